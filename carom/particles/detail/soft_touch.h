// Contacts of particles of cloth and soft bodies with what they meet: held along the normal while they press, slowed
// across it by friction of the last substep's push.
#pragma once

#include <vector>

#include "carom/particles/detail/soft_matrix.h"
#include "carom/particles/detail/soft_obstacles.h"

namespace carom::particles::detail {

inline constexpr float soft_slip = 0.002f;  ///< m/s: friction grows up to here
inline constexpr float soft_pull = 1;  ///< m/s² times its mass: what a contact may pull a particle back for a substep

struct SoftTouch {
  bool near = false, active = false;
  SoftPlane plane{};
  float push = 0;   ///< N, in the last substep
  float given = 0;  ///< m/s: change along the normal where it is held, beside the surface's own
  float grip = 0;   ///< kg: friction of this substep, times what slips
  Vec3f slip{};     ///< m/s, before the solve
};

/// A place of a face that something fast meets, or may meet in a substep.
struct SoftFaceTouch {
  std::uint32_t corner[3] = {};
  Vec3f share{};
  SoftPlane plane{};
  float least = 0;      ///< m/s along the normal, of the place against the body
  float lightness = 0;  ///< 1/kg, of both
  SoftTwist answer{};   ///< of the body, to an impulse of 1 N·s
  float impulse = 0;    ///< N·s
};

/// What touches or is pinned in a substep.
struct SoftTouching {
  std::vector<SoftTouch>& touches;
  const std::vector<SoftPin>& pins;
  const std::vector<int>& pinned;
  const std::vector<math::Vec3d>& position;
  const std::vector<Vec3f>& velocity;
  const std::vector<float>& mass;
  double apart = 0;  ///< m, of a sheet from what it touches; 0: a body
};

struct SoftThing;
/// Which side of a sheet each shape is on that faces may meet between their corners.
void find_sides(SoftThing& thing);
/// Of what is small or comes fast what its faces meet between their corners: each of these is held off the plane where
/// the body is nearest to the face.
void meet_faces(SoftThing& thing, float h);
/// All places where something fast may come through a face in a substep. Before meet_faces, which chooses one for each
/// corner.
void find_face_touches(SoftThing& thing, float h);
/// After the solve, in which a corner is held off one plane: holds every such place by impulses. `pin_impulse`: by pin,
/// may be null.
void press_faces(SoftThing& thing, float h, Vec3d* pin_impulse);
/// s, of a substep of h at most and `least` at least: as far as something fast may come before it is seen to touch.
double stride(const SoftThing& thing, double h, double least);

/// m/s, at which what is too deep rises at most.
float greatest_rise(const SoftPlane& plane, const SoftObstacles& obstacles);
/// Enters the touch of particle i, which is near, into the system. `friction`: of the particles' material.
void hold_touch(SoftTouch& touch, std::size_t i, Vec3f velocity, double friction, float h,
                const SoftObstacles& obstacles, SoftSolver& solver);

/// Enters what is held, and the bodies of what is held or rubbed, into the system. Before every solve.
void tie_touches(const SoftTouching& all, const SoftObstacles& obstacles, SoftSolver& solver);
/// After a solve: lets go of what is pulled, holds what would pass through. True: solve again.
bool revise_touches(const SoftTouching& all, float h, const SoftObstacles& obstacles, SoftSolver& solver);
/// Hands the bodies what the solution has for them. `pin_impulse`: by pin, may be null.
void react_touches(const SoftTouching& all, float h, SoftObstacles& obstacles, const SoftSolver& solver,
                   Vec3d* pin_impulse);

/// Drops pins of bodies that are gone, puts pinned vertices to their places.
void place_pins(std::vector<SoftPin>& pins, std::vector<int>& pinned, std::vector<int>& pin_of, rigid::World3& world,
                SoftObstacles& obstacles, std::vector<Vec3d>& position, std::vector<Vec3f>& velocity);
/// Holds pinned vertices for a substep.
void hold_pins(const SoftTouching& all, SoftSolver& solver);
/// Gives a vertex an impulse (N·s), or the body that it is pinned to.
core::Status push_vertex(std::vector<Vec3f>& velocity, const SoftTouching& all, const std::vector<int>& pin_of,
                         int vertex, math::Vec3d impulse, rigid::World3& world);
/// What is within reach of a step of the vertices, kept `apart` m from shapes.
void gather_near(double apart, double dt, rigid::World3& world, const rigid::Filter& filter,
                 const std::vector<SoftPin>& pins, const std::vector<Vec3d>& position,
                 const std::vector<Vec3f>& velocity, SoftObstacles& obstacles);

}  // namespace carom::particles::detail
