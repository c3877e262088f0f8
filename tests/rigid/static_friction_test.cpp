// A pair of materials with a friction of rest and one of motion (mechanics 3.3: |F_s| ≤ μ_s N, F_k = μ_k N). Gravity
// leans instead of the ground.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

constexpr double g = 10;
constexpr float at_rest = 0.6f, in_motion = 0.3f;

template <class D>
ShapeId shape_of(const World<D>& world, BodyId body) {
  std::vector<ShapeId> shapes;
  world.shapes(body, shapes);
  return shapes.at(0);
}
template <class D>
void made_of(World<D>& world, BodyId body, std::uint32_t material) {
  world.set_material(shape_of(world, body), {.friction = 0.9f, .user_id = material}).value();
}

template <class D>
struct Slope {
  explicit Slope(double angle, PairRule rule = {.friction = in_motion, .static_friction = at_rest})
      : world(leaning(angle)) {
    const BodyId ground = add_ground(world);
    made_of(world, ground, 1);
    block = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.1f, 0.5f), at<D>(0, 0.1));
    made_of(world, block, 2);
    EXPECT_TRUE(world.set_pair_rule(1, 2, &rule).ok());
  }
  static WorldDef<D> leaning(double angle) {
    WorldDef<D> def = world_with<D>();
    def.gravity = along<D>(float(g * std::sin(angle)), float(-g * std::cos(angle)));
    return def;
  }
  double speed() const { return world.state(block).value().linear_velocity.x; }
  double place() const { return world.state(block).value().pose.position.x; }
  World<D> world;
  BodyId block;
};

template <class D>
class StaticFriction : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(StaticFriction, Dimensions);

// Between the angles of the two frictions a block stands where it stood, and what was pushed slides on, faster and
// faster, by g (sin − μ_k cos). Below both it stops; beyond both it slides by itself.
TYPED_TEST(StaticFriction, StandsWhereItStoodAndSlidesOnWhenPushed) {
  const double between = std::atan(0.45);
  {
    Slope<TypeParam> slope(between);
    run(slope.world, 300);
    EXPECT_NEAR(slope.place(), 0, 2e-3) << "stands";
    ASSERT_TRUE(slope.world.set_velocity(slope.block, along<TypeParam>(0.3f, 0), {}).ok());
    run(slope.world, 1);
    const double from = slope.speed();
    run(slope.world, 120);
    const double a = g * (std::sin(between) - in_motion * std::cos(between));
    EXPECT_NEAR((slope.speed() - from) / 2, a, 0.01 * a) << "slides on";
  }
  {
    Slope<TypeParam> uphill(between);  // it stops at the top of its way, and what has stopped stands
    run(uphill.world, 60);
    ASSERT_TRUE(uphill.world.set_velocity(uphill.block, along<TypeParam>(-2, 0), {}).ok());
    run(uphill.world, 180);
    const double a = g * (std::sin(between) + in_motion * std::cos(between));
    EXPECT_NEAR(uphill.place(), -2 * 2 / (2 * a), 0.02);
    EXPECT_NEAR(uphill.speed(), 0, 1e-3);
  }
  {
    Slope<TypeParam> gentle(std::atan(0.2));
    run(gentle.world, 60);
    ASSERT_TRUE(gentle.world.set_velocity(gentle.block, along<TypeParam>(1, 0), {}).ok());
    run(gentle.world, 240);
    EXPECT_NEAR(gentle.speed(), 0, 1e-3) << "stops";
    const double a = g * (std::sin(std::atan(0.2)) - in_motion * std::cos(std::atan(0.2)));
    EXPECT_NEAR(gentle.place(), 1 / (-2 * a), 0.02);
  }
}

// It breaks loose at the angle of rest, within half a degree (mechanics 14: slip iff tan θ > μ ± .5°), and then has the
// friction of motion.
TYPED_TEST(StaticFriction, BreaksLooseAtTheAngleOfRest) {
  const double limit = std::atan(at_rest), half_degree = 0.5 * pi / 180;
  Slope<TypeParam> holds(limit - half_degree), slips(limit + half_degree);
  run(holds.world, 300);
  run(slips.world, 300);
  EXPECT_NEAR(holds.place(), 0, 5e-3);
  EXPECT_GT(slips.place(), 1);
  const double from = slips.speed();
  run(slips.world, 60);
  const double a = g * (std::sin(limit + half_degree) - in_motion * std::cos(limit + half_degree));
  EXPECT_NEAR(slips.speed() - from, a, 0.01 * a);
}

// On a belt what runs along with it sticks, and what the belt runs under slides.
TYPED_TEST(StaticFriction, OfABeltIsAgainstTheBelt) {
  using D = TypeParam;
  World<D> world(world_with<D>(float(g)));
  const BodyId belt = add_ground(world);
  ASSERT_TRUE(world.set_surface_velocity(shape_of(world, belt), along<D>(2, 0)).ok());
  made_of(world, belt, 1);
  const BodyId block = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.5f, 0.1f, 0.5f), at<D>(0, 0.1));
  made_of(world, block, 2);
  const PairRule rule{.friction = in_motion, .static_friction = at_rest};
  ASSERT_TRUE(world.set_pair_rule(1, 2, &rule).ok());
  run(world, 30);
  EXPECT_NEAR(world.state(block).value().linear_velocity.x, in_motion * g * 0.5, 0.03) << "by the friction of motion";
  run(world, 60);
  EXPECT_NEAR(world.state(block).value().linear_velocity.x, 2, 1e-3);
  // What pulls with more than the friction of motion, and less than that of rest, does not get it off.
  for (int i = 0; i < 120; ++i) {
    const float pull = float(0.5 * (in_motion + at_rest) * g) * 200;  // kg that a metre by .2 (by a metre) has
    ASSERT_TRUE(world.add_force(block, along<D>(pull, 0)).ok());
    run(world, 1);
  }
  EXPECT_NEAR(world.state(block).value().linear_velocity.x, 2, 5e-3);
}

TYPED_TEST(StaticFriction, NoneGivenChangesNothingAndLessIsRefused) {
  Slope<TypeParam> plain(std::atan(0.45), {.friction = in_motion}),
      same(std::atan(0.45), {.friction = in_motion, .static_friction = in_motion});
  run(plain.world, 120);
  run(same.world, 120);
  EXPECT_GT(plain.place(), 1) << "slides by itself";
  EXPECT_EQ(plain.place(), same.place());
  const PairRule less{.friction = 0.5f, .static_friction = 0.4f}, negative{.static_friction = -1};
  EXPECT_FALSE(plain.world.set_pair_rule(1, 2, &less).ok());
  EXPECT_FALSE(plain.world.set_pair_rule(1, 2, &negative).ok());
}

}  // namespace
}  // namespace carom::rigid::test
