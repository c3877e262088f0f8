// Vectors of two, three and four components (appendix A of the subject).
// `f` aliases are the engine's local float quantities, `d` aliases world positions and reference computations.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace carom::math {

/// Correctly rounded square root, the same bits everywhere (IEEE 754). NaN for x < 0.
inline float sqrt(float x) { return __builtin_sqrtf(x); }
inline double sqrt(double x) { return __builtin_sqrt(x); }

template <class T>
constexpr T min(T a, T b) {
  return b < a ? b : a;
}
template <class T>
constexpr T max(T a, T b) {
  return a < b ? b : a;
}
template <class T>
constexpr T clamp(T x, T low, T high) {
  return x < low ? low : (high < x ? high : x);
}
template <class T>
constexpr T abs(T x) {
  // One instruction where comparisons are two branches that cannot be foretold.
  if constexpr (std::is_same_v<T, float>)
    return __builtin_fabsf(x);
  else if constexpr (std::is_same_v<T, double>)
    return __builtin_fabs(x);
  else
    return x < T(0) ? -x : (x == T(0) ? T(0) : x);
}
template <class T>
constexpr T square(T x) {
  return x * x;
}
template <class T>
constexpr T lerp(T a, T b, T t) {
  return a + (b - a) * t;
}

/// True for every number that is neither infinite nor NaN.
constexpr bool is_finite(float x) { return x - x == 0.0f; }
constexpr bool is_finite(double x) { return x - x == 0.0; }

template <class T>
struct Vec2 {
  T x{}, y{};

  constexpr Vec2() = default;
  constexpr Vec2(T x_, T y_) : x(x_), y(y_) {}
  template <class U>
  explicit constexpr Vec2(const Vec2<U>& v) : x(T(v.x)), y(T(v.y)) {}

  constexpr T& operator[](int i) { return i == 0 ? x : y; }
  constexpr T operator[](int i) const { return i == 0 ? x : y; }
  constexpr Vec2& operator+=(Vec2 b) {
    x += b.x;
    y += b.y;
    return *this;
  }
  constexpr Vec2& operator-=(Vec2 b) {
    x -= b.x;
    y -= b.y;
    return *this;
  }
  constexpr Vec2& operator*=(T s) {
    x *= s;
    y *= s;
    return *this;
  }
  constexpr Vec2& operator/=(T s) {
    x /= s;
    y /= s;
    return *this;
  }
  friend constexpr Vec2 operator-(Vec2 a) { return {-a.x, -a.y}; }
  friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2 operator*(T s, Vec2 a) { return {s * a.x, s * a.y}; }
  friend constexpr Vec2 operator*(Vec2 a, T s) { return {s * a.x, s * a.y}; }
  friend constexpr Vec2 operator/(Vec2 a, T s) { return {a.x / s, a.y / s}; }
  friend constexpr bool operator==(Vec2 a, Vec2 b) { return a.x == b.x && a.y == b.y; }
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  constexpr Vec3() = default;
  constexpr Vec3(T x_, T y_, T z_) : x(x_), y(y_), z(z_) {}
  template <class U>
  explicit constexpr Vec3(const Vec3<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)) {}

  constexpr T& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  constexpr T operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
  constexpr Vec3& operator+=(Vec3 b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  constexpr Vec3& operator-=(Vec3 b) {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  constexpr Vec3& operator*=(T s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
  constexpr Vec3& operator/=(T s) {
    x /= s;
    y /= s;
    z /= s;
    return *this;
  }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator*(T s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, T s) { return {s * a.x, s * a.y, s * a.z}; }
  friend constexpr Vec3 operator/(Vec3 a, T s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(Vec3 a, Vec3 b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

template <class T>
struct Vec4 {
  T x{}, y{}, z{}, w{};

  constexpr Vec4() = default;
  constexpr Vec4(T x_, T y_, T z_, T w_) : x(x_), y(y_), z(z_), w(w_) {}
  template <class U>
  explicit constexpr Vec4(const Vec4<U>& v) : x(T(v.x)), y(T(v.y)), z(T(v.z)), w(T(v.w)) {}

  constexpr T& operator[](int i) { return i == 0 ? x : (i == 1 ? y : (i == 2 ? z : w)); }
  constexpr T operator[](int i) const { return i == 0 ? x : (i == 1 ? y : (i == 2 ? z : w)); }
  friend constexpr Vec4 operator-(Vec4 a) { return {-a.x, -a.y, -a.z, -a.w}; }
  friend constexpr Vec4 operator+(Vec4 a, Vec4 b) { return {a.x + b.x, a.y + b.y, a.z + b.z, a.w + b.w}; }
  friend constexpr Vec4 operator-(Vec4 a, Vec4 b) { return {a.x - b.x, a.y - b.y, a.z - b.z, a.w - b.w}; }
  friend constexpr Vec4 operator*(T s, Vec4 a) { return {s * a.x, s * a.y, s * a.z, s * a.w}; }
  friend constexpr Vec4 operator*(Vec4 a, T s) { return s * a; }
  friend constexpr Vec4 operator/(Vec4 a, T s) { return {a.x / s, a.y / s, a.z / s, a.w / s}; }
  friend constexpr bool operator==(Vec4 a, Vec4 b) { return a.x == b.x && a.y == b.y && a.z == b.z && a.w == b.w; }
};

using Vec2f = Vec2<float>;
using Vec2d = Vec2<double>;
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
using Vec4f = Vec4<float>;
using Vec4d = Vec4<double>;

template <class T>
constexpr T dot(Vec2<T> a, Vec2<T> b) {
  return a.x * b.x + a.y * b.y;
}
template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr T dot(Vec4<T> a, Vec4<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w;
}

/// The z component of a × b.
template <class T>
constexpr T cross(Vec2<T> a, Vec2<T> b) {
  return a.x * b.y - a.y * b.x;
}
/// (ω ẑ) × r: the velocity of a point at r that turns with ω.
template <class T>
constexpr Vec2<T> cross(T w, Vec2<T> r) {
  return {-w * r.y, w * r.x};
}
template <class T>
constexpr Vec2<T> cross(Vec2<T> r, T w) {
  return {w * r.y, -w * r.x};
}
template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
/// a · (b × c): the signed volume of the parallelepiped.
template <class T>
constexpr T triple(Vec3<T> a, Vec3<T> b, Vec3<T> c) {
  return dot(a, cross(b, c));
}

template <class V>
constexpr auto length_squared(V a) {
  return dot(a, a);
}
template <class V>
inline auto length(V a) {
  return math::sqrt(dot(a, a));
}
template <class V>
constexpr auto distance_squared(V a, V b) {
  return length_squared(a - b);
}
template <class V>
inline auto distance(V a, V b) {
  return math::length(a - b);
}

/// a/|a|, or `fallback` where |a| is not above `tolerance` (or not a number).
template <class V, class T>
inline V normalize_or(V a, V fallback, T tolerance) {
  const auto l = math::length(a);
  return l > tolerance ? a * (1 / l) : fallback;
}
/// a/|a|, or the zero vector where a is too short to have a direction.
inline Vec2f normalize(Vec2f a) { return normalize_or(a, Vec2f{}, 1e-18f); }
inline Vec3f normalize(Vec3f a) { return normalize_or(a, Vec3f{}, 1e-18f); }
inline Vec2d normalize(Vec2d a) { return normalize_or(a, Vec2d{}, 1e-150); }
inline Vec3d normalize(Vec3d a) { return normalize_or(a, Vec3d{}, 1e-150); }

template <class T>
constexpr Vec2<T> min(Vec2<T> a, Vec2<T> b) {
  return {min(a.x, b.x), min(a.y, b.y)};
}
template <class T>
constexpr Vec2<T> max(Vec2<T> a, Vec2<T> b) {
  return {max(a.x, b.x), max(a.y, b.y)};
}
template <class T>
constexpr Vec3<T> min(Vec3<T> a, Vec3<T> b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
template <class T>
constexpr Vec3<T> max(Vec3<T> a, Vec3<T> b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}
template <class T>
constexpr Vec2<T> abs(Vec2<T> a) {
  return {abs(a.x), abs(a.y)};
}
template <class T>
constexpr Vec3<T> abs(Vec3<T> a) {
  return {abs(a.x), abs(a.y), abs(a.z)};
}
/// Component by component product.
template <class T>
constexpr Vec2<T> scale(Vec2<T> a, Vec2<T> b) {
  return {a.x * b.x, a.y * b.y};
}
template <class T>
constexpr Vec3<T> scale(Vec3<T> a, Vec3<T> b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
template <class T>
constexpr Vec2<T> lerp(Vec2<T> a, Vec2<T> b, T t) {
  return a + (b - a) * t;
}
template <class T>
constexpr Vec3<T> lerp(Vec3<T> a, Vec3<T> b, T t) {
  return a + (b - a) * t;
}

/// a turned by +90°.
template <class T>
constexpr Vec2<T> perpendicular(Vec2<T> a) {
  return {-a.y, a.x};
}
/// A unit vector at right angles to the unit vector n; continuous except at one pole (Duff et al. 2017).
template <class T>
constexpr Vec3<T> perpendicular(Vec3<T> n) {
  const T s = n.z < 0 ? T(-1) : T(1);
  const T a = T(-1) / (s + n.z);
  return {T(1) + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x};
}

template <class T>
constexpr bool is_finite(Vec2<T> a) {
  return is_finite(a.x) && is_finite(a.y);
}
template <class T>
constexpr bool is_finite(Vec3<T> a) {
  return is_finite(a.x) && is_finite(a.y) && is_finite(a.z);
}
template <class T>
constexpr bool is_finite(Vec4<T> a) {
  return is_finite(a.x) && is_finite(a.y) && is_finite(a.z) && is_finite(a.w);
}

inline constexpr double pi = 3.14159265358979323846;
inline constexpr float pi_f = 3.14159265358979323846f;
template <class T>
constexpr T radians(T degrees) {
  return degrees * T(pi / 180.0);
}
template <class T>
constexpr T degrees(T radians) {
  return radians * T(180.0 / pi);
}

}  // namespace carom::math
