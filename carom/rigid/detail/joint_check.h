// What may be said of a joint, and what not. Each check ends in a sentence "World::create_joint: … is …, expected …".
#pragma once

#include <string>

#include "carom/core/result.h"
#include "carom/core/string.h"
#include "carom/rigid/state.h"

namespace carom::rigid::detail {

/// Gathers the first complaint about a call.
class Complaint {
 public:
  explicit Complaint(std::string_view call) : call_(call) {}
  Complaint(std::string_view type, std::string_view call) : type_(type), call_(call) {}
  bool none_yet() const { return message_.empty(); }
  void say(const std::string& sentence) {
    if (message_.empty()) message_ = core::text(type_, call_, ": ", sentence);
  }
  void finite(std::string_view field, double x, std::string_view axis = {}) {
    if (!is_finite(x)) say(core::refused(core::text(field, axis), x, "a finite number"));
  }
  void not_negative(std::string_view field, double x) {
    if (!(is_finite(x) && x >= 0)) say(core::refused(field, x, "a finite number ≥ 0"));
  }
  void positive(std::string_view field, double x) {
    if (!(is_finite(x) && x > 0)) say(core::refused(field, x, "a finite number > 0"));
  }
  template <class T>
  void vector(std::string_view field, Vec2<T> v) {
    finite(field, v.x, ".x");
    finite(field, v.y, ".y");
  }
  template <class T>
  void vector(std::string_view field, Vec3<T> v) {
    finite(field, v.x, ".x");
    finite(field, v.y, ".y");
    finite(field, v.z, ".z");
  }
  void rotation(std::string_view field, Rot2f q) { unit(field, math::sqrt(q.c * q.c + q.s * q.s)); }
  void rotation(std::string_view field, const Quatf& q) { unit(field, math::length(q)); }
  void status(const core::Status& s) {
    if (!s.ok()) say(s.error().message);
  }

  void spring(std::string_view field, const JointSpring& s) {
    not_negative(core::text(field, ".hertz"), s.hertz);
    not_negative(core::text(field, ".damping_ratio"), s.damping_ratio);
  }
  void limit(std::string_view field, const JointLimit& l) {
    finite(core::text(field, ".lower"), l.lower);
    finite(core::text(field, ".upper"), l.upper);
    if (none_yet() && l.lower > l.upper)
      say(core::text(field, ".lower is ", l.lower, ", expected at most ", field, ".upper, which is ", l.upper));
  }
  void angle_limit(std::string_view field, const JointLimit& l) {
    limit(field, l);
    if (none_yet() && !(l.lower >= -2 * pi_f && l.upper <= 2 * pi_f && l.upper - l.lower <= 2 * pi_f))
      say(core::text(field, " is ", l.lower, " … ", l.upper, " rad, expected a range of at most one turn within ±2π"));
  }
  void distance_limit(std::string_view field, const JointLimit& l) {
    limit(field, l);
    if (none_yet() && l.enabled && l.lower < 0) say(core::refused(core::text(field, ".lower"), l.lower, "≥ 0 m"));
  }
  void motor(std::string_view field, const JointMotor& m) {
    finite(core::text(field, ".speed"), m.speed);
    not_negative(core::text(field, ".max_force"), m.max_force);
  }
  void cone_angle(std::string_view field, float x, bool in_plane) {
    finite(field, x);
    if (x > pi_f) say(core::refused(field, x, "at most π rad"));
    if (in_plane && x >= 0) say(core::refused(field, x, "none (−1) in the plane: use twist"));
  }
  void not_zero(std::string_view field, double x) {
    if (!is_finite(x) || x == 0) say(core::refused(field, x, "a finite number other than 0"));
  }
  void axis(std::string_view field, const JointAxis& a, bool angular) {
    const std::string limits = core::text(field, ".limit");
    if (angular)
      angle_limit(limits, a.limit);
    else
      limit(limits, a.limit);
    spring(core::text(field, ".spring"), a.spring);
    finite(core::text(field, ".target"), a.target);
    not_negative(core::text(field, ".max_spring_force"), a.max_spring_force);
    motor(core::text(field, ".motor"), a.motor);
    not_negative(core::text(field, ".friction"), a.friction);
  }
  core::Error error() const { return core::Error{message_}; }

 private:
  void unit(std::string_view field, float norm) {
    if (!(norm > 0.99f && norm < 1.01f)) say(core::text(field, " has norm ", norm, ", expected a rotation (norm 1)"));
  }
  std::string_view type_{}, call_;
  std::string message_;
};

template <class D>
void check_path(Complaint& c, const PathJointDef<D>& d) {
  const std::size_t n = d.points.size(), least = d.closed ? 3 : 2;
  if (n < least) return c.say(core::text("points holds ", n, ", expected at least ", least));
  if (!d.tangents.empty() && d.tangents.size() != n)
    return c.say(core::text("tangents holds ", d.tangents.size(), ", expected one for each of the ", n, " points"));
  if (d.straight && !d.tangents.empty()) return c.say("tangents are given, expected none where straight is set");
  for (std::size_t i = 0; i < n; ++i) {
    c.vector(core::text("points[", i, "]"), d.points[i]);
    if (!d.tangents.empty()) c.vector(core::text("tangents[", i, "]"), d.tangents[i]);
  }
  if (!c.none_yet()) return;
  for (std::size_t i = 0; i < n; ++i) {
    const std::size_t next = (i + 1) % n;
    if ((next != 0 || d.closed) && !(math::distance(d.points[i], d.points[next]) > 1e-5f))
      return c.say(core::text("points[", i, "] and points[", next, "] are the same, expected them apart"));
    if (!d.tangents.empty() && !(math::length(d.tangents[i]) > 1e-5f))
      return c.say(core::text("tangents[", i, "] is zero, expected a direction"));
  }
  c.not_negative("friction", d.friction);
  c.limit("limit", d.limit);
  if (d.closed && d.limit.enabled) c.say("limit is enabled, expected none on a closed path");
}

/// What all definitions have under the same name is checked once; the rest by type.
template <class D, class Def>
void check_joint(Complaint& c, const Def& d) {
  constexpr bool distance = std::is_same_v<Def, DistanceJointDef<D>>, ball = std::is_same_v<Def, BallJointDef<D>>;
  if constexpr (requires { d.spring.hertz; }) c.spring("spring", d.spring);
  if constexpr (requires { d.linear.hertz; }) c.spring("linear", d.linear);
  if constexpr (requires { d.angular.hertz; }) c.spring("angular", d.angular);
  if constexpr (requires { d.motor; }) c.motor("motor", d.motor);
  if constexpr (requires { d.max_force; }) c.not_negative("max_force", d.max_force);
  if constexpr (requires { d.max_torque; }) c.not_negative("max_torque", d.max_torque);
  if constexpr (requires { d.target; }) c.vector("target", d.target);
  if constexpr (requires { d.target_angle; }) c.finite("target_angle", d.target_angle);
  if constexpr (requires { d.target_translation; }) c.finite("target_translation", d.target_translation);
  if constexpr (requires { d.target_rotation; }) c.rotation("target_rotation", d.target_rotation);
  if constexpr (requires { d.target_position; }) check_size(c, "target_position", d.target_position, 1e6);
  if constexpr (requires { d.target_velocity; }) check_size(c, "target_velocity", d.target_velocity, 1e6);
  if constexpr (requires { d.target_spin; }) check_size(c, "target_spin", d.target_spin, 1e6);
  if constexpr (requires { d.max_spring_force; }) c.not_negative("max_spring_force", d.max_spring_force);
  if constexpr (requires { d.max_spring_torque; }) c.not_negative("max_spring_torque", d.max_spring_torque);
  if constexpr (requires { d.target_distance; }) c.finite("target_distance", d.target_distance);
  if constexpr (requires { d.length; }) c.not_negative("length", d.length);
  if constexpr (distance)
    c.distance_limit("limit", d.limit);
  else if constexpr (std::is_same_v<Def, HingeJointDef<D>>)
    c.angle_limit("limit", d.limit);
  else if constexpr (std::is_same_v<Def, SliderJointDef<D>>)
    c.limit("limit", d.limit);
  else if constexpr (ball) {
    c.cone_angle("cone_angle", d.cone_angle, D::dimension == 2);
    c.angle_limit("twist", d.twist);
    c.not_negative("friction_torque", d.friction_torque);
  } else if constexpr (std::is_same_v<Def, GenericJointDef<D>>) {
    for (int i = 0; i < D::dimension; ++i) c.axis(core::text("linear[", i, "]"), d.linear[i], false);
    for (int i = 0; i < (D::dimension == 2 ? 1 : 3); ++i) c.axis(core::text("angular[", i, "]"), d.angular[i], true);
  } else if constexpr (std::is_same_v<Def, GearJointDef<D>>) {
    c.not_zero("ratio", d.ratio);
  } else if constexpr (std::is_same_v<Def, RackJointDef<D>>) {
    c.not_zero("radius", d.radius);
  } else if constexpr (std::is_same_v<Def, ScrewJointDef<D>>) {
    c.not_zero("pitch", d.pitch);
    if (D::dimension == 2) c.say("a screw joint is for space, expected another type in the plane");
  } else if constexpr (std::is_same_v<Def, PathJointDef<D>>) {
    check_path<D>(c, d);
  } else if constexpr (std::is_same_v<Def, PulleyJointDef<D>>) {
    c.vector("ground_a", d.ground_a);
    c.vector("ground_b", d.ground_b);
    c.positive("ratio", d.ratio);
  }
}

/// q of unit length. What is so already, to rounding, keeps its bits: a world that is saved and loaded stays the same.
inline Rot2f unit_rotation(Rot2f q) { return abs(q.c * q.c + q.s * q.s - 1) < 1e-6f ? q : normalize(q); }
inline Quatf unit_rotation(const Quatf& q) { return abs(dot(q, q) - 1) < 1e-6f ? q : normalize(q); }

}  // namespace carom::rigid::detail
