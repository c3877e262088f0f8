// Chapter 13, connecting objects: ropes, chains, pendulums and torsion springs in a world of bodies and joints.
// Source of every number: mechanics.md chapter 13 (tag C, computed from closed forms) and rigid-body.md 6.1.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "carom/math/elementary.h"
#include "carom/ode/methods.h"
#include "carom/rigid/world.h"

namespace carom::published {
namespace chapter_13_test {

using namespace carom::rigid;
constexpr float frame = 1.0f / 60;
constexpr double g = 9.80665;

WorldDef<Dim2> plane_world(double gravity = g) {
  WorldDef<Dim2> def;
  def.gravity = {0, float(-gravity)};
  def.allow_sleep = false;
  return def;
}
BodyId mass_at(World2& world, Vec2d p, double mass, double inertia, Rot2f q = {}) {
  BodyDef<Dim2> def;
  def.position = p;
  def.rotation = q;
  const BodyId body = world.create_body(def).value();
  world.set_mass_properties(body, {mass, {}, inertia}).value();
  return body;
}
Vec2d position(const World2& world, BodyId body) { return world.state(body).value().pose.position; }

/// Times at which the signal passes zero upward.
struct Upward {
  std::vector<double> times;
  double before = 0, last = 0;
  bool have = false;
  void add(double t, double value) {
    if (have && before < 0 && value >= 0) times.push_back(last + (t - last) * (-before / (value - before)));
    before = value;
    last = t;
    have = true;
  }
  double period() const { return times.size() < 2 ? 0 : (times.back() - times.front()) / double(times.size() - 1); }
};

/// π/2 over the arithmetic–geometric mean of 1 and √(1 − k²).
double complete_elliptic(double k) {
  double a = 1, b = math::sqrt(1 - k * k);
  for (int i = 0; i < 12; ++i) {
    const double mean = 0.5 * (a + b);
    b = math::sqrt(a * b);
    a = mean;
  }
  return pi / (2 * a);
}

/// A pendulum in the plane: `arm` from the pivot to the centre of mass, moment about it, released at rest.
struct Pendulum {
  World2 world;
  BodyId body;
  double arm;
  Pendulum(double arm_, double inertia, double angle, double gravity, bool hinge)
      : world(plane_world(gravity)), arm(arm_) {
    const auto [s, c] = math::sincos(angle);
    body = mass_at(world, {arm * s, -arm * c}, 1, inertia, {float(c), float(s)});
    if (hinge) {
      HingeJointDef<Dim2> def;
      def.body_b = body;
      def.frame_b.p = {0, float(arm)};
      world.create_joint(def).value();
    } else {
      DistanceJointDef<Dim2> def;
      def.body_b = body;
      def.length = float(arm);
      world.create_joint(def).value();
    }
  }
  double measured_period(int swings) {
    Upward up;
    for (double t = 0; int(up.times.size()) <= swings;) {
      world.step(frame).value();
      t += double(frame);
      up.add(t, position(world, body).x);
      if (t > 60) break;
    }
    return up.period();
  }
};

TEST(Chapter13, PointPendulumAtAnyAmplitude) {
  // rigid-body.md 6.1 #10: 90° 2.3678 s, 60° 2.1529, 120° 2.7541 with g 9.81; first period within .5 %.
  const std::pair<double, double> cases[] = {{60, 2.1529}, {90, 2.3678}, {120, 2.7541}};
  for (const auto& [degrees_, period] : cases) {
    const double angle = radians(degrees_);
    EXPECT_NEAR(4 * complete_elliptic(math::sin(angle / 2)) * math::sqrt(1 / 9.81), period, 1e-4);
    Pendulum pendulum(1, 0.01, angle, 9.81, false);
    const double measured = pendulum.measured_period(1);
    RecordProperty("period_" + std::to_string(int(degrees_)), std::to_string(measured));
    EXPECT_NEAR(measured, period, 0.005 * period) << degrees_ << "°";
  }
}

TEST(Chapter13, PendulumKeepsItsEnergyForAMinute) {
  // rigid-body.md 6.1 #10: energy > 95 % after 60 s of 90° swings.
  Pendulum pendulum(1, 0.01, pi / 2, 9.81, false);
  double highest = -2;
  for (int i = 0; i < 3600; ++i) {
    pendulum.world.step(frame).value();
    if (i > 3300) highest = math::max(highest, position(pendulum.world, pendulum.body).y);
  }
  const double energy = 1 + highest;  // share of m g L above the lowest point
  RecordProperty("energy_after_60_s", std::to_string(energy));
  EXPECT_GT(energy, 0.95);
  EXPECT_LT(energy, 1.005);
}

TEST(Chapter13, RodPendulum) {
  // Rod of 1 m about its end: T₀ = 2π√(2L/3g) = 1.63823 s; amplitude factor 1.01741 at 30°, 1.18034 at 90°.
  const double small = 2 * pi * math::sqrt(2 / (3 * g));
  EXPECT_NEAR(small, 1.63823, 1e-5);
  const std::pair<double, double> cases[] = {{3, 1.000171}, {30, 1.01741}, {90, 1.18034}};
  for (const auto& [degrees_, factor] : cases) {
    Pendulum rod(0.5, 1.0 / 12, radians(degrees_), g, true);
    const double measured = rod.measured_period(4);
    RecordProperty("factor_" + std::to_string(int(degrees_)), std::to_string(measured / small));
    EXPECT_NEAR(measured, small * factor, 0.005 * small * factor) << degrees_ << "°";
  }
}

TEST(Chapter13, TorsionSpringOnARod) {
  // 13.6: rod m = 1, l = 1 about its end (I = 1/3), k_θ = 10 N·m/rad, no gravity: T = 1.14715 s.
  const double period = 2 * pi * math::sqrt(1.0 / 3 / 10);
  EXPECT_NEAR(period, 1.14715, 1e-5);
  World2 world(plane_world(0));
  HingeJointDef<Dim2> def;
  def.body_b = mass_at(world, {0.5, 0}, 1, 1.0 / 12);
  def.frame_b.p = {-0.5f, 0};
  def.spring.hertz =
      float(math::sqrt(10.0 / (1.0 / 3)) / (2 * pi));  // a joint's frequency is that of what swings on it
  const JointId joint = world.create_joint(def).value();
  world.set_velocity(def.body_b, {0, 0.5f}, 1).value();
  Upward up;
  for (double t = 0; t < 8; t += double(frame)) {
    up.add(t, double(world.joint_state(joint).value().coordinate));
    world.step(frame).value();
  }
  RecordProperty("period", std::to_string(up.period()));
  EXPECT_NEAR(up.period(), period, 0.01 * period);
}

TEST(Chapter13, DoublePendulumLowerMode) {
  // Two equal point masses on strings of 1 m: ω₁ = √(g/l (2 − √2)) = 2.3968 rad/s.
  const double omega = math::sqrt(g * (2 - math::sqrt(2.0)));
  EXPECT_NEAR(omega, 2.3968, 1e-4);
  World2 world(plane_world());
  // The lower mode's shape: the second string turns √2 times as far as the first.
  const double a = 0.03, b = a * math::sqrt(2.0);
  const Vec2d p1{math::sin(a), -math::cos(a)}, p2 = p1 + Vec2d{math::sin(b), -math::cos(b)};
  const BodyId m1 = mass_at(world, p1, 1, 0.01), m2 = mass_at(world, p2, 1, 0.01);
  DistanceJointDef<Dim2> def;
  def.body_b = m1;
  world.create_joint(def).value();
  def.body_a = m1;
  def.body_b = m2;
  world.create_joint(def).value();
  Upward up;
  for (double t = 0; t < 14; t += double(frame)) {
    up.add(t, position(world, m2).x);
    world.step(frame).value();
  }
  const double measured = 2 * pi / up.period();
  RecordProperty("omega", std::to_string(measured));
  EXPECT_NEAR(measured, omega, 0.01 * omega);
}

/// A chain of n equal lumps over 1 m, hung from the origin in its first mode's shape.
struct HangingChain {
  World2 world{plane_world()};
  std::vector<BodyId> lumps;
  HangingChain(int n, double amplitude) {
    BodyId above{};
    Vec2d p{};
    for (int i = 0; i < n; ++i) {
      // The continuous first mode J₀(2ω√(z/g)), z from the free end, is close enough; higher modes average out.
      const double z = 1 - double(i + 1) / n, x = amplitude * bessel(2 * 3.7654 * math::sqrt(z / g));
      const double l = 1.0 / n, dx = x - p.x;
      p = {x, p.y - math::sqrt(l * l - dx * dx)};
      const BodyId lump = mass_at(world, p, 1.0 / n, 0.001);
      DistanceJointDef<Dim2> def;
      def.body_a = above;
      def.body_b = lump;
      def.length = float(l);
      world.create_joint(def).value();
      above = lump;
      lumps.push_back(lump);
    }
  }
  /// J₀ by its series; the arguments are below 2.5.
  static double bessel(double x) {
    double term = 1, sum = 1;
    for (int k = 1; k < 12; ++k) {
      term *= -x * x / (4.0 * k * k);
      sum += term;
    }
    return sum;
  }
};

TEST(Chapter13, HangingChainFirstMode) {
  // 20 equal lumps on 1 m: ω₁ = 3.7196 rad/s (the continuous chain: 3.7654).
  HangingChain chain(20, 0.02);
  Upward up;
  for (double t = 0; t < 12; t += double(frame)) {
    up.add(t, position(chain.world, chain.lumps.back()).x);
    chain.world.step(frame).value();
  }
  const double measured = 2 * pi / up.period();
  RecordProperty("omega", std::to_string(measured));
  EXPECT_NEAR(measured, 3.7196, 0.02 * 3.7196);
}

TEST(Chapter13, StaticStretchOfASpringRope) {
  // N = 10 lumps of 1 kg on springs of 1000 N/m, g 9.81: Σ i m g/k = .53955 m.
  World2 world(plane_world(9.81));
  BodyId above{};
  const double rest = 0.3;
  BodyId last{};
  for (int i = 0; i < 10; ++i) {
    last = mass_at(world, {0, -rest * (i + 1)}, 1, 0.1);
    SpringDamper<Dim2> spring;
    spring.body_a = last;
    spring.rest_length = rest;
    spring.stiffness = 1000;
    spring.damping = 20;
    if (i > 0) {
      spring.body_b = above;
    }
    world.add_effector(spring).value();
    above = last;
  }
  for (int i = 0; i < 3600; ++i) world.step(frame).value();
  const double stretch = -position(world, last).y - 10 * rest;
  RecordProperty("stretch", std::to_string(stretch));
  EXPECT_NEAR(stretch, 0.53955, 0.002 * 0.53955);
}

TEST(Chapter13, CatenaryOfALinkedChain) {
  // Span 10, length 12: sag 2.92344 m. Sixty links; 16 substeps, because the stiffness of joints grows with their
  // square and 4 leave the links 1 % too long under this load (sag 3.10 m).
  WorldDef<Dim2> world_def = plane_world();
  world_def.substeps = 16;
  world_def.joint_hertz = 1000;  // as stiff as the substeps permit
  World2 world(world_def);
  const int n = 60;
  const double link = 12.0 / n;
  // Start from a V of the right length, then let it come to rest with the help of drag.
  const double depth = math::sqrt(36.0 - 25.0);
  BodyId above{};
  std::vector<BodyId> lumps;
  for (int i = 1; i <= n; ++i) {
    const double s = double(i) / n;
    const Vec2d p{10 * s, s < 0.5 ? -2 * depth * s : -2 * depth * (1 - s)};
    DistanceJointDef<Dim2> def;
    def.length = float(link);
    def.body_a = above;
    if (i < n) {
      const BodyId lump = mass_at(world, p, 0.2, 0.01);
      world.set_damping(lump, 1.0f, 0).value();
      def.body_b = lump;
      lumps.push_back(lump);
      above = lump;
    } else {
      def.body_a = {};
      def.body_b = above;
      def.frame_a.p = {10, 0};
    }
    world.create_joint(def).value();
  }
  for (int i = 0; i < 2400; ++i) world.step(frame).value();
  double lowest = 0;
  for (const BodyId lump : lumps) lowest = math::min(lowest, position(world, lump).y);
  RecordProperty("sag", std::to_string(-lowest));
  EXPECT_NEAR(-lowest, 2.92344, 0.005 * 2.92344);
}

struct Row {
  double x[60] = {};
  friend Row operator+(const Row& a, const Row& b) {
    Row out;
    for (int i = 0; i < 60; ++i) out.x[i] = a.x[i] + b.x[i];
    return out;
  }
  friend Row operator*(double s, const Row& a) {
    Row out;
    for (int i = 0; i < 60; ++i) out.x[i] = s * a.x[i];
    return out;
  }
};

TEST(Chapter13, SemiImplicitLimitsOfSpringsAndChains) {
  // dt < 2/ω_max: 63.2 ms for one mass on a spring (k = 1000 N/m, m = 1 kg), 31.6 ms for a long chain of them. Half a
  // millisecond less stays bounded, half a millisecond more grows; explicit Euler grows at any step.
  const auto largest = [](int masses, double dt, bool explicit_step) {
    const auto rates = [&](double, const ode::Motion<Row>& y) {
      ode::Motion<Row> out{y.velocity, {}};
      for (int i = 0; i < masses; ++i) {
        const double here = y.position.x[i], left = i > 0 ? y.position.x[i - 1] : 0,
                     right = i + 1 < masses ? y.position.x[i + 1] : here;
        out.velocity.x[i] = 1000 * (left - here + right - here);
      }
      return out;
    };
    ode::Motion<Row> y;
    for (int i = 0; i < masses; ++i) y.position.x[i] = i % 2 == 0 ? 0.1 : -0.1;
    double most = 0;
    for (int i = 0; i < 400; ++i) {
      y = explicit_step ? ode::euler(rates, 0, y, dt) : ode::semi_implicit_euler(rates, 0, y, dt);
      for (int k = 0; k < masses; ++k) most = math::max(most, math::abs(y.position.x[k]));
    }
    return most;
  };
  EXPECT_LT(largest(1, 0.0627, false), 2);
  EXPECT_GT(largest(1, 0.0637, false), 1e3);
  EXPECT_LT(largest(60, 0.0311, false), 2);
  EXPECT_GT(largest(60, 0.0321, false), 1e3);
  EXPECT_GT(largest(1, 0.02, true), 1e3);
}

}  // namespace chapter_13_test
}  // namespace carom::published
