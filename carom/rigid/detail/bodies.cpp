#include "carom/rigid/detail/bodies.h"

#include <algorithm>

#include "carom/geometry/detail/passage.h"
#include "carom/rigid/detail/contacts.h"
#include "carom/rigid/detail/load_account.h"
#include "carom/rigid/detail/rotation_step.h"

namespace carom::rigid::detail {
namespace {

template <class D>
bool moves(const WorldImplementation<D>& world, std::int32_t body) {
  return body != none && world.bodies.record[std::size_t(body)].awake_index != none;
}

/// A body that could be moved and is not among those that move: asleep, disabled or quarantined.
template <class D>
bool rests(const WorldImplementation<D>& world, std::int32_t body) {
  return body != none && world.bodies.is_dynamic(body) && !moves(world, body);
}

/// Joints act between bodies that move, or stand for good. Impulses on one that rests would only pile up in it.
template <class D>
void joint_to_graph(WorldImplementation<D>& world, std::int32_t joint) {
  JointHeader& j = world.joints.headers[std::size_t(joint)];
  if (j.place.color >= 0 || rests(world, j.body[0]) || rests(world, j.body[1])) return;
  world.joints.trees.stale = true;
  j.place = world.graph.add(ConstraintKind::joint, joint, j.body[0], j.body[1], world.bodies);
}
template <class D>
void joint_from_graph(WorldImplementation<D>& world, std::int32_t joint) {
  JointHeader& j = world.joints.headers[std::size_t(joint)];
  if (j.place.color < 0) return;
  world.joints.trees.stale = true;
  const std::int32_t moved = world.graph.remove(ConstraintKind::joint, j.place, j.body[0], j.body[1], world.bodies);
  if (moved != none) world.joints.headers[std::size_t(moved)].place = j.place;
  j.place = {};
}

Mat3f symmetric(const Mat3f& i) {
  // To the last bit, so that both bodies of a pair see the same.
  const float xy = 0.5f * (i.cx.y + i.cy.x), xz = 0.5f * (i.cx.z + i.cz.x), yz = 0.5f * (i.cy.z + i.cz.y);
  return {{i.cx.x, xy, xz}, {xy, i.cy.y, yz}, {xz, yz, i.cz.z}};
}
Mat3f symmetric(float xx, float xy, float xz, float yy, float yz, float zz) {
  return {{xx, xy, xz}, {xy, yy, yz}, {xz, yz, zz}};
}
/// r t rᵀ.
Mat3f turned(const Mat3f& t, const Mat3f& r) {
  const Vec3f x{r.cx.x, r.cy.x, r.cz.x}, y{r.cx.y, r.cy.y, r.cz.y}, z{r.cx.z, r.cy.z, r.cz.z};  // its rows
  const Vec3f tx = t * x, ty = t * y, tz = t * z;
  return symmetric(dot(x, tx), dot(x, ty), dot(x, tz), dot(y, ty), dot(y, tz), dot(z, tz));
}
/// scale m⁻¹.
Mat3f inverse_of_symmetric(const Mat3f& m, float scale) {
  const Vec3f a = cross(m.cy, m.cz), b = cross(m.cz, m.cx), c = cross(m.cx, m.cy);
  const float d = dot(m.cx, a), s = d != 0 ? scale / d : 0;
  return symmetric(a.x * s, a.y * s, a.z * s, b.y * s, b.z * s, c.z * s);
}
void set_inertia(BodyMotion<Dim2>& m, double inertia) { m.inertia = float(inertia); }
void set_inertia(BodyMotion<Dim3>& m, const Mat3d& inertia) {
  m.inertia = symmetric(Mat3f(inertia));
  const double scale = (inertia.cx.x + inertia.cy.y + inertia.cz.z) / 3;
  const auto off = [&](double x) { return math::abs(x) > 1e-4 * scale; };
  m.gyroscopic = off(inertia.cx.y) || off(inertia.cx.z) || off(inertia.cy.z) || off(inertia.cx.x - scale) ||
                 off(inertia.cy.y - scale) || off(inertia.cz.z - scale);
}

typename Dim2::Bounds placed(const Dim2::Shape& shape, const Pose2& pose) {
  const geometry::Bounds2f b = geometry::bounds(shape, Transform2f{{}, pose.rotation});
  return {pose.position + Vec2d(b.low), pose.position + Vec2d(b.high)};
}
typename Dim3::Bounds placed(const Dim3::Shape& shape, const Pose3& pose) {
  const geometry::Bounds3f b = geometry::bounds(shape, Transform3f{{}, pose.rotation});
  return {pose.position + Vec3d(b.low), pose.position + Vec3d(b.high)};
}

/// Outward to the next millimetre (2⁻¹⁰ m): a twentieth of the smallest margin at most, and numbers with few digits,
/// which take little room in the difference of two snapshots.
double grid_below(double x) {
  if (!(math::abs(x) < 1e12)) return x;  // the spacing of doubles is about that of the grid
  const double scaled = x * 1024, whole = double(std::int64_t(scaled));
  return (whole > scaled ? whole - 1 : whole) * (1.0 / 1024);
}
Vec2d grid_below(const Vec2d& v) { return {grid_below(v.x), grid_below(v.y)}; }
Vec3d grid_below(const Vec3d& v) { return {grid_below(v.x), grid_below(v.y), grid_below(v.z)}; }
template <class V>
geometry::Bounds<V> on_grid(const geometry::Bounds<V>& b) {
  return {grid_below(b.low), -grid_below(-b.high)};
}

}  // namespace

Mat3f inverse_inertia_in_world(const BodyMotion<Dim3>& m, const Quatf& q, const BodyRecord& record) {
  const float scale = (m.inertia.cx.x + m.inertia.cy.y + m.inertia.cz.z) * (1.0f / 3.0f);
  const int locked = record.locks >> 3 & 7;
  if (record.type != BodyType::dynamic || !(scale > 0) || locked == 7) return Mat3f::zero();
  if (locked == 0 && !m.gyroscopic) return Mat3f::diagonal({1 / scale, 1 / scale, 1 / scale});
  // Scaled to order one, because a determinant of three small moments would underflow.
  Mat3f i = turned((1 / scale) * m.inertia, to_matrix(q));
  // Only the free axes turn: the inverse of that part of the tensor.
  for (int k = 0; k < 3; ++k)
    if (locked >> k & 1)
      for (int l = 0; l < 3; ++l) {
        i.column(k)[l] = k == l ? 1.0f : 0.0f;
        i.column(l)[k] = k == l ? 1.0f : 0.0f;
      }
  i = inverse_of_symmetric(i, 1 / scale);
  for (int k = 0; k < 3; ++k)
    if (locked >> k & 1) i.column(k)[k] = 0;
  return i;
}
float inverse_inertia_in_world(const BodyMotion<Dim2>& m, const Rot2f&, const BodyRecord& record) {
  return record.type == BodyType::dynamic && m.inertia > 0 && (record.locks & 32) == 0 ? 1 / m.inertia : 0;
}

template <class D>
void activate_body(WorldImplementation<D>& world, std::int32_t body) {
  BodyRecord& record = world.bodies.record[std::size_t(body)];
  if (record.awake_index != none || record.type == BodyType::fixed || !record.enabled() ||
      (record.flags & body_quarantined) != 0)
    return;
  record.flags |= body_awake;
  record.awake_index = std::int32_t(world.bodies.awake.size());
  world.bodies.awake.push_back(body);
  update_world_inertia(world, body);
  for (std::int32_t key = record.first_contact; key != none; key = world.contacts.at(key >> 1).next[key & 1])
    activate_contact(world, key >> 1);
  for (std::int32_t key = record.first_joint; key != none;
       key = world.joints.headers[std::size_t(key >> 1)].next[key & 1])
    joint_to_graph(world, key >> 1);
}

template <class D>
void deactivate_body(WorldImplementation<D>& world, std::int32_t body) {
  BodyRecord& record = world.bodies.record[std::size_t(body)];
  if (record.awake_index == none) return;
  const std::int32_t last = world.bodies.awake.back();
  // The ways of the last step stay beside their bodies; one without a way stands.
  std::vector<SweepStart<D>>& ways = world.scratch.swept;
  const std::size_t place = std::size_t(record.awake_index), end = world.bodies.awake.size() - 1;
  if (end < ways.size()) {
    ways[place] = ways[end];
    ways.pop_back();
  } else if (place < ways.size()) {
    ways[place] = {world.bodies.pose[std::size_t(last)].rotation, world.bodies.motion[std::size_t(last)].center, {}, 1};
  }
  world.bodies.awake[std::size_t(record.awake_index)] = last;
  world.bodies.record[std::size_t(last)].awake_index = record.awake_index;
  world.bodies.awake.pop_back();
  record.awake_index = none;
  record.flags &= std::uint16_t(~body_awake);
  for (std::int32_t key = record.first_contact; key != none; key = world.contacts.at(key >> 1).next[key & 1])
    if (!moves(world, world.contacts.at(key >> 1).body[1 - (key & 1)])) deactivate_contact(world, key >> 1);
  for (std::int32_t key = record.first_joint; key != none;) {
    const JointHeader& j = world.joints.headers[std::size_t(key >> 1)];
    const std::int32_t next = j.next[key & 1];
    if (record.type == BodyType::dynamic || !moves(world, j.body[1 - (key & 1)])) joint_from_graph(world, key >> 1);
    key = next;
  }
}

template <class D>
void rouse_body(WorldImplementation<D>& world, std::int32_t body) {
  BodyRecord& record = world.bodies.record[std::size_t(body)];
  record.sleep_timer = 0;
  if (record.awake_index != none || record.type == BodyType::fixed) return;
  if (!record.enabled()) return;
  if (record.sleeping_island == none) {
    activate_body(world, body);
    return;
  }
  const std::int32_t island = record.sleeping_island;
  SleepingIslands& sleeping = world.sleeping;
  for (std::int32_t member = sleeping.first[std::size_t(island)]; member != none;) {
    BodyRecord& other = world.bodies.record[std::size_t(member)];
    const std::int32_t next = other.next_asleep;
    other.sleeping_island = none;
    other.next_asleep = none;
    other.sleep_timer = 0;
    activate_body(world, member);
    member = next;
  }
  sleeping.first[std::size_t(island)] = none;
  sleeping.free.push_back(island);
}

template <class D>
void wake_body(WorldImplementation<D>& world, std::int32_t body) {
  rouse_body(world, body);
  enter_graph_in_order(world);
}

template <class D>
void put_to_sleep(WorldImplementation<D>& world, std::span<std::int32_t> bodies) {
  std::sort(bodies.begin(), bodies.end());  // they wake in an order that tells nothing of other islands
  SleepingIslands& sleeping = world.sleeping;
  std::int32_t island;
  if (!sleeping.free.empty()) {
    island = sleeping.free.back();
    sleeping.free.pop_back();
  } else {
    island = std::int32_t(sleeping.first.size());
    sleeping.first.push_back(none);
  }
  std::int32_t* link = &sleeping.first[std::size_t(island)];
  for (const std::int32_t body : bodies) {
    deactivate_body(world, body);
    BodyRecord& record = world.bodies.record[std::size_t(body)];
    record.sleeping_island = island;
    *link = body;
    link = &record.next_asleep;
    SolverBody<D>& s = world.bodies.solver[std::size_t(body)];
    s.linear_velocity = {};
    s.angular_velocity = {};
  }
}

template <class D>
void wake_touching(WorldImplementation<D>& world, std::int32_t body) {
  for (std::int32_t key = world.bodies.record[std::size_t(body)].first_contact; key != none;) {
    const ContactRecord<D>& c = world.contacts.at(key >> 1);
    const std::int32_t next = c.next[key & 1];
    if (c.first_manifold != none) wake_body(world, c.body[1 - (key & 1)]);
    key = next;
  }
}

template <class D>
void update_world_inertia(WorldImplementation<D>& world, std::int32_t body) {
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  m.world_inverse_inertia = inverse_inertia_in_world(m, world.bodies.pose[std::size_t(body)].rotation,
                                                     world.bodies.record[std::size_t(body)]);
}

template <class D>
void pose_from_center(WorldImplementation<D>& world, std::int32_t body) {
  const BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  typename D::Pose& pose = world.bodies.pose[std::size_t(body)];
  pose.position = m.center;
  if (m.local_center != typename D::Vector{})
    pose.position = pose.position - typename D::Position(rotate(pose.rotation, m.local_center));
}
template <class D>
void center_from_pose(WorldImplementation<D>& world, std::int32_t body) {
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  m.center = world_point(world.bodies.pose[std::size_t(body)], m.local_center);
}

/// Lets the distances from the axes through the centre of mass of a body's frame reach all of a shape.
static void reach(Vec3f& arms, const ShapeRecord<Dim3>& shape, const Vec3f& center) {
  const auto reach_point = [&arms](const Vec3f& p) {
    const Vec3f s{p.x * p.x, p.y * p.y, p.z * p.z};
    arms = max(arms, Vec3f{math::sqrt(s.y + s.z), math::sqrt(s.z + s.x), math::sqrt(s.x + s.y)});
  };
  if (shape.geometry.type == geometry::ShapeType3::hull && shape.geometry.hull->radius == 0) {
    for (const Vec3f& v : shape.geometry.hull->vertices) reach_point(transform_point(shape.local, v) - center);
    return;
  }
  const geometry::Bounds3f box = geometry::bounds(shape.geometry, shape.local);
  const Vec3f corner = max(abs(box.low - center), abs(box.high - center));
  const float along = arms.y;
  reach_point(corner);
  const bool round = shape.geometry.type == geometry::ShapeType3::cylinder ||
                     shape.geometry.type == geometry::ShapeType3::cone ||
                     shape.geometry.type == geometry::ShapeType3::capsule;
  if (round && shape.at_origin && center.x == 0 && center.z == 0) arms.y = max(along, max(corner.x, corner.z));
}
static std::uint8_t slenderness(const WorldImplementation<Dim2>& world, std::int32_t body) {
  const Vec2f center = world.bodies.motion[std::size_t(body)].local_center;
  for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next)
    if (world.shapes.at(s).geometry.type != geometry::ShapeType2::circle || world.shapes.at(s).local.p != center)
      return 0;
  return 1;
}
static std::uint8_t slenderness(const WorldImplementation<Dim3>& world, std::int32_t body) {
  const BodyMotion<Dim3>& m = world.bodies.motion[std::size_t(body)];
  Vec3f arms{};
  for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next)
    reach(arms, world.shapes.at(s), m.local_center);
  const int axis = arms.x <= arms.y && arms.x <= arms.z ? 0 : (arms.y <= arms.z ? 1 : 2);
  if (!(3 * arms[axis] < m.outer_extent)) return 0;
  return std::uint8_t(1 + axis + 4 * (int(63 * math::sqrt(arms[axis] / m.outer_extent)) + 1));
}

template <class D>
void update_mass(WorldImplementation<D>& world, std::int32_t body) {
  world.joints.trees.stale = true;
  BodyRecord& record = world.bodies.record[std::size_t(body)];
  BodyMotion<D>& m = world.bodies.motion[std::size_t(body)];
  const typename D::Vector old_center = m.local_center;
  m.inner_extent = 0;
  m.outer_extent = 0;
  typename D::MassProperties sum{};  // nothing yet: mass and inertia zero
  bool first = true;
  for (std::int32_t s = record.first_shape; s != none; s = world.shapes.at(s).next) {
    const ShapeRecord<D>& shape = world.shapes.at(s);
    if (first || shape.inner_extent < m.inner_extent) m.inner_extent = shape.inner_extent;
    first = false;
    const float density = world.shapes.terms_of(shape).density;
    if (density > 0 && record.type == BodyType::dynamic) {
      typename D::MassProperties p = geometry::mass_properties(shape.geometry, double(density));
      if (!shape.at_origin) {
        using T = std::conditional_t<D::dimension == 2, Transform2d, Transform3d>;
        using Q = decltype(T{}.q);
        p = geometry::transform(p, T{typename D::Position(shape.local.p), Q(shape.local.q)});
      }
      if (p.mass > 0) sum = sum.mass > 0 ? geometry::combine(sum, p) : p;
    }
  }
  if ((record.flags & body_mass_given) == 0) {
    m.mass = record.type == BodyType::dynamic ? float(sum.mass) : 0;
    m.local_center = typename D::Vector(sum.center);
    set_inertia(m, sum.inertia);
  } else {
    using InertiaD = decltype(sum.inertia);
    set_inertia(m, InertiaD(m.inertia));
  }
  const bool translates = (record.locks & (D::dimension == 2 ? 3 : 7)) != (D::dimension == 2 ? 3 : 7);
  m.inverse_mass = record.type == BodyType::dynamic && m.mass > 0 && translates ? 1 / m.mass : 0;
  for (std::int32_t s = record.first_shape; s != none; s = world.shapes.at(s).next) {
    const ShapeRecord<D>& shape = world.shapes.at(s);
    m.outer_extent = max(m.outer_extent, math::length(shape.local.p - m.local_center) + shape.outer_extent);
  }
  m.slender = slenderness(world, body);
  center_from_pose(world, body);
  SolverBody<D>& solver = world.bodies.solver[std::size_t(body)];
  const typename D::Vector shift = rotate(world.bodies.pose[std::size_t(body)].rotation, m.local_center - old_center);
  solver.linear_velocity = solver.linear_velocity + cross(solver.angular_velocity, shift);
  update_world_inertia(world, body);
}

template <class D>
typename D::Bounds shape_bounds(const WorldImplementation<D>& world, const ShapeRecord<D>& shape) {
  return placed(shape.geometry, shape_pose(world, shape));
}

/// So far in a step that its shapes may be anywhere about the centre of mass.
static bool turns_far(float spin, float dt) { return math::abs(spin) * dt > 0.5f; }
static bool turns_far(const Vec3f& spin, float dt) { return math::length_squared(spin) * dt * dt > 0.25f; }

template <class D>
void learn_bounce(WorldImplementation<D>& world) {
  ShapeStore<D>& shapes = world.shapes;
  if (shapes.bounce != Bounce::unknown) return;
  const auto rebounds = [](const auto& x) { return x.restitution >= least_bounce; };
  bool any = false;
  for (const PairRuleEntry& entry : world.pair_rules) any = any || rebounds(entry.rule);
  for (const ShapeExtra<D>& extra : shapes.extras) any = any || extra.modify;  // who may ask for it
  for (const PartSurface<D>& part : shapes.surfaces) any = any || rebounds(part.surface.material);
  for (std::size_t i = 0; i < shapes.record.size() && !any; ++i)
    any = shapes.slots.in_use(int(i)) && rebounds(shapes.terms_of(std::int32_t(i)).material);
  shapes.bounce = any ? Bounce::some : Bounce::none;
}

template <class D>
bool has_several_shapes(const WorldImplementation<D>& world, std::int32_t body) {
  const std::int32_t first = world.bodies.record[std::size_t(body)].first_shape;
  return first != none && world.shapes.at(first).next != none;
}

/// m, of the middle of a shape in the next step, by the velocity that it has.
template <class D>
static typename D::Vector way_of_middle(const WorldImplementation<D>& world, const ShapeRecord<D>& shape) {
  using V = typename D::Vector;
  const SolverBody<D>& s = world.bodies.solver[std::size_t(shape.body)];
  if (!has_several_shapes(world, shape.body)) return s.linear_velocity * world.last_dt;
  const V own = ball_about(shape).middle, middle = shape.at_origin ? own : transform_point(shape.local, own),
          arm = rotate(world.bodies.pose[std::size_t(shape.body)].rotation,
                       middle - world.bodies.motion[std::size_t(shape.body)].local_center);
  return (s.linear_velocity + cross(s.angular_velocity, arm)) * world.last_dt;
}

template <class D>
typename D::Position way_ahead(const WorldImplementation<D>& world, const ShapeRecord<D>& shape) {
  const typename D::Vector way = way_of_middle(world, shape);
  return typename D::Position(way * within_foresight(math::length_squared(way), shape, world.shapes.bounce));
}

/// A bullet asks the pairs of its fat bounds what it meets, so they must hold how it turns as well.
template <class D>
static bool is_quick_bullet(const WorldImplementation<D>& world, std::int32_t body) {
  if ((world.bodies.record[std::size_t(body)].flags & body_bullet) == 0) return false;
  const auto way = world.bodies.solver[std::size_t(body)].linear_velocity * world.last_dt;
  return math::length_squared(way) > square(0.25f * world.bodies.motion[std::size_t(body)].inner_extent);
}
/// Of the shape's places while its body turns through a step about its centre of mass.
template <class D>
static typename D::Bounds bounds_of_turn(const WorldImplementation<D>& world, const ShapeRecord<D>& shape) {
  using P = typename D::Position;
  using Sweep = std::conditional_t<D::dimension == 2, geometry::Sweep2, geometry::Sweep3>;
  const BodyMotion<D>& m = world.bodies.motion[std::size_t(shape.body)];
  const typename D::Rotation& q = world.bodies.pose[std::size_t(shape.body)].rotation;
  const Sweep body{m.local_center,
                   {},
                   {},
                   q,
                   normalize(turn(world.bodies.solver[std::size_t(shape.body)].angular_velocity * world.last_dt) * q)};
  const auto box = geometry::detail::swept_bounds(
      shape.geometry, shape.at_origin ? body : geometry::detail::sweep_of_part(body, shape.local));
  return {m.center + P(box.low), m.center + P(box.high)};
}

template <class D>
static typename D::Position bounds_ahead(const WorldImplementation<D>& world, const ShapeRecord<D>& shape,
                                         bool quick_bullet) {
  using P = typename D::Position;
  if (quick_bullet) return P(world.bodies.solver[std::size_t(shape.body)].linear_velocity * world.last_dt);
  if (!has_several_shapes(world, shape.body)) return way_ahead(world, shape);
  // A body of several shapes would have all of them leave their bounds in every step of a fall. What is long has few
  // others beside it.
  const double steps = world.bodies.motion[std::size_t(shape.body)].slender != 0 ? 5 : 3;
  return P(way_of_middle(world, shape)) * steps;
}
template <class D>
typename D::Position bounds_ahead(const WorldImplementation<D>& world, const ShapeRecord<D>& shape) {
  return bounds_ahead(world, shape, is_quick_bullet(world, shape.body));
}

template <class D>
typename D::Bounds fat_bounds(const WorldImplementation<D>& world, const ShapeRecord<D>& shape) {
  const SolverBody<D>& s = world.bodies.solver[std::size_t(shape.body)];
  typename D::Bounds box;
  const bool far = turns_far(s.angular_velocity, world.last_dt) && world.bodies.is_dynamic(shape.body);
  if (far) {
    const BodyMotion<D>& m = world.bodies.motion[std::size_t(shape.body)];
    const double reach = double(math::length(shape.local.p - m.local_center) + shape.outer_extent);
    box = geometry::grow(typename D::Bounds{m.center, m.center}, reach);
  } else {
    box = shape_bounds(world, shape);
  }
  const bool bullet = is_quick_bullet(world, shape.body);
  if (bullet && !turns_far(s.angular_velocity, world.last_dt)) box = merge(box, bounds_of_turn(world, shape));
  box = geometry::grow(box, double(shape.margin));
  return on_grid(box_along(box, bounds_ahead(world, shape, bullet)));
}

template <class D>
void insert_into_tree(WorldImplementation<D>& world, std::int32_t s) {
  ShapeRecord<D>& shape = world.shapes.at(s);
  const BodyRecord& record = world.bodies.record[std::size_t(shape.body)];
  if (shape.leaf != none || !record.enabled()) return;
  shape.tree = record.type == BodyType::fixed ? tree_fixed
                                              : (record.type == BodyType::kinematic ? tree_kinematic : tree_dynamic);
  learn_bounce(world);
  shape.leaf = world.shapes.trees[shape.tree].insert(fat_bounds(world, shape), std::uint32_t(s));
  look_at_bounds(world.bodies.motion[std::size_t(shape.body)]);
  world.scratch.old_bounds.clear();  // its pairs have not been looked for
  if ((shape.flags & shape_moved) == 0) {
    shape.flags |= shape_moved;
    world.scratch.moved.push_back(s);
  }
}

template <class D>
void remove_from_tree(WorldImplementation<D>& world, std::int32_t s) {
  ShapeRecord<D>& shape = world.shapes.at(s);
  if (shape.leaf == none) return;
  world.shapes.trees[shape.tree].remove(shape.leaf);
  shape.leaf = none;
  shape.tree = tree_none;
}

template <class D>
void refresh_bounds(WorldImplementation<D>& world, std::int32_t body, const typename D::Position& way) {
  learn_bounce(world);
  BodyMotion<D>& motion = world.bodies.motion[std::size_t(body)];
  look_at_bounds(motion);
  // What its owner moves in small ways, as a character, has bounds for some of them to come.
  constexpr double ways = 3;
  const bool goes_on = world.bodies.record[std::size_t(body)].type == BodyType::kinematic &&
                       math::length(way) < double(motion.outer_extent);
  for (std::int32_t s = world.bodies.record[std::size_t(body)].first_shape; s != none; s = world.shapes.at(s).next) {
    ShapeRecord<D>& shape = world.shapes.at(s);
    if (shape.leaf == none) continue;
    auto& tree = world.shapes.trees[shape.tree];
    if (goes_on &&
        geometry::contains(tree.bounds(shape.leaf), box_along(shape_bounds(world, shape), bounds_ahead(world, shape))))
      continue;
    const typename D::Bounds box = fat_bounds(world, shape);
    tree.update(shape.leaf, goes_on ? on_grid(box_along(box, way * ways)) : box);
    if ((shape.flags & shape_moved) == 0) {
      shape.flags |= shape_moved;
      world.scratch.moved.push_back(s);
    }
  }
}

template <class D>
void attach_joint(WorldImplementation<D>& world, std::int32_t joint) {
  JointHeader& j = world.joints.headers[std::size_t(joint)];
  for (int side = 0; side < 2; ++side) {
    if (j.body[side] == none) continue;
    BodyRecord& body = world.bodies.record[std::size_t(j.body[side])];
    const std::int32_t key = 2 * joint + side;
    j.previous[side] = none;
    j.next[side] = body.first_joint;
    if (body.first_joint != none)
      world.joints.headers[std::size_t(body.first_joint >> 1)].previous[body.first_joint & 1] = key;
    body.first_joint = key;
    ++body.joint_count;
    world.scratch.dropped.push_back(j.body[side]);
  }
  drop_loads(world, world.scratch.dropped);
  j.place = {};
  for (int side = 0; side < 2; ++side)
    if (j.body[side] != none) wake_body(world, j.body[side]);
  if (moves(world, j.body[0]) || moves(world, j.body[1])) joint_to_graph(world, joint);
  if (!j.collide_connected && j.body[0] != none && j.body[1] != none)
    destroy_contacts_between(world, j.body[0], j.body[1]);
}

template <class D>
void detach_joint(WorldImplementation<D>& world, std::int32_t joint) {
  joint_from_graph(world, joint);
  JointHeader& j = world.joints.headers[std::size_t(joint)];
  for (int side = 0; side < 2; ++side) {
    if (j.body[side] == none) continue;
    BodyRecord& body = world.bodies.record[std::size_t(j.body[side])];
    const std::int32_t previous = j.previous[side], next = j.next[side];
    if (previous != none)
      world.joints.headers[std::size_t(previous >> 1)].next[previous & 1] = next;
    else
      body.first_joint = next;
    if (next != none) world.joints.headers[std::size_t(next >> 1)].previous[next & 1] = previous;
    --body.joint_count;
  }
  for (int side = 0; side < 2; ++side)
    if (j.body[side] != none) {
      wake_body(world, j.body[side]);
      if (!j.collide_connected) find_pairs_again(world, j.body[side]);
    }
}

template <class D>
bool joints_forbid_collision(const WorldImplementation<D>& world, std::int32_t a, std::int32_t b) {
  const BodyRecord &ra = world.bodies.record[std::size_t(a)], &rb = world.bodies.record[std::size_t(b)];
  const bool use_a = ra.joint_count <= rb.joint_count;
  const std::int32_t other = use_a ? b : a;
  for (std::int32_t key = use_a ? ra.first_joint : rb.first_joint; key != none;) {
    const JointHeader& j = world.joints.headers[std::size_t(key >> 1)];
    if (!j.collide_connected && j.body[1 - (key & 1)] == other) return true;
    key = j.next[key & 1];
  }
  return false;
}

#define CAROM_INSTANTIATE(D)                                                                  \
  template void activate_body<D>(WorldImplementation<D>&, std::int32_t);                      \
  template void deactivate_body<D>(WorldImplementation<D>&, std::int32_t);                    \
  template void wake_body<D>(WorldImplementation<D>&, std::int32_t);                          \
  template void rouse_body<D>(WorldImplementation<D>&, std::int32_t);                         \
  template void put_to_sleep<D>(WorldImplementation<D>&, std::span<std::int32_t>);            \
  template void wake_touching<D>(WorldImplementation<D>&, std::int32_t);                      \
  template void update_world_inertia<D>(WorldImplementation<D>&, std::int32_t);               \
  template void pose_from_center<D>(WorldImplementation<D>&, std::int32_t);                   \
  template void center_from_pose<D>(WorldImplementation<D>&, std::int32_t);                   \
  template void update_mass<D>(WorldImplementation<D>&, std::int32_t);                        \
  template D::Bounds shape_bounds<D>(const WorldImplementation<D>&, const ShapeRecord<D>&);   \
  template void learn_bounce<D>(WorldImplementation<D>&);                                     \
  template D::Position way_ahead<D>(const WorldImplementation<D>&, const ShapeRecord<D>&);    \
  template D::Position bounds_ahead<D>(const WorldImplementation<D>&, const ShapeRecord<D>&); \
  template bool has_several_shapes<D>(const WorldImplementation<D>&, std::int32_t);           \
  template D::Bounds fat_bounds<D>(const WorldImplementation<D>&, const ShapeRecord<D>&);     \
  template void insert_into_tree<D>(WorldImplementation<D>&, std::int32_t);                   \
  template void remove_from_tree<D>(WorldImplementation<D>&, std::int32_t);                   \
  template void refresh_bounds<D>(WorldImplementation<D>&, std::int32_t, const D::Position&); \
  template void attach_joint<D>(WorldImplementation<D>&, std::int32_t);                       \
  template void detach_joint<D>(WorldImplementation<D>&, std::int32_t);                       \
  template bool joints_forbid_collision<D>(const WorldImplementation<D>&, std::int32_t, std::int32_t);
CAROM_INSTANTIATE(Dim2)
CAROM_INSTANTIATE(Dim3)
#undef CAROM_INSTANTIATE

}  // namespace carom::rigid::detail
