// Square matrices of order two, three and four, stored by columns (appendix B of the subject).
#pragma once

#include "carom/math/vec.h"

namespace carom::math {

template <class T>
struct Mat2 {
  Vec2<T> cx{1, 0}, cy{0, 1};

  constexpr T operator()(int row, int column) const { return column == 0 ? cx[row] : cy[row]; }
  static constexpr Mat2 identity() { return {}; }
  static constexpr Mat2 zero() { return {{0, 0}, {0, 0}}; }
  friend constexpr Vec2<T> operator*(const Mat2& m, Vec2<T> v) { return m.cx * v.x + m.cy * v.y; }
  friend constexpr Vec2<T> operator*(Vec2<T> v, const Mat2& m) { return {dot(v, m.cx), dot(v, m.cy)}; }
  friend constexpr Mat2 operator*(const Mat2& a, const Mat2& b) { return {a * b.cx, a * b.cy}; }
  friend constexpr Mat2 operator*(T s, const Mat2& m) { return {s * m.cx, s * m.cy}; }
  friend constexpr Mat2 operator*(const Mat2& m, T s) { return s * m; }
  friend constexpr Mat2 operator/(const Mat2& m, T s) { return {m.cx / s, m.cy / s}; }
  friend constexpr Mat2 operator+(const Mat2& a, const Mat2& b) { return {a.cx + b.cx, a.cy + b.cy}; }
  friend constexpr Mat2 operator-(const Mat2& a, const Mat2& b) { return {a.cx - b.cx, a.cy - b.cy}; }
  friend constexpr bool operator==(const Mat2& a, const Mat2& b) { return a.cx == b.cx && a.cy == b.cy; }
};

template <class T>
struct Mat3 {
  Vec3<T> cx{1, 0, 0}, cy{0, 1, 0}, cz{0, 0, 1};

  constexpr Mat3() = default;
  constexpr Mat3(Vec3<T> x, Vec3<T> y, Vec3<T> z) : cx(x), cy(y), cz(z) {}
  template <class U>
  explicit constexpr Mat3(const Mat3<U>& m) : cx(m.cx), cy(m.cy), cz(m.cz) {}

  constexpr Vec3<T>& column(int i) { return i == 0 ? cx : (i == 1 ? cy : cz); }
  constexpr Vec3<T> column(int i) const { return i == 0 ? cx : (i == 1 ? cy : cz); }
  constexpr T operator()(int row, int col) const { return column(col)[row]; }
  static constexpr Mat3 identity() { return {}; }
  static constexpr Mat3 zero() { return {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}}; }
  static constexpr Mat3 diagonal(Vec3<T> d) { return {{d.x, 0, 0}, {0, d.y, 0}, {0, 0, d.z}}; }
  friend constexpr Vec3<T> operator*(const Mat3& m, Vec3<T> v) { return m.cx * v.x + m.cy * v.y + m.cz * v.z; }
  friend constexpr Vec3<T> operator*(Vec3<T> v, const Mat3& m) { return {dot(v, m.cx), dot(v, m.cy), dot(v, m.cz)}; }
  friend constexpr Mat3 operator*(const Mat3& a, const Mat3& b) { return {a * b.cx, a * b.cy, a * b.cz}; }
  friend constexpr Mat3 operator*(T s, const Mat3& m) { return {s * m.cx, s * m.cy, s * m.cz}; }
  friend constexpr Mat3 operator*(const Mat3& m, T s) { return s * m; }
  friend constexpr Mat3 operator/(const Mat3& m, T s) { return {m.cx / s, m.cy / s, m.cz / s}; }
  friend constexpr Mat3 operator+(const Mat3& a, const Mat3& b) { return {a.cx + b.cx, a.cy + b.cy, a.cz + b.cz}; }
  friend constexpr Mat3 operator-(const Mat3& a, const Mat3& b) { return {a.cx - b.cx, a.cy - b.cy, a.cz - b.cz}; }
  friend constexpr bool operator==(const Mat3& a, const Mat3& b) {
    return a.cx == b.cx && a.cy == b.cy && a.cz == b.cz;
  }
};

template <class T>
struct Mat4 {
  Vec4<T> cx{1, 0, 0, 0}, cy{0, 1, 0, 0}, cz{0, 0, 1, 0}, cw{0, 0, 0, 1};

  constexpr Vec4<T> column(int i) const { return i == 0 ? cx : (i == 1 ? cy : (i == 2 ? cz : cw)); }
  constexpr T operator()(int row, int col) const { return column(col)[row]; }
  static constexpr Mat4 identity() { return {}; }
  friend constexpr Vec4<T> operator*(const Mat4& m, Vec4<T> v) {
    return m.cx * v.x + m.cy * v.y + m.cz * v.z + m.cw * v.w;
  }
  friend constexpr Mat4 operator*(const Mat4& a, const Mat4& b) { return {a * b.cx, a * b.cy, a * b.cz, a * b.cw}; }
  friend constexpr Mat4 operator*(T s, const Mat4& m) { return {s * m.cx, s * m.cy, s * m.cz, s * m.cw}; }
  friend constexpr Mat4 operator*(const Mat4& m, T s) { return s * m; }
  friend constexpr Mat4 operator/(const Mat4& m, T s) { return {m.cx / s, m.cy / s, m.cz / s, m.cw / s}; }
  friend constexpr Mat4 operator+(const Mat4& a, const Mat4& b) {
    return {a.cx + b.cx, a.cy + b.cy, a.cz + b.cz, a.cw + b.cw};
  }
  friend constexpr Mat4 operator-(const Mat4& a, const Mat4& b) {
    return {a.cx - b.cx, a.cy - b.cy, a.cz - b.cz, a.cw - b.cw};
  }
  friend constexpr bool operator==(const Mat4& a, const Mat4& b) {
    return a.cx == b.cx && a.cy == b.cy && a.cz == b.cz && a.cw == b.cw;
  }
};

using Mat2f = Mat2<float>;
using Mat2d = Mat2<double>;
using Mat3f = Mat3<float>;
using Mat3d = Mat3<double>;
using Mat4f = Mat4<float>;
using Mat4d = Mat4<double>;

template <class T>
constexpr Mat2<T> transpose(const Mat2<T>& m) {
  return {{m.cx.x, m.cy.x}, {m.cx.y, m.cy.y}};
}
template <class T>
constexpr Mat3<T> transpose(const Mat3<T>& m) {
  return {{m.cx.x, m.cy.x, m.cz.x}, {m.cx.y, m.cy.y, m.cz.y}, {m.cx.z, m.cy.z, m.cz.z}};
}
template <class T>
constexpr T determinant(const Mat2<T>& m) {
  return cross(m.cx, m.cy);
}
template <class T>
constexpr T determinant(const Mat3<T>& m) {
  return triple(m.cx, m.cy, m.cz);
}
template <class T>
constexpr T trace(const Mat3<T>& m) {
  return m.cx.x + m.cy.y + m.cz.z;
}

/// The inverse by cofactors, or the zero matrix where the determinant is zero.
template <class T>
constexpr Mat2<T> inverse(const Mat2<T>& m) {
  const T d = determinant(m);
  const T s = d != T(0) ? T(1) / d : T(0);
  return {{s * m.cy.y, -s * m.cx.y}, {-s * m.cy.x, s * m.cx.x}};
}
template <class T>
constexpr Mat3<T> inverse(const Mat3<T>& m) {
  const Vec3<T> a = cross(m.cy, m.cz), b = cross(m.cz, m.cx), c = cross(m.cx, m.cy);
  const T d = dot(m.cx, a);
  const T s = d != T(0) ? T(1) / d : T(0);
  return transpose(Mat3<T>{a * s, b * s, c * s});
}

template <class T>
constexpr Mat4<T> transpose(const Mat4<T>& m) {
  return {{m.cx.x, m.cy.x, m.cz.x, m.cw.x},
          {m.cx.y, m.cy.y, m.cz.y, m.cw.y},
          {m.cx.z, m.cy.z, m.cz.z, m.cw.z},
          {m.cx.w, m.cy.w, m.cz.w, m.cw.w}};
}

namespace detail {
/// The 2×2 minors of the first two rows (a) and of the last two (b) of a 4×4 matrix, for Laplace's expansion.
template <class T>
struct Minors4 {
  T a01, a02, a03, a12, a13, a23, b01, b02, b03, b12, b13, b23;
  constexpr explicit Minors4(const Mat4<T>& m)
      : a01(m.cx.x * m.cy.y - m.cx.y * m.cy.x),
        a02(m.cx.x * m.cz.y - m.cx.y * m.cz.x),
        a03(m.cx.x * m.cw.y - m.cx.y * m.cw.x),
        a12(m.cy.x * m.cz.y - m.cy.y * m.cz.x),
        a13(m.cy.x * m.cw.y - m.cy.y * m.cw.x),
        a23(m.cz.x * m.cw.y - m.cz.y * m.cw.x),
        b01(m.cx.z * m.cy.w - m.cx.w * m.cy.z),
        b02(m.cx.z * m.cz.w - m.cx.w * m.cz.z),
        b03(m.cx.z * m.cw.w - m.cx.w * m.cw.z),
        b12(m.cy.z * m.cz.w - m.cy.w * m.cz.z),
        b13(m.cy.z * m.cw.w - m.cy.w * m.cw.z),
        b23(m.cz.z * m.cw.w - m.cz.w * m.cw.z) {}
  constexpr T determinant() const { return a01 * b23 - a02 * b13 + a03 * b12 + a12 * b03 - a13 * b02 + a23 * b01; }
};
}  // namespace detail

template <class T>
constexpr T determinant(const Mat4<T>& m) {
  return detail::Minors4<T>(m).determinant();
}
/// The inverse by cofactors, or the zero matrix where the determinant is zero.
template <class T>
constexpr Mat4<T> inverse(const Mat4<T>& m) {
  const detail::Minors4<T> n(m);
  const T d = n.determinant();
  const T s = d != T(0) ? T(1) / d : T(0);
  const Vec4<T>&x = m.cx, &y = m.cy, &z = m.cz, &w = m.cw;
  const Mat4<T> adjugate{{y.y * n.b23 - z.y * n.b13 + w.y * n.b12, -x.y * n.b23 + z.y * n.b03 - w.y * n.b02,
                          x.y * n.b13 - y.y * n.b03 + w.y * n.b01, -x.y * n.b12 + y.y * n.b02 - z.y * n.b01},
                         {-y.x * n.b23 + z.x * n.b13 - w.x * n.b12, x.x * n.b23 - z.x * n.b03 + w.x * n.b02,
                          -x.x * n.b13 + y.x * n.b03 - w.x * n.b01, x.x * n.b12 - y.x * n.b02 + z.x * n.b01},
                         {y.w * n.a23 - z.w * n.a13 + w.w * n.a12, -x.w * n.a23 + z.w * n.a03 - w.w * n.a02,
                          x.w * n.a13 - y.w * n.a03 + w.w * n.a01, -x.w * n.a12 + y.w * n.a02 - z.w * n.a01},
                         {-y.z * n.a23 + z.z * n.a13 - w.z * n.a12, x.z * n.a23 - z.z * n.a03 + w.z * n.a02,
                          -x.z * n.a13 + y.z * n.a03 - w.z * n.a01, x.z * n.a12 - y.z * n.a02 + z.z * n.a01}};
  return adjugate * s;
}

/// x ↦ m x + p as a 4×4 matrix on homogeneous coordinates, and what it does to points and to directions.
template <class T>
constexpr Mat4<T> affine(const Mat3<T>& m, Vec3<T> p) {
  return {{m.cx.x, m.cx.y, m.cx.z, 0}, {m.cy.x, m.cy.y, m.cy.z, 0}, {m.cz.x, m.cz.y, m.cz.z, 0}, {p.x, p.y, p.z, 1}};
}
template <class T>
constexpr Vec3<T> transform_point(const Mat4<T>& m, Vec3<T> v) {
  const Vec4<T> r = m * Vec4<T>{v.x, v.y, v.z, T(1)};
  return {r.x, r.y, r.z};
}
template <class T>
constexpr Vec3<T> transform_direction(const Mat4<T>& m, Vec3<T> v) {
  const Vec4<T> r = m * Vec4<T>{v.x, v.y, v.z, T(0)};
  return {r.x, r.y, r.z};
}

/// The matrix of v ↦ a × v.
template <class T>
constexpr Mat3<T> skew(Vec3<T> a) {
  return {{0, a.z, -a.y}, {-a.z, 0, a.x}, {a.y, -a.x, 0}};
}
/// a bᵀ.
template <class T>
constexpr Mat3<T> outer(Vec3<T> a, Vec3<T> b) {
  return {a * b.x, a * b.y, a * b.z};
}

}  // namespace carom::math
