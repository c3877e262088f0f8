// The kernels of joints and bodies of one width, and the table that names them.
#include "carom/rigid/detail/flight_kernel.inl"
#include "carom/rigid/detail/joint_kernel.inl"
#include "carom/rigid/detail/joint_limb_kernel.inl"
#include "carom/rigid/detail/move_kernel.inl"
#include "carom/rigid/detail/step_end_kernel.inl"

namespace carom::rigid::detail::CAROM_PIN_NAMESPACE {

template <class D>
static LaneKernels<D> all_kernels() {
  constexpr int W = CAROM_PIN_WIDTH;
  static_assert(W <= BodyEnds::most);
  LaneKernels<D> k;
  k.pins = {begin<D, W>, warm_start<D, W>, solve<D, W>, relax<D, W>};
  k.limbs = {begin_limbs<D, W>, warm_start_limbs<D, W>, solve_limbs<D, W>, relax_limbs<D, W>};
  k.bring_to_end = end_bodies<W>;
  if constexpr (D::dimension == 3) {
    k.move = {accelerate_bodies<W>, move_bodies<W>, turn_bodies<W>, fly_bodies<W>};
    k.turn_free = fly<W / 2>;
  }
  return k;
}
LaneKernels<Dim2> kernels(Dim2) { return all_kernels<Dim2>(); }
LaneKernels<Dim3> kernels(Dim3) { return all_kernels<Dim3>(); }

}  // namespace carom::rigid::detail::CAROM_PIN_NAMESPACE
