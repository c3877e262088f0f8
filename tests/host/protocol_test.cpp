// The conversation of docs/protocol.md, with a page that checks every byte.
#include <cmath>

#include "apps/host/registry.h"
#include "apps/host/stress_demo.h"
#include "tests/host/client.h"

namespace carom::host::test {
namespace {

TEST(Protocol, HelloIsAnsweredByEveryDemo) {
  Page page;
  page.hello();
  const Json welcome = page.last("welcome");
  ASSERT_TRUE(welcome.is_object());
  EXPECT_EQ(welcome["protocol"], 1);
  EXPECT_EQ(welcome["engine"], "native");
  EXPECT_EQ(welcome["demos"].size(), demos().size() + stress_demos().size());
  for (const Json& demo : welcome["demos"])
    for (const char* field : {"id", "title", "summary", "group", "chapter", "dimension"})
      EXPECT_TRUE(demo.contains(field));
}

TEST(Protocol, EveryDemoIsFoundByTheIdThatItDeclares) {
  for (const DemoEntry& demo : demos()) EXPECT_EQ(demo.make()->declaration().id, demo.id);
  for (const std::unique_ptr<Demo>& demo : stress_demos()) {
    const std::string id = demo->declaration().id;
    ASSERT_NE(make_demo(id), nullptr) << id;
    EXPECT_EQ(make_demo(id)->declaration().id, id);
  }
  Page page;
  page.hello();
  page.send({{"type", "open"}, {"demo", "piramids"}});
  EXPECT_EQ(page.last("error")["message"], "no demo \"piramids\"; did you mean \"pyramids\"?");
}

TEST(Protocol, AMenuMadeBeforeIsSaidAsItIs) {
  Declaration scene;
  scene.id = "scene:one";
  scene.title = "a \"scene\" of its own";
  const auto load = []() -> core::Result<std::unique_ptr<Demo>> { return make_demo("pyramids"); };
  HostOptions first;
  first.scenes.push_back({scene, load, {}});
  Page asked(std::move(first));
  asked.hello();
  HostOptions second;
  second.menu = asked.last("welcome")["demos"].dump();
  scene = {};
  scene.id = "scene:one";
  second.scenes.push_back({scene, load, {}});
  Page told(std::move(second));
  told.hello();
  EXPECT_EQ(told.last("welcome"), asked.last("welcome"));
  for (const char* id : {"rolling", "scene:one"}) {
    told.send({{"type", "open"}, {"demo", id}});
    EXPECT_EQ(told.count("error"), 0) << told.last("error");
  }
  EXPECT_EQ(told.count("opened"), 2);
}

TEST(Protocol, NothingBeforeHello) {
  Page page;
  page.send({{"type", "open"}, {"demo", "pyramids"}});
  EXPECT_EQ(page.count("opened"), 0);
  EXPECT_NE(page.last("error")["message"].get<std::string>().find("hello"), std::string::npos);
}

TEST(Protocol, AnotherVersionIsRefused) {
  Page page;
  page.send({{"type", "hello"}, {"protocol", 2}});
  EXPECT_EQ(page.count("welcome"), 0);
  EXPECT_EQ(page.count("error"), 1);
}

class EveryDemo : public testing::TestWithParam<std::string> {};

TEST_P(EveryDemo, OpensWithKeyFrameRunsAndStaysFinite) {
  Page page;
  page.open(GetParam());
  ASSERT_EQ(page.count("error"), 0) << page.last("error");
  const Json opened = page.last("opened"), scene = page.last("scene");
  ASSERT_TRUE(opened.is_object());
  ASSERT_TRUE(scene.is_object());
  EXPECT_GT(opened["text"].get<std::string>().size(), 100u);
  for (const Json& p : opened["parameters"]) {
    EXPECT_LE(p["minimum"].get<double>(), p["value"].get<double>()) << p;
    EXPECT_GE(p["maximum"].get<double>(), p["value"].get<double>()) << p;
    EXPECT_FALSE(p["label"].get<std::string>().empty());
  }
  ASSERT_FALSE(page.frames.empty());
  EXPECT_TRUE(page.frames.front().key);
  EXPECT_TRUE(page.frames.front().has_stats);
  EXPECT_EQ(page.frames.front().bodies.size(), scene["bodies"].size());
  EXPECT_EQ(page.frames.front().dimension, opened["dimension"].get<int>());
  page.run_for(1.0);
  EXPECT_EQ(page.count("error"), 0) << page.last("error");
  // Steps, not time: some demos show a blow in slow motion.
  EXPECT_NEAR(page.frames.back().step * opened["dt"].get<double>(), 1.0, 0.05);
  for (const auto& [id, body] : page.bodies) {
    EXPECT_TRUE(math::is_finite(body.position)) << id;
    double norm = 0;
    for (const double q : body.rotation) norm += q * q;
    EXPECT_NEAR(norm, 1, 1e-3) << id;
  }
  for (const Frame& frame : page.frames)
    for (const Sample& s : frame.samples) {
      ASSERT_LT(std::size_t(s.plot), opened["plots"].size());
      const Json& series = opened["plots"][std::size_t(s.plot)]["series"];
      ASSERT_LT(std::size_t(s.series), series.size());
      EXPECT_FALSE(series[std::size_t(s.series)].contains("points")) << "a fixed curve was fed";
    }
}

INSTANTIATE_TEST_SUITE_P(Demos, EveryDemo, testing::ValuesIn(demo_ids()), [](const auto& info) {
  std::string name = info.param;
  for (char& c : name)
    if (c == '-') c = '_';
  return name;
});

TEST(Protocol, SameInputsSameBits) {
  std::uint64_t hash[2] = {};
  for (const int threads : {1, 2}) {
    HostOptions options;
    options.threads = threads;
    Page page(options);
    page.open("wrecking-ball");
    page.run_for(3.0);
    page.send({{"type", "pause"}});
    page.send({{"type", "step"}, {"count", 1}});
    page.advance();
    ASSERT_TRUE(page.frames.back().has_stats);
    hash[threads - 1] = page.frames.back().hash;
  }
  EXPECT_NE(hash[0], 0u);
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(Protocol, NoThirdFrameWithoutAcknowledgement) {
  Page page;
  page.open("pyramids");
  const std::size_t before = page.frames.size();
  for (int i = 0; i < 60; ++i) page.advance();
  EXPECT_EQ(page.frames.size(), before + 1);  // the key frame is one of the two that may be under way
  page.ack();
  for (int i = 0; i < 60; ++i) page.advance();
  EXPECT_EQ(page.frames.size(), before + 3);
  EXPECT_NEAR(page.frames.back().time, 1.0, 0.1) << "the simulation must not wait for the page";
}

TEST(Protocol, AcknowledgingTheFutureOrThePastHelpsNothing) {
  Page page;
  page.open("pyramids");
  page.send({{"type", "ack"}, {"sequence", 4000000000u}});
  for (int i = 0; i < 30; ++i) page.advance();
  const std::size_t frames = page.frames.size();
  page.send({{"type", "ack"}, {"sequence", 0}});
  for (int i = 0; i < 30; ++i) page.advance();
  EXPECT_EQ(page.frames.size(), frames);
}

TEST(Protocol, PauseStopsTimeAndStepAdvancesIt) {
  Page page;
  page.open("race-ship");
  page.run_for(0.5);
  page.send({{"type", "pause"}});
  EXPECT_EQ(page.last("status")["running"], false);
  const std::uint32_t step = page.frames.back().step;
  page.run_for(0.5);
  EXPECT_EQ(page.frames.back().step, step);
  page.send({{"type", "step"}, {"count", 25}});
  page.advance();
  EXPECT_EQ(page.frames.back().step, step + 25);
  page.send({{"type", "run"}});
  page.run_for(0.5);
  EXPECT_GT(page.frames.back().step, step + 40);
}

TEST(Protocol, StepWhileRunningIsAnError) {
  Page page;
  page.open("race-ship");
  page.send({{"type", "step"}, {"count", 1}});
  EXPECT_EQ(page.count("error"), 1);
}

TEST(Protocol, SpeedScalesTime) {
  Page page;
  page.open("race-ship");
  page.send({{"type", "speed"}, {"value", 0.25}});
  page.run_for(2.0);
  EXPECT_NEAR(page.frames.back().time, 0.5, 0.05);
  page.send({{"type", "speed"}, {"value", 4}});
  page.run_for(1.0);
  EXPECT_NEAR(page.frames.back().time, 4.5, 0.3);
  page.send({{"type", "speed"}, {"value", 100}});
  EXPECT_EQ(page.count("error"), 1);
}

TEST(Protocol, AParameterRestartsTheDemoAndALiveOneDoesNot) {
  Page page;
  page.open("pyramids");
  page.run_for(0.5);
  page.send({{"type", "set"}, {"name", "ball_mass"}, {"value", 9000}});
  page.run_for(0.1);
  EXPECT_GT(page.frames.back().time, 0.4);
  EXPECT_EQ(page.last("values")["values"]["ball_mass"], 9000);
  for (int n = 2; n <= 5; ++n) page.send({{"type", "set"}, {"name", "pyramids"}, {"value", n}});
  page.run_for(0.1);
  EXPECT_LT(page.frames.back().time, 0.3);
  EXPECT_EQ(page.count("scene"), 2) << "five moves of a slider are one restart";
  EXPECT_EQ(page.last("scene")["bodies"].size(), 5u * 55 + 1);
}

TEST(Protocol, AValueOutOfRangeIsRefusedWithItsRange) {
  Page page;
  page.open("pyramids");
  page.send({{"type", "set"}, {"name", "friction"}, {"value", 50}});
  EXPECT_NE(page.last("error")["message"].get<std::string>().find("0.1 to 1.2"), std::string::npos);
  page.send({{"type", "set"}, {"name", "fricton"}, {"value", 0.5}});
  EXPECT_NE(page.last("error")["message"].get<std::string>().find("\"friction\""), std::string::npos);
}

TEST(Protocol, OpenTakesParametersAndABadOneKeepsTheOldDemo) {
  Page page;
  page.open("pyramids", {{"pyramids", 2}, {"base", 4}});
  EXPECT_EQ(page.last("scene")["bodies"].size(), 2u * 10 + 1);
  page.send({{"type", "open"}, {"demo", "pyramids"}, {"parameters", {{"base", "many"}}}});
  page.send({{"type", "open"}, {"demo", "pyramidz"}});
  EXPECT_EQ(page.count("error"), 2);
  EXPECT_NE(page.last("error")["message"].get<std::string>().find("\"pyramids\""), std::string::npos);
  page.run_for(0.1);
  EXPECT_EQ(page.bodies.size(), 2u * 10 + 1);
}

TEST(Protocol, InputsThrowBallsAndBodiesComeAndGo) {
  Page page;
  page.open("pyramids", {{"pyramids", 1}});
  const std::size_t bodies = page.bodies.size();
  for (int i = 0; i < 14; ++i) {
    page.send({{"type", "input"}, {"action", "throw"}, {"value", 1}});
    page.send({{"type", "input"}, {"action", "throw"}, {"value", 0}});
    page.run_for(0.1);
  }
  EXPECT_GE(page.count("bodies"), 14);
  std::size_t added = 0, removed = 0;
  for (const Json& t : page.texts) {
    if (t["type"] != "bodies") continue;
    added += t["add"].size();
    removed += t["remove"].size();
  }
  EXPECT_EQ(added, 14u);
  EXPECT_EQ(removed, 2u) << "no more than twelve balls";
  EXPECT_GE(page.bodies.size(), bodies + 12);
}

TEST(Protocol, DrivingTheHovercraftMovesIt) {
  Page page;
  page.open("hovercraft");
  page.send({{"type", "input"}, {"action", "port"}, {"value", 1}});
  const Frame::Body before = page.body(0);
  page.run_for(1.0);
  const Frame::Body after = page.body(0);
  EXPECT_GT(std::fabs(after.rotation[2] - before.rotation[2]), 0.02) << "the bow thruster turns it";
  EXPECT_GT(after.rotation[2], 0) << "counterclockwise";
}

TEST(Protocol, KeyFramesComeAboutEveryTwoSeconds) {
  Page page;
  page.open("pyramids", {{"pyramids", 1}});
  page.run_for(9);
  int keys = 0;
  for (const Frame& f : page.frames) keys += f.key;
  EXPECT_GE(keys, 4);
  EXPECT_LE(keys, 7);
}

TEST(Protocol, WhatRestsIsNotSentAgain) {
  Page page;
  page.open("pyramids", {{"pyramids", 1}, {"base", 3}});
  page.run_for(4);
  EXPECT_TRUE(page.body(1).asleep);
  std::size_t sent = 0;
  const std::size_t first = page.frames.size();
  page.run_for(1);
  for (std::size_t i = first; i < page.frames.size(); ++i)
    if (!page.frames[i].key) sent += page.frames[i].bodies.size();
  EXPECT_EQ(sent, 0u);
}

}  // namespace
class Bare final : public StageBase {
 public:
  using StageBase::StageBase;
};

TEST(Drawn, PointsAreThinnedAndKeepTheirPlaces) {
  Declaration declaration;
  Bare stage(declaration, {});
  std::vector<math::Vec3f> many(150'000);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = {float(i), -1, 2};
  stage.points(many, 0.1f, 0xff0000ff);
  EXPECT_LE(stage.state.points.positions.size(), max_points);
  EXPECT_GT(stage.state.points.positions.size(), max_points / 2);
  EXPECT_TRUE(stage.state.status.ok());
  const std::string message = points_message(stage.state.points);
  EXPECT_EQ(test::decode_points(message), stage.state.points.positions.size());
  // The last point's x is the whole of the box, its radius the whole of the largest.
  std::uint16_t x, radius;
  std::memcpy(&x, message.data() + message.size() - 12, 2);
  std::memcpy(&radius, message.data() + message.size() - 6, 2);
  EXPECT_EQ(x, 65535);
  EXPECT_EQ(radius, 65535);
  const std::vector<float> radii(2);
  const std::vector<std::uint32_t> colors(3);
  stage.points(std::span(many).first(3), radii, colors);
  EXPECT_NE(stage.state.status.error().message.find("2 radii"), std::string::npos);
}

TEST(Drawn, ASurfaceTellsItsTrianglesOnceAndRefusesWrongOnes) {
  Declaration declaration;
  Bare stage(declaration, {});
  const int sheet = stage.add_surface({0, 1, 2, 2, 1, 3}, 0x80ff00ff);
  const std::vector<math::Vec3f> corners(4);
  stage.set_surface(sheet, corners);
  EXPECT_EQ(test::decode_surface(surface_message(0, stage.state.surfaces[0], true)), 2u);
  EXPECT_EQ(test::decode_surface(surface_message(0, stage.state.surfaces[0], false)), 0u);
  const std::uint32_t before = stage.state.surfaces[0].topology;
  stage.set_surface(sheet, corners, {0, 1, 2});
  EXPECT_NE(stage.state.surfaces[0].topology, before);
  EXPECT_TRUE(stage.state.status.ok());
  stage.set_surface(sheet, corners, {0, 1, 4});
  EXPECT_NE(stage.state.status.error().message.find("corner 4 of 4"), std::string::npos);
}

}  // namespace carom::host::test
