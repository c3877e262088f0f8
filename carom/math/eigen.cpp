#include "carom/math/eigen.h"

namespace carom::math {
namespace {

struct Rotation {
  double c, s;
};
/// The rotation that makes the off-diagonal element apq of a symmetric 2×2 block vanish, by the smaller angle.
Rotation jacobi_rotation(double app, double apq, double aqq) {
  if (apq == 0) return {1, 0};
  const double tau = (aqq - app) / (2 * apq);
  // For huge tau its square would overflow, and t = 1/(2 tau) is exact enough.
  const double t = abs(tau) > 1e150 ? 0.5 / tau : (tau >= 0 ? 1 : -1) / (abs(tau) + sqrt(1 + tau * tau));
  const double c = 1 / sqrt(1 + t * t);
  return {c, t * c};
}

Vec3d largest_positive(Vec3d v) {
  const Vec3d a = abs(v);
  const double leading = a.x >= a.y && a.x >= a.z ? v.x : (a.y >= a.z ? v.y : v.z);
  return leading < 0 ? -v : v;
}

}  // namespace

Eigen3 symmetric_eigen(const Mat3d& m) {
  double a[3][3] = {{m(0, 0), m(0, 1), m(0, 2)}, {m(0, 1), m(1, 1), m(1, 2)}, {m(0, 2), m(1, 2), m(2, 2)}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  constexpr int pairs[3][2] = {{0, 1}, {0, 2}, {1, 2}};
  for (int sweep = 0; sweep < 30; ++sweep) {
    bool rotated = false;
    for (const auto& pair : pairs) {
      const int p = pair[0], q = pair[1], r = 3 - p - q;
      // An element that does not change either diagonal any more is rounding error.
      const double size = abs(a[p][q]);
      if (size == 0 || (abs(a[p][p]) + size * 0x1p-2 == abs(a[p][p]) && abs(a[q][q]) + size * 0x1p-2 == abs(a[q][q]))) {
        a[p][q] = a[q][p] = 0;
        continue;
      }
      rotated = true;
      const Rotation j = jacobi_rotation(a[p][p], a[p][q], a[q][q]);
      const double t = j.s / j.c, apq = a[p][q], arp = a[r][p], arq = a[r][q];
      a[p][p] -= t * apq;
      a[q][q] += t * apq;
      a[p][q] = a[q][p] = 0;
      a[r][p] = a[p][r] = j.c * arp - j.s * arq;
      a[r][q] = a[q][r] = j.s * arp + j.c * arq;
      for (auto& row : v) {
        const double vp = row[p], vq = row[q];
        row[p] = j.c * vp - j.s * vq;
        row[q] = j.s * vp + j.c * vq;
      }
    }
    if (!rotated) break;
  }
  int order[3] = {0, 1, 2};
  const auto arrange = [&](int i, int j) {
    if (a[order[j]][order[j]] < a[order[i]][order[i]]) {
      const int t = order[i];
      order[i] = order[j];
      order[j] = t;
    }
  };
  arrange(0, 1);
  arrange(1, 2);
  arrange(0, 1);
  const auto column = [&](int c) { return Vec3d{v[0][c], v[1][c], v[2][c]}; };
  const Vec3d x = largest_positive(normalize(column(order[0])));
  const Vec3d second = column(order[1]);
  const Vec3d y = largest_positive(normalize(second - x * dot(x, second)));
  return {{a[order[0]][order[0]], a[order[1]][order[1]], a[order[2]][order[2]]}, {x, y, cross(x, y)}};
}

Eigen2 symmetric_eigen(const Mat2d& m) {
  const double xx = m(0, 0), xy = m(0, 1), yy = m(1, 1);
  const Rotation j = jacobi_rotation(xx, xy, yy);
  const double t = j.s / j.c;
  const double first = xx - t * xy, second = yy + t * xy;
  Vec2d v = first <= second ? Vec2d{j.c, -j.s} : Vec2d{j.s, j.c};
  if ((abs(v.x) >= abs(v.y) ? v.x : v.y) < 0) v = -v;
  return {{min(first, second), max(first, second)}, {v, perpendicular(v)}};
}

}  // namespace carom::math
