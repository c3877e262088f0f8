#include "carom/particles/coupling.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

namespace {

using namespace particles;

ParticleSystem stormy(int width) {
  SystemDef d;
  d.capacity = 5000;
  d.radius = 0.02f;
  d.mass = 0.002f;
  d.lanes = width;
  d.drag = {.law = DragLaw::schiller_naumann};
  d.drag_over_age = Curve::make({{0, 1}, {1, 3}}).value();
  ParticleSystem system = ParticleSystem::create(d).value();
  Air air;
  air.wind = {.velocity = {4, 0, 1}, .profile = environment::WindProfile::logarithmic};
  air.turbulence = {.speed = 2, .length = 3};
  air.whirls.push_back({.center = {2, 0, 0}});
  (void)system.set_air(air);
  const Attractor pull{.center = {0, 4, 3}, .radial = {.strength = -3, .exponent = -1.5, .range = 8}};
  (void)system.set_attractors({&pull, 1});
  (void)system.add_emitter({.form = EmitterForm::sphere,
                            .size = {1, 1, 1},
                            .position = {0, 5, 0},
                            .rate = 1500,
                            .spread = 1,
                            .speed = {2, 8},
                            .lifetime = {0.5f, 2.5f},
                            .scale = {0.5f, 1.5f}});
  return system;
}

}  // namespace

void particle_models(int width) {
  // A storm in a world of bodies that feel it, of every kind of shape that lanes know and of some that they do not.
  rigid::World3 world;
  const auto add = [&](rigid::BodyType type, math::Vec3d place, const geometry::Shape3& shape) {
    rigid::BodyDef<rigid::Dim3> body;
    body.type = type;
    body.position = place;
    (void)world.add_shape(world.create_body(body).value(), shape);
  };
  add(rigid::BodyType::fixed, {}, geometry::Plane{});
  add(rigid::BodyType::dynamic, {0, 1, 0}, geometry::Box{{0.5f, 0.3f, 0.4f}});
  add(rigid::BodyType::dynamic, {1.5, 1, 0}, geometry::Sphere{0.4f});
  add(rigid::BodyType::dynamic, {-1.5, 1, 0}, geometry::Capsule3{0.4f, 0.2f});
  add(rigid::BodyType::dynamic, {0, 1, 1.5}, geometry::Cylinder{0.3f, 0.3f});
  add(rigid::BodyType::dynamic, {0, 1, -1.5}, geometry::Cone{0.4f, 0.4f});
  ParticleSystem storm = stormy(width);
  Coupling3 coupling({.two_way = true});
  for (int i = 0; i < 120; ++i) {
    (void)world.step(1.0f / 60);
    (void)coupling.step(world, storm, 1.0 / 60);
  }
  print_model("particle_storm", core::StateHash().add(storm.state_hash()).add(world.state_hash()));

  SystemDef grains;
  grains.capacity = 1000;
  grains.radius = 0.04f;
  grains.lanes = width;
  grains.contacts.enabled = true;
  ParticleSystem heap = ParticleSystem::create(grains).value();
  Collider ground;
  ground.shape = geometry::Plane{};
  (void)heap.set_colliders({&ground, 1});
  (void)heap.add_emitter({.form = EmitterForm::disc,
                          .size = {0.3f, 0, 0},
                          .position = {0, 1.5, 0},
                          .rate = 400,
                          .direction = {0, -1, 0},
                          .lifetime = {3, 4},
                          .scale = {0.7f, 1.2f}});
  for (int i = 0; i < 120; ++i) (void)heap.step(1.0 / 60);
  print_model("particle_heap", core::StateHash().add(heap.state_hash()));

  core::StateHash burst;
  const std::vector<math::Vec3d> velocities =
      burst_velocities({.count = 101, .energy = 10, .equal_speeds = false}).value();
  for (const math::Vec3d& w : velocities) burst.add(w.x).add(w.y).add(w.z);
  print_model("particle_burst", burst);
}

}  // namespace carom::determinism
