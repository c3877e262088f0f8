// The kernels of corner_lanes.h for one instruction set: CAROM_CORNERS_NAMESPACE. Hulls keep their vectors by fours
// (x x x x y y y y z z z z); wider instruction sets gain by what they can take from memory, not by more lanes.

namespace carom::geometry::detail::CAROM_CORNERS_NAMESPACE {

using Four = math::WideFloat<4>;

CAROM_SIMD_INLINE static Four along(const float* p, Four x, Four y, Four z) {
  return Four::load(p) * x + Four::load(p + 4) * y + Four::load(p + 8) * z;
}

static int farthest(const float* lanes, int blocks, float dx, float dy, float dz) {
  // How far first, and then which, by the same sums: to carry along which would take longer.
  const Four x = Four::splat(dx), y = Four::splat(dy), z = Four::splat(dz);
  Four most = along(lanes, x, y, z);
  for (int i = 1; i < blocks; ++i) most = max(most, along(lanes + 12 * i, x, y, z));
  const float a = most[0] < most[1] ? most[1] : most[0], b = most[2] < most[3] ? most[3] : most[2];
  const Four value = Four::splat(a < b ? b : a);
  for (int i = 0; i < blocks; ++i)
    if (const std::uint32_t met = math::bitmask(along(lanes + 12 * i, x, y, z) >= value); met != 0)
      return 4 * i + __builtin_ctz(met);
  return 0;  // not a number
}

static void extremes(const float* lanes, int blocks, const float (&rows)[3][3], float (&least)[3], float (&most)[3]) {
  for (int k = 0; k < 3; ++k) {
    const Four x = Four::splat(rows[k][0]), y = Four::splat(rows[k][1]), z = Four::splat(rows[k][2]);
    Four low = along(lanes, x, y, z), high = low;
    for (int i = 1; i < blocks; ++i) {
      const Four here = along(lanes + 12 * i, x, y, z);
      low = min(low, here), high = max(high, here);
    }
    const float a = low[1] < low[0] ? low[1] : low[0], b = low[3] < low[2] ? low[3] : low[2];
    const float c = high[0] < high[1] ? high[1] : high[0], d = high[2] < high[3] ? high[3] : high[2];
    least[k] = b < a ? b : a, most[k] = c < d ? d : c;
  }
}

extern const CornerKernels kernels = {farthest, extremes};

}  // namespace carom::geometry::detail::CAROM_CORNERS_NAMESPACE
