// Soft bodies with volume beside a world of rigid bodies: tetrahedra of an elastic solid.
//
// Linear elasticity in a frame that turns with each tetrahedron (corotated: Müller and Gross, "Interactive virtual
// materials", 2004), one implicit step of Euler's a substep, stable for any stiffness and step. What lies inside is
// solid; `set_pressure` blows it up from within.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "carom/core/scheduler.h"
#include "carom/rigid/world.h"

namespace carom::particles {

struct SoftMaterial {
  double density = 1000;        ///< kg/m³, > 0
  double youngs_modulus = 1e5;  ///< Pa, > 0
  double poisson_ratio = 0.4;   ///< 0 … .48
  double damping = 0.005;       ///< s: stress of the strain's rate, as a share of the stiffness; ≥ 0
  double friction = 0.5;        ///< mixed with a shape's as √(ab); ≥ 0
  double skin = 0.005;          ///< m: vertices keep so far from shapes, > 0
};

struct SoftBodyDef {
  SoftMaterial material{};
  std::span<const math::Vec3d> points{};        ///< m
  std::span<const std::uint32_t> tetrahedra{};  ///< four indices each, in any order
  math::Vec3d velocity{};                       ///< m/s
  bool collide = true;
  rigid::Filter filter{};
  core::TaskScheduler* scheduler = nullptr;  ///< the caller's; outlives the body. Any gives the same bits.
  int lanes = 0;                             ///< 0: as many as the machine has; 4, 8, 16. The same bits too.
};

struct SoftMesh {
  std::vector<math::Vec3d> points;
  std::vector<std::uint32_t> tetrahedra;
};
/// A box of cells, each of five tetrahedra that alternate.
CAROM_API SoftMesh make_soft_box(math::Vec3d corner, math::Vec3d size, int nx, int ny, int nz);
/// A ball of about `cells` cells across: a box's cells drawn out to the sphere.
CAROM_API SoftMesh make_soft_ball(math::Vec3d center, double radius, int cells);

namespace detail {
struct SoftState;
}

/// A value: a copy is a snapshot. Call `step` before World3::step with the same dt; of several that are to meet, that
/// of a SoftGroup.
class CAROM_API SoftBody {
 public:
  /// Errors: a number out of its range, an index beyond the points, a tetrahedron without volume.
  static core::Result<SoftBody> make(const SoftBodyDef& definition);
  ~SoftBody();
  SoftBody(const SoftBody&);
  SoftBody& operator=(const SoftBody&);
  SoftBody(SoftBody&&) noexcept;
  SoftBody& operator=(SoftBody&&) noexcept;

  core::Status pin(int vertex);  ///< where it is
  core::Status pin(int vertex, rigid::BodyId body, math::Vec3d point, const rigid::World3& world);
  core::Status unpin(int vertex);
  core::Status set_velocity(int vertex, math::Vec3d velocity);
  /// N·s. Of a pinned vertex the body that holds it takes it; the world's own pins take it away.
  core::Status add_impulse(int vertex, math::Vec3d impulse, rigid::World3& world);
  core::Status set_force(int vertex, math::Vec3d force);  ///< N, until it is set anew
  core::Status set_substeps(int substeps);                ///< 1 … 64
  core::Status set_pressure(double pressure);             ///< Pa from within on the surface, beside the solid's own

  core::Status step(rigid::World3& world, double dt);

  int vertex_count() const;
  std::span<const math::Vec3d> positions() const;
  std::span<const math::Vec3f> velocities() const;
  std::span<const std::uint32_t> surface() const;  ///< triangles, outward
  double mass() const;                             ///< kg
  double volume() const;                           ///< m³, as it is now
  double rest_volume() const;
  math::Vec3d momentum() const;
  double kinetic_energy() const;
  double elastic_energy() const;  ///< J, as it is now; without what the pressure does
  math::Vec3d center() const;     ///< of mass
  int iterations() const;
  std::uint64_t state_hash() const;

 private:
  friend class SoftGroup;
  SoftBody();
  std::unique_ptr<detail::SoftState> state_;
};

}  // namespace carom::particles
