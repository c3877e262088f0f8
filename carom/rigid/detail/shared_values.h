// Values that many have in common, each kept once and named by a number.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "carom/core/growth.h"

namespace carom::rigid::detail {

/// T has operator== and hash(). Which number a value has follows from the calls made and from nothing else.
template <class T>
class SharedValues {
 public:
  const T& operator[](std::int32_t number) const { return values_[std::size_t(number)]; }
  int size() const { return int(values_.size() - free_.size()); }

  /// The number of the value, with one user more.
  std::int32_t take(const T& value) {
    const std::uint64_t hash = value.hash();
    if (!first_.empty())
      for (std::int32_t i = first_[hash & (first_.size() - 1)]; i >= 0; i = next_[std::size_t(i)])
        if (values_[std::size_t(i)] == value) return ++users_[std::size_t(i)], i;
    std::int32_t number = std::int32_t(values_.size());
    if (free_.empty()) {
      core::grow_a_little(values_), values_.push_back(value);
      core::grow_a_little(users_), users_.push_back(1);
    } else {
      number = free_.back();
      free_.pop_back();
      values_[std::size_t(number)] = value;
      users_[std::size_t(number)] = 1;
    }
    if (values_.size() > first_.size())
      link();
    else
      link(number, hash);
    return number;
  }
  void drop(std::int32_t number) {
    if (--users_[std::size_t(number)] > 0) return;
    std::int32_t* at = &first_[values_[std::size_t(number)].hash() & (first_.size() - 1)];
    while (*at != number) at = &next_[std::size_t(*at)];
    *at = next_[std::size_t(number)];
    free_.push_back(number);
  }
  /// After a snapshot was read.
  void link() {
    std::size_t count = 16;
    while (count < values_.size() * 2) count *= 2;
    first_.assign(count, -1);
    for (std::size_t i = 0; i < values_.size(); ++i)
      if (users_[i] > 0) link(std::int32_t(i), values_[i].hash());
  }
  /// Before link(), for who restores them: `users` counts those of each number (the rest is free), and is used up.
  bool sound(std::vector<std::int32_t>& users) const {
    if (users_.size() != values_.size() || users != users_) return false;
    for (const std::int32_t number : free_) {
      if (number < 0 || std::size_t(number) >= users.size() || users[std::size_t(number)] != 0) return false;
      users[std::size_t(number)] = 1;
    }
    return std::find(users.begin(), users.end(), 0) == users.end();
  }
  std::size_t count() const { return values_.size(); }
  std::size_t bytes_of_links() const { return (first_.capacity() + next_.capacity()) * sizeof(std::int32_t); }
  /// Calls visit(member) for all that the links do not follow from.
  template <class Values, class Visit>
  static void visit_members(Values& values, Visit&& visit) {
    visit(values.values_);
    visit(values.users_);
    visit(values.free_);
  }

 private:
  void link(std::int32_t number, std::uint64_t hash) {
    std::int32_t& first = first_[hash & (first_.size() - 1)];
    if (next_.size() <= std::size_t(number)) {
      if (next_.capacity() < values_.size()) next_.reserve(values_.capacity());
      next_.resize(std::size_t(number) + 1);
    }
    next_[std::size_t(number)] = first;
    first = number;
  }
  std::vector<T> values_;
  std::vector<std::int32_t> users_, free_;
  std::vector<std::int32_t> first_, next_;  ///< chains by hash
};

}  // namespace carom::rigid::detail
