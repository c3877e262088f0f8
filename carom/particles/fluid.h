// A liquid of particles in a box-shaped domain, in the plane or in space: it fills, splashes, carries and drags bodies.
//
//   auto water = Fluid3::create({.lower = {0, 0, 0}, .upper = {2, 1, 1}, .spacing = 0.025f}).value();
//   water.add_box({0, 0, 0}, {0.6, 0.6, 1});
//   each step:  water.step(world, dt);  world.step(dt);
//
// Particles carry the liquid and its velocity, a grid makes it incompressible: affine particle-in-cell transfers
// (Jiang, Schroeder, Selle, Teran, Stomakhin, "The affine particle-in-cell method", 2015) on a staggered grid (Harlow &
// Welch 1965), a pressure that meets walls and bodies in cut cells (Ng, Min, Gibou, "An efficient fluid–solid coupling
// algorithm for single-phase flows", 2009) and is solved together with the motion of the bodies (Batty, Bertails,
// Bridson, "A fast variational framework for accurate solid–fluid coupling", 2007), a free surface within the cell
// (Gibou, Fedkiw, Cheng, Kang 2002), and a second, weaker solve that keeps particles evenly spread (Kugelstadt, Longva,
// Thuerey, Bender, "Implicit density projection for volume conserving liquids", 2019). docs/fluids.md says why.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/rigid/world.h"

namespace carom::particles {

/// Everything in SI units. In the plane densities are per area (kg/m²), as those of the rigid world are.
template <class D>
struct FluidDef {
  using Position = typename D::Position;
  Position lower{};                  ///< m, corner of the domain
  Position upper = unit_position();  ///< m; rounded up to whole cells of 2 spacings
  float spacing = 0.05f;             ///< m between particles at rest, 1e-4 … 100; a cell is two of them wide
  float density = 1000;              ///< kg/m³ (plane: kg/m²), > 0
  float viscosity = 1e-6f;           ///< m²/s, kinematic; the scheme itself adds a little
  float surface_tension = 0;  ///< N/m (plane: N), 0 … 10; matters where a drop is smaller than a centimetre or two
  typename D::Vector gravity = rigid::default_gravity<D>();  ///< m/s²
  /// Sides of the domain that are walls: lower x, upper x, lower y, … What leaves through an open side is gone.
  bool walls[6] = {true, true, true, true, true, true};
  int max_particles = 32768;                 ///< 1 … 2^22; room is made for all of them beforehand
  float courant = 2.0f;                      ///< cells a particle may cross in a substep, 0.1 … 5
  int max_substeps = 4;                      ///< in a step, 1 … 64: faster liquid crosses more cells
  int threads = 1;                           ///< that the fluid makes for itself, 1 … 64
  core::TaskScheduler* scheduler = nullptr;  ///< the caller's own, instead; must outlive the fluid

  static constexpr Position unit_position() {
    if constexpr (D::dimension == 2)
      return {1, 1};
    else
      return {1, 1, 1};
  }
};

/// A jet: a disc (plane: a line) across `velocity` from which liquid comes as long as it is open.
template <class D>
struct FluidTap {
  typename D::Position center{};
  typename D::Vector velocity{};  ///< m/s, not zero
  float radius = 0.1f;            ///< m, > 0
  std::uint32_t tag = 0;
  bool open = true;
};
/// A box that swallows what comes into it.
template <class D>
struct FluidDrain {
  typename D::Position lower{}, upper{};
  bool open = true;
};

/// Of the last step (energies and momentum: as it is now).
struct FluidStatistics {
  int particles = 0;
  int substeps = 0;
  int liquid_cells = 0;
  int iterations = 0;            ///< of the pressure solver, all substeps
  int spreading_iterations = 0;  ///< of the solver that spreads particles
  bool converged = true;         ///< every pressure solve came below its tolerance
  float divergence = 0;          ///< largest that is left in a cell, as a velocity across a cell (m/s)
  float mean_density = 1;        ///< in cells within the liquid, 1: at rest
  float density_deviation = 0;   ///< root mean square about 1, of cells within the liquid
  float max_speed = 0;           ///< m/s
  double milliseconds[6] = {};   ///< sort, to the grid, solids, pressure, spreading, to the particles (wall clock)
};

/// Not thread-safe; two fluids are independent. A copy is a whole second fluid with the same state (for rollback).
/// Results do not depend on threads or on the machine. After a first step no step allocates.
template <class D>
class CAROM_API Fluid {
 public:
  using Vector = typename D::Vector;
  using Position = typename D::Position;
  using Angular = typename D::Angular;

  /// Errors: a field out of range, or a domain of more than 2^24 cells.
  static core::Result<Fluid> create(const FluidDef<D>& definition);
  Fluid(const Fluid& other);
  Fluid& operator=(const Fluid& other);
  Fluid(Fluid&&) noexcept;
  Fluid& operator=(Fluid&&) noexcept;
  ~Fluid();
  const FluidDef<D>& definition() const;

  /// Fills a box with particles on a lattice, those inside the domain. Errors: not finite, no room for all (then none
  /// is added).
  core::Status add_box(Position lower, Position upper, Vector velocity = {}, std::uint32_t tag = 0);
  /// The same within a ball (plane: a disc).
  core::Status add_ball(Position center, float radius, Vector velocity = {}, std::uint32_t tag = 0);
  core::Status add_particle(Position position, Vector velocity = {}, std::uint32_t tag = 0);
  /// m/s. Errors: no such particle, not finite.
  core::Status set_velocity(int index, Vector velocity);
  void clear();
  /// Returns the number of the tap or drain.
  core::Result<int> add_tap(const FluidTap<D>& tap);
  core::Status set_tap(int index, const FluidTap<D>& tap);
  core::Result<int> add_drain(const FluidDrain<D>& drain);
  core::Status set_drain(int index, const FluidDrain<D>& drain);

  /// Advances by dt seconds (0 < dt ≤ 0.1) among the bodies of `world`, which get their impulses as forces for
  /// the world's own step of the same dt, which must follow. What a body weighs in the liquid follows from its velocity
  /// and mass as the world has them now. Errors: dt out of range, a world that refuses an impulse.
  /// With surface tension: dt of more than 64 times the period of the shortest ripples over 4π.
  core::Status step(rigid::World<D>& world, float dt);
  /// Without bodies.
  core::Status step(float dt);

  int size() const;
  /// m, world.
  Position position(int index) const;
  Vector velocity(int index) const;
  std::uint32_t tag(int index) const;
  /// All positions in m from `definition().lower`, in the order of the indices; they change order in every step.
  std::span<const Vector> positions() const;
  float particle_mass() const;  ///< kg

  /// Pa (plane: N/m) over that of the air, at the last substep; 0 outside of the liquid.
  float pressure(Position point) const;
  /// Share of the rest density at a point: 1 within the liquid, about ½ at its surface.
  float density(Position point) const;
  /// The liquid's volume (area) by its particles, m³ (m²).
  double volume() const;
  /// Height (m, world) of the surface in the column of cells at `point`; definition().lower.y where there is none.
  double surface_height(Position point) const;

  const FluidStatistics& statistics() const;
  double kinetic_energy() const;    ///< J
  double potential_energy() const;  ///< J, zero at the world's origin
  Position momentum() const;        ///< kg·m/s
  /// kg·m²/s about the origin, with that of the particles' own turning.
  std::conditional_t<D::dimension == 2, double, math::Vec3d> angular_momentum() const;
  /// N·s that the walls, fixed and kinematic bodies took from the liquid in the last step.
  Position wall_impulse() const;
  std::uint64_t state_hash() const;
  std::size_t bytes() const;

 private:
  struct Implementation;
  explicit Fluid(std::unique_ptr<Implementation> self);
  std::unique_ptr<Implementation> self_;
};

extern template class CAROM_API Fluid<rigid::Dim2>;
extern template class CAROM_API Fluid<rigid::Dim3>;
using Fluid2 = Fluid<rigid::Dim2>;
using Fluid3 = Fluid<rigid::Dim3>;

}  // namespace carom::particles
