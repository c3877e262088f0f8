// From the records of contacts and bodies to lanes and back, in space: part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

struct ManifoldRows3 {  // what a row starts with
  using Record = ManifoldRecord<Dim3>;
  using Point = geometry::ManifoldPoint3;
  static constexpr int friction = offsetof(Record, friction), points = offsetof(Record, manifold.points),
                       anchors = offsetof(Record, anchor_a), sliding = offsetof(Record, impulses.friction),
                       rolling = offsetof(Record, impulses.rolling), last = sizeof(Record) - 16;
  static_assert(offsetof(Record, tangent_speed) == friction + 12 && offsetof(Record, manifold) == friction + 16 &&
                offsetof(Record, manifold.count) == friction + 28 && offsetof(Point, separation) == 12 &&
                offsetof(Record, anchor_b) == anchors + 12 && offsetof(Record, impulses) == anchors + 24 &&
                offsetof(Record, impulses.twist) == rolling + 12 && offsetof(Record, spinning_lever) == last + 12);
};
struct BodyRows3 {
  using Motion = BodyMotion<Dim3>;
  static constexpr int center = offsetof(Motion, local_center), gravity_scale = offsetof(Motion, gravity_scale),
                       rotation = offsetof(Dim3::Pose, rotation);
  static_assert(offsetof(Motion, inverse_mass) == center + 12 &&
                offsetof(Motion, world_inverse_inertia) == center + 16 && offsetof(Motion, force) == center + 52);
};

/// One side of W contacts: its bodies' centres in their frames, masses and rotations.
template <const char* LaneRecords::* Motion, const char* LaneRecords::* Pose, int W>
CAROM_SIMD_INLINE void gather_side3(const LaneRecords (&lanes)[W], const float (&share)[W], float (&rotation)[4][W],
                                    typename ContactRaw<Dim3, W>::Placed& shape, float (&inverse_mass)[W],
                                    float (&inverse_inertia)[6][W]) {
  using F = WideFloat<W>;
  F body[16], turn[4];
  gather_from<Motion, BodyRows3::center>(lanes, body);
  gather_from<Pose, BodyRows3::rotation>(lanes, turn);
  for (int i = 0; i < 4; ++i) {
    turn[i].store(rotation[i]);
    F::splat(i == 0 ? 1 : 0).store(shape.q[i]);
  }
  for (int i = 0; i < 3; ++i) (F::zero() - body[i]).store(shape.p[i]);
  const F s = F::load(share);
  (body[3] * s).store(inverse_mass);
  const int places[6] = {4, 8, 12, 7, 10, 11};  // of xx, yy, zz, xy, xz, yz
  for (int i = 0; i < 6; ++i) (body[places[i]] * s).store(inverse_inertia[i]);
}

/// Returns which of them are so deep that they are pushed out with the push speed. `loaded`: those that bear a load.
template <int W>
CAROM_SIMD_INLINE std::uint32_t gather_points3(const ContactSources<Dim3>& from, const LaneRecords (&lanes)[W],
                                               ContactBlock<Dim3, W>& c, ContactRaw<Dim3, W>& raw, WideInt<W> anchor,
                                               WideInt<W> flags, WideMask<W>& loaded) {
  using F = WideFloat<W>;
  const F zero = F::zero(), one = F::splat(1);
  F head[8], anchors[12], sliding[4], rolling[4], last[4], points[4][4];
  gather_from<&LaneRecords::manifold, ManifoldRows3::friction>(lanes, head);
  gather_from<&LaneRecords::manifold, ManifoldRows3::anchors>(lanes, anchors);  // and the normal impulses
  gather_from<&LaneRecords::manifold, ManifoldRows3::sliding>(lanes, sliding);
  gather_from<&LaneRecords::manifold, ManifoldRows3::rolling>(lanes, rolling);
  gather_from<&LaneRecords::manifold, ManifoldRows3::last>(lanes, last);
  constexpr int points_at = ManifoldRows3::points, size = sizeof(ManifoldRows3::Point);
  gather_from<&LaneRecords::manifold, points_at>(lanes, points[0]);
  gather_from<&LaneRecords::manifold, points_at + size>(lanes, points[1]);
  gather_from<&LaneRecords::manifold, points_at + 2 * size>(lanes, points[2]);
  gather_from<&LaneRecords::manifold, points_at + 3 * size>(lanes, points[3]);
  const WideInt<W> count = bits(head[7]);
  F deepest = zero;
  loaded = WideMask<W>::none();
  for (int i = 0; i < 4; ++i) {
    auto& point = c.point[i];
    const auto exists = count > WideInt<W>::splat(i);
    const F separation = keep(exists, points[i][3]), impulse = anchors[6 + i];
    deepest = min(deepest, separation);
    loaded = loaded | (exists & (impulse > zero));
    for (int k = 0; k < 3; ++k) keep(exists, points[i][k]).store(point.r_a[k]);
    separation.store(point.separation);
    keep(exists, one).store(point.normal_mass);
    // An impulse on its way to nothing is nothing: no denormals, no division by them.
    keep(exists & (impulse > F::splat(1e-12f)), impulse).store(point.impulse);
    zero.store(point.total);
  }
  for (int k = 0; k < 3; ++k) {
    head[4 + k].store(c.normal[k]);
    anchors[k].store(raw.anchor_a[k]);
    anchors[3 + k].store(raw.anchor_b[k]);
    sliding[k].store(raw.friction_impulse[k]);
  }
  rolling[3].store(c.twist_impulse);
  const F friction = head[0], rolling_lever = head[2], tangent_speed = head[3], spinning_lever = last[3];
  friction.store(c.friction);
  tangent_speed.store(raw.tangent_speed);
  const auto has = [&](int bit) __attribute__((always_inline)) {
    return (flags & WideInt<W>::splat(bit)) != WideInt<W>::zero();
  };
  const auto slides = has(contact_round) | (tangent_speed != zero);
  select(slides, zero, one + to_float(anchor)).store(raw.anchor_state);
  // Radius of the patch for the twist over the mean distance of its points, under uniform pressure: a disc turns on 2/3
  // of its radius, rectangles from square to thin line on .54 … .5 of the distance of their corners.
  select(has(contact_on_disc), F::splat(2.0f / 3.0f), F::splat(0.53f)).store(raw.patch_factor);
  // What a single point's disc turns on (prepare_friction3), unless a resistance holds against spin. Of spinning
  // resistance what rolling resistance does not do already.
  select((rolling_lever > zero) | (spinning_lever > zero), zero, F::splat(0.589f)).store(raw.point_factor);
  const F spinning = spinning_lever - rolling_lever;
  const auto rubs = friction > zero;
  keep((spinning > zero) & rubs, spinning / select(rubs, friction, one)).store(raw.spin_radius);
  return bitmask(deepest * WideSoftness<W>(from.softness, c).bias_rate < F::splat(-from.push_speed));
}

/// Which of those that roll and carry a load have bodies that move past each other by as much as it takes.
template <int W>
CAROM_SIMD_INLINE std::uint32_t turning3(const ContactSources<Dim3>& from, const LaneRecords (&lanes)[W],
                                         const ContactBlock<Dim3, W>& c) {
  using F = WideFloat<W>;
  F extent[4], va[8], vb[8];  // of the first: extent, inner
  gather_from<&LaneRecords::contact, int(offsetof(ContactRecord<Dim3>, extent))>(lanes, extent);
  gather<W>(from.bodies, Slots<W>(c.body_a).of, 0, va);
  gather<W>(from.bodies, Slots<W>(c.body_b).of, 0, vb);
  const WideVec3<W> between = multiply(load3<W>(c.center_offset), F::splat(-1));
  const WideVec3<W> wa = {va[4], va[5], va[6]}, wb = {vb[4], vb[5], vb[6]};
  const WideVec3<W> relative = {vb[0] - va[0], vb[1] - va[1], vb[2] - va[2]};
  const WideVec3<W> seen = subtract(relative, cross(wa, between)), spin = subtract(wb, wa);
  const F turned = sqrt(dot(spin, spin)) * extent[0], half = F::splat(from.half_step);
  const F moved = half * half * (dot(seen, seen) + turned * turned);
  const F least = max(F::splat(least_middle_way) * extent[1], F::splat(0.5f * from.still_way));
  const F most = F::splat(most_middle_way) * extent[0];
  return bitmask((moved > least * least) & (moved < most * most));
}

template <int W>
GatheredLanes gather3(const ContactSources<Dim3>& from, const std::int32_t* list, int lanes, void* block, void* out) {
  using F = WideFloat<W>;
  ContactBlock<Dim3, W>& c = *static_cast<ContactBlock<Dim3, W>*>(block);
  ContactRaw<Dim3, W>& raw = *static_cast<ContactRaw<Dim3, W>*>(out);
  const GatheredRecords<Dim3, W> records(from, list, lanes, c);
  const LaneRecords(&lane)[W] = records.lane;
  gather_side3<&LaneRecords::motion_a, &LaneRecords::pose_a>(lane, records.share_a, raw.rotation_a, raw.shape_a,
                                                             c.inverse_mass_a, c.inverse_inertia_a);
  gather_side3<&LaneRecords::motion_b, &LaneRecords::pose_b>(lane, records.share_b, raw.rotation_b, raw.shape_b,
                                                             c.inverse_mass_b, c.inverse_inertia_b);
  F base[8];
  gather_from<&LaneRecords::contact, int(offsetof(ContactRecord<Dim3>, base))>(lane, base);
  for (int i = 0; i < 3; ++i) base[i].store(raw.base.p[i]);
  for (int i = 0; i < 4; ++i) base[3 + i].store(raw.base.q[i]);
  for (auto& total : c.tangent_total) F::zero().store(total);
  GatheredLanes result = records.begin(c, raw);
  WideMask<W> loaded;
  result.pushed =
      gather_points3<W>(from, lane, c, raw, WideInt<W>::load(records.anchor), WideInt<W>::load(records.flags), loaded);
  // Without gravity nothing rocks, and arms of the step's start are those of most blows.
  const std::uint32_t rolls = records.rolls & bitmask(loaded);
  if (rolls != 0 && from.still_way > 0) result.turns = rolls & turning3<W>(from, lane, c);
  return result;
}

/// m/s², of bodies without a clock of their own.
template <int W>
CAROM_SIMD_INLINE WideVec3<W> acceleration3(const ContactSources<Dim3>& from, const std::int32_t (&body)[W]) {
  using F = WideFloat<W>;
  LaneRecords lane[W];
  for (int i = 0; i < W; ++i) lane[i].motion_a = reinterpret_cast<const char*>(from.motion + slot_of(body[i]));
  F row[16], scale[4];
  gather_from<&LaneRecords::motion_a, BodyRows3::center>(lane, row);
  gather_from<&LaneRecords::motion_a, BodyRows3::gravity_scale>(lane, scale);
  const auto moves = WideInt<W>::load(body) > WideInt<W>::splat(-1);
  const auto along = [&](float gravity, F force) __attribute__((always_inline)) {
    return keep(moves, F::splat(gravity) * scale[0] + force * row[3]);
  };
  return {along(from.gravity.x, row[13]), along(from.gravity.y, row[14]), along(from.gravity.z, row[15])};
}

/// m/s, of B's point against A's along the normal.
template <int W>
struct Parting3 {
  WideVec3<W> n, offset, va, wa, vb, wb;
  Parting3(const ContactSources<Dim3>& from, const ContactBlock<Dim3, W>& c)
      : n(load3<W>(c.normal)), offset(load3<W>(c.center_offset)) {
    WideFloat<W> a[8], b[8];
    gather<W>(from.bodies, Slots<W>(c.body_a).of, 0, a);
    gather<W>(from.bodies, Slots<W>(c.body_b).of, 0, b);
    va = {a[0], a[1], a[2]}, wa = {a[4], a[5], a[6]};
    vb = {b[0], b[1], b[2]}, wb = {b[4], b[5], b[6]};
  }
  CAROM_SIMD_INLINE WideFloat<W> at(const WideVec3<W>& ra) const {
    return dot(n, subtract(subtract(add(vb, cross(wb, add(ra, offset))), va), cross(wa, ra)));
  }
};

template <int W>
std::uint32_t approach3(const ContactSources<Dim3>& from, const std::int32_t* list, int lanes, const void* block,
                        void* extra) {
  using F = WideFloat<W>;
  const ContactBlock<Dim3, W>& c = *static_cast<const ContactBlock<Dim3, W>*>(block);
  ContactExtra<Dim3, W>& e = *static_cast<ContactExtra<Dim3, W>*>(extra);
  const F zero = F::zero();
  LaneRecords lane[W];
  for (int i = 0; i < W; ++i)
    lane[i].manifold = reinterpret_cast<const char*>(from.manifolds + list[i < lanes ? i : 0]);
  F head[8], old[4];
  gather_from<&LaneRecords::manifold, ManifoldRows3::friction>(lane, head);
  gather_from<&LaneRecords::manifold, ManifoldRows3::rolling>(lane, old);
  const F restitution = head[1], lever = head[2];
  const auto rolls = lever > zero, bouncy = restitution > zero;
  lever.store(e.rolling_lever);
  for (int i = 0; i < 3; ++i) keep(rolls, old[i]).store(e.rolling_impulse[i]);
  WideInt<W>::zero().store(e.struck);
  zero.store(e.closing_acceleration);
  for (auto& speed : e.bounce_speed) zero.store(speed);
  if (!any(bouncy)) return 0;

  const WideVec3<W> acceleration = subtract(acceleration3<W>(from, c.body_a), acceleration3<W>(from, c.body_b));
  const Parting3<W> parting(from, c);
  const F closing = keep(bouncy, max(dot(parting.n, acceleration), zero));
  closing.store(e.closing_acceleration);
  WideMask<W> bounces = WideMask<W>::none();
  for (int i = 0; i < 4; ++i) {
    const F vn = parting.at(load3<W>(c.point[i].r_a));
    // The speed at the surface: v² + 2 a s, because the body still falls through the gap.
    const F impact = sqrt(vn * vn + F::splat(2) * closing * max(F::load(c.point[i].separation), zero));
    const auto strikes =
        bouncy & (bits(head[7]) > WideInt<W>::splat(i)) & (vn < zero) & (impact > F::splat(from.restitution_threshold));
    keep(strikes, restitution * impact).store(e.bounce_speed[i]);
    bounces = bounces | strikes;
  }
  return bitmask(bounces);
}

template <int W>
std::uint32_t closing3(const ContactSources<Dim3>& from, int lanes, const void* block, float least) {
  using F = WideFloat<W>;
  const ContactBlock<Dim3, W>& c = *static_cast<const ContactBlock<Dim3, W>*>(block);
  const Parting3<W> parting(from, c);
  WideMask<W> fast = WideMask<W>::none();
  for (int i = 0; i < 4; ++i) {
    const auto exists = F::load(c.point[i].normal_mass) > F::zero();
    fast = fast | (exists & (parting.at(load3<W>(c.point[i].r_a)) < F::splat(-least)));
  }
  return bitmask(fast) & ((1u << lanes) - 1);
}

/// Adds the load of each lane to its bodies, as store_load2.
template <int W>
CAROM_SIMD_INLINE void store_load3(const ContactSources<Dim3>& to, const ContactBlock<Dim3, W>& c, WideFloat<W> load) {
  using F = WideFloat<W>;
  const F zero = F::zero();
  const auto loaded = load > zero;
  if (!any(loaded)) return;
  const WideVec3<W> n = load3<W>(c.normal);
  const WideVec3<W> p = {keep(loaded, n.x * load), keep(loaded, n.y * load), keep(loaded, n.z * load)};
  F va[4], vb[4], a[4], b[4];
  const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
  gather<W>(to.bodies, slots_a.of, 0, va);
  gather<W>(to.bodies, slots_b.of, 0, vb);
  // What is being squashed closes; what is at rest neither slides nor parts.
  const WideVec3<W> relative = {vb[0] - va[0], vb[1] - va[1], vb[2] - va[2]};
  const WideVec3<W> slip = subtract(relative, multiply(n, min(dot(n, relative), zero)));
  const auto restless = dot(slip, slip) > F::splat(to.rest_speed_squared);
  const F size = keep(loaded, select(restless, F::splat(to.restless_load), load));
  gather_rows<4, W>(to.loads, slots_a.of, a);
  gather_rows<4, W>(to.loads, slots_b.of, b);
  const F sum_a[4] = {a[0] - p.x, a[1] - p.y, a[2] - p.z, a[3] + size},
          sum_b[4] = {b[0] + p.x, b[1] + p.y, b[2] + p.z, b[3] + size};
  scatter_rows<4, 4, W>(to.loads, c.body_a, sum_a);
  scatter_rows<4, 4, W>(to.loads, c.body_b, sum_b);
}

template <int W>
std::uint32_t store3(const ContactSources<Dim3>& to, const std::int32_t* list, int lanes, const void* block) {
  using F = WideFloat<W>;
  using Record = ManifoldRecord<Dim3>;
  const ContactBlock<Dim3, W>& c = *static_cast<const ContactBlock<Dim3, W>*>(block);
  std::int32_t index[W];
  for (int i = 0; i < W; ++i) index[i] = i < lanes ? list[i] : none;
  F load = F::zero(), impulses[8];
  for (int i = 0; i < 4; ++i) {
    impulses[i] = F::load(c.point[i].impulse);
    impulses[4 + i] = F::load(c.point[i].total);
    load += impulses[i];
  }
  const WideVec3<W> n = load3<W>(c.normal), t = load3<W>(c.tangent), u = cross(n, t);
  const auto along = [&](const float(&size)[2][W]) __attribute__((always_inline)) {
    return add(multiply(t, F::load(size[0])), multiply(u, F::load(size[1])));
  };
  const WideVec3<W> friction = along(c.tangent_impulse), total = along(c.tangent_total);
  constexpr int stride = sizeof(Record) / 4, first = offsetof(Record, impulses) / 4,
                sliding = offsetof(Record, impulses.friction) / 4;
  static_assert(offsetof(Record, impulses.total) == 4 * first + 16 &&
                offsetof(Record, impulses.friction_total) == 4 * sliding + 12);
  float* records = reinterpret_cast<float*>(to.manifolds);
  // The six floats of friction are two rows of four that overlap.
  const F both[4] = {friction.x, friction.y, friction.z, total.x}, rest[4] = {friction.z, total.x, total.y, total.z};
  scatter_rows<stride, 8, W>(records + first, index, impulses);
  scatter_rows<stride, 4, W>(records + sliding, index, both);
  scatter_rows<stride, 4, W>(records + sliding + 2, index, rest);
  for (int i = 0; i < lanes; ++i) to.manifolds[list[i]].impulses.twist = c.twist_impulse[i];
  store_load3<W>(to, c, load);
  const F limit = F::splat(0.999f) * F::load(c.friction) * load;
  return bitmask(dot(friction, friction) >= limit * limit);
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
