// Cloth beside a world of rigid bodies: a mesh of triangles with the stiffness of a woven fabric along warp and weft.
//
// One implicit step of Euler's a substep, stable for any stiffness and step (Baraff and Witkin, "Large steps in cloth
// simulation", 1998). Stretch and shear are an orthotropic membrane in Green's strain, bending is quadratic in the
// positions: the curvature of each triangle by its neighbours' corners (Oñate and Zárate, "Rotation-free triangular
// plate and shell elements", 2000), with constant weights since cloth hardly stretches (Bergou et al. 2006). The linear
// system is solved by conjugate gradients on 3×3 blocks, contacts and pins are projected out of it and their reactions
// go to the bodies. Folds that meet are kept apart by impulses between vertices and triangles (Bridson, Fedkiw,
// Anderson 2002).
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "carom/core/scheduler.h"
#include "carom/environment/wind_field.h"
#include "carom/rigid/world.h"

namespace carom::particles {

/// A fabric: forces per metre of width, as testers of textiles measure them (Kawabata, "The standardization and
/// analysis of hand evaluation", 1980: tensile, shear and bending tester).
struct Fabric {
  double mass_per_area = 0.2;            ///< kg/m², > 0
  double warp_stiffness = 1000;          ///< N/m, E t along the warp; > 0
  double weft_stiffness = 1000;          ///< N/m, > 0
  double poisson_ratio = 0.2;            ///< weft's contraction when the warp is drawn; 0 … .49
  double shear_stiffness = 50;           ///< N/m a radian, > 0
  double bending_stiffness = 5e-6;       ///< N·m, moment per metre of width and curvature; ≥ 0
  double damping = 0.005;                ///< s: stress of the strain's rate, as a share of the stiffness; ≥ 0
  double thickness = 0.004;              ///< m: folds and bodies keep this apart, > 0
  double friction = 0.4;                 ///< mixed with a shape's as √(ab); ≥ 0
  double normal_coefficient = 1.2;       ///< pressure of a wind that meets it squarely: a plate's drag; ≥ 0
  double tangential_coefficient = 0.02;  ///< skin friction of both sides; ≥ 0
  double tear_tension = 0;               ///< N/m, 0: never
};

struct ClothDef {
  Fabric fabric{};
  std::span<const math::Vec3d> points{};       ///< m, the cloth at rest and where it begins
  std::span<const std::uint32_t> triangles{};  ///< three indices each
  math::Vec3d warp{1, 0, 0};                   ///< along the warp; laid into each triangle
  math::Vec3d velocity{};                      ///< m/s
  bool collide = true;                         ///< with shapes of the world
  bool self_collide = true;                    ///< folds: vertices and triangles
  /// Edges and edges of folds too, where threads cross between their vertices.
  bool self_collide_edges = false;
  rigid::Filter filter{};
  core::TaskScheduler* scheduler = nullptr;  ///< the caller's; outlives the cloth. Any gives the same bits.
  int lanes = 0;                             ///< 0: as many as the machine has; 4, 8, 16. The same bits too.
};

/// A rectangle of columns × rows vertices from `corner` along two edges, for ClothDef.
struct ClothSheet {
  std::vector<math::Vec3d> points;
  std::vector<std::uint32_t> triangles;
};
CAROM_API ClothSheet make_cloth_sheet(math::Vec3d corner, math::Vec3d along, math::Vec3d across, int columns, int rows);

namespace detail {
struct ClothState;
}

/// A value: a copy is a snapshot. Call `step` before World3::step with the same dt; of several that are to meet, that
/// of a SoftGroup.
class CAROM_API Cloth {
 public:
  /// Errors: a number out of its range, an index beyond the points, a triangle without area.
  static core::Result<Cloth> make(const ClothDef& definition);
  ~Cloth();
  Cloth(const Cloth&);
  Cloth& operator=(const Cloth&);
  Cloth(Cloth&&) noexcept;
  Cloth& operator=(Cloth&&) noexcept;

  /// Holds a vertex to a point of a body (its frame), or of the world where `body` is null.
  core::Status pin(int vertex, rigid::BodyId body, math::Vec3d point, const rigid::World3& world);
  /// Holds a vertex where it is.
  core::Status pin(int vertex);
  core::Status unpin(int vertex);
  /// `beyond`: what blows beyond the wind, by place.
  core::Status set_air(double density, const environment::Wind& wind, const environment::WindPatch& beyond = {});
  core::Status set_velocity(int vertex, math::Vec3d velocity);
  /// N·s. Of a pinned vertex the body that holds it takes it; the world's own pins take it away.
  core::Status add_impulse(int vertex, math::Vec3d impulse, rigid::World3& world);
  core::Status set_substeps(int substeps);  ///< 1 … 64 implicit steps a step; more: less damping

  core::Status step(rigid::World3& world, double dt);

  int vertex_count() const;
  std::span<const math::Vec3d> positions() const;
  std::span<const math::Vec3f> velocities() const;
  std::span<const float> masses() const;             ///< kg
  std::span<const std::uint32_t> triangles() const;  ///< changes where it tears
  bool torn() const;                                 ///< in the last step: there are new vertices
  double mass() const;                               ///< kg
  double area() const;                               ///< m², as it is now
  math::Vec3d momentum() const;
  double kinetic_energy() const;
  double elastic_energy() const;  ///< J, membrane and bending
  /// N on what holds the vertex, over the last step.
  math::Vec3d pin_force(int vertex) const;
  math::Vec3d wind_force() const;   ///< N on the whole cloth, at the last substep
  double greatest_tension() const;  ///< N/m, principal, in the last step
  int iterations() const;           ///< of the linear solver in the last step
  std::uint64_t state_hash() const;

 private:
  friend class SoftGroup;
  Cloth();
  std::unique_ptr<detail::ClothState> state_;
};

}  // namespace carom::particles
