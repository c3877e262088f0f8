// From sliding to rolling: friction takes speed and gives spin until the contact point stands still (chapter 11).
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Rolling final : public Repeatable<Rolling, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "rolling";
    d.title = "From sliding to rolling";
    d.summary =
        "A ball, a disc and a box start alike on a rough lane; two of them soon roll, and one stops. Another ball "
        "spins.";
    d.group = "Surfaces";
    d.chapter = "11";
    d.text =
        "All start with the speed v₀ and no spin. Friction μ m g slows them and, at the rim, turns the round ones. "
        "When "
        "ω r has grown to v the contact point rests, and nothing slows them any more.\n\n"
        "  ball: v = 5/7 v₀ at t = 2 v₀/(7 μ g)\n\n"
        "  disc: v = 2/3 v₀ at t = v₀/(3 μ g)      box: stops after s = v₀²/(2 μ g)\n\n"
        "How fast they roll in the end does not depend on friction, only how soon.\n\n"
        "With rolling resistance c the ground gives way a little: a torque c r N holds against the roll. With spinning "
        "resistance the same holds against spin about the normal, as of the ball that spins on its spot.\n\n"
        "  ball: a = −5/7 c g      disc: a = −2/3 c g      spin: dω/dt = −5/2 c g/r";
    d.dt = 1.0 / 120;
    d.duration = 4;
    d.loop = true;
    d.camera = {{6, 6, 14}, {6, 0, 0}};
    d.ground = 0;
    d.parameters = {
        {"speed", "Speed at the start v₀", "m/s", "m/s", "", 0.5, 10, 0, 5, false},
        {"friction", "Friction μ", "", "", "on the lane", 0.05, 1, 0, 0.3, false},
        {"rolling", "Rolling resistance", "", "", "lever arm over radius", 0, 0.1, 0, 0, false},
        {"spinning", "Spinning resistance", "", "", "likewise, about the normal", 0, 0.1, 0, 0.02, false},
    };
    d.plots = {
        {"Speed",
         {"time", "s"},
         {"speed", "m/s"},
         {{"ball"},
          {"disc"},
          {"box"},
          {"ball: 5/7 v₀", Series::Style::points},
          {"disc: 2/3 v₀", Series::Style::points}}},
        {"Slip at the ground", {"time", "s"}, {"v − ω r", "m/s"}, {{"ball"}, {"disc"}}},
        {"Spin about the normal", {"time", "s"}, {"spin", "rad/s"}, {{"ball on its spot"}, {"ω₀ − 5/2 c g t/r"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    // The geometric mean of a pair counts.
    rigid::Material lane;
    lane.friction = stage.valuef("friction");
    lane.rolling_resistance = stage.valuef("rolling");
    lane.spinning_resistance = stage.valuef("spinning");
    stage.floor(0, lane);
    rigid::ShapeDef<Dim3> shape;
    shape.material = lane;
    ball_ = start(stage, "ball", -2, geometry::Sphere{radius_}, shape, orange);
    // A cylinder's axis is y of its shape; it rolls about z.
    shape.local.q = {0.70710678f, 0.70710678f, 0, 0};
    disc_ = start(stage, "disc", 0, geometry::Cylinder{0.15f, radius_}, shape, blue);
    shape.local.q = {};
    box_ = start(stage, "box", 2, geometry::Box{{radius_, radius_, radius_}}, shape, green);
    rigid::BodyDef<Dim3> top;
    top.name = "ball on its spot";
    top.position = {0, double(radius_), -4};
    top.angular_velocity = {0, float(spin_), 0};
    shape.local.q = {};
    top_ = stage.add(top, geometry::Sphere{radius_}, shape, gold);
    const double v = stage.value("speed"), g = 9.80665 * stage.value("friction");
    stage.sample(0, 3, 2 * v / (7 * g), 5 * v / 7);
    stage.sample(0, 4, v / (3 * g), 2 * v / 3);
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const auto ball = stage.at(ball_), disc = stage.at(disc_), box = stage.at(box_);
    stage.sample(0, 0, t, ball.linear_velocity.x);
    stage.sample(0, 1, t, disc.linear_velocity.x);
    stage.sample(0, 2, t, box.linear_velocity.x);
    stage.sample(1, 0, t, ball.linear_velocity.x + ball.angular_velocity.z * radius_);
    stage.sample(1, 1, t, disc.linear_velocity.x + disc.angular_velocity.z * radius_);
    stage.sample(2, 0, t, stage.at(top_).angular_velocity.y);
    stage.sample(2, 1, t, spin_at(stage, t));
    for (const auto* s : {&ball, &disc, &box})
      stage.line(s->center_of_mass, s->center_of_mass + 0.3 * Vec3d(s->linear_velocity), pen(0xffffff, 0xc0));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"speed of the ball", "m/s", "5/7 v₀", stage.at(ball_).linear_velocity.x, 5 * 5.0 / 7, 0.018});
    out.push_back({"speed of the disc", "m/s", "2/3 v₀", stage.at(disc_).linear_velocity.x, 2 * 5.0 / 3, 0.018});
    out.push_back(
        {"where the box stops", "m", "v₀²/(2 μ g)", stage.at(box_).pose.position.x, 25 / (2 * 0.3 * 9.80665), 0.04});
    out.push_back({"spin of the ball on its spot", "rad/s", "ω₀ − 5/2 c g t/r", stage.at(top_).angular_velocity.y,
                   spin_at(stage, stage.world().time()), 0.1});
  }

 private:
  static constexpr float radius_ = 0.4f;
  static constexpr double spin_ = 20;  ///< rad/s

  static double spin_at(Stage3& stage, double t) {
    const double c = max(stage.value("rolling"), stage.value("spinning"));
    return max(spin_ - 2.5 * c * 9.80665 * t / double(radius_), 0.0);
  }

  BodyId start(Stage3& stage, const char* name, double z, const geometry::Shape3& form,
               const rigid::ShapeDef<Dim3>& shape, std::uint32_t color) {
    rigid::BodyDef<Dim3> body;
    body.name = name;
    body.position = {0, double(radius_), z};
    body.linear_velocity = {stage.valuef("speed"), 0, 0};
    return stage.add(body, form, shape, color);
  }

  BodyId ball_, disc_, box_, top_;
};

}  // namespace

std::unique_ptr<Demo> make_rolling() { return std::make_unique<Rolling>(); }

}  // namespace carom::host::demo
