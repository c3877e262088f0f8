#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/command/command.h"
#include "benchmarks/recipe.h"

namespace carom::command {

int bench(const BenchOptions& options) {
  const std::vector<std::string> known = carom::bench::recipe_names();
  std::vector<std::string> names = options.scenes.empty() ? known : options.scenes;
  for (const std::string& name : names) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    const std::string nearest = host::nearest_name(name, {known.begin(), known.end()});
    return fail(exit_usage,
                "no benchmark scene \"" + name + "\"" + (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
  }
  watch_for_interrupts();
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  if (!options.json)
    std::printf("%-18s %7s %6s %10s %10s %10s %12s %12s  %s\n", "scene", "bodies", "steps", "total s", "median ms",
                "worst ms", "penetr. mm", "drift mm", "state hash");
  Progress progress("bench", !options.json);
  int done = 0;
  for (const std::string& name : names) {
    const carom::bench::Recipe recipe = carom::bench::make_recipe(name);
    carom::bench::Settings settings;
    settings.threads = options.threads;
    settings.steps = options.steps;
    carom::bench::Outcome best;
    double best_total = 0;
    for (int i = 0; i < options.repeats && !interrupted; ++i) {
      const carom::bench::Outcome outcome = carom::bench::run_carom(recipe, settings);
      double total = 0;
      for (const double ms : outcome.step_ms) total += ms;
      if (i == 0 || total < best_total) {
        best = outcome;
        best_total = total;
      }
      progress.update((done + double(i + 1) / options.repeats) / double(names.size()));
    }
    ++done;
    if (interrupted || best.step_ms.empty()) break;
    std::vector<double> sorted = best.step_ms;
    std::sort(sorted.begin(), sorted.end());
    char hash[20];
    std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(best.hash));
    if (options.json)
      out.push_back({{"scene", name},
                     {"bodies", recipe.bodies.size()},
                     {"steps", sorted.size()},
                     {"threads", options.threads},
                     {"total_s", best_total / 1e3},
                     {"median_ms", sorted[sorted.size() / 2]},
                     {"worst_ms", sorted.back()},
                     {"worst_penetration_m", best.worst_penetration},
                     {"worst_drift_m", best.worst_drift},
                     {"state_hash", hash}});
    else
      std::printf("%-18s %7zu %6zu %10.3f %10.3f %10.3f %12.3f %12.3f  %s\n", name.c_str(), recipe.bodies.size(),
                  sorted.size(), best_total / 1e3, sorted[sorted.size() / 2], sorted.back(),
                  1e3 * best.worst_penetration, 1e3 * best.worst_drift, hash);
    std::fflush(stdout);
  }
  if (options.json) std::printf("%s\n", out.dump(2).c_str());
  return interrupted ? exit_interrupted : exit_ok;
}

}  // namespace carom::command
