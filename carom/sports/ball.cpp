#include "carom/sports/ball.h"

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "carom/sports/detail/number_fields.h"

namespace carom::sports {
namespace {

/// 1 below the crisis, 0 above it.
double laminar(const DragLaw& law, double reynolds) {
  if (law.crisis == 0 && law.critical_reynolds <= 0) return 0;
  return 1 / (1 + math::pow(reynolds / law.critical_reynolds, law.steepness));
}

struct Cell {
  std::size_t index;
  double part;
};
Cell cell_of(const std::vector<double>& nodes, double x) {
  const std::size_t last = nodes.size() - 1;
  if (x <= nodes.front() || last == 0) return {0, 0};
  if (x >= nodes.back()) return {last - 1, 1};
  std::size_t i = 0;
  while (x > nodes[i + 1]) ++i;
  return {i, (x - nodes[i]) / (nodes[i + 1] - nodes[i])};
}

Coefficients read(const CoefficientGrid& grid, double speed, double spin) {
  const Cell v = cell_of(grid.speeds, speed), w = cell_of(grid.spins, spin);
  const std::size_t columns = grid.speeds.size();
  const auto at = [&](const std::vector<double>& values) {
    const auto along = [&](std::size_t row) {
      const double a = values[row * columns + v.index];
      return v.part == 0 ? a : a + v.part * (values[row * columns + v.index + 1] - a);
    };
    const double a = along(w.index);
    return w.part == 0 ? a : a + w.part * (along(w.index + 1) - a);
  };
  return {at(grid.drag), at(grid.lift)};
}

/// The side force as a multiple of ½ ρ A V².
Vec3d side_coefficient(const Ball& ball, const Air& air, const BallMotion& motion, double speed) {
  const SideForce& side = ball.side;
  const Vec3d along = motion.velocity / speed;
  switch (side.kind) {
    case SideForce::Kind::none:
      break;
    case SideForce::Kind::held_seam: {
      const double sine = -math::dot(side.seam_normal, along);
      const Vec3d across = side.seam_normal + sine * along;
      const double size = math::length(across);
      if (!(size > 1e-12)) break;
      const double angle = math::asin(math::clamp(sine, -1.0, 1.0)) / side.best_angle;
      double turn = 1;
      if (side.reverse_reynolds > 0)
        turn = 2 / (1 + math::pow(reynolds(ball, air, speed) / side.reverse_reynolds, 12.0)) - 1;
      return (side.coefficient * turn * angle * math::exp(0.5 * (1 - angle * angle)) / size) * across;
    }
    case SideForce::Kind::turning_seam: {
      const Vec3d across = math::cross(motion.spin, motion.velocity);
      const double size = math::length(across);
      if (!(size > 1e-12)) break;
      return (side.coefficient * math::sin(side.cycles * motion.turned) / size) * across;
    }
    case SideForce::Kind::wandering_wake: {
      // Two directions across: level, and upright to it.
      Vec3d level = math::cross(along, Vec3d{0, 1, 0});
      const double size = math::length(level);
      level = size > 1e-6 ? level / size : Vec3d{0, 0, 1};
      const Vec3d upright = math::cross(level, along);
      const double rate = 2 * math::pi * side.strouhal * speed / (2 * ball.radius);
      constexpr double ratios[] = {0.618033988749895, 1, 1.272019649514069};
      math::Random random(side.seed);
      double sum[2] = {};
      for (double& s : sum)
        for (const double ratio : ratios) s += math::sin(ratio * rate * motion.time + random.uniform(0, 2 * math::pi));
      return (side.coefficient / 3) * (sum[0] * level + sum[1] * upright);
    }
  }
  return {};
}

}  // namespace

Coefficients coefficients(const Ball& ball, const Air& air, double speed, double spin) {
  if (!ball.grid.speeds.empty()) return read(ball.grid, speed, spin);
  if (!(speed > 0)) return {ball.drag.fast + ball.drag.crisis, 0};
  const double s = spin * ball.radius / speed, slow = laminar(ball.drag, reynolds(ball, air, speed));
  const double x = s / ball.drag.spin_scale;
  Coefficients c;
  c.drag = ball.drag.fast + ball.drag.crisis * slow + ball.drag.spin_slope * s;
  if (ball.drag.spin_rise != 0) c.drag += ball.drag.spin_rise * (1 - math::exp(-x * x));
  if (ball.lift.maximum != 0) {
    const double shape = ball.lift.shape == LiftLaw::Shape::hyperbolic ? math::tanh(s / ball.lift.spin_scale)
                                                                       : s / (s + ball.lift.spin_scale);
    c.lift = ball.lift.maximum * shape * (1 - ball.lift.fade * slow);
  }
  return c;
}

forces::Wrench3 air_load(const Ball& ball, const Air& air, const BallMotion& motion) {
  const double speed = math::length(motion.velocity);
  if (!(speed > 1e-9)) return {};
  const Vec3d turn = math::cross(motion.spin, motion.velocity);
  const double across = math::length(turn) / speed;  // rad/s, the spin that makes lift
  const Coefficients c = coefficients(ball, air, speed, across);
  const double pressure_area = 0.5 * air.density * area(ball) * speed * speed;
  forces::Wrench3 load;
  load.force = (-pressure_area * c.drag / speed) * motion.velocity;
  if (across > 1e-12 && c.lift != 0) load.force += (pressure_area * c.lift / (across * speed)) * turn;
  if (ball.side.kind != SideForce::Kind::none) load.force += pressure_area * side_coefficient(ball, air, motion, speed);
  load.moment = (-0.5 * air.density * area(ball) * ball.radius * ball.radius * ball.spin_damping * speed) * motion.spin;
  return load;
}

double terminal_speed(const Ball& ball, const Air& air, double gravity) {
  const auto excess = [&](double v) {
    return 0.5 * air.density * area(ball) * coefficients(ball, air, v, 0).drag * v * v - ball.mass * gravity;
  };
  double low = 0, high = 0.1;
  while (excess(high) < 0 && high < 1e4) {
    low = high;
    high *= 1.05;
  }
  for (int i = 0; i < 80; ++i) {
    const double middle = 0.5 * (low + high);
    (excess(middle) < 0 ? low : high) = middle;
  }
  return high;
}

double smooth_sphere_drag(double re) {
  const double a = re / 5, b = re / 2.63e5, c = re / 1e6;
  return 24 / re + 2.6 * a / (1 + math::pow(a, 1.52)) + 0.411 * math::pow(b, -7.94) / (1 + math::pow(b, -8.0)) +
         0.25 * c / (1 + c);
}
double schiller_naumann_drag(double re) { return 24 / re * (1 + 0.15 * math::pow(re, 0.687)); }
double ideal_cylinder_lift(double density, double speed, double radius, double spin) {
  return density * speed * 2 * math::pi * radius * radius * spin;
}
double ideal_sphere_lift(double density, double speed, double radius, double spin) {
  return math::pi * density * speed * radius * radius * radius * spin;
}

core::Status check(const Ball& ball) {
  if (const core::Status fields = detail::check_fields(ball, "a ball"); !fields) return fields;
  const Vec3d n = ball.side.seam_normal;
  if (!(math::abs(math::length(n) - 1) < 1e-6))
    return core::Error{core::refused("length of side.seam_normal of a ball", math::length(n), "1")};
  const CoefficientGrid& grid = ball.grid;
  if (grid.speeds.empty() && grid.spins.empty() && grid.drag.empty() && grid.lift.empty()) return {};
  const std::size_t cells = grid.speeds.size() * grid.spins.size();
  if (cells == 0 || grid.drag.size() != cells || grid.lift.size() != cells)
    return core::Error{core::text("the grid of a ball has ", grid.drag.size(), " drag and ", grid.lift.size(),
                                  " lift coefficients, expected ", cells, " of each: spins times speeds")};
  for (const auto* nodes : {&grid.speeds, &grid.spins})
    for (std::size_t i = 0; i < nodes->size(); ++i)
      if (!math::is_finite((*nodes)[i]) || (i > 0 && !((*nodes)[i] > (*nodes)[i - 1])))
        return core::Error{core::text("node ", i + 1, " of the grid of a ball is ", (*nodes)[i],
                                      ", expected finite numbers that rise")};
  for (std::size_t i = 0; i < cells; ++i)
    if (!math::is_finite(grid.drag[i]) || !math::is_finite(grid.lift[i]))
      return core::Error{core::text("cell ", i + 1, " of the grid of a ball is not finite")};
  return {};
}

}  // namespace carom::sports
