// The blast wave of an explosion in air (chapter 18.6): pressure over time at a distance, and what it does to things.
#pragma once

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::blast {

/// The wave at a place. Pressures are above the ambient one.
struct Wave {
  double arrival = 0;             ///< s after the detonation
  double pressure = 0;            ///< Pa, side-on peak P_s
  double reflected_pressure = 0;  ///< Pa, peak P_r on a wall square to the wave
  double duration = 0;            ///< s, t_d of the positive phase
  double impulse = 0;             ///< Pa·s, side-on i_s
  double reflected_impulse = 0;   ///< Pa·s, i_r
  double front_speed = 0;         ///< m/s
  double decay = 0;               ///< b of Friedlander's law, from P_s, t_d and i_s
  double reflected_decay = 0;     ///< the same from P_r, t_d and i_r
};

enum class Burst {
  ground,  ///< a hemisphere on the ground: Kingery and Bulmash as fitted by Swisdak
  /// A sphere far from any surface: the peak by Kinney and Graham, arrival and duration of the ground's wave of a
  /// charge smaller by 1.8, the reflection factor, and its other pressures and impulses in proportion to the peak.
  free_air,
  /// A sphere over ground that reflects it (reflection.h). By itself its wave is that of free air.
  air,
};

/// The least and the most scaled distance Z = R/W^{1/3} (m/kg^{1/3}) of the fits. Nearer and farther ones are refused.
inline constexpr double least_scaled_distance = 0.2, greatest_scaled_distance = 40;

/// The wave of `charge` kg of TNT at `distance` m. Errors: a charge or distance ≤ 0, a scaled distance outside
/// 0.2 … 40 m/kg^{1/3}. M. M. Swisdak Jr., Simplified Kingery Airblast Calculations, 1994 (ADA526744).
CAROM_API core::Result<Wave> blast_wave(double charge, double distance, Burst burst = Burst::ground);

/// The quantities that Swisdak fits one by one, each over its own range.
enum class WaveQuantity {
  pressure,            ///< Pa, P_s: 0.2 … 198.5 m/kg^{1/3}
  reflected_pressure,  ///< Pa, P_r: 0.06 … 40
  arrival,             ///< s, t_a: 0.06 … 40
  duration,            ///< s, t_d: 0.2 … 40
  impulse,             ///< Pa·s, i_s: 0.2 … 158.7
  reflected_impulse,   ///< Pa·s, i_r: 0.06 … 40
  front_speed,         ///< m/s, U: 0.06 … 40
};
CAROM_API const char* to_string(WaveQuantity quantity);
struct ScaledRange {
  double least = 0, greatest = 0;  ///< m/kg^{1/3}
};
CAROM_API ScaledRange fitted_range(WaveQuantity quantity);
/// One quantity of a hemisphere's wave on the ground, where `blast_wave`, which needs them all, has no answer: what
/// hits a wall beside the charge, and what breaks windows far away. Errors: a charge or distance ≤ 0, a scaled distance
/// outside the quantity's range.
CAROM_API core::Result<double> wave_quantity(WaveQuantity quantity, double charge, double distance);

/// Peak side-on pressure (Pa) of a free-air burst by another fit: G. F. Kinney & K. J. Graham, Explosive Shocks in Air,
/// 1985. Another geometry than `Burst::ground`; `ambient` in Pa.
CAROM_API double kinney_graham_pressure(double charge, double distance, double ambient = 101325);

/// The wave with so many times its pressures and impulses, and as fast as that makes it.
CAROM_API Wave strengthened(const Wave& wave, double by);

/// p(t) = P (1 − t/t_d) e^{−b t/t_d}, Pa, t s after the arrival; zero before and after the positive phase.
CAROM_API double friedlander(double peak, double duration, double decay, double time);
/// b with i = P t_d (1/b − (1 − e^{−b})/b²); for impulses above ½ P t_d, which no such wave has, 0; at most 200.
CAROM_API double friedlander_decay(double peak, double duration, double impulse);

/// P_r = 2 P_s (7 P₀ + 4 P_s)/(7 P₀ + P_s) of an ideal gas: a quarter too low at Z = .2; not used below Z ≈ 1.
constexpr double ideal_reflected_pressure(double side_on, double ambient = 101325) {
  return 2 * side_on * (7 * ambient + 4 * side_on) / (7 * ambient + side_on);
}
/// Rankine and Hugoniot: U = a₀ √(1 + 6 P_s/7 P₀).
inline double shock_speed(double side_on, double ambient = 101325, double speed_of_sound = 340.294) {
  return speed_of_sound * math::sqrt(1 + 6 * side_on / (7 * ambient));
}
/// Pressure of the wind behind the front: q = 2.5 P_s²/(7 P₀ + P_s).
constexpr double dynamic_pressure(double side_on, double ambient = 101325) {
  return 2.5 * side_on * side_on / (7 * ambient + side_on);
}

/// What a peak side-on pressure does, by thresholds (Pa) of common use; no promise of safety.
enum class Damage {
  none,
  windows_break,     ///< from 1 kPa
  light_structures,  ///< from 14 kPa: roofs, cladding
  eardrums,          ///< from 34 kPa: one in a hundred
  walls_collapse,    ///< from 70 kPa: brick
  lethal,            ///< from 240 kPa: lungs
};
CAROM_API Damage damage_of(double side_on_pressure);
CAROM_API const char* to_string(Damage damage);

/// Energy of 1 kg of TNT (J), by definition.
inline constexpr double tnt_energy = 4.184e6;

}  // namespace carom::blast
