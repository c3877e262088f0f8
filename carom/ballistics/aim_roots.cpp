// The shot near a guess, by Newton's and Broyden's methods.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

AimSolver::Root AimSolver::refine(Guess guess, int most, bool eager, Start start) const {
  Root root;
  Path path;
  Inverse inverse;
  const double allowed = options_.tolerance, away = math::length(target_(guess.time) - shooter_.muzzle);
  // Rough paths as long as Newton's method has far to go. Then one whose own error is measured, step by step; what
  // little is left from there on is found by flying the same steps again, each corrected by what it was found to miss.
  double rough = math::min(2e-5 * math::length(guess.u) * guess.time, 75 * allowed);
  double accuracy = start == Start::near ? rough : math::max(0.02 * away, rough), last_both = 1e300, first_both = 1e300;
  double off = 0, last_off = 0;  // m, what the last measured paths erred
  const double finest = rough / 64;
  Vec3d last_u{}, last_x{};
  double last_time = 0;
  // secant: Broyden's updates, from the closed form; recorded: with the derivatives; plain: Broyden's updates of those;
  // measured: with what it errs; again: by the corrected steps of that one; checked: and measured once more.
  enum class Way { secant, recorded, plain, measured, again, checked };
  Way way = start == Start::near ? Way::measured : eager ? Way::secant : Way::recorded;
  const auto correct = [&](Arrival& end) {
    const Vec3d more = measure(path, 0.8 * allowed);
    last_off = off;
    end.position += more;
    off = math::length(more);
  };
  for (int i = 0; i < most; ++i) {
    Arrival end;
    if (way == Way::again || way == Way::checked) {
      end = follow(guess.u, guess.time, path);
      if (way == Way::checked) correct(end);
    } else if (way == Way::plain || way == Way::secant) {  // as good as recorded on flat paths, and half the work
      end = propagate(guess.u, guess.time, accuracy);
      if (i == 0)
        inverse = estimate(guess, end);
      else
        update(inverse, guess.u - last_u, end.position - last_x - (guess.time - last_time) * end.velocity);
    } else {
      if (!record(guess.u, guess.time, accuracy, path, i == 0 && start == Start::falling)) {
        if (path.count < Path::most) return root;
        rough *= 4;  // too many steps
        accuracy *= 4;
        continue;
      }
      guess.time = path.node[path.count].t;
      sensitivities(path);
      inverse = inverse_of(path.by_velocity);
      end = path.arrival;
      if (way == Way::measured) {
        for (int n = 0; n < path.count; ++n) path.correction[n] = {};
        correct(end);
      }
    }
    last_u = guess.u;
    last_x = end.position;
    last_time = guess.time;
    const Vec3d miss = target_(guess.time) - end.position, barrel = guess.u - shooter_.velocity;
    const double speed = math::length(barrel), lack = shooter_.muzzle_speed - speed, missed = math::length(miss);
    const Vec3d d = barrel / speed, drift = velocity_of_target(guess.time) - end.velocity;
    const Vec3d to_miss = inverse.apply(miss), to_drift = inverse.apply(drift);
    const double slope = math::dot(d, to_drift), both = missed + math::abs(lack) * guess.time;
    if (!math::is_finite(missed) || !math::is_finite(slope) || slope == 0) return root;
    double dt = (lack - math::dot(d, to_miss)) / slope;
    dt = math::clamp(dt, -0.5 * guess.time, guess.time);
    Vec3d du = to_miss + dt * to_drift;
    const double longest = shooter_.muzzle_speed;
    if (math::length(du) > longest) du *= longest / math::length(du);
    const double scale =
        math::max(math::length(target_(guess.time) - shooter_.muzzle), 0.5 * math::length(end.velocity) * guess.time);
    guess.u += du;
    guess.time += dt;
    if (!(guess.time > 1e-9) || guess.time > 2 * options_.longest_time) return root;
    const double moved = math::length(du) * guess.time + math::length(end.velocity) * math::abs(dt);
    // Derivatives are known to a few thousandths, and the next miss is as the square of this one.
    const double share = way == Way::measured ? 3e-3 + 3 * moved / scale : math::clamp(both / last_both, 0.01, 1.0);
    const bool again = way == Way::again || way == Way::checked, known = way == Way::measured || again;
    // What is measured is known to a hundredth or better, and it errs as its square. Less well where wind or drag
    // bends, by every step's share of it: those of opposite sign are none the less in doubt. Shorter steps where wind
    // that changes steeply with height would feel what the heights within them are off.
    const double enough = path.layers ? finest : 16 * finest;  // flown roughly, drag tables of lines stay as rough
    const bool fine =
        rough <= finest || (path.steep < allowed && (!path.bends || path.total < 50 * allowed || rough <= enough));
    const bool trusted = fine && off < 0.5 * math::sqrt(allowed * scale);
    const double doubt = way == Way::again ? 0 : path.bends ? 0.05 * path.total : 0.005 * off;
    if (known && trusted && share * moved < allowed && doubt < 0.5 * allowed) {
      const double* pull = path.node[path.count].k;
      const Vec3d aimed = guess.u - shooter_.velocity;
      root = {true, slope, guess, {target_(guess.time), end.velocity + dt * Vec3d{pull[0], pull[1], pull[2]}}};
      root.guess.u = shooter_.velocity + (shooter_.muzzle_speed / math::length(aimed)) * aimed;
      return root;
    }
    if (eager && i >= 4 && both > 0.2 * first_both) return root;
    if (i == 0) first_both = both;
    if (known && !trusted) rough *= 0.25;
    // What a path errs hangs on where its steps lie in the bends of drag and wind: most of all where it is flat.
    const double alike = start == Start::falling ? 600 * allowed : 150 * allowed;
    const bool near_by = moved < math::min(alike, 1e-3 * scale) && moved * off < 1e-4 * alike * scale;
    if (known && trusted && moved < 5e-3 * scale &&
        (way == Way::measured || both < 0.3 * last_both || (way == Way::checked && off < 0.5 * last_off)))
      way = near_by && !path.bends ? Way::again : Way::checked;
    else if (known || way == Way::plain || moved < 0.01 * scale)
      way = Way::measured;
    else if (way == Way::recorded && moved < 0.15 * scale)
      way = Way::plain;
    else if (way != Way::secant || i > 2 || moved > 0.3 * scale)
      way = Way::recorded;
    if (way == Way::measured && moved > 0.15 * scale) way = Way::recorded;
    accuracy = way == Way::recorded || way == Way::secant ? math::max(0.005 * math::min(moved, scale), rough) : rough;
    last_both = both;
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
