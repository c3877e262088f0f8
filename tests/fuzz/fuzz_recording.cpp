// Recordings from anybody: frames or a clear error, forwards, backwards and by time.
#include <cstdint>
#include <cstdio>
#include <cstdlib>

#include "carom/core/hash.h"
#include "carom/scene/recording.h"
#include "tests/fuzz/target.h"

namespace {

/// Chunk checksums made right again: without this no damage would ever get past them.
void mend(std::vector<std::uint8_t>& bytes) {
  const auto word = [&](std::size_t at) {
    return std::uint32_t(bytes[at]) | std::uint32_t(bytes[at + 1]) << 8 | std::uint32_t(bytes[at + 2]) << 16 |
           std::uint32_t(bytes[at + 3]) << 24;
  };
  for (std::size_t at = 16; at + 16 <= bytes.size();) {
    const std::size_t length = word(at + 4);
    if (length > bytes.size() - at - 16) return;
    carom::core::StateHash hash;
    hash.add(std::uint32_t(bytes[at]));
    hash.add(std::string_view(reinterpret_cast<const char*>(bytes.data()) + at + 16, length));
    const std::uint64_t digest = hash.digest();
    for (std::size_t i = 0; i < 8; ++i) bytes[at + 8 + i] = std::uint8_t(digest >> (8 * i));
    at += 16 + length;
  }
}

void play(std::vector<std::uint8_t> bytes) {
  using namespace carom::scene;
  Result<Recording> recording = Recording::from_bytes(std::move(bytes));
  if (!recording) {
    if (recording.error().message.empty()) std::abort();
    return;
  }
  const std::size_t count = recording->frame_count();
  if (!recording->complete() && recording->damage().empty()) std::abort();
  for (std::size_t i = 0; i < count && i < 40; ++i) (void)recording->frame(i);
  for (std::size_t i = count < 20 ? count : 20; i-- > 0;) (void)recording->frame(i);
  for (const RecordedArrival& arrival : recording->arrivals())
    if (arrival.meshes.size() > 1u << 20) std::abort();
  for (std::size_t i = 0; i < count && i < 10; ++i) {
    const Result<RecordedFrame> frame = recording->frame(i);
    if (!frame) continue;
    // What is given out must be safe to draw.
    const RecordedPicture& picture = frame->picture;
    if (picture.radii.size() != picture.points.size() || picture.point_rgbas.size() != picture.points.size())
      std::abort();
    for (const RecordedSurface& surface : picture.surfaces)
      for (const std::uint32_t corner : surface.triangles)
        if (corner >= surface.corners.size()) std::abort();
  }
  for (const double t : {-1.0, 0.0, 0.5, 1e300})
    if (count > 0 && recording->index_at_time(t) >= count) std::abort();
}

}  // namespace

FUZZ_TARGET(recording) {
  std::vector<std::uint8_t> bytes(data, data + size);
  play(bytes);
  mend(bytes);
  play(std::move(bytes));
}
