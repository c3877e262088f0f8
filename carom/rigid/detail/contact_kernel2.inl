// The contact kernels of the plane: part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

template <int W>
struct Velocity2 {
  WideVec2<W> v;
  WideFloat<W> w;
};
template <int W>
CAROM_SIMD_INLINE Velocity2<W> read_velocity(const SolverBody<Dim2>* bodies, const std::int32_t* index) {
  WideFloat<W> c[4];
  gather<W>(bodies, index, 0, c);
  return {{c[0], c[1]}, c[2]};
}
template <int W>
CAROM_SIMD_INLINE void write_velocity(SolverBody<Dim2>* bodies, const std::int32_t* index, const Velocity2<W>& a) {
  const WideFloat<W> c[4] = {a.v.x, a.v.y, a.w, WideFloat<W>::splat(0)};
  scatter_rows<8, 4, W>(reinterpret_cast<float*>(bodies), index, c);
}
/// The impulse (x, y) at r on a body, `s` its sign times the inverse masses.
template <int W>
CAROM_SIMD_INLINE void push(Velocity2<W>& a, WideFloat<W> m, WideFloat<W> i, const WideVec2<W>& p, WideFloat<W> turn) {
  a.v.x += m * p.x;
  a.v.y += m * p.y;
  a.w += i * turn;
}
template <int W>
CAROM_SIMD_INLINE void push_back(Velocity2<W>& a, WideFloat<W> m, WideFloat<W> i, const WideVec2<W>& p,
                                 WideFloat<W> turn) {
  a.v.x -= m * p.x;
  a.v.y -= m * p.y;
  a.w -= i * turn;
}

template <int W>
void warm_start2(SolverBody<Dim2>* bodies, void* blocks, const void* extra, int begin, int end, bool again) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    const ContactBlock<Dim2, W>& c = static_cast<const ContactBlock<Dim2, W>*>(blocks)[k];
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity2<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const WideVec2<W> n = load2<W>(c.normal), offset = load2<W>(c.center_offset);
    const WideVec2<W> t = {F::splat(0) - n.y, n.x};
    const F offset_turn = cross(offset, n), friction = F::load(c.tangent_impulse);
    const WideVec2<W> patch = load2<W>(c.patch_r_a);
    // Arms as the passes have them: the middle of a ground may lie a kilometre off, and what the far arms of all points
    // together differ by from these would turn the body.
    F turn_a = friction * cross(patch, t), turn_b = friction * cross(add(patch, offset), t), sum = F::splat(0);
    for (int i = 0; i < 2; ++i) {
      const F lambda = F::load(c.point[i].impulse), turn = cross(load2<W>(c.point[i].r_a), n);
      sum += lambda;
      turn_a += lambda * turn;
      turn_b += lambda * (turn + offset_turn);
    }
    const WideVec2<W> p = {sum * n.x + friction * t.x, sum * n.y + friction * t.y};
    if (extra != nullptr) {
      const F rolling = F::load(static_cast<const ContactExtra<Dim2, W>*>(extra)[k].rolling_impulse[0]);
      turn_a += rolling;
      turn_b += rolling;
    }
    push_back(a, F::load(c.inverse_mass_a), F::load(c.inverse_inertia_a), p, turn_a);
    push(b, F::load(c.inverse_mass_b), F::load(c.inverse_inertia_b), p, turn_b);
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

/// n·(R r) − n·r = (Rᵀn − n)·r: the change only, so that no precision is lost for large r. Without what is along n: a
/// point below the centre of a body that rolls is another one at every moment, and the surface stays where it is. What
/// faces lose by that is of second order.
template <int W>
CAROM_SIMD_INLINE WideVec2<W> turned_back_change(const WideFloat<W> (&q)[4], const WideVec2<W>& n) {
  const WideVec2<W> change = {q[2] * n.x + q[3] * n.y - n.x, q[2] * n.y - q[3] * n.x - n.y};
  const WideFloat<W> lift = dot(change, n);
  return {change.x - n.x * lift, change.y - n.y * lift};
}

template <int W, NormalPass Pass>
CAROM_SIMD_INLINE PassBlow<W, 2> solve_normals2(const SolverBody<Dim2>* bodies, const Slots<W>& slots_a,
                                                const Slots<W>& slots_b, ContactBlock<Dim2, W>& c, Velocity2<W>& a,
                                                Velocity2<W>& b, const WideVec2<W>& n, WideFloat<W> inverse_h,
                                                WideFloat<W> push_speed, const WideSoftness<W>& soft, int order) {
  using F = WideFloat<W>;
  order &= 1;
  const F zero = F::splat(0), one = F::splat(1);
  const F ma = F::load(c.inverse_mass_a), mb = F::load(c.inverse_mass_b);
  const F ia = F::load(c.inverse_inertia_a), ib = F::load(c.inverse_inertia_b);
  const WideVec2<W> offset = load2<W>(c.center_offset);
  const F offset_turn = cross(offset, n);
  F pa[4], pb[4];
  gather<W>(bodies, slots_a.of, 4, pa);
  gather<W>(bodies, slots_b.of, 4, pb);
  const F shift = n.x * (pb[0] - pa[0]) + n.y * (pb[1] - pa[1]);
  const WideVec2<W> na = turned_back_change<W>(pa, n), nb = turned_back_change<W>(pb, n);
  PassBlow<W, 2> blow;
  for (int k = 0; k < 2; ++k) {
    const int i = k ^ order;
    auto& point = c.point[i];
    const WideVec2<W> ra = load2<W>(point.r_a), rb = add(ra, offset);
    const F s = F::load(point.separation) + shift + (dot(nb, rb) - dot(na, ra));
    const F turn_a = cross(ra, n), turn_b = turn_a + offset_turn;
    const F old = F::load(point.impulse);
    F bias, yields = one;  // mass_scale; impulse_scale is 1 less that
    const auto apart = s > zero;
    if constexpr (Pass == NormalPass::solve) {
      bias = select(apart, s * inverse_h, max(soft.bias_rate * s, zero - push_speed));
      // From soft to rigid within so little: rounding must not decide which of the two it is.
      const F rigid = clamp(s * F::splat(1 / touching_gap), zero, one);
      yields = soft.mass_scale + rigid * soft.impulse_scale;
    } else {
      bias = keep(apart, s * inverse_h);
    }
    const F vn = dot(subtract(b.v, a.v), n) + b.w * turn_b - a.w * turn_a;
    F mass = F::load(point.normal_mass);
    if constexpr (Pass == NormalPass::settle) mass = F::load(c.settles) * mass;
    const F wanted = old - mass * (vn + bias);
    const F lambda = max(Pass == NormalPass::solve ? yields * wanted : wanted, zero);
    const F delta = lambda - old;
    lambda.store(point.impulse);
    if constexpr (Pass == NormalPass::relax) (F::load(point.total) + lambda).store(point.total);
    const WideVec2<W> p = {delta * n.x, delta * n.y};
    push_back(a, ma, ia, p, delta * turn_a);
    push(b, mb, ib, p, delta * turn_b);
    blow.add(k, old, delta, vn);
  }
  return blow;
}

template <int W>
void solve2(SolverBody<Dim2>* bodies, void* blocks, int begin, int end, float inverse_h, float push_speed,
            const ContactSoftness& softness, int order) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim2, W>& c = static_cast<ContactBlock<Dim2, W>*>(blocks)[k];
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity2<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const WideSoftness<W> soft(softness, c);
    const PassBlow<W, 2> normals = solve_normals2<W, NormalPass::solve>(
        bodies, slots_a, slots_b, c, a, b, load2<W>(c.normal), F::splat(inverse_h), F::splat(push_speed), soft, order);
    const auto struck = find_struck(c, normals, WideMask<W>::all());
    if (any(struck)) [[unlikely]] {
      const auto shared = share_blow<W, true>(bodies, c, a, b, struck, inverse_h, push_speed, soft, 0);
      a = shared.a, b = shared.b;
    }
    write_velocity<W>(bodies, c.body_a, a);
    write_velocity<W>(bodies, c.body_b, b);
  }
}

/// The speed of a push is along the normals: friction takes part only once that is gone.
template <int W>
void settle2(SolverBody<Dim2>* bodies, void* blocks, int begin, int end, float inverse_h) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim2, W>& c = static_cast<ContactBlock<Dim2, W>*>(blocks)[k];
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity2<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const auto takes_part = F::load(c.settles) > F::splat(0);
    if (const auto pushed = takes_part & (F::load(c.struck) >= F::splat(block_pushed)); any(pushed)) [[unlikely]] {
      const auto shared = share_blow<W, false>(bodies, c, a, b, pushed, inverse_h, 0, {}, 0);
      a = shared.a, b = shared.b;
    }
    const PassBlow<W, 2> normals = solve_normals2<W, NormalPass::settle>(
        bodies, slots_a, slots_b, c, a, b, load2<W>(c.normal), F::splat(inverse_h), F::splat(0), {}, 0);
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
void relax2(SolverBody<Dim2>* bodies, void* blocks, void* extra, int begin, int end, float inverse_h) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim2, W>& c = static_cast<ContactBlock<Dim2, W>*>(blocks)[k];
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity2<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const F ma = F::load(c.inverse_mass_a), mb = F::load(c.inverse_mass_b);
    const F ia = F::load(c.inverse_inertia_a), ib = F::load(c.inverse_inertia_b);
    const WideVec2<W> n = load2<W>(c.normal);
    const WideVec2<W> t = {F::splat(0) - n.y, n.x};
    auto rubs = WideMask<W>::all();
    if (const auto pushed = F::load(c.struck) >= F::splat(block_pushed); any(pushed)) [[unlikely]] {
      const auto shared = share_blow<W, false>(bodies, c, a, b, pushed, inverse_h, 0, {}, 0);
      a = shared.a, b = shared.b;
    }
    F load = F::load(c.point[0].impulse) + F::load(c.point[1].impulse);
    for (bool struck = false;; struck = true) {  // a blow that falls only here rubs too, as in relax3
      if (extra != nullptr) {
        ContactExtra<Dim2, W>& e = static_cast<ContactExtra<Dim2, W>*>(extra)[k];
        const F old = F::load(e.rolling_impulse[0]), limit = F::load(e.rolling_lever) * load;
        const F lambda =
            select(rubs, clamp(old - F::load(e.rolling_mass) * (b.w - a.w), F::splat(0) - limit, limit), old);
        lambda.store(e.rolling_impulse[0]);
        a.w -= ia * (lambda - old);
        b.w += ib * (lambda - old);
      }
      {
        WideVec2<W> ra = load2<W>(c.patch_r_a), rb = add(ra, load2<W>(c.center_offset));
        if (struck) {  // where the surfaces meet now, both arms reach there
          F pa[4], pb[4];
          gather<W>(bodies, slots_a.of, 4, pa);
          gather<W>(bodies, slots_b.of, 4, pb);
          const F apart = F::splat(0.5f) * (n.x * (pb[0] - pa[0]) + n.y * (pb[1] - pa[1]));
          ra = {ra.x + apart * n.x, ra.y + apart * n.y};
          rb = {rb.x - apart * n.x, rb.y - apart * n.y};
        }
        const F turn_a = cross(ra, t), turn_b = cross(rb, t);
        F mass = F::load(c.tangent_mass);
        // They may be far longer than those of the step's start, of which tangent_mass tells.
        if (struck) mass = inverse_or_zero(F::splat(1), ma + mb + ia * turn_a * turn_a + ib * turn_b * turn_b);
        const F vt = dot(subtract(b.v, a.v), t) + b.w * turn_b - a.w * turn_a;
        const F old = F::load(c.tangent_impulse), limit = F::load(c.friction) * load;
        const F wanted = old - mass * (vt - F::load(c.tangent_target));
        const F lambda = select(rubs, clamp(wanted, F::splat(0) - limit, limit), old);
        const F delta = lambda - old;
        lambda.store(c.tangent_impulse);
        const WideVec2<W> p = {delta * t.x, delta * t.y};
        push_back(a, ma, ia, p, delta * turn_a);
        push(b, mb, ib, p, delta * turn_b);
      }
      if (struck) break;
      const PassBlow<W, 2> normals = solve_normals2<W, NormalPass::relax>(bodies, slots_a, slots_b, c, a, b, n,
                                                                          F::splat(inverse_h), F::splat(0), {}, 0);
      const auto hard = find_struck(c, normals, WideMask<W>::all());
      if (any(hard)) [[unlikely]] {
        const auto shared = share_blow<W, false>(bodies, c, a, b, hard, inverse_h, 0, {}, 1);
        a = shared.a, b = shared.b;
      }
      const F before = load;
      load = F::load(c.point[0].impulse) + F::load(c.point[1].impulse);
      rubs = (load - before) * (ma + mb) > F::splat(least_blow);
      if (!any(rubs)) break;
    }
    (F::load(c.tangent_total) + F::load(c.tangent_impulse)).store(c.tangent_total);
    write_velocity<W>(bodies, c.body_a, a);
    write_velocity<W>(bodies, c.body_b, b);
  }
}

template <int W>
void restitute2(SolverBody<Dim2>* bodies, void* blocks, const void* extra, int begin, int end) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim2, W>& c = static_cast<ContactBlock<Dim2, W>*>(blocks)[k];
    const ContactExtra<Dim2, W>& e = static_cast<const ContactExtra<Dim2, W>*>(extra)[k];
    const F zero = F::splat(0);
    if (!any(max(F::load(e.bounce_speed[0]), F::load(e.bounce_speed[1])) > zero)) continue;
    const Slots<W> slots_a(c.body_a), slots_b(c.body_b);
    Velocity2<W> a = read_velocity<W>(bodies, slots_a.of), b = read_velocity<W>(bodies, slots_b.of);
    const F ma = F::load(c.inverse_mass_a), mb = F::load(c.inverse_mass_b);
    const F ia = F::load(c.inverse_inertia_a), ib = F::load(c.inverse_inertia_b);
    const WideVec2<W> n = load2<W>(c.normal);
    const WideVec2<W> offset = load2<W>(c.center_offset);
    const F offset_turn = cross(offset, n);
    F pa[4], pb[4];
    gather<W>(bodies, slots_a.of, 4, pa);
    gather<W>(bodies, slots_b.of, 4, pb);
    const F shift = n.x * (pb[0] - pa[0]) + n.y * (pb[1] - pa[1]);
    const WideVec2<W> na = turned_back_change<W>(pa, n), nb = turned_back_change<W>(pb, n);
    const F acceleration = F::load(e.closing_acceleration) + F::load(e.closing_acceleration);
    // Where one point of a face struck, those beside it did too, though the solver may have found that its neighbours
    // carry the blow for it.
    F struck = zero;
    for (int i = 0; i < 2; ++i) struck += F::load(c.point[i].total);
    const F reach = F::splat(2e-3f);
    // The points of a face push each other back: repeat until they agree.
    auto changes = WideMask<W>::none();
    for (int pass = 0; pass < 16; ++pass) {
      const int i = pass % 2;
      if (i == 0) {
        if (pass > 0 && !any(changes)) break;
        changes = WideMask<W>::none();
      }
      auto& point = c.point[i];
      const F full = F::load(e.bounce_speed[i]), total = F::load(point.total), old = F::load(point.impulse);
      const WideVec2<W> ra = load2<W>(point.r_a);
      const F s = F::load(point.separation) + shift + (dot(nb, add(ra, offset)) - dot(na, ra));
      // Still s above the surface, the body has the energy of falling through it left.
      const F speed = sqrt(max(full * full - acceleration * max(s, zero), zero));
      const F turn_a = cross(ra, n), turn_b = turn_a + offset_turn;
      const F vn = dot(subtract(b.v, a.v), n) + b.w * turn_b - a.w * turn_a;
      const F lambda = max(old - F::load(point.normal_mass) * (vn - speed), zero);
      const F delta = keep((full > zero) & ((total > zero) | ((struck > zero) & (s < reach))), lambda - old);
      changes = changes | !(delta == zero);
      (old + delta).store(point.impulse);
      (total + delta).store(point.total);
      const WideVec2<W> p = {delta * n.x, delta * n.y};
      push_back(a, ma, ia, p, delta * turn_a);
      push(b, mb, ib, p, delta * turn_b);
    }
    // The blow presses the surfaces together: friction of the whole step stays within the cone of its whole load. It
    // acts where the surfaces meet; the points were foreseen half a gap before that.
    const F total0 = F::load(c.point[0].total), total1 = F::load(c.point[1].total), load = total0 + total1;
    const F bounced =
        max(keep(total0 > zero, F::load(e.bounce_speed[0])), keep(total1 > zero, F::load(e.bounce_speed[1])));
    const F gap =
        F::splat(0.5f) *
        (total0 * max(F::load(c.point[0].separation), zero) + total1 * max(F::load(c.point[1].separation), zero)) /
        max(load, F::splat(1e-30f));
    const WideVec2<W> t = {zero - n.y, n.x}, middle = load2<W>(c.patch_r_a), to_surface = {n.x * gap, n.y * gap};
    const WideVec2<W> ra = subtract(middle, to_surface), rb = add(add(middle, offset), to_surface);
    const F turn_a = cross(ra, t), turn_b = cross(rb, t), limit = F::load(c.friction) * load;
    const F mass = inverse_or_zero(F::splat(1), ma + mb + ia * turn_a * turn_a + ib * turn_b * turn_b);
    const F slip = dot(subtract(b.v, a.v), t) + b.w * turn_b - a.w * turn_a - F::load(c.tangent_target);
    const F old = F::load(c.tangent_total);
    const F lambda = clamp(old - mass * slip, zero - limit, limit);
    const F delta = keep(bounced > zero, lambda - old);
    (old + delta).store(c.tangent_total);
    (F::load(c.tangent_impulse) + delta).store(c.tangent_impulse);
    const WideVec2<W> p = {delta * t.x, delta * t.y};
    push_back(a, ma, ia, p, delta * turn_a);
    push(b, mb, ib, p, delta * turn_b);
    write_velocity<W>(bodies, c.body_a, a);
    write_velocity<W>(bodies, c.body_b, b);
  }
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
