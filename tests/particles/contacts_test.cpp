// Grains: impacts, heaps, overlap, energy, weight on what bears them.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/math/elementary.h"
#include "carom/particles/system.h"

namespace particles_contacts_test {
using namespace carom;
using namespace carom::particles;
using math::Vec3d;

SystemDef grains(float restitution, float friction) {
  SystemDef d;
  d.radius = 0.05f;
  d.mass = 1;
  d.drag.law = DragLaw::none;
  d.contacts = {.enabled = true, .restitution = restitution, .friction = friction};
  return d;
}
std::vector<Collider> tray(float half) {
  std::vector<Collider> c(5);
  const math::Vec3f normals[5] = {{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
  for (int i = 0; i < 5; ++i) {
    c[std::size_t(i)].shape = geometry::Plane{normals[i]};
    c[std::size_t(i)].pose.position = i == 0 ? Vec3d{} : Vec3d(normals[i]) * double(-half);
    c[std::size_t(i)].friction = 0.5f;
    c[std::size_t(i)].restitution = 0.2f;
  }
  return c;
}

// Two equal balls head on exchange their velocities where e = 1; else the relative one is −e times that before.
TEST(ParticleContacts, HeadOn) {
  for (const float e : {0.0f, 0.5f, 1.0f}) {
    SystemDef d = grains(e, 0);
    d.gravity = {};
    ParticleSystem s = ParticleSystem::create(d).value();
    ASSERT_TRUE(s.add({.position = {-1, 0, 0}, .velocity = {4, 0, 0}}).value());
    ASSERT_TRUE(s.add({.position = {0, 0, 0}}).value());
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(s.step(1.0 / 60).ok());
    EXPECT_NEAR(s.velocity(0).x + s.velocity(1).x, 4, 1e-5);
    EXPECT_NEAR(s.velocity(1).x - s.velocity(0).x, 4 * double(e), 1e-5);
  }
}

// Grains let fall into a tray, eight layers: at rest within 1 % of a radius of overlap, borne by the floor and, through
// friction, the walls (Janssen 1895), none lost, and their energy falls.
TEST(ParticleContacts, AHeapComesToRest) {
  SystemDef d = grains(0.2f, 0.5f);
  d.capacity = 512;
  d.contacts.substeps = 12;
  ParticleSystem s = ParticleSystem::create(d).value();
  ASSERT_TRUE(s.set_colliders(tray(0.5f)).ok());
  math::Random random(2);
  for (int i = 0; i < d.capacity; ++i)
    ASSERT_TRUE(s.add({.position = {-0.4 + 0.11 * (i % 8) + random.uniform(0.0, 0.01), 0.1 + 0.12 * (i / 64),
                                    -0.4 + 0.11 * (i / 8 % 8) + random.uniform(0.0, 0.01)}})
                    .value());
  double last = 1e30, most_rise = 0;
  const double start = s.totals().potential_energy;
  for (int i = 0; i < 150; ++i) {
    ASSERT_TRUE(s.step(1.0 / 60).ok());
    const ParticleTotals t = s.totals();
    double energy = t.kinetic_energy + t.potential_energy;
    for (int k = 0; k < s.size(); ++k) energy += 0.5 * 0.4 * 0.05 * 0.05 * math::dot(s.spin(k), s.spin(k));
    most_rise = std::max(most_rise, energy - last);
    last = energy;
  }
  // While it lands, contacts give back what they were pressed together: .3 % of the energy at most.
  EXPECT_LT(most_rise, 5e-3 * start);
  EXPECT_LT(s.worst_overlap(), 0.01);
  EXPECT_EQ(s.size(), d.capacity);
  EXPECT_LT(s.totals().kinetic_energy / d.capacity, 1e-4);
  Vec3d borne{};
  for (const Exchange& e : s.exchanges()) borne += e.impulse;
  EXPECT_NEAR(-borne.y * 60 / (d.capacity * 9.80665), 1, 0.01);
  EXPECT_LT(-s.exchanges()[0].impulse.y, -borne.y);
  for (int i = 0; i < s.size(); ++i) ASSERT_GT(s.position(i).y, 0.05 * 0.99);
}

// A ball that rolls down a slope without slipping: a = 5/7 g sin θ; with resistance ρ by ρ cos θ less in the force.
TEST(ParticleContacts, RollsDownASlope) {
  for (const float rolling : {0.0f, 0.1f}) {
    SystemDef d = grains(0, 1);
    d.contacts.rolling = rolling;
    ParticleSystem s = ParticleSystem::create(d).value();
    const double angle = 0.3;
    Collider slope;
    slope.shape = geometry::Plane{{float(std::sin(angle)), float(std::cos(angle)), 0}};
    slope.friction = 1;
    ASSERT_TRUE(s.set_colliders({&slope, 1}).ok());
    ASSERT_TRUE(s.add({.position = Vec3d{std::sin(angle), std::cos(angle), 0} * 0.05}).value());
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(s.step(1.0 / 60).ok());
    const double a = 5.0 / 7 * 9.80665 * (std::sin(angle) - double(rolling) * std::cos(angle));
    EXPECT_NEAR(math::length(s.velocity(0)), a, 0.01 * a) << rolling;
    EXPECT_NEAR(-s.spin(0).z * 0.05, a, 0.01 * a) << rolling;
  }
}

TEST(ParticleContacts, SameBitsForAnyWidthAndThreadCount) {
  const auto run = [](int lanes, core::TaskScheduler* scheduler) {
    SystemDef d = grains(0.2f, 0.5f);
    d.lanes = lanes;
    d.radius = 0.03f;
    d.drag.law = DragLaw::quadratic;
    ParticleSystem s = ParticleSystem::create(d).value();
    EXPECT_TRUE(s.set_colliders(tray(0.4f)).ok());
    EXPECT_TRUE(s.add_emitter({.form = EmitterForm::disc,
                               .size = {0.3f, 0, 0},
                               .position = {0, 1, 0},
                               .rate = 600,
                               .direction = {0, -1, 0},
                               .lifetime = {1, 2},
                               .scale = {0.6f, 1.2f}})
                    .ok());
    for (int i = 0; i < 45; ++i) EXPECT_TRUE(s.step(1.0 / 60, scheduler).ok());
    EXPECT_GT(s.size(), 300);
    return s.state_hash();
  };
  const auto pool = core::make_thread_pool(3);
  const std::uint64_t first = run(4, nullptr);
  for (const int lanes : {4, 8, 16}) EXPECT_EQ(first, run(lanes, pool.get()));
}

}  // namespace particles_contacts_test
