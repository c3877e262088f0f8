// The shot near a guess, by Newton's and Broyden's methods.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

AimSolver::Root AimSolver::refine(Guess guess, int most, bool eager, bool near) const {
  Root root;
  Inverse inverse;
  const double allowed = options_.tolerance, away = math::length(target_(guess.time) - shooter_.muzzle);
  // Most of the way paths are rough: they follow the steps of the first one that is good to a few 10^-5 of the way,
  // and so all err alike. One fine path then tells by how much, and rough ones are flown at a target that is off by
  // that. What the fine one errs adds up: bends of drag curves and layers of wind pass the estimate unseen.
  const double fine = 0.1 * allowed / (1 + 0.25 * guess.time), rough = math::max(4e-5 * away, fine);
  Schedule schedule;
  double accuracy = near ? fine : math::max(0.02 * away, rough);
  double last_accuracy = accuracy, last_missed = 1e300, first_missed = 1e300, last_both = 1e300;
  Vec3d last_u{}, last_x{}, off{}, fine_u{};  // off: fine less rough
  bool corrected = near;
  double contraction = 0.1;  // of the miss by a step of Newton's method
  double last_time = 0;
  for (int i = 0; i < most; ++i) {
    const bool recorded = schedule.count > 0 && schedule.count <= Schedule::most;
    Arrival end = recorded ? follow(guess.u, guess.time, schedule)
                           : propagate(guess.u, guess.time, accuracy, accuracy <= rough ? &schedule : nullptr);
    end.position += off;
    const Vec3d place = target_(guess.time);
    Vec3d miss = place - end.position;
    if (i == 0) {
      inverse = estimate(guess, end);
    } else {  // what the change of u alone did to the arrival, where that is more than what integration errs
      const Vec3d moved = end.position - last_x - (guess.time - last_time) * end.velocity;
      if (recorded || math::length_squared(moved) > math::square(10 * (accuracy + last_accuracy)))
        update(inverse, guess.u - last_u, moved);
    }
    last_u = guess.u;
    last_time = guess.time;
    last_accuracy = accuracy;
    const Vec3d barrel = guess.u - shooter_.velocity;
    const double speed = math::length(barrel), lack = shooter_.muzzle_speed - speed;
    double missed = math::length(miss);
    if (!math::is_finite(missed)) return root;
    bool turned = false;  // from rough to fine
    if (corrected && !near && math::length(guess.u - fine_u) * guess.time > 10 * rough) corrected = false;
    // Near enough that the fine path errs by as much here as where it will hit.
    if (accuracy <= rough && !corrected && missed < 5 * rough && math::abs(lack) * guess.time < 5 * rough) {
      const Arrival best = propagate(guess.u, guess.time, fine);
      off += best.position - end.position;
      corrected = turned = true;
      fine_u = guess.u;
      end = best;
      miss = place - end.position;
      missed = math::length(miss);
    }
    last_x = end.position;
    const Vec3d d = barrel / speed, drift = velocity_of_target(guess.time) - end.velocity;
    const Vec3d to_miss = inverse.apply(miss), to_drift = inverse.apply(drift);
    const double slope = math::dot(d, to_drift);
    if (!math::is_finite(missed) || !math::is_finite(slope) || slope == 0) return root;
    if (corrected && math::abs(lack) * guess.time < allowed && missed < allowed) {
      root = {true, slope, guess, end};
      root.guess.u = shooter_.velocity + shooter_.muzzle_speed * d;
      return root;
    }
    // A correction that the last ones say will land: it is not flown.
    const double both = missed + math::abs(lack) * guess.time;
    if (!turned && i > 0) contraction = math::clamp(both / last_both, 0.02, 1.0);
    const bool lands = i > 0 && corrected && !turned && both < 30 * allowed && contraction * both < 0.25 * allowed;
    last_both = both;
    // The next miss is some tenth of this one: then integration may err a tenth of that.
    accuracy = math::min(accuracy, math::max(0.02 * math::min(missed, last_missed), rough));
    if (accuracy < 4 * rough) accuracy = rough;
    if (i == 0) first_missed = missed;
    if (eager && i >= 4 && missed > 0.2 * first_missed) return root;
    last_missed = missed;
    double dt = (lack - math::dot(d, to_miss)) / slope;
    dt = math::clamp(dt, -0.5 * guess.time, guess.time);
    Vec3d du = to_miss + dt * to_drift;
    const double longest = shooter_.muzzle_speed;
    if (math::length(du) > longest) du *= longest / math::length(du);
    guess.u += du;
    guess.time += dt;
    if (!(guess.time > 1e-9) || guess.time > 2 * options_.longest_time) return root;
    if (lands) {
      const Vec3d aimed = guess.u - shooter_.velocity;
      root = {true, slope, guess, {target_(guess.time), end.velocity}};
      root.guess.u = shooter_.velocity + (shooter_.muzzle_speed / math::length(aimed)) * aimed;
      return root;
    }
  }
  return root;
}

AimSolver::Need AimSolver::need(Guess& guess) const {
  const double enough = 1e-4 * shooter_.muzzle_speed * guess.time + 1e-3, accuracy = 0.05 * enough;
  Inverse inverse;
  Vec3d last_u{}, last_x{}, best_u = guess.u, best_miss{};
  double best = 1e300, part = 1;
  for (int i = 0; i < 40; ++i) {
    const Arrival end = propagate(guess.u, guess.time, i < 8 ? accuracy : 0.1 * accuracy);
    const Vec3d miss = target_(guess.time) - end.position;
    const double speed = math::length(guess.u - shooter_.velocity), missed = math::length(miss);
    if (!math::is_finite(speed)) return {};
    if (missed < enough) return {true, shooter_.muzzle_speed - speed};
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
