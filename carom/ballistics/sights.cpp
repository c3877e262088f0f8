#include "carom/ballistics/sights.h"

#include "carom/ballistics/detail/flight_air.h"
#include "carom/ballistics/detail/number_checks.h"
#include "carom/math/calculus.h"

namespace carom::ballistics {

using math::Vec3d;

namespace detail {

core::Result<void> check(const Gun& gun) {
  const core::Status numbers = check_numbers({{"muzzle_speed", gun.muzzle_speed},
                                              {"sight_height", gun.sight_height, true},
                                              {"mass", gun.mass, true},
                                              {"area_per_mass", gun.projectile.area_per_mass, true}});
  if (!numbers) return core::Error{core::text("gun: ", numbers.error().message)};
  if (!math::is_finite(gun.sight_offset))
    return core::Error{core::text("gun: ", core::refused("sight_offset", gun.sight_offset, "a finite number"))};
  if (gun.shape && (!(gun.shape->mass > 0) || !(gun.shape->diameter > 0) || !(gun.shape->length > 0) || gun.twist == 0))
    return core::Error{"gun: spin drift needs mass, diameter and length > 0, and a twist"};
  return {};
}

/// Axes of the line of sight.
struct Sightline {
  Vec3d along, up, right{0, 0, 1};
  explicit Sightline(double slant) {
    const math::SinCos<double> s = math::sincos(slant);
    along = {s.cos, s.sin, 0};
    up = {-s.sin, s.cos, 0};
  }
  explicit Sightline(Vec3d way) : along(way) {
    const Vec3d across = math::cross(way, Vec3d{0, 1, 0});
    const double level = math::length(across);
    if (level > 1e-9) right = across / level;
    up = math::cross(right, along);
  }
  /// Of a gun that leans to the right.
  Vec3d top(double cant) const {
    const math::SinCos<double> lean = math::sincos(cant);
    return lean.cos * up + lean.sin * right;
  }
};

Vec3d bore_of(const Aiming& aiming, const Sightline& line) {
  const math::SinCos<double> elevation = math::sincos(aiming.elevation), windage = math::sincos(aiming.windage);
  const Vec3d top = line.top(aiming.cant);
  return elevation.cos * (windage.cos * line.along + windage.sin * math::cross(line.along, top)) + elevation.sin * top;
}

FlightPoint muzzle_of(const Gun& gun, const Aiming& aiming, const Sightline& line) {
  const Vec3d top = line.top(aiming.cant), right = math::cross(line.along, top);
  return {-gun.sight_height * top - gun.sight_offset * right, gun.muzzle_speed * bore_of(aiming, line)};
}

core::Result<Trajectory> fly_along(const Gun& gun, const Conditions& conditions, const Aiming& aiming,
                                   double farthest) {
  const FlightPoint start = muzzle_of(gun, aiming, Sightline(aiming.slant));
  return fly(gun.projectile, conditions, start, {.time = 200, .distance = farthest, .tolerance = 1e-10});
}

}  // namespace detail

Vec3d swung(Vec3d way, double up, double right) {
  return detail::bore_of({.elevation = up, .windage = right}, detail::Sightline(way));
}
Vec3d bore_direction(Vec3d line, const Aiming& aiming) { return detail::bore_of(aiming, detail::Sightline(line)); }

namespace {

/// The shot at a distance along the line of sight; empty where it does not come so far.
std::optional<Vec3d> place_at(const Gun& gun, const Conditions& conditions, const Aiming& aiming,
                              const detail::Sightline& line, double distance) {
  const core::Result<Trajectory> flight = detail::fly_along(gun, conditions, aiming, distance * 1.01 + 1);
  if (!flight) return std::nullopt;
  const auto there =
      flight->first([&](const Trajectory::Point& p) { return math::dot(p.position, line.along) - distance; });
  if (!there) return std::nullopt;
  return there->position;
}

}  // namespace

core::Result<double> zero_elevation(const Gun& gun, const Conditions& conditions, double distance, double slant) {
  const core::Result<void> checked = detail::check(gun);
  if (!checked.ok()) return checked.error();
  if (!(distance > 0) || !math::is_finite(distance))
    return core::Error{core::refused("zero distance", distance, "a finite number of metres > 0")};
  const detail::Sightline line(slant);
  const double windage = math::atan(gun.sight_offset / distance);
  const auto height = [&](double elevation) -> std::optional<double> {
    const auto there =
        place_at(gun, conditions, {.elevation = elevation, .slant = slant, .windage = windage}, line, distance);
    if (!there) return std::nullopt;
    return math::dot(*there, line.up);
  };
  // The height there grows with the elevation until the arc becomes too high: secants from a flat shot.
  const double fall = 0.5 * conditions.gravity * math::square(distance / gun.muzzle_speed) * math::cos(slant);
  double low = 0, high = math::atan((gun.sight_height + fall) / distance);
  std::optional<double> at_low = height(low), at_high = height(high);
  for (int i = 0; i < 60 && at_low && at_high; ++i) {
    const double slope = (*at_high - *at_low) / (high - low);
    if (!(slope > 0)) break;
    const double next = math::min(high - *at_high / slope, high + 0.2);
    low = high;
    at_low = at_high;
    high = next;
    at_high = height(high);
    if (at_high && math::abs(*at_high) < 1e-9 * math::max(1.0, distance)) return high;
    if (high == low) return high;
  }
  return core::Error{core::text("no elevation brings the shot to the line of sight at ", distance,
                                " m: it is out of reach for ", gun.muzzle_speed, " m/s")};
}

core::Result<Aiming> zero_aiming(const Gun& gun, const Conditions& conditions, double distance, double slant) {
  const core::Result<double> elevation = zero_elevation(gun, conditions, distance, slant);
  if (!elevation) return elevation.error();
  Aiming aiming{.elevation = *elevation, .slant = slant};
  if (gun.sight_offset == 0) return aiming;
  // Level in still air the angle is exact; on a slope, gravity shortens the way along the line but not across it.
  const detail::Sightline line(slant);
  Gun centred = gun;
  centred.sight_offset = 0;
  const auto drift = place_at(centred, conditions, aiming, line, distance);
  aiming.windage = math::atan(gun.sight_offset / distance);
  for (int i = 0; i < 2; ++i) {
    const auto there = place_at(gun, conditions, aiming, line, distance);
    if (!there || !drift) break;
    aiming.windage -= math::atan(math::dot(*there - *drift, line.right) / distance);
  }
  return aiming;
}

core::Result<SightedFlight> SightedFlight::fire(const Gun& gun, const Conditions& conditions, const Aiming& aiming,
                                                double farthest) {
  const core::Result<void> checked = detail::check(gun);
  if (!checked.ok()) return checked.error();
  core::Result<Trajectory> flight = detail::fly_along(gun, conditions, aiming, farthest * math::cos(aiming.slant) + 1);
  if (!flight) return flight.error();
  SightedFlight seen(std::move(flight).value());
  const detail::Sightline line(aiming.slant);
  seen.along_ = line.along;
  seen.up_ = line.up;
  seen.right_ = line.right;
  seen.mass_ = gun.mass;
  seen.air_ = conditions.air;
  if (gun.shape) {
    constexpr double foot = 0.3048, mph = 0.44704;
    const double density = conditions.air.at(0).density;
    const double twist = math::abs(gun.twist);
    seen.stability_ = density > 0 ? miller_stability(*gun.shape, twist, gun.muzzle_speed / foot, density / 1.225) : 0;
    seen.twist_sign_ = gun.twist > 0 ? 1 : -1;
    const double from_right = -math::dot(detail::wind_of(conditions, {}, 0), line.right) / mph;
    seen.jump_ = seen.twist_sign_ * from_right * aerodynamic_jump(seen.stability_, *gun.shape) * minute_of_angle;
  }
  return seen;
}

SightedPoint SightedFlight::seen(const Trajectory::Point& point) const {
  SightedPoint out;
  out.distance = math::dot(point.position, along_);
  out.time = point.time;
  out.speed = math::length(point.velocity);
  out.mach = out.speed / air_.at(point.position.y).speed_of_sound;
  out.energy = 0.5 * mass_ * out.speed * out.speed;
  out.height = math::dot(point.position, up_) + jump_ * out.distance;
  out.side = math::dot(point.position, right_) + twist_sign_ * 0.0254 * spin_drift(stability_, point.time);
  if (out.distance > 0) {
    out.hold_up = math::atan2(-out.height, out.distance);
    out.hold_right = math::atan2(-out.side, out.distance);
  }
  return out;
}

std::optional<SightedPoint> SightedFlight::at(double distance) const {
  const auto point =
      trajectory_.first([&](const Trajectory::Point& p) { return math::dot(p.position, along_) - distance; });
  if (!point) return std::nullopt;
  return seen(*point);
}

std::vector<double> SightedFlight::zeros() const {
  std::vector<double> zeros;
  double after = 0;
  while (zeros.size() < 2) {
    const auto point = trajectory_.first([&](const Trajectory::Point& p) {
      const double height = math::dot(p.position, up_) + jump_ * math::dot(p.position, along_);
      // The crossing that was found is left behind: up to a hair beyond it the sign of the other side is reported.
      return p.time > after ? height : (zeros.empty() ? -1.0 : 1.0);
    });
    if (!point) break;
    zeros.push_back(math::dot(point->position, along_));
    after = point->time + 1e-6;
  }
  return zeros;
}

double SightedFlight::point_blank_range(double radius) const {
  const auto point = trajectory_.first([&](const Trajectory::Point& p) {
    const SightedPoint s = seen(p);
    // The muzzle may lie below the circle; it counts from where the shot has come within.
    return s.height > 0 || math::dot(p.velocity, up_) < 0 ? radius - math::abs(s.height) : radius;
  });
  return math::dot((point ? point->position : trajectory_.end().position), along_);
}

std::optional<SightedFlight::Stretch> SightedFlight::danger_space(double distance, double height) const {
  const auto middle = at(distance);
  if (!middle || !(height > 0)) return std::nullopt;
  const double last = math::dot(trajectory_.end().position, along_);
  const auto within = [&](double d) {
    const auto point = at(d);
    return point && math::abs(point->height - middle->height) <= 0.5 * height;
  };
  // Outward in steps, then by halves.
  const auto edge = [&](double limit) {
    constexpr int steps = 400;
    double inside = distance;
    for (int i = 1; i <= steps; ++i) {
      double outside = distance + (limit - distance) * i / steps;
      if (within(outside)) {
        inside = outside;
        continue;
      }
      for (int k = 0; k < 50; ++k) {
        const double d = 0.5 * (inside + outside);
        (within(d) ? inside : outside) = d;
      }
      return inside;
    }
    return limit;
  };
  return Stretch{edge(0), edge(last)};
}

core::Result<GreatestRange> greatest_range(const Gun& gun, const Conditions& conditions) {
  const auto shoot = [&](double elevation) -> core::Result<GreatestRange> {
    const auto flight =
        fly(gun.projectile, conditions, {{}, gun.muzzle_speed * direction(elevation)}, {.time = 3600, .ground = 0});
    if (!flight) return flight.error();
    const Trajectory::Point end = flight->end();
    return GreatestRange{elevation, math::hypot(end.position.x, end.position.z), end.time};
  };
  // Over level ground the range has one peak.
  core::Status flies;
  const double elevation = math::least_place(
      [&](double at) {
        const auto shot = shoot(at);
        if (shot) return -shot->range;
        flies = shot.error();
        return 0.0;
      },
      0.02, 1.55, 40);
  if (!flies) return flies.error();
  return shoot(elevation);
}

core::Result<PointBlank> best_point_blank(const Gun& gun, const Conditions& conditions, double radius) {
  if (!(radius > 0) || !math::is_finite(radius))
    return core::Error{core::refused("radius of the target", radius, "a finite number of metres > 0")};
  // The longest one touches the top of the circle: find the zero whose highest point is `radius`.
  const auto top = [&](double zero) -> std::optional<double> {
    const core::Result<double> elevation = zero_elevation(gun, conditions, zero);
    if (!elevation) return std::nullopt;
    const auto flight = SightedFlight::fire(gun, conditions, {.elevation = elevation.value()}, zero + 1);
    return flight ? std::optional<double>(flight->trajectory().apex().position.y) : std::nullopt;
  };
  double low = 1, high = 2;
  std::optional<double> at_high = top(high);
  while (at_high && *at_high < radius && high < 1e5) {
    low = high;
    high *= 1.5;
    at_high = top(high);
  }
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const std::optional<double> height = top(middle);
    (height && *height < radius ? low : high) = middle;
  }
  const core::Result<double> elevation = zero_elevation(gun, conditions, low);
  if (!elevation) return elevation.error();
  const auto flight = SightedFlight::fire(gun, conditions, {.elevation = elevation.value()}, 3 * low + 10);
  if (!flight) return flight.error();
  return PointBlank{low, flight->point_blank_range(radius * (1 + 1e-9))};
}

}  // namespace carom::ballistics
