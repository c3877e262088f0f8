// Ropes that fall on, are thrown at and are met by posts thinner than their segments are long: none goes through.
#include <gtest/gtest.h>

#include "carom/geometry/shape3.h"
#include "carom/math/elementary.h"
#include "carom/particles/rope.h"

namespace rope_post_test {
using namespace carom;
using math::Vec3d;
using namespace carom::particles;
using rigid::BodyId;
using rigid::Dim3;
using rigid::World3;
constexpr double dt = 1.0 / 480, g = 9.80665;  // one substep a step, so that nothing is unseen

/// The angle at the post's axis, along z, from one point to another.
double angle(Vec3d a, Vec3d b) { return math::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y); }

/// How often a rope winds round the post, less how often its ends did since the start: that changes by whole turns, and
/// only where the rope goes through the axis.
class Winding {
 public:
  double follow(std::span<const Vec3d> points, Vec3d axis) {
    double sum = 0;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) sum += angle(points[i] - axis, points[i + 1] - axis);
    const Vec3d ends[] = {points.front() - axis, points.back() - axis};
    for (int k = 0; k < 2; ++k) {
      if (begun_) turned_[k] += angle(ends_[k], ends[k]);
      ends_[k] = ends[k];
    }
    const double now = sum - (turned_[1] - turned_[0]);
    if (!begun_) first_ = now;
    begun_ = true;
    return math::abs(now - first_);
  }

 private:
  bool begun_ = false;
  double turned_[2] = {0, 0}, first_ = 0;
  Vec3d ends_[2] = {};
};

struct Fall {
  double post = 0.02, segment = 0.05;
  Vec3d along{1, 0, 0}, middle{0, 0.1, 0}, velocity{0, -5, 0};
  double loads[2] = {0, 0};  ///< of the rope's mass, at its ends
  double lift = 0;           ///< m/s: the post moves up
  double seconds = 1;
};

/// Whether a rope goes through the post.
bool goes_through(const Fall& fall) {
  World3 world;
  rigid::BodyDef<Dim3> def;
  def.type = fall.lift > 0 ? rigid::BodyType::kinematic : rigid::BodyType::fixed;
  def.rotation = {float(math::sqrt(0.5)), float(math::sqrt(0.5)), 0, 0};
  def.linear_velocity = {0, float(fall.lift), 0};
  const BodyId post = world.create_body(def).value();
  rigid::ShapeDef<Dim3> shape;
  shape.material.friction = 0.3f;
  world.add_shape(post, geometry::Capsule3{5, float(fall.post)}, shape).value();
  RopeSet ropes;
  ropes.set_substeps(1).value();
  const Vec3d half = 0.6 * normalize(fall.along);
  const Vec3d points[] = {fall.middle - half, fall.middle + half};
  ropes
      .add({.material = {.mass_per_length = 0.05,
                         .radius = 0.005,
                         .axial_stiffness = 1e5,
                         .friction = 0.3,
                         .drag_coefficient = 0,
                         .skin_coefficient = 0},
            .points = points,
            .segments = int(1.2 / fall.segment + 0.5),
            .touch = RopeTouch::none})
      .value();
  const double mass = ropes.mass(0);
  for (int k = 0; k < 2; ++k) ropes.add_mass(0, k == 0 ? 0 : -1, fall.loads[k] * mass).value();
  for (int i = 0; i < int(ropes.positions(0).size()); ++i) ropes.set_velocity(0, i, fall.velocity).value();
  Winding winding;
  for (double t = 0; t < fall.seconds; t += dt) {
    const Vec3d axis = world.state(post)->center_of_mass;
    if (winding.follow(ropes.positions(0), axis) > 1) return true;
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
  }
  return false;
}

/// The number of a case turns the rope from 30° to 90° to the post and puts it off its middle by up to a quarter of a
/// metre.
Fall over(double post, double segment, const double (&load)[2], int number) {
  const double turn = math::pi / 6 * (1 + number % 3), off = 0.25 * math::sin(2.4 * number);
  return {.post = post,
          .segment = segment,
          .along = {math::sin(turn), 0, math::cos(turn)},
          .middle = {off, post + 0.055, 0},
          .velocity = {},
          .loads = {load[0], load[1]}};
}

constexpr double posts[] = {0.02, 0.01, 0.005}, segments[] = {0.05, 0.025};
constexpr double loads[][2] = {{0, 0}, {1, 1}, {100, 100}, {1, 0}, {100, 50}, {0, 100}, {3, 100}};

TEST(RopePosts, WhatFallsOnAThinPostHangsOverItOrSlidesOff) {
  int count = 0, through = 0;
  for (const double post : posts)
    for (const double segment : segments)
      for (const double height : {1.0, 2.5, 5.0})
        for (const auto& load : loads) {
          Fall fall = over(post, segment, load, count);
          fall.velocity.y = -math::sqrt(2 * g * height);
          ++count;
          if (!goes_through(fall)) continue;
          ++through;
          ADD_FAILURE() << "post " << post << " m, segments of " << segment << " m, from " << height << " m, loads of "
                        << load[0] << " and " << load[1] << " times its mass, number " << count - 1;
        }
  RecordProperty("falls", count);
  RecordProperty("through", through);
}

TEST(RopePosts, WhatIsThrownAtAThinPostWrapsRoundIt) {
  int count = 0;
  for (const double post : posts)
    for (const double segment : segments)
      for (const auto& load : loads) {
        const double slant = 2.4 * count, off = 0.4 * math::sin(1.7 * count);
        const Vec3d along{math::sin(slant), math::cos(slant), 0.3 * math::sin(slant)};
        const Vec3d way = normalize(cross(Vec3d{0, 0, 1}, along));
        const Fall fall{.post = post,
                        .segment = segment,
                        .along = along,
                        .middle = -(post + 0.06) * way + off * normalize(along),
                        .velocity = 20.0 * way,
                        .loads = {load[0], load[1]},
                        .seconds = 0.5};
        EXPECT_FALSE(goes_through(fall)) << "post " << post << " m, segments of " << segment << " m, number " << count;
        ++count;
      }
}

TEST(RopePosts, WhatAThinPostMeetsIsTakenAlong) {
  int count = 0;
  for (const double post : posts)
    for (const double segment : segments)
      for (const auto& load : loads) {
        Fall fall = over(post, segment, load, count);
        fall.lift = 1 + 1.5 * (count % 7);
        fall.seconds = 0.4;
        EXPECT_FALSE(goes_through(fall)) << "post " << post << " m, segments of " << segment << " m, number " << count;
        ++count;
      }
}

/// How far beyond a rope of 1 kN a light bar or ball is that is flung at it, at most, at the end of a step (m).
double beyond(double speed, double ahead, bool ball) {
  constexpr double step = 1.0 / 60, mass = 0.01;
  World3 world({.gravity = {0, 0, 0}});
  rigid::BodyDef<Dim3> def;
  def.type = rigid::BodyType::dynamic;
  def.position = {0, ahead, 0};
  def.rotation = {float(math::sqrt(0.5)), float(math::sqrt(0.5)), 0, 0};  // along z
  def.linear_velocity = {0, -float(speed), 0};
  const BodyId body = world.create_body(def).value();
  constexpr double radius = 0.02, half = 0.1;
  rigid::ShapeDef<Dim3> shape;
  const double volume = math::pi * radius * radius * (4 * radius / 3 + (ball ? 0 : 2 * half));
  shape.density = float(mass / volume);
  if (ball)
    world.add_shape(body, geometry::Sphere{float(radius)}, shape).value();
  else
    world.add_shape(body, geometry::Capsule3{float(half), float(radius)}, shape).value();
  RopeSet ropes;
  constexpr double pull = 1000, stiffness = 1e5, length = 2;
  const Vec3d points[] = {{-0.5 * length, 0, 0}, {0.5 * length, 0, 0}};
  ropes
      .add({.material = {.mass_per_length = 0.05,
                         .radius = 0.005,
                         .axial_stiffness = stiffness,
                         .drag_coefficient = 0,
                         .skin_coefficient = 0},
            .points = points,
            .segments = 40,
            .length = length / (1 + pull / stiffness),
            .touch = RopeTouch::none})
      .value();
  for (const int end : {0, -1}) ropes.attach(0, {.node = end, .point = points[end == 0 ? 0 : 1]}, world).value();
  double most = -1;
  for (int i = 0; i < 60; ++i) {
    ropes.step(world, step).value();
    world.step(float(step)).value();
    const Vec3d place = world.state(body)->center_of_mass;
    double height = 0, nearest = 1e9;  // m, of the rope where the body is
    for (const Vec3d p : ropes.positions(0))
      if (const double off = math::abs(p.x - place.x); off < nearest) {
        nearest = off;
        height = p.y;
      }
    if (nearest < 0.05) most = math::max(most, height - place.y);
  }
  return most;
}

// What a taut rope stops within a step is on its side of it at the step's end.
TEST(RopePosts, ALightBodyThatATautRopeStopsIsNotBeyondIt) {
  for (const bool ball : {false, true})
    for (const double speed : {5.0, 10.0, 20.0, 30.0, 50.0})
      for (int phase = 0; phase < 8; ++phase)
        EXPECT_LT(beyond(speed, 0.3 + phase * speed / 480, ball), 0) << speed << ' ' << phase << ' ' << ball;
}

}  // namespace rope_post_test
