// Angles between the frames of a joint.
#pragma once

#include "carom/math/elementary.h"
#include "carom/rigid/dimension.h"

namespace carom::rigid::detail {

/// x brought into [−π, π].
inline float wrap_angle(float x) {
  if (x >= -pi_f && x <= pi_f) return x;
  return float(double(x) - 2 * pi * double(math::floor((double(x) + pi) / (2 * pi))));
}

/// The turn about z (3D: the twist of the swing–twist decomposition), rad in [−π, π].
inline float twist_angle(Rot2f q) { return math::atan2(q.s, q.c); }
inline float twist_angle(const Quatf& q) { return q.w < 0 ? 2 * math::atan2(-q.z, -q.w) : 2 * math::atan2(q.z, q.w); }

/// The rotation vector of a unit quaternion, |angle| ≤ π.
inline Vec3f rotation_vector_of(Quatf q) {
  if (q.w < 0) q = -q;
  const Vec3f v = q.vector();
  const float s2 = length_squared(v);
  if (s2 < 0.01f) return (2 + s2 * (1.0f / 3 + s2 * 0.15f)) * v;  // 2 asin(s)/s
  const float s = math::sqrt(s2);
  return (2 * math::atan2(s, q.w) / s) * v;
}

}  // namespace carom::rigid::detail
