#include "carom/forces/added_mass.h"

#include "carom/math/elementary.h"

namespace carom::forces {
using math::Vec3d;
namespace {

/// Carlson's integral of the second kind R_D(x, y, z), by duplication. B. C. Carlson, Numerische Mathematik 33 (1979).
double carlson_rd(double x, double y, double z) {
  double sum = 0, factor = 1;
  for (int i = 0; i < 60; ++i) {
    const double rx = math::sqrt(x), ry = math::sqrt(y), rz = math::sqrt(z);
    const double lambda = rx * ry + rx * rz + ry * rz;
    sum += factor / (rz * (z + lambda));
    factor *= 0.25;
    x = 0.25 * (x + lambda), y = 0.25 * (y + lambda), z = 0.25 * (z + lambda);
    const double mean = 0.2 * (x + y + 3 * z);
    const double dx = (mean - x) / mean, dy = (mean - y) / mean, dz = (mean - z) / mean;
    if (math::max(math::abs(dx), math::max(math::abs(dy), math::abs(dz))) > 1e-3) continue;
    const double ea = dx * dy, eb = dz * dz, ec = ea - eb, ed = ea - 6 * eb, ee = ed + 2 * ec;
    const double series = 1 + ed * (-3.0 / 14 + 9.0 / 88 * ed - 4.5 / 26 * dz * ee) +
                          dz * (ee / 6 + dz * (-9.0 / 22 * ec + dz * 3.0 / 26 * ea));
    return 3 * sum + factor * series / (mean * math::sqrt(mean));
  }
  return 3 * sum;
}

}  // namespace

AddedShares ellipsoid_added_mass(Vec3d h) {
  // α₀ = abc ∫₀^∞ dλ/((a² + λ) Δ) = ⅔ abc R_D(b², c², a²), and so on round.
  const double volume = h.x * h.y * h.z;
  const Vec3d s{h.x * h.x, h.y * h.y, h.z * h.z};
  const Vec3d alpha =
      2.0 / 3 * volume * Vec3d{carlson_rd(s.y, s.z, s.x), carlson_rd(s.z, s.x, s.y), carlson_rd(s.x, s.y, s.z)};
  AddedShares out;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    out.linear[i] = alpha[i] / (2 - alpha[i]);
    const double difference = s[j] - s[k], sum = s[j] + s[k];
    if (math::abs(difference) < 1e-7 * sum) continue;  // round about this axis: it turns without moving the fluid
    const double gap = alpha[k] - alpha[j];
    out.angular[i] = difference * difference * gap / (sum * (2 * difference - sum * gap));
  }
  return out;
}

}  // namespace carom::forces
