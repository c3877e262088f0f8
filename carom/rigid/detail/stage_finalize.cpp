#include <algorithm>
#include <atomic>
#include <type_traits>
#include <utility>

#include "carom/rigid/detail/coarse.h"
#include "carom/rigid/detail/joint_figure.h"
#include "carom/rigid/detail/rotation_step.h"
#include "carom/rigid/detail/stages.h"
#include "carom/rigid/detail/step_end_lanes.h"

namespace carom::rigid::detail {
namespace {

constexpr int finalize_grain = 128, hit_grain = 128;
constexpr float settling_speed = 3;  ///< of its sleep speed, below which a body that lies on something settles
constexpr float settling_resistance = 0.014f;  ///< lever arm over the radius: holds a ball on .8°, as sleep does alone

float spin_of(float w) { return math::abs(w); }
float spin_of(const Vec3f& w) { return math::length(w); }
Rot2f turn_of(Dim2, const BodyEnds& ends, int lane) { return {ends.turn[0][lane], ends.turn[1][lane]}; }
Quatf turn_of(Dim3, const BodyEnds& ends, int lane) {
  return {ends.turn[0][lane], ends.turn[1][lane], ends.turn[2][lane], ends.turn[3][lane]};
}

/// m/s², of what acts on the body from afar; `gravity` is that of the world.
template <class D>
float gravity_of(const WorldDef<D>& definition, const BodyMotion<D>& m, float pace, float gravity) {
  if (m.force == typename D::Vector{} && m.gravity_scale == 1 && pace == 1) return gravity;
  return pace * pace * math::length(m.gravity_scale * definition.gravity + m.inverse_mass * m.force);
}

/// What a body of a torque impulse's unit turns by, along its spin.
float response_of(float inverse_inertia, float, float) { return inverse_inertia; }
float response_of(const Mat3f& inverse_inertia, const Vec3f& spin, float size) {
  return math::length(inverse_inertia * spin) / size;
}

/// m: of what it rolls on; 0: on nothing round. `inner`: half of the body's thickness.
float rolling_radius(const geometry::Shape2& s, float inner) {
  using geometry::ShapeType2;
  return s.type == ShapeType2::circle || s.type == ShapeType2::capsule ? inner : 0;
}
float rolling_radius(const geometry::Shape3& s, float inner) {
  switch (s.type) {
    case geometry::ShapeType3::sphere:
    case geometry::ShapeType3::capsule:
    case geometry::ShapeType3::ellipsoid:
      return inner;
    case geometry::ShapeType3::cylinder:  // a coin rolls, and rocks, on its rim
      return s.cylinder.radius;
    case geometry::ShapeType3::cone:
      return s.cone.radius;
    default:
      return 0;
  }
}

/// What rolls of a spin: what turns about the direction of the load spins on its spot.
float rolling_part(float spin, const Vec2f&) { return spin; }
Vec3f rolling_part(const Vec3f& spin, const Vec3f& load) {
  const float squared = math::length_squared(load);
  return squared > 0 ? spin - load * (dot(load, spin) / squared) : spin;
}

/// What is round and lies on others would roll among them for ever where nothing resists it, and keep a heap awake.
/// Sleep stops what is slow and alone; what is slow among others is stopped by some rolling resistance under the load
/// that it carries. slowness: 0 … 1.
template <class D>
void settle(const StepContext<D>& context, const BodyMotion<D>& m, SolverBody<D>& s, float radius,
            const BodyLoad<D>& load, float slowness) {
  const auto rolling = rolling_part(s.angular_velocity, load.sum);
  const float spin = spin_of(rolling);
  if (!(spin > 0)) return;
  const float torque = slowness * settling_resistance * radius * load.size * float(context.substeps);
  const float left = max(spin - torque * response_of(m.world_inverse_inertia, rolling, spin), 0.0f);
  s.angular_velocity = (s.angular_velocity - rolling) + rolling * (left / spin);
}

/// Where the hulls of a body of several shapes are and go, all of which are asked in every step while it is quick: as
/// the boxes that they have in their own frame, found far sooner than their bounds, and no smaller; x, y and z in
/// lanes.
class BoxesOfHulls {
 public:
  using Four = math::WideFloat<4>;

  BoxesOfHulls(const WorldImplementation<Dim3>& world, std::int32_t body, bool quick) : quick_(quick) {
    if (!quick) return;
    const SolverBody<Dim3>& s = world.bodies.solver[std::size_t(body)];
    position_ = world.bodies.pose[std::size_t(body)].position;
    const Mat3f turn = math::to_matrix(world.bodies.pose[std::size_t(body)].rotation);
    const Vec3f spin = s.angular_velocity * world.last_dt,
                center = turn * world.bodies.motion[std::size_t(body)].local_center;
    for (int k = 0; k < 3; ++k) {
      const Vec3f axis = k == 0 ? turn.cx : k == 1 ? turn.cy : turn.cz;
      axis_[k] = lanes(axis), size_[k] = lanes(abs(axis)), turning_[k] = lanes(cross(spin, axis));
    }
    way_ = lanes(s.linear_velocity * world.last_dt - cross(spin, center));
    bounce_ = world.shapes.bounce;
  }
  /// Does it stay in its fat bounds, with its way in the next step? Then with so much room (m).
  bool stay_within(const ShapeRecord<Dim3>& shape, const Dim3::Bounds& fat, Vec3d& least_below, Vec3d& least_above) {
    if (!quick_ || !shape.at_origin || shape.geometry.type != geometry::ShapeType3::hull) return false;
    const geometry::Bounds3f& own = shape.geometry.hull->bounds;
    const Vec3f c = own.center(), e = own.extents();
    const auto sum = [](const Four(&rows)[3], const Vec3f& v) {
      return rows[0] * Four::splat(v.x) + rows[1] * Four::splat(v.y) + rows[2] * Four::splat(v.z);
    };
    const Four middle = sum(axis_, c), zero = Four::zero();
    const float size = math::abs(c.x) + math::abs(c.y) + math::abs(c.z) + e.x + e.y + e.z;
    const Four half = sum(size_, e) + Four::splat(4e-6f * size + shape.geometry.hull->radius);
    const Four to = way_ + sum(turning_, c), squares = to * to;
    const Four way = to * Four::splat(within_foresight(squares[0] + squares[1] + squares[2], shape, bounce_));
    const Four below = middle - half - lanes(Vec3f(fat.low - position_)),
               above = lanes(Vec3f(fat.high - position_)) - middle - half;
    const auto within = (below + min(way, zero) >= zero) & (above - max(way, zero) >= zero);
    if ((bitmask(within) & 7) != 7) return false;
    for (int k = 0; k < 3; ++k) {
      least_below[k] = min(least_below[k], double(below[k]));
      least_above[k] = min(least_above[k], double(above[k]));
    }
    return true;
  }

 private:
  static Four lanes(const Vec3f& v) { return {Four::Vector{v.x, v.y, v.z, 0}}; }

  bool quick_;
  Bounce bounce_ = Bounce::unknown;
  Vec3d position_{};
  Four axis_[3], size_[3], turning_[3], way_;  ///< rad, m
};
struct NoBoxes {
  NoBoxes(const WorldImplementation<Dim2>&, std::int32_t, bool) {}
  static bool stay_within(const ShapeRecord<Dim2>&, const Dim2::Bounds&, Vec2d&, Vec2d&) { return false; }
};

}  // namespace

// Puts the body back where the step began, at rest and for good: one broken number must not spread.
template <class D>
void quarantine(WorldImplementation<D>& world, std::int32_t body) {
  SolverBody<D>& s = world.bodies.solver[std::size_t(body)];
  s = {};
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  m.force = {};
  m.torque = {};
  world.bodies.record[std::size_t(body)].flags |= body_quarantined;
}

template <class D>
bool leave_bounds(WorldImplementation<D>& world, std::int32_t body) {
  bool any = false;
  using P = typename D::Position;
  P least_below{}, least_above{};
  for (int k = 0; k < D::dimension; ++k) least_below[k] = least_above[k] = 1e6;
  // What moves far in a step must have its next way within its bounds, so that its contacts are foreseen.
  const BodyMotion<D>& motion = world.bodies.motion[std::size_t(body)];
  const P way = P(world.bodies.solver[std::size_t(body)].linear_velocity) * double(world.last_dt);
  const double most_slow = quick_share * double(motion.inner_extent);
  const bool quick = math::length_squared(way) > most_slow * most_slow;
  double farthest = 0;
  const bool several = has_several_shapes(world, body);
  const bool bullet = (world.bodies.record[std::size_t(body)].flags & body_bullet) != 0;  // looks one step ahead
  if (quick && (bullet || !several))
    for (int k = 0; k < D::dimension; ++k) farthest = max(farthest, math::abs(way[k]));
  std::conditional_t<D::dimension == 2, NoBoxes, BoxesOfHulls> boxes(world, body, several && quick);
  for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next) {
    ShapeRecord<D>& shape = world.shapes.at(s);
    if (shape.leaf == none) continue;
    if (farthest > double(shape.margin)) {  // with the way of the next step it has left them, or nearly so
      shape.flags |= shape_outgrown;
      any = true;
      least_below = least_above = P{};
      if (several) continue;
      look_at_bounds(world.bodies.motion[std::size_t(body)]);
      return true;
    }
    const typename D::Bounds fat = world.shapes.trees[shape.tree].bounds(shape.leaf);
    if (boxes.stay_within(shape, fat, least_below, least_above)) continue;
    const typename D::Bounds box = shape_bounds(world, shape);
    const P ahead = quick ? way_ahead(world, shape) : P{};
    if (geometry::contains(fat, box_along(box, ahead))) {
      least_below = math::min(least_below, box.low - fat.low);
      least_above = math::min(least_above, fat.high - box.high);
      continue;
    }
    shape.flags |= shape_outgrown;
    any = true;
    // It gets new ones in this step (update_trees), with so much room.
    const P reach = several ? bounds_ahead(world, shape) : ahead;
    for (int k = 0; k < D::dimension; ++k) {
      least_below[k] = min(least_below[k], double(shape.margin) + max(-reach[k], 0.0));
      least_above[k] = min(least_above[k], double(shape.margin) + max(reach[k], 0.0));
    }
  }
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  for (int k = 0; k < D::dimension; ++k) {
    m.room_below[k] = coarse(0.98f * float(least_below[k]));
    m.room_above[k] = coarse(0.98f * float(least_above[k]));
  }
  return any;
}

/// The next level of a body with joints (load.h): it rises slowly, because joints that gave way would throw up what
/// they carry, and falls fast once nothing presses.
template <class D>
std::uint16_t follow_jointed_load(const StepContext<D>& context, std::int32_t body, const BodyMotion<D>& m,
                                  const BodyLoad<D>& load, float pace, float gravity) {
  if (load.size < 0) return 0;
  if (load.size == 0) return std::uint16_t(max(int(m.load_level) - jointed_fall, 0));
  const WorldImplementation<D>& world = context.world;
  const typename D::Vector weight =
      (context.h * pace * pace) * (m.mass * m.gravity_scale * world.definition.gravity + m.force);
  const int level =
      min(int(follow_load(context, m, jointed_load<D>(load, weight), gravity)), int(m.load_level) + load_rise);
  return level > 0 ? min(std::uint16_t(level), Figure<D>(world, body).most_level(body)) : std::uint16_t(0);
}

/// The level of the body by its load. `gravity`: m/s², of what acts on it from afar.
template <class D>
static void follow_load_of(StepContext<D>& context, std::int32_t body, const BodyLoad<D>& load, float pace,
                           float gravity, std::vector<LoadWish>& wishes) {
  WorldImplementation<D>& world = context.world;
  BodyRecord& record = world.bodies.record[std::size_t(body)];
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  set_flag(record, body_pushed, !(m.force == typename D::Vector{}));
  const bool jointed = record.joint_count > 0;
  int level = 0;
  if (record.type == BodyType::dynamic)
    level =
        jointed ? follow_jointed_load(context, body, m, load, pace, gravity) : follow_load(context, m, load, gravity);
  if (level == 0 && m.load_level > free_level) {
    wishes.push_back({body, 0});
  } else if (level <= m.load_level) {
    m.load_level = std::uint16_t(level);
  } else {
    const int limit = jointed ? level : max(int(m.load_limit), free_level);
    m.load_level = std::uint16_t(max(int(m.load_level), min(level, limit)));
    // To ask costs a walk over all contacts.
    const auto now = std::uint16_t(world.step_count);
    if (level > limit && may_ask(std::uint16_t(now - m.load_asked))) {
      m.load_asked = now;
      wishes.push_back({body, m.mass * borne_as_it_is(m, gravity, context.contact_stiffness)});
    }
  }
}

/// Sleep, loads and bounds of the body at a place of the awake list, which has come to the end of the step. Returns
/// BodyChange.
template <class D>
static std::uint8_t finalize_body(StepContext<D>& context, int place, const BodyEnds& ends, int lane, float gravity,
                                  std::vector<LoadWish>& wishes) {
  WorldImplementation<D>& world = context.world;
  const std::int32_t body = world.bodies.awake[std::size_t(place)];
  BodyRecord& record = world.bodies.record[std::size_t(body)];
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  SolverBody<D>& s = world.bodies.solver[std::size_t(body)];
  const typename D::Pose& pose = world.bodies.pose[std::size_t(body)];
  const BodyLoad<D> load = world.scratch.loads[std::size_t(body)];
  world.scratch.loads[std::size_t(body)] = {};
  std::uint8_t change = 0;
  const float travel = ends.travel[lane], spin = ends.spin[lane];
  float surface_way = ends.surface_way[lane];
  if ((ends.whirling >> lane & 1) != 0) {
    const float slowed = min(1.0f, max_turn / (context.h * spin));
    const typename D::Angular whole = whole_turn(turn_of(D{}, ends, lane), s.angular_velocity, slowed * context.dt);
    world.scratch.swept[std::size_t(place)].turn = whole;
    surface_way = max(ends.turned[lane], spin_of(whole)) * m.outer_extent;
  }
  const bool bullet = (record.flags & body_bullet) != 0;
  if (world.definition.continuous && record.type == BodyType::dynamic && (record.flags & body_has_collider) != 0 &&
      travel + surface_way > (bullet ? 0.25f : 0.5f) * m.inner_extent) {
    record.flags |= body_fast;
    change = body_flew;
  }
  const float pace = world.bodies.pace(body);
  follow_load_of(context, body, load, pace, max(gravity, gravity_of(world.definition, m, pace, gravity)), wishes);
  m.force = {};
  m.torque = {};
  float speed = ends.speed[lane];
  // What is still being pushed out of an overlap is not at rest: that way is not in its velocity.
  const float pushed_squared = ends.pushed_squared[lane];
  const float sleep_speed = record.sleep_speed * pace;
  const bool may_sleep = record.sleep_speed > 0 && (record.flags & body_allow_sleep) != 0;
  const float slow = settling_speed * sleep_speed;
  if (may_sleep && world.definition.allow_sleep && load.size > 0 && spin > 0 && record.joint_count == 0 &&
      speed < slow) {
    const float radius = rolling_radius(world.shapes.at(record.first_shape).geometry, m.inner_extent);
    if (radius > 0) {
      settle(context, m, s, radius, load, 1 - speed / slow);
      speed = max(math::length(s.linear_velocity), D::dimension == 3 && m.slender != 0
                                                       ? way_of_turn(m, pose.rotation, s.angular_velocity)
                                                       : spin_of(s.angular_velocity) * max(m.outer_extent, 0.01f));
    }
  }
  if (may_sleep && speed < sleep_speed && pushed_squared < square(0.2f * sleep_speed))
    record.sleep_timer += context.dt * pace;
  else
    record.sleep_timer = 0;
  if (D::dimension == 3 && (record.locks >> 3 & 7) != 0) update_world_inertia(world, body);  // the others have it
  const bool near = bullet || (ends.near_bounds >> lane & 1) != 0;
  if (near) look_at_bounds(m);
  if (record.flags & body_fast) return change;  // its bounds wait for the end of its way
  return near && leave_bounds(world, body) ? std::uint8_t(body_outgrew) : change;
}

template <class D>
void finalize_bodies(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  StepScratch<D>& scratch = world.scratch;
  const std::size_t count = world.bodies.awake.size();
  scratch.body_changes.resize(count);
  scratch.swept.resize(count);
  const float gravity = math::length(world.definition.gravity);
  const int width = world.kernels.width;
  for (std::vector<LoadWish>& list : scratch.load_wishes) list.clear();
  context.scheduler.parallel_for(int(count), finalize_grain, [&](int begin, int end, int worker) {
    std::vector<LoadWish>& wishes = scratch.load_wishes[std::size_t(worker)];
    for (int first = begin; first < end; first += width) {
      const int lanes = min(width, end - first);
      const std::int32_t* const slots = &world.bodies.awake[std::size_t(first)];
      SweepStart<D>* const starts = &scratch.swept[std::size_t(first)];
      std::uint8_t* const changes = &scratch.body_changes[std::size_t(first)];
      StepEndTerms terms{context.dt, context.inverse_dt, 0};
      for (int k = 0; k < lanes; ++k) {
        const std::size_t body = std::size_t(slots[k]);
        BodyRecord& record = world.bodies.record[body];
        record.flags &= std::uint16_t(~body_fast);
        if (record.locks != 0) apply_locks(context.bodies[body], record.locks);  // the last pass may have moved them
        if (record.type == BodyType::dynamic && (record.locks & 0x38) == 0) terms.turning |= 1u << k;
        starts[k] = {world.bodies.pose[body].rotation, world.bodies.motion[body].center, {}, 1};
      }
      BodyEnds ends;
      world.kernels.bring_to_end(context.bodies, world.bodies.pose.data(), world.bodies.motion.data(), slots, lanes,
                                 terms, ends);
      for (int k = 0; k < lanes; ++k) {
        if ((ends.broken >> k & 1) != 0) {
          scratch.loads[std::size_t(slots[k])] = {};
          quarantine(world, slots[k]);
          changes[k] = body_broke;
        } else {
          changes[k] = finalize_body(context, first + k, ends, k, gravity, wishes);
        }
      }
    }
  });
  grant_loads(context);
  for (std::size_t i = 0; i < count; ++i)
    if (scratch.body_changes[i] == body_broke) {
      const std::int32_t body = world.bodies.awake[i];
      scratch.quarantined.push_back({world.bodies.slots.handle_at(body)});
      scratch.broken.push_back(body);
    }
}

template <class D>
void release_broken_bodies(WorldImplementation<D>& world) {
  for (const std::int32_t body : world.scratch.broken) {
    deactivate_body(world, body);
    for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
      const std::int32_t next = world.contacts.at(key >> 1).next[key & 1];
      destroy_contact(world, key >> 1, false);
      key = next;
    }
    for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next) {
      world.shapes.at(s).flags &= std::uint8_t(~shape_outgrown);
      remove_from_tree(world, s);
    }
  }
  world.scratch.broken.clear();
}

/// What a contact that may have been hit tells: an impulse of 0 where nothing is to be told.
template <class D>
static ContactHitEvent<D> hit_event(WorldImplementation<D>& world, const ContactRecord<D>& c) {
  ContactHitEvent<D> event{};
  for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) {
    ManifoldRecord<D>& record = world.contacts.manifold(m);
    const float approach_speed = std::exchange(record.approach_speed, 0.0f);  // not every step finds it anew
    float impulse = 0;
    for (int i = 0; i < record.manifold.count; ++i) impulse += record.impulses.total[i];
    if (approach_speed < bounce_threshold(world, c.body[0], c.body[1]) || impulse <= 0) continue;
    if (approach_speed > event.approach_speed) {
      typename D::Position points[D::max_points];
      float separations[D::max_points];
      contact_points_now(world, record, points, separations, event.normal);
      int strongest = 0;
      for (int i = 1; i < record.manifold.count; ++i)
        if (record.impulses.total[i] > record.impulses.total[strongest]) strongest = i;
      event.point = points[strongest];
      event.approach_speed = approach_speed;
      event.slip_speed = record.slip_speed;
      event.material_a = material_at(world, c.shape[0], record.manifold.material).user_id;
      event.material_b = material_at(world, c.shape[1], record.manifold.material).user_id;
    }
    event.impulse += impulse;
  }
  if (event.impulse <= 0) return {};
  // A foreseen contact may take a first breath of an impulse in the step before the blow: that is told when it falls.
  const auto velocity = [&](std::int32_t body) {
    const SolverBody<D>& s = world.bodies.solver[std::size_t(body)];
    const typename D::Vector arm(event.point - world.bodies.motion[std::size_t(body)].center);
    return s.linear_velocity + cross(s.angular_velocity, arm);
  };
  if (dot(event.normal, velocity(c.body[0]) - velocity(c.body[1])) > 0.5f * event.approach_speed) return {};
  event.shape_a = world.shapes.slots.handle_at(c.shape[0]);
  event.shape_b = world.shapes.slots.handle_at(c.shape[1]);
  return event;
}

template <class D>
void gather_hit_events(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  if (world.hit_event_shapes == 0) return;
  std::vector<std::int32_t>& hits = world.scratch.hits;
  if (hits.empty()) return;
  // From manifolds to contacts, in the order in which those are awake, each once.
  std::vector<std::uint8_t>& is_hit = world.scratch.contact_changes;
  is_hit.assign((world.contacts.awake.size() + 7) / 8 * 8, 0);
  world.scheduler->parallel_for(int(hits.size()), hit_grain, [&](int begin, int end, int) {
    const auto contact_of = [&](int k) -> const ContactRecord<D>& {
      return world.contacts.at(world.contacts.manifold(hits[std::size_t(k)]).contact);
    };
    for (int k = begin; k < end; ++k) {
      if (k + 16 < end) __builtin_prefetch(&world.contacts.manifold(hits[std::size_t(k) + 16]));
      if (k + 8 < end) __builtin_prefetch(&contact_of(k + 8).awake_index);
      // By all threads: all write the same.
      std::atomic_ref<std::uint8_t>(is_hit[std::size_t(contact_of(k).awake_index)]).store(1, std::memory_order_relaxed);
    }
  });
  hits.clear();
  for (std::size_t i = 0; i < world.contacts.awake.size(); i += 8) {
    std::uint64_t any;
    __builtin_memcpy(&any, &is_hit[i], 8);
    for (std::size_t k = i; any != 0 && k < i + 8; ++k)
      if (is_hit[k] != 0) hits.push_back(world.contacts.awake[k]);
  }
  std::vector<ContactHitEvent<D>>& events = world.scratch.contact_hit;
  events.resize(hits.size());
  world.scheduler->parallel_for(int(hits.size()), hit_grain, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) {
      if (k + 12 < end) prefetch_lines(&world.contacts.at(hits[std::size_t(k) + 12]), 64);
      if (k + 6 < end)
        if (const std::int32_t soon = world.contacts.at(hits[std::size_t(k) + 6]).first_manifold; soon != none)
          prefetch_lines(&world.contacts.manifold(soon), sizeof(ManifoldRecord<D>));
      events[std::size_t(k)] = hit_event(world, world.contacts.at(hits[std::size_t(k)]));
    }
  });
  std::erase_if(events, [](const ContactHitEvent<D>& event) { return !(event.impulse > 0); });
  hits.clear();
}
#define CAROM_INSTANTIATE(D)                                          \
  template void quarantine<D>(WorldImplementation<D>&, std::int32_t); \
  template void finalize_bodies<D>(StepContext<D>&);                  \
  template void release_broken_bodies<D>(WorldImplementation<D>&);    \
  template void gather_hit_events<D>(StepContext<D>&);                \
  template bool leave_bounds<D>(WorldImplementation<D>&, std::int32_t);
CAROM_INSTANTIATE(Dim2)
CAROM_INSTANTIATE(Dim3)
#undef CAROM_INSTANTIATE

}  // namespace carom::rigid::detail
