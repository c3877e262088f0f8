// Rockets of scene files: they fly as the model alone does, drop their stages, come down, and errors name the place.
#include <gtest/gtest.h>

#include <algorithm>

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/scene/destruction.h"
#include "carom/scene/rocket_presets.h"
#include "carom/scene/scene.h"
#include "carom/scene/write_scene.h"
#include "tests/scene/scene_world.h"
#include "tests/scene/source_file.h"

namespace rocket_scene_test {
using namespace carom;
using scene::Scene;
using scene::SceneWorld;
using scene::test::read;
using scene::test::read_source;

SceneWorld start(const std::string& keys) {
  return scene::test::started(scene::parse_scene("{\"dimension\": 3, " + keys + "}", "s.json", read_source));
}

struct Case {
  const char* preset;
  double tilt, wind;  // rad, m/s
};

// C_D by Mach number, written out or as a file of presets/drag: a rocket with little drag rises higher.
TEST(RocketScene, DragTables) {
  const auto apex = [](const std::string& drag) {
    SceneWorld world = start(R"("step": "1/60 s", "rockets": [{"name": "alpha", "preset": "rocket/two_stage_c6", )" +
                             drag + R"("position": [0, 0, 0]}])");
    if (world.world3 == nullptr) return 0.0;
    for (int i = 0; i < 60 * 14; ++i) EXPECT_TRUE(world.step().ok());
    return read(world, "rocket.alpha.apex");
  };
  const double plain = apex("");
  EXPECT_NEAR(apex(R"("coasting_drag_table": [0, 0.55, 3, 0.55], )"), plain, 1e-3 * plain);
  EXPECT_GT(apex(R"("coasting_drag_table": "308_168_smk", )"), 1.2 * plain);
  const auto error = [](const std::string& drag) {
    const auto scene = scene::parse_scene(R"({"rockets": [{"name": "a", "diameter": 0.1, "length": 1, )" + drag +
                                              R"(, "stages": [{"dry_mass": 1, "motor": "black_powder"}]}]})",
                                          "s.json", read_source);
    return scene.ok() ? std::string("none") : scene.error().message;
  };
  EXPECT_NE(error(R"("drag_table": [0, 1], "drag_coefficient": 1)").find("rockets[0].drag_table"), std::string::npos);
  EXPECT_NE(error(R"("drag_table": [0, 1, 2])").find("pairs of Mach number"), std::string::npos);
  EXPECT_NE(error(R"("drag_table": [1, 1, 0, 2])").find("rockets[0].drag_table"), std::string::npos);
}

TEST(RocketScene, BodyOfAWorldFliesAsTheModelAlone) {
  for (const Case& c : {Case{"two_stage_c6", 0, 0}, Case{"two_stage_c6", .1, 4}, Case{"payload_d12", .15, 3}}) {
    const std::string path = std::string("presets/rocket/") + c.preset + ".json";
    const auto rocket = scene::parse_rocket(read_source(path).value(), path, read_source);
    ASSERT_TRUE(rocket) << rocket.error().message;
    ballistics::Conditions conditions;
    conditions.wind = environment::WindColumn({c.wind, 0, 0});
    const ballistics::Launch launch{.direction = {-math::sin(c.tilt), math::cos(c.tilt), 0}, .rail_length = 1.2};
    const auto alone = ballistics::fly_rocket(*rocket, conditions, launch, ballistics::RocketModel::six_degrees,
                                              {.time = 600, .ground = 0});
    ASSERT_TRUE(alone) << alone.error().message;
    SceneWorld world = start(core::text(R"("step": "1/120 s", "environment": {"wind": {"velocity": [)", c.wind,
                                        R"(, 0, 0]}}, "rockets": [{"name": "alpha", "preset": "rocket/)", c.preset,
                                        R"(", "rail_length": 1.2, "start": "0.5 s",
        "position": [0, 0, 0], "direction": [)",
                                        launch.direction.x, ", ", launch.direction.y, ", 0]}]"));
    ASSERT_NE(world.world3, nullptr);
    const rigid::BodyId body = world.find_body("alpha")->id;
    const math::Vec3d first = world.world3->state(body)->center_of_mass;
    const ballistics::RocketMoment* const apex = alone->first(ballistics::RocketEvent::apex);
    const auto burnout = std::find_if(alone->events.rbegin(), alone->events.rend(),
                                      [](const auto& m) { return m.event == ballistics::RocketEvent::burnout; });
    ASSERT_TRUE(apex != nullptr && burnout != alone->events.rend());
    double highest = 0, apex_time = 0, fastest = 0;
    while (world.time() < .5 + apex->time + 5) {
      ASSERT_TRUE(world.step().ok());
      const auto state = world.world3->state(body).value();
      if (state.center_of_mass.y - first.y > highest)
        highest = state.center_of_mass.y - first.y, apex_time = world.time() - .5;
      fastest = math::max(fastest, double(length(state.linear_velocity)));
      if (math::abs(world.time() - .5 - burnout->time) < .5 / 120) {
        EXPECT_LT(distance(math::Vec3d(state.linear_velocity), burnout->velocity), .02 * length(burnout->velocity))
            << c.preset;
        // The centre of mass also moves within the rocket as it burns.
        EXPECT_LT(distance(state.center_of_mass - first, burnout->position), .01 * length(burnout->position) + .3);
      }
    }
    double fastest_alone = 0;
    for (const auto& node : alone->path.nodes()) fastest_alone = math::max(fastest_alone, length(node.velocity));
    EXPECT_NEAR(fastest, fastest_alone, .01 * fastest_alone) << c.preset;
    EXPECT_NEAR(highest, apex->position.y, .01 * apex->position.y) << c.preset << ", wind " << c.wind;
    EXPECT_NEAR(read(world, "rocket.alpha.apex"), highest, .05);
    EXPECT_NEAR(apex_time, apex->time, .02 * apex->time) << c.preset;
    EXPECT_EQ(read(world, "rocket.alpha.parachute"), 1);
    EXPECT_EQ(read(world, "rocket.alpha.stages"), 1);
    EXPECT_EQ(read(world, "rocket.alpha.thrust"), 0);
    EXPECT_NEAR(read(world, "rocket.alpha.mass"), alone->masses.back(), 1e-9);
    // It sinks as the parachute lets it, nose up.
    const auto state = world.world3->state(body).value();
    const double density = conditions.air.at(state.center_of_mass.y).density;
    const double sinks = math::sqrt(2 * alone->masses.back() * 9.80665 / (density * rocket->parachute.drag_area));
    EXPECT_NEAR(-state.linear_velocity.y, sinks, .02 * sinks) << c.preset;
    EXPECT_NEAR(state.linear_velocity.x, c.wind, .05 * sinks);
    EXPECT_GT(rotate(state.pose.rotation, math::Vec3f{1, 0, 0}).y, .9f);
  }
}

TEST(RocketScene, StaysOnItsRailUntilItBurnsAndDropsItsStage) {
  SceneWorld world = start(
      R"("rockets": [{"name": "alpha", "preset": "rocket/two_stage_c6", "start": "1 s", "position": [0, 2, 0]}])");
  ASSERT_NE(world.world3, nullptr);
  const rigid::BodyId body = world.find_body("alpha")->id;
  const ballistics::BodyRocket& rocket = world.destruction->space.rockets[0].thing;
  const math::Vec3d place = world.world3->state(body)->pose.position;
  while (world.time() < .99) ASSERT_TRUE(world.step().ok());
  EXPECT_LT(distance(world.world3->state(body)->pose.position, place), 1e-4) << "the rail holds it";
  math::Vec3d momentum{};
  double mass = 0;
  while (rocket.dropped().empty() && world.time() < 10) {
    const auto state = world.world3->state(body).value();
    mass = state.mass;
    momentum = mass * math::Vec3d(state.linear_velocity);
    ASSERT_TRUE(world.step().ok());
  }
  ASSERT_EQ(rocket.dropped().size(), 1u);
  const rigid::BodyId booster = rocket.dropped()[0];
  // In a step of coasting both parts have lost what gravity and drag take.
  const auto upper = world.world3->state(body).value(), lower = world.world3->state(booster).value();
  EXPECT_NEAR(upper.mass + lower.mass, mass, 1e-6);
  EXPECT_NEAR(lower.mass, .025 + .0241 - .0108, .004) << "the casing and the booster";
  const math::Vec3d after =
      double(upper.mass) * math::Vec3d(upper.linear_velocity) + double(lower.mass) * math::Vec3d(lower.linear_velocity);
  EXPECT_LT(distance(after, momentum), .05 * length(momentum));
  EXPECT_EQ(read(world, "rocket.alpha.stages"), 1);
  while (world.time() < 8) ASSERT_TRUE(world.step().ok());
  EXPECT_LT(world.world3->state(booster)->center_of_mass.y, world.world3->state(body)->center_of_mass.y - 50);
  EXPECT_FALSE(scene::write_scene(world).ok()) << "rockets are not written";
}

TEST(RocketScene, SameBitsOnAnyNumberOfThreads) {
  std::uint64_t hash[2] = {};
  const auto scene = scene::load_scene(std::string(CAROM_SOURCE_DIR) + "/scenes/model_rocket.json");
  ASSERT_TRUE(scene) << scene.error().message;
  for (int k = 0; k < 2; ++k) {
    auto world = scene->instantiate({}, {.threads = k == 0 ? 1 : 3});
    ASSERT_TRUE(world) << world.error().message;
    for (int i = 0; i < 600; ++i) ASSERT_TRUE(world->step().ok());
    hash[k] = world->state_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(RocketScene, ErrorsNameThePlace) {
  const auto message = [](const std::string& rocket, int dimension = 3) {
    const auto s = scene::parse_scene(core::text("{\"dimension\": ", dimension, ", \"rockets\": [{", rocket, "}]}"),
                                      "s.json", read_source);
    return s.ok() ? std::string("none") : s.error().message;
  };
  const auto says = [](const std::string& found, const std::string& part) {
    EXPECT_TRUE(found.starts_with("s.json:1: ")) << found;
    EXPECT_NE(found.find(part), std::string::npos) << found;
  };
  const std::string size = R"("diameter": "25 mm", "length": "1 m", )";
  const std::string motor = R"({"mass": "20 g", "propellant_mass": "10 g", "thrust": [0, 0, 0.1, 10, 1, 0]})";
  EXPECT_EQ(message(size + R"("stages": [{"dry_mass": "50 g", "motor": )" + motor + "}]"), "none");
  says(message(R"("length": "1 m", "stages": [])"), "the key \"diameter\" is missing");
  says(message(size + R"("stages": [])"), "a list of 1 to 10 stages");
  says(message(size + R"("wings": 2, "stages": [])"), "wings");
  says(message(size + R"("fin_count": 99, "stages": [])"), "rockets[0].fin_count");
  says(message(R"("diameter": "-1 m", "length": "1 m", "stages": [])"), "a number above zero");
  says(message(R"("diameter": "3 kg", "length": "1 m", "stages": [])"), "rockets[0].diameter");
  says(message(size + R"("stages": [{"dry_mass": "1 kg"}])"), "motor");
  says(message(size + R"("stages": [{"dry_mass": "1 kg", "motor": "no_such"}])"), "presets/motor/no_such.eng");
  says(message(size + R"("stages": [{"dry_mass": "1 kg", "motor": "../x"}])"), "the name of a file of presets/motor");
  says(message(size + R"("stages": [{"dry_mass": "1 kg", "motor": "black_powder", "designation": "Z9"}])"),
       "expected one of presets/motor/black_powder.eng");
  says(message(size + R"("stages": [{"dry_mass": "1 kg", "motor": {"mass": 1, "thrust": [0, 1, 2]}}])"),
       "pairs of time");
  says(message(size + R"("stages": [{"dry_mass": "1 kg", "motor": {"mass": 1, "thrust": [1, 1, 0, 2]}}])"),
       "stages[0].motor.thrust");
  says(message(size +
               R"("stages": [{"dry_mass": "1 kg", "motor": {"mass": 1, "propellant_mass": 2, "thrust": [0, 1]}}])"),
       "no more than the motor's mass");
  says(message(size +
               R"("fin_count": 3, "fin_root_chord": 0, "fin_tip_chord": 0, "stages": [{"dry_mass": 1, "motor": )" +
               motor + "}]"),
       "no chord");
  says(message(size + R"("stages": [{"dry_mass": 1, "dry_centre": "2 m", "motor": )" + motor + "}]"), "centre of mass");
  says(message(size + R"("direction": [0, 0, 0], "stages": [{"dry_mass": 1, "motor": )" + motor + "}]"), "direction");
  says(message(size + R"("stages": [{"dry_mass": 1, "motor": )" + motor + "}]", 2), "rockets");
}

}  // namespace rocket_scene_test
