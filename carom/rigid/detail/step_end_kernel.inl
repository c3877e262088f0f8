// The inner loops of step_end_lanes.h, after move_kernel.inl and in its namespace.

namespace carom::rigid::detail::CAROM_PIN_NAMESPACE {

/// Which of the first `count` bodies are finite, and the slots of those; −1 for all others.
template <int W, int N>
CAROM_SIMD_INLINE std::uint32_t finite_bodies(const WideFloat<W> (&row)[N], const std::int32_t (&slots)[W], int count,
                                              std::int32_t (&finite)[W]) {
  using F = WideFloat<W>;
  F none = F::zero();
  for (int i = 0; i < N; ++i) none += row[i] * F::zero();  // no number times nothing is no number
  const std::uint32_t which = bitmask(none == F::zero()) & ((1u << count) - 1);
  choose_lanes<W>(which, slots, finite);
  return which;
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> without_trace(WideFloat<W> x) {
  return keep(!(abs(x) < WideFloat<W>::splat(motion_trace)), x);
}
template <int N, int W>
CAROM_SIMD_INLINE Lanes<N, W> without_trace(const Lanes<N, W>& a) {
  Lanes<N, W> r;
  for (int i = 0; i < N; ++i) r.v[i] = without_trace(a.v[i]);
  return r;
}
template <int N, int W>
CAROM_SIMD_INLINE WideFloat<W> length_of(const Lanes<N, W>& a) {
  WideFloat<W> sum = a.v[0] * a.v[0];
  for (int i = 1; i < N; ++i) sum += a.v[i] * a.v[i];
  return sqrt(sum);
}
/// Centres and origins, in double.
template <class D, int W>
CAROM_SIMD_INLINE void place_bodies(typename D::Pose* poses, BodyMotion<D>* motions, const std::int32_t (&index)[W],
                                    const Lanes<D::dimension, W>& moved, const Lanes<D::dimension, W>& offset) {
  alignas(64) float by_lane[2][D::dimension][W];
  store(moved, by_lane[0]);
  store(offset, by_lane[1]);
  for (int i = 0; i < W; ++i) {
    if (index[i] < 0) continue;
    typename D::Position& center = motions[index[i]].center;
    typename D::Position& origin = poses[index[i]].position;
    for (int k = 0; k < D::dimension; ++k) {
      center[k] += double(by_lane[0][k][i]);
      origin[k] = center[k] - double(by_lane[1][k][i]);
    }
  }
}

template <int W>
CAROM_SIMD_INLINE WideFloat<W> coarse_lanes(WideFloat<W> x) {  // as `coarse`
  const WideInt<W> high = bits(x) & WideInt<W>::splat(std::int32_t(0xFFFE0000u));
  return select(x > WideFloat<W>::zero(), float_of_bits(high), x);
}
/// Takes from a body's room (BodyMotion) what it went in a step: its surface goes as the centre does, and by the turn
/// at most any way. `next`, `next_turn`: what there must still be room for. Where there may not be: bits by lane.
template <int N, int W>
CAROM_SIMD_INLINE std::uint32_t use_room(WideFloat<W>* below, WideFloat<W>* above, const Lanes<N, W>& way,
                                         WideFloat<W> surface_way, const Lanes<N, W>& next, WideFloat<W> next_turn) {
  using F = WideFloat<W>;
  const F zero = F::zero();
  WideMask<W> near = WideMask<W>::none();
  for (int k = 0; k < N; ++k) {
    below[k] = coarse_lanes(below[k] + way.v[k] - surface_way);
    above[k] = coarse_lanes(above[k] - way.v[k] - surface_way);
    near =
        near | !(below[k] > max(zero - next.v[k], zero) + next_turn) | !(above[k] > max(next.v[k], zero) + next_turn);
  }
  return bitmask(near);
}

// The plane -----------------------------------------------------------------------------------------------------------
template <int W>
void end_bodies(SolverBody<Dim2>* bodies, Pose2* poses, BodyMotion<Dim2>* motions, const std::int32_t* slots, int count,
                const StepEndTerms& terms, BodyEnds& ends) {
  using F = WideFloat<W>;
  using Motion = BodyMotion<Dim2>;
  std::int32_t all[W], index[W];
  repeat_first<W>(slots, count, all);
  F row[8];
  read_records<0>(bodies, all, row);
  const F zero = F::zero(), one = F::splat(1);
  row[3] = zero;
  const std::uint32_t finite = finite_bodies<W>(row, all, count, index);
  ends.broken = ~finite & ((1u << count) - 1);
  static_assert(sizeof(bool) == 1 && offsetof(Motion, slender) == offsetof(Motion, gyroscopic) + 1);
  F before[4], center[4], flags[4], extents[8];
  read_records<offsetof(Pose2, rotation) - 8>(poses, all, before);  // half of the position, and the rotation
  read_records<offsetof(Motion, local_center)>(motions, all, center);
  read_records<offsetof(Motion, gyroscopic)>(motions, all, flags);
  constexpr int extents_at = offsetof(Motion, gravity_scale);  // scale, inner and outer extent, room below and above
  static_assert(offsetof(Motion, inner_extent) == extents_at + 4 && offsetof(Motion, outer_extent) == extents_at + 8 &&
                offsetof(Motion, room_below) == extents_at + 12 && offsetof(Motion, room_above) == extents_at + 20 &&
                sizeof(Motion) == extents_at + 32);
  read_records<extents_at>(motions, all, extents);
  const auto wheel = ((bits(flags[0]) >> 8) & WideInt<W>::splat(255)) != WideInt<W>::zero();
  const F outer = extents[2], spin = abs(row[2]);
  const Lanes<2, W> moved = {{row[4], row[5]}}, turn = {{row[6], row[7]}};
  const F travel = length_of(moved), turned_by = abs(turn.v[1]) + max(zero, F::splat(-2) * turn.v[0]);
  const F reach = select(wheel, zero, abs(turn.v[1]) * outer);
  travel.store_aligned(ends.travel);
  turned_by.store_aligned(ends.turned);
  const auto turns_little = turned_by < F::splat(small_turn);
  const F surface_way = select(turns_little, reach, turned_by * outer);
  surface_way.store_aligned(ends.surface_way);
  spin.store_aligned(ends.spin);
  const auto whirls = spin * F::splat(terms.dt) > F::splat(2);
  ends.whirling = bitmask(whirls) & finite;
  if (ends.whirling != 0)
    for (int k = 0; k < 2; ++k) turn.v[k].store_aligned(ends.turn[k]);
  Lanes<2, W> now = turned(turn, Lanes<2, W>{{before[2], before[3]}});
  const F size = length_of(now);
  const auto turns = size > zero;
  const F scale = one / select(turns, size, one);
  now = {{select(turns, now.v[0] * scale, one), keep(turns, now.v[1] * scale)}};
  const Lanes<2, W> v = without_trace(Lanes<2, W>{{row[0], row[1]}});
  const F w = without_trace(row[2]);
  max(max(length_of(v), F::splat(0.01f) * spin), spin * outer).store_aligned(ends.speed);
  const F ahead = keep(travel > F::splat(quick_share) * extents[1], F::splat(terms.dt));
  ends.near_bounds = use_room<2, W>(extents + 3, extents + 5, moved, surface_way, multiply(v, ahead),
                                    select(wheel, zero, spin * outer * ahead)) |
                     bitmask(!turns_little | whirls);
  scatter_rows<sizeof(Motion) / 4, 8, W>(reinterpret_cast<float*>(motions) + extents_at / 4, index, extents);
  const Lanes<2, W> pushed = subtract(multiply(moved, F::splat(terms.inverse_dt)), v);
  (pushed.v[0] * pushed.v[0] + pushed.v[1] * pushed.v[1]).store_aligned(ends.pushed_squared);
  place_bodies<Dim2, W>(poses, motions, index, moved, turned(now, Lanes<2, W>{{center[0], center[1]}}));
  alignas(64) float rotation[2][W];
  store(now, rotation);
  for (int i = 0; i < W; ++i)
    if (index[i] >= 0) poses[index[i]].rotation = {rotation[0][i], rotation[1][i]};
  const F left[8] = {v.v[0], v.v[1], w, zero, zero, zero, one, zero};
  scatter_rows<8, 8, W>(reinterpret_cast<float*>(bodies), index, left);
}

// Space ---------------------------------------------------------------------------------------------------------------
/// `way_of_turn` of bodies: how far they turn as balls would, and less where they are long.
template <int W>
struct LongBodies {
  WideInt<W> slender;
  WideFloat<W> outer;

  CAROM_SIMD_INLINE bool any_long() const { return any(slender != WideInt<W>::zero()); }
  CAROM_SIMD_INLINE WideFloat<W> way(const Turn<W>& rotation, const Lanes<3, W>& turn, WideFloat<W> ball) const {
    using F = WideFloat<W>;
    using I = WideInt<W>;
    if (!any_long()) return ball;
    const Lanes<3, W> local = turned(conjugated(rotation), turn);
    const I axis = slender & I::splat(3);
    F along = F::zero(), across = F::zero();
    for (int k = 0; k < 3; ++k) {
      const auto is_long = axis == I::splat(k + 1);
      along += keep(is_long, abs(local.v[k]));
      across += keep(!is_long, local.v[k] * local.v[k]);
    }
    const F share = to_float(slender >> 2) * F::splat(1.0f / 63);
    const F rolls = along * outer * (share * share);
    return select(slender != I::zero(), min(ball, sqrt(across) * outer + rolls), ball);
  }
};
/// As `inverse_inertia_in_world` finds it, operation for operation: xx, xy, xz, yy, yz, zz.
template <int W>
CAROM_SIMD_INLINE Lanes<6, W> inverse_in_world(const Lanes<6, W>& inertia, const Turn<W>& q) {
  using F = WideFloat<W>;
  const F one = F::splat(1), two = F::splat(2);
  const F &x = q.u.v[0], &y = q.u.v[1], &z = q.u.v[2];
  const F trace = (inertia.v[0] + inertia.v[3] + inertia.v[5]) * F::splat(1.0f / 3.0f);
  const F scale = one / select(trace > F::zero(), trace, one);
  const Lanes<6, W> t = multiply(inertia, scale);
  const F xx = two * x * x, yy = two * y * y, zz = two * z * z, xy = two * x * y, xz = two * x * z, yz = two * y * z;
  const F wx = two * q.w * x, wy = two * q.w * y, wz = two * q.w * z;
  const Lanes<3, W> row[3] = {
      {{one - yy - zz, xy - wz, xz + wy}}, {{xy + wz, one - xx - zz, yz - wx}}, {{xz - wy, yz + wx, one - xx - yy}}};
  const Lanes<3, W> tx = times(t, row[0]), ty = times(t, row[1]), tz = times(t, row[2]);
  const Lanes<3, W> cx = {{dot(row[0], tx), dot(row[0], ty), dot(row[0], tz)}};
  const Lanes<3, W> cy = {{cx.v[1], dot(row[1], ty), dot(row[1], tz)}}, cz = {{cx.v[2], cy.v[2], dot(row[2], tz)}};
  const Lanes<3, W> a = cross(cy, cz), b = cross(cz, cx), c = cross(cx, cy);
  const F d = dot(cx, a);
  const auto sound = d != F::zero();
  const F s = keep(sound, scale / select(sound, d, one));
  return {{a.v[0] * s, a.v[1] * s, a.v[2] * s, b.v[1] * s, b.v[2] * s, c.v[2] * s}};
}

template <int W>
void end_bodies(SolverBody<Dim3>* bodies, Pose3* poses, BodyMotion<Dim3>* motions, const std::int32_t* slots, int count,
                const StepEndTerms& terms, BodyEnds& ends) {
  using F = WideFloat<W>;
  using Motion = BodyMotion<Dim3>;
  std::int32_t all[W], index[W];
  repeat_first<W>(slots, count, all);
  F row[16];
  read_records<0>(bodies, all, row);
  const std::uint32_t finite = finite_bodies<W>(row, all, count, index);
  ends.broken = ~finite & ((1u << count) - 1);
  static_assert(offsetof(Motion, slender) == offsetof(Motion, gyroscopic) + 1);
  F before[4], center[4], tensor[12], extents[12];
  read_records<offsetof(Pose3, rotation)>(poses, all, before);
  read_records<offsetof(Motion, local_center)>(motions, all, center);
  read_inertia(motions, all, tensor);
  constexpr int extents_at = offsetof(Motion, linear_damping);  // dampings, scale, extents, room below and above
  static_assert(offsetof(Motion, inner_extent) == extents_at + 12 &&
                offsetof(Motion, outer_extent) == extents_at + 16 && offsetof(Motion, room_below) == extents_at + 20 &&
                offsetof(Motion, room_above) == extents_at + 32 && sizeof(Motion) == extents_at + 48);
  read_records<extents_at>(motions, all, extents);
  const F zero = F::zero(), one = F::splat(1), two = F::splat(2), outer = extents[4];
  const auto flags = bits(tensor[1]);
  const LongBodies<W> shape = {(flags >> 8) & WideInt<W>::splat(255), outer};
  const Lanes<3, W> moved = {{row[8], row[9], row[10]}};
  const Turn<W> turn = {row[12], {{row[13], row[14], row[15]}}}, old = {before[0], {{before[1], before[2], before[3]}}};
  const Lanes<3, W> w0 = {{row[4], row[5], row[6]}};
  const F travel = length_of(moved), spin = length_of(w0), turned_by = two * length_of(turn.u);
  travel.store_aligned(ends.travel);
  turned_by.store_aligned(ends.turned);
  spin.store_aligned(ends.spin);
  const F ball = turned_by * outer, reach = shape.way(old, multiply(turn.u, two), ball);
  const auto turns_little = turned_by < F::splat(small_turn);
  const F surface_way = select(turns_little, reach, ball);
  surface_way.store_aligned(ends.surface_way);
  const auto whirls = spin * F::splat(terms.dt) > two;
  ends.whirling = bitmask(whirls) & finite;
  if (ends.whirling != 0)
    for (int k = 0; k < 4; ++k) row[12 + k].store_aligned(ends.turn[k]);
  Turn<W> now = normalized(product(turn, old));
  now.u = without_trace(now.u);
  const Lanes<3, W> v = without_trace(Lanes<3, W>{{row[0], row[1], row[2]}}), w = without_trace(w0);
  const F surface_speed = shape.way(now, w, spin * outer);
  max(max(length_of(v), F::splat(0.01f) * spin), surface_speed).store_aligned(ends.speed);
  const F ahead = keep(travel > F::splat(quick_share) * extents[3], F::splat(terms.dt));
  ends.near_bounds =
      use_room<3, W>(extents + 5, extents + 8, moved, surface_way, multiply(v, ahead), surface_speed * ahead) |
      bitmask(!turns_little | whirls);
  const F room[8] = {extents[4], extents[5], extents[6], extents[7], extents[8], extents[9], extents[10], extents[11]};
  scatter_rows<sizeof(Motion) / 4, 8, W>(reinterpret_cast<float*>(motions) + extents_at / 4 + 4, index, room);
  const Lanes<3, W> pushed = subtract(multiply(moved, F::splat(terms.inverse_dt)), v);
  dot(pushed, pushed).store_aligned(ends.pushed_squared);
  place_bodies<Dim3, W>(poses, motions, index, moved, turned(now, Lanes<3, W>{{center[0], center[1], center[2]}}));
  alignas(64) float rotation[4][W];
  now.w.store_aligned(rotation[0]);
  for (int k = 0; k < 3; ++k) now.u.v[k].store_aligned(rotation[k + 1]);
  for (int i = 0; i < W; ++i)
    if (index[i] >= 0) poses[index[i]].rotation = {rotation[0][i], rotation[1][i], rotation[2][i], rotation[3][i]};
  const F left[16] = {v.v[0], v.v[1], v.v[2], row[3],  w.v[0], w.v[1], w.v[2], row[7],
                      zero,   zero,   zero,   row[11], one,    zero,   zero,   zero};
  scatter_rows<16, 16, W>(reinterpret_cast<float*>(bodies), index, left);
  const auto unlike_a_ball = (flags & WideInt<W>::splat(255)) != WideInt<W>::zero();
  const std::uint32_t turning = bitmask(unlike_a_ball) & terms.turning & finite;
  if (turning == 0) return;
  const Lanes<6, W> inverse = inverse_in_world(tensor_of(tensor), now);
  alignas(64) float i[6][W];
  store(inverse, i);
  for (int k = 0; k < W; ++k)
    if ((turning >> k & 1) != 0)
      motions[index[k]].world_inverse_inertia = {
          {i[0][k], i[1][k], i[2][k]}, {i[1][k], i[3][k], i[4][k]}, {i[2][k], i[4][k], i[5][k]}};
}

}  // namespace carom::rigid::detail::CAROM_PIN_NAMESPACE
