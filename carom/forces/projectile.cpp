#include "carom/forces/projectile.h"

#include "carom/math/elementary.h"

namespace carom::forces {
using math::Vec3d;

namespace detail {

/// (1 − e^{−x})/x and (1 − that)/x, without cancellation.
struct Decay {
  double first, second;
};
Decay decay(double x) {
  if (math::abs(x) < 1e-3)
    return {1 - x / 2 + x * x / 6 - x * x * x / 24, 0.5 - x / 6 + x * x / 24 - x * x * x / 120 + x * x * x * x / 720};
  const double first = -math::expm1(-x) / x;
  return {first, (1 - first) / x};
}

}  // namespace detail

FlightPoint linear_drag_flight(const LinearDragFlight& flight, const FlightPoint& start, double time) {
  // With k = c/m and x = k t: v − w = (v₀ − w)e^{−x} + g t φ₁(x), position by one more integral; no 1/k anywhere.
  const double x = flight.coefficient / flight.mass * time;
  const detail::Decay phi = detail::decay(x);
  const Vec3d relative = start.velocity - flight.wind;
  return {
      start.position + time * flight.wind + (time * phi.first) * relative + (time * time * phi.second) * flight.gravity,
      flight.wind + math::exp(-x) * relative + (time * phi.first) * flight.gravity};
}

double apex_time(const LinearDragFlight& flight, const FlightPoint& start) {
  const double g = math::length(flight.gravity);
  if (!(g > 0)) return 0;
  const Vec3d up = flight.gravity / -g;
  const double rise = math::dot(start.velocity, up), k = flight.coefficient / flight.mass;
  const double wind = math::dot(flight.wind, up);
  if (!(rise > 0)) return 0;
  // 0 = w + (u − w)e^{−kt} − g(1 − e^{−kt})/k
  const double x = k * rise / (g - k * wind);
  return x < 1e-8 && x > -1e-8 ? rise / (g - k * wind) * (1 - x / 2) : math::log1p(x) / k;
}

std::optional<double> landing_time(const LinearDragFlight& flight, const FlightPoint& start, double ground) {
  const auto height = [&](double t) { return linear_drag_flight(flight, start, t).position.y - ground; };
  double low = apex_time(flight, start);
  if (!math::is_finite(low) || height(low) < 0) return std::nullopt;
  double step = math::max(low, 1e-3), high = low + step;
  for (int i = 0; height(high) > 0; ++i) {
    if (i > 200 || !math::is_finite(high)) return std::nullopt;
    low = high;
    step *= 2;
    high += step;
  }
  // Newton from the far side converges monotonically on a path that is concave; bisection guards it.
  double t = high;
  for (int i = 0; i < 200; ++i) {
    const FlightPoint at = linear_drag_flight(flight, start, t);
    const double h = at.position.y - ground;
    if (h > 0)
      low = t;
    else
      high = t;
    double next = at.velocity.y != 0 ? t - h / at.velocity.y : 0.5 * (low + high);
    if (!(next >= low && next <= high)) next = 0.5 * (low + high);
    if (next == t || high - low <= 1e-16 * high) break;
    t = next;
  }
  return t;
}

Vec3d barrel_direction(double from_vertical, double azimuth) {
  const math::SinCos<double> alpha = math::sincos(from_vertical), gamma = math::sincos(azimuth);
  return {alpha.sin * gamma.cos, alpha.cos, alpha.sin * gamma.sin};
}
FlightPoint muzzle(Vec3d base, double length, double from_vertical, double azimuth, double speed) {
  const Vec3d direction = barrel_direction(from_vertical, azimuth);
  return {base + length * direction, speed * direction};
}

VacuumShot vacuum_shot(double speed, double elevation, double height, double gravity) {
  const math::SinCos<double> angle = math::sincos(elevation);
  const double rise = speed * angle.sin, across = speed * angle.cos;
  const double fall = math::sqrt(math::max(0.0, rise * rise + 2 * gravity * height));
  VacuumShot shot;
  shot.time = (rise + fall) / gravity;
  shot.range = across * shot.time;
  shot.apex = height + (rise > 0 ? rise * rise / (2 * gravity) : 0);
  shot.speed = math::sqrt(across * across + fall * fall);
  return shot;
}

std::optional<Aim> aim(double speed, double distance, double height, double gravity) {
  if (!(speed > 0) || !(distance > 0) || !(gravity > 0)) return std::nullopt;
  const double v2 = speed * speed;
  const double discriminant = v2 * v2 - gravity * (gravity * distance * distance + 2 * height * v2);
  if (!(discriminant >= 0)) return std::nullopt;
  const double root = math::sqrt(discriminant);
  // The low tangent by the product of the two, which does not cancel for fast shots.
  const double high = (v2 + root) / (gravity * distance);
  const double low = (gravity * distance * distance + 2 * height * v2) / (distance * (v2 + root));
  Aim result;
  result.low = math::atan(low);
  result.high = math::atan(high);
  result.low_time = distance / (speed * math::cos(result.low));
  result.high_time = distance / (speed * math::cos(result.high));
  return result;
}

std::optional<AimVelocities> aim(double speed, Vec3d target, double gravity) {
  const double distance = math::hypot(target.x, target.z);
  if (!(speed > 0) || !(gravity > 0) || !math::is_finite(distance)) return std::nullopt;
  if (distance < 1e-9 * (1 + math::abs(target.y))) {
    const double square = speed * speed - 2 * gravity * target.y;
    if (square < 0) return std::nullopt;
    // Straight at it, and past it and back (above), or up first and down (below).
    const double root = math::sqrt(square);
    if (target.y >= 0)
      return AimVelocities{{0, speed, 0}, {0, speed, 0}, (speed - root) / gravity, (speed + root) / gravity};
    return AimVelocities{{0, -speed, 0}, {0, speed, 0}, (root - speed) / gravity, (root + speed) / gravity};
  }
  const std::optional<Aim> plane = aim(speed, distance, target.y, gravity);
  if (!plane) return std::nullopt;
  const auto velocity = [&](double elevation) {
    const math::SinCos<double> angle = math::sincos(elevation);
    const double along = speed * angle.cos / distance;
    return Vec3d{along * target.x, speed * angle.sin, along * target.z};
  };
  return AimVelocities{velocity(plane->low), velocity(plane->high), plane->low_time, plane->high_time};
}

double least_speed(double distance, double height, double gravity) {
  return math::sqrt(gravity * (height + math::hypot(distance, height)));
}

namespace detail {

/// Times at which s + u t + ½ a t² = 0, ascending; 0, 1 or 2 of them.
int parabola_roots(double s, double u, double a, double* roots) {
  if (a == 0) {
    if (u == 0) return 0;
    roots[0] = -s / u;
    return 1;
  }
  const double discriminant = u * u - 2 * a * s;
  if (discriminant < 0) return 0;
  const double q = -(u + math::copysign(math::sqrt(discriminant), u));
  const double first = q / a, second = q != 0 ? 2 * s / q : first;
  roots[0] = math::min(first, second);
  roots[1] = math::max(first, second);
  return 2;
}

double distance_to(const TargetBox& box, Vec3d p) {
  const Vec3d nearest = math::max(box.lower, math::min(p, box.upper));
  return math::distance(p, nearest);
}

}  // namespace detail

std::optional<double> first_hit(const FlightPoint& start, Vec3d acceleration, double duration, const TargetBox& box) {
  // The path enters the box through one of six faces, or starts inside: the earliest crossing at which the other two
  // coordinates lie between their faces.
  const auto inside = [&](double t, int face_axis) {
    const Vec3d p = parabola(start, acceleration, t).position;
    for (int axis = 0; axis < 3; ++axis)
      if (axis != face_axis && !(p[axis] >= box.lower[axis] && p[axis] <= box.upper[axis])) return false;
    return true;
  };
  if (inside(0, -1)) return 0.0;
  std::optional<double> best;
  for (int axis = 0; axis < 3; ++axis)
    for (const double face : {box.lower[axis], box.upper[axis]}) {
      double roots[2];
      const int count =
          detail::parabola_roots(start.position[axis] - face, start.velocity[axis], acceleration[axis], roots);
      for (int i = 0; i < count; ++i)
        if (roots[i] >= 0 && roots[i] <= duration && (!best || roots[i] < *best) && inside(roots[i], axis))
          best = roots[i];
    }
  return best;
}

std::optional<double> first_hit(core::FunctionRef<Vec3d(double)> path, double max_speed, double duration,
                                const TargetBox& box, double tolerance) {
  double t = 0;
  for (;;) {
    const double gap = detail::distance_to(box, path(t));
    if (gap <= tolerance) return t;
    if (!(max_speed > 0) || t >= duration) return std::nullopt;
    // Nothing that moves at most at max_speed can be in the box sooner.
    t = math::min(duration, t + math::max(gap, tolerance) / max_speed);
  }
}

ShotStep advance_shot(const FlightPoint& start, Vec3d acceleration, double dt, const TargetBox& target, double ground,
                      double elapsed, double time_limit) {
  ShotStep step;
  step.time = dt;
  if (elapsed + dt >= time_limit) {
    step.outcome = ShotOutcome::timed_out;
    step.time = math::max(0.0, time_limit - elapsed);
  }
  double roots[2];
  const int count = detail::parabola_roots(start.position.y - ground, start.velocity.y, acceleration.y, roots);
  for (int i = count - 1; i >= 0; --i) {
    // Only the crossing downward is an arrival at the ground.
    if (roots[i] >= 0 && roots[i] <= step.time && start.velocity.y + acceleration.y * roots[i] < 0) {
      step.outcome = ShotOutcome::ground;
      step.time = roots[i];
    }
  }
  if (const std::optional<double> hit = first_hit(start, acceleration, step.time, target)) {
    step.outcome = ShotOutcome::hit;
    step.time = *hit;
  }
  step.point = parabola(start, acceleration, step.time);
  return step;
}

BurstParticle burst_particle(Vec3d origin, Vec3d drift, Vec3d velocity, Vec3d acceleration, double life, double time) {
  const FlightPoint at = parabola({origin, drift + velocity}, acceleration, time);
  return {at.position, at.velocity, math::clamp(1 - time / life, 0.0, 1.0)};
}

Vec3d direction_on_sphere(double u, double v) {
  const double y = 2 * u - 1, r = math::sqrt(math::max(0.0, 1 - y * y));
  const math::SinCos<double> turn = math::sincos(2 * math::pi * v);
  return {r * turn.cos, y, r * turn.sin};
}

}  // namespace carom::forces
