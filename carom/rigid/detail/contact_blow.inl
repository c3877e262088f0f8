// Hard blows and pushes: part of contact_kernel.inl. One round over the points of a manifold leaves some hundredths of
// a blow between them, with which a body comes back from a wall though nothing of it bounces; and as much of the speed
// with which it is pushed out of the wall. Where a pass changes much speed at once, the points are therefore solved
// together.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

/// m/s: what meets faster, and loses at least `least_change` of it in a pass, strikes hard; what is given more than
/// `least_push` though it does not close is pushed.
inline constexpr float hard_blow = 1, least_change = 0.05f, least_push = 0.02f;

/// What a pass over the normals of a manifold of N points did: Σ λ before it, Σ Δλ, and in the order in which it took
/// the points, how fast they parted (m/s) and their Δλ.
template <int W, int N>
struct PassBlow {
  WideFloat<W> before = WideFloat<W>::splat(0), change = WideFloat<W>::splat(0), parting[N], delta[N];
  CAROM_SIMD_INLINE void add(int place, WideFloat<W> old, WideFloat<W> more, WideFloat<W> speed) {
    before += old;
    change += more;
    parting[place] = speed;
    delta[place] = more;
  }
  /// The power that it took off, −Σ v Δλ.
  CAROM_SIMD_INLINE WideFloat<W> power() const {
    WideFloat<W> sum = WideFloat<W>::splat(0);
    for (int k = 0; k < N; ++k) sum -= parting[k] * delta[k];
    return sum;
  }
};

/// The lanes of `among` on which a hard blow or a push fell, in this pass or earlier in the step: the next warm start
/// gives it again. It is one only where next to nothing pressed before, and more than one point has to share it:
/// in a pile, where much presses already, contacts disagree more than the points of one.
template <int W, int N, class Block>
CAROM_SIMD_INLINE WideMask<W> find_struck(Block& c, const PassBlow<W, N>& blow, WideMask<W> among) {
  using F = WideFloat<W>;
  const F zero = F::splat(0), earlier = F::load(c.struck);
  const auto fresh = (blow.before <= F::splat(1e-3f) * blow.change) & (F::load(c.point[1].normal_mass) > zero);
  // Most blocks have none, and are done here.
  const auto may_be = among & ((fresh & (blow.change > zero)) | (earlier > zero));
  if (!any(may_be)) [[likely]]
    return may_be;
  const F mobility = F::load(c.inverse_mass_a) + F::load(c.inverse_mass_b);
  const F change = blow.change * mobility, power = blow.power() * mobility;
  const auto hard = fresh & (power > F::splat(hard_blow) * max(change, F::splat(least_change)));
  // One point that is pushed turns others inward: that closes too, though far slower than it pushes.
  const auto pushed = fresh & (change > F::splat(least_push)) & (power <= F::splat(0.3f) * change * change);
  const auto struck = among & (hard | pushed | (earlier > zero));
  if (any(struck))
    select(struck, max(earlier, select(pushed, F::splat(block_pushed), F::splat(block_struck))), earlier)
        .store(c.struck);
  return struck;
}

/// The points of a manifold together: find λ ≥ 0 so that velocity + K (λ − impulse) + yield λ ≥ 0, and 0 where λ > 0.
/// By principal pivoting (Murty 1974): the rows that press are solved, the first that pulls or gives way changes sides.
template <int W, int N>
struct TogetherRows {
  WideFloat<W> k[N][N];  ///< the mobility, K_ij = K_ji; filled for j ≤ i
  WideFloat<W> velocity[N], impulse[N], yield[N];
  WideMask<W> present[N];
};

/// x of A x = rhs by A = L D Lᵀ; of A only j ≤ i is read, and lost.
template <int W, int N>
CAROM_SIMD_INLINE void solve_symmetric(WideFloat<W> (&a)[N][N], WideFloat<W> (&x)[N]) {
  using F = WideFloat<W>;
  F inverse[N];
  for (int j = 0; j < N; ++j) {
    F d = a[j][j];
    for (int k = 0; k < j; ++k) d -= a[j][k] * a[j][k] * a[k][k];
    a[j][j] = d;
    inverse[j] = F::splat(1) / d;
    for (int i = j + 1; i < N; ++i) {
      F l = a[i][j];
      for (int k = 0; k < j; ++k) l -= a[i][k] * a[j][k] * a[k][k];
      a[i][j] = l * inverse[j];
    }
  }
  for (int i = 1; i < N; ++i)
    for (int k = 0; k < i; ++k) x[i] -= a[i][k] * x[k];
  for (int i = N - 1; i >= 0; --i) {
    x[i] = x[i] * inverse[i];
    for (int k = i + 1; k < N; ++k) x[i] -= a[k][i] * x[k];
  }
}

/// The rows' impulses, in place. Four points of a face hang on three motions: a thousandth of the diagonal tells how
/// they share, toward what they had, and is taken out again by repeating.
template <int W, int N>
CAROM_SIMD_INLINE void solve_together(TogetherRows<W, N>& rows) {
  using F = WideFloat<W>;
  constexpr int repeats = 2, most_pivots = 2 * N;
  const F zero = F::splat(0), one = F::splat(1);
  F free_velocity[N];  // with no impulse at all
  WideMask<W> presses[N];
  for (int i = 0; i < N; ++i) {
    free_velocity[i] = rows.velocity[i];
    for (int j = 0; j < N; ++j) free_velocity[i] -= rows.k[i > j ? i : j][i > j ? j : i] * rows.impulse[j];
    presses[i] = rows.present[i] & (rows.impulse[i] > zero);
  }
  for (int repeat = 0; repeat < repeats; ++repeat) {
    F keep_share[N], x[N];
    for (int i = 0; i < N; ++i) keep_share[i] = F::splat(1e-3f) * rows.k[i][i];
    for (int pivot = 0; pivot < most_pivots; ++pivot) {
      F a[N][N];
      for (int i = 0; i < N; ++i) {
        for (int j = 0; j < i; ++j) a[i][j] = keep(presses[i] & presses[j], rows.k[i][j]);
        a[i][i] = select(presses[i], rows.k[i][i] + rows.yield[i] + keep_share[i], one);
        x[i] = keep(presses[i], keep_share[i] * rows.impulse[i] - free_velocity[i]);
      }
      solve_symmetric<W, N>(a, x);
      WideMask<W> changed = WideMask<W>::none();
      for (int i = 0; i < N; ++i) {
        F v = free_velocity[i] - keep_share[i] * rows.impulse[i];
        for (int j = 0; j < N; ++j) v += rows.k[i > j ? i : j][i > j ? j : i] * x[j];
        const auto wrong = select(presses[i], x[i], v) < zero;
        const auto changes = rows.present[i] & wrong & !changed;
        presses[i] = presses[i] ^ changes;
        changed = changed | changes;
      }
      if (!any(changed)) break;
    }
    for (int i = 0; i < N; ++i) rows.impulse[i] = max(x[i], zero);
  }
}

/// How a row of a solving or relaxing pass stands: the velocity that is still to be taken off, and how much it yields
/// per impulse where it is soft: i_s λ + m_s m_eff (v + bias) = 0.
template <int W>
struct BlowRow {
  WideFloat<W> bias, yield;
};
template <int W, bool UseBias>
CAROM_SIMD_INLINE BlowRow<W> blow_row(const WideSoftness<W>& soft, WideFloat<W> s, WideFloat<W> mobility,
                                      WideFloat<W> inverse_h, WideFloat<W> push_speed) {
  using F = WideFloat<W>;
  const F zero = F::splat(0);
  const auto apart = s > zero;
  if constexpr (!UseBias) return {keep(apart, s * inverse_h), zero};
  return {select(apart, s * inverse_h, max(soft.bias_rate * s, zero - push_speed)),
          select(apart, zero, mobility * soft.impulse_scale / soft.mass_scale)};
}

template <class Velocity>
struct VelocityPair {
  Velocity a, b;
};
/// Solves the normals of the lanes in `struck` again, all points of a manifold at once.
template <int W, bool UseBias, class D, class Velocity>
[[gnu::noinline]] VelocityPair<Velocity> share_blow(const SolverBody<D>* bodies, ContactBlock<D, W>& c, Velocity a,
                                                    Velocity b, WideMask<W> struck, float inverse_h, float push_speed,
                                                    const WideSoftness<W>& soft, float counted) {
  using F = WideFloat<W>;
  constexpr int points = std::extent_v<decltype(c.point)>;
  const F ma = F::load(c.inverse_mass_a), mb = F::load(c.inverse_mass_b);
  const auto ia = load_inertia(c.inverse_inertia_a), ib = load_inertia(c.inverse_inertia_b);
  const auto n = load_vector(c.normal), offset = load_vector(c.center_offset);
  const auto offset_turn = cross(offset, n);
  F pa[4 * (D::dimension - 1)], pb[4 * (D::dimension - 1)];
  gather<W>(bodies, Slots<W>(c.body_a).of, D::dimension == 2 ? 4 : 8, pa);
  gather<W>(bodies, Slots<W>(c.body_b).of, D::dimension == 2 ? 4 : 8, pb);
  F shift = n.x * (pb[0] - pa[0]) + n.y * (pb[1] - pa[1]);
  if constexpr (D::dimension == 3) shift = shift + n.z * (pb[2] - pa[2]);
  const auto na = turned_back_change(pa, n), nb = turned_back_change(pb, n);
  TogetherRows<W, points> rows;
  decltype(a.w) turn_a[points], turn_b[points];
  for (int i = 0; i < points; ++i) {
    const auto& point = c.point[i];
    const auto ra = load_vector(point.r_a), rb = add(ra, offset);
    const F s = F::load(point.separation) + shift + (dot(nb, rb) - dot(na, ra));
    turn_a[i] = cross(ra, n), turn_b[i] = add(turn_a[i], offset_turn);
    const auto ita = multiply(ia, turn_a[i]), itb = multiply(ib, turn_b[i]);
    for (int j = 0; j <= i; ++j) rows.k[i][j] = ma + mb + dot(ita, turn_a[j]) + dot(itb, turn_b[j]);
    const BlowRow<W> row = blow_row<W, UseBias>(soft, s, rows.k[i][i], F::splat(inverse_h), F::splat(push_speed));
    rows.velocity[i] = dot(subtract(b.v, a.v), n) + dot(b.w, turn_b[i]) - dot(a.w, turn_a[i]) + row.bias;
    rows.yield[i] = row.yield;
    rows.impulse[i] = F::load(point.impulse);
    rows.present[i] = F::load(point.normal_mass) > F::splat(0);
  }
  solve_together<W, points>(rows);
  F sum = F::splat(0);
  decltype(a.w) on_a{}, on_b{};
  for (int i = 0; i < points; ++i) {
    auto& point = c.point[i];
    const F old = F::load(point.impulse), delta = keep(struck, rows.impulse[i] - old);
    (old + delta).store(point.impulse);
    if constexpr (!UseBias) (F::load(point.total) + delta * F::splat(counted)).store(point.total);
    sum += delta;
    on_a = add(on_a, multiply(turn_a[i], delta));
    on_b = add(on_b, multiply(turn_b[i], delta));
  }
  push_back(a, ma, ia, multiply(n, sum), on_a);
  push(b, mb, ib, multiply(n, sum), on_b);
  return {a, b};
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
