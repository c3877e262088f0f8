#include "carom/geometry/mesh_file.h"

#include <cstdio>

#include "carom/geometry/detail/mesh_formats.h"
#include "carom/geometry/detail/text.h"

namespace carom::geometry {

namespace {

namespace mesh_files {

core::Status finish(MeshFile& mesh, MeshFormat format, const MeshFileOptions& options) {
  mesh.format = format;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    mesh.vertices[i] *= options.unit;
    const Vec3d size = abs(mesh.vertices[i]);
    if (!(max(size.x, max(size.y, size.z)) <= 1e12) || !is_finite(size))
      return detail::error("vertex %zu is not a finite point within 1e12 m", i);
  }
  for (const std::uint32_t i : mesh.indices)
    if (i >= mesh.vertices.size())
      return detail::error("a triangle refers to vertex %u of %zu", i, mesh.vertices.size());
  return {};
}

core::Result<MeshFile> parse(std::string_view bytes, MeshFormat format, const std::string* directory,
                             const MeshFileOptions& options) {
  if (!(options.unit > 0) || !is_finite(options.unit))
    return detail::error("unit is %g m: expected a positive number", options.unit);
  if (bytes.size() > options.max_bytes)
    return detail::error("%zu bytes, expected at most %zu", bytes.size(), options.max_bytes);
  core::Result<MeshFile> mesh = detail::error("not recognised as OBJ, STL, glTF or GLB");
  switch (format) {
    case MeshFormat::unknown:
      return mesh;
    case MeshFormat::obj:
      mesh = detail::parse_obj(bytes, options);
      break;
    case MeshFormat::stl:
      mesh = detail::parse_stl(bytes, options);
      break;
    case MeshFormat::gltf:
      mesh = detail::parse_gltf(bytes, false, directory, options);
      break;
    case MeshFormat::glb:
      mesh = detail::parse_gltf(bytes, true, directory, options);
      break;
  }
  if (mesh.ok())
    if (auto s = finish(*mesh, format, options); !s) return s.error();
  return mesh;
}

core::Error named(std::string_view name, const core::Error& error) {
  return {std::string(name) + ": " + error.message};
}

}  // namespace mesh_files

}  // namespace

const char* name_of(MeshFormat format) {
  switch (format) {
    case MeshFormat::obj:
      return "OBJ";
    case MeshFormat::stl:
      return "STL";
    case MeshFormat::gltf:
      return "glTF";
    case MeshFormat::glb:
      return "GLB";
    case MeshFormat::unknown:
      break;
  }
  return "unknown";
}

MeshFormat detect_mesh_format(std::string_view name, std::string_view bytes) {
  const std::size_t dot = name.rfind('.');
  std::string ending(dot == std::string_view::npos ? std::string_view() : name.substr(dot + 1));
  for (char& c : ending) c = c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c;
  if (ending == "obj") return MeshFormat::obj;
  if (ending == "stl") return MeshFormat::stl;
  if (ending == "glb") return MeshFormat::glb;
  if (ending == "gltf") return MeshFormat::gltf;
  if (bytes.substr(0, 4) == "glTF") return MeshFormat::glb;
  if (bytes.substr(0, 6) == "solid ") return MeshFormat::stl;
  const std::size_t first = bytes.find_first_not_of(" \t\r\n");
  if (first != std::string_view::npos && bytes[first] == '{') return MeshFormat::gltf;
  if (bytes.substr(0, 2) == "v " || bytes.find("\nv ") != std::string_view::npos) return MeshFormat::obj;
  return MeshFormat::unknown;
}

core::Result<std::string> detail::read_bytes(const std::string& path, std::size_t max_bytes) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (!file) return error("cannot be opened");
  std::string bytes;
  char block[65536];
  bool too_large = false;
  for (std::size_t n = 1; n > 0 && !too_large;) {
    n = std::fread(block, 1, sizeof block, file);
    bytes.append(block, n);
    too_large = bytes.size() > max_bytes;
  }
  const bool failed = std::ferror(file) != 0;
  std::fclose(file);
  if (failed) return error("cannot be read (is it a folder?)");
  if (too_large) return error("larger than %zu bytes", max_bytes);
  return bytes;
}

core::Result<MeshFile> parse_mesh(std::string_view bytes, MeshFormat format, const MeshFileOptions& options,
                                  std::string_view name) {
  auto mesh = mesh_files::parse(bytes, format, nullptr, options);
  if (!mesh.ok()) return mesh_files::named(name, mesh.error());
  return mesh;
}

core::Result<MeshFile> read_mesh_file(const std::string& path, const MeshFileOptions& options) {
  const auto bytes = detail::read_bytes(path, options.max_bytes);
  if (!bytes.ok()) return mesh_files::named(path, bytes.error());
  const std::size_t slash = path.rfind('/');
  const std::string directory = slash == std::string::npos ? std::string(".") : path.substr(0, slash + 1);
  auto mesh = mesh_files::parse(*bytes, detect_mesh_format(path, *bytes), &directory, options);
  if (!mesh.ok()) return mesh_files::named(path, mesh.error());
  return mesh;
}

Triangles to_triangles(const MeshFile& file) {
  Triangles out;
  out.positions.reserve(file.vertices.size());
  for (const Vec3d& v : file.vertices) out.positions.push_back(Vec3f(v));
  out.indices = file.indices;
  return out;
}

}  // namespace carom::geometry
