// What is set for single bodies: their clocks, substeps, weight, resistance, locks, and whom they meet.
#pragma once

#include "apps/host/demos/demos.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_time_scale();
std::unique_ptr<Demo> make_substeps();
std::unique_ptr<Demo> make_body_rules();
std::unique_ptr<Demo> make_filters();
std::unique_ptr<Demo> make_body_rules_space();
std::unique_ptr<Demo> make_gates_space();
std::unique_ptr<Demo> make_events_space();

}  // namespace carom::host::demo
