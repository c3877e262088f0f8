// Frames as bytes. A key frame stands alone; the others hold what differs from the motion foretold by the two frames
// before, bit for bit, so that playing gives exactly what was recorded.
#pragma once

#include "carom/scene/detail/bytes.h"
#include "carom/scene/detail/picture_codec.h"
#include "carom/scene/recording.h"

namespace carom::scene::detail {

class FrameCodec {
 public:
  explicit FrameCodec(int dimension = 3) : dimension_(dimension) {}

  void encode(const RecordedFrame& frame, bool key, ByteWriter& out);
  /// False where the bytes are not those of a frame. `frame` is then unspecified, and so is this codec until the next
  /// key frame.
  bool decode(std::span<const std::uint8_t> bytes, bool key, RecordedFrame& frame);

 private:
  struct Track {
    std::uint32_t id = 0;
    bool asleep = false;
    std::uint64_t now[7] = {}, before[7] = {};  ///< bits: three doubles, four floats
  };
  std::uint64_t foretold(const Track& track, int component) const;
  bool used(int component) const { return dimension_ == 3 || (component != 2 && component != 4 && component != 5); }

  bool decode_bodies(ByteReader& in, bool key, RecordedFrame& frame);

  int dimension_;
  std::vector<Track> tracks_, next_;
  PictureCodec picture_;
  std::string message_;
  std::vector<double> values_;
};

}  // namespace carom::scene::detail
