// A field with wind: a profile over the ground, turbulence that drifts with it, the lee of a house, a thermal and
// gusts, shown by tracers and felt by balls.
#include "apps/host/demos/demos.h"
#include "apps/host/demos/environment/environment_demos.h"
#include "carom/environment/environment.h"
#include "carom/math/random.h"

namespace carom::host::demo {
namespace {

using environment::Environment;
using rigid::BodyId;
using rigid::Dim3;

class WindyField final : public Repeatable<WindyField, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "windy_field";
    d.title = "Wind over a field";
    d.summary =
        "A boundary layer, turbulence, the lee of a house, a thermal and gusts: every tracer feels its own air.";
    d.group = "Wind, water and fields";
    d.chapter = "3, 6, 15";
    d.text =
        "The wind is a field over place and time. Over the ground it grows as\n\n"
        "  V(h) = V₁₀ ln(h/z₀)/ln(10/z₀)\n\n"
        "and carries eddies of all sizes with it. Their energy over the wave number k along the wind is von "
        "Kármán's,\n\n"
        "  Φ_u = σ² (2L/π)/(1 + (1.339 L k)²)^(5/6)\n\n"
        "(Dryden's has the power 1: it is smoother). The field is a sum of waves of velocity, each across its own "
        "direction, so that no air is made or lost; it is the same for whoever asks, at any place and time.\n\n"
        "Behind the house the wind has lost what the drag took from it. Over the warm field air rises and sinks again "
        "around it. A gust comes as ½ (1 − cos πs/H). The colour of a tracer is its speed: blue slow, red fast.";
    d.duration = 20;
    d.camera = {{16, 24, 62}, {2, 9, 0}};
    d.ground = 0;
    d.parameters = {
        {"wind", "Wind at 10 m", "m/s", "m/s", "", 0, 25, 0, 8, true},
        {"roughness", "Roughness length z₀", "m", "cm", ".02 cm sea, 3 cm grass, 50 cm suburb", 2e-4, 0.5, 0, 0.03,
         true},
        {"sigma", "Turbulence σ", "m/s", "m/s", "", 0, 5, 0, 1.4, true},
        {"length", "Size of the eddies L", "m", "m", "", 5, 200, 0, 25, true},
        choice("dryden", "Spectrum", "of the eddies", {"von Kármán", "Dryden"}, 0, true),
        {"thermal", "Rise in the thermal", "m/s", "m/s", "", 0, 8, 0, 3, true},
        {"gust", "Strength of a gust", "m/s", "m/s", "", 0, 20, 0, 8, true},
        {"seed", "Seed", "", "", "of the eddies", 1, 99, 1, 3, true},
        {"house", "Height of the house", "m", "m", "", 2, 14, 0, 8, false},
    };
    d.inputs = {{"gust", "Gust", {"Space"}, true, 1}};
    d.plots = {{"Anemometer at 10 m", {"time", "s"}, {"wind", "m/s"}, {{"along"}, {"up"}, {"mean"}}},
               {"Spectrum along the wind",
                {"log₁₀ k", "1/m"},
                {"log₁₀ Φ", "m³/s²"},
                {{"analytic"}, {"this field, bands", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> world;
    world.allow_sleep = false;
    stage.start(world);
    stage.floor(0);
    const float house = 0.5f * stage.valuef("house");
    rigid::BodyDef<Dim3> def;
    def.type = rigid::BodyType::fixed;
    def.name = "house";
    def.position = {-14, double(house), 0};
    stage.add(def, geometry::Box{{4, house, 6}}, {}, sand);
    def.name = "mast";
    def.position = mast_ - Vec3d{0, 5, 0};
    stage.add(def, geometry::Cylinder{5, 0.12f}, {}, steel);
    blow(stage);
    around_id_ = stage.keep(stage.world().add_effector(rigid::Surroundings<Dim3>{around_}));
    rigid::BodyDrag<Dim3> drag;
    drag.diameter = 1;
    drag.area = 0.25 * math::pi;
    stage.keep(stage.world().add_effector(drag));
    for (int i = 0; i < 7; ++i) {
      rigid::BodyDef<Dim3> ball;
      ball.name = "ball";
      ball.position = {-34.0 + 3 * i, 6.0 + (i % 3), -18.0 + 6 * i};
      rigid::ShapeDef<Dim3> form;
      form.density = 0.7f;
      form.material.restitution = 0.5f;
      stage.add(ball, geometry::Sphere{0.5f}, form, i % 2 ? orange : violet);
    }
    for (int i = 0; i < tracers_; ++i) {
      position_.push_back(anywhere());
      age_.push_back(random_.uniform(0.0, 5.0));
    }
    show_spectrum(stage);
  }

  void changed(Stage3& stage, std::string_view) override {
    blow(stage);
    if (around_ != nullptr) stage.check(stage.world().set_effector(around_id_, rigid::Surroundings<Dim3>{around_}));
  }

  void before_step(Stage3& stage) override {
    const double t = stage.world().time();
    bool gusts = stage.presses("gust") > 0;
    if (!scheduled_ && t >= 8) gusts = scheduled_ = true;
    if (gusts) {
      gust_time_ = t;
      blow(stage);
      stage.check(stage.world().set_effector(around_id_, rigid::Surroundings<Dim3>{around_}));
    }
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time(), dt = stage.declaration().dt;
    const double mean = around_->definition().wind.mean_at(10).x;
    std::vector<Vec3f> places;
    std::vector<float> radii;
    std::vector<std::uint32_t> colors;
    for (std::size_t i = 0; i < position_.size(); ++i) {
      Vec3d& p = position_[i];
      const Vec3d v = around_->wind(p, t);
      p += dt * v;
      age_[i] += dt;
      // Gone at the end of its life or of the field: another one starts anywhere, so that they stay evenly spread.
      const bool inside = abs(p.x) < box_.x && abs(p.z) < box_.z && p.y > 0.1 && p.y < box_.y;
      if (!inside || age_[i] > 5) p = anywhere(), age_[i] = 0;
      const std::uint32_t color = shade(length(v) / max(1.6 * mean, 3.0));
      places.push_back(Vec3f(p));
      radii.push_back(0.2f);
      colors.push_back(color);
      if (age_[i] > 0.25) stage.line(p - 0.25 * v, p, (color & 0xffffff00u) | 0x90);
    }
    stage.points(places, radii, colors);
    const Vec3d v = around_->wind(mast_, t);
    stage.line(mast_, mast_ + 0.8 * v, pen(red));
    stage.sample(0, 0, t, v.x);
    stage.sample(0, 1, t, v.y);
    stage.sample(0, 2, t, mean);
    if (t < 8) sum_ += v.x, ++count_;
    strongest_ = max(strongest_, v.x);
    const Vec3d lee = around_->wind({14, 4, 0}, t), open = around_->wind({14, 4, 24}, t);
    lee_ += lee.x, open_ += open.x;
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    const environment::WindField& wind = around_->definition().wind;
    out.push_back({"mean wind at 10 m", "m/s", "the logarithmic profile, ± 2 σ of so short a record",
                   sum_ / max(1, count_), 8, 2.4});
    Vec3d variance{};
    for (const auto& m : wind.turbulence.modes())
      for (int i = 0; i < 3; ++i) variance[i] += 0.5 * (m.cosine[i] * m.cosine[i] + m.sine[i] * m.sine[i]);
    out.push_back({"variance of the whole field along the wind", "", "1 of σ²", variance.x, 1, 1e-9});
    out.push_back({"the gust at the mast", "m/s", "mean + gust, ± turbulence", strongest_, 16, 4});
    out.push_back({"wind behind the house over that beside it", "", "sheltered", lee_ / open_, 0.55, 0.3});
  }

 private:
  static constexpr int tracers_ = 900;
  static constexpr Vec3d box_{42, 26, 30}, mast_{18, 10, 20};

  Vec3d anywhere() {
    return {random_.uniform(-box_.x, box_.x), random_.uniform(0.2, box_.y), random_.uniform(-box_.z, box_.z)};
  }

  /// The field by the sliders, and the gust on its way.
  void blow(Stage3& stage) {
    Environment::Definition d;
    environment::WindField& wind = d.wind;
    wind.mean = {.velocity = {stage.value("wind"), 0, 0},
                 .profile = environment::WindProfile::logarithmic,
                 .roughness_length = stage.value("roughness")};
    environment::TurbulenceDef eddies;
    eddies.spectrum = stage.count("dryden") > 0 ? environment::TurbulenceSpectrum::dryden
                                                : environment::TurbulenceSpectrum::von_karman;
    const double sigma = stage.value("sigma"), length = stage.value("length");
    eddies.scales = {{sigma, sigma, sigma}, {length, length, length}};
    eddies.mean_wind = {stage.value("wind"), 0, 0};
    eddies.shells = 7;
    eddies.smallest = 0.1 * length;
    eddies.seed = std::uint64_t(stage.count("seed"));
    wind.turbulence = stage.keep(environment::Turbulence::make(eddies));
    wind.thermals.push_back({.base = {20, 0, -8}, .strength = stage.value("thermal"), .radius = 11, .depth = 60});
    const double house = stage.value("house");
    wind.obstacles.push_back({.center = {-10, 0.5 * house, 0}, .area = 12 * house, .drag_coefficient = 1.1});
    if (gust_time_ >= 0) {
      const double speed = max(stage.value("wind"), 4.0);
      // Its front stands at the left edge when it is let go.
      wind.gusts.push_back({.velocity = {stage.value("gust"), 0, 0},
                            .direction = {1, 0, 0},
                            .front = -box_.x - speed * gust_time_,
                            .gradient_distance = 12,
                            .speed = speed});
    }
    core::Result<Environment> made = Environment::make(std::move(d));
    if (!made.ok()) return stage.fail(made.error());
    around_ = std::make_shared<const Environment>(std::move(made).value());
  }

  void show_spectrum(Stage3& stage) {
    const environment::Turbulence& field = around_->definition().wind.turbulence;
    const environment::TurbulenceDef& def = field.definition();
    const double sigma = def.scales.intensity.x, length = def.scales.length.x;
    if (!(sigma > 0)) return;
    for (double x = -2.5; x <= 0.6; x += 0.1) {
      const double k = math::pow(10.0, x);
      stage.sample(1, 0, x, math::log10(environment::longitudinal_spectrum(def.spectrum, sigma, length, k)));
    }
    for (double x = -2.25; x < 0.4; x += 0.5) {
      const double low = math::pow(10.0, x - 0.25), high = math::pow(10.0, x + 0.25);
      double energy = 0;
      for (const auto& m : field.modes()) {
        const double k = math::abs(m.wave_number.x) / length;
        if (k >= low && k < high) energy += 0.5 * sigma * sigma * (m.cosine.x * m.cosine.x + m.sine.x * m.sine.x);
      }
      if (energy > 0) stage.sample(1, 1, x, math::log10(energy / (high - low)));
    }
  }

  /// Blue, teal, gold, red over 0 … 1.
  static std::uint32_t shade(double x) {
    constexpr std::uint32_t steps[4] = {blue, teal, gold, red};
    const double place = clamp(x, 0.0, 0.9999) * 3;
    const int i = int(place);
    const double t = place - i;
    std::uint32_t out = 0;
    for (int shift = 16; shift >= 0; shift -= 8) {
      const double a = double(steps[i] >> shift & 0xff), b = double(steps[i + 1] >> shift & 0xff);
      out |= std::uint32_t(a + t * (b - a)) << shift;
    }
    return pen(out);
  }

  std::shared_ptr<const Environment> around_;
  rigid::EffectorId around_id_;
  std::vector<Vec3d> position_;
  std::vector<double> age_;
  math::Random random_{11};
  double gust_time_ = -1, sum_ = 0, strongest_ = 0, lee_ = 0, open_ = 0;
  int count_ = 0;
  bool scheduled_ = false;
};

}  // namespace

std::unique_ptr<Demo> make_windy_field() { return std::make_unique<WindyField>(); }

}  // namespace carom::host::demo
