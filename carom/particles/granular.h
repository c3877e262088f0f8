// Sand, gravel, beads: round grains that touch, rub and roll on each other and on the bodies of a world.
//
//   auto sand = Granular2::create({.lower = {-2, 0}, .upper = {2, 2}, .radius = 0.02f}).value();
//   sand.add_box({-0.5, 0}, {0.5, 1});
//   each step:  sand.step(world, dt);  world.step(dt);
//
// A discrete element method of hard grains: contacts without springs, with Coulomb's cone and a limited rolling moment,
// solved for their impulses by projected Gauss–Seidel in small steps (contact dynamics: Jean, "The non-smooth contact
// dynamics method", Comput. Methods Appl. Mech. Eng. 177 (1999) 235; rolling moment: Ai, Chen, Rotter, Ooi, "Assessment
// of rolling resistance models in discrete element simulations", Powder Technol. 206 (2011) 269, model A as a limit).
// docs/fluids.md compares it with experiments.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/rigid/world.h"

namespace carom::particles {

/// Everything in SI units; in the plane grains are discs one metre thick.
template <class D>
struct GranularDef {
  using Position = typename D::Position;
  Position lower{};                                          ///< m, corner of the domain
  Position upper = unit_position();                          ///< m
  float radius = 0.01f;                                      ///< m, of the largest grains, 1e-4 … 10
  float radius_spread = 0.2f;                                ///< radii are uniform in [(1 − spread), 1] radius; 0 … 0.5
  float density = 2600;                                      ///< kg/m³ of the grains themselves, > 0
  float friction = 0.5f;                                     ///< Coulomb's μ between grains, 0 … 5
  float rolling_friction = 0.3f;                             ///< lever arm over radius, 0 … 5
  float wall_friction = 0.5f;                                ///< at walls and bodies
  typename D::Vector gravity = rigid::default_gravity<D>();  ///< m/s²
  bool walls[6] = {true, true, true, true, true, true};      ///< as FluidDef::walls
  int max_grains = 16384;                                    ///< 1 … 2^20
  int substeps = 8;                                          ///< 1 … 64, at least
  int iterations = 4;                                        ///< sweeps over the contacts in a substep, 1 … 100: two
                                                             ///< at least, one there and one back, and more where
                                                             ///< grains pass each other fast (docs/fluids.md)
  std::uint64_t seed = 1;                                    ///< of the radii
  int lanes = 0;                                             ///< 0: as many as the machine has; 4, 8, 16
  int threads = 1;                                           ///< 1 … 64
  core::TaskScheduler* scheduler = nullptr;                  ///< the caller's own, instead; must outlive the grains

  static constexpr Position unit_position() {
    if constexpr (D::dimension == 2)
      return {1, 1};
    else
      return {1, 1, 1};
  }
};

struct GranularStatistics {
  int grains = 0;
  int contacts = 0;         ///< pairs of grains that may touch in the step
  int wall_contacts = 0;    ///< grains with walls and bodies
  float max_overlap = 0;    ///< m, between grains
  float max_speed = 0;      ///< m/s
  double milliseconds = 0;  ///< of the last step, wall clock
};

/// Not thread-safe; two are independent. A copy is a second one with the same state. Results do not depend on threads
/// or on the machine. After a first step no step allocates while the number of contacts stays.
template <class D>
class CAROM_API Granular {
 public:
  using Vector = typename D::Vector;
  using Position = typename D::Position;
  using Angular = typename D::Angular;

  /// Errors: a field out of range, or a domain of more than 2^24 cells of five radii (in space four).
  static core::Result<Granular> create(const GranularDef<D>& definition);
  Granular(const Granular& other);
  Granular& operator=(const Granular& other);
  Granular(Granular&&) noexcept;
  Granular& operator=(Granular&&) noexcept;
  ~Granular();
  const GranularDef<D>& definition() const;

  /// Fills a box with grains on a lattice of two radii. Errors: not finite, no room for all (then none is added).
  core::Status add_box(Position lower, Position upper, Vector velocity = {}, std::uint32_t tag = 0);
  core::Status add_grain(Position position, Vector velocity = {}, std::uint32_t tag = 0, float radius = 0,
                         Angular spin = {});
  /// m/s. Errors: no such grain, not finite.
  core::Status set_velocity(int index, Vector velocity);
  void clear();

  /// Advances by dt seconds (0 < dt ≤ 0.1) among the bodies of `world`, which get their impulses as forces for the
  /// world's own step of the same dt that must follow. Errors: dt out of range, a world that refuses a force.
  core::Status step(rigid::World<D>& world, float dt);
  core::Status step(float dt);  ///< without bodies

  int size() const;
  Position position(int index) const;  ///< m, world; grains that left through an open side are gone
  Vector velocity(int index) const;
  Angular spin(int index) const;  ///< rad/s
  float radius(int index) const;
  std::uint32_t tag(int index) const;

  const GranularStatistics& statistics() const;
  double mass() const;              ///< kg
  double kinetic_energy() const;    ///< J, with that of rotation
  double potential_energy() const;  ///< J, zero at the world's origin
  Position momentum() const;        ///< kg·m/s
  Position wall_impulse() const;    ///< N·s that walls and fixed bodies took in the last step
  std::uint64_t state_hash() const;

 private:
  struct Implementation;
  explicit Granular(std::unique_ptr<Implementation> self);
  std::unique_ptr<Implementation> self_;
};

extern template class CAROM_API Granular<rigid::Dim2>;
extern template class CAROM_API Granular<rigid::Dim3>;
using Granular2 = Granular<rigid::Dim2>;
using Granular3 = Granular<rigid::Dim3>;

}  // namespace carom::particles
