// First guesses of the aim solver, by drag of a constant coefficient in the frame of the wind.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

double AimSolver::drag_by_way(double speed, double height) const {
  const environment::AirColumn::Air air = conditions_.air.at(height);
  return math::max(medium_.half_area * air.density * projectile_.drag(speed / air.speed_of_sound), 1e-9);
}

AimSolver::Straight AimSolver::fly_straight(double speed, double length, double up) const {
  constexpr int steps = 5;
  const double g = conditions_.gravity, lies = shooter_.muzzle.y, way = length / steps;
  double k = drag_by_way(speed, lies), sinks = 0;  // 1/m, m/s
  Straight flown;
  for (int i = 0; i < steps; ++i) {
    k = drag_by_way(speed * (1 - 0.5 * math::min(k * way, 1.0)), lies + (i + 0.5) * way * up);
    const double left = math::exp(-k * way), next = speed * left, dt = way / math::sqrt(speed * next),
                 sinks_then = left * sinks + g * dt * math::sqrt(left);
    flown.fall += 0.5 * (sinks + sinks_then) * dt;
    flown.time += dt;
    sinks = sinks_then;
    speed = next;
  }
  return flown;
}

// Along a straight way drag leaves e^(−ks) of the speed after s: so long does it take, z = e^(ks) − 1 in units of 1/(k
// v), and the fall is what gravity adds up to under the same drag.
AimSolver::Guess AimSolver::flat_guess(bool& far) const {
  const double speed = shooter_.muzzle_speed, g = conditions_.gravity, lies = shooter_.muzzle.y;
  const Vec3d wind = conditions_.wind.at(lies), still = shooter_.velocity - wind;
  double time = 0, dropped = 0, mean = speed, last = speed;
  Vec3d along;
  bool stepwise = false;
  far = false;
  for (int i = 0; i < (stepwise ? 4 : 3); ++i) {
    const Vec3d way = target_(time) - shooter_.muzzle - time * wind + Vec3d{0, dropped, 0};
    const double length = math::max(math::length(way), 1e-9);
    along = way / length;
    // The speed through the air that the barrel gives along that way.
    const double ahead = math::dot(along, still), beside = speed * speed - math::length_squared(still) + ahead * ahead;
    const double first = math::max(ahead + math::sqrt(math::max(beside, 0.0)), 0.1 * speed);
    if (stepwise) {
      const Straight flown = fly_straight(first, length, along.y);
      along *= first;
      if (!(flown.fall < 0.8 * length)) {
        far = true;
        break;
      }
      time = flown.time;
      dropped = flown.fall;
      continue;
    }
    // Where it comes down through the speed of sound that mean swings to and fro; what holds at first is nearer.
    const bool falls_through = first > 1.2 * sound_ && last < 1.2 * sound_;
    const double at_first = drag_by_way(first, lies),
                 k = falls_through ? at_first : (at_first + 4 * drag_by_way(mean, lies) + drag_by_way(last, lies)) / 6,
                 worn = math::min(k * length, 5.0), z = math::expm1(worn);
    mean = first * math::exp(-0.5 * worn);
    last = mean * mean / first;
    time = z / (k * first);
    dropped = z > 1e-3 ? g * math::square(time / z) * 0.5 * (z + 0.5 * z * z - worn) : 0.5 * g * time * time;
    along *= first;
    stepwise = i > 0 && last < 0.7 * first;  // so much is lost that drag in the mean tells little
  }
  far = far || 0.5 * g * time * time > 0.65 * math::length(target_(time) - shooter_.muzzle);
  return {wind + along, time};
}

AimSolver::Guess AimSolver::steep_guess() const {
  const double speed = shooter_.muzzle_speed, g = math::max(conditions_.gravity, 1e-3), lies = shooter_.muzzle.y;
  const double climb = math::max(0.95 * speed + shooter_.velocity.y, 0.1 * speed);
  double height = 0.1 * climb * climb / g;
  // Up by the tangent, first faster than sound, then slower; the level speed is worn with it.
  double up = 0, risen = 0, left = 1, level = 0;  // s, m, of the level speed, s by it
  const auto rise = [&](double from, double to, double k) {
    const double pace = math::sqrt(g * k), a = from * k / pace, b = to * k / pace;
    const double secant_a = math::sqrt(1 + a * a), secant_b = math::sqrt(1 + b * b);
    up += (math::atan(a) - math::atan(b)) / pace;
    risen += math::log(secant_a / secant_b) / k;
    level += left * math::log((a + secant_a) / (b + secant_b)) / (pace * secant_a);
    left *= secant_b / secant_a;
  };
  const double slow = math::min(climb, 1.05 * sound_);
  if (slow < climb) rise(climb, slow, drag_by_way(0.5 * (climb + slow), lies + 0.2 * height));
  rise(slow, 0, drag_by_way(0.6 * slow, lies + 0.6 * height));
  height = risen;
  // Down by the hyperbolic tangent.
  const double deep = math::max(height - (target_(up).y - lies), 0.0), k = drag_by_way(0.5 * slow, lies + 0.5 * height);
  const double worn = k * deep, pace = math::sqrt(g * k);
  const double down = worn + math::log1p(math::sqrt(-math::expm1(-2 * worn))), e = math::exp(-down);
  level += left * 2 * math::atan((1 - e) / (1 + e)) / pace;
  const double time = up + down / pace;
  const Vec3d wind = conditions_.wind.at(lies + 0.5 * height);
  Vec3d barrel = (target_(time) - shooter_.muzzle - time * wind) / math::max(level, 1e-9) + wind - shooter_.velocity;
  barrel.y = 0;
  const double most = 0.8 * speed, aside = math::length(barrel);
  if (aside > most) barrel *= most / aside;
  barrel.y = math::sqrt(speed * speed - math::length_squared(barrel));
  return {shooter_.velocity + barrel, time};
}

bool AimSolver::by_guesses(const Guess& flat, double apart, Aims& aims, Root& late) const {
  const double speed = shooter_.muzzle_speed, longest = options_.longest_time;
  if (!(flat.time > 0)) return false;
  const Root low = refine(flat, 14, true);
  if (!low.found) return false;
  // Near the peak two roots are close together, and where the low one alone is asked for it must be the earlier.
  if (low.slope * low.guess.time > (options_.high_arc ? 0.02 * speed : 0)) {
    late = low;
    return false;
  }
  if (apart > 0 && !(low.slope * low.guess.time < -apart * speed)) return false;
  if (!options_.high_arc) {
    // It is the earliest where a little less time would need more speed; the slope tells, unless it is near the peak.
    if (low.slope * low.guess.time < -0.1 * speed) {
      keep(aims, low);
      return true;
    }
    const double before = 0.98 * low.guess.time;
    const Reach sooner = reach({low.guess.u, before}, target_(before));
    if (!sooner.known || sooner.gap <= 0) return false;
    keep(aims, low);
    return true;
  }
  const Guess steep = steep_guess();
  // Where the target is still within the surface at the longest time the high arc takes longer.
  const auto longer = [&] {
    const Reach last = reach_nearest({steep.u, longest});
    return last.known && last.gap < -1e-3 * last.scale && longest > 1.001 * low.guess.time;
  };
  const bool late_guess = 0.97 * steep.time > longest;  // they are rather too long
  if (late_guess && longer()) {
    keep(aims, low);
    return true;
  }
  const Root high = refine(steep, 40, false, true);
  if (!high.found) {
    if (late_guess || !longer()) return false;
    keep(aims, low);
    return true;
  }
  if (high.guess.time < 1.001 * low.guess.time) return false;  // two roots are all there are
  if (apart > 0 && !(high.slope * high.guess.time > apart * speed)) return false;
  keep(aims, low);
  keep(aims, high);
  return true;
}

}  // namespace carom::ballistics::detail
