#include "carom/environment/environment.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::environment {
using math::Vec3d;

Vec3d gravity_at(const GravityField& field, Vec3d point) {
  switch (field.kind) {
    case GravityField::Kind::none:
      return {};
    case GravityField::Kind::uniform:
      return field.acceleration;
    case GravityField::Kind::spherical:
      return spherical_gravity(point - field.center, field.gm, field.minimum_radius);
    case GravityField::Kind::oblate:
      break;
  }
  const Vec3d r = point - field.center;
  const double distance = math::length(r);
  if (!(distance > field.minimum_radius)) return spherical_gravity(r, field.gm, field.minimum_radius);
  const double along = math::dot(r, field.axis), ratio = field.equatorial_radius / distance;
  const double k = 1.5 * field.j2 * ratio * ratio, s = 5 * along * along / (distance * distance);
  const double pull = -field.gm / (distance * distance * distance);
  return pull * ((1 + k * (1 - s)) * r + (2 * k * along) * field.axis);
}

double nodal_regression(const ZonalGravity& body, double a, double e, double inclination) {
  const double p = a * (1 - e * e), n = math::sqrt(body.gm / (a * a * a));
  return -1.5 * body.j2 * math::square(body.radius / p) * n * math::cos(inclination);
}

core::Result<Environment> Environment::make(Definition d) {
  const auto refuse = [](const char* field, double found, const char* expected) {
    return core::Error{core::text("Environment::make: ", field, " is ", found, ", expected ", expected)};
  };
  const GravityField& g = d.gravity;
  if (!math::is_finite(g.acceleration)) return refuse("gravity.acceleration", g.acceleration.y, "finite components");
  if (!math::is_finite(g.center)) return refuse("gravity.center", g.center.x, "finite components");
  if (!(math::abs(math::length(g.axis) - 1) < 1e-6))
    return refuse("gravity.axis", math::length(g.axis), "a length of 1");
  if (!math::is_finite(g.gm) || !(g.gm >= 0)) return refuse("gravity.gm", g.gm, "0 m³/s² or more");
  if (!math::is_finite(g.minimum_radius) || !(g.minimum_radius > 0))
    return refuse("gravity.minimum_radius", g.minimum_radius, "more than 0 m");
  if (!math::is_finite(g.equatorial_radius) || !(g.equatorial_radius > 0))
    return refuse("gravity.equatorial_radius", g.equatorial_radius, "more than 0 m");
  if (!math::is_finite(g.j2)) return refuse("gravity.j2", g.j2, "a finite number");
  if (!math::is_finite(d.frame.rate)) return refuse("frame.rate", d.frame.rate.x, "finite components");
  if (!math::is_finite(d.frame.origin)) return refuse("frame.origin", d.frame.origin.x, "finite components");
  if (!math::is_finite(d.air.temperature) || !(math::abs(d.air.temperature) <= 150))
    return refuse("air.temperature", d.air.temperature, "an offset of at most 150 K");
  if (!math::is_finite(d.air.sea_level_pressure) || !(d.air.sea_level_pressure > 0))
    return refuse("air.sea_level_pressure", d.air.sea_level_pressure, "more than 0 Pa");
  if (!(d.air.relative_humidity >= 0) || !(d.air.relative_humidity <= 1))
    return refuse("air.relative_humidity", d.air.relative_humidity, "0 … 1");
  if (!math::is_finite(d.altitude)) return refuse("altitude", d.altitude, "a finite height");
  if (!math::is_finite(d.ground)) return refuse("ground", d.ground, "a finite height");
  if (const core::Status wind = validate(d.wind); !wind.ok())
    return core::Error{core::text("Environment::make: ", wind.error().message)};
  Environment out;
  out.windy_ = !d.wind.calm();
  out.column_ = d.vacuum ? AirColumn::uniform(0) : AirColumn(d.air, d.altitude);
  out.definition_ = std::move(d);
  return out;
}

AirState Environment::air(Vec3d point) const {
  AirState state = standard_atmosphere(point.y + definition_.altitude, definition_.air);
  if (definition_.vacuum) state.pressure = state.density = 0;
  return state;
}

}  // namespace carom::environment
