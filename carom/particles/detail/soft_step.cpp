// A substep of a soft body.
#include "carom/math/elementary.h"
#include "carom/particles/detail/soft_state.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {
constexpr int soft_chunk = 64;

/// The rotation nearest to f, from a guess: turns that bring the columns together (Müller, Bender, Chentanez, Macklin,
/// "A robust method to extract the rotational part of deformations", 2016). Works for crushed and inverted elements.
Mat3f nearest_turn(const Mat3f& f, const Mat3f& guess) {
  Mat3f r = guess;
  for (int round = 0; round < 12; ++round) {
    const Vec3f axis = cross(r.cx, f.cx) + cross(r.cy, f.cy) + cross(r.cz, f.cz);
    const float scale = math::abs(dot(r.cx, f.cx) + dot(r.cy, f.cy) + dot(r.cz, f.cz)) + 1e-9f;
    const Vec3f w = axis * (1 / scale);
    const float size = dot(w, w);
    if (size < 1e-12f) break;
    // Cayley's turn by about |w|, rational and so the same everywhere.
    const Vec3f half = 0.5f * w;
    const float k = 2 / (1 + 0.25f * size);
    const auto turn = [&](Vec3f v) {
      const Vec3f t = cross(half, v);
      return v + k * (t + cross(half, t));
    };
    r = {turn(r.cx), turn(r.cy), turn(r.cz)};
  }
  // Rounding must not make it drift away from a rotation.
  const Vec3f x = normalize(r.cx), y = normalize(r.cy - dot(r.cy, x) * x);
  return {x, y, cross(x, y)};
}

}  // namespace

void SoftState::strain(float h) {
  const float e = float(material.youngs_modulus), nu = float(material.poisson_ratio);
  const float lambda = e * nu / ((1 + nu) * (1 - 2 * nu)), mu = e / (2 * (1 + nu));
  tasks().parallel_for(int(elements.size()), soft_chunk, [&](int from, int to, int) {
    for (int k = from; k < to; ++k) {
      SoftElement& element = elements[std::size_t(k)];
      const Mat3f f = deformation(std::size_t(k));
      find_crush(std::size_t(k), f, h);
      element.turn = nearest_turn(f, element.turn);
      const Mat3f s = transpose(element.turn) * f;
      const Mat3f strain = 0.5f * (s + transpose(s)) - Mat3f::identity();
      const Mat3f stress = (2 * mu) * strain + (lambda * trace(strain)) * Mat3f::identity();
      for (int a = 0; a < 4; ++a)
        element.force[a] = (-element.volume) * (element.turn * (stress * element.gradient[a]));
    }
  });
}

double SoftState::elastic_energy() const {
  const float e = float(material.youngs_modulus), nu = float(material.poisson_ratio);
  const float lambda = e * nu / ((1 + nu) * (1 - 2 * nu)), mu = e / (2 * (1 + nu));
  double sum = 0;
  for (std::size_t k = 0; k < elements.size(); ++k) {
    const Mat3f f = deformation(k), s = transpose(nearest_turn(f, elements[k].turn)) * f;
    const Mat3f strain = 0.5f * (s + transpose(s)) - Mat3f::identity();
    const float squares = dot(strain.cx, strain.cx) + dot(strain.cy, strain.cy) + dot(strain.cz, strain.cz);
    sum += double(elements[k].volume) * double(mu * squares + 0.5f * lambda * math::square(trace(strain)));
  }
  return sum;
}

void SoftState::assemble(float h, Vec3f gravity) {
  const float e = float(material.youngs_modulus), nu = float(material.poisson_ratio);
  const float lambda = e * nu / ((1 + nu) * (1 - 2 * nu)), mu = e / (2 * (1 + nu));
  const float weight = h * h + h * float(material.damping);
  tasks().parallel_for(int(position.size()), soft_chunk, [&](int from, int to, int) {
    for (int row = from; row < to; ++row) {
      const std::size_t i = std::size_t(row);
      for (int k = matrix.first(row); k < matrix.first(row + 1); ++k) matrix.blocks[std::size_t(k)] = SoftBlock{};
      Vec3f force = load[i] + mass[i] * gravity, held{};
      for (int k = first[i]; k < first[i + 1]; ++k) {
        const int place = list[std::size_t(k)], a = place % 4;
        const SoftElement& element = elements[std::size_t(place / 4)];
        force += element.force[a];
        if (element.crushed) {
          const SoftCrush& crush = crushes[std::size_t(place / 4)];
          held += (crush.stiff * crush.wanted * crush.weight[a]) * crush.normal;
          for (int b = 0; b < 4; ++b) crush.add_block(a, b, 1, matrix.blocks[std::size_t(element.slots[4 * a + b])]);
        }
        // K_ab = V R (λ g_a g_bᵀ + μ (g_b g_aᵀ + g_a·g_b 1)) Rᵀ, with the gradients turned.
        const Vec3f ga = element.turn * element.gradient[a];
        const float s = weight * element.volume;
        for (int b = 0; b < 4; ++b) {
          const Vec3f gb = element.turn * element.gradient[b];
          SoftBlock& block = matrix.blocks[std::size_t(element.slots[4 * a + b])];
          const Vec3f l = (s * lambda) * ga, m = (s * mu) * gb;
          block.add(l * gb.x + m * ga.x, l * gb.y + m * ga.y, l * gb.z + m * ga.z);
          block.add_diagonal(s * mu * dot(ga, gb));
        }
      }
      solver.diagonal[i] = Mat3f::diagonal({mass[i], mass[i], mass[i]});
      solver.right[i] = h * force + held;
    }
  });
  if (pressure != 0)
    for (std::size_t k = 0; k + 2 < surface.size(); k += 3) {
      const Vec3d a = position[surface[k]];
      const Vec3f push =
          (h * float(pressure) / 6) * cross(Vec3f(position[surface[k + 1]] - a), Vec3f(position[surface[k + 2]] - a));
      for (std::size_t j = 0; j < 3; ++j) solver.right[surface[k + j]] += push;
    }
  solver.begin(matrix, velocity, tasks());
}

void SoftState::begin_substep(float h, Vec3f gravity) {
  way = greatest_way(h, nullptr);
  strain(h);
  slimmest = elements[0].thick;
  for (const SoftElement& element : elements) slimmest = math::min(slimmest, element.thick);
  for (std::size_t f = 0; f < behind.size(); ++f) folded[f] = !(elements[std::size_t(behind[f])].thick > 0);
  assemble(h, gravity);
  obstacles.enter(h, solver);
  hold(h);
}

void SoftState::end_substep(float h) {
  react_touches(touching(), h, obstacles, solver, nullptr);
  press_faces(*this, h, nullptr);
  for (std::size_t i = 0; i < position.size(); ++i) {
    velocity[i] += solver.change[i].vector();
    position[i] += Vec3d(h * velocity[i]);
  }
}

}  // namespace carom::particles::detail
