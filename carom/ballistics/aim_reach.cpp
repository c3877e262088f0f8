// The surface that shots reach at a flight time: how near it comes to the target, and when the target passes it.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

// Shots of one muzzle speed that fly for a time T reach a closed surface around those that are slower: a ball in
// vacuum, nearly an ellipsoid with drag, with the normal J⁻ᵀ d where the barrel points along d and J = ∂x(T)/∂u. A
// target that lies beyond the plane that touches it there is out of reach at T. Over T the distance is convex as a
// rule: its rate is the speed of the target past the shot along the normal, and two or three flights find where it is
// least.

AimSolver::Reach AimSolver::reach(const Guess& guess, Vec3d target, Trail* trail) const {
  const double scale = scale_of(guess.time, target);
  Path own;
  Reach at;
  if (trail == nullptr) {
    at = reach(guess, target, 5e-3, own);
  } else {
    const Guess far{guess.u, math::max(guess.time, trail->horizon)};
    const auto spread_path = [&](bool flown, bool fine = false) {
      trail->spread = flown;
      trail->fine = fine;
      if (flown) spread(trail->path);
      at = along(*trail, guess.time, target);
    };
    if (trail->known && trail->path.count <= 40 && bring(far, rough_reach * scale, trail->path)) spread_path(true);
    if (!at.known) spread_path(record(far, rough_reach * scale, trail->path));
    settle(*trail, target, at);
    if (!at.known || !at.told()) spread_path(record(far, 5e-4 * scale, trail->path), true);
    trail->known = at.known;
  }
  if (!at.known || (trail == nullptr && math::abs(at.gap) < 0.03 * scale)) at = reach(guess, target, 5e-4, own);
  return at;
}

// As Newton's method moves it: what it owes falls as its square.
void AimSolver::settle(Trail& trail, Vec3d target, Reach& at) const {
  for (int i = 0; i < 2 && at.known && !at.told() && math::abs(at.gap) > 3e-3 * at.scale; ++i) {
    move(trail.path, {}, 0);
    spread(trail.path);
    at = along(trail, at.guess.time, target);
  }
}

AimSolver::Reach AimSolver::along(Trail& trail, double time, Vec3d target, bool moving) const {
  Path& path = trail.path;
  if (!trail.spread || time > path.time()) return {};
  const double scale = scale_of(time, target);
  int n = path.count - 1;
  while (n > 0 && path.t[n] > time) --n;
  const double h = path.t[n + 1] - path.t[n], s = (time - path.t[n]) / h, left = 1 - s;
  const Path::Spread &from = path.spread[n], &to = path.spread[n + 1];
  const double leaps = left * double(from.leaps) + s * double(to.leaps),
               carried = left * double(from.carried) + s * double(to.carried);
  if (!(leaps + carried < 0.5 * scale)) return {};
  path.flatten(n);
  const FlightElement flown(path, n);
  const float by_from = float(left * left * (1 + 2 * s)), by_to = float(s * s * (3 - 2 * s)),
              slope_from = float(h * s * left * left), slope_to = float(-h * s * s * left);
  Vec3d rows[3], position, velocity;
  for (int i = 0; i < 3; ++i) {
    float x[4];
    for (int j = 0; j < 4; ++j)
      x[j] = (by_from * from.x[i][j] + slope_from * from.v[i][j]) + (by_to * to.x[i][j] + slope_to * to.v[i][j]);
    rows[i] = {double(x[0]), double(x[1]), double(x[2])};
    position[i] = flown.place(i, s) + double(x[3]);
    if (moving) velocity[i] = flown.velocity(i, s) + left * double(from.v[i][3]) + s * double(to.v[i][3]);
  }
  Reach at = reach({Path::at(path.v, 0), time}, scale, target, position, rows);
  if (moving) {
    at.velocity = velocity;
    at.drift = (target_(time + 1e-4 * time) - target) / (1e-4 * time) - velocity;
    at.rate = math::dot(at.way, at.drift) / (at.radius + at.gap);
    at.known = at.known && math::is_finite(at.rate);
  }
  at.fine = trail.fine;
  at.owes = leaps + carried;
  return at;
}

// What is left then is of second order in the change.
bool AimSolver::bring(const Guess& guess, double allowed, Path& path) const {
  const double time = guess.time;
  move(path, guess.u - Path::at(path.v, 0), 0);
  if (time > path.time()) return record(guess, allowed, path, false, true);
  int n = path.count - 1;
  while (n > 0 && path.t[n] >= time) --n;
  if (time == path.t[n + 1]) return true;
  path.flatten(n);
  const FlightElement flown(path, n);
  const double s = (time - path.t[n]) / (2 * flown.half);
  path.put(n + 1, time, {flown.place(0, s), flown.place(1, s), flown.place(2, s)},
           {flown.velocity(0, s), flown.velocity(1, s), flown.velocity(2, s)}, {});
  path.count = n + 1;
  return true;
}

AimSolver::Reach AimSolver::reach(const Guess& guess, Vec3d target, double accuracy, Path& path) const {
  const double time = guess.time, scale = scale_of(time, target), speed = shooter_.muzzle_speed;
  if (!record(guess, accuracy * scale, path)) return {};
  linearize(path, false);
  Reach at = reach(guess, scale, target, path.arrival.position, path.by_velocity);
  const Vec3d later = target_(time + 1e-2 * time), velocity = (target_(time + 1e-4 * time) - target) / (1e-4 * time);
  const double distance = at.radius + at.gap;
  const Vec3d to = at.way / distance;
  at.velocity = path.arrival.velocity;
  at.drift = velocity - at.velocity;
  at.rate = math::dot(to, at.drift);
  const Vec3d pull = ((later - target) / (1e-2 * time) - velocity) / (0.5e-2 * time) - Path::at(path.k, path.count);
  at.bend = math::max(math::dot(to, pull) + math::length_squared(at.drift - at.rate * to) / distance,
                      math::max(0.3 * conditions_.gravity, 1e-4 * speed * speed / at.scale));
  at.known = at.known && math::is_finite(at.bend) && math::is_finite(at.rate);
  return at;
}

AimSolver::Reach AimSolver::reach(const Guess& guess, double scale, Vec3d target, Vec3d position,
                                  const Vec3d* rows) const {
  const double speed = shooter_.muzzle_speed;
  Reach at;
  at.guess = guess;
  at.scale = scale;
  at.inverse = inverse_of(rows);
  // Changes of u across the barrel move the arrival within the surface. The ball's curvature is the surface's mean one.
  const Vec3d across = at.inverse.apply_transposed((guess.u - shooter_.velocity) / speed);
  const double steep = math::length(across);
  const Vec3d miss = target - position;
  at.normal = across / steep;
  at.radius = speed * math::sqrt(math::abs(math::dot(rows[0], math::cross(rows[1], rows[2]))) * steep);
  at.way = miss + at.radius * at.normal;
  at.gap = math::length(at.way) - at.radius;
  at.plane = math::dot(at.normal, miss);
  at.bulge = math::abs(at.gap - at.plane);
  at.known = math::is_finite(at.gap);
  return at;
}

AimSolver::Guess AimSolver::toward(const Reach& at, double time) const {
  const Vec3d then = math::normalize(at.way + (time - at.guess.time) * at.drift);
  const Vec3d barrel =
      at.guess.u - shooter_.velocity + at.inverse.apply(at.radius * (then - math::dot(then, at.normal) * at.normal));
  return {shooter_.velocity + shooter_.muzzle_speed * math::normalize(barrel), time};
}

AimSolver::Reach AimSolver::reach_nearest(const Guess& guess, Trail* trail) const {
  const Vec3d target = target_(guess.time);
  Reach at = reach(guess, target, trail);
  for (int i = 0; i < 6 && at.known && !at.settled(); ++i) at = reach(toward(at, guess.time), target, trail);
  return at;
}

AimSolver::Nearest AimSolver::nearest(double time) const {
  const double away = math::length(target_(0) - shooter_.muzzle), longest = options_.longest_time;
  const Guess first = straight(math::min(math::min(time, math::sqrt(1.6 * away / conditions_.gravity)), longest));
  Nearest found = nearest_from(first);
  // What seemed to be within, by a ball that is far from it, is looked at again.
  if (found.sure && found.gap > 0 && found.doubtful.time > 0) {
    const Reach at = reach_nearest(found.doubtful);
    const Nearest other = at.known ? nearest_from(at.guess) : Nearest{};
    if (other.sure && other.gap < found.gap) found = other;
  }
  // There may be a nearer place elsewhere: where winds bend the surface, or where the target turns.
  const auto look = [&](double at) {
    if (!found.sure || found.gap < 0) return;
    const Nearest other = nearest_from(straight(at));
    if (!other.sure || other.gap < found.gap) found = other;
  };
  if (found.sure && found.gap < (layered_ ? 0.15 : 0.03) * found.at.scale) look(0.7 * found.time);
  const Vec3d turns = velocity_of_target(longest) - velocity_of_target(0);
  if (math::length(turns) > 1e-6 * shooter_.muzzle_speed)
    for (const double share : {0.125, 0.25, 0.5, 1.0}) look(share * longest);
  return found;
}

AimSolver::Nearest AimSolver::nearest_from(Guess guess) const {
  const double longest = options_.longest_time;
  Nearest found;
  double early = 0, late = 1e300, closing = 0, opening = 0;  // s, m/s: between them the gap is least
  double before = 1e300;
  for (int i = 0; i < 16; ++i) {
    const Reach at = reach(guess, target_(guess.time));
    if (!at.known) return found;
    const double time = guess.time;
    (at.rate < 0 ? early : late) = time;
    (at.rate < 0 ? closing : opening) = at.rate;
    double next = time - at.rate / at.bend;
    if (early > 0 && late < 1e300)
      next = math::clamp(early + (late - early) * closing / (closing - opening), 0.95 * early + 0.05 * late,
                         0.05 * early + 0.95 * late);
    const double wanted = next;
    next = math::clamp(next, 0.4 * time, math::min(2.5 * time, longest));
    const double dt = next - time, least = at.gap + dt * (at.rate + 0.5 * at.bend * dt);
    const double change = math::abs(least - before);
    const bool within = at.gap < -0.02 * at.scale && at.bulge < -0.4 * at.gap;
    if (at.gap < 0) found.doubtful = guess;
    found.at = at;
    found.time = within && at.gap < least ? time : next;
    found.gap = within ? math::min(at.gap, least) : least;
    // What is foretold from far away tells little.
    const bool near = wanted > 0.5 * time && wanted < 1.6 * time;
    found.sure = within || (near && change < 0.25 * math::abs(least)) || change < 2e-4 * at.scale;
    if (found.sure) return found;
    before = least;
    guess = toward(at, next);
  }
  return found;
}

bool AimSolver::by_nearest(Aims& aims, const Nearest& nearest, const Root& late) const {
  if (!nearest.sure) return false;
  const Reach& at = nearest.at;
  const double edge = 1e-3 * at.scale;
  if (nearest.gap > edge) return true;
  // What is nearer than it can be known is hit where Newton's method says so.
  if (nearest.gap > -edge) {
    const Root touch = refine(toward(at, nearest.time));
    if (!touch.found) return nearest.gap > 0;
    keep(aims, touch);
  }
  // By the parabola that is foretold.
  const double way = math::sqrt(2 * math::max(-nearest.gap, edge) / at.bend), peak = at.guess.time - at.rate / at.bend;
  for (const double side : {-1.0, 1.0}) {
    if (side > 0 && !options_.high_arc && aims.low) break;
    if (side > 0 && late.found && late.guess.time > nearest.time) {
      keep(aims, late);
      continue;
    }
    Root root;
    bool beside = false;
    // Where both roots are close together, Newton's method may step over both: it begins farther out then.
    for (double far = way; !beside && far < 5 * way; far *= 2) {
      const double time = math::clamp(peak + side * far, 0.4 * nearest.time, 2 * nearest.time);
      root = refine(toward(at, time));
      beside = root.found && side * root.slope > 0 && (far > way || side * (root.guess.time - nearest.time) > 0);
    }
    if (beside) {
      keep(aims, root);
      continue;
    }
    Reach inside = reach_nearest(toward(at, nearest.time)), outside = inside;
    if (!inside.known || inside.gap > 0) return false;
    while (outside.gap <= 0) {
      inside = outside;
      const double next = inside.guess.time * (side > 0 ? 1.3 : 1 / 1.3);
      if (next > 1.3 * options_.longest_time || next < 1e-5) break;
      outside = reach_nearest(toward(inside, next));
      if (!outside.known) return false;
    }
    Trail trail;
    if (outside.gap > 0 && !between(inside, outside, trail, aims)) return false;
  }
  return aims.low.has_value();
}

}  // namespace carom::ballistics::detail
