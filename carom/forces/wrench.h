// Force and torque together, and the motion of points of a rigid body (chapters 2.8–2.10, 3.8).
#pragma once

#include "carom/math/vec.h"

namespace carom::forces {

/// A force (N) and its moment (N·m) about a stated point.
struct Wrench3 {
  math::Vec3d force{};
  math::Vec3d moment{};
  friend constexpr Wrench3 operator+(const Wrench3& a, const Wrench3& b) {
    return {a.force + b.force, a.moment + b.moment};
  }
  friend constexpr Wrench3 operator*(double s, const Wrench3& a) { return {s * a.force, s * a.moment}; }
};
struct Wrench2 {
  math::Vec2d force{};
  double moment = 0;
  friend constexpr Wrench2 operator+(const Wrench2& a, const Wrench2& b) {
    return {a.force + b.force, a.moment + b.moment};
  }
};

/// A force at `point`, with its moment M = r × F about `about`.
constexpr Wrench3 force_at(math::Vec3d force, math::Vec3d point, math::Vec3d about) {
  return {force, math::cross(point - about, force)};
}
constexpr Wrench2 force_at(math::Vec2d force, math::Vec2d point, math::Vec2d about) {
  return {force, math::cross(point - about, force)};
}
/// The same wrench about another point: M_Q = M_P + (P − Q) × F. A couple (no force) is the same everywhere.
constexpr Wrench3 transport(const Wrench3& wrench, math::Vec3d from, math::Vec3d to) {
  return {wrench.force, wrench.moment + math::cross(from - to, wrench.force)};
}
constexpr Wrench2 transport(const Wrench2& wrench, math::Vec2d from, math::Vec2d to) {
  return {wrench.force, wrench.moment + math::cross(from - to, wrench.force)};
}

/// v_P = v + ω × r, m/s; r from the centre of mass.
constexpr math::Vec3d point_velocity(math::Vec3d v, math::Vec3d omega, math::Vec3d r) {
  return v + math::cross(omega, r);
}
constexpr math::Vec2d point_velocity(math::Vec2d v, double omega, math::Vec2d r) { return v + math::cross(omega, r); }
/// a_P = a + α × r + ω × (ω × r), m/s².
constexpr math::Vec3d point_acceleration(math::Vec3d a, math::Vec3d alpha, math::Vec3d omega, math::Vec3d r) {
  return a + math::cross(alpha, r) + math::cross(omega, math::cross(omega, r));
}
constexpr math::Vec2d point_acceleration(math::Vec2d a, double alpha, double omega, math::Vec2d r) {
  return a + math::cross(alpha, r) - (omega * omega) * r;
}

}  // namespace carom::forces
