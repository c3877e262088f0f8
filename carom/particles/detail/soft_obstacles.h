// What cloth and soft bodies meet in a world: shapes near them, and the bodies that take the impulses.
#pragma once

#include <vector>

#include "carom/math/quat.h"
#include "carom/particles/detail/soft_matrix.h"
#include "carom/rigid/world.h"

namespace carom::particles::detail {

using math::Quatd;
using math::Vec3d;
using math::Vec3f;

/// The nearest plane of a shape to a ball at `center` (shape's frame); false where there is none within `margin`.
bool nearest_plane(const geometry::Shape3& shape, Vec3f center, float radius, float margin, Vec3f& normal,
                   float& separation);

struct SoftPlane {
  int body = -1;
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
    Vec3d impulse{}, turn{};  ///< over the step, about the centre of mass
    Vec3d velocity_at(Vec3d point) const { return velocity + cross(spin, point - center); }
    Vec3d place(Vec3d local) const { return center + rotate(rotation, local - local_center); }
  };
  std::vector<Body> bodies;

  void clear() {
    bodies.clear();
    shapes_.clear();
  }
  int body_index(rigid::World3& world, rigid::BodyId id);  ///< −1: not there
  void gather(rigid::World3& world, const geometry::Bounds3d& bounds, const rigid::Filter& filter,
              const std::vector<SoftPin>& pins);
  bool empty() const { return shapes_.empty(); }
  bool nearest(Vec3d point, double radius, double margin, SoftPlane& plane) const;
  void push(int body, Vec3d point, Vec3d impulse) {
    if (body < 0) return;
    Body& b = bodies[std::size_t(body)];
    b.impulse += impulse;
    b.turn += cross(point - b.center, impulse);
  }
  /// What all else does to the bodies in this step, by what they did in the last one.
  void find_pulls(rigid::World3& world, double dt);
  /// The bodies as unknowns of a substep, not yet tied to anything.
  void enter(float h, SoftSolver& solver) const;
  /// Moves the bodies on by a substep, as the solver has it.
  void advance(double h, const SoftSolver& solver);
  void hand_over(rigid::World3& world, double dt, double gravity);

 private:
  struct Shape {
    geometry::Shape3 shape{};
    geometry::Bounds3f tight{};
    int body = -1;
    Quatd turn{}, local_turn{};
    Vec3d place{}, local_place{};
    double friction = 0;
  };
  double mass_behind(rigid::World3& world, const Body& body, Vec3d push);
  std::vector<SoftMemory> memory_;
  std::vector<rigid::BodyId> behind_;
  std::vector<rigid::ContactView<rigid::Dim3>> contacts_;
  std::vector<Shape> shapes_;
  std::vector<rigid::ShapeId> found_;
};

}  // namespace carom::particles::detail
