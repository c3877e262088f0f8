// Small pieces from which the tests of this folder build their scenes.
#pragma once

#include <limits>

#include "mechanics_world.h"

namespace carom::rigid::test {

template <class D>
typename D::Position at(double x, double y, double z = 0) {
  if constexpr (D::dimension == 2)
    return {x, y};
  else
    return {x, y, z};
}
template <class D>
typename D::Vector along(float x, float y, float z = 0) {
  if constexpr (D::dimension == 2)
    return {x, y};
  else
    return {x, y, z};
}
template <class D>
typename D::Shape box_shape(float x, float y, float z) {
  if constexpr (D::dimension == 2)
    return geometry::make_box2({x, y});
  else
    return geometry::Box{{x, y, z}};
}
template <class D>
typename D::Shape ball_shape(float radius) {
  if constexpr (D::dimension == 2)
    return geometry::Circle{radius};
  else
    return geometry::Sphere{radius};
}
template <class D>
WorldDef<D> world_with(float gravity = 9.81f) {
  WorldDef<D> d;
  d.gravity = along<D>(0, -gravity);
  return d;
}

struct Surface {
  float friction = 0.6f, restitution = 0, density = 1000, rolling_resistance = 0, spinning_resistance = 0;
};
template <class D>
BodyId add_body(World<D>& world, BodyType type, const typename D::Shape& shape, typename D::Position position,
                const Surface& surface = {}, typename D::Vector velocity = {}) {
  BodyDef<D> body;
  body.type = type;
  body.position = position;
  body.linear_velocity = velocity;
  const BodyId id = world.create_body(body).value();
  ShapeDef<D> d;
  d.density = surface.density;
  d.material.friction = surface.friction;
  d.material.restitution = surface.restitution;
  d.material.rolling_resistance = surface.rolling_resistance;
  d.material.spinning_resistance = surface.spinning_resistance;
  world.add_shape(id, shape, d).value();
  return id;
}
template <class D>
BodyId add_ground(World<D>& world, const Surface& surface = {}) {
  return add_body<D>(world, BodyType::fixed, box_shape<D>(200, 1, 200), at<D>(0, -1), surface);
}
template <class D>
BodyId add_box(World<D>& world, typename D::Position position, float half = 0.5f, const Surface& surface = {}) {
  return add_body<D>(world, BodyType::dynamic, box_shape<D>(half, half, half), position, surface);
}
template <class D>
BodyId add_ball(World<D>& world, typename D::Position position, float radius, const Surface& surface = {},
                typename D::Vector velocity = {}) {
  return add_body<D>(world, BodyType::dynamic, ball_shape<D>(radius), position, surface, velocity);
}
/// A model whose force is no number after 0.2 s.
template <class D>
CustomEffector<D> breaks(BodyId body) {
  CustomEffector<D> broken;
  broken.body = body;
  broken.model = [](const EffectorInput<D>& in) {
    Wrench<D> w;
    if (in.time > 0.2) w.force.y = std::numeric_limits<float>::quiet_NaN();
    return w;
  };
  return broken;
}
template <class D>
void run(World<D>& world, int steps) {
  for (int i = 0; i < steps; ++i) world.step(frame).value();
}
template <class D>
float speed(const World<D>& world, BodyId body) {
  return math::length(world.state(body).value().linear_velocity);
}

/// Rows of boxes, each half a box further in.
template <class D>
std::vector<BodyId> add_pyramid(World<D>& world, int base, double z = 0) {
  std::vector<BodyId> bodies;
  for (int row = 0; row < base; ++row)
    for (int i = 0; i < base - row; ++i) bodies.push_back(add_box<D>(world, at<D>(0.5 * row + i, 0.5 + row, z)));
  return bodies;
}
/// Random numbers from −1 to 1, the same on every machine.
struct Draw {
  std::uint32_t r;
  float operator()() {
    r = 1664525u * r + 1013904223u;
    return float(r >> 8) / 8388608.0f - 1;
  }
};
/// A mixed heap that is thrown together: what determinism is tested on.
template <class D>
std::vector<BodyId> add_heap(World<D>& world, int layers) {
  std::vector<BodyId> bodies;
  std::uint32_t r = 12345;
  const auto draw = [&] {
    r = 1664525u * r + 1013904223u;
    return float(r >> 8) / 16777216.0f;
  };
  const int depth = D::dimension == 2 ? 1 : 4;
  for (int y = 0; y < layers; ++y)
    for (int x = 0; x < 4; ++x)
      for (int z = 0; z < depth; ++z) {
        const float dx = 0.2f * (draw() - 0.5f);
        const auto position = at<D>(1.25 * (x - 1.5) + double(dx), 1 + 1.25 * y, 1.25 * (z - 1.5));
        const int kind = (x + y + z) % 3;
        typename D::Shape shape = box_shape<D>(0.4f, 0.4f, 0.4f);
        if (kind == 1) shape = ball_shape<D>(0.45f);
        if constexpr (D::dimension == 2) {
          if (kind == 2) shape = geometry::Capsule2{0.3f, 0.3f};
        } else {
          if (kind == 2) shape = geometry::Capsule3{0.3f, 0.3f};
        }
        bodies.push_back(
            add_body<D>(world, BodyType::dynamic, shape, position, {0.5f, 0.2f * float(kind == 1), 1000, 0}));
      }
  return bodies;
}

}  // namespace carom::rigid::test
