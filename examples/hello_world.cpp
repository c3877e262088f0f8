// The smallest program with Carom: a ball falls on the ground and bounces.
#include <carom/carom.h>

#include <cstdio>

int main() {
  using namespace carom;
  World3 world;

  const auto ground = world.create_body({.type = rigid::BodyType::fixed}).value();
  world.add_shape(ground, geometry::Plane{}).value();

  const auto ball = world.create_body({.position = {0, 5, 0}}).value();
  world.add_shape(ball, geometry::Sphere{0.5f}, {.material = {.restitution = 0.8f}}).value();

  for (int step = 0; step < 180; ++step) {
    world.step(1.0f / 60.0f).value();
    if (step % 20 == 0) std::printf("%5.2f s  height %6.3f m\n", world.time(), world.state(ball)->pose.position.y);
  }
}
