// From solved blocks back to manifolds and to the loads of their bodies (part of stage_contacts.cpp).
#pragma once

namespace carom::rigid::detail {
namespace {

/// The bodies feel the load of the contact between them. Bodies of a colour's contacts differ, and those of the
/// overflow come in order, so this needs no lock.
template <class D, int W>
void add_load(StepContext<D>& context, const ContactBlock<D, W>& block, int lane, float load) {
  if (load <= 0) return;
  const std::int32_t a = block.read_a[lane], b = block.read_b[lane];
  const typename D::Vector n = get(block.normal, lane), p = n * load;
  // What is being squashed closes; what is at rest neither slides nor parts.
  typename D::Vector slip = context.bodies[b].linear_velocity - context.bodies[a].linear_velocity;
  slip -= n * min(dot(n, slip), 0.0f);
  const float size = math::length_squared(slip) > context.rest_speed * context.rest_speed ? restless_load : load;
  std::vector<BodyLoad<D>>& loads = context.world.scratch.loads;
  if (block.write_a[lane] != none) {
    loads[std::size_t(a)].sum -= p;
    loads[std::size_t(a)].size += size;
  }
  if (block.write_b[lane] != none) {
    loads[std::size_t(b)].sum += p;
    loads[std::size_t(b)].size += size;
  }
}

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
void store_lane(StepContext<Dim3>& context, std::int32_t index, const ContactBlock<Dim3, W>& block,
                const ContactExtra<Dim3, W>* extra, int lane) {
  ManifoldRecord<Dim3>& m = context.world.contacts.manifold(index);
  float load = 0;
  for (int i = 0; i < m.manifold.count; ++i) {
    m.impulses.normal[i] = block.point[i].impulse[lane];
    m.impulses.total[i] = block.point[i].total[lane];
    load += block.point[i].impulse[lane];
  }
  const float limit = 0.999f * m.friction * load;
  const Vec3f n{block.normal[0][lane], block.normal[1][lane], block.normal[2][lane]};
  const Vec3f t{block.tangent[0][lane], block.tangent[1][lane], block.tangent[2][lane]}, u = cross(n, t);
  m.impulses.friction = t * block.tangent_impulse[0][lane] + u * block.tangent_impulse[1][lane];
  m.impulses.friction_total = t * block.tangent_total[0][lane] + u * block.tangent_total[1][lane];
  m.impulses.twist = block.twist_impulse[lane];
  if (extra != nullptr)
    m.impulses.rolling = {extra->rolling_impulse[0][lane], extra->rolling_impulse[1][lane],
                          extra->rolling_impulse[2][lane]};
  add_load(context, block, lane, load);
  let_go(context, m, block, lane, load, math::length_squared(m.impulses.friction) >= limit * limit);
}

/// A contact that bears a load for the first time is looked at again.
void stop_watching(WorldImplementation<Dim2>& world, std::int32_t contact) {
  core::Column<ContactWatch<Dim2>>& watches = world.scratch.watches;
  const auto place = std::size_t(world.contacts.at(contact).awake_index);
  if (place < watches.size()) watches[place].body[0] = none;
}

template <int W>
void store_block(StepContext<Dim3>& context, const ContactSources<Dim3>&, std::span<const std::int32_t> list,
                 const ContactBlock<Dim3, W>& block, const ContactExtra<Dim3, W>* extra, const std::uint8_t*) {
  for (std::size_t lane = 0; lane < list.size(); ++lane) store_lane(context, list[lane], block, extra, int(lane));
}
template <int W>
void store_block(StepContext<Dim2>& context, const ContactSources<Dim2>& sources, std::span<const std::int32_t> list,
                 const ContactBlock<Dim2, W>& block, const ContactExtra<Dim2, W>* extra, const std::uint8_t* marks) {
  const int lanes = int(list.size());
  const std::uint32_t at_limit = context.world.kernels.store(sources, list.data(), lanes, &block);
  const std::uint32_t limited = at_limit & lanes_with<W>(marks, mark_anchored) & lane_bits(lanes);
  for (std::uint32_t left = limited; left != 0; left &= left - 1)
    __builtin_prefetch(sources.manifolds + list[std::size_t(std::countr_zero(left))], 1);
  if (extra != nullptr)
    for (int lane = 0; lane < lanes; ++lane)
      context.world.contacts.manifold(list[std::size_t(lane)]).impulses.rolling = extra->rolling_impulse[0][lane];
  // Most keep their anchors: the front of their records is let be.
  const std::uint32_t left_open =
      (lanes_with<W>(marks, mark_anew) | lanes_with<W>(marks, mark_open)) & lane_bits(lanes);
  for (std::uint32_t left = limited | left_open; left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    ManifoldRecord<Dim2>& m = context.world.contacts.manifold(list[std::size_t(lane)]);
    const bool limit = (at_limit >> lane & 1u) != 0, anew = (marks[lane] & mark_anew) != 0;
    const float load = block.point[0].impulse[lane] + block.point[1].impulse[lane];
    if (anew && !(load > 0)) continue;
    if (anew) {
      m.anchor = Anchor::settles;
      put_anchor(context, m, block, lane, Vec2f{});
    } else if (m.anchor != Anchor::none) {
      let_go(context, m, block, lane, load, limit);
    }
    if (m.waits && load > 0) stop_watching(context.world, m.contact);
  }
}

}  // namespace
}  // namespace carom::rigid::detail
