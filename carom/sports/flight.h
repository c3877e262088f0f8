// The way of a ball through the air, integrated alone (chapters 6.2, 6.3, 19). y is up; in the frame of a shot x points
// at the target and z to the right.
#pragma once

#include <optional>

#include "carom/core/function_ref.h"
#include "carom/environment/wind_field.h"
#include "carom/ode/state.h"
#include "carom/sports/ball.h"

namespace carom::sports {

/// A ball at one moment.
struct BallState {
  Vec3d position{}, velocity{};  ///< m, m/s
  Vec3d spin{};                  ///< rad/s, world axes; backspin of a ball that flies along x is +z
  double turned = 0;             ///< rad, angle turned about the spin axis since the start
  friend constexpr BallState operator+(const BallState& a, const BallState& b) {
    return {a.position + b.position, a.velocity + b.velocity, a.spin + b.spin, a.turned + b.turned};
  }
  friend constexpr BallState operator*(double s, const BallState& a) {
    return {s * a.position, s * a.velocity, s * a.spin, s * a.turned};
  }
};

/// Where it flies.
struct Conditions {
  environment::AirColumn air = environment::AirColumn::uniform(1.225);
  environment::WindColumn wind{};
  double viscosity = 1.7894e-5;  ///< Pa·s
  double gravity = 9.80665;      ///< m/s²
  /// Wind by place and time, which stands for `wind` where there is one: gusts, thermals, lees. Flights take steps of
  /// at most a twentieth of a second through it.
  environment::WindFunction field{};
  double field_time = 0;  ///< s: of the field when a flight begins, or when a world's time is 0
};
/// Of the air at a place, `time` s after the flight began (m/s).
inline Vec3d wind_at(const Conditions& conditions, Vec3d position, double time) {
  return conditions.field ? conditions.field(position, conditions.field_time + time) : conditions.wind.at(position.y);
}

/// Rates of everything in a state: v, F/m − g ŷ, torque/I, |ω|.
CAROM_API BallState derivative(const Ball& ball, const Conditions& conditions, double time, const BallState& state);

/// What a launch monitor shows: speed (m/s), elevation and azimuth (rad, to the right of x), total spin (rad/s) and its
/// tilt (rad): the axis of pure backspin turned about the way, positive where the ball curves to the right.
struct Launch {
  double speed = 0, elevation = 0, azimuth = 0, spin = 0, tilt = 0;
  double gyro = 0;  ///< rad/s, spin along the way (a bullet's), right-handed
};
CAROM_API BallState launch_state(const Launch& launch, Vec3d position = {});
CAROM_API Launch launch_of(const BallState& state);

/// A flight as nodes with polynomials between them: ask it at any time.
class CAROM_API BallFlight {
 public:
  struct Node {
    double time = 0;  ///< s
    BallState state{}, rate{};
  };
  struct Point : BallState {
    double time = 0;  ///< s since the start
  };

  BallFlight() = default;
  explicit BallFlight(std::vector<Node> nodes) : nodes_(std::move(nodes)) {}
  const std::vector<Node>& nodes() const { return nodes_; }
  double duration() const { return nodes_.empty() ? 0 : nodes_.back().time; }
  /// Times before the start and after the end give those.
  Point at(double time) const;
  Point start() const { return at(0); }
  Point end() const { return at(duration()); }
  Point apex() const;  ///< the highest point
  /// The first time at which `value` (of a point) passes through zero; empty where it never does.
  std::optional<Point> first(core::FunctionRef<double(const Point&)> value) const;
  /// The first point at x, in the frame of the shot.
  std::optional<Point> at_x(double x) const;
  /// The state at a time between two nodes.
  static Point between(const Node& a, const Node& b, double time);

 private:
  std::vector<Node> nodes_;
};

struct FlightLimits {
  double time = 60;         ///< s
  double tolerance = 1e-9;  ///< of a step, relative
};
/// From `start` at `time` 0 until `stop` (of time and state) passes from positive to zero, or the limit.
/// Errors: a ball, start or limit that cannot be, or a flight that cannot be integrated.
CAROM_API core::Result<BallFlight> fly_until(const Ball& ball, const Conditions& conditions, const BallState& start,
                                             core::FunctionRef<double(double, const BallState&)> stop,
                                             const FlightLimits& limits = {});
/// From `start` to the way down through the height `ground` (m).
CAROM_API core::Result<BallFlight> fly(const Ball& ball, const Conditions& conditions, const BallState& start,
                                       double ground = 0, const FlightLimits& limits = {});

/// What is told of a shot.
struct Landing {
  double carry = 0;  ///< m along x, from the start
  double side = 0;   ///< m to the right
  double apex = 0;   ///< m above the start
  double time = 0;   ///< s
  double angle = 0;  ///< rad below the horizon
  double speed = 0;  ///< m/s
  double spin = 0;   ///< rad/s
};
CAROM_API Landing landing(const BallFlight& flight);

}  // namespace carom::sports

namespace carom::ode {
template <>
inline constexpr int components<sports::BallState> = 10;
}
