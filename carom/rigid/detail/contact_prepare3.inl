// From the records of contacts to their blocks, in space: part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

template <int W>
struct WideQuat {
  WideFloat<W> w, x, y, z;
};
template <int W>
CAROM_SIMD_INLINE WideQuat<W> load_turn(const float (&p)[4][W]) {
  return {WideFloat<W>::load(p[0]), WideFloat<W>::load(p[1]), WideFloat<W>::load(p[2]), WideFloat<W>::load(p[3])};
}
template <int W>
CAROM_SIMD_INLINE WideQuat<W> multiply(const WideQuat<W>& a, const WideQuat<W>& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
template <int W>
CAROM_SIMD_INLINE WideQuat<W> conjugate(const WideQuat<W>& q) {
  return {q.w, -q.x, -q.y, -q.z};
}
template <int W>
struct WideMatrix {
  WideVec3<W> cx, cy, cz;
};
template <int W>
CAROM_SIMD_INLINE WideMatrix<W> to_matrix(const WideQuat<W>& q) {
  using F = WideFloat<W>;
  const F one = F::splat(1), x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
  const F xx = x2 * q.x, yy = y2 * q.y, zz = z2 * q.z, xy = x2 * q.y, xz = x2 * q.z, yz = y2 * q.z;
  const F wx = x2 * q.w, wy = y2 * q.w, wz = z2 * q.w;
  return {{one - yy - zz, xy + wz, xz - wy}, {xy - wz, one - xx - zz, yz + wx}, {xz + wy, yz - wx, one - xx - yy}};
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> rotate(const WideMatrix<W>& m, const WideVec3<W>& v) {
  return {m.cx.x * v.x + m.cy.x * v.y + m.cz.x * v.z, m.cx.y * v.x + m.cy.y * v.y + m.cz.y * v.z,
          m.cx.z * v.x + m.cy.z * v.y + m.cz.z * v.z};
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> inverse_rotate(const WideMatrix<W>& m, const WideVec3<W>& v) {
  return {dot(m.cx, v), dot(m.cy, v), dot(m.cz, v)};
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> select(WideMask<W> m, const WideVec3<W>& a, const WideVec3<W>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
template <int W>
CAROM_SIMD_INLINE void store3(const WideVec3<W>& a, float (&p)[3][W]) {
  a.x.store(p[0]);
  a.y.store(p[1]);
  a.z.store(p[2]);
}
/// As math::perpendicular.
template <int W>
CAROM_SIMD_INLINE WideVec3<W> perpendicular(const WideVec3<W>& n) {
  using F = WideFloat<W>;
  const F one = F::splat(1), s = select(n.z < F::splat(0), -one, one), a = -one / (s + n.z);
  return {one + s * n.x * n.x * a, s * n.x * n.y * a, -s * n.x};
}

template <int W>
CAROM_SIMD_INLINE void prepare_points3(ContactBlock<Dim3, W>& c, const ContactRaw<Dim3, W>& raw) {
  using F = WideFloat<W>;
  const F half = F::splat(0.5f), zero = F::splat(0);
  const WideQuat<W> body_a = load_turn<W>(raw.rotation_a), body_b = load_turn<W>(raw.rotation_b);
  const WideQuat<W> qa = multiply(body_a, load_turn<W>(raw.shape_a.q));
  const WideQuat<W> qb = multiply(body_b, load_turn<W>(raw.shape_b.q));
  const WideMatrix<W> a = to_matrix(qa);
  const WideVec3<W> to_a = rotate(to_matrix(body_a), load3<W>(raw.shape_a.p));
  const WideVec3<W> to_b = rotate(to_matrix(body_b), load3<W>(raw.shape_b.p));
  const WideVec3<W> normal = load3<W>(c.normal), offset = load3<W>(c.center_offset);
  // How B has moved in A's frame since the manifold was made.
  const auto recycled = F::load(raw.recycled) > zero;
  const WideMatrix<W> turned = to_matrix(multiply(multiply(conjugate(qa), qb), conjugate(load_turn<W>(raw.base.q))));
  const WideVec3<W> moved =
      subtract(inverse_rotate(a, subtract(subtract(to_b, to_a), offset)), rotate(turned, load3<W>(raw.base.p)));
  for (int i = 0; i < 4; ++i) {
    auto& point = c.point[i];
    const auto exists = F::load(point.normal_mass) > zero;
    const WideVec3<W> p = load3<W>(point.r_a), reach = multiply(normal, half * F::load(point.separation));
    const WideVec3<W> on_a = subtract(p, reach), on_b = add(rotate(turned, add(p, reach)), moved);
    const F separation = select(recycled, dot(subtract(on_b, on_a), normal), F::load(point.separation));
    const WideVec3<W> now = select(recycled, multiply(add(on_a, on_b), half), p), none = {zero, zero, zero};
    store3(select(exists, add(rotate(a, now), to_a), none), point.r_a);
    select(exists, separation, F::splat(1e3f)).store(point.separation);
  }
  store3(rotate(a, normal), c.normal);
}

template <int W>
CAROM_SIMD_INLINE void prepare_friction3(ContactBlock<Dim3, W>& c, ContactRaw<Dim3, W>& raw, WideFloat<W> rate) {
  using F = WideFloat<W>;
  const F zero = F::splat(0), one = F::splat(1);
  F weight = zero, count = zero;
  WideVec3<W> pressed = {zero, zero, zero}, middle = pressed;
  for (int i = 0; i < 4; ++i) {
    const F impulse = F::load(c.point[i].impulse);
    const WideVec3<W> r = load3<W>(c.point[i].r_a);
    weight += impulse;
    count += F::load(c.point[i].normal_mass);
    pressed = add(pressed, multiply(r, impulse));
    middle = add(middle, r);
  }
  const auto loaded = weight > zero;
  const F share = one / select(loaded, weight, max(count, one));
  const WideVec3<W> center = multiply(select(loaded, pressed, middle), share);
  store3(center, c.patch_r_a);
  F radius = zero;
  for (int i = 0; i < 4; ++i) {
    const WideVec3<W> d = subtract(load3<W>(c.point[i].r_a), center);
    radius += sqrt(dot(d, d)) * select(loaded, F::load(c.point[i].impulse), F::load(c.point[i].normal_mass));
  }
  // A single point, where something is round, is a small disc by the depth to which it is pressed in: of radius √(R δ),
  // and its elliptic pressure turns on 3π/16 of that (Hertz; Johnson, Contact Mechanics, §3.4 and §7.4).
  const WideVec3<W> center_b = add(center, load3<W>(c.center_offset));
  const F arm = min(sqrt(dot(center, center)), sqrt(dot(center_b, center_b)));
  const F disc = F::load(raw.point_factor) * sqrt(arm * max(zero - F::load(c.point[0].separation), zero));
  radius = select(count > one, radius * F::load(raw.patch_factor) * share, keep(loaded, disc));
  radius += F::load(raw.spin_radius);
  radius.store(c.twist_radius);
  keep(radius > zero, F::load(c.twist_impulse)).store(c.twist_impulse);

  const WideVec3<W> n = load3<W>(c.normal), t = perpendicular(n), u = cross(n, t);
  store3(t, c.tangent);
  // Where friction sticks is remembered on both bodies, so that a body at rest on a slope stays there for good.
  const WideVec3<W> a = subtract(rotate(to_matrix(load_turn<W>(raw.rotation_a)), load3<W>(raw.anchor_a)), center);
  const WideVec3<W> b = subtract(rotate(to_matrix(load_turn<W>(raw.rotation_b)), load3<W>(raw.anchor_b)), center_b);
  const F reach = anchor_reach(arm);
  const F state = F::load(raw.anchor_state);
  const auto holds = (state > one) & (dot(b, b) < reach * reach);
  const WideVec3<W> none = {zero, zero, zero}, slip = select(holds, subtract(b, a), none);
  select(holds, zero, min(state, one)).store(raw.anchor_state);
  rate = select(state > F::splat(2), rate + rate, rate);
  keep(holds & (state == F::splat(2)) & (count == F::splat(4)), F::load(raw.squeezed)).store(raw.squeezed);
  const WideVec3<W> impulse = load3<W>(raw.friction_impulse);
  dot(impulse, t).store(c.tangent_impulse[0]);
  dot(impulse, u).store(c.tangent_impulse[1]);
  (F::load(raw.tangent_speed) - rate * dot(slip, t)).store(c.tangent_target[0]);
  (zero - rate * dot(slip, u)).store(c.tangent_target[1]);
}

/// How tangents respond: 11, 22, 12 of a symmetric matrix.
template <int W>
struct TangentResponse {
  WideFloat<W> k11, k22, k12;
};
/// The masses of the rows, from those of the bodies. Points that exist have a normal_mass.
template <int W>
CAROM_SIMD_INLINE TangentResponse<W> find_masses3(ContactBlock<Dim3, W>& c) {
  using F = WideFloat<W>;
  const F mass = F::load(c.inverse_mass_a) + F::load(c.inverse_mass_b);
  const WideSymmetric<W> ia = load_symmetric<W>(c.inverse_inertia_a), ib = load_symmetric<W>(c.inverse_inertia_b);
  const WideVec3<W> n = load3<W>(c.normal), offset = load3<W>(c.center_offset);
  for (int i = 0; i < 4; ++i) {
    const WideVec3<W> ra = load3<W>(c.point[i].r_a), ta = cross(ra, n), tb = cross(add(ra, offset), n);
    const F response = mass + dot(ta, multiply(ia, ta)) + dot(tb, multiply(ib, tb));
    const F exists = keep(F::load(c.point[i].normal_mass) > F::zero(), F::splat(1));
    inverse_or_zero(exists, response).store(c.point[i].normal_mass);
  }
  const WideVec3<W> t = load3<W>(c.tangent), u = cross(n, t), ra = load3<W>(c.patch_r_a), rb = add(ra, offset);
  const WideVec3<W> ta = cross(ra, t), tb = cross(rb, t), ua = cross(ra, u), ub = cross(rb, u);
  const WideVec3<W> ita = multiply(ia, ta), itb = multiply(ib, tb), iua = multiply(ia, ua), iub = multiply(ib, ub);
  const F k11 = mass + dot(ta, ita) + dot(tb, itb), k22 = mass + dot(ua, iua) + dot(ub, iub);
  const F k12 = dot(ua, ita) + dot(ub, itb);
  const F s = inverse_or_zero(F::splat(1), k11 * k22 - k12 * k12);
  (k22 * s).store(c.tangent_mass[0]);
  (k11 * s).store(c.tangent_mass[1]);
  (F::splat(0) - k12 * s).store(c.tangent_mass[2]);
  const WideVec3<W> spin = add(multiply(ia, n), multiply(ib, n));
  inverse_or_zero(F::splat(1), dot(n, spin)).store(c.twist_mass);
  return {k11, k22, k12};
}
/// Bodies have turned.
template <int W>
void find_masses_again3(void* block) {
  find_masses3(*static_cast<ContactBlock<Dim3, W>*>(block));
}

template <int W>
CAROM_SIMD_INLINE void prepare_masses3(ContactBlock<Dim3, W>& c, const ContactRaw<Dim3, W>& raw, WideFloat<W> leak) {
  using F = WideFloat<W>;
  const auto [k11, k22, k12] = find_masses3(c);
  const F forgotten = leak * F::load(raw.squeezed);
  const F l1 = forgotten * F::load(c.tangent_impulse[0]), l2 = forgotten * F::load(c.tangent_impulse[1]);
  (F::load(c.tangent_target[0]) - (k11 * l1 + k12 * l2)).store(c.tangent_target[0]);
  (F::load(c.tangent_target[1]) - (k12 * l1 + k22 * l2)).store(c.tangent_target[1]);
}

template <int W>
std::uint32_t prepare3(void* block, void* raw, float anchor_rate, float friction_leak) {
  ContactBlock<Dim3, W>& c = *static_cast<ContactBlock<Dim3, W>*>(block);
  ContactRaw<Dim3, W>& from = *static_cast<ContactRaw<Dim3, W>*>(raw);
  prepare_points3(c, from);
  prepare_friction3(c, from, WideFloat<W>::splat(anchor_rate));
  prepare_masses3(c, from, WideFloat<W>::splat(friction_leak));
  return bitmask(WideFloat<W>::load(from.anchor_state) > WideFloat<W>::zero());
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
