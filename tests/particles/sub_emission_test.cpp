// Particles that are born where others strike or die, and on the surface of a mesh.
#include <gtest/gtest.h>

#include "carom/geometry/mesh_builders.h"
#include "carom/math/elementary.h"
#include "carom/particles/system.h"

namespace sub_emission_test {
using namespace carom;
using namespace carom::particles;
using math::Vec3d;

ParticleSystem system_of(const SystemDef& def) { return ParticleSystem::create(def).value(); }

// Rain on a sloping roof: every drop that strikes bears three that leave the roof within the cone about its normal, at
// the speed that was drawn, from where the drop struck.
TEST(SubEmission, DropsThatStrikeBearSplashesAlongTheNormal) {
  ParticleSystem rain = system_of({.capacity = 400, .radius = 1e-3f, .drag = {DragLaw::none}, .report_hits = true});
  ParticleSystem splash = system_of({.capacity = 4000, .gravity = {}, .drag = {DragLaw::none}});
  const double slope = math::pi / 6;
  const Vec3d normal{math::sin(slope), math::cos(slope), 0};
  const Collider roof[] = {{.shape = geometry::Plane{math::Vec3f(normal)}, .answer = CollisionAnswer::kill}};
  rain.set_colliders(roof).value();
  math::Random random(7);
  for (int i = 0; i < 400; ++i) {
    const double x = random.uniform(-2.0, 2.0), above = random.uniform(0.5, 3.0);
    rain.add({.position = {x, -x * math::tan(slope) + above, random.uniform(-2.0, 2.0)}}).value();
  }
  SubEmission sub{.emitter = {.spread = 0.5f, .speed = {2, 3}, .lifetime = {100, 100}, .seed = 3}, .count = 3};
  int struck = 0;
  for (int i = 0; i < 90; ++i) {
    rain.step(1.0 / 60).value();
    const int before = splash.size();
    const int born = splash.emit_at(rain.hits(), sub).value();
    struck += int(rain.hits().size());
    EXPECT_EQ(born, 3 * int(rain.hits().size()));
    for (int k = before; k < splash.size(); ++k) {
      const ParticleEvent& event = rain.hits()[std::size_t(k - before) / 3];
      EXPECT_LT(length(splash.position(k) - event.position), 1e-3);
      EXPECT_NEAR(dot(splash.position(k), normal), 0, 2e-3);
      const double speed = length(splash.velocity(k));
      EXPECT_GE(speed, 2 - 1e-5);
      EXPECT_LE(speed, 3 + 1e-5);
      EXPECT_GE(dot(splash.velocity(k), normal), speed * math::cos(0.5) - 1e-5);
    }
  }
  EXPECT_EQ(struck, 400);
  EXPECT_EQ(splash.size(), 1200);
}

// Rockets that burn out in flight: what they bear starts from where they ended, with the share of their velocity that
// was asked for, and a chance of a half is one of many draws.
TEST(SubEmission, DeathsHandDownTheirVelocityAndChanceIsAShare) {
  ParticleSystem rockets = system_of({.capacity = 2000, .gravity = {}, .drag = {DragLaw::none}, .report_deaths = true});
  ParticleSystem sparks = system_of({.capacity = 10'000, .gravity = {}, .drag = {DragLaw::none}});
  for (int i = 0; i < 2000; ++i)
    rockets.add({.position = {0.01 * i, 0, 0}, .velocity = {0, 40, 0}, .lifetime = 0.5f}).value();
  const SubEmission sub{.emitter = {.spread = float(math::pi), .speed = {1, 1}, .lifetime = {9, 9}},
                        .count = 4,
                        .chance = 0.5f,
                        .inherited = 0.75f,
                        .along_normal = false};
  int born = 0;
  for (int i = 0; i < 40; ++i) {
    rockets.step(1.0 / 60).value();
    born += sparks.emit_at(rockets.deaths(), sub).value();
  }
  EXPECT_EQ(rockets.size(), 0);
  EXPECT_EQ(born, sparks.size());
  EXPECT_EQ(born % 4, 0);
  EXPECT_NEAR(born / 4, 1000, 4 * 22.4);  // four standard deviations of 2000 draws
  Vec3d mean{};
  for (int i = 0; i < sparks.size(); ++i) {
    EXPECT_NEAR(length(sparks.velocity(i) - Vec3d{0, 30, 0}), 1, 1e-4);
    EXPECT_NEAR(sparks.position(i).y, 20, 1);  // 40 m/s for half a second, to the step
    mean += sparks.velocity(i) / double(sparks.size());
  }
  EXPECT_LT(length(mean - Vec3d{0, 30, 0}), 0.06);
}

// Every particle is born on a triangle of the mesh and leaves it outward.
TEST(SubEmission, AMeshBearsOnItsSurfaceAndOutward) {
  const geometry::Triangles ring = geometry::make_torus_mesh(2, 0.5f, 48, 24);
  const auto mesh = geometry::make_triangle_mesh(ring.positions, ring.indices).value();
  ParticleSystem steam = system_of({.capacity = 5000, .gravity = {}, .drag = {DragLaw::none}});
  const int emitter =
      steam
          .add_emitter(
              {.form = EmitterForm::mesh, .mesh = mesh, .along_normal = true, .speed = {1, 1}, .lifetime = {9, 9}})
          .value();
  ASSERT_EQ(steam.emit(emitter, 5000).value(), 5000);
  double outer = 0;
  for (int i = 0; i < steam.size(); ++i) {
    const Vec3d p = steam.position(i), v = steam.velocity(i);
    const double round = math::hypot(p.x, p.y);           // about z; its circle is 2 m from there
    EXPECT_NEAR(math::hypot(round - 2, p.z), 0.5, 0.01);  // flat faces between 48 and 24 corners
    EXPECT_GT(dot(v, p - (2 / round) * Vec3d{p.x, p.y, 0}), 0.97 * 0.49);
    outer += round > 2;
  }
  // Of a torus' area the outer half has 1/2 + r/(π R).
  EXPECT_NEAR(outer / 5000, 0.5 + 0.5 / (math::pi * 2), 0.03);
}

}  // namespace sub_emission_test
