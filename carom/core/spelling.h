// "Did you mean …": the nearest known name to a misspelt one.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "carom/export.h"

namespace carom::core {

/// Insertions, deletions, substitutions and swaps of neighbours that turn a into b (optimal string alignment),
/// upper and lower case being alike. Names longer than 64 characters are compared by their first 64.
CAROM_API int edit_distance(std::string_view a, std::string_view b);

/// The name nearest to `name`, the first of equally near ones; empty where none is near enough to be meant (a third
/// of the longer name's length, at least 1 edit).
CAROM_API std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known);

/// `, did you mean "mass"?`, or nothing: the end of an error message.
CAROM_API std::string did_you_mean(std::string_view name, std::span<const std::string_view> known);

}  // namespace carom::core
