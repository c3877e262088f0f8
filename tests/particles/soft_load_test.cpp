// Rigid bodies on foam and cloth: their mass is in the same system as the particles that bear them.
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/particles/cloth.h"
#include "carom/particles/soft_body.h"

namespace carom::particles {
namespace soft_load_test {

using namespace math;
using rigid::Dim3;
using rigid::World3;
constexpr double dt = 1.0 / 60, g = 9.80665;

rigid::BodyId add_body(World3& world, Vec3d place, const geometry::Shape3& shape, double mass, double volume) {
  rigid::BodyDef<Dim3> def;
  def.position = place;
  const auto id = world.create_body(def).value();
  world.add_shape(id, shape, {.density = float(mass / volume)}).value();
  return id;
}

void add_ground(World3& world) {
  rigid::BodyDef<Dim3> ground;
  ground.type = rigid::BodyType::fixed;
  world.add_shape(world.create_body(ground).value(), geometry::Plane{}).value();
}

SoftBody make_foam(double modulus, Vec3d corner = {-0.25, 0.005, -0.25}) {
  const SoftMesh mesh = make_soft_box(corner, {0.5, 0.25, 0.5}, 6, 3, 6);
  return SoftBody::make({.material = {.density = 50, .youngs_modulus = modulus, .poisson_ratio = 0.2, .damping = 0.02},
                         .points = mesh.points,
                         .tetrahedra = mesh.tetrahedra})
      .value();
}

double energy_of(const World3& world, rigid::BodyId id, double mass) {
  const auto state = world.state(id);
  return mass * g * state->center_of_mass.y + 0.5 * mass * double(length_squared(state->linear_velocity));
}

TEST(SoftLoad, BoxOnStiffFoamStaysAtSixtyHertz) {
  // k Δt² from less than the box's mass to ten thousand times it.
  for (const double modulus : {1e5, 1e6, 1e7})
    for (const double mass : {0.2, 40.0}) {
      World3 world;
      add_ground(world);
      SoftBody foam = make_foam(modulus);
      const auto box = add_body(world, {0, 0.365, 0}, geometry::Box{{0.1f, 0.1f, 0.1f}}, mass, 0.008);
      double highest = 0, fastest = 0;
      for (int i = 0; i < 180; ++i) {
        foam.step(world, dt).value();
        world.step(float(dt)).value();
        const auto state = world.state(box);
        highest = max(highest, state->center_of_mass.y);
        if (i >= 120) fastest = max(fastest, double(length(state->linear_velocity)));
      }
      const auto state = world.state(box);
      RecordProperty("highest", std::to_string(highest));
      EXPECT_LT(highest, 0.37) << modulus << ' ' << mass;
      EXPECT_LT(fastest, 0.01) << modulus << ' ' << mass;
      EXPECT_GT(state->center_of_mass.y, 0.3) << modulus << ' ' << mass;
      EXPECT_GT(double(state->pose.rotation.w), 0.999) << modulus << ' ' << mass;
    }
}

TEST(SoftLoad, BoxDroppedOnFoamNeverGainsEnergy) {
  for (const double modulus : {1e5, 1e6})
    for (const double mass : {0.5, 20.0}) {
      World3 world;
      add_ground(world);
      SoftBody foam = make_foam(modulus);
      const auto box = add_body(world, {0, 0.86, 0}, geometry::Box{{0.1f, 0.1f, 0.1f}}, mass, 0.008);
      const double before = energy_of(world, box, mass);
      double highest = 0;
      for (int i = 0; i < 240; ++i) {
        foam.step(world, dt).value();
        world.step(float(dt)).value();
        highest = max(highest, energy_of(world, box, mass) / before);
      }
      EXPECT_LT(highest, 1.001) << modulus << ' ' << mass;
      EXPECT_LT(double(length(world.state(box)->linear_velocity)), 0.02) << modulus << ' ' << mass;
    }
}

TEST(SoftLoad, FoamBearsTheWeightOfWhatLiesOnIt) {
  // The bed's force on the ground is not read here: what holds the box is, by its acceleration, and it comes to rest at
  // the depth of a column in compression, σ/E (ν = 0), when the box covers the whole of it.
  World3 world;
  add_ground(world);
  const SoftMesh mesh = make_soft_box({-0.1, 0.005, -0.1}, {0.2, 0.2, 0.2}, 4, 4, 4);
  SoftBody foam =
      SoftBody::make({.material = {.density = 30, .youngs_modulus = 5e4, .poisson_ratio = 0, .damping = 0.05},
                      .points = mesh.points,
                      .tetrahedra = mesh.tetrahedra})
          .value();
  const double mass = 10;
  const auto box = add_body(world, {0, 0.21 + 0.1, 0}, geometry::Box{{0.15f, 0.1f, 0.15f}}, mass, 0.018);
  for (int i = 0; i < 600; ++i) {
    foam.step(world, dt).value();
    world.step(float(dt)).value();
  }
  // Its own weight shortens it by ρ g L²/2E.
  const double expected = mass * g * 0.2 / (5e4 * 0.04) + 30 * g * 0.2 * 0.2 / (2 * 5e4);
  const double found = 0.31 - world.state(box)->center_of_mass.y;
  RecordProperty("found", std::to_string(found));
  RecordProperty("expected", std::to_string(expected));
  EXPECT_NEAR(found, expected, 0.06 * expected);
}

TEST(SoftLoad, HeavyBallOnATrampoline) {
  // A ball of a thousand times the cloth's mass falls into it and comes up no higher than it fell from.
  for (const double ratio : {1.0, 1000.0}) {
    World3 world;
    const int n = 21;
    const ClothSheet sheet = make_cloth_sheet({-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, n, n);
    Cloth cloth = Cloth::make({.fabric = {.mass_per_area = 0.25,
                                          .warp_stiffness = 2000 * ratio,
                                          .weft_stiffness = 2000 * ratio,
                                          .shear_stiffness = 500 * ratio,
                                          .damping = 0.01,
                                          .thickness = 0.01},
                               .points = sheet.points,
                               .triangles = sheet.triangles})
                      .value();
    cloth.set_air(0, {}).value();
    for (int r = 0; r < n; ++r)
      for (int c = 0; c < n; ++c)
        if (r == 0 || c == 0 || r == n - 1 || c == n - 1) cloth.pin(r * n + c).value();
    const double mass = ratio, radius = 0.25;
    const auto ball = add_body(world, {0.02, 1.6, 0.01}, geometry::Sphere{float(radius)}, mass,
                               4.0 / 3 * 3.14159265358979 * radius * radius * radius);
    const double before = energy_of(world, ball, mass);
    double lowest = 2, highest = 0;
    for (int i = 0; i < 420; ++i) {
      cloth.step(world, dt).value();
      world.step(float(dt)).value();
      lowest = min(lowest, world.state(ball)->center_of_mass.y);
      highest = max(highest, energy_of(world, ball, mass) / before);
      for (const Vec3d& p : cloth.positions()) {
        ASSERT_TRUE(is_finite(p.y));
        ASSERT_GT(length(p - world.state(ball)->center_of_mass), radius - 0.02) << ratio << ' ' << i;
      }
    }
    RecordProperty("lowest", std::to_string(lowest));
    EXPECT_LT(highest, 1.001) << ratio;
    EXPECT_LT(lowest, 1.24) << ratio;  // it sinks in
    EXPECT_GT(lowest, 0.3) << ratio;   // and is borne
    EXPECT_LT(double(length(world.state(ball)->linear_velocity)), 0.2) << ratio;
  }
}

TEST(SoftLoad, ClothKeepsMomentumWithBodiesOfEveryMass) {
  rigid::WorldDef<Dim3> weightless;
  weightless.gravity = {};
  weightless.allow_sleep = false;  // which would take a slow body's momentum
  for (const double mass : {0.001, 0.25, 250.0}) {
    World3 world(weightless);
    const ClothSheet sheet = make_cloth_sheet({-0.5, 0, -0.5}, {1, 0, 0}, {0, 0, 1}, 17, 17);
    Cloth cloth = Cloth::make({.fabric = {.mass_per_area = 0.25, .thickness = 0.01},
                               .points = sheet.points,
                               .triangles = sheet.triangles})
                      .value();
    cloth.set_air(0, {}).value();
    const auto ball =
        add_body(world, {0.1, 0.5, 0.05}, geometry::Sphere{0.2f}, mass, 4.0 / 3 * 3.14159265358979 * 0.008);
    world.set_velocity(ball, {0, -2, 0}, {0, 0, 5}).value();
    const Vec3d before = cloth.momentum() + world.totals().momentum;
    const double energy = 0.5 * mass * 4 + 0.5 * 0.4 * mass * 0.04 * 25;
    for (int i = 0; i < 120; ++i) {
      cloth.step(world, dt).value();
      world.step(float(dt)).value();
      const auto state = world.state(ball);
      const double now = 0.5 * mass * double(length_squared(state->linear_velocity)) +
                         0.5 * 0.4 * mass * 0.04 * double(length_squared(state->angular_velocity)) +
                         cloth.kinetic_energy() + cloth.elastic_energy();
      ASSERT_LT(now, 1.002 * energy) << mass << ' ' << i;
    }
    const Vec3d after = cloth.momentum() + world.totals().momentum;
    EXPECT_LT(length(after - before), 2e-3 * length(before)) << mass;
  }
}

TEST(SoftLoad, SoftBallOnABoxThatLiesOnTheGround) {
  // What else holds a body is felt: a box of a tenth of the ball's mass between it and the ground stays where it is.
  World3 world;
  add_ground(world);
  const auto box = add_body(world, {0, 0.1, 0}, geometry::Box{{0.4f, 0.1f, 0.4f}}, 3, 0.128);
  const SoftMesh mesh = make_soft_ball({0, 0.53, 0}, 0.3, 6);
  SoftBody ball =
      SoftBody::make({.material = {.density = 300, .youngs_modulus = 1e5, .poisson_ratio = 0.3, .damping = 0.02},
                      .points = mesh.points,
                      .tetrahedra = mesh.tetrahedra})
          .value();
  for (int i = 0; i < 240; ++i) {
    ball.step(world, dt).value();
    world.step(float(dt)).value();
  }
  double lowest = 1;
  for (const Vec3d& p : ball.positions()) lowest = min(lowest, p.y);
  RecordProperty("lowest", std::to_string(lowest));
  EXPECT_GT(lowest, 0.2);
  EXPECT_NEAR(world.state(box)->center_of_mass.y, 0.1, 0.004);
  const double resting = ball.center().y;
  for (int i = 0; i < 120; ++i) {
    ball.step(world, dt).value();
    world.step(float(dt)).value();
  }
  EXPECT_NEAR(ball.center().y, resting, 0.004);
}

}  // namespace soft_load_test
}  // namespace carom::particles
