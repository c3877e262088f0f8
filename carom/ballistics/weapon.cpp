#include "carom/ballistics/weapon.h"

#include "carom/core/string.h"

namespace carom::ballistics {
namespace {

constexpr double inch = 0.0254, grain = 0.45359237 / 7000;

struct Bound {
  std::string_view name;
  double value, least, most;
  std::string_view expected;
};
core::Status within(std::string_view what, std::span<const Bound> bounds) {
  for (const Bound& b : bounds)
    if (!(b.value >= b.least && b.value <= b.most))
      return core::Error{core::text(what, ": ", core::refused(b.name, b.value, b.expected))};
  return {};
}

}  // namespace

core::Status check(const Ammunition& a) {
  const Bound bounds[] = {
      {"area_per_mass", a.projectile.area_per_mass, 0, 1e4, "0 to 10^4 m²/kg"},
      {"mass", a.mass, 1e-6, 1e5, "10^-6 to 10^5 kg"},
      {"diameter", a.diameter, 1e-4, 10, "10^-4 to 10 m"},
      {"length", a.length, 0, 100, "0 to 100 m"},
      {"muzzle_speed", a.muzzle_speed, 0.1, 1e4, "0.1 to 10^4 m/s"},
      {"speed_deviation", a.speed_deviation, 0, 1e3, "0 to 1000 m/s"},
      {"powder_mass", a.powder_mass, 0, 1e5, "0 to 10^5 kg"},
      {"gas_speed", a.gas_speed, 0, 1e4, "0 to 10^4 m/s"},
  };
  if (a.shell)
    if (auto s = check(*a.shell); !s) return core::Error{core::text("ammunition: ", s.error().message)};
  return within("ammunition", bounds);
}
core::Status check(const Sight& s) {
  const Bound bounds[] = {
      {"height", s.height, -1, 10, "-1 to 10 m"},
      {"offset", s.offset, -1, 1, "-1 to 1 m"},
      {"parallax_free", s.parallax_free, 0, 1e5, "0 to 10^5 m"},
      {"click", s.click, 1e-9, 0.1, "10^-9 to 0.1 rad"},
      {"spacing", s.spacing, 0, 1, "0 to 1 rad"},
      {"magnification", s.magnification, 0.1, 1000, "0.1 to 1000"},
  };
  return within("a sight", bounds);
}
core::Status check(const Weapon& w) {
  if (auto s = check(w.ammunition); !s) return s;
  if (auto s = check(w.sight); !s) return s;
  const Bound bounds[] = {
      {"mass", w.mass, 1e-3, 1e7, "10^-3 to 10^7 kg"},
      {"muzzle_speed", w.muzzle_speed, 0, 1e4, "0 to 10^4 m/s"},
      {"twist", w.twist, -1e3, 1e3, "-1000 to 1000 m"},
      {"zero", w.zero, 1, 1e5, "1 to 10^5 m"},
      {"dispersion", w.dispersion, 0, 1, "0 to 1 rad"},
      {"rounds_per_minute", w.rounds_per_minute, 1e-3, 1e5, "10^-3 to 10^5"},
      {"mount.mass", w.mount.mass, 1e-3, 1e7, "10^-3 to 10^7 kg"},
      {"mount.inertia", w.mount.inertia, 1e-6, 1e9, "10^-6 to 10^9 kg·m²"},
      {"mount.bore_above_shoulder", w.mount.bore_above_shoulder, -10, 10, "-10 to 10 m"},
      {"mount.bore_beside_shoulder", w.mount.bore_beside_shoulder, -10, 10, "-10 to 10 m"},
      {"mount.push_frequency", w.mount.push_frequency, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"mount.push_damping", w.mount.push_damping, 0, 100, "0 to 100"},
      {"mount.rise_frequency", w.mount.rise_frequency, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"mount.rise_damping", w.mount.rise_damping, 0, 100, "0 to 100"},
      {"mount.swing_frequency", w.mount.swing_frequency, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"mount.swing_damping", w.mount.swing_damping, 0, 100, "0 to 100"},
      {"mount.roll_inertia", w.mount.roll_inertia, 1e-6, 1e9, "10^-6 to 10^9 kg·m²"},
      {"mount.lift_frequency", w.mount.lift_frequency, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"mount.lift_damping", w.mount.lift_damping, 0, 100, "0 to 100"},
      {"mount.slide_frequency", w.mount.slide_frequency, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"mount.slide_damping", w.mount.slide_damping, 0, 100, "0 to 100"},
      {"mount.roll_frequency", w.mount.roll_frequency, 1e-3, 1e3, "10^-3 to 1000 Hz"},
      {"mount.roll_damping", w.mount.roll_damping, 0, 100, "0 to 100"},
  };
  if (auto s = within("a gun", bounds); !s) return s;
  if (auto s = check(w.mount); !s) return core::Error{core::text("a gun: mount.", s.error().message)};
  return {};
}

Gun gun_of(const Weapon& w) {
  const Ammunition& a = w.ammunition;
  Gun gun{.projectile = a.projectile,
          .mass = a.mass,
          .muzzle_speed = w.muzzle_speed > 0 ? w.muzzle_speed : a.muzzle_speed,
          .sight_height = w.sight.height,
          .sight_offset = w.sight.offset};
  if (a.length > 0 && w.twist != 0) {
    gun.shape = BulletShape{a.mass / grain, a.diameter / inch, a.length / inch};
    gun.twist = w.twist / inch;
  }
  return gun;
}
double spin_of(const Weapon& w, double speed) {
  if (w.twist != 0) return 2 * math::pi * speed / w.twist;
  return w.ammunition.shell ? muzzle_spin(*w.ammunition.shell, speed) : 0;
}
Charge charge_of(const Weapon& w) {
  return {.bullet_mass = w.ammunition.mass,
          .muzzle_speed = gun_of(w).muzzle_speed,
          .powder_mass = w.ammunition.powder_mass,
          .gas_speed = w.ammunition.gas_speed};
}
FreeRecoil free_recoil(const Weapon& w) { return free_recoil(charge_of(w), w.mass); }
Penetrator penetrator_of(const Weapon& w, double speed) {
  return {.mass = w.ammunition.mass, .area = math::pi / 4 * math::square(w.ammunition.diameter), .speed = speed};
}
ShotVariation variation_of(const Weapon& w, double aim) {
  return {.muzzle_speed = w.ammunition.speed_deviation, .aim = math::hypot(w.dispersion, aim)};
}

core::Result<Aiming> zeroed(const Weapon& w, const Conditions& conditions) {
  if (auto s = check(w); !s) return s.error();
  return zero_aiming(gun_of(w), conditions, w.zero);
}

math::Vec2d parallax_of(const Sight& sight, math::Vec2d eye, double distance) {
  if (!(sight.parallax_free > 0) || !(distance > 0)) return {};
  return parallax_turn(1, distance, sight.parallax_free, sight.magnification) * eye;
}

Aiming turned(const Aiming& aiming, const Sight& sight, int up, int right) {
  Aiming out = aiming;
  out.elevation += up * sight.click;
  out.windage += right * sight.click;
  return out;
}

core::Result<Dial> dial(const Weapon& w, const Conditions& conditions, double distance) {
  const auto aiming = zeroed(w, conditions);
  if (!aiming) return aiming.error();
  if (!(distance > 0) || !math::is_finite(distance))
    return core::Error{core::refused("dial: distance", distance, "a finite number of m > 0")};
  const auto flight = SightedFlight::fire(gun_of(w), conditions, *aiming, 1.02 * distance + 1);
  if (!flight) return flight.error();
  const auto point = flight->at(distance);
  if (!point) return core::Error{core::text("dial: the shot does not get ", distance, " m far")};
  Dial d{.up = clicks(point->hold_up, w.sight.click),
         .right = clicks(point->hold_right, w.sight.click),
         .hold_up = point->hold_up,
         .hold_right = point->hold_right};
  if (w.sight.spacing > 0)
    d.marks_up = point->hold_up / w.sight.spacing, d.marks_right = point->hold_right / w.sight.spacing;
  return d;
}

}  // namespace carom::ballistics
