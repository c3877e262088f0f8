// Recorded paths of the aim solver: what the arrival owes to the start and to every element, and how a path is moved to
// where it should be.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

void AimSolver::linearize(Path& path, bool finely) const {
#if defined(__x86_64__)
  if (wide_)
    aim_avx2::linearize(medium_, path, finely);
  else
#endif
    aim_baseline::linearize(medium_, path, finely);
  path.lands = path.bends = false;
  path.steep = 0;
}

void AimSolver::move(Path& path, Vec3d du, double dt) {
  const Path::Elements& of = path.elements;
  float dx[3] = {}, dv[3] = {float(du.x), float(du.y), float(du.z)};
  const double later = dt / path.time();
  for (int n = 0; n <= path.count; ++n) {
    const double stretch = later * path.t[n];
    path.t[n] += stretch;
    for (int i = 0; i < 3; ++i) {
      path.x[i][n] += double(dx[i]) + stretch * path.v[i][n];
      path.v[i][n] += double(dv[i]) + stretch * path.k[i][n];
    }
    if (n == 0) {  // exactly
      for (int i = 0; i < 3; ++i) path.v[i][0] += du[i] - double(dv[i]);
    }
    if (n == path.count) break;
    const float ahead = of.e[0][n] * dv[0] + of.e[1][n] * dv[1] + of.e[2][n] * dv[2];
    const float half = 0.5f * of.h[n], height = dx[1] + half * dv[1], sunk = half * (dx[1] + (2.0f / 3) * half * dv[1]);
    const float d = of.d[n] * ahead, b = of.b[n] * ahead, c = of.c[n], a = of.a[n];
    for (int i = 0; i < 3; ++i) {
      dx[i] += c * dv[i] + d * of.e[i][n] + sunk * of.q[i][n] + of.x[i][n];
      dv[i] = a * dv[i] + b * of.e[i][n] + height * of.q[i][n] + of.v[i][n];
    }
  }
}

int AimSolver::cut(const Path& path, double enough, double bend, Cut* cuts) const {
  int count = 0;
  const double slow = 0.85 * sound_, fast = 1.15 * sound_;
  for (int n = 0; n < path.count; ++n) {
    const double carries = path.carried(n);
    int parts = 1;  // the defect falls as the fourth power of the length
    while (parts < 8 && math::square(math::square(double(parts))) * parts * enough < carries) ++parts;
    // In the barrier, where drag bends too sharply for that, no longer than it takes to lose so much speed.
    const double from = math::length(Path::at(path.w, n)), to = math::length(Path::at(path.w, n + 1));
    const double lost = math::abs(from - to), usual = 1.0 / parts;
    const bool barrier = math::max(from, to) > slow && math::min(from, to) < fast && lost > 1.2 * bend;
    const double within = barrier ? math::min(bend / lost, usual) : usual;
    const double enters = barrier ? (from > to ? from - fast : slow - from) / lost : 2,
                 leaves = barrier ? (from > to ? from - slow : fast - from) / lost : 2;
    double s = 0;
    for (int j = 1; s < 1 - 0.3 * within; ++j) {
      if (count == Path::most) return count + 1;
      cuts[count++] = {n, s};
      if (!barrier)
        s = j * usual;
      else if (s >= leaves - 1e-9)
        s += usual;
      else
        s = s >= enters - 1e-9 ? s + within : math::min(s + usual, math::max(enters, s + within));
    }
  }
  return count;
}

void AimSolver::divide(Path& path, double enough, double bend) const {
  Cut cuts[Path::most];
  int count = cut(path, enough, bend, cuts);
  for (; count > Path::most && bend < sound_; enough *= 4, bend *= 2) count = cut(path, 4 * enough, 2 * bend, cuts);
  if (count > Path::most) return;
  Path::Arrival end{Path::at(path.x, path.count), Path::at(path.v, path.count)};
  Vec3d end_pull = Path::at(path.k, path.count);
  double end_time = path.time();
  path.count = count;
  path.put(count, end_time, end.position, end.velocity, end_pull);
  for (int to = count - 1; to >= 0;) {
    const int n = cuts[to].element;
    const Vec3d x = Path::at(path.x, n), v = Path::at(path.v, n), k = Path::at(path.k, n);
    const double t = path.t[n], h = end_time - t;
    const Vec3d d = end.position - x - h * v - (0.5 * h * h) * k, dv = h * (end.velocity - v - h * k),
                dk = (h * h) * (end_pull - k);
    const Vec3d c3 = 10.0 * d - 4.0 * dv + 0.5 * dk, c4 = 7.0 * dv - 15.0 * d - dk, c5 = 6.0 * d - 3.0 * dv + 0.5 * dk;
    for (; cuts[to].s > 0; --to) {
      const double s = cuts[to].s, by = s * h;
      path.put(to, t + by, x + by * (v + (0.5 * by) * k) + (s * s * s) * (c3 + s * (c4 + s * c5)),
               v + by * k + (s * s / h) * (3.0 * c3 + s * (4.0 * c4 + (5 * s) * c5)), k);
    }
    path.put(to--, t, x, v, k);
    end = {x, v};
    end_pull = k;
    end_time = t;
  }
}

}  // namespace carom::ballistics::detail
