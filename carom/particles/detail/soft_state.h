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
  bool crushed = false;  ///< its height is held
  float thick = 0;       ///< at most its least height, as a share of that at rest
  Mat3f turn{};          ///< of this substep; kept as the next one's first guess
  Vec3f force[4] = {};   ///< N on the corners
};

/// An element crushed to its limit: the height of a corner above the opposite face is held from below, as a contact is.
/// An elastic law, however stiff, would give way to a heavy load and let the element turn inside out.
struct SoftCrush {
  Vec3f normal{};        ///< from the face to the corner
  float weight[4] = {};  ///< of the corners' velocities along it in the height's rate; their sum is 0
  float gap = 0;         ///< m, above the limit
  float stiff = 0;       ///< kg: impulse for what the rate lacks
  float wanted = 0;      ///< m/s, where it is held
  float before = 0;      ///< m/s, the rate before the solve

  /// Its part of the block of two corners, times `sign`.
  void add_block(int a, int b, float sign, SoftBlock& block) const {
    const Vec3f along = (sign * stiff * weight[a]) * normal, way = weight[b] * normal;
    block.add(way.x * along, way.y * along, way.z * along);
  }
};

struct SoftState final : SoftThing {
  SoftMaterial material{};
  double pressure = 0;

  std::vector<Vec3f> load;
  std::vector<std::uint32_t> corners;
  std::vector<SoftElement> elements;
  std::vector<SoftCrush> crushes;  ///< by element
  float steepest = 0;  ///< 1/m: the greatest rate of an element's deformation for velocities that differ by 1 m/s
  float slimmest = 0;  ///< the least `thick`
  float way = 0;       ///< of this substep: the rate times it, at most, before the solve
  std::vector<std::uint32_t> surface;
  std::vector<int> behind;       ///< by face of the surface: its element
  std::vector<int> first, list;  ///< by vertex: 4·element + corner

  core::Status set_mesh();
  void find_surface();
  void strain(float h);
  Mat3f deformation(std::size_t element) const;
  Mat3f rate(std::size_t element, const SoftVector* change) const;  ///< `change`: of the velocities, or null
  void find_crush(std::size_t element, const Mat3f& f, float h);
  void foresee_crush(std::size_t element, const Mat3f& f, float h, const SoftVector* change);
  float greatest_way(float h, const SoftVector* change) const;
  void enter_crush(std::size_t element, float sign);
  double elastic_energy() const;
  void assemble(float h, Vec3f gravity);

  std::span<const std::uint32_t> faces() const override { return surface; }
  void begin_substep(float h, Vec3f gravity) override;
  bool revise(float h) override;
  void end_substep(float h) override;
};

}  // namespace carom::particles::detail
