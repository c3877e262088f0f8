// What the engine knows and a picture of bodies does not show, as lines over the scene.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "apps/host/declaration.h"
#include "carom/rigid/world.h"

namespace carom::host {

/// The layers that a page can ask for, each a bit.
struct DebugLayer {
  const char* name;
  std::uint32_t bit;
  const char *label, *legend;  ///< for people
};
inline constexpr std::uint32_t layer_bounds = 1, layer_centers = 2, layer_contacts = 4, layer_joints = 8,
                               layer_islands = 16, layer_colors = 32, layer_velocities = 64, layer_forces = 128,
                               layer_effectors = 256, layer_water = 512, layer_errors = 1024;
inline constexpr DebugLayer debug_layers[] = {
    {"bounds", layer_bounds, "Bounds", ""},
    {"centers", layer_centers, "Centres of mass", ""},
    {"contacts", layer_contacts, "Contact impulses", "normal impulses red, friction yellow"},
    {"joints", layer_joints, "Joints and limits", "limits as arcs, cones and bars; where it stands now red"},
    {"errors", layer_errors, "Constraint error",
     "holds: small and green; apart or too deep by 1/1000 of the view: large and red"},
    {"islands", layer_islands, "Islands and sleep", "one colour an island, asleep grey"},
    {"colors", layer_colors, "Graph colours", "arrows in the colour in which the solver takes them"},
    {"velocities", layer_velocities, "Velocities", "velocity green, spin violet"},
    {"forces", layer_forces, "Forces", "weight blue, contacts red, friction yellow, joints violet"},
    {"effectors", layer_effectors, "Forces by effector", ""},
    {"water", layer_water, "Under water", "wet edges blue, waterline light, buoyancy from its centre"},
};

/// What a colour stands for, where that depends on the scene.
struct LegendEntry {
  std::string label;
  std::uint32_t color = 0;  ///< 0xRRGGBB
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
[[gnu::noinline]] void debug_lines(const rigid::World<D>& world, std::uint32_t layers, float dt, double size,
                                   std::vector<Line>& out);

}  // namespace carom::host
