// What a world costs at rest.
#include <gtest/gtest.h>

#include <vector>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

// The bar of this engine: at most 1 kB for a sleeping body of space with a shape and its contacts.
TEST(Memory, SleepingBodyTakesAtMostAKilobyte) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  const int side = 50;
  for (int x = 0; x < side; ++x)
    for (int z = 0; z < side; ++z) add_box<Dim3>(world, {1.5 * x - 37.5, 0.5, 1.5 * z - 37.5});
  run(world, 90);
  const Counters c = world.counters();
  EXPECT_EQ(c.awake_bodies, 0);
  EXPECT_LE(c.bytes / std::size_t(c.bodies), 1024u);
}

// A ball joint takes 318, and what there is of room ahead; Jolt 5.5's, a point constraint, 370, its hinge 869.
TEST(Memory, SmallJointTakesAtMost370Bytes) {
  for (const int count : {1300, 2100, 4200, 5000}) {
    World3 world(world_with<Dim3>(0));
    std::vector<BodyId> boxes;
    for (int i = 0; i <= count; ++i) boxes.push_back(add_box<Dim3>(world, {3.0 * i, 0, 0}));
    const std::size_t before = world.counters().bytes;
    for (int i = 0; i < count; ++i) {
      BallJointDef<Dim3> joint;
      joint.body_a = boxes[std::size_t(i)];
      joint.body_b = boxes[std::size_t(i) + 1];
      joint.frame_a.p = {1.5f, 0, 0};
      joint.frame_b.p = {-1.5f, 0, 0};
      world.create_joint(joint).value();
    }
    EXPECT_LE((world.counters().bytes - before) / std::size_t(count), 370u) << count << " joints";
  }
}

TEST(Memory, CreatingAndDestroyingReachesASteadyState) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  std::size_t held = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<BodyId> boxes = add_pyramid(world, 6);
    run(world, 4);
    for (const BodyId box : boxes) ASSERT_TRUE(world.destroy_body(box).ok());
    if (round == 9) held = world.counters().bytes;
  }
  EXPECT_LE(world.counters().bytes, held + held / 50);
  EXPECT_EQ(world.counters().bodies, 1);
  EXPECT_EQ(world.counters().contacts, 0);
}

TEST(Memory, WorldWithoutMotionCostsNothing) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  add_pyramid(world, 10);
  run(world, 300);
  ASSERT_EQ(world.counters().awake_bodies, 0);
  world.step(frame).value();
  EXPECT_LT(world.profile().total, 0.1);  // ms; a hundred times what it takes
}

}  // namespace
}  // namespace carom::rigid::test
