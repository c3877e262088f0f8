// Small bodies of many shapes that are flung at ropes, cloth and soft bodies.
#pragma once

#include <cstdlib>
#include <string_view>

#include "carom/geometry/compound.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/shape3.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"
#include "carom/rigid/world.h"

namespace carom::particles {

/// How many are flung: a third of them, or all where CAROM_SHOTS is "all".
inline int shots_of(int all) {
  const char* const wanted = std::getenv("CAROM_SHOTS");
  return wanted != nullptr && std::string_view(wanted) == "all" ? all : (all + 2) / 3;
}

/// A ball, box, cylinder, hull or compound of `size` m from its middle to its nearest side.
inline geometry::Shape3 flung_shape(int kind, double size) {
  const float r = float(size);
  if (kind == 0) return geometry::Sphere{r};
  if (kind == 1) return geometry::Box{{r, r, r}};
  if (kind == 2) return geometry::Cylinder{r, r};
  std::vector<math::Vec3f> corners;
  for (int k = 0; k < 8; ++k) corners.push_back({k & 1 ? r : -r, k & 2 ? r : -r, k & 4 ? r : -r});
  if (kind == 3) return geometry::make_hull(corners).value();
  return geometry::make_compound(
             {{geometry::Box{{r, r, r}}, {{0.5f * r, 0, 0}, {}}}, {geometry::Box{{r, r, r}}, {{-0.5f * r, 0, 0}, {}}}})
      .value();
}

/// Turned and turning anyhow but for a ball.
inline rigid::BodyId fling_body(rigid::World3& world, math::Random& random, int kind, const geometry::Shape3& shape,
                                double mass, math::Vec3d position, math::Vec3d velocity) {
  rigid::BodyDef<rigid::Dim3> def;
  def.type = rigid::BodyType::dynamic;
  def.position = position;
  def.linear_velocity = math::Vec3f(velocity);
  if (kind > 0) {
    def.rotation = normalize(math::Quatf{random.uniform(-1.f, 1.f), random.uniform(-1.f, 1.f),
                                         random.uniform(-1.f, 1.f), random.uniform(-1.f, 1.f)});
    def.angular_velocity = {random.uniform(-20.f, 20.f), random.uniform(-20.f, 20.f), random.uniform(-20.f, 20.f)};
  }
  const rigid::BodyId body = world.create_body(def).value();
  world.add_shape(body, shape, {.density = 1000}).value();
  auto properties = world.mass_properties3(body).value();
  const double scale = mass / properties.mass;
  world.set_mass_properties(body, {mass, properties.center, scale * properties.inertia}).value();
  return body;
}

}  // namespace carom::particles
