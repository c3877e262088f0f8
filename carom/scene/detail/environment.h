// The environment of a scene file, read and written.
#pragma once

#include <memory>

#include "carom/environment/environment.h"
#include "carom/scene/detail/reader.h"

namespace carom::scene::detail {

/// Null and an error in the reader where it is wrong.
std::shared_ptr<const environment::Environment> read_environment(Reader& reader, const Object& scene);
/// As the value of the key "environment", exact to the bit; terrain that is a function is left out.
std::string environment_text(const environment::Environment& environment, int dimension);

}  // namespace carom::scene::detail
