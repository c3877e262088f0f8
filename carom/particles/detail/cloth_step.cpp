// A substep of cloth: strains, the linear system, contacts, folds.
#include "carom/math/elementary.h"
#include "carom/particles/detail/cloth_state.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {
constexpr int cloth_chunk = 128;
core::SerialScheduler cloth_serial;
}  // namespace

void ClothState::stretch() {
  const float nu = float(fabric.poisson_ratio), warp = float(fabric.warp_stiffness),
              weft = float(fabric.weft_stiffness);
  // Plane stress of an orthotropic sheet: ν₂₁ = ν₁₂ E₂/E₁.
  const float share = 1 / (1 - nu * nu * weft / warp);
  const float c11 = warp * share, c22 = weft * share, c12 = nu * weft * share, shear = float(fabric.shear_stiffness);
  const float normal_drag = float(0.5 * air_density * fabric.normal_coefficient);
  const float skin_drag = float(0.5 * air_density * fabric.tangential_coefficient);
  core::TaskScheduler& tasks = scheduler ? *scheduler : cloth_serial;
  tasks.parallel_for(int(triangles.size()), cloth_chunk, [&](int from, int to, int) {
    for (int t = from; t < to; ++t) {
      ClothTriangle& triangle = triangles[std::size_t(t)];
      const std::uint32_t* c = &corners[3 * std::size_t(t)];
      const Vec3f d1(position[c[1]] - position[c[0]]), d2(position[c[2]] - position[c[0]]);
      triangle.along = triangle.u[1] * d1 + triangle.u[2] * d2;
      triangle.across = triangle.v[1] * d1 + triangle.v[2] * d2;
      const float e1 = 0.5f * (dot(triangle.along, triangle.along) - 1);
      const float e2 = 0.5f * (dot(triangle.across, triangle.across) - 1);
      const float s1 = c11 * e1 + c12 * e2, s2 = c12 * e1 + c22 * e2;
      const float s3 = shear * dot(triangle.along, triangle.across);
      triangle.stress[0] = s1;
      triangle.stress[1] = s2;
      triangle.stress[2] = s3;
      // The part of the stress that pulls: only that stiffens, and the system stays positive definite.
      const float mean = 0.5f * (s1 + s2), spread = math::sqrt(0.25f * (s1 - s2) * (s1 - s2) + s3 * s3);
      const float high = mean + spread, low = mean - spread;
      if (low >= 0) {
        triangle.pull[0] = s1, triangle.pull[1] = s2, triangle.pull[2] = s3;
      } else if (high <= 0) {
        triangle.pull[0] = triangle.pull[1] = triangle.pull[2] = 0;
      } else {
        const float k = high / (high - low);
        triangle.pull[0] = k * (s1 - low), triangle.pull[1] = k * (s2 - low), triangle.pull[2] = k * s3;
      }
      triangle.wind = {};
      triangle.brake = Mat3f::zero();
      if (normal_drag == 0 && skin_drag == 0) continue;
      const Vec3f cross_ = cross(d1, d2);
      const float twice = length(cross_);
      if (!(twice > 1e-12f)) continue;
      const Vec3f n = cross_ * (1 / twice);
      const double height = (position[c[0]].y + position[c[1]].y + position[c[2]].y) / 3;
      const Vec3f air =
          Vec3f(environment::wind_at(wind, height)) - (velocity[c[0]] + velocity[c[1]] + velocity[c[2]]) * (1.0f / 3);
      const float through = dot(air, n), third = twice / 6;
      const Vec3f along = air - through * n;
      const float press = normal_drag * math::abs(through) * third, rub = skin_drag * length(along) * third;
      triangle.wind = press * through * n + rub * along;
      triangle.brake = (2 * press) * math::outer(n, n) + rub * (Mat3f::identity() + (-1.0f) * math::outer(n, n));
    }
  });
}

void ClothState::assemble(float h, Vec3f gravity) {
  const float nu = float(fabric.poisson_ratio), warp = float(fabric.warp_stiffness),
              weft = float(fabric.weft_stiffness);
  const float inverse_share = 1 / (1 - nu * nu * weft / warp);
  const float c11 = warp * inverse_share, c22 = weft * inverse_share, c12 = nu * weft * inverse_share;
  const float shear = float(fabric.shear_stiffness);
  const float weight = h * h + h * float(fabric.damping);
  matrix.link_scale = weight;
  // A twentieth of what an explicit step would still be stable with.
  matrix.far_ahead = weight * far_share < 0.05f;
  core::TaskScheduler& tasks = scheduler ? *scheduler : cloth_serial;
  tasks.parallel_for(int(position.size()), cloth_chunk, [&](int from, int to, int) {
    for (int row = from; row < to; ++row) {
      const std::size_t i = std::size_t(row);
      for (int k = matrix.first(row); k < matrix.first(row + 1); ++k) {
        matrix.blocks[std::size_t(k)] = SoftBlock{};
        matrix.blocks[std::size_t(k)].add_diagonal(weight * matrix.near[std::size_t(k)]);
      }
      if (matrix.far_ahead) matrix.blocks[std::size_t(matrix.diagonal(row))].add_diagonal(weight * matrix.far_sum(row));
      Vec3f force{};
      Mat3f brake = Mat3f::zero();
      for (int k = triangle_first[i]; k < triangle_first[i + 1]; ++k) {
        const int place = triangle_list[std::size_t(k)], a = place % 3;
        const ClothTriangle& t = triangles[std::size_t(place / 3)];
        const float ua = t.u[a], va = t.v[a], area = t.area;
        force -=
            area * ((t.stress[0] * ua + t.stress[2] * va) * t.along + (t.stress[1] * va + t.stress[2] * ua) * t.across);
        force += t.wind;
        brake = brake + t.brake;
        // ½ area (c11 e1² + 2 c12 e1 e2 + c22 e2² + shear e3²), derived by the corners a and b.
        const SoftVector along(t.along), across(t.across);
        const float s = weight * area;
        const float uu = s * c11 * ua, uv = s * c12 * ua, vu = s * c12 * va, vv = s * c22 * va;
        const float su = s * shear * ua, sv = s * shear * va;
        const float pull_u = s * (t.pull[0] * ua + t.pull[2] * va), pull_v = s * (t.pull[1] * va + t.pull[2] * ua);
        for (int b = 0; b < 3; ++b) {
          const float ub = t.u[b], vb = t.v[b];
          const SoftBlock::Lanes p = (uu * ub + sv * vb) * along.v + (uv * vb + sv * ub) * across.v;
          const SoftBlock::Lanes q = (vu * ub + su * vb) * along.v + (vv * vb + su * ub) * across.v;
          SoftBlock& block = matrix.blocks[std::size_t(t.slots[3 * a + b])];
          block.x += along.v * p[0] + across.v * q[0];
          block.y += along.v * p[1] + across.v * q[1];
          block.z += along.v * p[2] + across.v * q[2];
          block.add_diagonal(pull_u * ub + pull_v * vb);
        }
      }
      force -= matrix.pull_of_links(row, position.data());
      solver.diagonal[i] = Mat3f::diagonal({mass[i], mass[i], mass[i]}) + h * brake;
      solver.right[i] = h * force + (h * mass[i]) * gravity;
    }
  });
  solver.begin(matrix, velocity, tasks);
}

void ClothState::hold(float h) {
  hold_pins(touching(), solver);
  if (!collide || obstacles.empty()) {
    for (SoftTouch& touch : touches) touch = {};
    return;
  }
  core::TaskScheduler& tasks = scheduler ? *scheduler : cloth_serial;
  const double radius = fabric.thickness;
  tasks.parallel_for(int(position.size()), cloth_chunk, [&](int from, int to, int) {
    for (int row = from; row < to; ++row) {
      const std::size_t i = std::size_t(row);
      SoftTouch& touch = touches[i];
      touch.near =
          pin_of[i] < 0 &&
          obstacles.nearest(position[i], radius,
                            radius + 2 * double(h) * (double(length(velocity[i])) + double(h) * 20), touch.plane);
      if (!touch.near) {
        touch = {};
        continue;
      }
      hold_touch(touch, i, position[i], velocity[i], fabric.friction, h, obstacles, solver);
    }
  });
}

void ClothState::step(rigid::World3& world, double dt) {
  const float h = float(dt / substeps);
  last_step = dt;
  const Vec3f gravity = world.definition().gravity;
  core::TaskScheduler& tasks = scheduler ? *scheduler : cloth_serial;
  obstacles.clear();
  place_pins(pins, pinned, pin_of, world, obstacles, position, velocity);
  pin_impulse.assign(pins.size(), Vec3d{});
  if (collide) gather_near(fabric.thickness, dt, world, filter, pins, position, velocity, obstacles);
  obstacles.find_pulls(world, dt);
  iterations = 0;
  greatest_tension = 0;
  wind_impulse = {};
  for (int s = 0; s < substeps; ++s) {
    stretch();
    assemble(h, gravity);
    obstacles.enter(h, solver);
    hold(h);
    iterations += solve_touches(touching(), matrix, h, obstacles, solver, tasks);
    wind_force = {};
    for (const ClothTriangle& t : triangles) {
      wind_force += 3.0 * Vec3d(t.wind);
      const float mean = 0.5f * (t.stress[0] + t.stress[1]);
      const float spread =
          math::sqrt(0.25f * (t.stress[0] - t.stress[1]) * (t.stress[0] - t.stress[1]) + t.stress[2] * t.stress[2]);
      greatest_tension = math::max(greatest_tension, double(mean + spread));
    }
    react_touches(touching(), h, obstacles, solver, pin_impulse.data());
    for (std::size_t i = 0; i < position.size(); ++i) velocity[i] += solver.change[i].vector();
    if (self_collide) keep_apart(h);
    for (std::size_t i = 0; i < position.size(); ++i) position[i] += Vec3d(h * velocity[i]);
    obstacles.advance(double(h), solver);
  }
  tear();
  obstacles.hand_over(world, dt, double(length(gravity)));
}

}  // namespace carom::particles::detail
