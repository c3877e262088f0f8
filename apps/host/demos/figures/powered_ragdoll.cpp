// A ragdoll with muscles holds its poses on a rig that carries it about; its twin has none.
#include "apps/host/demos/figures/figure.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class PoweredRagdoll final : public Repeatable<PoweredRagdoll, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "powered_ragdoll";
    d.title = "A ragdoll with muscles";
    d.summary =
        "Carried by the hips, it changes its pose and holds it, whatever shakes or strikes it. Its twin is limp.";
    d.group = "Characters";
    d.text =
        "Every joint of the left figure has a muscle: a frequency f, a damping ratio and a greatest torque. The "
        "torques "
        "come from inverse dynamics (Newton and Euler, link by link: outward the accelerations, inward the forces that "
        "they take), with gravity and what touched the figure a moment ago,\n\n"
        "  τ = M(q) q̈ + c(q, q̇) + g(q),  q̈ = −2ζω q̇ − ω² (q − q_d)\n\n"
        "so an arm holds its pose as stiffly as a leg, whatever hangs on it, and does not sag. The limits of torque "
        "are "
        "those of a strong person: too fast a swing, or a hand that pulls, and a limb gives way.\n\n"
        "Throw balls at it, pull it with the mouse, shake the rig, or let its muscles go.";
    d.duration = 14;
    d.camera = {{4.2, 1.9, 3.4}, {0, 0.9, 0.6}};
    d.ground = -0.6;
    d.parameters = {
        {"sway", "Sway of the rig", "m", "cm", "up and down, half of the whole way", 0, 0.4, 0.01, 0.1, true},
        {"period", "Period of the sway", "s", "s", "", 0.7, 8, 0.1, 2, true},
        {"hertz", "Frequency of the muscles", "Hz", "Hz", "", 0.5, 10, 0.1, 5, true},
        {"strength", "Strength", "", "", "of the torques: 1 is that of a strong person", 0, 2, 0.05, 1, true},
    };
    d.plots = {{"Farthest joint from its pose", {"time", "s"}, {"angle", "deg"}, {{"with muscles"}}},
               {"Torques of the left side", {"time", "s"}, {"torque", "N·m"}, {{"shoulder"}, {"hip"}, {"knee"}}}};
    d.inputs = {{"pose", "Next pose", {"KeyP"}, true, 1}, {"ball", "Throw a ball", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.joint_solver = rigid::JointSolver::direct;
    stage.start(world);
    stage.floor(-0.6);
    for (int k = 0; k < 2; ++k) {
      rigid::BodyDef<Dim3> rig;
      rig.name = "rig";
      rig.type = rigid::BodyType::kinematic;
      rig.position = {-0.3, 1, 1.4 * k};
      rigid::ShapeDef<Dim3> rod;
      rod.filter.mask = 0;
      rig_[k] = stage.add(rig, geometry::Box{{0.16f, 0.02f, 0.02f}, 0.01f}, rod, dark);
      Figure& figure = k == 0 ? strong_ : limp_;
      figure = Figure::create(stage, {0, 0, 1.4 * k}, k == 0 ? orange : steel, k == 0 ? blue : dark, rig_[k]);
    }
    tune(stage);
  }

  void changed(Stage3& stage, std::string_view) override { tune(stage); }

  void before_step(Stage3& stage) override {
    const double dt = stage.declaration().dt, t = stage.world().time(),
                 phase = 2 * pi / stage.value("period") * (t + dt);
    for (int k = 0; k < 2; ++k)
      stage.check(stage.world().set_target_pose(
          rig_[k], {-0.3, 1 + min(1.0, t / 2) * stage.value("sway") * sin(phase), 1.4 * k}, {}, float(dt)));
    if (stage.presses("pose") > 0) ++chosen_;
    strong_.set_pose(stage, poses()[pose_at(t)]);
    stage.check(strong_.mechanism.drive(stage.world(), float(dt)));
    if (stage.presses("ball") > 0 || (t >= 7 && !thrown_)) throw_ball(stage);
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    rigid::Articulation3& m = strong_.mechanism;
    stage.check(m.read(stage.world()));
    const double off = degrees(strong_.farthest_from(poses()[pose_at(t)]));
    stage.sample(0, 0, t, off);
    // A second and more after the last change, and not just after the ball.
    if (t - 3 * floor(t / 3) > 1.5 && (t < 7 || t > 9)) worst_ = max(worst_, off);
    const rigid::JointId left[3] = {strong_.shoulder[0], strong_.hip[0], strong_.knee[0]};
    for (int k = 0; k < 3; ++k) {
      const rigid::ArticulationJoint& j = m.joints()[std::size_t(m.find(left[k]))];
      double size = 0;
      for (int i = 0; i < j.degrees; ++i) size += square(m.torques()[std::size_t(j.first) + std::size_t(i)]);
      stage.sample(1, k, t, sqrt(size));
    }
    constexpr const char* names[] = {"at ease", "arms out", "hands up", "seated"};
    stage.say(format("pose %.0f of 4, farthest joint off by %.1f°", pose_at(t) + 1, off) + std::string(": ") +
              names[pose_at(t)]);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"farthest joint from its pose, once it is taken", "deg", "the pose", worst_, 0, 5});
    const double drop = stage.at(limp_.body[Figure::chest]).pose.position.y - stage.at(rig_[1]).pose.position.y;
    out.push_back({"the limp one's chest, against its hips", "", "hangs or leans", drop < 0.29 ? 1.0 : 0.0, 1, 0});
  }

 private:
  static const Pose* poses() {
    static const Pose all[4] = {
        {{}, {}, {{0.1, 0, 0}, {-0.1, 0, 0}}, {}, {}, {0.2, 0.2}, {}},
        {{}, {}, {{1.5, 0, 0}, {-1.5, 0, 0}}, {}, {}, {0.1, 0.1}, {}},
        {{0, 0, 0.1}, {0, 0, 0.2}, {{0, 0, 2.7}, {0, 0, 2.7}}, {}, {}, {0.3, 0.3}, {}},
        {{0, 0, -0.3},
         {0, 0, 0.2},
         {{0, 0, 1.4}, {0, 0, 1.4}},
         {{0, 0, 0.9}, {0, 0, 0.9}},
         {{0, 0, 0.6}, {0, 0, 0.6}},
         {0.3, 0.3},
         {1.4, 1.4}},
    };
    return all;
  }
  int pose_at(double t) const { return (chosen_ + int(t / 3)) % 4; }
  void tune(Stage3& stage) {
    const double strength = stage.value("strength"), hertz = stage.value("hertz");
    rigid::Articulation3& m = strong_.mechanism;
    const auto set = [&](rigid::JointId joint, double torque) {
      stage.check(m.set_muscle(m.find(joint), {strength > 0 ? hertz : 0, 1, max(strength * torque, 1e-3)}));
    };
    set(strong_.waist, 300), set(strong_.neck, 50);
    for (int k = 0; k < 2; ++k) {
      set(strong_.shoulder[k], 120), set(strong_.elbow[k], 80), set(strong_.hip[k], 350);
      set(strong_.knee[k], 300), set(strong_.ankle[k], 180);
    }
  }
  void throw_ball(Stage3& stage) {
    thrown_ = true;
    rigid::BodyDef<Dim3> ball;
    ball.name = "ball";
    ball.position = stage.at(strong_.body[Figure::chest]).pose.position + Vec3d{-2.5, 0.35, 0.05};
    ball.linear_velocity = {6, 0.8f, 0};
    rigid::ShapeDef<Dim3> d;
    d.density = 60;
    stage.add(ball, geometry::Sphere{0.16f}, d, red);
  }

  BodyId rig_[2];
  Figure strong_, limp_;
  double worst_ = 0;
  int chosen_ = 0;
  bool thrown_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_powered_ragdoll() { return std::make_unique<PoweredRagdoll>(); }

}  // namespace carom::host::demo
