// Two figures stand on their own feet and are pushed. One minds its balance.
#include "apps/host/demos/figures/balance.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

class Standing final : public Repeatable<Standing, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "standing";
    d.title = "Standing on one's own feet";
    d.summary =
        "Two figures are pushed. The one that minds its balance stays up; the other holds its pose and topples.";
    d.group = "Characters";
    d.text =
        "Nothing holds these figures but their feet. Muscles keep both in a pose. But a pose is no balance: who leans "
        "out over his toes falls as stiffly as a statue. What counts is the capture point, where one must be held to "
        "come to rest: with the centre of mass at x over the feet, its speed v and its height h,\n\n"
        "  ξ = x + v/ω,  ω = √(g/h)\n\n"
        "As long as ξ is over the feet, pressing the ground beyond it brings the body back. So the left figure turns "
        "its ankles (and, sideways, its hips) in proportion to ξ, within the torque that an ankle has. A push of p N·s "
        "moves ξ by p/(m ω): feet of 26 cm bear about 20 N·s from behind, less from the front.\n\n"
        "Push them, throw something at them, or take the balance away.";
    d.duration = 12;
    d.camera = {{3.4, 1.7, 3.2}, {0, 0.85, 0.5}};
    d.ground = 0;
    d.parameters = {
        {"gain", "Balance", "rad/m", "rad/m", "turn of the ankles for a metre that ξ is off; 0: none", 0, 6, 0.1, 2,
         true},
        {"push", "Push", "N*s", "N·s", "on the chest, every four seconds", 0, 40, 1, 10, true},
        {"strength", "Strength", "", "", "of the torques: 1 is that of a strong person", 0.1, 2, 0.05, 1, true},
    };
    d.plots = {{"Capture point over the feet",
                {"time", "s"},
                {"ξ", "cm"},
                {{"forward"}, {"aside"}, {"forward, without balance"}}},
               {"Height of the head", {"time", "s"}, {"height", "m"}, {{"with balance"}, {"without"}}}};
    d.inputs = {{"push", "Push from behind", {"Space"}, true, 1},
                {"push_back", "Push from the front", {"KeyB"}, true, 1},
                {"push_aside", "Push from the side", {"KeyN"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.joint_solver = rigid::JointSolver::direct;
    stage.start(world);
    stage.floor(0, {.friction = 0.9f});
    for (int k = 0; k < 2; ++k) {
      figure_[k] = Figure::create(stage, {0, 0, 1.3 * k}, k == 0 ? orange : steel, k == 0 ? blue : dark, {});
      tune(stage, figure_[k]);
    }
  }

  void changed(Stage3& stage, std::string_view) override {
    for (Figure& figure : figure_) tune(stage, figure);
  }

  void before_step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    for (int k = 0; k < 2; ++k) {
      Figure& figure = figure_[k];
      stage.check(figure.mechanism.read(stage.world()));
      balance_[k].look(stage, figure);
      Pose pose = at_ease();
      if (k == 0) balance_[k].correct(pose, stage.value("gain"));
      figure.set_pose(stage, pose);
      stage.check(figure.mechanism.drive(stage.world(), float(dt)));
    }
    const std::uint64_t step = stage.world().step_count();
    constexpr Vec3f ways[] = {{1, 0, 0}, {0, 0, 0.7f}, {-0.6f, 0, 0}};
    if (step > 0 && step % 240 == 180) push(stage, ways[step / 240 % 3]);
    if (stage.presses("push") > 0) push(stage, ways[0]);
    if (stage.presses("push_aside") > 0) push(stage, ways[1]);
    if (stage.presses("push_back") > 0) push(stage, {-1, 0, 0});
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    stage.sample(0, 0, t, 100 * balance_[0].forward);
    stage.sample(0, 1, t, 100 * balance_[0].aside);
    stage.sample(0, 2, t, 100 * balance_[1].forward);
    for (int k = 0; k < 2; ++k) {
      const double head = stage.at(figure_[k].body[Figure::head]).pose.position.y;
      stage.sample(1, k, t, head);
      lowest_[k] = min(lowest_[k], head);
      // The capture point on the ground.
      const Vec3d feet = 0.5 * (stage.at(figure_[k].body[Figure::foot]).pose.position +
                                stage.at(figure_[k].body[Figure::foot + 1]).pose.position);
      const Vec3d mark{feet.x + balance_[k].forward, 0.01, feet.z + balance_[k].aside};
      const std::uint32_t color = pen(k == 0 ? green : red);
      stage.line(mark - Vec3d{0.06, 0, 0}, mark + Vec3d{0.06, 0, 0}, color);
      stage.line(mark - Vec3d{0, 0, 0.06}, mark + Vec3d{0, 0, 0.06}, color);
      if (hit_ > 0) stage.line(from_[k], from_[k] + way_, pen(red));
    }
    if (hit_ > 0) --hit_;
    stage.say(format("ξ is %.1f cm ahead of the feet's middle, %.1f cm aside", 100 * balance_[0].forward,
                     100 * balance_[0].aside));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"lowest place of the head that minds its balance", "m", "it stands, through three pushes",
                   lowest_[0], 1.62, 0.08});
    (void)stage;
  }

 private:
  static Pose at_ease() {
    Pose pose;
    for (int k = 0; k < 2; ++k) {
      pose.hip[k] = {0, 0, 0.1}, pose.knee[k] = 0.2, pose.ankle[k] = {0, 0, 0.1};
      pose.shoulder[k] = {k == 0 ? 0.15 : -0.15, 0, 0.1}, pose.elbow[k] = 0.25;
    }
    return pose;
  }
  void tune(Stage3& stage, Figure& figure) {
    const double strength = stage.value("strength");
    rigid::Articulation3& m = figure.mechanism;
    const auto set = [&](rigid::JointId joint, double hertz, double torque) {
      stage.check(m.set_muscle(m.find(joint), {hertz, 1, strength * torque}));
    };
    set(figure.waist, 5, 300), set(figure.neck, 5, 50);
    for (int k = 0; k < 2; ++k) {
      set(figure.shoulder[k], 3, 120), set(figure.elbow[k], 3, 80), set(figure.hip[k], 5, 350);
      set(figure.knee[k], 5, 300), set(figure.ankle[k], 4, 180);
    }
  }
  void push(Stage3& stage, Vec3f way) {
    for (int k = 0; k < 2; ++k) {
      const auto chest = stage.at(figure_[k].body[Figure::chest]);
      stage.check(stage.world().add_impulse(figure_[k].body[Figure::chest], way * stage.valuef("push")));
      from_[k] = chest.pose.position - Vec3d(way) * 0.8;
      way_ = Vec3d(way) * 0.6;
    }
    hit_ = 25;
  }

  Figure figure_[2];
  Balance balance_[2];
  Vec3d from_[2]{}, way_{};
  double lowest_[2] = {9, 9};
  int hit_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_standing() { return std::make_unique<Standing>(); }

}  // namespace carom::host::demo
