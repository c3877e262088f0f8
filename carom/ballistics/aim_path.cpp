// Recorded paths of the aim solver: how the arrival depends on the start, and by how much it is off.
#include "carom/ballistics/detail/aim_solver.h"
#include "carom/math/simd_double.h"

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

Vec3d vec(const double* p) { return {p[0], p[1], p[2]}; }
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

using Pair = math::WideDouble<2>;
/// x and y, and z with an idle lane.
struct Pairs {
  Pair xy, z;
};
[[gnu::always_inline]] inline Pairs pairs(Vec3d v) { return {{Pair::Vector{v.x, v.y}}, {Pair::Vector{v.z, 0}}}; }
[[gnu::always_inline]] inline Vec3d vec(const Pairs& p) { return {p.xy.v[0], p.xy.v[1], p.z.v[0]}; }
[[gnu::always_inline]] inline void add(Pairs& to, double s, const Pairs& from) {
  const Pair scale = Pair::splat(s);
  to.xy = to.xy + scale * from.xy;
  to.z = to.z + scale * from.z;
}

/// Hermite's quintic over a step, from its start at s = 0 to its end at s = 1.
struct Interpolant {
  Pairs c[6];  // of the position, by powers of s
  double h;
  Interpolant(const FlightPath::Node& a, const FlightPath::Node& b) : h(b.t - a.t) {
    const Vec3d x = vec(a.x), v = h * vec(a.v), k = (h * h) * vec(a.k);
    const Vec3d d = vec(b.x) - x - v - 0.5 * k, dv = h * vec(b.v) - v - k, dk = (h * h) * vec(b.k) - k;
    c[0] = pairs(x);
    c[1] = pairs(v);
    c[2] = pairs(0.5 * k);
    c[3] = pairs(10.0 * d - 4.0 * dv + 0.5 * dk);
    c[4] = pairs(7.0 * dv - 15.0 * d - dk);
    c[5] = pairs(6.0 * d - 3.0 * dv + 0.5 * dk);
  }
};

/// Gauss's six points from `from` to `to`, halved where the fifth and third Legendre coefficients of the defect say
/// that they are too few: at bends of drag curves and of the wind. (The defect of a smooth motion is even.)
template <class At>
void gather(const At& at, const Interpolant& flown, double from, double to, double budget, Pairs* moment) {
  constexpr int points = 6;
  constexpr double place[points] = {0.033765242898423989, 0.16939530676686773, 0.38069040695840156,
                                    0.61930959304159849,  0.83060469323313224, 0.96623475710157603};
  constexpr double gauss[points] = {0.085662246189585178, 0.1803807865240693, 0.23395696728634552,
                                    0.23395696728634552,  0.1803807865240693, 0.085662246189585178};
  // Legendre's polynomials of these orders there.
  constexpr double fifth[points] = {-0.20571231105962262, 0.29439571492543726,  -0.33461902074104077,
                                    0.33461902074104088,  -0.29439571492543726, 0.20571231105962262};
  constexpr double third[points] = {-0.62824992464368901, 0.26911576974459905,  0.32396186535393517,
                                    -0.32396186535393534, -0.26911576974459905, 0.62824992464368901};
  const double width = to - from, by_h = 1 / flown.h;
  Pairs defect[points], rest{}, less{};
  for (int q = 0; q < points; ++q) {
    const double s = from + width * place[q], s2 = s * s, s3 = s2 * s, s4 = s2 * s2;
    const Pairs* c = flown.c;
    Pairs x = c[0], v = c[1], k{};
    add(x, s, c[1]);
    add(x, s2, c[2]);
    add(x, s3, c[3]);
    add(x, s4, c[4]);
    add(x, s4 * s, c[5]);
    add(v, 2 * s, c[2]);
    add(v, 3 * s2, c[3]);
    add(v, 4 * s3, c[4]);
    add(v, 5 * s4, c[5]);
    add(k, 2, c[2]);
    add(k, 6 * s, c[3]);
    add(k, 12 * s2, c[4]);
    add(k, 20 * s3, c[5]);
    const double share = gauss[q] * width;
    Pairs d{};
    add(d, share, pairs(at(vec(x), by_h * vec(v))));
    add(d, -share * by_h * by_h, k);
    defect[q] = d;
    add(rest, fifth[q], d);
    add(less, third[q], d);
  }
  const auto size = [](Vec3d v) { return math::abs(v.x) + math::abs(v.y) + math::abs(v.z); };
  if (width > 0.2 && size(vec(rest)) + 0.1 * size(vec(less)) > budget) {
    gather(at, flown, from, 0.5 * (from + to), budget, moment);
    gather(at, flown, 0.5 * (from + to), to, budget, moment);
    return;
  }
  for (int q = 0; q < points; ++q) {
    const double s = from + width * place[q], s2 = s * s, s3 = s2 * s;
    add(moment[0], 2 * s3 - 3 * s2 + 1, defect[q]);
    add(moment[1], s3 - 2 * s2 + s, defect[q]);
    add(moment[2], 3 * s2 - 2 * s3, defect[q]);
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
  const double bend_speed = sound_ * math::clamp((share < 5e-4 ? 0.4 : 0.6) * math::sqrt(math::sqrt(share)), 0.03, 0.2);
  constexpr double far_bend = 3;
  const double least = 0.5 * fall_speed_, tolerance = allowed / time;
  Path::Stage first;
  Vec3d x = shooter_.muzzle, v = u, k = pull_.at<Plain>(x, v, first);
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
      if (h > far_bend * bend) h = far_bend * bend;
      if (h > bend && speed - h * strength < 1.15 * sound_) h = bend;
    }
    if (share < 5e-4) h = math::min(h, time / 12);
    bool last = !falling && t + h >= time * (1 - 1e-12);
    if (last) h = time - t;
    Path::Stage* s = path.stage[path.count];
    s[0] = first;
    Path::Stage after;
    const auto at = [&](int stage, Vec3d position, Vec3d velocity) __attribute__((always_inline)) {
      return pull_.at<Plain>(position, velocity, stage < 6 ? s[stage] : after);
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
        const auto at = [&](Vec3d position, Vec3d velocity)
                            __attribute__((always_inline)) { return pull_.at<Plain>(position, velocity); };
        gather(at, Interpolant(a, path.node[n + 1]), 0, 1, fine / (h * owed), moment);
        off += h * (times(debt, vec(moment[0])) + times(after, vec(moment[2])) -
                    h * (times(slope, vec(moment[1])) + times(slope_after, vec(moment[3]))));
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
