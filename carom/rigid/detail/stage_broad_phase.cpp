#include <algorithm>

#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int pair_grain = 64;

template <class D>
void find_pairs_of(WorldImplementation<D>& world, std::int32_t s, std::vector<FoundPair>& found) {
  const ShapeRecord<D>& shape = world.shapes.at(s);
  if (shape.leaf == none) return;
  const typename D::Bounds box = world.shapes.trees[shape.tree].bounds(shape.leaf);
  const auto visit = [&](std::uint32_t item) {
    const std::int32_t o = std::int32_t(item);
    if (o == s) return true;
    const ShapeRecord<D>& other = world.shapes.at(o);
    // Where both moved, the pair is found twice: only the lower slot reports it.
    if ((other.flags & shape_moved) != 0 && o < s) return true;
    if (!may_collide(world, shape, other)) return true;
    if (world.pairs.contains(PairSet::key(s, o))) return true;
    if (joints_forbid_collision(world, shape.body, other.body)) return true;
    found.push_back(s < o ? FoundPair{s, o} : FoundPair{o, s});
    return true;
  };
  for (int tree = shape.tree == tree_fixed ? tree_kinematic : tree_fixed; tree <= tree_dynamic; ++tree)
    world.shapes.trees[tree].query(box, visit);
}

}  // namespace

template <class D>
void find_pairs(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  if (scratch.moved.empty()) return;
  for (std::vector<FoundPair>& list : scratch.found_pairs) list.clear();
  world.scheduler->parallel_for(int(scratch.moved.size()), pair_grain, [&](int begin, int end, int worker) {
    for (int i = begin; i < end; ++i)
      find_pairs_of(world, scratch.moved[std::size_t(i)], scratch.found_pairs[std::size_t(worker)]);
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
  for (const std::int32_t s : scratch.moved) world.shapes.at(s).flags &= std::uint8_t(~shape_moved);
  scratch.moved.clear();
}

template <class D>
void update_trees(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  bool enlarged[3] = {};
  for (std::size_t i = 0; i < world.bodies.awake.size(); ++i) {
    if (scratch.body_changes[i] == 0) continue;
    const std::int32_t body = world.bodies.awake[i];
    for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next) {
      ShapeRecord<D>& shape = world.shapes.at(s);
      if ((shape.flags & shape_outgrown) == 0) continue;
      shape.flags &= std::uint8_t(~shape_outgrown);
      world.shapes.trees[shape.tree].enlarge(shape.leaf, fat_bounds(world, shape));
      enlarged[shape.tree] = true;
      if ((shape.flags & shape_moved) == 0) {
        shape.flags |= shape_moved;
        scratch.moved.push_back(s);
      }
    }
  }
  for (int tree = 0; tree < 3; ++tree)
    if (enlarged[tree]) world.shapes.trees[tree].rebuild_enlarged();
}

template void find_pairs<Dim2>(WorldImplementation<Dim2>&);
template void find_pairs<Dim3>(WorldImplementation<Dim3>&);
template void update_trees<Dim2>(WorldImplementation<Dim2>&);
template void update_trees<Dim3>(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
