// Every number of a ball once: its name and unit in files, and what it may be.
#pragma once

#include "carom/sports/ball.h"

namespace carom::sports::detail {

template <class BallType, class Visitor>
void visit_fields(BallType& b, Visitor&& field) {
  field("mass", "kg", b.mass, 1e-6, 1e6);
  field("radius", "m", b.radius, 1e-5, 1e3);
  field("inertia_factor", "", b.inertia_factor, 1e-3, 2.0 / 3 + 1e-9);
  field("drag", "", b.drag.fast, 0.0, 1e4);
  field("drag_crisis", "", b.drag.crisis, 0.0, 1e4);
  field("critical_reynolds", "", b.drag.critical_reynolds, 1.0, 1e9);
  field("crisis_steepness", "", b.drag.steepness, 0.0, 100.0);
  field("drag_spin_rise", "", b.drag.spin_rise, 0.0, 10.0);
  field("drag_spin_scale", "", b.drag.spin_scale, 1e-3, 100.0);
  field("drag_spin_slope", "", b.drag.spin_slope, 0.0, 10.0);
  field("lift", "", b.lift.maximum, -10.0, 10.0);
  field("lift_spin_scale", "", b.lift.spin_scale, 1e-3, 100.0);
  field("lift_fade", "", b.lift.fade, 0.0, 1.0);
  field("spin_damping", "", b.spin_damping, 0.0, 10.0);
  field("side_force", "", b.side.coefficient, -10.0, 10.0);
  field("seam_best_angle", "rad", b.side.best_angle, 1e-3, 1.6);
  field("seam_reverse_reynolds", "", b.side.reverse_reynolds, 0.0, 1e9);
  field("seam_cycles", "", b.side.cycles, 0.0, 1000.0);
  field("wake_strouhal", "", b.side.strouhal, 0.0, 100.0);
}

}  // namespace carom::sports::detail
