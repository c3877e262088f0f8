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
  double square = 0;
  float before = 0;
  for (int i = 0; i < n; ++i) {
    float sum = w[i] * scale[i];
    for (int a = 0; a < N - 1; ++a) sum -= below[i].across[a] * r[below[i].cell[a]];
    before = sum - below[i].along * before;
    r[i] = before;
    square += double(before) * double(before);
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
    before = 0;
    for (int i = n - 1; i >= 0; --i) {
      p[i] = r[i] + again * p[i];
      float sum = p[i];
      for (int a = 0; a < N - 1; ++a) sum -= above[i].across[a] * t[above[i].cell[a]];
      before = sum - above[i].along * before;
      t[i] = before;
    }
    // w = t + (I + L)⁻¹ (p + (D − 2 + J) t): into w what is in brackets, then what is solved, in place.
    for (int i = 0; i < n; ++i) w[i] = p[i] + middle[i] * t[i];
    if (bodies_here) add_bodies(s.z, s.product, true);
    before = 0;
    for (int i = 0; i < n; ++i) {
      float sum = w[i];
      for (int a = 0; a < N - 1; ++a) sum -= below[i].across[a] * w[below[i].cell[a]];
      before = sum - below[i].along * before;
      w[i] = before;
    }
    double part[4] = {0, 0, 0, 0};
    for (int i = 0; i < n; ++i) {
      w[i] += t[i];
      part[i & 3] += double(p[i]) * double(w[i]);
    }
    const double curvature = (part[0] + part[1]) + (part[2] + part[3]);
    if (!(curvature > 0)) return false;
    const float way = float(square / curvature);
    double next[4] = {0, 0, 0, 0};
    for (int i = 0; i < n; ++i) {
      s.x[i] += way * (scale[i] * t[i]);
      r[i] -= way * w[i];
      next[i & 3] += double(r[i]) * double(r[i]);
    }
    const double now = (next[0] + next[1]) + (next[2] + next[3]);
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
