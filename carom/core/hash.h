// A 64-bit hash of states, the same on every machine: for comparing runs, not for hash tables against attackers.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace carom::core {

/// Streaming. Each 64-bit word w: state ← rotl(state ⊕ w·K₁, 27)·K₂ + K₃; the digest mixes in the number of words
/// and finishes with two xor-shift multiplications. Smaller values are widened to one word each. A float or double
/// goes in by its bits, −0 as +0, and every NaN as the same NaN, since only the numbers of a state matter.
class StateHash {
 public:
  constexpr StateHash& add(std::uint64_t word) {
    state_ = std::rotl(state_ ^ word * 0x9E3779B97F4A7C15u, 27) * 0xC2B2AE3D27D4EB4Fu + 0x165667B19E3779F9u;
    ++count_;
    return *this;
  }
  constexpr StateHash& add(std::uint32_t value) { return add(std::uint64_t{value}); }
  constexpr StateHash& add(std::int32_t value) { return add(std::uint64_t(std::int64_t{value})); }
  constexpr StateHash& add(std::int64_t value) { return add(std::uint64_t(value)); }
  constexpr StateHash& add(bool value) { return add(std::uint64_t{value}); }
  constexpr StateHash& add(double value) {
    if (value != value) return add(std::uint64_t{0x7FF8000000000000u});
    return add(std::bit_cast<std::uint64_t>(value == 0 ? 0.0 : value));
  }
  constexpr StateHash& add(float value) {
    if (value != value) return add(std::uint64_t{0x7FC00000u});
    return add(std::uint64_t{std::bit_cast<std::uint32_t>(value == 0 ? 0.0f : value)});
  }
  /// Length first, then eight bytes a word, lowest byte first, the last word filled with zeros.
  constexpr StateHash& add(std::string_view bytes) {
    add(std::uint64_t{bytes.size()});
    for (std::size_t i = 0; i < bytes.size(); i += 8) {
      std::uint64_t word = 0;
      for (std::size_t j = 0; j < 8 && i + j < bytes.size(); ++j)
        word |= std::uint64_t{static_cast<unsigned char>(bytes[i + j])} << (8 * j);
      add(word);
    }
    return *this;
  }
  constexpr StateHash& add(const char* bytes) { return add(std::string_view(bytes)); }

  constexpr std::uint64_t digest() const {
    std::uint64_t h = state_ ^ count_;
    h = (h ^ h >> 30) * 0xBF58476D1CE4E5B9u;
    h = (h ^ h >> 27) * 0x94D049BB133111EBu;
    return h ^ h >> 31;
  }

 private:
  std::uint64_t state_ = 0;
  std::uint64_t count_ = 0;
};

}  // namespace carom::core
