// A substep of cloth: strains, the linear system, contacts, folds.
#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {
constexpr int cloth_chunk = 128;
}  // namespace

ClothLaw ClothState::law() const {
  const float nu = float(fabric.poisson_ratio), warp = float(fabric.warp_stiffness),
              weft = float(fabric.weft_stiffness);
  // Plane stress of an orthotropic sheet: ν₂₁ = ν₁₂ E₂/E₁.
  const float share = 1 / (1 - nu * nu * weft / warp);
  ClothLaw law;
  law.warp = warp * share;
  law.weft = weft * share;
  law.both = nu * weft * share;
  law.shear = float(fabric.shear_stiffness);
  law.press = float(0.5 * air_density * fabric.normal_coefficient);
  law.rub = float(0.5 * air_density * fabric.tangential_coefficient);
  return law;
}

void ClothState::stretch() {
  // A place is told in two floats, so that differences far from the first vertex are as exact as near it.
  tasks().parallel_for(int(position.size()), cloth_chunk, [&](int from, int to, int) {
    for (std::size_t i = std::size_t(from); i < std::size_t(to); ++i) {
      const Vec3d place = position[i] - position[0];
      const Vec3f high(place), low(place - Vec3d(high));
      float* const record = &records[i * cloth_record];
      for (int k = 0; k < 3; ++k) record[k] = high[k], record[4 + k] = low[k], record[8 + k] = velocity[i][k];
    }
  });
  const ClothLaw law = this->law();
  const bool same = wind.profile == environment::WindProfile::uniform && beyond.nodes().empty();
  const Vec3f everywhere(wind.velocity);
  tasks().parallel_for(int(tiles.size()), cloth_chunk / cloth_lanes, [&](int from, int to, int) {
    for (int k = from; k < to; ++k) {
      ClothTile& tile = tiles[std::size_t(k)];
      for (std::size_t lane = 0; lane < cloth_lanes; ++lane) {
        Vec3f air = everywhere;
        if (!same) {
          Vec3d middle{};
          for (const auto& corner : tile.corner) middle += position[std::size_t(corner[lane])];
          middle = middle / 3.0;
          air = Vec3f(environment::wind_at(wind, middle.y) + beyond.at(middle));
        }
        for (int axis = 0; axis < 3; ++axis) tile.air[axis][lane] = air[axis];
      }
    }
    solver.kernels().strain(tiles.data(), from, to, records.data(), law, strains.data());
  });
}

void ClothState::assemble(float h, Vec3f gravity) {
  ClothLaw law = this->law();
  law.weight = h * h + h * float(fabric.damping);
  matrix.link_scale = law.weight;
  // Half of what is stable for any mesh: of the eigenvalues of the links beyond triangles, at most twice `far_share`,
  // the weight must stay below 1.
  matrix.far_ahead = law.weight * far_share < 0.25f;
  const SoftKernels& kernels = solver.kernels();
  float* const blocks = reinterpret_cast<float*>(matrix.blocks.data());
  tasks().parallel_for(int(edges.size()), cloth_chunk / cloth_lanes, [&](int from, int to, int) {
    kernels.join_edges(edges.data(), from, to, edge_sides.data(), strains.data(), law, blocks);
  });
  tasks().parallel_for(int(vertices.size()), cloth_chunk / cloth_lanes, [&](int first, int last, int) {
    kernels.join_corners(vertices.data(), first, last, vertex_sides.data(), strains.data(), law, blocks, rows.data());
    const std::size_t end = std::min(position.size(), std::size_t(last) * cloth_lanes);
    for (std::size_t i = std::size_t(first) * cloth_lanes; i < end; ++i) {
      const int row = int(i);
      if (matrix.far_ahead)
        matrix.blocks[std::size_t(matrix.diagonal(row))].add_diagonal(law.weight * matrix.far_sum(row));
      const float* const r = &rows[i * cloth_row];
      const float along = mass[i] + h * r[3];
      const Vec3f force = Vec3f{r[0], r[1], r[2]} - matrix.pull_of_links(row, position.data());
      solver.diagonal[i] = {{along + h * r[4], h * r[8], h * r[10]},
                            {h * r[8], along + h * r[5], h * r[9]},
                            {h * r[10], h * r[9], along + h * r[6]}};
      solver.right[i] = h * force + (h * mass[i]) * gravity;
    }
  });
  solver.begin(matrix, velocity, tasks());
}

void ClothState::begin_step(rigid::World3& world, double dt) {
  last_step = dt;
  greatest_tension = 0;
  SoftThing::begin_step(world, dt);
  pin_impulse.assign(pins.size(), Vec3d{});
}

void ClothState::begin_substep(float h, Vec3f gravity) {
  stretch();
  assemble(h, gravity);
  obstacles.enter(h, solver);
  hold(h);
}

void ClothState::end_substep(float h) {
  wind_force = {};
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const ClothStrain& strain = strains[t];
    wind_force += 3.0 * Vec3d(strain.wind[0], strain.wind[1], strain.wind[2]);
    greatest_tension = math::max(greatest_tension, double(strain.tension()));
  }
  react_touches(touching(), h, obstacles, solver, pin_impulse.data());
  press_faces(*this, h, pin_impulse.data());
  for (std::size_t i = 0; i < position.size(); ++i) velocity[i] += solver.change[i].vector();
  if (self_collide) keep_apart(h);
  for (std::size_t i = 0; i < position.size(); ++i) position[i] += Vec3d(h * velocity[i]);
}

void ClothState::end_step(rigid::World3& world, double dt) {
  tear();
  SoftThing::end_step(world, dt);
}

}  // namespace carom::particles::detail
