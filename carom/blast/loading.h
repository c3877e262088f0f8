// What a blast does to a piece of surface: pressure over time, and its impulse in closed form.
#pragma once

#include "carom/blast/wave.h"

namespace carom::blast {

/// Pressure on a patch that the wave reaches at an angle. c: cosine between the patch's outward normal and the way to
/// the charge, 1 square on, 0 grazing, below 0 turned away.
///  c > 0: c² p_r(t) + (1 + c² − 2 c) p_s(t) (G. Randers-Pehrson & K. A. Bannister, Airblast loading model for DYNA2D
///  and
///         DYNA3D, ARL-TR-1310, 1997), which edges clear within t_c = 3 S/U down to p_s + c² q (U. S. Army TM 5-1300,
///         Structures to resist the effects of accidental explosions, 1990, 2-15.3);
///  c ≤ 0: p_s(t) − 0.4 c² q(t) (the same, suction of sides and rear).
/// p_s and p_r decay by Friedlander's law, q(t) = q (1 − t/t_d)² e^{−2 b t/t_d}.
class CAROM_API SurfaceLoad {
 public:
  /// `clearing_length` S (m): the shorter of the height and half the width of the face; 0: the face is a wall without
  /// end. `share` ≤ 1: of what an obstacle lets through; below 1 only p_s is felt.
  SurfaceLoad(const Wave& wave, double cosine, double clearing_length = 0, double share = 1);
  /// Pa, t s after the detonation.
  double pressure(double time) const;
  /// Pa·s from the arrival to t s after the detonation. Differences over steps add up to `impulse()` exactly.
  double impulse(double time) const;
  double impulse() const { return impulse(1e30); }
  double arrival() const { return arrival_; }  ///< s
  double end() const { return end_; }          ///< s, of the last positive phase
  double peak() const { return pressure(arrival_); }

 private:
  /// A (1 − t/T)^power (1 − t/t_c)^clears e^{−β t/T} for t < T and (where it clears) t < t_c.
  struct Term {
    double amplitude = 0, duration = 1, decay = 0;
    int power = 1;
    bool clears = false;
  };
  void add(double amplitude, double duration, double decay, int power, bool clears);
  Term terms_[6];
  int count_ = 0;
  double arrival_ = 0, end_ = 0, clearing_ = 0;
};

/// Pa·s of the wind's pressure q(t) from the arrival to t s after the detonation, in closed form.
CAROM_API double wind_impulse(const Wave& wave, double time);

/// What of an impulse `load` (N·s), as a thing at rest would get it, one takes that the air can carry along: its mass
/// in kg, its speed along the push and that of the wind behind the front in m/s; none becomes faster than the wind.
/// A sheet with air on both sides: its motion takes ρ c v off the pressure in front (G. I. Taylor, The pressure and
/// impulse of submarine explosion waves on plates, 1941), and the difference of its sides vanishes where it moves as
/// the air does: dv/dt = (load/m)(1 − v/u).
CAROM_API double sheet_impulse(double load, double mass, double speed, double wind);
/// Drag, by the square of the speed through the air: dv/dt = (load/m)(1 − v/u)².
CAROM_API double drag_impulse(double load, double mass, double speed, double wind);

/// The speed of the air behind a front: u = 5 P_s/(7 P₀) a₀/√(1 + 6 P_s/7 P₀).
inline double wind_speed(double side_on, double ambient = 101325, double speed_of_sound = 340.294) {
  return 5 * side_on / (7 * ambient) * speed_of_sound / math::sqrt(1 + 6 * side_on / (7 * ambient));
}

}  // namespace carom::blast
