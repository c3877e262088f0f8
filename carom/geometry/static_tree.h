// A bounding-volume tree over a fixed set of boxes, built once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/export.h"
#include "carom/geometry/bounds.h"

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
CAROM_API StaticTree build_static_tree(std::span<const Bounds3f> boxes);

/// Calls visit(item) for every item whose leaf overlaps `query`; visit returns false to stop.
template <class Visit> void query(const StaticTree& tree, const Bounds3f& query, Visit&& visit) {
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

}  // namespace carom::geometry
