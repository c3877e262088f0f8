// What lies under water of the bodies that float, as buoyancy sees it.
#pragma once

#include "apps/host/declaration.h"
#include "carom/rigid/world.h"

namespace carom::host {

/// Wet edges, the waterline, and the lift at its centre, of every body that a Buoyancy effector acts on.
template <class D>
void water_lines(const rigid::World<D>& world, double size, std::vector<Line>& out);

}  // namespace carom::host
