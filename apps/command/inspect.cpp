// `carom list` and `carom doctor`: what is there to run, and what this machine and build can do.
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <thread>

#include "apps/command/command.h"
#include "apps/host/messages.h"
#include "apps/host/registry.h"
#include "apps/host/scene_demo.h"
#include "apps/host/stress_demo.h"
#include "carom/math/cpu.h"
#include "carom/scene/scene.h"

namespace carom::command {

using Json = nlohmann::ordered_json;

int list(bool json) {
  Json demos = Json::array(), scenes = Json::array(), presets = Json::array();
  if (!json) std::printf("Demos (carom run NAME)\n");
  for (const host::DemoEntry& demo : host::demos()) {
    const host::Declaration d = demo.make()->declaration();
    demos.push_back(Json::parse(host::declaration_json(d, -1)));
    if (!json) std::printf("  %-20s %dD  %s\n", d.id.c_str(), d.dimension, d.summary.c_str());
  }
  Json stress = Json::array();
  if (!json) std::printf("\nBenchmark scenes as demos (carom run NAME)\n");
  for (const std::unique_ptr<host::Demo>& demo : host::stress_demos()) {
    const host::Declaration d = demo->declaration();
    stress.push_back(Json::parse(host::declaration_json(d, -1)));
    if (!json) std::printf("  %-28s %dD  %s\n", d.id.c_str(), d.dimension, d.summary.c_str());
  }
  bool broken = false;
  const std::vector<SceneFile> files = scene_files();
  if (!json && !files.empty()) std::printf("\nScenes (carom run NAME or FILE)\n");
  for (const SceneFile& file : files) {
    const core::Result<scene::Scene> scene = scene::load_scene(file.path);
    if (!scene.ok()) {
      broken = true;
      scenes.push_back({{"name", file.name}, {"file", file.path}, {"error", scene.error().message}});
      if (!json) std::printf("  %-28s    %s\n", file.name.c_str(), scene.error().message.c_str());
      continue;
    }
    const host::Declaration d = host::declaration_of(*scene, file.name);
    Json entry = Json::parse(host::declaration_json(d, -1));
    entry["file"] = file.path;
    scenes.push_back(entry);
    if (!json) std::printf("  %-28s %dD  %s\n", file.name.c_str(), d.dimension, d.summary.substr(0, 100).c_str());
  }
  const std::vector<std::string> names = preset_names();
  if (!json && !names.empty()) std::printf("\nPresets (\"preset\": NAME in a scene)\n");
  for (const std::string& name : names) {
    presets.push_back(name);
    if (!json) std::printf("  %s\n", name.c_str());
  }
  if (json)
    std::printf("%s\n",
                Json({{"demos", demos}, {"stress", stress}, {"scenes", scenes}, {"presets", presets}}).dump(2).c_str());
  return broken ? exit_input : exit_ok;
}

namespace {

struct Finding {
  const char* name;
  std::string value;
  bool good = true;
  std::string advice;
};

bool port_free(int port) {
  const int socket_handle = ::socket(AF_INET, SOCK_STREAM, 0);
  if (socket_handle < 0) return false;
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<unsigned short>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int on = 1;
  setsockopt(socket_handle, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  const bool free = ::bind(socket_handle, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  ::close(socket_handle);
  return free;
}

/// The engine itself: a box dropped on a floor must come to rest on it.
Finding engine_works() {
  rigid::World3 world;
  rigid::BodyDef<rigid::Dim3> floor, box;
  floor.type = rigid::BodyType::fixed;
  box.position = {0, 1, 0};
  const auto a = world.create_body(floor), b = world.create_body(box);
  if (!a.ok() || !b.ok() || !world.add_shape(*a, geometry::Plane{}).ok() || !world.add_shape(*b, geometry::Box{}).ok())
    return {"engine", "cannot make a world", false, "build again; run ./check"};
  for (int i = 0; i < 120; ++i)
    if (!world.step(1.0f / 60).ok()) return {"engine", "a step failed", false, "build again; run ./check"};
  const auto state = world.state(*b);
  const double y = state.ok() ? state->pose.position.y : 0;
  const bool good = y > 0.48 && y < 0.51;
  char text[80];
  std::snprintf(text, sizeof text, "a dropped box rests at %.4f m", y);
  return {"engine", text, good, "expected 0.5 m; run ./check"};
}

std::string compiler() {
#if defined(__clang__)
  return "clang " __clang_version__;
#elif defined(__GNUC__)
  return "gcc " __VERSION__;
#else
  return "unknown";
#endif
}

}  // namespace

int doctor(bool json) {
  const math::InstructionSet set = math::detect_instruction_set();
  std::vector<Finding> findings;
  findings.push_back({"version", CAROM_VERSION_STRING});
  findings.push_back({"compiler", compiler()});
#if defined(NDEBUG)
  findings.push_back({"build", "optimised"});
#else
  findings.push_back({"build", "with assertions", false, "configure with -DCMAKE_BUILD_TYPE=Release for speed"});
#endif
  findings.push_back(
      {"instruction set", std::string(math::to_string(set)) + ", " + std::to_string(math::simd_width(set)) + " lanes"});
  findings.push_back({"processors", std::to_string(std::thread::hardware_concurrency())});
  findings.push_back({"mesh files", CAROM_WITH_GLTF ? "OBJ, STL, glTF, GLB" : "OBJ, STL", CAROM_WITH_GLTF != 0,
                      "configure with -DCAROM_MESH_FILES=ON for glTF"});
  findings.push_back(
      {"server", CAROM_WITH_SERVER ? "yes" : "no", CAROM_WITH_SERVER, "install libboost-dev and build again"});
  const std::string page = page_folder();
  findings.push_back({"page", page.empty() ? "not built" : page, !page.empty(),
                      "run ./play, or npm ci && npm run build in apps/playground"});
  const std::vector<SceneFile> scenes = scene_files();
  findings.push_back(
      {"scenes", std::to_string(scenes.size()), !scenes.empty(), "run carom in the repository's folder"});
  int port = 8080;
  while (port < 8100 && !port_free(port)) ++port;
  findings.push_back({"free port", std::to_string(port), port < 8100, "give `carom serve` another --port"});
  findings.push_back(engine_works());
  bool good = true;
  Json out = Json::object();
  for (const Finding& f : findings) {
    good = good && (f.good || std::string_view(f.name) != "engine");
    out[f.name] = {{"value", f.value}, {"ok", f.good}};
    if (!f.good) out[f.name]["advice"] = f.advice;
    if (!json)
      std::printf("%s %-16s %s%s%s\n", f.good ? "ok  " : "note", f.name, f.value.c_str(), f.good ? "" : "   → ",
                  f.good ? "" : f.advice.c_str());
  }
  if (json) std::printf("%s\n", out.dump(2).c_str());
  return good ? exit_ok : exit_failed_expectation;
}

}  // namespace carom::command
