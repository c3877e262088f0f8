#include "carom/ballistics/body_flight.h"

#include "carom/ballistics/detail/flight_air.h"
#include "carom/core/string.h"
#include "carom/environment/environment.h"

namespace carom::ballistics {

using math::Vec3d;
namespace {
template <class V>
Vec3d in_space(const V& v) {
  if constexpr (requires { v.z; })
    return Vec3d(v);
  else
    return {v.x, v.y, 0};
}
}  // namespace

template <class D>
core::Result<rigid::CustomEffector<D>> flight_effector(rigid::BodyId body, const BodyFlight& flight) {
  if (body == rigid::BodyId{}) return core::Error{"flight_effector: found the null body, expected one of a world"};
  if (!(flight.dt > 0) || !math::is_finite(flight.dt))
    return core::Error{
        core::text("flight_effector: ", core::refused("dt", flight.dt, "a finite number of seconds > 0"))};
  if (!(flight.projectile.area_per_mass >= 0) || !math::is_finite(flight.projectile.area_per_mass))
    return core::Error{core::text(
        "flight_effector: ", core::refused("area_per_mass", flight.projectile.area_per_mass, "a finite number >= 0"))};
  rigid::CustomEffector<D> effector;
  effector.body = body;
  effector.model = [flight](const rigid::EffectorInput<D>& input) {
    const Vec3d x = in_space(input.state.center_of_mass), v = in_space(input.state.linear_velocity);
    const environment::Environment* const around = input.around;
    const Vec3d beside = flight.own_wind ? Vec3d{} : in_space(input.wind);
    const bool alone = (around == nullptr || (flight.own_air && flight.own_wind)) && beside == Vec3d{};
    // In the middle or at the end of the step, `after` s from its beginning.
    const auto a = [&](Vec3d position, Vec3d velocity, double after) {
      const double time = input.time + after;
      const Conditions& own = flight.conditions;
      if (alone) return detail::flight_acceleration(flight.projectile, own, position, velocity, time);
      Vec3d wind = beside + (around != nullptr && !flight.own_wind ? around->wind(position, time)
                                                                   : detail::wind_of(own, position, time));
      if constexpr (D::dimension == 2) wind.z = 0;
      const environment::AirColumn::Air air =
          around != nullptr && !flight.own_air ? around->thin_air(position) : own.air.at(position.y);
      return detail::drag_acceleration(flight.projectile, air, velocity - wind) +
             detail::beside_drag(own, position, velocity);
    };
    const double h = flight.dt;
    const Vec3d a1 = a(x, v, 0);
    const Vec3d v2 = v + (0.5 * h) * a1, a2 = a(x + (0.5 * h) * v, v2, 0.5 * h);
    const Vec3d v3 = v + (0.5 * h) * a2, a3 = a(x + (0.5 * h) * v2, v3, 0.5 * h);
    const Vec3d a4 = a(x + h * v3, v + h * a3, h);
    Vec3d mean = (1.0 / 6) * (a1 + 2.0 * (a2 + a3) + a4);
    mean.y += flight.conditions.gravity;
    const Vec3d force = double(input.state.mass) * mean;
    rigid::Wrench<D> wrench;
    if constexpr (D::dimension == 3)
      wrench.force = math::Vec3f(force);
    else
      wrench.force = math::Vec2f(float(force.x), float(force.y));
    return wrench;
  };
  return effector;
}

template core::Result<rigid::CustomEffector<rigid::Dim2>> flight_effector(rigid::BodyId, const BodyFlight&);
template core::Result<rigid::CustomEffector<rigid::Dim3>> flight_effector(rigid::BodyId, const BodyFlight&);

}  // namespace carom::ballistics
