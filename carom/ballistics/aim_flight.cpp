// The paths that the aim solver flies.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

[[gnu::always_inline]] inline AimSolver::Step AimSolver::step(Vec3d x, Vec3d v, Vec3d k1, double h) const {
  // The newest slope comes last in every sum, so that all before it is done when it is known.
  const Vec3d v2 = v + (h / 5) * k1, k2 = at(x + (h / 5) * v, v2);
  const Vec3d v3 = v + (h * (3.0 / 40)) * k1 + (h * (9.0 / 40)) * k2;
  const Vec3d k3 = at(x + (h * (3.0 / 40)) * v + (h * (9.0 / 40)) * v2, v3);
  const Vec3d v4 = v + (h * (44.0 / 45)) * k1 - (h * (56.0 / 15)) * k2 + (h * (32.0 / 9)) * k3;
  const Vec3d k4 = at(x + (h * (44.0 / 45)) * v - (h * (56.0 / 15)) * v2 + (h * (32.0 / 9)) * v3, v4);
  const Vec3d v5 = v + (h * (19372.0 / 6561)) * k1 - (h * (25360.0 / 2187)) * k2 + (h * (64448.0 / 6561)) * k3 -
                   (h * (212.0 / 729)) * k4;
  const Vec3d k5 = at(x + (h * (19372.0 / 6561)) * v - (h * (25360.0 / 2187)) * v2 + (h * (64448.0 / 6561)) * v3 -
                          (h * (212.0 / 729)) * v4,
                      v5);
  const Vec3d v6 = v + (h * (9017.0 / 3168)) * k1 - (h * (355.0 / 33)) * k2 + (h * (46732.0 / 5247)) * k3 +
                   (h * (49.0 / 176)) * k4 - (h * (5103.0 / 18656)) * k5;
  const Vec3d k6 = at(x + (h * (9017.0 / 3168)) * v - (h * (355.0 / 33)) * v2 + (h * (46732.0 / 5247)) * v3 +
                          (h * (49.0 / 176)) * v4 - (h * (5103.0 / 18656)) * v5,
                      v6);
  Step end;
  end.v = v + (h * (35.0 / 384)) * k1 + (h * (500.0 / 1113)) * k3 + (h * (125.0 / 192)) * k4 -
          (h * (2187.0 / 6784)) * k5 + (h * (11.0 / 84)) * k6;
  end.x = x + (h * (35.0 / 384)) * v + (h * (500.0 / 1113)) * v3 + (h * (125.0 / 192)) * v4 -
          (h * (2187.0 / 6784)) * v5 + (h * (11.0 / 84)) * v6;
  end.k = at(end.x, end.v);
  end.error = h * math::length(71.0 / 57600 * k1 - 71.0 / 16695 * k3 + 71.0 / 1920 * k4 - 17253.0 / 339200 * k5 +
                               22.0 / 525 * k6 - 1.0 / 40 * end.k);
  return end;
}

AimSolver::Arrival AimSolver::propagate(Vec3d u, double time, double allowed, Schedule* schedule) const {
  // Faster than sound, and most of all through the barrier, drag curves bend too sharply for the estimate of the
  // error: no long steps there, the shorter the better the path must be known.
  const double share = allowed / math::max(math::length(u) * time, 1e-9);
  const double bend_speed = sound_ * math::clamp(0.6 * math::sqrt(math::sqrt(share)), 0.03, 0.2);
  constexpr double far_bend = 3;
  const double least = 0.5 * fall_speed_, tolerance = allowed / time;
  Vec3d x = shooter_.muzzle, v = u, k = at(x, v);
  double t = 0, h = math::min(0.25 * math::max(math::length(v), least) / math::max(math::length(k), 1e-9), time);
  for (int i = 0; i < 4000; ++i) {
    const double speed = math::length(v), pull = math::max(math::length(k), 1e-9), bend = bend_speed / pull;
    if (speed > 0.85 * sound_) {
      if (h > far_bend * bend) h = far_bend * bend;
      if (h > bend && speed - h * pull < 1.15 * sound_) h = bend;
    }
    const bool last = t + h >= time * (1 - 1e-12);
    if (last) h = time - t;
    const Step end = step(x, v, k, h);
    const double room = tolerance / math::max(end.error, 1e-30);
    // The fifth root, near enough: the root of the root, held closer to one.
    const double factor = math::clamp(0.8 * math::sqrt(math::sqrt(room)), 0.2, 1.7);
    if (room >= 1) {
      x = end.x;
      v = end.v;
      k = end.k;
      t += h;
      if (schedule != nullptr) schedule->add(last ? 1 : t / time);
      if (last) break;
    }
    h *= factor;
    if (!(h > 1e-9 * time)) break;
  }
  return {x, v};
}

AimSolver::Arrival AimSolver::follow(Vec3d u, double time, const Schedule& schedule) const {
  Vec3d x = shooter_.muzzle, v = u, k = at(x, v);
  double t = 0;
  for (int i = 0; i < schedule.count; ++i) {
    const double next = time * double(schedule.ends[i]);
    const Step end = step(x, v, k, next - t);
    x = end.x;
    v = end.v;
    k = end.k;
    t = next;
  }
  return {x, v};
}

AimSolver::Pass AimSolver::pass(double elevation, double azimuth) const {
  Vec3d x = shooter_.muzzle, v = shooter_.velocity + shooter_.muzzle_speed * direction(elevation, azimuth),
        k = at(x, v);
  const auto beyond = [&](Vec3d place, double t) {  // m past the target's distance
    const Vec3d to = target_(t) - shooter_.muzzle, way = place - shooter_.muzzle;
    return math::sqrt(way.x * way.x + way.z * way.z) - math::sqrt(to.x * to.x + to.z * to.z);
  };
  const double start = beyond(x, 0);
  double t = 0;
  for (int i = 0; i < 400 && t < options_.longest_time; ++i) {
    const double speed = math::length(v),
                 h = math::min(0.3 * math::max(speed, 0.5 * fall_speed_) / math::max(math::length(k), 1e-9),
                               -0.5 * start / math::max(speed, 1e-9));
    const Step end = step(x, v, k, h);
    const double gone = beyond(end.x, t + h);
    if (gone >= 0) {
      // Within the step: the cubic through both ends, halved to a thousandth.
      double low = 0, high = 1;
      Vec3d place = end.x;
      for (int j = 0; j < 12; ++j) {
        const double s = 0.5 * (low + high), s2 = s * s, s3 = s2 * s;
        place =
            (2 * s3 - 3 * s2 + 1) * x + (s3 - 2 * s2 + s) * h * v + (3 * s2 - 2 * s3) * end.x + (s3 - s2) * h * end.v;
        (beyond(place, t + s * h) >= 0 ? high : low) = s;
      }
      const double when = t + high * h;
      const Vec3d to = target_(when) - shooter_.muzzle, way = place - shooter_.muzzle;
      const double radial = (v.x * way.x + v.z * way.z) / math::max(math::hypot(way.x, way.z), 1e-9);
      const double turn = math::atan2(to.z, to.x) - math::atan2(way.z, way.x);
      return {radial > 2 * math::length(velocity_of_target(when)), way.y - to.y,
              turn > math::pi    ? turn - 2 * math::pi
              : turn < -math::pi ? turn + 2 * math::pi
                                 : turn};
    }
    x = end.x;
    v = end.v;
    k = end.k;
    t += h;
    const double above = x.y - target_(t).y;
    if (v.y < 0 && above < 0.5 * start) {
      // Where the target is nearly as fast as a spent shot, it may have been nearer before.
      const Vec3d way = x - shooter_.muzzle;
      const double radial = (v.x * way.x + v.z * way.z) / math::max(math::hypot(way.x, way.z), 1e-9);
      return {radial > 2 * math::length(velocity_of_target(t)), above + gone, 0};
    }
  }
  return {};
}

}  // namespace carom::ballistics::detail
