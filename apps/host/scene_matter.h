// Pictures of what a scene has besides bodies: ropes as beads, cloth and soft bodies as surfaces, the rest as balls.
#pragma once

#include <vector>

#include "apps/host/stage.h"
#include "carom/scene/matter.h"

namespace carom::host {

class MatterPicture {
 public:
  /// Surfaces for what has one; once, when the scene is built.
  void begin(StageBase& stage, const scene::Matter& matter);
  /// Draws all of it as it is now.
  template <class D>
  void draw(StageBase& stage, const scene::Matter& matter);

 private:
  template <class D>
  void add_balls(const scene::MatterOf<D>& many);
  void add_ropes(const scene::Matter& matter);
  void set_surfaces(StageBase& stage, const scene::Matter& matter);

  float least_ = 0;  ///< m: what is smaller is drawn so large, to be seen
  std::vector<int> cloths_, soft_bodies_;
  std::vector<math::Vec3f> places_, corners_, found_;
  std::vector<float> radii_, found_radii_;
  std::vector<std::uint32_t> colors_, found_colors_;
};

}  // namespace carom::host
