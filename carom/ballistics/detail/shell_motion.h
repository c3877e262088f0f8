// The equations of a spinning shell.
#pragma once

#include "carom/ballistics/detail/flight_air.h"
#include "carom/ballistics/shell.h"
#include "carom/ode/state.h"

namespace carom::ballistics::detail {

using math::Vec3d;

/// Modified point mass: position, velocity, spin.
struct SpinningPoint {
  Vec3d position{}, velocity{};
  double spin = 0;
  friend SpinningPoint operator+(const SpinningPoint& a, const SpinningPoint& b) {
    return {a.position + b.position, a.velocity + b.velocity, a.spin + b.spin};
  }
  friend SpinningPoint operator*(double s, const SpinningPoint& a) {
    return {s * a.position, s * a.velocity, s * a.spin};
  }
};

/// A symmetric body: axis e and angular momentum h = I_x p e + I_t (e × ė), so that the spin itself needs no short
/// steps, only the nutation (McCoy, Modern Exterior Ballistics, ch. 9).
struct SymmetricBody {
  Vec3d position{}, velocity{}, axis{}, momentum{};
  friend SymmetricBody operator+(const SymmetricBody& a, const SymmetricBody& b) {
    return {a.position + b.position, a.velocity + b.velocity, a.axis + b.axis, a.momentum + b.momentum};
  }
  friend SymmetricBody operator*(double s, const SymmetricBody& a) {
    return {s * a.position, s * a.velocity, s * a.axis, s * a.momentum};
  }
};

inline double frontal_area(const Shell& shell) { return math::pi / 4 * shell.diameter * shell.diameter; }

struct PointMassMotion {
  SpinningPoint derivative;
  Vec3d yaw;
};

inline PointMassMotion modified_point_mass(const Shell& shell, const Conditions& conditions, double time,
                                           const SpinningPoint& s) {
  const environment::AirColumn::Air air = conditions.air.at(s.position.y);
  const Vec3d v = s.velocity - wind_of(conditions, s.position, time),
              g = beside_drag(conditions, s.position, s.velocity);
  const double speed = math::length(v), area = frontal_area(shell), d = shell.diameter;
  if (!(speed > 1e-9) || !(air.density > 0)) return {{s.velocity, g, 0}, {}};
  const ShellCoefficients c = coefficients_at(shell, speed / air.speed_of_sound);
  const double k = 0.5 * air.density * area / shell.mass, rate = s.spin * d / (2 * speed);
  // The yaw of repose depends on the acceleration that it changes: three passes from drag and gravity alone.
  Vec3d yaw{}, a = g - (k * c.axial * speed) * v;
  for (int pass = 0; pass < 3; ++pass) {
    yaw = yaw_of_repose(shell, s.spin, air.density, v, a, c.overturning);
    const double drag = c.axial + (c.axial_yaw + c.normal) * math::length_squared(yaw);
    a = g + k * ((-drag * speed) * v + ((c.normal - c.axial) * speed * speed) * yaw +
                 (rate * c.magnus_force * speed) * math::cross(yaw, v));
  }
  const double spin = 0.5 * air.density * speed * speed * area * d * rate * c.roll_damping / shell.axial_inertia;
  return {{s.velocity, a, spin}, yaw};
}

inline SymmetricBody six_degrees(const Shell& shell, const Conditions& conditions, double time,
                                 const SymmetricBody& s) {
  const environment::AirColumn::Air air = conditions.air.at(s.position.y);
  const Vec3d w = s.velocity - wind_of(conditions, s.position, time),
              g = beside_drag(conditions, s.position, s.velocity);
  const Vec3d e = s.axis / math::length(s.axis);
  const double p = math::dot(s.momentum, e) / shell.axial_inertia;
  const Vec3d turn = math::cross(s.momentum, e) / shell.transverse_inertia;  // ė
  const double speed = math::length(w), area = frontal_area(shell), d = shell.diameter;
  if (!(speed > 1e-9) || !(air.density > 0)) return {s.velocity, g, turn, {}};
  const ShellCoefficients c = coefficients_at(shell, speed / air.speed_of_sound);
  const Vec3d u = w / speed, side = u - math::dot(u, e) * e;  // the wind's part across the axis
  const double q = 0.5 * air.density * speed * speed * area, rate = p * d / (2 * speed);
  const Vec3d force = q * (-(c.axial + c.axial_yaw * math::length_squared(side)) * e - c.normal * side +
                           (rate * c.magnus_force) * math::cross(e, u));
  const Vec3d spin_across = math::cross(e, turn);  // ω without its part along the axis
  const Vec3d moment =
      (q * d) * (c.overturning * math::cross(u, e) + (d / (2 * speed) * c.pitch_damping) * spin_across +
                 (rate * c.magnus_moment) * side + (rate * c.roll_damping) * e);
  return {s.velocity, g + force / shell.mass, turn, moment};
}

}  // namespace carom::ballistics::detail

template <>
inline constexpr int carom::ode::components<carom::ballistics::detail::SpinningPoint> = 7;
template <>
inline constexpr int carom::ode::components<carom::ballistics::detail::SymmetricBody> = 12;
