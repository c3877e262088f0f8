// What the engine knows and a picture of bodies does not show, as lines over the scene.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "apps/host/declaration.h"
#include "carom/rigid/world.h"

namespace carom::host {

/// The layers that a page can ask for, each a bit.
struct DebugLayer {
  const char* name;
  std::uint32_t bit;
};
inline constexpr std::uint32_t layer_bounds = 1, layer_centers = 2, layer_contacts = 4, layer_joints = 8,
                               layer_islands = 16, layer_colors = 32, layer_velocities = 64, layer_forces = 128;
inline constexpr DebugLayer debug_layers[] = {
    {"bounds", layer_bounds},   {"centers", layer_centers}, {"contacts", layer_contacts},     {"joints", layer_joints},
    {"islands", layer_islands}, {"colors", layer_colors},   {"velocities", layer_velocities}, {"forces", layer_forces},
};

/// How long arrows are, for a scene of this size (m).
struct ArrowScale {
  double velocity = 0;  ///< m per m/s
  double force = 0;     ///< m per N
  double impulse = 0;   ///< m per N·s
};
template <class D>
ArrowScale arrow_scale(const rigid::World<D>& world, float dt, double size);

/// Adds the lines of these layers, as many as fit below `max_lines`. dt: s of the last step, for forces from impulses.
template <class D>
void debug_lines(const rigid::World<D>& world, std::uint32_t layers, float dt, double size, std::vector<Line>& out);

}  // namespace carom::host
