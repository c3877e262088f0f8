// Messages about what the caller filled in; whose filters let them meet.
#pragma once

#include <string>

#include "carom/core/result.h"
#include "carom/math/vec.h"
#include "carom/rigid/definitions.h"

namespace carom::particles::detail {

inline bool finite_vector(math::Vec3d v) {
  return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z);
}
inline bool finite_vector(math::Vec3f v) {
  return math::is_finite(v.x) && math::is_finite(v.y) && math::is_finite(v.z);
}
inline bool filters_meet(const rigid::Filter& a, const rigid::Filter& b) {
  if (a.group != 0 && a.group == b.group) return a.group > 0;
  return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}
inline core::Error bad(const char* what, const char* field, const std::string& found, const char* expected) {
  return core::Error{std::string(what) + ": " + field + " is " + found + ", expected " + expected};
}
inline core::Error bad(const char* what, const char* field, double found, const char* expected) {
  return bad(what, field, std::to_string(found), expected);
}

}  // namespace carom::particles::detail
