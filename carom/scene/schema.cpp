// The JSON Schema (draft 2020-12) of scene files, made from the tables that the loader reads with.
#include <algorithm>
#include <iterator>

#include "carom/scene/detail/document.h"
#include "carom/scene/detail/fields.h"
#include "carom/scene/scene.h"

namespace carom::scene {
namespace {
using detail::Field;
using detail::FieldType;
using detail::Measure;
using detail::ObjectKind;
using detail::quote;
using detail::tables;

std::string reference_to(std::string_view name) { return "{\"$ref\": " + quote("#/$defs/" + std::string(name)) + "}"; }

std::string measure_name(Measure measure) {
  if (measure == Measure::count_) return "quantity";
  if (measure == Measure::plain) return "number";
  std::string name = detail::measure_info(measure).article;
  name = name.substr(name.find(' ') + 1);
  for (char& c : name)
    if (c == ' ') c = '_';
  return "quantity_" + name;
}

std::string item_schema(const Field& field) {
  const ObjectKind* const grouped[] = {tables().body,      tables().joint,     tables().effector,  tables().rope,
                                       tables().cloth,     tables().soft_body, tables().liquid,    tables().grains,
                                       tables().particles, tables().structure, tables().explosion, tables().gun};
  if (field.of != nullptr && std::find(std::begin(grouped), std::end(grouped), field.of) != std::end(grouped))
    return "{\"anyOf\": [" + reference_to(field.of->name) + ", " + reference_to("group") + "]}";
  if (field.of == tables().shape || field.of == tables().surface)
    return "{\"anyOf\": [{\"type\": \"string\"}, " + reference_to(field.of->name) + "]}";
  return field.of != nullptr ? reference_to(field.of->name) : std::string("{\"type\": \"string\"}");
}

/// The members of the schema of a field, without braces.
std::string field_schema(const Field& field) {
  const std::string quantity = reference_to(measure_name(field.measure));
  switch (field.type) {
    case FieldType::flag:
      return "\"type\": [\"boolean\", \"string\"]";
    case FieldType::integer:
      return "\"type\": [\"integer\", \"string\"]";
    case FieldType::quantity:
      return "\"$ref\": " + quote("#/$defs/" + measure_name(field.measure));
    case FieldType::vector:
      if (field.measure == Measure::angular_speed || field.measure == Measure::flux_density ||
          field.measure == Measure::area)  // a number in the plane
        return "\"anyOf\": [" + quantity + ", {\"type\": \"array\", \"items\": " + quantity +
               ", \"minItems\": 3, \"maxItems\": 3}]";
      return "\"type\": \"array\", \"items\": " + quantity + ", \"minItems\": " + (field.dimensions == 3 ? "3" : "2") +
             ", \"maxItems\": 3";
    case FieldType::rotation:
      return "\"anyOf\": [" + reference_to(measure_name(Measure::angle)) + ", " + reference_to("rotation") +
             ", {\"type\": \"array\", \"items\": " + reference_to("number") + ", \"minItems\": 2, \"maxItems\": 4}]";
    case FieldType::text:
    case FieldType::name:
      return "\"type\": \"string\"";
    case FieldType::choice: {
      std::string list;
      for (const std::string_view c : field.choices) list += (list.empty() ? "" : ", ") + quote(c);
      return "\"enum\": [" + list + "]";
    }
    case FieldType::bits:
      return "\"anyOf\": [{\"type\": \"integer\"}, {\"type\": \"string\", \"pattern\": \"^0x[0-9a-fA-F]{1,16}$\"}, "
             "{\"type\": \"array\", \"items\": {\"type\": \"integer\", \"minimum\": 0, \"maximum\": 63}}]";
    case FieldType::color:
      return "\"type\": \"string\"";
    case FieldType::point_list:
    case FieldType::point_lists: {
      const std::string list = "\"type\": \"array\", \"items\": {\"type\": \"array\", \"items\": " + quantity +
                               ", \"minItems\": 2, \"maxItems\": 3}";
      return field.type == FieldType::point_list ? list : "\"type\": \"array\", \"items\": {" + list + "}";
    }
    case FieldType::number_list:
      return "\"type\": \"array\", \"items\": " + quantity;
    case FieldType::object:
      return "\"$ref\": " + quote(std::string("#/$defs/") + field.of->name);
    case FieldType::list:
      return "\"type\": \"array\", \"items\": " + item_schema(field);
    case FieldType::map:
      return "\"type\": \"object\", \"additionalProperties\": " +
             (field.of != nullptr ? item_schema(field) : reference_to("number"));
    case FieldType::reference:
      return "\"anyOf\": [{\"type\": \"string\"}, " + reference_to(field.of->name) + "]";
    case FieldType::any:
      return "\"type\": [\"number\", \"string\", \"array\", \"object\"]";
  }
  return "";
}

std::string kind_schema(const ObjectKind& kind, const std::string& indent) {
  std::string out = indent + "\"type\": \"object\",\n" + indent + "\"description\": " + quote(kind.description) +
                    ",\n" + indent + "\"additionalProperties\": false,\n";
  std::string required;
  for (const Field& f : kind.fields)
    if (f.required) required += (required.empty() ? "" : ", ") + quote(f.name);
  if (!required.empty()) out += indent + "\"required\": [" + required + "],\n";
  out += indent + "\"properties\": {";
  bool first = true;
  for (const Field& f : kind.fields) {
    std::string description = f.description;
    if (f.dimensions == 2) description += description.empty() ? "plane only" : " (plane only)";
    if (f.dimensions == 3) description += description.empty() ? "space only" : " (space only)";
    out += (first ? "\n" : ",\n") + indent + "  " + quote(f.name) + ": {" + field_schema(f);
    if (!description.empty()) out += ", \"description\": " + quote(description);
    out += "}";
    first = false;
  }
  return out + "\n" + indent + "}";
}

}  // namespace

std::string scene_schema() {
  std::string out =
      "{\n  \"$schema\": \"https://json-schema.org/draft/2020-12/schema\",\n  \"title\": \"Carom scene\",\n";
  out += kind_schema(*tables().scene, "  ") + ",\n  \"$defs\": {\n";
  for (int i = 0; i <= int(Measure::count_); ++i) {
    const Measure measure = Measure(i);
    std::string description = "a plain number, or an expression such as \"=2*x\"";
    if (measure == Measure::count_)
      description = "a number in SI units, a text with a unit, or an expression";
    else if (measure != Measure::plain)
      description = std::string(detail::measure_info(measure).article) + ": a number in " +
                    detail::measure_info(measure).unit + ", a text such as " +
                    quote(detail::measure_info(measure).sample) + ", or an expression such as \"=2*x\"";
    out += "    " + quote(measure_name(measure)) +
           ": {\"type\": [\"number\", \"string\"], \"description\": " + quote(description) + "},\n";
  }
  bool first = true;
  for (const ObjectKind* kind : tables().all) {
    if (kind == tables().scene) continue;
    out += std::string(first ? "" : ",\n") + "    " + quote(kind->name) + ": {\n" + kind_schema(*kind, "      ") +
           "\n    }";
    first = false;
  }
  return out + "\n  }\n}\n";
}

}  // namespace carom::scene
