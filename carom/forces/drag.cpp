#include "carom/forces/drag.h"

#include "carom/math/elementary.h"

namespace carom::forces {

double sphere_drag_schiller_naumann(double reynolds) {
  return 24.0 / reynolds * (1 + 0.15 * math::pow(reynolds, 0.687));
}

double sphere_drag_morrison(double reynolds) {
  const double a = reynolds / 5.0, b = reynolds / 2.63e5, c = reynolds / 1e6;
  // For small Re the powers −7.94 and −8 overflow together; their quotient tends to b^.06.
  const double crisis = b < 1e-3 ? math::pow(b, 0.06) : math::pow(b, -7.94) / (1 + math::pow(b, -8.0));
  return 24.0 / reynolds + 2.6 * a / (1 + math::pow(a, 1.52)) + 0.411 * crisis + 0.25 * c / (1 + c);
}

double terminal_speed(double mass, double gravity, double density, double drag_coefficient, double area) {
  return math::sqrt(2 * mass * gravity / (density * drag_coefficient * area));
}

Run quadratic_fall(double terminal_speed, double gravity, double time) {
  const double x = gravity * time / terminal_speed;
  // ln cosh x = |x| + ln((1 + e^{−2|x|})/2), without overflow.
  const double y = math::abs(x);
  const double log_cosh = y < 1e-4 ? 0.5 * y * y : y + math::log1p(math::exp(-2 * y)) - 0.69314718055994530942;
  return {terminal_speed * math::tanh(x), terminal_speed * terminal_speed / gravity * log_cosh};
}

Run quadratic_coast(double initial_speed, double k, double time) {
  const double x = initial_speed * k * time;
  return {initial_speed / (1 + x), k == 0 ? initial_speed * time : math::log1p(x) / k};
}

Run thrust_against_linear_drag(double mass, double thrust, double coefficient, double initial_speed, double time) {
  const double final_speed = thrust / coefficient, missing = final_speed - initial_speed;
  const double gone = math::expm1(-coefficient * time / mass);
  return {initial_speed - missing * gone, final_speed * time + mass / coefficient * missing * gone};
}

}  // namespace carom::forces
