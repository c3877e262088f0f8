// What a step tells in space: hits with their speeds along and across the surface, a gate that sees who is in it, who
// moved and who fell asleep.
#include <algorithm>

#include "apps/host/demos/rules/list.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class EventsSpace final : public Repeatable<EventsSpace, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "events-3d";
    d.title = "Hits, gates and sleepers in space";
    d.summary = "Crates fall through a gate that counts them; a ball skids; who sleeps turns grey. All told by events.";
    d.group = "Events";
    d.text =
        "After each step a world tells what happened in it. A hit has the speed at which the surfaces met, the speed "
        "at which they slipped across each other, and the impulse that the solver really applied: enough for a sound, "
        "a spark or a scratch. Red lines show impulses, rings slip.\n\n"
        "  approach = √(2 g h)      slip = v₀      impulse = m (1 + e) √(2 g h)\n\n"
        "The golden gate is a sensor: it pushes nothing and tells who comes and goes. Move events name all that moved, "
        "so that a game need look at no other body, and sleep events those that no longer do.";
    d.dt = 1.0 / 120;
    d.duration = 7;
    d.camera.position = {4.5, 5.2, 9.5};
    d.camera.target = {0.2, 1.3, 0};
    d.ground = 0;
    d.parameters = {
        {"crates", "Crates", "", "", "", 2, 60, 1, 16, false},
        {"speed", "Speed of the ball v₀", "m/s", "m/s", "level, without spin", 0, 10, 0.1, 4, false},
    };
    d.plots = {{"Hits",
                {"time", "s"},
                {"speed", "m/s"},
                {{"approach", Series::Style::points}, {"slip", Series::Style::points}}},
               {"Bodies", {"time", "s"}, {"bodies", ""}, {{"moved"}, {"asleep"}, {"in the gate"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.move_events = true;
    stage.start(world);
    stage.floor(0);
    rigid::BodyDef<Dim3> gate;
    gate.type = rigid::BodyType::fixed;
    gate.name = "gate";
    gate.position = {0, 2.6, 0};
    rigid::ShapeDef<Dim3> sensor;
    sensor.sensor = true;
    stage.add(gate, geometry::Box{{1.9f, 0.06f, 1.9f}}, sensor, gold);
    const int crates = stage.count("crates");
    for (int i = 0; i < crates; ++i) {
      const int row = i / 4 % 4, layer = i / 16;
      rigid::BodyDef<Dim3> body;
      body.name = "crate";
      body.position = {-1.2 + 0.8 * (i % 4), 3.4 + 0.75 * layer, -1.2 + 0.8 * row};
      rigid::ShapeDef<Dim3> shape;
      shape.hit_events = true;
      const float half = 0.18f + 0.02f * float(i * 5 % 7);
      bodies_.push_back(stage.add(body, geometry::Box{{half, half, half}}, shape, colors[i % 5]));
    }
    rigid::BodyDef<Dim3> ball;
    ball.name = "ball";
    ball.position = {-4.5, drop_ + double(radius_), 2.6};
    ball.linear_velocity = {stage.valuef("speed"), 0, 0};
    rigid::ShapeDef<Dim3> shape;
    shape.hit_events = true;
    shape.material.restitution = 0.5f;
    shape.material.rolling_resistance = 0.08f;
    ball_ = stage.add(ball, geometry::Sphere{radius_}, shape, red);
    bodies_.push_back(ball_);
    asleep_.assign(bodies_.size(), false);
  }

  void after_step(Stage3& stage) override {
    const rigid::Events<Dim3> events = stage.world().events();
    const double t = stage.world().time();
    entered_ += int(events.sensor_begin.size());
    left_ += int(events.sensor_end.size());
    for (const rigid::ContactHitEvent<Dim3>& hit : events.contact_hit) {
      stage.sample(0, 0, t, double(hit.approach_speed));
      stage.sample(0, 1, t, double(hit.slip_speed));
      marks_.push_back({hit.point, Vec3d(hit.normal), double(hit.impulse), double(hit.slip_speed), t});
      const BodyId a = stage.keep(stage.world().body_of(hit.shape_a)),
                   b = stage.keep(stage.world().body_of(hit.shape_b));
      if (first_.impulse == 0 && (a == ball_ || b == ball_)) first_ = hit;
    }
    // Only what the events name is looked at.
    moved_ = int(events.moved.size());
    for (const rigid::MoveEvent<Dim3>& move : events.moved) paint(stage, move.body, false);
    for (const rigid::SleepEvent& sleeper : events.fell_asleep) paint(stage, sleeper.body, true);
    stage.sample(1, 0, t, moved_);
    stage.sample(1, 1, t, double(std::count(asleep_.begin(), asleep_.end(), true)));
    stage.sample(1, 2, t, entered_ - left_);
    std::erase_if(marks_, [&](const Mark& m) { return t - m.time > 0.35; });
    for (const Mark& m : marks_) {
      const Vec3d up = m.normal.y < 0 ? -m.normal : m.normal;
      stage.line(m.point, m.point + up * (0.004 * m.impulse), pen(red));
      ring(stage, m.point + up * 0.01, 0.12 * m.slip);
    }
    stage.say(format("through the gate: %.0f in, %.0f out; %.0f move", entered_, left_, moved_));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double meeting = sqrt(2 * 9.80665 * drop_), mass = double(stage.at(ball_).mass);
    out.push_back(
        {"approach of the ball's first hit", "m/s", "√(2 g h)", double(first_.approach_speed), meeting, 0.06});
    out.push_back({"slip of the ball's first hit", "m/s", "v₀", double(first_.slip_speed), stage.value("speed"), 0.01});
    out.push_back({"impulse of the ball's first hit", "N·s", "m (1 + e) √(2 g h)", double(first_.impulse),
                   1.5 * mass * meeting, 0.03 * mass * meeting});
    out.push_back({"entered the gate", "", "each crate once", double(entered_), double(bodies_.size() - 1), 0});
    out.push_back({"in the gate at the end", "", "all that entered left", double(entered_ - left_), 0, 0});
    out.push_back({"bodies that moved in the last step", "", "all sleep", double(moved_), 0, 0});
    out.push_back({"bodies told asleep", "", "all", double(std::count(asleep_.begin(), asleep_.end(), true)),
                   double(bodies_.size()), 0});
  }

 private:
  struct Mark {
    Vec3d point, normal;
    double impulse, slip, time;
  };
  static constexpr std::uint32_t colors[] = {orange, blue, green, violet, teal};
  static constexpr float radius_ = 0.25f;
  static constexpr double drop_ = 1.2;

  void paint(Stage3& stage, BodyId body, bool asleep) {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      if (bodies_[i] != body || asleep_[i] == asleep) continue;
      asleep_[i] = asleep;
      stage.set_color(body, asleep ? steel : (body == ball_ ? red : colors[i % 5]));
    }
  }
  static void ring(Stage3& stage, Vec3d center, double radius) {
    constexpr int sides = 20;
    const auto at = [&](int i) {
      return center + Vec3d{radius * cos(2 * pi * i / sides), 0, radius * sin(2 * pi * i / sides)};
    };
    for (int i = 0; i < sides; ++i) stage.line(at(i), at(i + 1), pen(blue));
  }

  std::vector<BodyId> bodies_;
  std::vector<bool> asleep_;
  BodyId ball_;
  std::vector<Mark> marks_;
  rigid::ContactHitEvent<Dim3> first_{};
  int entered_ = 0, left_ = 0, moved_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_events_space() { return std::make_unique<EventsSpace>(); }

}  // namespace carom::host::demo
