// What a step tells: who begins and ends to touch, how hard things hit, who is in a sensor.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class EventsDemo final : public Repeatable<EventsDemo, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "events";
    d.title = "Sensors and contact events";
    d.summary = "Balls fall through a gate that counts them and strike the floor: every blow is a line as long as it.";
    d.group = "Events";
    d.dimension = 2;
    d.text =
        "After each step a world tells of contacts that began and ended, of hits with the impulse that the solver "
        "really "
        "applied, and of sensors, which see what overlaps them and push nothing. Lines show hits; the gate counts.\n\n"
        "  impulse of a ball that falls by h and bounces: m (1 + e) √(2 g h)";
    d.dt = 1.0 / 120;
    d.duration = 6;
    d.camera.target = {0, 3.5, 0};
    d.camera.height = 10;
    d.camera.width = 14;
    d.parameters = {
        {"balls", "Balls", "", "", "", 1, 40, 1, 12, false},
        {"restitution", "Restitution e", "", "", "of the floor", 0, 0.9, 0, 0.5, false},
    };
    d.plots = {{"Hits", {"time", "s"}, {"impulse", "N·s"}, {{"hits", Series::Style::points}, {"m (1 + e) √(2 g h)"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(0, {.restitution = stage.valuef("restitution")});
    rigid::BodyDef<Dim2> gate;
    gate.type = rigid::BodyType::fixed;
    gate.name = "gate";
    gate.position = {0, 3.5};
    rigid::ShapeDef<Dim2> sensor;
    sensor.sensor = true;
    stage.add(gate, geometry::make_box2({6, 0.3f}), sensor, gold);
    constexpr std::uint32_t colors[] = {orange, blue, green, violet, red, teal};
    const int balls = stage.count("balls");
    for (int i = 0; i < balls; ++i) {
      rigid::BodyDef<Dim2> body;
      body.name = "ball";
      body.position = {-5.5 + 11.0 * (i + 0.5) / balls, 6 + 0.35 * (i * 5 % 7)};
      rigid::ShapeDef<Dim2> shape;
      shape.hit_events = true;
      const BodyId id = stage.add(body, geometry::Circle{radius_}, shape, colors[i % 6]);
      if (i == 0) first_ = id, drop_ = body.position.y - double(radius_);
    }
    mass_ = double(stage.at(first_).mass);
    expected_ = mass_ * (1 + stage.value("restitution")) * sqrt(2 * 9.80665 * drop_);
    stage.sample(0, 1, 0, expected_), stage.sample(0, 1, 6, expected_);
  }

  void after_step(Stage2& stage) override {
    const rigid::Events<Dim2> events = stage.world().events();
    entered_ += int(events.sensor_begin.size());
    left_ += int(events.sensor_end.size());
    begun_ += int(events.contact_begin.size());
    ended_ += int(events.contact_end.size());
    for (const rigid::ContactHitEvent<Dim2>& hit : events.contact_hit) {
      stage.sample(0, 0, stage.world().time(), double(hit.impulse));
      marks_.push_back({hit.point, Vec2d(hit.normal) * double(hit.impulse) / mass_ * 0.12, stage.world().time()});
      const BodyId a = stage.keep(stage.world().body_of(hit.shape_a)),
                   b = stage.keep(stage.world().body_of(hit.shape_b));
      if (impulse_ == 0 && (a == first_ || b == first_)) impulse_ = double(hit.impulse);
    }
    std::erase_if(marks_, [&](const Mark& m) { return stage.world().time() - m.time > 0.4; });
    for (const Mark& m : marks_) stage.line(m.point - m.way, m.point + m.way, pen(red));
    stage.say(format("through the gate: %.0f in, %.0f out; contacts: %.0f begun, %.0f ended", entered_, left_, begun_,
                     ended_));
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    const double balls = double(stage.count("balls"));
    out.push_back({"entered the gate at least", "", "each ball once", min(double(entered_), balls), balls, 0});
    out.push_back({"in the gate at the end", "", "all that entered left", double(entered_ - left_), 0, 0});
    out.push_back({"impulse of the first hit", "N·s", "m (1 + e) √(2 g h)", impulse_, expected_, 0.02 * expected_});
    std::vector<rigid::ContactView<Dim2>> contacts;
    stage.world().contacts(contacts);
    out.push_back(
        {"contacts begun and not ended", "", "those there are", double(begun_ - ended_), double(contacts.size()), 2});
  }

 private:
  struct Mark {
    Vec2d point, way;
    double time;
  };
  static constexpr float radius_ = 0.22f;
  BodyId first_;
  std::vector<Mark> marks_;
  double drop_ = 1, mass_ = 1, expected_ = 0, impulse_ = 0;
  int entered_ = 0, left_ = 0, begun_ = 0, ended_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_events() { return std::make_unique<EventsDemo>(); }

}  // namespace carom::host::demo
