// Substeps where they are needed: one of two beams, and nobody else pays.
#include "apps/host/demos/rules/list.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim2;

class Substeps final : public Repeatable<Substeps, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "substeps";
    d.dimension = 2;
    d.title = "Substeps where they are needed";
    d.summary =
        "Two welded beams: one gets substeps of its own and stiffens; the loose balls below cost what they did.";
    d.group = "Rules of bodies";
    d.text =
        "The solver cuts a step of dt into n substeps, and joints and contacts can be as stiff as the substep permits: "
        "their frequency f follows n. A weld that bears a moment M gives way by M/(I_eff ω²), so that a beam of many "
        "welds sags with 1/n²:\n\n"
        "  sag ∝ 1/ω²,  ω = 2π f,  f = f₀ n/n₀\n\n"
        "More substeps for the whole world cost in proportion. Here a body asks for them, and only its island gets "
        "them: what touches it or is jointed to it. The plot shows how many bodies are solved in a step, times "
        "substeps, and what that would be if all had as many. (A direct solver of joints, which this engine takes for "
        "beams of itself, would hold both beams straight; it is switched off here.)";
    d.duration = 6;
    d.camera.target = {0.5, 3.4, 0};
    d.camera.height = 11.5;
    d.camera.width = 17;
    d.ground = 0;
    d.parameters = {
        {"substeps", "Substeps of the upper beam", "", "", "the world has four", 4, 32, 1, 16, true},
        {"pieces", "Pieces of a beam", "", "", "", 4, 14, 1, 10, false},
        {"balls", "Loose balls", "", "", "", 0, 200, 1, 80, false},
    };
    d.plots = {{"Sag", {"time", "s"}, {"of the tip", "mm"}, {{"four substeps"}, {"its own substeps"}}},
               {"Work", {"time", "s"}, {"awake bodies × substeps", ""}, {{"as it is"}, {"all as many"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    rigid::WorldDef<Dim2> world;
    world.joint_solver = rigid::JointSolver::iterative;
    world.allow_sleep = false;
    stage.start(world);
    stage.floor(0);
    for (const double x : {-7.0, 8.0}) {
      rigid::BodyDef<Dim2> wall;
      wall.type = rigid::BodyType::fixed;
      wall.name = "wall";
      wall.position = {x, 4};
      walls_[x > 0 ? 1 : 0] = stage.add(wall, geometry::make_box2({0.5f, 4}), {}, dark);
    }
    beam(stage, 1, upper_, green);
    beam(stage, 0, lower_, steel);
    const int balls = stage.count("balls");
    for (int i = 0; i < balls; ++i) {
      rigid::BodyDef<Dim2> ball;
      ball.name = "ball";
      const int row = i / 20;
      ball.position = {-5.6 + 0.62 * (i % 20) + 0.05 * (i / 20 % 3), 0.4 + 0.6 * row};
      stage.add(ball, geometry::Circle{0.2f}, {}, i % 2 == 0 ? sand : gold);
    }
    changed(stage, {});
  }

  void changed(Stage2& stage, std::string_view) override {
    stage.check(stage.world().set_substeps(tip_[1], stage.count("substeps")));
  }

  void after_step(Stage2& stage) override {
    const double t = stage.world().time();
    for (int k = 0; k < 2; ++k) stage.sample(0, k, t, 1e3 * sag(stage, k));
    const int pieces = stage.count("pieces"), all = stage.world().counters().awake_bodies;
    const int base = stage.world().definition().substeps, own = max(stage.count("substeps"), base);
    stage.sample(1, 0, t, double(base * (all - pieces) + own * pieces));
    stage.sample(1, 1, t, double(own * all));
    const Vec2d wall{-6.5, 0};
    for (const double y : {upper_, lower_})
      stage.line(wall + Vec2d{0, y}, {wall.x + stage.value("pieces"), y}, pen(red, 0x70));
    stage.say(format("the tips hang %.1f and %.1f mm low", 1e3 * sag(stage, 0), 1e3 * sag(stage, 1)));
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    const double own = sag(stage, 1), plain = sag(stage, 0);
    out.push_back(
        {"sag of the beam with 16 substeps, against 4", "", "1/n²: a sixteenth", own / plain, 1.0 / 16, 0.02});
    out.push_back({"sag of the beam with 4 at least", "m", "welds of 60 Hz give way", min(plain, 0.02), 0.02, 0});
  }

 private:
  static constexpr double upper_ = 7.2, lower_ = 4.8;

  void beam(Stage2& stage, int which, double y, std::uint32_t color) {
    BodyId last = walls_[0];
    const int pieces = stage.count("pieces");
    for (int i = 0; i < pieces; ++i) {
      rigid::BodyDef<Dim2> piece;
      piece.name = which == 1 ? "piece with its own substeps" : "piece";
      piece.position = {-6 + 1.0 * i, y};
      const BodyId next = stage.add(piece, geometry::make_box2({0.5f, 0.15f}), {}, color);
      rigid::WeldJointDef<Dim2> weld;
      weld.body_a = last, weld.body_b = next;
      weld.frame_a.p = i == 0 ? Vec2f{0.5f, float(y - 4)} : Vec2f{0.5f, 0};
      weld.frame_b.p = {-0.5f, 0};
      stage.keep(stage.world().create_joint(weld));
      last = next;
    }
    tip_[which] = last;
  }
  double sag(Stage2& stage, int which) const {
    return (which == 1 ? upper_ : lower_) - stage.at(tip_[which]).pose.position.y;
  }

  BodyId walls_[2], tip_[2];
};

}  // namespace

std::unique_ptr<Demo> make_substeps() { return std::make_unique<Substeps>(); }

}  // namespace carom::host::demo
