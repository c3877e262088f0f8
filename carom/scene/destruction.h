// What a running scene has besides bodies and matter: charges that go off, guns that fire, structures that break,
// rockets and shells.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "carom/ballistics/aim.h"
#include "carom/ballistics/body_rocket.h"
#include "carom/ballistics/body_shell.h"
#include "carom/ballistics/hits.h"
#include "carom/ballistics/spinning_rounds.h"
#include "carom/ballistics/sway.h"
#include "carom/ballistics/weapon.h"
#include "carom/blast/matter.h"
#include "carom/blast/structure.h"
#include "carom/math/random.h"
#include "carom/scene/case_fragments.h"
#include "carom/scene/matter.h"

namespace carom::scene {

template <class D>
struct SceneExplosion {
  blast::Explosion<D> explosion;
  std::optional<CaseFragments> casing{};  ///< of space
  int reached = 0;                        ///< bodies that its front met so far
  math::Vec3d pushed{};                   ///< N·s, given to matter so far, particles aside
};

/// A gun of a scene as it was read.
struct GunDef {
  ballistics::Weapon weapon{};
  ballistics::Conditions conditions{};
  rigid::BodyId body{};                    ///< that carries it; null: it stands in the world
  math::Vec3d muzzle{};                    ///< m, of the body or of the world
  math::Vec3d bore{1, 0, 0};               ///< unit vector, of the body or of the world
  rigid::BodyId target{};                  ///< aimed at before each shot; null: it shoots along the bore
  bool high_arc = false;                   ///< at a target
  double start = 0;                        ///< s, of the first shot
  int rounds = 1;                          ///< how many it has
  double lifetime = 60;                    ///< s that a projectile flies at most
  bool climbs = false;                     ///< the mount's motion turns the bore from shot to shot
  std::vector<math::Vec2d> pattern{};      ///< rad, right and up: instead of that, of each shot; the last stays
  bool recoils = true;                     ///< its body takes the recoil
  std::uint64_t seed = 1;                  ///< of dispersion, muzzle speeds and sway
  std::optional<ballistics::Sway> sway{};  ///< of the hands that hold it; none: it stands still
  double breath_held = 0;                  ///< 0 … 1
};
struct SceneGun {
  SceneGun(const GunDef& definition, const ballistics::BatchRound& one)
      : definition(definition),
        round(one),
        batch(definition.weapon.ammunition.projectile.drag, definition.conditions),
        random(definition.seed),
        next(definition.start) {
    if (definition.sway) sway.emplace(*definition.sway, math::Random(definition.seed, 1).bits64());
    if (definition.weapon.ammunition.shell) spinning.emplace(*definition.weapon.ammunition.shell);
  }
  GunDef definition;
  ballistics::BatchRound round;
  ballistics::ProjectileBatch batch;
  math::Random random;
  std::optional<ballistics::SpinningRounds> spinning{};  ///< those of `batch`, where its ammunition spins
  std::optional<ballistics::SwayMotion> sway{};
  /// rad (x to the right, y up), by which the hands hold it beside its aim at a time (s) of the world: sway, and what
  /// its shots raised it by if it climbs or has a pattern.
  math::Vec2d swing(double time) const;
  double next = 0;  ///< s, the time of the next shot
  int shots = 0, hits = 0, passed = 0, ricochets = 0;
  bool no_solution = false;                ///< the target was out of reach when it last wanted to shoot
  std::vector<double> shot_times;          ///< s
  std::vector<ballistics::BatchHit> last;  ///< of the last step
  math::Vec3d last_hit{__builtin_nan(""), __builtin_nan(""), __builtin_nan("")};  ///< m
  double hit_speed = __builtin_nan("");                                           ///< m/s, of the last hit
  double energy = 0;                                                              ///< J, given up to what was hit
};

template <class D>
struct DestructionOf {
  std::vector<Named<SceneExplosion<D>>> explosions;
  std::vector<Named<SceneGun>> guns;
  std::vector<Named<blast::Structure<D>>> structures;
  std::vector<Named<ballistics::BodyRocket>> rockets;  ///< of space
  std::vector<Named<ballistics::BodyShell>> shells;    ///< of space
  ballistics::BatchHits<D> hits;                       ///< with what projectiles go through
  blast::FractureStepper<D> stepper;
};

/// Guns shoot at the beginning of the step in which their time falls; projectiles fly in the air of the environment, in
/// its steady wind by height and its turning frame, or in still air of the standard day, and are pulled along y as the
/// world's bodies are. Rockets and shells feel all of the environment's wind.
class CAROM_API Destruction {
 public:
  DestructionOf<rigid::Dim2> plane;
  DestructionOf<rigid::Dim3> space;
  template <class D>
  DestructionOf<D>& of() {
    if constexpr (D::dimension == 2)
      return plane;
    else
      return space;
  }
  template <class D>
  const DestructionOf<D>& of() const {
    return const_cast<Destruction*>(this)->of<D>();
  }

  /// Before a step of `dt` s: shots, and what blasts give to bodies and to `matter`, which may be null.
  template <class D>
  [[gnu::noinline]] Status before(rigid::World<D>& world, double dt, Matter* matter);
  /// In place of World::step: with breaking in it.
  template <class D>
  [[gnu::noinline]] Status step(rigid::World<D>& world, double dt);
  /// After it: projectiles fly and hit.
  template <class D>
  [[gnu::noinline]] Status after(rigid::World<D>& world, double dt);
  void add_to(core::StateHash& hash) const;

  /// What a quantity such as "gun.turret.hits" names; false where it names nothing here.
  bool find(std::string_view text, int dimension, Probe::Source& source, std::string_view& unit) const;
  double read(const Probe::Source& source, double time) const;
  /// The names that quantities begin with: "explosion.charge", "gun.turret", "structure.wall", "rocket.alpha",
  /// "shell.right".
  std::vector<std::string> names() const;
};

}  // namespace carom::scene
