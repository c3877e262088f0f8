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

void AimSolver::keep(Aims& aims, const Root& root) const {
  if (!root.found || root.guess.time > options_.longest_time) return;
  const Shot shot{(root.guess.u - shooter_.velocity) / shooter_.muzzle_speed, root.guess.time, root.arrival.position,
                  root.arrival.velocity};
  if (!aims.low || shot.time < aims.low->time) aims.low = shot;
  if (!aims.high || shot.time > aims.high->time) aims.high = shot;
}

AimSolver::Guess AimSolver::straight(double time) const {
  const Vec3d way = vacuum(time) - shooter_.velocity;
  return {shooter_.velocity + (shooter_.muzzle_speed / math::length(way)) * way, time};
}

bool AimSolver::two_arcs(Aims& aims) const {
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
  Nearest near;
  if (looks_far()) {
    near = nearest();
    if (near.sure && near.gap > 1e-3 * near.at.scale) return true;
  }
  Root late;
  if (by_guesses(aims, late)) return true;
  if (!near.sure) near = nearest();
  return by_nearest(aims, near, late);
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
    const Reach sooner = reach({low.guess.u, 0.98 * low.guess.time});
    if (!sooner.known || sooner.gap <= 0) return false;
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
  // Where the gun is more than fast enough for the longest time the high arc takes longer.
  const double longest = options_.longest_time;
  const auto longer = [&](const Guess& high) {
    const Reach last = reach_nearest({high.u, longest});
    return last.known && last.gap < -1e-3 * last.scale && longest > 1.001 * low.guess.time;
  };
  const bool late_guess = guess.time > 0.95 * longest;
  if (late_guess && longer(guess)) {
    keep(aims, low);
    return true;
  }
  const Root high = refine(guess, 40, false, true);
  if (!high.found) {
    if (late_guess || !longer(guess)) return false;
    keep(aims, low);
    return true;
  }
  if (high.guess.time < 1.001 * low.guess.time) return false;  // two roots are all there are
  keep(aims, low);
  keep(aims, high);
  return true;
}

}  // namespace carom::ballistics::detail
