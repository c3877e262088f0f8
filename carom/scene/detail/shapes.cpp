#include "carom/scene/detail/shapes.h"

#include "carom/core/spelling.h"
#include "carom/geometry/compound.h"
#include "carom/geometry/decomposition.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/geometry/voxels.h"
#include "carom/rigid/tile_ground.h"
#include "carom/scene/detail/joints.h"

namespace carom::scene::detail {
namespace {

using math::Vec2f;
using math::Vec3d;
using math::Vec3f;
using rigid::Dim2;
using rigid::Dim3;

enum ShapeChoice {
  sphere,
  capsule,
  box,
  cylinder,
  cone,
  ellipsoid,
  hull,
  plane,
  mesh,
  height_field,
  voxels,
  compound,
  circle,
  polygon,
  segment,
  chain,
  tiles,
  concave_polygon
};

const Node* look_up(Reader& reader, const std::map<std::string, std::pair<const Node*, std::string>, std::less<>>& all,
                    const Node& at, const std::string& path, std::string_view name, const char* what,
                    std::string& found_path) {
  const auto found = all.find(name);
  if (found != all.end()) {
    found_path = found->second.second;
    return found->second.first;
  }
  std::vector<std::string_view> known;
  for (const auto& entry : all) known.push_back(entry.first);
  reader.fail(at, path, "found " + show(at) + ", expected the name of a " + what + core::did_you_mean(name, known));
  return nullptr;
}

void read_material(Reader& reader, const Library& library, const Node& node, std::string path, SurfaceDefaults& out) {
  const Node* source = &node;
  if (node.is_text()) {
    source = look_up(reader, library.materials, node, path, reader.expand(node, path, node.text), "material", path);
    if (source == nullptr) return;
  }
  Object o;
  if (!reader.open(*source, path, *tables().material, o)) return;
  rigid::Material m;
  m.friction = float(reader.number(o, "friction", m.friction));
  m.restitution = float(reader.number(o, "restitution", m.restitution));
  m.rolling_resistance = float(reader.number(o, "rolling_resistance", m.rolling_resistance));
  m.spinning_resistance = float(reader.number(o, "spinning_resistance", m.spinning_resistance));
  m.tangent_speed = float(reader.number(o, "tangent_speed", m.tangent_speed));
  m.user_id = reader.user_id(o);
  out.material = m;
  out.density = reader.number(o, "density", out.density);
}

/// An entry of "surfaces": the name of a material, or an object with one.
template <class D>
bool read_part_surface(Reader& reader, const Library& library, const Node& node, const std::string& path,
                       rigid::SurfaceMaterial<D>& out) {
  SurfaceDefaults read;
  if (node.is_text()) {
    read_material(reader, library, node, path, read);
  } else {
    Object o;
    if (!reader.open(node, path, *tables().surface, o)) return false;
    read_material(reader, library, *o.find("material"), o.path_of("material"), read);
    if (o.has("surface_velocity"))
      out.surface_velocity = vector_for(reader.vector(o, "surface_velocity"), static_cast<D*>(nullptr));
  }
  out.material = read.material;
  return !reader.failed();
}
/// One number a part, from 0 to 255.
std::vector<std::uint8_t> read_part_materials(Reader& reader, const Object& o) {
  std::vector<std::uint8_t> out;
  for (const double i : reader.numbers(o, "materials")) {
    if (!(i >= 0 && i <= 255) || i != __builtin_floor(i)) {
      reader.fail(*o.find("materials"), o.path_of("materials"),
                  "found " + shortest(i) + ", expected whole numbers from 0 to 255");
      return {};
    }
    out.push_back(std::uint8_t(i));
  }
  return out;
}

/// One of two keys for the same length, the second one half of the first.
float half_of(Reader& reader, const Object& o, const char* whole, const char* half, double fallback) {
  if (o.has(half)) return float(reader.number(o, half, fallback));
  return float(reader.number(o, whole, 2 * fallback) / 2);
}
float radius_of(Reader& reader, const Object& o, double fallback) {
  if (o.has("diameter")) return float(reader.number(o, "diameter", 0) / 2);
  return float(reader.number(o, "radius", fallback));
}
Vec3d half_extents_of(Reader& reader, const Object& o, float radius) {
  if (o.has("half_extents")) return reader.vector(o, "half_extents");
  if (!o.has("size")) {
    reader.fail(*o.node, o.path, "a box needs the key \"size\" or \"half_extents\"");
    return {1, 1, 1};
  }
  const Vec3d half = reader.vector(o, "size") * 0.5;
  const double r = radius;
  return {half.x - r, half.y - r, reader.dimension == 2 ? 0 : half.z - r};
}
bool needs(Reader& reader, const Object& o, std::string_view key, const char* what) {
  if (o.has(key)) return true;
  reader.fail(*o.node, o.path, std::string("a ") + what + " needs the key " + quote(key));
  return false;
}
void wrong_dimension(Reader& reader, const Object& o) {
  const Node* type = o.find("type");
  reader.fail(type != nullptr ? *type : *o.node, o.path_of("type"),
              "found a shape that a scene of dimension " + std::to_string(reader.dimension) + " does not have");
}
template <class T>
bool put(Reader& reader, const Object& o, const core::Result<T>& result, auto& out) {
  if (!result) return reader.fail(*o.node, o.path, result.error().message), false;
  out = *result;
  return true;
}

/// "runs": how many cells, and of what, one after another.
bool read_runs(Reader& reader, const Object& o, std::size_t total, std::vector<std::uint8_t>& cells) {
  const std::vector<double> runs = reader.numbers(o, "runs");
  for (std::size_t i = 0; i + 1 < runs.size() && !reader.failed(); i += 2) {
    const bool whole = runs[i] == __builtin_floor(runs[i]) && runs[i + 1] == __builtin_floor(runs[i + 1]);
    if (!whole || !(runs[i] >= 0 && runs[i] <= double(total - cells.size())) ||
        !(runs[i + 1] >= 0 && runs[i + 1] <= 255))
      return reader.fail(*o.find("runs"), o.path_of("runs"),
                         "found a run of " + shortest(runs[i]) + " cells of " + shortest(runs[i + 1]) +
                             ", expected whole numbers, no more cells than the grid has, and 0 (empty) to 255"),
             false;
    cells.insert(cells.end(), std::size_t(runs[i]), std::uint8_t(runs[i + 1]));
  }
  if (!reader.failed() && (runs.size() % 2 != 0 || cells.size() != total))
    return reader.fail(*o.find("runs"), o.path_of("runs"),
                       "found runs of " + std::to_string(cells.size()) +
                           " cells, expected pairs of a count and a cell for " + std::to_string(total)),
           false;
  return !reader.failed();
}

/// The outlines of square tiles, each a chain.
bool read_tiles(Reader& reader, const Object& o, geometry::Shape2& out, std::vector<geometry::Shape2>& more) {
  if (!needs(reader, o, "runs", "tiles") || !needs(reader, o, "cell_size", "tiles")) return false;
  const int columns = reader.integer(o, "columns", 1, 1, 4096), rows = reader.integer(o, "rows", 1, 1, 4096);
  const float cell = float(reader.number(o, "cell_size", 1));
  std::vector<std::uint8_t> cells;
  if (!read_runs(reader, o, std::size_t(columns) * std::size_t(rows), cells)) return false;
  auto outlines = rigid::outline_tiles(columns, rows, cell, cells);
  if (!outlines.ok()) return reader.fail(*o.node, o.path, outlines.error().message), false;
  if (outlines->empty()) return reader.fail(*o.find("runs"), o.path_of("runs"), "every tile is empty"), false;
  for (std::size_t i = 0; i < outlines->size(); ++i)
    if (i == 0)
      out = (*outlines)[i];
    else
      more.emplace_back((*outlines)[i]);
  return true;
}

/// Of convex parts, each a shape.
bool read_concave_polygon(Reader& reader, const Object& o, geometry::Shape2& out, std::vector<geometry::Shape2>& more) {
  if (!needs(reader, o, "points", "concave_polygon")) return false;
  std::vector<Vec2f> points;
  for (const Vec3d& p : reader.points(o, "points")) points.emplace_back(float(p.x), float(p.y));
  if (reader.failed()) return false;
  std::vector<std::vector<Vec2f>> holes;
  for (const std::vector<Vec3d>& hole : reader.point_lists(o, "openings")) {
    holes.emplace_back();
    for (const Vec3d& p : hole) holes.back().emplace_back(float(p.x), float(p.y));
  }
  if (reader.failed()) return false;
  const auto parts = geometry::decompose_convex(points, holes);
  const char* wrong = holes.empty() ? "points" : "openings";
  if (!parts.ok()) return reader.fail(*o.find(wrong), o.path_of(wrong), parts.error().message), false;
  out = parts->front();
  more.assign(parts->begin() + 1, parts->end());
  return true;
}

bool read_geometry(Reader& reader, const Library&, const Object& o, int type, geometry::Shape2& out,
                   std::vector<geometry::Shape2>& more) {
  switch (type) {
    case circle:
      out = geometry::Circle{radius_of(reader, o, 0.5)};
      break;
    case capsule:
      out = geometry::Capsule2{half_of(reader, o, "length", "half_length", 0.5), radius_of(reader, o, 0.25)};
      break;
    case box: {
      const float radius = radius_of(reader, o, 0);
      const Vec3d half = half_extents_of(reader, o, radius);
      if (reader.failed()) return false;
      if (!(half.x > 0 && half.y > 0 && radius >= 0))
        return reader.fail(*o.node, o.path, "a box needs positive extents and a radius that fits into them"), false;
      out = geometry::make_box2({float(half.x), float(half.y)}, radius);
      break;
    }
    case polygon: {
      if (!needs(reader, o, "points", "polygon")) return false;
      std::vector<Vec2f> points;
      for (const Vec3d& p : reader.points(o, "points")) points.emplace_back(float(p.x), float(p.y));
      const float radius = radius_of(reader, o, 0);
      return !reader.failed() && put(reader, o, geometry::make_polygon(points, radius), out);
    }
    case segment: {
      if (!needs(reader, o, "points", "segment")) return false;
      const std::vector<Vec3d> points = reader.points(o, "points");
      if (reader.failed()) return false;
      if (points.size() != 2) return reader.expected(*o.find("points"), o.path_of("points"), "two points"), false;
      out = geometry::Segment{{float(points[0].x), float(points[0].y)}, {float(points[1].x), float(points[1].y)}};
      break;
    }
    case chain: {
      if (!needs(reader, o, "points", "chain")) return false;
      std::vector<Vec2f> points;
      for (const Vec3d& p : reader.points(o, "points")) points.emplace_back(float(p.x), float(p.y));
      const bool loop = reader.flag(o, "loop", false);
      std::vector<std::uint8_t> materials = read_part_materials(reader, o);
      return !reader.failed() &&
             put(reader, o, geometry::make_chain(std::move(points), loop, std::move(materials)), out);
    }
    case tiles:
      return read_tiles(reader, o, out, more);
    case concave_polygon:
      return read_concave_polygon(reader, o, out, more);
    default:
      return wrong_dimension(reader, o), false;
  }
  return !reader.failed();
}

bool read_hull(Reader& reader, const Object& o, geometry::Shape3& out) {
  const char* key = o.has("points") ? "points" : "vertices";
  if (!needs(reader, o, key, "hull")) return false;
  std::vector<Vec3f> points;
  const double scale = reader.number(o, "scale", 1);
  for (const Vec3d& p : reader.points(o, key)) points.emplace_back(p * scale);
  geometry::HullOptions options;
  options.radius = radius_of(reader, o, 0);
  options.simplify = reader.flag(o, "simplify", false);
  options.max_vertices = reader.integer(o, "max_corners", options.max_vertices, 8, 255);
  if (reader.failed()) return false;
  if (points.size() > 100000) return reader.fail(*o.node, o.path, "a hull may have at most 100000 points"), false;
  return put(reader, o, geometry::make_hull(points, options), out);
}

bool read_mesh(Reader& reader, const Object& o, geometry::Shape3& out) {
  if (!needs(reader, o, "vertices", "mesh") || !needs(reader, o, "indices", "mesh")) return false;
  std::vector<Vec3f> vertices;
  const double scale = reader.number(o, "scale", 1);
  for (const Vec3d& p : reader.points(o, "vertices")) vertices.emplace_back(p * scale);
  std::vector<std::uint32_t> indices;
  for (const double i : reader.numbers(o, "indices")) {
    if (!(i >= 0 && i < 4294967295.0) || i != __builtin_floor(i))
      return reader.fail(*o.find("indices"), o.path_of("indices"), "found " + shortest(i) + ", expected whole numbers"),
             false;
    indices.push_back(std::uint32_t(i));
  }
  std::vector<std::uint8_t> materials = read_part_materials(reader, o);
  return !reader.failed() &&
         put(reader, o, geometry::make_triangle_mesh(std::move(vertices), std::move(indices), std::move(materials)),
             out);
}

bool read_height_field(Reader& reader, const Object& o, geometry::Shape3& out) {
  if (!needs(reader, o, "heights", "height_field")) return false;
  const int columns = reader.integer(o, "columns", 0, 0, 65536);
  const int rows = reader.integer(o, "rows", 0, 0, 65536);
  std::vector<double> cell{1, 1};
  if (o.has("cell")) cell = reader.numbers(o, "cell", 2);
  std::vector<float> heights;
  for (const double h : reader.numbers(o, "heights")) heights.push_back(float(h));
  std::vector<std::uint8_t> holes;
  for (const double h : reader.numbers(o, "holes")) holes.push_back(h != 0);
  std::vector<std::uint8_t> materials = read_part_materials(reader, o);
  return !reader.failed() &&
         put(reader, o,
             geometry::make_height_field(columns, rows, {float(cell[0]), float(cell[1])}, std::move(heights),
                                         std::move(holes), std::move(materials)),
             out);
}

bool read_voxels(Reader& reader, const Object& o, geometry::Shape3& out) {
  if (!needs(reader, o, "runs", "voxels") || !needs(reader, o, "cell_size", "voxels")) return false;
  const int columns = reader.integer(o, "columns", 1, 1, 1024), layers = reader.integer(o, "layers", 1, 1, 1024),
            rows = reader.integer(o, "rows", 1, 1, 1024);
  const float cell = float(reader.number(o, "cell_size", 1));
  std::vector<std::uint8_t> cells;
  return read_runs(reader, o, std::size_t(columns) * std::size_t(layers) * std::size_t(rows), cells) &&
         put(reader, o, geometry::make_voxel_grid(columns, layers, rows, cell, std::move(cells)), out);
}

bool read_geometry(Reader& reader, const Library& library, const Object& o, int type, geometry::Shape3& out,
                   std::vector<geometry::Shape3>&) {
  switch (type) {
    case sphere:
      out = geometry::Sphere{radius_of(reader, o, 0.5)};
      break;
    case capsule:
      out = geometry::Capsule3{half_of(reader, o, "length", "half_length", 0.5), radius_of(reader, o, 0.25)};
      break;
    case box: {
      const float radius = radius_of(reader, o, 0);
      out = geometry::Box{Vec3f(half_extents_of(reader, o, radius)), radius};
      break;
    }
    case cylinder:
      out = geometry::Cylinder{half_of(reader, o, "height", "half_height", 0.5), radius_of(reader, o, 0.5),
                               float(reader.number(o, "rounding", 0))};
      break;
    case cone:
      out = geometry::Cone{half_of(reader, o, "height", "half_height", 0.5), radius_of(reader, o, 0.5),
                           float(reader.number(o, "rounding", 0))};
      break;
    case ellipsoid:
      if (!needs(reader, o, "radii", "ellipsoid")) return false;
      out = geometry::Ellipsoid{Vec3f(reader.vector(o, "radii"))};
      break;
    case plane: {
      Vec3d normal = reader.vector(o, "normal", {0, 1, 0});
      // What is of unit length already keeps its bits.
      if (!(math::abs(math::length_squared(normal) - 1) < 1e-6)) normal = math::normalize(normal);
      out = geometry::Plane{Vec3f(normal)};
      break;
    }
    case hull:
      return read_hull(reader, o, out);
    case mesh:
      return read_mesh(reader, o, out);
    case height_field:
      return read_height_field(reader, o, out);
    case voxels:
      return read_voxels(reader, o, out);
    case compound: {
      if (!needs(reader, o, "children", "compound")) return false;
      const Node& list = *o.find("children");
      const std::string path = o.path_of("children");
      if (!list.is_array()) return reader.expected(list, path, "a list of shapes"), false;
      std::vector<geometry::CompoundChild> children;
      for (std::size_t i = 0; i < list.children.size(); ++i) {
        ReadShape<Dim3> child;
        if (!read_shape<Dim3>(reader, library, list.children[i], index_path(path, i), {}, child)) return false;
        children.push_back({child.shape, child.definition.local});
      }
      return put(reader, o, geometry::make_compound(std::move(children)), out);
    }
    default:
      return wrong_dimension(reader, o), false;
  }
  return !reader.failed();
}

/// A shape written as {"use": name, …}: the named shape with the keys written here in place of its own.
Node overlay(const Node& base, const Node& over) {
  Node merged = over;
  for (std::size_t i = 0; i < base.keys.size(); ++i) {
    if (merged.find(base.keys[i]) != nullptr) continue;
    merged.keys.push_back(base.keys[i]);
    merged.children.push_back(base.children[i]);
  }
  return merged;
}

void read_local(Reader& reader, const Object& o, math::Transform2f& out) {
  const Vec3d p = reader.vector(o, "position");
  out = {{float(p.x), float(p.y)}, reader.rotation2(o, "rotation")};
}
void read_local(Reader& reader, const Object& o, math::Transform3f& out) {
  out = {Vec3f(reader.vector(o, "position")), reader.rotation3(o, "rotation")};
}

}  // namespace

void read_filter(Reader& reader, const Object& o, rigid::Filter& filter) {
  Object f;
  if (!o.has("filter") || !reader.open(*o.find("filter"), o.path_of("filter"), *tables().filter, f)) return;
  filter.category = reader.bits(f, "category", filter.category);
  filter.mask = reader.bits(f, "mask", filter.mask);
  filter.group = reader.integer(f, "group", filter.group, -0x7FFFFFFF, 0x7FFFFFFF);
}

SurfaceDefaults read_surface(Reader& reader, const Library& library, const Object& o, SurfaceDefaults defaults) {
  if (const Node* material = o.find("material"))
    read_material(reader, library, *material, o.path_of("material"), defaults);
  if (o.kind->find("density") != nullptr) defaults.density = reader.number(o, "density", defaults.density);
  read_filter(reader, o, defaults.filter);
  return defaults;
}

template <class D>
bool read_shape(Reader& reader, const Library& library, const Node& node, const std::string& path,
                const SurfaceDefaults& defaults, ReadShape<D>& out) {
  if (reader.failed()) return false;
  std::string at = path;
  const Node* source = &node;
  Node merged;
  for (int depth = 0;; ++depth) {
    const Node* use = source->is_object() ? source->find("use") : nullptr;
    if (!source->is_text() && use == nullptr) break;
    if (depth == 16) return reader.fail(*source, at, "shapes use one another in a circle"), false;
    std::string found_path;
    const Node& named = use != nullptr ? *use : *source;
    if (!named.is_text()) return reader.expected(named, at, "the name of a shape"), false;
    const Node* base =
        look_up(reader, library.shapes, named, at, reader.expand(named, at, named.text), "shape", found_path);
    if (base == nullptr) return false;
    if (use == nullptr) {
      source = base;
      at = found_path;
      continue;
    }
    if (!base->is_object()) return reader.expected(*base, found_path, "an object (shape)"), false;
    Node without = *source;
    for (std::size_t i = 0; i < without.keys.size(); ++i) {
      if (without.keys[i] != "use") continue;
      without.keys.erase(without.keys.begin() + std::ptrdiff_t(i));
      without.children.erase(without.children.begin() + std::ptrdiff_t(i));
      break;
    }
    merged = overlay(*base, without);
    source = &merged;
  }
  Object o;
  if (!reader.open(*source, at, *tables().shape, o)) return false;
  if (!o.has("type")) return reader.fail(*source, at, "the key \"type\" is missing in a shape"), false;
  const int type = reader.choice(o, "type", 0);
  if (reader.failed() || !read_geometry(reader, library, o, type, out.shape, out.more)) return false;
  if (!reader.accept(geometry::validate(out.shape), *source, at)) return false;

  const SurfaceDefaults surface = read_surface(reader, library, o, defaults);
  rigid::ShapeDef<D>& d = out.definition;
  read_local(reader, o, d.local);
  d.material = surface.material;
  d.filter = surface.filter;
  d.density = float(surface.density);
  out.density_given = o.has("density");
  if (o.has("mass")) {
    const double mass = reader.number(o, "mass", 0);
    double volume = geometry::mass_properties(out.shape, 1.0).mass;
    for (const typename D::Shape& part : out.more) volume += geometry::mass_properties(part, 1.0).mass;
    if (!reader.failed() && !(volume > 0))
      reader.fail(*o.find("mass"), o.path_of("mass"), "this kind of shape has no volume, and so no mass");
    else
      d.density = float(mass / volume);
    out.density_given = true;
  }
  d.sensor = reader.flag(o, "sensor", d.sensor);
  d.contact_events = reader.flag(o, "contact_events", d.contact_events);
  d.hit_events = reader.flag(o, "hit_events", d.hit_events);
  d.modify_contacts = reader.flag(o, "modify_contacts", d.modify_contacts);
  if (o.has("surface_velocity"))
    d.surface_velocity = vector_for(reader.vector(o, "surface_velocity"), static_cast<D*>(nullptr));
  if (const Node* list = o.find("surfaces")) {
    const std::string list_path = o.path_of("surfaces");
    if (!list->is_array()) return reader.expected(*list, list_path, "a list of surfaces"), false;
    for (std::size_t i = 0; i < list->children.size(); ++i) {
      rigid::SurfaceMaterial<D> part;
      if (!read_part_surface(reader, library, list->children[i], index_path(list_path, i), part)) return false;
      d.surfaces.push_back(part);
    }
  }
  if (o.has("one_way")) d.one_way = vector_for(reader.vector(o, "one_way"), static_cast<D*>(nullptr));
  d.user_data = reader.bits(o, "user_data", 0);
  return !reader.failed();
}
template bool read_shape<Dim2>(Reader&, const Library&, const Node&, const std::string&, const SurfaceDefaults&,
                               ReadShape<Dim2>&);
template bool read_shape<Dim3>(Reader&, const Library&, const Node&, const std::string&, const SurfaceDefaults&,
                               ReadShape<Dim3>&);

}  // namespace carom::scene::detail
