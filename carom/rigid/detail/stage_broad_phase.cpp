#include <algorithm>
#include <bit>

#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int pair_grain = 64;
constexpr int most_subtrees = 128;  ///< that threads look through
constexpr int most_in_group = BoxGroup<Dim2>::most_members;
constexpr int bounds_grain = 128, list_grain = 1024;
constexpr double most_worse = 4;  ///< times its best: a tree of what flies

/// Remembers two shapes whose bounds overlap, if they are a pair without a contact.
template <class D>
void consider_pair(WorldImplementation<D>& world, std::int32_t s, std::int32_t o, std::vector<FoundPair>& found) {
  if (o == s) return;
  const ShapeRecord<D>&shape = world.shapes.at(s), &other = world.shapes.at(o);
  if (!may_collide(world, shape, other)) return;
  if (world.pairs.contains(PairSet::key(s, o))) return;
  if (joints_forbid_collision(world, shape.body, other.body)) return;
  found.push_back(s < o ? FoundPair{s, o} : FoundPair{o, s});
}

/// Trees in which a shape of `tree` can find partners.
inline int first_tree_for(int tree) { return tree == tree_fixed ? tree_kinematic : tree_fixed; }

template <class D>
void find_pairs_of(WorldImplementation<D>& world, std::int32_t place, std::vector<FoundPair>& found,
                   int last_tree = tree_dynamic) {
  using Bounds = typename D::Bounds;
  const std::int32_t s = world.scratch.moved[std::size_t(place)];
  const ShapeRecord<D>& shape = world.shapes.at(s);
  if (shape.leaf == none) return;
  const Bounds box = world.shapes.trees[shape.tree].bounds(shape.leaf);
  const Bounds old = world.scratch.old_bounds[std::size_t(place)];
  for (int tree = first_tree_for(shape.tree); tree <= last_tree; ++tree)
    world.shapes.trees[tree].query_boxes(box, [&](std::uint32_t item, const Bounds& other) {
      // What overlapped when pairs were last looked for was considered then; but a caller's filter may change its mind.
      if (!world.contact_filter) {
        const std::int32_t other_place = world.scratch.moved_place[item];
        if (overlaps(old, other_place >= 0 ? world.scratch.old_bounds[std::size_t(other_place)] : other)) return true;
      }
      consider_pair(world, s, std::int32_t(item), found);
      return true;
    });
}

/// The same for neighbours in the tree of dynamic shapes: one descent for all, then each against all that was found.
template <class D>
void find_pairs_of_group(WorldImplementation<D>& world, std::span<const std::int32_t> places,
                         std::vector<FoundPair>& found) {
  using Bounds = typename D::Bounds;
  const StepScratch<D>& scratch = world.scratch;
  const int count = int(places.size());
  std::int32_t members[most_in_group];
  Bounds all{};
  for (int i = 0; i < count; ++i) {
    members[i] = scratch.moved[std::size_t(places[std::size_t(i)])];
    const Bounds& box = world.shapes.trees[tree_dynamic].bounds(world.shapes.at(members[i]).leaf);
    all = i == 0 ? box : merge(all, box);
  }
  const typename D::Position size = all.high - all.low, origin = all.low;
  for (int k = 0; k < D::dimension; ++k)
    if (count == 1 || size[k] > 1e3) {
      for (const std::int32_t place : places) find_pairs_of(world, place, found);
      return;
    }
  BoxGroup<D> group;
  for (int i = 0; i < count; ++i) {
    group.boxes.put(i, world.shapes.trees[tree_dynamic].bounds(world.shapes.at(members[i]).leaf), origin);
    group.old_boxes.put(i, scratch.old_bounds[std::size_t(places[std::size_t(i)])], origin);
    // A caller's filter may change its mind about what met before. Far from here it met none of these.
    bool forgets = bool(world.contact_filter);
    for (int k = 0; k < D::dimension; ++k)
      forgets =
          forgets || !(math::abs(group.old_boxes.low[k][i]) < 4e3f && math::abs(group.old_boxes.high[k][i]) < 4e3f);
    if (forgets) group.old_boxes.put_nowhere(i);
  }

  std::int32_t shapes[BoxGroup<D>::room];
  const Bounds* near[BoxGroup<D>::room];
  int number = 0;
  std::uint64_t looking = 0;  // bits by place: who looks for partners in the same way, and so finds us
  const auto look = [&] {
    for (int k = 0; k < number; ++k) {
      const std::int32_t place = scratch.moved_place[std::size_t(shapes[k])];
      group.others.put(k, *near[k], origin);
      group.old_others.put(k, place >= 0 ? scratch.old_bounds[std::size_t(place)] : *near[k], origin);
    }
    const int full = (number + 15) / 16 * 16;  // a multiple of all widths
    for (int k = number; k < full; ++k) group.others.put_nowhere(k), group.old_others.put_nowhere(k);
    std::uint64_t news[most_in_group];
    world.kernels.pairs.new_meetings(group, count, full, news);
    for (int i = 0; i < count; ++i)
      for (std::uint64_t left = news[i]; left != 0; left &= left - 1) {
        const int k = std::countr_zero(left);
        if ((looking >> k & 1u) != 0 && shapes[k] < members[i])
          news[i] ^= std::uint64_t(1) << k;
        else
          world.pairs.prefetch(PairSet::key(members[i], shapes[k]));
      }
    for (int i = 0; i < count; ++i)
      for (std::uint64_t left = news[i]; left != 0; left &= left - 1)
        consider_pair(world, members[i], shapes[std::countr_zero(left)], found);
    number = 0, looking = 0;
  };
  for (int tree = tree_fixed; tree <= tree_dynamic; ++tree)
    world.shapes.trees[tree].query_boxes(all, [&](std::uint32_t item, const Bounds& box) {
      near[number] = &box;
      if (tree == tree_dynamic && scratch.moved_place[item] >= 0) looking |= std::uint64_t(1) << number;
      shapes[number++] = std::int32_t(item);
      if (number == BoxGroup<D>::room) look();
      return true;
    });
  look();
}

/// The same for the moved shapes of a subtree, cut into groups that lie close together.
template <class D>
void find_pairs_below(WorldImplementation<D>& world, std::int32_t root, std::vector<FoundPair>& found) {
  using Bounds = typename D::Bounds;
  std::int32_t places[most_in_group];
  Bounds all{};
  int count = 0;
  const auto surface = [](const Bounds& b) { return geometry::detail::surface(b); };
  const auto look = [&] {
    if (count > 0) find_pairs_of_group(world, std::span(places, std::size_t(count)), found);
    count = 0;
  };
  world.shapes.trees[tree_dynamic].visit_leaves_below(root, [&](std::uint32_t item, const Bounds& box) {
    const std::int32_t place = world.scratch.moved_place[item];
    if (place < 0) return;
    const Bounds more = count > 0 ? merge(all, box) : box;
    const bool apart = count > 0 && surface(more) > 2 * (surface(all) + surface(box));
    if (count == most_in_group || apart) look();
    all = count > 0 ? more : box;
    places[count++] = place;
  });
  look();
}

/// Did a box go on by an eighth of its size?
template <class Bounds>
bool goes_far(const Bounds& old, const Bounds& now) {
  const auto way = abs(now.center() - old.center()), eighth = 0.125 * (old.high - old.low);
  for (int k = 0; k < geometry::detail::Axes<std::decay_t<decltype(way)>>::count; ++k)
    if (way[k] > eighth[k]) return true;
  return false;
}

/// Do the bounds of most that forces move go far? Some are asked.
bool most_fly(const WorldImplementation<Dim3>& world) {
  const StepScratch<Dim3>& scratch = world.scratch;
  if (2 * scratch.moved.size() < std::size_t(world.shapes.trees[tree_dynamic].size())) return false;
  constexpr std::size_t asked = 64;
  int fly = 0;
  for (std::size_t k = 0; k < asked; ++k) {
    const std::size_t place = k * scratch.moved.size() / asked;
    const ShapeRecord<Dim3>& shape = world.shapes.at(scratch.moved[place]);
    if (shape.leaf == none || shape.tree != tree_dynamic) continue;
    fly += goes_far(scratch.old_bounds[place], world.shapes.trees[tree_dynamic].bounds(shape.leaf)) ? 1 : 0;
  }
  return 2 * fly > int(asked);
}

/// Where most of what forces move flies and is sparse: all of its boxes against each other in one sweep. False where
/// that would take longer. `still_too`: and against what forces do not move, where that is little.
bool sweep_dynamic(WorldImplementation<Dim2>&, bool&) { return false; }
bool sweep_dynamic(WorldImplementation<Dim3>& world, bool& still_too) {
  using Bounds = geometry::Bounds3d;
  StepScratch<Dim3>& scratch = world.scratch;
  if (!most_fly(world) || !scratch.sweep.take(*world.scheduler, world.shapes.trees[tree_dynamic])) return false;
  constexpr int most_still = 32;
  const Bounds* still_box[most_still];
  std::uint32_t still[most_still];
  int count = 0;
  still_too = world.shapes.trees[tree_fixed].size() + world.shapes.trees[tree_kinematic].size() <= most_still;
  for (int tree = tree_fixed; tree <= tree_kinematic && still_too; ++tree)
    world.shapes.trees[tree].visit_leaves([&](std::uint32_t item, const Bounds& box) {
      still_box[count] = &box;
      still[count++] = item;
    });
  world.scheduler->parallel_for(scratch.sweep.strip_count(), 2, [&](int begin, int end, int worker) {
    std::vector<FoundPair>& found = scratch.found_pairs[std::size_t(worker)];
    const auto box_of = [&](std::uint32_t item) -> const Bounds& {
      return world.shapes.trees[tree_dynamic].bounds(world.shapes.at(std::int32_t(item)).leaf);
    };
    const auto old_of = [&](std::uint32_t item) -> const Bounds& {
      const std::int32_t place = scratch.moved_place[item];
      return place >= 0 ? scratch.old_bounds[std::size_t(place)] : box_of(item);
    };
    for (int strip = begin; strip < end; ++strip) {
      scratch.sweep.visit_strip(strip, [&](std::uint32_t a, std::uint32_t b) {
        if (!world.contact_filter && overlaps(old_of(a), old_of(b))) return;
        if (scratch.moved_place[a] < 0 && scratch.moved_place[b] < 0) return;
        consider_pair(world, std::int32_t(a), std::int32_t(b), found);
      });
      for (int k = 0; k < count; ++k) {
        const std::int32_t place = scratch.moved_place[still[k]];
        const Bounds &box = *still_box[k], &old = place >= 0 ? scratch.old_bounds[std::size_t(place)] : box;
        scratch.sweep.query_strip(strip, box, [&](std::uint32_t a) {
          if (scratch.moved_place[a] < 0 || (!world.contact_filter && overlaps(old_of(a), old))) return;
          if (overlaps(box_of(a), box)) consider_pair(world, std::int32_t(a), std::int32_t(still[k]), found);
        });
      }
    }
  });
  return true;
}

/// What a strip tells of becomes pairs.
struct MeetingsInStrip {
  WorldImplementation<Dim2>& world;
  std::vector<FoundPair>& found;
  int strip = 0;

  static void tell(void* whom, std::int32_t i, std::int32_t first, std::uint32_t which) {
    MeetingsInStrip& m = *static_cast<MeetingsInStrip*>(whom);
    const BoxStrips& strips = m.world.scratch.strips;
    for (; which != 0; which &= which - 1)
      if (const std::int32_t k = first + std::countr_zero(which); strips.is_of(m.strip, i, k))
        consider_pair(m.world, std::int32_t(strips.item(i)), std::int32_t(strips.item(k)), m.found);
  }
};

/// In the plane: all boxes against each other in strips, of now and of before. False where trees are faster.
bool sweep_strips(WorldImplementation<Dim3>&) { return false; }
bool sweep_strips(WorldImplementation<Dim2>& world) {
  using Bounds = geometry::Bounds2d;
  StepScratch<Dim2>& scratch = world.scratch;
  const auto& trees = world.shapes.trees;
  const std::size_t dynamic = std::size_t(trees[tree_dynamic].size()),
                    still = std::size_t(trees[tree_fixed].size()) + std::size_t(trees[tree_kinematic].size());
  // A caller's filter may change its mind about what met before.
  if (world.contact_filter || 3 * scratch.moved.size() < dynamic + still || dynamic < 64) return false;
  const Bounds whole = trees[tree_dynamic].root_bounds();
  BoxStrips& strips = scratch.strips;
  const int parts = BoxStrips::part_count(world.scheduler->thread_count(), dynamic + still);
  const std::size_t nodes = (trees[tree_dynamic].node_count() + std::size_t(parts) - 1) / std::size_t(parts);
  if (!strips.begin(whole, parts, min(nodes, dynamic) + still)) return false;
  world.scheduler->parallel_for(parts, 1, [&](int part, int, int) {
    const auto add = [&](std::uint32_t item, const Bounds& box) {
      const std::int32_t place = scratch.moved_place[item];
      if (overlaps(box, whole)) strips.add(part, item, box, place >= 0 ? scratch.old_bounds[std::size_t(place)] : box);
    };
    const std::size_t begin = std::size_t(part) * nodes;
    trees[tree_dynamic].each_leaf(begin, min(begin + nodes, trees[tree_dynamic].node_count()), add);
    for (int tree = 0; tree < tree_dynamic && part == 0; ++tree)
      trees[tree].each_leaf(0, trees[tree].node_count(), add);
  });
  if (!strips.sort(*world.scheduler)) return false;
  const StripRows rows = strips.rows();
  world.scheduler->parallel_for(strips.strip_count(), 2, [&](int begin, int end, int worker) {
    MeetingsInStrip finder{world, scratch.found_pairs[std::size_t(worker)], 0};
    for (finder.strip = begin; finder.strip < end; ++finder.strip)
      world.kernels.pairs.sweep(rows, strips.strip_begin(finder.strip), strips.strip_end(finder.strip),
                                MeetingsInStrip::tell, &finder);
  });
  return true;
}

/// Calls for the memory that the contact of a pair will need, so many contacts before it is made. Inlined always, as
/// prefetch_lines.
template <class D>
[[gnu::always_inline]] inline void call_for_creation(const WorldImplementation<D>& world, const FoundPair& pair,
                                                     std::size_t ahead) {
  world.pairs.prefetch(PairSet::key(pair.a, pair.b));
  for (const std::int32_t s : {pair.a, pair.b}) prefetch_lines(&world.shapes.record[std::size_t(s)], 128);
  const std::vector<std::int32_t>& free = world.contacts.free_contacts;
  if (free.size() > ahead) prefetch_lines(&world.contacts.at(free[free.size() - 1 - ahead]), sizeof(ContactRecord<D>));
}

/// A box that overlaps none: pairs with it have not been looked for.
template <class D>
typename D::Bounds nowhere() {
  typename D::Bounds box{};
  box.low.x = 1e30, box.high.x = -1e30;
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
  const int moved = int(scratch.moved.size());
  world.scheduler->parallel_for(moved, list_grain, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) scratch.moved_place[std::size_t(scratch.moved[std::size_t(k)])] = k;
  });
  // Where much of the tree moved, neighbours look together.
  const bool in_strips = sweep_strips(world);
  const bool grouped = !in_strips && 16 * scratch.moved.size() > std::size_t(world.shapes.trees[tree_dynamic].size());
  bool still_too = false;
  const bool swept = grouped && sweep_dynamic(world, still_too);
  const int one_by_one = in_strips ? 0 : moved;
  world.scheduler->parallel_for(one_by_one, pair_grain, [&](int begin, int end, int worker) {
    for (int i = begin; i < end; ++i) {
      const bool dynamic = world.shapes.at(scratch.moved[std::size_t(i)]).tree == tree_dynamic;
      if (!grouped || (swept && !still_too) || !dynamic)
        find_pairs_of(world, i, scratch.found_pairs[std::size_t(worker)],
                      swept && dynamic ? tree_kinematic : tree_dynamic);
    }
  });
  if (grouped && !swept) {
    std::int32_t roots[most_subtrees];
    const int count = world.shapes.trees[tree_dynamic].subtrees(roots);
    world.scheduler->parallel_for(count, 1, [&](int begin, int end, int worker) {
      for (int k = begin; k < end; ++k) find_pairs_below(world, roots[k], scratch.found_pairs[std::size_t(worker)]);
    });
  }
  level_room(scratch.found_pairs);
  scratch.pairs.clear();
  for (const std::vector<FoundPair>& list : scratch.found_pairs)
    scratch.pairs.insert(scratch.pairs.end(), list.begin(), list.end());
  // Which worker found a pair is chance; the order of creation must not be. Where both moved it may be found twice.
  std::sort(scratch.pairs.begin(), scratch.pairs.end());
  scratch.pairs.erase(std::unique(scratch.pairs.begin(), scratch.pairs.end()), scratch.pairs.end());
  for (std::size_t k = 0; k < scratch.pairs.size(); ++k) {
    const FoundPair& pair = scratch.pairs[k];
    if (k + 6 < scratch.pairs.size()) call_for_creation(world, scratch.pairs[k + 6], 6);
    if (!world.contact_filter ||
        world.contact_filter(world.shapes.slots.handle_at(pair.a), world.shapes.slots.handle_at(pair.b)))
      create_contact(world, pair.a, pair.b);
  }
  world.scheduler->parallel_for(moved, list_grain, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) {
      const std::int32_t s = scratch.moved[std::size_t(k)];
      world.shapes.at(s).flags &= std::uint8_t(~shape_moved);
      scratch.moved_place[std::size_t(s)] = none;
    }
  });
  scratch.moved.clear();
  scratch.old_bounds.clear();
}

/// The shapes that left their fat bounds, in the order of their bodies, and their places among those that moved.
template <class D>
void list_outgrown(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  const std::vector<std::int32_t>& awake = world.bodies.awake;
  // Each thread lists those of its part of the bodies.
  const int parts = int(scratch.found_outgrown.size()), count = int(awake.size()), grain = (count + parts - 1) / parts;
  for (std::vector<std::int32_t>& list : scratch.found_outgrown) list.clear();
  world.scheduler->parallel_for(count, grain, [&](int begin, int end, int) {
    std::vector<std::int32_t>& found = scratch.found_outgrown[std::size_t(begin / grain)];
    const auto changes = [&](int i) { return i < end && scratch.body_changes[std::size_t(i)] != 0; };
    const auto record = [&](int i) -> BodyRecord& { return world.bodies.record[std::size_t(awake[std::size_t(i)])]; };
    for (int i = begin; i < end; ++i) {
      if (changes(i + 16)) __builtin_prefetch(&record(i + 16));
      if (changes(i + 8))
        if (const std::int32_t s = record(i + 8).first_shape; s != none)
          prefetch_lines(&world.shapes.at(s), sizeof(ShapeTraits<D>));
      if (!changes(i)) continue;
      for (std::int32_t s = record(i).first_shape; s != none;) {
        ShapeRecord<D>& shape = world.shapes.at(s);
        if ((shape.flags & shape_outgrown) != 0) {
          const bool known = (shape.flags & shape_moved) != 0;  // its old bounds are, or none need be
          found.push_back(known ? ~s : s);
          shape.flags = std::uint8_t((shape.flags & ~shape_outgrown) | shape_moved);
        }
        s = shape.next;
      }
    }
  });
  level_room(scratch.found_outgrown);
  scratch.outgrown.clear();
  scratch.outgrown_places.clear();
  scratch.outgrown.reserve(scratch.moved.capacity());
  scratch.outgrown_places.reserve(scratch.moved.capacity());
  for (const std::vector<std::int32_t>& list : scratch.found_outgrown)
    for (const std::int32_t s : list) {
      scratch.outgrown.push_back(s < 0 ? ~s : s);
      scratch.outgrown_places.push_back(s < 0 ? none : std::int32_t(scratch.moved.size()));
      if (s >= 0) scratch.moved.push_back(s);
    }
  scratch.old_bounds.resize(scratch.moved.size());
}

template <class D>
void update_trees(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  scratch.old_bounds.resize(scratch.moved.size(), nowhere<D>());
  list_outgrown(world);
  // From one in sixteen on, making all boxes of the tree anew from below takes less than sorting these into new places.
  const std::size_t leaves = std::size_t(world.shapes.trees[tree_dynamic].size());
  const bool refit = 16 * scratch.outgrown.size() > leaves;
  scratch.new_bounds.reserve(scratch.outgrown.capacity());
  scratch.new_bounds.resize(scratch.outgrown.size());
  world.scheduler->parallel_for(int(scratch.outgrown.size()), bounds_grain, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) {
      if (k + 6 < end) {
        const ShapeRecord<D>& soon = world.shapes.at(scratch.outgrown[std::size_t(k) + 6]);
        prefetch_lines(&soon, D::dimension == 2 ? sizeof(ShapeRecord<D>) - 16 : 192);
        __builtin_prefetch(&world.bodies.pose[std::size_t(soon.body)]);
        __builtin_prefetch(&world.bodies.solver[std::size_t(soon.body)]);
        __builtin_prefetch(&world.bodies.record[std::size_t(soon.body)]);
        prefetch_lines(&world.bodies.motion[std::size_t(soon.body)], sizeof(BodyMotion<D>));
      }
      const ShapeRecord<D>& shape = world.shapes.at(scratch.outgrown[std::size_t(k)]);
      auto& tree = world.shapes.trees[shape.tree];
      const std::int32_t place = scratch.outgrown_places[std::size_t(k)];
      if (place != none) scratch.old_bounds[std::size_t(place)] = tree.bounds(shape.leaf);
      const typename D::Bounds box = fat_bounds(world, shape);
      scratch.new_bounds[std::size_t(k)] = box;
      if (refit && shape.tree == tree_dynamic) tree.set_bounds(shape.leaf, box);
    }
  });
  bool enlarged[3] = {};
  std::size_t far = 0;
  // In the plane nothing is left to do for what forces move.
  const bool done = refit && D::dimension == 2 && world.shapes.trees[tree_kinematic].empty();
  if (done) enlarged[tree_dynamic] = true;
  for (std::size_t k = 0; k < scratch.outgrown.size() && !done; ++k) {
    const ShapeRecord<D>& shape = world.shapes.at(scratch.outgrown[k]);
    const std::int32_t place = scratch.outgrown_places[k];
    enlarged[shape.tree] = true;
    if (!refit || shape.tree != tree_dynamic)
      world.shapes.trees[shape.tree].enlarge(shape.leaf, scratch.new_bounds[k]);
    else if (D::dimension == 3 && place != none &&
             goes_far(scratch.old_bounds[std::size_t(place)], scratch.new_bounds[k]))
      ++far;
  }
  for (int tree = 0; tree < 3; ++tree)
    if (enlarged[tree]) {
      if (refit && tree == tree_dynamic)
        // What flies is soon elsewhere, and its pairs are found without the tree (sweep_dynamic).
        world.shapes.trees[tree].refit(*world.scheduler, 2 * far > scratch.outgrown.size() ? most_worse : 1.1);
      else
        world.shapes.trees[tree].rebuild_enlarged();
    }
}

template void find_pairs<Dim2>(WorldImplementation<Dim2>&);
template void find_pairs<Dim3>(WorldImplementation<Dim3>&);
template void update_trees<Dim2>(WorldImplementation<Dim2>&);
template void update_trees<Dim3>(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
