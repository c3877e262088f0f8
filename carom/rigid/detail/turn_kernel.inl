// The inner loop of turn_lanes.h, after joint_limb_kernel.inl and in its namespace. See rotation_step.h for the method.

namespace carom::rigid::detail::CAROM_PIN_NAMESPACE {

template <int W>
CAROM_SIMD_INLINE Turn<W> conjugated(const Turn<W>& q) {
  return {q.w, multiply(q.u, WideFloat<W>::splat(-1))};
}
template <int W>
CAROM_SIMD_INLINE Turn<W> normalized(const Turn<W>& q) {
  const WideFloat<W> size2 = q.w * q.w + dot(q.u, q.u);
  const WideFloat<W> scale =
      WideFloat<W>::splat(1) / sqrt(select(size2 > WideFloat<W>::zero(), size2, WideFloat<W>::splat(1)));
  return {q.w * scale, multiply(q.u, scale)};
}
/// The turn by a rotation vector up to 2.5 rad.
template <int W>
CAROM_SIMD_INLINE Turn<W> turn_by(const Lanes<3, W>& angle) {
  using F = WideFloat<W>;
  const Lanes<3, W> y = multiply(angle, F::splat(0.5f));
  const F yy = dot(y, y);
  const Lanes<3, W> t =
      multiply(y, (F::splat(105) - F::splat(10) * yy) / (F::splat(105) - F::splat(45) * yy + yy * yy));
  const F s = F::splat(1) / sqrt(F::splat(1) + dot(t, t));
  return {s, multiply(t, s)};
}

template <int W>
void turn_bodies(SolverBody<Dim3>* bodies, const void* lanes, float h) {
  using F = WideFloat<W>;
  const TurnLanes<W>& c = *static_cast<const TurnLanes<W>*>(lanes);
  const Motion3<W> motion = read_motion<W>(bodies, c.body);
  const Turn<W> turned_so_far = read_placement<W>(bodies, c.body).turn, start = load_turn(c.start);
  const Turn<W> q = normalized(product(turned_so_far, start));
  Lanes<6, W> tensor = load(c.inertia);
  tensor = multiply(tensor, reciprocal_above(tensor.v[0], F::zero()));
  const F half = F::splat(0.5f * h);
  const Lanes<3, W> w = turned(conjugated(q), motion.w), m = times(tensor, w);
  const F enough = F::splat(1e-12f) * half * half * dot(m, m);
  const Lanes<3, W> column[3] = {{{tensor.v[0], tensor.v[1], tensor.v[2]}},
                                 {{tensor.v[1], tensor.v[3], tensor.v[4]}},
                                 {{tensor.v[2], tensor.v[4], tensor.v[5]}}};
  Lanes<3, W> angle = multiply(w, F::splat(h)), turned_m = m;
  Turn<W> r = turn_by(angle);
  for (int i = 0; i < 8; ++i) {
    turned_m = turned(conjugated(r), m);
    const Lanes<3, W> error = subtract(times(tensor, angle), multiply(add(m, turned_m), half));
    const auto open = dot(error, error) > enough;
    if (!any(open)) break;
    const F aa = dot(angle, angle);
    const F b = F::splat(0.5f) - aa * (F::splat(1.0f / 24) - aa * F::splat(1.0f / 720));
    const F d = F::splat(1.0f / 6) - aa * (F::splat(1.0f / 120) - aa * F::splat(1.0f / 5040));
    Lanes<3, W> slope[3];
    for (int k = 0; k < 3; ++k) {
      Lanes<3, W> axis = {{F::zero(), F::zero(), F::zero()}};
      axis.v[k] = F::splat(1);
      const Lanes<3, W> first = cross(angle, axis), second = cross(angle, first);
      const Lanes<3, W> moved = add(subtract(axis, multiply(first, b)), multiply(second, d));
      slope[k] = subtract(column[k], multiply(cross(turned_m, moved), half));
    }
    const Lanes<3, W> yz = cross(slope[1], slope[2]);
    const F determinant = dot(slope[0], yz);
    const F scale = F::splat(1) / select(determinant != F::zero(), determinant, F::splat(1));
    const Lanes<3, W> step = {{dot(error, yz) * scale, dot(slope[0], cross(error, slope[2])) * scale,
                               dot(slope[0], cross(slope[1], error)) * scale}};
    // A lane that has arrived stays: no lane's result depends on its neighbours.
    for (int k = 0; k < 3; ++k) angle.v[k] = select(open, angle.v[k] - step.v[k], angle.v[k]);
    r = turn_by(angle);
  }
  // Where the method found nothing (a thin piece that a blow spins past half a turn a substep), it turns as it spins.
  const auto found = F::splat(9) > dot(angle, angle);  // greatest_free_turn², rotation_step.h
  const Turn<W> plain = turn_by(multiply(w, F::splat(h)));
  r.w = select(found, r.w, plain.w);
  for (int k = 0; k < 3; ++k) r.u.v[k] = select(found, r.u.v[k], plain.u.v[k]);
  const Turn<W> now = product(q, r), total = normalized(product(now, conjugated(start)));
  Lanes<3, W> spin = turned(now, solve_factor(factorise(tensor), turned(conjugated(r), m)));
  for (int k = 0; k < 3; ++k) spin.v[k] = select(found, spin.v[k], motion.w.v[k]);
  const F velocity[4] = {spin.v[0], spin.v[1], spin.v[2], F::zero()};
  const F rotation[4] = {total.w, total.u.v[0], total.u.v[1], total.u.v[2]};
  float* const floats = reinterpret_cast<float*>(bodies);
  scatter_rows<16, 4, W>(floats + 4, c.body, velocity);
  scatter_rows<16, 4, W>(floats + 12, c.body, rotation);
}

TurnKernel turn_kernel() { return turn_bodies<CAROM_PIN_WIDTH>; }

}  // namespace carom::rigid::detail::CAROM_PIN_NAMESPACE
