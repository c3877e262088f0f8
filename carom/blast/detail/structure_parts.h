// What the sources of Structure share: numbers of either dimension, parts together, what hangs together.
#pragma once

#include <algorithm>

#include "carom/blast/detail/bond_stress.h"
#include "carom/blast/structure.h"

namespace carom::blast {

using math::Mat3d;
using math::Vec2d;
using math::Vec2f;
using math::Vec3d;
using math::Vec3f;
using rigid::Dim2;
using rigid::Dim3;

namespace detail {

template <class D>
using Mass = typename D::MassProperties;
template <class D>
using InertiaD = std::conditional_t<D::dimension == 2, double, Mat3d>;

inline double about(double inertia, double mass, Vec2d d) { return inertia + mass * length_squared(d); }
inline Mat3d about(const Mat3d& inertia, double mass, Vec3d d) { return geometry::transfer_inertia(inertia, mass, d); }
inline double solve_for(double inertia, double torque) { return inertia > 0 ? torque / inertia : 0; }
inline Vec3d solve_for(const Mat3d& inertia, Vec3d torque) {
  const double scale = trace(inertia) / 3;
  return scale > 0 ? inverse((1 / scale) * inertia) * (torque / scale) : Vec3d{};
}
/// ω × Iω, the torque that a spin about no principal axis takes.
inline double gyroscopic(double, double) { return 0; }
inline Vec3d gyroscopic(const Mat3d& inertia, Vec3d spin) { return cross(spin, inertia * spin); }
inline double no_inertia(Dim2*) { return 0; }
inline Mat3d no_inertia(Dim3*) { return Mat3d::zero(); }
inline Vec2d into(const math::Rot2f& q, Vec2d v) { return inverse_rotate(math::Rot2d(q), v); }
inline Vec3d into(const math::Quatf& q, Vec3d v) { return inverse_rotate(math::Quatd(q), v); }
inline double into(const math::Rot2f&, double w) { return w; }
inline Vec2d out_of(const math::Rot2f& q, Vec2d v) { return rotate(math::Rot2d(q), v); }
inline Vec3d out_of(const math::Quatf& q, Vec3d v) { return rotate(math::Quatd(q), v); }
inline float narrow(double w) { return float(w); }
inline Vec3f narrow(Vec3d w) { return Vec3f(w); }
inline double widen(float w) { return double(w); }
inline Vec3d widen(Vec3f w) { return Vec3d(w); }

/// The parts together, in the structure's frame.
template <class D>
Mass<D> together(const StructureDef<D>& d, const std::vector<std::uint32_t>& parts) {
  Mass<D> sum{};
  typename D::Position first{};
  for (const std::uint32_t p : parts) {
    sum.mass += d.parts[p].mass.mass;
    first += d.parts[p].mass.mass * d.parts[p].mass.center;
  }
  sum.center = first / sum.mass;
  InertiaD<D> inertia = no_inertia(static_cast<D*>(nullptr));
  for (const std::uint32_t p : parts) {
    const Mass<D>& m = d.parts[p].mass;
    inertia = inertia + about(m.inertia, m.mass, m.center - sum.center);
  }
  sum.inertia = inertia;
  return sum;
}

/// Components of the parts under the bonds that hold, in the order of their first parts.
template <class D>
std::vector<std::vector<std::uint32_t>> components(const StructureDef<D>& d, const std::vector<std::uint8_t>& intact,
                                                   const std::vector<std::uint32_t>& parts) {
  std::vector<std::uint32_t> parent(d.parts.size(), ground);
  for (const std::uint32_t p : parts) parent[p] = p;
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::size_t i = 0; i < d.bonds.size(); ++i) {
    const auto& b = d.bonds[i];
    if (!intact[i] || b.b == ground || parent[b.a] == ground || parent[b.b] == ground) continue;
    const std::uint32_t x = root(b.a), y = root(b.b);
    if (x != y) parent[math::max(x, y)] = math::min(x, y);
  }
  std::vector<std::vector<std::uint32_t>> found;
  std::vector<std::uint32_t> place(d.parts.size(), ground);
  for (const std::uint32_t p : parts) {
    const std::uint32_t r = root(p);
    if (place[r] == ground) place[r] = std::uint32_t(found.size()), found.emplace_back();
    found[place[r]].push_back(p);
  }
  return found;
}

template <class D>
bool stands(const StructureDef<D>& d, const std::vector<std::uint8_t>& intact,
            const std::vector<std::uint32_t>& parts) {
  for (std::size_t i = 0; i < d.bonds.size(); ++i)
    if (intact[i] && d.bonds[i].b == ground && std::binary_search(parts.begin(), parts.end(), d.bonds[i].a))
      return true;
  return false;
}

/// Of a free body, that its parts are not one piece; of what stands, that a piece of it no longer does.
template <class D>
bool comes_apart(const StructureDef<D>& d, const std::vector<std::uint8_t>& intact,
                 const std::vector<std::uint32_t>& parts, bool fixed) {
  const auto pieces = components(d, intact, parts);
  if (!fixed) return pieces.size() > 1;
  for (const auto& piece : pieces)
    if (!stands(d, intact, piece)) return true;
  return false;
}

}  // namespace detail

}  // namespace carom::blast
