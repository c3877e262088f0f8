// Water with waves: one surface for drawing, for what floats and for what swims. Airy's linear waves of any depth,
// their motion carried up to the real surface by Wheeler's stretching. The y axis is up.
#pragma once

#include <span>
#include <vector>

#include "carom/environment/water.h"
#include "carom/environment/wave_spectrum.h"

namespace carom::environment {

/// How linear theory, which knows the water below the still level, is carried on to the real surface.
enum class Stretching : std::int32_t {
  /// J. D. Wheeler, J. Petroleum Technology 22 (1970) 359: the column from bed to surface is that from bed to still
  /// level, stretched. Velocity and pressure are right at the surface; at a fixed depth it adds a weak mean flow
  /// against
  /// the waves, −½ a² ω k e^(ky).
  wheeler,
  /// Above the still level as at it. No mean flow, so that what swims deep drifts as Stokes says.
  vertical,
};

/// The water of a place.
struct WaterBody {
  double level = 0;           ///< m, of the still surface
  double depth = deep_water;  ///< m
  double density = 1025;      ///< kg/m³
  double gravity = 9.80665;   ///< m/s²
  math::Vec3d current{};      ///< m/s, horizontal; the waves go with it
  Stretching stretching = Stretching::wheeler;
};

struct SeaPoint : WaterPoint {
  double pressure = 0;  ///< Pa over that of the air: 0 at the surface and above it
};

/// What something covers of the water: the second moments (m²) of its plan about its middle, as shares of its area. A
/// disc has r²/4 along x and z, a rectangle l²/12 along each of its sides.
struct Footprint {
  double xx = 0, xz = 0, zz = 0;
};
constexpr Footprint disc_footprint(double radius) { return {0.25 * radius * radius, 0, 0.25 * radius * radius}; }

/// A sum of waves on a body of water. All answers are first order in the steepness. Each costs a sine or two for
/// every component.
class CAROM_API Sea {
 public:
  Sea() = default;  ///< still, deep salt water at level 0
  /// Errors: water or components that are not finite or out of range, by name; more than 256 components.
  static core::Result<Sea> make(const WaterBody& water, std::span<const WaveComponent> components = {});
  /// With components drawn from a spectrum for the water's depth and gravity.
  static core::Result<Sea> make(const WaterBody& water, SeaDef definition);

  const WaterBody& water() const { return water_; }
  std::span<const WaveComponent> components() const { return components_; }
  /// 4 √(Σ a²/2), m.
  double significant_height() const;
  /// √(Σ a² k²/Σ a²), rad/m: the waves that matter. 0 where still.
  double mean_wave_number() const { return mean_wave_number_; }

  /// y of the surface.
  double height(double x, double z, double time) const;
  /// Height, normal and the motion and pressure of the water at the point; above the surface, of the surface under it.
  /// `footprint` is of what feels it: waves short against it count less, nearly as their mean over it, e^(−½ k·M k).
  SeaPoint sample(math::Vec3d point, double time, const Footprint& footprint = {}) const;
  /// Heights at (x, z) of each point, by the same sum as `height`.
  void heights(std::span<const math::Vec2d> points, double time, std::span<double> out) const;
  /// Heights of a grid of columns × rows points, `spacing` m apart from (x, z), row by row along x. The waves are
  /// turned from point to point instead of taken anew: within 1e-12 H_s of `height`, ten times as fast.
  void grid(double x, double z, double spacing, int columns, int rows, double time, std::span<double> out) const;
  /// Mean drift (m/s) of the water's particles at `depth_below` m under the still surface, second order:
  /// a² ω k cosh 2k(h − d)/(2 sinh² k h). Not part of `sample`: what floats in the waves drifts by itself. Stokes 1847.
  math::Vec3d stokes_drift(double depth_below) const;

 private:
  double phase(const WaveComponent& wave, double x, double z, double time) const {
    return wave.wave_number *
               (wave.direction_x * (x - water_.current.x * time) + wave.direction_z * (z - water_.current.z * time)) -
           wave.frequency * time + wave.phase;
  }
  WaterBody water_{};
  std::vector<WaveComponent> components_;
  double mean_wave_number_ = 0;
};

}  // namespace carom::environment
