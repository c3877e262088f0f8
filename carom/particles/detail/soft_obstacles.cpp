#include "carom/particles/detail/soft_obstacles.h"

namespace carom::particles::detail {

bool nearest_plane(const geometry::Shape3& shape, Vec3f center, float radius, float margin, Vec3f& normal,
                   float& separation) {
  const geometry::Shape3 ball(geometry::Sphere{radius});
  const math::Transform3f place{center, {}};
  bool found = false;
  const auto take = [&](const geometry::Manifold3& manifold) {
    for (int k = 0; k < manifold.count; ++k)
      if (manifold.points[k].separation <= margin && (!found || manifold.points[k].separation < separation)) {
        found = true;
        separation = manifold.points[k].separation;
        normal = manifold.normal;
      }
  };
  if (is_convex(shape) || shape.type == geometry::ShapeType3::plane) {
    geometry::PairCache cache;
    geometry::Manifold3 manifold;
    geometry::collide(shape, ball, place, margin, cache, manifold);
    take(manifold);
  } else {
    geometry::Manifold3 manifolds[4];
    const int count = geometry::collide_many(shape, ball, place, margin, manifolds);
    for (int k = 0; k < count; ++k) take(manifolds[k]);
  }
  return found;
}

int SoftObstacles::body_index(rigid::World3& world, rigid::BodyId id) {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].id == id) return int(i);
  const auto state = world.state(id);
  if (!state) return -1;
  Body body;
  body.id = id;
  body.dynamic = state->type == rigid::BodyType::dynamic;
  body.awake = state->awake;
  body.position = state->pose.position;
  body.center = state->center_of_mass;
  body.rotation = Quatd(state->pose.rotation);
  body.velocity = Vec3d(state->linear_velocity);
  body.spin = Vec3d(state->angular_velocity);
  body.mass = double(state->mass);
  bodies.push_back(body);
  return int(bodies.size()) - 1;
}

void SoftObstacles::gather(rigid::World3& world, const geometry::Bounds3d& bounds, const rigid::Filter& filter,
                           const std::vector<SoftPin>& pins) {
  (void)world.overlap_bounds(bounds, found_);
  for (const rigid::ShapeId id : found_) {
    const auto definition = world.shape_definition(id);
    const auto owner = world.body_of(id);
    if (!definition || !owner || definition->sensor) continue;
    const rigid::Filter& other = definition->filter;
    const bool same_group = other.group != 0 && other.group == filter.group;
    if (same_group ? other.group < 0 : (other.category & filter.mask) == 0 || (filter.category & other.mask) == 0)
      continue;
    bool pinned = false;
    for (const SoftPin& pin : pins) pinned |= pin.body == *owner;
    if (pinned) continue;
    const auto shape = world.shape_geometry(id);
    const int index = body_index(world, *owner);
    if (!shape || index < 0) continue;
    const Body& body = bodies[std::size_t(index)];
    shapes_.push_back({*shape, geometry::bounds(*shape, {}), index, body.rotation * Quatd(definition->local.q),
                       body.place(Vec3d(definition->local.p)), double(definition->material.friction)});
  }
}

bool SoftObstacles::nearest(Vec3d point, double radius, double margin, SoftPlane& plane) const {
  bool found = false;
  for (const Shape& shape : shapes_) {
    const Vec3f local(inverse_rotate(shape.turn, point - shape.place));
    if (!contains(grow(shape.tight, float(radius + margin)), geometry::Bounds3f{local, local})) continue;
    Vec3f normal;
    float separation = 0;
    if (!nearest_plane(shape.shape, local, float(radius), float(margin), normal, separation)) continue;
    if (found && double(separation) >= plane.separation) continue;
    found = true;
    plane = {shape.body, rotate(shape.turn, Vec3d(normal)), double(separation), shape.friction};
  }
  return found;
}

void SoftObstacles::hand_over(rigid::World3& world, double dt, double gravity) const {
  const float per_step = float(1 / dt);
  for (const Body& body : bodies) {
    if (!body.dynamic || (length_squared(body.impulse) == 0 && length_squared(body.turn) == 0)) continue;
    // What sleeps is not woken by what only lies on it.
    if (!body.awake && length(body.impulse) < 0.02 * body.mass * gravity * dt) continue;
    (void)world.add_force(body.id, Vec3f(body.impulse) * per_step);
    (void)world.add_torque(body.id, Vec3f(body.turn) * per_step);
  }
}

}  // namespace carom::particles::detail
