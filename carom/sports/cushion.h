// A ball strikes a cushion: three published models (chapter 19.8).
//
// The nose of a cushion is an edge at the height h above the bed, so that the contact lies above the ball's equator:
// sin θ = h/R − 1. All three take the direction from the ball's centre to the contact and give the new velocities.
//   stronge   W. J. Stronge, "Impact Mechanics" (2000), ch. 5: a compliant contact that stores energy along both
//             directions, so that a ball may leave with its slip reversed. Solved in closed form phase by phase.
//   mathavan  S. Mathavan, M. R. Jackson, R. M. Parkin, "A theoretical analysis of billiard ball dynamics under cushion
//             impacts", Proc. IMechE C 224 (2010): integrated over the impulse, with the bed's friction meanwhile.
//   han       I. Han, "Dynamics in carom and three cushion billiards", J. Mech. Sci. Technol. 19 (2005): rigid, Coulomb
//             friction that ends at the latest where slip ends; the fastest.
#pragma once

#include <cstdint>

#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::sports {

struct BilliardPhysics;
struct BilliardState;

enum class CushionModel : std::uint8_t { stronge, mathavan, han };

struct CushionContact {
  CushionModel model = CushionModel::stronge;
  double restitution = 0.85;
  double friction = 0.2;
  double frequency_ratio = 1.8;  ///< Stronge: tangential over normal natural frequency of the contact, ≥ 1
  int steps = 400;               ///< Mathavan: steps of the impulse to the end of compression, about
};

/// The ball meets a cushion whose contact lies in the direction `toward` (unit vector from the ball's centre). On the
/// bed the vertical part of the impulse is taken up by the bed. Nothing happens where it does not approach.
/// Returns the approach speed along `toward` (m/s).
CAROM_API double strike_cushion(BilliardState& state, math::Vec3d toward, bool on_bed, const BilliardPhysics& physics);

struct CompliantImpact {
  double tangential = 0;  ///< m/s after the impact
  double normal = 0;      ///< m/s after the impact
};
/// Stronge's planar compliant impact. Contact velocities before: tangential of any sign, normal ≤ 0 (approaching).
/// β are the inverse effective masses times m: 3.5 and 1 for a solid sphere.
CAROM_API CompliantImpact stronge_impact(double tangential, double normal, double restitution, double friction,
                                         double frequency_ratio, double beta_tangential, double beta_normal);

}  // namespace carom::sports
