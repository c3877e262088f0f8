// A ball in air: coefficients over Reynolds number and spin, and the force and torque that follow from them
// (chapters 6.2, 6.3 and 19). One model for all sports; what differs is data (presets.h).
#pragma once

#include <cstdint>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/forces/wrench.h"
#include "carom/math/vec.h"

namespace carom::sports {

using math::Vec3d;

/// C_D = C_fast + C_crisis L(Re) + C_spin (1 − e^{−(S/S_d)²}) + k S, with L = 1/(1 + (Re/Re_c)^n): the drag crisis is a
/// step of L from 1 (slow, laminar) to 0 (fast, turbulent). S = ω⊥ r/V is the spin parameter.
struct DragLaw {
  double fast = 0.47;              ///< C_fast, beyond the crisis and without spin
  double crisis = 0;               ///< C_crisis, more drag below the crisis
  double critical_reynolds = 1e5;  ///< Re_c, the middle of the crisis, on the diameter
  double steepness = 10;           ///< n
  double spin_rise = 0;            ///< C_spin
  double spin_scale = 0.15;        ///< S_d
  double spin_slope = 0;           ///< k
};

/// C_L = C_max s (1 − f L(Re)), where s = tanh(S/S_l) or S/(S + S_l): lift that saturates with spin, and fades by f
/// below the drag crisis.
struct LiftLaw {
  enum class Shape : std::uint8_t {
    rational,    ///< S/(S + S_l): 1/(b + a/S) of the tennis and baseball papers has C_max = 1/b, S_l = a/b
    hyperbolic,  ///< tanh(S/S_l)
  };
  Shape shape = Shape::rational;
  double maximum = 0;       ///< C_max
  double spin_scale = 0.2;  ///< S_l
  double fade = 0;          ///< f, 0 … 1
};

/// A force across the way that spin does not make: of a seam, or of a wake that wanders.
struct SideForce {
  enum class Kind : std::uint8_t {
    none,
    /// A seam that keeps its attitude (cricket): C = C_s f(α) R(Re) toward the side to which it points; α is its angle
    /// to the flight, f = (α/α₀) e^{½(1 − (α/α₀)²)} peaks at α₀, and R turns from 1 to −1 round Re_r (reverse swing).
    held_seam,
    /// A seam that turns slowly past the flow (knuckleball): C = C_s sin(k φ), φ the angle turned about the spin axis.
    /// Watts & Sawyer, Am. J. Phys. 43 (1975) 960: four cycles a turn.
    turning_seam,
    /// No spin at all (soccer): three incommensurate waves near the Strouhal number St V/d along each of two directions
    /// across the flight, their phases drawn from `seed`.
    wandering_wake,
  };
  Kind kind = Kind::none;
  double coefficient = 0;       ///< C_s, the largest
  Vec3d seam_normal{0, 0, 1};   ///< held_seam: unit normal of the seam's plane, world axes
  double best_angle = 0.35;     ///< α₀, rad
  double reverse_reynolds = 0;  ///< Re_r; 0: never reverses
  double cycles = 4;            ///< k, a turn
  double strouhal = 0.03;       ///< St
  std::uint64_t seed = 1;
};

/// Measured coefficients on a grid of speeds and spins, bilinear between and constant beyond. Where a ball has one, it
/// takes the place of both laws.
struct CoefficientGrid {
  std::vector<double> speeds;      ///< m/s, rising
  std::vector<double> spins;       ///< rad/s, rising
  std::vector<double> drag, lift;  ///< [spin][speed]
};

struct Ball {
  double mass = 0.1;            ///< kg
  double radius = 0.03;         ///< m
  double inertia_factor = 0.4;  ///< I/(m r²): .4 solid, 2/3 thin shell
  DragLaw drag{};
  LiftLaw lift{};
  SideForce side{};
  double spin_damping = 0;  ///< C_m: torque −½ ρ A r² C_m V ω
  CoefficientGrid grid{};
};
/// Errors name the field: not finite, or out of what can be.
CAROM_API core::Status check(const Ball& ball);

/// The air at one place.
struct Air {
  double density = 1.225;        ///< kg/m³
  double viscosity = 1.7894e-5;  ///< Pa·s
};
/// What a ball does in it.
struct BallMotion {
  Vec3d velocity{};   ///< m/s, through the air
  Vec3d spin{};       ///< rad/s, world axes
  double turned = 0;  ///< rad, angle turned about the spin axis (SideForce::turning_seam)
  double time = 0;    ///< s (SideForce::wandering_wake)
};

struct Coefficients {
  double drag = 0, lift = 0;
};
/// At a speed (m/s) and a spin across the flight (rad/s).
CAROM_API Coefficients coefficients(const Ball& ball, const Air& air, double speed, double spin);
/// Force (N) and torque (N·m) of the air: drag along −v, lift along ω × v, the side force across, and the torque that
/// takes the spin. The part of the spin along the flight gives no lift.
CAROM_API forces::Wrench3 air_load(const Ball& ball, const Air& air, const BallMotion& motion);

inline double area(const Ball& ball) { return 3.14159265358979323846 * ball.radius * ball.radius; }  ///< m²
inline double inertia(const Ball& ball) { return ball.inertia_factor * ball.mass * ball.radius * ball.radius; }
/// Re = ρ V d/μ.
inline double reynolds(const Ball& ball, const Air& air, double speed) {
  return air.density * speed * 2 * ball.radius / air.viscosity;
}
/// Speed (m/s) at which drag carries the weight, without spin: V with ½ ρ A C_D(V) V² = m g, the lowest such speed.
CAROM_API double terminal_speed(const Ball& ball, const Air& air, double gravity = 9.80665);

/// C_D of a smooth sphere for any Reynolds number: F. A. Morrison, An Introduction to Fluid Mechanics (2013),
/// fig. 8.13; within the scatter of the data to 1e6.
CAROM_API double smooth_sphere_drag(double reynolds);
/// (24/Re)(1 + .15 Re^.687): Schiller & Naumann 1933, Re < 800.
CAROM_API double schiller_naumann_drag(double reynolds);
/// Lift per length (N/m) of a cylinder by ideal theory: ρ V Γ, Γ = 2π r² ω (Kutta and Joukowski).
CAROM_API double ideal_cylinder_lift(double density, double speed, double radius, double spin);
/// Lift (N) of a sphere by ideal theory, π ρ V r³ ω: 1.6 times too large at S = .17, and blind to the drag crisis.
CAROM_API double ideal_sphere_lift(double density, double speed, double radius, double spin);

}  // namespace carom::sports
