// What shoulders, rails and scene files do with ballistics.
#include "carom/ballistics/body_rocket.h"
#include "carom/ballistics/body_shell.h"
#include "carom/ballistics/recoil.h"
#include "carom/ballistics/spinning_rounds.h"
#include "carom/ballistics/sway.h"
#include "carom/environment/environment.h"
#include "carom/scene/scene.h"
#include "tests/determinism/models.h"

namespace carom::determinism {

using math::Vec3d;

void rocket_models() {
  core::StateHash hash;
  const auto add = [&](Vec3d v) { hash.add(v.x).add(v.y).add(v.z); };
  environment::Environment::Definition around;
  around.wind.layers = {{0, {2, 0, 3}}, {60, {-4, 0, 6}}};
  around.wind.turbulence = *environment::Turbulence::make({});
  around.wind.gusts = {{.velocity = {0, 2, 7}, .front = -30, .gradient_distance = 25, .speed = 12}};
  const auto environment =
      std::make_shared<const environment::Environment>(*environment::Environment::make(std::move(around)));
  ballistics::Conditions air{.wind = environment::column_of(environment->definition().wind),
                             .gravity_model = ballistics::GravityModel::inverse_square,
                             .rotation = ballistics::earth_rotation_rate(0.7, 0.4)};
  const auto motor = [](double thrust, double time) {
    return ballistics::Motor{
        .propellant_mass = 0.03, .mass = 0.06, .curve = ballistics::ThrustCurve::constant(thrust, time)};
  };
  const ballistics::Rocket rocket{
      .stages = {{.motor = motor(30, 0.9), .dry_mass = 0.15, .dry_centre = 0.8, .separation_delay = 0.1},
                 {.motor = motor(12, 1.4), .dry_mass = 0.2, .dry_centre = 0.35, .motor_centre = 0.55}},
      .nose_length = 0.2,
      .fins = {.count = 3, .position = 0.85},
      .parachute = {.drag_area = 0.4, .deploy_delay = 0.5}};
  const ballistics::Launch launch{.direction = {0.15, 1, 0.05}, .rail_length = 1.2};
  for (const bool field : {false, true}) {
    if (field) air.field = [environment](Vec3d point, double time) { return environment->wind(point, time); };
    for (const auto model : {ballistics::RocketModel::point_mass, ballistics::RocketModel::six_degrees}) {
      const auto flight =
          ballistics::fly_rocket(rocket, air, launch, model, {.time = 12, .ground = 0, .tolerance = 1e-8});
      for (const ballistics::Trajectory::Node& node : flight->path.nodes()) add(node.position), add(node.velocity);
      for (const ballistics::RocketMoment& moment : flight->events) hash.add(moment.time);
    }
  }
  print_model("rocket_flights", hash);

  hash = {};
  rigid::World3 world;
  auto body =
      ballistics::BodyRocket::make(world, {.rocket = rocket, .conditions = air, .launch = launch, .start = 0.2});
  for (int i = 0; i < 600; ++i) {
    (void)body->before_step(world, 1.0 / 60);
    (void)world.step(1.0f / 60);
    if (i % 30 == 0) hash.add(world.state_hash());
  }
  hash.add(body->apex()).add(body->stages_left()).add(body->under_parachute());
  print_model("rocket_body", hash);
}

void shell_models() {
  core::StateHash hash;
  for (const auto model : {ballistics::ShellModel::modified_point_mass, ballistics::ShellModel::six_degrees}) {
    rigid::World3 world;
    const rigid::BodyId ground = *world.create_body({.type = rigid::BodyType::fixed});
    (void)*world.add_shape(ground, geometry::Plane{});
    auto shell =
        ballistics::BodyShell::make(world, {.shell = ballistics::m107(),
                                            .model = model,
                                            .conditions = {.wind = environment::WindColumn(Vec3d{4, 0, -7}),
                                                           .gravity_model = ballistics::GravityModel::inverse_square,
                                                           .rotation = ballistics::earth_rotation_rate(0.7, 0.4)},
                                            .start = {{0, 1, 0}, 300.0 * ballistics::direction(0.1)},
                                            .tip = {0, 1, 2},
                                            .fired_at = 0.1});
    for (int i = 0; i < 480; ++i) {
      (void)shell->before_step(world, 1.0 / 60);
      (void)world.step(1.0f / 60);
      if (i % 30 == 0) hash.add(world.state_hash()).add(shell->motion().spin).add(shell->yaw());
    }
    hash.add(shell->impact() != nullptr ? shell->impact()->point.x : 0);
  }
  print_model("shell_body", hash);

  hash = {};
  const ballistics::Conditions air{.wind = environment::WindColumn(Vec3d{-3, 0, 6})};
  ballistics::ProjectileBatch batch(ballistics::DragCurve(0.3), air);
  ballistics::SpinningRounds rounds(ballistics::m107());
  for (std::uint64_t i = 0; i < 5; ++i) {
    const ballistics::FlightPoint start{{0, 10.0 * double(i), 0}, 400.0 * ballistics::direction(0.2 + 0.1 * double(i))};
    batch.add(start, {.mass = 43, .tag = i});
    rounds.add(batch, start, i % 2 == 0 ? 900 : -900);
  }
  for (int i = 0; i < 240; ++i) {
    if (i == 100) batch.remove(1);
    if (i == 150) batch.place(0, {batch.at(0).position, {0, 90, 0}});
    rounds.step(batch, air, i / 60.0, 1.0 / 60);
  }
  for (int k = 0; k < 6; ++k)
    for (const float x : batch.array(k)) hash.add(x);
  hash.add(std::uint64_t(rounds.size()));
  print_model("spinning_rounds", hash);
}

void gun_models() {
  rocket_models();
  shell_models();
  core::StateHash hash;
  for (const auto stance : {ballistics::Stance::offhand, ballistics::Stance::prone}) {
    const ballistics::SwayMotion sway(ballistics::sway_of(stance, 0.6, 0.3), 12);
    for (int i = 0; i < 200; ++i) {
      const math::Vec2d at = sway.at(0.05 * i, 0.005 * i);
      hash.add(at.x).add(at.y);
    }
  }
  print_model("sway", hash);
  hash = {};
  const auto pattern = ballistics::recoil_pattern({.bore_beside_shoulder = 0.01}, 11, {.seed = 5});
  for (const math::Vec2d at : *pattern) hash.add(at.x).add(at.y);
  print_model("recoil_pattern", hash);

  // Guns that stand and ride, aim and scatter, in wind by height over a turning Earth, at what moves; a body that flies
  // as the rounds do, and a ball.
  const auto scene = scene::parse_scene(R"({"environment": {"frame": {"latitude": "50 deg"}, "ground": "-2 m",
      "air": {"altitude": "800 m"}, "wind": {"velocity": [3, 0, 6], "profile": "logarithmic",
        "gusts": [{"velocity": [0, 1, 9], "front": -40, "gradient_distance": 30, "speed": 20}]}},
    "bodies": [{"name": "cart", "position": [0, 0, 0], "velocity": [4, 0, 1], "gravity_scale": 0, "mass": 900, "shape": {"type": "box", "size": [3, 1, 2]}},
      {"repeat": {"i": 6}, "bodies": [{"name": "plate_{i}", "position": ["=120 m + 10 m * i", 4, "=3 m * i - 9 m"],
        "velocity": [0, "=20 m/s - 8 m/s * i", 0], "angular_velocity": [0, 0, "=3 rad/s * i"], "gravity_scale": 0, "mass": 40,
        "shape": {"type": "box", "size": [0.1, 6, 6], "material": {"user_id": 4}}}]},
      {"name": "shell", "position": [0, 6, 20], "velocity": [250, 60, 0], "shape": {"type": "sphere", "radius": 0.05}},
      {"name": "ball", "position": [0, 6, -20], "velocity": [50, 20, 0], "angular_velocity": [0, 40, 200],
        "shape": {"type": "sphere", "radius": 0.0213}}],
    "effectors": [{"type": "projectile", "body": "shell", "drag_function": "g1", "mass": 4, "diameter": 0.1},
      {"type": "ball_flight", "body": "ball", "flight": {"mass": 0.0459, "radius": 0.0213, "drag": 0.25, "lift": 0.3, "lift_spin_scale": 0.2}}],
    "guns": [{"name": "burst", "position": [0, 2, 0], "direction": [1, 0.03, 0], "rounds": 12, "rounds_per_minute": 600, "dispersion": 0.004,
        "climb": true, "ammunition": {"mass": 0.01, "diameter": 0.0078, "muzzle_speed": 700, "speed_deviation": 8, "drag_function": "g7", "ballistic_coefficient": 0.2}},
      {"name": "turret", "body": "cart", "position": [1.6, 1, 0], "target": "plate_3", "rounds": 4, "rounds_per_minute": 120,
        "ammunition": {"mass": 0.5, "diameter": 0.04, "muzzle_speed": 300, "drag_function": "g1", "powder_mass": 0.1}}],
    "penetration": [{"user_id": 4, "wall": [{"thickness": 0.02, "strength": 30e6, "inertia": 800}]}]})",
                                        "guns.json");
  if (!scene.ok()) {
    std::printf("model scene_with_guns %s\n", scene.error().message.c_str());
    return;
  }
  auto world = scene->instantiate();
  hash = {};
  for (int i = 0; i < 240 && world.ok(); ++i) {
    if (!world->step().ok()) break;
    if (i % 20 == 0) hash.add(world->state_hash());
  }
  if (world.ok()) hash.add(world->state_hash());
  print_model("scene_with_guns", hash);
}

}  // namespace carom::determinism
