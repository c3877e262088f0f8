#include "carom/scene/detail/destruction.h"

#include "carom/core/string.h"
#include "carom/scene/detail/destruction_fields.h"
#include "carom/scene/detail/matter.h"

namespace carom::scene::detail {
namespace {

template <class D>
bool read_case(DestructionPlace<D>& place, const Object& o, typename D::Position at,
               std::optional<CaseFragments>& out) {
  Reader& r = place.reader;
  Object c;
  if (!r.open(*o.find("case"), o.path_of("case"), case_kind, c)) return false;
  if constexpr (D::dimension == 3) {
    CaseDef d;
    d.mass = r.number(c, "mass", d.mass);
    d.shape = blast::CaseShape(r.choice(c, "shape", int(d.shape)));
    if (r.choice(c, "explosive", 0) == 1) d.gurney_constant = blast::gurney_composition_b;
    d.fragments = r.integer(c, "fragments", d.fragments, 2, 100'000);
    d.density = r.number(c, "density", d.density);
    d.drag_coefficient = r.number(c, "drag_coefficient", d.drag_coefficient);
    d.lifetime = r.number(c, "lifetime", d.lifetime);
    d.seed = std::uint64_t(r.integer(c, "seed", 1, 0, 0x7FFFFFFF));
    if (r.failed() || !r.accept(check(d), *c.node, c.path)) return false;
    out.emplace(d, conditions_at(at, -double(place.world.definition().gravity.y), D::dimension, place.around.get()));
    return true;
  } else {
    (void)at, (void)out;
    return r.fail(*c.node, c.path, "a case flies apart in space only"), false;
  }
}

template <class D>
void read_explosion(DestructionPlace<D>& place, const Object& o) {
  Reader& r = place.reader;
  blast::Charge<D> charge;
  charge.position = position_of(r.vector(o, "position"), static_cast<D*>(nullptr));
  charge.mass = r.number(o, "mass", 1);
  charge.burst = blast::Burst(r.choice(o, "burst", 0));
  charge.ground = r.number(o, "ground", 0);
  charge.time = r.number(o, "time", 0);
  charge.reach = r.number(o, "reach", 0);
  charge.clearing = r.flag(o, "clearing", charge.clearing);
  charge.shelter = r.number(o, "shelter", charge.shelter);
  charge.mask = r.bits(o, "mask", charge.mask);
  charge.obstacles = r.bits(o, "obstacles", charge.obstacles);
  if (o.has("casing"))
    charge.casing = place.names.find_body(*o.find("casing"), o.path_of("casing"), r.text(o, "casing"));
  std::optional<CaseFragments> casing;
  if (o.has("case") && !read_case(place, o, charge.position, casing)) return;
  std::string name;
  std::uint32_t color = 0;
  auto& list = place.out.template of<D>().explosions;
  if (r.failed() || !name_thing(r, o, "charge", list, name, color)) return;
  auto made = blast::Explosion<D>::make(charge);
  if (!r.accept(made.ok() ? core::Status{} : core::Status{made.error()}, *o.node, o.path)) return;
  list.push_back({std::move(name), color, {std::move(*made), std::move(casing)}});
}

bool read_layers(Reader& r, const Node& list, const std::string& path, std::vector<ballistics::Layer>& out,
                 double through) {
  if (!list.is_array() || list.children.empty() || list.children.size() > 100)
    return r.expected(list, path, "the name of a preset, or a list of 1 to 100 layers"), false;
  for (std::size_t i = 0; i < list.children.size(); ++i) {
    Object o;
    if (!r.open(list.children[i], index_path(path, i), layer_kind, o)) return false;
    ballistics::Layer layer;
    layer.thickness = r.number(o, "thickness", i + 1 == list.children.size() ? through : layer.thickness);
    layer.medium.strength = r.number(o, "strength", layer.medium.strength);
    layer.medium.inertia = r.number(o, "inertia", layer.medium.inertia);
    layer.limit_speed = r.number(o, "limit_speed", layer.limit_speed);
    layer.density = r.number(o, "density", layer.density);
    layer.ricochet_angle = r.number(o, "ricochet_angle", layer.ricochet_angle);
    layer.ricochet_restitution = r.number(o, "ricochet_restitution", layer.ricochet_restitution);
    out.push_back(layer);
  }
  return !r.failed();
}

}  // namespace

template <class D>
bool read_penetration(Reader& r, const Node& part, ballistics::BatchHits<D>& hits) {
  const Node* list = part.find("penetration");
  if (list == nullptr || r.failed()) return !r.failed();
  if (!list->is_array()) return r.expected(*list, "penetration", "a list"), false;
  for (std::size_t i = 0; i < list->children.size(); ++i) {
    Object o;
    if (!r.open(list->children[i], index_path("penetration", i), penetration_kind, o)) return false;
    std::vector<ballistics::Layer> layers;
    if (!read_layers(r, *o.find("wall"), o.path_of("wall"), layers, ballistics::BatchHits<D>::through)) return false;
    const std::uint32_t id = r.user_id(o);
    if (r.failed()) return false;
    const core::Status set = o.has("user_id") ? hits.set_material(id, layers) : hits.set_default(layers);
    if (!r.accept(set, *o.find("wall"), o.path_of("wall"))) return false;
  }
  return true;
}
template bool read_penetration(Reader&, const Node&, ballistics::BatchHits<rigid::Dim2>&);
template bool read_penetration(Reader&, const Node&, ballistics::BatchHits<rigid::Dim3>&);

template <class D>
void read_destruction(DestructionPlace<D>& place, std::string_view list, const Node& node, const std::string& path) {
  const bool charge = list == "explosions", gun = list == "guns", rocket = list == "rockets", shell = list == "shells";
  const ObjectKind& kind = charge   ? explosion_kind
                           : gun    ? gun_kind
                           : rocket ? rocket_kind
                           : shell  ? fired_shell_kind
                                    : structure_kind;
  Object o;
  if (!place.reader.open(node, path, kind, o)) return;
  if (!place.reader.wanted(o)) return;
  if (charge) return read_explosion(place, o);
  if (gun) return read_gun(place, o);
  if constexpr (D::dimension == 3) {
    if (rocket) return read_rocket(place, o);
    if (shell) return read_shell(place, o);
  }
  read_structure(place, o);
}
template void read_destruction(DestructionPlace<rigid::Dim2>&, std::string_view, const Node&, const std::string&);
template void read_destruction(DestructionPlace<rigid::Dim3>&, std::string_view, const Node&, const std::string&);

}  // namespace carom::scene::detail
