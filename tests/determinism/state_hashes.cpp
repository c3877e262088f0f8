// Prints the state hashes of scenes that every build of Carom must agree on: compilers, SIMD widths, thread counts and
// WebAssembly (tools/check_determinism.sh compares the printed lines).
//   state_hashes [--threads N] [--width 4|8|16] [--demos] [--scenes] [--models]
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "apps/host/registry.h"
#include "apps/host/simulation.h"
#include "benchmarks/measure.h"
#include "carom/ballistics/aim.h"
#include "carom/ballistics/batch.h"
#include "carom/ballistics/shell.h"
#include "carom/core/hash.h"

namespace {

bool print_demos(int threads) {
  carom::host::SimulationOptions options;
  options.threads = threads;
  for (const carom::host::DemoFactory make : carom::host::demos()) {
    auto demo = make();
    carom::host::Demo& opener = *demo;
    auto opened = opener.open(std::move(demo), {}, options);
    if (!opened) {
      std::fprintf(stderr, "state_hashes: %s\n", opened.error().message.c_str());
      return false;
    }
    carom::host::Simulation& simulation = **opened;
    for (int step = 0; step < 600; ++step)
      if (const auto status = simulation.step(); !status) {
        std::fprintf(stderr, "state_hashes: %s\n", status.error().message.c_str());
        return false;
      }
    std::printf("demo %s 600 %016llx\n", simulation.declaration().id.c_str(),
                static_cast<unsigned long long>(simulation.state_hash()));
  }
  return true;
}

void print_scenes(int threads, int width) {
  for (const carom::bench::SceneInfo& scene : carom::bench::all_scenes()) {
    if (scene.hash_steps == 0) continue;
    carom::bench::Settings settings;
    settings.threads = threads;
    settings.simd_width = width;
    settings.steps = scene.hash_steps;
    const carom::bench::Outcome outcome = carom::bench::run_scene(scene, settings);
    std::printf("scene %s %d %016llx\n", scene.path().c_str(), scene.hash_steps,
                static_cast<unsigned long long>(outcome.hash));
  }
}

/// Models that no scene runs yet.
void print_models(int width) {
  using namespace carom;
  using math::Vec3d;
  const auto print = [](const char* name, std::uint64_t hash) {
    std::printf("model %s %016llx\n", name, static_cast<unsigned long long>(hash));
  };
  const ballistics::Conditions air{.wind = environment::WindColumn(environment::Wind{
                                       .velocity = {5, 0, 3}, .profile = environment::WindProfile::power}),
                                   .gravity_model = ballistics::GravityModel::round_earth,
                                   .rotation = ballistics::earth_rotation_rate(0.8, 1.1)};
  ballistics::ProjectileBatch batch(ballistics::DragCurve(ballistics::DragFunction::g1), air, {}, width);
  for (int i = 0; i < 100; ++i)
    batch.add({{0, 100.0 + i, 0}, (200.0 + 7 * i) * ballistics::direction(0.01 * i, i)}, 1e-3);
  for (int i = 0; i < 120; ++i) batch.step(1.0 / 60);
  core::StateHash hash;
  for (int k = 0; k < 6; ++k)
    for (const float x : batch.array(k)) hash.add(x);
  print("projectile_batch", hash.digest());

  hash = {};
  const auto hash_vector = [&](Vec3d v) { hash.add(v.x).add(v.y).add(v.z); };
  const auto shell = ballistics::fly_shell(ballistics::m107(), air, {{}, 474.0 * ballistics::direction(0.5)},
                                           ballistics::ShellModel::six_degrees, {.time = 10, .tolerance = 1e-7});
  for (const ballistics::Trajectory::Node& node : shell->path.nodes())
    hash_vector(node.position), hash_vector(node.velocity);
  const auto aims = ballistics::aim(ballistics::projectile_from_coefficient(ballistics::DragFunction::g7, 0.3), air,
                                    {.muzzle_speed = 500}, ballistics::Target{{600, 20, 100}, {10, 0, -30}});
  for (const ballistics::Shot& shot : {*aims->low, *aims->high}) hash_vector(shot.direction), hash.add(shot.time);
  print("shell_and_aim", hash.digest());
}

}  // namespace

int main(int argc, char** argv) {
  int threads = 1, width = 0;
  bool demos = false, scenes = false, models = false;
  for (int i = 1; i < argc; ++i) {
    if (!std::strcmp(argv[i], "--threads") && i + 1 < argc)
      threads = std::atoi(argv[++i]);
    else if (!std::strcmp(argv[i], "--width") && i + 1 < argc)
      width = std::atoi(argv[++i]);
    else if (!std::strcmp(argv[i], "--demos"))
      demos = true;
    else if (!std::strcmp(argv[i], "--scenes"))
      scenes = true;
    else if (!std::strcmp(argv[i], "--models"))
      models = true;
    else {
      std::fprintf(stderr, "state_hashes: unknown option %s\n", argv[i]);
      return 2;
    }
  }
  const bool all = !demos && !scenes && !models;
  if ((all || demos) && !print_demos(threads)) return 1;
  if (all || models) print_models(width);
  if (all || scenes) print_scenes(threads, width);
}
