// Parts held by bonds (shared reference "ballistics", 2.14 and 6: hand-over to rigid bodies).
#include "carom/blast/structure.h"

#include <gtest/gtest.h>

#include "carom/geometry/mesh_builders.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "carom/math/rotation.h"
#include "tests/blast/block.h"

namespace blast_test {
using namespace carom;
using namespace carom::blast;
using math::Vec2d;
using math::Vec3d;
using rigid::Dim2;
using rigid::Dim3;
using test::block;

template <class D>
void floor_of(rigid::World<D>& world) {
  rigid::BodyDef<D> body;
  body.type = rigid::BodyType::fixed;
  const auto id = world.create_body(body).value();
  if constexpr (D::dimension == 3)
    ASSERT_TRUE(world.add_shape(id, geometry::Plane{}));
  else
    ASSERT_TRUE(world.add_shape(id, geometry::make_box2({100, 1}, 0, {{0, -1}, {}})));
}

TEST(Structure, SplittingKeepsMassMomentumAndAngularMomentum) {
  rigid::World3 world({.gravity = {0, 0, 0}});
  auto d = structure_of(block({1, 0.5, 0.7}, 60, 4), 2400);
  d.pose = {{1000, 20, -7}, math::from_axis_angle(math::Vec3f{0.6f, 0.8f, 0}, 0.7f)};
  d.linear_velocity = {3, -2, 5};
  d.angular_velocity = {1, 4, -2};
  auto structure = Structure3::make(world, d).value();
  const auto about = [&](const rigid::Totals<Dim3>& t) {  // the centre of mass: far from the origin L is all orbit
    return t.angular_momentum - cross(t.center_of_mass, t.momentum);
  };
  const rigid::Totals<Dim3> before = world.totals();
  EXPECT_EQ(structure.cluster_count(), 1u);
  EXPECT_NEAR(before.mass, 2400 * 8 * 1 * 0.5 * 0.7, 1e-6 * before.mass);
  for (std::uint32_t i = 0; i < d.bonds.size(); ++i) structure.break_bond(i);
  ASSERT_TRUE(structure.after_step(world, 0.01f));
  EXPECT_EQ(structure.cluster_count(), 60u);
  const rigid::Totals<Dim3> after = world.totals();
  EXPECT_NEAR(after.mass, before.mass, 1e-6 * before.mass);
  EXPECT_LT(length(after.momentum - before.momentum), 1e-6 * length(before.momentum));
  EXPECT_LT(length(after.center_of_mass - before.center_of_mass), 1e-6);
  EXPECT_LT(length(about(after) - about(before)), 1e-6 * length(about(before)));
  EXPECT_NEAR(after.kinetic_energy, before.kinetic_energy, 1e-6 * before.kinetic_energy) << "no work by letting go";
  EXPECT_EQ(world.worst_penetration(), 0);
}

TEST(Structure, PiecesStartApart) {
  rigid::World3 world({.gravity = {0, 0, 0}});
  auto d = structure_of(block({1, 1, 1}, 100, 8), 1000);
  auto structure = Structure3::make(world, d).value();
  for (std::uint32_t i = 0; i < d.bonds.size(); ++i) structure.break_bond(i);
  ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
  const double before = world.totals().kinetic_energy;
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(world.step(1 / 60.f));
  EXPECT_EQ(before, 0);
  EXPECT_LT(world.totals().kinetic_energy, 1e-9) << "nothing pushes them";
}

/// A cantilever of the plane along x from 0 to `length`, cut across into parts of equal length.
StructureDef<Dim2> cantilever(double length, double height, int count) {
  std::vector<Vec2d> sites;
  for (int i = 0; i < count; ++i) sites.push_back({(i + 0.5) * length / count, height / 2});
  const std::vector<Vec2d> outline{{0, 0}, {length, 0}, {length, height}, {0, height}};
  auto d = structure_of(fracture_polygon(outline, voronoi_pattern2(sites).value(), 0).value(), 1000);
  StructureDef<Dim2>::Joint root;
  root.a = 0, root.b = ground, root.area = height, root.center = {0, height / 2}, root.normal = {-1, 0};
  d.bonds.push_back(root);
  return d;
}

// Bending stress of a cantilever of rectangular section (Gere & Timoshenko, Mechanics of Materials): σ = 6 F L/(b h²).
TEST(Structure, StressOfACantilever) {
  const double length = 2, height = 0.2, force = 1000;
  auto d = cantilever(length, height, 12);
  d.iterations = 1000;
  d.material.tensile_strength = d.material.compressive_strength = d.material.shear_strength = 1e9;
  rigid::World2 world({.gravity = {0, 0}});
  auto structure = Structure2::make(world, d).value();
  structure.add_load(11, {0, float(-force * 0.01)}, {length, height / 2}, 0.01);
  ASSERT_TRUE(world.step(1 / 60.f));
  ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
  EXPECT_EQ(structure.broken(), 0u);
  EXPECT_NEAR(structure.loads().back() * 1e9, 6 * force * length / (height * height), 1e-3 * 3e5);
  // At the fifth joint from the root, five twelfths of the way.
  for (std::size_t i = 0; i < d.bonds.size(); ++i)
    if (math::abs(d.bonds[i].center.x - length * 5 / 12) < 1e-9)
      EXPECT_NEAR(structure.loads()[i] * 1e9, 6 * force * length * 7 / 12 / (height * height), 1e-3 * 3e5);
}

// Its own weight: σ = 3 ρ g L²/h at the root.
TEST(Structure, ACantileverBreaksUnderItsOwnWeight) {
  const double length = 2, height = 0.2, stress = 3 * 1000 * 9.80665 * length * length / height;
  for (const double strength : {1.02 * stress, 0.98 * stress}) {
    auto d = cantilever(length, height, 10);
    d.iterations = 1000;
    d.material.tensile_strength = strength;
    d.material.compressive_strength = d.material.shear_strength = 1e9;
    rigid::World2 world;
    auto structure = Structure2::make(world, d).value();
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(world.step(1 / 60.f));
      ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
    }
    EXPECT_EQ(structure.broken() > 0, strength < stress);
  }
}

// A bar that spins about its middle is pulled there by ρ ω² L²/8.
TEST(Structure, ASpinningBarBursts) {
  const double length = 2, strength = 1e6, speed = math::sqrt(8 * strength / (1000 * length * length));
  for (const double share : {0.98, 1.02}) {
    auto d = cantilever(length, 0.1, 10);
    d.bonds.pop_back();
    d.iterations = 1000;
    d.material.tensile_strength = strength;
    d.angular_velocity = float(share * speed);
    rigid::World2 world({.gravity = {0, 0}});
    auto structure = Structure2::make(world, d).value();
    ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
    EXPECT_EQ(structure.broken(), share < 1 ? 0u : 1u) << "the middle one";
    EXPECT_EQ(structure.cluster_count(), share < 1 ? 1u : 2u);
  }
}

TEST(Structure, ABlockOfIceBreaksWhereItFallsFarEnough) {
  std::size_t last = 0;
  for (const double height : {0.002, 1.0}) {
    rigid::World3 world;
    floor_of(world);
    auto d = structure_of(block({0.1, 0.15, 0.1}, 30, 2), 917);
    d.material = bond_material(Substance::ice);
    d.pose.position = {0, 0.15 + height, 0};
    if (height > 0.5) d.pose.rotation = math::from_axis_angle(math::Vec3f{0.6f, 0, 0.8f}, 0.4f);
    auto structure = Structure3::make(world, d).value();
    const double mass = world.totals().mass;
    for (int i = 0; i < 60; ++i) {
      ASSERT_TRUE(world.step(1 / 60.f));
      const double energy = world.totals().kinetic_energy + world.totals().potential_energy;
      ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
      const double now = world.totals().kinetic_energy + world.totals().potential_energy;
      // What is given back never makes more of it than the blow took.
      EXPECT_LT(now, mass * 9.80665 * (0.15 + height) * 1.001 + 1e-3) << energy;
    }
    EXPECT_NEAR(world.totals().mass, mass, 1e-6 * mass);
    if (height < 0.01)
      EXPECT_EQ(structure.cluster_count(), 1u);
    else
      EXPECT_GT(structure.cluster_count(), 1u);
    last = structure.cluster_count();
  }
  EXPECT_GT(last, 1u);
}

StructureDef<Dim3> brick_wall() {
  const ConvexCell box(geometry::Bounds3d{{-1.5, 0, -0.1}, {1.5, 1.8, 0.1}});
  auto d = structure_of(
      fracture_convex(brick_pattern(box, {0.5, 0.2, 0.2}, {-1.5, 0, -0.1}).value(), {.meshes = false}).value(), 1900);
  d.material = bond_material(Substance::brick_and_mortar);
  anchor_below(d, 0.05);
  return d;
}

struct Shot {
  std::size_t broken, clusters;
  float speed;
  std::uint64_t hash;
};
Shot shoot(float speed, int threads, bool whole = false) {
  rigid::World3 world({.threads = threads});
  floor_of(world);
  auto d = brick_wall();
  if (whole) d.material.tensile_strength = d.material.shear_strength = d.material.compressive_strength = 1e15;
  auto structure = Structure3::make(world, d).value();
  rigid::BodyDef<Dim3> ball;
  ball.position = {0.1, 1.0, 2};
  ball.linear_velocity = {0, 0, -speed};
  ball.bullet = true;
  const auto id = world.create_body(ball).value();
  EXPECT_TRUE(world.add_shape(id, geometry::Sphere{0.15f}, {.density = 7800}));
  for (int i = 0; i < 60; ++i) {
    EXPECT_TRUE(world.step(1 / 60.f));
    EXPECT_TRUE(structure.after_step(world, 1 / 60.f));
  }
  return {structure.broken(), structure.cluster_count(), world.state(id)->linear_velocity.z, world.state_hash()};
}

TEST(Structure, ABallGoesThroughAWall) {
  const Shot none = shoot(0, 1), slow = shoot(0.5f, 1), fast = shoot(40, 1), hard = shoot(40, 1, true);
  EXPECT_EQ(none.broken, 0u) << "it stands";
  EXPECT_EQ(slow.broken, 0u);
  EXPECT_GT(fast.broken, 5u);
  EXPECT_EQ(hard.broken, 0u);
  EXPECT_GT(hard.speed, -1.0f) << "stopped by a wall that holds";
  EXPECT_LT(math::abs(fast.speed), 40.0f) << "no faster than it came";
  EXPECT_EQ(fast.hash, shoot(40, 3).hash);
}

TEST(Structure, SleepersStayAsleepUntilBondsBreak) {
  rigid::World3 world;
  floor_of(world);
  auto d = structure_of(block({0.5, 0.2, 0.5}, 20, 3), 2400);
  d.material = bond_material(Substance::concrete);
  d.pose.position = {0, 0.201, 0};
  auto structure = Structure3::make(world, d).value();
  for (int i = 0; i < 120; ++i) {
    ASSERT_TRUE(world.step(1 / 60.f));
    ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
  }
  EXPECT_EQ(structure.broken(), 0u);
  EXPECT_FALSE(world.state(structure.body_of(0))->awake);
  for (std::uint32_t i = 0; i < d.bonds.size(); ++i)
    if (d.bonds[i].a == 0 || d.bonds[i].b == 0) structure.break_bond(i);
  ASSERT_TRUE(structure.after_step(world, 1 / 60.f));
  EXPECT_GE(structure.cluster_count(), 2u);
  EXPECT_TRUE(world.state(structure.body_of(0))->awake);
}

TEST(Structure, CopiesFollowASnapshot) {
  rigid::World3 world;
  floor_of(world);
  auto d = structure_of(block({0.1, 0.15, 0.1}, 25, 2), 2300);
  d.material = bond_material(Substance::ceramic);
  d.pose.position = {0, 1, 0};
  auto structure = Structure3::make(world, d).value();
  const auto run = [&](Structure3& s) {
    for (int i = 0; i < 60; ++i) {
      EXPECT_TRUE(world.step(1 / 60.f));
      EXPECT_TRUE(s.after_step(world, 1 / 60.f));
    }
    return world.state_hash();
  };
  const auto snapshot = world.snapshot();
  Structure3 copy = structure;
  const std::uint64_t first = run(structure);
  ASSERT_TRUE(world.restore(snapshot));
  EXPECT_EQ(run(copy), first);
  EXPECT_EQ(copy.cluster_count(), structure.cluster_count());
}

TEST(Structure, SplintersOfAPaneStayNumbers) {
  // Small pieces jammed between large ones are spun past half a turn a substep when the pane lands on its edge.
  for (const std::uint64_t seed : {7u, 9u, 10u}) {
    rigid::World3 world;
    floor_of(world);
    const ConvexCell pane(geometry::Bounds3d{{-1, -0.75, -0.005}, {1, 0.75, 0.005}});
    const auto sites =
        radial_sites(pane, {.impact = {0.2, 0.1, 0}, .first_radius = 0.03, .growth = 1.55, .sectors = 11}, seed)
            .value();
    auto d = structure_of(
        fracture_convex(voronoi_pattern(pane, sites).value(), {.skin = 5e-4, .meshes = false}).value(), 2500);
    d.pose.position = {0, 1.05, 0};
    d.bonds.clear();
    ASSERT_TRUE(Structure3::make(world, d));
    for (int i = 0; i < 40; ++i) {
      ASSERT_TRUE(world.step(1 / 60.f));
      EXPECT_TRUE(world.events().quarantined.empty());
    }
  }
}

TEST(Structure, BadInputIsNamed) {
  rigid::World3 world;
  StructureDef<Dim3> d;
  EXPECT_EQ(Structure3::make(world, d).error().message, "Structure: no parts, expected at least one");
  d = brick_wall();
  d.bonds[3].b = 9999;
  EXPECT_NE(Structure3::make(world, d).error().message.find("bond 3 is between parts"), std::string::npos);
  d = brick_wall();
  d.material.tensile_strength = 0;
  EXPECT_EQ(Structure3::make(world, d).error().message,
            "Structure: tensile_strength is 0, expected a finite number > 0");
}

}  // namespace blast_test
