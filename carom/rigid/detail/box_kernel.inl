// Which boxes meet: part of contact_kernel.inl.

namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE {

/// Which of W boxes from `first` on meet box `lane` of the other?
template <int W, class Lanes, class OtherLanes>
CAROM_SIMD_INLINE WideMask<W> boxes_meet(const Lanes& boxes, int first, const OtherLanes& other, int lane) {
  using F = WideFloat<W>;
  WideMask<W> meets = WideMask<W>::all();
#pragma GCC unroll 3
  for (int k = 0; k < Lanes::dimension; ++k)
    meets = meets & (F::load(boxes.low[k] + first) <= F::splat(other.high[k][lane])) &
            (F::load(boxes.high[k] + first) >= F::splat(other.low[k][lane]));
  return meets;
}

template <class D, int W>
void new_meetings(const BoxGroup<D>& group, int members, int others, std::uint64_t* news) {
  for (int i = 0; i < members; ++i) {
    std::uint64_t found = 0;
    for (int k = 0; k < others; k += W) {
      const auto meets =
          boxes_meet<W>(group.others, k, group.boxes, i) & !boxes_meet<W>(group.old_others, k, group.old_boxes, i);
      found |= std::uint64_t(bitmask(meets)) << k;
    }
    news[i] = found;
  }
}

template <int W>
void sweep(const StripRows& rows, std::int32_t begin, std::int32_t end, TellMeetings tell, void* whom) {
  using F = WideFloat<W>;
  for (std::int32_t i = begin; i + 1 < end; ++i) {
    const F low[2] = {F::splat(rows.low[0][i]), F::splat(rows.low[1][i])},
            high[2] = {F::splat(rows.high[0][i]), F::splat(rows.high[1][i])},
            old_low[2] = {F::splat(rows.old_low[0][i]), F::splat(rows.old_low[1][i])},
            old_high[2] = {F::splat(rows.old_high[0][i]), F::splat(rows.old_high[1][i])};
    const std::uint16_t last = rows.last[i];
    for (std::int32_t k = i + 1; k < end && rows.key[k] <= last; k += W) {
      const auto load = [&](const float* row) __attribute__((always_inline)) { return F::load(row + k); };
      const auto meets = (load(rows.low[0]) <= high[0]) & (load(rows.high[0]) >= low[0]) &
                         (load(rows.low[1]) <= high[1]) & (load(rows.high[1]) >= low[1]);
      const auto met = (load(rows.old_low[0]) <= old_high[0]) & (load(rows.old_high[0]) >= old_low[0]) &
                       (load(rows.old_low[1]) <= old_high[1]) & (load(rows.old_high[1]) >= old_low[1]);
      if (const std::uint32_t news = bitmask(meets & !met); news != 0) tell(whom, i, k, news);
    }
  }
}

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
