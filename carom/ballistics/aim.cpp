#include "carom/ballistics/aim.h"

#include "carom/ballistics/detail/point_mass.h"
#include "carom/core/string.h"
#include "carom/math/mat.h"

namespace carom::ballistics {

using math::Vec3d;

namespace detail {

/// One aiming problem. The target's velocity is only needed near enough for Newton's method: differences serve.
class AimSolver {
 public:
  AimSolver(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
            core::FunctionRef<Vec3d(double)> target, const AimOptions& options)
      : projectile_(projectile), conditions_(conditions), shooter_(shooter), target_(target), options_(options) {
    const double density = conditions.air.at(shooter.muzzle.y).density;
    const double speed = shooter.muzzle_speed;
    sound_ = conditions.air.at(shooter.muzzle.y).speed_of_sound;
    const double k = 0.5 * density * projectile.drag(speed / sound_) * projectile.area_per_mass;
    decay_ = k > 0 ? 1 / (k * speed) : 1e30;
    fall_speed_ = math::min(speed, math::sqrt(conditions.gravity * decay_ * speed));
  }

  struct Guess {
    Vec3d u{};  // the initial velocity in the world
    double time = 0;
  };
  struct Arrival {
    Vec3d position{}, velocity{};
  };

  /// Newton's method for u and T together.
  struct Root {
    bool found = false;
    double slope = 0;  // m/s², of the speed that is needed over T: falls on the low side, rises on the high one
    Guess guess{};
    Arrival arrival{};
  };
  /// `eager`: gives up where the first steps do not lead there; `near`: the guess is as good as there.
  Root refine(Guess guess, int most = 40, bool eager = false, bool near = false) const {
    Root root;
    Inverse inverse;
    // Paths are integrated a good deal better than they still miss; the last ones as well as they must be.
    // What they err adds up: bends of drag curves and layers of wind, met on the way, pass the estimate unseen.
    const double fine = 0.1 * options_.tolerance / (1 + 0.25 * guess.time);
    Schedule schedule;  // of the first path that is as good as it must be
    double accuracy = near ? fine : math::max(0.02 * math::length(target_(guess.time) - shooter_.muzzle), fine);
    double last_accuracy = accuracy, last_missed = 1e300, first_missed = 1e300;
    Vec3d last_u{}, last_x{};
    double last_time = 0;
    for (int i = 0; i < most; ++i) {
      const bool recorded = schedule.count > 0 && schedule.count <= Schedule::most;
      const Arrival end = recorded ? follow(guess.u, guess.time, schedule)
                                   : propagate(guess.u, guess.time, accuracy, accuracy <= fine ? &schedule : nullptr);
      const Vec3d place = target_(guess.time), miss = place - end.position;
      if (i == 0) {
        inverse = estimate(guess, end);
      } else {  // what the change of u alone did to the arrival, where that is more than what integration errs
        const Vec3d moved = end.position - last_x - (guess.time - last_time) * end.velocity;
        if (recorded || math::length_squared(moved) > math::square(10 * (accuracy + last_accuracy)))
          update(inverse, guess.u - last_u, moved);
      }
      last_u = guess.u;
      last_x = end.position;
      last_time = guess.time;
      last_accuracy = accuracy;
      const Vec3d barrel = guess.u - shooter_.velocity;
      const double speed = math::length(barrel), lack = shooter_.muzzle_speed - speed;
      const double missed = math::length(miss);
      const Vec3d d = barrel / speed, drift = velocity_of_target(guess.time) - end.velocity;
      const Vec3d to_miss = inverse.apply(miss), to_drift = inverse.apply(drift);
      const double slope = math::dot(d, to_drift);
      if (!math::is_finite(missed) || !math::is_finite(slope) || slope == 0) return root;
      const double allowed = options_.tolerance;
      if (accuracy <= fine && math::abs(lack) * guess.time < allowed && missed < allowed) {
        root = {true, slope, guess, end};
        root.guess.u = shooter_.velocity + shooter_.muzzle_speed * d;
        return root;
      }
      // The next miss is some tenth of this one: then integration may err a tenth of that.
      accuracy = math::min(accuracy, 0.02 * math::min(missed, last_missed));
      if (accuracy < 100 * fine) accuracy = fine;
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
    }
    return root;
  }

  /// Finds u(T), from the guess that is there; false where it would need more than several muzzle speeds.
  struct Need {
    bool known = false;
    double lack = -1e300;  // muzzle speed − |u − v|: ≥ 0 where the gun is fast enough
  };
  Need need(Guess& guess) const {
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

  /// The initial velocity that hits at T in vacuum.
  Vec3d vacuum(double time) const {
    const Vec3d way = target_(time) - shooter_.muzzle;
    return way / time + Vec3d{0, 0.5 * conditions_.gravity * time, 0};
  }
  double vacuum_lack(double time) const {
    return shooter_.muzzle_speed - math::length(vacuum(time) - shooter_.velocity);
  }

  /// All roots by a walk through the flight times, the earliest and the latest of them.
  Aims scan() const {
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

  void keep(Aims& aims, const Root& root) const {
    if (!root.found || root.guess.time > options_.longest_time) return;
    const Shot shot{(root.guess.u - shooter_.velocity) / shooter_.muzzle_speed, root.guess.time, root.arrival.position,
                    root.arrival.velocity};
    if (!aims.low || shot.time < aims.low->time) aims.low = shot;
    if (!aims.high || shot.time > aims.high->time) aims.high = shot;
  }

  /// The usual case, in which the speed to spare has one peak over T, with an arc on either side of it. False: it is
  /// not the usual case, and the scan must tell.
  bool two_arcs(Aims& aims, bool steady) const {
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
    return by_guesses(aims) || (steady && out_of_reach()) || climb(aims);
  }

 private:
  bool by_guesses(Aims& aims) const {
    const double speed = shooter_.muzzle_speed, g = conditions_.gravity;
    const double fall_speed = math::sqrt(g * decay_ * speed);
    // Low: straight at the target, by the time of flight of quadratic drag.
    double time = 0;
    for (int i = 0; i < 3; ++i) {
      const double way = math::length(target_(time) - shooter_.muzzle - time * shooter_.velocity);
      const double worn = math::min(way / (decay_ * speed), 5.0);
      time = worn > 1e-6 ? decay_ * math::expm1(worn) : way / speed;
    }
    if (!(time > 0)) return false;
    const Vec3d flat = target_(time) - shooter_.muzzle + Vec3d{0, 0.5 * g * time * time, 0} - time * shooter_.velocity;
    const Root low = refine({shooter_.velocity + (speed / math::length(flat)) * flat, time}, 14, true);
    if (!low.found) return false;
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
    const double down =
        ratio > 1e-3 ? fall_speed / g * math::log1p(math::expm1(deep * g / (fall_speed * fall_speed)) * 2) * 0.5 +
                           math::sqrt(2 * deep / g) * 0.5
                     : math::sqrt(2 * deep / g);
    Guess guess{{}, 0.95 * (up + down)};
    const Vec3d way = target_(guess.time) - shooter_.muzzle - guess.time * shooter_.velocity;
    const double flown = math::max(math::hypot(way.x, way.z), 1e-9);
    const double level = math::min(flown / (2 * height + deep) * speed, 0.7 * speed);
    const double climb = math::sqrt(speed * speed - level * level);
    guess.u = shooter_.velocity + Vec3d{level * way.x / flown, climb, level * way.z / flown};
    const Root high = refine(guess);
    if (!high.found || high.guess.time < 1.001 * low.guess.time) return false;  // two roots are all there are
    keep(aims, low);
    keep(aims, high);
    return true;
  }

  /// How a shot passes the distance of the target.
  struct Pass {
    bool plain = false;  // it does so once and at a slant, or never
    double over = 0;     // m above the target; where it falls short, less what it lacks in distance
    double aside = 0;    // rad, how much farther to turn
  };
  Pass pass(double elevation, double azimuth) const {
    Vec3d x = shooter_.muzzle, v = shooter_.velocity + shooter_.muzzle_speed * direction(elevation, azimuth),
          k = at(x, v);
    const auto beyond = [&](Vec3d place, double t) {  // m past the target's distance
      const Vec3d to = target_(t) - shooter_.muzzle, way = place - shooter_.muzzle;
      return math::sqrt(way.x * way.x + way.z * way.z) - math::sqrt(to.x * to.x + to.z * to.z);
    };
    const double start = beyond(x, 0);
    double t = 0;
    for (int i = 0; i < 400 && t < options_.longest_time; ++i) {
      const double speed = math::length(v),
                   h = math::min(0.12 * math::max(speed, 0.5 * fall_speed_) / math::max(math::length(k), 1e-9),
                                 -0.5 * start / math::max(speed, 1e-9));
      const Step end = step(x, v, k, h);
      const double gone = beyond(end.x, t + h);
      if (gone >= 0) {
        // Within the step: the cubic through both ends, halved to a thousandth.
        double low = 0, high = 1;
        Vec3d place = end.x;
        for (int j = 0; j < 12; ++j) {
          const double s = 0.5 * (low + high), s2 = s * s, s3 = s2 * s;
          place =
              (2 * s3 - 3 * s2 + 1) * x + (s3 - 2 * s2 + s) * h * v + (3 * s2 - 2 * s3) * end.x + (s3 - s2) * h * end.v;
          (beyond(place, t + s * h) >= 0 ? high : low) = s;
        }
        const double when = t + high * h;
        const Vec3d to = target_(when) - shooter_.muzzle, way = place - shooter_.muzzle;
        const double radial = (v.x * way.x + v.z * way.z) / math::max(math::hypot(way.x, way.z), 1e-9);
        const double turn = math::atan2(to.z, to.x) - math::atan2(way.z, way.x);
        return {radial > 2 * math::length(velocity_of_target(when)), way.y - to.y,
                turn > math::pi    ? turn - 2 * math::pi
                : turn < -math::pi ? turn + 2 * math::pi
                                   : turn};
      }
      x = end.x;
      v = end.v;
      k = end.k;
      t += h;
      const double above = x.y - target_(t).y;
      if (v.y < 0 && above < 0.5 * start) return {true, above + gone, 0};
    }
    return {};
  }

  /// True: certainly no solution. Shots at eight elevations pass the target's distance below it, and so does the best
  /// one between them, by a good margin.
  bool out_of_reach() const {
    const Vec3d way = target_(0) - shooter_.muzzle;
    const double away = math::hypot(way.x, way.z), level = math::atan2(way.y, away);
    if (away < 0.3 * math::length(way) || math::length(velocity_of_target(0)) > 0.2 * shooter_.muzzle_speed ||
        math::length(shooter_.velocity) > 0.5 * shooter_.muzzle_speed)
      return false;
    constexpr int shots = 8;
    double elevation[shots], over[shots], azimuth = math::atan2(way.z, way.x);
    int best = 0;
    for (int i = 0; i < shots; ++i) {
      elevation[i] = level + (1.5 - level) * (i + 0.5) / shots;
      const Pass at = pass(elevation[i], azimuth);
      if (!at.plain || at.over > -0.05 * away) return false;
      over[i] = at.over;
      azimuth += at.aside;
      if (over[i] > over[best]) best = i;
    }
    if (best == 0 || best == shots - 1) return false;
    // A parabola through the best and its neighbours: the peak is b²/4a above the middle one.
    const double a = over[best] - 0.5 * (over[best - 1] + over[best + 1]), b = 0.5 * (over[best + 1] - over[best - 1]);
    return a > 0 && over[best] + 2 * b * b / (4 * a) < -0.05 * away;
  }

  /// From the best time in vacuum up to the peak of the speed to spare, then down both sides of it.
  bool climb(Aims& aims) const {
    constexpr double golden = 0.6180339887498949;
    double low = math::log(1e-3), high = math::log(options_.longest_time);
    const auto in_vacuum = [&](double x) { return vacuum_lack(math::exp(x)); };
    double a = high - golden * (high - low), b = low + golden * (high - low);
    for (int i = 0; i < 24; ++i) {
      (in_vacuum(a) > in_vacuum(b) ? high : low) = in_vacuum(a) > in_vacuum(b) ? b : a;
      a = high - golden * (high - low);
      b = low + golden * (high - low);
    }
    // With drag the peak lies elsewhere, but the way up to it can be felt, in shrinking strides of ln T.
    const double latest = math::log(options_.longest_time);
    Guess top{vacuum(math::exp(a)), math::exp(a)};
    Need at_top = need(top);
    if (!at_top.known) return false;
    double stride = 0.4;
    for (int i = 0; i < 60 && at_top.lack < 0 && stride > 2e-3; ++i) {
      const double x = math::min(math::log(top.time) + stride, latest);
      Guess next{top.u, math::exp(x)};
      const Need at_next = need(next);
      if (at_next.known && at_next.lack > at_top.lack && next.time > top.time) {
        top = next;
        at_top = at_next;
        continue;
      }
      Guess back{top.u, top.time * math::exp(-stride)};
      const Need at_back = need(back);
      if (at_back.known && at_back.lack > at_top.lack) {
        top = back;
        at_top = at_back;
      } else {
        stride *= 0.4;
      }
    }
    // Below zero at the peak of a smooth hill whose sides are strides of .002 away: no solution.
    if (at_top.lack < 0) return true;
    for (const double step : {1 / 1.3, 1.3}) {
      Guess inside = top, outside = top;
      Need at_outside = at_top;
      for (int i = 0; i < 60 && at_outside.lack >= 0; ++i) {
        inside = outside;
        outside.time *= step;
        if (outside.time > options_.longest_time * 1.3 || outside.time < 1e-5) break;
        at_outside = need(outside);
        if (!at_outside.known) return false;
      }
      if (at_outside.lack < 0 && !bisect(inside, {true, 1}, outside, aims)) return false;
    }
    return aims.low.has_value();
  }

  /// The inverse of ∂x(T)/∂u.
  struct Inverse {
    Vec3d row[3];
    Vec3d apply(Vec3d x) const { return {math::dot(row[0], x), math::dot(row[1], x), math::dot(row[2], x)}; }
    Vec3d apply_transposed(Vec3d x) const { return x.x * row[0] + x.y * row[1] + x.z * row[2]; }
  };

  /// Without gravity a turn of u turns the whole path, and quadratic drag gives ∂D/∂|u| = T v_end/|u|.
  Inverse estimate(const Guess& guess, const Arrival& end) const {
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
  /// The inverse of the derivative by differences.
  Inverse derivatives(const Guess& guess, const Arrival& end, double accuracy) const {
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
  /// Broyden's update of the inverse: it must give du for dx.
  static void update(Inverse& inverse, Vec3d du, Vec3d dx) {
    const Vec3d given = inverse.apply(dx);
    const double scale = math::dot(du, given);
    if (!(math::abs(scale) > 1e-3 * math::length_squared(du)) || !math::is_finite(scale)) return;
    const Vec3d right = inverse.apply_transposed(du) / scale, error = du - given;
    for (int i = 0; i < 3; ++i) inverse.row[i] += error[i] * right;
  }

  Vec3d velocity_of_target(double time) const {
    const double h = 1e-3 * math::max(time, 1e-2);
    return (target_(time + h) - target_(time)) / h;
  }

  /// The steps of a path as shares of its time. Paths that follow the same ones err alike, whatever air in layers and
  /// the bends of drag curves do to the estimate of the error: Newton's method converges on them without noise.
  struct Schedule {
    static constexpr int most = 600;
    int count = 0;  // most + 1: too many
    float ends[most];
    void add(double end) {
      if (count < most) ends[count] = float(end);
      if (count <= most) ++count;
    }
  };

  struct Step {
    Vec3d x{}, v{}, k{};
    double error = 0;  // m/s
  };
  /// Dormand and Prince's pair of orders 5 and 4; k1 is the acceleration at the start, k the one at the end.
  [[gnu::always_inline]] Step step(Vec3d x, Vec3d v, Vec3d k1, double h) const {
    const Vec3d v2 = v + (h / 5) * k1, k2 = at(x + (h / 5) * v, v2);
    const Vec3d v3 = v + h * (3.0 / 40 * k1 + 9.0 / 40 * k2);
    const Vec3d k3 = at(x + h * (3.0 / 40 * v + 9.0 / 40 * v2), v3);
    const Vec3d v4 = v + h * (44.0 / 45 * k1 - 56.0 / 15 * k2 + 32.0 / 9 * k3);
    const Vec3d k4 = at(x + h * (44.0 / 45 * v - 56.0 / 15 * v2 + 32.0 / 9 * v3), v4);
    const Vec3d v5 = v + h * (19372.0 / 6561 * k1 - 25360.0 / 2187 * k2 + 64448.0 / 6561 * k3 - 212.0 / 729 * k4);
    const Vec3d k5 =
        at(x + h * (19372.0 / 6561 * v - 25360.0 / 2187 * v2 + 64448.0 / 6561 * v3 - 212.0 / 729 * v4), v5);
    const Vec3d v6 =
        v + h * (9017.0 / 3168 * k1 - 355.0 / 33 * k2 + 46732.0 / 5247 * k3 + 49.0 / 176 * k4 - 5103.0 / 18656 * k5);
    const Vec3d k6 =
        at(x + h * (9017.0 / 3168 * v - 355.0 / 33 * v2 + 46732.0 / 5247 * v3 + 49.0 / 176 * v4 - 5103.0 / 18656 * v5),
           v6);
    Step end;
    end.v = v + h * (35.0 / 384 * k1 + 500.0 / 1113 * k3 + 125.0 / 192 * k4 - 2187.0 / 6784 * k5 + 11.0 / 84 * k6);
    end.x = x + h * (35.0 / 384 * v + 500.0 / 1113 * v3 + 125.0 / 192 * v4 - 2187.0 / 6784 * v5 + 11.0 / 84 * v6);
    end.k = at(end.x, end.v);
    end.error = h * math::length(71.0 / 57600 * k1 - 71.0 / 16695 * k3 + 71.0 / 1920 * k4 - 17253.0 / 339200 * k5 +
                                 22.0 / 525 * k6 - 1.0 / 40 * end.k);
    return end;
  }

  /// Steps held by the error of the velocity: at every moment so small that it moves the end by less than `allowed` m.
  Arrival propagate(Vec3d u, double time, double allowed, Schedule* schedule = nullptr) const {
    // Faster than sound, and most of all through the barrier, drag curves bend too sharply for the estimate of the
    // error: no long steps there, the shorter the better the path must be known.
    const double share = allowed / math::max(math::length(u) * time, 1e-9);
    const double bend_speed = sound_ * math::clamp(0.6 * math::sqrt(math::sqrt(share)), 0.03, 0.2);
    constexpr double far_bend = 3;
    const double least = 0.5 * fall_speed_, tolerance = allowed / time;
    Vec3d x = shooter_.muzzle, v = u, k = at(x, v);
    double t = 0, h = math::min(0.25 * math::max(math::length(v), least) / math::max(math::length(k), 1e-9), time);
    for (int i = 0; i < 4000; ++i) {
      const double speed = math::length(v), pull = math::max(math::length(k), 1e-9), bend = bend_speed / pull;
      if (speed > 0.85 * sound_) {
        if (h > far_bend * bend) h = far_bend * bend;
        if (h > bend && speed - h * pull < 1.15 * sound_) h = bend;
      }
      const bool last = t + h >= time * (1 - 1e-12);
      if (last) h = time - t;
      const Step end = step(x, v, k, h);
      const double room = tolerance / math::max(end.error, 1e-30);
      // The fifth root, near enough: the root of the root, held closer to one.
      const double factor = math::clamp(0.85 * math::sqrt(math::sqrt(room)), 0.2, 3.0);
      if (room >= 1) {
        x = end.x;
        v = end.v;
        k = end.k;
        t += h;
        if (schedule != nullptr) schedule->add(last ? 1 : t / time);
        if (last) break;
      }
      h *= factor;
      if (!(h > 1e-9 * time)) break;
    }
    return {x, v};
  }
  Arrival follow(Vec3d u, double time, const Schedule& schedule) const {
    Vec3d x = shooter_.muzzle, v = u, k = at(x, v);
    double t = 0;
    for (int i = 0; i < schedule.count; ++i) {
      const double next = time * double(schedule.ends[i]);
      const Step end = step(x, v, k, next - t);
      x = end.x;
      v = end.v;
      k = end.k;
      t = next;
    }
    return {x, v};
  }
  [[gnu::always_inline]] Vec3d at(Vec3d position, Vec3d velocity) const {
    return point_mass_acceleration(projectile_, conditions_, position, velocity);
  }

  /// The root between a and b, where the lack has different signs: halved until Newton's method finds one there.
  bool bisect(Guess a, const Need& at_a, Guess b, Aims& aims) const {
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

  /// A peak of the lack between a and b, below zero in the samples: where it reaches zero there are two roots.
  void touch(Guess a, Guess peak, double at_peak, Guess b, Aims& aims) const {
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

  const Projectile& projectile_;
  const Conditions& conditions_;
  const Shooter& shooter_;
  core::FunctionRef<Vec3d(double)> target_;
  AimOptions options_;
  double decay_ = 1e30;     // s, in which drag takes the muzzle speed
  double fall_speed_ = 0;   // m/s, terminal, at most the muzzle speed
  double sound_ = 340.294;  // m/s, at the muzzle
};

core::Result<void> check(const Projectile& projectile, const Shooter& shooter, const AimOptions& options) {
  const auto finite = [](Vec3d v) { return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z); };
  if (!(shooter.muzzle_speed > 0) || !math::is_finite(shooter.muzzle_speed))
    return core::Error{core::text("aim: ", core::refused("muzzle_speed", shooter.muzzle_speed, "a finite number > 0"))};
  if (!finite(shooter.muzzle)) return core::Error{"aim: the position of the muzzle is not finite"};
  if (!finite(shooter.velocity)) return core::Error{"aim: the velocity of the shooter is not finite"};
  if (!(projectile.area_per_mass >= 0) || !math::is_finite(projectile.area_per_mass))
    return core::Error{
        core::text("aim: ", core::refused("area_per_mass", projectile.area_per_mass, "a finite number >= 0"))};
  if (!(options.longest_time > 0) || !math::is_finite(options.longest_time))
    return core::Error{core::text("aim: ", core::refused("longest_time", options.longest_time, "a finite number > 0"))};
  if (!(options.tolerance > 0))
    return core::Error{core::text("aim: ", core::refused("tolerance", options.tolerance, "a number > 0"))};
  return {};
}

}  // namespace detail

core::Result<Aims> aim(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                       core::FunctionRef<Vec3d(double)> target, const AimOptions& options) {
  const core::Result<void> checked = detail::check(projectile, shooter, options);
  if (!checked.ok()) return checked.error();
  return detail::AimSolver(projectile, conditions, shooter, target, options).scan();
}

core::Result<Aims> aim(const Projectile& projectile, const Conditions& conditions, const Shooter& shooter,
                       const Target& target, const AimOptions& options) {
  const core::Result<void> checked = detail::check(projectile, shooter, options);
  if (!checked.ok()) return checked.error();
  const Vec3d sum = target.position + target.velocity + target.acceleration;
  if (!math::is_finite(sum.x + sum.y + sum.z)) return core::Error{"aim: the target is not finite"};
  const auto place = [&](double t) {
    return target.position + t * (target.velocity + (0.5 * t) * target.acceleration);
  };
  const detail::AimSolver solver(projectile, conditions, shooter, place, options);
  Aims aims;
  const bool steady = target.acceleration == Vec3d{};
  if (solver.two_arcs(aims, steady)) return aims;
  return solver.scan();
}

core::Result<std::optional<Shot>> aim_again(const Projectile& projectile, const Conditions& conditions,
                                            const Shooter& shooter, const Target& target, const Shot& last,
                                            const AimOptions& options) {
  const core::Result<void> checked = detail::check(projectile, shooter, options);
  if (!checked.ok()) return checked.error();
  const Vec3d sum = target.position + target.velocity + target.acceleration + last.direction;
  if (!math::is_finite(sum.x + sum.y + sum.z))
    return core::Error{"aim_again: the target or the last shot is not finite"};
  if (!(last.time > 0) || !math::is_finite(last.time))
    return core::Error{core::text("aim_again: ", core::refused("last.time", last.time, "a finite number > 0"))};
  const auto place = [&](double t) {
    return target.position + t * (target.velocity + (0.5 * t) * target.acceleration);
  };
  const detail::AimSolver solver(projectile, conditions, shooter, place, options);
  const auto root =
      solver.refine({shooter.velocity + shooter.muzzle_speed * last.direction, last.time}, 40, false, true);
  if (!root.found || root.guess.time > options.longest_time) return std::optional<Shot>{};
  return std::optional<Shot>{{(root.guess.u - shooter.velocity) / shooter.muzzle_speed, root.guess.time,
                              root.arrival.position, root.arrival.velocity}};
}

}  // namespace carom::ballistics
