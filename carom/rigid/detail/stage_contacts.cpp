// From manifolds to the blocks of the wide solver, and from the solved blocks back.
#include <bit>

#include "carom/math/cpu.h"
#include "carom/math/simd.h"
#include "carom/rigid/detail/contact_foresight.h"
#include "carom/rigid/detail/contact_lanes.h"
#include "carom/rigid/detail/contact_middle.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int block_grain = 8;
constexpr float anchor_rate = 0.05f;  ///< part of the slip that sticking friction takes back in a step

template <class D>
typename D::Vector acceleration_of(const StepContext<D>& context, std::int32_t body) {
  if (!context.world.bodies.is_dynamic(body)) return {};
  const BodyMotion<D>& m = context.world.bodies.motion[std::size_t(body)];
  const float pace = context.world.bodies.pace(body);
  return (pace * pace) * (context.world.definition.gravity * m.gravity_scale + m.force * m.inverse_mass);
}

template <class D, int W>
void put_shape(const WorldImplementation<D>& world, std::int32_t shape, const typename D::Vector& center,
               bool at_origin, typename ContactRaw<D, W>::Placed& to, int lane) {
  const typename D::Transform local = at_origin ? typename D::Transform{} : world.shapes.at(shape).local;
  put(to.p, lane, local.p - center);
  put(to.q, lane, local.q);
}

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
  s.contact_softness = context.contact_softness;
  s.fixed_contact_softness = context.fixed_contact_softness;
  s.gravity = world.definition.gravity;
  s.restitution_threshold = world.definition.restitution_threshold;
  s.push_speed = context.push_speed;
  s.rest_speed_squared = context.rest_speed * context.rest_speed;
  s.restless_load = restless_load;
  return s;
}

/// Copies what the records hold to a lane; what follows from it the kernel computes for all lanes at once. Returns the
/// lane's mark.
template <class D, int W>
std::uint8_t gather_lane(const StepContext<D>& context, std::int32_t index, ContactBlock<D, W>& block,
                         ContactRaw<D, W>& raw, int lane) {
  using V = typename D::Vector;
  const WorldImplementation<D>& world = context.world;
  const ManifoldRecord<D>& m = world.contacts.manifold(index);
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  const std::int32_t a = c.body[0], b = c.body[1];
  const BodyMotion<D>&ma = world.bodies.motion[std::size_t(a)], &mb = world.bodies.motion[std::size_t(b)];
  const bool both = (c.flags & contact_dynamic) != 0;
  const bool dynamic_a = both || world.bodies.is_dynamic(a), dynamic_b = both || world.bodies.is_dynamic(b);
  const bool at_origin = (c.flags & contact_at_origin) != 0;
  put(raw.rotation_a, lane, world.bodies.pose[std::size_t(a)].rotation);
  put(raw.rotation_b, lane, world.bodies.pose[std::size_t(b)].rotation);
  put_shape<D, W>(world, c.shape[0], ma.local_center, at_origin, raw.shape_a, lane);
  put_shape<D, W>(world, c.shape[1], mb.local_center, at_origin, raw.shape_b, lane);
  put(raw.base.p, lane, c.base.p);
  put(raw.base.q, lane, c.base.q);
  raw.recycled[lane] = (c.flags & contact_recycled) != 0 ? 1 : 0;
  put(raw.anchor_a, lane, m.anchor_a);
  put(raw.anchor_b, lane, m.anchor_b);
  const bool slides = m.tangent_speed != 0 || (c.flags & contact_round) != 0;
  raw.anchor_state[lane] = slides ? 0 : 1 + float(m.anchor);
  put(raw.friction_impulse, lane, m.impulses.friction);
  raw.tangent_speed[lane] = m.tangent_speed;
  // Radius of the patch for the twist over the mean distance of its points, under uniform pressure: a disc turns on 2/3
  // of its radius, rectangles from square to thin line on .54 … .5 of the distance of their corners.
  raw.patch_factor[lane] = (c.flags & contact_on_disc) != 0 ? 2.0f / 3.0f : 0.53f;
  // What a single point's disc turns on (prepare_friction3); rolling resistance holds against spin too.
  raw.point_factor[lane] = m.rolling_lever > 0 ? 0 : 0.589f;

  block.read_a[lane] = a;
  block.read_b[lane] = b;
  block.write_a[lane] = dynamic_a ? a : none;
  block.write_b[lane] = dynamic_b ? b : none;
  put(block.normal, lane, m.manifold.normal);
  block.inverse_mass_a[lane] = ma.inverse_mass * load_share(ma);
  block.inverse_mass_b[lane] = mb.inverse_mass * load_share(mb);
  put(block.inverse_inertia_a, lane, ma.world_inverse_inertia * load_share(ma));
  put(block.inverse_inertia_b, lane, mb.world_inverse_inertia * load_share(mb));
  const Softness& soft = dynamic_a && dynamic_b ? context.contact_softness : context.fixed_contact_softness;
  block.bias_rate[lane] = soft.bias_rate;
  block.mass_scale[lane] = soft.mass_scale;
  block.impulse_scale[lane] = soft.impulse_scale;
  put(block.center_offset, lane, V(ma.center - mb.center));
  float deepest = 0;
  for (int i = 0; i < D::max_points; ++i) {
    auto& point = block.point[i];
    const bool exists = i < m.manifold.count;
    if (exists) deepest = min(deepest, m.manifold.points[i].separation);
    put(point.r_a, lane, exists ? m.manifold.points[i].point : V{});
    point.separation[lane] = exists ? m.manifold.points[i].separation : 0;
    point.normal_mass[lane] = exists ? 1 : 0;
    // An impulse on its way to nothing is nothing: no denormals, no division by them.
    point.impulse[lane] = exists && m.impulses.normal[i] > 1e-12f ? m.impulses.normal[i] : 0;
    point.total[lane] = 0;
  }
  block.friction[lane] = m.friction;
  block.settles[lane] = 0;
  block.tangent_total[0][lane] = block.tangent_total[1][lane] = 0;
  block.twist_impulse[lane] = m.impulses.twist;
  return deepest * soft.bias_rate < -context.push_speed ? mark_pushed : 0;
}

template <class Block>
void zero_lane(Block& block, int width, int lane) {
  for (std::size_t i = 0; i < sizeof(Block) / 4; i += std::size_t(width))
    reinterpret_cast<float*>(&block)[i + std::size_t(lane)] = 0;
}
/// A lane without a contact: no masses, and the bodies of the block's first lane to read from.
template <class D, int W>
void clear_lane(ContactBlock<D, W>& block, ContactRaw<D, W>& raw, ContactExtra<D, W>* extra, int lane) {
  zero_lane(block, W, lane);
  zero_lane(raw, W, lane);
  if (extra != nullptr) zero_lane(*extra, W, lane);
  block.read_a[lane] = block.read_a[0];
  block.read_b[lane] = block.read_b[0];
  block.write_a[lane] = block.write_b[lane] = none;
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
  if (!may_turn(c, m) || !middle_of_step(context.world, c, m.manifold, context.dt, middle)) return;
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

/// The lanes of a block from the records of `list`, and their marks.
template <class D, int W>
void gather_block(const StepContext<D>& context, const ContactSources<D>& sources, std::span<const std::int32_t> list,
                  ContactBlock<D, W>& block, ContactRaw<D, W>& raw, ContactExtra<D, W>* extra, std::uint8_t* marks) {
  const int lanes = int(list.size());
  typename D::Vector across[W];
  std::uint32_t meets = 0, turns = 0;  // bits by lane
  for (int lane = 0; lane < lanes; ++lane) {
    const std::int32_t index = list[std::size_t(lane)];
    const ContactRecord<D>& c = sources.contacts[sources.manifolds[index].contact];
    turns |= std::uint32_t(c.rolls) << lane;
    if (may_foresee(c)) meets |= std::uint32_t(put_where_it_meets(context, index, across[lane])) << lane;
  }
  turns &= ~meets;
  if constexpr (D::dimension == 2) {
    const WorldImplementation<D>& world = context.world;
    const GatheredLanes found = world.kernels.gather(sources, list.data(), lanes, &block, &raw);
    for (int lane = 0; lane < lanes; ++lane) {
      marks[lane] = (found.pushed >> lane & 1u) != 0 ? mark_pushed : 0;
      if ((found.placed >> lane & 1u) == 0) continue;
      const ContactRecord<D>& c = world.contacts.at(world.contacts.manifold(list[std::size_t(lane)]).contact);
      put_shape<D, W>(world, c.shape[0], world.bodies.motion[std::size_t(c.body[0])].local_center, false, raw.shape_a,
                      lane);
      put_shape<D, W>(world, c.shape[1], world.bodies.motion[std::size_t(c.body[1])].local_center, false, raw.shape_b,
                      lane);
    }
    if (extra != nullptr)
      for (int lane = lanes; lane < W; ++lane) zero_lane(*extra, W, lane);
  } else {
    for (int lane = 0; lane < lanes; ++lane)
      marks[lane] = gather_lane(context, list[std::size_t(lane)], block, raw, lane);
    for (int lane = lanes; lane < W; ++lane) clear_lane(block, raw, extra, lane);
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

/// How fast something parts shows only where it is slow: what flies faster than that in an overlap was pressed into it
/// by a blow, and takes it along.
template <class D>
bool parts_in_flight(const StepContext<D>& context, std::int32_t a, std::int32_t b) {
  const float fast = 2 * context.push_speed;
  const float speed_squared = max(math::length_squared(context.bodies[a].linear_velocity),
                                  math::length_squared(context.bodies[b].linear_velocity));
  return speed_squared > fast * fast;
}

/// m: by so much a contact that settles may slip.
template <class D>
float settling_slip(const StepContext<D>& context) {
  return context.rest_speed / rest_falls * context.dt;
}

/// Friction sticks here from now on, less the way that it slipped meanwhile (world axes).
template <class D, int W>
void put_anchor(const StepContext<D>& context, ManifoldRecord<D>& m, const ContactBlock<D, W>& block, int lane,
                const typename D::Vector& slip) {
  const ContactRecord<D>& c = context.world.contacts.at(m.contact);
  const typename D::Vector center = get(block.patch_r_a, lane), center_b = center + get(block.center_offset, lane);
  m.anchor_a = inverse_rotate(context.world.bodies.pose[std::size_t(c.body[0])].rotation, center);
  m.anchor_b = inverse_rotate(context.world.bodies.pose[std::size_t(c.body[1])].rotation, center_b + slip);
}

/// After the kernel: friction that sticks anew remembers where. A contact that settles has a new anchor where its load
/// moved on the patch, and keeps its slip. False where a face bears nothing yet: what it gets, it may lose in the same
/// step (store_block).
template <class D, int W>
bool set_anchor(const StepContext<D>& context, std::int32_t index, const ContactBlock<D, W>& block, int lane,
                bool may_wait) {
  using V = typename D::Vector;
  ManifoldRecord<D>& m = context.world.contacts.manifold(index);
  V slip{};
  if (m.anchor == Anchor::settles) {
    const ContactRecord<D>& c = context.world.contacts.at(m.contact);
    const auto &qa = context.world.bodies.pose[std::size_t(c.body[0])].rotation,
               &qb = context.world.bodies.pose[std::size_t(c.body[1])].rotation;
    const V n = get(block.normal, lane);
    const V center = get(block.patch_r_a, lane), center_b = center + get(block.center_offset, lane);
    slip = (rotate(qb, m.anchor_b) - center_b) - (rotate(qa, m.anchor_a) - center);
    slip -= dot(n, slip) * n;
    const float most = settling_slip(context);
    if (math::length_squared(slip) > most * most) slip = {}, m.anchor = Anchor::holds;
  } else {
    float load = 0;
    for (const auto& point : block.point) load += point.impulse[lane];
    // What meets with a corner or an edge may roll on it.
    const bool face = m.manifold.count == D::max_points;
    if (may_wait && face && !(load > 0)) return false;
    m.anchor = load > 0 || !face ? Anchor::holds : Anchor::settles;
  }
  put_anchor(context, m, block, lane, slip);
  return true;
}

/// After the kernel: how fast the surfaces close, and with what speed they are to part. Returns the lane's mark.
template <class D, int W>
std::uint8_t find_approach(const StepContext<D>& context, std::int32_t index, const ContactBlock<D, W>& block,
                           ContactExtra<D, W>* extra, int lane) {
  using V = typename D::Vector;
  const WorldImplementation<D>& world = context.world;
  ManifoldRecord<D>& m = context.world.contacts.manifold(index);
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  const SolverBody<D>&sa = context.bodies[c.body[0]], &sb = context.bodies[c.body[1]];
  const V n = get(block.normal, lane), offset = get(block.center_offset, lane);
  const V closing_acceleration =
      m.restitution > 0 ? acceleration_of(context, c.body[0]) - acceleration_of(context, c.body[1]) : V{};
  const float closing = max(dot(n, closing_acceleration), 0.0f);
  m.approach_speed = 0;
  if (extra != nullptr) extra->closing_acceleration[lane] = closing;
  for (int i = 0; i < D::max_points; ++i) {
    float speed = 0;
    if (i < m.manifold.count) {
      const V ra = get(block.point[i].r_a, lane), rb = ra + offset;
      const float vn = dot(
          n, sb.linear_velocity + cross(sb.angular_velocity, rb) - sa.linear_velocity - cross(sa.angular_velocity, ra));
      m.approach_speed = max(m.approach_speed, -vn);
      if (m.restitution > 0 && vn < 0) {
        // The speed at the surface: v² + 2 a s, because the body still falls through the gap.
        const float impact = math::sqrt(vn * vn + 2 * closing * max(block.point[i].separation[lane], 0.0f));
        if (impact > bounce_threshold(world, c.body[0], c.body[1])) speed = m.restitution * impact;
      }
    }
    if (extra != nullptr) extra->bounce_speed[i][lane] = speed;
  }
  const bool told = (c.flags & contact_hit_events) != 0;
  return told && m.approach_speed >= world.definition.restitution_threshold ? mark_hits : 0;
}

template <class D, int W>
void prepare_rolling(const StepContext<D>& context, std::int32_t index, ContactExtra<D, W>& extra, int lane) {
  const WorldImplementation<D>& world = context.world;
  const ManifoldRecord<D>& m = world.contacts.manifold(index);
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  const BodyMotion<D>&a = world.bodies.motion[std::size_t(c.body[0])], &b = world.bodies.motion[std::size_t(c.body[1])];
  const auto k = a.world_inverse_inertia * load_share(a) + b.world_inverse_inertia * load_share(b);
  extra.rolling_lever[lane] = m.rolling_lever;
  if constexpr (D::dimension == 2) {
    extra.rolling_response[0][lane] = m.rolling_lever > 0 && k > 0 ? 1 / k : 0;
    extra.rolling_impulse[0][lane] = m.rolling_lever > 0 ? m.impulses.rolling : 0;
  } else {
    put(extra.rolling_response, lane, k);
    put(extra.rolling_impulse, lane, m.rolling_lever > 0 ? m.impulses.rolling : Vec3f{});
  }
}

/// What only few contacts have: belts, patches that push nothing in this step, and hits that are told.
template <class D, int W>
void prepare_special(const StepContext<D>& context, std::int32_t index, ContactBlock<D, W>& block,
                     ContactExtra<D, W>* extra, int lane) {
  using V = typename D::Vector;
  ManifoldRecord<D>& m = context.world.contacts.manifold(index);
  const ContactRecord<D>& c = context.world.contacts.at(m.contact);
  if ((c.flags & (contact_special | contact_hit_events)) == 0) return;
  const V n = get(block.normal, lane), middle = get(block.patch_r_a, lane), offset = get(block.center_offset, lane);
  if (c.flags & contact_special) {
    const V belt = surface_slip(context.world, c, m.manifold.material);
    if (!(belt == V{})) {
      m.anchor = Anchor::none;  // nothing sticks to one place of a belt
      if constexpr (D::dimension == 2) {
        block.tangent_target[lane] = m.tangent_speed + dot(belt, Vec2f{-n.y, n.x});
      } else {
        const Vec3f t = get(block.tangent, lane);
        block.tangent_target[0][lane] = dot(belt, t);
        block.tangent_target[1][lane] = dot(belt, cross(n, t));
      }
    }
  }
  if (c.flags & contact_hit_events) {
    const SolverBody<D>&a = context.bodies[c.body[0]], &b = context.bodies[c.body[1]];
    const V v = b.linear_velocity + cross(b.angular_velocity, middle + offset) - a.linear_velocity -
                cross(a.angular_velocity, middle);
    m.slip_speed = math::length(v - n * dot(n, v));
  }
  if (!m.disabled) return;
  m.anchor = Anchor::none;
  for (int i = 0; i < D::max_points; ++i) {
    block.point[i].separation[lane] = 1e3f;
    block.point[i].impulse[lane] = 0;
    if (extra != nullptr) extra->bounce_speed[i][lane] = 0;
  }
  block.friction[lane] = 0;
  if constexpr (D::dimension == 2) {
    block.tangent_impulse[lane] = 0;
  } else {
    block.tangent_impulse[0][lane] = block.tangent_impulse[1][lane] = 0;
    block.twist_impulse[lane] = block.twist_radius[lane] = 0;
  }
  if (extra != nullptr) {
    extra->rolling_lever[lane] = 0;
    for (auto& row : extra->rolling_impulse) row[lane] = 0;
  }
}

/// May it bounce in this step?
template <class D, int W>
std::uint8_t bounce_mark(ContactExtra<D, W>& extra, int lane) {
  extra.struck[lane] = 0;
  for (const auto& speed : extra.bounce_speed)
    if (speed[lane] > 0) return mark_bounces;
  return 0;
}

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
  std::vector<ContactWatch<Dim2>>& watches = world.scratch.watches;
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
  for (int lane = 0; lane < lanes; ++lane) {
    ManifoldRecord<Dim2>& m = context.world.contacts.manifold(list[std::size_t(lane)]);
    if (extra != nullptr) m.impulses.rolling = extra->rolling_impulse[0][lane];
    const float load = block.point[0].impulse[lane] + block.point[1].impulse[lane];
    const bool anew = (marks[lane] & mark_anew) != 0;
    if (anew && !(load > 0)) continue;
    if (anew) {
      m.anchor = Anchor::settles;
      put_anchor(context, m, block, lane, Vec2f{});
    } else if (m.anchor != Anchor::none) {
      let_go(context, m, block, lane, load, (at_limit >> lane & 1u) != 0);
    }
    if (m.waits && load > 0) stop_watching(context.world, m.contact);
  }
}

/// Contacts of a colour lie anywhere in memory: three rounds of pre-loading walk from the manifold to its contact to
/// its bodies, some lanes ahead of their use; preparing is bound by latency, and a round that comes before the memory
/// of the one before it waits. Inlined always: to gcc a function that only pre-loads has no effect, and calls of it go.
template <class D>
CAROM_SIMD_INLINE void prefetch_manifold(const ContactSources<D>& from, std::span<const std::int32_t> list,
                                         std::size_t i, bool velocities) {
  constexpr std::size_t manifold_lanes = 64, contact_lanes = 40, body_lanes = 18;
  if (i + body_lanes >= list.size()) return;
  const ContactRecord<D>& c = from.contacts[from.manifolds[list[i + body_lanes]].contact];
  for (const std::int32_t body : c.body) {
    prefetch_lines(from.motion + body, sizeof(BodyMotion<D>));
    __builtin_prefetch(from.pose + body);
    if (velocities) __builtin_prefetch(from.bodies + body);
    if ((c.flags & contact_dynamic) == 0) __builtin_prefetch(from.record + body);
  }
  if (i + contact_lanes >= list.size()) return;
  prefetch_lines(from.contacts + from.manifolds[list[i + contact_lanes]].contact,
                 D::dimension == 2 ? 64 : sizeof(ContactRecord<D>));
  if (i + manifold_lanes >= list.size()) return;
  prefetch_lines(from.manifolds + list[i + manifold_lanes], ManifoldRecord<D>::hot_bytes);
}

/// May blocks of the overflow, which share bodies, be taken at once?
enum class Overflow : std::uint8_t { at_once, in_order };

/// Calls f(manifolds of the colour, first, lanes, block, extra, marks) for the blocks of every colour, in parallel;
/// those of all colours at once, or colour by colour, the overflow in its order.
template <class D, int W, class F>
void for_blocks(StepContext<D>& context, Overflow overflow, F&& f) {
  WorldImplementation<D>& world = context.world;
  const auto run = [&](int color, int begin, int end) {
    const std::vector<std::int32_t>& manifolds = world.graph.colors[color].manifolds;
    const ColorBlocks& blocks = world.scratch.blocks[color];
    const int lanes = color == overflow_color ? 1 : W;
    for (int k = begin; k < end; ++k) {
      const int first = k * lanes;
      f(std::span<const std::int32_t>(manifolds), std::size_t(first), min(lanes, int(manifolds.size()) - first),
        static_cast<ContactBlock<D, W>*>(blocks.blocks)[k],
        blocks.extra == nullptr ? nullptr : static_cast<ContactExtra<D, W>*>(blocks.extra) + k, blocks.marks + first);
    }
  };
  int ends[color_count + 1], total = 0;
  for (int color = 0; color <= overflow_color; ++color) {
    const int count = world.scratch.blocks[color].count;
    ends[color] = total += count;
    if (overflow == Overflow::at_once || count == 0) continue;
    if (count <= block_grain || color == overflow_color)
      run(color, 0, count);
    else
      context.scheduler.parallel_for(count, block_grain, [&](int begin, int end, int) { run(color, begin, end); });
  }
  if (overflow == Overflow::in_order || total == 0) return;
  context.scheduler.parallel_for(total, block_grain, [&](int begin, int end, int) {
    for (int color = 0; begin < end; ++color) {
      if (ends[color] <= begin) continue;
      const int before = color == 0 ? 0 : ends[color - 1], stop = min(end, ends[color]);
      run(color, begin - before, stop - before);
      begin = stop;
    }
  });
}

template <class D, int W>
void prepare_blocks(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  for (int color = 0; color <= overflow_color; ++color) {
    const GraphColor& c = world.graph.colors[color];
    ColorBlocks& blocks = world.scratch.blocks[color];
    const int lanes = color == overflow_color ? 1 : W;
    blocks = {};
    blocks.count = (int(c.manifolds.size()) + lanes - 1) / lanes;
    if (blocks.count == 0) continue;
    blocks.blocks = context.arena.template allocate<ContactBlock<D, W>>(std::size_t(blocks.count)).data();
    if (c.extra > 0)
      blocks.extra = context.arena.template allocate<ContactExtra<D, W>>(std::size_t(blocks.count)).data();
    blocks.marks = context.arena.template allocate_zeroed<std::uint8_t>((c.manifolds.size() + 7) / 8 * 8).data();
  }
  const ContactSources<D> sources = sources_of(context);
  const bool any_special = !world.shapes.extras.empty() || world.hit_event_shapes > 0;
  // Where nothing rare is asked for, lanes find by themselves how their contacts roll and bounce.
  const bool by_kernel = world.kernels.approach != nullptr && !any_special && world.bodies.time_scale.empty();
  const bool may_wait = D::dimension == 2 && !any_special;
  for_blocks<D, W>(
      context, Overflow::at_once,
      [&](std::span<const std::int32_t> manifolds, std::size_t first, int lanes, ContactBlock<D, W>& block,
          ContactExtra<D, W>* extra, std::uint8_t* marks) {
        ContactRaw<D, W> raw;
        const bool approaches = extra != nullptr || world.hit_event_shapes > 0;
        const std::span<const std::int32_t> list = manifolds.subspan(first, std::size_t(lanes));
        for (int lane = 0; lane < lanes; ++lane)
          prefetch_manifold(sources, manifolds, first + std::size_t(lane), approaches);
        gather_block(context, sources, list, block, raw, extra, marks);
        for (int lane = 0; lane < lanes; ++lane)
          if (marks[lane] != 0 && parts_in_flight(context, block.read_a[lane], block.read_b[lane])) marks[lane] = 0;
        world.kernels.prepare(&block, &raw, anchor_rate * context.inverse_dt);
        for (int lane = 0; lane < lanes; ++lane)
          if (raw.anchor_state[lane] > 0 && !set_anchor(context, list[std::size_t(lane)], block, lane, may_wait))
            marks[lane] |= mark_anew;
        if (by_kernel) {
          if (extra == nullptr) return;
          std::uint32_t bounces = world.kernels.approach(sources, list.data(), lanes, &block, extra);
          for (; bounces != 0; bounces &= bounces - 1)
            if (const int lane = std::countr_zero(bounces); lane < lanes) marks[lane] |= mark_bounces;
          return;
        }
        for (int lane = 0; lane < lanes; ++lane) {
          const std::int32_t m = list[std::size_t(lane)];
          if (approaches) marks[lane] |= find_approach(context, m, block, extra, lane);
          if (extra != nullptr) prepare_rolling(context, m, *extra, lane);
          if (any_special) prepare_special(context, m, block, extra, lane);
          if (extra != nullptr) marks[lane] |= bounce_mark(*extra, lane);
        }
      });
}

/// Finds the contacts that settle: those of bodies out of which something is pushed, or that are pushed themselves;
/// all, where these are many, because then the blow that pressed them into each other goes through all.
template <class D, int W>
void mark_settling(StepContext<D>& context) {
  constexpr std::size_t many = 64;  ///< one in so many bodies
  WorldImplementation<D>& world = context.world;
  std::uint8_t* pushed = nullptr;  // by slot of the body
  std::size_t count = 0;
  for (int color = 0; color <= overflow_color; ++color)
    for_marked(world, color, mark_pushed, [&](std::int32_t manifold) {
      if (pushed == nullptr)
        pushed = context.arena.template allocate_zeroed<std::uint8_t>(world.bodies.record.size()).data();
      for (const std::int32_t body : world.contacts.at(world.contacts.manifold(manifold).contact).body)
        if (world.bodies.is_dynamic(body) && pushed[body] == 0) pushed[body] = 1, ++count;
    });
  if (count == 0) return;
  const bool all = many * count > world.bodies.awake.size();
  for_blocks<D, W>(context, Overflow::at_once,
                   [&](std::span<const std::int32_t>, std::size_t, int lanes, ContactBlock<D, W>& block,
                       ContactExtra<D, W>*, std::uint8_t* marks) {
                     for (int lane = 0; lane < lanes; ++lane) {
                       const std::int32_t a = block.write_a[lane], b = block.write_b[lane];
                       if (!all && (a == none || pushed[a] == 0) && (b == none || pushed[b] == 0)) continue;
                       block.settles[lane] = 1;
                       marks[lane] |= mark_settles;
                     }
                   });
}

template <class D, int W>
void prepare_and_mark(StepContext<D>& context) {
  prepare_blocks<D, W>(context);
  mark_settling<D, W>(context);
  WorldImplementation<D>& world = context.world;
  if (world.hit_event_shapes == 0) return;
  std::vector<std::int32_t>& hits = world.scratch.hits;
  if (hits.capacity() < world.contacts.awake.size()) hits.reserve(world.contacts.awake.capacity());
  for (int color = 0; color <= overflow_color; ++color)
    for_marked(world, color, mark_hits, [&](std::int32_t manifold) {
      hits.push_back(world.contacts.at(world.contacts.manifold(manifold).contact).awake_index);
    });
}

template <class D, int W>
void store_blocks(StepContext<D>& context) {
  const ContactSources<D> sources = sources_of(context);
  for_blocks<D, W>(context, Overflow::in_order,
                   [&](std::span<const std::int32_t> manifolds, std::size_t first, int lanes, ContactBlock<D, W>& block,
                       ContactExtra<D, W>* extra, const std::uint8_t* marks) {
                     for (int lane = 0; lane < lanes; ++lane)
                       for (const std::int32_t body : {block.read_a[lane], block.read_b[lane]}) {
                         __builtin_prefetch(sources.loads + 4 * body, 1);
                         __builtin_prefetch(sources.bodies + body);
                       }
                     for (int lane = 0; lane < lanes; ++lane) {
                       const std::size_t i = first + std::size_t(lane);
                       if (i + 12 < manifolds.size()) {
                         const char* record = reinterpret_cast<const char*>(sources.manifolds + manifolds[i + 12]);
                         for (std::size_t k = 0; k < ManifoldRecord<D>::hot_bytes; k += 64)
                           __builtin_prefetch(record + k, 1);
                       }
                     }
                     store_block(context, sources, manifolds.subspan(first, std::size_t(lanes)), block, extra, marks);
                   });
}

}  // namespace

template <class D>
void prepare_contacts(StepContext<D>& context) {
  if constexpr (math::widest_lanes > 4) {
    if (context.world.kernels.width == 16) return prepare_and_mark<D, 16>(context);
    if (context.world.kernels.width == 8) return prepare_and_mark<D, 8>(context);
  }
  prepare_and_mark<D, 4>(context);
}
template <class D>
void store_contacts(StepContext<D>& context) {
  if constexpr (math::widest_lanes > 4) {
    if (context.world.kernels.width == 16) return store_blocks<D, 16>(context);
    if (context.world.kernels.width == 8) return store_blocks<D, 8>(context);
  }
  store_blocks<D, 4>(context);
}

template <class D>
void contact_points_now(const WorldImplementation<D>& world, const ManifoldRecord<D>& m,
                        typename D::Position (&points)[D::max_points], float (&separations)[D::max_points],
                        typename D::Vector& normal) {
  const ContactRecord<D>& c = world.contacts.at(m.contact);
  // After a step the bodies have moved on from where the manifold was made: follow them as the kernel does for recycled
  // contacts (prepare_points2, prepare_points3).
  const typename D::Pose pose = shape_pose(world, world.shapes.at(c.shape[0]));
  typename D::Transform now;
  if (c.flags & contact_at_origin)
    now = relative(world.bodies.pose[std::size_t(c.body[0])], world.bodies.pose[std::size_t(c.body[1])]);
  else
    now = relative(pose, shape_pose(world, world.shapes.at(c.shape[1])));
  const typename D::Transform motion = now * inverse(c.base);
  normal = rotate(pose.rotation, m.manifold.normal);
  for (int i = 0; i < m.manifold.count; ++i) {
    const auto& point = m.manifold.points[i];
    const typename D::Vector half = (0.5f * point.separation) * m.manifold.normal, on_a = point.point - half;
    const typename D::Vector on_b = transform_point(motion, point.point + half);
    separations[i] = dot(on_b - on_a, m.manifold.normal);
    points[i] = world_point(pose, 0.5f * (on_a + on_b));
  }
}

template void prepare_contacts<Dim2>(StepContext<Dim2>&);
template void prepare_contacts<Dim3>(StepContext<Dim3>&);
template void store_contacts<Dim2>(StepContext<Dim2>&);
template void store_contacts<Dim3>(StepContext<Dim3>&);
template void contact_points_now<Dim2>(const WorldImplementation<Dim2>&, const ManifoldRecord<Dim2>&, Vec2d (&)[2],
                                       float (&)[2], Vec2f&);
template void contact_points_now<Dim3>(const WorldImplementation<Dim3>&, const ManifoldRecord<Dim3>&, Vec3d (&)[4],
                                       float (&)[4], Vec3f&);

}  // namespace carom::rigid::detail
