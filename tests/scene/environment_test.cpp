// The key "environment" of a scene, and the effectors that go with it.
#include <gtest/gtest.h>

#include "carom/environment/environment.h"
#include "carom/math/random.h"
#include "carom/scene/scene.h"
#include "carom/scene/write_scene.h"

namespace environment_scene_test {
using namespace carom;
using namespace carom::scene;
using environment::Environment;

Result<SceneWorld> start(std::string_view text) {
  const Result<Scene> scene = parse_scene(text, "scenes/sea.json", {});
  if (!scene) return scene.error();
  return scene->instantiate();
}
std::string error_of(std::string_view text) {
  const Result<SceneWorld> world = start(text);
  return world ? "accepted" : world.error().message;
}
const Environment& around(const SceneWorld& world) {
  const auto definition = world.world3->effector_definition(world.environment).value();
  return *std::get<rigid::Surroundings<rigid::Dim3>>(definition).environment;
}

constexpr const char* everything = R"({"name": "all", "environment": {
  "gravity": {"kind": "oblate", "axis": [0, 0, 2], "center": [0, -6378, 0]},
  "frame": {"latitude": "45 deg", "bearing": "0 deg"},
  "air": {"temperature_offset": "15 K", "sea_level_pressure": "1000 hPa", "humidity": 0.5, "altitude": "500 m"},
  "wind": {"velocity": ["10 kn", 0, 0], "profile": "logarithmic", "roughness_length": "3 cm",
    "turbulence": {"spectrum": "dryden", "height": "50 m", "wind_at_20_feet": "15 kn", "shells": 8, "seed": 7},
    "gusts": [{"velocity": [0, "9 m/s", 0], "direction": [-3, 0, 0], "gradient_distance": "30 m"}],
    "thermals": [{"base": [100, 0, 0], "strength": "3 m/s"}],
    "obstacles": [{"center": [0, 5, 0], "area": "100 m^2"}],
    "wakes": [{"point": [0, 100, 0], "circulation": "300 m^2/s"}]},
  "water": {"spectrum": "jonswap", "significant_height": "2 m", "peak_period": "8 s", "direction": "30 deg", "components": 12,
    "current": [0.5, 0, 0], "depth": "40 m", "seed": 3},
  "ground": "2 m"}})";

TEST(SceneEnvironment, HoldsEverything) {
  const Result<SceneWorld> world = start(everything);
  ASSERT_TRUE(world.ok()) << world.error().message;
  const Environment& here = around(*world);
  const Environment::Definition& d = here.definition();
  EXPECT_EQ(d.gravity.kind, environment::GravityField::Kind::oblate);
  EXPECT_EQ(d.gravity.axis, (math::Vec3d{0, 0, 1}));
  EXPECT_NEAR(math::length(d.frame.rate), 7.292115e-5, 1e-12);
  EXPECT_NEAR(here.air({0, 0, 0}).temperature, 288.15 + 15 - 3.25, 0.01);
  EXPECT_NEAR(d.wind.mean.velocity.x, 5.14444, 1e-4);
  EXPECT_EQ(d.wind.gusts.at(0).direction, (math::Vec3d{-1, 0, 0}));
  EXPECT_EQ(d.wind.turbulence.modes().size(), 48u);
  EXPECT_NEAR(d.wind.turbulence.definition().mean_wind.x, d.wind.mean_at(50).x, 1e-12);
  ASSERT_NE(here.water(), nullptr);
  EXPECT_NEAR(here.water()->significant_height(), 2, 1e-9);
  EXPECT_EQ(here.water()->components().size(), 12u);
  EXPECT_EQ(here.ground(3, 4), 2);
}

// What is written reads back as the same: same water, same gusts, same text.
TEST(SceneEnvironment, ComesBackTheSame) {
  const Result<SceneWorld> world = start(everything);
  ASSERT_TRUE(world.ok());
  const Result<std::string> written = write_scene(*world);
  ASSERT_TRUE(written.ok());
  const Result<SceneWorld> again = start(*written);
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(write_scene(*again).value(), *written);
  const Environment &a = around(*world), &b = around(*again);
  for (const math::Vec3d p : {math::Vec3d{1, 5, 2}, math::Vec3d{100, 400, -30}, math::Vec3d{-40, 99, 12}}) {
    EXPECT_EQ(a.wind(p, 3.7), b.wind(p, 3.7));
    EXPECT_EQ(a.gravity(p), b.gravity(p));
    EXPECT_EQ(a.air(p).density, b.air(p).density);
    EXPECT_EQ(a.water()->height(p.x, p.z, 9.1), b.water()->height(p.x, p.z, 9.1));
  }
  // In the plane too.
  const Result<SceneWorld> plane =
      start(R"({"dimension": 2, "environment": {"frame": {"rate": "1 rad/s", "centrifugal": true},
    "wind": {"velocity": [3, 0], "turbulence": {"strength": 1, "size": 20}}, "water": {"waves": [{"height": 1, "period": 6}]}},
    "bodies": [{"name": "b", "shape": {"type": "circle"}}],
    "effectors": [{"type": "electromagnetic_field", "charge": 2, "electric": [1, 0], "magnetic": 0.3},
                  {"type": "turning_frame", "angular_velocity": 0.2}, {"type": "magnus_lift", "ball": "tennis_ball"},
                  {"type": "body_drag", "law": "cylinder"},
                  {"type": "lifting_surface", "body": "b", "point": [0.2, 0]}, {"type": "cylinder_drag", "body": "b"}, {"type": "buoyancy", "added_mass": [0, 1], "added_inertia": 0.1}]})");
  ASSERT_TRUE(plane.ok()) << plane.error().message;
  const std::string text = write_scene(*plane).value();
  const Result<SceneWorld> flat = start(text);
  ASSERT_TRUE(flat.ok()) << flat.error().message;
  EXPECT_EQ(write_scene(*flat).value(), text);
}

TEST(SceneEnvironment, EffectorsComeBackTheSame) {
  const Result<SceneWorld> world = start(R"({"bodies": [{"name": "a", "shape": {"type": "sphere"}}], "effectors": [
    {"type": "body_drag", "body": "a", "law": "by_mach", "table": [0, 0.2, "=0.8", 0.3, 1.2, 0.7], "diameter": "7.82 mm"},
    {"type": "body_drag", "law": "by_reynolds", "table": [1, 30, 1000, 0.4], "logarithmic": true, "area": "2 m^2"},
    {"type": "magnus_lift", "ball": "baseball", "radius": "36.6 mm"},
    {"type": "turning_frame", "latitude": "48 deg"},
    {"type": "lifting_surface", "body": "a", "aspect_ratio": 8, "stall_angle": "14 deg", "area": "2 m^2", "chord": "0.5 m", "forward": [0, 0, 1], "up": [0, 1, 0]},
    {"type": "cylinder_drag", "body": "a", "axis": [0, 1, 0], "diameter": "3 cm", "length": "2 m"},
    {"type": "electromagnetic_field", "body": "a", "charge": "2 mC", "electric": ["100 V/m", 0, 0], "magnetic": [0, 0, "0.5 T"]},
    {"type": "buoyancy", "added_mass": [0.5, 0.5, 0.5], "added_inertia": [0, 0.1, 0.1]}]})");
  ASSERT_TRUE(world.ok()) << world.error().message;
  const auto drag =
      std::get<rigid::BodyDrag<rigid::Dim3>>(world->world3->effector_definition(world->effectors[0].id).value());
  ASSERT_EQ(drag.law.table.points().size(), 3u);
  EXPECT_EQ(drag.law.table.points()[1].x, 0.8);
  EXPECT_NEAR(drag.area, math::pi / 4 * 7.82e-3 * 7.82e-3, 1e-15);
  const Result<std::string> written = write_scene(*world);
  ASSERT_TRUE(written.ok());
  const Result<SceneWorld> again = start(*written);
  ASSERT_TRUE(again.ok()) << again.error().message;
  EXPECT_EQ(write_scene(*again).value(), *written);
}

// A force by formulas: the oscillator of k = 8 N/m and 2 kg comes back after π s; an acceleration acts on any mass;
// time and parameters count.
TEST(SceneForceField, ActsByItsFormulas) {
  const Result<Scene> scene = parse_scene(
      R"j({"parameters": {"k": {"value": "8 N/m", "minimum": "1 N/m", "maximum": "9 N/m"}, "w": {"value": "2 rad/s", "minimum": "1 rad/s", "maximum": "3 rad/s"}}, "gravity": [0, 0, 0], "step": "1/240 s",
    "bodies": [{"name": "a", "mass": "2 kg", "position": [1, 0, 0], "shape": {"type": "sphere", "radius": 0.1}},
               {"name": "b", "mass": "5 kg", "position": [0, 9, 0], "shape": {"type": "sphere", "radius": 0.1}},
               {"name": "c", "mass": "3 kg", "position": [0, 0, 9], "velocity": ["4 m/s", 0, 0], "shape": {"type": "sphere", "radius": 0.1}}],
    "effectors": [{"type": "force_field", "body": "a", "formula": ["-k*x", "0 N", 0]},
                  {"type": "force_field", "body": "b", "formula": ["0 N", "=-9.81 m/s^2", "3 m/s^2*sin(w*t)"]},
                  {"type": "force_field", "body": "c", "formula": ["-m*vx*0.5 Hz", "0 N", "0 N"]}]})j",
      "s", {});
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  SceneWorld world = scene->instantiate().value();
  const int steps = 754;
  for (int i = 0; i < steps; ++i) world.world3->step(1.0f / 240).value();
  const double t = steps / 240.0;  // within 1 ms of π
  const auto at = [&](int i) { return world.world3->state(world.bodies[std::size_t(i)].id).value(); };
  EXPECT_NEAR(at(0).pose.position.x, 1, 1e-3);
  EXPECT_NEAR(at(0).pose.position.y, 0, 1e-6);
  EXPECT_NEAR(at(1).pose.position.y, 9 - 0.5 * 9.81 * t * t, 2e-3);
  EXPECT_NEAR(at(1).linear_velocity.z, 1.5 * (1 - math::cos(2 * t)), 2e-3);
  EXPECT_NEAR(at(2).linear_velocity.x, 4 * math::exp(-0.5 * t), 4e-3);
  // Where a formula has no value there is no force.
  const Result<SceneWorld> hole =
      start(R"({"dimension": 2, "gravity": [0, 0], "bodies": [{"name": "a", "shape": {"type": "circle"}}],
    "effectors": [{"type": "force_field", "formula": ["1 N*m/x", 0]}]})");
  ASSERT_TRUE(hole.ok()) << hole.error().message;
  hole->world2->step(1.0f / 60).value();
  EXPECT_EQ(hole->world2->state(hole->bodies[0].id)->linear_velocity.x, 0);
  EXPECT_TRUE(hole->world2->events().quarantined.empty());
}

TEST(SceneForceField, ErrorsNameThePlace) {
  const auto message = [](const std::string& formula) {
    const auto world = start(R"({"effectors": [{"type": "force_field", "formula": )" + formula + "}]}");
    return world.ok() ? std::string() : world.error().message;
  };
  EXPECT_EQ(message(R"(["1 N", "2 N", "m*9.81 m/s^2"])"), "");
  EXPECT_NE(message(R"(["1 N", "2 N"])").find("three formulas"), std::string::npos);
  EXPECT_NE(message(R"(["1 N", "2 m", "0 N"])").find("effectors[0].formula[1]"), std::string::npos);
  EXPECT_NE(message(R"(["1 N", "2 m", "0 N"])").find("expected a force or an acceleration"), std::string::npos);
  EXPECT_NE(message(R"(["vq*1 N", 0, 0])").find("found the name \"vq\""), std::string::npos);
  EXPECT_NE(message(R"(["1 N +", 0, 0])").find("formula[0]"), std::string::npos);
  EXPECT_NE(message("[5, 0, 0]").find("expected a formula"), std::string::npos);
  EXPECT_NE(message("3").find("three formulas"), std::string::npos);
}

// A live parameter may blow the wind up while the world runs.
TEST(SceneEnvironment, FollowsLiveParameters) {
  const Result<Scene> scene =
      parse_scene(R"({"parameters": {"wind": {"value": "2 m/s", "minimum": "0 m/s", "maximum": "20 m/s", "live": true}},
    "gravity": [0, 0, 0], "environment": {"wind": {"velocity": ["=wind", 0, 0]}},
    "bodies": [{"name": "a", "shape": {"type": "sphere"}}], "effectors": [{"type": "linear_drag", "coefficient": "1e5 N*s/m"}]})",
                  "s", {});
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  SceneWorld world = scene->instantiate().value();
  for (int i = 0; i < 60; ++i) world.world3->step(1.0f / 60).value();
  EXPECT_NEAR(world.world3->state(world.bodies[0].id).value().linear_velocity.x, 2, 1e-3);
  const ParameterValue value{"wind", 12};
  ASSERT_TRUE(scene->apply(world, {&value, 1}).ok());
  for (int i = 0; i < 60; ++i) world.world3->step(1.0f / 60).value();
  EXPECT_NEAR(world.world3->state(world.bodies[0].id).value().linear_velocity.x, 12, 1e-3);
}

TEST(SceneEnvironment, ErrorsNameThePlace) {
  const struct {
    const char *text, *part;
  } cases[] = {
      {R"({"environment": {"winds": {}}})",
       "environment.winds: found the unknown key \"winds\" in an environment, did you mean \"wind\""},
      {R"({"environment": {"water": {"spectrum": "jonswap"}}})", "environment.water: expected a spectrum with either"},
      {R"({"environment": {"water": {"sea_state": 3}}})", "environment.water: expected a spectrum with either"},
      {R"({"environment": {"water": {"spectrum": "jonswop", "sea_state": 3}}})", "did you mean \"jonswap\""},
      {R"({"environment": {"water": {"spectrum": "jonswap", "significant_height": 2}}})", "together"},
      {R"({"environment": {"water": {"spectrum": "pierson_moskowitz", "wind_speed": 9, "fetch": 9}}})",
       "found a fetch"},
      {R"({"environment": {"water": {"waves": [{"height": 1}]}}})", "environment.water.waves[0]: expected a period"},
      {R"({"environment": {"water": {"waves": [{"period": 1}]}}})", "the key \"height\" is missing"},
      {R"({"environment": {"water": {"waves": [{"height": 1, "period": 0}]}}})", "more than 0 s"},
      {R"({"environment": {"water": {"depth": "-3 m"}}})", "Sea::make: depth is -3"},
      {R"({"environment": {"water": {"spectrum": "jonswap", "sea_state": 4, "peak_enhancement": 50}}})", "1 … 10"},
      {R"({"environment": {"wind": {"layers": [{"height": 10, "velocity": [1,0,0]}, {"height": 5, "velocity": [1,0,0]}]}}})",
       "layers[1].height is 5"},
      {R"({"environment": {"wind": {"turbulence": {"shells": 3}}}})", "environment.wind.turbulence.shells"},
      {R"({"environment": {"wind": {"turbulence": {"strength": "3 kg"}}}})", "expected a speed"},
      {R"({"environment": {"wind": {"turbulence": {"size": 0}}}})", "length.u is 0"},
      {R"({"environment": {"wind": {"thermals": [{"radius": 0}]}}})", "thermals[0].radius is 0"},
      {R"({"environment": {"air": {"humidity": 3}}})", "air.relative_humidity is 3"},
      {R"({"environment": {"air": {"sea_level_pressure": "1000 m"}}})", "expected a pressure"},
      {R"({"environment": {"frame": {"latitude": "3 deg", "rate": [0,1,0]}}})", "found both rate and latitude"},
      {R"({"environment": {"gravity": {"kind": "spheric"}}})", "did you mean \"spherical\""},
      {R"({"effectors": [{"type": "body_drag", "law": "by_mach"}]})", "table: found 0 points"},
      {R"({"effectors": [{"type": "body_drag", "table": [1, 2, 3]}]})", "pairs of x and C_d"},
      {R"({"effectors": [{"type": "electromagnetic_field", "charge": "3 V"}]})", "expected a charge"},
  };
  for (const auto& c : cases) {
    const std::string e = error_of(c.text);
    EXPECT_NE(e.find(c.part), std::string::npos) << c.text << "\n" << e;
    EXPECT_EQ(e.rfind("scenes/sea.json:1: ", 0), 0u) << e;
  }
}

// Whatever is damaged in the file: it is read or refused, with a message that names the file.
TEST(SceneEnvironment, SurvivesDamage) {
  const std::string whole = everything;
  const std::string_view pieces[] = {"-1", "0", "1e300", "\"\"", "{}", "[]", "null", "=1/0", "-", ",", "}"};
  math::Random random(5);
  int refused = 0;
  for (int i = 0; i < 400; ++i) {
    std::string text = whole;
    for (int k = 0; k <= i % 3; ++k) {
      const std::size_t at = random.below(std::uint32_t(text.size()));
      if (random.chance(0.5))
        text.erase(at, 1 + random.below(6));
      else
        text.insert(at, pieces[random.below(11)]);
    }
    const std::string e = error_of(text);
    if (e == "accepted") continue;
    ++refused;
    EXPECT_EQ(e.rfind("scenes/sea.json", 0), 0u) << e;
  }
  EXPECT_GT(refused, 200);
}

}  // namespace environment_scene_test
