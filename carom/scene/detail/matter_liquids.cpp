// Liquids and grains of a scene file.
#include "carom/core/spelling.h"
#include "carom/scene/detail/matter.h"
#include "carom/scene/detail/matter_fields.h"

namespace carom::scene::detail {
namespace {
using math::Vec3d;

void read_walls(Reader& r, const Object& o, bool (&walls)[6]) {
  const Node* list = o.find("walls");
  if (list == nullptr || r.failed()) return;
  static constexpr std::string_view names[] = {"lower_x", "upper_x", "lower_y", "upper_y", "lower_z", "upper_z"};
  if (!list->is_array()) return r.expected(*list, o.path_of("walls"), "a list such as [\"lower_x\", \"lower_y\"]");
  for (bool& w : walls) w = false;
  for (std::size_t i = 0; i < list->children.size(); ++i) {
    bool known = false;
    for (int k = 0; k < 2 * r.dimension; ++k)
      if (list->children[i].text == names[k]) walls[k] = known = true;
    if (!known)
      return r.expected(list->children[i], index_path(o.path_of("walls"), i), "lower_x, upper_x, lower_y and so on",
                        core::did_you_mean(list->children[i].text, names));
  }
}

/// How many cells of this size fit into the domain.
template <class D>
double cells_of(typename D::Position lower, typename D::Position upper, double size) {
  double cells = 1;
  for (int k = 0; k < D::dimension; ++k) cells *= math::max((double(upper[k]) - double(lower[k])) / size, 0.0) + 1;
  return cells;
}
struct Fill {
  Vec3d lower{}, upper{}, center{}, velocity{};
  double radius = 0;
  std::uint32_t tag = 0;
  bool ball = false;
  double volume(int dimension) const {
    if (ball) return dimension == 2 ? math::pi * radius * radius : 4.0 / 3 * math::pi * radius * radius * radius;
    double v = 1;
    for (int k = 0; k < dimension; ++k) v *= math::max(upper[k] - lower[k], 0.0);
    return v;
  }
};
std::vector<std::pair<Fill, Object>> read_fills(Reader& r, const Object& o, bool balls) {
  std::vector<std::pair<Fill, Object>> out;
  each_entry(r, o, "fill", fill_kind, [&](const Object& f) {
    Fill fill;
    fill.ball = f.has("center");
    if (fill.ball == f.has("lower") || f.has("lower") != f.has("upper") || (fill.ball && !balls))
      return r.fail(*f.node, f.path,
                    balls ? "a fill has \"lower\" and \"upper\", or \"center\" and \"radius\""
                          : "a fill of grains has \"lower\" and \"upper\"");
    fill.lower = r.vector(f, "lower");
    fill.upper = r.vector(f, "upper");
    fill.center = r.vector(f, "center");
    fill.radius = r.number(f, "radius", 0.1);
    fill.velocity = r.vector(f, "velocity");
    fill.tag = std::uint32_t(r.integer(f, "tag", 0, 0, 1000000));
    out.emplace_back(fill, f);
  });
  return out;
}
double filled_volume(const std::vector<std::pair<Fill, Object>>& fills, int dimension) {
  double sum = 0;
  for (const auto& f : fills) sum += f.first.volume(dimension);
  return sum;
}

}  // namespace

template <class D>
void read_liquid(MatterPlace<D>& place, const Object& o) {
  constexpr D* tag = nullptr;
  Reader& r = place.reader;
  particles::FluidDef<D> def;
  def.lower = position_of(r.vector(o, "lower"), tag);
  def.upper = position_of(r.vector(o, "upper"), tag);
  def.spacing = float(r.number(o, "spacing", double(def.spacing)));
  def.density = float(r.number(o, "density", double(def.density)));
  def.viscosity = float(r.number(o, "viscosity", double(def.viscosity)));
  def.surface_tension = float(r.number(o, "surface_tension", 0));
  def.gravity = place.world.definition().gravity;
  read_walls(r, o, def.walls);
  def.courant = float(r.number(o, "courant", double(def.courant)));
  def.max_substeps = r.integer(o, "maximum_substeps", def.max_substeps, 1, 64);
  const auto fills = read_fills(r, o, true);
  if (r.failed()) return;
  if (!(def.spacing >= 1e-4f && def.spacing <= 100))
    return r.expected(*(o.has("spacing") ? o.find("spacing") : o.node), o.path_of("spacing"), "0.0001 m to 100 m");
  double particle = 1;
  for (int k = 0; k < D::dimension; ++k) particle *= double(def.spacing);
  const double needed = 1.5 * filled_volume(fills, D::dimension) / particle + 1024 + (o.has("taps") ? 16384 : 0);
  def.max_particles = r.integer(o, "maximum_particles", int(math::min(needed, double(1 << 22))), 1, 1 << 22);
  std::string name;
  std::uint32_t color = 0x2662be;
  auto& list = place.out.template of<D>().liquids;
  if (!name_thing(r, o, "liquid", list, name, color)) return;
  if (!spend(r, place.budget, def.max_particles + 0.25 * cells_of<D>(def.lower, def.upper, 2 * double(def.spacing)), o))
    return;
  auto made = particles::Fluid<D>::create(def);
  if (!r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.node, o.path)) return;
  for (const auto& [f, at] : fills) {
    const auto velocity = vector_for(f.velocity, tag);
    const core::Status added =
        f.ball ? made->add_ball(position_of(f.center, tag), float(f.radius), velocity, f.tag)
               : made->add_box(position_of(f.lower, tag), position_of(f.upper, tag), velocity, f.tag);
    if (!r.accept(added, *at.node, at.path)) return;
  }
  each_entry(r, o, "taps", tap_kind, [&](const Object& t) {
    const auto added = made->add_tap({.center = position_of(r.vector(t, "center"), tag),
                                      .velocity = vector_for(r.vector(t, "velocity"), tag),
                                      .radius = float(r.number(t, "radius", 0.1)),
                                      .tag = std::uint32_t(r.integer(t, "tag", 0, 0, 1000000))});
    if (!r.failed()) r.accept(added.ok() ? core::Status{} : core::Status{added.error()}, *t.node, t.path);
  });
  each_entry(r, o, "drains", drain_kind, [&](const Object& d) {
    const auto added = made->add_drain(
        {.lower = position_of(r.vector(d, "lower"), tag), .upper = position_of(r.vector(d, "upper"), tag)});
    if (!r.failed()) r.accept(added.ok() ? core::Status{} : core::Status{added.error()}, *d.node, d.path);
  });
  if (!r.failed()) list.push_back({std::move(name), color, std::move(*made)});
}
template void read_liquid(MatterPlace<rigid::Dim2>&, const Object&);
template void read_liquid(MatterPlace<rigid::Dim3>&, const Object&);

template <class D>
void read_grains(MatterPlace<D>& place, const Object& o) {
  constexpr D* tag = nullptr;
  Reader& r = place.reader;
  particles::GranularDef<D> def;
  def.lower = position_of(r.vector(o, "lower"), tag);
  def.upper = position_of(r.vector(o, "upper"), tag);
  def.radius = float(read_radius(r, o, double(def.radius)));
  def.radius_spread = float(r.number(o, "radius_spread", double(def.radius_spread)));
  def.density = float(r.number(o, "density", double(def.density)));
  def.friction = float(r.number(o, "friction", double(def.friction)));
  def.rolling_friction = float(r.number(o, "rolling_friction", double(def.rolling_friction)));
  def.wall_friction = float(r.number(o, "wall_friction", double(def.wall_friction)));
  def.gravity = place.world.definition().gravity;
  read_walls(r, o, def.walls);
  def.substeps = r.integer(o, "substeps", def.substeps, 1, 64);
  def.iterations = r.integer(o, "iterations", def.iterations, 1, 100);
  def.seed = std::uint64_t(r.integer(o, "seed", 1, 0, 0x7FFFFFFF));
  const auto fills = read_fills(r, o, false);
  if (r.failed()) return;
  if (!(def.radius >= 1e-4f && def.radius <= 10))
    return r.expected(*(o.has("radius") ? o.find("radius") : o.node), o.path_of("radius"), "0.0001 m to 10 m");
  double cell = 1;
  for (int k = 0; k < D::dimension; ++k) cell *= 2 * double(def.radius);
  const double needed = 1.2 * filled_volume(fills, D::dimension) / cell + 256;
  def.max_grains = r.integer(o, "maximum_grains", int(math::min(needed, double(1 << 20))), 1, 1 << 20);
  std::string name;
  std::uint32_t color = 0xc9a66b;
  auto& list = place.out.template of<D>().grains;
  if (!name_thing(r, o, "grains", list, name, color)) return;
  if (!spend(r, place.budget, def.max_grains + 0.25 * cells_of<D>(def.lower, def.upper, 2 * double(def.radius)), o))
    return;
  auto made = particles::Granular<D>::create(def);
  if (!r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.node, o.path)) return;
  for (const auto& [f, at] : fills)
    if (!r.accept(
            made->add_box(position_of(f.lower, tag), position_of(f.upper, tag), vector_for(f.velocity, tag), f.tag),
            *at.node, at.path))
      return;
  list.push_back({std::move(name), color, std::move(*made)});
}
template void read_grains(MatterPlace<rigid::Dim2>&, const Object&);
template void read_grains(MatterPlace<rigid::Dim3>&, const Object&);

}  // namespace carom::scene::detail
