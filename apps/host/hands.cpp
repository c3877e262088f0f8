#include "apps/host/hands.h"

#include <algorithm>

namespace carom::host {

namespace {

constexpr double ray_length = 2000;  // m

/// Where the view ray meets the plane of a world of two dimensions.
math::Vec2d on_plane(math::Vec3d origin, math::Vec3d direction) {
  const double t = direction.z != 0 ? -origin.z / direction.z : 0;
  return {origin.x + t * direction.x, origin.y + t * direction.y};
}

template <class D>
std::int64_t id_of(const Stage<D>& stage, rigid::BodyId body) {
  for (const auto& actor : stage.actors())
    if (actor.body == body) return actor.id;
  return -1;
}

template <class D>
typename D::Shape ball(float radius) {
  if constexpr (D::dimension == 2)
    return geometry::Circle{radius};
  else
    return geometry::Sphere{radius};
}

/// The nearest shape within `radius` of a point, of bodies other than `passed`.
template <class D>
core::Result<ProbeAnswer> nearest(const Stage<D>& stage, typename D::Position point, float radius,
                                  rigid::BodyId passed) {
  const rigid::World<D>& world = stage.world();
  std::vector<rigid::ShapeId> found;
  if (const core::Status status = world.overlap(ball<D>(radius), {point, {}}, found); !status.ok())
    return status.error();
  ProbeAnswer best;
  best.point = in_space(point);
  double least = 1e30;
  const typename D::Shape probe = ball<D>(1e-3f);
  for (const rigid::ShapeId id : found) {
    const auto body = world.body_of(id);
    const auto shape = world.shape_geometry(id);
    const auto definition = world.shape_definition(id);
    if (!body.ok() || *body == passed || !shape.ok() || !definition.ok() || definition->sensor) continue;
    const auto state = world.state(*body);
    if (!state.ok()) continue;
    // Measured in the frame of the shape, where numbers are small.
    const typename D::Pose placed = state->pose * definition->local;
    typename D::Transform at{};
    at.p = local_point(placed, point);
    const auto gap = geometry::distance(*shape, probe, at);
    const double distance = gap.distance <= 0 ? 0 : double(gap.distance) + 1e-3;
    if (distance >= least) continue;
    least = distance;
    best = {id_of(stage, *body), in_space(world_point(placed, gap.point_a)),
            in_space(rotate(placed.rotation, gap.normal)), distance};
  }
  return best;
}

}  // namespace

template <class D>
rigid::BodyId pick_body(const Stage<D>& stage, math::Vec3d origin, math::Vec3d direction, typename D::Position& point) {
  const rigid::World<D>& world = stage.world();
  if constexpr (D::dimension == 2) {
    // A finger's width around the point counts as a hit; the body whose middle is nearest wins.
    point = on_plane(origin, direction);
    std::vector<rigid::ShapeId> found;
    const float reach = math::clamp(float(stage.declaration().camera.height) * 0.006f, 1e-4f, 1e4f);
    if (!world.overlap(geometry::Circle{reach}, {point, {}}, found).ok()) return {};
    rigid::BodyId best;
    double nearest = 0;
    for (const rigid::ShapeId shape : found) {
      const auto body = world.body_of(shape);
      const auto state = body.ok() ? world.state(*body) : core::Result<rigid::BodyState<D>>(body.error());
      if (!state.ok() || state->type != rigid::BodyType::dynamic) continue;
      const double d = math::distance_squared(state->center_of_mass, point);
      if (best && d >= nearest) continue;
      best = *body;
      nearest = d;
    }
    return best;
  } else {
    const auto hit = world.ray_cast(origin, math::Vec3f(math::normalize(direction) * ray_length));
    if (!hit.ok() || !hit->shape) return {};
    point = hit->point;
    const auto body = world.body_of(hit->shape);
    return body.ok() ? *body : rigid::BodyId{};
  }
}

template <class D>
core::Status spawn_body(Stage<D>& stage, const SpawnRequest& request) {
  if (!(request.size >= 0.005 && request.size <= 50)) return core::Error{"spawn: expected a size from 0.005 to 50 m"};
  if (!(request.density > 0 && request.density <= 1e5))
    return core::Error{"spawn: expected a density above 0, at most 100 000"};
  if (stage.actors().size() >= max_spawned_into) return core::Error{"spawn: the scene holds too many bodies already"};
  rigid::BodyDef<D> body;
  body.name = "thrown in";
  body.bullet = true;
  rigid::ShapeDef<D> material;
  material.density = float(request.density);
  const float size = float(request.size);
  typename D::Shape shape = ball<D>(size);
  if constexpr (D::dimension == 2) {
    body.position = {request.position.x, request.position.y};
    body.linear_velocity = {float(request.velocity.x), float(request.velocity.y)};
    if (request.form == SpawnRequest::Form::box) shape = geometry::make_box2({size, size});
    if (request.form == SpawnRequest::Form::capsule) shape = geometry::Capsule2{size, 0.5f * size};
  } else {
    body.position = request.position;
    body.linear_velocity = math::Vec3f(request.velocity);
    if (request.form == SpawnRequest::Form::box) shape = geometry::Box{{size, size, size}};
    if (request.form == SpawnRequest::Form::capsule) shape = geometry::Capsule3{size, 0.5f * size};
  }
  // Not through `Stage::add`, whose failures end the demo: a user's mistake must not.
  const core::Result<rigid::BodyId> made = stage.world().create_body(body);
  if (!made.ok()) return made.error();
  if (const auto added = stage.world().add_shape(*made, shape, material); !added.ok()) {
    (void)stage.world().destroy_body(*made);
    return added.error();
  }
  stage.adopt(*made, 0xd1495b);
  return {};
}

template <class D>
core::Result<ProbeAnswer> probe_world(const Stage<D>& stage, ProbeKind kind, math::Vec3d origin, math::Vec3d direction,
                                      double radius) {
  if (!(radius >= 1e-3 && radius <= 100)) return core::Error{"probe: expected a radius from 0.001 to 100 m"};
  const rigid::World<D>& world = stage.world();
  if constexpr (D::dimension == 2) {
    typename D::Position point{};
    const rigid::BodyId under = pick_body(stage, origin, direction, point);
    if (kind == ProbeKind::closest) return nearest(stage, point, float(radius), under);
    // In the plane one looks from above: what lies at the point, or within the circle.
    return nearest(stage, point, kind == ProbeKind::ray ? 1e-3f : float(radius), {});
  } else {
    const math::Vec3f way(math::normalize(direction) * ray_length);
    const auto hit = kind == ProbeKind::sphere ? world.shape_cast(geometry::Sphere{float(radius)}, {origin, {}}, way)
                                               : world.ray_cast(origin, way);
    if (!hit.ok()) return hit.error();
    if (!hit->shape) return ProbeAnswer{};
    const auto body = world.body_of(hit->shape);
    if (!body.ok()) return body.error();
    if (kind == ProbeKind::closest) return nearest(stage, hit->point, float(radius), *body);
    return ProbeAnswer{id_of(stage, *body), hit->point, math::Vec3d(hit->normal), double(hit->fraction) * ray_length};
  }
}

template rigid::BodyId pick_body(const Stage2&, math::Vec3d, math::Vec3d, math::Vec2d&);
template rigid::BodyId pick_body(const Stage3&, math::Vec3d, math::Vec3d, math::Vec3d&);
template core::Status spawn_body(Stage2&, const SpawnRequest&);
template core::Status spawn_body(Stage3&, const SpawnRequest&);
template core::Result<ProbeAnswer> probe_world(const Stage2&, ProbeKind, math::Vec3d, math::Vec3d, double);
template core::Result<ProbeAnswer> probe_world(const Stage3&, ProbeKind, math::Vec3d, math::Vec3d, double);

}  // namespace carom::host
