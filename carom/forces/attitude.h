// Forces of the flow on bodies that show it different sides (chapters 3.4, 6.2): wings and plates at any angle of
// attack, cylinders along, across and between.
#pragma once

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/forces/wrench.h"

namespace carom::forces {

/// A wing, a fin, a plate, a sail: lift and drag over the angle of attack, all the way round.
struct WingLaw {
  double aspect_ratio = 6;     ///< span² by area, > 0
  double zero_lift_angle = 0;  ///< rad, of attack at which there is no lift; a flat plate's is 0
  double stall_angle = 0.26;   ///< rad beyond that, in (0, 1): some 15° of a profile, 8° to 10° of a thin plate
  double profile_drag = 0.01;  ///< C_D without lift, attached
  double efficiency = 0.9;     ///< Oswald's e of the induced drag, in (0, 1]
};
/// A thin flat plate of that aspect ratio.
constexpr WingLaw flat_plate(double aspect_ratio) { return {aspect_ratio, 0, 0.16, 0.02, 0.9}; }

struct LiftAndDrag {
  double lift = 0, drag = 0;
};
/// C_L and C_D, on the area of the plan, at an angle of attack (rad, any). Attached: slope 2π A/(2 + √(A² + 4)) (H. B.
/// Helmbold, Jahrbuch der Luftfahrtforschung 1942) and C_L²/(π e A) of induced drag. Beyond the stall L. A. Viterna's
/// and D. C. Janetzke's continuation to a plate across the flow, C_D = 1.11 + .018 A there (NASA TM-82944, 1982); the
/// trailing edge first the same with .7 of the lift.
CAROM_API LiftAndDrag lift_and_drag(const WingLaw& law, double angle_of_attack);
/// Where the force acts, in chords behind the leading edge: a quarter where the flow is attached (thin aerofoils), the
/// middle across the flow, by the sine of the angle in between; from the other edge where that comes first. Plates by
/// J. Joëssel (1870): .195 + .305 sin α.
CAROM_API double pressure_centre(double angle_of_attack);
/// Force (N) of the flow and its moment about the middle of the surface. `forward` (toward the leading edge) and `up`
/// are unit vectors square to each other; `velocity` is that of the surface through the air (m/s). What of it goes
/// along the span has no part. The angle of attack is that at the three-quarter chord, where `spin` (rad/s) counts: it
/// damps.
CAROM_API Wrench3 lifting_surface(const WingLaw& law, double density, double area, double chord, math::Vec3d forward,
                                  math::Vec3d up, math::Vec3d velocity, math::Vec3d spin = {});
/// Errors name what is out of range.
CAROM_API core::Status validate(const WingLaw& law);

/// Force (N) on a cylinder, `axis` a unit vector, `velocity` its own through the fluid: each part of the flow has its
/// own drag (the cross-flow principle, S. F. Hoerner, Fluid-Dynamic Drag, 1965, 3-11). Across, `cylinder_drag` at the
/// Reynolds number of that part; along, the friction of a plate as long over the mantle and .82 on the blunt ends
/// (Hoerner 3-12: a rod that is long against its diameter).
CAROM_API math::Vec3d cylinder_force(double density, double viscosity, double diameter, double length, math::Vec3d axis,
                                     math::Vec3d velocity);

}  // namespace carom::forces
