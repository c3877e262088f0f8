// Trees of joints are solved directly: they hold at any mass ratio (rigid-body.md 6.1 #3), and keep energy and
// momentum.
#include "mechanics_world.h"

namespace carom::rigid::test {
namespace joint_tree_test {

template <class D>
class JointTrees : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(JointTrees, Dimensions);

template <class D>
WorldDef<D> restless(JointSolver solver = JointSolver::automatic) {
  WorldDef<D> d;
  d.gravity = vec<D>(0, -9.81f);
  d.allow_sleep = false;
  d.joint_solver = solver;
  return d;
}
template <class D>
typename D::MassProperties rod(double mass, double length) {
  typename D::MassProperties p;
  p.mass = mass;
  const double across = mass * length * length / 12;
  if constexpr (D::dimension == 2)
    p.inertia = across;
  else
    p.inertia = Mat3d::diagonal({0.005 * mass, across, across});
  return p;
}
template <class D>
double energy(const World<D>& world) {
  return world.totals().kinetic_energy + world.totals().potential_energy;
}

/// Links of 1 kg and 1 m along x from the origin, and a ball of `load` kg at the end of the last.
template <class D>
BodyId hang_chain(World<D>& world, int links, double load, bool level) {
  BodyId above{};
  for (int i = 0; i <= links; ++i) {
    const bool ball = i == links;
    BodyDef<D> def;
    const double along = ball ? links : i + 0.5;
    def.position = level ? pos<D>(along, 0) : pos<D>(0, -along);
    if (!level) def.rotation = turned<D>(-pi / 2);
    BodyId body;
    if (ball) {
      body = add_mass(world, def, load, 0.4 * load);
    } else {
      body = world.create_body(def).value();
      world.set_mass_properties(body, rod<D>(1, 1)).value();
    }
    BallJointDef<D> joint;
    joint.body_a = above;
    joint.body_b = body;
    if (i > 0) joint.frame_a.p = vec<D>(0.5f, 0);
    if (!ball) joint.frame_b.p = vec<D>(-0.5f, 0);
    world.create_joint(joint).value();
    above = body;
  }
  return above;
}
template <class D>
float worst_gap(World<D>& world, int steps) {
  float worst = 0;
  for (int i = 0; i < steps; ++i) {
    world.step(frame).value();
    worst = math::max(worst, world.worst_joint_error());
  }
  return worst;
}

TYPED_TEST(JointTrees, HeavyChainSwingsWithoutAGap) {
  using D = TypeParam;
  for (const int links : {10, 20})
    for (const double load : {1.0, 10.0, 100.0, 1000.0, 10000.0}) {
      World<D> world(restless<D>());
      hang_chain(world, links, load, true);
      const float gap = worst_gap(world, 900);
      EXPECT_LT(gap, 0.01f) << links << " links, load " << load;
      // It was let go at height 0; the deepest point lies (links/2 + load) g links below.
      const double scale = (0.5 * links + load) * 9.81 * links;
      EXPECT_LT(energy(world), 0.001 * scale) << links << " links, load " << load << ", of " << scale;
      testing::Test::RecordProperty("gap_" + std::to_string(links) + "_" + std::to_string(int(load)),
                                    std::to_string(gap));
      testing::Test::RecordProperty("energy_" + std::to_string(links) + "_" + std::to_string(int(load)),
                                    std::to_string(energy(world) / scale));
    }
}

TYPED_TEST(JointTrees, HundredLinksHangUnderTheirOwnWeight) {
  World<TypeParam> world(restless<TypeParam>());
  hang_chain(world, 100, 1, false);
  EXPECT_LT(worst_gap(world, 600), 1e-4f);
}

TYPED_TEST(JointTrees, RodsCarryToo) {
  // Lumps on rigid distance joints, 1000 : 1, let go level.
  using D = TypeParam;
  World<D> world(restless<D>());
  BodyId above{};
  for (int i = 0; i < 10; ++i) {
    DistanceJointDef<D> rod;
    rod.body_a = above;
    rod.body_b = add_mass(world, i + 1, 0, i == 9 ? 1000 : 1, 0.1);
    rod.length = 1;
    world.create_joint(rod).value();
    above = rod.body_b;
  }
  EXPECT_LT(worst_gap(world, 900), 0.01f);
  EXPECT_LT(energy(world), 0.001 * 1000 * 9.81 * 10);
}

TYPED_TEST(JointTrees, CantileverOfTenBeams) {
  using D = TypeParam;
  World<D> world(restless<D>());
  BodyId above{}, last{};
  for (int i = 0; i < 10; ++i) {
    last = add_mass(world, i + 0.5, 0, 40, 40.0 / 12);
    WeldJointDef<D> weld;
    weld.body_a = above;
    weld.body_b = last;
    if (i > 0) weld.frame_a.p = vec<D>(0.5f, 0);
    weld.frame_b.p = vec<D>(-0.5f, 0);
    world.create_joint(weld).value();
    above = last;
  }
  double lowest = 0;
  for (int i = 0; i < 600; ++i) {
    world.step(frame).value();
    lowest = math::min(lowest, double(state_of(world, last).pose.position.y));
  }
  EXPECT_GT(lowest, -1e-3);
  EXPECT_NEAR(math::length(state_of(world, last).linear_velocity), 0, 1e-4);
}

TYPED_TEST(JointTrees, PendulumKeepsItsEnergyAndPeriod) {
  // rigid-body.md 6.1 #10: T = 4 K(sin θ/2) √(L/g).
  using D = TypeParam;
  const double periods[][2] = {{60, 2.1529}, {90, 2.3678}, {120, 2.7541}};
  for (const auto& [degrees, period] : periods) {
    World<D> world(restless<D>(JointSolver::direct));
    const auto [s, c] = math::sincos(degrees * pi / 180);
    const BodyId mass = add_mass(world, s, -c, 1, 1e-4);
    DistanceJointDef<D> rod;
    rod.body_b = mass;
    world.create_joint(rod).value();
    const double before = energy(world);
    Crossings up;
    for (int i = 0; i < 3600; ++i) {
      world.step(frame).value();
      up.add(i / 60.0, state_of(world, mass).pose.position.x);
    }
    EXPECT_NEAR(up.period(), period, 0.002 * period);
    const double kept = (energy(world) + 9.81) / (before + 9.81);
    EXPECT_GT(kept, 0.99) << degrees;
    // Velocities are those of half a substep before: at the lowest point that is worth g v h/2.
    EXPECT_LT(kept, 1.01) << degrees;
  }
}

TYPED_TEST(JointTrees, BridgeHoldsAtBothEnds) {
  // Twelve links between two anchors 10 m apart, with 1000 kg on the middle one: more than one way to the ground.
  using D = TypeParam;
  World<D> world(restless<D>());
  BodyId above{};
  for (int i = 0; i <= 12; ++i) {
    BallJointDef<D> joint;
    joint.body_a = above;
    if (i > 0) joint.frame_a.p = vec<D>(0.5f, 0);
    if (i < 12) {
      BodyDef<D> def;
      // A V of links: 12 m over a span of 10 m.
      const double tilt = math::acos(10.0 / 12), down = i < 6 ? i + 0.5 : 11.5 - i;
      def.position = pos<D>((i + 0.5) * 10 / 12, -down * math::sin(tilt));
      def.rotation = turned<D>(i < 6 ? -tilt : tilt);
      joint.body_b = world.create_body(def).value();
      world.set_mass_properties(joint.body_b, rod<D>(i == 6 ? 1000 : 1, 1)).value();
      joint.frame_b.p = vec<D>(-0.5f, 0);
    } else {
      joint.body_a = {};
      joint.body_b = above;
      joint.frame_a.p = vec<D>(10, 0);
      joint.frame_b.p = vec<D>(0.5f, 0);
    }
    world.create_joint(joint).value();
    above = joint.body_b;
  }
  EXPECT_LT(worst_gap(world, 900), 0.01f);
}

TYPED_TEST(JointTrees, FreeTreeKeepsItsMomenta) {
  using D = TypeParam;
  WorldDef<D> definition = weightless<D>();
  definition.joint_solver = JointSolver::direct;
  World<D> world(definition);
  BodyId before{};
  for (int i = 0; i < 8; ++i) {
    BodyDef<D> def;
    def.position = pos<D>(i, 0);
    def.linear_velocity = vec<D>(0.5f, 0.3f * float(i * i % 5));
    const BodyId body = world.create_body(def).value();
    world.set_mass_properties(body, rod<D>(i == 7 ? 100 : 1, 1)).value();
    if (i > 0) {
      HingeJointDef<D> joint;
      joint.body_a = before;
      joint.body_b = body;
      joint.frame_a.p = vec<D>(0.5f, 0);
      joint.frame_b.p = vec<D>(-0.5f, 0);
      world.create_joint(joint).value();
    }
    before = body;
  }
  world.step(frame).value();
  const Totals<D> start = world.totals();
  for (int i = 0; i < 600; ++i) world.step(frame).value();
  const Totals<D> end = world.totals();
  EXPECT_NEAR(end.momentum.x, start.momentum.x, 1e-5 * start.mass);
  EXPECT_NEAR(end.momentum.y, start.momentum.y, 1e-5 * start.mass);
  if constexpr (D::dimension == 2)
    EXPECT_NEAR(end.angular_momentum, start.angular_momentum, 1e-3 * start.mass);
  else
    EXPECT_NEAR(end.angular_momentum.z, start.angular_momentum.z, 1e-3 * start.mass);
  EXPECT_LT(end.kinetic_energy, 1.0001 * start.kinetic_energy);
  EXPECT_GT(end.kinetic_energy, 0.9 * start.kinetic_energy);
  EXPECT_LT(world.worst_joint_error(), 1e-3f);
}

TYPED_TEST(JointTrees, ImpossibleSpanStaysBounded) {
  // Five links of 1 m between anchors 6 m apart.
  using D = TypeParam;
  World<D> world(restless<D>(JointSolver::direct));
  BodyId above{};
  std::vector<BodyId> bodies;
  for (int i = 0; i <= 5; ++i) {
    BallJointDef<D> joint;
    joint.body_a = above;
    if (i > 0) joint.frame_a.p = vec<D>(0.5f, 0);
    if (i < 5) {
      joint.body_b = add_mass(world, 1.2 * i + 0.6, 0, 1, 0.1);
      bodies.push_back(joint.body_b);
      joint.frame_b.p = vec<D>(-0.5f, 0);
    } else {
      joint.body_a = {};
      joint.body_b = above;
      joint.frame_a.p = vec<D>(6, 0);
      joint.frame_b.p = vec<D>(0.5f, 0);
    }
    world.create_joint(joint).value();
    above = joint.body_b;
  }
  for (int i = 0; i < 600; ++i) {
    world.step(frame).value();
    for (const BodyId body : bodies) {
      ASSERT_LT(math::length(state_of(world, body).linear_velocity), 20.0f) << i;
      ASSERT_LT(math::abs(state_of(world, body).pose.position.y), 2) << i;
    }
  }
}

/// A carriage of 1 kg on an upright rail with a motor; from it hang ten links and a ball of `load` kg.
template <class D>
struct Hoist {
  World<D> world;
  JointId rail;
  Hoist(double load, const JointMotor& motor) : world(restless<D>()) {
    BodyId above = add_mass(world, 0, 0, 1, 0.1);
    SliderJointDef<D> slider;
    slider.body_b = above;
    slider.frame_a.q = slider.frame_b.q = turned<D>(pi / 2);
    slider.motor = motor;
    rail = world.create_joint(slider).value();
    for (int i = 0; i <= 10; ++i) {
      BallJointDef<D> joint;
      joint.body_a = above;
      joint.body_b =
          i < 10 ? add_mass(world, 0, -0.25f - 0.5f * float(i), 1, 0.05) : add_mass(world, 0, -5.5f, load, 0.1 * load);
      joint.frame_a.p = vec<D>(0, i > 0 ? -0.25f : 0);
      joint.frame_b.p = vec<D>(0, i < 10 ? 0.25f : 0.5f);
      world.create_joint(joint).value();
      above = joint.body_b;
    }
  }
};

TYPED_TEST(JointTrees, AMotorLiftsAllThatHangsOnIt) {
  using D = TypeParam;
  for (const double load : {1.0, 30.0, 1000.0}) {
    const float weight = float((11 + load) * 9.81);
    Hoist<D> lifts(load, {true, 1, 2 * weight});
    for (int i = 0; i < 300; ++i) lifts.world.step(frame).value();
    const JointState<D> state = lifts.world.joint_state(lifts.rail).value();
    EXPECT_TRUE(state.direct);
    EXPECT_NEAR(state.speed, 1, 1e-3f) << load;
    EXPECT_NEAR(math::length(state.force), weight, 1e-3f * weight) << load;

    Hoist<D> brakes(load, {true, 0, 2 * weight});
    for (int i = 0; i < 600; ++i) brakes.world.step(frame).value();
    EXPECT_NEAR(brakes.world.joint_state(brakes.rail).value().coordinate, 0, 1e-3f) << load;

    // With half of the weight it slips at g/2.
    Hoist<D> slips(load, {true, 0, 0.5f * weight});
    for (int i = 0; i < 60; ++i) slips.world.step(frame).value();
    EXPECT_NEAR(slips.world.joint_state(slips.rail).value().speed, -0.5f * 9.81f, 0.01f) << load;
  }
}

enum class Held { by_stop, by_motor, by_friction, by_spring };
/// The angle of an arm of ten welded beams of 1 m and 10 kg after a minute, at a hinge (a ball joint for friction).
template <class D>
double arm_angle(Held held, float hertz = 0) {
  World<D> world(restless<D>());
  BodyId before{};
  for (int i = 0; i < 10; ++i) {
    BodyDef<D> def;
    def.position = pos<D>(i + 0.5, 0);
    const BodyId beam = world.create_body(def).value();
    world.set_mass_properties(beam, rod<D>(10, 1)).value();
    const auto hang = [&](auto joint) {
      joint.body_a = before;
      joint.body_b = beam;
      joint.frame_a.p = vec<D>(i > 0 ? 0.5f : 0, 0);
      joint.frame_b.p = vec<D>(-0.5f, 0);
      world.create_joint(joint).value();
    };
    HingeJointDef<D> hinge;
    if (held == Held::by_stop) hinge.limit = {true, 0, 1};
    if (held == Held::by_motor) hinge.motor = {true, 0, 1e4f};
    if (held == Held::by_spring) hinge.spring = {hertz, 1};
    BallJointDef<D> ball;
    ball.friction_torque = 1e4f;
    if (i > 0)
      hang(WeldJointDef<D>{});
    else if (held == Held::by_friction)
      hang(ball);
    else
      hang(hinge);
    before = beam;
  }
  for (int i = 0; i < 3600; ++i) world.step(frame).value();
  return math::asin(state_of(world, before).pose.position.y / 9.5);
}

TYPED_TEST(JointTrees, StopsMotorsFrictionAndSpringsHoldALongArm) {
  using D = TypeParam;
  EXPECT_NEAR(arm_angle<D>(Held::by_stop), 0, 1e-3);
  EXPECT_NEAR(arm_angle<D>(Held::by_motor), 0, 1e-3);
  EXPECT_NEAR(arm_angle<D>(Held::by_friction), 0, 1e-3);
  // k = ω² m l²/3 of the first beam, to which the spring's frequency belongs: k θ = M g L/2 cos θ.
  for (const float hertz : {10.0f, 20.0f}) {
    const double k = math::square(2 * pi * double(hertz)) * 10.0 / 3;
    double theta = 0;
    for (int i = 0; i < 50; ++i) theta = 100 * 9.81 * 5 * math::cos(theta) / k;
    EXPECT_NEAR(arm_angle<D>(Held::by_spring, hertz), -theta, 0.03 * theta) << hertz;
  }
}

TYPED_TEST(JointTrees, SameBitsForAnyThreads) {
  using D = TypeParam;
  std::uint64_t hashes[2];
  for (const int threads : {1, 2}) {
    WorldDef<D> definition = restless<D>(JointSolver::direct);
    definition.threads = threads;
    World<D> world(definition);
    for (int i = 0; i < 40; ++i) {
      const BodyId a = add_mass(world, 5 * i, 0, 1 + i, 0.2), b = add_mass(world, 5 * i + 1, 1, 2, 0.4);
      BallJointDef<D> joint;
      joint.body_b = a;
      joint.frame_a.p = vec<D>(float(5 * i), 1);
      joint.frame_b.p = vec<D>(0, 1);
      world.create_joint(joint).value();
      joint.body_a = a;
      joint.body_b = b;
      joint.frame_a.p = vec<D>(1, 0);
      joint.frame_b.p = vec<D>(0, -1);
      world.create_joint(joint).value();
    }
    for (int i = 0; i < 120; ++i) world.step(frame).value();
    hashes[threads - 1] = world.state_hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

}  // namespace joint_tree_test
}  // namespace carom::rigid::test
