#pragma once

namespace carom::geometry::detail {

/// Room for N values that are written before they are read: clearing it in every call costs more than the work done.
template <class T, int N>
struct RawArray {
  union {
    T items[N];
  };
  RawArray() {}
  T& operator[](int i) { return items[i]; }
  const T& operator[](int i) const { return items[i]; }
};

}  // namespace carom::geometry::detail
