#include "carom/forces/attitude.h"

#include "carom/core/string.h"
#include "carom/forces/drag.h"
#include "carom/forces/drag_law.h"
#include "carom/math/elementary.h"

namespace carom::forces {
using math::Vec3d;
namespace {

constexpr double half_turn = math::pi;

/// An angle (rad) within ± π.
double wrapped(double angle) { return angle - 2 * half_turn * math::round(angle / (2 * half_turn)); }

}  // namespace

LiftAndDrag lift_and_drag(const WingLaw& law, double angle_of_attack) {
  double angle = wrapped(angle_of_attack - law.zero_lift_angle);
  // The trailing edge first: as a wing that flies the other way, upside down.
  double share = 1;
  if (math::abs(angle) > 0.5 * half_turn) {
    angle = angle > 0 ? angle - half_turn : angle + half_turn;
    share = 0.7;
  }
  const double side = angle < 0 ? -1 : 1, a = math::abs(angle), aspect = law.aspect_ratio;
  const double slope = 2 * math::pi * aspect / (2 + math::sqrt(aspect * aspect + 4));
  const auto attached = [&](double x) {
    const double lift = slope * x;
    return LiftAndDrag{lift, law.profile_drag + lift * lift / (math::pi * law.efficiency * aspect)};
  };
  const double stall = law.stall_angle;
  if (a <= stall) {
    const LiftAndDrag c = attached(a);
    return {side * share * c.lift, c.drag};
  }
  const LiftAndDrag at = attached(stall);
  const double broadside = math::min(1.11 + 0.018 * aspect, 2.01);
  const math::SinCos<double> s = math::sincos(stall), x = math::sincos(a);
  const double lift = (at.lift - broadside * s.sin * s.cos) * s.sin / (s.cos * s.cos);
  const double drag = (at.drag - broadside * s.sin * s.sin) / s.cos;
  return {side * share * (broadside * x.sin * x.cos + lift * x.cos * x.cos / x.sin),
          broadside * x.sin * x.sin + drag * x.cos};
}

double pressure_centre(double angle_of_attack) {
  const math::SinCos<double> a = math::sincos(angle_of_attack);
  const double from_front = 0.25 + 0.25 * math::abs(a.sin);
  return a.cos < 0 ? 1 - from_front : from_front;
}

Wrench3 lifting_surface(const WingLaw& law, double density, double area, double chord, Vec3d forward, Vec3d up,
                        Vec3d velocity, Vec3d spin) {
  // Three quarters of the chord behind the edge that comes first.
  const double back = math::dot(velocity, forward) < 0 ? 0.25 : -0.25;
  const Vec3d felt = velocity + math::cross(spin, (back * chord) * forward);
  const double along = math::dot(felt, forward), down = -math::dot(felt, up), speed2 = along * along + down * down;
  if (!(speed2 > 0)) return {};
  const double speed = math::sqrt(speed2), angle = math::atan2(down, along);
  const LiftAndDrag c = lift_and_drag(law, angle);
  const double pressure = 0.5 * density * area * speed2;
  // Unit vectors of the motion and of the lift, square to it.
  const Vec3d way = (along * forward - down * up) / speed, rise = (down * forward + along * up) / speed;
  const Vec3d force = pressure * (c.lift * rise - c.drag * way);
  const Vec3d arm = ((0.5 - pressure_centre(angle)) * chord) * forward;
  return {force, math::cross(arm, force)};
}

core::Status validate(const WingLaw& law) {
  const struct {
    const char* name;
    double value, low, high;
  } rules[] = {{"aspect_ratio", law.aspect_ratio, 1e-3, 1e3},
               {"zero_lift_angle", law.zero_lift_angle, -0.5, 0.5},
               {"stall_angle", law.stall_angle, 1e-3, 1},
               {"profile_drag", law.profile_drag, 0, 10},
               {"efficiency", law.efficiency, 1e-3, 1}};
  for (const auto& rule : rules)
    if (!(rule.value >= rule.low && rule.value <= rule.high))
      return core::Error{
          core::text(rule.name, " is ", rule.value, ", expected a number in [", rule.low, ", ", rule.high, "]")};
  return {};
}

Vec3d cylinder_force(double density, double viscosity, double diameter, double length, Vec3d axis, Vec3d velocity) {
  const double along = math::dot(velocity, axis), a = math::abs(along);
  const Vec3d across = velocity - along * axis;
  const double v = math::length(across);
  Vec3d force{};
  if (v > 0) {
    const double c = cylinder_drag(reynolds_number(density, v, diameter, viscosity));
    force = (-0.5 * density * diameter * length * c * v) * across;
  }
  if (a > 0) {
    // Friction on the mantle, of which the plate's two sides are counted on one; the ends' pressure.
    const double friction = 0.5 * plate_friction(reynolds_number(density, a, length, viscosity));
    const double surface = math::pi * diameter * length * friction + 0.25 * math::pi * diameter * diameter * 0.82;
    force -= (0.5 * density * surface * a * along) * axis;
  }
  return force;
}

}  // namespace carom::forces
