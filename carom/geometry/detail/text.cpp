#include "carom/geometry/detail/text.h"

#include <cstdarg>

namespace carom::geometry::detail {

static std::string text_of(const char* format, std::va_list arguments) {
  char buffer[512];
  std::vsnprintf(buffer, sizeof buffer, format, arguments);
  return buffer;
}

std::string text(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::string result = text_of(format, arguments);
  va_end(arguments);
  return result;
}

core::Error error(const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  std::string result = text_of(format, arguments);
  va_end(arguments);
  return {std::move(result)};
}

core::Status check_range(const char* field, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return error("%s is %g: expected a number from %g to %g", field, value, low, high);
}

core::Status check_point(const char* field, math::Vec2f value, double limit) {
  if (math::abs(double(value.x)) <= limit && math::abs(double(value.y)) <= limit) return {};
  return error("%s is (%g, %g): expected finite coordinates of at most %g m", field, double(value.x), double(value.y),
               limit);
}

core::Status check_point(const char* field, math::Vec3f value, double limit) {
  if (math::abs(double(value.x)) <= limit && math::abs(double(value.y)) <= limit && math::abs(double(value.z)) <= limit)
    return {};
  return error("%s is (%g, %g, %g): expected finite coordinates of at most %g m", field, double(value.x),
               double(value.y), double(value.z), limit);
}

}  // namespace carom::geometry::detail
