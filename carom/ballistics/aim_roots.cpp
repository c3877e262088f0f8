// The shot near a guess, by Newton's and Broyden's methods.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

namespace {

bool any_mistakes(const FlightPath& path, double too_much) {
  for (int n = 0; n < path.count; ++n)
    if (path.mistaken(n) > too_much) return true;
  return false;
}
double all_carry(const FlightPath& path) {
  double sum = 0;
  for (int n = 0; n < path.count; ++n) sum += path.carried(n);
  return sum;
}

}  // namespace

AimSolver::Newton AimSolver::newton(const Path& path, const Guess& guess) const {
  Newton to;
  const Inverse inverse = inverse_of(path.by_velocity);
  const Arrival& end = path.arrival;
  const Vec3d target = target_(guess.time), miss = target - end.position, barrel = guess.u - shooter_.velocity;
  const double speed = math::length(barrel), lack = shooter_.muzzle_speed - speed, missed = math::length(miss);
  const Vec3d d = barrel / speed, goes = velocity_of_target(guess.time), drift = goes - end.velocity;
  const Vec3d to_miss = inverse.apply(miss), to_drift = inverse.apply(drift);
  to.slope = math::dot(d, to_drift);
  to.known = math::is_finite(missed) && math::is_finite(to.slope) && to.slope != 0;
  to.missed = missed + math::abs(lack) * guess.time;
  to.dt = math::clamp((lack - math::dot(d, to_miss)) / to.slope, -0.5 * guess.time, guess.time);
  to.du = to_miss + to.dt * to_drift;
  const double longest = shooter_.muzzle_speed;
  if (math::length(to.du) > longest) to.du *= longest / math::length(to.du);
  const double end_speed = math::length(end.velocity), time = guess.time + to.dt;
  to.scale = math::max(math::length(target - shooter_.muzzle), 0.5 * end_speed * guess.time);
  to.moved = math::length(to.du) * time + end_speed * math::abs(to.dt) + path.leaps;
  // Derivatives are known to a few thousandths, and what is left is as the square of the way.
  // The leap of a wind profile at its beginning they do not know.
  to.left = to.moved * ((path.lands ? 0.1 : 2e-3) + to.moved / to.scale) +
            math::length(target_(time) - target - to.dt * goes);
  return to;
}

AimSolver::Root AimSolver::refine(Guess guess, int most, bool eager, bool falling, Path* known) const {
  Root root;
  Path own, &path = known != nullptr ? *known : own;
  const double allowed = options_.tolerance, away = math::length(target_(guess.time) - shooter_.muzzle);
  // A rough flight from the guess; then that path itself is moved, all of it at once, until it is a flight that hits:
  // in the few elements of that flight, then in as many as the tolerance wants, at last by more points of them.
  double rough = math::min(2e-5 * math::length(guess.u) * guess.time, 75 * allowed);
  double accuracy = math::max(0.02 * away, rough);
  double last_missed = 1e300, first_missed = 1e300, strict = 1;
  int divisions = 0;
  bool flown = known != nullptr, flat = true;
  if (flown)
    for (int n = 0; n < path.count; ++n) path.flatten(n);
  for (int i = 0; i < most; ++i) {
    if (!flown) {
      if (!record(guess, accuracy, path, i == 0 && falling)) {
        if (path.count < Path::most) return root;
        rough *= 4;  // too many steps
        accuracy *= 4;
        continue;
      }
      for (int n = 0; n < path.count; ++n) path.flatten(n);
      guess.time = path.time();
      flown = flat = true;
    }
    linearize(path, true);
    Newton to = newton(path, guess);
    bool fine = to.left < allowed && unsettled(path) < allowed && (!flat || all_carry(path) < 10 * allowed);
    flat = false;
    const bool near = to.left < 20 * allowed;
    const double enough = math::max((near ? 3 : 8) * allowed * strict, 3e-3 * to.moved);
    bool hard = !fine && divisions < 7 && any_mistakes(path, 2 * enough);
    if (fine) {
      measure(path);
      to = newton(path, guess);
      fine = to.left < allowed && (!path.bends || all_carry(path) < 100 * allowed || divisions > 6);
      if (!fine) {
        strict *= 0.1;
        hard = divisions < 7;
      }
    }
    if (!to.known) return root;
    guess.u += to.du;
    guess.time += to.dt;
    if (!(guess.time > 1e-9) || guess.time > 2 * options_.longest_time) return root;
    if (fine) {
      const Vec3d aimed = guess.u - shooter_.velocity, end = path.arrival.velocity;
      root = {true, to.slope, guess, {target_(guess.time), end + to.dt * Path::at(path.k, path.count)}};
      root.guess.u = shooter_.velocity + (shooter_.muzzle_speed / math::length(aimed)) * aimed;
      return root;
    }
    if (eager && i >= 4 && to.missed > 0.2 * first_missed) return root;
    if (i == 0) first_missed = to.missed;
    if (to.moved > 1.2 * to.scale || to.missed > last_missed) {
      flown = false;
      accuracy = math::max(0.02 * math::min(to.moved, to.scale), rough);
      last_missed = 1e300;
      divisions = 0;
      continue;
    }
    move(path, to.du, to.dt);
    last_missed = to.missed;
    if (hard) {
      divide(path, enough);
      ++divisions;
      last_missed = 1e300;  // more points may see more
    }
  }
  return root;
}

AimSolver::Inverse AimSolver::inverse_of(const Vec3d* rows) {
  const Vec3d c12 = math::cross(rows[1], rows[2]), c20 = math::cross(rows[2], rows[0]),
              c01 = math::cross(rows[0], rows[1]);
  const double determinant = math::dot(rows[0], c12);
  Inverse inverse;
  for (int i = 0; i < 3; ++i) inverse.row[i] = (1 / determinant) * Vec3d{c12[i], c20[i], c01[i]};
  return inverse;
}

}  // namespace carom::ballistics::detail
