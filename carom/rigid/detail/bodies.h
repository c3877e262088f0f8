// Waking, sleeping and measuring bodies: serial operations on the world's stores.
#pragma once

#include "carom/rigid/detail/contacts.h"

namespace carom::rigid::detail {

inline std::uint8_t lock_bits(const MotionLocks& l) {
  return std::uint8_t(int(l.x) | int(l.y) << 1 | int(l.z) << 2 | int(l.rotation_x) << 3 | int(l.rotation_y) << 4 |
                      int(l.rotation_z) << 5);
}
inline MotionLocks locks_of(std::uint8_t b) {
  return {(b & 1) != 0, (b & 2) != 0, (b & 4) != 0, (b & 8) != 0, (b & 16) != 0, (b & 32) != 0};
}

inline bool is_surface(const geometry::Shape2&) { return false; }  // chains do not move
using geometry::is_surface;
/// A mesh on a body that is not fixed.
template <class D>
inline bool is_moving_surface(const WorldImplementation<D>& world, std::int32_t shape) {
  const ShapeRecord<D>& s = world.shapes.at(shape);
  return is_surface(s.geometry) && !world.bodies.is_fixed(s.body);
}

/// Puts the body among those that move (or does nothing, for fixed and disabled ones), with its contacts and joints;
/// what touches enters the graph with enter_graph_in_order.
template <class D>
void activate_body(WorldImplementation<D>& world, std::int32_t body);
/// The opposite. Contacts and joints stay active where the other body is awake.
template <class D>
void deactivate_body(WorldImplementation<D>& world, std::int32_t body);
/// Puts bodies that are awake to sleep together. Sorts them.
template <class D>
void put_to_sleep(WorldImplementation<D>& world, std::span<std::int32_t> bodies);
/// As wake_body, but what touches enters the graph with enter_graph_in_order, once all are awake.
template <class D>
void rouse_body(WorldImplementation<D>& world, std::int32_t body);

/// Wakes whoever touches the body: what it rested on may be gone.
template <class D>
void wake_touching(WorldImplementation<D>& world, std::int32_t body);

/// The inverse of the tensor in world axes, with locked axes taken out.
template <class D>
void update_world_inertia(WorldImplementation<D>& world, std::int32_t body);
/// What it is made of: a pure function of these three.
Mat3f inverse_inertia_in_world(const BodyMotion<Dim3>& motion, const Quatf& rotation, const BodyRecord& record);
float inverse_inertia_in_world(const BodyMotion<Dim2>& motion, const Rot2f& rotation, const BodyRecord& record);
/// The pose of the body's origin from its centre of mass.
template <class D>
void pose_from_center(WorldImplementation<D>& world, std::int32_t body);
template <class D>
void center_from_pose(WorldImplementation<D>& world, std::int32_t body);

template <class D>
BodyState<D> state_of(const WorldImplementation<D>& world, std::int32_t body) {
  const std::size_t i = std::size_t(body);
  const BodyRecord& r = world.bodies.record[i];
  BodyState<D> s;
  s.pose = world.bodies.pose[i];
  s.center_of_mass = world.bodies.motion[i].center;
  s.linear_velocity = world.bodies.solver[i].linear_velocity;
  s.angular_velocity = world.bodies.solver[i].angular_velocity;
  s.mass = world.bodies.motion[i].mass;
  s.type = r.type;
  s.awake = r.awake_index != none;
  s.enabled = r.enabled();
  s.user_data = word_of(world.bodies.user_data, body);
  return s;
}
/// A box and all that it passes over on a straight way.
template <class P>
geometry::Bounds<P> box_along(const geometry::Bounds<P>& box, const P& way) {
  return {box.low + math::min(way, P{}), box.high + math::max(way, P{})};
}
/// Tight bounds of a shape where it stands.
template <class D>
typename D::Bounds shape_bounds(const WorldImplementation<D>& world, const ShapeRecord<D>& shape);
/// Tight bounds grown by the margin, and along the motion of one step where that is more.
template <class D>
typename D::Bounds fat_bounds(const WorldImplementation<D>& world, const ShapeRecord<D>& shape);
/// Finds out what ShapeStore::bounce says.
template <class D>
void learn_bounce(WorldImplementation<D>& world);
/// Which part of a shape's way in the next step contacts look along: all of it where anything rebounds, else up to half
/// the shape's thickness. way_squared: m².
template <class D>
float within_foresight(float way_squared, const ShapeRecord<D>& shape, Bounce bounce) {
  const float most = 0.5f * shape.inner_extent;
  return bounce == Bounce::none && way_squared > most * most ? most / math::sqrt(way_squared) : 1.0f;
}
/// How far fat bounds must reach ahead along the velocity: for a step where anything rebounds; else as far as contacts
/// look.
template <class D>
typename D::Position way_ahead(const WorldImplementation<D>& world, const ShapeRecord<D>& shape);
/// How far fat bounds that are made now do: of bodies of several shapes for some steps.
template <class D>
typename D::Position bounds_ahead(const WorldImplementation<D>& world, const ShapeRecord<D>& shape);
/// Has the body more than one shape?
template <class D>
bool has_several_shapes(const WorldImplementation<D>& world, std::int32_t body);
/// Puts the shape into the tree of its body's type (disabled bodies: none) and lets the broad phase look at it.
template <class D>
void insert_into_tree(WorldImplementation<D>& world, std::int32_t shape);
template <class D>
void remove_from_tree(WorldImplementation<D>& world, std::int32_t shape);
/// After a body was set to another place, `way` (m) from the one before.
template <class D>
void refresh_bounds(WorldImplementation<D>& world, std::int32_t body, const typename D::Position& way);

/// Locked degrees of freedom do not move: their velocities go to zero.
inline void apply_locks(SolverBody<Dim2>& s, std::uint8_t locks) {
  if (locks & 1) s.linear_velocity.x = 0;
  if (locks & 2) s.linear_velocity.y = 0;
  if (locks & 32) s.angular_velocity = 0;
}
inline void apply_locks(SolverBody<Dim3>& s, std::uint8_t locks) {
  for (int i = 0; i < 3; ++i) {
    if (locks >> i & 1) s.linear_velocity[i] = 0;
    if (locks >> (3 + i) & 1) s.angular_velocity[i] = 0;
  }
}

}  // namespace carom::rigid::detail
