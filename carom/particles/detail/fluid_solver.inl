// Conjugate gradients with a modified incomplete Cholesky factor (Bridson, "Fluid Simulation for Computer Graphics",
// 2nd ed. 2015, ch. 5). Rows and unknowns are scaled so that the factors have a unit diagonal and the off-diagonal
// numbers of the matrix itself; then the matrix between its factors costs no more than solving with both (S. C.
// Eisenstat, "Efficient implementation of a class of preconditioned conjugate gradient methods", SIAM J. Sci. Stat.
// Comput. 2 (1981) 1).
#pragma once

#include "carom/particles/detail/fluid_solids.inl"

namespace carom::particles::detail {

/// What pressures x (scaled: in the solver's unknowns) do to a body.
template <class D>
void FluidState<D>::push_of(const FluidBody<D>& body, const std::vector<float>& x, bool scaled, Vector& force,
                            Angular& torque) const {
  double f[3] = {0, 0, 0}, t[3] = {0, 0, 0};
  for (int k = 0; k < body.cell_count; ++k) {
    const FluidTouch<N>& touch = system.touched[body.first_cell + k];
    const double p = scaled ? x[touch.cell] * system.scale[touch.cell] : x[touch.cell];
    for (int a = 0; a < N; ++a) f[a] += p * touch.area[a];
    for (int a = 0; a < (N == 2 ? 1 : 3); ++a) t[a] += p * touch.moment[a];
  }
  for (int a = 0; a < N; ++a) force[a] = cell_mass * float(f[a]);
  if constexpr (N == 2)
    torque = cell_mass * float(t[0]);
  else
    torque = cell_mass * Vec3f{float(t[0]), float(t[1]), float(t[2])};
}

/// y += Jᵀ M⁻¹ J x of all bodies that move.
template <class D>
void FluidState<D>::add_bodies(const std::vector<float>& x, std::vector<float>& y, bool scaled) {
  const FluidSystem<N>& s = system;
  for (const FluidBody<D>& body : bodies) {
    if (!body.moves || body.cell_count == 0) continue;
    Vector force{};
    Angular torque{};
    push_of(body, x, scaled, force, torque);
    Vector way{};
    for (int a = 0; a < N; ++a) way[a] = body.inverse_mass[a] * force[a];
    const Angular turn = body.inverse_inertia * torque;
    for (int k = 0; k < body.cell_count; ++k) {
      const FluidTouch<N>& touch = s.touched[body.first_cell + k];
      float sum = 0;
      for (int a = 0; a < N; ++a) sum += touch.area[a] * way[a];
      if constexpr (N == 2)
        sum += touch.moment[0] * turn;
      else
        for (int a = 0; a < 3; ++a) sum += touch.moment[a] * turn[a];
      y[touch.cell] += scaled ? sum * s.scale[touch.cell] : sum;
    }
  }
}

template <class D>
void FluidState<D>::apply_rows(const std::vector<float>& x, std::vector<float>& y, bool with_bodies) {
  const FluidSystem<N>& s = system;
  const int n = int(s.rows.size());
  parallel(n, 4096, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const FluidRow<N>& row = s.rows[i];
      float sum = row.diagonal * x[i];
      for (int a = 0; a < N; ++a) sum += row.minus[a] * x[row.minus_cell[a]] + row.plus[a] * x[row.plus_cell[a]];
      y[i] = sum;
    }
  });
  if (with_bodies) add_bodies(x, y, false);
}

template <class D>
void FluidState<D>::factorise() {
  constexpr float tuning = 0.97f, safety = 0.25f;
  FluidSystem<N>& s = system;
  const int n = int(s.rows.size());
  s.below.resize(n);
  s.above.resize(n);
  for (int i = 0; i < n; ++i) {
    const FluidRow<N>& row = s.rows[i];
    float e = row.diagonal;
    for (int a = 0; a < N; ++a) {
      const int j = row.minus_cell[a];
      const float q = s.scale[j];
      if (row.minus[a] == 0) continue;
      const float t = row.minus[a] * q;
      e -= t * t;
      float others = 0;
      for (int b = 0; b < N; ++b)
        if (b != a) others += s.rows[j].plus[b];
      e -= tuning * row.minus[a] * others * q * q;
    }
    if (e < safety * row.diagonal) e = row.diagonal;
    s.scale[i] = e > 0 ? 1 / math::sqrt(e) : 0.0f;
    s.inverse_scale[i] = e > 0 ? math::sqrt(e) : 0.0f;
    s.middle[i] = s.scale[i] * s.scale[i] * row.diagonal - 2;
  }
  for (int i = 0; i < n; ++i) {
    const FluidRow<N>& row = s.rows[i];
    s.below[i].along = row.minus[0] * s.scale[row.minus_cell[0]] * s.scale[i];
    s.above[i].along = row.plus[0] * s.scale[row.plus_cell[0]] * s.scale[i];
    for (int a = 1; a < N; ++a) {
      s.below[i].cell[a - 1] = row.minus_cell[a];
      s.above[i].cell[a - 1] = row.plus_cell[a];
      s.below[i].across[a - 1] = row.minus[a] * s.scale[row.minus_cell[a]] * s.scale[i];
      s.above[i].across[a - 1] = row.plus[a] * s.scale[row.plus_cell[a]] * s.scale[i];
    }
  }
  find_runs(true);
  find_runs(false);
}

template <class D>
void FluidState<D>::find_runs(bool up) {
  FluidSystem<N>& s = system;
  const std::vector<FluidLinks<N>>& links = up ? s.below : s.above;
  std::vector<FluidRuns>& list = up ? s.up : s.down;
  const int n = int(s.rows.size()), sign = up ? 1 : -1;
  list.clear();
  for (int row = up ? 0 : n - 1; row >= 0 && row < n;) {
    FluidRuns runs;
    runs.last = n;
    for (int k = 0; k < FluidRuns::together && row >= 0 && row < n; ++k) {
      runs.base[k] = row;
      do {
        // What it hangs on of the runs before this one in the group.
        for (int a = 0; a < N - 1; ++a) {
          const int on = links[row].cell[a];
          if (links[row].across[a] == 0) continue;
          for (int j = 0; j < k; ++j) {
            const int place = sign * (on - runs.base[j]);
            if (place >= 0 && place < runs.count[j])
              runs.lag[k] = math::max(runs.lag[k], runs.lag[j] + place - runs.count[k] + 1);
          }
        }
        ++runs.count[k];
        row += sign;
      } while (row >= 0 && row < n && links[row].along != 0);
    }
    for (int k = 0; k < FluidRuns::together; ++k) {
      runs.first = math::max(runs.first, runs.lag[k]);
      runs.last = math::min(runs.last, runs.lag[k] + runs.count[k]);
      runs.end = math::max(runs.end, runs.lag[k] + runs.count[k]);
    }
    list.push_back(runs);
  }
}

/// f(row, what it gave for the row before) for all rows, up or down.
template <bool up, class F>
[[gnu::always_inline]] inline void in_step(const std::vector<FluidRuns>& list, F&& f) {
  constexpr int sign = up ? 1 : -1;
  for (const FluidRuns& runs : list) {
    float before[FluidRuns::together] = {};
    const auto some = [&](int from, int to) {
      for (int step = from; step < to; ++step)
        for (int k = 0; k < FluidRuns::together; ++k) {
          const int m = step - runs.lag[k];
          if (m >= 0 && m < runs.count[k]) before[k] = f(runs.base[k] + sign * m, before[k]);
        }
    };
    if (runs.last <= runs.first) {
      some(0, runs.end);
      continue;
    }
    some(0, runs.first);
    float a = before[0], b = before[1], c = before[2], d = before[3];
    int i = runs.base[0] + sign * (runs.first - runs.lag[0]), j = runs.base[1] + sign * (runs.first - runs.lag[1]);
    int k = runs.base[2] + sign * (runs.first - runs.lag[2]), l = runs.base[3] + sign * (runs.first - runs.lag[3]);
    for (int step = runs.first; step < runs.last; ++step, i += sign, j += sign, k += sign, l += sign) {
      a = f(i, a);
      b = f(j, b);
      c = f(k, c);
      d = f(l, d);
    }
    before[0] = a, before[1] = b, before[2] = c, before[3] = d;
    some(runs.last, runs.end);
  }
}

/// Σ f(i), in double, by four sums in turn.
template <class F>
[[gnu::always_inline]] inline double sum_of_rows(int n, F&& f) {
  double a = 0, b = 0, c = 0, d = 0;
  int i = 0;
  for (; i + 4 <= n; i += 4) {
    a += f(i);
    b += f(i + 1);
    c += f(i + 2);
    d += f(i + 3);
  }
  if (i < n) a += f(i);
  if (i + 1 < n) b += f(i + 1);
  if (i + 2 < n) c += f(i + 2);
  return (a + b) + (c + d);
}

/// The largest residual of the rows as they are, from that between the factors.
template <class D>
float FluidState<D>::true_residual() const {
  const FluidSystem<N>& s = system;
  const int n = int(s.rows.size());
  const float* r = s.residual.data();
  float worst = 0, before = 0;
  for (int i = 0; i < n; ++i) {
    const FluidLinks<N>& link = s.below[i];
    float sum = r[i] + link.along * before;
    for (int a = 0; a < N - 1; ++a) sum += link.across[a] * r[link.cell[a]];
    before = r[i];
    worst = math::max(worst, math::abs(sum * s.inverse_scale[i]));
  }
  return worst;
}

/// From `system.x` on until no cell's divergence is above `tolerance` (m/s, or cells).
template <class D>
bool FluidState<D>::solve(float tolerance, int limit, bool with_bodies, int& iterations, float& left) {
  FluidSystem<N>& s = system;
  const int n = int(s.rows.size());
  apply_rows(s.x, s.product, with_bodies);
  float start = 0;
  for (int i = 0; i < n; ++i) {
    s.product[i] = s.right[i] - s.product[i];
    start = math::max(start, math::abs(s.product[i]));
  }
  left = start;
  if (start <= tolerance) return true;

  // r ← (I + L)⁻¹ r, with L the scaled part below the diagonal.
  float *r = s.residual.data(), *p = s.search.data(), *w = s.product.data(), *t = s.z.data();
  const float *scale = s.scale.data(), *middle = s.middle.data();
  const FluidLinks<N>*below = s.below.data(), *above = s.above.data();
  in_step<true>(s.up, [=](int i, float before) {
    float sum = w[i] * scale[i];
    for (int a = 0; a < N - 1; ++a) sum -= below[i].across[a] * r[below[i].cell[a]];
    return r[i] = sum - below[i].along * before;
  });
  double square = 0;
  for (int i = 0; i < n; ++i) {
    square += double(r[i]) * double(r[i]);
    p[i] = 0;
  }
  const double first = square;
  float again = 0;
  bool bodies_here = false;
  for (const FluidBody<D>& body : bodies) bodies_here = bodies_here || (body.moves && body.cell_count > 0);
  bodies_here = bodies_here && with_bodies;
  w[n] = r[n] = p[n] = t[n] = 0;
  for (int iteration = 0; iteration < limit; ++iteration) {
    ++iterations;
    // p ← r + β p, t = (I + Lᵀ)⁻¹ p
    in_step<false>(s.down, [=](int i, float before) {
      float sum = p[i] = r[i] + again * p[i];
      for (int a = 0; a < N - 1; ++a) sum -= above[i].across[a] * t[above[i].cell[a]];
      return t[i] = sum - above[i].along * before;
    });
    // w = t + (I + L)⁻¹ (p + (D − 2 + J) t): into w what is in brackets, then what is solved, in place.
    for (int i = 0; i < n; ++i) w[i] = p[i] + middle[i] * t[i];
    if (bodies_here) add_bodies(s.z, s.product, true);
    in_step<true>(s.up, [=](int i, float before) {
      float sum = w[i];
      for (int a = 0; a < N - 1; ++a) sum -= below[i].across[a] * w[below[i].cell[a]];
      return w[i] = sum - below[i].along * before;
    });
    const double curvature = sum_of_rows(n, [=](int i) {
      w[i] += t[i];
      return double(p[i]) * double(w[i]);
    });
    if (!(curvature > 0)) return false;
    const float way = float(square / curvature);
    float* const x = s.x.data();
    const double now = sum_of_rows(n, [=](int i) {
      x[i] += way * (scale[i] * t[i]);
      r[i] -= way * w[i];
      return double(r[i]) * double(r[i]);
    });
    again = float(now / square);
    square = now;
    // The rows' own residual takes a look of its own: only where this one says that it may be small enough.
    if (iteration + 1 == limit ||
        double(start) * double(start) * now <= 4.0 * double(tolerance) * double(tolerance) * first) {
      left = true_residual();
      if (left <= tolerance) return true;
    }
  }
  return false;
}

}  // namespace carom::particles::detail
