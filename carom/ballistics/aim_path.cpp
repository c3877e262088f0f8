// Recorded paths of the aim solver: what the arrival owes to the start and to every element, and how a path is moved to
// where it should be.
#include "carom/ballistics/detail/aim_solver.h"

namespace carom::ballistics::detail {

void AimSolver::linearize(Path& path, bool finely) const {
  (path.count > 4 ? lanes_ : few_lanes_).linearize(medium_, path, finely);
  path.lands = path.bends = false;
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
    // What it feels there then.
    const Vec3d w = Path::at(path.w, n), turned{double(dv[0]), double(dv[1]), double(dv[2])};
    const Vec3d more = turned + stretch * Path::at(path.k, n);
    const double bend = (path.along[n] - path.drag[n]) * math::dot(w, more) / math::max(math::length_squared(w), 1e-18);
    const double up = double(dx[1]) + stretch * path.v[1][n];
    for (int i = 0; i < 3; ++i) path.k[i][n] += up * path.rise[i][n] - path.drag[n] * more[i] - bend * w[i];
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

namespace {

/// Bulges of a part of an element: the powers of t from the sixth on.
void bend_part(FlightPath& path, int to, const FlightElement& whole, int part, int parts) {
  const double r = 1.0 / parts, c = (2 * part + 1) * r - 1, r3 = r * r * r, r6 = r3 * r3;
  auto& bulge = path.elements.bulge;
  for (int i = 0; i < 3; ++i) {
    const double p6 = whole.even[i][3], p7 = whole.odd[i][3], p8 = whole.even[i][4];
    bulge[2][i][to] = -r6 * r * r * p8;
    bulge[1][i][to] = -r6 * r * (p7 + 8 * c * p8);
    bulge[0][i][to] = 3 * bulge[2][i][to] - r6 * (p6 + c * (7 * p7 + 28 * c * p8));
  }
}

}  // namespace

void AimSolver::divide(Path& path, double enough) const {
  int parts[Path::most], count = 0;
  for (int n = 0; n < path.count; ++n) {  // what is mistaken falls as the fourth power of the length, about
    const double share = path.mistaken(n) / enough;
    for (parts[n] = 1; parts[n] < 8 && math::square(math::square(double(parts[n]))) < share;) ++parts[n];
    count += parts[n];
  }
  if (count > Path::most) {
    if (enough < 1e6) divide(path, 4 * enough);
    return;
  }
  int to = count, n = path.count;
  const auto bring = [&](int from) {
    path.put(to, path.t[from], Path::at(path.x, from), Path::at(path.v, from), Path::at(path.k, from));
  };
  bring(n);
  path.count = count;
  while (--n >= 0) {
    if (parts[n] == 1) {
      --to;
      for (auto& power : path.elements.bulge)
        for (auto& one : power) one[to] = one[n];
      bring(n);
      continue;
    }
    const FlightElement flown(path, n);
    const double t = path.t[n];
    for (int j = parts[n] - 1; j >= 0; --j) {
      const double s = double(j) / parts[n];
      bend_part(path, --to, flown, j, parts[n]);
      if (j == 0)
        bring(n);
      else
        path.put(to, t + 2 * s * flown.half, {flown.place(0, s), flown.place(1, s), flown.place(2, s)},
                 {flown.velocity(0, s), flown.velocity(1, s), flown.velocity(2, s)}, {});
    }
  }
}

}  // namespace carom::ballistics::detail
