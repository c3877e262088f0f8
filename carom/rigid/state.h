// What one reads from a world.
#pragma once

#include <variant>
#include <vector>

#include "carom/rigid/definitions.h"

namespace carom::rigid {

template <class D>
struct BodyState {
  typename D::Pose pose{};                 ///< of the body's origin
  typename D::Position center_of_mass{};   ///< m, world
  typename D::Vector linear_velocity{};    ///< m/s, of the centre of mass
  typename D::Angular angular_velocity{};  ///< rad/s, world axes
  float mass = 0;                          ///< kg, 0: does not move by forces
  BodyType type = BodyType::dynamic;
  bool awake = true;
  bool enabled = true;
  std::uint64_t user_data = 0;
};

template <class D>
struct JointState {
  JointType type{};
  BodyId body_a{}, body_b{};
  typename D::Vector force{};    ///< N, on B, over the last step
  typename D::Angular torque{};  ///< N·m, on B
  float coordinate = 0;          ///< angle (hinge) or translation (slider, distance)
  float speed = 0;
  float linear_error = 0;   ///< m by which the joint is pulled apart
  float angular_error = 0;  ///< rad
  bool direct = false;      ///< in the last step its rigid rows were solved directly (WorldDef::joint_solver)
};

template <class D>
using AnyJointDef =
    std::variant<DistanceJointDef<D>, BallJointDef<D>, HingeJointDef<D>, SliderJointDef<D>, WeldJointDef<D>,
                 MotorJointDef<D>, MouseJointDef<D>, GenericJointDef<D>, GearJointDef<D>, RackJointDef<D>,
                 ScrewJointDef<D>, PulleyJointDef<D>, PathJointDef<D>>;

template <class D>
struct ContactView {
  ShapeId shape_a{}, shape_b{};
  std::uint32_t material_a = 0, material_b = 0;  ///< Material::user_id of the parts that touch
  typename D::Vector normal{};                   ///< from A to B, world
  int count = 0;
  struct Point {
    typename D::Position point{};
    float separation = 0;      ///< m
    float normal_impulse = 0;  ///< N·s over the step
  } points[D::max_points];
  typename D::Vector friction_impulse{};  ///< N·s on B over the step
  int color = -1;                         ///< of the constraint graph
};

template <class D>
struct Totals {
  double mass = 0;  ///< kg, dynamic bodies
  typename D::Position center_of_mass{};
  typename D::Position momentum{};                                          ///< kg·m/s
  std::conditional_t<D::dimension == 2, double, Vec3d> angular_momentum{};  ///< kg·m²/s about the origin
  double kinetic_energy = 0;                                                ///< J
  double potential_energy = 0;  ///< J, in uniform gravity, zero at the origin's height
};

struct Counters {
  int bodies = 0, awake_bodies = 0, shapes = 0, joints = 0, effectors = 0;
  int contacts = 0, touching_contacts = 0, contact_points = 0;
  int islands = 0, colors = 0, overflow_constraints = 0;
  std::size_t bytes = 0;       ///< memory held by the world, without shared hulls and meshes
  std::size_t peak_bytes = 0;  ///< the most that it held after any step
};

/// Milliseconds of the last step.
struct StepProfile {
  double total = 0, effectors = 0, broad_phase = 0, narrow_phase = 0, prepare = 0, solve = 0, restitution = 0,
         finalize = 0, continuous = 0, sensors = 0, sleep = 0;
};

}  // namespace carom::rigid
