// Heights of a sum of waves, compiled once for each instruction set: CAROM_SEA_NAMESPACE, CAROM_SEA_WIDTH.

namespace carom::environment::detail::CAROM_SEA_NAMESPACE {

using F = math::WideFloat<CAROM_SEA_WIDTH>;

/// sin 2πt for t in turns, |t| < 2²²: the nearest whole turn off by adding and taking away 1.5·2²³, folded into a
/// quarter turn, then an odd polynomial (fit of our own by least squares at Chebyshev points, error 5e-8).
CAROM_SIMD_INLINE F sine_of_turns(F t) {
  const F big = F::splat(12582912.0f);
  const F r = t - ((t + big) - big);
  const F half = F::splat(0.5f), quarter = F::splat(0.25f);
  const F folded = select(r > quarter, half - r, select(r < -quarter, -half - r, r));
  const F q = folded * folded;
  F p = F::splat(39.5358162f);
  p = p * q + F::splat(-76.5496597f);
  p = p * q + F::splat(81.6009979f);
  p = p * q + F::splat(-41.3416557f);
  p = p * q + F::splat(6.28318501f);
  return p * folded;
}

void heights(const SeaWaves& sea, std::size_t from, std::size_t to) {
  const bool slopes = sea.slope_x != nullptr;
  for (std::size_t i = from; i < to; i += CAROM_SEA_WIDTH) {
    const F x = F::load(sea.x + i), z = F::load(sea.z + i);
    F height = F::zero(), along = F::zero(), across = F::zero();
    for (int w = 0; w < sea.count; ++w) {
      const F kx = F::splat(sea.turns_x[w]), kz = F::splat(sea.turns_z[w]), a = F::splat(sea.amplitude[w]);
      const F t = kx * x + kz * z + F::splat(sea.phase[w]);
      height += a * sine_of_turns(t);
      if (!slopes) continue;
      const F c = a * sine_of_turns(t + F::splat(0.25f));
      along += kx * c;
      across += kz * c;
    }
    height.store(sea.height + i);
    if (!slopes) continue;
    const F turn = F::splat(6.28318530718f);
    (turn * along).store(sea.slope_x + i);
    (turn * across).store(sea.slope_z + i);
  }
}

}  // namespace carom::environment::detail::CAROM_SEA_NAMESPACE
