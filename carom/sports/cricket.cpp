#include "carom/sports/cricket.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/sports/detail/number_fields.h"

namespace carom::sports {
namespace {

constexpr double longest = 10;  // s

BallState released(const CricketDelivery& d) {
  return launch_state({.speed = d.speed,
                       .elevation = d.elevation,
                       .azimuth = d.azimuth,
                       .spin = d.spin,
                       .tilt = d.tilt,
                       .gyro = d.gyro},
                      {0, d.height, d.side});
}

/// From a state to the ground or the stumps, whatever comes first.
core::Result<BallFlight> leg(const Ball& ball, const Conditions& conditions, const BallState& start, double distance) {
  return fly_until(
      ball, conditions, start,
      [&](double, const BallState& s) { return math::min(s.position.y - ball.radius, distance - s.position.x); },
      {.time = longest});
}

}  // namespace

core::Status check(const CricketDelivery& delivery) { return detail::check_fields(delivery, "a delivery"); }

BallState CricketPath::at(double when) const {
  if (when <= air.duration() || off.empty()) return air.at(when);
  when -= air.duration();
  for (const BallFlight& flight : off) {
    if (when <= flight.duration()) return flight.at(when);
    when -= flight.duration();
  }
  return off.back().end();
}

core::Result<CricketPath> deliver(const Ball& ball, const Conditions& conditions, const Surface& pitch,
                                  const CricketDelivery& d, double distance) {
  if (const core::Status good = check(d); !good) return good.error();
  if (const core::Status good = detail::check_fields(pitch, "a pitch"); !good) return good.error();
  if (!(distance > 1 && distance < 1000))
    return core::Error{core::text("the distance to the stumps is ", distance, ", expected a number in (1, 1000) m")};
  Ball seamed = ball;
  const math::SinCos<double> seam = math::sincos(d.azimuth + d.seam);
  seamed.side.seam_normal = {0.0 - seam.sin, 0, seam.cos};
  CricketPath path;
  auto air = leg(seamed, conditions, released(d), distance);
  if (!air) return air.error();
  path.air = std::move(*air);
  BallFlight::Point end = path.air.end();
  path.time = end.time;
  path.full = end.position.x >= distance - 1e-6;
  // The same ball without seam and spin, as far down the pitch.
  Ball plain = ball;
  plain.side = {};
  plain.lift = {};
  const auto straight =
      fly_until(plain, conditions, released(d),
                [&](double, const BallState& s) { return end.position.x - s.position.x; }, {.time = longest});
  if (!straight) return straight.error();
  path.swing = end.position.z - straight->end().position.z;
  if (!path.full) {
    path.length = distance - end.position.x;
    path.line = end.position.z;
    seamed.side.kind = SideForce::Kind::none;
    double before = math::atan2(end.velocity.z, end.velocity.x);
    for (int i = 0; i < 20 && end.position.x < distance - 1e-6; ++i) {
      BallState start = bounce(seamed, pitch, {0, 1, 0}, end).after;
      if (i == 0) path.turn = math::atan2(start.velocity.z, start.velocity.x) - before;
      start.position.y = math::max(start.position.y, ball.radius);
      if (!(start.velocity.y > 1e-3 && start.velocity.x > 1e-3)) break;
      auto flight = leg(seamed, conditions, start, distance);
      if (!flight) return flight.error();
      path.time += flight->duration();
      end = flight->end();
      path.off.push_back(std::move(*flight));
    }
  }
  if (!(end.position.x >= distance - 1e-6) || path.time > longest)
    return core::Error{"the delivery does not reach the stumps within 10 s"};
  path.speed = math::length(end.velocity);
  path.height = end.position.y;
  path.side = end.position.z;
  path.hits = path.height - ball.radius < stumps_height && math::abs(path.side) < 0.5 * stumps_width + ball.radius;
  return path;
}

core::Result<CricketDelivery> aimed(const Ball& ball, const Conditions& conditions, const Surface& pitch,
                                    const CricketDelivery& delivery, double length, double line, double distance) {
  CricketDelivery d = delivery;
  if (!(length > 0 && length < distance))
    return core::Error{
        core::text("the length of a delivery is ", length, ", expected a number in (0, ", distance, ")")};
  const double way = distance - length;
  d.elevation = -math::atan2(d.height, way);
  d.azimuth = math::atan2(line - d.side, way);
  // Flat deliveries pitch at about −h/way + ½ g way/v²; what is left is corrected by the slope of that.
  for (int i = 0; i < 40; ++i) {
    const auto path = deliver(ball, conditions, pitch, d, distance);
    double reached = distance;
    double beside = 0;
    if (path && !path->full) {
      reached = distance - path->length;
      beside = path->line;
    } else if (path) {
      beside = path->side;
    } else if (i > 0) {
      return path.error();
    }
    const double off = way - reached, aside = line - beside;
    if (path && !path->full && math::abs(off) < 1e-3 && math::abs(aside) < 1e-3) return d;
    const double steepness =
        math::max(0.02, d.height / (way * way) + 0.5 * conditions.gravity / math::square(math::max(d.speed, 1.0)));
    d.elevation = math::clamp(d.elevation + 0.8 * off * steepness, -1.2, 1.2);
    d.azimuth = math::clamp(d.azimuth + aside / way, -1.0, 1.0);
  }
  return core::Error{
      core::text("no delivery of ", d.speed, " m/s was found that pitches ", length, " m before the stumps")};
}

}  // namespace carom::sports
