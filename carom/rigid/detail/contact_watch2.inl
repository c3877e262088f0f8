// Which pairs of the plane have nothing new to tell, as many at a time as there are lanes: part of contact_kernel.inl.
// Those that are apart: as B's middle moved since, its surface turned about it, and both may come in this step, along
// the normal where there is one. Those that touch: the same across it.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

/// Bits by lane; lanes from `count` on are none.
template <int W>
std::uint32_t nothing_new2(const ContactWatch<Dim2>* watches, int count, const Dim2::Pose* poses,
                           const BodySweep<Dim2>* sweeps, float dt) {
  using F = WideFloat<W>;
  using Watch = ContactWatch<Dim2>;
  static_assert(offsetof(Watch, normal) == offsetof(Watch, base) + 16 &&
                offsetof(Watch, middle) == offsetof(Watch, base) + 24 &&
                offsetof(Watch, extent) == offsetof(Watch, base) + 32 &&
                offsetof(Watch, cap) == offsetof(Watch, base) + 44 && sizeof(BodySweep<Dim2>) == 16);
  const float *watch[W], *turn_a[W], *turn_b[W], *sweep_a[W], *sweep_b[W], *between[W];
  alignas(16) float apart[W][4];
  std::int32_t body[W];
  for (int i = 0; i < W; ++i) {
    const Watch& w = watches[i < count ? i : 0];
    const bool looks = w.body[0] != none;
    const std::int32_t a = looks ? w.body[0] : 0, b = looks ? w.body[1] : 0;
    const Dim2::Pose &pa = poses[a], &pb = poses[b];
    body[i] = i < count ? w.body[0] : none;
    watch[i] = reinterpret_cast<const float*>(&w.base);
    turn_a[i] = reinterpret_cast<const float*>(&pa.rotation) - 2;
    turn_b[i] = reinterpret_cast<const float*>(&pb.rotation) - 2;
    sweep_a[i] = reinterpret_cast<const float*>(sweeps + a);
    sweep_b[i] = reinterpret_cast<const float*>(sweeps + b);
    apart[i][0] = float(pb.position.x - pa.position.x);
    apart[i][1] = float(pb.position.y - pa.position.y);
    between[i] = apart[i];
  }
  F w[12], qa[4], qb[4], d[4];
  gather_rows<12, W>(watch, w);
  gather_rows<4, W>(turn_a, qa);
  gather_rows<4, W>(turn_b, qb);
  gather_rows<4, W>(between, d);
  const F zero = F::zero();
  const WideTurn2<W> a = {qa[2], qa[3]}, base = {w[2], w[3]}, now = multiply(conjugate(a), WideTurn2<W>{qb[2], qb[3]});
  const WideVec2<W> normal = {w[4], w[5]}, middle = {w[6], w[7]};
  const WideVec2<W> way = subtract(add(rotate(conjugate(a), WideVec2<W>{d[0], d[1]}), rotate(now, middle)),
                                   add(WideVec2<W>{w[0], w[1]}, rotate(base, middle)));
  const F gap = w[9], most_way = w[10], cap = w[11];
  const F turn = length(WideVec2<W>{now.c - base.c, now.s - base.s}) * w[8], along = dot(normal, way);
  const auto looked_at = WideInt<W>::load(body) > WideInt<W>::splat(-1), recycled = cap < zero;
  const F across = length(WideVec2<W>{way.x - along * normal.x, way.y - along * normal.y});
  const auto stays = recycled & (gap + along < zero) & (gap + along > cap) & (across + turn < most_way);
  if (!any(looked_at & !recycled)) return bitmask(looked_at & stays);

  F sa[4], sb[4];
  gather_rows<4, W>(sweep_a, sa);
  gather_rows<4, W>(sweep_b, sb);
  const WideVec2<W> closing = {sa[0] - sb[0], sa[1] - sb[1]};
  const F turning = min(sa[2] + sb[2], F::splat(most_turning * dt)), moved = length(way) + turn;
  const auto anyhow = most_way == zero;
  const F ahead = select(anyhow, length(closing), max(dot(rotate(a, normal), closing), zero - turning)) + turning;
  const auto far = select(anyhow, moved, turn - along) + min(ahead, cap) < gap;
  const auto keeps = (!recycled) & far & (anyhow | (moved < most_way));
  return bitmask(looked_at & (stays | keeps));
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
