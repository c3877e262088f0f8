// Joints that pass motion on: gears, rack and pinion, a screw, a rope over pulleys, a universal joint.
#include "apps/host/demos/demos.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;
using rigid::JointId;

class Machines final : public Repeatable<Machines, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "machines";
    d.title = "Gears, rack, screw, pulley";
    d.summary = "Joints that couple motions: teeth, threads and ropes without teeth, threads or ropes.";
    d.group = "Rigid bodies";
    d.chapter = "13";
    d.text =
        "From left to right: a motor turns a small wheel that meshes with a larger one, and that drives a rack. A "
        "motor turns a nut that climbs its screw by one pitch a turn. A rope over two pulleys carries 3 and 2 kg "
        "(Atwood's machine). A universal joint between two shafts at an angle β: the driven one speeds up and slows "
        "down twice a turn, between ω cos β and ω/cos β.\n\n"
        "  ω₂ = ratio ω₁      v = radius ω      a = g (m₁ − m₂)/(m₁ + m₂)";
    d.duration = 6;
    d.dt = 1.0 / 60;
    d.camera = {{0, 2.4, 13}, {0, 1.8, 0}, 0.75};
    d.ground = 0;
    d.parameters = {
        {"speed", "Speed of the motors", "rad/s", "rad/s", "of wheel, nut and shaft", -8, 8, 0.1, 2, true},
        {"ratio", "Teeth, large : small", "", "", "how much slower the large wheel turns", 1, 4, 0.5, 2, false},
        {"pitch", "Pitch of the screw", "m", "cm", "a turn", 0.02, 0.3, 0, 0.1, false},
        {"angle", "Angle of the shafts", "rad", "deg", "of the universal joint", 0, 0.9, 0, radians(35.0), false},
    };
    d.plots = {{"Wheels", {"time", "s"}, {"speed", "rad/s"}, {{"small"}, {"large"}}},
               {"Along", {"time", "s"}, {"way", "m"}, {{"rack"}, {"nut"}, {"3 kg"}}},
               {"Shafts", {"time", "s"}, {"speed", "rad/s"}, {{"driving"}, {"driven"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.allow_sleep = false;
    stage.start(world);
    stage.floor(0);
    wheels(stage);
    screw(stage);
    rope(stage);
    shafts(stage);
    changed(stage, "speed");
  }

  void changed(Stage3& stage, std::string_view) override {
    for (const JointId motor : {small_hinge_, shaft_hinge_})
      stage.check(stage.world().set_motor(motor, {true, stage.valuef("speed"), 2000}));
    rigid::JointAxis turn;
    turn.free = true;
    turn.motor = {true, stage.valuef("speed"), 2000};
    stage.check(stage.world().set_axis(nut_joint_, 3, turn));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const auto spin = [&](BodyId body) { return double(stage.at(body).angular_velocity.z); };
    stage.sample(0, 0, t, spin(small_));
    stage.sample(0, 1, t, spin(large_));
    stage.sample(1, 0, t, stage.at(rack_).pose.position.x - rack_start_);
    stage.sample(1, 1, t, stage.at(nut_).pose.position.y - nut_start_);
    stage.sample(1, 2, t, stage.at(heavy_).pose.position.y - 2.6);
    const double driven = double(dot(stage.at(driven_).angular_velocity, axis_));
    stage.sample(2, 0, t, spin(driving_));
    stage.sample(2, 1, t, driven);
    if (t > 1) slowest_ = min(slowest_, driven), fastest_ = max(fastest_, driven);
    turned_ += double(stage.at(nut_).angular_velocity.y) * stage.declaration().dt;
    if (t < 0.501) fallen_ = 2.6 - stage.at(heavy_).pose.position.y, fall_time_ = t;
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double speed = stage.value("speed"), ratio = stage.value("ratio"), c = cos(stage.value("angle"));
    const auto spin = [&](BodyId body) { return double(stage.at(body).angular_velocity.z); };
    out.push_back({"speed of the large wheel", "rad/s", "−ω/ratio", spin(large_), -speed / ratio, 0.01});
    out.push_back({"speed of the rack", "m/s", "radius · ω", stage.at(rack_).linear_velocity.x,
                   -large_radius() * spin(large_), 0.01});
    out.push_back({"way of the nut a turn", "m", "its pitch",
                   (stage.at(nut_).pose.position.y - nut_start_) * 2 * pi / turned_, stage.value("pitch"), 0.002});
    out.push_back({"fall of the 3 kg in half a second", "m", "½ g (3 − 2)/(3 + 2) t²", fallen_,
                   0.5 * 9.80665 / 5 * square(fall_time_), 0.01});
    out.push_back({"slowest of the driven shaft", "rad/s", "ω cos β", slowest_, speed * c, 0.05});
    out.push_back({"fastest of the driven shaft", "rad/s", "ω/cos β", fastest_, speed / c, 0.05});
  }

 private:
  double large_radius() const { return 0.9; }

  static BodyId part(Stage3& stage, const char* name, Vec3d at, const geometry::Shape3& shape, std::uint32_t color,
                     Quatf form = {}, float density = 200) {
    rigid::BodyDef<Dim3> definition;
    definition.name = name;
    definition.position = at;
    rigid::ShapeDef<Dim3> surface;
    surface.density = density;
    surface.filter.group = -1;
    surface.local.q = form;
    return stage.add(definition, shape, surface, color);
  }
  /// A hinge to the world where the body is, about `axis`.
  static JointId axle(Stage3& stage, BodyId body, Vec3f axis = {0, 0, 1}) {
    rigid::HingeJointDef<Dim3> hinge;
    hinge.body_b = body;
    hinge.frame_a = {Vec3f(stage.at(body).pose.position), from_to(Vec3f{0, 0, 1}, axis)};
    hinge.frame_b.q = hinge.frame_a.q;
    return stage.keep(stage.world().create_joint(hinge));
  }

  void wheels(Stage3& stage) {
    const Quatf facing = from_axis_angle(Vec3f{1, 0, 0}, float(0.5 * pi));  // cylinders stand along y
    const double r = large_radius() / stage.value("ratio");
    small_ = part(stage, "small wheel", {-4.4 - large_radius() - r, 2, 0}, geometry::Cylinder{0.12f, float(r)}, blue,
                  facing);
    large_ = part(stage, "large wheel", {-4.4, 2, 0}, geometry::Cylinder{0.12f, float(large_radius())}, orange, facing);
    rack_start_ = -3.6;
    rack_ = part(stage, "rack", {rack_start_, 2 + large_radius() + 0.1, 0}, geometry::Box{{1.8f, 0.1f, 0.12f}}, gold);
    small_hinge_ = axle(stage, small_);
    axle(stage, large_);
    rigid::GearJointDef<Dim3> gear;
    gear.body_a = small_;
    gear.body_b = large_;
    gear.ratio = float(-1 / stage.value("ratio"));
    stage.keep(stage.world().create_joint(gear));
    rigid::SliderJointDef<Dim3> slide;
    slide.body_b = rack_;
    slide.frame_a.p = Vec3f(stage.at(rack_).pose.position);
    stage.keep(stage.world().create_joint(slide));
    rigid::RackJointDef<Dim3> rack;
    rack.body_a = large_;
    rack.body_b = rack_;
    rack.radius = float(-large_radius());
    stage.keep(stage.world().create_joint(rack));
  }

  void screw(Stage3& stage) {
    nut_start_ = 0.8;
    rigid::BodyDef<Dim3> post;
    post.type = rigid::BodyType::fixed;
    post.name = "screw";
    post.position = {-0.6, 1.8, 0};
    rigid::ShapeDef<Dim3> through;
    through.filter.group = -1;
    stage.add(post, geometry::Cylinder{1.8f, 0.08f}, through, steel);
    nut_ = part(stage, "nut", {-0.6, nut_start_, 0}, geometry::Box{{0.35f, 0.12f, 0.35f}}, green);
    const Quatf up = from_to(Vec3f{1, 0, 0}, Vec3f{0, 1, 0});
    rigid::JointFrames<Dim3> frames;
    frames.body_b = nut_;
    frames.frame_a = {Vec3f(stage.at(nut_).pose.position), up};
    frames.frame_b.q = up;
    nut_joint_ = stage.keep(stage.world().create_joint(rigid::make_cylindrical_joint<Dim3>(frames)));
    rigid::ScrewJointDef<Dim3> thread{frames};
    thread.pitch = stage.valuef("pitch");
    stage.keep(stage.world().create_joint(thread));
  }

  void rope(Stage3& stage) {
    const float density = float(1 / (8 * 0.2 * 0.2 * 0.2));  // 1 kg
    heavy_ = part(stage, "3 kg", {1.4, 2.6, 0}, geometry::Box{{0.2f, 0.2f, 0.2f}}, red, {}, 3 * density);
    light_ = part(stage, "2 kg", {2.4, 2.0, 0}, geometry::Box{{0.2f, 0.2f, 0.2f}}, violet, {}, 2 * density);
    rigid::PulleyJointDef<Dim3> rope;
    rope.body_a = heavy_;
    rope.body_b = light_;
    rope.ground_a = {1.4, 4.6, 0};
    rope.ground_b = {2.4, 4.6, 0};
    rope.length = 2.0f + 2.6f;
    stage.keep(stage.world().create_joint(rope));
    for (const BodyId body : {heavy_, light_}) {  // on rails, so that they do not swing
      rigid::SliderJointDef<Dim3> rail;
      rail.body_b = body;
      const Quatf up = from_to(Vec3f{1, 0, 0}, Vec3f{0, 1, 0});
      rail.frame_a = {Vec3f(stage.at(body).pose.position), up};
      rail.frame_b.q = up;
      rail.limit = {true, -1.6f, 1.9f};
      stage.keep(stage.world().create_joint(rail));
    }
  }

  void shafts(Stage3& stage) {
    const double b = stage.value("angle");
    axis_ = Vec3f(float(-sin(b)), 0, float(cos(b)));
    const Quatf facing = from_axis_angle(Vec3f{1, 0, 0}, float(0.5 * pi));
    const Vec3d middle{5, 2, 0};
    driving_ = part(stage, "driving shaft", middle + Vec3d{0, 0, -0.7}, geometry::Cylinder{0.6f, 0.15f}, blue, facing);
    const Quatf aside = from_to(Vec3f{0, 0, 1}, axis_);
    driven_ = part(stage, "driven shaft", middle + 0.7 * Vec3d(axis_), geometry::Cylinder{0.6f, 0.15f}, orange,
                   aside * facing);
    shaft_hinge_ = axle(stage, driving_);
    axle(stage, driven_, axis_);
    // The joint's x turns with the driving shaft, its z with the driven one; both lie across their shafts.
    rigid::JointFrames<Dim3> frames;
    frames.body_a = driving_;
    frames.body_b = driven_;
    const Quatf across = from_axis_angle(Vec3f{1, 0, 0}, float(0.5 * pi));  // x across A, z along −y
    frames.frame_a = {Vec3f{0, 0, 0.7f}, across};
    frames.frame_b = {-0.7f * axis_, across};
    stage.keep(stage.world().create_joint(rigid::make_universal_joint<Dim3>(frames)));
  }

  BodyId small_, large_, rack_, nut_, heavy_, light_, driving_, driven_;
  JointId small_hinge_, shaft_hinge_, nut_joint_;
  Vec3f axis_{0, 0, 1};
  double rack_start_ = 0, nut_start_ = 0, turned_ = 0, fallen_ = 0, fall_time_ = 0, slowest_ = 1e9, fastest_ = -1e9;
};

}  // namespace

std::unique_ptr<Demo> make_machines() { return std::make_unique<Machines>(); }

}  // namespace carom::host::demo
