#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "apps/command/command.h"
#include "benchmarks/measure.h"

namespace carom::command {
namespace {
using carom::bench::Outcome;
using carom::bench::SceneInfo;

/// One scene on one number of threads.
struct Row {
  const SceneInfo* scene;
  int threads;
  Outcome best;
};

std::string hexadecimal(std::uint64_t hash) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}
double bytes_per_body(const Outcome& o) { return double(o.peak_bytes) / std::max(1, o.counters.bodies); }
/// Without the first step, as the peers measure.
double worst_ms(const Outcome& o) {
  return *std::max_element(o.step_ms.begin() + (o.step_ms.size() > 1 ? 1 : 0), o.step_ms.end());
}

core::Result<std::vector<const SceneInfo*>> choose(const BenchOptions& options) {
  if (options.scenes.empty()) return carom::bench::find_scenes(options.suite.empty() ? "common" : options.suite);
  std::vector<const SceneInfo*> chosen;
  for (const std::string& name : options.scenes) {
    std::vector<const SceneInfo*> found = carom::bench::find_scenes(name);
    if (!options.suite.empty() && options.suite != "all")
      std::erase_if(found, [&](const SceneInfo* s) { return s->suite != options.suite; });
    if (found.empty()) {
      std::vector<std::string> known;
      for (const SceneInfo& s : carom::bench::all_scenes())
        known.push_back(name.find('/') == std::string::npos ? s.name : s.path());
      const std::string nearest = host::nearest_name(name, {known.begin(), known.end()});
      return core::Error{
          "no benchmark scene \"" + name + "\"" + (options.suite.empty() ? "" : " in the suite " + options.suite) +
          (nearest.empty() ? "; `carom bench --list` shows them" : "; did you mean \"" + nearest + "\"?")};
    }
    for (const SceneInfo* s : found)
      if (std::find(chosen.begin(), chosen.end(), s) == chosen.end()) chosen.push_back(s);
  }
  return chosen;
}

void list_scenes(bool json) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  if (!json) std::printf("%-26s %3s %6s  %s\n", "scene", "dim", "steps", "note");
  for (const SceneInfo& s : carom::bench::all_scenes()) {
    const char* note = s.missing == nullptr ? "" : s.missing;
    if (json)
      out.push_back({{"scene", s.path()}, {"dimension", s.dimension()}, {"steps", s.steps}, {"note", note}});
    else
      std::printf("%-26s %3d %6d  %s\n", s.path().c_str(), s.dimension(), s.steps, note);
  }
  if (json) std::printf("%s\n", out.dump(2).c_str());
}

void print_times_heading() {
  std::printf("%-24s %3s %9s %8s | %8s %8s %8s %8s %8s %7s %7s | %s\n", "scene", "thr", "ms/step", "worst", "pairs",
              "narrow", "prepare", "solve", "finalize", "ccd", "sleep", "state hash");
}
void print_times(const Row& row) {
  const rigid::StepProfile p = carom::bench::mean_stages(row.best);
  std::printf("%-24s %3d %9.3f %8.2f | %8.3f %8.3f %8.3f %8.3f %8.3f %7.3f %7.3f | %s\n", row.scene->path().c_str(),
              row.threads, carom::bench::mean_after_first(row.best.step_ms), worst_ms(row.best), p.broad_phase,
              p.narrow_phase, p.prepare, p.solve + p.restitution, p.finalize + p.effectors, p.continuous + p.sensors,
              p.sleep, hexadecimal(row.best.hash).c_str());
}
void print_counts(const std::vector<Row>& rows) {
  std::printf("\n%-24s %7s %7s %8s %8s %7s %6s | %8s %8s %8s %8s | %7s %8s %8s %7s\n", "scene", "bodies", "awake",
              "contacts", "touching", "joints", "over", "world MB", "B/body", "peak MB", "make ms", "pen. mm", "gap mm",
              "rms m/s", "escaped");
  std::set<const SceneInfo*> shown;
  for (const Row& row : rows) {
    const Outcome& o = row.best;
    if (!shown.insert(row.scene).second) continue;
    std::printf("%-24s %7d %7.0f %8.0f %8.0f %7d %6d | %8.1f %8.0f %8.1f %8.0f | %7.2f %8.2f %8.3f %7d\n",
                row.scene->path().c_str(), o.counters.bodies, o.mean_awake, o.mean_contacts, o.mean_touching,
                o.counters.joints, o.counters.overflow_constraints, double(o.peak_bytes) * 1e-6, bytes_per_body(o),
                double(o.peak_resident) * 1e-6, o.create_ms, 1e3 * o.worst_penetration, 1e3 * o.worst_joint_gap,
                o.rms_speed, o.escaped);
  }
  std::printf(
      "ms: mean over the steps after the first of each step's fastest round. awake, contacts, touching: means over the "
      "run; over: constraints without a colour, solved serially;\nB/body: the world's largest size by its bodies; "
      "peak: "
      "what the process grew by; pen., gap, rms: worst penetration and joint gap, and speed, at the end.\n");
}

nlohmann::ordered_json to_json(const Row& row, bool series) {
  const Outcome& o = row.best;
  const rigid::StepProfile p = carom::bench::mean_stages(o);
  nlohmann::ordered_json j{{"scene", row.scene->path()},
                           {"engine", "carom"},
                           {"threads", row.threads},
                           {"steps", o.step_ms.size()},
                           {"ms", carom::bench::mean_after_first(o.step_ms)},
                           {"worst_ms", worst_ms(o)},
                           {"first_ms", o.step_ms.front()},
                           {"create_ms", o.create_ms},
                           {"action_ms", o.action_ms},
                           {"stages_ms",
                            {{"effectors", p.effectors},
                             {"broad_phase", p.broad_phase},
                             {"narrow_phase", p.narrow_phase},
                             {"prepare", p.prepare},
                             {"solve", p.solve},
                             {"restitution", p.restitution},
                             {"finalize", p.finalize},
                             {"continuous", p.continuous},
                             {"sensors", p.sensors},
                             {"sleep", p.sleep}}},
                           {"bodies", o.counters.bodies},
                           {"joints", o.counters.joints},
                           {"mean_awake", o.mean_awake},
                           {"mean_contacts", o.mean_contacts},
                           {"mean_touching", o.mean_touching},
                           {"contacts", o.counters.contacts},
                           {"touching", o.counters.touching_contacts},
                           {"colors", o.counters.colors},
                           {"overflow", o.counters.overflow_constraints},
                           {"world_bytes", o.peak_bytes},
                           {"resident_bytes", o.peak_resident},
                           {"bytes_per_body", bytes_per_body(o)},
                           {"worst_drift_m", o.worst_drift},
                           {"worst_penetration_m", o.worst_penetration},
                           {"worst_joint_gap_m", o.worst_joint_gap},
                           {"rms_speed", o.rms_speed},
                           {"escaped", o.escaped},
                           {"state_hash", hexadecimal(o.hash)}};
  if (row.scene->missing != nullptr) j["note"] = row.scene->missing;
  if (series) j["step_ms"] = o.step_ms;
  return j;
}

}  // namespace

int bench(const BenchOptions& options) {
  if (!options.plot.empty()) return plot_benchmarks(options.from, options.plot);
  if (options.list) return list_scenes(options.json), exit_ok;
  const auto chosen = choose(options);
  if (!chosen) return fail(exit_usage, chosen.error().message);
  watch_for_interrupts();
  if (!options.json) print_times_heading();
  Progress progress("bench", !options.json);
  std::vector<Row> done;
  double finished = 0;
  const double whole = double(chosen->size() * options.threads.size()) * options.rounds;
  for (const SceneInfo* scene : *chosen) {
    if (scene->make2 == nullptr && scene->make3 == nullptr) {
      if (!options.json) std::printf("%-24s not there: %s\n", scene->path().c_str(), scene->missing);
      continue;
    }
    std::vector<Row> rows;
    for (const int threads : options.threads) rows.push_back({scene, threads, {}});
    // Thread counts take turns, so that what else the machine does falls on all of them.
    for (int round = 0; round < options.rounds && !interrupted; ++round)
      for (Row& row : rows) {
        if (interrupted) break;
        carom::bench::Settings settings;
        settings.threads = row.threads;
        settings.steps = options.steps;
        settings.simd_width = options.width;
        Outcome next = carom::bench::run_scene(*scene, settings);
        if (!row.best.steps.empty() && next.hash != row.best.hash)
          return fail(exit_failed_expectation, scene->path() + ": two rounds ended in different states");
        carom::bench::take_minima(row.best, std::move(next));
        progress.update(++finished / whole);
      }
    for (Row& row : rows) {
      if (row.best.steps.empty()) continue;
      if (!options.json) print_times(row);
      std::fflush(stdout);
      if (row.best.hash != rows.front().best.hash)
        return fail(exit_failed_expectation, scene->path() + ": the state depends on the number of threads");
      done.push_back(std::move(row));
    }
    if (interrupted) break;
  }
  if (options.json) {
    nlohmann::ordered_json out = nlohmann::ordered_json::array();
    for (const Row& row : done) out.push_back(to_json(row, options.series));
    std::printf("%s\n", out.dump(2).c_str());
  } else if (!done.empty()) {
    print_counts(done);
  }
  return interrupted ? exit_interrupted : exit_ok;
}

}  // namespace carom::command
