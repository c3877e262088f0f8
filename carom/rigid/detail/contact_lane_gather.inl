// From the records of manifolds, contacts and bodies to the lanes of a block (part of stage_contacts.cpp).
#pragma once

namespace carom::rigid::detail {
namespace {

template <class D, int W>
void put_shape(const WorldImplementation<D>& world, std::int32_t shape, const typename D::Vector& center,
               typename ContactRaw<D, W>::Placed& to, int lane) {
  const typename D::Transform& local = world.shapes.at(shape).local;
  put(to.p, lane, local.p - center);
  put(to.q, lane, local.q);
}

constexpr float settling_push = 0.6f;  ///< of the push speed, above which what pushes without gravity is taken back

template <class D>
ContactSources<D> sources_of(const StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  ContactSources<D> s;
  s.manifolds = world.contacts.manifolds.data();
  s.contacts = world.contacts.contacts.data();
  s.motion = world.bodies.motion.data();
  s.pose = world.bodies.pose.data();
  s.record = world.bodies.record.data();
  s.bodies = context.bodies;
  s.load_shares = load_shares.share;
  s.loads = reinterpret_cast<float*>(world.scratch.loads.data());
  s.softness = context.contact_softness;
  s.gravity = world.definition.gravity;
  s.restitution_threshold = world.definition.restitution_threshold;
  s.push_speed = context.push_speed;
  if (is_weightless(context)) s.push_speed *= settling_push;
  s.rest_speed_squared = context.rest_speed * context.rest_speed;
  s.restless_load = restless_load;
  s.still_way = still_way(world, context.dt);
  s.half_step = 0.5f * context.dt;
  return s;
}

template <class Block>
void zero_lane(Block& block, int width, int lane) {
  for (std::size_t i = 0; i < sizeof(Block) / 4; i += std::size_t(width))
    reinterpret_cast<float*>(&block)[i + std::size_t(lane)] = 0;
}
/// Puts the manifold of a pair that will meet in this step there where it does. False: as it is. `across`: foresee.
template <class D>
bool put_where_it_meets(const StepContext<D>& context, std::int32_t index, typename D::Vector& across) {
  ManifoldRecord<D>& m = context.world.contacts.manifold(index);
  const ContactRecord<D>& c = context.world.contacts.at(m.contact);
  Foreseen<D> foreseen;
  if (!may_foresee(c, m) || !foresee(context.world, c, m.manifold, context.dt, foreseen)) return false;
  m.manifold = foreseen.manifold;
  across = foreseen.across;
  for (float& impulse : m.impulses.normal) impulse = 0;
  return true;
}

/// A round contact that turns in this step is solved as it is in its middle, with the gap of now.
template <class D, int W>
void put_middle(const StepContext<D>& context, std::int32_t index, ContactBlock<D, W>& block, ContactRaw<D, W>& raw,
                int lane) {
  ManifoldRecord<D>& m = context.world.contacts.manifold(index);
  const ContactRecord<D>& c = context.world.contacts.at(m.contact);
  MiddleOfStep<D> middle;
  if (!middle_of_step(context.world, c, m.manifold, context.dt, middle)) return;
  put(block.normal, lane, middle.normal);
  for (int i = 0; i < m.manifold.count; ++i) put(block.point[i].r_a, lane, middle.point[i]);
  put(block.center_offset, lane, get(block.center_offset, lane) - middle.across);
  raw.recycled[lane] = 0;
  if (m.anchor == Anchor::holds) {
    const auto& turn = context.world.bodies.pose[std::size_t(c.body[0])].rotation;
    put(raw.anchor_a, lane, get(raw.anchor_a, lane) + inverse_rotate(turn, middle.across));
  } else {
    raw.anchor_state[lane] = 0;
    m.anchor = Anchor::none;
  }
}

inline std::uint32_t lane_bits(int lanes) { return (1u << lanes) - 1; }

/// A byte for each of eight bits: `mark` where it is set.
inline std::uint64_t bytes_of(std::uint32_t bits, std::uint8_t mark) {
  const std::uint64_t set = (bits & 0xff) * 0x0101010101010101u & 0x8040201008040201u;  // bit i in byte i
  return ((set + 0x7f7f7f7f7f7f7f7fu) >> 7 & 0x0101010101010101u) * mark;
}
/// The other way round, for a mark of one bit: which of W lanes have it. Reads whole words.
template <int W>
std::uint32_t lanes_with(const std::uint8_t* marks, std::uint8_t mark) {
  std::uint32_t bits = 0;
  for (int k = 0; k < W; k += 8) {
    std::uint64_t bytes;
    __builtin_memcpy(&bytes, marks + k, 8);
    const std::uint64_t set = bytes >> std::countr_zero(mark) & 0x0101010101010101u;  // bit i of the bits in byte i
    bits |= std::uint32_t(set * 0x0102040810204080u >> 56) << k;
  }
  return bits;
}
/// The marks of a block's lanes, of which none has any yet. Whole blocks write them by words: lane by lane this is a
/// twelfth of the time of preparing.
template <int W>
void put_marks(const GatheredLanes& found, int lanes, std::uint8_t* marks) {
  if (((found.anchored | found.open) & lane_bits(lanes)) == 0) return;
  if (lanes == W) {
    for (int k = 0; k < W; k += 8) {
      const std::uint64_t bytes = bytes_of(found.anchored >> k, mark_anchored) | bytes_of(found.open >> k, mark_open);
      __builtin_memcpy(marks + k, &bytes, W < 8 ? W : 8);
    }
    return;
  }
  for (int lane = 0; lane < lanes; ++lane)
    marks[lane] = std::uint8_t((found.anchored >> lane & 1u) * mark_anchored | (found.open >> lane & 1u) * mark_open);
}

/// The lanes of a block from the records of `list`, and their marks.
template <class D, int W>
void gather_block(const StepContext<D>& context, const ContactSources<D>& sources, std::span<const std::int32_t> list,
                  ContactBlock<D, W>& block, ContactRaw<D, W>& raw, ContactExtra<D, W>* extra, std::uint8_t* marks) {
  const int lanes = int(list.size());
  typename D::Vector across[W];
  std::uint32_t meets = 0;  // bits by lane
  for (int lane = 0; lane < lanes; ++lane) {
    const std::int32_t index = list[std::size_t(lane)];
    const ContactRecord<D>& c = sources.contacts[sources.manifolds[index].contact];
    if (may_foresee(c)) meets |= std::uint32_t(put_where_it_meets(context, index, across[lane])) << lane;
  }
  const WorldImplementation<D>& world = context.world;
  const GatheredLanes found = world.kernels.gather(sources, list.data(), lanes, &block, &raw);
  put_marks<W>(found, lanes, marks);
  for (std::uint32_t left = found.placed & lane_bits(lanes); left != 0; left &= left - 1) {
    const int lane = std::countr_zero(left);
    const ContactRecord<D>& c = world.contacts.at(world.contacts.manifold(list[std::size_t(lane)]).contact);
    put_shape<D, W>(world, c.shape[0], world.bodies.motion[std::size_t(c.body[0])].local_center, raw.shape_a, lane);
    put_shape<D, W>(world, c.shape[1], world.bodies.motion[std::size_t(c.body[1])].local_center, raw.shape_b, lane);
  }
  if (extra != nullptr)
    for (int lane = lanes; lane < W; ++lane) zero_lane(*extra, W, lane);
  std::uint32_t pushed = found.pushed & lane_bits(lanes), turns = found.turns & ~meets;
  for (; pushed != 0; pushed &= pushed - 1) {
    const int lane = std::countr_zero(pushed);
    if (!parts_in_flight(context, slot_of(block.body_a[lane]), slot_of(block.body_b[lane]))) marks[lane] |= mark_pushed;
  }
  for (; meets != 0; meets &= meets - 1) {
    const int lane = std::countr_zero(meets);
    put(block.center_offset, lane, get(block.center_offset, lane) - across[lane]);
  }
  for (; turns != 0; turns &= turns - 1) {
    const int lane = std::countr_zero(turns);
    put_middle(context, list[std::size_t(lane)], block, raw, lane);
  }
}

}  // namespace
}  // namespace carom::rigid::detail
