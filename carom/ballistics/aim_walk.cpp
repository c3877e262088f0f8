// Where the target passes the surface that shots reach, however it moves: walks through the flight times from both
// ends.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

// Over the whole way between two looks, lest it leap, and at the later one, lest it turn back between them.
double AimSolver::Looks::pace(int look) {
  double& pace = paces_[look];
  if (pace < 0) {
    const double time = solver_.time_of_look(look), h = 1e-4 * time;
    const Vec3d here = place(look), way = here - place(look - 1);
    pace = math::max(math::length(way) / (time - solver_.time_of_look(look - 1)),
                     math::length(solver_.target_(time + h) - here) / h);
  }
  return pace;
}

Vec3d AimSolver::Looks::place(int look) {
  if (!known_[look]) places_[look] = solver_.target_(solver_.time_of_look(look));
  known_[look] = true;
  return places_[look];
}

bool AimSolver::between(Reach a, Reach b, Trail& trail, Aims& aims) const {
  const double first = math::min(a.guess.time, b.guess.time), last = math::max(a.guess.time, b.guess.time);
  const double margin = 0.02 * (last - first) + 2e-3 * last;  // gaps are known to about 1e-3
  for (int i = 0; i < 24; ++i) {
    const double chord = a.gap / (a.gap - b.gap), share = i % 3 == 2 ? 0.5 : math::clamp(chord, 0.1, 0.9);
    const double time = a.guess.time + share * (b.guess.time - a.guess.time);
    const Guess guess = toward(share < 0.5 ? a : b, time);
    const Root root = refine_along(guess, a.scale, trail, 40, false);
    if (root.found && root.guess.time > first - margin && root.guess.time < last + margin) {
      keep(aims, root);
      return true;
    }
    const Reach at = reach_nearest(guess, &trail);
    if (!at.known) return false;
    ((at.gap > 0) == (a.gap > 0) ? a : b) = at;
  }
  return false;
}

AimSolver::Root AimSolver::refine_along(const Guess& guess, double scale, Trail& trail, int most, bool eager) const {
  const bool known = trail.known && bring(guess, rough_reach * scale, trail.path);
  const Root root = refine(guess, most, eager, false, known ? &trail.path : nullptr);
  trail.known = known && root.found;
  return root;
}

// The gap changes by no more than the target and the surface move: so long a step leaves it on its side of the surface.
void AimSolver::walk(double from, double to, Looks& at_looks, Aims& aims) const {
  const double side = to > from ? 1 : -1;
  // Of the time: from step to step a shot's speed changes little more; a passing touch may be as short as the least.
  const double longest_step = side > 0 ? 0.4 : 0.25;
  Guess guess = straight(from);
  Reach before;
  Trail trail;
  double foretold = 0;     // s, when the gap would close, by the look before
  double refused = 1e300;  // s, how far ahead that was where it was not so
  for (int i = 0; i < 1000; ++i) {
    const double time = guess.time;
    Reach at = reach_nearest(guess, &trail);
    if (at.known && !at.settled()) {  // it does not find there from the shot before
      at = reach_nearest(straight(time), &trail);
      at.known = at.known && at.settled();
    }
    if (at.known && before.known && (before.gap > 0) != (at.gap > 0) && between(before, at, trail, aims)) return;
    // Longer the longer it takes, so that a target that stays beside the surface does not hold it up.
    const double least_step = (at.known ? 4e-3 : 2e-2) * (1 + 0.01 * i);
    double step = least_step * time;
    if (at.known) {
      const double ahead = -side * at.gap / at.rate, closes = time + side * ahead;
      if (ahead > 0 && ahead < math::min((side > 0 ? 0.5 : 0.25) * time, 0.6 * refused) &&
          math::abs(closes - foretold) < 0.3 * ahead) {
        if (soon(at, closes, trail, aims)) return;
        refused = ahead;
      }
      foretold = closes;
      // Where drag is strong speeds fall as the inverse of the time.
      const double shots = math::max(math::length(velocity_of_shot(at)), 0.5 * fall_speed_) * (side > 0 ? 1 : 1.3);
      const double far = longest_step * time;
      double most = 0;
      for (int look = 1; look <= looks; ++look)
        if (time_of_look(look) >= time - far && time_of_look(look - 1) <= time + far)
          most = math::max(most, at_looks.pace(look));
      step = math::clamp(0.8 * math::abs(at.gap) / (shots + most), step, math::max(step, far));
    }
    if (time == to) return;
    before = at;
    double next = time + side * step;
    if (side * (to - next) < 0) next = to;
    guess = at.known ? toward(at, next) : straight(next);
  }
}

bool AimSolver::soon(const Reach& at, double time, Trail& trail, Aims& aims) const {
  const double from = at.guess.time, ahead = math::abs(time - from);
  const Root root = refine_along(toward(at, time), at.scale, trail, 14, true);
  if (!root.found || math::abs(root.guess.time - time) > 0.3 * ahead + 1e-3 * from) return false;
  if ((root.slope < 0) != ((at.gap > 0) == (time > from))) return false;  // that is where it comes back
  if (ahead > 0.05 * from) {
    const Reach halfway = reach_nearest(toward(at, 0.5 * (from + root.guess.time)), &trail);
    if (!halfway.known || math::abs(halfway.gap - 0.5 * at.gap) > 0.1 * math::abs(at.gap)) return false;
  }
  keep(aims, root);
  return true;
}

double AimSolver::before_any(Looks& at_looks) const {
  const double g = conditions_.gravity, fastest = shooter_.muzzle_speed + math::length(shooter_.velocity) +
                                                  math::length(conditions_.wind.at(shooter_.muzzle.y));
  for (int look = 1; look <= looks; ++look) {
    const double time = time_of_look(look - 1), next = time_of_look(look);
    const double away = math::length(at_looks.place(look - 1) - shooter_.muzzle) - time * (fastest + 0.5 * g * time);
    const double pace = math::max(at_looks.pace(look), at_looks.pace(math::min(look + 1, looks)));
    const double first = time + 0.8 * away / (fastest + g * next + pace);
    if (!(first > next)) return math::max(first, time);
  }
  return options_.longest_time;
}

void AimSolver::scan(Aims& aims) const {
  Looks at_looks(*this);
  const double longest = options_.longest_time;
  walk(math::clamp(before_any(at_looks), math::min(1e-4, longest), longest), longest, at_looks, aims);
  if (options_.high_arc && aims.low) walk(longest, math::max(aims.low->time, 1e-4), at_looks, aims);
}

}  // namespace carom::ballistics::detail
