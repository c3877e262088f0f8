#include "carom/particles/detail/granular_face.inl"

namespace carom::particles {
template class Granular<rigid::Dim2>;
}  // namespace carom::particles
