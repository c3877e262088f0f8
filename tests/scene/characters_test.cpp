// Characters and tiles of scene files.
#include <gtest/gtest.h>

#include "carom/scene/scene.h"
#include "tests/scene/scene_world.h"

namespace carom::scene {
namespace {

SceneWorld started(const std::string& text) { return test::started(parse_scene(text, "scenes/x.json", {})); }
std::string fault_of(const std::string& text) {
  const Result<Scene> scene = parse_scene(text, "scenes/x.json", {});
  if (!scene.ok()) return scene.error().message;
  const Result<SceneWorld> world = scene->instantiate();
  return world.ok() ? "" : world.error().message;
}

// A square ring of tiles has two outlines, one round it and one round its cave: 12 tiles on 4 by 4 with a hole of 2
// by 2.
TEST(SceneTiles, AreTheirOutlines) {
  const SceneWorld world = started(R"({"dimension": 2, "bodies": [
    {"name": "ring", "type": "fixed", "shape": {"type": "tiles", "columns": 4, "rows": 4, "cell_size": "50 cm",
      "runs": [5, 1, 2, 0, 2, 1, 2, 0, 5, 1], "material": {"friction": 0.9}}},
    {"name": "ball", "position": [1, 1], "shape": {"type": "circle", "radius": "20 cm"}}]})");
  std::vector<rigid::ShapeId> shapes;
  world.world2->shapes(world.bodies[0].id, shapes);
  ASSERT_EQ(shapes.size(), 2u);
  for (const rigid::ShapeId s : shapes) {
    EXPECT_EQ(world.world2->shape_definition(s)->material.friction, 0.9f);
    EXPECT_EQ(world.world2->shape_geometry(s)->chain->points.size(), 4u) << "straight runs are one segment";
  }
  for (int i = 0; i < 120; ++i) world.world2->step(1.0f / 60).value();
  EXPECT_NEAR(test::read(world, "ball.position.y"), 0.7, 0.01) << "it lies on the floor of the cave";
}

TEST(SceneTiles, AreRefusedWhereTheyAreNone) {
  const auto tiles = [](const char* keys) {
    return std::string(R"({"dimension": 2, "bodies": [{"type": "fixed", "shape": {"type": "tiles", )") + keys + "}}]}";
  };
  EXPECT_NE(fault_of(tiles(R"("columns": 2, "rows": 2, "cell_size": 1, "runs": [4, 0])")).find("every tile is empty"),
            std::string::npos);
  EXPECT_NE(fault_of(tiles(R"("columns": 2, "rows": 2, "cell_size": 1, "runs": [3, 1])")).find("for 4"),
            std::string::npos);
  EXPECT_NE(fault_of(tiles(R"("columns": 2, "rows": 2, "cell_size": 0, "runs": [4, 1])")).find("bodies[0]"),
            std::string::npos);
  EXPECT_NE(fault_of(tiles(R"("columns": 2, "rows": 2, "runs": [4, 1])")).find("cell_size"), std::string::npos);
  EXPECT_NE(
      fault_of(R"({"bodies": [{"type": "fixed", "shape": {"type": "tiles", "columns": 1, "rows": 1, "cell_size": 1,
                        "runs": [1, 1]}}]})"),
      "");
}

constexpr const char* course = R"({"step": "1/60 s",
  "parameters": {"pace": {"value": "2 m/s", "minimum": "0 m/s", "maximum": "4 m/s", "live": true}},
  "bodies": [{"name": "ground", "type": "fixed", "shape": {"type": "plane"}}],
  "characters": [
    {"name": "legs", "position": [0, 0, 0], "velocity": ["=pace", 0, 0], "mass": "70 kg", "color": "#ff8000"},
    {"repeat": {"i": 2}, "characters": [
      {"name": "ghost_{i}", "type": "kinematic", "position": [0, 0, "=3 + i"], "velocity": [0, 0, "=pace/2"]}]}]})";

TEST(SceneCharacters, WalkAsTheyAreTold) {
  const Result<Scene> scene = parse_scene(course, "scenes/x.json", {});
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  SceneWorld world = scene->instantiate().value();
  ASSERT_EQ(world.characters.size(), 3u);
  ASSERT_EQ(world.bodies.size(), 4u);
  EXPECT_TRUE(world.find_body("legs")->colored);
  EXPECT_NEAR(test::read(world, "legs.mass"), 70, 0.01);
  for (int i = 0; i < 60; ++i) world.step().value();
  EXPECT_NEAR(test::read(world, "legs.velocity.x"), 2, 0.02);
  EXPECT_NEAR(test::read(world, "ghost_1.position.z"), 5, 0.05);
  scene->apply(world, std::vector<ParameterValue>{{"pace", 1}}).value();
  for (int i = 0; i < 60; ++i) world.step().value();
  EXPECT_NEAR(test::read(world, "legs.velocity.x"), 1, 0.02);
  SceneWorld again = scene->instantiate().value();
  for (int i = 0; i < 60; ++i) again.step().value();
  scene->apply(again, std::vector<ParameterValue>{{"pace", 1}}).value();
  for (int i = 0; i < 60; ++i) again.step().value();
  EXPECT_EQ(again.state_hash(), world.state_hash());
}

TEST(SceneCharacters, WrongOnesAreNamed) {
  const auto with = [](const char* keys) { return std::string(R"({"characters": [{)") + keys + "}]}"; };
  EXPECT_NE(fault_of(with(R"("mass": "-1 kg")")).find("characters[0]"), std::string::npos);
  EXPECT_NE(fault_of(with(R"("push_force": "1 N")")).find("only a kinematic character"), std::string::npos);
  EXPECT_NE(fault_of(with(R"("type": "kinematic", "leg_force": "1 N")")).find("only a dynamic character"),
            std::string::npos);
  EXPECT_NE(fault_of(with(R"("type": "flying")")).find("kinematic"), std::string::npos);
  EXPECT_NE(fault_of(R"({"bodies": [{"name": "a"}], "characters": [{"name": "a"}]})").find("a second time"),
            std::string::npos);
}

}  // namespace
}  // namespace carom::scene
