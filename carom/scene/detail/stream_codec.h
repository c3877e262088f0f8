// Whole numbers that change little from frame to frame, in few bits: blocks of 64, each with the foretelling (from the
// number before it, from the last frame, from the last two) that leaves the least, and as many bits as that needs.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/scene/detail/bytes.h"

namespace carom::scene::detail {

/// Beyond ±2⁵⁸ no number is written.
inline constexpr std::int64_t stream_limit = std::int64_t{1} << 58;

class StreamCodec {
 public:
  void clear() { now_.clear(), before_.clear(); }
  bool empty() const { return now_.empty(); }
  /// In a key frame nothing is foretold from the frames before.
  void encode(std::span<const std::int64_t> numbers, bool key, ByteWriter& out);
  /// `count` numbers. Spoils `in` where they are beyond the limit or where the bytes end.
  std::span<const std::int64_t> decode(std::size_t count, bool key, ByteReader& in);
  /// The fewest bytes that `count` numbers take.
  static std::size_t least_bytes(std::size_t count) { return (count + block - 1) / block; }

 private:
  static constexpr std::size_t block = 64;
  enum Foretelling : std::uint8_t { from_neighbour, from_last, from_motion };
  std::int64_t foretold(Foretelling how, std::size_t i, std::int64_t neighbour) const;

  std::vector<std::int64_t> now_, before_, next_;
};

}  // namespace carom::scene::detail
