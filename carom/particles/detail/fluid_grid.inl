// Particles to the grid, and which cells are liquid. Included by fluid2.cpp and fluid3.cpp.
#pragma once

#include "carom/math/simd.h"
#include "carom/particles/detail/fluid_state.h"

namespace carom::particles::detail {

inline constexpr int fluid_slab = 4;  // layers of cells that one thread carries to the grid

/// Where a particle stands between grid points: those on whole numbers and those between.
template <int N>
struct FluidStencil {
  int at[2][N];
  float part[2][N];
  explicit FluidStencil(const float (&x)[N]) {
    for (int b = 0; b < N; ++b) {
      at[0][b] = int(x[b]);
      part[0][b] = x[b] - float(at[0][b]);
      const int half = int(x[b] + 0.5f);
      at[1][b] = half - 1;
      part[1][b] = (x[b] + 0.5f) - float(half);
    }
  }
  /// Of component a's faces (a = N: of cell centres) along axis b.
  int low(int a, int b) const { return at[a == b ? 0 : 1][b]; }
  float share(int a, int b) const { return part[a == b ? 0 : 1][b]; }
};

/// A counting sort by cell that leaves out what is no longer in the domain.
template <class D>
void FluidState<D>::sort() {
  const int count = int(particles.size());
  cell_of.resize(particles.size());
  std::fill(cell_start.begin(), cell_start.end(), 0);
  parallel(count, 4096, [&](int begin, int end, int) {
    for (int p = begin; p < end; ++p) {
      int index = grid.first;
      bool inside = true;
      for (int b = 0; b < N; ++b) {
        const float x = particles[p].x[b];
        inside = inside && x > 0 && x < float(grid.cells[b]);
        index += inside ? int(x) * grid.stride[b] : 0;
      }
      for (const FluidDrain<D>& drain : drains) {
        if (!drain.open || !inside) continue;
        bool swallowed = true;
        for (int b = 0; b < N; ++b) {
          const float x = particles[p].x[b];
          swallowed = swallowed && x >= float(drain.lower[b] - definition.lower[b]) * inverse_cell &&
                      x <= float(drain.upper[b] - definition.lower[b]) * inverse_cell;
        }
        inside = !swallowed;
      }
      cell_of[p] = inside ? index : -1;
    }
  });
  for (int p = 0; p < count; ++p)
    if (cell_of[p] >= 0) ++cell_start[cell_of[p] + 1];
  for (int c = 0; c < grid.size; ++c) cell_start[c + 1] += cell_start[c];
  const int kept = cell_start[grid.size];
  sorted.resize(kept);
  for (int p = 0; p < count; ++p)
    if (cell_of[p] >= 0) sorted[cell_start[cell_of[p]]++] = particles[p];
  for (int c = grid.size; c > 0; --c) cell_start[c] = cell_start[c - 1];
  cell_start[0] = 0;
  particles.swap(sorted);
}

namespace {

using Four = math::WideFloat<4>;

/// Mass and momentum of one particle to the faces across component a: two neighbours along x are four floats.
template <int N>
CAROM_SIMD_INLINE void carry_component(const FluidParticle<N>& p, const FluidStencil<N>& s, int a,
                                       const FluidGrid& grid, float* carried) {
  const float* c = p.c + a * N;
  const float fx = s.share(a, 0), fy = s.share(a, 1);
  float value = p.v[a] - c[0] * fx - c[1] * fy;
  int at = grid.first + s.low(a, 0) + s.low(a, 1) * grid.stride[1];
  if constexpr (N == 3) {
    value -= c[2] * s.share(a, 2);
    at += s.low(a, 2) * grid.stride[2];
  }
  const Four values = {{1, value, 1, value + c[0]}}, up = {{0, c[1], 0, c[1]}};
  const Four weights = {{1 - fx, 1 - fx, fx, fx}};
  const auto add = [&](int index, float weight, Four v) {
    float* to = carried + 2 * index;
    (Four::load(to) + weights * Four::splat(weight) * v).store(to);
  };
  if constexpr (N == 2) {
    add(at, 1 - fy, values);
    add(at + grid.stride[1], fy, values + up);
  } else {
    const float fz = s.share(a, 2);
    const Four deep = {{0, c[2], 0, c[2]}};
    add(at, (1 - fy) * (1 - fz), values);
    add(at + grid.stride[1], fy * (1 - fz), values + up);
    add(at + grid.stride[2], (1 - fy) * fz, values + deep);
    add(at + grid.stride[1] + grid.stride[2], fy * fz, values + up + deep);
  }
}

template <int N>
CAROM_SIMD_INLINE void carry_mass(const FluidStencil<N>& s, const FluidGrid& grid, float* mass) {
  const float fx = s.share(N, 0), fy = s.share(N, 1);
  int at = grid.first + s.low(N, 0) + s.low(N, 1) * grid.stride[1];
  const auto add = [&](int index, float weight) {
    mass[index] += (1 - fx) * weight;
    mass[index + 1] += fx * weight;
  };
  if constexpr (N == 2) {
    add(at, 1 - fy);
    add(at + grid.stride[1], fy);
  } else {
    at += s.low(N, 2) * grid.stride[2];
    const float fz = s.share(N, 2);
    add(at, (1 - fy) * (1 - fz));
    add(at + grid.stride[1], fy * (1 - fz));
    add(at + grid.stride[2], (1 - fy) * fz);
    add(at + grid.stride[1] + grid.stride[2], fy * fz);
  }
}

}  // namespace

/// Every second slab of layers at a time, so that no two threads add to the same place, and always in the same order.
template <class D>
void FluidState<D>::to_grid() {
  for (auto& field : carried) std::fill(field.begin(), field.end(), 0.0f);
  std::fill(mass.begin(), mass.end(), 0.0f);
  const int layers = grid.cells[N - 1], stride = grid.stride[N - 1];
  const int slabs = (layers + fluid_slab - 1) / fluid_slab;
  for (int odd = 0; odd < 2; ++odd) {
    parallel((slabs + 1 - odd) / 2, 1, [&](int begin, int end, int) {
      for (int s = begin; s < end; ++s) {
        const int low = (2 * s + odd) * fluid_slab, high = math::min(low + fluid_slab, layers);
        const int last = cell_start[(high + 1) * stride];
        for (int p = cell_start[(low + 1) * stride]; p < last; ++p) {
          const Particle& particle = particles[p];
          const FluidStencil<N> stencil(particle.x);
          for (int a = 0; a < N; ++a) carry_component<N>(particle, stencil, a, grid, carried[a].data());
          carry_mass<N>(stencil, grid, mass.data());
        }
      }
    });
  }
}

/// Calls f(i, j, k, index) for the cells of a range, layer after layer.
template <class F>
void for_cells(const FluidGrid& grid, const FluidRange& r, F&& f) {
  for (int k = r.low[2]; k <= r.high[2]; ++k)
    for (int j = r.low[1]; j <= r.high[1]; ++j) {
      int index = grid.index(r.low[0], j, k);
      for (int i = r.low[0]; i <= r.high[0]; ++i, ++index) f(i, j, k, index);
    }
}

/// Liquid is where the particles fill a cell's surroundings by half and more; how far the surface is from a cell's
/// centre follows from how full it is, exactly so for a level surface under the kernel of the transfer.
template <class D>
void FluidState<D>::classify() {
  const float one = room_of_particle();
  const int layers = grid.cells[N - 1];
  std::fill(kind.begin(), kind.end(), std::uint8_t(fluid_air));
  parallel(layers, 4, [&](int begin, int end, int) {
    FluidRange r = whole();
    r.low[N - 1] = begin;
    r.high[N - 1] = end - 1;
    for_cells(grid, r, [&](int, int, int, int c) {
      const float space = room[c];
      const float f = space > 0.05f ? mass[c] * one / space : 0.0f;
      fill[c] = f;
      level[c] = f >= 0.5f ? math::sqrt(2 * (1 - math::min(f, 1.0f))) - 1 : 1 - math::sqrt(2 * f);
    });
  });
  parallel(layers, 4, [&](int begin, int end, int) {
    FluidRange r = whole();
    r.low[N - 1] = begin;
    r.high[N - 1] = end - 1;
    for_cells(grid, r, [&](int, int, int, int c) {
      bool wet = fill[c] >= 0.5f;
      if (!wet && fill[c] > 0.1f) {  // a bubble that is only a gap between particles
        wet = true;
        for (int a = 0; a < N && wet; ++a)
          wet = (fill[c - grid.stride[a]] >= 0.5f || open[a][c] == 0) &&
                (fill[c + grid.stride[a]] >= 0.5f || open[a][c + grid.stride[a]] == 0);
      }
      if (!wet) return;
      bool reachable = false;
      for (int a = 0; a < N; ++a) reachable = reachable || open[a][c] > 0 || open[a][c + grid.stride[a]] > 0;
      if (reachable) kind[c] = fluid_liquid;
    });
  });
  liquid.clear();
  for_cells(grid, whole(), [&](int, int, int, int c) {
    if (kind[c] != fluid_liquid) return;
    if (fill[c] < 0.5f) level[c] = -0.5f;
    liquid.push_back(c);
  });
}

/// Parts of the liquid that have nothing to do with each other, by the cells that their particles reach, and what each
/// has of momentum.
template <class D>
void FluidState<D>::label() {
  std::fill(component.begin(), component.end(), -2);  // the margin stays so
  for_cells(grid, whole(), [&](int, int, int, int c) { component[c] = -1; });
  budgets.clear();
  queue.clear();
  for_cells(grid, whole(), [&](int, int, int, int seed) {
    if (!(mass[seed] > 0) || component[seed] != -1) return;
    const int name = int(budgets.size());
    budgets.push_back({});
    component[seed] = name;
    queue.clear();
    queue.push_back(seed);
    for (std::size_t next = 0; next < queue.size(); ++next) {
      const int c = queue[next];
      for (int a = 0; a < N; ++a)
        for (const int n : {c - grid.stride[a], c + grid.stride[a]})
          if (mass[n] > 0 && component[n] == -1) {
            component[n] = name;
            queue.push_back(n);
          }
    }
  });
  for (int c = 0, p = 0; c < grid.size; ++c)
    for (; p < cell_start[c + 1]; ++p) {
      Budget& budget = budgets[component[c]];
      for (int a = 0; a < N; ++a) budget.before[a] += particles[p].v[a];
      budget.mass += 1;
    }
}

}  // namespace carom::particles::detail
