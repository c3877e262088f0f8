// Unit quaternions as rotations, scalar first (appendix C of the subject).
// What needs elementary functions (axis and angle, Euler angles, slerp, exponential map) is in rotation.h.
#pragma once

#include "carom/math/mat.h"

// Where a rotation is called out of line, its operands go through memory, which takes as long as the rotation: 3 % of a
// step of falling bodies. Not where the size of a download counts.
#if defined(__wasm__)
#define CAROM_ROTATION_INLINE
#else
#define CAROM_ROTATION_INLINE [[gnu::always_inline]]
#endif

namespace carom::math {

/// A rotation of the plane, kept as cosine and sine so that no step needs a trigonometric function.
template <class T>
struct Rot2 {
  T c{1}, s{0};

  constexpr Rot2() = default;
  constexpr Rot2(T cosine, T sine) : c(cosine), s(sine) {}
  template <class U>
  explicit constexpr Rot2(Rot2<U> q) : c(T(q.c)), s(T(q.s)) {}
  friend constexpr Rot2 operator*(Rot2 a, Rot2 b) { return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s}; }
  friend constexpr bool operator==(Rot2 a, Rot2 b) { return a.c == b.c && a.s == b.s; }
};

template <class T>
constexpr Rot2<T> conjugate(Rot2<T> q) {
  return {q.c, -q.s};
}
template <class T>
constexpr Vec2<T> rotate(Rot2<T> q, Vec2<T> v) {
  return {q.c * v.x - q.s * v.y, q.s * v.x + q.c * v.y};
}
template <class T>
constexpr Vec2<T> inverse_rotate(Rot2<T> q, Vec2<T> v) {
  return {q.c * v.x + q.s * v.y, -q.s * v.x + q.c * v.y};
}
template <class T>
inline Rot2<T> normalize(Rot2<T> q) {
  const T l = math::sqrt(q.c * q.c + q.s * q.s);
  return l > T(0) ? Rot2<T>{q.c / l, q.s / l} : Rot2<T>{};
}
/// q turned further by the small angle `angle` (rad), to second order and renormalised; error below angle³/3.
template <class T>
inline Rot2<T> integrate(Rot2<T> q, T angle) {
  return normalize(Rot2<T>{q.c - angle * q.s, q.s + angle * q.c});
}
template <class T>
constexpr Mat2<T> to_matrix(Rot2<T> q) {
  return {{q.c, q.s}, {-q.s, q.c}};
}
template <class T>
constexpr bool is_finite(Rot2<T> q) {
  return is_finite(q.c) && is_finite(q.s);
}

template <class T>
struct Quat {
  T w{1}, x{0}, y{0}, z{0};

  constexpr Quat() = default;
  constexpr Quat(T w_, T x_, T y_, T z_) : w(w_), x(x_), y(y_), z(z_) {}
  constexpr Quat(T w_, Vec3<T> v) : w(w_), x(v.x), y(v.y), z(v.z) {}
  template <class U>
  explicit constexpr Quat(const Quat<U>& q) : w(T(q.w)), x(T(q.x)), y(T(q.y)), z(T(q.z)) {}

  constexpr Vec3<T> vector() const { return {x, y, z}; }
  friend constexpr Quat operator*(const Quat& a, const Quat& b) {
    return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
            a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
  }
  friend constexpr Quat operator*(const Quat& q, Vec3<T> v) { return q * Quat{T(0), v}; }
  friend constexpr Quat operator*(Vec3<T> v, const Quat& q) { return Quat{T(0), v} * q; }
  friend constexpr Quat operator*(T s, const Quat& q) { return {s * q.w, s * q.x, s * q.y, s * q.z}; }
  friend constexpr Quat operator*(const Quat& q, T s) { return s * q; }
  friend constexpr Quat operator/(const Quat& q, T s) { return {q.w / s, q.x / s, q.y / s, q.z / s}; }
  friend constexpr Quat operator+(const Quat& a, const Quat& b) { return {a.w + b.w, a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Quat operator-(const Quat& a, const Quat& b) { return {a.w - b.w, a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Quat operator-(const Quat& q) { return {-q.w, -q.x, -q.y, -q.z}; }
  friend constexpr bool operator==(const Quat& a, const Quat& b) {
    return a.w == b.w && a.x == b.x && a.y == b.y && a.z == b.z;
  }
};

using Rot2f = Rot2<float>;
using Rot2d = Rot2<double>;
using Quatf = Quat<float>;
using Quatd = Quat<double>;

template <class T>
constexpr T dot(const Quat<T>& a, const Quat<T>& b) {
  return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Quat<T> conjugate(const Quat<T>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
template <class T>
inline T length(const Quat<T>& q) {
  return math::sqrt(dot(q, q));
}
/// q/|q|, or the identity where q is zero or not finite.
template <class T>
inline Quat<T> normalize(const Quat<T>& q) {
  const T l = length(q);
  return l > T(0) && is_finite(l) ? q * (T(1) / l) : Quat<T>{};
}
/// The inverse of any non-zero quaternion; for a unit quaternion the conjugate is the same and cheaper.
template <class T>
constexpr Quat<T> inverse(const Quat<T>& q) {
  return conjugate(q) / dot(q, q);
}
/// q v q* for unit q.
template <class T>
CAROM_ROTATION_INLINE constexpr Vec3<T> rotate(const Quat<T>& q, Vec3<T> v) {
  const Vec3<T> u = q.vector();
  const Vec3<T> t = T(2) * cross(u, v);
  return v + q.w * t + cross(u, t);
}
template <class T>
CAROM_ROTATION_INLINE constexpr Vec3<T> inverse_rotate(const Quat<T>& q, Vec3<T> v) {
  return rotate(conjugate(q), v);
}
/// q̇ = ½ ω ⊗ q with ω in world axes, one explicit step, renormalised.
template <class T>
inline Quat<T> integrate(const Quat<T>& q, Vec3<T> rotation) {
  return normalize(q + T(0.5) * (rotation * q));
}
template <class T>
constexpr Mat3<T> to_matrix(const Quat<T>& q) {
  const T xx = 2 * q.x * q.x, yy = 2 * q.y * q.y, zz = 2 * q.z * q.z;
  const T xy = 2 * q.x * q.y, xz = 2 * q.x * q.z, yz = 2 * q.y * q.z;
  const T wx = 2 * q.w * q.x, wy = 2 * q.w * q.y, wz = 2 * q.w * q.z;
  return {{1 - yy - zz, xy + wz, xz - wy}, {xy - wz, 1 - xx - zz, yz + wx}, {xz + wy, yz - wx, 1 - xx - yy}};
}
template <class T>
constexpr bool is_finite(const Quat<T>& q) {
  return is_finite(q.w) && is_finite(q.x) && is_finite(q.y) && is_finite(q.z);
}

}  // namespace carom::math
