// Contact between the particles of a system: grains, heaps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::particles {

/// Grains are spheres that turn and roll. Impulses by Gauss and Seidel over substeps, contacts remember them from step
/// to step; a gap that would close is kept from closing (D. E. Stewart & J. C. Trinkle, IJNME 39 (1996) 2673).
struct ContactDef {
  bool enabled = false;
  float restitution = 0.2f;  ///< 0 … 1, between particles
  float friction = 0.5f;     ///< ≥ 0, between particles
  float rolling = 0.1f;      ///< ≥ 0: resistance against rolling by the push, in radii; round grains 0, rough ones .2
  int substeps = 8;          ///< 1 … 64 a step; overlap under a heap goes with its square's inverse
  int iterations = 1;        ///< 1 … 64 a substep, each down and up through the heap
};
CAROM_API core::Status check(const ContactDef& definition);

namespace detail {

/// Grains in the order of the cells of a grid, and what touches.
class ContactSolver {
 public:
  struct Grain {
    math::Vec3f x, v, w;  ///< w: rad/s
    float inverse_mass, radius, inverse_inertia;
  };
  struct Contact {
    std::int32_t a, b;   ///< slots; b < 0: surface −1 − b
    math::Vec3f normal;  ///< from a to b, where they are; of a surface: toward it
    float offset;        ///< surface: the gap is this − normal · (x − u t)
    math::Vec3f u;       ///< m/s, of the surface
    math::Vec3f turn;    ///< rad/s, of the surface
    float inverse;       ///< 1/(1/m_a + 1/m_b)
    float friction, restitution, approach;
    float push = 0, most = 0;  ///< N·s: of this substep, and the greatest of the step
    math::Vec3f grip{};        ///< N·s, on b
    math::Vec3f roll{};        ///< N·m·s, on b
    float gap = 0;             ///< m, where they are
  };
  struct Pile {
    std::span<const float> x[3], v[3], w[3], scale;
    std::span<const std::uint32_t> ids;
    float radius, mass;
    double dt;
  };

  /// Room for so many grains, each with a few contacts, so that a warm step allocates only where there are more.
  void reserve(std::size_t grains);
  /// Sorts the grains of a pile into a grid and finds those that touch or may within dt.
  void begin(const Pile& pile, const ContactDef& definition);
  /// A surface near grain `index` of the pile.
  void add_surface(int index, int surface, float gap, math::Vec3f normal, math::Vec3f u, math::Vec3f turn,
                   float friction, float restitution);
  /// Solves and moves; `gained`: change of velocity over the step, by index, from forces.
  void solve(const ContactDef& definition, std::span<const math::Vec3f> gained, double dt);
  void finish();  ///< remembers impulses for the next step

  std::int32_t slot_of(int index) const { return slots_[std::size_t(index)]; }
  const Grain& grain(int index) const { return grains_[std::size_t(slots_[std::size_t(index)])]; }
  bool near_surface(int index) const { return near_surface_[std::size_t(slots_[std::size_t(index)])] != 0; }
  const std::vector<Contact>& contacts() const { return contacts_; }
  /// Momentum that surface contacts gave, by surface: to be added to `out`, with moments about `centers`.
  void exchanged(std::span<double> out, std::span<const math::Vec3f> centers) const;
  double worst_overlap() const;  ///< of pairs, in radii of the smaller one

 private:
  struct Memory {
    std::uint32_t other = 0;
    bool surface = false;
    float push = 0;
    math::Vec3f grip{}, roll{};
  };
  void sort_into_cells(const Pile& pile);
  void find_pairs(const Pile& pile, const ContactDef& definition);
  void recall();
  void measure(float t);
  void give(const Contact& c, math::Vec3f push, math::Vec3f grip, math::Vec3f roll, std::size_t i);
  void solve_contact(std::size_t i, float h, bool push_out);
  void solve_up(float h, bool push_out);
  void solve_down(float h, bool push_out);
  void restitute();

  std::vector<Grain> grains_;
  std::vector<std::int32_t> slots_, order_, cell_of_, cell_start_;
  std::vector<std::uint32_t> id_;  ///< by slot
  std::vector<std::uint8_t> near_surface_;
  std::vector<Contact> contacts_;
  std::vector<math::Vec3f> given_;  ///< by contact: total momentum a surface gave
  int cells_[3] = {1, 1, 1};
  float cell_size_ = 1, reach_ = 0;
  // By the id of the first: what was solved in the last step.
  std::vector<Memory> memory_, new_memory_;
  std::vector<std::int32_t> memory_start_, fill_;
  std::vector<std::uint32_t> memory_ids_;
  std::vector<std::int32_t> index_of_slot_;
  struct {
    float rate = 0, mass = 1, leak = 0;
  } soft_;
  float rolling_ = 0;
  std::size_t pairs_ = 0;  ///< of the contacts; those of surfaces follow
};

}  // namespace detail
}  // namespace carom::particles
