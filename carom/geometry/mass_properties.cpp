// Mass properties of the shapes of space (reference 1.6, 1.8).
#include "carom/geometry/mass_properties.h"

#include "carom/geometry/compound.h"
#include "carom/geometry/detail/mass_hull.h"
#include "carom/geometry/detail/volume_integrals.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/elementary.h"

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

/// π∫R², π∫yR², π∫y²R² and π∫R⁴ over y, of a solid of revolution made of pieces.
struct Revolution {
  double volume = 0, first = 0, second = 0, fourths = 0;

  /// R from r0 to r1 in a straight line from y0 to y0 + h.
  void add_frustum(double y0, double h, double r0, double r1) {
    const double squares = h * (r0 * r0 + r0 * r1 + r1 * r1) / 3,
                 along = h * h * (r0 * r0 + 2 * r0 * r1 + 3 * r1 * r1) / 12,
                 along2 = h * h * h * (r0 * r0 + 3 * r0 * r1 + 6 * r1 * r1) / 30;
    volume += pi * squares;
    first += pi * (y0 * squares + along);
    second += pi * (y0 * y0 * squares + 2 * y0 * along + along2);
    fourths += pi * h * ((r0 * r0 + r1 * r1) * (r0 * r0 + r0 * r1 + r1 * r1) - r0 * r0 * r1 * r1) / 5;
  }
  /// R = a + r cos φ, y = c + r sin φ, with φ between two directions (cos, sin). dy = r cos φ dφ, and ∫cosⁿ by parts.
  void add_arc(double a, double c, double r, Vec2d from, Vec2d to) {
    double cosines[7], mixed[7];  // ∫cosⁿ, ∫cosⁿ sin
    cosines[0] = math::atan2(to.y, to.x) - math::atan2(from.y, from.x);
    cosines[1] = to.y - from.y;
    double f = from.x, t = to.x;  // cosⁿ⁻¹, then cosⁿ
    for (int n = 2; n < 7; ++n) {
      cosines[n] = (t * to.y - f * from.y + (n - 1) * cosines[n - 2]) / n;
      f *= from.x, t *= to.x;
      mixed[n - 1] = (f - t) / n;
    }
    const auto sines = [&](int n) { return cosines[n] - cosines[n + 2]; };  // ∫cosⁿ sin²
    const double a2 = a * a, r2 = r * r;
    const double squares = r * (a2 * cosines[1] + 2 * a * r * cosines[2] + r2 * cosines[3]),
                 along = r2 * (a2 * mixed[1] + 2 * a * r * mixed[2] + r2 * mixed[3]),
                 along2 = r2 * r * (a2 * sines(1) + 2 * a * r * sines(2) + r2 * sines(3));
    volume += pi * squares;
    first += pi * (c * squares + along);
    second += pi * (c * c * squares + 2 * c * along + along2);
    fourths += pi * r *
               (a2 * a2 * cosines[1] + 4 * a2 * a * r * cosines[2] + 6 * a2 * r2 * cosines[3] +
                4 * a * r2 * r * cosines[4] + r2 * r2 * cosines[5]);
  }
  MassProperties3 mass(double density) const {
    const double center = first / volume, axial = density * fourths / 2,
                 transverse = axial / 2 + density * (second - center * first);
    return detail::mass_of_diagonal(density * volume, {0, center, 0}, {transverse, axial, transverse});
  }
};

/// A quarter of a ring and more about the rim of the base, a frustum along the side, a cap on the apex.
MassProperties3 mass_of_rounded_cone(const Cone& cone, double density) {
  const double h = cone.half_height, a = cone.radius, r = cone.rounding, slant = math::sqrt(4 * h * h + a * a);
  const Vec2d out{2 * h / slant, a / slant};  // normal of the side
  Revolution body;
  body.add_arc(a, -h, r, {0, -1}, out);
  body.add_frustum(-h + r * out.y, 2 * h, a + r * out.x, r * out.x);
  body.add_arc(0, h, r, out, {0, 1});
  return body.mass(density);
}

MassProperties3 mass_of_cone(const Cone& cone, double density) {
  if (cone.rounding > 0) return mass_of_rounded_cone(cone, density);
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
