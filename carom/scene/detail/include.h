// The files of a scene: the scene itself, what it includes, and the presets it names.
#pragma once

#include "carom/scene/detail/reader.h"
#include "carom/scene/scene.h"

namespace carom::scene::detail {

core::Status read_parts(SceneDocument& document, std::string_view text, std::string_view name,
                        const Resolver& resolver);

core::Result<std::string> read_file(const std::string& path, std::size_t limit);

}  // namespace carom::scene::detail
