// Why a body does what it does: who pushes it, how hard, and why it is awake.
#pragma once

#include <string>

#include "apps/host/stage.h"

namespace carom::host {

/// A JSON object as docs/protocol.md describes for `inspected`; empty where the stage shows no such body.
template <class D>
std::string inspect_body(Stage<D>& stage, std::uint32_t id);

}  // namespace carom::host
