// What single contacts still need once the kernel has prepared their block: anchors of friction, how fast they close,
// and what only few have (part of stage_contacts.cpp).
#pragma once

namespace carom::rigid::detail {
namespace {

constexpr float anchor_rate = 0.05f;  ///< part of the slip that sticking friction takes back in a step
/// Part of its impulse that sticking friction forgets in a step where bodies are squeezed. What takes slip back pushes
/// late where many rows agree slowly, and a tall wall would sway for ever: it has to forget faster than it takes back.
constexpr float friction_leak = 0.15f;

template <class D>
typename D::Vector acceleration_of(const StepContext<D>& context, std::int32_t body) {
  if (!context.world.bodies.is_dynamic(body)) return {};
  const BodyMotion<D>& m = context.world.bodies.motion[std::size_t(body)];
  const float pace = context.world.bodies.pace(body);
  return (pace * pace) * (context.world.definition.gravity * m.gravity_scale + m.force * m.inverse_mass);
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
  extra.rolling_lever[lane] = m.rolling_lever;
  if constexpr (D::dimension == 2) {
    const BodyMotion<D>&a = world.bodies.motion[std::size_t(c.body[0])],
          &b = world.bodies.motion[std::size_t(c.body[1])];
    const float k = a.world_inverse_inertia * load_share(a) + b.world_inverse_inertia * load_share(b);
    extra.rolling_mass[lane] = m.rolling_lever > 0 && k > 0 ? 1 / k : 0;
    extra.rolling_impulse[0][lane] = m.rolling_lever > 0 ? m.impulses.rolling : 0;
  } else {
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

}  // namespace
}  // namespace carom::rigid::detail
