// Fragments of a case that bursts: their speed, their masses, and a spray of them (chapter 18.6).
#pragma once

#include <cstdint>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::blast {

enum class CaseShape { cylinder, sphere };
/// √(2E), m/s, of cast TNT and of Composition B: numbers of common use.
inline constexpr double gurney_tnt = 2440, gurney_composition_b = 2700;

/// First speed (m/s) of the fragments: √(2E)/√(M/C + ½) for a cylinder, /√(M/C + ⅗) for a sphere; M/C is the mass of
/// the case by that of the charge. R. W. Gurney, BRL report 405 (1943).
CAROM_API double gurney_speed(CaseShape shape, double case_to_charge, double gurney_constant = gurney_tnt);

/// Number of fragments heavier than m: N(m) = (M/2μ) e^{−√(m/μ)} with Mott's μ (kg), half the mean mass.
/// N. F. Mott, Proc. R. Soc. A 189 (1947) 300.
CAROM_API double mott_count(double case_mass, double mu, double heavier_than);

struct Fragment {
  double mass = 0;         ///< kg
  math::Vec3d velocity{};  ///< m/s, from the case's own
};
/// A seeded spray of a case at rest: masses by Mott's law, scaled to the case's mass exactly, directions uniform over
/// the sphere, in pairs of equal mass thrown to opposite sides, so that the momentum is zero to rounding. `count` is
/// rounded up to an even number. Errors name a field that cannot be.
CAROM_API core::Result<std::vector<Fragment>> fragment_spray(double case_mass, double speed, int count,
                                                             std::uint64_t seed);

}  // namespace carom::blast
