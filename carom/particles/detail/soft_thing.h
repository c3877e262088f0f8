// What cloth and soft bodies have in common: vertices with a linear system, what they touch, and the order of a step.
#pragma once

#include <span>

#include "carom/particles/detail/soft_touch.h"

namespace carom::particles::detail {

/// A contact with another thing, from substep to substep.
struct SoftMeetingMemory {
  int other = 0;
  std::uint32_t vertex = 0;
  bool active = false;
  float push = 0;  ///< N
  Vec3f normal{};
};

struct SoftThing {
  bool collide = true;
  rigid::Filter filter{};
  core::TaskScheduler* scheduler = nullptr;
  int substeps = 2, iterations = 0;

  std::vector<math::Vec3d> position;
  std::vector<Vec3f> velocity;
  std::vector<float> mass;
  std::vector<SoftPin> pins;
  std::vector<int> pinned, pin_of;  ///< vertex of each pin; pin of each vertex, −1: free
  std::vector<SoftTouch> touches;
  std::vector<SoftFaceTouch> face_touches;  ///< in this substep
  std::vector<std::uint64_t> seen_edges;    ///< scratch: of faces that share them
  SoftMatrix matrix;
  SoftSolver solver;
  SoftObstacles obstacles;

  std::vector<std::uint8_t> outside;  ///< by vertex: on the surface. Of what is all surface: empty
  bool closed = false;                ///< the faces close a volume
  std::vector<std::uint8_t> folded;   ///< by face: what lies behind it is inside out. Of what has nothing behind: empty
  float mean_edge = 0;                ///< m, of the faces at rest
  double apart = 0;                   ///< m: vertices keep so far from what they meet
  double friction = 0;
  std::vector<SoftMeetingMemory> met;  ///< by thing, then by vertex

  SoftThing() = default;
  SoftThing(const SoftThing&) = default;
  SoftThing& operator=(const SoftThing&) = default;
  virtual ~SoftThing() = default;

  virtual std::span<const std::uint32_t> faces() const = 0;  ///< triangles; outward where closed
  virtual void begin_step(rigid::World3& world, double dt);
  /// Makes the linear system of a substep, with what is held.
  virtual void begin_substep(float h, Vec3f gravity) = 0;
  /// After a solve: lets go of what is drawn, holds what would give way. True: solve again.
  virtual bool revise(float h) { return revise_touches(touching(), h, obstacles, solver); }
  virtual void end_substep(float h) = 0;  ///< moves on by what the solver found
  virtual void end_step(rigid::World3& world, double dt);

  void hold(float h);  ///< what is pinned or touches, in this substep
  SoftTouching touching() { return {touches, pins, pinned, position, velocity, mass, closed ? 0 : apart}; }
  core::TaskScheduler& tasks() const;
};

class SoftMeeting;

/// A step of things that meet each other; `meeting` null: of one that meets none. Returns s, its last substep.
float step_together(std::span<SoftThing* const> things, SoftMeeting* meeting, rigid::World3& world, double dt);

}  // namespace carom::particles::detail
