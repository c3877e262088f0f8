// Single bodies in space: clocks of their own, locks, a kinematic table that is sent where it shall be, a load that a
// motor joint carries along a path, and a charge.
#include "apps/host/demos/rules/list.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class BodyRulesSpace final : public Repeatable<BodyRulesSpace, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "body-rules-3d";
    d.title = "Clocks, locks, targets and a charge";
    d.summary =
        "Balls whose time runs slower, a bead on a rail, a turntable, a carried load, and a ring blown outward.";
    d.group = "Rules of bodies";
    d.text =
        "Left: three balls fall, whose own time runs at s = 1, ½ and ¼ of the world's.\n\n"
        "  y = y₀ − ½ g (s t)²\n\n"
        "Front: a block that may only go along x is struck by a ball from askew. The lock takes what points elsewhere; "
        "along x the momentum of both stays.\n\n"
        "Behind: a turntable is kinematic. It is given its pose at the end of each step, and carries crates by "
        "friction alone as long as ω² r < μ g. Above it a motor joint draws a load along a circle: it pulls toward "
        "its target like a damped spring, with a limited force.\n\n"
        "Right: a charge gives all in its reach the same speed outward, whatever their mass (press B).";
    d.dt = 1.0 / 120;
    d.duration = 5;
    d.camera.position = {1.5, 6.5, 11};
    d.camera.target = {0.3, 1.4, -0.6};
    d.ground = 0;
    d.parameters = {
        {"turn", "Turntable", "rad/s", "rad/s", "ω", 0, 4, 0.05, 1.2, true},
        {"force", "Greatest force of the motor joint", "N", "N", "the load weighs 98 N", 20, 2000, 10, 400, false},
        {"blast", "Speed of the blast", "m/s", "m/s", "", 0, 12, 0.1, 3, true},
    };
    d.plots = {{"Falling balls", {"time", "s"}, {"height", "m"}, {{"s = 1"}, {"s = ½"}, {"s = ¼"}}},
               {"Load", {"time", "s"}, {"distance", "m"}, {{"off its target"}}}};
    d.inputs = {{"blast", "Blast", {"KeyB"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    for (int i = 0; i < 3; ++i) {
      rigid::BodyDef<Dim3> ball;
      ball.name = "falling ball";
      ball.position = {-5.2 + 0.8 * i, start_, 0};
      ball.time_scale = scale(i);
      falling_[i] = stage.add(ball, geometry::Sphere{0.28f}, {}, i == 0 ? orange : (i == 1 ? gold : sand));
    }
    // A block on a rail, without friction, and a ball that strikes it askew.
    rigid::ShapeDef<Dim3> smooth;
    smooth.material.friction = 0;
    rigid::BodyDef<Dim3> block;
    block.name = "block on a rail";
    block.position = {-1.5, 0.9, 3};
    block.locks = {false, true, true, true, true, true};
    block_ = stage.add(block, geometry::Box{{0.35f, 0.3f, 0.3f}}, smooth, teal);
    rigid::BodyDef<Dim3> bumper;
    bumper.type = rigid::BodyType::fixed;
    bumper.name = "bumper";
    bumper.position = {5.1, 0.6, 3};
    stage.add(bumper, geometry::Box{{0.1f, 0.6f, 0.2f}}, {}, dark);
    rigid::BodyDef<Dim3> shot;
    shot.name = "shot";
    shot.position = {-3.6, 0.9, 3.4};
    shot.linear_velocity = {6, 0, -0.8f};
    shot.gravity_scale = 0;
    smooth.density = 2000;
    shot_ = stage.add(shot, geometry::Sphere{0.25f}, smooth, dark);
    push_ = double(stage.at(shot_).mass) * 6;

    rigid::BodyDef<Dim3> table;
    table.type = rigid::BodyType::kinematic;
    table.name = "turntable";
    table.position = {0, 0.4, -2.6};
    table_ = stage.add(table, geometry::Cylinder{0.12f, 1.8f, 0.04f}, {}, steel);
    for (int i = 0; i < 4; ++i) {
      rigid::BodyDef<Dim3> crate;
      crate.name = "crate on the table";
      const Vec2d at = polar(1.2, pi * i / 2);
      crate.position = table.position + Vec3d{at.x, 0.36, at.y};
      crates_[i] = stage.add(crate, geometry::Box{{0.2f, 0.2f, 0.2f}}, {}, i == 0 ? red : blue);
    }
    rigid::BodyDef<Dim3> load;
    load.name = "carried load";
    load.position = target(0);
    const float r = 0.25f;
    rigid::ShapeDef<Dim3> ten;
    ten.density = 10 / (4.0f / 3 * pi_f * r * r * r);
    load_ = stage.add(load, geometry::Sphere{r}, ten, violet);
    rigid::MotorJointDef<Dim3> motor;
    motor.body_b = load_;
    motor.linear = {4, 1};
    motor.max_force = stage.valuef("force");
    motor.target_position = Vec3f(target(0));
    motor_ = stage.keep(stage.world().create_joint(motor));
    for (int i = 0; i < 10; ++i) {
      rigid::BodyDef<Dim3> body;
      body.name = "blown ball";
      const Vec2d at = polar(0.8, 2 * pi * i / 10);
      const float radius = i % 2 == 0 ? 0.2f : 0.14f;
      body.position = {charge_.x + at.x, double(radius), charge_.z + at.y};
      rigid::ShapeDef<Dim3> shape;
      shape.material.rolling_resistance = 0.1f;
      ring_.push_back(stage.add(body, geometry::Sphere{radius}, shape, i % 2 == 0 ? green : gold));
    }
  }

  void before_step(Stage3& stage) override {
    const double dt = stage.declaration().dt, t = stage.world().time() + dt;
    angle_ += stage.value("turn") * dt;
    stage.check(stage.world().set_target_pose(table_, {0, 0.4, -2.6}, from_axis_angle(Vec3f{0, 1, 0}, float(angle_)),
                                              float(dt)));
    // Where it shall be, and how fast: without the speed it would lag behind.
    const Vec3d ahead = target(t + 1e-3), behind = target(t - 1e-3);
    stage.check(stage.world().set_target_pose(motor_, Vec3f(target(t)), {}));
    stage.check(stage.world().set_target_velocity(motor_, Vec3f((ahead - behind) / 2e-3), {}));
    const bool first = !blown_ && t >= 1;
    if (!first && stage.presses("blast") == 0) return;
    rigid::ExplosionDef<Dim3> charge;
    charge.center = charge_;
    charge.radius = 2;
    charge.falloff = 1;
    charge.speed = stage.valuef("blast");
    (void)stage.keep(stage.world().explode(charge));
    if (!first) return;
    blown_ = true;
    for (const BodyId ball : ring_) {
      const Vec3d v(stage.at(ball).linear_velocity), way = stage.at(ball).pose.position - charge_;
      slowest_ = min(slowest_, length(v));
      aside_ = max(aside_, length(cross(v, way)) / max(length(v) * length(way), 1e-9));
    }
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    for (int i = 0; i < 3; ++i) {
      const double y = stage.at(falling_[i]).pose.position.y;
      stage.sample(0, i, t, y);
      const double own = double(scale(i)) * t, fall = start_ - 0.5 * 9.80665 * own * own;
      if (fall > 0.4) off_ = max(off_, abs(y - fall));
    }
    const double lag = length(stage.at(load_).pose.position - target(t));
    stage.sample(1, 0, t, lag);
    if (t > 1) lag_ = max(lag_, lag);
    if (t < 1.3) momentum_ = along_x(stage);
    stage.line(Vec3d{-4, 0.9, 3}, Vec3d{5, 0.9, 3}, pen(dark));
    for (int i = 0; i < 60; ++i)
      stage.line(target(i * period_ / 60), target((i + 1) * period_ / 60), pen(violet, 0x80));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"farthest a ball was off its fall", "m", "½ g (s t)²", off_, 0, 0.03});
    out.push_back({"momentum along the rail", "N·s", "that of the shot", momentum_, push_, 0.01 * push_});
    const Vec3d block = stage.at(block_).pose.position;
    out.push_back({"block off its rail", "m", "its locks", max(abs(block.y - 0.9), abs(block.z - 3)), 0, 1e-6});
    const auto q = stage.at(table_).pose.rotation;
    const double turned = 2 * atan2(double(q.y), double(q.w)), wanted = 1.2 * stage.world().time();
    out.push_back({"turntable off its target", "rad", "it is there after each step",
                   abs(sin((turned - wanted) / 2)) * 2, 0, 1e-3});
    const Vec3d crate = stage.at(crates_[0]).pose.position - Vec3d{0, 0.4, -2.6};
    out.push_back({"crate's distance from the axle", "m", "ω² r < μ g: it is carried",
                   sqrt(crate.x * crate.x + crate.z * crate.z), 1.2, 0.03});
    out.push_back({"farthest the load was off its target", "m", "the motor joint", lag_, 0, 0.05});
    out.push_back({"slowest of the ring after the charge", "m/s", "the speed of the blast", slowest_, 3, 0.05});
    out.push_back({"farthest aside of outward", "", "from the centre of the charge", aside_, 0, 0.05});
  }

 private:
  static constexpr double start_ = 5, period_ = 4;
  static constexpr Vec3d charge_{4.2, 0, -0.4};
  static float scale(int i) { return i == 0 ? 1.0f : (i == 1 ? 0.5f : 0.25f); }
  static Vec2d polar(double r, double a) { return {r * cos(a), r * sin(a)}; }
  static Vec3d target(double t) {
    const Vec2d p = polar(1.3, 2 * pi * t / period_);
    return {p.x, 2.3 + 0.3 * sin(4 * pi * t / period_), -2.6 + p.y};
  }
  double along_x(Stage3& stage) const {
    return double(stage.at(shot_).mass * stage.at(shot_).linear_velocity.x +
                  stage.at(block_).mass * stage.at(block_).linear_velocity.x);
  }

  BodyId falling_[3], block_, shot_, table_, crates_[4], load_;
  rigid::JointId motor_;
  std::vector<BodyId> ring_;
  double angle_ = 0, off_ = 0, push_ = 1, momentum_ = 0, lag_ = 0, slowest_ = 1e9, aside_ = 0;
  bool blown_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_body_rules_space() { return std::make_unique<BodyRulesSpace>(); }

}  // namespace carom::host::demo
