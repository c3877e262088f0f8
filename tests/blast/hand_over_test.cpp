// What a striker loses to what it breaks (shared reference "ballistics", 6, hand-over to rigid bodies: the impulse is
// solved on the unbroken body first, the step is run again for what remains; momentum gate 1e-6).
#include <gtest/gtest.h>

#include "carom/blast/structure.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "carom/math/rotation.h"
#include "tests/blast/block.h"

namespace blast_hand_over_test {
using namespace carom;
using namespace carom::blast;
using math::Vec2d;
using math::Vec3d;
using rigid::Dim2;
using rigid::Dim3;
using test::block;

rigid::BodyId ball(rigid::World3& world, Vec3d position, math::Vec3f velocity, float radius, float density,
                   float restitution = 0) {
  rigid::BodyDef<Dim3> body;
  body.position = position;
  body.linear_velocity = velocity;
  body.bullet = true;
  const auto id = world.create_body(body).value();
  EXPECT_TRUE(world.add_shape(id, geometry::Sphere{radius},
                              {.density = density, .material = {.friction = 0, .restitution = restitution}}));
  return id;
}
void floor_of(rigid::World3& world) {
  rigid::BodyDef<Dim3> body;
  body.type = rigid::BodyType::fixed;
  ASSERT_TRUE(world.add_shape(world.create_body(body).value(), geometry::Plane{}));
}

// A brick of mass M held by one bond of area A and shear strength τ for the time t of a blow: a ball of mass m that
// comes with v and sticks takes it along with (m v − τ A t)/(m + M), the balance of momentum in closed form.
TEST(HandOver, MomentumBudgetOfABallAndABrick) {
  for (const float speed : {3.0f, 8.0f, 40.0f, 200.0f})
    for (const float dt : {1 / 60.f, 1 / 240.f}) {
      rigid::World3 world({.gravity = {0, 0, 0}});
      auto d = structure_of(block({0.25, 0.1, 0.1}, 1, 1), 1900);
      d.material = bond_material(Substance::brick_and_mortar);
      d.shape.material.friction = 0;
      StructureDef<Dim3>::Joint bed;
      bed.a = 0, bed.b = ground, bed.area = 0.05, bed.normal = {0, -1, 0};
      d.bonds.push_back(bed);
      auto structure = Structure3::make(world, d).value();
      const auto id = ball(world, {0, 0, 1.3}, {0, 0, -speed}, 0.08f, 7800);
      const double m = double(world.state(id)->mass), M = d.parts[0].mass.mass,
                   borne = d.material.shear_strength * bed.area * d.material.contact_time;
      FractureStepper3 stepper;
      for (int i = 0; i < int(0.6f / dt); ++i) ASSERT_TRUE(stepper.step(world, dt, structure));
      const double expected = m * double(speed) > borne ? (m * double(speed) - borne) / (m + M) : 0;
      EXPECT_EQ(structure.broken(), expected > 0 ? 1u : 0u);
      EXPECT_NEAR(-double(world.state(id)->linear_velocity.z), expected, 1e-4 * double(speed)) << speed << ' ' << dt;
    }
}
// The same in the plane.
TEST(HandOver, MomentumBudgetInThePlane) {
  rigid::World2 world({.gravity = {0, 0}});
  const std::vector<Vec2d> outline{{-0.1, -0.25}, {0.1, -0.25}, {0.1, 0.25}, {-0.1, 0.25}};
  auto d =
      structure_of(fracture_polygon(outline, voronoi_pattern2(std::vector<Vec2d>{{0, 0}}).value(), 0).value(), 1900);
  d.material = bond_material(Substance::concrete);
  d.shape.material.friction = 0;
  StructureDef<Dim2>::Joint bed;
  bed.a = 0, bed.b = ground, bed.area = 0.02, bed.normal = {0, -1};
  d.bonds.push_back(bed);
  auto structure = Structure2::make(world, d).value();
  rigid::BodyDef<Dim2> body;
  body.position = {-1, 0};
  body.linear_velocity = {30, 0};
  body.bullet = true;
  const auto id = world.create_body(body).value();
  ASSERT_TRUE(world.add_shape(id, geometry::Circle{0.1f}, {.density = 2000, .material = {.friction = 0}}));
  const double m = double(world.state(id)->mass), M = d.parts[0].mass.mass,
               borne = d.material.shear_strength * bed.area * d.material.contact_time;
  FractureStepper2 stepper;
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(stepper.step(world, 1 / 60.f, structure));
  EXPECT_NEAR(double(world.state(id)->linear_velocity.x), (m * 30 - borne) / (m + M), 1e-3);
}

// A free body that is shot at, step by step: what is taken from the striker and given to the pieces before a step is
// done again keeps momentum and angular momentum, and gives no energy. (The world's own step keeps momentum too; of a
// fast bullet it moves the point of contact, so that angular momentum is only kept as steps get short.)
TEST(HandOver, AFreeBodyKeepsMomentumAndGivesNoEnergy) {
  math::Random random(7);
  std::size_t broken = 0;
  int rounds = 0;
  for (int k = 0; k < 24; ++k) {
    rigid::World3 world({.gravity = {0, 0, 0}});
    auto d = structure_of(block({0.6, 0.4, 0.05}, 25, std::uint64_t(k + 1)), 2400);
    d.material = bond_material(Substance::ceramic);
    d.pose.rotation = math::from_axis_angle(math::Vec3f{0.6f, 0.8f, 0}, random.uniform(-0.8f, 0.8f));
    d.angular_velocity = random.uniform(0.0f, 2.0f) * math::Vec3f(random.in_sphere());
    auto structure = Structure3::make(world, d).value();
    ball(world, {random.uniform(-0.3, 0.3), random.uniform(-0.2, 0.2), 1.5}, {0, 0, -random.uniform(10.0f, 80.0f)},
         random.uniform(0.03f, 0.1f), 7800, random.uniform(0.0f, 0.5f));
    const auto first = world.totals();
    for (int i = 0; i < 30; ++i) {
      structure.start_step();
      for (int round = 0; round < 12; ++round) {
        const auto before = world.totals();
        const auto snapshot = world.snapshot();
        ASSERT_TRUE(world.step(1 / 60.f));
        if (!structure.find_breaks(world, 1 / 60.f).value()) break;
        ++rounds;
        ASSERT_TRUE(world.restore(snapshot));
        ASSERT_TRUE(structure.bear(world));
        ASSERT_TRUE(structure.part_bodies(world));
        const auto after = world.totals();
        EXPECT_NEAR(after.mass, before.mass, 1e-6 * before.mass);
        EXPECT_LT(length(after.momentum - before.momentum), 1e-6 * length(before.momentum)) << k;
        EXPECT_LT(length(after.angular_momentum - before.angular_momentum),
                  1e-6 * (length(before.momentum) + length(before.angular_momentum)))
            << k;
        EXPECT_LE(after.kinetic_energy, before.kinetic_energy * (1 + 1e-6)) << k;
      }
      ASSERT_TRUE(structure.part_bodies(world));
      EXPECT_LE(world.totals().kinetic_energy, first.kinetic_energy * (1 + 1e-6)) << k << ' ' << i;
    }
    const auto after = world.totals();
    EXPECT_NEAR(after.mass, first.mass, 1e-6 * first.mass);
    EXPECT_LT(length(after.momentum - first.momentum), 1e-6 * length(first.momentum)) << k;
    broken += structure.broken();
  }
  EXPECT_GT(broken, 200u);
  EXPECT_GT(rounds, 20);
}

StructureDef<Dim3> pane_in_a_frame() {
  const ConvexCell pane(geometry::Bounds3d{{-1, -0.75, -0.003}, {1, 0.75, 0.003}});
  const auto sites =
      radial_sites(pane, {.impact = {0.1, 0.2, 0}, .first_radius = 0.03, .growth = 1.55, .sectors = 11}, 7).value();
  auto d = structure_of(fracture_convex(voronoi_pattern(pane, sites).value(), {.skin = 5e-4, .meshes = false}).value(),
                        2500);
  d.material = bond_material(Substance::glass);
  d.pose.position = {0, 0.8, 0};
  anchor_below(d, -0.73);
  return d;
}
StructureDef<Dim3> brick_wall(double strength = 1) {
  const ConvexCell box(geometry::Bounds3d{{-1.5, 0, -0.1}, {1.5, 1.8, 0.1}});
  auto d = structure_of(
      fracture_convex(brick_pattern(box, {0.5, 0.2, 0.2}, {-1.5, 0, -0.1}).value(), {.meshes = false}).value(), 1900);
  d.material = bond_material(Substance::brick_and_mortar);
  d.material.tensile_strength *= strength;
  d.material.shear_strength *= strength;
  d.material.compressive_strength *= strength;
  anchor_below(d, 0.05);
  return d;
}

struct Shot {
  double mass, speed, place;  // of the ball at the end
  std::size_t broken, clusters;
  std::uint64_t hash;
};
Shot shoot(const StructureDef<Dim3>& d, float speed, float radius, float density, float dt, double seconds,
           int threads = 1) {
  rigid::World3 world({.threads = threads});
  floor_of(world);
  auto structure = Structure3::make(world, d).value();
  const auto id = ball(world, {0.1, 1.0, 1}, {0, 0, -speed}, radius, density);
  double energy = 1e300, weight = 0;
  for (const auto& part : d.parts) weight += 9.80665 * part.mass.mass;
  FractureStepper3 stepper;
  for (int i = 0; i < int(seconds / double(dt)); ++i) {
    const auto before = world.totals();
    const bool stood = structure.broken() == 0;
    EXPECT_TRUE(stepper.step(world, dt, structure));
    const auto after = world.totals();
    // Parts that come loose bring the energy of their height with them; otherwise it only falls.
    if (stood == (structure.broken() == 0))
      EXPECT_LE(after.kinetic_energy,
                before.kinetic_energy + (weight + 1200) * double(dt) * math::sqrt(2 * 9.80665 * 2) + 1e-6);
    EXPECT_LE(after.kinetic_energy, energy + weight * 1.8) << i;
    energy = math::min(energy, after.kinetic_energy);
  }
  const auto state = world.state(id);
  return {double(state->mass), -double(state->linear_velocity.z), state->pose.position.z,
          structure.broken(),  structure.cluster_count(),         world.state_hash()};
}

// A steel ball of 4 kg, 20 m/s, through 6 mm of glass: what it loses are shards of some hundred grams.
TEST(HandOver, ABallGoesThroughAPaneWithMostOfItsSpeed) {
  for (const float dt : {1 / 60.f, 1 / 120.f, 1 / 240.f}) {
    const Shot shot = shoot(pane_in_a_frame(), 20, 0.05f, 7800, dt, 0.4);
    EXPECT_GT(shot.speed, 0.8 * 20) << dt;
    EXPECT_LT(shot.speed, 20);
    EXPECT_LT(shot.place, -1.0) << "through";
    EXPECT_GT(shot.broken, 5u);
  }
}
// What a wall can take from it: what its bonds bear in the time of a blow, and the bricks that it takes along.
TEST(HandOver, ABallGoesThroughABrickWall) {
  const auto wall = brick_wall();
  double area = 0, bricks = 0;
  for (const auto& bond : wall.bonds) area += bond.area;
  for (const auto& part : wall.parts) bricks += part.mass.mass;
  const Shot shot = shoot(wall, 40, 0.15f, 7800, 1 / 60.f, 0.5);
  EXPECT_GT(shot.broken, 20u);
  EXPECT_LT(shot.place, -1.0);
  const double most = area * wall.material.shear_strength * wall.material.contact_time;
  EXPECT_GT(shot.mass * 40, shot.mass * shot.speed) << "it loses some";
  EXPECT_LT(shot.mass * (40 - shot.speed), most + bricks * shot.speed + 0.2 * shot.mass * 40);
  EXPECT_EQ(shot.hash, shoot(wall, 40, 0.15f, 7800, 1 / 60.f, 0.5, 3).hash) << "on three threads";
}
TEST(HandOver, AStrongWallStopsAHeavyBall) {
  const Shot shot = shoot(brick_wall(1e4), 3, 0.25f, 7800, 1 / 60.f, 1.5);
  EXPECT_EQ(shot.broken, 0u);
  EXPECT_LT(math::abs(shot.speed), 0.2);
  EXPECT_GT(shot.place, 0.3) << "in front of it";
  // A blow that breaks a few bonds, and no more than that: what is left holds.
  const Shot slow = shoot(brick_wall(), 0.5f, 0.1f, 7800, 1 / 60.f, 1.0);
  EXPECT_EQ(slow.broken, 0u);
  EXPECT_GT(slow.place, 0.1);
}

// Without a break the stepper is the step.
TEST(HandOver, NothingBreaksNothingChanges) {
  std::uint64_t hash[2];
  for (const bool plain : {true, false}) {
    rigid::World3 world;
    floor_of(world);
    auto structure = Structure3::make(world, brick_wall(1e6)).value();
    ball(world, {0, 1, 1}, {0, 0, -9}, 0.2f, 3000);
    FractureStepper3 stepper;
    for (int i = 0; i < 60; ++i) {
      if (plain) {
        ASSERT_TRUE(world.step(1 / 60.f));
        ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
      } else {
        ASSERT_TRUE(stepper.step(world, 1 / 60.f, structure));
        EXPECT_EQ(stepper.rounds(), 1);
      }
    }
    hash[plain] = world.state_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

// Two bodies that break each other, and a copy that goes on from a snapshot with the same bits.
TEST(HandOver, TwoStructuresMeet) {
  rigid::World3 world({.gravity = {0, 0, 0}});
  std::vector<Structure3> both;
  for (int i = 0; i < 2; ++i) {
    auto d = structure_of(block({0.2, 0.2, 0.2}, 20, std::uint64_t(i + 1)), 2300);
    d.material = bond_material(Substance::ice);
    d.pose.position = {0.05 * i, 0.1 * i, i * 0.8};
    d.linear_velocity = {0, 0, 12.0f * (1 - 2 * i)};
    both.push_back(Structure3::make(world, d).value());
  }
  const auto before = world.totals();
  const auto run = [&](std::vector<Structure3> structures) {
    Structure3* const list[] = {&structures[0], &structures[1]};
    FractureStepper3 stepper;
    for (int i = 0; i < 20; ++i) {
      EXPECT_TRUE(stepper.step(world, 1 / 120.f, list));
      EXPECT_LE(world.totals().kinetic_energy, before.kinetic_energy * (1 + 1e-6));
    }
    EXPECT_GT(structures[0].broken(), 5u);
    EXPECT_GT(structures[1].broken(), 5u);
    return world.state_hash();
  };
  const auto snapshot = world.snapshot();
  const std::uint64_t hash = run(both);
  const auto after = world.totals();
  EXPECT_LT(length(after.momentum - before.momentum), 1e-6 * before.mass * 12);
  ASSERT_TRUE(world.restore(snapshot));
  EXPECT_EQ(run(both), hash);
}

TEST(HandOver, BadStepsAreRefused) {
  rigid::World3 world;
  auto structure = Structure3::make(world, brick_wall()).value();
  FractureStepper3 stepper;
  EXPECT_FALSE(stepper.step(world, 0, structure));
  EXPECT_FALSE(stepper.step(world, -1, structure));
}

}  // namespace blast_hand_over_test
