// A burst of sparks: all of one speed lie on a sphere about the centre as it falls (chapter 2.7).
#include "apps/host/demos/particles/particles.h"

namespace carom::host::demo {
namespace {

class SparkBurst final : public Repeatable<SparkBurst, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "spark-burst";
    d.title = "A burst of sparks";
    d.summary = "A rocket bursts: the sparks of equal speed stay on a sphere that grows and falls, until air bends it.";
    d.group = "Particles";
    d.chapter = "2.7";
    d.text =
        "All sparks start from one point with the speed w in all directions, on top of the velocity V of what burst. "
        "Without air each flies its own parabola, and all together they are\n\n"
        "  x = x₀ + V t + ½ g t²  +  w t n\n\n"
        "a sphere of radius w t about a centre that falls as the unburst rocket would have. Directions come in "
        "opposite pairs, so that the momentum of the burst is zero to the last bit. With drag the sphere shrinks and "
        "hangs behind; the lines show the one without.\n\n"
        "Where a spark goes out near the ground or strikes it, it bursts once more into a few small ones.";
    d.duration = 2.2;
    d.loop = true;
    d.camera = {{0, 14, 58}, {0, 21, 0}};
    d.ground = 0;
    d.parameters = {
        {"count", "Sparks", "", "", "", 50, 3000, 50, 1200, false},
        {"speed", "Speed of the sparks w", "m/s", "m/s", "", 2, 30, 0, 10, false},
        {"climb", "Speed of the rocket", "m/s", "m/s", "upward when it bursts", -10, 30, 0, 8, false},
        {"drag", "Drag", "", "", "a factor: 0 is a vacuum", 0, 3, 0, 0, false},
        {"wind", "Wind", "m/s", "m/s", "felt with drag only", 0, 20, 0, 5, false},
    };
    d.plots = {
        {"Distance from the falling centre",
         {"time", "s"},
         {"distance", "m"},
         {{"farthest spark"}, {"nearest spark"}, {"w t"}}},
        {"Momentum of the burst beside gravity's", {"time", "s"}, {"momentum", "kg·m/s"}, {{"up"}, {"to the right"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    particles::SystemDef d;
    d.capacity = 3000;
    d.mass = 1e-3f;
    d.radius = 0.1f;
    d.report_deaths = d.report_hits = true;
    d.slowest_hit = 3;
    d.drag = {.coefficient = 0.02f * stage.valuef("drag")};
    d.color_over_age = stage.keep(particles::Gradient::make({{0, 0xfff4c0}, {0.3f, gold}, {0.7f, orange}, {1, red}}));
    d.size_over_age = stage.keep(particles::Curve::make({{0, 2.4f}, {0.7f, 2.2f}, {1, 0.8f}}));
    sparks_ = make_system(stage, d);
    d.capacity = 4000;
    d.radius = 0.05f;
    d.mass = 1e-4f;
    d.report_deaths = d.report_hits = false;
    d.drag = {.coefficient = 0.02f};
    embers_ = make_system(stage, d);
    if (!sparks_ || !embers_) return;
    const particles::Air air{.wind = {.velocity = {stage.value("wind"), 0, 0}}};
    stage.check(sparks_->set_air(air));
    stage.check(embers_->set_air(air));
    particles::Collider ground;
    ground.shape = geometry::Plane{};
    ground.restitution = 0.4f;
    stage.check(sparks_->set_colliders({&ground, 1}));
    stage.check(embers_->set_colliders({&ground, 1}));
    burst_.count = stage.count("count") / 2 * 2;
    burst_.center = {0, 22, 0};
    burst_.velocity = {0, stage.value("climb"), 0};
    burst_.speed = stage.value("speed");
    burst_.seed = 7;
    stage.keep(sparks_->burst(burst_, {1.9f, 2.4f}));
  }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status status = stage.world().step(float(dt)); !status) return status;
    if (!sparks_ || !embers_) return {};
    if (const core::Status status = sparks_->step(dt); !status) return status;
    if (const core::Status status = embers_->step(dt); !status) return status;
    particles::SubEmission small;
    small.count = 3;
    small.inherited = 0.3f;
    small.emitter.spread = 3.14159f;
    small.emitter.speed = {0.5f, 3};
    small.emitter.lifetime = {0.2f, 0.5f};
    small.emitter.seed = 3;
    if (const auto born = embers_->emit_at(sparks_->deaths(), small); !born) return born.error();
    small.emitter.spread = 1.2f;
    if (const auto born = embers_->emit_at(sparks_->hits(), small); !born) return born.error();
    return {};
  }

  void after_step(Stage3& stage) override {
    if (!sparks_ || !embers_) return;
    const double t = stage.world().time();
    const Vec3d center = particles::burst_position(burst_, {}, {0, -9.80665, 0}, t);
    double nearest = 1e30, farthest = 0;
    for (int i = 0; i < sparks_->size(); ++i) {
      const double r = distance(sparks_->position(i), center);
      nearest = min(nearest, r);
      farthest = max(farthest, r);
    }
    stage.sample(0, 2, t, burst_.speed * t);
    if (sparks_->size() > 0) {
      stage.sample(0, 0, t, farthest);
      stage.sample(0, 1, t, nearest);
    }
    if (t < 1.2 && sparks_->size() > 0) {
      worst_ = max(worst_, max(farthest - burst_.speed * t, burst_.speed * t - nearest));
      const Vec3d p =
          sparks_->totals().momentum - sparks_->totals().mass * (burst_.velocity + Vec3d{0, -9.80665 * t, 0});
      stage.sample(1, 0, t, p.y);
      stage.sample(1, 1, t, p.x);
    }
    // Three circles of the sphere.
    const double r = burst_.speed * t;
    for (int axis = 0; axis < 3; ++axis)
      for (int k = 0; k < 48; ++k) {
        const auto at = [&](int i) {
          const SinCos<double> turn = sincos(2 * pi * i / 48);
          const double a = r * turn.cos, b = r * turn.sin;
          return center + (axis == 0 ? Vec3d{0, a, b} : (axis == 1 ? Vec3d{a, 0, b} : Vec3d{a, b, 0}));
        };
        if (at(k).y > 0 && at(k + 1).y > 0) stage.line(at(k), at(k + 1), pen(steel, 0xa0));
      }
    Cloud cloud;
    cloud.add(*sparks_);
    cloud.add(*embers_);
    cloud.draw(stage);
    stage.say(format("sphere of %.1f m, centre at %.1f m", r, center.y));
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return mixed(mixed(world, sparks_), embers_); }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"off the sphere", "m", "x₀ + V t + ½ g t² + w t n (chapter 2.7), in floats", worst_, 0, 5e-5});
  }

 private:
  std::optional<particles::ParticleSystem> sparks_, embers_;
  particles::BurstDef burst_;
  double worst_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_spark_burst() { return std::make_unique<SparkBurst>(); }

}  // namespace carom::host::demo
