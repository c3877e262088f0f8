// Two towers: one as the world's settings make it, one with the substeps that the adviser asks for.
#include "apps/host/demos/demos.h"
#include "carom/rigid/advice.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class Adviser final : public Repeatable<Adviser, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "adviser";
    d.dimension = 2;
    d.title = "The adviser";
    d.summary = "It predicts how far a tower will sag, and gives the one that needs them more substeps.";
    d.group = "Rigid bodies";
    d.chapter = "16";
    d.text =
        "A contact is a stiff spring of frequency f, and closes under the load P it bears. The solver makes bodies "
        "that "
        "bear much heavier, so that each contact closes by a fraction of a millimetre only. The adviser adds that up "
        "from masses, step and settings. Its cure for the rest is more substeps, which permit stiffer contacts. They "
        "are given to the island of the right tower alone; the left one costs what it did.\n\n"
        "  sag ≈ Σ P/(Σ m_eff ω²),  ω = 2π f";
    d.duration = 8;
    d.camera = {{0, 13, 20}, {0, 13, 0}};
    d.camera.height = 32;
    d.ground = 0;
    d.parameters = {
        {"boxes", "Boxes", "", "", "of each tower", 5, 40, 1, 28, false},
        {"share", "Sag allowed", "", "%", "of the height, before the adviser speaks", 0.0001, 0.01, 0, 0.0003, false},
    };
    d.plots = {{"Sag", {"time", "s"}, {"of the top", "mm"}, {{"left"}, {"right, advised"}, {"predicted, left"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    rigid::WorldDef<Dim2> world;
    world.allow_sleep = false;
    stage.start(world);
    stage.floor(0);
    count_ = stage.count("boxes");
    right_ = tower(stage, 5, blue);
    left_ = tower(stage, -5, steel);
    asked_ = false;
  }

  void after_step(Stage2& stage) override {
    if (!asked_) {  // who rests on whom is known after the first step
      asked_ = true;
      rigid::AdviceOptions options;
      options.sag_share = stage.value("share");
      const auto advice = advise(stage.world(), float(stage.declaration().dt), options);
      std::vector<rigid::Advice> for_the_right;
      for (const auto& a : advice) {
        if (a.kind != rigid::AdviceKind::sag) continue;
        if (a.body == right_) for_the_right.push_back(a);
        if (a.body == left_) predicted_ = a.predicted;
        stage.say(a.message);
      }
      given_ = apply_advice<Dim2>(stage.world(), for_the_right);
    }
    const double t = stage.world().time();
    stage.sample(0, 0, t, 1e3 * sag(stage, left_));
    stage.sample(0, 1, t, 1e3 * sag(stage, right_));
    stage.sample(0, 2, t, 1e3 * predicted_);
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    out.push_back({"sag of the left tower", "m", "the adviser's prediction", sag(stage, left_), predicted_,
                   0.25 * predicted_ + 0.005});
    out.push_back({"sag of the right tower", "m", "under the allowed share", sag(stage, right_), 0,
                   1.6 * stage.value("share") * count_});
    out.push_back({"bodies given substeps", "", "the one tower", double(given_), 1, 0});
  }

 private:
  BodyId tower(Stage2& stage, double x, std::uint32_t color) {
    BodyId top{};
    for (int i = 0; i < count_; ++i) {
      rigid::BodyDef<Dim2> body;
      body.name = "box";
      body.position = {x, 0.5 + i};
      top = stage.add(body, geometry::make_box2({0.5f, 0.5f}), {}, color);
    }
    return top;
  }
  double sag(Stage2& stage, BodyId top) const { return count_ - 0.5 - stage.at(top).pose.position.y; }

  BodyId left_, right_;
  double predicted_ = 0;
  int count_ = 0, given_ = 0;
  bool asked_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_adviser() { return std::make_unique<Adviser>(); }

}  // namespace carom::host::demo
