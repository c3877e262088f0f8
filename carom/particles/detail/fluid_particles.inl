// The grid back to the particles, their way through a step, taps and drains.
#pragma once

#include "carom/particles/detail/fluid_pressure.inl"

namespace carom::particles::detail {

namespace {

constexpr float wall_gap = 0.05f;  // of a cell: how near particles come to a wall

/// Value and gradient (per cell) of a field of component a's faces at a particle.
template <int N>
CAROM_SIMD_INLINE float gather_component(const FluidStencil<N>& s, int a, const FluidGrid& grid, const float* field,
                                         float* gradient) {
  const float fx = s.share(a, 0), fy = s.share(a, 1);
  int at = grid.first + s.low(a, 0) + s.low(a, 1) * grid.stride[1];
  if constexpr (N == 2) {
    const float* p = field + at;
    const float* q = p + grid.stride[1];
    const float low = p[0] + fx * (p[1] - p[0]), high = q[0] + fx * (q[1] - q[0]);
    if (gradient) {
      gradient[0] = (p[1] - p[0]) + fy * ((q[1] - q[0]) - (p[1] - p[0]));
      gradient[1] = high - low;
    }
    return low + fy * (high - low);
  } else {
    at += s.low(a, 2) * grid.stride[2];
    const float fz = s.share(a, 2);
    const float* p00 = field + at;
    const float* p10 = p00 + grid.stride[1];
    const float* p01 = p00 + grid.stride[2];
    const float* p11 = p01 + grid.stride[1];
    const float d00 = p00[1] - p00[0], d10 = p10[1] - p10[0], d01 = p01[1] - p01[0], d11 = p11[1] - p11[0];
    const float v00 = p00[0] + fx * d00, v10 = p10[0] + fx * d10, v01 = p01[0] + fx * d01, v11 = p11[0] + fx * d11;
    const float v0 = v00 + fy * (v10 - v00), v1 = v01 + fy * (v11 - v01);
    if (gradient) {
      const float d0 = d00 + fy * (d10 - d00), d1 = d01 + fy * (d11 - d01);
      gradient[0] = d0 + fz * (d1 - d0);
      gradient[1] = (v10 - v00) + fz * ((v11 - v01) - (v10 - v00));
      gradient[2] = v1 - v0;
    }
    return v0 + fz * (v1 - v0);
  }
}

/// Value and gradient (per cell) of a field of nodes.
template <int N>
inline float gather_nodes(const float (&x)[N], const FluidGrid& grid, const float* field, float (&gradient)[N],
                          int& nearest) {
  int at = grid.first;
  float part[N];
  for (int b = 0; b < N; ++b) {
    const int i = int(x[b]);
    part[b] = x[b] - float(i);
    at += i * grid.stride[b];
  }
  float value = 0, least = 0;
  for (int b = 0; b < N; ++b) gradient[b] = 0;
  nearest = at;
  for (int corner = 0; corner < (1 << N); ++corner) {
    int node = at;
    float weight = 1;
    for (int b = 0; b < N; ++b) {
      const bool up = (corner >> b) & 1;
      if (up) node += grid.stride[b];
      weight *= up ? part[b] : 1 - part[b];
    }
    const float d = field[node];
    if (corner == 0 || d < least) {
      least = d;
      nearest = node;
    }
    value += weight * d;
    for (int b = 0; b < N; ++b) {
      float slope = (corner >> b) & 1 ? 1.0f : -1.0f;
      for (int o = 0; o < N; ++o)
        if (o != b) slope *= (corner >> o) & 1 ? part[o] : 1 - part[o];
      gradient[b] += slope * d;
    }
  }
  return value;
}

}  // namespace

/// Faces within solids: of the velocity that was continued there, what leads through the surface becomes the solid's.
template <class D>
void FluidState<D>::hold_at_walls() {
  for (int a = 0; a < N; ++a) {
    FluidRange faces = whole();
    faces.high[a] += 1;
    for_cells(grid, faces, [&](int i, int j, int k, int f) {
      if (open[a][f] > 0 || !(carried[a][2 * f] > 0)) return;
      float x[N];
      const int at[3] = {i, j, k};
      bool edge = false;
      for (int b = 0; b < N; ++b) {
        x[b] = math::clamp(float(at[b]) + (b == a ? 0.0f : 0.5f), 0.0f, float(grid.cells[b]) - 0.001f);
        edge = edge || at[b] == 0 || at[b] >= grid.cells[b] - 1;
      }
      float slope[N];
      int nearest = 0;
      (void)gather_nodes<N>(x, grid, node_distance.data(), slope, nearest);
      float square = 0;
      for (int b = 0; b < N; ++b) square += slope[b] * slope[b];
      if (!(square > 0)) return;
      const int owner = node_owner[nearest];
      const Vector solid = solid_velocity(owner, a, f);
      float through = (velocity[a][f] - solid[a]) * slope[a];
      for (int b = 0; b < N && !edge; ++b) {
        if (b == a) continue;
        const int n = f - grid.stride[a];
        const float mean = 0.25f * ((velocity[b][f] + velocity[b][f + grid.stride[b]]) +
                                    (velocity[b][n] + velocity[b][n + grid.stride[b]]));
        through += (mean - solid[b]) * slope[b];
      }
      spread[a][f] = velocity[a][f] - through * slope[a] / square;
    });
  }
  for (int a = 0; a < N; ++a) {
    FluidRange faces = whole();
    faces.high[a] += 1;
    for_cells(grid, faces, [&](int, int, int, int f) {
      if (open[a][f] > 0 || !(carried[a][2 * f] > 0)) return;
      velocity[a][f] = spread[a][f];
      known[a][f] = 2;
    });
  }
}

template <class D>
void FluidState<D>::to_particles() {
  const int count = int(particles.size());
  parallel(count, 2048, [&](int begin, int end, int) {
    for (int p = begin; p < end; ++p) {
      Particle& particle = particles[p];
      const FluidStencil<N> stencil(particle.x);
      float way[N];
      for (int a = 0; a < N; ++a) {
        particle.v[a] = gather_component<N>(stencil, a, grid, velocity[a].data(), particle.c + a * N);
        way[a] = gather_component<N>(stencil, a, grid, spread[a].data(), nullptr);
      }
      for (int a = 0; a < N; ++a) particle.x[a] += way[a];
    }
  });
}

/// What the transfers and the air next to the surface made of the momentum of every part of the liquid is set right:
/// what it had, its weight, and what walls and bodies took. So bodies and liquid exchange exactly opposite impulses.
template <class D>
void FluidState<D>::balance(float dt) {
  for (int c = 0, p = 0; c < grid.size; ++c)
    for (; p < cell_start[c + 1]; ++p) {
      Budget& b = budgets[component[c]];
      for (int a = 0; a < N; ++a) b.after[a] += particles[p].v[a];
    }
  for (Budget& b : budgets)
    for (int a = 0; a < N; ++a)
      b.after[a] =
          (b.before[a] - b.given[a] / particle_mass - b.after[a]) / b.mass + double(definition.gravity[a] * dt);
}

/// Along the velocity field (to second order by its gradient), out of solids, and in free fall where there is only air.
template <class D>
void FluidState<D>::move(float dt) {
  const int count = int(particles.size());
  const int chunks = (count + move_grain - 1) / move_grain;
  const int pushed = int(bodies.size()) + 1;
  body_push.assign(std::size_t(chunks) * pushed, Position{});
  body_twist.assign(std::size_t(chunks) * pushed, Angular{});
  const float rate = dt * inverse_cell;
  parallel(count, move_grain, [&](int begin, int end, int) {
    Position* push = body_push.data() + std::size_t(begin / move_grain) * pushed;
    Angular* twist = body_twist.data() + std::size_t(begin / move_grain) * pushed;
    for (int p = begin; p < end; ++p) {
      Particle& q = particles[p];
      const int c = cell_of[p];
      const Budget& budget = budgets[component[c]];
      for (int a = 0; a < N; ++a) q.v[a] += float(budget.after[a]);
      bool falling = kind[c] != fluid_liquid;
      for (int a = 0; a < N && falling; ++a)
        falling = kind[c - grid.stride[a]] != fluid_liquid && kind[c + grid.stride[a]] != fluid_liquid;
      float way[N];
      for (int a = 0; a < N; ++a) {
        float v = q.v[a];
        for (int b = 0; b < N; ++b) v += 0.5f * rate * q.c[a * N + b] * q.v[b];
        if (falling) v = q.v[a] - 0.5f * definition.gravity[a] * dt;
        way[a] = v;
      }
      // In pieces of half a cell, so that nothing jumps over what is thin.
      float farthest = 0;
      for (int a = 0; a < N; ++a) farthest = math::max(farthest, math::abs(way[a]) * rate);
      const int pieces = farthest < 8 ? 1 + int(2 * farthest) : 16;
      for (int piece = 0; piece < pieces; ++piece) {
        for (int a = 0; a < N; ++a) {
          q.x[a] += rate * way[a] / float(pieces);
          // Walls of the domain are solid; an open side lets the particle go, and the next sort drops it.
          if (definition.walls[2 * a]) q.x[a] = math::max(q.x[a], 0.001f);
          if (definition.walls[2 * a + 1]) q.x[a] = math::min(q.x[a], float(grid.cells[a]) - 0.001f);
        }
        if (collide(q, push, twist)) break;
      }
    }
  });
  for (int chunk = 0; chunk < chunks; ++chunk)
    for (int b = 0; b < pushed; ++b) {
      const Position& impulse = body_push[std::size_t(chunk) * pushed + b];
      if (b + 1 < pushed && bodies[b].moves)
        give(bodies[b], Vector(impulse), body_twist[std::size_t(chunk) * pushed + b]);
      else
        wall_impulse += impulse;
    }
}

/// Out of a solid, and no further into it; true where there was one.
template <class D>
bool FluidState<D>::collide(Particle& q, Position* push, Angular* twist) {
  for (int a = 0; a < N; ++a)
    if (!(q.x[a] > 0 && q.x[a] < float(grid.cells[a]))) return false;
  int base = grid.first;
  for (int a = 0; a < N; ++a) base += int(q.x[a]) * grid.stride[a];
  if (node_distance[base] > 2 * cell) return false;  // a distance changes by no more than √3 cells within a cell
  float slope[N];
  int nearest = 0;
  const float d = gather_nodes<N>(q.x, grid, node_distance.data(), slope, nearest) * inverse_cell;
  if (d >= wall_gap) return false;
  float square = 0;
  for (int a = 0; a < N; ++a) square += slope[a] * slope[a];
  if (!(square > 0)) return false;
  const float size = math::sqrt(square);
  const int owner = node_owner[nearest];
  Vector normal{}, place{}, solid{};
  for (int a = 0; a < N; ++a) {
    normal[a] = slope[a] / size;
    q.x[a] += math::min(wall_gap - d, 1.0f) * normal[a];
    if (definition.walls[2 * a]) q.x[a] = math::max(q.x[a], 0.001f);
    if (definition.walls[2 * a + 1]) q.x[a] = math::min(q.x[a], float(grid.cells[a]) - 0.001f);
    place[a] = q.x[a] * cell;
  }
  if (owner >= 0) solid = bodies[owner].velocity + turned(bodies[owner].spin, place - bodies[owner].center);
  float into = 0;
  for (int a = 0; a < N; ++a) into += (q.v[a] - solid[a]) * normal[a];
  if (into >= 0) return true;
  const Vector impulse = (into * particle_mass) * normal;
  for (int a = 0; a < N; ++a) q.v[a] -= into * normal[a];
  const int slot = owner >= 0 ? owner : int(bodies.size());
  push[slot] += Position(impulse);
  if (owner >= 0) twist[slot] += cross_of(place - bodies[owner].center, impulse);
  return true;
}

/// Layers of particles come out of the taps, evenly spaced along the jet whatever the step.
template <class D>
void FluidState<D>::emit(float dt) {
  for (std::size_t t = 0; t < taps.size(); ++t) {
    const FluidTap<D>& tap = taps[t];
    if (!tap.open) continue;
    const float speed = length(tap.velocity);
    const Vector along = tap.velocity / speed;
    Vector side[2];
    if constexpr (N == 2) {
      side[0] = {-along.y, along.x};
    } else {
      const Vector other = math::abs(along.y) < 0.9f ? Vector{0, 1, 0} : Vector{1, 0, 0};
      side[0] = cross(along, other);
      side[0] /= length(side[0]);
      side[1] = cross(along, side[0]);
    }
    const float spacing = definition.spacing;
    const int reach = int(tap.radius / spacing);
    tap_phase[t] += speed * dt;
    while (tap_phase[t] >= spacing) {
      tap_phase[t] -= spacing;
      for (int j = N == 2 ? 0 : -reach; j <= (N == 2 ? 0 : reach); ++j)
        for (int i = -reach; i <= reach; ++i) {
          const float x = float(i) * spacing, y = float(j) * spacing;
          if (x * x + y * y > tap.radius * tap.radius || int(particles.size()) >= definition.max_particles) continue;
          Vector r = tap_phase[t] * along + x * side[0];
          if constexpr (N == 3) r += y * side[1];
          Particle p{};
          const Position at = (tap.center - definition.lower) + Position(r);
          for (int a = 0; a < N; ++a) {
            p.x[a] = float(at[a] * double(inverse_cell));
            p.v[a] = tap.velocity[a];
          }
          p.tag = tap.tag;
          particles.push_back(p);
        }
    }
  }
}

template <class D>
void FluidState<D>::substep(float dt) {
  const auto now = [] { return std::chrono::steady_clock::now(); };
  auto last = now();
  const auto lap = [&](int stage) {
    const auto t = now();
    statistics.milliseconds[stage] += std::chrono::duration<double, std::milli>(t - last).count();
    last = t;
  };
  sort();
  lap(0);
  to_grid();
  lap(1);
  place_solids();
  classify();
  label();
  tension_dt = definition.surface_tension * dt * inverse_cell * inverse_cell / definition.density;
  measure_curvature();
  lap(2);
  accelerate(dt);
  project(dt);
  continue_velocities(velocity, 1);
  hold_at_walls();
  continue_velocities(velocity, 2);
  if (N == 3) continue_velocities(velocity, 3);
  lap(3);
  spread_particles(dt);
  continue_velocities(spread, 1);
  lap(4);
  to_particles();
  // The cells in which particles were carried to the grid: their component and kind.
  for (int c = 0, p = 0; c < grid.size; ++c)
    for (; p < cell_start[c + 1]; ++p) cell_of[p] = c;
  balance(dt);
  move(dt);
  lap(5);
}

template <class D>
core::Status FluidState<D>::step(rigid::World<D>* world, float dt) {
  statistics = {};
  wall_impulse = {};
  if (world) {
    const core::Status gathered = gather_solids(*world, dt);
    if (!gathered.ok()) return gathered;
  } else if (!fixed_known || !solids.empty() || fixed_hash != 0) {
    solids.clear();
    bodies.clear();
    fixed_hash = 0;
    fixed_known = true;
    paint_fixed();
  }
  const core::ParallelRegion region(*scheduler);
  emit(dt);
  float fastest = 0;
  for (const Particle& p : particles) {
    float square = 0;
    for (int a = 0; a < N; ++a) square += p.v[a] * p.v[a];
    fastest = math::max(fastest, square);
  }
  fastest = math::sqrt(fastest);
  statistics.max_speed = fastest;
  const float crossed = (fastest + length(definition.gravity) * dt) * dt * inverse_cell / definition.courant;
  const int ripples = capillary_substeps(dt);
  if (ripples > most_ripples)
    return core::Error{core::text("Fluid::step: a surface tension of ", definition.surface_tension,
                                  " N/m at a spacing of ", definition.spacing, " m needs ", ripples,
                                  " substeps in dt, expected ", most_ripples, " at most: a shorter step")};
  int parts = crossed < float(definition.max_substeps) ? math::max(1, int(crossed) + 1) : definition.max_substeps;
  parts = math::max(parts, ripples);
  statistics.substeps = parts;
  for (int k = 0; k < parts; ++k) substep(dt / float(parts));
  statistics.particles = int(particles.size());
  statistics.liquid_cells = int(liquid.size());
  places.resize(particles.size());
  for (std::size_t p = 0; p < particles.size(); ++p)
    for (int a = 0; a < N; ++a) places[p][a] = particles[p].x[a] * cell;
  memory.clear();
  for (FluidBody<D>& body : bodies) {
    if (!body.moves) continue;
    FluidMemory<D> m{body.id, {}, dt};
    const auto state = world->state(body.id);
    if (!state.ok()) continue;
    bool any = false;
    for (int a = 0; a < N; ++a) {
      m.velocity[a] = state->linear_velocity[a] + body.inverse_mass[a] * body.impulse[a];
      any = any || body.impulse[a] != 0;
    }
    memory.push_back(m);
    if (!any) continue;
    // As forces, so that they act evenly through the world's step, together with the weight that they balance.
    core::Status pushed = world->add_force(body.id, body.impulse / dt);
    if (!pushed.ok()) return pushed;
    core::Status twisted = world->add_torque(body.id, body.turn / dt);
    if (!twisted.ok()) return twisted;
  }
  return {};
}

}  // namespace carom::particles::detail
