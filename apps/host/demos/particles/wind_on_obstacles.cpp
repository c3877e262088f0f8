// Particles blown by the wind onto round obstacles and the ground: the example program of chapter 8.
#include "apps/host/demos/particles/particles.h"

namespace carom::host::demo {
namespace {

using particles::DragLaw;
using rigid::Dim2;

class WindOnObstacles final : public Repeatable<WindOnObstacles, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "wind-on-obstacles";
    d.title = "Wind on particles and obstacles";
    d.summary = "Particles fall, drift with the wind and bounce off circles and the ground: every number on a slider.";
    d.group = "Particles";
    d.chapter = "8";
    d.dimension = 2;
    d.text =
        "Each particle feels its weight and the drag of the air that moves past it with w = v − wind,\n\n"
        "  F = −½ ρ C_d A |w| w\n\n"
        "so that its horizontal speed goes to the wind's and its fall to the terminal speed\n\n"
        "  v_t = √(2 m g / (ρ C_d A))\n\n"
        "which is 29.09 m/s for 1 kg, r = 0.1 m and C_d = 0.6. Where its way meets an obstacle it bounces with the "
        "restitution e at the very moment of impact within the step: from a drop it comes back to e², e⁴, … of the "
        "height. The step solves drag exactly for the rate it finds, so no wind and no step is too strong for it.";
    d.duration = 12;
    d.camera.target = {0, 7, 0};
    d.camera.height = 17;
    d.camera.width = 30;
    d.parameters = {
        {"wind", "Wind", "m/s", "m/s", "to the right", -30, 30, 0, 10, true},
        {"rate", "Particles a second", "1/s", "1/s", "", 10, 800, 10, 300, true},
        {"drag", "Drag coefficient C_d", "", "", "", 0, 2, 0, 0.6, false},
        {"mass", "Mass", "kg", "kg", "", 0.01, 5, 0, 1, false},
        {"radius", "Radius", "m", "m", "", 0.03, 0.3, 0, 0.1, false},
        {"restitution", "Restitution e", "", "", "", 0, 1, 0, 0.6, false},
        {"friction", "Friction μ", "", "", "", 0, 1, 0, 0.1, false},
        {"obstacles", "Obstacles", "", "", "", 0, 12, 1, 6, false},
        {"seed", "Seed", "", "", "where the obstacles stand", 1, 50, 1, 4, false},
    };
    d.plots = {
        {"Mean velocity in the air", {"time", "s"}, {"speed", "m/s"}, {{"to the right"}, {"downward"}, {"wind"}}},
        {"Height of one that falls without air",
         {"time", "s"},
         {"height", "m"},
         {{"height"}, {"bounces to h e², h e⁴, …"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(0);
    math::Random random(std::uint64_t(stage.count("seed")));
    for (int i = 0; i < stage.count("obstacles"); ++i) {
      rigid::BodyDef<Dim2> body;
      body.type = rigid::BodyType::fixed;
      body.name = "obstacle";
      body.position = {random.uniform(-11.0, 11.0), random.uniform(1.5, 7.5)};
      stage.add(body, geometry::Circle{random.uniform(0.5f, 1.4f)}, {}, i % 2 ? teal : steel);
    }
    particles::SystemDef d;
    d.capacity = 4000;
    d.planar = true;
    d.radius = stage.valuef("radius");
    d.mass = stage.valuef("mass");
    d.drag = {.law = DragLaw::quadratic, .coefficient = stage.valuef("drag"), .density = 1.23f};
    d.color_over_age = stage.keep(particles::Gradient::make({{0, gold}, {0.5f, orange}, {1, red}}));
    d.opacity_over_age = stage.keep(particles::Curve::make({{0, 1}, {0.8f, 1}, {1, 0}}));
    system_ = make_system(stage, d);
    d.capacity = 1;
    d.drag.law = DragLaw::none;
    d.color_over_age = particles::Gradient(violet);
    probe_ = make_system(stage, d);
    if (!system_ || !probe_) return;
    particles::EmitterDef sky;
    sky.form = particles::EmitterForm::segment;
    sky.size = {13, 0, 0};
    sky.position = {0, 15, 0};
    sky.direction = {0, -1, 0};
    sky.speed = {0, 2};
    sky.rate = stage.valuef("rate");
    sky.lifetime = {5, 6};
    stage.keep(system_->add_emitter(sky));
    stage.keep(probe_->add({.position = {-14, 10.0 + double(d.radius), 0}}));
    particles::CouplingDef coupling;
    coupling.restitution = stage.valuef("restitution");
    coupling.friction = stage.valuef("friction");
    coupling_ = particles::Coupling2(coupling);
    blow(stage);
  }

  void changed(Stage2& stage, std::string_view) override { blow(stage); }

  core::Status step(Stage2& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status status = stage.world().step(float(dt)); !status) return status;
    if (!system_ || !probe_) return {};
    if (const core::Status status = coupling_.step(stage.world(), *probe_, dt); !status) return status;
    return coupling_.step(stage.world(), *system_, dt);
  }

  void after_step(Stage2& stage) override {
    if (!system_ || !probe_) return;
    const double t = stage.world().time();
    double right = 0, down = 0;
    int flying = 0;
    for (int i = 0; i < system_->size(); ++i) {
      if (system_->position(i).y < 8) continue;
      right += system_->velocity(i).x;
      down -= system_->velocity(i).y;
      ++flying;
    }
    if (flying > 0) {
      stage.sample(0, 0, t, right / flying);
      stage.sample(0, 1, t, down / flying);
    }
    stage.sample(0, 2, t, stage.value("wind"));
    stage.sample(1, 1, t, exact_height(t, stage.value("restitution")));
    if (probe_->size() > 0) {
      const double height = probe_->position(0).y - double(probe_->definition().radius);
      stage.sample(1, 0, t, height);
      const double v = probe_->velocity(0).y;
      if (t > 1.4 && t < 3.2) highest_ = max(highest_, height + (v > 0 ? 0.5 * v * v / 9.80665 : 0));
      deepest_ = min(deepest_, height);
    }
    // Whoever lies at the ground, or in it.
    for (int i = 0; i < system_->size(); ++i)
      deepest_ = min(deepest_, system_->position(i).y - double(system_->definition().radius));
    Cloud cloud;
    cloud.add(*system_);
    cloud.add(*probe_);
    cloud.draw(stage);
    stage.say(format("%.0f particles", double(system_->size())));
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return mixed(world, system_); }

  void expectations(Stage2& stage, std::vector<Expectation>& out) override {
    out.push_back({"height after the first bounce", "m", "e² of 10 m (chapter 8.7)", highest_, 3.6, 0.01});
    out.push_back({"deepest in the ground", "m", "1 % of a radius (chapter 8.8)", min(deepest_, 0.0), 0, 0.001});
    // One alone, falling for a minute.
    particles::SystemDef d = system_->definition();
    d.capacity = 1;
    auto alone = make_system(stage, d);
    if (!alone) return;
    stage.keep(alone->add({}));
    for (int i = 0; i < 3600; ++i) stage.check(alone->step(1.0 / 60));
    out.push_back({"terminal speed", "m/s", "chapter 8.5", -alone->velocity(0).y, 29.09, 0.01});
  }

 private:
  /// A drop from 10 m that bounces: one parabola after the other.
  static double exact_height(double t, double e) {
    double v = math::sqrt(2 * 9.80665 * 10), begin = -v / 9.80665;
    for (int k = 0; k < 60; ++k) {
      const double end = begin + 2 * v / 9.80665;
      if (t < end) return v * (t - begin) - 0.5 * 9.80665 * square(t - begin);
      begin = end;
      v *= e;
      if (v < 0.1) break;
    }
    return 0;
  }
  void blow(Stage2& stage) {
    if (!system_) return;
    stage.check(system_->set_air({.wind = {.velocity = {stage.value("wind"), 0, 0}}}));
    particles::EmitterDef sky = system_->emitter(0);
    sky.rate = stage.valuef("rate");
    // Upwind, so that they drift across the picture.
    sky.position.x = -0.4 * stage.value("wind");
    stage.check(system_->set_emitter(0, sky));
  }

  std::optional<particles::ParticleSystem> system_, probe_;
  particles::Coupling2 coupling_;
  double highest_ = 0, deepest_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_wind_on_obstacles() { return std::make_unique<WindOnObstacles>(); }

}  // namespace carom::host::demo
