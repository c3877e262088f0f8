// Relations that hold whatever the numbers: the whole scene mirrored, turned and moved, told in other units, or made
// larger, gives the same motion; and what only loses energy never gains any. Of particles, ropes, cloth, soft bodies
// and liquids. Each relation is asked once with a coefficient that is wrong, too, and must tell it.
#include <gtest/gtest.h>

#include "carom/math/elementary.h"
#include "carom/math/quat.h"
#include "carom/particles/cloth.h"
#include "carom/particles/fluid.h"
#include "carom/particles/rope.h"
#include "carom/particles/soft_body.h"
#include "carom/particles/system.h"

namespace carom::particles {
namespace metamorphic_test {

using math::Vec3d;
using math::Vec3f;
using rigid::World3;
using Places = std::vector<Vec3d>;

/// The greatest distance between two shapes of as many places.
double apart(const Places& one, const Places& other) {
  double most = 0;
  for (std::size_t i = 0; i < one.size(); ++i) most = math::max(most, distance(one[i], other[i]));
  return most;
}

/// How a scene is told: where it lies, and in which units.
struct Telling {
  math::Quatd turn{};
  bool mirrored = false;  ///< in x, before it is turned
  Vec3d shift{};          ///< m, after all else
  double length = 1, mass = 1, time = 1;
  double wrong = 1;  ///< times one coefficient of each scene

  Vec3d direction(Vec3d v) const { return rotate(turn, mirrored ? Vec3d{-v.x, v.y, v.z} : v); }
  Vec3d place(Vec3d p) const { return length * direction(p) + shift; }
  Vec3d velocity(Vec3d v) const { return (length / time) * direction(v); }
  Vec3d acceleration(Vec3d a) const { return (length / (time * time)) * direction(a); }
  double force() const { return mass * length / (time * time); }
  double density() const { return mass / (length * length * length); }
};

const math::Quatd askew = normalize(math::Quatd{0.3, -0.5, 0.2, 0.7});
constexpr double g = 9.80665, dt = 1.0 / 120;

/// The greatest distance of what a scene gives from what it should, of the whole by its size.
template <class Scene>
double off(const Scene& scene, const Telling& telling) {
  const Places plain = scene(Telling{}), told = scene(telling);
  if (plain.size() != told.size()) return 1e30;
  double most = 0, size = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    most = math::max(most, distance(told[i], telling.place(plain[i])) / telling.length);
    size = math::max(size, distance(plain[i], plain[0]));
  }
  return most / size;
}

/// All that should change nothing.
template <class Scene>
void expect_same(const Scene& scene, double placed, double units) {
  const Telling tellings[] = {{.mirrored = true},
                              {.turn = askew},
                              {.shift = {300, -40, 1000}},
                              {.turn = askew, .mirrored = true, .shift = {-20, 5, 7}}};
  for (std::size_t k = 0; k < std::size(tellings); ++k) EXPECT_LT(off(scene, tellings[k]), placed) << k;
  EXPECT_LT(off(scene, {.length = 100, .mass = 1000}), units) << "lengths in cm, masses in g";
  EXPECT_LT(off(scene, {.length = 0.25, .mass = 0.5, .time = 0.5}), units);
  EXPECT_GT(off(scene, {.length = 100, .mass = 1000, .wrong = 1.05}), 3 * units) << "a wrong coefficient is not seen";
  EXPECT_GT(off(scene, {.turn = askew, .wrong = 1.05}), 3 * placed) << "a wrong coefficient is not seen";
}

/// Shots through a wind across.
Places particles(const Telling& t, DragLaw law) {
  SystemDef def;
  def.gravity = t.acceleration({0, -g, 0});
  def.radius = float(0.02 * t.length);
  def.mass = float(0.01 * t.mass);
  def.drag.law = law;
  def.drag.density = float(1.225 * t.density() * t.wrong);
  def.drag.viscosity = float(1.81e-5 * t.mass / (t.length * t.time) * t.wrong);
  if (law == DragLaw::linear) def.drag.coefficient = float(0.01 * t.mass / t.time * t.wrong);
  def.anchor = t.shift;
  ParticleSystem system = ParticleSystem::create(def).value();
  system.set_air({.wind = {.velocity = t.velocity({4, 1, -6})}}).value();
  for (int i = 0; i < 20; ++i)
    EXPECT_TRUE(system.add({.position = t.place({0.1 * i, 1, 0}), .velocity = t.velocity({20.0 - i, 3.0 + i, 0.5 * i})})
                    .value());
  for (int s = 0; s < 180; ++s) system.step(dt * t.time).value();
  Places out;
  for (int i = 0; i < system.size(); ++i) out.push_back(system.position(i));
  return out;
}

TEST(ParticlesMetamorphic, AnyPlaceAndUnits) {
  for (const DragLaw law : {DragLaw::linear, DragLaw::schiller_naumann, DragLaw::quadratic})
    expect_same([&](const Telling& t) { return particles(t, law); }, 2e-5, 2e-5);
}

/// A rope with bending that hangs by one end and is swung through a wind.
Places rope(const Telling& t) {
  World3 world({.gravity = Vec3f(t.acceleration({0, -g, 0}))});
  RopeSet ropes;
  const Vec3d points[] = {t.place({0, 0, 0}), t.place({1, -0.4, 0.3})};
  ropes
      .add({.material = {.mass_per_length = 0.2 * t.mass / t.length,
                         .radius = 0.01 * t.length,
                         .axial_stiffness = 2e4 * t.force(),
                         .axial_damping = 10 * t.force() * t.time,
                         .bending_stiffness = 1e-3 * t.force() * t.length * t.length,
                         .bending_damping = 0.01 * t.time},
            .points = points,
            .segments = 12})
      .value();
  ropes.attach(0, {.node = 0, .point = points[0]}, world).value();
  ropes.set_air({.density = 1.225 * t.density() * t.wrong * t.wrong, .wind = {.velocity = t.velocity({6, 0, -9})}});
  ropes.set_velocity(0, 12, t.velocity({0, 2, 3})).value();
  for (int s = 0; s < 60; ++s) ropes.step(world, dt * t.time).value();
  const auto found = ropes.positions(0);
  return {found.begin(), found.end()};
}

TEST(RopeMetamorphic, AnyPlaceAndUnits) { expect_same(rope, 1e-6, 1e-6); }

/// A flag held at two corners.
Places flag(const Telling& t) {
  World3 world({.gravity = Vec3f(t.acceleration({0, -g, 0}))});
  ClothSheet sheet = make_cloth_sheet({0, 0, 0}, {0.6, 0.05, 0}, {0, -0.5, 0.1}, 10, 9);
  for (Vec3d& p : sheet.points) p = t.place(p);
  Cloth cloth = Cloth::make({.fabric = {.mass_per_area = 0.2 * t.mass / (t.length * t.length),
                                        .warp_stiffness = 900 * t.mass / (t.time * t.time) * t.wrong,
                                        .weft_stiffness = 700 * t.mass / (t.time * t.time) * t.wrong,
                                        .shear_stiffness = 40 * t.mass / (t.time * t.time) * t.wrong,
                                        .bending_stiffness = 1e-4 * t.force() * t.length * t.wrong,
                                        .damping = 0.01 * t.time,
                                        .thickness = 0.004 * t.length},
                             .points = sheet.points,
                             .triangles = sheet.triangles,
                             .warp = t.direction({1, 0, 0}),
                             .self_collide = false})
                    .value();
  cloth.set_air(1.225 * t.density(), {.velocity = t.velocity({3, 0, 5})}).value();
  cloth.pin(0).value();
  cloth.pin(80).value();
  for (int s = 0; s < 60; ++s) cloth.step(world, dt * t.time).value();
  return {cloth.positions().begin(), cloth.positions().end()};
}

TEST(ClothMetamorphic, AnyPlaceAndUnits) { expect_same(flag, 1e-3, 1e-3); }

/// A beam that hangs by one end from level.
Places beam(const Telling& t) {
  World3 world({.gravity = Vec3f(t.acceleration({0, -g, 0}))});
  SoftMesh mesh = make_soft_box({0, 0, 0}, {0.8, 0.2, 0.2}, 8, 2, 2);
  for (Vec3d& p : mesh.points) p = t.place(p);
  SoftBody body = SoftBody::make({.material = {.density = 500 * t.density(),
                                               .youngs_modulus = 6e4 * t.force() / (t.length * t.length) * t.wrong,
                                               .damping = 0.01 * t.time,
                                               .skin = 0.005 * t.length},
                                  .points = mesh.points,
                                  .tetrahedra = mesh.tetrahedra})
                      .value();
  for (int i = 0; i < body.vertex_count(); ++i)
    if (i % 9 == 0) body.pin(i).value();
  for (int s = 0; s < 60; ++s) body.step(world, dt * t.time).value();
  return {body.positions().begin(), body.positions().end()};
}

TEST(SoftBodyMetamorphic, AnyPlaceAndUnits) { expect_same(beam, 1e-3, 1e-3); }

/// What a column of liquid has done when it broke: middle, spread and height of it.
Places dam(const Telling& t) {
  const auto wide = [](Vec3d v) { return math::Vec2d{v.x, v.y}; };
  FluidDef<rigid::Dim2> def;
  def.spacing = float(0.03 * t.length);
  const math::Vec2d a = wide(t.place({0, 0, 0})), b = wide(t.place({1.8, 0.9, 0}));
  def.lower = {math::min(a.x, b.x), a.y};
  def.upper = {math::max(a.x, b.x), b.y};
  def.density = float(1000 * t.mass / (t.length * t.length));
  def.viscosity = float(1e-3 * t.length * t.length / t.time * t.wrong * t.wrong * t.wrong);
  def.gravity = math::Vec2f(wide(t.acceleration({0, -g * t.wrong, 0})));
  Fluid2 liquid = Fluid2::create(def).value();
  const math::Vec2d c = wide(t.place({0, 0, 0})), d = wide(t.place({0.6, 0.6, 0}));
  liquid.add_box({math::min(c.x, d.x), c.y}, {math::max(c.x, d.x), d.y}).value();
  for (int s = 0; s < 40; ++s) liquid.step(float(dt * t.time)).value();
  Vec3d middle{}, low{1e30, 1e30, 0}, high = -low;
  for (int i = 0; i < liquid.size(); ++i) {
    const math::Vec2d p = liquid.position(i);
    middle += Vec3d{p.x, p.y, 0} / liquid.size();
    low = min(low, Vec3d{p.x, p.y, 0}), high = max(high, Vec3d{p.x, p.y, 0});
  }
  if (t.mirrored) std::swap(low.x, high.x);
  return {low, middle, high};
}

TEST(FluidMetamorphic, AnyPlaceAndUnits) {
  EXPECT_LT(off(dam, {.mirrored = true}), 0.01);
  EXPECT_LT(off(dam, {.shift = {300, -40, 0}}), 0.01);
  EXPECT_LT(off(dam, {.length = 100, .mass = 1000}), 1e-3);
  EXPECT_LT(off(dam, {.length = 0.25, .mass = 2, .time = 0.5}), 1e-3);
  EXPECT_GT(off(dam, {.length = 100, .mass = 1000, .wrong = 1.05}), 3e-3) << "a wrong coefficient is not seen";
}

// A catenary of any size has one shape, where it hardly stretches; so has a cloth whose stiffness goes with its size
// and its bending stiffness with the cube of it.
TEST(RopeMetamorphic, CatenariesOfAnySizeHaveOneShape) {
  const auto hang = [](double size, double slack) {
    World3 world;
    RopeSet ropes;
    const Vec3d points[] = {{0, 0, 0}, {0.5 * size, -0.6 * size, 0}, {size, 0.1 * size, 0}};
    ropes
        .add({.material = {.mass_per_length = 0.3,
                           .radius = 0.01 * size,
                           .axial_stiffness = 1e6 * size,
                           .axial_damping = 200 * size * math::sqrt(size)},
              .points = points,
              .segments = 40,
              .length = slack * size})
        .value();
    for (const int end : {0, -1}) ropes.attach(0, {.node = end, .point = points[end == 0 ? 0 : 2]}, world).value();
    ropes.set_air({.density = 20 / (size * size)});
    for (int s = 0; s < 1200; ++s) ropes.step(world, math::sqrt(size) / 60).value();
    Places out;
    for (const Vec3d p : ropes.positions(0)) out.push_back(p / size);
    return out;
  };
  const Places one = hang(1, 1.5);
  EXPECT_LT(apart(one, hang(20, 1.5)), 1e-3);
  EXPECT_LT(apart(one, hang(0.1, 1.5)), 1e-3);
  EXPECT_GT(apart(one, hang(20, 1.52)), 3e-3) << "another length is not seen";
}

TEST(ClothMetamorphic, HangingClothsOfAnySizeHaveOneShape) {
  const auto hang = [](double size, double power) {
    World3 world;
    const ClothSheet sheet = make_cloth_sheet({0, 0, 0}, {size, 0, 0}, {0, 0, size}, 13, 13);
    Cloth cloth = Cloth::make({.fabric = {.warp_stiffness = 400 * size,
                                          .weft_stiffness = 400 * size,
                                          .shear_stiffness = 40 * size,
                                          .bending_stiffness = 2e-3 * math::pow(size, power),
                                          .damping = 0.05 * math::sqrt(size),
                                          .thickness = 0.004 * size},
                               .points = sheet.points,
                               .triangles = sheet.triangles,
                               .self_collide = false})
                      .value();
    cloth.set_air(1.225 / size, {}).value();
    for (const int corner : {0, 12, 156, 168})
      cloth.pin(corner, {}, 0.8 * sheet.points[std::size_t(corner)], world).value();
    for (int s = 0; s < 400; ++s) cloth.step(world, math::sqrt(size) / 60).value();
    Places out;
    for (const Vec3d p : cloth.positions()) out.push_back(p / size);
    return out;
  };
  const Places one = hang(1, 3);
  EXPECT_LT(apart(one, hang(5, 3)), 2e-3);
  EXPECT_LT(apart(one, hang(0.25, 3)), 2e-3);
  EXPECT_GT(apart(one, hang(5, 1)), 4e-3) << "another bending is not seen";
}

/// Fails where an energy rises by more than a share of all that there was at the start.
struct Falling {
  double first = 0, least = 0, rise = 0;
  bool begun = false;
  void see(double energy) {
    if (!begun) first = least = energy;
    begun = true;
    rise = math::max(rise, energy - least);
    least = math::min(least, energy);
  }
  double rising() const { return rise / first; }
};

// In still air, without anything that drives.
TEST(ParticlesMetamorphic, EnergyNeverRisesInStillAir) {
  for (const DragLaw law : {DragLaw::linear, DragLaw::stokes, DragLaw::schiller_naumann, DragLaw::quadratic}) {
    SystemDef def;
    def.mass = 1e-3f;
    def.radius = 0.01f;
    def.drag.law = law;
    if (law == DragLaw::linear) def.drag.coefficient = 1e-3f;
    ParticleSystem system = ParticleSystem::create(def).value();
    for (int i = 0; i < 10; ++i)
      EXPECT_TRUE(system.add({.position = {0, 200, 0}, .velocity = {3.0 * i, 20 - 4.0 * i, 1}}).value());
    Falling energy;
    for (int s = 0; s < 300; ++s) {
      const ParticleTotals totals = system.totals();
      energy.see(totals.kinetic_energy + totals.potential_energy);
      system.step(1.0 / 60).value();
    }
    EXPECT_LT(energy.rising(), 1e-6) << int(law);
  }
}

TEST(RopeMetamorphic, EnergyNeverRisesInStillAir) {
  World3 world;
  RopeSet ropes;
  const Vec3d points[] = {{0, 0, 0}, {2, 0.3, 0}};
  ropes
      .add({.material = {.mass_per_length = 0.2,
                         .axial_stiffness = 1e5,
                         .axial_damping = 50,
                         .bending_stiffness = 1e-3,
                         .bending_damping = 0.01},
            .points = points})
      .value();
  ropes.attach(0, {.node = 0, .point = {}}, world).value();
  Falling energy;
  for (int s = 0; s < 300; ++s) {
    energy.see(ropes.kinetic_energy() + ropes.elastic_energy() + ropes.potential_energy({0, -g, 0}) + 0.4 * g * 2);
    ropes.step(world, 1.0 / 60).value();
  }
  EXPECT_LT(energy.rising(), 1e-3);
}

TEST(ClothMetamorphic, EnergyNeverRisesInStillAir) {
  World3 world;
  const ClothSheet sheet = make_cloth_sheet({0, 0, 0}, {1, 0, 0}, {0, 0, 1}, 13, 13);
  Cloth cloth = Cloth::make({.points = sheet.points, .triangles = sheet.triangles}).value();
  cloth.pin(0).value();
  cloth.pin(12).value();
  Falling energy;
  for (int s = 0; s < 240; ++s) {
    double potential = 0;
    for (std::size_t i = 0; i < cloth.positions().size(); ++i)
      potential += double(cloth.masses()[i]) * g * (cloth.positions()[i].y + 1.1);
    energy.see(cloth.kinetic_energy() + cloth.elastic_energy() + potential);
    cloth.step(world, 1.0 / 60).value();
  }
  EXPECT_LT(energy.rising(), 1e-3);
}

TEST(SoftBodyMetamorphic, EnergyNeverRises) {
  World3 world;
  const SoftMesh mesh = make_soft_box({0, 0, 0}, {0.8, 0.2, 0.2}, 8, 2, 2);
  SoftBody body =
      SoftBody::make(
          {.material = {.density = 500, .youngs_modulus = 3e4}, .points = mesh.points, .tetrahedra = mesh.tetrahedra})
          .value();
  for (int i = 0; i < body.vertex_count(); ++i)
    if (i % 9 == 0) body.pin(i).value();
  Falling energy;
  for (int s = 0; s < 240; ++s) {
    energy.see(body.kinetic_energy() + body.elastic_energy() + body.mass() * g * (body.center().y + 0.8));
    body.step(world, 1.0 / 60).value();
  }
  EXPECT_LT(energy.rising(), 1e-3);
}

}  // namespace metamorphic_test
}  // namespace carom::particles
