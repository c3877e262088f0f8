// Snapshots whose content was changed by someone who then made the checksums right: what decode cannot know.
#pragma once

#include <cstring>

#include "carom/rigid/detail/snapshot_data.h"
#include "carom/rigid/snapshot.h"

namespace carom::rigid::detail {
struct SnapshotAccess {
  template <class D>
  static SnapshotData<D>& data(Snapshot<D>& snapshot) {
    return *snapshot.self_;
  }
};
}  // namespace carom::rigid::detail

namespace carom::rigid::test {

/// Changes a word, a byte or a bit of any section, all alike, so that short ones (counts, heads of lists) are met as
/// often as long ones. draw() gives 32 random bits.
template <class D, class Draw>
void forge(Snapshot<D>& snapshot, Draw&& draw) {
  detail::SnapshotData<D>& data = detail::SnapshotAccess::data(snapshot);
  detail::SnapshotSection s;
  for (int i = 0; i < 1000 && s.count == 0; ++i) s = data.sections[draw() % data.sections.size()];
  if (s.count == 0) return;
  std::byte* const bytes = reinterpret_cast<std::byte*>(data.image.data() + s.first);
  const std::size_t size = std::size_t(s.count * s.element), place = std::size_t(draw()) % size;
  const std::size_t word = place & ~std::size_t{3};
  const std::uint32_t small = draw() % 64, any = draw();
  switch (draw() % 6) {
    case 0:
      bytes[place] ^= std::byte(1u << draw() % 8);
      break;
    case 1:
      bytes[place] = std::byte(std::uint8_t(any));
      break;
    case 2:
      if (word + 4 <= size) std::memcpy(bytes + word, &small, 4);
      break;
    case 3: {
      const std::uint32_t extreme[] = {0xFFFFFFFFu, 0x7FFFFFFFu, 0x80000000u, 0x7FC00000u, 0x7F800000u, 0};
      if (word + 4 <= size) std::memcpy(bytes + word, &extreme[any % 6], 4);
      break;
    }
    case 4:
      if (word + 4 <= size) std::memcpy(bytes + word, &any, 4);
      break;
    default: {  // by one: the index of a neighbour
      std::uint32_t x = 0;
      if (word + 4 > size) break;
      std::memcpy(&x, bytes + word, 4);
      x += any % 2 == 0 ? 1u : ~0u;
      std::memcpy(bytes + word, &x, 4);
    }
  }
}

}  // namespace carom::rigid::test
