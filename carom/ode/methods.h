// Fixed-step integrators for ẏ = f(t, y) over one interface (chapter 7; weak points W1, W2 of the classic treatment).
//
// For a value state S the derivative is `S f(double t, const S& y)`; for spans it is
// `void f(double t, std::span<const double> y, std::span<double> derivative)`. Nothing here allocates.
#pragma once

#include <array>
#include <optional>
#include <string_view>

#include "carom/export.h"
#include "carom/ode/detail/implicit.h"
#include "carom/ode/state.h"

namespace carom::ode {

enum class Method {
  euler,                ///< explicit, order 1; gains energy: for comparison only
  semi_implicit_euler,  ///< order 1, symplectic: new velocity first (Motion or spans)
  midpoint,             ///< explicit, order 2
  heun,                 ///< improved Euler, order 2
  rk4,                  ///< classic Runge–Kutta, order 4
  velocity_verlet,      ///< order 2, symplectic and reversible for forces of position (Motion or spans)
  implicit_midpoint,    ///< order 2, symplectic, A-stable
  dormand_prince,       ///< the fifth-order formula with a fixed step; adaptive: dormand_prince.h
};

inline constexpr std::array<std::string_view, 8> method_names = {
    "euler", "semi_implicit_euler", "midpoint",          "heun",
    "rk4",   "velocity_verlet",     "implicit_midpoint", "dormand_prince"};

CAROM_API std::string_view to_string(Method method);
CAROM_API std::optional<Method> method_from_name(std::string_view name);
CAROM_API std::string_view to_string(Outcome outcome);  ///< as the end of a sentence
CAROM_API int order(Method method);
constexpr bool needs_velocities(Method method) {
  return method == Method::semi_implicit_euler || method == Method::velocity_verlet;
}

struct ImplicitOptions {
  double tolerance = 1e-13;  ///< of the slope, relative to its size
  int iterations = 50;       ///< of the fixed point; then Newton's method, where the number of components is known
  int newton_iterations = 12;
};

namespace detail {

inline constexpr int max_stages = 8;

template <class S, class F>
void euler_step(const F& f, double t, S& y, double h, S* k) {
  evaluate(f, t, y, k[0]);
  add(y, h, k[0]);
}
template <class S, class F>
void midpoint_step(const F& f, double t, S& y, double h, S* k) {
  evaluate(f, t, y, k[0]);
  sum(k[1], y, 0.5 * h, k[0]);
  evaluate(f, t + 0.5 * h, k[1], k[0]);
  add(y, h, k[0]);
}
template <class S, class F>
void heun_step(const F& f, double t, S& y, double h, S* k) {
  evaluate(f, t, y, k[0]);
  sum(k[1], y, h, k[0]);
  evaluate(f, t + h, k[1], k[2]);
  add(y, 0.5 * h, k[0]);
  add(y, 0.5 * h, k[2]);
}
template <class S, class F>
void rk4_step(const F& f, double t, S& y, double h, S* k) {
  evaluate(f, t, y, k[0]);
  sum(k[4], y, 0.5 * h, k[0]);
  evaluate(f, t + 0.5 * h, k[4], k[1]);
  sum(k[4], y, 0.5 * h, k[1]);
  evaluate(f, t + 0.5 * h, k[4], k[2]);
  sum(k[4], y, h, k[2]);
  evaluate(f, t + h, k[4], k[3]);
  add(k[1], 1.0, k[2]);
  add(k[0], 2.0, k[1]);
  add(k[0], 1.0, k[3]);
  add(y, h / 6.0, k[0]);
}

/// Coefficients of Dormand & Prince, J. Comput. Appl. Math. 6 (1980) 19–26. Leaves k[0] … k[6] and the new state in
/// `next`; `scratch` is overwritten. k[0] must hold f(t, y).
template <class S, class F>
void dormand_prince_stages(const F& f, double t, const S& y, double h, S* k, S& next, S& scratch) {
  sum(scratch, y, h * (1.0 / 5), k[0]);
  evaluate(f, t + h * (1.0 / 5), scratch, k[1]);
  sum(scratch, y, h * (3.0 / 40), k[0]);
  add(scratch, h * (9.0 / 40), k[1]);
  evaluate(f, t + h * (3.0 / 10), scratch, k[2]);
  sum(scratch, y, h * (44.0 / 45), k[0]);
  add(scratch, h * (-56.0 / 15), k[1]);
  add(scratch, h * (32.0 / 9), k[2]);
  evaluate(f, t + h * (4.0 / 5), scratch, k[3]);
  sum(scratch, y, h * (19372.0 / 6561), k[0]);
  add(scratch, h * (-25360.0 / 2187), k[1]);
  add(scratch, h * (64448.0 / 6561), k[2]);
  add(scratch, h * (-212.0 / 729), k[3]);
  evaluate(f, t + h * (8.0 / 9), scratch, k[4]);
  sum(scratch, y, h * (9017.0 / 3168), k[0]);
  add(scratch, h * (-355.0 / 33), k[1]);
  add(scratch, h * (46732.0 / 5247), k[2]);
  add(scratch, h * (49.0 / 176), k[3]);
  add(scratch, h * (-5103.0 / 18656), k[4]);
  evaluate(f, t + h, scratch, k[5]);
  sum(next, y, h * (35.0 / 384), k[0]);
  add(next, h * (500.0 / 1113), k[2]);
  add(next, h * (125.0 / 192), k[3]);
  add(next, h * (-2187.0 / 6784), k[4]);
  add(next, h * (11.0 / 84), k[5]);
  evaluate(f, t + h, next, k[6]);
}

/// Calls action(position, velocity, derivative's velocity) with the halves of y and k.
template <class S, class Action>
void with_halves(S& y, S& k, Action&& action) {
  if constexpr (std::is_same_v<S, Span>) {
    const std::size_t n = y.size() / 2;
    Span position = y.first(n), velocity = y.subspan(n), acceleration = k.subspan(n);
    action(position, velocity, acceleration);
  } else {
    action(y.position, y.velocity, k.velocity);
  }
}

template <class S, class F>
void semi_implicit_euler_step(const F& f, double t, S& y, double h, S* k) {
  evaluate(f, t, y, k[0]);
  with_halves(y, k[0], [h](auto& position, auto& velocity, auto& acceleration) {
    add(velocity, h, acceleration);
    add(position, h, velocity);
  });
}

/// For forces of velocity the acceleration at the end is taken with a predicted velocity: still of order 2.
template <class S, class F>
void velocity_verlet_step(const F& f, double t, S& y, double h, S* k) {
  evaluate(f, t, y, k[0]);
  copy(k[1], y);
  with_halves(k[1], k[0], [h](auto& position, auto& velocity, auto& acceleration) {
    add(position, h, velocity);
    add(position, 0.5 * h * h, acceleration);
    add(velocity, h, acceleration);
  });
  evaluate(f, t + h, k[1], k[2]);
  if constexpr (std::is_same_v<S, Span>) {
    const std::size_t n = y.size() / 2;
    for (std::size_t i = 0; i < n; ++i) {
      y[i] = k[1][i];
      y[n + i] = y[n + i] + 0.5 * h * (k[0][n + i] + k[2][n + i]);
    }
  } else {
    y.position = k[1].position;
    y.velocity = y.velocity + 0.5 * h * (k[0].velocity + k[2].velocity);
  }
}

template <class S, class F>
Outcome step_in(Method method, const F& f, double t, S& y, double h, S* k, const ImplicitOptions& options,
                Span newton) {
  switch (method) {
    case Method::euler:
      euler_step(f, t, y, h, k);
      return Outcome::done;
    case Method::midpoint:
      midpoint_step(f, t, y, h, k);
      return Outcome::done;
    case Method::heun:
      heun_step(f, t, y, h, k);
      return Outcome::done;
    case Method::rk4:
      rk4_step(f, t, y, h, k);
      return Outcome::done;
    case Method::dormand_prince:
      evaluate(f, t, y, k[0]);
      dormand_prince_stages(f, t, y, h, k, k[7], k[6]);
      copy(y, k[7]);
      return Outcome::done;
    case Method::implicit_midpoint:
      return implicit_midpoint_step(f, t, y, h, k, options.tolerance, options.iterations, options.newton_iterations,
                                    newton);
    case Method::semi_implicit_euler:
    case Method::velocity_verlet:
      if constexpr (is_motion<S> || std::is_same_v<S, Span>) {
        if (size_of(y) % 2 != 0 && std::is_same_v<S, Span>) return Outcome::not_partitioned;
        if (method == Method::semi_implicit_euler)
          semi_implicit_euler_step(f, t, y, h, k);
        else
          velocity_verlet_step(f, t, y, h, k);
        return Outcome::done;
      } else {
        return Outcome::not_partitioned;
      }
  }
  return Outcome::bad_argument;
}

}  // namespace detail

/// One step of length h (s, any sign) from (t, y). On any outcome but `done`, y is unchanged.
template <class S, class F>
  requires(!std::is_same_v<S, std::span<double>>)
[[nodiscard]] Outcome step(Method method, const F& f, double t, S& y, double h, const ImplicitOptions& options = {}) {
  S k[detail::max_stages];
  constexpr std::size_t n = std::size_t(components<S>);
  double newton[detail::newton_size(n) + 1];
  return detail::step_in(method, f, t, y, h, k, options, std::span<double>(newton, detail::newton_size(n)));
}

/// Doubles of workspace that `step` needs for a span state of n components. With `newton`, room for Newton's method
/// in the implicit midpoint as well, which stiff systems need.
constexpr std::size_t workspace_size(std::size_t n, bool newton = true) {
  return std::size_t(detail::max_stages) * n + (newton ? detail::newton_size(n) : 0);
}

/// One step of length h from (t, y) in place, with memory lent by the caller (`workspace_size`).
template <class F>
[[nodiscard]] Outcome step(Method method, const F& f, double t, std::span<double> y, double h,
                           std::span<double> workspace, const ImplicitOptions& options = {}) {
  const std::size_t n = y.size(), stages = std::size_t(detail::max_stages);
  if (workspace.size() < stages * n) return Outcome::bad_argument;
  std::span<double> k[detail::max_stages];
  for (std::size_t i = 0; i < stages; ++i) k[i] = workspace.subspan(i * n, n);
  return detail::step_in(method, f, t, y, h, k, options, workspace.subspan(stages * n));
}

// The explicit methods by name, for value states: `y = ode::rk4(f, t, y, h)`.
template <class S, class F>
S euler(const F& f, double t, S y, double h) {
  S k[1];
  detail::euler_step(f, t, y, h, k);
  return y;
}
template <class S, class F>
S midpoint(const F& f, double t, S y, double h) {
  S k[2];
  detail::midpoint_step(f, t, y, h, k);
  return y;
}
template <class S, class F>
S heun(const F& f, double t, S y, double h) {
  S k[3];
  detail::heun_step(f, t, y, h, k);
  return y;
}
template <class S, class F>
S rk4(const F& f, double t, S y, double h) {
  S k[5];
  detail::rk4_step(f, t, y, h, k);
  return y;
}
template <class Q, class F>
Motion<Q> semi_implicit_euler(const F& f, double t, Motion<Q> y, double h) {
  Motion<Q> k[1];
  detail::semi_implicit_euler_step(f, t, y, h, k);
  return y;
}
template <class Q, class F>
Motion<Q> velocity_verlet(const F& f, double t, Motion<Q> y, double h) {
  Motion<Q> k[3];
  detail::velocity_verlet_step(f, t, y, h, k);
  return y;
}

/// From t₀ to t₁ in `steps` equal steps.
template <class S, class F>
  requires(!std::is_same_v<S, std::span<double>>)
[[nodiscard]] Outcome integrate(Method method, const F& f, double t0, double t1, int steps, S& y,
                                const ImplicitOptions& options = {}) {
  if (steps < 1) return Outcome::bad_argument;
  const double h = (t1 - t0) / steps;
  for (int i = 0; i < steps; ++i) {
    const Outcome outcome = step(method, f, t0 + i * h, y, h, options);
    if (outcome != Outcome::done) return outcome;
  }
  return Outcome::done;
}

}  // namespace carom::ode
