// A bounding-volume tree over a fixed set of boxes, built once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/export.h"
#include "carom/geometry/bounds.h"
#include "carom/geometry/detail/tree_build.h"

namespace carom::geometry {

/// Nodes in depth-first order. An inner node's first child follows it; its second child is at `link`.
/// A leaf holds `count` items, items[link … link + count).
struct StaticTree {
  struct Node {
    Bounds3f bounds;
    std::uint32_t link = 0;
    std::uint32_t count = 0;  ///< 0: inner node
  };
  std::vector<Node> nodes;
  std::vector<std::uint32_t> items;
};
/// Binned surface area heuristic; at most `leaf_size` boxes a leaf. The tree is never deeper than 63 levels.
CAROM_API StaticTree build_static_tree(std::span<const Bounds3f> boxes, int leaf_size = 4);

/// Calls visit(item) for every item whose leaf overlaps `query`; visit returns false to stop.
template <class Visit>
void query(const StaticTree& tree, const Bounds3f& query, Visit&& visit) {
  if (tree.nodes.empty()) return;
  std::uint32_t stack[64];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t index = stack[--top];
    const StaticTree::Node& node = tree.nodes[index];
    if (!overlaps(node.bounds, query)) continue;
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i)
        if (!visit(tree.items[node.link + i])) return;
    } else {
      stack[top++] = node.link;
      stack[top++] = index + 1;
    }
  }
}

/// A box of half extents `extents` (zero: a ray) travels from `origin` by `translation`. Calls
/// visit(item, limit) → new limit for the items of every leaf it may meet before `limit` (at first `limit`), nearer
/// leaves first: return `limit` to go on, a smaller fraction to clip, a negative one to stop.
template <class Visit>
void cast(const StaticTree& tree, Vec3f origin, Vec3f translation, Vec3f extents, float limit, Visit&& visit) {
  if (tree.nodes.empty()) return;
  const detail::SlabRay<Vec3f> ray(origin, translation, extents);
  std::uint32_t stack[128];
  int top = 0;
  stack[top++] = 0;
  while (top > 0) {
    const std::uint32_t index = stack[--top];
    const StaticTree::Node& node = tree.nodes[index];
    if (ray.enter(node.bounds, limit) > limit) continue;
    if (node.count > 0) {
      for (std::uint32_t i = 0; i < node.count; ++i) {
        limit = visit(tree.items[node.link + i], limit);
        if (limit < 0) return;
      }
      continue;
    }
    const std::uint32_t first = index + 1, second = node.link;
    const float a = ray.enter(tree.nodes[first].bounds, limit), b = ray.enter(tree.nodes[second].bounds, limit);
    const bool swap = b < a;
    if ((swap ? a : b) <= limit) stack[top++] = swap ? first : second;
    if ((swap ? b : a) <= limit) stack[top++] = swap ? second : first;
  }
}

}  // namespace carom::geometry
