// From the records of contacts and bodies to lanes, in space: as contact_gather2.inl, part of contact_kernel.inl.

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
  static constexpr int center = offsetof(Motion, local_center), rotation = offsetof(Dim3::Pose, rotation);
  static_assert(offsetof(Motion, inverse_mass) == center + 12 &&
                offsetof(Motion, world_inverse_inertia) == center + 16 && offsetof(Motion, force) == center + 52);
};

/// One side of W contacts: its bodies' centres in their frames, masses and rotations.
template <const char* LaneRecords2::* Motion, const char* LaneRecords2::* Pose, int W>
CAROM_SIMD_INLINE void gather_side3(const LaneRecords2 (&lanes)[W], const float (&share)[W], float (&rotation)[4][W],
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
CAROM_SIMD_INLINE std::uint32_t gather_points3(const ContactSources<Dim3>& from, const LaneRecords2 (&lanes)[W],
                                               ContactBlock<Dim3, W>& c, ContactRaw<Dim3, W>& raw, WideInt<W> anchor,
                                               WideInt<W> flags, WideMask<W>& loaded) {
  using F = WideFloat<W>;
  const F zero = F::zero(), one = F::splat(1);
  F head[8], anchors[12], sliding[4], rolling[4], last[4], points[4][4];
  gather_from<&LaneRecords2::manifold, ManifoldRows3::friction>(lanes, head);
  gather_from<&LaneRecords2::manifold, ManifoldRows3::anchors>(lanes, anchors);  // and the normal impulses
  gather_from<&LaneRecords2::manifold, ManifoldRows3::sliding>(lanes, sliding);
  gather_from<&LaneRecords2::manifold, ManifoldRows3::rolling>(lanes, rolling);
  gather_from<&LaneRecords2::manifold, ManifoldRows3::last>(lanes, last);
  constexpr int points_at = ManifoldRows3::points, size = sizeof(ManifoldRows3::Point);
  gather_from<&LaneRecords2::manifold, points_at>(lanes, points[0]);
  gather_from<&LaneRecords2::manifold, points_at + size>(lanes, points[1]);
  gather_from<&LaneRecords2::manifold, points_at + 2 * size>(lanes, points[2]);
  gather_from<&LaneRecords2::manifold, points_at + 3 * size>(lanes, points[3]);
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
  return bitmask(deepest * F::load(c.bias_rate) < F::splat(-from.push_speed));
}

/// Which of those that roll and carry a load have bodies that move past each other by as much as it takes.
template <int W>
CAROM_SIMD_INLINE std::uint32_t turning3(const ContactSources<Dim3>& from, const LaneRecords2 (&lanes)[W],
                                         const ContactBlock<Dim3, W>& c) {
  using F = WideFloat<W>;
  F extent[4], va[8], vb[8];  // of the first: extent, inner
  gather_from<&LaneRecords2::contact, int(offsetof(ContactRecord<Dim3>, extent))>(lanes, extent);
  gather<W>(from.bodies, c.read_a, 0, va);
  gather<W>(from.bodies, c.read_b, 0, vb);
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
  using I = WideInt<W>;
  ContactBlock<Dim3, W>& c = *static_cast<ContactBlock<Dim3, W>*>(block);
  ContactRaw<Dim3, W>& raw = *static_cast<ContactRaw<Dim3, W>*>(out);
  LaneRecords2 lane[W];
  std::int32_t flags[W], anchor[W];
  std::uint32_t rolls = 0;
  float share_a[W], share_b[W];
  alignas(16) float offset[W][4];
  for (int i = 0; i < W; ++i) {
    const ManifoldRecord<Dim3>& m = from.manifolds[list[i < lanes ? i : 0]];
    const ContactRecord<Dim3>& k = from.contacts[m.contact];
    const std::int32_t a = k.body[0], b = k.body[1];
    const BodyMotion<Dim3>&ma = from.motion[a], &mb = from.motion[b];
    lane[i].manifold = reinterpret_cast<const char*>(&m);
    lane[i].contact = reinterpret_cast<const char*>(&k);
    lane[i].motion_a = reinterpret_cast<const char*>(&ma);
    lane[i].motion_b = reinterpret_cast<const char*>(&mb);
    lane[i].pose_a = reinterpret_cast<const char*>(from.pose + a);
    lane[i].pose_b = reinterpret_cast<const char*>(from.pose + b);
    share_a[i] = from.load_shares[ma.load_level];
    share_b[i] = from.load_shares[mb.load_level];
    offset[i][0] = float(ma.center.x - mb.center.x);
    offset[i][1] = float(ma.center.y - mb.center.y);
    offset[i][2] = float(ma.center.z - mb.center.z);
    flags[i] = k.flags;
    anchor[i] = std::int32_t(m.anchor);
    rolls |= std::uint32_t(k.rolls && (k.flags & contact_many) == 0) << i;
    const bool both = (k.flags & contact_dynamic) != 0;
    c.read_a[i] = a;
    c.read_b[i] = b;
    c.write_a[i] = i < lanes && (both || from.record[a].type == BodyType::dynamic) ? a : none;
    c.write_b[i] = i < lanes && (both || from.record[b].type == BodyType::dynamic) ? b : none;
  }
  gather_side3<&LaneRecords2::motion_a, &LaneRecords2::pose_a>(lane, share_a, raw.rotation_a, raw.shape_a,
                                                               c.inverse_mass_a, c.inverse_inertia_a);
  gather_side3<&LaneRecords2::motion_b, &LaneRecords2::pose_b>(lane, share_b, raw.rotation_b, raw.shape_b,
                                                               c.inverse_mass_b, c.inverse_inertia_b);
  (F::splat(1) - min(F::load(share_a), F::load(share_b))).store(raw.squeezed);
  F base[8];
  gather_from<&LaneRecords2::contact, int(offsetof(ContactRecord<Dim3>, base))>(lane, base);
  for (int i = 0; i < 3; ++i) base[i].store(raw.base.p[i]);
  for (int i = 0; i < 4; ++i) base[3 + i].store(raw.base.q[i]);
  const float* rows[W];
  for (int i = 0; i < W; ++i) rows[i] = offset[i];
  F between[4];
  gather_rows<4, W>(rows, between);
  for (int i = 0; i < 3; ++i) between[i].store(c.center_offset[i]);
  const I flag = I::load(flags);
  const auto has = [&](int bit) __attribute__((always_inline)) { return (flag & I::splat(bit)) != I::zero(); };
  keep(has(contact_recycled), F::splat(1)).store(raw.recycled);
  const auto firm = (I::load(c.write_a) < I::zero()) | (I::load(c.write_b) < I::zero());
  const Softness &soft = from.contact_softness, &hard = from.fixed_contact_softness;
  select(firm, F::splat(hard.bias_rate), F::splat(soft.bias_rate)).store(c.bias_rate);
  select(firm, F::splat(hard.mass_scale), F::splat(soft.mass_scale)).store(c.mass_scale);
  select(firm, F::splat(hard.impulse_scale), F::splat(soft.impulse_scale)).store(c.impulse_scale);
  F::zero().store(c.tangent_total[0]);
  F::zero().store(c.tangent_total[1]);
  F::zero().store(c.settles);
  F::zero().store(c.struck);
  I::zero().store(c.again);
  GatheredLanes result;
  WideMask<W> loaded;
  result.pushed = gather_points3<W>(from, lane, c, raw, I::load(anchor), flag, loaded);
  result.placed = bitmask(!has(contact_at_origin));
  // Without gravity nothing rocks, and arms of the step's start are those of most blows.
  rolls &= bitmask(loaded) & ((1u << lanes) - 1);
  if (rolls != 0 && from.still_way > 0) result.turns = rolls & turning3<W>(from, lane, c);
  return result;
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
