#include <algorithm>
#include <cstdio>

#include "carom/scene/detail/frame_codec.h"
#include "carom/scene/detail/recording_chunks.h"
#include "carom/scene/recording.h"

namespace carom::scene {
namespace {
using detail::ByteWriter;
using detail::check_picture;
using detail::chunk_hash;
using detail::chunk_header_size;
using detail::FrameEntry;
using detail::max_payload;
using detail::preamble_magic;
using detail::recording_version;
using detail::Tag;
using detail::tag_bodies;
using detail::tag_delta;
using detail::tag_header;
using detail::tag_index;
using detail::tag_key;
using detail::trailer_magic;
}  // namespace

struct Recorder::Implementation {
  Sink sink;
  std::FILE* file = nullptr;
  std::string path;
  RecorderOptions options;
  detail::FrameCodec codec;
  std::uint64_t written = 0;
  std::vector<FrameEntry> index;
  std::vector<std::uint64_t> arrivals;  ///< where their chunks are
  bool broken = false, finished = false;

  Status put(std::span<const std::uint8_t> bytes) {
    Status status;
    if (file != nullptr) {
      if (std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size())
        status = core::Error{path + ": cannot be written (is the disk full?)"};
    } else {
      status = sink(bytes);
    }
    if (status)
      written += bytes.size();
    else
      broken = true;
    return status;
  }
  Status chunk(Tag tag, const std::vector<std::uint8_t>& payload) {
    if (payload.size() > max_payload) return core::Error{"found a frame of more than 1 GiB"};
    ByteWriter out;
    out.bytes.reserve(chunk_header_size + payload.size());
    out.fixed(std::uint32_t(tag));
    out.fixed(std::uint32_t(payload.size()));
    out.fixed(chunk_hash(tag, payload));
    out.bytes.insert(out.bytes.end(), payload.begin(), payload.end());
    return put(out.bytes);
  }
  Status begin(const RecordingHeader& header) {
    if (header.dimension != 2 && header.dimension != 3)
      return core::Error{"dimension: found " + std::to_string(header.dimension) + ", expected 2 or 3"};
    if (!math::is_finite(header.dt) || !(header.dt > 0)) return core::Error{"dt: expected a finite time above zero"};
    codec = detail::FrameCodec(header.dimension);
    ByteWriter preamble;
    preamble.bytes.assign(preamble_magic, preamble_magic + 8);
    preamble.fixed(recording_version);
    preamble.fixed(std::uint32_t{0});
    if (const Status status = put(preamble.bytes); !status) return status;
    ByteWriter body;
    body.number(header.dt);
    body.fixed(std::uint8_t(header.dimension));
    body.text(header.name);
    body.text(header.scene);
    body.text(header.declaration);
    body.varint(header.meshes.size());
    for (const std::string& mesh : header.meshes) body.text(mesh);
    body.text(header.origin);
    body.varint(header.files.size());
    for (const RecordedFile& one : header.files) {
      body.text(one.name);
      body.text(one.bytes);
    }
    return chunk(tag_header, body.bytes);
  }
  ~Implementation() {
    if (file != nullptr) std::fclose(file);
  }
};

Recorder::Recorder() = default;
Recorder::~Recorder() {
  if (self_ && !self_->finished && !self_->broken) (void)finish();
}
Recorder::Recorder(Recorder&&) noexcept = default;
Recorder& Recorder::operator=(Recorder&& other) noexcept {
  if (this == &other) return *this;
  if (self_ && !self_->finished && !self_->broken) (void)finish();
  self_ = std::move(other.self_);
  return *this;
}

Result<Recorder> Recorder::open(const std::string& path, const RecordingHeader& header,
                                const RecorderOptions& options) {
  Recorder recorder;
  recorder.self_ = std::make_unique<Implementation>();
  recorder.self_->path = path;
  recorder.self_->options = options;
  recorder.self_->file = std::fopen(path.c_str(), "wb");
  if (recorder.self_->file == nullptr) {
    recorder.self_->broken = true;
    return core::Error{path + ": cannot be created"};
  }
  if (const Status begun = recorder.self_->begin(header); !begun) {
    recorder.self_->broken = true;
    return begun.error();
  }
  return recorder;
}
Result<Recorder> Recorder::open(Sink sink, const RecordingHeader& header, const RecorderOptions& options) {
  if (!sink) return core::Error{"the recorder has nowhere to write to"};
  Recorder recorder;
  recorder.self_ = std::make_unique<Implementation>();
  recorder.self_->sink = std::move(sink);
  recorder.self_->options = options;
  if (const Status begun = recorder.self_->begin(header); !begun) {
    recorder.self_->broken = true;
    return begun.error();
  }
  return recorder;
}

Status Recorder::add(const RecordedFrame& frame) {
  if (!self_ || self_->broken || self_->finished) return core::Error{"the recorder is closed"};
  if (!self_->index.empty() && (frame.step <= self_->index.back().step || !(frame.time >= self_->index.back().time)))
    return core::Error{"found a frame of step " + std::to_string(frame.step) + " after one of step " +
                       std::to_string(self_->index.back().step) + ", expected rising steps and times"};
  if (!math::is_finite(frame.time)) return core::Error{"time: expected a finite number"};
  for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
    const RecordedBody& b = frame.bodies[i];
    if (i > 0 && b.id <= frame.bodies[i - 1].id) return core::Error{"found bodies out of order, expected rising ids"};
    if (!math::is_finite(b.position) || !math::is_finite(b.rotation))
      return core::Error{"body " + std::to_string(b.id) + ": expected a finite pose"};
  }
  if (const Status picture = check_picture(frame.picture); !picture) return picture;
  const std::size_t interval = std::size_t(std::max(self_->options.key_interval, 1));
  const bool key = self_->index.size() % interval == 0;
  ByteWriter payload;
  self_->codec.encode(frame, key, payload);
  const FrameEntry entry{self_->written, frame.step, frame.time, key};
  if (const Status status = self_->chunk(key ? tag_key : tag_delta, payload.bytes); !status) return status;
  if (key && self_->file != nullptr) std::fflush(self_->file);
  self_->index.push_back(entry);
  return {};
}

Status Recorder::introduce(const RecordedArrival& arrival) {
  if (!self_ || self_->broken || self_->finished) return core::Error{"the recorder is closed"};
  ByteWriter payload;
  payload.text(arrival.bodies);
  payload.varint(arrival.meshes.size());
  for (const std::string& mesh : arrival.meshes) payload.text(mesh);
  self_->arrivals.push_back(self_->written);
  return self_->chunk(tag_bodies, payload.bytes);
}

Status Recorder::finish() {
  if (!self_ || self_->broken || self_->finished) return core::Error{"the recorder is closed"};
  self_->finished = true;
  const std::uint64_t at = self_->written;
  ByteWriter payload;
  payload.varint(self_->index.size());
  std::uint64_t offset = 0, step = 0;
  for (const FrameEntry& e : self_->index) {
    payload.varint((e.offset - offset) << 1 | (e.key ? 1 : 0));
    payload.varint(e.step - step);
    payload.number(e.time);
    offset = e.offset;
    step = e.step;
  }
  payload.varint(self_->arrivals.size());
  offset = 0;
  for (const std::uint64_t at_arrival : self_->arrivals) {
    payload.varint(at_arrival - offset);
    offset = at_arrival;
  }
  if (const Status status = self_->chunk(tag_index, payload.bytes); !status) return status;
  ByteWriter trailer;
  trailer.fixed(at);
  trailer.fixed(std::uint64_t(self_->index.size()));
  trailer.bytes.insert(trailer.bytes.end(), trailer_magic, trailer_magic + 8);
  if (const Status status = self_->put(trailer.bytes); !status) return status;
  if (self_->file == nullptr) return {};
  const bool closed = std::fclose(self_->file) == 0;
  self_->file = nullptr;
  return closed ? Status{} : Status{core::Error{self_->path + ": cannot be written (is the disk full?)"}};
}

std::uint64_t Recorder::bytes_written() const { return self_ ? self_->written : 0; }

}  // namespace carom::scene
