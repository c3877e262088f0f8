// The effector "projectile" of a scene file: a body that flies by a drag curve (carom/ballistics/body_flight.h).
#pragma once

#include "carom/rigid/effector.h"
#include "carom/scene/detail/reader.h"

namespace carom::scene::detail {

/// Fails the reader where keys are missing or numbers cannot be.
template <class D>
rigid::EffectorDef<D> read_projectile(Reader& reader, const Object& o, rigid::BodyId body);

}  // namespace carom::scene::detail
