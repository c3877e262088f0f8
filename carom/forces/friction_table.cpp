#include "carom/forces/friction_table.h"

namespace carom::forces {
namespace {

constexpr PairFriction table[] = {
    {"hard steel", "hard steel", 0.78, 0.42},
    {"mild steel", "mild steel", 0.74, 0.57},
    {"steel", "steel", 0.78, 0.42},
    {"steel, greased", "steel, greased", 0.11, 0.05},
    {"aluminium", "mild steel", 0.61, 0.47},
    {"aluminium", "aluminium", 1.05, 1.40},
    {"copper", "mild steel", 0.53, 0.36},
    {"brass", "mild steel", 0.51, 0.44},
    {"bronze", "mild steel", 0.34, 0.34},
    {"lead", "mild steel", 0.95, 0.95},
    {"nickel", "nickel", 1.10, 0.53},
    {"zinc", "cast iron", 0.85, 0.21},
    {"copper", "cast iron", 1.05, 0.29},
    {"cast iron", "cast iron", 1.10, 0.15},
    {"graphite", "steel", 0.21, 0.21},
    {"PTFE", "PTFE", 0.04, 0.04},
    {"PTFE", "steel", 0.04, 0.04},
    {"glass", "glass", 0.94, 0.40},
    {"glass", "nickel", 0.78, 0.56},
    {"copper", "glass", 0.68, 0.53},
    {"oak", "oak", 0.62, 0.48},
    {"oak, across the grain", "oak", 0.54, 0.32},
    {"oak", "leather", 0.61, 0.52},
    {"cast iron", "leather", 0.60, 0.56},
    {"cast iron", "oak", 0.49, 0.49},
    {"rubber", "asphalt", 0.90, 0.70},
    {"rubber", "asphalt, wet", 0.60, 0.50},
    {"rubber", "concrete", 1.00, 0.80},
    {"rubber", "concrete, wet", 0.70, 0.60},
    {"rubber", "gravel", 0.60, 0.55},
    {"rubber", "snow", 0.20, 0.15},
    {"rubber", "ice", 0.10, 0.07},
    {"steel", "ice", 0.10, 0.03},
    {"waxed ski", "snow", 0.10, 0.05},
};

}  // namespace

std::span<const PairFriction> friction_table() { return table; }

std::optional<PairFriction> find_friction(std::string_view first, std::string_view second) {
  for (const PairFriction& pair : table)
    if ((pair.first == first && pair.second == second) || (pair.first == second && pair.second == first)) return pair;
  return std::nullopt;
}

}  // namespace carom::forces
