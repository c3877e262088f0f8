// What a soft body keeps, and the passes of its step.
#pragma once

#include "carom/particles/detail/soft_thing.h"
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

struct SoftState final : SoftThing {
  SoftMaterial material{};
  double pressure = 0;

  std::vector<Vec3f> load;
  std::vector<std::uint32_t> corners;
  std::vector<SoftElement> elements;
  std::vector<std::uint32_t> surface;
  std::vector<int> first, list;  ///< by vertex: 4·element + corner

  core::Status set_mesh();
  void find_surface();
  void strain();
  void assemble(float h, Vec3f gravity);
  void hold(float h);

  std::span<const std::uint32_t> faces() const override { return surface; }
  void begin_substep(float h, Vec3f gravity) override;
  void end_substep(float h) override;
};

}  // namespace carom::particles::detail
