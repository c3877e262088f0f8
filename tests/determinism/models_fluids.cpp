#include "carom/particles/fluid.h"
#include "carom/particles/granular.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

void fluid_models(int width) {
  const auto put = [](auto& world, const auto& shape, auto place, float density) {
    using D = std::conditional_t<std::is_same_v<decltype(place), math::Vec2d>, rigid::Dim2, rigid::Dim3>;
    rigid::BodyDef<D> body;
    body.position = place;
    rigid::ShapeDef<D> material;
    material.density = density;
    world.add_shape(world.create_body(body).value(), shape, material).value();
  };
  rigid::World2 plane({.simd_width = width});
  put(plane, geometry::make_box2({0.1f, 0.08f}), math::Vec2d{0.6, 0.6}, 500.0f);
  auto water = particles::Fluid2::create({.spacing = 0.02f, .viscosity = 1e-3f}).value();
  water.add_box({0, 0}, {1, 0.4}).value();
  water.add_box({0, 0.4}, {0.2, 0.9}, {1, 0}).value();
  rigid::World3 space({.simd_width = width});
  put(space, geometry::Sphere{0.12f}, math::Vec3d{0.5, 0.6, 0.5}, 300.0f);
  auto pool = particles::Fluid3::create({.spacing = 0.04f}).value();
  pool.add_box({0, 0, 0}, {1, 0.4, 1}).value();
  pool.add_tap({.center = {0.1, 0.8, 0.5}, .velocity = {1.5f, 0, 0}}).value();
  for (int i = 0; i < 60; ++i) {
    water.step(plane, 1.0f / 60).value();
    plane.step(1.0f / 60).value();
    pool.step(space, 1.0f / 60).value();
    space.step(1.0f / 60).value();
  }
  core::StateHash hash;
  print_model("fluid",
              hash.add(water.state_hash()).add(pool.state_hash()).add(plane.state_hash()).add(space.state_hash()));

  auto sand = particles::Granular2::create({.upper = {2, 1}, .radius = 0.02f, .lanes = width}).value();
  sand.add_box({0, 0}, {0.5, 0.8}).value();
  auto gravel = particles::Granular3::create({.radius = 0.04f, .lanes = width}).value();
  gravel.add_box({0.2, 0, 0.2}, {0.6, 0.6, 0.6}).value();
  rigid::World2 yard({.simd_width = width});
  put(yard, geometry::Circle{0.1f}, math::Vec2d{0.8, 0.1}, 500.0f);
  for (int i = 0; i < 60; ++i) {
    sand.step(yard, 1.0f / 60).value();
    yard.step(1.0f / 60).value();
    gravel.step(1.0f / 60).value();
  }
  hash = {};
  print_model("granular", hash.add(sand.state_hash()).add(gravel.state_hash()).add(yard.state_hash()));
}

}  // namespace carom::determinism
