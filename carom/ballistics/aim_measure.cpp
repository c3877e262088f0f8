// By how much a recorded path of the aim solver is off.
#include <utility>

#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

namespace {

using Pair = PointMassPull::Pair;
using Pairs = PointMassPull::Pairs;
void add(Pairs& to, Pair s, const Pairs& from) {
  to.x = to.x + s * from.x;
  to.y = to.y + s * from.y;
  to.z = to.z + s * from.z;
}
Vec3d sum(const Pairs& p) { return {p.x.v[0] + p.x.v[1], p.y.v[0] + p.y.v[1], p.z.v[0] + p.z.v[1]}; }

/// Hermite's quintic over a step, from its start at s = 0 to its end at s = 1. `Plain`: of the positions the height
/// alone.
template <bool Plain>
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
      for (int j = 0; j < 6 && (!Plain || i == 1); ++j) position[i][j] = Pair::splat(x[j]);
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

/// Gauss's eight points of (0, 1), and their weights.
constexpr int gauss_pairs = 4;
constexpr Pair place[gauss_pairs] = {{{0.019855071751231856, 0.10166676129318658}},
                                     {{0.2372337950418355, 0.4082826787521751}},
                                     {{0.591717321247825, 0.7627662049581645}},
                                     {{0.8983332387068135, 0.9801449282487682}}};
constexpr Pair gauss[gauss_pairs] = {{{0.05061426814518809, 0.11119051722668723}},
                                     {{0.1568533229389437, 0.181341891689181}},
                                     {{0.181341891689181, 0.1568533229389437}},
                                     {{0.11119051722668723, 0.05061426814518809}}};
// Legendre's polynomials of the seventh and fifth orders there.
constexpr Pair seventh[gauss_pairs] = {{{-0.15501881289035005, 0.2265762383999968}},
                                       {{-0.2685203140877153, 0.28855496859568763}},
                                       {{-0.28855496859568763, 0.2685203140877153}},
                                       {{-0.2265762383999968, 0.15501881289035005}}};
constexpr Pair fifth[gauss_pairs] = {{{-0.4828486810505167, 0.4033170755970801}},
                                     {{-0.031045687085550933, -0.29156822258958437}},
                                     {{0.29156822258958437, 0.031045687085550933}},
                                     {{-0.4033170755970801, 0.4828486810505167}}};

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

/// Gauss's eight points from `from` to `to`, halved where the seventh and fifth Legendre coefficients of the defect say
/// that they are too few: at bends of drag curves and of the wind. (The defect of a smooth motion is even.)
template <bool Plain>
void gather(const PointMassPull& pull, const Interpolant<Plain>& flown, double from, double to, double budget,
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
    add(rest, seventh[q], defect[q]);
    add(less, fifth[q], defect[q]);
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
  bool layers = false, lands = false;
  double s[most + 1];

  /// `layered`: there are such bends of the wind, by more than `least` m/s; `bent`: of the drag curve.
  template <bool Plain>
  Cuts(const Projectile& projectile, const Conditions& conditions, bool layered, bool bent, double least,
       const Interpolant<Plain>& flown, const FlightPath::Node& a, const FlightPath::Node& b) {
    const auto height = [&](double at) { return value(flown.position[1], at); };
    s[count++] = 0;
    const auto levels = conditions.wind.levels();
    const double ground = levels.size() > 1 ? levels.front().height : -1e300;
    lands = (a.x[1] > ground) != (b.x[1] > ground);  // where profiles of wind begin, with a leap
    if (lands && !layered) s[count++] = root([&](double at) { return height(at) - ground; }, 0, 1);
    if (layered) {
      double turn = 1;  // up to there heights only rise or only fall
      if ((a.v[1] > 0) != (b.v[1] > 0)) turn = root([&](double at) { return value(flown.velocity[1], at); }, 0, 1);
      const auto bends = [&](double low, double high, auto&& keep) {
        conditions.wind.for_each_bend(low, high, least, keep);
      };
      between(bends, height, 0, turn);
      if (turn < 1) between(bends, height, turn, 1);
      layers = count > 1;
    }
    if (bent) {
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

}  // namespace

template <bool Plain>
Vec3d AimSolver::measure_in(Path& path, double fine) const {
  Vec3d off{};
  path.bends = path.layers = false;
  path.total = path.steep = 0;
  for (int n = 0; n < path.count; ++n) {
    const Path::Node &a = path.node[n], &b = path.node[n + 1];
    const Path::Debt &owed = path.debt[n], &after = path.debt[n + 1];
    const double h = b.t - a.t,
                 most = math::abs(owed.v[0].v[0]) + math::abs(owed.v[1].v[1]) + math::abs(owed.v[2].v[2]);
    const Interpolant<Plain> flown(a, b);
    const Cuts cuts(projectile_, conditions_, layered_, bent_, least_bend, flown, a, b);
    path.bends = path.bends || cuts.count > 1;
    path.layers = path.layers || cuts.layers;
    // Smooth steps err independently of each other.
    const double budget = (cuts.count > 1 ? 1 : 2) * fine / (h * most);
    Moments moments;
    for (int i = 0; i < cuts.count; ++i) gather<Plain>(pull_, flown, cuts.s[i], cuts.s[i + 1], budget, moments);
    const Path::Stage* s = path.stage[n];
    const Path::Stage* of[4] = {s, s + 1, s + 2, path.stage[n + 1]};
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
    const float* const last = of[3]->w;
    const Vec3d w{last[0], last[1], last[2]}, e = w / math::max(math::length(w), 1e-9);
    const auto both = [&](Vec3d sideways, Vec3d forward) { return sideways + math::dot(e, forward - sideways) * e; };
    const Path::Correction more{both(place(aside), place(ahead)), both(velocity(aside), velocity(ahead))};
    path.correction[n].x += more.x;
    path.correction[n].v += more.v;
    Vec3d moved{more.x.x, 0, more.x.z};
    for (int i = 0; i < 3; ++i)
      moved[i] += after.v[0].v[i] * more.v.x + after.v[1].v[i] * more.v.y + after.v[2].v[i] * more.v.z +
                  after.y.v[i] * more.x.y;
    off += moved;
    path.total += math::length(moved);
    // What an error of the height within the step does there; at its beginning there is none.
    const auto rise = [](const Path::Stage& stage) {
      return double(math::abs(stage.rise[0]) + math::abs(stage.rise[1]) + math::abs(stage.rise[2]));
    };
    const double feeds = cuts.lands ? 1 : h * h * math::max(rise(s[1]), rise(s[2]));
    path.steep += feeds / 6 * math::length(moved);
  }
  return off;
}

template Vec3d AimSolver::measure_in<true>(Path&, double) const;
template Vec3d AimSolver::measure_in<false>(Path&, double) const;

}  // namespace carom::ballistics::detail
