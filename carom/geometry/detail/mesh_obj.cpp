// Wavefront OBJ: vertices and faces; everything else in the file says nothing about the shape.
#include "carom/geometry/detail/mesh_formats.h"
#include "carom/geometry/detail/text.h"
#include "carom/math/decimal.h"

namespace carom::geometry::detail {

namespace {

namespace obj {

constexpr std::string_view spaces = " \t\r\v\f";

class Parser {
 public:
  explicit Parser(const MeshFileOptions& options) : options_(options) {}
  core::Status read(std::string_view text);
  MeshFile mesh;

 private:
  core::Status line(std::string_view rest);
  core::Status vertex(std::string_view rest);
  core::Status face(std::string_view rest);

  const MeshFileOptions& options_;
  std::size_t line_ = 0;
  std::vector<std::uint32_t> polygon_;
};

std::string_view next_word(std::string_view& rest) {
  const std::size_t begin = rest.find_first_not_of(spaces);
  if (begin == std::string_view::npos) {
    rest = {};
    return {};
  }
  const std::size_t end = min(rest.find_first_of(spaces, begin), rest.size());
  const std::string_view word = rest.substr(begin, end - begin);
  rest = rest.substr(end);
  return word;
}

std::string quoted(std::string_view word) {
  std::string s = "'";
  for (const char c : word.substr(0, 40)) s += c >= ' ' && c <= '~' ? c : '?';
  return s + (word.size() > 40 ? "…'" : "'");
}

core::Status Parser::vertex(std::string_view rest) {
  Vec3d v{};
  for (int k = 0; k < 3; ++k) {
    const std::string_view word = next_word(rest);
    const math::DecimalResult number = math::parse_decimal(word);
    if (word.empty() || number.length != word.size() || !is_finite(number.value))
      return error("line %zu: coordinate %d of the vertex is %s, expected a number", line_, k + 1,
                   word.empty() ? "missing" : quoted(word).c_str());
    v[k] = number.value;
  }
  mesh.vertices.push_back(v);
  return {};
}

core::Status Parser::face(std::string_view rest) {
  polygon_.clear();
  const std::int64_t count = std::int64_t(mesh.vertices.size());
  for (std::string_view word = next_word(rest); !word.empty(); word = next_word(rest)) {
    if (word[0] == '#') break;
    const bool negative = word[0] == '-';
    std::int64_t index = 0;
    std::size_t k = negative ? 1 : 0;
    const std::size_t first = k;
    for (; k < word.size() && word[k] >= '0' && word[k] <= '9' && index < (std::int64_t(1) << 40); ++k)
      index = 10 * index + (word[k] - '0');
    if (k == first || (k < word.size() && word[k] != '/'))
      return error("line %zu: the face refers to %s, expected the number of a vertex", line_, quoted(word).c_str());
    const std::int64_t vertex = negative ? count - index : index - 1;
    if (vertex < 0 || vertex >= count)
      return error("line %zu: the face refers to vertex %s%lld of %lld before it", line_, negative ? "-" : "",
                   static_cast<long long>(index), static_cast<long long>(count));
    polygon_.push_back(std::uint32_t(vertex));
  }
  if (polygon_.size() < 3)
    return error("line %zu: the face has %zu corners, expected at least 3", line_, polygon_.size());
  if (mesh.indices.size() / 3 + polygon_.size() - 2 > options_.max_triangles)
    return error("line %zu: more than %zu triangles", line_, options_.max_triangles);
  triangulate_polygon(mesh.vertices, polygon_, mesh.indices);
  return {};
}

core::Status Parser::line(std::string_view rest) {
  const std::string_view word = next_word(rest);
  if (word == "v") return vertex(rest);
  if (word == "f" || word == "fo") return face(rest);
  if (word == "o") ++mesh.parts;
  return {};
}

core::Status Parser::read(std::string_view text) {
  mesh.parts = 0;
  std::string joined;  // lines that end in a backslash go on in the next
  while (!text.empty()) {
    const std::size_t end = min(text.find('\n'), text.size());
    std::string_view rest = text.substr(0, end);
    text = text.substr(min(end + 1, text.size()));
    ++line_;
    if (!rest.empty() && rest.back() == '\r') rest.remove_suffix(1);
    if (!rest.empty() && rest.back() == '\\') {
      joined += rest.substr(0, rest.size() - 1);
      joined += ' ';
      continue;
    }
    if (!joined.empty()) {
      joined += rest;
      rest = joined;
    }
    if (auto s = line(rest); !s) return s;
    joined.clear();
  }
  if (!joined.empty())
    if (auto s = line(joined); !s) return s;
  if (mesh.vertices.size() > 0xFFFFFFFFu) return error("more than 2^32 vertices");
  if (mesh.indices.empty())
    return error("%zu lines and %zu vertices, but no face ('f' line)", line_, mesh.vertices.size());
  mesh.parts = max(mesh.parts, 1);
  return {};
}

}  // namespace obj

}  // namespace

core::Result<MeshFile> parse_obj(std::string_view text, const MeshFileOptions& options) {
  obj::Parser parser(options);
  if (auto s = parser.read(text); !s) return s.error();
  return std::move(parser.mesh);
}

}  // namespace carom::geometry::detail
