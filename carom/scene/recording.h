// Recordings: what a run showed, as one compact file that streams, seeks and says when it is damaged.
//
// File: a 16-byte preamble, then chunks, then an index chunk and a 24-byte trailer. Each chunk is
// {u8 tag, u8[3] zero, u32 payload bytes, u64 hash of tag and payload, payload}. All little-endian.
// A file cut anywhere plays up to its last whole chunk: the index is found again by scanning.
// Version 2 adds what is drawn beside bodies, bodies that come later, and what the run was opened from; files of
// version 1 open as before.
#pragma once

#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "carom/core/result.h"
#include "carom/export.h"
#include "carom/math/transform.h"

namespace carom::scene {
using core::Result;
using core::Status;
class SceneWorld;

struct RecordedFile {
  std::string name, bytes;
};
struct RecordingHeader {
  std::uint32_t version = 2;
  std::string name;      ///< of the scene
  double dt = 1.0 / 60;  ///< s a step
  int dimension = 3;
  std::string scene;                ///< the `scene` message of docs/protocol.md
  std::vector<std::string> meshes;  ///< binary mesh messages, as in the protocol
  std::string declaration;          ///< JSON text with plots and camera, or empty
  std::string origin;               ///< JSON text: what runs it again (docs/protocol.md), or empty
  std::vector<RecordedFile> files;  ///< the scene that was opened, first, and all that it names; or none
};
/// Bodies that the header does not know: a `bodies` message of docs/protocol.md and the meshes that are new in it.
struct RecordedArrival {
  std::string bodies;
  std::vector<std::string> meshes;
};
struct RecordedBody {
  std::uint32_t id = 0;
  bool asleep = false;
  math::Vec3d position{};
  math::Quatf rotation{};
};
struct RecordedSample {
  std::uint16_t plot = 0, series = 0;
  double x = 0, y = 0;
};
struct RecordedLine {
  math::Vec3d a{}, b{};
  std::uint32_t rgba = 0;
};
struct RecordedSurface {
  std::vector<math::Vec3f> corners;
  std::vector<std::uint32_t> triangles;  ///< three corners each
  std::uint32_t rgba = 0;
};
/// What is drawn beside bodies. Places are kept to 2⁻¹⁶ (points), 2⁻¹⁸ (surfaces) or 2⁻²² (lines) of the whole's size.
struct RecordedPicture {
  std::vector<RecordedLine> lines;
  std::vector<math::Vec3f> points;         ///< m: middles of small balls
  std::vector<float> radii;                ///< m, one a point
  std::vector<std::uint32_t> point_rgbas;  ///< one a point
  std::vector<RecordedSurface> surfaces;
};
struct RecordedFrame {
  std::uint64_t step = 0;
  double time = 0;
  bool has_hash = false;
  std::uint64_t state_hash = 0;
  std::vector<RecordedBody> bodies;     ///< all bodies, by rising id
  std::vector<RecordedSample> samples;  ///< taken since the frame before
  RecordedPicture picture;
  std::string message;               ///< a demo's verdict
  std::vector<double> values;        ///< of the declared parameters
  std::vector<std::string> actions;  ///< JSON texts: what was done since the frame before (docs/protocol.md)
};

struct RecorderOptions {
  int key_interval = 60;  ///< frames between key frames
};

/// Writes as it goes: what has been written stays whole whatever comes after.
class CAROM_API Recorder {
 public:
  using Sink = std::function<Status(std::span<const std::uint8_t> bytes)>;
  Recorder();
  ~Recorder();
  Recorder(Recorder&&) noexcept;
  Recorder& operator=(Recorder&&) noexcept;
  static Result<Recorder> open(const std::string& path, const RecordingHeader& header, const RecorderOptions& = {});
  static Result<Recorder> open(Sink sink, const RecordingHeader& header, const RecorderOptions& = {});

  /// Frames must come with rising steps; bodies may come and go.
  Status add(const RecordedFrame& frame);
  /// Tells what bodies look like that frames from here on name. Their ids must be new.
  Status introduce(const RecordedArrival& arrival);
  Status finish();  ///< writes index and trailer and closes; the destructor does it too, without telling of errors
  std::uint64_t bytes_written() const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

/// The frame of a running scene: every body with its pose, and the state hash.
CAROM_API void capture_frame(const SceneWorld& world, RecordedFrame& out);

/// Plays a recording. All checks on damage are made when it is opened or read; nothing in a file can do harm.
class CAROM_API Recording {
 public:
  Recording();
  ~Recording();
  Recording(Recording&&) noexcept;
  Recording& operator=(Recording&&) noexcept;
  static Result<Recording> open(const std::string& path);
  static Result<Recording> from_bytes(std::vector<std::uint8_t> bytes);

  const RecordingHeader& header() const;
  const std::vector<RecordedArrival>& arrivals() const;  ///< in the order in which they came
  std::size_t frame_count() const;
  double first_time() const;
  double last_time() const;
  bool complete() const;              ///< index and trailer were there
  const std::string& damage() const;  ///< what is wrong behind the last whole chunk; empty where nothing is

  /// The frame as it was recorded. Cheapest in rising order.
  Result<RecordedFrame> frame(std::size_t index);
  /// The last frame at or before the time (step); the first where there is none before.
  std::size_t index_at_time(double time) const;
  std::size_t index_at_step(std::uint64_t step) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> self_;
};

}  // namespace carom::scene
