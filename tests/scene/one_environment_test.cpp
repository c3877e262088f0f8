// One environment: guns, rockets, projectiles, balls and particles of a scene feel the air that its bodies feel.
#include <gtest/gtest.h>

#include <sstream>

#include "carom/ballistics/body_flight.h"
#include "carom/scene/destruction.h"
#include "carom/scene/scene.h"
#include "carom/sports/flight.h"
#include "carom/sports/presets.h"
#include "tests/scene/scene_world.h"
#include "tests/scene/source_file.h"

namespace scene_one_environment_test {
using namespace carom;
using math::Vec3d;
using scene::SceneWorld;

SceneWorld start(const std::string& text) {
  return scene::test::started(scene::parse_scene(text, "s.json", scene::test::read_source));
}
void run(SceneWorld& world, int steps) {
  for (int i = 0; i < steps; ++i) ASSERT_TRUE(world.step().ok());
}
const environment::Environment& around(const SceneWorld& world) {
  return *scene::environment_of(*world.world3, world.environment);
}
Vec3d center(const SceneWorld& world, const char* name) {
  return world.world3->state(world.find_body(name)->id)->center_of_mass;
}

constexpr const char* shot = R"("mass": "4 kg", "diameter": "10 cm", "drag_function": "gs")";
const ballistics::Projectile model =
    ballistics::projectile_from_size(ballistics::DragCurve(ballistics::DragFunction::gs), 4, .1);

constexpr const char* winds[] = {
    R"("layers": [{"height": "0 m", "velocity": [2, 0, 3]}, {"height": "20 m", "velocity": [0, 0, 14]},
                  {"height": "60 m", "velocity": [-4, 0, -9]}])",
    R"("velocity": [3, 0, 8], "profile": "power")",
    R"("velocity": [3, 0, 8], "profile": "logarithmic", "roughness_length": "10 cm")"};

// Rounds fly as the model does in the column of the environment, over ground that is not at zero.
TEST(OneEnvironment, GunsFeelTheWindByHeight) {
  for (const char* wind : winds) {
    SceneWorld world = start(std::string(R"({"step": "1/240 s", "environment": {"ground": "30 m", "wind": {)") + wind +
                             R"(}}, "guns": [{"name": "g", "position": [0, 31, 0], "direction": [1, 0.15, 0],
                      "ammunition": {"muzzle_speed": "200 m/s", )" +
                             shot + "}}]}");
    run(world, 960);
    const auto& gun = world.destruction->space.guns[0].thing;
    ASSERT_EQ(gun.batch.size(), 1u);
    const Vec3d bore = math::normalize(Vec3d{1, .15, 0});
    const auto fly = [&](const environment::WindColumn& column) {
      return ballistics::fly(model, {.wind = column}, {{0, 31, 0}, 200.0 * bore}, {.time = 4})->end().position;
    };
    const Vec3d there = gun.batch.at(0).position;
    const Vec3d expected = fly(environment::column_of(around(world).definition().wind, 30));
    EXPECT_GT(math::abs(expected.z), 1) << wind;
    EXPECT_NEAR(there.z, expected.z, .01 * math::abs(expected.z)) << wind << ": batches know wind every ten metres";
    EXPECT_LT(math::length(there - expected), .1) << wind;
    EXPECT_GT(math::abs(there.z - fly(environment::WindColumn(around(world).definition().wind.mean.velocity)).z), .2);
  }
}

// A body without drag and a round without drag that leave side by side stay together in a frame that turns.
TEST(OneEnvironment, BodiesAndRoundsTurnAlike) {
  for (const int dimension : {2, 3}) {
    const bool plane = dimension == 2;
    SceneWorld world =
        start(std::string("{\"dimension\": ") + (plane ? "2" : "3") + R"(, "step": "1/240 s", "gravity": )" +
              (plane ? "[0, 0]" : "[0, 0, 0]") + R"(, "environment": {"frame": {"rate": )" +
              (plane ? "\"0.2 rad/s\"" : R"(["0.1 rad/s", "-0.15 rad/s", "0.2 rad/s"])") +
              R"(}}, "bodies": [{"name": "b", "position": )" + (plane ? "[0, 2]" : "[0, 2, 0]") + R"(, "velocity": )" +
              (plane ? "[80, 60]" : "[80, 60, 0]") + R"(, "shape": {"type": )" + (plane ? "\"circle\"" : "\"sphere\"") +
              R"(, "radius": 0.1}}],
            "guns": [{"name": "g", "position": )" +
              (plane ? "[0, 0]" : "[0, 0, 0]") + R"(, "direction": )" + (plane ? "[0.8, 0.6]" : "[0.8, 0.6, 0]") +
              R"(, "ammunition": {"mass": 1, "diameter": 0.1, "drag_coefficient": 0, "muzzle_speed": 100}}]})");
    run(world, 480);
    const auto& batch =
        plane ? world.destruction->plane.guns[0].thing.batch : world.destruction->space.guns[0].thing.batch;
    ASSERT_EQ(batch.size(), 1u);
    const Vec3d round = batch.at(0).position;
    Vec3d body{scene::test::read(world, "b.position.x"), scene::test::read(world, "b.position.y") - 2, 0};
    if (!plane) body.z = scene::test::read(world, "b.position.z");
    EXPECT_GT(math::length(round - Vec3d{160, 120, 0}), 20) << "it turns";
    EXPECT_LT(math::length(round - body), .02)
        << round.x - body.x << ' ' << round.y - body.y << ' ' << round.z - body.z;
  }
}

// A projectile asks the environment for wind and air; what it says itself counts instead.
TEST(OneEnvironment, ProjectilesFlyInIt) {
  for (const char* wind : winds) {
    const auto fly = [&](const char* own) {
      SceneWorld world = start(
          std::string(
              R"({"step": "1/240 s", "environment": {"ground": "30 m", "air": {"altitude": "1500 m"}, "wind": {)") +
          wind + R"(}}, "bodies": [{"name": "b", "position": [0, 31, 0], "velocity": [200, 30, 0],
            "shape": {"type": "sphere", "radius": "5 cm"}}], "effectors": [{"type": "projectile", "body": "b", )" +
          shot + own + "}]}");
      run(world, 960);
      const ballistics::Conditions air{.air = environment::AirColumn({}, 1500),
                                       .wind = environment::column_of(around(world).definition().wind, 30)};
      const Vec3d expected = ballistics::fly(model, air, {{0, 31, 0}, {200, 30, 0}}, {.time = 4})->end().position;
      return std::pair(center(world, "b"), expected);
    };
    const auto [there, expected] = fly("");
    EXPECT_NEAR(there.z, expected.z, 1e-3 * math::abs(expected.z)) << wind;
    EXPECT_NEAR(there.x, expected.x, 1e-3 * 4) << wind;
    EXPECT_EQ(fly(R"(, "velocity": [0, 0, 0])").first.z, 0);
    EXPECT_LT(fly(R"(, "density": "1.225 kg/m^3")").first.x, there.x - 1) << "thicker air";
  }
}

// A drive in Mexico City: as far as the model says with that air, and farther than at the sea; a gust carries it aside.
TEST(OneEnvironment, BallsFlyInIt) {
  const sports::Ball ball = *sports::ball_preset("golf");
  const auto drive = [&](const std::string& environment, const std::string& own = "") {
    const double inertia = ball.inertia_factor * ball.mass * ball.radius * ball.radius;
    std::ostringstream text;
    text.precision(17);
    text << R"({"step": "1/240 s", )" << environment << R"("bodies": [{"name": "ball", "position": [0, 1, 0],
        "velocity": [70, 14, 0], "angular_velocity": [0, 0, 280], "shape": {"type": "sphere", "radius": )"
         << ball.radius << R"(}, "mass_properties": {"mass": )" << ball.mass << R"(, "inertia": [)" << inertia << ", "
         << inertia << ", " << inertia << R"(]}}], "effectors": [{"type": "ball_flight", "body": "ball", )" << own
         << R"("flight": {"preset": "flight/golf"}}]})";
    SceneWorld world = start(text.str());
    run(world, 1200);
    return center(world, "ball");
  };
  const auto fly = [&](sports::Conditions air) {
    return sports::fly(ball, air, {.position = {0, 1, 0}, .velocity = {70, 14, 0}, .spin = {0, 0, 280}}, -1e3,
                       {.time = 5})
        ->at(5)
        .position;
  };
  sports::Conditions high;
  high.air = environment::AirColumn({}, 2200);
  high.viscosity = environment::standard_atmosphere(2200 + 20).viscosity;
  const Vec3d there = drive(R"("environment": {"air": {"altitude": "2200 m"}},)");
  EXPECT_LT(math::length(there - fly(high)), .05);
  const Vec3d sea = drive("");
  EXPECT_LT(math::length(sea - fly({})), .05);
  EXPECT_GT(there.x, sea.x + 8);
  EXPECT_LT(
      math::length(drive(R"("environment": {"air": {"altitude": "2200 m"}},)", R"("density": "1.225 kg/m^3",)") - sea),
      1e-6);
  const environment::Gust gust{.velocity = {0, 0, 15}, .front = 200, .gradient_distance = 60, .speed = -10};
  sports::Conditions gusty;
  gusty.field = [gust](Vec3d p, double t) { return environment::gust_at(gust, p, t); };
  gusty.air = environment::AirColumn();
  const Vec3d blown = drive(R"("environment": {"wind": {"gusts": [{"velocity": [0, 0, 15], "front": 200,
      "gradient_distance": 60, "speed": -10}]}},)");
  EXPECT_GT(blown.z, 3);
  EXPECT_LT(math::length(blown - fly(gusty)), .05);
}

// A wind that rises while the world runs takes rounds and rockets in flight along.
TEST(OneEnvironment, FollowsLiveParameters) {
  const auto scene = scene::parse_scene(
      R"({"parameters": {"wind": {"value": "0 m/s", "minimum": "0 m/s", "maximum": "20 m/s", "live": true}},
      "environment": {"wind": {"velocity": [0, 0, "=wind"]}},
      "guns": [{"name": "g", "direction": [1, 1, 0], "ammunition": {"mass": 1, "diameter": 0.1, "muzzle_speed": 150}}],
      "rockets": [{"name": "r", "preset": "rocket/two_stage_c6", "position": [0, 0, 50]}]})",
      "s.json", scene::test::read_source);
  SceneWorld world = scene::test::started(scene);
  run(world, 60);
  const auto& gun = world.destruction->space.guns[0].thing;
  ASSERT_EQ(gun.batch.size(), 1u);
  EXPECT_NEAR(gun.batch.at(0).velocity.z, 0, 1e-6);
  EXPECT_NEAR(center(world, "r").z, 50, .01);
  const scene::ParameterValue value{"wind", 15};
  ASSERT_TRUE(scene->apply(world, {&value, 1}).ok());
  run(world, 60);
  EXPECT_GT(gun.batch.at(0).velocity.z, .5);
  EXPECT_GT(math::abs(center(world, "r").z - 50), .5);
}

// A rocket meets the gust that its environment has.
TEST(OneEnvironment, RocketsFeelGusts) {
  const auto launch = [](const char* wind) {
    SceneWorld world =
        start(std::string(R"({"environment": {"wind": {)") + wind +
              R"(}}, "rockets": [{"name": "r", "preset": "rocket/two_stage_c6", "rail_length": "1.2 m"}]})");
    run(world, 180);
    return center(world, "r");
  };
  const Vec3d calm = launch(""), blown = launch(R"("gusts": [{"velocity": [0, 0, 8], "front": 200, "lasting": true}])");
  EXPECT_NEAR(calm.z, 0, .05);
  EXPECT_LT(blown.z, -2) << "it turns into the wind";
  EXPECT_NEAR(blown.z, launch(R"("velocity": [0, 0, 8])").z, .05) << "as into a steady one";
}

// The frame's turning acts on a rocket once.
TEST(OneEnvironment, RocketsFeelTheTurningOnce) {
  SceneWorld world = start(
      R"({"step": "1/240 s", "gravity": [0, -9.80665, 0], "environment": {"air": {"vacuum": true}, "frame": {"latitude": "0 deg"}}, "rockets": [{"name": "r",
      "diameter": "1 m", "length": "8 m", "drag_coefficient": 0, "stages": [{"dry_mass": 1000,
        "motor": {"mass": 10, "propellant_mass": 0, "thrust": [0, 0, 0.01, 400e3, 1, 400e3, 1.01, 0]}}]}]})");
  run(world, 240 * 9);
  // Straight up at some 395 m/s less what gravity takes: Coriolis' 2 Ω v to the west, by closed form from the burnout.
  const rigid::BodyState<rigid::Dim3> state = *world.world3->state(world.find_body("r")->id);
  const Vec3d rate = around(world).definition().frame.rate;
  const Vec3d aside = math::cross(-2.0 * rate, Vec3d{0, state.center_of_mass.y - 4, 0});  // ∫ 2 Ω v dt = 2 Ω h
  EXPECT_NEAR(state.linear_velocity.x, aside.x, .05 * math::length(aside));
  EXPECT_NEAR(state.linear_velocity.z, aside.z, .05 * math::length(aside));
  EXPECT_GT(math::length(aside), .1);
}

// Fog takes on the wind of its own height.
TEST(OneEnvironment, ParticlesFeelLayers) {
  SceneWorld world =
      start(std::string(R"({"gravity": [0, 0, 0], "environment": {"ground": "30 m", "wind": {)") + winds[0] +
            R"(}}, "particles": [{"name": "low", "radius": "5 um", "density": "1000 kg/m^3",
        "emitters": [{"burst": 10, "position": [0, 40, 0], "speed": 0, "lifetime": "10 s"}]},
      {"name": "high", "radius": "5 um", "density": "1000 kg/m^3",
        "emitters": [{"burst": 10, "position": [0, 120, 0], "speed": 0, "lifetime": "10 s"}]}]})");
  const auto place = [&](const char* of) {
    return Vec3d{scene::test::read(world, std::string("particles.") + of + ".center.x"), 0,
                 scene::test::read(world, std::string("particles.") + of + ".center.z")};
  };
  run(world, 30);
  const Vec3d low = place("low"), high = place("high");
  run(world, 60);
  EXPECT_LT(math::length(place("low") - low - Vec3d{1, 0, 8.5}), .05) << "half way between two layers";
  EXPECT_LT(math::length(place("high") - high - Vec3d{-4, 0, -9}), .05);
}

// Smoke in the middle of a gust that stands still goes with its peak.
TEST(OneEnvironment, ParticlesFeelGusts) {
  SceneWorld world = start(R"({"gravity": [0, 0, 0], "environment": {"wind": {"velocity": [1, 0, 0],
      "gusts": [{"velocity": [0, 0, 4], "front": "100 m", "gradient_distance": "100 m"}]}},
      "particles": [{"name": "smoke", "radius": "5 um", "density": "1000 kg/m^3",
        "emitters": [{"burst": 10, "position": [0, 40, 0], "speed": 0, "lifetime": "10 s"}]}]})");
  const auto along = [&](const char* axis) {
    return scene::test::read(world, std::string("particles.smoke.center.") + axis);
  };
  run(world, 30);
  const double x = along("x"), z = along("z");
  run(world, 60);
  EXPECT_NEAR((along("z") - z) / (along("x") - x), 4, .01);
}

// Of two halves of one cloth, and of two ropes, one is in a gust and one is not.
TEST(OneEnvironment, ClothAndRopesFeelTheGustWhereTheyAre) {
  SceneWorld world = start(R"({"gravity": [0, 0, 0], "environment": {"wind": {"velocity": [0, 0, 0],
      "gusts": [{"velocity": [0, 0, 6], "front": "0 m", "gradient_distance": "2 m"}]}},
      "ropes": [{"name": "in", "points": [[-2, 1, 0], [-2, 2, 0]], "segments": 5},
                {"name": "out", "points": [[2, 1, 0], [2, 2, 0]], "segments": 5}],
      "cloths": [{"name": "c", "corner": [-2, 3, 0], "along": [4, 0, 0], "across": [0, 1, 0], "columns": 33,
                  "rows": 9, "mass_per_area": "100 g/m^2"}]})");
  run(world, 6);
  const auto z = [&](int rope) { return world.matter->rope_set.positions(rope)[2].z; };
  EXPECT_GT(z(0), 1e-3);
  EXPECT_LT(math::abs(z(1)), 1e-2 * z(0));
  const auto places = world.matter->cloths[0].thing.positions();
  EXPECT_GT(places[4].z, .05);
  EXPECT_LT(math::abs(places[28].z), 1e-3);
}

}  // namespace scene_one_environment_test
