// Generic joints and what they make (cylindrical, planar, universal, wheel), couplings (gear, rack, screw, pulley), and
// joints that break.
#include "mechanics_world.h"

namespace carom::rigid::test {
namespace joint_types_test {

template <class D>
class JointTypes : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(JointTypes, Dimensions);

constexpr float g = 9.80665f;

template <class D>
WorldDef<D> heavy() {
  WorldDef<D> d;
  d.allow_sleep = false;
  return d;
}
template <class D>
void run(World<D>& world, int steps) {
  for (int i = 0; i < steps; ++i) world.step(frame).value();
}
/// A hinge about z that holds `body` to the world where it is.
template <class D>
JointId pin(World<D>& world, BodyId body) {
  HingeJointDef<D> hinge;
  hinge.body_b = body;
  const auto p = state_of(world, body).pose.position;
  hinge.frame_a.p = vec<D>(float(p.x), float(p.y));
  return world.create_joint(hinge).value();
}

TYPED_TEST(JointTypes, GenericHoldsWhatIsNotFree) {
  using D = TypeParam;
  World<D> world(heavy<D>());
  GenericJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 1, 0, 2, 0.3);
  def.frame_b.p = vec<D>(-1, 0);
  const JointId joint = world.create_joint(def).value();
  run(world, 300);
  const JointState<D> state = world.joint_state(joint).value();
  EXPECT_LT(state.linear_error, 3e-3f);
  EXPECT_LT(state.angular_error, 3e-2f);
  EXPECT_NEAR(state.force.y, 2 * g, 0.1f);
  EXPECT_NEAR(z_of(state.torque), 2 * g, 0.1f);
}

TYPED_TEST(JointTypes, GenericAxisFallsBetweenItsStops) {
  using D = TypeParam;
  World<D> world(heavy<D>());
  GenericJointDef<D> def;
  def.body_b = add_mass(world, 0, 0, 2, 0.3);
  def.linear[1].free = true;
  def.linear[1].limit = {true, -1, 1};
  const JointId joint = world.create_joint(def).value();
  run(world, 20);
  const double t = 20 * double(frame);
  EXPECT_NEAR(double(world.joint_state(joint).value().coordinate), -0.5 * double(g) * t * t, 0.02);
  run(world, 120);
  EXPECT_NEAR(world.joint_state(joint).value().coordinate, -1, 0.01f);
  EXPECT_NEAR(world.joint_state(joint).value().force.y, 2 * g, 0.1f);
}

TYPED_TEST(JointTypes, GenericSpringMotorAndFriction) {
  using D = TypeParam;
  {  // 2 Hz: half a period after it was let go at 0 it is as far beyond its target
    World<D> world(weightless<D>());
    GenericJointDef<D> def;
    def.body_b = add_mass(world, 0, 0, 2, 0.3);
    def.linear[0].free = true;
    def.linear[0].spring = {2, 0};
    def.linear[0].target = 0.4f;
    const JointId joint = world.create_joint(def).value();
    run(world, 15);
    EXPECT_NEAR(world.joint_state(joint).value().coordinate, 0.8f, 0.01f);
  }
  {  // a stiff spring with 3 N: pulls 2 kg with no more than that
    World<D> world(weightless<D>());
    GenericJointDef<D> def;
    def.body_b = add_mass(world, 0, 0, 2, 0.3);
    def.linear[0].free = true;
    def.linear[0].spring = {5, 1};
    def.linear[0].target = 5;
    def.linear[0].max_spring_force = 3;
    const JointId joint = world.create_joint(def).value();
    run(world, 60);
    EXPECT_NEAR(world.joint_state(joint).value().speed, 1.5f, 0.02f);
  }
  {  // friction stops v = 2 m/s with 4 N on 2 kg after 1 s and 1 m
    World<D> world(weightless<D>());
    GenericJointDef<D> def;
    def.body_b = add_mass(world, 0, 0, 2, 0.3);
    def.linear[0].free = true;
    def.linear[0].friction = 4;
    const JointId joint = world.create_joint(def).value();
    world.set_velocity(def.body_b, vec<D>(2, 0), {}).value();
    run(world, 90);
    EXPECT_NEAR(world.joint_state(joint).value().coordinate, 1, 0.02f);
    EXPECT_NEAR(world.joint_state(joint).value().speed, 0, 1e-4f);
  }
}

TYPED_TEST(JointTypes, WheelRollsAndSprings) {
  using D = TypeParam;
  // A carrier that is held, a wheel of 5 kg on 3 Hz: rests g/ω² below, and its motor turns it.
  World<D> world(heavy<D>());
  GenericJointDef<D> def = make_wheel_joint<D>({.body_a = add_fixed(world)}, {3, 0.7f}, {true, -0.5f, 0.5f});
  def.body_b = add_mass(world, 0, 0, 5, 0.4);
  def.angular[D::dimension == 2 ? 0 : 2].motor = {true, 10, 2};  // 2 N·m on 0.4 kg·m²: 5 rad/s²
  const JointId joint = world.create_joint(def).value();
  run(world, 60);
  EXPECT_NEAR(z_of(state_of(world, def.body_b).angular_velocity), 5, 0.05f);
  run(world, 240);
  EXPECT_NEAR(z_of(state_of(world, def.body_b).angular_velocity), 10, 0.01f);
  const float omega = 2 * pi_f * 3;
  EXPECT_NEAR(world.joint_state(joint).value().coordinate, -g / (omega * omega), 1e-3f);
  EXPECT_NEAR(state_of(world, def.body_b).pose.position.x, 0, 1e-3);
}

TYPED_TEST(JointTypes, GearKeepsItsRatio) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  GearJointDef<D> gear;
  gear.body_a = add_mass(world, 0, 0, 1, 0.5);
  gear.body_b = add_mass(world, 2, 0, 1, 0.2);
  gear.ratio = -2.5f;
  pin(world, gear.body_a);
  pin(world, gear.body_b);
  const JointId joint = world.create_joint(gear).value();
  // 1 N·m on A: I = .5 + 2.5² · .2 = 1.75 kg·m² as A sees it.
  double angle_a = 0, angle_b = 0;
  for (int i = 0; i < 120; ++i) {
    world.add_torque(gear.body_a, about_z<D>(1)).value();
    world.step(frame).value();
    angle_a += double(z_of(state_of(world, gear.body_a).angular_velocity)) * double(frame);
    angle_b += double(z_of(state_of(world, gear.body_b).angular_velocity)) * double(frame);
  }
  EXPECT_NEAR(z_of(state_of(world, gear.body_a).angular_velocity), 2 / 1.75f, 2e-3f);
  EXPECT_NEAR(z_of(state_of(world, gear.body_b).angular_velocity), -2.5f * 2 / 1.75f, 5e-3f);
  EXPECT_NEAR(angle_b, -2.5 * angle_a, 5e-3);
  EXPECT_LT(world.joint_state(joint).value().angular_error, 1e-3f);
}

TYPED_TEST(JointTypes, RackMovesByThePinionsRadius) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  RackJointDef<D> rack;
  rack.body_a = add_mass(world, 0, 0, 1, 0.5);
  rack.body_b = add_mass(world, 0, -0.3, 2, 0.2);
  rack.radius = 0.3f;
  pin(world, rack.body_a);
  SliderJointDef<D> slider;
  slider.body_b = rack.body_b;
  slider.frame_a.p = vec<D>(0, -0.3f);
  const JointId slides = world.create_joint(slider).value();
  const JointId joint = world.create_joint(rack).value();
  for (int i = 0; i < 120; ++i) {
    world.add_torque(rack.body_a, about_z<D>(1)).value();
    world.step(frame).value();
  }
  // I = .5 + 2 · .3² = .68 as the pinion sees it; ½ α t² turned.
  EXPECT_NEAR(z_of(state_of(world, rack.body_a).angular_velocity), 2 / 0.68f, 5e-3f);
  EXPECT_NEAR(world.joint_state(slides).value().coordinate, 0.3f * 2 / 0.68f, 0.02f);
  EXPECT_NEAR(world.joint_state(slides).value().speed, 0.3f * 2 / 0.68f, 2e-3f);
  EXPECT_LT(world.joint_state(joint).value().linear_error, 1e-3f);
}

TYPED_TEST(JointTypes, PulleyIsAtwoodsMachine) {
  using D = TypeParam;
  // 3 and 1 kg: a = g (3 − 1)/(3 + 1), tension 2 m₁ m₂ g/(m₁ + m₂) = 1.5 g.
  World<D> world(heavy<D>());
  PulleyJointDef<D> pulley;
  pulley.body_a = add_mass(world, -1, -3, 3, 0.1);
  pulley.body_b = add_mass(world, 1, -3, 1, 0.1);
  pulley.ground_a = pos<D>(-1, 0);
  pulley.ground_b = pos<D>(1, 0);
  pulley.length = 6;
  const JointId joint = world.create_joint(pulley).value();
  float longest = 0;
  for (int i = 0; i < 30; ++i) {
    world.step(frame).value();
    longest = math::max(longest, world.joint_state(joint).value().coordinate);
  }
  EXPECT_NEAR(state_of(world, pulley.body_a).linear_velocity.y, -0.5f * g / 2, 0.01f);
  EXPECT_NEAR(state_of(world, pulley.body_b).linear_velocity.y, 0.5f * g / 2, 0.01f);
  EXPECT_LT(longest, 6.005f);
  EXPECT_NEAR(math::length(world.joint_state(joint).value().force), 1.5f * g, 0.05f);
}

TYPED_TEST(JointTypes, PulleyRopeGoesSlack) {
  using D = TypeParam;
  World<D> world(heavy<D>());
  PulleyJointDef<D> pulley;
  pulley.body_a = add_mass(world, -1, -1, 3, 0.1);
  pulley.body_b = add_mass(world, 1, -1, 1, 0.1);
  pulley.ground_a = pos<D>(-1, 0);
  pulley.ground_b = pos<D>(1, 0);
  pulley.length = 6;
  const JointId joint = world.create_joint(pulley).value();
  run(world, 20);
  EXPECT_EQ(math::length(world.joint_state(joint).value().force), 0);
  EXPECT_NEAR(state_of(world, pulley.body_a).linear_velocity.y, -g / 3, 0.01f) << "both fall freely";
}

TYPED_TEST(JointTypes, BreaksAboveItsThresholdAndTellsOfIt) {
  using D = TypeParam;
  for (const bool strong : {true, false}) {
    World<D> world(heavy<D>());
    BallJointDef<D> def;
    def.body_b = add_mass(world, 0, 0, 4, 0.1);
    def.break_force = 4 * g * (strong ? 1.02f : 0.98f);
    const JointId joint = world.create_joint(def).value();
    int told = 0;
    for (int i = 0; i < 60; ++i) {
      world.step(frame).value();
      for (const JointBreakEvent<D>& event : world.events().joint_break) {
        ++told;
        EXPECT_TRUE(event.joint == joint);
        EXPECT_TRUE(event.body_b == def.body_b);
        EXPECT_GT(math::length(event.force), def.break_force);
      }
    }
    EXPECT_EQ(world.contains(joint), strong);
    EXPECT_EQ(told, strong ? 0 : 1);
    EXPECT_EQ(state_of(world, def.body_b).pose.position.y < -1, !strong);
  }
}

TYPED_TEST(JointTypes, WeldBreaksByTorque) {
  using D = TypeParam;
  // The moment of 2 kg on an arm of 1 m is 2 g; let go at once it may be twice that.
  for (const bool strong : {true, false}) {
    World<D> world(heavy<D>());
    WeldJointDef<D> def;
    def.body_b = add_mass(world, 1, 0, 2, 0.3);
    def.frame_b.p = vec<D>(-1, 0);
    def.break_torque = 2 * g * (strong ? 2.5f : 0.9f);
    const JointId joint = world.create_joint(def).value();
    run(world, 120);
    EXPECT_EQ(world.contains(joint), strong);
  }
}

TYPED_TEST(JointTypes, RefusesWhatMakesNoSense) {
  using D = TypeParam;
  World<D> world;
  const BodyId a = add_mass(world, 0, 0, 1, 1), b = add_mass(world, 1, 0, 1, 1);
  const auto message = [&](auto def) {
    def.body_a = a;
    def.body_b = b;
    const auto made = world.create_joint(def);
    return made.ok() ? std::string() : made.error().message;
  };
  GenericJointDef<D> generic;
  generic.linear[1].limit = {true, 2, 1};
  EXPECT_NE(message(generic).find("linear[1].limit.lower"), std::string::npos) << message(generic);
  generic = {};
  generic.angular[0].friction = -1;
  EXPECT_NE(message(generic).find("angular[0].friction"), std::string::npos);
  GearJointDef<D> gear;
  gear.ratio = 0;
  EXPECT_NE(message(gear).find("ratio"), std::string::npos);
  PulleyJointDef<D> pulley;
  pulley.ratio = -1;
  EXPECT_NE(message(pulley).find("ratio"), std::string::npos);
  ScrewJointDef<D> screw;
  EXPECT_EQ(message(screw).empty(), D::dimension == 3);
  BallJointDef<D> ball;
  ball.break_force = -1;
  EXPECT_NE(message(ball).find("break_force"), std::string::npos);
  const JointId joint = world.create_joint(GenericJointDef<D>{{.body_a = a, .body_b = b}, {}, {}}).value();
  EXPECT_FALSE(world.set_axis(joint, 7, {}).ok());
  EXPECT_FALSE(world.set_axis(joint, 0, {.free = true}).ok());
  EXPECT_FALSE(world.set_spring(joint, {1, 1}).ok());
  EXPECT_TRUE(world.set_axis(joint, 0, {}).ok());
}

TEST(JointTypes3, CylindricalSlidesAndTurns) {
  World3 world(weightless<Dim3>());
  GenericJointDef<Dim3> def = make_cylindrical_joint<Dim3>({});
  def.body_b = add_mass(world, 0, 0, 2, 0.3);
  world.create_joint(def).value();
  world.set_velocity(def.body_b, {1, 2, 3}, {4, 5, 6}).value();
  run(world, 60);
  const BodyState<Dim3> state = state_of(world, def.body_b);
  EXPECT_NEAR(state.linear_velocity.x, 1, 1e-3f);
  EXPECT_NEAR(state.angular_velocity.x, 4, 1e-3f);
  EXPECT_NEAR(state.pose.position.x, 1, 0.01);
  EXPECT_NEAR(state.pose.position.y, 0, 1e-3);
  EXPECT_NEAR(math::length(math::cross(state.angular_velocity, Vec3f{1, 0, 0})), 0, 1e-3f);
}

TEST(JointTypes3, PlanarStaysInItsPlane) {
  World3 world(weightless<Dim3>());
  GenericJointDef<Dim3> def = make_planar_joint<Dim3>({});
  def.body_b = add_mass(world, 0, 0, 2, 0.3);
  world.create_joint(def).value();
  world.set_velocity(def.body_b, {1, 2, 3}, {4, 5, 6}).value();
  run(world, 60);
  const BodyState<Dim3> state = state_of(world, def.body_b);
  EXPECT_NEAR(state.linear_velocity.x, 1, 1e-3f);
  EXPECT_NEAR(state.linear_velocity.y, 2, 1e-3f);
  EXPECT_NEAR(state.pose.position.z, 0, 1e-3);
  EXPECT_NEAR(state.angular_velocity.z, 6, 1e-3f);
  EXPECT_NEAR(state.angular_velocity.x, 0, 1e-3f);
}

TEST(JointTypes3, UniversalJointTurnsUnevenly) {
  // Two shafts at an angle β: tan(φ₂) = tan(φ₁)/cos β, and ω₂/ω₁ runs between cos β and 1/cos β.
  World3 world(weightless<Dim3>());
  const float bend = 0.5f;
  const auto shaft = [&](float angle) {
    BodyDef<Dim3> body;
    body.rotation = turned<Dim3>(double(angle));  // its x is the shaft
    const BodyId id = add_mass(world, body, 1, 0.1);
    GenericJointDef<Dim3> bearing;  // turns about x only
    bearing.body_b = id;
    bearing.frame_a.q = body.rotation;
    bearing.angular[0].free = true;
    world.create_joint(bearing).value();
    return id;
  };
  const BodyId in = shaft(0), out = shaft(bend);
  // The cross: one arm across the first shaft (its y), one across the second (its z). Frames: x of A and z of B.
  GenericJointDef<Dim3> cross = make_universal_joint<Dim3>({.body_a = in, .body_b = out});
  const float half = math::sqrt(0.5f);
  cross.frame_a.q = {half, 0, 0, half};                   // x of the frame is y of the shaft
  cross.frame_b.q = {1, 0, 0, 0};                         // z of the frame is z of the shaft
  for (JointAxis& axis : cross.linear) axis.free = true;  // the bearings hold the place
  world.create_joint(cross).value();
  const auto [s, c] = math::sincos(bend);
  (void)s;
  float least = 10, most = 0;
  for (int i = 0; i < 600; ++i) {
    // Driven evenly.
    world.set_velocity(in, {}, {2, 0, 0}).value();
    world.step(frame).value();
    if (i < 60) continue;
    const float speed_in = state_of(world, in).angular_velocity.x;
    const Vec3f w = state_of(world, out).angular_velocity;
    const float ratio = dot(w, rotate(turned<Dim3>(double(bend)), Vec3f{1, 0, 0})) / speed_in;
    least = math::min(least, ratio);
    most = math::max(most, ratio);
  }
  EXPECT_NEAR(least, c, 0.02f);
  EXPECT_NEAR(most, 1 / c, 0.02f);
}

TEST(JointTypes3, ScrewAdvancesByItsPitch) {
  World3 world(weightless<Dim3>());
  GenericJointDef<Dim3> guide = make_cylindrical_joint<Dim3>({});
  guide.body_b = add_mass(world, 0, 0, 2, 0.3);
  world.create_joint(guide).value();
  ScrewJointDef<Dim3> screw;
  screw.body_b = guide.body_b;
  screw.pitch = 0.2f;
  const JointId joint = world.create_joint(screw).value();
  // 1 N·m for 2 s: I + m p²/4π² as the turning sees it.
  const float p = 0.2f / (2 * pi_f), inertia = 0.3f + 2 * p * p;
  for (int i = 0; i < 120; ++i) {
    world.add_torque(guide.body_b, {1, 0, 0}).value();
    world.step(frame).value();
  }
  EXPECT_NEAR(state_of(world, guide.body_b).angular_velocity.x, 2 / inertia, 0.02f);
  const double turns = 0.5 * double(1 / inertia) * 4 / (2 * pi);
  EXPECT_NEAR(state_of(world, guide.body_b).pose.position.x, 0.2 * turns, 0.02 * 0.2 * turns);
  EXPECT_LT(world.joint_state(joint).value().linear_error, 1e-3f);
}

// A thread sees 1/1200 of what turns against its jammed nut, a gear 1/1000 of what its braked wheel holds: their
// impulses agree slowly, and must not swing up meanwhile.
TEST(JointTypes3, AJammedThreadComesToRest) {
  World3 world(weightless<Dim3>());
  GenericJointDef<Dim3> guide = make_cylindrical_joint<Dim3>({});
  guide.body_b = add_mass(world, 0, 0, 2, 0.3);
  guide.linear[0].friction = 1e5f;
  world.create_joint(guide).value();
  ScrewJointDef<Dim3> screw;
  screw.body_b = guide.body_b;
  screw.pitch = 0.1f;
  const JointId joint = world.create_joint(screw).value();
  for (int i = 0; i < 1800; ++i) {
    world.add_torque(guide.body_b, {math::min(2.0f, float(i) / 60), 0, 0}).value();
    world.step(frame).value();
  }
  EXPECT_LT(math::length(state_of(world, guide.body_b).angular_velocity), 1e-4f);
  EXPECT_NEAR(world.joint_state(joint).value().torque.x, -2, 0.01f);
  EXPECT_NEAR(world.joint_state(joint).value().force.x, 2 * 2 * pi_f / 0.1f, 1);
}
TYPED_TEST(JointTypes, AGearOnABrakeComesToRest) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  GearJointDef<D> gear;
  gear.body_a = add_mass(world, 0, 0, 1, 3);
  gear.body_b = add_mass(world, 2, 0, 1, 0.003);
  gear.ratio = 1;
  pin(world, gear.body_a);
  world.set_motor(pin(world, gear.body_b), JointMotor{true, 0, 1e6f}).value();
  const JointId joint = world.create_joint(gear).value();
  for (int i = 0; i < 1800; ++i) {
    world.add_torque(gear.body_a, about_z<D>(2)).value();
    world.step(frame).value();
  }
  EXPECT_LT(math::abs(z_of(state_of(world, gear.body_a).angular_velocity)), 1e-4f);
  EXPECT_NEAR(z_of(world.joint_state(joint).value().torque), 2, 0.01f);
}

// By iteration alone a weld sees 1/1000 of what it holds on a brake: it gives way by that, and comes to rest. At a
// quarter of the substep rate all of these swung up without bound.
TYPED_TEST(JointTypes, WhatIterationHoldsOnABrakeComesToRest) {
  using D = TypeParam;
  WorldDef<D> definition = heavy<D>();
  definition.joint_solver = JointSolver::iterative;
  const auto fall = [&](auto joint) {
    World<D> world(definition);
    SliderJointDef<D> slider;
    slider.body_b = joint.body_a = add_mass(world, 0, 0, 1, 0.1);
    slider.frame_a.q = slider.frame_b.q = turned<D>(0.5 * pi);
    slider.motor = {true, 0, 1e8f};
    world.create_joint(slider).value();
    joint.body_b = add_mass(world, 0, -1, 1000, 100);
    joint.frame_b.p = vec<D>(0, 1);
    world.create_joint(joint).value();
    run(world, 1800);
    EXPECT_LT(world.totals().kinetic_energy, 1e-3);
    EXPECT_NEAR(state_of(world, joint.body_b).pose.position.y, -1.108, 0.01);
  };
  fall(WeldJointDef<D>{});
  fall(BallJointDef<D>{});
  fall(GenericJointDef<D>{});
}

}  // namespace joint_types_test
}  // namespace carom::rigid::test
