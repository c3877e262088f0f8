// What the trees share: the cost of a box, box tests without branches, and the binned split of a bulk build.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/geometry/bounds.h"

namespace carom::geometry::detail {

/// Proportional to the chance that a random line meets the box (the surface area heuristic's measure).
template <class T>
constexpr T surface(const Bounds<Vec2<T>>& b) {
  const Vec2<T> d = b.high - b.low;
  return d.x + d.y;
}
template <class T>
constexpr T surface(const Bounds<Vec3<T>>& b) {
  const Vec3<T> d = b.high - b.low;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

template <class T>
constexpr bool boxes_meet(const Bounds<Vec2<T>>& a, const Bounds<Vec2<T>>& b) {
  return bool(int(a.low.x <= b.high.x) & int(b.low.x <= a.high.x) & int(a.low.y <= b.high.y) &
              int(b.low.y <= a.high.y));
}
template <class T>
constexpr bool boxes_meet(const Bounds<Vec3<T>>& a, const Bounds<Vec3<T>>& b) {
  return bool(int(a.low.x <= b.high.x) & int(b.low.x <= a.high.x) & int(a.low.y <= b.high.y) &
              int(b.low.y <= a.high.y) & int(a.low.z <= b.high.z) & int(b.low.z <= a.high.z));
}

#if defined(__SSE2__)
/// Both axes at once.
inline bool boxes_meet(const Bounds<Vec2<double>>& a, const Bounds<Vec2<double>>& b) {
  typedef double Two __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
  Two low_a, high_a, low_b, high_b;
  __builtin_memcpy(&low_a, &a.low, sizeof low_a), __builtin_memcpy(&high_a, &a.high, sizeof high_a);
  __builtin_memcpy(&low_b, &b.low, sizeof low_b), __builtin_memcpy(&high_b, &b.high, sizeof high_b);
  const auto below = low_a <= high_b, above = low_b <= high_a;
  return (__builtin_ia32_movmskpd(Two(below)) & __builtin_ia32_movmskpd(Two(above))) == 3;
}
#endif

template <class V>
struct Axes;
template <class T>
struct Axes<Vec2<T>> {
  using Scalar = T;
  static constexpr int count = 2;
  static constexpr Vec2<T> all(T x) { return {x, x}; }
};
template <class T>
struct Axes<Vec3<T>> {
  using Scalar = T;
  static constexpr int count = 3;
  static constexpr Vec3<T> all(T x) { return {x, x, x}; }
};

/// A line or box that travels from `origin` by `translation`, prepared for slab tests.
template <class V>
struct SlabRay {
  using T = typename Axes<V>::Scalar;
  V origin, inverse, extents;

  SlabRay(V from, V translation, V half_extents) : origin(from), extents(half_extents) {
    // A direction component of zero gets a large finite inverse: inside its slab the interval is then everything,
    // outside it is empty, and no product is a NaN.
    const T tiny = T(sizeof(T) == 4 ? 1e-30 : 1e-250);
    for (int i = 0; i < Axes<V>::count; ++i) {
      const T d = translation[i];
      inverse[i] = math::abs(d) > tiny ? T(1) / d : T(1) / tiny;
    }
  }
  /// The fraction at which the box is entered, or 2 where it is missed or entered after `limit`.
  T enter(const Bounds<V>& box, T limit) const {
    // The exit is widened by a few roundings (Ize 2013), so that a flat box is not missed.
    const T widen = T(1) + (sizeof(T) == 4 ? T(1e-6) : T(1e-14));
    T first = 0, last = limit;
    for (int i = 0; i < Axes<V>::count; ++i) {
      const T a = (box.low[i] - extents[i] - origin[i]) * inverse[i];
      const T b = (box.high[i] + extents[i] - origin[i]) * inverse[i];
      first = math::max(first, math::min(a, b));
      last = math::min(last, math::max(a, b) * widen);
    }
    return first <= last ? first : T(2);
  }
};

/// Nodes still to be visited. Grows past its inline part only in trees deeper than any that boxes of similar size make.
class TraversalStack {
 public:
  bool empty() const { return count_ == 0; }
  void push(std::uint32_t x) {
    if (count_ < inline_size)
      inline_[count_] = x;
    else
      overflow_.push_back(x);
    ++count_;
  }
  std::uint32_t pop() {
    --count_;
    if (count_ < inline_size) return inline_[count_];
    const std::uint32_t x = overflow_.back();
    overflow_.pop_back();
    return x;
  }

 private:
  static constexpr int inline_size = 192;
  int count_ = 0;
  std::uint32_t inline_[inline_size];
  std::vector<std::uint32_t> overflow_;
};

template <class V>
struct BuildItem {
  Bounds<V> box;
  std::uint32_t index;
  std::uint32_t bin = 0;  ///< of the split that is being made
};

inline constexpr int split_depth_limit = 36;  ///< below this depth a build halves by count, so that depth stays bounded

/// Reorders `items` (two or more) into two non-empty groups with a low sum of surface × count, over 16 bins of the
/// longest axis of the centres (Wald 2007), and returns the size of the first. Depends on nothing but the input order.
template <class V>
std::size_t binned_split(std::span<BuildItem<V>> items, int depth) {
  using T = typename Axes<V>::Scalar;
  constexpr int bins = 16;
  const std::size_t count = items.size();
  if (count == 2 || depth > split_depth_limit) return count / 2;
  Bounds<V> centers{items[0].box.center(), items[0].box.center()};
  for (const BuildItem<V>& item : items) {
    const V c = item.box.center();
    centers = {min(centers.low, c), max(centers.high, c)};
  }
  const V size = centers.high - centers.low;
  int axis = 0;
  for (int i = 1; i < Axes<V>::count; ++i)
    if (size[i] > size[axis]) axis = i;
  if (!(size[axis] > T(0))) return count / 2;

  const T low = centers.low[axis], extent = size[axis];
  const auto bin_of = [&](const BuildItem<V>& item) {
    // Divided first: the reciprocal of a subnormal extent would be infinite.
    const int b = int((item.box.center()[axis] - low) / extent * T(bins));
    return std::uint32_t(b < 0 ? 0 : (b >= bins ? bins - 1 : b));
  };
  std::size_t counts[bins] = {};
  Bounds<V> boxes[bins];
  for (BuildItem<V>& item : items) {
    const std::uint32_t b = item.bin = bin_of(item);
    boxes[b] = counts[b] == 0 ? item.box : merge(boxes[b], item.box);
    ++counts[b];
  }
  T right_cost[bins];
  Bounds<V> box{};
  std::size_t n = 0;
  for (int b = bins - 1; b > 0; --b) {
    if (counts[b] > 0) {
      box = n == 0 ? boxes[b] : merge(box, boxes[b]);
      n += counts[b];
    }
    right_cost[b] = n > 0 ? surface(box) * T(n) : T(0);
  }
  int best = -1;
  T best_cost = 0;
  n = 0;
  for (int b = 0; b + 1 < bins; ++b) {
    if (counts[b] > 0) {
      box = n == 0 ? boxes[b] : merge(box, boxes[b]);
      n += counts[b];
    }
    if (n == 0 || n == count) continue;
    const T cost = surface(box) * T(n) + right_cost[b + 1];
    if (best < 0 || cost < best_cost) best = b, best_cost = cost;
  }
  if (best < 0) return count / 2;

  std::size_t i = 0, j = count;
  while (i < j) {
    if (int(items[i].bin) <= best) {
      ++i;
    } else {
      --j;
      const BuildItem<V> t = items[i];
      items[i] = items[j];
      items[j] = t;
    }
  }
  return i;
}

}  // namespace carom::geometry::detail
