// Recorded paths of the aim solver: how the arrival depends on the start.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

namespace {

using Four = math::WideFloat<4>;

using Debt = FlightPath::Debt;

/// How drag changes on the mean of a step, times its length.
struct MeanSlope {
  Four drag, bend, w[3], rise[3], length;

  /// At its beginning, .3, .8 and the end of it: the weights of order 4 there.
  MeanSlope(const FlightPath::Stage* step, const FlightPath::Stage* next, float h) {
    static_assert(sizeof(FlightPath::Stage) == 2 * sizeof(Four));
    Four half[2];
    for (int i = 0; i < 2; ++i) {
      const auto of = [&](const FlightPath::Stage* stage) {
        return Four::load(reinterpret_cast<const float*>(stage) + 4 * i);
      };
      half[i] = Four::splat(float(1.0 / 12)) * of(step) + Four::splat(float(10.0 / 21)) * of(step + 1) +
                Four::splat(float(5.0 / 12)) * of(step + 2) + Four::splat(float(1.0 / 42)) * of(next);
    }
    drag = Four::splat(h * half[0].v[0]);
    bend = Four::splat(h * half[0].v[1]);
    w[0] = Four::splat(half[0].v[2]);
    w[1] = Four::splat(half[0].v[3]);
    w[2] = Four::splat(half[1].v[0]);
    for (int i = 0; i < 3; ++i) rise[i] = Four::splat(h * half[1].v[i + 1]);
    length = Four::splat(h);
  }
  /// What a debt at the end owes to the velocity and the height before, but for itself. Places owe themselves, `own`,
  /// to the arrival.
  [[gnu::always_inline]] Debt through(const Debt& k, float own) const {
    Debt r;
    const Four along = bend * (w[0] * k.v[0] + w[1] * k.v[1] + w[2] * k.v[2]);
    r.v[0] = Four{{own, 0, 0, 0}} - drag * k.v[0] - w[0] * along;
    r.v[1] = length * k.y - drag * k.v[1] - w[1] * along;
    r.v[2] = Four{{0, 0, own, 0}} - drag * k.v[2] - w[2] * along;
    r.y = rise[0] * k.v[0] + rise[1] * k.v[1] + rise[2] * k.v[2];
    return r;
  }
};

/// Where in a step a height > 0 falls to 0: Hermite's cubic, halved to a thousandth.
double fall_within(double from, double from_slope, double to, double to_slope) {
  double low = 0, high = 1;
  for (int j = 0; j < 10; ++j) {
    const double s = 0.5 * (low + high), s2 = s * s, s3 = s2 * s;
    const double height =
        (2 * s3 - 3 * s2 + 1) * from + (s3 - 2 * s2 + s) * from_slope + (3 * s2 - 2 * s3) * to + (s3 - s2) * to_slope;
    (height > 0 ? low : high) = s;
  }
  return high;
}

}  // namespace

template <bool Plain>
bool AimSolver::record_in(Vec3d u, double time, double allowed, Path& path, bool falling) const {
  const double share = allowed / math::max(math::length(u) * time, 1e-9);
  const double bend_speed = speed_of_a_bend(share);
  const double least = 0.5 * fall_speed_, tolerance = allowed / time;
  Path::Stage first;
  Vec3d x = shooter_.muzzle, v = u, k = rough_.at<Plain>(x, v, first);
  double t = 0, h = math::min(0.25 * math::max(math::length(v), least) / math::max(math::length(k), 1e-9), time);
  const auto keep_node = [&] { path.node[path.count].put(t, x, v, k); };
  path.count = 0;
  keep_node();
  for (int i = 0; i < 400 && path.count < Path::most; ++i) {
    const double speed = math::length(v), strength = math::max(math::length(k), 1e-9), bend = bend_speed / strength;
    if (speed > 0.85 * sound_) {
      h = math::min(h, far_bend * bend);
      if (h > bend && speed - h * strength < 1.15 * sound_) h = bend;
    }
    if (share < 5e-4) h = math::min(h, time / 12);
    bool last = !falling && t + h >= time * (1 - 1e-12);
    if (last) h = time - t;
    Path::Stage* s = path.stage[path.count];
    s[0] = first;
    Path::Stage after;
    const auto at = [&](int stage, Vec3d position, Vec3d velocity) __attribute__((always_inline)) {
      if (stage == 2 || stage == 3) return rough_.at<Plain>(position, velocity, s[stage - 1]);
      return stage < 6 ? rough_.at<Plain>(position, velocity) : rough_.at<Plain>(position, velocity, after);
    };
    const Step end = flight_step(at, x, v, k, h);
    const double room = tolerance / math::max(end.error, 1e-30);
    const double factor = math::clamp(0.8 * math::sqrt(math::sqrt(room)), 0.2, 1.7);
    if (room >= 1) {
      if (falling && end.v.y < 0 && end.x.y < target_(t + h).y) {
        // Once more, as far as it takes to come down to the target.
        const double drop = x.y - target_(t).y, left = end.x.y - target_(t + h).y;
        falling = false;
        time = t + (drop > 0 ? h * fall_within(drop, h * (v.y - velocity_of_target(t).y), left,
                                               h * (end.v.y - velocity_of_target(t + h).y))
                             : h);
        if (time < t + h) {
          h = time - t;
          continue;
        }
        last = true;
      }
      x = end.x;
      v = end.v;
      k = end.k;
      first = after;
      t = last ? time : t + h;
      ++path.count;
      keep_node();
      if (last) {
        path.stage[path.count][0] = first;
        path.arrival = {x, v};
        return true;
      }
    }
    h *= factor;
    if (!(h > 1e-9 * time) || t > options_.longest_time) return false;
  }
  return false;
}

void AimSolver::sensitivities(Path& path) {
  Debt debt{};
  debt.y = Four{{0, 1, 0, 0}};
  path.debt[path.count] = debt;
  for (int n = path.count - 1; n >= 0; --n) {
    // exp(h A), A the mean, by its series: of parts of the step, where it is long beside what drag takes.
    const float step = float(path.node[n + 1].t - path.node[n].t);
    const Path::Stage& middle = path.stage[n][1];
    const float strength =
        middle.drag + middle.bend * (middle.w[0] * middle.w[0] + middle.w[1] * middle.w[1] + middle.w[2] * middle.w[2]);
    const float load = step * strength;
    const int parts = load < 20 ? 1 + int(math::max(load, 0.0f)) : 20;
    const float h = step / float(parts);
    const MeanSlope mean(path.stage[n], path.stage[n + 1], h);
    for (int part = 0; part < parts; ++part) {
      Debt term = debt;
      for (int j = 1; j <= 4; ++j) {
        term = mean.through(term, j == 1 ? h : 0);
        const Four by = Four::splat(1 / float(j));
        for (Four& v : term.v) v = by * v;
        term.y = by * term.y;
        for (int i = 0; i < 3; ++i) debt.v[i] = debt.v[i] + term.v[i];
        debt.y = debt.y + term.y;
      }
    }
    path.debt[n] = debt;
  }
  for (int i = 0; i < 3; ++i) path.by_velocity[i] = {debt.v[0].v[i], debt.v[1].v[i], debt.v[2].v[i]};
}

template bool AimSolver::record_in<true>(Vec3d, double, double, Path&, bool) const;
template bool AimSolver::record_in<false>(Vec3d, double, double, Path&, bool) const;

}  // namespace carom::ballistics::detail
