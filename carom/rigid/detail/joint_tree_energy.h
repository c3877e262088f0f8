// The kinetic energy of a tree, and how some of it is taken out without touching its momenta.
#pragma once

#include "carom/rigid/detail/joint_tree_algebra.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

template <class D>
struct TreeEnergy {
  static constexpr int dofs = TreeBody<D>::dofs, dimension = D::dimension;
  StepContext<D>& context;
  JointTrees<D>& trees;
  const TreeRange& range;

  /// Of a free tree, that of its inner motion: joints change nothing of the rest, whose rounding would drown a slow
  /// one.
  double kinetic() const {
    double turning = 0;
    return kinetic(turning);
  }
  /// `turning`: of a free tree, its turning as a whole besides.
  double kinetic(double& turning) const {
    double rigid[dofs] = {};
    typename D::Position center{};
    if (range.free) rigid_motion(rigid, center);
    double sum = 0;
    turning = 0;
    for (int i = range.first_body; i < range.body_end; ++i) {
      const TreeBody<D>& body = trees.bodies[std::size_t(i)];
      double v[dofs];
      velocity_of(v, context.bodies[body.body]);
      if (range.free) {
        double r[dofs];
        rigid_velocity(rigid, position_of(body) - center, r);
        for (int c = 0; c < dofs; ++c) v[c] -= r[c];
        for (int c = 0; c < dimension; ++c) r[c] -= rigid[c];
        turning += energy_of(body, r);
      }
      sum += energy_of(body, v);
    }
    return sum;
  }
  /// J, of the tree when it moves at `speed` as a whole.
  double at_speed(double speed) const {
    double mass = 0;
    for (int i = range.first_body; i < range.body_end; ++i) mass += trees.bodies[std::size_t(i)].own_mass;
    return 0.5 * mass * speed * speed;
  }
  double energy_of(const TreeBody<D>& body, const double (&v)[dofs]) const {
    double sum = 0;
    for (int c = 0; c < dimension; ++c) sum += v[c] * v[c];
    sum *= body.own_mass;
    for (int r = dimension; r < dofs; ++r)
      for (int c = dimension; c < dofs; ++c) sum += v[r] * body.inertia[r - dimension][c - dimension] * v[c];
    return 0.5 * sum;
  }
  /// Slows the motion against the ground; of a free tree, the motion within it, so that its momenta stay.
  void take(double excess, double energy) const {
    if (range.moving_ground) return;
    if (!(energy > 0)) return;
    double rigid[dofs] = {};
    typename D::Position center{};
    if (range.free) rigid_motion(rigid, center);
    const double scale = math::sqrt(max(0.0, 1 - excess / energy));
    for (int i = range.first_body; i < range.body_end; ++i) {
      const TreeBody<D>& body = trees.bodies[std::size_t(i)];
      double v[dofs], r[dofs];
      velocity_of(v, context.bodies[body.body]);
      rigid_velocity(rigid, position_of(body) - center, r);
      for (int c = 0; c < dofs; ++c) v[c] = (scale - 1) * (v[c] - r[c]);
      add_velocity(context.bodies[body.body], v);
    }
  }
  /// Of a body that moves with the whole tree; zero where the tree is held.
  void rigid_velocity(const double (&rigid)[dofs], const typename D::Position& arm, double (&v)[dofs]) const {
    for (int c = 0; c < dofs; ++c) v[c] = rigid[c];
    if (range.free) add_turn(v, rigid, arm);
  }
  typename D::Position position_of(const TreeBody<D>& body) const {
    return context.world.bodies.motion[std::size_t(body.body)].center +
           typename D::Position(context.bodies[body.body].delta_position);
  }
  static void add_turn(double (&v)[3], const double (&rigid)[3], Vec2d r) {
    v[0] -= rigid[2] * r.y;
    v[1] += rigid[2] * r.x;
  }
  static void add_turn(double (&v)[6], const double (&rigid)[6], Vec3d r) {
    const Vec3d turn = cross(Vec3d{rigid[3], rigid[4], rigid[5]}, r);
    v[0] += turn.x;
    v[1] += turn.y;
    v[2] += turn.z;
  }
  /// The motion of the tree as one body with the same momenta: velocity of its centre of mass, and its turning.
  void rigid_motion(double (&rigid)[dofs], typename D::Position& center) const {
    constexpr int turning = dofs - dimension;
    double mass = 0;
    const typename D::Position origin = position_of(trees.bodies[std::size_t(range.first_body)]);
    typename D::Position moment{};
    for (int i = range.first_body; i < range.body_end; ++i) {
      const TreeBody<D>& body = trees.bodies[std::size_t(i)];
      const double m = body.own_mass;
      double v[dofs];
      velocity_of(v, context.bodies[body.body]);
      mass += m;
      moment += m * (position_of(body) - origin);
      for (int c = 0; c < dimension; ++c) rigid[c] += m * v[c];
    }
    center = origin + moment / mass;
    for (int c = 0; c < dimension; ++c) rigid[c] /= mass;
    double inertia[turning][turning] = {}, inverse[turning];
    double* const spin = rigid + dimension;
    for (int i = range.first_body; i < range.body_end; ++i) {
      const TreeBody<D>& body = trees.bodies[std::size_t(i)];
      const double m = body.own_mass;
      double v[dofs];
      velocity_of(v, context.bodies[body.body]);
      const typename D::Position r = position_of(body) - center;
      for (int a = 0; a < turning; ++a)
        for (int b = 0; b < turning; ++b) {
          inertia[a][b] += body.inertia[a][b] + m * ((a == b ? dot(r, r) : 0) - (turning == 3 ? r[a] * r[b] : 0));
          spin[a] += body.inertia[a][b] * v[dimension + b];
        }
      if constexpr (turning == 1) {
        spin[0] += m * (r.x * v[1] - r.y * v[0]);
      } else {
        const Vec3d l = cross(r, Vec3d{v[0], v[1], v[2]});
        for (int a = 0; a < 3; ++a) spin[a] += m * l[a];
      }
    }
    factorise_block(inertia, inverse, turning);
    solve_block(inertia, inverse, turning, spin);
  }
};

}  // namespace carom::rigid::detail
