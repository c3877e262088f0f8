// What grains consist of, and what happens in a step.
#pragma once

#include <algorithm>
#include <vector>

#include "carom/core/scheduler.h"
#include "carom/particles/detail/aligned.h"
#include "carom/particles/detail/granular_block.h"
#include "carom/particles/granular.h"

namespace carom::particles::detail {

inline float grain_cross(math::Vec2f r, math::Vec2f f) { return r.x * f.y - r.y * f.x; }
inline math::Vec3f grain_cross(math::Vec3f r, math::Vec3f f) { return cross(r, f); }
inline math::Vec2f grain_turn(float spin, math::Vec2f r) { return {-spin * r.y, spin * r.x}; }
inline math::Vec3f grain_turn(math::Vec3f spin, math::Vec3f r) { return cross(spin, r); }
inline float grain_size(float spin) { return math::abs(spin); }
inline float grain_size(math::Vec2f v) { return length(v); }
inline float grain_size(math::Vec3f spin) { return length(spin); }

template <class D>
struct Grain {
  typename D::Vector x{};  ///< m, from the domain's lower corner
  typename D::Vector v{};
  typename D::Angular spin{};
  float radius = 0, curve = 0;  ///< m, 1/m: its inverse
  float inverse_mass = 0, inverse_inertia = 0;
  std::uint32_t tag = 0;
};

/// A grain and a wall or a shape, listed with the grain.
struct GrainTouch {
  std::uint32_t key = 0;  ///< of the surface
  int lane = 0;           ///< where it is solved: grain_lanes × block + lane; of a body that moves −1 − its contact
};

/// A grain and a body that moves.
template <class D>
struct GrainContact {
  int a = 0, solid = 0;
  float normal_impulse = 0;       ///< N·s
  typename D::Vector friction{};  ///< N·s on the body
  typename D::Angular rolling{};  ///< N·m·s on the body
  typename D::Vector normal{};    ///< from the grain to the body
  typename D::Vector arm{};       ///< from its centre to the contact
  float gap = 0;                  ///< m
};

template <class D>
struct GrainBody {
  rigid::BodyId id{};
  bool moves = false;
  typename D::Vector center{}, velocity{}, gain{};
  typename D::Angular spin{};
  float inverse_mass = 0;
  std::conditional_t<D::dimension == 2, float, math::Mat3f> inverse_inertia{};
  typename D::Vector impulse{};
  typename D::Angular turn{};
};

template <class D>
struct GrainSolid {
  typename D::Shape shape{};
  typename D::Transform at{};
  geometry::Bounds<typename D::Vector> bounds{};
  int body = -1;  ///< −1: does not move
  float friction = 0;
  float sheet = 0;  ///< m, as fluid_distance.h
  std::uint32_t key = 0;
};

/// m/s: between what velocities the grains of a cell lie and, as in space one ring of cells around tells too little of
/// what may stop them, nought.
template <class D>
struct Haste {
  static constexpr int N = D::dimension, lanes = N == 2 ? 4 : 8, down = lanes / 2;
  using Four = math::WideFloat<4>;
  float most[lanes];  ///< up the axes, and from `down` on down them

  Haste() { std::fill_n(most, lanes, N == 2 ? -1e30f : 0.0f); }
  void add(const typename D::Vector& v) {
    for (int k = 0; k < N; ++k) {
      most[k] = math::max(most[k], v[k]);
      most[down + k] = math::max(most[down + k], -v[k]);
    }
  }
  void add(const Haste& other) {
    for (int k = 0; k < lanes; k += 4) math::max(Four::load(most + k), Four::load(other.most + k)).store(most + k);
  }
  void add_still(int axis) {
    most[axis] = math::max(most[axis], 0.0f);
    most[down + axis] = math::max(most[down + axis], 0.0f);
  }
  typename D::Vector range() const {
    typename D::Vector r{};
    for (int k = 0; k < N; ++k) r[k] = most[k] + most[down + k];
    return r;
  }
};

/// A pair that is solved since a later stage: its grains, and its block and lane.
struct GrainLate {
  int a = 0, b = 0, at = 0;
};
/// The same, as the next search looks for it.
struct GrainLink {
  int other = 0, next = -1;  ///< `next`: the next one of the same first grain
};

/// Neighbouring columns of cells: their pairs are found and placed by one thread, without a look at other slabs'.
template <int N>
struct GrainSlab {
  std::vector<float> near;  ///< what is near a cell's grains (GrainRoom)
  std::vector<int> numbers;
  std::vector<int> pairs;  ///< its grains' pairs that may touch at once: room for more than pair_count
  int pair_count = 0;
  // Where they are solved, in the order of the slab's layers.
  std::vector<GrainBlock<N>> blocks;  ///< room for more than block_count, which is not made anew
  int block_count = 0;
  std::vector<int> pair_of, was;               ///< by block and lane: the pair's number, and its old one (GrainKernels)
  std::vector<int> filled;                     ///< lanes by block
  std::vector<int> open_block;                 ///< the next that has room, by block
  std::vector<GrainWait> later[grain_stages];  ///< pairs that do not touch at once: room for more than `waiting`
  int waiting[grain_stages] = {};
  std::vector<GrainLate> late;  ///< what of them has been placed
  float fastest = 0;            ///< m/s, that two pass each other that may touch at once
  bool astray = false;          ///< one of its grains has gone another way than was foreseen

  void add_block(std::uint32_t none);
};

template <class D>
struct GranularState {
  static constexpr int N = D::dimension;
  static constexpr float cell_radii = N == 2 ? 5 : 4;  ///< width of a cell in the largest radii
  static constexpr int rings = grain_rings<N>;
  /// Largest radii that two may close along an axis from search to search: no more than cells have room for.
  static constexpr float search_way = N == 2 ? 7.5f : 2;
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  using Position = typename D::Position;
  using Contact = GrainContact<D>;

  using Block = GrainBlock<N>;

  GranularDef<D> definition{};
  const GrainKernels<N>* kernels = nullptr;
  float inverse_cell = 0;
  int cells[3] = {1, 1, 1}, slab_cells = 1, size = 0;
  std::vector<int> column_start;  ///< number of the first cell of a slab's column
  Vector extent{};
  std::vector<Grain<D>> grains, sorted;
  std::uint64_t added = 0;  ///< in all, the stream of the next one's radius
  std::vector<int> cell_of, cell_start;
  std::vector<Haste<D>> haste, around, spare;  ///< by cell; of those within `rings`; what it is made with
  std::vector<int> old_place;                  ///< of a grain when contacts were last looked for
  std::vector<float> near_by[N + 1];           ///< places, then radii, in the order of the cells
  // While contacts are solved grains are rows of floats (granular_block.h); behind them one for each slab that is none.
  AlignedFloats place, motion;
  AlignedFloats origin;  ///< in the plane: places when contacts were last looked for
  AlignedFloats pace;    ///< m, rows by grain: how far another may close on it until the next search, by axis
  // Pairs that may touch at once: by grain the numbers of others, and what each pair held when last looked for. Behind
  // them come those that were placed later.
  std::vector<int> pairs, old_pairs, first_pair, old_first_pair;
  std::vector<int> was;             ///< twice the old number of a pair, and 1 where its grains are swapped; or −1
  int pair_count = 0, watched = 0;  ///< `watched`: with those that wait
  std::vector<GrainLink> late;
  std::vector<int> first_late;  ///< by grain, −1: none
  std::vector<float> held;
  std::vector<GrainSlab<N>> slabs;
  std::vector<int> last_block, last_across;  ///< the last block that a grain is in: of its slab, of the one before
  // Surfaces.
  std::vector<GrainTouch> touches, old_touches;
  std::vector<int> first_touch, old_first_touch;
  std::vector<Block> wall_blocks, old_wall_blocks;
  std::vector<int> wall_of;  ///< surface by block: a side, or 2 N + a solid
  std::vector<Contact> body_contacts, old_body_contacts;
  std::vector<int> surface_block;  ///< by surface: that which is being filled
  std::vector<GrainSolid<D>> solids;
  std::vector<GrainBody<D>> bodies;
  std::vector<rigid::ShapeId> found;
  Position wall_impulse{};
  float last_h = 0;
  GranularStatistics statistics{};
  core::TaskScheduler* scheduler = nullptr;

  float lightness() const { return 1 / (definition.density * math::pi_f); }  ///< GrainPass
  void make_grid();
  void reserve();
  core::Status add(Position at, Vector velocity, std::uint32_t tag, float radius, Angular spin, const char* call);
  core::Status fill(Position lower, Position upper, Vector velocity, std::uint32_t tag);
  core::Status gather(rigid::World<D>& world);
  int cell_at(int x, int y, int z) const;
  void sort();
  int grain_in(const Block& block, int lane) const;
  void to_rows();
  void from_rows();
  void find_pairs(float dt);
  template <class F>
  void for_cells(int slab, F&& f) const;
  void look_around();
  float time_to_search(float dt) const;
  bool astray(float time);
  void find_neighbours(GrainSlab<N>& slab, int x, int y, int z, float dt);
  int place_pair(GrainSlab<N>& slab, int end, int a, int b, int& last_of_a);
  int old_pair(int grain, int other) const;
  void match_pairs(GrainSlab<N>& slab, int begin, int end);
  void place_pairs(GrainSlab<N>& slab, int begin, int end);
  void place_later(GrainSlab<N>& slab, int end, int stage);
  void number_late();
  int slab_begin(int slab) const { return cell_start[std::size_t(slab) * (std::size_t(size) / slabs.size())]; }
  void find_surfaces(float dt);
  void touch(int grain, int surface, std::uint32_t key);
  bool near_solid(int grain, int index, float reach) const;
  void scale_surfaces(float scale);
  float fastest_beside_solids() const;
  float push_out(int grain, const Vector& normal, float gap, const GrainPass& pass);
  void measure_surfaces(const GrainPass& pass);
  bool measure_solid(const GrainSolid<D>& solid, const Vector& at, Vector& normal, float& distance) const;
  void press();
  template <class F>
  void for_slabs(F&& f);
  template <class F>
  void for_slabs_in_turn(bool back, F&& f);
  template <class F>
  void for_grains(int count, F&& f);
  void sweep(float h, bool back);
  void solve_body(Contact& contact, float h);
  void apply_body(const Contact& contact, float normal, Vector friction, Angular rolling);
  void sum_walls();
  float round(float dt, float whole);
  core::Status step(rigid::World<D>* world, float dt);
};

}  // namespace carom::particles::detail
