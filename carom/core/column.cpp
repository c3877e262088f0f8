#include "carom/core/column.h"

#include <cstdlib>
#include <new>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace carom::core::detail {
namespace {

#if defined(__linux__)
/// Blocks of so many bytes are pages of their own.
constexpr std::size_t least_pages = std::size_t(1) << 18;
#else
constexpr std::size_t least_pages = std::size_t(-1);
#endif

void* take_block(std::size_t bytes, std::size_t alignment) {
#if defined(__linux__)
  if (bytes >= least_pages) {
    void* const block = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    if (block == MAP_FAILED) std::abort();  // as operator new does where there are no exceptions
    return block;
  }
#endif
  return ::operator new(bytes, std::align_val_t(alignment));
}
void give_block(void* block, std::size_t bytes, std::size_t alignment) {
#if defined(__linux__)
  if (bytes >= least_pages) {
    munmap(block, bytes);
    return;
  }
#endif
  ::operator delete(block, std::align_val_t(alignment));
}

}  // namespace

void* resize_block(void* old, std::size_t old_bytes, std::size_t bytes, std::size_t alignment) {
#if defined(__linux__)
  if (old_bytes >= least_pages && bytes >= least_pages) {
    void* const block = mremap(old, old_bytes, bytes, MREMAP_MAYMOVE);
    if (block == MAP_FAILED) std::abort();
    return block;
  }
#endif
  void* const block = bytes > 0 ? take_block(bytes, alignment) : nullptr;
  if (old_bytes > 0 && bytes > 0) std::memcpy(block, old, std::min(old_bytes, bytes));
  if (old_bytes > 0) give_block(old, old_bytes, alignment);
  return block;
}

}  // namespace carom::core::detail
