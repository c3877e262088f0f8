// The shot near a guess, by Newton's and Broyden's methods.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

namespace {

bool none_carries(const FlightPath& path, double too_much) {
  for (int n = 0; n < path.count; ++n)
    if (path.carried(n) > too_much) return false;
  return true;
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
  const Vec3d miss = target_(guess.time) - end.position, barrel = guess.u - shooter_.velocity;
  const double speed = math::length(barrel), lack = shooter_.muzzle_speed - speed, missed = math::length(miss);
  const Vec3d d = barrel / speed, drift = velocity_of_target(guess.time) - end.velocity;
  const Vec3d to_miss = inverse.apply(miss), to_drift = inverse.apply(drift);
  to.slope = math::dot(d, to_drift);
  to.known = math::is_finite(missed) && math::is_finite(to.slope) && to.slope != 0;
  to.missed = missed + math::abs(lack) * guess.time;
  to.dt = math::clamp((lack - math::dot(d, to_miss)) / to.slope, -0.5 * guess.time, guess.time);
  to.du = to_miss + to.dt * to_drift;
  const double longest = shooter_.muzzle_speed;
  if (math::length(to.du) > longest) to.du *= longest / math::length(to.du);
  const double end_speed = math::length(end.velocity), time = guess.time + to.dt;
  to.scale = math::max(math::length(target_(guess.time) - shooter_.muzzle), 0.5 * end_speed * guess.time);
  to.moved = math::length(to.du) * time + end_speed * math::abs(to.dt) + path.leaps;
  // Derivatives are known to a few thousandths, and what is left is as the square of the way.
  // The leap of a wind profile at its beginning they do not know.
  to.left = to.moved * ((path.lands ? 0.1 : 6e-3) + 3 * to.moved / to.scale);
  return to;
}

AimSolver::Root AimSolver::refine(Guess guess, int most, bool eager, bool falling) const {
  Root root;
  Path path;
  const double allowed = options_.tolerance, away = math::length(target_(guess.time) - shooter_.muzzle);
  // A rough flight from the guess; then that path itself is moved, all of it at once, until it is a flight that hits:
  // in the few elements of that flight, then in as many as the tolerance wants, at last by more points of them.
  double rough = math::min(2e-5 * math::length(guess.u) * guess.time, 75 * allowed);
  double accuracy = math::max(0.02 * away, rough);
  double last_missed = 1e300, first_missed = 1e300, piece = 16 * allowed;
  int divisions = 0;
  enum class Stage { fly, rough, fine, measured } stage = Stage::fly;
  for (int i = 0; i < most; ++i) {
    if (stage == Stage::fly) {
      if (!record(guess, accuracy, path, i == 0 && falling)) {
        if (path.count < Path::most) return root;
        rough *= 4;  // too many steps
        accuracy *= 4;
        continue;
      }
      guess.time = path.time();
      stage = Stage::rough;
    }
    linearize(path, stage == Stage::measured);
    Newton to = newton(path, guess);
    bool fine = stage == Stage::measured && (divisions > 6 || none_carries(path, 300 * allowed));
    if (fine && to.left < allowed) {
      measure(path);
      to = newton(path, guess);
      fine = (path.steep < allowed && (!path.bends || all_carry(path) < 100 * allowed)) || divisions > 6;
      if (!fine) piece *= 0.1;
    }
    if (!to.known) return root;
    guess.u += to.du;
    guess.time += to.dt;
    if (!(guess.time > 1e-9) || guess.time > 2 * options_.longest_time) return root;
    if (fine && to.left < allowed) {
      const Vec3d aimed = guess.u - shooter_.velocity, end = path.arrival.velocity;
      root = {true, to.slope, guess, {target_(guess.time), end + to.dt * Path::at(path.k, path.count)}};
      root.guess.u = shooter_.velocity + (shooter_.muzzle_speed / math::length(aimed)) * aimed;
      return root;
    }
    if (eager && i >= 4 && to.missed > 0.2 * first_missed) return root;
    if (i == 0) first_missed = to.missed;
    if (to.moved > 1.2 * to.scale || to.missed > last_missed) {
      stage = Stage::fly;
      accuracy = math::max(0.02 * math::min(to.moved, to.scale), rough);
      last_missed = 1e300;
      continue;
    }
    move(path, to.du, to.dt);
    last_missed = to.missed;
    if (stage == Stage::fine) {
      stage = Stage::measured;
    } else if (stage == Stage::measured ? !fine : to.moved < 0.05 * to.scale) {
      const double bend = speed_of_a_bend(rough / (math::length(guess.u) * guess.time));
      divide(path, piece, bend);
      ++divisions;
      if (stage == Stage::rough) stage = to.moved < 1e-3 * to.scale ? Stage::measured : Stage::fine;
      last_missed = 1e300;
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

AimSolver::Need AimSolver::need(Guess& guess) const {
  const double enough = 1e-4 * shooter_.muzzle_speed * guess.time + 1e-3, accuracy = 0.05 * enough;
  Inverse inverse;
  Vec3d last_u{}, last_x{}, best_u = guess.u, best_miss{};
  const double away = math::length(target_(guess.time) - shooter_.muzzle);
  double best = 1e300, part = 1, missed = away;
  for (int i = 0; i < 40; ++i) {
    const double roughly = i < 8 ? math::max(accuracy, 0.02 * missed) : 0.1 * accuracy;
    const Arrival end = propagate(guess.u, guess.time, roughly);
    const Vec3d miss = target_(guess.time) - end.position;
    const double speed = math::length(guess.u - shooter_.velocity);
    missed = math::length(miss);
    if (!math::is_finite(speed)) return {};
    if (missed < enough && roughly <= 4 * accuracy) return {true, shooter_.muzzle_speed - speed};
    if (speed > 4 * shooter_.muzzle_speed && i > 2) return {true, shooter_.muzzle_speed - speed};
    // Secants while they serve; then the derivatives themselves, and shorter steps where one did not help.
    const bool better = missed < best || i == 8;
    if (i == 0)
      inverse = estimate(guess, end);
    else if (i < 8)
      update(inverse, guess.u - last_u, end.position - last_x);
    else if (better)
      inverse = derivatives(guess, end, 0.1 * accuracy);
    last_u = guess.u;
    last_x = end.position;
    if (better || i <= 8) {
      best = missed;
      best_u = guess.u;
      best_miss = miss;
      part = 1;
    } else {
      part *= 0.4;
    }
    Vec3d du = part * inverse.apply(best_miss);
    // Far more than the gun has, or less, and there is no doubt of it.
    const double doubt = 2 * math::length(du), far = math::max(away, 0.1 * speed * guess.time);
    if (i > 0 && i < 8 && missed < 0.05 * far &&
        (speed - doubt > 1.5 * shooter_.muzzle_speed || speed + doubt < 0.95 * shooter_.muzzle_speed))
      return {true, shooter_.muzzle_speed - speed};
    const double most = 0.5 * speed + 0.5 * shooter_.muzzle_speed;
    if (math::length(du) > most) du *= most / math::length(du);
    guess.u = best_u + du;
  }
  return {};
}

AimSolver::Inverse AimSolver::estimate(const Guess& guess, const Arrival& end) const {
  const Vec3d fall{0, -0.5 * conditions_.gravity * guess.time * guess.time, 0};
  const double speed = math::length(guess.u), flown = math::length(end.position - shooter_.muzzle - fall);
  const double across = math::clamp(flown / math::max(speed, 1e-9), 1e-3 * guess.time, guess.time);
  const double along =
      math::clamp(guess.time * math::length(end.velocity) / math::max(speed, 1e-9), 1e-3 * guess.time, guess.time);
  const Vec3d e = speed > 0 ? guess.u / speed : Vec3d{1, 0, 0};
  const double extra = 1 / along - 1 / across;
  Inverse inverse;
  for (int i = 0; i < 3; ++i) {
    inverse.row[i] = (extra * e[i]) * e;
    inverse.row[i][i] += 1 / across;
  }
  return inverse;
}

AimSolver::Inverse AimSolver::derivatives(const Guess& guess, const Arrival& end, double accuracy) const {
  const double h = 1e-3 * math::max(math::length(guess.u), 0.1 * shooter_.muzzle_speed);
  Vec3d column[3];
  for (int i = 0; i < 3; ++i) {
    Vec3d u = guess.u;
    u[i] += h;
    column[i] = (propagate(u, guess.time, 0.05 * accuracy).position - end.position) / h;
  }
  const Vec3d c12 = math::cross(column[1], column[2]);
  const double determinant = math::dot(column[0], c12);
  if (!(math::abs(determinant) > 0)) return estimate(guess, end);
  return {{c12 / determinant, math::cross(column[2], column[0]) / determinant,
           math::cross(column[0], column[1]) / determinant}};
}

void AimSolver::update(Inverse& inverse, Vec3d du, Vec3d dx) {
  const Vec3d given = inverse.apply(dx);
  const double scale = math::dot(du, given);
  if (!(math::abs(scale) > 1e-3 * math::length_squared(du)) || !math::is_finite(scale)) return;
  const Vec3d right = inverse.apply_transposed(du) / scale, error = du - given;
  for (int i = 0; i < 3; ++i) inverse.row[i] += error[i] * right;
}

bool AimSolver::bisect(Guess a, const Need& at_a, Guess b, Aims& aims) const {
  const double first = math::min(a.time, b.time), last = math::max(a.time, b.time);
  const double margin = 0.02 * (last - first) + 2e-3 * last;  // what is known of the ends is known to about 1e-3
  for (int i = 0; i < 24; ++i) {
    Guess middle{0.5 * (a.u + b.u), 0.5 * (a.time + b.time)};
    const Need at = need(middle);
    if (!at.known) return false;
    const Root root = i < 2 ? Root{} : refine(middle);
    if (root.found && root.guess.time > first - margin && root.guess.time < last + margin) {
      keep(aims, root);
      return true;
    }
    ((at.lack < 0) == (at_a.lack < 0) ? a : b) = middle;
  }
  return false;
}

void AimSolver::touch(Guess a, Guess peak, double at_peak, Guess b, Aims& aims) const {
  for (int i = 0; i < 24; ++i) {
    const bool left = peak.time - a.time > b.time - peak.time;
    Guess probe{peak.u, 0.5 * ((left ? a.time : b.time) + peak.time)};
    const Need here = need(probe);
    if (!here.known) return;
    if (here.lack >= 0) {
      bisect(a, {true, -1}, probe, aims);
      bisect(probe, here, b, aims);
      return;
    }
    if (here.lack > at_peak) {
      (left ? b : a) = peak;
      peak = probe;
      at_peak = here.lack;
    } else {
      (left ? a : b) = probe;
    }
  }
}

}  // namespace carom::ballistics::detail
