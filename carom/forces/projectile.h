// Flights with closed forms, aiming, and hits that no time step can miss (chapters 2.4–2.6, 4.3, 4.4, 6.1). y is up.
#pragma once

#include <optional>

#include "carom/core/function_ref.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::forces {

/// Position and velocity.
struct FlightPoint {
  math::Vec3d position{};  ///< m
  math::Vec3d velocity{};  ///< m/s
};

/// Constant acceleration: the parabola.
constexpr FlightPoint parabola(const FlightPoint& start, math::Vec3d acceleration, double time) {
  return {start.position + time * start.velocity + (0.5 * time * time) * acceleration,
          start.velocity + time * acceleration};
}

/// Drag −c (v − wind), for a particle of mass m: v = v_T + (v₀ − v_T)e^{−ct/m} with v_T = wind + (m/c) g.
/// A wind force C_w v_w of its own, as in the classic cannon, is the wind (C_w/C_d) v_w here.
struct LinearDragFlight {
  double mass = 1;                      ///< kg
  double coefficient = 0;               ///< N·s/m, ≥ 0; 0: a parabola
  math::Vec3d wind{};                   ///< m/s
  math::Vec3d gravity{0, -9.80665, 0};  ///< m/s²
};
CAROM_API FlightPoint linear_drag_flight(const LinearDragFlight& flight, const FlightPoint& start, double time);
/// Time (s) until the velocity along gravity vanishes; 0 where it already points down.
CAROM_API double apex_time(const LinearDragFlight& flight, const FlightPoint& start);
/// Time (s) of the descent through the height `ground` (y, gravity along −y); empty where it is never reached.
CAROM_API std::optional<double> landing_time(const LinearDragFlight& flight, const FlightPoint& start, double ground);

/// Direction of a barrel: angle from the vertical and azimuth about y, from x toward z (rad).
CAROM_API math::Vec3d barrel_direction(double from_vertical, double azimuth);
/// The shell at the muzzle of a barrel of `length` m whose base stands at `base`.
CAROM_API FlightPoint muzzle(math::Vec3d base, double length, double from_vertical, double azimuth, double speed);

/// Shot in a vertical plane in vacuum from height h₀ ≥ 0 over level ground (6.1).
struct VacuumShot {
  double time = 0;   ///< s to the ground
  double range = 0;  ///< m
  double apex = 0;   ///< m above the ground
  double speed = 0;  ///< m/s at the impact
};
/// `elevation` in rad above the horizon.
CAROM_API VacuumShot vacuum_shot(double speed, double elevation, double height, double gravity);
/// d = ½ g (x/v)²: drop of a flat shot.
constexpr double flat_shot_drop(double distance, double speed, double gravity) {
  return 0.5 * gravity * (distance / speed) * (distance / speed);
}

/// How to hit a target at horizontal distance x > 0 and height y with a given speed in vacuum:
/// tan θ = (v² ± √(v⁴ − g(g x² + 2 y v²)))/(g x). Empty where the target is out of reach.
struct Aim {
  double low = 0, high = 0;            ///< rad above the horizon
  double low_time = 0, high_time = 0;  ///< s
};
CAROM_API std::optional<Aim> aim(double speed, double distance, double height, double gravity);
/// The same in space, from the shooter to the target (m): velocities (m/s) of the low and the high shot. A target
/// straight above or below is hit by vertical shots.
struct AimVelocities {
  math::Vec3d low{}, high{};
  double low_time = 0, high_time = 0;
};
CAROM_API std::optional<AimVelocities> aim(double speed, math::Vec3d target, double gravity);
/// The least speed that reaches it: √(g(y + √(x² + y²))).
CAROM_API double least_speed(double distance, double height, double gravity);

struct TargetBox {
  math::Vec3d lower{}, upper{};  ///< m
};
/// The first time in [0, duration] at which the parabola is in the box: exact, whatever the step.
CAROM_API std::optional<double> first_hit(const FlightPoint& start, math::Vec3d acceleration, double duration,
                                          const TargetBox& box);
/// The same for any path whose speed never exceeds `max_speed` (m/s), by steps that cannot jump over the box; to
/// `tolerance` m: paths that only graze the box by less may count as hits.
CAROM_API std::optional<double> first_hit(core::FunctionRef<math::Vec3d(double)> path, double max_speed,
                                          double duration, const TargetBox& box, double tolerance = 1e-6);

enum class ShotOutcome { in_flight, hit, ground, timed_out };
/// What happens in the next dt seconds of a shot in vacuum.
struct ShotStep {
  ShotOutcome outcome = ShotOutcome::in_flight;
  double time = 0;      ///< s from the start of this step until it happens, or dt
  FlightPoint point{};  ///< there
};
/// `elapsed` is the time since the shot (s), `time_limit` when it is given up, `ground` the height (m) of the ground.
CAROM_API ShotStep advance_shot(const FlightPoint& start, math::Vec3d acceleration, double dt, const TargetBox& target,
                                double ground, double elapsed, double time_limit);

/// A kinematic burst: the particle that left `origin` with `velocity` at time 0 (chapter 2.7).
struct BurstParticle {
  math::Vec3d position{};
  math::Vec3d velocity{};
  double fade = 1;  ///< 1 … 0 over its life; 0: gone
};
/// `drift` is the velocity of the bursting body, added to each particle's own.
CAROM_API BurstParticle burst_particle(math::Vec3d origin, math::Vec3d drift, math::Vec3d velocity,
                                       math::Vec3d acceleration, double life, double time);
/// A direction from two numbers uniform in [0, 1): uniform on the sphere (Archimedes' hat box).
CAROM_API math::Vec3d direction_on_sphere(double u, double v);

}  // namespace carom::forces
