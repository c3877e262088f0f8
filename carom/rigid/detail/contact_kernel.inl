// The contact solver's inner loops, written once over the width. Included by contact_solver_{baseline,avx2,avx512}.cpp,
// each of which defines CAROM_CONTACT_NAMESPACE. See math/simd.h for the rules a kernel obeys.
//
// Soft contacts with a relaxing pass (Catto, "Solver2D", 2024): the biased pass pushes overlaps apart like a damped
// spring, the relaxing pass takes the velocity of that push out again. Friction and twist act on the whole patch at its
// pressure centre, both tangents together, so that the cone is a circle and no direction is preferred.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

using namespace math;

constexpr float touching_gap = 2e-5f;  ///< m, over which a row goes from soft to rigid

template <int W>
struct WideVec2 {
  WideFloat<W> x, y;
};
template <int W>
struct WideVec3 {
  WideFloat<W> x, y, z;
};
template <int W>
CAROM_SIMD_INLINE WideVec2<W> load2(const float (&p)[2][W]) {
  return {WideFloat<W>::load(p[0]), WideFloat<W>::load(p[1])};
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> load3(const float (&p)[3][W]) {
  return {WideFloat<W>::load(p[0]), WideFloat<W>::load(p[1]), WideFloat<W>::load(p[2])};
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> dot(const WideVec2<W>& a, const WideVec2<W>& b) {
  return a.x * b.x + a.y * b.y;
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> cross(const WideVec2<W>& a, const WideVec2<W>& b) {
  return a.x * b.y - a.y * b.x;
}
template <int W>
CAROM_SIMD_INLINE WideVec2<W> add(const WideVec2<W>& a, const WideVec2<W>& b) {
  return {a.x + b.x, a.y + b.y};
}
template <int W>
CAROM_SIMD_INLINE WideVec2<W> subtract(const WideVec2<W>& a, const WideVec2<W>& b) {
  return {a.x - b.x, a.y - b.y};
}
template <int W>
CAROM_SIMD_INLINE WideVec2<W> multiply(const WideVec2<W>& a, WideFloat<W> s) {
  return {a.x * s, a.y * s};
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> dot(const WideVec3<W>& a, const WideVec3<W>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> cross(const WideVec3<W>& a, const WideVec3<W>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> add(const WideVec3<W>& a, const WideVec3<W>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> subtract(const WideVec3<W>& a, const WideVec3<W>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> multiply(const WideVec3<W>& a, WideFloat<W> s) {
  return {a.x * s, a.y * s, a.z * s};
}
/// Symmetric matrix, xx, yy, zz, xy, xz, yz.
template <int W>
struct WideSymmetric {
  WideFloat<W> xx, yy, zz, xy, xz, yz;
};
template <int W>
CAROM_SIMD_INLINE WideSymmetric<W> load_symmetric(const float (&p)[6][W]) {
  return {WideFloat<W>::load(p[0]), WideFloat<W>::load(p[1]), WideFloat<W>::load(p[2]),
          WideFloat<W>::load(p[3]), WideFloat<W>::load(p[4]), WideFloat<W>::load(p[5])};
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> multiply(const WideSymmetric<W>& m, const WideVec3<W>& v) {
  return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
          m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

template <int W>
CAROM_SIMD_INLINE WideFloat<W> length(const WideVec2<W>& a) {
  return sqrt(dot(a, a));
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> length(const WideVec3<W>& a) {
  return sqrt(dot(a, a));
}

/// What the code of both dimensions calls them: turns and inertias of the plane are numbers.
template <int W>
CAROM_SIMD_INLINE WideVec2<W> load_vector(const float (&p)[2][W]) {
  return load2<W>(p);
}
template <int W>
CAROM_SIMD_INLINE WideVec3<W> load_vector(const float (&p)[3][W]) {
  return load3<W>(p);
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> load_inertia(const float (&p)[W]) {
  return WideFloat<W>::load(p);
}
template <int W>
CAROM_SIMD_INLINE WideSymmetric<W> load_inertia(const float (&p)[6][W]) {
  return load_symmetric<W>(p);
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> dot(WideFloat<W> a, WideFloat<W> b) {
  return a * b;
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> add(WideFloat<W> a, WideFloat<W> b) {
  return a + b;
}
template <int W>
CAROM_SIMD_INLINE WideFloat<W> multiply(WideFloat<W> a, WideFloat<W> s) {
  return a * s;
}

/// The passes over normals: pushing out, taking the speed of that back where things settle, and doing so everywhere,
/// for the impulses that count.
enum class NormalPass { solve, settle, relax };

/// m/s that the relaxing pass takes off where bodies meet: with more it is a blow, whose friction is due at once.
inline constexpr float least_blow = 0.25f;

/// flag/k, or 0 where nothing responds.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> inverse_or_zero(WideFloat<W> flag, WideFloat<W> k) {
  const WideFloat<W> zero = WideFloat<W>::splat(0);
  return keep(k > zero, flag / select(k > zero, k, WideFloat<W>::splat(1)));
}

/// Of the lanes' bodies those of the lanes that settle.
template <int W>
CAROM_SIMD_INLINE void who_settles(const float (&settles)[W], const std::int32_t (&bodies)[W],
                                   std::int32_t (&chosen)[W]) {
  for (int i = 0; i < W; ++i) chosen[i] = settles[i] > 0 ? bodies[i] : none;
}

/// Of the lanes' bodies those that take impulses again.
template <int W>
CAROM_SIMD_INLINE void who_starts_again(const std::int32_t (&again)[W], std::int32_t bit,
                                        const std::int32_t (&bodies)[W], std::int32_t (&chosen)[W]) {
  for (int i = 0; i < W; ++i) chosen[i] = (again[i] & bit) != 0 ? bodies[i] : none;
}

/// The slots of the lanes' bodies, whoever they are.
template <int W>
struct Slots {
  alignas(4 * W) std::int32_t of[W];
  CAROM_SIMD_INLINE explicit Slots(const std::int32_t (&bodies)[W]) {
    const WideInt<W> x = WideInt<W>::load(bodies);
    (x ^ (x >> 31)).store(of);
  }
};

/// How soft the lanes' contacts are.
template <int W>
struct WideSoftness {
  WideFloat<W> bias_rate, mass_scale, impulse_scale;

  CAROM_SIMD_INLINE WideSoftness() : bias_rate{}, mass_scale{}, impulse_scale{} {}
  template <class D>
  CAROM_SIMD_INLINE WideSoftness(const ContactSoftness& softness, const ContactBlock<D, W>& c) {
    const auto firm = (WideInt<W>::load(c.body_a) | WideInt<W>::load(c.body_b)) < WideInt<W>::zero();
    const auto either = [&](float Softness::* part) __attribute__((always_inline)) {
      return select(firm, WideFloat<W>::splat(softness.firm.*part), WideFloat<W>::splat(softness.free.*part));
    };
    bias_rate = either(&Softness::bias_rate);
    mass_scale = either(&Softness::mass_scale);
    impulse_scale = either(&Softness::impulse_scale);
  }
};

/// m: so far the load may move on a body before friction lets go of its anchor; `arm`: from the patch to the nearer
/// centre. Where something rolls by a whole radius its anchor stands beside it, and what asks that back would spin it.
template <int W>
CAROM_SIMD_INLINE WideFloat<W> anchor_reach(WideFloat<W> arm) {
  using F = WideFloat<W>;
  return min(F::splat(0.05f) * arm + F::splat(0.01f), F::splat(0.25f) * arm);
}

template <int W, int Columns, class Body>
CAROM_SIMD_INLINE void gather(const Body* bodies, const std::int32_t* index, int offset,
                              WideFloat<W> (&columns)[Columns]) {
  const float* rows[W];
  for (int i = 0; i < W; ++i) rows[i] = reinterpret_cast<const float*>(bodies + index[i]) + offset;
  gather_rows<Columns, W>(rows, columns);
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE

#include "carom/rigid/detail/box_kernel.inl"
#include "carom/rigid/detail/contact_gather.inl"
#include "carom/rigid/detail/contact_gather2.inl"
#include "carom/rigid/detail/contact_gather3.inl"
#include "carom/rigid/detail/contact_prepare2.inl"
#include "carom/rigid/detail/contact_prepare3.inl"
#include "carom/rigid/detail/contact_watch2.inl"
#include "carom/rigid/detail/contact_watch3.inl"
#include "carom/rigid/detail/pair_motions.inl"
// The passes use what the preparation left.
#include "carom/rigid/detail/contact_blow.inl"
#include "carom/rigid/detail/contact_kernel2.inl"
#include "carom/rigid/detail/contact_kernel3.inl"
// And bodies go on with the velocities that these leave.
#include "carom/rigid/detail/body_kernel2.inl"

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

/// Lanes of a prepared block whose points are a hundredth of an arm or more apart and close fast enough for a blow.
template <class D, int W>
std::uint32_t strikes(const SolverBody<D>* bodies, const void* block) {
  using F = WideFloat<W>;
  const ContactBlock<D, W>& c = *static_cast<const ContactBlock<D, W>*>(block);
  const auto ra = load_vector(c.patch_r_a), rb = add(ra, load_vector(c.center_offset));
  F nearest = F::load(c.point[0].separation);
  for (int i = 1; i < c.points; ++i) nearest = min(nearest, F::load(c.point[i].separation));
  const auto apart = (nearest > F::splat(0)) & (nearest * nearest > F::splat(1e-4f) * min(dot(ra, ra), dot(rb, rb)));
  if (!any(apart)) return 0;
  const auto n = load_vector(c.normal);
  const auto a = read_velocity<W>(bodies, Slots<W>(c.body_a).of), b = read_velocity<W>(bodies, Slots<W>(c.body_b).of);
  const F parting = dot(subtract(b.v, a.v), n) + dot(b.w, cross(rb, n)) - dot(a.w, cross(ra, n));
  return bitmask(apart & (parting < F::splat(-least_blow)));
}

template <class D, int W>
void keep_impulses(void* blocks, float* kept, int begin, int end, const ContactSoftness& softness) {
  using Block = ContactBlock<D, W>;
  for (int k = begin; k < end; ++k) {
    const Block& c = static_cast<const Block*>(blocks)[k];
    const WideFloat<W> share = WideSoftness<W>(softness, c).mass_scale;
    for (int i = 0; i < Block::points; ++i)
      (share * WideFloat<W>::load(c.point[i].impulse)).store(kept + (k * Block::points + i) * W);
  }
}
template <class D, int W>
void take_impulses_back(SolverBody<D>* bodies, void* blocks, const float* kept, int begin, int end) {
  using F = WideFloat<W>;
  using Block = ContactBlock<D, W>;
  for (int k = begin; k < end; ++k) {
    Block& c = static_cast<Block*>(blocks)[k];
    auto a = read_velocity<W>(bodies, Slots<W>(c.body_a).of), b = read_velocity<W>(bodies, Slots<W>(c.body_b).of);
    const auto n = load_vector(c.normal);
    const auto offset_turn = cross(load_vector(c.center_offset), n);
    const auto bearless = (WideInt<W>::load(c.again) & WideInt<W>::splat(block_bears)) == WideInt<W>::zero();
    F sum = F::zero();
    decltype(a.w) on_a{}, on_b{};
    for (int i = 0; i < Block::points; ++i) {
      const F now = F::load(c.point[i].impulse), before = F::load(kept + (k * Block::points + i) * W);
      const F change = keep(bearless, F::load(c.settles) * (before - now));
      const auto turn = cross(load_vector(c.point[i].r_a), n);
      (now + change).store(c.point[i].impulse);
      sum += change;
      on_a = add(on_a, multiply(turn, change));
      on_b = add(on_b, multiply(add(turn, offset_turn), change));
    }
    push_back(a, F::load(c.inverse_mass_a), load_inertia(c.inverse_inertia_a), multiply(n, sum), on_a);
    push(b, F::load(c.inverse_mass_b), load_inertia(c.inverse_inertia_b), multiply(n, sum), on_b);
    std::int32_t to_a[W], to_b[W];
    who_settles<W>(c.settles, c.body_a, to_a);
    who_settles<W>(c.settles, c.body_b, to_b);
    write_velocity<W>(bodies, to_a, a);
    write_velocity<W>(bodies, to_b, b);
  }
}

#if CAROM_CONTACT_WIDTH <= 8
PairKernels<Dim2> pair_kernels(Dim2) {
  constexpr int W = CAROM_CONTACT_WIDTH;
  return {W, new_meetings<Dim2, W>, sweep<W>, nothing_new2<W>, pair_motions<Dim2, W>};
}
PairKernels<Dim3> pair_kernels(Dim3) {
  constexpr int W = CAROM_CONTACT_WIDTH;
  return {W, new_meetings<Dim3, W>, nullptr, nothing_new3<W>, pair_motions<Dim3, W>};
}
#endif
ContactKernels<Dim2> kernels(Dim2) {
  constexpr int W = CAROM_CONTACT_WIDTH;
  ContactKernels<Dim2> k;
  k.width = W;
  k.gather = gather2<W>;
  k.prepare = prepare2<W>;
  k.approach = approach2<W>;
  k.closing = closing2<W>;
  k.store = store2<W>;
  k.strikes = strikes<Dim2, W>;
  k.warm_start = warm_start2<W>;
  k.solve = solve2<W>;
  k.keep = keep_impulses<Dim2, W>;
  k.take_back = take_impulses_back<Dim2, W>;
  k.settle = settle2<W>;
  k.relax = relax2<W>;
  k.restitute = restitute2<W>;
  k.integrate_velocities = integrate_velocities2<W>;
  k.integrate_positions = integrate_positions2<W>;
  return k;
}
ContactKernels<Dim3> kernels(Dim3) {
  constexpr int W = CAROM_CONTACT_WIDTH;
  ContactKernels<Dim3> k;
  k.width = W;
  k.gather = gather3<W>;
  k.prepare = prepare3<W>;
  k.masses = find_masses_again3<W>;
  k.approach = approach3<W>;
  k.closing = closing3<W>;
  k.store = store3<W>;
  k.strikes = strikes<Dim3, W>;
  k.warm_start = warm_start3<W>;
  k.solve = solve3<W>;
  k.keep = keep_impulses<Dim3, W>;
  k.take_back = take_impulses_back<Dim3, W>;
  k.settle = settle3<W>;
  k.relax = relax3<W>;
  k.restitute = restitute3<W>;
  return k;
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
