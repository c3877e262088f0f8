// What a user does to a scene beside pulling at it: throws bodies into it, and asks what lies where.
#pragma once

#include "apps/host/simulation.h"
#include "apps/host/stage.h"

namespace carom::host {

inline constexpr std::size_t max_spawned_into = 20'000;  ///< bodies of a scene; beyond it nothing is thrown in

template <class D>
core::Status spawn_body(Stage<D>& stage, const SpawnRequest& request);
template <class D>
core::Result<ProbeAnswer> probe_world(const Stage<D>& stage, ProbeKind kind, math::Vec3d origin, math::Vec3d direction,
                                      double radius);
/// The body that the view ray meets first, and where; null where it meets none.
template <class D>
rigid::BodyId pick_body(const Stage<D>& stage, math::Vec3d origin, math::Vec3d direction, typename D::Position& point);

}  // namespace carom::host
