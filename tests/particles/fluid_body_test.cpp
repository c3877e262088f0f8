// Liquid and bodies: buoyancy, added mass, momentum, walls of any shape.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/math/rotation.h"
#include "carom/particles/fluid.h"

namespace fluid_body_test {
using namespace carom;
using namespace carom::particles;
using namespace carom::rigid;

constexpr double gravity = 9.80665;
constexpr float dt = 1.0f / 60;

template <class D>
BodyId put(World<D>& world, const typename D::Shape& shape, typename D::Position at, float density,
           BodyType type = BodyType::dynamic) {
  BodyDef<D> body;
  body.type = type;
  body.position = at;
  ShapeDef<D> material;
  material.density = density;
  const BodyId id = world.create_body(body).value();
  world.add_shape(id, shape, material).value();
  return id;
}

/// Water to a height of 0.6 m with room left for a box that hangs `draft` into it, between x = 0.6 and 1.4.
Fluid2 harbour(double draft, float spacing) {
  Fluid2 f = Fluid2::create({.upper = {2, 1.2}, .spacing = spacing}).value();
  f.add_box({0, 0}, {2, 0.6 - draft}).value();
  f.add_box({0, 0.6 - draft}, {0.6, 0.6}).value();
  f.add_box({1.4, 0.6 - draft}, {2, 0.6}).value();
  return f;
}

// Archimedes: a box of relative density 0.6 floats at 60 % of its height, one of 0.3 at 30 %: to 1 % of the height at
// every moment of five seconds, and upright.
TEST(FluidBody, BoxFloatsAtItsDraft) {
  for (const float ratio : {0.3f, 0.6f, 0.85f}) {
    World2 world;
    const double draft = 0.4 * double(ratio);
    const BodyId box = put<Dim2>(world, geometry::make_box2({0.4f, 0.2f}), {1, 0.6 - draft + 0.2}, 1000 * ratio);
    Fluid2 f = harbour(draft, 0.02f);
    double mean = 0;
    for (int i = 0; i < 300; ++i) {
      f.step(world, dt).value();
      world.step(dt).value();
      const auto s = world.state(box).value();
      const double found = (0.6 - (s.pose.position.y - 0.2)) / 0.4;
      mean += found / 300;
      ASSERT_NEAR(found, double(ratio), 0.01) << ratio << " step " << i;
    }
    const auto s = world.state(box).value();
    EXPECT_NEAR(mean, double(ratio), 0.005);
    EXPECT_NEAR(math::angle_of(s.pose.rotation), 0, 0.05);
  }
}

// Hydrostatics of a square log (E. N. Gilbert, "How things float", Am. Math. Monthly 98 (1991) 201): upright it is
// unstable for relative densities from 0.211 to 0.789, and at one half it floats with a diagonal in the water line.
TEST(FluidBody, SquareLogTurnsOnItsCorner) {
  World2 world;
  const BodyId log = put<Dim2>(world, geometry::make_box2({0.2f, 0.2f}), {1, 0.6}, 500);
  Fluid2 f = Fluid2::create({.upper = {2, 1.2}, .spacing = 0.025f, .viscosity = 2e-3f}).value();
  f.add_box({0, 0}, {2, 0.4}).value();
  f.add_box({0, 0.4}, {0.8, 0.6}).value();
  f.add_box({1.2, 0.4}, {2, 0.6}).value();
  world.set_velocity(log, {}, 0.3f).value();
  double mean = 0;
  for (int i = 0; i < 480; ++i) {
    f.step(world, dt).value();
    world.step(dt).value();
    if (i >= 240) mean += math::angle_of(world.state(log)->pose.rotation) / 240;
  }
  const double quarter = 1.5707963;
  mean = std::abs(mean - quarter * std::floor(mean / quarter));
  EXPECT_NEAR(mean, 0.5 * quarter, 0.12);
}

// Dropped from above it comes to the same draft, as the mean over what is left of its dance. A narrow box thrown in on
// its side turns till it floats flat.
TEST(FluidBody, DroppedBoxComesToItsDraft) {
  World2 world;
  const BodyId box = put<Dim2>(world, geometry::make_box2({0.2f, 0.15f}), {1, 0.9}, 600);
  Fluid2 f = Fluid2::create({.upper = {2, 1.4}, .spacing = 0.025f, .viscosity = 2e-3f}).value();
  f.add_box({0, 0}, {2, 0.6}).value();
  double mean = 0;
  for (int i = 0; i < 480; ++i) {
    f.step(world, dt).value();
    world.step(dt).value();
    if (i < 240) continue;
    // The level follows from the volume: V = 2 H − 0.4 draft with H = bottom + draft.
    const double bottom = world.state(box)->pose.position.y - 0.15;
    mean += (f.volume() - 2 * bottom) / 1.6 / 0.3 / 240;
  }
  EXPECT_NEAR(mean, 0.6, 0.03);
}

TEST(FluidBody, HeavyBodiesSinkAndRest) {
  World3 world;
  put<Dim3>(world, geometry::Box{{2, 0.25f, 2}}, {0.4, -0.25, 0.4}, 1000, BodyType::fixed);
  const BodyId heavy = put<Dim3>(world, geometry::Box{{0.1f, 0.1f, 0.1f}}, {0.4, 0.42, 0.4}, 2000);
  Fluid3 f = Fluid3::create({.upper = {0.8, 0.7, 0.8}, .spacing = 0.04f}).value();
  f.add_box({0, 0, 0}, {0.8, 0.5, 0.8}).value();
  for (int i = 0; i < 120; ++i) {
    f.step(world, dt).value();
    world.step(dt).value();
  }
  EXPECT_NEAR(world.state(heavy)->pose.position.y, 0.1, 0.01);
  EXPECT_LT(length(world.state(heavy)->linear_velocity), 0.02f);
}

// A ball let go in deep water: a = (ρ_b − ρ) g/(ρ_b + ½ ρ), the ½ being the added mass of a sphere (Lamb, art. 92).
// A radius of five particles, walls four radii away: 3 % of g in equilibrium, 5 % for what is heavier, 12 % for what is
// lighter (which the water that it carries with it outweighs).
TEST(FluidBody, AddedMassOfABall) {
  for (const float ratio : {0.5f, 1.0f, 3.0f}) {
    World3 world;
    const BodyId ball = put<Dim3>(world, geometry::Sphere{0.2f}, {0.51, 0.45, 0.5}, 1000 * ratio, BodyType::kinematic);
    Fluid3 f = Fluid3::create({.upper = {1, 1, 1}, .spacing = 0.04f}).value();
    f.add_box({0, 0, 0}, {1, 0.92, 1}).value();
    for (int i = 0; i < 15; ++i) {
      f.step(world, dt).value();
      world.step(dt).value();
    }
    world.set_type(ball, BodyType::dynamic).value();
    const float fine = 1.0f / 240;
    double early = 0;
    for (int i = 0; i < 10; ++i) {
      f.step(world, fine).value();
      world.step(fine).value();
      if (i == 1) early = world.state(ball)->linear_velocity.y;
    }
    const double found = (world.state(ball)->linear_velocity.y - early) / (8 * double(fine));
    const double expected = (1 - double(ratio)) * gravity / (double(ratio) + 0.5);
    const double tolerance = ratio == 1 ? 0.03 * gravity : (ratio > 1 ? 0.05 : 0.12) * std::abs(expected);
    EXPECT_NEAR(found, expected, tolerance) << ratio;
  }
}

// In free space a jet of liquid strikes a box off its middle: together they keep their momentum to rounding, of light
// and heavy boxes. Angular momentum is kept to a per cent of what was there.
TEST(FluidBody, MomentumIsConserved) {
  for (const float density : {50.0f, 800.0f}) {
    World3 world({.gravity = {0, 0, 0}});
    const BodyId box = put<Dim3>(world, geometry::Box{{0.15f, 0.15f, 0.15f}}, {1.0, 0.5, 0.5}, density);
    FluidDef<Dim3> d{.upper = {3, 1, 1}, .spacing = 0.035f, .gravity = {0, 0, 0}};
    for (bool& wall : d.walls) wall = false;
    Fluid3 f = Fluid3::create(d).value();
    f.add_ball({0.55, 0.55, 0.5}, 0.2f, {3, 0, 0}).value();
    const int count = f.size();
    const auto before = f.momentum();
    const auto spin = f.angular_momentum();
    for (int i = 0; i < 30; ++i) {
      f.step(world, 1.0f / 120).value();
      world.step(1.0f / 120).value();
    }
    ASSERT_EQ(f.size(), count);
    EXPECT_GT(world.state(box)->linear_velocity.x, 0.5f);
    const auto after = f.momentum() + world.totals().momentum;
    EXPECT_NEAR(length(after - before) / length(before), 0, 1e-6);
    EXPECT_LT(length(f.angular_momentum() + world.totals().angular_momentum - spin), 0.02 * length(spin));
    const double energy = f.kinetic_energy() + world.totals().kinetic_energy;
    EXPECT_LT(energy, 0.5 * 9 * count * double(f.particle_mass()));
  }
}

// Walls of every shape hold water: nothing gets through, and it comes to rest.
TEST(FluidBody, WallsOfEveryShapeHoldWater) {
  World2 world;
  std::vector<math::Vec2f> bowl;
  for (int i = 0; i <= 20; ++i) {
    const float x = 0.8f - 0.08f * float(i);  // solid to the left
    bowl.push_back({x, 0.8f * x * x});
  }
  const auto chain = geometry::make_chain(bowl, false).value();
  put<Dim2>(world, chain, {1, 0.3}, 0, BodyType::fixed);
  put<Dim2>(world, geometry::Circle{0.1f}, {1, 0.45}, 0, BodyType::fixed);
  Fluid2 f = Fluid2::create({.upper = {2, 1.2}, .spacing = 0.02f}).value();
  f.add_box({0.7, 0.7}, {1.3, 0.9}).value();
  const int count = f.size();
  for (int i = 0; i < 240; ++i) f.step(world, dt).value();
  int below = 0;
  for (int p = 0; p < f.size(); ++p) {
    const auto x = f.position(p);
    if (math::abs(x.x - 1) < 0.78 && x.y < 0.3 + 0.8 * (x.x - 1) * (x.x - 1) - 0.03) ++below;
  }
  EXPECT_EQ(f.size(), count);
  EXPECT_EQ(below, 0);
  EXPECT_LT(f.kinetic_energy() / (f.volume() * 1000), 0.05);
}

// The bodies of another thread count, the same bits: liquid and world together.
TEST(FluidBody, SameBitsWithBodies) {
  const auto run = [](int threads) {
    World3 world({.threads = threads});
    put<Dim3>(world, geometry::Sphere{0.1f}, {0.5, 0.6, 0.5}, 500);
    put<Dim3>(world, geometry::Capsule3{0.1f, 0.08f}, {0.3, 0.7, 0.4}, 300);
    Fluid3 f = Fluid3::create({.spacing = 0.04f, .threads = threads}).value();
    f.add_box({0, 0, 0}, {1, 0.4, 1}).value();
    for (int i = 0; i < 30; ++i) {
      f.step(world, dt).value();
      world.step(dt).value();
    }
    return f.state_hash() ^ world.state_hash();
  };
  EXPECT_EQ(run(1), run(2));
}

}  // namespace fluid_body_test
