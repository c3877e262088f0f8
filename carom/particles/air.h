// The medium that particles move through, and what else pulls at them.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "carom/core/result.h"
#include "carom/environment/wind_field.h"
#include "carom/export.h"
#include "carom/forces/fields.h"

namespace carom::particles {

enum class DragLaw {
  none,
  linear,            ///< F = −c w; `coefficient` is c in N·s/m of a particle of scale 1, at any scale
  stokes,            ///< F = −6π μ r w: Re < 1
  schiller_naumann,  ///< Stokes · (1 + .15 Re^.687) to Re ≈ 1000, C_d = .44 beyond. Schiller & Naumann 1933
  quadratic,         ///< F = −½ ρ C_d π r² |w| w; `coefficient` is C_d
};
struct Drag {
  DragLaw law = DragLaw::quadratic;
  float coefficient = 0.47f;
  float density = 1.225f;      ///< kg/m³, of the medium
  float viscosity = 1.81e-5f;  ///< Pa·s
};

/// A field of eddies without divergence: a sum of plane waves with random directions, of lengths from `length` down to
/// an eighth of it with Kolmogorov's energies, each turning over in its own time and carried along by the wind.
/// R. H. Kraichnan, Phys. Fluids 13 (1970) 22.
struct Turbulence {
  float speed = 0;   ///< m/s, root of the mean square of the velocity; 0: none
  float length = 5;  ///< m, of the largest eddies
  int waves = 12;    ///< 1 … 64
  std::uint64_t seed = 1;
};
struct Whirl {
  math::Vec3d center{};
  math::Vec3d axis{0, 1, 0};  ///< unit
  forces::Vortex vortex{};
};
/// Velocity of the medium is wind (or layers, or field) + turbulence + whirls.
struct Air {
  environment::Wind wind{};
  /// Where there are any they stand for `wind`; by rising height, constant beyond.
  std::vector<environment::WindColumn::Level> layers{};
  /// The wind of an environment: where there is one it stands for `wind` and `layers`. Its steady part is felt as it
  /// is, what else blows as environment::WindPatch has it, of up to 8192 nodes round all but stray particles.
  std::optional<environment::WindField> field{};
  double ground = 0;  ///< m: heights of the wind's profile and of the layers are above this
  Turbulence turbulence{};
  std::vector<Whirl> whirls{};
};

/// Pulls (or pushes) all particles alike: an acceleration.
struct Attractor {
  math::Vec3d center{};
  forces::Radial radial{};
};

CAROM_API core::Status check(const Drag& drag);
CAROM_API core::Status check(const Air& air);
CAROM_API core::Status check(const Attractor& attractor);

}  // namespace carom::particles
