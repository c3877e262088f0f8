// The blocks that joints are made of. Each holds what it needs through a step, and knows three things: how to give last
// substep's impulse again (warm_start), how to remove the error of velocity and position (solve), and what it exerted.
// Moments arms turn with the bodies in every pass: unlike contacts, joints see large rotations in a step.
//
//   PinBlock      the anchors coincide                     ball, hinge, weld
//   PointBlock    the same by a spring or with limited force  soft weld, motor, mouse
//   AngularBlock  the frames have the same attitude        weld, slider, motor, ball spring and friction
//   HingeBlock    the z axes are parallel (3D)             hinge
//   SlideBlock    B's anchor stays on A's x axis           slider
//   LinearAxis    spring, motor and limits along an axis   distance, slider
//   AngularAxis   the same about an axis                   hinge, twist and cone of a ball
//   CouplingBlock one coordinate follows another           gear, rack, screw, pulley (joint_coupling.h)
#pragma once

#include "carom/rigid/detail/joint_angle.h"
#include "carom/rigid/detail/joint_pair.h"
#include "carom/rigid/detail/joint_response.h"

namespace carom::rigid::detail {

/// What all joints of a pass share.
struct JointPass {
  float h = 0;  ///< s, substep
  float inverse_h = 0;
  bool use_bias = true;  ///< false: the relaxing pass
  Response rigid{};      ///< of rigid rows in this pass: the relaxing pass removes speed and nothing else
  Response coupling{};   ///< of couplings, likewise
};

template <class V>
V clamp_magnitude(V v, float limit) {
  const float l = magnitude(v);
  return l > limit ? v * (limit / l) : v;
}
inline Vec2f clamp_magnitude(Vec2f v, float limit) {
  const float l = math::length(v);
  return l > limit ? v * (limit / l) : v;
}

template <class D>
struct PinBlock {
  using Vector = typename D::Vector;
  Vector arm_a{}, arm_b{};  ///< from the centres of mass, world axes at the start of the step
  Vector offset{};          ///< centre of B minus centre of A at the start of the step
  Vector impulse{};
  std::conditional_t<D::dimension == 2, Factor2, Factor3> mobility{};  ///< of this substep

  // Both bodies take the impulse at B's anchor: then the pair's angular momentum stays exact also where the anchors are
  // a little apart. Its rate is that of the gap as seen from A.
  template <class Pair>
  void warm_start(Pair& pair) const {
    const Vector b = rotate(pair.turn_b, arm_b);
    pair.apply(impulse, offset + pair.shift + b, b);
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    const Response& r = pass.rigid;
    const Vector b = rotate(pair.turn_b, arm_b), a = offset + pair.shift + b;
    Vector residual = r.velocity * pair.point_velocity(a, b);
    if (pass.use_bias) {
      residual += r.position * (a - rotate(pair.turn_a, arm_a));
      mobility = factorise(point_mobility(pair, a, b));  // good enough for the relaxing pass too
    }
    const Vector change = -detail::solve(mobility, residual) - r.memory * impulse;
    impulse += change;
    pair.apply(change, a, b);
  }
};

template <class D>
struct PointBlock {
  using Vector = typename D::Vector;
  Vector arm_a{}, arm_b{};  ///< from the centres of mass, world axes at the start of the step
  Vector offset{};          ///< centre of B minus centre of A at the start of the step
  Vector impulse{};
  Vector before{};  ///< of a spring: the speed at the end of the last substep
  Response response{};
  Vector drive{};  ///< m/s, the velocity that is wanted, world axes at the start of the step
  float max_impulse = 1e30f;
  bool rigid = true;
  bool driven = false;    ///< `drive` is not zero
  bool anywhere = false;  ///< no wanted place

  // At B's anchor, as a pin; here it matters more, because the anchors may be far apart.
  template <class Pair>
  void warm_start(Pair& pair) const {
    const Vector b = rotate(pair.turn_b, arm_b);
    pair.apply(impulse, offset + pair.shift + b, b);
  }
  template <class Pair>
  Vector velocity(const Pair& pair, const Vector& a, const Vector& b) const {
    const Vector v = pair.point_velocity(a, b);
    return driven ? v - rotate(pair.turn_a, drive) : v;
  }
  template <class Pair>
  void note_speed(const Pair& pair) {
    const Vector b = rotate(pair.turn_b, arm_b);
    before = velocity(pair, offset + pair.shift + b, b);
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    const Vector b = rotate(pair.turn_b, arm_b), a = offset + pair.shift + b;
    const Vector v = velocity(pair, a, b);
    if (!rigid && !anywhere && !pass.use_bias) {
      before = v;
      return;
    }
    const Response& r = anywhere ? velocity_only : (rigid ? pass.rigid : response);
    Vector residual = r.velocity * v;
    if (r.position > 0) residual += r.position * (a - rotate(pair.turn_a, arm_a));
    if (!rigid) residual += r.previous * before;
    const Vector wanted = solve_mobility(point_mobility(pair, a, b), residual);
    const Vector old = impulse;
    impulse = old - wanted - r.memory * old;
    if (max_impulse < 1e29f) impulse = clamp_magnitude(impulse, max_impulse);
    pair.apply(impulse - old, a, b);
  }
};

template <class D>
struct AngularBlock {
  using Angular = typename D::Angular;
  typename D::Rotation frame_a{}, frame_b{};  ///< joint frames in the world at the start of the step
  Angular impulse{};
  Angular before{};  ///< as in PointBlock
  Response response{};
  Angular drive{};  ///< rad/s, as in PointBlock
  float max_impulse = 1e30f;
  bool rigid = true;      ///< else a spring, or friction
  bool friction = false;  ///< no wanted attitude
  bool driven = false;    ///< `drive` is not zero

  template <class Pair>
  void warm_start(Pair& pair) const {
    pair.apply_angular(impulse);
  }
  template <class Pair>
  Angular relative_spin(const Pair& pair) const {
    const Angular spin = pair.spin_b - pair.spin_a;
    if (!driven) return spin;
    if constexpr (D::dimension == 2)
      return spin - drive;
    else
      return spin - rotate(pair.turn_a, drive);
  }
  template <class Pair>
  void note_speed(const Pair& pair) {
    before = relative_spin(pair);
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    pair.apply_angular(solve(pair, pair.inverse_inertia_a + pair.inverse_inertia_b, pass));
  }
  /// Returns the impulse to add. `mobility`: of what moves.
  template <class Pair, class Mobility>
  Angular solve(const Pair& pair, const Mobility& mobility, const JointPass& pass) {
    const Angular spin = relative_spin(pair);
    if (!rigid && !friction && !pass.use_bias) {
      before = spin;
      return {};
    }
    const Response& r = friction ? velocity_only : (rigid ? pass.rigid : response);
    Angular residual = r.velocity * spin;
    if (r.position > 0) {
      if constexpr (D::dimension == 2) {
        residual += r.position * twist_angle(conjugate(pair.turn_a * frame_a) * (pair.turn_b * frame_b));
      } else {
        residual += r.position * rotation_vector_of((pair.turn_b * frame_b) * conjugate(pair.turn_a * frame_a));
      }
    }
    if (!rigid) residual += r.previous * before;
    const Angular wanted = solve_mobility(mobility, residual);
    const Angular old = impulse;
    impulse = old - wanted - r.memory * old;
    if (max_impulse < 1e29f) impulse = clamp_magnitude(impulse, max_impulse);
    return impulse - old;
  }
};

/// Space only. With z of B against x and y of A: C₁ = x_a·z_b, Ċ₁ = (ω_b − ω_a)·(z_b × x_a); C₂ likewise with y_a.
struct HingeBlock {
  Vec3f x_a{}, y_a{}, z_b{};
  Vec2f impulse{};

  template <class Pair>
  void directions(const Pair& pair, Vec3f& u, Vec3f& v, Vec2f& error) const {
    const Vec3f z = rotate(pair.turn_b, z_b), x = rotate(pair.turn_a, x_a), y = rotate(pair.turn_a, y_a);
    u = cross(z, x);
    v = cross(z, y);
    error = {dot(z, x), dot(z, y)};
    // The sine of the angle; beyond a right one it goes on growing, so that nothing comes to rest upside down.
    const float sine = math::length(error);
    if (dot(z, cross(x, y)) < 0 && sine > 1e-3f) error *= (2 - sine) / sine;
  }
  template <class Pair>
  void warm_start(Pair& pair) const {
    Vec3f u, v;
    Vec2f error;
    directions(pair, u, v, error);
    pair.apply_angular(impulse.x * u + impulse.y * v);
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    const Response& r = pass.rigid;
    Vec3f u, v;
    Vec2f error;
    directions(pair, u, v, error);
    const auto k = pair.inverse_inertia_a + pair.inverse_inertia_b;
    const Vec3f ku = k * u, kv = k * v;
    const float uv = dot(u, kv);
    const Mat2f mobility{{dot(u, ku), uv}, {uv, dot(v, kv)}};
    const Vec3f spin = pair.spin_b - pair.spin_a;
    const Vec2f wanted = solve_mobility(mobility, r.velocity * Vec2f{dot(u, spin), dot(v, spin)} + r.position * error);
    const Vec2f old = impulse;
    impulse = old - wanted - r.memory * old;
    const Vec2f change = impulse - old;
    pair.apply_angular(change.x * u + change.y * v);
  }
};

/// The rows across A's x axis. Ċ = n·(v_b − v_a) + (arm_b × n)·ω_b − ((d + arm_a) × n)·ω_a, with d from anchor to
/// anchor.
template <class D>
struct SlideBlock {
  using Vector = typename D::Vector;
  static constexpr int rows = D::dimension - 1;
  Vector arm_a{}, arm_b{}, offset{};
  Vector normal[rows];  ///< world axes at the start of the step
  float impulse[rows] = {};

  struct Row {
    Vector n{};
    typename D::Angular lever_a{}, lever_b{};
    float error = 0;
  };
  template <class Pair>
  void directions(const Pair& pair, Row (&row)[rows]) const {
    const Vector b = rotate(pair.turn_b, arm_b);
    const Vector reach = offset + pair.shift + b;  // from A's centre to B's anchor
    const Vector d = reach - rotate(pair.turn_a, arm_a);
    for (int i = 0; i < rows; ++i) {
      row[i].n = rotate(pair.turn_a, normal[i]);
      row[i].lever_a = cross(reach, row[i].n);
      row[i].lever_b = cross(b, row[i].n);
      row[i].error = dot(d, row[i].n);
    }
  }
  template <class Pair>
  void warm_start(Pair& pair) const {
    Row row[rows];
    directions(pair, row);
    for (int i = 0; i < rows; ++i) pair.apply_row(impulse[i], row[i].n, row[i].lever_a, row[i].lever_b);
  }
  template <class Pair>
  void solve(Pair& pair, const JointPass& pass) {
    const Response& r = pass.rigid;
    Row row[rows];
    directions(pair, row);
    float wanted[rows], residual[rows];
    for (int i = 0; i < rows; ++i)
      residual[i] =
          r.velocity * pair.row_velocity(row[i].n, row[i].lever_a, row[i].lever_b) + r.position * row[i].error;
    const float k00 = pair.row_inverse_mass(row[0].lever_a, row[0].lever_b);
    if constexpr (rows == 1) {
      wanted[0] = solve_mobility(k00, residual[0]);
    } else {
      const float k11 = pair.row_inverse_mass(row[1].lever_a, row[1].lever_b);
      const float k01 = inner(row[0].lever_a, pair.inverse_inertia_a * row[1].lever_a) +
                        inner(row[0].lever_b, pair.inverse_inertia_b * row[1].lever_b);
      const Vec2f x = solve_mobility(Mat2f{{k00, k01}, {k01, k11}}, Vec2f{residual[0], residual[1]});
      wanted[0] = x.x;
      wanted[1] = x.y;
    }
    for (int i = 0; i < rows; ++i) {
      const float change = -wanted[i] - r.memory * impulse[i];
      impulse[i] += change;
      pair.apply_row(change, row[i].n, row[i].lever_a, row[i].lever_b);
    }
  }
};

}  // namespace carom::rigid::detail
