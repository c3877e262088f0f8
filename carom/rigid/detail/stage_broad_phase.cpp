#include <algorithm>

#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int pair_grain = 64;

template <class D>
void find_pairs_of(WorldImplementation<D>& world, std::int32_t place, std::vector<FoundPair>& found) {
  using Bounds = typename D::Bounds;
  const StepScratch<D>& scratch = world.scratch;
  const std::int32_t s = scratch.moved[std::size_t(place)];
  const ShapeRecord<D>& shape = world.shapes.at(s);
  if (shape.leaf == none) return;
  const Bounds box = world.shapes.trees[shape.tree].bounds(shape.leaf);
  const Bounds old = scratch.old_bounds[std::size_t(place)];
  const auto visit = [&](std::uint32_t item, const Bounds& other_box) {
    const std::int32_t o = std::int32_t(item);
    const std::int32_t other_place = scratch.moved_place[std::size_t(o)];
    // Where both moved, the pair is found twice: only the lower slot reports it.
    if (o == s || (other_place >= 0 && o < s)) return true;
    // What overlapped when pairs were last looked for was considered then; but a caller's filter may change its mind.
    if (!world.contact_filter &&
        overlaps(old, other_place >= 0 ? scratch.old_bounds[std::size_t(other_place)] : other_box))
      return true;
    const ShapeRecord<D>& other = world.shapes.at(o);
    if (!may_collide(world, shape, other)) return true;
    if (world.pairs.contains(PairSet::key(s, o))) return true;
    if (joints_forbid_collision(world, shape.body, other.body)) return true;
    found.push_back(s < o ? FoundPair{s, o} : FoundPair{o, s});
    return true;
  };
  for (int tree = shape.tree == tree_fixed ? tree_kinematic : tree_fixed; tree <= tree_dynamic; ++tree)
    world.shapes.trees[tree].query_boxes(box, visit);
}

/// A box that overlaps none: pairs with it have not been looked for.
template <class D>
typename D::Bounds nowhere() {
  typename D::Bounds box{};
  box.low.x = 1e300, box.high.x = -1e300;
  return box;
}

}  // namespace

template <class D>
void find_pairs(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  if (scratch.moved.empty()) return;
  for (std::vector<FoundPair>& list : scratch.found_pairs) list.clear();
  scratch.old_bounds.resize(scratch.moved.size(), nowhere<D>());
  scratch.moved_place.resize(world.shapes.record.size(), none);
  for (std::size_t k = 0; k < scratch.moved.size(); ++k)
    scratch.moved_place[std::size_t(scratch.moved[k])] = std::int32_t(k);
  world.scheduler->parallel_for(int(scratch.moved.size()), pair_grain, [&](int begin, int end, int worker) {
    for (int i = begin; i < end; ++i) find_pairs_of(world, i, scratch.found_pairs[std::size_t(worker)]);
  });
  level_room(scratch.found_pairs);
  scratch.pairs.clear();
  for (const std::vector<FoundPair>& list : scratch.found_pairs)
    scratch.pairs.insert(scratch.pairs.end(), list.begin(), list.end());
  // Which worker found a pair is chance; the order of creation must not be.
  std::sort(scratch.pairs.begin(), scratch.pairs.end());
  scratch.pairs.erase(std::unique(scratch.pairs.begin(), scratch.pairs.end()), scratch.pairs.end());
  for (const FoundPair& pair : scratch.pairs)
    if (!world.contact_filter ||
        world.contact_filter(world.shapes.slots.handle_at(pair.a), world.shapes.slots.handle_at(pair.b)))
      create_contact(world, pair.a, pair.b);
  for (const std::int32_t s : scratch.moved) {
    world.shapes.at(s).flags &= std::uint8_t(~shape_moved);
    scratch.moved_place[std::size_t(s)] = none;
  }
  scratch.moved.clear();
  scratch.old_bounds.clear();
}

template <class D>
void update_trees(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  // Where most of a tree moves, its boxes are made anew from below in one go.
  std::size_t outgrown = 0;
  for (const std::uint8_t change : scratch.body_changes) outgrown += change != 0 ? 1 : 0;
  const bool refit = 4 * outgrown > std::size_t(world.shapes.trees[tree_dynamic].size());
  scratch.old_bounds.resize(scratch.moved.size(), nowhere<D>());
  bool enlarged[3] = {};
  for (std::size_t i = 0; i < world.bodies.awake.size(); ++i) {
    if (scratch.body_changes[i] == 0) continue;
    const std::int32_t body = world.bodies.awake[i];
    for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next) {
      ShapeRecord<D>& shape = world.shapes.at(s);
      if ((shape.flags & shape_outgrown) == 0) continue;
      shape.flags &= std::uint8_t(~shape_outgrown);
      auto& tree = world.shapes.trees[shape.tree];
      if ((shape.flags & shape_moved) == 0) {
        shape.flags |= shape_moved;
        scratch.moved.push_back(s);
        scratch.old_bounds.push_back(tree.bounds(shape.leaf));
      }
      if (refit && shape.tree == tree_dynamic)
        tree.set_bounds(shape.leaf, fat_bounds(world, shape));
      else
        tree.enlarge(shape.leaf, fat_bounds(world, shape));
      enlarged[shape.tree] = true;
    }
  }
  for (int tree = 0; tree < 3; ++tree)
    if (enlarged[tree]) {
      if (refit && tree == tree_dynamic)
        world.shapes.trees[tree].refit();
      else
        world.shapes.trees[tree].rebuild_enlarged();
    }
}

template void find_pairs<Dim2>(WorldImplementation<Dim2>&);
template void find_pairs<Dim3>(WorldImplementation<Dim3>&);
template void update_trees<Dim2>(WorldImplementation<Dim2>&);
template void update_trees<Dim3>(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
