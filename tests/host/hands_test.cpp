// What a page asks of a scene: bodies thrown in, probes, reports on a body, layers of debug drawing.
#include <algorithm>
#include <cmath>

#include "apps/host/debug_draw.h"
#include "apps/host/debug_effectors.h"
#include "apps/host/scene_demo.h"
#include "tests/host/client.h"

namespace carom::host::test {
namespace {

/// A box of 1 m and 1000 kg on a floor, through the interface of a scene file.
constexpr const char* box_on_floor = R"({"name": "box", "dimension": 3, "bodies": [
  {"name": "floor", "type": "fixed", "position": [0, "-1 m", 0], "shape": {"type": "box", "half_extents": ["20 m", "1 m", "20 m"]}},
  {"name": "box", "position": [0, "0.5 m", 0], "mass": "1000 kg", "shape": {"type": "box", "half_extents": ["0.5 m", "0.5 m", "0.5 m"]}}]})";

class Scene : public ::testing::Test {
 protected:
  Page page{[] {
    HostOptions options;
    options.parse_scene = [](std::string_view name, std::string_view text) -> core::Result<std::unique_ptr<Demo>> {
      core::Result<scene::Scene> scene = scene::parse_scene(text, name);
      if (!scene.ok()) return scene.error();
      return make_scene_demo(std::move(scene).value(), std::string(name));
    };
    return options;
  }()};

  void open(const char* text) {
    page.send({{"type", "hello"}, {"protocol", 1}});
    page.send({{"type", "open_scene"}, {"name", "test"}, {"text", text}});
    ASSERT_TRUE(page.last("error").is_null()) << page.last("error");
    page.send({{"type", "pause"}});
    page.ack();
  }
  void advance() {
    page.advance();
    page.ack();
  }
};

TEST_F(Scene, ARayDownMeetsTheTopOfTheBoxAndASphereItsRadiusEarlier) {
  open(box_on_floor);
  const Json ray = {
      {"type", "probe"}, {"kind", "ray"}, {"origin", {0.2, 5, 0.1}}, {"direction", {0, -2, 0}}, {"radius", 0.25}};
  page.send(ray);
  Json answer = page.last("probed");
  EXPECT_NEAR(answer["distance"].get<double>(), 4.0, 1e-5);
  EXPECT_NEAR(answer["point"][1].get<double>(), 1.0, 1e-5);
  EXPECT_NEAR(answer["normal"][1].get<double>(), 1.0, 1e-5);
  Json sphere = ray;
  sphere["kind"] = "sphere";
  page.send(sphere);
  EXPECT_NEAR(page.last("probed")["distance"].get<double>(), 3.75, 2e-3) << "casts stop a millimetre before they touch";
  Json miss = ray;
  miss["direction"] = {0, 1, 0};
  page.send(miss);
  EXPECT_EQ(page.last("probed")["body"], -1);
  Json wrong = ray;
  wrong["radius"] = -1;
  page.send(wrong);
  EXPECT_NE(page.last("error").dump().find("radius"), std::string::npos);
}

TEST_F(Scene, TheClosestBodyToAPointOfTheFloor) {
  open(box_on_floor);
  // The ray meets the floor 2 m beside the box' face.
  page.send(
      {{"type", "probe"}, {"kind", "closest"}, {"origin", {2.5, 3, 0}}, {"direction", {0, -1, 0}}, {"radius", 5}});
  const Json answer = page.last("probed");
  EXPECT_NEAR(answer["distance"].get<double>(), 2.0, 5e-3);
  EXPECT_NEAR(answer["point"][0].get<double>(), 0.5, 5e-3);
}

TEST_F(Scene, AReportOfABoxAtRestNamesItsWeightAndWhoCarriesIt) {
  open(box_on_floor);
  page.send({{"type", "step"}, {"count", 20}});
  page.send({{"type", "inspect"}, {"body", 1}});
  const Json report = page.last("inspected");
  const double weight = 1000 * 9.80665;
  EXPECT_NEAR(report["weight"].get<double>(), weight, 0.02);
  ASSERT_EQ(report["contacts"].size(), 1u);
  EXPECT_EQ(report["contacts"][0]["with"], "floor");
  EXPECT_NEAR(report["contacts"][0]["impulse"].get<double>() * 60, weight, 0.01 * weight) << "the floor bears it";
  EXPECT_EQ(report["contacts"][0]["points"], 4);
  EXPECT_EQ(report["awake"], true);
  page.send({{"type", "step"}, {"count", 120}});
  advance();
  EXPECT_EQ(page.last("inspected")["awake"], false);
  EXPECT_NE(page.last("inspected")["why"].get<std::string>().find("asleep"), std::string::npos);
  page.send({{"type", "inspect"}, {"body", 77}});
  EXPECT_EQ(page.last("inspected")["body"], -1);
}

TEST_F(Scene, ABodyThrownInFallsAndAWrongOneIsRefused) {
  open(box_on_floor);
  page.send({{"type", "spawn"},
             {"form", "ball"},
             {"size", 0.25},
             {"density", 500},
             {"position", {3, 4, 0}},
             {"velocity", {0, 0, 0}}});
  const Json added = page.last("bodies")["add"];
  ASSERT_EQ(added.size(), 1u);
  EXPECT_EQ(added[0]["shapes"][0]["kind"], "sphere");
  page.send({{"type", "step"}, {"count", 30}});
  advance();
  const auto& bodies = page.frames.back().bodies;
  ASSERT_FALSE(bodies.empty());
  EXPECT_NEAR(bodies.back().position.y, 4 - 0.5 * 9.80665 * 0.25, 1e-3) << "half a second of free fall";
  for (const Json& wrong : {Json{{"form", "cube"}}, Json{{"size", 0}}, Json{{"density", -1}}}) {
    Json message = {{"type", "spawn"}, {"form", "ball"},        {"size", 0.25},
                    {"density", 500},  {"position", {3, 4, 0}}, {"velocity", {0, 0, 0}}};
    message.update(wrong);
    const int before = page.count("error");
    page.send(message);
    EXPECT_EQ(page.count("error"), before + 1) << message;
  }
}

TEST_F(Scene, EveryLayerDrawsAndUnknownOnesAreNamed) {
  open(box_on_floor);
  page.send({{"type", "step"}, {"count", 1}});
  advance();
  const std::size_t plain = page.frames.back().lines;
  for (const DebugLayer& layer : debug_layers) {
    // Nothing to show in this scene:
    if (layer.bit & (layer_joints | layer_velocities | layer_effectors | layer_water)) continue;
    page.send({{"type", "draw"}, {"layers", {layer.name}}});
    advance();
    EXPECT_GT(page.frames.back().lines, plain) << layer.name;
  }
  page.send({{"type", "draw"}, {"layers", {"ghosts"}}});
  EXPECT_NE(page.last("error").dump().find("contacts"), std::string::npos);
  page.send({{"type", "draw"}, {"layers", Json::array()}});
  advance();
  EXPECT_EQ(page.frames.back().lines, plain);
}

TEST(Layers, ForcesAreToldApartByEffector) {
  rigid::World3 world(rigid::WorldDef<rigid::Dim3>{});
  rigid::BodyDef<rigid::Dim3> body;
  body.linear_velocity = {3, 0, 0};
  const rigid::BodyId box = *world.create_body(body);
  ASSERT_TRUE(world.add_shape(box, geometry::Box{{0.5f, 0.5f, 0.5f}}, {.density = 500}).ok());
  rigid::Thrust<rigid::Dim3> thrust;
  thrust.body = box;
  thrust.force = {0, 0, 120};
  ASSERT_TRUE(world.add_effector(thrust).ok());
  rigid::LinearDrag<rigid::Dim3> drag;
  drag.body = box;
  drag.coefficient = 10;
  ASSERT_TRUE(world.add_effector(drag).ok());
  rigid::Buoyancy<rigid::Dim3> water;
  water.density = 1000;
  water.level = 0;
  ASSERT_TRUE(world.add_effector(water).ok());
  const std::uint64_t before = world.state_hash();
  EffectorForces<rigid::Dim3> forces;
  std::vector<Line> lines;
  forces.lines(world, 1.0f / 60, 10, lines);
  EXPECT_EQ(world.state_hash(), before);
  EXPECT_EQ(lines.size(), 3u) << "one arrow of three lines: beside the weight the others are too short to be seen";
  std::map<std::string, double> found;
  for (const LegendEntry& entry : forces.legend()) {
    const std::size_t comma = entry.label.find(", up to ");
    ASSERT_NE(comma, std::string::npos) << entry.label;
    found[entry.label.substr(0, comma)] = std::stod(entry.label.substr(comma + 8));
  }
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found["thrust"], 120, 0.5);
  EXPECT_NEAR(found["linear drag"], 30, 0.5) << "10 N·s/m at 3 m/s";
  // Half of a cubic metre is under water at mid-step, but for what it sinks in 1/120 s.
  EXPECT_NEAR(found["buoyancy"], 1000 * 9.80665 * 0.5, 20);
}

TEST(Layers, WhatIsUnderWaterIsCutAtTheSurface) {
  rigid::World3 world(rigid::WorldDef<rigid::Dim3>{});
  rigid::BodyDef<rigid::Dim3> body;
  body.position = {5, 0.25, 0};  // a quarter of it under water
  const rigid::BodyId box = *world.create_body(body);
  ASSERT_TRUE(world.add_shape(box, geometry::Box{{0.5f, 0.5f, 0.5f}}, {.density = 500}).ok());
  rigid::Buoyancy<rigid::Dim3> water;
  water.density = 1000;
  ASSERT_TRUE(world.add_effector(water).ok());
  std::vector<Line> lines;
  debug_lines(world, layer_water, 1.0f / 60, 10, lines);
  ASSERT_FALSE(lines.empty());
  double around = 0, lowest = 1;
  math::Vec3d lift{};
  for (const Line& line : lines) {
    lowest = std::min({lowest, line.a.y, line.b.y});
    if (line.rgba == 0x7fe3ffff) {
      EXPECT_NEAR(line.a.y, 0, 1e-6);
      EXPECT_NEAR(line.b.y, 0, 1e-6);
      around += math::distance(line.a, line.b);
    } else if (line.rgba == 0x00a6c7ff && line.b.y - line.a.y > 0.2) {
      lift = line.a;
    }
  }
  EXPECT_NEAR(around, 4, 1e-5) << "the waterline of a cube of 1 m";
  EXPECT_NEAR(lowest, -0.25, 0.2);
  EXPECT_NEAR(lift.x, 5, 1e-6) << "from the centre of what is wet";
  EXPECT_NEAR(lift.y, -0.125, 1e-6);
  rigid::World2 flat(rigid::WorldDef<rigid::Dim2>{});
  rigid::BodyDef<rigid::Dim2> ball;
  ASSERT_TRUE(flat.add_shape(*flat.create_body(ball), geometry::Circle{1}, {.density = 500}).ok());
  ASSERT_TRUE(flat.add_effector(rigid::Buoyancy<rigid::Dim2>{}).ok());
  lines.clear();
  debug_lines(flat, layer_water, 1.0f / 60, 10, lines);
  around = 0;
  for (const Line& line : lines)
    if (line.rgba == 0x7fe3ffff) around += math::distance(line.a, line.b);
  EXPECT_NEAR(around, 2, 1e-3);
}

TEST(Layers, AJointApartIsMarkedLargerAndRedder) {
  rigid::World3 world(rigid::WorldDef<rigid::Dim3>{});
  rigid::BodyDef<rigid::Dim3> body;
  const rigid::BodyId a = *world.create_body(body);
  ASSERT_TRUE(world.add_shape(a, geometry::Sphere{0.1f}).ok());
  rigid::BallJointDef<rigid::Dim3> joint;
  joint.body_b = a;
  const rigid::JointId id = *world.create_joint(joint);
  const auto widest = [&] {
    std::vector<Line> lines;
    debug_lines(world, layer_errors, 1.0f / 60, 10, lines);
    double most = 0;
    for (const Line& line : lines) most = std::max(most, math::distance(line.a, line.b));
    return most;
  };
  const double small = widest();
  EXPECT_GT(small, 0);
  ASSERT_TRUE(world.set_pose(a, {0.05, 0, 0}, {}).ok());
  EXPECT_NEAR(world.joint_state(id)->linear_error, 0.05, 1e-6);
  EXPECT_GT(widest(), 3 * small);
}

TEST_F(Scene, ThePastIsShownAndGoneOnFrom) {
  open(box_on_floor);
  page.send({{"type", "step"}, {"count", 90}});
  page.send({{"type", "seek"}, {"step", 45}});
  Json status = page.last("status");
  EXPECT_EQ(status["step"], 45);
  EXPECT_EQ(status["first"], 0);
  EXPECT_EQ(status["last"], 90);
  advance();
  EXPECT_EQ(page.frames.back().step, 45u);
  EXPECT_TRUE(page.frames.back().key);
  page.send({{"type", "step"}, {"count", 1}});
  EXPECT_EQ(page.last("status")["last"], 46);
  page.send({{"type", "seek"}, {"step", 1e9}});
  EXPECT_EQ(page.last("status")["step"], 46);
  page.send({{"type", "seek"}, {"step", -1}});
  EXPECT_NE(page.last("error").dump().find("step"), std::string::npos);
}

}  // namespace
}  // namespace carom::host::test
