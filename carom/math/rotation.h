// Rotations and what needs elementary functions: axis and angle, Euler angles, interpolation, exponential map.
//
// A quaternion q and −q are the same attitude. Functions that read angles out of q give the shorter way; functions that
// make q keep the sign, so that a turn by 2π is −1. Angles in rad. T is float or double.
#pragma once

#include <limits>

#include "carom/math/elementary.h"
#include "carom/math/transform.h"

namespace carom::math {

// ---- The plane

template <class T>
inline Rot2<T> from_angle(T angle) {
  const SinCos<T> r = sincos(angle);
  return {r.cos, r.sin};
}
/// In (−π, π].
template <class T>
inline T angle_of(Rot2<T> q) {
  return atan2(q.s, q.c);
}

/// The same angle in [−π, π].
template <class T>
inline T wrap_angle(T angle) {
  constexpr T turn = T(2 * pi);
  if (abs(angle) <= T(pi)) return angle;
  const T r = fmod(angle, turn);
  return r > T(pi) ? r - turn : (r < T(-pi) ? r + turn : r);
}

// ---- Elementary rotation matrices: a vector turns counterclockwise, seen from the tip of the axis

template <class T>
inline Mat3<T> rotation_x(T angle) {
  const SinCos<T> r = sincos(angle);
  return {{1, 0, 0}, {0, r.cos, r.sin}, {0, -r.sin, r.cos}};
}
template <class T>
inline Mat3<T> rotation_y(T angle) {
  const SinCos<T> r = sincos(angle);
  return {{r.cos, 0, -r.sin}, {0, 1, 0}, {r.sin, 0, r.cos}};
}
template <class T>
inline Mat3<T> rotation_z(T angle) {
  const SinCos<T> r = sincos(angle);
  return {{r.cos, r.sin, 0}, {-r.sin, r.cos, 0}, {0, 0, 1}};
}

// ---- Axis and angle, exponential and logarithm

template <class T>
struct AxisAngle {
  Vec3<T> axis{1, 0, 0};
  T angle{};
};

/// The rotation by `angle` about `axis`, which need not be a unit vector; the identity where it is zero.
template <class T>
inline Quat<T> from_axis_angle(Vec3<T> axis, T angle) {
  const SinCos<T> r = sincos(angle / 2);
  const Vec3<T> n = normalize(axis);
  return dot(n, n) > T(0) ? Quat<T>{r.cos, r.sin * n} : Quat<T>{};
}

/// Exponential map: the rotation by |v| about v.
template <class T>
inline Quat<T> from_rotation_vector(Vec3<T> v) {
  const T angle = length(v);
  // sin(θ/2)/θ = ½ − θ²/48 + …; the next term is below rounding here.
  if (angle < T(sizeof(T) == 4 ? 1e-2 : 1e-4)) {
    const T s = angle * angle;
    return {T(1) - s / T(8) + s * s / T(384), v * (T(0.5) - s / T(48) + s * s / T(3840))};
  }
  const SinCos<T> r = sincos(angle / 2);
  return {r.cos, v * (r.sin / angle)};
}

/// Logarithm: the rotation vector of a unit quaternion, |v| ≤ π.
template <class T>
inline Vec3<T> rotation_vector(const Quat<T>& q) {
  const Vec3<T> u = q.w < T(0) ? -q.vector() : q.vector();
  const T w = abs(q.w), s = length(u);
  if (s == T(0)) return u * T(2);
  // 2 atan(s/w)/s; with the ratio small enough, 2/w (1 − (s/w)²/3).
  const T ratio = s / w;
  if (ratio < T(sizeof(T) == 4 ? 1e-3 : 1e-5)) return u * (T(2) / w * (T(1) - ratio * ratio / T(3)));
  return u * (T(2) * atan2(s, w) / s);
}

/// Axis and angle in [0, π]; the x axis where there is no rotation.
template <class T>
inline AxisAngle<T> axis_angle(const Quat<T>& q) {
  const Vec3<T> u = q.w < T(0) ? -q.vector() : q.vector();
  const T s = length(u);
  if (!(s > T(0))) return {};
  return {u / s, T(2) * atan2(s, abs(q.w))};
}

/// The angle in [0, π] of the rotation that takes a to b; accurate for small angles too.
template <class T>
inline T angle_between(const Quat<T>& a, const Quat<T>& b) {
  const Quat<T> d = conjugate(a) * b;
  return T(2) * atan2(length(d.vector()), abs(d.w));
}

/// q turned for dt by an angular velocity that is constant in world axes: exact, whatever the angle.
template <class T>
inline Quat<T> integrate_exact(const Quat<T>& q, Vec3<T> angular_velocity, T dt) {
  return normalize(from_rotation_vector(angular_velocity * dt) * q);
}
/// The same with an angular velocity that is constant in body axes.
template <class T>
inline Quat<T> integrate_exact_body(const Quat<T>& q, Vec3<T> angular_velocity, T dt) {
  return normalize(q * from_rotation_vector(angular_velocity * dt));
}

// ---- Matrices

/// The unit quaternion of a rotation matrix, w ≥ 0 up to rounding (Shepperd 1978: divide by the largest component).
template <class T>
inline Quat<T> from_matrix(const Mat3<T>& m) {
  const T xx = m.cx.x, yy = m.cy.y, zz = m.cz.z, t = xx + yy + zz;
  Quat<T> q;
  if (t >= xx && t >= yy && t >= zz) {
    q = {T(1) + t, m.cy.z - m.cz.y, m.cz.x - m.cx.z, m.cx.y - m.cy.x};
  } else if (xx >= yy && xx >= zz) {
    q = {m.cy.z - m.cz.y, T(1) + xx - yy - zz, m.cy.x + m.cx.y, m.cz.x + m.cx.z};
  } else if (yy >= zz) {
    q = {m.cz.x - m.cx.z, m.cy.x + m.cx.y, T(1) + yy - xx - zz, m.cz.y + m.cy.z};
  } else {
    q = {m.cx.y - m.cy.x, m.cz.x + m.cx.z, m.cz.y + m.cy.z, T(1) + zz - xx - yy};
  }
  q = normalize(q);
  return q.w < T(0) ? -q : q;
}

/// A rotation matrix from one that has drifted: Gram–Schmidt from the x column on, right-handed.
template <class T>
inline Mat3<T> orthonormalize(const Mat3<T>& m) {
  const Vec3<T> x = normalize_or(m.cx, Vec3<T>{1, 0, 0}, T(1e-18));
  const Vec3<T> y = normalize_or(m.cy - x * dot(x, m.cy), perpendicular(x), T(1e-18));
  return {x, y, cross(x, y)};
}

// ---- Euler angles

/// The axes in the order in which they turn, each in the frame that the ones before have turned (intrinsic): for zyx
/// the matrix is R_z(first) R_y(second) R_x(third). Turns about fixed axes are the same angles in the reverse order.
enum class EulerOrder { xyz, xzy, yxz, yzx, zxy, zyx, xyx, xzx, yxy, yzy, zxz, zyz };

template <class T>
struct EulerAngles {
  T first{}, second{}, third{};
};

namespace detail {
struct EulerAxes {
  int first, second, third;
};
constexpr EulerAxes axes_of(EulerOrder order) {
  constexpr EulerAxes axes[] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0},
                                {0, 1, 0}, {0, 2, 0}, {1, 0, 1}, {1, 2, 1}, {2, 0, 2}, {2, 1, 2}};
  return axes[static_cast<int>(order)];
}
template <class T>
inline Quat<T> about_axis(int axis, T angle) {
  const SinCos<T> r = sincos(angle / 2);
  Vec3<T> v;
  v[axis] = r.sin;
  return {r.cos, v};
}
}  // namespace detail

template <class T>
inline Quat<T> from_euler_angles(EulerAngles<T> e, EulerOrder order) {
  const detail::EulerAxes a = detail::axes_of(order);
  return detail::about_axis(a.first, e.first) * detail::about_axis(a.second, e.second) *
         detail::about_axis(a.third, e.third);
}

/// Euler angles of a unit quaternion: first and third in [−π, π]; second in [−π/2, π/2] where all axes differ, else in
/// [0, π]. In gimbal lock, where only the sum or difference of first and third is defined, third is zero.
/// Method: Bernardes and Viollet, PLoS ONE 17(11) e0276302 (2022), with half angles by atan2 so that no digits are lost
/// near gimbal lock.
template <class T>
inline EulerAngles<T> euler_angles(const Quat<T>& q, EulerOrder order) {
  const detail::EulerAxes axes = detail::axes_of(order);
  const bool proper = axes.first == axes.third;
  const int i = axes.third, j = axes.second, k = proper ? 3 - i - j : axes.first;
  const T sign = T((i - j) * (j - k) * (k - i) / 2);
  const Vec3<T> v = q.vector();
  T a = q.w, b = v[i], c = v[j], d = sign * v[k];
  if (!proper) {
    a = q.w - v[j];
    b = v[i] + sign * v[k];
    c = v[j] + q.w;
    d = sign * v[k] - v[i];
  }
  const T ab = sqrt(a * a + b * b), cd = sqrt(c * c + d * d);
  T plus = atan2(b, a), minus = atan2(d, c);
  constexpr T locked = T(16) * std::numeric_limits<T>::epsilon();
  if (cd <= locked * ab) minus = plus;
  if (ab <= locked * cd) plus = minus;
  EulerAngles<T> e{plus + minus, T(2) * atan2(cd, ab), plus - minus};
  if (!proper) {
    e.first *= sign;
    e.second -= T(pi / 2);
  }
  return {wrap_angle(e.first), e.second, wrap_angle(e.third)};
}
template <class T>
inline EulerAngles<T> euler_angles(const Mat3<T>& m, EulerOrder order) {
  return euler_angles(from_matrix(m), order);
}

/// Aerospace angles for frames with x forward and z down: turns about z (yaw), then y (pitch), then x (roll).
template <class T>
struct YawPitchRoll {
  T yaw{}, pitch{}, roll{};
};
template <class T>
inline Quat<T> from_yaw_pitch_roll(YawPitchRoll<T> a) {
  return from_euler_angles(EulerAngles<T>{a.yaw, a.pitch, a.roll}, EulerOrder::zyx);
}
/// Pitch in [−π/2, π/2]; at ±π/2 roll is zero and yaw holds the whole turn.
template <class T>
inline YawPitchRoll<T> yaw_pitch_roll(const Quat<T>& q) {
  const EulerAngles<T> e = euler_angles(q, EulerOrder::zyx);
  return {e.first, e.second, e.third};
}

// ---- Between directions

/// The shortest rotation that takes the unit vector a to the unit vector b; about any normal axis where they oppose.
template <class T>
inline Quat<T> from_to(Vec3<T> a, Vec3<T> b) {
  if (dot(a, b) < T(0)) {
    // a + b would cancel: half a turn about the normal of both takes a to −a, from where b is near.
    const Vec3<T> normal = normalize_or(cross(a, b), perpendicular(a), T(4) * std::numeric_limits<T>::epsilon());
    const Quat<T> half_turn{T(0), normalize(normal - a * dot(a, normal))};
    return normalize(from_to(-a, b) * half_turn);
  }
  const Vec3<T> half = normalize(a + b);
  return normalize(Quat<T>{dot(a, half), cross(a, half)});
}

/// The attitude of a body whose x axis points along `forward` and whose y axis is as near to `up` as that allows. Where
/// the two are parallel any such attitude; the identity where `forward` is zero.
template <class T>
inline Quat<T> look_rotation(Vec3<T> forward, Vec3<T> up) {
  const Vec3<T> x = normalize(forward);
  if (!(dot(x, x) > T(0))) return {};
  const Vec3<T> u = normalize(up);
  const Vec3<T> y = normalize_or(u - x * dot(x, u), perpendicular(x), T(16) * std::numeric_limits<T>::epsilon());
  return from_matrix(Mat3<T>{x, y, cross(x, y)});
}

// ---- Interpolation

/// Between unit quaternions along the chord, shorter way, renormalised: cheap, monotonic, not of constant speed.
template <class T>
inline Quat<T> nlerp(const Quat<T>& a, const Quat<T>& b, T t) {
  const Quat<T> end = dot(a, b) < T(0) ? -b : b;
  return normalize(a * (T(1) - t) + end * t);
}
/// Along the great arc at constant angular velocity, shorter way (Shoemake 1985).
template <class T>
inline Quat<T> slerp(const Quat<T>& a, const Quat<T>& b, T t) {
  const Quat<T> end = dot(a, b) < T(0) ? -b : b;
  const T arc = T(2) * atan2(length(a - end), length(a + end));
  const T s = sin(arc);
  if (!(s > T(sizeof(T) == 4 ? 1e-4 : 1e-7))) return nlerp(a, end, t);
  return normalize(a * (sin((T(1) - t) * arc) / s) + end * (sin(t * arc) / s));
}
template <class T>
inline Rot2<T> slerp(Rot2<T> a, Rot2<T> b, T t) {
  return normalize(a * from_angle(t * angle_of(conjugate(a) * b)));
}

// ---- Swing and twist

template <class T>
struct SwingTwist {
  Quat<T> swing, twist;
};
/// q = swing ⊗ twist with the twist about the unit vector `axis` (a body axis) and the swing about a normal of it.
/// Where the swing is half a turn the twist is not defined, and is none.
template <class T>
inline SwingTwist<T> swing_twist(const Quat<T>& q, Vec3<T> axis) {
  const T along = dot(q.vector(), axis);
  const T l = sqrt(q.w * q.w + along * along);
  if (!(l > T(4) * std::numeric_limits<T>::epsilon())) return {q, Quat<T>{}};
  const Quat<T> twist{q.w / l, axis * (along / l)};
  return {normalize(q * conjugate(twist)), twist};
}
/// The angle of the twist of q about the unit vector `axis`, in (−π, π].
template <class T>
inline T twist_angle(const Quat<T>& q, Vec3<T> axis) {
  return wrap_angle(T(2) * atan2(dot(q.vector(), axis), q.w));
}

}  // namespace carom::math
