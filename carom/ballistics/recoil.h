// Recoil: what the gun takes from a shot, how it moves in the hands, and a pattern for games (chapter 18.5).
#pragma once

#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::ballistics {

/// One shot as the gun feels it.
struct Charge {
  double bullet_mass = 0.0109;   ///< kg
  double muzzle_speed = 808;     ///< m/s
  double powder_mass = 0.00282;  ///< kg
  /// m/s at which the gas leaves: 1585 (5200 ft/s) by convention, or 1.75 times the muzzle speed for rifles.
  double gas_speed = 1585;
};
/// m_b v_b + m_p v_gas (N·s).
constexpr double recoil_impulse(const Charge& charge) {
  return charge.bullet_mass * charge.muzzle_speed + charge.powder_mass * charge.gas_speed;
}
struct FreeRecoil {
  double speed = 0;   ///< m/s of a gun that nothing holds
  double energy = 0;  ///< J
};
constexpr FreeRecoil free_recoil(const Charge& charge, double gun_mass) {
  const double speed = recoil_impulse(charge) / gun_mass;
  return {speed, 0.5 * gun_mass * speed * speed};
}

/// Speed (m/s) of a ballistic pendulum of mass M that keeps a bullet of mass m and speed v: m v/(m + M).
constexpr double pendulum_speed(double bullet_mass, double bullet_speed, double pendulum_mass) {
  return bullet_mass * bullet_speed / (bullet_mass + pendulum_mass);
}

/// A gun as a rigid body on springs at the shoulder: M q̈ + D q̇ + K q = 0 with six ways to move, x forward, y up and z
/// to the right and the turns about them, which a shot sets off with the impulse at the bore. Each way has a spring and
/// a damper of its own, given as the frequency f and the share ζ of critical damping that it has by itself (k = m (2π
/// f)², or I (2π f)² of a turn). With the centre of mass at the shoulder nothing couples them: back, rise and swing are
/// three damped oscillators, and nothing lifts, slides or rolls. A centre of mass elsewhere couples what it levers:
/// above or below, the way back with the rise; beside, the way back with the swing; ahead, the rise with the lift and
/// the swing with the slide; above and beside, the roll with lift and slide and with the other turns.
struct GunMount {
  double mass = 4;                    ///< kg, gun and what of the arms moves with it
  double inertia = 0.8;               ///< kg·m² about the shoulder, for rise and for swing
  double bore_above_shoulder = 0.03;  ///< m, the lever that lifts the muzzle
  double bore_beside_shoulder = 0.0;  ///< m, to the right: swings the muzzle to the right
  double push_frequency = 3;          ///< Hz, of the way back
  double push_damping = 0.8;          ///< ζ
  double rise_frequency = 1.6;        ///< Hz
  double rise_damping = 0.6;          ///< ζ
  double swing_frequency = 1.6;       ///< Hz
  double swing_damping = 0.6;         ///< ζ
  math::Vec3d centre_of_mass{};       ///< m from the shoulder: forward, up, to the right
  double roll_inertia = 0.02;         ///< kg·m² about the line through the shoulder along the bore
  double lift_frequency = 3;          ///< Hz, up and down
  double lift_damping = 0.8;          ///< ζ
  double slide_frequency = 3;         ///< Hz, from side to side
  double slide_damping = 0.8;         ///< ζ
  double roll_frequency = 3;          ///< Hz
  double roll_damping = 0.6;          ///< ζ
};
/// Errors: a frequency, damping, mass or inertia out of range; inertias about the shoulder that are less than those of
/// the mass in its centre, which no body has.
CAROM_API core::Status check(const GunMount& mount);

struct RecoilMotion {
  double back = 0;   ///< m
  double rise = 0;   ///< rad, up
  double swing = 0;  ///< rad, to the right
  double lift = 0;   ///< m, up
  double slide = 0;  ///< m, to the right
  double roll = 0;   ///< rad, clockwise to the shooter
};
/// The motion `time` s after shots at `shot_times` (s), each with the impulse (N·s); exact, by superposition. The mount
/// is one that `check` lets pass.
CAROM_API RecoilMotion recoil_at(const GunMount& mount, double impulse, std::span<const double> shot_times,
                                 double time);

/// A pattern for automatic fire: where each shot of a burst points, from the motion that the shots before it left, with
/// some wander of the hands; the same for the same seed.
struct RecoilPattern {
  int shots = 30;
  double rounds_per_minute = 650;
  double wander = 0.1;  ///< share of the rise that each shot adds in a random direction
  std::uint64_t seed = 1;
};
/// Aim offsets (rad: x to the right, y up) of shots 1 … n; the first is zero. Errors name a field out of range.
CAROM_API core::Result<std::vector<math::Vec2d>> recoil_pattern(const GunMount& mount, double impulse,
                                                                const RecoilPattern& pattern);

}  // namespace carom::ballistics
