// Projectiles of a batch meet the bodies of a world: what they hit on their way through a step, what of them goes
// through or skips off, and the push they give (chapters 2.6, 18.5).
//
// A step is swept as a segment from where each projectile was to where it is, and bodies move through it meanwhile from
// where the world's last step found them to where they are, so that no speed of either carries one through the other
// unseen. Step the world, then the batch by the same time, then ask. After a step of another length than the world's
// last one bodies stand where they are.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/ballistics/batch.h"
#include "carom/ballistics/penetration.h"
#include "carom/rigid/world.h"

namespace carom::ballistics {

/// A meeting of a projectile and a body.
struct BatchHit {
  std::size_t projectile = 0;  ///< its index when it hit; those that stopped are removed afterwards
  std::uint64_t tag = 0;       ///< BatchRound::tag
  int order = 0;               ///< how many surfaces it met before in this step
  rigid::BodyId body{};
  rigid::ShapeId shape{};
  std::uint32_t material = 0;  ///< Material::user_id of the part
  double time = 0;             ///< s since the step began
  math::Vec3d point{};         ///< m, where it met the surface
  math::Vec3d normal{};        ///< outward, a unit vector; against the path where it began inside
  math::Vec3d velocity{};      ///< m/s, when it met
  LayerOutcome outcome = LayerOutcome::stopped;
  math::Vec3d exit{};           ///< m, where it came out; the point itself where it skipped off
  math::Vec3d exit_velocity{};  ///< m/s; of the body's surface there where it stopped
  double depth = 0;             ///< m of path within
  math::Vec3d impulse{};        ///< N·s, what the body took
  double energy = 0;            ///< J, turned into heat and damage: what the two lost together
};

struct HitOptions {
  rigid::QueryFilter filter{};
  bool push = true;           ///< bodies take the impulses
  bool keep_stopped = false;  ///< projectiles that stopped stay in the batch, with the velocity of what they hit
  int most_hits = 8;          ///< of one projectile in a step; then it flies on from the last
};

/// In the plane the batch flies in x and y; z is left out.
template <class D>
class CAROM_API BatchHits {
 public:
  /// What shapes with this Material::user_id are for projectiles: layers behind the surface, front to back. The last
  /// one may have the thickness `through`: then it is as thick as the convex shape is along the path (any other shape:
  /// without end). Errors: no layer, or one that cannot be, named.
  core::Status set_material(std::uint32_t user_id, std::span<const Layer> layers);
  /// Of shapes whose material is not set; at first it stops everything.
  core::Status set_default(std::span<const Layer> layers);
  static constexpr double through = 1e300;

  /// Everything that happened on the way of the last step of `dt` s. Later hits of a step meet bodies as the earlier
  /// ones left them. The world's threads cast; the results do not depend on them. Errors: dt not > 0, a position that
  /// is not finite.
  core::Status collect(ProjectileBatch& batch, rigid::World<D>& world, double dt, const HitOptions& options = {});
  /// By time, then by projectile.
  std::span<const BatchHit> hits() const { return hits_; }
  std::size_t rays() const { return cast_; }  ///< how many segments the world was asked about

 private:
  struct Wall {
    std::uint32_t user_id = 0;
    std::vector<Layer> layers;
  };
  struct Way {
    std::size_t projectile = 0;
    double time = 0;      // s, when the segment begins
    math::Vec3d from{};   // m
    math::Vec3d along{};  // m
    math::Vec3d velocity{};
  };
  struct Met {
    Way way;
    rigid::RayHit<D> found;
    double time = 0;  // s, since the step began
  };
  core::Status cast_batch(const ProjectileBatch& batch, const rigid::World<D>& world, double dt,
                          const HitOptions& options);
  core::Status cast_rest(const rigid::World<D>& world, double dt, const HitOptions& options);
  void strike(ProjectileBatch& batch, rigid::World<D>& world, double dt, const HitOptions& options, const Met& met,
              int order);

  std::vector<Wall> walls_;  // sorted by user_id
  std::vector<Layer> default_;
  std::vector<BatchHit> hits_;
  std::vector<Way> ways_;
  std::vector<Met> met_;
  rigid::StepWays<D> steps_;  // of bodies, in the world's last step
  std::vector<rigid::RayQuery<D>> queries_;
  std::vector<float> begins_;  // of queries, parts of the step
  std::vector<rigid::RayHit<D>> found_;
  std::vector<std::size_t> stopped_;
  std::size_t cast_ = 0;
};

extern template class CAROM_API BatchHits<rigid::Dim2>;
extern template class CAROM_API BatchHits<rigid::Dim3>;

}  // namespace carom::ballistics
