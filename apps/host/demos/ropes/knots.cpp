// Ropes that touch themselves and each other: a knot drawn tight, two loops hooked into each other.
#include "apps/host/demos/ropes/draw.h"
#include "apps/host/demos/ropes/list.h"

namespace carom::host::demo {
namespace {

using particles::RopeSet;
using rigid::BodyId;
using rigid::Dim3;

class Knots final : public Repeatable<Knots, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "knots";
    d.title = "Knots";
    d.summary = "A weight draws an overhand knot tight; two loops hold a load by nothing but each other.";
    d.group = "Ropes and cloth";
    d.chapter = "13";
    d.text =
        "Segments of a rope push on each other where they touch, with Coulomb's friction, both ways and within the "
        "same "
        "implicit step as the tension. So a knot stays a knot: a tight one of a smooth rope takes up about ten "
        "diameters of its length, whatever it is made of and however hard it is drawn (P. Pieranski, S. Przybył, "
        "A. Stasiak, Eur. Phys. J. E 6 (2001) 123: 10.1 for the shortest open one).\n\n"
        "Two loops hooked into each other (red and blue) carry the box: each turns over the other's round.";
    d.duration = 10;
    d.camera = {{0.1, 0.95, 4.2}, {0.1, 0.9, 0}, 0.75};
    d.ground = -0.6;
    d.parameters = {
        {"pull", "Weight on the knot", "kg", "kg", "", 0.5, 10, 0, 2, false},
        {"load", "Load on the loops", "kg", "kg", "", 1, 100, 0, 20, false},
        {"friction", "Friction", "", "", "coefficient of rope on rope", 0, 0.6, 0, 0.2, false},
        {"diameter", "Diameter", "mm", "mm", "of the ropes", 10, 20, 0, 18, false},
    };
    d.plots = {{"Rope in the knot", {"time", "s"}, {"diameters", ""}, {{"knot"}, {"shortest"}}},
               {"Pull on the ceiling", {"time", "s"}, {"force", "N"}, {{"loops"}, {"weight"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(-0.6);
    rigid::BodyDef<Dim3> def;
    def.type = rigid::BodyType::fixed;
    def.position = {0.1, 2.35, 0};
    stage.add(def, geometry::Box{{0.9f, 0.05f, 0.2f}}, {}, dark);
    radius_ = 0.5e-3 * stage.value("diameter");
    particles::RopeMaterial material{.mass_per_length = 0.05,
                                     .radius = radius_,
                                     .axial_stiffness = 2e5,
                                     .axial_damping = 20,
                                     .bending_stiffness = 2e-4,
                                     .friction = stage.value("friction")};
    // The polynomial trefoil, with the lower end hanging.
    const Vec3d center{-0.4, 1.75, 0};
    std::vector<Vec3d> knot{{-0.4, 2.3, 0}};
    for (int i = 0; i <= 120; ++i) {
      const double t = -2.1 + 4.2 * i / 120, t2 = t * t;
      knot.push_back(center + 0.06 * Vec3d{t2 * t2 - 4 * t2, -(t * t2 - 3 * t), t * t2 * t2 / 5 - 2 * t});
    }
    knot.push_back({-0.4, 1.3, 0});
    stage.keep(ropes_.add({.material = material, .points = knot, .segments = 120, .touch_ropes = true}));
    stage.check(ropes_.attach(0, {.node = 0, .point = knot.front()}, stage.world()));

    std::vector<Vec3d> upper, lower;
    for (int i = 0; i <= 16; ++i) {
      const double a = math::pi * i / 16;
      upper.push_back({0.5 - 0.12 * math::cos(a), 2.3 - 0.65 * math::sin(a), 0});
      lower.push_back({0.5, 1.0 + 0.65 * math::sin(a) + 2.4 * radius_, -0.12 * math::cos(a)});
    }
    for (const auto* way : {&upper, &lower})
      stage.keep(ropes_.add({.material = material, .points = *way, .segments = 30, .touch_ropes = true}));
    def.type = rigid::BodyType::dynamic;
    def.allow_sleep = false;
    def.name = "load";
    def.position = {0.5, 0.9, 0};
    rigid::ShapeDef<Dim3> iron;
    iron.density = float(stage.value("load") / (0.3 * 0.2 * 0.3));
    load_ = stage.add(def, geometry::Box{{0.15f, 0.1f, 0.15f}}, iron, sand);
    for (const int node : {0, -1}) {
      const auto end = [&](const std::vector<Vec3d>& way) { return node == 0 ? way.front() : way.back(); };
      stage.check(ropes_.attach(1, {.node = node, .point = end(upper)}, stage.world()));
      stage.check(ropes_.attach(2, {.node = node, .body = load_, .point = end(lower) - def.position}, stage.world()));
    }
    def.name = "weight";
    def.position = {-0.4, 1.2, 0};
    iron.density = float(stage.value("pull") / (4.0 / 3 * math::pi * 0.1 * 0.1 * 0.1));
    weight_ = stage.add(def, geometry::Sphere{0.1f}, iron, red);
    stage.check(ropes_.attach(0, {.node = -1, .body = weight_, .point = {0, 0.1, 0}}, stage.world()));
  }

  void before_step(Stage3& stage) override { stage.check(ropes_.step(stage.world(), stage.declaration().dt)); }

  void after_step(Stage3& stage) override {
    constexpr std::uint32_t colors[] = {0xc9a227ff, 0xc0504dff, 0x4f81bdff};
    for (int r = 0; r < 3; ++r) draw_rope(stage, ropes_, r, colors[r]);
    const double t = stage.world().time();
    const auto p = ropes_.positions(0);
    taken_ = (ropes_.length(0) - distance(p.front(), p.back())) / (2 * radius_);
    held_ = -(ropes_.attachment_force(1, 0).y + ropes_.attachment_force(1, -1).y);
    carried_ = (stage.value("load") + ropes_.mass(1) + ropes_.mass(2)) * 9.80665;
    stage.sample(0, 0, t, taken_);
    stage.sample(0, 1, t, 10.1);
    stage.sample(1, 0, t, held_);
    stage.sample(1, 1, t, carried_);
  }
  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"rope in the tight knot, diameters", "", "Pieranski, Przybył, Stasiak 2001: 10.1", taken_, 11, 2});
    out.push_back({"pull on the ceiling", "N", "the weight of what hangs there", held_, carried_, 0.02 * carried_});
  }
  std::uint64_t state_hash(std::uint64_t world) const override { return world ^ ropes_.state_hash(); }

 private:
  RopeSet ropes_;
  BodyId load_{}, weight_{};
  double radius_ = 0.01, taken_ = 0, held_ = 0, carried_ = 1;
};

}  // namespace

std::unique_ptr<Demo> make_knots() { return std::make_unique<Knots>(); }

}  // namespace carom::host::demo
