// One rigid body in double precision with six degrees of freedom, integrated by any method of carom/ode: the reference
// the engine is measured against, and flights over a flat, a round and the real Earth (NASA/TM-2015-218675).
#pragma once

#include "carom/core/function_ref.h"
#include "carom/core/result.h"
#include "carom/environment/earth.h"
#include "carom/environment/gravity.h"
#include "carom/export.h"
#include "carom/math/quat.h"
#include "carom/ode/methods.h"

namespace carom::rigid {

/// In an inertial frame; as a derivative it holds the rates of the same quantities.
struct FreeBodyState {
  math::Vec3d position{};          ///< m, of the centre of mass
  math::Vec3d velocity{};          ///< m/s
  math::Quatd attitude{};          ///< body → inertial
  math::Vec3d angular_velocity{};  ///< rad/s, body axes
  friend constexpr FreeBodyState operator+(const FreeBodyState& a, const FreeBodyState& b) {
    return {a.position + b.position, a.velocity + b.velocity, a.attitude + b.attitude,
            a.angular_velocity + b.angular_velocity};
  }
  friend constexpr FreeBodyState operator*(double s, const FreeBodyState& a) {
    return {s * a.position, s * a.velocity, s * a.attitude, s * a.angular_velocity};
  }
};

/// Mass properties about the centre of mass. Make it with `make_free_body`.
struct FreeBody {
  double mass = 1;                                        ///< kg
  math::Mat3d inertia = math::Mat3d::identity();          ///< kg·m², body axes
  math::Mat3d inverse_inertia = math::Mat3d::identity();  ///< 1/(kg·m²)
};
/// Errors: mass not finite or ≤ 0; tensor not finite, not symmetric, or not that of a possible body (principal
/// moments must be positive and satisfy the triangle inequality).
CAROM_API core::Result<FreeBody> make_free_body(double mass, const math::Mat3d& inertia);

struct FreeBodyLoad {
  math::Vec3d force{};   ///< N, inertial axes, at the centre of mass
  math::Vec3d moment{};  ///< N·m, body axes
};

/// v̇ = F/m, q̇ = ½ q ⊗ ω, ω̇ = I⁻¹(M − ω × Iω).
CAROM_API FreeBodyState derivative(const FreeBody& body, const FreeBodyState& state, const FreeBodyLoad& load);

/// One step; `load(time, state)` gives the FreeBodyLoad. The attitude is renormalised after the step.
template <class Load>
[[nodiscard]] ode::Outcome step(ode::Method method, const FreeBody& body, const Load& load, double time,
                                FreeBodyState& state, double dt) {
  const auto rates = [&](double t, const FreeBodyState& y) { return derivative(body, y, load(t, y)); };
  const ode::Outcome outcome = ode::step(method, rates, time, state, dt);
  if (outcome == ode::Outcome::done) state.attitude = math::normalize(state.attitude);
  return outcome;
}

/// 2T = ω·Iω, J·2: constant without moments.
CAROM_API double twice_rotational_energy(const FreeBody& body, const FreeBodyState& state);
/// H = Iω in inertial axes, kg·m²/s: constant without moments.
CAROM_API math::Vec3d angular_momentum(const FreeBody& body, const FreeBodyState& state);

/// Yaw, pitch and roll (rad) of a rotation body → reference, applied in the order z, y, x; axes x forward, y to
/// starboard, z down. At pitch ±90° the roll is zero and the yaw takes the whole turn.
struct FlightAngles {
  double yaw = 0, pitch = 0, roll = 0;
};
CAROM_API math::Quatd to_attitude(const FlightAngles& angles);
CAROM_API FlightAngles to_flight_angles(const math::Quatd& attitude);

enum class FlightWorld {
  flat,   ///< still, plane ground; gravity uniform or falling off with height
  round,  ///< a still sphere with GM/r²
  earth,  ///< WGS-84: ellipsoid, turning, J₂
};

/// A flight of a body without control, in aviation's axes: north-east-down and x forward, y starboard, z down.
/// SI units, radians.
struct FlightCase {
  FlightWorld world = FlightWorld::flat;
  double gravity = environment::standard_gravity;  ///< m/s², flat world; 0 and `gm` set: gm/(radius + h)²
  double gm = environment::earth_gm;               ///< m³/s²
  double radius = 6371000;                         ///< m, round world (and flat with gravity 0)
  environment::Ellipsoid ellipsoid{};              ///< earth
  environment::ZonalGravity zonal{};               ///< earth

  environment::Geodetic place{};  ///< at the start
  math::Vec3d velocity_ned{};     ///< m/s relative to the (turning) ground
  FlightAngles angles{};          ///< relative to north-east-down
  math::Vec3d body_rates{};       ///< rad/s, body axes, relative to inertial space

  double mass = 1;                                ///< kg
  math::Mat3d inertia = math::Mat3d::identity();  ///< kg·m², body axes

  double drag_coefficient = 0;  ///< constant, on `reference_area` (m²), in the US Standard Atmosphere 1976
  double reference_area = 0;
  math::Vec3d wind_ned{};  ///< m/s, uniform

  ode::Method method = ode::Method::rk4;
  double dt = 0.01;            ///< s
  double duration = 30;        ///< s
  double output_interval = 1;  ///< s, rounded to whole steps, at least one
};

struct FlightRow {
  double time = 0;                     ///< s
  double altitude = 0;                 ///< m
  double latitude = 0, longitude = 0;  ///< rad
  math::Vec3d velocity_ned{};          ///< m/s relative to the ground
  math::Vec3d body_rates{};            ///< rad/s, relative to inertial space
  FlightAngles angles{};               ///< rad, relative to the local north-east-down
  double speed_of_sound = 0;           ///< m/s
  double density = 0;                  ///< kg/m³
  double mach = 0;
  double drag = 0;                     ///< N
  math::Vec3d drag_body{};             ///< N, body axes
  double gravity = 0;                  ///< m/s², gravitation without the centrifugal part
  double twice_rotational_energy = 0;  ///< J·2
  double angular_momentum = 0;         ///< kg·m²/s
  FreeBodyState state{};  ///< inertial (earth and round: axes of the Earth at t = 0; flat: north-east-down)
};

/// Calls `row` at the start, after every output interval and at the end. Errors name the field that was refused, or
/// the time at which the integration failed.
CAROM_API core::Status simulate(const FlightCase& flight, core::FunctionRef<void(const FlightRow&)> row);

}  // namespace carom::rigid

namespace carom::ode {
template <>
inline constexpr int components<rigid::FreeBodyState> = 13;
}
