// Motion of particles against closed forms, and their bits over widths and threads.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/forces/drag.h"
#include "carom/math/elementary.h"
#include "carom/particles/system.h"

namespace particles_motion_test {
using namespace carom;
using namespace carom::particles;
using math::Vec3d;
using math::Vec3f;

SystemDef without_air() {
  SystemDef d;
  d.drag.law = DragLaw::none;
  return d;
}

void run(ParticleSystem& system, double dt, int steps, core::TaskScheduler* scheduler = nullptr) {
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(system.step(dt, scheduler).ok());
}

// Constant acceleration is integrated exactly: the parabola to float rounding for any step.
TEST(ParticleMotion, ParabolaForAnyStep) {
  for (const double dt : {0.5, 0.1, 1.0 / 60}) {
    ParticleSystem system = ParticleSystem::create(without_air()).value();
    ASSERT_TRUE(system.add({.position = {1, 20, -2}, .velocity = {3, 10, 1}}).value());
    run(system, dt, int(std::lround(2 / dt)));
    const Vec3d expected = Vec3d{1, 20, -2} + Vec3d{6, 20, 2} + Vec3d{0, -9.80665 * 2, 0};
    EXPECT_LT(math::distance(system.position(0), expected), 3e-5);
  }
}

// Linear drag exactly, also with a step of many time constants (chapter 4.3).
TEST(ParticleMotion, StokesDragIsExact) {
  SystemDef d;
  d.drag = {DragLaw::linear, 0.02f};
  d.mass = 0.01f;
  d.gravity = {0, -9.80665, 0};
  for (const double dt : {1.0, 0.25, 1.0 / 60}) {
    ParticleSystem system = ParticleSystem::create(d).value();
    ASSERT_TRUE(system.set_air({.wind = {.velocity = {5, 0, 0}}}).ok());
    ASSERT_TRUE(system.add({.velocity = {0, 8, 0}}).value());
    run(system, dt, int(std::lround(1 / dt)));
    const double rate = double(0.02f) / double(0.01f), e = std::exp(-rate);
    EXPECT_NEAR(system.velocity(0).x, 5 * (1 - e), 1e-5);
    EXPECT_NEAR(system.velocity(0).y, 8 * e - 9.80665 / rate * (1 - e), 1e-5);
    EXPECT_NEAR(system.position(0).x, 5 - 5 * (1 - e) / rate, 1e-5);
    EXPECT_NEAR(system.position(0).y, 8 * (1 - e) / rate - 9.80665 / rate * (1 - (1 - e) / rate), 1e-5);
  }
}

// Fall against quadratic drag: v = v_t tanh(gt/v_t); second order in the step.
TEST(ParticleMotion, QuadraticDragConverges) {
  SystemDef d;
  d.mass = 1;
  d.radius = 0.1f;
  d.drag = {DragLaw::quadratic, 0.6f, 1.23f};
  const double vt =
      forces::terminal_speed(1, 9.80665, double(1.23f), double(0.6f), math::pi * double(0.1f) * double(0.1f));
  const forces::Run exact = forces::quadratic_fall(vt, 9.80665, 4);
  double last = 0;
  for (const double dt : {0.4, 0.2, 0.1}) {
    ParticleSystem system = ParticleSystem::create(d).value();
    ASSERT_TRUE(system.add({}).value());
    run(system, dt, int(std::lround(4 / dt)));
    const double error = std::abs(-system.velocity(0).y - exact.speed);
    if (last > 0) EXPECT_NEAR(last / error, 4, 1);
    last = error;
  }
  EXPECT_LT(last, 0.01);
}

// Drag laws at their terminal speeds, at steps of any length: the fixed point of the step is that of the equation.
TEST(ParticleMotion, TerminalSpeedDoesNotDependOnTheStep) {
  for (const double dt : {1.0, 1.0 / 60}) {
    SystemDef d;
    d.radius = 1e-4f;
    d.mass = float(4.0 / 3 * math::pi * 1e-12 * 1000);
    d.drag = {DragLaw::schiller_naumann};
    ParticleSystem system = ParticleSystem::create(d).value();
    ASSERT_TRUE(system.add({}).value());
    run(system, dt, int(std::lround(20 / dt)));
    const double v = -system.velocity(0).y;
    const double re = forces::reynolds_number(double(d.drag.density), v, 2e-4, double(d.drag.viscosity));
    const double force =
        0.5 * double(d.drag.density) * forces::sphere_drag_schiller_naumann(re) * math::pi * 1e-8 * v * v;
    EXPECT_NEAR(force / (double(d.mass) * 9.80665), 1, 1e-4) << dt;
  }
}

TEST(ParticleMotion, StiffDragStaysStable) {
  SystemDef d;
  d.radius = 1e-5f;
  d.mass = 1e-13f;
  for (const DragLaw law : {DragLaw::stokes, DragLaw::schiller_naumann, DragLaw::quadratic}) {
    d.drag.law = law;
    ParticleSystem system = ParticleSystem::create(d).value();
    ASSERT_TRUE(system.set_air({.wind = {.velocity = {10, 0, 0}}}).ok());
    ASSERT_TRUE(system.add({.velocity = {-1000, 500, 0}}).value());
    double last = 1e9;
    for (int i = 0; i < 20; ++i) {
      ASSERT_TRUE(system.step(1).ok());
      const double off = std::abs(system.velocity(0).x - 10);
      EXPECT_LE(off, last + 1e-5);
      last = off;
    }
    EXPECT_LT(last, 0.2);
  }
}

ParticleSystem busy(int lanes, core::TaskScheduler* scheduler, bool field) {
  SystemDef d;
  d.capacity = 20'000;
  d.radius = 0.02f;
  d.mass = 0.002f;
  d.lanes = lanes;
  d.drag_over_age = Curve::make({{0, 1}, {1, 3}}).value();
  d.report_deaths = d.report_hits = true;
  ParticleSystem system = ParticleSystem::create(d).value();
  Air air;
  air.wind = {.velocity = {4, 0, 1}, .profile = environment::WindProfile::logarithmic};
  air.turbulence = {.speed = 2, .length = 3};
  air.whirls.push_back({.center = {2, 0, 0}});
  if (field) {
    air.field = environment::WindField{.mean = air.wind};
    air.field->turbulence = environment::Turbulence::make({.mean_wind = {4, 0, 1}}).value();
    air.field->gusts = {{.velocity = {2, 0, 0}, .front = -3, .gradient_distance = 2, .speed = 2}};
  }
  EXPECT_TRUE(system.set_air(air).ok());
  const Attractor attractor{.center = {0, 4, 3},
                            .radial = {.strength = -3, .reference = 1, .exponent = -1.5, .range = 8}};
  EXPECT_TRUE(system.set_attractors({&attractor, 1}).ok());
  std::vector<Collider> colliders(5);
  colliders[0].shape = geometry::Plane{};
  colliders[1].shape = geometry::Sphere{1};
  colliders[1].pose.position = {1, 1, 0};
  colliders[1].two_way = true;
  colliders[1].inverse_mass = 0.1f;
  colliders[2].shape = geometry::Box{{1, 0.5f, 1}};
  colliders[2].pose = {{-1, 1, 1}, math::normalize(math::Quatf{1, 0.2f, 0.1f, 0.3f})};
  colliders[2].angular_velocity = {0, 1, 0};
  colliders[2].center_of_mass = {-1, 1, 1};
  colliders[3].shape = geometry::Cylinder{0.5f, 0.3f};
  colliders[3].pose.position = {0, 0.5, 2};
  colliders[4].shape = geometry::Capsule3{0.5f, 0.2f};
  colliders[4].pose.position = {2, 0.5, 2};
  EXPECT_TRUE(system.set_colliders(colliders).ok());
  EmitterDef fountain;
  fountain.form = EmitterForm::disc;
  fountain.size = {2, 0, 0};
  fountain.position = {0, 3, 0};
  fountain.rate = 8000;
  fountain.spread = 0.6f;
  fountain.speed = {2, 8};
  fountain.lifetime = {0.5f, 2.5f};
  fountain.scale = {0.5f, 1.5f};
  EXPECT_TRUE(system.add_emitter(fountain).ok());
  run(system, 1.0 / 60, 150, scheduler);
  return system;
}

TEST(ParticleMotion, SameBitsForAnyWidthAndThreadCount) {
  const auto pool = core::make_thread_pool(3);
  for (const bool field : {false, true}) {
    const ParticleSystem first = busy(4, nullptr, field);
    EXPECT_GT(first.size(), 5000);
    EXPECT_GT(first.hits().size(), 10u);
    EXPECT_GT(first.exchanges()[1].touching, 0);
    for (const int lanes : {8, 16}) {
      const ParticleSystem other = busy(lanes, lanes == 8 ? nullptr : pool.get(), field);
      EXPECT_EQ(first.state_hash(), other.state_hash()) << lanes;
      ASSERT_EQ(first.hits().size(), other.hits().size());
      EXPECT_EQ(first.exchanges()[1].impulse, other.exchanges()[1].impulse);
      EXPECT_EQ(first.exchanges()[1].angular_impulse, other.exchanges()[1].angular_impulse);
    }
  }
}

// Smoke goes with the air: in a gust, in eddies and in a thermal that are asked of the environment, at 10 000 km from
// the world's origin, as the field says itself; on the steady wind alone, exactly.
TEST(ParticleMotion, SmokeGoesWithTheWindOfTheField) {
  SystemDef d;
  d.capacity = 2000;
  d.radius = 1e-6f;
  d.mass = 4e-15f;
  d.gravity = {0, 0, 0};
  d.drag = {.law = DragLaw::stokes};
  d.anchor = {1e7, 0, 0};
  environment::WindField wind{.mean = {.velocity = {6, 0, 0}, .profile = environment::WindProfile::power}};
  const auto worst_of = [&](double bound) {
    ParticleSystem smoke = ParticleSystem::create(d).value();
    EXPECT_TRUE(smoke.set_air({.field = wind}).ok());
    math::Random random(1);
    for (int i = 0; i < 2000; ++i)
      EXPECT_TRUE(smoke
                      .add({.position = d.anchor + Vec3d{random.uniform(-20.0, 20.0), random.uniform(1.0, 20.0),
                                                         random.uniform(-20.0, 20.0)}})
                      .value());
    run(smoke, 1.0 / 60, 30);
    double squares = 0;
    for (int i = 0; i < smoke.size(); ++i) {
      // Where it was half a step before.
      const Vec3d v = smoke.velocity(i), place = smoke.position(i) - v / 120;
      squares += math::length_squared(v - wind.at(place, smoke.time() - 1.0 / 120)) / smoke.size();
    }
    EXPECT_LT(std::sqrt(squares), bound);
  };
  worst_of(0.01);
  wind.gusts = {{.velocity = {4, 0, 2}, .direction = {-1, 0, 0}, .front = -1e7 - 20, .gradient_distance = 15}};
  wind.thermals = {{.base = d.anchor, .strength = 3, .radius = 30, .depth = 200}};
  worst_of(0.06);
  wind.turbulence = environment::Turbulence::make({.scales = {.length = {80, 80, 80}}, .mean_wind = {6, 0, 0}}).value();
  worst_of(0.4);
}

}  // namespace particles_motion_test
