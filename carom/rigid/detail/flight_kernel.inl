// The inner loop of flight_lanes.h, after joint_kernel.inl and in its namespace. The method is that of
// `torque_free_turn` (rotation_step.h): the momentum m in body axes turns by −θ into m₁, where θ = ½h I⁻¹(m + m₁).
// Between substeps a body's state is its momentum in body axes and its attitude, of any length.

namespace carom::rigid::detail::CAROM_PIN_NAMESPACE {

template <int W>
struct Arrow {
  WideDouble<W> x, y, z;
};
template <int W>
CAROM_SIMD_INLINE Arrow<W> plus(const Arrow<W>& a, const Arrow<W>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <int W>
CAROM_SIMD_INLINE Arrow<W> minus(const Arrow<W>& a, const Arrow<W>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <int W>
CAROM_SIMD_INLINE Arrow<W> scaled(const Arrow<W>& a, WideDouble<W> s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <int W>
CAROM_SIMD_INLINE WideDouble<W> inner(const Arrow<W>& a, const Arrow<W>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <int W>
CAROM_SIMD_INLINE Arrow<W> outer(const Arrow<W>& a, const Arrow<W>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <int W>
CAROM_SIMD_INLINE Arrow<W> choose(typename WideDouble<W>::Mask m, const Arrow<W>& a, const Arrow<W>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
template <int W>
CAROM_SIMD_INLINE Arrow<W> load_arrow(const double (&p)[3][W]) {
  using F = WideDouble<W>;
  return {F::load_aligned(p[0]), F::load_aligned(p[1]), F::load_aligned(p[2])};
}

template <int W>
struct Symmetric {
  WideDouble<W> xx, xy, xz, yy, yz, zz;
};
template <int W>
CAROM_SIMD_INLINE Arrow<W> of_arrow(const Symmetric<W>& m, const Arrow<W>& a) {
  return {m.xx * a.x + m.xy * a.y + m.xz * a.z, m.xy * a.x + m.yy * a.y + m.yz * a.z,
          m.xz * a.x + m.yz * a.y + m.zz * a.z};
}
template <int W>
CAROM_SIMD_INLINE Symmetric<W> inverted(const Symmetric<W>& m) {
  const WideDouble<W> xx = m.yy * m.zz - m.yz * m.yz, xy = m.xz * m.yz - m.xy * m.zz, xz = m.xy * m.yz - m.xz * m.yy;
  const WideDouble<W> s = WideDouble<W>::splat(1) / (m.xx * xx + m.xy * xy + m.xz * xz);
  return {xx * s,
          xy * s,
          xz * s,
          (m.xx * m.zz - m.xz * m.xz) * s,
          (m.xy * m.xz - m.xx * m.yz) * s,
          (m.xx * m.yy - m.xy * m.xy) * s};
}

/// A quaternion.
template <int W>
struct Attitude {
  WideDouble<W> w;
  Arrow<W> u;
};
template <int W>
CAROM_SIMD_INLINE Attitude<W> load_attitude(const double (&p)[4][W]) {
  using F = WideDouble<W>;
  return {F::load_aligned(p[0]), {F::load_aligned(p[1]), F::load_aligned(p[2]), F::load_aligned(p[3])}};
}
template <int W>
CAROM_SIMD_INLINE Attitude<W> then(const Attitude<W>& a, const Attitude<W>& b) {
  return {a.w * b.w - inner(a.u, b.u), plus(plus(scaled(b.u, a.w), scaled(a.u, b.w)), outer(a.u, b.u))};
}
/// v turned by a quaternion (w, u) of any length; backwards by (w, −u).
template <int W>
CAROM_SIMD_INLINE Arrow<W> turned_by(WideDouble<W> w, const Arrow<W>& u, const Arrow<W>& v) {
  const WideDouble<W> twice = WideDouble<W>::splat(2) / (w * w + inner(u, u));
  const Arrow<W> uv = outer(u, v);
  return plus(v, scaled(plus(scaled(uv, w), outer(u, uv)), twice));
}
template <int W>
CAROM_SIMD_INLINE Arrow<W> opposite(const Arrow<W>& a) {
  return {WideDouble<W>::splat(0) - a.x, WideDouble<W>::splat(0) - a.y, WideDouble<W>::splat(0) - a.z};
}
/// The turn by a rotation vector, as (1, result).
template <int W>
CAROM_SIMD_INLINE Arrow<W> half_tangent(const Arrow<W>& angle) {
  using F = WideDouble<W>;
  const F half = F::splat(0.5), yy = F::splat(0.25) * inner(angle, angle);
  return scaled(angle, half * ((F::splat(105) - F::splat(10) * yy) / (F::splat(105) - F::splat(45) * yy + yy * yy)));
}

/// Newton's step for the angle: the error over the slope of the equation, with J the right Jacobian of the exponential
/// map (its series): moving the angle by δ turns m₁ by J δ more.
template <int W>
CAROM_SIMD_INLINE Arrow<W> newton_step(const Symmetric<W>& tensor, const Arrow<W>& angle, const Arrow<W>& m1,
                                       WideDouble<W> half, const Arrow<W>& error) {
  using F = WideDouble<W>;
  const F aa = inner(angle, angle);
  const F b = half * (F::splat(0.5) - aa * (F::splat(1.0 / 24) - aa * F::splat(1.0 / 720)));
  const F c = half * (F::splat(1.0 / 6) - aa * (F::splat(1.0 / 120) - aa * F::splat(1.0 / 5040)));
  const F g = half - c * aa, d = b * inner(m1, angle);
  const Arrow<W> p = scaled(outer(m1, angle), c), q = scaled(angle, b), gm = scaled(m1, g);
  // Columns of tensor − (g [m₁]ₓ + p θᵀ − q m₁ᵀ + d 1).
  const Arrow<W> x = {tensor.xx - p.x * angle.x + q.x * m1.x - d, tensor.xy - gm.z - p.y * angle.x + q.y * m1.x,
                      tensor.xz + gm.y - p.z * angle.x + q.z * m1.x};
  const Arrow<W> y = {tensor.xy + gm.z - p.x * angle.y + q.x * m1.y, tensor.yy - p.y * angle.y + q.y * m1.y - d,
                      tensor.yz - gm.x - p.z * angle.y + q.z * m1.y};
  const Arrow<W> z = {tensor.xz - gm.y - p.x * angle.z + q.x * m1.z, tensor.yz + gm.x - p.y * angle.z + q.y * m1.z,
                      tensor.zz - p.z * angle.z + q.z * m1.z - d};
  const Arrow<W> yz = outer(y, z);
  const F scale = F::splat(1) / inner(x, yz);
  return {inner(error, yz) * scale, inner(x, outer(error, z)) * scale, inner(x, outer(y, error)) * scale};
}

template <int W>
void fly(void* lanes, float h, int substeps, float max_turn) {
  using F = WideDouble<W>;
  FlightLanes<W>& c = *static_cast<FlightLanes<W>*>(lanes);
  Symmetric<W> tensor = {F::load_aligned(c.inertia[0]), F::load_aligned(c.inertia[1]), F::load_aligned(c.inertia[2]),
                         F::load_aligned(c.inertia[3]), F::load_aligned(c.inertia[4]), F::load_aligned(c.inertia[5])};
  const F unit = F::splat(1) / tensor.xx;
  tensor = {F::splat(1), tensor.xy * unit, tensor.xz * unit, tensor.yy * unit, tensor.yz * unit, tensor.zz * unit};
  const Symmetric<W> inverse = inverted(tensor);
  const F step = F::splat(double(h)), half = F::splat(0.5 * double(h)), keep = F::load_aligned(c.keep);
  const F most = F::splat(double(max_turn) / double(h));
  const Attitude<W> start = load_attitude(c.start);
  Attitude<W> attitude = then(load_attitude(c.so_far), start);
  Arrow<W> w = turned_by(attitude.w, opposite(attitude.u), load_arrow(c.spin)), m{};
  for (int substep = 0; substep < substeps; ++substep) {
    if (c.any_gain) w = plus(w, turned_by(attitude.w, opposite(attitude.u), load_arrow(c.gain)));
    w = scaled(w, keep);
    const F fast = inner(w, w);
    const auto too_fast = fast > most * most;
    if (any_of<W>(too_fast)) w = scaled(w, select(too_fast, most / sqrt(fast), F::splat(1)));
    m = of_arrow(tensor, w);
    const F enough = F::splat(1e-28) * half * half * inner(m, m);
    // Euler's equation gives the angle to the second order.
    Arrow<W> angle = scaled(plus(w, scaled(of_arrow(inverse, outer(m, w)), half)), step);
    Arrow<W> t = half_tangent(angle), m1 = turned_by(F::splat(1), opposite(t), m);
    for (int i = 0; i < 12; ++i) {
      const Arrow<W> error = minus(of_arrow(tensor, angle), scaled(plus(m, m1), half));
      const auto open = inner(error, error) > enough;
      if (!any_of<W>(open)) break;
      // A lane that has arrived stays: no lane's result depends on its neighbours.
      angle = choose(open, minus(angle, newton_step(tensor, angle, m1, half, error)), angle);
      t = half_tangent(angle);
      m1 = turned_by(F::splat(1), opposite(t), m);
    }
    // Where the method found nothing (a thin piece that a blow spins past half a turn a substep), it turns as it spins.
    const auto found = F::splat(9) > inner(angle, angle);  // greatest_free_turn², rotation_step.h
    const Arrow<W> w1 = of_arrow(inverse, m1);
    if (any_of<W>(~found)) {
      const Arrow<W> plain = half_tangent(scaled(w, step));
      t = choose(found, t, plain);
      w = choose(found, w1, turned_by(F::splat(1), opposite(t), w));
    } else {
      w = w1;
    }
    attitude = then(attitude, {F::splat(1), t});
  }
  const Attitude<W> turn = then(attitude, {start.w, opposite(start.u)});
  const F scale = F::splat(1) / sqrt(turn.w * turn.w + inner(turn.u, turn.u));
  w.x.store_aligned(c.spin[0]), w.y.store_aligned(c.spin[1]), w.z.store_aligned(c.spin[2]);
  (turn.w * scale).store_aligned(c.so_far[0]);
  (turn.u.x * scale).store_aligned(c.so_far[1]);
  (turn.u.y * scale).store_aligned(c.so_far[2]);
  (turn.u.z * scale).store_aligned(c.so_far[3]);
}

}  // namespace carom::rigid::detail::CAROM_PIN_NAMESPACE
