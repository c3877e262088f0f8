// Particles against surfaces: bounces, friction, energy, tunnelling, the shapes of a world and momentum given to it.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/geometry/hull.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/geometry/query.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/elementary.h"
#include "carom/particles/coupling.h"

namespace particles_surfaces_test {
using namespace carom;
using namespace carom::particles;
using math::Vec3d;
using math::Vec3f;

SystemDef without_air(float radius = 0.1f) {
  SystemDef d;
  d.radius = radius;
  d.drag.law = DragLaw::none;
  return d;
}
Collider ground(float restitution = 0.6f, float friction = 0) {
  Collider c;
  c.shape = geometry::Plane{};
  c.restitution = restitution;
  c.friction = friction;
  return c;
}
double energy(const ParticleSystem& s) {
  const ParticleTotals t = s.totals();
  return t.kinetic_energy + t.potential_energy;
}

// Without loss it comes back to the same height for minutes, whatever the step is to the bounce.
TEST(ParticleSurfaces, ElasticBounceKeepsItsHeight) {
  ParticleSystem s = ParticleSystem::create(without_air()).value();
  const Collider c = ground(1);
  ASSERT_TRUE(s.set_colliders({&c, 1}).ok());
  ASSERT_TRUE(s.add({.position = {0, 1.1, 0}, .velocity = {0.5, 0, 0}}).value());
  const double before = energy(s);
  for (int i = 0; i < 6000; ++i) ASSERT_TRUE(s.step(1.0 / 60).ok());
  EXPECT_NEAR(energy(s) / before, 1, 2e-4);
  EXPECT_NEAR(s.velocity(0).x, 0.5, 1e-6);
}

// A block on a slope: holds where tan < μ, else slides with g(sin − μ cos).
TEST(ParticleSurfaces, FrictionOnASlope) {
  for (const double angle : {0.3, 0.6}) {
    ParticleSystem s = ParticleSystem::create(without_air()).value();
    Collider slope = ground(0.5f, 0.5f);
    slope.shape = geometry::Plane{{float(std::sin(angle)), float(std::cos(angle)), 0}};
    ASSERT_TRUE(s.set_colliders({&slope, 1}).ok());
    ASSERT_TRUE(s.add({.position = Vec3d{std::sin(angle), std::cos(angle), 0} * 0.1}).value());
    for (int i = 0; i < 120; ++i) ASSERT_TRUE(s.step(1.0 / 60).ok());
    const double a = std::max(0.0, 9.80665 * (std::sin(angle) - 0.5 * std::cos(angle)));
    EXPECT_NEAR(math::length(s.velocity(0)), 2 * a, 1e-4 + 1e-3 * a);
    EXPECT_NEAR(math::length(s.position(0) - Vec3d{std::sin(angle), std::cos(angle), 0} * 0.1), 2 * a, 1e-4 + 1e-3 * a);
  }
}

struct Placed {
  const char* name;
  geometry::Shape3 shape;
};
std::vector<Placed> all_shapes() {
  std::vector<Vec3f> corners;
  for (int i = 0; i < 8; ++i) corners.push_back({i & 1 ? 0.5f : -0.4f, i & 2 ? 0.3f : -0.3f, i & 4 ? 0.6f : -0.5f});
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  for (const float x : {-1.0f, 1.0f})
    for (const float z : {-1.0f, 1.0f}) vertices.push_back({x, 0.2f * x, z});
  indices = {0, 1, 3, 0, 3, 2};
  std::vector<float> heights;
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i) heights.push_back(0.1f * float((i * 7 + j * 3) % 4));
  return {{"sphere", geometry::Sphere{0.5f}},
          {"capsule", geometry::Capsule3{0.4f, 0.2f}},
          {"box", geometry::Box{{0.5f, 0.3f, 0.4f}}},
          {"rounded box", geometry::Box{{0.4f, 0.2f, 0.3f}, 0.1f}},
          {"cylinder", geometry::Cylinder{0.4f, 0.3f}},
          {"hull", geometry::make_hull(corners).value()},
          {"cone", geometry::Cone{0.4f, 0.5f}},
          {"rounded cone", geometry::Cone{0.3f, 0.4f, 0.1f}},
          {"ellipsoid", geometry::Ellipsoid{{0.5f, 0.3f, 0.4f}}},
          {"mesh", geometry::make_triangle_mesh(vertices, indices).value()},
          {"height field", geometry::make_height_field(5, 5, {0.5f, 0.5f}, heights).value()}};
}

// A thousand fast small particles from above, at any step: none gets through, none is left inside, energy falls.
TEST(ParticleSurfaces, NothingTunnelsAndEnergyNeverRises) {
  for (const Placed& p : all_shapes())
    for (const double dt : {1.0 / 240, 1.0 / 60, 1.0 / 15}) {
      SCOPED_TRACE(std::string(p.name) + " at " + std::to_string(dt));
      SystemDef d = without_air(0.01f);
      ParticleSystem s = ParticleSystem::create(d).value();
      std::vector<Collider> c(2);
      c[0].shape = p.shape;
      c[0].restitution = 0.7f;
      c[0].pose = {{100, 5, 0}, math::normalize(math::Quatf{1, 0.05f, 0.1f, -0.1f})};
      c[1] = ground(0.7f, 0.3f);
      s.set_anchor({100, 0, 0});
      ASSERT_TRUE(s.set_colliders(c).ok());
      math::Random random(5);
      const bool field = p.shape.type == geometry::ShapeType3::height_field;
      for (int i = 0; i < 500; ++i) {
        const Vec3d place{random.uniform(-0.2, 0.2), 3, random.uniform(-0.2, 0.2)};
        ASSERT_TRUE(s.add({.position = Vec3d{100, 5, 0} + (field ? Vec3d{1, 0, 1} : Vec3d{}) + place,
                           .velocity = {random.uniform(-3.0, 3.0), -60, random.uniform(-3.0, 3.0)}})
                        .value());
      }
      double last = energy(s);
      bool felt = false;
      for (int i = 0; i < int(2 / dt); ++i) {
        ASSERT_TRUE(s.step(dt).ok());
        const double now = energy(s);
        ASSERT_LE(now, last * (1 + 2e-6));
        felt = felt || now < 0.9 * last;
        last = now;
        for (int k = 0; k < s.size(); ++k) {
          const Vec3d at = s.position(k);
          ASSERT_GT(at.y, 0.01 - 1e-4) << k;
          if (field) continue;
          const math::Transform3f place{Vec3f(math::local_point(c[0].pose, at)), {}};
          const geometry::Shape3 ball = geometry::Sphere{0.0098f};
          ASSERT_FALSE(geometry::overlap(p.shape, ball, place)) << k << " step " << i;
        }
      }
      EXPECT_TRUE(felt);
    }
}

// A pane of 2 mm before bullets of 1 mm at 500 m/s.
TEST(ParticleSurfaces, AThinPaneStopsWhatIsFast) {
  ParticleSystem s = ParticleSystem::create(without_air(1e-3f)).value();
  Collider pane;
  pane.shape = geometry::Box{{1e-3f, 5, 5}};
  ASSERT_TRUE(s.set_colliders({&pane, 1}).ok());
  for (int i = 0; i < 100; ++i)
    ASSERT_TRUE(s.add({.position = {-3.0 - 0.05 * i, 0, 0}, .velocity = {500, 0, 0}}).value());
  for (int i = 0; i < 20; ++i) ASSERT_TRUE(s.step(1.0 / 60).ok());
  for (int k = 0; k < s.size(); ++k) EXPECT_LT(s.position(k).x, 0);
}

// A bat that turns and moves meets what stands still; in its frame nothing moves.
TEST(ParticleSurfaces, MovingBoxCarriesItsVelocity) {
  ParticleSystem s = ParticleSystem::create({.gravity = {}, .radius = 0.01f, .drag = {DragLaw::none}}).value();
  ASSERT_TRUE(s.add({.position = {2, 0, 0}}).value());
  Collider bat;
  bat.shape = geometry::Box{{0.1f, 1, 1}};
  bat.velocity = {30, 0, 0};
  bat.restitution = 1;
  for (int i = 1; i <= 10; ++i) {
    bat.pose.position = {0.5 * i, 0, 0};
    bat.center_of_mass = bat.pose.position;
    ASSERT_TRUE(s.set_colliders({&bat, 1}).ok());
    ASSERT_TRUE(s.step(1.0 / 60).ok());
  }
  EXPECT_NEAR(s.velocity(0).x, 60, 1e-4);
}

TEST(ParticleSurfaces, StickAndKill) {
  ParticleSystem s =
      ParticleSystem::create({.drag = {DragLaw::none}, .report_deaths = true, .report_hits = true}).value();
  std::vector<Collider> c(2, ground());
  c[0].shape = geometry::Sphere{1};
  c[0].answer = CollisionAnswer::stick;
  c[1].answer = CollisionAnswer::kill;
  c[1].pose.position = {0, -5, 0};
  ASSERT_TRUE(s.set_colliders(c).ok());
  ASSERT_TRUE(s.add({.position = {0.3, 3, 0}}).value());
  ASSERT_TRUE(s.add({.position = {2, 3, 0}}).value());
  std::vector<ParticleEvent> deaths, hits;
  for (int i = 0; i < 180; ++i) {
    ASSERT_TRUE(s.step(1.0 / 60).ok());
    deaths.insert(deaths.end(), s.deaths().begin(), s.deaths().end());
    hits.insert(hits.end(), s.hits().begin(), s.hits().end());
  }
  ASSERT_EQ(s.size(), 1);
  EXPECT_NEAR(math::length(s.position(0)), 1.01, 1e-4);
  ASSERT_EQ(deaths.size(), 1u);
  EXPECT_NEAR(deaths[0].position.y, -4.99, 1e-4);
  EXPECT_NEAR(deaths[0].position.x, 2, 1e-6);
  ASSERT_EQ(hits.size(), 2u);
  EXPECT_NEAR(hits[0].normal.y, std::sqrt(1 - std::pow(0.3 / 1.01, 2)), 1e-3);
  EXPECT_NEAR(hits[0].speed, std::sqrt(2 * 9.80665 * 2.04) * hits[0].normal.y, 0.1);
}

// Two-way: what particles lose a floating box gains, linear and angular, to float rounding; nothing else acts.
TEST(ParticleSurfaces, MomentumGoesToBodiesExactly) {
  rigid::World3 world({.gravity = {}});
  rigid::BodyDef<rigid::Dim3> def;
  def.position = {0.2, 0.1, 0};
  def.rotation = math::normalize(math::Quatf{1, 0.3f, 0.2f, 0});
  const rigid::BodyId body = world.create_body(def).value();
  rigid::ShapeDef<rigid::Dim3> shape;
  shape.density = 100;
  ASSERT_TRUE(world.add_shape(body, geometry::Box{{0.5f, 0.3f, 0.4f}}, shape).ok());
  SystemDef d = without_air(0.02f);
  d.gravity = {};
  d.mass = 0.01f;
  ParticleSystem s = ParticleSystem::create(d).value();
  math::Random random(3);
  for (int i = 0; i < 400; ++i)
    ASSERT_TRUE(s.add({.position = {-3 - 0.02 * i, random.uniform(-0.5, 0.5), random.uniform(-0.5, 0.5)},
                       .velocity = {20, 0, 0}})
                    .value());
  const auto angular = [&] {
    Vec3d sum = world.totals().angular_momentum;
    for (int i = 0; i < s.size(); ++i) sum += double(d.mass) * math::cross(s.position(i), s.velocity(i));
    return sum;
  };
  const double kinetic = s.totals().kinetic_energy;
  const Vec3d before = s.totals().momentum + world.totals().momentum, spin = angular();
  Coupling3 coupling({.restitution = 0.5f, .two_way = true});
  for (int i = 0; i < 60; ++i) {
    ASSERT_TRUE(world.step(1.0f / 60).ok());
    ASSERT_TRUE(coupling.step(world, s, 1.0 / 60).ok());
  }
  const Vec3d after = s.totals().momentum + world.totals().momentum;
  EXPECT_LT(math::distance(before, after), 2e-6 * math::length(before));
  EXPECT_GT(world.totals().momentum.x, 0.2 * before.x);
  EXPECT_LT(math::distance(spin, angular()), 0.01 * math::length(before));
  EXPECT_LT(s.totals().kinetic_energy + world.totals().kinetic_energy, kinetic);
}

// In the plane: a rain on a body of every shape; none inside, momentum as above.
TEST(ParticleSurfaces, PlaneWorld) {
  rigid::World2 world({.gravity = {}});
  std::vector<rigid::BodyId> bodies;
  const math::Vec2f triangle[3] = {{-0.4f, -0.3f}, {0.4f, -0.3f}, {0, 0.4f}};
  const geometry::Shape2 shapes[] = {geometry::Circle{0.4f}, geometry::Capsule2{0.3f, 0.2f},
                                     geometry::make_box2({0.4f, 0.3f}), geometry::make_polygon(triangle).value()};
  for (int i = 0; i < 4; ++i) {
    rigid::BodyDef<rigid::Dim2> def;
    def.position = {1.5 * i, 0};
    bodies.push_back(world.create_body(def).value());
    ASSERT_TRUE(world.add_shape(bodies.back(), shapes[i]).ok());
  }
  SystemDef d = without_air(0.02f);
  d.planar = true;
  d.gravity = {};
  ParticleSystem s = ParticleSystem::create(d).value();
  for (int i = 0; i < 300; ++i)
    ASSERT_TRUE(s.add({.position = {-0.5 + 0.02 * i, 1 + 0.001 * i, 0}, .velocity = {0, -6, 0}}).value());
  const Vec3d before = s.totals().momentum;
  Coupling2 coupling({.two_way = true});
  int hit = 0;
  for (int i = 0; i < 40; ++i) {
    ASSERT_TRUE(world.step(1.0f / 60).ok());
    ASSERT_TRUE(coupling.step(world, s, 1.0 / 60).ok());
    for (const Exchange& e : s.exchanges()) hit += e.touching;
  }
  EXPECT_GT(hit, 100);
  for (int i = 0; i < s.size(); ++i) EXPECT_EQ(s.position(i).z, 0);
  const Vec3d after = s.totals().momentum + Vec3d{world.totals().momentum.x, world.totals().momentum.y, 0};
  EXPECT_LT(math::distance(before, after), 2e-6 * math::length(before));
  for (const rigid::BodyId body : bodies) EXPECT_LT(world.state(body)->linear_velocity.y, -1e-7f);
}

}  // namespace particles_surfaces_test
