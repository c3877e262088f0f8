// Times the benchmark scenes in Carom and in the peers found at build time, engine by engine in turn, several rounds;
// prints the mean over steps of each step's minimum over the rounds (the simulations are deterministic, so the minimum
// removes what other programs did meanwhile), the worst step, and what the run looks like at its end.
//   bench_scenes [--rounds N] [--steps N] [--only SCENE] [--engine NAME] [--threads N] [--markdown]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "benchmarks/engine.h"
#include "benchmarks/measure.h"

using namespace carom::bench;

namespace {

struct Entry {
  const char* name;
  Runner run;
  RecipeSettings settings;
};

void merge(RecipeOutcome& best, RecipeOutcome&& next) {
  if (best.step_ms.empty()) {
    best = std::move(next);
    return;
  }
  for (std::size_t i = 0; i < best.step_ms.size(); ++i) best.step_ms[i] = std::min(best.step_ms[i], next.step_ms[i]);
}

}  // namespace

int main(int argc, char** argv) {
  int rounds = 3, steps = 0, threads = 0, width = 0;
  const char *only = nullptr, *engine = nullptr;
  for (int i = 1; i < argc; ++i) {
    const auto value = [&]() -> const char* {
      if (i + 1 < argc) return argv[++i];
      std::fprintf(stderr, "bench_scenes: %s needs a value\n", argv[i]);
      std::exit(2);
    };
    if (!std::strcmp(argv[i], "--rounds"))
      rounds = std::atoi(value());
    else if (!std::strcmp(argv[i], "--steps"))
      steps = std::atoi(value());
    else if (!std::strcmp(argv[i], "--only"))
      only = value();
    else if (!std::strcmp(argv[i], "--engine"))
      engine = value();
    else if (!std::strcmp(argv[i], "--threads"))
      threads = std::atoi(value());
    else if (!std::strcmp(argv[i], "--width"))
      width = std::atoi(value());
    else {
      std::fprintf(stderr, "bench_scenes: unknown option %s\n", argv[i]);
      return 2;
    }
  }
  if (rounds < 1) rounds = 1;

  std::printf(
      "| scene | engine | ms/step | worst | ratio | drift m | rms m/s | penetration m | joint gap m | escaped |\n");
  std::printf("|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& name : recipe_names()) {
    if (only && name != only) continue;
    const Recipe recipe = make_recipe(name);
    std::vector<Entry> engines;
    const auto add = [&](const char* label, Runner run, int engine_threads) {
      if (engine && std::strcmp(engine, label) != 0 && std::strstr(label, engine) == nullptr) return;
      if (threads > 0 && engine_threads != threads) return;
      RecipeSettings settings;
      settings.threads = engine_threads;
      settings.steps = steps;
      settings.simd_width = width;
      engines.push_back({label, run, settings});
    };
    add("carom", run_carom, 1);
    add("carom 2 threads", run_carom, 2);
#ifdef CAROM_WITH_BULLET
    if (recipe.dimension == 3)
      add("bullet", [](const Recipe& r, const RecipeSettings& s) { return run_recipe(make_bullet, r, s); }, 1);
#endif
#ifdef CAROM_WITH_BOX2D
    if (recipe.dimension == 2)
      add("box2d 2.4", [](const Recipe& r, const RecipeSettings& s) { return run_recipe(make_box2d_2, r, s); }, 1);
#endif
    std::vector<RecipeOutcome> best(engines.size());
    for (int round = 0; round < rounds; ++round)
      for (std::size_t e = 0; e < engines.size(); ++e) merge(best[e], engines[e].run(recipe, engines[e].settings));
    for (std::size_t e = 0; e < engines.size(); ++e) {
      const RecipeOutcome& o = best[e];
      std::printf("| %s | %s | %.3f | %.2f | %.2f | %.4f | %.4f | %.5f | %.5f | %d |\n", name.c_str(), engines[e].name,
                  mean_after_first(o.step_ms), *std::max_element(o.step_ms.begin(), o.step_ms.end()),
                  mean_after_first(o.step_ms) / mean_after_first(best[0].step_ms), o.worst_drift, o.rms_speed,
                  o.worst_penetration, o.worst_joint_gap, o.escaped);
      std::fflush(stdout);
    }
  }
}
