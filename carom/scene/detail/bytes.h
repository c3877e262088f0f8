// Little-endian bytes, written and read with every bound checked.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace carom::scene::detail {

class ByteWriter {
 public:
  std::vector<std::uint8_t> bytes;

  template <class T>
  void fixed(T value) {
    for (std::size_t i = 0; i < sizeof(T); ++i) bytes.push_back(std::uint8_t(std::uint64_t(value) >> (8 * i)));
  }
  void number(double value) { fixed(std::bit_cast<std::uint64_t>(value)); }
  void number(float value) { fixed(std::bit_cast<std::uint32_t>(value)); }
  /// Seven bits a byte, the lowest first.
  void varint(std::uint64_t value) {
    while (value >= 0x80) {
      bytes.push_back(std::uint8_t(value | 0x80));
      value >>= 7;
    }
    bytes.push_back(std::uint8_t(value));
  }
  void text(std::string_view s) {
    varint(s.size());
    bytes.insert(bytes.end(), s.begin(), s.end());
  }
};

/// After the first read beyond the end every read gives zero and `good` is false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}
  bool good() const { return good_; }
  void spoil() { good_ = false; }
  std::size_t left() const { return bytes_.size() - at_; }

  template <class T>
  T fixed() {
    if (!have(sizeof(T))) return 0;
    std::uint64_t value = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) value |= std::uint64_t(bytes_[at_ + i]) << (8 * i);
    at_ += sizeof(T);
    return T(value);
  }
  double number() { return std::bit_cast<double>(fixed<std::uint64_t>()); }
  float small_number() { return std::bit_cast<float>(fixed<std::uint32_t>()); }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      const std::uint8_t byte = fixed<std::uint8_t>();
      value |= std::uint64_t(byte & 0x7F) << shift;
      if ((byte & 0x80) == 0) return value;
    }
    good_ = false;
    return 0;
  }
  /// A count of things that take at least `bytes_each` bytes: more than can follow is damage, not a reason to allocate.
  std::size_t count(std::size_t bytes_each) {
    const std::uint64_t n = varint();
    if (n > left() / bytes_each) good_ = false;
    return good_ ? std::size_t(n) : 0;
  }
  std::string text() {
    const std::size_t n = count(1);
    std::string s(reinterpret_cast<const char*>(bytes_.data() + at_), n);
    at_ += n;
    return s;
  }

 private:
  bool have(std::size_t n) {
    if (left() < n) good_ = false;
    return good_;
  }
  std::span<const std::uint8_t> bytes_;
  std::size_t at_ = 0;
  bool good_ = true;
};

}  // namespace carom::scene::detail
