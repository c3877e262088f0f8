// Recordings: what comes out is bit for bit what went in; damage is told, never followed.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>

#include "carom/scene/recording.h"

namespace carom::scene {
namespace {

RecordingHeader header_of(int dimension) {
  RecordingHeader h;
  h.name = "test";
  h.dt = 1.0 / 60;
  h.dimension = dimension;
  h.scene = "{\"type\":\"scene\",\"bodies\":[]}";
  h.meshes = {std::string("\x01\0\0\0", 4), "mesh"};
  h.declaration = "{}";
  h.origin = "{\"demo\":\"test\"}";
  h.files = {{"test.json", "{}"}, {"presets/ball.json", std::string("\0\xff", 2)}};
  return h;
}

/// Frames with bodies that move smoothly, stand still, sleep, come and go.
RecordedFrame frame_of(int k, int dimension) {
  RecordedFrame f;
  f.step = std::uint64_t(k) * 2;
  f.time = k / 30.0;
  f.has_hash = k % 3 == 0;
  f.state_hash = f.has_hash ? 0x123456789ABCDEFu * std::uint64_t(k + 1) : 0;
  for (int i = 0; i < 20; ++i) {
    if (i % 7 == 3 && k % 10 < 4) continue;  // comes and goes
    RecordedBody b;
    b.id = std::uint32_t(i * i);
    b.asleep = i % 5 == 0 && k > 12;
    const double t = i % 5 == 0 ? std::min(k, 12) / 30.0 : f.time;
    b.position = {1e6 + i + 3.1 * t, 10 - 4.9 * t * t, dimension == 3 ? -0.5 * i * t : 0};
    const float a = float(t) * 0.7f;
    b.rotation = {1 - a * a, dimension == 3 ? a * 0.5f : 0, dimension == 3 ? -a : 0, a};
    f.bodies.push_back(b);
  }
  if (k % 2 == 0) f.samples.push_back({1, 2, f.time, 0.1 * k});
  f.message = k < 15 ? "rising" : "";
  f.values = {1.5, k < 20 ? 2.0 : 3.0};
  if (k % 11 == 5) f.actions = {"{\"step\":3}", "second"};
  return f;
}

/// Drawn things that move, grow, vanish for a while, and a surface that is torn once.
RecordedPicture picture_of(int k) {
  RecordedPicture p;
  if (k % 17 == 9) return p;
  const double t = k / 60.0;
  const int lines = 3 + (k < 20 ? 2 * k : 80 - 2 * k) / 2;
  for (int i = 0; i < lines; ++i)
    p.lines.push_back(
        {{0.3 * i, 1e4 + i * i * 0.01, -0.1 * i}, {0.3 * i + t, 1e4 + i, t}, 0xff00ff80u + std::uint32_t(i)});
  const int points = k % 9 == 4 ? 0 : 150 + k;
  for (int i = 0; i < points; ++i) {
    p.points.push_back({float(i % 13) + float(t), 5 - 4.9f * float(t * t), float(i % 7)});
    p.radii.push_back(i % 3 == 0 ? 0.05f : 0.08f);
    p.point_rgbas.push_back(0x2f7faeffu + std::uint32_t(i % 5) * 0x01000000u);
  }
  for (int s = 0; s < 2; ++s) {
    RecordedSurface surface;
    surface.rgba = 0x11223344u + std::uint32_t(s);
    for (int i = 0; i < 100; ++i)
      surface.corners.push_back({float(i % 10), 0.2f * float((i * 7 + k) % 11), float(i / 10)});
    for (std::uint32_t i = 0; i + 11 < (k < 25 ? 100u : 60u); ++i)
      surface.triangles.insert(surface.triangles.end(), {i, i + 1, i + 11});
    if (s == 1 && k < 4) surface = {};  // its corners are not known yet
    p.surfaces.push_back(surface);
  }
  return p;
}

void expect_close(const RecordedPicture& a, const RecordedPicture& b) {
  ASSERT_EQ(a.lines.size(), b.lines.size());
  for (std::size_t i = 0; i < a.lines.size(); ++i) {
    ASSERT_LT(math::distance(a.lines[i].a, b.lines[i].a), 40.0 / (1 << 20));
    ASSERT_LT(math::distance(a.lines[i].b, b.lines[i].b), 40.0 / (1 << 20));
    ASSERT_EQ(a.lines[i].rgba, b.lines[i].rgba);
  }
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t i = 0; i < a.points.size(); ++i)
    ASSERT_LT(math::distance(a.points[i], b.points[i]), 40.0f / (1 << 15));
  ASSERT_EQ(a.radii, b.radii);
  ASSERT_EQ(a.point_rgbas, b.point_rgbas);
  ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
  for (std::size_t s = 0; s < a.surfaces.size(); ++s) {
    ASSERT_EQ(a.surfaces[s].triangles, b.surfaces[s].triangles);
    ASSERT_EQ(a.surfaces[s].rgba, b.surfaces[s].rgba);
    ASSERT_EQ(a.surfaces[s].corners.size(), b.surfaces[s].corners.size());
    for (std::size_t i = 0; i < a.surfaces[s].corners.size(); ++i)
      ASSERT_LT(math::distance(a.surfaces[s].corners[i], b.surfaces[s].corners[i]), 20.0f / (1 << 17));
  }
}

void expect_same(const RecordedFrame& a, const RecordedFrame& b) {
  ASSERT_EQ(a.step, b.step);
  ASSERT_EQ(a.time, b.time);
  ASSERT_EQ(a.has_hash, b.has_hash);
  ASSERT_EQ(a.state_hash, b.state_hash);
  ASSERT_EQ(a.bodies.size(), b.bodies.size());
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    ASSERT_EQ(a.bodies[i].id, b.bodies[i].id);
    ASSERT_EQ(a.bodies[i].asleep, b.bodies[i].asleep);
    ASSERT_TRUE(a.bodies[i].position == b.bodies[i].position);
    ASSERT_TRUE(a.bodies[i].rotation == b.bodies[i].rotation);
  }
  ASSERT_EQ(a.samples.size(), b.samples.size());
  for (std::size_t i = 0; i < a.samples.size(); ++i) ASSERT_EQ(a.samples[i].y, b.samples[i].y);
  ASSERT_EQ(a.message, b.message);
  ASSERT_EQ(a.values, b.values);
  ASSERT_EQ(a.actions, b.actions);
}

std::vector<std::uint8_t> record(int frames, int dimension, int key_interval = 10, bool finish = true) {
  std::vector<std::uint8_t> bytes;
  const auto sink = [&](std::span<const std::uint8_t> part) -> Status {
    bytes.insert(bytes.end(), part.begin(), part.end());
    return {};
  };
  Result<Recorder> recorder = Recorder::open(sink, header_of(dimension), {key_interval});
  EXPECT_TRUE(recorder.ok());
  for (int k = 0; k < frames; ++k) EXPECT_TRUE(recorder->add(frame_of(k, dimension)).ok());
  if (!finish) {
    std::vector<std::uint8_t> unfinished = bytes;
    return unfinished;
  }
  EXPECT_TRUE(recorder->finish().ok());
  EXPECT_EQ(recorder->bytes_written(), bytes.size());
  return bytes;
}

class RecordingInDimension : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Both, RecordingInDimension, testing::Values(2, 3));

TEST_P(RecordingInDimension, GivesBackTheBitsInAnyOrder) {
  Result<Recording> r = Recording::from_bytes(record(47, GetParam()));
  ASSERT_TRUE(r.ok()) << r.error().message;
  EXPECT_TRUE(r->complete());
  EXPECT_EQ(r->damage(), "");
  EXPECT_EQ(r->header().name, "test");
  EXPECT_EQ(r->header().meshes, header_of(3).meshes);
  EXPECT_EQ(r->header().dimension, GetParam());
  ASSERT_EQ(r->frame_count(), 47u);
  for (const int k : {0, 1, 2, 30, 31, 29, 46, 5, 5, 44, 9, 10, 11, 0}) {
    const Result<RecordedFrame> f = r->frame(std::size_t(k));
    ASSERT_TRUE(f.ok()) << f.error().message;
    expect_same(*f, frame_of(k, GetParam()));
  }
  EXPECT_FALSE(r->frame(47).ok());
  EXPECT_EQ(r->index_at_time(-1), 0u);
  EXPECT_EQ(r->index_at_time(1.0), 30u);
  EXPECT_EQ(r->index_at_time(1.01), 30u);
  EXPECT_EQ(r->index_at_time(99), 46u);
  EXPECT_EQ(r->index_at_step(61), 30u);
}

TEST(Recording, HoldsWhatIsDrawnBesideBodiesInAnyOrder) {
  std::vector<std::uint8_t> bytes;
  Result<Recorder> recorder = Recorder::open(
      [&](std::span<const std::uint8_t> part) -> Status {
        bytes.insert(bytes.end(), part.begin(), part.end());
        return {};
      },
      header_of(3), {12});
  ASSERT_TRUE(recorder.ok());
  for (int k = 0; k < 40; ++k) {
    RecordedFrame f = frame_of(k, 3);
    f.picture = picture_of(k);
    if (k % 13 == 0) {
      ASSERT_TRUE(recorder->introduce({"{\"add\":[" + std::to_string(k) + "]}", {"mesh " + std::to_string(k)}}).ok());
    }
    ASSERT_TRUE(recorder->add(f).ok()) << k;
  }
  const std::vector<std::uint8_t> cut = bytes;
  ASSERT_TRUE(recorder->finish().ok());
  for (const std::vector<std::uint8_t>& file : {bytes, cut}) {
    Result<Recording> r = Recording::from_bytes(file);
    ASSERT_TRUE(r.ok()) << r.error().message;
    EXPECT_EQ(r->complete(), file.size() == bytes.size());
    EXPECT_EQ(r->header().origin, header_of(3).origin);
    ASSERT_EQ(r->header().files.size(), 2u);
    EXPECT_EQ(r->header().files[1].bytes, header_of(3).files[1].bytes);
    ASSERT_EQ(r->arrivals().size(), 4u);
    EXPECT_EQ(r->arrivals()[3].bodies, "{\"add\":[39]}");
    EXPECT_EQ(r->arrivals()[1].meshes, std::vector<std::string>{"mesh 13"});
    ASSERT_EQ(r->frame_count(), 40u);
    for (const int k : {0, 1, 39, 9, 10, 26, 27, 25, 12, 13, 14, 3, 4, 5, 38, 0}) {
      const Result<RecordedFrame> f = r->frame(std::size_t(k));
      ASSERT_TRUE(f.ok()) << k << ": " << f.error().message;
      expect_same(*f, frame_of(k, 3));
      expect_close(f->picture, picture_of(k));
    }
  }
}

TEST(Recording, PointsTakeFewBytes) {
  // 5000 balls in free flight: 28 bytes each in memory.
  std::vector<std::uint8_t> bytes;
  Result<Recorder> recorder = Recorder::open(
      [&](std::span<const std::uint8_t> part) -> Status {
        bytes.insert(bytes.end(), part.begin(), part.end());
        return {};
      },
      header_of(3));
  const int count = 5000, frames = 60;
  for (int k = 0; k < frames; ++k) {
    RecordedFrame f;
    f.step = std::uint64_t(k);
    f.time = k / 60.0;
    const float t = float(k) / 60;
    for (int i = 0; i < count; ++i) {
      const float vx = float(i % 97) / 20 - 2.4f, vy = float(i % 89) / 10, vz = float(i % 83) / 20 - 2;
      f.picture.points.push_back({vx * t, vy * t - 4.9f * t * t, vz * t});
      f.picture.radii.push_back(0.02f);
      f.picture.point_rgbas.push_back(0xffffffffu);
    }
    ASSERT_TRUE(recorder->add(f).ok());
  }
  ASSERT_TRUE(recorder->finish().ok());
  EXPECT_LT(double(bytes.size()) / (count * frames), 4.0);
}

TEST(Recording, FilesOfVersionOneStillOpen) {
  // The corpus of the fuzzer holds two that version 1 wrote.
  for (const char* name : {"whole_2d.bin", "whole_3d.bin"}) {
    Result<Recording> r = Recording::open(std::string(CAROM_SOURCE_DIR "/tests/fuzz/corpus/recording/") + name);
    ASSERT_TRUE(r.ok()) << r.error().message;
    EXPECT_EQ(r->header().version, 1u);
    EXPECT_TRUE(r->complete()) << r->damage();
    EXPECT_GT(r->frame_count(), 3u);
    for (std::size_t i = 0; i < r->frame_count(); ++i) EXPECT_TRUE(r->frame(i).ok());
  }
}

TEST(Recorder, RefusesAPictureThatDoesNotFit) {
  Result<Recorder> r = Recorder::open([](std::span<const std::uint8_t>) -> Status { return {}; }, header_of(3));
  RecordedFrame f = frame_of(1, 3);
  f.picture.points = {{0, 0, 0}};
  EXPECT_FALSE(r->add(f).ok()) << "no radius";
  f.picture = {};
  f.picture.surfaces = {{{{0, 0, 0}}, {0, 0, 1}, 0}};
  EXPECT_FALSE(r->add(f).ok()) << "no such corner";
  f.picture.surfaces = {{{{0, 0, 0}}, {0, 0}, 0}};
  EXPECT_FALSE(r->add(f).ok()) << "two corners";
}

TEST(Recording, PlaysUpToWhereItIsWholeAtEveryCut) {
  const std::vector<std::uint8_t> whole = record(23, 3);
  std::size_t most = 0;
  for (std::size_t size = 0; size <= whole.size(); ++size) {
    Result<Recording> r = Recording::from_bytes({whole.begin(), whole.begin() + std::ptrdiff_t(size)});
    if (!r.ok()) {
      EXPECT_FALSE(r.error().message.empty());
      EXPECT_EQ(most, 0u) << "a longer part of the file must not play less";
      continue;
    }
    ASSERT_GE(r->frame_count(), most);
    most = r->frame_count();
    EXPECT_EQ(r->complete(), size == whole.size());
    EXPECT_EQ(r->damage().empty(), size == whole.size());
    if (most > 0) {
      const Result<RecordedFrame> last = r->frame(most - 1);
      ASSERT_TRUE(last.ok()) << last.error().message;
      expect_same(*last, frame_of(int(most) - 1, 3));
    }
  }
  EXPECT_EQ(most, 23u);
}

TEST(Recording, TellsOfEveryFlippedBit) {
  const std::vector<std::uint8_t> whole = record(12, 3, 4);
  for (std::size_t i = 0; i < whole.size(); ++i) {
    std::vector<std::uint8_t> bad = whole;
    bad[i] ^= std::uint8_t(1u << (i % 8));
    Result<Recording> r = Recording::from_bytes(bad);
    if (!r.ok()) continue;
    bool told = !r->complete() || !r->damage().empty();
    for (std::size_t k = 0; k < r->frame_count(); ++k) {
      const Result<RecordedFrame> f = r->frame(k);
      if (!f.ok())
        told = true;
      else
        expect_same(*f, frame_of(int(k), 3));
    }
    // Four bytes of the preamble are reserved: nothing reads them.
    EXPECT_TRUE(told || (i >= 12 && i < 16)) << "byte " << i;
  }
}

TEST(Recording, IsCompactWhereMotionIsSmooth) {
  RecordedFrame f;
  std::vector<std::uint8_t> bytes;
  Result<Recorder> recorder = Recorder::open(
      [&](std::span<const std::uint8_t> part) -> Status {
        bytes.insert(bytes.end(), part.begin(), part.end());
        return {};
      },
      header_of(3), {1000});
  const int bodies = 200, frames = 100;
  for (int k = 0; k < frames; ++k) {
    f.step = std::uint64_t(k);
    f.time = k / 60.0;
    f.bodies.clear();
    for (int i = 0; i < bodies; ++i) {
      RecordedBody b;
      b.id = std::uint32_t(i);
      const double t = i < bodies / 2 ? 0 : f.time;  // half of them rest
      b.position = {i + 2 * t, 100 - 4.9 * t * t, 0.1 * t};
      f.bodies.push_back(b);
    }
    ASSERT_TRUE(recorder->add(f).ok());
  }
  ASSERT_TRUE(recorder->finish().ok());
  const double per_body = double(bytes.size()) / (double(bodies) * frames);
  EXPECT_LT(per_body, 16) << "the state is 40 bytes";
}

TEST(Recorder, RefusesWhatIsNotAFrame) {
  const auto sink = [](std::span<const std::uint8_t>) -> Status { return {}; };
  Result<Recorder> r = Recorder::open(sink, header_of(3));
  ASSERT_TRUE(r.ok());
  RecordedFrame f = frame_of(5, 3);
  ASSERT_TRUE(r->add(f).ok());
  EXPECT_FALSE(r->add(f).ok()) << "steps must rise";
  f = frame_of(6, 3);
  f.bodies[0].position.x = __builtin_nan("");
  EXPECT_FALSE(r->add(f).ok());
  f = frame_of(6, 3);
  std::swap(f.bodies[0], f.bodies[1]);
  EXPECT_FALSE(r->add(f).ok());
  f = frame_of(6, 3);
  f.time = __builtin_inf();
  EXPECT_FALSE(r->add(f).ok());
  EXPECT_TRUE(r->add(frame_of(6, 3)).ok());
  EXPECT_TRUE(r->finish().ok());
  EXPECT_FALSE(r->add(frame_of(7, 3)).ok());
  RecordingHeader bad = header_of(3);
  bad.dimension = 4;
  EXPECT_FALSE(Recorder::open(sink, bad).ok());
  bad = header_of(3);
  bad.dt = 0;
  EXPECT_FALSE(Recorder::open(sink, bad).ok());
  EXPECT_FALSE(Recorder::open("/nonexistent/folder/x.rec", header_of(3)).ok());
  EXPECT_FALSE(Recording::open("/nonexistent/folder/x.rec").ok());
}

TEST(Recorder, PassesOnWhatTheSinkSays) {
  int calls = 0;
  const auto full = [&](std::span<const std::uint8_t>) -> Status {
    return ++calls <= 3 ? Status{} : Status{core::Error{"the disk is full"}};
  };
  Result<Recorder> r = Recorder::open(full, header_of(3));
  ASSERT_TRUE(r.ok());
  EXPECT_TRUE(r->add(frame_of(0, 3)).ok());
  const Status second = r->add(frame_of(1, 3));
  ASSERT_FALSE(second.ok());
  EXPECT_EQ(second.error().message, "the disk is full");
  EXPECT_FALSE(r->finish().ok());
}

TEST(Recording, GoesThroughAFile) {
  const std::string path = testing::TempDir() + "carom_recording_test.rec";
  {
    Result<Recorder> r = Recorder::open(path, header_of(3));
    ASSERT_TRUE(r.ok()) << r.error().message;
    for (int k = 0; k < 5; ++k) ASSERT_TRUE(r->add(frame_of(k, 3)).ok());
  }  // the destructor finishes the file
  Result<Recording> p = Recording::open(path);
  ASSERT_TRUE(p.ok()) << p.error().message;
  EXPECT_TRUE(p->complete());
  ASSERT_EQ(p->frame_count(), 5u);
  expect_same(*p->frame(4), frame_of(4, 3));
  std::remove(path.c_str());
}

}  // namespace
}  // namespace carom::scene
