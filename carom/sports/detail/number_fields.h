// Every number of a ball, a surface, a club head and of how games are played once: its name and unit in files, and what
// it may be.
#pragma once

#include <vector>

#include "carom/core/string.h"
#include "carom/sports/baseball.h"
#include "carom/sports/bounce.h"
#include "carom/sports/bowling.h"
#include "carom/sports/cricket.h"
#include "carom/sports/golf_impact.h"
#include "carom/sports/numbers.h"

namespace carom::sports::detail {

/// `B` is Ball or const Ball, and so on.
template <class B, class Visitor>
  requires std::is_same_v<std::remove_const_t<B>, Ball>
void visit_fields(B& b, Visitor&& field) {
  field("mass", "kg", b.mass, 1e-6, 1e6);
  field("radius", "m", b.radius, 1e-5, 1e3);
  field("inertia_factor", "", b.inertia_factor, 1e-3, 2.0 / 3 + 1e-9);
  field("drag", "", b.drag.fast, 0.0, 1e4);
  field("drag_crisis", "", b.drag.crisis, 0.0, 1e4);
  field("critical_reynolds", "", b.drag.critical_reynolds, 1.0, 1e9);
  field("crisis_steepness", "", b.drag.steepness, 0.0, 100.0);
  field("drag_spin_rise", "", b.drag.spin_rise, 0.0, 10.0);
  field("drag_spin_scale", "", b.drag.spin_scale, 1e-3, 100.0);
  field("drag_spin_slope", "", b.drag.spin_slope, 0.0, 10.0);
  field("lift", "", b.lift.maximum, -10.0, 10.0);
  field("lift_spin_scale", "", b.lift.spin_scale, 1e-3, 100.0);
  field("lift_fade", "", b.lift.fade, 0.0, 1.0);
  field("spin_damping", "", b.spin_damping, 0.0, 10.0);
  field("side_force", "", b.side.coefficient, -10.0, 10.0);
  field("seam_best_angle", "rad", b.side.best_angle, 1e-3, 1.6);
  field("seam_reverse_reynolds", "", b.side.reverse_reynolds, 0.0, 1e9);
  field("seam_cycles", "", b.side.cycles, 0.0, 1000.0);
  field("wake_strouhal", "", b.side.strouhal, 0.0, 100.0);
}

template <class S, class Visitor>
  requires std::is_same_v<std::remove_const_t<S>, Surface>
void visit_fields(S& s, Visitor&& field) {
  field("friction", "", s.friction, 0.0, 100.0);
  field("restitution", "", s.restitution, 0.0, 1.0);
  field("restitution_slope", "s/m", s.restitution_slope, 0.0, 1e3);
  field("restitution_curve", "s^2/m^2", s.restitution_curve, 0.0, 1e3);
  field("restitution_floor", "", s.restitution_floor, 0.0, 1.0);
  field("restitution_speed", "m/s", s.restitution_speed, 0.0, 1e300);
  field("tangential_restitution", "", s.tangential_restitution, -1.0, 1.0);
  field("tilt", "rad", s.tilt, 0.0, 1.5);
  field("tilt_speed", "m/s", s.tilt_speed, 1e-3, 1e6);
  field("tilt_angle", "rad", s.tilt_angle, 1e-3, 1.6);
  field("rolling", "", s.rolling, 1e-6, 100.0);
}

template <class H, class Visitor>
  requires std::is_same_v<std::remove_const_t<H>, ClubHead>
void visit_fields(H& h, Visitor&& field) {
  field("mass", "kg", h.mass, 1e-4, 100.0);
  field("inertia_roll", "kg*m^2", h.inertia.x, 1e-9, 100.0);
  field("inertia_yaw", "kg*m^2", h.inertia.y, 1e-9, 100.0);
  field("inertia_pitch", "kg*m^2", h.inertia.z, 1e-9, 100.0);
  field("depth", "m", h.depth, 0.0, 1.0);
  field("loft", "rad", h.loft, -1.5, 1.5);
  field("restitution", "", h.restitution, 0.0, 1.0);
  field("tangential_restitution", "", h.tangential_restitution, -1.0, 1.0);
  field("friction", "", h.friction, 0.0, 100.0);
  field("bulge", "1/m", h.bulge, -100.0, 100.0);
  field("roll", "1/m", h.roll, -100.0, 100.0);
}

template <class P, class Visitor>
  requires std::is_same_v<std::remove_const_t<P>, Pitch>
void visit_fields(P& p, Visitor&& field) {
  field("speed", "m/s", p.speed, 0.1, 1e3);
  field("elevation", "rad", p.elevation, -1.5, 1.5);
  field("azimuth", "rad", p.azimuth, -1.5, 1.5);
  field("spin", "rad/s", p.spin, -1e4, 1e4);
  field("tilt", "rad", p.tilt, -7.0, 7.0);
  field("gyro", "rad/s", p.gyro, -1e4, 1e4);
  field("release_height", "m", p.release.y, 0.0, 10.0);
  field("release_side", "m", p.release.z, -10.0, 10.0);
}

template <class B, class Visitor>
  requires std::is_same_v<std::remove_const_t<B>, Bat>
void visit_fields(B& b, Visitor&& field) {
  field("effective_mass", "kg", b.effective_mass, 1e-3, 100.0);
  field("radius", "m", b.radius, 1e-4, 1.0);
  field("restitution", "", b.restitution, 0.0, 1.0);
  field("friction", "", b.friction, 0.0, 100.0);
  field("tangential_restitution", "", b.tangential_restitution, -1.0, 1.0);
}

template <class C, class Visitor>
  requires std::is_same_v<std::remove_const_t<C>, CricketDelivery>
void visit_fields(C& c, Visitor&& field) {
  field("speed", "m/s", c.speed, 1.0, 1e3);
  field("elevation", "rad", c.elevation, -1.5, 1.5);
  field("azimuth", "rad", c.azimuth, -1.5, 1.5);
  field("spin", "rad/s", c.spin, -1e4, 1e4);
  field("tilt", "rad", c.tilt, -7.0, 7.0);
  field("gyro", "rad/s", c.gyro, -1e4, 1e4);
  field("seam", "rad", c.seam, -1.5, 1.5);
  field("height", "m", c.height, 0.1, 10.0);
  field("side", "m", c.side, -10.0, 10.0);
}

template <class B, class Visitor>
  requires std::is_same_v<std::remove_const_t<B>, BowlingBall>
void visit_fields(B& b, Visitor&& field) {
  field("mass", "kg", b.mass, 1e-3, 1e3);
  field("radius", "m", b.radius, 1e-3, 10.0);
  field("gyration", "m", b.gyration, 1e-4, 10.0);
  field("differential", "m", b.differential, 0.0, 1.0);
  field("cover", "", b.cover, 0.0, 10.0);
}

template <class L, class Visitor>
  requires std::is_same_v<std::remove_const_t<L>, Lane>
void visit_fields(L& l, Visitor&& field) {
  field("length", "m", l.length, 1e-3, 1e4);
  field("width", "m", l.width, 1e-3, 1e4);
  field("gravity", "m/s^2", l.gravity, 1e-6, 1e4);
}

template <class D, class Visitor>
  requires std::is_same_v<std::remove_const_t<D>, Delivery>
void visit_fields(D& d, Visitor&& field) {
  field("speed", "m/s", d.speed, 1e-3, 1e3);
  field("angle", "rad", d.angle, -1.5, 1.5);
  field("spin", "rad/s", d.spin, -1e4, 1e4);
  field("axis_rotation", "rad", d.axis_rotation, -7.0, 7.0);
  field("start", "m", d.start, -1e3, 1e3);
}

template <class T>
core::Status check_fields(const T& thing, std::string_view what) {
  core::Status status;
  visit_fields(thing, [&](const char* name, const char* unit, double value, double low, double high) {
    if (status.ok() && !(value >= low && value <= high))
      status = core::Error{core::text(name, " of ", what, " is ", value, ", expected a number in [", low, ", ", high,
                                      "]", *unit != 0 ? " " : "", unit)};
  });
  return status;
}

template <class T>
std::vector<double> numbers_of(const T& thing) {
  std::vector<double> values;
  visit_fields(thing, [&](const char*, const char*, double value, double, double) { values.push_back(value); });
  return values;
}

template <class T>
std::span<const NumberName> number_names_of() {
  static const std::vector<NumberName> names = [] {
    std::vector<NumberName> list;
    const T thing{};
    visit_fields(thing,
                 [&](const char* name, const char* unit, double, double, double) { list.push_back({name, unit}); });
    return list;
  }();
  return names;
}

/// Puts the named numbers into `thing`. Errors: a name it does not have, or one that comes twice.
template <class T>
core::Status take_numbers(T& thing, std::span<const Number> numbers, std::string_view what) {
  std::vector<bool> used(numbers.size(), false);
  core::Status status;
  visit_fields(thing, [&](const char* name, const char*, double& value, double, double) {
    bool seen = false;
    for (std::size_t i = 0; i < numbers.size(); ++i) {
      if (numbers[i].name != name) continue;
      if (seen && status.ok()) status = core::Error{core::text(name, " of ", what, " is given twice")};
      value = numbers[i].value;
      used[i] = seen = true;
    }
  });
  for (std::size_t i = 0; i < numbers.size() && status.ok(); ++i)
    if (!used[i]) status = core::Error{core::text(what, " has no number ", core::quoted(numbers[i].name))};
  return status.ok() ? check_fields(thing, what) : status;
}

}  // namespace carom::sports::detail
