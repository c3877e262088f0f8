// The paths that the aim solver flies.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

template <bool Rough>
AimSolver::Step AimSolver::step(Vec3d x, Vec3d v, Vec3d k1, double h) const {
  const auto at = [&](int, Vec3d position, Vec3d velocity)
                      __attribute__((always_inline)) { return rough_.at(position, velocity); };
  if constexpr (Rough)
    return rough_flight_step(at, x, v, k1, h);
  else
    return flight_step(at, x, v, k1, h);
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

template <bool Rough>
bool AimSolver::fly(Guess guess, double allowed, Path& path, bool falling, bool on) const {
  double time = guess.time;
  const double share = allowed / math::max(math::length(guess.u) * time, 1e-9);
  const double bend_speed = speed_of_a_bend(share);
  const double least = 0.5 * fall_speed_, tolerance = (Rough ? 4 : 1) * allowed / time;
  if (!on) {
    path.count = 0;
    path.put(0, 0, shooter_.muzzle, guess.u, rough_.at(shooter_.muzzle, guess.u));
  }
  Vec3d x = Path::at(path.x, path.count), v = Path::at(path.v, path.count), k = Path::at(path.k, path.count);
  double t = path.time(), h = 0.25 * math::max(math::length(v), least) / math::max(math::length(k), 1e-9);
  h = math::min(h, time - t);
  for (int i = 0; i < 4000 && path.count < Path::most; ++i) {
    const double speed = math::length(v), pull = math::max(math::length(k), 1e-9), bend = bend_speed / pull;
    if (share < 5e-4 && speed > 0.85 * sound_) {
      h = math::min(h, far_bend * bend);
      if (h > bend && speed - h * pull < 1.15 * sound_) h = bend;
    }
    if (share < 5e-4) h = math::min(h, time / 12);
    bool last = !falling && t + h >= time * (1 - 1e-12);
    if (last) h = time - t;
    const Step end = step<Rough>(x, v, k, h);
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
      path.put(++path.count, t, x, v, k);
      if (last) return true;
    }
    h *= factor;
    if (!(h > 1e-9 * time) || (falling && t > options_.longest_time)) break;
  }
  return false;
}

template bool AimSolver::fly<true>(Guess, double, Path&, bool, bool) const;
template bool AimSolver::fly<false>(Guess, double, Path&, bool, bool) const;

}  // namespace carom::ballistics::detail
