// Bodies whose own time goes slower or faster than the world's (BodyDef::time_scale).
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class TimeScale : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(TimeScale, Dimensions);

template <class D>
BodyId add_paced_ball(World<D>& world, typename D::Position position, float pace, const Surface& surface = {},
                      typename D::Vector velocity = {}) {
  const BodyId ball = add_ball<D>(world, position, 0.2f, surface, velocity);
  world.set_time_scale(ball, pace).value();
  return ball;
}

// y = ½ g (s t)², v = s · g (s t); a thrown one keeps its parabola when its clock changes on the way.
TYPED_TEST(TimeScale, FallsInItsOwnTime) {
  using D = TypeParam;
  World<D> world(world_with<D>(10));
  const float paces[] = {0.1f, 0.5f, 1, 3};
  BodyId balls[4];
  for (int i = 0; i < 4; ++i) balls[i] = add_paced_ball<D>(world, at<D>(3.0 * i, 0), paces[i]);
  run(world, 60);
  for (int i = 0; i < 4; ++i) {
    const auto state = state_of(world, balls[i]);
    const double own = double(paces[i]) * 60 * double(frame);
    EXPECT_NEAR(state.pose.position.y, -5 * own * own, 2e-4 * own * own) << paces[i];
    EXPECT_NEAR(state.linear_velocity.y, -10 * own * double(paces[i]), 1e-4 * own) << paces[i];
  }
}

TYPED_TEST(TimeScale, ItsPathStaysWhenTheClockChanges) {
  using D = TypeParam;
  World<D> world(world_with<D>(10));
  BodyDef<D> def;
  def.linear_velocity = along<D>(4, 6);
  def.angular_velocity = about_z<D>(2);
  const BodyId ball = world.create_body(def).value();
  world.add_shape(ball, ball_shape<D>(0.1f), ShapeDef<D>{}).value();
  double own = 0;
  for (int i = 0; i < 240; ++i) {
    const float pace = i < 60 ? 1 : i < 180 ? 0.25f : 2;
    if (i == 60 || i == 180) world.set_time_scale(ball, pace).value();
    world.step(frame).value();
    own += double(pace) * double(frame);
    const auto state = state_of(world, ball);
    ASSERT_NEAR(state.pose.position.x, 4 * own, 1e-4 * (1 + own)) << i;
    ASSERT_NEAR(state.pose.position.y, 6 * own - 5 * own * own, 1e-4 * (1 + own * own)) << i;
    ASSERT_NEAR(z_of(state.angular_velocity), 2 * pace, 1e-5) << i;
  }
}

// T = 2π/s √(l/g) (1 + φ²/16), and the energy stays.
TYPED_TEST(TimeScale, APendulumSwingsInItsOwnTime) {
  using D = TypeParam;
  World<D> world(world_with<D>(10));
  const float pace = 0.5f;
  BodyDef<D> def;
  def.position = at<D>(0.1, -0.99498743710662);
  def.time_scale = pace;
  const BodyId bob = add_mass<D>(world, def, 1, 1e-4);
  DistanceJointDef<D> rod;
  rod.body_a = world.create_body({.type = BodyType::fixed}).value();
  rod.body_b = bob;
  rod.length = 1;
  world.create_joint(rod).value();
  const double energy = world.totals().kinetic_energy + world.totals().potential_energy;
  double first = -1, last = 0, before = 0.1;
  int turns = 0;
  for (int i = 0; i < 1200; ++i) {
    world.step(frame).value();
    const double x = state_of(world, bob).pose.position.x;
    if (before > 0 && x <= 0) {
      last = world.time() - x / (x - before) * double(frame);
      if (first < 0)
        first = last;
      else
        ++turns;
    }
    before = x;
  }
  ASSERT_GT(turns, 3);
  EXPECT_NEAR((last - first) / turns, 2 * math::pi / 0.5 * math::sqrt(0.1) * (1 + 0.01 / 16), 0.004 * 4);
  EXPECT_NEAR(world.totals().kinetic_energy + world.totals().potential_energy, energy, 0.05 * 0.05 * 0.25);
}

TYPED_TEST(TimeScale, BouncesAsHighAndSlidesAsFarAsOthers) {
  using D = TypeParam;
  World<D> world(world_with<D>(10));
  add_ground(world, {0.3f, 0, 1000, 0});
  const Surface bouncy{0, 0.8f, 1000, 0};
  for (const float pace : {0.25f, 1.0f}) {
    // From 2 m to .64 × 2 m: a fall of √(2·2/10) s and a rise of .8 of that, in its own time.
    const BodyId ball = add_paced_ball<D>(world, at<D>(pace < 1 ? -20 : 20, 2.2), pace, bouncy);
    const BodyId crate = add_box<D>(world, at<D>(pace < 1 ? -60 : 60, 0.5), 0.5f, {0.3f, 0, 1000, 0});
    world.set_time_scale(crate, pace).value();
    world.set_velocity(crate, along<D>(4 * pace, 0), {}).value();
    const double start = state_of(world, crate).pose.position.x;
    double top = 0, lowest = 9, resting = 0;
    const double fall = math::sqrt(0.4) / double(pace);
    for (double t = 0; t < 2 / double(pace); t += double(frame)) {
      world.step(frame).value();
      const double y = state_of(world, ball).pose.position.y - 0.2;
      if (t > fall && t < 2.6 * fall) top = std::max(top, y);
      lowest = std::min(lowest, y);
      resting = state_of(world, crate).pose.position.x - start;
    }
    EXPECT_NEAR(top, 1.28, 0.02) << pace;
    EXPECT_GT(lowest, -0.01) << pace;
    EXPECT_NEAR(resting, 16 / (2 * 0.3 * 10), 0.03) << pace;
  }
}

// m ẍ = −k x swings with s f; a drag brings the speed to s of the terminal one; damping takes e^(−c s t).
TYPED_TEST(TimeScale, SpringsDragAndDampingGoAlong) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const float pace = 0.2f;
  BodyDef<D> def;
  def.time_scale = pace;
  def.position = at<D>(1, 0);
  const BodyId swing = add_mass<D>(world, def, 2, 1);
  SpringDamper<D> spring;
  spring.body_a = swing;
  spring.point_b = at<D>(0, 0);
  spring.stiffness = 2 * 4 * float(math::pi * math::pi);  // 1 Hz
  world.add_effector(spring).value();
  def.position = at<D>(0, 9);
  def.linear_damping = 0.7f;
  def.linear_velocity = along<D>(1, 0);
  const BodyId damped = add_mass<D>(world, def, 2, 1);
  def.position = at<D>(0, -9);
  def.linear_damping = 0;
  def.linear_velocity = {};
  const BodyId driven = add_mass<D>(world, def, 2, 1);
  LinearDrag<D> drag;
  drag.body = driven;
  drag.coefficient = 8;
  world.add_effector(drag).value();
  Thrust<D> thrust;
  thrust.body = driven;
  thrust.force = along<D>(24, 0);
  world.add_effector(thrust).value();
  run(world, 300);  // 5 s: one own second, one turn
  EXPECT_NEAR(state_of(world, swing).pose.position.x, 1, 0.01);
  EXPECT_NEAR(state_of(world, damped).linear_velocity.x, math::exp(-0.7), 2e-3);
  EXPECT_NEAR(state_of(world, driven).linear_velocity.x, 0.2 * 3 * (1 - math::exp(-4.0)), 2e-3);
}

TYPED_TEST(TimeScale, ASlowOneDoesNotSleepInTheAir) {
  using D = TypeParam;
  World<D> world(world_with<D>(10));
  add_ground(world);
  const BodyId ball = add_paced_ball<D>(world, at<D>(0, 3), 0.01f);
  run(world, 300);
  EXPECT_TRUE(state_of(world, ball).awake);
  const BodyId quick = add_paced_ball<D>(world, at<D>(9, 0.2), 4);
  run(world, 30);
  EXPECT_FALSE(state_of(world, quick).awake) << "rests for two of its own seconds";
}

// Different clocks in one island: nothing runs away, what stands goes on standing.
TYPED_TEST(TimeScale, StacksAndChainsOfManyClocksStayWhole) {
  using D = TypeParam;
  WorldDef<D> definition = world_with<D>(10);
  definition.allow_sleep = false;
  World<D> world(definition);
  add_ground(world);
  const float paces[] = {1, 0.05f, 2, 0.3f, 4, 1, 0.01f, 0.7f};
  std::vector<BodyId> stack, chain;
  BodyId last = add_body<D>(world, BodyType::fixed, box_shape<D>(0.1f, 0.1f, 0.1f), at<D>(30, 20));
  for (int i = 0; i < 8; ++i) {
    stack.push_back(add_box<D>(world, at<D>(0, 0.5 + i)));
    world.set_time_scale(stack.back(), paces[i]).value();
    chain.push_back(add_box<D>(world, at<D>(31.0 + i, 20), 0.25f));
    world.set_time_scale(chain.back(), paces[i]).value();
    BallJointDef<D> joint;
    joint.body_a = last;
    joint.body_b = chain.back();
    joint.frame_a.p = along<D>(0.5f, 0);
    joint.frame_b.p = along<D>(-0.5f, 0);
    world.create_joint(joint).value();
    last = chain.back();
  }
  double gap = 0, fastest = 0;
  for (int i = 0; i < 900; ++i) {
    world.step(frame).value();
    typename D::Position end = at<D>(30.5, 20);
    for (const BodyId link : chain) {
      const auto state = state_of(world, link);
      using P = typename D::Position;
      gap = std::max(
          gap, double(math::length(state.pose.position + P(rotate(state.pose.rotation, along<D>(-0.5f, 0))) - end)));
      end = state.pose.position + P(rotate(state.pose.rotation, along<D>(0.5f, 0)));
      fastest = std::max(fastest, double(math::length(state.linear_velocity)));
    }
  }
  EXPECT_LT(gap, 0.05);
  EXPECT_LT(fastest, 4 * math::sqrt(2 * 10 * 16.0)) << "of the fastest clock, from all its height";
  for (int i = 0; i < 8; ++i) {
    const auto state = state_of(world, stack[std::size_t(i)]);
    EXPECT_NEAR(state.pose.position.x, 0, 0.02) << i;
    EXPECT_NEAR(state.pose.position.y, 0.5 + i, 0.02 * (i + 1)) << i;
    EXPECT_LT(math::length(state.linear_velocity), 2e-3) << i;
  }
}

// Blows exchange momentum in the world's time, whatever the clocks say.
TYPED_TEST(TimeScale, BlowsKeepMomentum) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const Surface bouncy{0, 1, 1000, 0};
  const BodyId slow = add_paced_ball<D>(world, at<D>(0, 0), 0.1f, bouncy);
  const BodyId ball = add_paced_ball<D>(world, at<D>(-3, 0), 1, bouncy, along<D>(5, 0));
  run(world, 60);
  EXPECT_NEAR(state_of(world, slow).linear_velocity.x, 5, 1e-3);
  EXPECT_NEAR(state_of(world, ball).linear_velocity.x, 0, 1e-3);
}

TYPED_TEST(TimeScale, SnapshotsHoldTheClocks) {
  using D = TypeParam;
  World<D> world(world_with<D>()), other(world_with<D>());
  add_ground(world);
  const std::vector<BodyId> heap = add_heap(world, 3);
  for (std::size_t i = 0; i < heap.size(); i += 3) world.set_time_scale(heap[i], 0.3f + 0.2f * float(i % 5)).value();
  run(world, 40);
  const auto bytes = world.snapshot().encode();
  run(world, 40);
  const std::uint64_t hash = world.state_hash();
  const auto decoded = Snapshot<D>::decode(bytes);
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  ASSERT_TRUE(other.restore(*decoded).ok());
  run(other, 40);
  EXPECT_EQ(other.state_hash(), hash);
  for (const BodyId id : heap) world.set_time_scale(id, 1).value();
  EXPECT_EQ(world.body_definition(heap[0]).value().time_scale, 1);
}

TYPED_TEST(TimeScale, ANewBodyInAnOldSlotHasTheWorldsClock) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId slow = add_paced_ball<D>(world, at<D>(0, 0), 0.1f);
  ASSERT_TRUE(world.destroy_body(slow).ok());
  EXPECT_EQ(world.body_definition(add_ball<D>(world, at<D>(0, 0), 0.2f)).value().time_scale, 1);
  BodyDef<D> def;
  for (const float bad : {0.0f, -1.0f, 2e3f}) {
    def.time_scale = bad;
    const auto refused = world.create_body(def);
    ASSERT_FALSE(refused.ok());
    EXPECT_NE(refused.error().message.find("time_scale"), std::string::npos) << refused.error().message;
  }
}

}  // namespace
}  // namespace carom::rigid::test
