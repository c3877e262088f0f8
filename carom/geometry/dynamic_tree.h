// A bounding-volume tree over boxes that come, move and go: the broad phase of a world.
// Boxes are kept in the precision they come in (double in a world), because float boxes relative to one origin would
// grow by a metre at 10⁷ m; a node of space then fills one cache line.
#pragma once

#include <cstdint>
#include <type_traits>
#include <vector>

#include "carom/core/column.h"
#include "carom/core/scheduler.h"
#include "carom/export.h"
#include "carom/geometry/detail/tree_build.h"

namespace carom::geometry {

/// Leaves are named by their node, which stays the same until it is removed. The structure is a pure function of the
/// calls made, so two worlds with the same history visit in the same order. Copy it to keep a snapshot.
/// V: Vec2d, Vec3d, Vec2f or Vec3f. Coordinates beyond ±10¹⁵ m are taken as that (an infinite plane's box).
template <class V>
class CAROM_API DynamicTree {
 public:
  using Box = Bounds<V>;
  using Scalar = typename detail::Axes<V>::Scalar;

  /// Returns the leaf. `item` is the caller's own number.
  int insert(const Box& box, std::uint32_t item);
  void remove(int leaf);
  /// Gives the leaf a new box, and a new place in the tree where it leaves its part of that.
  void update(int leaf, const Box& box);
  /// Gives the leaf a new box but leaves it in its place, widening what is above: cheaper than `update`, for many
  /// movers in a step. What has been widened is built anew by `rebuild_enlarged`.
  void enlarge(int leaf, const Box& box);
  /// Rebuilds the parts above enlarged leaves. Returns how many subtrees were sorted into new places.
  int rebuild_enlarged();
  /// Gives the leaf a new box and leaves everything else wrong until `refit`: for when most leaves move. Different
  /// leaves may be given theirs at once on several threads.
  void set_bounds(int leaf, const Box& box);
  /// Tightens all inner boxes to their leaves, and builds the whole tree anew once its summed surface has become so
  /// many times the least that it was. True if it did.
  bool refit(double worst = 1.2);
  /// The same on several threads.
  bool refit(core::TaskScheduler& scheduler, double worst);
  /// Builds the whole tree anew from its leaves (binned surface area heuristic); leaves keep their names.
  void rebuild();
  /// Inserts all boxes at once: leaves[i] (if not null) is the leaf of boxes[i], items[i] its item. Much faster, and a
  /// better tree, than one by one.
  void insert_all(std::span<const Box> boxes, std::span<const std::uint32_t> items, int* leaves);
  void clear();
  void reserve(int leaves);
  void release_scratch();  ///< gives back what only builds need

  const Box& bounds(int leaf) const { return nodes_[std::size_t(leaf)].box; }
  std::uint32_t item(int leaf) const { return std::uint32_t(nodes_[std::size_t(leaf)].child_a); }
  void set_item(int leaf, std::uint32_t item) { ++version_, nodes_[std::size_t(leaf)].child_a = std::int32_t(item); }
  int size() const { return count_; }  ///< leaves
  bool empty() const { return root_ < 0; }
  Box root_bounds() const { return root_ < 0 ? Box{} : nodes_[std::size_t(root_)].box; }
  std::size_t bytes() const { return nodes_.capacity() * sizeof(Node) + scratch_bytes(); }
  std::size_t scratch_bytes() const {  ///< of these, what only builds need
    return build_.capacity() * sizeof(detail::BuildItem<V>) + jobs_.capacity() * sizeof(Job) +
           inner_.capacity() * sizeof(std::int32_t);
  }

  /// Counts the changes, from 1: a copy made for another purpose is good as long as this stays.
  std::uint64_t version() const { return version_; }

  /// Calls visit(item) for every leaf whose box meets `box`; visit returns false to stop.
  template <class Visit>
  void query(const Box& box, Visit&& visit) const {
    query_boxes(box, [&](std::uint32_t item, const Box&) { return visit(item); });
  }
  /// The same with the leaf's box: visit(item, box).
  template <class Visit>
  void query_boxes(const Box& box, Visit&& visit) const {
    descend([&](const Box& b) { return detail::boxes_meet(b, box); }, visit);
  }
  /// Calls visit(item, box) for every leaf; neighbours in space mostly follow each other.
  template <class Visit>
  void visit_leaves(Visit&& visit) const {
    visit_leaves_below(root_, visit);
  }
  /// The same in the order in which they lie in memory: of the nodes [begin, end) of node_count().
  template <class Visit>
  void each_leaf(std::size_t begin, std::size_t end, Visit&& visit) const {
    for (const Node *node = nodes_.data() + begin, *last = nodes_.data() + end; node < last; ++node)
      if (node->child_b < 0 && node->child_a >= 0) visit(std::uint32_t(node->child_a), node->box);
  }
  std::size_t node_count() const { return nodes_.size(); }

  /// Subtrees that together hold all leaves, in the order in which visit_leaves comes to them: for work on several
  /// threads. Returns how many there are, at most roots.size().
  int subtrees(std::span<std::int32_t> roots) const;
  /// visit_leaves for one of them.
  template <class Visit>
  void visit_leaves_below(std::int32_t root, Visit&& visit) const {
    descend([](const Box&) { return true; },
            [&](std::uint32_t item, const Box& box) {
              visit(item, box);
              return true;
            },
            root);
  }

  /// The box of half extents `extents` (zero: a ray) travels from `origin` by `translation`. Calls
  /// visit(item, limit) → new limit for every leaf that it may meet before `limit` (at first 1), near ones first where
  /// that is cheap to know: return `limit` to go on, a smaller fraction to clip, a negative one to stop.
  template <class Visit>
  void cast(V origin, V translation, V extents, Visit&& visit) const {
    if (root_ < 0) return;
    const detail::SlabRay<V> ray(origin, translation, extents);
    Scalar limit = 1;
    detail::TraversalStack stack;
    stack.push(std::uint32_t(root_));
    while (!stack.empty()) {
      const Node& node = nodes_[stack.pop()];
      if (ray.enter(node.box, limit) > limit) continue;
      if (node.child_b < 0) {
        limit = Scalar(visit(std::uint32_t(node.child_a), limit));
        if (limit < 0) return;
        continue;
      }
      const Scalar a = ray.enter(nodes_[std::size_t(node.child_a)].box, limit);
      const Scalar b = ray.enter(nodes_[std::size_t(node.child_b)].box, limit);
      const bool b_first = b < a;
      const std::int32_t near = b_first ? node.child_b : node.child_a, far = b_first ? node.child_a : node.child_b;
      if ((b_first ? a : b) <= limit) stack.push(std::uint32_t(far));
      if ((b_first ? b : a) <= limit) stack.push(std::uint32_t(near));
    }
  }

  /// Calls visit(item_of_this, item_of_other) for every pair of leaves whose boxes meet, one tree against another.
  template <class Visit>
  void pairs(const DynamicTree& other, Visit&& visit) const {
    if (root_ < 0 || other.root_ < 0) return;
    detail::TraversalStack stack;
    stack.push(std::uint32_t(other.root_));
    stack.push(std::uint32_t(root_));
    while (!stack.empty()) {
      const std::uint32_t i = stack.pop();
      const std::uint32_t j = stack.pop();
      const Node &a = nodes_[i], &b = other.nodes_[j];
      if (!detail::boxes_meet(a.box, b.box)) continue;
      const bool leaf_a = a.child_b < 0, leaf_b = b.child_b < 0;
      if (leaf_a && leaf_b) {
        visit(std::uint32_t(a.child_a), std::uint32_t(b.child_a));
      } else if (leaf_b || (!leaf_a && detail::surface(a.box) >= detail::surface(b.box))) {
        stack.push(j), stack.push(std::uint32_t(a.child_b));
        stack.push(j), stack.push(std::uint32_t(a.child_a));
      } else {
        stack.push(std::uint32_t(b.child_b)), stack.push(i);
        stack.push(std::uint32_t(b.child_a)), stack.push(i);
      }
    }
  }

  /// Calls visit(item, item) once for every pair of different leaves of this tree whose boxes meet.
  template <class Visit>
  void self_pairs(Visit&& visit) const {
    if (root_ < 0) return;
    detail::TraversalStack stack;
    stack.push(std::uint32_t(root_));
    stack.push(std::uint32_t(root_));
    while (!stack.empty()) {
      const std::uint32_t i = stack.pop();
      const std::uint32_t j = stack.pop();
      const Node &a = nodes_[i], &b = nodes_[j];
      if (i == j) {
        if (a.child_b < 0) continue;
        const std::uint32_t l = std::uint32_t(a.child_a), r = std::uint32_t(a.child_b);
        stack.push(r), stack.push(l);
        stack.push(r), stack.push(r);
        stack.push(l), stack.push(l);
        continue;
      }
      if (!detail::boxes_meet(a.box, b.box)) continue;
      const bool leaf_a = a.child_b < 0, leaf_b = b.child_b < 0;
      if (leaf_a && leaf_b) {
        visit(std::uint32_t(a.child_a), std::uint32_t(b.child_a));
      } else if (leaf_b || (!leaf_a && detail::surface(a.box) >= detail::surface(b.box))) {
        stack.push(j), stack.push(std::uint32_t(a.child_b));
        stack.push(j), stack.push(std::uint32_t(a.child_a));
      } else {
        stack.push(std::uint32_t(b.child_b)), stack.push(i);
        stack.push(std::uint32_t(b.child_a)), stack.push(i);
      }
    }
  }

  /// Calls visit(member) for everything that changes, plain arrays and numbers: for who saves and restores the tree.
  /// `tree` may be const.
  template <class Tree, class Visit>
  static void visit_members(Tree& tree, Visit&& visit) {
    visit(tree.nodes_);
    visit(tree.root_);
    visit(tree.free_);
    visit(tree.count_);
    visit(tree.least_cost_);
    if constexpr (!std::is_const_v<Tree>) ++tree.version_;
  }

  /// For tests and reports: levels below the root, summed surface of inner nodes over that of the root, and whether
  /// every link and box is consistent.
  int height() const;
  double cost() const;
  bool valid() const;
  /// Whether there is such a leaf, of this item. Of a valid tree.
  bool has_leaf(int leaf, std::uint32_t item) const {
    return leaf >= 0 && std::size_t(leaf) < nodes_.size() && nodes_[std::size_t(leaf)].child_b < 0 &&
           nodes_[std::size_t(leaf)].child_a >= 0 && this->item(leaf) == item;
  }

 private:
  struct Node {
    Box box{};
    std::int32_t parent = -1;   ///< free nodes: the next free one
    std::int32_t child_a = -1;  ///< leaves: the item
    std::int32_t child_b = -1;  ///< −1: leaf
    std::uint32_t enlarged = 0;
  };
  /// Calls visit(item, box) for the leaves whose boxes, and those above them, `wanted` says yes to.
  template <class Wanted, class Visit>
  void descend(Wanted&& wanted, Visit&& visit) const {
    descend(wanted, visit, root_);
  }
  template <class Wanted, class Visit>
  void descend(Wanted&& wanted, Visit&& visit, std::int32_t root) const {
    if (root < 0) return;
    detail::TraversalStack stack;
    std::int32_t index = root;
    if (!wanted(nodes_[std::size_t(index)].box)) return;
    while (true) {
      const Node& node = nodes_[std::size_t(index)];
      if (node.child_b < 0) {
        if (!visit(std::uint32_t(node.child_a), node.box)) return;
      } else {
        const bool a = wanted(nodes_[std::size_t(node.child_a)].box);
        const bool b = wanted(nodes_[std::size_t(node.child_b)].box);
        if (a) {
          if (b) {
            __builtin_prefetch(&nodes_[std::size_t(node.child_b)].parent);  // who wants all has not looked at it
            stack.push(std::uint32_t(node.child_b));
          }
          index = node.child_a;
          continue;
        }
        if (b) {
          index = node.child_b;
          continue;
        }
      }
      if (stack.empty()) return;
      index = std::int32_t(stack.pop());
    }
  }
  struct Job {
    std::size_t first, count;
    int parent, depth;
    bool second;
  };
  int take_node();
  void give_node(int node);
  void link(int leaf);
  void unlink(int leaf);
  void fit_from(int index);  ///< fits boxes to what they hold, from here up as far as that changes them
  int subtrees(std::span<std::int32_t> roots, int& levels) const;
  double refit_below(int top, int levels);
  void refit_and_rotate(int node);
  void rotate(int node);
  int build(std::span<detail::BuildItem<V>> items);

  core::Column<Node> nodes_;
  // Of a build; kept, so that a tree that was once built does not allocate again.
  std::vector<detail::BuildItem<V>> build_;
  std::vector<Job> jobs_;
  std::vector<std::int32_t> inner_;
  std::int32_t root_ = -1, free_ = -1;
  int count_ = 0;
  std::uint64_t version_ = 1;
  double least_cost_ = 0;  ///< summed surface of inner nodes when it was least since the last build; 0: not known
};

extern template class CAROM_API DynamicTree<Vec2d>;
extern template class CAROM_API DynamicTree<Vec3d>;
extern template class CAROM_API DynamicTree<Vec2f>;
extern template class CAROM_API DynamicTree<Vec3f>;
using DynamicTree2 = DynamicTree<Vec2d>;
using DynamicTree3 = DynamicTree<Vec3d>;

}  // namespace carom::geometry
