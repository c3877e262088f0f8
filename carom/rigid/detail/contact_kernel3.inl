// The contact kernels of space: part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

template <int W>
struct Velocity3 {
  WideVec3<W> v, w;
};
template <int W>
CAROM_SIMD_INLINE Velocity3<W> read_velocity(const SolverBody<Dim3>* bodies, const std::int32_t* index) {
  WideFloat<W> c[8];
  gather<W>(bodies, index, 0, c);
  return {{c[0], c[1], c[2]}, {c[4], c[5], c[6]}};
}
template <int W>
CAROM_SIMD_INLINE void write_velocity(SolverBody<Dim3>* bodies, const std::int32_t* index, const Velocity3<W>& a) {
  const WideFloat<W> zero = WideFloat<W>::splat(0);
  const WideFloat<W> c[8] = {a.v.x, a.v.y, a.v.z, zero, a.w.x, a.w.y, a.w.z, zero};
  scatter_rows<16, 8, W>(reinterpret_cast<float*>(bodies), index, c);
}
template <int W>
CAROM_SIMD_INLINE void push(Velocity3<W>& a, WideFloat<W> m, const WideSymmetric<W>& i, const WideVec3<W>& p,
                            const WideVec3<W>& turn) {
  a.v = add(a.v, multiply(p, m));
  a.w = add(a.w, multiply(i, turn));
}
template <int W>
CAROM_SIMD_INLINE void push_back(Velocity3<W>& a, WideFloat<W> m, const WideSymmetric<W>& i, const WideVec3<W>& p,
                                 const WideVec3<W>& turn) {
  a.v = subtract(a.v, multiply(p, m));
  a.w = subtract(a.w, multiply(i, turn));
}

template <int W>
void warm_start3(SolverBody<Dim3>* bodies, void* blocks, const void* extra, int begin, int end, bool again) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    const ContactBlock<Dim3, W>& c = static_cast<const ContactBlock<Dim3, W>*>(blocks)[k];
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity3<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const WideVec3<W> n = load3<W>(c.normal), t = load3<W>(c.tangent), u = cross(n, t);
    const WideVec3<W> offset = load3<W>(c.center_offset), offset_turn = cross(offset, n);
    const F f1 = F::load(c.tangent_impulse[0]), f2 = F::load(c.tangent_impulse[1]);
    const WideVec3<W> f = add(multiply(t, f1), multiply(u, f2)), patch = load3<W>(c.patch_r_a);
    const WideVec3<W> twist = multiply(n, F::load(c.twist_impulse));
    // Arms as the passes have them: the middle of a ground may lie a kilometre off, and what the far arms of all points
    // together differ by from these would turn the body.
    WideVec3<W> turn_a = add(cross(patch, f), twist), turn_b = add(cross(add(patch, offset), f), twist);
    F sum = F::splat(0);
    for (int i = 0; i < 4; ++i) {
      const F lambda = F::load(c.point[i].impulse);
      const WideVec3<W> turn = cross(load3<W>(c.point[i].r_a), n);
      sum += lambda;
      turn_a = add(turn_a, multiply(turn, lambda));
      turn_b = add(turn_b, multiply(add(turn, offset_turn), lambda));
    }
    const WideVec3<W> p = add(multiply(n, sum), f);
    if (extra != nullptr) {
      const WideVec3<W> rolling = load3<W>(static_cast<const ContactExtra<Dim3, W>*>(extra)[k].rolling_impulse);
      turn_a = add(turn_a, rolling);
      turn_b = add(turn_b, rolling);
    }
    push_back(a, F::load(c.inverse_mass_a), load_symmetric<W>(c.inverse_inertia_a), p, turn_a);
    push(b, F::load(c.inverse_mass_b), load_symmetric<W>(c.inverse_inertia_b), p, turn_b);
    if (again) {
      std::int32_t to_a[W], to_b[W];
      who_starts_again<W>(c.again, 1, c.body_a, to_a);
      who_starts_again<W>(c.again, 2, c.body_b, to_b);
      write_velocity<W>(bodies, to_a, a);
      write_velocity<W>(bodies, to_b, b);
    } else {
      write_velocity<W>(bodies, c.body_a, a);
      write_velocity<W>(bodies, c.body_b, b);
    }
  }
}

/// Rᵀn − n of the unit quaternion (w, x, y, z), without what is along n: a point below the centre of a body that rolls
/// is another one at every moment, and the surface stays where it is. What faces lose by that is of second order.
template <int W>
CAROM_SIMD_INLINE WideVec3<W> turned_back_change(const WideFloat<W> (&q)[8], const WideVec3<W>& n) {
  using F = WideFloat<W>;
  const WideVec3<W> u = {F::splat(0) - q[5], F::splat(0) - q[6], F::splat(0) - q[7]};
  const WideVec3<W> x = cross(u, n), t = add(x, x);
  const WideVec3<W> change = add(multiply(t, q[4]), cross(u, t));
  return subtract(change, multiply(n, dot(change, n)));
}

template <int W, NormalPass Pass>
CAROM_SIMD_INLINE PassBlow<W, 4> solve_normals3(const SolverBody<Dim3>* bodies, const Slots<W>& slots_a,
                                                const Slots<W>& slots_b, ContactBlock<Dim3, W>& c, Velocity3<W>& a,
                                                Velocity3<W>& b, const WideVec3<W>& n, const WideSymmetric<W>& ia,
                                                const WideSymmetric<W>& ib, WideFloat<W> inverse_h,
                                                WideFloat<W> push_speed, const WideSoftness<W>& soft, int order) {
  using F = WideFloat<W>;
  const F zero = F::splat(0), one = F::splat(1);
  const F ma = F::load(c.inverse_mass_a), mb = F::load(c.inverse_mass_b);
  const WideVec3<W> offset = load3<W>(c.center_offset), offset_turn = cross(offset, n);
  F pa[8], pb[8];
  gather<W>(bodies, slots_a.of, 8, pa);
  gather<W>(bodies, slots_b.of, 8, pb);
  const F shift = n.x * (pb[0] - pa[0]) + n.y * (pb[1] - pa[1]) + n.z * (pb[2] - pa[2]);
  const WideVec3<W> na = turned_back_change<W>(pa, n), nb = turned_back_change<W>(pb, n);
  PassBlow<W, 4> blow;
  for (int k = 0; k < 4; ++k) {
    const int i = k ^ order;
    auto& point = c.point[i];
    const WideVec3<W> ra = load3<W>(point.r_a), rb = add(ra, offset);
    const F s = F::load(point.separation) + shift + (dot(nb, rb) - dot(na, ra));
    const WideVec3<W> turn_a = cross(ra, n), turn_b = add(turn_a, offset_turn);
    const F old = F::load(point.impulse);
    F bias, mass_scale = one, impulse_scale = zero;
    const auto apart = s > zero;
    if constexpr (Pass == NormalPass::solve) {
      bias = select(apart, s * inverse_h, max(soft.bias_rate * s, zero - push_speed));
      mass_scale = select(apart, one, soft.mass_scale);
      impulse_scale = select(apart, zero, soft.impulse_scale);
    } else {
      bias = keep(apart, s * inverse_h);
    }
    const F vn = dot(subtract(b.v, a.v), n) + dot(b.w, turn_b) - dot(a.w, turn_a);
    F mass = F::load(point.normal_mass);
    if constexpr (Pass == NormalPass::settle) mass = F::load(c.settles) * mass;
    const F lambda = max(old - mass * mass_scale * (vn + bias) - impulse_scale * old, zero);
    const F delta = lambda - old;
    lambda.store(point.impulse);
    if constexpr (Pass == NormalPass::relax) (F::load(point.total) + lambda).store(point.total);
    const WideVec3<W> p = multiply(n, delta);
    push_back(a, ma, ia, p, multiply(turn_a, delta));
    push(b, mb, ib, p, multiply(turn_b, delta));
    blow.add(k, old, delta, vn);
  }
  return blow;
}

template <int W>
void solve3(SolverBody<Dim3>* bodies, void* blocks, int begin, int end, float inverse_h, float push_speed,
            const ContactSoftness& softness, int order) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim3, W>& c = static_cast<ContactBlock<Dim3, W>*>(blocks)[k];
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity3<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const WideSoftness<W> soft(softness, c);
    const PassBlow<W, 4> normals = solve_normals3<W, NormalPass::solve>(
        bodies, slots_a, slots_b, c, a, b, load3<W>(c.normal), load_symmetric<W>(c.inverse_inertia_a),
        load_symmetric<W>(c.inverse_inertia_b), F::splat(inverse_h), F::splat(push_speed), soft, order);
    const auto struck = find_struck(c, normals, WideMask<W>::all());
    if (any(struck)) [[unlikely]] {
      const auto shared = share_blow<W, true>(bodies, c, a, b, struck, inverse_h, push_speed, soft, 0);
      a = shared.a, b = shared.b;
    }
    write_velocity<W>(bodies, c.body_a, a);
    write_velocity<W>(bodies, c.body_b, b);
  }
}

template <int W>
CAROM_SIMD_INLINE void solve_rolling3(ContactExtra<Dim3, W>& e, Velocity3<W>& a, Velocity3<W>& b, WideFloat<W> load,
                                      WideMask<W> takes_part, const WideSymmetric<W>& ia, const WideSymmetric<W>& ib) {
  using F = WideFloat<W>;
  const WideVec3<W> old = load3<W>(e.rolling_impulse);
  // Against the spin, as friction is: not along what its inertia would ask for, or logs roll on while they tilt.
  const WideSymmetric<W> response = {ia.xx + ib.xx, ia.yy + ib.yy, ia.zz + ib.zz,
                                     ia.xy + ib.xy, ia.xz + ib.xz, ia.yz + ib.yz};
  const WideVec3<W> spin = subtract(b.w, a.w), turned = multiply(response, spin);
  const WideVec3<W> step = multiply(spin, dot(spin, spin) / (dot(spin, turned) + F::splat(1e-30f)));
  WideVec3<W> lambda = subtract(old, step);
  const F limit = F::load(e.rolling_lever) * load, size = sqrt(dot(lambda, lambda));
  const F scale = select(size > limit, limit / max(size, F::splat(1e-30f)), F::splat(1));
  lambda = select(takes_part, multiply(lambda, scale), old);
  lambda.x.store(e.rolling_impulse[0]);
  lambda.y.store(e.rolling_impulse[1]);
  lambda.z.store(e.rolling_impulse[2]);
  const WideVec3<W> delta = subtract(lambda, old);
  a.w = subtract(a.w, multiply(ia, delta));
  b.w = add(b.w, multiply(ib, delta));
}

template <int W>
CAROM_SIMD_INLINE WideFloat<W> load_of(const ContactBlock<Dim3, W>& c) {
  using F = WideFloat<W>;
  return F::load(c.point[0].impulse) + F::load(c.point[1].impulse) + F::load(c.point[2].impulse) +
         F::load(c.point[3].impulse);
}

template <int W>
CAROM_SIMD_INLINE void solve_friction3(ContactBlock<Dim3, W>& c, Velocity3<W>& a, Velocity3<W>& b, WideFloat<W> load,
                                       WideMask<W> takes_part, const WideVec3<W>& n, const WideSymmetric<W>& ia,
                                       const WideSymmetric<W>& ib) {
  using F = WideFloat<W>;
  const F cone = F::load(c.friction) * load;
  {
    const F old = F::load(c.twist_impulse), limit = cone * F::load(c.twist_radius);
    const F wanted = old - F::load(c.twist_mass) * dot(subtract(b.w, a.w), n);
    const F lambda = select(takes_part, clamp(wanted, F::splat(0) - limit, limit), old);
    lambda.store(c.twist_impulse);
    const WideVec3<W> turn = multiply(n, lambda - old);
    a.w = subtract(a.w, multiply(ia, turn));
    b.w = add(b.w, multiply(ib, turn));
  }
  const WideVec3<W> t = load3<W>(c.tangent), u = cross(n, t);
  const WideVec3<W> ra = load3<W>(c.patch_r_a), rb = add(ra, load3<W>(c.center_offset));
  const WideVec3<W> slip = subtract(add(b.v, cross(b.w, rb)), add(a.v, cross(a.w, ra)));
  const F e1 = dot(slip, t) - F::load(c.tangent_target[0]), e2 = dot(slip, u) - F::load(c.tangent_target[1]);
  const F m11 = F::load(c.tangent_mass[0]), m22 = F::load(c.tangent_mass[1]), m12 = F::load(c.tangent_mass[2]);
  const F old1 = F::load(c.tangent_impulse[0]), old2 = F::load(c.tangent_impulse[1]);
  F l1 = old1 - (m11 * e1 + m12 * e2), l2 = old2 - (m12 * e1 + m22 * e2);
  const F size = sqrt(l1 * l1 + l2 * l2);
  const F scale = select(size > cone, cone / max(size, F::splat(1e-30f)), F::splat(1));
  l1 = select(takes_part, l1 * scale, old1);
  l2 = select(takes_part, l2 * scale, old2);
  l1.store(c.tangent_impulse[0]);
  l2.store(c.tangent_impulse[1]);
  const WideVec3<W> p = add(multiply(t, l1 - old1), multiply(u, l2 - old2));
  push_back(a, F::load(c.inverse_mass_a), ia, p, cross(ra, p));
  push(b, F::load(c.inverse_mass_b), ib, p, cross(rb, p));
}

/// The speed of a push is along the normals: friction takes part only once that is gone.
template <int W>
void settle3(SolverBody<Dim3>* bodies, void* blocks, int begin, int end, float inverse_h) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim3, W>& c = static_cast<ContactBlock<Dim3, W>*>(blocks)[k];
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity3<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const auto takes_part = F::load(c.settles) > F::splat(0);
    if (const auto pushed = takes_part & (F::load(c.struck) >= F::splat(block_pushed)); any(pushed)) [[unlikely]] {
      const auto shared = share_blow<W, false>(bodies, c, a, b, pushed, inverse_h, 0, {}, 0);
      a = shared.a, b = shared.b;
    }
    const PassBlow<W, 4> normals = solve_normals3<W, NormalPass::settle>(
        bodies, slots_a, slots_b, c, a, b, load3<W>(c.normal), load_symmetric<W>(c.inverse_inertia_a),
        load_symmetric<W>(c.inverse_inertia_b), F::splat(inverse_h), F::splat(0), {}, 0);
    const auto hard = find_struck(c, normals, takes_part);
    if (any(hard)) [[unlikely]] {
      const auto shared = share_blow<W, false>(bodies, c, a, b, hard, inverse_h, 0, {}, 0);
      a = shared.a, b = shared.b;
    }
    std::int32_t to_a[W], to_b[W];
    who_settles<W>(c.settles, c.body_a, to_a);
    who_settles<W>(c.settles, c.body_b, to_b);
    write_velocity<W>(bodies, to_a, a);
    write_velocity<W>(bodies, to_b, b);
  }
}

template <int W>
void relax3(SolverBody<Dim3>* bodies, void* blocks, void* extra, int begin, int end, float inverse_h) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim3, W>& c = static_cast<ContactBlock<Dim3, W>*>(blocks)[k];
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity3<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const WideSymmetric<W> ia = load_symmetric<W>(c.inverse_inertia_a), ib = load_symmetric<W>(c.inverse_inertia_b);
    const WideVec3<W> n = load3<W>(c.normal);
    auto rubs = WideMask<W>::all();
    // A push is taken back as it was given, before friction can make something of it.
    if (const auto pushed = F::load(c.struck) >= F::splat(block_pushed); any(pushed)) [[unlikely]] {
      const auto shared = share_blow<W, false>(bodies, c, a, b, pushed, inverse_h, 0, {}, 0);
      a = shared.a, b = shared.b;
    }
    F load = load_of<W>(c);
    // What keeps bodies apart has the last word. But a blow that falls only here would otherwise pass without friction:
    // what strikes the ground would go on along it.
    for (bool struck = false;; struck = true) {
      if (extra != nullptr) solve_rolling3<W>(static_cast<ContactExtra<Dim3, W>*>(extra)[k], a, b, load, rubs, ia, ib);
      solve_friction3<W>(c, a, b, load, rubs, n, ia, ib);
      if (struck) break;
      const PassBlow<W, 4> normals = solve_normals3<W, NormalPass::relax>(bodies, slots_a, slots_b, c, a, b, n, ia, ib,
                                                                          F::splat(inverse_h), F::splat(0), {}, 0);
      const auto hard = find_struck(c, normals, WideMask<W>::all());
      if (any(hard)) [[unlikely]] {
        const auto shared = share_blow<W, false>(bodies, c, a, b, hard, inverse_h, 0, {}, 1);
        a = shared.a, b = shared.b;
      }
      const F before = load;
      load = load_of<W>(c);
      const F blow = (load - before) * (F::load(c.inverse_mass_a) + F::load(c.inverse_mass_b));
      rubs = blow > F::splat(least_blow);
      if (!any(rubs)) break;
    }
    (F::load(c.tangent_total[0]) + F::load(c.tangent_impulse[0])).store(c.tangent_total[0]);
    (F::load(c.tangent_total[1]) + F::load(c.tangent_impulse[1])).store(c.tangent_total[1]);
    write_velocity<W>(bodies, c.body_a, a);
    write_velocity<W>(bodies, c.body_b, b);
  }
}

template <int W>
void restitute3(SolverBody<Dim3>* bodies, void* blocks, const void* extra, int begin, int end) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim3, W>& c = static_cast<ContactBlock<Dim3, W>*>(blocks)[k];
    const ContactExtra<Dim3, W>& e = static_cast<const ContactExtra<Dim3, W>*>(extra)[k];
    const F zero = F::splat(0);
    F fastest = F::load(e.bounce_speed[0]);
    for (int i = 1; i < 4; ++i) fastest = max(fastest, F::load(e.bounce_speed[i]));
    if (!any(fastest > zero)) continue;
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity3<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const F ma = F::load(c.inverse_mass_a), mb = F::load(c.inverse_mass_b);
    const WideSymmetric<W> ia = load_symmetric<W>(c.inverse_inertia_a), ib = load_symmetric<W>(c.inverse_inertia_b);
    const WideVec3<W> n = load3<W>(c.normal), offset = load3<W>(c.center_offset), offset_turn = cross(offset, n);
    F pa[8], pb[8];
    gather<W>(bodies, slots_a.of, 8, pa);
    gather<W>(bodies, slots_b.of, 8, pb);
    const F shift = n.x * (pb[0] - pa[0]) + n.y * (pb[1] - pa[1]) + n.z * (pb[2] - pa[2]);
    const WideVec3<W> na = turned_back_change<W>(pa, n), nb = turned_back_change<W>(pb, n);
    const F acceleration = F::load(e.closing_acceleration) + F::load(e.closing_acceleration);
    // Where one point of a face struck, those beside it did too, though the solver may have found that its neighbours
    // carry the blow for it.
    F struck = zero;
    for (int i = 0; i < 4; ++i) struck += F::load(c.point[i].total);
    const F reach = F::splat(2e-3f);
    // The points of a face push each other back: repeat until they agree.
    auto changes = WideMask<W>::none();
    for (int pass = 0; pass < 32; ++pass) {
      const int i = pass % 4;
      if (i == 0) {
        if (pass > 0 && !any(changes)) break;
        changes = WideMask<W>::none();
      }
      auto& point = c.point[i];
      const F full = F::load(e.bounce_speed[i]), total = F::load(point.total), old = F::load(point.impulse);
      const WideVec3<W> ra = load3<W>(point.r_a);
      const F s = F::load(point.separation) + shift + (dot(nb, add(ra, offset)) - dot(na, ra));
      const F speed = sqrt(max(full * full - acceleration * max(s, zero), zero));
      const WideVec3<W> turn_a = cross(ra, n), turn_b = add(turn_a, offset_turn);
      const F vn = dot(subtract(b.v, a.v), n) + dot(b.w, turn_b) - dot(a.w, turn_a);
      const F lambda = max(old - F::load(point.normal_mass) * (vn - speed), zero);
      const F delta = keep((full > zero) & ((total > zero) | ((struck > zero) & (s < reach))), lambda - old);
      changes = changes | !(delta == zero);
      (old + delta).store(point.impulse);
      (total + delta).store(point.total);
      const WideVec3<W> p = multiply(n, delta);
      push_back(a, ma, ia, p, multiply(turn_a, delta));
      push(b, mb, ib, p, multiply(turn_b, delta));
    }
    // The blow presses the surfaces together: friction of the whole step stays within the cone of its whole load. It
    // acts where the surfaces meet; the points were foreseen half a gap before that.
    F load = zero, bounced = zero, gap = zero;
    for (int i = 0; i < 4; ++i) {
      const F total = F::load(c.point[i].total);
      load += total;
      gap += total * max(F::load(c.point[i].separation), zero);
      bounced = max(bounced, keep(total > zero, F::load(e.bounce_speed[i])));
    }
    gap = F::splat(0.5f) * gap / max(load, F::splat(1e-30f));
    const WideVec3<W> t = load3<W>(c.tangent), u = cross(n, t), middle = load3<W>(c.patch_r_a),
                      to_surface = multiply(n, gap);
    const WideVec3<W> ra = subtract(middle, to_surface), rb = add(add(middle, offset), to_surface);
    const F cone = F::load(c.friction) * load;
    const WideVec3<W> ta = cross(ra, t), tb = cross(rb, t), ua = cross(ra, u), ub = cross(rb, u);
    const WideVec3<W> ita = multiply(ia, ta), itb = multiply(ib, tb);
    const F k11 = ma + mb + dot(ta, ita) + dot(tb, itb), k12 = dot(ua, ita) + dot(ub, itb);
    const F k22 = ma + mb + dot(ua, multiply(ia, ua)) + dot(ub, multiply(ib, ub));
    const F s = inverse_or_zero(F::splat(1), k11 * k22 - k12 * k12);
    const WideVec3<W> slip = subtract(add(b.v, cross(b.w, rb)), add(a.v, cross(a.w, ra)));
    const F e1 = dot(slip, t) - F::load(c.tangent_target[0]), e2 = dot(slip, u) - F::load(c.tangent_target[1]);
    const F old1 = F::load(c.tangent_total[0]), old2 = F::load(c.tangent_total[1]);
    const F l1 = old1 - s * (k22 * e1 - k12 * e2), l2 = old2 - s * (k11 * e2 - k12 * e1);
    const F size = sqrt(l1 * l1 + l2 * l2);
    const F scale = select(size > cone, cone / max(size, F::splat(1e-30f)), F::splat(1));
    const F delta1 = keep(bounced > zero, scale * l1 - old1), delta2 = keep(bounced > zero, scale * l2 - old2);
    (old1 + delta1).store(c.tangent_total[0]);
    (old2 + delta2).store(c.tangent_total[1]);
    (F::load(c.tangent_impulse[0]) + delta1).store(c.tangent_impulse[0]);
    (F::load(c.tangent_impulse[1]) + delta2).store(c.tangent_impulse[1]);
    const WideVec3<W> p = add(multiply(t, delta1), multiply(u, delta2));
    push_back(a, ma, ia, p, cross(ra, p));
    push(b, mb, ib, p, cross(rb, p));
    write_velocity<W>(bodies, c.body_a, a);
    write_velocity<W>(bodies, c.body_b, b);
  }
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
