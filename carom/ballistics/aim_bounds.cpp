// What no shot can do, for any elevation: how the aim solver knows without a flight that a target is out of reach.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

namespace {

double least_coefficient(const DragCurve& curve) {
  double least = 1e300;
  for (const DragPoint& point : curve.points()) least = math::min(least, point.coefficient);
  return least;
}
/// Up to that Mach number. Between their nodes curves do not leave the nodes' range.
double most_coefficient(const DragCurve& curve, double mach) {
  double most = 0;
  for (const DragPoint& point : curve.points()) {
    most = math::max(most, point.coefficient);
    if (point.mach > mach) break;
  }
  return most;
}

/// How fast a shot can be at most in any level direction, and how far it can have come. With e such a direction let
/// z = v·e less what the wind can be: the air passes at w ≥ z, and z falls at least as ½ρ (A/m) w C_D(w/c) z.
class LevelSpeed {
 public:
  /// `by_mach`: ½ρ (A/m) c, at the least.
  LevelSpeed(const DragCurve& curve, double first, double by_mach, double most_sound)
      : z(first), points_(curve.points()), next_(points_.size()), by_mach_(by_mach), most_sound_(most_sound) {
    above_ = points_.back().coefficient;
    beyond_ = above_ > 0 ? 1e300 : 0;
  }
  double z, t = 0, way = 0;  // m/s, s, m
  /// By `longest` s, or until z has fallen by a twentieth.
  void advance(double longest) {
    constexpr double ratio = 0.95, log_ratio = 0.051293294387550578;
    const double rate = by_mach_ * least_from(ratio * z / most_sound_), worn = rate * longest;
    if (worn > log_ratio) {
      t += log_ratio / rate;
      way += (1 - ratio) * z / rate;
      z *= ratio;
    } else {
      t += longest;
      way += z * longest;
      if (worn > 0) z *= math::exp(-worn);
    }
  }

 private:
  /// The least of M C_D(M) from a Mach number upward, which is not more than in the call before.
  double least_from(double mach) {
    for (; next_ > 0 && points_[next_ - 1].mach > mach; --next_) {
      const DragPoint& node = points_[next_ - 1];
      beyond_ = math::min(beyond_, node.mach * math::min(node.coefficient, above_));
      above_ = node.coefficient;
    }
    const double below = next_ > 0 ? points_[next_ - 1].coefficient : above_;
    return math::min(beyond_, mach * math::min(below, above_));
  }
  std::span<const DragPoint> points_;
  std::size_t next_;       // the first node that lies above
  double above_, beyond_;  // its C_D, and the least from there on
  double by_mach_, most_sound_;
};

/// Bounds between two heights: density falls with the height, the speed of sound changes by less than 2 m/s from one
/// look to the next.
struct AirBounds {
  double least_density, most_density, least_sound, most_sound;
  AirBounds(const environment::AirColumn& air, double low, double high) {
    least_density = air.at(high).density;
    most_density = air.at(low).density;
    least_sound = most_sound = air.at(high).speed_of_sound;
    constexpr double lowest = -20000, highest = 60000;  // beyond them columns are constant
    for (double height = math::max(low, lowest); height < math::min(high, highest); height += 500) {
      const double sound = air.at(height).speed_of_sound;
      least_sound = math::min(least_sound, sound);
      most_sound = math::max(most_sound, sound);
    }
    least_sound -= 2;
    most_sound += 2;
  }
};

}  // namespace

bool AimSolver::outranged() const {
  const double gravity = conditions_.gravity, half_area = 0.5 * projectile_.area_per_mass;
  if (!pull_.plain() || !(half_area > 0) || !(gravity > 0)) return false;
  double longest = options_.longest_time;
  const Vec3d velocity = (target_(longest) - target_(0)) / longest;
  // In the frame of the wind at the muzzle; `gusts`: by how much it differs elsewhere, m/s.
  const Vec3d wind = conditions_.wind.at(shooter_.muzzle.y);
  double gusts = 0;
  for (const environment::WindColumn::Level& level : conditions_.wind.levels()) {
    if (level.velocity.y != 0) return false;
    gusts = math::max(gusts, math::length(level.velocity - wind));
  }
  // It comes no higher, and no later to its top, than in vacuum, nor than with the least drag up to there.
  const double up = shooter_.muzzle_speed + math::max(shooter_.velocity.y, 0.0), lies = shooter_.muzzle.y,
               target = math::min(target_(0).y, target_(longest).y), lowest = math::min(lies, target);
  double highest = lies + up * up / (2 * gravity), last_top = up / gravity;
  const double least = least_coefficient(projectile_.drag);
  AirBounds air(conditions_.air, lowest, highest);
  for (int i = 0; i < 3; ++i) {
    const double k = half_area * air.least_density * least;
    if (k > 1e-12) {
      highest = lies + math::log1p(k * up * up / gravity) / (2 * k);
      last_top = math::atan(up * math::sqrt(k / gravity)) / math::sqrt(k * gravity);
    }
    air = AirBounds(conditions_.air, lowest, highest);
  }
  const auto level = [](Vec3d v) { return Vec3d{v.x, 0, v.z}; };
  const double fastest = shooter_.muzzle_speed + math::length(level(shooter_.velocity - wind)) + gusts;
  const double by_mach = half_area * air.least_density * air.least_sound;
  // From there it falls at least as with the most drag, at the greatest speed at which the air can pass: implicit
  // steps, which are never too fast while the speed rises to the one at which drag is even with gravity.
  LevelSpeed speed(projectile_.drag, fastest, by_mach, air.most_sound);
  for (double falls = 0, height = highest; speed.t + last_top < longest;) {
    const double aside = speed.z + 2 * gusts, t = speed.t;
    const double most =
        half_area * air.most_density *
        most_coefficient(projectile_.drag, (aside + falls + gravity * (0.05 * t + 0.05)) / air.least_sound);
    speed.advance(0.05 * t + 0.05);
    const double h = speed.t - t, before = falls,
                 even = 2 * gravity / (most * (aside + math::sqrt(aside * aside + 4 * gravity / most)));
    if (falls < even) {
      const double pushed = falls + h * gravity, b = 1 + h * most * aside;
      falls = 2 * pushed / (b + math::sqrt(b * b + 4 * h * most * pushed));
    } else {
      falls = even;
    }
    height -= h * math::min(before, falls);
    if (height < target) {
      longest = speed.t + last_top;
      break;
    }
  }
  // How far it comes until then, and how near the target.
  const Vec3d from = level(target_(0) - shooter_.muzzle), closing = level(velocity - wind);
  const double square = math::length_squared(closing);
  speed = LevelSpeed(projectile_.drag, fastest, by_mach, air.most_sound);
  while (speed.t < longest) {
    const double t = speed.t;
    speed.advance(math::min(0.05 * t + 0.05, longest - t));
    const double nearest = square > 0 ? math::clamp(-math::dot(from, closing) / square, t, speed.t) : t;
    if (!(math::length(from + nearest * closing) > 1.0001 * (speed.way + gusts * speed.t))) return false;
  }
  return true;
}

}  // namespace carom::ballistics::detail
