// Bytes that a world holds.
#pragma once

#include "carom/rigid/detail/state_visitor.h"

namespace carom::rigid::detail {

struct ByteCounter {
  std::size_t bytes = 0;

  template <class T>
  void state(const T&) {}  // numbers stand in the world itself
  template <class T>
  void state(const std::vector<T>& v) {
    bytes += v.capacity() * sizeof(T);
  }
  template <class T>
  void state(const core::Column<T>& v) {
    bytes += v.capacity() * sizeof(T);
  }
  template <class S, class P, class M>
  void bodies(const core::Column<S>& solver, const core::Column<P>& pose, const core::Column<M>& motion,
              const core::Column<BodyRecord>& record) {
    state(solver), state(pose), state(motion), state(record);
  }
  void begins(StatePart) {}
  template <class T>
  void manifolds(const core::Column<T>& v) {
    state(v);
  }
  template <class T>
  void scratch(const std::vector<T>& v) {
    state(v);
  }
  template <class T>
  void scratch(const core::Column<T>& v) {
    state(v);
  }
  template <class T>
  void events(const std::vector<T>& v) {
    state(v);
  }
  template <class T>
  void definition(const T&) {}
  template <class T>
  void shapes(const std::vector<T>& v) {
    state(v);
  }
  void names(const std::vector<std::string>& v) { state(v); }
  template <class T>
  void effectors(const std::vector<T>& v) {
    state(v);
  }
};

/// Everything but the shared data of hulls, meshes and height fields.
template <class D>
std::size_t bytes_of_world(const WorldImplementation<D>& world) {
  ByteCounter counter{sizeof(world)};
  visit_world(world, counter);
  counter.bytes += world.shapes.terms.bytes_of_links();
  for (const auto& tree : world.shapes.trees) counter.bytes += tree.scratch_bytes();
  return counter.bytes + world.query_trees.bytes() + world.arena.capacity();
}

}  // namespace carom::rigid::detail
