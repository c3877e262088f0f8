#include "carom/forces/fields.h"

#include "carom/math/elementary.h"

namespace carom::forces {

double radial_strength(const Radial& field, double distance) {
  if (distance > field.range) return 0;
  const double x = math::max(distance, field.core) / field.reference;
  if (field.exponent == -2) return field.strength / (x * x);
  if (field.exponent == 1) return field.strength * x;
  if (field.exponent == 0) return field.strength;
  return field.strength * math::pow(x, field.exponent);
}

}  // namespace carom::forces
