// Walks through static trees: boxes that overlap, boxes on the way of a ray or a moving box, nearest boxes.
#pragma once

#include <algorithm>

#include "carom/geometry/static_tree.h"
#include "carom/math/simd.h"

namespace carom::geometry {
namespace detail {

using Four = WideFloat<4>;

/// Eight bytes as floats, in two halves.
CAROM_SIMD_INLINE void bytes_as_floats(const std::uint8_t (&bytes)[8], Four (&out)[2]) {
#if defined(__SSE2__)
  const __m128i zero = _mm_setzero_si128();
  const __m128i words = _mm_unpacklo_epi8(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(bytes)), zero);
  out[0] = {Four::Vector(_mm_cvtepi32_ps(_mm_unpacklo_epi16(words, zero)))};
  out[1] = {Four::Vector(_mm_cvtepi32_ps(_mm_unpackhi_epi16(words, zero)))};
#else
  for (int h = 0; h < 2; ++h)
    out[h] = {
        Four::Vector{float(bytes[4 * h]), float(bytes[4 * h + 1]), float(bytes[4 * h + 2]), float(bytes[4 * h + 3])}};
#endif
}

/// A box that travels, prepared for slab tests against wide nodes.
template <class V>
struct WideRay {
  static constexpr int axes = Axes<V>::count;
  V origin;
  Four inverse = Four::zero(), extents = Four::zero();  // an axis a lane

  WideRay(V from, V translation, V half_extents) : origin(from) {
    // Rounding moves a slab by at most a few ulps of the way and of the node (nodes are padded for their own part).
    float reach = 0;
    for (int k = 0; k < axes; ++k)
      reach = math::max(reach, math::abs(float(translation[k])) + 2 * float(half_extents[k]));
    for (int k = 0; k < axes; ++k) {
      const float d = float(translation[k]);
      inverse.set(k, math::abs(d) > 1e-18f ? 1 / d : 1e18f);
      extents.set(k, float(half_extents[k]) * 1.000001f + 5e-7f * reach);
    }
  }
};

/// Where the children of a node are entered, and which of them before `limit`.
template <class V>
CAROM_SIMD_INLINE std::uint32_t enter_children(const typename WideTree<V>::Node& node, const WideRay<V>& ray,
                                               float limit, float (&enter)[WideTree<V>::width]) {
  constexpr int axes = WideRay<V>::axes;
  const V apart = node.origin - ray.origin;
  Four from, step;  // an axis a lane
  if constexpr (axes == 3) {
    from.v = Four::Vector{float(apart[0]), float(apart[1]), float(apart[2]), 0};
    step.v = Four::Vector{node.step[0], node.step[1], node.step[2], 0};
  } else {
    from.v = Four::Vector{float(apart[0]), float(apart[1]), 0, 0};
    step.v = Four::Vector{node.step[0], node.step[1], 0, 0};
  }
  const Four scales = step * ray.inverse, lows = (from - ray.extents) * ray.inverse,
             highs = (from + ray.extents) * ray.inverse;
  Four first[2] = {Four::zero(), Four::zero()}, last[2] = {Four::splat(limit), Four::splat(limit)};
#pragma GCC unroll 3
  for (int k = 0; k < axes; ++k) {
    Four low[2], high[2];
    bytes_as_floats(node.low[k], low);
    bytes_as_floats(node.high[k], high);
    const Four scale = Four::splat(scales[k]), low_end = Four::splat(lows[k]), high_end = Four::splat(highs[k]);
#pragma GCC unroll 2
    for (int h = 0; h < 2; ++h) {
      const Four a = low[h] * scale + low_end, b = high[h] * scale + high_end;
      first[h] = max(first[h], min(a, b));
      last[h] = min(last[h], max(a, b));
    }
  }
  first[0].store(enter), first[1].store(enter + 4);
  return bitmask(first[0] <= last[0]) | bitmask(first[1] <= last[1]) << 4;
}

/// A box on the grid of a node: from which step to which, an axis a lane; up to 0 and from 255 on are beside it.
template <class V>
CAROM_SIMD_INLINE void on_grid(const typename WideTree<V>::Node& node, const Bounds<V>& box, WideInt<4>& low,
                               WideInt<4>& high) {
  const V from = box.low - node.origin, to = box.high - node.origin;
  Four first, last, inverse;
  if constexpr (WideTree<V>::axes == 3) {
    first.v = Four::Vector{float(from[0]), float(from[1]), float(from[2]), 0};
    last.v = Four::Vector{float(to[0]), float(to[1]), float(to[2]), 0};
    inverse.v = Four::Vector{node.inverse[0], node.inverse[1], node.inverse[2], 0};
  } else {
    first.v = Four::Vector{float(from[0]), float(from[1]), 0, 0};
    last.v = Four::Vector{float(to[0]), float(to[1]), 0, 0};
    inverse.v = Four::Vector{node.inverse[0], node.inverse[1], 0, 0};
  }
  // Neither reaches both ends: no child, from 255 to 0, meets nothing.
  const Four none = Four::zero(), most = Four::splat(254), end = Four::splat(255);
  high = to_int(clamp(last * inverse, none, most));
  low = WideInt<4>::splat(255) - to_int(clamp(end - first * inverse, none, most));  // rounds up
}

/// Which children meet a box. What rounding may lose is in the node's own padding.
template <class V>
CAROM_SIMD_INLINE std::uint32_t meet_children(const typename WideTree<V>::Node& node, const Bounds<V>& box) {
  constexpr int axes = WideTree<V>::axes;
  WideInt<4> low, high;
  on_grid<V>(node, box, low, high);
#if defined(__SSE2__)
  // Each of the box's bytes eight times over, an axis after the other as in the node.
  const auto spread = [](WideInt<4> x) __attribute__((always_inline)) {
    const __m128i two = _mm_or_si128(__m128i(x.v), _mm_slli_epi32(__m128i(x.v), 8));
    return _mm_or_si128(two, _mm_slli_epi32(two, 16));
  };
  const auto load = [](const auto& row) __attribute__((always_inline)) {
    return _mm_loadu_si128(reinterpret_cast<const __m128i*>(row));
  };
  const __m128i lows = spread(low), highs = spread(high);
  // Bytes that are not zero where an axis parts the two.
  __m128i apart = _mm_or_si128(_mm_subs_epu8(load(node.low[0]), _mm_unpacklo_epi32(highs, highs)),
                               _mm_subs_epu8(_mm_unpacklo_epi32(lows, lows), load(node.high[0])));
  apart = _mm_or_si128(apart, _mm_srli_si128(apart, 8));
  if constexpr (axes == 3)  // the second half of what is read is not of this axis, and not looked at
    apart = _mm_or_si128(apart, _mm_or_si128(_mm_subs_epu8(load(node.low[2]), _mm_unpackhi_epi32(highs, highs)),
                                             _mm_subs_epu8(_mm_unpackhi_epi32(lows, lows), load(node.high[2]))));
  return std::uint32_t(_mm_movemask_epi8(_mm_cmpeq_epi8(apart, _mm_setzero_si128()))) & 0xFFu;
#else
  typedef std::uint8_t Eight __attribute__((vector_size(8)));  // NOLINT(modernize-use-using)
  std::uint64_t meet = ~std::uint64_t(0);
  for (int k = 0; k < axes; ++k) {
    Eight from, to;
    __builtin_memcpy(&from, node.low[k], sizeof from);
    __builtin_memcpy(&to, node.high[k], sizeof to);
    const auto together = (from <= std::uint8_t(high[k])) & (to >= std::uint8_t(low[k]));
    std::uint64_t bytes;
    __builtin_memcpy(&bytes, &together, sizeof bytes);
    meet &= bytes;
  }
  return std::uint32_t((meet & 0x8040201008040201u) * 0x0101010101010101u >> 56);  // a bit of each byte
#endif
}

/// Has what a child will be looked at for brought near; soon(item): of a leaf of one. Always inlined, as prefetch_lines
/// of rigid is.
template <class V, class Soon>
CAROM_SIMD_INLINE void call_for(const WideTree<V>& tree, std::uint32_t child, Soon&& soon) {
  if ((child & WideTree<V>::leaf_bit) == 0)
    __builtin_prefetch(&tree.nodes[child]);
  else if (WideTree<V>::leaf_count(child) > 1)
    __builtin_prefetch(&tree.items[child & WideTree<V>::first_mask]);
  else
    soon(child & WideTree<V>::first_mask);
}
struct NotSoon {
  CAROM_SIMD_INLINE void operator()(std::uint32_t) const {}
};

/// look(items, count) at those of a leaf.
template <class V, class Look>
auto look_at_leaf(const WideTree<V>& tree, std::uint32_t leaf, Look&& look) {
  const int count = WideTree<V>::leaf_count(leaf);
  const std::uint32_t first = leaf & WideTree<V>::first_mask;
  return look(count == 1 ? &first : &tree.items[first], count);
}

}  // namespace detail

/// Writes the leaves that overlap `box` (and some near it), in the order of query_leaves. All nodes of a level are
/// called for before the first of them is met: for the small boxes of those who ask so often that they wait for memory.
/// Returns how many, or −1 where there are more than `room`.
template <int room, class V>
int list_leaves(const WideTree<V>& tree, const Bounds<V>& box, std::uint32_t (&leaves)[room]) {
  if (tree.nodes.empty()) return 0;
  std::uint32_t lists[2][room];
  std::uint32_t *level = lists[0], *below = lists[1];
  int count = 1;
  level[0] = 0;
  for (bool nodes = true; nodes;) {
    nodes = false;
    int next = 0;
    for (int i = 0; i < count; ++i) {
      if ((level[i] & WideTree<V>::leaf_bit) != 0) {
        if (next == room) return -1;
        below[next++] = level[i];
        continue;
      }
      const auto& node = tree.nodes[level[i]];
      for (std::uint32_t met = detail::meet_children<V>(node, box); met != 0; met &= met - 1) {
        if (next == room) return -1;
        const std::uint32_t child = node.child[__builtin_ctz(met)];
        below[next++] = child;
        nodes = nodes || (child & WideTree<V>::leaf_bit) == 0;
        detail::call_for(tree, child, detail::NotSoon{});
      }
    }
    std::swap(level, below);
    count = next;
  }
  std::copy(level, level + count, leaves);
  return count;
}

/// Calls visit(items, count) for every leaf (1 to 4 items) that overlaps `box` (and some near it); visit returns false
/// to stop.
template <class V, class Visit>
void query_leaves(const WideTree<V>& tree, const Bounds<V>& box, Visit&& visit) {
  if (tree.nodes.empty()) return;
  std::uint32_t stack[detail::wide_stack_size];
  int top = 0;
  std::uint32_t at = 0;
  while (true) {
    const auto& node = tree.nodes[at];
    for (std::uint32_t met = detail::meet_children<V>(node, box); met != 0;) {
      const int lane = 31 - __builtin_clz(met);  // the first is taken first
      met ^= 1u << lane;
      const std::uint32_t child = node.child[lane];
      stack[top++] = child;
      detail::call_for(tree, child, detail::NotSoon{});
    }
    while (true) {
      if (top == 0) return;
      at = stack[--top];
      if ((at & WideTree<V>::leaf_bit) == 0) break;
      if (!detail::look_at_leaf(tree, at, visit)) return;
    }
  }
}

/// The same item by item: visit(item).
template <class V, class Visit>
void query(const WideTree<V>& tree, const Bounds<V>& box, Visit&& visit) {
  query_leaves(tree, box, [&](const std::uint32_t* items, int count) {
    for (int i = 0; i < count; ++i)
      if (!visit(items[i])) return false;
    return true;
  });
}

/// A box of half extents `extents` (zero: a ray) travels from `origin` by `translation`. Calls
/// visit(items, count, limit) → new limit for every leaf (1 to 4 items) it may meet before `limit` (at first `limit`),
/// nearer ones first: return `limit` to go on, a smaller fraction to clip, a negative one to stop. soon(item) hints at
/// what a leaf of one will be asked about.
template <class V, class Visit, class Soon = detail::NotSoon>
void cast_leaves(const WideTree<V>& tree, V origin, V translation, V extents, float limit, Visit&& visit,
                 Soon&& soon = {}) {
  if (tree.nodes.empty()) return;
  const detail::WideRay<V> ray(origin, translation, extents);
  struct Later {
    float enter;
    std::uint32_t child;
  };
  Later stack[detail::wide_stack_size];
  int top = 0;
  std::uint32_t at = 0;
  while (true) {
    const auto& node = tree.nodes[at];
    float enter[WideTree<V>::width];
    const int bottom = top;
    for (std::uint32_t met = detail::enter_children<V>(node, ray, limit, enter); met != 0; met &= met - 1) {
      const int lane = __builtin_ctz(met);
      const Later later{enter[lane], node.child[lane]};
      if (later.child == 0) continue;
      detail::call_for(tree, later.child, soon);
      int k = top++;
      for (; k > bottom && stack[k - 1].enter < later.enter; --k) stack[k] = stack[k - 1];
      stack[k] = later;
    }
    while (true) {
      if (top == 0) return;
      const Later& next = stack[--top];
      if (next.enter > limit) continue;
      at = next.child;
      if ((at & WideTree<V>::leaf_bit) == 0) break;
      limit = detail::look_at_leaf(
          tree, at, [&](const std::uint32_t* items, int count) { return float(visit(items, count, limit)); });
      if (limit < 0) return;
    }
  }
}

/// The same item by item: visit(item, limit) → new limit.
template <class V, class Visit, class Soon = detail::NotSoon>
void cast(const WideTree<V>& tree, V origin, V translation, V extents, float limit, Visit&& visit, Soon&& soon = {}) {
  const auto look = [&](const std::uint32_t* items, int count, float now) {
    for (int i = 0; i < count && !(now < 0); ++i) now = float(visit(items[i], now));
    return now;
  };
  cast_leaves(tree, origin, translation, extents, limit, look, soon);
}

/// Calls look(item) for the items of leaves nearer to `box` than `best`, which look() lowers; nearer leaves first.
template <class V, class Look>
void nearest(const WideTree<V>& tree, const Bounds<V>& box, const float& best, Look&& look) {
  if (tree.nodes.empty()) return;
  struct Later {
    float gap_squared;
    std::uint32_t child;
  };
  Later stack[detail::wide_stack_size];
  int top = 0;
  std::uint32_t at = 0;
  while (true) {
    const auto& node = tree.nodes[at];
    detail::Four sum[2] = {detail::Four::zero(), detail::Four::zero()};
    for (int k = 0; k < WideTree<V>::axes; ++k) {
      detail::Four low[2], high[2];
      detail::bytes_as_floats(node.low[k], low);
      detail::bytes_as_floats(node.high[k], high);
      const detail::Four step = detail::Four::splat(node.step[k]),
                         most = detail::Four::splat(float(box.high[k] - node.origin[k])),
                         least = detail::Four::splat(float(box.low[k] - node.origin[k]));
      for (int h = 0; h < 2; ++h) {
        const detail::Four gap = max(max(low[h] * step - most, least - high[h] * step), detail::Four::zero());
        sum[h] += gap * gap;
      }
    }
    const int bottom = top;
    for (int lane = 0; lane < WideTree<V>::width && node.child[lane] != 0; ++lane) {
      const Later later{sum[lane / 4][lane % 4], node.child[lane]};
      int k = top++;
      for (; k > bottom && stack[k - 1].gap_squared < later.gap_squared; --k) stack[k] = stack[k - 1];
      stack[k] = later;
    }
    while (true) {
      if (top == 0) return;
      const Later& next = stack[--top];
      if (!(next.gap_squared < best * best)) continue;
      at = next.child;
      if ((at & WideTree<V>::leaf_bit) == 0) break;
      detail::look_at_leaf(tree, at, [&](const std::uint32_t* items, int count) {
        for (int i = 0; i < count; ++i) look(items[i]);
      });
      if (!(best > 0)) return;
    }
  }
}

}  // namespace carom::geometry
