// Drag coefficients that follow from the flow: by Reynolds and Mach number, for spheres, cylinders, plates and whatever
// was measured (chapters 3.4, 6.2). Coefficients are on the area across the flow unless stated.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/vec.h"

namespace carom::forces {

struct CoefficientPoint {
  double x = 0, y = 0;
};
/// A measured curve: points of rising x, straight lines between them (over ln x where `logarithmic`, which then is >
/// 0), constant beyond. It does not change: copies share the points.
class CAROM_API CoefficientTable {
 public:
  static constexpr std::size_t capacity = 1024;
  CoefficientTable() = default;
  explicit CoefficientTable(std::vector<CoefficientPoint> points, bool logarithmic = false)
      : points_(std::make_shared<const std::vector<CoefficientPoint>>(std::move(points))), logarithmic_(logarithmic) {}
  std::span<const CoefficientPoint> points() const {
    return points_ != nullptr ? std::span<const CoefficientPoint>(*points_) : std::span<const CoefficientPoint>();
  }
  bool logarithmic() const { return logarithmic_; }
  double at(double x) const;

 private:
  std::shared_ptr<const std::vector<CoefficientPoint>> points_;
  bool logarithmic_ = false;
};
/// Errors: no or too many points, x that does not rise, what is not finite.
CAROM_API core::Status validate(const CoefficientTable& table);

/// A circular cylinder across the flow. To Re = 2·10⁵: 1.18 + 6.8 Re^−.89 + 1.96 Re^−.5 − .0004 Re/(1 + 3.64e-7 Re²)
/// (D. Sucker & H. Brauer, Wärme- und Stoffübertragung 8 (1975) 149); through the drag crisis and beyond a curve
/// through G. Schewe's measurements, J. Fluid Mech. 133 (1983) 265: .23 at 5·10⁵, .52 at 7·10⁶ (within 15 %, as tunnels
/// differ). Creeping flow below Re = 10⁻⁴ keeps the value there.
CAROM_API double cylinder_drag(double reynolds);
/// A disc or square plate across the flow: (64/(π Re))(1 + .138 Re^.792) to Re = 133, 1.17 from 1000 on, joined between
/// by its logarithm. R. Clift, J. R. Grace & M. E. Weber, Bubbles, Drops, and Particles (1978), chapter 6.
CAROM_API double disc_drag(double reynolds);
/// A thin plate along the flow, both sides, on the area of one side: laminar 2·.664/√Re_l to Re_l = 5·10⁵ (Blasius),
/// then 2(.455/(log₁₀ Re_l)^2.58 − 1700/Re_l) (Prandtl–Schlichting). Re by its length.
CAROM_API double plate_friction(double reynolds);
/// A sphere at any speed: Morrison's curve (its last value beyond Re = 10⁶), and from M .4 on more and more the
/// measured curve of 9/16 in spheres over the Mach number (.4662 at rest, 1.0 at M 1.4): waves, not the boundary layer,
/// then make the drag, and there is no drag crisis.
CAROM_API double sphere_drag(double reynolds, double mach);

/// Which law a body follows.
struct DragLaw {
  enum class Kind : std::int32_t {
    constant,
    sphere,       ///< by Re and M
    cylinder,     ///< by Re
    disc,         ///< by Re
    by_reynolds,  ///< the table
    by_mach,      ///< the table
  };
  Kind kind = Kind::sphere;
  double coefficient = 0.47;  ///< where constant
  CoefficientTable table{};
};
CAROM_API double drag_coefficient(const DragLaw& law, double reynolds, double mach);

/// Lift of a spinning ball over the spin factor S = r ω/V: C_L = S/(a S + b), which is 1/(a + b/S).
struct LiftLaw {
  double a = 2.32, b = 0.4;
};
/// Sawicki, Hubbard & Stronge, Am. J. Phys. 71 (2003) 1152, as a fit over S .1 … .5 of rough balls.
inline constexpr LiftLaw rough_ball_lift{2.32, 0.4};
/// Baseballs: 1.12 S/(.583 + 2.333 S). A. M. Nathan, Am. J. Phys. 76 (2008) 119 and his trajectory calculator.
inline constexpr LiftLaw baseball_lift{2.333 / 1.12, 0.583 / 1.12};
/// Tennis balls: 1/(2.022 + .981/S). A. Štěpánek, Am. J. Phys. 56 (1988) 138.
inline constexpr LiftLaw tennis_lift{2.022, 0.981};

constexpr double lift_coefficient(const LiftLaw& law, double spin_factor) {
  return spin_factor > 0 ? spin_factor / (law.a * spin_factor + law.b) : 0;
}
/// F = ½ ρ A V² C_L(S) ω̂ × v̂, N; A = π r². Zero where nothing turns or moves. S takes the whole spin: the part along
/// the way bends nothing and only counts through the cross product.
CAROM_API math::Vec3d magnus_force(const LiftLaw& law, double density, double radius, math::Vec3d spin,
                                   math::Vec3d relative_velocity);
/// The same in the plane, with the spin about z.
CAROM_API math::Vec2d magnus_force(const LiftLaw& law, double density, double radius, double spin,
                                   math::Vec2d relative_velocity);

/// Ideal flow, for comparison: lift per length of a spinning cylinder, Kutta and Joukowski: ρ V Γ, Γ = 2π r² ω (N/m).
constexpr double kutta_joukowski_lift(double density, double speed, double radius, double spin) {
  return density * speed * 2 * math::pi * radius * radius * spin;
}
/// And of a sphere: π ρ V r³ ω (N). At S = .17 real balls have 1.6 times less.
constexpr double ideal_sphere_lift(double density, double speed, double radius, double spin) {
  return math::pi * density * speed * radius * radius * radius * spin;
}

}  // namespace carom::forces
