// Bodies that come fast: which of their shapes may be met within a step.
#pragma once

#include <vector>

#include "carom/geometry/bounds.h"
#include "carom/rigid/world.h"

namespace carom::particles::detail {

/// m/s: up to there what comes is looked for without a look at its speed.
inline constexpr double usual_body = 20;

/// A shape of a body that comes fast, and the room that it goes through in the step.
struct FastShape {
  rigid::ShapeId id{};
  geometry::Bounds3d way{};
};

/// The room that something within `tight` (the body's frame) goes through in a step of dt, falling by `slack` besides.
geometry::Bounds3d way_of(const rigid::BodyState<rigid::Dim3>& state, const geometry::Bounds3f& tight, double dt,
                          double slack);
/// Of what is faster than what is looked for anyway, where it goes. The first two lists are scratch.
void find_fast_shapes(const rigid::World3& world, double dt, std::vector<rigid::BodyId>& bodies,
                      std::vector<rigid::ShapeId>& of_body, std::vector<FastShape>& found);

}  // namespace carom::particles::detail
