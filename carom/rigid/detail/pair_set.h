// Which pairs of shapes already have a contact: a set of 64-bit keys with open addressing. Never iterated, so the order
// of its slots has no influence on anything.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

namespace carom::rigid::detail {

class PairSet {
 public:
  static std::uint64_t key(std::int32_t a, std::int32_t b) {
    return a < b ? std::uint64_t(std::uint32_t(a)) << 32 | std::uint32_t(b)
                 : std::uint64_t(std::uint32_t(b)) << 32 | std::uint32_t(a);
  }
  bool contains(std::uint64_t key) const {
    if (keys_.empty()) return false;
    for (std::size_t i = home(key);; i = (i + 1) & mask_) {
      if (keys_[i] == key) return true;
      if (keys_[i] == empty) return false;
    }
  }
  /// Calls for the memory that contains, insert and erase will ask for. Inlined always: to gcc it has no effect.
  [[gnu::always_inline]] void prefetch(std::uint64_t key) const {
    if (!keys_.empty()) __builtin_prefetch(&keys_[home(key)]);
  }
  void insert(std::uint64_t key) {
    if (4 * (count_ + 1) > 3 * keys_.size()) grow();
    std::size_t i = home(key);
    while (keys_[i] != empty) {
      if (keys_[i] == key) return;
      i = (i + 1) & mask_;
    }
    keys_[i] = key;
    ++count_;
  }
  void erase(std::uint64_t key) {
    if (keys_.empty()) return;
    std::size_t i = home(key);
    while (keys_[i] != key) {
      if (keys_[i] == empty) return;
      i = (i + 1) & mask_;
    }
    --count_;
    // Close the gap: move back every later key of the run that could stand at or before it.
    for (std::size_t j = (i + 1) & mask_; keys_[j] != empty; j = (j + 1) & mask_) {
      const std::size_t h = home(keys_[j]);
      if (((j - h) & mask_) >= ((j - i) & mask_)) {
        keys_[i] = keys_[j];
        i = j;
      }
    }
    keys_[i] = empty;
  }
  void reserve(std::size_t count) {
    while (4 * count > 3 * keys_.size()) grow();
  }
  /// For who restores one: does a search find every key, and end for every other?
  bool sound() const {
    if (keys_.empty()) return mask_ == 0 && count_ == 0;
    if ((keys_.size() & (keys_.size() - 1)) != 0 || mask_ != keys_.size() - 1) return false;
    std::size_t last = keys_.size();  // an empty place, from which to go round
    for (std::size_t i = 0; i < keys_.size() && last == keys_.size(); ++i)
      if (keys_[i] == empty) last = i;
    if (last == keys_.size()) return false;
    std::size_t found = 0;
    for (std::size_t k = 1, run = 0; k <= mask_; ++k) {
      const std::size_t i = (last + k) & mask_;
      run = keys_[i] == empty ? 0 : run + 1;
      if (run == 0) continue;
      ++found;
      if (((i - home(keys_[i])) & mask_) >= run) return false;  // its search ends before it
    }
    return found == count_;
  }
  std::size_t size() const { return count_; }
  /// Keeps the room.
  void clear() {
    std::fill(keys_.begin(), keys_.end(), empty);
    mask_ = keys_.empty() ? 0 : keys_.size() - 1;
    count_ = 0;
  }
  /// Calls visit(member) for everything that changes. `set` may be const.
  template <class Set, class Visit>
  static void visit_members(Set& set, Visit&& visit) {
    visit(set.keys_);
    visit(set.mask_);
    visit(set.count_);
  }

 private:
  static constexpr std::uint64_t empty = 0;  ///< no pair has it: the two shapes of a pair differ
  std::size_t home(std::uint64_t key) const {
    std::uint64_t h = key * 0x9E3779B97F4A7C15u;
    h ^= h >> 32;
    return std::size_t(h) & mask_;
  }
  void grow() {
    std::vector<std::uint64_t> old;
    old.swap(keys_);
    keys_.assign(old.empty() ? 64 : 2 * old.size(), empty);
    mask_ = keys_.size() - 1;
    count_ = 0;
    for (std::uint64_t key : old)
      if (key != empty) insert(key);
  }
  std::vector<std::uint64_t> keys_;
  std::size_t mask_ = 0, count_ = 0;
};

}  // namespace carom::rigid::detail
