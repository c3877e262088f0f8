// How a gun sways in the hands: breath, heartbeat, tremor and the body's drift as a spectrum (chapter 18.4).
#pragma once

#include <cstdint>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::ballistics {

enum class Stance { offhand, kneeling, sitting, prone, supported };

/// Amplitudes are root mean squares (rad) of each axis. They are designer's numbers of the order that marksmen show
/// (offhand 1 to 3 mrad, prone with a rest .1 to .3 mrad), not measured ones.
struct Sway {
  double breath = 0.6e-3, breath_frequency = 0.25;            ///< rad, Hz; mostly up and down
  double heartbeat = 0.2e-3, heartbeat_frequency = 1.2;       ///< rad, Hz
  double tremor = 0.15e-3, tremor_low = 8, tremor_high = 12;  ///< rad, a band in Hz
  double drift = 0.8e-3, drift_low = 0.05, drift_high = 0.6;  ///< rad, of the body, a band in Hz
};
/// Errors name what is not finite or out of range: 0 to 1 rad, 10^-3 to 1000 Hz, bands that rise.
CAROM_API core::Status check(const Sway& sway);
/// A steadier or tired shooter: `skill` 0 (beginner) … 1 (expert), `fatigue` 0 … 1.
CAROM_API Sway sway_of(Stance stance, double skill = 0.5, double fatigue = 0);

/// Sway as a function of time: sums of sines whose frequencies and phases a seed draws, so that any moment can be asked
/// at any time, and a replay shows the same.
class CAROM_API SwayMotion {
 public:
  SwayMotion(const Sway& sway, std::uint64_t seed);
  /// Aim offset (rad: x to the right, y up) at time t (s). `breath_held` 0 … 1 fades the breath out; tremor grows as it
  /// is held: by half.
  math::Vec2d at(double time, double breath_held = 0) const;

 private:
  enum class Part { breath, heartbeat, tremor, drift };
  struct Wave {
    Part part;
    double omega, phase_x, phase_y, amplitude_x, amplitude_y;
  };
  std::vector<Wave> waves_;
};

}  // namespace carom::ballistics
