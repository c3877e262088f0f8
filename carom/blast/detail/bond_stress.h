// How loads on the parts of a body spread over its bonds: parts as rigid bodies, bonds as short beams between them, in
// equilibrium with the loads and with the inertia of the whole. Solved by conjugate gradients (Hestenes & Stiefel,
// 1952), in a fixed order.
#pragma once

#include <vector>

#include "carom/blast/structure.h"
#include "carom/math/elementary.h"

namespace carom::blast::detail {

using math::Mat3d;
using math::Vec2d;
using math::Vec3d;

template <class D>
using AngularD = std::conditional_t<D::dimension == 2, double, Vec3d>;

inline double dot_any(double a, double b) { return a * b; }
inline double dot_any(Vec3d a, Vec3d b) { return dot(a, b); }
inline double size_of(double a) { return math::abs(a); }
inline double size_of(Vec3d a) { return length(a); }
/// Second moment of a section of that area: a round one in space, one a metre deep in the plane.
inline double bending_moment(rigid::Dim3*, double area) { return area * area / (4 * math::pi); }
inline double bending_moment(rigid::Dim2*, double area) { return area * area * area / 12; }
inline double bending_reach(rigid::Dim3*, double area) { return math::sqrt(area / math::pi); }
inline double bending_reach(rigid::Dim2*, double area) { return area / 2; }

template <class D>
struct StressSolver {
  using P = typename D::Position;
  using A = AngularD<D>;
  struct Beam {
    std::uint32_t a, b;  // nodes; b may be `ground`
    std::uint32_t bond;
    P arm_a, arm_b, normal;
    double normal_stiffness, shear_stiffness, turning_stiffness, area;
    bool broken = false;
  };
  std::vector<Beam> beams;
  std::vector<P> force;   // N on each node
  std::vector<A> torque;  // N·m
  std::vector<P> shift;   // m
  std::vector<A> turn;    // rad

  void start(std::size_t nodes) {
    force.assign(nodes, P{}), torque.assign(nodes, A{});
    shift.assign(nodes, P{}), turn.assign(nodes, A{});
    beams.clear();
  }

  struct Internal {
    P force{};   // on a
    A moment{};  // on a
  };
  Internal internal(const Beam& beam, const std::vector<P>& u, const std::vector<A>& w) const {
    P slip = -u[beam.a] - cross(w[beam.a], beam.arm_a);
    A bend = -w[beam.a];
    if (beam.b != ground) {
      slip += u[beam.b] + cross(w[beam.b], beam.arm_b);
      bend = bend + w[beam.b];
    }
    const double along = dot(slip, beam.normal);
    return {beam.shear_stiffness * slip + ((beam.normal_stiffness - beam.shear_stiffness) * along) * beam.normal,
            beam.turning_stiffness * bend};
  }

  /// Up to `iterations` rounds from where the last solution left off.
  void solve(int iterations) {
    const std::size_t n = force.size();
    diagonal_.assign(n, 0), turning_.assign(n, 0);
    for (const Beam& beam : beams) {
      if (beam.broken) continue;
      const double k = beam.shear_stiffness + (beam.normal_stiffness - beam.shear_stiffness) / D::dimension;
      diagonal_[beam.a] += k, turning_[beam.a] += beam.turning_stiffness + k * length_squared(beam.arm_a);
      if (beam.b == ground) continue;
      diagonal_[beam.b] += k, turning_[beam.b] += beam.turning_stiffness + k * length_squared(beam.arm_b);
    }
    r_ = force, rw_ = torque;
    apply(shift, turn);
    double scale = 0;
    for (std::size_t i = 0; i < n; ++i) {
      if (!(diagonal_[i] > 0)) {  // holds to nothing
        r_[i] = P{}, rw_[i] = A{};
        continue;
      }
      scale += length_squared(force[i]) / diagonal_[i] + dot_any(torque[i], torque[i]) / turning_[i];
      r_[i] -= q_[i], rw_[i] = rw_[i] - qw_[i];
    }
    p_.assign(n, P{}), pw_.assign(n, A{});
    double before = 0;
    for (int round = 0; round < iterations; ++round) {
      double now = 0;
      for (std::size_t i = 0; i < n; ++i)
        if (diagonal_[i] > 0) now += length_squared(r_[i]) / diagonal_[i] + dot_any(rw_[i], rw_[i]) / turning_[i];
      if (!(now > 1e-8 * scale)) break;
      const double beta = before > 0 ? now / before : 0;
      for (std::size_t i = 0; i < n; ++i) {
        if (!(diagonal_[i] > 0)) continue;
        p_[i] = r_[i] / diagonal_[i] + beta * p_[i];
        pw_[i] = rw_[i] / turning_[i] + beta * pw_[i];
      }
      apply(p_, pw_);
      double curvature = 0;
      for (std::size_t i = 0; i < n; ++i) curvature += dot(p_[i], q_[i]) + dot_any(pw_[i], qw_[i]);
      if (!(curvature > 0)) break;
      const double alpha = now / curvature;
      for (std::size_t i = 0; i < n; ++i) {
        shift[i] += alpha * p_[i], turn[i] = turn[i] + alpha * pw_[i];
        r_[i] -= alpha * q_[i], rw_[i] = rw_[i] - alpha * qw_[i];
      }
      before = now;
    }
  }

  /// Greatest stress of a beam by what the material bears.
  double load(const Beam& beam, const BondMaterial& m, double strength) const {
    const Internal in = internal(beam, shift, turn);
    constexpr D* dimension = nullptr;
    const double pull = dot(in.force, beam.normal) / beam.area;  // the force on a points to b where it is pulled
    const double shear = length(in.force - dot(in.force, beam.normal) * beam.normal) / beam.area;
    const double bending =
        size_of(in.moment) * bending_reach(dimension, beam.area) / bending_moment(dimension, beam.area);
    return math::max(math::max((pull + bending) / m.tensile_strength, (bending - pull) / m.compressive_strength),
                     shear / m.shear_strength) /
           strength;
  }

 private:
  /// q = K·(u, w).
  void apply(const std::vector<P>& u, const std::vector<A>& w) {
    q_.assign(u.size(), P{}), qw_.assign(u.size(), A{});
    for (const Beam& beam : beams) {
      if (beam.broken) continue;
      const Internal in = internal(beam, u, w);
      q_[beam.a] -= in.force;
      qw_[beam.a] = qw_[beam.a] - cross(beam.arm_a, in.force) - in.moment;
      if (beam.b == ground) continue;
      q_[beam.b] += in.force;
      qw_[beam.b] = qw_[beam.b] + cross(beam.arm_b, in.force) + in.moment;
    }
  }
  std::vector<double> diagonal_, turning_;
  std::vector<P> r_, p_, q_;
  std::vector<A> rw_, pw_, qw_;
};

}  // namespace carom::blast::detail
