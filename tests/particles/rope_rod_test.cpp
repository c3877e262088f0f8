// Bending, twist, breaking, energy and bad input of ropes.
#include <gtest/gtest.h>

#include <limits>

#include "carom/math/elementary.h"
#include "carom/particles/rope.h"
#include "tests/particles/weightless.h"

namespace carom::particles {
namespace rope_rod_test {

using namespace math;
using rigid::World3;
constexpr double dt = 1.0 / 60, g = 9.80665;

TEST(RopeRod, CantileverBendsAsABeam) {
  // Euler–Bernoulli: w = F L³/3EI. The force is the weight of a lump at the tip; the first segment is clamped, so that
  // the beam begins in its middle.
  World3 world;
  RopeSet ropes;
  const int n = 20;
  const double length = 1, stiffness = 1, load = 0.005;
  const Vec3d points[] = {{0, 0, 0}, {length, 0, 0}};
  RopeMaterial m{.mass_per_length = 0.05, .axial_stiffness = 1e5, .bending_stiffness = stiffness};
  ASSERT_TRUE(ropes.add({.material = m, .points = points, .segments = n}).ok());
  ropes.attach(0, {.node = 0, .clamped = true}, world).value();
  ropes.add_mass(0, -1, load).value();
  ropes.set_air({.density = 2000});  // comes to rest in thick air
  for (int i = 0; i < 240; ++i) ropes.step(world, dt).value();
  const double free = length - 0.5 * length / n, weight = 0.05 * g;
  const double expected =
      load * g * free * free * free / (3 * stiffness) + weight * square(square(free)) / (8 * stiffness);
  const double found = -ropes.positions(0).back().y;
  RecordProperty("deflection", std::to_string(found));
  RecordProperty("beam", std::to_string(expected));
  EXPECT_NEAR(found, expected, 0.02 * expected);
}

TEST(RopeRod, LargeDeflectionIsTheElastica) {
  // Bisshopp and Drucker (1945), end load P L²/EI = 2: vertical deflection .4935 L, horizontal .1606 L
  // (their table, also Timoshenko and Gere).
  World3 world;
  RopeSet ropes;
  const int n = 16;
  const double half = 0.5 / (n - 0.5), stiffness = 5;  // the clamped half segment is beside the beam of 1 m
  const Vec3d points[] = {{-half, 0, 0}, {1, 0, 0}};
  RopeMaterial m{.mass_per_length = 0.05, .axial_stiffness = 1e6, .bending_stiffness = stiffness};
  ASSERT_TRUE(ropes.add({.material = m, .points = points, .segments = n}).ok());
  ropes.attach(0, {.node = 0, .point = points[0], .clamped = true}, world).value();
  // The weight of the rod itself, 5 % of the load, bends as 3/8 of it at the tip would.
  ropes.add_mass(0, -1, 2 * stiffness / g - 0.375 * 0.05 - 0.5 * 0.05 / n).value();
  ropes.set_air({.density = 2000});
  for (int i = 0; i < 2000; ++i) ropes.step(world, 1.0 / 240).value();
  const Vec3d tip = ropes.positions(0).back();
  RecordProperty("vertical", std::to_string(-tip.y));
  RecordProperty("horizontal", std::to_string(1 - tip.x));
  EXPECT_NEAR(-tip.y, 0.4935, 0.02 * 0.4935);
  EXPECT_NEAR(1 - tip.x, 0.1606, 0.04 * 0.1606);
}

TEST(RopeRod, TwistedRodWrithesAtGreenhillsMoment) {
  // Greenhill (1883): a clamped rod under no end load leaves the straight line at M = 8.987 EI/L (clamped ends that may
  // approach); here M = GJ Θ/L, so that Θ_critical = 8.987 EI/GJ. A rod a tenth below stays straight, one above
  // writhes.
  const auto width = [](double share) {
    World3 world = weightless();
    RopeSet ropes;
    const double stiffness = 1e-3, length = 1, critical = 8.987 * stiffness / 1e-3;
    std::vector<Vec3d> points;
    for (int i = 0; i <= 40; ++i)
      points.push_back({length * i / 40, 1e-4 * sin(pi * i / 40), 1e-4 * sin(2 * pi * i / 40)});
    RopeMaterial m{.mass_per_length = 0.05,
                   .axial_stiffness = 1e4,
                   .bending_stiffness = stiffness,
                   .bending_damping = 0.002,
                   .torsional_stiffness = 1e-3};
    EXPECT_TRUE(ropes.add({.material = m, .points = points, .segments = 40}).ok());
    ropes.attach(0, {.node = 0, .clamped = true}, world).value();
    // The far end may slide along: a heavy body on a slider.
    rigid::BodyDef<rigid::Dim3> def;
    def.position = {length, 0, 0};
    const auto end = world.create_body(def).value();
    world.set_mass_properties(end, {0.1, {}, Mat3d::diagonal({1e-3, 1e-3, 1e-3})}).value();
    rigid::SliderJointDef<rigid::Dim3> slider;
    slider.body_b = end;
    slider.frame_a.p = {float(length), 0, 0};
    world.create_joint(slider).value();
    ropes.attach(0, {.node = -1, .body = end, .clamped = true}, world).value();
    ropes.set_air({.density = 0});
    double widest = 0;
    for (int i = 0; i < 420; ++i) {
      ropes.set_twist(0, share * critical * min(1.0, i / 120.0)).value();
      ropes.step(world, dt).value();
      world.step(float(dt)).value();
    }
    for (const Vec3d& p : ropes.positions(0)) widest = max(widest, sqrt(p.y * p.y + p.z * p.z));
    return widest;
  };
  const double below = width(0.9), above = width(1.15);
  RecordProperty("below", std::to_string(below));
  RecordProperty("above", std::to_string(above));
  EXPECT_LT(below, 0.002);
  EXPECT_GT(above, 0.03);
}

TEST(RopeRod, PendulumKeepsItsEnergy) {
  World3 world;
  RopeSet ropes;
  ropes.set_air({.density = 0});
  const Vec3d points[] = {{0, 0, 0}, {1, 0, 0}};
  ASSERT_TRUE(
      ropes.add({.material = {.mass_per_length = 0.01, .axial_stiffness = 1e6}, .points = points, .segments = 1}).ok());
  ropes.add_mass(0, 1, 1).value();
  ropes.attach(0, {.node = 0}, world).value();
  double highest = -2;
  for (int i = 0; i < 3600; ++i) {
    ropes.step(world, dt).value();
    if (i > 3300) highest = max(highest, ropes.positions(0)[1].y);
  }
  RecordProperty("share_after_60_s", std::to_string(1 + highest));
  EXPECT_GT(1 + highest, 0.95);  // rigid-body.md 6.1 #10: above 95 % after 60 s of 90° swings
  EXPECT_LT(1 + highest, 1.001);
}

TEST(RopeRod, SwingingRopeNeverGainsEnergy) {
  World3 world;
  RopeSet ropes;
  ropes.set_air({.density = 0});
  const Vec3d points[] = {{0, 0, 0}, {2, 0.3, 0.4}};
  ASSERT_TRUE(ropes.add({.material = {.bending_stiffness = 1e-3}, .points = points, .segments = 30}).ok());
  ropes.attach(0, {.node = 0}, world).value();
  const auto energy = [&] {
    return ropes.kinetic_energy() + ropes.elastic_energy() + ropes.potential_energy({0, -g, 0});
  };
  const double start = energy(), scale = ropes.mass(0) * g * 2;
  double most = start;
  for (int i = 0; i < 600; ++i) {
    ropes.step(world, dt).value();
    most = max(most, energy());
  }
  EXPECT_LT(most, start + 0.01 * scale);
}

TEST(RopeRod, BreaksAboveItsStrengthAndKeepsItsMass) {
  World3 world;
  RopeSet ropes;
  const Vec3d points[] = {{0, 0, 0}, {0, -1, 0}};
  ASSERT_TRUE(
      ropes.add({.material = {.axial_damping = 1e4, .break_tension = 500}, .points = points, .segments = 10}).ok());
  ropes.attach(0, {.node = 0}, world).value();
  const double mass = ropes.mass(0);
  ropes.add_mass(0, -1, 20).value();
  for (int i = 0; i < 120; ++i) {
    ropes.step(world, dt).value();
    ASSERT_TRUE(ropes.breaks().empty());
  }
  ropes.add_mass(0, -1, 40).value();
  std::size_t breaks = 0;
  for (int i = 0; i < 60; ++i) {
    ropes.step(world, dt).value();
    for (const RopeBreakEvent& event : ropes.breaks()) {
      ++breaks;
      EXPECT_GT(event.tension, 500);
    }
  }
  EXPECT_GE(breaks, 1u);
  EXPECT_LT(ropes.positions(0).back().y, -2);
  EXPECT_DOUBLE_EQ(ropes.mass(0), mass + 60);
}

TEST(RopeRod, MirroredAndCopiedRunsAgree) {
  // A copy goes on with the same bits; a world mirrored in x gives the mirrored rope to the bit.
  World3 world;
  RopeSet a, b;
  const Vec3d points[] = {{0, 0, 0}, {1, 0.5, 0.2}}, mirrored[] = {{0, 0, 0}, {-1, 0.5, 0.2}};
  ASSERT_TRUE(a.add({.material = {.bending_stiffness = 1e-3}, .points = points}).ok());
  ASSERT_TRUE(b.add({.material = {.bending_stiffness = 1e-3}, .points = mirrored}).ok());
  a.attach(0, {.node = 0}, world).value();
  b.attach(0, {.node = 0}, world).value();
  for (int i = 0; i < 60; ++i) {
    a.step(world, dt).value();
    b.step(world, dt).value();
  }
  for (std::size_t i = 0; i < a.positions(0).size(); ++i) {
    EXPECT_EQ(a.positions(0)[i].x, -b.positions(0)[i].x);
    EXPECT_EQ(a.positions(0)[i].y, b.positions(0)[i].y);
  }
  RopeSet copy = a;
  for (int i = 0; i < 30; ++i) {
    a.step(world, dt).value();
    copy.step(world, dt).value();
  }
  EXPECT_EQ(a.state_hash(), copy.state_hash());
}

TEST(RopeRod, RefusesBadInput) {
  World3 world;
  RopeSet ropes;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vec3d points[] = {{0, 0, 0}, {1, 0, 0}}, bad[] = {{0, 0, 0}, {nan, 0, 0}}, same[] = {{1, 0, 0}, {1, 0, 0}};
  const auto message = [](const auto& result) { return result.ok() ? std::string() : result.error().message; };
  EXPECT_NE(message(ropes.add({.material = {.mass_per_length = 0}, .points = points})).find("mass_per_length"),
            std::string::npos);
  EXPECT_NE(message(ropes.add({.material = {.bending_stiffness = -1}, .points = points})).find("bending_stiffness"),
            std::string::npos);
  EXPECT_NE(message(ropes.add({.points = bad})).find("points[1]"), std::string::npos);
  EXPECT_FALSE(ropes.add({.points = same}).ok());
  EXPECT_FALSE(ropes.add({}).ok());
  EXPECT_FALSE(ropes.add({.points = points, .segments = 0}).ok());
  EXPECT_FALSE(ropes.add({.points = points, .length = nan}).ok());
  ASSERT_TRUE(ropes.add({.points = points}).ok());
  EXPECT_FALSE(ropes.attach(1, {}, world).ok());
  EXPECT_FALSE(ropes.attach(0, {.node = 99}, world).ok());
  EXPECT_FALSE(ropes.attach(0, {.node = 5, .clamped = true}, world).ok());
  EXPECT_FALSE(ropes.attach(0, {.node = 0, .point = {nan, 0, 0}}, world).ok());
  rigid::World3 other;
  const auto foreign = other.create_body({}).value();
  EXPECT_FALSE(ropes.attach(0, {.node = 0, .body = foreign}, world).ok());
  EXPECT_FALSE(ropes.add_mass(0, 0, nan).ok());
  EXPECT_FALSE(ropes.add_mass(0, 0, -1).ok());
  EXPECT_FALSE(ropes.set_winch(0, 2, 1).ok());
  EXPECT_FALSE(ropes.set_twist(0, nan).ok());
  EXPECT_FALSE(ropes.cut(0, 20).ok());
  EXPECT_FALSE(ropes.set_substeps(0).ok());
  EXPECT_FALSE(ropes.step(world, 0).ok());
  EXPECT_FALSE(ropes.step(world, nan).ok());
  ASSERT_TRUE(ropes.add({.material = {.mass_per_length = 1e-6, .bending_stiffness = 1e6}, .points = points}).ok());
  EXPECT_NE(message(ropes.step(world, dt)).find("bending_stiffness"), std::string::npos);
  EXPECT_TRUE(ropes.positions(7).empty());
}

}  // namespace rope_rod_test
// A stiff rope without any damping that flies free after a blow in its middle folds sharply; it must not gain energy.
TEST(RopeRod, AFreeRopeThatIsStruckGainsNoEnergy) {
  for (const double stiffness : {0.005, 0.05}) {
    rigid::World3 world;
    RopeSet ropes;
    const Vec3d points[] = {{0, 0, 0}, {2, 0, 0}};
    ropes
        .add({.material = {.mass_per_length = 0.275,
                           .radius = 0.01,
                           .axial_stiffness = 240e3,
                           .axial_damping = 100,
                           .bending_stiffness = stiffness},
              .points = points,
              .segments = 36})
        .value();
    ropes.set_velocity(0, 18, {0, 3, 0}).value();
    const double start = ropes.kinetic_energy() - 0.5 * length_squared(ropes.momentum()) / ropes.mass(0);
    for (int i = 0; i < 180; ++i) {
      ropes.step(world, 1.0 / 60).value();
      const double inner = ropes.kinetic_energy() - 0.5 * length_squared(ropes.momentum()) / ropes.mass(0);
      ASSERT_LT(inner, 1.05 * start) << stiffness << ", step " << i;
    }
    EXPECT_LT(ropes.peak_tension(0), 1000);
  }
}

}  // namespace carom::particles
