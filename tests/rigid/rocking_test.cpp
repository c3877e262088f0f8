// What rocks on something round: its period, and that it gains no energy.
#include <gtest/gtest.h>

#include "carom/math/rotation.h"
#include "scene_pieces.h"

namespace carom::rigid::test {
namespace {

constexpr double log_radius = 0.5, half_thickness = 0.05, half_length = 1, lean = 0.12;

float angle_of(const Rot2f& q) { return -math::atan2(q.s, q.c); }
float angle_of(const Quatf& q) {
  const Vec3f along = rotate(q, Vec3f{1, 0, 0});
  return -math::atan2(along.y, along.x);
}
template <class D>
typename D::Rotation leaning(double angle) {
  if constexpr (D::dimension == 2)
    return Rot2f(float(math::cos(angle)), float(-math::sin(angle)));
  else
    return math::from_axis_angle(Vec3f{0, 0, 1}, float(-angle));
}
float square_of(float w) { return w * w; }
float square_of(const Vec3f& w) { return math::length_squared(w); }

struct Rocking {
  double period = 0, gained = -1e30, left = 0, swing = 0;  // s, m²/s² (of the body's mass), the same, rad
};

/// A plank lies on a fixed log, rolled off its middle by `lean` rad without slipping, and rocks for 30 s.
template <class D>
Rocking rock(const typename D::Shape& log, const typename D::Shape& plank, typename D::Rotation log_turn) {
  World<D> world(world_with<D>());
  const BodyId below = add_body<D>(world, BodyType::fixed, log, at<D>(0, 0), {.friction = 0.9f});
  world.set_pose(below, at<D>(0, 0), log_turn).value();
  const double s = math::sin(lean), c = math::cos(lean), up = log_radius + half_thickness;
  BodyDef<D> def;
  def.position = at<D>(up * s - log_radius * lean * c, up * c + log_radius * lean * s);
  def.rotation = leaning<D>(lean);
  def.sleep_speed = 0;
  const BodyId id = world.create_body(def).value();
  ShapeDef<D> shape;
  shape.material.friction = 0.9f;
  world.add_shape(id, plank, shape).value();
  const double k2 = (half_length * half_length + half_thickness * half_thickness) / 3;  // inertia over mass
  const auto energy = [&](const BodyState<D>& b) {
    return 0.5 * double(math::length_squared(b.linear_velocity)) + 0.5 * k2 * double(square_of(b.angular_velocity)) +
           9.81 * b.pose.position.y;
  };
  const double start = energy(world.state(id).value());
  Rocking r;
  double before = lean, first = -1, last = -1;
  int swings = 0;
  for (int i = 1; i <= 1800; ++i) {
    world.step(frame).value();
    const BodyState<D> b = world.state(id).value();
    const double angle = double(angle_of(b.pose.rotation)), now = energy(b) - start;
    r.gained = std::max(r.gained, now);
    r.left = now;
    if (i > 1620) r.swing = std::max(r.swing, math::abs(angle));
    if (before < 0 && angle >= 0) {
      last = (i - angle / (angle - before)) / 60;
      if (first < 0)
        first = last;
      else
        ++swings;
    }
    before = angle;
  }
  r.period = swings > 0 ? (last - first) / swings : 0;
  return r;
}

/// Rolled by θ, the plank's middle is at the height (R + h) cos θ + R θ sin θ, and turns about a point h below it: near
/// the middle ω² = g (R − h)/(k² + h²), k its radius of inertia and h half its thickness.
void expect_law(const Rocking& r) {
  const double k2 = (half_length * half_length + half_thickness * half_thickness) / 3;
  const double omega = math::sqrt(9.81 * (log_radius - half_thickness) / (k2 + half_thickness * half_thickness));
  EXPECT_NEAR(r.period, 2 * math::pi / omega, 0.01 * r.period);
  // Contacts that keep the normal of the step's start add 3/16 ω²Δt a second to the swing: three times it in 30 s.
  EXPECT_LT(r.gained, 1e-4);
  EXPECT_LT(r.left, 0);
  EXPECT_GT(r.swing, 0.6 * lean);
}

TEST(Rocking, APlankOnALogHasItsPeriodAndGainsNothing) {
  const geometry::Shape3 plank = geometry::Box{{float(half_length), float(half_thickness), 0.3f}};
  const Quatf lying = math::from_axis_angle(Vec3f{1, 0, 0}, float(math::pi / 2));
  const float radius = float(log_radius);
  expect_law(rock<Dim3>(geometry::Sphere{radius}, plank, lying));
  expect_law(rock<Dim3>(geometry::Capsule3{0.6f, radius}, plank, lying));
  expect_law(rock<Dim3>(geometry::Cylinder{0.6f, radius}, plank, lying));
}

TEST(Rocking, APlankOnADiscHasItsPeriodAndGainsNothing) {
  const geometry::Shape2 plank = geometry::make_box2({float(half_length), float(half_thickness)});
  expect_law(rock<Dim2>(geometry::Circle{float(log_radius)}, plank, {}));
}

}  // namespace
}  // namespace carom::rigid::test
