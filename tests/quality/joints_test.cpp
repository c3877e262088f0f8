// Chains, pendulums, gyroscopes and springs: gates 3, 10, 11 and 23 (rigid-body.md 6.1). Default settings.
#include <algorithm>
#include <cmath>

#include "tests/quality/chain.h"
#include "tests/quality/gate.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::quality {
namespace joints {

using namespace carom::rigid;
using namespace carom::rigid::test;
using math::length;

template <class D>
class QualityJoints : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(QualityJoints, Dimensions);

// Gate 3.
TYPED_TEST(QualityJoints, ChainWithAHeavyBall) {
  using D = TypeParam;
  for (const float ratio : {100.0f, 1000.0f}) {
    Chain<D> chain(20, ratio);
    chain.run(15);
    const std::string what =
        "chain of 20 links with a ball of " + std::to_string(int(ratio)) + " times their mass: widest gap in 15 s";
    Gate(3, what, D::dimension, "m").at_most(chain.worst_gap, 0.01);
  }
}

// Issue of the engine, 2: 100 links under their own weight.
TYPED_TEST(QualityJoints, HundredLinksUnderTheirOwnWeight) {
  using D = TypeParam;
  Chain<D> chain(100, 0);
  chain.run(15);
  Gate(3, "chain of 100 links falls from level: widest gap in 15 s", D::dimension, "m").at_most(chain.worst_gap, 0.01);
  Chain<D> hanging(100, 0, true);
  hanging.run(10);
  Gate(3, "chain of 100 links hangs: widest gap in 10 s", D::dimension, "m").at_most(hanging.worst_gap, 0.01);
}

// Issue of the engine, 2: ten welded beams of 1 m × .2 × .2, built into a wall.
TYPED_TEST(QualityJoints, CantileverOfTenBeams) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  d.allow_sleep = false;
  World<D> world(d);
  BodyId before{}, beam{};
  for (int i = 0; i < 10; ++i) {
    BodyDef<D> body;
    body.position = rigid::test::at<D>(0.5 + i, 0);
    beam = world.create_body(body).value();
    ShapeDef<D> def;
    def.filter.group = -1;
    world.add_shape(beam, box_shape<D>(0.5f, 0.1f, 0.1f), def).value();
    WeldJointDef<D> weld;
    weld.body_a = before;
    weld.body_b = beam;
    weld.frame_a.p = rigid::test::along<D>(before.is_null() ? 0 : 0.5f, 0);
    weld.frame_b.p = rigid::test::along<D>(-0.5f, 0);
    world.create_joint(weld).value();
    before = beam;
  }
  double lowest = 0;
  for (int i = 0; i < 1800; ++i) {
    world.step(frame).value();
    if (i >= 600) lowest = std::min(lowest, world.state(beam).value().pose.position.y);
  }
  Gate(3, "cantilever of ten welded beams of 1 m: sags", D::dimension, "m").at_most(-lowest, 0.05);
}

/// The first period of a point mass on 1 m released at `degrees`, or the energy left after a minute.
template <class D>
struct Pendulum {
  World<D> world;
  BodyId body;
  Pendulum(double degrees_, bool ball)
      : world([] {
          WorldDef<D> d = world_with<D>();
          d.allow_sleep = false;
          return d;
        }()) {
    const double a = math::radians(degrees_);
    BodyDef<D> def;
    def.position = rigid::test::at<D>(std::sin(a), -std::cos(a));
    body = add_mass<D>(world, def, 1, 1e-4);
    if (ball) {
      BallJointDef<D> joint;
      joint.body_b = body;
      joint.frame_b.p = rigid::test::along<D>(float(-std::sin(a)), float(std::cos(a)));
      world.create_joint(joint).value();
    } else {
      DistanceJointDef<D> joint;
      joint.body_b = body;
      joint.length = 1;
      world.create_joint(joint).value();
    }
  }
  double period() {
    Crossings up;
    double t = 0;
    while (up.times.size() < 2 && t < 20) {
      world.step(frame).value();
      t += double(frame);
      up.add(t, world.state(body).value().pose.position.x);
    }
    return up.period();
  }
  double energy_after_a_minute() {
    run(world, 3600);
    const Totals<D> t = world.totals();
    return t.kinetic_energy / 9.81 + t.potential_energy / 9.81 + 1;  // of m g L above the lowest point
  }
};

// Gate 10: T = 4 K(sin θ/2) √(L/g).
TYPED_TEST(QualityJoints, PendulumAtLargeAmplitude) {
  using D = TypeParam;
  for (const bool ball : {false, true}) {
    const std::string what = ball ? "pendulum on a ball joint" : "pendulum on a rod";
    for (const auto& [angle, period] : {std::pair{60.0, 2.1529}, {90.0, 2.3678}, {120.0, 2.7541}})
      Gate(10, what + " from " + std::to_string(int(angle)) + "°: first period", D::dimension, "s")
          .near(Pendulum<D>(angle, ball).period(), period, 0.005);
    Gate(10, what + " from 90°, 60 s: energy left", D::dimension, "of it")
        .near(Pendulum<D>(90, ball).energy_after_a_minute(), 1, 0.05);
  }
}

// Gate 11: a disc of R .3 m on an arm of .5 m, axis level, ω 80 rad/s, started at Ω = g r/(½ R² ω). With the axis level
// the rate is exact, not the fast top's approximation.
TEST(QualityJoints3, Gyroscope) {
  WorldDef<Dim3> d = world_with<Dim3>();
  d.allow_sleep = false;
  World3 world(d);
  const double radius = 0.3, arm = 0.5, spin = 80, rate = 9.81 * arm / (0.5 * radius * radius * spin);
  EXPECT_NEAR(rate, 1.3625, 1e-4);
  BodyDef<Dim3> body;
  body.position = {arm, 0, 0};
  body.angular_velocity = {float(spin), float(rate), 0};
  body.linear_velocity = {0, 0, float(-rate * arm)};
  const BodyId disc = world.create_body(body).value();
  geometry::MassProperties3 properties;
  properties.mass = 1;
  properties.inertia = Mat3d::diagonal({0.5 * radius * radius, 0.25 * radius * radius, 0.25 * radius * radius});
  world.set_mass_properties(disc, properties).value();
  BallJointDef<Dim3> joint;
  joint.body_b = disc;
  joint.frame_b.p = {float(-arm), 0, 0};
  world.create_joint(joint).value();
  double turned = 0, last = 0, lowest = 0;
  const int steps = 600;
  for (int i = 0; i < steps; ++i) {
    world.step(frame).value();
    const Vec3d p = world.state(disc).value().center_of_mass;
    const double angle = std::atan2(-p.z, p.x);
    double change = angle - last;
    if (change < -pi) change += 2 * pi;
    if (change > pi) change -= 2 * pi;
    turned += change;
    last = angle;
    lowest = std::min(lowest, p.y);
  }
  Gate(11, "gyroscope, level axis, 10 s: precession", 3, "rad/s").near(turned / (steps / 60.0), rate, 0.03);
  Gate(11, "gyroscope: droop (of the arm)", 3, "%").at_most(100 * -lowest / arm, 3);
}

// Gate 23: ω_d = ω √(1 − ζ²), amplitudes in the ratio exp(−2πζ/√(1 − ζ²)) from cycle to cycle, at f h ≤ .1.
TYPED_TEST(QualityJoints, SoftJoints) {
  using D = TypeParam;
  double worst_frequency = 0, worst_amplitude = 0;
  for (const float hertz : {0.5f, 2.0f, 6.0f})
    for (const float zeta : {0.0f, 0.05f, 0.2f})
      for (const int kind : {0, 1, 2}) {
        World<D> world(weightless<D>());
        BodyDef<D> body;
        body.position = rigid::test::at<D>(2.2, 0);
        const BodyId mass = add_mass<D>(world, body, 3, 1);
        if (kind == 0) {
          DistanceJointDef<D> joint;
          joint.body_b = mass;
          joint.length = 2;
          joint.spring = {hertz, zeta};
          world.create_joint(joint).value();
        } else if (kind == 1) {
          SliderJointDef<D> joint;
          joint.body_b = mass;
          joint.frame_a.p = rigid::test::along<D>(2, 0);
          joint.spring = {hertz, zeta};
          world.create_joint(joint).value();
        } else {
          WeldJointDef<D> joint;
          joint.body_b = mass;
          joint.frame_a.p = rigid::test::along<D>(2, 0);
          joint.linear = joint.angular = {hertz, zeta};
          world.create_joint(joint).value();
        }
        Crossings up;
        std::vector<double> peaks;
        double before = 1e30, middle = 0.2, t = 0;
        while (t < 6.5 / double(hertz)) {
          world.step(frame).value();
          t += double(frame);
          const double now = world.state(mass).value().pose.position.x - 2;
          up.add(t, now);
          if (middle > before && middle >= now && middle > 0) {
            const double a = 0.5 * (before + now) - middle, b = 0.5 * (now - before);
            peaks.push_back(a < 0 ? middle - b * b / (4 * a) : middle);
          }
          before = middle;
          middle = now;
        }
        const double s = std::sqrt(1 - double(zeta) * double(zeta));
        const double ratio = std::pow(peaks.back() / peaks.front(), 1.0 / double(peaks.size() - 1));
        worst_frequency = std::max(worst_frequency, std::abs(1 / (up.period() * double(hertz) * s) - 1));
        worst_amplitude = std::max(worst_amplitude, std::abs(ratio / std::exp(-2 * pi * double(zeta) / s) - 1));
      }
  Gate(23, "soft distance, slider and weld joints, .5 to 6 Hz, ζ 0 to .2: frequency off by", D::dimension, "%")
      .at_most(100 * worst_frequency, 1);
  Gate(23, "the same: ratio of amplitudes off by", D::dimension, "%").at_most(100 * worst_amplitude, 3);
}

}  // namespace joints
}  // namespace carom::quality
