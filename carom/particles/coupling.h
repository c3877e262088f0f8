// Particles in a world of bodies: its shapes become colliders, and what particles give them goes back as impulses.
#pragma once

#include <vector>

#include "carom/particles/system.h"
#include "carom/rigid/world.h"

namespace carom::particles {

struct CouplingDef {
  float restitution = 0.3f;  ///< of the particles; the pair has the greater of both (rigid::Material)
  float friction = 0.5f;     ///< of the particles; the pair has the geometric mean
  CollisionAnswer answer = CollisionAnswer::bounce;
  bool two_way = false;         ///< dynamic bodies feel the particles
  rigid::QueryFilter filter{};  ///< which shapes
  float margin = 0.5f;          ///< m round all particles within which shapes are looked for
};

/// Joins a system to a world of the plane or of space; a planar system to one of the plane. In the plane, circles,
/// capsules, polygons and segments become prisms across it. Chains and meshes are cast one by one. Sensors are passed
/// through; of a shape with several materials the first counts, belts stand still. Call `step` after the world's own:
/// bodies are where they ended and came from where their velocities say. Not two-way: the world is only read.
template <class D>
class CAROM_API Coupling {
 public:
  explicit Coupling(const CouplingDef& definition = {}) : definition_(definition) {}
  static core::Status check(const CouplingDef& definition);
  CouplingDef& definition() { return definition_; }

  /// The shapes near the particles as colliders, after `own` (which may be empty).
  core::Status gather(const rigid::World<D>& world, ParticleSystem& system, std::span<const Collider> own = {});
  /// The exchanges of the system's last step as impulses on the bodies.
  core::Status give_back(rigid::World<D>& world, const ParticleSystem& system) const;
  /// gather, system.step, give_back.
  core::Status step(rigid::World<D>& world, ParticleSystem& system, double dt, std::span<const Collider> own = {},
                    core::TaskScheduler* scheduler = nullptr);
  /// The body behind a collider of the last `gather`; null: one of the caller's own.
  rigid::BodyId body_of(int collider) const;

 private:
  CouplingDef definition_;
  struct Form {
    rigid::ShapeId shape{};
    geometry::Shape3 form{};
    math::Pose3 local{};
  };
  core::Status add_body(const rigid::World<D>& world, rigid::ShapeId shape);
  const Form& form_of(rigid::ShapeId shape, const typename D::Shape& geometry);

  std::size_t own_ = 0, cursor_ = 0;
  std::vector<Form> forms_;  ///< shapes of the plane as shapes of space, in the order in which they were last found
  std::vector<Collider> colliders_;
  std::vector<rigid::BodyId> bodies_;
  std::vector<rigid::ShapeId> found_;
};

extern template class CAROM_API Coupling<rigid::Dim2>;
extern template class CAROM_API Coupling<rigid::Dim3>;
using Coupling2 = Coupling<rigid::Dim2>;
using Coupling3 = Coupling<rigid::Dim3>;

}  // namespace carom::particles
