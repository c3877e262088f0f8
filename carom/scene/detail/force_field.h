// The effector "force_field" of a scene file: a force or an acceleration by formulas of place, velocity and time.
#pragma once

#include "carom/rigid/effector.h"
#include "carom/scene/detail/reader.h"

namespace carom::scene::detail {

/// Fails the reader where a formula is not understood, names what is not known, or has another dimension.
template <class D>
rigid::EffectorDef<D> read_force_field(Reader& reader, const Object& o, rigid::BodyId body);

}  // namespace carom::scene::detail
