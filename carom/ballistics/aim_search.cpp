// Where the aim solver looks for shots, and how it knows that there are none.
#include <bit>

#include "carom/ballistics/detail/aim_solver.h"

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
    m.lowest_cell = std::bit_cast<double>(m.wind.first_cell << 48);
    m.highest_cell = std::bit_cast<double>(m.wind.last_cell << 48);
  }
  for (int i = 0; i < 3; ++i) m.wind_above[i] = above[i];
  m.drag = projectile.drag.table();
  m.half_area = 0.5 * projectile.area_per_mass;
  m.gravity = conditions.gravity;
  m.beside = only_height_matters(conditions) ? nullptr : add_beside;
  m.conditions = &conditions;
  return m;
}

const AimKernel& best_kernel(math::InstructionSet most) {
#if CAROM_WIDE_UNITS
  switch (math::choose_instruction_set(most)) {
    case math::InstructionSet::avx512:
      return aim_avx512::kernel;
    case math::InstructionSet::avx2:
      return aim_avx2::kernel;
    case math::InstructionSet::baseline:
      break;
  }
#endif
  return aim_baseline::kernel;
}

/// m/s, faster than anything will fly.
double fastest(const Shooter& shooter) { return 1.5 * (shooter.muzzle_speed + math::length(shooter.velocity)); }

}  // namespace

AimSolver::AimSolver(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                     core::FunctionRef<Vec3d(double)> target, const AimOptions& options, math::InstructionSet most)
    : rough_(projectile, conditions),
      medium_(medium_of(projectile, conditions)),
      lanes_(best_kernel(most)),
      few_lanes_(best_kernel(math::min(most, math::InstructionSet::avx2))),
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
  layered_ = conditions.wind.sharpest_bend() > least_bend;
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

// In vacuum u(T) = d/T + w + G T/2, d the way to the target, w its velocity past the shooter and G gravity with its
// acceleration; |u|² has its extremes where ½ G² T⁴ + (w·G) T³ − 2 (d·w) T − 2 d² = 0. By the signs of these there is
// one T > 0, unless w·G and d·w are both negative: three then, perhaps.
bool AimSolver::one_peak(const Target& target) const {
  const Vec3d way = target.position - shooter_.muzzle, past = target.velocity - shooter_.velocity,
              pull = target.acceleration + Vec3d{0, conditions_.gravity, 0};
  if (math::dot(past, pull) >= 0 || math::dot(way, past) >= 0) return true;
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
  return peaks + (rises ? 1 : 0) <= 1;
}

// A target slower than half of what drag leaves of any shot's speed is passed once by the surface on its way out and
// once on its way back, however it moves, but for the time about the peak, when that surface hardly moves.
bool AimSolver::slow_target() const {
  Looks at_looks(*this);
  for (int look = 1; look <= looks; ++look)
    if (!(at_looks.pace(look) < 0.5 * fall_speed_)) return false;
  return true;
}

bool AimSolver::two_arcs(const Target& target, Aims& aims) const {
  // More than one peak even in vacuum means a target whose motion makes further arcs.
  return one_peak(target) && arcs(0, aims);
}

bool AimSolver::two_arcs(Aims& aims) const { return slow_target() && arcs(0.1, aims); }

bool AimSolver::arcs(double apart, Aims& aims) const {
  bool far = false;
  const Guess flat = flat_guess(far);
  Nearest near;
  if (far) {
    near = nearest(options_.longest_time);
    if (near.sure && near.gap > math::max(apart, 1e-3) * near.at.scale) return true;
  }
  Root late;
  // Near the edge of reach guesses lead nowhere.
  const bool at_edge = near.sure && near.gap > (apart > 0 ? -0.1 : -0.3) * near.at.scale;
  if (!at_edge && by_guesses(flat, apart, aims, late)) return true;
  if (apart > 0) return false;
  if (!near.sure) near = nearest(flat.time);
  if (late.found && near.gap > 0) return false;  // that is not where they come nearest
  return by_nearest(aims, near, late);
}

}  // namespace carom::ballistics::detail
