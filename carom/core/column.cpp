#include "carom/core/column.h"

#include <cstdint>
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
/// And of so many large pages, where the system gives them: what is read here and there in a block of megabytes waits
/// for its addresses to be translated no less than for the memory.
constexpr std::size_t large_page = std::size_t(1) << 21, least_large = large_page / 2;

bool is_large(std::size_t bytes) { return bytes >= least_large; }
std::size_t length_of(std::size_t bytes) {
  return is_large(bytes) ? (bytes + large_page - 1) / large_page * large_page : bytes;
}
void* take_pages(std::size_t bytes) {
  const std::size_t length = length_of(bytes), room = is_large(bytes) ? length + large_page : length;
  void* const taken = mmap(nullptr, room, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (taken == MAP_FAILED) std::abort();  // as operator new does where there are no exceptions
  if (!is_large(bytes)) return taken;
  const std::size_t before = (large_page - reinterpret_cast<std::uintptr_t>(taken) % large_page) % large_page;
  char* const block = static_cast<char*>(taken) + before;
  if (before > 0) munmap(taken, before);
  munmap(block + length, large_page - before);
  madvise(block, length, MADV_HUGEPAGE);  // a wish
  return block;
}
void* resize_pages(void* old, std::size_t old_bytes, std::size_t bytes) {
  const std::size_t old_length = length_of(old_bytes), length = length_of(bytes);
  if (old_length == length) return old;
  void* block = mremap(old, old_length, length, is_large(bytes) ? 0 : MREMAP_MAYMOVE);
  if (block == MAP_FAILED && is_large(bytes))  // large pages move to where large pages may stand
    block = mremap(old, old_length, length, MREMAP_MAYMOVE | MREMAP_FIXED, take_pages(bytes));
  if (block == MAP_FAILED) std::abort();
  return block;
}
#else
constexpr std::size_t least_pages = std::size_t(-1);
#endif

void* take_block(std::size_t bytes, std::size_t alignment) {
#if defined(__linux__)
  if (bytes >= least_pages) return take_pages(bytes);
#endif
  return ::operator new(bytes, std::align_val_t(alignment));
}
void give_block(void* block, std::size_t bytes, std::size_t alignment) {
#if defined(__linux__)
  if (bytes >= least_pages) {
    munmap(block, length_of(bytes));
    return;
  }
#endif
  ::operator delete(block, std::align_val_t(alignment));
}

}  // namespace

void* resize_block(void* old, std::size_t old_bytes, std::size_t bytes, std::size_t alignment) {
#if defined(__linux__)
  if (old_bytes >= least_pages && bytes >= least_pages && is_large(old_bytes) == is_large(bytes))
    return resize_pages(old, old_bytes, bytes);
#endif
  void* const block = bytes > 0 ? take_block(bytes, alignment) : nullptr;
  if (old_bytes > 0 && bytes > 0) std::memcpy(block, old, std::min(old_bytes, bytes));
  if (old_bytes > 0) give_block(old, old_bytes, alignment);
  return block;
}

}  // namespace carom::core::detail
