// Turbulence as a frozen field of eddies that the mean wind carries past: a sum of waves of velocity, the same at a
// place and time whoever asks and in whatever order.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::environment {

enum class TurbulenceSpectrum {
  dryden,      ///< correlation e^(−r/L): falls with k⁻² at high wave numbers
  von_karman,  ///< falls with k^(−5/3), as real air does
};

/// Strength and size of the eddies along the mean wind (u), across it (v, horizontal) and upward (w).
struct TurbulenceScales {
  math::Vec3d intensity{1, 1, 1};     ///< m/s, σ_u, σ_v, σ_w
  math::Vec3d length{150, 150, 150};  ///< m, L_u, L_v, L_w, > 0
};
/// Below 2000 ft, by height over the ground (m, held to 10 … 1000 ft) and the wind at 20 ft (m/s): σ_w = .1 W₂₀,
/// σ_u = σ_v = σ_w/(.177 + .000823 h)^.4, L_w = h, L_u = L_v = h/(.177 + .000823 h)^1.2, h in ft.
/// MIL-F-8785C 3.7.3.4. W₂₀ is 15 kn in light, 30 in moderate, 45 in severe turbulence.
CAROM_API TurbulenceScales low_altitude_turbulence(double height, double wind_at_20_feet);
/// Above 2000 ft: isotropic, L = 1750 ft (Dryden) or 2500 ft (von Kármán); σ as given, m/s. MIL-F-8785C 3.7.2.
CAROM_API TurbulenceScales high_altitude_turbulence(double intensity, TurbulenceSpectrum spectrum);

/// Intensity (m/s) that is exceeded with the probability `exceedance` (.2 … 1e-6, in turbulence or not) at an altitude
/// (m): MIL-F-8785C, figure 7. Light turbulence is 1e-1 … 1e-2, moderate 1e-3, severe 1e-5. Linear over altitude and
/// over the logarithm of the probability; held at the ends (500 and 80 000 ft).
CAROM_API double turbulence_intensity(double altitude, double exceedance);
/// At any height: the low-altitude scales to 1000 ft, those of high altitude from 2000 ft, linear between (3.7.3.4).
/// MIL-HDBK-1797 writes half the lengths L_v and L_w; its spectra over k are the same.
CAROM_API TurbulenceScales standard_turbulence(double height, double wind_at_20_feet, double exceedance,
                                               TurbulenceSpectrum spectrum);

/// One-sided spectra over the wave number k (rad/m) along the line of flight, ∫₀^∞ Φ dk = σ², (m/s)²·m/rad.
/// Dryden: Φ_u = σ² (2L/π)/(1 + (Lk)²), Φ_w = σ² (L/π)(1 + 3(Lk)²)/(1 + (Lk)²)².
/// von Kármán: Φ_u = σ² (2L/π)/(1 + (1.339 Lk)²)^(5/6), Φ_w = σ² (L/π)(1 + 8/3 (1.339 Lk)²)/(1 + (1.339 Lk)²)^(11/6).
/// Over the frequency ω of a flight at V: Φ(ω) = Φ(k = ω/V)/V. MIL-F-8785C 3.7.1.
CAROM_API double longitudinal_spectrum(TurbulenceSpectrum spectrum, double intensity, double length,
                                       double wave_number);
CAROM_API double transverse_spectrum(TurbulenceSpectrum spectrum, double intensity, double length, double wave_number);

struct TurbulenceDef {
  TurbulenceSpectrum spectrum = TurbulenceSpectrum::von_karman;
  TurbulenceScales scales{};
  /// m/s: the eddies drift with it, and u is along it. Still air: along x.
  math::Vec3d mean_wind{};
  /// m, the smallest eddies: a hundredth of the length where 0. What is smaller is not there.
  double smallest = 0;
  int shells = 16;  ///< 4 … 64 bands of wave number, six directions each
  std::uint64_t seed = 1;
};

/// Nodes of a lattice of cubes.
struct WindGrid {
  math::Vec3d corner{};                   ///< m, the lowest
  double spacing = 1;                     ///< m
  int columns = 2, layers = 2, rows = 2;  ///< along x, y, z
  int size() const { return columns * layers * rows; }
};

/// Random Fourier modes (Kraichnan, Phys. Fluids 13 (1970) 22): shells of wave number with the energy of the isotropic
/// spectrum E(k), six directions each (the axes of an icosahedron, turned at random) and both polarisations, so that
/// every component has exactly its variance over space. Where the three lengths and intensities are equal the field has
/// no divergence; where they are not, each component has the scales that are asked for along the mean wind.
class CAROM_API Turbulence {
 public:
  Turbulence() = default;  ///< calm
  /// Errors: what is not finite or out of range, by name.
  static core::Result<Turbulence> make(const TurbulenceDef& definition);

  /// The part of the wind (m/s) at a place and time.
  math::Vec3d at(math::Vec3d point, double time) const;
  /// Adds the same, to 1e-5 of the intensity, at the nodes of a grid: x fastest, then y, then z. The modes are turned
  /// from node to node instead of taken anew, which is ten times as fast.
  void add_at(const WindGrid& grid, double time, std::span<math::Vec3f> out) const;
  const TurbulenceDef& definition() const { return definition_; }
  bool calm() const { return modes_.empty(); }

  /// u = Σ a cos(k·x) + b sin(k·x) of the field of unit intensity and length, axes u, w (up), v.
  struct Mode {
    math::Vec3d wave_number{}, cosine{}, sine{};
  };
  std::span<const Mode> modes() const { return modes_; }

 private:
  TurbulenceDef definition_{};
  math::Vec3d along_{1, 0, 0}, across_{0, 0, 1};
  std::vector<Mode> modes_;
  std::vector<Mode> waves_;  ///< the same in the world's axes and units: modes for each length that differs
};

}  // namespace carom::environment
