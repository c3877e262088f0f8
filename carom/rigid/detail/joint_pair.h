// Two bodies as a joint sees them while it is solved, and the small algebra that the plane and space share.
#pragma once

#include "carom/rigid/dimension.h"

namespace carom::rigid::detail {

inline float inner(float a, float b) { return a * b; }
inline float inner(Vec3f a, Vec3f b) { return dot(a, b); }
inline float magnitude(float a) { return math::abs(a); }
inline float magnitude(Vec3f a) { return math::length(a); }

/// The working copy of the two bodies of a joint. A fixed body or the world has zero inverse mass and inertia.
/// I: the inverse inertia; in space a number will do for bodies that turn alike about every axis.
template <class D, class I = typename D::Inertia>
struct BodyPair {
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  using Inertia = I;

  Vector velocity_a{}, velocity_b{};
  Angular spin_a{}, spin_b{};
  float inverse_mass_a = 0, inverse_mass_b = 0;
  Inertia inverse_inertia_a{}, inverse_inertia_b{};  ///< world axes
  typename D::Rotation turn_a{}, turn_b{};           ///< since the step began
  Vector moved_a{};                                  ///< displacement of the centre of A since the step began
  Vector shift{};  ///< centre of B minus centre of A, less what it was when the step began

  Vector point_velocity(Vector arm_a, Vector arm_b) const {
    return velocity_b + cross(spin_b, arm_b) - velocity_a - cross(spin_a, arm_a);
  }
  void apply(Vector impulse, Vector arm_a, Vector arm_b) {
    velocity_a -= inverse_mass_a * impulse;
    spin_a -= inverse_inertia_a * cross(arm_a, impulse);
    velocity_b += inverse_mass_b * impulse;
    spin_b += inverse_inertia_b * cross(arm_b, impulse);
  }
  void apply_angular(Angular impulse) {
    spin_a -= inverse_inertia_a * impulse;
    spin_b += inverse_inertia_b * impulse;
  }
  /// A row with direction n at B, and moments `lever_a`, `lever_b` of it about the centres.
  void apply_row(float impulse, Vector n, Angular lever_a, Angular lever_b) {
    velocity_a -= (inverse_mass_a * impulse) * n;
    spin_a -= inverse_inertia_a * (impulse * lever_a);
    velocity_b += (inverse_mass_b * impulse) * n;
    spin_b += inverse_inertia_b * (impulse * lever_b);
  }
  float row_velocity(Vector n, Angular lever_a, Angular lever_b) const {
    return dot(n, velocity_b - velocity_a) + inner(lever_b, spin_b) - inner(lever_a, spin_a);
  }
  float row_inverse_mass(Angular lever_a, Angular lever_b) const {
    return inverse_mass_a + inverse_mass_b + inner(lever_a, inverse_inertia_a * lever_a) +
           inner(lever_b, inverse_inertia_b * lever_b);
  }
};

/// Adds [r]× I [r]×ᵀ, the mobility of a point at r by turning, to k.
inline void add_point_mobility(Mat3f& k, Vec3f r, const Mat3f& inertia) {
  const Vec3f x = cross(r, inertia.cx), y = cross(r, inertia.cy), z = cross(r, inertia.cz);  // columns of [r]× I
  // Column j of [r]× I [r]×ᵀ is r × (row j of [r]× I).
  k.cx += cross(r, Vec3f{x.x, y.x, z.x});
  k.cy += cross(r, Vec3f{x.y, y.y, z.y});
  k.cz += cross(r, Vec3f{x.z, y.z, z.z});
}
inline void add_point_mobility(Mat3f& k, Vec3f r, float inertia) {
  const Vec3f s = inertia * r;
  const float trace = dot(s, r);
  k.cx += Vec3f{trace - s.x * r.x, -s.x * r.y, -s.x * r.z};
  k.cy += Vec3f{-s.y * r.x, trace - s.y * r.y, -s.y * r.z};
  k.cz += Vec3f{-s.z * r.x, -s.z * r.y, trace - s.z * r.z};
}
inline void add_point_mobility(Mat2f& k, Vec2f r, float inertia) {
  k.cx += Vec2f{inertia * r.y * r.y, -inertia * r.x * r.y};
  k.cy += Vec2f{-inertia * r.x * r.y, inertia * r.x * r.x};
}

/// m = L D Lᵀ, which keeps its digits at extreme mass ratios where cofactors cancel. Rows that cannot move get zero.
struct Factor3 {
  float i1 = 0, i2 = 0, i3 = 0, l21 = 0, l31 = 0, l32 = 0;  ///< 1/D and L
};
inline Factor3 factorise(const Mat3f& m) {
  Factor3 f;
  f.i1 = m.cx.x > 0 ? 1 / m.cx.x : 0;
  f.l21 = m.cx.y * f.i1;
  f.l31 = m.cx.z * f.i1;
  const float d2 = m.cy.y - f.l21 * m.cx.y;
  f.i2 = d2 > 1e-7f * m.cy.y ? 1 / d2 : 0;
  const float u32 = m.cy.z - f.l31 * m.cx.y;
  f.l32 = u32 * f.i2;
  const float d3 = m.cz.z - f.l31 * m.cx.z - f.l32 * u32;
  f.i3 = d3 > 1e-7f * m.cz.z ? 1 / d3 : 0;
  return f;
}
inline Vec3f solve(const Factor3& f, Vec3f v) {
  const float y2 = v.y - f.l21 * v.x, y3 = v.z - f.l31 * v.x - f.l32 * y2;
  const float z = y3 * f.i3;
  const float y = y2 * f.i2 - f.l32 * z;
  const float x = v.x * f.i1 - f.l21 * y - f.l31 * z;
  return {x, y, z};
}
struct Factor2 {
  float i1 = 0, i2 = 0, l21 = 0;
};
inline Factor2 factorise(const Mat2f& m) {
  Factor2 f;
  f.i1 = m.cx.x > 0 ? 1 / m.cx.x : 0;
  f.l21 = m.cx.y * f.i1;
  const float d2 = m.cy.y - f.l21 * m.cx.y;
  f.i2 = d2 > 1e-7f * m.cy.y ? 1 / d2 : 0;
  return f;
}
inline Vec2f solve(const Factor2& f, Vec2f v) {
  const float y = (v.y - f.l21 * v.x) * f.i2;
  return {v.x * f.i1 - f.l21 * y, y};
}
inline Vec3f solve_mobility(const Mat3f& m, Vec3f v) { return solve(factorise(m), v); }
inline Vec2f solve_mobility(const Mat2f& m, Vec2f v) { return solve(factorise(m), v); }
inline Vec3f solve_mobility(float m, Vec3f v) { return m > 0 ? v * (1 / m) : Vec3f{}; }
inline float solve_mobility(float m, float v) { return m > 0 ? v / m : 0; }

template <class D, class I>
auto point_mobility(const BodyPair<D, I>& pair, typename D::Vector arm_a, typename D::Vector arm_b) {
  const float m = pair.inverse_mass_a + pair.inverse_mass_b;
  if constexpr (D::dimension == 2) {
    Mat2f k{{m, 0}, {0, m}};
    add_point_mobility(k, arm_a, pair.inverse_inertia_a);
    add_point_mobility(k, arm_b, pair.inverse_inertia_b);
    return k;
  } else {
    Mat3f k{{m, 0, 0}, {0, m, 0}, {0, 0, m}};
    add_point_mobility(k, arm_a, pair.inverse_inertia_a);
    add_point_mobility(k, arm_b, pair.inverse_inertia_b);
    return k;
  }
}

}  // namespace carom::rigid::detail
