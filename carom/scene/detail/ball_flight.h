// The effector "ball_flight" of a scene file: a ball that flies by its numbers (carom/sports/effector.h).
#pragma once

#include "carom/rigid/world.h"
#include "carom/scene/detail/reader.h"

namespace carom::scene::detail {

/// Of space only. Fails the reader where keys are missing or numbers cannot be. A ball that is thrown or struck gets
/// place, velocity and spin in `world`, null where that was done before.
template <class D>
rigid::EffectorDef<D> read_ball_flight(Reader& reader, const Object& o, rigid::BodyId body, rigid::World<D>* world);

}  // namespace carom::scene::detail
