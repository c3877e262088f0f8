// What is refused, and how it is said; what a step does not allocate; emitters and curves.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <new>

#include "carom/geometry/triangle_mesh.h"
#include "carom/math/elementary.h"
#include "carom/particles/coupling.h"

namespace particles_refusals_test {
using namespace carom;
using namespace carom::particles;
using math::Vec3d;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

void expect_message(const core::Status& status, const char* part) {
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find(part), std::string::npos) << status.error().message;
}
template <class T>
void expect_message(const core::Result<T>& result, const char* part) {
  ASSERT_FALSE(result.ok());
  EXPECT_NE(result.error().message.find(part), std::string::npos) << result.error().message;
}

TEST(ParticleRefusals, Definitions) {
  const auto refused = [](auto change, const char* part) {
    SystemDef d;
    change(d);
    expect_message(ParticleSystem::create(d), part);
  };
  refused([](SystemDef& d) { d.capacity = 0; }, "capacity is 0");
  refused([](SystemDef& d) { d.capacity = 1 << 25; }, "capacity");
  refused([](SystemDef& d) { d.anchor.y = double(nan); }, "anchor");
  refused([](SystemDef& d) { d.gravity.x = double(nan); }, "gravity");
  refused([](SystemDef& d) { d.planar = true, d.gravity.z = 1; }, "planar");
  refused([](SystemDef& d) { d.radius = -1; }, "radius is -1");
  refused([](SystemDef& d) { d.mass = nan; }, "mass");
  refused([](SystemDef& d) { d.lanes = 5; }, "lanes");
  refused([](SystemDef& d) { d.drag.coefficient = -1; }, "coefficient");
  refused([](SystemDef& d) { d.drag.viscosity = 0; }, "viscosity");
  refused([](SystemDef& d) { d.drag_over_age = Curve(-1); }, "drag_over_age");
  refused([](SystemDef& d) { d.contacts.substeps = 0; }, "substeps");
  refused([](SystemDef& d) { d.contacts.restitution = 2; }, "restitution");
  refused([](SystemDef& d) { d.limit = nan; }, "limit");

  ParticleSystem s = ParticleSystem::create({}).value();
  expect_message(s.add({.position = {double(nan), 0, 0}}), "position");
  expect_message(s.add({.lifetime = 0}), "lifetime");
  expect_message(s.add({.scale = nan}), "scale");
  expect_message(s.step(0), "step of 0");
  expect_message(s.step(double(nan)), "step");
  expect_message(s.burst({.count = 1}), "count");
  expect_message(s.burst({.mass = 0}), "mass");
  expect_message(s.add_emitter({.rate = nan}), "rate");
  expect_message(s.add_emitter({.form = EmitterForm::mesh}), "mesh");
  expect_message(s.add_emitter({.speed = {2, 1}}), "speed");
  expect_message(s.add_emitter({.lifetime = {0, 1}}), "lifetime");
  expect_message(s.add_emitter({.direction = {0, 2, 0}}), "direction");
  expect_message(s.set_emitter(3, {}), "emitter 3 does not exist");
  expect_message(s.emit(-1, 3), "does not exist");
  expect_message(s.set_air({.wind = {.velocity = {0, double(nan), 0}}}), "velocity");
  expect_message(s.set_air({.turbulence = {.speed = 1, .length = 0}}), "length");
  expect_message(s.set_air({.whirls = {{.axis = {0, 2, 0}}}}), "axis");
  const Attractor far{.radial = {.reference = 0}};
  expect_message(s.set_attractors({&far, 1}), "reference");
  Collider bad;
  bad.shape = geometry::Sphere{-1};
  EXPECT_FALSE(s.set_colliders({&bad, 1}).ok());
  bad = {};
  bad.restitution = nan;
  expect_message(s.set_colliders({&bad, 1}), "restitution");
  bad = {};
  bad.velocity.x = nan;
  expect_message(s.set_colliders({&bad, 1}), "velocity");
  EXPECT_EQ(s.size(), 0);
  expect_message(Curve::make({{0.5f, 1}, {0.2f, 1}}), "age of key 1");
  expect_message(Curve::make({{0, nan}}), "value of key 0");
  expect_message(Gradient::make({{0, 0x1000000}}), "rgb");
  expect_message(Coupling3::check({.friction = -1}), "friction");
}

// What is no number any more is taken out and counted, and harms nobody else.
TEST(ParticleRefusals, WhatIsLostLeaves) {
  SystemDef d;
  d.limit = 100;
  ParticleSystem s = ParticleSystem::create(d).value();
  for (int i = 0; i < 40; ++i) ASSERT_TRUE(s.add({.position = {0.1 * i, 0, 0}}).value());
  s.set_velocity(7, {double(nan), 0, 0});
  s.set_velocity(9, {1e5, 0, 0});
  ASSERT_TRUE(s.set_air({.wind = {.velocity = {1, 0, 0}, .profile = environment::WindProfile::power},
                         .turbulence = {.speed = 1}})
                  .ok());
  ASSERT_TRUE(s.step(0.01).ok());
  EXPECT_EQ(s.size(), 38);
  EXPECT_EQ(s.lost(), 2);
}

TEST(ParticleRefusals, RateIsKeptForAnyStep) {
  for (const double dt : {0.5, 1.0 / 60, 1.0 / 7}) {
    ParticleSystem s = ParticleSystem::create({}).value();
    ASSERT_TRUE(s.add_emitter({.rate = 37, .start = 0.25f, .duration = 2, .lifetime = {50, 50}}).ok());
    for (int i = 0; i * dt < 3.5; ++i) ASSERT_TRUE(s.step(dt).ok());
    EXPECT_NEAR(s.size(), 74, 1) << dt;
    // They are as far apart as the rate says, not in clumps of a step.
    double youngest = 1e9, oldest = 0;
    for (int i = 0; i < s.size(); ++i) {
      youngest = std::min(youngest, double(s.age(i)));
      oldest = std::max(oldest, double(s.age(i)));
    }
    EXPECT_NEAR(oldest - youngest, 2, 0.08);
  }
}

TEST(ParticleRefusals, FormsAreFilledEvenly) {
  const auto mean_square = [](EmitterDef d) {
    d.speed = {0, 0};
    d.lifetime = {1000, 1000};
    ParticleSystem s = ParticleSystem::create({.capacity = 20'000, .gravity = {}, .drag = {DragLaw::none}}).value();
    EXPECT_TRUE(s.emit(s.add_emitter(d).value(), 20'000).ok());
    Vec3d sum{};
    for (int i = 0; i < s.size(); ++i) {
      const Vec3d p = s.position(i);
      sum += Vec3d{p.x * p.x, p.y * p.y, p.z * p.z} / double(s.size());
    }
    return sum;
  };
  // Means of x², y², z² over each form; the error of the mean of 20 000 is below 1 %.
  const auto near = [](Vec3d found, Vec3d expected) {
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 0.03 * (0.1 + expected[k]));
  };
  near(mean_square({.form = EmitterForm::segment, .size = {3, 0, 0}}), {3, 0, 0});
  near(mean_square({.form = EmitterForm::disc, .size = {2, 0, 0}}), {1, 0, 1});
  near(mean_square({.form = EmitterForm::disc, .size = {2, 0, 0}, .surface_only = true}), {2, 0, 2});
  near(mean_square({.form = EmitterForm::box, .size = {1, 2, 3}}), {1.0 / 3, 4.0 / 3, 3});
  near(mean_square({.form = EmitterForm::sphere, .size = {2, 0, 0}}), {0.8, 0.8, 0.8});
  near(mean_square({.form = EmitterForm::sphere, .size = {2, 0, 0}, .surface_only = true}),
       {4.0 / 3, 4.0 / 3, 4.0 / 3});
  // A large and a small triangle: by area. ∫x² over the right triangle (0,0) (a,0) (0,b) is a²/6 of its area.
  std::vector<math::Vec3f> corners = {{0, 0, 0}, {0, 0, 6}, {6, 0, 0}};
  const auto mesh = geometry::make_triangle_mesh(corners, {0, 1, 2}).value();
  near(mean_square({.form = EmitterForm::mesh, .mesh = mesh}), {6, 0, 6});
}

TEST(ParticleRefusals, CurvesAndColours) {
  const Curve c = Curve::make({{0, 1}, {0.5f, 3}, {1, 0}}).value();
  EXPECT_FLOAT_EQ(c(0.25f), 2);
  EXPECT_FLOAT_EQ(c(0.75f), 1.5f);
  EXPECT_FLOAT_EQ(c(2), 0);
  EXPECT_FLOAT_EQ(c(-1), 1);
  EXPECT_TRUE(Curve(4).is_constant());
  const Gradient g = Gradient::make({{0, 0x000000}, {1, 0xff8040}}).value();
  EXPECT_EQ(g(0.5f), 0x804020u);
}

// The field has no divergence and the speed that was asked for: read off particles that the air carries at once.
TEST(ParticleRefusals, TurbulenceIsFreeOfDivergence) {
  SystemDef d;
  d.capacity = 30'000;
  d.gravity = {};
  d.drag = {.law = DragLaw::linear, .coefficient = 1e3f};
  ParticleSystem s = ParticleSystem::create(d).value();
  ASSERT_TRUE(s.set_air({.turbulence = {.speed = 3, .length = 2, .waves = 24}}).ok());
  const double h = 1e-2;
  math::Random random(1);
  for (int i = 0; i < 3000; ++i) {
    const Vec3d at{random.uniform(-40.0, 40.0), random.uniform(-40.0, 40.0), random.uniform(-40.0, 40.0)};
    for (int k = 0; k < 6; ++k) {
      Vec3d p = at;
      p[k / 2] += k % 2 ? h : -h;
      ASSERT_TRUE(s.add({.position = p}).value());
    }
  }
  ASSERT_TRUE(s.step(1e-3).ok());
  double squares = 0, divergence = 0, gradient = 0;
  for (int i = 0; i < 3000; ++i) {
    double div = 0;
    for (int k = 0; k < 3; ++k) {
      const Vec3d a = s.velocity(6 * i + 2 * k), b = s.velocity(6 * i + 2 * k + 1);
      div += (b[k] - a[k]) / (2 * h);
      gradient += math::square((b[k] - a[k]) / (2 * h));
    }
    divergence += div * div;
    squares += math::dot(s.velocity(6 * i), s.velocity(6 * i));
  }
  EXPECT_NEAR(std::sqrt(squares / 3000), 3, 0.15);
  EXPECT_LT(divergence, 1e-3 * gradient);
}

// A vortex and a centre of attraction: a circle and an orbit of Kepler.
TEST(ParticleRefusals, OrbitAndWhirl) {
  SystemDef d;
  d.gravity = {};
  d.drag.law = DragLaw::none;
  ParticleSystem s = ParticleSystem::create(d).value();
  const Attractor sun{.radial = {.strength = -4, .reference = 1, .exponent = -2}};
  ASSERT_TRUE(s.set_attractors({&sun, 1}).ok());
  ASSERT_TRUE(s.add({.position = {1, 0, 0}, .velocity = {0, 2, 0}}).value());
  // v = 2 at r = 1: ten turns. The phase is of second order in the step, energy and form of the orbit stay.
  for (int i = 0; i < 10'000; ++i) ASSERT_TRUE(s.step(math::pi / 1000).ok());
  EXPECT_LT(math::distance(s.position(0), Vec3d{1, 0, 0}), 2e-3);
  EXPECT_NEAR(math::length(s.position(0)), 1, 1e-4);
  d.drag = {.law = DragLaw::linear, .coefficient = 1e3f};
  s = ParticleSystem::create(d).value();
  ASSERT_TRUE(s.set_air({.whirls = {{.vortex = {.circulation = 6, .core_radius = 0.5}}}}).ok());
  ASSERT_TRUE(s.add({.position = {2, 0, 0}}).value());
  ASSERT_TRUE(s.add({.position = {0.25, 0, 0}}).value());
  ASSERT_TRUE(s.step(1e-3).ok());
  EXPECT_NEAR(s.velocity(0).z, -6 / (2 * math::pi * 2), 2e-3);
  EXPECT_NEAR(s.velocity(1).z, -6 / (2 * math::pi * 0.5) * 0.5, 2e-3);
}

// A system at 10⁸ m does what it does at the origin.
TEST(ParticleRefusals, FarFromTheOrigin) {
  const auto run = [](Vec3d anchor) {
    SystemDef d;
    d.anchor = anchor;
    ParticleSystem s = ParticleSystem::create(d).value();
    Collider ball;
    ball.shape = geometry::Sphere{1};
    ball.pose.position = anchor;
    EXPECT_TRUE(s.set_colliders({&ball, 1}).ok());
    EXPECT_TRUE(s.add_emitter({.form = EmitterForm::sphere, .position = anchor + Vec3d{0, 4, 0}, .rate = 500}).ok());
    for (int i = 0; i < 120; ++i) EXPECT_TRUE(s.step(1.0 / 64).ok());
    Vec3d sum{};
    for (int i = 0; i < s.size(); ++i) sum += s.position(i) - anchor;
    return sum / double(s.size());
  };
  EXPECT_LT(math::distance(run({}), run({1e8, -1e8, 1e8})), 1e-6);
}

}  // namespace particles_refusals_test
