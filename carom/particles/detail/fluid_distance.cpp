#include "carom/particles/detail/fluid_distance.h"

#include "carom/geometry/compound.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/query.h"

namespace carom::particles::detail {

using geometry::Shape2;
using geometry::Shape3;
using math::Vec2f;
using math::Vec3f;

namespace {

float distance_to_segment(Vec2f p, Vec2f a, Vec2f b) {
  const Vec2f d = b - a;
  const float square = dot(d, d);
  const float t = square > 0 ? math::clamp(dot(p - a, d) / square, 0.0f, 1.0f) : 0.0f;
  return length(p - (a + t * d));
}

/// To a rectangle of half extents a, b about the origin, in the first quadrant of its symmetry.
float distance_to_rectangle(float x, float y, float a, float b) {
  const float dx = math::abs(x) - a, dy = math::abs(y) - b;
  const float ox = math::max(dx, 0.0f), oy = math::max(dy, 0.0f);
  return math::sqrt(ox * ox + oy * oy) + math::min(math::max(dx, dy), 0.0f);
}

float distance_to_polygon(const geometry::Polygon& s, Vec2f p) {
  float inside = -1e30f, outside = 1e30f;
  for (int i = 0; i < s.count; ++i) {
    inside = math::max(inside, dot(s.normals[i], p - s.vertices[i]));
    outside = math::min(outside, distance_to_segment(p, s.vertices[i], s.vertices[i + 1 == s.count ? 0 : i + 1]));
  }
  return (inside <= 0 ? inside : outside) - s.radius;
}

/// Positive to the right of the direction of travel. At a corner the segment decides that is seen least aslant.
float distance_to_chain(const geometry::Chain& chain, Vec2f p) {
  float nearest = 1e30f, across = 0;
  for (int i = 0; i < chain.segment_count(); ++i) {
    const geometry::ChainSegment c = chain.segment(i);
    const float d = distance_to_segment(p, c.a, c.b);
    if (d > nearest * 1.00001f) continue;
    const Vec2f way = c.b - c.a;
    const float side = ((p.x - c.a.x) * way.y - (p.y - c.a.y) * way.x) / length(way);
    if (d < nearest * 0.99999f || math::abs(side) > math::abs(across)) across = side;
    nearest = math::min(nearest, d);
  }
  return across < 0 ? -nearest : nearest;
}

/// A surface that is solid behind, down to three times the thickness of a sheet on both sides.
float one_sided(float distance, float thickness) {
  const float depth = 3 * thickness;
  return math::abs(distance + depth) - depth;
}

float distance_to_ellipsoid(Vec3f r, Vec3f p) {
  // The level set over its gradient: exact to first order at the surface.
  const Vec3f q = {p.x / r.x, p.y / r.y, p.z / r.z};
  const Vec3f g = {q.x / r.x, q.y / r.y, q.z / r.z};
  const float k = length(q), slope = length(g);
  return slope > 0 ? k * (k - 1) / slope : -math::min(r.x, math::min(r.y, r.z));
}

float distance_to_surface(const Shape3& s, Vec3f p) {
  math::Transform3f at;
  at.p = p;
  constexpr float dot_radius = 1e-5f;
  return geometry::distance(s, geometry::Sphere{dot_radius}, at).distance + dot_radius;
}

}  // namespace

float signed_distance(const Shape2& s, Vec2f p, float thickness) {
  using geometry::ShapeType2;
  switch (s.type) {
    case ShapeType2::circle:
      return length(p) - s.circle.radius;
    case ShapeType2::capsule:
      return distance_to_segment(p, {0, -s.capsule.half_length}, {0, s.capsule.half_length}) - s.capsule.radius;
    case ShapeType2::polygon:
      return distance_to_polygon(s.polygon, p);
    case ShapeType2::segment:
      return distance_to_segment(p, s.segment.a, s.segment.b) - thickness;
    case ShapeType2::chain_segment:
      return distance_to_segment(p, s.chain_segment.a, s.chain_segment.b) - thickness;
    case ShapeType2::chain:
      return one_sided(distance_to_chain(*s.chain, p), thickness);
  }
  return 1e30f;
}

float signed_distance(const Shape3& s, Vec3f p, float thickness) {
  using geometry::ShapeType3;
  switch (s.type) {
    case ShapeType3::sphere:
      return length(p) - s.sphere.radius;
    case ShapeType3::capsule: {
      const float y = p.y - math::clamp(p.y, -s.capsule.half_length, s.capsule.half_length);
      return math::sqrt(p.x * p.x + y * y + p.z * p.z) - s.capsule.radius;
    }
    case ShapeType3::box: {
      const Vec3f h = s.box.half_extents;
      const float dx = math::abs(p.x) - h.x, dy = math::abs(p.y) - h.y, dz = math::abs(p.z) - h.z;
      const Vec3f o = {math::max(dx, 0.0f), math::max(dy, 0.0f), math::max(dz, 0.0f)};
      return length(o) + math::min(math::max(dx, math::max(dy, dz)), 0.0f) - s.box.radius;
    }
    case ShapeType3::cylinder:
      return distance_to_rectangle(math::sqrt(p.x * p.x + p.z * p.z), p.y, s.cylinder.radius, s.cylinder.half_height) -
             s.cylinder.rounding;
    case ShapeType3::cone: {
      const float h = 2 * s.cone.half_height, slant = math::sqrt(h * h + s.cone.radius * s.cone.radius);
      const float r = math::sqrt(p.x * p.x + p.z * p.z), below = -s.cone.half_height - p.y;
      const float side = (r * h + (p.y - s.cone.half_height) * s.cone.radius) / slant;
      if (side < 0 && below < 0) return math::max(side, below) - s.cone.rounding;
      // The nearest of the base and of the side, from apex to rim.
      const float base = math::max(r - s.cone.radius, 0.0f);
      const float along =
          math::clamp((r * s.cone.radius - (p.y - s.cone.half_height) * h) / slant, 0.0f, slant) / slant;
      const float dx = r - along * s.cone.radius, dy = p.y - s.cone.half_height + along * h;
      return math::sqrt(math::min(base * base + below * below, dx * dx + dy * dy)) - s.cone.rounding;
    }
    case ShapeType3::ellipsoid:
      return distance_to_ellipsoid(s.ellipsoid.radii, p);
    case ShapeType3::hull: {
      float d = -1e30f;
      for (const geometry::HullPlane& plane : s.hull->planes) d = math::max(d, dot(plane.normal, p) - plane.offset);
      return d - s.hull->radius;
    }
    case ShapeType3::plane:
      return dot(s.plane.normal, p);
    case ShapeType3::compound: {
      float d = 1e30f;
      for (const geometry::CompoundChild& child : s.compound->children)
        d = math::min(d, signed_distance(child.shape, inverse_transform_point(child.local, p), thickness));
      return d;
    }
    case ShapeType3::height_field: {
      const geometry::CastHit3 ground = geometry::ray_cast(s, {p.x, p.y + 1e4f, p.z}, {0, -2e4f, 0});
      const float d = distance_to_surface(s, p);
      return one_sided(ground.hit && ground.point.y > p.y ? -d : d, thickness);
    }
    case ShapeType3::mesh:
    case ShapeType3::voxels:
      return distance_to_surface(s, p) - thickness;
  }
  return 1e30f;
}

}  // namespace carom::particles::detail
