// Springs of joints and spring effectors against the damped oscillator x'' + 2ζω x' + ω² x = 0.
#include <cmath>

#include "carom/math/elementary.h"
#include "mechanics_world.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace joint_spring_test {

template <class D>
class JointSprings : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(JointSprings, Dimensions);

struct Swing {
  double period = 0;     ///< s
  double per_cycle = 0;  ///< ratio of amplitudes one cycle apart
};
/// Steps until enough cycles have passed; `signal` is the displacement from rest.
template <class D, class Signal>
Swing measure(World<D>& world, float dt, double seconds, const Signal& signal) {
  Crossings up;
  std::vector<std::pair<double, double>> peaks;
  double before = 1e30, middle = signal(), time = 0;
  for (; time < seconds;) {
    world.step(dt).value();
    time += double(dt);
    const double now = signal();
    up.add(time, now);
    if (middle > before && middle >= now && middle > 0) {  // a parabola through three samples
      const double a = 0.5 * (before + now) - middle, b = 0.5 * (now - before);
      peaks.push_back({time - double(dt), a < 0 ? middle - b * b / (4 * a) : middle});
    }
    before = middle;
    middle = now;
  }
  Swing out;
  out.period = up.period();
  out.per_cycle = math::pow(peaks.back().second / peaks.front().second, 1.0 / double(peaks.size() - 1));
  return out;
}

// rigid-body.md 6.1 #23: f 1 %, amplitude 3 % at f h ≤ .1, with h the step.
TYPED_TEST(JointSprings, FrequencyAndDecayAreExact) {
  using D = TypeParam;
  for (const float hertz : {0.5f, 2.0f, 6.0f}) {
    for (const float zeta : {0.0f, 0.05f, 0.2f}) {
      World<D> world(weightless<D>());
      DistanceJointDef<D> def;
      def.body_a = add_fixed(world);
      def.body_b = add_mass(world, 2.2, 0, 3, 1);
      def.length = 2;
      def.spring = {hertz, zeta};
      world.create_joint(def).value();
      const Swing swing =
          measure(world, frame, 6.5 / double(hertz), [&] { return state_of(world, def.body_b).pose.position.x - 2; });
      const double s = math::sqrt(1 - double(zeta) * double(zeta));
      EXPECT_NEAR(swing.period * double(hertz) * s, 1, 0.01) << hertz << " Hz, ζ " << zeta;
      EXPECT_NEAR(swing.per_cycle, math::exp(-2 * pi * double(zeta) / s), 0.03) << hertz << " Hz, ζ " << zeta;
    }
  }
}

TYPED_TEST(JointSprings, AmplitudeWithoutDampingStaysForAMinute) {
  using D = TypeParam;
  World<D> world(weightless<D>());
  DistanceJointDef<D> def;
  def.body_a = add_fixed(world);
  def.body_b = add_mass(world, 2.2, 0, 3, 1);
  def.length = 2;
  def.spring = {6, 0};
  world.create_joint(def).value();
  double highest = 0;
  for (int i = 0; i < 3600; ++i) {
    world.step(frame).value();
    if (i >= 3500) highest = math::max(highest, state_of(world, def.body_b).pose.position.x - 2);
  }
  EXPECT_NEAR(highest, 0.2, 0.03 * 0.2);
}

TYPED_TEST(JointSprings, HingeSliderAndWeldSpringsHaveTheirFrequency) {
  using D = TypeParam;
  const float hertz = 3, zeta = 0.1f;
  const double period = 1 / (double(hertz) * math::sqrt(1 - 0.01));
  {
    World<D> world(weightless<D>());
    HingeJointDef<D> def;
    def.body_a = add_fixed(world);
    def.body_b = add_mass(world, 0, 0, 1, 0.7);
    def.spring = {hertz, zeta};
    def.target_angle = 0.3f;
    world.create_joint(def).value();
    EXPECT_NEAR(
        measure(world, frame, 3, [&] { return angle_of(state_of(world, def.body_b).pose.rotation) - 0.3; }).period,
        period, 0.01 * period);
  }
  {
    World<D> world(weightless<D>());
    SliderJointDef<D> def;
    def.body_a = add_fixed(world);
    def.body_b = add_mass(world, 0, 0, 2, 0.7);
    def.spring = {hertz, zeta};
    def.target_translation = -0.5f;
    world.create_joint(def).value();
    EXPECT_NEAR(measure(world, frame, 3, [&] { return state_of(world, def.body_b).pose.position.x + 0.5; }).period,
                period, 0.01 * period);
  }
  {
    World<D> world(weightless<D>());
    WeldJointDef<D> def;
    def.body_a = add_fixed(world);
    BodyDef<D> body;
    body.position = pos<D>(0.1, 0);
    body.rotation = turned<D>(0.2);
    def.body_b = add_mass(world, body, 2, 0.7);
    def.linear = def.angular = {hertz, zeta};
    world.create_joint(def).value();
    EXPECT_NEAR(measure(world, frame, 3, [&] { return angle_of(state_of(world, def.body_b).pose.rotation); }).period,
                period, 0.01 * period);
  }
}

TYPED_TEST(JointSprings, TwoFreeMassesSwingWithTheReducedMass) {
  using D = TypeParam;
  // mechanics.md 3.7: k = 100, m = 1 and 3: ω = 11.547 rad/s. As an effector between two bodies.
  World<D> world(weightless<D>());
  SpringDamper<D> spring;
  spring.body_a = add_mass(world, 0, 0, 1, 1);
  spring.body_b = add_mass(world, 1.2, 0, 3, 1);
  spring.rest_length = 1;
  spring.stiffness = 100;
  const EffectorId id = world.add_effector(spring).value();
  const Swing swing = measure(world, frame, 4, [&] {
    return state_of(world, spring.body_b).pose.position.x - state_of(world, spring.body_a).pose.position.x - 1;
  });
  EXPECT_NEAR(2 * pi / swing.period, 11.547, 0.01 * 11.547);
  EXPECT_NEAR(swing.per_cycle, 1, 0.005);
  const Totals<D> totals = world.totals();
  EXPECT_NEAR(totals.momentum.x, 0, 1e-5);
  std::vector<JointId> joints;
  world.joints(joints);
  EXPECT_TRUE(joints.empty()) << "the effector's own joint is not the user's";
  world.destroy_effector(id).value();
  EXPECT_FALSE(world.effector_definition(id).ok());
}

// A torsion spring that swings through its rest with ω twists by √(kI) ω = 2π f I ω at most: it breaks above its
// torque.
TYPED_TEST(JointSprings, TorsionSpringsBreakByTorque) {
  using D = TypeParam;
  const double hertz = 1, inertia = 1, strength = 5;
  for (const double share : {0.9, 1.1}) {
    World<D> world(weightless<D>());
    HingeJointDef<D> def;
    def.body_a = add_fixed(world);
    def.body_b = add_mass(world, 0, 0, 2, inertia);
    def.spring = {float(hertz), 0};
    def.break_torque = float(strength);
    const JointId joint = world.create_joint(def).value();
    typename D::Angular spin{};
    const double speed = share * strength / (2 * pi * hertz * inertia);
    if constexpr (D::dimension == 2)
      spin = float(speed);
    else
      spin = {0, 0, float(speed)};
    world.set_velocity(def.body_b, {}, spin).value();
    run(world, 60);
    EXPECT_EQ(world.contains(joint), share < 1) << share;
  }
}

// Above its force a spring gives way: of a mass that runs away from it with v it takes F²/2k of the energy, no more.
TYPED_TEST(JointSprings, SpringsGiveWay) {
  using D = TypeParam;
  for (const bool to_the_world : {true, false})
    for (const double speed : {2.0, 4.0}) {  // √(m k) v: 20 and 40 N at most
      World<D> world(weightless<D>());
      SpringDamper<D> spring;
      spring.body_a = add_mass(world, 1, 0, 1, 1);
      if (!to_the_world) spring.body_b = add_mass(world, 0, 0, 1e9, 1e9);
      spring.stiffness = 100;
      spring.break_force = 25;
      const EffectorId id = world.add_effector(spring).value();
      world.set_velocity(spring.body_a, vec<D>(float(speed), 0), {}).value();
      int breaks = 0;
      double force = 0;
      for (int i = 0; i < 60; ++i) {
        world.step(frame).value();
        for (const SpringBreakEvent<D>& event : world.events().spring_break) {
          ++breaks;
          EXPECT_EQ(event.spring, id);
          EXPECT_EQ(event.body_a, spring.body_a);
          EXPECT_EQ(event.body_b, spring.body_b);
          EXPECT_LT(event.force.x, -25) << "it pulls A back";
          EXPECT_GT(event.force.x, -32) << "a step later at most";
          force = double(event.force.x);
        }
        EXPECT_TRUE(world.events().joint_break.empty());
      }
      EXPECT_EQ(breaks, speed > 3 ? 1 : 0);
      EXPECT_EQ(world.effector_definition(id).ok(), breaks == 0);
      if (breaks > 0)
        EXPECT_NEAR(state_of(world, spring.body_a).linear_velocity.x, std::sqrt(16 - force * force / 100), 0.12);
    }
  World<D> world(weightless<D>());
  SpringDamper<D> spring;
  spring.body_a = add_mass(world, 1, 0, 1, 1);
  spring.break_force = -1;
  EXPECT_NE(world.add_effector(spring).error().message.find("break_force"), std::string::npos);
}

TYPED_TEST(JointSprings, SpringToTheWorldWithDampingRatio) {
  using D = TypeParam;
  // c = 2ζ√(k m): k = 50, m = 2, ζ = .1 → c = 2.
  World<D> world(weightless<D>());
  SpringDamper<D> spring;
  spring.body_a = add_mass(world, 3.1, 0, 2, 1);
  spring.point_b = pos<D>(2, 0);
  spring.stiffness = 50;
  spring.damping = 2;
  world.add_effector(spring).value();
  const Swing swing = measure(world, frame, 8, [&] { return state_of(world, spring.body_a).pose.position.x - 3; });
  EXPECT_NEAR(swing.period, 2 * pi / (5 * math::sqrt(0.99)), 0.01 * 2 * pi / 5);
  EXPECT_NEAR(swing.per_cycle, math::exp(-2 * pi * 0.1 / math::sqrt(0.99)), 0.01);
}

TYPED_TEST(JointSprings, StiffestSpringsDoNotBlowUp) {
  using D = TypeParam;
  // Thirty springs of 500 Hz, undamped, on one light hub; nothing may gain energy.
  World<D> world(weightless<D>());
  const BodyId hub = add_mass(world, 0.01, 0, 0.1, 0.1);
  for (int i = 0; i < 30; ++i) {
    const auto [s, c] = math::sincos(0.2094 * i);
    DistanceJointDef<D> def;
    def.body_a = add_mass(world, c, s, 1, 0.1);
    def.body_b = hub;
    def.spring = {500, 0};
    world.create_joint(def).value();
  }
  for (int i = 0; i < 600; ++i) world.step(frame).value();
  EXPECT_LT(math::length(state_of(world, hub).linear_velocity), 5.0f);
}

}  // namespace joint_spring_test
}  // namespace carom::rigid::test
