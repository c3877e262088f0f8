// Walks through static trees: boxes that overlap, boxes on the way of a ray or a moving box, nearest boxes.
#pragma once

#include "carom/geometry/static_tree.h"
#include "carom/math/simd.h"

namespace carom::geometry {
namespace detail {

using Four = WideFloat<4>;

/// Rows of four bytes, one an axis, as floats.
template <int Axes>
CAROM_SIMD_INLINE void bytes_as_floats(const std::uint8_t (&rows)[Axes][4], Four (&out)[Axes]) {
#if defined(__SSE2__)
  // Sixteen bytes are read from twelve (or eight): the node goes on behind both rows.
  __m128i bytes;
  __builtin_memcpy(&bytes, rows, sizeof bytes);
  const __m128i zero = _mm_setzero_si128();
  const __m128i words = _mm_unpacklo_epi8(bytes, zero);
  out[0] = {Four::Vector(_mm_cvtepi32_ps(_mm_unpacklo_epi16(words, zero)))};
  out[1] = {Four::Vector(_mm_cvtepi32_ps(_mm_unpackhi_epi16(words, zero)))};
  if constexpr (Axes == 3)
    out[2] = {Four::Vector(_mm_cvtepi32_ps(_mm_unpacklo_epi16(_mm_unpackhi_epi8(bytes, zero), zero)))};
#else
  for (int k = 0; k < Axes; ++k)
    out[k] = {Four::Vector{float(rows[k][0]), float(rows[k][1]), float(rows[k][2]), float(rows[k][3])}};
#endif
}

/// A box that travels, prepared for slab tests against wide nodes.
template <class V>
struct WideRay {
  static constexpr int axes = Axes<V>::count;
  V origin;
  float inverse[axes], extents[axes];

  WideRay(V from, V translation, V half_extents) : origin(from) {
    // Rounding moves a slab by at most a few ulps of the way and of the node (nodes are padded for their own part).
    float reach = 0;
    for (int k = 0; k < axes; ++k)
      reach = math::max(reach, math::abs(float(translation[k])) + 2 * float(half_extents[k]));
    for (int k = 0; k < axes; ++k) {
      const float d = float(translation[k]);
      inverse[k] = math::abs(d) > 1e-18f ? 1 / d : 1e18f;
      extents[k] = float(half_extents[k]) * 1.000001f + 5e-7f * reach;
    }
  }
};

/// Where the children of a node are entered, and which of them before `limit`.
template <class V>
CAROM_SIMD_INLINE std::uint32_t enter_children(const typename WideTree<V>::Node& node, const WideRay<V>& ray,
                                               float limit, Four& enter) {
  constexpr int axes = WideRay<V>::axes;
  Four low[axes], high[axes];
  bytes_as_floats(node.low, low);
  bytes_as_floats(node.high, high);
  Four first = Four::zero(), last = Four::splat(limit);
#pragma GCC unroll 3
  for (int k = 0; k < axes; ++k) {
    const float from = float(node.origin[k] - ray.origin[k]);
    const Four scale = Four::splat(node.step[k] * ray.inverse[k]);
    const Four a = low[k] * scale + Four::splat((from - ray.extents[k]) * ray.inverse[k]);
    const Four b = high[k] * scale + Four::splat((from + ray.extents[k]) * ray.inverse[k]);
    first = max(first, min(a, b));
    last = min(last, max(a, b));
  }
  enter = first;
  return bitmask(first <= last);
}

/// Which children meet a box.
template <class V>
CAROM_SIMD_INLINE std::uint32_t meet_children(const typename WideTree<V>::Node& node, const Bounds<V>& box) {
  constexpr int axes = WideTree<V>::axes;
  Four low[axes], high[axes];
  bytes_as_floats(node.low, low);
  bytes_as_floats(node.high, high);
  WideMask<4> meet = WideMask<4>::all();
#pragma GCC unroll 3
  for (int k = 0; k < axes; ++k) {
    // Rounded outward by the node's own padding.
    const Four step = Four::splat(node.step[k]);
    meet = meet & (low[k] * step <= Four::splat(float(box.high[k] - node.origin[k]))) &
           (high[k] * step >= Four::splat(float(box.low[k] - node.origin[k])));
  }
  return bitmask(meet);
}

template <class V, class Visit>
bool visit_leaf(const WideTree<V>& tree, std::uint32_t leaf, Visit&& visit) {
  const int count = WideTree<V>::leaf_count(leaf);
  const std::uint32_t first = leaf & WideTree<V>::first_mask;
  if (count == 1) return visit(first);
  for (int i = 0; i < count; ++i)
    if (!visit(tree.items[first + std::uint32_t(i)])) return false;
  return true;
}

}  // namespace detail

/// Calls visit(item) for every item whose leaf overlaps `box` (and some near it); visit returns false to stop.
template <class V, class Visit>
void query(const WideTree<V>& tree, const Bounds<V>& box, Visit&& visit) {
  if (tree.nodes.empty()) return;
  std::uint32_t stack[detail::wide_stack_size];
  int top = 0;
  std::uint32_t at = 0;
  while (true) {
    const auto& node = tree.nodes[at];
    const std::uint32_t met = detail::meet_children<V>(node, box);
    for (int lane = 3; lane >= 0; --lane) {
      const std::uint32_t child = node.child[lane];
      if ((met >> lane & 1u) == 0 || child == 0) continue;
      stack[top++] = child;
      if ((child & WideTree<V>::leaf_bit) == 0)
        __builtin_prefetch(&tree.nodes[child]);
      else if (WideTree<V>::leaf_count(child) > 1)
        __builtin_prefetch(&tree.items[child & WideTree<V>::first_mask]);
    }
    while (true) {
      if (top == 0) return;
      at = stack[--top];
      if ((at & WideTree<V>::leaf_bit) == 0) break;
      if (!detail::visit_leaf(tree, at, visit)) return;
    }
  }
}

/// A box of half extents `extents` (zero: a ray) travels from `origin` by `translation`. Calls
/// visit(item, limit) → new limit for the items of every leaf it may meet before `limit` (at first `limit`), nearer
/// leaves first: return `limit` to go on, a smaller fraction to clip, a negative one to stop.
template <class V, class Visit>
void cast(const WideTree<V>& tree, V origin, V translation, V extents, float limit, Visit&& visit) {
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
    detail::Four enter;
    const int bottom = top;
    for (std::uint32_t met = detail::enter_children<V>(node, ray, limit, enter); met != 0; met &= met - 1) {
      const int lane = __builtin_ctz(met);
      const Later later{enter[lane], node.child[lane]};
      if (later.child == 0) continue;
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
      detail::visit_leaf(tree, at, [&](std::uint32_t item) {
        limit = float(visit(item, limit));
        return !(limit < 0);
      });
      if (limit < 0) return;
    }
  }
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
    constexpr int axes = WideTree<V>::axes;
    detail::Four low[axes], high[axes], sum = detail::Four::zero();
    detail::bytes_as_floats(node.low, low);
    detail::bytes_as_floats(node.high, high);
    for (int k = 0; k < axes; ++k) {
      const detail::Four step = detail::Four::splat(node.step[k]);
      const detail::Four gap = max(max(low[k] * step - detail::Four::splat(float(box.high[k] - node.origin[k])),
                                       detail::Four::splat(float(box.low[k] - node.origin[k])) - high[k] * step),
                                   detail::Four::zero());
      sum += gap * gap;
    }
    const int bottom = top;
    for (int lane = 0; lane < 4 && node.child[lane] != 0; ++lane) {
      const Later later{sum[lane], node.child[lane]};
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
      detail::visit_leaf(tree, at, [&](std::uint32_t item) {
        look(item);
        return true;
      });
      if (!(best > 0)) return;
    }
  }
}

}  // namespace carom::geometry
