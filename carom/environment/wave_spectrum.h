// Seas as spectra: how the energy of waves is spread over frequency and direction.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::environment {

/// One long-crested wave of a sum: η = a sin(k (d_x x + d_z z) − ω t + φ), ω relative to the water.
struct WaveComponent {
  double amplitude = 0;                     ///< m
  double wave_number = 0;                   ///< rad/m, > 0
  double frequency = 0;                     ///< rad/s
  double direction_x = 1, direction_z = 0;  ///< unit vector, where the wave goes to
  double phase = 0;                         ///< rad
};

inline constexpr double deep_water = 1e9;  ///< m, a depth that no wave feels

/// k of ω² = g k tanh(k h), rad/m, to the last digits by Newton's method; 0 where ω is not positive.
CAROM_API double wave_number(double frequency, double depth = deep_water, double gravity = 9.80665);
/// ω of the same, rad/s.
CAROM_API double wave_frequency_at_depth(double wave_number, double depth, double gravity = 9.80665);

/// The family of Pierson–Moskowitz and JONSWAP spectra by height and peak period:
/// S(ω) ∝ ω⁻⁵ exp(−5/4 (ω_p/ω)⁴) γ^b, b = exp(−(ω − ω_p)²/(2 σ² ω_p²)), σ = .07 below and .09 above the peak, scaled
/// to m₀ = H_s²/16. γ = 1 is Pierson and Moskowitz 1964 (in two parameters, Bretschneider), 3.3 the mean of JONSWAP
/// (Hasselmann et al. 1973), up to 7 young seas.
struct WaveSpectrum {
  double significant_height = 1;  ///< m, H_s = 4 √m₀
  double peak_period = 6;         ///< s
  double peak_enhancement = 1;    ///< γ, 1 … 10
};
/// A fully grown sea by the wind at 19.5 m: α = .0081, β = .74. Pierson & Moskowitz, J. Geophys. Res. 69 (1964) 5181.
CAROM_API WaveSpectrum fully_grown_sea(double wind_speed_19_5, double gravity = 9.80665);
/// A sea that the wind at 10 m has blown up over `fetch` m: α = .076 (U²/(F g))^.22, ω_p = 22 (g²/(U F))^⅓.
/// Hasselmann et al., Deutsche Hydrographische Zeitschrift A8 No. 12 (1973).
CAROM_API WaveSpectrum fetch_limited_sea(double wind_speed_10, double fetch, double peak_enhancement = 3.3,
                                         double gravity = 9.80665);
/// Sea state 0 … 9 (WMO code table 3700): the middle of its range of H_s, with the peak period that a fully grown sea
/// of this height has. Outside 0 … 9 the nearest.
CAROM_API WaveSpectrum sea_state(int code);

/// S(ω), m²·s/rad; 0 for ω ≤ 0.
CAROM_API double spectral_density(const WaveSpectrum& spectrum, double frequency);
/// m_n = ∫ ωⁿ S dω, n = −1 … 2, to 1e-6 for γ 1 … 10.
CAROM_API double spectral_moment(const WaveSpectrum& spectrum, int n);
/// cos²ˢ spread over the angle θ (rad) from the mean direction: D = Γ(s+1)/(2√π Γ(s+½)) cos²ˢ(θ/2), ∫ D dθ = 1.
/// Longuet-Higgins, Cartwright & Smith 1963. s ≥ 0.
CAROM_API double spread_density(double s, double angle);

/// What components are drawn from a spectrum.
struct SeaDef {
  WaveSpectrum spectrum{};
  double direction = 0;       ///< rad, where the waves go to: from x toward z
  double spread = 10;         ///< s of cos²ˢ(θ/2); wind seas 5 … 30, swell more. 0 or less: long crests
  int components = 48;        ///< 1 … 256
  double depth = deep_water;  ///< m
  double gravity = 9.80665;   ///< m/s²
  std::uint64_t seed = 1;
};
/// One direction for each frequency (Jefferys 1987), so that the sea looks alike everywhere. The frequencies share the
/// range .6 … 4 ω_p, closer where the energy is, and each component carries the energy of its band: Σ a²/2 = H_s²/16
/// exactly. Errors: what is not finite or out of range, by name.
CAROM_API core::Result<std::vector<WaveComponent>> wave_components(const SeaDef& sea);
/// One regular wave of `height` m from trough to crest, toward `direction` (rad, from x toward z).
CAROM_API WaveComponent regular_wave(double height, double period, double direction = 0, double depth = deep_water,
                                     double gravity = 9.80665, double phase = 0);

}  // namespace carom::environment
