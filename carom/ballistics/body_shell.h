// A spinning shell as a body of a world: the model of shell.h flies it until it touches something.
#pragma once

#include <memory>
#include <string>

#include "carom/ballistics/shell.h"
#include "carom/rigid/world.h"

namespace carom::ballistics {

struct BodyShellDef {
  Shell shell{};
  ShellModel model = ShellModel::modified_point_mass;
  /// With all of its gravity: the body feels none of the world's while it flies. What effectors do to it acts beside.
  Conditions conditions{};
  /// The world's Surroundings turn its frame by `conditions.rotation` already: the body is kept from feeling that
  /// twice.
  bool world_turns = false;
  FlightPoint start{};  ///< of the centre of mass; the nose points along the velocity
  math::Vec3d tip{};    ///< rad/s, its first transverse angular velocity in six degrees of freedom
  double spin = 0;      ///< rad/s; 0: that of the barrel at the speed of `start`
  double fired_at = 0;  ///< s of the world's time; until then it is disabled
  bool sticks = false;  ///< it stays where it first touches something, as in soft ground
  /// Material and filter of its shape.
  rigid::ShapeDef<rigid::Dim3> shape{};
  std::string name = "shell";
};

/// Where a shell first touched something.
struct ShellImpact {
  double time = 0;         ///< s of the world's time
  math::Vec3d point{};     ///< m
  math::Vec3d velocity{};  ///< m/s, just before
  double spin = 0;         ///< rad/s
};

/// Its body has the x axis forward, out of the nose, and the origin in the centre of mass. While it flies, place,
/// velocity, axis and spin are those of the model, which takes them on in double from step to step; the body goes where
/// they go, its own velocity being the mean over the step, and does not roll: a world slows what turns by more than
/// 2.5 rad in a substep. What pushes or turns it besides is taken over into the model. From the first touch on it is a
/// rigid body like others (or stands fast), with its spin, the world's gravity, and the drag of a cylinder. Copy it
/// with a snapshot of the world, and restore both.
class CAROM_API BodyShell {
 public:
  /// Makes the body. Errors: what fly_shell and the world refuse.
  static core::Result<BodyShell> make(rigid::World3& world, const BodyShellDef& definition);
  /// Other air, wind and gravity from now on.
  void set_conditions(const Conditions& conditions);
  /// Before each step of `dt` s.
  core::Status before_step(rigid::World3& world, double dt);

  rigid::BodyId body() const { return body_; }
  const BodyShellDef& definition() const { return *definition_; }
  bool waits() const { return phase_ == Phase::waits; }
  bool flies() const { return phase_ == Phase::flies; }
  /// At the end of the last step, or as it left the model.
  const ShellMotion& motion() const { return motion_; }
  double yaw() const { return yaw_; }              ///< rad, likewise, of the axis to the way through the air
  double stability() const { return stability_; }  ///< S_g, likewise
  const ShellImpact* impact() const { return phase_ == Phase::landed ? &impact_ : nullptr; }

 private:
  enum class Phase { waits, flies, landed };
  bool touches(const rigid::World3& world, math::Vec3d& point);
  void take_over(const rigid::BodyState<rigid::Dim3>& state);
  core::Status land(rigid::World3& world, const rigid::BodyState<rigid::Dim3>& state, math::Vec3d point);
  core::Status lead(rigid::World3& world, const rigid::BodyState<rigid::Dim3>& state, double dt);

  std::shared_ptr<const BodyShellDef> definition_;
  rigid::BodyId body_{};
  Phase phase_ = Phase::waits;
  ShellMotion motion_{};
  math::Vec3d from_{}, way_{};                   // m: of the last step, as it was meant
  double step_ = 0;                              // s, of the last step; 0: none yet
  math::Vec3f given_velocity_{}, given_turn_{};  // what the body was given for it
  double stopped_at_ = -1;                       // s, when the world held it at a surface; < 0: it did not
  double yaw_ = 0, stability_ = 0;
  ShellImpact impact_{};
};

}  // namespace carom::ballistics
