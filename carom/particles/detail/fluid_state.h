// What a fluid consists of: particles, the grid they are carried to and from, and the cut cells round solids.
// Positions are in cells from the lower corner of the domain, velocities in m/s, the solver's pressure P = p·dt/(ρ·h)
// in m/s, so that a face between two cells changes its velocity by their difference.
#pragma once

#include <array>
#include <chrono>
#include <vector>

#include "carom/core/scheduler.h"
#include "carom/particles/fluid.h"

namespace carom::particles::detail {

using math::Vec2d;
using math::Vec2f;
using math::Vec3d;
using math::Vec3f;

/// One cache line in space.
template <int N>
struct FluidParticle {
  float x[N];
  float v[N];
  float c[N * N];  ///< c[a * N + b] = ∂v_a/∂x_b, m/s a cell
  std::uint32_t tag;
};

/// A box of cells with one more all round; faces and nodes are numbered as the cell above them.
struct FluidGrid {
  int cells[3] = {1, 1, 1};
  int stride[3] = {1, 0, 0};
  int first = 0;  ///< index of cell (0, 0, 0)
  int size = 0;   ///< of arrays over the padded box
  int index(int i, int j, int k) const { return first + i + j * stride[1] + k * stride[2]; }
};

/// A body of the world that the liquid can feel in this step.
template <class D>
struct FluidBody {
  using Vector = typename D::Vector;
  using Angular = typename D::Angular;
  rigid::BodyId id{};
  bool moves = false;     ///< by forces
  Vector center{};        ///< m, from the domain's lower corner
  Vector velocity{};      ///< m/s as the solver has it, all impulses so far included
  Angular spin{};         ///< rad/s
  Vector gain{};          ///< m/s²: what else accelerates it, as far as is known beforehand
  Vector inverse_mass{};  ///< 1/kg along the world's axes (zero where locked)
  std::conditional_t<D::dimension == 2, float, math::Mat3f> inverse_inertia{};
  Vector impulse{};                    ///< N·s so far in this step
  Angular turn{};                      ///< N·m·s
  int first_cell = 0, cell_count = 0;  ///< its part of `FluidSystem::touched`
};

/// What is known of a body from the last step, to tell what contacts do to it.
template <class D>
struct FluidMemory {
  rigid::BodyId id{};
  typename D::Vector velocity{};  ///< with the impulses that the fluid gave
  float dt = 0;
};

/// Cells from low to high, both included.
struct FluidRange {
  int low[3] = {0, 0, 0}, high[3] = {-1, 0, 0};
};

/// A shape placed in the domain.
template <class D>
struct FluidSolid {
  typename D::Shape shape{};
  typename D::Transform at{};  ///< shape → domain, m
  geometry::Bounds<typename D::Vector> bounds{};
  int owner = -1;       ///< index into the bodies; −1: does not move
  bool shared = false;  ///< another shape of the same body comes before it
};

/// A row of the pressure equation.
template <int N>
struct FluidRow {
  float diagonal;
  float minus[N], plus[N];          ///< −coefficient of the neighbours
  int minus_cell[N], plus_cell[N];  ///< compact index; the number of rows where there is none
};
/// A cell at a moving body: the body's area vector in it, and its moment, in units of a cell's side.
template <int N>
struct FluidTouch {
  int cell;
  float area[N];
  float moment[N == 2 ? 1 : 3];  ///< m
};

/// One side of a row after scaling by the preconditioner. The neighbour along x is the row next to it.
template <int N>
struct FluidLinks {
  float along;          ///< of the neighbour along x
  float across[N - 1];  ///< of the others
  int cell[N - 1];      ///< compact index; the number of rows where there is none
};

/// Four runs of rows, each of which hangs on the row before it: a sweep takes them in step, so that none waits for the
/// one before it alone. A run lags as many rows behind as what its rows hang on asks for.
struct FluidRuns {
  static constexpr int together = 4;
  int base[together] = {}, lag[together] = {}, count[together] = {};  ///< row m of a run is base ± m
  int first = 0, last = 0, end = 0;                                   ///< steps in which all have a row; of all
};

template <int N>
struct FluidSystem {
  std::vector<FluidRow<N>> rows;
  std::vector<FluidLinks<N>> below, above;  ///< factors of the preconditioner
  std::vector<FluidRuns> up, down;          ///< runs of its sweeps
  std::vector<float> right, x, residual, search, product, z;
  std::vector<float> scale, inverse_scale;  ///< of a row and its unknown
  std::vector<float> middle;                ///< the scaled diagonal less 2
  std::vector<FluidTouch<N>> touched;
  std::array<std::vector<float>*, 9> vectors() {
    return {&right, &x, &residual, &search, &product, &z, &scale, &inverse_scale, &middle};
  }
};

enum FluidCell : std::uint8_t { fluid_air = 0, fluid_liquid = 1 };

template <class D>
struct FluidState {
  static constexpr int N = D::dimension;
  static constexpr int move_grain = 2048;
  using Vector = typename D::Vector;
  using Position = typename D::Position;
  using Angular = typename D::Angular;
  using Particle = FluidParticle<N>;

  FluidDef<D> definition{};
  FluidGrid grid{};
  float cell = 0;           ///< m
  float inverse_cell = 0;   ///< 1/m
  float cell_mass = 0;      ///< kg of a full cell: ρ h^N
  float particle_mass = 0;  ///< kg
  std::vector<FluidTap<D>> taps;
  std::vector<float> tap_phase;  ///< m since the last layer
  std::vector<FluidDrain<D>> drains;

  std::vector<Particle> particles, sorted;
  std::vector<int> cell_of, cell_start;
  std::vector<Vector> places;  ///< m, from the domain's lower corner

  // Over the padded grid, one array a component where faces are meant.
  std::vector<float> carried[N];                     ///< mass and momentum by turns, in particles
  std::vector<float> mass;                           ///< at cells, in particles
  std::vector<float> velocity[N];                    ///< after the solver
  std::vector<float> spread[N];                      ///< displacement, cells
  std::vector<float> node_distance, fixed_distance;  ///< m, at nodes
  std::vector<float> open[N], fixed_open[N];         ///< share of a face that is open
  std::vector<std::int16_t> node_owner;              ///< whose distance a node has: body or −1
  std::vector<float> room, fixed_room;               ///< mass that a cell can have, in full cells
  std::vector<float> fill;                           ///< mass/room: 1 in the liquid
  std::vector<float> level;                          ///< distance to the free surface in cells, negative in the liquid
  std::vector<std::uint8_t> kind;
  std::vector<std::uint8_t> known[N];       ///< 1: by the solver, 2, 3: continued from there
  std::vector<int> row_of;                  ///< compact index or −1
  std::vector<int> component;               ///< of cells that particles reach, −1 elsewhere
  std::vector<float> pressure;              ///< m/s, of the last substep
  std::vector<float> volume, fixed_volume;  ///< open share of a cell
  std::vector<FluidRange> painted;          ///< where moving bodies were drawn last
  float pressure_dt = 0;
  float spreading_rate = 60;  ///< 1/s: how fast unevenness is taken out

  std::vector<float> curvature, smooth;  ///< of the surface, 1/cells; with surface tension only
  std::vector<int> liquid;               ///< cells, ascending
  FluidSystem<N> system;
  std::vector<FluidSolid<D>> solids;
  std::vector<FluidBody<D>> bodies;
  std::vector<FluidMemory<D>> memory;
  std::vector<rigid::ShapeId> found;
  std::uint64_t fixed_hash = 0;
  bool fixed_known = false;
  struct Budget {
    Position before{}, after{}, given{};
    double mass = 0;
    bool sealed = true;  ///< no free surface anywhere
    double excess = 0;
    int cells = 0;
    Position surface{};  ///< impulse of the surface's tension on the liquid
    bool held = false;   ///< touches something that is closed
  };
  std::vector<Budget> budgets;  ///< one a component
  std::vector<int> queue;
  std::vector<Position> body_push;  ///< per chunk and body, of collisions
  std::vector<Angular> body_twist;
  Position wall_impulse{};
  FluidStatistics statistics{};
  core::TaskScheduler* scheduler = nullptr;

  // fluid_grid.inl
  void sort();
  void to_grid();
  void classify();
  void label();
  // fluid_solids.inl
  core::Status gather_solids(rigid::World<D>& world, float dt);
  FluidBody<D> describe(const rigid::World<D>& world, rigid::BodyId id, const rigid::BodyState<D>& state, float dt);
  void place_solids();
  void paint_fixed();
  void paint(const FluidSolid<D>& solid, std::vector<float>& distance, std::vector<float>& space, std::int16_t owner);
  FluidRange range_of(const geometry::Bounds<Vector>& bounds, int margin) const;
  void measure_openings(const FluidRange& range, const std::vector<float>& distance, std::vector<float> (&into)[N]);
  void measure_room(const FluidRange& range, const std::vector<float>& space, std::vector<float>& into);
  int face_owner(int component, int face) const;
  Vector solid_velocity(int owner, int component, int face) const;
  Vector face_place(int component, int face) const;
  // fluid_solver.inl
  bool solve(float tolerance, int limit, bool with_bodies, int& iterations, float& left);
  void factorise();
  void find_runs(bool up);
  void apply_rows(const std::vector<float>& x, std::vector<float>& y, bool with_bodies);
  void add_bodies(const std::vector<float>& x, std::vector<float>& y, bool scaled);
  float true_residual() const;
  // fluid_surface.inl
  void measure_curvature();
  float surface_pressure(int cell, int next, float theta) const;
  void pull_of_surface();
  int capillary_substeps(float dt) const;
  float tension_dt = 0;  ///< σ dt/(ρ h²), m/s a curvature of one cell
  // fluid_pressure.inl
  void accelerate(float dt);
  void build_rows();
  void project(float dt);
  void spread_particles(float dt);
  void continue_velocities(std::vector<float> (&field)[N], int layer);
  void push_solids(float dt, bool weight);
  void hold_at_walls();
  void balance_sealed();
  void subtract_gradient(std::vector<float> (&field)[N], bool from_field);
  void push_of(const FluidBody<D>& body, const std::vector<float>& x, bool scaled, Vector& force,
               Angular& torque) const;
  void give(FluidBody<D>& body, Vector force, Angular torque);
  // fluid_particles.inl
  void to_particles();
  void balance(float dt);
  void move(float dt);
  bool collide(Particle& particle, Position* push, Angular* twist);
  void emit(float dt);
  core::Status step(rigid::World<D>* world, float dt);
  // fluid_setup.inl
  void make_grid();
  void reserve();
  core::Status fill_lattice(Position lower, Position upper, float radius, Vector speed, std::uint32_t tag,
                            const char* call);
  float at_cells(const std::vector<float>& field, Position point) const;
  float pressure_at(Position point) const;
  double surface_height(Position point) const;
  double kinetic_energy() const;
  double potential_energy() const;
  std::conditional_t<D::dimension == 2, double, Vec3d> angular_momentum() const;
  std::size_t bytes() const;
  void substep(float dt);

  FluidRange whole() const {
    return {{0, 0, 0}, {grid.cells[0] - 1, grid.cells[1] - 1, N == 3 ? grid.cells[2] - 1 : 0}};
  }
  float room_of_particle() const { return N == 2 ? 0.25f : 0.125f; }
  template <class F>
  void parallel(int count, int grain, F&& f) {
    scheduler->parallel_for(count, grain, f);
  }
};

}  // namespace carom::particles::detail
