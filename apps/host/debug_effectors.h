// The forces of a world apart by the kind of effector that they come from.
#pragma once

#include <memory>
#include <vector>

#include "apps/host/debug_draw.h"
#include "carom/rigid/world.h"

namespace carom::host {

/// Arrows from the centres of mass: what each kind of effector does to a body in the next step. Found by steps of a
/// copy of the world, without contacts and joints, with and without that kind; models of the caller
/// (CustomEffector) stay out, because they may remember being asked.
template <class D>
class EffectorForces {
 public:
  [[gnu::noinline]] void lines(const rigid::World<D>& world, float dt, double size, std::vector<Line>& out);
  /// Of the kinds that the last call found.
  const std::vector<LegendEntry>& legend() const { return legend_; }

  /// Worlds with more bodies are not copied.
  static constexpr int most_bodies = 1500;

 private:
  std::unique_ptr<rigid::World<D>> copy_;
  rigid::Snapshot<D> now_;
  std::vector<LegendEntry> legend_;
};

}  // namespace carom::host
