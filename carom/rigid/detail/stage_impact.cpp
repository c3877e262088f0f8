// Impacts at the moment in the substep when they happen.
//
// A substep's solve shares a blow among all that touch, which no bouncing row does: there the blow runs through from
// pair to pair (sequential impacts; Stronge, "Impact Mechanics", 2000, ch. 10; rigid-body.md 5.4). So where something
// strikes a body that has bouncing neighbours (a cradle, a rack), the pairs are solved one after the other, each by
// Newton's law of restitution, until none closes faster than the threshold. Every such impact keeps momentum and takes
// energy away (or none where e is 1). Bodies are set back by what the impact's moment within the substep makes them
// move less or more, so that positions are those of free flight before and after; hence single bodies that strike each
// other or the ground bounce here too. The other bounces, of bodies that rest on something or are part of a figure of
// joints, are left to the pass at the
// step's end (`restitute_contacts`), which weighs them against everything that they rest on.
#include <algorithm>
#include <tuple>

#include "carom/math/cpu.h"
#include "carom/rigid/detail/contact_lanes.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

enum ImpactState : std::int32_t { impact_listed = 1, impact_queued = 2 };  ///< ContactExtra::struck

/// A blow runs through bodies that bounce at least so well. Duller ones, as in a heap that is stirred, do not part in
/// their order: the solver's passes share the blow among them as well, and for far less.
constexpr float least_running_restitution = 0.5f;

/// A body that so many touch passes a blow on in the next substep only: to look at all of them after each would take
/// time as their square.
constexpr int most_neighbours = 64;

/// Calls f(manifold, other body) → bool (false: stop) for the bouncing manifolds of a body that are in the graph.
template <class D, class F>
void for_bouncing_manifolds(const WorldImplementation<D>& world, std::int32_t body, F&& f) {
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) {
      const ManifoldRecord<D>& record = world.contacts.manifold(m);
      if (record.restitution > 0 && record.place.color >= 0 && !record.disabled && !f(m, c.body[1 - (key & 1)])) return;
    }
    key = c.next[key & 1];
  }
}

/// Does a joint tie the body to another one that moves? Then a blow is not the body's alone: the whole figure takes it.
template <class D>
bool is_linked(const WorldImplementation<D>& world, std::int32_t body) {
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_joint; key != none;) {
    const JointHeader& joint = world.joints.headers[std::size_t(key >> 1)];
    const std::int32_t other = joint.body[1 - (key & 1)];
    if (other != none && world.bodies.is_dynamic(other)) return true;
    key = joint.next[key & 1];
  }
  return false;
}

/// Does one of the pair bounce well at a third body that moves, or does neither touch anything else?
template <class D>
bool strikes_here(const WorldImplementation<D>& world, const ManifoldRecord<D>& manifold) {
  const ContactRecord<D>& c = world.contacts.at(manifold.contact);
  if (is_linked(world, c.body[0]) || is_linked(world, c.body[1])) return false;
  bool found = false, alone = true;
  for (int side = 0; side < 2; ++side)
    alone = alone && (!world.bodies.is_dynamic(c.body[side]) ||
                      world.bodies.record[std::size_t(c.body[side])].constraint_count == 1);
  if (alone) return true;
  if (manifold.restitution < least_running_restitution) return false;
  for (int side = 0; side < 2 && !found; ++side) {
    if (!world.bodies.is_dynamic(c.body[side])) continue;
    for_bouncing_manifolds(world, c.body[side], [&](std::int32_t m, std::int32_t other) {
      found = other != c.body[1 - side] && world.bodies.is_dynamic(other) &&
              world.contacts.manifold(m).restitution >= least_running_restitution;
      return !found;
    });
  }
  return found;
}

float turn_dot(float a, float b) { return a * b; }
float turn_dot(const Vec3f& a, const Vec3f& b) { return dot(a, b); }

/// m/s at the surface of what closes at `closing` with `gap` to go and has an acceleration along it, whose gain of the
/// time h the speed holds already.
float impact_speed(float closing, float gap, float acceleration, float h) {
  if (acceleration == 0) return closing;
  const float start = max(closing - acceleration * h, 0.0f);
  return math::sqrt(start * start + 2 * acceleration * max(gap, 0.0f));
}

/// Friction of a blow: within the cone of its impulses, where the surfaces meet (the points lie half of the gap that
/// was at the step's start before it).
template <class D, int W, class Push>
void rub(ContactBlock<D, W>& block, int lane, const float (&impulse)[D::max_points],
         const typename D::Vector (&r_a)[D::max_points], const typename D::Vector& offset, const SolverBody<D>& a,
         const SolverBody<D>& b, const typename D::Inertia& inertia_a, const typename D::Inertia& inertia_b,
         const Push& push) {
  using V = typename D::Vector;
  float load = 0, gap = 0;
  V middle{};
  for (int i = 0; i < D::max_points; ++i)
    if (impulse[i] > 0) {
      load += impulse[i];
      gap += max(block.point[i].separation[lane], 0.0f) * impulse[i];
      middle += r_a[i] * impulse[i];
    }
  const float limit = block.friction[lane] * load;
  if (limit <= 0) return;
  middle = middle * (1 / load);
  const V n = get(block.normal, lane), to_surface = n * (0.5f * gap / load);
  const V at_a = middle - to_surface, at_b = middle + offset + to_surface;
  const V slip =
      b.linear_velocity + cross(b.angular_velocity, at_b) - a.linear_velocity - cross(a.angular_velocity, at_a);
  const float mass = block.inverse_mass_a[lane] + block.inverse_mass_b[lane];
  V done{};
  if constexpr (D::dimension == 2) {
    const V t{-n.y, n.x};
    const float arm_a = cross(at_a, t), arm_b = cross(at_b, t);
    const float k = mass + inertia_a * arm_a * arm_a + inertia_b * arm_b * arm_b;
    if (k > 0) done = t * ((block.tangent_target[lane] - dot(slip, t)) / k);
  } else {
    const V t = get(block.tangent, lane), u = cross(n, t);
    const V ta = cross(at_a, t), tb = cross(at_b, t), ua = cross(at_a, u), ub = cross(at_b, u);
    const V ita = inertia_a * ta, itb = inertia_b * tb;
    const float k11 = mass + dot(ta, ita) + dot(tb, itb), k12 = dot(ua, ita) + dot(ub, itb);
    const float k22 = mass + dot(ua, inertia_a * ua) + dot(ub, inertia_b * ub), d = k11 * k22 - k12 * k12;
    const float e1 = block.tangent_target[0][lane] - dot(slip, t), e2 = block.tangent_target[1][lane] - dot(slip, u);
    if (d > 0) done = t * ((k22 * e1 - k12 * e2) / d) + u * ((k11 * e2 - k12 * e1) / d);
  }
  const float size = math::length(done);
  if (size > limit) done = done * (limit / size);
  push(done, at_a, at_b);
  if constexpr (D::dimension == 2) {
    block.tangent_total[lane] += dot(done, V{-n.y, n.x});
  } else {
    const V t = get(block.tangent, lane);
    block.tangent_total[0][lane] += dot(done, t);
    block.tangent_total[1][lane] += dot(done, cross(n, t));
  }
}

/// The law of impact for the points of a manifold that would close in the substep that begins, whose acceleration the
/// velocities have already or not. False if none is fast enough.
template <class D, int W>
bool strike(StepContext<D>& context, ManifoldRecord<D>& m, bool accelerated) {
  using V = typename D::Vector;
  const ContactRecord<D>& contact = context.world.contacts.at(m.contact);
  const Lane<D, W> place = lane_of<D, W>(context.world, m);
  ContactBlock<D, W>& block = place.block;
  ContactExtra<D, W>& extra = *place.extra;
  const int lane = place.lane;
  const std::int32_t ia = contact.body[0], ib = contact.body[1];
  SolverBody<D> a = context.bodies[ia], b = context.bodies[ib];
  const BodyMotion<D>&ma = context.world.bodies.motion[std::size_t(ia)],
        &mb = context.world.bodies.motion[std::size_t(ib)];
  const typename D::Inertia inertia_a = ma.world_inverse_inertia * load_share(ma),
                            inertia_b = mb.world_inverse_inertia * load_share(mb);
  const V n = get(block.normal, lane), offset = get(block.center_offset, lane);
  const float shift = dot(n, b.delta_position - a.delta_position);
  const V na = turned_back_change(a.delta_rotation, n), nb = turned_back_change(b.delta_rotation, n);
  const float h = context.h, acceleration = extra.closing_acceleration[lane];

  V r_a[D::max_points], r_b[D::max_points];
  float gap[D::max_points], target[D::max_points] = {}, impulse[D::max_points] = {};
  bool closes[D::max_points] = {};
  float fastest = 0, time = 0, meeting = 0;
  const auto closing_speed = [&](int i) {
    return dot(n, a.linear_velocity + cross(a.angular_velocity, r_a[i]) - b.linear_velocity -
                      cross(b.angular_velocity, r_b[i]));
  };
  for (int i = 0; i < m.manifold.count; ++i) {
    r_a[i] = get(block.point[i].r_a, lane);
    r_b[i] = r_a[i] + offset;
    gap[i] = block.point[i].separation[lane] + shift + (dot(nb, r_b[i]) - dot(na, r_a[i]));
    const float closing = closing_speed(i);
    if (closing <= 0 || gap[i] > closing * h) continue;
    // The surface is met before the substep's end, with the energy of falling through the gap and no more.
    const float impact = impact_speed(closing, gap[i], acceleration, accelerated ? h : 0);
    if (impact > fastest) fastest = impact, time = clamp(gap[i] / closing, -h, h), meeting = gap[i];
  }
  const float threshold = bounce_threshold(context.world, ia, ib);
  if (fastest <= threshold) return false;
  // All of a face strikes at once, though rounding lets a corner lag behind.
  int count = 0;
  const float gained = accelerated ? acceleration * h : 0;
  for (int i = 0; i < m.manifold.count; ++i) {
    const float closing = closing_speed(i);
    closes[i] = closing > 0 && gap[i] < meeting + 0.1f * closing * h + 1e-3f;
    if (!closes[i]) continue;
    ++count;
    const float impact = impact_speed(closing, gap[i], acceleration, accelerated ? h : 0);
    if (impact > threshold) target[i] = max(m.restitution * impact + acceleration * max(time, 0.0f) - gained, 0.0f);
  }

  const V va = a.linear_velocity, vb = b.linear_velocity;
  const auto push = [&](const V& p, const V& at_a, const V& at_b) {
    a.linear_velocity -= p * block.inverse_mass_a[lane];
    a.angular_velocity -= inertia_a * cross(at_a, p);
    b.linear_velocity += p * block.inverse_mass_b[lane];
    b.angular_velocity += inertia_b * cross(at_b, p);
  };
  if (count > 1) {  // first what the points have in common: a face that lands flat leaves flat
    V middle_a{}, middle_b{};
    float wanted = 0;
    for (int i = 0; i < m.manifold.count; ++i)
      if (closes[i]) {
        middle_a += r_a[i];
        middle_b += r_b[i];
        wanted += closing_speed(i) + target[i];
      }
    const auto turn_a = cross(middle_a, n), turn_b = cross(middle_b, n);
    const float response = float(count * count) * (block.inverse_mass_a[lane] + block.inverse_mass_b[lane]) +
                           turn_dot(turn_a, inertia_a * turn_a) + turn_dot(turn_b, inertia_b * turn_b);
    const float each = max(wanted / response, 0.0f);
    for (int i = 0; i < m.manifold.count; ++i) impulse[i] = closes[i] ? each : 0;
    a.linear_velocity -= n * (each * float(count) * block.inverse_mass_a[lane]);
    a.angular_velocity -= inertia_a * (turn_a * each);
    b.linear_velocity += n * (each * float(count) * block.inverse_mass_b[lane]);
    b.angular_velocity += inertia_b * (turn_b * each);
  }
  for (int pass = 0; pass < (count == 1 ? 1 : 8); ++pass)
    for (int i = 0; i < m.manifold.count; ++i) {
      if (!closes[i]) continue;
      const float old = impulse[i];
      impulse[i] = max(old + block.point[i].normal_mass[lane] * (closing_speed(i) + target[i]), 0.0f);
      push(n * (impulse[i] - old), r_a[i], r_b[i]);
    }
  rub(block, lane, impulse, r_a, offset, a, b, inertia_a, inertia_b, push);
  a.delta_position -= (a.linear_velocity - va) * time;
  b.delta_position -= (b.linear_velocity - vb) * time;
  if (block.body_a[lane] >= 0) context.bodies[ia] = a;
  if (block.body_b[lane] >= 0) context.bodies[ib] = b;

  // The pair parts: what pressed and rubbed there before does so no more, and the last pass has nothing to add.
  for (int i = 0; i < D::max_points; ++i) {
    block.point[i].impulse[lane] = 0;
    block.point[i].total[lane] += impulse[i];
    extra.bounce_speed[i][lane] = 0;
  }
  if constexpr (D::dimension == 2) {
    block.tangent_impulse[lane] = 0;
  } else {
    block.tangent_impulse[0][lane] = block.tangent_impulse[1][lane] = block.twist_impulse[lane] = 0;
  }
  for (auto& rolling : extra.rolling_impulse) rolling[lane] = 0;
  if ((contact.flags & contact_hit_events) != 0) {
    m.approach_speed = max(m.approach_speed, fastest);
    context.world.scratch.hits.push_back(std::int32_t(&m - context.world.contacts.manifolds.data()));
  }
  return true;
}

/// The last relaxing pass of a step must not act on what will strike in the next step: there it does at its time.
template <class D, int W>
void leave_to_next_step(StepContext<D>& context) {
  using V = typename D::Vector;
  for (const std::int32_t manifold : context.world.scratch.impacts) {
    const ManifoldRecord<D>& m = context.world.contacts.manifold(manifold);
    const ContactRecord<D>& c = context.world.contacts.at(m.contact);
    const Lane<D, W> at = lane_of<D, W>(context.world, m);
    const SolverBody<D>&a = context.bodies[c.body[0]], &b = context.bodies[c.body[1]];
    const V n = get(at.block.normal, at.lane), offset = get(at.block.center_offset, at.lane);
    bool fast = false;
    for (int i = 0; i < m.manifold.count; ++i) {
      const V r = get(at.block.point[i].r_a, at.lane);
      fast = fast ||
             dot(n, a.linear_velocity + cross(a.angular_velocity, r) - b.linear_velocity -
                        cross(b.angular_velocity, r + offset)) > bounce_threshold(context.world, c.body[0], c.body[1]);
    }
    if (!fast) continue;
    for (auto& point : at.block.point) point.separation[at.lane] = 1e3f;
  }
}

template <class D, int W>
void solve_queue(StepContext<D>& context, bool accelerated) {
  WorldImplementation<D>& world = context.world;
  std::vector<std::int32_t>& impacts = world.scratch.impacts;
  // A ring: every manifold waits in it at most once.
  std::vector<std::int32_t>& queue = world.scratch.impact_queue;
  std::size_t taken = 0, given = 0;
  const auto enqueue = [&](std::int32_t manifold) {
    const Lane<D, W> lane = lane_of<D, W>(world, world.contacts.manifold(manifold));
    std::int32_t& state = lane.extra->struck[lane.lane];
    if ((state & impact_listed) == 0) impacts.push_back(manifold);
    if ((state & impact_queued) == 0) queue[given++ % queue.size()] = manifold;
    state = impact_listed | impact_queued;
  };
  const std::size_t known = impacts.size();
  for (std::size_t i = 0; i < known; ++i) {
    const Lane<D, W> lane = lane_of<D, W>(world, world.contacts.manifold(impacts[i]));
    lane.extra->struck[lane.lane] |= impact_listed;
    enqueue(impacts[i]);
  }
  // e < 1 may take infinitely many impacts: what is left after so many rests on the soft contacts.
  const std::size_t most = 1024 + 8 * known;
  while (taken < given) {
    ManifoldRecord<D>& m = world.contacts.manifold(queue[taken++ % queue.size()]);
    const Lane<D, W> lane = lane_of<D, W>(world, m);
    lane.extra->struck[lane.lane] = impact_listed;
    if (taken > most || !strike<D, W>(context, m, accelerated)) continue;
    const ContactRecord<D>& c = world.contacts.at(m.contact);
    for (const std::int32_t body : c.body)
      if (world.bodies.is_dynamic(body) && world.bodies.record[std::size_t(body)].constraint_count <= most_neighbours)
        for_bouncing_manifolds(world, body, [&](std::int32_t other, std::int32_t neighbour) {
          if (!is_linked(world, neighbour)) enqueue(other);
          return true;
        });
  }
}

template <class D, int W>
void solve_impacts_wide(StepContext<D>& context, ImpactMoment moment) {
  if (moment == ImpactMoment::end_of_step)
    leave_to_next_step<D, W>(context);
  else
    solve_queue<D, W>(context, moment == ImpactMoment::after_forces);
}

}  // namespace

template <class D>
void find_impacts(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  std::vector<std::int32_t>& impacts = world.scratch.impacts;
  impacts.clear();
  int bouncing = 0;
  for (const GraphColor& color : world.graph.colors) bouncing += color.extra;
  if (bouncing == 0) return;
  // Room for all there can be, so that a warm step never grows them.
  const std::size_t room = world.contacts.manifolds.capacity();
  if (impacts.capacity() < room) impacts.reserve(room);
  if (world.scratch.impact_queue.size() < room) world.scratch.impact_queue.resize(room);
  for (int color = 0; color <= overflow_color; ++color) {
    ColorBlocks& blocks = world.scratch.blocks[color];
    if (blocks.extra == nullptr) continue;
    const std::size_t first = impacts.size();
    for_marked(world, color, mark_bounces, [&](std::int32_t manifold) {
      blocks.bounces = true;
      if (strikes_here(world, world.contacts.manifold(manifold))) impacts.push_back(manifold);
    });
    // By their shapes, wherever in its colour a contact lies by now (order_by_place).
    std::sort(impacts.begin() + std::ptrdiff_t(first), impacts.end(), [&](std::int32_t l, std::int32_t r) {
      const ManifoldRecord<D>&a = world.contacts.manifold(l), &b = world.contacts.manifold(r);
      const ContactRecord<D>&in_a = world.contacts.at(a.contact), &in_b = world.contacts.at(b.contact);
      return std::tie(in_a.shape[0], in_a.shape[1], a.manifold.child) <
             std::tie(in_b.shape[0], in_b.shape[1], b.manifold.child);
    });
  }
}

template <class D>
void solve_impacts(StepContext<D>& context, ImpactMoment moment) {
  if (context.world.scratch.impacts.empty()) return;
  if constexpr (math::widest_lanes > 4) {
    if (context.world.kernels.width == 16) return solve_impacts_wide<D, 16>(context, moment);
    if (context.world.kernels.width == 8) return solve_impacts_wide<D, 8>(context, moment);
  }
  solve_impacts_wide<D, 4>(context, moment);
}

template void find_impacts<Dim2>(StepContext<Dim2>&);
template void find_impacts<Dim3>(StepContext<Dim3>&);
template void solve_impacts<Dim2>(StepContext<Dim2>&, ImpactMoment);
template void solve_impacts<Dim3>(StepContext<Dim3>&, ImpactMoment);

}  // namespace carom::rigid::detail
