// Rocket motors: thrust over time, and the files that model rocketry keeps it in (chapter 6.4).
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::ballistics {

struct ThrustPoint {
  double time = 0;    ///< s
  double thrust = 0;  ///< N
};

/// Thrust over time, linear between points, zero before the first and after the last.
class CAROM_API ThrustCurve {
 public:
  ThrustCurve() = default;
  /// Points by rising time from 0 up, thrust ≥ 0. The error names the point.
  static core::Result<ThrustCurve> from_points(std::vector<ThrustPoint> points);
  static ThrustCurve constant(double thrust, double duration);

  double thrust(double time) const;
  double impulse(double time) const;  ///< N·s delivered until then
  double total_impulse() const { return impulses_.empty() ? 0 : impulses_.back(); }
  double burn_time() const { return points_.empty() ? 0 : points_.back().time; }
  const std::vector<ThrustPoint>& points() const { return points_; }

 private:
  std::size_t interval(double time) const;
  std::vector<ThrustPoint> points_;
  std::vector<double> impulses_;  // at the points
};

struct Motor {
  std::string name, manufacturer;
  double diameter = 0, length = 0;       ///< m
  std::vector<double> delays;            ///< s, from burnout to the ejection charge
  bool plugged = false;                  ///< no ejection charge
  double propellant_mass = 0, mass = 0;  ///< kg; `mass` with the propellant and the casing
  ThrustCurve curve;

  /// kg at `time` s after ignition: propellant leaves in proportion to the impulse, as for a constant exhaust speed.
  double mass_at(double time) const {
    const double total = curve.total_impulse();
    return mass - (total > 0 ? propellant_mass * curve.impulse(time) / total : 0);
  }
  /// Exhaust speed (m/s): impulse by propellant mass.
  double exhaust_speed() const { return propellant_mass > 0 ? curve.total_impulse() / propellant_mass : 0; }
};

/// The letter of the total impulse I (N·s): A up to 2.5, doubling for each; "1/2A" and "1/4A" below.
CAROM_API std::string impulse_class(double total_impulse);

/// A RASP thrust file (.eng): comments after ';', a header "name diameter(mm) length(mm) delays propellant(kg) mass(kg)
/// manufacturer", then lines "time thrust" that end with thrust zero. Every motor of the file. Errors name `name`, the
/// line, what was found and what was expected.
CAROM_API core::Result<std::vector<Motor>> read_rasp(std::string_view text, std::string_view name);

}  // namespace carom::ballistics
