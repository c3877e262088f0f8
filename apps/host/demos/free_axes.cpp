// Joints that free single axes: a puck in a plane, a cart on wheels with suspension, a platform on six springs.
#include "apps/host/demos/demos.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;
using rigid::JointId;

class FreeAxes final : public Repeatable<FreeAxes, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "free-axes";
    d.title = "Planar, wheel and six-axis joints";
    d.summary = "A puck that keeps to its plane, a cart whose wheels spring and steer, a platform on six springs.";
    d.group = "Joints";
    d.chapter = "13";
    d.text =
        "Two bodies have six degrees of freedom against each other, three to slide and three to turn. A joint holds "
        "some of them and leaves the others free; on each free axis there may be a spring, a motor, stops or "
        "friction.\n\n"
        "The puck slides in a plane and turns about its normal (planar joint). Springs of f and 2f along its two axes "
        "make it draw a figure of Lissajous. The cart's wheels (wheel joint) spring along y and roll about z; the "
        "front "
        "ones are freed about y too, where a stiff spring with a target steers them. The platform is free on all six "
        "axes, each on a spring: heave, surge and sway swing with f, whatever its mass.\n\n"
        "  x = A cos 2πft,  y = B sin 4πft";
    d.duration = 10;
    d.camera = {{0.4, 4.2, 8.8}, {0, 0.7, 0.4}, 0.75};
    d.ground = 0;
    d.parameters = {
        {"frequency", "Frequency of the springs", "Hz", "Hz", "f, of the puck and the platform", 0.2, 2, 0, 0.5, false},
        {"steer", "Steering", "rad", "deg", "of the front wheels", -0.6, 0.6, 0, radians(20.0), true},
        {"speed", "Speed of the cart", "m/s", "m/s", "that its rear wheels want", -4, 4, 0, 2, true},
        {"suspension", "Suspension of the cart", "Hz", "Hz", "", 1, 6, 0, 2, false},
    };
    d.plots = {{"Puck", {"x", "m"}, {"y", "m"}, {{"in its plane"}}},
               {"Platform", {"time", "s"}, {"height", "mm"}, {{"of its middle"}}},
               {"Cart", {"time", "s"}, {"speed", "m/s"}, {{"forward"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    rigid::Material grip;
    grip.friction = 1;
    stage.floor(0, grip);
    puck(stage);
    cart(stage);
    platform(stage);
    changed(stage, {});
  }

  void changed(Stage3& stage, std::string_view) override {
    for (int k = 0; k < 4; ++k) {
      const bool front = k < 2;
      if (front) {
        rigid::JointAxis steering;
        steering.free = true;
        steering.spring = {8, 1};
        steering.target = stage.valuef("steer");
        stage.check(stage.world().set_axis(wheel_joint_[k], 4, steering));
      } else {
        rigid::JointAxis drive;
        drive.free = true;
        drive.motor = {true, -stage.valuef("speed") / wheel_radius_, 60};
        stage.check(stage.world().set_axis(wheel_joint_[k], 5, drive));
      }
    }
    stage.check(stage.world().set_awake(chassis_, true));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const rigid::BodyState<Dim3> puck = stage.at(puck_);
    const Vec3d d = puck.pose.position - table_;
    const Vec3d in_plane = inverse_rotate(Quatd(tilt()), d);
    stage.sample(0, 0, in_plane.x, in_plane.y);
    trail_.add(puck.pose.position + rotate(Quatd(tilt()), Vec3d{0, 0, 0.12}));
    trail_.draw(stage, pen(orange));
    lift_ = max(lift_, abs(in_plane.z));
    // Swings are counted where the puck comes through the middle; its y at the ends of x is the phase of the figure.
    const double place = stage.at(platform_).pose.position.y - rest_;
    stage.sample(1, 0, t, 1e3 * place);
    if (before_ > 0 && place <= 0) {
      const double at = t - place / (place - before_) * stage.declaration().dt;
      (crossings_ == 0 ? first_ : last_) = at;
      ++crossings_;
    }
    before_ = place;
    const rigid::BodyState<Dim3> cart = stage.at(chassis_);
    const double v = double(dot(cart.linear_velocity, rotate(cart.pose.rotation, Vec3f{1, 0, 0})));
    stage.sample(2, 0, t, v);
    way_.add(cart.pose.position - Vec3d{0, cart.pose.position.y - 0.02, 0});
    way_.draw(stage, pen(blue, 0xa0));
    if (t > 5) far_ = max(far_, abs(v - 2));
    if (t > 5) turn_ = double(cart.angular_velocity.y) / v;
    const rigid::BodyState<Dim3> platform = stage.at(platform_);
    for (int i = 0; i < 4; ++i) {  // springs under the platform
      const Vec3f corner{i % 2 == 0 ? -0.6f : 0.6f, -0.08f, i / 2 == 0 ? -0.4f : 0.4f};
      stage.line({rest_x_ + double(corner.x), 0, double(corner.z)},
                 platform.pose.position + Vec3d(rotate(platform.pose.rotation, corner)), pen(dark));
    }
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"farthest the puck left its plane", "m", "the joint holds it", lift_, 0, 2e-3});
    const double swing = (last_ - first_) / max(crossings_ - 1, 1);
    out.push_back({"period of the platform", "s", "1/f", swing, 2, 0.03});
    out.push_back({"speed of the cart", "m/s", "its wheels want 2, in a curve", far_, 0, 0.25});
    // Ackermann's mean wheel: curvature tan(steer)/wheelbase, less what the tyres slip.
    out.push_back(
        {"curvature of its way", "1/m", "tan δ/wheelbase", turn_, tan(radians(20.0)) / (2 * half_base_), 0.06});
    out.push_back({"worst joint error", "m", "joints hold", stage.world().worst_joint_error(), 0, 0.005});
  }

 private:
  static constexpr float wheel_radius_ = 0.22f;
  static constexpr double half_base_ = 0.55, rest_x_ = 4.2;
  static constexpr Vec3d table_{-4, 1.5, 0};
  static Quatf tilt() { return from_axis_angle(Vec3f{1, 0, 0}, -0.7f); }  // its normal, z, leans up

  void puck(Stage3& stage) {
    rigid::BodyDef<Dim3> body;
    body.type = rigid::BodyType::fixed;
    body.name = "table";
    body.position = table_ - rotate(Quatd(tilt()), Vec3d{0, 0, 0.16});
    body.rotation = tilt();
    rigid::ShapeDef<Dim3> ghost;
    ghost.filter.mask = 0;
    const BodyId table = stage.add(body, geometry::Box{{1.7f, 1.3f, 0.05f}, 0.02f}, ghost, steel);
    body.type = rigid::BodyType::dynamic;
    body.name = "puck";
    const Vec3d start{1.2, 0, 0};
    const double w = 2 * pi * stage.value("frequency");
    body.position = table_ + rotate(Quatd(tilt()), start);
    body.linear_velocity = rotate(tilt(), Vec3f{0, float(2 * w * 0.9), 0});
    body.angular_velocity = rotate(tilt(), Vec3f{0, 0, 1});
    body.gravity_scale = 0;
    body.sleep_speed = 0;
    rigid::ShapeDef<Dim3> shape;
    shape.local.q = from_axis_angle(Vec3f{1, 0, 0}, 0.5f * pi_f);
    puck_ = stage.add(body, geometry::Cylinder{0.08f, 0.22f, 0.02f}, shape, orange);
    rigid::JointFrames<Dim3> frames;
    frames.body_a = table, frames.body_b = puck_;
    frames.frame_a.p = {0, 0, 0.16f};
    rigid::GenericJointDef<Dim3> joint = rigid::make_planar_joint<Dim3>(frames);
    joint.linear[0].spring = {stage.valuef("frequency"), 0};
    joint.linear[1].spring = {2 * stage.valuef("frequency"), 0};
    stage.keep(stage.world().create_joint(joint));
  }

  void cart(Stage3& stage) {
    rigid::BodyDef<Dim3> body;
    body.name = "cart";
    body.position = {0, 0.42, 1.9};
    body.sleep_speed = 0;
    rigid::ShapeDef<Dim3> shape;
    shape.filter.group = -2;
    shape.density = 500;
    rigid::ShapeDef<Dim3> cabin = shape;
    cabin.local.p = {-0.1f, 0.2f, 0};
    cabin.density = 100;
    chassis_ = stage.add(
        body,
        {{geometry::Box{{0.72f, 0.06f, 0.26f}, 0.04f}, shape}, {geometry::Box{{0.3f, 0.12f, 0.22f}, 0.04f}, cabin}},
        blue);
    for (int k = 0; k < 4; ++k) {
      const Vec3d at{k < 2 ? half_base_ : -half_base_, -0.2, k % 2 == 0 ? 0.36 : -0.36};
      rigid::BodyDef<Dim3> wheel;
      wheel.name = "wheel";
      wheel.position = body.position + at;
      wheel.sleep_speed = 0;
      rigid::ShapeDef<Dim3> tyre;
      tyre.material.friction = 1;
      tyre.filter.group = -2;
      tyre.local.q = from_axis_angle(Vec3f{1, 0, 0}, 0.5f * pi_f);
      const BodyId id = stage.add(wheel, geometry::Cylinder{0.05f, wheel_radius_ - 0.02f, 0.02f}, tyre, dark);
      rigid::JointFrames<Dim3> frames;
      frames.body_a = chassis_, frames.body_b = id;
      frames.frame_a.p = Vec3f(at);
      auto joint = rigid::make_wheel_joint<Dim3>(frames, {stage.valuef("suspension"), 0.5f}, {true, -0.12f, 0.12f});
      joint.angular[1].free = k < 2;
      wheel_joint_[k] = stage.keep(stage.world().create_joint(joint));
    }
  }

  void platform(Stage3& stage) {
    rigid::BodyDef<Dim3> body;
    body.name = "platform";
    const double w = 2 * pi * stage.value("frequency");
    rest_ = 1.2;
    body.position = {rest_x_, rest_ + 0.15, 0};
    body.sleep_speed = 0;
    platform_ = stage.add(body, geometry::Box{{0.6f, 0.04f, 0.4f}, 0.04f}, {}, green);
    rigid::GenericJointDef<Dim3> joint;
    joint.body_b = platform_;
    // Unloaded it would stand g/ω² higher.
    joint.frame_a.p = {float(rest_x_), float(rest_), 0};
    for (int i = 0; i < 3; ++i) {
      joint.linear[i].free = joint.angular[i].free = true;
      joint.linear[i].spring = {stage.valuef("frequency"), 0.01f};
      joint.angular[i].spring = {1.7f * stage.valuef("frequency"), 0.01f};
    }
    joint.linear[1].target = float(9.80665 / (w * w));
    stage.keep(stage.world().create_joint(joint));
    stage.check(stage.world().set_velocity(platform_, {0.3f, 0, 0.2f}, {0.3f, 0.2f, 0.5f}));
  }

  BodyId puck_, chassis_, platform_;
  JointId wheel_joint_[4];
  Trail trail_{0.02, 400}, way_{0.05, 300};
  double lift_ = 0, before_ = 0, first_ = 0, last_ = 0, far_ = 0, turn_ = 0, rest_ = 0;
  int crossings_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_free_axes() { return std::make_unique<FreeAxes>(); }

}  // namespace carom::host::demo
