// What queries walk, beside the trees that follow moving shapes.
#pragma once

#include <atomic>
#include <vector>

#include "carom/geometry/dynamic_tree.h"
#include "carom/geometry/static_tree.h"

namespace carom::rigid::detail {

/// A tree's shapes with their tight boxes, and a wide tree over them.
template <class Position>
struct QueryTree {
  std::vector<geometry::Bounds<Position>> boxes;
  std::vector<std::int32_t> slots;    ///< of shapes, beside their boxes
  geometry::WideTree<Position> wide;  ///< of places in these; none over a few
  static constexpr std::size_t few = 3;
};

/// Made once a tree has been asked about as often as it has leaves since anything in it last moved: by then as much
/// work has been spent on walking the slower tree. Answers do not depend on which is walked. Queries of several threads
/// at once may share this.
template <class Position>
class QueryTrees {
 public:
  /// Null: ask `tree` itself. `moves` counts up whenever poses change that the tree need not know of;
  /// tight(slot) is the box of a shape.
  template <class Tight>
  const QueryTree<Position>* of(int index, const geometry::DynamicTree<Position>& tree, std::uint64_t moves,
                                Tight&& tight) {
    Copy& copy = copies_[index];
    const std::uint64_t version = tree.version() + moves;  // both only grow
    if (copy.version.load(std::memory_order_acquire) == version) return &copy.tree;
    if (copy.asked_version.load(std::memory_order_relaxed) != version) {
      copy.asked_version.store(version, std::memory_order_relaxed);
      copy.asked_before.store(copy.asked.exchange(0, std::memory_order_relaxed), std::memory_order_relaxed);
    }
    // Where that would have come late in the version before, as of characters that look around once a step, it will
    // now.
    const int size = tree.size(), before = copy.asked_before.load(std::memory_order_relaxed);
    const int enough = before >= size && before < 2 * size ? 2 * size : size;
    if (copy.asked.fetch_add(1, std::memory_order_relaxed) < enough) return nullptr;
    if (copy.building.exchange(true, std::memory_order_acquire)) return nullptr;
    QueryTree<Position>& made = copy.tree;
    if (copy.version.load(std::memory_order_relaxed) != version) {
      made.boxes.clear();
      made.slots.clear();
      made.boxes.reserve(std::size_t(tree.size()));
      made.slots.reserve(std::size_t(tree.size()));
      tree.query(tree.root_bounds(), [&](std::uint32_t item) {
        made.boxes.push_back(tight(item));
        made.slots.push_back(std::int32_t(item));
        return true;
      });
      copy.order.clear();
      if (made.boxes.size() > QueryTree<Position>::few)
        for (std::size_t i = 0; i < made.boxes.size(); ++i) copy.order.push_back({made.boxes[i], std::uint32_t(i)});
      geometry::detail::build_wide_tree<Position>(copy.order, 1, made.wide);
      copy.version.store(version, std::memory_order_release);
    }
    copy.building.store(false, std::memory_order_release);
    return &made;
  }
  std::size_t bytes() const {
    std::size_t sum = 0;
    for (const Copy& copy : copies_)
      sum += copy.tree.wide.bytes() + copy.tree.boxes.capacity() * sizeof(geometry::Bounds<Position>) +
             copy.tree.slots.capacity() * sizeof(std::int32_t) +
             copy.order.capacity() * sizeof(geometry::detail::BuildItem<Position>);
    return sum;
  }

 private:
  struct Copy {
    std::atomic<std::uint64_t> version{0}, asked_version{0};
    std::atomic<int> asked{0}, asked_before{0};
    std::atomic<bool> building{false};  // one thread makes it; WebAssembly without threads has no mutex
    QueryTree<Position> tree;
    std::vector<geometry::detail::BuildItem<Position>> order;  ///< of a build
  };
  Copy copies_[3];
};

}  // namespace carom::rigid::detail
