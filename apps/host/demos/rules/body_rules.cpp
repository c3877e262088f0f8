// Weight, resistance and locks of single bodies, and a body that is sent to where it shall be.
#include "apps/host/demos/rules/list.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class BodyRules final : public Repeatable<BodyRules, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "body-rules";
    d.dimension = 2;
    d.title = "Weight, damping, locks and targets";
    d.summary = "Stones of other weights, pucks that slow down, crates that do not turn, and a lift that keeps time.";
    d.group = "Rules of bodies";
    d.text =
        "Each dynamic body has a gravity scale: 0 floats, −0.2 rises, 2 falls twice as fast. Above, four balls on the "
        "left show it.\n\n"
        "  y = y₀ − ½ γ g t²\n\n"
        "Linear and angular damping c take a share of the velocity in every step, implicitly, so that no damping turns "
        "a body round. A puck without friction comes to rest after v/c metres.\n\n"
        "  v = v₀ e^(−c t)      x = (v₀/c)(1 − e^(−c t))\n\n"
        "Locks hold single motions: of the three crates that the ball strikes, one is free, one cannot turn, and one "
        "cannot leave its column. The lift is kinematic: it is given the pose where it shall be at the end of each "
        "step, moves there whatever is in the way, and carries what stands on it by friction alone.";
    d.duration = 6;
    d.camera.target = {0, 3.7, 0};
    d.camera.height = 10;
    d.camera.width = 18.5;
    d.ground = 0;
    d.parameters = {
        {"light", "Gravity scale of the light ball", "", "", "γ", -0.5, 1, 0, 0.25, false},
        {"damping", "Damping of the second puck", "1/s", "1/s", "c; the third has twice as much", 0.2, 8, 0, 1, false},
        {"period", "Period of the lift", "s", "s", "", 1.5, 10, 0, 4, false},
    };
    d.plots = {{"Balls", {"time", "s"}, {"height", "m"}, {{"γ = −0.2"}, {"light"}, {"γ = 1"}, {"γ = 2"}}},
               {"Pucks", {"time", "s"}, {"way", "m"}, {{"no damping"}, {"c"}, {"2c"}}},
               {"Lift", {"time", "s"}, {"height", "m"}, {{"target"}, {"lift"}, {"crate on it"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(0);
    const float scales[] = {-0.2f, stage.valuef("light"), 1, 2};
    constexpr std::uint32_t colors[] = {violet, gold, steel, dark};
    for (int i = 0; i < 4; ++i) {
      rigid::BodyDef<Dim2> body;
      body.name = i == 0 ? "balloon" : "ball";
      body.position = {-8.4 + 0.9 * i, start_};
      body.gravity_scale = scales[i];
      balls_[i] = stage.add(body, geometry::Circle{0.3f}, {}, colors[i]);
    }
    for (int i = 0; i < 3; ++i) {
      rigid::BodyDef<Dim2> lane;
      lane.type = rigid::BodyType::fixed;
      lane.name = "lane";
      lane.position = {0.2, lane_of(i) - 0.06};
      rigid::ShapeDef<Dim2> smooth;
      smooth.material.friction = 0;
      stage.add(lane, geometry::make_box2({4.2f, 0.06f}), smooth, steel);
      rigid::BodyDef<Dim2> puck;
      puck.name = "puck";
      puck.position = {puck_start_, lane_of(i) + 0.15};
      puck.linear_velocity = {2, 0};
      puck.linear_damping = float(i) * stage.valuef("damping");
      puck.sleep_speed = 0;
      pucks_[i] = stage.add(puck, geometry::make_box2({0.35f, 0.15f}), smooth, i == 0 ? teal : i == 1 ? green : blue);
    }
    for (int i = 0; i < 3; ++i) {
      rigid::BodyDef<Dim2> crate;
      crate.name = i == 0 ? "free crate" : i == 1 ? "crate that does not turn" : "crate that stays in its column";
      crate.position = {-3 + 2.6 * i, 0.6};
      crate.locks.rotation_z = i == 1;
      crate.locks.x = i == 2;
      crates_[i] = stage.add(crate, geometry::make_box2({0.3f, 0.6f}), {}, i == 0 ? sand : i == 1 ? orange : red);
      rigid::BodyDef<Dim2> ball;
      ball.name = "shot";
      ball.position = {-4 + 2.6 * i, 1};
      ball.linear_velocity = {5, 0};
      rigid::ShapeDef<Dim2> heavy;
      heavy.density = 2500;
      stage.add(ball, geometry::Circle{0.18f}, heavy, dark);
    }
    rigid::BodyDef<Dim2> lift;
    lift.type = rigid::BodyType::kinematic;
    lift.name = "lift";
    lift.position = target(stage, 0);
    lift_ = stage.add(lift, geometry::make_box2({0.9f, 0.1f}), {}, dark);
    rigid::BodyDef<Dim2> load;
    load.name = "crate on the lift";
    load.position = lift.position + Vec2d{0, 0.5};
    load_ = stage.add(load, geometry::make_box2({0.4f, 0.4f}), {}, gold);
  }

  void before_step(Stage2& stage) override {
    const double dt = stage.declaration().dt;
    stage.check(stage.world().set_target_pose(lift_, target(stage, stage.world().time() + dt), {}, float(dt)));
  }

  void after_step(Stage2& stage) override {
    const double t = stage.world().time();
    for (int i = 0; i < 4; ++i) {
      const double y = stage.at(balls_[i]).pose.position.y;
      stage.sample(0, i, t, y);
      if (t < 0.75) {
        constexpr double fixed[] = {-0.2, 0, 1, 2};
        const double scale = i == 1 ? stage.value("light") : fixed[i];
        if (i < 3 || t < 0.6) fall_ = max(fall_, abs(y - (start_ - 0.5 * scale * 9.80665 * t * t)));
      }
    }
    for (int i = 0; i < 3; ++i) stage.sample(1, i, t, way(stage, i));
    const Vec2d wanted = target(stage, t), is = stage.at(lift_).pose.position;
    stage.sample(2, 0, t, wanted.y);
    stage.sample(2, 1, t, is.y);
    stage.sample(2, 2, t, stage.at(load_).pose.position.y);
    off_ = max(off_, length(is - wanted));
    const Vec2d c = lift_center_;
    for (int i = 0; i < 48; ++i) {
      const double a = 2 * pi * i / 48, b = 2 * pi * (i + 1) / 48;
      stage.line(c + Vec2d{sway_ * sin(a), -rise_ * cos(a)}, c + Vec2d{sway_ * sin(b), -rise_ * cos(b)},
                 pen(steel, 0x80));
    }
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    out.push_back({"farthest a ball was off its fall", "m", "½ γ g t²", fall_, 0, 2e-3});
    const double t = stage.world().time(), c = 1;
    out.push_back(
        {"way of the puck with c = 1/s", "m", "(v₀/c)(1 − e^(−c t))", way(stage, 1), 2 / c * (1 - exp(-c * t)), 0.03});
    out.push_back({"way of the puck with c = 2/s", "m", "likewise", way(stage, 2), 1 - exp(-2 * t), 0.03});
    out.push_back({"turn of the crate that does not turn", "rad", "its lock", angle(stage, crates_[1]), 0, 1e-6});
    out.push_back(
        {"way of the crate in its column", "m", "its lock", stage.at(crates_[2]).pose.position.x - 2.2, 0, 1e-6});
    out.push_back({"turn of the free crate at least", "rad", "struck above its centre",
                   min(abs(angle(stage, crates_[0])), 0.5), 0.5, 0});
    out.push_back({"farthest the lift was off its target", "m", "it is there at the end of each step", off_, 0, 1e-4});
    out.push_back({"crate over the lift", "m", "it rides",
                   stage.at(load_).pose.position.y - stage.at(lift_).pose.position.y, 0.5, 0.02});
  }

 private:
  static constexpr double start_ = 6.6, puck_start_ = -3.4, sway_ = 1.1, rise_ = 1.6;
  static constexpr Vec2d lift_center_{7, 2.6};
  static double lane_of(int i) { return 3.4 + 1.3 * i; }
  static Vec2d target(Stage2& stage, double t) {
    const double phase = 2 * pi * t / stage.value("period");
    return lift_center_ + Vec2d{sway_ * sin(phase), -rise_ * cos(phase)};
  }
  double way(Stage2& stage, int i) const { return stage.at(pucks_[i]).pose.position.x - puck_start_; }
  static double angle(Stage2& stage, BodyId body) {
    const auto q = stage.at(body).pose.rotation;
    return double(atan2(q.s, q.c));
  }

  BodyId balls_[4], pucks_[3], crates_[3], lift_, load_;
  double fall_ = 0, off_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_body_rules() { return std::make_unique<BodyRules>(); }

}  // namespace carom::host::demo
