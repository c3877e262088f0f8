#include <algorithm>

#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr std::uint64_t sleep_interval = 4;  ///< steps between looks at the islands
constexpr float settling_time = 1;           ///< s: so long friction may take back what slipped before a body sleeps

/// Union-find over places in the list of awake bodies; roots are the lowest place of their set.
std::int32_t find_root(std::vector<std::int32_t>& parent, std::int32_t i) {
  while (parent[std::size_t(i)] != i) {
    parent[std::size_t(i)] = parent[std::size_t(parent[std::size_t(i)])];
    i = parent[std::size_t(i)];
  }
  return i;
}
void unite(std::vector<std::int32_t>& parent, std::int32_t a, std::int32_t b) {
  a = find_root(parent, a);
  b = find_root(parent, b);
  if (a < b)
    parent[std::size_t(b)] = a;
  else if (b < a)
    parent[std::size_t(a)] = b;
}

template <class D>
std::int32_t dynamic_place(const WorldImplementation<D>& world, std::int32_t body) {
  if (body == none || !world.bodies.is_dynamic(body)) return none;
  return world.bodies.record[std::size_t(body)].awake_index;
}

/// Joins what constraints of the graph join.
template <class D>
void unite_islands(const WorldImplementation<D>& world, std::vector<std::int32_t>& parent) {
  parent.resize(world.bodies.awake.size());
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = std::int32_t(i);
  const auto join = [&](std::int32_t a, std::int32_t b) {
    const std::int32_t pa = dynamic_place(world, a), pb = dynamic_place(world, b);
    if (pa != none && pb != none) unite(parent, pa, pb);
  };
  for (const GraphColor& color : world.graph.colors) {
    for (const std::int32_t m : color.manifolds) {
      const ContactRecord<D>& c = world.contacts.at(world.contacts.manifold(m).contact);
      if (c.flags & contact_touching) join(c.body[0], c.body[1]);
    }
    for (const std::int32_t j : color.joints) {
      const JointHeader& header = world.joints.headers[std::size_t(j)];
      join(header.body[0], header.body[1]);
    }
  }
}

/// Friction of the contact still takes back what slipped while it took up its load.
template <class D>
bool still_settles(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
  for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next)
    if (world.contacts.manifold(m).anchor == Anchor::settles) return true;
  return false;
}

/// The same for islands in which nothing is restless. In the end the roots of islands that may sleep are not restless.
template <class D>
void unite_tired(const WorldImplementation<D>& world, std::vector<std::int32_t>& parent,
                 std::vector<std::uint8_t>& restless) {
  parent.resize(world.bodies.awake.size());
  for (std::size_t i = 0; i < parent.size(); ++i) parent[i] = std::int32_t(i);
  const auto join = [&](std::int32_t place, std::int32_t other) {
    if (other == none) return;
    if (const std::int32_t there = dynamic_place(world, other); there != none) {
      if (restless[std::size_t(there)] != 0)
        restless[std::size_t(place)] = 1;
      else
        unite(parent, place, there);
      return;
    }
    const BodyRecord& record = world.bodies.record[std::size_t(other)];
    if (record.type == BodyType::kinematic && record.awake_index != none && record.sleep_timer == 0)
      restless[std::size_t(place)] = 1;
  };
  const std::vector<std::int32_t>& awake = world.contacts.awake;
  for (std::size_t i = 0; i < awake.size(); ++i) {
    if (i + 16 < awake.size()) __builtin_prefetch(&world.contacts.at(awake[i + 16]));
    const ContactRecord<D>& c = world.contacts.at(awake[i]);
    if ((c.flags & contact_touching) == 0 || c.first_manifold == none) continue;
    for (int side = 0; side < 2; ++side) {
      const std::int32_t body = c.body[side], place = dynamic_place(world, body);
      if (place == none || restless[std::size_t(place)] != 0) continue;
      if (world.bodies.record[std::size_t(body)].sleep_timer < world.definition.sleep_time + settling_time &&
          still_settles(world, c))
        restless[std::size_t(place)] = 1;
      else
        join(place, c.body[1 - side]);
    }
  }
  for (const GraphColor& color : world.graph.colors)
    for (const std::int32_t j : color.joints) {
      const JointHeader& header = world.joints.headers[std::size_t(j)];
      for (int side = 0; side < 2; ++side)
        if (const std::int32_t place = dynamic_place(world, header.body[side]);
            place != none && restless[std::size_t(place)] == 0)
          join(place, header.body[1 - side]);
    }
}

}  // namespace

template <class D>
void sleep_islands(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  if (!world.definition.allow_sleep || world.step_count % sleep_interval != 0) return;
  StepScratch<D>& scratch = world.scratch;
  const auto tired = [&](std::size_t place) {
    return world.bodies.record[std::size_t(world.bodies.awake[place])].sleep_timer >= world.definition.sleep_time;
  };
  const std::size_t count = world.bodies.awake.size();
  bool any = false;
  for (std::size_t i = 0; i < count && !any; ++i) any = tired(i);
  if (!any) return;

  std::vector<std::int32_t>& parent = scratch.island_parent;
  std::vector<std::uint8_t>& restless = scratch.island_restless;
  restless.assign(count, 0);
  for (std::size_t i = 0; i < count; ++i) restless[i] = tired(i) ? 0 : 1;
  unite_tired(world, parent, restless);
  for (std::size_t i = 0; i < count; ++i)
    if (restless[i] != 0) restless[std::size_t(find_root(parent, std::int32_t(i)))] = 1;
  scratch.island_list.clear();
  for (std::size_t i = 0; i < count; ++i)
    if (restless[std::size_t(find_root(parent, std::int32_t(i)))] == 0) scratch.island_list.push_back(std::int32_t(i));
  if (scratch.island_list.empty()) return;
  std::sort(scratch.island_list.begin(), scratch.island_list.end(), [&](std::int32_t a, std::int32_t b) {
    const std::int32_t ra = find_root(parent, a), rb = find_root(parent, b);
    return ra != rb ? ra < rb : a < b;
  });
  // Slots before anything moves in the list of awake bodies.
  scratch.island_bodies.clear();
  scratch.island_ends.clear();
  for (std::size_t i = 0; i < scratch.island_list.size(); ++i) {
    if (i > 0 && find_root(parent, scratch.island_list[i]) != find_root(parent, scratch.island_list[i - 1]))
      scratch.island_ends.push_back(std::int32_t(i));
    const std::int32_t body = world.bodies.awake[std::size_t(scratch.island_list[i])];
    scratch.island_bodies.push_back(body);
    scratch.fell_asleep.push_back({world.bodies.slots.handle_at(body)});
  }
  scratch.island_ends.push_back(std::int32_t(scratch.island_list.size()));
  std::int32_t begin = 0;
  for (const std::int32_t end : scratch.island_ends) {
    put_to_sleep<D>(world, std::span(scratch.island_bodies).subspan(std::size_t(begin), std::size_t(end - begin)));
    begin = end;
  }
}

template <class D>
int count_islands(const WorldImplementation<D>& world) {
  std::vector<std::int32_t> parent;
  unite_islands(world, parent);
  int count = world.sleeping.count();
  for (std::size_t i = 0; i < parent.size(); ++i)
    if (parent[i] == std::int32_t(i) && world.bodies.is_dynamic(world.bodies.awake[i])) ++count;
  return count;
}

template void sleep_islands<Dim2>(StepContext<Dim2>&);
template void sleep_islands<Dim3>(StepContext<Dim3>&);
template int count_islands<Dim2>(const WorldImplementation<Dim2>&);
template int count_islands<Dim3>(const WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
