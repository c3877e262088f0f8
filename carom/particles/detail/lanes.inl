// Vectors of lanes, and the elementary functions that the particle kernels need: a few ulp of float are enough here.

namespace carom::particles::detail::CAROM_PARTICLE_NAMESPACE {

constexpr int width = CAROM_PARTICLE_WIDTH;
using F = math::WideFloat<width>;
using I = math::WideInt<width>;
using M = math::WideMask<width>;

struct V {
  F x, y, z;
};
CAROM_SIMD_INLINE F splat(float x) { return F::splat(x); }
CAROM_SIMD_INLINE V splat(const float* v) { return {F::splat(v[0]), F::splat(v[1]), F::splat(v[2])}; }
CAROM_SIMD_INLINE V load(float* const (&p)[3], int i) {
  return {F::load(p[0] + i), F::load(p[1] + i), F::load(p[2] + i)};
}
CAROM_SIMD_INLINE V load(const float (&p)[3][block_size], int i) {
  return {F::load(p[0] + i), F::load(p[1] + i), F::load(p[2] + i)};
}
CAROM_SIMD_INLINE void store(const V& v, float* const (&p)[3], int i) {
  v.x.store(p[0] + i);
  v.y.store(p[1] + i);
  v.z.store(p[2] + i);
}
CAROM_SIMD_INLINE void store(const V& v, float (&p)[3][block_size], int i) {
  v.x.store(p[0] + i);
  v.y.store(p[1] + i);
  v.z.store(p[2] + i);
}
CAROM_SIMD_INLINE V operator+(const V& a, const V& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
CAROM_SIMD_INLINE V operator-(const V& a, const V& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
CAROM_SIMD_INLINE V operator*(F s, const V& a) { return {s * a.x, s * a.y, s * a.z}; }
CAROM_SIMD_INLINE F dot(const V& a, const V& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
CAROM_SIMD_INLINE V cross(const V& a, const V& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
CAROM_SIMD_INLINE V select(M m, const V& a, const V& b) {
  return {math::select(m, a.x, b.x), math::select(m, a.y, b.y), math::select(m, a.z, b.z)};
}
using math::select;
/// Rows of m times v, and columns of m times v.
CAROM_SIMD_INLINE V turn(const float* m, const V& v) {
  return {splat(m[0]) * v.x + splat(m[1]) * v.y + splat(m[2]) * v.z,
          splat(m[3]) * v.x + splat(m[4]) * v.y + splat(m[5]) * v.z,
          splat(m[6]) * v.x + splat(m[7]) * v.y + splat(m[8]) * v.z};
}
CAROM_SIMD_INLINE V turn_back(const float* m, const V& v) {
  return {splat(m[0]) * v.x + splat(m[3]) * v.y + splat(m[6]) * v.z,
          splat(m[1]) * v.x + splat(m[4]) * v.y + splat(m[7]) * v.z,
          splat(m[2]) * v.x + splat(m[5]) * v.y + splat(m[8]) * v.z};
}

/// To the nearest whole number; |x| < 2²².
CAROM_SIMD_INLINE F nearest(F x) {
  const F big = splat(12582912.0f);
  return (x + big) - big;
}
/// 2ˣ for x in [−126, 126]; 3e-7 relative.
CAROM_SIMD_INLINE F exp2_lanes(F x) {
  x = math::min(splat(126), math::max(splat(-126), x));
  const F whole = nearest(x), f = x - whole;
  F p = splat(1.52527338e-5f);
  p = splat(1.54035304e-4f) + f * p;
  p = splat(1.33335581e-3f) + f * p;
  p = splat(9.61812911e-3f) + f * p;
  p = splat(5.55041087e-2f) + f * p;
  p = splat(2.40226507e-1f) + f * p;
  p = splat(6.93147181e-1f) + f * p;
  p = splat(1) + f * p;
  return p * math::float_of_bits((math::to_int(whole) + I::splat(127)) << 23);
}
/// For normal positive x; 3e-7 absolute.
CAROM_SIMD_INLINE F log2_lanes(F x) {
  const I b = math::bits(x), e = (b - I::splat(0x3f3504f3)) >> 23;
  const F m = math::float_of_bits(b - (e << 23));
  const F t = (m - splat(1)) / (m + splat(1)), t2 = t * t;
  const F series =
      splat(1) + t2 * (splat(1.0f / 3) + t2 * (splat(0.2f) + t2 * (splat(1.0f / 7) + t2 * splat(1.0f / 9))));
  return math::to_float(e) + splat(2.88539008f) * t * series;
}
/// cos 2πx for |x| < 2²²; 2e-7 absolute.
CAROM_SIMD_INLINE F cos_turns(F x) {
  const F y = splat(6.28318531f) * (splat(0.25f) - math::abs(x - nearest(x))), y2 = y * y;
  F p = splat(-2.50521084e-8f);
  p = splat(2.75573192e-6f) + y2 * p;
  p = splat(-1.98412698e-4f) + y2 * p;
  p = splat(8.33333333e-3f) + y2 * p;
  p = splat(-1.66666667e-1f) + y2 * p;
  return y + y * y2 * p;
}

/// e^{−x}, φ₁ = (1 − e^{−x})/x, φ₂ = (1 − φ₁)/x for x ≥ 0: what is left of a velocity, its mean over the step, and
/// the way under a constant acceleration.
struct Decay {
  F decay, mean, half;
};
CAROM_SIMD_INLINE Decay decay_of(F x) {
  F s = splat(2.50521084e-8f);
  s = splat(2.75573192e-7f) - x * s;
  s = splat(2.75573192e-6f) - x * s;
  s = splat(2.48015873e-5f) - x * s;
  s = splat(1.98412698e-4f) - x * s;
  s = splat(1.38888889e-3f) - x * s;
  s = splat(8.33333333e-3f) - x * s;
  s = splat(4.16666667e-2f) - x * s;
  s = splat(1.66666667e-1f) - x * s;
  s = splat(0.5f) - x * s;
  const F near_mean = splat(1) - x * s, near_decay = splat(1) - x * near_mean;
  const M small = x < splat(1);
  if (math::all(small)) return {near_decay, near_mean, s};
  const F e = exp2_lanes(splat(-1.44269504f) * math::min(x, splat(80)));
  const F safe = math::max(x, splat(1)), far_mean = (splat(1) - e) / safe;
  return {select(small, near_decay, e), select(small, near_mean, far_mean),
          select(small, s, (splat(1) - far_mean) / safe)};
}

/// Value between the nodes of a table of values and differences.
CAROM_SIMD_INLINE F look_up(const float* table, F place) {
  const I node = math::to_int(place);
  F value = F::zero(), step = F::zero();
  for (int i = 0; i < width; ++i) {
    value.set(i, table[2 * node[i]]);
    step.set(i, table[2 * node[i] + 1]);
  }
  return value + (place - math::to_float(node)) * step;
}

}  // namespace carom::particles::detail::CAROM_PARTICLE_NAMESPACE
