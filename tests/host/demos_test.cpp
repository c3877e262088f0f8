// What demos and scenes show: their expectations, ropes as lines, loops.
#include "apps/host/registry.h"
#include "apps/host/scene_demo.h"
#include "carom/sports/flight.h"
#include "carom/sports/presets.h"
#include "tests/host/client.h"

namespace carom::host::test {
namespace {

/// Its world is a scene file that a page shows and edits: read back, it is the same world.
void expect_scene_file(Simulation& simulation) {
  const core::Result<std::string> text = simulation.scene_file();
  ASSERT_TRUE(text.ok()) << text.error().message;
  core::Result<scene::Scene> scene = scene::parse_scene(*text, "written.json");
  ASSERT_TRUE(scene.ok()) << scene.error().message;
  std::unique_ptr<Demo> again = make_scene_demo(std::move(scene).value(), "written.json");
  Demo& opener = *again;
  auto read = opener.open(std::move(again), {}, {});
  ASSERT_TRUE(read.ok()) << read.error().message;
  const auto same = [&](const auto& found, const auto& wanted) {
    // A joint to the world itself becomes one to a fixed body, which is one more.
    const bool joined = text->find("\"body_a\": \"world\"") != std::string::npos;
    EXPECT_EQ(found.counters().bodies, wanted.counters().bodies + (joined ? 1 : 0));
    EXPECT_EQ(found.counters().joints, wanted.counters().joints);
    if (!joined) {
      EXPECT_EQ(found.state_hash(), wanted.state_hash());
    }
  };
  if (simulation.world2())
    same(*(*read)->world2(), *simulation.world2());
  else
    same(*(*read)->world3(), *simulation.world3());
}

class DemoExpectations : public testing::TestWithParam<std::string> {};

TEST_P(DemoExpectations, AreMetAfterTheDeclaredTimeAndItsWorldIsASceneFile) {
  std::unique_ptr<Demo> owner = make_demo(GetParam());
  Demo& demo = *owner;
  auto simulation = demo.open(std::move(owner), {}, {});
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  const Declaration& d = (*simulation)->declaration();
  EXPECT_EQ(d.dimension, (*simulation)->world2() ? 2 : 3);
  for (const Parameter& p : d.parameters) {
    if (p.choices.empty()) continue;
    EXPECT_EQ(p.maximum - p.minimum, double(p.choices.size()) - 1) << p.name;
    EXPECT_EQ(p.step, 1) << p.name;
  }
  int step = 0;
  for (; (*simulation)->time() + 0.5 * d.dt < d.duration; ++step) {
    if (step == 10) expect_scene_file(**simulation);  // here, because some demos take seconds to open
    if (HasFatalFailure()) return;
    const core::Status status = (*simulation)->step();
    ASSERT_TRUE(status.ok()) << status.error().message;
  }
  EXPECT_GT(step, 10);
  std::vector<Expectation> expectations;
  (*simulation)->expectations(expectations);
  EXPECT_FALSE(expectations.empty()) << "a demo says what must come out";
  for (const Expectation& e : expectations)
    EXPECT_TRUE(e.passed()) << e.name << ": found " << e.found << ' ' << e.unit << ", expected " << e.expected << " ± "
                            << e.tolerance << " (" << e.source << ')';
}
INSTANTIATE_TEST_SUITE_P(Demos, DemoExpectations, testing::ValuesIn(demo_ids()), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

// What a choice on a page brings must be met as well: a curve, a moving gun, a burst in the air, a third link.
struct Variant {
  const char* demo;
  std::vector<std::pair<std::string, double>> values;
  const char* expected;  ///< one that only this choice has, or nothing
};
class DemoVariants : public testing::TestWithParam<Variant> {};

TEST_P(DemoVariants, MeetTheirExpectations) {
  std::unique_ptr<Demo> owner = make_demo(GetParam().demo);
  Demo& demo = *owner;
  std::vector<double> values;
  std::size_t set = 0;
  for (const Parameter& p : demo.declaration().parameters) {
    values.push_back(p.value);
    for (const auto& [name, value] : GetParam().values)
      if (name == p.name) values.back() = value, ++set;
  }
  ASSERT_EQ(set, GetParam().values.size());
  auto simulation = demo.open(std::move(owner), values, {});
  ASSERT_TRUE(simulation.ok()) << simulation.error().message;
  while ((*simulation)->time() + 0.5 * (*simulation)->declaration().dt < (*simulation)->declaration().duration)
    ASSERT_TRUE((*simulation)->step().ok());
  std::vector<Expectation> expectations;
  (*simulation)->expectations(expectations);
  bool there = false;
  for (const Expectation& e : expectations) {
    there = there || e.name == GetParam().expected;
    EXPECT_TRUE(e.passed()) << e.name << ": found " << e.found << ' ' << e.unit << ", expected " << e.expected << " ± "
                            << e.tolerance << " (" << e.source << ')';
  }
  EXPECT_TRUE(there) << GetParam().expected;
}
INSTANTIATE_TEST_SUITE_P(
    Demos, DemoVariants,
    testing::Values(
        Variant{"turret", {{"own", 25}}, "hits among them"},
        Variant{"turret", {{"own", 40}, {"speed", 160}, {"pace", 60}}, "hits among them"},
        Variant{"blast-field", {{"air", 1}}, "impulse at the open gauge"},
        Variant{"blast-field", {{"air", 2}}, "height of the Mach stem at the open gauge"},
        Variant{"blast-field", {{"air", 2}, {"burst", 6}}, "height of the Mach stem at the open gauge"},
        Variant{"rocket-launch", {{"motor", 0}}, "the upper stage goes on"},
        Variant{"rocket-launch", {{"motor", 1}}, "the upper stage goes on"},
        Variant{"rocket-launch", {{"motor", 3}}, "the upper stage goes on"},
        Variant{"rocket-launch", {{"motor", 3}, {"stages", 1}}, "into the wind"},
        Variant{"golf-swing", {{"links", 3}}, "energy gained"},
        Variant{
            "shooting-range", {{"distance", 400}, {"zero", 400}}, "greatest difference of shares and probabilities"},
        Variant{"pool-table",
                {{"table", 5}, {"direction", 7.35 * math::pi / 180}, {"speed", 5}, {"side", 0.4}, {"height", 0}},
                "cushions before the second"}),
    [](const auto& info) {
      std::string name = std::string(info.param.demo) + '_' + std::to_string(info.index);
      for (char& c : name)
        if (c == '-') c = '_';
      return name;
    });

// At 300 m/s nine bullets of nine shapes fly nine ways, each as the library's flight says, and under its own name.
TEST(TrajectoryLab, HasAllDragCurves) {
  std::vector<double> ranges;
  for (int k = 0; k < 9; ++k) {
    std::unique_ptr<Demo> owner = make_demo("trajectory-lab");
    Demo& demo = *owner;
    std::vector<double> values;
    for (const Parameter& p : demo.declaration().parameters)
      values.push_back(p.name == "speed" || p.name == "terminal" ? 300 : p.name == "curve" ? k : p.value);
    auto simulation = demo.open(std::move(owner), values, {});
    ASSERT_TRUE(simulation.ok()) << simulation.error().message;
    const char* const names[] = {"G1", "G2", "G5", "G6", "G7", "G8", "GI", "GS", "RA4"};
    for (int plot = 0; plot < 2; ++plot)
      EXPECT_EQ((*simulation)->declaration().plots[std::size_t(plot)].series[3].name, names[k]);
    std::vector<Expectation> expectations;
    (*simulation)->expectations(expectations);
    ASSERT_EQ(expectations.size(), 5u);
    for (const Expectation& e : expectations)
      EXPECT_TRUE(e.passed()) << e.name << ": " << e.found << " of " << e.expected << " ± " << e.tolerance;
    for (const double other : ranges) EXPECT_GT(std::abs(expectations[4].found - other), 1e-3) << names[k];
    ranges.push_back(expectations[4].found);
  }
}

// The trajectory lab throws each of its ten balls of sports where the model says that it lands, with spin (which the
// lab keeps) and without it in wind.
TEST(TrajectoryLab, ThrowsTheBallsOfSports) {
  const char* const balls[] = {"golf",       "baseball", "soccer",  "tennis", "table_tennis",
                               "basketball", "cricket",  "bowling", "arrow",  "shuttlecock"};
  for (int k = 0; k < 10; ++k) {
    std::unique_ptr<Demo> owner = make_demo("trajectory-lab");
    Demo& demo = *owner;
    std::vector<double> values;
    for (const Parameter& p : demo.declaration().parameters) {
      double value = p.value;
      if (p.name == "speed") value = 30;
      if (p.name == "elevation") value = .6;
      if (p.name == "spin") value = 60;
      if (p.name == "wind") value = -4;
      if (p.name == "cross") value = 2;
      if (p.name == "ball") value = k + 1;
      values.push_back(value);
    }
    auto simulation = demo.open(std::move(owner), values, {});
    ASSERT_TRUE(simulation.ok()) << simulation.error().message;
    while ((*simulation)->time() < 8) ASSERT_TRUE((*simulation)->step().ok());
    std::vector<BodyPlace> places;
    (*simulation)->places(places);
    ASSERT_EQ(places.size(), 6u);
    sports::Ball ball = *sports::ball_preset(balls[k]);
    ball.spin_damping = 0;
    sports::Conditions wind;
    wind.wind = environment::WindColumn(math::Vec3d{-4, 0, 2});
    const auto spun = sports::fly(ball, {}, sports::launch_state({.speed = 30, .elevation = .6, .spin = 60}));
    const auto blown = sports::fly(ball, wind, sports::launch_state({.speed = 30, .elevation = .6}));
    ASSERT_TRUE(spun && blown);
    EXPECT_LT(math::length(places[4].position - spun->end().position), .02) << balls[k];
    EXPECT_LT(math::length(places[5].position - blown->end().position), .02) << balls[k];
  }
}

HostOptions with_scenes() {
  HostOptions options;
  options.parse_scene = [](std::string_view name, std::string_view text) -> core::Result<std::unique_ptr<Demo>> {
    core::Result<scene::Scene> scene = scene::parse_scene(text, name);
    if (!scene.ok()) return scene.error();
    return make_scene_demo(std::move(scene).value(), std::string(name));
  };
  return options;
}

TEST(SceneDemo, RopesAreLinesAndPathsStayBehind) {
  Page page(with_scenes());
  page.hello();
  page.send({{"type", "open_scene"}, {"name", "rope.json"}, {"text", R"({"bodies": [{"name": "hook", "type": "fixed"},
                {"name": "ball", "trail": true, "color": "#c0402080", "position": ["1 m", 0, 0],
                 "shape": {"type": "sphere", "radius": "0.1 m"}}],
               "joints": [{"type": "distance", "body_a": "hook", "body_b": "ball", "length": "1 m", "frame_a": {},
                           "frame_b": {}}]})"}});
  page.advance(0);
  ASSERT_FALSE(page.frames.empty()) << page.last("error").dump();
  EXPECT_EQ(page.frames.back().lines, 1u) << "the rope, before anything has moved";
  page.ack();
  page.run_for(0.5);
  EXPECT_GT(page.frames.back().lines, 4u) << "the rope and the path";
  const Json ball = page.last("scene")["bodies"][1]["shapes"][0];
  EXPECT_EQ(ball["color"], "#c04020");
  EXPECT_NEAR(ball["opacity"].get<double>(), 128 / 255.0, 1e-6);
}

TEST(SceneDemo, LoopsBeginAnewAfterAMoment) {
  Page page(with_scenes());
  page.hello();
  const auto open = [&](const char* loop) {
    page.send({{"type", "open_scene"},
               {"name", "loop.json"},
               {"text", std::string(R"({"duration": "0.5 s", "loop": )") + loop +
                            R"(, "bodies": [{"name": "ball", "velocity": [1, 0, 0], "shape": {"type": "sphere"}}]})"}});
  };
  open("true");
  const int before = page.count("scene");
  page.run_for(1.5);
  EXPECT_EQ(page.count("scene"), before);
  EXPECT_NEAR(page.host.simulation()->time(), 0.5, 1e-6) << "its last picture stays";
  page.run_for(0.7);
  EXPECT_EQ(page.count("scene"), before + 1);
  EXPECT_LT(page.host.simulation()->time(), 0.4);
  open("false");
  page.run_for(1.5);
  EXPECT_NEAR(page.host.simulation()->time(), 1.5, 0.05);
}

TEST(SceneDemo, AFlightIsDrawnOnItsWholeWay) {
  Page page(with_scenes());
  page.hello();
  page.send({{"type", "open_scene"},
             {"name", "drop.json"},
             {"text", R"({"kind": "flight", "duration": "10 s", "step": "0.01 s", "flight": {"earth": {"model": "flat"},
                "vehicle": {"mass": "2 kg", "inertia": [1, 2, 2.5]}, "initial": {"altitude": "3 km",
                "rates": ["10 deg/s", 0, 0]}}})"}});
  page.advance(0);
  ASSERT_FALSE(page.frames.empty()) << page.last("error").dump();
  const Json opened = page.last("opened"), shape = page.last("scene")["bodies"][0]["shapes"][0];
  const Frame::Body start = page.body(0);
  page.ack();
  page.run_for(5);
  const Frame::Body now = page.body(0);
  EXPECT_NEAR(now.position.y - start.position.y, -0.5 * 9.80665 * 25, 3);
  EXPECT_NE(now.rotation[0], start.rotation[0]) << "it rolls";
  EXPECT_NEAR(opened["camera"]["target"][1].get<double>(), -0.25 * 9.80665 * 100, 5) << "the middle of the way";
  // I_x : I_y : I_z = 1 : 2 : 2.5 of a box whose axes are forward, starboard, down: a² : c² : b² = 3.5 : 1.5 : 0.5.
  const double x = shape["half_extents"][0], y = shape["half_extents"][1], z = shape["half_extents"][2];
  EXPECT_NEAR(z * z / (x * x), 1.5 / 3.5, 1e-4);
  EXPECT_NEAR(y * y / (x * x), 0.5 / 3.5, 1e-4);
}

// The lightest scene of each suite; the others are the same code with more bodies.
class Stress : public testing::TestWithParam<const char*> {};

TEST_P(Stress, RunsLikeADemo) {
  Page page;
  page.open(GetParam());
  ASSERT_TRUE(page.last("opened").is_object()) << page.last("error").dump();
  EXPECT_GT(page.last("scene")["bodies"].size(), 50u);
  page.run_for(0.5);
  EXPECT_TRUE(page.last("error").is_null()) << page.last("error").dump();
  EXPECT_GT(page.frames.back().step, 3u);
  for (const auto& [id, body] : page.bodies) EXPECT_TRUE(math::is_finite(body.position)) << id;
}
INSTANTIATE_TEST_SUITE_P(Suites, Stress,
                         testing::Values("common-twenty-pyramids", "box3d-wide-pyramid", "box2d-tumbler",
                                         "jolt-pyramid"));

TEST(StressScenes, BodiesThatComeAndGoAreShown) {
  std::unique_ptr<Demo> owner = make_demo("box2d-rain");
  ASSERT_TRUE(owner);
  Demo& demo = *owner;
  auto simulation = demo.open(std::move(owner), {}, {});
  ASSERT_TRUE(simulation.ok());
  std::vector<std::uint32_t> added, removed;
  (*simulation)->take_changes(added, removed);
  const std::size_t before = added.size();
  std::size_t shown = before;
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE((*simulation)->step().ok());
    if (!(*simulation)->take_changes(added, removed)) continue;
    shown += added.size();
    shown -= removed.size();
  }
  EXPECT_EQ(shown, (*simulation)->body_count());
  EXPECT_EQ(int((*simulation)->body_count()), (*simulation)->counters().bodies);
  EXPECT_GT(shown, before) << "ragdolls have come";
}

}  // namespace
}  // namespace carom::host::test
