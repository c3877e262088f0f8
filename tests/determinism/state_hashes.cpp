// Prints the state hashes of scenes that every build of Carom must agree on: compilers, SIMD widths, thread counts and
// WebAssembly (tools/check_determinism.sh compares the printed lines).
//   state_hashes [--threads N] [--width 4|8|16] [--demos] [--scenes] [--models] [--demo-steps 300|600]
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "apps/host/registry.h"
#include "apps/host/simulation.h"
#include "benchmarks/measure.h"
#include "tests/determinism/models.h"

namespace {

void print_models(int width) {
  using namespace carom::determinism;
  particle_models(width);
  ballistics_models(width);
  gun_models();
  billiards_models(width);
  environment_models(width);
  blast_models(width);
  sports_models();
  rope_models(width);
  fluid_models(width);
}

/// A line of each demo after every 300 steps.
bool print_demos(int threads, int steps) {
  carom::host::SimulationOptions options;
  options.threads = threads;
  for (const carom::host::DemoEntry& entry : carom::host::demos()) {
    auto demo = entry.make();
    carom::host::Demo& opener = *demo;
    auto opened = opener.open(std::move(demo), {}, options);
    if (!opened) {
      std::fprintf(stderr, "state_hashes: %s\n", opened.error().message.c_str());
      return false;
    }
    carom::host::Simulation& simulation = **opened;
    for (int step = 1; step <= steps; ++step) {
      if (const auto status = simulation.step(); !status) {
        std::fprintf(stderr, "state_hashes: %s\n", status.error().message.c_str());
        return false;
      }
      if (step % 300 == 0)
        std::printf("demo %s %d %016llx\n", simulation.declaration().id.c_str(), step,
                    static_cast<unsigned long long>(simulation.state_hash()));
    }
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

}  // namespace

int main(int argc, char** argv) {
  int threads = 1, width = 0, demo_steps = 600;
  bool demos = false, scenes = false, models = false;
  for (int i = 1; i < argc; ++i) {
    if (!std::strcmp(argv[i], "--threads") && i + 1 < argc)
      threads = std::atoi(argv[++i]);
    else if (!std::strcmp(argv[i], "--width") && i + 1 < argc)
      width = std::atoi(argv[++i]);
    else if (!std::strcmp(argv[i], "--demo-steps") && i + 1 < argc)
      demo_steps = std::atoi(argv[++i]);
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
  if ((all || demos) && !print_demos(threads, demo_steps)) return 1;
  if (all || models) print_models(width);
  if (all || scenes) print_scenes(threads, width);
}
