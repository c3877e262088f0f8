// A world of rigid bodies in two or three dimensions.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string_view>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/voxels.h"
#include "carom/rigid/effector.h"
#include "carom/rigid/events.h"
#include "carom/rigid/snapshot.h"
#include "carom/rigid/state.h"
#include "carom/rigid/step_ways.h"

namespace carom::rigid {
using core::Result;
using core::Status;

/// Which shapes a query sees.
struct QueryFilter {
  std::uint64_t category = ~std::uint64_t{0};
  std::uint64_t mask = ~std::uint64_t{0};
  BodyId ignore{};  ///< whose shapes are not seen; null: none
};
/// One of many rays.
template <class D>
struct RayQuery {
  typename D::Position origin{};
  typename D::Vector translation{};
  QueryFilter filter{};
};
/// One of many casts of a shape.
template <class D>
struct ShapeCastQuery {
  typename D::Pose pose{};
  typename D::Vector translation{};
  QueryFilter filter{};
};
/// One of many places of a shape.
template <class D>
struct OverlapQuery {
  typename D::Pose pose{};
  QueryFilter filter{};
};
template <class D>
struct RayHit {
  ShapeId shape{};
  typename D::Position point{};
  typename D::Vector normal{};
  float fraction = 1;
  std::uint32_t child = 0;     ///< triangle, cell, segment or compound child
  std::uint32_t material = 0;  ///< Material::user_id of that part
};

/// Bodies, shapes, joints and effectors, and their motion in time. Not copyable; two worlds in two threads are
/// independent. Every function that takes a handle or a number from outside returns an error for a stale, foreign or
/// null handle and for a number that is not finite or out of range, and leaves the world as it was.
template <class D>
class CAROM_API World {
 public:
  using Vector = typename D::Vector;
  using Position = typename D::Position;
  using Rotation = typename D::Rotation;
  using Angular = typename D::Angular;
  using Pose = typename D::Pose;
  using Shape = typename D::Shape;

  /// Out-of-range fields are errors at the first step; see `check`.
  explicit World(const WorldDef<D>& definition = {});
  ~World();
  World(World&&) noexcept;
  World& operator=(World&&) noexcept;
  static Status check(const WorldDef<D>& definition);
  const WorldDef<D>& definition() const;

  // Bodies
  Result<BodyId> create_body(const BodyDef<D>& definition);
  Status destroy_body(BodyId body);  ///< with its shapes and joints
  bool contains(BodyId body) const;
  Result<BodyState<D>> state(BodyId body) const;
  Result<BodyDef<D>> body_definition(BodyId body) const;  ///< as it is now: definition and state in one
  Result<geometry::MassProperties2> mass_properties2(BodyId body) const
    requires(D::dimension == 2);
  Result<geometry::MassProperties3> mass_properties3(BodyId body) const
    requires(D::dimension == 3);
  Status set_mass_properties(BodyId body, const typename D::MassProperties& properties);  ///< instead of the shapes'
  Status set_pose(BodyId body, Position position, Rotation rotation);                     ///< teleports
  Status set_velocity(BodyId body, Vector linear, Angular angular);
  Status set_target_pose(BodyId body, Position position, Rotation rotation, float dt);  ///< kinematic: be there in dt
  Status set_type(BodyId body, BodyType type);
  Status set_awake(BodyId body, bool awake);
  Status set_enabled(BodyId body, bool enabled);
  Status set_locks(BodyId body, MotionLocks locks);
  Status set_damping(BodyId body, float linear, float angular);
  Status set_gravity_scale(BodyId body, float scale);
  /// BodyDef::time_scale. A dynamic body goes on at the same speed in its own time: its velocities change.
  Status set_time_scale(BodyId body, float scale);
  Status set_substeps(BodyId body, int substeps);  ///< BodyDef::substeps
  Status set_user_data(BodyId body, std::uint64_t data);

  // Forces last for one step; impulses act at once. Points and vectors in world axes.
  Status add_force(BodyId body, Vector force);  ///< N, at the centre of mass
  Status add_force_at(BodyId body, Vector force, Position point);
  Status add_torque(BodyId body, Angular torque);
  Status add_impulse(BodyId body, Vector impulse);  ///< N·s
  Status add_impulse_at(BodyId body, Vector impulse, Position point);
  Status add_angular_impulse(BodyId body, Angular impulse);
  /// Pushes what is near; returns how many shapes felt it. What would fly off at more than 10⁶ m/s is left alone.
  Result<int> explode(const ExplosionDef<D>& definition);

  // Shapes
  Result<ShapeId> add_shape(BodyId body, const Shape& shape, const ShapeDef<D>& definition = {});
  Status destroy_shape(ShapeId shape);
  bool contains(ShapeId shape) const;
  Result<BodyId> body_of(ShapeId shape) const;
  Result<Shape> shape_geometry(ShapeId shape) const;
  Result<ShapeDef<D>> shape_definition(ShapeId shape) const;
  Status set_material(ShapeId shape, const Material& material);
  Status set_surface(ShapeId shape, int index, const SurfaceMaterial<D>& surface);  ///< one of ShapeDef::surfaces
  /// Terrain that changes (space): part of a height field or voxel grid. What lies on it wakes, contacts follow,
  /// snapshots carry the change. The world changes a copy of its own: the first change after a snapshot copies the
  /// field, others take time in proportion to what they change and to the contacts that are awake. Errors: another kind
  /// of shape, and what geometry's functions of these names refuse; a material that `surfaces` does not have.
  Status set_heights(ShapeId shape, const geometry::GridRectangle& vertices, std::span<const float> heights)
    requires(D::dimension == 3);
  Status set_holes(ShapeId shape, const geometry::GridRectangle& cells, std::span<const std::uint8_t> holes)
    requires(D::dimension == 3);
  Status set_cell_materials(ShapeId shape, const geometry::GridRectangle& cells,
                            std::span<const std::uint8_t> materials)
    requires(D::dimension == 3);
  Status set_cells(ShapeId shape, const geometry::VoxelBlock& block, std::span<const std::uint8_t> cells)
    requires(D::dimension == 3);
  Status set_filter(ShapeId shape, const Filter& filter);
  Status set_density(ShapeId shape, float density);  ///< kg/m³ (2D: kg/m²); the body's mass follows
  Status set_surface_velocity(ShapeId shape, Vector velocity);
  Status set_one_way(ShapeId shape, Vector direction);  ///< zero: solid
  Status set_modify_contacts(ShapeId shape, bool modify);

  // What happens between shapes. Functions of the caller are called on the thread that calls `step`, in an order that
  // depends on nothing but the world; they must not call the world, and they are not part of snapshots.
  /// Instead of the mixture for materials with these user_ids, in either order; null: the mixture again.
  Status set_pair_rule(std::uint32_t material_a, std::uint32_t material_b, const PairRule* rule);
  void pair_rules(std::vector<MaterialPair>& out) const;
  using ContactFilter = std::function<bool(ShapeId, ShapeId)>;
  /// Asked, after the filters of the shapes, when the bounds of two shapes come to overlap: false, and they do not
  /// collide until they part and meet again. Kinematic characters ask in every move about what is near.
  void set_contact_filter(ContactFilter filter);
  using ContactModifier = std::function<void(ContactModification<D>&)>;
  /// Asked before every step about each patch of contact of shapes that have modify_contacts.
  void set_contact_modifier(ContactModifier modifier);

  // Joints. One definition struct a type (definitions.h). body_a null: the world, frame_a in world axes.
  Result<JointId> create_joint(const DistanceJointDef<D>& definition);
  Result<JointId> create_joint(const BallJointDef<D>& definition);
  Result<JointId> create_joint(const HingeJointDef<D>& definition);
  Result<JointId> create_joint(const SliderJointDef<D>& definition);
  Result<JointId> create_joint(const WeldJointDef<D>& definition);
  Result<JointId> create_joint(const MotorJointDef<D>& definition);
  Result<JointId> create_joint(const MouseJointDef<D>& definition);
  Result<JointId> create_joint(const GenericJointDef<D>& definition);
  Result<JointId> create_joint(const GearJointDef<D>& definition);
  Result<JointId> create_joint(const RackJointDef<D>& definition);
  Result<JointId> create_joint(const ScrewJointDef<D>& definition);  ///< space only
  Result<JointId> create_joint(const PulleyJointDef<D>& definition);
  Result<JointId> create_joint(const PathJointDef<D>& definition);
  Status destroy_joint(JointId joint);
  bool contains(JointId joint) const;
  Result<JointState<D>> joint_state(JointId joint) const;
  Result<AnyJointDef<D>> joint_definition(JointId joint) const;  ///< as it is now
  // What of a joint can change.
  Status set_motor(JointId joint, const JointMotor& motor);     ///< distance, hinge, slider, path
  Status set_limit(JointId joint, const JointLimit& limit);     ///< distance, ball (its twist), hinge, slider, path
  Status set_spring(JointId joint, const JointSpring& spring);  ///< both springs of a weld or motor joint
  // What these set to what it is wakes nobody.
  Status set_spring_target(JointId joint, float target);                      ///< m or rad: hinge, slider, path
  Status set_max_spring_force(JointId joint, float most);                     ///< N or N·m, 0: any; hinge, slider, path
  Status set_target_rotation(JointId joint, Rotation target);                 ///< ball, motor
  Status set_target_pose(JointId joint, Vector position, Rotation rotation);  ///< motor
  Status set_target_velocity(JointId joint, Vector velocity, Angular spin);   ///< motor
  Status set_hold(JointId joint, bool position, bool rotation);               ///< motor
  Status set_max_force(JointId joint, float force, float torque);             ///< motor; mouse (torque: 0)
  Status set_length(JointId joint, float length);                             ///< m: distance, pulley
  Status set_cone_angle(JointId joint, float angle);                          ///< rad, < 0: none; ball in space
  Status set_friction(JointId joint, float friction);  ///< N or N·m: ball, path (others: a motor at speed 0)
  Status set_break_force(JointId joint, float force, float torque);  ///< N, N·m, 0: never; every joint
  /// Of a generic joint: the linear axes come first, then the angular ones. Whether it is free stays as it was made.
  Status set_axis(JointId joint, int axis, const JointAxis& settings);
  Status set_mouse_target(JointId joint, Position target);

  // Effectors: forces that act on their own every step (effector.h).
  Result<EffectorId> add_effector(const EffectorDef<D>& definition);
  Status destroy_effector(EffectorId effector);
  Result<EffectorDef<D>> effector_definition(EffectorId effector) const;
  Status set_effector(EffectorId effector, const EffectorDef<D>& definition);

  Status set_gravity(Vector gravity);

  /// Advances by dt seconds (0 < dt ≤ 1). No allocation once warm. Callers fix dt: see ode/clock.h.
  Status step(float dt);
  std::uint64_t step_count() const;
  double time() const;  ///< s
  Events<D> events() const;

  /// Makes room beforehand, so that even the first steps with that much do not allocate, and keeps it.
  /// Errors: a negative number or more than 2^24 of anything.
  Status reserve(const Capacity& capacity);

  // Rollback (docs/snapshots.md).
  void snapshot(Snapshot<D>& into);  ///< keeps the memory of `into`
  Snapshot<D> snapshot();
  /// Puts the state back; handles are valid again, and a world of another process goes on as this one would. Threads,
  /// scheduler and SIMD width stay this world's own, events are forgotten. Errors, and nothing changes: an empty one,
  /// one whose shared geometry or functions are not here, bytes that are not a world's state (which thing, and how).
  Status restore(const Snapshot<D>& snapshot);

  // Queries. Rays and casts go from `origin` by `translation`.
  Result<RayHit<D>> ray_cast(Position origin, Vector translation,
                             QueryFilter filter = {}) const;  ///< closest; null shape: none
  Status ray_cast_all(Position origin, Vector translation, std::vector<RayHit<D>>& hits, QueryFilter filter = {}) const;
  Result<RayHit<D>> shape_cast(const Shape& shape, const Pose& pose, Vector translation, QueryFilter filter = {}) const;
  Status overlap(const Shape& shape, const Pose& pose, std::vector<ShapeId>& found, QueryFilter filter = {}) const;
  Status overlap_bounds(const typename D::Bounds& bounds, std::vector<ShapeId>& found, QueryFilter filter = {}) const;
  /// Awake bodies of which some point may move faster than `speed` (m/s): they come from afar within a step.
  void fast_bodies(float speed, std::vector<BodyId>& found) const;

  // Many queries at once, on the world's threads: the same answers as one by one, to the bit. Errors: a bad query,
  // which the message names by its number, and then none is answered; results that are not as many as queries.
  Status cast_rays(std::span<const RayQuery<D>> rays, std::span<RayHit<D>> hits) const;
  /// Bodies on their ways through the last step, for what flies meanwhile: about `ray_length` (m) each, or any length.
  void find_ways(StepWays<D>& into, double ray_length = 0) const;
  /// Where a body was at a fraction of the last step; where it is now, if it stood.
  Result<Pose> pose_in_step(BodyId body, double fraction, const StepWays<D>& ways) const;
  /// Rays that go their way within the last step, ray i from the fraction begins[i] of it (none given: from 0) to its
  /// end: what moved in it is met where it was at each moment. Points and normals are those of that moment.
  Status cast_rays(std::span<const RayQuery<D>> rays, std::span<const float> begins, std::span<RayHit<D>> hits,
                   const StepWays<D>& ways) const;
  Status cast_shapes(const Shape& shape, std::span<const ShapeCastQuery<D>> casts, std::span<RayHit<D>> hits) const;
  /// What query i found stands in `found` from ends[i − 1] (0 for the first) to ends[i].
  Status overlap_shapes(const Shape& shape, std::span<const OverlapQuery<D>> queries, std::vector<ShapeId>& found,
                        std::span<std::uint32_t> ends) const;

  // The whole world, in creation order of what still exists.
  void bodies(std::vector<BodyId>& out) const;
  void shapes(BodyId body, std::vector<ShapeId>& out) const;
  void joints(std::vector<JointId>& out) const;
  void effectors(std::vector<EffectorId>& out) const;
  void contacts(std::vector<ContactView<D>>& out) const;               ///< touching contacts with points and impulses
  void contacts(BodyId body, std::vector<ContactView<D>>& out) const;  ///< of one body; none if it does not exist

  Totals<D> totals() const;         ///< mass, momentum, angular momentum, energies
  Counters counters() const;        ///< bodies, awake, shapes, contacts, joints, islands, colours, bytes
  StepProfile profile() const;      ///< ms of the last step, by stage
  float worst_penetration() const;  ///< m, over touching contacts after the last step
  float worst_joint_error() const;  ///< m
  /// 64-bit hash of every body's pose, velocity and sleep state, in creation order.
  std::uint64_t state_hash() const;

 private:
  template <class>
  friend class Character;  // looks at all that is near it, in every move: copies would cost more than the look
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

extern template class CAROM_API World<Dim2>;
extern template class CAROM_API World<Dim3>;
using World2 = World<Dim2>;
using World3 = World<Dim3>;

}  // namespace carom::rigid
