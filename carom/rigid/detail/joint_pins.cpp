// Pins side by side (joint_lanes.h): who they are, and their way into the blocks and back.
#include "carom/rigid/detail/joint_fill.h"

namespace carom::rigid::detail {

template <class D>
bool goes_wide(const WorldImplementation<D>& world, std::int32_t joint) {
  return world.joints.tree_of(joint) == none && world.joints.at(joint).parts == part_pin && is_isotropic(world, joint);
}

template <class D>
void prepare_pins(StepContext<D>& context) {
  JointStore<D>& joints = context.world.joints;
  for_width(context.world.kernels.width, [&]<int W>() {
    const int count = int(joints.pins.size()) / W;
    if (count == 0) return;
    const auto blocks = context.arena.template allocate<PinLanes<D, W>>(std::size_t(count));
    joints.pin_blocks = blocks.data();
    for_blocks_of_colors(context.scheduler, 8, joints.pin_begin, [&](int begin, int end) {
      for (int b = begin; b < end; ++b) {
        PinLanes<D, W>& block = *::new (static_cast<void*>(&blocks[std::size_t(b)])) PinLanes<D, W>{};
        BodyTurns<D, W> turns{};
        for (int lane = 0; lane < W; ++lane)
          put_joint(block, turns, block.inverse_inertia_a, block.inverse_inertia_b, lane,
                    joints.pins[std::size_t(b) * W + std::size_t(lane)], context.world);
        context.world.kernels.pins.begin(&block, &turns);
      }
    });
  });
}

template <class D>
void store_pins(StepContext<D>& context) {
  JointStore<D>& joints = context.world.joints;
  for_width(context.world.kernels.width, [&]<int W>() {
    const auto* const blocks = static_cast<const PinLanes<D, W>*>(joints.pin_blocks);
    for_blocks_of_colors(context.scheduler, 8, joints.pin_begin, [&](int begin, int end) {
      for (int b = begin; b < end; ++b) {
        for (int lane = 0; lane < W; ++lane) {
          if (blocks[b].joint[lane] == none) continue;
          JointData<D>& data = joints.at(blocks[b].joint[lane]);
          for (int i = 0; i < D::dimension; ++i) data.memory.point[i] = blocks[b].impulse[i][lane];
          data.force = data.memory.point * context.inverse_h;
          data.torque = {};
        }
      }
    });
  });
}

template bool goes_wide(const WorldImplementation<Dim2>&, std::int32_t);
template bool goes_wide(const WorldImplementation<Dim3>&, std::int32_t);
template void prepare_pins(StepContext<Dim2>&);
template void prepare_pins(StepContext<Dim3>&);
template void store_pins(StepContext<Dim2>&);
template void store_pins(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
