#include "carom/geometry/dynamic_tree.h"

#include <cassert>

namespace carom::geometry {
namespace {
template <class V>
Bounds<V> within_range(const Bounds<V>& box) {
  using A = detail::Axes<V>;
  const V most = A::all(typename A::Scalar(1e15)), least = A::all(typename A::Scalar(-1e15));
  return {max(min(box.low, most), least), max(min(box.high, most), least)};
}
}  // namespace

template <class V>
int DynamicTree<V>::take_node() {
  if (free_ >= 0) {
    const int node = free_;
    free_ = nodes_[std::size_t(node)].parent;
    nodes_[std::size_t(node)] = Node{};
    return node;
  }
  nodes_.push_back(Node{});
  return int(nodes_.size()) - 1;
}

template <class V>
void DynamicTree<V>::give_node(int node) {
  nodes_[std::size_t(node)] = Node{};
  nodes_[std::size_t(node)].parent = free_;
  free_ = node;
}

template <class V>
int DynamicTree<V>::insert(const Box& box, std::uint32_t item) {
  ++version_;
  const int leaf = take_node();
  nodes_[std::size_t(leaf)].box = within_range(box);
  nodes_[std::size_t(leaf)].child_a = std::int32_t(item);
  link(leaf);
  ++count_;
  return leaf;
}

template <class V>
void DynamicTree<V>::remove(int leaf) {
  ++version_;
  assert(leaf >= 0 && leaf < int(nodes_.size()) && nodes_[std::size_t(leaf)].child_b < 0);
  unlink(leaf);
  give_node(leaf);
  --count_;
}

template <class V>
void DynamicTree<V>::update(int leaf, const Box& box) {
  ++version_;
  Node* nodes = nodes_.data();
  const int above = nodes[leaf].parent;
  const Box to = within_range(box);
  // What goes no farther than its part of the tree reaches only widens the node above it.
  const int part = above >= 0 ? nodes[above].parent : -1;
  const bool stays = part >= 0 && contains(nodes[part].box, to);
  if (!stays) unlink(leaf);
  nodes[leaf].box = to;
  if (stays)
    fit_from(above);
  else
    link(leaf);
}

template <class V>
void DynamicTree<V>::fit_from(int index) {
  Node* nodes = nodes_.data();
  for (; index >= 0; index = nodes[index].parent) {
    const Box box = merge(nodes[nodes[index].child_a].box, nodes[nodes[index].child_b].box);
    if (box == nodes[index].box) break;
    nodes[index].box = box;
  }
}

template <class V>
void DynamicTree<V>::enlarge(int leaf, const Box& box) {
  ++version_;
  Node* nodes = nodes_.data();
  nodes[leaf].box = within_range(box);
  int above = nodes[leaf].parent;
  while (above >= 0) {
    Node& node = nodes[above];
    const bool inside = contains(node.box, nodes[leaf].box);
    if (inside && node.enlarged != 0) break;
    if (!inside) node.box = merge(node.box, nodes[leaf].box);
    node.enlarged = 1;
    above = node.parent;
  }
}

template <class V>
void DynamicTree<V>::set_bounds(int leaf, const Box& box) {
  nodes_[std::size_t(leaf)].box = within_range(box);
}

/// All of `roots` lie so many levels below the root, but for leaves that stand higher.
template <class V>
int DynamicTree<V>::subtrees(std::span<std::int32_t> roots, int& levels) const {
  levels = 0;
  if (root_ < 0 || roots.empty()) return 0;
  roots[0] = root_;
  for (int count = 1;; ++levels) {
    int more = 0;
    for (int i = 0; i < count; ++i) more += nodes_[std::size_t(roots[std::size_t(i)])].child_b >= 0 ? 1 : 0;
    if (more == 0 || count + more > int(roots.size())) return count;
    std::size_t to = std::size_t(count) + std::size_t(more);  // from behind: what is not yet read stays
    for (std::size_t i = std::size_t(count); i-- > 0;) {
      const Node& node = nodes_[std::size_t(roots[i])];
      if (node.child_b < 0) {
        roots[--to] = roots[i];
      } else {
        roots[--to] = node.child_b;
        roots[--to] = node.child_a;
      }
    }
    count += more;
  }
}
template <class V>
int DynamicTree<V>::subtrees(std::span<std::int32_t> roots) const {
  int levels;
  return subtrees(roots, levels);
}

/// Tightens the inner nodes of so many levels from `top` on, the lower ones first. Returns their summed surface.
template <class V>
double DynamicTree<V>::refit_below(int top, int levels) {
  Node* nodes = nodes_.data();
  double sum = 0;
  if (levels <= 0 || nodes[top].child_b < 0) return sum;
  for (int at = top, from = nodes[top].parent, depth = 1;;) {
    Node& node = nodes[at];
    const auto goes_down = [&](int child) { return depth < levels && nodes[child].child_b >= 0; };
    int next = -1;
    if (from == node.parent) __builtin_prefetch(nodes + node.child_b);
    if (from == node.parent && goes_down(node.child_a))
      next = node.child_a;
    else if (from != node.child_b && goes_down(node.child_b))
      next = node.child_b;
    from = at;
    if (next >= 0) {
      at = next;
      ++depth;
      continue;
    }
    node.box = merge(nodes[node.child_a].box, nodes[node.child_b].box);
    node.enlarged = 0;
    sum += double(detail::surface(node.box));
    if (at == top) return sum;
    at = node.parent;
    --depth;
  }
}

template <class V>
bool DynamicTree<V>::refit(core::TaskScheduler& scheduler, double worst) {
  ++version_;
  if (count_ < 2) return false;
  constexpr std::size_t most = 128;  // enough to share
  std::int32_t roots[most];
  double sums[most];
  int levels;
  const int count = subtrees(roots, levels);
  scheduler.parallel_for(count, 2, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) sums[k] = refit_below(roots[k], count_);
  });
  double sum = refit_below(root_, levels);
  for (int k = 0; k < count; ++k) sum += sums[k];
  if (!(least_cost_ > 0) || sum < least_cost_) least_cost_ = sum;
  if (!(sum > worst * least_cost_)) return false;
  rebuild();
  return true;
}
template <class V>
bool DynamicTree<V>::refit(double worst) {
  core::SerialScheduler here;
  return refit(here, worst);
}

template <class V>
void DynamicTree<V>::clear() {
  ++version_;
  nodes_.clear();
  root_ = free_ = -1;
  count_ = 0;
  least_cost_ = 0;
}

template <class V>
void DynamicTree<V>::reserve(int leaves) {
  nodes_.reserve(2 * std::size_t(leaves));
  build_.reserve(std::size_t(leaves));
  inner_.reserve(std::size_t(leaves));
  jobs_.reserve(2 * detail::split_depth_limit + 64);  // two a level; below the limit a build halves
}

template <class V>
void DynamicTree<V>::release_scratch() {
  std::vector<detail::BuildItem<V>>().swap(build_);
  std::vector<Job>().swap(jobs_);
  std::vector<std::int32_t>().swap(inner_);
}

// Descends to the sibling that makes the summed surface grow least, comparing at every node the cost of standing
// beside it with the least that going on can cost.
template <class V>
void DynamicTree<V>::link(int leaf) {
  if (root_ < 0) {
    root_ = leaf;
    nodes_[std::size_t(leaf)].parent = -1;
    return;
  }
  const Box box = nodes_[std::size_t(leaf)].box;
  int sibling = root_;
  {
    const Node* nodes = nodes_.data();
    while (nodes[sibling].child_b >= 0) {
      const Node& node = nodes[sibling];
      const Scalar beside = detail::surface(merge(node.box, box));
      const Scalar growth = beside - detail::surface(node.box);
      const auto cost_of = [&](int child) {
        const Scalar merged = detail::surface(merge(nodes[child].box, box));
        return nodes[child].child_b < 0 ? merged : merged - detail::surface(nodes[child].box);
      };
      const Scalar a = cost_of(node.child_a), b = cost_of(node.child_b);
      if (beside <= growth + math::min(a, b)) break;
      if (a == b) {  // boxes inside both: go where the centre is nearer
        const V c = box.center();
        const V to_a = nodes[node.child_a].box.center() - c, to_b = nodes[node.child_b].box.center() - c;
        sibling = dot(to_b, to_b) < dot(to_a, to_a) ? node.child_b : node.child_a;
      } else {
        sibling = b < a ? node.child_b : node.child_a;
      }
    }
  }
  const int above = nodes_[std::size_t(sibling)].parent;
  const int joint = take_node();
  Node* nodes = nodes_.data();
  nodes[joint].parent = above;
  nodes[joint].child_a = sibling;
  nodes[joint].child_b = leaf;
  nodes[joint].box = merge(nodes[sibling].box, box);
  nodes[sibling].parent = nodes[leaf].parent = joint;
  if (above < 0)
    root_ = joint;
  else if (nodes[above].child_a == sibling)
    nodes[above].child_a = joint;
  else
    nodes[above].child_b = joint;
  refit_and_rotate(above);
}

template <class V>
void DynamicTree<V>::unlink(int leaf) {
  Node* nodes = nodes_.data();
  const int joint = nodes[leaf].parent;
  if (joint < 0) {
    root_ = -1;
    return;
  }
  const int sibling = nodes[joint].child_a == leaf ? nodes[joint].child_b : nodes[joint].child_a;
  const int above = nodes[joint].parent;
  nodes[sibling].parent = above;
  if (above < 0)
    root_ = sibling;
  else if (nodes[above].child_a == joint)
    nodes[above].child_a = sibling;
  else
    nodes[above].child_b = sibling;
  give_node(joint);
  fit_from(above);
}

template <class V>
void DynamicTree<V>::refit_and_rotate(int index) {
  Node* nodes = nodes_.data();
  for (; index >= 0; index = nodes[index].parent) {
    nodes[index].box = merge(nodes[nodes[index].child_a].box, nodes[nodes[index].child_b].box);
    rotate(index);
  }
}

// Swaps a child with a grandchild of the other side where that lowers the surface of the inner node between
// (tree rotations, Kensler 2008).
template <class V>
void DynamicTree<V>::rotate(int index) {
  Node* nodes = nodes_.data();
  const int children[2] = {nodes[index].child_a, nodes[index].child_b};
  Scalar best = 0;
  int best_side = -1;
  bool best_takes_a = false;
  for (int side = 0; side < 2; ++side) {  // the inner node that would change, its child swapped with the other side
    const Node& inner = nodes[children[side]];
    if (inner.child_b < 0) continue;
    const Box& other = nodes[children[1 - side]].box;
    const Scalar now = detail::surface(inner.box);
    const Scalar keeps_b = detail::surface(merge(other, nodes[inner.child_b].box)) - now;
    const Scalar keeps_a = detail::surface(merge(other, nodes[inner.child_a].box)) - now;
    if (keeps_b < best) best = keeps_b, best_side = side, best_takes_a = true;
    if (keeps_a < best) best = keeps_a, best_side = side, best_takes_a = false;
  }
  if (best_side < 0) return;
  const int inner = children[best_side], other = children[1 - best_side];
  const int lifted = best_takes_a ? nodes[inner].child_a : nodes[inner].child_b;
  (best_takes_a ? nodes[inner].child_a : nodes[inner].child_b) = other;
  (best_side == 0 ? nodes[index].child_b : nodes[index].child_a) = lifted;
  nodes[other].parent = inner;
  nodes[lifted].parent = index;
  nodes[inner].box = merge(nodes[nodes[inner].child_a].box, nodes[nodes[inner].child_b].box);
  nodes[inner].enlarged = nodes[index].enlarged;
}

/// So many leaves are split in the middle of their centres' longest axis: bins find little more and take longer.
constexpr std::size_t few = 6;
template <class V>
std::size_t split_few(std::span<detail::BuildItem<V>> items) {
  const std::size_t count = items.size();
  if (count == 2) return 1;
  V low = items[0].box.low + items[0].box.high, high = low;
  for (const detail::BuildItem<V>& item : items) {
    const V c = item.box.low + item.box.high;
    low = min(low, c), high = max(high, c);
  }
  const V size = high - low;
  int axis = 0;
  for (int i = 1; i < detail::Axes<V>::count; ++i)
    if (size[i] > size[axis]) axis = i;
  const auto middle = (low[axis] + high[axis]) / 2;
  std::size_t i = 0, j = count;
  while (i < j) {
    if (items[i].box.low[axis] + items[i].box.high[axis] <= middle)
      ++i;
    else
      std::swap(items[i], items[--j]);
  }
  return i == 0 || i == count ? count / 2 : i;
}

template <class V>
int DynamicTree<V>::build(std::span<detail::BuildItem<V>> items) {
  if (items.size() == 1) return int(items[0].index);
  jobs_.clear();
  jobs_.push_back({0, items.size(), -1, 0, false});
  int top = -1;
  while (!jobs_.empty()) {
    const Job job = jobs_.back();
    jobs_.pop_back();
    int made;
    if (job.count == 1) {
      made = int(items[job.first].index);
    } else {
      made = take_node();
      const auto part = items.subspan(job.first, job.count);
      const std::size_t cut = job.count <= few ? split_few<V>(part) : detail::binned_split<V>(part, job.depth);
      jobs_.push_back({job.first + cut, job.count - cut, made, job.depth + 1, true});
      jobs_.push_back({job.first, cut, made, job.depth + 1, false});
      Box box = items[job.first].box;
      for (std::size_t i = 1; i < job.count; ++i) box = merge(box, items[job.first + i].box);
      nodes_[std::size_t(made)].box = box;
    }
    nodes_[std::size_t(made)].parent = job.parent;
    if (job.parent < 0)
      top = made;
    else
      (job.second ? nodes_[std::size_t(job.parent)].child_b : nodes_[std::size_t(job.parent)].child_a) = made;
  }
  return top;
}

template <class V>
void DynamicTree<V>::rebuild() {
  if (count_ < 2) return;
  least_cost_ = 0;
  build_.clear();
  // The free list is rebuilt in ascending order too, so that inner nodes lie in depth-first order.
  inner_.clear();
  detail::TraversalStack stack;
  stack.push(std::uint32_t(root_));
  while (!stack.empty()) {
    const std::uint32_t i = stack.pop();
    const Node& node = nodes_[i];
    if (node.child_b < 0) {
      build_.push_back({node.box, i});
      continue;
    }
    inner_.push_back(std::int32_t(i));
    stack.push(std::uint32_t(node.child_b));
    stack.push(std::uint32_t(node.child_a));
  }
  for (std::size_t i = inner_.size(); i-- > 0;) give_node(inner_[i]);
  root_ = build(build_);
  nodes_[std::size_t(root_)].parent = -1;
}

template <class V>
int DynamicTree<V>::rebuild_enlarged() {
  if (root_ < 0 || nodes_[std::size_t(root_)].child_b < 0 || nodes_[std::size_t(root_)].enlarged == 0) return 0;
  build_.clear();
  detail::TraversalStack stack;
  inner_.clear();
  stack.push(std::uint32_t(root_));
  while (!stack.empty()) {
    const std::uint32_t i = stack.pop();
    const Node& node = nodes_[i];
    if (node.child_b < 0 || node.enlarged == 0) {
      build_.push_back({node.box, i});
      continue;
    }
    inner_.push_back(std::int32_t(i));
    stack.push(std::uint32_t(node.child_b));
    stack.push(std::uint32_t(node.child_a));
  }
  for (std::size_t i = inner_.size(); i-- > 0;) give_node(inner_[i]);
  root_ = build(build_);
  nodes_[std::size_t(root_)].parent = -1;
  return int(build_.size());
}

template <class V>
void DynamicTree<V>::insert_all(std::span<const Box> boxes, std::span<const std::uint32_t> items, int* leaves) {
  ++version_;
  assert(boxes.size() == items.size());
  if (boxes.empty()) return;
  nodes_.reserve(nodes_.size() + 2 * boxes.size());
  build_.clear();
  build_.reserve(boxes.size());
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const int leaf = take_node();
    Node& node = nodes_[std::size_t(leaf)];
    node.box = within_range(boxes[i]);
    node.child_a = std::int32_t(items[i]);
    build_.push_back({node.box, std::uint32_t(leaf)});
    if (leaves) leaves[i] = leaf;
  }
  count_ += int(boxes.size());
  const int old = root_;
  const int made = build(build_);
  nodes_[std::size_t(made)].parent = -1;
  if (old < 0) {
    root_ = made;
    return;
  }
  const int joint = take_node();
  Node& node = nodes_[std::size_t(joint)];
  node.child_a = old;
  node.child_b = made;
  node.box = merge(nodes_[std::size_t(old)].box, nodes_[std::size_t(made)].box);
  nodes_[std::size_t(old)].parent = nodes_[std::size_t(made)].parent = joint;
  root_ = joint;
  rebuild();
}

template <class V>
int DynamicTree<V>::height() const {
  int most = 0;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    int levels = 0;
    std::int32_t at = std::int32_t(i);
    while (at != root_ && at >= 0) at = nodes_[std::size_t(at)].parent, ++levels;
    if (at == root_) most = math::max(most, levels);
  }
  return most;
}

template <class V>
double DynamicTree<V>::cost() const {
  if (root_ < 0) return 0;
  double sum = 0;
  detail::TraversalStack stack;
  stack.push(std::uint32_t(root_));
  while (!stack.empty()) {
    const Node& node = nodes_[stack.pop()];
    if (node.child_b < 0) continue;
    sum += double(detail::surface(node.box));
    stack.push(std::uint32_t(node.child_b));
    stack.push(std::uint32_t(node.child_a));
  }
  return sum / double(detail::surface(nodes_[std::size_t(root_)].box));
}

template <class V>
bool DynamicTree<V>::valid() const {
  const auto is_node = [this](std::int32_t i) { return i >= 0 && std::size_t(i) < nodes_.size(); };
  // Every node but the root is the child of its one parent, so what is reached is a tree.
  std::size_t leaves = 0, reached = 0;
  if (root_ >= 0) {
    if (!is_node(root_) || nodes_[std::size_t(root_)].parent != -1) return false;
    detail::TraversalStack stack;
    stack.push(std::uint32_t(root_));
    while (!stack.empty()) {
      const std::uint32_t i = stack.pop();
      const Node& node = nodes_[i];
      ++reached;
      if (node.child_b < 0) {
        if (node.child_a < 0 || !contains(node.box, node.box)) return false;
        ++leaves;
        continue;
      }
      if (node.child_a == node.child_b) return false;
      for (const std::int32_t child : {node.child_a, node.child_b}) {
        if (!is_node(child) || nodes_[std::size_t(child)].parent != std::int32_t(i)) return false;
        if (!contains(node.box, nodes_[std::size_t(child)].box)) return false;
        stack.push(std::uint32_t(child));
      }
    }
  }
  std::int32_t free = free_;
  for (; reached < nodes_.size() && is_node(free); ++reached) {
    const Node& node = nodes_[std::size_t(free)];
    if (node.child_a != -1 || node.child_b != -1) return false;
    free = node.parent;
  }
  return reached == nodes_.size() && free < 0 && count_ >= 0 && leaves == std::size_t(count_);
}

template class DynamicTree<Vec2d>;
template class DynamicTree<Vec3d>;
template class DynamicTree<Vec2f>;
template class DynamicTree<Vec3f>;

}  // namespace carom::geometry
