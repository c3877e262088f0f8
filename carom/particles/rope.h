// Ropes, cables and chains beside a world of rigid bodies (chapter 13.2–13.3).
//
// A rope is a row of particles with an elastic segment between neighbours. Every substep is one implicit step of the
// whole row together with the bodies that it holds: Newton's method, whose linear system is block-tridiagonal and is
// solved directly, with the attached bodies as a small dense border (Schur complement). So a light rope carries a heavy
// load without giving way. Bending and twist are those of a discrete elastic rod (Bergou, Wardetzky, Robinson, Audoly,
// Grinspun, "Discrete Elastic Rods", 2008). Contacts with shapes of the world hold particles with Coulomb friction
// within the same system, so that the tension falls along a bollard as e^(−μφ).
#pragma once

#include <span>
#include <vector>

#include "carom/environment/wind_field.h"
#include "carom/math/mat.h"
#include "carom/rigid/world.h"

namespace carom::particles {
using core::Result;
using core::Status;
using math::Vec3d;
using math::Vec3f;

/// What a rope is made of.
struct RopeMaterial {
  double mass_per_length = 0.1;    ///< kg/m, > 0
  double radius = 0.01;            ///< m, > 0
  double axial_stiffness = 1e6;    ///< N, EA: force at a strain of one; > 0
  double axial_damping = 0;        ///< N·s, of the strain's rate; ≥ 0
  double bending_stiffness = 0;    ///< N·m², EI ≥ 0
  double bending_damping = 0;      ///< s, in proportion to EI; ≥ 0
  double torsional_stiffness = 0;  ///< N·m², GJ ≥ 0
  double friction = 0.3;           ///< Coulomb's μ, mixed with a shape's as √(ab); ≥ 0
  double drag_coefficient = 1.2;   ///< across, on the diameter (a long cylinder: 1.2); ≥ 0
  double skin_coefficient = 0.01;  ///< along, on the surface; ≥ 0
  double break_tension = 0;        ///< N, 0: never
};

/// Which ropes of its set a rope touches, where `collide` is set.
enum class RopeTouch : std::uint8_t {
  none,
  others,
  itself,  ///< the others and itself
};

struct RopeDef {
  RopeMaterial material{};
  std::span<const Vec3d> points{};  ///< m: the rope lies along these, two or more
  int segments = 20;                ///< 1 … 10 000, of equal length along the way
  double length = 0;                ///< m at rest; 0: as long as it lies
  bool collide = true;              ///< with shapes of the world, and with ropes as `touch` says
  RopeTouch touch = RopeTouch::others;
  rigid::Filter filter{};
};

/// Holds a particle to a point of a body, or of the world where `body` is null.
struct RopeAttachment {
  int node = 0;  ///< −1: the last
  rigid::BodyId body{};
  Vec3d point{};         ///< m, in the body's frame; world: the place
  bool clamped = false;  ///< of an end only: holds the first segment's direction and its turn about it, too
  bool collide = false;  ///< the rope also touches this body's shapes (a drum)
};

struct RopeBreakEvent {
  int rope = 0, segment = 0;
  double tension = 0;  ///< N
};

/// Two segments that touched in the last step. Of a rope that touches itself both are the same rope.
struct RopeCrossing {
  int rope[2] = {0, 0}, segment[2] = {0, 0};
  double share[2] = {0, 0};  ///< along the segment, 0 to 1
  Vec3d normal{};            ///< from the first to the second
  Vec3d force{};             ///< N on the second, over the step
};

/// Where the air stands to the ropes.
struct RopeAir {
  double density = 1.225;  ///< kg/m³, ≥ 0
  environment::Wind wind{};
  environment::WindPatch beyond{};  ///< what blows beyond it, by place
};

namespace detail {
struct FastShape;
struct Rope;
struct RopeAnswer;
struct RopeBody;
struct RopeCross;
struct RopeMemory;
struct RopeShape;
struct RopeSolver;
struct RopeStretch;
}  // namespace detail

/// Ropes that share a world. A value: a copy is a snapshot. Call `step` before every World3::step with the same dt; it
/// hands the bodies their forces for that step.
class CAROM_API RopeSet {
 public:
  RopeSet();
  ~RopeSet();
  RopeSet(const RopeSet&);
  RopeSet& operator=(const RopeSet&);
  RopeSet(RopeSet&&) noexcept;
  RopeSet& operator=(RopeSet&&) noexcept;

  /// Index of the new rope. Errors: numbers out of their ranges, points too close together.
  Result<int> add(const RopeDef& definition);
  /// Errors: no such rope or node, a body that the world does not have, clamped elsewhere than at an end. The node
  /// keeps its place and is drawn to the point within some steps, so that one may attach at a distance.
  Status attach(int rope, const RopeAttachment& attachment, const rigid::World3& world);
  Status detach(int rope, int node);
  Status add_mass(int rope, int node, double mass);  ///< kg, a lump on the rope; it may be taken off again
  /// Reels in (positive, m/s) or pays out at the rope's last (end 1) or first (end 0) particle.
  Status set_winch(int rope, int end, double speed);
  /// Turns the clamped last end by `angle` rad about the rope against the first.
  Status set_twist(int rope, double angle);
  Status set_velocity(int rope, int node, Vec3d velocity);
  /// N·s. Of an attached node the body that holds it takes it; what holds it to the world takes it away.
  Status add_impulse(int rope, int node, Vec3d impulse, rigid::World3& world);
  Status cut(int rope, int segment);
  void set_air(const RopeAir& air) { air_ = air; }
  /// Substeps of a step, 1 … 256; bending adds what it needs. More: less damping of fast swings.
  Status set_substeps(int substeps);

  /// Errors: dt not in (0, 1]; a rope whose bending needs more than 256 substeps. Bodies that are gone let go.
  Status step(rigid::World3& world, double dt);

  int size() const;
  std::span<const Vec3d> positions(int rope) const;
  std::span<const Vec3d> velocities(int rope) const;
  std::span<const double> tensions(int rope) const;  ///< N by segment, at the end of the last step
  std::span<const std::uint8_t> broken(int rope) const;
  double peak_tension(int rope) const;    ///< N, in any substep of the last step
  double rest_length(int rope) const;     ///< m
  double length(int rope) const;          ///< m, as it is now
  double mass(int rope) const;            ///< kg
  double mass(int rope, int node) const;  ///< kg, half of the segments beside it and its lump
  double twist(int rope) const;           ///< rad between the clamped ends, less what the curve takes up
  const RopeMaterial& material(int rope) const;
  Vec3d attachment_force(int rope, int node) const;  ///< N on the body, over the last step
  int contact_count(int rope) const;
  std::span<const RopeCrossing> crossings() const { return touching_; }  ///< of the last step
  std::span<const RopeBreakEvent> breaks() const { return breaks_; }     ///< of the last step

  Vec3d momentum() const;                        ///< kg·m/s
  double kinetic_energy() const;                 ///< J
  double elastic_energy() const;                 ///< J
  double potential_energy(Vec3d gravity) const;  ///< J
  std::uint64_t state_hash() const;

 private:
  friend struct detail::RopeSolver;
  std::vector<detail::Rope> ropes_;
  std::vector<detail::RopeBody> bodies_, bodies_before_;
  std::vector<detail::RopeShape> shapes_;
  std::vector<detail::RopeMemory> memory_;
  std::vector<double> matrix_, right_;
  std::vector<int> first_block_;
  std::vector<rigid::ShapeId> found_, of_body_;
  std::vector<rigid::BodyId> fast_bodies_;
  std::vector<detail::FastShape> fast_;
  std::vector<rigid::JointId> joints_;
  std::vector<RopeBreakEvent> breaks_;
  std::vector<detail::RopeCross> crossings_, crossings_before_;
  std::vector<detail::RopeStretch> stretches_;
  std::vector<int> crossing_now_;
  std::vector<detail::RopeAnswer> crossing_answers_;
  std::vector<math::Mat3d> crossing_matrix_;
  std::vector<double> crossing_right_;
  std::vector<RopeCrossing> touching_;
  RopeAir air_{};
  int substeps_ = 8;
};

}  // namespace carom::particles
