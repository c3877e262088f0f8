// Soft bodies that bounce, and a ball that falls on one.
#include "apps/host/demos/ropes/list.h"
#include "carom/particles/soft_body.h"

namespace carom::host::demo {
namespace {

using particles::SoftBody;
using rigid::BodyId;
using rigid::Dim3;

class SoftBodies final : public Repeatable<SoftBodies, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "soft-bodies";
    d.title = "Soft bodies";
    d.summary = "A ball of foam bounces, a cushion takes an iron ball: solids of tetrahedra with volume.";
    d.group = "Ropes and cloth";
    d.chapter = "beyond the book";
    d.text =
        "Each tetrahedron is an elastic solid with Young's modulus E and Poisson's ratio ν in a frame that turns with "
        "it, "
        "so that large turns cost nothing:\n\n"
        "  σ = 2 μ ε + λ tr(ε) 1\n\n"
        "Near ν = ½ it keeps its volume and bulges where it is pressed.";
    d.duration = 6;
    d.camera = {{0, 1.6, 6}, {0, 0.7, 0}, 0.7};
    d.ground = 0;
    d.parameters = {
        {"modulus", "Young's modulus", "Pa", "kPa", "", 5e3, 5e5, 0, 4e4, false},
        {"poisson", "Poisson's ratio", "", "", "", 0, 0.47, 0, 0.4, false},
        {"iron", "Iron ball", "kg", "kg", "", 1, 80, 0, 25, false},
    };
    d.plots = {{"Ball",
                {"time", "s"},
                {"height of the middle", "m"},
                {{"foam"}, {"iron"}, {"free fall, y₀ − g t²/2", Series::Style::points}}},
               {"Energy of the foam ball",
                {"time", "s"},
                {"energy", "J"},
                {{"motion, height and strain"}, {"at the start: none is gained"}, {"strain alone"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    const particles::SoftMaterial foam{.density = 150,
                                       .youngs_modulus = stage.value("modulus"),
                                       .poisson_ratio = stage.value("poisson"),
                                       .damping = 0.002};
    const auto ball = particles::make_soft_ball({-1, 1.6, 0}, 0.45, 7);
    const auto cushion = particles::make_soft_box({0.3, 0.02, -0.6}, {1.4, 0.5, 1.2}, 8, 4, 8);
    for (const auto* mesh : {&ball, &cushion}) {
      auto made = SoftBody::make({.material = foam, .points = mesh->points, .tetrahedra = mesh->tetrahedra});
      if (!made) return stage.fail(made.error());
      bodies_.push_back(std::move(made).value());
      const auto skin = bodies_.back().surface();
      surfaces_.push_back(stage.add_surface({skin.begin(), skin.end()}, bodies_.size() == 1 ? 0xe8833aff : 0x2f9c95ff));
    }
    rigid::BodyDef<Dim3> def;
    def.position = {1, 1.2, 0};
    const double radius = 0.22;
    rigid::ShapeDef<Dim3> iron;
    iron.density = float(stage.value("iron") / (4.0 / 3 * math::pi * radius * radius * radius));
    iron_ = stage.add(def, geometry::Sphere{float(radius)}, iron, dark);
    show(stage);
  }
  void before_step(Stage3& stage) override {
    for (SoftBody& body : bodies_) stage.check(body.step(stage.world(), stage.declaration().dt));
  }
  void after_step(Stage3& stage) override {
    show(stage);
    const double t = stage.world().time(), y = bodies_[0].center().y;
    stage.sample(0, 0, t, y);
    stage.sample(0, 1, t, stage.at(iron_).center_of_mass.y);
    const double g = -double(stage.world().definition().gravity.y);
    for (const double start : {1.6, 1.2}) {
      const double fallen = start - 0.5 * g * t * t;
      const bool seldom = int(math::round(60 * t)) % 4 == 0;  // the curves are to be seen beside the points
      if (seldom && fallen > (start == 1.6 ? 0.45 : 0.74)) stage.sample(0, 2, t, fallen);
    }
    const double strain = bodies_[0].elastic_energy(), weight = bodies_[0].mass() * g;
    const double energy = bodies_[0].kinetic_energy() + strain + weight * y;
    stage.sample(1, 0, t, energy);
    stage.sample(1, 1, t, weight * 1.6);
    stage.sample(1, 2, t, strain);
    most_ = max(most_, energy / (weight * 1.6));
    if (y > 0.5 && !touched_) fall_ = max(fall_, math::abs(y - (1.6 - 0.5 * g * t * t)));
    for (const SoftBody& body : bodies_) volume_ = max(volume_, math::abs(body.volume() / body.rest_volume() - 1));
    touched_ |= y < 0.45;
    if (touched_) bounce_ = max(bounce_, y);
  }
  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"change of volume, most", "", "small near ν = ½", volume_, 0, 0.2});
    out.push_back({"the foam ball falls as a stone, off by", "m", "y₀ − g t²/2", fall_, 0, 0.02});
    out.push_back({"its greatest energy, of that at the start", "", "none is gained", most_, 1, 0.01});
    out.push_back({"bounce of the foam ball", "m", "up again, and not above its start", bounce_, 1.0, 0.55});
    const double y = stage.at(iron_).center_of_mass.y;
    out.push_back({"the iron ball lies in the cushion", "m", "above the ground, below where it would lie on stone", y,
                   0.5, 0.25});
  }
  std::uint64_t state_hash(std::uint64_t world) const override {
    for (const SoftBody& body : bodies_) world = world * 31 + body.state_hash();
    return world;
  }

 private:
  void show(Stage3& stage) {
    for (std::size_t k = 0; k < bodies_.size(); ++k) {
      std::vector<math::Vec3f> corners;
      for (const Vec3d& p : bodies_[k].positions()) corners.push_back(math::Vec3f(p));
      stage.set_surface(surfaces_[k], corners);
    }
  }
  std::vector<SoftBody> bodies_;
  std::vector<int> surfaces_;
  BodyId iron_{};
  double volume_ = 0, bounce_ = 0, fall_ = 0, most_ = 0;
  bool touched_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_soft_bodies() { return std::make_unique<SoftBodies>(); }

}  // namespace carom::host::demo
