// Worlds from files: parameters, groups, presets, plots; every scene of this repository; world → file → world.
#include <gtest/gtest.h>

#include <dirent.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "carom/geometry/hull.h"
#include "carom/scene/destruction.h"
#include "carom/scene/recording.h"
#include "carom/scene/scene.h"
#include "carom/scene/write_scene.h"
#include "tests/scene/scene_world.h"
#include "tests/scene/source_file.h"

namespace carom::scene {
namespace {

std::string scenes_folder() { return std::string(CAROM_SOURCE_DIR) + "/scenes/"; }
std::vector<std::string> scene_files() {
  std::vector<std::string> files;
  DIR* folder = opendir(scenes_folder().c_str());
  if (folder == nullptr) return files;
  while (const dirent* entry = readdir(folder)) {
    const std::string name = entry->d_name;
    if (name.size() > 5 && name.substr(name.size() - 5) == ".json") files.push_back(name);
  }
  closedir(folder);
  std::sort(files.begin(), files.end());
  return files;
}
Scene load(const std::string& name) {
  Result<Scene> scene = load_scene(scenes_folder() + name);
  EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().message);
  return scene.ok() ? *scene : Scene{};
}
Scene parse(std::string_view text) {
  Result<Scene> scene = parse_scene(text, "test");
  EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().message);
  return scene.ok() ? *scene : Scene{};
}
std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}
/// The message of a scene that must not load or start.
std::string parse_error(std::string_view text) {
  const Result<Scene> scene = parse_scene(text, "test");
  if (!scene.ok()) return scene.error().message;
  const Result<SceneWorld> world = scene->instantiate();
  return world.ok() ? "accepted" : world.error().message;
}
SceneWorld start(const Scene& scene, std::span<const ParameterValue> values = {}) {
  return test::started(scene, values);
}
using test::read;

class EverySceneFile : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EverySceneFile, testing::ValuesIn(scene_files()),
                         [](const auto& info) { return info.param.substr(0, info.param.size() - 5); });

TEST_P(EverySceneFile, LoadsAndRunsAndDescribesItself) {
  const Scene scene = load(GetParam());
  EXPECT_FALSE(scene.name.empty());
  EXPECT_FALSE(scene.description.empty());
  EXPECT_FALSE(scene.plots.empty() && scene.expectations.empty());
  SceneWorld world = start(scene);
  for (int i = 0; i < 10; ++i) ASSERT_TRUE(world.step().ok());
  EXPECT_EQ(world.step_count(), 10u);
  RecordedFrame frame;
  capture_frame(world, frame);
  EXPECT_EQ(frame.bodies.size(), world.bodies.size());
  const double level = 0;
  EXPECT_NE(scene_messages(world, &level).scene.find("\"ground\""), std::string::npos);
  for (const Parameter& p : scene.parameters) {
    EXPECT_LE(p.minimum, p.value);
    EXPECT_LE(p.value, p.maximum);
  }
}

TEST_P(EverySceneFile, ComesBackFromAFileWithTheSameStateHash) {
  const Scene scene = load(GetParam());
  SceneWorld world = start(scene);
  if (scene.kind == Kind::flight) {
    EXPECT_FALSE(write_scene(world).ok()) << "a flight is not a world of bodies";
    return;
  }
  const auto more = [](const auto& of) {
    return !of.guns.empty() || !of.structures.empty() || !of.rockets.empty() || !of.shells.empty();
  };
  if (world.matter || (world.destruction && (more(world.destruction->space) || more(world.destruction->plane)))) {
    EXPECT_FALSE(write_scene(world).ok()) << "ropes, guns and so on are not written";
    return;
  }
  for (int i = 0; i < 25; ++i) ASSERT_TRUE(world.step().ok());
  const Result<std::string> text = write_scene(world);
  ASSERT_TRUE(text.ok()) << text.error().message;
  const Scene again = parse(*text);
  const SceneWorld copy = start(again);
  EXPECT_EQ(copy.state_hash(), world.state_hash());
  EXPECT_EQ(copy.bodies.size(), world.bodies.size());
  const Result<std::string> twice = write_scene(copy);
  ASSERT_TRUE(twice.ok());
  EXPECT_TRUE(*twice == *text) << "writing what was read gives the same file";
}

/// The expectations at their times, as `carom run` checks them.
void expect_expectations(const Scene& scene, std::span<const ParameterValue> values = {}) {
  SceneWorld world = start(scene, values);
  const auto list = scene.expectations_for(world, values);
  ASSERT_TRUE(list.ok());
  ASSERT_FALSE(list->empty());
  std::vector<std::uint64_t> steps;
  const std::uint64_t last = std::uint64_t(world.duration / world.dt + 0.5);
  for (const Expectation& e : *list) steps.push_back(e.time < 0 ? last : std::uint64_t(e.time / world.dt + 0.5));
  for (std::uint64_t k = 0;; ++k) {
    for (std::size_t i = 0; i < steps.size(); ++i) {
      if (steps[i] != k) continue;
      const Expectation& e = (*list)[i];
      EXPECT_NEAR(read(world, e.quantity), e.expected, e.tolerance)
          << scene.name << ": " << e.quantity << " at " << k * world.dt << " s, " << e.source;
    }
    if (k == last) break;
    ASSERT_TRUE(world.step().ok());
  }
}

class SceneExpectations : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Scenes, SceneExpectations,
                         testing::Values("nesc_01", "nesc_02", "nesc_04", "pendulum", "collision_lab_2d",
                                         "collision_lab_3d", "tumbling_brick", "hovercraft_2d", "cannon",
                                         "floating_boxes", "wall_and_wrecking_ball", "ropes", "flag", "soft_bodies",
                                         "dam_break_2d", "sand_2d", "weather"));
TEST_P(SceneExpectations, AreMet) { expect_expectations(load(std::string(GetParam()) + ".json")); }

TEST(SceneExpectation, FollowsTheParameters) {
  const Scene scene = load("collision_lab_2d.json");
  const ParameterValue values[] = {{"e", 0.2}, {"u1", 9}, {"m2", 4}};
  expect_expectations(scene, values);
}

TEST(SceneParameters, AreReadWithUnitsAndRanges) {
  const Scene scene =
      parse(R"({"parameters": {"speed": {"value": "30 mph", "minimum": "0 mph", "maximum": "60 mph", "step": "1 mph"}},
    "bodies": [{"name": "car", "velocity": ["$speed", 0, 0], "gravity_scale": 0, "shape": {"type": "sphere"}}]})");
  ASSERT_EQ(scene.parameters.size(), 1u);
  EXPECT_EQ(scene.parameters[0].unit, "m/s");
  EXPECT_EQ(scene.parameters[0].display_unit, "mph");
  EXPECT_DOUBLE_EQ(scene.parameters[0].display_scale, 0.44704);
  EXPECT_DOUBLE_EQ(scene.parameters[0].value, 13.4112);
  const Result<ParameterValue> fast = scene.parse_parameter("speed=45 mph");
  ASSERT_TRUE(fast.ok());
  EXPECT_FLOAT_EQ(float(read(start(scene, {&*fast, 1}), "car.velocity.x")), float(45 * 0.44704));
  EXPECT_DOUBLE_EQ(scene.parse_parameter("speed=45")->value, 45 * 0.44704) << "a number alone is in the unit shown";
  for (const char* bad : {"speed", "speed=", "speed=90 mph", "speed=3 kg", "spede=3 mph", "speed=nan"})
    EXPECT_FALSE(scene.parse_parameter(bad).ok()) << bad;
  EXPECT_NE(scene.parse_parameter("sped=3 mph").error().message.find("did you mean \"speed\""), std::string::npos);
  const ParameterValue beyond[] = {{"speed", 1e9}}, unknown[] = {{"mass", 1}};
  EXPECT_FALSE(scene.instantiate(beyond).ok());
  EXPECT_FALSE(scene.instantiate(unknown).ok());
}

TEST(SceneParameters, ActOnARunningWorldWhereLive) {
  const Scene scene = parse(
      R"({"parameters": {"g": {"value": 10, "minimum": 0, "maximum": 100, "live": true}, "n": {"value": 1, "minimum": 1, "maximum": 9}},
    "gravity": [0, "=-g", 0], "bodies": [{"repeat": {"i": "=n"}, "bodies": [{"name": "b{i}", "shape": {"type": "sphere"}}]}]})");
  SceneWorld world = start(scene);
  ASSERT_TRUE(world.step().ok());
  const double before = read(world, "b0.velocity.y");
  const ParameterValue none[] = {{"g", 0}};
  ASSERT_TRUE(scene.apply(world, none).ok());
  ASSERT_TRUE(world.step().ok());
  EXPECT_EQ(read(world, "b0.velocity.y"), before);
  const ParameterValue more[] = {{"n", 3}};
  EXPECT_FALSE(scene.apply(world, more).ok()) << "a live value may not change how many bodies there are";
}

TEST(SceneGroups, CountWithInnerCountsAndConditions) {
  const SceneWorld world = start(parse(R"({"bodies": [{"repeat": {"i": 4, "j": "=4 - i"}, "bodies": [
    {"name": "b_{i}_{j}", "position": ["=i*2 m", "=j", 0], "shape": {"type": "sphere"}, "if": "=i + j != 3"}]}],
    "joints": [{"repeat": {"i": 2}, "joints": [{"type": "ball", "body_a": "b_{i}_0", "body_b": "b_{i+1}_0", "anchor": ["=2*i + 1", 0, 0]}]}]})"));
  EXPECT_EQ(world.bodies.size(), 6u);
  EXPECT_EQ(world.joints.size(), 2u);
  EXPECT_EQ(read(world, "b_1_1.position.x"), 2);
  EXPECT_EQ(world.find_body("b_0_3"), nullptr);
}

TEST(SceneShapes, GiveTheMassAskedFor) {
  const SceneWorld world = start(parse(
      R"({"materials": {"oak": {"density": "700 kg/m^3"}}, "shapes": {"crate": {"type": "box", "size": [2, 1, 1]}},
    "bodies": [{"name": "a", "mass": "12 kg", "shape": "crate"}, {"name": "b", "shape": {"use": "crate", "material": "oak"}, "position": [5, 0, 0]},
    {"name": "c", "position": [0, 9, 0], "shapes": [{"type": "sphere", "mass": "3 kg"}, {"type": "sphere", "mass": "4 kg", "position": [0, 2, 0]}]},
    {"name": "d", "position": [0, 0, 9], "shape": "crate", "mass_properties": {"mass": 5, "center": [0.1, 0, 0], "inertia": [1, 2, 2.5]}}]})"));
  EXPECT_NEAR(read(world, "a.mass"), 12, 1e-5);
  EXPECT_NEAR(read(world, "b.mass"), 1400, 1e-3);
  EXPECT_NEAR(read(world, "c.mass"), 7, 1e-5);
  EXPECT_EQ(read(world, "d.mass"), 5);
  EXPECT_NEAR(read(world, "c.center.y"), 9 + 2 * 4.0 / 7, 1e-5);
  EXPECT_NEAR(read(world, "d.center.x"), 0.1, 1e-7);
}

TEST(SceneShapes, AreReadFromMeshFiles) {
  const Resolver files = [](std::string_view path) -> Result<std::string> {
    if (path != "parts/tetra.obj") return core::Error{"no such file"};
    return std::string("v 0 0 0\nv 1000 0 0\nv 0 1000 0\nv 0 0 1000\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  };
  const Result<Scene> scene = parse_scene(R"({"bodies": [
    {"name": "hull", "density": 1200, "shape": {"type": "hull", "file": "parts/tetra.obj", "scale": 0.001}},
    {"name": "mesh", "type": "fixed", "position": [0, -5, 0], "shape": {"type": "mesh", "file": "parts/tetra.obj"}}]})",
                                          "t", files);
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  EXPECT_NEAR(read(start(*scene), "hull.mass"), 200, 1e-3);
  for (const char* name : {"none.obj", "../tetra.obj"})
    EXPECT_FALSE(
        parse_scene(std::string("{\"bodies\": [{\"shape\": {\"type\": \"hull\", \"file\": \"") + name + "\"}}]}", "t",
                    files)
            .ok());
}

TEST(SceneBodies, ReadRotationsInEveryForm) {
  const SceneWorld world = start(parse(R"({"bodies": [
    {"name": "axis", "rotation": {"axis": [0, 0, 2], "angle": "90 deg"}}, {"name": "pitch", "rotation": {"pitch": "90 deg"}},
    {"name": "quat", "rotation": [0.70710678, 0, 0, 0.70710678]}, {"name": "tilted", "rotation": {"roll": "30 deg"}}]})"));
  for (const char* name : {"axis", "pitch", "quat"}) {
    const auto state = world.world3->state(world.find_body(name)->id);
    const math::Vec3f x = math::rotate(state->pose.rotation, math::Vec3f{1, 0, 0});
    EXPECT_NEAR(x.y, 1, 1e-6) << name;
  }
  EXPECT_NEAR(read(world, "tilted.tilt"), math::radians(30.0), 1e-6);
}

TEST(SceneJoints, OfEveryTypeInBothDimensions) {
  const char* joints = R"("joints": [
    {"type": "distance", "body_a": "a", "body_b": "b", "anchor_a": [A0], "anchor_b": [A1], "spring": {"frequency": "2 Hz", "damping_ratio": 0.3}},
    {"type": "hinge", "body_a": "world", "body_b": "a", "anchor": [A0], "spring": {"frequency": "3 Hz"}, "target_angle": "10 deg", "max_spring_torque": "4 N*m", "limit": {"lower": "-1 deg", "upper": "90 deg"}, "motor": {"speed": "60 rpm", "max_torque": "5 N*m"}},
    {"type": "slider", "body_a": "world", "body_b": "b", "anchor": [A1], "axis": [A1], "spring": {"frequency": "3 Hz"}, "target_translation": "10 cm", "max_spring_force": "4 N", "motor": {"speed": "1 m/s", "max_force": "10 N"}},
    {"type": "weld", "body_a": "a", "body_b": "c", "anchor": [A0], "angular_spring": {"frequency": "1 Hz"}},
    {"type": "ball", "body_a": "a", "body_b": "c", "anchor": [A0], "spring": {"frequency": "1 Hz"}, "target_rotation": TURN},
    {"type": "motor", "body_a": "b", "body_b": "c", "max_force": "10 N", "target_position": [A1], "target_rotation": TURN,
     "target_velocity": [A1], "target_spin": SPIN, "hold_position": false},
    {"type": "mouse", "body_b": "c", "anchor": [A1], "target": [A0]},
    {"type": "generic", "body_a": "a", "body_b": "b", "anchor": [A0], "break_force": "40 kN", "break_torque": "9 kN*m",
     "axes": {"x": {"limit": {"lower": "-1 m", "upper": "2 m"}, "spring": {"frequency": "1 Hz"}, "target": "10 cm", "max_spring_force": "50 N"},
              "y": {"friction": "3 N"}, "turn_z": {"motor": {"speed": "1 rpm", "max_torque": "2 N*m"}, "limit": {"lower": "-20 deg", "upper": "20 deg"}}}},
    {"type": "wheel", "body_a": "a", "body_b": "c", "anchor": [A0], "spring": {"frequency": "2 Hz", "damping_ratio": 0.7},
     "limit": {"lower": "-10 cm", "upper": "10 cm"}, "motor": {"speed": "10 rpm", "max_torque": "1 N*m"}},
    {"type": "gear", "body_a": "a", "body_b": "b", "ratio": -2},
    {"type": "rack", "body_a": "a", "body_b": "b", "slide_axis": [A1], "radius": "20 cm"},
    {"type": "pulley", "body_a": "a", "body_b": "b", "anchor": [A0], "ground_a": [A1], "ground_b": [A0], "ratio": 2},
    {"type": "path", "body_a": "a", "body_b": "c", "points": [[A0], [A1], [A2]], "follow": true, "spring": {"frequency": "1 Hz"},
     "target_distance": "50 cm", "max_spring_force": "20 N", "limit": {"lower": 0, "upper": "1 m"}},
    {"type": "path", "body_a": "world", "body_b": "b", "points": [[A0], [A1], [A2]], "tangents": [[A1], [A1], [A1]], "closed": true, "friction": "2 N"}])";
  for (const int dimension : {2, 3}) {
    std::string text = "{\"dimension\": " + std::to_string(dimension) + ", \"bodies\": [";
    for (const char* name : {"a", "b", "c"})
      text += std::string(name[0] == 'a' ? "" : ", ") + "{\"name\": \"" + name + "\", \"shape\": {\"type\": \"" +
              (dimension == 2 ? "circle" : "sphere") + "\"}, \"position\": [A1]}";
    text += std::string("], ") + joints + "}";
    for (const auto& [from, to] :
         {std::pair<std::string, std::string>{"[A0]", dimension == 2 ? "[0, 0]" : "[0, 0, 0]"},
          {"TURN", dimension == 2 ? "\"30 deg\"" : "{\"axis\": [0, 1, 0], \"angle\": \"30 deg\"}"},
          {"SPIN", dimension == 2 ? "\"2 rpm\"" : "[1, \"2 rpm\", 0]"},
          {"[A2]", dimension == 2 ? "[2, 0]" : "[2, 0, 1]"},
          {"[A1]", dimension == 2 ? "[1, 1]" : "[1, 1, 1]"}})
      for (std::size_t at = 0; (at = text.find(from)) != std::string::npos;) text.replace(at, from.size(), to);
    SceneWorld world = start(parse(text));
    EXPECT_EQ(world.joints.size(), 14u);
    EXPECT_EQ(world.bodies.size(), 4u) << "and the body \"world\"";
    for (int i = 0; i < 20; ++i) ASSERT_TRUE(world.step().ok());
    const Result<std::string> written = write_scene(world);
    ASSERT_TRUE(written.ok());
    EXPECT_EQ(start(parse(*written)).state_hash(), world.state_hash());
    EXPECT_EQ(write_scene(start(parse(*written))).value(), *written);
  }
}

TEST(SceneJoints, OfSpaceOnly) {
  const std::string bodies =
      R"("bodies": [{"name": "a", "shape": {"type": "SHAPE"}}, {"name": "b", "shape": {"type": "SHAPE"}}])";
  for (const char* type : {"cylindrical", "planar", "universal", "screw"}) {
    const std::string joint = std::string(R"("joints": [{"type": ")") + type +
                              R"(", "body_a": "a", "body_b": "b", "anchor": ORIGIN, "axis": AXIS}])";
    const auto text = [&](int dimension) {
      std::string t = "{\"dimension\": " + std::to_string(dimension) + ", " + bodies + ", " + joint + "}";
      for (const auto& [from, to] : {std::pair<std::string, std::string>{"SHAPE", dimension == 2 ? "circle" : "sphere"},
                                     {"ORIGIN", dimension == 2 ? "[0, 0]" : "[0, 0, 0]"},
                                     {"AXIS", dimension == 2 ? "[0, 1]" : "[0, 1, 0]"}})
        for (std::size_t at = 0; (at = t.find(from)) != std::string::npos;) t.replace(at, from.size(), to);
      return t;
    };
    const SceneWorld world = start(parse(text(3)));
    ASSERT_EQ(world.joints.size(), 1u) << type;
    const std::string written = write_scene(world).value();
    EXPECT_EQ(write_scene(start(parse(written))).value(), written) << type;
    const Result<Scene> flat = parse_scene(text(2), "t");
    ASSERT_FALSE(flat.ok()) << type;
    EXPECT_NE(flat.error().message.find("for space"), std::string::npos) << flat.error().message;
  }
}

TEST(SceneJoints, SolverIsASetting) {
  const SceneWorld world = start(parse(R"({"world": {"joint_solver": "direct"}, "bodies": []})"));
  EXPECT_EQ(world.world3->definition().joint_solver, rigid::JointSolver::direct);
  EXPECT_NE(write_scene(world).value().find("\"joint_solver\": \"direct\""), std::string::npos);
}

TEST(SceneEffectors, OfEveryTypeComeBackTheSame) {
  const SceneWorld world = start(parse(
      R"({"bodies": [{"name": "a", "shape": {"type": "sphere"}}, {"name": "b", "position": [3, 0, 0], "shape": {"type": "sphere"}}],
    "effectors": [{"type": "spherical_gravity", "center": [0, -7e6, 0]}, {"type": "linear_drag", "coefficient": 0.3, "angular_coefficient": "0.1 N*m*s"},
    {"type": "quadratic_drag", "body": "a", "point": [0.1, 0, 0]}, {"type": "wind", "velocity": ["10 kn", 0, 0]},
    {"type": "spring", "body_a": "a", "body_b": "b", "stiffness": "3 N/mm"}, {"type": "spring", "body_a": "a", "point_b": [0, 9, 0]},
    {"type": "buoyancy", "waves": [{"amplitude": "1 ft", "wavelength": "30 m", "phase": "20 deg"}]},
    {"type": "thrust", "body": "b", "force": ["1 lbf", 0, 0]}, {"type": "radial_field"}, {"type": "vortex_field", "axis": [0, 0, 1]}]})"));
  EXPECT_EQ(world.effectors.size(), 10u);
  const Result<std::string> written = write_scene(world);
  ASSERT_TRUE(written.ok());
  EXPECT_EQ(write_scene(start(parse(*written))).value(), *written);
}

TEST(WriteScene, KeepsEveryKindOfShape) {
  const SceneWorld space = start(parse(R"({"bodies": [
    {"name": "fixed", "type": "fixed", "shapes": [{"type": "plane", "normal": [0.1, 1, 0]},
      {"type": "mesh", "vertices": [[0,0,0],[1,0,0],[0,0,1],[1,0.3,1]], "indices": [0,2,1,1,2,3]},
      {"type": "height_field", "columns": 3, "rows": 2, "cell": [1, 0.5], "heights": [0, 0.1, 0, 0.2, 0.3, 0.1], "holes": [0, 1]},
      {"type": "voxels", "columns": 3, "layers": 2, "rows": 4, "cell_size": "25 cm", "runs": [7, 1, 5, 0, 3, 2, 9, 1], "surfaces": [{"material": {"friction": 1}}, {"material": {"friction": 0.1}}]}]},
    {"name": "egg", "position": [2, 9, 1], "shape": {"type": "ellipsoid", "radii": [0.3, "20 cm", 0.4]}},
    {"name": "tetrahedron", "position": [7, 9, 1], "shape": {"type": "mesh", "vertices": [[0,0,0],[1,0,0],[0,1,0],[0,0,1]], "indices": [0,2,1,0,1,3,1,2,3,2,0,3], "density": 500, "filter": {"mask": 2}}},
    {"name": "hull", "position": [0.1, 5.3, 0.7], "awake": false, "user_data": "0xfedcba9876543210", "locks": ["x", "rotation_z"],
      "shape": {"type": "hull", "points": [[0,0,0],[1,0,0],[0,1.1,0],[0,0,1.3],[0.7,0.7,0.7]], "radius": 0.02, "filter": {"category": [1, 40], "mask": "0xff", "group": -3}}},
    {"name": "compound", "position": [5, 5, 5], "velocity": [1, 2, 3], "angular_velocity": [0.3, 0.2, 0.1], "rotation": {"yaw": "33 deg", "pitch": "12 deg"},
      "shape": {"type": "compound", "children": [{"type": "cylinder", "height": 2, "rounding": 0.05}, {"type": "cone", "position": [0, 1, 0], "rounding": 0.1}, {"type": "capsule", "length": 1, "radius": 0.2}]}},
    {"name": "box", "position": [-5, 5, 5], "shape": {"type": "box", "size": [1, 2, 3], "radius": 0.1, "sensor": true}},
    {"name": "belt", "type": "fixed", "position": [0, -9, 0], "shape": {"type": "box", "size": [9, 1, 9], "material": {"user_id": 7},
      "surface_velocity": ["2 km/h", 0, "1 m/s"], "modify_contacts": true}}],
    "world": {"material_pairs": [{"materials": [7, 0], "friction": 0.05, "restitution": 0.5}]}})"));
  EXPECT_EQ(read(space, "compound.velocity.y"), 2) << "of the centre of mass, which the cone puts off the origin";
  const std::string text = write_scene(space).value();
  const SceneWorld copy = start(parse(text));
  EXPECT_EQ(copy.state_hash(), space.state_hash());
  std::vector<rigid::MaterialPair> pairs;
  copy.world3->pair_rules(pairs);
  ASSERT_EQ(pairs.size(), 1u);
  EXPECT_EQ(pairs[0].rule.friction, 0.05f);
  EXPECT_NE(text.find("surface_velocity"), std::string::npos);
  EXPECT_NE(text.find("\"runs\": [7, 1, 5, 0, 3, 2, 9, 1]"), std::string::npos);
  EXPECT_NEAR(read(copy, "tetrahedron.mass"), 500.0 / 6, 1e-4) << "of what the mesh encloses";
  EXPECT_EQ(write_scene(copy).value(), text);
  const SceneWorld plane = start(parse(R"({"dimension": 2, "bodies": [
    {"type": "fixed", "shapes": [{"type": "segment", "points": [[-1, 0], [1, 0.1]]}, {"type": "chain", "points": [[0,0],[1,0],[1,1]], "loop": true},
      {"type": "box", "size": [4, 0.2], "position": [0, 3], "one_way": [0, 1]}]},
    {"position": [3, 3.3], "rotation": "17 deg", "shapes": [{"type": "polygon", "points": [[0,0],[1,0],[0.3,1.7]], "radius": 0.01}, {"type": "capsule"}, {"type": "box", "size": [1, 2]}, {"type": "circle", "diameter": "3 in"}]}]})"));
  const std::string flat = write_scene(plane).value();
  EXPECT_EQ(start(parse(flat)).state_hash(), plane.state_hash());
  EXPECT_EQ(write_scene(start(parse(flat))).value(), flat);
}

TEST(SceneShapes, HavePartsOfDifferentMaterials) {
  const char* const space = R"({"dimension": 3, "materials": {"ice": {"friction": 0.05, "user_id": 3}},
    "bodies": [{"name": "ground", "type": "fixed", "shape": SHAPE}]})";
  const char* const shapes[] = {
      R"({"type": "mesh", "vertices": [[0, 0, 0], [0, 0, 1], [1, 0, 0], [1, 0, 1]], "indices": [0, 1, 2, 2, 1, 3],
          "materials": [0, 1], "surfaces": ["ice", {"material": {"friction": 2}, "surface_velocity": ["3 m/s", 0, 0]}]})",
      R"({"type": "height_field", "columns": 3, "rows": 2, "heights": [0, 0, 0, 0, 0, 0], "materials": [0, 1],
          "surfaces": ["ice", {"material": {"friction": 2}, "surface_velocity": ["3 m/s", 0, 0]}]})"};
  for (const std::string shape : shapes) {
    const SceneWorld world = start(parse(replaced(space, "SHAPE", shape)));
    std::vector<rigid::ShapeId> ids;
    world.world3->shapes(world.bodies[0].id, ids);
    const std::vector<rigid::SurfaceMaterial<rigid::Dim3>> surfaces =
        world.world3->shape_definition(ids[0]).value().surfaces;
    ASSERT_EQ(surfaces.size(), 2u);
    EXPECT_EQ(surfaces[0].material.user_id, 3u);
    EXPECT_EQ(surfaces[0].material.friction, 0.05f);
    EXPECT_EQ(surfaces[1].material.friction, 2.0f);
    EXPECT_EQ(surfaces[1].surface_velocity, (math::Vec3f{3, 0, 0}));
    EXPECT_EQ(geometry::material_count(world.world3->shape_geometry(ids[0]).value()), 2);
    const std::string written = write_scene(world).value();
    EXPECT_EQ(write_scene(start(parse(written))).value(), written);
    EXPECT_NE(parse_error(replaced(space, "SHAPE", replaced(shape, "[0, 1]", "[0, 256]")))
                  .find("whole numbers from 0 to 255"),
              std::string::npos);
    EXPECT_NE(parse_error(replaced(space, "SHAPE", replaced(shape, "\"ice\"", "\"icy\""))).find("did you mean"),
              std::string::npos);
  }
  const SceneWorld flat = start(parse(R"({"dimension": 2, "bodies": [{"name": "ground", "type": "fixed", "shape":
    {"type": "chain", "points": [[2, 0], [1, 0], [0, 0]], "materials": [1, 0], "surfaces":
     [{"material": {"friction": 1}}, {"material": {"friction": 2}}]}}]})"));
  const std::string written = write_scene(flat).value();
  EXPECT_NE(written.find("\"materials\": [1, 0]"), std::string::npos);
  EXPECT_EQ(write_scene(start(parse(written))).value(), written);
}

TEST(Probe, ReadsExpressionsWithUnits) {
  const SceneWorld world = start(parse(
      R"({"gravity": [0, -10, 0], "bodies": [{"name": "a.b", "position": [0, 3, 0], "velocity": [3, 4, 0], "mass": "2 kg", "shape": {"type": "sphere"}}]})"));
  EXPECT_EQ(read(world, "a.b.speed"), 5);
  EXPECT_EQ(read(world, "a.b.position.y*2"), 6);
  EXPECT_NEAR(read(world, "energy.kinetic"), 25, 1e-5);
  EXPECT_NEAR(read(world, "energy.total"), 85, 1e-4);
  EXPECT_NEAR(read(world, "momentum.x"), 6, 1e-6);
  EXPECT_EQ(world.probe("a.b.speed*a.b.mass")->unit, world.probe("momentum.x")->unit);
  for (const char* bad :
       {"", "a.b", "a.b.speeed", "a.b.position", "c.speed", "momentum", "a.b.speed + time", "joint.x.coordinate"})
    EXPECT_FALSE(world.probe(bad).ok()) << bad;
}

TEST(Schema, InTheRepositoryIsTheOneOfTheLoader) {
  std::ifstream file(scenes_folder() + "schema/carom-scene.schema.json");
  std::stringstream text;
  text << file.rdbuf();
  if (const char* rewrite = std::getenv("CAROM_REWRITE_SCHEMA"); rewrite != nullptr)
    std::ofstream(rewrite) << scene_schema();
  EXPECT_TRUE(text.str() == scene_schema()) << "CAROM_REWRITE_SCHEMA=FILE test_scene writes it anew";
}

// Two surfaces of the table of friction; "friction" beside it holds.
TEST(Scene, PairsOfTheTableOfFriction) {
  const auto scene = [](const std::string& pair) {
    return parse_scene(R"({"dimension": 2, "world": {"material_pairs": [{"materials": [1, 2], )" + pair + "}]}}", "t",
                       test::read_source);
  };
  const struct {
    const char* pair;
    float friction, at_rest;  // at_rest 0: as friction
  } cases[] = {{R"("pair": "rubber on asphalt, wet")", 0.5f, 0.6f},
               {R"("pair": "ice on steel")", 0.03f, 0.1f},
               {R"("pair": "ice on steel", "friction": 0.2)", 0.2f, 0},
               {R"("friction": 0.2, "static_friction": 0.3)", 0.2f, 0.3f}};
  for (const auto& [pair, friction, at_rest] : cases) {
    std::vector<rigid::MaterialPair> pairs;
    start(scene(pair).value()).world2->pair_rules(pairs);
    ASSERT_EQ(pairs.size(), 1u);
    EXPECT_EQ(pairs[0].rule.friction, friction) << pair;
    EXPECT_EQ(pairs[0].rule.static_friction, at_rest) << pair;
  }
  const auto wrong = scene(R"("pair": "rubber on asfalt, wet")");
  ASSERT_FALSE(wrong.ok());
  EXPECT_NE(wrong.error().message.find("world.material_pairs[0].pair"), std::string::npos) << wrong.error().message;
  EXPECT_NE(wrong.error().message.find("did you mean \"rubber on asphalt, wet\"?"), std::string::npos)
      << wrong.error().message;
}

std::vector<std::filesystem::path> presets_in(const std::string& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(CAROM_SOURCE_DIR "/presets/" + folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  return files;
}

TEST(Presets, AllStateTheirSource) {
  const std::vector<std::filesystem::path> files = presets_in("");
  EXPECT_GT(files.size(), 80u);
  for (const std::filesystem::path& path : files) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    if (path.extension() == ".json") {
      const std::size_t at = text.str().find("\"source\": \"");
      EXPECT_TRUE(at != std::string::npos && text.str().find('"', at + 11) > at + 20) << path;
    } else {  // tables begin with where they are from
      const std::string first = text.str().substr(0, text.str().find('\n'));
      EXPECT_TRUE(first.size() > 20 && (first[0] == '#' || first[0] == ';')) << path;
    }
  }
}

TEST(Presets, BallsAndMaterialsLoad) {
  const auto mass = [](const std::string& text) {
    const Result<Scene> scene = parse_scene(text, "t", test::read_source);
    EXPECT_TRUE(scene.ok()) << scene.error().message << "\n" << text;
    return scene.ok() ? read(start(*scene), "b.mass") : 0;
  };
  for (const std::filesystem::path& path : presets_in("ball"))
    EXPECT_GT(mass(R"({"bodies": [{"name": "b", "preset": "ball/)" + path.stem().string() + R"("}]})"), 0.002) << path;
  for (const std::filesystem::path& path : presets_in("material"))
    EXPECT_GT(mass(R"({"materials": {"m": {"preset": "material/)" + path.stem().string() +
                   R"("}}, "bodies": [{"name": "b", "shape": {"type": "box", "size": [1, 1, 1], "material": "m"}}]})"),
              100)
        << path;
}

}  // namespace
}  // namespace carom::scene
