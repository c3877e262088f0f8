// Cloths and soft bodies that meet one another: stepped together they are kept apart, with friction.
//
// Vertices of one before the faces of another are held off them within the implicit step: the linear systems of all
// that are near one another are solved as one, to which each contact adds a term that hardly gives way along its normal
// and, by the push of the substep before, Coulomb's friction across it. What a contact gives to one it takes from the
// other: the momentum of all together stays.
#pragma once

#include <memory>
#include <span>

#include "carom/particles/cloth.h"
#include "carom/particles/soft_body.h"

namespace carom::particles {

namespace detail {
struct SoftGroupState;
}

/// Two things that touched in the last step. Numbers count the cloths first, then the soft bodies.
struct SoftContact {
  int thing = 0, other = 0;  ///< a vertex of the first before a face of the other
  int vertex = 0;
  int corner[3] = {0, 0, 0};
  double share[3] = {0, 0, 0};  ///< of the corners, below the vertex
  math::Vec3d normal{};         ///< from the face to the vertex
  double distance = 0;          ///< m between them at the beginning of the last substep; negative: within
  math::Vec3d force{};          ///< N on the vertex, in the last substep
};

/// Whose `filter`s let them meet, do, further apart than the larger of their skins and thicknesses. Of those near one
/// another the largest count of substeps holds for all, and as many more (16 at most) as it takes that none passes
/// another by more than half an edge in one; what is near nothing takes its own step. Holds the memory of a step alone:
/// what is remembered lies in the things, by their numbers, so that copies of these are snapshots. Soft bodies that
/// overlap at the start by less than a cell are drawn apart.
class CAROM_API SoftGroup {
 public:
  SoftGroup();
  ~SoftGroup();
  SoftGroup(const SoftGroup&);
  SoftGroup& operator=(const SoftGroup&);
  SoftGroup(SoftGroup&&) noexcept;
  SoftGroup& operator=(SoftGroup&&) noexcept;

  /// In place of the `step` of each; call it before World3::step with the same dt. Errors, with nothing moved: a thing
  /// that is null or was moved away, the same thing twice, one with a place or velocity that is not finite.
  core::Status step(std::span<Cloth* const> cloths, std::span<SoftBody* const> bodies, rigid::World3& world, double dt);

  std::span<const SoftContact> contacts() const;  ///< of the last substep

 private:
  std::unique_ptr<detail::SoftGroupState> state_;
};

}  // namespace carom::particles
