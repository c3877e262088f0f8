// Chapter 13 through carom/particles/rope.h. Source of every number: mechanics.md chapter 13 (closed forms).
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "carom/math/elementary.h"
#include "carom/particles/rope.h"

namespace carom::published {
namespace chapter_13_rope_test {

using namespace math;
using particles::RopeMaterial;
using particles::RopeSet;
using rigid::World3;
constexpr double dt = 1.0 / 60, g = 9.80665;

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
  double omega() const {
    return times.size() < 2 ? 0 : 2 * pi * double(times.size() - 1) / (times.back() - times.front());
  }
};
double bessel(double x) {  // J₀ by its series
  double term = 1, sum = 1;
  for (int k = 1; k < 40; ++k) {
    term *= -x * x / (4.0 * k * k);
    sum += term;
  }
  return sum;
}
RopeMaterial in_vacuum(double mass_per_length = 1, double stiffness = 1e7) {
  RopeMaterial m;
  m.mass_per_length = mass_per_length;
  m.axial_stiffness = stiffness;
  m.drag_coefficient = m.skin_coefficient = 0;
  return m;
}

/// A chain of 1 m from the origin in the shape J₀(2ω√(z/g)), z above its free end.
double mode_of_hanging_chain(int segments, double omega, double seconds, bool lumps) {
  World3 world;
  RopeSet ropes;
  std::vector<Vec3d> points{{0, 0, 0}};
  double y = 0;
  for (int i = 1; i <= segments; ++i) {
    const double z = 1 - double(i) / segments, x = 0.004 * bessel(2 * omega * sqrt(z / g));
    y -= sqrt(1.0 / (segments * segments) - square(x - points.back().x));
    points.push_back({x, y, 0});
  }
  EXPECT_TRUE(ropes.add({.material = in_vacuum(), .points = points, .segments = segments}).ok());
  // Equal lumps: the last one, too, is whole.
  if (lumps) ropes.add_mass(0, -1, 0.5 / segments).value();
  ropes.attach(0, {.node = 0}, world).value();
  Upward up;
  for (double t = 0; t < seconds; t += dt) {
    up.add(t, ropes.positions(0).back().x);
    ropes.step(world, dt).value();
  }
  return up.omega();
}

TEST(Chapter13Rope, HangingChainModes) {
  // ω_n = ½ j₀ₙ √(g/L): 3.7654 and 13.5498 rad/s; 20 equal lumps: 3.7196.
  const double first = mode_of_hanging_chain(100, 3.7654, 12, false);
  const double third = mode_of_hanging_chain(100, 13.5498, 3, false);
  const double lumps = mode_of_hanging_chain(20, 3.7654, 12, true);
  RecordProperty("first", std::to_string(first));
  RecordProperty("third", std::to_string(third));
  RecordProperty("lumps", std::to_string(lumps));
  EXPECT_NEAR(first, 3.7654, 0.002 * 3.7654);
  EXPECT_NEAR(third, 13.5498, 0.005 * 13.5498);
  EXPECT_NEAR(lumps, 3.7196, 0.002 * 3.7196);
}

TEST(Chapter13Rope, StaticStretch) {
  // N = 10 lumps of 1 kg on springs of 1000 N/m, g 9.81: Σ i m g/k = .53955 m.
  rigid::WorldDef<rigid::Dim3> def;
  def.gravity = {0, -9.81f, 0};
  World3 world(def);
  RopeSet ropes;
  const Vec3d points[] = {{0, 0, 0}, {0, -3, 0}};
  RopeMaterial m = in_vacuum(1e-9, 300);  // EA = k l
  m.axial_damping = 20 * 0.3;
  EXPECT_TRUE(ropes.add({.material = m, .points = points, .segments = 10}).ok());
  for (int i = 1; i <= 10; ++i) ropes.add_mass(0, i, 1).value();
  ropes.attach(0, {.node = 0}, world).value();
  for (int i = 0; i < 3600; ++i) ropes.step(world, dt).value();
  const double stretch = ropes.length(0) - 3;
  RecordProperty("stretch", std::to_string(stretch));
  EXPECT_NEAR(stretch, 0.53955, 1e-4 * 0.53955);
}

TEST(Chapter13Rope, StiffSpringsAreStableBeyondTheExplicitLimit) {
  // Semi-implicit limit dt < 2/ω: 63.2 ms for k = 1000 N/m, m = 1 kg. The rope's step takes 500 ms with one substep.
  World3 world;
  RopeSet ropes;
  ropes.set_substeps(1).value();
  const Vec3d points[] = {{0, 0, 0}, {0, -0.4, 0}};
  EXPECT_TRUE(ropes.add({.material = in_vacuum(1e-9, 300), .points = points, .segments = 1, .length = 0.3}).ok());
  ropes.add_mass(0, 1, 1).value();
  ropes.attach(0, {.node = 0}, world).value();
  for (int i = 0; i < 400; ++i) {
    ropes.step(world, 0.5).value();
    ASSERT_LT(ropes.length(0), 0.6);
  }
  EXPECT_NEAR(ropes.length(0), 0.3 + g / 1000, 1e-4);
}

TEST(Chapter13Rope, Catenary) {
  // Span 10, length 12: a = 4.69542 m, sag 2.92344 m; the horizontal pull is ρ g a.
  World3 world;
  RopeSet ropes;
  const double depth = sqrt(36.0 - 25.0);
  const Vec3d points[] = {{0, 0, 0}, {5, -depth, 0}, {10, 0, 0}};
  RopeMaterial m = in_vacuum(1, 1e7);
  m.drag_coefficient = 1.2;
  EXPECT_TRUE(ropes.add({.material = m, .points = points, .segments = 80}).ok());
  ropes.attach(0, {.node = 0}, world).value();
  ropes.attach(0, {.node = -1, .point = {10, 0, 0}}, world).value();
  ropes.set_air({.density = 5000});  // comes to rest in thick air
  for (int i = 0; i < 1800; ++i) ropes.step(world, dt).value();
  double lowest = 0;
  for (const Vec3d& p : ropes.positions(0)) lowest = min(lowest, p.y);
  const double pull = ropes.attachment_force(0, 0).x;
  RecordProperty("sag", std::to_string(-lowest));
  RecordProperty("a", std::to_string(pull / g));
  EXPECT_NEAR(-lowest, 2.92344, 0.001 * 2.92344);
  EXPECT_NEAR(pull / g, 4.69542, 0.002 * 4.69542);
  EXPECT_NEAR(ropes.length(0), 12, 0.0001);
}

TEST(Chapter13Rope, DoublePendulumLowerMode) {
  // Two equal point masses on strings of 1 m: 2.3968 rad/s.
  World3 world;
  RopeSet ropes;
  const double a = 0.03, b = a * sqrt(2.0);
  const Vec3d p1{sin(a), -cos(a), 0}, p2 = p1 + Vec3d{sin(b), -cos(b), 0}, points[] = {{0, 0, 0}, p1, p2};
  EXPECT_TRUE(ropes.add({.material = in_vacuum(1e-6), .points = points, .segments = 2}).ok());
  ropes.add_mass(0, 1, 1).value();
  ropes.add_mass(0, 2, 1).value();
  ropes.attach(0, {.node = 0}, world).value();
  Upward up;
  for (double t = 0; t < 14; t += dt) {
    up.add(t, ropes.positions(0)[2].x);
    ropes.step(world, dt).value();
  }
  RecordProperty("omega", std::to_string(up.omega()));
  EXPECT_NEAR(up.omega(), 2.3968, 0.002 * 2.3968);
}

TEST(Chapter13Rope, RodPendulumHungByARope) {
  // A rod of 1 m on a hinge has T₀ = 1.63823 s; here the rope's clamp holds a body and swings as a compound pendulum:
  // rod of 1 kg, I = 1/12 about its middle, hung .5 m below the pivot by a rigid short piece of rope to its end.
  World3 world;
  RopeSet ropes;
  const double angle = radians(3.0);
  const Vec3d way{sin(angle), -cos(angle), 0};
  rigid::BodyDef<rigid::Dim3> def;
  def.position = 0.5 * way;
  def.rotation = {float(cos(angle / 2)), 0, 0, float(sin(angle / 2))};
  const auto rod = world.create_body(def).value();
  world.set_mass_properties(rod, {1, {}, Mat3d::diagonal({1.0 / 12, 1e-3, 1.0 / 12})}).value();
  const Vec3d points[] = {{0, 0, 0}, 0.001 * way};
  EXPECT_TRUE(ropes.add({.material = in_vacuum(1e-3), .points = points, .segments = 1}).ok());
  ropes.attach(0, {.node = 0}, world).value();
  ropes.attach(0, {.node = 1, .body = rod, .point = {0, 0.499, 0}}, world).value();
  Upward up;
  for (double t = 0; t < 14; t += dt) {
    up.add(t, world.state(rod)->center_of_mass.x);
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
  }
  const double period = 2 * pi / up.omega();
  RecordProperty("period", std::to_string(period));
  EXPECT_NEAR(period, 1.63823, 0.005 * 1.63823);
}

TEST(Chapter13Rope, TorsionPendulum) {
  // T = 2π √(I/k) = 1.14715 s for I = 1/3 kg·m², k = GJ/L = 10 N·m/rad: the body hangs on a wire of 1 m that twists.
  World3 world;
  RopeSet ropes;
  RopeMaterial m = in_vacuum(0.01);
  m.torsional_stiffness = 10;
  const Vec3d points[] = {{0, 0, 0}, {0, -1, 0}};
  EXPECT_TRUE(ropes.add({.material = m, .points = points, .segments = 10}).ok());
  rigid::BodyDef<rigid::Dim3> def;
  def.position = {0, -1, 0};
  def.angular_velocity = {0, 2, 0};
  const auto bob = world.create_body(def).value();
  world.set_mass_properties(bob, {5, {}, Mat3d::diagonal({1.0, 1.0 / 3, 1.0})}).value();
  ropes.attach(0, {.node = 0, .clamped = true}, world).value();
  ropes.attach(0, {.node = -1, .body = bob, .clamped = true}, world).value();
  Upward up;
  double largest = 0;
  for (double t = 0; t < 8; t += dt) {
    up.add(t, ropes.twist(0));
    largest = max(largest, ropes.twist(0));
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
  }
  const double period = 2 * pi / up.omega();
  RecordProperty("period", std::to_string(period));
  EXPECT_NEAR(period, 1.14715, 0.005 * 1.14715);
  EXPECT_NEAR(largest, 2 / sqrt(30.0), 0.02);
}

}  // namespace chapter_13_rope_test
}  // namespace carom::published
