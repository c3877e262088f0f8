// Elements of a path of the aim solver that take more than a few points: something is bent within them.
#include <utility>

#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

namespace {

/// Where in an element its heights pass the bends of the wind and its Mach numbers those of the drag curve, in rising
/// order of s.
struct Cuts {
  static constexpr int most = 40;
  int count = 0;
  bool lands = false;
  double s[most + 1];

  /// `layered`: there are such bends of the wind, by more than `least` m/s; `bent`: of the drag curve.
  Cuts(const Projectile& projectile, const Conditions& conditions, bool layered, bool bent, double least,
       const FlightElement& flown, const FlightPath& p, int n) {
    const auto height = [&](double at) { return flown.place(1, at); };
    s[count++] = 0;
    const auto levels = conditions.wind.levels();
    const double ground = levels.size() > 1 ? levels.front().height : -1e300;
    lands = (p.x[1][n] > ground) != (p.x[1][n + 1] > ground);  // where profiles of wind begin, with a leap
    if (lands && !layered) s[count++] = root([&](double at) { return height(at) - ground; }, 0, 1);
    if (layered) {
      double turn = 1;  // up to there heights only rise or only fall
      if ((p.v[1][n] > 0) != (p.v[1][n + 1] > 0)) turn = root([&](double at) { return flown.velocity(1, at); }, 0, 1);
      const auto bends = [&](double low, double high, auto&& keep) {
        conditions.wind.for_each_bend(low, high, least, keep);
      };
      between(bends, height, 0, turn);
      if (turn < 1) between(bends, height, turn, 1);
    }
    if (bent) {
      const auto mach = [&](double at) {
        const double y = height(at);
        const Vec3d v{flown.velocity(0, at), flown.velocity(1, at), flown.velocity(2, at)};
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
  /// To a hundred-thousandth: secants, with every third step a bisection.
  template <class F>
  static double root(F&& f, double low, double high) {
    double at_low = f(low), at_high = f(high);
    for (int i = 0; i < 20 && high - low > 1e-5; ++i) {
      const double chord = low - at_low * (high - low) / (at_high - at_low);
      const double s = i % 3 == 2 || !(chord > low && chord < high) ? 0.5 * (low + high) : chord;
      const double at = f(s);
      if (math::abs(at) < 1e-5 * math::abs(at_high - at_low)) return s;
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

double AimSolver::unsettled(Path& path) const {
  double sum = 0;
  for (int n = 0; n < path.count; ++n) {
    const bool lands = (path.x[1][n] > ground_) != (path.x[1][n + 1] > ground_);
    const double h = path.t[n + 1] - path.t[n], fades = math::max(path.along[n], path.along[n + 1]);
    path.lands = path.lands || lands;
    const auto rise = [&](int i) {
      return math::abs(path.rise[0][i]) + math::abs(path.rise[1][i]) + math::abs(path.rise[2][i]);
    };
    const double slower = math::length(Path::at(path.w, n + 1)) - math::length(Path::at(path.w, n)),
                 steeper = math::abs(path.along[n + 1] - path.along[n]) / math::max(math::abs(slower), 1e-3);
    sum += path.carried(n) * ((lands ? 1 : h * h * math::max(rise(n), rise(n + 1))) / 6 +
                              5e-3 * math::square(h * fades) + h * steeper * path.elements.defect[n]);
  }
  return sum;
}

double AimSolver::kinks(const Path& path, int n) const {
  if (!medium_.drag.varies) return 0;
  constexpr double most = 1.2e-4;  // of a half of s², that seven of Lobatto's points mistake, wherever it begins
  const environment::AirColumn::Air air = conditions_.air.at(path.x[1][n]);
  const Vec3d from = Path::at(path.w, n), to = Path::at(path.w, n + 1);
  const double speed = math::length(from), h = path.t[n + 1] - path.t[n];
  const double way[] = {speed, 0.5 * math::length(from + to), math::length(to)};
  double sum = 0, mach = speed / air.speed_of_sound, turns = projectile_.drag.turns(mach);
  for (int half = 1; half < 3; ++half) {  // the speed may have its least within
    const double next = way[half] / air.speed_of_sound, to_turns = projectile_.drag.turns(next);
    sum += math::square(2 * (next - mach)) * math::abs(to_turns - turns);
    mach = next;
    turns = to_turns;
  }
  return most * h * medium_.half_area * air.density * math::square(speed) * sum;
}

void AimSolver::measure(Path& path) const {
  Path::Elements& of = path.elements;
  struct Hard {
    int element;
    double budget;
    AimMoments moments;
  } hard[Path::most];
  struct Waiting {
    int hard;
    double from, to;
  };
  constexpr int most_waiting = 1024, most_parts = 16;
  Waiting waiting[most_waiting];
  int hards = 0, waits = 0;
  for (int n = 0; n < path.count; ++n) {
    const double reach = path.reach(n), rest = of.rest[n] * reach;
    const bool lands = (path.x[1][n] > ground_) != (path.x[1][n + 1] > ground_), cut = lands || layered_ || bent_;
    const double h = path.t[n + 1] - path.t[n];
    // Tables of straight lines have bends too that are not worth a cut: not much may hide there.
    const bool settled =
        rest < (bent_ ? 0.25 : 1.5) * options_.tolerance && reach * kinks(path, n) < 2 * options_.tolerance;
    if (!cut && settled) continue;
    double s[Cuts::most + 1] = {0, 0.5, 1};
    int parts = 2;
    bool bends = false;
    if (cut) {
      const Cuts cuts(projectile_, conditions_, layered_, bent_, least_bend, FlightElement(path, n), path, n);
      bends = cuts.count > 1;
      path.bends = path.bends || bends;
      if (!bends && settled) continue;
      if (bends) {
        parts = cuts.count;
        for (int i = 0; i <= parts; ++i) s[i] = cuts.s[i];
      }
    }
    if (waits + parts > most_waiting) break;
    // What is smooth is mistaken by less than its coefficients say.
    hard[hards] = {n, (bends || bent_ ? 0.15 : 1) * options_.tolerance / (h * reach), {}};
    for (int i = parts - 1; i >= 0; --i) waiting[waits++] = {hards, s[i], s[i + 1]};
    ++hards;
  }
  // Parts by the dozen, each halved where its points do not settle it.
  while (waits > 0) {
    AimPart parts[most_parts];
    int of_hard[most_parts], count = 0;
    for (; waits > 0 && count < most_parts; ++count) {
      const Waiting& next = waiting[--waits];
      of_hard[count] = next.hard;
      parts[count].element = hard[next.hard].element;
      parts[count].from = next.from;
      parts[count].to = next.to;
    }
    lanes_.measure(medium_, path, parts, count);
    for (int i = count - 1; i >= 0; --i) {
      const AimPart& part = parts[i];
      Hard& whole = hard[of_hard[i]];
      if (part.to - part.from > 0.05 && part.rest > whole.budget && waits + 2 <= most_waiting) {
        const double middle = 0.5 * (part.from + part.to);
        waiting[waits++] = {of_hard[i], middle, part.to};
        waiting[waits++] = {of_hard[i], part.from, middle};
        continue;
      }
      whole.moments.add(part.moments);
    }
  }
  for (int i = 0; i < hards; ++i) {
    const int n = hard[i].element;
    const AimMoments& m = hard[i].moments;
    const double h = path.t[n + 1] - path.t[n];
    const auto fades = [&](int node, Vec3d push) {
      const Vec3d w = Path::at(path.w, node);
      const double bend = (path.along[node] - path.drag[node]) / math::max(math::length_squared(w), 1e-18);
      return h * (path.drag[node] * push + (bend * math::dot(w, push)) * w);
    };
    const Vec3d u = m.at(0) + fades(n, m.at(1)), e{of.e[0][n], of.e[1][n], of.e[2][n]};
    const double ahead = math::dot(e, u);
    const Vec3d more_v = h * (m.at(2) + fades(n + 1, m.at(3)) + double(of.a[n]) * u + (of.b[n] * ahead) * e);
    const Vec3d more_x = h * (double(of.c[n]) * u + (of.d[n] * ahead) * e - h * (m.at(1) + m.at(3)));
    for (int j = 0; j < 3; ++j) {
      of.x[j][n] = float(more_x[j]);
      of.v[j][n] = float(more_v[j]);
    }
  }
  lanes_.settle(path);
}

}  // namespace carom::ballistics::detail
