// Parts of the page that a sweep writes.
#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "apps/host/declaration.h"

namespace carom::command {

struct Varied {
  std::size_t parameter = 0;   ///< its place in the declaration
  std::vector<double> values;  ///< SI
};

/// Text as HTML shows it.
std::string escaped(const std::string& text);
/// What was varied and what was kept, and how many cases failed. `base`: the values that were kept.
std::string sweep_settings(const host::Declaration& d, std::span<const Varied> varied, const std::vector<double>& base,
                           std::span<const nlohmann::ordered_json> cases);
/// The first cases as they are, for who has no spreadsheet at hand.
std::string sweep_table(const std::vector<std::string>& columns, std::span<const nlohmann::ordered_json> cases);

}  // namespace carom::command
