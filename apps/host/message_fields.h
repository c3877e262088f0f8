// Fields of a page's message, each with what was expected of it; the first complaint is kept.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "carom/core/result.h"
#include "carom/math/vec.h"

namespace carom::host {

/// A member of a JSON object, or null.
inline const nlohmann::json* member(const nlohmann::json& object, const char* name) {
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

class MessageFields {
 public:
  explicit MessageFields(const nlohmann::json& object) : object_(object) {}
  core::Status status;

  void wrong(const char* name, const char* expected) {
    if (status.ok()) status = core::Error{std::string("field \"") + name + "\": expected " + expected};
  }
  double number(const char* name) {
    const nlohmann::json* value = member(object_, name);
    if (value && value->is_number()) {
      const double x = value->get<double>();
      if (math::is_finite(x)) return x;
    }
    wrong(name, "a finite number");
    return 0;
  }
  std::string text(const char* name) {
    const nlohmann::json* value = member(object_, name);
    if (value && value->is_string()) return value->get<std::string>();
    wrong(name, "a string");
    return {};
  }
  bool flag(const char* name) {
    const nlohmann::json* value = member(object_, name);
    if (value && value->is_boolean()) return value->get<bool>();
    wrong(name, "true or false");
    return false;
  }
  math::Vec3d vector(const char* name) {
    const nlohmann::json* value = member(object_, name);
    if (value && value->is_array() && value->size() == 3 && (*value)[0].is_number() && (*value)[1].is_number() &&
        (*value)[2].is_number()) {
      const math::Vec3d v{(*value)[0].get<double>(), (*value)[1].get<double>(), (*value)[2].get<double>()};
      if (math::is_finite(v) && math::length_squared(v) < 1e24) return v;
    }
    wrong(name, "three finite numbers");
    return {};
  }
  math::Vec3d direction(const char* name) {
    const math::Vec3d v = vector(name);
    if (status.ok() && !(math::length_squared(v) > 1e-12)) wrong(name, "a direction, found none");
    return v;
  }
  std::int64_t integer(const char* name, double low, double high) {
    const double x = number(name);
    if (!status.ok()) return 0;
    if (x >= low && x <= high && x == double(std::int64_t(x))) return std::int64_t(x);
    wrong(name, "a whole number in range");
    return 0;
  }
  std::int64_t pointer() { return integer("pointer", -2147483648.0, 2147483647.0); }

 private:
  const nlohmann::json& object_;
};

}  // namespace carom::host
