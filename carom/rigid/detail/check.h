// Limits of what a world accepts, and the checks that its public functions share.
#pragma once

#include "carom/rigid/detail/joint_check.h"
#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

// Beyond these nothing physical lies, and nothing within them overflows a float on the way through a step.
inline constexpr double max_coordinate = 1e12;  ///< m
inline constexpr double max_velocity = 1e6;     ///< m/s, rad/s
inline constexpr double max_size = 1e6;         ///< m, of a moving shape
inline constexpr double max_density = 1e9;      ///< kg/m³
inline constexpr double max_body_mass = 1e15;   ///< kg
inline constexpr double max_force = 1e18;       ///< N, N·m, N·s

/// `axis` is appended to the field's name; the sentence is only made when something is wrong with the number.
inline void check_range(Complaint& c, std::string_view field, double x, double low, double high,
                        std::string_view axis = {}) {
  if (!(x >= low && x <= high))
    c.say(core::refused(core::text(field, axis), x, core::text("a number from ", low, " to ", high)));
}
template <class T>
void check_size(Complaint& c, std::string_view field, Vec2<T> v, double limit) {
  check_range(c, field, double(v.x), -limit, limit, ".x");
  check_range(c, field, double(v.y), -limit, limit, ".y");
}
template <class T>
void check_size(Complaint& c, std::string_view field, Vec3<T> v, double limit) {
  check_range(c, field, double(v.x), -limit, limit, ".x");
  check_range(c, field, double(v.y), -limit, limit, ".y");
  check_range(c, field, double(v.z), -limit, limit, ".z");
}
inline void check_size(Complaint& c, std::string_view field, float x, double limit) {
  check_range(c, field, double(x), -limit, limit);
}
inline void check_material(Complaint& c, std::string_view field, const Material& m) {
  check_range(c, field, m.friction, 0, 1e6, ".friction");
  check_range(c, field, m.restitution, 0, 1, ".restitution");
  check_range(c, field, m.rolling_resistance, 0, 1e6, ".rolling_resistance");
  check_range(c, field, m.spinning_resistance, 0, 1e6, ".spinning_resistance");
  check_range(c, field, m.tangent_speed, -max_velocity, max_velocity, ".tangent_speed");
}

}  // namespace carom::rigid::detail
