// A tank of water with what floats and what sinks.
#include <algorithm>

#include "apps/host/demos/fluids/fluids.h"

namespace carom::host::demo {
namespace {

using particles::Fluid2;
using rigid::BodyId;
using rigid::Dim2;

class FluidTank final : public Repeatable<FluidTank, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "fluid-tank";
    d.title = "Water tank";
    d.summary = "Grab the boxes and the ball: light things float as deep as they are dense, the heavy one sinks.";
    d.group = "Fluids";
    d.chapter = "3.6, beyond";
    d.dimension = 2;
    d.text =
        "Thousands of particles carry the water, and a grid makes it incompressible: in every step one system of "
        "equations gives the pressure in all cells and the motion of the bodies in them together, so that a box "
        "pushes the water aside and the water pushes the box, with exactly opposite impulses.\n\n"
        "  ∇·u = 0,   Du/Dt = −∇p/ρ + g,   m dv/dt = −∮ p n dA + m g\n\n"
        "Archimedes follows by itself: what is 0.6 times as dense as water floats with 60 % of its height under the "
        "surface. The plot shows the draft of the two boxes against that. Pressure grows with depth as p = ρ g d "
        "(dotted).\n\n"
        "Open the tap and the level rises; viscosity turns water into oil and honey.";
    d.duration = 10;
    d.camera = {{1.2, 0.75, 6}, {1.2, 0.75, 0}, 0.75, 1.75, 2.7};
    d.parameters = {
        {"light", "Density of the orange box", "kg/m³", "kg/m³", "water has 1000", 50, 950, 50, 300, false},
        {"half", "Density of the green box", "kg/m³", "kg/m³", "", 50, 950, 50, 600, false},
        {"heavy", "Density of the ball", "kg/m³", "kg/m³", "", 50, 4000, 50, 1800, false},
        {"depth", "Depth of the water", "m", "m", "", 0.2, 0.9, 0.05, 0.6, false},
        {"viscosity", "Kinematic viscosity", "m²/s", "m²/s", "water 0.000001, honey 0.005", 0, 0.02, 0, 1e-6, false},
        {"spacing", "Spacing of the particles", "m", "mm", "half a cell of the grid", 0.01, 0.04, 0.001, 0.016, false},
    };
    d.plots = {{"Draft over height",
                {"time", "s"},
                {"share under water", ""},
                {{"orange", Series::Style::line, {}, orange},
                 {"green", Series::Style::line, {}, green},
                 {"orange: ρ/ρ_water", Series::Style::line, {}, gold},
                 {"green: ρ/ρ_water", Series::Style::line, {}, teal}}},
               {"Pressure in the middle",
                {"depth", "m"},
                {"pressure", "kPa"},
                {{"measured", Series::Style::points}, {"ρ g d"}}}};
    d.inputs = {{"tap", "Tap (hold)", {"KeyT", "Space"}, false, 1}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    wall(stage, {width_ / 2, -0.1}, {width_ / 2 + 0.2, 0.1});
    wall(stage, {-0.1, 0.6}, {0.1, 0.6});
    wall(stage, {width_ + 0.1, 0.6}, {0.1, 0.6});
    const double depth = stage.value("depth");
    light_ = box(stage, "orange", {0.45, depth + 0.25}, {0.16f, 0.12f}, stage.valuef("light"), orange);
    half_ = box(stage, "green", {1.15, depth + 0.3}, {0.2f, 0.15f}, stage.valuef("half"), green);
    rigid::BodyDef<Dim2> body;
    body.position = {1.95, depth + 0.3};
    body.name = "ball";
    rigid::ShapeDef<Dim2> shape;
    shape.density = stage.valuef("heavy");
    stage.add(body, geometry::Circle{0.13f}, shape, red);
    fluid_ = stage.keep(held(Fluid2::create({.upper = {width_, 1.3},
                                             .spacing = stage.valuef("spacing"),
                                             .viscosity = stage.valuef("viscosity"),
                                             .max_particles = 40000,
                                             .threads = 1})));
    if (!fluid_) return;
    stage.check(fluid_->add_box({0, 0}, {width_, depth}));
    particles::FluidTap<Dim2> tap{.center = {0.15, 1.25}, .velocity = {0, -1.5f}, .radius = 0.05f, .tag = 1};
    tap.open = false;
    tap_ = stage.keep(fluid_->add_tap(tap));
    draw(stage);
  }

  void before_step(Stage2& stage) override {
    if (!fluid_) return;
    particles::FluidTap<Dim2> tap{.center = {0.15, 1.25}, .velocity = {0, -1.5f}, .radius = 0.05f, .tag = 1};
    tap.open = stage.input("tap") > 0;
    stage.check(fluid_->set_tap(tap_, tap));
    stage.check(fluid_->step(stage.world(), float(stage.declaration().dt)));
  }

  void after_step(Stage2& stage) override {
    if (!fluid_) return;
    draw(stage);
    const double t = stage.world().time();
    light_draft_ = draft(stage, light_, 0.24);
    half_draft_ = draft(stage, half_, 0.3);
    if (t > 5) {
      half_mean_ += half_draft_;
      light_mean_ += light_draft_;
      ++samples_;
    }
    stage.sample(0, 0, t, light_draft_);
    stage.sample(0, 1, t, half_draft_);
    stage.sample(0, 2, t, stage.value("light") / 1000);
    stage.sample(0, 3, t, stage.value("half") / 1000);
    const double phase = t - 0.5 * double(int(t / 0.5)), level = fluid_->surface_height({1.55, 0});
    if (phase < 1.0 / 60)
      for (double y = 0.03; y < level; y += 0.06) {
        stage.sample(1, 0, level - y, fluid_->pressure({1.55, y}) / 1000);
        stage.sample(1, 1, level - y, 9.80665 * (level - y));
      }
  }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    (void)stage;
    const double n = samples_ > 0 ? samples_ : 1;
    out.push_back({"draft of the orange box", "", "Archimedes: ρ/ρ_water", light_mean_ / n, 0.3, 0.05});
    out.push_back({"draft of the green box", "", "Archimedes: ρ/ρ_water", half_mean_ / n, 0.6, 0.05});
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return fluid_ ? world ^ fluid_->state_hash() : world; }

 private:
  static constexpr double width_ = 2.4;

  static core::Result<std::optional<Fluid2>> held(core::Result<Fluid2> made) {
    if (!made.ok()) return made.error();
    return std::optional<Fluid2>(std::move(made).value());
  }
  void wall(Stage2& stage, Vec2d at, Vec2d half) {
    rigid::BodyDef<Dim2> body;
    body.type = rigid::BodyType::fixed;
    body.position = at;
    stage.add(body, geometry::make_box2(Vec2f(half)), {}, steel);
  }
  BodyId box(Stage2& stage, const char* name, Vec2d at, Vec2f half, float density, std::uint32_t color) {
    rigid::BodyDef<Dim2> body;
    body.position = at;
    body.name = name;
    rigid::ShapeDef<Dim2> shape;
    shape.density = density;
    return stage.add(body, geometry::make_box2(half), shape, color);
  }
  /// Of the height along the box's own vertical, against the mean level of the tank.
  double draft(Stage2& stage, BodyId body, double height) {
    // The median column: under a box a column ends at the box.
    double columns[25];
    for (int i = 0; i < 25; ++i) columns[i] = fluid_->surface_height({width_ * (i + 0.5) / 25, 0});
    std::sort(columns, columns + 25);
    const double level = columns[14];
    return (level - (stage.at(body).pose.position.y - height / 2)) / height;
  }
  void draw(Stage2& stage) { look_.draw(stage, *fluid_, 1.6f); }

  BodyId light_, half_;
  std::optional<Fluid2> fluid_;
  LiquidLook<Dim2> look_;
  int tap_ = 0, samples_ = 0;
  double light_draft_ = 0, half_draft_ = 0, light_mean_ = 0, half_mean_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_fluid_tank() { return std::make_unique<FluidTank>(); }

}  // namespace carom::host::demo
