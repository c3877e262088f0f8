#include "carom/ballistics/shell.h"

#include "carom/ballistics/detail/shell_motion.h"
#include "carom/core/string.h"
#include "carom/ode/dormand_prince.h"
#include "carom/ode/methods.h"

namespace carom::ballistics {

using math::Vec3d;

Shell m107() {
  return {.mass = 43.4545,
          .diameter = .155,
          .axial_inertia = .14705,
          .transverse_inertia = 1.28888,
          .twist = 20,
          .aerodynamics = {{0, .144, 2.343, 1.763, -.767, -.023, 3.355, -5.1, -.500},
                           {.6, .144, 2.343, 1.763, -.767, -.023, 3.378, -5.1, -.500},
                           {.8, .146, 2.847, 1.783, -.767, -.022, 3.571, -5.1, -.355},
                           {.9, .167, 3.372, 1.827, -.857, -.021, 3.957, -7.4, -.112},
                           {.95, .221, 3.730, 2.038, -1.082, -.020, 3.886, -9.9, .085},
                           {1, .327, 4.180, 2.153, -.992, -.020, 3.682, -13.8, .198},
                           {1.05, .383, 4.691, 2.207, -.902, -.020, 3.415, -13.3, .293},
                           {1.1, .381, 5.209, 2.255, -.857, -.019, 3.384, -14.6, .334},
                           {1.2, .370, 5.702, 2.325, -.767, -.020, 3.424, -15.8, .352},
                           {1.35, .353, 5.130, 2.442, -.767, -.020, 3.278, -15.6, .366},
                           {1.5, .338, 4.561, 2.556, -.767, -.020, 3.264, -15.3, .373},
                           {1.75, .314, 3.970, 2.692, -.767, -.020, 3.201, -15.3, .381},
                           {2, .294, 3.460, 2.747, -.767, -.021, 3.013, -15.3, .388}},
          .length = 4.5 * .155,
          .centre = 2.96 * .155};
}

std::span<const ShellPreset> shell_presets() {
  static const std::vector<ShellPreset> list = {
      {"155mm_m107",
       "155 mm high explosive shell M107, 95.8 lb, spin-stabilised; charges 4, 6 and 8.",
       "mass, inertia and aerodynamics: BRL MR-1582 (AD0454925), table 11 of Lim, NPS thesis AD1029824",
       m107(),
       {337, 474, 684}}};
  return list;
}

core::Status check(const Shell& shell) {
  const struct {
    const char* name;
    double value;
  } positive[] = {{"mass", shell.mass},
                  {"diameter", shell.diameter},
                  {"axial_inertia", shell.axial_inertia},
                  {"transverse_inertia", shell.transverse_inertia}};
  for (const auto& field : positive)
    if (!(field.value > 0) || !math::is_finite(field.value))
      return core::Error{core::text("shell: ", core::refused(field.name, field.value, "a finite number > 0"))};
  for (const auto& [name, value] : {std::pair{"length", shell.length}, {"centre", shell.centre}})
    if (!(value >= 0 && value <= 1000))
      return core::Error{core::text("shell: ", core::refused(name, value, "0 to 1000 m"))};
  if (shell.length > 0 && !(shell.centre < shell.length))
    return core::Error{
        core::text("shell: ", core::refused("centre", shell.centre, "less than the length, m from the nose"))};
  if (!math::is_finite(shell.twist) || shell.twist == 0)
    return core::Error{core::text("shell: ", core::refused("twist", shell.twist, "calibres a turn, not zero"))};
  if (shell.aerodynamics.empty()) return core::Error{"shell: no aerodynamic coefficients, expected at least one row"};
  for (std::size_t i = 0; i < shell.aerodynamics.size(); ++i) {
    const ShellCoefficients& row = shell.aerodynamics[i];
    const auto refuse = [&](const char* name, double value, const char* expected) {
      return core::Error{core::text("shell: aerodynamics row ", i + 1, ": ", core::refused(name, value, expected))};
    };
    if (!(row.mach >= 0) || (i > 0 && !(row.mach > shell.aerodynamics[i - 1].mach)))
      return refuse("mach", row.mach, "Mach numbers from 0, rising");
    if (!(row.overturning != 0) || !math::is_finite(row.overturning))
      return refuse("overturning", row.overturning, "a finite number, not zero");
    for (const auto& [name, value] : {std::pair{"axial", row.axial},
                                      {"axial_yaw", row.axial_yaw},
                                      {"normal", row.normal},
                                      {"magnus_force", row.magnus_force},
                                      {"roll_damping", row.roll_damping},
                                      {"pitch_damping", row.pitch_damping},
                                      {"magnus_moment", row.magnus_moment}})
      if (!math::is_finite(value)) return refuse(name, value, "a finite number");
  }
  return {};
}

ShellCoefficients coefficients_at(const Shell& shell, double mach) {
  const auto& rows = shell.aerodynamics;
  if (rows.empty()) return {};
  if (!(mach > rows.front().mach)) return rows.front();
  if (mach >= rows.back().mach) return rows.back();
  std::size_t i = 1;
  while (rows[i].mach < mach) ++i;
  const ShellCoefficients &a = rows[i - 1], &b = rows[i];
  const double t = (mach - a.mach) / (b.mach - a.mach);
  const auto between = [t](double x, double y) { return x + t * (y - x); };
  return {mach,
          between(a.axial, b.axial),
          between(a.axial_yaw, b.axial_yaw),
          between(a.normal, b.normal),
          between(a.magnus_force, b.magnus_force),
          between(a.roll_damping, b.roll_damping),
          between(a.overturning, b.overturning),
          between(a.pitch_damping, b.pitch_damping),
          between(a.magnus_moment, b.magnus_moment)};
}

double muzzle_spin(const Shell& shell, double speed) { return 2 * math::pi * speed / (shell.twist * shell.diameter); }

double gyroscopic_stability(const Shell& shell, double spin, double density, double speed, double mach) {
  const double s = detail::frontal_area(shell);
  return math::square(shell.axial_inertia * spin) / (2 * density * shell.transverse_inertia * s * shell.diameter *
                                                     speed * speed * coefficients_at(shell, mach).overturning);
}

Vec3d yaw_of_repose(const Shell& shell, double spin, double density, Vec3d velocity, Vec3d acceleration,
                    double overturning) {
  const double v2 = math::length_squared(velocity);
  return (-2 * shell.axial_inertia * spin /
          (density * detail::frontal_area(shell) * shell.diameter * overturning * v2 * v2)) *
         math::cross(velocity, acceleration);
}

namespace detail {

core::Status check(const FlightPoint& start, const FlightLimits& limits) {
  const struct {
    const char* name;
    double value;
  } positive[] = {{"speed at the muzzle", math::length(start.velocity)},
                  {"time limit", limits.time},
                  {"tolerance", limits.tolerance}};
  for (const auto& field : positive)
    if (!(field.value > 0) || !math::is_finite(field.value))
      return core::Error{core::text("shell: ", core::refused(field.name, field.value, "a finite number > 0"))};
  return {};
}

template <class S, class Derivative, class Record>
core::Result<ShellFlight> integrate(const S& first, const FlightPoint& start, const FlightLimits& limits,
                                    double longest_step, const Derivative& derivative, const Record& record) {
  ode::DormandPrince<S> solver(
      0, first,
      {.relative_tolerance = limits.tolerance, .absolute_tolerance = limits.tolerance, .maximum_step = longest_step});
  std::vector<Trajectory::Node> nodes;
  std::vector<ShellState> states;
  const auto add = [&] {
    const S d = derivative(solver.t(), solver.y());
    nodes.push_back({solver.t(), solver.y().position, d.position, d.velocity});
    states.push_back(record(solver.t(), solver.y()));
  };
  const auto remaining = [&](const S& s) {
    const double flown = math::hypot(s.position.x - start.position.x, s.position.z - start.position.z);
    const double height = s.velocity.y < 0 ? s.position.y - limits.ground : 1e300;
    return math::min(height, limits.distance - flown);
  };
  add();
  while (solver.t() < limits.time) {
    bool found = false;
    const ode::Outcome outcome = solver.advance_to_event(derivative, math::min(solver.t() + longest_step, limits.time),
                                                         [&](double, const S& s) { return remaining(s); }, found,
                                                         {.crossing = ode::Crossing::falling});
    if (outcome != ode::Outcome::done)
      return core::Error{
          core::text("the flight cannot be integrated beyond ", solver.t(), " s: ", ode::to_string(outcome))};
    add();
    if (found || !(remaining(solver.y()) > 0)) break;
  }
  return ShellFlight{Trajectory(std::move(nodes)), std::move(states)};
}

}  // namespace detail

core::Result<ShellFlight> fly_shell(const Shell& shell, const Conditions& conditions, const FlightPoint& start,
                                    ShellModel model, const FlightLimits& limits, Vec3d tip) {
  if (const core::Status good = check(shell); !good) return good.error();
  if (const core::Status good = detail::check(start, limits); !good) return good.error();
  const double spin = muzzle_spin(shell, math::length(start.velocity));
  const auto longest = [&](double step) {
    return conditions.field ? math::min(step, detail::longest_field_step) : step;
  };
  const auto angle = [&](double time, Vec3d axis, Vec3d position, Vec3d velocity) {
    return yaw_of(conditions, {position, velocity, 0, axis, {}}, time);
  };
  if (model == ShellModel::modified_point_mass) {
    return detail::integrate(
        detail::SpinningPoint{start.position, start.velocity, spin}, start, limits, longest(0.25),
        [&](double time, const detail::SpinningPoint& s) {
          return detail::modified_point_mass(shell, conditions, time, s).derivative;
        },
        [&](double time, const detail::SpinningPoint& s) {
          const Vec3d yaw = detail::modified_point_mass(shell, conditions, time, s).yaw;
          const Vec3d w = s.velocity - detail::wind_of(conditions, s.position, time);
          const Vec3d axis = math::normalize(math::normalize(w) + yaw);
          return ShellState{time, s.position, s.velocity, s.spin, axis, angle(time, axis, s.position, s.velocity)};
        });
  }
  const ShellMotion launch = launched(shell, start, spin, model, tip);
  const detail::SymmetricBody first{launch.position, launch.velocity, launch.axis, launch.momentum};
  return detail::integrate(
      first, start, limits, longest(0.05),
      [&](double time, const detail::SymmetricBody& s) { return detail::six_degrees(shell, conditions, time, s); },
      [&](double time, const detail::SymmetricBody& s) {
        const Vec3d e = s.axis / math::length(s.axis);
        return ShellState{time,       s.position,
                          s.velocity, math::dot(s.momentum, e) / shell.axial_inertia,
                          e,          angle(time, e, s.position, s.velocity)};
      });
}

namespace detail {

/// rad/s: the nutation, the swing of a shell that hardly spins, and what it turns by already.
double fastest_turn(const Shell& shell, const Conditions& conditions, const ShellMotion& m, double time) {
  const environment::AirColumn::Air air = conditions.air.at(m.position.y);
  const double speed = math::length(m.velocity - wind_of(conditions, m.position, time));
  const double lever = math::abs(coefficients_at(shell, speed / air.speed_of_sound).overturning);
  const double swing = 0.5 * air.density * speed * speed * frontal_area(shell) * shell.diameter * lever;
  return math::max(shell.axial_inertia * math::abs(m.spin) / shell.transverse_inertia,
                   math::sqrt(swing / shell.transverse_inertia) +
                       math::length(math::cross(m.momentum, m.axis)) / shell.transverse_inertia);
}

}  // namespace detail

ShellMotion launched(const Shell& shell, const FlightPoint& start, double spin, ShellModel model, Vec3d tip) {
  const Vec3d axis = math::normalize(start.velocity);
  ShellMotion motion{start.position, start.velocity, spin, axis, {}};
  if (model == ShellModel::six_degrees)
    motion.momentum =
        (shell.axial_inertia * spin) * axis + shell.transverse_inertia * (tip - math::dot(tip, axis) * axis);
  return motion;
}

ShellMotion flown(const Shell& shell, const Conditions& conditions, ShellModel model, const ShellMotion& motion,
                  double time, double dt) {
  constexpr int most = 4096;
  double parts = dt / detail::longest_field_step;
  if (model == ShellModel::six_degrees)
    parts = math::max(parts, 10 * dt * detail::fastest_turn(shell, conditions, motion, time));
  const int count = parts < most ? int(math::ceil(math::max(parts, 1.0))) : most;
  const double h = dt / count;
  if (model == ShellModel::modified_point_mass) {
    detail::SpinningPoint s{motion.position, motion.velocity, motion.spin};
    const auto slope = [&](double t, const detail::SpinningPoint& at) {
      return detail::modified_point_mass(shell, conditions, t, at).derivative;
    };
    for (int k = 0; k < count; ++k) s = ode::rk4(slope, time + k * h, s, h);
    const Vec3d yaw = detail::modified_point_mass(shell, conditions, time + dt, s).yaw,
                w = s.velocity - detail::wind_of(conditions, s.position, time + dt);
    const Vec3d axis = math::length(w) > 1e-9 ? math::normalize(math::normalize(w) + yaw) : motion.axis;
    return {s.position, s.velocity, s.spin, axis, {}};
  }
  detail::SymmetricBody s{motion.position, motion.velocity, motion.axis, motion.momentum};
  const auto slope = [&](double t, const detail::SymmetricBody& at) {
    return detail::six_degrees(shell, conditions, t, at);
  };
  for (int k = 0; k < count; ++k) s = ode::rk4(slope, time + k * h, s, h);
  const Vec3d e = math::normalize(s.axis);
  return {s.position, s.velocity, math::dot(s.momentum, e) / shell.axial_inertia, e, s.momentum};
}

double yaw_of(const Conditions& conditions, const ShellMotion& motion, double time) {
  const Vec3d w = motion.velocity - detail::wind_of(conditions, motion.position, time);
  return math::atan2(math::length(math::cross(motion.axis, w)), math::dot(motion.axis, w));
}

}  // namespace carom::ballistics
