// The pressure: one symmetric system for the liquid's cells and the bodies in it (solved in fluid_solver.inl), and what
// it does to the velocities.
#pragma once

#include "carom/particles/detail/fluid_surface.inl"

namespace carom::particles::detail {

namespace {
constexpr float least_depth = 0.05f;  // of a surface below the centre of its cell, in cells: bounds the system's spread
}

/// u* = momentum / mass + g dt, and what viscosity takes from face to face.
template <class D>
void FluidState<D>::accelerate(float dt) {
  for (int a = 0; a < N; ++a) {
    const float push = definition.gravity[a] * dt;
    const float* from = carried[a].data();
    float* to = velocity[a].data();
    std::uint8_t* state = known[a].data();
    parallel(grid.size, 1 << 15, [&](int begin, int end, int) {
      for (int f = begin; f < end; ++f) {
        const float m = from[2 * f];
        to[f] = m > 0 ? from[2 * f + 1] / m + push : 0.0f;
        state[f] = 0;
      }
    });
  }
  for (FluidBody<D>& body : bodies)
    if (body.moves) body.velocity += dt * body.gain;
  const float number = definition.viscosity * dt * inverse_cell * inverse_cell;
  if (!(number > 1e-6f)) return;
  // Explicit, in as many parts as stability asks for; `spread` is scratch here.
  const int parts = math::min(1 + int(number * float(4 * N)), 64);
  const float share = math::min(number / float(parts), 0.5f / float(2 * N));
  for (int part = 0; part < parts; ++part)
    for (int a = 0; a < N; ++a) {
      const float* m = carried[a].data();
      FluidRange faces = whole();
      faces.high[a] += 1;
      for_cells(grid, faces, [&](int, int, int, int f) {
        float change = 0;
        if (m[2 * f] > 0 && open[a][f] > 0)
          for (int b = 0; b < N; ++b)
            for (const int n : {f - grid.stride[b], f + grid.stride[b]})
              if (m[2 * n] > 0 && open[a][n] > 0)
                change += math::min(1.0f, m[2 * n] / m[2 * f]) * (velocity[a][n] - velocity[a][f]);
        spread[a][f] = velocity[a][f] + share * change;
      });
      for_cells(grid, faces, [&](int, int, int, int f) { velocity[a][f] = spread[a][f]; });
    }
}

/// One row for every liquid cell: Σ w (P − P_n) + what the bodies give way = −div u, with w the open share of a face.
/// Towards the air the pressure falls to nothing at the surface, which lies at the share θ of the way to the next
/// centre.
template <class D>
void FluidState<D>::build_rows() {
  const int n = int(liquid.size());
  FluidSystem<N>& s = system;
  for (int i = 0; i < n; ++i) row_of[liquid[i]] = i;
  s.rows.resize(n);
  for (auto* v : s.vectors()) {
    v->resize(n + 1);
    (*v)[n] = 0;
  }
  parallel(n, 1024, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const int c = liquid[i];
      FluidRow<N>& row = s.rows[i];
      row.diagonal = 0;
      float out = 0, raised = 0;
      for (int a = 0; a < N; ++a) {
        const int up = c + grid.stride[a], down = c - grid.stride[a];
        const auto side = [&](int face, int next, float sign, float& coefficient, int& cell_index) {
          const float w = open[a][face];
          coefficient = 0;
          cell_index = n;
          out += sign * w * velocity[a][face];
          if (w < 1) {
            const int owner = face_owner(a, face);
            if (owner >= 0) out += sign * (1 - w) * solid_velocity(owner, a, face)[a];
          }
          if (w == 0) return;
          if (kind[next] == fluid_liquid) {
            coefficient = -w;
            cell_index = row_of[next];
            row.diagonal += w;
          } else {
            const float theta = level[c] / (level[c] - level[next]);
            row.diagonal += w / math::max(theta, least_depth);
            raised += w / math::max(theta, least_depth) * surface_pressure(c, next, theta);
          }
        };
        side(c, down, -1.0f, row.minus[a], row.minus_cell[a]);
        side(up, up, 1.0f, row.plus[a], row.plus_cell[a]);
      }
      s.right[i] = raised - out;
    }
  });
  s.touched.clear();
  for (int b = 0; b < int(bodies.size()); ++b) {
    FluidBody<D>& body = bodies[b];
    body.first_cell = int(s.touched.size());
    for (const FluidSolid<D>& solid : solids) {
      if (solid.owner != b) continue;
      for_cells(grid, range_of(solid.bounds, 3), [&](int, int, int, int c) {
        if (kind[c] != fluid_liquid) return;
        FluidTouch<N> touch{row_of[c], {}, {}};
        Angular moment{};
        bool any = false;
        for (int a = 0; a < N; ++a)
          for (int up = 0; up < 2; ++up) {
            const int face = up ? c + grid.stride[a] : c;
            const float w = open[a][face];
            if (w == 1 || face_owner(a, face) != b) continue;
            Vector push{};
            push[a] = up ? 1 - w : w - 1;
            touch.area[a] += push[a];
            moment += cross_of(face_place(a, face) - body.center, push);
            any = true;
          }
        // A body of several shapes has each cell once: the first of its shapes that reaches it.
        if (!any) return;
        if (solid.shared)
          for (std::size_t t = body.first_cell; t < s.touched.size(); ++t)
            if (s.touched[t].cell == touch.cell) return;
        if constexpr (N == 2) {
          touch.moment[0] = moment;
        } else {
          for (int k = 0; k < 3; ++k) touch.moment[k] = moment[k];
        }
        s.touched.push_back(touch);
      });
    }
    body.cell_count = int(s.touched.size()) - body.first_cell;
  }
}

/// Where a part of the liquid has no surface, only the differences of pressure are known, and what flows in must be
/// what flows out.
template <class D>
void FluidState<D>::balance_sealed() {
  FluidSystem<N>& s = system;
  for (Budget& b : budgets) {
    b.sealed = true;
    b.excess = 0;
    b.cells = 0;
  }
  for (int i = 0; i < int(liquid.size()); ++i) {
    const int c = liquid[i];
    Budget& b = budgets[component[c]];
    b.excess += s.right[i];
    b.cells += 1;
    for (int a = 0; a < N; ++a)
      for (const int up : {0, 1}) {
        const int face = up ? c + grid.stride[a] : c, next = up ? face : c - grid.stride[a];
        if (open[a][face] > 0 && kind[next] != fluid_liquid) b.sealed = false;
      }
  }
  for (int i = 0; i < int(liquid.size()); ++i) {
    const Budget& b = budgets[component[liquid[i]]];
    if (b.sealed) s.right[i] -= float(b.excess / b.cells);
  }
}

template <class D>
void FluidState<D>::project(float dt) {
  FluidSystem<N>& s = system;
  const int n = int(liquid.size());
  push_solids(dt, true);
  build_rows();
  balance_sealed();
  factorise();
  float largest = 0;
  for (int i = 0; i < n; ++i) {
    largest = math::max(largest, math::abs(s.right[i]));
    s.x[i] = pressure_dt > 0 ? pressure[liquid[i]] * (dt / pressure_dt) : 0.0f;
  }
  const float tolerance = math::max(1e-4f * largest, 1e-6f);
  float left = 0;
  const bool converged = solve(tolerance, 300, true, statistics.iterations, left);
  statistics.converged = statistics.converged && converged;
  statistics.divergence = math::max(statistics.divergence, left);

  std::fill(pressure.begin(), pressure.end(), 0.0f);
  for (int i = 0; i < n; ++i) pressure[liquid[i]] = s.x[i];
  pressure_dt = dt;
  subtract_gradient(velocity, true);

  push_solids(dt, false);
  pull_of_surface();
}

/// Impulses on what closes faces, and their opposite for the liquid: the pressure on a solid's surface within a cell
/// is, by Gauss' theorem, that on the closed parts of the cell's faces less what would weigh in the closed part of it.
template <class D>
void FluidState<D>::push_solids(float dt, bool weight) {
  const int n = int(liquid.size());
  const int count = int(bodies.size());
  body_push.assign(count, Position{});
  body_twist.assign(count, Angular{});
  for (int i = 0; i < n; ++i) {
    const int c = liquid[i];
    Budget& budget = budgets[component[c]];
    const auto push = [&](int a, int owner, float size, const Vector& place) {
      budget.given[a] += size;
      if (owner < 0 || !bodies[owner].moves) {
        wall_impulse[a] += size;
        return;
      }
      Vector force{};
      force[a] = size;
      body_push[owner][a] += size;
      body_twist[owner] += cross_of(place - bodies[owner].center, force);
    };
    float most = 0;
    int nearest = -1;
    for (int a = 0; a < N; ++a)
      for (const int up : {0, 1}) {
        const int face = up ? c + grid.stride[a] : c;
        const float closed = 1 - open[a][face];
        if (!(closed > 0)) continue;
        const int owner = face_owner(a, face);
        if (closed > most) {
          most = closed;
          nearest = owner;
        }
        const float sign = up ? 1.0f : -1.0f;
        const float at_face = weight ? 0.5f * sign * dt * definition.gravity[a] : system.x[i];
        push(a, owner, cell_mass * closed * sign * at_face, face_place(a, face));
      }
    if (!weight || !(most > 0) || volume[c] >= 1) continue;
    Vector middle = face_place(0, c);
    middle[0] += 0.5f * cell;
    for (int a = 0; a < N; ++a) push(a, nearest, -cell_mass * (1 - volume[c]) * dt * definition.gravity[a], middle);
  }
  for (int b = 0; b < count; ++b)
    if (bodies[b].moves) give(bodies[b], Vector(body_push[b]), body_twist[b]);
}

template <class D>
void FluidState<D>::give(FluidBody<D>& body, Vector force, Angular torque) {
  for (int a = 0; a < N; ++a) body.velocity[a] += body.inverse_mass[a] * force[a];
  body.spin += body.inverse_inertia * torque;
  body.impulse += force;
  body.turn += torque;
}

/// u −= ∇P on every open face of a liquid cell.
template <class D>
void FluidState<D>::subtract_gradient(std::vector<float> (&field)[N], bool from_field) {
  const FluidSystem<N>& s = system;
  const int n = int(liquid.size());
  parallel(n, 2048, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const int c = liquid[i];
      for (int a = 0; a < N; ++a) {
        const int up = c + grid.stride[a], down = c - grid.stride[a];
        // The lower face is this cell's; the upper one only where no liquid cell is there to own it.
        if (open[a][c] > 0) {
          float step = s.x[i];
          if (kind[down] == fluid_liquid) {
            step -= s.x[row_of[down]];
          } else {
            const float theta = level[c] / (level[c] - level[down]);
            if (from_field) step -= surface_pressure(c, down, theta);
            step /= math::max(theta, least_depth);
          }
          field[a][c] = (from_field ? field[a][c] : 0.0f) - step;
          known[a][c] = 1;
        }
        if (open[a][up] > 0 && kind[up] != fluid_liquid) {
          const float theta = level[c] / (level[c] - level[up]);
          const float surface = from_field ? surface_pressure(c, up, theta) : 0.0f;
          const float step = (s.x[i] - surface) / math::max(theta, least_depth);
          field[a][up] = (from_field ? field[a][up] : 0.0f) + step;
          known[a][up] = 1;
        }
      }
    }
  });
}

/// A displacement that brings the density of every cell within the liquid back to that at rest, and takes the excess
/// out of those at the surface.
template <class D>
void FluidState<D>::spread_particles(float dt) {
  FluidSystem<N>& s = system;
  const int n = int(liquid.size());
  for (auto& field : spread) std::fill(field.begin(), field.end(), 0.0f);
  for (auto& state : known) std::fill(state.begin(), state.end(), std::uint8_t(0));
  const float rate = math::min(1.0f, dt * spreading_rate);
  double sum = 0, squares = 0;
  int inner = 0;
  for (int i = 0; i < n; ++i) {
    const int c = liquid[i];
    bool within = true;
    for (int a = 0; a < N; ++a)
      within = within && (kind[c - grid.stride[a]] == fluid_liquid || open[a][c] == 0) &&
               (kind[c + grid.stride[a]] == fluid_liquid || open[a][c + grid.stride[a]] == 0);
    const float excess = fill[c] - 1;
    if (within) {
      ++inner;
      sum += fill[c];
      squares += double(excess) * excess;
    }
    s.right[i] = rate * (within ? math::clamp(excess, -0.5f, 0.5f) : math::clamp(excess, 0.0f, 0.5f)) * room[c];
    s.x[i] = 0;
  }
  statistics.mean_density = inner > 0 ? float(sum / inner) : 1.0f;
  statistics.density_deviation = inner > 0 ? float(math::sqrt(squares / inner)) : 0.0f;
  balance_sealed();
  float left = 0;
  (void)solve(1e-3f, 60, false, statistics.spreading_iterations, left);
  subtract_gradient(spread, false);
}

/// Faces that particles reach and the solver did not go on as their neighbours of the layer before do.
template <class D>
void FluidState<D>::continue_velocities(std::vector<float> (&field)[N], int layer) {
  for (int a = 0; a < N; ++a) {
    FluidRange faces = whole();
    faces.high[a] += 1;
    for (int b = 0; b < N; ++b)
      if (b != a) {
        faces.low[b] -= 1;
        faces.high[b] += 1;
      }
    std::uint8_t* state = known[a].data();
    for_cells(grid, faces, [&](int i, int j, int k, int f) {
      if (state[f] != 0 || !(carried[a][2 * f] > 0)) return;
      float sum = 0;
      int count = 0;
      const int at[3] = {i, j, k};
      for (int b = 0; b < N; ++b) {
        const int s = grid.stride[b];
        if (at[b] > faces.low[b] && state[f - s] != 0 && state[f - s] <= layer) sum += field[a][f - s], ++count;
        if (at[b] < faces.high[b] && state[f + s] != 0 && state[f + s] <= layer) sum += field[a][f + s], ++count;
      }
      if (count == 0) return;
      field[a][f] = sum / float(count);
      state[f] = std::uint8_t(layer + 1);
    });
  }
}

}  // namespace carom::particles::detail
