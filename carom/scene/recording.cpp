#include "carom/scene/recording.h"

#include <algorithm>
#include <cstring>

#include "carom/core/hash.h"
#include "carom/scene/detail/frame_codec.h"

namespace carom::scene {
namespace {
using detail::ByteReader;
using detail::ByteWriter;

constexpr char preamble_magic[] = "CAROMREC", trailer_magic[] = "CAROMEND";
constexpr std::uint32_t recording_version = 1;
constexpr std::size_t preamble_size = 16, chunk_header_size = 16, trailer_size = 24;
constexpr std::uint32_t max_payload = 1u << 30;
enum Tag : std::uint8_t { tag_header = 'H', tag_key = 'K', tag_delta = 'D', tag_index = 'I' };

std::uint64_t chunk_hash(std::uint8_t tag, std::span<const std::uint8_t> payload) {
  core::StateHash hash;
  hash.add(std::uint32_t(tag));
  hash.add(std::string_view(reinterpret_cast<const char*>(payload.data()), payload.size()));
  return hash.digest();
}

struct FrameEntry {
  std::uint64_t offset = 0, step = 0;
  double time = 0;
  bool key = false;
};

/// Bytes in memory or in an open file.
class Source {
 public:
  std::vector<std::uint8_t> bytes;
  std::FILE* file = nullptr;
  std::uint64_t size = 0;

  Source() = default;
  Source(const Source&) = delete;
  Source& operator=(const Source&) = delete;
  ~Source() {
    if (file != nullptr) std::fclose(file);
  }
  bool read(std::uint64_t offset, std::size_t count, std::vector<std::uint8_t>& out) {
    if (offset > size || count > size - offset) return false;
    if (file == nullptr) {
      out.assign(bytes.begin() + std::ptrdiff_t(offset), bytes.begin() + std::ptrdiff_t(offset + count));
      return true;
    }
    out.resize(count);
    if (std::fseek(file, long(offset), SEEK_SET) != 0) return false;
    return std::fread(out.data(), 1, count, file) == count;
  }
};

}  // namespace

// ---- Recorder

struct Recorder::Implementation {
  Sink sink;
  std::FILE* file = nullptr;
  std::string path;
  RecorderOptions options;
  detail::FrameCodec codec;
  std::uint64_t written = 0;
  std::vector<FrameEntry> index;
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

// ---- Recording

struct Recording::Implementation {
  Source source;
  std::string name;  ///< of the file, for messages
  RecordingHeader header;
  std::vector<FrameEntry> frames;
  bool complete = false;
  std::string damage;
  detail::FrameCodec codec;
  std::size_t decoded = 0;  ///< frames [.., decoded) are in the codec; 0: none
  RecordedFrame current;

  core::Error error(const std::string& what) const { return core::Error{name + ": " + what}; }

  /// Reads and checks the chunk at `offset`. On failure `why` says what is wrong.
  bool read_chunk(std::uint64_t offset, std::uint8_t& tag, std::vector<std::uint8_t>& payload, std::string& why) {
    std::vector<std::uint8_t> head;
    if (!source.read(offset, chunk_header_size, head)) {
      why = "byte " + std::to_string(offset) + ": found the end of the file within a chunk's header";
      return false;
    }
    ByteReader in(head);
    const std::uint32_t tag_word = in.fixed<std::uint32_t>(), size = in.fixed<std::uint32_t>();
    const std::uint64_t hash = in.fixed<std::uint64_t>();
    tag = std::uint8_t(tag_word);
    const bool known = tag_word == tag_header || tag_word == tag_key || tag_word == tag_delta || tag_word == tag_index;
    if (!known || size > max_payload) {
      why = "byte " + std::to_string(offset) + ": found no chunk, expected a header, frame or index";
      return false;
    }
    if (!source.read(offset + chunk_header_size, size, payload)) {
      why = "byte " + std::to_string(offset) + ": found the end of the file within a chunk of " + std::to_string(size) +
            " bytes";
      return false;
    }
    if (chunk_hash(tag, payload) != hash) {
      why = "byte " + std::to_string(offset) + ": the checksum of this chunk is wrong";
      return false;
    }
    return true;
  }

  bool read_header(const std::vector<std::uint8_t>& payload) {
    ByteReader in(payload);
    header.version = recording_version;
    header.dt = in.number();
    header.dimension = in.fixed<std::uint8_t>();
    header.name = in.text();
    header.scene = in.text();
    header.declaration = in.text();
    header.meshes.resize(in.count(1));
    for (std::string& mesh : header.meshes) mesh = in.text();
    return in.good() && in.left() == 0 && math::is_finite(header.dt) && header.dt > 0 &&
           (header.dimension == 2 || header.dimension == 3);
  }

  /// True where trailer and index are there and agree with the file.
  bool read_index(std::uint64_t first_frame) {
    std::vector<std::uint8_t> bytes;
    if (source.size < trailer_size || !source.read(source.size - trailer_size, trailer_size, bytes)) return false;
    ByteReader trailer(bytes);
    const std::uint64_t at = trailer.fixed<std::uint64_t>(), count = trailer.fixed<std::uint64_t>();
    if (std::memcmp(bytes.data() + 16, trailer_magic, 8) != 0 || at < first_frame) return false;
    std::uint8_t tag = 0;
    std::vector<std::uint8_t> payload;
    std::string why;
    if (!read_chunk(at, tag, payload, why) || tag != tag_index) return false;
    if (at + chunk_header_size + payload.size() + trailer_size != source.size) return false;
    ByteReader in(payload);
    if (in.count(10) != count || !in.good()) return false;
    frames.resize(std::size_t(count));
    std::uint64_t offset = 0, step = 0;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      const std::uint64_t word = in.varint(), steps = in.varint();
      offset += word >> 1;
      step += steps;
      const double time = in.number();
      frames[i] = {offset, step, time, (word & 1) != 0};
      const bool ordered =
          i == 0 ? offset == first_frame && frames[0].key : word >> 1 != 0 && steps != 0 && time >= frames[i - 1].time;
      if (!in.good() || !ordered || offset >= at || !math::is_finite(time)) return frames.clear(), false;
    }
    return in.left() == 0;
  }

  /// Finds the frames again by walking over the chunks.
  void scan(std::uint64_t offset) {
    frames.clear();
    std::vector<std::uint8_t> payload;
    while (offset < source.size) {
      std::uint8_t tag = 0;
      if (!read_chunk(offset, tag, payload, damage)) return;
      if (tag == tag_index) {
        damage = "byte " + std::to_string(offset) + ": the index is not followed by a whole end of the file";
        return;
      }
      ByteReader in(payload);
      FrameEntry entry{offset, in.varint(), in.number(), tag == tag_key};
      const bool first = frames.empty();
      const bool ordered = first ? entry.key : entry.step > frames.back().step && entry.time >= frames.back().time;
      if (tag == tag_header || !in.good() || !math::is_finite(entry.time) || !ordered) {
        damage = "byte " + std::to_string(offset) + ": found a chunk that does not belong here";
        return;
      }
      frames.push_back(entry);
      offset += chunk_header_size + payload.size();
    }
    damage = "the file ends without its index: the recording was not finished";
  }

  Status open() {
    std::vector<std::uint8_t> bytes;
    if (!source.read(0, preamble_size, bytes) || std::memcmp(bytes.data(), preamble_magic, 8) != 0)
      return error("found no recording, expected a file that begins with CAROMREC");
    ByteReader preamble(std::span<const std::uint8_t>(bytes).subspan(8));
    const std::uint32_t version = preamble.fixed<std::uint32_t>();
    if (version != recording_version)
      return error("found a recording of version " + std::to_string(version) + ", expected version " +
                   std::to_string(recording_version));
    std::uint8_t tag = 0;
    std::string why;
    if (!read_chunk(preamble_size, tag, bytes, why)) return error(why);
    if (tag != tag_header || !read_header(bytes)) return error("byte 16: found no whole header");
    codec = detail::FrameCodec(header.dimension);
    const std::uint64_t first = preamble_size + chunk_header_size + bytes.size();
    complete = read_index(first);
    if (!complete) scan(first);
    return {};
  }
};

Recording::Recording() = default;
Recording::~Recording() = default;
Recording::Recording(Recording&&) noexcept = default;
Recording& Recording::operator=(Recording&&) noexcept = default;

Result<Recording> Recording::open(const std::string& path) {
  Recording recording;
  recording.self_ = std::make_unique<Implementation>();
  Implementation& self = *recording.self_;
  self.name = path;
  self.source.file = std::fopen(path.c_str(), "rb");
  if (self.source.file == nullptr) return core::Error{path + ": cannot be opened"};
  if (std::fseek(self.source.file, 0, SEEK_END) != 0) return core::Error{path + ": cannot be read"};
  const long size = std::ftell(self.source.file);
  if (size < 0) return core::Error{path + ": cannot be read"};
  self.source.size = std::uint64_t(size);
  if (const Status opened = self.open(); !opened) return opened.error();
  return recording;
}

Result<Recording> Recording::from_bytes(std::vector<std::uint8_t> bytes) {
  Recording recording;
  recording.self_ = std::make_unique<Implementation>();
  Implementation& self = *recording.self_;
  self.name = "recording";
  self.source.size = bytes.size();
  self.source.bytes = std::move(bytes);
  if (const Status opened = self.open(); !opened) return opened.error();
  return recording;
}

const RecordingHeader& Recording::header() const { return self_->header; }
std::size_t Recording::frame_count() const { return self_->frames.size(); }
double Recording::first_time() const { return self_->frames.empty() ? 0 : self_->frames.front().time; }
double Recording::last_time() const { return self_->frames.empty() ? 0 : self_->frames.back().time; }
bool Recording::complete() const { return self_->complete; }
const std::string& Recording::damage() const { return self_->damage; }

Result<RecordedFrame> Recording::frame(std::size_t index) {
  Implementation& self = *self_;
  if (index >= self.frames.size())
    return self.error("found frame " + std::to_string(index) + ", expected one below " +
                      std::to_string(self.frames.size()));
  if (self.decoded == index + 1) return self.current;
  std::size_t from = index;
  while (!self.frames[from].key) --from;  // the first frame is a key frame: checked when opened
  if (self.decoded > from && self.decoded <= index) from = self.decoded;
  std::vector<std::uint8_t> payload;
  for (std::size_t i = from; i <= index; ++i) {
    const FrameEntry& entry = self.frames[i];
    std::uint8_t tag = 0;
    std::string why;
    self.decoded = 0;
    if (!self.read_chunk(entry.offset, tag, payload, why)) return self.error(why);
    if (tag != (entry.key ? tag_key : tag_delta) || !self.codec.decode(payload, entry.key, self.current) ||
        self.current.step != entry.step || self.current.time != entry.time)
      return self.error("byte " + std::to_string(entry.offset) +
                        ": found no frame that the index or the frames before agree with");
    self.decoded = i + 1;
  }
  return self.current;
}

std::size_t Recording::index_at_time(double time) const {
  const auto after = std::upper_bound(self_->frames.begin(), self_->frames.end(), time,
                                      [](double t, const FrameEntry& e) { return t < e.time; });
  return after == self_->frames.begin() ? 0 : std::size_t(after - self_->frames.begin()) - 1;
}
std::size_t Recording::index_at_step(std::uint64_t step) const {
  const auto after = std::upper_bound(self_->frames.begin(), self_->frames.end(), step,
                                      [](std::uint64_t s, const FrameEntry& e) { return s < e.step; });
  return after == self_->frames.begin() ? 0 : std::size_t(after - self_->frames.begin()) - 1;
}

}  // namespace carom::scene
