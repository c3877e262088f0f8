#include "apps/host/read_views.h"

#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

namespace carom::host {

namespace {

using Json = nlohmann::json;

/// Reads fields of one JSON object and keeps the first complaint.
class Fields {
 public:
  Fields(const Json& json, std::string where, std::string& error)
      : json_(json), where_(std::move(where)), error_(error) {}

  double number(const char* key, double missing) {
    const auto found = json_.find(key);
    if (found == json_.end()) return missing;
    if (found->is_number() && math::is_finite(found->get<double>())) return found->get<double>();
    complain(key, "a number");
    return missing;
  }
  template <std::size_t n>
  std::array<double, n> numbers(const char* key, std::array<double, n> missing) {
    const auto found = json_.find(key);
    if (found == json_.end()) return missing;
    if (!found->is_array() || found->size() != n) {
      complain(key, std::to_string(n) + " numbers");
      return missing;
    }
    std::array<double, n> out{};
    for (std::size_t i = 0; i < n; ++i) {
      if (!(*found)[i].is_number()) {
        complain(key, std::to_string(n) + " numbers");
        return missing;
      }
      out[i] = (*found)[i].get<double>();
    }
    return out;
  }
  std::string text(const char* key) {
    const auto found = json_.find(key);
    if (found == json_.end()) return {};
    if (found->is_string()) return found->get<std::string>();
    complain(key, "a text");
    return {};
  }
  bool flag(const char* key) {
    const auto found = json_.find(key);
    return found != json_.end() && found->is_boolean() && found->get<bool>();
  }
  /// "#rrggbb"; 0 where there is none.
  std::uint32_t color(const char* key) {
    const std::string name = text(key);
    if (name.empty()) return 0;
    char* end = nullptr;
    const unsigned long value = std::strtoul(name.c_str() + 1, &end, 16);
    if (name.size() == 7 && name[0] == '#' && *end == 0) return std::uint32_t(value);
    complain(key, "a colour as #rrggbb");
    return 0;
  }
  const Json* list(const char* key) {
    const auto found = json_.find(key);
    if (found != json_.end() && found->is_array()) return &*found;
    complain(key, "an array");
    return nullptr;
  }
  void complain(const char* key, const std::string& expected) {
    if (error_.empty()) error_ = where_ + "." + key + ": expected " + expected;
  }

 private:
  const Json& json_;
  std::string where_;
  std::string& error_;
};

math::Vec3d vec(const std::array<double, 3>& v) { return {v[0], v[1], v[2]}; }

ShapeView read_shape(const Json& json, const std::string& where, std::size_t mesh_count, std::string& error) {
  Fields f(json, where, error);
  ShapeView s;
  const std::string kind = f.text("kind");
  bool known = false;
  for (int k = 0; k <= int(ShapeKind::chain); ++k) {
    if (kind != name_of(ShapeKind(k))) continue;
    s.kind = ShapeKind(k);
    known = true;
  }
  if (!known) f.complain("kind", "a kind of shape of docs/protocol.md, found \"" + kind + "\"");
  s.radius = float(f.number("radius", 0));
  s.size.y = float(f.number("half_length", f.number("half_height", 0)));
  if (s.kind == ShapeKind::cylinder || s.kind == ShapeKind::cone) s.size.x = float(f.number("rounding", 0));
  const char* three = s.kind == ShapeKind::box         ? "half_extents"
                      : s.kind == ShapeKind::ellipsoid ? "radii"
                      : s.kind == ShapeKind::plane     ? "normal"
                                                       : nullptr;
  if (three) s.size = math::Vec3f(vec(f.numbers<3>(three, {0.5, 0.5, 0.5})));
  if (s.kind == ShapeKind::mesh) {
    const double mesh = f.number("mesh", -1);
    if (!(mesh >= 0 && mesh < double(mesh_count)))
      f.complain("mesh", "one of " + std::to_string(mesh_count) + " meshes");
    else
      s.mesh = std::uint32_t(mesh);
  }
  if (s.kind == ShapeKind::polygon || s.kind == ShapeKind::segment || s.kind == ShapeKind::chain) {
    if (const Json* points = f.list("points")) {
      for (const Json& p : *points) {
        if (!p.is_array() || p.size() != 2 || !p[0].is_number() || !p[1].is_number()) {
          f.complain("points", "pairs of numbers");
          break;
        }
        s.points.push_back({p[0].get<float>(), p[1].get<float>()});
      }
    }
  }
  s.loop = f.flag("loop");
  s.sensor = f.flag("sensor");
  if (const std::uint32_t color = f.color("color"); color != 0 || json.contains("color"))
    s.look = color | std::uint32_t(math::clamp(f.number("opacity", 1), 0.004, 1.0) * 255) << 24;
  const std::array<double, 7> local = f.numbers<7>("local", {0, 0, 0, 1, 0, 0, 0});
  s.local.p = math::Vec3f(math::Vec3d{local[0], local[1], local[2]});
  s.local.q = {float(local[3]), float(local[4]), float(local[5]), float(local[6])};
  return s;
}

core::Status read_bodies(const Json& bodies, const std::string& list, std::size_t mesh_count,
                         std::vector<BodyView>& out) {
  std::string error;
  for (std::size_t i = 0; i < bodies.size() && error.empty(); ++i) {
    const std::string where = list + "[" + std::to_string(i) + "]";
    const Json& json = bodies[i];
    if (!json.is_object()) return core::Error{where + ": expected an object"};
    Fields f(json, where, error);
    BodyView body;
    body.id = std::uint32_t(math::clamp(f.number("id", 0), 0.0, 4294967295.0));
    body.name = f.text("name");
    const std::string type = f.text("type");
    body.type = type == "fixed"       ? rigid::BodyType::fixed
                : type == "kinematic" ? rigid::BodyType::kinematic
                                      : rigid::BodyType::dynamic;
    body.color = f.color("color");
    body.position = vec(f.numbers<3>("position", {}));
    const std::array<double, 4> q = f.numbers<4>("rotation", {1, 0, 0, 0});
    body.rotation = {float(q[0]), float(q[1]), float(q[2]), float(q[3])};
    if (const Json* shapes = f.list("shapes"))
      for (std::size_t k = 0; k < shapes->size(); ++k)
        if ((*shapes)[k].is_object())
          body.shapes.push_back(
              read_shape((*shapes)[k], where + ".shapes[" + std::to_string(k) + "]", mesh_count, error));
    out.push_back(std::move(body));
  }
  return error.empty() ? core::Status{} : core::Status{core::Error{error}};
}

}  // namespace

core::Result<SceneViews> read_scene(const std::string& text, std::size_t mesh_count) {
  const Json scene = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  std::string error;
  SceneViews out;
  if (!scene.is_object()) return core::Error{"scene: expected a JSON object"};
  Fields whole(scene, "scene", error);
  if (const auto ground = scene.find("ground"); ground != scene.end() && ground->is_object())
    out.ground = Fields(*ground, "scene.ground", error).number("level", 0);
  if (const Json* bodies = whole.list("bodies"))
    if (const core::Status read = read_bodies(*bodies, "scene.bodies", mesh_count, out.bodies); !read.ok())
      return read.error();
  if (!error.empty()) return core::Error{error};
  return out;
}

core::Result<std::vector<BodyView>> read_arrivals(const std::string& text, std::size_t mesh_count) {
  const Json message = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  std::string error;
  std::vector<BodyView> out;
  if (!message.is_object()) return core::Error{"bodies: expected a JSON object"};
  const Json* added = Fields(message, "bodies", error).list("add");
  if (added == nullptr) return core::Error{error};
  if (const core::Status read = read_bodies(*added, "bodies.add", mesh_count, out); !read.ok()) return read.error();
  return out;
}

core::Result<Mesh> read_mesh(const std::string& bytes) {
  std::uint32_t head[4] = {};
  if (bytes.size() < sizeof head) return core::Error{"mesh: " + std::to_string(bytes.size()) + " bytes, expected 16"};
  std::memcpy(head, bytes.data(), sizeof head);
  const std::uint64_t expected = 16 + 12 * std::uint64_t(head[2]) + 4 * std::uint64_t(head[3]);
  if ((head[0] & 255) != 1 || bytes.size() != expected || head[3] % 3 != 0)
    return core::Error{"mesh: " + std::to_string(bytes.size()) + " bytes, expected a mesh message of " +
                       std::to_string(expected)};
  Mesh mesh;
  mesh.vertices.resize(head[2]);
  mesh.indices.resize(head[3]);
  if (!mesh.vertices.empty()) std::memcpy(mesh.vertices.data(), bytes.data() + 16, 12 * mesh.vertices.size());
  if (!mesh.indices.empty())
    std::memcpy(mesh.indices.data(), bytes.data() + 16 + 12 * mesh.vertices.size(), 4 * mesh.indices.size());
  for (const std::uint32_t i : mesh.indices)
    if (i >= mesh.vertices.size())
      return core::Error{"mesh: a triangle names corner " + std::to_string(i) + " of " +
                         std::to_string(mesh.vertices.size())};
  return mesh;
}

void read_camera(const std::string& opened, Camera& camera) {
  const Json json = Json::parse(opened, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object() || !json.contains("camera") || !json["camera"].is_object()) return;
  std::string ignored;
  Fields f(json["camera"], "camera", ignored);
  camera.position = vec(f.numbers<3>("position", {camera.position.x, camera.position.y, camera.position.z}));
  camera.target = vec(f.numbers<3>("target", {camera.target.x, camera.target.y, camera.target.z}));
  camera.field_of_view = math::clamp(f.number("field_of_view", camera.field_of_view), 0.05, 3.0);
  camera.height = math::clamp(f.number("height", camera.height), 1e-6, 1e9);
  camera.width = math::clamp(f.number("width", camera.width), 0.0, 1e9);
  camera.follow = int(math::clamp(f.number("follow", camera.follow), -1.0, 2e9));
}

}  // namespace carom::host
