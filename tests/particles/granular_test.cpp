// Grains: exact cases of one grain, heaps against published simulations and experiments, conservation, bits.
#include "carom/particles/granular.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "carom/core/hash.h"

namespace granular_test {
using namespace carom;
using namespace carom::particles;
using namespace carom::rigid;

constexpr double gravity = 9.80665;
constexpr float dt = 1.0f / 60;

/// Speed after a second of a ball on a slope of `angle`.
double slide(double angle, float friction, float rolling) {
  Granular3 g = Granular3::create({.upper = {10, 1, 1},
                                   .radius = 0.05f,
                                   .radius_spread = 0,
                                   .rolling_friction = rolling,
                                   .wall_friction = friction,
                                   .gravity = {float(gravity * std::sin(angle)), float(-gravity * std::cos(angle)), 0}})
                    .value();
  g.add_grain({0.5, 0.05, 0.5}).value();
  for (int i = 0; i < 60; ++i) g.step(dt).value();
  return g.velocity(0).x;
}

// A solid ball rolls with 5/7 g (sin α − μ_r cos α), slides with g (sin α − μ cos α) where μ < 2/7 tan α, and stays
// where μ_r > tan α.
TEST(Granular, OneBallOnASlope) {
  const double a = 0.35, s = std::sin(a), c = std::cos(a);
  EXPECT_NEAR(slide(a, 0.6f, 0), 5.0 / 7 * gravity * s, 2e-3);
  EXPECT_NEAR(slide(a, 0.6f, 0.2f), 5.0 / 7 * gravity * (s - 0.2 * c), 3e-3);
  EXPECT_NEAR(slide(a, 0.1f, 0), gravity * (s - 0.1 * c), 2e-3);
  EXPECT_NEAR(slide(a, 0.6f, 0.4f), 0, 1e-4);
}

struct Collapse {
  double aspect = 0, run = 0, slope = 0, rise = 0, rest = 0;
};
Collapse collapse(float friction, float rolling, double height, std::uint64_t seed) {
  const double width = 0.4;
  Granular2 g = Granular2::create({.upper = {6, 2},
                                   .radius = 0.0125f,
                                   .friction = friction,
                                   .rolling_friction = rolling,
                                   .wall_friction = friction,
                                   .seed = seed})
                    .value();
  g.add_box({0, 0}, {width, height}).value();
  World2 world;
  BodyDef<Dim2> gate;
  gate.type = BodyType::fixed;
  gate.position = {width + 0.5, 1};
  const BodyId wall = world.create_body(gate).value();
  world.add_shape(wall, geometry::make_box2({0.5f, 1})).value();
  for (int i = 0; i < 60; ++i) g.step(world, dt).value();
  Collapse result;
  double top = 0;
  for (int i = 0; i < g.size(); ++i) top = std::max(top, g.position(i).y + double(g.radius(i)));
  result.aspect = top / width;
  world.destroy_body(wall).value();
  double energy = g.kinetic_energy() + g.potential_energy();
  const double first = energy;
  for (int i = 0; i < 110; ++i) {
    g.step(world, dt).value();
    const double next = g.kinetic_energy() + g.potential_energy();
    result.rise = std::max(result.rise, (next - energy) / first);
    energy = next;
  }
  result.rest = g.kinetic_energy() / first;
  std::vector<double> x;
  for (int i = 0; i < g.size(); ++i) x.push_back(g.position(i).x);
  std::sort(x.begin(), x.end());
  const double front = x[x.size() * 99 / 100];
  result.run = (front - width) / width;
  return result;
}

// L. Staron & E. J. Hinch, "Study of the collapse of granular columns using two-dimensional discrete-grain simulation",
// J. Fluid Mech. 545 (2005) 1–27: discs run ΔL/L = 2.5 H/L for H/L up to 2; here to 25 % with a rolling friction of
// 0.05 (without any, discs roll on along a level floor for ever). Grains that resist rolling run no further than sand
// does in a channel, 1.2 H/L (G. Lube, H. E. Huppert, R. S. J. Sparks, A. Freundt, "Collapses of two-dimensional
// granular columns", Phys. Rev. E 72 (2005) 041301): to 30 %.
// How far grains run and what still rolls at the end differ from heap to heap (the latter from 2 to 15 ten-thousandths
// of the energy for discs): means over four, and the greatest rise.
TEST(Granular, ColumnsRunAsFarAsPublished) {
  const auto mean = [](float friction, float rolling, double height) {
    Collapse all;
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
      const Collapse c = collapse(friction, rolling, height, seed);
      all.aspect += c.aspect / 4;
      all.run += c.run / 4;
      all.rest += c.rest / 4;
      all.rise = std::max(all.rise, c.rise);
    }
    return all;
  };
  const Collapse discs = mean(0.5f, 0.05f, 0.4), grains = mean(0.5f, 0.4f, 0.4);
  EXPECT_NEAR(discs.run, 2.5 * discs.aspect, 0.25 * 2.5 * discs.aspect);
  EXPECT_NEAR(grains.run, 1.2 * grains.aspect, 0.30 * 1.2 * grains.aspect);
  for (const Collapse& c : {discs, grains}) {
    EXPECT_LT(c.rise, 0.003);  // energy goes, but for what taking out overlaps lifts
    EXPECT_LT(c.rest, 1e-3);
  }
}

// A heap at rest: the floor carries its weight to a thousandth, and nothing moves.
TEST(Granular, WeightAndRest) {
  Granular2 g = Granular2::create({.upper = {0.5, 1}, .radius = 0.0125f}).value();
  g.add_box({0, 0}, {0.5, 0.4}).value();
  for (int i = 0; i < 200; ++i) g.step(dt).value();
  double down = 0;
  for (int i = 0; i < 10; ++i) {
    g.step(dt).value();
    down += g.wall_impulse().y / 10;
  }
  EXPECT_NEAR(-down * 60, g.mass() * gravity, 0.003 * g.mass() * gravity);
  EXPECT_LT(g.kinetic_energy(), 1e-3);
  EXPECT_LT(g.statistics().max_overlap, 0.05f * 0.0125f);
}

// A column falls with the fewest sweeps that can be asked for: energy only goes, but for what taking out overlaps
// lifts. (A single sweep in a substep, over-relaxed, would blow it up.)
TEST(Granular, FewestSweepsStayTame) {
  Granular2 g = Granular2::create({.radius = 0.008f, .iterations = 1}).value();
  g.add_box({0, 0}, {0.5, 1}).value();
  double energy = g.kinetic_energy() + g.potential_energy();
  const double first = energy;
  for (int i = 0; i < 60; ++i) {
    g.step(dt).value();
    const double next = g.kinetic_energy() + g.potential_energy();
    EXPECT_LT(next, energy + 0.003 * first) << i;
    energy = next;
  }
}

// In free space a swarm of grains strikes a box: momentum is kept to rounding, energy only goes.
TEST(Granular, MomentumIsConserved) {
  World3 world({.gravity = {0, 0, 0}});
  BodyDef<Dim3> body;
  body.position = {1, 0.5, 0.5};
  const BodyId box = world.create_body(body).value();
  world.add_shape(box, geometry::Box{{0.15f, 0.15f, 0.15f}}, {.density = 500}).value();
  GranularDef<Dim3> d{.upper = {3, 1, 1}, .radius = 0.03f, .gravity = {0, 0, 0}};
  for (bool& wall : d.walls) wall = false;
  Granular3 g = Granular3::create(d).value();
  g.add_box({0.45, 0.4, 0.35}, {0.81, 0.7, 0.65}, {2, 0, 0}).value();
  const int count = g.size();
  const auto before = g.momentum();
  const double energy = g.kinetic_energy();
  for (int i = 0; i < 20; ++i) {
    g.step(world, dt).value();
    world.step(dt).value();
  }
  ASSERT_EQ(g.size(), count);
  EXPECT_GT(world.state(box)->linear_velocity.x, 0.3f);
  EXPECT_NEAR(length(g.momentum() + world.totals().momentum - before) / length(before), 0, 2e-6);
  EXPECT_LT(g.kinetic_energy() + world.totals().kinetic_energy, energy);
}

// A box set down on sand stays on it.
TEST(Granular, SandCarriesABox) {
  World2 world;
  BodyDef<Dim2> body;
  body.position = {0.5, 0.36};
  const BodyId box = world.create_body(body).value();
  world.add_shape(box, geometry::make_box2({0.12f, 0.05f}), {.density = 1500}).value();
  Granular2 g = Granular2::create({.upper = {1, 1}, .radius = 0.015f}).value();
  g.add_box({0, 0}, {1, 0.3}).value();
  for (int i = 0; i < 180; ++i) {
    g.step(world, dt).value();
    world.step(dt).value();
  }
  const auto s = world.state(box).value();
  EXPECT_GT(s.pose.position.y, 0.25);
  EXPECT_LT(length(s.linear_velocity), 0.05f);
}

// Grains in a shaft too narrow for two abreast stay in their order, however fast they come: a heap struck by a column
// that falls together, two columns that meet, and a fast one that goes through slow ones.
TEST(Granular, NoGrainPassesAnother) {
  const auto passes = [](auto&& speed_of, float gravity) {
    GranularDef<Dim2> d{.upper = {0.12, 40}, .radius = 0.05f, .gravity = {0, -gravity}};
    Granular2 g = Granular2::create(d).value();
    double y = 0.05;
    for (std::uint32_t i = 0; i < 60; ++i) {
      g.add_grain({0.06 + 0.005 * (int(i % 3) - 1), y}, {0, speed_of(int(i))}, i).value();
      y += i < 20 ? 0.1 : 0.1 + 0.07 * double(i * i % 7);  // with gaps that three would fill
      if (i == 19) y += 3;
      if (i == 39) y += 3;
    }
    int passed = 0;
    std::vector<double> at(60);
    for (int k = 0; k < 40; ++k) {
      g.step(dt).value();
      EXPECT_EQ(g.size(), 60);
      for (int i = 0; i < g.size(); ++i) at[g.tag(i)] = g.position(i).y;
      for (int i = 1; i < 60; ++i) passed += at[i] < at[i - 1];
    }
    return passed;
  };
  for (const float speed : {3.0f, 10.0f, 30.0f, 50.0f}) {
    EXPECT_EQ(passes([&](int i) { return i < 20 ? 0 : -speed; }, 9.8f), 0) << speed;
    EXPECT_EQ(passes([&](int i) { return i < 20 ? 0 : i < 40 ? speed / 2 : -speed / 2; }, 0), 0) << speed;
    EXPECT_EQ(passes([&](int i) { return i < 59 ? -2.0f : -speed; }, 9.8f), 0) << speed;
  }
}

// A sphere at rest in a heap, in lanes of every width, on one thread and on two, and in a copy.
TEST(Granular, SameBitsForAnyWidthAnyThreadsAndInACopy) {
  const auto hash = [](int lanes, int threads) {
    Granular3 g = Granular3::create({.radius = 0.03f, .lanes = lanes, .threads = threads}).value();
    g.add_box({0.2, 0, 0.2}, {0.6, 0.8, 0.6}).value();
    // Wide enough for four slabs, and full across where they meet.
    Granular2 flat = Granular2::create({.upper = {4, 1}, .radius = 0.01f, .lanes = lanes, .threads = threads}).value();
    flat.add_box({0.3, 0}, {3.7, 0.2}, {1, 0}).value();
    World3 world({.simd_width = 4});
    BodyDef<Dim3> body;
    body.position = {0.4, 0.9, 0.4};
    world.add_shape(world.create_body(body).value(), geometry::Sphere{0.1f}, {.density = 500}).value();
    for (int i = 0; i < 30; ++i) {
      g.step(world, dt).value();
      world.step(dt).value();
      flat.step(dt).value();
    }
    Granular3 copy = g;
    for (int i = 0; i < 10; ++i) {
      g.step(dt).value();
      copy.step(dt).value();
    }
    EXPECT_EQ(g.state_hash(), copy.state_hash());
    core::StateHash all;
    return all.add(g.state_hash()).add(flat.state_hash()).add(world.state_hash()).digest();
  };
  const std::uint64_t first = hash(4, 1);
  for (const int lanes : {4, 8, 16})
    for (const int threads : {1, 2}) EXPECT_EQ(hash(lanes, threads), first) << lanes << " lanes, " << threads;
}

// A column of balls falls and comes to rest: what holds nothing any more lies beside what does, and squares of the
// frictions at walls vanish.
TEST(Granular, SameBitsForAnyWidthUntilAtRest) {
  const auto hash = [](int lanes) {
    Granular3 g = Granular3::create({.radius = 0.0427f, .lanes = lanes}).value();
    g.add_box({0, 0, 0}, {0.5, 1, 1}).value();
    for (int i = 0; i < 150; ++i) g.step(dt).value();
    return g.state_hash();
  };
  const std::uint64_t first = hash(4);
  for (const int lanes : {8, 16}) EXPECT_EQ(hash(lanes), first) << lanes;
}

TEST(Granular, BadInputIsRefused) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto refused = [](const GranularDef<Dim2>& d, const char* word) {
    const auto g = Granular2::create(d);
    ASSERT_FALSE(g.ok()) << word;
    EXPECT_NE(g.error().message.find(word), std::string::npos) << g.error().message;
  };
  refused({.radius = 0}, "radius");
  refused({.radius_spread = 0.9f}, "radius_spread");
  refused({.density = nan}, "density");
  refused({.friction = -1}, "friction");
  refused({.rolling_friction = nan}, "rolling_friction");
  refused({.gravity = {nan, 0}}, "gravity");
  refused({.lanes = 5}, "lanes");
  refused({.upper = {1e9, 1e9}}, "cells");
  refused({.upper = {-1, 1}}, "upper");
  Granular2 g = Granular2::create({.radius = 0.05f, .max_grains = 10}).value();
  EXPECT_FALSE(g.add_grain({nan, 0}).ok());
  EXPECT_FALSE(g.add_grain({0.5, 0.5}, {nan, 0}).ok());
  EXPECT_FALSE(g.add_grain({0.5, 0.5}, {}, 0, 1).ok());
  EXPECT_FALSE(g.add_box({0, 0}, {1, 1}).ok());
  EXPECT_EQ(g.size(), 0);
  EXPECT_FALSE(g.step(0).ok());
  EXPECT_FALSE(g.step(nan).ok());
}

}  // namespace granular_test
