// Snapshots as bytes: words as what changed against those of a base, written short.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::rigid::detail {

/// Appends numbers to bytes, lowest byte first.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}
  void byte(std::uint8_t x) { out_.push_back(std::byte(x)); }
  void word(std::uint64_t x) {
    for (int i = 0; i < 8; ++i) byte(std::uint8_t(x >> (8 * i)));
  }
  /// Seven bits a byte, the lowest first.
  void number(std::uint64_t x) {
    for (; x >= 0x80; x >>= 7) byte(std::uint8_t(x | 0x80));
    byte(std::uint8_t(x));
  }
  /// now ⊕ base: runs of equal words are counted, others written in as few bytes as they need. A null base is zero.
  void difference(const std::uint32_t* now, const std::uint32_t* base, std::size_t count);

 private:
  std::vector<std::byte>& out_;
};

/// Reads them back. Past the end, or at a number that cannot be, all that follows is zero and `sound` is false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> in) : in_(in) {}
  bool sound() const { return sound_; }
  bool at_end() const { return next_ == in_.size(); }
  std::size_t left() const { return in_.size() - next_; }
  void fail() { sound_ = false; }
  std::uint8_t byte() {
    if (!sound_ || next_ >= in_.size()) return sound_ = false, std::uint8_t(0);
    return std::uint8_t(in_[next_++]);
  }
  std::uint64_t word();
  std::uint64_t number();
  /// Turns `words`, which hold the base, into what was written.
  void difference(std::uint32_t* words, std::size_t count);

 private:
  std::span<const std::byte> in_;
  std::size_t next_ = 0;
  bool sound_ = true;
};

}  // namespace carom::rigid::detail
