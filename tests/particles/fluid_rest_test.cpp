// A liquid at rest, and what is exact about it: hydrostatics, volume, weight; bits; input that is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#if defined(__GLIBC__)
#include <malloc.h>
#endif

#include "carom/core/scheduler.h"
#include "carom/particles/fluid.h"

namespace fluid_rest_test {
using namespace carom;
using namespace carom::particles;
using rigid::Dim2;
using rigid::Dim3;

constexpr double gravity = 9.80665;

Fluid2 pool(float spacing, double width, double depth, double height) {
  Fluid2 f = Fluid2::create({.upper = {width, height}, .spacing = spacing}).value();
  f.add_box({0, 0}, {width, depth}).value();
  return f;
}

// p = ρ g d to half a per cent of the deepest, at once and after 12 s; the surface stays where it was to 0.5 %, the
// density within 0.5 % of that at rest, and nothing moves faster than a millimetre a second.
TEST(FluidRest, HydrostaticPressureAndVolumeForTwelveSeconds) {
  Fluid2 f = pool(0.02f, 1, 0.5, 0.8);
  for (int i = 0; i < 720; ++i) {
    f.step(1.0f / 60).value();
    if (i != 2 && i != 719) continue;
    for (const double depth : {0.05, 0.15, 0.25, 0.35, 0.45, 0.49})
      for (const double x : {0.02, 0.37, 0.98})
        EXPECT_NEAR(f.pressure({x, 0.5 - depth}), 1000 * gravity * depth, 0.005 * 1000 * gravity * 0.5)
            << "at depth " << depth << " after step " << i;
  }
  for (const double x : {0.01, 0.3, 0.5, 0.99}) EXPECT_NEAR(f.surface_height({x, 0}), 0.5, 0.0025);
  EXPECT_NEAR(f.statistics().mean_density, 1, 0.005);
  EXPECT_LT(f.statistics().density_deviation, 0.005f);
  EXPECT_LT(f.statistics().max_speed, 1e-3f);
  EXPECT_EQ(f.size(), 50 * 25);
}

TEST(FluidRest, HydrostaticPressureInSpace) {
  Fluid3 f = Fluid3::create({.lower = {1e6, 0, -3}, .upper = {1e6 + 0.4, 0.5, -2.6}, .spacing = 0.02f}).value();
  f.add_box({1e6, 0, -3}, {1e6 + 0.4, 0.4, -2.6}).value();
  for (int i = 0; i < 60; ++i) f.step(1.0f / 60).value();
  for (const double depth : {0.05, 0.15, 0.25, 0.35})
    EXPECT_NEAR(f.pressure({1e6 + 0.13, 0.4 - depth, -2.75}), 1000 * gravity * depth, 0.01 * 1000 * gravity * 0.4);
  // The floor carries what the particles weigh.
  EXPECT_NEAR(f.wall_impulse().y * 60, -f.size() * double(f.particle_mass()) * gravity, 0.5);
  EXPECT_LT(f.statistics().max_speed, 2e-3f);
}

// A liquid that fills its vessel altogether has no surface: pressure differences and stillness are the same.
TEST(FluidRest, SealedVessel) {
  Fluid2 f = pool(0.025f, 0.5, 0.5, 0.5);
  for (int i = 0; i < 60; ++i) f.step(1.0f / 60).value();
  EXPECT_NEAR(f.pressure({0.2, 0.1}) - f.pressure({0.2, 0.4}), 1000 * gravity * 0.3, 0.01 * 1000 * gravity * 0.3);
  EXPECT_LT(f.statistics().max_speed, 2e-3f);
  EXPECT_EQ(f.size(), 400);
}

template <class D>
Fluid<D> splash(int threads, core::TaskScheduler* scheduler = nullptr) {
  FluidDef<D> d{.spacing = D::dimension == 2 ? 0.02f : 0.05f, .threads = threads, .scheduler = scheduler};
  Fluid<D> f = Fluid<D>::create(d).value();
  typename D::Position high = FluidDef<D>::unit_position();
  high[0] = 0.4;
  high[1] = 0.7;
  f.add_box({}, high).value();
  return f;
}
template <class D>
std::uint64_t run(Fluid<D>& f, int steps) {
  for (int i = 0; i < steps; ++i) f.step(1.0f / 60).value();
  return f.state_hash();
}

TEST(FluidDeterminism, SameBitsForAnyThreads) {
  Fluid2 plane = splash<Dim2>(1);
  const std::uint64_t expected2 = run(plane, 30);
  Fluid3 space = splash<Dim3>(1);
  const std::uint64_t expected3 = run(space, 30);
  for (const int threads : {2, 3}) {
    Fluid2 p = splash<Dim2>(threads);
    EXPECT_EQ(run(p, 30), expected2) << threads;
    Fluid3 s = splash<Dim3>(threads);
    EXPECT_EQ(run(s, 30), expected3) << threads;
  }
}

TEST(FluidDeterminism, ACopyGoesOnAsTheOriginal) {
  Fluid2 f = splash<Dim2>(1);
  run(f, 20);
  Fluid2 copy = f;
  const std::uint64_t expected = run(f, 20);
  EXPECT_EQ(run(copy, 20), expected);
  Fluid2 other = splash<Dim2>(1);
  other = copy;
  EXPECT_EQ(run(other, 5), run(f, 5));
}

TEST(FluidInput, BadDefinitionsAreRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refused = [](const FluidDef<Dim2>& d, const char* word) {
    const auto f = Fluid2::create(d);
    ASSERT_FALSE(f.ok()) << word;
    EXPECT_NE(f.error().message.find(word), std::string::npos) << f.error().message;
  };
  refused({.spacing = 0}, "spacing");
  refused({.spacing = nan}, "spacing");
  refused({.density = -1}, "density");
  refused({.viscosity = nan}, "viscosity");
  refused({.gravity = {0, nan}}, "gravity");
  refused({.max_particles = 0}, "max_particles");
  refused({.courant = 0}, "courant");
  refused({.max_substeps = 0}, "max_substeps");
  refused({.threads = 0}, "threads");
  refused({.upper = {-1, 1}}, "upper");
  refused({.upper = {1e9, 1e9}}, "cells");
  refused({.lower = {std::numeric_limits<double>::infinity(), 0}}, "lower");
}

TEST(FluidInput, BadCallsAreRefusedAndChangeNothing) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  Fluid2 f = Fluid2::create({.spacing = 0.05f, .max_particles = 30}).value();
  EXPECT_FALSE(f.step(0).ok());
  EXPECT_FALSE(f.step(nan).ok());
  EXPECT_FALSE(f.step(0.2f).ok());
  EXPECT_FALSE(f.add_particle({nan, 0}).ok());
  EXPECT_FALSE(f.add_particle({0.5, 0.5}, {0, nan}).ok());
  EXPECT_FALSE(f.add_ball({0.5, 0.5}, -1).ok());
  EXPECT_FALSE(f.add_box({0, 0}, {1, 1}).ok()) << "more than max_particles";
  EXPECT_EQ(f.size(), 0);
  EXPECT_FALSE(f.add_tap({.velocity = {0, 0}}).ok());
  EXPECT_FALSE(f.add_tap({.velocity = {1, 0}, .radius = nan}).ok());
  EXPECT_FALSE(f.add_drain({.lower = {1, 0}, .upper = {0, 1}}).ok());
  EXPECT_FALSE(f.set_tap(0, {.velocity = {1, 0}}).ok());
  EXPECT_FALSE(f.set_drain(-1, {}).ok());
  EXPECT_TRUE(f.step(0.01f).ok());
  f.add_box({0, 0}, {0.2, 0.2}).value();
  EXPECT_EQ(f.size(), 16);
}

// A tap gives its cross-section times its speed, whatever the step; a drain takes what comes into it.
TEST(FluidTaps, TapsGiveWhatTheyPromiseAndDrainsEmpty) {
  for (const float dt : {1.0f / 60, 1.0f / 97}) {
    Fluid2 f = Fluid2::create({.upper = {2, 1}, .spacing = 0.02f}).value();
    const int tap = f.add_tap({.center = {0.5, 0.9}, .velocity = {0, -1.5f}, .radius = 0.1f}).value();
    const int steps = int(2 / double(dt));
    for (int i = 0; i < steps; ++i) f.step(dt).value();
    // 11 particles abreast, every 2 cm.
    EXPECT_NEAR(f.size(), 11 * 1.5 * steps * double(dt) / 0.02, 11);
    EXPECT_NEAR(f.volume(), f.size() * 0.0004, 1e-6);
    f.set_tap(tap, {.center = {0.5, 0.9}, .velocity = {0, -1}, .open = false}).value();
    f.add_drain({.lower = {1.5, 0}, .upper = {2, 1}}).value();
    const int before = f.size();
    for (int i = 0; i < 240; ++i) f.step(dt).value();
    EXPECT_LT(f.size(), before / 2);
  }
}

#if defined(__GLIBC__) && __GLIBC_PREREQ(2, 33) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
// Warm steps keep no memory that they did not have: splash, tap and body included.
TEST(FluidMemory, WarmStepsTakeNone) {
  rigid::World2 world;
  rigid::BodyDef<Dim2> body;
  body.position = {0.6, 0.5};
  const auto box = world.create_body(body).value();
  world.add_shape(box, geometry::make_box2({0.1f, 0.1f}), {.density = 500}).value();
  Fluid2 f = splash<Dim2>(1);
  f.add_tap({.center = {0.5, 0.9}, .velocity = {1, 0}}).value();
  const auto step = [&] {
    f.step(world, 1.0f / 60).value();
    world.step(1.0f / 60).value();
  };
  for (int i = 0; i < 60; ++i) step();
  const auto before = mallinfo2();
  for (int i = 0; i < 60; ++i) step();
  const auto after = mallinfo2();
  EXPECT_EQ(after.uordblks, before.uordblks);
  EXPECT_EQ(after.hblkhd, before.hblkhd);
}
#endif

}  // namespace fluid_rest_test
