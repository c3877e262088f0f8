// Small bodies that come at a taut cloth or at a soft body at 5 to 400 m/s, from any side: each is met within the step,
// goes not through, and what it loses the other has.
#include <gtest/gtest.h>

#include "carom/particles/cloth.h"
#include "carom/particles/soft_body.h"
#include "carom/particles/soft_group.h"
#include "tests/particles/flung.h"
#include "tests/particles/weightless.h"

namespace carom::particles {
namespace soft_fast_test {

using math::Vec3d;
using math::Vec3f;
using rigid::BodyId;
using rigid::World3;
constexpr double dt = 1.0 / 60;

/// A sheet of 1 m across y with cells of 5 cm, drawn out by a fiftieth and held at its border.
Cloth taut_sheet(World3& world, bool held = true) {
  constexpr int n = 21;
  const ClothSheet sheet = make_cloth_sheet({-0.5, 0, -0.5}, {1, 0, 0}, {0, 0, 1}, n, n);
  const Fabric canvas{
      .mass_per_area = 0.3, .warp_stiffness = 2e4, .weft_stiffness = 2e4, .shear_stiffness = 2e3, .damping = 0.001};
  Cloth cloth = Cloth::make({.fabric = canvas, .points = sheet.points, .triangles = sheet.triangles}).value();
  cloth.set_air(0, {}).value();
  if (!held) return cloth;
  for (int i = 0; i < n * n; ++i) {
    const int column = i % n, row = i / n;
    if (column > 0 && column < n - 1 && row > 0 && row < n - 1) continue;
    cloth.pin(i, {}, 1.02 * sheet.points[std::size_t(i)], world).value();
  }
  for (int i = 0; i < 30; ++i) cloth.step(world, dt).value();
  return cloth;
}

/// The surface's height above or below a point, by the triangle over it; 0 beside all.
double height_at(std::span<const Vec3d> points, std::span<const std::uint32_t> triangles, Vec3d p) {
  double lowest = 1e30;
  for (std::size_t k = 0; k + 2 < triangles.size(); k += 3) {
    const Vec3d a = points[triangles[k]], u = points[triangles[k + 1]] - a, v = points[triangles[k + 2]] - a, d = p - a;
    const double area = u.x * v.z - u.z * v.x;
    if (area == 0) continue;
    const double s = (d.x * v.z - d.z * v.x) / area, t = (u.x * d.z - u.z * d.x) / area;
    if (s >= 0 && t >= 0 && s + t <= 1) lowest = math::min(lowest, a.y + s * u.y + t * v.y);
  }
  return lowest < 1e30 ? lowest : 0;
}

struct Shot {
  double size = 0, mass = 0, speed = 0;
  Vec3d way{}, aim{};
  BodyId body{};
};

/// At a place on the square of `half` about the origin from above.
Shot fling(World3& world, math::Random& random, int kind, double mass, double half, double top) {
  Shot shot;
  shot.size = 0.01 * math::exp(random.uniform(0.0, math::log(10.0)));
  shot.speed = 5 * math::exp(random.uniform(0.0, math::log(80.0)));
  const double volume = 8 * shot.size * shot.size * shot.size;
  shot.mass = mass > 0 ? math::min(mass, 7800 * volume) : 300 * volume;  // at most of steel
  const double roll = random.uniform(0.0, 2 * math::pi), slant = random.uniform(0.0, 1.0);
  shot.way = {math::sin(slant) * math::cos(roll), -math::cos(slant), math::sin(slant) * math::sin(roll)};
  shot.aim = {random.uniform(-half, half), top, random.uniform(-half, half)};
  shot.body =
      fling_body(world, random, kind, flung_shape(kind, shot.size), shot.mass,
                 shot.aim - (0.3 + random.uniform(0.0, 1.0) * shot.speed * dt) * shot.way, shot.speed * shot.way);
  return shot;
}

int steps_of(const Shot& shot) { return int((0.3 + shot.speed * dt) / shot.speed / dt) + 6; }

std::ostream& operator<<(std::ostream& out, const Shot& shot) {
  return out << shot.size << " m, " << shot.mass << " kg, " << shot.speed << " m/s";
}

TEST(SoftFast, NonePassesATautCloth) {
  math::Random random(11);
  int shots = 0;
  World3 still = weightless();
  const Cloth taut = taut_sheet(still);
  for (int kind = 0; kind < 5; ++kind)
    for (const double mass : {0.0, 0.01, 0.3})
      for (int i = 0; i < shots_of(kind < 2 ? 25 : 10); ++i) {
        World3 world = weightless();
        const Shot shot = fling(world, random, kind, mass, 0.3, 0);
        Cloth cloth = taut;
        bool passed = false;
        for (int s = 0; s < steps_of(shot) && !passed; ++s) {
          cloth.step(world, dt).value();
          world.step(float(dt)).value();
          const Vec3d c = world.state(shot.body)->center_of_mass;
          passed = math::max(math::abs(c.x), math::abs(c.z)) < 0.5 &&
                   c.y < height_at(cloth.positions(), cloth.triangles(), c) - shot.size;
        }
        const bool met =
            length(Vec3d(world.state(shot.body)->linear_velocity) - shot.speed * shot.way) > 1e-4 * shot.speed;
        EXPECT_TRUE(met) << kind << ' ' << i << ": " << shot << " is not met";
        EXPECT_FALSE(passed) << kind << ' ' << i << ": " << shot << " goes through";
        ++shots;
      }
  RecordProperty("shots", shots);
}

// In a group with a block of foam under the sheet, which the sheet is flung against.
TEST(SoftFast, GroupsMeetWhatIsFast) {
  math::Random random(19);
  const SoftMesh mesh = make_soft_box({-0.3, -0.5, -0.3}, {0.6, 0.3, 0.6}, 4, 2, 4);
  const SoftBody beneath = SoftBody::make({.material = {.density = 200, .youngs_modulus = 1e6, .damping = 0.002},
                                           .points = mesh.points,
                                           .tetrahedra = mesh.tetrahedra})
                               .value();
  World3 still = weightless();
  const Cloth taut = taut_sheet(still);
  for (int kind = 0; kind < 5; ++kind)
    for (const double mass : {0.0, 0.01, 0.3})
      for (int i = 0; i < shots_of(4); ++i) {
        World3 world = weightless();
        const Shot shot = fling(world, random, kind, mass, 0.3, 0);
        Cloth cloth = taut;
        SoftBody below = beneath;
        SoftGroup group;
        Cloth* cloths[] = {&cloth};
        SoftBody* soft[] = {&below};
        bool passed = false;
        for (int s = 0; s < steps_of(shot) && !passed; ++s) {
          group.step(cloths, soft, world, dt).value();
          world.step(float(dt)).value();
          const Vec3d c = world.state(shot.body)->center_of_mass;
          passed = math::max(math::abs(c.x), math::abs(c.z)) < 0.5 &&
                   c.y < height_at(cloth.positions(), cloth.triangles(), c) - shot.size;
        }
        EXPECT_GT(length(Vec3d(world.state(shot.body)->linear_velocity) - shot.speed * shot.way), 1e-4 * shot.speed)
            << kind << ' ' << i << ": " << shot << " is not met";
        EXPECT_FALSE(passed) << kind << ' ' << i << ": " << shot << " goes through";
        for (const Vec3f v : below.velocities()) EXPECT_LT(length(v), 2 * shot.speed);
      }
}

/// A block of foam of 60 by 30 by 60 cm, its top at y = 0.
SoftMesh block_mesh() { return make_soft_box({-0.3, -0.3, -0.3}, {0.6, 0.3, 0.6}, 8, 4, 8); }
SoftBody foam_block() {
  const SoftMesh mesh = block_mesh();
  return SoftBody::make({.material = {.density = 200, .youngs_modulus = 1e6, .poisson_ratio = 0.3, .damping = 0.002},
                         .points = mesh.points,
                         .tetrahedra = mesh.tetrahedra})
      .value();
}

bool within(const SoftBody& body, const SoftMesh& mesh, Vec3d p) {
  const auto x = body.positions();
  for (std::size_t e = 0; e + 3 < mesh.tetrahedra.size(); e += 4) {
    const Vec3d o = x[mesh.tetrahedra[e]], u = x[mesh.tetrahedra[e + 1]] - o, v = x[mesh.tetrahedra[e + 2]] - o,
                w = x[mesh.tetrahedra[e + 3]] - o, d = p - o;
    const double six = math::triple(u, v, w), s = math::triple(d, v, w) / six, t = math::triple(u, d, w) / six,
                 r = math::triple(u, v, d) / six;
    if (s > 0 && t > 0 && r > 0 && s + t + r < 1) return true;
  }
  return false;
}

TEST(SoftFast, NoneEntersASoftBody) {
  math::Random random(13);
  int shots = 0, inside = 0;
  const SoftMesh mesh = block_mesh();
  const SoftBody foam = foam_block();
  for (int kind = 0; kind < 5; ++kind)
    for (const double mass : {0.0, 0.01, 0.3})
      for (int i = 0; i < shots_of(kind < 2 ? 12 : 6); ++i) {
        World3 world = weightless();
        const Shot shot = fling(world, random, kind, mass, 0.2, 0);
        SoftBody body = foam;
        bool entered = false;
        for (int s = 0; s < steps_of(shot) && !entered; ++s) {
          body.step(world, dt).value();
          world.step(float(dt)).value();
          entered = within(body, mesh, world.state(shot.body)->center_of_mass);
        }
        const bool met =
            length(Vec3d(world.state(shot.body)->linear_velocity) - shot.speed * shot.way) > 1e-4 * shot.speed;
        EXPECT_TRUE(met) << kind << ' ' << i << ": " << shot << " is not met";
        ++shots;
        inside += entered;
      }
  RecordProperty("inside", inside);
  EXPECT_LT(63 * inside, shots);
}

// Of what flies freely nothing is lost, and no energy comes.
TEST(SoftFast, MomentumIsKept) {
  math::Random random(17);
  const Cloth loose = [&] {
    World3 world = weightless();
    return taut_sheet(world, false);
  }();
  const SoftBody foam = foam_block();
  for (const bool cloth : {true, false})
    for (int kind = 0; kind < 5; ++kind)
      for (int i = 0; i < shots_of(8); ++i) {
        World3 world = weightless();
        const Shot shot = fling(world, random, kind, i % 2 == 0 ? 0.02 : 0.5, 0.2, 0);
        Cloth sheet = loose;
        SoftBody block = foam;
        const auto given = [&] { return cloth ? sheet.momentum() : block.momentum(); };
        const auto energy = [&] {
          return world.totals().kinetic_energy + (cloth ? sheet.kinetic_energy() + sheet.elastic_energy()
                                                        : block.kinetic_energy() + block.elastic_energy());
        };
        const Vec3d before = world.totals().momentum;
        const double first = energy();
        for (int s = 0; s < steps_of(shot); ++s) {
          (cloth ? sheet.step(world, dt) : block.step(world, dt)).value();
          world.step(float(dt)).value();
        }
        EXPECT_GT(length(given()), 0) << cloth << ' ' << kind << ' ' << i << ": " << shot;
        EXPECT_LT(length(world.totals().momentum + given() - before), 2e-3 * length(before))
            << cloth << ' ' << kind << ' ' << i << ": " << shot;
        EXPECT_LT(energy(), 1.001 * first) << cloth << ' ' << kind << ' ' << i << ": " << shot;
      }
}

TEST(SoftFast, SameBits) {
  World3 still = weightless();
  const Cloth taut = taut_sheet(still);
  const SoftBody foam = foam_block();
  const auto run = [&](bool copied) {
    math::Random random(3);
    std::uint64_t hash = 0;
    for (int i = 0; i < 10; ++i) {
      World3 world = weightless();
      (void)fling(world, random, i % 5, 0.05, 0.2, 0);
      Cloth cloth = taut;
      SoftBody block = foam;
      for (int s = 0; s < 8; ++s) {
        if (copied) {
          cloth = Cloth(cloth);
          block = SoftBody(block);
        }
        (i % 2 == 0 ? cloth.step(world, dt) : block.step(world, dt)).value();
        world.step(float(dt)).value();
      }
      hash = hash * 1099511628211u ^ cloth.state_hash() ^ block.state_hash() ^ world.state_hash();
    }
    return hash;
  };
  const std::uint64_t once = run(false);
  EXPECT_EQ(run(false), once);
  EXPECT_EQ(run(true), once);
}

// A marble that is smaller than the cells rolls on the cloth and does not fall between its threads.
TEST(SoftFast, ClothBearsWhatIsSmallerThanItsCells) {
  World3 still = weightless();
  const Cloth taut = taut_sheet(still);
  math::Random random(5);
  for (int kind = 0; kind < 2; ++kind)
    for (int i = 0; i < 6; ++i) {
      World3 world;
      const BodyId marble = fling_body(world, random, kind, flung_shape(kind, 0.012), 0.02,
                                       {random.uniform(-0.2, 0.2), 0.1, random.uniform(-0.2, 0.2)}, {});
      Cloth cloth = taut;
      for (int s = 0; s < 120; ++s) {
        cloth.step(world, dt).value();
        world.step(float(dt)).value();
      }
      const Vec3d c = world.state(marble)->center_of_mass;
      EXPECT_GT(c.y, height_at(cloth.positions(), cloth.triangles(), c)) << kind << ' ' << i;
      EXPECT_LT(c.y, 0.1) << kind << ' ' << i;
    }
}

}  // namespace soft_fast_test
}  // namespace carom::particles
