#include "carom/particles/detail/granular_face.inl"

namespace carom::particles {
template class Granular<rigid::Dim3>;
}  // namespace carom::particles
