// The effector "ball_flight" of a scene file: a ball that flies by its numbers (carom/sports/effector.h).
#pragma once

#include "carom/rigid/effector.h"
#include "carom/scene/detail/reader.h"

namespace carom::scene::detail {

/// Of space only. Fails the reader where keys are missing or numbers cannot be.
template <class D>
rigid::EffectorDef<D> read_ball_flight(Reader& reader, const Object& o, rigid::BodyId body);

}  // namespace carom::scene::detail
