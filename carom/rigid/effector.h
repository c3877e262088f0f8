// Effectors join the force models of carom/forces to the bodies of a world. They are data, so that a scene file can
// hold them; a model in user code comes in as CustomEffector.
#pragma once

#include <functional>
#include <variant>

#include "carom/rigid/state.h"

namespace carom::rigid {

/// Bodies an effector acts on: one body, or (null) every awake dynamic body. An effector that names a body goes with
/// it. Effectors act once a step, on the state in the middle of the step: forces of position by the leapfrog
/// (symplectic), resistances by their exact decay (stable for any coefficient, with the right terminal speed).
struct EffectorTarget {
  BodyId body{};
};

/// Gravity toward a point mass: a = −GM r/r³. In 2D the same law in the plane.
template <class D>
struct SphericalGravity : EffectorTarget {
  typename D::Position center{};
  double gm = 3.986004418e14;   ///< m³/s²
  double minimum_radius = 1.0;  ///< m: inside it the pull stays as at this radius
};
/// F = −c v_rel, N·s/m; torque −c_ω ω.
template <class D>
struct LinearDrag : EffectorTarget {
  double coefficient = 0;          ///< N·s/m
  double angular_coefficient = 0;  ///< N·m·s/rad
};
/// F = −½ ρ C_d A |v_rel| v_rel at `point` of the body.
template <class D>
struct QuadraticDrag : EffectorTarget {
  double density = 1.225;  ///< kg/m³ of the medium
  double drag_coefficient = 0.47;
  double area = 1;                 ///< m²
  typename D::Vector point{};      ///< body frame, from the origin
  double angular_coefficient = 0;  ///< N·m·s²/rad²: torque −c |ω| ω
};
/// The air moves: what drag effectors of the same world feel. Log or power profiles come with the environment issue.
template <class D>
struct Wind {
  typename D::Vector velocity{};  ///< m/s
};
/// Spring and damper between points of two bodies, or of a body and the world (body_b null, point_b in the world).
/// Solved with the joints in every substep, so that stiff springs are stable and undamped ones keep their energy.
template <class D>
struct SpringDamper {
  BodyId body_a{}, body_b{};
  typename D::Vector point_a{};    ///< in A's frame
  typename D::Position point_b{};  ///< in B's frame, or in the world
  double rest_length = 1;          ///< m
  double stiffness = 100;          ///< N/m
  double damping = 0;              ///< N·s/m
};
/// Archimedes: ρ g times the submerged volume, at its centre, with drag of the wet part. The surface is
/// y = level + Σ a sin(k x − ω t + φ) in x (deep water: ω² = g k).
template <class D>
struct Buoyancy : EffectorTarget {
  double density = 1025;    ///< kg/m³
  double level = 0;         ///< m
  double linear_drag = 0;   ///< 1/s, relative to the displaced mass
  double angular_drag = 0;  ///< 1/s
  struct Wave {
    double amplitude = 0, wavelength = 10, phase = 0;
  } waves[4];
  int wave_count = 0;
  typename D::Vector current{};  ///< m/s
};
/// A thruster fixed to a body.
template <class D>
struct Thrust : EffectorTarget {
  typename D::Vector point{};  ///< body frame
  typename D::Vector force{};  ///< N, body frame
};
/// Toward (negative) or away from a point with strength·(distance/reference)^exponent, as an acceleration.
template <class D>
struct RadialField : EffectorTarget {
  typename D::Position center{};
  double strength = 10;  ///< m/s²
  double reference = 1;  ///< m
  double exponent = -2;
  double range = 1e30;  ///< m: no force beyond
};
/// Circles round an axis through `center` (2D: z): pulls bodies along with the vortex' speed by a drag rate.
template <class D>
struct VortexField : EffectorTarget {
  typename D::Position center{};
  Vec3f axis{0, 1, 0};      ///< 3D only
  double circulation = 10;  ///< m²/s: speed = Γ/(2π r)
  double core_radius = 1;   ///< m: solid-body rotation inside
  double rate = 1;          ///< 1/s: a = rate·(v_field − v)
};

/// What a user's own effector sees and returns, in world axes.
template <class D>
struct EffectorInput {
  BodyId body;
  BodyState<D> state;
  double time;
};
template <class D>
struct Wrench {
  typename D::Vector force{};    ///< N at the centre of mass
  typename D::Angular torque{};  ///< N·m
};
/// Not saved in scene files.
template <class D>
struct CustomEffector : EffectorTarget {
  std::function<Wrench<D>(const EffectorInput<D>&)> model;
};

template <class D>
using EffectorDef = std::variant<SphericalGravity<D>, LinearDrag<D>, QuadraticDrag<D>, Wind<D>, SpringDamper<D>,
                                 Buoyancy<D>, Thrust<D>, RadialField<D>, VortexField<D>, CustomEffector<D>>;

}  // namespace carom::rigid
