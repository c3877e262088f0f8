// Memory of many megabytes, in pages of its size.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "carom/export.h"

namespace carom::core {

/// Asks the system to back a block that has not been written yet by large pages, where there are such: a million bodies
/// are 800 MB, and a fault for each 4 kB of them takes longer than to fill them. Small blocks are left alone.
CAROM_API void prefer_large_pages(void* block, std::size_t bytes);

/// Makes room for `capacity` elements, as reserve does, in large pages.
template <class T>
void reserve_large(std::vector<T>& v, std::size_t capacity) {
  if (capacity <= v.capacity()) return;
  std::vector<T> grown;
  grown.reserve(capacity);
  prefer_large_pages(static_cast<void*>(grown.data()), capacity * sizeof(T));
  for (T& x : v) grown.push_back(std::move(x));
  v.swap(grown);
}

}  // namespace carom::core
