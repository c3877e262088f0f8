#include "carom/scene/detail/stream_codec.h"

#include <algorithm>
#include <bit>

namespace carom::scene::detail {
namespace {

/// Small for what is near zero, of either sign.
std::uint64_t folded(std::int64_t x) { return std::uint64_t(x) << 1 ^ std::uint64_t(x >> 63); }
std::int64_t unfolded(std::uint64_t x) { return std::int64_t(x >> 1) ^ -std::int64_t(x & 1); }

}  // namespace

std::int64_t StreamCodec::foretold(Foretelling how, std::size_t i, std::int64_t neighbour) const {
  if (how == from_neighbour || i >= now_.size()) return neighbour;
  if (how == from_last || i >= before_.size()) return now_[i];
  return 2 * now_[i] - before_[i];
}

void StreamCodec::encode(std::span<const std::int64_t> numbers, bool key, ByteWriter& out) {
  if (key) clear();
  for (std::size_t first = 0; first < numbers.size(); first += block) {
    const std::size_t last = std::min(first + block, numbers.size());
    Foretelling best = from_neighbour;
    int width = 64;
    for (const Foretelling how : {from_neighbour, from_last, from_motion}) {
      if (key && how != from_neighbour) break;
      std::uint64_t all = 0;
      for (std::size_t i = first; i < last; ++i)
        all |= folded(numbers[i] - foretold(how, i, i == 0 ? 0 : numbers[i - 1]));
      if (const int bits = int(std::bit_width(all)); bits < width) width = bits, best = how;
    }
    out.fixed(std::uint8_t(best << 6 | width));
    std::uint64_t waiting = 0;
    int waiting_bits = 0;
    for (std::size_t i = first; i < last; ++i) {
      std::uint64_t rest = folded(numbers[i] - foretold(best, i, i == 0 ? 0 : numbers[i - 1]));
      for (int left = width; left > 0;) {
        const int part = std::min(left, 8 - waiting_bits);
        waiting |= (rest & ((1u << part) - 1)) << waiting_bits;
        rest >>= part, left -= part, waiting_bits += part;
        if (waiting_bits == 8) out.bytes.push_back(std::uint8_t(waiting)), waiting = 0, waiting_bits = 0;
      }
    }
    if (waiting_bits > 0) out.bytes.push_back(std::uint8_t(waiting));
  }
  before_.swap(now_);
  now_.assign(numbers.begin(), numbers.end());
}

std::span<const std::int64_t> StreamCodec::decode(std::size_t count, bool key, ByteReader& in) {
  if (key) clear();
  if (least_bytes(count) > in.left()) in.spoil();
  if (!in.good()) return {};
  next_.resize(count);
  for (std::size_t first = 0; first < count; first += block) {
    const std::size_t last = std::min(first + block, count);
    const std::uint8_t head = in.fixed<std::uint8_t>();
    const int width = head & 63;
    if (head >> 6 > from_motion || (key && head >> 6 != from_neighbour)) in.spoil();
    const auto how = Foretelling(head >> 6);
    std::uint64_t waiting = 0;
    int waiting_bits = 0;
    for (std::size_t i = first; i < last; ++i) {
      std::uint64_t rest = 0;
      for (int done = 0; done < width;) {
        if (waiting_bits == 0) waiting = in.fixed<std::uint8_t>(), waiting_bits = 8;
        const int part = std::min(width - done, waiting_bits);
        rest |= (waiting & ((1u << part) - 1)) << done;
        waiting >>= part, waiting_bits -= part, done += part;
      }
      // In unsigned arithmetic: damage must not overflow.
      const auto value =
          std::int64_t(std::uint64_t(foretold(how, i, i == 0 ? 0 : next_[i - 1])) + std::uint64_t(unfolded(rest)));
      if (value > stream_limit || value < -stream_limit) in.spoil();
      if (!in.good()) return {};
      next_[i] = value;
    }
  }
  before_.swap(now_);
  now_.swap(next_);
  return now_;
}

}  // namespace carom::scene::detail
