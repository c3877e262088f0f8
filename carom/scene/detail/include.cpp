#include "carom/scene/detail/include.h"

#include <algorithm>
#include <cstdio>
#include <map>

#include "carom/ballistics/drag_curve.h"
#include "carom/ballistics/motor.h"
#include "carom/geometry/mesh_file.h"
#include "carom/scene/detail/preset_values.h"

namespace carom::scene::detail {
namespace {

constexpr std::size_t max_files = 256;
constexpr int max_include_depth = 16;

std::string folder_of(std::string_view path) {
  const std::size_t slash = path.rfind('/');
  return slash == std::string_view::npos ? std::string() : std::string(path.substr(0, slash + 1));
}

/// Relative, with forward slashes, and no way out of the root.
bool is_inside(std::string_view path) {
  if (path.empty() || path.size() > 256 || path[0] == '/' || path[0] == '~') return false;
  for (const char c : path)
    if (c == '\\' || c == ':' || static_cast<unsigned char>(c) < 0x20) return false;
  for (std::size_t at = 0; at <= path.size();) {
    const std::size_t end = std::min(path.find('/', at), path.size());
    const std::string_view part = path.substr(at, end - at);
    if (part.empty() || part == "." || part == "..") return false;
    at = end + 1;
  }
  return true;
}

/// An empty node that stands where another one does, and a number.
Node node_at(const Node& place, NodeKind kind) {
  Node n;
  n.kind = kind;
  n.file = place.file;
  n.line = place.line;
  n.column = place.column;
  return n;
}
Node number_at(const Node& place, double value) {
  Node n = node_at(place, NodeKind::number);
  n.number = value;
  return n;
}

class PartReader {
 public:
  PartReader(SceneDocument& document, const Resolver& resolver, std::string_view name)
      : document_(document), resolver_(resolver), shown_folder_(folder_of(name)) {}

  /// `path` is the file's path from the root; empty for the scene itself.
  core::Status read(std::string_view text, const std::string& shown, const std::string& path, int depth) {
    if (depth > max_include_depth)
      return core::Error{shown + ": included more than " + std::to_string(max_include_depth) + " files deep"};
    core::Result<Node> node = parse(text, shown);
    if (!node) return node.error();
    if (const core::Status merged = merge_presets(*node, path, 0); !merged) return merged;
    if (const Node* list = node->is_object() ? node->find("include") : nullptr) {
      if (!list->is_array()) return error(*list, "include", "found " + show(*list) + ", expected a list of file names");
      for (std::size_t i = 0; i < list->children.size(); ++i)
        if (const core::Status read = include(list->children[i], index_path("include", i), path, depth); !read)
          return read;
    }
    document_.parts.push_back(std::move(*node));
    return {};
  }

 private:
  core::Error error(const Node& at, std::string_view path, const std::string& message) const {
    return core::Error{document_.files[at.file] + ":" + std::to_string(at.line) + ": " + std::string(path) + ": " +
                       message};
  }

  core::Result<Node> parse(std::string_view text, const std::string& shown) {
    if (document_.files.size() >= max_files)
      return core::Error{shown + ": a scene may have at most " + std::to_string(max_files) + " files"};
    document_.files.push_back(shown);
    return parse_document(text, shown, std::uint16_t(document_.files.size() - 1));
  }

  core::Status include(const Node& node, const std::string& where, const std::string& from, int depth) {
    if (!node.is_text() || !is_inside(node.text))
      return error(node, where,
                   "found " + show(node) + ", expected a file name such as \"parts/ground.json\", without \"..\"");
    const std::string path = folder_of(from) + node.text;
    for (const std::string& open : chain_)
      if (open == path) return error(node, where, "found " + show(node) + ", which includes itself");
    for (const std::string& seen : included_)
      if (seen == path) return {};  // what two parts share comes once
    if (!resolver_) return error(node, where, "found an include, but this scene has no folder to read from");
    const core::Result<std::string> text = resolver_(path);
    if (!text) return error(node, where, text.error().message);
    chain_.push_back(path);
    const core::Status read_part = read(*text, shown_folder_ + path, path, depth + 1);
    chain_.pop_back();
    included_.push_back(path);
    return read_part;
  }

  /// Puts the keys that presets give into the objects that name them, where those do not have them. `list`: the key of
  /// the list that the node is in.
  core::Status merge_presets(Node& node, const std::string& from, int depth, std::string_view list = {}) {
    if (node.is_object()) {
      if (const Node* preset = node.find("preset"); preset != nullptr && preset->is_text()) {
        if (depth >= 8) return error(*preset, "preset", "presets name one another more than 8 deep");
        const Node named = *preset;
        const Node* values = nullptr;
        if (const core::Status found = load_preset(named, values); !found) return found;
        for (std::size_t i = 0; i < values->keys.size(); ++i) {
          if (values->keys[i] == "preset" || node.find(values->keys[i]) != nullptr) continue;
          node.keys.push_back(values->keys[i]);
          node.children.push_back(values->children[i]);
        }
      }
    }
    if (node.is_object() && node.find("file") != nullptr)
      for (const char* kind : {"type", "form"})  // of a shape, of an emitter
        if (const Node* of = node.find(kind); of != nullptr)
          if (const core::Status read = read_mesh(node, of->text, from); !read) return read;
    if (node.is_object() && list == "guns")
      for (const char* key : {"ammunition", "sight"}) spell_out(node, key, "preset", std::string(key) + "/");
    if (node.is_object() && list == "effectors") {
      spell_out(node, "delivery", "preset", "cricket/");
      spell_out(node, "pitch", "preset", "pitch/");
      spell_out(node, "shot", "club", "");
    }
    if (node.is_object() && (list == "ammunition" || list == "shells")) spell_out(node, "shell", "preset", "shell/");
    if (node.is_object() && list == "penetration")
      if (const core::Status read = read_wall(node); !read) return read;
    if (node.is_object() && list == "stages")
      if (const core::Status read = read_motor(node, from); !read) return read;
    if (node.is_object() && (list == "ammunition" || list == "rockets"))
      if (const core::Status read = read_drag(node, from); !read) return read;
    for (std::size_t i = 0; i < node.children.size(); ++i) {
      const std::string_view within = node.is_object() ? std::string_view(node.keys[i]) : list;
      if (const core::Status merged = merge_presets(node.children[i], from, depth, within); !merged) return merged;
    }
    return {};
  }

  /// "ammunition": "9mm_115_fmj" is short for {"preset": "ammunition/9mm_115_fmj"}.
  static void spell_out(Node& owner, std::string_view key, const char* inner, const std::string& before) {
    for (std::size_t i = 0; i < owner.keys.size(); ++i) {
      Node& name = owner.children[i];
      if (owner.keys[i] != key || !name.is_text()) continue;
      Node full = name;
      full.text = before + name.text;
      name.kind = NodeKind::object;
      name.text.clear();
      name.keys = {inner};
      name.children = {std::move(full)};
    }
  }
  /// "wall": "brick" stands for the layers of presets/wall/brick.json.
  core::Status read_wall(Node& owner) {
    for (std::size_t i = 0; i < owner.keys.size(); ++i) {
      if (owner.keys[i] != "wall" || !owner.children[i].is_text()) continue;
      Node named = owner.children[i];
      named.text = "wall/" + named.text;
      const Node* layers = nullptr;
      if (const core::Status found = load_preset(named, layers, true); !found) return found;
      owner.children[i] = *layers;
    }
    return {};
  }

  /// The text of a file that `key` names: beside the scene where the name has an extension, as "my.eng"; without one
  /// presets/KIND/NAME.EXTENSION. `path`: what it was asked for by.
  core::Result<std::string> named_file(const Node& at, const std::string& key, const std::string& from,
                                       const std::string& kind, const std::string& extension, std::string& path) {
    const bool beside = at.text.find('.') != std::string::npos;
    if (beside ? !is_inside(at.text) : !is_preset_name(at.text))
      return error(at, key,
                   "found " + show(at) + ", expected the name of a file of presets/" + kind +
                       ", or of one beside this scene, as \"my." + extension + "\"");
    if (!resolver_) return error(at, key, "found the name of a file, but this scene has no folder to read from");
    path = beside ? folder_of(from) + at.text : "presets/" + kind + "/" + at.text + "." + extension;
    core::Result<std::string> text = resolver_(path);
    if (!text) return error(at, key, text.error().message);
    if (text->size() > 65536) return error(at, key, path + " has more than 64 kB");
    return text;
  }

  /// "drag_table": "308_168_smk" stands for the numbers of presets/drag/308_168_smk.txt; of rockets too.
  core::Status read_drag(Node& owner, const std::string& from) {
    for (std::size_t i = 0; i < owner.keys.size(); ++i) {
      const std::string& key = owner.keys[i];
      if ((key != "drag_table" && key != "coasting_drag_table") || !owner.children[i].is_text()) continue;
      Node& at = owner.children[i];
      std::string path;
      const auto text = named_file(at, key, from, "drag", "txt", path);
      if (!text) return text.error();
      const auto curve = ballistics::read_drag_table(*text, path);
      if (!curve) return error(at, key, curve.error().message);
      Node numbers = node_at(at, NodeKind::array);
      for (const ballistics::DragPoint& p : curve->points())
        for (const double x : {p.mach, p.coefficient}) numbers.children.push_back(number_at(at, x));
      merged_ += numbers.children.size();
      at = std::move(numbers);
    }
    return {};
  }

  /// "motor": "black_powder" stands for a motor of presets/motor/black_powder.eng.
  core::Status read_motor(Node& stage, const std::string& from) {
    for (std::size_t i = 0; i < stage.keys.size(); ++i) {
      if (stage.keys[i] != "motor" || !stage.children[i].is_text()) continue;
      Node& at = stage.children[i];
      std::string path;
      const auto text = named_file(at, "motor", from, "motor", "eng", path);
      if (!text) return text.error();
      const auto motors = ballistics::read_rasp(*text, path);
      if (!motors) return error(at, "motor", motors.error().message);
      const Node* const wanted = stage.find("designation");
      const auto motor = choose_motor(*motors, path, wanted);
      if (!motor)
        return error(wanted != nullptr ? *wanted : at, wanted != nullptr ? "designation" : "motor",
                     motor.error().message);
      Node thrust = node_at(at, NodeKind::array);
      for (const ballistics::ThrustPoint& p : motor->curve.points()) {
        thrust.children.push_back(number_at(at, p.time));
        thrust.children.push_back(number_at(at, p.thrust));
      }
      merged_ += thrust.children.size();
      at = node_at(at, NodeKind::object);
      at.keys = {"propellant_mass", "mass", "thrust"};
      at.children = {number_at(at, motor->propellant_mass), number_at(at, motor->mass), std::move(thrust)};
    }
    return {};
  }

  /// Puts vertices and indices of a mesh file into the shape or emitter that names it.
  core::Status read_mesh(Node& shape, const std::string& kind, const std::string& from) {
    const Node file = *shape.find("file");
    const bool hull = kind == "hull";
    if (!hull && kind != "mesh") return error(file, "file", "only meshes and hulls are read from files");
    if (shape.find("vertices") != nullptr || shape.find("points") != nullptr || shape.find("indices") != nullptr)
      return error(file, "file", "found a file beside vertices, points or indices, expected one of them");
    if (!file.is_text() || !is_inside(file.text))
      return error(file, "file", "found " + show(file) + ", expected the name of a mesh file, without \"..\"");
    if (!resolver_) return error(file, "file", "found a mesh file, but this scene has no folder to read from");
    const core::Result<std::string> bytes = resolver_(folder_of(from) + file.text);
    if (!bytes) return error(file, "file", bytes.error().message);
    geometry::MeshFileOptions options;
    options.max_triangles = 500000;
    const core::Result<geometry::MeshFile> mesh =
        geometry::parse_mesh(*bytes, geometry::detect_mesh_format(file.text, *bytes), options, file.text);
    if (!mesh) return error(file, "file", mesh.error().message);
    if ((mesh_values_ += mesh->vertices.size() + mesh->indices.size()) > 4000000)
      return error(file, "file", "the meshes of this scene have more than four million numbers");
    Node points = node_at(file, NodeKind::array);
    for (const math::Vec3d& v : mesh->vertices) {
      Node point = node_at(file, NodeKind::array);
      for (int i = 0; i < 3; ++i) point.children.push_back(number_at(file, v[i]));
      points.children.push_back(std::move(point));
    }
    shape.keys.push_back(hull ? "points" : "vertices");
    shape.children.push_back(std::move(points));
    if (hull) return {};
    Node indices = node_at(file, NodeKind::array);
    for (const std::uint32_t i : mesh->indices) indices.children.push_back(number_at(file, double(i)));
    shape.keys.push_back("indices");
    shape.children.push_back(std::move(indices));
    return {};
  }

  core::Status load_preset(const Node& at, const Node*& values, bool is_list = false) {
    const auto known = presets_.find(at.text);
    if (known == presets_.end()) {
      if (!is_inside(at.text))
        return error(at, "preset", "found " + show(at) + ", expected the name of a preset such as \"ball/golf\"");
      if (!resolver_) return error(at, "preset", "found a preset, but this scene has no folder to read from");
      const std::string path = "presets/" + at.text + ".json";
      const core::Result<std::string> text = resolver_(path);
      if (!text) return error(at, "preset", text.error().message);
      if (text->size() > 65536) return error(at, "preset", "a preset may have at most 65536 bytes");
      core::Result<Node> parsed = parse(*text, path);
      if (!parsed) return parsed.error();
      Reader reader(document_);
      Object o;
      if (!reader.open(*parsed, "", *tables().preset, o)) return reader.error();
      if (is_list ? !o.find("values")->is_array() : !o.find("values")->is_object())
        return error(*o.find("values"), "values",
                     "found " + show(*o.find("values")) + (is_list ? ", expected a list" : ", expected an object"));
      Node own = *o.find("values");
      if (own.find("preset") != nullptr) return error(own, "values.preset", "a preset may not name another one");
      merged_ += own.children.size();
      presets_.emplace(at.text, std::move(own));
    }
    values = &presets_.find(at.text)->second;
    if (values->is_array() != is_list)
      return error(at, "preset", "found the preset " + show(at) + ", which is for something else");
    merged_ += count(*values);
    if (merged_ > (2u << 20)) return error(at, "preset", "the presets of this scene add more than two million values");
    return {};
  }
  static std::size_t count(const Node& node) {
    std::size_t n = 1;
    for (const Node& child : node.children) n += count(child);
    return n;
  }

  SceneDocument& document_;
  const Resolver& resolver_;
  std::string shown_folder_;
  std::vector<std::string> chain_, included_;
  std::map<std::string, Node> presets_;
  std::size_t merged_ = 0, mesh_values_ = 0;
};

}  // namespace

core::Status read_parts(SceneDocument& document, std::string_view text, std::string_view name,
                        const Resolver& resolver) {
  return PartReader(document, resolver, name).read(text, std::string(name), "", 0);
}

core::Result<std::string> read_file(const std::string& path, std::size_t limit) {
  std::FILE* file = std::fopen(path.c_str(), "rb");
  if (file == nullptr) return core::Error{path + ": cannot be opened"};
  std::string text;
  char buffer[65536];
  std::size_t got = 0;
  while ((got = std::fread(buffer, 1, sizeof buffer, file)) > 0) {
    text.append(buffer, got);
    if (text.size() > limit) break;
  }
  const bool bad = std::ferror(file) != 0;
  std::fclose(file);
  if (bad) return core::Error{path + ": cannot be read"};
  if (text.size() > limit) return core::Error{path + ": found more than " + std::to_string(limit) + " bytes"};
  return text;
}

}  // namespace carom::scene::detail

namespace carom::scene {

Result<Scene> load_scene(const std::string& path, const LoadOptions& options) {
  constexpr std::size_t limit = 64u << 20;
  const core::Result<std::string> text = detail::read_file(path, limit);
  if (!text) return text.error();
  const std::size_t slash = path.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : path.substr(0, slash + 1);
  const std::string root = options.root.empty() ? folder : options.root + "/";
  const Resolver resolver = [&](std::string_view name) -> Result<std::string> {
    if (name.rfind("presets/", 0) != 0) return detail::read_file(root + std::string(name), limit);
    const std::string rest(name.substr(8));
    if (!options.presets.empty()) return detail::read_file(options.presets + "/" + rest, limit);
    for (const std::string& place : {root + "presets/", root + "../presets/", std::string("presets/")})
      if (Result<std::string> found = detail::read_file(place + rest, limit); found.ok()) return found;
    return core::Error{"the preset file presets/" + rest +
                       " is neither in the scene's folder, nor beside it, nor in the working folder"};
  };
  return parse_scene(*text, path, resolver, options);
}

}  // namespace carom::scene
