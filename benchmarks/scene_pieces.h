// What the scenes are built with.
#pragma once

#include "benchmarks/scene.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/elementary.h"
#include "carom/math/rotation.h"

namespace carom::bench {
using rigid::BodyDef;
using rigid::BodyId;
using rigid::BodyType;
using rigid::Dim2;
using rigid::Dim3;
using rigid::ShapeDef;
using World2 = rigid::World<Dim2>;
using World3 = rigid::World<Dim3>;

inline constexpr double pi = 3.14159265358979323846;
inline constexpr double degree = pi / 180;

template <class D>
BodyId add_body(rigid::World<D>& world, const BodyDef<D>& body) {
  return world.create_body(body).value();
}
template <class D>
BodyId add_body(rigid::World<D>& world, const BodyDef<D>& body, const typename D::Shape& shape,
                const ShapeDef<D>& surface) {
  const BodyId id = world.create_body(body).value();
  world.add_shape(id, shape, surface).value();
  return id;
}
inline BodyId add_fixed(World3& world, math::Vec3d position, const geometry::Shape3& shape, float friction = 0.6f,
                        float restitution = 0) {
  ShapeDef<Dim3> surface;
  surface.material.friction = friction;
  surface.material.restitution = restitution;
  return add_body<Dim3>(world, {.type = BodyType::fixed, .position = position}, shape, surface);
}
/// n separate boxes at rest on nothing: no gravity, asleep.
inline World3 sleeping_boxes(int n) {
  rigid::WorldDef<Dim3> definition;
  definition.gravity = {};
  World3 world(definition);
  for (int i = 0; i < n; ++i)
    add_body<Dim3>(world, {.position = {2.0 * (i % 100), 2.0 * (i / 100 % 100), 2.0 * (i / 10000)}, .awake = false},
                   geometry::Box{{0.5f, 0.5f, 0.5f}}, {});
  return world;
}
/// A box as one more shape of a body.
inline void add_box(World3& world, BodyId body, math::Vec3f center, math::Vec3f half, const ShapeDef<Dim3>& surface) {
  ShapeDef<Dim3> placed = surface;
  placed.local.p = center;
  world.add_shape(body, geometry::Box{half}, placed).value();
}
inline void add_box(World2& world, BodyId body, math::Vec2f center, math::Vec2f half, const ShapeDef<Dim2>& surface) {
  world.add_shape(body, geometry::make_box2(half, 0, {center, {}}), surface).value();
}
inline std::shared_ptr<const geometry::Hull> hull_of(std::span<const math::Vec3f> points) {
  return geometry::make_hull(points).value();
}
inline std::shared_ptr<const geometry::TriangleMesh> mesh_of(geometry::Triangles triangles) {
  return geometry::make_triangle_mesh(std::move(triangles.positions), std::move(triangles.indices)).value();
}
/// A terrain of cells² squares of `cell` metres, centred, with vertex heights by index.
template <class Height>
std::shared_ptr<const geometry::TriangleMesh> terrain(int columns, int rows, float cell, math::Vec3f offset,
                                                      Height&& height) {
  geometry::Triangles t = geometry::make_terrain_mesh(columns, rows, {cell, cell}, height);
  for (math::Vec3f& p : t.positions) p += offset;
  return mesh_of(std::move(t));
}

}  // namespace carom::bench
