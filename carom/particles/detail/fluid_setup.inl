// Making a fluid's grid, filling it, and what can be asked of it.
#pragma once

#include "carom/core/string.h"
#include "carom/particles/detail/fluid_particles.inl"

namespace carom::particles::detail {

template <class D>
void FluidState<D>::make_grid() {
  cell = 2 * definition.spacing;
  inverse_cell = 1 / cell;
  int stride = 1;
  grid.first = 0;
  for (int a = 0; a < N; ++a) {
    const double size = (definition.upper[a] - definition.lower[a]) / double(cell);
    grid.cells[a] = math::max(1, int(size - 1e-4) + 1);
    grid.stride[a] = stride;
    grid.first += stride;
    stride *= grid.cells[a] + 2;
  }
  if (N == 2) grid.stride[2] = 0;
  grid.size = stride;
  cell_mass = definition.density;
  for (int a = 0; a < N; ++a) cell_mass *= cell;
  particle_mass = cell_mass * room_of_particle();
  for (int a = 0; a < N; ++a) {
    carried[a].assign(2 * std::size_t(grid.size) + 4, 0.0f);
    for (auto* field : {&velocity[a], &spread[a], &open[a], &fixed_open[a]}) field->assign(grid.size + 4, 0.0f);
    known[a].assign(grid.size + 4, 0);
  }
  for (auto* field :
       {&mass, &node_distance, &fixed_distance, &room, &fixed_room, &fill, &level, &pressure, &volume, &fixed_volume})
    field->assign(grid.size + 4, 0.0f);
  if (definition.surface_tension > 0)
    for (auto* field : {&curvature, &smooth}) field->assign(grid.size + 4, 0.0f);
  std::fill(level.begin(), level.end(), 1.0f);
  node_owner.assign(grid.size + 4, -1);
  kind.assign(grid.size + 4, fluid_air);
  row_of.assign(grid.size, -1);
  component.assign(grid.size, -2);
  cell_start.assign(grid.size + 1, 0);
}

template <class D>
void FluidState<D>::reserve() {
  const std::size_t n = std::size_t(definition.max_particles);
  particles.reserve(n);
  sorted.reserve(n);
  cell_of.reserve(n);
  places.reserve(n);
  int inner = 1;
  for (int a = 0; a < N; ++a) inner *= grid.cells[a];
  // A cell is liquid from half the rest density on, and its kernel reaches over its neighbours.
  const std::size_t rows = math::min(std::size_t(inner), 2 * n + 16);
  liquid.reserve(rows);
  queue.reserve(inner);
  system.rows.reserve(rows);
  system.below.reserve(rows);
  for (auto* list : {&system.up, &system.down}) list->reserve(rows / FluidRuns::together + 1);
  system.above.reserve(rows);
  for (auto* v : system.vectors()) v->reserve(rows + 1);
  budgets.reserve(n);
  painted.reserve(64);
  solids.reserve(64);
  bodies.reserve(64);
  memory.reserve(64);
  found.reserve(64);
  system.touched.reserve(4096);
  body_push.reserve((n / move_grain + 1) * 16);
  body_twist.reserve((n / move_grain + 1) * 16);
}

/// Lattice points of the box, or of the ball of this radius about its lower corner; −1: the corner alone.
template <class D>
core::Status FluidState<D>::fill_lattice(Position lower, Position upper, float radius, Vector speed, std::uint32_t tag,
                                         const char* call) {
  for (int a = 0; a < N; ++a)
    if (!math::is_finite(lower[a]) || !math::is_finite(upper[a]) || !math::is_finite(speed[a]) ||
        !(math::abs(speed[a]) <= 1e4f))
      return core::Error{
          core::text(call, ": place or velocity is not finite in component ", a, ", or a velocity is above 10000 m/s")};
  const std::size_t before = particles.size();
  const bool ball = radius > 0, point = radius < 0;
  const double step = double(definition.spacing);
  double from[3] = {0, 0, 0};
  int count[3] = {1, 1, 1};
  for (int a = 0; a < N; ++a) {
    // From the corner of the box, half a spacing in; of a ball, symmetric about its middle.
    double low = math::max(ball ? lower[a] - double(radius) : lower[a], definition.lower[a]);
    const double high =
        math::min(ball ? lower[a] + double(radius) : upper[a], definition.lower[a] + double(cell) * grid.cells[a]);
    if (point) {
      from[a] = lower[a];
      continue;
    }
    const double size = (high - low) / step;
    if (!(size >= 0)) return {};
    count[a] = int(size + 1e-3);
    if (ball) low = lower[a] - 0.5 * step * count[a];
    from[a] = low + 0.5 * step;
  }
  for (int k = 0; k < count[2]; ++k)
    for (int j = 0; j < count[1]; ++j)
      for (int i = 0; i < count[0]; ++i) {
        const int at[3] = {i, j, k};
        Particle p{};
        bool inside = true;
        double square = 0;
        for (int a = 0; a < N; ++a) {
          const double x = from[a] + step * at[a];
          square += (x - lower[a]) * (x - lower[a]);
          p.x[a] = float((x - definition.lower[a]) / double(cell));
          p.v[a] = speed[a];
          inside = inside && p.x[a] > 0 && p.x[a] < float(grid.cells[a]);
        }
        if (!inside || (ball && square > double(radius) * double(radius))) continue;
        p.tag = tag;
        if (int(particles.size()) >= definition.max_particles) {
          particles.resize(before);
          return core::Error{core::text(call, ": more than max_particles = ", definition.max_particles, " particles")};
        }
        particles.push_back(p);
      }
  for (std::size_t p = before; p < particles.size(); ++p) {
    Vector place{};
    for (int a = 0; a < N; ++a) place[a] = particles[p].x[a] * cell;
    places.push_back(place);
  }
  return {};
}

/// Between the centres of cells; what is beyond the domain counts as its margin.
template <class D>
float FluidState<D>::at_cells(const std::vector<float>& field, Position point) const {
  int at = grid.first;
  float part[N];
  for (int a = 0; a < N; ++a) {
    const double x = (point[a] - definition.lower[a]) * double(inverse_cell) - 0.5;
    if (!(x > -1 && x < grid.cells[a])) return 0;
    const int i = int(x + 1) - 1;
    part[a] = float(x - i);
    at += i * grid.stride[a];
  }
  float sum = 0;
  for (int corner = 0; corner < (1 << N); ++corner) {
    int c = at;
    float weight = 1;
    for (int a = 0; a < N; ++a) {
      const bool up = (corner >> a) & 1;
      if (up) c += grid.stride[a];
      weight *= up ? part[a] : 1 - part[a];
    }
    sum += weight * field[c];
  }
  return sum;
}

/// Linear between liquid cells about the point; what the surface or a wall cuts off goes on with the local gradient of
/// the liquid's own weight.
template <class D>
float FluidState<D>::pressure_at(Position point) const {
  if (!(pressure_dt > 0)) return 0;
  int at = grid.first;
  double x[N];
  int low[N];
  for (int a = 0; a < N; ++a) {
    x[a] = (point[a] - definition.lower[a]) * double(inverse_cell) - 0.5;
    if (!(x[a] > -1 && x[a] < grid.cells[a])) return 0;
    low[a] = int(x[a] + 1) - 1;
    at += low[a] * grid.stride[a];
  }
  const float scale = definition.density * cell / pressure_dt;
  double sum = 0, weights = 0;
  for (int corner = 0; corner < (1 << N); ++corner) {
    int c = at;
    double weight = 1, lift = 0;
    for (int a = 0; a < N; ++a) {
      const int up = (corner >> a) & 1;
      c += up ? grid.stride[a] : 0;
      const double distance = x[a] - (low[a] + up);
      weight *= 1 - math::abs(distance);
      lift += distance * double(cell) * double(definition.gravity[a]) * double(definition.density);
    }
    if (kind[c] != fluid_liquid) continue;
    sum += weight * (double(pressure[c] * scale) + lift);
    weights += weight;
  }
  return weights > 0 ? float(sum / weights) : 0.0f;
}

template <class D>
double FluidState<D>::surface_height(Position point) const {
  int at = grid.first;
  for (int a = 0; a < N; ++a) {
    if (a == 1) continue;
    const double x = (point[a] - definition.lower[a]) * double(inverse_cell);
    if (!(x >= 0 && x < grid.cells[a])) return definition.lower[1];
    at += int(x) * grid.stride[a];
  }
  for (int j = grid.cells[1] - 1; j >= 0; --j) {
    const int c = at + j * grid.stride[1];
    if (kind[c] != fluid_liquid) continue;
    const float above = level[c + grid.stride[1]];
    const float theta = j + 1 < grid.cells[1] ? level[c] / (level[c] - math::max(above, 1e-3f)) : 0.5f;
    return definition.lower[1] + (j + 0.5 + double(math::clamp(theta, 0.0f, 1.0f))) * double(cell);
  }
  return definition.lower[1];
}

template <class D>
double FluidState<D>::kinetic_energy() const {
  double sum = 0;
  for (const Particle& p : particles)
    for (const float v : p.v) sum += double(v) * v;
  return 0.5 * double(particle_mass) * sum;
}

template <class D>
double FluidState<D>::potential_energy() const {
  double sum = 0;
  for (const Particle& p : particles)
    for (int a = 0; a < N; ++a)
      sum -= double(definition.gravity[a]) * (definition.lower[a] + double(p.x[a]) * double(cell));
  return double(particle_mass) * sum;
}

/// The particles' own turning: the affine part of the transfer conserves Σ c about cells' points, of which a linear
/// kernel has moments f(1 − f) along every axis.
template <class D>
std::conditional_t<D::dimension == 2, double, Vec3d> FluidState<D>::angular_momentum() const {
  double sum[3] = {0, 0, 0};
  for (const Particle& p : particles) {
    const FluidStencil<N> s(p.x);
    double x[3] = {0, 0, 0}, v[3] = {0, 0, 0};
    for (int a = 0; a < N; ++a) {
      x[a] = definition.lower[a] + double(p.x[a]) * double(cell);
      v[a] = p.v[a];
    }
    sum[0] += x[1] * v[2] - x[2] * v[1];
    sum[1] += x[2] * v[0] - x[0] * v[2];
    sum[2] += x[0] * v[1] - x[1] * v[0];
    const auto own = [&](int a, int b) {  // of ∂v_a/∂x_b
      const double f = s.share(a, b);
      return double(cell) * double(p.c[a * N + b]) * f * (1 - f);
    };
    sum[2] += own(1, 0) - own(0, 1);
    if constexpr (N == 3) {
      sum[0] += own(2, 1) - own(1, 2);
      sum[1] += own(0, 2) - own(2, 0);
    }
  }
  if constexpr (N == 2)
    return double(particle_mass) * sum[2];
  else
    return double(particle_mass) * Vec3d{sum[0], sum[1], sum[2]};
}

template <class D>
std::size_t FluidState<D>::bytes() const {
  std::size_t sum = sizeof *this + (particles.capacity() + sorted.capacity()) * sizeof(Particle) +
                    cell_of.capacity() * sizeof(int) + places.capacity() * sizeof(Vector) +
                    system.rows.capacity() * (sizeof(FluidRow<N>) + 7 * sizeof(float)) +
                    budgets.capacity() * sizeof(Budget) + liquid.capacity() * sizeof(int);
  // Fields over the padded grid, by what a cell has of each.
  sum += std::size_t(grid.size) * (std::size_t(N) * 7 * sizeof(float) + 9 * sizeof(float) + 4 * sizeof(int));
  return sum;
}

}  // namespace carom::particles::detail
