// Frames that turn: the forces that appear in them (chapter 1.1, 3.2).
#pragma once

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::environment {

/// A frame that turns steadily with `rate` about an axis through `origin`.
struct RotatingFrame {
  math::Vec3d rate{};    ///< rad/s, Ω
  math::Vec3d origin{};  ///< m, on the axis
  /// Whether Ω × (Ω × r) is felt too. On Earth it is part of the gravity that a plumb line shows: leave it out there.
  bool centrifugal = false;
};
/// −2 Ω × v, and −Ω × (Ω × r) where asked for: what a free body seems to feel (m/s²) at r with v in the frame.
constexpr math::Vec3d frame_acceleration(const RotatingFrame& frame, math::Vec3d point, math::Vec3d velocity) {
  math::Vec3d a = -2.0 * math::cross(frame.rate, velocity);
  if (frame.centrifugal) a = a - math::cross(frame.rate, math::cross(frame.rate, point - frame.origin));
  return a;
}
/// The Earth's turning seen from a place at `latitude` (rad, north positive) in axes with y up whose x axis points to
/// the compass bearing `bearing` (rad from north over east): Ω (cos φ north + sin φ up).
inline math::Vec3d earth_rate(double latitude, double bearing = 0.5 * math::pi, double rate = 7.292115e-5) {
  const math::SinCos<double> phi = math::sincos(latitude), b = math::sincos(bearing);
  // North in axes x (bearing b), y up, z to the right of x: cos b along x, −sin b along z.
  return {rate * phi.cos * b.cos, rate * phi.sin, 0.0 - rate * phi.cos * b.sin};
}

}  // namespace carom::environment
