// From solved blocks back to manifolds and to the loads of their bodies (part of stage_contacts.cpp).
#pragma once

namespace carom::rigid::detail {
namespace {

/// (m/s)²: of the speed at which the slip since the anchor was set is taken back.
template <int W>
float taken_back_squared(const ContactBlock<Dim2, W>& block, int lane) {
  return block.tangent_target[lane] * block.tangent_target[lane];
}
template <int W>
float taken_back_squared(const ContactBlock<Dim3, W>& block, int lane) {
  return block.tangent_target[0][lane] * block.tangent_target[0][lane] +
         block.tangent_target[1][lane] * block.tangent_target[1][lane];
}

/// What slides, or lies loosely, lets go of its anchor, and a contact that settles does once it has slipped too far.
template <class D, int W>
void let_go(const StepContext<D>& context, ManifoldRecord<D>& m, const ContactBlock<D, W>& block, int lane, float load,
            bool at_limit) {
  if (m.anchor == Anchor::settles) {
    const float back = taken_back_squared(block, lane);
    const float most = 2 * anchor_rate * context.inverse_dt * settling_slip(context);
    if (at_limit && (load <= 0 || back > most * most))
      m.anchor = Anchor::none;
    else if (!at_limit && back > 0 && back < 1e-4f * most * most)
      m.anchor = Anchor::holds;  // 0: the anchor is new
  } else if (at_limit) {
    m.anchor = Anchor::none;
  }
}

template <int W>
void put_rolling(const ContactExtra<Dim2, W>& extra, int lane, float& impulse) {
  impulse = extra.rolling_impulse[0][lane];
}
template <int W>
void put_rolling(const ContactExtra<Dim3, W>& extra, int lane, Vec3f& impulse) {
  impulse = get(extra.rolling_impulse, lane);
}

/// A contact that bears a load for the first time is looked at again.
void stop_watching(WorldImplementation<Dim2>& world, std::int32_t contact) {
  core::Column<ContactWatch<Dim2>>& watches = world.scratch.watches;
  const auto place = std::size_t(world.contacts.at(contact).awake_index);
  if (place < watches.size()) watches[place].body[0] = none;
}

template <class D, int W>
void store_block(StepContext<D>& context, const ContactSources<D>& sources, std::span<const std::int32_t> list,
                 const ContactBlock<D, W>& block, const ContactExtra<D, W>* extra, const std::uint8_t* marks) {
  const int lanes = int(list.size());
  const std::uint32_t at_limit = context.world.kernels.store(sources, list.data(), lanes, &block);
  const std::uint32_t limited = at_limit & lanes_with<W>(marks, mark_anchored) & lane_bits(lanes);
  for (std::uint32_t left = limited; left != 0; left &= left - 1)
    __builtin_prefetch(sources.manifolds + list[std::size_t(std::countr_zero(left))], 1);
  if (extra != nullptr)
    for (int lane = 0; lane < lanes; ++lane)
      put_rolling(*extra, lane, context.world.contacts.manifold(list[std::size_t(lane)]).impulses.rolling);
  // Most keep their anchors: the front of their records is let be.
  const std::uint32_t left_open =
      (lanes_with<W>(marks, mark_anew) | lanes_with<W>(marks, mark_open)) & lane_bits(lanes);
  for (std::uint32_t left = limited | left_open; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    ManifoldRecord<D>& m = context.world.contacts.manifold(list[std::size_t(lane)]);
    const bool limit = (at_limit >> lane & 1u) != 0, anew = (marks[lane] & mark_anew) != 0;
    float load = 0;
    for (const auto& point : block.point) load += point.impulse[lane];
    if (anew && !(load > 0)) continue;
    if (anew) {
      m.anchor = Anchor::settles;
      put_anchor(context, m, block, lane, typename D::Vector{});
    } else if (m.anchor != Anchor::none) {
      let_go(context, m, block, lane, load, limit);
    }
    if constexpr (D::dimension == 2)
      if (m.waits && load > 0) stop_watching(context.world, m.contact);
  }
}

}  // namespace
}  // namespace carom::rigid::detail
