// From the records of contacts to their blocks, in the plane: part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

template <int W>
struct WideTurn2 {
  WideFloat<W> c, s;
};
template <int W>
CAROM_SIMD_INLINE WideTurn2<W> load_turn(const float (&p)[2][W]) {
  return {WideFloat<W>::load(p[0]), WideFloat<W>::load(p[1])};
}
template <int W>
CAROM_SIMD_INLINE WideTurn2<W> multiply(const WideTurn2<W>& a, const WideTurn2<W>& b) {
  return {a.c * b.c - a.s * b.s, a.s * b.c + a.c * b.s};
}
template <int W>
CAROM_SIMD_INLINE WideTurn2<W> conjugate(const WideTurn2<W>& a) {
  return {a.c, -a.s};
}
template <int W>
CAROM_SIMD_INLINE WideVec2<W> rotate(const WideTurn2<W>& q, const WideVec2<W>& v) {
  return {q.c * v.x - q.s * v.y, q.s * v.x + q.c * v.y};
}
template <int W>
CAROM_SIMD_INLINE WideVec2<W> scale(const WideVec2<W>& a, WideFloat<W> s) {
  return {a.x * s, a.y * s};
}
template <int W>
CAROM_SIMD_INLINE WideVec2<W> select(WideMask<W> m, const WideVec2<W>& a, const WideVec2<W>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y)};
}
template <int W>
CAROM_SIMD_INLINE void store2(const WideVec2<W>& a, float (&p)[2][W]) {
  a.x.store(p[0]);
  a.y.store(p[1]);
}

template <int W>
CAROM_SIMD_INLINE void prepare_points2(ContactBlock<Dim2, W>& c, const ContactRaw<Dim2, W>& raw) {
  using F = WideFloat<W>;
  const F half = F::splat(0.5f), zero = F::splat(0);
  const WideTurn2<W> body_a = load_turn<W>(raw.rotation_a), body_b = load_turn<W>(raw.rotation_b);
  const WideTurn2<W> a = multiply(body_a, load_turn<W>(raw.shape_a.q));
  const WideTurn2<W> b = multiply(body_b, load_turn<W>(raw.shape_b.q));
  const WideVec2<W> to_a = rotate(body_a, load2<W>(raw.shape_a.p)), to_b = rotate(body_b, load2<W>(raw.shape_b.p));
  const WideVec2<W> normal = load2<W>(c.normal), offset = load2<W>(c.center_offset);
  // How B has moved in A's frame since the manifold was made.
  const auto recycled = F::load(raw.recycled) > zero;
  const WideTurn2<W> turned = multiply(multiply(conjugate(a), b), conjugate(load_turn<W>(raw.base.q)));
  const WideVec2<W> moved =
      subtract(rotate(conjugate(a), subtract(subtract(to_b, to_a), offset)), rotate(turned, load2<W>(raw.base.p)));
  for (int i = 0; i < 2; ++i) {
    auto& point = c.point[i];
    const auto exists = F::load(point.normal_mass) > zero;
    const WideVec2<W> p = load2<W>(point.r_a), reach = scale(normal, half * F::load(point.separation));
    const WideVec2<W> on_a = subtract(p, reach), on_b = add(rotate(turned, add(p, reach)), moved);
    const F separation = select(recycled, dot(subtract(on_b, on_a), normal), F::load(point.separation));
    const WideVec2<W> now = select(recycled, scale(add(on_a, on_b), half), p), none = {zero, zero};
    store2(select(exists, add(rotate(a, now), to_a), none), point.r_a);
    select(exists, separation, F::splat(1e3f)).store(point.separation);
  }
  store2(rotate(a, normal), c.normal);
}

template <int W>
CAROM_SIMD_INLINE void prepare_friction2(ContactBlock<Dim2, W>& c, ContactRaw<Dim2, W>& raw, WideFloat<W> rate) {
  using F = WideFloat<W>;
  const F zero = F::splat(0), one = F::splat(1);
  F weight = zero, count = zero;
  WideVec2<W> pressed = {zero, zero}, middle = {zero, zero};
  for (int i = 0; i < 2; ++i) {
    const F impulse = F::load(c.point[i].impulse);
    const WideVec2<W> r = load2<W>(c.point[i].r_a);
    weight += impulse;
    count += F::load(c.point[i].normal_mass);
    pressed = add(pressed, scale(r, impulse));
    middle = add(middle, r);
  }
  const auto loaded = weight > zero;
  const WideVec2<W> center =
      select(loaded, scale(pressed, one / select(loaded, weight, one)), scale(middle, one / max(count, one)));
  store2(center, c.patch_r_a);
  const WideVec2<W> n = load2<W>(c.normal), t = {zero - n.y, n.x};
  // Where friction sticks is remembered on both bodies, so that a body at rest on a slope stays there for good.
  const WideVec2<W> center_b = add(center, load2<W>(c.center_offset));
  const WideVec2<W> a = subtract(rotate(load_turn<W>(raw.rotation_a), load2<W>(raw.anchor_a)), center);
  const WideVec2<W> b = subtract(rotate(load_turn<W>(raw.rotation_b), load2<W>(raw.anchor_b)), center_b);
  const F reach = anchor_reach(min(sqrt(dot(center, center)), sqrt(dot(center_b, center_b))));
  const F state = F::load(raw.anchor_state);
  const auto holds = (state > one) & (dot(b, b) < reach * reach);
  const WideVec2<W> none = {zero, zero}, slip = select(holds, subtract(b, a), none);
  select(holds, zero, min(state, one)).store(raw.anchor_state);
  rate = select(state > F::splat(2), rate + rate, rate);
  dot(load2<W>(raw.friction_impulse), t).store(c.tangent_impulse);
  keep(holds & (state == F::splat(2)) & (count == F::splat(2)), F::load(raw.squeezed)).store(raw.squeezed);
  (F::load(raw.tangent_speed) - rate * dot(slip, t)).store(c.tangent_target);
}

template <int W>
CAROM_SIMD_INLINE void prepare_masses2(ContactBlock<Dim2, W>& c, const ContactRaw<Dim2, W>& raw, WideFloat<W> leak) {
  using F = WideFloat<W>;
  const F mass = F::load(c.inverse_mass_a) + F::load(c.inverse_mass_b);
  const F ia = F::load(c.inverse_inertia_a), ib = F::load(c.inverse_inertia_b);
  const WideVec2<W> n = load2<W>(c.normal), offset = load2<W>(c.center_offset), t = {F::splat(0) - n.y, n.x};
  for (int i = 0; i < 2; ++i) {
    const WideVec2<W> ra = load2<W>(c.point[i].r_a);
    const F ta = cross(ra, n), tb = cross(add(ra, offset), n);
    inverse_or_zero(F::load(c.point[i].normal_mass), mass + ia * ta * ta + ib * tb * tb).store(c.point[i].normal_mass);
  }
  const WideVec2<W> ra = load2<W>(c.patch_r_a);
  const F ta = cross(ra, t), tb = cross(add(ra, offset), t);
  const F response = mass + ia * ta * ta + ib * tb * tb;
  inverse_or_zero(F::splat(1), response).store(c.tangent_mass);
  const F forgotten = leak * F::load(raw.squeezed) * F::load(c.tangent_impulse);
  (F::load(c.tangent_target) - response * forgotten).store(c.tangent_target);
}

template <int W>
std::uint32_t prepare2(void* block, void* raw, float anchor_rate, float friction_leak) {
  ContactBlock<Dim2, W>& c = *static_cast<ContactBlock<Dim2, W>*>(block);
  ContactRaw<Dim2, W>& from = *static_cast<ContactRaw<Dim2, W>*>(raw);
  prepare_points2(c, from);
  prepare_friction2(c, from, WideFloat<W>::splat(anchor_rate));
  prepare_masses2(c, from, WideFloat<W>::splat(friction_leak));
  return bitmask(WideFloat<W>::load(from.anchor_state) > WideFloat<W>::zero());
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
