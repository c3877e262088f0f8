// What a soft body keeps, and the passes of its step.
#pragma once

#include "carom/particles/detail/soft_touch.h"
#include "carom/particles/soft_body.h"

namespace carom::particles::detail {

struct SoftElement {
  float volume = 0;        ///< m³, at rest
  Vec3f gradient[4] = {};  ///< of the corners' shares, 1/m
  Vec3f rest[4] = {};      ///< m, about the first corner
  int slots[16] = {};
  Mat3f turn{};         ///< of this substep; kept as the next one's first guess
  Vec3f force[4] = {};  ///< N on the corners
};

struct SoftState {
  SoftMaterial material{};
  bool collide = true;
  rigid::Filter filter{};
  core::TaskScheduler* scheduler = nullptr;
  int substeps = 2, iterations = 0;
  double pressure = 0;

  std::vector<math::Vec3d> position;
  std::vector<Vec3f> velocity, load;
  std::vector<float> mass;
  std::vector<std::uint32_t> corners;
  std::vector<SoftElement> elements;
  std::vector<std::uint32_t> surface;
  std::vector<std::uint8_t> outside;  ///< by vertex: on the surface
  std::vector<SoftPin> pins;
  std::vector<int> pinned, pin_of;
  std::vector<SoftTouch> touches;
  SoftMatrix matrix;
  std::vector<int> first, list;  ///< by vertex: 4·element + corner
  SoftSolver solver;
  SoftObstacles obstacles;

  core::Status set_mesh();
  void find_surface();
  void step(rigid::World3& world, double dt);
  void strain();
  void assemble(float h, Vec3f gravity);
  void hold(float h);
  SoftTouching touching() { return {touches, pins, pinned, position, velocity, mass}; }
};

}  // namespace carom::particles::detail
