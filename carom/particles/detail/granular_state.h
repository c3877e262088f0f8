// What grains consist of, and what happens in a step.
#pragma once

#include <vector>

#include "carom/core/scheduler.h"
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
  float radius = 0, inverse_mass = 0, inverse_inertia = 0;
  std::uint32_t id = 0, tag = 0;
};

/// Two grains, or a grain and a wall or body (`b` is then −1 − surface).
template <class D>
struct GrainContact {
  int a = 0, b = 0;
  std::uint32_t key = 0;          ///< id of b's grain or number of the surface, to find it again
  float normal_impulse = 0;       ///< N·s
  typename D::Vector friction{};  ///< N·s on b
  typename D::Angular rolling{};  ///< N·m·s on b
  typename D::Vector normal{};    ///< from a to b
  typename D::Vector arm{};       ///< surfaces of bodies: from their centre to the contact
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

template <class D>
struct GranularState {
  static constexpr int N = D::dimension;
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  using Position = typename D::Position;
  using Contact = GrainContact<D>;

  GranularDef<D> definition{};
  float cell = 0, inverse_cell = 0;
  int cells[3] = {1, 1, 1}, stride[3] = {1, 0, 0}, size = 0;
  Vector extent{};
  std::vector<Grain<D>> grains, sorted;
  std::uint32_t next_id = 0;
  std::uint64_t added = 0;  ///< in all, the stream of the next one's radius
  std::vector<int> cell_of, cell_start;
  std::vector<float> near_by[N + 1];  ///< places, then radii, in the order of the cells
  std::vector<Contact> contacts, old_contacts, sorted_old, surface_contacts, old_surface_contacts;
  std::vector<int> slab_start;           ///< first contact of each slab of layers
  std::vector<int> old_start, place_of;  ///< by id: first old contact; where a grain lies now
  std::vector<int> first_surface;        ///< by place: first contact with a surface
  std::vector<std::uint32_t> free_ids;
  float last_h = 0;
  std::vector<GrainSolid<D>> solids;
  std::vector<GrainBody<D>> bodies;
  std::vector<rigid::ShapeId> found;
  Position wall_impulse{};
  GranularStatistics statistics{};
  core::TaskScheduler* scheduler = nullptr;

  void make_grid();
  void reserve();
  core::Status add(Position at, Vector velocity, std::uint32_t tag, float radius, Angular spin, const char* call);
  core::Status fill(Position lower, Position upper, Vector velocity, std::uint32_t tag);
  core::Status gather(rigid::World<D>& world);
  void sort();
  void find_contacts(float dt);
  void find_surfaces(float dt);
  void remember(Contact& contact, const std::vector<Contact>& old, std::uint32_t a, std::uint32_t b) const;
  void touch_solid(int grain, const GrainSolid<D>& solid, int index, float reach);
  void touch_wall(int grain, int side, float reach);
  void measure();
  void round(float dt, int parts);
  void warm_start();
  template <class F>
  void for_slabs(bool back, F&& f);
  void sweep(float h, bool back);
  void separate();
  void solve_pair(Contact& contact, float h);
  void solve_surface(Contact& contact, float h);
  void apply_pair(const Contact& contact, float normal, Vector friction, Angular rolling);
  void apply_surface(const Contact& contact, float normal, Vector friction, Angular rolling);
  core::Status step(rigid::World<D>* world, float dt);
};

}  // namespace carom::particles::detail
