// Memory that lasts for one step.
#pragma once

#include <cstddef>
#include <new>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "carom/core/column.h"

namespace carom::core {

/// Hands out memory from a block and takes it all back at once. Grows while it must (further blocks); at `reset` the
/// blocks are merged into one as large as all of them, so that it soon never allocates again. For one thread.
class Arena {
 public:
  static constexpr std::size_t alignment = 64;  ///< of everything handed out: a cache line, the widest SIMD register

  explicit Arena(std::size_t bytes = 0) {
    if (bytes > 0) add_block(rounded(bytes));
  }
  ~Arena() { free_blocks(); }
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;
  Arena(Arena&& other) noexcept { swap(other); }
  Arena& operator=(Arena&& other) noexcept {
    swap(other);
    return *this;
  }

  /// Uninitialised, aligned to 64 bytes, good until `reset`.
  std::byte* allocate_bytes(std::size_t bytes) {
    const std::size_t size = rounded(bytes);
    if (blocks_.empty() || blocks_.back().size - used_ < size) {
      const std::size_t last = blocks_.empty() ? 0 : blocks_.back().size;
      add_block(size > last ? size : last);
    }
    std::byte* const result = blocks_.back().data + used_;
    used_ += size;
    in_use_ += size;
    if (in_use_ > peak_) peak_ = in_use_;
    return result;
  }

  /// `count` values of T, uninitialised: write before reading.
  template <class T>
  std::span<T> allocate(std::size_t count) {
    static_assert(std::is_trivially_destructible_v<T> && alignof(T) <= alignment);
    return {reinterpret_cast<T*>(allocate_bytes(count * sizeof(T))), count};
  }
  /// `count` values of T, each T{}.
  template <class T>
  std::span<T> allocate_zeroed(std::size_t count) {
    const std::span<T> values = allocate<T>(count);
    for (T& value : values) new (&value) T{};
    return values;
  }

  /// Takes everything back.
  void reset() {
    if (blocks_.size() > 1) {
      std::size_t total = 0;
      for (const Block& block : blocks_) total += block.size;
      free_blocks();
      add_block(total);
    }
    used_ = in_use_ = 0;
  }

  std::size_t used() const { return in_use_; }  ///< bytes handed out since the last reset
  std::size_t peak() const { return peak_; }    ///< the most that was ever handed out
  std::size_t capacity() const {                ///< bytes held
    std::size_t total = 0;
    for (const Block& block : blocks_) total += block.size;
    return total;
  }
  int block_count() const { return int(blocks_.size()); }

 private:
  struct Block {
    std::byte* data;
    std::size_t size;
  };
  static std::size_t rounded(std::size_t bytes) { return (bytes + alignment - 1) / alignment * alignment; }
  void add_block(std::size_t size) {
    const std::size_t bytes = size < 4096 ? 4096 : size;
    blocks_.push_back({static_cast<std::byte*>(detail::resize_block(nullptr, 0, bytes, alignment)), bytes});
    used_ = 0;
  }
  void free_blocks() {
    for (const Block& block : blocks_) detail::resize_block(block.data, block.size, 0, alignment);
    blocks_.clear();
  }
  void swap(Arena& other) noexcept {
    blocks_.swap(other.blocks_);
    std::swap(used_, other.used_);
    std::swap(in_use_, other.in_use_);
    std::swap(peak_, other.peak_);
  }

  std::vector<Block> blocks_;
  std::size_t used_ = 0, in_use_ = 0, peak_ = 0;
};

}  // namespace carom::core
