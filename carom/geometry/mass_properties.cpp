// Mass properties of the shapes of space (reference 1.6, 1.8).
#include "carom/geometry/mass_properties.h"

#include "carom/geometry/compound.h"
#include "carom/geometry/detail/mass_hull.h"
#include "carom/geometry/detail/volume_integrals.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"

namespace carom::geometry {

namespace {

MassProperties3 mass_of_capsule3(const Capsule3& capsule, double density) {
  const double h = capsule.half_length, r = capsule.radius;
  const double tube = density * 2 * h * pi * r * r, ball = density * 4.0 / 3.0 * pi * r * r * r;
  const double axial = tube * r * r / 2 + ball * 2 * r * r / 5;
  // Each half ball's own centre stands 3r/8 beyond the end of the segment.
  const double transverse = tube * (3 * r * r + 4 * h * h) / 12 + ball * (2 * r * r / 5 + h * h + 0.75 * h * r);
  return detail::mass_of_diagonal(tube + ball, {}, {transverse, axial, transverse});
}

// ∫x² dV of a box of half extents (a, b, c) swept by a sphere of radius r: the box, a slab on each face, a quarter
// cylinder on each edge and an eighth of a ball at each corner.
double second_moment_of_rounded_box(double a, double b, double c, double r) {
  const double r2 = r * r, r3 = r2 * r, r4 = r2 * r2, r5 = r4 * r, a2 = a * a;
  const double core = 8 * a * b * c * a2 / 3;
  const double outward_slabs = 8 * b * c * (3 * a2 * r + 3 * a * r2 + r3) / 3;
  const double side_slabs = 8 * a * r * (b + c) * a2 / 3;
  const double edges_along = 2 * pi * r2 * a * a2 / 3;
  const double edges_across = 8 * (b + c) * (a2 * pi * r2 / 4 + 2 * a * r3 / 3 + pi * r4 / 16);
  const double corners = 8 * (a2 * pi * r3 / 6 + a * pi * r4 / 8 + pi * r5 / 30);
  return core + outward_slabs + side_slabs + edges_along + edges_across + corners;
}

MassProperties3 mass_of_ellipsoid(const Ellipsoid& e, double density) {
  const Vec3d r(e.radii), squares = scale(r, r);
  const double mass = density * 4.0 / 3.0 * pi * r.x * r.y * r.z;
  return detail::mass_of_diagonal(
      mass, {},
      {mass / 5 * (squares.y + squares.z), mass / 5 * (squares.z + squares.x), mass / 5 * (squares.x + squares.y)});
}

MassProperties3 mass_of_box(const Box& box, double density) {
  const double a = box.half_extents.x, b = box.half_extents.y, c = box.half_extents.z, r = box.radius;
  const double volume =
      8 * a * b * c + 8 * r * (a * b + b * c + c * a) + 2 * pi * r * r * (a + b + c) + 4.0 / 3.0 * pi * r * r * r;
  const double xx = density * second_moment_of_rounded_box(a, b, c, r);
  const double yy = density * second_moment_of_rounded_box(b, c, a, r);
  const double zz = density * second_moment_of_rounded_box(c, a, b, r);
  return detail::mass_of_diagonal(density * volume, {}, {yy + zz, zz + xx, xx + yy});
}

// A solid of revolution of radius R(y): V = π∫R², I_axial = (π/2)∫R⁴, ∫y²dV = π∫y²R². Beyond the core R = a + s with
// s² = r² − u² at the height h + u; the integrals of uᵏsᵐ from 0 to r are closed.
MassProperties3 mass_of_cylinder(const Cylinder& cylinder, double density) {
  const double h = cylinder.half_height, a = cylinder.radius, r = cylinder.rounding, outer = a + r,
               outer2 = outer * outer;
  const double r2 = r * r, r3 = r2 * r, r4 = r2 * r2, r5 = r4 * r, a2 = a * a;
  const double squares = a2 * r + a * pi * r2 / 2 + 2 * r3 / 3;
  const double fourths = a2 * a2 * r + a2 * a * pi * r2 + 4 * a2 * r3 + 3 * a * pi * r4 / 4 + 8 * r5 / 15;
  const double first = a2 * r2 / 2 + 2 * a * r3 / 3 + r4 / 4;         // ∫u (a + s)²
  const double second = a2 * r3 / 3 + a * pi * r4 / 8 + 2 * r5 / 15;  // ∫u² (a + s)²
  const double mass = density * 2 * pi * (h * outer2 + squares);
  const double axial = density * pi * (h * outer2 * outer2 + fourths);
  const double along = density * 2 * pi * (outer2 * h * h * h / 3 + h * h * squares + 2 * h * first + second);
  const double transverse = axial / 2 + along;
  return detail::mass_of_diagonal(mass, {}, {transverse, axial, transverse});
}

MassProperties3 mass_of_cone(const Cone& cone, double density) {
  const double h = 2.0 * cone.half_height, r = cone.radius, mass = density * pi * r * r * h / 3;
  const double transverse = 3 * mass * (r * r + h * h / 4) / 20;
  return detail::mass_of_diagonal(mass, {0, -h / 4, 0}, {transverse, 3 * mass * r * r / 10, transverse});
}

MassProperties3 mass_of_hull(const Hull& hull, double density) {
  const Vec3d origin(hull.centroid);
  MassProperties3 m = detail::mass_of(detail::integrate_hull(hull, origin), density);
  m.center += origin;
  return m;
}

MassProperties3 mass_of_compound(const Compound& compound, double density) {
  MassProperties3 sum;
  for (const CompoundChild& child : compound.children) {
    const Quatd q = normalize(Quatd{child.local.q.w, child.local.q.x, child.local.q.y, child.local.q.z});
    const Transform3d place{Vec3d(child.local.p), q};
    sum = combine(sum, transform(mass_properties(child.shape, density), place));
  }
  return sum;
}

}  // namespace

MassProperties3 mass_properties(const Shape3& shape, double density) {
  switch (shape.type) {
    case ShapeType3::sphere: {
      const double r = shape.sphere.radius, mass = density * 4.0 / 3.0 * pi * r * r * r, moment = 2 * mass * r * r / 5;
      return detail::mass_of_diagonal(mass, {}, {moment, moment, moment});
    }
    case ShapeType3::capsule:
      return mass_of_capsule3(shape.capsule, density);
    case ShapeType3::box:
      return mass_of_box(shape.box, density);
    case ShapeType3::cylinder:
      return mass_of_cylinder(shape.cylinder, density);
    case ShapeType3::cone:
      return mass_of_cone(shape.cone, density);
    case ShapeType3::ellipsoid:
      return mass_of_ellipsoid(shape.ellipsoid, density);
    case ShapeType3::hull:
      return mass_of_hull(*shape.hull, density);
    case ShapeType3::compound:
      return mass_of_compound(*shape.compound, density);
    case ShapeType3::mesh: {
      const std::vector<Vec3d> vertices(shape.mesh->vertices.begin(), shape.mesh->vertices.end());
      const core::Result<MeshMass> m = mesh_mass_properties(vertices, shape.mesh->indices, density);
      return m.ok() ? m->properties : MassProperties3{};
    }
    case ShapeType3::plane:
    case ShapeType3::height_field:
    case ShapeType3::voxels:
      break;
  }
  return {};
}

MassProperties3 combine(const MassProperties3& a, const MassProperties3& b) {
  const double mass = a.mass + b.mass;
  if (!(mass > 0)) return {};
  const Vec3d apart = b.center - a.center;
  return {mass, a.center + apart * (b.mass / mass),
          transfer_inertia(a.inertia + b.inertia, a.mass * (b.mass / mass), apart)};
}

MassProperties3 transform(const MassProperties3& m, const Transform3d& t) {
  return {m.mass, transform_point(t, m.center), rotate_inertia(m.inertia, to_matrix(t.q))};
}

Mat3d transfer_inertia(const Mat3d& inertia, double mass, Vec3d d) {
  return inertia + mass * (dot(d, d) * Mat3d::identity() - outer(d, d));
}

Mat3d rotate_inertia(const Mat3d& inertia, const Mat3d& r) {
  const Mat3d m = r * inertia * transpose(r);
  return 0.5 * (m + transpose(m));  // keeps the tensor exactly symmetric
}

}  // namespace carom::geometry
