// What the adviser says before the first step is what comes.
#include "carom/rigid/advice.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace advice_test {

template <class D>
class Advised : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Advised, Dimensions);

constexpr AdviceOptions everything{0, 0, 16};
template <class D>
const Advice* find(const std::vector<Advice>& all, AdviceKind kind) {
  for (const Advice& a : all)
    if (a.kind == kind) return &a;
  return nullptr;
}

TYPED_TEST(Advised, SagOfStacks) {
  using D = TypeParam;
  for (const int n : {2, 6, 9, 20}) {
    WorldDef<D> d = world_with<D>();
    d.allow_sleep = false;
    World<D> world(d);
    add_ground(world);
    BodyId top{};
    for (int i = 0; i < n; ++i) top = add_box<D>(world, at<D>(0, 0.5 + i));
    const std::vector<Advice> all = advise(world, frame, everything);
    const Advice* sag = find<D>(all, AdviceKind::sag);
    ASSERT_NE(sag, nullptr);
    EXPECT_EQ(sag->body, top);
    run(world, 600);
    const double measured = n - 0.5 - world.state(top).value().pose.position.y;
    EXPECT_NEAR(sag->predicted, measured, 0.15 * measured) << n << " boxes";
  }
}

TYPED_TEST(Advised, MoreSubstepsCureTheSagAsSaid) {
  using D = TypeParam;
  const auto stack = [](int substeps, float hertz) {
    WorldDef<D> d = world_with<D>();
    d.allow_sleep = false;
    d.substeps = substeps;
    d.contact_hertz = hertz;
    auto world = std::make_unique<World<D>>(d);
    add_ground(*world);
    for (int i = 0; i < 8; ++i) add_box<D>(*world, at<D>(0, 0.5 + i));
    return world;
  };
  const AdviceOptions options{0.0004, 0.01, 16};
  const std::vector<Advice> all = advise(*stack(4, 36), frame, options);
  const Advice* sag = find<D>(all, AdviceKind::sag);
  ASSERT_NE(sag, nullptr);
  ASSERT_GT(sag->substeps, 4);
  auto cured = stack(sag->substeps, float(36 * std::sqrt(sag->predicted / (0.0004 * 8))));
  std::vector<BodyId> bodies;
  cured->bodies(bodies);
  run(*cured, 600);
  EXPECT_LT(7.5 - cured->state(bodies.back()).value().pose.position.y, 1.15 * 0.0004 * 8);
}

TYPED_TEST(Advised, NothingToSayOfASoundWorld) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  add_pyramid(world, 5);
  add_ball<D>(world, at<D>(20, 3), 0.5f);
  EXPECT_TRUE(advise(world, frame).empty());
  EXPECT_TRUE(advise(World<D>(), frame).empty());
}

// The solver's mass of the light one follows the load: it stands, and sinks as foreseen.
TYPED_TEST(Advised, HeavyOnLight) {
  using D = TypeParam;
  for (const float ratio : {30.0f, 1000.0f}) {
    WorldDef<D> d = world_with<D>();
    d.allow_sleep = false;
    World<D> world(d);
    add_ground(world);
    add_box<D>(world, at<D>(0, 0.5), 0.5f, {0.6f, 0, 1, 0});
    const BodyId heavy = add_box<D>(world, at<D>(0, 1.5), 0.5f, {0.6f, 0, ratio, 0});
    EXPECT_TRUE(advise(world, frame).empty());
    const std::vector<Advice> all = advise(world, frame, everything);
    const Advice* sag = find<D>(all, AdviceKind::sag);
    ASSERT_NE(sag, nullptr);
    EXPECT_EQ(sag->body, heavy);
    run(world, 1200);
    const double measured = 1.5 - world.state(heavy).value().pose.position.y;
    EXPECT_NEAR(sag->predicted, measured, 0.2 * measured) << "1 : " << ratio;
  }
}

TYPED_TEST(Advised, MuchTooHeavyOnLight) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  add_box<D>(world, at<D>(0, 0.5), 0.5f, {0.6f, 0, 1, 0});
  const BodyId heavy = add_box<D>(world, at<D>(0, 1.5), 0.5f, {0.6f, 0, 1e9f, 0});
  const std::vector<Advice> all = advise(world, frame);
  const Advice* sag = find<D>(all, AdviceKind::sag);
  ASSERT_NE(sag, nullptr);
  EXPECT_EQ(sag->body, heavy);
  EXPECT_EQ(sag->substeps, 0) << "no substeps cure 1 : 10⁹";
  EXPECT_NE(sag->message.find("masses"), std::string::npos) << sag->message;
}

TYPED_TEST(Advised, SpringsThatTurnTooFarInASubstep) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  DistanceJointDef<D> joint;
  joint.body_b = add_mass<D>(world, 0, -1, 2, 1);
  joint.spring = {20, 0};
  world.create_joint(joint).value();
  EXPECT_EQ(find<D>(advise(world, frame), AdviceKind::stiff_spring), nullptr) << "2π 20/240 = .52 is exact";
  joint.spring = {60, 0};
  const JointId stiff = world.create_joint(joint).value();
  SpringDamper<D> spring;
  spring.body_a = joint.body_b;
  spring.stiffness = 2 * std::pow(2 * pi * 45, 2);
  world.add_effector(spring).value();
  const std::vector<Advice> all = advise(world, frame);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].joint, stiff);
  EXPECT_NEAR(all[0].predicted, 2 * pi * 60 / 240, 1e-6);
  EXPECT_EQ(all[0].substeps, 9) << "2π 60/(60 · 9) = .698";
  EXPECT_NEAR(all[1].predicted, 2 * pi * 45 / 240, 1e-4);
}

TYPED_TEST(Advised, CapsAndFastBodies) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  d.contact_hertz = 60;
  d.continuous = false;
  World<D> world(d);
  const BodyId ball = add_ball<D>(world, at<D>(0, 0), 0.1f, {}, along<D>(100, 0));
  const std::vector<Advice> all = advise(world, frame);
  ASSERT_EQ(all.size(), 2u);
  EXPECT_EQ(all[0].kind, AdviceKind::capped_stiffness);
  EXPECT_NEAR(all[0].predicted, 36, 1e-3);
  EXPECT_EQ(all[0].substeps, 7);
  EXPECT_EQ(all[1].kind, AdviceKind::fast_body);
  EXPECT_EQ(all[1].body, ball);
}

TYPED_TEST(Advised, StretchOfAHangingChain) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  d.allow_sleep = false;
  d.joint_solver = JointSolver::iterative;
  World<D> world(d);
  BodyId before{}, last{};
  const int n = 12;
  for (int i = 0; i < n; ++i) {
    last = add_mass<D>(world, 0, -0.5 - i, 2, 0.2);
    BallJointDef<D> joint;
    joint.body_a = before;
    joint.body_b = last;
    if (!before.is_null()) joint.frame_a.p = along<D>(0, -0.5f);
    joint.frame_b.p = along<D>(0, 0.5f);
    world.create_joint(joint).value();
    before = last;
  }
  const std::vector<Advice> all = advise(world, frame, everything);
  const Advice* stretch = find<D>(all, AdviceKind::stretch);
  ASSERT_NE(stretch, nullptr);
  EXPECT_EQ(stretch->body, last);
  run(world, 900);
  const double measured = -(n - 0.5) - world.state(last).value().pose.position.y;
  EXPECT_NEAR(stretch->predicted, measured, 0.15 * measured);
}

}  // namespace advice_test
}  // namespace carom::rigid::test
