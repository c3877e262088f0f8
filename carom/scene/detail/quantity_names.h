// Quantities of a scene's things by their names: "gun.turret.hits", "rope.lead.end.x".
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "carom/core/string.h"
#include "carom/scene/scene_world.h"

namespace carom::scene::detail {

/// Finds what `text` names. `each_name(f)` calls f(list, place, name) for every thing; `fields` have `name`, `unit` and
/// `vector`, and `has(list, field)` tells of which things they are. Names may have dots: of several that fit, the
/// longest counts. Fills the place in `source` and the unit; false, with both as they were, where nothing fits.
template <class Field, class EachName, class Has>
bool find_quantity(std::string_view text, int dimension, std::span<const std::string_view> lists,
                   std::span<const Field> fields, EachName&& each_name, Has&& has, Probe::Source& source,
                   std::string_view& unit) {
  bool found = false;
  std::size_t best = 0;
  each_name([&](int list, int place, const std::string& name) {
    const std::string whole = core::text(lists[std::size_t(list)], ".", name, ".");
    if (text.substr(0, whole.size()) != whole || whole.size() < best) return;
    const std::string_view rest = text.substr(whole.size());
    for (std::size_t f = 0; f < fields.size(); ++f) {
      if (!has(list, int(f)) || rest.substr(0, fields[f].name.size()) != fields[f].name) continue;
      const std::string_view end = rest.substr(fields[f].name.size());
      const bool good =
          fields[f].vector ? end.size() == 2 && end[0] == '.' && end[1] >= 'x' && end[1] <= (dimension == 2 ? 'y' : 'z')
                           : end.empty();
      if (!good) continue;
      best = whole.size();
      found = true;
      source.list = list;
      source.item = place;
      source.field = int(f);
      source.component = fields[f].vector ? end[1] - 'x' : 0;
      unit = fields[f].unit;
    }
  });
  return found;
}

/// What quantities begin with: "gun.turret" of every thing.
template <class EachName>
std::vector<std::string> quantity_names(std::span<const std::string_view> lists, EachName&& each_name) {
  std::vector<std::string> out;
  each_name(
      [&](int list, int, const std::string& name) { out.push_back(core::text(lists[std::size_t(list)], ".", name)); });
  return out;
}

}  // namespace carom::scene::detail
