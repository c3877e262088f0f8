// World3: all of World's members for space.
#include "carom/math/elementary.h"
#include "carom/rigid/detail/world_shapes.inl"
// Shapes first: what bodies ask of them.
#include "carom/rigid/detail/world_bodies.inl"
#include "carom/rigid/detail/world_body_settings.inl"
#include "carom/rigid/detail/world_effectors.inl"
#include "carom/rigid/detail/world_forces.inl"
#include "carom/rigid/detail/world_joints.inl"
#include "carom/rigid/detail/world_queries.inl"
#include "carom/rigid/detail/world_snapshot.inl"
#include "carom/rigid/detail/world_terrain.inl"
#include "carom/rigid/detail/world_ways.inl"
#include "carom/rigid/detail/world_whole.inl"

namespace carom::rigid {
template class World<Dim3>;
}  // namespace carom::rigid
