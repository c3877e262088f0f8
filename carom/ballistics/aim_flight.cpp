// The paths that the aim solver flies.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

template <bool Plain>
AimSolver::Step AimSolver::step(Vec3d x, Vec3d v, Vec3d k1, double h) const {
  return flight_step([&](int, Vec3d position, Vec3d velocity)
                         __attribute__((always_inline)) { return rough_.at<Plain>(position, velocity); },
                     x, v, k1, h);
}

namespace {

/// Where in a step a height > 0 falls to 0: Hermite's cubic, halved to a thousandth.
double fall_within(double from, double from_slope, double to, double to_slope) {
  double low = 0, high = 1;
  for (int j = 0; j < 10; ++j) {
    const double s = 0.5 * (low + high), s2 = s * s, s3 = s2 * s;
    const double height =
        (2 * s3 - 3 * s2 + 1) * from + (s3 - 2 * s2 + s) * from_slope + (3 * s2 - 2 * s3) * to + (s3 - s2) * to_slope;
    (height > 0 ? low : high) = s;
  }
  return high;
}

}  // namespace

template <bool Plain>
bool AimSolver::fly_in(Guess guess, double allowed, Arrival& arrival, Path* path, bool falling) const {
  double time = guess.time;
  const double share = allowed / math::max(math::length(guess.u) * time, 1e-9);
  const double bend_speed = speed_of_a_bend(share);
  const double least = 0.5 * fall_speed_, tolerance = allowed / time;
  Vec3d x = shooter_.muzzle, v = guess.u, k = rough_.at<Plain>(x, v);
  double t = 0, h = math::min(0.25 * math::max(math::length(v), least) / math::max(math::length(k), 1e-9), time);
  int count = 0;
  if (path) path->put(0, t, x, v, k);
  const int most = path ? Path::most : 4000;
  for (int i = 0; i < 4000 && count < most; ++i) {
    const double speed = math::length(v), pull = math::max(math::length(k), 1e-9), bend = bend_speed / pull;
    if (share < 5e-4 && speed > 0.85 * sound_) {
      h = math::min(h, far_bend * bend);
      if (h > bend && speed - h * pull < 1.15 * sound_) h = bend;
    }
    if (share < 5e-4) h = math::min(h, time / 12);
    bool last = !falling && t + h >= time * (1 - 1e-12);
    if (last) h = time - t;
    const Step end = step<Plain>(x, v, k, h);
    const double room = tolerance / math::max(end.error, 1e-30);
    // The fifth root, near enough: the root of the root, held closer to one.
    const double factor = math::clamp(0.8 * math::sqrt(math::sqrt(room)), 0.2, 1.7);
    if (room >= 1) {
      if (falling && end.v.y < 0 && end.x.y < target_(t + h).y) {
        // Once more, as far as it takes to come down to the target.
        const double drop = x.y - target_(t).y, left = end.x.y - target_(t + h).y;
        falling = false;
        time = t + (drop > 0 ? h * fall_within(drop, h * (v.y - velocity_of_target(t).y), left,
                                               h * (end.v.y - velocity_of_target(t + h).y))
                             : h);
        if (time < t + h) {
          h = time - t;
          continue;
        }
        last = true;
      }
      x = end.x;
      v = end.v;
      k = end.k;
      t = last ? time : t + h;
      ++count;
      if (path) {
        path->put(count, t, x, v, k);
        path->count = count;
      }
      if (last) {
        arrival = {x, v};
        return true;
      }
    }
    h *= factor;
    if (!(h > 1e-9 * time) || (falling && t > options_.longest_time)) break;
  }
  arrival = {x, v};
  return false;
}

template <bool Plain>
AimSolver::Pass AimSolver::pass_in(double elevation, double azimuth) const {
  Vec3d x = shooter_.muzzle, v = shooter_.velocity + shooter_.muzzle_speed * direction(elevation, azimuth),
        k = rough_.at<Plain>(x, v);
  const auto beyond = [&](Vec3d place, double t) {  // m past the target's distance
    const Vec3d to = target_(t) - shooter_.muzzle, way = place - shooter_.muzzle;
    return math::sqrt(way.x * way.x + way.z * way.z) - math::sqrt(to.x * to.x + to.z * to.z);
  };
  const double start = beyond(x, 0);
  double t = 0, above = x.y - target_(0).y, nearest = -1e300;
  for (int i = 0; i < 400 && t < options_.longest_time; ++i) {
    const double speed = math::length(v),
                 h = math::min(0.3 * math::max(speed, 0.5 * fall_speed_) / math::max(math::length(k), 1e-9),
                               -0.5 * start / math::max(speed, 1e-9));
    const Step end = step<Plain>(x, v, k, h);
    const double gone = beyond(end.x, t + h), above_end = end.x.y - target_(t + h).y;
    const bool passes = gone >= 0, crosses = (above > 0) != (above_end > 0);
    if (passes || crosses) {
      // Within the step: the cubic through both ends, halved to a thousandth.
      const auto look = [&](double s) {
        const double s2 = s * s, s3 = s2 * s;
        return (2 * s3 - 3 * s2 + 1) * x + (s3 - 2 * s2 + s) * h * v + (3 * s2 - 2 * s3) * end.x +
               (s3 - s2) * h * end.v;
      };
      const auto first = [&](auto&& is_there) {
        double low = 0, high = 1;
        for (int j = 0; j < 12; ++j) {
          const double s = 0.5 * (low + high);
          (is_there(look(s), t + s * h) ? high : low) = s;
        }
        return high;
      };
      double s = crosses ? first([&](Vec3d place, double at) { return (place.y > target_(at).y) != (above > 0); }) : 2;
      const bool far = crosses && beyond(look(s), t + s * h) < 0;  // at the target's height before its distance
      if (!far && passes) s = first([&](Vec3d place, double at) { return beyond(place, at) >= 0; });
      const double when = t + s * h;
      const Vec3d place = look(s), to = target_(when) - shooter_.muzzle, way = place - shooter_.muzzle;
      const double radial = (v.x * way.x + v.z * way.z) / math::max(math::hypot(way.x, way.z), 1e-9);
      double turn = math::atan2(to.z, to.x) - math::atan2(way.z, way.x);
      turn += turn > math::pi ? -2 * math::pi : turn < -math::pi ? 2 * math::pi : 0;
      if (!far) return {radial > 2 * math::length(velocity_of_target(when)), math::max(way.y - to.y, nearest), turn};
      // What the wind and the shooter's way do hangs on the azimuth.
      const double drift = math::length(shooter_.velocity) + math::length(conditions_.wind.at(place.y));
      nearest = math::max(nearest, beyond(place, when) + drift * when * math::min(math::abs(turn), 1.0));
      if (above > 0) return {end.v.y < velocity_of_target(when).y, nearest, turn};
      if (passes) return {};
    }
    x = end.x;
    v = end.v;
    k = end.k;
    t += h;
    above = above_end;
    if (v.y < 0 && above < 0.5 * start) return {true, above + gone, 0};  // it never came up to the target's height
  }
  return {};
}

template bool AimSolver::fly_in<true>(Guess, double, Arrival&, Path*, bool) const;
template bool AimSolver::fly_in<false>(Guess, double, Arrival&, Path*, bool) const;
template AimSolver::Pass AimSolver::pass_in<true>(double, double) const;
template AimSolver::Pass AimSolver::pass_in<false>(double, double) const;

}  // namespace carom::ballistics::detail
