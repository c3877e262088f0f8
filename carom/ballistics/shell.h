// Spinning shells: the modified point mass of STANAG 4355 and the full motion of a symmetric body (chapter 18.1).
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "carom/ballistics/flight.h"

namespace carom::ballistics {

/// Aerodynamic coefficients at a Mach number, per radian; rate terms with p d/2V, on S = π d²/4.
struct ShellCoefficients {
  double mach = 0;
  double axial = 0;          ///< C_X0
  double axial_yaw = 0;      ///< C_X2, with the square of the yaw
  double normal = 0;         ///< C_Nα
  double magnus_force = 0;   ///< C_Ypα
  double roll_damping = 0;   ///< C_lp
  double overturning = 0;    ///< C_Mα
  double pitch_damping = 0;  ///< C_mq
  double magnus_moment = 0;  ///< C_Mpα
};

struct Shell {
  double mass = 1;                              ///< kg
  double diameter = 0.1;                        ///< m
  double axial_inertia = 1;                     ///< kg·m², I_x
  double transverse_inertia = 1;                ///< kg·m², I_t
  double twist = 20;                            ///< calibres a turn, right-handed; negative: left-handed
  std::vector<ShellCoefficients> aerodynamics;  ///< rows by rising Mach number, linear between
  double length = 0;                            ///< m; 0: 4.5 calibres. Of its body alone, as is:
  double centre = 0;                            ///< m from the nose to the centre of mass; 0: .65 of the length
};
/// Errors name what cannot be: masses, inertias, rows of coefficients.
CAROM_API core::Status check(const Shell& shell);
/// A shell with what it is fired with.
struct ShellPreset {
  std::string_view name, description, source;
  Shell shell{};
  std::vector<double> muzzle_speeds;  ///< m/s, by charge
};
/// 155mm_m107. Files: presets/shell.
CAROM_API std::span<const ShellPreset> shell_presets();
/// The 155 mm M107. Mass, inertia and aerodynamics: BRL MR-1582 (AD0454925) as tabulated in table 11 of Lim, NPS thesis
/// AD1029824.
CAROM_API Shell m107();

/// Row at a Mach number, constant beyond the ends.
CAROM_API ShellCoefficients coefficients_at(const Shell& shell, double mach);
/// Spin (rad/s) at the muzzle: 2π v/(twist · d).
CAROM_API double muzzle_spin(const Shell& shell, double speed);
/// S_g = I_x² p²/(2 ρ I_t S d V² C_Mα): > 1 is stable.
CAROM_API double gyroscopic_stability(const Shell& shell, double spin, double density, double speed, double mach);

/// Yaw of repose (rad, as a vector): δ = −2 I_x p (v × v̇)/(ρ S d C_Mα V⁴); v through the air, v̇ of the trajectory.
CAROM_API math::Vec3d yaw_of_repose(const Shell& shell, double spin, double density, math::Vec3d velocity,
                                    math::Vec3d acceleration, double overturning);

enum class ShellModel {
  modified_point_mass,  ///< the axis stands at the yaw of repose: artillery's standard, and fast
  six_degrees,          ///< the axis nutates and precesses
};

/// One moment of the flight.
struct ShellState {
  double time = 0;                     ///< s
  math::Vec3d position{}, velocity{};  ///< m, m/s
  double spin = 0;                     ///< rad/s
  math::Vec3d axis{1, 0, 0};           ///< unit vector, nose forward
  double yaw = 0;                      ///< rad, between the axis and the velocity through the air
};

struct ShellFlight {
  Trajectory path;
  std::vector<ShellState> states;  ///< at the path's nodes
};

/// From `start` with the spin of the barrel to the first limit. In six degrees the shell leaves along its velocity
/// through the ground, tipped by `tip` (rad/s, its first transverse angular velocity).
/// Errors name what cannot be: masses, inertias, coefficients, limits.
CAROM_API core::Result<ShellFlight> fly_shell(const Shell& shell, const Conditions& conditions,
                                              const FlightPoint& start, ShellModel model,
                                              const FlightLimits& limits = {}, math::Vec3d tip = {});

/// A shell in flight that is taken on step by step.
struct ShellMotion {
  math::Vec3d position{}, velocity{};  ///< m, m/s
  double spin = 0;                     ///< rad/s
  math::Vec3d axis{1, 0, 0};           ///< unit vector, nose forward
  math::Vec3d momentum{};              ///< kg·m²/s, angular, I_x p e + I_t e × ė; of six degrees alone
};
/// As it leaves the barrel along its velocity through the ground with a spin (rad/s). In six degrees `tip` as above.
CAROM_API ShellMotion launched(const Shell& shell, const FlightPoint& start, double spin, ShellModel model,
                               math::Vec3d tip = {});
/// `dt` s later, from the time `time` of the field: classic Runge–Kutta steps, a fiftieth of a second at most, and so
/// short that the nose turns by a tenth of a radian at most in one. Those are what six degrees cost: a bullet of a
/// rifle takes hundreds in a sixtieth of a second. Expects a shell that `check` passes.
CAROM_API ShellMotion flown(const Shell& shell, const Conditions& conditions, ShellModel model,
                            const ShellMotion& motion, double time, double dt);
/// rad, between axis and velocity through the air.
CAROM_API double yaw_of(const Conditions& conditions, const ShellMotion& motion, double time);

}  // namespace carom::ballistics
