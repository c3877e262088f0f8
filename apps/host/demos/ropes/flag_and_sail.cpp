// A flag on its pole and a square sail between two yards, in the same wind.
#include "apps/host/demos/ropes/list.h"
#include "carom/particles/cloth.h"

namespace carom::host::demo {
namespace {

using particles::Cloth;
using rigid::Dim3;

class FlagAndSail final : public Repeatable<FlagAndSail, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "flag-and-sail";
    d.title = "A flag and a sail";
    d.summary = "Woven cloth in the wind: every triangle feels the air that comes to it and gives way.";
    d.group = "Ropes and cloth";
    d.chapter = "13";
    d.text =
        "A fabric stretches by E t a metre of width along warp and weft, shears easily and hardly resists bending. "
        "Each "
        "triangle of area A with normal n takes from the air that moves past it with u\n\n"
        "  F = ½ ρ C |u·n| (u·n) A n\n\n"
        "and a little along itself. One implicit step makes this stable at 60 Hz however stiff the cloth. A sail that "
        "stands square to the wind pulls about as a plate of its size; a flag that streams pulls far less.";
    d.duration = 8;
    d.camera = {{0.4, 2.2, 7.5}, {0.4, 1.6, 0}, 0.7};
    d.ground = 0;
    d.parameters = {
        {"wind", "Wind", "m/s", "km/h", "along x", 0, 25, 0, 9, true},
        {"weight", "Weight of the cloth", "kg/m²", "g/m²", "", 0.05, 0.6, 0, 0.15, false},
    };
    d.plots = {{"Pull on the sail", {"time", "s"}, {"force", "N"}, {{"sail"}, {"a plate of its size"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    rigid::BodyDef<Dim3> def;
    def.type = rigid::BodyType::fixed;
    def.position = {-2.5, 1.5, 0};
    stage.add(def, geometry::Cylinder{1.5f, 0.04f}, {}, steel);
    const particles::Fabric flag{
        .mass_per_area = stage.value("weight"), .shear_stiffness = 60, .bending_stiffness = 1e-5, .thickness = 0.01};
    const auto sheet = particles::make_cloth_sheet({-2.45, 1.9, 0}, {1.5, 0, 0}, {0, 1, 0}, 25, 17);
    flag_ = stage.keep(make({.fabric = flag, .points = sheet.points, .triangles = sheet.triangles, .collide = false}));
    for (int r = 0; r < 17; ++r) pin(stage, *flag_, r * 25);
    flag_surface_ = stage.add_surface(sheet.triangles, 0xd1495bff);

    // The sail hangs from its yard and is held at the lower one, across the wind.
    for (const double y : {0.4, 2.6}) {
      def.position = {1.6, y, 0};
      def.rotation = {0.70710678f, 0.70710678f, 0, 0};
      stage.add(def, geometry::Cylinder{1.1f, 0.04f}, {}, sand);
    }
    def.rotation = {};
    def.position = {1.52, 1.6, 0};
    stage.add(def, geometry::Cylinder{1.6f, 0.06f}, {}, sand);
    const particles::Fabric canvas{.mass_per_area = 2 * stage.value("weight"),
                                   .warp_stiffness = 2e4,
                                   .weft_stiffness = 2e4,
                                   .shear_stiffness = 600,
                                   .bending_stiffness = 1e-4,
                                   .thickness = 0.01};
    const auto square = particles::make_cloth_sheet({1.66, 0.4, -1}, {0, 0, 2}, {0, 2.2, 0}, 19, 21);
    std::vector<Vec3d> full = square.points;  // cut with some belly
    sail_ = stage.keep(make({.fabric = canvas,
                             .points = full,
                             .triangles = square.triangles,
                             .warp = {0, 1, 0},
                             .collide = false,
                             .self_collide = false}));
    for (int c = 0; c < 19; ++c) pin(stage, *sail_, 20 * 19 + c);
    pin(stage, *sail_, 0);
    pin(stage, *sail_, 18);
    sail_surface_ = stage.add_surface(square.triangles, 0xe9e2d0ff);
    changed(stage, "wind");
    show(stage);
  }

  void changed(Stage3& stage, std::string_view) override {
    const environment::Wind wind{.velocity = {stage.value("wind"), 0, 0.05 * stage.value("wind")}};
    stage.check(flag_->set_air(1.225, wind));
    stage.check(sail_->set_air(1.225, wind));
  }
  void before_step(Stage3& stage) override {
    stage.check(flag_->step(stage.world(), stage.declaration().dt));
    stage.check(sail_->step(stage.world(), stage.declaration().dt));
  }
  void after_step(Stage3& stage) override {
    show(stage);
    Vec3d pull{};
    for (int c = 0; c < 19; ++c) pull += sail_->pin_force(20 * 19 + c);
    pull += sail_->pin_force(0) + sail_->pin_force(18);
    const double t = stage.world().time(), v = stage.value("wind");
    const double plate = 0.5 * 1.225 * v * v * 1.2 * 2 * 2.2;
    stage.sample(0, 0, t, pull.x);
    stage.sample(0, 1, t, plate);
    if (t > 5) sum_ += pull.x / plate, ++samples_;
    for (const math::Vec3f& speed : flag_->velocities()) fastest_ = max(fastest_, double(length(speed)));
  }
  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"pull of the sail over that of a plate", "", "½ ρ v² C A, less for its belly",
                   samples_ > 0 ? sum_ / samples_ : 0, 0.9, 0.15});
    out.push_back(
        {"fastest vertex of the flag over the wind", "", "it flaps, and does not fly off", fastest_ / 9, 1, 1});
  }
  std::uint64_t state_hash(std::uint64_t world) const override {
    return world ^ flag_->state_hash() ^ (sail_->state_hash() << 1);
  }

 private:
  static core::Result<std::optional<Cloth>> make(const particles::ClothDef& def) {
    auto made = Cloth::make(def);
    if (!made) return made.error();
    return std::optional<Cloth>(std::move(made).value());
  }
  static void pin(Stage3& stage, Cloth& cloth, int vertex) { stage.check(cloth.pin(vertex)); }
  void show(Stage3& stage) {
    for (int k = 0; k < 2; ++k) {
      std::vector<math::Vec3f> corners;
      for (const Vec3d& p : (k == 0 ? *flag_ : *sail_).positions()) corners.push_back(math::Vec3f(p));
      stage.set_surface(k == 0 ? flag_surface_ : sail_surface_, corners);
    }
  }

  std::optional<Cloth> flag_, sail_;
  int flag_surface_ = 0, sail_surface_ = 0, samples_ = 0;
  double sum_ = 0, fastest_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_flag_and_sail() { return std::make_unique<FlagAndSail>(); }

}  // namespace carom::host::demo
