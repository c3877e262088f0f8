// The sea round a place at one moment, for many points at once: what clips a hull of a thousand triangles.
#pragma once

#include <span>
#include <vector>

#include "carom/environment/sea.h"

namespace carom::environment {

/// Heights by lanes of floats, relative to an origin near the points. The phases of the waves at the origin are taken
/// in double, so that it is as good far from the world's origin and late as near and early: within 1e-6 H_s + 4e-7 k r
/// a of `Sea::height` at a distance r. The same bits for any number of lanes.
class CAROM_API SeaPatch {
 public:
  /// `origin`: (x, z) that points are relative to. `lanes` 4, 8, 16, or 0: what the machine has.
  SeaPatch(const Sea& sea, math::Vec2d origin, double time, int lanes = 0) { set(sea, origin, time, lanes); }
  SeaPatch() = default;  ///< still water
  /// Another moment or place; allocates only where the sea has more waves than ever before.
  void set(const Sea& sea, math::Vec2d origin, double time, int lanes = 0);

  /// y of the surface less the still level (m), at points (m from the origin). All spans as long as `out`.
  void heights(std::span<const float> x, std::span<const float> z, std::span<float> out) const;
  /// Also the slopes ∂η/∂x and ∂η/∂z.
  void heights(std::span<const float> x, std::span<const float> z, std::span<float> out, std::span<float> slope_x,
               std::span<float> slope_z) const;
  int lanes() const { return lanes_; }
  const std::vector<float>& memory() const { return waves_; }  ///< for whoever counts it
  std::vector<float>& memory() { return waves_; }

 private:
  void run(std::span<const float> x, std::span<const float> z, float* out, float* slope_x, float* slope_z) const;
  std::vector<float> waves_;  ///< four arrays one after another
  int lanes_ = 4;
};

}  // namespace carom::environment
