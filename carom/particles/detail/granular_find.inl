// Which grains touch each other, walls and bodies.
#pragma once

#include <bit>

#include "carom/math/simd.h"
#include "carom/particles/detail/fluid_distance.h"
#include "carom/particles/detail/granular_state.h"

namespace carom::particles::detail {

inline constexpr int grain_slab = 4;  // layers of cells that one thread solves

/// By cell, without those that left through an open side.
template <class D>
void GranularState<D>::sort() {
  const int count = int(grains.size());
  cell_of.resize(count);
  std::fill(cell_start.begin(), cell_start.end(), 0);
  for (int i = 0; i < count; ++i) {
    int index = 0;
    bool inside = true;
    for (int b = 0; b < N; ++b) {
      const float x = grains[i].x[b] * inverse_cell;
      inside = inside && x >= 0 && x < float(cells[b]);
      index += inside ? int(x) * stride[b] : 0;
    }
    cell_of[i] = inside ? index : -1;
    if (inside)
      ++cell_start[index + 1];
    else
      free_ids.push_back(grains[i].id);
  }
  for (int c = 0; c < size; ++c) cell_start[c + 1] += cell_start[c];
  sorted.resize(cell_start[size]);
  for (int i = 0; i < count; ++i)
    if (cell_of[i] >= 0) sorted[cell_start[cell_of[i]]++] = grains[i];
  for (int c = size; c > 0; --c) cell_start[c] = cell_start[c - 1];
  cell_start[0] = 0;
  grains.swap(sorted);
}

/// What the same contact had in the last step: lists are by the id of the first grain.
template <class D>
void GranularState<D>::remember(Contact& contact, const std::vector<Contact>& old, std::uint32_t a,
                                std::uint32_t b) const {
  for (int k = old_start[a]; k < old_start[a + 1]; ++k)
    if (old[k].key == b) {
      contact.normal_impulse = old[k].normal_impulse;
      contact.friction = old[k].friction;
      contact.rolling = old[k].rolling;
      return;
    }
  for (int k = old_start[b]; k < old_start[b + 1]; ++k)
    if (old[k].key == a) {
      contact.normal_impulse = old[k].normal_impulse;
      contact.friction = -old[k].friction;
      contact.rolling = -old[k].rolling;
      return;
    }
}

template <class D>
void GranularState<D>::find_contacts(float dt) {
  // The old ones by the id of their first grain; `a` still names the place that the grain had then.
  old_contacts.swap(contacts);
  contacts.clear();
  std::fill(old_start.begin(), old_start.end(), 0);
  for (const Contact& c : old_contacts) ++old_start[std::size_t(c.a) + 1];
  for (std::size_t i = 1; i < old_start.size(); ++i) old_start[i] += old_start[i - 1];
  sorted_old.resize(old_contacts.size());
  for (const Contact& c : old_contacts) sorted_old[old_start[c.a]++] = c;
  for (std::size_t i = old_start.size() - 1; i > 0; --i) old_start[i] = old_start[i - 1];
  old_start[0] = 0;

  // Pairs that may meet before the next search; the cells are that much wider than two grains.
  const float reach =
      math::min(2 * statistics.max_speed * dt + 0.02f * definition.radius, cell - 2 * definition.radius);
  slab_start.clear();
  for (auto& list : near_by) list.resize(grains.size() + 3);  // read by fours
  for (std::size_t i = 0; i < grains.size(); ++i) {
    for (int axis = 0; axis < N; ++axis) near_by[axis][i] = grains[i].x[axis];
    near_by[N][i] = grains[i].radius;
  }
  using F = math::WideFloat<4>;
  /// Four grains at a time of a run of neighbours in memory.
  const auto try_run = [&](int i, int from, int to) {
    const Grain<D>& grain = grains[i];
    for (int j = from; j < to; j += 4) {
      F square = F::zero();
      for (int axis = 0; axis < N; ++axis) {
        const F d = F::load(&near_by[axis][j]) - F::splat(grain.x[axis]);
        square = square + d * d;
      }
      const F touch = F::splat(grain.radius) + F::load(&near_by[N][j]) + F::splat(reach);
      std::uint32_t hits = math::bitmask(square < touch * touch);
      if (to - j < 4) hits &= (1u << (to - j)) - 1;
      for (; hits != 0; hits &= hits - 1) {
        Contact c;
        c.a = i;
        c.b = j + std::countr_zero(hits);
        c.key = grains[c.b].id;
        remember(c, sorted_old, grain.id, c.key);
        contacts.push_back(c);
      }
    }
  };
  for (int z = 0; z < cells[2]; ++z)
    for (int y = 0; y < cells[1]; ++y) {
      if ((N == 3 && y == 0 && z % grain_slab == 0) || (N == 2 && y % grain_slab == 0))
        slab_start.push_back(int(contacts.size()));
      for (int x = 0; x < cells[0]; ++x) {
        const int c = x + y * stride[1] + z * stride[2];
        // The half of the neighbours that come later: rows of up to three cells, which lie side by side.
        const int left = math::max(x - 1, 0) - x, right = math::min(x + 1, cells[0] - 1) - x;
        for (int i = cell_start[c]; i < cell_start[c + 1]; ++i) {
          try_run(i, i + 1, cell_start[c + right + 1]);
          for (int up = 0; up < (N == 2 ? 1 : 2); ++up)
            for (int row = up == 0 ? 1 : -1; row <= 1; ++row) {
              if (y + row < 0 || y + row >= cells[1] || z + up >= cells[2]) continue;
              const int middle = c + row * stride[1] + up * stride[2];
              try_run(i, cell_start[middle + left], cell_start[middle + right + 1]);
            }
        }
      }
    }
  slab_start.push_back(int(contacts.size()));
}

template <class D>
void GranularState<D>::touch_wall(int i, int side, float reach) {
  const int axis = side / 2;
  const bool high = side % 2 == 1;
  const Grain<D>& g = grains[i];
  const float distance = high ? extent[axis] - g.x[axis] : g.x[axis];
  if (distance >= g.radius + reach) return;
  Contact c;
  c.a = i;
  c.b = -1 - side;
  c.key = std::uint32_t(side);
  c.normal[axis] = high ? 1.0f : -1.0f;
  surface_contacts.push_back(c);
}

template <class D>
void GranularState<D>::touch_solid(int i, const GrainSolid<D>& solid, int index, float reach) {
  const Grain<D>& g = grains[i];
  const float most = g.radius + reach;
  for (int b = 0; b < N; ++b)
    if (g.x[b] < solid.bounds.low[b] - most || g.x[b] > solid.bounds.high[b] + most) return;
  const Vector local = inverse_transform_point(solid.at, g.x);
  const float d = signed_distance(solid.shape, local, solid.sheet);
  if (d >= most) return;
  Contact c;
  c.a = i;
  c.b = -1 - 2 * N - index;
  c.key = solid.key;
  surface_contacts.push_back(c);
}

template <class D>
void GranularState<D>::find_surfaces(float dt) {
  old_surface_contacts.swap(surface_contacts);
  surface_contacts.clear();
  const float reach = statistics.max_speed * dt + 0.02f * definition.radius;
  for (int i = 0; i < int(grains.size()); ++i) {
    for (int side = 0; side < 2 * N; ++side)
      if (definition.walls[side]) touch_wall(i, side, reach);
    for (int k = 0; k < int(solids.size()); ++k) touch_solid(i, solids[k], k, reach);
  }
  // Warm: the old ones lie in the order of their grains then; their ids lead to where the grains are now.
  for (std::size_t i = 0; i < grains.size(); ++i) place_of[grains[i].id] = int(i);
  for (std::size_t k = 0; k < first_surface.size(); ++k) first_surface[k] = -1;
  for (std::size_t k = surface_contacts.size(); k-- > 0;) first_surface[surface_contacts[k].a] = int(k);
  for (const Contact& old : old_surface_contacts) {
    const int place = place_of[old.a];
    if (place < 0 || std::size_t(place) >= grains.size() || grains[place].id != std::uint32_t(old.a)) continue;
    for (int k = first_surface[place]; k >= 0 && k < int(surface_contacts.size()) && surface_contacts[k].a == place;
         ++k)
      if (surface_contacts[k].key == old.key) {
        surface_contacts[k].normal_impulse = old.normal_impulse;
        surface_contacts[k].friction = old.friction;
        surface_contacts[k].rolling = old.rolling;
      }
  }
}

}  // namespace carom::particles::detail
