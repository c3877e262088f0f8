// A rocket as a body of a world: the model of rocket.h gives its forces and its mass; rail, stages and parachute change
// as it flies.
#pragma once

#include <memory>
#include <span>
#include <string>

#include "carom/ballistics/rocket.h"
#include "carom/rigid/world.h"

namespace carom::ballistics {

namespace detail {
struct RocketRun;
}

struct BodyRocketDef {
  Rocket rocket{};
  /// Its uniform gravity must be the world's, which the world adds itself.
  Conditions conditions{};
  Launch launch{};   ///< `position`: where the tail stands
  double start = 0;  ///< s of the world's time, at which the launch begins
  /// Material and filter of its shapes. Without a group of their own its parts get one in which they do not collide.
  rigid::ShapeDef<rigid::Dim3> shape{};
  std::string name = "rocket";
};

/// Its body has the x axis forward, out of the nose, and the origin at the tail. Each step takes the model through it
/// in eight Runge–Kutta steps from where the body is, and gives the body what it needs to arrive with that velocity and
/// turning; the rail is a force that leaves it only the way along. What touches it acts besides. A stage that drops
/// becomes a body of its own with the drag of a cylinder across the air. A rocket hangs from its open parachute by the
/// nose. Copy it with a snapshot of the world, and restore both.
class CAROM_API BodyRocket {
 public:
  /// Makes the bodies. Errors: what fly_rocket and the world refuse.
  static core::Result<BodyRocket> make(rigid::World3& world, const BodyRocketDef& definition);
  /// Other air, wind and gravity from now on.
  void set_conditions(const Conditions& conditions);
  /// Before each step of `dt` s: forces, mass, and what drops.
  core::Status before_step(rigid::World3& world, double dt);

  rigid::BodyId body() const { return body_; }
  std::span<const rigid::BodyId> dropped() const { return dropped_; }  ///< bodies of the stages that are gone
  bool just_dropped() const { return just_dropped_; }                  ///< one of them, in the last before_step
  int stages_left() const { return int(stage_shapes_.size() - dropped_.size()); }
  bool on_rail() const { return on_rail_; }
  bool under_parachute() const { return under_parachute_; }
  double thrust() const { return thrust_; }  ///< N, at the beginning of the last step
  double mass() const { return mass_; }      ///< kg
  double apex() const { return apex_; }      ///< m: the most that its centre of mass rose above where it began

 private:
  struct Flight;  // what does not change
  core::Status drop(rigid::World3& world, const rigid::BodyState<rigid::Dim3>& state);
  core::Status set_mass(rigid::World3& world, double time);

  std::shared_ptr<const Flight> flight_;
  rigid::BodyId body_{};
  rigid::ShapeDef<rigid::Dim3> shape_{};
  std::vector<rigid::BodyId> dropped_;
  std::vector<std::vector<rigid::ShapeId>> stage_shapes_;
  bool on_rail_ = true, under_parachute_ = false, apex_passed_ = false;
  double deploy_at_ = -1;  // s; −1: not to be asked, 1e300: waits for the height
  double thrust_ = 0, mass_ = 0, inertia_ = 0, centre_ = 0, apex_ = 0, first_height_ = 0;
  bool just_dropped_ = false;
};

}  // namespace carom::ballistics
