// One stand a type of joint, side by side: what each holds and what it lets go.
#include "apps/host/demos/demos.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Joints final : public Repeatable<Joints, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "joints";
    d.title = "Joints";
    d.summary = "Rod, rope, spring, ball with a cone, driven hinge, slider, weld and motor side by side. Pull at each.";
    d.group = "Rigid bodies";
    d.chapter = "13";
    d.text =
        "From left to right: a rod keeps two points apart. A rope only pulls. A spring has a frequency and a damping "
        "ratio, whatever the mass. A ball joint holds a point and lets its arm swing within a cone. A hinge turns "
        "about "
        "one axis, here with a motor of limited torque. A slider moves along one axis, here on a spring between two "
        "stops. Welds hold everything; these four carry a beam. A motor joint drives a body toward a place and an "
        "attitude with limited force: push it away and it comes back, move the target and it follows.\n\n"
        "Each is a constraint on velocities, solved with the contacts; how far a joint is pulled apart is its "
        "error.\n\n"
        "  T = 2π √(L/g)      f = (1/2π) √(k/m)";
    d.duration = 8;
    d.dt = 1.0 / 60;
    d.camera = {{0, 4.2, 19.5}, {0, 2.5, 0}, 0.75};
    d.ground = 0;
    d.parameters = {
        {"motor_speed", "Speed of the hinge", "rad/s", "rad/s", "that its motor wants", -8, 8, 0.1, 2, true},
        {"motor_torque", "Torque of the hinge", "N*m", "N·m", "the most its motor gives", 0, 2000, 10, 600, true},
        {"spring", "Frequency of the springs", "Hz", "Hz", "of the hung spring and of the slider", 0.3, 4, 0, 0.8,
         false},
        {"damping", "Damping ratio", "", "", "of those springs; 1: no swing", 0, 1, 0, 0.1, false},
        {"cone", "Cone of the ball joint", "rad", "deg", "how far its arm swings aside", 0.1, 1.4, 0, radians(35.0),
         false},
        {"height", "Height of the driven box", "m", "m", "that its motor joint wants, from the middle", -1.5, 1.5, 0.05,
         0.5, true},
        {"turn", "Turn of the driven box", "rad", "deg", "likewise", -3, 3, 0, radians(40.0), true},
    };
    d.plots = {{"Springs", {"time", "s"}, {"height over the ground", "m"}, {{"hung on a spring"}, {"slider"}}},
               {"Hinge", {"time", "s"}, {"speed", "rad/s"}, {{"windmill"}, {"motor wants"}}},
               {"Errors", {"time", "s"}, {"worst joint error", "mm"}, {{"all joints"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    rigid::BodyDef<Dim3> frame;
    frame.type = rigid::BodyType::fixed;
    frame.name = "frame";
    frame.position = {0, height_ + 0.12, 0};
    const auto part = [](Vec3f half, Vec3f at) {
      rigid::ShapeDef<Dim3> shape;
      shape.local.p = at;
      return Stage3::Part{geometry::Box{half}, shape};
    };
    const float leg = 0.5f * float(height_);
    frame_ = stage.add(frame,
                       {part({8.4f, 0.12f, 0.12f}, {}), part({0.12f, leg, 0.12f}, {8.3f, -leg, 0}),
                        part({0.12f, leg, 0.12f}, {-8.3f, -leg, 0})},
                       dark);
    rod_and_rope(stage);
    spring(stage);
    cone(stage);
    windmill(stage);
    slider(stage);
    beam(stage);
    servo(stage);
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    stage.sample(0, 0, t, stage.at(hung_).pose.position.y);
    stage.sample(0, 1, t, stage.at(sled_).pose.position.y);
    stage.sample(1, 0, t, stage.at(mill_).angular_velocity.z);
    stage.sample(1, 1, t, stage.value("motor_speed"));
    stage.sample(2, 0, t, 1e3 * double(stage.world().worst_joint_error()));
    const Vec3d hook{station(1), height_, 0};
    rope_ = max(rope_, distance(stage.at(tied_).pose.position, hook));
    const Vec3f arm = rotate(stage.at(arm_).pose.rotation, {0, -1, 0});
    tilt_ = max(tilt_, double(acos(clamp(-arm.y, -1.0f, 1.0f))));
    travel_ = max(travel_, abs(stage.at(sled_).pose.position.y - sled_middle_));
  }

  void changed(Stage3& stage, std::string_view) override {
    stage.check(stage.world().set_motor(hinge_, {true, stage.valuef("motor_speed"), stage.valuef("motor_torque")}));
    stage.check(stage.world().set_awake(mill_, true));
    stage.check(stage.world().set_target_pose(drive_, wanted_place(stage), wanted_turn(stage)));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"longest the rope was", "m", "a rope of 2.2 m only pulls", rope_, 2.2, 0.02});
    out.push_back({"farthest the arm swung", "deg", "a cone of 35°", degrees(tilt_), 35, 2});
    out.push_back({"speed of the windmill", "rad/s", "its motor wants 2", stage.at(mill_).angular_velocity.z, 2, 0.01});
    // Let go at rest: g/ω² below the middle on average, and as far below that by e^(−π ζ/√(1 − ζ²)).
    const double ring = exp(-pi * 0.1 / sqrt(1 - 0.01)), sag = 9.80665 / square(2 * pi * 0.8);
    out.push_back({"farthest the slider sank", "m", "g/ω² (1 + e^(−πζ/√(1−ζ²)))", travel_, sag * (1 + ring), 0.01});
    out.push_back({"sag of the welded beam", "m", "welds hold", 3.0 - stage.at(tip_).pose.position.y, 0, 0.05});
    // The spring of the motor joint, 2 Hz, gives way under the weight by g/ω².
    out.push_back({"height of the driven box", "m", "its target less g/ω²", stage.at(driven_).pose.position.y,
                   2.6 + 0.5 - 9.80665 / square(2 * pi * 2), 0.005});
    out.push_back({"turn of the driven box", "deg", "its target, 40°",
                   degrees(2 * double(atan2(stage.at(driven_).pose.rotation.z, stage.at(driven_).pose.rotation.w))), 40,
                   0.5});
    out.push_back({"worst joint error", "m", "joints hold", stage.world().worst_joint_error(), 0, 0.005});
  }

 private:
  static constexpr double height_ = 5, sled_middle_ = 2.6;
  static double station(int i) { return -7.35 + 2.1 * i; }

  BodyId body(Stage3& stage, const char* name, Vec3d at, const geometry::Shape3& shape, std::uint32_t color,
              Quatf rotation = {}, float density = 1000) {
    rigid::BodyDef<Dim3> definition;
    definition.name = name;
    definition.position = at;
    definition.rotation = rotation;
    definition.sleep_speed = 0;
    rigid::ShapeDef<Dim3> surface;
    surface.density = density;
    surface.filter.group = -1;  // neighbours swing through one another
    return stage.add(definition, shape, surface, color);
  }
  /// The joint between the frame and a body, at a place of the world; its axes are turned by `turn`.
  template <class Joint>
  rigid::JointId hang(Stage3& stage, Joint joint, BodyId id, Vec3d at, Quatf turn = {}) {
    const auto on = stage.at(frame_), of = stage.at(id);
    joint.body_a = frame_;
    joint.body_b = id;
    joint.frame_a = {local_point(on.pose, at), conjugate(on.pose.rotation) * turn};
    joint.frame_b = {local_point(of.pose, at), conjugate(of.pose.rotation) * turn};
    return stage.keep(stage.world().create_joint(joint));
  }
  rigid::JointId tie(Stage3& stage, rigid::DistanceJointDef<Dim3> joint, BodyId id, Vec3d hook) {
    joint.body_a = frame_;
    joint.body_b = id;
    joint.frame_a.p = local_point(stage.at(frame_).pose, hook);
    return stage.keep(stage.world().create_joint(joint));
  }

  void rod_and_rope(Stage3& stage) {
    rigid::DistanceJointDef<Dim3> rod;
    rod.length = 2.5f;
    const double angle = 0.5;
    const BodyId bob = body(stage, "bob on a rod", {station(0), height_ - 2.5 * cos(angle), 2.5 * sin(angle)},
                            geometry::Sphere{0.35f}, blue);
    tie(stage, rod, bob, {station(0), height_, 0});
    rigid::DistanceJointDef<Dim3> rope;
    rope.length = 2.2f;
    rope.rope = true;
    rope.limit = {true, 0, 2.2f};
    tied_ = body(stage, "ball on a rope", {station(1) + 0.6, height_ - 0.6, 0}, geometry::Sphere{0.35f}, orange);
    tie(stage, rope, tied_, {station(1), height_, 0});
  }

  void spring(Stage3& stage) {
    rigid::DistanceJointDef<Dim3> spring;
    spring.length = 1.6f;
    spring.spring = {stage.valuef("spring"), stage.valuef("damping")};
    hung_ = body(stage, "box on a spring", {station(2), height_ - 1.6, 0}, geometry::Box{{0.35f, 0.35f, 0.35f}}, green);
    tie(stage, spring, hung_, {station(2), height_, 0});
  }

  void cone(Stage3& stage) {
    const Vec3d hook{station(3), height_, 0};
    arm_ = body(stage, "arm of a ball joint", hook - Vec3d{0, 1.1, 0}, geometry::Capsule3{0.9f, 0.18f}, violet);
    rigid::BallJointDef<Dim3> joint;
    joint.cone_angle = stage.valuef("cone");
    // The cone opens about z of the joint's frames: downward.
    hang(stage, joint, arm_, hook, {0.70710678f, 0.70710678f, 0, 0});
    stage.check(stage.world().set_velocity(arm_, {4, 0, 0}, {0, 0, 3.6f}));
  }

  void windmill(Stage3& stage) {
    const Vec3d hub{station(4), 3, 0};
    rigid::BodyDef<Dim3> definition;
    definition.name = "windmill";
    definition.position = hub;
    definition.sleep_speed = 0;
    rigid::ShapeDef<Dim3> wood;
    wood.density = 500;
    wood.filter.group = -1;
    mill_ = stage.add(
        definition, {{geometry::Box{{0.95f, 0.15f, 0.06f}}, wood}, {geometry::Box{{0.15f, 0.95f, 0.06f}}, wood}}, gold);
    rigid::HingeJointDef<Dim3> joint;
    joint.motor = {true, stage.valuef("motor_speed"), stage.valuef("motor_torque")};
    hinge_ = hang(stage, joint, mill_, hub);
  }

  void slider(Stage3& stage) {
    const Vec3d middle{station(5), sled_middle_, 0};
    sled_ = body(stage, "sled of a slider", middle, geometry::Box{{0.5f, 0.3f, 0.4f}}, teal);
    rigid::SliderJointDef<Dim3> joint;
    joint.spring = {stage.valuef("spring"), stage.valuef("damping")};
    joint.limit = {true, -0.9f, 0.9f};
    // It slides along x of the joint's frames: upward.
    hang(stage, joint, sled_, middle, {0.70710678f, 0, 0, 0.70710678f});
    for (const double y : {-1.2, 1.2}) {
      rigid::BodyDef<Dim3> stop;
      stop.type = rigid::BodyType::fixed;
      stop.name = "stop";
      stop.position = middle + Vec3d{0, y + (y > 0 ? 0.06 : -0.06), 0};
      stage.add(stop, geometry::Box{{0.6f, 0.05f, 0.1f}}, {}, steel);
    }
  }

  void beam(Stage3& stage) {
    rigid::BodyDef<Dim3> wall;
    wall.type = rigid::BodyType::fixed;
    wall.name = "wall";
    wall.position = {station(6) - 1.0, 3, 0};
    BodyId last = stage.add(wall, geometry::Box{{0.1f, 0.6f, 0.4f}}, {}, dark);
    Vec3d seam{station(6) - 0.9, 3, 0};
    for (int i = 0; i < 4; ++i) {
      const BodyId next = body(stage, "piece of a beam", seam + Vec3d{0.225, 0, 0},
                               geometry::Box{{0.225f, 0.15f, 0.15f}}, red, {}, 600);
      rigid::WeldJointDef<Dim3> weld;
      weld.body_a = last;
      weld.body_b = next;
      weld.frame_a.p = local_point(stage.at(last).pose, seam);
      weld.frame_b.p = local_point(stage.at(next).pose, seam);
      stage.keep(stage.world().create_joint(weld));
      last = next;
      seam.x += 0.45;
    }
    tip_ = last;
  }

  void servo(Stage3& stage) {
    const Vec3d place{station(7), 2.6, 0};
    driven_ = body(stage, "box of a motor joint", place, geometry::Box{{0.4f, 0.4f, 0.4f}}, sand);
    rigid::MotorJointDef<Dim3> joint;
    joint.max_force = 12000;
    joint.max_torque = 2000;
    joint.target_position = wanted_place(stage);
    joint.target_rotation = wanted_turn(stage);
    drive_ = hang(stage, joint, driven_, place);
  }
  static Vec3f wanted_place(Stage3& stage) { return {0, stage.valuef("height"), 0}; }
  static Quatf wanted_turn(Stage3& stage) {
    const float half = 0.5f * stage.valuef("turn");
    return {cos(half), 0, 0, sin(half)};
  }

  BodyId frame_, tied_, hung_, arm_, mill_, sled_, tip_, driven_;
  rigid::JointId hinge_, drive_;
  double rope_ = 0, tilt_ = 0, travel_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_joints() { return std::make_unique<Joints>(); }

}  // namespace carom::host::demo
