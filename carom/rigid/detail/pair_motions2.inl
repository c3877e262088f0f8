// How pairs of the plane have moved, as many at a time as there are lanes, and whether what is known of those that are
// apart is still true: as pair_motion.inl and stays() of pair_watch.inl. Part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

/// One side of the pairs: rotations of the bodies and their shapes, and where those stand.
template <int W>
struct PlacedShapes2 {
  WideTurn2<W> body, local, shape;
  alignas(16) double x[W], y[W];

  CAROM_SIMD_INLINE PlacedShapes2(const Dim2::Pose* poses, const std::int32_t (&bodies)[W],
                                  const Transform2f* const (&frames)[W]) {
    const float *turn[W], *in_body[W];
    for (int i = 0; i < W; ++i) {
      turn[i] = reinterpret_cast<const float*>(&poses[bodies[i]].rotation) - 2;
      in_body[i] = reinterpret_cast<const float*>(frames[i]);
    }
    WideFloat<W> q[4], at[4];
    gather_rows<4, W>(turn, q);
    gather_rows<4, W>(in_body, at);
    body = {q[2], q[3]}, local = {at[2], at[3]}, shape = multiply(body, local);
    const WideVec2<W> arm = rotate(body, WideVec2<W>{at[0], at[1]});
    float arm_x[W], arm_y[W];
    arm.x.store(arm_x);
    arm.y.store(arm_y);
    for (int i = 0; i < W; ++i) {
      const Vec2d& position = poses[bodies[i]].position;
      x[i] = position.x + double(arm_x[i]), y[i] = position.y + double(arm_y[i]);
    }
  }
};

/// sweep_of_shape: how the shapes of B, with these middles, go past A by the velocities of their bodies, and what the
/// turns add to that.
template <int W>
CAROM_SIMD_INLINE void sweeps_of_shapes(const std::int32_t (&a)[W], const std::int32_t (&b)[W],
                                        const MovingBodies& bodies, const PlacedShapes2<W>& placed,
                                        const WideVec2<W>& middle, WideFloat<W> extent, float dt, WideVec2<W>& way,
                                        WideFloat<W>& turning) {
  using F = WideFloat<W>;
  float x[W], y[W], arm[2][2][W];
  const WideVec2<W> to_middle = rotate(placed.shape, middle);
  to_middle.x.store(x);
  to_middle.y.store(y);
  for (int i = 0; i < W; ++i) {
    const Vec2d at{placed.x[i] + double(x[i]), placed.y[i] + double(y[i])};
    for (int side = 0; side < 2; ++side) {
      const Vec2d from = at - bodies.motion[side == 0 ? a[i] : b[i]].center;
      arm[side][0][i] = float(from.x), arm[side][1][i] = float(from.y);
    }
  }
  const F h = F::splat(dt);
  way = {F::zero(), F::zero()}, turning = F::zero();
  for (int side = 0; side < 2; ++side) {
    F v[4];
    gather<W>(bodies.velocities, side == 0 ? a : b, 0, v);
    const WideVec2<W> r = {F::load(arm[side][0]), F::load(arm[side][1])};
    const WideVec2<W> own = {(v[0] - v[2] * r.y) * h, (v[1] + v[2] * r.x) * h};
    way = side == 0 ? subtract(way, own) : add(way, own);
    const F turn = v[2] * h;
    turning += abs(turn) * extent + F::splat(0.5f) * turn * turn * length2<W>(r);
  }
}

template <int W>
KnownApart pair_motions2(PairMotions& pairs, int count, const MovingBodies& bodies, float dt) {
  using F = WideFloat<W>;
  using I = WideInt<W>;
  using Record = ContactRecord<Dim2>;
  static_assert(offsetof(Record, extent) == offsetof(Record, base) + 16 &&
                offsetof(Record, gap) == offsetof(Record, base) + 24 && sizeof(Record) >= offsetof(Record, axis) + 16);
  const float *row[W], *axis_row[W], *sweep_a[W], *sweep_b[W], *between[W];
  const Transform2f *local_a[W], *local_b[W];
  std::int32_t a[W], b[W], flags[W], manifold[W];
  for (int i = 0; i < W; ++i) {
    const int lane = i < count ? i : 0;
    const Record& c = *pairs.contact[lane];
    a[i] = c.body[0], b[i] = c.body[1], flags[i] = c.flags, manifold[i] = c.first_manifold;
    row[i] = reinterpret_cast<const float*>(&c.base);
    axis_row[i] = reinterpret_cast<const float*>(&c.axis);
    sweep_a[i] = reinterpret_cast<const float*>(bodies.sweeps + a[i]);
    sweep_b[i] = reinterpret_cast<const float*>(bodies.sweeps + b[i]);
    local_a[i] = pairs.local[0][lane], local_b[i] = pairs.local[1][lane];
  }
  const PlacedShapes2<W> placed_a(bodies.poses, a, local_a), placed_b(bodies.poses, b, local_b);
  alignas(16) float apart[W][4];
  for (int i = 0; i < W; ++i) {
    apart[i][0] = float(placed_b.x[i] - placed_a.x[i]);
    apart[i][1] = float(placed_b.y[i] - placed_a.y[i]);
    between[i] = apart[i];
  }
  F known[8], axes[4], d[4], sa[4], sb[4];
  gather_rows<8, W>(row, known);
  gather_rows<4, W>(axis_row, axes);
  gather_rows<4, W>(between, d);
  gather_rows<4, W>(sweep_a, sa);
  gather_rows<4, W>(sweep_b, sb);
  const F zero = F::zero();
  const I flag = I::load(flags);
  const auto has = [&](int bit) __attribute__((always_inline)) { return (flag & I::splat(bit)) != I::zero(); };
  const auto met = I::load(manifold) > I::splat(-1);
  const WideTurn2<W> base = {known[2], known[3]}, back = conjugate(placed_a.shape);
  const WideTurn2<W> now = multiply(back, placed_b.shape);
  const WideVec2<W> place = rotate(back, WideVec2<W>{d[0], d[1]}),
                    middle = {F::load(pairs.middle[0]), F::load(pairs.middle[1])};
  const F extent = F::load(pairs.extent), inner = known[5], gap = known[6];

  const WideVec2<W> way =
      subtract(add(rotate(now, middle), place), add(rotate(base, middle), WideVec2<W>{known[0], known[1]}));
  const F half = F::splat(0.5f) * length2<W>({now.c - base.c, now.s - base.s});
  const F turn = F::splat(2) * (half * extent), most = length2<W>(way) + turn;
  const F rows[4] = {place.x, place.y, now.c, now.s};
  std::int32_t number[W];
  for (int i = 0; i < W; ++i) number[i] = i;
  scatter_rows<4, 4, W>(&pairs.b_in_a[0][0], number, rows);
  way.x.store(pairs.way[0]);
  way.y.store(pairs.way[1]);
  turn.store(pairs.turn);

  // Ahead by all of the way, and by what of it is along the axis.
  const WideVec2<W> axis = {axes[0], axes[1]}, normal = rotate(placed_a.body, rotate(placed_a.local, axis));
  const auto anyhow = (axis.x == zero) & (axis.y == zero);
  WideVec2<W> closing = {sb[0] - sa[0], sb[1] - sa[1]};
  F turning = min(sa[2] + sb[2], F::splat(most_turning * dt));
  F all = length2<W>(closing) + turning, along = max(turning - dot(normal, closing), zero);
  // What has a manifold is told by its bodies alone that more may be near: it is asked how near its points are anyway.
  const auto asks = (!met) & (turning > F::splat(0.1f) * inner);
  pairs.swept = any(asks);
  if (pairs.swept) {
    sweeps_of_shapes<W>(a, b, bodies, placed_b, middle, extent, dt, closing, turning);
    closing.x.store(pairs.sweep_way[0]);
    closing.y.store(pairs.sweep_way[1]);
    turning.store(pairs.sweep_turn);
    all = select(asks, min(all, length2<W>(closing) + turning), all);
    along = select(asks, min(along, max(turning - dot(normal, closing), zero)), along);
  }
  const auto bouncy = has(contact_bouncy);
  const F cap = F::splat(0.5f) * inner;
  all = select(bouncy, all, min(all, cap));
  along = select(bouncy, along, min(along, cap));
  all.store(pairs.ahead);

  const F margin = clamp(F::splat(0.25f) * inner, F::splat(0.001f), F::splat(0.02f)), slack = gap - margin;
  const F left = dot(axis, way);
  const auto was_apart = has(contact_known) & !met, slid = most >= inner;  // longest_slide
  const auto slides = was_apart & (!anyhow) & slid & (along < gap + left - turn - margin);
  const auto stays =
      was_apart & ((anyhow & (all < slack - most)) | ((!anyhow) & (!slid) & (along < slack + left - turn)));
  return {bitmask(stays), bitmask(slides)};
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
