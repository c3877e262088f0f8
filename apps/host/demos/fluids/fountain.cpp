// A jet into a basin in space, with boxes and balls that ride on the water.
#include "apps/host/demos/fluids/fluids.h"

namespace carom::host::demo {
namespace {

using particles::Fluid3;
using rigid::Dim3;

class WaterFountain final : public Repeatable<WaterFountain, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "water-fountain";
    d.title = "Fountain into a basin";
    d.summary = "A jet fills a basin; what floats rises with the level, what is heavy stays on the ground.";
    d.group = "Fluids";
    d.chapter = "beyond";
    d.text =
        "Water in space, ten thousand particles and more. The jet leaves its nozzle with speed v and the cross-section "
        "A, so the volume in the basin grows by\n\n"
        "  dV/dt = A v\n\n"
        "until the overflow at the far side takes as much. The plot compares the volume with that. Grab the floats: "
        "the water resists, and its added mass is felt (a ball moves half its own volume of water along).";
    d.duration = 8;
    d.camera = {{2.05, 1.45, 2.15}, {0.75, 0.25, 0.42}};
    d.parameters = {
        {"speed", "Speed of the jet", "m/s", "m/s", "", 0.5, 4, 0, 2.5, true},
        {"angle", "Angle of the jet", "rad", "deg", "above the level", -1.2, 1.2, 0, 0.5, true},
        {"radius", "Radius of the nozzle", "m", "mm", "", 0.03, 0.12, 0, 0.07, true},
        {"depth", "Water at the start", "m", "m", "", 0, 0.5, 0.02, 0.14, false},
        {"spacing", "Spacing of the particles", "m", "mm", "", 0.02, 0.06, 0.001, 0.035, false},
    };
    d.plots = {{"Volume", {"time", "s"}, {"volume", "m³"}, {{"particles"}, {"V₀ + A v t"}}},
               {"Work", {"time", "s"}, {"iterations of the solver", ""}, {{"pressure"}, {"spreading"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    wall(stage, {length_ / 2, 0.3, -0.03}, {float(length_ / 2 + 0.06), 0.3f, 0.03f});
    wall(stage, {length_ / 2, 0.1, width_ + 0.03}, {float(length_ / 2 + 0.06), 0.1f, 0.03f}, 0x60);
    wall(stage, {-0.03, 0.3, width_ / 2}, {0.03f, 0.3f, float(width_ / 2)});
    wall(stage, {length_ + 0.03, 0.2, width_ / 2}, {0.03f, 0.2f, float(width_ / 2)});
    particles::FluidDef<Dim3> water{.upper = {length_, 1.0, width_},
                                    .spacing = stage.valuef("spacing"),
                                    .max_particles = 60000,
                                    .threads = stage.threads()};
    auto made = Fluid3::create(water);
    if (!made.ok()) return stage.fail(made.error());
    fluid_ = std::move(made).value();
    const double depth = stage.value("depth");
    if (depth > 0) stage.check(fluid_->add_box({0, 0, 0}, {length_, depth, width_}));
    // What rises above the rim of the far wall is taken away.
    stage.keep(fluid_->add_drain({.lower = {length_ - 0.08, 0.4, 0}, .upper = {length_, 1.0, width_}}));
    tap_ = stage.keep(fluid_->add_tap(tap(stage)));
    start_ = fluid_->volume();
    promised_ = start_;
    body(stage, geometry::Box{{0.09f, 0.09f, 0.09f}}, {0.9, depth + 0.2, 0.3}, 350, orange);
    body(stage, geometry::Box{{0.12f, 0.05f, 0.08f}}, {1.15, depth + 0.15, 0.6}, 500, gold);
    body(stage, geometry::Sphere{0.1f}, {0.75, depth + 0.3, 0.65}, 250, green);
    body(stage, geometry::Capsule3{0.08f, 0.06f}, {1.2, depth + 0.35, 0.35}, 600, violet);
    body(stage, geometry::Sphere{0.09f}, {0.5, depth + 0.3, 0.6}, 2500, red);
    look_.draw(stage, *fluid_, 2.5f);
  }

  void before_step(Stage3& stage) override {
    if (!fluid_) return;
    stage.check(fluid_->set_tap(tap_, tap(stage)));
    stage.check(fluid_->step(stage.world(), float(stage.declaration().dt)));
  }

  void after_step(Stage3& stage) override {
    if (!fluid_) return;
    look_.draw(stage, *fluid_, 2.5f);
    const double t = stage.world().time();
    // The nozzle is made of whole particles: its cross-section is that of those in one layer.
    const double s = stage.value("spacing"), r = stage.value("radius");
    int layer = 0;
    const int reach = int(r / s);
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j) layer += (i * i + j * j) * s * s <= r * r ? 1 : 0;
    promised_ += layer * s * s * stage.value("speed") * stage.declaration().dt;
    if (t <= 2) early_ = fluid_->volume() - start_, early_promise_ = promised_ - start_;
    if (t > 4) density_ += double(fluid_->statistics().mean_density), ++samples_;
    stage.sample(0, 0, t, fluid_->volume());
    stage.sample(0, 1, t, promised_);
    stage.sample(1, 0, t, fluid_->statistics().iterations);
    stage.sample(1, 1, t, fluid_->statistics().spreading_iterations);
    stage.say(format("%.0f particles, density within %.2f %% of water's", fluid_->size(),
                     100 * math::abs(double(fluid_->statistics().mean_density) - 1)));
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"volume that came in two seconds", "m³", "A v t", early_, early_promise_, 0.03 * early_promise_});
    // The jet drives particles closer together where it strikes than they can be spread again in a step.
    out.push_back({"mean density", "", "incompressible", samples_ > 0 ? density_ / samples_ : 0, 1, 0.05});
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return fluid_ ? world ^ fluid_->state_hash() : world; }

 private:
  static constexpr double length_ = 1.6, width_ = 0.9;

  particles::FluidTap<Dim3> tap(Stage3& stage) {
    const float v = stage.valuef("speed"), angle = stage.valuef("angle");
    return {.center = {0.1, 0.5, width_ / 2},
            .velocity = {v * math::cos(angle), v * math::sin(angle), 0},
            .radius = stage.valuef("radius"),
            .tag = 1};
  }
  void wall(Stage3& stage, Vec3d at, Vec3f half, std::uint32_t = 0xff) {
    rigid::BodyDef<Dim3> def;
    def.type = rigid::BodyType::fixed;
    def.position = at;
    stage.add(def, geometry::Box{half}, {}, steel);
  }
  void body(Stage3& stage, const geometry::Shape3& form, Vec3d at, float density, std::uint32_t color) {
    rigid::BodyDef<Dim3> def;
    def.position = at;
    rigid::ShapeDef<Dim3> shape;
    shape.density = density;
    stage.add(def, form, shape, color);
  }

  std::optional<Fluid3> fluid_;
  LiquidLook<Dim3> look_;
  int tap_ = 0, samples_ = 0;
  double density_ = 0;
  double start_ = 0, promised_ = 0, early_ = 0, early_promise_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_water_fountain() { return std::make_unique<WaterFountain>(); }

}  // namespace carom::host::demo
