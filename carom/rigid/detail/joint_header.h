// What the rest of the engine knows of a joint: whom it connects and where it is in the lists and the graph.
#pragma once

#include "carom/rigid/detail/constraint_graph.h"

namespace carom::rigid::detail {

struct JointHeader {
  std::int32_t body[2] = {none, none};  ///< slots of A and B; A may be `none` (mouse joint)
  std::int32_t next[2] = {none, none};  ///< edge keys (2·joint + side) in the lists of A and B
  std::int32_t previous[2] = {none, none};
  GraphPlace place{};
  bool collide_connected = false;
};

}  // namespace carom::rigid::detail
