// What particles bounce off: shapes that stand or move, of a world (coupling.h) or of the caller.
#pragma once

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/geometry/shape3.h"
#include "carom/math/mat.h"
#include "carom/math/transform.h"

namespace carom::particles {

enum class CollisionAnswer {
  bounce,
  stick,  ///< stays where it met it for good; on what moves: loses its velocity against it
  kill,   ///< its time is over
};

/// Spheres, capsules, boxes, cylinders, hulls, planes and height fields are met by lanes of particles; other shapes by
/// one cast a particle near them, which costs a hundred times as much. Particles touch a hull's corners as if its
/// faces, moved outward by the radius, met there. Their way is a straight line within a step; the moment of impact
/// is that of the parabola.
struct Collider {
  geometry::Shape3 shape{};
  math::Pose3 pose{};              ///< at the end of the step
  math::Vec3f velocity{};          ///< m/s, of the centre of mass
  math::Vec3f angular_velocity{};  ///< rad/s
  math::Vec3d center_of_mass{};    ///< m, world
  float restitution = 0.5f;        ///< 0 … 1, of the pair
  float friction = 0.3f;           ///< ≥ 0, of the pair
  CollisionAnswer answer = CollisionAnswer::bounce;
  /// Collects what the particles give it (ParticleSystem::exchanges). With an inverse mass impacts are those of two
  /// bodies of finite mass.
  bool two_way = false;
  float inverse_mass = 0;                             ///< 1/kg
  math::Mat3f inverse_inertia = math::Mat3f::zero();  ///< 1/(kg·m²), world axes
};

CAROM_API core::Status check(const Collider& collider);

/// What particles gave a collider in the last step.
struct Exchange {
  math::Vec3d impulse{};          ///< N·s
  math::Vec3d angular_impulse{};  ///< N·m·s, about the centre of mass
  int touching = 0;               ///< contacts that gave it
};

}  // namespace carom::particles
