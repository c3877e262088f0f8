// Bodies that fell asleep together wake together.
#pragma once

#include <vector>

#include "carom/rigid/detail/body_store.h"

namespace carom::rigid::detail {

/// Each island is a range of `members` while it sleeps; ranges of woken islands are reused by compaction.
struct SleepingIslands {
  struct Island {
    std::vector<std::int32_t> bodies;  ///< slots; empty: free
  };
  std::vector<Island> islands;
  std::vector<std::int32_t> free;
  int count() const { return int(islands.size() - free.size()); }
};

}  // namespace carom::rigid::detail
