// Which shapes of a world a query sees, and those near a box.
#pragma once

#include "carom/geometry/tree_walk.h"
#include "carom/rigid/detail/contacts.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

/// A filter with the slot of the body that it ignores.
struct SeenFilter {
  std::uint64_t category, mask;
  const SharedValues<ShapeTerms>& terms;
  std::int32_t ignored;
  template <class D>
  SeenFilter(const WorldImplementation<D>& world, const QueryFilter& f)
      : category(f.category),
        mask(f.mask),
        terms(world.shapes.terms),
        ignored(world.bodies.slots.contains(f.ignore) ? world.bodies.slots.slot(f.ignore) : none) {}
};
template <class D>
bool query_sees(const ShapeRecord<D>& shape, const SeenFilter& filter) {
  const Filter& own = filter.terms[shape.terms].filter;
  return (shape.flags & shape_sensor) == 0 && (own.category & filter.mask) != 0 && (filter.category & own.mask) != 0 &&
         shape.body != filter.ignored;
}
template <class D>
typename D::Bounds world_bounds(const typename D::Shape& shape, const typename D::Pose& pose) {
  using Position = typename D::Position;
  const auto local = geometry::bounds(shape, typename D::Transform{{}, pose.rotation});
  return {pose.position + Position(local.low), pose.position + Position(local.high)};
}
template <class D>
const QueryTree<typename D::Position>* query_tree(const WorldImplementation<D>& world, int index) {
  const auto tight = [&](std::uint32_t item) {
    const auto& shape = world.shapes.at(std::int32_t(item));
    const typename D::Bounds box = world_bounds<D>(shape.geometry, shape_pose<D>(world, shape));
    const auto& fat = world.shapes.trees[shape.tree].bounds(shape.leaf);  // finite, where a plane's is not
    return typename D::Bounds{max(box.low, fat.low), min(box.high, fat.high)};
  };
  return world.query_trees.of(index, world.shapes.trees[index], index == tree_fixed ? 0 : world.moves, tight);
}
/// Every shape that may meet `box`: visit(slot, a box that holds it, whether that is the tight one or the tree's).
template <class D, class Visit>
void visit_seen_boxes(const WorldImplementation<D>& world, const typename D::Bounds& box, Visit&& visit) {
  for (int t = 0; t < 3; ++t) {
    const auto& tree = world.shapes.trees[t];
    if (tree.empty()) continue;
    const auto* made = query_tree<D>(world, t);
    if (made == nullptr) {
      tree.query_boxes(box, [&](std::uint32_t item, const typename D::Bounds& fat) {
        visit(std::int32_t(item), fat, false);
        return true;
      });
      continue;
    }
    const auto look = [&](std::size_t place) {
      if (geometry::detail::boxes_meet(made->boxes[place], box)) visit(made->slots[place], made->boxes[place], true);
      return true;
    };
    if (made->wide.nodes.empty())
      for (std::size_t i = 0; i < made->slots.size(); ++i) look(i);
    else
      query(made->wide, box, look);
  }
}

}  // namespace carom::rigid::detail
