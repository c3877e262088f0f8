// A fixed number of floats on a 64-byte boundary, so that no register straddles two cache lines.
#pragma once

#include <cstddef>
#include <cstring>
#include <new>
#include <utility>

namespace carom::particles::detail {

class AlignedFloats {
 public:
  AlignedFloats() = default;
  explicit AlignedFloats(std::size_t count) : count_(count) {
    if (count == 0) return;
    data_ = static_cast<float*>(::operator new(count * sizeof(float), std::align_val_t{64}));
    std::memset(data_, 0, count * sizeof(float));
  }
  AlignedFloats(const AlignedFloats& other) : AlignedFloats(other.count_) {
    if (count_ > 0) std::memcpy(data_, other.data_, count_ * sizeof(float));
  }
  AlignedFloats(AlignedFloats&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), count_(std::exchange(other.count_, 0)) {}
  AlignedFloats& operator=(AlignedFloats other) noexcept {
    std::swap(data_, other.data_);
    std::swap(count_, other.count_);
    return *this;
  }
  ~AlignedFloats() {
    if (data_ != nullptr) ::operator delete(data_, std::align_val_t{64});
  }

  float* data() { return data_; }
  const float* data() const { return data_; }
  std::size_t size() const { return count_; }
  float& operator[](std::size_t i) { return data_[i]; }
  float operator[](std::size_t i) const { return data_[i]; }

 private:
  float* data_ = nullptr;
  std::size_t count_ = 0;
};

}  // namespace carom::particles::detail
