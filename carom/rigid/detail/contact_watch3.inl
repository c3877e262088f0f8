// Which pairs of space have nothing new to tell, as many at a time as there are lanes: part of contact_kernel.inl.
// See contact_watch2.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

template <int W>
CAROM_SIMD_INLINE WideVec3<W> rotate(const WideQuat<W>& q, const WideVec3<W>& v) {
  const WideVec3<W> u = {q.x, q.y, q.z}, half = cross(u, v), t = add(half, half);
  return add(add(v, multiply(t, q.w)), cross(u, t));
}

/// Bits by lane; lanes from `count` on are none.
template <int W>
std::uint32_t nothing_new3(const ContactWatch<Dim3>* watches, int count, const Dim3::Pose* poses,
                           const BodySweep<Dim3>* sweeps, float dt) {
  using F = WideFloat<W>;
  using Watch = ContactWatch<Dim3>;
  static_assert(offsetof(Watch, base) == 8 && offsetof(Watch, normal) == 36 && offsetof(Watch, middle) == 48 &&
                offsetof(Watch, extent) == 60 && offsetof(Watch, gap) == 64 && offsetof(Watch, most_way) == 68 &&
                offsetof(Watch, cap) == 72 && sizeof(Watch) == 80 && sizeof(BodySweep<Dim3>) == 16);
  const float *watch[W], *turn_a[W], *turn_b[W], *sweep_a[W], *sweep_b[W], *between[W];
  alignas(16) float apart[W][4];
  std::int32_t body[W];
  for (int i = 0; i < W; ++i) {
    const Watch& w = watches[i < count ? i : 0];
    const bool looks = w.body[0] != none;
    const std::int32_t a = looks ? w.body[0] : 0, b = looks ? w.body[1] : 0;
    const Dim3::Pose &pa = poses[a], &pb = poses[b];
    body[i] = i < count ? w.body[0] : none;
    watch[i] = reinterpret_cast<const float*>(&w);
    turn_a[i] = reinterpret_cast<const float*>(&pa.rotation);
    turn_b[i] = reinterpret_cast<const float*>(&pb.rotation);
    sweep_a[i] = reinterpret_cast<const float*>(sweeps + a);
    sweep_b[i] = reinterpret_cast<const float*>(sweeps + b);
    apart[i][0] = float(pb.position.x - pa.position.x);
    apart[i][1] = float(pb.position.y - pa.position.y);
    apart[i][2] = float(pb.position.z - pa.position.z);
    between[i] = apart[i];
  }
  const auto looked_at = WideInt<W>::load(body) > WideInt<W>::splat(-1);
  if (!any(looked_at)) return 0;
  F w[20], qa[4], qb[4], d[4];
  gather_rows<20, W>(watch, w);
  gather_rows<4, W>(turn_a, qa);
  gather_rows<4, W>(turn_b, qb);
  gather_rows<4, W>(between, d);
  const F zero = F::zero();
  const WideQuat<W> a = {qa[0], qa[1], qa[2], qa[3]}, base = {w[5], w[6], w[7], w[8]};
  const WideQuat<W> back = conjugate(a), now = multiply(back, WideQuat<W>{qb[0], qb[1], qb[2], qb[3]});
  const WideVec3<W> normal = {w[9], w[10], w[11]}, middle = {w[12], w[13], w[14]};
  const WideVec3<W> way = subtract(add(rotate(back, WideVec3<W>{d[0], d[1], d[2]}), rotate(now, middle)),
                                   add(WideVec3<W>{w[2], w[3], w[4]}, rotate(base, middle)));
  const F gap = w[16], most_way = w[17], cap = w[18];
  const WideQuat<W> turned = multiply(conjugate(base), now);
  const F chord = F::splat(2) * length(WideVec3<W>{turned.x, turned.y, turned.z}), turn = chord * w[15];
  const F along = dot(normal, way);
  const auto recycled = cap < zero;
  const F across = length(subtract(way, multiply(normal, along)));
  const auto stays = recycled & (gap + along < zero) & (gap + along > cap) & (across + turn < most_way);
  if (!any(looked_at & !recycled)) return bitmask(looked_at & stays);

  F sa[4], sb[4];
  gather_rows<4, W>(sweep_a, sa);
  gather_rows<4, W>(sweep_b, sb);
  const WideVec3<W> closing = {sa[0] - sb[0], sa[1] - sb[1], sa[2] - sb[2]};
  const F turning = min(sa[3] + sb[3], F::splat(most_turning * dt)), moved = length(way) + turn;
  const auto anyhow = most_way == zero;
  const F ahead = select(anyhow, length(closing), max(dot(rotate(a, normal), closing), zero - turning)) + turning;
  const auto far = select(anyhow, moved, turn - along) + min(ahead, cap) < gap;
  const auto keeps = (!recycled) & far & (anyhow | (moved < most_way));
  return bitmask(looked_at & (stays | keeps));
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
