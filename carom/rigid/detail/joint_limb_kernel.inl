// The inner loops of limbs (joint_limb_lanes.h), after joint_kernel.inl and in its namespace. What is solved, and in
// which order: the blocks of joint_blocks.h and joint_axis.h (friction, cone, twist, spring, hinge rows, pin). What
// follows from where the bodies are is made once a substep, in the relaxing pass, for the next substep too.

namespace carom::rigid::detail::CAROM_PIN_NAMESPACE {

template <int W>
CAROM_SIMD_INLINE WideFloat<W> dot(const Lanes<3, W>& a, const Lanes<3, W>& b) {
  return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2];
}
/// atan2 to 2·10⁻⁷: the even polynomial interpolates atan(√s)/√s at the Chebyshev nodes of [0, 1].
template <int W>
CAROM_SIMD_INLINE WideFloat<W> arc(WideFloat<W> y, WideFloat<W> x) {
  using F = WideFloat<W>;
  const F ax = abs(x), ay = abs(y), large = max(ax, ay), small = min(ax, ay);
  const F a = small * reciprocal_above(large, F::zero()), s = a * a;
  constexpr float c[] = {1.0f,
                         -0.33333036303520203f,
                         0.1999187171459198f,
                         -0.14197798073291779f,
                         0.10618370771408081f,
                         -0.07456854730844498f,
                         0.04213762283325195f,
                         -0.015731249004602432f,
                         0.0027662834618240595f};
  F p = F::splat(c[8]);
  for (int i = 7; i >= 0; --i) p = p * s + F::splat(c[i]);
  p = p * a;
  p = select(ay > ax, F::splat(1.57079632679489662f) - p, p);
  p = select(x < F::zero(), F::splat(3.14159265358979324f) - p, p);
  return copysign(p, y);
}
/// Brought into [−π, π].
template <int W>
CAROM_SIMD_INLINE WideFloat<W> wrapped(WideFloat<W> x) {
  using F = WideFloat<W>;
  const F turns = x * F::splat(0.159154943091895336f);
  const F whole = to_float(to_int(turns + copysign(F::splat(0.5f), turns)));
  return x - whole * F::splat(6.28318530717958648f);
}

// Stops and laws ------------------------------------------------------------------------------------------------------
/// Returns the change of impulse, ≥ 0 in sum, of a stop that is approached at −v.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> hold_stop(StopLanes<W>& stop, WideFloat<W> mass, WideFloat<W> v, const LimbPass& pass,
                                         bool biased) {
  using F = WideFloat<W>;
  const F gap = F::load_aligned(stop.gap), old = F::load_aligned(stop.impulse);
  const F ahead = old - mass * (v + gap * F::splat(pass.inverse_h));
  const F inside =
      biased ? old - mass * (F::splat(pass.velocity) * v + F::splat(pass.position) * gap) - F::splat(pass.memory) * old
             : old - mass * v;
  const F next = max(select(gap > F::zero(), ahead, inside), F::zero());
  next.store_aligned(stop.impulse);
  return next - old;
}
/// Returns the impulse to add; v is the angle's rate.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> hold_law(LawLanes<W>& law, WideFloat<W> v, const LimbPass& pass, bool biased) {
  using F = WideFloat<W>;
  const F mass = F::load_aligned(law.axis_mass), mobility = F::load_aligned(law.axis_mobility);
  F sum = F::zero();
  if (biased) {
    const F old = F::load_aligned(law.spring);
    const F residual = F::load_aligned(law.velocity) * v + F::load_aligned(law.position) * F::load_aligned(law.error) +
                       F::load_aligned(law.previous) * F::load_aligned(law.before);
    F change = F::zero() - mass * residual - F::load_aligned(law.memory) * old;
    const F next = old + change, most = F::load_aligned(law.max_spring);
    const F bounded = clamp(next, F::zero() - most, most);
    change = select(abs(next) > most, bounded - old, change);
    bounded.store_aligned(law.spring);
    v += mobility * change;
    sum += change;
  } else {
    v.store_aligned(law.before);
  }
  const F old = F::load_aligned(law.motor), most = F::load_aligned(law.max_motor);
  const F motor = clamp(old - mass * (v - F::load_aligned(law.speed)), F::zero() - most, most);
  motor.store_aligned(law.motor);
  v += mobility * (motor - old);
  sum += motor - old;
  const F up = hold_stop(law.lower, mass, v, pass, biased);
  v += mobility * up;
  sum += up;
  return sum - hold_stop(law.upper, mass, F::zero() - v, pass, biased);
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> law_total(const LawLanes<W>& law) {
  using F = WideFloat<W>;
  return F::load_aligned(law.spring) + F::load_aligned(law.motor) + F::load_aligned(law.lower.impulse) -
         F::load_aligned(law.upper.impulse);
}
template <int W>
CAROM_SIMD_INLINE void place_law(LawLanes<W>& law, WideFloat<W> angle, WideFloat<W> mobility) {
  using F = WideFloat<W>;
  mobility.store_aligned(law.axis_mobility);
  reciprocal_above(mobility, F::zero()).store_aligned(law.axis_mass);
  wrapped(angle - F::load_aligned(law.rest)).store_aligned(law.error);
  const F low = F::load_aligned(law.low), high = F::load_aligned(law.high);
  const F middle = F::splat(0.5f) * (low + high);
  const F x = middle + wrapped(angle - middle);  // the turn nearest to the permitted range
  (x - low).store_aligned(law.lower.gap);
  (high - x).store_aligned(law.upper.gap);
}

/// mass_ratio_root, of a mobility and what the anchors take from it.
template <class D, int W>
CAROM_SIMD_INLINE void store_stiffness(WideFloat<W> mobility, WideFloat<W> taken, LimbRaw<D, W>& raw) {
  using F = WideFloat<W>;
  const auto moves = mobility > F::zero();
  const F row = select(moves, mobility, F::splat(1));
  select(moves, sqrt(row / max(row - taken, F::splat(0.01f) * row)), F::splat(1)).store_aligned(raw.stiffer);
}

// The plane -----------------------------------------------------------------------------------------------------------
template <int W>
struct Placement2 {
  Lanes<2, W> moved, turn;
};
template <int W>
CAROM_SIMD_INLINE Placement2<W> read_placement(const SolverBody<Dim2>* bodies, const std::int32_t* index) {
  WideFloat<W> c[4];
  gather_part<4, 4, 8, W>(reinterpret_cast<const float*>(bodies), index, unmoved.plane, c);
  return {{{c[0], c[1]}}, {{c[2], c[3]}}};
}
template <int W>
CAROM_SIMD_INLINE void place(LimbLanes<Dim2, W>& c, const Placement2<W>& a, const Placement2<W>& b) {
  using F = WideFloat<W>;
  const auto arm_a = turned(a.turn, load(c.arm_a)), reach_b = turned(b.turn, load(c.arm_b));
  const auto reach_a = add(add(load(c.offset), subtract(b.moved, a.moved)), reach_b);
  store(reach_a, c.reach_a);
  store(reach_b, c.reach_b);
  store(subtract(reach_a, arm_a), c.error);
  const F ia = F::load_aligned(c.inverse_inertia_a), ib = F::load_aligned(c.inverse_inertia_b);
  store(factorise(reach_a, reach_b, F::load_aligned(c.inverse_mass_a) + F::load_aligned(c.inverse_mass_b), ia, ib),
        c.factor);
  const Lanes<2, W> back = {{a.turn.v[0], F::zero() - a.turn.v[1]}};
  const auto q = turned(back, turned(b.turn, load(c.frame)));
  place_law(c.law, arc(q.v[1], q.v[0]), ia + ib);
}
template <int W>
CAROM_SIMD_INLINE void turn_frames(LimbLanes<Dim2, W>& c, const LimbRaw<Dim2, W>& raw) {
  const auto qa = load_turn(raw.turns.a), qb = load_turn(raw.turns.b);
  store(turned(qa, load(c.arm_a)), c.arm_a);
  store(turned(qb, load(c.arm_b)), c.arm_b);
  const auto fa = turned(qa, load(raw.frame_a)), fb = turned(qb, load(raw.frame_b));
  store(turned(Lanes<2, W>{{fa.v[0], WideFloat<W>::zero() - fa.v[1]}}, fb), c.frame);
}
template <int W>
CAROM_SIMD_INLINE void note_spin(LimbLanes<Dim2, W>& c, const Lanes<1, W>& spin) {
  spin.v[0].store_aligned(c.law.before);
}
template <int W>
CAROM_SIMD_INLINE void find_stiffness(const LimbLanes<Dim2, W>& c, LimbRaw<Dim2, W>& raw) {
  using F = WideFloat<W>;
  const Lanes<1, W> ia = {{F::load_aligned(c.inverse_inertia_a)}}, ib = {{F::load_aligned(c.inverse_inertia_b)}};
  const auto anchors = add(cross(ib, load(c.reach_b)), cross(ia, load(c.reach_a)));
  const auto held = solve_factor(load(c.factor), anchors);
  store_stiffness(F::load_aligned(c.law.axis_mobility), anchors.v[0] * held.v[0] + anchors.v[1] * held.v[1], raw);
}
template <int W>
CAROM_SIMD_INLINE void solve_limb(LimbLanes<Dim2, W>& c, Motion2<W>& a, Motion2<W>& b, const LimbPass& pass,
                                  bool biased) {
  using F = WideFloat<W>;
  const F ma = F::load_aligned(c.inverse_mass_a), mb = F::load_aligned(c.inverse_mass_b);
  const F ia = F::load_aligned(c.inverse_inertia_a), ib = F::load_aligned(c.inverse_inertia_b);
  const F twist = hold_law(c.law, b.w.v[0] - a.w.v[0], pass, biased);
  a.w.v[0] -= ia * twist;
  b.w.v[0] += ib * twist;
  const auto reach_a = load(c.reach_a), reach_b = load(c.reach_b), old = load(c.impulse);
  const auto rate = subtract(add(b.v, cross(b.w, reach_b)), add(a.v, cross(a.w, reach_a)));
  auto change = rate;
  if (biased) {
    const auto residual =
        add(multiply(rate, F::splat(pass.velocity)), multiply(load(c.error), F::splat(pass.position)));
    change = add(solve_factor(load(c.factor), residual), multiply(old, F::splat(pass.memory)));
  } else {
    change = solve_factor(load(c.factor), rate);
  }
  store(subtract(old, change), c.impulse);
  push(b, a, mb, ma, ib, ia, change, reach_b, reach_a);  // the change is taken off: A gains what B loses
}
template <int W>
CAROM_SIMD_INLINE void warm_start_limb(const LimbLanes<Dim2, W>& c, Motion2<W>& a, Motion2<W>& b) {
  using F = WideFloat<W>;
  const F ia = F::load_aligned(c.inverse_inertia_a), ib = F::load_aligned(c.inverse_inertia_b);
  const F twist = F::load_aligned(c.turn_impulse);
  push(a, b, F::load_aligned(c.inverse_mass_a), F::load_aligned(c.inverse_mass_b), ia, ib, load(c.impulse),
       load(c.reach_a), load(c.reach_b));
  a.w.v[0] -= ia * twist;
  b.w.v[0] += ib * twist;
}
template <int W>
CAROM_SIMD_INLINE void sum_turns(LimbLanes<Dim2, W>& c) {
  law_total(c.law).store_aligned(c.turn_impulse);
}

// Space ---------------------------------------------------------------------------------------------------------------
template <int W>
struct Placement3 {
  Lanes<3, W> moved;
  Turn<W> turn;
};
template <int W>
CAROM_SIMD_INLINE Placement3<W> read_placement(const SolverBody<Dim3>* bodies, const std::int32_t* index) {
  WideFloat<W> c[8];
  gather_part<8, 8, 16, W>(reinterpret_cast<const float*>(bodies), index, unmoved.space, c);
  return {{{c[0], c[1], c[2]}}, {c[4], {{c[5], c[6], c[7]}}}};
}
template <int W>
CAROM_SIMD_INLINE Turn<W> product(const Turn<W>& p, const Turn<W>& q) {
  return {p.w * q.w - dot(p.u, q.u), add(add(multiply(q.u, p.w), multiply(p.u, q.w)), cross(p.u, q.u))};
}
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> axis_x(const Turn<W>& q) {
  using F = WideFloat<W>;
  const F two = F::splat(2), &x = q.u.v[0], &y = q.u.v[1], &z = q.u.v[2];
  return {{F::splat(1) - two * (y * y + z * z), two * (x * y + q.w * z), two * (x * z - q.w * y)}};
}
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> axis_y(const Turn<W>& q) {
  using F = WideFloat<W>;
  const F two = F::splat(2), &x = q.u.v[0], &y = q.u.v[1], &z = q.u.v[2];
  return {{two * (x * y - q.w * z), F::splat(1) - two * (x * x + z * z), two * (y * z + q.w * x)}};
}
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> axis_z(const Turn<W>& q) {
  using F = WideFloat<W>;
  const F two = F::splat(2), &x = q.u.v[0], &y = q.u.v[1], &z = q.u.v[2];
  return {{two * (x * z + q.w * y), two * (y * z - q.w * x), F::splat(1) - two * (x * x + y * y)}};
}
/// Symmetric tensors: xx, xy, xz, yy, yz, zz.
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> times(const Lanes<6, W>& t, const Lanes<3, W>& r) {
  return {{t.v[0] * r.v[0] + t.v[1] * r.v[1] + t.v[2] * r.v[2], t.v[1] * r.v[0] + t.v[3] * r.v[1] + t.v[4] * r.v[2],
           t.v[2] * r.v[0] + t.v[4] * r.v[1] + t.v[5] * r.v[2]}};
}
template <int W>
CAROM_SIMD_INLINE Lanes<6, W> turned_tensor(const Turn<W>& q, const Lanes<6, W>& t) {
  const Lanes<3, W> x = axis_x(q), y = axis_y(q), z = axis_z(q);  // R's columns
  const Lanes<3, W> row[3] = {{{x.v[0], y.v[0], z.v[0]}}, {{x.v[1], y.v[1], z.v[1]}}, {{x.v[2], y.v[2], z.v[2]}}};
  const Lanes<3, W> t0 = times(t, row[0]), t1 = times(t, row[1]), t2 = times(t, row[2]);
  return {{dot(row[0], t0), dot(row[0], t1), dot(row[0], t2), dot(row[1], t1), dot(row[1], t2), dot(row[2], t2)}};
}
/// LDLᵀ of a symmetric matrix, as `factorise`.
template <int W>
CAROM_SIMD_INLINE Lanes<6, W> factorise(const Lanes<6, W>& k) {
  using F = WideFloat<W>;
  const F small = F::splat(1e-7f);
  const F i1 = reciprocal_above(k.v[0], F::zero()), l21 = k.v[1] * i1, l31 = k.v[2] * i1;
  const F i2 = reciprocal_above(k.v[3] - l21 * k.v[1], small * k.v[3]);
  const F u32 = k.v[4] - l31 * k.v[1], l32 = u32 * i2;
  const F i3 = reciprocal_above(k.v[5] - l31 * k.v[2] - l32 * u32, small * k.v[5]);
  return {{i1, i2, i3, l21, l31, l32}};
}
/// Adds [r]× I [r]×ᵀ.
template <int W>
CAROM_SIMD_INLINE Lanes<6, W> add_mobility(const Lanes<6, W>& k, const Lanes<3, W>& r, const Lanes<6, W>& t) {
  const Lanes<3, W> x = cross(r, Lanes<3, W>{{t.v[0], t.v[1], t.v[2]}}),
                    y = cross(r, Lanes<3, W>{{t.v[1], t.v[3], t.v[4]}}),
                    z = cross(r, Lanes<3, W>{{t.v[2], t.v[4], t.v[5]}});
  const Lanes<3, W> k0 = cross(r, Lanes<3, W>{{x.v[0], y.v[0], z.v[0]}}),
                    k1 = cross(r, Lanes<3, W>{{x.v[1], y.v[1], z.v[1]}}),
                    k2 = cross(r, Lanes<3, W>{{x.v[2], y.v[2], z.v[2]}});
  return add(k, Lanes<6, W>{{k0.v[0], k0.v[1], k0.v[2], k1.v[1], k1.v[2], k2.v[2]}});
}

template <int W>
CAROM_SIMD_INLINE void place_pin(LimbLanes<Dim3, W>& c, const Placement3<W>& a, const Placement3<W>& b,
                                 const Lanes<6, W>& ta, const Lanes<6, W>& tb) {
  using F = WideFloat<W>;
  const auto arm_a = turned(a.turn, load(c.arm_a)), reach_b = turned(b.turn, load(c.arm_b));
  const auto reach_a = add(add(load(c.offset), subtract(b.moved, a.moved)), reach_b);
  store(reach_a, c.reach_a);
  store(reach_b, c.reach_b);
  store(subtract(reach_a, arm_a), c.error);
  const F m = F::load_aligned(c.inverse_mass_a) + F::load_aligned(c.inverse_mass_b);
  const Lanes<6, W> k = {{m, F::zero(), F::zero(), m, F::zero(), m}};
  store(factorise(add_mobility(add_mobility(k, reach_a, ta), reach_b, tb)), c.factor);
}
template <int W>
CAROM_SIMD_INLINE void place_hinge(LimbLanes<Dim3, W>& c, const Turn<W>& a, const Lanes<3, W>& z,
                                   const Lanes<6, W>& t) {
  using F = WideFloat<W>;
  const Lanes<3, W> x = axis_x(a), y = axis_y(a), u = cross(z, x), v = cross(z, y);
  store(u, c.hinge_u);
  store(v, c.hinge_v);
  const Lanes<2, W> error = {{dot(z, x), dot(z, y)}};
  const F sine = sqrt(error.v[0] * error.v[0] + error.v[1] * error.v[1]);
  const F more = (F::splat(2) - sine) * reciprocal_above(sine, F::splat(1e-3f));
  store(multiply(error, select((dot(z, axis_z(a)) < F::zero()) & (sine > F::splat(1e-3f)), more, F::splat(1))),
        c.hinge_error);
  const Lanes<3, W> ku = times(t, u), kv = times(t, v);
  const F k11 = dot(u, ku), k12 = dot(u, kv), k22 = dot(v, kv);
  const F i1 = reciprocal_above(k11, F::zero()), l21 = k12 * i1;
  store(Lanes<3, W>{{i1, reciprocal_above(k22 - l21 * k12, F::splat(1e-7f) * k22), l21}}, c.hinge_factor);
}
template <int W>
CAROM_SIMD_INLINE void place_cone(LimbLanes<Dim3, W>& c, const Turn<W>& a, const Lanes<3, W>& za, const Lanes<3, W>& zb,
                                  const Lanes<6, W>& t) {
  using F = WideFloat<W>;
  const Lanes<3, W> u = cross(za, zb);
  const F sine = sqrt(dot(u, u));
  const auto bent = sine > F::splat(1e-6f);
  const Lanes<3, W> along = multiply(u, F::splat(1) / select(bent, sine, F::splat(1))), x = axis_x(a);
  const Lanes<3, W> n = {
      {select(bent, along.v[0], x.v[0]), select(bent, along.v[1], x.v[1]), select(bent, along.v[2], x.v[2])}};
  store(n, c.cone_axis);
  reciprocal_above(dot(n, times(t, n)), F::zero()).store_aligned(c.cone_mass);
  (F::load_aligned(c.cone_angle) - arc(sine, dot(za, zb))).store_aligned(c.cone.gap);
}
template <int W>
CAROM_SIMD_INLINE void place_attitude(LimbLanes<Dim3, W>& c, const Turn<W>& a, const Turn<W>& b) {
  using F = WideFloat<W>;
  Turn<W> q = product(b, Turn<W>{a.w, multiply(a.u, F::splat(-1))});
  const F sign = copysign(F::splat(1), q.w);
  q = {q.w * sign, multiply(q.u, sign)};
  const F s2 = dot(q.u, q.u), s = sqrt(s2);
  const auto small = s2 < F::splat(0.01f);
  const F series = F::splat(2) + s2 * (F::splat(1.0f / 3) + s2 * F::splat(0.15f));  // 2 asin(s)/s
  const F scale = F::splat(2) * arc(s, q.w) / select(small, F::splat(1), s);
  store(multiply(q.u, select(small, series, scale)), c.attitude);
}
/// Of all rows about axes.
template <int W>
CAROM_SIMD_INLINE void sum_turns(LimbLanes<Dim3, W>& c) {
  using F = WideFloat<W>;
  Lanes<3, W> sum = {{F::zero(), F::zero(), F::zero()}};
  if (c.parts & part_friction) sum = add(sum, load(c.friction));
  if (c.parts & part_cone) sum = subtract(sum, multiply(load(c.cone_axis), F::load_aligned(c.cone.impulse)));
  if (c.parts & part_twist) sum = add(sum, multiply(load(c.twist_axis), law_total(c.law)));
  if (c.parts & part_angular) sum = add(sum, load(c.spring));
  if (c.parts & part_hinge)
    sum = add(sum, add(multiply(load(c.hinge_u), F::load_aligned(c.hinge[0])),
                       multiply(load(c.hinge_v), F::load_aligned(c.hinge[1]))));
  store(sum, c.turn_impulse);
}
template <int W>
CAROM_SIMD_INLINE void place(LimbLanes<Dim3, W>& c, const Placement3<W>& a, const Placement3<W>& b) {
  using F = WideFloat<W>;
  const Lanes<6, W> ta = turned_tensor(a.turn, load(c.start_tensor_a)),
                    tb = turned_tensor(b.turn, load(c.start_tensor_b));
  store(ta, c.tensor_a);
  store(tb, c.tensor_b);
  place_pin(c, a, b, ta, tb);
  if (c.parts == part_pin) return;
  const Lanes<6, W> both = add(ta, tb);
  if (c.parts & (part_friction | part_angular)) store(factorise(both), c.turn_factor);
  const Turn<W> qa = product(a.turn, load_turn(c.frame_a)), qb = product(b.turn, load_turn(c.frame_b));
  const Lanes<3, W> za = axis_z(qa), zb = axis_z(qb);
  if (c.parts & part_cone) place_cone(c, qa, za, zb, both);
  if (c.parts & part_twist) {
    const Turn<W> q = product(Turn<W>{qa.w, multiply(qa.u, F::splat(-1))}, qb);
    const F sign = copysign(F::splat(1), q.w);
    const Lanes<3, W> n = multiply(add(za, zb), reciprocal_above(F::splat(1) + dot(za, zb), F::splat(0.02f)));
    store(n, c.twist_axis);
    place_law(c.law, F::splat(2) * arc(q.u.v[2] * sign, q.w * sign), dot(n, times(both, n)));
  }
  if (c.parts & part_angular) place_attitude(c, c.parts & limb_is_aimed ? product(qa, load_turn(c.aim)) : qa, qb);
  if (c.parts & part_hinge) place_hinge(c, qa, zb, both);
}

template <int W>
CAROM_SIMD_INLINE void store_turn(const Turn<W>& q, float (&p)[4][W]) {
  q.w.store_aligned(p[0]);
  for (int i = 0; i < 3; ++i) q.u.v[i].store_aligned(p[i + 1]);
}
template <int W>
CAROM_SIMD_INLINE void turn_frames(LimbLanes<Dim3, W>& c, const LimbRaw<Dim3, W>& raw) {
  const Turn<W> a = load_turn(raw.turns.a), b = load_turn(raw.turns.b);
  store(turned(a, load(c.arm_a)), c.arm_a);
  store(turned(b, load(c.arm_b)), c.arm_b);
  if (c.parts == part_pin) return;
  store_turn(product(a, load_turn(c.frame_a)), c.frame_a);
  store_turn(product(b, load_turn(c.frame_b)), c.frame_b);
}
template <int W>
CAROM_SIMD_INLINE void note_spin(LimbLanes<Dim3, W>& c, const Lanes<3, W>& spin) {
  if (c.parts & part_twist) dot(load(c.twist_axis), spin).store_aligned(c.law.before);
  if (c.parts & part_angular) store(spin, c.before);
}
template <int W>
CAROM_SIMD_INLINE void find_stiffness(const LimbLanes<Dim3, W>& c, LimbRaw<Dim3, W>& raw) {
  const Lanes<3, W> n = load(c.twist_axis);
  const Lanes<3, W> anchors =
      add(cross(times(load(c.tensor_b), n), load(c.reach_b)), cross(times(load(c.tensor_a), n), load(c.reach_a)));
  const Lanes<3, W> held = solve_factor(load(c.factor), anchors);
  store_stiffness(WideFloat<W>::load_aligned(c.law.axis_mobility), dot(anchors, held), raw);
}

template <int W>
struct LimbMotion3 {
  Motion3<W> a, b;
  Lanes<6, W> ta, tb;
  CAROM_SIMD_INLINE Lanes<3, W> spin() const { return subtract(b.w, a.w); }
  CAROM_SIMD_INLINE void turn(const Lanes<3, W>& impulse) {
    a.w = subtract(a.w, times(ta, impulse));
    b.w = add(b.w, times(tb, impulse));
  }
  CAROM_SIMD_INLINE void push(const Lanes<3, W>& impulse, const Lanes<3, W>& reach_a, const Lanes<3, W>& reach_b,
                              WideFloat<W> ma, WideFloat<W> mb) {
    a.v = subtract(a.v, multiply(impulse, ma));
    a.w = subtract(a.w, times(ta, cross(reach_a, impulse)));
    b.v = add(b.v, multiply(impulse, mb));
    b.w = add(b.w, times(tb, cross(reach_b, impulse)));
  }
};
template <int W>
CAROM_SIMD_INLINE void rub(LimbLanes<Dim3, W>& c, LimbMotion3<W>& m) {
  using F = WideFloat<W>;
  const Lanes<3, W> old = load(c.friction);
  Lanes<3, W> next = subtract(old, solve_factor(load(c.turn_factor), m.spin()));
  const F size = sqrt(dot(next, next)), limit = F::load_aligned(c.max_friction);
  const auto slips = size > limit;
  next = multiply(next, select(slips, limit / select(slips, size, F::splat(1)), F::splat(1)));
  store(next, c.friction);
  m.turn(subtract(next, old));
}
template <int W>
CAROM_SIMD_INLINE void pull_straight(LimbLanes<Dim3, W>& c, LimbMotion3<W>& m, const LimbPass& pass, bool biased) {
  using F = WideFloat<W>;
  const Lanes<3, W> spin = m.spin(), old = load(c.spring);
  const bool stiff = (c.parts & limb_is_stiff) != 0;
  if (!biased && !stiff) return store(spin, c.before);
  Lanes<3, W> next = old;
  if (!biased) {
    next = subtract(old, solve_factor(load(c.turn_factor), spin));
  } else {
    const F velocity = stiff ? F::splat(pass.velocity) : F::load_aligned(c.velocity);
    const F position = stiff ? F::splat(pass.position) : F::load_aligned(c.position);
    const F memory = stiff ? F::splat(pass.memory) : F::load_aligned(c.memory);
    Lanes<3, W> residual = add(multiply(spin, velocity), multiply(load(c.attitude), position));
    if (!stiff) residual = add(residual, multiply(load(c.before), F::load_aligned(c.previous)));
    next = subtract(subtract(old, solve_factor(load(c.turn_factor), residual)), multiply(old, memory));
  }
  store(next, c.spring);
  m.turn(subtract(next, old));
}
template <int W>
CAROM_SIMD_INLINE void keep_parallel(LimbLanes<Dim3, W>& c, LimbMotion3<W>& m, const LimbPass& pass, bool biased) {
  using F = WideFloat<W>;
  const Lanes<3, W> u = load(c.hinge_u), v = load(c.hinge_v), spin = m.spin();
  const Lanes<2, W> rate = {{dot(u, spin), dot(v, spin)}}, old = load(c.hinge);
  Lanes<2, W> change = rate;
  if (biased) {
    const Lanes<2, W> residual =
        add(multiply(rate, F::splat(pass.velocity)), multiply(load(c.hinge_error), F::splat(pass.position)));
    change = add(solve_factor(load(c.hinge_factor), residual), multiply(old, F::splat(pass.memory)));
  } else {
    change = solve_factor(load(c.hinge_factor), rate);
  }
  store(subtract(old, change), c.hinge);
  m.turn(multiply(add(multiply(u, change.v[0]), multiply(v, change.v[1])), F::splat(-1)));
}
template <int W>
CAROM_SIMD_INLINE void solve_limb(LimbLanes<Dim3, W>& c, Motion3<W>& a, Motion3<W>& b, const LimbPass& pass,
                                  bool biased) {
  using F = WideFloat<W>;
  LimbMotion3<W> m = {a, b, load(c.tensor_a), load(c.tensor_b)};
  if (c.parts & part_friction) rub(c, m);
  if (c.parts & part_cone) {
    const Lanes<3, W> n = load(c.cone_axis);
    const F back = hold_stop(c.cone, F::load_aligned(c.cone_mass), F::zero() - dot(n, m.spin()), pass, biased);
    m.turn(multiply(n, F::zero() - back));
  }
  if (c.parts & part_twist) {
    const Lanes<3, W> n = load(c.twist_axis);
    m.turn(multiply(n, hold_law(c.law, dot(n, m.spin()), pass, biased)));
  }
  if (c.parts & part_angular) pull_straight(c, m, pass, biased);
  if (c.parts & part_hinge) keep_parallel(c, m, pass, biased);

  const auto reach_a = load(c.reach_a), reach_b = load(c.reach_b), old = load(c.impulse);
  const auto rate = subtract(add(m.b.v, cross(m.b.w, reach_b)), add(m.a.v, cross(m.a.w, reach_a)));
  Lanes<3, W> change = rate;
  if (biased) {
    const auto residual =
        add(multiply(rate, F::splat(pass.velocity)), multiply(load(c.error), F::splat(pass.position)));
    change = add(solve_factor(load(c.factor), residual), multiply(old, F::splat(pass.memory)));
  } else {
    change = solve_factor(load(c.factor), rate);
  }
  store(subtract(old, change), c.impulse);
  m.push(multiply(change, F::splat(-1)), reach_a, reach_b, F::load_aligned(c.inverse_mass_a),
         F::load_aligned(c.inverse_mass_b));
  a = m.a;
  b = m.b;
}
template <int W>
CAROM_SIMD_INLINE void warm_start_limb(const LimbLanes<Dim3, W>& c, Motion3<W>& a, Motion3<W>& b) {
  using F = WideFloat<W>;
  LimbMotion3<W> m = {a, b, load(c.tensor_a), load(c.tensor_b)};
  m.turn(load(c.turn_impulse));
  m.push(load(c.impulse), load(c.reach_a), load(c.reach_b), F::load_aligned(c.inverse_mass_a),
         F::load_aligned(c.inverse_mass_b));
  a = m.a;
  b = m.b;
}

// Both ----------------------------------------------------------------------------------------------------------------
template <class D, int W>
void begin_limbs(const SolverBody<D>* bodies, void* block, void* out) {
  LimbLanes<D, W>& c = *static_cast<LimbLanes<D, W>*>(block);
  LimbRaw<D, W>& raw = *static_cast<LimbRaw<D, W>*>(out);
  turn_frames(c, raw);
  place(c, read_placement<W>(bodies, c.read_a), read_placement<W>(bodies, c.read_b));
  sum_turns(c);
  note_spin(c, subtract(read_motion<W>(bodies, c.read_b).w, read_motion<W>(bodies, c.read_a).w));
  if ((c.parts & part_twist) && (D::dimension == 2 || (c.parts & part_hinge))) find_stiffness(c, raw);
}
template <class D, int W>
void warm_start_limbs(SolverBody<D>* bodies, void* blocks, int begin, int end) {
  for (int k = begin; k < end; ++k) {
    const LimbLanes<D, W>& c = static_cast<const LimbLanes<D, W>*>(blocks)[k];
    auto a = read_motion<W>(bodies, c.read_a), b = read_motion<W>(bodies, c.read_b);
    warm_start_limb(c, a, b);
    write_motion<W>(bodies, c.write_a, a);
    write_motion<W>(bodies, c.write_b, b);
  }
}
template <class D, int W>
void solve_limbs(SolverBody<D>* bodies, void* blocks, int begin, int end, LimbPass pass) {
  for (int k = begin; k < end; ++k) {
    LimbLanes<D, W>& c = static_cast<LimbLanes<D, W>*>(blocks)[k];
    auto a = read_motion<W>(bodies, c.read_a), b = read_motion<W>(bodies, c.read_b);
    solve_limb(c, a, b, pass, true);
    write_motion<W>(bodies, c.write_a, a);
    write_motion<W>(bodies, c.write_b, b);
  }
}
template <class D, int W>
void relax_limbs(SolverBody<D>* bodies, void* blocks, int begin, int end, LimbPass pass) {
  for (int k = begin; k < end; ++k) {
    LimbLanes<D, W>& c = static_cast<LimbLanes<D, W>*>(blocks)[k];
    place(c, read_placement<W>(bodies, c.read_a), read_placement<W>(bodies, c.read_b));
    auto a = read_motion<W>(bodies, c.read_a), b = read_motion<W>(bodies, c.read_b);
    solve_limb(c, a, b, pass, false);
    sum_turns(c);
    write_motion<W>(bodies, c.write_a, a);
    write_motion<W>(bodies, c.write_b, b);
  }
}

}  // namespace carom::rigid::detail::CAROM_PIN_NAMESPACE
