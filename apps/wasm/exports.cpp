// The simulation host as a module: messages in, messages out, as docs/protocol.md says. What goes in is written to the
// place that `carom_room` gives; what comes out lies at `carom_message` until the next call.
#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "apps/host/host.h"
#include "apps/host/scene_demo.h"
#include "carom/core/scheduler.h"
#include "carom/scene/scene.h"

namespace {

using namespace carom;

constexpr std::string_view presets = "presets/", menu = "menu";

/// Scene files and presets by name: what a server finds in its folders, the page hands over.
struct Files {
  std::map<std::string, std::string, std::less<>> text;

  scene::Resolver resolver() const {
    return [this](std::string_view name) -> core::Result<std::string> {
      if (const auto found = text.find(name); found != text.end()) return found->second;
      return core::Error{std::string(name) + ": expected a scene or preset that this page carries"};
    };
  }
  core::Result<std::unique_ptr<host::Demo>> demo(std::string_view name, std::string_view scene_text,
                                                 std::string id) const {
    core::Result<scene::Scene> scene = scene::parse_scene(scene_text, name, resolver());
    if (!scene.ok()) return scene.error();
    return host::make_scene_demo(std::move(scene).value(), std::move(id));
  }
};

struct Module {
  std::string in;
  host::Message out;
  Files files;
  std::unique_ptr<host::SimulationHost> host;
};
Module& module() {
  static Module* const one = new Module;
  return *one;
}

}  // namespace

extern "C" {

#define CAROM_MODULE(name) __attribute__((export_name(name)))

/// Room for `size` bytes of what the next call takes.
CAROM_MODULE("carom_room") char* carom_room(std::uint32_t size) {
  module().in.resize(size);
  return module().in.data();
}

/// The room holds a file's name and, from byte `name_size` on, its text. Scenes go by NAME.json, presets by
/// presets/KIND/NAME.json. `menu` is the `demos` of the `welcome` that an instance of this module said which had these
/// files and no menu: with it the start needs no demo's code and no scene is read. Before `carom_start`.
CAROM_MODULE("carom_file") void carom_file(std::uint32_t name_size) {
  std::string& in = module().in;
  const std::size_t end = std::min<std::size_t>(name_size, in.size());
  module().files.text[in.substr(0, end)] = in.substr(end);
}

CAROM_MODULE("carom_start") void carom_start() {
  Files& files = module().files;
  host::HostOptions options;
  options.threads = core::hardware_threads();
  if (const auto list = files.text.extract(std::string(menu))) options.menu = std::move(list.mapped());
  for (const auto& [name, text] : files.text) {
    if (name.compare(0, presets.size(), presets) == 0) continue;
    const std::string id = "scene:" + name.substr(0, name.rfind('.'));
    host::Declaration summary;
    summary.id = id;
    if (options.menu.empty()) {
      const core::Result<scene::Scene> scene = scene::parse_scene(text, name, files.resolver());
      if (!scene.ok()) continue;
      summary = host::declaration_of(*scene, id);
    }
    options.scenes.push_back({std::move(summary),
                              [&files, name = name, id] { return files.demo(name, files.text.at(name), id); },
                              [&files, name = name] { return files.text.at(name); }});
  }
  options.parse_scene = [&files](std::string_view name, std::string_view text) {
    return files.demo(name, text, std::string(name));
  };
  module().host = std::make_unique<host::SimulationHost>(std::move(options));
}

/// The room holds a text message of the page.
CAROM_MODULE("carom_receive") void carom_receive() { module().host->receive(module().in); }

CAROM_MODULE("carom_receive_binary") void carom_receive_binary() { module().host->receive_binary(module().in); }

CAROM_MODULE("carom_advance") void carom_advance(double seconds) { module().host->advance(seconds); }

/// Takes the next message; −1 where none waits, otherwise 2·bytes, plus one where it is text.
CAROM_MODULE("carom_take") std::int32_t carom_take() {
  if (!module().host->take(module().out)) return -1;
  return std::int32_t(module().out.data.size() * 2 + (module().out.text ? 1 : 0));
}
CAROM_MODULE("carom_message") const char* carom_message() { return module().out.data.data(); }
}
