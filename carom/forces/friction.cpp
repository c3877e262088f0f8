#include "carom/forces/friction.h"

#include "carom/math/elementary.h"

namespace carom::forces {

bool stays_on_incline(double angle, double static_coefficient) { return math::tan(angle) <= static_coefficient; }
double incline_acceleration(double angle, double kinetic_coefficient, double gravity) {
  const math::SinCos<double> slope = math::sincos(angle);
  return gravity * (slope.sin - kinetic_coefficient * slope.cos);
}
double rolling_acceleration(double angle, double shape_factor, double gravity) {
  return gravity * math::sin(angle) / (1 + shape_factor);
}
double rolling_friction_needed(double angle, double shape_factor) {
  return math::tan(angle) * shape_factor / (1 + shape_factor);
}

}  // namespace carom::forces
