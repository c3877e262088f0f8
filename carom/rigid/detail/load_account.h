// Which loads are real (load.h). What presses a body together is a load only as far as what lies above it accounts for
// it. What is squeezed between walls that no force moves presses by its overlap, and the harder the more it counts for:
// it may not count for more. And the impulses of what counted for much and is itself again at once would throw it: they
// shrink as its mass does.
#pragma once

#include <vector>

#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

/// The bodies are their own selves again before anything else moves them. Empties the list.
template <class D>
void drop_loads(WorldImplementation<D>& world, std::vector<std::int32_t>& bodies);

/// A body that is struck or kicked, or starts to slide, is to be its own self before momentum is exchanged.
template <class D>
void forget_load(const WorldImplementation<D>& world, std::int32_t body, const typename D::Vector& change_of_velocity,
                 std::vector<std::int32_t>& dropped) {
  if (world.bodies.motion[std::size_t(body)].load_level == 0) return;
  const float at_rest = rest_speed(world.definition, world.last_dt);
  if (math::length_squared(change_of_velocity) > at_rest * at_rest) dropped.push_back(body);
}
/// At once.
template <class D>
void forget_load(WorldImplementation<D>& world, std::int32_t body, const typename D::Vector& change_of_velocity) {
  forget_load(world, body, change_of_velocity, world.scratch.dropped);
  drop_loads(world, world.scratch.dropped);
}

}  // namespace carom::rigid::detail
