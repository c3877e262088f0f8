#include "carom/ballistics/body_flight.h"

#include "carom/ballistics/detail/point_mass.h"
#include "carom/core/string.h"

namespace carom::ballistics {

using math::Vec3d;

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
    Vec3d x{input.state.center_of_mass.x, input.state.center_of_mass.y, 0};
    Vec3d v{input.state.linear_velocity.x, input.state.linear_velocity.y, 0};
    if constexpr (D::dimension == 3) {
      x.z = input.state.center_of_mass.z;
      v.z = input.state.linear_velocity.z;
    }
    const auto a = [&](Vec3d position, Vec3d velocity) {
      return detail::point_mass_acceleration(flight.projectile, flight.conditions, position, velocity);
    };
    const double h = flight.dt;
    const Vec3d a1 = a(x, v);
    const Vec3d v2 = v + (0.5 * h) * a1, a2 = a(x + (0.5 * h) * v, v2);
    const Vec3d v3 = v + (0.5 * h) * a2, a3 = a(x + (0.5 * h) * v2, v3);
    const Vec3d a4 = a(x + h * v3, v + h * a3);
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
