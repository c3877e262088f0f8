// What of a joint can change while it lives: targets, the most that a spring gives, lengths, and when it breaks.
#include <limits>
#include <string>

#include "mechanics_world.h"

namespace carom::rigid::test {
namespace joint_target_test {

constexpr float nan = std::numeric_limits<float>::quiet_NaN();

template <class D>
class JointTargets : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(JointTargets, Dimensions);

template <class D>
void run(World<D>& world, double seconds) {
  for (int i = 0; i < int(seconds * 60 + 0.5); ++i) world.step(frame).value();
}
template <class D, class Def>
Def on_ground(World<D>& world, BodyId body) {
  Def def;
  def.body_a = add_fixed(world);
  def.body_b = body;
  return def;
}

TYPED_TEST(JointTargets, HingeSliderAndPathGoWhereTheyAreToldNext) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId turning = add_mass(world, 0, 0, 1, 0.7), sliding = add_mass(world, 0, 0, 2, 0.7),
               bead = add_mass(world, 0, 0, 1, 1);
  auto hinge = on_ground<D, HingeJointDef<D>>(world, turning);
  auto slider = on_ground<D, SliderJointDef<D>>(world, sliding);
  auto path = on_ground<D, PathJointDef<D>>(world, bead);
  const typename D::Vector points[] = {vec<D>(0, 0), vec<D>(5, 0)};
  path.points = points;
  path.straight = true;
  hinge.spring = slider.spring = path.spring = {2, 1};
  const JointId h = world.create_joint(hinge).value(), s = world.create_joint(slider).value(),
                p = world.create_joint(path).value();
  for (const float target : {0.5f, 1.5f, 0.25f}) {
    world.set_spring_target(h, -target).value();
    world.set_spring_target(s, -2 * target).value();
    world.set_spring_target(p, 3 * target).value();
    run(world, 2);
    EXPECT_NEAR(angle_of(state_of(world, turning).pose.rotation), -target, 1e-3);
    EXPECT_NEAR(state_of(world, sliding).pose.position.x, -2 * target, 1e-3);
    EXPECT_NEAR(state_of(world, bead).pose.position.x, 3 * target, 1e-3);
  }
}

// Far from its target a stiff spring of limited force is a constant one: ½ (F/m) t², ½ (τ/I) t².
TYPED_TEST(JointTargets, ServosGiveNoMoreThanTheyMay) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId turning = add_mass(world, 0, 0, 1, 2), sliding = add_mass(world, 0, 0, 4, 0.7);
  auto hinge = on_ground<D, HingeJointDef<D>>(world, turning);
  auto slider = on_ground<D, SliderJointDef<D>>(world, sliding);
  hinge.spring = slider.spring = {20, 1};
  hinge.target_angle = 2;
  hinge.max_spring_torque = 1;
  slider.target_translation = 3;
  const JointId h = world.create_joint(hinge).value(), s = world.create_joint(slider).value();
  world.set_max_spring_force(s, 2).value();
  run(world, 1);
  EXPECT_NEAR(angle_of(state_of(world, turning).pose.rotation), 0.25, 0.0025);
  EXPECT_NEAR(state_of(world, sliding).pose.position.x, 0.25, 0.0025);
  EXPECT_NEAR(z_of(world.joint_state(h).value().torque), 1, 1e-3);
  EXPECT_NEAR(world.joint_state(s).value().force.x, 2, 1e-3);
  world.set_max_spring_force(h, 0).value();
  world.set_max_spring_force(s, 0).value();
  run(world, 1);
  EXPECT_NEAR(angle_of(state_of(world, turning).pose.rotation), 2, 1e-3) << "as much as it takes";
  EXPECT_NEAR(state_of(world, sliding).pose.position.x, 3, 1e-3);
}

// A beam that is held level by a servo: it stays while m g l is no more than the torque, and falls with
// (m g l − τ)/(I + m l²) where it is.
TYPED_TEST(JointTargets, AWeakServoGivesWay) {
  using D = TypeParam;
  WorldDef<D> def;
  def.gravity = vec<D>(0, -10);
  World<D> world(def);
  const BodyId beam = add_mass(world, 1, 0, 2, 0.5);
  auto hinge = on_ground<D, HingeJointDef<D>>(world, beam);
  hinge.frame_b.p = vec<D>(-1, 0);
  hinge.spring = {20, 1};
  hinge.max_spring_torque = 21;
  const JointId joint = world.create_joint(hinge).value();
  run(world, 3);
  EXPECT_NEAR(angle_of(state_of(world, beam).pose.rotation), 0, 2e-3);
  world.set_max_spring_force(joint, 15).value();
  run(world, 0.1);
  EXPECT_NEAR(z_of(state_of(world, beam).angular_velocity), -0.1 * 5 / 2.5, 0.01);
}

TYPED_TEST(JointTargets, BallSpringsTurnToTheirTarget) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId body = add_mass(world, 0, 0, 1, 0.7);
  auto ball = on_ground<D, BallJointDef<D>>(world, body);
  ball.spring = {2, 1};
  const JointId joint = world.create_joint(ball).value();
  const auto settles_at = [&](typename D::Rotation target) {
    world.set_target_rotation(joint, target).value();
    run(world, 2);
    const auto away = conjugate(target) * state_of(world, body).pose.rotation;
    if constexpr (D::dimension == 2)
      EXPECT_NEAR(away.s, 0, 1e-4);
    else
      EXPECT_NEAR(math::length(away.vector()), 0, 1e-4);
  };
  settles_at(turned<D>(0.8));
  settles_at(turned<D>(-2));
  if constexpr (D::dimension == 3) settles_at(normalize(Quatf{0.8f, 0.3f, -0.4f, 0.2f}));
  settles_at({});
}

TYPED_TEST(JointTargets, MotorJointsGoToAPoseInTheFrameOfA) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  BodyDef<D> turned_base;
  turned_base.type = BodyType::fixed;
  turned_base.rotation = turned<D>(pi / 2);
  MotorJointDef<D> def;
  def.body_a = world.create_body(turned_base).value();
  def.body_b = add_mass(world, 0, 0, 1, 0.7);
  def.target_position = vec<D>(1, 0);
  const JointId joint = world.create_joint(def).value();
  run(world, 3);
  EXPECT_NEAR(state_of(world, def.body_b).pose.position.y, 1, 1e-3);
  EXPECT_NEAR(angle_of(state_of(world, def.body_b).pose.rotation), pi / 2, 1e-3);
  EXPECT_NEAR(world.joint_state(joint).value().linear_error, 0, 1e-3);
  world.set_target_pose(joint, vec<D>(2, 3), turned<D>(-0.5)).value();
  EXPECT_NEAR(world.joint_state(joint).value().linear_error, math::sqrt(10.0), 1e-2);
  run(world, 3);
  EXPECT_NEAR(state_of(world, def.body_b).pose.position.x, -3, 2e-3);
  EXPECT_NEAR(state_of(world, def.body_b).pose.position.y, 2, 2e-3);
  EXPECT_NEAR(angle_of(state_of(world, def.body_b).pose.rotation), pi / 2 - 0.5, 1e-3);
}

// At F/m and τ/I up to the speeds that are wanted, and no further.
TYPED_TEST(JointTargets, MotorJointsDriveAtAVelocity) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId body = add_mass(world, 0, 0, 4, 0.5);
  auto def = on_ground<D, MotorJointDef<D>>(world, body);
  def.hold_position = def.hold_rotation = false;
  def.target_velocity = vec<D>(2, 0);
  def.target_spin = about_z<D>(3);
  def.max_force = 2;
  def.max_torque = 0.5f;
  const JointId joint = world.create_joint(def).value();
  run(world, 2);
  EXPECT_NEAR(state_of(world, body).linear_velocity.x, 1, 1e-3);
  EXPECT_NEAR(z_of(state_of(world, body).angular_velocity), 2, 1e-3);
  run(world, 3);
  EXPECT_NEAR(state_of(world, body).linear_velocity.x, 2, 1e-4);
  EXPECT_NEAR(z_of(state_of(world, body).angular_velocity), 3, 1e-4);
  world.set_target_velocity(joint, vec<D>(0, -1), {}).value();
  world.set_max_force(joint, 1e4f, 1e4f).value();
  run(world, 0.1);
  EXPECT_NEAR(state_of(world, body).linear_velocity.y, -1, 1e-4);
  EXPECT_NEAR(z_of(state_of(world, body).angular_velocity), 0, 1e-4);
  world.set_hold(joint, true, true).value();
  run(world, 4);
  EXPECT_NEAR(math::length(Vec2d{state_of(world, body).pose.position.x, state_of(world, body).pose.position.y}),
              2 / (2 * pi * 2), 1e-3)
      << "the spring's damper pulls on at −1 m/s: x = 2ζv/ω";
}

// Its velocity is that which A sees: with none, B goes round with a turntable.
TYPED_TEST(JointTargets, VelocityIsThatInTheTurningFrame) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  BodyDef<D> table;
  table.type = BodyType::kinematic;
  table.angular_velocity = about_z<D>(2);
  MotorJointDef<D> def;
  def.body_a = world.create_body(table).value();
  def.body_b = add_mass(world, 1, 0, 1, 0.2);
  def.hold_position = def.hold_rotation = false;
  def.max_force = def.max_torque = 1e5f;
  const JointId joint = world.create_joint(def).value();
  run(world, 1);
  EXPECT_NEAR(math::length(state_of(world, def.body_b).linear_velocity), 2, 0.04);
  EXPECT_NEAR(angle_of(state_of(world, def.body_b).pose.rotation), 2, 0.05);
  world.set_target_velocity(joint, vec<D>(1, 0), {}).value();  // outward, where B was on A's x axis
  run(world, 1);
  const auto p = state_of(world, def.body_b).pose.position;
  EXPECT_NEAR(math::sqrt(p.x * p.x + p.y * p.y), 2, 0.06);
}

// A spring lags 2ζv/ω behind a target that moves at v, unless it is told of v.
TYPED_TEST(JointTargets, ATargetThatMovesIsFollowedWithoutLag) {
  using D = TypeParam;
  for (const bool told : {false, true}) {
    World<D> world(weightless<D>());
    const BodyId body = add_mass(world, 0, 0, 1, 0.7);
    const JointId joint = world.create_joint(on_ground<D, MotorJointDef<D>>(world, body)).value();
    if (told) world.set_target_velocity(joint, vec<D>(1, 0), {}).value();
    double target = 0;
    for (int i = 0; i < 180; ++i) {
      target += double(frame);
      world.set_target_pose(joint, vec<D>(float(target), 0), {}).value();
      world.step(frame).value();
    }
    EXPECT_NEAR(target - state_of(world, body).pose.position.x, told ? 0 : 2 / (2 * pi * 2), double(frame)) << told;
  }
}

TYPED_TEST(JointTargets, LengthsFrictionAndBreakForces) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId far = add_mass(world, 2, 0, 1, 1), spinning = add_mass(world, 0, 0, 1, 0.5);
  auto rod = on_ground<D, DistanceJointDef<D>>(world, far);
  rod.length = 2;
  const JointId r = world.create_joint(rod).value();
  auto ball = on_ground<D, BallJointDef<D>>(world, spinning);
  const JointId b = world.create_joint(ball).value();
  world.set_length(r, 2.5f).value();
  world.set_velocity(spinning, {}, about_z<D>(4)).value();
  run(world, 1);
  EXPECT_NEAR(state_of(world, far).pose.position.x, 2.5, 1e-3);
  EXPECT_NEAR(z_of(state_of(world, spinning).angular_velocity), 4, 1e-4);
  world.set_friction(b, 1).value();
  run(world, 1);
  EXPECT_NEAR(z_of(state_of(world, spinning).angular_velocity), 2, 0.01) << "ω − τ t/I";
  run(world, 1.5);
  EXPECT_NEAR(z_of(state_of(world, spinning).angular_velocity), 0, 1e-5);

  world.set_break_force(r, 3, 0).value();
  world.set_gravity(vec<D>(2, 0)).value();
  run(world, 0.5);
  ASSERT_TRUE(world.contains(r)) << "2 N hold";
  world.set_break_force(r, 1, 0).value();
  run(world, 0.1);
  EXPECT_FALSE(world.contains(r));
}

TEST(JointTargets3, AConeThatClosesPushesBack) {
  World3 world(weightless<Dim3>());
  const BodyId body = add_mass(world, 0, 0, 1, 0.5);
  auto ball = on_ground<Dim3, BallJointDef<Dim3>>(world, body);
  const JointId joint = world.create_joint(ball).value();
  world.set_pose(body, {}, {math::cos(0.4f), math::sin(0.4f), 0, 0}).value();
  EXPECT_NEAR(world.joint_state(joint).value().coordinate, 0.8, 1e-4);
  world.set_cone_angle(joint, 0.5f).value();
  run(world, 2);
  EXPECT_LT(world.joint_state(joint).value().coordinate, 0.505f);
  world.set_cone_angle(joint, -1).value();
  EXPECT_EQ(std::get<BallJointDef<Dim3>>(world.joint_definition(joint).value()).cone_angle, -1);
}

TYPED_TEST(JointTargets, WhatStaysAsItIsWakesNobody) {
  using D = TypeParam;
  WorldDef<D> def = weightless<D>();
  def.allow_sleep = true;
  World<D> world(def);
  const BodyId body = add_mass(world, 0, 0, 1, 0.7);
  auto hinge = on_ground<D, HingeJointDef<D>>(world, body);
  hinge.spring = {2, 1};
  const JointId joint = world.create_joint(hinge).value();
  run(world, 2);
  ASSERT_FALSE(state_of(world, body).awake);
  world.set_spring_target(joint, 0).value();
  world.set_break_force(joint, 0, 0).value();
  EXPECT_FALSE(state_of(world, body).awake);
  world.set_spring_target(joint, 0.1f).value();
  EXPECT_TRUE(state_of(world, body).awake);
}

TYPED_TEST(JointTargets, WhatCannotBeIsRefused) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  const BodyId body = add_mass(world, 0, 0, 1, 0.7);
  const JointId hinge = world.create_joint(on_ground<D, HingeJointDef<D>>(world, body)).value();
  const JointId ball = world.create_joint(on_ground<D, BallJointDef<D>>(world, body)).value();
  const JointId motor = world.create_joint(on_ground<D, MotorJointDef<D>>(world, body)).value();
  const JointId mouse = world.create_joint(on_ground<D, MouseJointDef<D>>(world, body)).value();
  const JointId rod = world.create_joint(on_ground<D, DistanceJointDef<D>>(world, body)).value();
  const std::uint64_t before = world.snapshot().digest();
  const auto refused = [&](const Status& status, const std::string& word) {
    ASSERT_FALSE(status.ok()) << word;
    EXPECT_NE(status.error().message.find(word), std::string::npos) << status.error().message;
    EXPECT_EQ(world.snapshot().digest(), before) << word;
  };
  const typename D::Rotation none = [] {
    typename D::Rotation q{};
    if constexpr (D::dimension == 2)
      q.c = 0;
    else
      q.w = 0;
    return q;
  }();
  refused(world.set_spring_target({}, 1), "null");
  refused(world.set_spring_target(hinge, nan), "target");
  refused(world.set_spring_target(ball, 1), "a ball joint, expected a hinge, slider or path joint");
  refused(world.set_max_spring_force(hinge, -1), "most");
  refused(world.set_max_spring_force(motor, 1), "a motor joint");
  refused(world.set_target_rotation(ball, none), "target has norm 0");
  refused(world.set_target_rotation(hinge, {}), "a hinge joint");
  refused(world.set_target_pose(motor, vec<D>(nan, 0), {}), "position.x");
  refused(world.set_target_pose(motor, {}, none), "rotation");
  refused(world.set_target_pose(ball, {}, {}), "a ball joint");
  refused(world.set_target_velocity(motor, vec<D>(0, 1e9f), {}), "velocity.y");
  refused(world.set_target_velocity(motor, {}, about_z<D>(nan)), "spin");
  refused(world.set_target_velocity(mouse, {}, {}), "a mouse joint");
  refused(world.set_hold(hinge, false, false), "a hinge joint");
  refused(world.set_max_force(motor, -1, 0), "force");
  refused(world.set_max_force(motor, 1, nan), "torque");
  refused(world.set_max_force(mouse, 1, 1), "torque");
  refused(world.set_max_force(rod, 1, 1), "a distance joint");
  refused(world.set_length(rod, -1), "length");
  refused(world.set_length(hinge, 1), "a hinge joint");
  refused(world.set_cone_angle(ball, 4), "angle");
  if constexpr (D::dimension == 2) refused(world.set_cone_angle(ball, 1), "in the plane");
  refused(world.set_friction(ball, -1), "friction");
  refused(world.set_friction(hinge, 1), "a motor at speed 0");
  refused(world.set_break_force(rod, nan, 0), "force");
  refused(world.set_break_force(rod, 1, -1), "torque");

  const auto not_made = [&](const auto& def, const std::string& word) {
    const auto made = world.create_joint(def);
    ASSERT_FALSE(made.ok()) << word;
    EXPECT_NE(made.error().message.find(word), std::string::npos) << made.error().message;
    EXPECT_EQ(world.snapshot().digest(), before) << word;
  };
  MotorJointDef<D> m;
  m.body_b = body;
  m.target_position = vec<D>(nan, 0);
  not_made(m, "target_position.x");
  m.target_position = {};
  m.target_rotation = none;
  not_made(m, "target_rotation");
  m.target_rotation = {};
  m.target_velocity = vec<D>(0, nan);
  not_made(m, "target_velocity.y");
  m.target_velocity = {};
  m.target_spin = about_z<D>(nan);
  not_made(m, "target_spin");
  HingeJointDef<D> h;
  h.body_b = body;
  h.max_spring_torque = -1;
  not_made(h, "max_spring_torque");
  SliderJointDef<D> s;
  s.body_b = body;
  s.max_spring_force = nan;
  not_made(s, "max_spring_force");
  BallJointDef<D> b;
  b.body_b = body;
  b.target_rotation = none;
  not_made(b, "target_rotation");
}

/// Links that a spring turns each to its own target, and a servo at the end of each.
template <class D>
std::vector<JointId> add_arms(World<D>& world) {
  std::vector<JointId> joints;
  for (int k = 0; k < 24; ++k) {
    const BodyId base = add_fixed(world, 0, 3.0 * k), arm = add_mass(world, 1, 3.0 * k, 2, 0.3),
                 hand = add_mass(world, 2, 3.0 * k, 1, 0.2);
    BallJointDef<D> shoulder;
    shoulder.body_a = base;
    shoulder.body_b = arm;
    shoulder.frame_b.p = vec<D>(-1, 0);
    shoulder.spring = {3, 0.7f};
    shoulder.target_rotation = turned<D>(0.05 * k);
    shoulder.friction_torque = 0.1f;
    joints.push_back(world.create_joint(shoulder).value());
    HingeJointDef<D> wrist;
    wrist.body_a = arm;
    wrist.body_b = hand;
    wrist.frame_a.p = vec<D>(0.5f, 0);
    wrist.frame_b.p = vec<D>(-0.5f, 0);
    wrist.spring = {5, 0.5f};
    wrist.max_spring_torque = 1 + 0.5f * float(k);
    joints.push_back(world.create_joint(wrist).value());
  }
  return joints;
}
template <class D>
void wave(World<D>& world, const std::vector<JointId>& joints, int step) {
  for (std::size_t i = 0; i < joints.size(); i += 2) {
    world.set_target_rotation(joints[i], turned<D>(0.02 * step)).value();
    world.set_spring_target(joints[i + 1], 0.03f * float(step)).value();
  }
}

TYPED_TEST(JointTargets, AreTheSameForEveryWidthAndAfterARollback) {
  using D = TypeParam;
  std::uint64_t hash = 0;
  for (const int width : {4, 8, 16}) {
    WorldDef<D> def;
    def.simd_width = width;
    if (!World<D>::check(def).ok()) continue;
    World<D> world(def);
    const auto joints = add_arms(world);
    for (int i = 0; i < 30; ++i) wave(world, joints, i), world.step(frame).value();
    const Snapshot<D> kept = world.snapshot();
    for (int i = 30; i < 60; ++i) wave(world, joints, i), world.step(frame).value();
    const std::uint64_t end = world.state_hash();
    world.restore(kept).value();
    EXPECT_EQ(world.snapshot().digest(), kept.digest());
    for (int i = 30; i < 60; ++i) wave(world, joints, i), world.step(frame).value();
    EXPECT_EQ(world.state_hash(), end) << "lanes " << width;
    if (hash == 0) hash = end;
    EXPECT_EQ(end, hash) << "lanes " << width;
  }
}

}  // namespace joint_target_test
}  // namespace carom::rigid::test
