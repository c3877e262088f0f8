#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "apps/command/command.h"
#include "apps/host/registry.h"
#include "apps/host/scene_demo.h"
#include "apps/host/stress_demo.h"
#include "carom/math/units.h"
#include "carom/scene/scene.h"

namespace carom::command {

namespace fs = std::filesystem;

std::atomic<bool> interrupted{false};

namespace {
void on_signal(int number) {
  if (interrupted.exchange(true)) ::_exit(128 + number);
}
}  // namespace

void watch_for_interrupts() {
  struct sigaction action{};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

int fail(int code, const std::string& message) {
  std::fprintf(stderr, "carom: %s\n", message.c_str());
  return code;
}

double now_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Progress::Progress(std::string label, bool wanted)
    : label_(std::move(label)), terminal_(wanted && ::isatty(STDERR_FILENO) == 1), started_(now_seconds()) {}

Progress::~Progress() {
  if (shown_) std::fprintf(stderr, "\r\x1b[K");
}

void Progress::update(double fraction) {
  if (!terminal_) return;
  const double now = now_seconds(), elapsed = now - started_;
  if (elapsed < 0.4 || now - last_ < 0.1) return;
  const double total = elapsed / std::max(fraction, 1e-6);
  if (!shown_ && total < 2) return;
  shown_ = true;
  last_ = now;
  constexpr int width = 32;
  const int full = int(fraction * width);
  std::string bar(std::size_t(std::clamp(full, 0, width)), '#');
  bar.resize(width, '.');
  std::fprintf(stderr, "\r%s [%s] %3.0f %%  %.0f s left \x1b[K", label_.c_str(), bar.c_str(), 100 * fraction,
               total - elapsed);
  std::fflush(stderr);
}

std::vector<std::string> data_folders(const std::string& name) {
  std::vector<std::string> out;
  const auto consider = [&](const fs::path& path) {
    std::error_code error;
    if (!fs::is_directory(path, error)) return;
    const std::string text = fs::weakly_canonical(path, error).string();
    if (std::find(out.begin(), out.end(), text) == out.end()) out.push_back(text);
  };
  consider(name);
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (!error) {
    // build/release/apps/command/carom and /usr/bin/carom
    consider(program.parent_path() / "../../../.." / name);
    consider(program.parent_path() / "../share/carom" / name);
  }
  return out;
}

std::vector<SceneFile> scene_files() {
  std::vector<SceneFile> out;
  for (const std::string& folder : data_folders("scenes")) {
    std::error_code error;
    for (fs::recursive_directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
      const fs::path& path = i->path();
      if (i->is_directory(error)) {
        // Parts that scenes include, and the schema, are no scenes.
        if (path.filename() == "schema" || path.filename() == "parts") i.disable_recursion_pending();
        continue;
      }
      if (path.extension() != ".json") continue;
      const std::string name = fs::relative(path, folder, error).replace_extension().generic_string();
      if (std::none_of(out.begin(), out.end(), [&](const SceneFile& f) { return f.name == name; }))
        out.push_back({name, path.string()});
    }
  }
  std::sort(out.begin(), out.end(), [](const SceneFile& a, const SceneFile& b) { return a.name < b.name; });
  return out;
}

std::vector<std::string> preset_names() {
  std::vector<std::string> out;
  for (const std::string& folder : data_folders("presets")) {
    std::error_code error;
    for (fs::recursive_directory_iterator i(folder, error), end; !error && i != end; i.increment(error))
      if (i->path().extension() == ".json")
        out.push_back(fs::relative(i->path(), folder, error).replace_extension().generic_string());
  }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

std::string page_folder() {
  for (const char* name : {"build/playground", "apps/playground/dist", "playground"})
    for (const std::string& folder : data_folders(name)) {
      std::error_code error;
      if (fs::is_regular_file(fs::path(folder) / "index.html", error) &&
          !fs::exists(fs::path(folder) / "package.json", error))
        return folder;
    }
  return {};
}

std::vector<host::MenuScene> menu_scenes() {
  std::vector<host::MenuScene> out;
  for (const SceneFile& file : scene_files()) {
    const std::string id = "scene:" + file.name;
    const core::Result<scene::Scene> scene = scene::load_scene(file.path);
    if (!scene.ok()) continue;  // `carom list` says what is wrong with it
    const auto load = [path = file.path, id]() -> core::Result<std::unique_ptr<host::Demo>> {
      core::Result<scene::Scene> loaded = scene::load_scene(path);
      if (!loaded.ok()) return loaded.error();
      return host::make_scene_demo(std::move(loaded).value(), id);
    };
    const auto text = [path = file.path] {
      std::ifstream in(path, std::ios::binary);
      return std::string((std::istreambuf_iterator<char>(in)), {});
    };
    out.push_back({host::declaration_of(*scene, id), load, text});
  }
  return out;
}

core::Result<std::unique_ptr<host::Demo>> open_demo(const std::string& name) {
  if (std::unique_ptr<host::Demo> demo = host::make_demo(name)) return demo;
  std::string path;
  std::error_code error;
  if (fs::is_regular_file(name, error)) path = name;
  const std::string plain = name.rfind("scene:", 0) == 0 ? name.substr(6) : name;
  std::vector<std::string> known;
  for (const SceneFile& file : scene_files()) {
    known.push_back(file.name);
    if (path.empty() && (file.name == plain || file.name + ".json" == plain)) path = file.path;
  }
  if (!path.empty()) {
    core::Result<scene::Scene> scene = scene::load_scene(path);
    if (!scene.ok()) return scene.error();
    return host::make_scene_demo(std::move(scene).value(), fs::path(path).stem().string());
  }
  for (const host::DemoEntry& demo : host::demos()) known.emplace_back(demo.id);
  for (const std::unique_ptr<host::Demo>& demo : host::stress_demos()) known.push_back(demo->declaration().id);
  const std::string nearest = host::nearest_name(name, {known.begin(), known.end()});
  return core::Error{"no demo or scene file \"" + name + "\"" +
                     (nearest.empty() ? "; `carom list` names them all" : "; did you mean \"" + nearest + "\"?")};
}

core::Result<std::vector<double>> parse_settings(const host::Declaration& declaration,
                                                 const std::vector<std::string>& settings) {
  std::vector<double> values;
  std::vector<std::string_view> known;
  for (const host::Parameter& p : declaration.parameters) {
    values.push_back(p.value);
    known.push_back(p.name);
  }
  for (const std::string& setting : settings) {
    const std::size_t equals = setting.find('=');
    if (equals == std::string::npos)
      return core::Error{"--set " + setting + ": expected name=value, such as --set \"speed=30 mph\""};
    const std::string name = setting.substr(0, equals), text = setting.substr(equals + 1);
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      const std::string nearest = host::nearest_name(name, known);
      return core::Error{
          "--set " + setting + ": " + declaration.id + " has no parameter \"" + name + "\"" +
          (nearest.empty() ? "; `carom list --json` names them" : "; did you mean \"" + nearest + "\"?")};
    }
    const std::size_t i = std::size_t(found - known.begin());
    const host::Parameter& p = declaration.parameters[i];
    if (const auto named = std::find(p.choices.begin(), p.choices.end(), text); named != p.choices.end()) {
      values[i] = p.minimum + double(named - p.choices.begin());
      continue;
    }
    const math::QuantityResult unit = math::parse_quantity(p.unit.empty() ? "1" : "1 " + p.unit);
    const math::QuantityResult any = math::parse_quantity(text);
    // A bare number is taken in SI; with a unit its dimension must fit.
    const bool bare = any.ok && text.find_first_not_of("0123456789.eE+- ") == std::string::npos;
    const math::QuantityResult value = bare || !unit.ok ? any : math::parse_quantity(text, unit.dimension);
    if (!value.ok || (!p.choices.empty() && !(value.si >= p.minimum && value.si <= p.maximum))) {
      std::string message = "--set " + setting + ": ";
      if (p.choices.empty()) return core::Error{message + value.error};
      message += "expected one of";
      for (const std::string& choice : p.choices)
        message += (&choice == p.choices.data() ? " \"" : ", \"") + choice + "\"";
      return core::Error{message};
    }
    if (!(value.si >= p.minimum && value.si <= p.maximum)) {
      // In the unit that the demo shows.
      const std::string& shown = p.display_unit.empty() ? p.unit : p.display_unit;
      const math::QuantityResult zero = math::parse_quantity("0 " + shown), one = math::parse_quantity("1 " + shown);
      const bool known_unit = zero.ok && one.ok && one.si != zero.si;
      const auto in_unit = [&](double si) { return known_unit ? (si - zero.si) / (one.si - zero.si) : si; };
      char range[160];
      std::snprintf(range, sizeof range, ": found %g, expected %g to %g %s", in_unit(value.si), in_unit(p.minimum),
                    in_unit(p.maximum), (known_unit ? shown : p.unit).c_str());
      return core::Error{"--set " + setting + range};
    }
    values[i] = value.si;
  }
  return values;
}

}  // namespace carom::command
