// How vectors grow that hold what a world holds.
#pragma once

#include <cstddef>
#include <vector>

namespace carom::core {

/// Vectors double by themselves; a world of sleepers should pay for what it holds. What is large grows faster: most of
/// the time of filling it goes into copies and new pages.
inline std::size_t next_capacity(std::size_t now) { return now + now / (now < (1 << 16) ? 4 : 2) + 16; }

/// Makes room for one more.
template <class T>
void grow_a_little(std::vector<T>& v) {
  if (v.size() == v.capacity()) v.reserve(next_capacity(v.size()));
}

}  // namespace carom::core
