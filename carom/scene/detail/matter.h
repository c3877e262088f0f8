// Reads ropes, cloth, soft bodies, liquids, grains and particles of a scene file into a world.
#pragma once

#include "carom/scene/detail/joints.h"
#include "carom/scene/matter.h"

namespace carom::scene::detail {

inline constexpr const char* matter_lists[] = {"ropes", "cloths", "soft_bodies", "liquids", "grains", "particles"};
inline bool is_matter(std::string_view list) {
  for (const std::string_view m : matter_lists)
    if (m == list) return true;
  return false;
}

/// Particles that are born into systems which may come later in the file.
struct UnresolvedEmission {
  Object object;
  std::size_t system = 0;
  std::vector<Reader::Variable> variables;
};
/// What readers of matter share.
template <class D>
struct MatterPlace {
  Reader& reader;
  BodyNames& names;
  rigid::World<D>& world;
  Matter& out;
  double budget = 0;  ///< points and cells that may still be made
  std::vector<UnresolvedEmission> unresolved{};
};
/// Makes one thing of the list. Fails the reader where it is wrong.
template <class D>
[[gnu::noinline]] void read_matter(MatterPlace<D>& place, std::string_view list, const Node& node,
                                   const std::string& path);
/// The systems that particles are born into, once all systems are there.
template <class D>
void resolve_sub_emissions(MatterPlace<D>& place);

// By kind (matter_ropes.cpp, matter_liquids.cpp, matter_particles.cpp).
[[gnu::noinline]] void read_rope(MatterPlace<rigid::Dim3>& place, const Object& o);
[[gnu::noinline]] void read_cloth(MatterPlace<rigid::Dim3>& place, const Object& o);
[[gnu::noinline]] void read_soft_body(MatterPlace<rigid::Dim3>& place, const Object& o);
template <class D>
[[gnu::noinline]] void read_liquid(MatterPlace<D>& place, const Object& o);
template <class D>
[[gnu::noinline]] void read_grains(MatterPlace<D>& place, const Object& o);
template <class D>
[[gnu::noinline]] void read_particles(MatterPlace<D>& place, const Object& o);

/// The name and colour of a thing; fails where another of the list has the name.
template <class List>
bool name_thing(Reader& reader, const Object& o, std::string_view kind, const List& others, std::string& name,
                std::uint32_t& color);
/// Takes from the budget; fails where there is not enough of it.
bool spend(Reader& reader, double& budget, double points, const Object& o);
/// Opens every entry of a list.
template <class Make>
void each_entry(Reader& reader, const Object& o, const char* key, const ObjectKind& kind, const Make& make) {
  const Node* list = o.find(key);
  if (list == nullptr || reader.failed()) return;
  const std::string path = o.path_of(key);
  if (!list->is_array()) return reader.expected(*list, path, "a list");
  for (std::size_t i = 0; i < list->children.size() && !reader.failed(); ++i) {
    Object entry;
    if (reader.open(list->children[i], index_path(path, i), kind, entry)) make(entry);
  }
}
/// "radius", or half of "diameter".
double read_radius(Reader& reader, const Object& o, double fallback);
rigid::Filter read_matter_filter(Reader& reader, const Object& o);
/// A number, or a rising list of two.
particles::Range read_range(Reader& reader, const Object& o, const char* key, Measure measure,
                            particles::Range fallback);
std::vector<std::uint32_t> read_indices(Reader& reader, const Object& o, const char* key);

template <class List>
bool name_thing(Reader& reader, const Object& o, std::string_view kind, const List& others, std::string& name,
                std::uint32_t& color) {
  name = reader.text(o, "name");
  if (const auto read = o.kind->find("color") != nullptr ? reader.color(o, "color") : std::nullopt)
    color = *read & 0xffffff;
  if (reader.failed()) return false;
  const auto taken = [&] {
    for (const auto& other : others)
      if (other.name == name) return true;
    return false;
  };
  if (name.empty()) {
    name = std::string(kind) + "_" + std::to_string(others.size());
    while (taken()) name += "_";
  } else if (taken()) {
    reader.fail(*o.find("name"), o.path_of("name"),
                "found the name \"" + name + "\" a second time, expected one that no other has");
    return false;
  }
  return true;
}

}  // namespace carom::scene::detail
