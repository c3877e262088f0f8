// Helpers of the tests of what a world has around it.
#pragma once

#include <memory>
#include <utility>

#include "carom/environment/environment.h"
#include "tests/rigid/mechanics_world.h"

namespace surroundings_test {
using namespace carom::rigid;
using namespace carom::rigid::test;
using namespace carom;
using environment::Environment;

using Dimensions = testing::Types<Dim2, Dim3>;

inline std::shared_ptr<const Environment> shared(Environment::Definition definition) {
  return std::make_shared<const Environment>(Environment::make(std::move(definition)).value());
}
inline BodyId ball(World3& world, double radius, float density, Vec3d position = {}, Vec3f velocity = {}) {
  BodyDef<Dim3> def;
  def.position = position;
  def.linear_velocity = velocity;
  const BodyId body = world.create_body(def).value();
  ShapeDef<Dim3> shape;
  shape.density = density;
  world.add_shape(body, geometry::Shape3(geometry::Sphere{float(radius)}), shape).value();
  return body;
}
inline std::shared_ptr<const Environment> sea_of(double height, double period, double direction = 0) {
  const environment::WaveComponent wave = environment::regular_wave(height, period, direction);
  Environment::Definition d;
  d.water = environment::Sea::make({}, {&wave, 1}).value();
  return shared(d);
}

}  // namespace surroundings_test
