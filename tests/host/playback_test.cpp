// Recordings: made by a host, sent back to a host, shown frame by frame; damage and nonsense are named.
#include "tests/host/client.h"

namespace carom::host::test {
namespace {

/// As a page sends a file: in parts.
void upload(Page& page, const std::string& file, std::size_t part = 50'000) {
  for (std::size_t at = 0; at < file.size() || at == 0; at += part) {
    const bool last = at + part >= file.size();
    std::string message{file_message_kind, char(last), 0, 0};
    message += file.substr(at, part);
    page.host.receive_binary(message);
  }
  page.advance(0);
}

std::string recording_of(const std::string& demo, int steps) {
  Page page;
  page.open(demo);
  page.send({{"type", "pause"}});
  page.send({{"type", "record"}, {"on", true}});
  page.send({{"type", "step"}, {"count", steps}});
  page.send({{"type", "record"}, {"on", false}});
  EXPECT_EQ(page.files.size(), 1u);
  return page.files.empty() ? std::string() : page.files[0];
}

TEST(Playback, ShowsWhatWasRecordedAndAnyFrameOfIt) {
  const std::string file = recording_of("pyramids", 90);
  Page original;
  original.open("pyramids");
  original.send({{"type", "pause"}});
  original.send({{"type", "step"}, {"count", 60}});
  original.ack();
  original.advance();

  Page page;
  page.hello();
  upload(page, file);
  EXPECT_TRUE(page.last("error").is_null()) << page.last("error");
  EXPECT_EQ(page.last("opened")["title"], original.last("opened")["title"]);
  EXPECT_EQ(page.last("scene"), original.last("scene"));
  EXPECT_EQ(page.last("status")["last"], 90);
  page.send({{"type", "seek"}, {"step", 60}});
  page.ack();
  page.advance();
  ASSERT_FALSE(page.frames.empty());
  EXPECT_EQ(page.frames.back().step, 60u);
  EXPECT_EQ(page.frames.back().hash, original.frames.back().hash) << "the hash is recorded once a second";
  ASSERT_EQ(page.bodies.size(), original.bodies.size());
  for (const auto& [id, body] : original.bodies) {
    EXPECT_NEAR(page.body(id).position.x, body.position.x, 1e-6);
    EXPECT_NEAR(page.body(id).position.y, body.position.y, 1e-6);
  }
  // It plays to its end and stops there.
  page.send({{"type", "run"}});
  page.run_for(2);
  EXPECT_EQ(page.frames.back().step, 90u);
  EXPECT_EQ(page.last("status")["running"], false);
  page.send({{"type", "spawn"},
             {"form", "ball"},
             {"size", 1},
             {"density", 1},
             {"position", {0, 5, 0}},
             {"velocity", {0, 0, 0}}});
  EXPECT_NE(page.last("error").dump().find("recording"), std::string::npos);
}

TEST(Playback, ADamagedFilePlaysAsFarAsItIsWhole) {
  std::string file = recording_of("wrecking-ball", 60);
  file.resize(file.size() * 2 / 3);
  Page page;
  page.hello();
  upload(page, file);
  EXPECT_TRUE(page.last("error").is_null()) << page.last("error");
  const int last = page.last("status")["last"];
  EXPECT_GT(last, 10);
  EXPECT_LT(last, 60);
  EXPECT_NE(page.last("status")["message"].get<std::string>().find("not whole"), std::string::npos);
}

TEST(Playback, WhatIsNoRecordingIsNamedAndTheOpenDemoStays) {
  std::string broken = recording_of("wrecking-ball", 10);
  broken[40] = char(broken[40] ^ 1);
  for (const std::string& file : {std::string("{\"name\": \"a scene\"}"), std::string(), broken}) {
    Page page;
    page.open("chain");
    upload(page, file);
    ASSERT_FALSE(page.last("error").is_null()) << file.size();
    page.run_for(0.2);
    EXPECT_GT(page.frames.back().step, 5u);
  }
}

TEST(Playback, AFileBeyondTheLimitIsRefused) {
  HostOptions options;
  options.max_recording = 1000;
  Page page(options);
  page.hello();
  upload(page, std::string(5000, 'x'), 400);
  EXPECT_NE(page.last("error").dump().find("recording"), std::string::npos);
}

}  // namespace
}  // namespace carom::host::test
