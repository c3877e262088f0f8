// The inner loops of pins, written once over the width. Included by joint_solver_{baseline,avx2,avx512}.cpp, each of
// which defines CAROM_PIN_NAMESPACE and CAROM_PIN_WIDTH. See math/simd.h for the rules a kernel obeys, and PinBlock
// (joint_blocks.h) for what is solved: both bodies take the impulse at B's anchor.

namespace carom::rigid::detail::CAROM_PIN_NAMESPACE {

using namespace math;

template <int N, int W>
struct Lanes {
  WideFloat<W> v[N];
};
template <int N, int W>
CAROM_SIMD_INLINE Lanes<N, W> load(const float (&p)[N][W]) {
  Lanes<N, W> r;
  for (int i = 0; i < N; ++i) r.v[i] = WideFloat<W>::load_aligned(p[i]);
  return r;
}
template <int N, int W>
CAROM_SIMD_INLINE void store(const Lanes<N, W>& a, float (&p)[N][W]) {
  for (int i = 0; i < N; ++i) a.v[i].store_aligned(p[i]);
}
template <int N, int W>
CAROM_SIMD_INLINE Lanes<N, W> add(const Lanes<N, W>& a, const Lanes<N, W>& b) {
  Lanes<N, W> r;
  for (int i = 0; i < N; ++i) r.v[i] = a.v[i] + b.v[i];
  return r;
}
template <int N, int W>
CAROM_SIMD_INLINE Lanes<N, W> subtract(const Lanes<N, W>& a, const Lanes<N, W>& b) {
  Lanes<N, W> r;
  for (int i = 0; i < N; ++i) r.v[i] = a.v[i] - b.v[i];
  return r;
}
template <int N, int W>
CAROM_SIMD_INLINE Lanes<N, W> multiply(const Lanes<N, W>& a, WideFloat<W> s) {
  Lanes<N, W> r;
  for (int i = 0; i < N; ++i) r.v[i] = a.v[i] * s;
  return r;
}
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> cross(const Lanes<3, W>& a, const Lanes<3, W>& b) {
  return {{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2], a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
}
template <int W>
CAROM_SIMD_INLINE Lanes<1, W> cross(const Lanes<2, W>& a, const Lanes<2, W>& b) {
  return {{a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
}
template <int W>
CAROM_SIMD_INLINE Lanes<2, W> cross(const Lanes<1, W>& spin, const Lanes<2, W>& r) {
  return {{WideFloat<W>::zero() - spin.v[0] * r.v[1], spin.v[0] * r.v[0]}};
}
/// 1/k, or 0 where k is no more than `least`.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> reciprocal_above(WideFloat<W> k, WideFloat<W> least) {
  const auto above = k > least;
  const WideFloat<W> one = WideFloat<W>::splat(1);
  return keep(above, one / select(above, k, one));
}

/// What bodies with a negative index read: at rest and not turned.
struct alignas(64) Unmoved {
  float plane[8] = {0, 0, 0, 0, 0, 0, 1, 0};
  float space[16] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0};
};
inline constexpr Unmoved unmoved{};

template <int First, int Columns, int Stride, int W>
CAROM_SIMD_INLINE void gather_part(const float* base, const std::int32_t* index, const float* fallback,
                                   WideFloat<W> (&columns)[Columns]) {
  const float* rows[W];
  simd_detail::unrolled<W>([&](auto lane) __attribute__((always_inline)) {
    constexpr int i = decltype(lane)::value;
    rows[i] = (index[i] >= 0 ? base + static_cast<std::ptrdiff_t>(index[i]) * Stride : fallback) + First;
  });
  gather_rows<Columns, W>(rows, columns);
}

// The plane -----------------------------------------------------------------------------------------------------------
template <int W>
struct Motion2 {
  Lanes<2, W> v;
  Lanes<1, W> w;
};
template <int W>
CAROM_SIMD_INLINE Motion2<W> read_motion(const SolverBody<Dim2>* bodies, const std::int32_t* index) {
  WideFloat<W> c[4];
  gather_part<0, 4, 8, W>(reinterpret_cast<const float*>(bodies), index, unmoved.plane, c);
  return {{{c[0], c[1]}}, {{c[2]}}};
}
template <int W>
CAROM_SIMD_INLINE void write_motion(SolverBody<Dim2>* bodies, const std::int32_t* index, const Motion2<W>& m) {
  const WideFloat<W> c[4] = {m.v.v[0], m.v.v[1], m.w.v[0], WideFloat<W>::zero()};
  scatter_rows<8, 4, W>(reinterpret_cast<float*>(bodies), index, c);
}
template <int W>
CAROM_SIMD_INLINE Lanes<2, W> load_turn(const float (&p)[2][W]) {
  return load(p);
}
template <int W>
CAROM_SIMD_INLINE Lanes<2, W> turned(const Lanes<2, W>& turn, const Lanes<2, W>& r) {
  return {{turn.v[0] * r.v[0] - turn.v[1] * r.v[1], turn.v[1] * r.v[0] + turn.v[0] * r.v[1]}};
}
/// Where the arms point now; returns the arm turned and the displacement of the centre.
template <int W>
CAROM_SIMD_INLINE Lanes<2, W> turned_arm(const SolverBody<Dim2>* bodies, const std::int32_t* index,
                                         const Lanes<2, W>& arm, Lanes<2, W>& shift) {
  WideFloat<W> c[4];
  gather_part<4, 4, 8, W>(reinterpret_cast<const float*>(bodies), index, unmoved.plane, c);
  shift = {{c[0], c[1]}};
  return turned(Lanes<2, W>{{c[2], c[3]}}, arm);
}
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> factorise(const Lanes<2, W>& a, const Lanes<2, W>& b, WideFloat<W> m, WideFloat<W> ia,
                                        WideFloat<W> ib) {
  using F = WideFloat<W>;
  const F k11 = m + ia * a.v[1] * a.v[1] + ib * b.v[1] * b.v[1];
  const F k12 = F::zero() - (ia * a.v[0] * a.v[1] + ib * b.v[0] * b.v[1]);
  const F k22 = m + ia * a.v[0] * a.v[0] + ib * b.v[0] * b.v[0];
  const F i1 = reciprocal_above(k11, F::zero()), l21 = k12 * i1;
  return {{i1, reciprocal_above(k22 - l21 * k12, F::splat(1e-7f) * k22), l21}};
}
template <int W>
CAROM_SIMD_INLINE Lanes<2, W> solve_factor(const Lanes<3, W>& f, const Lanes<2, W>& r) {
  const WideFloat<W> y = (r.v[1] - f.v[2] * r.v[0]) * f.v[1];
  return {{r.v[0] * f.v[0] - f.v[2] * y, y}};
}

// Space ---------------------------------------------------------------------------------------------------------------
template <int W>
struct Motion3 {
  Lanes<3, W> v, w;
};
template <int W>
CAROM_SIMD_INLINE Motion3<W> read_motion(const SolverBody<Dim3>* bodies, const std::int32_t* index) {
  WideFloat<W> c[8];
  gather_part<0, 8, 16, W>(reinterpret_cast<const float*>(bodies), index, unmoved.space, c);
  return {{{c[0], c[1], c[2]}}, {{c[4], c[5], c[6]}}};
}
template <int W>
CAROM_SIMD_INLINE void write_motion(SolverBody<Dim3>* bodies, const std::int32_t* index, const Motion3<W>& m) {
  const WideFloat<W> zero = WideFloat<W>::zero();
  const WideFloat<W> c[8] = {m.v.v[0], m.v.v[1], m.v.v[2], zero, m.w.v[0], m.w.v[1], m.w.v[2], zero};
  scatter_rows<16, 8, W>(reinterpret_cast<float*>(bodies), index, c);
}
template <int W>
struct Turn {
  WideFloat<W> w;
  Lanes<3, W> u;
};
template <int W>
CAROM_SIMD_INLINE Turn<W> load_turn(const float (&p)[4][W]) {
  using F = WideFloat<W>;
  return {F::load_aligned(p[0]), {{F::load_aligned(p[1]), F::load_aligned(p[2]), F::load_aligned(p[3])}}};
}
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> turned(const Turn<W>& q, const Lanes<3, W>& r) {
  const Lanes<3, W> x = cross(q.u, r), t = add(x, x);
  return add(add(r, multiply(t, q.w)), cross(q.u, t));
}
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> turned_arm(const SolverBody<Dim3>* bodies, const std::int32_t* index,
                                         const Lanes<3, W>& arm, Lanes<3, W>& shift) {
  WideFloat<W> c[8];
  gather_part<8, 8, 16, W>(reinterpret_cast<const float*>(bodies), index, unmoved.space, c);
  shift = {{c[0], c[1], c[2]}};
  return turned(Turn<W>{c[4], {{c[5], c[6], c[7]}}}, arm);
}
template <int W>
CAROM_SIMD_INLINE Lanes<6, W> factorise(const Lanes<3, W>& a, const Lanes<3, W>& b, WideFloat<W> m, WideFloat<W> ia,
                                        WideFloat<W> ib) {
  using F = WideFloat<W>;
  const Lanes<3, W> p = multiply(a, ia), q = multiply(b, ib);
  const F xx = p.v[0] * a.v[0] + q.v[0] * b.v[0], yy = p.v[1] * a.v[1] + q.v[1] * b.v[1],
          zz = p.v[2] * a.v[2] + q.v[2] * b.v[2];
  const F k11 = m + (yy + zz), k22 = m + (xx + zz), k33 = m + (xx + yy);
  const F k12 = F::zero() - (p.v[0] * a.v[1] + q.v[0] * b.v[1]), k13 = F::zero() - (p.v[0] * a.v[2] + q.v[0] * b.v[2]),
          k23 = F::zero() - (p.v[1] * a.v[2] + q.v[1] * b.v[2]);
  const F small = F::splat(1e-7f);
  const F i1 = reciprocal_above(k11, F::zero()), l21 = k12 * i1, l31 = k13 * i1;
  const F i2 = reciprocal_above(k22 - l21 * k12, small * k22);
  const F u32 = k23 - l31 * k12, l32 = u32 * i2;
  const F i3 = reciprocal_above(k33 - l31 * k13 - l32 * u32, small * k33);
  return {{i1, i2, i3, l21, l31, l32}};
}
template <int W>
CAROM_SIMD_INLINE Lanes<3, W> solve_factor(const Lanes<6, W>& f, const Lanes<3, W>& r) {
  using F = WideFloat<W>;
  const F y2 = r.v[1] - f.v[3] * r.v[0], y3 = r.v[2] - f.v[4] * r.v[0] - f.v[5] * y2;
  const F z = y3 * f.v[2], y = y2 * f.v[1] - f.v[5] * z;
  return {{r.v[0] * f.v[0] - f.v[3] * y - f.v[4] * z, y, z}};
}

// Both ----------------------------------------------------------------------------------------------------------------
template <class Motion, class Vector, int W>
CAROM_SIMD_INLINE void push(Motion& a, Motion& b, WideFloat<W> ma, WideFloat<W> mb, WideFloat<W> ia, WideFloat<W> ib,
                            const Vector& impulse, const Vector& reach_a, const Vector& reach_b) {
  a.v = subtract(a.v, multiply(impulse, ma));
  a.w = subtract(a.w, multiply(cross(reach_a, impulse), ia));
  b.v = add(b.v, multiply(impulse, mb));
  b.w = add(b.w, multiply(cross(reach_b, impulse), ib));
}

template <class D, int W>
void begin(void* block, const void* in) {
  PinLanes<D, W>& c = *static_cast<PinLanes<D, W>*>(block);
  const BodyTurns<D, W>& turns = *static_cast<const BodyTurns<D, W>*>(in);
  const auto arm_a = turned(load_turn(turns.a), load(c.arm_a)), reach_b = turned(load_turn(turns.b), load(c.arm_b)),
             reach_a = add(load(c.offset), reach_b);
  store(arm_a, c.arm_a);
  store(reach_b, c.arm_b);
  store(reach_b, c.reach_b);
  store(reach_a, c.reach_a);
  store(subtract(reach_a, arm_a), c.error);
}
template <class D, int W>
void warm_start(SolverBody<D>* bodies, void* blocks, int begin, int end) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    const PinLanes<D, W>& c = static_cast<const PinLanes<D, W>*>(blocks)[k];
    auto a = read_motion<W>(bodies, c.read_a), b = read_motion<W>(bodies, c.read_b);
    push(a, b, F::load_aligned(c.inverse_mass_a), F::load_aligned(c.inverse_mass_b),
         F::load_aligned(c.inverse_inertia_a), F::load_aligned(c.inverse_inertia_b), load(c.impulse), load(c.reach_a),
         load(c.reach_b));
    write_motion<W>(bodies, c.write_a, a);
    write_motion<W>(bodies, c.write_b, b);
  }
}

template <class D, int W>
void solve(SolverBody<D>* bodies, void* blocks, int begin, int end, PinResponse response) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    PinLanes<D, W>& c = static_cast<PinLanes<D, W>*>(blocks)[k];
    auto a = read_motion<W>(bodies, c.read_a), b = read_motion<W>(bodies, c.read_b);
    const F ma = F::load_aligned(c.inverse_mass_a), mb = F::load_aligned(c.inverse_mass_b);
    const F ia = F::load_aligned(c.inverse_inertia_a), ib = F::load_aligned(c.inverse_inertia_b);
    const auto reach_a = load(c.reach_a), reach_b = load(c.reach_b), old = load(c.impulse);
    const auto factor = factorise(reach_a, reach_b, ma + mb, ia, ib);
    store(factor, c.factor);
    const auto rate = subtract(add(b.v, cross(b.w, reach_b)), add(a.v, cross(a.w, reach_a)));
    const auto residual =
        add(multiply(rate, F::splat(response.velocity)), multiply(load(c.error), F::splat(response.position)));
    const auto next = subtract(multiply(old, F::splat(1 - response.memory)), solve_factor(factor, residual));
    store(next, c.impulse);
    push(a, b, ma, mb, ia, ib, subtract(next, old), reach_a, reach_b);
    write_motion<W>(bodies, c.write_a, a);
    write_motion<W>(bodies, c.write_b, b);
  }
}

template <class D, int W>
void relax(SolverBody<D>* bodies, void* blocks, int begin, int end) {
  using F = WideFloat<W>;
  for (int k = begin; k < end; ++k) {
    PinLanes<D, W>& c = static_cast<PinLanes<D, W>*>(blocks)[k];
    auto a = read_motion<W>(bodies, c.read_a), b = read_motion<W>(bodies, c.read_b);
    decltype(load(c.arm_a)) moved_a, moved_b;
    const auto arm_a = turned_arm<W>(bodies, c.read_a, load(c.arm_a), moved_a);
    const auto reach_b = turned_arm<W>(bodies, c.read_b, load(c.arm_b), moved_b);
    const auto reach_a = add(add(load(c.offset), subtract(moved_b, moved_a)), reach_b);
    store(reach_a, c.reach_a);
    store(reach_b, c.reach_b);
    store(subtract(reach_a, arm_a), c.error);
    const auto rate = subtract(add(b.v, cross(b.w, reach_b)), add(a.v, cross(a.w, reach_a)));
    const auto change = solve_factor(load(c.factor), rate);
    store(subtract(load(c.impulse), change), c.impulse);
    // The change is taken off: A gains what B loses.
    push(a, b, WideFloat<W>::zero() - F::load_aligned(c.inverse_mass_a),
         WideFloat<W>::zero() - F::load_aligned(c.inverse_mass_b),
         WideFloat<W>::zero() - F::load_aligned(c.inverse_inertia_a),
         WideFloat<W>::zero() - F::load_aligned(c.inverse_inertia_b), change, reach_a, reach_b);
    write_motion<W>(bodies, c.write_a, a);
    write_motion<W>(bodies, c.write_b, b);
  }
}

}  // namespace carom::rigid::detail::CAROM_PIN_NAMESPACE
