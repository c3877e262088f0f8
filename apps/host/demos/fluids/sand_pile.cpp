// A column of sand that falls, and a heap that is poured: how steep sand can be.
#include <algorithm>

#include "apps/host/demos/fluids/fluids.h"
#include "carom/particles/granular.h"

namespace carom::host::demo {
namespace {

using particles::Granular2;
using rigid::Dim2;

class SandPile final : public Repeatable<SandPile, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "sand-pile";
    d.title = "Sand pile";
    d.summary = "A column of sand collapses into a heap; friction and rolling friction decide how steep it stays.";
    d.group = "Fluids";
    d.chapter = "3.3, beyond";
    d.dimension = 2;
    d.text =
        "Every grain is a disc that touches its neighbours under Coulomb's law, and resists rolling as real, angular "
        "grains do:\n\n"
        "  |F_t| ≤ μ F_n,   |M| ≤ μ_r r F_n\n\n"
        "A column of the width L and the height H is let go at t = 0.5 s. How far it runs depends on its shape alone; "
        "smooth round discs in the computer run as far as Staron and Hinch found (2005),\n\n"
        "  ΔL/L ≈ 2.5 H/L  for H/L < 2,\n\n"
        "real sand in a channel about half as far (Lube et al. 2005: 1.2 H/L): that is what rolling friction is for. "
        "The slope of the flank is the angle of repose.";
    d.duration = 5;
    d.camera = {{0.7, 0.38, 6}, {0.7, 0.38, 0}, 0.75, 1.05, 1.8};
    d.ground = 0;
    d.parameters = {
        {"friction", "Friction μ", "", "", "between grains", 0, 1, 0, 0.5, false},
        {"rolling", "Rolling friction μ_r", "", "", "0: round and smooth", 0, 1, 0, 0.3, false},
        {"width", "Width of the column L", "m", "m", "", 0.2, 0.6, 0.02, 0.4, false},
        {"height", "Height of the column H", "m", "m", "", 0.2, 1.2, 0.02, 0.6, false},
        {"radius", "Radius of the grains", "m", "mm", "", 0.006, 0.03, 0.001, 0.009, false},
        {"box", "Density of the box on top", "kg/m³", "kg/m³", "0: none", 0, 4000, 100, 800, false},
    };
    d.plots = {{"Way of the front",
                {"time", "s"},
                {"ΔL/L", ""},
                {{"front"}, {"Staron & Hinch: 2.5 H/L"}, {"Lube et al.: 1.2 H/L"}}},
               {"Slope of the flank", {"time", "s"}, {"angle", "°"}, {{"flank"}}},
               {"Energy", {"time", "s"}, {"energy", "J"}, {{"kinetic"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    const double width = stage.value("width"), height = stage.value("height");
    rigid::BodyDef<Dim2> body;
    body.type = rigid::BodyType::fixed;
    body.position = {1.4, -0.05};
    stage.add(body, geometry::make_box2({1.5f, 0.05f}), {}, sand);
    body.position = {-0.05, 0.7};
    stage.add(body, geometry::make_box2({0.05f, 0.7f}), {}, steel);
    body.position = {width + 0.03, 0.7};
    gate_ = stage.add(body, geometry::make_box2({0.03f, 0.7f}), {}, steel);
    auto made = Granular2::create({.upper = {2.8, 2},
                                   .radius = stage.valuef("radius"),
                                   .friction = stage.valuef("friction"),
                                   .rolling_friction = stage.valuef("rolling"),
                                   .wall_friction = stage.valuef("friction"),
                                   .threads = stage.threads()});
    if (!made.ok()) return stage.fail(made.error());
    grains_ = std::move(made).value();
    stage.check(grains_->add_box({0, 0}, {width, height}));
    if (stage.value("box") > 0) {
      rigid::BodyDef<Dim2> box;
      box.position = {width / 2, height + 0.1};
      rigid::ShapeDef<Dim2> shape;
      shape.density = stage.valuef("box");
      stage.add(box, geometry::make_box2({0.07f, 0.05f}), shape, violet);
    }
    open_ = false;
    first_height_ = height;
    draw(stage);
  }

  void before_step(Stage2& stage) override {
    if (!grains_) return;
    if (!open_ && stage.world().time() >= 0.5) {
      stage.remove(gate_);
      open_ = true;
      first_height_ = 0;
      for (int i = 0; i < grains_->size(); ++i)
        first_height_ = math::max(first_height_, grains_->position(i).y + double(grains_->radius(i)));
    }
    stage.check(grains_->step(stage.world(), float(stage.declaration().dt)));
  }

  void after_step(Stage2& stage) override {
    if (!grains_) return;
    draw(stage);
    const double t = stage.world().time(), width = stage.value("width");
    std::vector<double> x;
    for (int i = 0; i < grains_->size(); ++i) x.push_back(grains_->position(i).x);
    if (x.empty()) return;
    std::sort(x.begin(), x.end());
    const double front = x[x.size() * 99 / 100];
    run_ = math::max(0.0, (front - width) / width);
    stage.sample(0, 0, t, run_);
    stage.sample(0, 1, t, 2.5 * first_height_ / width);
    stage.sample(0, 2, t, 1.2 * first_height_ / width);
    // A straight line through the tops of columns on the flank.
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    const double wide = 5 * stage.value("radius");
    for (double low = 0.25 * front; low < 0.9 * front; low += wide) {
      double top = 0;
      for (int i = 0; i < grains_->size(); ++i) {
        const Vec2d p = grains_->position(i);
        if (p.x >= low && p.x < low + wide) top = math::max(top, p.y);
      }
      n += 1, sx += low, sy += top, sxx += low * low, sxy += low * top;
    }
    const double spread = n * sxx - sx * sx;
    if (open_ && spread > 0) slope_ = -math::atan((n * sxy - sx * sy) / spread) * 180 / pi;
    if (open_) stage.sample(1, 0, t, slope_);
    stage.sample(2, 0, t, grains_->kinetic_energy());
  }

  void expectations(Stage2&, std::vector<Expectation>& out) override {
    out.push_back({"slope of the flank", "°", "sand: 20 … 35°", slope_, 26, 9});
    out.push_back({"kinetic energy at the end", "J", "at rest", grains_ ? grains_->kinetic_energy() : 0, 0, 0.5});
  }

  std::uint64_t state_hash(std::uint64_t world) const override {
    return grains_ ? world ^ grains_->state_hash() : world;
  }

 private:
  void draw(Stage2& stage) {
    const int n = grains_->size();
    places_.resize(n);
    radii_.resize(n);
    colors_.resize(n);
    for (int i = 0; i < n; ++i) {
      const Vec2d p = grains_->position(i);
      places_[i] = {float(p.x), float(p.y), 0};
      radii_[i] = grains_->radius(i);
      const std::uint32_t shade = std::uint32_t(60 * (grains_->radius(i) / stage.valuef("radius") - 0.8f) / 0.2f);
      colors_[i] = (160u + shade) << 24 | (125u + shade) << 16 | (70u + shade) << 8 | 0xffu;
    }
    stage.points(places_, radii_, colors_);
  }

  std::optional<Granular2> grains_;
  rigid::BodyId gate_;
  bool open_ = false;
  double first_height_ = 0, slope_ = 0, run_ = 0;
  std::vector<Vec3f> places_;
  std::vector<float> radii_;
  std::vector<std::uint32_t> colors_;
};

}  // namespace

std::unique_ptr<Demo> make_sand_pile() { return std::make_unique<SandPile>(); }

}  // namespace carom::host::demo
