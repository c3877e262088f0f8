// Bodies that fell asleep together wake together.
#pragma once

#include <vector>

#include "carom/rigid/detail/body_store.h"

namespace carom::rigid::detail {

/// By number of the island: its first body, from which BodyRecord::next_asleep leads to the others; `none`: free.
struct SleepingIslands {
  std::vector<std::int32_t> first;
  std::vector<std::int32_t> free;
  int count() const { return int(first.size() - free.size()); }
};

}  // namespace carom::rigid::detail
