#include "carom/sports/bowling.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/vec.h"
#include "carom/sports/detail/number_fields.h"

namespace carom::sports {

core::Status check(const Lane& lane) {
  if (const core::Status good = detail::check_fields(lane, "a lane"); !good) return good;
  if (lane.stretches.empty()) return core::Error{"a lane has no stretches, expected at least one"};
  double before = 0;
  for (std::size_t i = 0; i < lane.stretches.size(); ++i) {
    const Lane::Stretch& s = lane.stretches[i];
    if (!(s.end > before && s.end < 1e6))
      return core::Error{
          core::text("end of stretch ", i + 1, " of a lane is ", s.end, ", expected more than ", before)};
    if (!(s.friction >= 0 && s.friction <= 10))
      return core::Error{
          core::text("friction of stretch ", i + 1, " of a lane is ", s.friction, ", expected a number in [0, 10]")};
    before = s.end;
  }
  return {};
}

core::Status usbc_allows(const BowlingBall& ball, const Lane& lane) {
  if (const core::Status good = detail::check_fields(ball, "a bowling ball"); !good) return good;
  if (const core::Status good = check(lane); !good) return good;
  constexpr double inch = 0.0254, pound = 0.45359237, rounding = 1 + 1e-9;
  double grip = 0;
  for (const Lane::Stretch& s : lane.stretches) grip = math::max(grip, ball.cover * s.friction);
  const struct {
    const char* what;
    double found, least, most;
    const char* unit;
  } rules[] = {{"diameter", 2 * ball.radius / inch, 8.5, 8.595, " in"},
               {"weight", ball.mass / pound, 0, 16, " lb"},
               {"radius of gyration", ball.gyration / inch, 2.46, 2.80, " in"},
               {"differential", ball.differential / inch, 0, .06, " in"},
               {"friction on the lane", grip, 0, .32, ""}};
  for (const auto& rule : rules)
    if (rule.found > rule.most * rounding || rule.found * rounding < rule.least)
      return core::Error{
          core::text("not by USBC's rules: ", core::refused(core::text("the ", rule.what, " of the ball"), rule.found,
                                                            core::text(rule.least, " to ", rule.most, rule.unit)))};
  return {};
}

namespace {

core::Status check(const BowlingBall& ball, const Lane& lane, const Delivery& d) {
  if (const core::Status good = detail::check_fields(ball, "a bowling ball"); !good) return good;
  if (const core::Status good = sports::check(lane); !good) return good;
  return detail::check_fields(d, "a delivery");
}

/// The first time in (0, limit) at which p + v t + ½ a t² reaches q, or `limit`.
double reach(double p, double v, double a, double q, double limit) {
  const double d = q - p;
  double best = limit;
  const auto offer = [&](double t) {
    if (t > 1e-12 && t < best) best = t;
  };
  if (math::abs(a) < 1e-15) {
    if (v != 0) offer(d / v);
    return best;
  }
  const double root = v * v + 2 * a * d;
  if (root < 0) return best;
  // The two roots without cancellation.
  const double w = -(v + (v < 0 ? -1.0 : 1.0) * math::sqrt(root));
  offer(w / a);
  if (w != 0) offer(-2 * d / w);
  return best;
}

}  // namespace

double LanePath::entry_angle() const { return math::atan2(end().speed_y, end().speed_x); }

LanePoint LanePath::at(double time) const {
  if (points.empty()) return {};
  std::size_t i = 0;
  while (i + 1 < points.size() && points[i + 1].time <= time) ++i;
  if (i + 1 == points.size() || time <= points.front().time) {
    LanePoint p = time <= points.front().time ? points.front() : points.back();
    return p;
  }
  // Between two points the acceleration is constant.
  const LanePoint &a = points[i], &b = points[i + 1];
  const double h = b.time - a.time, t = time - a.time, s = t / h;
  LanePoint p = a;
  p.time = time;
  p.speed_x = a.speed_x + s * (b.speed_x - a.speed_x);
  p.speed_y = a.speed_y + s * (b.speed_y - a.speed_y);
  p.rim_x = a.rim_x + s * (b.rim_x - a.rim_x);
  p.rim_y = a.rim_y + s * (b.rim_y - a.rim_y);
  p.x = a.x + 0.5 * t * (a.speed_x + p.speed_x);
  p.y = a.y + 0.5 * t * (a.speed_y + p.speed_y);
  return p;
}

core::Result<LanePath> bowl(const BowlingBall& ball, const Lane& lane, const Delivery& delivery) {
  if (const core::Status good = check(ball, lane, delivery); !good) return good.error();
  const double ratio = math::square(ball.radius / ball.gyration);  // r²/k²
  const math::SinCos<double> way = math::sincos(delivery.angle),
                             axis = math::sincos(delivery.angle + delivery.axis_rotation);
  const double rim = ball.radius * delivery.spin;
  LanePoint p{.y = delivery.start,
              .speed_x = delivery.speed * way.cos,
              .speed_y = delivery.speed * way.sin,
              .rim_x = rim * axis.cos,
              .rim_y = rim * axis.sin};
  LanePath path;
  const double edge = 0.5 * lane.width;
  std::size_t stretch = 0;
  for (int guard = 0; guard < 1000; ++guard) {
    const double ux = p.speed_x - p.rim_x, uy = p.speed_y - p.rim_y, u = math::hypot(ux, uy);
    p.rolls = p.rolls || u < 1e-9;
    path.points.push_back(p);
    if (p.x >= lane.length - 1e-12) break;
    if (math::abs(p.y) >= edge) {
      path.gutter = true;
      break;
    }
    const double friction = ball.cover * lane.stretches[stretch].friction;
    const bool last = stretch + 1 == lane.stretches.size();
    const double border = last ? lane.length : math::min(lane.stretches[stretch].end, lane.length);
    const double a = p.rolls ? 0 : friction * lane.gravity;
    const double ax = p.rolls ? 0 : -a * ux / u, ay = p.rolls ? 0 : -a * uy / u;
    const double roll = a > 0 ? u / (a * (1 + ratio)) : 1e9;
    const double at_border = reach(p.x, p.speed_x, ax, border, 1e9);
    double time = math::min(roll, at_border);
    time = math::min(time, reach(p.y, p.speed_y, ay, edge, time));
    time = math::min(time, reach(p.y, p.speed_y, ay, -edge, time));
    if (!(time < 1e9)) return core::Error{"the ball does not reach the pins: it comes to rest on the lane"};
    p.time += time;
    p.x += time * (p.speed_x + 0.5 * time * ax);
    p.y += time * (p.speed_y + 0.5 * time * ay);
    p.speed_x += time * ax;
    p.speed_y += time * ay;
    p.rim_x -= ratio * time * ax;
    p.rim_y -= ratio * time * ay;
    if (time == roll && a > 0) {
      p.rolls = true;
      p.rim_x = p.speed_x;
      p.rim_y = p.speed_y;
    }
    if (time == at_border) {
      p.x = border;
      if (!last) ++stretch;
    }
    if (math::abs(math::abs(p.y) - edge) < 1e-9) p.y = p.y > 0 ? edge : -edge;
    if (p.rolls && !(p.speed_x > 1e-9)) return core::Error{"the ball rolls back from the pins"};
  }
  return path;
}

}  // namespace carom::sports
