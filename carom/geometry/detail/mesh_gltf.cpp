// glTF 2.0 and GLB through tinygltf, the one library of this room. It reads the JSON and the buffers; what it leaves
// unchecked (depth of nesting, ranges of accessors, cycles of nodes, where the buffers lie) is checked here.
#include "carom/geometry/detail/mesh_formats.h"
#include "carom/geometry/detail/text.h"

#ifdef CAROM_HAVE_TINYGLTF

#include <cstring>
#include <fstream>

// A program that brings its own copy of the library must not meet this one.
#define tinygltf carom_tinygltf
#define TINYGLTF_IMPLEMENTATION
#define TINYGLTF_NO_FS
#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_INCLUDE_JSON
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wpedantic"
#include <nlohmann/json.hpp>

#include <tiny_gltf.h>
#pragma GCC diagnostic pop

namespace carom::geometry::detail {

namespace {

namespace gltf {

using namespace carom_tinygltf;

// The library follows nested values by recursion.
bool too_deep(std::string_view json) {
  constexpr int most = 64;
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      i += c == '\\';
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      if (++depth > most) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

// The length of a GLB's first chunk stands at byte 12; what lies beyond the end of the file the library finds itself.
std::string_view json_chunk(std::string_view bytes) {
  std::uint32_t length = 0;
  for (std::size_t k = 0; k < 4; ++k) length |= std::uint32_t(static_cast<unsigned char>(bytes[12 + k])) << (8 * k);
  return bytes.substr(20, length);
}

struct Files {
  const std::string* directory;
  std::size_t max_bytes;
};

// Only names below the folder of the file itself.
bool is_allowed(const std::string& path, const Files& files) {
  if (!files.directory || path.substr(0, files.directory->size()) != *files.directory) return false;
  const std::string rest = path.substr(files.directory->size());
  return rest.find("..") == std::string::npos && rest.find('\\') == std::string::npos &&
         rest.find('\0') == std::string::npos && rest.find("//") != 0;
}
bool file_exists(const std::string& path, void* user) {
  const Files& files = *static_cast<const Files*>(user);
  return is_allowed(path, files) && read_bytes(path, files.max_bytes).ok();
}
std::string same_path(const std::string& path, void*) { return path; }
bool read_file(std::vector<unsigned char>* out, std::string* message, const std::string& path, void* user) {
  const Files& files = *static_cast<const Files*>(user);
  if (!is_allowed(path, files)) {
    if (message) *message += "a file outside the folder of the mesh is not read";
    return false;
  }
  const auto bytes = read_bytes(path, files.max_bytes);
  if (!bytes.ok()) {
    if (message) *message += bytes.error().message;
    return false;
  }
  out->assign(bytes->begin(), bytes->end());
  return true;
}
bool pass_over_image(Image*, int, std::string*, std::string*, int, int, const unsigned char*, int, void*) {
  return true;
}

// Where the elements of an accessor lie.
struct Elements {
  const unsigned char* data = nullptr;
  std::size_t count = 0, stride = 0;
  int component_type = 0;
  bool normalized = false;
};

core::Result<Elements> elements_of(const Model& model, int index, int type, const char* what) {
  if (index < 0 || std::size_t(index) >= model.accessors.size())
    return error("%s: accessor %d of %zu", what, index, model.accessors.size());
  const Accessor& accessor = model.accessors[std::size_t(index)];
  if (accessor.sparse.isSparse) return error("%s: accessor %d is sparse, which is not supported", what, index);
  if (accessor.bufferView < 0 || std::size_t(accessor.bufferView) >= model.bufferViews.size())
    return error("%s: accessor %d refers to buffer view %d of %zu", what, index, accessor.bufferView,
                 model.bufferViews.size());
  const BufferView& view = model.bufferViews[std::size_t(accessor.bufferView)];
  if (view.buffer < 0 || std::size_t(view.buffer) >= model.buffers.size())
    return error("%s: buffer view %d refers to buffer %d of %zu", what, accessor.bufferView, view.buffer,
                 model.buffers.size());
  const std::vector<unsigned char>& buffer = model.buffers[std::size_t(view.buffer)].data;
  const std::int32_t component = GetComponentSizeInBytes(std::uint32_t(accessor.componentType));
  const std::int32_t components = GetNumComponentsInType(std::uint32_t(type));
  if (accessor.type != type || component <= 0)
    return error("%s: accessor %d has type %d of component type %d", what, index, accessor.type,
                 accessor.componentType);
  const std::size_t size = std::size_t(component) * std::size_t(components);
  const std::size_t stride = view.byteStride > 0 ? view.byteStride : size;
  if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
    return error("%s: buffer view %d, bytes %zu to %zu + %zu, lies outside its buffer of %zu bytes", what,
                 accessor.bufferView, view.byteOffset, view.byteOffset, view.byteLength, buffer.size());
  if (accessor.count == 0) return error("%s: accessor %d is empty", what, index);
  if (accessor.byteOffset > view.byteLength || size > view.byteLength - accessor.byteOffset || stride < size ||
      (accessor.count - 1) > (view.byteLength - accessor.byteOffset - size) / stride)
    return error("%s: accessor %d, %zu elements from byte %zu on, lies outside its buffer view of %zu bytes", what,
                 index, accessor.count, accessor.byteOffset, view.byteLength);
  return Elements{buffer.data() + view.byteOffset + accessor.byteOffset, accessor.count, stride, accessor.componentType,
                  accessor.normalized};
}

template <class T>
double load(const unsigned char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return double(value);
}

// Integers occur with KHR_mesh_quantization; normalised ones stand for −1…1 or 0…1.
bool component(const Elements& e, const unsigned char* at, double& value) {
  const auto scaled = [&](double x, double limit) { return e.normalized ? max(x / limit, -1.0) : x; };
  switch (e.component_type) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      value = load<float>(at);
      return true;
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      value = scaled(load<std::int8_t>(at), 127);
      return true;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      value = scaled(load<std::uint8_t>(at), 255);
      return true;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      value = scaled(load<std::int16_t>(at), 32767);
      return true;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      value = scaled(load<std::uint16_t>(at), 65535);
      return true;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      value = load<std::uint32_t>(at);
      return !e.normalized;
    default:
      return false;
  }
}

// x ↦ m x + p.
struct Affine {
  Mat3d m;
  Vec3d p{};
};
Affine operator*(const Affine& a, const Affine& b) { return {a.m * b.m, a.m * b.p + a.p}; }

core::Result<Affine> placement(const Node& node, std::size_t index) {
  Affine t;
  if (node.matrix.size() == 16) {
    const std::vector<double>& m = node.matrix;
    t.m = {{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}};
    t.p = {m[12], m[13], m[14]};
  } else {
    if (node.rotation.size() == 4) {
      const Quatd q{node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]};
      if (!(abs(length(q) - 1) < 0.01)) return error("nodes[%zu].rotation is not a unit quaternion", index);
      t.m = to_matrix(normalize(q));
    }
    if (node.scale.size() == 3) t.m = t.m * Mat3d::diagonal({node.scale[0], node.scale[1], node.scale[2]});
    if (node.translation.size() == 3) t.p = {node.translation[0], node.translation[1], node.translation[2]};
  }
  if (!is_finite(t.m.cx) || !is_finite(t.m.cy) || !is_finite(t.m.cz) || !is_finite(t.p))
    return error("nodes[%zu]: its placement is not finite", index);
  return t;
}

class Collector {
 public:
  Collector(const Model& model, const MeshFileOptions& options) : model_(model), options_(options) {}
  core::Status collect();
  MeshFile mesh;

 private:
  core::Status add_nodes(const std::vector<int>& roots);
  core::Status add_mesh(std::size_t index, const Affine& place);
  core::Status add_primitive(const Primitive& primitive, const Affine& place, const char* where);

  const Model& model_;
  const MeshFileOptions& options_;
};

core::Status Collector::add_primitive(const Primitive& primitive, const Affine& place, const char* where) {
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode < TINYGLTF_MODE_TRIANGLES) return {};  // points and lines
  if (mode > TINYGLTF_MODE_TRIANGLE_FAN) return error("%s: mode %d, expected 0 to 6", where, mode);
  for (const char* extension : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
    if (primitive.extensions.count(extension))
      return error("%s: compressed by %s, which is not supported", where, extension);
  const auto position = primitive.attributes.find("POSITION");
  if (position == primitive.attributes.end()) return error("%s has no POSITION", where);
  const auto points = elements_of(model_, position->second, TINYGLTF_TYPE_VEC3, where);
  if (!points.ok()) return points.error();
  Elements corners;
  corners.count = points->count;
  if (primitive.indices >= 0) {
    const auto indices = elements_of(model_, primitive.indices, TINYGLTF_TYPE_SCALAR, where);
    if (!indices.ok()) return indices.error();
    corners = *indices;
    corners.normalized = false;
    if (corners.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE &&
        corners.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT &&
        corners.component_type != TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT)
      return error("%s: indices of component type %d, expected unsigned integers", where, corners.component_type);
  }
  const std::size_t triangles =
      mode == TINYGLTF_MODE_TRIANGLES ? corners.count / 3 : (corners.count < 3 ? 0 : corners.count - 2);
  if (mesh.indices.size() / 3 + triangles > options_.max_triangles ||
      mesh.vertices.size() + points->count > 4 * options_.max_triangles + 4)
    return error("%s: more than %zu triangles in all", where, options_.max_triangles);

  const std::uint32_t base = std::uint32_t(mesh.vertices.size());
  const std::size_t step = std::size_t(GetComponentSizeInBytes(std::uint32_t(points->component_type)));
  for (std::size_t i = 0; i < points->count; ++i) {
    Vec3d v{};
    for (int k = 0; k < 3; ++k)
      if (!component(*points, points->data + i * points->stride + std::size_t(k) * step, v[k]))
        return error("%s: POSITION of component type %d, expected float", where, points->component_type);
    mesh.vertices.push_back(place.m * v + place.p);
  }
  const auto corner = [&](std::size_t i) {
    double value = double(i);
    if (corners.data) component(corners, corners.data + i * corners.stride, value);
    return std::uint32_t(value);
  };
  const bool mirrored = determinant(place.m) < 0;
  for (std::size_t t = 0; t < triangles; ++t) {
    std::uint32_t c[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i =
          mode == TINYGLTF_MODE_TRIANGLES ? 3 * t + k : (mode == TINYGLTF_MODE_TRIANGLE_FAN && k == 0 ? 0 : t + k);
      c[k] = corner(i);
      if (c[k] >= points->count) return error("%s: index %zu is %u of %zu vertices", where, i, c[k], points->count);
    }
    if (mirrored != (mode == TINYGLTF_MODE_TRIANGLE_STRIP && t % 2 == 1)) std::swap(c[1], c[2]);
    mesh.indices.insert(mesh.indices.end(), {base + c[0], base + c[1], base + c[2]});
  }
  ++mesh.parts;
  return {};
}

core::Status Collector::add_mesh(std::size_t index, const Affine& place) {
  const std::vector<Primitive>& primitives = model_.meshes[index].primitives;
  for (std::size_t i = 0; i < primitives.size(); ++i)
    if (auto s = add_primitive(primitives[i], place, text("meshes[%zu].primitives[%zu]", index, i).c_str()); !s)
      return s;
  return {};
}

core::Status Collector::add_nodes(const std::vector<int>& roots) {
  struct Task {
    int node;
    Affine parent;
  };
  std::vector<Task> open;
  std::vector<bool> seen(model_.nodes.size(), false);
  for (std::size_t i = roots.size(); i-- > 0;) open.push_back({roots[i], {}});
  while (!open.empty()) {
    const Task task = open.back();
    open.pop_back();
    if (task.node < 0 || std::size_t(task.node) >= model_.nodes.size())
      return error("a scene or node refers to node %d of %zu", task.node, model_.nodes.size());
    const std::size_t index = std::size_t(task.node);
    if (seen[index]) return error("nodes[%zu] is reached twice, expected a tree", index);
    seen[index] = true;
    const Node& node = model_.nodes[index];
    const auto local = placement(node, index);
    if (!local.ok()) return local.error();
    const Affine place = task.parent * *local;
    if (node.mesh >= 0) {
      if (std::size_t(node.mesh) >= model_.meshes.size())
        return error("nodes[%zu] refers to mesh %d of %zu", index, node.mesh, model_.meshes.size());
      if (auto s = add_mesh(std::size_t(node.mesh), place); !s) return s;
    }
    for (std::size_t i = node.children.size(); i-- > 0;) open.push_back({node.children[i], place});
  }
  return {};
}

core::Status Collector::collect() {
  mesh.parts = 0;
  if (!model_.scenes.empty()) {
    const std::size_t scene = std::size_t(max(model_.defaultScene, 0));
    if (scene >= model_.scenes.size()) return error("scene %zu of %zu", scene, model_.scenes.size());
    if (auto s = add_nodes(model_.scenes[scene].nodes); !s) return s;
  } else {
    for (std::size_t i = 0; i < model_.meshes.size(); ++i)
      if (auto s = add_mesh(i, {}); !s) return s;
  }
  if (mesh.indices.empty()) return error("no triangles in %zu meshes", model_.meshes.size());
  return {};
}

core::Result<MeshFile> parse(std::string_view bytes, bool binary, Files files, const MeshFileOptions& options) {
  if (bytes.size() > 0xFFFFFFF0u) return error("%zu bytes, expected less than 4 GiB", bytes.size());
  if (binary ? bytes.size() < 20 || bytes.substr(0, 4) != "glTF" : bytes.size() < 4)
    return error("%zu bytes: not a %s file", bytes.size(), binary ? "GLB" : "glTF");
  if (too_deep(binary ? json_chunk(bytes) : bytes)) return error("values are nested more than 64 deep");
  TinyGLTF loader;
  loader.SetFsCallbacks({file_exists, same_path, read_file, nullptr, &files});
  loader.SetImageLoader(pass_over_image, nullptr);
  Model model;
  std::string errors, warnings;
  const std::string directory = files.directory ? *files.directory : std::string();
  const bool ok =
      binary ? loader.LoadBinaryFromMemory(&model, &errors, &warnings,
                                           reinterpret_cast<const unsigned char*>(bytes.data()), unsigned(bytes.size()),
                                           directory)
             : loader.LoadASCIIFromString(&model, &errors, &warnings, bytes.data(), unsigned(bytes.size()), directory);
  if (!ok) {
    for (char& c : errors) c = c >= ' ' && c <= '~' ? c : ' ';
    while (!errors.empty() && errors.back() == ' ') errors.pop_back();
    return error("not a valid glTF file: %.300s", errors.empty() ? "unknown reason" : errors.c_str());
  }
  Collector collector(model, options);
  if (auto s = collector.collect(); !s) return s.error();
  return std::move(collector.mesh);
}

}  // namespace gltf

}  // namespace

core::Result<MeshFile> parse_gltf(std::string_view bytes, bool binary, const std::string* directory,
                                  const MeshFileOptions& options) {
  try {
    return gltf::parse(bytes, binary, {directory, options.max_bytes}, options);
  } catch (const std::exception& e) {
    return error("not a valid glTF file: %.200s", e.what());
  }
}

}  // namespace carom::geometry::detail

#else

namespace carom::geometry::detail {

core::Result<MeshFile> parse_gltf(std::string_view, bool, const std::string*, const MeshFileOptions&) {
  return error("this build of Carom does not read glTF: configure it with CAROM_MESH_FILES and tinygltf installed");
}

}  // namespace carom::geometry::detail

#endif
