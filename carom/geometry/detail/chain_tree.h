// The segments of a chain near a box, in their order along the chain.
#pragma once

#include "carom/geometry/shape2.h"

namespace carom::geometry::detail {

inline constexpr int chain_run = 4;  ///< segments under a leaf of Chain::tree

inline Bounds2f segment_bounds(const Chain& chain, int i) {
  const Vec2f p = chain.points[std::size_t(i)];
  const Vec2f q = chain.points[std::size_t(i) + 1 < chain.points.size() ? std::size_t(i) + 1 : 0];
  return {min(p, q), max(p, q)};
}

/// Neighbours along a chain are neighbours in space, so the tree is a heap: node k stands over 2k and 2k + 1, the
/// leaves are the last half, each over a run of segments.
inline std::vector<Bounds2f> build_chain_tree(const Chain& chain) {
  const int count = chain.segment_count();
  std::size_t leaves = 1;
  while (int(leaves) * chain_run < count) leaves *= 2;
  constexpr Bounds2f nothing{{3.4e38f, 3.4e38f}, {-3.4e38f, -3.4e38f}};
  std::vector<Bounds2f> tree(2 * leaves, nothing);
  for (int i = 0; i < count; ++i) {
    Bounds2f& leaf = tree[leaves + std::size_t(i / chain_run)];
    leaf = merge(leaf, segment_bounds(chain, i));
  }
  for (std::size_t k = leaves - 1; k > 0; --k) tree[k] = merge(tree[2 * k], tree[2 * k + 1]);
  return tree;
}

/// Calls use(i) for every segment whose bounds meet `box`, in ascending order; use returns false to stop.
template <class Use>
void visit_segments(const Chain& chain, const Bounds2f& box, Use&& use) {
  const int count = chain.segment_count();
  const auto run = [&](int begin, int end) {
    for (int i = begin; i < end; ++i)
      if (overlaps(segment_bounds(chain, i), box) && !use(i)) return false;
    return true;
  };
  if (chain.tree.empty()) {
    run(0, count);
    return;
  }
  const std::uint32_t leaves = std::uint32_t(chain.tree.size() / 2);
  std::uint32_t stack[64];
  int top = 0;
  stack[top++] = 1;
  while (top > 0) {
    const std::uint32_t node = stack[--top];
    if (!overlaps(chain.tree[node], box)) continue;
    if (node < leaves) {
      stack[top++] = 2 * node + 1;
      stack[top++] = 2 * node;
    } else {
      const int begin = int(node - leaves) * chain_run;
      if (!run(begin, math::min(begin + chain_run, count))) return;
    }
  }
}

/// No point of the chain is nearer to the box than this (m); at most `limit`.
inline float clearance(const Chain& chain, const Bounds2f& box, float limit) {
  const auto gap = [&](const Bounds2f& b) {
    const Vec2f d = max(max(b.low - box.high, box.low - b.high), Vec2f{});
    return math::length(d);
  };
  const std::uint32_t leaves = std::uint32_t(chain.tree.size() / 2);
  std::uint32_t stack[64];
  int top = 0;
  if (leaves > 0) stack[top++] = 1;
  while (top > 0) {
    const std::uint32_t node = stack[--top];
    const float here = gap(chain.tree[node]);
    if (here >= limit) continue;
    if (node >= leaves) {
      limit = here;
      continue;
    }
    stack[top++] = 2 * node + 1;
    stack[top++] = 2 * node;
  }
  return leaves > 0 ? limit : 0;
}

}  // namespace carom::geometry::detail
