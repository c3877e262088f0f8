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
  trail.spread = false;
  const Root root = refine(guess, most, eager, false, known ? &trail.path : nullptr);
  trail.known = known && root.found;
  return root;
}

AimSolver::Reach AimSolver::on_the_way(Trail& trail, double time) const {
  if (!trail.spread) return {};
  const Vec3d target = target_(time);
  Reach at = along(trail, time, target);
  // What lies beyond the plane that touches the surface lies beyond the surface.
  const double gap = at.gap > 0 ? at.plane : -at.gap;
  at.known = at.known && at.bulge <= (at.gap > 0 ? 1.0 : 0.15) * gap;
  settle(trail, target, at);
  at.known = at.known && at.told();
  return at;
}

// Where drag is strong speeds fall as the inverse of the time.
double AimSolver::safe_step(double time, double side, double room, double shots, double least, Looks& at_looks) const {
  const double longest = options_.longest_time;
  const auto step = [&](double share, double faster) {
    const double far = share * time, begin = side > 0 ? time : time - far,
                 end = math::min(side > 0 ? time + far : time, longest);
    const double by_time = looks / math::sqrt(longest);
    const int first = math::max(1, int(by_time * math::sqrt(begin))),
              last = math::min(looks, int(by_time * math::sqrt(end)) + 1);
    double most = 0;
    for (int look = first; look <= last; ++look) {
      most = math::max(most, at_looks.pace(look));
      if (room < least * (faster * shots + most)) return 0.0;
    }
    return math::min(far, room / (faster * shots + most));
  };
  if (side > 0) return step(0.4, 1);
  if (room > 0.5 * time * 1.4 * shots)
    if (const double far = step(0.5, 1.4); far == 0.5 * time) return far;
  return step(0.25, 1.3);
}

// The gap changes by no more than the target and the surface move: so long a step leaves it on its side of the surface.
void AimSolver::walk(const Guess& from, double to, Looks& at_looks, Trail& trail, Aims& aims) const {
  const double side = to > from.time ? 1 : -1;
  double time = from.time;
  Reach before;
  double refused = 1e300;  // s, how far ahead that was where it was not so
  for (int i = 0; i < 1000; ++i) {
    Reach at = on_the_way(trail, time);
    if (!at.known) {
      const Guess guess = i == 0 ? from : before.known ? toward(before, time) : straight(time);
      if (side > 0) trail.horizon = math::max(trail.horizon, math::min(1.5 * time, to));
      at = reach_nearest(guess, &trail);
    }
    if (at.known && !at.settled() && !(at.plane > 0)) {  // it does not find there from the shot before
      at = reach_nearest(straight(time), &trail);
      at.known = at.known && at.settled();
    }
    if (at.known && before.known && (before.gap > 0) != (at.gap > 0) && between(before, at, trail, aims)) return;
    // Longer the longer it takes, so that a target that stays beside the surface does not hold it up.
    const double least_step = (at.known ? 4e-3 : 2e-2) * (1 + 0.01 * i);
    double step = least_step * time;
    if (at.known) {
      const double ahead = -side * at.gap / at.rate, closes = time + side * ahead;
      if (ahead > 0 && ahead < 0.6 * refused) {
        if (soon(at, closes, trail, aims)) return;
        if (!trail.spread) refused = ahead;
      }
      const double room = 0.8 * (at.gap > 0 ? math::min(at.gap, math::max(at.plane, 0.5 * at.gap)) : -at.gap);
      const double shots = math::max(math::length(at.velocity), 0.5 * fall_speed_);
      step = math::max(step, safe_step(time, side, room, shots, step, at_looks));
    }
    if (time == to) return;
    before = at;
    time += side * step;
    if (side * (to - time) < 0) time = to;
  }
}

// A target that weaves would show at one of the looks on the way: they are the closer together, and the less allows
// them, the less of the gap is left.
bool AimSolver::soon(const Reach& at, double time, Trail& trail, Aims& aims) const {
  const double from = at.guess.time, side = time > from ? 1 : -1, most = 0.5 * from;
  double ahead = side * (time - from);
  if (!(ahead < most)) return false;
  const auto look = [&](double then, bool moving) { return along(trail, then, target_(then), moving); };
  Reach there = look(time, true);
  for (int i = 0; i < 3 && there.known && math::abs(there.gap) > 0.06 * math::abs(at.gap); ++i) {
    time = there.guess.time - there.gap / there.rate;
    if (!(side * (time - from) > 0 && side * (time - from) < most)) return false;
    there = look(time, true);
  }
  if (!there.known || there.bulge > 0.1 * at.scale || math::abs(there.gap) > 0.06 * math::abs(at.gap)) return false;
  time = there.guess.time - there.gap / there.rate;
  ahead = side * (time - from);
  if (!(ahead > 0 && ahead < most)) return false;
  if (ahead > 0.05 * from) {
    for (const double share : {0.4, 0.7, 0.85, 0.93, 0.97}) {
      const Reach between = look(from + share * (time - from), false);
      const double left = (1 - share) * at.gap;
      if (!between.known || math::abs(between.gap - left) > 0.6 * math::abs(left)) return false;
    }
  }
  // That is where the walk is to end.
  if (at.gap < 0 && aims.low && math::abs(time - aims.low->time) < 0.01 * ahead) return true;
  const Root root = refine_along(toward(there, time), at.scale, trail, 14, true);
  if (!root.found || math::abs(root.guess.time - time) > 0.3 * ahead + 1e-3 * from) return false;
  if ((root.slope < 0) != ((at.gap > 0) == (time > from))) return false;  // that is where it comes back
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

// The highest shots come down the faster the longer they fall, until drag balances their weight.
AimSolver::Guess AimSolver::after_any(Looks& at_looks, Trail& trail) const {
  const double longest = options_.longest_time;
  const Guess steep = steep_guess(), last = straight(longest);
  const double share = 1.1 * steep.time / longest;
  if (!(share > 0 && share < 1)) return last;
  const int first = math::min(int(looks * math::sqrt(share)) + 1, looks);
  const double time = time_of_look(first);
  const Vec3d target = at_looks.place(first);
  const Reach at = reach({steep.u, time}, target, &trail);
  if (!at.known || at.normal.y < 0.8) return last;
  const double top = target.y - at.way.y + at.radius + 0.03 * at.scale,
               falls = 0.5 * math::min(-at.velocity.y, fall_speed_);
  if (!(falls > 0)) return last;
  for (int look = looks; look > first; --look) {
    const double begin = time_of_look(look - 1), lasts = time_of_look(look) - begin;
    const double lowest =
        math::min(at_looks.place(look - 1).y, at_looks.place(look).y) - 0.5 * lasts * at_looks.pace(look);
    if (!(lowest > top - falls * (begin - time))) return straight(time_of_look(look));
  }
  return {steep.u, time};
}

void AimSolver::scan(Aims& aims) const {
  Looks at_looks(*this);
  Trail trail;
  const double longest = options_.longest_time,
               first = math::clamp(before_any(at_looks), math::min(1e-4, longest), longest);
  bool far = false;
  const Guess flat = flat_guess(far);
  Guess from = straight(first);
  if (!far && flat.time > first && flat.time < longest) {
    from.u = shooter_.velocity + shooter_.muzzle_speed * math::normalize(flat.u - shooter_.velocity);
    trail.horizon = math::min(1.1 * flat.time, longest);
  }
  walk(from, longest, at_looks, trail, aims);
  if (!options_.high_arc || !aims.low) return;
  trail.known = trail.spread = false;
  trail.horizon = 0;
  walk(after_any(at_looks, trail), math::max(aims.low->time, 1e-4), at_looks, trail, aims);
}

}  // namespace carom::ballistics::detail
