#include "apps/host/demos/rules/list.h"

namespace carom::host::demo {

std::span<const DemoFactory> rule_demos() {
  static constexpr DemoFactory all[] = {make_time_scale, make_body_rules, make_filters, make_substeps};
  return all;
}

}  // namespace carom::host::demo
