// Fire and smoke, and a fireball that throws bodies about.
#include "apps/host/demos/particles/particles.h"

namespace carom::host::demo {
namespace {

using particles::DragLaw;
using rigid::BodyId;
using rigid::Dim3;

class Fire final : public Repeatable<Fire, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "fire-and-smoke";
    d.title = "Fire and smoke";
    d.summary =
        "Hot gas rises through turbulent air, cools into smoke that drifts with the wind; sparks fly and bounce.";
    d.group = "Particles";
    d.chapter = "8";
    d.text =
        "Three systems: flames, smoke and sparks. Flames and smoke are lighter than the air round them and rise,\n\n"
        "  a = g (ρ_air/ρ − 1) ≈ g ΔT/T\n\n"
        "against a drag that takes hold of them at once, so that they go where the air goes: with the wind, with the "
        "eddies and, if you like, round a whirl over the fire (Rankine's vortex), which pulls the flames into a "
        "column. "
        "Colour, size and opacity follow curves over the age of each particle. Where a flame goes out a puff of smoke "
        "is born. Sparks are solid: they fall, bounce and cool.";
    d.duration = 10;
    d.camera = {{0, 3.2, 11}, {0, 2.8, 0}};
    d.ground = 0;
    d.parameters = {
        {"rate", "Flames a second", "1/s", "1/s", "", 50, 1500, 50, 700, true},
        {"heat", "Buoyancy", "", "", "in weights of the gas: ΔT/T", 0.2, 4, 0, 1.6, false},
        {"gusts", "Speed of the eddies", "m/s", "m/s", "", 0, 3, 0, 0.8, true},
        {"wind", "Wind", "m/s", "m/s", "", -6, 6, 0, 0.4, true},
        {"whirl", "Circulation of a whirl", "m²/s", "m²/s", "over the fire", 0, 25, 0, 0, true},
    };
    d.plots = {{"Mean height", {"time", "s"}, {"height", "m"}, {{"flames"}, {"smoke"}, {"sparks"}}},
               {"Particles", {"time", "s"}, {"number", ""}, {{"flames"}, {"smoke"}, {"sparks"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    for (int k = 0; k < 5; ++k) {
      rigid::BodyDef<Dim3> log;
      log.type = rigid::BodyType::fixed;
      log.name = "log";
      const double a = 2 * pi * k / 5;
      log.position = {0.55 * cos(a), 0.28, 0.55 * sin(a)};
      // Leaning to the middle.
      const Quatf about = from_turn({float(sin(a)), 0, float(-cos(a))}, -1.0f);
      log.rotation = about;
      stage.add(log, geometry::Cylinder{0.6f, 0.13f}, {}, k % 2 ? 0x5b4330 : 0x6e5238);
    }
    particles::SystemDef d;
    d.capacity = 2000;
    d.radius = 0.12f;
    d.mass = 3e-3f;
    d.gravity_scale = -stage.valuef("heat");
    d.drag = {.law = DragLaw::linear, .coefficient = 0.012f};
    d.color_over_age = stage.keep(particles::Gradient::make(
        {{0, 0xfff6c8}, {0.15f, 0xffd24a}, {0.5f, 0xf08020}, {0.8f, 0xb83018}, {1, 0x501810}}));
    d.size_over_age = stage.keep(particles::Curve::make({{0, 0.5f}, {0.2f, 1}, {1, 0.15f}}));
    d.opacity_over_age = stage.keep(particles::Curve::make({{0, 0.2f}, {0.1f, 0.8f}, {1, 0.1f}}));
    d.report_deaths = true;
    flames_ = make_system(stage, d);
    d.capacity = 3500;
    d.radius = 0.16f;
    d.gravity_scale = -0.25f * stage.valuef("heat");
    d.color_over_age = stage.keep(particles::Gradient::make({{0, 0x5a4a44}, {0.3f, 0x77777a}, {1, 0xb4b8bd}}));
    d.size_over_age = stage.keep(particles::Curve::make({{0, 0.5f}, {1, 2.6f}}));
    d.opacity_over_age = stage.keep(particles::Curve::make({{0, 0.05f}, {0.15f, 0.22f}, {0.6f, 0.1f}, {1, 0}}));
    d.report_deaths = false;
    smoke_ = make_system(stage, d);
    d.capacity = 600;
    d.radius = 0.018f;
    d.mass = 2e-5f;
    d.gravity_scale = 1;
    d.drag = {.law = DragLaw::quadratic, .coefficient = 0.5f};
    d.color_over_age = stage.keep(particles::Gradient::make({{0, 0xffffd0}, {0.4f, 0xffb030}, {1, 0xa02010}}));
    d.size_over_age = particles::Curve(1.4f);
    d.opacity_over_age = particles::Curve(1);
    sparks_ = make_system(stage, d);
    if (!flames_ || !smoke_ || !sparks_) return;
    particles::EmitterDef hearth;
    hearth.form = particles::EmitterForm::disc;
    hearth.size = {0.42f, 0, 0};
    hearth.position = {0, 0.35, 0};
    hearth.spread = 0.4f;
    hearth.speed = {0.4f, 1.4f};
    hearth.lifetime = {0.5f, 1.3f};
    hearth.scale = {0.6f, 1.3f};
    stage.keep(flames_->add_emitter(hearth));
    hearth.rate = 60;
    hearth.speed = {2.5f, 6};
    hearth.spread = 0.5f;
    hearth.lifetime = {1, 2.5f};
    hearth.scale = {0.6f, 1.6f};
    hearth.seed = 5;
    stage.keep(sparks_->add_emitter(hearth));
    blow(stage);
  }

  void changed(Stage3& stage, std::string_view) override { blow(stage); }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status status = stage.world().step(float(dt)); !status) return status;
    if (!flames_ || !smoke_ || !sparks_) return {};
    for (auto* system : {&*flames_, &*smoke_})
      if (const core::Status status = system->step(dt); !status) return status;
    if (const core::Status status = coupling_.step(stage.world(), *sparks_, dt); !status) return status;
    particles::SubEmission puff;
    puff.count = 1;
    puff.inherited = 0.6f;
    puff.chance = 0.5f;
    puff.emitter.spread = 3.1415f;
    puff.emitter.speed = {0, 0.2f};
    puff.emitter.lifetime = {2.5f, 4.5f};
    puff.emitter.scale = {0.7f, 1.3f};
    if (const auto born = smoke_->emit_at(flames_->deaths(), puff); !born) return born.error();
    return {};
  }

  void after_step(Stage3& stage) override {
    if (!flames_ || !smoke_ || !sparks_) return;
    const double t = stage.world().time();
    Cloud cloud;
    int k = 0;
    for (const auto* system : {&*smoke_, &*flames_, &*sparks_}) {
      const int series = k == 0 ? 1 : (k == 1 ? 0 : 2);
      if (system->size() > 0) {
        height_[series] = system->totals().center.y;
        stage.sample(0, series, t, height_[series]);
      }
      stage.sample(1, series, t, system->size());
      cloud.add(*system);
      ++k;
    }
    cloud.draw(stage);
    stage.say(format("%.0f flames, %.0f puffs of smoke, %.0f sparks", double(flames_->size()), double(smoke_->size()),
                     double(sparks_->size())));
  }

  std::uint64_t state_hash(std::uint64_t world) const override {
    return mixed(mixed(mixed(world, flames_), smoke_), sparks_);
  }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"smoke above the flames", "", "it was born of them and rises",
                   height_[1] > height_[0] + 0.5 ? 1.0 : 0.0, 1, 0});
    out.push_back({"sparks none below the ground", "", "", lowest() > 0 ? 1.0 : 0.0, 1, 0});
  }

 private:
  static Quatf from_turn(Vec3f axis, float angle) {
    const SinCos<float> half = sincos(0.5f * angle);
    return normalize(Quatf{half.cos, half.sin * axis});
  }
  double lowest() const {
    double y = 1;
    for (int i = 0; i < sparks_->size(); ++i) y = min(y, sparks_->position(i).y);
    return y;
  }
  void blow(Stage3& stage) {
    if (!flames_ || !smoke_ || !sparks_) return;
    particles::Air air;
    air.wind = {
        .velocity = {stage.value("wind"), 0, 0}, .profile = environment::WindProfile::power, .reference_height = 3};
    air.turbulence = {.speed = stage.valuef("gusts"), .length = 1.6f, .waves = 10, .seed = 3};
    if (stage.value("whirl") > 0)
      air.whirls.push_back(
          {.center = {}, .axis = {0, 1, 0}, .vortex = {.circulation = stage.value("whirl"), .core_radius = 0.5}});
    for (auto* system : {&*flames_, &*smoke_, &*sparks_}) {
      stage.check(system->set_air(air));
      // A whirl draws in what is near its foot.
      const particles::Attractor foot{
          .center = {0, 1.2, 0},
          .radial = {.strength = -0.5 * stage.value("whirl"), .reference = 1, .exponent = 1, .range = 2.5}};
      stage.check(system->set_attractors({&foot, std::size_t(stage.value("whirl") > 0 ? 1 : 0)}));
    }
    particles::EmitterDef hearth = flames_->emitter(0);
    hearth.rate = stage.valuef("rate");
    stage.check(flames_->set_emitter(0, hearth));
  }

  std::optional<particles::ParticleSystem> flames_, smoke_, sparks_;
  particles::Coupling3 coupling_;
  double height_[3] = {0, 0, 0};
};

class Fireball final : public Repeatable<Fireball, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "fireball";
    d.title = "A fireball and its budget";
    d.summary = "A charge bursts among crates: every bit of momentum the crates get, the burning gas gave.";
    d.group = "Particles";
    d.chapter = "18.7";
    d.text =
        "The ball is a few thousand pieces of burning gas of equal mass, thrown out in opposite pairs: their momentum "
        "is zero to rounding, their energy is what the charge had,\n\n"
        "  Σ m v = 0      Σ ½ m v² = E\n\n"
        "What strikes a crate bounces and gives it the opposite impulse at the point where it struck, linear and "
        "angular. There is no other force here (no weight, no air), so the sum over gas and crates stays zero; the "
        "plot shows it beside what the crates got. Energy only falls, since the gas bounces with e < 1.";
    d.duration = 4;
    d.loop = true;
    d.camera = {{8, 5, 11}, {0, 0, 0}};
    d.parameters = {
        {"energy", "Energy of the charge", "J", "kJ", "", 100, 50000, 0, 2500, false},
        {"mass", "Mass of the gas", "kg", "kg", "", 0.5, 30, 0, 10, false},
        {"count", "Pieces", "", "", "", 200, 4000, 100, 3000, false},
        {"restitution", "Restitution e", "", "", "", 0, 1, 0, 0.3, false},
    };
    d.plots = {{"Momentum along x", {"time", "s"}, {"momentum", "kg·m/s"}, {{"gas"}, {"crates"}, {"both"}}},
               {"Energy", {"time", "s"}, {"energy", "J"}, {{"gas"}, {"crates"}, {"both"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    rigid::WorldDef<Dim3> def;
    def.gravity = {};
    stage.start(def);
    math::Random random(12);
    constexpr std::uint32_t colors[] = {blue, teal, violet, green, sand, steel};
    for (int k = 0; k < 14; ++k) {
      // Evenly over the sphere, so that none begins in another.
      const double y = 1 - (2 * k + 1) / 14.0, around = 2.399963 * k, across = math::sqrt(1 - y * y);
      const Vec3d away{across * cos(around), y, across * sin(around)};
      rigid::BodyDef<Dim3> crate;
      crate.name = "crate";
      crate.position = away * random.uniform(1.5, 2.1);
      crate.allow_sleep = false;
      crate.rotation = Quatf(random.rotation());
      rigid::ShapeDef<Dim3> wood;
      wood.density = 6;  // cardboard
      const float a = random.uniform(0.25f, 0.5f), b = random.uniform(0.25f, 0.5f), c = random.uniform(0.25f, 0.5f);
      stage.add(crate, geometry::Box{{a, b, c}}, wood, colors[k % 6]);
    }
    particles::SystemDef d;
    d.capacity = 4000;
    d.gravity = {};
    d.radius = 0.06f;
    d.mass = float(stage.value("mass") / stage.count("count"));
    d.drag.law = DragLaw::none;
    d.color_over_age = stage.keep(particles::Gradient::make(
        {{0, 0xfffbe0}, {0.1f, 0xffd850}, {0.35f, 0xf07818}, {0.6f, 0x8a2c14}, {1, 0x40302c}}));
    d.size_over_age = stage.keep(particles::Curve::make({{0, 0.8f}, {0.3f, 2.2f}, {1, 1.2f}}));
    d.opacity_over_age = stage.keep(particles::Curve::make({{0, 1}, {0.3f, 0.7f}, {1, 0.15f}}));
    gas_ = make_system(stage, d);
    if (!gas_) return;
    particles::BurstDef burst;
    burst.count = stage.count("count");
    burst.energy = stage.value("energy");
    burst.mass = double(d.mass);
    burst.equal_speeds = false;
    burst.seed = 3;
    stage.keep(gas_->burst(burst, {6, 6}));
    coupling_ = particles::Coupling3({.restitution = stage.valuef("restitution"), .two_way = true});
    first_energy_ = gas_->totals().kinetic_energy;
    first_momentum_ = length(gas_->totals().momentum);
    for (int i = 0; i < gas_->size(); ++i) scale_ += double(d.mass) * length(gas_->velocity(i));
    last_energy_ = first_energy_;
  }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status status = stage.world().step(float(dt)); !status) return status;
    return gas_ ? coupling_.step(stage.world(), *gas_, dt) : core::Status{};
  }

  void after_step(Stage3& stage) override {
    if (!gas_) return;
    const double t = stage.world().time();
    const particles::ParticleTotals gas = gas_->totals();
    const rigid::Totals<Dim3> crates = stage.world().totals();
    stage.sample(0, 0, t, gas.momentum.x);
    stage.sample(0, 1, t, crates.momentum.x);
    stage.sample(0, 2, t, gas.momentum.x + crates.momentum.x);
    const double both = gas.kinetic_energy + crates.kinetic_energy;
    stage.sample(1, 0, t, gas.kinetic_energy);
    stage.sample(1, 1, t, crates.kinetic_energy);
    stage.sample(1, 2, t, both);
    worst_ = max(worst_, length(gas.momentum + crates.momentum));
    rise_ = max(rise_, both - last_energy_);
    last_energy_ = both;
    Cloud cloud;
    cloud.add(*gas_);
    cloud.draw(stage);
    stage.say(format("crates: %.0f J, sum of momentum %.1e kg·m/s", crates.kinetic_energy,
                     length(gas.momentum + crates.momentum)));
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return mixed(world, gas_); }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    out.push_back({"momentum of the burst", "kg·m/s", "zero, of Σ|mv| in floats (chapter 18.7)",
                   first_momentum_ / scale_, 0, 1e-6});
    out.push_back({"energy of the burst", "J", "the charge's", first_energy_ / stage.value("energy"), 1, 1e-5});
    out.push_back({"momentum of all at any time", "", "zero, of Σ|mv|", worst_ / scale_, 0, 1e-5});
    out.push_back(
        {"rise of energy in a step", "", "none, of the charge's", max(rise_, 0.0) / stage.value("energy"), 0, 1e-4});
    out.push_back({"the crates fly", "", "", stage.world().totals().kinetic_energy > 5 ? 1.0 : 0.0, 1, 0});
  }

 private:
  std::optional<particles::ParticleSystem> gas_;
  particles::Coupling3 coupling_;
  double first_energy_ = 0, first_momentum_ = 0, scale_ = 0, worst_ = 0, rise_ = 0, last_energy_ = 0;
};

class SandHeap final : public Repeatable<SandHeap, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "sand-heap";
    d.title = "Grains in a heap";
    d.summary = "Grains pour onto a table, pile up, and hold their slope by friction; what is too much runs off.";
    d.group = "Particles";
    d.chapter = "8.8";
    d.text =
        "Here particles touch each other. They are sorted into the cells of a grid; neighbours that touch, or would "
        "within the step, exchange impulses until none closes in, with friction up to μ times the push,\n\n"
        "  v_n ≥ −gap/Δt,   |J_t| ≤ μ J_n\n\n"
        "Impulses are remembered from step to step, so that a heap comes to rest: grains overlap by less than a "
        "hundredth of their radius, and the table feels their whole weight. Grains turn and roll; the resistance "
        "against rolling, in radii of the push, makes rough grains of balls. Slope and height of the heap follow both.";
    d.duration = 14;
    d.camera = {{3.4, 2.6, 4.6}, {0, 0.75, 0}};
    d.ground = 0;
    d.parameters = {
        {"friction", "Friction μ between grains", "", "", "", 0, 1, 0, 0.3, false},
        {"rolling", "Resistance against rolling", "", "", "in radii", 0, 0.5, 0, 0.1, false},
        {"grains", "Grains", "", "", "", 100, 1500, 100, 700, false},
        {"radius", "Radius of a grain", "m", "cm", "", 0.03, 0.07, 0, 0.05, false},
    };
    d.plots = {
        {"Load on the table", {"time", "s"}, {"weight", "N"}, {{"felt by the table"}, {"weight of the grains on it"}}},
        {"Worst overlap of grains", {"time", "s"}, {"of a radius", "%"}, {{"overlap"}}},
        {"Height of the heap", {"time", "s"}, {"height", "m"}, {{"heap"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    rigid::Material rough;
    rough.friction = 0.6f;
    stage.floor(0, rough);
    rigid::BodyDef<Dim3> table;
    table.type = rigid::BodyType::fixed;
    table.name = "table";
    table.position = {0, 0.5, 0};
    rigid::ShapeDef<Dim3> top;
    top.material = rough;
    table_ = stage.add(table, geometry::Cylinder{0.06f, 0.8f}, top, sand);
    table.position = {0, 0.22, 0};
    stage.add(table, geometry::Cylinder{0.22f, 0.12f}, top, dark);
    particles::SystemDef d;
    d.capacity = 2000;
    d.radius = stage.valuef("radius");
    d.mass = ball_mass(double(d.radius));
    d.drag.law = DragLaw::none;
    d.contacts = {
        .enabled = true, .restitution = 0.1f, .friction = stage.valuef("friction"), .rolling = stage.valuef("rolling")};
    d.color_over_age = particles::Gradient(0xd9b36a);
    grains_ = make_system(stage, d);
    if (!grains_) return;
    particles::EmitterDef spout;
    spout.form = particles::EmitterForm::disc;
    spout.size = {0.12f, 0, 0};
    spout.position = {0, 2.1, 0};
    spout.direction = {0, -1, 0};
    spout.speed = {1, 1};
    spout.lifetime = {1e6f, 1e6f};
    spout.rate = 160;
    spout.duration = stage.valuef("grains") / 160;
    spout.scale = {0.85f, 1.15f};
    stage.keep(grains_->add_emitter(spout));
    coupling_ = particles::Coupling3({.restitution = 0.1f, .friction = 0.6f});
  }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status status = stage.world().step(float(dt)); !status) return status;
    return grains_ ? coupling_.step(stage.world(), *grains_, dt) : core::Status{};
  }

  void after_step(Stage3& stage) override {
    if (!grains_) return;
    const double t = stage.world().time(), dt = stage.declaration().dt;
    double load = 0, weight = 0, top = 0.56;
    for (int i = 0; i < int(grains_->exchanges().size()); ++i)
      if (coupling_.body_of(i) == table_) load -= grains_->exchanges()[std::size_t(i)].impulse.y / dt;
    for (int i = 0; i < grains_->size(); ++i) {
      const Vec3d p = grains_->position(i);
      const double s = double(grains_->scale(i));
      if (p.y < 0.56 || p.x * p.x + p.z * p.z > 0.75) continue;
      if (length(grains_->velocity(i)) < 0.5) top = max(top, p.y + double(grains_->definition().radius) * s);
      weight += double(grains_->definition().mass) * s * s * s * 9.80665;
    }
    felt_ += 0.1 * (load - felt_);
    weight_ = weight;
    stage.sample(0, 0, t, felt_);
    stage.sample(0, 1, t, weight);
    stage.sample(1, 0, t, 100 * grains_->worst_overlap());
    stage.sample(2, 0, t, top - 0.56);
    Cloud cloud;
    cloud.add(*grains_);
    cloud.draw(stage);
    stage.say(format("%.0f grains, heap of %.2f m, overlap %.2f %% of a radius", double(grains_->size()), top - 0.56,
                     100 * grains_->worst_overlap()));
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return mixed(world, grains_); }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back(
        {"overlap at rest", "%", "below 1 % of a radius (chapter 8.8)", 100 * grains_->worst_overlap(), 0.5, 0.5});
    out.push_back({"load on the table", "", "the weight of what lies on it", felt_ / weight_, 1, 0.05});
    double lowest = 1;
    for (int i = 0; i < grains_->size(); ++i)
      lowest = min(lowest, grains_->position(i).y / (double(grains_->scale(i)) * double(grains_->definition().radius)));
    out.push_back({"none in the ground", "", "within 1 % of a radius", min(lowest, 1.0), 1, 0.01});
  }

 private:
  static float ball_mass(double r) { return float(4.0 / 3 * pi * r * r * r * 2600); }
  std::optional<particles::ParticleSystem> grains_;
  particles::Coupling3 coupling_;
  BodyId table_;
  double felt_ = 0, weight_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_fire() { return std::make_unique<Fire>(); }
std::unique_ptr<Demo> make_fireball() { return std::make_unique<Fireball>(); }
std::unique_ptr<Demo> make_sand_heap() { return std::make_unique<SandHeap>(); }

}  // namespace carom::host::demo
