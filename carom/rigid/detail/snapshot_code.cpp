#include "carom/rigid/detail/snapshot_code.h"

namespace carom::rigid::detail {

void ByteWriter::difference(const std::uint32_t* now, const std::uint32_t* base, std::size_t count) {
  const auto changed = [&](std::size_t i) { return base == nullptr ? now[i] : now[i] ^ base[i]; };
  // What came last is equal to the base and needs no word.
  while (count > 0 && changed(count - 1) == 0) --count;
  number(count);
  for (std::size_t i = 0; i < count;) {
    std::size_t equal = 0;
    while (changed(i + equal) == 0) ++equal;
    i += equal;
    // A single equal word between others is cheaper as one of them.
    std::size_t different = 0;
    while (i + different < count &&
           (changed(i + different) != 0 || (i + different + 1 < count && changed(i + different + 1) != 0)))
      ++different;
    number(equal);
    number(different);
    for (std::size_t k = 0; k < different; k += 4) {
      const std::size_t group = different - k < 4 ? different - k : 4;
      std::uint8_t lengths = 0;
      for (std::size_t j = 0; j < group; ++j) {
        const std::uint32_t x = changed(i + k + j);
        lengths = std::uint8_t(lengths | (x > 0xFFFFFF ? 3 : (x > 0xFFFF ? 2 : (x > 0xFF ? 1 : 0))) << (2 * j));
      }
      byte(lengths);
      for (std::size_t j = 0; j < group; ++j) {
        const std::uint32_t x = changed(i + k + j);
        for (int b = 0; b <= (lengths >> (2 * j) & 3); ++b) byte(std::uint8_t(x >> (8 * b)));
      }
    }
    i += different;
  }
}

std::uint64_t ByteReader::word() {
  std::uint64_t x = 0;
  for (int i = 0; i < 8; ++i) x |= std::uint64_t{byte()} << (8 * i);
  return x;
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

void ByteReader::difference(std::uint32_t* words, std::size_t count) {
  const std::uint64_t written = number();
  if (written > count) return fail();
  for (std::uint64_t i = 0; sound_ && i < written;) {
    const std::uint64_t equal = number(), different = number();
    if (equal > written - i || different > written - i - equal || different == 0) return fail();
    i += equal;
    for (std::uint64_t k = 0; sound_ && k < different; k += 4) {
      const std::uint8_t lengths = byte();
      for (std::uint64_t j = 0; j < 4 && k + j < different; ++j) {
        std::uint32_t x = 0;
        for (int b = 0; b <= (lengths >> (2 * j) & 3); ++b) x |= std::uint32_t{byte()} << (8 * b);
        words[i + k + j] ^= x;
      }
    }
    i += different;
  }
}

}  // namespace carom::rigid::detail
