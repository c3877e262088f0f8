#include "carom/particles/detail/fluid_face.inl"

namespace carom::particles {
template class Fluid<rigid::Dim2>;
}  // namespace carom::particles
