// The collapse of a column of water against the experiment of Martin and Moyce.
#include "apps/host/demos/fluids/fluids.h"

namespace carom::host::demo {
namespace {

using particles::Fluid2;
using rigid::Dim2;

class DamBreak final : public Repeatable<DamBreak, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "dam-break";
    d.title = "Dam break";
    d.summary = "A column of water is let go, beside what Martin and Moyce measured in 1952.";
    d.group = "Fluids";
    d.chapter = "beyond";
    d.dimension = 2;
    d.text =
        "A column of the width a and twice as high stands behind a wall that vanishes. In dimensionless numbers the "
        "collapse is the same for every size (Froude's law), so the experiment with a = 57 mm can be laid beside a "
        "column of a metre:\n\n"
        "  T = t √(2 g/a),   Z = x_front/a,   τ = t √(g/a),   η = h/(2 a)\n\n"
        "The column's height η follows the measured one to 4 %. The front is ahead by about T = 0.3 all the way: the "
        "wall of the experiment (wax paper, melted by a current) did not vanish at once, and its floor was not "
        "without friction; the speed of the front agrees to 10 %.\n\n"
        "J. C. Martin, W. J. Moyce, Phil. Trans. R. Soc. A 244 (1952) 312, n² = 2, a = 2¼ in.";
    d.dt = 1.0 / 120;
    d.duration = 2.5;
    d.loop = true;
    d.camera = {{3.6, 1.2, 6}, {3.6, 1.2, 0}, 0.75, 3.4, 7.8};
    d.parameters = {
        {"size", "Width of the column a", "m", "m", "", 0.05, 2, 0, 1, false},
        {"particles", "Particles across", "", "", "", 8, 40, 2, 24, false},
        {"viscosity", "Kinematic viscosity", "m²/s", "m²/s", "", 0, 0.1, 0, 1e-6, false},
    };
    Series front{"Martin & Moyce", Series::Style::points};
    for (const auto& [time, z] : front_data) front.points.push_back({time, z});
    Series height{"Martin & Moyce", Series::Style::points};
    for (const auto& [time, h] : height_data) height.points.push_back({time, h});
    d.plots = {{"Front", {"T = t √(2g/a)", ""}, {"Z = x/a", ""}, {{"simulation"}, front}},
               {"Column at the wall", {"τ = t √(g/a)", ""}, {"η = h/2a", ""}, {{"simulation"}, height}},
               {"Energy", {"time", "s"}, {"share of that at the start", ""}, {{"all"}, {"kinetic"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    a_ = stage.value("size");
    rigid::BodyDef<Dim2> body;
    body.type = rigid::BodyType::fixed;
    body.position = {3.6 * a_, -0.05 * a_};
    stage.add(body, geometry::make_box2({float(3.7 * a_), float(0.05 * a_)}), {}, steel);
    body.position = {-0.05 * a_, 1.2 * a_};
    stage.add(body, geometry::make_box2({float(0.05 * a_), float(1.2 * a_)}), {}, steel);
    body.position = {7.25 * a_, 1.2 * a_};
    stage.add(body, geometry::make_box2({float(0.05 * a_), float(1.2 * a_)}), {}, steel);
    stage.set_camera({{3.6 * a_, 1.2 * a_, 6}, {3.6 * a_, 1.2 * a_, 0}, 0.75, 3.4 * a_, 7.8 * a_});
    auto made = Fluid2::create({.upper = {7.2 * a_, 2.8 * a_},
                                .spacing = float(a_ / stage.value("particles")),
                                .viscosity = stage.valuef("viscosity"),
                                .threads = stage.threads()});
    if (!made.ok()) return stage.fail(made.error());
    fluid_ = std::move(made).value();
    stage.check(fluid_->add_box({0, 0}, {a_, 2 * a_}));
    energy_ = fluid_->potential_energy();
    look_.draw(stage, *fluid_, float(math::sqrt(8 * 9.80665 * a_)));
  }

  void before_step(Stage2& stage) override {
    if (fluid_) stage.check(fluid_->step(stage.world(), float(stage.declaration().dt)));
  }

  void after_step(Stage2& stage) override {
    if (!fluid_) return;
    look_.draw(stage, *fluid_, float(math::sqrt(8 * 9.80665 * a_)));
    const double t = stage.world().time(), unit = math::sqrt(2 * 9.80665 / a_);
    const double y = a_ / stage.value("particles");
    double front = 7.2;
    while (front > 0 && fluid_->density({front * a_, y}) < 0.5) front -= 0.02;
    const double height = fluid_->surface_height({y, 0}) / (2 * a_);
    if (front < 7) {
      stage.sample(0, 0, t * unit, front);
      if (front >= 2.11 && first_ == 0) first_ = t * unit;
      if (front >= 4.11 && second_ == 0) second_ = t * unit;
    }
    const double tau = t * unit / math::sqrt(2.0);
    if (tau < 3.6) stage.sample(1, 0, tau, height);
    if (tau < 1.66) height_ = height;
    stage.sample(2, 0, t, (fluid_->kinetic_energy() + fluid_->potential_energy()) / energy_);
    stage.sample(2, 1, t, fluid_->kinetic_energy() / energy_);
  }

  void expectations(Stage2&, std::vector<Expectation>& out) override {
    out.push_back({"speed of the front from Z = 2.11 to 4.11", "", "Martin & Moyce 1952", 2 / (second_ - first_),
                   2 / 1.50, 0.14});
    out.push_back({"height of the column at τ = 1.66", "", "Martin & Moyce 1952", height_, 0.61, 0.04});
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return fluid_ ? world ^ fluid_->state_hash() : world; }

 private:
  static constexpr double front_data[][2] = {{0.41, 1.11}, {0.84, 1.22}, {1.19, 1.44}, {1.43, 1.67}, {1.63, 1.89},
                                             {1.83, 2.11}, {1.98, 2.33}, {2.20, 2.56}, {2.32, 2.78}, {2.51, 3.00},
                                             {2.65, 3.22}, {2.83, 3.44}, {2.98, 3.67}, {3.11, 3.89}, {3.33, 4.11}};
  static constexpr double height_data[][2] = {{0.56, 0.94}, {0.77, 0.89}, {0.93, 0.83}, {1.08, 0.78}, {1.28, 0.72},
                                              {1.46, 0.67}, {1.66, 0.61}, {1.84, 0.56}, {2.00, 0.50}, {2.21, 0.44},
                                              {2.45, 0.39}, {2.70, 0.33}, {3.06, 0.28}, {3.44, 0.22}};
  double a_ = 1, energy_ = 1, first_ = 0, second_ = 0, height_ = 0;
  std::optional<Fluid2> fluid_;
  LiquidLook<Dim2> look_;
};

}  // namespace

std::unique_ptr<Demo> make_dam_break() { return std::make_unique<DamBreak>(); }

}  // namespace carom::host::demo
