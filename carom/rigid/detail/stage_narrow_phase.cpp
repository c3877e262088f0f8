#include <algorithm>

#include "carom/rigid/detail/fly_past.h"
#include "carom/rigid/detail/found_contacts.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr int contact_grain = 128;
constexpr float touch_distance = 0.005f;  ///< m: surfaces nearer than this touch, for events
constexpr float recycle_share = 0.1f;     ///< of the smaller half thickness: manifolds stay while the pair slid less,
constexpr float rolling_share = 0.01f;    ///< and where something rolls

enum ContactChange : std::uint8_t {
  change_apart = 1,      ///< fat bounds no longer overlap
  change_manifolds = 2,  ///< new manifolds wait in the found list; the old ones go
  change_empty = 4,      ///< manifolds go, none come
  change_begin = 8,
  change_end = 16,
};

template <class D>
float smallest_separation(const typename D::Manifold& m) {
  float s = m.points[0].separation;
  for (int i = 1; i < m.count; ++i) s = min(s, m.points[i].separation);
  return s;
}

/// m: how far a pair may slide and turn until its manifolds are made anew. Where something is round, the point in which
/// it meets another moves over both, and the normal turns with it: a manifold kept over a way s is wrong by s²/2r, and
/// what rocks on it is lifted by as much at every new one.
template <class D>
float longest_way(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
  const float most = recycle_share * c.inner;
  return c.rolls ? min(most, max(rolling_share * c.inner, still_way(world, world.last_dt))) : most;
}

/// How far a turn (rad, times a scale) in its own frame moves the surface of a shape about its middle, at most: about
/// its long axis little. `ball`: m, about all of it.
float way_of_turn(const ShapeRecord<Dim2>& shape, float turn, float ball) {
  return shape.geometry.type == geometry::ShapeType2::circle ? 0 : math::abs(turn) * ball;
}
float way_of_turn(const ShapeRecord<Dim3>& shape, const Vec3f& turn, float ball) {
  const float most = math::length(turn) * ball;
  if (shape.geometry.type != geometry::ShapeType3::hull || ball < 2 * shape.inner_extent) return most;
  const Vec3f e = shape.geometry.hull->bounds.extents();
  const float rounding = math::length(turn) * shape.geometry.hull->radius;
  const Vec3f arms{math::sqrt(e.y * e.y + e.z * e.z), math::sqrt(e.z * e.z + e.x * e.x),
                   math::sqrt(e.x * e.x + e.y * e.y)};
  return min(most, dot(abs(turn), arms) + rounding);
}
/// m per radian: what a further turn adds to that at most, after one of `before` rad that took `way` of m. Where that
/// was less than all of the ball, other axes are not all alike, and turns about two of them are more than either.
float way_of_more(const ShapeRecord<Dim2>& shape, float, float, float ball) {
  return shape.geometry.type == geometry::ShapeType2::circle ? 0 : ball;
}
float way_of_more(const ShapeRecord<Dim3>& shape, const Vec3f& before, float way, float ball) {
  const float angle = math::length(before);
  if (!(way < angle * ball)) return ball;
  const geometry::Hull& hull = *shape.geometry.hull;
  return max(ball, 1.4143f * math::length(hull.bounds.extents()) * (1 + angle) + hull.radius);
}
/// Chords are twice this.
float half_chord(const Rot2f& a, const Rot2f& b) { return 0.5f * chord(a, b); }
Vec3f half_chord(const Quatf& a, const Quatf& b) { return (conjugate(a) * b).vector(); }

/// How far a point strays at most from the tangent of its way while its body turns (rad); what is slender may roll.
float bend_of(const BodyMotion<Dim2>&, float turn, const Vec2f& arm) { return 0.5f * turn * turn * math::length(arm); }
float bend_of(const BodyMotion<Dim3>& m, const Vec3f& turn, const Vec3f& arm) {
  const float angle = math::length(turn);
  return 0.5f * angle * (m.slender == 0 ? angle * math::length(arm) : math::length(cross(turn, arm)));
}

/// How B moved, seen from A, from when its manifolds were made to `now`: its middle, and its surface about that by the
/// turn, at most.
template <class D>
struct Moved {
  typename D::Vector way;
  float turn;
  float extent;  ///< m per radian of what it turns from here

  Moved(const ContactRecord<D>& c, const ShapeRecord<D>& b, const typename D::Transform& now) {
    const typename D::Vector middle = ball_about(b).middle;
    way = transform_point(now, middle) - transform_point(c.base, middle);
    const auto half = half_chord(c.base.q, now.q);
    const float half_way = way_of_turn(b, half, c.extent);
    turn = 2 * half_way;
    extent = way_of_more(b, half, half_way, c.extent);
  }
  /// An upper bound for any point of B.
  float most() const { return math::length(way) + turn; }
  /// The same without what is along the normal: approach and parting change separations only.
  float across(const typename D::Vector& normal) const { return math::length(way - normal * dot(normal, way)) + turn; }
};

/// A turn of the world in a shape's frame.
float in_frame(const Rot2f&, float turn) { return turn; }
Vec3f in_frame(const Quatf& frame, const Vec3f& turn) { return inverse_rotate(frame, turn); }

/// How B's shape goes past A in this step by the velocities of their bodies, seen from A: its middle, and what the
/// turns add to that anywhere in it. Long bodies turn fast at their ends only.
template <class D>
BodySweep<D> sweep_of_shape(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
  const ShapeRecord<D>& shape = world.shapes.at(c.shape[1]);
  const typename D::Pose pose = shape_pose(world, shape);
  const typename D::Position middle = world_point(pose, ball_about(shape).middle);
  BodySweep<D> sweep;
  for (int side = 0; side < 2; ++side) {
    const std::size_t body = std::size_t(c.body[side]);
    const SolverBody<D>& s = world.bodies.solver[body];
    const typename D::Vector arm = typename D::Vector(middle - world.bodies.motion[body].center);
    const typename D::Vector way = (s.linear_velocity + cross(s.angular_velocity, arm)) * world.last_dt;
    sweep.way = side == 0 ? sweep.way - way : sweep.way + way;
    const typename D::Angular turn = s.angular_velocity * world.last_dt;
    sweep.turning +=
        way_of_turn(shape, in_frame(pose.rotation, turn), c.extent) + bend_of(world.bodies.motion[body], turn, arm);
  }
  return sweep;
}
/// The same, found when it is first asked for.
template <class D>
struct ShapeSweep {
  BodySweep<D> sweep;
  bool known = false;

  const BodySweep<D>& of(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
    if (!known) sweep = sweep_of_shape(world, c), known = true;
    return sweep;
  }
};
/// How far the surfaces of the bodies may come nearer in this step; where nothing bounces, half their thickness is
/// enough.
template <class D>
float way_of_bodies(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
  const std::vector<BodySweep<D>>& sweeps = world.scratch.sweeps;
  const float least = way_between(sweeps[std::size_t(c.body[0])], sweeps[std::size_t(c.body[1])], world.last_dt);
  return (c.flags & contact_bouncy) != 0 ? least : min(least, 0.5f * c.inner);
}
/// Calls way(sweep) for the sweep of the bodies and, where they turn, for that of the shape: both are bounds.
template <class D, class Way>
float least_way(const WorldImplementation<D>& world, const ContactRecord<D>& c, ShapeSweep<D>& shape, Way&& way) {
  const std::vector<BodySweep<D>>& sweeps = world.scratch.sweeps;
  const BodySweep<D>&a = sweeps[std::size_t(c.body[0])], &b = sweeps[std::size_t(c.body[1])];
  const float turning = min(a.turning + b.turning, most_turning * world.last_dt);
  float least = way(BodySweep<D>{b.way - a.way, turning});
  if (turning > 0.1f * c.inner) least = min(least, way(shape.of(world, c)));
  return (c.flags & contact_bouncy) != 0 ? least : min(least, 0.5f * c.inner);
}

/// How far the surfaces of the pair may come nearer in this step. Contacts are foreseen that far, so that impacts
/// happen at the surface, with the energy a body has there; those that do not bounce look no farther than half their
/// thickness.
template <class D>
float look_ahead(const WorldImplementation<D>& world, const ContactRecord<D>& c, ShapeSweep<D>& shape) {
  return least_way(world, c, shape, [](const BodySweep<D>& s) { return math::length(s.way) + s.turning; });
}
/// The same for a contact with this normal (in the frame of A's shape): what counts is what closes along it.
template <class D>
float look_ahead(const WorldImplementation<D>& world, const ContactRecord<D>& c, ShapeSweep<D>& shape,
                 typename D::Vector normal) {
  if ((c.flags & contact_at_origin) == 0) normal = rotate(world.shapes.at(c.shape[0]).local.q, normal);
  normal = rotate(world.bodies.pose[std::size_t(c.body[0])].rotation, normal);
  return least_way(world, c, shape, [&](const BodySweep<D>& s) { return max(s.turning - dot(normal, s.way), 0.0f); });
}
/// How B's shape goes past A in this step, in the frame of A's.
geometry::detail::ShapeWay approach_of(const WorldImplementation<Dim3>& world, const ContactRecord<Dim3>& c,
                                       float reach) {
  geometry::detail::ShapeWay approach;
  const ShapeRecord<Dim3>& shape = world.shapes.at(c.shape[1]);
  const Dim3::Pose pose = shape_pose(world, shape);
  const ShapeBall<Dim3> ball = ball_about(shape);
  const Vec3f to_middle = rotate(pose.rotation, ball.middle);
  for (int side = 0; side < 2; ++side) {
    const std::size_t body = std::size_t(c.body[side]);
    const SolverBody<Dim3>& s = world.bodies.solver[body];
    const Vec3f arm = Vec3f(pose.position - world.bodies.motion[body].center),
                turn = s.angular_velocity * world.last_dt;
    const Vec3f way = s.linear_velocity * world.last_dt + cross(turn, arm);
    approach.way = side == 0 ? approach.way - way : approach.way + way;
    approach.turn = side == 0 ? approach.turn - turn : approach.turn + turn;
    approach.bend +=
        bend_of(world.bodies.motion[body], turn, arm + to_middle) + 0.5f * length_squared(turn) * ball.radius;
  }
  const Quatf frame = shape_pose(world, world.shapes.at(c.shape[0])).rotation;
  approach.way = inverse_rotate(frame, approach.way), approach.turn = inverse_rotate(frame, approach.turn);
  // What moves fast is looked at again in the next step anyway.
  const float margin = c.margin(), ahead = reach - 2 * margin;
  approach.margin = margin + clamp(margin - ahead, 0.0f, margin);
  approach.worth = margin + 3 * ahead;  // two steps
  return approach;
}
/// m: how far a pair that is apart along an axis may move until it is looked at whether its bounds still meet.
template <class D>
float longest_slide(const ContactRecord<D>& c) {
  return (D::dimension == 2 ? 1.0f : 0.5f) * c.inner;
}
/// How much nearer B may still come to A until the pair is of interest; what it may do in this step not
/// counted. Apart from each other along an axis, they may slide past each other, but are looked at now and then, so
/// that pairs end whose bounds have parted.
template <class D>
float slack_of(const ContactRecord<D>& c, const Moved<D>& moved) {
  const float slack = c.gap - c.margin();
  if (c.axis == typename D::Vector{}) return slack - moved.most();
  if (moved.most() >= longest_slide(c)) return -1e30f;
  return slack + dot(c.axis, moved.way) - moved.turn;
}

/// The touch flag, with hysteresis: begins within the touch distance, ends when the manifolds are gone or beyond twice
/// it.
template <class D>
std::uint8_t touch_change(ContactRecord<D>& c, float separation, bool pressed) {
  const bool was = (c.flags & contact_touching) != 0;
  const bool is = separation < (was ? 2 * touch_distance : touch_distance) || pressed;
  if (is == was) return 0;
  c.flags ^= contact_touching;
  return is ? change_begin : change_end;
}

template <class D>
bool pressed(const ManifoldRecord<D>& m) {
  for (int i = 0; i < D::max_points; ++i)
    if (m.impulses.normal[i] > 0) return true;
  return false;
}

template <class D>
bool pressed_any(const ContactStore<D>& store, const ContactRecord<D>& c) {
  for (std::int32_t m = c.first_manifold; m != none; m = store.manifold(m).next)
    if (pressed(store.manifold(m))) return true;
  return false;
}

/// Parts are named by their triangle, cell or child; what they are made of may change (edits).
template <class D>
bool same_patch(const ManifoldRecord<D>& m, std::uint32_t child, const typename D::Manifold& found) {
  return m.manifold.child == child && m.manifold.material == found.material;
}

template <class D>
std::uint8_t update_sensor(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                           const ShapeRecord<D>& b, const typename D::Transform& b_in_a) {
  if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf)))
    return change_apart;
  const bool is = geometry::overlap(a.geometry, b.geometry, b_in_a), was = (c.flags & contact_touching) != 0;
  if (is == was) return 0;
  c.flags ^= contact_touching;
  return is ? change_begin : change_end;
}

/// The watch on a pair that has just been looked at; the caller says what it watches for.
template <class D>
ContactWatch<D>& watch_contact(WorldImplementation<D>& world, const ContactRecord<D>& c,
                               const typename D::Vector& normal, float extent) {
  const std::int32_t a = c.body[0], b = c.body[1];
  ContactWatch<D>& w = world.scratch.watches[std::size_t(c.awake_index)];
  w.body[0] = a, w.body[1] = b;
  w.base = relative(world.bodies.pose[std::size_t(a)], world.bodies.pose[std::size_t(b)]);
  const bool at_origin = (c.flags & contact_at_origin) != 0;
  w.normal = at_origin ? normal : rotate(world.shapes.at(c.shape[0]).local.q, normal);
  const ShapeRecord<D>& shape = world.shapes.at(c.shape[1]);
  w.middle = ball_about(shape).middle;
  if (!at_origin) w.middle = transform_point(shape.local, w.middle);
  w.extent = extent;
  return w;
}
/// Rounding must not let a watch hold a moment longer than the exact test.
template <class D>
float rounding_of(const ContactWatch<D>& w) {
  return 1e-5f + 1e-6f * (math::length(w.base.p) + math::length(w.middle));
}
template <class D>
void watch_apart(WorldImplementation<D>& world, const ContactRecord<D>& c, const Moved<D>& moved) {
  ContactWatch<D>& w = watch_contact(world, c, c.axis, moved.extent);
  w.gap = slack_of(c, moved) - rounding_of(w);
  w.cap = (c.flags & contact_bouncy) != 0 ? 3.4e38f : 0.5f * c.inner;
  w.most_way = 0;
  if (c.axis == typename D::Vector{}) return;
  w.most_way = longest_slide(c) - moved.most() - rounding_of(w);
  if (!(w.most_way > 0)) w.body[0] = none;
}
/// What touches is watched until it parts; in the plane, what does not until it comes near or bears a load
/// (store_contacts).
template <class D>
void watch_recycled(WorldImplementation<D>& world, const ContactRecord<D>& c, float slack, float separation,
                    const typename D::Vector& normal, float extent) {
  const bool touching = (c.flags & contact_touching) != 0;
  if (c.first_manifold != none) world.contacts.manifold(c.first_manifold).waits = !touching;
  if (!touching && (D::dimension == 3 || c.manifold_count != 1)) return;
  ContactWatch<D>& w = watch_contact(world, c, normal, extent);
  const float most = touching ? min(c.margin(), 2 * touch_distance) : c.margin(), rounding = rounding_of(w);
  w.most_way = slack - rounding;
  w.gap = separation - most + rounding;
  w.cap = touching ? -3.4e38f : touch_distance - most + 2 * rounding;
  if (!(w.most_way > 0 && w.cap < 0)) w.body[0] = none;
}

/// Finds how far bodies may come in the step.
template <class D>
void measure_sweeps(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  if (scratch.watches.size() != world.contacts.awake.size()) scratch.watches.assign(world.contacts.awake.size(), {});
  if (world.contacts.awake.empty()) return;
  scratch.sweeps.resize(world.bodies.pose.size());
  for (const std::int32_t body : scratch.sweeping) scratch.sweeps[std::size_t(body)] = {};
  scratch.sweeping.assign(world.bodies.awake.begin(), world.bodies.awake.end());
  world.scheduler->parallel_for(int(world.bodies.awake.size()), 512, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const std::size_t body = std::size_t(world.bodies.awake[std::size_t(i)]);
      const SolverBody<D>& s = world.bodies.solver[body];
      scratch.sweeps[body] = {
          s.linear_velocity * world.last_dt,
          reach_of_turn(world.bodies.motion[body], world.bodies.pose[body].rotation, s.angular_velocity) *
              world.last_dt};
    }
  });
}

/// Do two that slid past each other, apart along an axis, have their bounds still meet and that axis still between
/// them? Then they go on from here, without being asked how far they are.
template <class D>
bool slides_on(WorldImplementation<D>& world, ContactRecord<D>& c, const Moved<D>& moved,
               const typename D::Transform& now, ShapeSweep<D>& sweep) {
  if (D::dimension == 3 || c.axis == typename D::Vector{} || moved.most() < longest_slide(c)) return false;
  const float gap = c.gap + dot(c.axis, moved.way) - moved.turn;
  if (!(look_ahead(world, c, sweep, c.axis) < gap - c.margin())) return false;
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf))) return false;
  c.gap = gap;
  c.base = now;
  watch_apart(world, c, Moved<D>(c, b, now));
  return true;
}

/// Is all that is known of a contact still true, now that B is there seen from A? Then only its flags follow.
template <class D>
bool stays(WorldImplementation<D>& world, ContactRecord<D>& c, const typename D::Transform& now, float ahead,
           ShapeSweep<D>& sweep, std::uint8_t& change) {
  if ((c.flags & contact_known) == 0 || (c.first_manifold != none && (c.flags & contact_round) != 0)) return false;
  const Moved<D> moved(c, world.shapes.at(c.shape[1]), now);
  if (c.first_manifold == none) {
    if (slides_on(world, c, moved, now, sweep)) return true;
    const float near = c.axis == typename D::Vector{} ? ahead : look_ahead(world, c, sweep, c.axis);
    if (!(near < slack_of(c, moved))) return false;
    watch_apart(world, c, moved);
    return true;
  }
  // Contact recycling, after Box2D 3.1 and Box3D: while a pair hardly moves, its manifolds are kept and only their
  // separations follow. What moves along the normal changes nothing else; the bound is on sliding and turning, and
  // far below the size of features, so that nothing sticks to a stale edge.
  const typename D::Manifold& m = world.contacts.manifold(c.first_manifold).manifold;
  const typename D::Vector normal = m.normal;
  const float separation = c.gap + dot(normal, moved.way), far = moved.across(normal);
  const float most = longest_way(world, c);
  if (!(separation < c.margin() && far < most)) return false;
  c.flags |= contact_recycled;
  change = touch_change(c, separation, pressed_any(world.contacts, c));
  watch_recycled(world, c, most - far, separation, normal, moved.extent);
  return true;
}

/// A contact whose shapes were found to be `c.gap` apart.
template <class D>
std::uint8_t part(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                  const ShapeRecord<D>& b) {
  std::uint8_t change = 0;
  if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf)))
    change = change_apart;
  else if (c.first_manifold != none)
    change = change_empty;
  else
    watch_apart(world, c, Moved<D>(c, b, c.base));
  return std::uint8_t(change | touch_change(c, c.gap, false));
}

/// How far the points of a manifold that was just made close in this step by the velocities that their bodies have
/// there. A turn bends their ways.
template <class D>
float look_ahead(const WorldImplementation<D>& world, const ContactRecord<D>& c, const typename D::Manifold& m) {
  using V = typename D::Vector;
  const ShapeRecord<D>& shape = world.shapes.at(c.shape[0]);
  const typename D::Pose pose = shape_pose(world, shape);
  const V normal = rotate(pose.rotation, m.normal);
  float farthest = -1e30f;
  for (int i = 0; i < m.count; ++i) {
    const typename D::Position point = world_point(pose, m.points[i].point);
    float closing = 0;
    for (int side = 0; side < 2; ++side) {
      const std::size_t body = std::size_t(c.body[side]);
      const SolverBody<D>& s = world.bodies.solver[body];
      const V arm = V(point - world.bodies.motion[body].center);
      const float way = dot(normal, s.linear_velocity + cross(s.angular_velocity, arm)) * world.last_dt;
      closing += (side == 0 ? way : -way) + bend_of(world.bodies.motion[body], s.angular_velocity * world.last_dt, arm);
    }
    farthest = max(farthest, closing - m.points[i].separation);
  }
  return farthest + smallest_separation<D>(m);
}

/// Nearer than the margin, or so near that they may meet in this step?
template <class D>
bool of_interest(const WorldImplementation<D>& world, const ContactRecord<D>& c, ShapeSweep<D>& sweep,
                 const typename D::Manifold& m, float separation) {
  if (separation <= c.margin()) return true;
  if (separation > c.margin() + look_ahead(world, c, sweep, m.normal)) return false;
  return separation <= c.margin() + look_ahead(world, c, m);
}

/// The normal of a manifold as the axis along which the shapes are apart. That of a manifold may be bent (over_border).
void go_on_apart(ContactRecord<Dim2>& c, const ShapeRecord<Dim2>& a, const ShapeRecord<Dim2>& b,
                 const Dim2::Manifold& m) {
  const Vec2f back = inverse_rotate(c.base.q, -m.normal);
  const float apart = dot(m.normal, transform_point(c.base, support(b.geometry, back)) - support(a.geometry, m.normal));
  if (!(apart > c.margin())) return;
  c.axis = m.normal;
  c.gap = min(c.gap, apart);
}
void go_on_apart(ContactRecord<Dim3>&, const ShapeRecord<Dim3>&, const ShapeRecord<Dim3>&, const Dim3::Manifold&) {}

/// Two convex shapes, or a plane: one manifold at most.
template <class D>
std::uint8_t update_convex(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                           const ShapeRecord<D>& b, float reach, ShapeSweep<D>& sweep,
                           std::vector<FoundManifold<D>>& list) {
  typename D::Manifold m;
  geometry::collide(a.geometry, b.geometry, c.base, reach, c.cache, m);
  c.gap = reach;
  c.axis = {};
  if (m.count == 0) {
    // Pairs are to be looked at before they leave each other's bounds for good.
    c.gap = max(reach, min(m.points[0].separation, reach + 0.25f * c.inner));
    c.axis = m.normal;
    return part(world, c, a, b);
  }
  const float separation = smallest_separation<D>(m);
  c.gap = min(reach, separation);
  if (!of_interest(world, c, sweep, m, separation)) {
    go_on_apart(c, a, b, m);
    return part(world, c, a, b);
  }
  const std::uint8_t change = touch_change(c, c.gap, pressed_any(world.contacts, c));
  const bool waits = D::dimension == 2 && c.manifold_count == 1;
  if ((c.flags & contact_round) == 0 && ((c.flags & contact_touching) != 0 || waits) && c.gap < c.margin()) {
    c.flags |= contact_recycled;  // in the steps to come, which may not look at it, and why not in this one
    watch_recycled(world, c, longest_way(world, c), c.gap, m.normal, c.extent);
  }
  if (c.first_manifold == none) {
    list.push_back({c.awake_index, 0, 0, m});
    return std::uint8_t(change | change_manifolds);
  }
  ManifoldRecord<D>& record = world.contacts.manifold(c.first_manifold);
  carry_impulses<D>(record.manifold, m, 0.2f * c.inner, record.impulses);
  record.manifold = m;
  return change;
}

/// One of the shapes has many parts.
template <class D>
std::uint8_t update_many(WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                         const ShapeRecord<D>& b, float reach, ShapeSweep<D>& sweep,
                         std::vector<FoundManifold<D>>& list) {
  ContactStore<D>& store = world.contacts;
  Found<D> found;
  if constexpr (D::dimension == 3)
    collide_all(a.geometry, b.geometry, c.base, reach, approach_of(world, c, reach), found);
  else
    collide_all(a.geometry, b.geometry, c.base, reach, found);
  c.gap = found.count == 0 ? found.apart : reach;
  c.axis = {};
  int kept = 0;
  for (int i = 0; i < found.count; ++i) {
    const float s = smallest_separation<D>(found.manifold[i]);
    c.gap = min(c.gap, s);
    if (!of_interest(world, c, sweep, found.manifold[i], s)) continue;
    if (kept != i) {
      found.manifold[kept] = found.manifold[i];
      found.child[kept] = found.child[i];
    }
    ++kept;
  }
  if (kept == 0 && found.count > 0 && found.near > 0) c.gap = min(c.gap, found.near);
  found.count = kept;
  if (found.count == 0) return part(world, c, a, b);
  int matched = 0;
  for (std::int32_t m = c.first_manifold; m != none; m = store.manifold(m).next) {
    for (int i = 0; i < found.count; ++i)
      if (same_patch(store.manifold(m), found.child[i], found.manifold[i])) {
        ++matched;
        break;
      }
  }
  const std::uint8_t change = touch_change(c, c.gap, pressed_any(store, c));
  if (matched == found.count && matched == c.manifold_count) {
    for (std::int32_t m = c.first_manifold; m != none; m = store.manifold(m).next) {
      ManifoldRecord<D>& record = store.manifold(m);
      for (int i = 0; i < found.count; ++i)
        if (same_patch(record, found.child[i], found.manifold[i])) {
          carry_impulses<D>(record.manifold, found.manifold[i], 0.2f * c.inner, record.impulses);
          record.manifold = found.manifold[i];
          break;
        }
    }
    return change;
  }
  for (int i = 0; i < found.count; ++i) list.push_back({c.awake_index, i, found.child[i], found.manifold[i]});
  return std::uint8_t(change | change_manifolds);
}

/// Do two that go far past each other in this step stay apart, by the velocities that their bodies have? Those whose
/// way is shorter than twice the thickness of the thinner have their surfaces asked.
bool goes_past(const WorldImplementation<Dim2>&, const ContactRecord<Dim2>&, const ShapeRecord<Dim2>&,
               const ShapeRecord<Dim2>&) {
  return false;
}
bool goes_past(const WorldImplementation<Dim3>& world, const ContactRecord<Dim3>& c, const ShapeRecord<Dim3>& a,
               const ShapeRecord<Dim3>& b) {
  const std::vector<BodySweep<Dim3>>& sweeps = world.scratch.sweeps;
  const Vec3f way = sweeps[std::size_t(c.body[1])].way - sweeps[std::size_t(c.body[0])].way;
  if (!(math::length_squared(way) > square(4 * c.inner))) return false;
  const Vec3d base = world.bodies.motion[std::size_t(c.body[0])].center;
  const auto way_of = [&](const ShapeRecord<Dim3>& shape) {
    const BodyMotion<Dim3>& m = world.bodies.motion[std::size_t(shape.body)];
    const SolverBody<Dim3>& s = world.bodies.solver[std::size_t(shape.body)];
    const Dim3::Pose pose = shape_pose(world, shape);
    const ShapeBall<Dim3> ball = ball_about(shape);
    const Vec3d middle = world_point(pose, ball.middle);
    const Vec3f arm = Vec3f(middle - m.center), turn = s.angular_velocity * world.last_dt;
    const float angle = math::length(turn), reach = math::length(arm);
    const Vec3f from(middle - base), along = s.linear_velocity * world.last_dt;
    // What turns far about another point stays in a ball about that.
    if (angle > 1.4f) return BallWay{from - arm, along, pose.rotation, ball.radius + reach, 0, 1e15f};
    return BallWay{from,        along + cross(turn, arm),     pose.rotation,
                   ball.radius, 0.5f * angle * angle * reach, angle * ball.radius};
  };
  return fly_past(a.geometry, b.geometry, way_of(a), way_of(b), 2 * c.margin());
}

/// What flies past meets nothing in this step.
template <class D>
std::uint8_t pass_by(const WorldImplementation<D>& world, ContactRecord<D>& c, const ShapeRecord<D>& a,
                     const ShapeRecord<D>& b) {
  c.flags = std::uint16_t(c.flags & ~(contact_recycled | contact_known));
  c.gap = 0;
  c.axis = {};
  std::uint8_t change = 0;
  if (!overlaps(world.shapes.trees[a.tree].bounds(a.leaf), world.shapes.trees[b.tree].bounds(b.leaf)))
    change = change_apart;
  else if (c.first_manifold != none)
    change = change_empty;
  return std::uint8_t(change | touch_change(c, 1e30f, false));
}

/// Recomputes one contact. Writes only to the contact, its manifolds and the worker's list.
template <class D>
std::uint8_t update_contact(WorldImplementation<D>& world, std::int32_t awake_index,
                            std::vector<FoundManifold<D>>& list) {
  ContactRecord<D>& c = world.contacts.at(world.contacts.awake[std::size_t(awake_index)]);
  const ShapeRecord<D>&a = world.shapes.at(c.shape[0]), &b = world.shapes.at(c.shape[1]);
  world.scratch.watches[std::size_t(awake_index)].body[0] = none;  // an old one knows nothing of what changes now
  // What is known and stays comes first, as watches ask for nothing else; of what is not known, this saves all the
  // rest.
  const bool known = (c.flags & contact_known) != 0, sensor = (c.flags & contact_sensor) != 0;
  if (!known && !sensor && goes_past(world, c, a, b)) return pass_by(world, c, a, b);
  typename D::Transform b_in_a;
  if (c.flags & contact_at_origin)
    b_in_a = relative(world.bodies.pose[std::size_t(c.body[0])], world.bodies.pose[std::size_t(c.body[1])]);
  else
    b_in_a = relative(shape_pose(world, a), shape_pose(world, b));
  if (sensor) return update_sensor(world, c, a, b, b_in_a);

  ShapeSweep<D> sweep;
  // What has a manifold in the plane is told that more may be near than the sweep of its shape would say: it is asked
  // how near its points are anyway.
  const bool touched = D::dimension == 2 && c.first_manifold != none && (c.flags & contact_many) == 0;
  const float ahead = touched ? way_of_bodies(world, c) : look_ahead(world, c, sweep), reach = 2 * c.margin() + ahead;
  std::uint8_t change = 0;
  if (stays(world, c, b_in_a, ahead, sweep, change)) return change;
  if (known && goes_past(world, c, a, b)) return pass_by(world, c, a, b);
  c.flags = std::uint16_t((c.flags & ~contact_recycled) | contact_known);
  c.base = b_in_a;
  return (c.flags & contact_many) != 0 ? update_many(world, c, a, b, reach, sweep, list)
                                       : update_convex(world, c, a, b, reach, sweep, list);
}

/// Replaces the manifolds of a contact by those found; children that stay keep their impulses and place.
template <class D>
void replace_manifolds(WorldImplementation<D>& world, std::int32_t contact, std::span<const FoundManifold<D>> found) {
  ContactStore<D>& store = world.contacts;
  for (std::int32_t m = store.at(contact).first_manifold; m != none;) {
    const std::int32_t next = store.manifold(m).next;
    bool stays = false;
    for (const FoundManifold<D>& f : found) stays = stays || same_patch(store.manifold(m), f.child, f.manifold);
    if (!stays) remove_manifold(world, m);
    m = next;
  }
  for (const FoundManifold<D>& f : found) {
    std::int32_t m = store.at(contact).first_manifold;
    while (m != none && !same_patch(store.manifold(m), f.child, f.manifold)) m = store.manifold(m).next;
    if (m == none) {
      add_manifold(world, contact, f.manifold, f.child);
    } else {
      ManifoldRecord<D>& record = store.manifold(m);
      carry_impulses<D>(record.manifold, f.manifold, 0.2f * store.at(contact).inner, record.impulses);
      record.manifold = f.manifold;
    }
  }
}

template <class D>
void send_touch_event(WorldImplementation<D>& world, const ContactRecord<D>& c, bool begin) {
  const ShapeId a = world.shapes.slots.handle_at(c.shape[0]), b = world.shapes.slots.handle_at(c.shape[1]);
  StepScratch<D>& scratch = world.scratch;
  if (c.flags & contact_sensor) {
    const bool first = (world.shapes.at(c.shape[0]).flags & shape_sensor) != 0;
    (begin ? scratch.sensor_begin : scratch.sensor_end).push_back(first ? SensorEvent{a, b} : SensorEvent{b, a});
  } else if (c.flags & contact_events) {
    if (begin) {
      std::uint32_t part = 0;
      float deepest = 1e30f;
      for (std::int32_t m = c.first_manifold; m != none; m = world.contacts.manifold(m).next) {
        const typename D::Manifold& manifold = world.contacts.manifold(m).manifold;
        const float depth = smallest_separation<D>(manifold);
        if (depth < deepest) deepest = depth, part = manifold.material;
      }
      scratch.contact_begin.push_back(
          {a, b, material_at(world, c.shape[0], part).user_id, material_at(world, c.shape[1], part).user_id});
    } else {
      scratch.contact_end.push_back({a, b});
    }
  }
}

template <class D>
void apply_change(WorldImplementation<D>& world, std::size_t i, std::size_t& next_found) {
  StepScratch<D>& scratch = world.scratch;
  const std::uint8_t change = scratch.contact_changes[i];
  const std::int32_t contact = world.contacts.awake[i];
  if (change & change_begin) {
    scratch.new_touches.push_back(contact);  // who fell asleep close by, but apart, has a manifold already
  }
  if (change & change_end) send_touch_event(world, world.contacts.at(contact), false);
  if (change & change_apart) {
    scratch.doomed_contacts.push_back(contact);
  } else if (change & change_empty) {
    replace_manifolds<D>(world, contact, {});
  } else if (change & change_manifolds) {
    const std::size_t first = next_found;
    while (next_found < scratch.manifolds.size() && scratch.manifolds[next_found].awake_index == std::int32_t(i))
      ++next_found;
    const bool was_empty = world.contacts.at(contact).first_manifold == none;
    replace_manifolds<D>(world, contact, std::span(scratch.manifolds).subspan(first, next_found - first));
    if (was_empty) scratch.new_touches.push_back(contact);
  }
  if (change & change_begin) send_touch_event(world, world.contacts.at(contact), true);
}

}  // namespace

template <class D>
void update_contacts(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  const std::size_t count = world.contacts.awake.size();
  scratch.contact_changes.resize((count + 7) / 8 * 8);
  std::fill(scratch.contact_changes.begin(), scratch.contact_changes.end(), std::uint8_t(0));
  for (std::vector<FoundManifold<D>>& list : scratch.found_manifolds) list.clear();
  measure_sweeps(world);
  world.scheduler->parallel_for(int(count), contact_grain, [&](int begin, int end, int worker) {
    std::int32_t due[contact_grain];
    while (begin < end) {
      const int stop = min(begin + contact_grain, end);
      int number = 0;
      const int width = world.kernels.width;
      for (; begin < stop; begin += width) {
        const int lanes = min(width, stop - begin);
        std::uint32_t old = 0;  // bits by lane
        for (int lane = 0; lane < lanes; ++lane) {
          const ContactWatch<D>& soon = scratch.watches[std::size_t(min(begin + width + lane, stop - 1))];
          if (soon.body[0] == none) continue;
          for (const std::int32_t body : soon.body) {
            __builtin_prefetch(&world.bodies.pose[std::size_t(body)]);
            __builtin_prefetch(&scratch.sweeps[std::size_t(body)]);
          }
        }
        if (world.kernels.nothing_new != nullptr) {
          old = world.kernels.nothing_new(&scratch.watches[std::size_t(begin)], lanes, world.bodies.pose.data(),
                                          scratch.sweeps.data(), world.last_dt);
        } else {
          for (int lane = 0; lane < lanes; ++lane)
            old |= std::uint32_t(nothing_new(scratch.watches[std::size_t(begin) + std::size_t(lane)], world.bodies.pose,
                                             scratch.sweeps, world.last_dt))
                   << lane;
        }
        for (int lane = 0; lane < lanes; ++lane) {
          if ((old >> lane & 1u) != 0) continue;
          prefetch_lines(&world.contacts.at(world.contacts.awake[std::size_t(begin) + std::size_t(lane)]),
                         sizeof(ContactRecord<D>));
          due[number++] = begin + lane;
        }
      }
      const auto look_at_soon = [&](int k) __attribute__((always_inline)) {  // as prefetch_lines
        const ContactRecord<D>& soon = world.contacts.at(world.contacts.awake[std::size_t(due[k])]);
        for (const std::int32_t body : soon.body) __builtin_prefetch(&world.bodies.pose[std::size_t(body)]);
        for (const std::int32_t shape : soon.shape)
          prefetch_lines(&world.shapes.at(shape), D::dimension == 2 ? sizeof(ShapeRecord<D>) - 16 : 192);
        if (soon.first_manifold != none)
          prefetch_lines(&world.contacts.manifold(soon.first_manifold), ManifoldRecord<D>::hot_bytes);
      };
      for (int k = 0; k < min(6, number); ++k) look_at_soon(k);
      for (int k = 0; k < number; ++k) {
        if (k + 6 < number) look_at_soon(k + 6);
        scratch.contact_changes[std::size_t(due[k])] =
            update_contact(world, due[k], scratch.found_manifolds[std::size_t(worker)]);
      }
    }
  });
  level_room(scratch.found_manifolds);
  scratch.manifolds.clear();
  for (const std::vector<FoundManifold<D>>& list : scratch.found_manifolds)
    scratch.manifolds.insert(scratch.manifolds.end(), list.begin(), list.end());
  // Workers take chunks as they come.
  if (scratch.found_manifolds.size() > 1)
    std::sort(scratch.manifolds.begin(), scratch.manifolds.end(), [](const auto& l, const auto& r) {
      return l.awake_index != r.awake_index ? l.awake_index < r.awake_index : l.ordinal < r.ordinal;
    });

  scratch.doomed_contacts.clear();
  scratch.new_touches.clear();
  std::size_t next_found = 0;
  for (std::size_t block = 0; block < count; block += 8) {
    std::uint64_t any;
    __builtin_memcpy(&any, &scratch.contact_changes[block], 8);
    if (any == 0) continue;
    for (std::size_t i = block; i < min(block + 8, count); ++i)
      if (scratch.contact_changes[i] != 0) apply_change(world, i, next_found);
  }
  for (const std::int32_t contact : scratch.doomed_contacts) destroy_contact(world, contact, false);
  // A new contact wakes whoever slept.
  for (const std::int32_t contact : scratch.new_touches) {
    const ContactRecord<D>& c = world.contacts.at(contact);
    if (c.first_manifold == none) continue;
    const std::int32_t a = c.body[0], b = c.body[1];
    for (const std::int32_t body : {a, b})
      if (world.bodies.record[std::size_t(body)].awake_index == none && !world.bodies.is_fixed(body))
        wake_body(world, body);
  }
}

template void update_contacts<Dim2>(WorldImplementation<Dim2>&);
template void update_contacts<Dim3>(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
