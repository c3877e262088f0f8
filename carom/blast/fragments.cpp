#include "carom/blast/fragments.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace carom::blast {

double gurney_speed(CaseShape shape, double case_to_charge, double gurney_constant) {
  return gurney_constant / math::sqrt(case_to_charge + (shape == CaseShape::cylinder ? 0.5 : 0.6));
}

double mott_count(double case_mass, double mu, double heavier_than) {
  return case_mass / (2 * mu) * math::exp(-math::sqrt(heavier_than / mu));
}

core::Result<std::vector<Fragment>> fragment_spray(double case_mass, double speed, int count, std::uint64_t seed) {
  if (!(case_mass > 0) || !math::is_finite(case_mass))
    return core::Error{core::refused("case_mass", case_mass, "a finite number of kg > 0")};
  if (!(speed >= 0) || !math::is_finite(speed))
    return core::Error{core::refused("speed", speed, "a finite number of m/s >= 0")};
  if (count < 1 || count > 10000000) return core::Error{core::refused("count", count, "1 to 10000000 fragments")};
  const std::size_t pairs = std::size_t(count + 1) / 2;
  math::Random random(seed);
  std::vector<Fragment> fragments(2 * pairs);
  double sum = 0;
  for (std::size_t i = 0; i < pairs; ++i) {
    // N(m) ∝ e^{−√(m/μ)}: √(m/μ) is exponential.
    const double mass = math::square(random.exponential());
    const math::Vec3d velocity = speed * random.on_sphere();
    fragments[2 * i] = {mass, velocity};
    fragments[2 * i + 1] = {mass, -velocity};
    sum += 2 * mass;
  }
  for (Fragment& fragment : fragments) fragment.mass *= case_mass / sum;
  return fragments;
}

}  // namespace carom::blast
