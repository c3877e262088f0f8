#include "carom/forces/drag_law.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/forces/drag.h"
#include "carom/math/elementary.h"

namespace carom::forces {
using math::Vec2d;
using math::Vec3d;
namespace {

/// Linear in ln Re between points of rising Re; what lies beyond keeps the end.
template <std::size_t N>
double between(const double (&re)[N], const double (&c)[N], double reynolds) {
  if (!(reynolds > re[0])) return c[0];
  for (std::size_t i = 1; i < N; ++i)
    if (reynolds < re[i])
      return c[i - 1] + (c[i] - c[i - 1]) * math::log(reynolds / re[i - 1]) / math::log(re[i] / re[i - 1]);
  return c[N - 1];
}

// Spheres of 9/16 in over the Mach number (US Army BRL, the drag function GS), thinned.
constexpr double sphere_mach[] = {0, .2, .4, .5, .6, .7, .8, .9, 1, 1.1, 1.2, 1.3, 1.4, 1.6, 2, 2.5, 3, 4};
constexpr double sphere_by_mach[] = {.4662, .4772, .4882, .4970,  .5260,  .5920,  .6610, .7370, .8140,
                                     .8870, .9510, .9910, 1.0030, 1.0090, 1.0010, .9810, .9610, .9280};

double sphere_of_mach(double mach) {
  constexpr int n = int(std::size(sphere_mach));
  if (!(mach > 0)) return sphere_by_mach[0];
  for (int i = 1; i < n; ++i)
    if (mach < sphere_mach[i]) {
      const double t = (mach - sphere_mach[i - 1]) / (sphere_mach[i] - sphere_mach[i - 1]);
      return sphere_by_mach[i - 1] + t * (sphere_by_mach[i] - sphere_by_mach[i - 1]);
    }
  return sphere_by_mach[n - 1];
}

}  // namespace

double CoefficientTable::at(double x) const {
  const std::span<const CoefficientPoint> p = points();
  if (p.empty()) return 0;
  if (!(x > p[0].x)) return p[0].y;
  const auto next = std::ranges::upper_bound(p, x, {}, &CoefficientPoint::x);
  if (next == p.end()) return p.back().y;
  const CoefficientPoint &a = *(next - 1), &b = *next;
  const double t = logarithmic_ ? math::log(x / a.x) / math::log(b.x / a.x) : (x - a.x) / (b.x - a.x);
  return a.y + t * (b.y - a.y);
}

core::Status validate(const CoefficientTable& table) {
  const std::span<const CoefficientPoint> p = table.points();
  if (p.empty() || p.size() > CoefficientTable::capacity)
    return core::Error{core::text("table: found ", p.size(), " points, expected 1 … ", CoefficientTable::capacity)};
  for (std::size_t i = 0; i < p.size(); ++i) {
    if (!math::is_finite(p[i].x) || !math::is_finite(p[i].y))
      return core::Error{core::text("table: point ", i, " is not finite")};
    if (i > 0 && !(p[i].x > p[i - 1].x))
      return core::Error{core::text("table: x[", i, "] is ", p[i].x, ", expected more than ", p[i - 1].x)};
  }
  if (table.logarithmic() && !(p[0].x > 0))
    return core::Error{core::text("table: x[0] is ", p[0].x, ", expected more than 0 over a logarithm")};
  return {};
}

double cylinder_drag(double reynolds) {
  constexpr double crisis_re[] = {2e5, 2.8e5, 3.5e5, 5e5, 1e6, 2e6, 4e6, 7e6};
  constexpr double crisis_c[] = {1.179, 1.1, 0.45, 0.23, 0.24, 0.34, 0.45, 0.52};
  if (reynolds > 2e5) return between(crisis_re, crisis_c, reynolds);
  const double re = math::max(reynolds, 1e-4);
  return 1.18 + 6.8 * math::pow(re, -0.89) + 1.96 / math::sqrt(re) - 0.0004 * re / (1 + 3.64e-7 * re * re);
}

double disc_drag(double reynolds) {
  const auto slow = [](double re) { return 64 / (math::pi * re) * (1 + 0.138 * math::pow(re, 0.792)); };
  if (reynolds <= 133) return slow(reynolds);
  if (reynolds >= 1000) return 1.17;
  const double t = math::log(reynolds / 133) / math::log(1000.0 / 133);
  return slow(133) + t * (1.17 - slow(133));
}

double plate_friction(double reynolds) {
  if (!(reynolds > 5e5)) return 1.328 / math::sqrt(math::max(reynolds, 1e-3));
  return 2 * (0.455 / math::pow(math::log10(reynolds), 2.58) - 1700 / reynolds);
}

double sphere_drag(double reynolds, double mach) {
  const double slow = sphere_drag_morrison(math::clamp(reynolds, 1e-9, 1e6));
  if (!(mach > 0.4)) return slow;
  const double t = math::min((mach - 0.4) / 0.5, 1.0), share = t * t * (3 - 2 * t);
  return slow + share * (math::max(sphere_of_mach(mach), reynolds < 1e3 ? slow : 0.0) - slow);
}

double drag_coefficient(const DragLaw& law, double reynolds, double mach) {
  switch (law.kind) {
    case DragLaw::Kind::constant:
      return law.coefficient;
    case DragLaw::Kind::sphere:
      return sphere_drag(reynolds, mach);
    case DragLaw::Kind::cylinder:
      return cylinder_drag(reynolds);
    case DragLaw::Kind::disc:
      return disc_drag(math::max(reynolds, 1e-9));
    case DragLaw::Kind::by_reynolds:
      return law.table.at(reynolds);
    case DragLaw::Kind::by_mach:
      return law.table.at(mach);
  }
  return 0;
}

Vec3d magnus_force(const LiftLaw& law, double density, double radius, Vec3d spin, Vec3d velocity) {
  const double speed = math::length(velocity), rate = math::length(spin);
  if (!(speed > 0) || !(rate > 0)) return {};
  const double c = lift_coefficient(law, radius * rate / speed);
  return (0.5 * density * math::pi * radius * radius * c * speed / rate) * math::cross(spin, velocity);
}

Vec2d magnus_force(const LiftLaw& law, double density, double radius, double spin, Vec2d velocity) {
  const double speed = math::length(velocity), rate = math::abs(spin);
  if (!(speed > 0) || !(rate > 0)) return {};
  const double c = lift_coefficient(law, radius * rate / speed);
  return (0.5 * density * math::pi * radius * radius * c * speed / rate) * math::cross(spin, velocity);
}

}  // namespace carom::forces
