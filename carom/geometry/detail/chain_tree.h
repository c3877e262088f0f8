// The segments of a chain near a box, in their order along the chain.
#pragma once

#include "carom/geometry/shape2.h"

namespace carom::geometry::detail {

inline constexpr int chain_run = 4;  ///< segments under a leaf of Chain::tree

inline Vec2f segment_end(const Chain& chain, int i) {
  return chain.points[std::size_t(i) + 1 < chain.points.size() ? std::size_t(i) + 1 : 0];
}
inline Bounds2f segment_bounds(const Chain& chain, int i) {
  const Vec2f p = chain.points[std::size_t(i)], q = segment_end(chain, i);
  return {min(p, q), max(p, q)};
}
/// Is every point of a segment farther than `reach` (m) from c?
inline bool segment_far(const Chain& chain, int i, Vec2f c, float reach) {
  const Vec2f p = chain.points[std::size_t(i)], q = segment_end(chain, i), d = q - p, to = c - p;
  const float u = dot(to, d), whole = dot(d, d), far = reach * reach;
  if (u <= 0) return dot(to, to) > far;
  if (u >= whole) return math::distance_squared(c, q) > far;
  return math::square(cross(d, to)) > far * whole;
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

/// m²: a lower bound of how far a segment is from the box: by the axes of the box, or along its own normal.
inline float segment_gap_squared(const Chain& chain, int i, const Bounds2f& box) {
  const Vec2f p = chain.points[std::size_t(i)], q = segment_end(chain, i), d = q - p,
              half = 0.5f * (box.high - box.low);
  const Vec2f beside = max(max(min(p, q) - box.high, box.low - max(p, q)), Vec2f{});
  const float whole = dot(d, d);
  const float over = abs(cross(d, box.center() - p)) - (abs(d.y) * half.x + abs(d.x) * half.y);
  const float along = over > 0 && whole > 0 ? over * over / whole : 0;
  return math::max(dot(beside, beside), along);
}

/// No point of the chain is nearer to the box than this (m); at most `limit`.
inline float clearance(const Chain& chain, const Bounds2f& box, float limit) {
  const std::uint32_t leaves = std::uint32_t(chain.tree.size() / 2);
  if (leaves == 0) return 0;
  struct Place {
    std::uint32_t node;
    float gap_squared;
  } stack[64];
  const auto place = [&](std::uint32_t node) {
    const Bounds2f& b = chain.tree[node];
    const Vec2f d = max(max(b.low - box.high, box.low - b.high), Vec2f{});
    return Place{node, dot(d, d)};
  };
  float least = limit * limit;
  int top = 0;
  stack[top++] = place(1);
  while (top > 0) {
    const Place here = stack[--top];
    if (here.gap_squared >= least) continue;
    if (here.node >= leaves) {
      const int begin = int(here.node - leaves) * chain_run;
      for (int i = begin; i < math::min(begin + chain_run, chain.segment_count()); ++i)
        least = math::min(least, segment_gap_squared(chain, i, box));
      continue;
    }
    const Place a = place(2 * here.node), b = place(2 * here.node + 1);
    const bool first = a.gap_squared <= b.gap_squared;  // the nearer child ends the search sooner
    stack[top++] = first ? b : a;
    stack[top++] = first ? a : b;
  }
  return math::sqrt(least);
}

}  // namespace carom::geometry::detail
