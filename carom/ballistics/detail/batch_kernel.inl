// The step of ProjectileBatch, compiled once for each instruction set: CAROM_BATCH_NAMESPACE, CAROM_BATCH_WIDTH.

namespace carom::ballistics::detail::CAROM_BATCH_NAMESPACE {

using F = math::WideFloat<CAROM_BATCH_WIDTH>;
using I = math::WideInt<CAROM_BATCH_WIDTH>;

struct Vector {
  F x, y, z;
};
CAROM_SIMD_INLINE Vector add(const Vector& a, F s, const Vector& b) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

/// The first `Count` values of a table's rows, linear between two nodes.
template <int Row, int Count>
CAROM_SIMD_INLINE void look_up(const float* table, I node, F part, F (&values)[Count]) {
  std::int32_t index[CAROM_BATCH_WIDTH];
  node.store(index);
  F columns[Row];
  math::gather_rows<Row, CAROM_BATCH_WIDTH>(table, index, columns);
  for (int k = 0; k < Count; ++k) values[k] = columns[2 * k] + part * columns[2 * k + 1];
}

struct Air {
  F density, slowness;
  Vector wind;
};

CAROM_SIMD_INLINE Vector acceleration(const BatchStep& b, const Air& air, F k, const Vector& v) {
  const Vector w = {v.x - air.wind.x, v.y - air.wind.y, v.z - air.wind.z};
  const F speed = sqrt(w.x * w.x + w.y * w.y + w.z * w.z);
  // In this order for what is no number.
  const F place = min(F::splat(b.last_node), speed * air.slowness * F::splat(b.nodes_per_mach));
  const I node = to_int(place);
  F coefficient[1];
  look_up<drag_row>(b.drag, node, place - to_float(node), coefficient);
  const F drag = min(F::splat(b.most_drag), coefficient[0] * air.density * k * speed);
  const F tx = F::splat(b.turning[0]), ty = F::splat(b.turning[1]), tz = F::splat(b.turning[2]);
  return {ty * v.z - tz * v.y - drag * w.x, tz * v.x - tx * v.z - drag * w.y - F::splat(b.gravity),
          tx * v.y - ty * v.x - drag * w.z};
}

void step(const BatchStep& b, std::size_t from, std::size_t to) {
  const F h = F::splat(b.dt), half = F::splat(0.5f * b.dt), sixth = F::splat(b.dt / 6.0f);
  for (std::size_t i = from; i < to; i += CAROM_BATCH_WIDTH) {
    const Vector x = {F::load(b.position[0] + i), F::load(b.position[1] + i), F::load(b.position[2] + i)};
    const Vector v1 = {F::load(b.velocity[0] + i), F::load(b.velocity[1] + i), F::load(b.velocity[2] + i)};
    const F k = F::load(b.half_area_per_mass + i);
    const F height = x.y + half * v1.y;
    const F above = height - F::splat(b.base);
    const F distance = min(F::splat(greatest_distance), max(F::splat(least_distance), abs(above)));
    const I cell = bits(distance) >> air_shift;
    const I below = select(above < F::zero(), I::splat(air_cells), I::zero());
    F row[5];
    look_up<air_row>(b.air, cell - I::splat(air_first) + below, distance - float_of_bits(cell << air_shift), row);
    const Air air = {row[0], row[1], {row[2], row[3], row[4]}};
    const Vector a1 = acceleration(b, air, k, v1);
    const Vector v2 = add(v1, half, a1), a2 = acceleration(b, air, k, v2);
    const Vector v3 = add(v1, half, a2), a3 = acceleration(b, air, k, v3);
    const Vector v4 = add(v1, h, a3), a4 = acceleration(b, air, k, v4);
    const F two = F::splat(2);
    const Vector v = {v1.x + sixth * (a1.x + two * (a2.x + a3.x) + a4.x),
                      v1.y + sixth * (a1.y + two * (a2.y + a3.y) + a4.y),
                      v1.z + sixth * (a1.z + two * (a2.z + a3.z) + a4.z)};
    x.x.store(b.previous[0] + i);
    x.y.store(b.previous[1] + i);
    x.z.store(b.previous[2] + i);
    (x.x + sixth * (v1.x + two * (v2.x + v3.x) + v4.x)).store(b.position[0] + i);
    (x.y + sixth * (v1.y + two * (v2.y + v3.y) + v4.y)).store(b.position[1] + i);
    (x.z + sixth * (v1.z + two * (v2.z + v3.z) + v4.z)).store(b.position[2] + i);
    v.x.store(b.velocity[0] + i);
    v.y.store(b.velocity[1] + i);
    v.z.store(b.velocity[2] + i);
  }
}

}  // namespace carom::ballistics::detail::CAROM_BATCH_NAMESPACE
