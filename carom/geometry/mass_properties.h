// Mass, centre of mass and inertia tensor of every shape, of compounds and of closed meshes (chapter 1.6, 1.8).
// All in double: these are computed once and everything after depends on them.
#pragma once

#include "carom/geometry/shape2.h"
#include "carom/geometry/shape3.h"

namespace carom::geometry {

struct MassProperties2 {
  double mass = 0;     ///< kg (a shape of the plane has kg/m²: one metre thick with density in kg/m³)
  Vec2d center{};      ///< m, in the shape's frame
  double inertia = 0;  ///< kg·m², about the centre of mass
};
struct MassProperties3 {
  double mass = 0;                ///< kg
  Vec3d center{};                 ///< m, in the shape's frame
  Mat3d inertia = Mat3d::zero();  ///< kg·m², about the centre of mass, axes of the shape's frame
};

/// density > 0: kg/m³. Segments and chains have no area: zero mass.
CAROM_API MassProperties2 mass_properties(const Shape2& shape, double density);
/// Planes, height fields, voxel grids and meshes that are not closed have zero mass; what a closed mesh encloses is
/// measured by mesh_mass_properties, which also says what is wrong with one that is not.
CAROM_API MassProperties3 mass_properties(const Shape3& shape, double density);

/// The properties of a and b together, both in the same frame.
CAROM_API MassProperties2 combine(const MassProperties2& a, const MassProperties2& b);
CAROM_API MassProperties3 combine(const MassProperties3& a, const MassProperties3& b);
/// The properties seen from the frame in which the shape stands at t.
CAROM_API MassProperties2 transform(const MassProperties2& m, const Transform2d& t);
CAROM_API MassProperties3 transform(const MassProperties3& m, const Transform3d& t);
/// I = I_c + m(|d|²E − d dᵀ): the tensor about a point at distance d from the centre of mass.
CAROM_API Mat3d transfer_inertia(const Mat3d& inertia, double mass, Vec3d d);
/// R I Rᵀ.
CAROM_API Mat3d rotate_inertia(const Mat3d& inertia, const Mat3d& r);

/// Principal moments in ascending order, and the rotation from principal axes to the body's frame.
struct PrincipalAxes {
  Vec3d moments{};
  Quatd rotation{};
};
CAROM_API PrincipalAxes principal_axes(const Mat3d& inertia);

/// What a closed surface encloses, by the divergence theorem. Vertices in one place count as one (STL files share
/// none); where edges stay open, so do vertices closer than 1e-6 of the mesh's size. Triangles run counterclockwise
/// seen from outside. A piece that lies inside another one and is wound the other way is a cavity, and its volume is
/// taken off.
struct MeshMass {
  MassProperties3 properties;
  double volume = 0, area = 0;  ///< m³, m²
  Bounds3d bounds;
  int triangles = 0;           ///< with an area; the others are left out
  int components = 0;          ///< pieces connected by edges, cavities included
  int cavities = 0;            ///< pieces that are holes in others
  int overlapping = 0;         ///< pieces that begin inside another one and are not cavities: counted twice
  int non_manifold_edges = 0;  ///< edges where more than two triangles meet, as many one way as the other: harmless
};
/// density > 0: kg/m³. Errors name the defect, how often it occurs and where the first one is: a bad index, a vertex
/// that is not finite, open edges, edges that more triangles run one way than the other, neighbours wound against each
/// other, a surface (or a piece that is no cavity) that is inside out, no volume.
CAROM_API core::Result<MeshMass> mesh_mass_properties(std::span<const Vec3d> vertices,
                                                      std::span<const std::uint32_t> indices, double density);

}  // namespace carom::geometry
