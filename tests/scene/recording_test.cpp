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
  return f;
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
