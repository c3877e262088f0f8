// Recorded paths of the aim solver: how the arrival depends on the start, and by how much it is off.
#include <utility>

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

using Four = math::WideFloat<4>;

using Debt = FlightPath::Debt;
[[gnu::always_inline]] inline void add(Debt& to, float s, const Debt& from) {
  const Four scale = Four::splat(s);
  for (int i = 0; i < 3; ++i) to.v[i] = to.v[i] + scale * from.v[i];
  to.y = to.y + scale * from.y;
}
[[gnu::always_inline]] inline Four times(const Debt& m, const float* v) {
  return Four::splat(v[0]) * m.v[0] + Four::splat(v[1]) * m.v[1] + Four::splat(v[2]) * m.v[2];
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

/// ∫ H d of the defect d over a step, H Hermite's cubics: what is weighted by a cubic in s takes its values (0, 1) and
/// slopes at both ends of them.
struct Moments {
  Pairs start{}, start_slope{}, end{}, end_slope{};
};

/// What a push within a step does at its end, along the velocity through the air or across it: e' = −rate e.
struct Push {
  double at_start, slope_at_start, slope_at_end;  // of the velocity at the end: 1 for a push there
  double way, way_slope;                          // of the place: 0 and −1 for a push at the end

  /// `z`: −rate times the length of the step, at its beginning, .3, .8 and the end of it.
  explicit Push(const double (&z)[4]) {
    const double mean = 1.0 / 12 * z[0] + 10.0 / 21 * z[1] + 5.0 / 12 * z[2] + 1.0 / 42 * z[3];
    const double even = 1 + mean * mean / 12, odd = 0.5 * mean;
    at_start = (even + odd) / (even - odd);
    slope_at_start = -z[0] * at_start;
    slope_at_end = -z[3];
    way = 0.5 * (1 + at_start) + (z[0] - z[3] * at_start) / 12;
    way_slope = -1 - z[0] * way;
  }
};

/// Gauss's six points from `from` to `to`, halved where the fifth and third Legendre coefficients of the defect say
/// that they are too few: at bends of drag curves and of the wind. (The defect of a smooth motion is even.)
template <bool Plain>
void gather(const PointMassPull& pull, const Interpolant& flown, double from, double to, double budget,
            Moments& moments) {
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
  if (width > 0.05 && size(sum(rest)) + 0.1 * size(sum(less)) > budget) {
    gather<Plain>(pull, flown, from, 0.5 * (from + to), budget, moments);
    gather<Plain>(pull, flown, 0.5 * (from + to), to, budget, moments);
    return;
  }
  for (int q = 0; q < gauss_pairs; ++q) {
    const Pair s = at[q], s2 = s * s, s3 = s2 * s, end = Pair::splat(3) * s2 - Pair::splat(2) * s3;
    add(moments.start, Pair::splat(1) - end, defect[q]);
    add(moments.start_slope, s3 - Pair::splat(2) * s2 + s, defect[q]);
    add(moments.end, end, defect[q]);
    add(moments.end_slope, s3 - s2, defect[q]);
  }
}

/// Where in a step its heights pass the bends of the wind and its Mach numbers those of the drag curve, in rising order
/// of s.
struct Cuts {
  static constexpr int most = 40;
  int count = 0;
  double s[most + 1];

  Cuts(const Projectile& projectile, const Conditions& conditions, const Interpolant& flown, const FlightPath::Node& a,
       const FlightPath::Node& b) {
    const auto height = [&](double at) { return value(flown.position[1], at); };
    s[count++] = 0;
    if (conditions.wind.levels().size() > 1) {
      double turn = 1;  // up to there heights only rise or only fall
      if ((a.v[1] > 0) != (b.v[1] > 0)) turn = root([&](double at) { return value(flown.velocity[1], at); }, 0, 1);
      const auto levels = [&](double low, double high, auto&& keep) {
        conditions.wind.for_each_bend(low, high, least, keep);
      };
      between(levels, height, 0, turn);
      if (turn < 1) between(levels, height, turn, 1);
    }
    if (projectile.drag.has_bends()) {
      const auto mach = [&](double at) {
        const double y = height(at);
        const Vec3d v{value(flown.velocity[0], at), value(flown.velocity[1], at), value(flown.velocity[2], at)};
        return math::length(v - conditions.wind.at(y)) / conditions.air.at(y).speed_of_sound;
      };
      const auto nodes = [&](double low, double high, auto&& keep) { projectile.drag.for_each_bend(low, high, keep); };
      between(nodes, mach, 0, 0.5);  // speed may have its least or its most within
      between(nodes, mach, 0.5, 1);
    }
    for (int i = 1; i < count; ++i)
      for (int j = i; j > 1 && s[j] < s[j - 1]; --j) std::swap(s[j], s[j - 1]);
    s[count] = 1;
  }

 private:
  static constexpr double least = 0.2;  // m/s
  template <int N>
  static double value(const Pair (&c)[N], double s) {
    double r = c[N - 1].v[0];
    for (int i = N - 2; i >= 0; --i) r = c[i].v[0] + s * r;
    return r;
  }
  /// To a thousandth: secants, with every third step a bisection.
  template <class F>
  static double root(F&& f, double low, double high) {
    double at_low = f(low), at_high = f(high);
    for (int i = 0; i < 12 && high - low > 1e-3; ++i) {
      const double chord = low - at_low * (high - low) / (at_high - at_low);
      const double s = i % 3 == 2 || !(chord > low && chord < high) ? 0.5 * (low + high) : chord;
      const double at = f(s);
      if (math::abs(at) < 1e-3 * math::abs(at_high - at_low)) return s;
      if ((at > 0) == (at_low > 0)) {
        low = s;
        at_low = at;
      } else {
        high = s;
        at_high = at;
      }
    }
    return 0.5 * (low + high);
  }
  template <class Bends, class F>
  void between(Bends&& bends, F&& f, double from, double to) {
    const double begin = f(from), end = f(to);
    bends(math::min(begin, end), math::max(begin, end), [&](double level) {
      if (count < most) s[count++] = root([&](double at) { return f(at) - level; }, from, to);
    });
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

void AimSolver::sensitivities(Path& path) {
  Debt debt{};
  debt.y = Four{{0, 1, 0, 0}};
  path.debt[path.count] = debt;
  for (int n = path.count - 1; n >= 0; --n) {
    const Debt after = debt;
    const float step = float(path.node[n + 1].t - path.node[n].t);
    Debt of[6];  // by the stages
    for (int j = 5; j >= 0; --j) {
      Debt k{};
      if (j != 1) add(k, step * weight[j], after);
      for (int m = j + 1; m < 6; ++m) add(k, step * tableau[m][j], of[m]);
      of[j] = through(k, path.stage[n][j], step * weight[j]);
      for (int i = 0; i < 3; ++i) debt.v[i] = debt.v[i] + of[j].v[i];
      debt.y = debt.y + of[j].y;
    }
    path.debt[n] = debt;
  }
  for (int i = 0; i < 3; ++i) path.by_velocity[i] = {debt.v[0].v[i], debt.v[1].v[i], debt.v[2].v[i]};
}

template <bool Plain>
Vec3d AimSolver::measure_in(Path& path, double fine) const {
  Vec3d off{};
  path.bends = false;
  for (int n = 0; n < path.count; ++n) {
    const Path::Node &a = path.node[n], &b = path.node[n + 1];
    const Debt &owed = path.debt[n], &after = path.debt[n + 1];
    const double h = b.t - a.t,
                 most = math::abs(owed.v[0].v[0]) + math::abs(owed.v[1].v[1]) + math::abs(owed.v[2].v[2]);
    const Interpolant flown(a, b);
    const Cuts cuts(projectile_, conditions_, flown, a, b);
    path.bends = path.bends || cuts.count > 1;
    Moments moments;
    for (int i = 0; i < cuts.count; ++i)
      gather<Plain>(pull_, flown, cuts.s[i], cuts.s[i + 1], fine / (h * most), moments);
    const Path::Stage* s = path.stage[n];
    const Path::Stage* of[4] = {s, s + 2, s + 3, n + 1 < path.count ? path.stage[n + 1] : s + 5};
    double across[4], along[4];
    for (int i = 0; i < 4; ++i) {
      const double w2 =
          double(of[i]->w[0]) * of[i]->w[0] + double(of[i]->w[1]) * of[i]->w[1] + double(of[i]->w[2]) * of[i]->w[2];
      across[i] = -h * of[i]->drag;
      along[i] = across[i] - h * of[i]->bend * w2;
    }
    const Push aside(across), ahead(along);
    const Vec3d start = sum(moments.start), start_slope = sum(moments.start_slope), end = sum(moments.end),
                end_slope = sum(moments.end_slope);
    const auto velocity = [&](const Push& push) {
      return h * (end + push.at_start * start + push.slope_at_start * start_slope + push.slope_at_end * end_slope);
    };
    const auto place = [&](const Push& push) {
      return (h * h) * (push.way * start + push.way_slope * start_slope - end_slope);
    };
    const Vec3d w{s[3].w[0], s[3].w[1], s[3].w[2]}, e = w / math::max(math::length(w), 1e-9);
    const auto both = [&](Vec3d sideways, Vec3d forward) { return sideways + math::dot(e, forward - sideways) * e; };
    const Path::Correction more{both(place(aside), place(ahead)), both(velocity(aside), velocity(ahead))};
    path.correction[n].x += more.x;
    path.correction[n].v += more.v;
    off += more.x;
    off.y -= more.x.y;
    for (int i = 0; i < 3; ++i)
      off[i] += after.v[0].v[i] * more.v.x + after.v[1].v[i] * more.v.y + after.v[2].v[i] * more.v.z +
                after.y.v[i] * more.x.y;
  }
  return off;
}

template bool AimSolver::record_in<true>(Vec3d, double, double, Path&, bool) const;
template bool AimSolver::record_in<false>(Vec3d, double, double, Path&, bool) const;
template Vec3d AimSolver::measure_in<true>(Path&, double) const;
template Vec3d AimSolver::measure_in<false>(Path&, double) const;

}  // namespace carom::ballistics::detail
