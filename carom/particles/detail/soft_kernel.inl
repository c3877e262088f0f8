// Sweeps of the solver of cloth and soft bodies, a tile of rows at a time.

namespace carom::particles::detail::CAROM_SOFT_NAMESPACE {
namespace {

constexpr int width = CAROM_SOFT_WIDTH;
using F = math::WideFloat<width>;

struct V {
  F x, y, z;
};
CAROM_SIMD_INLINE V operator+(const V& a, const V& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
CAROM_SIMD_INLINE V operator-(const V& a, const V& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
CAROM_SIMD_INLINE V operator*(F s, const V& a) { return {s * a.x, s * a.y, s * a.z}; }
CAROM_SIMD_INLINE F dot(const V& a, const V& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
CAROM_SIMD_INLINE V cross(const V& a, const V& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
CAROM_SIMD_INLINE V load(const float* vector, int lane) {
  return {F::load_aligned(vector + lane), F::load_aligned(vector + soft_lanes + lane),
          F::load_aligned(vector + 2 * soft_lanes + lane)};
}
CAROM_SIMD_INLINE void store(const V& v, float* vector, int lane) {
  v.x.store_aligned(vector + lane);
  v.y.store_aligned(vector + soft_lanes + lane);
  v.z.store_aligned(vector + 2 * soft_lanes + lane);
}
/// Columns of a block.
struct Block {
  V x, y, z;
};
CAROM_SIMD_INLINE Block load_block(const float* block, int lane) {
  return {load(block, lane), load(block + soft_vector, lane), load(block + 2 * soft_vector, lane)};
}
CAROM_SIMD_INLINE V times(const Block& m, const V& v) { return v.x * m.x + v.y * m.y + v.z * m.z; }
CAROM_SIMD_INLINE V transposed_times(const Block& m, const V& v) { return {dot(m.x, v), dot(m.y, v), dot(m.z, v)}; }

/// Records of four floats by their numbers.
CAROM_SIMD_INLINE V gather(const float* records, const int* at) {
  F r[4];
  math::gather_rows<4, width>(records, at, r);
  return {r[0], r[1], r[2]};
}
CAROM_SIMD_INLINE Block gather_blocks(const float* records, const int* at) {
  F r[12];
  math::gather_rows<12, width>(records, at, r);
  return {{r[0], r[1], r[2]}, {r[4], r[5], r[6]}, {r[8], r[9], r[10]}};
}
/// Records that lie side by side.
CAROM_SIMD_INLINE V read_records(const float* records) {
  const float* rows[width];
  math::simd_detail::unrolled<width>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    rows[i] = records + 4 * i;
  });
  F r[4];
  math::gather_rows<4, width>(rows, r);
  return {r[0], r[1], r[2]};
}
CAROM_SIMD_INLINE void write_records(const V& v, float* records) {
  float* rows[width];
  math::simd_detail::unrolled<width>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    rows[i] = records + 4 * i;
  });
  const F r[4] = {v.x, v.y, v.z, F::zero()};
  math::scatter_records<width>(rows, r);
}
/// Adds to records in the order of the lanes: some may be the same.
CAROM_SIMD_INLINE void add_records(const V& v, float* records, const int* at) {
  using namespace math::simd_detail;
  typename F::Vector r[4] = {v.x.v, v.y.v, v.z.v, F::zero().v};
  transpose_blocks<width>(r);
  unrolled<width>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    float* const row = records + 4 * std::ptrdiff_t(at[i]);
    const Four sum = load_four(row) + block_of<width, i / 4>(r[i % 4]);
    __builtin_memcpy(row, &sum, sizeof sum);
  });
}

/// A sum in double of each lane of a tile, then of all of them.
class Sum {
 public:
  CAROM_SIMD_INLINE void add(F v, int lane) {
    constexpr int half = width / 2;
    typedef float Half __attribute__((vector_size(4 * half)));  // NOLINT(modernize-use-using)
    using Double = math::WideDouble<half>;
    Half part[2];
    __builtin_memcpy(part, &v.v, sizeof part);
    for (int k = 0; k < 2; ++k) {
      double* const at = lanes_ + lane + k * half;
      (Double::load_aligned(at) + Double{__builtin_convertvector(part[k], typename Double::Vector)}).store_aligned(at);
    }
  }
  CAROM_SIMD_INLINE double total() const {
    double sum = 0;
    for (const double lane : lanes_) sum += lane;
    return sum;
  }

 private:
  alignas(64) double lanes_[soft_lanes] = {};
};

void fill(const SoftSweep& sweep, const SoftEntries& entries) {
  for (int tile = 0; tile < sweep.tiles; ++tile)
    for (int entry = sweep.first[tile]; entry < sweep.last[tile]; ++entry) {
      if (entries.stale[entry] == 0) continue;
      for (int lane = 0; lane < soft_lanes; lane += width) {
        const std::ptrdiff_t at = std::ptrdiff_t(entry) * soft_lanes + lane;
        const Block own = load_block(sweep.scale + std::ptrdiff_t(tile) * soft_block, lane);
        Block inner = gather_blocks(entries.scale, sweep.column + at);
        if (entry < entries.far[tile]) {
          const Block k = gather_blocks(entries.blocks, entries.source + at);
          inner = {times(k, inner.x), times(k, inner.y), times(k, inner.z)};
        } else {
          F link = F::zero();
          for (int i = 0; i < width; ++i) link.set(i, entries.links[entries.source[at + i]]);
          link = F::splat(entries.link_scale) * link;
          inner = {link * inner.x, link * inner.y, link * inner.z};
        }
        float* const out = sweep.lower + std::ptrdiff_t(entry) * soft_block;
        store(transposed_times(own, inner.x), out, lane);
        store(transposed_times(own, inner.y), out + soft_vector, lane);
        store(transposed_times(own, inner.z), out + 2 * soft_vector, lane);
      }
    }
}

/// L times `forward`, for a part of a tile.
CAROM_SIMD_INLINE V below(const SoftSweep& sweep, int tile, int lane) {
  V sum{F::zero(), F::zero(), F::zero()};
  for (int entry = sweep.first[tile]; entry < sweep.last[tile]; ++entry)
    sum = sum + times(load_block(sweep.lower + std::ptrdiff_t(entry) * soft_block, lane),
                      gather(sweep.forward, sweep.column + std::ptrdiff_t(entry) * soft_lanes + lane));
  return sum;
}

double start(const SoftSweep& sweep, const float* from) {
  Sum size;
  for (int tile = 0; tile < sweep.tiles; ++tile)
    for (int lane = 0; lane < soft_lanes; lane += width) {
      const std::ptrdiff_t place = std::ptrdiff_t(tile) * soft_lanes + lane;
      const Block scale = load_block(sweep.scale + std::ptrdiff_t(tile) * soft_block, lane);
      const V v = transposed_times(scale, read_records(from + 4 * place)) - below(sweep, tile, lane);
      store(v, sweep.swept + std::ptrdiff_t(tile) * soft_vector, lane);
      write_records(v, sweep.forward + 4 * place);
      size.add(dot(v, v), lane);
    }
  return size.total();
}

// What lies above the diagonal is pushed on from tile to tile, in `forward`.
void up(const SoftSweep& sweep, float keep) {
  for (int tile = sweep.tiles; tile-- > 0;) {
    float* const direction = sweep.direction + std::ptrdiff_t(tile) * soft_vector;
    float* const back = sweep.back + std::ptrdiff_t(tile) * soft_vector;
    for (int lane = 0; lane < soft_lanes; lane += width) {
      const V towards =
          load(sweep.swept + std::ptrdiff_t(tile) * soft_vector, lane) + F::splat(keep) * load(direction, lane);
      store(towards, direction, lane);
      store(towards - read_records(sweep.forward + 4 * (std::ptrdiff_t(tile) * soft_lanes + lane)), back, lane);
    }
    for (int entry = sweep.first[tile]; entry < sweep.last[tile]; ++entry)
      for (int lane = 0; lane < soft_lanes; lane += width)
        add_records(
            transposed_times(load_block(sweep.lower + std::ptrdiff_t(entry) * soft_block, lane), load(back, lane)),
            sweep.forward, sweep.column + std::ptrdiff_t(entry) * soft_lanes + lane);
  }
}

double down(const SoftSweep& sweep) {
  Sum curvature;
  for (int tile = 0; tile < sweep.tiles; ++tile)
    for (int lane = 0; lane < soft_lanes; lane += width) {
      const V direction = load(sweep.direction + std::ptrdiff_t(tile) * soft_vector, lane);
      const V back = load(sweep.back + std::ptrdiff_t(tile) * soft_vector, lane);
      V v = direction - back - below(sweep, tile, lane);
      if (sweep.answer != nullptr) v = v + load(sweep.answer + std::ptrdiff_t(tile) * soft_vector, lane);
      write_records(v, sweep.forward + 4 * (std::ptrdiff_t(tile) * soft_lanes + lane));
      curvature.add(dot(direction, back + v), lane);
    }
  return curvature.total();
}

double go(const SoftSweep& sweep, float stride) {
  Sum size;
  const F along = F::splat(stride);
  for (int tile = 0; tile < sweep.tiles; ++tile)
    for (int lane = 0; lane < soft_lanes; lane += width) {
      float* const sum = sweep.sum + std::ptrdiff_t(tile) * soft_vector;
      float* const swept = sweep.swept + std::ptrdiff_t(tile) * soft_vector;
      float* const forward = sweep.forward + 4 * (std::ptrdiff_t(tile) * soft_lanes + lane);
      const V back = load(sweep.back + std::ptrdiff_t(tile) * soft_vector, lane);
      const V left = load(swept, lane) - along * (back + read_records(forward));
      store(load(sum, lane) + along * back, sum, lane);
      store(left, swept, lane);
      for (int k = 0; k < 4; ++k) F::zero().store(forward + k * width);
      size.add(dot(left, left), lane);
    }
  return size.total();
}

}  // namespace
}  // namespace carom::particles::detail::CAROM_SOFT_NAMESPACE
