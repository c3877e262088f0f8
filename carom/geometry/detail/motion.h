// A sweep in double, and how fast its points can come nearer along a direction: what conservative advancement asks
// (Mirtich 1996; the directional bound of Zhang et al. 2006).
#pragma once

#include "carom/geometry/query.h"

namespace carom::geometry::detail {

inline Transform2f in_float(const Transform2d& t) { return {Vec2f(t.p), Rot2f(t.q)}; }
inline Transform3f in_float(const Transform3d& t) { return {Vec3f(t.p), Quatf(t.q)}; }

/// The middle of a shape that is swept, and the farthest that a point of its core lies from there.
template <class V>
struct Swept {
  V arm{};  ///< from the centre of rotation, in the frame of what moves
  double reach = 0;
};

struct Motion2 {
  Vec2d local_center, c0, way;
  Rot2d q0, q1;
  double least_rate = 0, most_rate = 0;  ///< rad a unit of time, signed alike
  double sagitta = 0;                    ///< of the arc of a point 1 m from the centre, over its chord

  explicit Motion2(const Sweep2& s)
      : local_center(s.local_center),
        c0(s.c0),
        way(Vec2d(s.c1) - Vec2d(s.c0)),
        q0(normalize(Rot2d(s.q0))),
        q1(normalize(Rot2d(s.q1))) {
    // A normalised linear interpolation turns fastest half way, 2 tan(θ/2) a unit of time for a turn by θ, and slowest
    // at its ends, sin θ.
    const double l = math::sqrt(square((q1.c + q0.c) / 2) + square((q1.s + q0.s) / 2));
    const double sine = q0.c * q1.s - q0.s * q1.c;
    const double chord = math::sqrt(square(q1.c - q0.c) + square(q1.s - q0.s));
    most_rate = (sine < 0 ? -1 : 1) * (l > 1e-6 ? chord / l : 1e6);
    least_rate = l > 0.71 ? sine : 0;
    sagitta = 1 - l;
  }
  bool turns() const { return most_rate != 0; }
  Rot2d rotation(double t) const {
    return turns() ? normalize(Rot2d{q0.c + t * (q1.c - q0.c), q0.s + t * (q1.s - q0.s)}) : q0;
  }
  /// Seen from `origin`.
  Transform2d at(double t, Vec2d origin = {}) const {
    const Rot2d q = rotation(t);
    return {c0 + way * t - rotate(q, local_center) - origin, q};
  }
  /// The most that a point of the shape moves along the unit n in a unit of time, from t on.
  double speed(Vec2d n, const Swept<Vec2d>& shape, double t) const {
    double most = dot(way, n);
    if (!turns()) return most;
    const double across = dot(cross(1.0, rotate(rotation(t), shape.arm)), n), rate = math::abs(most_rate);
    most += max(most_rate * across, least_rate * across);
    return most + rate * (rate * (1 - t) * math::length(shape.arm) + shape.reach);
  }
};

struct Motion3 {
  Vec3d local_center, c0, way;
  Quatd q0, q1;
  Vec3d axis{};                          ///< of the turn, unit
  double least_rate = 0, most_rate = 0;  ///< rad a unit of time
  double sagitta = 0;                    ///< of the arc of a point 1 m from the centre, over its chord

  explicit Motion3(const Sweep3& s)
      : local_center(s.local_center),
        c0(s.c0),
        way(Vec3d(s.c1) - Vec3d(s.c0)),
        q0(normalize(Quatd(s.q0))),
        q1(normalize(Quatd(s.q1))) {
    if (dot(q0, q1) < 0) q1 = -q1;
    const Quatd chord = q1 - q0;
    if (chord == Quatd{0, {}}) return;
    // A normalised linear interpolation turns fastest half way, 4 tan(θ/4) a unit of time for a turn by θ, and slowest
    // at its ends, 2 sin(θ/2).
    const double l = length((q0 + q1) * 0.5);  // cos(θ/4)
    const Vec3d turn = (q1 * conjugate(q0)).vector();
    most_rate = 2 * length(chord) / l;
    least_rate = 2 * math::length(turn);
    axis = normalize(turn);
    sagitta = 2 * (1 - l * l);  // 1 − cos(θ/2)
  }
  bool turns() const { return most_rate != 0; }
  /// The most that the way of a point 1 m from the centre is bent: its acceleration, m a unit of time squared.
  double bend() const { return square(most_rate) * math::sqrt(1 + square(0.25 * most_rate)); }
  Quatd rotation(double t) const { return turns() ? normalize(q0 + (q1 - q0) * t) : q0; }
  Transform3d at(double t) const {
    const Quatd q = rotation(t);
    return {c0 + way * t - rotate(q, local_center), q};
  }
  /// The most that a point of the shape moves along the unit n in a unit of time, from t on.
  double speed(Vec3d n, const Swept<Vec3d>& shape, double t) const {
    double most = dot(way, n);
    if (!turns()) return most;
    const double side = dot(cross(axis, rotate(rotation(t), shape.arm)), n);
    most += max(most_rate * side, least_rate * side);
    const double along = dot(n, axis), across = min(1.0, math::sqrt(max(0.0, 1 - along * along)) + 1e-6);
    return most + most_rate * (most_rate * (1 - t) * math::length(shape.arm) + across * shape.reach);
  }
};

/// The acceleration of all points of a swept core is at most this.
template <class Motion, class V>
double bend_of(const Motion& motion, const Swept<V>& shape) {
  return motion.turns() ? motion.bend() * (math::length(shape.arm) + shape.reach) : 0;
}

/// The first part of a span of time (0…1; 1: all of it) in which a gap along a fixed direction, `first` at its begin
/// and `last` at its end, can shrink to nothing. Were all points to go straight and evenly from where they begin to
/// where they end, the gap would be at least what is linear between both; they stray from there by bend · part ·
/// (1 − part) / 2, with their accelerations times the span squared as the bend.
inline double clear_part(double first, double last, double bend) {
  const double bow = 0.5 * bend, slope = last - first - bow, discriminant = slope * slope - 4 * bow * first;
  if (slope >= 0 || discriminant < 0) return 1;
  return min(1.0, 2 * first / (math::sqrt(discriminant) - slope));
}

/// Steps through time by what the gap cannot close before. gap(t, normal): the distance of the surfaces at t, and the
/// unit normal from A to B that shows it, zero or less where they overlap; closing(t, normal): the most by which it
/// shrinks in a unit of time from t on; safe(t, normal): nothing will be passed from t on, as the caller knows better.
/// A gap that has clear_until(t, normal, distance, target, limit) may know better how long the normal keeps them apart.
template <class V, class Gap, class Closing, class Safe>
TimeOfImpact advance(double target, double limit, Gap&& gap, Closing&& closing, Safe&& safe) {
  const double tolerance = 0.25 * target;
  double t = 0;
  for (int i = 0; i < 200; ++i) {
    V n{};
    const double d = gap(t, n);
    if (i == 0 && d <= 0) return {ImpactState::overlapped, 0};
    if (d <= target + tolerance) return {ImpactState::hit, float(t)};
    const double rate = closing(t, n);
    if (!(rate * (limit - t) > d - target) || safe(t, n)) return {};
    double next = t + (d - target) / rate;
    if constexpr (requires { gap.clear_until(t, n, d, target, limit); })
      next = max(next, gap.clear_until(t, n, d, target, limit));
    t = next;
    if (t >= limit) return {};
  }
  // Still near after so many small steps: stop here rather than risk to pass.
  return {ImpactState::hit, float(t)};
}

}  // namespace carom::geometry::detail
