// Every joint keeps what it promises, in the plane and in space: constraints, limits, motors, and Newton's third law.
#include "mechanics_world.h"

namespace carom::rigid::test {
namespace joint_test {

template <class D>
class Joints : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Joints, Dimensions);

/// Steps and returns the worst linear and angular error seen.
template <class D>
std::pair<float, float> worst_errors(World<D>& world, JointId joint, int steps) {
  float linear = 0, angular = 0;
  for (int i = 0; i < steps; ++i) {
    world.step(frame).value();
    const JointState<D> state = world.joint_state(joint).value();
    linear = math::max(linear, state.linear_error);
    angular = math::max(angular, state.angular_error);
  }
  return {linear, angular};
}

TYPED_TEST(Joints, RigidDistanceStaysRigidUnderGravity) {
  using D = TypeParam;
  WorldDef<D> definition;
  definition.allow_sleep = false;
  World<D> world(definition);
  const BodyId ground = add_fixed(world);
  DistanceJointDef<D> def;
  def.body_a = ground;
  def.body_b = add_mass(world, 2, 0, 3, 0.1);
  def.length = 2;
  const JointId joint = world.create_joint(def).value();
  EXPECT_LT(worst_errors(world, joint, 600).first, 2e-3f);
}

TYPED_TEST(Joints, RopeOnlyPulls) {
  using D = TypeParam;
  WorldDef<D> definition;
  definition.allow_sleep = false;
  World<D> world(definition);
  DistanceJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 0.5, 0, 1, 0.1);
  def.length = 2;
  def.rope = true;
  const JointId joint = world.create_joint(def).value();
  world.step(frame).value();
  EXPECT_EQ(math::length(world.joint_state(joint).value().force), 0.0f) << "slack rope";
  float longest = 0;
  for (int i = 0; i < 600; ++i) {
    world.step(frame).value();
    longest = math::max(longest, world.joint_state(joint).value().coordinate);
  }
  EXPECT_LT(longest, 2.01f);
  EXPECT_GT(longest, 1.99f);
}

TYPED_TEST(Joints, BallHoldsAndCarriesTheWeight) {
  using D = TypeParam;
  WorldDef<D> definition;
  definition.allow_sleep = false;
  World<D> world(definition);
  BallJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 0, -1, 4, 0.2);
  def.frame_b.p = vec<D>(0, 1);
  const JointId joint = world.create_joint(def).value();
  EXPECT_LT(worst_errors(world, joint, 120).first, 1e-3f);
  const JointState<D> state = world.joint_state(joint).value();
  EXPECT_NEAR(state.force.y, 4 * 9.80665f, 0.02f) << "hangs at rest: the joint pulls up with the weight";
}

TYPED_TEST(Joints, WeldIsACantilever) {
  using D = TypeParam;
  WorldDef<D> definition;
  definition.allow_sleep = false;
  World<D> world(definition);
  WeldJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 1, 0, 2, 0.3);
  def.frame_b.p = vec<D>(-1, 0);
  const JointId joint = world.create_joint(def).value();
  const auto [linear, angular] = worst_errors(world, joint, 300);
  EXPECT_LT(linear, 3e-3f);
  EXPECT_LT(angular, 3e-2f);
  const JointState<D> state = world.joint_state(joint).value();
  EXPECT_NEAR(state.force.y, 2 * 9.80665f, 0.05f);
  EXPECT_NEAR(z_of(state.torque), 2 * 9.80665f * 1, 0.1f) << "moment of the weight about the wall";
}

TYPED_TEST(Joints, HingeSpeedsUpToItsMotorWithinItsTorque) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  HingeJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 0, 0, 1, 0.5);
  def.motor = {true, 6, 2};  // 2 N·m on 0.5 kg·m²: 4 rad/s²
  const JointId joint = world.create_joint(def).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_NEAR(world.joint_state(joint).value().speed, 4.0f, 0.01f);
  EXPECT_NEAR(z_of(world.joint_state(joint).value().torque), 2.0f, 1e-3f);
  for (int i = 0; i < 120; ++i) world.step(frame).value();
  EXPECT_NEAR(world.joint_state(joint).value().speed, 6.0f, 1e-3f);
}

TYPED_TEST(Joints, HingeStopsAtItsLimits) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  BodyDef<D> body;
  body.angular_velocity = about_z<D>(5);
  HingeJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, body, 1, 0.5);
  def.limit = {true, -0.5f, 1.0f};
  const JointId joint = world.create_joint(def).value();
  float highest = -10;
  for (int i = 0; i < 120; ++i) {
    world.step(frame).value();
    highest = math::max(highest, world.joint_state(joint).value().coordinate);
  }
  EXPECT_NEAR(highest, 1.0f, 0.01f);
  EXPECT_NEAR(world.joint_state(joint).value().speed, 0.0f, 1e-3f);
  world.set_velocity(def.body_b, {}, about_z<D>(-8)).value();
  float lowest = 10;
  for (int i = 0; i < 120; ++i) {
    world.step(frame).value();
    lowest = math::min(lowest, world.joint_state(joint).value().coordinate);
  }
  EXPECT_NEAR(lowest, -0.5f, 0.01f);
}

TYPED_TEST(Joints, SliderSlidesOnlyAlongItsAxis) {
  using D = TypeParam;
  WorldDef<D> definition;
  definition.allow_sleep = false;
  World<D> world(definition);
  SliderJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 0, 0, 1, 0.2);
  const double slope = -0.5;  // rad: the axis points 0.5 rad below the horizon
  def.frame_a.q = turned<D>(slope);
  def.frame_b.q = turned<D>(slope);
  const JointId joint = world.create_joint(def).value();
  const auto [linear, angular] = worst_errors(world, joint, 60);
  EXPECT_LT(linear, 2e-3f);
  EXPECT_LT(angular, 1e-3f);
  const double expected = 0.5 * 9.80665 * math::sin(0.5) * 1.0;  // ½ g sin(slope) t²
  EXPECT_NEAR(double(world.joint_state(joint).value().coordinate), expected, 0.005 * expected);
}

TYPED_TEST(Joints, SliderMotorAndLimit) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  SliderJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 0, 0, 2, 0.2);
  def.motor = {true, 1.5f, 4};  // 4 N on 2 kg
  def.limit = {true, -1, 1};
  const JointId joint = world.create_joint(def).value();
  for (int i = 0; i < 30; ++i) world.step(frame).value();
  EXPECT_NEAR(world.joint_state(joint).value().speed, 1.0f, 0.01f);
  for (int i = 0; i < 120; ++i) world.step(frame).value();
  EXPECT_NEAR(world.joint_state(joint).value().coordinate, 1.0f, 0.005f);
  EXPECT_NEAR(world.joint_state(joint).value().speed, 0.0f, 1e-3f);
  EXPECT_NEAR(world.joint_state(joint).value().force.x, 0.0f, 0.05f) << "motor and stop balance";
}

TYPED_TEST(Joints, MotorJointDrivesToItsPose) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  MotorJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 3, 1, 2, 0.4);
  def.frame_a.p = vec<D>(1, 2);
  def.frame_a.q = turned<D>(0.7);
  const JointId joint = world.create_joint(def).value();
  for (int i = 0; i < 240; ++i) world.step(frame).value();
  const BodyState<D> state = state_of(world, def.body_b);
  EXPECT_NEAR(state.pose.position.x, 1, 1e-3);
  EXPECT_NEAR(state.pose.position.y, 2, 1e-3);
  EXPECT_NEAR(angle_of(state.pose.rotation), 0.7, 1e-3);
  EXPECT_LT(world.joint_state(joint).value().linear_error, 1e-3f);
}

TYPED_TEST(Joints, MotorJointIsNoStrongerThanItsForce) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  MotorJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 100, 0, 2, 0.4);
  def.max_force = 3;
  const JointId joint = world.create_joint(def).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_NEAR(math::length(state_of(world, def.body_b).linear_velocity), 1.5f, 0.01f) << "F t/m";
  EXPECT_NEAR(math::length(world.joint_state(joint).value().force), 3.0f, 1e-3f);
}

TYPED_TEST(Joints, MouseJointFollowsItsTarget) {
  using D = TypeParam;
  WorldDef<D> definition;
  World<D> world(definition);
  MouseJointDef<D> def;
  def.body_b = add_mass(world, 0, 0, 2, 0.4);
  def.frame_b.p = vec<D>(0, 0.5f);
  def.target = pos<D>(0, 0.5);
  const JointId joint = world.create_joint(def).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  world.set_mouse_target(joint, pos<D>(4, 3)).value();
  for (int i = 0; i < 400; ++i) world.step(frame).value();
  const auto held = world_point(state_of(world, def.body_b).pose, def.frame_b.p);
  EXPECT_NEAR(held.x, 4, 0.02);
  // 5 Hz under the weight: sags by g/ω² times what the arm adds to the mobility at most.
  EXPECT_NEAR(held.y, 3, 9.80665 / math::square(2 * pi * 5) + 5e-3);
  EXPECT_TRUE(world.joint_state(joint).value().body_a.is_null());
}

TYPED_TEST(Joints, BallFrictionStopsTheTurn) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  BodyDef<D> body;
  body.angular_velocity = about_z<D>(2);
  BallJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, body, 1, 0.5);
  def.friction_torque = 1;  // 2 rad/s²: rest after one second and one radian
  world.create_joint(def).value();
  for (int i = 0; i < 30; ++i) world.step(frame).value();
  EXPECT_NEAR(z_of(state_of(world, def.body_b).angular_velocity), 1.0f, 1e-3f);
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_NEAR(z_of(state_of(world, def.body_b).angular_velocity), 0.0f, 1e-4f);
  EXPECT_NEAR(angle_of(state_of(world, def.body_b).pose.rotation), 1.0, 0.01);
}

TYPED_TEST(Joints, MomentumIsConservedByEveryType) {
  using D = TypeParam;
  // A spinning chain of seven bodies, each joined to the next by another type of joint, far from everything.
  World<D> world(weightless<D>());
  std::vector<BodyId> bodies;
  for (int i = 0; i < 7; ++i) {
    BodyDef<D> body;
    body.position = pos<D>(i, 0.1 * i * i);
    body.linear_velocity = vec<D>(0.3f * float(i % 3), 0.2f * float(i) - 0.5f);
    body.angular_velocity = about_z<D>(0.5f * float(i % 4) - 1);
    bodies.push_back(add_mass(world, body, 1 + 0.5 * i, 0.1 + 0.05 * i));
  }
  const auto join = [&](auto def, int i) {
    def.body_a = bodies[std::size_t(i)];
    def.body_b = bodies[std::size_t(i) + 1];
    def.frame_a.p = vec<D>(0.5f, 0);
    def.frame_b.p = vec<D>(-0.5f, 0);
    world.create_joint(def).value();
  };
  DistanceJointDef<D> distance;
  distance.length = 0.4f;
  join(distance, 0);
  BallJointDef<D> ball;
  ball.friction_torque = 0.1f;
  join(ball, 1);
  HingeJointDef<D> hinge;
  hinge.motor = {true, 3, 0.2f};
  join(hinge, 2);
  SliderJointDef<D> slider;
  slider.spring = {2, 0.1f};
  join(slider, 3);
  join(WeldJointDef<D>{}, 4);
  join(MotorJointDef<D>{}, 5);
  world.step(frame).value();  // the first step pulls everything together
  const Totals<D> before = world.totals();
  for (int i = 0; i < 600; ++i) world.step(frame).value();
  const Totals<D> after = world.totals();
  const double scale = before.mass;  // × 1 m/s
  EXPECT_NEAR(after.momentum.x, before.momentum.x, 1e-5 * scale);
  EXPECT_NEAR(after.momentum.y, before.momentum.y, 1e-5 * scale);
  if constexpr (D::dimension == 2) {
    EXPECT_NEAR(after.angular_momentum, before.angular_momentum, 2e-2 * scale);
  } else {
    EXPECT_NEAR(after.angular_momentum.z, before.angular_momentum.z, 2e-2 * scale);
  }
}

TYPED_TEST(Joints, WorldAnchorNeedsNoBody) {
  using D = TypeParam;
  World<D> world;
  BallJointDef<D> def;
  def.body_b = add_mass(world, 5, 3, 1, 0.1);
  def.frame_a.p = vec<D>(5, 4);
  def.frame_b.p = vec<D>(0, 1);
  const JointId joint = world.create_joint(def).value();
  EXPECT_LT(worst_errors(world, joint, 60).first, 1e-3f);
  EXPECT_NEAR(state_of(world, def.body_b).pose.position.y, 3, 1e-3);
}

TYPED_TEST(Joints, DestroyingABodyDestroysItsJoints) {
  using D = TypeParam;
  World<D> world;
  const BodyId a = add_mass(world, 0, 0, 1, 1), b = add_mass(world, 1, 0, 1, 1), c = add_mass(world, 2, 0, 1, 1);
  BallJointDef<D> def;
  def.body_a = a;
  def.body_b = b;
  const JointId ab = world.create_joint(def).value();
  def.body_a = b;
  def.body_b = c;
  const JointId bc = world.create_joint(def).value();
  world.step(frame).value();
  world.destroy_body(a).value();
  EXPECT_FALSE(world.contains(ab));
  EXPECT_TRUE(world.contains(bc));
  world.step(frame).value();
  std::vector<JointId> joints;
  world.joints(joints);
  EXPECT_EQ(joints, std::vector<JointId>{bc});
  world.destroy_joint(bc).value();
  EXPECT_FALSE(world.joint_state(bc).ok());
  world.step(frame).value();
}

TEST(Joints3, JointedBodiesSleepAndWakeTogether) {
  World3 world(WorldDef<Dim3>{.gravity = {}});
  BallJointDef<Dim3> def;
  def.body_a = add_mass(world, 0, 0, 1, 0.1);
  def.body_b = add_mass(world, 1, 0, 1, 0.1);
  def.frame_a.p = {0.5f, 0, 0};
  def.frame_b.p = {-0.5f, 0, 0};
  const JointId joint = world.create_joint(def).value();
  for (int i = 0; i < 60; ++i) world.step(frame).value();
  EXPECT_FALSE(state_of(world, def.body_a).awake);
  EXPECT_FALSE(state_of(world, def.body_b).awake);
  world.set_velocity(def.body_a, {1, 0, 0}, {}).value();
  for (int i = 0; i < 30; ++i) world.step(frame).value();
  EXPECT_TRUE(state_of(world, def.body_b).awake);
  EXPECT_NEAR(state_of(world, def.body_b).linear_velocity.x, 0.5, 1e-3);
  EXPECT_LT(world.joint_state(joint).value().linear_error, 1e-3f);
}

TEST(Joints3, ConnectedBodiesCollideOnlyWhereAsked) {
  for (const bool collide : {false, true}) {
    World3 world(weightless<Dim3>());
    BallJointDef<Dim3> def;
    def.body_a = world.create_body({.position = {0, 0, 0}}).value();
    def.body_b = world.create_body({.position = {0.9, 0, 0}}).value();
    world.add_shape(def.body_a, geometry::Sphere{0.5f}).value();
    world.add_shape(def.body_b, geometry::Sphere{0.5f}).value();
    def.frame_a.p = {0.45f, 0, 0};
    def.frame_b.p = {-0.45f, 0, 0};
    def.collide_connected = collide;
    const JointId joint = world.create_joint(def).value();
    for (int i = 0; i < 5; ++i) world.step(frame).value();
    EXPECT_EQ(world.counters().touching_contacts, collide ? 1 : 0);
    world.destroy_joint(joint).value();
    for (int i = 0; i < 5; ++i) world.step(frame).value();
    EXPECT_EQ(world.counters().contacts, 1) << "the pair is looked for again";
  }
}

TEST(Joints3, HingeKeepsItsAxis) {
  WorldDef<Dim3> definition;
  definition.allow_sleep = false;
  World3 world(definition);
  HingeJointDef<Dim3> def;  // a gate about a vertical axis, with its weight out on the arm
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 1, 0, 5, 0.4);
  const float half = math::sqrt(0.5f);
  def.frame_a.q = def.frame_b.q = {half, -half, 0, 0};  // z of the frames is world y
  def.frame_b.p = {-1, 0, 0};
  const JointId joint = world.create_joint(def).value();
  world.set_velocity(def.body_b, {0, 0, -2}, {0, 2, 0}).value();
  float linear = 0, angular = 0;
  for (int i = 0; i < 300; ++i) {
    world.step(frame).value();
    const JointState<Dim3> state = world.joint_state(joint).value();
    linear = math::max(linear, state.linear_error);
    angular = math::max(angular, state.angular_error);
  }
  EXPECT_LT(linear, 5e-3f);
  EXPECT_LT(angular, 2e-2f);
  EXPECT_NEAR(world.joint_state(joint).value().speed, 2.0f, 0.02f) << "gravity does no work on a vertical hinge";
}

TEST(Joints3, ConeAndTwistLimitsHold) {
  World3 world(weightless<Dim3>());
  BallJointDef<Dim3> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 0, 0, 1, 0.3);
  def.cone_angle = 0.6f;
  def.twist = {true, -0.4f, 0.4f};
  world.create_joint(def).value();
  float widest = 0, most = 0;
  for (int push = 0; push < 8; ++push) {
    const float a = float(push) * 0.785f;
    const auto [s, c] = math::sincos(a);
    world.set_velocity(def.body_b, {}, {3 * c, 3 * s, push % 2 == 0 ? 2.0f : -2.0f}).value();
    for (int i = 0; i < 60; ++i) {
      world.step(frame).value();
      const Quatf q = state_of(world, def.body_b).pose.rotation;
      const Vec3f z = rotate(q, Vec3f{0, 0, 1});
      widest = math::max(widest, math::acos(math::clamp(z.z, -1.0f, 1.0f)));
      most = math::max(most, math::abs(2 * math::atan2(q.z, q.w)));
    }
  }
  EXPECT_NEAR(widest, 0.6f, 0.02f);
  EXPECT_NEAR(most, 0.4f, 0.02f);
}

TEST(Joints3, GyroscopeOnABallJointPrecesses) {
  // Reference rigid-body.md 6.1 #11: disc R .3 on a .5 m arm, ω 80, started at Ω = g r/(½R²ω).
  WorldDef<Dim3> definition;
  definition.gravity = {0, -9.81f, 0};
  definition.allow_sleep = false;
  definition.maximum_linear_speed = 1e4f;
  World3 world(definition);
  const double radius = 0.3, arm = 0.5, spin = 80;
  const double rate = 9.81 * arm / (0.5 * radius * radius * spin);
  EXPECT_NEAR(rate, 1.3625, 1e-4);
  BodyDef<Dim3> body;
  body.position = {arm, 0, 0};
  body.angular_velocity = {float(spin), float(rate), 0};
  body.linear_velocity = {0, 0, float(-rate * arm)};  // Ω ŷ × arm x̂
  const BodyId disc = world.create_body(body).value();
  geometry::MassProperties3 properties;
  properties.mass = 1;
  properties.inertia = Mat3d::diagonal({0.5 * radius * radius, 0.25 * radius * radius, 0.25 * radius * radius});
  world.set_mass_properties(disc, properties).value();
  BallJointDef<Dim3> def;
  def.body_b = disc;
  def.frame_b.p = {float(-arm), 0, 0};
  world.create_joint(def).value();
  double turned = 0, last = 0, lowest = 0;
  const int steps = 600;
  for (int i = 0; i < steps; ++i) {
    world.step(frame).value();
    const Vec3d p = state_of(world, disc).center_of_mass;
    const double angle = math::atan2(-p.z, p.x);
    double change = angle - last;
    if (change < -pi) change += 2 * pi;
    if (change > pi) change -= 2 * pi;
    turned += change;
    last = angle;
    lowest = math::min(lowest, p.y);
  }
  const double measured = turned / (steps / 60.0);
  RecordProperty("precession", std::to_string(measured));
  RecordProperty("droop", std::to_string(-lowest / arm));
  EXPECT_NEAR(measured, rate, 0.03 * rate);
  EXPECT_LT(-lowest, 0.03 * arm);
}

}  // namespace joint_test
}  // namespace carom::rigid::test
