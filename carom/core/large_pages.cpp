#include "carom/core/large_pages.h"

#if defined(__linux__)
#include <sys/mman.h>

#include <cstdint>
#endif

namespace carom::core {

void prefer_large_pages(void* block, std::size_t bytes) {
#if defined(__linux__)
  constexpr std::size_t page = 2u << 20;
  if (bytes < 4 * page) return;
  // Only whole pages inside the block; what does not work changes nothing.
  const std::uintptr_t begin = (reinterpret_cast<std::uintptr_t>(block) + page - 1) / page * page;
  const std::uintptr_t end = (reinterpret_cast<std::uintptr_t>(block) + bytes) / page * page;
  (void)madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#else
  (void)block;
  (void)bytes;
#endif
}

}  // namespace carom::core
