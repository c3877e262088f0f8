// Weather: snow that settles on what it meets, a fountain whose drops splash, hail on pegs that hang on hinges.
#include "apps/host/demos/particles/particles.h"

namespace carom::host::demo {
namespace {

using particles::DragLaw;
using rigid::BodyId;
using rigid::Dim2;
using rigid::Dim3;

constexpr double water = 1000, density_of_ice = 917;
float ball_mass(double radius, double density) { return float(4.0 / 3 * pi * radius * radius * radius * density); }

class Snow final : public Repeatable<Snow, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "snow";
    d.title = "Snow in turbulent air";
    d.summary = "Flakes fall as slowly as their drag lets them, follow every eddy, and lie where they land.";
    d.group = "Particles";
    d.chapter = "8";
    d.text =
        "A flake is light for its size: it loses its own velocity within\n\n"
        "  τ = v_t / g ≈ 0.15 s\n\n"
        "and from then on goes with the air, sinking at v_t. The air here is a wind that grows with the height, and "
        "eddies upon it: a sum of waves u = a cos(k·x + ωt) with a ⟂ k, so that no air is made or lost anywhere "
        "(Kraichnan 1970), with less speed in the smaller ones as Kolmogorov's law says. What touches the ground, the "
        "hut or the tree stays there until it melts.";
    d.duration = 15;
    d.camera = {{9, 4.5, 13}, {0, 2.2, 0}};
    d.ground = 0;
    d.parameters = {
        {"wind", "Wind in 10 m", "m/s", "m/s", "", 0, 15, 0, 3, true},
        {"gusts", "Speed of the eddies", "m/s", "m/s", "root of the mean square", 0, 6, 0, 1.2, true},
        {"size", "Size of the largest eddies", "m", "m", "", 0.5, 20, 0, 4, true},
        {"sinks", "Speed of fall v_t", "m/s", "m/s", "of a flake in still air", 0.3, 4, 0, 1.4, false},
        {"rate", "Flakes a second", "1/s", "1/s", "", 50, 1200, 50, 500, true},
    };
    d.plots = {{"Mean velocity of the flakes", {"time", "s"}, {"speed", "m/s"}, {{"down"}, {"with the wind"}, {"v_t"}}},
               {"Flakes", {"time", "s"}, {"number", ""}, {{"in the air"}, {"lying"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    const auto fixed = [&](Vec3d p, const geometry::Shape3& shape, std::uint32_t color, const Quatf& turn = {}) {
      rigid::BodyDef<Dim3> body;
      body.type = rigid::BodyType::fixed;
      body.position = p;
      body.rotation = turn;
      stage.add(body, shape, {}, color);
    };
    stage.floor(0);
    fixed({-1.5, 0.9, 0}, geometry::Box{{1.5f, 0.9f, 1.2f}}, sand);
    const Quatf tilt = {0.9238795f, 0, 0, 0.3826834f};
    fixed({-1.5 - 0.62, 2.35, 0}, geometry::Box{{1.1f, 0.06f, 1.5f}}, red, tilt);
    fixed({-1.5 + 0.85, 2.35, 0}, geometry::Box{{1.1f, 0.06f, 1.5f}}, red, conjugate(tilt));
    fixed({2.6, 0.5, 0.5}, geometry::Cylinder{0.5f, 0.2f}, dark);
    for (int k = 0; k < 3; ++k) fixed({2.6, 1.7 + 0.9 * k, 0.5}, geometry::Cone{0.75f, 1.3f - 0.3f * float(k)}, green);
    particles::SystemDef d;
    d.capacity = 9000;
    d.radius = 0.04f;
    d.mass = 4e-6f;
    // Its drag follows from the speed at which it shall fall: stiff and linear, as of a flake's branches.
    d.drag = {.law = DragLaw::linear, .coefficient = float(4e-6 * 9.80665 / stage.value("sinks"))};
    d.color_over_age = particles::Gradient(0xf4f8ff);
    d.opacity_over_age = stage.keep(particles::Curve::make({{0, 0}, {0.03f, 1}, {0.9f, 1}, {1, 0}}));
    system_ = make_system(stage, d);
    if (!system_) return;
    particles::EmitterDef sky;
    sky.form = particles::EmitterForm::box;
    sky.size = {7, 0.3f, 5};
    sky.position = {0, 8, 0};
    sky.speed = {0, 0};
    sky.lifetime = {13, 16};
    stage.keep(system_->add_emitter(sky));
    particles::CouplingDef coupling;
    coupling.answer = particles::CollisionAnswer::stick;
    coupling_ = particles::Coupling3(coupling);
    blow(stage);
  }

  void changed(Stage3& stage, std::string_view) override { blow(stage); }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status status = stage.world().step(float(dt)); !status) return status;
    return system_ ? coupling_.step(stage.world(), *system_, dt) : core::Status{};
  }

  void after_step(Stage3& stage) override {
    if (!system_) return;
    const double t = stage.world().time();
    double down = 0, along = 0;
    int flying = 0;
    for (int i = 0; i < system_->size(); ++i) {
      const Vec3d v = system_->velocity(i);
      if (v == Vec3d{} || system_->age(i) < 0.7f) continue;
      down -= v.y;
      along += v.x;
      ++flying;
    }
    stage.sample(0, 2, t, stage.value("sinks"));
    if (flying > 20) {
      stage.sample(0, 0, t, down / flying);
      stage.sample(0, 1, t, along / flying);
      if (t > 5) {
        mean_ += down / flying;
        ++counted_;
      }
    }
    int air = 0;
    for (int i = 0; i < system_->size(); ++i) air += system_->velocity(i) == Vec3d{} ? 0 : 1;
    stage.sample(1, 0, t, air);
    stage.sample(1, 1, t, system_->size() - air);
    Cloud cloud;
    cloud.add(*system_);
    cloud.draw(stage);
    stage.say(format("%.0f flakes", double(system_->size())));
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return mixed(world, system_); }

  void expectations(Stage3&, std::vector<Expectation>& out) override {
    out.push_back({"mean speed of fall", "m/s", "v_t: the eddies carry as much up as down",
                   counted_ ? mean_ / counted_ : 0, 1.4, 0.15});
  }

 private:
  void blow(Stage3& stage) {
    if (!system_) return;
    particles::Air air;
    air.wind = {.velocity = {stage.value("wind"), 0, 0}, .profile = environment::WindProfile::power};
    air.turbulence = {.speed = stage.valuef("gusts"), .length = stage.valuef("size")};
    stage.check(system_->set_air(air));
    particles::EmitterDef sky = system_->emitter(0);
    sky.rate = stage.valuef("rate");
    // Upwind by what they drift while they fall.
    sky.position.x = -0.7 * stage.value("wind") * 8 / stage.value("sinks");
    stage.check(system_->set_emitter(0, sky));
  }

  std::optional<particles::ParticleSystem> system_;
  particles::Coupling3 coupling_;
  double mean_ = 0;
  int counted_ = 0;
};

class DropFountain final : public Repeatable<DropFountain, Demo3> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "drop-fountain";
    d.title = "A fountain of drops";
    d.summary = "Drops rise and fall with the drag of spheres, the wind drifts them, and each one splashes.";
    d.group = "Particles";
    d.chapter = "8";
    d.text =
        "Drops of water leave the nozzle in a narrow cone. Each feels the drag of a sphere of its size: Stokes' at "
        "rest, Schiller and Naumann's correction with the Reynolds number, a constant coefficient beyond,\n\n"
        "  F = 6 π μ r w (1 + 0.15 Re^0.687)      C_d = 0.44 for Re > 1000\n\n"
        "In a vacuum they would all reach v²/2g. A drop that strikes the basin ends, and bears three small ones that "
        "start where and when it ended. Small drops are held back and carried off by the wind far more.";
    d.duration = 8;
    d.camera = {{0, 4.5, 12}, {0, 2.6, 0}};
    d.ground = 0;
    d.parameters = {
        {"speed", "Speed at the nozzle", "m/s", "m/s", "", 3, 14, 0, 9.5, true},
        {"diameter", "Diameter of the drops", "m", "mm", "", 0.0005, 0.012, 0, 0.006, false},
        {"spread", "Half angle of the jet", "rad", "deg", "", 0, 0.5, 0, 0.12, true},
        {"wind", "Wind", "m/s", "m/s", "", 0, 12, 0, 1, true},
        {"rate", "Drops a second", "1/s", "1/s", "", 50, 2000, 50, 900, true},
    };
    d.plots = {{"Highest drop", {"time", "s"}, {"height", "m"}, {{"drops"}, {"v²/2g, no air"}}},
               {"Particles", {"time", "s"}, {"number", ""}, {{"drops"}, {"splashes"}}}};
    return d;
  }

  void build(Stage3& stage) override {
    stage.start({});
    stage.floor(0);
    rigid::BodyDef<Dim3> nozzle;
    nozzle.type = rigid::BodyType::fixed;
    nozzle.name = "nozzle";
    nozzle.position = {0, 0.25, 0};
    stage.add(nozzle, geometry::Cylinder{0.25f, 0.12f}, {}, dark);
    nozzle.name = "basin";
    for (int k = 0; k < 12; ++k) {
      const double a = 2 * pi * k / 12;
      nozzle.position = {2.6 * cos(a), 0.2, 2.6 * sin(a)};
      const SinCos<double> half = sincos(-0.5 * a);
      nozzle.rotation = {float(half.cos), 0, float(half.sin), 0};
      stage.add(nozzle, geometry::Box{{0.1f, 0.2f, 0.72f}}, {}, steel);
    }
    nozzle.rotation = {};
    const double r = 0.5 * stage.value("diameter");
    particles::SystemDef d;
    d.capacity = 5000;
    d.radius = float(r);
    d.mass = ball_mass(r, water);
    d.drag = {.law = DragLaw::schiller_naumann};
    d.report_hits = true;
    d.slowest_hit = 1;
    // Drawn larger than they are.
    d.size_over_age = particles::Curve(float(0.03 / r));
    d.color_over_age = stage.keep(particles::Gradient::make({{0, 0xe6f4ff}, {1, 0x6fb4ea}}));
    drops_ = make_system(stage, d);
    d.capacity = 4000;
    d.radius = float(0.3 * r);
    d.mass = ball_mass(0.3 * r, water);
    d.report_hits = false;
    d.size_over_age = stage.keep(particles::Curve::make({{0, float(0.018 / r / 0.3)}, {1, float(0.006 / r / 0.3)}}));
    splashes_ = make_system(stage, d);
    if (!drops_ || !splashes_) return;
    particles::EmitterDef jet;
    jet.form = particles::EmitterForm::disc;
    jet.size = {0.08f, 0, 0};
    jet.position = {0, 0.52, 0};
    jet.lifetime = {4, 4};
    stage.keep(drops_->add_emitter(jet));
    particles::CouplingDef coupling;
    coupling.answer = particles::CollisionAnswer::kill;
    coupling_ = particles::Coupling3(coupling);
    turn_on(stage);
  }

  void changed(Stage3& stage, std::string_view) override { turn_on(stage); }

  core::Status step(Stage3& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status status = stage.world().step(float(dt)); !status) return status;
    if (!drops_ || !splashes_) return {};
    if (const core::Status status = coupling_.step(stage.world(), *drops_, dt); !status) return status;
    if (const core::Status status = splashes_->step(dt); !status) return status;
    particles::SubEmission splash;
    splash.count = 3;
    splash.emitter.spread = 0.9f;
    splash.emitter.speed = {0.8f, 2.2f};
    splash.emitter.lifetime = {0.2f, 0.4f};
    splash.emitter.seed = 11;
    if (const auto born = splashes_->emit_at(drops_->hits(), splash); !born) return born.error();
    return {};
  }

  void after_step(Stage3& stage) override {
    if (!drops_ || !splashes_) return;
    const double t = stage.world().time();
    double top = 0;
    for (int i = 0; i < drops_->size(); ++i) top = max(top, drops_->position(i).y);
    stage.sample(0, 0, t, top);
    stage.sample(0, 1, t, 0.52 + square(stage.value("speed")) / 2 / 9.80665);
    stage.sample(1, 0, t, drops_->size());
    stage.sample(1, 1, t, splashes_->size());
    top_ = max(top_, top);
    Cloud cloud;
    cloud.add(*drops_);
    cloud.add(*splashes_);
    cloud.draw(stage);
    stage.say(format("%.2f m high, %.0f drops", top, double(drops_->size())));
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return mixed(mixed(world, drops_), splashes_); }

  void expectations(Stage3& stage, std::vector<Expectation>& out) override {
    const double vacuum = 0.52 + square(stage.value("speed")) / 2 / 9.80665;
    // m v v' = −m g − ½ ρ C_d A v² with C_d = .44: h = (v_t²/2g) ln(1 + v²/v_t²).
    const double r = 0.5 * stage.value("diameter");
    const double vt2 = 2 * double(ball_mass(r, water)) * 9.80665 / (1.225 * 0.44 * pi * r * r);
    const double h = 0.52 + vt2 / (2 * 9.80665) * log(1 + square(stage.value("speed")) / vt2);
    out.push_back({"height of the jet", "m", "(v_t²/2g) ln(1 + v²/v_t²), C_d = 0.44", top_, h, 0.03 * h});
    out.push_back({"lower than without air", "", "", top_ < 0.97 * vacuum ? 1.0 : 0.0, 1, 0});
  }

 private:
  void turn_on(Stage3& stage) {
    if (!drops_ || !splashes_) return;
    particles::EmitterDef jet = drops_->emitter(0);
    jet.speed = {0.97f * stage.valuef("speed"), stage.valuef("speed")};
    jet.spread = stage.valuef("spread");
    jet.rate = stage.valuef("rate");
    stage.check(drops_->set_emitter(0, jet));
    const particles::Air air{.wind = {.velocity = {stage.value("wind"), 0, 0}}};
    stage.check(drops_->set_air(air));
    stage.check(splashes_->set_air(air));
  }

  std::optional<particles::ParticleSystem> drops_, splashes_;
  particles::Coupling3 coupling_;
  double top_ = 0;
};

class Hail final : public Repeatable<Hail, Demo2> {
 public:
  Declaration declaration() const override {
    Declaration d;
    d.id = "hail-on-pegs";
    d.title = "Hail on pegs and scales";
    d.summary = "Hailstones rattle down a Galton board onto bodies that feel every blow: paddles turn, a scale sinks.";
    d.group = "Particles";
    d.chapter = "8";
    d.dimension = 2;
    d.text =
        "At each of eight rows of pegs a stone goes half a pitch to the left or to the right. Where no row knows what "
        "the one above did, the share of the k-th channel is binomial (Galton 1889),\n\n"
        "  P(k) = C(8, k)/2⁸,   σ = ½ s √8\n\n"
        "Stones that bounce do not forget so readily. These pegs are thick and far enough apart that at e = 0.35, of "
        "two rows in turn, 53 % send a stone the same way: of 7 900 stones no share is off by more than 0.014. At "
        "e = 0.5 or 0.1 the curve is a quarter wider than Galton's, at 150 stones a second, which push each other, "
        "half as wide "
        "again.\n\n"
        "Particles here are not only for show: what a body does to a hailstone, the hailstone does to the body,\n\n"
        "  J = (1 + e) m_eff v_n,   1/m_eff = 1/m + 1/M + (r × n)² / I\n\n"
        "and both sums are kept apart in double, so that momentum is only handed over. The paddles hang on free "
        "hinges and are turned by what strikes them. The pan hangs on a spring; hail that bounces off it or lies on it "
        "presses it down by\n\n"
        "  F = Σ J / Δt";
    d.duration = 20;
    d.camera.target = {0, 3.5, 0};
    d.camera.height = 7.8;
    d.camera.width = 6;
    d.parameters = {
        {"rate", "Hailstones a second", "1/s", "1/s", "", 5, 150, 5, 40, true},
        {"diameter", "Diameter", "m", "cm", "", 0.03, 0.09, 0, 0.05, false},
        {"restitution", "Restitution e", "", "", "", 0, 0.9, 0, 0.35, false},
        yes_or_no("two_way", "Bodies feel it", "", true),
    };
    Series law{"binomial"};
    double share = 1.0 / (1 << rows);
    for (int k = 0; k <= rows; share *= double(rows - k) / (k + 1), ++k) law.points.push_back({channel(k), share});
    d.plots = {{"Where they leave the pegs",
                {"place", "m"},
                {"share of the stones", ""},
                {law, {.name = "counted", .style = Series::Style::points, .latest = true}}},
               {"Force on the pan", {"time", "s"}, {"force", "N"}, {{"hail"}, {"spring, beyond its load at rest"}}},
               {"Turning of the paddles", {"time", "s"}, {"rate", "rad/s"}, {{"left"}, {"right"}}},
               {"Momentum handed over, all in all", {"time", "s"}, {"momentum", "N·s"}, {{"by the hail"}, {"error"}}}};
    return d;
  }

  void build(Stage2& stage) override {
    stage.start({});
    stage.floor(0);
    const auto fixed = [&](const char* name, Vec2d place, const geometry::Shape2& shape) {
      rigid::BodyDef<Dim2> body;
      body.type = rigid::BodyType::fixed;
      body.name = name;
      body.position = place;
      stage.add(body, shape, {}, steel);
    };
    for (int row = 0; row < rows; ++row)
      for (int k = 0; k < 13 - row % 2; ++k)
        fixed("peg", {pitch * (k - 6 + 0.5 * (row % 2)), top - drop * row}, geometry::Circle{0.07f});
    for (int k = 0; k < 12; ++k)
      fixed("wall", {pitch * (k - 5.5), counted_at - 0.4}, geometry::make_box2({0.015f, 0.35f}));
    rigid::ShapeDef<Dim2> light;
    light.density = 20;
    for (int side = 0; side < 2; ++side) {
      rigid::BodyDef<Dim2> paddle;
      paddle.name = "paddle";
      paddle.allow_sleep = false;
      paddle.angular_damping = 0.4f;
      paddle.position = {side ? 0.8 : -0.8, 2.7};
      paddles_[side] =
          stage.add(paddle, {{geometry::make_box2({0.7f, 0.04f}), light}, {geometry::make_box2({0.04f, 0.7f}), light}},
                    side ? violet : blue);
      rigid::HingeJointDef<Dim2> hinge;
      hinge.body_b = paddles_[side];
      // Off the line of the hail's middle, so that it turns them.
      hinge.frame_a.p = {side ? 0.8f : -0.8f, 2.7f};
      stage.keep(stage.world().create_joint(hinge));
    }
    rigid::BodyDef<Dim2> pan;
    pan.name = "pan";
    pan.position = {0, pan_height};
    pan.allow_sleep = false;
    pan.locks.x = true;
    pan.locks.rotation_z = true;
    rigid::ShapeDef<Dim2> heavy;
    heavy.density = 20;
    pan_ = stage.add(pan, geometry::make_box2({2.5f, 0.08f}), heavy, gold);
    particles::SystemDef d;
    d.capacity = 3000;
    d.planar = true;
    d.radius = 0.5f * stage.valuef("diameter");
    d.mass = ball_mass(double(d.radius), density_of_ice);
    d.color_over_age = particles::Gradient(0x3d86c6);
    d.opacity_over_age = stage.keep(particles::Curve::make({{0, 1}, {0.9f, 1}, {1, 0}}));
    d.contacts = {.enabled = true, .restitution = stage.valuef("restitution"), .friction = friction, .substeps = 4};
    system_ = make_system(stage, d);
    if (!system_) return;
    particles::EmitterDef sky;
    sky.form = particles::EmitterForm::segment;
    sky.size = {0.03f, 0, 0};
    sky.position = {0, top + 0.35, 0};
    sky.direction = {0, -1, 0};
    sky.speed = {0, 0};
    sky.rate = stage.valuef("rate");
    sky.lifetime = {7, 9};
    stage.keep(system_->add_emitter(sky));
    particles::CouplingDef coupling;
    coupling.restitution = stage.valuef("restitution");
    coupling.friction = friction;
    coupling.two_way = stage.value("two_way") > 0.5;
    coupling_ = particles::Coupling2(coupling);
    weight_ = double(stage.at(pan_).mass) * 9.80665;
    before_ = stage.world().totals().momentum.y;
  }

  void changed(Stage2& stage, std::string_view) override {
    if (!system_) return;
    particles::EmitterDef sky = system_->emitter(0);
    sky.rate = stage.valuef("rate");
    stage.check(system_->set_emitter(0, sky));
  }

  void before_step(Stage2& stage) override {
    // The scale: a spring and a damper that bear the pan where it began.
    const rigid::BodyState<Dim2> pan = stage.at(pan_);
    spring_ = 800 * (pan_height - pan.pose.position.y) - 80 * double(pan.linear_velocity.y);
    stage.check(stage.world().add_force(pan_, {0, float(weight_ + spring_)}));
  }

  core::Status step(Stage2& stage) override {
    const double dt = stage.declaration().dt;
    if (const core::Status status = stage.world().step(float(dt)); !status) return status;
    if (!system_) return {};
    if (const core::Status status = coupling_.gather(stage.world(), *system_); !status) return status;
    if (const core::Status status = system_->step(dt); !status) return status;
    // What the bodies get is weighed on both sides of the hand-over.
    const Vec2d before = stage.world().totals().momentum;
    if (const core::Status status = coupling_.give_back(stage.world(), *system_); !status) return status;
    const Vec2d got = stage.world().totals().momentum - before;
    double given = 0, on_pan = 0;
    for (int i = 0; i < int(system_->exchanges().size()); ++i) {
      const rigid::BodyId body = coupling_.body_of(i);
      const double j = system_->exchanges()[std::size_t(i)].impulse.y;
      if (body == paddles_[0] || body == paddles_[1] || body == pan_) given += j;
      if (body == pan_) on_pan -= j;
    }
    handed_ += given;
    if (stage.value("two_way") > 0.5) error_ = max(error_, abs(got.y - given));
    force_ += 0.1 * (on_pan / dt - force_);
    return {};
  }

  void after_step(Stage2& stage) override {
    if (!system_) return;
    const double t = stage.world().time();
    count(stage);
    stage.sample(1, 0, t, force_);
    stage.sample(1, 1, t, spring_);
    for (int side = 0; side < 2; ++side) {
      const double w = double(stage.at(paddles_[side]).angular_velocity);
      stage.sample(2, side, t, w);
      fastest_ = max(fastest_, abs(w));
    }
    stage.sample(3, 0, t, handed_);
    stage.sample(3, 1, t, error_);
    if (t > 8) {
      mean_hail_ += force_;
      mean_spring_ += spring_;
    }
    Cloud cloud;
    cloud.add(*system_);
    cloud.draw(stage);
    stage.say(format("%.0f hailstones through, %.1f N on the pan", through_, force_));
  }

  std::uint64_t state_hash(std::uint64_t world) const override { return mixed(world, system_); }

  void expectations(Stage2&, std::vector<Expectation>& out) override {
    // Three standard errors of 700 stones, and what many of them miss the law by.
    double farthest = 0, share = 1.0 / (1 << rows);
    for (int k = 0; k <= rows; share *= double(rows - k) / (k + 1), ++k)
      farthest = max(farthest, abs(in_channel_[k] / through_ - share));
    const double spread = 0.5 * pitch * sqrt(double(rows));
    out.push_back({"spread under the pegs", "m", "½ s √8: the binomial law",
                   sqrt(squares_ / through_ - square(sum_ / through_)), spread, 0.1 * spread});
    out.push_back({"farthest share from the binomial law", "", "", farthest, 0, 0.07});
    out.push_back({"momentum lost on the way", "N·s", "none but rounding to float", error_, 0, 1e-4});
    out.push_back({"the spring bears what the hail gives", "", "mean over 12 s", mean_spring_ / mean_hail_, 1, 0.1});
    out.push_back({"paddles turn", "", "", fastest_ > 0.5 ? 1.0 : 0.0, 1, 0});
  }

 private:
  static constexpr int rows = 8;
  static constexpr double pitch = 0.25, drop = 0.275, top = 6.5, pan_height = 1;  // m; the first two are of the pegs
  static constexpr double counted_at = top - drop * (rows - 0.5);                 // m
  static constexpr float friction = 0.03f;                                        // ice on steel
  static double channel(int k) { return pitch * (k - 0.5 * rows); }               // m, its middle

  /// Stones that came through the last row since they were looked at.
  void count(Stage2& stage) {
    const double before = through_;
    for (int i = 0; i < system_->size(); ++i) {
      const Vec2d p{system_->position(i).x, system_->position(i).y};
      const std::size_t id = system_->id(i);
      if (id >= seen_.size()) seen_.resize(id + 1);
      if (seen_[id] || p.y > counted_at) continue;
      seen_[id] = true;
      through_ += 1;
      sum_ += p.x;
      squares_ += p.x * p.x;
      const int k = int(floor(p.x / pitch + 0.5 * (rows + 1)));
      if (k >= 0 && k <= rows) in_channel_[k] += 1;
    }
    if (through_ > before)
      for (int k = 0; k <= rows; ++k) stage.sample(0, 1, channel(k), in_channel_[k] / through_);
  }

  std::optional<particles::ParticleSystem> system_;
  particles::Coupling2 coupling_;
  std::vector<bool> seen_;
  double in_channel_[rows + 1] = {}, through_ = 0, sum_ = 0, squares_ = 0;
  BodyId paddles_[2], pan_;
  double weight_ = 0, spring_ = 0, before_ = 0, force_ = 0, handed_ = 0, error_ = 0, fastest_ = 0, mean_hail_ = 0,
         mean_spring_ = 0;
};

}  // namespace

std::unique_ptr<Demo> make_snow() { return std::make_unique<Snow>(); }
std::unique_ptr<Demo> make_drop_fountain() { return std::make_unique<DropFountain>(); }
std::unique_ptr<Demo> make_hail() { return std::make_unique<Hail>(); }

}  // namespace carom::host::demo
