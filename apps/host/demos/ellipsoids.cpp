// Ellipsoids: one rocks with the period of its curvature, others tumble down a slope and come to rest on their flat
// sides.
#include "apps/host/demos/demos.h"
#include "carom/math/rotation.h"

namespace carom::host::demo {
namespace {

using rigid::BodyId;
using rigid::Dim3;

class Ellipsoids final : public Repeatable<Ellipsoids, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "ellipsoids";
    d.title = "Ellipsoids";
    d.summary = "Pebbles tumble down a slope and come to rest on their flat sides; one rocks, as its curvature says.";
    d.group = "Shapes";
    d.text =
        "An ellipsoid's surface is exact: its support function is that of a scaled sphere. Rocking without slip on its "
        "lowest point by a small angle, with half axes a across and b upright,\n\n"
        "  ω² = g (a² − b²)/b / (k² + b²)      k² = (a² + b²)/5";
    d.duration = 7;
    d.camera.position = {1, 6, 13};
    d.camera.target = {0, 1, 0};
    d.parameters = {
        {"pebbles", "Pebbles", "", "", "on the slope", 0, 60, 1, 30, false},
        {"tilt", "First tilt", "rad", "deg", "of the rocking one", 0.02, 0.5, 0, 0.1, false},
    };
    d.plots = {{"The rocking one", {"time", "s"}, {"tilt", "rad"}, {{"tilt"}, {"θ₀ cos ω t", Series::Style::points}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0, {.friction = 1});
    rigid::BodyDef<Dim3> ramp;
    ramp.type = rigid::BodyType::fixed;
    ramp.name = "slope";
    ramp.position = {-4, 1.2, 0};
    ramp.rotation = from_axis_angle(Vec3f{0, 0, 1}, -0.45f);
    stage.add(ramp, geometry::Box{{3, 0.1f, 2}}, {}, sand);
    constexpr std::uint32_t colors[] = {orange, blue, gold, violet, red, green};
    const int pebbles = stage.count("pebbles");
    for (int i = 0; i < pebbles; ++i) {
      rigid::BodyDef<Dim3> body;
      body.name = "pebble";
      const int row = i / 6, side = i / 3 % 2;
      body.position = {-6.2 + 0.7 * (i % 3), 3.4 + 0.6 * row, 0.9 * side - 0.4};
      body.rotation = from_axis_angle(normalize(Vec3f{1, float(i % 5), 2}), float(i));
      const float size = 0.75f + 0.1f * float(i % 4);
      thin_.push_back(0.2 * double(size));
      stage.add(body, geometry::Ellipsoid{{0.36f * size, 0.2f * size, 0.28f * size}},
                {.density = 2600, .material = {.friction = 0.6f, .rolling_resistance = 0.03f}}, colors[i % 6]);
    }
    const double theta = stage.value("tilt");
    rigid::BodyDef<Dim3> egg;
    egg.name = "rocker";
    egg.position = {3, sqrt(square(b_ * cos(theta)) + square(a_ * sin(theta))), 2.6};
    egg.rotation = from_axis_angle(Vec3f{0, 0, 1}, float(theta));
    egg.sleep_speed = 0;
    egg_ = stage.add(egg, geometry::Ellipsoid{{float(a_), float(b_), 0.5f}}, {.material = {.friction = 1}}, teal);
    omega_ = sqrt(9.80665 * (a_ * a_ - b_ * b_) / b_ / ((a_ * a_ + b_ * b_) / 5 + b_ * b_));
    for (double t = 0; t <= 5; t += 0.1) stage.sample(0, 1, t, theta * cos(omega_ * t));
  }

  void after_step(Stage3& stage) override {
    const double t = stage.world().time();
    const double tilt = double(rotate(stage.at(egg_).pose.rotation, Vec3f{1, 0, 0}).y);
    if (t <= 5) stage.sample(0, 0, t, tilt);
    if (before_ > 0 && tilt <= 0) crossings_.push_back(t);
    before_ = tilt;
  }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double period = crossings_.size() > 3 ? (crossings_[3] - crossings_[0]) / 3 : 0;
    out.push_back({"period of rocking", "s", "2π/ω", period, 2 * pi / omega_, 0.07});
    double lowest = 10;
    std::size_t pebble = 0;
    for (const auto& actor : stage.actors()) {
      const auto state = stage.at(actor.body);
      if (state.type == rigid::BodyType::dynamic && !(actor.body == egg_) && pebble < thin_.size())
        lowest = min(lowest, state.pose.position.y - thin_[pebble++]);
    }
    out.push_back(
        {"a pebble's centre over its shortest half axis, at the least", "m", "flat on the floor", lowest, 0, 0.02});
  }

 private:
  static constexpr double a_ = 1.0, b_ = 0.5;
  BodyId egg_;
  double omega_ = 1, before_ = 1;
  std::vector<double> crossings_, thin_;  ///< s; m, of the pebbles
};

}  // namespace

std::unique_ptr<Demo> make_ellipsoids() { return std::make_unique<Ellipsoids>(); }

}  // namespace carom::host::demo
