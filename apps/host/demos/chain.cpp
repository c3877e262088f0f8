// A light chain under a heavy load: what soft joints make of a mass ratio.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Chain final : public Repeatable<Chain, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "chain";
    d.title = "Chain and load";
    d.summary = "Twenty links of 1 kg carry a ball up to a thousand times as heavy. Pull at it, and watch the joints.";
    d.group = "Rigid bodies";
    d.chapter = "13";
    d.text =
        "An iterative solver passes a load from joint to joint; the heavier the load beside a link, the more it takes "
        "until the top of the chain knows of it. The plot shows the worst gap at any joint. The force in the top joint "
        "must be the weight of everything below it.\n\n"
        "  F = (n m + M) g\n\n"
        "Direct solvers and more substeps close the gap; `docs/quality.md` has the numbers.";
    d.duration = 10;
    d.camera = {{4, -4, 17}, {0, -5, 0}};
    d.parameters = {
        {"ratio", "Load", "", "", "mass of the ball in links", 1, 1000, 1, 100, false},
        {"links", "Links", "", "", "", 5, 40, 1, 20, false},
        {"angle", "Drawn aside by", "rad", "deg", "from straight down, at the start", 0, 1.2, 0, 0, false},
    };
    d.plots = {{"Gap", {"time", "s"}, {"worst gap at a joint", "mm"}, {{"chain"}}},
               {"Force in the top joint", {"time", "s"}, {"force", "kN"}, {{"joint"}, {"weight below it"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    const int links = stage.count("links");
    const double angle = stage.value("angle"), length = 0.5;
    const Vec3d along{sin(angle), -cos(angle), 0};
    const Quatf tilt{float(cos(0.5 * angle)), 0, 0, float(sin(0.5 * angle))};
    rigid::BodyDef<Dim3> hook;
    hook.type = rigid::BodyType::fixed;
    hook.name = "hook";
    BodyId last = stage.add(hook, geometry::Box{{0.6f, 0.1f, 0.3f}}, {}, dark);
    const float half = float(0.5 * length);
    for (int i = 0; i < links; ++i) {
      rigid::BodyDef<Dim3> body;
      body.name = "link";
      body.position = along * (length * (i + 0.5));
      body.rotation = tilt;
      const geometry::Capsule3 form{half - 0.06f, 0.06f};
      const BodyId link = stage.add(body, form, surface(1, pi * 0.0036 * (2 * (half - 0.06) + 0.08)), steel);
      const rigid::JointId joint = join(stage, last, {0, i == 0 ? 0 : -half, 0}, link, {0, half, 0});
      if (i == 0) top_ = joint;
      last = link;
    }
    const double mass = stage.value("ratio"), radius = 0.12 * cbrt(mass);
    rigid::BodyDef<Dim3> ball;
    ball.name = "load";
    ball.position = along * (length * links + radius);
    ball.rotation = tilt;
    const BodyId load =
        stage.add(ball, geometry::Sphere{float(radius)}, surface(mass, 4.0 / 3 * pi * radius * radius * radius), red);
    join(stage, last, {0, -half, 0}, load, {0, float(radius), 0});
    weight_ = (links + mass) * 9.80665;
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    stage.sample(0, 0, t, 1e3 * double(stage.world().worst_joint_error()));
    force_ = length(Vec3d(stage.keep(stage.world().joint_state(top_)).force));
    stage.sample(1, 0, t, 1e-3 * force_);
    stage.sample(1, 1, t, 1e-3 * weight_);
    if (t > 5) sum_ += force_, ++count_;
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"mean force in the top joint", "N", "(n m + M) g", sum_ / max(count_, 1), weight_, 0.01 * weight_});
  }

 private:
  static rigid::ShapeDef<Dim3> surface(double mass, double volume) {
    rigid::ShapeDef<Dim3> shape;
    shape.density = float(mass / volume);
    shape.filter.group = -1;
    return shape;
  }
  static rigid::JointId join(Stage3& stage, BodyId a, Vec3f at_a, BodyId b, Vec3f at_b) {
    rigid::BallJointDef<Dim3> joint;
    joint.body_a = a;
    joint.body_b = b;
    joint.frame_a.p = at_a;
    joint.frame_b.p = at_b;
    return stage.keep(stage.world().create_joint(joint));
  }

  rigid::JointId top_;
  double weight_ = 0, force_ = 0, sum_ = 0;
  int count_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_chain() { return std::make_unique<Chain>(); }

}  // namespace carom::host::demo
