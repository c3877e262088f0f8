// How a figure keeps its balance on both feet.
#pragma once

#include "apps/host/demos/figures/figure.h"

namespace carom::host::demo {

/// Where a figure would tip over from: its capture point (Hof, "The condition for dynamic stability", 2005) against the
/// middle between its feet.
struct Balance {
  double forward = 0, aside = 0;  ///< m, of the capture point; to its right positive

  /// Looks at a figure whose mechanism was read.
  void look(Stage3& stage, const Figure& figure);
  /// Turns of ankles and hips, added to a pose, that press the feet where the capture point is. gain: rad/m.
  void correct(Pose& pose, double gain) const;
};

}  // namespace carom::host::demo
