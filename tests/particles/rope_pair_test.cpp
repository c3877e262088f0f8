// Ropes that touch each other and themselves, and a leader's fall.
#include <gtest/gtest.h>

#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/rope.h"

namespace carom::particles {
namespace rope_pair_test {

using namespace math;
using rigid::BodyId;
using rigid::Dim3;
using rigid::World3;
constexpr double dt = 1.0 / 60, g = 9.80665;

World3 weightless() {
  rigid::WorldDef<Dim3> def;
  def.gravity = {};
  return World3(def);
}

RopeMaterial cord(double radius) {
  return {.mass_per_length = 0.05,
          .radius = radius,
          .axial_stiffness = 5e4,
          .axial_damping = 20,
          .bending_stiffness = 2e-4,
          .friction = 0.3,
          .drag_coefficient = 0,
          .skin_coefficient = 0};
}

/// The least distance of the centre lines of two ropes, or of parts of one that a fold apart.
double nearest(const RopeSet& ropes, int a, int b) {
  double least = 1e9;
  const auto p = ropes.positions(a), q = ropes.positions(b);
  for (std::size_t i = 0; i + 1 < p.size(); ++i)
    for (std::size_t j = a == b ? i + 6 : 0; j + 1 < q.size(); ++j)
      for (int s = 0; s <= 8; ++s)
        for (int t = 0; t <= 8; ++t)
          least = min(least, length(lerp(p[i], p[i + 1], s / 8.0) - lerp(q[j], q[j + 1], t / 8.0)));
  return least;
}

TEST(RopePairs, HookedLoopsCarryALoad) {
  // A loop hung from above, a loop with 20 kg in it from below: nothing but each other holds them.
  World3 world;
  RopeSet ropes;
  const double r = 0.01, load = 20;
  RopeMaterial strong = cord(r);
  strong.axial_stiffness = 2e5;
  strong.axial_damping = 1000;
  std::vector<Vec3d> upper, lower;
  for (int i = 0; i <= 16; ++i) {
    const double a = pi * i / 16;
    upper.push_back({-0.1 * cos(a), 0.4 - 0.4 * sin(a), 0});
    lower.push_back({0, -0.4 + 0.4 * sin(a) + 2.2 * r, -0.1 * cos(a)});
  }
  for (const auto* way : {&upper, &lower})
    ropes.add({.material = strong, .points = *way, .segments = 24, .collide = false, .touch_ropes = true}).value();
  rigid::BodyDef<Dim3> def;
  def.position = {0, -0.4, 0};
  const BodyId body = world.create_body(def).value();
  world.set_mass_properties(body, {load, {}, Mat3d::diagonal({.2, .2, .2})}).value();
  ropes.attach(0, {.node = 0, .point = upper.front()}, world).value();
  ropes.attach(0, {.node = -1, .point = upper.back()}, world).value();
  ropes.attach(1, {.node = 0, .body = body, .point = lower.front() - def.position}, world).value();
  ropes.attach(1, {.node = -1, .body = body, .point = lower.back() - def.position}, world).value();
  double least = 1;
  for (int i = 0; i < 300; ++i) {
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
    if (i > 30) least = min(least, nearest(ropes, 0, 1));
  }
  RecordProperty("least", std::to_string(least / r));
  EXPECT_GT(least, 1.7 * r);
  EXPECT_GT(ropes.rope_contact_count(), 0);
  EXPECT_LT(double(length(world.state(body)->linear_velocity)), 0.02);
  const double held = -(ropes.attachment_force(0, 0).y + ropes.attachment_force(0, -1).y);
  EXPECT_NEAR(held, (load + ropes.mass(0) + ropes.mass(1)) * g, 0.01 * load * g);
  EXPECT_NEAR(ropes.attachment_force(1, 0).y + ropes.attachment_force(1, -1).y, load * g, 0.01 * load * g);
}

TEST(RopePairs, OverhandKnotTightensAndHolds) {
  // The polynomial trefoil (t³ − 3t, t⁴ − 4t², t⁵/5 − 2t), drawn tight by a weight. A tight open trefoil takes up 10.1
  // diameters of rope (Pieranski, Przybył, Stasiak 2001, "Tight open knots"); one that comes undone takes up none.
  rigid::WorldDef<Dim3> def;
  def.gravity = {0, -3, 0};
  World3 world(def);
  RopeSet ropes;
  const double r = 0.01;
  std::vector<Vec3d> way{{0, 0.45, 0}};
  for (int i = 0; i <= 120; ++i) {
    const double t = -2.1 + 4.2 * i / 120, t2 = t * t;
    way.push_back(0.06 * Vec3d{t2 * t2 - 4 * t2, -(t * t2 - 3 * t), t * t2 * t2 / 5 - 2 * t});
  }
  way.push_back({0, -0.45, 0});
  RopeMaterial material = cord(r);
  material.axial_stiffness = 2e5;
  ropes.add({.material = material, .points = way, .segments = 110, .collide = false, .touch_ropes = true}).value();
  const double length_at_rest = ropes.rest_length(0);
  ropes.attach(0, {.node = 0, .point = way.front()}, world).value();
  ropes.add_mass(0, 110, 2).value();
  for (int i = 0; i < 600; ++i) ropes.step(world, dt).value();
  const auto p = ropes.positions(0);
  const double taken = (ropes.length(0) - length(p.back() - p.front())) / (2 * r);
  RecordProperty("taken_up_diameters", std::to_string(taken));
  RecordProperty("rest", std::to_string(length_at_rest));
  EXPECT_GT(taken, 8);
  EXPECT_LT(taken, 15);
  EXPECT_GT(nearest(ropes, 0, 0), 1.6 * r);
}

TEST(RopePairs, FlyingRopesKeepMomentumAndLoseEnergy) {
  World3 world = weightless();
  RopeSet ropes;
  const double r = 0.02;
  const Vec3d one[] = {{-0.5, 0, 0}, {0.5, 0, 0}}, other[] = {{0.05, 0.2, -0.5}, {0.05, 0.2, 0.5}};
  for (const auto* way : {&one, &other})
    ropes.add({.material = cord(r), .points = *way, .segments = 20, .collide = false, .touch_ropes = true}).value();
  for (int i = 0; i <= 20; ++i) ropes.set_velocity(1, i, {0, -6, 0}).value();
  const Vec3d before = ropes.momentum();
  double energy = ropes.kinetic_energy() + ropes.elastic_energy();
  const double first = energy;
  for (int i = 0; i < 8; ++i) {
    ropes.step(world, dt).value();
    energy = ropes.kinetic_energy() + ropes.elastic_energy();
    ASSERT_LT(energy, 1.01 * first) << i;
  }
  EXPECT_LT(length(ropes.momentum() - before), 1e-6 * length(before));
  EXPECT_LT(energy, 0.99 * first);
  double low = 1e9;  // the upper one has not passed: its middle is above the other's
  low = ropes.positions(1)[10].y - ropes.positions(0)[11].y;
  RecordProperty("low", std::to_string(low));
  EXPECT_GT(low, 1.5 * r);
  EXPECT_GT(ropes.velocities(0)[10].y, -1e3);
}

TEST(RopePairs, LiesAcrossAnotherWithFriction) {
  // A cord over a taut one, 1 kg against 1.2 kg: friction of a half turn at μ = .3 holds up to e^.94 = 2.57, at μ = 0
  // it runs off.
  for (const double mu : {0.0, 0.3}) {
    World3 world;
    RopeSet ropes;
    RopeMaterial beam = cord(0.01), cross = cord(0.01);
    beam.axial_stiffness = 1e6;
    beam.friction = cross.friction = mu;
    const Vec3d taut[] = {{-0.5, 0, 0}, {0.5, 0, 0}};
    std::vector<Vec3d> over{{0, -0.6, -0.022}};
    for (int i = 0; i <= 8; ++i) over.push_back({0, 0.022 * sin(pi * i / 8), -0.022 * cos(pi * i / 8)});
    over.push_back({0, -0.6, 0.022});
    ropes.add({.material = beam, .points = taut, .segments = 20, .length = 0.99, .collide = false, .touch_ropes = true})
        .value();
    ropes.add({.material = cross, .points = over, .segments = 100, .collide = false, .touch_ropes = true}).value();
    ropes.attach(0, {.node = 0, .point = taut[0]}, world).value();
    ropes.attach(0, {.node = -1, .point = taut[1]}, world).value();
    ropes.add_mass(1, 0, 1).value();
    ropes.add_mass(1, 100, 1.2).value();
    for (int i = 0; i < 45; ++i) ropes.step(world, dt).value();
    const double fallen = ropes.positions(1)[0].y - ropes.positions(1)[100].y;
    RecordProperty(mu > 0 ? "held" : "ran", std::to_string(fallen));
    if (mu > 0)
      EXPECT_LT(abs(fallen), 0.05);
    else
      EXPECT_GT(fallen, 0.2);
    EXPECT_GT(nearest(ropes, 0, 1), 0.8 * 0.02);
  }
}

TEST(RopePairs, CopiesStepAlike) {
  World3 world = weightless();
  RopeSet ropes;
  const Vec3d one[] = {{-0.5, 0, 0}, {0.5, 0, 0}}, other[] = {{0.05, 0.05, -0.5}, {0.05, 0.05, 0.5}};
  for (const auto* way : {&one, &other})
    ropes.add({.material = cord(0.02), .points = *way, .segments = 20, .touch_ropes = true}).value();
  for (int i = 0; i <= 20; ++i) ropes.set_velocity(1, i, {0, -3, 0}).value();
  for (int i = 0; i < 10; ++i) ropes.step(world, dt).value();
  RopeSet copy = ropes;
  for (int i = 0; i < 30; ++i) {
    ropes.step(world, dt).value();
    copy.step(world, dt).value();
  }
  EXPECT_EQ(ropes.state_hash(), copy.state_hash());
}

// A leader falls past the last anchor into a rope of length L: without damping the greatest force is
// F = m g + √((m g)² + 2 m g EA f), f the height of the fall over L (Wexler, Am. Alpine Journal 7 (1950) 379).
TEST(LeadFall, PeakIsThatOfTheFallFactor) {
  const double mass = 80, stiffness = 9.8e3, rope_length = 3;
  for (const double factor : {0.4, 1.0, 1.5, 1.8}) {
    World3 world;
    RopeSet ropes;
    const double above = factor * rope_length - rope_length;
    const Vec3d start{0, above, 0}, aside{0.5 * sqrt(rope_length * rope_length - above * above), 0.5 * above, 0};
    rigid::BodyDef<Dim3> def;
    def.position = start;
    const BodyId climber = world.create_body(def).value();
    world.set_mass_properties(climber, {mass, {}, Mat3d::diagonal({5, 5, 5})}).value();
    const Vec3d way[] = {{0, 0, 0}, aside, start};
    RopeMaterial rope{.mass_per_length = 0.064,
                      .radius = 0.005,
                      .axial_stiffness = stiffness,
                      .bending_stiffness = 0.002,
                      .drag_coefficient = 0,
                      .skin_coefficient = 0};
    ropes.add({.material = rope, .points = way, .segments = 24, .length = rope_length, .collide = false}).value();
    ropes.attach(0, {.node = 0}, world).value();
    ropes.attach(0, {.node = -1, .body = climber}, world).value();
    double peak = 0, anchor = 0;
    for (int i = 0; i < 180; ++i) {
      ropes.step(world, dt).value();
      world.step(float(dt)).value();
      peak = max(peak, ropes.peak_tension(0));
      anchor = max(anchor, length(ropes.attachment_force(0, 0)));
    }
    const double weight = mass * g, expected = weight + sqrt(weight * weight + 2 * weight * stiffness * factor);
    RecordProperty("peak_over_expected_" + std::to_string(int(10 * factor)), std::to_string(peak / expected));
    RecordProperty("anchor_over_expected_" + std::to_string(int(10 * factor)), std::to_string(anchor / expected));
    EXPECT_NEAR(peak, expected, 0.05 * expected) << factor;
    EXPECT_NEAR(anchor, expected, 0.05 * expected) << factor;
  }
}

TEST(LeadFall, RopeThatIsLongerThanItsWayLiesInFolds) {
  // Laid a quarter shorter than it is: as a strut it would hold ½ EA ε² L = 920 J and fly apart.
  World3 world = weightless();
  const Vec3d way[] = {{0, 0, 0}, {0.4, 0, 0}, {0.4, 1.5, 0}, {0, 1.5, 0}};
  for (const int segments : {24, 25}) {
    RopeSet ropes;
    ropes
        .add({.material =
                  {.mass_per_length = 0.064, .radius = 0.005, .axial_stiffness = 9.8e3, .bending_stiffness = 0.002},
              .points = way,
              .segments = segments,
              .length = 3})
        .value();
    EXPECT_NEAR(ropes.length(0), 3, 0.06);
    EXPECT_LT(ropes.elastic_energy(), 25);
    for (int i = 0; i < 60; ++i) {
      ropes.step(world, dt).value();
      EXPECT_LT(ropes.peak_tension(0), 1000);
    }
  }
}

}  // namespace rope_pair_test
}  // namespace carom::particles
