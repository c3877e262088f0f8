#include "carom/ballistics/aim.h"

#include "carom/ballistics/detail/aim_solver.h"
#include "carom/core/string.h"

namespace carom::ballistics {

using math::Vec3d;

namespace detail {
namespace {

core::Result<void> check(const Projectile& projectile, const Shooter& shooter, const AimOptions& options) {
  const auto finite = [](Vec3d v) { return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z); };
  if (!(shooter.muzzle_speed > 0) || !math::is_finite(shooter.muzzle_speed))
    return core::Error{core::text("aim: ", core::refused("muzzle_speed", shooter.muzzle_speed, "a finite number > 0"))};
  if (!finite(shooter.muzzle)) return core::Error{"aim: the position of the muzzle is not finite"};
  if (!finite(shooter.velocity)) return core::Error{"aim: the velocity of the shooter is not finite"};
  if (!(projectile.area_per_mass >= 0) || !math::is_finite(projectile.area_per_mass))
    return core::Error{
        core::text("aim: ", core::refused("area_per_mass", projectile.area_per_mass, "a finite number >= 0"))};
  if (!(options.longest_time > 0) || !math::is_finite(options.longest_time))
    return core::Error{core::text("aim: ", core::refused("longest_time", options.longest_time, "a finite number > 0"))};
  if (!(options.tolerance > 0))
    return core::Error{core::text("aim: ", core::refused("tolerance", options.tolerance, "a number > 0"))};
  return {};
}

}  // namespace
}  // namespace detail

core::Result<Aims> aim(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                       core::FunctionRef<Vec3d(double)> target, const AimOptions& options) {
  const core::Result<void> checked = detail::check(projectile, shooter, options);
  if (!checked.ok()) return checked.error();
  const detail::AimSolver solver(projectile, conditions, shooter, target, options);
  Aims aims;
  if (!solver.two_arcs(aims)) solver.scan(aims);
  return aims;
}

core::Result<Aims> aim(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                       const Target& target, const AimOptions& options) {
  const core::Result<void> checked = detail::check(projectile, shooter, options);
  if (!checked.ok()) return checked.error();
  const Vec3d sum = target.position + target.velocity + target.acceleration;
  if (!math::is_finite(sum.x + sum.y + sum.z)) return core::Error{"aim: the target is not finite"};
  const auto place = [&](double t) {
    return target.position + t * (target.velocity + (0.5 * t) * target.acceleration);
  };
  const detail::AimSolver solver(projectile, conditions, shooter, place, options);
  Aims aims;
  if (!solver.two_arcs(target, aims)) solver.scan(aims);
  return aims;
}

core::Result<std::optional<Shot>> aim_again(const Projectile& projectile, const Conditions& conditions,
                                            const Shooter& shooter, const Target& target, const Shot& last,
                                            const AimOptions& options) {
  const core::Result<void> checked = detail::check(projectile, shooter, options);
  if (!checked.ok()) return checked.error();
  const Vec3d sum = target.position + target.velocity + target.acceleration + last.direction;
  if (!math::is_finite(sum.x + sum.y + sum.z))
    return core::Error{"aim_again: the target or the last shot is not finite"};
  if (!(last.time > 0) || !math::is_finite(last.time))
    return core::Error{core::text("aim_again: ", core::refused("last.time", last.time, "a finite number > 0"))};
  const auto place = [&](double t) {
    return target.position + t * (target.velocity + (0.5 * t) * target.acceleration);
  };
  const detail::AimSolver solver(projectile, conditions, shooter, place, options);
  const auto root = solver.refine({shooter.velocity + shooter.muzzle_speed * last.direction, last.time});
  if (!root.found || root.guess.time > options.longest_time) return std::optional<Shot>{};
  return std::optional<Shot>{{(root.guess.u - shooter.velocity) / shooter.muzzle_speed, root.guess.time,
                              root.arrival.position, root.arrival.velocity}};
}

}  // namespace carom::ballistics
