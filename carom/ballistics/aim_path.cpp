// Recorded paths of the aim solver: what the arrival owes to the start and to every element, and how a path is moved to
// where it should be.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

namespace {

using Four = math::WideFloat<4>;
using Debt = FlightPath::Debt;

/// What the debt at the end of an element owes before it.
[[gnu::always_inline]] inline Debt before(const FlightPath::Elements& of, int n, const Debt& after) {
  const auto sum = [&](const float(&k)[3][FlightPath::padded]) __attribute__((always_inline)) {
    return Four::splat(k[0][n]) * after.v[0] + Four::splat(k[1][n]) * after.v[1] + Four::splat(k[2][n]) * after.v[2];
  };
  const Four e{{of.e[0][n], of.e[1][n], of.e[2][n], 0}}, q{{of.q[0][n], of.q[1][n], of.q[2][n], 0}};
  const float a = of.a[n], c = of.c[n], d = of.d[n], h = of.h[n];
  const Four ahead = Four::splat(d) * (e + Four::splat(of.e[1][n]) * after.y) + Four::splat(of.b[n]) * sum(of.e);
  const Four pushed = sum(of.q), half = Four::splat(0.5f * h);
  Debt r;
  for (int i = 0; i < 3; ++i) r.v[i] = Four::splat(a) * after.v[i] + Four::splat(of.e[i][n]) * ahead;
  r.v[0] = r.v[0] + Four{{c, 0, 0, 0}};
  r.v[1] = r.v[1] + Four{{0, c, 0, 0}} + Four::splat(c) * after.y + half * (pushed + Four::splat(h * (1.0f / 3)) * q);
  r.v[2] = r.v[2] + Four{{0, 0, c, 0}};
  r.y = after.y + pushed + half * q;
  return r;
}

}  // namespace

void AimSolver::linearize(Path& path, bool finely) const {
#if defined(__x86_64__)
  if (wide_)
    aim_avx2::linearize(medium_, path, finely);
  else
#endif
    aim_baseline::linearize(medium_, path, finely);
  const Path::Elements& of = path.elements;
  Debt debt{};
  path.debt[path.count] = debt;
  for (int n = path.count - 1; n >= 0; --n) path.debt[n] = debt = before(of, n, debt);
  for (int i = 0; i < 3; ++i) path.by_velocity[i] = {debt.v[0].v[i], debt.v[1].v[i], debt.v[2].v[i]};
  path.layers = path.bends = false;
  path.steep = 0;
  settle(path);
}

void AimSolver::settle(Path& path) {
  const Path::Elements& of = path.elements;
  path.total = path.most_carried = path.leaps = 0;
  Four off{};
  for (int n = 0; n < path.count; ++n) {
    const Debt& after = path.debt[n + 1];
    const Four moved = Four{{of.x[0][n], of.x[1][n], of.x[2][n], 0}} + Four::splat(of.x[1][n]) * after.y +
                       Four::splat(of.v[0][n]) * after.v[0] + Four::splat(of.v[1][n]) * after.v[1] +
                       Four::splat(of.v[2][n]) * after.v[2];
    off = off + moved;
    path.leaps += math::abs(moved.v[0]) + math::abs(moved.v[1]) + math::abs(moved.v[2]);
    const double carried = of.defect[n] * path.reach(n);
    path.total += carried;
    path.most_carried = math::max(path.most_carried, carried);
  }
  const Vec3d moved{off.v[0], off.v[1], off.v[2]};
  path.arrival = {Path::at(path.x, path.count) + moved, Path::at(path.v, path.count)};
}

void AimSolver::move(Path& path, Vec3d du, double dt) {
  Vec3d dx{}, dv = du;
  const double later = dt / path.time();
  for (int n = 0; n <= path.count; ++n) {
    const double stretch = later * path.t[n];
    path.t[n] += stretch;
    for (int i = 0; i < 3; ++i) {
      path.x[i][n] += dx[i] + stretch * path.v[i][n];
      path.v[i][n] += dv[i] + stretch * path.k[i][n];
    }
    if (n == path.count) break;
    const Path::Elements& of = path.elements;
    const double ahead = of.e[0][n] * dv.x + of.e[1][n] * dv.y + of.e[2][n] * dv.z;
    const double half = 0.5 * of.h[n], height = dx.y + half * dv.y, sunk = half * (dx.y + (2.0 / 3) * half * dv.y);
    for (int i = 0; i < 3; ++i) {
      dx[i] += of.c[n] * dv[i] + of.d[n] * ahead * of.e[i][n] + sunk * of.q[i][n] + of.x[i][n];
      dv[i] = of.a[n] * dv[i] + of.b[n] * ahead * of.e[i][n] + height * of.q[i][n] + of.v[i][n];
    }
  }
}

int AimSolver::cut(const Path& path, double enough, double bend, Cut* cuts) const {
  int count = 0;
  const double slow = 0.85 * sound_, fast = 1.15 * sound_;
  for (int n = 0; n < path.count; ++n) {
    const double carries = path.elements.defect[n] * path.reach(n);
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
