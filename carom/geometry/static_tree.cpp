#include "carom/geometry/static_tree.h"

#include "carom/geometry/detail/tree_build.h"

namespace carom::geometry {
namespace {

template <class V>
struct Range {
  std::size_t first = 0, count = 0;
  Bounds<V> box{};
  int depth = 0;
};

template <class V>
Bounds<V> box_of(std::span<const detail::BuildItem<V>> items) {
  Bounds<V> box = items[0].box;
  for (std::size_t i = 1; i < items.size(); ++i) box = merge(box, items[i].box);
  return box;
}

/// The grid of a node, and the children's boxes rounded outward on it.
template <class V>
void set_boxes(typename WideTree<V>::Node& node, const Range<V>* ranges, int count) {
  using T = typename detail::Axes<V>::Scalar;
  Bounds<V> all = ranges[0].box;
  for (int c = 1; c < count; ++c) all = merge(all, ranges[c].box);
  const V size = all.high - all.low;
  T widest = 0;
  for (int k = 0; k < detail::Axes<V>::count; ++k) widest = math::max(widest, size[k]);
  for (int k = 0; k < detail::Axes<V>::count; ++k) {
    // What the arithmetic of a traversal, in float and about the node's corner, can lose.
    const T pad = T(2e-6) * widest +
                  T(sizeof(T) == 4 ? 4e-7 : 1e-15) * math::max(math::abs(all.low[k]), math::abs(all.high[k])) +
                  T(1e-30);
    node.origin[k] = all.low[k] - pad;
    node.step[k] = float((all.high[k] + pad - node.origin[k]) / T(254));
    for (int c = 0; c < count; ++c) {
      const T step = T(node.step[k]);
      const T low = (ranges[c].box.low[k] - pad - node.origin[k]) / step;
      const T high = (ranges[c].box.high[k] + pad - node.origin[k]) / step;
      node.low[k][c] = std::uint8_t(math::clamp(int(low), 0, 255));
      node.high[k][c] = std::uint8_t(math::clamp(int(high) + 1, 0, 255));
    }
    for (int c = count; c < 4; ++c) node.low[k][c] = 255;
  }
}

}  // namespace

namespace detail {

template <class V>
void build_wide_tree(std::span<BuildItem<V>> items, int leaf_size, WideTree<V>& tree) {
  tree.nodes.clear();
  tree.items.clear();
  if (items.empty()) return;
  const std::size_t most = std::size_t(math::clamp(leaf_size, 1, 4));
  struct Job {
    Range<V> range;
    std::uint32_t parent;
    int lane;
  };
  Job jobs[wide_stack_size];
  int open = 0;
  jobs[open++] = {{0, items.size(), box_of<V>(items), 0}, 0, -1};
  while (open > 0) {
    const Job job = jobs[--open];
    const std::uint32_t index = std::uint32_t(tree.nodes.size());
    if (job.lane >= 0) tree.nodes[job.parent].child[job.lane] = index;
    Range<V> ranges[4] = {job.range};
    int count = 1;
    while (count < 4) {  // open what is met most often
      int widest = -1;
      for (int c = 0; c < count; ++c)
        if (ranges[c].count > most && (widest < 0 || surface(ranges[c].box) > surface(ranges[widest].box))) widest = c;
      if (widest < 0) break;
      Range<V>& a = ranges[widest];
      Range<V>& b = ranges[count++];
      const std::size_t cut = binned_split<V>(items.subspan(a.first, a.count), a.depth);
      b.first = a.first + cut, b.count = a.count - cut;
      a.count = cut;
      a.depth = b.depth = a.depth + 1;
      a.box = box_of<V>(items.subspan(a.first, a.count));
      b.box = box_of<V>(items.subspan(b.first, b.count));
    }
    typename WideTree<V>::Node node;
    set_boxes<V>(node, ranges, count);
    for (int c = 0; c < count; ++c) {
      const Range<V>& r = ranges[c];
      if (r.count == 1) {
        node.child[c] = WideTree<V>::leaf_bit | items[r.first].index;
      } else if (r.count <= most) {
        node.child[c] = WideTree<V>::leaf_bit | std::uint32_t(r.count - 1) << 29 | std::uint32_t(tree.items.size());
        for (std::size_t i = 0; i < r.count; ++i) tree.items.push_back(items[r.first + i].index);
      }
    }
    tree.nodes.push_back(node);
    for (int c = count - 1; c >= 0; --c)
      if (ranges[c].count > most) jobs[open++] = {ranges[c], index, c};
  }
}
template void build_wide_tree<Vec3f>(std::span<BuildItem<Vec3f>>, int, WideTree<Vec3f>&);
template void build_wide_tree<Vec3d>(std::span<BuildItem<Vec3d>>, int, WideTree<Vec3d>&);
template void build_wide_tree<Vec2d>(std::span<BuildItem<Vec2d>>, int, WideTree<Vec2d>&);

}  // namespace detail

StaticTree build_static_tree(std::span<const Bounds3f> boxes, int leaf_size) {
  StaticTree tree;
  std::vector<detail::BuildItem<Vec3f>> items(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) items[i] = {boxes[i], std::uint32_t(i)};
  detail::build_wide_tree<Vec3f>(items, leaf_size, tree);
  // Copies, because shrink_to_fit does nothing where there are no exceptions.
  tree.nodes = std::vector<StaticTree::Node>(tree.nodes);
  tree.items = std::vector<std::uint32_t>(tree.items);
  return tree;
}

}  // namespace carom::geometry
