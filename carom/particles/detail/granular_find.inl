// Which grains touch each other, walls and bodies.
#pragma once

#include <utility>

#include "carom/math/simd.h"
#include "carom/particles/detail/fluid_distance.h"
#include "carom/particles/detail/granular_state.h"

namespace carom::particles::detail {

/// In memory cells lie slab by slab (slabs stand side by side: so many cells across, and what one thread solves), in a
/// slab layer by layer upward, in a layer row by row.
template <class D>
int GranularState<D>::cell_at(int x, int y, int z) const {
  if constexpr (N == 2)
    return column_start[std::size_t(x)] + y * slab_cells;
  else
    return column_start[std::size_t(z)] + y * slab_cells * cells[0] + x;
}

/// By cell, without those that left through an open side.
template <class D>
void GranularState<D>::sort() {
  const int count = int(grains.size());
  cell_of.resize(count);
  std::fill(cell_start.begin(), cell_start.end(), 0);
  std::fill(haste.begin(), haste.end(), Haste<D>{});
  for (int i = 0; i < count; ++i) {
    int at[3] = {};
    bool inside = true;
    for (int b = 0; b < N; ++b) {
      const float x = grains[i].x[b] * inverse_cell;
      inside = inside && x >= 0 && x < float(cells[b]);
      at[b] = inside ? int(x) : 0;
    }
    cell_of[i] = inside ? cell_at(at[0], at[1], at[2]) : -1;
    if (!inside) continue;
    ++cell_start[cell_of[i] + 1];
    haste[cell_of[i]].add(grains[i].v);
  }
  for (int c = 0; c < size; ++c) cell_start[c + 1] += cell_start[c];
  sorted.resize(cell_start[size]);
  old_place.resize(cell_start[size]);
  for (int i = 0; i < count; ++i) {
    if (cell_of[i] < 0) continue;
    const int to = cell_start[cell_of[i]]++;
    sorted[to] = grains[i];
    old_place[to] = i;
  }
  for (int c = size; c > 0; --c) cell_start[c] = cell_start[c - 1];
  cell_start[0] = 0;
  grains.swap(sorted);
  for (auto& list : near_by) list.resize(grains.size() + grain_lanes);
}

/// The cells of a slab in memory's order.
template <class D>
template <class F>
void GranularState<D>::for_cells(int slab, F&& f) const {
  const int across = N == 2 ? cells[0] : cells[2], layer = N == 2 ? 1 : cells[0];
  const int low = slab * slab_cells, high = math::min(low + slab_cells, across);
  for (int y = 0; y < cells[1]; ++y)
    for (int k = low; k < high; ++k)
      for (int x = 0; x < layer; ++x) f(N == 2 ? k : x, y, N == 2 ? 0 : k);
}

/// Between what the velocities of the grains of each cell and of those within `rings` lie, and of what they may strike.
template <class D>
void GranularState<D>::look_around() {
  const std::vector<Haste<D>>* from = &haste;
  for (int axis = 0; axis < N; ++axis) {
    std::vector<Haste<D>>& to = (N - axis) % 2 ? around : spare;
    for_slabs([&](GrainSlab<N>&, int index) {
      for_cells(index, [&](int x, int y, int z) {
        int at[3] = {x, y, z};
        const int c = cell_at(x, y, z), here = at[axis], last = math::min(here + rings, cells[axis] - 1);
        if (axis == N - 1 && cell_start[c] == cell_start[c + 1]) return;  // nobody asks
        Haste<D> all;
        for (at[axis] = math::max(here - rings, 0); at[axis] <= last; ++at[axis])
          all.add((*from)[cell_at(at[0], at[1], at[2])]);
        to[c] = all;
      });
    });
    from = &to;
  }
}

/// s, `dt` at most, until neighbours are to be looked for again: no two anywhere, nor one and what stands still, then
/// close by more than `search_way`.
template <class D>
float GranularState<D>::time_to_search(float dt) const {
  Haste<D> all;
  all.add(Vector{});
  for (const Haste<D>& one : haste) all.add(one);
  const Vector range = all.range();
  float closing = 0;
  for (int k = 0; k < N; ++k) closing = math::max(closing, range[k]);
  const float parts = closing * dt / (search_way * definition.radius);
  return parts > 1 ? dt / math::ceil(parts) : dt;
}

/// Whether `time` after a search a grain is where it was not foreseen by more than a radius: two could then meet that
/// were not found.
template <class D>
bool GranularState<D>::astray(float time) {
  using Four = math::WideFloat<4>;
  const float margin = (1 - definition.radius_spread) * definition.radius;
  for_slabs([&](GrainSlab<N>& slab, int index) {
    slab.astray = false;
    for_cells(index, [&](int x, int y, int z) {
      const int c = cell_at(x, y, z);
      const Haste<D>& near = around[c];
      float least[4] = {}, most[4] = {};
      for (int k = 0; k < N; ++k) {
        const float gain = time * definition.gravity[k];
        least[k] = -time * (near.most[Haste<D>::down + k] - math::min(gain, 0.0f)) - margin;
        most[k] = time * (near.most[k] + math::max(gain, 0.0f)) + margin;
      }
      for (int i = cell_start[c]; i < cell_start[c + 1]; ++i) {
        const std::size_t row = std::size_t(i) * grain_place;
        const Four way = Four::load(&place[row]) - Four::load(&origin[row]);
        if (math::any((way < Four::load(least)) | (way > Four::load(most)))) slab.astray = true;
      }
    });
  });
  bool any = false;
  for (const GrainSlab<N>& slab : slabs) any = any || slab.astray;
  return any;
}

/// Lists the neighbours of a cell's grains, each pair once: those that come later along x, up or across to the next
/// slab, so that a slab's pairs have grains of this slab and the next alone.
template <class D>
void GranularState<D>::find_neighbours(GrainSlab<N>& slab, int x, int y, int z, float dt) {
  const int c = cell_at(x, y, z), begin = cell_start[c], end = cell_start[c + 1];
  if (begin == end) return;
  // What pulls one of the two pulls the other alike unless it is borne, and it then falls by half of g dt², in parts a
  // little more.
  const Vector closing = around[c].range();
  GrainReach<N> reach{.slack = 0.02f * definition.radius, .most = (rings * cell_radii - 2) * definition.radius};
  for (int k = 0; k < N; ++k) reach.way[k] = dt * closing[k] + 0.55f * dt * dt * math::abs(definition.gravity[k]);
  // As fast at any time until the next search.
  float* const paces = pace.data();
  for (int k = 0; k < N; ++k) {
    const float by_axis = dt * closing[k] + 1.1f * dt * dt * math::abs(definition.gravity[k]);
    for (int i = begin; i < end; ++i) paces[std::size_t(i) * grain_place + std::size_t(k)] = by_axis;
  }
  // Along an axis they are as far apart, at most, as where they come closest askew to it.
  const float radii = 2 * definition.radius + reach.slack, width = cell_radii * definition.radius;
  float sum = 0, square = 0, far[N], farthest = 0;
  for (int k = 0; k < N; ++k) {
    sum += reach.way[k];
    square += reach.way[k] * reach.way[k];
  }
  for (int k = 0; k < N; ++k) {
    far[k] = 1.001f * (radii + math::min(math::min(0.5f * (sum + reach.way[k]), math::sqrt(square)), reach.most));
    farthest = math::max(farthest, far[k]);
  }
  const int near = farthest > width ? rings : 1;
  GrainRuns<N> runs;
  for (int k = 0, at[3] = {x, y, z}; k < N; ++k) {
    runs.low[k] = float(at[k]) * width - far[k];
    runs.high[k] = float(at[k] + 1) * width + far[k];
  }
  const auto add = [&](int x0, int x1, int row, int across) {
    if (row < 0 || row >= cells[1] || across >= cells[2]) return;
    x0 = math::max(x0, 0);
    x1 = math::min(x1, cells[0] - 1);
    if (x0 > x1) return;
    const int from = cell_start[cell_at(x0, row, across)], to = cell_start[cell_at(x1, row, across) + 1];
    if (runs.count > 0 && runs.to[runs.count - 1] == from) {
      runs.to[runs.count - 1] = to;
      return;
    }
    runs.from[runs.count] = from;
    runs.to[runs.count++] = to;
  };
  if constexpr (N == 2) {
    for (int k = 0; k <= 2 * near; ++k) {  // its own row first
      const int up = k <= near ? k : near - k;
      for (int right = up < 0 ? 1 : 0; right <= near; ++right) add(x + right, x + right, y + up, z);
    }
  } else {
    add(x, x + 1, y, z);
    add(x - 1, x + 1, y + 1, z);
    for (int row = -1; row <= 1; ++row) add(x - 1, x + 1, y + row, z + 1);
  }
  std::size_t most = 0;
  for (int k = 0; k < runs.count; ++k) most += std::size_t(runs.to[k] - runs.from[k]);
  // As many of the cell's grains at a time as leave room for all pairs: mostly all, few where a cell holds hundreds.
  const int some = math::max(1, math::min(end - begin, (1 << 14) / int(most)));
  const std::size_t near_count = most + grain_lanes, pair_room = most * std::size_t(some) + grain_lanes;
  if (near_count + 2 * pair_room > slab.numbers.size()) slab.numbers.resize(2 * (near_count + 2 * pair_room));
  const std::size_t floats = (N + 1) * near_count + 3 * pair_room;
  if (floats > slab.near.size()) slab.near.resize(2 * floats);
  GrainRoom<N> room;
  room.number = slab.numbers.data();
  room.own = room.number + near_count;
  room.other = room.own + pair_room;
  float* next = slab.near.data();
  for (float*& column : room.column) column = std::exchange(next, next + near_count);
  for (float*& column : room.wait) column = std::exchange(next, next + pair_room);
  room.waiting = slab.waiting;
  GrainColumns<N> columns;
  for (int k = 0; k <= N; ++k) columns.column[k] = near_by[k].data();
  for (int from = begin; from < end; from += some) {
    runs.begin = runs.from[0] = from;
    runs.end = math::min(from + some, end);
    for (int k = 1; k < grain_stages; ++k) {
      const std::size_t wanted = std::size_t(slab.waiting[k]) + pair_room;
      if (wanted > slab.later[k].size()) slab.later[k].resize(2 * wanted);
      room.later[k] = slab.later[k].data();
    }
    const std::size_t wanted = std::size_t(slab.pair_count) + pair_room;
    if (wanted > slab.pairs.size()) slab.pairs.resize(2 * wanted);
    slab.pair_count = kernels->find(columns, runs, reach, room, first_pair.data(), slab.pairs.data(), slab.pair_count);
  }
}

/// One more, empty; `none`: a grain that is none.
template <int N>
void GrainSlab<N>::add_block(std::uint32_t none) {
  const std::size_t block = std::size_t(block_count++);
  if (block == blocks.size()) blocks.emplace_back();
  if (block == open_block.size()) {
    const std::size_t room = 2 * block + 16;
    open_block.resize(room);
    filled.resize(room);
    pair_of.resize(room * grain_lanes);
    was.resize(room * grain_lanes);
  }
  open_block[block] = int(block);
  filled[block] = 0;
  std::fill_n(&pair_of[block * grain_lanes], grain_lanes, -1);
  std::fill_n(&was[block * grain_lanes], grain_lanes, -1);
  // Of a lane without a contact the rest is not felt.
  GrainBlock<N>& made = blocks[block];
  for (float* list : {made.push, made.gain}) std::fill_n(list, grain_lanes, 0.0f);
  for (int k = 0; k < GrainBlock<N>::turns; ++k)
    for (float* list : {made.grip[k], made.roll[k]}) std::fill_n(list, grain_lanes, 0.0f);
  std::fill_n(blocks[block].a, grain_lanes, none);
  std::fill_n(blocks[block].b, grain_lanes, none);
}

/// Gives a pair a lane in the first block that has room after the last in which one of the two is: solved block by
/// block the pairs give what they would one after the other. The slab's grains end at `end`. `last_of_a`: last_block of
/// the grain, which may be at hand.
template <class D>
[[gnu::always_inline]] inline int GranularState<D>::place_pair(GrainSlab<N>& slab, int end, int a, int b,
                                                               int& last_of_a) {
  int *const open = slab.open_block.data(), &last_of_b = b < end ? last_block[b] : last_across[b];
  int block = math::max(last_of_a, last_of_b) + 1;
  while (block < slab.block_count && open[block] != block) {
    const int after = open[block];
    if (after < slab.block_count) open[block] = open[after];
    block = after;
  }
  if (block >= slab.block_count) {
    block = slab.block_count;
    slab.add_block(std::uint32_t((int(grains.size()) + int(&slab - slabs.data())) * grain_place));
  }
  last_of_a = last_of_b = block;
  const int lane = slab.filled[block]++;
  if (lane == grain_lanes - 1) slab.open_block[block] = block + 1;
  slab.blocks[block].a[lane] = std::uint32_t(a * grain_place);
  slab.blocks[block].b[lane] = std::uint32_t(b * grain_place);
  return block * grain_lanes + lane;
}

/// The number that a pair had when last looked for, listed with the one of its grains; −1: none. Both as they were.
template <class D>
int GranularState<D>::old_pair(int grain, int other) const {
  for (int k = old_first_pair[grain]; k < old_first_pair[grain + 1]; ++k)
    if (old_pairs[k] == other) return k;
  for (int k = first_late[grain]; k >= 0; k = late[k].next)
    if (late[k].other == other) return old_first_pair.back() + k;
  return -1;
}

/// Finds which the pairs of the slab's grains were when last looked for: mostly the same in turn.
template <class D>
void GranularState<D>::match_pairs(GrainSlab<N>& slab, int begin, int end) {
  const int known = int(old_first_pair.size()) - 1;
  const int *const old_first = old_first_pair.data(), *const others = old_pairs.data(),
                   *const places = old_place.data(), *const first = first_pair.data(), *const mine = pairs.data();
  const float* const motions = motion.data();
  int* const old_of = was.data();
  float fastest = 0;
  for (int grain = begin; grain < end; ++grain) {
    const int own = places[grain];
    const float* const ours = motions + std::size_t(grain) * grain_motion<N>;
    int next = own < known ? old_first[own] : 0;
    const int old_end = own < known ? old_first[own + 1] : 0;
    for (int k = first[grain], to = first[grain + 1]; k < to; ++k) {
      const float* const theirs = motions + std::size_t(mine[k]) * grain_motion<N>;
      float square = 0;
      for (int axis = 0; axis < N; ++axis) {
        const float passing = theirs[axis] - ours[axis];
        square += passing * passing;
      }
      fastest = math::max(fastest, square);
      const int other = places[mine[k]];
      if (next < old_end && others[next] == other) {
        old_of[k] = 2 * next++;
        continue;
      }
      int old = own < known ? old_pair(own, other) : -1;
      old_of[k] = old < 0 ? -1 : 2 * old;
      if (old >= 0) {
        if (old < old_end) next = old + 1;
      } else if (other < known) {
        old = old_pair(other, own);
        if (old >= 0) old_of[k] = 2 * old + 1;
      }
    }
  }
  slab.fastest = math::sqrt(fastest);
}

/// Gives the pairs of the slab's grains their blocks.
template <class D>
void GranularState<D>::place_pairs(GrainSlab<N>& slab, int begin, int end) {
  const int *const first = first_pair.data(), *const others = pairs.data();
  for (int grain = begin; grain < end; ++grain) {
    int last = last_block[grain];
    for (int k = first[grain], to = first[grain + 1]; k < to; ++k) {
      const int at = place_pair(slab, end, grain, others[k], last);
      slab.pair_of[at] = k;
      slab.was[at] = was[k];
    }
    last_block[grain] = last;
  }
}

/// At the begin of a stage: pairs that may touch within it get a lane, the others wait on.
template <class D>
void GranularState<D>::place_later(GrainSlab<N>& slab, int end, int stage) {
  constexpr int some = 64;
  int stages_more[some + grain_lanes];
  GrainWait now[some], never[some];
  GrainWait* to[2 * grain_stages];
  const int count = slab.waiting[stage];
  for (int k = stage + 1; k < grain_stages; ++k) {
    const std::size_t wanted = std::size_t(slab.waiting[k]) + std::size_t(count);
    if (wanted > slab.later[k].size()) slab.later[k].resize(2 * wanted);
    to[k] = slab.later[k].data() + slab.waiting[k];
  }
  for (int begin = 0; begin < count; begin += some) {
    const GrainWait* const waiting = slab.later[stage].data() + begin;
    const int asked = math::min(count - begin, some);
    kernels->wait(waiting, asked, place.data(), pace.data(), 0.02f * definition.radius, stages_more);
    to[stage] = now;
    for (int k = grain_stages; k < 2 * grain_stages; ++k) to[k] = never;
    for (int k = 0; k < asked; ++k) *to[stage + stages_more[k]]++ = waiting[k];
    for (const GrainWait* pair = now; pair < to[stage]; ++pair) {
      const int a = int(pair->a / grain_place), b = int(pair->b / grain_place);
      const int at = place_pair(slab, end, a, b, last_block[a]), lane = at % grain_lanes;
      slab.late.push_back({a, b, at});
      GrainBlock<N>& block = slab.blocks[at / grain_lanes];
      const Grain<D>&ga = grains[a], &gb = grains[b];
      block.ease[lane] = 1 / (ga.inverse_mass + gb.inverse_mass);
      block.give_way[lane] = 1 / (ga.inverse_inertia + gb.inverse_inertia);
      block.lever[lane] = 1 / (ga.curve + gb.curve);
    }
  }
  for (int k = stage + 1; k < grain_stages; ++k) slab.waiting[k] = int(to[k] - slab.later[k].data());
}

/// Pairs that were placed later come behind the others.
template <class D>
void GranularState<D>::number_late() {
  late.clear();
  first_late.assign(grains.size(), -1);
  for (GrainSlab<N>& slab : slabs)
    for (const GrainLate& pair : slab.late) {
      slab.pair_of[pair.at] = pair_count + int(late.size());
      late.push_back({pair.b, std::exchange(first_late[pair.a], int(late.size()))});
    }
}

template <class D>
void GranularState<D>::find_pairs(float dt) {
  const int count = int(grains.size());
  old_pairs.swap(pairs);
  old_first_pair.swap(first_pair);
  first_pair.resize(std::size_t(count) + 1);
  last_block.assign(std::size_t(count), -1);
  last_across.assign(std::size_t(count), -1);
  for_slabs([&](GrainSlab<N>& slab, int index) {
    slab.pair_count = slab.block_count = 0;
    slab.late.clear();
    std::fill_n(slab.waiting, grain_stages, 0);
    for_cells(index, [&](int x, int y, int z) { find_neighbours(slab, x, y, z, dt); });
  });
  pair_count = watched = 0;
  for (const GrainSlab<N>& slab : slabs) {
    pair_count += slab.pair_count;
    for (const int count : slab.waiting) watched += count;
  }
  watched += pair_count;
  if (std::size_t(pair_count) > pairs.size()) pairs.resize(2 * std::size_t(pair_count));
  first_pair[count] = pair_count;
  for (int k = 0, before = 0; k < int(slabs.size()); ++k) {
    std::copy_n(slabs[k].pairs.data(), slabs[k].pair_count, pairs.data() + before);
    for (int i = slab_begin(k); i < slab_begin(k + 1); ++i) first_pair[i] += before;
    before += slabs[k].pair_count;
  }
  if (was.size() < pairs.size()) was.resize(pairs.size());
  for_slabs([&](GrainSlab<N>& slab, int index) {
    match_pairs(slab, slab_begin(index), slab_begin(index + 1));
    place_pairs(slab, slab_begin(index), slab_begin(index + 1));
  });
}

/// Surface: a side of the domain, or 2 N + the index of a solid. Each has blocks of its own: a grain is in one once.
template <class D>
void GranularState<D>::touch(int grain, int surface, std::uint32_t key) {
  const GrainTouch* old = nullptr;
  const int was = old_place[grain];
  if (was + 1 < int(old_first_touch.size()))
    for (int k = old_first_touch[was]; k < old_first_touch[was + 1]; ++k)
      if (old_touches[k].key == key) old = &old_touches[k];
  if (surface >= 2 * N && solids[surface - 2 * N].body >= 0) {
    Contact c;
    if (old && old->lane < 0) c = old_body_contacts[-1 - old->lane];
    c.a = grain;
    c.solid = surface - 2 * N;
    touches.push_back({key, -1 - int(body_contacts.size())});
    body_contacts.push_back(c);
    return;
  }
  int& filling = surface_block[surface];
  const auto none = std::uint32_t(grains.size() * grain_place);
  int lane = 0;
  if (filling >= 0)
    while (lane < grain_lanes && wall_blocks[filling].a[lane] != none) ++lane;
  if (filling < 0 || lane == grain_lanes) {
    lane = 0;
    filling = int(wall_blocks.size());
    wall_blocks.emplace_back();
    wall_of.push_back(surface);
    for (int k = 0; k < grain_lanes; ++k) wall_blocks[filling].a[k] = wall_blocks[filling].b[k] = none;
  }
  Block& now = wall_blocks[filling];
  now.a[lane] = std::uint32_t(grain * grain_place);
  if (old && old->lane >= 0) {
    const Block& then = old_wall_blocks[old->lane / grain_lanes];
    const int from = old->lane % grain_lanes;
    now.push[lane] = then.push[from];
    for (int k = 0; k < Block::turns; ++k) {
      now.grip[k][lane] = then.grip[k][from];
      now.roll[k][lane] = then.roll[k][from];
    }
  }
  touches.push_back({key, filling * grain_lanes + lane});
}

template <class D>
bool GranularState<D>::near_solid(int i, int index, float reach) const {
  const GrainSolid<D>& solid = solids[index];
  const Grain<D>& g = grains[i];
  const float most = g.radius + reach;
  for (int b = 0; b < N; ++b)
    if (g.x[b] < solid.bounds.low[b] - most || g.x[b] > solid.bounds.high[b] + most) return false;
  return signed_distance(solid.shape, inverse_transform_point(solid.at, g.x), solid.sheet) < most;
}

/// Also what grains may strike, to their cells' haste.
template <class D>
void GranularState<D>::find_surfaces(float dt) {
  old_touches.swap(touches);
  old_first_touch.swap(first_touch);
  old_wall_blocks.swap(wall_blocks);
  old_body_contacts.swap(body_contacts);
  touches.clear();
  wall_blocks.clear();
  wall_of.clear();
  body_contacts.clear();
  surface_block.assign(2 * N + solids.size(), -1);
  first_touch.resize(grains.size() + 1);
  const float reach = statistics.max_speed * dt + 0.02f * definition.radius;
  for (int i = 0; i < int(grains.size()); ++i) {
    first_touch[i] = int(touches.size());
    Haste<D>& here = haste[cell_of[old_place[i]]];
    for (int side = 0; side < 2 * N; ++side) {
      const float x = grains[i].x[side / 2], distance = side % 2 ? extent[side / 2] - x : x;
      if (!definition.walls[side] || distance >= grains[i].radius + reach) continue;
      touch(i, side, std::uint32_t(side));
      here.add_still(side / 2);
    }
    for (int k = 0; k < int(solids.size()); ++k) {
      if (!near_solid(i, k, reach)) continue;
      touch(i, 2 * N + k, solids[k].key);
      Vector speed{};
      if (solids[k].body >= 0) {
        const GrainBody<D>& b = bodies[solids[k].body];
        speed = b.velocity + grain_turn(b.spin, grains[i].x - b.center);
      }
      here.add(speed);
    }
  }
  first_touch[grains.size()] = int(touches.size());
}

/// Of the impulses that surfaces held, for a substep so much longer.
template <class D>
void GranularState<D>::scale_surfaces(float scale) {
  for (Block& block : wall_blocks)
    for (int lane = 0; lane < grain_lanes; ++lane) {
      block.push[lane] *= scale;
      for (int k = 0; k < Block::turns; ++k) {
        block.grip[k][lane] *= scale;
        block.roll[k][lane] *= scale;
      }
    }
  for (Contact& c : body_contacts) {
    c.normal_impulse *= scale;
    c.friction = scale * c.friction;
    c.rolling = scale * c.rolling;
  }
}

}  // namespace carom::particles::detail
