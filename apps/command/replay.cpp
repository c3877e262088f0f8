// `carom replay`: a recording run again from what opened it, and compared step by step.
#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "apps/command/command.h"
#include "apps/host/replay.h"

namespace carom::command {

int replay(const ReplayOptions& options) {
  core::Result<scene::Recording> opened = scene::Recording::open(options.recording);
  if (!opened.ok()) return fail(exit_input, opened.error().message);
  const auto recording = std::make_shared<scene::Recording>(std::move(opened).value());
  if (!recording->complete() && !options.quiet)
    std::fprintf(stderr, "carom: %s is not whole: %s\n", options.recording.c_str(), recording->damage().c_str());
  core::Result<host::Replay> made = host::Replay::open(recording, {options.threads});
  if (!made.ok()) return fail(exit_input, options.recording + ": " + made.error().message);
  host::Replay& again = *made;
  const host::ReplayReport& report = again.report();
  watch_for_interrupts();
  Progress progress("running again", !options.quiet);
  while (!report.done && !interrupted) {
    if (const core::Status status = again.advance(50); !status.ok())
      return fail(exit_input, options.recording + ": " + status.error().message);
    progress.update(double(report.step) / double(std::max<std::uint64_t>(report.last, 1)));
  }
  if (options.json) {
    nlohmann::json out = {{"equal", report.equal()}, {"first", report.first},
                          {"last", report.last},     {"step", report.step},
                          {"frames", report.frames}, {"hashes", report.hashes},
                          {"text", report.text()},   {"recorded_by", report.recorded_by},
                          {"run_by", report.run_by}};
    if (report.difference) {
      out["differs"] = report.difference->step;
      out["same_until"] = report.difference->after;
    }
    std::printf("%s\n", out.dump(2, ' ', false, nlohmann::json::error_handler_t::replace).c_str());
  } else if (!options.quiet) {
    std::printf("%s\n", report.text().c_str());
  }
  if (interrupted) return exit_interrupted;
  return report.equal() ? exit_ok : exit_failed_expectation;
}

}  // namespace carom::command
