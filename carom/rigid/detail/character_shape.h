// What both kinds of characters are made of.
#pragma once

#include "carom/rigid/detail/check.h"
#include "carom/rigid/world.h"

namespace carom::rigid::detail {

inline Rot2f upright(Vec2f up) { return {up.y, -up.x}; }
inline Quatf upright(Vec3f up) {
  if (up.y < -0.9999f) return {0, 1, 0, 0};
  return normalize(Quatf{1 + up.y, up.z, 0, -up.x});
}
inline geometry::Shape2 make_capsule(Dim2, float half_length, float radius) {
  return geometry::Capsule2{half_length, radius};
}
inline geometry::Shape3 make_capsule(Dim3, float half_length, float radius) {
  return geometry::Capsule3{half_length, radius};
}

/// What both definitions have, and where it is to stand. Returns the length of `up`.
template <class Definition, class Position>
float check_character(Complaint& complaint, const Definition& d, const Position& feet) {
  check_range(complaint, "radius", double(d.radius), 1e-3, 1e3);
  check_range(complaint, "half_length", double(d.half_length), 0, 1e3);
  check_range(complaint, "max_slope", double(d.max_slope), 0, double(math::pi_f) / 2);
  check_range(complaint, "step_height", double(d.step_height), 0, 1e3);
  const float size = math::length(d.up);
  if (!(math::abs(size - 1) < 1e-3f)) complaint.say("up is not a unit vector, expected a length of 1");
  check_size(complaint, "feet", feet, max_coordinate);
  return size;
}

/// How fast a belt runs where its normal (outward, world axes) is this. `runs`: of its surface, world axes.
inline Vec2f belt_velocity(Vec2f runs, const Material& material, Vec2f normal) {
  const Vec2f tangent{-normal.y, normal.x};
  return tangent * (dot(runs, tangent) + material.tangent_speed);
}
inline Vec3f belt_velocity(Vec3f runs, const Material&, Vec3f normal) { return runs - normal * dot(runs, normal); }

/// A body with one shape, or neither.
template <class D>
Status make_character(World<D>& world, const BodyDef<D>& body, const typename D::Shape& capsule,
                      const ShapeDef<D>& definition, BodyId& id, ShapeId& shape) {
  const Result<BodyId> made = world.create_body(body);
  if (!made.ok()) return made.error();
  const Result<ShapeId> added = world.add_shape(made.value(), capsule, definition);
  if (!added.ok()) {
    (void)world.destroy_body(made.value());
    return added.error();
  }
  id = made.value(), shape = added.value();
  return {};
}

}  // namespace carom::rigid::detail
