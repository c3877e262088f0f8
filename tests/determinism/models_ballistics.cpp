#include "carom/ballistics/aim.h"
#include "carom/ballistics/batch.h"
#include "carom/ballistics/body_flight.h"
#include "carom/ballistics/hits.h"
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

  // A batch against a world on two threads: what it hits, what goes through, how it pushes; a body that flies.
  hash = {};
  rigid::WorldDef<rigid::Dim3> definition;
  definition.threads = 2;
  rigid::World3 world(definition);
  rigid::BodyId flying{};
  for (int i = 0; i < 60; ++i) {
    rigid::BodyDef<rigid::Dim3> body;
    body.position = {20.0 + 3 * i, 2.0 + 5 * (i % 7), -40.0 + 11 * (i % 9)};
    const rigid::BodyId id = *world.create_body(body);
    (void)*world.add_shape(id, geometry::Box{{1, 2, 3}});
    if (i == 0) flying = id;
  }
  (void)world.set_velocity(flying, {120, 40, 10}, {});
  (void)*world.add_effector(*ballistics::flight_effector<rigid::Dim3>(
      flying, {ballistics::projectile_from_coefficient(ballistics::DragFunction::g7, 0.3), air, 1.0 / 60}));
  ballistics::ProjectileBatch bullets(ballistics::DragCurve(ballistics::DragFunction::g7), air, {}, width);
  for (std::uint64_t i = 0; i < 500; ++i)
    bullets.add(
        {{0, 10, 0}, 600.0 * ballistics::direction(0.3 * math::sin(0.7 * double(i)), 0.5 * math::sin(double(i)))},
        ballistics::BatchRound{.area_per_mass = 5e-3, .mass = 0.01, .frontal_area = 5e-5, .tag = i});
  ballistics::BatchHits<rigid::Dim3> hits;
  const ballistics::Layer wood{.thickness = hits.through, .medium = {5e5, 100}, .ricochet_angle = 0.4};
  (void)hits.set_default(std::span(&wood, 1));
  for (int i = 0; i < 60; ++i) {
    if (i % 20 == 0) bullets.sort();
    (void)world.step(1.0f / 60);
    bullets.step(1.0 / 60);
    (void)hits.collect(bullets, world, 1.0 / 60);
    for (const ballistics::BatchHit& hit : hits.hits()) {
      hash.add(hit.tag).add(hit.time);
      hash_vector(hit.point), hash_vector(hit.exit_velocity), hash_vector(hit.impulse);
    }
  }
  hash.add(world.state_hash());
  print_model("projectiles_in_a_world", hash);
  const auto table =
      ballistics::AimTable::make(ballistics::projectile_from_coefficient(ballistics::DragFunction::g1, 0.4), air,
                                 {.muzzle_speed = 300, .longest_range = 2500, .elevations = 40});
  hash = {};
  for (int i = 1; i < 20; ++i)
    if (const auto entries = table->at(120.0 * i, 10.0 * i); entries.low)
      hash.add(entries.low->elevation).add(entries.high->time);
  print_model("aim_table", hash);
}

}  // namespace carom::determinism
