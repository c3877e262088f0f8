#include "carom/ballistics/aim.h"
#include "carom/ballistics/batch.h"
#include "carom/ballistics/shell.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

void ballistics_models(int width) {
  using math::Vec3d;
  const ballistics::Conditions air{.wind = environment::WindColumn(environment::Wind{
                                       .velocity = {5, 0, 3}, .profile = environment::WindProfile::power}),
                                   .gravity_model = ballistics::GravityModel::round_earth,
                                   .rotation = ballistics::earth_rotation_rate(0.8, 1.1)};
  ballistics::ProjectileBatch batch(ballistics::DragCurve(ballistics::DragFunction::g1), air, {}, width);
  for (int i = 0; i < 100; ++i)
    batch.add({{0, 100.0 + i, 0}, (200.0 + 7 * i) * ballistics::direction(0.01 * i, i)}, 1e-3);
  for (int i = 0; i < 120; ++i) batch.step(1.0 / 60);
  core::StateHash hash;
  for (int k = 0; k < 6; ++k)
    for (const float x : batch.array(k)) hash.add(x);
  print_model("projectile_batch", hash);

  hash = {};
  const auto hash_vector = [&](Vec3d v) { hash.add(v.x).add(v.y).add(v.z); };
  const auto shell = ballistics::fly_shell(ballistics::m107(), air, {{}, 474.0 * ballistics::direction(0.5)},
                                           ballistics::ShellModel::six_degrees, {.time = 10, .tolerance = 1e-7});
  for (const ballistics::Trajectory::Node& node : shell->path.nodes())
    hash_vector(node.position), hash_vector(node.velocity);
  const auto aims = ballistics::aim(ballistics::projectile_from_coefficient(ballistics::DragFunction::g7, 0.3), air,
                                    {.muzzle_speed = 500}, ballistics::Target{{600, 20, 100}, {10, 0, -30}});
  for (const ballistics::Shot& shot : {*aims->low, *aims->high}) hash_vector(shot.direction), hash.add(shot.time);
  print_model("shell_and_aim", hash);
}

}  // namespace carom::determinism
