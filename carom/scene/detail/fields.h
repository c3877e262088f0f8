// The tables of what a scene file may hold. The loader reads by them, the schema and its errors are made from them.
#pragma once

#include <span>
#include <string_view>

#include "carom/scene/detail/quantity.h"

namespace carom::scene::detail {

enum class FieldType : std::uint8_t {
  flag,
  integer,
  quantity,
  vector,
  rotation,
  text,
  name,
  choice,
  bits,
  color,
  point_list,
  point_lists,  ///< a list of them
  number_list,
  object,
  list,
  map,
  /// object or name of a reusable one
  reference,
  any
};

struct ObjectKind;

struct Field {
  const char* name;
  FieldType type;
  Measure measure = Measure::plain;  ///< of quantities, vectors, points and numbers
  const char* description = "";
  const ObjectKind* of = nullptr;  ///< of objects, lists and maps
  std::span<const std::string_view> choices{};
  bool required = false;
  std::uint8_t dimensions = 0;  ///< 2 or 3: only there; 0: both
};

struct ObjectKind {
  const char* name;  ///< "body"
  const char* description;
  std::span<const Field> fields;
  const Field* find(std::string_view key) const {
    for (const Field& f : fields)
      if (key == f.name) return &f;
    return nullptr;
  }
};

/// Of the key "preset" wherever it stands.
inline constexpr const char* preset_text = "name of a preset file, without .json";
/// Of the key "name" of what is not a body.
inline constexpr const char* name_text = "unique among its kind; {expressions} in braces are replaced";
inline constexpr std::string_view drag_functions[] = {"g1", "g2", "g5", "g6", "g7", "g8", "gi", "gs", "ra4"};

struct FieldTables {
  const ObjectKind *scene, *part, *world, *material_pair, *parameter, *material, *filter, *surface, *shape, *body,
      *character, *mass_properties, *group, *joint, *joint_axis, *joint_axes, *frame, *spring, *limit, *motor,
      *effector, *wave, *camera, *plot, *axis, *series, *expectation, *rotation, *preset, *flight, *earth, *vehicle,
      *initial, *rope, *cloth, *soft_body, *liquid, *grains, *particles, *structure, *explosion, *gun;
  std::span<const ObjectKind* const> all;
};
const FieldTables& tables();

}  // namespace carom::scene::detail
