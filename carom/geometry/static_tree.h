// A bounding-volume tree over a fixed set of boxes, built once and asked often.
// Every node holds eight children whose boxes lie on a grid of 256 steps a side over the node: it is two cache lines,
// and the boxes are tested side by side (quantised wide trees: Ylitie, Karras & Laine 2017). What a node says of a
// child is a little larger than the child, never smaller, so a tree only decides what is looked at, not what is found.
// tree_walk.h has the walks.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/export.h"
#include "carom/geometry/bounds.h"
#include "carom/geometry/detail/tree_build.h"

namespace carom::geometry {

/// V: Vec2d, Vec3d (a world's shapes) or Vec3f (a mesh's triangles).
template <class V>
struct WideTree {
  static constexpr int axes = detail::Axes<V>::count;
  static constexpr int width = 8;
  struct alignas(64) Node {
    V origin{};                                            ///< the low corner of the grid
    float step[axes]{}, inverse[axes]{};                   ///< m, of the grid, and 1/m
    std::uint8_t low[axes][width]{}, high[axes][width]{};  ///< 1 to 254; 255 and 0: no child
    std::uint32_t child[width]{};                          ///< a node; or with leaf_bit one or more items; 0: none
  };
  /// A leaf of one item names it; a leaf of 2 to 4 has (count − 1) << 29 and the first of them in `items`.
  static constexpr std::uint32_t leaf_bit = 1u << 31, first_mask = (1u << 29) - 1;

  std::vector<Node> nodes;  ///< the first is the root
  std::vector<std::uint32_t> items;

  static constexpr int leaf_count(std::uint32_t leaf) { return int(leaf >> 29 & 3u) + 1; }
  std::size_t bytes() const { return nodes.capacity() * sizeof(Node) + items.capacity() * sizeof(std::uint32_t); }
};
using StaticTree = WideTree<Vec3f>;
static_assert(sizeof(StaticTree::Node) == 128);

/// Binned surface area heuristic; at most `leaf_size` (1 to 4) boxes a leaf, at most 2²⁹ boxes.
CAROM_API StaticTree build_static_tree(std::span<const Bounds3f> boxes, int leaf_size = 4);

namespace detail {

/// Builds over the boxes of `items` (reordered), whose indices the leaves name. Keeps the memory of `tree`.
template <class V>
void build_wide_tree(std::span<BuildItem<V>> items, int leaf_size, WideTree<V>& tree);

/// The same of items, which take memory no longer than they are needed.
StaticTree build_static_tree(std::vector<BuildItem<Vec3f>> items, int leaf_size = 4);

/// Seven a level remain; no tree is deeper than the 36 levels of its splits and 29 of halving.
inline constexpr int wide_stack_size = 7 * 65 + 1;

}  // namespace detail
}  // namespace carom::geometry
