// What a rope and a body that it touches are to the solver.
#pragma once

#include <cstdint>
#include <vector>

#include "carom/geometry/bounds.h"
#include "carom/math/mat.h"
#include "carom/math/quat.h"
#include "carom/particles/rope.h"

namespace carom::particles::detail {

using math::Mat3d;
using math::Quatd;

/// A body as the rope's substeps know it: it falls and moves by what the ropes do to it, and by nothing else.
struct RopeBody {
  rigid::BodyId id{};
  rigid::BodyType type = rigid::BodyType::fixed;
  bool moves = false;  ///< takes part in the solve: its mobility is not zero
  bool awake = false;
  Vec3d position{}, center{};
  Quatd rotation{};
  Vec3d local_center{};
  Vec3d velocity{}, spin{}, gravity{};
  double mass = 0;
  Mat3d linear = Mat3d::zero(), mixed = Mat3d::zero(),
        angular = Mat3d::zero();  ///< mobility: v = L j + X l, w = Xᵀ j + A l
  Vec3d impulse{}, turn{};        ///< over the step, about the centre of mass
  Vec3d carried{};                ///< kg·m, the impulse times how long it has acted
  int column = -1;                ///< block of the bodies' system

  Vec3d place(Vec3d local) const { return center + rotate(rotation, local - local_center); }
  Vec3d velocity_at(Vec3d point) const { return velocity + cross(spin, point - center); }
};

/// What is remembered of a body from step to step: its velocity, and how the ropes were to change it.
struct RopeMemory {
  rigid::BodyId id{};
  Vec3d velocity{}, change{};
};

enum class RopeHold : std::uint8_t { none, attached, stick, slide };

/// A shape near a rope.
struct RopeShape {
  bool fast = false;  ///< its body is: how far it is has to be told beside its edges, too
  geometry::Shape3 shape{};
  rigid::ShapeId id{};
  int body = -1;
  double half = 0;      ///< m, from its middle to the nearest side of its bounds
  double friction = 0;  ///< of the shape
  Quatd turn{};         ///< shape → body
  Vec3d place{};
};

/// A plane that a particle may touch, fixed in a body.
struct RopeContact {
  rigid::ShapeId shape{};
  int near = -1;           ///< of this step's shapes
  int coming = -1;         ///< of them the fast one that may be met first, until it is `near`
  double comes_in = 1e30;  ///< s
  int body = -1;
  double friction = 0;
  double separation = 0;  ///< m, at the start of the substep
  RopeHold state = RopeHold::none;
  Vec3d grip{};     ///< N along the surface, kept while it sticks
  double slip = 0;  ///< m/s along the surface
  double push = 0;  ///< N along the normal, in the last substep
};

struct RopeGrip {
  RopeAttachment attachment{};
  int body = -1;    ///< of this step's list; −1: the world
  Vec3d bias{};     ///< m/s: closes what gap there is
  Vec3d impulse{};  ///< N·s on the body over the step
  Vec3d force{};    ///< N on the body, over the last step
  Vec3d second{};   ///< clamped: where the neighbour is held, in the body's frame
  Vec3d second_bias{};
  Vec3d director{};  ///< clamped: a unit vector across the segment, in the body's frame
};

/// How a particle is held in this substep: all of its velocity (attached), or the part along a normal with friction
/// along the surface, which is an implicit resistance: impulse = grip − resistance (v − surface), within the cone.
struct RopeNode {
  RopeHold hold = RopeHold::none;
  int body = -1;
  Vec3d arm{};     ///< from the body's centre of mass
  Vec3d target{};  ///< velocity that is held, of the surface without what the solve changes
  Vec3d normal{};
  Vec3d grip{};           ///< N·s
  double resistance = 0;  ///< kg
  Vec3d reaction{};       ///< N·s on the particle
};

/// The part of a vector across a hold's normal.
inline Vec3d across(const RopeNode& node, Vec3d v) { return v - dot(node.normal, v) * node.normal; }
/// The part of a momentum row that a hold leaves.
inline Vec3d project(const RopeNode& node, Vec3d r) {
  if (node.hold == RopeHold::none) return r;
  return node.hold == RopeHold::attached ? Vec3d{} : across(node, r);
}
inline Mat3d project(const RopeNode& node, const Mat3d& m) {
  return {project(node, m.cx), project(node, m.cy), project(node, m.cz)};
}

/// A segment that lies on something between its particles: a point of it is held as a particle would be, by a stiffness
/// within the system of the row. Where the ends touch as deep as the middle, they do without.
struct RopeEdge {
  RopeContact contact{};
  RopeNode point{};
  double share = 0.5;                ///< of the second end
  RopeHold before = RopeHold::none;  ///< in the substep before
  double nearest = -1e30;            ///< m: no less is its separation at the start of the substep
  Mat3d stiff = Mat3d::zero();       ///< kg: impulse = stiff (target − velocity) + grip
};

/// The room that a segment may need in a step.
struct RopeStretch {
  geometry::Bounds3d box{};
  int rope = 0, segment = 0;
};

/// Two segments that may touch, in the order of their numbers, and the impulse between them.
struct RopeCross {
  int rope[2] = {0, 0}, segment[2] = {0, 0};
  double friction = 0;
  Vec3d side{};  ///< where the second was when last looked at; zero: not known
  double share[2] = {0, 0};
  Vec3d normal{};         ///< from the first to the second
  double separation = 0;  ///< m, of the surfaces
  double least = 0;       ///< m/s along the normal, at the end of the substep
  Vec3d velocity{};       ///< m/s, of the second past the first
  Vec3d impulse{};        ///< N·s on the second, in the substep
  Vec3d sum{};            ///< N·s, over the step

  friend bool operator<(const RopeCross& a, const RopeCross& b) {
    for (int k = 0; k < 2; ++k) {
      if (a.rope[k] != b.rope[k]) return a.rope[k] < b.rope[k];
      if (a.segment[k] != b.segment[k]) return a.segment[k] < b.segment[k];
    }
    return false;
  }
};

/// Velocities of a rope's particles from `low` to `high` for an impulse on it, by its direction.
struct RopeAnswer {
  int rope = 0, low = 0, high = -1;
  std::vector<Mat3d> at;  ///< by particle
};

struct Rope {
  RopeMaterial material{};
  rigid::Filter filter{};
  bool collide = true;
  RopeTouch touch = RopeTouch::others;
  double segment = 0;  ///< m, as it was made
  std::vector<Vec3d> position, velocity;
  std::vector<double> lump;           ///< kg beside the rope's own
  std::vector<double> rest, tension;  ///< by segment
  std::vector<std::uint8_t> broken;
  std::vector<RopeGrip> grips;
  std::vector<RopeContact> contacts;  ///< by particle
  std::vector<RopeEdge> edges;        ///< by segment
  double winch[2] = {0, 0};
  double twist = 0, twist_offset = 0;  ///< rad
  double peak = 0;

  // Scratch of a substep.
  std::vector<double> mass;
  std::vector<Vec3d> force, start, guess;
  std::vector<RopeNode> nodes;
  std::vector<Mat3d> lower, diagonal, upper, factor, held;  ///< momentum rows, and Thomas' eliminated ones
  std::vector<Vec3d> right, solution, momentum;
  std::vector<int> touched;    ///< bodies that move, in this rope's order
  std::vector<int> reach;      ///< two a body: particles from … to that its motion moves
  std::vector<Vec3d> columns;  ///< 6 a body, as many as particles
  std::vector<double> theta, pull;
  double before[2] = {0, 0};        ///< m, the rest lengths at the ends, at the start of the substep
  std::vector<double> room;         ///< m, by particle: as far as it may go before what is near it is to be found anew
  std::vector<std::uint8_t> slack;  ///< by segment
  geometry::Bounds3d around{};      ///< all that it may reach in a step

  int count() const { return int(position.size()); }
  void resize(std::size_t n);
};

}  // namespace carom::particles::detail
