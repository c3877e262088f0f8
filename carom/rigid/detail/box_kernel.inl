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

}  // namespace carom::rigid::detail::CAROM_CONTACT_NAMESPACE
