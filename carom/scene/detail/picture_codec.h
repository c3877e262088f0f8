// What is drawn beside bodies as bytes: places on a grid that a key frame chooses, as streams of whole numbers.
#pragma once

#include <vector>

#include "carom/core/result.h"
#include "carom/scene/detail/stream_codec.h"
#include "carom/scene/recording.h"

namespace carom::scene::detail {

/// Errors: arrays of different lengths, a triangle that names no corner, more than a file may hold.
core::Status check_picture(const RecordedPicture& picture);

class PictureCodec {
 public:
  void clear();
  /// Whether a frame must say anything about this picture.
  bool holds(const RecordedPicture& picture, bool key) const;
  void encode(const RecordedPicture& picture, bool key, ByteWriter& out);
  /// False where the bytes are not those of a picture; this codec is then good again from the next key frame on.
  bool decode(ByteReader& in, bool key, RecordedPicture& picture);

 private:
  struct Places {
    int exponent = 0;  ///< the grid's spacing is 2 to it, m
    StreamCodec x, y, z;
    void clear() { x.clear(), y.clear(), z.clear(); }
  };
  struct Colors {
    StreamCodec bytes[4];
    void clear();
  };
  struct Sheet {
    Places places;
    StreamCodec triangles;
    std::vector<std::uint32_t> known;  ///< triangles as last written or read
  };
  template <class At>
  void encode_places(Places& places, std::size_t count, int bits, bool key, const At& at, ByteWriter& out);
  template <class At>
  void encode_colors(Colors& colors, std::size_t count, bool key, const At& at, ByteWriter& out);
  bool decode_places(Places& places, std::size_t count, bool key, ByteReader& in, std::vector<math::Vec3d>& out);
  bool decode_colors(Colors& colors, std::size_t count, bool key, ByteReader& in, std::vector<std::uint32_t>& out);

  Places starts_, ends_, points_;
  Colors line_colors_, point_colors_;
  StreamCodec radii_;
  std::vector<Sheet> sheets_;
  bool shown_ = false;  ///< the last frame had a picture
  std::vector<std::int64_t> numbers_;
};

}  // namespace carom::scene::detail
