// Every number of a gun as scenes and presets name it.
#pragma once

#include "carom/ballistics/weapon.h"

namespace carom::scene::detail {

/// Calls number(name, unit, value) for each; what the value is when it is called is the default. A swing is a rise
/// unless it is given, so it comes later.
template <class Visitor>
void visit_numbers(ballistics::Weapon& w, Visitor&& number) {
  number("mass", "kg", w.mass);
  number("muzzle_speed", "m/s", w.muzzle_speed);
  number("twist", "m", w.twist);
  number("zero", "m", w.zero);
  number("dispersion", "rad", w.dispersion);
  number("rounds_per_minute", "", w.rounds_per_minute);
  ballistics::GunMount& m = w.mount;
  number("mount_mass", "kg", m.mass);
  number("mount_inertia", "kg*m^2", m.inertia);
  number("mount_bore_above_shoulder", "m", m.bore_above_shoulder);
  number("mount_bore_beside_shoulder", "m", m.bore_beside_shoulder);
  number("mount_push_frequency", "Hz", m.push_frequency);
  number("mount_push_damping", "", m.push_damping);
  number("mount_rise_frequency", "Hz", m.rise_frequency);
  number("mount_rise_damping", "", m.rise_damping);
  m.swing_frequency = m.rise_frequency;
  m.swing_damping = m.rise_damping;
  number("mount_swing_frequency", "Hz", m.swing_frequency);
  number("mount_swing_damping", "", m.swing_damping);
  number("mount_roll_inertia", "kg*m^2", m.roll_inertia);
  number("mount_centre_ahead", "m", m.centre_of_mass.x);
  number("mount_centre_above", "m", m.centre_of_mass.y);
  number("mount_centre_beside", "m", m.centre_of_mass.z);
  number("mount_lift_frequency", "Hz", m.lift_frequency);
  number("mount_lift_damping", "", m.lift_damping);
  number("mount_slide_frequency", "Hz", m.slide_frequency);
  number("mount_slide_damping", "", m.slide_damping);
  number("mount_roll_frequency", "Hz", m.roll_frequency);
  number("mount_roll_damping", "", m.roll_damping);
}

}  // namespace carom::scene::detail
