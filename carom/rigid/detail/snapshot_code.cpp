#include "carom/rigid/detail/snapshot_code.h"

namespace carom::rigid::detail {
namespace {

constexpr std::uint32_t least_range = 1u << 24;

/// How many bits x has, at least 1.
int length_of(std::uint32_t x) { return x == 0 ? 1 : 32 - __builtin_clz(x); }

}  // namespace

void ByteWriter::shift_out() {
  if (low_ < 0xFF000000u || low_ > 0xFFFFFFFFu) {  // no carry can come any more, or it has
    const std::uint8_t carry = std::uint8_t(low_ >> 32);
    for (; waiting_ > 0; --waiting_) {
      out_.push_back(std::byte(std::uint8_t(cache_ + carry)));
      cache_ = 0xFF;
    }
    cache_ = std::uint8_t(low_ >> 24);
  }
  ++waiting_;
  low_ = (low_ & 0x00FFFFFFu) << 8;
}

void ByteWriter::grow() {
  while (range_ < least_range) {
    range_ <<= 8;
    shift_out();
  }
}

void ByteWriter::bit(BitModel& model, bool x) {
  const std::uint32_t bound = (range_ >> 12) * model.chance();
  if (x)
    low_ += bound, range_ -= bound;
  else
    range_ = bound;
  model.learn(x);
  grow();
}

void ByteWriter::bits(std::uint32_t x, int count) {
  while (count-- > 0) {
    range_ >>= 1;
    if ((x >> count & 1u) != 0) low_ += range_;
    grow();
  }
}

void ByteWriter::finish() {
  for (int i = 0; i < 5; ++i) shift_out();
}

void ByteWriter::changed_word(WordModel& model, std::uint32_t x, bool before) {
  bit(model.changed[before ? 1 : 0], x != 0);
  if (x == 0) return;
  const int length = length_of(x), symbol = length - 1;
  for (int node = 1, k = 4; k >= 0; --k) {
    const bool b = (symbol >> k & 1) != 0;
    bit(model.length[node], b);
    node = 2 * node + (b ? 1 : 0);
  }
  const bool halved = length > 16 && (x & 0xFFFFu) == 0;
  if (length > 16) bit(model.halved, halved);
  bits(halved ? x >> 16 : x, length - 1 - (halved ? 16 : 0));  // the highest is 1
}

void ByteWriter::difference(const std::uint32_t* now, const std::uint32_t* base, std::size_t count,
                            SectionModel& model) {
  const std::size_t size = model.words.size(), elements = (count + size - 1) / size;
  const auto changed = [&](std::size_t i) { return base == nullptr ? now[i] : now[i] ^ base[i]; };
  const auto differs = [&](std::size_t e) {
    for (std::size_t i = e * size; i < (e + 1) * size && i < count; ++i)
      if (changed(i) != 0) return true;
    return false;
  };
  for (std::size_t e = 0; e < elements;) {
    std::size_t equal = 0, different = 0;
    while (e + equal < elements && !differs(e + equal)) ++equal;
    e += equal;
    while (e + different < elements && differs(e + different)) ++different;
    changed_word(model.equal, std::uint32_t(equal));
    changed_word(model.different, std::uint32_t(different));
    for (std::size_t k = 0; k < different; ++k, ++e) {
      bool before = false;
      for (std::size_t w = 0; w < size && e * size + w < count; ++w) {
        const std::uint32_t x = changed(e * size + w);
        changed_word(model.words[w], x, before);
        before = x != 0;
      }
    }
  }
}

ByteReader::ByteReader(std::span<const std::byte> in) : in_(in) {
  take();
  for (int i = 0; i < 4; ++i) code_ = code_ << 8 | take();
}

std::uint8_t ByteReader::take() {
  if (next_ >= in_.size()) return sound_ = false, std::uint8_t(0);
  return std::uint8_t(in_[next_++]);
}

void ByteReader::grow() {
  while (range_ < least_range) {
    range_ <<= 8;
    code_ = code_ << 8 | take();
  }
}

bool ByteReader::bit(BitModel& model) {
  if (!sound_) return false;
  const std::uint32_t bound = (range_ >> 12) * model.chance();
  const bool x = code_ >= bound;
  if (x)
    code_ -= bound, range_ -= bound;
  else
    range_ = bound;
  model.learn(x);
  grow();
  return x;
}

std::uint32_t ByteReader::bits(int count) {
  std::uint32_t x = 0;
  for (; count > 0 && sound_; --count) {
    range_ >>= 1;
    const bool b = code_ >= range_;
    if (b) code_ -= range_;
    x = x << 1 | (b ? 1u : 0u);
    grow();
  }
  return sound_ ? x : 0;
}

std::uint64_t ByteReader::number() {
  std::uint64_t x = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const std::uint8_t b = byte();
    x |= std::uint64_t{std::uint8_t(b & 0x7F)} << shift;
    if (b < 0x80) return x;
  }
  sound_ = false;
  return 0;
}

std::uint32_t ByteReader::changed_word(WordModel& model, bool before) {
  if (!bit(model.changed[before ? 1 : 0])) return 0;
  int symbol = 0;
  for (int node = 1, k = 4; k >= 0; --k) {
    const bool b = bit(model.length[node]);
    symbol = 2 * symbol + (b ? 1 : 0);
    node = 2 * node + (b ? 1 : 0);
  }
  const bool halved = symbol > 15 && bit(model.halved);
  return 1u << symbol | (halved ? bits(symbol - 16) << 16 : bits(symbol));
}

void ByteReader::difference(std::uint32_t* words, std::size_t count, SectionModel& model) {
  const std::size_t size = model.words.size(), elements = (count + size - 1) / size;
  for (std::size_t e = 0; sound_ && e < elements;) {
    const std::size_t equal = changed_word(model.equal), different = changed_word(model.different);
    if (equal > elements - e || different > elements - e - equal || equal + different == 0) return fail();
    e += equal;
    for (std::size_t k = 0; sound_ && k < different; ++k, ++e) {
      bool before = false;
      for (std::size_t w = 0; w < size && e * size + w < count; ++w) {
        const std::uint32_t x = changed_word(model.words[w], before);
        words[e * size + w] ^= x;
        before = x != 0;
      }
    }
  }
}

}  // namespace carom::rigid::detail
