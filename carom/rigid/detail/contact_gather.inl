// From the records of contacts and bodies to lanes, what both dimensions have in common: part of contact_kernel.inl.
// Records are rows of four floats, which are transposed as many at a time as there are lanes.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

/// Where the records of a lane are. Pointers of one kind side by side would tempt gcc to compute them in vectors.
struct LaneRecords {
  const char *manifold, *contact, *motion_a, *motion_b, *pose_a, *pose_b;
};

/// Columns of the floats at `Offset` bytes from the begin of W records.
template <const char* LaneRecords::* Record, int Offset, int Columns, int W>
CAROM_SIMD_INLINE void gather_from(const LaneRecords (&lanes)[W], WideFloat<W> (&columns)[Columns]) {
  const float* rows[W];
  simd_detail::unrolled<W>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    rows[i] = reinterpret_cast<const float*>(lanes[i].*Record + Offset);
  });
  gather_rows<Columns, W>(rows, columns);
}

/// What is asked of the records one by one. Lanes beyond `lanes` are like the first, but move nobody.
template <class D, int W>
struct GatheredRecords {
  LaneRecords lane[W];
  std::int32_t flags[W], anchor[W];
  std::uint32_t waits = 0, rolls = 0;  // bits by lane
  float share_a[W], share_b[W];
  alignas(16) float offset[W][4];  // from B's centre to A's

  CAROM_SIMD_INLINE GatheredRecords(const ContactSources<D>& from, const std::int32_t* list, int lanes,
                                    ContactBlock<D, W>& c) {
    for (int i = 0; i < W; ++i) {
      const ManifoldRecord<D>& m = from.manifolds[list[i < lanes ? i : 0]];
      const ContactRecord<D>& k = from.contacts[m.contact];
      const std::int32_t a = k.body[0], b = k.body[1];
      const BodyMotion<D>&ma = from.motion[a], &mb = from.motion[b];
      lane[i].manifold = reinterpret_cast<const char*>(&m);
      lane[i].contact = reinterpret_cast<const char*>(&k);
      lane[i].motion_a = reinterpret_cast<const char*>(&ma);
      lane[i].motion_b = reinterpret_cast<const char*>(&mb);
      lane[i].pose_a = reinterpret_cast<const char*>(from.pose + a);
      lane[i].pose_b = reinterpret_cast<const char*>(from.pose + b);
      share_a[i] = from.load_shares[ma.load_level];
      share_b[i] = from.load_shares[mb.load_level];
      for (int axis = 0; axis < D::dimension; ++axis) offset[i][axis] = float(ma.center[axis] - mb.center[axis]);
      flags[i] = k.flags;
      anchor[i] = std::int32_t(m.anchor);
      waits |= std::uint32_t(m.waits) << i;
      rolls |= std::uint32_t(k.rolls && (k.flags & contact_many) == 0) << i;
      const bool both = (k.flags & contact_dynamic) != 0;
      c.body_a[i] = i < lanes && (both || from.record[a].type == BodyType::dynamic) ? a : ~a;
      c.body_b[i] = i < lanes && (both || from.record[b].type == BodyType::dynamic) ? b : ~b;
    }
    rolls &= (1u << lanes) - 1;
  }
  CAROM_SIMD_INLINE WideMask<W> has(int flag) const {
    return (WideInt<W>::load(flags) & WideInt<W>::splat(flag)) != WideInt<W>::zero();
  }
  /// Where the bodies of the contacts are, and what a step starts without.
  CAROM_SIMD_INLINE GatheredLanes begin(ContactBlock<D, W>& c, ContactRaw<D, W>& raw) const {
    using F = WideFloat<W>;
    using I = WideInt<W>;
    const float* rows[W];
    for (int i = 0; i < W; ++i) rows[i] = offset[i];
    F between[4];
    gather_rows<4, W>(rows, between);
    for (int axis = 0; axis < D::dimension; ++axis) between[axis].store(c.center_offset[axis]);
    (F::splat(1) - min(F::load(share_a), F::load(share_b))).store(raw.squeezed);
    keep(has(contact_recycled), F::splat(1)).store(raw.recycled);
    F::zero().store(c.settles);
    F::zero().store(c.struck);
    I::zero().store(c.again);
    GatheredLanes result;
    const I anchored = I::load(anchor);
    result.placed = bitmask(!has(contact_at_origin));
    result.anchored = bitmask(anchored != I::splat(int(Anchor::none)));
    result.open = waits | bitmask(anchored == I::splat(int(Anchor::settles)));
    return result;
  }
};

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
