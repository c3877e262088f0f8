// How pairs have moved, as many at a time as there are lanes, and whether what is known of those that are apart is
// still true: as pair_motion.inl tells. Part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

/// The words of both dimensions.
template <class D, int W>
using WideVector = std::conditional_t<D::dimension == 2, WideVec2<W>, WideVec3<W>>;
template <class D, int W>
using WideTurn = std::conditional_t<D::dimension == 2, WideTurn2<W>, WideQuat<W>>;

/// The vector or the rotation in columns from `first` on.
template <class D, int W, int Columns>
CAROM_SIMD_INLINE WideVector<D, W> vector_in(const WideFloat<W> (&columns)[Columns], int first) {
  if constexpr (D::dimension == 2)
    return {columns[first], columns[first + 1]};
  else
    return {columns[first], columns[first + 1], columns[first + 2]};
}
template <class D, int W, int Columns>
CAROM_SIMD_INLINE WideTurn<D, W> turn_in(const WideFloat<W> (&columns)[Columns], int first) {
  if constexpr (D::dimension == 2)
    return {columns[first], columns[first + 1]};
  else
    return {columns[first], columns[first + 1], columns[first + 2], columns[first + 3]};
}
template <int W>
CAROM_SIMD_INLINE void store_each(const WideVec2<W>& v, float (&to)[2][16]) {
  v.x.store(to[0]), v.y.store(to[1]);
}
template <int W>
CAROM_SIMD_INLINE void store_each(const WideVec3<W>& v, float (&to)[3][16]) {
  v.x.store(to[0]), v.y.store(to[1]), v.z.store(to[2]);
}

/// One side of the pairs: rotations of the bodies and their shapes, and where those stand.
template <class D, int W>
struct PlacedShapes {
  static constexpr int N = D::dimension, turn_at = N == 2 ? 2 : 0;
  WideTurn<D, W> body, local, shape;
  alignas(16) double at[N][W];

  CAROM_SIMD_INLINE PlacedShapes(const typename D::Pose* poses, const std::int32_t (&bodies)[W],
                                 const typename D::Transform* const (&frames)[W], bool moved) {
    const float *turn[W], *in_body[W];
    for (int i = 0; i < W; ++i) {
      turn[i] = reinterpret_cast<const float*>(&poses[bodies[i]].rotation) - turn_at;
      in_body[i] = reinterpret_cast<const float*>(frames[i]);
    }
    WideFloat<W> q[4];
    gather_rows<4, W>(turn, q);
    body = turn_in<D, W>(q, turn_at);
    for (int i = 0; i < W; ++i)
      for (int k = 0; k < N; ++k) at[k][i] = poses[bodies[i]].position[k];
    shape = body;
    if (!moved) return;
    constexpr int columns = N == 2 ? 4 : 8;
    WideFloat<W> frame[columns];
    gather_rows<columns, W>(in_body, frame);
    local = turn_in<D, W>(frame, N), shape = multiply(body, local);
    float arm[N][16];
    store_each(rotate(body, vector_in<D, W>(frame, 0)), arm);
    for (int i = 0; i < W; ++i)
      for (int k = 0; k < N; ++k) at[k][i] += double(arm[k][i]);
  }
};

/// How far turns in their own frames move the surfaces of the shapes of B about their middles, at most (about a long
/// axis little), and m per radian of what they turn further. Where that was less than all of the ball, other axes are
/// not all alike, and turns about two of them are more than either.
template <class D, int W>
struct SurfaceWays;
template <int W>
struct SurfaceWays<Dim2, W> {
  using F = WideFloat<W>;
  F extent;

  CAROM_SIMD_INLINE SurfaceWays(const PairMotions<Dim2>& pairs, F) : extent(F::load(pairs.extent)) {}
  CAROM_SIMD_INLINE F half_turn(const WideTurn2<W>& a, const WideTurn2<W>& b) const {
    return F::splat(0.5f) * length(WideVec2<W>{b.c - a.c, b.s - a.s});
  }
  CAROM_SIMD_INLINE F of(F turn) const { return abs(turn) * extent; }
  CAROM_SIMD_INLINE void of_more(F, F, PairMotions<Dim2>&) const {}
};
template <int W>
struct SurfaceWays<Dim3, W> {
  using F = WideFloat<W>;
  F ball, rounding;
  WideVec3<W> box, arms;

  CAROM_SIMD_INLINE SurfaceWays(const PairMotions<Dim3>& pairs, F extent)
      : ball(extent),
        rounding(F::load(pairs.rounding)),
        box{F::load(pairs.box[0]), F::load(pairs.box[1]), F::load(pairs.box[2])},
        arms{sqrt(box.y * box.y + box.z * box.z), sqrt(box.z * box.z + box.x * box.x),
             sqrt(box.x * box.x + box.y * box.y)} {}
  CAROM_SIMD_INLINE WideVec3<W> half_turn(const WideQuat<W>& a, const WideQuat<W>& b) const {
    const WideQuat<W> q = multiply(conjugate(a), b);
    return {q.x, q.y, q.z};
  }
  CAROM_SIMD_INLINE F of(const WideVec3<W>& turn) const {
    const F angle = length(turn);
    return min(angle * ball, dot(WideVec3<W>{abs(turn.x), abs(turn.y), abs(turn.z)}, arms) + angle * rounding);
  }
  CAROM_SIMD_INLINE void of_more(const WideVec3<W>& before, F way, PairMotions<Dim3>& pairs) const {
    const F angle = length(before), one = F::splat(1);
    const F more = max(ball, F::splat(1.4143f) * length(box) * (one + angle) + rounding);
    select(way < angle * ball, more, ball).store(pairs.extent);
  }
};

/// What a side adds to a sweep of shapes: the way of points at r from its body's centre, by its velocity there, and how
/// far they stray from that.
template <int W>
CAROM_SIMD_INLINE void sweep_of_side(const std::int32_t (&body)[W], const MovingBodies<Dim2>& bodies,
                                     const PlacedShapes<Dim2, W>&, const SurfaceWays<Dim2, W>& surface,
                                     const WideVec2<W>& r, WideFloat<W> h, WideVec2<W>& way, WideFloat<W>& turning) {
  using F = WideFloat<W>;
  F v[4];
  gather<W>(bodies.velocities, body, 0, v);
  way = {(v[0] - v[2] * r.y) * h, (v[1] + v[2] * r.x) * h};
  const F turn = v[2] * h;
  turning = surface.of(turn) + F::splat(0.5f) * turn * turn * length(r);
}
template <int W>
CAROM_SIMD_INLINE void sweep_of_side(const std::int32_t (&body)[W], const MovingBodies<Dim3>& bodies,
                                     const PlacedShapes<Dim3, W>& placed, const SurfaceWays<Dim3, W>& surface,
                                     const WideVec3<W>& r, WideFloat<W> h, WideVec3<W>& way, WideFloat<W>& turning) {
  using F = WideFloat<W>;
  F v[8];
  gather<W>(bodies.velocities, body, 0, v);
  const WideVec3<W> spin = {v[4], v[5], v[6]}, turn = multiply(spin, h);
  way = multiply(add(WideVec3<W>{v[0], v[1], v[2]}, cross(spin, r)), h);
  std::int32_t slender[W];
  for (int i = 0; i < W; ++i) slender[i] = bodies.motion[body[i]].slender;
  const F angle = length(turn);
  const auto rolls = WideInt<W>::load(slender) != WideInt<W>::zero();
  const F bend = F::splat(0.5f) * angle * select(rolls, length(cross(turn, r)), angle * length(r));
  turning = surface.of(rotate(conjugate(placed.shape), turn)) + bend;
}

/// How the shapes of B, with these middles, go past A by the velocities of their bodies, seen from A, and what the
/// turns add to that anywhere in them. Long bodies turn fast at their ends only.
template <class D, int W>
CAROM_SIMD_INLINE void sweeps_of_shapes(const std::int32_t (&a)[W], const std::int32_t (&b)[W],
                                        const MovingBodies<D>& bodies, const PlacedShapes<D, W>& placed,
                                        const SurfaceWays<D, W>& surface, const WideVector<D, W>& middle, float dt,
                                        WideVector<D, W>& way, WideFloat<W>& turning) {
  using F = WideFloat<W>;
  constexpr int N = D::dimension;
  float to_middle[N][16], arm[2][N][W];
  store_each(rotate(placed.shape, middle), to_middle);
  for (int i = 0; i < W; ++i)
    for (int k = 0; k < N; ++k) {
      const double at = placed.at[k][i] + double(to_middle[k][i]);
      arm[0][k][i] = float(at - bodies.motion[a[i]].center[k]);
      arm[1][k][i] = float(at - bodies.motion[b[i]].center[k]);
    }
  WideVector<D, W> of_a, of_b;
  F turning_a, turning_b;
  sweep_of_side(a, bodies, placed, surface, load_vector(arm[0]), F::splat(dt), of_a, turning_a);
  sweep_of_side(b, bodies, placed, surface, load_vector(arm[1]), F::splat(dt), of_b, turning_b);
  way = subtract(of_b, of_a);
  turning = turning_a + turning_b;
}

template <class D, int W>
KnownApart pair_motions(PairMotions<D>& pairs, int count, const MovingBodies<D>& bodies, float dt) {
  using F = WideFloat<W>;
  using I = WideInt<W>;
  using V = WideVector<D, W>;
  using Record = ContactRecord<D>;
  constexpr int N = D::dimension, columns = N == 2 ? 8 : 12, after = N == 2 ? 4 : 7;  // of `base`
  static_assert(
      offsetof(Record, extent) == offsetof(Record, base) + 4 * after &&
      offsetof(Record, inner) == offsetof(Record, extent) + 4 && offsetof(Record, gap) == offsetof(Record, inner) + 4 &&
      sizeof(Record) >= offsetof(Record, base) + 4 * columns && sizeof(Record) >= offsetof(Record, axis) + 16);
  const float *row[W], *axis_row[W], *sweep_a[W], *sweep_b[W], *between[W];
  const typename D::Transform *local_a[W], *local_b[W];
  std::int32_t a[W], b[W], flags[W], manifold[W], at_origin = contact_at_origin;
  for (int i = 0; i < W; ++i) {
    const int lane = i < count ? i : 0;
    const Record& c = *pairs.contact[lane];
    a[i] = c.body[0], b[i] = c.body[1], flags[i] = c.flags, manifold[i] = c.first_manifold;
    at_origin &= c.flags;
    row[i] = reinterpret_cast<const float*>(&c.base);
    axis_row[i] = reinterpret_cast<const float*>(&c.axis);
    sweep_a[i] = reinterpret_cast<const float*>(bodies.sweeps + a[i]);
    sweep_b[i] = reinterpret_cast<const float*>(bodies.sweeps + b[i]);
    local_a[i] = pairs.local[0][lane], local_b[i] = pairs.local[1][lane];
  }
  const bool placed_in_body = at_origin == 0;
  const PlacedShapes<D, W> placed_a(bodies.poses, a, local_a, placed_in_body),
      placed_b(bodies.poses, b, local_b, placed_in_body);
  alignas(16) float apart[W][4];
  for (int i = 0; i < W; ++i) {
    for (int k = 0; k < N; ++k) apart[i][k] = float(placed_b.at[k][i] - placed_a.at[k][i]);
    between[i] = apart[i];
  }
  F known[columns], axes[4], d[4], sa[4], sb[4];
  gather_rows<columns, W>(row, known);
  gather_rows<4, W>(axis_row, axes);
  gather_rows<4, W>(between, d);
  gather_rows<4, W>(sweep_a, sa);
  gather_rows<4, W>(sweep_b, sb);
  const F zero = F::zero();
  const I flag = I::load(flags);
  const auto has = [&](int bit) __attribute__((always_inline)) { return (flag & I::splat(bit)) != I::zero(); };
  const auto met = I::load(manifold) > I::splat(-1);
  const WideTurn<D, W> base = turn_in<D, W>(known, N), back = conjugate(placed_a.shape);
  const WideTurn<D, W> now = multiply(back, placed_b.shape);
  const V place = rotate(back, vector_in<D, W>(d, 0));
  V middle;
  if constexpr (N == 2)
    middle = {F::load(pairs.middle[0]), F::load(pairs.middle[1])};
  else
    middle = {F::load(pairs.middle[0]), F::load(pairs.middle[1]), F::load(pairs.middle[2])};
  const F inner = known[after + 1], gap = known[after + 2];
  const SurfaceWays<D, W> surface(pairs, known[after]);

  const V way = subtract(add(rotate(now, middle), place), add(rotate(base, middle), vector_in<D, W>(known, 0)));
  const auto half = surface.half_turn(base, now);
  const F half_way = surface.of(half), turn = F::splat(2) * half_way, most = length(way) + turn;
  surface.of_more(half, half_way, pairs);
  std::int32_t number[W];
  for (int i = 0; i < W; ++i) number[i] = i;
  if constexpr (N == 2) {
    const F rows[4] = {place.x, place.y, now.c, now.s};
    scatter_rows<4, 4, W>(&pairs.b_in_a[0][0], number, rows);
  } else {
    const F rows[8] = {place.x, place.y, place.z, now.w, now.x, now.y, now.z, zero};
    scatter_rows<8, 8, W>(&pairs.b_in_a[0][0], number, rows);
  }
  store_each(way, pairs.way);
  turn.store(pairs.turn);

  // Ahead by all of the way, and by what of it is along the axis.
  const V axis = vector_in<D, W>(axes, 0);
  const V normal = rotate(placed_a.body, placed_in_body ? rotate(placed_a.local, axis) : axis);
  const auto anyhow = dot(axis, axis) == zero;
  V closing = subtract(vector_in<D, W>(sb, 0), vector_in<D, W>(sa, 0));
  F turning = min(sa[N] + sb[N], F::splat(most_turning * dt));
  F all = length(closing) + turning, along = max(turning - dot(normal, closing), zero);
  const auto turns = turning > F::splat(far_turn) * inner;
  if (any(turns)) {
    // What has a manifold of the plane is told by its bodies alone that more may be near: it is asked how near its
    // points are anyway.
    const auto asks = N == 2 ? turns & !met : turns;
    sweeps_of_shapes<D, W>(a, b, bodies, placed_b, surface, middle, dt, closing, turning);
    store_each(closing, pairs.sweep_way);
    turning.store(pairs.sweep_turn);
    all = select(asks, min(all, length(closing) + turning), all);
    along = select(asks, min(along, max(turning - dot(normal, closing), zero)), along);
  }
  const auto bouncy = has(contact_bouncy);
  const F cap = F::splat(0.5f) * inner;
  all = select(bouncy, all, min(all, cap));
  along = select(bouncy, along, min(along, cap));
  all.store(pairs.ahead);

  const F margin = clamp(F::splat(0.25f) * inner, F::splat(0.001f), F::splat(0.02f)), slack = gap - margin;
  const F left = dot(axis, way);
  const auto was_apart = has(contact_known) & !met, slid = most >= F::splat(longest_slide<D>) * inner;
  const auto slides = was_apart & (!anyhow) & slid & (along < gap + left - turn - margin);
  const auto stays =
      was_apart & ((anyhow & (all < slack - most)) | ((!anyhow) & (!slid) & (along < slack + left - turn)));
  return {bitmask(stays), bitmask(slides)};
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
