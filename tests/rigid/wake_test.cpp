// Sleepers wake when something reaches them.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class Wake : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Wake, Dimensions);

// A neighbour within the margin has a manifold before it touches: it falls asleep by itself, and must still wake when
// the other comes on.
TYPED_TEST(Wake, ByANeighborThatWasCloseAllAlong) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  d.gravity = {};
  World<D> world(d);
  const BodyId sleeper = add_box<D>(world, at<D>(0, 0));
  BodyDef<D> restless;
  restless.position = at<D>(1.012, 0);
  restless.allow_sleep = false;
  const BodyId other = world.create_body(restless).value();
  world.add_shape(other, box_shape<D>(0.5f, 0.5f, 0.5f)).value();
  run(world, 60);
  ASSERT_FALSE(world.state(sleeper).value().awake);
  ASSERT_TRUE(world.state(other).value().awake);
  typename D::Vector v{};
  v.x = -0.1f;
  world.set_velocity(other, v, {}).value();
  run(world, 120);
  // Without restitution they go on together, and keep the momentum.
  EXPECT_TRUE(world.state(sleeper).value().awake);
  EXPECT_NEAR(world.state(sleeper).value().linear_velocity.x, -0.05, 3e-3);
  EXPECT_NEAR(world.state(other).value().linear_velocity.x, -0.05, 3e-3);
  EXPECT_LT(world.worst_penetration(), 0.006f);
}

}  // namespace
}  // namespace carom::rigid::test
