#include "apps/host/debug_water.h"

#include <algorithm>
#include <functional>

#include "apps/host/debug_draw.h"
#include "apps/host/debug_pen.h"
#include "carom/environment/environment.h"
#include "carom/forces/buoyancy.h"
#include "carom/geometry/mesh_builders.h"

namespace carom::host {

namespace {

using math::Vec3d;

constexpr std::uint32_t wet_pen = 0x1f78c8b0, waterline_pen = 0x7fe3ffff, lift_pen = 0x00a6c7ff;
constexpr std::size_t most_edges = 600;  ///< of one shape: of finer ones only the waterline is drawn
constexpr int circle_pieces = 20;        ///< segments of a circle

/// Height of the surface over (x, z) now.
using HeightOver = std::function<double(double x, double z)>;

struct Floating {
  rigid::BodyId target{};  ///< null: all
  double density = 1000;
  HeightOver height;
};

template <class D>
std::vector<Floating> waters(const rigid::World<D>& world) {
  std::vector<rigid::EffectorId> all;
  world.effectors(all);
  std::shared_ptr<const environment::Environment> around;
  for (const rigid::EffectorId id : all)
    if (const auto definition = world.effector_definition(id); definition.ok())
      if (const auto* surroundings = std::get_if<rigid::Surroundings<D>>(&*definition))
        around = surroundings->environment;
  std::vector<Floating> out;
  const double t = world.time(), g = math::max(1e-6, double(math::length(world.definition().gravity)));
  for (const rigid::EffectorId id : all) {
    const auto definition = world.effector_definition(id);
    const auto* buoyancy = definition.ok() ? std::get_if<rigid::Buoyancy<D>>(&*definition) : nullptr;
    if (buoyancy == nullptr) continue;
    Floating one{buoyancy->body, buoyancy->density, {}};
    if (around != nullptr && around->water() != nullptr) {
      one.density = around->water()->water().density;
      one.height = [around, t](double x, double z) { return around->water()->height(x, z, t); };
    } else {
      one.height = [def = *buoyancy, t, g](double x, double z) {
        environment::Wave waves[4];
        for (int i = 0; i < def.wave_count; ++i)
          waves[i] = {def.waves[i].amplitude, def.waves[i].wavelength, def.waves[i].phase, 1, 0};
        environment::Water water;
        water.level = def.level;
        water.waves = {waves, std::size_t(def.wave_count)};
        water.gravity = g;
        return environment::surface_height(water, x, z, t);
      };
    }
    out.push_back(std::move(one));
  }
  return out;
}

/// The part of a → b where the depth is above zero; false where there is none.
bool wet_part(Vec3d& a, double depth_a, Vec3d& b, double depth_b) {
  if (depth_a <= 0 && depth_b <= 0) return false;
  if (depth_a < 0) a = a + (b - a) * (depth_a / (depth_a - depth_b));
  if (depth_b < 0) b = b + (a - b) * (depth_b / (depth_b - depth_a));
  return true;
}

class WaterDrawing {
 public:
  WaterDrawing(DebugPen& pen, ArrowScale scale, double gravity) : pen_(pen), scale_(scale), gravity_(gravity) {}

  void solid(const geometry::Triangles& shape, const auto& place, const Floating& water) {
    corners_.clear(), depths_.clear();
    for (const math::Vec3f p : shape.positions) {
      const Vec3d at = place(p);
      corners_.push_back(at);
      depths_.push_back(water.height(at.x, at.z) - at.y);
    }
    if (corners_.empty() || *std::max_element(depths_.begin(), depths_.end()) <= 0) return;
    for (std::size_t t = 0; t + 2 < shape.indices.size() && !pen_.full(); t += 3) {
      const std::uint32_t* const corner = &shape.indices[t];
      Vec3d cut[3];
      int cuts = 0;
      for (int k = 0; k < 3; ++k) {
        const std::uint32_t i = corner[k], j = corner[(k + 1) % 3];
        const double da = depths_[i], db = depths_[j];
        if ((da > 0) != (db > 0)) cut[cuts++] = corners_[i] + (corners_[j] - corners_[i]) * (da / (da - db));
      }
      if (cuts == 2) pen_.line(cut[0], cut[1], waterline_pen);
    }
    if (shape.indices.size() <= 3 * most_edges) wet_edges(shape.indices);
    // Volume and centre as the engine has them, relative to the first corner: far away places stay exact.
    std::vector<Vec3d> near;
    for (const Vec3d at : corners_) near.push_back(at - corners_[0]);
    const forces::Submerged3 wet = forces::submerged_mesh(near, shape.indices, depths_, {0, 1, 0});
    if (wet.volume > 0) lift(corners_[0] + wet.centroid, wet.volume, water.density);
  }

  void outline(const geometry::Outline& shape, const auto& place, const Floating& water) {
    if (!shape.closed || shape.points.size() < 3) return;
    Vec3d waterline[16];
    int cuts = 0;
    double area = 0;
    Vec3d moment{}, first{};
    bool begun = false;
    const auto gather = [&](Vec3d a, Vec3d b) {
      if (!begun) first = a, begun = true;
      const Vec3d p = a - first, q = b - first;
      const double twice = p.x * q.y - p.y * q.x;
      area += 0.5 * twice;
      moment = moment + (p + q) * (twice / 6);
    };
    Vec3d left{};
    bool is_open = false;
    const std::size_t n = shape.points.size();
    for (std::size_t i = 0; i < n; ++i) {
      Vec3d a = place(shape.points[i]), b = place(shape.points[(i + 1) % n]);
      const double da = water.height(a.x, 0) - a.y, db = water.height(b.x, 0) - b.y;
      const bool out_of = da > 0 && db <= 0, into = da <= 0 && db > 0;
      if (!wet_part(a, da, b, db)) continue;
      pen_.line(a, b, wet_pen);
      if (into && is_open) gather(left, a), is_open = false;
      gather(a, b);
      if (out_of) left = b, is_open = true;
      if ((into || out_of) && cuts < 16) waterline[cuts++] = into ? a : b;
    }
    for (int i = 0; i + 1 < cuts; i += 2) pen_.line(waterline[i], waterline[i + 1], waterline_pen);
    if (area > 0) lift(first + moment * (1 / area), area, water.density);
  }

 private:
  /// The wet parts of all edges but those within a flat face.
  void wet_edges(const std::vector<std::uint32_t>& indices) {
    struct Edge {
      std::uint32_t i, j;
      Vec3d normal;
    };
    std::vector<Edge> edges;
    for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
      const Vec3d a = corners_[indices[t]], b = corners_[indices[t + 1]], c = corners_[indices[t + 2]];
      const Vec3d across = math::cross(b - a, c - a);
      const Vec3d normal = across * (1 / math::max(1e-300, math::length(across)));
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t i = indices[t + k], j = indices[t + (k + 1) % 3];
        edges.push_back({std::min(i, j), std::max(i, j), normal});
      }
    }
    std::sort(edges.begin(), edges.end(),
              [](const Edge& a, const Edge& b) { return a.i != b.i ? a.i < b.i : a.j < b.j; });
    for (std::size_t k = 0; k < edges.size() && !pen_.full(); ++k) {
      const Edge& edge = edges[k];
      const bool shared = k + 1 < edges.size() && edges[k + 1].i == edge.i && edges[k + 1].j == edge.j;
      if (shared) ++k;
      if (shared && math::dot(edge.normal, edges[k].normal) > 0.9999) continue;
      Vec3d a = corners_[edge.i], b = corners_[edge.j];
      if (wet_part(a, depths_[edge.i], b, depths_[edge.j])) pen_.line(a, b, wet_pen);
    }
  }
  void lift(Vec3d center, double volume, double density) {
    pen_.cross(center, lift_pen);
    pen_.arrow(center, Vec3d{0, scale_.force * forces::buoyant_force(density, gravity_, volume), 0}, lift_pen);
  }

  DebugPen& pen_;
  ArrowScale scale_;
  double gravity_;
  std::vector<Vec3d> corners_;
  std::vector<double> depths_;
};

}  // namespace

template <class D>
void water_lines(const rigid::World<D>& world, double size, std::vector<Line>& out) {
  const std::vector<Floating> floating = waters(world);
  if (floating.empty()) return;
  DebugPen pen(0.012 * size, D::dimension == 2, out);
  WaterDrawing drawing(pen, arrow_scale(world, 1.0f / 60, size), double(math::length(world.definition().gravity)));
  std::vector<rigid::BodyId> bodies;
  world.bodies(bodies);
  std::vector<rigid::ShapeId> shapes;
  for (const rigid::BodyId body : bodies) {
    const auto state = world.state(body);
    if (!state.ok() || state->type != rigid::BodyType::dynamic) continue;
    const auto water = std::find_if(floating.begin(), floating.end(),
                                    [&](const Floating& one) { return one.target.is_null() || one.target == body; });
    if (water == floating.end()) continue;
    if (pen.full()) return;
    shapes.clear();
    world.shapes(body, shapes);
    for (const rigid::ShapeId id : shapes) {
      const auto shape = world.shape_geometry(id);
      const auto definition = world.shape_definition(id);
      if (!shape.ok() || !definition.ok() || definition->sensor) continue;
      const auto place = [&](const auto p) {
        return in_space(world_point(state->pose, transform_point(definition->local, p)));
      };
      if constexpr (D::dimension == 2)
        drawing.outline(geometry::to_outline(*shape, circle_pieces), place, *water);
      else
        drawing.solid(geometry::to_triangles(*shape, circle_pieces), place, *water);
    }
  }
}

template void water_lines(const rigid::World2&, double, std::vector<Line>&);
template void water_lines(const rigid::World3&, double, std::vector<Line>&);

}  // namespace carom::host
