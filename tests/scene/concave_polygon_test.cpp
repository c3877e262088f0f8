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

// A frame 3 m × 2 m about a window 1 m × 1 m that is not in its middle, and a hole run round the other way: 5 m² − ½ m²
// with the centre and the inertia that are the whole's less the holes'. A ball in the window lies on its sill.
TEST(SceneConcavePolygon, HasHoles) {
  const std::string frame = R"("points": [[-1.5, 0], [1.5, 0], [1.5, 2], [-1.5, 2]],
      "openings": [[[-1, 0.5], [0, 0.5], [0, 1.5], [-1, 1.5]], [["50 cm", 0.5], [0.5, 1], [1, 1], [1, 0.5]], [[0.5, 1.5], [1, 1.25], [1, 1.75]]],
      "density": "2 kg/m^2")";
  std::string text = with(frame);
  text.insert(text.rfind(']'),
              R"(, {"name": "ball", "position": [-0.5, 1.2], "shape": {"type": "circle", "radius": 0.2}})");
  const SceneWorld world = test::started(parse_scene(text, "scenes/x.json", {}));
  const auto state = world.world2->state(world.bodies[1].id).value();
  const double area = 6 - 1 - 0.25 - 0.125, x = (1 * 0.5 - 0.25 * 0.75 - 0.125 * 2.5 / 3) / area,
               y = (6 * 1 - 1 * 1 - 0.25 * 0.75 - 0.125 * 1.5) / area;
  EXPECT_NEAR(state.mass, 2 * area, 1e-5);
  EXPECT_NEAR(state.center_of_mass.x, x, 1e-6);
  EXPECT_NEAR(state.center_of_mass.y, y, 1e-6);
  for (int i = 0; i < 120; ++i) world.world2->step(1.0f / 60).value();
  EXPECT_NEAR(test::read(world, "ball.position.y"), 0.7, 0.01);
}

TEST(SceneConcavePolygon, SaysWhatIsWrongWithAHole) {
  const auto message = [](const std::string& holes) {
    const Result<Scene> scene =
        parse_scene(with(R"("points": [[0, 0], [4, 0], [4, 4], [0, 4]], "openings": )" + holes), "scenes/x.json", {});
    const auto world = scene.ok() ? scene->instantiate() : Result<SceneWorld>(scene.error());
    return world.ok() ? std::string("none") : world.error().message;
  };
  EXPECT_EQ(message("[]"), "none");
  EXPECT_EQ(message("[[[1, 1], [2, 1], [2, 2]]]"), "none");
  for (const auto& [holes, wrong] :
       {std::pair{"[[[5, 1], [6, 1], [6, 2]]]", "holes[0] lies outside the outline"},
        {"[[[1, 1], [2, 1], [2, 2]], [[3, 1], [5, 1], [3, 2]]]", "of holes[1]"},
        {"[[[1, 1], [3, 1], [3, 3], [1, 3]], [[1.5, 1.5], [2, 1.5], [2, 2]]]", "holes[1] lies in holes[0]"},
        {"[[[1, 1], [3, 1], [3, 3], [1, 3]], [[2, 2], [3.5, 2], [2, 2.5]]]", "meets the side"},
        {"[[[1, 1], [3, 1]]]", "has 2 corners, expected 3"},
        {"[[1, 1], [3, 1], [3, 3]]", "openings[0][0]"},
        {"[[[1, 1], [3, 1], [3, \"1 s\"]]]", "openings[0][2]"},
        {"7", "expected a list of lists of points"},
        {"[7]", "expected a list of points"}}) {
    const std::string said = message(holes);
    EXPECT_NE(said.find(wrong), std::string::npos) << holes << ": " << said;
    EXPECT_NE(said.find("bodies[1].shape.openings"), std::string::npos) << holes << ": " << said;
  }
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
