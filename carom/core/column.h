// Rows of plain bytes that grow to millions: large ones are pages, which the system moves instead of copying them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <type_traits>
#include <utility>

#include "carom/core/growth.h"
#include "carom/export.h"

namespace carom::core {
namespace detail {

/// Gives a block of `old_bytes` (none: null, 0) another size and keeps what fits; null for 0 bytes. The alignment is a
/// power of two of at most a page.
CAROM_API void* resize_block(void* old, std::size_t old_bytes, std::size_t bytes, std::size_t alignment);

}  // namespace detail

/// A vector of plain values. What a world has one of for every body stands in such: filling a vector to a million costs
/// more in copies and new pages than in what is written.
template <class T>
class Column {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  using value_type = T;

  Column() = default;
  Column(const Column& other) { *this = other; }
  Column(Column&& other) noexcept { swap(other); }
  Column& operator=(const Column& other) {
    if (this == &other) return *this;
    if (capacity_ < other.size_) change_capacity(other.size_);
    size_ = other.size_;
    if (size_ > 0) std::memcpy(static_cast<void*>(data_), other.data_, size_ * sizeof(T));
    return *this;
  }
  Column& operator=(Column&& other) noexcept {
    swap(other);
    return *this;
  }
  ~Column() { change_capacity(0); }

  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }

  void reserve(std::size_t count) {
    if (count > capacity_) change_capacity(count);
  }
  void resize(std::size_t count) {
    reserve(count);
    for (; size_ < count; ++size_) new (static_cast<void*>(data_ + size_)) T();
    size_ = count;
  }
  /// Grows by less than to the double: see next_capacity.
  T& push_back(const T& value) {
    if (size_ == capacity_) {
      const T kept = value;  // it may stand in here
      change_capacity(next_capacity(size_));
      return *new (static_cast<void*>(data_ + size_++)) T(kept);
    }
    return *new (static_cast<void*>(data_ + size_++)) T(value);
  }
  T& back() { return data_[size_ - 1]; }
  void pop_back() { --size_; }
  void clear() { size_ = 0; }
  /// Gives back what is beyond the content.
  void fit() { change_capacity(size_); }
  void swap(Column& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

 private:
  void change_capacity(std::size_t count) {
    if (count == capacity_) return;
    data_ = static_cast<T*>(
        detail::resize_block(data_, capacity_ * sizeof(T), count * sizeof(T), std::max(alignof(T), sizeof(void*))));
    capacity_ = count;
  }
  T* data_ = nullptr;
  std::size_t size_ = 0, capacity_ = 0;
};

}  // namespace carom::core
