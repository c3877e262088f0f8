// Chapter 10, collision response in a world of bodies, with the numbers of chapter 5.3. Source: mechanics.md (C).
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/rigid/world.h"

namespace carom::published {
namespace chapter_10_test {

using namespace carom::rigid;
constexpr float frame = 1.0f / 60;

WorldDef<Dim2> space2() { return {.gravity = {}, .allow_sleep = false, .restitution_threshold = 0.01f}; }
WorldDef<Dim3> space3() { return {.gravity = {}, .allow_sleep = false, .restitution_threshold = 0.01f}; }

TEST(Chapter10, HeadOnEqualMassesSwapTheirVelocities) {
  World3 world(space3());
  ShapeDef<Dim3> shape;
  shape.material = {.friction = 0, .restitution = 1};
  const BodyId a = world.create_body({.position = {-2, 0, 0}, .linear_velocity = {3, 0, 0}}).value();
  const BodyId b = world.create_body({.position = {2, 0, 0}, .linear_velocity = {-1, 0, 0}}).value();
  world.add_shape(a, geometry::Sphere{0.5f}, shape).value();
  world.add_shape(b, geometry::Sphere{0.5f}, shape).value();
  const Totals<Dim3> before = world.totals();
  for (int i = 0; i < 120; ++i) world.step(frame).value();
  // Exact to the rounding of float velocities.
  EXPECT_NEAR(world.state(a).value().linear_velocity.x, -1, 2e-6);
  EXPECT_NEAR(world.state(b).value().linear_velocity.x, 3, 2e-6);
  EXPECT_LE(world.totals().kinetic_energy, before.kinetic_energy * (1 + 1e-6));
}

TEST(Chapter10, UnequalMassesWithHalfRestitution) {
  // 5.2: m = 2, 1; v = 3, −1; e = .5 → v' = 1, 3.
  World2 world(space2());
  ShapeDef<Dim2> shape;
  shape.material = {.friction = 0, .restitution = 0.5f};
  const BodyId a = world.create_body({.position = {-2, 0}, .linear_velocity = {3, 0}}).value();
  const BodyId b = world.create_body({.position = {2, 0}, .linear_velocity = {-1, 0}}).value();
  shape.density = 2;
  world.add_shape(a, geometry::make_box2({0.5f, 0.5f}), shape).value();
  shape.density = 1;
  world.add_shape(b, geometry::make_box2({0.5f, 0.5f}), shape).value();
  for (int i = 0; i < 120; ++i) world.step(frame).value();
  EXPECT_NEAR(world.state(a).value().linear_velocity.x, 1, 1e-3);
  EXPECT_NEAR(world.state(b).value().linear_velocity.x, 3, 1e-3);
}

TEST(Chapter10, CornerOnFaceImpactConservesWhatItMust) {
  // The case of 5.3: two boxes, m = 10, I = 104.1667, r₁ = (0, 5), r₂ = (2, −5), n = (0, 1), e = .5, |J| = 25.16779,
  // v₁' = 1.483221, v₂' = 2.516779. A disc on each body makes the contact a point at exactly those arms.
  World2 world(space2());
  const auto make = [&](Vec2d p, float v, Vec2f arm, float inward) {
    const BodyId body = world.create_body({.position = p, .linear_velocity = {0, v}}).value();
    ShapeDef<Dim2> shape;
    shape.density = 0;
    shape.material = {.friction = 0, .restitution = 0.5f};
    shape.local.p = arm + Vec2f{0, inward};
    world.add_shape(body, geometry::Circle{0.5f}, shape).value();
    world.set_mass_properties(body, {10, {}, 104.1667}).value();
    return body;
  };
  const BodyId a = make({0, 0}, 4, {0, 5}, -0.5f);
  const BodyId b = make({-2, 10.2}, 0, {2, -5}, 0.5f);
  const Totals<Dim2> before = world.totals();
  for (int i = 0; i < 30; ++i) world.step(frame).value();
  const BodyState<Dim2> sa = world.state(a).value(), sb = world.state(b).value();
  EXPECT_NEAR(sa.linear_velocity.y, 1.483221, 0.01);
  EXPECT_NEAR(sb.linear_velocity.y, 2.516779, 0.01);
  EXPECT_NEAR(10 * (sb.linear_velocity.y - 0), 25.16779, 0.1);
  const Totals<Dim2> after = world.totals();
  EXPECT_NEAR(after.momentum.y, before.momentum.y, 1e-4);
  EXPECT_NEAR(after.angular_momentum, before.angular_momentum, 1e-3);
  EXPECT_LT(after.kinetic_energy, before.kinetic_energy);
}

template <class D>
void meet_at_hundred(World<D>& world, BodyId a, BodyId b) {
  float worst = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(frame).value();
    worst = math::max(worst, world.worst_penetration());
  }
  EXPECT_LT(worst, 0.02f) << "m of overlap";
  EXPECT_LT(world.state(a).value().pose.position.x, world.state(b).value().pose.position.x) << "passed through";
}

TEST(Chapter10, NoInterpenetrationAtAHundredMetresPerSecond) {
  {
    World2 world(space2());
    const BodyId a = world.create_body({.position = {-10.3, 0}, .linear_velocity = {50, 0}, .bullet = true}).value();
    const BodyId b = world.create_body({.position = {10, 0}, .linear_velocity = {-50, 0}, .bullet = true}).value();
    world.add_shape(a, geometry::make_box2({0.25f, 0.25f})).value();
    world.add_shape(b, geometry::make_box2({0.25f, 0.25f})).value();
    meet_at_hundred(world, a, b);
  }
  {
    World3 world(space3());
    const BodyId a = world.create_body({.position = {-10.3, 0, 0}, .linear_velocity = {100, 0, 0}}).value();
    BodyDef<Dim3> wall;
    wall.type = BodyType::fixed;
    wall.position = {5, 0, 0};
    const BodyId b = world.create_body(wall).value();
    world.add_shape(a, geometry::Sphere{0.1f}).value();
    world.add_shape(b, geometry::Box{{0.05f, 3, 3}}).value();
    meet_at_hundred(world, a, b);
  }
}

}  // namespace chapter_10_test
}  // namespace carom::published
