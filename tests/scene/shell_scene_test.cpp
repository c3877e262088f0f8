// Spinning shells of scene files, and guns whose rounds spin: they fly as the model alone does, meet what is in their
// way, and errors name the place.
#include <gtest/gtest.h>

#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/scene/destruction.h"
#include "carom/scene/scene.h"
#include "carom/scene/write_scene.h"
#include "tests/scene/scene_world.h"
#include "tests/scene/source_file.h"

namespace shell_scene_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;
using scene::SceneWorld;
using scene::test::read;
using scene::test::read_source;

SceneWorld start(const std::string& keys) {
  return scene::test::started(scene::parse_scene("{\"dimension\": 3, " + keys + "}", "s.json", read_source));
}
void run(SceneWorld& world, double until) {
  while (world.time() < until - 1e-6) ASSERT_TRUE(world.step().ok());
}
constexpr const char* howitzer = R"("environment": {"frame": {"latitude": "50 deg"}, "wind": {"velocity": [2, 0, 5]}},
  "gravity": [0, -9.80665, 0])";

/// The flight of fly_shell in what is around the scene, and the turning that the frame of the scene has.
Trajectory::Point alone(const SceneWorld& world, double twist, ShellModel model, double time, bool turning = true) {
  Shell shell = m107();
  shell.twist = twist;
  const environment::Environment& around = *scene::environment_of(*world.world3, world.environment);
  Conditions conditions{.wind = environment::WindColumn({2, 0, 5})};
  if (turning) conditions.rotation = around.definition().frame.rate;
  return fly_shell(shell, conditions, {{0, 100, 0}, 474 * direction(0.3)}, model, {.time = time})->path.end();
}

// Wind and the turning of the Earth come from the environment, once.
TEST(ShellScene, FliesAsTheModelAlone) {
  for (const double twist : {20.0, -20.0})
    for (const ShellModel model : {ShellModel::modified_point_mass, ShellModel::six_degrees}) {
      SceneWorld world =
          start(core::text(howitzer, R"(, "shells": [{"name": "a", "shell": {"preset": "shell/155mm_m107",
          "twist": )",
                           twist, R"(}, "position": [0, 100, 0], "speed": "474 m/s", "direction": [)", math::cos(0.3),
                           ", ", math::sin(0.3), R"(, 0], "model": ")",
                           model == ShellModel::six_degrees ? "six_degrees" : "modified_point_mass", R"("}])"));
      ASSERT_NE(world.world3, nullptr);
      run(world, 15);
      const Vec3d there = world.world3->state(world.find_body("a")->id)->center_of_mass;
      const Vec3d expected = alone(world, twist, model, 15).position;
      EXPECT_LT(distance(there, expected), 0.002) << twist;
      EXPECT_GT(distance(there, alone(world, twist, model, 15, false).position), 1) << "the Earth's turning counts";
      EXPECT_NEAR(read(world, "a.position.z"), there.z, 1e-9);
      EXPECT_NEAR(read(world, "shell.a.spin"), (twist > 0 ? 1 : -1) * 900, 60);
      EXPECT_GT(read(world, "shell.a.stability"), 1);
      EXPECT_GT(read(world, "shell.a.yaw"), 1e-4);
      EXPECT_EQ(read(world, "shell.a.flying"), 1);
      EXPECT_FALSE(scene::write_scene(world).ok()) << "shells are not written";
    }
}

// The rounds of a gun drift as the modified point mass does, until they hit: then they are point masses.
TEST(ShellScene, RoundsOfAGunSpin) {
  const auto fire = [](const char* ammunition, const char* more) {
    return start(core::text(R"("gravity": [0, -9.80665, 0], "environment": {"wind": {"velocity": [2, 0, 5]}},
      "guns": [{"name": "g", "position": [0, 100, 0], "direction": [)",
                            math::cos(0.3), ", ", math::sin(0.3), R"(, 0], "ammunition": {"preset": "ammunition/)",
                            ammunition, R"(", "speed_deviation": 0})", more, "}]"));
  };
  const auto shot = [](const SceneWorld& world) { return world.destruction->space.guns[0].thing.batch.at(0).position; };
  SceneWorld spins = fire("155mm_m107_charge_6_spinning", ""),
             left = fire("155mm_m107_charge_6_spinning", R"(, "twist": "-3.1 m")"),
             point = fire("155mm_m107_charge_6", "");
  for (SceneWorld* world : {&spins, &left, &point}) run(*world, 15);
  const Vec3d right = alone(spins, 20, ShellModel::modified_point_mass, 15, false).position;
  EXPECT_LT(distance(shot(spins), right), 0.01);
  EXPECT_LT(distance(shot(left), alone(spins, -20, ShellModel::modified_point_mass, 15, false).position), 0.01);
  EXPECT_NEAR(shot(point).z, 0.5 * (shot(spins).z + shot(left).z), 0.5);
  EXPECT_GT(shot(spins).z - shot(point).z, 20);
  EXPECT_EQ(spins.destruction->space.guns[0].thing.spinning->size(), 1u);
  EXPECT_FALSE(point.destruction->space.guns[0].thing.spinning.has_value());
  // Through a board.
  SceneWorld board = start(
      R"("guns": [{"name": "g", "ammunition": {"preset": "ammunition/155mm_m107_charge_6_spinning"}, "rounds": 2, "rounds_per_minute": 100}],
      "bodies": [{"name": "board", "type": "fixed", "position": [100, 0, 0], "shape": {"type": "box", "size": [0.04, 20, 20]}}],
      "penetration": [{"wall": "timber"}])");
  run(board, 2);
  EXPECT_EQ(read(board, "gun.g.passed"), 2);
  EXPECT_EQ(read(board, "gun.g.in_flight"), 2);
  EXPECT_EQ(board.destruction->space.guns[0].thing.spinning->size(), 0u) << "what went through a wall tumbles";
  // Of the plane they cannot drift.
  const auto plane =
      scene::parse_scene(R"({"dimension": 2, "guns": [{"name": "g", "ammunition": "155mm_m107_charge_6_spinning"}]})",
                         "s.json", read_source);
  SceneWorld flat = scene::test::started(plane);
  run(flat, 1);
  EXPECT_EQ(read(flat, "gun.g.in_flight"), 1);
}

// The sight beside the bore, and the eye beside the axis of the sight.
TEST(ShellScene, SightsBesideTheBoreAndParallax) {
  const auto side = [](const char* sight, const char* more) {
    SceneWorld world =
        start(core::text(R"("step": "1/240 s", "bodies": [{"name": "paper", "type": "fixed", "position": [200.5, 0, 0],
        "shape": {"type": "box", "size": [1, 5, 5]}}], "guns": [{"name": "g", "sighted": true, "zero": "100 m",
        "ammunition": {"preset": "ammunition/308_168_smk", "speed_deviation": 0}, "sight": )",
                         sight, more, "}]"));
    run(world, 1);
    return Vec3d{0, read(world, "gun.g.last_hit.y"), read(world, "gun.g.last_hit.z")};
  };
  const Vec3d plain = side(R"({"height": 0.04})", "");
  EXPECT_NEAR(plain.z, 0, 1e-4);
  EXPECT_NEAR(side(R"({"height": 0.04, "offset": "5 cm"})", "").z, 0.10, 1e-3) << "from the muzzle: 5 cm at the zero";
  const char* scope = R"({"height": 0.04, "magnification": 10, "parallax_free": "50 m"})";
  // The mark is at the zero, 100 m: −M e (1 − R/D₀) there, twice as much at 200 m.
  EXPECT_NEAR(side(scope, R"(, "eye_right": "1 mm")").z - plain.z, 0.02, 1e-3);
  EXPECT_NEAR(side(scope, R"(, "eye_up": "1 mm")").y - plain.y, 0.02, 1e-3);
  const auto wrong = scene::parse_scene(R"({"guns": [{"name": "g", "ammunition": "308_168_smk", "eye_up": 0.001}]})",
                                        "s.json", read_source);
  EXPECT_NE(wrong.error().message.find("eye_up"), std::string::npos);
}

TEST(ShellScene, SameBitsOnAnyNumberOfThreads) {
  std::uint64_t hash[2] = {};
  const auto scene = scene::load_scene(std::string(CAROM_SOURCE_DIR) + "/scenes/artillery_drift.json");
  ASSERT_TRUE(scene) << scene.error().message;
  for (int k = 0; k < 2; ++k) {
    auto world = scene->instantiate({}, {.threads = k == 0 ? 1 : 3});
    ASSERT_TRUE(world) << world.error().message;
    for (int i = 0; i < 600; ++i) ASSERT_TRUE(world->step().ok());
    hash[k] = world->state_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(ShellScene, ErrorsNameThePlace) {
  const auto message = [](const std::string& shell, int dimension = 3) {
    const auto s = scene::parse_scene(core::text("{\"dimension\": ", dimension, ", \"shells\": [{", shell, "}]}"),
                                      "s.json", read_source);
    return s.ok() ? std::string("none") : s.error().message;
  };
  const auto says = [](const std::string& found, const std::string& part) {
    EXPECT_TRUE(found.starts_with("s.json:1: ")) << found;
    EXPECT_NE(found.find(part), std::string::npos) << found;
  };
  const std::string preset = R"("shell": "155mm_m107", )";
  EXPECT_EQ(message(preset + R"("speed": "300 m/s")"), "none");
  says(message(preset + R"("direction": [1, 0, 0])"), "speed");
  says(message(R"("speed": 300)"), "shell");
  says(message(preset + R"("speed": 0)"), "shells[0].speed");
  says(message(preset + R"("speed": "3 kg")"), "shells[0].speed");
  says(message(preset + R"("speed": 300, "direction": [0, 0, 0])"), "shells[0].direction");
  says(message(preset + R"("speed": 300, "wings": 2)"), "wings");
  says(message(preset + R"("speed": 300, "start": "-1 s")"), "fired_at");
  says(message(preset + R"("speed": 300, "model": "point")"), "six_degrees");
  says(message(preset + R"("speed": 300)", 2), "shells");
  EXPECT_NE(message(R"("speed": 300, "shell": "no_such")").find("presets/shell/no_such.json"), std::string::npos);
  says(message(R"("speed": 300, "shell": {"mass": 4})"), "the key \"diameter\" is missing");
  const std::string numbers = R"("mass": 4, "diameter": 0.1, "axial_inertia": 0.01, "transverse_inertia": 0.1)";
  says(message(R"("speed": 300, "shell": {)" + numbers + "}"), "a list of 1 to 200 rows");
  says(message(R"("speed": 300, "shell": {)" + numbers + R"(, "aerodynamics": [{"mach": 0}]})"), "row 1: overturning");
  says(message(R"("speed": 300, "shell": {)" + numbers + R"(, "aerodynamics": [{"drag": 0}]})"), "drag");
}

}  // namespace shell_scene_test
