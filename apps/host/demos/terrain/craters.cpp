// Shells dig craters into a height field, and what stood there tumbles in.
#include "apps/host/demos/terrain/list.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Craters final : public Repeatable<Craters, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "craters";
    d.title = "Craters";
    d.summary =
        "Whatever strikes the ground hard enough leaves a crater. Throw balls at the field; stacks fall into the pits.";
    d.group = "Terrain";
    d.text =
        "The ground is a height field that changes while the world runs. Where something strikes with the energy E, a "
        "pit is dug whose volume grows with E; the soil is thrown up as a rim,\n\n"
        "  Δh = −D (1 − ρ²) e^(−ρ²),  ρ = r/R,\n\n"
        "whose integral over the plane is zero: no soil is lost. Stacks that have fallen asleep wake when the ground "
        "under them goes, and only those. Throw balls (the hand tool) or let shells come down.";
    d.duration = 12;
    d.camera = {{13, 9, 15}, {0, 0.4, 0}};
    d.parameters = {
        {"pace", "Time between shells", "s", "s", "", 0.5, 6, 0.1, 2, true},
        {"soil", "Energy to dig a cubic metre", "J", "kJ", "of the pit", 2e3, 2e5, 0, 2e4, true},
        {"stacks", "Stacks of crates", "", "", "", 1, 25, 1, 9, false},
    };
    d.plots = {{"Lowest ground", {"time", "s"}, {"depth", "m"}, {{"deepest pit"}}},
               {"Awake bodies", {"time", "s"}, {"bodies", ""}, {{"awake"}, {"all"}}}};
    d.inputs = {{"shell", "Fire a shell", {"Space"}, true, 1}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    heights_.assign(std::size_t(side_) * std::size_t(side_), 0);
    for (int z = 0; z < side_; ++z)
      for (int x = 0; x < side_; ++x) heights_[at(x, z)] = 0.25f * sin(0.13f * float(x)) * cos(0.11f * float(z));
    rigid::BodyDef<Dim3> ground;
    ground.type = rigid::BodyType::fixed;
    ground.name = "ground";
    ground.position = {-half(), 0, -half()};
    rigid::ShapeDef<Dim3> soil;
    soil.material.friction = 0.8f;
    soil.material.rolling_resistance = 0.05f;
    soil.hit_events = true;
    auto field = geometry::make_height_field(side_, side_, {cell_, cell_}, heights_);
    if (!field.ok()) return stage.fail(field.error());
    ground_ = stage.add(ground, field.value(), soil, 0x8b7a55);
    std::vector<rigid::ShapeId> shapes;
    stage.world().shapes(ground_, shapes);
    soil_ = shapes.front();
    volume_ = volume();
    const int stacks = stage.count("stacks"), along = int(ceil(sqrt(double(stacks))));
    for (int s = 0; s < stacks; ++s) {
      const int column = s % along, row = s / along;
      const double x = 5.0 * (column - 0.5 * (along - 1)), z = 5.0 * (row - 0.5 * (along - 1));
      targets_.push_back({x, 0, z});
      const double floor = height(x, z);
      for (int k = 0; k < 4; ++k) {
        rigid::BodyDef<Dim3> crate;
        crate.name = "crate";
        crate.position = {x, floor + 0.36 + 0.71 * k, z};
        rigid::ShapeDef<Dim3> wood;
        wood.density = 300;
        const BodyId id = stage.add(crate, geometry::Box{{0.35f, 0.35f, 0.35f}}, wood, k % 2 ? gold : sand);
        if (s == 0) tower_ = id;
      }
    }
    top_ = stage.at(tower_).pose.position.y;
  }

  void before_step(Stage3& stage) override {
    const double t = stage.world().time();
    if (t >= next_ || stage.presses("shell") > 0) {
      next_ = t + stage.value("pace");
      fire(stage, targets_[std::size_t(fired_ % int(targets_.size()))]);
    }
    // What has dug in goes after a while.
    std::erase_if(shells_, [&](const Shell& s) {
      if (t - s.born < 4) return false;
      if (stage.world().contains(s.body)) stage.remove(s.body);
      return true;
    });
  }

  void after_step(Stage3& stage) override {
    struct Blow {
      Vec3d point;
      double energy;
    };
    std::vector<Blow> blows;
    for (const rigid::ContactHitEvent<Dim3>& hit : stage.world().events().contact_hit) {
      if (hit.shape_a != soil_ && hit.shape_b != soil_) continue;
      // Of a body that is stopped: impulse m v and speed v make ½ m v².
      const double energy = 0.5 * double(hit.impulse) * double(hit.approach_speed);
      if (energy > 300) blows.push_back({hit.point, energy});
    }
    for (const Blow& blow : blows) dig(stage, blow.point, blow.energy);
    if (!blows.empty()) stage.redraw(ground_);
    const rigid::Counters counters = stage.world().counters();
    double lowest = 0;
    for (const float h : heights_) lowest = min(lowest, double(h));
    stage.sample(0, 0, stage.world().time(), lowest);
    stage.sample(1, 0, stage.world().time(), counters.awake_bodies);
    stage.sample(1, 1, stage.world().time(), counters.bodies - 1);
    stage.say(format("%.0f craters, the deepest %.2f m; %.0f of %.0f bodies awake", dug_, -lowest,
                     counters.awake_bodies, counters.bodies - 1));
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"craters at least", "", "one each shell", min(dug_, 5.0), 5, 0});
    out.push_back({"soil lost", "m³", "none: the pit's is in its rim", volume() - volume_, 0, 0.05});
    out.push_back({"the first stack fell", "", "the ground under it went",
                   stage.at(tower_).pose.position.y < top_ - 0.5 ? 1.0 : 0.0, 1, 0});
  }

 private:
  struct Shell {
    BodyId body;
    double born;
  };
  static constexpr int side_ = 97;
  static constexpr float cell_ = 0.25f;
  static constexpr double half() { return 0.5 * double(cell_) * (side_ - 1); }
  static std::size_t at(int x, int z) { return std::size_t(z) * std::size_t(side_) + std::size_t(x); }
  double height(double x, double z) const {
    const int i = clamp(int((x + half()) / double(cell_) + 0.5), 0, side_ - 1),
              j = clamp(int((z + half()) / double(cell_) + 0.5), 0, side_ - 1);
    return double(heights_[at(i, j)]);
  }
  double volume() const {
    double sum = 0;
    for (const float h : heights_) sum += double(h);
    return sum * square(double(cell_));
  }
  void fire(Stage3& stage, Vec3d target) {
    rigid::BodyDef<Dim3> shell;
    shell.name = "shell";
    shell.bullet = true;
    shell.position = target + Vec3d{0.9 + 8 * 0.35, 8 + height(target.x, target.z), 0.6};
    shell.linear_velocity = {-10.5f, -30, 0};
    rigid::ShapeDef<Dim3> iron;
    iron.density = 4000;
    iron.material.restitution = 0;
    shells_.push_back({stage.add(shell, geometry::Sphere{0.18f}, iron, dark), stage.world().time()});
    ++fired_;
  }
  /// The volume of the pit alone is π R² D/e; a third of its radius deep.
  void dig(Stage3& stage, Vec3d point, double energy) {
    const double volume = energy / stage.value("soil"), e = 2.718281828459045;
    const double radius = clamp(cbrt_of(3 * e * volume / pi), 0.3, 2.5),
                 depth = min(radius / 3, volume * e / (pi * square(radius)));
    const double reach = 2.6 * radius, x = point.x + half(), z = point.z + half();
    const auto index = [&](double v) { return clamp(int(v / double(cell_)), 0, side_ - 1); };
    const int x0 = index(x - reach), x1 = index(x + reach), z0 = index(z - reach), z1 = index(z + reach);
    const auto square_of = [&](int i, int j) {
      return (square(double(cell_) * i - x) + square(double(cell_) * j - z)) / square(radius);
    };
    // On the grid the 1 of the formula is what makes the sum zero there.
    double weights = 0, moments = 0;
    for (int j = z0; j <= z1; ++j)
      for (int i = x0; i <= x1; ++i) {
        const double r2 = square_of(i, j);
        weights += exp(-r2), moments += r2 * exp(-r2);
      }
    std::vector<float> patch;
    for (int j = z0; j <= z1; ++j)
      for (int i = x0; i <= x1; ++i) {
        const double r2 = square_of(i, j);
        float& h = heights_[at(i, j)];
        h -= float(depth * (moments / weights - r2) * exp(-r2));
        patch.push_back(h);
      }
    stage.check(stage.world().set_heights(soil_, {x0, z0, x1 - x0 + 1, z1 - z0 + 1}, patch));
    dug_ += 1;
  }
  static double cbrt_of(double x) { return exp(log(x) / 3); }

  BodyId ground_, tower_;
  rigid::ShapeId soil_;
  std::vector<float> heights_;
  std::vector<Vec3d> targets_;
  std::vector<Shell> shells_;
  double next_ = 1.5, volume_ = 0, dug_ = 0, top_ = 0;
  int fired_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_craters() { return std::make_unique<Craters>(); }

}  // namespace carom::host::demo
