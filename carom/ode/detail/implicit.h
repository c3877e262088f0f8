// The implicit midpoint rule: the slope k solves k = f(t + h/2, y + h/2 k).
#pragma once

#include "carom/ode/state.h"

namespace carom::ode::detail {

/// Doubles that Newton's method needs for n components: the Jacobian, the residual and the right-hand side.
constexpr std::size_t newton_size(std::size_t n) { return n * n + 4 * n; }

/// Solves A x = b in place (A by rows, n×n) with partial pivoting; false where A is singular.
inline bool solve_linear(double* a, double* b, std::size_t n) {
  for (std::size_t column = 0; column < n; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < n; ++row)
      if (math::abs(a[row * n + column]) > math::abs(a[pivot * n + column])) pivot = row;
    const double p = a[pivot * n + column];
    if (!(math::abs(p) > 0) || !math::is_finite(p)) return false;
    if (pivot != column) {
      for (std::size_t i = column; i < n; ++i) {
        const double swapped = a[pivot * n + i];
        a[pivot * n + i] = a[column * n + i];
        a[column * n + i] = swapped;
      }
      const double swapped = b[pivot];
      b[pivot] = b[column];
      b[column] = swapped;
    }
    for (std::size_t row = column + 1; row < n; ++row) {
      const double factor = a[row * n + column] / p;
      if (factor == 0) continue;
      for (std::size_t i = column; i < n; ++i) a[row * n + i] -= factor * a[column * n + i];
      b[row] -= factor * b[column];
    }
  }
  for (std::size_t row = n; row-- > 0;) {
    double x = b[row];
    for (std::size_t i = row + 1; i < n; ++i) x -= a[row * n + i] * b[i];
    b[row] = x / a[row * n + row];
  }
  return true;
}

/// Newton's method on g(k) = k − f(t + h/2, y + h/2 k), Jacobian by forward differences. `k[0]` is the first guess
/// and the result; k[1], k[2] are scratch.
template <class S, class F>
bool newton_midpoint(const F& f, double t, const S& y, double h, S* k, double tolerance, int iterations, Span memory) {
  const std::size_t n = size_of(y);
  double* const jacobian = memory.data();
  double* const slope = jacobian + n * n;
  double* const residual = slope + n;
  double* const shifted = residual + n;
  double* const value = shifted + n;
  evaluate(f, t, y, k[0]);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    unpack(k[0], slope);
    sum(k[1], y, 0.5 * h, k[0]);
    evaluate(f, t + 0.5 * h, k[1], k[2]);
    unpack(k[2], value);
    double size = 0;
    for (std::size_t i = 0; i < n; ++i) {
      residual[i] = slope[i] - value[i];
      size = math::max(size, math::max(math::abs(slope[i]), math::abs(value[i])));
    }
    if (!math::is_finite(size)) return false;
    for (std::size_t column = 0; column < n; ++column) {
      const double delta = 1.5e-8 * math::max(math::abs(slope[column]), math::max(size * 1e-3, 1e-12));
      for (std::size_t i = 0; i < n; ++i) shifted[i] = slope[i];
      shifted[column] += delta;
      pack(shifted, k[0]);
      sum(k[1], y, 0.5 * h, k[0]);
      evaluate(f, t + 0.5 * h, k[1], k[2]);
      unpack(k[2], shifted);
      for (std::size_t row = 0; row < n; ++row)
        jacobian[row * n + column] = (row == column ? 1.0 : 0.0) - (shifted[row] - value[row]) / delta;
    }
    if (!solve_linear(jacobian, residual, n)) return false;
    double change = 0;
    for (std::size_t i = 0; i < n; ++i) {
      slope[i] -= residual[i];
      change = math::max(change, math::abs(residual[i]));
    }
    pack(slope, k[0]);
    if (change <= tolerance * math::max(size, 1e-300)) return true;
  }
  return false;
}

template <class S, class F>
Outcome implicit_midpoint_step(const F& f, double t, S& y, double h, S* k, double tolerance, int iterations,
                               int newton_iterations, Span newton) {
  evaluate(f, t, y, k[0]);
  bool solved = false;
  if constexpr (components < S >> 0 || std::is_same_v<S, Span>) {
    // The change must keep falling: where the fixed point does not contract, more iterations do not help.
    double before = 0;
    for (int iteration = 0; iteration < iterations && !solved; ++iteration) {
      sum(k[1], y, 0.5 * h, k[0]);
      evaluate(f, t + 0.5 * h, k[1], k[2]);
      double change = 0, size = 0;
      bool finite = true;
      for_each_component(k[2], k[0], k[0], [&](double now, double old, double) {
        finite = finite && math::is_finite(now);
        change = math::max(change, math::abs(now - old));
        size = math::max(size, math::abs(now));
      });
      if (!finite) break;
      copy(k[0], k[2]);
      if (change <= tolerance * size || size == 0)
        solved = true;
      else if (iteration > 4 && change > 0.9 * before) {
        solved = change <= 1e-15 * size * 16;  // as far as rounding lets it come
        break;
      }
      before = change;
    }
    if (!solved && newton.size() >= newton_size(size_of(y)) && size_of(y) > 0)
      solved = newton_midpoint(f, t, y, h, k, tolerance * 16, newton_iterations, newton);
  } else {
    // Components unknown: a fixed number of iterations, enough where h·Lipschitz/2 is below one half.
    for (int iteration = 0; iteration < iterations; ++iteration) {
      sum(k[1], y, 0.5 * h, k[0]);
      evaluate(f, t + 0.5 * h, k[1], k[0]);
    }
    solved = true;
  }
  if (!solved) return Outcome::no_convergence;
  add(y, h, k[0]);
  return Outcome::done;
}

}  // namespace carom::ode::detail
