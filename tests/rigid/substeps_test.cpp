// Islands with substeps of their own (BodyDef::substeps): they get steadier, and nobody else notices.
#include "carom/rigid/advice.h"
#include "scene_pieces.h"

namespace carom::rigid::test {
namespace substeps_test {

template <class D>
class Substeps : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Substeps, Dimensions);

template <class D>
WorldDef<D> awake() {
  WorldDef<D> d = world_with<D>();
  d.allow_sleep = false;
  return d;
}
template <class D>
std::vector<BodyId> add_stack(World<D>& world, double x, int count) {
  std::vector<BodyId> bodies;
  for (int i = 0; i < count; ++i) bodies.push_back(add_box<D>(world, at<D>(x, 0.5 + i)));
  return bodies;
}
template <class D>
double sag(const World<D>& world, const std::vector<BodyId>& stack) {
  return double(stack.size()) - 0.5 - state_of(world, stack.back()).pose.position.y;
}

TYPED_TEST(Substeps, OneStackIsStifferAndTheOtherIsAsBefore) {
  using D = TypeParam;
  World<D> plain(awake<D>()), mixed(awake<D>());
  add_ground(plain);
  add_ground(mixed);
  const auto stiff_before = add_stack(plain, -20, 20), other_before = add_stack(plain, 20, 20);
  const auto stiff = add_stack(mixed, -20, 20), other = add_stack(mixed, 20, 20);
  mixed.set_substeps(stiff[7], 16).value();
  for (int i = 0; i < 300; ++i) {
    plain.step(frame).value();
    mixed.step(frame).value();
  }
  // Frequency × 4: sag ÷ 16 where masses are their own; where they follow the load, which yields less in stiffer
  // contacts, somewhat less (computation.md, §3).
  EXPECT_LT(sag(mixed, stiff), sag(plain, stiff_before) / 4);
  EXPECT_GT(sag(mixed, stiff), sag(plain, stiff_before) / 25);
  for (std::size_t i = 0; i < other.size(); ++i) {
    const auto a = state_of(mixed, other[i]), b = state_of(plain, other_before[i]);
    ASSERT_EQ(a.pose.position, b.pose.position) << "to the bit, box " << i;
    ASSERT_EQ(a.linear_velocity, b.linear_velocity);
    ASSERT_EQ(a.angular_velocity, b.angular_velocity);
  }
}

TYPED_TEST(Substeps, BitsDoNotDependOnThreadsOrLanes) {
  using D = TypeParam;
  const auto hash = [](int threads, int width) {
    WorldDef<D> d = awake<D>();
    d.threads = threads;
    d.simd_width = width;
    World<D> world(d);
    add_ground(world);
    for (int i = 0; i < 24; ++i) {
      const auto stack = add_stack(world, 3.0 * i, 6);
      if (i % 3 > 0) world.set_substeps(stack[0], i % 3 == 1 ? 7 : 12).value();
      BallJointDef<D> joint;
      joint.body_a = stack[5];
      joint.body_b = add_box<D>(world, at<D>(3.0 * i + 1.2, 5.5), 0.2f);
      joint.frame_a.p = along<D>(0.7f, 0);
      joint.frame_b.p = along<D>(-0.5f, 0);
      joint.friction_torque = 20;
      world.create_joint(joint).value();
    }
    run(world, 60);
    return world.state_hash();
  };
  const std::uint64_t first = hash(1, 0);
  EXPECT_EQ(hash(2, 0), first);
  EXPECT_EQ(hash(1, 4), first);
  EXPECT_EQ(hash(1, 8), first);
}

TYPED_TEST(Substeps, ChainByIterationHoldsBetter) {
  using D = TypeParam;
  const auto gap = [](int substeps) {
    WorldDef<D> d = awake<D>();
    d.joint_solver = JointSolver::iterative;
    World<D> world(d);
    BodyId before{};
    for (int i = 0; i < 10; ++i) {
      BodyDef<D> def;
      def.position = at<D>(0, -0.5 - i);
      def.substeps = i == 9 ? substeps : 0;
      BallJointDef<D> joint;
      joint.body_a = before;
      joint.body_b = before = add_mass<D>(world, def, i == 9 ? 30 : 1, 0.1);
      joint.frame_a.p = along<D>(0, i == 0 ? 0 : -0.5f);
      joint.frame_b.p = along<D>(0, 0.5f);
      world.create_joint(joint).value();
    }
    run(world, 240);
    return double(world.worst_joint_error());
  };
  EXPECT_LT(gap(16), gap(0) / 5);
}

// A platform under both groups goes where its velocity takes it, and once a step.
TYPED_TEST(Substeps, KinematicBodiesMoveOnce) {
  using D = TypeParam;
  World<D> world(awake<D>());
  BodyDef<D> def;
  def.type = BodyType::kinematic;
  def.linear_velocity = along<D>(1, 0.5f);
  const BodyId lift = world.create_body(def).value();
  world.add_shape(lift, box_shape<D>(10, 0.5f, 10)).value();
  const BodyId a = add_box<D>(world, at<D>(-4, 1)), b = add_box<D>(world, at<D>(4, 1));
  world.set_substeps(a, 10).value();
  run(world, 120);
  const auto p = state_of(world, lift).pose.position;
  EXPECT_NEAR(p.x, 2, 1e-4);
  EXPECT_NEAR(p.y, 1, 1e-4);
  for (const BodyId box : {a, b}) {
    EXPECT_NEAR(state_of(world, box).pose.position.y, 2, 0.01);
    EXPECT_NEAR(state_of(world, box).linear_velocity.x, 1, 0.01f);
  }
}

TYPED_TEST(Substeps, JointsBreakInEveryGroup) {
  using D = TypeParam;
  World<D> world(awake<D>());
  std::vector<JointId> joints;
  for (int i = 0; i < 3; ++i) {
    BallJointDef<D> joint;
    joint.body_b = add_mass<D>(world, 5.0 * i, 0, 10, 1);
    joint.frame_a.p = along<D>(5.0f * float(i), 0);
    joint.break_force = 50;  // of 98 N
    joints.push_back(world.create_joint(joint).value());
    world.set_substeps(joint.body_b, 8 * i).value();
  }
  std::size_t told = 0;
  for (int i = 0; i < 5; ++i) {
    world.step(frame).value();
    told += world.events().joint_break.size();
  }
  EXPECT_EQ(told, 3u);
  for (const JointId joint : joints) EXPECT_FALSE(world.contains(joint));
}

TYPED_TEST(Substeps, GoThroughSnapshotsAndAreChecked) {
  using D = TypeParam;
  World<D> world(awake<D>());
  add_ground(world);
  const auto stack = add_stack(world, 0, 5);
  add_stack(world, 5, 5);
  world.set_substeps(stack[0], 9).value();
  EXPECT_EQ(world.body_definition(stack[0]).value().substeps, 9);
  run(world, 20);
  const Snapshot<D> before = world.snapshot();
  run(world, 20);
  const std::uint64_t hash = world.state_hash();
  world.restore(before).value();
  run(world, 20);
  EXPECT_EQ(world.state_hash(), hash);
  EXPECT_NE(world.set_substeps(stack[0], 65).error().message.find("substeps"), std::string::npos);
  BodyDef<D> bad;
  bad.substeps = -1;
  EXPECT_NE(world.create_body(bad).error().message.find("substeps"), std::string::npos);
}

TYPED_TEST(Substeps, TheAdviserChoosesThem) {
  using D = TypeParam;
  World<D> plain(awake<D>()), advised(awake<D>());
  add_ground(plain);
  add_ground(advised);
  const auto before = add_stack(plain, 0, 20), stack = add_stack(advised, 0, 20);
  const auto short_one = add_stack(advised, 20, 2);
  advised.step(frame).value();
  plain.step(frame).value();
  AdviceOptions options;
  options.sag_share = 0.0003;
  EXPECT_EQ(apply_advice<D>(advised, advise(advised, frame, options)), 1);
  EXPECT_EQ(advised.body_definition(short_one[1]).value().substeps, 0);
  run(plain, 300);
  run(advised, 300);
  EXPECT_GT(sag(plain, before), 0.01);
  // Half as much again is allowed: the forecast takes masses to follow the load at once.
  EXPECT_LT(sag(advised, stack), 1.5 * 0.0003 * 20) << "the share of the height that was asked for";
}

}  // namespace substeps_test
}  // namespace carom::rigid::test
