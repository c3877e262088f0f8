// What a step reports.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class WorldEvents : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(WorldEvents, Dimensions);

// A box that leaves another by more than counts as touching, yet not so far that its contact ends, and comes back: the
// touch ends and begins anew, although the pair was passed over before.
TYPED_TEST(WorldEvents, TouchEndsAndBeginsAgainWithinTheMargin) {
  using D = TypeParam;
  WorldDef<D> definition = world_with<D>();
  definition.gravity = {};
  definition.allow_sleep = false;
  World<D> world(definition);
  const BodyId still = add_box<D>(world, {}), moved = add_box<D>(world, at<D>(1.002, 0));
  (void)still;
  int begins = 0, ends = 0;
  const auto go = [&](float speed, int steps) {
    for (int i = 0; i < steps; ++i) {
      world.set_velocity(moved, along<D>(speed, 0), {}).value();
      world.step(frame).value();
      begins += int(world.events().contact_begin.size());
      ends += int(world.events().contact_end.size());
    }
  };
  go(0, 5);
  EXPECT_EQ(begins, 1);
  go(0.06f, 11);  // to 13 mm apart
  EXPECT_EQ(ends, 1);
  go(-0.06f, 11);
  EXPECT_EQ(begins, 2);
  EXPECT_EQ(ends, 1);
}

TYPED_TEST(WorldEvents, ContactBeginsOnceAndEndsOnce) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const BodyId box = add_box<D>(world, at<D>(0, 1.5));
  int begins = 0, ends = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(frame).value();
    begins += int(world.events().contact_begin.size());
    ends += int(world.events().contact_end.size());
  }
  EXPECT_EQ(begins, 1);
  EXPECT_EQ(ends, 0);
  ASSERT_TRUE(world.set_pose(box, at<D>(0, 20), {}).ok());
  world.step(frame).value();
  ends += int(world.events().contact_end.size());
  EXPECT_EQ(ends, 1);
}

TYPED_TEST(WorldEvents, DestroyingABodyEndsItsContacts) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const BodyId box = add_box<D>(world, at<D>(0, 0.5));
  run(world, 60);
  ASSERT_TRUE(world.destroy_body(box).ok());
  world.step(frame).value();
  EXPECT_EQ(world.events().contact_end.size(), 1u);
}

// The impulse of a hit is the momentum that the body lost.
TYPED_TEST(WorldEvents, HitTellsTheImpulse) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  const BodyId wall = add_body<D>(world, BodyType::fixed, box_shape<D>(0.5f, 5, 5), at<D>(0, 0));
  BodyDef<D> d;
  d.position = at<D>(-3, 0);
  d.linear_velocity = along<D>(4, 0);
  const BodyId ball = world.create_body(d).value();
  ShapeDef<D> s;
  s.hit_events = true;
  s.material.restitution = 0.5f;
  const ShapeId shape = world.add_shape(ball, ball_shape<D>(0.25f), s).value();
  const float mass = world.state(ball).value().mass;
  int hits = 0;
  for (int i = 0; i < 60; ++i) {
    world.step(frame).value();
    for (const ContactHitEvent<D>& hit : world.events().contact_hit) {
      ++hits;
      EXPECT_NEAR(hit.approach_speed, 4, 1e-3);
      EXPECT_NEAR(hit.impulse, mass * 6, 0.01f * mass * 6);
      EXPECT_NEAR(std::abs(hit.normal.x), 1, 1e-4);
      EXPECT_NEAR(hit.point.x, -0.5, 0.05);
      EXPECT_TRUE(hit.shape_a == shape || hit.shape_b == shape);
    }
  }
  EXPECT_EQ(hits, 1);
  EXPECT_TRUE(world.contains(wall));
}

// What came down at 45° slid across the surface as fast as it hit it.
TYPED_TEST(WorldEvents, HitTellsTheSlip) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  add_ground(world);
  BodyDef<D> d;
  d.position = at<D>(0, 1);
  d.linear_velocity = along<D>(3, -4);
  const BodyId ball = world.create_body(d).value();
  ShapeDef<D> s;
  s.hit_events = true;
  world.add_shape(ball, ball_shape<D>(0.25f), s).value();
  int hits = 0;
  for (int i = 0; i < 30; ++i) {
    world.step(frame).value();
    for (const ContactHitEvent<D>& hit : world.events().contact_hit) {
      ++hits;
      EXPECT_NEAR(hit.approach_speed, 4, 1e-3);
      EXPECT_NEAR(hit.slip_speed, 3, 1e-3);
    }
  }
  EXPECT_EQ(hits, 1);
}

TYPED_TEST(WorldEvents, MovesAreToldToWhoAsks) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  World<D> silent(d);
  d.move_events = true;
  World<D> world(d);
  add_ground(world);
  add_box<D>(silent, at<D>(0, 5));
  std::vector<BodyId> bodies;
  for (int i = 0; i < 5; ++i) bodies.push_back(add_box<D>(world, at<D>(3 * i, 0.5 + i)));
  silent.step(frame).value();
  EXPECT_TRUE(silent.events().moved.empty());
  for (int i = 0; i < 300; ++i) {
    const std::size_t awake = std::size_t(world.counters().awake_bodies);
    world.step(frame).value();
    ASSERT_EQ(world.events().moved.size(), awake);
    for (const MoveEvent<D>& e : world.events().moved) {
      const BodyState<D> s = world.state(e.body).value();
      ASSERT_TRUE(e.pose.position == s.pose.position && e.pose.rotation == s.pose.rotation);
    }
  }
  EXPECT_TRUE(world.events().moved.empty());  // all asleep
}

// A caller's function that returns no number freezes its own body, names it, and harms nobody else.
TYPED_TEST(WorldEvents, ABodyBrokenByAUserIsQuarantinedAlone) {
  using D = TypeParam;
  World<D> world(world_with<D>()), twin(world_with<D>());
  std::vector<BodyId> stack, other;
  for (World<D>* w : {&world, &twin}) {
    add_ground(*w);
    for (int i = 0; i < 5; ++i) (w == &world ? stack : other).push_back(add_box<D>(*w, at<D>(0, 0.5 + i)));
  }
  const CustomEffector<D> broken = breaks<D>(stack[2]);
  world.add_effector(broken).value();
  world.add_effector(broken).value();  // twice, told once
  int told = 0;
  for (int i = 0; i < 240; ++i) {
    world.step(frame).value();
    for (const SleepEvent& e : world.events().quarantined) {
      ++told;
      EXPECT_EQ(e.body, stack[2]);
    }
    for (const BodyId body : stack) ASSERT_TRUE(math::is_finite(world.state(body).value().pose.position));
  }
  EXPECT_EQ(told, 1);
  // Who stood on it has fallen on who stood below it.
  EXPECT_NEAR(world.state(stack[3]).value().pose.position.y, 2.5, 0.05);
  EXPECT_NEAR(world.state(stack[4]).value().pose.position.y, 3.5, 0.05);
  ASSERT_TRUE(world.destroy_body(stack[2]).ok());
  run(world, 10);
}

TYPED_TEST(WorldEvents, SensorSeesWhoComesAndGoes) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  BodyDef<D> gate;
  gate.type = BodyType::fixed;
  const BodyId body = world.create_body(gate).value();
  ShapeDef<D> s;
  s.sensor = true;
  const ShapeId sensor = world.add_shape(body, box_shape<D>(0.5f, 2, 2), s).value();
  const BodyId ball = add_ball<D>(world, at<D>(-3, 0), 0.25f, {}, along<D>(5, 0));
  int begins = 0, ends = 0;
  for (int i = 0; i < 90; ++i) {
    world.step(frame).value();
    for (const SensorEvent& e : world.events().sensor_begin) {
      ++begins;
      EXPECT_EQ(e.sensor, sensor);
      EXPECT_EQ(world.body_of(e.visitor).value(), ball);
    }
    ends += int(world.events().sensor_end.size());
  }
  EXPECT_EQ(begins, 1);
  EXPECT_EQ(ends, 1);
  EXPECT_NEAR(world.state(ball).value().linear_velocity.x, 5, 1e-6);  // it pushes nothing
}

TYPED_TEST(WorldEvents, FallingAsleepIsTold) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const BodyId box = add_box<D>(world, at<D>(0, 0.5));
  int told = 0;
  for (int i = 0; i < 120; ++i) {
    world.step(frame).value();
    for (const SleepEvent& e : world.events().fell_asleep) {
      ++told;
      EXPECT_EQ(e.body, box);
    }
  }
  EXPECT_EQ(told, 1);
}

TYPED_TEST(WorldEvents, SupportThatVanishesWakes) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const BodyId table = add_body<D>(world, BodyType::fixed, box_shape<D>(2, 0.5f, 2), at<D>(0, -0.5));
  const BodyId box = add_box<D>(world, at<D>(0, 0.5));
  run(world, 120);
  ASSERT_FALSE(world.state(box).value().awake);
  ASSERT_TRUE(world.destroy_body(table).ok());
  run(world, 60);
  EXPECT_LT(world.state(box).value().pose.position.y, -3);
}

TYPED_TEST(WorldEvents, FiltersAndGroupsDecide) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const BodyId ghost = add_box<D>(world, at<D>(0, 0.5));
  std::vector<ShapeId> shapes;
  world.shapes(ghost, shapes);
  ASSERT_TRUE(world.set_filter(shapes[0], {2, 0, 0}).ok());
  run(world, 30);
  EXPECT_LT(world.state(ghost).value().pose.position.y, 0);
}

TYPED_TEST(WorldEvents, KinematicBodyPushesAndArrives) {
  using D = TypeParam;
  World<D> world(world_with<D>(0));
  const BodyId pusher = add_body<D>(world, BodyType::kinematic, box_shape<D>(0.5f, 0.5f, 0.5f), at<D>(0, 0));
  const BodyId box = add_box<D>(world, at<D>(1.2, 0));
  for (int i = 1; i <= 60; ++i) {
    ASSERT_TRUE(world.set_target_pose(pusher, at<D>(i / 60.0, 0), {}, frame).ok());
    world.step(frame).value();
    EXPECT_NEAR(world.state(pusher).value().pose.position.x, i / 60.0, 1e-5);
  }
  EXPECT_GT(world.state(box).value().pose.position.x, 1.98);
}

}  // namespace
}  // namespace carom::rigid::test
