// Where the aim solver looks for shots, and how it knows that there are none.
#include "carom/ballistics/detail/aim_solver.h"
#include "carom/math/cpu.h"

namespace carom::ballistics::detail {

namespace {

void add_beside(const Conditions& conditions, const double* place, const double* velocity, double* acceleration) {
  const Vec3d more = beside_drag(conditions, {place[0], place[1], place[2]}, {velocity[0], velocity[1], velocity[2]});
  for (int i = 0; i < 3; ++i) acceleration[i] += more[i];
}

AimMedium medium_of(const Projectile& projectile, const Conditions& conditions) {
  AimMedium m;
  m.air = conditions.air.table();
  m.wind = conditions.wind.table();
  m.below.velocity = m.wind.lowest;
  Vec3d above = m.wind.lowest;
  if (m.wind.count > 0) {
    m.sheared_up_to = m.wind.legs[m.wind.count - 1].height;
    above = m.wind.legs[m.wind.count - 1].velocity;
  }
  for (int i = 0; i < 3; ++i) m.wind_above[i] = above[i];
  m.drag = projectile.drag.table();
  m.half_area = 0.5 * projectile.area_per_mass;
  m.gravity = conditions.gravity;
  const bool plain = conditions.gravity_model == GravityModel::uniform && conditions.rotation == Vec3d{};
  m.beside = plain ? nullptr : add_beside;
  m.conditions = &conditions;
  return m;
}

/// m/s, faster than anything will fly.
double fastest(const Shooter& shooter) { return 1.5 * (shooter.muzzle_speed + math::length(shooter.velocity)); }

}  // namespace

AimSolver::AimSolver(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                     core::FunctionRef<Vec3d(double)> target, const AimOptions& options)
    : pull_(projectile, conditions),
      rough_(projectile, conditions),
      medium_(medium_of(projectile, conditions)),
      wide_(math::detect_instruction_set() != math::InstructionSet::baseline),
      projectile_(projectile),
      conditions_(conditions),
      shooter_(shooter),
      target_(target),
      options_(options) {
  const double density = conditions.air.at(shooter.muzzle.y).density;
  const double speed = shooter.muzzle_speed;
  sound_ = conditions.air.at(shooter.muzzle.y).speed_of_sound;
  const double k = 0.5 * density * projectile.drag(speed / sound_) * projectile.area_per_mass;
  decay_ = k > 0 ? 1 / (k * speed) : 1e30;
  fall_speed_ = math::min(speed, math::sqrt(conditions.gravity * decay_ * speed));
  if (const auto levels = conditions.wind.levels(); levels.size() > 1) ground_ = levels.front().height;
  conditions.wind.for_each_bend(-1e300, 1e300, least_bend, [&](double) { layered_ = true; });
  // Most curves have one bend, at their very end.
  if (projectile.drag.has_bends())
    projectile.drag.for_each_bend(0, fastest(shooter) / sound_, [&](double) { bent_ = true; });
}

Aims AimSolver::scan() const {
  const double fastest =
      shooter_.muzzle_speed + math::length(shooter_.velocity) + math::length(conditions_.wind.at(shooter_.muzzle.y));
  const double first_time = math::max(
      1e-4, 0.2 * math::length(target_(0) - shooter_.muzzle) / (fastest + math::length(velocity_of_target(0))));
  const double ratio = math::max(options_.longest_time / first_time, 1.01);
  const int steps = 160;
  Aims aims;
  Guess previous{vacuum(first_time), first_time};
  Need at_previous = need(previous), before{};
  Guess before_guess{};
  for (int i = 1; i <= steps; ++i) {
    Guess next{previous.u, first_time * math::pow(ratio, double(i) / steps)};
    if (!at_previous.known || math::length(previous.u) > 4 * shooter_.muzzle_speed) next.u = vacuum(next.time);
    const Need at_next = need(next);
    if (!at_next.known) continue;
    if (at_previous.known && (at_previous.lack < 0) != (at_next.lack < 0)) {
      bisect(previous, at_previous, next, aims);
    } else if (before.known && at_previous.known && at_previous.lack < 0 && at_previous.lack > before.lack &&
               at_previous.lack > at_next.lack) {
      touch(before_guess, previous, at_previous.lack, next, aims);  // a peak below zero between samples may reach it
    }
    before = at_previous;
    before_guess = previous;
    previous = next;
    at_previous = at_next;
  }
  return aims;
}

void AimSolver::keep(Aims& aims, const Root& root) const {
  if (!root.found || root.guess.time > options_.longest_time) return;
  const Shot shot{(root.guess.u - shooter_.velocity) / shooter_.muzzle_speed, root.guess.time, root.arrival.position,
                  root.arrival.velocity};
  if (!aims.low || shot.time < aims.low->time) aims.low = shot;
  if (!aims.high || shot.time > aims.high->time) aims.high = shot;
}

bool AimSolver::two_arcs(Aims& aims, bool steady) const {
  // In vacuum the lack is cheap: more than one peak there means a target whose motion makes further arcs.
  constexpr int samples = 48;
  double previous = -1e300;
  int peaks = 0;
  bool rises = true;
  for (int i = 1; i <= samples; ++i) {
    const double lack = vacuum_lack(options_.longest_time * math::square(double(i) / samples));
    if (rises && lack < previous) ++peaks;
    rises = lack >= previous;
    previous = lack;
  }
  if (peaks + (rises ? 1 : 0) > 1) return false;
  const bool far = steady && looks_far();
  if (far && (out_of_reach() || outranged())) return true;
  Root late;
  return by_guesses(aims, late) || (steady && !far && !late.found && (out_of_reach() || outranged())) ||
         by_peak(aims, late);
}

/// Straight at the target, by the time of flight of quadratic drag.
double AimSolver::flat_time() const {
  const double speed = shooter_.muzzle_speed;
  double time = 0;
  for (int i = 0; i < 3; ++i) {
    const double way = math::length(target_(time) - shooter_.muzzle - time * shooter_.velocity);
    const double worn = math::min(way / (decay_ * speed), 5.0);
    time = worn > 1e-6 ? decay_ * math::expm1(worn) : way / speed;
  }
  return time;
}

/// On such a flight it would fall by more than the shots that go farthest do (.3 to .55 of the way).
bool AimSolver::looks_far() const {
  const double time = flat_time();
  return 0.5 * conditions_.gravity * time * time > 0.65 * math::length(target_(time) - shooter_.muzzle);
}

bool AimSolver::by_guesses(Aims& aims, Root& late) const {
  const double speed = shooter_.muzzle_speed, g = conditions_.gravity;
  const double fall_speed = math::sqrt(g * decay_ * speed);
  const double time = flat_time();
  if (!(time > 0)) return false;
  const Vec3d flat = target_(time) - shooter_.muzzle + Vec3d{0, 0.5 * g * time * time, 0} - time * shooter_.velocity;
  const Root low = refine({shooter_.velocity + (speed / math::length(flat)) * flat, time}, 14, true);
  if (!low.found) return false;
  if (low.slope * low.guess.time > 0.02 * speed) {
    late = low;
    return false;
  }
  if (!options_.high_arc) {
    // It is the earliest where a little less time would need more speed; the slope tells, unless it is near the peak.
    if (low.slope * low.guess.time < -0.1 * speed) {
      keep(aims, low);
      return true;
    }
    Guess sooner{low.guess.u, 0.98 * low.guess.time};
    const Need at_sooner = need(sooner);
    if (!at_sooner.known || at_sooner.lack >= 0) return false;
    keep(aims, low);
    return true;
  }
  // High: nearly straight up, and down at the terminal speed.
  const double ratio = speed / fall_speed;
  const double up = ratio > 1e-3 ? fall_speed / g * math::atan(ratio) : speed / g;
  const double height =
      ratio > 1e-3 ? fall_speed * fall_speed / (2 * g) * math::log1p(ratio * ratio) : speed * speed / (2 * g);
  const double deep = math::max(height - (target_(up).y - shooter_.muzzle.y), 0.0);
  const double down = ratio > 1e-3
                          ? fall_speed / g * math::log1p(math::expm1(deep * g / (fall_speed * fall_speed)) * 2) * 0.5 +
                                math::sqrt(2 * deep / g) * 0.5
                          : math::sqrt(2 * deep / g);
  Guess guess{{}, 0.95 * (up + down)};
  const Vec3d way = target_(guess.time) - shooter_.muzzle - guess.time * shooter_.velocity;
  const double flown = math::max(math::hypot(way.x, way.z), 1e-9);
  const double level = math::min(flown / (2 * height + deep) * speed, 0.7 * speed);
  const double climb = math::sqrt(speed * speed - level * level);
  guess.u = shooter_.velocity + Vec3d{level * way.x / flown, climb, level * way.z / flown};
  const Root high = refine(guess, 40, false, true);
  if (!high.found) {
    // Where the gun is more than fast enough for the longest time the high arc takes longer.
    Guess last{guess.u, options_.longest_time};
    const Need at_last = need(last);
    if (!at_last.known || at_last.lack < 1e-3 * speed || last.time < 1.001 * low.guess.time) return false;
    keep(aims, low);
    return true;
  }
  if (high.guess.time < 1.001 * low.guess.time) return false;  // two roots are all there are
  keep(aims, low);
  keep(aims, high);
  return true;
}

bool AimSolver::out_of_reach() const {
  const Vec3d way = target_(0) - shooter_.muzzle, velocity = velocity_of_target(0);
  const double away = math::hypot(way.x, way.z), level = math::atan2(way.y, away);
  const double flees = (way.x * velocity.x + way.z * velocity.z) / math::max(away, 1e-9);
  if (away < 0.3 * math::length(way) || math::length(shooter_.velocity) > 0.5 * shooter_.muzzle_speed) return false;
  // A fast target may come past the muzzle and be met behind it, unless it flees.
  if (math::length(velocity) > math::max(0.2 * shooter_.muzzle_speed, 1.5 * flees)) return false;
  constexpr int shots = 5;
  double over[shots], azimuth = math::atan2(way.z, way.x);
  int best = 0;
  for (int i = 0; i < shots; ++i) {
    const Pass at = pass(level + (1.5 - level) * math::square((i + 0.5) / shots), azimuth);
    if (!at.plain || at.over > -0.02 * away) return false;
    over[i] = at.over;
    azimuth += at.aside;
    if (over[i] > over[best]) best = i;
  }
  if (best == 0 || best == shots - 1) return false;
  // A parabola through the best and its neighbours: the peak is b²/4a above the middle one.
  const double a = over[best] - 0.5 * (over[best - 1] + over[best + 1]), b = 0.5 * (over[best + 1] - over[best - 1]);
  return a > 0 && over[best] + 2 * b * b / (4 * a) < -0.02 * away;
}

double AimSolver::best_in_vacuum() const {
  constexpr double golden = 0.6180339887498949;
  double low = math::log(1e-3), high = math::log(options_.longest_time);
  double a = high - golden * (high - low), b = low + golden * (high - low);
  double at_a = vacuum_lack(math::exp(a)), at_b = vacuum_lack(math::exp(b));
  for (int i = 0; i < 24; ++i) {
    if (at_a > at_b) {
      high = b;
      b = a;
      at_b = at_a;
      a = high - golden * (high - low);
      at_a = vacuum_lack(math::exp(a));
    } else {
      low = a;
      a = b;
      at_a = at_b;
      b = low + golden * (high - low);
      at_b = vacuum_lack(math::exp(b));
    }
  }
  return math::exp(a);
}

AimSolver::Reach AimSolver::falls_short(Guess& guess) const {
  struct Tangent {
    double time = 0, need = 0, slope = 0;  // m/s, m/s²
  } falls, rises;
  const double speed = shooter_.muzzle_speed, enough = 1.02 * speed;
  double first = 0, last = options_.longest_time;  // a shot would have to arrive between them
  guess.time = best_in_vacuum();
  guess.u = vacuum(guess.time);
  Inverse inverse;
  Vec3d last_u{}, last_x{};
  double last_time = 0;
  bool anew = true;
  double least = 1e300;  // m/s, of what was found to be needed, there:
  Guess nearest;
  for (int i = 0; i < 24; ++i) {
    const double away = math::length(target_(guess.time) - shooter_.muzzle);
    const Arrival end = propagate(guess.u, guess.time, 1e-3 * away);
    const Vec3d miss = target_(guess.time) - end.position;
    const double pace = math::length(guess.u - shooter_.velocity);
    if (!math::is_finite(math::length(miss)) || !math::is_finite(pace)) return Reach::unknown;
    if (anew)
      inverse = estimate(guess, end);
    else
      update(inverse, guess.u - last_u, end.position - last_x - (guess.time - last_time) * end.velocity);
    anew = false;
    last_u = guess.u;
    last_x = end.position;
    last_time = guess.time;
    if (pace > 8 * speed && rises.time == 0 && falls.time == 0) {  // later than anything gets there: sooner
      guess.time *= 0.5;
      guess.u = vacuum(guess.time);
      anew = true;
      continue;
    }
    Vec3d to_miss = inverse.apply(miss);
    if (math::length(miss) > 0.01 * away) {
      const double most = 0.5 * (pace + speed);
      if (math::length(to_miss) > most) to_miss *= most / math::length(to_miss);
      guess.u += to_miss;
      continue;
    }
    const Vec3d barrel = guess.u + to_miss - shooter_.velocity;
    const Vec3d to_drift = inverse.apply(velocity_of_target(guess.time) - end.velocity);
    const Tangent here{guess.time, math::length(barrel), math::dot(barrel, to_drift) / math::length(barrel)};
    if (here.need < enough) return Reach::near;
    if (here.need < least) {
      least = here.need;
      nearest = {guess.u + to_miss, guess.time};
    }
    if (!(math::abs(here.slope) > 0)) return Reach::unknown;
    // Slopes are known to about a tenth: as if they were a quarter steeper.
    const double reached = here.time - (here.need - enough) / (1.25 * here.slope);
    if (here.slope < 0) {
      falls = here;
      first = math::max(first, reached);
    } else {
      rises = here;
      last = math::min(last, reached);
    }
    if (falls.time > 0 && rises.time > 0) {
      // The mean slope between the two lies between theirs, where the curve is convex and they are right.
      const double mean = (rises.need - falls.need) / (rises.time - falls.time);
      if (rises.time < 1.02 * falls.time || mean < falls.slope || mean > rises.slope) return Reach::unknown;
    }
    if (first >= last && least < 1.5 * speed) {  // where drag falls with speed the curve need not be convex: look there
      guess = nearest;
      return Reach::near;
    }
    if (first >= last) {
      // Secants may mistake even the sign of a slope where paths bend much: the nearest one by its derivatives.
      const double slope = nearest.time == falls.time ? falls.slope : rises.slope;
      const Footing at = footing(nearest);
      if (!at.known) return Reach::unknown;
      guess = at.guess;
      return -at.slope / slope > 0 && -at.slope / slope < 1.25 ? Reach::never : Reach::near;
    }
    double next = 0.5 * (first + last);
    if (rises.time == 0) next = math::min(math::max(first, 1.4 * here.time), 0.5 * (first + last));
    if (falls.time == 0) next = math::max(last, 0.4 * here.time);
    guess.u += to_miss + (next - guess.time) * to_drift;
    guess.time = next;
  }
  return Reach::unknown;
}

bool AimSolver::by_peak(Aims& aims, const Root& late) const {
  Guess guess;
  const Reach reach = falls_short(guess);
  if (reach == Reach::never) return true;
  if (reach == Reach::near) return climb(aims, guess, true, late);
  const double best = best_in_vacuum();
  return climb(aims, {vacuum(best), best}, false, late);
}

AimSolver::Footing AimSolver::footing(Guess guess) const {
  Path path;
  for (int i = 0; i < 12; ++i) {
    const double away = math::length(target_(guess.time) - shooter_.muzzle);
    if (!record(guess, 2e-4 * away + 1e-3, path)) return {};
    linearize(path, false);
    const Inverse inverse = inverse_of(path.by_velocity);
    const Vec3d miss = target_(guess.time) - path.arrival.position;
    const double missed = math::length(miss), speed = math::length(guess.u - shooter_.velocity);
    Vec3d du = inverse.apply(miss);
    if (!math::is_finite(math::length(du)) || speed > 8 * shooter_.muzzle_speed) return {};
    const double most = 0.5 * (speed + shooter_.muzzle_speed);
    if (math::length(du) > most) du *= most / math::length(du);
    guess.u += du;
    if (missed > 0.01 * away) continue;  // what is left is as its square
    const Vec3d barrel = guess.u - shooter_.velocity;
    const Vec3d drift = inverse.apply(velocity_of_target(guess.time) - path.arrival.velocity);
    const double need = math::length(barrel);
    return {true, guess, shooter_.muzzle_speed - need, -math::dot(barrel, drift) / need, drift};
  }
  return {};
}

bool AimSolver::climb(Aims& aims, Guess top, bool sure, const Root& late) const {
  Footing at = footing(top), rises, falls;  // before the peak and after it
  const double longest = options_.longest_time;
  for (int i = 0; i < 16 && at.known && at.lack < 0; ++i) {
    (at.slope > 0 ? rises : falls) = at;
    const double time = at.guess.time;
    if (at.slope > 0 && time >= longest) break;
    double next = at.slope > 0 ? math::min(1.4 * time, longest) : time / 1.4;
    if (rises.known && falls.known) {
      const double first = rises.guess.time, last = falls.guess.time;
      if (last < 1.002 * first) break;
      // Where the chord of the slopes is level; every third time the middle.
      const double level = first + (last - first) * rises.slope / (rises.slope - falls.slope);
      next = i % 3 == 2 ? 0.5 * (first + last)
                        : math::clamp(level, first + 0.05 * (last - first), last - 0.05 * (last - first));
    }
    at = footing({at.guess.u + (next - time) * at.drift, next});
  }
  if (!at.known) return false;
  if (at.lack < 0) {
    // Below zero at the peak: no solution. But what it lacks is known to a few ten-thousandths: where a shot that
    // touches the target is found there all the same, the scan must tell.
    return sure && (at.lack < -1e-3 * shooter_.muzzle_speed || !refine(at.guess).found);
  }
  // A parabola through what is known leads to a root on either side; where Newton's method does not, step by step.
  const Footing& other = rises.known ? rises : falls;
  const double bend = other.known ? (at.slope - other.slope) / (at.guess.time - other.guess.time)
                                  : -2 * shooter_.muzzle_speed / math::square(at.guess.time);
  for (const double side : {-1.0, 1.0}) {
    if (side > 0 && late.found && late.guess.time > at.guess.time) {
      keep(aims, late);
      continue;
    }
    const double curve = math::min(bend, -0.1 * shooter_.muzzle_speed / math::square(at.guess.time));
    const double root = math::sqrt(at.slope * at.slope - 2 * curve * at.lack);
    const double way = (at.slope + side * root) / -curve;
    const double dt = math::clamp(way, -0.6 * at.guess.time, at.guess.time);
    const Root there = refine({at.guess.u + dt * at.drift, at.guess.time + dt});
    if (there.found && side * (there.guess.time - at.guess.time) > 0 && side * there.slope > 0) {
      keep(aims, there);
      continue;
    }
    Guess inside = at.guess, outside = at.guess;
    Need at_outside{true, at.lack};
    for (int i = 0; i < 60 && at_outside.lack >= 0; ++i) {
      inside = outside;
      outside.time *= side > 0 ? 1.3 : 1 / 1.3;
      if (outside.time > longest * 1.3 || outside.time < 1e-5) break;
      at_outside = need(outside);
      if (!at_outside.known) return false;
    }
    if (at_outside.lack < 0 && !bisect(inside, {true, 1}, outside, aims)) return false;
  }
  return aims.low.has_value();
}

}  // namespace carom::ballistics::detail
