// JSON text of the parts of a world, each number with the digits that restore its bits.
#pragma once

#include <string>

#include "carom/math/decimal.h"
#include "carom/rigid/definitions.h"
#include "carom/scene/detail/document.h"

namespace carom::scene::detail {

/// Digits that give the same bits back when they are read as a double and narrowed.
inline std::string digits(double v) { return shortest(v); }
inline std::string digits(float v) {
  const std::string s = shortest(v);
  return float(math::parse_decimal(s).value) == v ? s : shortest(double(v));
}
template <class T>
std::string vector_text(math::Vec2<T> v) {
  return "[" + digits(v.x) + ", " + digits(v.y) + "]";
}
template <class T>
std::string vector_text(math::Vec3<T> v) {
  return "[" + digits(v.x) + ", " + digits(v.y) + ", " + digits(v.z) + "]";
}
// A rotation is normalised when it is read, which loses the sign of a zero: adding one loses it here too.
inline std::string rotation_text(math::Rot2f q) { return "[" + digits(q.c + 0.0f) + ", " + digits(q.s + 0.0f) + "]"; }
inline std::string rotation_text(const math::Quatf& q) {
  return "[" + digits(q.w + 0.0f) + ", " + digits(q.x + 0.0f) + ", " + digits(q.y + 0.0f) + ", " + digits(q.z + 0.0f) +
         "]";
}
inline std::string angular_text(float w) { return digits(w); }
inline std::string angular_text(math::Vec3f w) { return vector_text(w); }
std::string bits_text(std::uint64_t bits);
/// "#rrggbb", or "#rrggbbaa" where it is not solid, from 0xAARRGGBB.
std::string color_text(std::uint32_t argb);
inline const char* truth(bool b) { return b ? "true" : "false"; }

/// "key": value pairs of one object.
class Fields {
 public:
  Fields& put(const char* key, const std::string& json) {
    text_ += (text_.empty() ? "" : ", ") + quote(key) + ": " + json;
    return *this;
  }
  Fields& put(const char* key, double v) { return put(key, digits(v)); }
  Fields& put(const char* key, float v) { return put(key, digits(v)); }
  Fields& flag(const char* key, bool v, bool fallback) {
    return v == fallback ? *this : put(key, std::string(truth(v)));
  }
  template <class T>
  Fields& unless(const char* key, T v, T fallback) {
    return v == fallback ? *this : put(key, v);
  }
  std::string object() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

/// A shape in its place, with its material and filter.
template <class D>
std::string shape_text(const typename D::Shape& shape, const rigid::ShapeDef<D>& definition);
extern template std::string shape_text<rigid::Dim2>(const geometry::Shape2&, const rigid::ShapeDef<rigid::Dim2>&);
extern template std::string shape_text<rigid::Dim3>(const geometry::Shape3&, const rigid::ShapeDef<rigid::Dim3>&);

}  // namespace carom::scene::detail
