// One coordinate follows another: gears, racks, screws and ropes over pulleys.
#pragma once

#include "carom/rigid/detail/joint_blocks.h"

namespace carom::rigid::detail {

enum class CouplingKind : std::uint8_t { gear, rack, screw, pulley };

/// The turn of q about the unit axis n, rad in [−π, π]; in the plane n does not matter.
inline float turn_about(Rot2f q, float) { return twist_angle(q); }
inline float turn_about(const Quatf& q, const Vec3f& n) {
  const float s = dot(q.vector(), n);
  return q.w < 0 ? 2 * math::atan2(-s, -q.w) : 2 * math::atan2(s, q.w);
}

/// Ċ = along_a·v_a + about_a·ω_a + along_b·v_b + about_b·ω_b. Gears, racks and screws remember C (`drift`) from step to
/// step and add what the step's displacements make of it; a pulley measures it.
template <class D>
struct CouplingBlock {
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  CouplingKind kind = CouplingKind::gear;
  float ratio = 1;                          ///< gear, pulley; rack: radius; screw: m a radian
  Angular spin_axis_a{}, spin_axis_b{};     ///< world axes at the start of the step
  Vector slide_axis{};                      ///< x of B (rack) or A (screw), likewise
  Vector arm_a{}, arm_b{}, offset{};        ///< as in PinBlock
  Vector from_ground_a{}, from_ground_b{};  ///< pulley: from the grounds to the centres
  float slid = 0;                           ///< screw: the coordinate at the start of the step
  float length = 0, drift = 0, impulse = 0;

  struct Row {
    Vector along_a{}, along_b{};
    Angular about_a{}, about_b{};
    float error = 0;
  };
  static Angular turned(const typename D::Rotation& q, const Angular& axis) {
    if constexpr (D::dimension == 2)
      return axis;
    else
      return rotate(q, axis);
  }
  template <class Pair>
  Row row(const Pair& pair) const {
    Row r;
    if (kind == CouplingKind::gear) {
      r.about_a = -ratio * turned(pair.turn_a, spin_axis_a);
      r.about_b = turned(pair.turn_b, spin_axis_b);
      r.error = drift + turn_about(pair.turn_b, spin_axis_b) - ratio * turn_about(pair.turn_a, spin_axis_a);
    } else if (kind == CouplingKind::rack) {
      const Vector x = rotate(pair.turn_b, slide_axis);
      r.along_b = x;
      r.along_a = -x;
      r.about_a = -ratio * turned(pair.turn_a, spin_axis_a);
      r.error = drift + dot(x, pair.shift) - ratio * turn_about(pair.turn_a, spin_axis_a);
    } else if (kind == CouplingKind::screw) {
      const Vector x = rotate(pair.turn_a, slide_axis), b = rotate(pair.turn_b, arm_b);
      const Vector reach = offset + pair.shift + b;
      const Angular twist = ratio * turned(pair.turn_a, spin_axis_a);
      r.along_b = x;
      r.along_a = -x;
      r.about_b = cross(b, x) - twist;
      r.about_a = twist - cross(reach, x);
      const auto turn = conjugate(pair.turn_a) * pair.turn_b;
      r.error = drift + dot(reach - rotate(pair.turn_a, arm_a), x) - slid - ratio * turn_about(turn, spin_axis_a);
    } else {
      const Vector a = rotate(pair.turn_a, arm_a), b = rotate(pair.turn_b, arm_b);
      const Vector to_a = from_ground_a + pair.moved_a + a, to_b = from_ground_b + pair.moved_a + pair.shift + b;
      const float length_a = math::length(to_a), length_b = math::length(to_b);
      r.along_a = length_a > 1e-6f ? to_a * (1 / length_a) : Vector{};
      r.along_b = length_b > 1e-6f ? to_b * (ratio / length_b) : Vector{};
      r.about_a = cross(a, r.along_a);
      r.about_b = cross(b, r.along_b);
      r.error = length_a + ratio * length_b - length;
    }
    return r;
  }
  template <class Pair>
  static void push(Pair& pair, const Row& r, float change) {
    pair.velocity_a += (pair.inverse_mass_a * change) * r.along_a;
    pair.spin_a += pair.inverse_inertia_a * (change * r.about_a);
    pair.velocity_b += (pair.inverse_mass_b * change) * r.along_b;
    pair.spin_b += pair.inverse_inertia_b * (change * r.about_b);
  }
  template <class Pair>
  void warm_start(Pair& pair) const {
    push(pair, row(pair), impulse);
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    const Row r = row(pair);
    const float mobility =
        pair.inverse_mass_a * dot(r.along_a, r.along_a) + pair.inverse_mass_b * dot(r.along_b, r.along_b) +
        inner(r.about_a, pair.inverse_inertia_a * r.about_a) + inner(r.about_b, pair.inverse_inertia_b * r.about_b);
    if (!(mobility > 0)) return;
    const float rate = dot(r.along_a, pair.velocity_a) + inner(r.about_a, pair.spin_a) +
                       dot(r.along_b, pair.velocity_b) + inner(r.about_b, pair.spin_b);
    const float old = impulse;
    if (kind == CouplingKind::pulley && r.error < 0) {
      impulse = old - (rate + r.error * pass.inverse_h) / mobility;  // slack: it may be taken up within the substep
    } else {
      const Response& response = pass.coupling;
      impulse = old - (response.velocity * rate + response.position * r.error) / mobility - response.memory * old;
    }
    if (kind == CouplingKind::pulley) impulse = min(impulse, 0.0f);
    push(pair, r, impulse - old);
  }
};

}  // namespace carom::rigid::detail
