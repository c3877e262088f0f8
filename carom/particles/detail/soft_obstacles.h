// What cloth and soft bodies meet in a world: shapes near them, and the bodies that take the impulses.
#pragma once

#include <vector>

#include "carom/math/quat.h"
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

/// A point of a body and how it answers to an impulse there.
struct SoftPin {
  rigid::BodyId body{};
  Vec3d point{};  ///< body's frame, or the world
  int index = -1;
  float mass = 0;  ///< kg by which the point resists, 0: it moves as it does
};

class SoftObstacles {
 public:
  struct Body {
    rigid::BodyId id{};
    bool dynamic = false, awake = false;
    Vec3d position{}, center{}, velocity{}, spin{};
    Quatd rotation{};
    double mass = 0;
    Vec3d impulse{}, turn{};  ///< over the step, about the centre of mass
    Vec3d velocity_at(Vec3d point) const { return velocity + cross(spin, point - center); }
    Vec3d place(Vec3d local) const { return position + rotate(rotation, local); }
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
  void hand_over(rigid::World3& world, double dt, double gravity) const;

 private:
  struct Shape {
    geometry::Shape3 shape{};
    geometry::Bounds3f tight{};
    int body = -1;
    Quatd turn{};
    Vec3d place{};
    double friction = 0;
  };
  std::vector<Shape> shapes_;
  std::vector<rigid::ShapeId> found_;
};

}  // namespace carom::particles::detail
