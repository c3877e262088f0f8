#include "carom/scene/detail/matter.h"

#include "carom/scene/detail/matter_fields.h"

namespace carom::scene::detail {

template <class D>
void read_matter(MatterPlace<D>& place, std::string_view list, const Node& node, const std::string& path) {
  const FieldTables& t = tables();
  const ObjectKind* const kinds[] = {t.rope, t.cloth, t.soft_body, t.liquid, t.grains, t.particles};
  int which = 0;
  while (list != matter_lists[which]) ++which;
  Object o;
  if (!place.reader.open(node, path, *kinds[which], o) || !place.reader.wanted(o)) return;
  if constexpr (D::dimension == 3) {
    if (which == 0) return read_rope(place, o);
    if (which == 1) return read_cloth(place, o);
    if (which == 2) return read_soft_body(place, o);
  }
  if (which == 3) return read_liquid(place, o);
  if (which == 4) return read_grains(place, o);
  if (which == 5) return read_particles(place, o);
  place.reader.fail(node, path, "found what only a scene of dimension 3 has");
}
template void read_matter(MatterPlace<rigid::Dim2>&, std::string_view, const Node&, const std::string&);
template void read_matter(MatterPlace<rigid::Dim3>&, std::string_view, const Node&, const std::string&);

bool spend(Reader& reader, double& budget, double points, const Object& o) {
  if (reader.failed()) return false;
  if (points <= budget) return budget -= points, true;
  reader.fail(*o.node, o.path, "this needs more points or cells than a scene may have");
  return false;
}

double read_radius(Reader& reader, const Object& o, double fallback) {
  if (o.has("radius") && o.has("diameter")) reader.fail(*o.node, o.path, "found both radius and diameter");
  return o.has("diameter") ? 0.5 * reader.number(o, "diameter", 0) : reader.number(o, "radius", fallback);
}

rigid::Filter read_matter_filter(Reader& reader, const Object& o) {
  rigid::Filter filter;
  Object f;
  if (!o.has("filter") || !reader.open(*o.find("filter"), o.path_of("filter"), filter_kind, f)) return filter;
  filter.category = reader.bits(f, "category", filter.category);
  filter.mask = reader.bits(f, "mask", filter.mask);
  filter.group = reader.integer(f, "group", filter.group, -0x7FFFFFFF, 0x7FFFFFFF);
  return filter;
}

particles::Range read_range(Reader& reader, const Object& o, const char* key, Measure measure,
                            particles::Range fallback) {
  const Node* node = o.find(key);
  if (node == nullptr || reader.failed()) return fallback;
  const std::string path = o.path_of(key);
  if (!node->is_array()) {
    const float one = float(reader.value(*node, path, measure));
    return {one, one};
  }
  if (node->children.size() != 2) {
    reader.expected(*node, path, "one number, or the lowest and the highest");
    return fallback;
  }
  const float low = float(reader.value(node->children[0], index_path(path, 0), measure));
  return {low, float(reader.value(node->children[1], index_path(path, 1), measure))};
}

std::vector<std::uint32_t> read_indices(Reader& reader, const Object& o, const char* key) {
  std::vector<std::uint32_t> out;
  for (const double x : reader.numbers(o, key)) {
    if (!(x >= 0 && x < 4e9 && x == __builtin_floor(x))) {
      reader.expected(*o.find(key), o.path_of(key), "whole numbers from 0");
      return {};
    }
    out.push_back(std::uint32_t(x));
  }
  return out;
}

}  // namespace carom::scene::detail
