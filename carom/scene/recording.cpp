#include "carom/scene/recording.h"

#include <algorithm>
#include <cstring>

#include "carom/scene/detail/frame_codec.h"
#include "carom/scene/detail/recording_chunks.h"

namespace carom::scene {
namespace {
using detail::ByteReader;
using detail::chunk_hash;
using detail::chunk_header_size;
using detail::FrameEntry;
using detail::max_payload;
using detail::preamble_magic;
using detail::preamble_size;
using detail::recording_version;
using detail::tag_bodies;
using detail::tag_delta;
using detail::tag_header;
using detail::tag_index;
using detail::tag_key;
using detail::trailer_magic;
using detail::trailer_size;

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

struct Recording::Implementation {
  Source source;
  std::string name;  ///< of the file, for messages
  RecordingHeader header;
  std::vector<RecordedArrival> arrivals;
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
    const bool known = tag_word == tag_header || tag_word == tag_key || tag_word == tag_delta ||
                       tag_word == tag_bodies || tag_word == tag_index;
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
    header.dt = in.number();
    header.dimension = in.fixed<std::uint8_t>();
    header.name = in.text();
    header.scene = in.text();
    header.declaration = in.text();
    header.meshes.resize(in.count(1));
    for (std::string& mesh : header.meshes) mesh = in.text();
    if (header.version >= 2) {
      header.origin = in.text();
      header.files.resize(in.count(2));
      for (RecordedFile& one : header.files) {
        one.name = in.text();
        one.bytes = in.text();
      }
    }
    return in.good() && in.left() == 0 && math::is_finite(header.dt) && header.dt > 0 &&
           (header.dimension == 2 || header.dimension == 3);
  }

  bool read_arrival(const std::vector<std::uint8_t>& payload) {
    ByteReader in(payload);
    RecordedArrival arrival;
    arrival.bodies = in.text();
    arrival.meshes.resize(in.count(1));
    for (std::string& mesh : arrival.meshes) mesh = in.text();
    if (!in.good() || in.left() != 0) return false;
    arrivals.push_back(std::move(arrival));
    return true;
  }

  /// True where trailer and index are there and agree with the file.
  bool read_index(std::uint64_t first_frame) {
    std::vector<std::uint8_t> bytes;
    if (source.size < trailer_size || !source.read(source.size - trailer_size, trailer_size, bytes)) return false;
    ByteReader trailer(bytes);
    const std::uint64_t at = trailer.fixed<std::uint64_t>(), count = trailer.fixed<std::uint64_t>();
    if (std::memcmp(bytes.data() + 16, trailer_magic, 8) != 0 || at < first_frame) return false;
    std::uint8_t tag = 0;
    std::vector<std::uint8_t> payload, payload_of_arrival;
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
          i == 0 ? offset >= first_frame && frames[0].key : word >> 1 != 0 && steps != 0 && time >= frames[i - 1].time;
      if (!in.good() || !ordered || offset >= at || !math::is_finite(time)) return frames.clear(), false;
    }
    if (header.version < 2) return in.left() == 0;
    const std::size_t coming = in.count(1);
    offset = 0;
    for (std::size_t i = 0; i < coming && in.good(); ++i) {
      const std::uint64_t word = in.varint();
      offset += word;
      if (!in.good() || word == 0 || offset < first_frame || offset >= at) return frames.clear(), false;
      if (!read_chunk(offset, tag, payload_of_arrival, why) || tag != tag_bodies || !read_arrival(payload_of_arrival))
        return frames.clear(), false;
    }
    return in.good() && in.left() == 0;
  }

  /// Finds the frames again by walking over the chunks.
  void scan(std::uint64_t offset) {
    frames.clear();
    arrivals.clear();
    std::vector<std::uint8_t> payload;
    while (offset < source.size) {
      std::uint8_t tag = 0;
      if (!read_chunk(offset, tag, payload, damage)) return;
      if (tag == tag_index) {
        damage = "byte " + std::to_string(offset) + ": the index is not followed by a whole end of the file";
        return;
      }
      if (tag == tag_bodies && header.version >= 2) {
        if (!read_arrival(payload)) {
          damage = "byte " + std::to_string(offset) + ": found no list of bodies, expected one";
          return;
        }
        offset += chunk_header_size + payload.size();
        continue;
      }
      ByteReader in(payload);
      FrameEntry entry{offset, in.varint(), in.number(), tag == tag_key};
      const bool first = frames.empty();
      const bool ordered = first ? entry.key : entry.step > frames.back().step && entry.time >= frames.back().time;
      if (tag == tag_header || tag == tag_bodies || !in.good() || !math::is_finite(entry.time) || !ordered) {
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
    if (version < 1 || version > recording_version)
      return error("found a recording of version " + std::to_string(version) + ", expected version 1 to " +
                   std::to_string(recording_version));
    header.version = version;
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
const std::vector<RecordedArrival>& Recording::arrivals() const { return self_->arrivals; }
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
