// Recordings: made by a host, sent back to a host, shown frame by frame; damage and nonsense are named.
#include <chrono>
#include <cmath>
#include <functional>

#include "carom/core/hash.h"
#include "carom/scene/recording.h"
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

/// Opens a demo, records `steps` of it, and gives the page that did it and the file.
struct Recorded {
  Page page;
  std::string file;
  explicit Recorded(const std::string& demo, int steps, Json parameters = Json::object()) {
    page.open(demo, std::move(parameters));
    page.send({{"type", "pause"}});
    page.send({{"type", "record"}, {"on", true}});
    page.send({{"type", "step"}, {"count", steps}});
    end();
  }
  void end() {
    page.send({{"type", "record"}, {"on", false}});
    EXPECT_FALSE(page.files.empty());
    file = page.files.empty() ? std::string() : page.files.back();
  }
};

TEST(Playback, HoldsWhatEveryDemoDraws) {
  for (const std::string& id : demo_ids()) {
    SCOPED_TRACE(id);
    Recorded recorded(id, 30);
    Page& live = recorded.page;
    live.ack();
    live.send({{"type", "seek"}, {"step", 30}});  // where it is: for the key frame
    live.advance();
    Page page;
    page.hello();
    upload(page, recorded.file, 4 << 20);
    ASSERT_TRUE(page.last("error").is_null()) << page.last("error");
    const int last = page.last("status")["last"];
    if (last != 30) continue;  // its own time: what was recorded before it turned back plays
    page.send({{"type", "seek"}, {"step", 30}});
    page.ack();
    page.advance();
    ASSERT_FALSE(page.frames.empty());
    ASSERT_FALSE(live.frames.empty());
    EXPECT_EQ(page.frames.back().lines, live.frames.back().lines);
    EXPECT_EQ(page.points, live.points);
    EXPECT_EQ(page.bodies.size(), live.bodies.size());
    EXPECT_EQ(page.triangles > 0, live.triangles > 0);
    EXPECT_EQ(page.last("values"), live.last("values"));
    const Json said = live.last("status");
    if (said.contains("message")) {
      EXPECT_EQ(page.last("status")["message"], said["message"]);
    }
    for (const auto& [body, place] : live.bodies) {
      EXPECT_LT(math::distance(page.body(body).position, place.position), 1e-3);
    }
  }
}

TEST(Playback, BodiesThatComeAndGoAreShownInEveryDirection) {
  Page page;
  page.open("pyramids");
  page.send({{"type", "pause"}});
  page.send({{"type", "record"}, {"on", true}});
  const std::size_t before = page.last("scene")["bodies"].size();
  page.send({{"type", "step"}, {"count", 10}});
  page.send({{"type", "spawn"},
             {"form", "ball"},
             {"size", 0.4},
             {"density", 800},
             {"position", {0, 9, 0}},
             {"velocity", {0, -4, 0}}});
  page.send({{"type", "step"}, {"count", 20}});
  EXPECT_EQ(page.last("status")["recording"], true) << "a new body does not end the recording";
  page.send({{"type", "record"}, {"on", false}});
  ASSERT_EQ(page.files.size(), 1u);
  Page shown;
  shown.hello();
  upload(shown, page.files[0]);
  ASSERT_TRUE(shown.last("error").is_null()) << shown.last("error");
  EXPECT_EQ(shown.last("scene")["bodies"].size(), before);
  const auto seek = [&shown](int step) {
    shown.send({{"type", "seek"}, {"step", step}});
    shown.ack();
    shown.advance();
    return shown.bodies.size();
  };
  EXPECT_EQ(seek(25), before + 1);
  EXPECT_EQ(shown.last("bodies")["add"].size(), 1u);
  EXPECT_EQ(shown.last("bodies")["add"][0]["shapes"][0]["kind"], "sphere");
  EXPECT_EQ(seek(5), before);
  EXPECT_EQ(shown.last("bodies")["remove"].size(), 1u);
  EXPECT_EQ(seek(30), before + 1);
}

TEST(Playback, ARecordingThatIsFullEndsWhole) {
  HostOptions options;
  options.max_recording = 2'000'000;
  Page page(options);
  page.open("pyramids");
  page.send({{"type", "pause"}});
  page.send({{"type", "record"}, {"on", true}});
  page.send({{"type", "step"}, {"count", 1000}});
  ASSERT_EQ(page.files.size(), 1u);
  EXPECT_NE(page.last("error").dump().find("full"), std::string::npos);
  EXPECT_EQ(page.last("status")["recording"], false);
  core::Result<scene::Recording> file = scene::Recording::from_bytes({page.files[0].begin(), page.files[0].end()});
  ASSERT_TRUE(file.ok());
  EXPECT_TRUE(file->complete()) << file->damage();
  EXPECT_GT(file->frame_count(), 20u);
}

TEST(Playback, ThirtyMegabytesOpenAndScrub) {
  constexpr int bodies = 1500, frames = 500;
  scene::RecordingHeader header;
  header.name = "large";
  Json scene = {{"type", "scene"}, {"bodies", Json::array()}};
  for (int i = 0; i < bodies; ++i)
    scene["bodies"].push_back({{"id", i},
                               {"name", "b"},
                               {"type", "dynamic"},
                               {"position", {0, 0, 0}},
                               {"rotation", {1, 0, 0, 0}},
                               {"shapes", {{{"kind", "sphere"}, {"radius", 0.1}}}}});
  header.scene = scene.dump();
  header.declaration = R"({"type": "opened", "title": "large", "camera": {}})";
  std::string file;
  core::Result<scene::Recorder> recorder = scene::Recorder::open(
      [&file](std::span<const std::uint8_t> bytes) -> core::Status {
        file.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return {};
      },
      header);
  ASSERT_TRUE(recorder.ok());
  std::uint64_t seed = 1;
  const auto random = [&seed] {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return double(seed >> 11) * 0x1p-53;
  };
  std::vector<math::Vec3d> wanted(frames);
  for (int k = 0; k < frames; ++k) {
    scene::RecordedFrame f;
    f.step = std::uint64_t(k);
    f.time = k / 60.0;
    for (int i = 0; i < bodies; ++i)
      f.bodies.push_back({std::uint32_t(i),
                          false,
                          {random(), random(), random()},
                          {1, float(random()), float(random()), float(random())}});
    wanted[std::size_t(k)] = f.bodies[77].position;
    ASSERT_TRUE(recorder->add(f).ok());
  }
  ASSERT_TRUE(recorder->finish().ok());
  EXPECT_GT(file.size(), 25u << 20);
  Page page;
  page.hello();
  upload(page, file, 4 << 20);
  ASSERT_TRUE(page.last("error").is_null()) << page.last("error");
  const auto started = std::chrono::steady_clock::now();
  for (const int step : {499, 0, 250, 249, 10, 480, 59, 60, 61, 333}) {
    page.send({{"type", "seek"}, {"step", step}});
    page.ack();
    page.advance();
    EXPECT_EQ(page.frames.back().step, std::uint32_t(step));
    EXPECT_LT(math::distance(page.body(77).position, wanted[std::size_t(step)]), 1e-6);
  }
  const double each = std::chrono::duration<double>(std::chrono::steady_clock::now() - started).count() / 10;
  RecordProperty("seconds_a_seek", std::to_string(each));
  EXPECT_LT(each, 1.0) << "s for a place of the slider";
}

/// Lets a page run its open recording again; the last report.
Json verified(Page& page) {
  page.send({{"type", "verify"}});
  for (int i = 0; i < 20000; ++i) {
    const Json report = page.last("verified");
    if (report.is_object() && report["done"] == true) return report;
    if (!page.last("error").is_null()) return page.last("error");
    page.advance();
    page.ack();
  }
  return page.last("verified");
}

TEST(Replay, AnUntouchedRunIsTheSame) {
  for (const char* id : {"pyramids", "wrecking-ball", "chain", "dam-break"}) {
    const Recorded recorded(id, 40);
    Page page;
    page.hello();
    upload(page, recorded.file);
    const Json report = verified(page);
    EXPECT_EQ(report["equal"], true) << id << ": " << report;
    EXPECT_EQ(report["last"], 40);
    EXPECT_EQ(report["frames"], 41);
    EXPECT_GE(report["hashes"], 4);
  }
}

TEST(Replay, WhatWasDoneIsDoneAgain) {
  // Before the recording, in it, and after going back within it.
  Page page;
  page.open("pyramids", {{"friction", 0.4}});
  page.send({{"type", "pause"}});
  page.send({{"type", "step"}, {"count", 10}});
  page.send({{"type", "spawn"},
             {"form", "box"},
             {"size", 0.4},
             {"density", 800},
             {"position", {0, 12, 0}},
             {"velocity", {0, -9, 0}}});
  page.send({{"type", "step"}, {"count", 20}});
  page.send({{"type", "spawn"},
             {"form", "ball"},
             {"size", 0.9},
             {"density", 900},
             {"position", {0, 12, 1}},
             {"velocity", {0, -9, 0}}});
  page.send({{"type", "step"}, {"count", 5}});
  page.send({{"type", "seek"}, {"step", 25}});  // the second body is of another future
  page.send({{"type", "record"}, {"on", true}});
  page.send({{"type", "step"}, {"count", 15}});
  page.send({{"type", "grab"}, {"pointer", 1}, {"origin", {0, 0.5, 20}}, {"direction", {0, 0, -1}}});
  EXPECT_GE(page.last("grabbed")["body"], 0);
  page.send({{"type", "step"}, {"count", 5}});
  page.send({{"type", "drag"}, {"pointer", 1}, {"target", {2, 4, 1}}});
  page.send({{"type", "step"}, {"count", 25}});
  page.send({{"type", "release"}, {"pointer", 1}});
  page.send({{"type", "spawn"},
             {"form", "capsule"},
             {"size", 0.3},
             {"density", 800},
             {"position", {0, 9, 0}},
             {"velocity", {0, -4, 0}}});
  page.send({{"type", "step"}, {"count", 20}});
  page.send({{"type", "record"}, {"on", false}});
  ASSERT_FALSE(page.files.empty());
  EXPECT_TRUE(page.last("error").is_null()) << page.last("error");
  Page shown;
  shown.hello();
  upload(shown, page.files.back());
  const Json report = verified(shown);
  EXPECT_EQ(report["equal"], true) << report;
  EXPECT_EQ(report["first"], 25);
  EXPECT_EQ(report["last"], 90);
}

/// The same recording with something else in it.
std::string changed(const std::string& file, const std::function<void(scene::RecordingHeader&)>& header,
                    const std::function<void(scene::RecordedFrame&)>& frame) {
  core::Result<scene::Recording> from = scene::Recording::from_bytes({file.begin(), file.end()});
  EXPECT_TRUE(from.ok());
  scene::RecordingHeader head = from->header();
  if (header) header(head);
  std::string out;
  core::Result<scene::Recorder> to = scene::Recorder::open(
      [&out](std::span<const std::uint8_t> bytes) -> core::Status {
        out.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return {};
      },
      head);
  EXPECT_TRUE(to.ok());
  for (std::size_t i = 0; i < from->frame_count(); ++i) {
    core::Result<scene::RecordedFrame> one = from->frame(i);
    if (frame) frame(*one);
    EXPECT_TRUE(to->add(*one).ok());
  }
  EXPECT_TRUE(to->finish().ok());
  return out;
}

TEST(Replay, SaysWhereARunDiffers) {
  const std::string file = Recorded("pyramids", 60).file;
  const auto report_of = [](const std::string& text) {
    Page page;
    page.hello();
    upload(page, text);
    return verified(page);
  };
  const auto replace = [](std::string& text, const std::string& what, const std::string& by) {
    const std::size_t at = text.find(what);
    ASSERT_NE(at, std::string::npos) << what << " in " << text;
    text.replace(at, what.size(), by);
  };
  Json report = report_of(changed(file, {}, {}));
  EXPECT_EQ(report["equal"], true) << report;
  // A hash that is not that of the run.
  report = report_of(changed(file, {}, [](scene::RecordedFrame& f) {
    if (f.step == 30) f.state_hash ^= 1;
  }));
  EXPECT_EQ(report["equal"], false);
  EXPECT_EQ(report["differs"], 30) << report;
  EXPECT_NE(report["message"].get<std::string>().find("state hash"), std::string::npos);
  // A body elsewhere, by a bit.
  report = report_of(changed(file, {}, [](scene::RecordedFrame& f) {
    if (f.step == 17) f.bodies[2].position.y = std::nextafter(f.bodies[2].position.y, 1e9);
  }));
  EXPECT_EQ(report["differs"], 17) << report;
  // Another parameter.
  report = report_of(changed(file,
                             [&](scene::RecordingHeader& h) {
                               replace(h.origin, "\"friction\":", "\"friction\":0.1,\"was\":");
                               const std::size_t from = h.origin.find(",\"was\":"),
                                                 to = h.origin.find_first_of(",}", from + 1);
                               h.origin.erase(from, to - from);
                             },
                             {}));
  EXPECT_EQ(report["equal"], false) << report;
  EXPECT_GT(report["differs"], 0) << report;
  // Another build.
  report = report_of(changed(
      file, [&](scene::RecordingHeader& h) { replace(h.origin, "\"version\":\"", "\"version\":\"9."); },
      [](scene::RecordedFrame& f) {
        if (f.step >= 20) f.state_hash ^= 2;
      }));
  EXPECT_EQ(report["differs"], 20) << report;
  EXPECT_NE(report["message"].get<std::string>().find("recorded by Carom 9."), std::string::npos) << report;
  // One that does not tell where it comes from, one whose demo nobody knows, one whose actions are no actions.
  report = report_of(changed(file, [](scene::RecordingHeader& h) { h.origin.clear(); }, {}));
  EXPECT_NE(report["message"].get<std::string>().find("does not say what opened it"), std::string::npos) << report;
  report = report_of(
      changed(file, [&](scene::RecordingHeader& h) { replace(h.origin, "\"pyramids\"", "\"pyramid\""); }, {}));
  EXPECT_NE(report["message"].get<std::string>().find("not here"), std::string::npos) << report;
  report = report_of(changed(file, {}, [](scene::RecordedFrame& f) {
    if (f.step == 5) f.actions = {"{\"step\":4,\"action\":{\"type\":\"grab\"}}"};
  }));
  EXPECT_NE(report["message"].get<std::string>().find("field"), std::string::npos) << report;
}

/// Chunk checksums made right again (carom/scene/recording.h): without it no damage would get past them.
void mend(std::string& file) {
  const auto byte = [&file](std::size_t at) { return std::uint32_t(static_cast<unsigned char>(file[at])); };
  for (std::size_t at = 16; at + 16 <= file.size();) {
    const std::size_t length = byte(at + 4) | byte(at + 5) << 8 | byte(at + 6) << 16 | byte(at + 7) << 24;
    if (length > file.size() - at - 16) return;
    core::StateHash hash;
    hash.add(byte(at));
    hash.add(std::string_view(file).substr(at + 16, length));
    const std::uint64_t digest = hash.digest();
    for (std::size_t i = 0; i < 8; ++i) file[at + 8 + i] = char(digest >> (8 * i));
    at += 16 + length;
  }
}

TEST(Playback, FilesMadeToHarmAreRefusedOrShown) {
  // What bodies come from, what is drawn and what was done: all of it wrong in turn, with checksums that are right.
  Page maker;
  maker.open("dam-break");
  maker.send({{"type", "pause"}});
  maker.send({{"type", "record"}, {"on", true}});
  maker.send({{"type", "step"}, {"count", 3}});
  maker.send({{"type", "spawn"},
              {"form", "ball"},
              {"size", 0.1},
              {"density", 500},
              {"position", {0, 3, 0}},
              {"velocity", {0, 0, 0}}});
  maker.send({{"type", "step"}, {"count", 3}});
  maker.send({{"type", "record"}, {"on", false}});
  ASSERT_FALSE(maker.files.empty());
  const std::string whole = maker.files.back();
  std::uint64_t seed = 7;
  const auto random = [&seed](std::size_t below) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    return std::size_t(seed >> 33) % below;
  };
  int opened = 0;
  for (int i = 0; i < 150; ++i) {
    std::string file = whole;
    for (std::size_t k = 0, n = 1 + random(4); k < n; ++k) file[16 + random(file.size() - 16)] = char(random(256));
    mend(file);
    Page page;
    page.hello();
    upload(page, file, 4 << 20);
    if (page.last("opened").is_null()) {
      EXPECT_FALSE(page.last("error").is_null());
      continue;
    }
    ++opened;
    for (const int step : {4, 0, 6}) {
      page.send({{"type", "seek"}, {"step", step}});
      page.ack();
      page.advance();
    }
    page.send({{"type", "verify"}});
    for (int k = 0; k < 3; ++k) page.advance();
  }
  EXPECT_GT(opened, 20);
}

TEST(Replay, OnlyARecordingCanBeVerified) {
  Page page;
  page.open("chain");
  page.send({{"type", "verify"}});
  EXPECT_NE(page.last("error").dump().find("no recording"), std::string::npos);
}

}  // namespace
}  // namespace carom::host::test
