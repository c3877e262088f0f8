// Concave polygons of scene files: convex parts of one body, with the mass of the whole.
#include <gtest/gtest.h>

#include "tests/scene/scene_world.h"

namespace carom::scene {
namespace {

std::string with(const std::string& keys) {
  return R"({"dimension": 2, "bodies": [
    {"name": "floor", "type": "fixed", "position": [0, -1], "shape": {"type": "box", "size": [20, 2]}},
    {"name": "bracket", "shape": {"type": "concave_polygon", )" +
         keys + "}}]}";
}

// An L of 3 m² whose parts are two boxes, with the centre of mass of both: (5/6, 5/6).
TEST(SceneConcavePolygon, IsOneBodyOfSeveralParts) {
  const SceneWorld world = test::started(parse_scene(
      with(
          R"("points": [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]], "mass": "6 kg", "material": {"friction": 0.9})"),
      "scenes/x.json", {}));
  std::vector<rigid::ShapeId> shapes;
  world.world2->shapes(world.bodies[1].id, shapes);
  ASSERT_EQ(shapes.size(), 2u);
  for (const rigid::ShapeId s : shapes) EXPECT_EQ(world.world2->shape_definition(s)->material.friction, 0.9f);
  const auto state = world.world2->state(world.bodies[1].id).value();
  EXPECT_NEAR(state.mass, 6, 1e-5);
  EXPECT_NEAR(state.center_of_mass.x, 5.0 / 6, 1e-6);
  EXPECT_NEAR(state.center_of_mass.y, 5.0 / 6, 1e-6);
  for (int i = 0; i < 120; ++i) world.world2->step(1.0f / 60).value();
  EXPECT_NEAR(test::read(world, "bracket.position.y"), 0, 0.01) << "it lies on its long side";
}

TEST(SceneConcavePolygon, SaysWhereItCrossesItself) {
  const Result<Scene> scene = parse_scene(with(R"("points": [[0, 0], [2, 2], [2, 0], [0, 2]])"), "scenes/x.json", {});
  const auto world = scene.ok() ? scene->instantiate() : Result<SceneWorld>(scene.error());
  ASSERT_FALSE(world.ok());
  EXPECT_NE(world.error().message.find("bodies[1]"), std::string::npos) << world.error().message;
  EXPECT_NE(world.error().message.find("meets the side"), std::string::npos) << world.error().message;
}

}  // namespace
}  // namespace carom::scene
