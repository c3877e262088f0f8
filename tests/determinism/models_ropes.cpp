#include "carom/core/hash.h"
#include "carom/math/elementary.h"
#include "carom/particles/cloth.h"
#include "carom/particles/rope.h"
#include "carom/particles/soft_body.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

void rope_models(int width) {
  using math::Vec3d;
  constexpr double dt = 1.0 / 60;
  rigid::World3 world;
  rigid::BodyDef<rigid::Dim3> def;
  def.type = rigid::BodyType::fixed;
  def.rotation = {0.70710678f, 0.70710678f, 0, 0};
  world.add_shape(world.create_body(def).value(), geometry::Cylinder{1, 0.3f}).value();
  def = {};
  def.position = {1.5, 0.5, 0.1};
  const auto load = world.create_body(def).value();
  world.add_shape(load, geometry::Sphere{0.2f}).value();

  particles::RopeSet ropes;
  const Vec3d points[] = {{-1.5, 0.5, 0}, {0, 0.6, 0}, {1.5, 0.5, 0.1}};
  ropes.add({.material = {.bending_stiffness = 1e-3}, .points = points, .segments = 40}).value();
  ropes.attach(0, {.node = 0, .point = points[0]}, world).value();
  ropes.attach(0, {.node = -1, .body = load}, world).value();
  for (int i = 0; i < 120; ++i) {
    ropes.set_winch(0, 0, 0.2).value();
    ropes.step(world, dt).value();
    world.step(float(dt)).value();
  }
  core::StateHash hash;
  hash.add(ropes.state_hash()).add(world.state_hash());
  print_model("rope", hash);

  const auto sheet = particles::make_cloth_sheet({-0.5, 0.5, -0.5}, {1, 0, 0}, {0, 0.01, 1}, 17, 17);
  auto cloth = particles::Cloth::make({.fabric = {.thickness = 0.01, .tear_tension = 200},
                                       .points = sheet.points,
                                       .triangles = sheet.triangles,
                                       .lanes = width})
                   .value();
  cloth.pin(0).value();
  cloth.set_air(1.225, {.velocity = {3, 0, 1}}).value();
  for (int i = 0; i < 60; ++i) {
    cloth.step(world, dt).value();
    world.step(float(dt)).value();
  }
  hash = {};
  hash.add(cloth.state_hash()).add(world.state_hash());
  print_model("cloth", hash);

  const auto mesh = particles::make_soft_ball({0.05, 0.9, 0}, 0.3, 4);
  auto ball = particles::SoftBody::make({.points = mesh.points, .tetrahedra = mesh.tetrahedra, .lanes = width}).value();
  for (int i = 0; i < 60; ++i) {
    ball.step(world, dt).value();
    world.step(float(dt)).value();
  }
  hash = {};
  hash.add(ball.state_hash()).add(world.state_hash());
  print_model("soft_body", hash);
}

}  // namespace carom::determinism
