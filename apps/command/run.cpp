#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <optional>

#include "apps/command/canvas.h"
#include "apps/command/chart.h"
#include "apps/command/command.h"
#include "apps/command/picture.h"
#include "apps/command/report.h"
#include "apps/host/messages.h"
#include "apps/host/run_recorder.h"
#include "carom/core/profiler.h"
#include "carom/scene/recording.h"

namespace carom::command {

namespace fs = std::filesystem;

namespace {

/// A name that is one harmless folder.
std::string folder_name(const std::string& id) {
  std::string out;
  for (const char c : id)
    out.push_back((c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
                          c == '_'
                      ? c
                      : '-');
  return out.empty() || out.front() == '.' ? "scene" : out;
}

std::string plot_name(const host::Plot& plot, std::size_t index) {
  std::string title = folder_name(plot.title);
  for (char& c : title)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return "plot-" + std::to_string(index + 1) + "-" + title;
}

class Runner {
 public:
  Runner(const RunOptions& options, std::unique_ptr<host::Simulation> simulation, core::Profiler* profiler)
      : options_(options), simulation_(std::move(simulation)), profiler_(profiler), out_(options.out) {
    const host::Declaration& d = simulation_->declaration();
    if (out_.empty()) out_ = "out/" + folder_name(d.id);
    report_.scene = d.id;
    report_.title = d.title;
    report_.dimension = d.dimension;
    report_.dt = d.dt;
    report_.threads = options.threads;
  }

  int run(bool check) {
    std::error_code error;
    fs::create_directories(out_, error);
    if (error) return fail(exit_system, out_ + ": cannot make the folder: " + error.message());
    if (options_.record)
      if (const core::Status status = open_recording(); !status.ok()) return fail(exit_system, status.error().message);
    if (options_.pictures) picture("start.png");
    steps();
    finish(check);
    if (const core::Status status = write_files(); !status.ok()) return fail(exit_system, status.error().message);
    if (options_.json)
      std::fputs(report_json(report_).c_str(), stdout);
    else if (!options_.quiet)
      std::fputs(report_text(report_).c_str(), stdout);
    if (!report_.stopped.empty()) return fail(exit_stopped, "the simulation stopped: " + report_.stopped);
    if (report_.interrupted) return exit_interrupted;
    return report_.passed() ? exit_ok : exit_failed_expectation;
  }

 private:
  std::string path(const std::string& name) const { return (fs::path(out_) / name).string(); }

  core::Status open_recording() {
    const host::Declaration& d = simulation_->declaration();
    core::Result<scene::Recorder> opened =
        scene::Recorder::open(temporary_name(path("recording.carom-rec")),
                              host::recording_header(*simulation_, {simulation_->values(), {}, true}));
    if (!opened.ok()) return opened.error();
    recorder_.emplace(std::move(opened).value(), *simulation_);
    // Sixty frames a second are enough to look at, however short the steps.
    record_every_ = std::max(1, int(std::lround(1.0 / 60 / d.dt)));
    return record(true);
  }

  core::Status record(bool always) {
    const std::uint64_t step = simulation_->step_count();
    if (!recorder_ || (!always && step % std::uint64_t(record_every_) != 0)) return {};
    last_recorded_ = step;
    const core::Status status = recorder_->add(*simulation_, waiting_);
    waiting_.clear();
    return status;
  }

  void take_samples() {
    std::vector<host::Sample>& fresh = simulation_->base().state.samples;
    samples_.insert(samples_.end(), fresh.begin(), fresh.end());
    if (recorder_) waiting_.insert(waiting_.end(), fresh.begin(), fresh.end());
    fresh.clear();
  }

  void steps() {
    const host::Declaration& d = simulation_->declaration();
    const double duration = options_.duration > 0 ? options_.duration : d.duration;
    const std::uint64_t total =
        options_.steps > 0 ? std::uint64_t(options_.steps) : std::uint64_t(std::ceil(duration / d.dt - 1e-9));
    Progress progress(d.title, !options_.quiet);
    std::vector<double> times;
    times.reserve(std::size_t(std::min<std::uint64_t>(total, 1 << 24)));
    report_.start = simulation_->budget();
    report_.advice = advice_for(*simulation_);
    const double started = now_seconds();
    double stepping = 0;
    take_samples();
    for (std::uint64_t i = 0; i < total && !interrupted; ++i) {
      const double before = now_seconds();
      core::Status status;
      {
        const core::ProfileScope scope(profiler_, "step");
        status = simulation_->step();
      }
      const double took = now_seconds() - before;
      stepping += took;
      if (!status.ok()) {
        report_.stopped = status.error().message;
        break;
      }
      times.push_back(1e3 * took);
      report_.worst_penetration = std::max(report_.worst_penetration, simulation_->worst_penetration());
      report_.worst_joint_error = std::max(report_.worst_joint_error, simulation_->worst_joint_error());
      report_.most_contacts = std::max(report_.most_contacts, simulation_->counters().touching_contacts);
      take_samples();
      if (options_.hash_every > 0 && (i + 1) % std::uint64_t(options_.hash_every) == 0)
        report_.hashes.push_back({simulation_->step_count(), simulation_->state_hash()});
      const core::ProfileScope scope(profiler_, "record");
      if (const core::Status recorded = record(false); !recorded.ok()) {
        report_.stopped = recorded.error().message;
        break;
      }
      progress.update(double(i + 1) / double(total));
    }
    report_.interrupted = interrupted;
    report_.wall = now_seconds() - started;
    report_.steps = simulation_->step_count();
    report_.simulated = simulation_->time();
    report_.real_time_factor = stepping > 0 ? double(times.size()) * d.dt / stepping : 0;
    if (!times.empty()) {
      std::sort(times.begin(), times.end());
      report_.step_median = times[times.size() / 2];
      report_.step_worst = times.back();
    }
  }

  void finish(bool check) {
    report_.end = simulation_->budget();
    report_.counters = simulation_->counters();
    report_.hash = simulation_->state_hash();
    report_.message = simulation_->base().state.message;
    const host::Declaration& d = simulation_->declaration();
    for (std::size_t i = 0; i < d.parameters.size(); ++i) {
      const host::Parameter& p = d.parameters[i];
      const double value = simulation_->values()[i];
      char number[64];
      std::snprintf(number, sizeof number, "%.9g%s%s", value, p.unit.empty() ? "" : " ", p.unit.c_str());
      report_.parameters.push_back({p.name, p.choices.empty() ? number : p.choices[std::size_t(value - p.minimum)]});
    }
    report_.checked = check && !report_.interrupted && report_.stopped.empty();
    if (report_.checked) simulation_->expectations(report_.expectations);
  }

  void picture(const std::string& name) {
    if (const core::Status status = write_picture(*simulation_, path(name)); !status.ok())
      trouble_ = status;
    else
      report_.files.push_back(path(name));
  }

  core::Status write_files() {
    if (recorder_) {
      const std::string name = path("recording.carom-rec");
      if (last_recorded_ != simulation_->step_count())
        if (const core::Status status = record(true); !status.ok()) return status;
      if (const core::Status status = recorder_->finish(); !status.ok()) return status;
      if (const core::Status status = put_in_place(temporary_name(name), name); !status.ok()) return status;
      report_.files.push_back(name);
    }
    if (options_.pictures) {
      picture("end.png");
      const host::Declaration& d = simulation_->declaration();
      for (std::size_t i = 0; i < d.plots.size(); ++i) {
        Chart chart = chart_of(d.plots[i], int(i), samples_);
        chart.subtitle = d.title;
        const std::string name = path(plot_name(d.plots[i], i));
        if (const core::Status status = write_chart(chart, name); !status.ok()) return status;
        report_.files.push_back(name + ".png");
        report_.files.push_back(name + ".svg");
      }
    }
    if (!trouble_.ok()) return trouble_;
    if (profiler_) {
      if (const core::Status status = write_file(options_.trace, profiler_->chrome_trace()); !status.ok())
        return status;
      report_.files.push_back(options_.trace);
    }
    report_.files.push_back(path("report.json"));
    return write_file(path("report.json"), report_json(report_));
  }

  const RunOptions& options_;
  std::unique_ptr<host::Simulation> simulation_;
  core::Profiler* profiler_;
  std::string out_;
  Report report_;
  std::optional<host::RunRecorder> recorder_;
  std::vector<host::Sample> samples_, waiting_;
  int record_every_ = 1;
  std::uint64_t last_recorded_ = ~std::uint64_t{0};
  core::Status trouble_;
};

}  // namespace

int run(const RunOptions& options) {
  core::Result<std::unique_ptr<host::Demo>> demo = open_demo(options.scene);
  if (!demo.ok()) return fail(exit_input, demo.error().message);
  const host::Declaration declaration = (*demo)->declaration();
  const core::Result<std::vector<double>> values = parse_settings(declaration, options.settings);
  if (!values.ok()) return fail(exit_usage, values.error().message);
  std::unique_ptr<host::Demo> owner = std::move(demo).value();
  host::Demo& opener = *owner;
  // A scope or two of ours a step, and a dozen of the engine's: a million is an hour of the smallest scenes.
  std::optional<core::Profiler> profiler;
  if (!options.trace.empty()) profiler.emplace(1, 1 << 20);
  core::Profiler* const stages = profiler ? &*profiler : nullptr;
  core::Result<std::unique_ptr<host::Simulation>> simulation =
      opener.open(std::move(owner), *values, {options.threads, stages});
  if (!simulation.ok()) return fail(exit_input, simulation.error().message);
  watch_for_interrupts();
  // Expectations are facts about the declared run; other values or lengths make another run.
  const bool full = options.steps == 0 && options.duration == 0 && options.settings.empty();
  return Runner(options, std::move(simulation).value(), stages).run(full);
}

}  // namespace carom::command
