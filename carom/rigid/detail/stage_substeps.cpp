// Islands with substeps of their own: the solver runs once for each number of substeps that somebody asks for, and sees
// in each run only the bodies and constraints that have it. Islands share no constraint and no moving body, so that
// none of them notices the others; a kinematic body moves in every run, from its start.
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

template <class D>
class Groups {
 public:
  explicit Groups(WorldImplementation<D>& world) : world_(world), scratch_(world.scratch) {}

  /// The most that anybody of an island asks for, by place in the list of awake bodies.
  void find() {
    std::vector<std::int32_t>& parent = scratch_.island_parent;
    std::vector<std::uint8_t>& substeps = scratch_.island_substeps;
    const std::vector<std::int32_t>& awake = world_.bodies.awake;
    parent.resize(awake.size());
    substeps.resize(awake.size());
    for (std::size_t i = 0; i < awake.size(); ++i) {
      parent[i] = std::int32_t(i);
      const BodyRecord& record = world_.bodies.record[std::size_t(awake[i])];
      substeps[i] = std::uint8_t(max(int(record.substeps), world_.definition.substeps));
      if (record.type == BodyType::kinematic) substeps[i] = 0;
    }
    for (const GraphColor& color : world_.graph.colors) {
      for (const std::int32_t m : color.manifolds) unite(bodies_of_manifold(m));
      for (const std::int32_t j : color.joints) unite(world_.joints.headers[std::size_t(j)].body);
    }
    for (std::size_t i = 0; i < awake.size(); ++i) {
      std::uint8_t& of_root = substeps[std::size_t(root(std::int32_t(i)))];
      of_root = max(of_root, substeps[i]);
    }
    for (std::size_t i = 0; i < awake.size(); ++i)
      if (substeps[i] != 0) substeps[i] = substeps[std::size_t(root(std::int32_t(i)))];
  }
  /// The next larger number of substeps that an island has, or 0.
  int next_after(int substeps) const {
    int next = 0;
    for (const std::uint8_t n : scratch_.island_substeps)
      if (n > substeps && (next == 0 || n < next)) next = n;
    return next;
  }

  void put_away() {
    scratch_.whole_awake.swap(world_.bodies.awake);
    scratch_.whole_trees.swap(world_.joints.trees.trees);
    for (std::size_t c = 0; c <= color_count; ++c) {
      scratch_.whole_colors[c].manifolds.swap(world_.graph.colors[c].manifolds);
      scratch_.whole_colors[c].joints.swap(world_.graph.colors[c].joints);
    }
  }
  void show(int substeps) {
    std::vector<std::int32_t>& awake = world_.bodies.awake;
    awake.clear();
    for (std::size_t i = 0; i < scratch_.whole_awake.size(); ++i) {
      const std::uint8_t own = scratch_.island_substeps[i];
      const std::int32_t body = scratch_.whole_awake[i];
      if (own == 0 || own == substeps) awake.push_back(body);
      if (own != 0) continue;
      SolverBody<D>& kinematic = world_.bodies.solver[std::size_t(body)];
      kinematic.delta_position = {};
      kinematic.delta_rotation = {};
    }
    world_.joints.trees.trees.clear();
    for (const TreeRange& tree : scratch_.whole_trees)
      if (has(world_.joints.trees.bodies[std::size_t(tree.first_body)].body, substeps))
        world_.joints.trees.trees.push_back(tree);
    for (std::size_t c = 0; c <= color_count; ++c) {
      GraphColor& color = world_.graph.colors[c];
      color.manifolds.clear();
      color.joints.clear();
      for (const std::int32_t m : scratch_.whole_colors[c].manifolds)
        if (has(bodies_of_manifold(m), substeps)) {
          world_.contacts.manifold(m).place.position = std::int32_t(color.manifolds.size());
          color.manifolds.push_back(m);
        }
      for (const std::int32_t j : scratch_.whole_colors[c].joints)
        if (has(world_.joints.headers[std::size_t(j)].body, substeps)) color.joints.push_back(j);
    }
  }
  void bring_back() {
    put_away();  // swaps again
    for (const GraphColor& color : world_.graph.colors)
      for (std::size_t i = 0; i < color.manifolds.size(); ++i)
        world_.contacts.manifold(color.manifolds[i]).place.position = std::int32_t(i);
  }

 private:
  const std::int32_t (&bodies_of_manifold(std::int32_t manifold) const)[2] {
    return world_.contacts.at(world_.contacts.manifold(manifold).contact).body;
  }
  std::int32_t place_of(std::int32_t body) const {
    if (body == none || !world_.bodies.is_dynamic(body)) return none;
    return world_.bodies.record[std::size_t(body)].awake_index;
  }
  bool has(std::int32_t body, int substeps) const {
    const std::int32_t place = place_of(body);
    return place != none && scratch_.island_substeps[std::size_t(place)] == substeps;
  }
  bool has(const std::int32_t (&body)[2], int substeps) const {
    return has(body[0], substeps) || has(body[1], substeps);
  }
  std::int32_t root(std::int32_t i) {
    std::vector<std::int32_t>& parent = scratch_.island_parent;
    while (parent[std::size_t(i)] != i) {
      parent[std::size_t(i)] = parent[std::size_t(parent[std::size_t(i)])];
      i = parent[std::size_t(i)];
    }
    return i;
  }
  void unite(const std::int32_t (&body)[2]) {
    std::int32_t a = place_of(body[0]), b = place_of(body[1]);
    if (a == none || b == none) return;
    a = root(a), b = root(b);
    if (a != b) scratch_.island_parent[std::size_t(max(a, b))] = min(a, b);
  }

  WorldImplementation<D>& world_;
  StepScratch<D>& scratch_;
};

}  // namespace

template <class D>
void for_each_substep_group(WorldImplementation<D>& world, core::FunctionRef<void(int substeps)> solve) {
  Groups<D> groups(world);
  if (world.bodies.substep_wishes > 0) groups.find();
  const int first = world.bodies.substep_wishes > 0 ? groups.next_after(0) : 0;
  if (first == 0) return solve(world.definition.substeps);
  if (groups.next_after(first) == 0) return solve(first);
  build_trees(world);
  groups.put_away();
  for (int substeps = first; substeps != 0; substeps = groups.next_after(substeps)) {
    groups.show(substeps);
    solve(substeps);
  }
  groups.bring_back();
}

template void for_each_substep_group(WorldImplementation<Dim2>&, core::FunctionRef<void(int)>);
template void for_each_substep_group(WorldImplementation<Dim3>&, core::FunctionRef<void(int)>);

}  // namespace carom::rigid::detail
