// Snapshots as bytes: words as what changed against those of a base, through a range coder whose models learn how many
// bits each word of a kind of record is wont to change (Martin 1979; carry propagation after Schindler 1998).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace carom::rigid::detail {

/// The chance that a bit is 0: the mean of those before at first, of the last thirty or so later.
class BitModel {
 public:
  std::uint32_t chance() const { return zero_ >> 4; }  ///< 1/4096, never 0 or 1
  void learn(bool bit) {
    const int target = bit ? 48 : 65536 - 48;
    zero_ = std::uint16_t(zero_ + (target - zero_) * rates[seen_] / 65536);
    if (seen_ + 1u < rates.size()) ++seen_;
  }

 private:
  static constexpr std::array<int, 30> rates = [] {
    std::array<int, 30> all{};
    for (int n = 0; n < 30; ++n) all[std::size_t(n)] = n == 0 ? 32767 : int(65536 / (n + 1.6));
    return all;
  }();
  std::uint16_t zero_ = 32768;  ///< 1/65536
  std::uint16_t seen_ = 0;
};

/// For one word of a record: whether it changed, where the word before it did or not, and if, its length in bits; and
/// of a long one, whether its lower half is zero.
struct WordModel {
  BitModel changed[2], length[32], halved;
};

/// What is known of a section while it is coded.
struct SectionModel {
  std::vector<WordModel> words;  ///< of an element
  WordModel equal, different;    ///< lengths of runs of elements
  explicit SectionModel(std::size_t element_words) : words(element_words < 1 ? 1 : element_words) {}
};

/// Appends numbers to bytes. Call finish() last.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::byte>& out) : out_(out) {}
  void byte(std::uint8_t x) { bits(x, 8); }
  void word(std::uint64_t x) {
    bits(std::uint32_t(x), 32);
    bits(std::uint32_t(x >> 32), 32);
  }
  /// Seven bits a byte, the lowest first.
  void number(std::uint64_t x) {
    for (; x >= 0x80; x >>= 7) byte(std::uint8_t(x | 0x80));
    byte(std::uint8_t(x));
  }
  /// now ⊕ base, element by element of the model. A null base is zero.
  void difference(const std::uint32_t* now, const std::uint32_t* base, std::size_t count, SectionModel& model);
  void bit(BitModel& model, bool x);
  void finish();

 private:
  void bits(std::uint32_t x, int count);
  void changed_word(WordModel& model, std::uint32_t x, bool before = false);
  void grow();
  void shift_out();

  std::vector<std::byte>& out_;
  std::uint64_t low_ = 0;
  std::uint32_t range_ = 0xFFFFFFFFu;
  std::uint8_t cache_ = 0;
  std::uint64_t waiting_ = 1;
};

/// Reads them back. Past the end, or at a number that cannot be, all that follows is zero and `sound` is false.
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::byte> in);
  bool sound() const { return sound_; }
  bool at_end() const { return next_ == in_.size(); }
  std::size_t left() const { return in_.size() - next_; }
  void fail() { sound_ = false; }
  /// Can so many words stand in what was written, runs of zeros and all? Keeps a few forged bytes from asking for all
  /// the memory there is.
  bool plausible(std::uint64_t words) const { return words <= (std::uint64_t{1} << 22) + (in_.size() << 16); }
  std::uint8_t byte() { return std::uint8_t(bits(8)); }
  std::uint64_t word() {
    const std::uint64_t low = bits(32);
    return low | std::uint64_t{bits(32)} << 32;
  }
  bool bit(BitModel& model);
  std::uint64_t number();
  /// Turns `words`, which hold the base, into what was written.
  void difference(std::uint32_t* words, std::size_t count, SectionModel& model);

 private:
  std::uint32_t bits(int count);
  std::uint32_t changed_word(WordModel& model, bool before = false);
  void grow();
  std::uint8_t take();

  std::span<const std::byte> in_;
  std::size_t next_ = 0;
  std::uint32_t code_ = 0, range_ = 0xFFFFFFFFu;
  bool sound_ = true;
};

}  // namespace carom::rigid::detail
