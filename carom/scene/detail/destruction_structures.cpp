// Solids that break: from the shape of a file to parts and bonds.
#include "carom/geometry/mesh_builders.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/scene/detail/destruction.h"
#include "carom/scene/detail/destruction_fields.h"
#include "carom/scene/detail/matter.h"

namespace carom::scene::detail {
namespace {
using blast::ConvexCell;
using blast::Pattern;
using blast::Substance;
using math::Vec2d;
using math::Vec3d;
using rigid::Dim2;
using rigid::Dim3;

enum PatternKind { voronoi, even, clustered, radial, slabs, bricks };

template <class T>
bool take(Reader& r, const Object& o, core::Result<T> made, T& out) {
  if (!r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.node, o.path)) return false;
  out = std::move(*made);
  return true;
}

/// A number of the pattern within bounds, so that no file asks for pieces without end.
double bounded(Reader& r, const Object& o, const char* key, double fallback, double low, double high,
               std::string_view what) {
  const double x = r.number(o, key, fallback);
  if (!r.failed() && !(x >= low && x <= high)) r.expected(*o.find(key), o.path_of(key), what);
  return x;
}

struct Rings {
  double first_radius, growth, jitter;
  int sectors;
};
Rings read_rings(Reader& r, const Object& o) {
  Rings rings;
  rings.first_radius = bounded(r, o, "first_radius", 0.02, 1e-4, 1e3, "0.1 mm to 1 km");
  rings.growth = bounded(r, o, "growth", 1.6, 1.05, 100, "1.05 to 100");
  rings.sectors = r.integer(o, "sectors", 9, 3, 1000);
  rings.jitter = bounded(r, o, "jitter", 0.35, 0, 1, "0 to 1");
  return rings;
}

Vec3d read_axis(Reader& r, const Object& o, Vec3d fallback) {
  const Vec3d axis = r.vector(o, "axis", fallback);
  if (!r.failed() && !(math::length(axis) > 1e-9))
    r.expected(*o.find("axis"), o.path_of("axis"), "a direction that is not zero");
  return r.failed() ? fallback : math::normalize(axis);
}

struct Slabs {
  Vec3d axis;
  double jitter;
};
Slabs read_slabs(Reader& r, const Object& o) {
  const Vec3d axis = read_axis(r, o, {0, 1, 0});
  return {axis, bounded(r, o, "jitter", 0, 0, 1, "0 to 1")};
}

/// The size of a brick, of which so many fill the extent that the budget allows them.
template <class D>
bool read_brick(DestructionPlace<D>& place, const Object& o, Vec3d extent, int dimensions, Vec3d& size) {
  Reader& r = place.reader;
  if (!o.has("brick")) return r.fail(*o.node, o.path, "the key \"brick\" is missing: the size of a brick"), false;
  size = r.vector(o, "brick");
  double count = 1;
  for (int k = 0; k < dimensions; ++k) count *= size[k] > 0 ? extent[k] / size[k] + 2 : 1;
  return !r.failed() && spend(r, place.budget, count, o);
}

bool read_pattern(DestructionPlace<Dim3>& place, const Object& o, const ConvexCell& box, Pattern& out) {
  Reader& r = place.reader;
  const int kind = r.choice(o, "pattern", voronoi);
  const int pieces = r.integer(o, "pieces", 50, 1, 10000);
  const std::uint64_t seed = std::uint64_t(r.integer(o, "seed", 1, 0, 0x7FFFFFFF));
  const Vec3d impact = r.vector(o, "impact");
  if (r.failed() || (kind != radial && kind != bricks && !spend(r, place.budget, pieces, o))) return false;
  std::vector<Vec3d> sites;
  switch (kind) {
    case slabs: {
      const Slabs slabs = read_slabs(r, o);
      return !r.failed() && take(r, o, blast::slab_pattern(box, slabs.axis, pieces, slabs.jitter, seed), out);
    }
    case bricks: {
      Vec3d low{1e300, 1e300, 1e300}, high = -low, size;
      for (const Vec3d& v : box.vertices()) low = math::min(low, v), high = math::max(high, v);
      return read_brick(place, o, high - low, 3, size) && take(r, o, blast::brick_pattern(box, size, low), out);
    }
    case radial: {
      blast::RadialSites rings;
      rings.impact = impact;
      rings.axis = read_axis(r, o, {0, 0, 1});
      const Rings read = read_rings(r, o);
      if (r.failed()) return false;
      rings.first_radius = read.first_radius, rings.growth = read.growth, rings.sectors = read.sectors;
      rings.jitter = read.jitter;
      if (!take(r, o, blast::radial_sites(box, rings, seed), sites)) return false;
      if (!spend(r, place.budget, double(sites.size()), o)) return false;
      break;
    }
    case even:
      sites = blast::even_sites(box, pieces, r.integer(o, "rounds", 2, 0, 10), seed);
      break;
    case clustered:
      sites = blast::clustered_sites(box, impact, bounded(r, o, "impact_radius", 0.1, 1e-4, 1e4, "0.1 mm to 10 km"),
                                     pieces, seed);
      break;
    default:
      sites = blast::uniform_sites(box, pieces, seed);
  }
  return !r.failed() && take(r, o, blast::voronoi_pattern(box, sites), out);
}

bool read_pattern(DestructionPlace<Dim2>& place, const Object& o, const std::vector<Vec2d>& outline,
                  blast::Pattern2& out) {
  Reader& r = place.reader;
  geometry::Bounds2d box{{1e300, 1e300}, {-1e300, -1e300}};
  for (const Vec2d& p : outline) box.low = math::min(box.low, p), box.high = math::max(box.high, p);
  const int kind = r.choice(o, "pattern", voronoi);
  const int pieces = r.integer(o, "pieces", 50, 1, 2000);
  const std::uint64_t seed = std::uint64_t(r.integer(o, "seed", 1, 0, 0x7FFFFFFF));
  if (r.failed()) return false;
  std::vector<Vec2d> sites;
  switch (kind) {
    case slabs: {
      const Slabs slabs = read_slabs(r, o);
      return !r.failed() && spend(r, place.budget, pieces, o) &&
             take(r, o, blast::slab_pattern2(outline, {slabs.axis.x, slabs.axis.y}, pieces, slabs.jitter, seed), out);
    }
    case bricks: {
      Vec3d size;
      return read_brick(place, o, {box.high.x - box.low.x, box.high.y - box.low.y, 0}, 2, size) &&
             take(r, o, blast::brick_pattern2(outline, {size.x, size.y}, box.low), out);
    }
    case radial: {
      const Rings read = read_rings(r, o);
      blast::RadialSites2 rings;
      const Vec3d impact = r.vector(o, "impact");
      rings.impact = {impact.x, impact.y};
      rings.first_radius = read.first_radius, rings.growth = read.growth, rings.sectors = read.sectors;
      rings.jitter = read.jitter;
      rings.limit = math::distance(box.low, box.high);
      if (r.failed() || !take(r, o, blast::radial_sites2(rings, seed), sites)) return false;
      break;
    }
    case voronoi:
      sites = blast::uniform_sites2(box, pieces, seed);
      break;
    default:
      return r.expected(*o.find("pattern"), o.path_of("pattern"), "voronoi, radial, slabs or bricks in the plane"),
             false;
  }
  return !r.failed() && spend(r, place.budget, double(sites.size()), o) &&
         take(r, o, blast::voronoi_pattern2(sites), out);
}

bool is_in_place(const math::Transform2f& t) { return t == math::Transform2f{}; }
bool is_in_place(const math::Transform3f& t) { return t == math::Transform3f{}; }

template <class D>
bool read_solid(DestructionPlace<D>& place, const Object& o, const SurfaceDefaults& surface, typename D::Shape& out) {
  Reader& r = place.reader;
  ReadShape<D> shape;
  if (!read_shape<D>(r, place.library, *o.find("shape"), o.path_of("shape"), surface, shape)) return false;
  if (!is_in_place(shape.definition.local))
    return r.fail(*o.find("shape"), o.path_of("shape"),
                  "the shape of a structure has no place of its own: move the structure"),
           false;
  out = shape.shape;
  return true;
}

bool break_up(DestructionPlace<Dim3>& place, const Object& o, const SurfaceDefaults& surface,
              const blast::FractureOptions& options, blast::Fracture& out) {
  using geometry::ShapeType3;
  Reader& r = place.reader;
  geometry::Shape3 shape;
  if (!o.has("shape")) return r.fail(*o.node, o.path, "the key \"shape\" is missing in a structure"), false;
  if (!read_solid(place, o, surface, shape)) return false;
  Pattern pattern;
  if (shape.type == ShapeType3::box && shape.box.radius == 0) {
    const Vec3d h(shape.box.half_extents);
    return read_pattern(place, o, ConvexCell(geometry::Bounds3d{-h, h}), pattern) &&
           take(r, o, blast::fracture_convex(pattern, options), out);
  }
  if (shape.type == ShapeType3::hull && shape.hull->radius == 0)
    return read_pattern(place, o, ConvexCell(*shape.hull), pattern) &&
           take(r, o, blast::fracture_convex(pattern, options), out);
  if (shape.type == ShapeType3::plane || shape.type == ShapeType3::height_field || shape.type == ShapeType3::voxels ||
      shape.type == ShapeType3::compound)
    return r.fail(*o.find("shape"), o.path_of("shape"),
                  "found a shape that does not break, expected a box, hull, sphere, capsule, cylinder, cone, ellipsoid "
                  "or closed mesh"),
           false;
  geometry::Triangles t;
  if (shape.type == ShapeType3::mesh)
    t = {shape.mesh->vertices, shape.mesh->indices};
  else
    t = geometry::to_triangles(shape, 24);
  const std::vector<Vec3d> vertices(t.positions.begin(), t.positions.end());
  return read_pattern(place, o, blast::container_of(vertices), pattern) &&
         take(r, o, blast::fracture_mesh(vertices, t.indices, pattern, options), out);
}

bool break_up(DestructionPlace<Dim2>& place, const Object& o, const SurfaceDefaults& surface,
              const blast::FractureOptions& options, blast::Fracture2& out) {
  Reader& r = place.reader;
  if (o.has("shape") == o.has("outline"))
    return r.fail(*o.node, o.path, "a structure needs either the key \"shape\" or \"outline\""), false;
  std::vector<Vec2d> outline;
  if (o.has("outline")) {
    for (const Vec3d& p : r.points(o, "outline")) outline.push_back({p.x, p.y});
  } else {
    geometry::Shape2 shape;
    if (!read_solid(place, o, surface, shape)) return false;
    const geometry::Outline found = geometry::to_outline(shape, 24);
    if (!found.closed)
      return r.fail(*o.find("shape"), o.path_of("shape"), "found a shape that does not break, expected a solid one"),
             false;
    for (const math::Vec2f& p : found.points) outline.push_back(Vec2d(p));
  }
  if (r.failed()) return false;
  blast::Pattern2 pattern;
  return read_pattern(place, o, outline, pattern) &&
         take(r, o, blast::fracture_polygon(outline, pattern, options.skin), out);
}

blast::BondMaterial read_bonds(Reader& r, const Object& o, Substance substance) {
  blast::BondMaterial m = blast::bond_material(substance);
  m.tensile_strength = r.number(o, "tensile_strength", m.tensile_strength);
  m.compressive_strength = r.number(o, "compressive_strength", m.compressive_strength);
  m.shear_strength = r.number(o, "shear_strength", m.shear_strength);
  m.youngs_modulus = r.number(o, "youngs_modulus", m.youngs_modulus);
  m.contact_time = r.number(o, "contact_time", m.contact_time);
  return m;
}

}  // namespace

template <class D>
void read_structure(DestructionPlace<D>& place, const Object& o) {
  constexpr D* tag = nullptr;
  Reader& r = place.reader;
  constexpr Substance substances[] = {Substance::glass,    Substance::brick_and_mortar,
                                      Substance::concrete, Substance::ceramic,
                                      Substance::wood,     Substance::ice};
  const Substance substance = substances[r.choice(o, "substance", 2)];
  const SurfaceDefaults surface = read_surface(r, place.library, o, {});
  const double density = r.number(o, "density", blast::density_of(substance));
  if (!r.failed() && !(density > 0 && density <= 1e6))
    r.expected(*o.find("density"), o.path_of("density"), "more than 0, up to 1e6 kg/m^3");
  const blast::FractureOptions options{.skin = r.number(o, "skin", 1e-3), .meshes = false};
  std::string name;
  std::uint32_t color = 0;
  auto& list = place.out.template of<D>().structures;
  if (r.failed() || !name_thing(r, o, "structure", list, name, color)) return;
  if (place.scene.find_body(name) != nullptr)
    return r.fail(*o.node, o.path, "found the name " + quote(name) + " a second time, expected one that no body has");

  std::conditional_t<D::dimension == 3, blast::Fracture, blast::Fracture2> fracture;
  if (!break_up(place, o, surface, options, fracture)) return;
  blast::StructureDef<D> def = blast::structure_of(fracture, density);
  def.material = read_bonds(r, o, substance);
  def.shape.material = surface.material;
  def.shape.filter = surface.filter;
  def.pose.position = position_of(r.vector(o, "position"), tag);
  def.pose.rotation = rotation_for(r, o, "rotation", tag);
  def.linear_velocity = vector_for(r.vector(o, "velocity"), tag);
  def.angular_velocity = angular_for(r.angular(o, "angular_velocity"), tag);
  def.bullet_pieces = r.flag(o, "bullet", false);
  if (o.has("anchored_below")) blast::anchor_below(def, r.number(o, "anchored_below", 0));
  const auto argb = r.color(o, "color");
  if (r.failed()) return;
  auto made = blast::Structure<D>::make(place.world, def);
  if (!r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.node, o.path)) return;
  place.scene.bodies.push_back({name, made->body_of(0), argb.value_or(0), argb.has_value(), false});
  list.push_back({std::move(name), color, std::move(*made)});
}
template void read_structure(DestructionPlace<Dim2>&, const Object&);
template void read_structure(DestructionPlace<Dim3>&, const Object&);

}  // namespace carom::scene::detail
