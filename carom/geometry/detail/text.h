// Messages for people, written with printf's rules.
#pragma once

#include <string>

#include "carom/core/result.h"
#include "carom/math/vec.h"

namespace carom::geometry::detail {

[[gnu::format(printf, 1, 2)]] std::string text(const char* format, ...);
[[gnu::format(printf, 1, 2)]] core::Error error(const char* format, ...);

/// Success where `value` lies in [low, high]; otherwise an error that names the field. NaN never passes.
core::Status check_range(const char* field, double value, double low, double high);
/// Success where every component is finite and at most `limit` in size.
core::Status check_point(const char* field, math::Vec2f value, double limit);
core::Status check_point(const char* field, math::Vec3f value, double limit);

}  // namespace carom::geometry::detail
