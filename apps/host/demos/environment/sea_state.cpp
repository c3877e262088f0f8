// A sea drawn from a spectrum: the surface that is shown is the one that floats the bodies.
#include "apps/host/demos/demos.h"
#include "apps/host/demos/environment/environment_demos.h"
#include "carom/environment/environment.h"

namespace carom::host::demo {
namespace {

using environment::Sea;
using rigid::BodyId;
using rigid::Dim3;

class SeaState final : public Repeatable<SeaState, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "sea_state";
    d.title = "Sea state";
    d.summary =
        "Waves from a JONSWAP spectrum: what is drawn is what floats the raft, the buoy, the log and the crate.";
    d.group = "Wind, water and fields";
    d.chapter = "3, 16";
    d.text =
        "A sea is a sum of long-crested waves whose energy over frequency is a spectrum,\n\n"
        "  S(ω) = α g² ω⁻⁵ exp(−5/4 (ω_p/ω)⁴) γ^b,  b = exp(−(ω − ω_p)²/(2 σ² ω_p²))\n\n"
        "spread over the directions as cos²ˢ(θ/2). γ = 1 is the fully grown sea of Pierson and Moskowitz, 3.3 the mean "
        "of "
        "the JONSWAP measurements. The significant height is what an old sailor would call the height of the waves:\n\n"
        "  H_s = 4 √m₀,  m₀ = ∫ S dω = Σ ½ a²\n\n"
        "Long waves run faster, ω² = g k tanh(k h): pick a few and watch them pass through one another. Under the "
        "surface "
        "the water goes round in circles that shrink as e^(ky); at the surface Wheeler's stretching carries linear "
        "theory "
        "up to the real water line. A body is lifted by the water it displaces, pushed with the water's own "
        "acceleration, "
        "and feels waves shorter than itself only in the mean: the raft rides the swell and ignores the ripples.";
    d.duration = 40;
    d.camera = {{17, 6.5, 21}, {0, -0.5, -2}};
    d.parameters = {
        {"height", "Significant height H_s", "m", "m", "4 √m₀", 0.1, 6, 0, 1.6, false},
        {"period", "Peak period T_p", "s", "s", "", 3, 16, 0, 5.5, false},
        {"gamma", "Peak enhancement γ", "", "", "1: fully grown; 3.3: JONSWAP; 7: swell", 1, 7, 0, 3.3, false},
        {"spread", "Spread s", "", "", "of cos²ˢ(θ/2); high: long crests", 1, 80, 1, 10, false},
        {"direction", "Direction", "rad", "deg", "where the waves go to", -3.14159265, 3.14159265, 0, 0.35, false},
        {"current", "Current", "m/s", "m/s", "along x", -2, 2, 0, 0.3, false},
        {"depth", "Depth", "m", "m", "", 2, 200, 0, 100, false},
        {"components", "Waves in the sum", "", "", "", 1, 128, 1, 48, false},
        {"seed", "Seed", "", "", "", 1, 99, 1, 7, false},
    };
    d.plots = {{"Wave staff and raft", {"time", "s"}, {"height", "m"}, {{"water at the raft"}, {"raft"}}},
               {"Spectrum", {"ω", "rad/s"}, {"S", "m²·s"}, {{"JONSWAP"}, {"waves in the sum", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.allow_sleep = false;
    stage.start(world);
    environment::SeaDef def;
    def.spectrum = {stage.value("height"), stage.value("period"), stage.value("gamma")};
    def.spread = stage.value("spread");
    def.direction = stage.value("direction");
    def.components = stage.count("components");
    def.seed = std::uint64_t(stage.count("seed"));
    environment::Environment::Definition around;
    around.water =
        stage.keep(Sea::make({.depth = stage.value("depth"), .current = {stage.value("current"), 0, 0}}, def));
    around_ =
        std::make_shared<const environment::Environment>(stage.keep(environment::Environment::make(std::move(around))));
    if (around_->water() == nullptr) return;
    stage.keep(stage.world().add_effector(rigid::Surroundings<Dim3>{around_}));
    rigid::Buoyancy<Dim3> water;
    water.linear_drag = 0.5;
    water.angular_drag = 0.8;
    water.added_mass = {0.2f, 0.6f, 0.2f};
    stage.keep(stage.world().add_effector(water));

    raft_ = float_body(stage, "raft", {0, 0.3, 0}, {}, geometry::Box{{3, raft_half_, 2}}, 450, sand);
    for (const auto& actor : stage.actors())
      if (actor.body == raft_) stage.follow(int(actor.id));
    float_body(stage, "crate", {-7, 0.5, 4}, {0.97f, 0.1f, 0.2f, 0}, geometry::Box{{0.9f, 0.9f, 0.9f}}, 620, orange);
    float_body(stage, "buoy", {6, 0.4, -5}, {}, geometry::Sphere{0.9f}, 380, red);
    float_body(stage, "log", {-2, 0.2, 8}, {0.7071f, 0, 0, 0.7071f}, geometry::Capsule3{2.2f, 0.4f}, 640, gold);
    for (int i = 0; i < 5; ++i)
      float_body(stage, "float", {-12.0 + 6 * i, 0.3, -12}, {}, geometry::Sphere{0.3f}, 300, i % 2 ? violet : teal);

    std::vector<std::uint32_t> triangles;
    for (std::uint32_t row = 0; row + 1 < cells_; ++row)
      for (std::uint32_t column = 0; column + 1 < cells_; ++column) {
        const std::uint32_t a = row * cells_ + column, b = a + 1, c = a + cells_, e = c + 1;
        triangles.insert(triangles.end(), {a, c, b, b, c, e});
      }
    surface_ = stage.add_surface(std::move(triangles), pen(0x2f7fae, 0xc8));
    show_sea(stage);
    show_spectrum(stage, def);
  }

  void after_step(Stage3& stage) override {
    if (around_ == nullptr || around_->water() == nullptr) return;
    show_sea(stage);
    const double t = stage.world().time();
    const auto raft = stage.at(raft_);
    // The raft feels the mean over its own size.
    const double eta = around_->water()->sample(raft.center_of_mass, t, {3.0, 0, 4.0 / 3}).height;
    stage.sample(0, 0, t, eta);
    stage.sample(0, 1, t, raft.center_of_mass.y);
    if (t > 8) {
      gap_ += raft.center_of_mass.y - eta;
      ++count_;
    }
    highest_ = max(highest_, eta);
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"4 √(Σ a²/2)", "m", "H_s asked for", around_->water()->significant_height(), 1.6, 1e-6});
    // In fresh air the raft of relative density 450/1025 has its middle this much over the water.
    const double height = 2 * double(raft_half_);
    out.push_back({"the raft's middle over the water, mean", "m", "Archimedes: h (½ − ρ/ρ_w)", gap_ / max(1, count_),
                   height * (0.5 - 450.0 / 1025), 0.05});
    out.push_back({"the highest crest at the raft", "m", "within .3 … 1 of H_s", highest_, 1.05, 0.55});
  }

 private:
  static constexpr std::uint32_t cells_ = 84;
  static constexpr double spacing_ = 1.2;
  static constexpr float raft_half_ = 0.4f;

  BodyId float_body(Stage3& stage, const char* name, Vec3d position, Quatf rotation, const geometry::Shape3& shape,
                    float density, std::uint32_t color) {
    rigid::BodyDef<Dim3> def;
    def.name = name;
    def.position = position;
    def.rotation = normalize(rotation);
    rigid::ShapeDef<Dim3> form;
    form.density = density;
    return stage.add(def, shape, form, color);
  }

  void show_sea(Stage3& stage) {
    // The patch goes with the current in whole cells, so that the raft stays over it.
    const double drift = stage.value("current") * stage.world().time();
    const double left = spacing_ * (math::round(drift / spacing_) - 0.5 * (cells_ - 1)),
                 near = -0.5 * spacing_ * (cells_ - 1);
    std::vector<double> heights(cells_ * cells_);
    around_->water()->grid(left, near, spacing_, int(cells_), int(cells_), stage.world().time(), heights);
    std::vector<Vec3f> corners(heights.size());
    for (std::size_t i = 0; i < heights.size(); ++i) {
      const std::size_t row = i / cells_, column = i % cells_;
      corners[i] = {float(left + spacing_ * double(column)), float(heights[i]), float(near + spacing_ * double(row))};
    }
    stage.set_surface(surface_, corners);
  }

  static void show_spectrum(Stage3& stage, const environment::SeaDef& def) {
    const double peak = 2 * math::pi / def.spectrum.peak_period;
    constexpr int bands = 14;
    double energy[bands] = {};
    const auto edge = [&](int i) { return peak * (0.5 + 2.5 * i / bands); };
    Sea sea = stage.keep(Sea::make({.depth = stage.value("depth")}, def));
    for (const environment::WaveComponent& w : sea.components())
      for (int i = 0; i < bands; ++i)
        if (w.frequency >= edge(i) && w.frequency < edge(i + 1)) energy[i] += 0.5 * w.amplitude * w.amplitude;
    for (int i = 0; i <= 80; ++i) {
      const double omega = peak * (0.5 + 2.5 * i / 80);
      stage.sample(1, 0, omega, environment::spectral_density(def.spectrum, omega));
    }
    for (int i = 0; i < bands; ++i)
      stage.sample(1, 1, 0.5 * (edge(i) + edge(i + 1)), energy[i] / (edge(i + 1) - edge(i)));
  }

  std::shared_ptr<const environment::Environment> around_;
  BodyId raft_;
  int surface_ = 0, count_ = 0;
  double gap_ = 0, highest_ = -1e9;
};

}  // namespace

std::unique_ptr<Demo> make_sea_state() { return std::make_unique<SeaState>(); }

}  // namespace carom::host::demo
