// Everything one says to a world: worlds, bodies, shapes and joints as plain structs with good defaults.
// SI units, radians, right-handed, y up. Made for designated initialisers.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "carom/core/handle.h"
#include "carom/rigid/dimension.h"

namespace carom::core {
class Profiler;       // core/profiler.h
class TaskScheduler;  // core/scheduler.h
}  // namespace carom::core

namespace carom::rigid {

using BodyId = core::Handle<struct BodyTag>;
using ShapeId = core::Handle<struct ShapeTag>;
using JointId = core::Handle<struct JointTag>;
using EffectorId = core::Handle<struct EffectorTag>;

template <class D>
constexpr typename D::Vector default_gravity() {
  if constexpr (D::dimension == 2)
    return {0, -9.80665f};
  else
    return {0, -9.80665f, 0};
}

/// Who holds the rigid rows of joints. Iteration is cheap, and gives way under loads far heavier than the joint's own
/// bodies; the direct solver holds trees of joints at any mass ratio, for some microseconds a joint and step.
enum class JointSolver : std::uint8_t {
  automatic,  ///< direct for trees in which some joint carries many times its own bodies
  iterative,
  direct,  ///< for every tree
};

template <class D>
struct WorldDef {
  typename D::Vector gravity = default_gravity<D>();  ///< m/s², uniform
  int substeps = 4;                                   ///< solver substeps in a step, 1 … 64
  int threads = 1;  ///< worker threads the world makes for itself, 1 … 64 (the caller's included)
  core::TaskScheduler* scheduler = nullptr;  ///< the caller's own, instead; must outlive the world
  core::Profiler* profiler = nullptr;        ///< takes the stages of every step, lane 0; must outlive the world
  int simd_width = 0;  ///< lanes of the contact solver: 4, 8 or 16, or 0 for what suits machine and work; same results
  bool allow_sleep = true;
  bool continuous = true;              ///< fast bodies never pass through static geometry
  float restitution_threshold = 1.0f;  ///< m/s: slower impacts do not bounce
  float contact_hertz = 36.0f;         ///< stiffness of contacts, capped at .15 of the substep rate
  float contact_damping_ratio = 10.0f;
  float contact_push_speed = 3.0f;  ///< m/s: overlapping bodies separate no faster
  float joint_hertz = 60.0f;        ///< stiffness of joints, capped at 1/4 of the substep rate (iterative: 1/5)
  float joint_damping_ratio = 2.0f;
  JointSolver joint_solver = JointSolver::automatic;
  float maximum_linear_speed = 4.0e3f;  ///< m/s
  float sleep_time = 0.5f;              ///< s below the sleep speed before an island sleeps
  bool move_events = false;             ///< tell after every step where each awake body now is
};

/// How much a world is to have room for.
struct Capacity {
  int bodies = 0;
  int shapes = 0;
  int contacts = 0;  ///< pairs of shapes whose bounds overlap: about four a body in heaps
  int joints = 0;
  int direct_joints = 0;  ///< of them solved directly (WorldDef::joint_solver) at one time: about 3 kB each
};

enum class BodyType : std::uint8_t { fixed, kinematic, dynamic };

/// Degrees of freedom that do not move, in world axes.
struct MotionLocks {
  bool x = false, y = false, z = false;                             ///< translation (z: 3D only)
  bool rotation_x = false, rotation_y = false, rotation_z = false;  ///< 2D has rotation_z only
  friend bool operator==(const MotionLocks&, const MotionLocks&) = default;
};

template <class D>
struct BodyDef {
  BodyType type = BodyType::dynamic;
  typename D::Position position{};  ///< m, of the body's origin
  typename D::Rotation rotation{};
  typename D::Vector linear_velocity{};    ///< m/s, of the centre of mass
  typename D::Angular angular_velocity{};  ///< rad/s, world axes
  float linear_damping = 0;                ///< 1/s
  float angular_damping = 0;               ///< 1/s
  float gravity_scale = 1;
  /// .001 … 1000: the seconds that a dynamic body lives in a second of the world. What acts on it acts in its own time:
  /// gravity, forces, effectors and damping, joint springs and motors, the threshold of restitution and sleep. What all
  /// share stays the world's: velocities are told in its m/s, contacts and impulses exchange momentum in it. Bodies of
  /// one scale do together what they do at 1, slower or faster. A joint takes the geometric mean of its two bodies.
  float time_scale = 1;
  float sleep_speed = 0.05f;  ///< m/s; 0: never sleeps
  /// 0 … 64: what touches this body or is jointed to it is solved with so many substeps at least, and with contacts and
  /// joints stiffer in proportion (frequency × substeps/WorldDef::substeps). Other islands do not pay.
  int substeps = 0;
  MotionLocks locks{};
  bool awake = true;  ///< false: asleep until something awake touches it
  bool allow_sleep = true;
  bool bullet = false;  ///< continuous against moving bodies too
  bool enabled = true;
  std::uint64_t user_data = 0;
  std::string_view name{};  ///< for reports and pictures; copied
};

/// How a surface behaves. Mixed for a pair: friction √(ab), restitution max(a, b), resistances max(a, b), unless the
/// world has a rule for the two user_ids (World::set_pair_rule).
struct Material {
  float friction = 0.6f;         ///< Coulomb's μ, ≥ 0
  float restitution = 0;         ///< 0 … 1
  float rolling_resistance = 0;  ///< lever arm / radius (what is not round: half its thickness), ≥ 0
  /// Likewise of what spins about the normal of the contact (3D), ≥ 0. Rolling resistance holds against spin too; this
  /// is for what spins less freely than it rolls. None without friction.
  float spinning_resistance = 0;
  float tangent_speed = 0;  ///< m/s along the surface (2D), a conveyor
  std::uint32_t user_id = 0;
  friend bool operator==(const Material&, const Material&) = default;
};
/// What parts of a surface (triangles of a mesh, cells of a height field, segments of a chain) are made of.
template <class D>
struct SurfaceMaterial {
  Material material{};
  typename D::Vector surface_velocity{};  ///< m/s, in the shape's frame: the part runs like a belt
  friend bool operator==(const SurfaceMaterial&, const SurfaceMaterial&) = default;
};
/// What holds between two materials instead of the mixture: rubber on ice is neither.
struct PairRule {
  float friction = 0.6f;          ///< ≥ 0
  float restitution = 0;          ///< 0 … 1
  float rolling_resistance = 0;   ///< ≥ 0
  float spinning_resistance = 0;  ///< ≥ 0
  /// Coulomb's μ of what sticks: holds a contact up to this, until it slides; then `friction` does, until it stops.
  /// 0: as `friction`; otherwise at least that.
  float static_friction = 0;
};
struct MaterialPair {
  std::uint32_t material_a = 0, material_b = 0;  ///< user_ids
  PairRule rule{};
};

/// Two shapes collide where each one's category is in the other's mask, unless they share a non-zero group:
/// a negative group never collides, a positive one always.
struct Filter {
  std::uint64_t category = 1;
  std::uint64_t mask = ~std::uint64_t{0};
  std::int32_t group = 0;
  friend bool operator==(const Filter&, const Filter&) = default;
};

template <class D>
struct ShapeDef {
  typename D::Transform local{};  ///< shape → body
  float density = 1000;           ///< kg/m³ (2D: kg/m²), ≥ 0
  Material material{};
  /// For a geometry whose parts are numbered by material (make_triangle_mesh, make_height_field, make_chain): what
  /// those numbers stand for, in place of `material` and `surface_velocity`. Empty: the same everywhere. At most 256.
  std::vector<SurfaceMaterial<D>> surfaces{};
  Filter filter{};
  bool sensor = false;           ///< reports overlaps, pushes nothing
  bool contact_events = true;    ///< begin and end events
  bool hit_events = false;       ///< an event with impulse and speed on every hard impact
  bool modify_contacts = false;  ///< the world's contact modifier is asked about its contacts in every step
  /// m/s, in the shape's frame: the surface runs like a belt, the shape stays. Friction carries what lies on it.
  typename D::Vector surface_velocity{};
  /// In the shape's frame, any length: holds bodies that come against this direction and lets through what comes from
  /// elsewhere, until it is out again. {0, 1} is a platform to jump through from below. Zero: solid.
  typename D::Vector one_way{};
  std::uint64_t user_data = 0;
};

/// An impulse outward from a point, for all dynamic bodies near it (World::explode).
template <class D>
struct ExplosionDef {
  typename D::Position center{};
  float radius = 5;            ///< m of full strength, measured to the nearest point of a shape
  float falloff = 0;           ///< m beyond, over which it falls to nothing
  float impulse_per_area = 0;  ///< N·s/m² (2D: N·s/m) on the area that a shape turns to the centre; negative: pulls
  float speed = 0;             ///< m/s given besides to every body, whatever its mass
  std::uint64_t mask = ~std::uint64_t{0};  ///< categories of shapes that feel it
};

enum class JointType : std::uint8_t {
  distance,
  ball,
  hinge,
  slider,
  weld,
  motor,
  mouse,
  generic,
  gear,
  rack,
  screw,
  pulley,
  path
};

template <class D>
struct JointFrames {
  BodyId body_a{}, body_b{};
  typename D::Transform frame_a{}, frame_b{};  ///< joint frame in each body's frame
  bool collide_connected = false;
  float break_force = 0;   ///< N, 0: never. Above it after a step, the joint is destroyed and told of in an event.
  float break_torque = 0;  ///< N·m, likewise
};

/// A spring toward the joint's rest state: natural frequency (Hz, 0: none) and damping ratio of what moves on it. Exact
/// in time, frequency and decay, up to about a tenth of the substep rate; stiffer springs are stable but damp more.
struct JointSpring {
  float hertz = 0;
  float damping_ratio = 0;
  friend bool operator==(const JointSpring&, const JointSpring&) = default;
};
struct JointLimit {
  bool enabled = false;
  float lower = 0, upper = 0;  ///< m or rad
  friend bool operator==(const JointLimit&, const JointLimit&) = default;
};
/// At speed 0 it is dry friction of `max_force`.
struct JointMotor {
  bool enabled = false;
  float speed = 0;      ///< m/s or rad/s
  float max_force = 0;  ///< N or N·m
  friend bool operator==(const JointMotor&, const JointMotor&) = default;
};

/// Keeps the frames' origins `length` apart. With a spring: a spring about `length` between the limits.
/// A rope: limit {true, 0, length} with spring hertz 0 and `rope` set.
template <class D>
struct DistanceJointDef : JointFrames<D> {
  float length = 1;
  bool rope = false;  ///< only ever pulls
  JointSpring spring{};
  JointLimit limit{};
  JointMotor motor{};
};
/// Keeps the frames' origins together; turns freely (3D), within a cone about frame z of A and a twist range.
template <class D>
struct BallJointDef : JointFrames<D> {
  JointSpring spring{};                    ///< toward `target_rotation`
  typename D::Rotation target_rotation{};  ///< of frame B in frame A; the default: frames aligned
  float cone_angle = -1;                   ///< rad, < 0: no limit
  JointLimit twist{};
  float friction_torque = 0;  ///< N·m
};
/// Turns about z of the frames only (2D: the revolute joint).
template <class D>
struct HingeJointDef : JointFrames<D> {
  JointSpring spring{};
  float target_angle = 0;       ///< rad, of the spring
  float max_spring_torque = 0;  ///< N·m, 0: as much as it takes. With a stiff spring: a motor to a position.
  JointLimit limit{};
  JointMotor motor{};
};
/// Slides along x of frame A only (the prismatic joint).
template <class D>
struct SliderJointDef : JointFrames<D> {
  JointSpring spring{};
  float target_translation = 0;  ///< m, of the spring
  float max_spring_force = 0;    ///< N, 0: as much as it takes. With a stiff spring: a motor to a position.
  JointLimit limit{};
  JointMotor motor{};
};
/// Frames stay together; a spring of 0 Hz is rigid.
template <class D>
struct WeldJointDef : JointFrames<D> {
  JointSpring linear{};
  JointSpring angular{};
};
/// Drives B toward a pose relative to A, or at a velocity, with limited force and torque.
template <class D>
struct MotorJointDef : JointFrames<D> {
  JointSpring linear{2.0f, 1.0f};  ///< 0 Hz: as much as it takes
  JointSpring angular{2.0f, 1.0f};
  float max_force = 1e3f;                  ///< N
  float max_torque = 1e3f;                 ///< N·m
  typename D::Vector target_position{};    ///< m, of B's frame in A's
  typename D::Rotation target_rotation{};  ///< likewise
  /// m/s and rad/s, as seen from A in the axes of its frame: what the springs damp toward. The target itself stays.
  typename D::Vector target_velocity{};
  typename D::Angular target_spin{};
  bool hold_position = true;  ///< false: drives at `target_velocity` wherever B is, as hard as it takes
  bool hold_rotation = true;  ///< likewise at `target_spin`
};
/// Pulls a point of B toward a target in the world: the hand of a user. body_a is ignored; frame_b.p is the point.
/// Slows the body's turning too, at the rate ½ hertz · damping_ratio (1/s).
template <class D>
struct MouseJointDef : JointFrames<D> {
  typename D::Position target{};
  JointSpring spring{5.0f, 1.0f};
  float max_force = 1e4f;  ///< N
};

/// One coordinate of a generic joint: held at zero, or free and then with what one wants of these.
struct JointAxis {
  bool free = false;
  JointLimit limit{};
  JointSpring spring{};        ///< toward `target`
  float target = 0;            ///< m or rad
  float max_spring_force = 0;  ///< N or N·m, 0: as much as it takes. With a stiff spring: a motor to a position.
  JointMotor motor{};
  float friction = 0;  ///< N or N·m, where no motor is enabled
  friend bool operator==(const JointAxis&, const JointAxis&) = default;
};

/// Six degrees of freedom (2D: three), each free or held. Linear: of B's origin along x, y, z of frame A. Angular, in
/// space: Cardan angles about x of frame A, then y, then z of frame B; the middle one keeps within ±90°.
template <class D>
struct GenericJointDef : JointFrames<D> {
  JointAxis linear[D::dimension];
  JointAxis angular[D::dimension == 2 ? 1 : 3];
};
/// Slides along x of the frames and turns about it.
template <class D>
GenericJointDef<D> make_cylindrical_joint(const JointFrames<D>& frames)
  requires(D::dimension == 3)
{
  GenericJointDef<D> d{frames, {}, {}};
  d.linear[0].free = d.angular[0].free = true;
  return d;
}
/// Slides in the plane of x and y and turns about z.
template <class D>
GenericJointDef<D> make_planar_joint(const JointFrames<D>& frames)
  requires(D::dimension == 3)
{
  GenericJointDef<D> d{frames, {}, {}};
  d.linear[0].free = d.linear[1].free = d.angular[2].free = true;
  return d;
}
/// Turns about x of frame A and z of frame B, which stay at right angles: Cardan's joint.
template <class D>
GenericJointDef<D> make_universal_joint(const JointFrames<D>& frames)
  requires(D::dimension == 3)
{
  GenericJointDef<D> d{frames, {}, {}};
  d.angular[0].free = d.angular[2].free = true;
  return d;
}
/// A wheel B on its carrier A: a spring along y, rolling about z, in space steered about y where `angular[1]` is freed.
template <class D>
GenericJointDef<D> make_wheel_joint(const JointFrames<D>& frames, JointSpring suspension, JointLimit travel) {
  GenericJointDef<D> d{frames, {}, {}};
  d.linear[1].free = true;
  d.linear[1].spring = suspension;
  d.linear[1].limit = travel;
  d.angular[D::dimension == 2 ? 0 : 2].free = true;
  return d;
}

/// Keeps the spin of B about z of its frame at `ratio` times that of A about z of its own. Wheels that mesh outside
/// have a negative ratio. Each needs a hinge of its own.
template <class D>
struct GearJointDef : JointFrames<D> {
  float ratio = -1;  ///< not 0
};
/// Keeps the speed of B along x of its frame, as seen from the centre of A, at `radius` times the spin of A about z of
/// its frame. The pinion A needs a hinge, the rack B a slider.
template <class D>
struct RackJointDef : JointFrames<D> {
  float radius = 1;  ///< m, not 0; the sign says which way
};
/// Along x of frame A, B moves by `pitch` a turn that it makes about x against A. Space only; needs a cylindrical
/// joint.
template <class D>
struct ScrewJointDef : JointFrames<D> {
  float pitch = 0.01f;  ///< m a turn, not 0; positive: right-handed
};
/// A rope from frame_a.p over `ground_a` and `ground_b` to frame_b.p: |a − ground_a| + ratio |b − ground_b| ≤ length.
template <class D>
struct PulleyJointDef : JointFrames<D> {
  typename D::Position ground_a{}, ground_b{};  ///< world
  float length = 1;                             ///< m
  float ratio = 1;                              ///< > 0; a block and tackle on B's side
};

/// B's anchor stays on a curve that is fixed in A (body_a null: in the world): a bead on a wire, a lift, a coaster. An
/// open path ends in stops. Held at once with what hangs on it (joint trees), so that a bead keeps its energy.
template <class D>
struct PathJointDef : JointFrames<D> {
  /// m, in frame A; two or more (closed: three), each apart from the next. Copied; of a definition that is read back,
  /// valid until the world's joints change.
  std::span<const typename D::Vector> points{};
  /// m from point to point, dγ/du at each point, for a piecewise cubic curve of Hermite's form. None: Catmull and
  /// Rom's, half the way between the neighbours (Catmull & Rom, "A class of local interpolating splines", 1974).
  std::span<const typename D::Vector> tangents{};
  bool straight = false;  ///< lines from point to point
  bool closed = false;    ///< from the last point on to the first
  bool follow = false;    ///< keeps x of frame B along the path (in space, B may roll about it)
  // Along the path, in m from its first point:
  JointSpring spring{};        ///< toward `target_distance`; on a closed path the shorter way
  float target_distance = 0;   ///< m
  float max_spring_force = 0;  ///< N, 0: as much as it takes. With a stiff spring: a motor to a position.
  JointLimit limit{};          ///< of open paths, within their ends
  JointMotor motor{};
  float friction = 0;  ///< N, where no motor is enabled
};

}  // namespace carom::rigid
