// What the kernels of a particle step work on: plain pointers and numbers, one set of functions for each instruction
// set. Positions are about the system's anchor.
#pragma once

#include <cstdint>

#include "carom/math/cpu.h"

namespace carom::particles::detail {

/// Particles that pass through all kernels together: few enough that their paths stay in the first cache.
inline constexpr int block_size = 1024;
inline constexpr float far_gap = 1e30f;

struct Arrays {
  float* position[3];
  float* velocity[3];
  float* birth;
  float* death;
  float* scale;  ///< null: all 1
  float* held;   ///< null: none; else 1 where a particle sticks to where it is
};

/// What a block's particles did so far in this step.
struct alignas(64) Path {
  float start[3][block_size];  ///< m, where the rest of the step begins
  float speed[3][block_size];  ///< m/s, with which velocity
  float left[block_size];      ///< s of it
  float reach[block_size];     ///< m, radius and length of that way
  float gap[block_size];       ///< for surfaces that are cast one by one: as the kernels' own, and its normal
  float normal[3][block_size];
};

/// Velocity a cos(2π(k·x + phase)) of a divergence-free field: a·k = 0.
struct Wave {
  float k[3], phase, a[3];
};
struct WhirlData {
  float center[3], axis[3];
  float inside, outside, core2;  ///< Γ/(2π r_c²), Γ/(2π), r_c²
};
/// Velocities at the nodes of a grid: four floats a node, x fastest, then y, then z.
struct WindNodes {
  const float* node;  ///< null: none
  float corner[3], inverse_spacing;
  float last[3];   ///< places along an axis are below
  int layer, row;  ///< floats from a node to the next above, and along z
};
struct AttractorData {
  float center[3];
  float strength, inverse_reference, exponent, range2, core;
};

enum class Rate : int { uniform, own, quadratic, schiller_naumann };

struct MoveData {
  float dt, now;
  float radius;
  float gravity[3];
  float wind[3];
  const float* wind_table;  ///< null: the same everywhere; else factors by the root of the height, and differences
  int wind_layers;          ///< 0; or the floats from one to the next of three such tables of velocities, not factors
  float wind_floor, wind_scale, wind_last;
  WindNodes nodes;
  int waves, whirls, attractors;
  const Wave* wave;
  const WhirlData* whirl;
  const AttractorData* attractor;
  Rate rate;
  int scale_power;          ///< the rate goes with scale to minus this
  float rate_coefficient;   ///< 1/s (own, schiller_naumann) or 1/m (quadratic)
  float reynolds;           ///< Re = this × scale × speed
  float decay, mean, half;  ///< of the uniform rate: e^{−x}, φ₁, φ₂ with x = rate × dt
  const float* drag_table;  ///< null, or the factor by age: 64 cells of value and difference
  bool keep_path;
  bool velocity_only;  ///< leaves positions: contacts decide about them
};

enum class Form : int { plane, sphere, capsule, box, cylinder, hull, height_field, given };
enum class Answer : int { bounce, stick, kill };

struct SurfaceData {
  Form form;
  Answer answer;
  float turn0[9], place0[3];  ///< pose at the start of the step, rows of the rotation
  float turn1[9], place1[3];  ///< and at its end
  float velocity[3], spin[3], center[3];
  float reach;  ///< m, radius of a sphere about place1 that holds all of it and its way; far_gap: everything
  float radius, half[3];
  const float* planes;  ///< hull: normal and offset
  int plane_count;
  const float* heights;
  const std::uint8_t* holes;
  int columns, rows;
  float cell[2];
  float restitution, friction;
  float inverse_mass, inverse_inertia[9];  ///< zero: immovable
  bool two_way, moves;
};

struct CollideData {
  float dt, now;
  float gravity[3];
  float radius, mass;
};

/// What hit: collected in the order of particles.
struct Hit {
  int index;
  float normal[3];
  float speed;
};
struct HitList {
  Hit* hits;
  int count, room;
  float slowest;      ///< m/s: slower impacts are not told
  double* exchanged;  ///< null, or momentum and angular momentum given to the particles: 6
};

#define CAROM_PARTICLE_KERNELS                                                                                        \
  /** Moves [from, to), to ≤ from + block_size, both multiples of 16. */                                              \
  void move(const MoveData& data, const Arrays& arrays, int from, int to, Path& path);                                \
  /** Lets them meet a surface; `count`: the first that is no particle. Returns the number that touched it. */        \
  int collide(const CollideData& data, const SurfaceData& surface, const Arrays& arrays, int from, int to, int count, \
              Path& path, HitList& hits);                                                                             \
  /** Gap and normal of every particle to a surface as it stood at the start of the step, into path.gap and           \
   * path.normal (world axes); far_gap where it is farther than `margin` from its sphere. */                          \
  void find_near(const CollideData& data, const SurfaceData& surface, const Arrays& arrays, float margin, int from,   \
                 int to, Path& path);                                                                                 \
  /** Indices of those whose time is over or that are lost; returns how many. */                                      \
  int find_dead(const Arrays& arrays, float now, float limit, int from, int to, int count, std::int32_t* dead);

namespace particles_baseline {
CAROM_PARTICLE_KERNELS
}
#if CAROM_WIDE_UNITS
namespace particles_avx2 {
CAROM_PARTICLE_KERNELS
}
namespace particles_avx512 {
CAROM_PARTICLE_KERNELS
}
#endif

struct Kernels {
  decltype(&particles_baseline::move) move;
  decltype(&particles_baseline::collide) collide;
  decltype(&particles_baseline::find_near) find_near;
  decltype(&particles_baseline::find_dead) find_dead;
};

}  // namespace carom::particles::detail
