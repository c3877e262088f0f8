#include "apps/host/demos/rules/list.h"

namespace carom::host::demo {

std::span<const DemoEntry> rule_demos() {
  static constexpr DemoEntry all[] = {
      {"time-scale", make_time_scale}, {"body-rules", make_body_rules},          {"filters", make_filters},
      {"substeps", make_substeps},     {"body-rules-3d", make_body_rules_space}, {"gates-3d", make_gates_space},
      {"events-3d", make_events_space}};
  return all;
}

}  // namespace carom::host::demo
