// From the records of contacts and bodies to lanes and back, in the plane: part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

struct ManifoldRows2 {  // what a row starts with
  using Record = ManifoldRecord<Dim2>;
  static constexpr int friction = offsetof(Record, friction), points = offsetof(Record, manifold.points),
                       impulses = offsetof(Record, impulses), anchors = offsetof(Record, anchor_a),
                       rolling = offsetof(Record, impulses.rolling);
  static_assert(offsetof(Record, tangent_speed) == friction + 12 && offsetof(Record, manifold) == friction + 16 &&
                offsetof(Record, manifold.count) == friction + 24 && sizeof(geometry::ManifoldPoint2) == 16 &&
                offsetof(Record, impulses.total) == impulses + 8 &&
                offsetof(Record, impulses.friction) == impulses + 16 &&
                offsetof(Record, impulses.friction_total) == impulses + 24 &&
                offsetof(Record, anchor_b) == anchors + 8);
};
struct BodyRows2 {
  using Motion = BodyMotion<Dim2>;
  static constexpr int center = offsetof(Motion, local_center), force = offsetof(Motion, force),
                       gravity_scale = offsetof(Motion, gravity_scale), rotation = offsetof(Dim2::Pose, rotation);
  static_assert(offsetof(Motion, inverse_mass) == center + 8 &&
                offsetof(Motion, world_inverse_inertia) == center + 12 && rotation >= 8);
};

/// One side of W contacts: its bodies' centres in their frames, masses and rotations.
template <const char* LaneRecords::* Motion, const char* LaneRecords::* Pose, int W>
CAROM_SIMD_INLINE void gather_side2(const LaneRecords (&lanes)[W], const float (&share)[W], float (&rotation)[2][W],
                                    typename ContactRaw<Dim2, W>::Placed& shape, float (&inverse_mass)[W],
                                    float (&inverse_inertia)[W]) {
  using F = WideFloat<W>;
  F body[4], turn[4];
  gather_from<Motion, BodyRows2::center>(lanes, body);
  gather_from<Pose, BodyRows2::rotation - 8>(lanes, turn);
  turn[2].store(rotation[0]);
  turn[3].store(rotation[1]);
  (F::zero() - body[0]).store(shape.p[0]);
  (F::zero() - body[1]).store(shape.p[1]);
  F::splat(1).store(shape.q[0]);
  F::zero().store(shape.q[1]);
  const F s = F::load(share);
  (body[2] * s).store(inverse_mass);
  (body[3] * s).store(inverse_inertia);
}

template <int W>
CAROM_SIMD_INLINE std::uint32_t gather_points2(const ContactSources<Dim2>& from, const LaneRecords (&lanes)[W],
                                               ContactBlock<Dim2, W>& c, ContactRaw<Dim2, W>& raw,
                                               const std::int32_t (&anchor)[W], WideMask<W> round) {
  using F = WideFloat<W>;
  const F zero = F::zero(), one = F::splat(1);
  F head[8], points[8], impulses[8], anchors[4];
  gather_from<&LaneRecords::manifold, ManifoldRows2::friction>(lanes, head);
  gather_from<&LaneRecords::manifold, ManifoldRows2::points>(lanes, points);
  gather_from<&LaneRecords::manifold, ManifoldRows2::impulses>(lanes, impulses);
  gather_from<&LaneRecords::manifold, ManifoldRows2::anchors>(lanes, anchors);
  head[0].store(c.friction);
  head[3].store(raw.tangent_speed);
  head[4].store(c.normal[0]);
  head[5].store(c.normal[1]);
  const WideInt<W> count = bits(head[6]);
  F deepest = zero;
  for (int i = 0; i < 2; ++i) {
    auto& point = c.point[i];
    const auto exists = count > WideInt<W>::splat(i);
    const F separation = keep(exists, points[4 * i + 2]), impulse = impulses[i];
    deepest = min(deepest, separation);
    keep(exists, points[4 * i]).store(point.r_a[0]);
    keep(exists, points[4 * i + 1]).store(point.r_a[1]);
    separation.store(point.separation);
    keep(exists, one).store(point.normal_mass);
    // An impulse on its way to nothing is nothing: no denormals, no division by them.
    keep(exists & (impulse > F::splat(1e-12f)), impulse).store(point.impulse);
    zero.store(point.total);
  }
  impulses[4].store(raw.friction_impulse[0]);
  impulses[5].store(raw.friction_impulse[1]);
  for (int i = 0; i < 2; ++i) {
    anchors[i].store(raw.anchor_a[i]);
    anchors[2 + i].store(raw.anchor_b[i]);
  }
  const auto slides = round | (head[3] != zero);
  select(slides, zero, one + to_float(WideInt<W>::load(anchor))).store(raw.anchor_state);
  return bitmask(deepest * WideSoftness<W>(from.softness, c).bias_rate < F::splat(-from.push_speed));
}

/// Which of those that roll touch in one point, carry a load and have bodies that move past each other by as much as it
/// takes (turns_in_step). What lies on two points has no rim to roll on.
template <int W>
CAROM_SIMD_INLINE std::uint32_t turning2(const ContactSources<Dim2>& from, const LaneRecords (&lanes)[W],
                                         const ContactBlock<Dim2, W>& c) {
  using F = WideFloat<W>;
  F extent[4], va[4], vb[4];  // of the first: extent, inner
  gather_from<&LaneRecords::contact, int(offsetof(ContactRecord<Dim2>, extent))>(lanes, extent);
  gather<W>(from.bodies, Slots<W>(c.body_a).of, 0, va);
  gather<W>(from.bodies, Slots<W>(c.body_b).of, 0, vb);
  const WideVec2<W> offset = load2<W>(c.center_offset);  // from B's centre to A's
  const WideVec2<W> seen = {vb[0] - va[0] - va[2] * offset.y, vb[1] - va[1] + va[2] * offset.x};
  const F turned = (vb[2] - va[2]) * extent[0], half = F::splat(from.half_step);
  const F moved = half * half * (dot(seen, seen) + turned * turned);
  const F least = max(F::splat(least_middle_way) * extent[1], F::splat(0.5f * from.still_way));
  const F most = F::splat(most_middle_way) * extent[0];
  const F zero = F::zero();
  const auto rests = (F::load(c.point[0].impulse) > zero) & (F::load(c.point[1].normal_mass) == zero);
  return bitmask(rests & (moved > least * least) & (moved < most * most));
}

template <int W>
GatheredLanes gather2(const ContactSources<Dim2>& from, const std::int32_t* list, int lanes, void* block, void* out) {
  using F = WideFloat<W>;
  ContactBlock<Dim2, W>& c = *static_cast<ContactBlock<Dim2, W>*>(block);
  ContactRaw<Dim2, W>& raw = *static_cast<ContactRaw<Dim2, W>*>(out);
  const GatheredRecords<Dim2, W> records(from, list, lanes, c);
  const LaneRecords(&lane)[W] = records.lane;
  gather_side2<&LaneRecords::motion_a, &LaneRecords::pose_a>(lane, records.share_a, raw.rotation_a, raw.shape_a,
                                                             c.inverse_mass_a, c.inverse_inertia_a);
  gather_side2<&LaneRecords::motion_b, &LaneRecords::pose_b>(lane, records.share_b, raw.rotation_b, raw.shape_b,
                                                             c.inverse_mass_b, c.inverse_inertia_b);
  F base[4];
  gather_from<&LaneRecords::contact, int(offsetof(ContactRecord<Dim2>, base))>(lane, base);
  for (int i = 0; i < 2; ++i) {
    base[i].store(raw.base.p[i]);
    base[2 + i].store(raw.base.q[i]);
  }
  F::zero().store(c.tangent_total);
  GatheredLanes result = records.begin(c, raw);
  result.pushed = gather_points2<W>(from, lane, c, raw, records.anchor, records.has(contact_round));
  // Without gravity nothing rocks, and arms of the step's start are those of most blows.
  if (records.rolls != 0 && from.still_way > 0) result.turns = records.rolls & turning2<W>(from, lane, c);
  return result;
}

/// m/s², of bodies without a clock of their own.
template <int W>
CAROM_SIMD_INLINE WideVec2<W> acceleration2(const ContactSources<Dim2>& from, const std::int32_t (&body)[W]) {
  using F = WideFloat<W>;
  LaneRecords lane[W];
  for (int i = 0; i < W; ++i) lane[i].motion_a = reinterpret_cast<const char*>(from.motion + slot_of(body[i]));
  F center[4], force[4], scale[4];
  gather_from<&LaneRecords::motion_a, BodyRows2::center>(lane, center);
  gather_from<&LaneRecords::motion_a, BodyRows2::force>(lane, force);
  gather_from<&LaneRecords::motion_a, BodyRows2::gravity_scale>(lane, scale);
  const auto moves = WideInt<W>::load(body) > WideInt<W>::splat(-1);
  return {keep(moves, F::splat(from.gravity.x) * scale[0] + force[0] * center[2]),
          keep(moves, F::splat(from.gravity.y) * scale[0] + force[1] * center[2])};
}

/// m/s, of B's point against A's, by the rows of the velocities of their bodies.
template <int W>
CAROM_SIMD_INLINE WideVec2<W> velocity_between(const WideFloat<W> (&va)[4], const WideFloat<W> (&vb)[4],
                                               const WideVec2<W>& ra, const WideVec2<W>& rb) {
  return {vb[0] - vb[2] * rb.y - va[0] + va[2] * ra.y, vb[1] + vb[2] * rb.x - va[1] - va[2] * ra.x};
}

template <int W>
std::uint32_t approach2(const ContactSources<Dim2>& from, const std::int32_t* list, int lanes, const void* block,
                        void* extra) {
  using F = WideFloat<W>;
  const ContactBlock<Dim2, W>& c = *static_cast<const ContactBlock<Dim2, W>*>(block);
  ContactExtra<Dim2, W>& e = *static_cast<ContactExtra<Dim2, W>*>(extra);
  const F zero = F::zero(), one = F::splat(1);
  LaneRecords lane[W];
  for (int i = 0; i < W; ++i)
    lane[i].manifold = reinterpret_cast<const char*>(from.manifolds + list[i < lanes ? i : 0]);
  F head[8], old[4];
  gather_from<&LaneRecords::manifold, ManifoldRows2::friction>(lane, head);
  gather_from<&LaneRecords::manifold, ManifoldRows2::rolling - 8>(lane, old);
  const auto rolls = head[2] > zero, bouncy = head[1] > zero;
  head[2].store(e.rolling_lever);
  inverse_or_zero(keep(rolls, one), F::load(c.inverse_inertia_a) + F::load(c.inverse_inertia_b)).store(e.rolling_mass);
  keep(rolls, old[2]).store(e.rolling_impulse[0]);
  WideInt<W>::zero().store(e.struck);
  zero.store(e.closing_acceleration);
  for (auto& speed : e.bounce_speed) zero.store(speed);
  if (!any(bouncy)) return 0;

  const WideVec2<W> n = load2<W>(c.normal), offset = load2<W>(c.center_offset);
  const WideVec2<W> acceleration = subtract(acceleration2<W>(from, c.body_a), acceleration2<W>(from, c.body_b));
  const F closing = keep(bouncy, max(dot(n, acceleration), zero));
  closing.store(e.closing_acceleration);
  F va[4], vb[4];
  gather<W>(from.bodies, Slots<W>(c.body_a).of, 0, va);
  gather<W>(from.bodies, Slots<W>(c.body_b).of, 0, vb);
  WideMask<W> bounces = WideMask<W>::none();
  for (int i = 0; i < 2; ++i) {
    const WideVec2<W> ra = load2<W>(c.point[i].r_a), rb = add(ra, offset);
    const F vn = dot(n, velocity_between<W>(va, vb, ra, rb));
    // The speed at the surface: v² + 2 a s, because the body still falls through the gap.
    const F impact = sqrt(vn * vn + F::splat(2) * closing * max(F::load(c.point[i].separation), zero));
    const auto strikes =
        bouncy & (bits(head[6]) > WideInt<W>::splat(i)) & (vn < zero) & (impact > F::splat(from.restitution_threshold));
    keep(strikes, head[1] * impact).store(e.bounce_speed[i]);
    bounces = bounces | strikes;
  }
  return bitmask(bounces);
}

template <int W>
std::uint32_t closing2(const ContactSources<Dim2>& from, int lanes, const void* block, float least) {
  using F = WideFloat<W>;
  const ContactBlock<Dim2, W>& c = *static_cast<const ContactBlock<Dim2, W>*>(block);
  const WideVec2<W> n = load2<W>(c.normal), offset = load2<W>(c.center_offset);
  F va[4], vb[4];
  gather<W>(from.bodies, Slots<W>(c.body_a).of, 0, va);
  gather<W>(from.bodies, Slots<W>(c.body_b).of, 0, vb);
  WideMask<W> fast = WideMask<W>::none();
  for (int i = 0; i < 2; ++i) {
    const WideVec2<W> ra = load2<W>(c.point[i].r_a), rb = add(ra, offset);
    const F vn = dot(n, velocity_between<W>(va, vb, ra, rb));
    fast = fast | ((F::load(c.point[i].normal_mass) > F::zero()) & (F::zero() - vn >= F::splat(least)));
  }
  return bitmask(fast) & ((1u << lanes) - 1);
}

/// Adds the load of each lane to its bodies. Bodies of a colour's contacts differ, and those of the overflow come one
/// by one, so this needs no lock.
template <int W>
CAROM_SIMD_INLINE void store_load2(const ContactSources<Dim2>& to, const ContactBlock<Dim2, W>& c, WideFloat<W> load) {
  using F = WideFloat<W>;
  const F zero = F::zero();
  const auto loaded = load > zero;
  if (!any(loaded)) return;
  const WideVec2<W> n = load2<W>(c.normal);
  const WideVec2<W> p = {keep(loaded, n.x * load), keep(loaded, n.y * load)};
  F va[4], vb[4], a[4], b[4];
  const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
  gather<W>(to.bodies, slots_a.of, 0, va);
  gather<W>(to.bodies, slots_b.of, 0, vb);
  // What is being squashed closes; what is at rest neither slides nor parts.
  WideVec2<W> slip = {vb[0] - va[0], vb[1] - va[1]};
  const F closing = min(dot(n, slip), zero);
  slip = {slip.x - n.x * closing, slip.y - n.y * closing};
  const auto restless = dot(slip, slip) > F::splat(to.rest_speed_squared);
  const F size = keep(loaded, select(restless, F::splat(to.restless_load), load));
  gather_rows<4, W>(to.loads, slots_a.of, a);
  gather_rows<4, W>(to.loads, slots_b.of, b);
  const F sum_a[4] = {a[0] - p.x, a[1] - p.y, a[2] + size, a[3]},
          sum_b[4] = {b[0] + p.x, b[1] + p.y, b[2] + size, b[3]};
  scatter_rows<4, 4, W>(to.loads, c.body_a, sum_a);
  scatter_rows<4, 4, W>(to.loads, c.body_b, sum_b);
}

template <int W>
std::uint32_t store2(const ContactSources<Dim2>& to, const std::int32_t* list, int lanes, const void* block) {
  using F = WideFloat<W>;
  const ContactBlock<Dim2, W>& c = *static_cast<const ContactBlock<Dim2, W>*>(block);
  std::int32_t index[W];
  for (int i = 0; i < W; ++i) index[i] = i < lanes ? list[i] : none;
  const F impulse = F::load(c.tangent_impulse), total = F::load(c.tangent_total);
  const F load = F::load(c.point[0].impulse) + F::load(c.point[1].impulse);
  const WideVec2<W> n = load2<W>(c.normal), t = {-n.y, n.x};
  const WideVec2<W> friction = {t.x * impulse, t.y * impulse};
  const F rows[8] = {F::load(c.point[0].impulse),
                     F::load(c.point[1].impulse),
                     F::load(c.point[0].total),
                     F::load(c.point[1].total),
                     friction.x,
                     friction.y,
                     t.x * total,
                     t.y * total};
  scatter_rows<int(sizeof(ManifoldRecord<Dim2>) / 4), 8, W>(
      reinterpret_cast<float*>(reinterpret_cast<char*>(to.manifolds) + ManifoldRows2::impulses), index, rows);
  store_load2<W>(to, c, load);
  const F limit = F::splat(0.999f) * F::load(c.friction) * load;
  return bitmask(dot(friction, friction) >= limit * limit);
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
