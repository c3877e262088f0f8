// The impulses of grains that touch.
#pragma once

#include <array>
#include <chrono>

#include "carom/math/elementary.h"
#include "carom/particles/detail/granular_find.inl"

namespace carom::particles::detail {

/// Radii that two pass each other by in a substep, at most. In space, whose searches take most, long substeps gain
/// nothing.
template <int N>
constexpr float pair_way = N == 2 ? 1.2f : 0.4f;
template <int N>
constexpr float sweeps_per_way = N == 2 ? 7 : 5;  ///< for each radius that the fastest do
constexpr int most_grain_substeps = 64;           ///< of a step
constexpr float grain_slop = 0.005f;              // overlap that stays, of a radius
template <int N>
constexpr float grain_part = N == 2 ? 0.4f : 0.3f;  ///< share of the rest that a substep takes out
/// What lies straight below counts by so much heavier while an overlap is taken out: a heap is let up from the ground,
/// layer by layer, and not pushed into it.
constexpr float grain_settle = 2;

/// Of a lane of a surface's block; −1: none, nor in those behind it.
template <class D>
int GranularState<D>::grain_in(const Block& block, int lane) const {
  const int grain = int(block.a[lane] / grain_place);
  return grain < int(grains.size()) ? grain : -1;
}

template <class D>
void GranularState<D>::to_rows() {
  const int count = int(grains.size());
  std::array<float*, N + 1> columns{};
  for (int k = 0; k <= N; ++k) columns[std::size_t(k)] = near_by[k].data();
  for_grains(count + int(slabs.size()), [count, from = grains.data(), places = place.data(), origins = origin.data(),
                                         motions = motion.data(), columns](int i) {
    float* const p = places + std::size_t(i) * grain_place;
    float* const m = motions + std::size_t(i) * grain_motion<N>;
    const Grain<D> none{.curve = 1, .inverse_mass = 1};
    const Grain<D>& g = i < count ? from[i] : none;
    p[2] = 0;
    for (int k = 0; k < N; ++k) {
      p[k] = g.x[k];
      m[k] = g.v[k];
    }
    p[3] = g.radius;
    if (i < count) {
      for (int k = 0; k < N; ++k) columns[std::size_t(k)][i] = g.x[k];
      columns[N][i] = g.radius;
    }
    if constexpr (N == 2) std::copy_n(p, grain_place, origins + std::size_t(i) * grain_place);  // astray()
    if constexpr (N == 2) {
      m[2] = g.radius * g.spin;
      m[3] = g.curve;
    } else {
      m[3] = g.inverse_mass;
      for (int k = 0; k < 3; ++k) m[4 + k] = g.radius * g.spin[k];
      m[7] = g.curve;
    }
  });
}

template <class D>
void GranularState<D>::from_rows() {
  for_grains(int(grains.size()), [to = grains.data(), places = place.data(), motions = motion.data()](int i) {
    const float* const p = places + std::size_t(i) * grain_place;
    const float* const m = motions + std::size_t(i) * grain_motion<N>;
    Grain<D>& g = to[i];
    for (int k = 0; k < N; ++k) {
      g.x[k] = p[k];
      g.v[k] = m[k];
    }
    if constexpr (N == 2)
      g.spin = m[2] * g.curve;
    else
      for (int k = 0; k < 3; ++k) g.spin[k] = m[4 + k] * g.curve;
  });
}

template <class D>
bool GranularState<D>::measure_solid(const GrainSolid<D>& solid, const Vector& at, Vector& normal,
                                     float& distance) const {
  const Vector local = inverse_transform_point(solid.at, at);
  distance = signed_distance(solid.shape, local, solid.sheet);
  const float step = 0.02f * definition.radius;
  Vector slope{};
  for (int b = 0; b < N; ++b) {
    Vector up = local, down = local;
    up[b] += step;
    down[b] -= step;
    slope[b] = signed_distance(solid.shape, up, solid.sheet) - signed_distance(solid.shape, down, solid.sheet);
  }
  const float size = length(slope);
  if (!(size > 0)) return false;
  normal = rotate(solid.at.q, slope / -size);
  return true;
}

/// A part of an overlap with a surface is taken out of the place; returns the gap that is left.
template <class D>
float GranularState<D>::push_out(int grain, const Vector& normal, float gap, const GrainPass& pass) {
  const float out = pass.part * math::max(-pass.slop - gap, 0.0f);
  for (int k = 0; k < N; ++k) place[std::size_t(grain) * grain_place + std::size_t(k)] -= out * normal[k];
  return gap + out;
}

/// Where the grains are now.
template <class D>
void GranularState<D>::measure_surfaces(const GrainPass& pass) {
  const auto where = [&](int grain) {
    Vector x{};
    for (int k = 0; k < N; ++k) x[k] = place[std::size_t(grain) * grain_place + std::size_t(k)];
    return x;
  };
  for (std::size_t i = 0; i < wall_blocks.size(); ++i) {
    Block& block = wall_blocks[i];
    const int surface = wall_of[i], axis = surface / 2;
    for (int lane = 0; lane < grain_lanes && grain_in(block, lane) >= 0; ++lane) {
      const int grain = grain_in(block, lane);
      const Vector x = where(grain);
      const float radius = grains[grain].radius;
      Vector normal{};
      float gap = 0;
      if (surface < 2 * N) {
        gap = (surface % 2 ? extent[axis] - x[axis] : x[axis]) - radius;
        normal[axis] = surface % 2 ? 1.0f : -1.0f;
      } else if (float distance = 0; measure_solid(solids[surface - 2 * N], x, normal, distance)) {
        gap = distance - radius;
      } else {
        block.gap[lane] = definition.radius;
        continue;
      }
      block.gap[lane] = push_out(grain, normal, gap, pass);
      for (int k = 0; k < N; ++k) block.normal[k][lane] = normal[k];
    }
  }
  for (Contact& c : body_contacts) {
    const Vector x = where(c.a);
    float distance = 0;
    if (!measure_solid(solids[c.solid], x, c.normal, distance)) {
      c.gap = definition.radius;
      continue;
    }
    c.arm = x + distance * c.normal - bodies[solids[c.solid].body].center;
    c.gap = push_out(c.a, c.normal, distance - grains[c.a].radius, pass);
  }
}

template <class D>
void GranularState<D>::apply_body(const Contact& c, float normal, Vector friction, Angular rolling) {
  const Grain<D>& a = grains[c.a];
  float* const m = &motion[std::size_t(c.a) * grain_motion<N>];
  const Vector impulse = normal * c.normal + friction;
  for (int k = 0; k < N; ++k) m[k] -= a.inverse_mass * impulse[k];
  const Angular turned = (a.radius * a.inverse_inertia) * (a.radius * grain_cross(c.normal, friction) + rolling);
  if constexpr (N == 2)
    m[2] -= turned;
  else
    for (int k = 0; k < 3; ++k) m[4 + k] -= turned[k];
  GrainBody<D>& b = bodies[solids[c.solid].body];
  if (!b.moves) {
    wall_impulse += Position(impulse);
    return;
  }
  const Angular turn = grain_cross(c.arm, impulse) + rolling;
  b.velocity += b.inverse_mass * impulse;
  b.spin += b.inverse_inertia * turn;
  b.impulse += impulse;
  b.turn += turn;
}

namespace {

/// The change of a limited impulse: `wanted` added to `held`, cut off at `limit`.
template <class V>
V limited_change(V& held, V wanted, float limit) {
  V next = held + wanted;
  const float size = grain_size(next);
  if (size > limit) next = (size > 0 ? limit / size : 0.0f) * next;
  const V change = next - held;
  held = next;
  return change;
}
}  // namespace

template <class D>
void GranularState<D>::solve_body(Contact& c, float h) {
  const Grain<D>& a = grains[c.a];
  const float* const m = &motion[std::size_t(c.a) * grain_motion<N>];
  const GrainSolid<D>& solid = solids[c.solid];
  const GrainBody<D>& b = bodies[solid.body];
  // Of the body's surface against the grain's middle.
  const auto across = [&] {
    Vector v = b.velocity + grain_turn(b.spin, c.arm);
    for (int k = 0; k < N; ++k) v[k] -= m[k];
    return v;
  };
  // What a unit impulse along `direction` changes between the two.
  const auto response = [&](const Vector& direction, bool rubs) {
    float sum = a.inverse_mass + (rubs ? a.radius * a.radius * a.inverse_inertia : 0.0f);
    if (b.moves) {
      const Angular turn = b.inverse_inertia * grain_cross(c.arm, direction);
      sum += b.inverse_mass + dot(grain_turn(turn, c.arm), direction);
    }
    return sum;
  };
  const float bias = c.gap > 0 ? c.gap / h : 0.0f;
  const float next = math::max(c.normal_impulse - (dot(across(), c.normal) + bias) / response(c.normal, false), 0.0f);
  const float normal = next - c.normal_impulse;
  c.normal_impulse = next;
  if (next == 0 && normal == 0 && grain_size(c.rolling) == 0 && dot(c.friction, c.friction) == 0) return;
  apply_body(c, normal, Vector{}, Angular{});
  Angular rim{};  // speed of the grain's
  if constexpr (N == 2)
    rim = m[2];
  else
    rim = {m[4], m[5], m[6]};
  const Vector slip = across() - grain_turn(rim, c.normal);
  const Vector tangent = slip - dot(slip, c.normal) * c.normal;
  const float size = length(tangent);
  Vector wanted{};
  if (size > 0) wanted = tangent / -response(tangent / size, true);
  const Vector friction = limited_change(c.friction, wanted, solid.friction * next);
  Angular rolling{};
  if (definition.rolling_friction > 0)
    rolling = limited_change(c.rolling, (rim / a.radius - b.spin) / a.inverse_inertia,
                             definition.rolling_friction * a.radius * next);
  apply_body(c, 0, friction, rolling);
}

/// All slabs, each by one thread.
template <class D>
template <class F>
void GranularState<D>::for_slabs(F&& f) {
  scheduler->parallel_for(int(slabs.size()), 1, [&](int begin, int end, int) {
    for (int k = begin; k < end; ++k) f(slabs[k], k);
  });
}

/// Every second slab at a time: no two threads then touch the same grain, and the order is always the same.
template <class D>
template <class F>
void GranularState<D>::for_slabs_in_turn(bool back, F&& f) {
  for (int color = 0; color < 2; ++color) {
    const int odd = back ? 1 - color : color;
    const int count = (int(slabs.size()) + 1 - odd) / 2;
    scheduler->parallel_for(count, 1, [&](int begin, int end, int) {
      for (int k = begin; k < end; ++k) f(slabs[2 * (back ? count - 1 - k : k) + odd]);
    });
  }
}

/// `f` captures pointers by value: after each store through a member they would be loaded anew.
template <class D>
template <class F>
void GranularState<D>::for_grains(int count, F&& f) {
  scheduler->parallel_for(count, 2048, [f](int begin, int end, int) {
    for (int i = begin; i < end; ++i) f(i);
  });
}

/// Overlaps are taken out of the places alone, so that no speed comes of them; normals and gaps where the grains then
/// are; and the impulses of the last substep, to begin with.
template <class D>
void GranularState<D>::press() {
  GrainPass pass{.lightness = lightness(), .slop = grain_slop * definition.radius, .part = grain_part<N>};
  const float pull = length(definition.gravity);
  for (int k = 0; k < N && pull > 0; ++k) pass.up[k] = -grain_settle * definition.gravity[k] / pull;
  measure_surfaces(pass);
  for_slabs_in_turn(false, [&](GrainSlab<N>& slab) {
    kernels->press(slab.blocks.data(), 0, slab.block_count, place.data(), motion.data(), pass);
  });
  kernels->press_surface(wall_blocks.data(), 0, int(wall_blocks.size()), place.data(), motion.data(), pass);
  for (Contact& c : body_contacts) {
    c.friction -= dot(c.friction, c.normal) * c.normal;
    apply_body(c, c.normal_impulse, c.friction, c.rolling);
  }
}

/// Back and forth by turns: weight goes down through a heap in the one direction, what the ground answers in the other.
template <class D>
void GranularState<D>::sweep(float h, bool back) {
  GrainPass pass{.inverse_h = 1 / h, .lightness = lightness(), .rolling = definition.rolling_friction};
  const auto surfaces = [&] {
    for (int i = 0; i < int(wall_blocks.size()); ++i) {
      pass.friction = wall_of[i] < 2 * N ? definition.wall_friction : solids[wall_of[i] - 2 * N].friction;
      kernels->sweep_surface(wall_blocks.data(), i, i + 1, false, motion.data(), pass);
    }
    for (Contact& c : body_contacts) solve_body(c, h);
  };
  if (!back) surfaces();
  pass.friction = definition.friction;
  for_slabs_in_turn(back, [&](GrainSlab<N>& slab) {
    kernels->sweep(slab.blocks.data(), 0, slab.block_count, back, motion.data(), pass);
  });
  if (back) surfaces();
}

/// What walls and fixed bodies took in a substep.
template <class D>
void GranularState<D>::sum_walls() {
  for (const Block& c : wall_blocks)
    for (int lane = 0; lane < grain_lanes && grain_in(c, lane) >= 0; ++lane) {
      Vector impulse{};
      for (int k = 0; k < N; ++k) impulse[k] = c.push[lane] * c.normal[k][lane];
      if constexpr (N == 2)
        impulse += c.grip[0][lane] * Vector{-c.normal[1][lane], c.normal[0][lane]};
      else
        impulse += Vector{c.grip[0][lane], c.grip[1][lane], c.grip[2][lane]};
      wall_impulse += Position(impulse);
    }
}

/// m/s, of a grain beside a shape.
template <class D>
float GranularState<D>::fastest_beside_solids() const {
  float most = 0;
  for (std::size_t i = 0; i < wall_blocks.size(); ++i)
    for (int lane = 0; wall_of[i] >= 2 * N && lane < grain_lanes && grain_in(wall_blocks[i], lane) >= 0; ++lane) {
      const Vector& v = grains[grain_in(wall_blocks[i], lane)].v;
      most = math::max(most, dot(v, v));
    }
  for (const Contact& c : body_contacts) most = math::max(most, dot(grains[c.a].v, grains[c.a].v));
  return math::sqrt(most);
}

/// One search, and substeps for as long as it holds, `dt` seconds at most of a `whole` step: returns how long. How fast
/// grains fall together does not matter, nor on a wall: no two pass each other by more than `pair_way` in a substep,
/// nor one a shape, which may be hollow, by more than half a radius. What takes a blow takes sweeps: as many for each
/// radius that two pass each other by, in however many substeps.
template <class D>
float GranularState<D>::round(float dt, float whole) {
  sort();
  const float shortest = whole / float(most_grain_substeps);
  dt = math::min(dt, math::max(time_to_search(dt), shortest));
  to_rows();
  find_surfaces(dt);
  look_around();
  find_pairs(dt);
  const float share = dt / whole;
  const int most = math::max(1, int(share * float(most_grain_substeps)));
  int parts = math::max(1, int(math::ceil(share * float(definition.substeps) - 1e-3f)));
  int sweeps = int(math::ceil(share * float(definition.substeps * definition.iterations) - 1e-3f));
  const float pull = solids.empty() ? 0 : dt * length(definition.gravity);
  float passing = 0;  // radii
  for (const GrainSlab<N>& slab : slabs) passing = math::max(passing, slab.fastest * dt / definition.radius);
  const float beside = 2 * (fastest_beside_solids() + pull) * dt / definition.radius;
  parts = math::max(parts, int(math::ceil(math::min(math::max(passing / pair_way<N>, beside), float(most)))));
  const float blows = sweeps_per_way<N> * math::min(passing, pair_way<N> * float(most));
  sweeps = math::max(math::max(sweeps, 2 * parts), int(math::ceil(blows)));
  const float h = dt / float(parts), scale = last_h > 0 ? h / last_h : 0;  // impulses of a steady load go with it
  last_h = h;
  scale_surfaces(scale);
  const GrainPass pass{.lightness = lightness()};
  for_slabs([&](GrainSlab<N>& slab, int) {
    kernels->recall(slab.blocks.data(), 0, slab.block_count, slab.was.data(), held.data(), scale, motion.data(), pass);
  });
  const int count = int(grains.size());
  // A row begins with what a place or a velocity is.
  const float still[4] = {};
  float time[4] = {}, gained[4] = {};
  for (int k = 0; k < N; ++k) {
    time[k] = h;
    gained[k] = h * definition.gravity[k];
  }
  const auto move = [&](const float* times, const float* gains) {
    scheduler->parallel_for(count, 2048, [&](int begin, int end, int) {
      kernels->move(place.data(), motion.data(), begin, end, times, gains);
    });
  };
  move(still, gained);
  for (int part = 0, swept = 0, stage = 0, looked = 0; part < parts; ++part) {
    for (GrainBody<D>& b : bodies)
      if (b.moves) b.velocity += h * b.gain;
    for (const int last = part == 0 ? 0 : math::min(part * grain_stages / parts + 1, grain_stages - 1); stage < last;) {
      ++stage;  // the next to come, at most
      for_slabs([&](GrainSlab<N>& slab, int index) { place_later(slab, slab_begin(index + 1), stage); });
    }
    press();
    for (const int end = (part + 1) * sweeps / parts; swept < end; ++swept) sweep(h, swept % 2 == 0);
    sum_walls();
    // In space it is foreseen that anything may stop.
    const bool last = part + 1 == parts, looks = N == 2 && !last && stage > looked + 2 && dt > shortest;
    move(time, last || looks ? still : gained);
    if (!looks) continue;
    looked = stage;
    const float gone = h * float(part + 1);
    if (astray(gone)) {
      dt = gone;
      break;
    }
    move(still, gained);
  }
  from_rows();
  number_late();
  held.resize((std::size_t(pair_count) + late.size()) * grain_held<N>);
  for_slabs([&](GrainSlab<N>& slab, int) {
    kernels->keep(slab.blocks.data(), 0, slab.block_count, slab.pair_of.data(), held.data());
  });
  statistics.contacts = watched;
  statistics.wall_contacts = int(touches.size());
  return dt;
}

template <class D>
core::Status GranularState<D>::step(rigid::World<D>* world, float dt) {
  const auto began = std::chrono::steady_clock::now();
  statistics = {};
  wall_impulse = {};
  solids.clear();
  bodies.clear();
  if (world) {
    const core::Status gathered = gather(*world);
    if (!gathered.ok()) return gathered;
  }
  const core::ParallelRegion region(*scheduler);
  float fastest = 0;
  for (const Grain<D>& g : grains) fastest = math::max(fastest, dot(g.v, g.v));
  fastest = math::sqrt(fastest) + dt * length(definition.gravity);
  statistics.max_speed = fastest;
  for (float left = dt; left > 1e-6f * dt;) left -= round(left, dt);
  for (const GrainSlab<N>& slab : slabs)
    statistics.max_overlap =
        math::max(statistics.max_overlap, kernels->deepest(slab.blocks.data(), 0, slab.block_count, place.data()));
  statistics.grains = int(grains.size());
  for (const GrainBody<D>& b : bodies) {
    if (!b.moves || (dot(b.impulse, b.impulse) == 0 && grain_size(b.turn) == 0)) continue;
    core::Status pushed = world->add_force(b.id, b.impulse / dt);
    if (!pushed.ok()) return pushed;
    core::Status twisted = world->add_torque(b.id, b.turn / dt);
    if (!twisted.ok()) return twisted;
  }
  const auto now = std::chrono::steady_clock::now();
  statistics.milliseconds = std::chrono::duration<double, std::milli>(now - began).count();
  return {};
}

}  // namespace carom::particles::detail
