// A hill of voxels in which charges blow caves; what stands on the hill falls in.
#include "apps/host/demos/terrain/list.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Quarry final : public Repeatable<Quarry, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "quarry";
    d.title = "A quarry of voxels";
    d.summary =
        "Charges take bites out of a hill of cells; balls and crates on it follow. Each press lays another charge.";
    d.group = "Terrain";
    d.text =
        "The hill is a grid of cells, full or empty, each of a material (grass, soil, rock). A charge empties the "
        "cells "
        "within its radius and gives what lies near a push. Contacts see the faces between full and empty cells, and "
        "flat runs of them as one surface: a ball rolls over the seams without a hop. Rock needs twice the charge.";
    d.duration = 12;
    d.camera = {{13, 10, 16}, {0, 2, 0}};
    d.parameters = {
        {"radius", "Radius of a charge", "m", "m", "in soil; half of that in rock", 0.5, 3, 0.1, 1.8, true},
        {"pace", "Time between charges", "s", "s", "", 0.4, 5, 0.1, 1.5, true},
        {"balls", "Balls on the hill", "", "", "", 5, 150, 5, 40, false},
    };
    d.plots = {{"Cells of the hill", {"time", "s"}, {"full cells", ""}, {{"full"}}},
               {"Awake bodies", {"time", "s"}, {"bodies", ""}, {{"awake"}}}};
    d.inputs = {{"charge", "Another charge", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.looks_in_materials = true;
    stage.floor(0);
    std::vector<std::uint8_t> cells(std::size_t(side_ * layers_ * side_), 0);
    for (int k = 0; k < side_; ++k)
      for (int j = 0; j < layers_; ++j)
        for (int i = 0; i < side_; ++i) {
          const double x = (i + 0.5 - side_ / 2.0) / (side_ / 2.0), z = (k + 0.5 - side_ / 2.0) / (side_ / 2.0);
          const double top = 2 + (layers_ - 3) * exp(-2.2 * (x * x + z * z)) * (1 + 0.15 * sin(7 * x) * cos(5 * z));
          std::uint8_t& c = cells[index(i, j, k)];
          if (j < int(top)) c = j < int(0.45 * top) ? rock : j + 1 < int(top) ? soil : grass;
          full_ += c != 0;
        }
    auto grid = geometry::make_voxel_grid(side_, layers_, side_, cell_, cells);
    if (!grid.ok()) return stage.fail(grid.error());
    cells_ = std::move(cells);
    rigid::BodyDef<Dim3> hill;
    hill.type = rigid::BodyType::fixed;
    hill.name = "hill";
    hill.position = {-half(), 0, -half()};
    rigid::ShapeDef<Dim3> ground;
    const auto surface = [](std::uint32_t color) {
      rigid::SurfaceMaterial<Dim3> s;
      s.material.friction = 0.7f;
      s.material.rolling_resistance = 0.03f;
      s.material.user_id = 0xff000000u | color;
      return s;
    };
    ground.surfaces = {surface(0x7da052), surface(0x8f6f4a), surface(0x7f858c)};
    hill_ = stage.add(hill, grid.value(), ground);
    std::vector<rigid::ShapeId> shapes;
    stage.world().shapes(hill_, shapes);
    ground_ = shapes.front();
    Random draw{77};
    constexpr std::uint32_t colors[] = {orange, blue, gold, violet, red, teal};
    const int balls = stage.count("balls");
    for (int n = 0; n < balls; ++n) {
      rigid::BodyDef<Dim3> body;
      const double angle = 2.399963 * n, r = 0.75 * sqrt(double(n));  // a sunflower's spiral
      body.position = {r * cos(angle), 7.0 + 0.02 * n, r * sin(angle)};
      rigid::ShapeDef<Dim3> d;
      d.density = 500;
      d.material.user_id = 0xff000000u | colors[n % 6];
      body.name = n % 3 ? "ball" : "crate";
      bodies_.push_back(n % 3 ? stage.add(body, geometry::Sphere{0.3f}, d)
                              : stage.add(body, geometry::Box{{0.28f, 0.28f, 0.28f}}, d));
    }
    state_ = draw.state;
  }

  void before_step(Stage3& stage) override {
    const double t = stage.world().time();
    if (t < next_ && stage.presses("charge") == 0) return;
    next_ = t + stage.value("pace");
    Random draw{state_};
    const double angle = 2 * pi * draw(), r = 3.2 * draw();
    state_ = draw.state;
    blow(stage, {r * cos(angle), 0, r * sin(angle)});
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    stage.sample(0, 0, t, full_);
    stage.sample(1, 0, t, stage.world().counters().awake_bodies);
    stage.say(format("%.0f charges, %.0f cells are left", charges_, full_));
    for (const BodyId id : bodies_) lowest_ = min(lowest_, stage.at(id).pose.position.y);
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"cells gone at least", "", "several hundred", min(double(started_() - full_), 300.0), 300, 0});
    double mean = 0;
    for (const BodyId id : bodies_) mean += stage.at(id).pose.position.y / double(bodies_.size());
    out.push_back(
        {"mean height of what lay on the hill, at most 4 m", "", "it follows the ground", mean < 4 ? 1.0 : 0.0, 1, 0});
    out.push_back({"nothing fell through the ground", "", "the lowest layer stays", lowest_ > 0.2 ? 1.0 : 0.0, 1, 0});
  }

 private:
  enum : std::uint8_t { empty, grass, soil, rock };
  struct Random {
    std::uint64_t state;
    double operator()() {
      state = state * 6364136223846793005ull + 1442695040888963407ull;
      return double(state >> 11) / 9007199254740992.0;
    }
  };
  static constexpr int side_ = 40, layers_ = 14;
  static constexpr float cell_ = 0.5f;
  static constexpr double half() { return 0.5 * double(cell_) * side_; }
  static std::size_t index(int i, int j, int k) {
    return (std::size_t(k) * std::size_t(layers_) + std::size_t(j)) * std::size_t(side_) + std::size_t(i);
  }
  double started_() const { return full_ + gone_; }
  void blow(Stage3& stage, Vec3d place) {
    const int ci = clamp(int((place.x + half()) / double(cell_)), 0, side_ - 1),
              ck = clamp(int((place.z + half()) / double(cell_)), 0, side_ - 1);
    int top = layers_ - 1;
    while (top > 0 && cells_[index(ci, top, ck)] == 0) --top;
    const Vec3d center{place.x, double(cell_) * (top + 0.5), place.z};
    const double radius = stage.value("radius");
    const int reach = int(radius / double(cell_)) + 1;
    const auto cut = [](int v, int count) { return clamp(v, 0, count - 1); };
    const int i0 = cut(ci - reach, side_), i1 = cut(ci + reach, side_), j0 = max(1, top - reach),
              j1 = cut(top + reach, layers_), k0 = cut(ck - reach, side_), k1 = cut(ck + reach, side_);
    if (j1 < j0) return;
    std::vector<std::uint8_t> block;
    for (int k = k0; k <= k1; ++k)
      for (int j = j0; j <= j1; ++j)
        for (int i = i0; i <= i1; ++i) {
          std::uint8_t& c = cells_[index(i, j, k)];
          const Vec3d middle{double(cell_) * (i + 0.5) - half(), double(cell_) * (j + 0.5),
                             double(cell_) * (k + 0.5) - half()};
          const double reaches = c == rock ? 0.5 * radius : radius;
          if (c != 0 && length(middle - center) < reaches) c = 0, full_ -= 1, gone_ += 1;
          block.push_back(c);
        }
    stage.check(stage.world().set_cells(ground_, {i0, j0, k0, i1 - i0 + 1, j1 - j0 + 1, k1 - k0 + 1}, block));
    rigid::ExplosionDef<Dim3> push;
    push.center = center;
    push.radius = float(radius);
    push.falloff = float(radius);
    push.impulse_per_area = 300;
    (void)stage.keep(stage.world().explode(push));
    stage.redraw(hill_);
    charges_ += 1;
  }

  BodyId hill_;
  rigid::ShapeId ground_;
  std::vector<std::uint8_t> cells_;
  std::vector<BodyId> bodies_;
  std::uint64_t state_ = 0;
  double next_ = 3, full_ = 0, gone_ = 0, charges_ = 0, lowest_ = 100;
};

}  // namespace

std::unique_ptr<Demo> make_quarry() { return std::make_unique<Quarry>(); }

}  // namespace carom::host::demo
