// What cloth and soft bodies meet in a world: shapes near them, and the bodies that take the impulses.
#pragma once

#include <vector>

#include "carom/math/quat.h"
#include "carom/particles/detail/fast_shapes.h"
#include "carom/particles/detail/soft_matrix.h"
#include "carom/rigid/world.h"

namespace carom::particles::detail {

using math::Quatd;
using math::Vec3d;
using math::Vec3f;

struct SoftPlane {
  int body = -1;
  Vec3d at{};             ///< m, where it is met
  Vec3d normal{};         ///< out of the shape
  double separation = 0;  ///< m, of the ball
  double friction = 0;    ///< of the shape
};

/// A point of a body that a vertex is held to.
struct SoftPin {
  rigid::BodyId body{};
  Vec3d point{};  ///< body's frame, or the world
  int index = -1;
};

/// What is remembered of a body from step to step: its velocity, and how this was to change it.
struct SoftMemory {
  rigid::BodyId id{};
  SoftTwist velocity{}, change{};
  Vec3d impulse{};
};

/// Which side of a sheet a shape is on, kept while it is near.
struct SoftSide {
  rigid::ShapeId id{};
  int side = 0;
};

class SoftObstacles {
 public:
  struct Body {
    rigid::BodyId id{};
    bool dynamic = false, awake = false, moves = false;  ///< moves: takes part with its mass
    Vec3d center{}, local_center{}, velocity{}, spin{};
    Quatd rotation{};
    double mass = 0;
    double heavier = 1;  ///< times the mass: with what it is pressed against
    math::Mat3d inertia = math::Mat3d::zero(), inverse_inertia = math::Mat3d::zero();  ///< world axes
    math::Vec3d locked{}, locked_turn{};                                               ///< 1: along this axis
    SoftTwist start{}, pull{};  ///< velocity before the step; acceleration by all else
    SoftTwist change{};         ///< of velocity in the last substep, where it was touched
    bool touched = false;
    Vec3d impulse{}, turn{};          ///< over the step, about the centre of mass
    Vec3d carried{}, carried_turn{};  ///< both times how long they have acted
    Vec3d velocity_at(Vec3d point) const { return velocity + cross(spin, point - center); }
    Vec3d place(Vec3d local) const { return center + rotate(rotation, local - local_center); }
  };
  struct Shape {
    geometry::Shape3 shape{};
    geometry::Bounds3f tight{};
    int body = -1;
    Quatd turn{}, local_turn{};
    Vec3d place{}, local_place{};
    double friction = 0;
    double half = 0, outer = 0;  ///< m, from the middle of its bounds to the nearest side, and to a corner
    double speed = 0;            ///< m/s, of none of its points more
    bool fast = false;           ///< comes farther in the step than through half of that
    rigid::ShapeId id{};
    int side = 0;  ///< of a sheet that it is near: 1 where its faces look
    Vec3d middle() const { return place + rotate(turn, Vec3d(tight.center())); }
  };
  std::vector<Body> bodies;
  bool fast = false;  ///< a shape is

  void clear() {
    bodies.clear();
    shapes_.clear();
    fast = false;
  }
  int body_index(rigid::World3& world, rigid::BodyId id);  ///< −1: not there
  /// What is within the bounds, and what may come there in a step of dt.
  void gather(rigid::World3& world, const geometry::Bounds3d& bounds, const rigid::Filter& filter,
              const std::vector<SoftPin>& pins, double dt);
  bool empty() const { return shapes_.empty(); }
  const std::vector<Shape>& shapes() const { return shapes_; }
  std::vector<Shape>& shapes() { return shapes_; }
  /// The nearest plane to a ball that comes by `margin` m in h s.
  bool nearest(Vec3d point, double radius, double margin, double h, SoftPlane& plane) const;
  void push(int body, Vec3d point, Vec3d impulse) {
    if (body < 0) return;
    Body& b = bodies[std::size_t(body)];
    b.impulse += impulse;
    b.turn += cross(point - b.center, impulse);
  }
  /// What all else does to the bodies in this step, by what they did in the last one.
  void find_pulls(rigid::World3& world, double dt);
  /// The bodies as unknowns of a substep, before tie_touches.
  void enter(float h, SoftSolver& solver) const;
  /// Moves the bodies on by a substep, as the solver has it.
  void advance(double h, const SoftSolver& solver);
  void hand_over(rigid::World3& world, double dt, double gravity);

 private:
  void take(rigid::World3& world, rigid::ShapeId id, const rigid::Filter& filter, const std::vector<SoftPin>& pins,
            double dt);
  double speed_of(const Shape& shape) const;
  double mass_behind(rigid::World3& world, const Body& body, Vec3d push);
  std::vector<SoftMemory> memory_;
  std::vector<SoftSide> sides_;
  std::vector<rigid::BodyId> behind_;
  std::vector<rigid::ContactView<rigid::Dim3>> contacts_;
  std::vector<Shape> shapes_;
  std::vector<rigid::ShapeId> found_, coming_, of_body_;
  std::vector<rigid::BodyId> fast_bodies_;
  std::vector<FastShape> fast_shapes_;
};

}  // namespace carom::particles::detail
