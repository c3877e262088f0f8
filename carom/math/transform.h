// Rigid transforms, and world poses: positions in double, everything local in float.
#pragma once

#include "carom/math/quat.h"

namespace carom::math {

/// x ↦ q x + p in the plane.
template <class T>
struct Transform2 {
  Vec2<T> p{};
  Rot2<T> q{};
  friend constexpr bool operator==(const Transform2& a, const Transform2& b) { return a.p == b.p && a.q == b.q; }
};
/// x ↦ q x q* + p in space.
template <class T>
struct Transform3 {
  Vec3<T> p{};
  Quat<T> q{};
  friend constexpr bool operator==(const Transform3& a, const Transform3& b) { return a.p == b.p && a.q == b.q; }
};

using Transform2f = Transform2<float>;
using Transform2d = Transform2<double>;
using Transform3f = Transform3<float>;
using Transform3d = Transform3<double>;

template <class T>
constexpr Vec2<T> transform_point(const Transform2<T>& t, Vec2<T> v) {
  return rotate(t.q, v) + t.p;
}
template <class T>
CAROM_ROTATION_INLINE constexpr Vec3<T> transform_point(const Transform3<T>& t, Vec3<T> v) {
  return rotate(t.q, v) + t.p;
}
template <class T>
constexpr Vec2<T> inverse_transform_point(const Transform2<T>& t, Vec2<T> v) {
  return inverse_rotate(t.q, v - t.p);
}
template <class T>
CAROM_ROTATION_INLINE constexpr Vec3<T> inverse_transform_point(const Transform3<T>& t, Vec3<T> v) {
  return inverse_rotate(t.q, v - t.p);
}
/// a ∘ b: first b, then a.
template <class T>
constexpr Transform2<T> operator*(const Transform2<T>& a, const Transform2<T>& b) {
  return {transform_point(a, b.p), a.q * b.q};
}
template <class T>
constexpr Transform3<T> operator*(const Transform3<T>& a, const Transform3<T>& b) {
  return {transform_point(a, b.p), a.q * b.q};
}
template <class T>
constexpr Transform2<T> inverse(const Transform2<T>& t) {
  return {-inverse_rotate(t.q, t.p), conjugate(t.q)};
}
template <class T>
constexpr Transform3<T> inverse(const Transform3<T>& t) {
  return {-inverse_rotate(t.q, t.p), conjugate(t.q)};
}

template <class T>
constexpr Mat4<T> to_matrix(const Transform3<T>& t) {
  return affine(to_matrix(t.q), t.p);
}

/// Where a body is in the world: its origin in metres (double: millimetres at 10⁹ m) and its attitude.
struct Pose2 {
  Vec2d position{};
  Rot2f rotation{};
  friend constexpr bool operator==(const Pose2& a, const Pose2& b) {
    return a.position == b.position && a.rotation == b.rotation;
  }
};
struct Pose3 {
  Vec3d position{};
  Quatf rotation{};
  friend constexpr bool operator==(const Pose3& a, const Pose3& b) {
    return a.position == b.position && a.rotation == b.rotation;
  }
};

/// The pose of b seen from a: subtracted in double, so that it is exact far from the origin.
constexpr Transform2f relative(const Pose2& a, const Pose2& b) {
  return {inverse_rotate(a.rotation, Vec2f(b.position - a.position)), conjugate(a.rotation) * b.rotation};
}
constexpr Transform3f relative(const Pose3& a, const Pose3& b) {
  return {inverse_rotate(a.rotation, Vec3f(b.position - a.position)), conjugate(a.rotation) * b.rotation};
}
constexpr Pose2 operator*(const Pose2& a, const Transform2f& b) {
  return {a.position + Vec2d(rotate(a.rotation, b.p)), a.rotation * b.q};
}
constexpr Pose3 operator*(const Pose3& a, const Transform3f& b) {
  return {a.position + Vec3d(rotate(a.rotation, b.p)), a.rotation * b.q};
}
constexpr Vec2d world_point(const Pose2& pose, Vec2f local) {
  return pose.position + Vec2d(rotate(pose.rotation, local));
}
constexpr Vec3d world_point(const Pose3& pose, Vec3f local) {
  return pose.position + Vec3d(rotate(pose.rotation, local));
}
constexpr Vec2f local_point(const Pose2& pose, Vec2d world) {
  return inverse_rotate(pose.rotation, Vec2f(world - pose.position));
}
constexpr Vec3f local_point(const Pose3& pose, Vec3d world) {
  return inverse_rotate(pose.rotation, Vec3f(world - pose.position));
}

}  // namespace carom::math
