// A weapon as data: what it shoots, what it is aimed with, how it is held; and the models that follow from it
// (chapter 18). Files of such: presets/gun, presets/ammunition, presets/sight (carom/scene/weapon_presets.h).
#pragma once

#include "carom/ballistics/dispersion.h"
#include "carom/ballistics/penetration.h"
#include "carom/ballistics/recoil.h"
#include "carom/ballistics/shell.h"
#include "carom/ballistics/sights.h"

namespace carom::ballistics {

struct Ammunition {
  Projectile projectile{};
  double mass = 0.0109;          ///< kg, of the projectile
  double diameter = 0.00782;     ///< m
  double length = 0;             ///< m; 0: not told, then there is no spin drift
  double muzzle_speed = 808;     ///< m/s
  double speed_deviation = 0;    ///< m/s, standard deviation from shot to shot
  double powder_mass = 0;        ///< kg
  double gas_speed = 1585;       ///< m/s at which the gas leaves, see Charge
  std::optional<Shell> shell{};  ///< in a world its rounds spin and drift as this does; aiming takes the point mass
};

struct Sight {
  double height = 0.04;             ///< m, from the bore up to the line of sight
  double offset = 0;                ///< m, from the bore to the right to it
  double click = 0.25 * 2.9089e-4;  ///< rad, of a turret; > 0
  double spacing = 1e-3;            ///< rad between marks of the reticle; 0: it has none
  double magnification = 1;
  double parallax_free = 0;  ///< m; 0: not told, or it has no parallax
};

struct Weapon {
  Ammunition ammunition{};
  Sight sight{};
  double mass = 4;                 ///< kg, ready to fire
  double muzzle_speed = 0;         ///< m/s from this barrel; 0: that of the ammunition
  double twist = 0;                ///< m a turn, negative: left-hand; 0: smooth bore
  double zero = 100;               ///< m
  double dispersion = 0;           ///< rad, σ of each axis, gun and ammunition
  double rounds_per_minute = 600;  ///< of automatic fire, or as fast as it can be served
  GunMount mount{};
};

/// Errors name the field: not finite, or out of what can be.
CAROM_API core::Status check(const Ammunition& ammunition);
CAROM_API core::Status check(const Sight& sight);
CAROM_API core::Status check(const Weapon& weapon);

CAROM_API Gun gun_of(const Weapon& weapon);
/// rad/s that the barrel gives at a speed (m/s): by the weapon's twist, or, where that is 0, by that of the shell.
CAROM_API double spin_of(const Weapon& weapon, double speed);
CAROM_API Charge charge_of(const Weapon& weapon);
CAROM_API FreeRecoil free_recoil(const Weapon& weapon);
/// The bullet as it strikes with a speed (m/s).
CAROM_API Penetrator penetrator_of(const Weapon& weapon, double speed);
/// What varies from shot to shot, with the shooter's own wander `aim` (rad, σ of each axis).
CAROM_API ShotVariation variation_of(const Weapon& weapon, double aim = 0);
/// Set for its zero, up and aside. Errors: what cannot be; a zero out of reach.
CAROM_API core::Result<Aiming> zeroed(const Weapon& weapon, const Conditions& conditions = {});
/// With the sight turned by so many clicks: they move the strike up and to the right.
CAROM_API Aiming turned(const Aiming& aiming, const Sight& sight, int up, int right);
/// rad (x to the right, y up), by which the sight's axis points beside a mark at `distance` m that an eye off its axis
/// by `eye` (m, right and up) has the reticle on.
CAROM_API math::Vec2d parallax_of(const Sight& sight, math::Vec2d eye, double distance);
/// Turns of the sight, up and right, that put a shot at `distance` m on the mark. Errors as `zeroed`; out of reach.
struct Dial {
  int up = 0, right = 0;                 ///< clicks
  double hold_up = 0, hold_right = 0;    ///< rad
  double marks_up = 0, marks_right = 0;  ///< marks of the reticle, instead of clicks; 0 where it has none
};
CAROM_API core::Result<Dial> dial(const Weapon& weapon, const Conditions& conditions, double distance);

}  // namespace carom::ballistics
