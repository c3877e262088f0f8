// Scene files from anybody: a clear error or a world that runs, is written, and comes back the same.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

#include "carom/scene/destruction.h"
#include "carom/scene/matter.h"
#include "carom/scene/scene.h"
#include "carom/scene/write_scene.h"
#include "tests/fuzz/target.h"

namespace {

[[noreturn]] void broken(const char* what, const std::string& why) {
  std::fprintf(stderr, "%s: %s\n", what, why.c_str());
  std::abort();
}

}  // namespace

FUZZ_TARGET(scene) {
  using namespace carom::scene;
  if (size > 20000) return;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  LoadOptions options;
  options.maximum_objects = 60;
  // Any name gives this same text: includes that meet themselves, presets that are scenes.
  const Resolver resolver = [&](std::string_view path) -> Result<std::string> {
    if (path.size() > 40) return carom::core::Error{"no such file"};
    return std::string(text.substr(size / 2));
  };
  const Result<Scene> scene = parse_scene(text, "fuzz.json", resolver, options);
  if (!scene) {
    if (scene.error().message.empty()) broken("an error without a message", "");
    return;
  }
  if (scene->kind == Kind::flight) return;
  Result<SceneWorld> world = scene->instantiate();
  if (!world) broken("what was parsed cannot be instantiated", world.error().message);
  for (int i = 0; i < 3; ++i)
    if (!world->step()) return;
  const Result<std::string> written = write_scene(*world);
  const auto more = [](const auto& of) {
    return !of.guns.empty() || !of.structures.empty() || !of.rockets.empty() || !of.shells.empty();
  };
  if (world->matter || (world->destruction && (more(world->destruction->plane) || more(world->destruction->space)))) {
    if (written) broken("ropes, guns and so on were left out of what was written", *written);
    return;
  }
  if (!written) broken("a world cannot be written", written.error().message);
  const Result<Scene> again = parse_scene(*written, "written.json");
  if (!again) broken("what was written cannot be read", again.error().message + "\n" + *written);
  const Result<SceneWorld> copy = again->instantiate();
  if (!copy) broken("what was written cannot be instantiated", copy.error().message);
  if (copy->state_hash() != world->state_hash()) broken("what was written is another world", *written);
}
