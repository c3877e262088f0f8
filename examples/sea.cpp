// A raft on a moderate sea in a gusty wind: one environment is what the raft floats on and what the game draws.
#include <cstdio>
#include <memory>

#include "carom/carom.h"
#include "carom/environment/environment.h"

int main() {
  using namespace carom;
  using environment::Environment;

  Environment::Definition around;
  environment::SeaDef waves;
  waves.spectrum = environment::sea_state(4);  // moderate: 1.9 m
  waves.direction = 0.3;                       // rad, from x toward z
  core::Result<environment::Sea> sea = environment::Sea::make({.current = {0.3, 0, 0}}, waves);
  if (!sea) return std::fprintf(stderr, "%s\n", sea.error().message.c_str()), 1;
  around.water = std::move(sea).value();
  around.wind.mean = {.velocity = {9, 0, 2}, .profile = environment::WindProfile::logarithmic};
  around.wind.turbulence =
      environment::Turbulence::make({.scales = environment::low_altitude_turbulence(10, 9), .mean_wind = {9, 0, 2}})
          .value();
  core::Result<Environment> made = Environment::make(std::move(around));
  if (!made) return std::fprintf(stderr, "%s\n", made.error().message.c_str()), 1;
  const auto here = std::make_shared<const Environment>(std::move(made).value());

  World3 world;
  (void)world.add_effector(rigid::Surroundings<rigid::Dim3>{here});
  rigid::Buoyancy<rigid::Dim3> water;
  water.linear_drag = water.angular_drag = 0.6;  // 1/s, of the displaced mass
  water.added_mass = {0.2f, 0.6f, 0.2f};
  (void)world.add_effector(water);
  const rigid::BodyId raft = world.create_body({.position = {0, 0.5, 0}}).value();
  (void)world.add_shape(raft, geometry::Box{{3, 0.4f, 2}}, {.density = 450});

  std::printf("%6s %8s %8s %10s\n", "s", "raft m", "water m", "wind m/s");
  for (int frame = 1; frame <= 600; ++frame) {
    (void)world.step(1.0f / 60);
    if (frame % 60 != 0) continue;
    const math::Vec3d p = world.state(raft)->pose.position;
    // What the game draws: Sea::grid gives the heights of a whole patch at once.
    std::printf("%6.1f %8.2f %8.2f %10.1f\n", world.time(), p.y, here->water()->height(p.x, p.z, world.time()),
                math::length(here->wind({p.x, p.y + 10, p.z}, world.time())));
  }
}
