// A robot arm that draws a figure of eight with a load in its hand: inverse dynamics as feed-forward, and without it.
#include "apps/host/demos/figures/list.h"
#include "carom/math/rotation.h"
#include "carom/rigid/articulation.h"

namespace carom::host::demo {
namespace {

using rigid::Articulation3;
using rigid::BodyId;
using rigid::Dim3;

class RobotArm final : public Repeatable<RobotArm, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "robot_arm";
    d.title = "A robot arm on its path";
    d.summary =
        "An arm draws a figure of eight with a load in its hand. Take the feed-forward away, or hang more on it.";
    d.group = "Joints";
    d.text =
        "Which torques make an arm move as it should? Newton and Euler, link by link: outward the accelerations, "
        "inward "
        "the forces that they take (inverse dynamics),\n\n"
        "  τ = M(q) q̈ + c(q, q̇) + g(q)\n\n"
        "The muscle of each joint asks for the acceleration of its target and, for what error is left, that of an "
        "oscillator of its own frequency f and damping ratio ζ, whatever hangs on the joint:\n\n"
        "  q̈ = q̈_d − 2ζω (q̇ − q̇_d) − ω² (q − q_d),  ω = 2πf\n\n"
        "So a soft muscle follows a fast path. Without feed-forward it knows nothing of q̈_d and q̇_d and lags behind; a "
        "limit of torque that is too low lets the hand sink. The red curve is the path, the orange one the hand's.";
    d.duration = 12;
    d.camera = {{2.6, 2.3, 3.4}, {0.4, 0.9, 0}};
    d.ground = 0;
    d.parameters = {
        {"period", "Period of the path", "s", "s", "", 0.8, 6, 0.1, 2, true},
        {"hertz", "Frequency of the muscles", "Hz", "Hz", "f", 0.2, 8, 0.1, 2, true},
        {"damping", "Damping ratio", "", "", "ζ", 0.1, 2, 0.05, 1, true},
        yes_or_no("feed", "Feed-forward", "speeds and accelerations of the path are known, or only the place", true,
                  true),
        {"limit", "Greatest torque", "N·m", "N·m", "of each joint", 20, 2000, 10, 600, true},
        {"load", "Load in the hand", "kg", "kg", "", 0.5, 40, 0.5, 10, false},
    };
    d.plots = {{"Hand off its path", {"time", "s"}, {"distance", "mm"}, {{"hand"}}},
               {"Torques", {"time", "s"}, {"torque", "N·m"}, {{"column"}, {"shoulder"}, {"elbow"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.joint_solver = rigid::JointSolver::direct;
    stage.start(world);
    stage.floor(0);
    const Quatf upward = from_axis_angle(Vec3f{1, 0, 0}, -0.5f * pi_f);  // z of the frame along y
    const BodyId base = part(stage, "base", {0, 0.1, 0}, geometry::Cylinder{0.06f, 0.22f, 0.04f}, 1000, dark, true);
    const BodyId column = part(stage, "column", {0, 0.45, 0}, geometry::Cylinder{0.2f, 0.09f, 0.04f}, 800, steel);
    const BodyId upper =
        part(stage, "upper arm", {upper_ / 2, shoulder_, 0}, geometry::Box{{0.34f, 0.05f, 0.05f}, 0.03f}, 800, orange);
    const BodyId fore = part(stage, "forearm", {upper_ + fore_ / 2, shoulder_, 0},
                             geometry::Box{{0.3f, 0.03f, 0.03f}, 0.03f}, 800, gold);
    const float r = 0.09f;
    hand_ = part(stage, "load", {upper_ + fore_, shoulder_, 0}, geometry::Sphere{r},
                 stage.valuef("load") / (4.0f / 3 * pi_f * r * r * r), blue);
    hinge(stage, base, column, {0, 0.2, 0}, upward);
    hinge(stage, column, upper, {0, shoulder_, 0}, {});
    hinge(stage, upper, fore, {upper_, shoulder_, 0}, {});
    rigid::WeldJointDef<Dim3> weld;
    weld.body_a = fore, weld.body_b = hand_;
    weld.frame_a.p = {float(fore_ / 2), 0, 0};
    (void)stage.keep(stage.world().create_joint(weld));
    // It begins on its path.
    const core::Result<Articulation3> arm = Articulation3::create(stage.world(), column);
    if (!arm.ok()) return stage.fail(arm.error());
    arm_ = arm.value();
    place(stage, column, upper, fore);
    stage.check(arm_.read(stage.world()));
    tune(stage);
    for (int i = 0; i <= 200; ++i) path_.push_back(wanted(phase_of(i / 200.0)));
  }

  void changed(Stage3& stage, std::string_view name) override {
    if (name == "period") begin_ = stage.world().time(), begin_phase_ = phase_;
    tune(stage);
  }

  void before_step(Stage3& stage) override {
    const double dt = stage.declaration().dt, rate = 2 * pi / stage.value("period");
    phase_ = begin_phase_ + rate * (stage.world().time() + dt - begin_);
    // The target at the end of the step, with its speed and acceleration by differences.
    const double h = 1e-3, feed = stage.value("feed");
    const Vec3d before = angles(wanted(phase_ - rate * h)), now = angles(wanted(phase_)),
                after = angles(wanted(phase_ + rate * h));
    const Vec3d speed = (after - before) * (0.5 / h), bend = (after - 2.0 * now + before) * (1 / (h * h));
    for (int j = 0; j < 3; ++j) stage.check(arm_.set_target(j, now[j], feed * speed[j], feed * bend[j]));
    stage.check(arm_.drive(stage.world(), float(dt)));
    for (int j = 0; j < 3; ++j) stage.sample(1, j, stage.world().time(), arm_.torques()[std::size_t(j)]);
  }

  void after_step(Stage3& stage) override {
    const Vec3d hand = stage.at(hand_).pose.position;
    const double off = length(hand - wanted(phase_));
    stage.sample(0, 0, stage.world().time(), 1000 * off);
    worst_ = max(worst_, off);
    trail_.add(hand);
    for (std::size_t i = 1; i < path_.size(); ++i) stage.line(path_[i - 1], path_[i], pen(red, 0x90));
    trail_.draw(stage, pen(orange));
    stage.say(format("off the path by %.1f mm; farthest %.1f mm", 1000 * off, 1000 * worst_));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"farthest off the path", "mm", "the path", 1000 * worst_, 0, 8});
    const double need = 10 * 9.80665 * 0.5;  // the load alone at half a metre
    out.push_back(
        {"torque of the shoulder at least", "N·m", "m g r of the load", arm_.torques()[1] > need ? 1.0 : 0.0, 1, 0});
  }

 private:
  static constexpr double upper_ = 0.8, fore_ = 0.7, shoulder_ = 0.75;

  static double phase_of(double turn) { return 2 * pi * turn; }
  /// Gerono's lemniscate, upright and curved about the column.
  static Vec3d wanted(double phase) {
    const double s = sin(phase), aside = 0.9 * s, radius = 0.95;
    return {radius * cos(aside), 0.95 + 0.35 * s * cos(phase) * 2, -radius * sin(aside)};
  }
  /// Turn of the column, lift of the upper arm, bend of the elbow: the law of cosines.
  static Vec3d angles(Vec3d p) {
    const double r = sqrt(p.x * p.x + p.z * p.z), y = p.y - shoulder_;
    const double c = clamp((r * r + y * y - upper_ * upper_ - fore_ * fore_) / (2 * upper_ * fore_), -1.0, 1.0);
    const double bend = -acos(c);
    return {atan2(-p.z, p.x), atan2(y, r) - atan2(fore_ * sin(bend), upper_ + fore_ * cos(bend)), bend};
  }
  BodyId part(Stage3& stage, const char* name, Vec3d at, const geometry::Shape3& shape, float density,
              std::uint32_t color, bool fixed = false) {
    rigid::BodyDef<Dim3> body;
    body.name = name;
    body.position = at;
    if (fixed) body.type = rigid::BodyType::fixed;
    rigid::ShapeDef<Dim3> d;
    d.density = density;
    d.filter.group = -1;
    return stage.add(body, shape, d, color);
  }
  void hinge(Stage3& stage, BodyId a, BodyId b, Vec3d point, Quatf frame) {
    rigid::HingeJointDef<Dim3> d;
    d.body_a = a, d.body_b = b;
    d.frame_a = {Vec3f(point - stage.at(a).pose.position), frame};
    d.frame_b = {Vec3f(point - stage.at(b).pose.position), frame};
    (void)stage.keep(stage.world().create_joint(d));
  }
  /// Every link where the path begins, at rest: the first moments show how the muscles take up the motion.
  void place(Stage3& stage, BodyId column, BodyId upper, BodyId fore) {
    const Vec3d q = angles(wanted(0));
    const Quatd turn = from_axis_angle(Vec3d{0, 1, 0}, q.x);
    const auto arm = [&](double lift) { return turn * from_axis_angle(Vec3d{0, 0, 1}, lift); };
    const Quatd first = arm(q.y), second = arm(q.y + q.z);
    const Vec3d shoulder{0, shoulder_, 0}, elbow = shoulder + rotate(first, Vec3d{upper_, 0, 0});
    const auto put = [&](BodyId body, Vec3d at, Quatd q) { stage.check(stage.world().set_pose(body, at, Quatf(q))); };
    put(column, {0, 0.45, 0}, turn);
    put(upper, shoulder + rotate(first, Vec3d{upper_ / 2, 0, 0}), first);
    put(fore, elbow + rotate(second, Vec3d{fore_ / 2, 0, 0}), second);
    put(hand_, elbow + rotate(second, Vec3d{fore_, 0, 0}), second);
    // And moving with it.
    const double h = 1e-3, rate = 2 * pi / stage.value("period");
    const Vec3d w = (angles(wanted(rate * h)) - angles(wanted(-rate * h))) * (0.5 / h);
    const Vec3d up{0, w.x, 0}, axis = rotate(turn, Vec3d{0, 0, 1}), a = up + axis * w.y, b = a + axis * w.z;
    const auto move = [&](BodyId body, Vec3d velocity, Vec3d spin) {
      stage.check(stage.world().set_velocity(body, Vec3f(velocity), Vec3f(spin)));
    };
    const Vec3d at_elbow = cross(a, elbow - shoulder);
    move(column, {}, up);
    move(upper, 0.5 * at_elbow, a);
    move(fore, at_elbow + 0.5 * cross(b, rotate(second, Vec3d{fore_, 0, 0})), b);
    move(hand_, at_elbow + cross(b, rotate(second, Vec3d{fore_, 0, 0})), b);
  }
  void tune(Stage3& stage) {
    stage.check(arm_.set_muscles({stage.value("hertz"), stage.value("damping"), stage.value("limit")}));
  }

  Articulation3 arm_;
  BodyId hand_;
  std::vector<Vec3d> path_;
  Trail trail_{0.02, 400};
  double phase_ = 0, begin_ = 0, begin_phase_ = 0, worst_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_robot_arm() { return std::make_unique<RobotArm>(); }

}  // namespace carom::host::demo
