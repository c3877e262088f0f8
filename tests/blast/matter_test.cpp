// What a blast gives to cloth, ropes, soft bodies, liquids and grains: its loads on them, and no momentum from nowhere.
#include "carom/blast/matter.h"

#include <gtest/gtest.h>

namespace blast_matter_test {
using namespace carom;
using blast::Explosion3;
using math::Vec3d;
using rigid::World3;

/// A world without gravity that is stepped until the wave has passed; `push` is called before each step.
template <class Push>
Vec3d passed(const Explosion3& charge, World3& world, double dt, const Push& push) {
  Vec3d given{};
  while (!charge.finished(world.time())) {
    const core::Result<Vec3d> step = push();
    EXPECT_TRUE(step.ok());
    if (!step.ok()) break;
    given += *step;
    EXPECT_TRUE(world.step(float(dt)).ok());
  }
  return given;
}
World3 weightless() { return World3({.gravity = {}}); }
Explosion3 charge_of(double mass, bool clearing = false) {
  return Explosion3::make({.mass = mass, .clearing = clearing}).value();
}
/// A square of 1 m at `x`, square to the wave, of so many kg/m².
particles::Cloth sheet(double x, double mass_per_area, int cells = 8) {
  const auto mesh = particles::make_cloth_sheet({x, -0.5, -0.5}, {0, 1, 0}, {0, 0, 1}, cells + 1, cells + 1);
  return particles::Cloth::make({.fabric = {.mass_per_area = mass_per_area},
                                 .points = mesh.points,
                                 .triangles = mesh.triangles,
                                 .warp = {0, 1, 0}})
      .value();
}

// The difference of the pressures on both sides, summed in time, over the area: to 0.1 % in steps of any length.
TEST(BlastMatter, AHeavyClothTakesTheLoadOfBothSides) {
  const Explosion3 charge = charge_of(2);
  Vec3d expected{};
  particles::Cloth cloth = sheet(6, 1e5);
  const auto corners = cloth.triangles();
  for (std::size_t t = 0; t + 2 < corners.size(); t += 3) {
    const Vec3d a = cloth.positions()[corners[t]], b = cloth.positions()[corners[t + 1]],
                c = cloth.positions()[corners[t + 2]], center = (a + b + c) / 3.0;
    const double cosine = center.x / length(center);
    const blast::Wave wave = charge.wave_at(length(center));
    const blast::SurfaceLoad front(wave, cosine), back(wave, -cosine);
    double sum = 0;
    const double h = 2e-6;
    for (double time = wave.arrival + 0.5 * h; time < wave.arrival + 2 * wave.duration; time += h)
      sum += h * (front.pressure(time) - back.pressure(time));
    expected += Vec3d{0.5 * length(cross(b - a, c - a)) * sum, 0, 0};
  }
  for (const double dt : {1.0 / 60, 1.0 / 240, 1.0 / 2000}) {
    World3 world = weightless();
    particles::Cloth hit = sheet(6, 1e5);
    const Vec3d given = passed(charge, world, dt, [&] { return blast::push(charge, world, dt, hit); });
    EXPECT_NEAR(given.x, expected.x, 1e-3 * expected.x) << dt;
    EXPECT_NEAR(length(hit.momentum() - given), 0, 2e-6 * given.x);
    EXPECT_NEAR(given.y, 0, 1e-9 * given.x);
  }
}

// A long weak step of pressure p on a sheet with air on both sides, G. I. Taylor 1941: m dv/dt = 2 p − 2 ρ c v, so
// v = p/ρc (1 − e^(−2ρct/m)); in one step or in many. Drag by the square: v = u (1 − 1/(1 + F t/m u)).
TEST(BlastMatter, SheetsAndDragHaveClosedForms) {
  const double p = 1000, impedance = 1.225 * 340.294, mass = 0.3, time = 5e-4, wind = p / impedance;
  double speed = 0;
  for (int i = 0; i < 7; ++i) speed += blast::sheet_impulse(2 * p * time / 7, mass, speed, wind) / mass;
  EXPECT_NEAR(speed, wind * (1 - math::exp(-2 * impedance * time / mass)), 1e-12 * wind);
  EXPECT_NEAR(blast::sheet_impulse(2 * p * time, 1e9, 0, wind), 2 * p * time, 1e-8 * p * time);
  speed = 0;
  for (int i = 0; i < 7; ++i) speed += blast::drag_impulse(300.0 * time / 7, mass, speed, wind) / mass;
  EXPECT_NEAR(speed, wind * (1 - 1 / (1 + 300.0 * time / (mass * wind))), 1e-12 * wind);
  EXPECT_EQ(blast::sheet_impulse(1, 1, 5, 4), 0);
}

TEST(BlastMatter, ALightClothGoesAlongWithTheAir) {
  const Explosion3 charge = charge_of(1);
  for (const double mass : {20.0, 1.0, 0.2}) {
    const blast::Wave wave = charge.wave_at(25);
    const blast::SurfaceLoad front(wave, 1), back(wave, -1);
    double speed = 0, fastest = 0;
    const double h = 1e-6;
    for (double t = 0.5 * h; t < wave.duration; t += h) {
      const double wind = blast::wind_speed(blast::friedlander(wave.pressure, wave.duration, wave.decay, t));
      const double load = front.pressure(wave.arrival + t) - back.pressure(wave.arrival + t);
      if (wind > speed) speed += h * load * (1 - speed / wind) / mass;
      fastest = math::max(fastest, speed);
    }
    World3 world = weightless();
    particles::Cloth cloth = sheet(25, mass, 2);
    double found = 0;
    passed(charge, world, 5e-5, [&] {
      found = math::max(found, cloth.momentum().x / cloth.mass());
      return blast::push(charge, world, 5e-5, cloth);
    });
    EXPECT_NEAR(found, fastest, 0.02 * fastest) << mass;
  }
  // However strong the wave and long the step, no faster than its wind.
  for (const double dt : {1e-4, 1.0 / 60}) {
    const Explosion3 strong = charge_of(50);
    World3 world = weightless();
    particles::Cloth cloth = sheet(6, 0.05, 2);
    passed(strong, world, dt, [&] { return blast::push(strong, world, dt, cloth); });
    const double speed = cloth.momentum().x / cloth.mass();
    EXPECT_GT(speed, 20);
    EXPECT_LT(speed, blast::wind_speed(strong.wave_at(6).pressure));
  }
}

TEST(BlastMatter, WhatHoldsAClothTakesItsPart) {
  const Explosion3 charge = charge_of(2);
  World3 world = weightless();
  rigid::BodyDef<rigid::Dim3> bar;
  bar.position = {6, 0, -4};
  const rigid::BodyId body = world.create_body(bar).value();
  ASSERT_TRUE(world.add_shape(body, geometry::Box{{0.1f, 0.1f, 0.1f}}, {.density = 1e5f}).ok());
  particles::Cloth cloth = sheet(6, 1e4);
  for (int i = 0; i < 9; ++i) {  // half of the vertices of one edge to the bar, one to the world
    const Vec3d place = cloth.positions()[std::size_t(i)];
    ASSERT_TRUE(cloth.pin(i, body, place - Vec3d{6, 0, -4}, world).ok());
  }
  ASSERT_TRUE(cloth.pin(80).ok());
  const double free_of = cloth.mass();
  const Vec3d given = passed(charge, world, 1.0 / 240, [&] { return blast::push(charge, world, 1.0 / 240, cloth); });
  const auto state = world.state(body).value();
  const double held = double(world.mass_properties3(body).value().mass) * double(state.linear_velocity.x),
               kept = cloth.momentum().x;
  EXPECT_GT(held, 0.04 * given.x);
  EXPECT_GT(free_of, 0);
  // One vertex of a corner hangs on the world: at most 2 of 128 × 3 shares of the whole.
  EXPECT_NEAR(held + kept, given.x, 2.5 / 384 * given.x);
  EXPECT_LT(held + kept, given.x * (1 - 0.5 / 384));
}

// C_d d L ∫q dt across a rope, by the square of the sine; nothing along it.
TEST(BlastMatter, ARopeTakesTheWindAcrossIt) {
  const Explosion3 charge = charge_of(2);
  const auto along = [&](Vec3d from, Vec3d to) {
    const Vec3d points[] = {from, to};
    particles::RopeSet ropes;
    EXPECT_TRUE(ropes
                    .add({.material = {.mass_per_length = 100, .radius = 0.01, .drag_coefficient = 1.2},
                          .points = points,
                          .segments = 4})
                    .ok());
    World3 world = weightless();
    const Vec3d given = passed(charge, world, 1.0 / 240, [&] { return blast::push(charge, world, 1.0 / 240, ropes); });
    EXPECT_NEAR(length(ropes.momentum() - given), 0, 1e-12 * (1 + length(given)));
    return given;
  };
  const double far = 6;
  const blast::Wave wave = charge.wave_at(far);
  double q = 0;
  const double h = 1e-6;
  for (double t = 0.5 * h; t < wave.duration; t += h)
    q += h * blast::dynamic_pressure(wave.pressure) * math::square(1 - t / wave.duration) *
         math::exp(-2 * wave.decay * t / wave.duration);
  const double across = along({far, -0.1, 0}, {far, 0.1, 0}).x;
  EXPECT_NEAR(across, 1.2 * 0.02 * 0.2 * q, 2e-3 * across);
  const Vec3d slanting = along({far - 0.1, -0.1, 0}, {far + 0.1, 0.1, 0});
  // √2 as long, half of the wind's pressure, across the rope.
  EXPECT_NEAR(slanting.x, across * math::sqrt(2.0) / 2 * math::sqrt(0.5), 1e-2 * across);
  EXPECT_NEAR(slanting.y, -slanting.x, 1e-2 * across);
  EXPECT_LT(length(along({far, 0, 0}, {far + 0.5, 0, 0})), 1e-6 * across);
}

// A soft box gets what a rigid one of its size gets.
TEST(BlastMatter, ASoftBodyFeelsItsFaces) {
  for (const bool clearing : {false, true}) {
    Explosion3 charge = charge_of(4, clearing);
    World3 world = weightless();
    const auto mesh = particles::make_soft_box({7.5, -0.5, -0.5}, {1, 1, 1}, 6, 6, 6);
    particles::SoftBody soft =
        particles::SoftBody::make({.points = mesh.points, .tetrahedra = mesh.tetrahedra}).value();
    const double dt = 1.0 / 240;
    const Vec3d given = passed(charge, world, dt, [&] { return blast::push(charge, world, dt, soft); });
    EXPECT_NEAR(length(soft.momentum() - given), 0, 1e-5 * given.x);
    World3 other = weightless();
    rigid::BodyDef<rigid::Dim3> box;
    box.position = {8, 0, 0};
    const rigid::BodyId body = other.create_body(box).value();
    ASSERT_TRUE(other.add_shape(body, geometry::Box{{0.5f, 0.5f, 0.5f}}, {.density = 1000}).ok());
    while (!charge.finished(other.time())) {
      ASSERT_TRUE(charge.apply(other, dt).ok());
      ASSERT_TRUE(other.step(float(dt)).ok());
    }
    EXPECT_NEAR(given.x, charge.impulse_given().x, 0.01 * given.x) << clearing;
  }
}

// Of liquid and grains what the charge sees: the area of the front of a cube, once, whatever lies behind.
TEST(BlastMatter, LiquidsAndGrainsTakeAFront) {
  const Explosion3 charge = charge_of(2);
  const double far = 6, dt = 1.0 / 240;
  const blast::Wave wave = charge.wave_at(far);
  const double load = blast::SurfaceLoad(wave, 1).impulse() - blast::SurfaceLoad(wave, -1).impulse();
  const auto check = [&](auto& many, double mass, bool walls, rigid::BodyId wall, World3& world) {
    const Vec3d before = many.momentum();
    const Vec3d given = passed(charge, world, dt, [&] { return blast::push(charge, world, dt, many); });
    EXPECT_NEAR(length(many.momentum() - before - given), 0, 1e-4 * load);
    if (walls || !wall.is_null()) {
      EXPECT_EQ(given.x, 0);
      return;
    }
    // A square of 1 m²; light grains give way to a few percent.
    EXPECT_NEAR(given.x, load, 0.12 * load);
    EXPECT_GT(mass, 0);
    int moved = 0;
    for (int i = 0; i < many.size(); ++i) moved += length(many.velocity(i)) > 0 ? 1 : 0;
    EXPECT_LT(moved, many.size() / 4) << "what lies behind others is not pushed";
  };
  for (const int kind : {0, 1, 2}) {  // free, behind walls of the domain, behind a wall of the world
    World3 world = weightless(), same = weightless();
    rigid::BodyId wall{};
    for (World3* w : {&world, &same}) {
      if (kind != 2) continue;
      rigid::BodyDef<rigid::Dim3> body;
      body.type = rigid::BodyType::fixed;
      body.position = {3, 0, 0};
      wall = w->create_body(body).value();
      ASSERT_TRUE(w->add_shape(wall, geometry::Box{{0.1f, 2.0f, 2.0f}}, {}).ok());
    }
    particles::FluidDef<rigid::Dim3> d{.lower = {far, -0.5, -0.5}, .upper = {far + 1, 0.5, 0.5}, .spacing = 0.05f};
    for (bool& open : d.walls) open = kind == 1;
    auto water = particles::Fluid3::create(d).value();
    ASSERT_TRUE(water.add_box({far, -0.5, -0.5}, {far + 1, 0.5, 0.5}).ok());
    check(water, 1000, kind == 1, wall, world);
    particles::GranularDef<rigid::Dim3> g{
        .lower = {far, -0.5, -0.5}, .upper = {far + 1, 0.5, 0.5}, .radius = 0.04f, .radius_spread = 0};
    for (bool& open : g.walls) open = kind == 1;
    auto sand = particles::Granular3::create(g).value();
    ASSERT_TRUE(sand.add_box({far, -0.5, -0.5}, {far + 1, 0.5, 0.5}).ok());
    check(sand, 1000, kind == 1, wall, same);
  }
  World3 world = weightless();
  particles::RopeSet none;
  EXPECT_FALSE(blast::push(charge, world, 0, none).ok());
}

}  // namespace blast_matter_test
