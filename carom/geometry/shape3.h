// The shapes of space. A shape is a value in its own frame; whoever uses it brings the transform.
// Small shapes are stored inline, large ones (hulls, meshes, height fields, compounds) are immutable and shared.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/geometry/bounds.h"

namespace carom::geometry {

struct Hull;          // hull.h
struct TriangleMesh;  // triangle_mesh.h
struct HeightField;   // height_field.h
struct VoxelGrid;     // voxels.h
struct Compound;      // compound.h

struct Sphere {
  float radius = 0.5f;  ///< m, > 0
};
/// A segment along local y from −half_length to +half_length, swept by a sphere.
struct Capsule3 {
  float half_length = 0.5f;  ///< m, ≥ 0
  float radius = 0.25f;      ///< m, > 0
};
/// A box, swept by a sphere of `radius` (0: sharp): its outer half extents are half_extents + radius.
struct Box {
  Vec3f half_extents{0.5f, 0.5f, 0.5f};  ///< m, > 0
  float radius = 0;                      ///< m, ≥ 0
};
/// Axis along local y, from −half_height to +half_height, swept by a sphere of `rounding` (0: sharp): outside it is
/// larger by that.
struct Cylinder {
  float half_height = 0.5f;  ///< m, > 0
  float radius = 0.5f;       ///< m, > 0
  float rounding = 0;        ///< m, ≥ 0
};
/// Axis along local y: base of `radius` at −half_height, apex at +half_height, swept by a sphere of `rounding` (0:
/// sharp, with its centre of mass at −half_height/2).
struct Cone {
  float half_height = 0.5f;  ///< m, > 0
  float radius = 0.5f;       ///< m, > 0
  float rounding = 0;        ///< m, ≥ 0
};
/// Half axes along local x, y and z: (x/rx)² + (y/ry)² + (z/rz)² ≤ 1.
struct Ellipsoid {
  Vec3f radii{0.5f, 0.25f, 0.5f};  ///< m, > 0
};
/// The half-space below the plane through the origin with unit `normal`. Static bodies only.
struct Plane {
  Vec3f normal{0, 1, 0};
};

enum class ShapeType3 : std::uint8_t {
  sphere,
  capsule,
  box,
  cylinder,
  cone,
  ellipsoid,
  hull,
  plane,
  mesh,
  height_field,
  voxels,
  compound
};

/// Any shape of space.
struct Shape3 {
  ShapeType3 type = ShapeType3::sphere;
  union {
    Sphere sphere;
    Capsule3 capsule;
    Box box;
    Cylinder cylinder;
    Cone cone;
    Ellipsoid ellipsoid;
    Plane plane;
    const Hull* hull;  ///< kept alive by `data`, like the next four
    const TriangleMesh* mesh;
    const HeightField* height_field;
    const VoxelGrid* voxels;
    const Compound* compound;
  };
  std::shared_ptr<const void> data;

  Shape3() : sphere{} {}
  Shape3(const Sphere& s) : type(ShapeType3::sphere), sphere(s) {}
  Shape3(const Capsule3& s) : type(ShapeType3::capsule), capsule(s) {}
  Shape3(const Box& s) : type(ShapeType3::box), box(s) {}
  Shape3(const Cylinder& s) : type(ShapeType3::cylinder), cylinder(s) {}
  Shape3(const Cone& s) : type(ShapeType3::cone), cone(s) {}
  Shape3(const Ellipsoid& s) : type(ShapeType3::ellipsoid), ellipsoid(s) {}
  Shape3(const Plane& s) : type(ShapeType3::plane), plane(s) {}
  Shape3(std::shared_ptr<const Hull> s) : type(ShapeType3::hull), hull(s.get()), data(std::move(s)) {}
  Shape3(std::shared_ptr<const TriangleMesh> s) : type(ShapeType3::mesh), mesh(s.get()), data(std::move(s)) {}
  Shape3(std::shared_ptr<const HeightField> s)
      : type(ShapeType3::height_field), height_field(s.get()), data(std::move(s)) {}
  Shape3(std::shared_ptr<const VoxelGrid> s) : type(ShapeType3::voxels), voxels(s.get()), data(std::move(s)) {}
  Shape3(std::shared_ptr<const Compound> s) : type(ShapeType3::compound), compound(s.get()), data(std::move(s)) {}
};

inline bool is_convex(const Shape3& s) { return s.type <= ShapeType3::hull; }
/// A surface of triangles. Surfaces do not collide with each other.
inline bool is_surface(const Shape3& s) { return s.type >= ShapeType3::mesh && s.type <= ShapeType3::voxels; }

/// How many materials the parts of the shape name: the greatest number and one; 0 where it has none.
CAROM_API int material_count(const Shape3& shape);
/// The material of a triangle or cell, named as CastHit and Manifold3 name it; 0 for all else.
CAROM_API std::uint8_t material_of_part(const Shape3& shape, std::uint32_t child);

/// Says what is wrong with a shape that a user filled in by hand (a radius that is not positive and finite, …).
CAROM_API core::Status validate(const Shape3& shape);
/// The tight bounds of the shape placed by t (for a mesh, height field or grid: the bounds of its placed local box). A
/// plane is ±infinity except where it is axis-aligned.
CAROM_API Bounds3f bounds(const Shape3& shape, const Transform3f& t);
/// The point farthest along `direction`, in the shape's frame, including its radius. Convex shapes only.
CAROM_API Vec3f support(const Shape3& shape, Vec3f direction);

}  // namespace carom::geometry
