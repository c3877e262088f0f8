// The bytes of a fuzzer as numbers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace carom::fuzz {

class Source {
 public:
  Source(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {}
  bool empty() const { return size_ == 0; }
  std::uint8_t byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }
  bool flag() { return (byte() & 1) != 0; }
  /// Mostly what a game says, sometimes what nobody should.
  float number(float scale = 1) {
    const std::uint8_t kind = byte();
    if (kind < 200) return scale * (float(byte()) - 100) / 32;
    switch (kind % 8) {
      case 0:
        return std::numeric_limits<float>::quiet_NaN();
      case 1:
        return std::numeric_limits<float>::infinity();
      case 2:
        return -1e30f;
      case 3:
        return 1e12f;
      case 4:
        return 1e-30f;
      case 5:
        return -0.0f;
      case 6: {
        std::uint32_t bits = 0;
        for (int i = 0; i < 4; ++i) bits = bits << 8 | byte();
        float x;
        std::memcpy(&x, &bits, 4);
        return x;
      }
      default:
        return scale * 1e5f;
    }
  }
  /// Of a size that can be: mostly.
  float size() { return byte() < 240 ? 0.05f + float(byte()) / 128 : number(); }
  std::vector<std::byte> rest(std::size_t most) {
    std::vector<std::byte> bytes;
    while (size_ > 0 && bytes.size() < most) bytes.push_back(std::byte(byte()));
    return bytes;
  }

 private:
  const std::uint8_t* data_;
  std::size_t size_;
};

}  // namespace carom::fuzz
