// What the wave of a charge gives to what is not rigid: ropes, cloth, soft bodies, liquids, grains (chapter 18.6).
//
// The loads are those of loading.h, as bodies feel them: a cloth feels the difference between its two sides, a soft
// body every face of its surface, a rope the wind across its diameter, liquids and grains a front over what of them the
// charge sees. What is light goes along with the air and takes less than a wall would, never more than makes it as fast
// as the wind. Bodies of the world shelter them; they shelter nothing.
#pragma once

#include "carom/blast/explosion.h"
#include "carom/particles/cloth.h"
#include "carom/particles/fluid.h"
#include "carom/particles/granular.h"
#include "carom/particles/rope.h"
#include "carom/particles/soft_body.h"

namespace carom::blast {

/// Before each step of `dt` s of the thing: what the wave gives it until then (N·s, all of it). Where it is held by a
/// body, the body takes what falls on that point; where by the world, the world does. Errors: dt not > 0; those of the
/// world.
CAROM_API core::Result<math::Vec3d> push(const Explosion3& explosion, rigid::World3& world, double dt,
                                         particles::Cloth& cloth);
CAROM_API core::Result<math::Vec3d> push(const Explosion3& explosion, rigid::World3& world, double dt,
                                         particles::SoftBody& body);
CAROM_API core::Result<math::Vec3d> push(const Explosion3& explosion, rigid::World3& world, double dt,
                                         particles::RopeSet& ropes);
/// Sides and bottom of their domain that are walls shelter what is behind them; a lid lets the wave in.
template <class D>
CAROM_API core::Result<typename D::Position> push(const Explosion<D>& explosion, const rigid::World<D>& world,
                                                  double dt, particles::Fluid<D>& liquid);
template <class D>
CAROM_API core::Result<typename D::Position> push(const Explosion<D>& explosion, const rigid::World<D>& world,
                                                  double dt, particles::Granular<D>& grains);

}  // namespace carom::blast
