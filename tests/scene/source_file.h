// Files of the source tree, as a resolver of presets gives them.
#pragma once

#include <fstream>
#include <sstream>
#include <string>

#include "carom/core/result.h"

namespace carom::scene::test {

/// The text of a file, named from the root of the source tree.
inline core::Result<std::string> read_source(std::string_view path) {
  std::ifstream in(std::string(CAROM_SOURCE_DIR) + "/" + std::string(path));
  if (!in) return core::Error{"no file " + std::string(path)};
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

}  // namespace carom::scene::test
