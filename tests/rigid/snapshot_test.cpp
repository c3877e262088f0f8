// Snapshots put a world back to the bit: warm starts, contact caches, timers, and whatever came and went in between.
#include <gtest/gtest.h>

#include <cstring>

#include "tests/rigid/furnished_world.h"

namespace carom::rigid::test {
namespace {

template <class D>
class SnapshotOf : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(SnapshotOf, Dimensions);

/// The hashes of the next steps.
template <class D>
std::vector<std::uint64_t> future(World<D>& world, int steps) {
  std::vector<std::uint64_t> hashes;
  for (int i = 0; i < steps; ++i) {
    world.step(frame).value();
    hashes.push_back(world.state_hash());
  }
  return hashes;
}
template <class D>
std::size_t count_events(const World<D>& world) {
  const Events<D> e = world.events();
  return e.contact_begin.size() + e.contact_end.size() + e.sensor_begin.size() + e.sensor_end.size();
}

TYPED_TEST(SnapshotOf, AWorldGoesOnWithTheSameBits) {
  using D = TypeParam;
  for (const int threads : {1, 2}) {
    WorldDef<D> d = world_with<D>();
    d.threads = threads;
    World<D> world(d);
    furnish(world);
    for (const int when : {0, 1, 20, 60, 150}) {
      while (int(world.step_count()) < when) world.step(frame).value();
      const Snapshot<D> before = world.snapshot();
      const std::uint64_t hash = world.state_hash();
      const std::vector<std::uint64_t> once = future(world, 90);
      ASSERT_TRUE(world.restore(before).ok());
      EXPECT_EQ(world.state_hash(), hash);
      EXPECT_EQ(int(world.step_count()), when);
      EXPECT_EQ(count_events(world), 0u);
      EXPECT_EQ(future(world, 90), once) << "from step " << when;
      ASSERT_TRUE(world.restore(before).ok());
    }
  }
}

// What is restored has no watches on its pairs: every one is looked at. Planks roll, tip and are hit while they lie on
// each other, where what is kept of a pair goes by how far its surfaces moved.
TYPED_TEST(SnapshotOf, AWorldThatIsRestoredAtEveryStepGoesOnWithTheSameBits) {
  using D = TypeParam;
  World<D> world(world_with<D>()), restored(world_with<D>());
  for (World<D>* w : {&world, &restored}) {
    add_ground(*w);
    for (int i = 0; i < 160; ++i) {
      typename D::Position position = at<D>(0.5 * (i % 4), 0.3 + 0.2 * (i / 4) + 0.05 * (i % 3));
      const Vec3f half{0.06f + 0.02f * float(i % 5), 0.2f + 0.07f * float(i % 7), 0.05f + 0.03f * float(i % 6)};
      typename D::Shape plank = box_shape<D>(half.x, half.y, half.z);
      if constexpr (D::dimension == 3) {
        position.z = 0.5 * (i / 2 % 3);
        std::vector<Vec3f> corners;
        for (int k = 0; k < 8; ++k)
          corners.push_back({k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z});
        plank = geometry::make_hull(corners).value();
      }
      add_body<D>(*w, BodyType::dynamic, plank, position, {0.5f, 0, 600, 0});
    }
    for (int i = 0; i < 4; ++i) add_ball(*w, at<D>(-9 - 12 * i, 2 + 9 * i), 0.4f, {0.5f, 0, 4000, 0}, along<D>(12, 0));
  }
  for (int i = 0; i < 300; ++i) {
    ASSERT_TRUE(restored.restore(restored.snapshot()).ok());
    run(world, 1), run(restored, 1);
    ASSERT_EQ(restored.state_hash(), world.state_hash()) << "step " << i;
  }
}

TYPED_TEST(SnapshotOf, AWorldBeforeBodiesCameWentAndChanged) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const std::vector<BodyId> bodies = furnish(world);
  run(world, 30);
  const Snapshot<D> before = world.snapshot();
  const Counters counters = world.counters();
  const std::vector<std::uint64_t> once = future(world, 60);

  ASSERT_TRUE(world.restore(before).ok());
  // All that a game may do in between.
  for (std::size_t i = 0; i < bodies.size(); i += 3) ASSERT_TRUE(world.destroy_body(bodies[i]).ok());
  std::vector<BodyId> guests;
  for (int i = 0; i < 12; ++i) guests.push_back(add_ball(world, at<D>(i, 7), 0.3f));
  HingeJointDef<D> joint;
  joint.body_a = guests[0];
  joint.body_b = guests[1];
  const JointId guest_joint = world.create_joint(joint).value();
  ASSERT_TRUE(world.set_gravity(along<D>(1, -3)).ok());
  ASSERT_TRUE(world.set_type(bodies[1], BodyType::kinematic).ok());
  ASSERT_TRUE(world.set_locks(bodies[4], {.x = true}).ok());
  std::vector<EffectorId> effectors;
  world.effectors(effectors);
  for (const EffectorId e : effectors) ASSERT_TRUE(world.destroy_effector(e).ok());
  run(world, 40);

  ASSERT_TRUE(world.restore(before).ok());
  EXPECT_EQ(world.counters().bodies, counters.bodies);
  EXPECT_EQ(world.counters().shapes, counters.shapes);
  EXPECT_EQ(world.counters().joints, counters.joints);
  EXPECT_EQ(world.counters().effectors, counters.effectors);
  EXPECT_EQ(world.counters().contacts, counters.contacts);
  for (const BodyId guest : guests) EXPECT_FALSE(world.contains(guest));
  EXPECT_FALSE(world.contains(guest_joint));
  for (const BodyId body : bodies) EXPECT_TRUE(world.contains(body));
  EXPECT_EQ(world.definition().gravity, along<D>(0, -9.81f));
  EXPECT_EQ(world.body_definition(bodies[bodies.size() - (D::dimension == 3 ? 3 : 2)]).value().name, "bullet");
  EXPECT_EQ(future(world, 60), once);
}

// The same calls after a restore give the same handles: lockstep peers need no table of names.
TYPED_TEST(SnapshotOf, HandlesAreGivenOutAsBefore) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const std::vector<BodyId> bodies = furnish(world);
  ASSERT_TRUE(world.destroy_body(bodies[2]).ok());
  const Snapshot<D> before = world.snapshot();
  const BodyId first = add_box<D>(world, at<D>(0, 20));
  ASSERT_TRUE(world.restore(before).ok());
  EXPECT_EQ(add_box<D>(world, at<D>(3, 20)), first);
}

TYPED_TEST(SnapshotOf, SleepersAndTheirTimers) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const std::vector<BodyId> pyramid = add_pyramid(world, 5);
  run(world, 25);
  const Snapshot<D> drowsy = world.snapshot();  // timers half way
  run(world, 95);
  ASSERT_EQ(world.counters().awake_bodies, 0);
  const Snapshot<D> asleep = world.snapshot();
  const auto push = [&] { ASSERT_TRUE(world.add_impulse(pyramid[0], along<D>(3000, 0)).ok()); };
  push();
  const std::vector<std::uint64_t> woken = future(world, 60);
  ASSERT_TRUE(world.restore(drowsy).ok());
  run(world, 95);
  EXPECT_EQ(world.counters().awake_bodies, 0);
  push();
  EXPECT_EQ(future(world, 60), woken);
  ASSERT_TRUE(world.restore(asleep).ok());
  EXPECT_EQ(world.counters().awake_bodies, 0);
  push();
  EXPECT_EQ(future(world, 60), woken);
}

TYPED_TEST(SnapshotOf, EndsThatWaitForTheNextStepAreKept) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const BodyId box = add_box<D>(world, at<D>(0, 0.5));
  run(world, 10);
  ASSERT_TRUE(world.destroy_body(box).ok());
  const Snapshot<D> before = world.snapshot();
  run(world, 2);
  ASSERT_TRUE(world.restore(before).ok());
  world.step(frame).value();
  EXPECT_EQ(world.events().contact_end.size(), 1u);
}

// Another world, as in another process: it goes on as the first one does, with its own threads and width.
TYPED_TEST(SnapshotOf, AWorldGoesIntoAnother) {
  using D = TypeParam;
  World<D> first(world_with<D>());
  furnish(first);
  run(first, 45);
  const Snapshot<D> before = first.snapshot();
  WorldDef<D> d = world_with<D>(3);
  d.threads = 2;
  d.simd_width = 4;
  World<D> second(d);
  add_heap(second, 2);
  run(second, 5);
  ASSERT_TRUE(second.restore(before).ok());
  EXPECT_EQ(second.definition().threads, 2);
  EXPECT_EQ(second.definition().simd_width, 4);
  std::vector<BodyId> bodies;
  second.bodies(bodies);
  for (const BodyId body : bodies) EXPECT_TRUE(second.contains(body) && !first.contains(body));
  std::vector<JointId> joints;
  second.joints(joints);
  ASSERT_FALSE(joints.empty());
  for (const JointId joint : joints) EXPECT_TRUE(second.contains(second.joint_state(joint).value().body_b));
  EXPECT_EQ(future(second, 60), future(first, 60));
  ASSERT_TRUE(second.destroy_body(bodies[3]).ok());  // effectors and joints find their bodies by the new handles
}

TYPED_TEST(SnapshotOf, BytesGoThereAndBack) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  furnish(world);
  run(world, 40);
  const Snapshot<D> base = world.snapshot();
  const std::vector<std::byte> whole = base.encode();
  run(world, 3);
  const Snapshot<D> later = world.snapshot();
  const std::vector<std::byte> step = later.encode(base);
  EXPECT_LT(step.size(), whole.size() / 2);
  const std::vector<std::uint64_t> once = future(world, 60);

  // Here: the base from its bytes, then the difference.
  const auto decoded = Snapshot<D>::decode(whole);
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  EXPECT_EQ(decoded->digest(), base.digest());
  const auto advanced = Snapshot<D>::decode(step, *decoded);
  ASSERT_TRUE(advanced.ok()) << advanced.error().message;
  EXPECT_EQ(advanced->digest(), later.digest());
  const Status restored = world.restore(*advanced);
  ASSERT_TRUE(restored.ok()) << restored.error().message;
  EXPECT_EQ(future(world, 60), once);

  // There: a world that has the same hulls and meshes, by whatever way it came by them.
  World<D> other(world_with<D>());
  furnish(other);
  ASSERT_TRUE(other.restore(*advanced).ok());
  EXPECT_EQ(future(other, 60), once);
}

TYPED_TEST(SnapshotOf, ADifferenceCarriesWhatCameAndWent) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  const std::vector<BodyId> bodies = furnish(world);
  run(world, 20);
  const Snapshot<D> base = world.snapshot();
  for (std::size_t i = 1; i < bodies.size(); i += 4) ASSERT_TRUE(world.destroy_body(bodies[i]).ok());
  for (int i = 0; i < 40; ++i) add_box<D>(world, at<D>(i, 11), 0.3f);
  LinearDrag<D> drag;
  drag.body = bodies[0];
  drag.coefficient = 5;
  world.add_effector(drag).value();
  run(world, 5);
  const Snapshot<D> later = world.snapshot();
  const auto decoded = Snapshot<D>::decode(later.encode(base), base);
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  const std::vector<std::uint64_t> once = future(world, 40);
  ASSERT_TRUE(world.restore(*decoded).ok());
  EXPECT_EQ(future(world, 40), once);
}

// What the caller wrote himself is not in the bytes; the world that restores them supplies it.
TYPED_TEST(SnapshotOf, FunctionsOfTheCallerStay) {
  using D = TypeParam;
  const auto furnish_with_function = [](World<D>& world) {
    add_ground(world);
    add_heap(world, 2);
    CustomEffector<D> lift;
    lift.model = [](const EffectorInput<D>& in) { return Wrench<D>{along<D>(0, 3 * in.state.mass), {}}; };
    return world.add_effector(lift).value();
  };
  World<D> world(world_with<D>());
  const EffectorId lift = furnish_with_function(world);
  run(world, 10);
  const Snapshot<D> direct = world.snapshot();
  const std::vector<std::byte> bytes = direct.encode();
  const std::vector<std::uint64_t> once = future(world, 40);
  const auto decoded = Snapshot<D>::decode(bytes);
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  ASSERT_TRUE(world.restore(*decoded).ok());
  EXPECT_EQ(future(world, 40), once);
  ASSERT_TRUE(world.destroy_effector(lift).ok());
  const std::uint64_t hash = world.state_hash();
  const Status refused = world.restore(*decoded);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().message.find("function"), std::string::npos) << refused.error().message;
  EXPECT_EQ(world.state_hash(), hash);
  ASSERT_TRUE(world.restore(direct).ok());  // in the process the function itself was kept
  EXPECT_EQ(future(world, 40), once);
}

// Every refusal says why, and the world stays as it was.
TYPED_TEST(SnapshotOf, WhatIsBrokenOrForeignIsRefused) {
  using D = TypeParam;
  using Other = std::conditional_t<D::dimension == 2, Dim3, Dim2>;
  World<D> world(world_with<D>());
  furnish(world);
  run(world, 10);
  const Snapshot<D> base = world.snapshot();
  run(world, 2);
  const Snapshot<D> later = world.snapshot();
  const std::vector<std::byte> whole = base.encode(), step = later.encode(base);
  const auto says = [](const auto& result, std::string_view part) {
    if (result.ok()) return false;
    const bool found = result.error().message.find(part) != std::string::npos;
    if (!found) ADD_FAILURE() << result.error().message << " does not say " << part;
    return found;
  };
  EXPECT_TRUE(says(Snapshot<D>::decode({}), "expected a snapshot"));
  EXPECT_TRUE(says(Snapshot<D>::decode(std::vector<std::byte>(100)), "does not begin"));
  EXPECT_TRUE(says(Snapshot<Other>::decode(whole), "dimension"));
  EXPECT_TRUE(says(Snapshot<D>::decode(step), "another base"));
  EXPECT_TRUE(says(Snapshot<D>::decode(step, later), "another base"));
  EXPECT_TRUE(says(Snapshot<D>::decode(whole, base), "whole snapshot"));
  EXPECT_TRUE(says(world.restore(Snapshot<D>{}), "empty"));
  for (std::size_t length = 0; length < whole.size(); length += 1 + whole.size() / 97)
    EXPECT_FALSE(Snapshot<D>::decode(std::span(whole).first(length)).ok()) << length;
  std::uint32_t r = 1;
  for (int i = 0; i < 300; ++i) {
    r = 1664525u * r + 1013904223u;
    std::vector<std::byte> bad = i % 2 == 0 ? whole : step;
    bad[r % bad.size()] ^= std::byte(1u << (r >> 20) % 8);
    EXPECT_FALSE(Snapshot<D>::decode(bad, i % 2 == 0 ? Snapshot<D>{} : base).ok()) << i;
  }
  // A world without the meshes and hulls that the snapshot shares.
  World<D> bare(world_with<D>());
  add_heap(bare, 1);
  const std::uint64_t hash = bare.state_hash();
  EXPECT_TRUE(says(bare.restore(Snapshot<D>::decode(whole).value()), "fingerprint"));
  EXPECT_EQ(bare.state_hash(), hash);
}

}  // namespace
}  // namespace carom::rigid::test
