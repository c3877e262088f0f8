// Slender bodies in contact: their inertia turns with them, and their contacts see it in every substep (space alone).
#include "carom/math/simd.h"
#include "carom/rigid/detail/contact_lanes.h"
#include "carom/rigid/detail/load.h"
#include "carom/rigid/detail/move_body.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr float fast_spin = 0.05f;     ///< rad in a step
constexpr float whirling = 0.5f;       ///< likewise
constexpr float least_turned = 0.01f;  ///< sine of half the angle

/// The inertia of a body that has turned, in one lane. `place`: SlenderBodies::place.
template <int W>
void put_inertia(const StepContext<Dim3>& context, std::int32_t body, std::int32_t place, ContactBlock<Dim3, W>& block,
                 int lane) {
  put(block.body_a[lane] == body ? block.inverse_inertia_a : block.inverse_inertia_b, lane,
      context.slender.inverse_inertia[std::size_t(place - 1)]);
}

template <int W>
void turn_few(const StepContext<Dim3>& context, std::int32_t body, std::int32_t place) {
  for_lanes_of<Dim3, W>(context.world, body, [&](ContactBlock<Dim3, W>& block, int lane, std::uint8_t&, int) {
    put_inertia(context, body, place, block, lane);
    context.world.kernels.masses(&block);
  });
}

template <int W>
void forget_few(const StepContext<Dim3>& context, std::int32_t body) {
  for_lanes_of<Dim3, W>(context.world, body, [](ContactBlock<Dim3, W>& block, int lane, std::uint8_t&, int) {
    for (auto& point : block.point) point.impulse[lane] = 0;
    block.tangent_impulse[0][lane] = block.tangent_impulse[1][lane] = block.twist_impulse[lane] = 0;
  });
}

template <int W>
void turn_blocks(const StepContext<Dim3>& context, int color, int begin, int end) {
  const std::int32_t* const places = context.slender.place.data();
  for (int k = begin; k < end; ++k) {
    ContactBlock<Dim3, W>& block = static_cast<ContactBlock<Dim3, W>*>(context.world.scratch.blocks[color].blocks)[k];
    bool any = false;
    for (int lane = 0; lane < (color == overflow_color ? 1 : W); ++lane)
      for (const std::int32_t body : {block.body_a[lane], block.body_b[lane]})
        if (body >= 0 && places[body] != 0) put_inertia(context, body, places[body], block, lane), any = true;
    if (any) context.world.kernels.masses(&block);
  }
}

}  // namespace

bool list_slender(StepContext<Dim3>& context) {
  WorldImplementation<Dim3>& world = context.world;
  const std::vector<std::int32_t>& awake = world.bodies.awake;
  std::span<std::int32_t> list;
  std::size_t count = 0;
  bool any = false, any_jointed = false;
  for (const std::int32_t body : awake) {
    const BodyMotion<Dim3>& m = world.bodies.motion[std::size_t(body)];
    if (m.slender == 0) continue;
    const BodyRecord& record = world.bodies.record[std::size_t(body)];
    if (!may_turn_freely(m, record) || record.first_contact == none) continue;
    any_jointed = any_jointed || record.joint_count > 0;
    if (count == 0) list = context.arena.allocate<std::int32_t>(awake.size());
    list[count++] = body;
    const float turn = context.dt * math::length(context.bodies[body].angular_velocity);
    if (turn > fast_spin) world.scratch.again[std::size_t(body)] = 1, any = true;
  }
  if (count == 0) return false;
  context.slender = {list.first(count), context.arena.allocate<Mat3f>(count),
                     context.arena.allocate_zeroed<std::int32_t>(world.bodies.record.size()), false, any_jointed};
  return any;
}

void turn_slender(StepContext<Dim3>& context) {
  const WorldImplementation<Dim3>& world = context.world;
  SlenderBodies& slender = context.slender;
  std::size_t count = 0;
  for (std::size_t i = 0; i < slender.bodies.size(); ++i) {
    const std::int32_t body = slender.bodies[i];
    const Quatf& turned = context.bodies[body].delta_rotation;
    const bool far = math::length_squared(turned.vector()) > least_turned * least_turned;
    slender.place[std::size_t(body)] = far ? std::int32_t(i + 1) : 0;
    if (!far) continue;
    const BodyMotion<Dim3>& m = world.bodies.motion[std::size_t(body)];
    const Mat3f turn = to_matrix(turned);
    slender.inverse_inertia[i] = turn * (m.world_inverse_inertia * load_share(m)) * transpose(turn);
    ++count;
  }
  slender.many = many_bodies * count > world.bodies.awake.size();
  if (slender.many || count == 0) return;
  for (const std::int32_t body : slender.bodies) {
    const std::int32_t place = slender.place[std::size_t(body)];
    if (place == 0) continue;
    if constexpr (math::widest_lanes > 4) {
      if (world.kernels.width == 16) turn_few<16>(context, body, place);
      if (world.kernels.width == 8) turn_few<8>(context, body, place);
    }
    if (world.kernels.width == 4) turn_few<4>(context, body, place);
  }
}
void turn_masses(const StepContext<Dim3>& context, int color, int begin, int end) {
  if constexpr (math::widest_lanes > 4) {
    if (context.world.kernels.width == 16) return turn_blocks<16>(context, color, begin, end);
    if (context.world.kernels.width == 8) return turn_blocks<8>(context, color, begin, end);
  }
  turn_blocks<4>(context, color, begin, end);
}
void forget_blows(const StepContext<Dim3>& context) {
  const WorldImplementation<Dim3>& world = context.world;
  for (const std::int32_t body : context.slender.bodies) {
    if (world.bodies.record[std::size_t(body)].joint_count == 0) continue;
    if (!(context.dt * math::length(context.bodies[body].angular_velocity) > whirling)) continue;
    if constexpr (math::widest_lanes > 4) {
      if (world.kernels.width == 16) forget_few<16>(context, body);
      if (world.kernels.width == 8) forget_few<8>(context, body);
    }
    if (world.kernels.width == 4) forget_few<4>(context, body);
  }
}

}  // namespace carom::rigid::detail
