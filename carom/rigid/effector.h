// Effectors join the force models of carom/forces to the bodies of a world. They are data, so that a scene file can
// hold them; a model in user code comes in as CustomEffector.
#pragma once

#include <functional>
#include <memory>
#include <variant>

#include "carom/forces/attitude.h"
#include "carom/forces/drag_law.h"
#include "carom/rigid/state.h"

namespace carom::environment {
class Environment;
}

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
/// All that is around the bodies of a world, from one object (environment/environment.h): its gravity (beside the
/// world's own) and turning frame act on every body, drag and lift effectors feel its wind and air, and what floats
/// floats on its water. The last one added counts. In the plane x and y of it are taken, at z = 0. Snapshots in memory
/// keep it; bytes do not carry it, like a CustomEffector.
template <class D>
struct Surroundings {
  std::shared_ptr<const environment::Environment> environment;
};
/// The air moves, everywhere alike: what drag effectors of the same world feel, beside the wind of its Surroundings.
template <class D>
struct Wind {
  typename D::Vector velocity{};  ///< m/s
};
/// Drag by the flow round the body: C_d from Reynolds and Mach number (forces/drag_law.h). The air is that of the
/// world's Surroundings, or what stands here.
template <class D>
struct BodyDrag : EffectorTarget {
  forces::DragLaw law{};
  double diameter = 1;                 ///< m, the length that Re is made with
  double area = 0.785398163397448310;  ///< m²; in the plane m² per metre of depth
  typename D::Vector point{};          ///< body frame, from the origin
  double density = 1.225;              ///< kg/m³
  double viscosity = 1.7894e-5;        ///< Pa·s
  double speed_of_sound = 340.294;     ///< m/s
};
/// Lift of a spinning ball by measured coefficients: ½ ρ π r² V² C_L(rω/V), across spin and way.
template <class D>
struct MagnusLift : EffectorTarget {
  forces::LiftLaw law{};
  double radius = 0.5;     ///< m
  double density = 1.225;  ///< kg/m³, where the world has no Surroundings
};
template <class D>
constexpr typename D::Vector unit_x() {
  typename D::Vector v{};
  v.x = 1;
  return v;
}
/// A wing, fin, sail or plate fixed to a body: lift and drag by its angle of attack, all the way round, at its centre
/// of pressure (forces/attitude.h). In the plane it is a metre deep.
template <class D>
struct LiftingSurface : EffectorTarget {
  forces::WingLaw law{};
  typename D::Vector point{};                ///< body frame, from the origin: the middle of the surface
  typename D::Vector forward = unit_x<D>();  ///< body frame: to its leading edge
  Vec3f up{0, 1, 0};                         ///< body frame, 3D only: out of its upper side
  double area = 1;                           ///< m²
  double chord = 1;                          ///< m
  double density = 1.225;                    ///< kg/m³, where the world has no Surroundings
};
/// A cylinder, such as a mast, an arrow, a pole, a rocket's body, that feels the flow along and across itself apart
/// (forces/attitude.h). In the plane it lies in it.
template <class D>
struct CylinderDrag : EffectorTarget {
  typename D::Vector point{};             ///< body frame, from the origin: its middle
  typename D::Vector axis = unit_x<D>();  ///< body frame
  double diameter = 0.1;                  ///< m
  double length = 1;                      ///< m
  double density = 1.225;                 ///< kg/m³, where the world has no Surroundings
  double viscosity = 1.7894e-5;           ///< Pa·s, likewise
};
/// The world stands in a frame that turns: −2 Ω × v, and the centrifugal Ω² r on request. The Earth's: environment::
/// earth_rate. Coriolis' force does no work here either, whatever the step.
template <class D>
struct TurningFrame : EffectorTarget {
  typename D::Angular rate{};     ///< rad/s
  typename D::Position center{};  ///< m, on the axis
  bool centrifugal = false;
};
/// Uniform fields on charged bodies: F = q (E + v × B). The magnetic part turns velocities as Boris (1970) does it: it
/// does no work, and the circles have r = m v/(q B) for any step. In the plane only z of B counts.
template <class D>
struct ElectromagneticField : EffectorTarget {
  double charge = 0;              ///< C, of each body acted on
  typename D::Vector electric{};  ///< V/m
  Vec3f magnetic{};               ///< T
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
  double break_force = 0;          ///< N, 0: never. Above it after a step the spring is gone and told of in an event.
};
/// Archimedes: ρ g times the submerged volume, at its centre, with drag of the wet part. The surface is
/// y = level + Σ a sin(k x − ω t + φ) in x (deep water: ω² = g k). Where the world has Surroundings with water, that is
/// the water: density, level, waves and current here are not used, and what is wet is also pushed with the water's own
/// acceleration (Froude and Krylov).
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
  /// Shares of the displaced mass that speed up with the body along each of its own axes: .5 of a sphere
  /// (forces/added_mass.h).
  typename D::Vector added_mass{};
  typename D::Angular added_inertia{};  ///< m²: the same for turning, kg·m² for each displaced kg
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

/// What a user's own effector sees and returns, in world axes; velocities in the body's own time (time_scale).
template <class D>
struct EffectorInput {
  BodyId body;
  BodyState<D> state;
  double time;                                       ///< s, at the beginning of the step
  const environment::Environment* around = nullptr;  ///< of the world's Surroundings; null where it has none
  typename D::Position wind{};                       ///< m/s, of the world's Wind, beside what is around
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
using EffectorDef =
    std::variant<SphericalGravity<D>, LinearDrag<D>, QuadraticDrag<D>, Wind<D>, SpringDamper<D>, Buoyancy<D>, Thrust<D>,
                 RadialField<D>, VortexField<D>, CustomEffector<D>, Surroundings<D>, BodyDrag<D>, MagnusLift<D>,
                 TurningFrame<D>, ElectromagneticField<D>, LiftingSurface<D>, CylinderDrag<D>>;

}  // namespace carom::rigid
