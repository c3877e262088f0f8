// Whatever a page sends, the host answers with an error or does it; it never falls over and never grows without bound.
#include <algorithm>
#include <cstring>
#include <random>

#include "tests/host/client.h"

namespace carom::host::test {
namespace {

TEST(Hostile, MalformedMessagesEachGetOneError) {
  Page page;
  page.open("pyramids", {{"pyramids", 1}});
  const std::vector<std::string> bad = {
      "",
      " ",
      "{",
      "[]",
      "null",
      "42",
      "\"run\"",
      "{}",
      "{\"type\":5}",
      "{\"type\":null}",
      "{\"type\":\"no such\"}",
      "{\"type\":\"set\"}",
      "{\"type\":\"set\",\"name\":7,\"value\":1}",
      "{\"type\":\"set\",\"name\":\"friction\",\"value\":\"x\"}",
      "{\"type\":\"set\",\"name\":\"friction\",\"value\":1e999}",
      "{\"type\":\"speed\"}",
      "{\"type\":\"speed\",\"value\":null}",
      "{\"type\":\"speed\",\"value\":0}",
      "{\"type\":\"speed\",\"value\":-1}",
      "{\"type\":\"step\",\"count\":0}",
      "{\"type\":\"step\",\"count\":1001}",
      "{\"type\":\"step\",\"count\":1.5}",
      "{\"type\":\"step\",\"count\":1,\"to\":-1}",
      "{\"type\":\"step\",\"count\":-1e300}",
      "{\"type\":\"grab\",\"pointer\":1}",
      "{\"type\":\"grab\",\"pointer\":1e40,\"origin\":[0,0,0],\"direction\":[0,0,1]}",
      "{\"type\":\"grab\",\"pointer\":1,\"origin\":[0,0],\"direction\":[0,0,1]}",
      "{\"type\":\"grab\",\"pointer\":1,\"origin\":[0,0,\"z\"],\"direction\":[0,0,1]}",
      "{\"type\":\"grab\",\"pointer\":1,\"origin\":[0,0,0],\"direction\":[0,0,0]}",
      "{\"type\":\"grab\",\"pointer\":1,\"origin\":[1e300,0,0],\"direction\":[0,0,1]}",
      "{\"type\":\"drag\",\"pointer\":1,\"target\":[1,2,3]}",
      "{\"type\":\"input\",\"action\":\"fly\",\"value\":1}",
      "{\"type\":\"input\",\"action\":\"throw\",\"value\":2}",
      "{\"type\":\"open\"}",
      "{\"type\":\"open\",\"demo\":[]}",
      "{\"type\":\"open\",\"demo\":\"pyramids\",\"parameters\":[]}",
      "{\"type\":\"open_scene\",\"name\":\"x\",\"text\":\"{}\"}",
      "{\"type\":\"ack\"}",
      "{\"type\":\"ack\",\"sequence\":-1}",
      "{\"type\":\"ack\",\"sequence\":0.5}",
      "{\"type\":\"release\"}",
      "\xff\xfe{\"type\":\"run\"}",
      "{\"type\":\"\xff\"}",
      std::string("{\"type\":\"run\"\0}", 15)};
  for (const std::string& text : bad) {
    const int before = page.count("error");
    page.raw(text);
    EXPECT_EQ(page.count("error"), before + 1) << text;
    EXPECT_FALSE(page.last("error")["message"].get<std::string>().empty());
  }
  const int errors = page.count("error");
  page.run_for(0.5);
  EXPECT_EQ(page.count("error"), errors);
  EXPECT_GT(page.frames.back().time, 0.4) << "and the simulation ran on";
}

TEST(Hostile, DeepNestingAndLongMessages) {
  Page page;
  page.hello();
  page.raw(std::string(200'000, '['));
  page.raw("{\"type\":" + std::string(100'000, '[') + std::string(100'000, ']') + "}");
  page.raw("{\"type\":\"" + std::string(1'000'000, 'x') + "\"}");
  page.raw(std::string(5 << 20, ' '));
  EXPECT_EQ(page.count("error"), 4);
  EXPECT_LT(page.last("error").dump().size(), 500u);
}

TEST(Hostile, BinaryMessagesAreRefused) {
  Page page;
  page.host.receive_binary("?");
  page.hello();
  EXPECT_EQ(page.count("error"), 1);
}

TEST(Hostile, APageThatNeverReadsIsBounded) {
  HostOptions options;
  options.max_outbox = 1 << 20;
  SimulationHost host(options);
  host.receive(R"({"type":"hello","protocol":1})");
  for (int i = 0; i < 2000; ++i) {
    host.receive(R"({"type":"open","demo":"collision-lab-3d"})");
    host.receive(R"({"type":"ack","sequence":)" + std::to_string(i) + "}");
    host.advance(1.0 / 60);
  }
  std::size_t bytes = 0;
  Message message;
  while (host.take(message)) bytes += message.data.size();
  EXPECT_LT(bytes, std::size_t(3) << 20);
}

TEST(Hostile, APageThatReadsAgainIsToldAllThatItMissed) {
  HostOptions options;
  options.max_outbox = 256 << 10;
  SimulationHost host(options);
  host.receive(R"({"type":"hello","protocol":1})");
  host.receive(R"({"type":"open","demo":"collision-lab-3d"})");
  // It reads nothing while the outbox fills.
  for (int i = 0; i < 500; ++i) {
    host.receive(R"({"type":"source"})");
    host.advance(1.0 / 60);
  }
  Message message;
  std::vector<std::string> said;
  int frames = 0;
  const auto read = [&] {
    while (host.take(message)) {
      if (message.text)
        said.push_back(Json::parse(message.data)["type"].get<std::string>());
      else if (message.data[0] == 2) {
        ++frames;
        std::uint32_t sequence = 0;
        std::memcpy(&sequence, message.data.data() + 4, 4);
        host.receive(R"({"type":"ack","sequence":)" + std::to_string(sequence) + "}");
      }
    }
  };
  read();
  said.clear();
  frames = 0;
  for (int i = 0; i < 60; ++i) {
    host.advance(1.0 / 60);
    read();
  }
  for (const char* type : {"opened", "values", "scene", "status"})
    EXPECT_EQ(std::count(said.begin(), said.end(), type), 1) << type;
  EXPECT_GT(frames, 30) << "what was read late was acknowledged all the same";
}

TEST(Hostile, TimeThatIsNotTime) {
  Page page;
  page.open("race-ship");
  for (const double t : {-1.0, 0.0, 1e300, 0.0 / 0.0, 1.0 / 0.0 * 1.0}) page.advance(t);
  EXPECT_EQ(page.count("error"), 0);
  page.ack();
  page.advance();
  EXPECT_LT(page.frames.back().time, 60) << "time that was lost is dropped, not simulated";
}

TEST(Hostile, RandomConversation) {
  // Messages with valid types and random fields, fixed seed: all must be survived.
  std::mt19937 random(7);
  const auto pick = [&](std::initializer_list<Json> list) { return *(list.begin() + random() % list.size()); };
  const auto number = [&]() -> Json {
    return pick({0, 1, -1, 0.5, 3, 1e9, -1e9, 1e308, "1", nullptr, Json::array(), 17, 2000000000, 1e-320});
  };
  Page page;
  page.hello();
  for (int i = 0; i < 4000; ++i) {
    const Json type = pick({"open", "set", "run", "pause", "restart", "step", "speed", "grab", "drag", "release",
                            "input", "ack", "hello"});
    Json m = {{"type", type}};
    m["demo"] = pick({"collision-lab-2d", "collision-lab-3d", "hovercraft", "hit-the-target", "none", 4});
    m["name"] = pick({"friction", "restitution", "speed", "alpha", "mass", "", 0});
    m["value"] = number();
    m["count"] = number();
    m["pointer"] = pick({0, 1, 2, "p", -5});
    m["origin"] = Json::array({number(), number(), number()});
    m["direction"] = Json::array({number(), number(), number()});
    m["target"] = Json::array({number(), number(), number()});
    m["action"] = pick({"fire", "throttle", "port", "again", "x"});
    m["sequence"] = number();
    m["protocol"] = pick({1, 1, 1, 2, "one"});
    page.send(m);
    if (i % 4 == 0) page.advance();
  }
  page.send({{"type", "open"}, {"demo", "race-ship"}});
  EXPECT_EQ(page.last("opened")["demo"], "race-ship");
}

}  // namespace
}  // namespace carom::host::test
