// STL, text and binary. The facets' normals are not used: they are often wrong, the order of the corners seldom.
#include <cstring>

#include "carom/geometry/detail/mesh_formats.h"
#include "carom/geometry/detail/text.h"
#include "carom/math/decimal.h"

namespace carom::geometry::detail {

namespace {

namespace stl {

constexpr std::size_t header = 84, facet = 50;

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t k = 0; k < 4; ++k) value |= std::uint32_t(static_cast<unsigned char>(bytes[at + k])) << (8 * k);
  return value;
}
float float_at(std::string_view bytes, std::size_t at) {
  const std::uint32_t bits = little_endian(bytes, at);
  float value;
  std::memcpy(&value, &bits, sizeof value);
  return value;
}

core::Result<MeshFile> parse_binary(std::string_view bytes, std::size_t count) {
  MeshFile mesh;
  mesh.vertices.reserve(3 * count);
  mesh.indices.reserve(3 * count);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = header + facet * i + 12 * (k + 1);
      const Vec3f v{float_at(bytes, at), float_at(bytes, at + 4), float_at(bytes, at + 8)};
      if (!is_finite(v)) return error("corner %zu of facet %zu is not a finite point", k + 1, i + 1);
      mesh.indices.push_back(std::uint32_t(mesh.vertices.size()));
      mesh.vertices.push_back(Vec3d(v));
    }
  return mesh;
}

class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}
  std::size_t line = 1;

  std::string_view next() {
    while (at_ < text_.size() && is_space(text_[at_])) line += text_[at_++] == '\n';
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  void skip_line() { at_ = min(text_.find('\n', at_), text_.size()); }

 private:
  static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
  std::string_view text_;
  std::size_t at_ = 0;
};

core::Result<MeshFile> parse_text(std::string_view text, const MeshFileOptions& options) {
  MeshFile mesh;
  mesh.parts = 0;
  Words words(text);
  std::size_t corners = 0;
  bool in_facet = false;
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (word == "solid") {
      ++mesh.parts;
      words.skip_line();
    } else if (word == "endsolid") {
      words.skip_line();
    } else if (word == "facet") {
      if (in_facet) return error("line %zu: a facet begins within a facet", words.line);
      in_facet = true;
      corners = 0;
      words.skip_line();
    } else if (word == "vertex") {
      Vec3d v{};
      for (int k = 0; k < 3; ++k) {
        const std::string_view number = words.next();
        const math::DecimalResult parsed = math::parse_decimal(number);
        if (number.empty() || parsed.length != number.size() || !is_finite(parsed.value))
          return error("line %zu: coordinate %d of the vertex is not a number", words.line, k + 1);
        v[k] = parsed.value;
      }
      if (!in_facet || ++corners > 3) return error("line %zu: a vertex that belongs to no triangle", words.line);
      mesh.indices.push_back(std::uint32_t(mesh.vertices.size()));
      mesh.vertices.push_back(v);
    } else if (word == "endfacet") {
      if (!in_facet || corners != 3)
        return error("line %zu: the facet has %zu corners, expected 3", words.line, corners);
      if (mesh.indices.size() / 3 > options.max_triangles)
        return error("line %zu: more than %zu triangles", words.line, options.max_triangles);
      in_facet = false;
    } else if (word != "outer" && word != "loop" && word != "endloop") {
      return error("line %zu: expected solid, facet, outer loop, vertex, endloop, endfacet or endsolid", words.line);
    }
  }
  if (in_facet) return error("line %zu: the file ends within a facet", words.line);
  if (mesh.indices.empty()) return error("no facet in %zu lines", words.line);
  return mesh;
}

}  // namespace stl

}  // namespace

core::Result<MeshFile> parse_stl(std::string_view bytes, const MeshFileOptions& options) {
  using namespace stl;
  const std::size_t count = bytes.size() >= header ? little_endian(bytes, header - 4) : 0;
  const bool fits = bytes.size() >= header && (bytes.size() - header) / facet >= count;
  const bool exact = fits && bytes.size() == header + facet * count;
  // Some programs begin their binary files with the word that marks text, so the length decides first.
  if (!exact && bytes.substr(0, 5) == "solid") return parse_text(bytes, options);
  if (bytes.size() < header)
    return error("%zu bytes: neither text that begins with 'solid' nor a binary STL", bytes.size());
  if (!fits)
    return error("the header announces %zu facets, but the %zu bytes hold only %zu", count, bytes.size(),
                 (bytes.size() - header) / facet);
  if (count == 0) return error("the header announces no facets");
  if (count > options.max_triangles) return error("%zu triangles, expected at most %zu", count, options.max_triangles);
  return parse_binary(bytes, count);
}

}  // namespace carom::geometry::detail
