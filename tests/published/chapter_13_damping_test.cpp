// Chapter 13: damping of what connects bodies, and the pulley that turns. Sources: mechanics.md 3.7 and 13.6
// (ζ = c/(2√(kμ)), M = −k_θ θ − c_θ ω) and the closed form of the damped oscillator; Atwood's machine with a sheave.
#include <gtest/gtest.h>

#include <string>

#include "carom/geometry/shape3.h"
#include "carom/math/elementary.h"
#include "carom/particles/rope.h"
#include "carom/rigid/world.h"

namespace carom::published {
namespace chapter_13_damping_test {

using namespace math;
using namespace rigid;
constexpr float frame = 1.0f / 240;
constexpr double g = 9.80665;

/// x(t)/x₀ of ẍ + 2ζω ẋ + ω² x = 0 let go at rest, for ζ ≤ 1.
double damped(double zeta, double omega, double t) {
  if (zeta == 1) return (1 + omega * t) * exp(-omega * t);
  const double rate = zeta * omega, sway = omega * sqrt(1 - zeta * zeta);
  return exp(-rate * t) * (cos(sway * t) + rate / sway * sin(sway * t));
}

WorldDef<Dim3> weightless() {
  WorldDef<Dim3> d;
  d.gravity = {};
  d.allow_sleep = false;
  return d;
}
BodyId solid(World3& world, Vec3d p, double mass, Vec3d inertia = {1, 1, 1}) {
  BodyDef<Dim3> def;
  def.position = p;
  const BodyId body = world.create_body(def).value();
  world.set_mass_properties(body, {mass, {}, Mat3d::diagonal(inertia)}).value();
  return body;
}

// 3.7: k = 100 N/m between 1 and 3 kg, ω = 11.547 rad/s, c = 2ζ√(kμ): the way between them follows the closed form.
TEST(Chapter13Damping, SpringAndDamperBetweenTwoBodies) {
  const double k = 100, mu = 0.75, omega = sqrt(k / mu);
  EXPECT_NEAR(omega, 11.547, 5e-4);
  for (const double zeta : {0.05, 0.2, 0.7, 1.0}) {
    World3 world(weightless());
    SpringDamper<Dim3> spring;
    spring.body_a = solid(world, {0, 0, 0}, 1);
    spring.body_b = solid(world, {1.1, 0, 0}, 3);
    spring.stiffness = k;
    spring.damping = 2 * zeta * sqrt(k * mu);
    world.add_effector(spring).value();
    double worst = 0;
    for (int i = 0; i < 480; ++i) {
      world.step(frame).value();
      const double x = world.state(spring.body_b)->center_of_mass.x - world.state(spring.body_a)->center_of_mass.x - 1;
      worst = max(worst, abs(x / 0.1 - damped(zeta, omega, world.time())));
    }
    RecordProperty("worst_" + std::to_string(zeta), std::to_string(worst));
    EXPECT_LT(worst, 0.02) << zeta;
    EXPECT_NEAR(world.totals().momentum.x, 0, 1e-4);
  }
}

// 13.6: the rod on its torsion spring (I = 1/3, k_θ = 10), c_θ = 2ζ√(k_θ I).
TEST(Chapter13Damping, TorsionSpringOnARod) {
  const double omega = sqrt(30.0);
  for (const double zeta : {0.1, 0.5, 1.0}) {
    World3 world(weightless());
    HingeJointDef<Dim3> hinge;
    hinge.body_b = solid(world, {0.5, 0, 0}, 1, {1e-3, 1.0 / 12, 1.0 / 12});
    hinge.frame_b.p = {-0.5f, 0, 0};
    hinge.spring = {float(omega / (2 * pi)), float(zeta)};
    hinge.target_angle = -0.3f;
    const JointId joint = world.create_joint(hinge).value();
    double worst = 0;
    for (int i = 0; i < 720; ++i) {
      world.step(frame).value();
      const double angle = double(world.joint_state(joint)->coordinate) + 0.3;
      worst = max(worst, abs(angle / 0.3 - damped(zeta, omega, world.time())));
    }
    RecordProperty("worst_" + std::to_string(zeta), std::to_string(worst));
    EXPECT_LT(worst, 0.02) << zeta;
  }
}

// A load bounces on a light rope: k = EA/L, c = (axial damping)/L.
TEST(Chapter13Damping, LoadOnARope) {
  const double length = 2, stiffness = 800, mass = 4, k = stiffness / length, omega = sqrt(k / mass);
  for (const double zeta : {0.05, 0.3}) {
    WorldDef<Dim3> def;
    def.gravity = {0, float(-g), 0};
    World3 world(def);
    particles::RopeSet ropes;
    particles::RopeMaterial m;
    m.mass_per_length = 1e-6;
    m.axial_stiffness = stiffness;
    m.axial_damping = 2 * zeta * sqrt(k * mass) * length;
    m.drag_coefficient = m.skin_coefficient = 0;
    const Vec3d points[] = {{0, 0, 0}, {0, -length, 0}};
    EXPECT_TRUE(ropes.add({.material = m, .points = points, .segments = 4}).ok());
    ropes.add_mass(0, -1, mass).value();
    ropes.attach(0, {.node = 0}, world).value();
    const double stretch = mass * g / k;  // it is let go without tension and falls into it
    double worst = 0;
    for (int i = 1; i <= 960; ++i) {
      ropes.step(world, double(frame)).value();
      const double below = -ropes.positions(0).back().y - length;
      worst = max(worst, abs((stretch - below) / stretch - damped(zeta, omega, i * double(frame))));
    }
    RecordProperty("worst_" + std::to_string(zeta), std::to_string(worst));
    EXPECT_LT(worst, 0.02) << zeta;
  }
}

// Atwood's machine whose sheave turns with the rope: a = (m₁ − m₂) g/(m₁ + m₂ + I/R²). The rope as two racks of one
// pinion, which is exact; the tensions differ by I a/R².
TEST(Chapter13Damping, AtwoodsMachineWithASheaveOfRacks) {
  for (const double inertia : {0.09, 0.36, 1.44}) {
    WorldDef<Dim3> def;
    def.gravity = {0, float(-g), 0};
    World3 world(def);
    const double radius = 0.3, a = 2 * g / (4 + inertia / square(radius));
    const BodyId sheave = solid(world, {0, 0, 0}, 1, {inertia, inertia, inertia});
    HingeJointDef<Dim3> hinge;
    hinge.body_b = sheave;
    world.create_joint(hinge).value();
    BodyId loads[2];
    JointId racks[2];
    const Quatf up{float(sqrt(0.5)), 0, 0, float(sqrt(0.5))};  // x of the frame along y
    for (int side = 0; side < 2; ++side) {
      const double x = side == 0 ? -radius : radius;
      loads[side] = solid(world, {x, -1, 0}, side == 0 ? 3 : 1);
      SliderJointDef<Dim3> slider;
      slider.body_b = loads[side];
      slider.frame_a = {{float(x), -1, 0}, up};
      slider.frame_b.q = up;
      world.create_joint(slider).value();
      RackJointDef<Dim3> rack;
      rack.body_a = sheave;
      rack.body_b = loads[side];
      rack.frame_b.q = up;
      rack.radius = float(x);
      racks[side] = world.create_joint(rack).value();
    }
    for (int step = 0; step < 120; ++step) world.step(frame).value();
    const double t = world.time();
    EXPECT_NEAR(double(world.state(loads[0])->linear_velocity.y), -a * t, 2e-3 * a * t) << inertia;
    EXPECT_NEAR(double(world.state(loads[1])->linear_velocity.y), a * t, 2e-3 * a * t) << inertia;
    EXPECT_NEAR(double(world.state(sheave)->angular_velocity.z), a * t / radius, 2e-3 * a * t / radius) << inertia;
  }
}

// And with a rope that lies on a wheel and takes it along by friction: the rope does not slip, I/R² counts in full.
// Sixty steps a second leave out what the rope loses while it comes to lie on the wheel.
TEST(Chapter13Damping, AtwoodsMachineWithARopeOverAWheel) {
  struct Case {
    double share;  // I/R² in kg
    int rate;      // Hz
  };
  std::vector<Case> cases;
  for (const double share : {0.0, 0.5, 1.0, 1.3, 2.0})
    for (const int rate : {240, 60}) cases.push_back({share, rate});
  for (const double share : {0.3, 0.7, 1.6, 1.9, 2.05, 2.3, 2.5}) cases.push_back({share, 60});
  for (const auto [share, rate] : cases) {
    const float frame = 1 / float(rate);
    WorldDef<Dim3> settings;
    settings.gravity = {0, float(-g), 0};
    World3 world(settings);
    particles::RopeSet ropes;
    const double radius = 0.2, thin = 0.002, line = radius + thin, inertia = max(share, 0.02) * square(line);
    BodyDef<Dim3> def;
    def.rotation = {float(sqrt(0.5)), float(sqrt(0.5)), 0, 0};  // its own y along z
    const BodyId wheel = world.create_body(def).value();
    ShapeDef<Dim3> shape;
    shape.material.friction = 1;
    world.add_shape(wheel, geometry::Cylinder{0.5f, float(radius)}, shape).value();
    world.set_mass_properties(wheel, {5, {}, Mat3d::diagonal({1, inertia, 1})}).value();
    HingeJointDef<Dim3> hinge;
    hinge.body_b = wheel;
    hinge.frame_b.q = {float(sqrt(0.5)), float(-sqrt(0.5)), 0, 0};
    world.create_joint(hinge).value();
    std::vector<Vec3d> points{{-line, -1, 0}};
    for (int i = 0; i <= 40; ++i) points.push_back({-line * cos(pi * i / 40), line * sin(pi * i / 40), 0});
    points.push_back({line, -1, 0});
    particles::RopeMaterial m;
    m.mass_per_length = 0.002;
    m.radius = thin;
    m.axial_stiffness = 1e6;
    m.friction = 1;
    m.drag_coefficient = m.skin_coefficient = 0;
    EXPECT_TRUE(ropes.add({.material = m, .points = points, .segments = 80}).ok());
    const BodyId heavy = solid(world, points.front(), 3), light = solid(world, points.back(), 1);
    ropes.attach(0, {.node = 0, .body = heavy}, world).value();
    ropes.attach(0, {.node = -1, .body = light}, world).value();
    const auto run = [&](double seconds) {
      for (double t = 0; t < seconds - 1e-9; t += double(frame)) {
        ropes.step(world, double(frame)).value();
        world.step(frame).value();
      }
      return double(world.state(heavy)->linear_velocity.y);
    };
    const double before = run(0.1), found = (before - run(0.3)) / 0.3;
    const double expected = 2 * g / (4 + inertia / square(line));
    RecordProperty("acceleration_" + std::to_string(share) + "_" + std::to_string(rate),
                   std::to_string(found / expected));
    EXPECT_NEAR(found, expected, (rate == 240 ? 0.02 : 0.08) * expected) << share << " kg, " << rate << " Hz";
    EXPECT_NEAR(double(world.state(wheel)->angular_velocity.z) * line, -double(world.state(heavy)->linear_velocity.y),
                0.04 * found)
        << share << " kg, " << rate << " Hz: it does not slip";
  }
}

}  // namespace chapter_13_damping_test
}  // namespace carom::published
