#include "carom/geometry/static_tree.h"

#include "carom/geometry/detail/tree_build.h"

namespace carom::geometry {
namespace {

/// A subtree of the tree of two children a node that is split first.
template <class V>
struct Branch {
  using T = typename detail::Axes<V>::Scalar;
  static constexpr int width = WideTree<V>::width;
  Bounds<V> box{};
  std::uint32_t first = 0, count = 0;
  std::uint32_t child = 0;  ///< the first of its two, which stand side by side; 0: a leaf
  std::int32_t depth = 0;
  /// The least cost of its wide nodes where it has at most so many places in the node above: of one on.
  T cost[width - 1]{};
};

template <class V>
Bounds<V> box_of(std::span<const detail::BuildItem<V>> items) {
  Bounds<V> box = items[0].box;
  for (std::size_t i = 1; i < items.size(); ++i) box = merge(box, items[i].box);
  return box;
}

/// Parents stand before their children.
template <class V>
std::vector<Branch<V>> split_all(std::span<detail::BuildItem<V>> items, std::size_t most) {
  std::vector<Branch<V>> branches;
  // Leaves are at least half full on the whole. Room that is not used costs no memory; a list that grows takes twice
  // it.
  branches.reserve(most == 1 ? 2 * items.size() : 2 * (2 * items.size() / most) + 2);
  branches.push_back({box_of<V>(items), 0, std::uint32_t(items.size())});
  for (std::size_t i = 0; i < branches.size(); ++i) {
    Branch<V> from = branches[i];
    if (from.count <= most) continue;
    branches[i].child = std::uint32_t(branches.size());
    const std::uint32_t all = from.count,
                        cut = std::uint32_t(detail::binned_split<V>(items.subspan(from.first, all), from.depth));
    ++from.depth;
    from.count = cut, from.box = box_of<V>(items.subspan(from.first, cut));
    branches.push_back(from);
    from.first += cut, from.count = all - cut, from.box = box_of<V>(items.subspan(from.first, from.count));
    branches.push_back(from);
  }
  return branches;
}

/// How many of `places` in a wide node the first of two children gets so that both cost least.
template <class V>
int best_share(const Branch<V>& one, const Branch<V>& two, int places) {
  int best = 1;
  for (int k = 2; k < places; ++k)
    if (one.cost[k - 1] + two.cost[places - k - 1] < one.cost[best - 1] + two.cost[places - best - 1]) best = k;
  return best;
}

/// Which branches become wide nodes so that their surfaces sum to the least (Ylitie, Karras & Laine 2017, §3): from the
/// leaves up. A node that is never met costs memory.
template <class V>
void choose_nodes(std::vector<Branch<V>>& branches) {
  using T = typename Branch<V>::T;
  constexpr int width = Branch<V>::width;
  const T memory = detail::surface(branches[0].box) / T(branches[0].count) + T(1e-30);
  for (std::size_t i = branches.size(); i-- > 0;) {
    Branch<V>& b = branches[i];
    if (b.child == 0) continue;
    const Branch<V>&one = branches[b.child], &two = branches[b.child + 1];
    const auto shared = [&](int places) {
      const int k = best_share(one, two, places);
      return one.cost[k - 1] + two.cost[places - k - 1];
    };
    b.cost[0] = detail::surface(b.box) + memory + shared(width);
    for (int places = 2; places < width; ++places) b.cost[places - 1] = math::min(b.cost[places - 2], shared(places));
  }
}

/// The branches that share the places of a wide node: those of `b`, or itself if that costs no more.
template <class V>
void collect(const std::vector<Branch<V>>& branches, std::uint32_t b, int places, bool open,
             std::uint32_t (&out)[Branch<V>::width], int& count) {
  const Branch<V>& branch = branches[b];
  if (!open)
    while (places > 1 && branch.cost[places - 2] == branch.cost[places - 1]) --places;
  if (branch.child == 0 || (!open && places == 1)) {
    out[count++] = b;
    return;
  }
  const int k = best_share(branches[branch.child], branches[branch.child + 1], places);
  collect(branches, branch.child, k, false, out, count);
  collect(branches, branch.child + 1, places - k, false, out, count);
}

/// The grid of a node, and the children's boxes rounded outward on it.
template <class V>
void set_boxes(typename WideTree<V>::Node& node, const std::vector<Branch<V>>& branches, const std::uint32_t* chosen,
               int count) {
  using T = typename detail::Axes<V>::Scalar;
  Bounds<V> all = branches[chosen[0]].box;
  for (int c = 1; c < count; ++c) all = merge(all, branches[chosen[c]].box);
  const V size = all.high - all.low;
  T widest = 0;
  for (int k = 0; k < detail::Axes<V>::count; ++k) widest = math::max(widest, size[k]);
  for (int k = 0; k < detail::Axes<V>::count; ++k) {
    // What the arithmetic of a traversal, in float and about the node's corner, can lose.
    const T pad = T(2e-6) * widest +
                  T(sizeof(T) == 4 ? 4e-7 : 1e-15) * math::max(math::abs(all.low[k]), math::abs(all.high[k])) +
                  T(1e-30);
    // Of the 256 steps the first and the last are nobody's: what lies beside the node rounds to them.
    const T low = all.low[k] - pad;
    node.step[k] = float((all.high[k] + pad - low) / T(252));
    node.inverse[k] = 1 / node.step[k];
    const T step = T(node.step[k]);
    node.origin[k] = low - step;
    for (int c = 0; c < count; ++c) {
      const Bounds<V>& box = branches[chosen[c]].box;
      const T from = (box.low[k] - pad - node.origin[k]) / step;
      const T to = (box.high[k] + pad - node.origin[k]) / step;
      node.low[k][c] = std::uint8_t(math::clamp(int(from), 1, 254));
      node.high[k][c] = std::uint8_t(math::clamp(int(to) + 1, 1, 254));
    }
    for (int c = count; c < WideTree<V>::width; ++c) node.low[k][c] = 255;
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
  std::vector<Branch<V>> branches = split_all<V>(items, most);
  choose_nodes<V>(branches);
  struct Job {
    std::uint32_t branch, parent;
    int lane;
  };
  Job jobs[wide_stack_size];
  int open = 0;
  jobs[open++] = {0, 0, -1};
  while (open > 0) {
    const Job job = jobs[--open];
    const std::uint32_t index = std::uint32_t(tree.nodes.size());
    if (job.lane >= 0) tree.nodes[job.parent].child[job.lane] = index;
    std::uint32_t chosen[WideTree<V>::width];
    int count = 0;
    collect<V>(branches, job.branch, WideTree<V>::width, true, chosen, count);
    typename WideTree<V>::Node node;
    set_boxes<V>(node, branches, chosen, count);
    for (int c = 0; c < count; ++c) {
      const Branch<V>& leaf = branches[chosen[c]];
      if (leaf.child != 0) continue;
      if (leaf.count == 1) {
        node.child[c] = WideTree<V>::leaf_bit | items[leaf.first].index;
        continue;
      }
      node.child[c] = WideTree<V>::leaf_bit | std::uint32_t(leaf.count - 1) << 29 | std::uint32_t(tree.items.size());
      for (std::size_t i = 0; i < leaf.count; ++i) tree.items.push_back(items[leaf.first + i].index);
    }
    tree.nodes.push_back(node);
    for (int c = count - 1; c >= 0; --c)
      if (branches[chosen[c]].child != 0) jobs[open++] = {chosen[c], index, c};
  }
}
template void build_wide_tree<Vec3f>(std::span<BuildItem<Vec3f>>, int, WideTree<Vec3f>&);
template void build_wide_tree<Vec3d>(std::span<BuildItem<Vec3d>>, int, WideTree<Vec3d>&);
template void build_wide_tree<Vec2d>(std::span<BuildItem<Vec2d>>, int, WideTree<Vec2d>&);

}  // namespace detail

StaticTree detail::build_static_tree(std::vector<BuildItem<Vec3f>> items, int leaf_size) {
  StaticTree tree;
  build_wide_tree<Vec3f>(items, leaf_size, tree);
  std::vector<BuildItem<Vec3f>>().swap(items);
  // Copies, because shrink_to_fit does nothing where there are no exceptions.
  tree.nodes = std::vector<StaticTree::Node>(tree.nodes);
  tree.items = std::vector<std::uint32_t>(tree.items);
  return tree;
}

StaticTree build_static_tree(std::span<const Bounds3f> boxes, int leaf_size) {
  std::vector<detail::BuildItem<Vec3f>> items(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) items[i] = {boxes[i], std::uint32_t(i)};
  return detail::build_static_tree(std::move(items), leaf_size);
}

}  // namespace carom::geometry
