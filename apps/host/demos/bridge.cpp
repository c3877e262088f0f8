// A bridge of planks whose joints bear only so much.
#include "apps/host/demos/demos.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;
using rigid::JointId;

class Bridge final : public Repeatable<Bridge, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "bridge";
    d.dimension = 2;
    d.title = "A bridge that breaks";
    d.summary = "Planks hinged to a bridge carry a load until a hinge is pulled above what it bears.";
    d.group = "Rigid bodies";
    d.chapter = "13";
    d.text =
        "Every hinge has a break force. After a step whose force was above it the joint is gone and an event tells of "
        "it. A bridge of weight W that sags by f over a span L pulls at its ends with about H = W L/8f along, so a "
        "tight bridge breaks sooner than a slack one. Blocks are put on until it gives way.\n\n"
        "  T = √(H² + (W/2)²)";
    d.duration = 12;
    d.camera = {{0, 1, 14}, {0, 1, 0}};
    d.camera.height = 11;
    d.camera.width = 15;
    d.parameters = {
        {"strength", "Strength of a hinge", "N", "kN", "force above which it breaks", 500, 20000, 0, 6000, false},
        {"load", "Mass of a block", "kg", "kg", "one is dropped every second", 5, 200, 5, 60, false},
    };
    d.plots = {{"Hinges", {"time", "s"}, {"force", "kN"}, {{"strongest pull"}, {"strength"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    rigid::BodyDef<Dim2> pier;
    pier.type = rigid::BodyType::fixed;
    pier.name = "pier";
    pier.position = {-5.5, 0};
    const BodyId left = stage.add(pier, geometry::make_box2({1, 1.5f}), {}, dark);
    pier.position = {5.5, 0};
    const BodyId right = stage.add(pier, geometry::make_box2({1, 1.5f}), {}, dark);
    BodyId before = left;
    for (int i = 0; i < planks_; ++i) {
      rigid::BodyDef<Dim2> plank;
      plank.name = "plank";
      plank.position = {-4.5 + width_ * (i + 0.5), 1.4};
      rigid::ShapeDef<Dim2> shape;
      shape.density = 60;
      const BodyId body = stage.add(plank, geometry::make_box2({float(0.5 * width_), 0.08f}), shape, sand);
      join(stage, before, body, -4.5 + width_ * i);
      before = body;
    }
    join(stage, before, right, 4.5);
  }

  void before_step(Stage2& stage) override {
    const int due = int(stage.world().time());
    if (due <= dropped_ || dropped_ >= 10) return;
    rigid::BodyDef<Dim2> block;
    block.name = "block";
    const int row = dropped_ / 4;
    block.position = {-1.5 + 1.0 * (dropped_ % 4), 2.4 + 0.3 * row};
    rigid::ShapeDef<Dim2> shape;
    shape.density = float(stage.value("load") / (0.5 * 0.5));
    stage.add(block, geometry::make_box2({0.25f, 0.25f}), shape, red);
    ++dropped_;
  }

  void after_step(Stage2& stage) override {
    const double t = stage.world().time();
    double strongest = 0;
    for (const JointId joint : hinges_)
      if (stage.world().contains(joint))
        strongest = max(strongest, double(length(stage.keep(stage.world().joint_state(joint)).force)));
    for (const auto& event : stage.world().events().joint_break) {
      ++broken_;
      weakest_ = min(weakest_, double(length(event.force)));
      stage.say(format("a hinge broke at %.1f kN, under %.0f blocks", 1e-3 * double(length(event.force)), dropped_));
    }
    stage.sample(0, 0, t, 1e-3 * strongest);
    stage.sample(0, 1, t, 1e-3 * stage.value("strength"));
    if (broken_ == 0) held_ = max(held_, strongest);
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    out.push_back({"most a hinge bore before", "N", "no more than its strength", max(held_, stage.value("strength")),
                   stage.value("strength"), 1e-9});
    out.push_back({"the bridge broke", "", "ten blocks are too much", broken_ > 0 ? 1.0 : 0.0, 1, 0});
    out.push_back({"least force that broke one", "N", "above its strength", min(weakest_, stage.value("strength")),
                   stage.value("strength"), 1e-9});
  }

 private:
  static constexpr int planks_ = 18;
  static constexpr double width_ = 9.0 / planks_;

  void join(Stage2& stage, BodyId a, BodyId b, double x) {
    rigid::HingeJointDef<Dim2> hinge;
    hinge.body_a = a;
    hinge.body_b = b;
    hinge.frame_a.p = local_point(stage.at(a).pose, Vec2d{x, 1.4});
    hinge.frame_b.p = local_point(stage.at(b).pose, Vec2d{x, 1.4});
    hinge.break_force = stage.valuef("strength");
    hinges_.push_back(stage.keep(stage.world().create_joint(hinge)));
  }

  std::vector<JointId> hinges_;
  int dropped_ = 0, broken_ = 0;
  double held_ = 0, weakest_ = 1e30;
};

}  // namespace

std::unique_ptr<Demo> make_bridge() { return std::make_unique<Bridge>(); }

}  // namespace carom::host::demo
