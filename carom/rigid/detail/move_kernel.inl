// The inner loops of move_lanes.h, after joint_limb_kernel.inl and in its namespace. See rotation_step.h for how
// bodies turn.

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

/// Lanes without a body are like the first.
template <int W>
CAROM_SIMD_INLINE void repeat_first(const std::int32_t* slots, int count, std::int32_t (&index)[W]) {
  for (int i = 0; i < W; ++i) index[i] = slots[i < count ? i : 0];
}
/// Columns floats of each body from byte Offset on.
template <int Offset, int Columns, class Record, int W>
CAROM_SIMD_INLINE void read_records(const Record* records, const std::int32_t (&index)[W],
                                    WideFloat<W> (&columns)[Columns]) {
  const float* rows[W];
  for (int i = 0; i < W; ++i)
    rows[i] = reinterpret_cast<const float*>(reinterpret_cast<const char*>(records + index[i]) + Offset);
  gather_rows<Columns, W>(rows, columns);
}
/// Mass, flags (BodyMotion::gyroscopic, slender, load_level), nine moments and a damping.
template <int W>
CAROM_SIMD_INLINE void read_inertia(const BodyMotion<Dim3>* motions, const std::int32_t (&index)[W],
                                    WideFloat<W> (&row)[12]) {
  using Motion = BodyMotion<Dim3>;
  static_assert(offsetof(Motion, gyroscopic) == offsetof(Motion, mass) + 4 &&
                offsetof(Motion, inertia) == offsetof(Motion, mass) + 8);
  read_records<offsetof(Motion, mass)>(motions, index, row);
}
/// xx, xy, xz, yy, yz, zz.
template <int W>
CAROM_SIMD_INLINE Lanes<6, W> tensor_of(const WideFloat<W> (&row)[12]) {
  return {{row[2], row[3], row[4], row[6], row[7], row[10]}};
}

template <int W>
void turn_bodies(SolverBody<Dim3>* bodies, const Pose3* poses, const BodyMotion<Dim3>* motions,
                 const std::int32_t* slots, int count, float h) {
  using F = WideFloat<W>;
  std::int32_t all[W], index[W];
  repeat_first<W>(slots, count, all);
  for (int i = 0; i < W; ++i) index[i] = i < count ? slots[i] : -1;
  const Motion3<W> motion = read_motion<W>(bodies, all);
  F before[4], inertia[12];
  read_records<offsetof(Pose3, rotation)>(poses, all, before);
  read_inertia(motions, all, inertia);
  const Turn<W> turned_so_far = read_placement<W>(bodies, all).turn,
                start = {before[0], {{before[1], before[2], before[3]}}};
  const Turn<W> q = normalized(product(turned_so_far, start));
  Lanes<6, W> tensor = tensor_of(inertia);
  tensor = multiply(tensor, reciprocal_above(tensor.v[0], F::zero()));
  const F half = F::splat(0.5f * h);
  const Lanes<3, W> w = turned(conjugated(q), motion.w), m = times(tensor, w);
  const F enough = F::splat(1e-12f) * half * half * dot(m, m);
  const Lanes<3, W> column[3] = {{{tensor.v[0], tensor.v[1], tensor.v[2]}},
                                 {{tensor.v[1], tensor.v[3], tensor.v[4]}},
                                 {{tensor.v[2], tensor.v[4], tensor.v[5]}}};
  // Euler's equation gives the angle to the second order.
  const Lanes<6, W> factor = factorise(tensor);
  Lanes<3, W> angle = multiply(add(w, multiply(solve_factor(factor, cross(m, w)), half)), F::splat(h)), turned_m = m;
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
  const auto found = F::splat(greatest_free_turn * greatest_free_turn) > dot(angle, angle);
  const Turn<W> plain = turn_by(multiply(w, F::splat(h)));
  r.w = select(found, r.w, plain.w);
  for (int k = 0; k < 3; ++k) r.u.v[k] = select(found, r.u.v[k], plain.u.v[k]);
  const Turn<W> now = product(q, r), total = normalized(product(now, conjugated(start)));
  Lanes<3, W> spin = turned(now, solve_factor(factor, turned(conjugated(r), m)));
  for (int k = 0; k < 3; ++k) spin.v[k] = select(found, spin.v[k], motion.w.v[k]);
  const F velocity[4] = {spin.v[0], spin.v[1], spin.v[2], F::zero()};
  const F rotation[4] = {total.w, total.u.v[0], total.u.v[1], total.u.v[2]};
  float* const floats = reinterpret_cast<float*>(bodies);
  scatter_rows<16, 4, W>(floats + 4, index, velocity);
  scatter_rows<16, 4, W>(floats + 12, index, rotation);
}

/// What drives the bodies of a few places, and who they are.
template <int W>
struct Driven3 {
  std::int32_t body[W];
  WideFloat<W> drive[12];  // see BodyDrive
  int count;

  CAROM_SIMD_INLINE Driven3(const BodyDrive<Dim3>* drives, int number) : count(number) {
    const float* rows[W];
    for (int i = 0; i < W; ++i) {
      const BodyDrive<Dim3>& one = drives[i < count ? i : 0];
      body[i] = one.body;
      rows[i] = reinterpret_cast<const float*>(&one);
    }
    gather_rows<12, W>(rows, drive);
  }
  CAROM_SIMD_INLINE WideFloat<W> kind() const { return drive[10]; }
  CAROM_SIMD_INLINE std::uint32_t which(WideMask<W> mask) const { return bitmask(mask) & ((1u << count) - 1); }
  CAROM_SIMD_INLINE std::uint32_t locked() const { return which(kind() > WideFloat<W>::splat(3)); }
  CAROM_SIMD_INLINE WideMask<W> gyroscopic() const {
    constexpr int flag = BodyDrive<Dim3>::gyroscopic;  // flags are the lowest byte of the second number
    return (bits(drive[1]) & WideInt<W>::splat(flag)) != WideInt<W>::zero();
  }
};
/// Only the lanes of `which`; the others −1.
template <int W>
CAROM_SIMD_INLINE void choose_lanes(std::uint32_t which, const std::int32_t (&index)[W], std::int32_t (&chosen)[W]) {
  for (int i = 0; i < W; ++i) chosen[i] = (which >> i & 1) != 0 ? index[i] : -1;
}
template <int Columns, int W>
CAROM_SIMD_INLINE void read_flights(const Flight<Dim3>* flights, int count, WideFloat<W> (&columns)[Columns]) {
  const float* rows[W];
  for (int i = 0; i < W; ++i) rows[i] = reinterpret_cast<const float*>(flights + (i < count ? i : 0));
  gather_rows<Columns, W>(rows, columns);
}

/// No faster than `most`.
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> limited(const Lanes<3, W>& v, float most) {
  using F = WideFloat<W>;
  const F top = F::splat(most), speed2 = dot(v, v);
  const auto fast = speed2 > top * top;
  if (!any(fast)) return v;
  return multiply(v, select(fast, top / sqrt(select(fast, speed2, top)), F::splat(1)));
}

template <int W>
std::uint32_t accelerate_bodies(SolverBody<Dim3>* bodies, const BodyDrive<Dim3>* drives, Flight<Dim3>* flights,
                                int count, float h, float max_speed, bool carry_on) {
  using F = WideFloat<W>;
  const Driven3<W> driven(drives, count);
  const F kind = driven.kind(), one = F::splat(1), zero = F::zero();
  const auto carries = kind == F::splat(2);
  const std::uint32_t which = driven.which((kind == one) | carries);
  if (which == 0) return driven.locked();
  F row[8];
  read_records<0>(bodies, driven.body, row);
  const F* const drive = driven.drive;
  Lanes<3, W> v = {{row[0] + drive[4], row[1] + drive[5], row[2] + drive[6]}};
  Lanes<3, W> w = {{row[4] + drive[7], row[5] + drive[8], row[6] + drive[9]}};
  v = limited(multiply(v, drive[2]), max_speed);
  w = limited(multiply(w, drive[3]), max_turn / h);
  Lanes<3, W> carried = {{zero, zero, zero}}, carried_spin = carried;
  if (carry_on && (driven.which(carries) & which) != 0) {
    F last[12];
    read_flights(flights, count, last);
    for (int k = 0; k < 3; ++k) {
      carried.v[k] = keep(carries, row[k] - last[k]);
      carried_spin.v[k] = keep(carries, row[4 + k] - last[8 + k]);
    }
  }
  std::int32_t index[W], places[W];
  for (int i = 0; i < W; ++i) places[i] = i;
  choose_lanes<W>(which, driven.body, index);
  const Lanes<3, W> v1 = add(v, carried), w1 = add(w, carried_spin);
  const F moved[8] = {v1.v[0], v1.v[1], v1.v[2], row[3], w1.v[0], w1.v[1], w1.v[2], row[7]};
  scatter_rows<16, 8, W>(reinterpret_cast<float*>(bodies), index, moved);
  choose_lanes<W>(which, places, index);
  const F flight[12] = {v.v[0], v.v[1], v.v[2], zero, row[0], row[1], row[2], zero, w.v[0], w.v[1], w.v[2], zero};
  scatter_rows<12, 12, W>(reinterpret_cast<float*>(flights), index, flight);
  return driven.locked();
}

template <int W>
LeftOver move_bodies(SolverBody<Dim3>* bodies, const BodyDrive<Dim3>* drives, const Flight<Dim3>* flights, int count,
                     float h) {
  using F = WideFloat<W>;
  const Driven3<W> driven(drives, count);
  const F kind = driven.kind();
  LeftOver left;
  left.locked = driven.locked();
  const std::uint32_t which = driven.which(kind < F::splat(3));
  if (which == 0) return left;
  F row[16], flight[8];
  read_records<0>(bodies, driven.body, row);
  read_flights(flights, count, flight);
  // What others are near but do not touch flies too: nothing has changed its velocity.
  const auto flies = (kind > F::zero()) & (row[0] == flight[0]) & (row[1] == flight[1]) & (row[2] == flight[2]);
  const F share = F::splat(0.5f * h), whole = F::splat(h);
  F moved[8];
  for (int k = 0; k < 3; ++k) moved[k] = row[8 + k] + select(flies, share * (flight[4 + k] + row[k]), whole * row[k]);
  moved[3] = row[11];
  const Lanes<3, W> w = {{row[4], row[5], row[6]}};
  const auto by_itself = driven.gyroscopic() & (dot(w, w) > F::splat(least_spin_squared));
  const Turn<W> old = {row[12], {{row[13], row[14], row[15]}}};
  const Turn<W> turned = normalized(product(turn_by(multiply(w, whole)), old));
  moved[4] = select(by_itself, old.w, turned.w);
  for (int k = 0; k < 3; ++k) moved[5 + k] = select(by_itself, old.u.v[k], turned.u.v[k]);
  std::int32_t index[W];
  choose_lanes<W>(which, driven.body, index);
  scatter_rows<16, 8, W>(reinterpret_cast<float*>(bodies) + 8, index, moved);
  left.free = driven.which(by_itself & flies) & which;
  left.pushed = driven.which(by_itself & !flies) & which;
  return left;
}

template <int W>
std::uint32_t fly_bodies(SolverBody<Dim3>* bodies, const BodyDrive<Dim3>* drives, int count, float h, int substeps,
                         float max_speed) {
  using F = WideFloat<W>;
  const Driven3<W> driven(drives, count);
  const F* const drive = driven.drive;
  const std::uint32_t which = driven.which(driven.kind() == F::splat(3));
  if (which == 0) return 0;
  F row[16];
  read_records<0>(bodies, driven.body, row);
  Lanes<3, W> v = {{row[0], row[1], row[2]}}, w = {{row[4], row[5], row[6]}}, moved = {{row[8], row[9], row[10]}};
  const Lanes<3, W> gain = {{drive[4], drive[5], drive[6]}}, spin_gain = {{drive[7], drive[8], drive[9]}};
  const auto by_itself =
      driven.gyroscopic() & ((dot(w, w) > F::splat(least_spin_squared)) | (dot(spin_gain, spin_gain) > F::zero()));
  const std::uint32_t left = driven.which(by_itself) & which;
  Turn<W> q = {row[12], {{row[13], row[14], row[15]}}};
  const F share = F::splat(0.5f * h);
  for (int k = 0; k < substeps; ++k) {  // the mean of the velocities makes ½at² exact
    const Lanes<3, W> before = v;
    v = limited(multiply(add(v, gain), drive[2]), max_speed);
    moved = add(moved, multiply(add(before, v), share));
  }
  if (left != which)
    for (int k = 0; k < substeps; ++k) {
      w = limited(multiply(add(w, spin_gain), drive[3]), max_turn / h);
      q = normalized(product(turn_by(multiply(w, F::splat(h))), q));
    }
  F now[16] = {v.v[0],     v.v[1],     v.v[2],     row[3],  w.v[0], w.v[1],   w.v[2],   row[7],
               moved.v[0], moved.v[1], moved.v[2], row[11], q.w,    q.u.v[0], q.u.v[1], q.u.v[2]};
  for (const int k : {4, 5, 6, 12, 13, 14, 15}) now[k] = select(by_itself, row[k], now[k]);
  std::int32_t index[W];
  choose_lanes<W>(which, driven.body, index);
  scatter_rows<16, 16, W>(reinterpret_cast<float*>(bodies), index, now);
  return left;
}

}  // namespace carom::rigid::detail::CAROM_PIN_NAMESPACE
