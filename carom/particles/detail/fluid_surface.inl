// Surface tension: the pressure at the free surface is σκ (Laplace) where the ghost fluid method has it zero without.
#pragma once

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/fluid_solver.inl"

namespace carom::particles::detail {

namespace {
constexpr int most_ripples = 64;  // substeps that the shortest ripples may ask for
}

/// The shortest ripple must not run over a cell in a substep: dt² < ρ h³/(4πσ) (J. U. Brackbill, D. B. Kothe, C.
/// Zemach, J. Comput. Phys. 100 (1992) 335, with nothing above the surface).
template <class D>
int FluidState<D>::capillary_substeps(float dt) const {
  if (!(definition.surface_tension > 0)) return 1;
  const double limit =
      math::sqrt(double(definition.density) * cell * cell * cell / (4 * math::pi * double(definition.surface_tension)));
  const double parts = math::ceil(double(dt) / limit);
  return parts < 1e6 ? math::max(1, int(parts)) : 1000000;
}

/// Curvature of the levels of how full the cells are, smoothed: κ = (∇fᵀ H ∇f − |∇f|² Δf)/|∇f|³, the sum of the
/// principal curvatures, positive for a drop. What is closed is as full as what is beside it: the surface meets it at
/// a right angle.
template <class D>
void FluidState<D>::measure_curvature() {
  if (!(definition.surface_tension > 0)) return;
  const FluidRange all = whole();
  // The margin counts as the cell before it.
  const auto extend = [&](std::vector<float>& field) {
    for_cells(grid, all, [&](int i, int j, int k, int c) {
      const int at[3] = {i, j, k};
      for (int a = 0; a < N; ++a) {
        if (at[a] == 0) field[c - grid.stride[a]] = field[c];
        if (at[a] + 1 == grid.cells[a]) field[c + grid.stride[a]] = field[c];
      }
    });
  };
  for_cells(grid, all, [&](int, int, int, int c) {
    if (room[c] > 0.05f) {
      smooth[c] = math::min(fill[c], 1.0f);
      return;
    }
    float sum = 0;
    int open_cells = 0;
    for (int a = 0; a < N; ++a)
      for (const int n : {c - grid.stride[a], c + grid.stride[a]})
        if (room[n] > 0.05f) sum += math::min(fill[n], 1.0f), ++open_cells;
    smooth[c] = open_cells > 0 ? sum / float(open_cells) : 0.0f;
  });
  for (int pass = 0; pass < 2; ++pass)
    for (int a = 0; a < N; ++a) {
      extend(smooth);
      for_cells(grid, all, [&](int, int, int, int c) {
        curvature[c] = 0.25f * (smooth[c - grid.stride[a]] + smooth[c + grid.stride[a]]) + 0.5f * smooth[c];
      });
      for_cells(grid, all, [&](int, int, int, int c) { smooth[c] = curvature[c]; });
    }
  extend(smooth);
  for_cells(grid, all, [&](int i, int j, int k, int c) {
    curvature[c] = 0;
    const float* f = smooth.data() + c;
    if (!(f[0] > 0.02f && f[0] < 0.98f)) return;
    const int at[3] = {i, j, k};
    float slope[N], second = 0, square = 0, turned_part = 0;
    float bend[N];
    for (int a = 0; a < N; ++a) {
      const int s = grid.stride[a];
      slope[a] = 0.5f * (f[s] - f[-s]);
      bend[a] = f[s] - 2 * f[0] + f[-s];
      second += bend[a];
      square += slope[a] * slope[a];
    }
    if (!(square > 1e-4f)) return;
    for (int a = 0; a < N; ++a) {
      turned_part += bend[a] * slope[a] * slope[a];
      for (int b = a + 1; b < N; ++b) {
        // At an edge of the grid the corner beyond it is not kept up.
        if (at[a] == 0 || at[b] == 0 || at[a] + 1 == grid.cells[a] || at[b] + 1 == grid.cells[b]) continue;
        const int s = grid.stride[a], t = grid.stride[b];
        const float mixed = 0.25f * ((f[s + t] - f[s - t]) - (f[t - s] - f[-s - t]));
        turned_part += 2 * mixed * slope[a] * slope[b];
      }
    }
    const float kappa = (turned_part - square * second) / (square * math::sqrt(square));
    curvature[c] = math::clamp(kappa, -1.0f, 1.0f);  // what is smaller than a cell is not seen
  });
}

/// P at the surface between a liquid cell and the next, which is air, θ of the way.
template <class D>
float FluidState<D>::surface_pressure(int c, int next, float theta) const {
  if (tension_dt == 0) return 0;
  const float here = curvature[c], there = curvature[next];
  if (here == 0) return tension_dt * there;
  if (there == 0) return tension_dt * here;
  return tension_dt * (here + math::clamp(theta, 0.0f, 1.0f) * (there - here));
}

/// By tension alone a part of the liquid that touches nothing does not move; where its surface ends at a wall, it pulls
/// at the wall as the wall at it.
template <class D>
void FluidState<D>::pull_of_surface() {
  if (tension_dt == 0) return;
  for (Budget& b : budgets) {
    b.surface = {};
    b.held = false;
  }
  for (const int c : liquid) {
    Budget& b = budgets[component[c]];
    for (int a = 0; a < N; ++a)
      for (const int up : {0, 1}) {
        const int face = up ? c + grid.stride[a] : c, next = up ? face : c - grid.stride[a];
        b.held = b.held || open[a][face] < 1;
        if (kind[next] == fluid_liquid || !(open[a][face] > 0)) continue;
        const float theta = level[c] / (level[c] - level[next]);
        const float push = cell_mass * open[a][face] * surface_pressure(c, next, theta);
        b.surface[a] += up ? -push : push;
      }
  }
  for (Budget& b : budgets) {
    if (!b.held) continue;
    b.given -= b.surface;
    wall_impulse -= b.surface;
  }
}

}  // namespace carom::particles::detail
