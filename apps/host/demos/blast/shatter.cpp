// A wall that a ball breaks: bricks in mortar, or a slab that cracks into cells (chapter 18.8).
#include "apps/host/demos/blast/list.h"
#include "apps/host/demos/blast/shown.h"
#include "carom/math/elementary.h"

namespace carom::host::demo {
namespace {

using rigid::Dim3;

class Shatter final : public Repeatable<Shatter, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "shatter-wall";
    d.title = "Shatter a wall";
    d.summary = "A wall of bricks or of cells stands as one body until a ball breaks its bonds. Shoot it.";
    d.group = "Explosions and fracture";
    d.chapter = "18.8";
    d.text =
        "Parts are held together by bonds, areas of mortar or of solid material. As long as they hold, the wall is one "
        "body. After every step the blows it took are spread over the bonds as over short beams between rigid parts, "
        "in "
        "equilibrium with the ground and with inertia:\n\n"
        "  σ = F/A + M r/I,   τ = Q/A,   F = J / contact time\n\n"
        "What is stressed beyond its strength gives way; of the blow only so much was borne, and the ball keeps the "
        "rest. What no bond holds to the ground any more falls with the velocity that it had.";
    d.duration = 5;
    d.camera = {{3.9, 2.4, 4.6}, {0.1, 0.9, -0.4}};
    d.ground = 0;
    d.parameters = {
        choice("pattern", "Pattern", "", {"bricks", "Voronoi cells", "slabs"}),
        {"parts", "Cells", "", "", "of the Voronoi wall", 20, 400, 1, 180, false},
        {"tension", "Strength in tension", "Pa", "MPa", "of the bonds", 2e4, 5e6, 0, 1.5e5, false},
        {"speed", "Speed of the ball", "m/s", "m/s", "", 1, 80, 0.5, 32, true},
        {"mass", "Mass of the ball", "kg", "kg", "", 1, 500, 1, 160, true},
        {"seed", "Seed", "", "", "of the cells", 1, 100, 1, 7, false},
    };
    d.plots = {
        {"What holds", {"time", "s"}, {"bodies of the wall", ""}, {{"bodies"}, {"broken bonds"}}},
        {"Speed of the ball", {"time", "s"}, {"speed", "m/s"}, {{"ball"}, {"free flight", Series::Style::points}}}};
    d.inputs = {{"shoot", "Shoot", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.looks_in_materials = true;
    stage.floor(0, {.friction = 0.8f});
    const blast::ConvexCell box(geometry::Bounds3d{{-2, 0, -0.11}, {2, 2.24, 0.11}});
    const int pattern = stage.count("pattern");
    blast::Pattern cells;
    if (pattern == 0)
      cells = stage.keep(blast::brick_pattern(box, {0.4, 0.16, 0.22}, {-2, 0, -0.11}));
    else if (pattern == 1)
      cells = stage.keep(blast::voronoi_pattern(
          box, blast::even_sites(box, stage.count("parts"), 2, std::uint64_t(stage.count("seed")))));
    else
      cells = stage.keep(blast::slab_pattern(box, {0.4, 1, 0}, 14, 0.5, std::uint64_t(stage.count("seed"))));
    auto d = blast::structure_of(stage.keep(blast::fracture_convex(cells, {.meshes = false})),
                                 blast::density_of(blast::Substance::brick_and_mortar));
    d.material = blast::bond_material(blast::Substance::brick_and_mortar);
    d.material.tensile_strength = stage.value("tension");
    d.material.shear_strength = 1.3 * stage.value("tension");
    d.shape.material.friction = 0.7f;
    blast::anchor_below(d, 0.05);
    for (std::uint32_t i = 0; i < d.parts.size(); ++i) d.parts[i].user_id = shade(pattern == 0 ? 0xb5533c : sand, i);
    for (const auto& part : d.parts) mass_ += part.mass.mass;
    wall_ = stage.keep(blast::Structure3::make(stage.world(), d));
    stage.adopt_all();
  }

  void before_step(Stage3& stage) override {
    if (stage.presses("shoot") == 0 && !(shots_ == 0 && stage.world().time() >= 0.4)) return;
    ++shots_;
    thrown_at_ = stage.world().time();
    thrown_ = {0, 1, -stage.value("speed")};
    if (shots_ == 1) shot_at_ = thrown_at_;
    const float radius = float(cbrt(stage.value("mass") / (7800 * 4 / 3.0 * pi)));
    rigid::BodyDef<Dim3> body;
    body.name = "ball";
    body.bullet = true;
    body.position = {-0.4 + 0.35 * (shots_ % 4), 1.05 + 0.25 * (shots_ % 3), 4};
    body.linear_velocity = {0, 1, -stage.valuef("speed")};
    ball_ = stage.add(body, geometry::Sphere{radius}, {.density = 7800, .material = {.user_id = 0xff000000u | dark}});
  }

  core::Status step(Stage3& stage) override {
    return stepper_.step(stage.world(), float(stage.declaration().dt), wall_);
  }

  void after_step(Stage3& stage) override {
    show_changes(stage, wall_);
    const double t = stage.world().time();
    stage.sample(0, 0, t, double(wall_.cluster_count()));
    stage.sample(0, 1, t, double(wall_.broken()));
    if (shots_ > 0 && stage.world().contains(ball_)) compare(stage, t);
    if (!wall_.events().empty())
      stage.say(format("broken bonds: %.0f, the worst at %.1f times its strength; %.0f bodies",
                       double(wall_.events().size()), worst(), double(wall_.cluster_count())));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    double mass = -stage.value("mass") * shots_;
    mass += stage.world().totals().mass;
    for (std::uint32_t p = 0; p < wall_.part_count(); ++p)
      if (stage.keep(stage.world().state(wall_.body_of(p))).mass == 0) mass += wall_.definition().parts[p].mass.mass;
    out.push_back({"mass of all parts", "kg", "cutting loses nothing", mass, mass_, 1e-5 * mass_});
    const double gap = 4 - 0.11 - cbrt(stage.value("mass") / (7800 * 4 / 3.0 * pi));
    out.push_back({"time that the ball flies freely", "s", "from the throw to the wall", flown_,
                   gap / stage.value("speed"), 2.0 / 60});
    out.push_back({"the wall broke", "", "a ball of 160 kg at 32 m/s", wall_.broken() > 5 ? 1.0 : 0.0, 1, 0});
  }

 private:
  /// The speed by free flight, from the throw or the last contact on.
  void compare(Stage3& stage, double t) {
    const Vec3d velocity(stage.at(ball_).linear_velocity);
    stage.sample(1, 0, t, length(velocity));
    const Vec3d law = thrown_ - Vec3d{0, 9.80665 * (t - thrown_at_), 0};
    if (distance(law, velocity) < 0.02) {
      stage.sample(1, 1, t, length(law));
      if (first_) flown_ = t - shot_at_;
      return;
    }
    first_ = false;
    thrown_ = velocity;
    thrown_at_ = t;
  }
  double worst() const {
    double w = 0;
    for (const auto& event : wall_.events()) w = max(w, event.load);
    return w;
  }
  blast::Structure3 wall_;
  blast::FractureStepper3 stepper_;
  rigid::BodyId ball_;
  double mass_ = 0, shot_at_ = 0, flown_ = 0, thrown_at_ = 0;
  Vec3d thrown_{};
  bool first_ = true;
  int shots_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_shatter() { return std::make_unique<Shatter>(); }

}  // namespace carom::host::demo
