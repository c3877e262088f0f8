#include "carom/scene/detail/picture_codec.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace carom::scene::detail {
namespace {

constexpr std::size_t max_lines = 1u << 18, max_points = 1u << 20, max_surfaces = 4096, max_corners = 1u << 22,
                      max_indices = 1u << 24;
constexpr int point_bits = 16, surface_bits = 18, line_bits = 22;

std::int64_t on_grid(double x, int exponent) {
  const double steps = std::ldexp(x, -exponent);
  if (!math::is_finite(steps)) return 0;
  return std::int64_t(std::floor(math::clamp(steps, -0.9 * double(stream_limit), 0.9 * double(stream_limit)) + 0.5));
}

}  // namespace

core::Status check_picture(const RecordedPicture& picture) {
  if (picture.radii.size() != picture.points.size() || picture.point_rgbas.size() != picture.points.size())
    return core::Error{"points: found " + std::to_string(picture.points.size()) + " places, " +
                       std::to_string(picture.radii.size()) + " radii and " +
                       std::to_string(picture.point_rgbas.size()) + " colours, expected as many of each"};
  std::size_t corners = 0, indices = 0;
  for (const RecordedSurface& surface : picture.surfaces) {
    corners += surface.corners.size();
    indices += surface.triangles.size();
    if (surface.triangles.size() % 3 != 0) return core::Error{"surface: expected three corners a triangle"};
    for (const std::uint32_t corner : surface.triangles)
      if (corner >= surface.corners.size())
        return core::Error{"surface: a triangle names corner " + std::to_string(corner) + " of " +
                           std::to_string(surface.corners.size())};
  }
  if (picture.lines.size() > max_lines || picture.points.size() > max_points ||
      picture.surfaces.size() > max_surfaces || corners > max_corners || indices > max_indices)
    return core::Error{"picture: expected at most " + std::to_string(max_lines) + " lines, " +
                       std::to_string(max_points) + " points and " + std::to_string(max_corners) + " corners"};
  return {};
}

void PictureCodec::Colors::clear() {
  for (StreamCodec& one : bytes) one.clear();
}

void PictureCodec::clear() {
  for (Places* places : {&starts_, &ends_, &points_}) places->clear();
  line_colors_.clear();
  point_colors_.clear();
  radii_.clear();
  sheets_.clear();
  shown_ = false;
}

bool PictureCodec::holds(const RecordedPicture& picture, bool key) const {
  return !picture.lines.empty() || !picture.points.empty() || !picture.surfaces.empty() || (shown_ && !key);
}

template <class At>
void PictureCodec::encode_places(Places& places, std::size_t count, int bits, bool key, const At& at, ByteWriter& out) {
  if (count == 0) return places.clear();
  if (key) {
    double low[3] = {}, high[3] = {};
    for (std::size_t i = 0; i < count; ++i)
      for (int k = 0; k < 3; ++k) {
        const double x = at(i, k);
        low[k] = i == 0 ? x : math::min(low[k], x);
        high[k] = i == 0 ? x : math::max(high[k], x);
      }
    const double size = math::max(high[0] - low[0], math::max(high[1] - low[1], high[2] - low[2]));
    places.exponent = math::is_finite(size) && size > 0 ? std::clamp(std::ilogb(size) + 1 - bits, -60, 60) : -13;
    out.fixed(std::uint8_t(places.exponent));
  }
  StreamCodec* const streams[] = {&places.x, &places.y, &places.z};
  for (int k = 0; k < 3; ++k) {
    numbers_.resize(count);
    for (std::size_t i = 0; i < count; ++i) numbers_[i] = on_grid(at(i, k), places.exponent);
    streams[k]->encode(numbers_, key, out);
  }
}

template <class At>
void PictureCodec::encode_colors(Colors& colors, std::size_t count, bool key, const At& at, ByteWriter& out) {
  numbers_.resize(count);
  for (int k = 0; k < 4; ++k) {
    for (std::size_t i = 0; i < count; ++i) numbers_[i] = at(i) >> (8 * k) & 255;
    colors.bytes[k].encode(numbers_, key, out);
  }
}

void PictureCodec::encode(const RecordedPicture& picture, bool key, ByteWriter& out) {
  // A grid is chosen in a key frame: what was not there then begins as in one.
  const bool fresh = key || !shown_;
  out.fixed(std::uint8_t(fresh));
  if (fresh) clear();
  const std::vector<RecordedLine>& lines = picture.lines;
  const auto grid_new = [fresh](const StreamCodec& stream) { return fresh || stream.empty(); };
  out.varint(lines.size());
  if (!lines.empty()) {
    const bool anew = grid_new(starts_.x);
    encode_places(starts_, lines.size(), line_bits, anew, [&](std::size_t i, int k) { return lines[i].a[k]; }, out);
    encode_places(ends_, lines.size(), line_bits, anew, [&](std::size_t i, int k) { return lines[i].b[k]; }, out);
    encode_colors(line_colors_, lines.size(), anew, [&](std::size_t i) { return lines[i].rgba; }, out);
  } else {
    starts_.clear(), ends_.clear(), line_colors_.clear();
  }
  const std::size_t points = picture.points.size();
  out.varint(points);
  if (points > 0) {
    const bool anew = grid_new(points_.x);
    encode_places(
        points_, points, point_bits, anew, [&](std::size_t i, int k) { return double(picture.points[i][k]); }, out);
    numbers_.resize(points);
    for (std::size_t i = 0; i < points; ++i) numbers_[i] = std::bit_cast<std::uint32_t>(picture.radii[i]);
    radii_.encode(numbers_, anew, out);
    encode_colors(point_colors_, points, anew, [&](std::size_t i) { return picture.point_rgbas[i]; }, out);
  } else {
    points_.clear(), radii_.clear(), point_colors_.clear();
  }
  out.varint(picture.surfaces.size());
  sheets_.resize(picture.surfaces.size());
  for (std::size_t s = 0; s < picture.surfaces.size(); ++s) {
    const RecordedSurface& surface = picture.surfaces[s];
    Sheet& sheet = sheets_[s];
    const bool anew = grid_new(sheet.places.x), turned = anew || sheet.known != surface.triangles;
    out.varint(surface.corners.size());
    out.fixed(surface.rgba);
    encode_places(
        sheet.places, surface.corners.size(), surface_bits, anew,
        [&](std::size_t i, int k) { return double(surface.corners[i][k]); }, out);
    out.fixed(std::uint8_t(turned));
    if (!turned) continue;
    sheet.known = surface.triangles;
    out.varint(sheet.known.size());
    numbers_.assign(sheet.known.begin(), sheet.known.end());
    sheet.triangles.encode(numbers_, true, out);
  }
  shown_ = true;
}

bool PictureCodec::decode_places(Places& places, std::size_t count, bool key, ByteReader& in,
                                 std::vector<math::Vec3d>& out) {
  out.resize(0);
  if (count == 0) return places.clear(), true;
  if (key) {
    const int byte = in.fixed<std::uint8_t>();
    places.exponent = byte < 128 ? byte : byte - 256;
  }
  if (places.exponent < -60 || places.exponent > 60) return false;
  StreamCodec* const streams[] = {&places.x, &places.y, &places.z};
  for (int k = 0; k < 3; ++k) {
    const std::span<const std::int64_t> numbers = streams[k]->decode(count, key, in);
    if (!in.good()) return false;
    out.resize(count);
    for (std::size_t i = 0; i < count; ++i) out[i][k] = std::ldexp(double(numbers[i]), places.exponent);
  }
  return true;
}

bool PictureCodec::decode_colors(Colors& colors, std::size_t count, bool key, ByteReader& in,
                                 std::vector<std::uint32_t>& out) {
  out.assign(count, 0);
  for (int k = 0; k < 4; ++k) {
    const std::span<const std::int64_t> numbers = colors.bytes[k].decode(count, key, in);
    if (!in.good()) return false;
    for (std::size_t i = 0; i < count; ++i) out[i] |= std::uint32_t(numbers[i] & 255) << (8 * k);
  }
  return true;
}

bool PictureCodec::decode(ByteReader& in, bool key, RecordedPicture& picture) {
  const bool fresh = in.fixed<std::uint8_t>() != 0;
  if (!fresh && (key || !shown_)) return false;
  if (fresh) clear();
  const auto grid_new = [fresh](const StreamCodec& stream) { return fresh || stream.empty(); };
  const auto how_many = [&in](std::size_t most) {
    const std::uint64_t n = in.varint();
    if (n > most || StreamCodec::least_bytes(std::size_t(n)) > in.left()) in.spoil();
    return in.good() ? std::size_t(n) : std::size_t{0};
  };
  std::vector<math::Vec3d> a, b;
  std::vector<std::uint32_t> rgbas;

  picture.lines.resize(how_many(max_lines));
  const bool lines_anew = grid_new(starts_.x);
  if (!decode_places(starts_, picture.lines.size(), lines_anew, in, a) ||
      !decode_places(ends_, picture.lines.size(), lines_anew, in, b))
    return false;
  if (picture.lines.empty())
    line_colors_.clear();
  else if (!decode_colors(line_colors_, picture.lines.size(), lines_anew, in, rgbas))
    return false;
  for (std::size_t i = 0; i < picture.lines.size(); ++i) picture.lines[i] = {a[i], b[i], rgbas[i]};

  const std::size_t points = how_many(max_points);
  const bool points_anew = grid_new(points_.x);
  picture.points.resize(points);
  picture.radii.resize(points);
  picture.point_rgbas.clear();
  if (!decode_places(points_, points, points_anew, in, a)) return false;
  if (points > 0) {
    const std::span<const std::int64_t> radii = radii_.decode(points, points_anew, in);
    if (!in.good()) return false;
    for (std::size_t i = 0; i < points; ++i) {
      picture.points[i] = math::Vec3f(a[i]);
      picture.radii[i] = std::bit_cast<float>(std::uint32_t(radii[i]));
      if (!math::is_finite(picture.radii[i])) return false;
    }
    if (!decode_colors(point_colors_, points, points_anew, in, picture.point_rgbas)) return false;
  } else {
    radii_.clear(), point_colors_.clear();
  }

  const std::size_t surfaces = in.count(6);
  if (surfaces > max_surfaces) in.spoil();
  if (!in.good()) return false;
  picture.surfaces.resize(surfaces);
  sheets_.resize(surfaces);
  std::size_t corners = 0, indices = 0;
  for (std::size_t s = 0; s < surfaces; ++s) {
    RecordedSurface& surface = picture.surfaces[s];
    Sheet& sheet = sheets_[s];
    const std::size_t count = how_many(max_corners - corners);
    corners += count;
    surface.rgba = in.fixed<std::uint32_t>();
    if (!decode_places(sheet.places, count, grid_new(sheet.places.x), in, a)) return false;
    surface.corners.resize(count);
    for (std::size_t i = 0; i < count; ++i) surface.corners[i] = math::Vec3f(a[i]);
    if (in.fixed<std::uint8_t>() != 0) {
      const std::size_t size = how_many(max_indices - indices);
      const std::span<const std::int64_t> numbers = sheet.triangles.decode(size, true, in);
      if (!in.good() || size % 3 != 0) return false;
      sheet.known.resize(size);
      for (std::size_t i = 0; i < size; ++i) {
        if (numbers[i] < 0 || numbers[i] >= std::int64_t(count)) return false;
        sheet.known[i] = std::uint32_t(numbers[i]);
      }
    }
    indices += sheet.known.size();
    for (const std::uint32_t corner : sheet.known)
      if (corner >= count) return false;
    surface.triangles = sheet.known;
  }
  shown_ = true;
  return in.good();
}

}  // namespace carom::scene::detail
