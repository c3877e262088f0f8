// Recorded paths of the aim solver: how the arrival depends on the start, and by how much it is off.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

namespace {

/// Dormand and Prince's stages and weights of order 5.
constexpr float tableau[6][5] = {
    {},
    {float(1.0 / 5)},
    {float(3.0 / 40), float(9.0 / 40)},
    {float(44.0 / 45), -float(56.0 / 15), float(32.0 / 9)},
    {float(19372.0 / 6561), -float(25360.0 / 2187), float(64448.0 / 6561), -float(212.0 / 729)},
    {float(9017.0 / 3168), -float(355.0 / 33), float(46732.0 / 5247), float(49.0 / 176), -float(5103.0 / 18656)},
};
constexpr float weight[6] = {float(35.0 / 384), 0, float(500.0 / 1113), float(125.0 / 192), -float(2187.0 / 6784),
                             float(11.0 / 84)};

void put(double* p, Vec3d v) {
  p[0] = v.x;
  p[1] = v.y;
  p[2] = v.z;
}

using Four = math::WideFloat<4>;

/// What the arrival owes to a change of the velocity and of the height: columns of ∂x(T)/∂(v, y), the fourth lane idle.
/// Seven digits are plenty.
struct Debt {
  Four v[3], y;
};
[[gnu::always_inline]] inline void add(Debt& to, float s, const Debt& from) {
  const Four scale = Four::splat(s);
  for (int i = 0; i < 3; ++i) to.v[i] = to.v[i] + scale * from.v[i];
  to.y = to.y + scale * from.y;
}
[[gnu::always_inline]] inline Four times(const Debt& m, const float* v) {
  return Four::splat(v[0]) * m.v[0] + Four::splat(v[1]) * m.v[1] + Four::splat(v[2]) * m.v[2];
}
Vec3d times(const Debt& m, Vec3d v) {
  const float f[3] = {float(v.x), float(v.y), float(v.z)};
  const Four r = times(m, f);
  return {r.v[0], r.v[1], r.v[2]};
}
/// What is owed by the velocity and the height of a stage, where `k` is owed by its acceleration: k ∂a/∂v, k ∂a/∂y;
/// places owe themselves, `own`, to the arrival, but for what the height does.
[[gnu::always_inline]] inline Debt through(const Debt& k, const FlightPath::Stage& stage, float own) {
  Debt r;
  const Four along = Four::splat(stage.bend) * times(k, stage.w), drag = Four::splat(stage.drag);
  r.v[0] = Four{{own, 0, 0, 0}} - drag * k.v[0] - Four::splat(stage.w[0]) * along;
  r.v[1] = k.y - drag * k.v[1] - Four::splat(stage.w[1]) * along;
  r.v[2] = Four{{0, 0, own, 0}} - drag * k.v[2] - Four::splat(stage.w[2]) * along;
  r.y = times(k, stage.rise);
  return r;
}

using Pair = PointMassPull::Pair;
using Pairs = PointMassPull::Pairs;
void add(Pairs& to, Pair s, const Pairs& from) {
  to.x = to.x + s * from.x;
  to.y = to.y + s * from.y;
  to.z = to.z + s * from.z;
}
Vec3d sum(const Pairs& p) { return {p.x.v[0] + p.x.v[1], p.y.v[0] + p.y.v[1], p.z.v[0] + p.z.v[1]}; }

/// Hermite's quintic over a step, from its start at s = 0 to its end at s = 1.
struct Interpolant {
  Pair position[3][6], velocity[3][5], acceleration[3][4];  // by powers of s
  Interpolant(const FlightPath::Node& a, const FlightPath::Node& b) {
    const double h = b.t - a.t, by_h = 1 / h;
    for (int i = 0; i < 3; ++i) {
      const double v = h * a.v[i], k = h * h * a.k[i];
      const double d = b.x[i] - a.x[i] - v - 0.5 * k, dv = h * b.v[i] - v - k, dk = h * h * b.k[i] - k;
      const double c3 = 10 * d - 4 * dv + 0.5 * dk, c4 = 7 * dv - 15 * d - dk, c5 = 6 * d - 3 * dv + 0.5 * dk;
      const double x[6] = {a.x[i], v, 0.5 * k, c3, c4, c5};
      const double v_of[5] = {a.v[i], by_h * k, 3 * by_h * c3, 4 * by_h * c4, 5 * by_h * c5};
      for (int j = 0; j < 6; ++j) position[i][j] = Pair::splat(x[j]);
      for (int j = 0; j < 5; ++j) velocity[i][j] = Pair::splat(v_of[j]);
      for (int j = 0; j < 4; ++j) acceleration[i][j] = Pair::splat(by_h * (j + 1) * v_of[j + 1]);
    }
  }
};
template <int N>
[[gnu::always_inline]] inline Pair polynomial(const Pair (&c)[N], Pair s) {
  Pair r = c[N - 1];
  for (int i = N - 2; i >= 0; --i) r = c[i] + s * r;
  return r;
}

/// Gauss's six points of (0, 1), and their weights.
constexpr int gauss_pairs = 3;
constexpr Pair place[gauss_pairs] = {{{0.033765242898423989, 0.16939530676686773}},
                                     {{0.38069040695840156, 0.61930959304159849}},
                                     {{0.83060469323313224, 0.96623475710157603}}};
constexpr Pair gauss[gauss_pairs] = {{{0.085662246189585178, 0.1803807865240693}},
                                     {{0.23395696728634552, 0.23395696728634552}},
                                     {{0.1803807865240693, 0.085662246189585178}}};
// Legendre's polynomials of the fifth and third orders there.
constexpr Pair fifth[gauss_pairs] = {{{-0.20571231105962262, 0.29439571492543726}},
                                     {{-0.33461902074104077, 0.33461902074104088}},
                                     {{-0.29439571492543726, 0.20571231105962262}}};
constexpr Pair third[gauss_pairs] = {{{-0.62824992464368901, 0.26911576974459905}},
                                     {{0.32396186535393517, -0.32396186535393534}},
                                     {{-0.26911576974459905, 0.62824992464368901}}};

/// Gauss's six points from `from` to `to`, halved where the fifth and third Legendre coefficients of the defect say
/// that they are too few: at bends of drag curves and of the wind. (The defect of a smooth motion is even.)
template <bool Plain>
void gather(const PointMassPull& pull, const Interpolant& flown, double from, double to, double budget, Pairs* moment) {
  const double width = to - from;

  Pairs defect[gauss_pairs], rest{}, less{};
  Pair at[gauss_pairs];
  for (int q = 0; q < gauss_pairs; ++q) {
    const Pair s = Pair::splat(from) + Pair::splat(width) * place[q], share = Pair::splat(width) * gauss[q];
    Pairs x{};
    if constexpr (!Plain) {
      x.x = polynomial(flown.position[0], s);
      x.z = polynomial(flown.position[2], s);
    }
    x.y = polynomial(flown.position[1], s);
    const Pairs v{polynomial(flown.velocity[0], s), polynomial(flown.velocity[1], s), polynomial(flown.velocity[2], s)};
    const Pairs a = pull.at<Plain>(x, v);
    defect[q] = {share * (a.x - polynomial(flown.acceleration[0], s)),
                 share * (a.y - polynomial(flown.acceleration[1], s)),
                 share * (a.z - polynomial(flown.acceleration[2], s))};
    at[q] = s;
    add(rest, fifth[q], defect[q]);
    add(less, third[q], defect[q]);
  }
  const auto size = [](Vec3d v) { return math::abs(v.x) + math::abs(v.y) + math::abs(v.z); };
  if (width > 0.2 && size(sum(rest)) + 0.1 * size(sum(less)) > budget) {
    gather<Plain>(pull, flown, from, 0.5 * (from + to), budget, moment);
    gather<Plain>(pull, flown, 0.5 * (from + to), to, budget, moment);
    return;
  }
  for (int q = 0; q < gauss_pairs; ++q) {
    const Pair s = at[q], s2 = s * s, s3 = s2 * s, end = Pair::splat(3) * s2 - Pair::splat(2) * s3;
    add(moment[0], Pair::splat(1) - end, defect[q]);
    add(moment[1], s3 - Pair::splat(2) * s2 + s, defect[q]);
    add(moment[2], end, defect[q]);
    add(moment[3], s3 - s2, defect[q]);
  }
}

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
  const auto keep_node = [&] {
    Path::Node& n = path.node[path.count];
    n.t = t;
    put(n.x, x);
    put(n.v, v);
    put(n.k, k);
  };
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
      return rough_.at<Plain>(position, velocity, stage < 6 ? s[stage] : after);
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
        path.arrival = {x, v};
        return true;
      }
    }
    h *= factor;
    if (!(h > 1e-9 * time) || t > options_.longest_time) return false;
  }
  return false;
}

template <bool Plain>
void AimSolver::sensitivities_in(Path& path, double fine) const {
  Debt debt{}, slope_after{};
  debt.y = Four{{0, 1, 0, 0}};
  Vec3d off{};
  for (int n = path.count; n >= 0; --n) {
    const Path::Node& a = path.node[n];
    const Debt after = debt;
    double h = 0;
    if (n < path.count) {
      h = path.node[n + 1].t - a.t;
      const float step = float(h);
      Debt of[6];  // by the stages
      for (int j = 5; j >= 0; --j) {
        Debt k{};
        if (j != 1) add(k, step * weight[j], after);
        for (int m = j + 1; m < 6; ++m) add(k, step * tableau[m][j], of[m]);
        of[j] = through(k, path.stage[n][j], step * weight[j]);
        for (int i = 0; i < 3; ++i) debt.v[i] = debt.v[i] + of[j].v[i];
        debt.y = debt.y + of[j].y;
      }
    }
    if (fine > 0) {
      const Path::Stage& stage = path.stage[math::min(n, path.count - 1)][n < path.count ? 0 : 5];
      const Debt slope = through(debt, stage, 1);  // −d(debt)/dt
      if (n < path.count) {
        // The defect of the interpolant, weighted as a cubic in s makes what is owed.
        Pairs moment[4]{};
        const double owed = math::abs(debt.v[0].v[0]) + math::abs(debt.v[1].v[1]) + math::abs(debt.v[2].v[2]);
        gather<Plain>(pull_, Interpolant(a, path.node[n + 1]), 0, 1, fine / (h * owed), moment);
        off += h * (times(debt, sum(moment[0])) + times(after, sum(moment[2])) -
                    h * (times(slope, sum(moment[1])) + times(slope_after, sum(moment[3]))));
      }
      slope_after = slope;
    }
  }
  for (int i = 0; i < 3; ++i) path.by_velocity[i] = {debt.v[0].v[i], debt.v[1].v[i], debt.v[2].v[i]};
  path.off = off;
}

template bool AimSolver::record_in<true>(Vec3d, double, double, Path&, bool) const;
template bool AimSolver::record_in<false>(Vec3d, double, double, Path&, bool) const;
template void AimSolver::sensitivities_in<true>(Path&, double) const;
template void AimSolver::sensitivities_in<false>(Path&, double) const;

}  // namespace carom::ballistics::detail
