// `carom render`: pictures of a recording, or of a scene as it runs, without a browser.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>

#include "apps/command/command.h"
#include "apps/command/movie.h"
#include "apps/command/picture.h"
#include "apps/host/playback.h"

namespace carom::command {

namespace fs = std::filesystem;

namespace {

core::Result<std::unique_ptr<host::Simulation>> open_source(const RenderOptions& options) {
  if (fs::path(options.source).extension() == ".carom-rec") {
    if (!options.settings.empty())
      return core::Error{"--set: " + options.source + " is a recording; what it shows was set when it was made"};
    std::ifstream in(options.source, std::ios::binary);
    if (!in) return core::Error{options.source + ": cannot be read"};
    std::vector<std::uint8_t> bytes((std::istreambuf_iterator<char>(in)), {});
    core::Result<std::unique_ptr<host::Simulation>> opened = host::open_recording(std::move(bytes));
    if (!opened.ok()) return core::Error{options.source + ": " + opened.error().message};
    return opened;
  }
  core::Result<std::unique_ptr<host::Demo>> demo = open_demo(options.source);
  if (!demo.ok()) return demo.error();
  const core::Result<std::vector<double>> values = parse_settings((*demo)->declaration(), options.settings);
  if (!values.ok()) return values.error();
  host::Demo& opener = **demo;
  return opener.open(std::move(demo).value(), *values, {options.threads});
}

}  // namespace

int render(const RenderOptions& options) {
  int width = 0, height = 0;
  char rest = 0;
  if (std::sscanf(options.size.c_str(), "%dx%d%c", &width, &height, &rest) != 2 || width < 16 || height < 16 ||
      width > 7680 || height > 4320)
    return fail(exit_usage, "--size " + options.size + ": expected WIDTHxHEIGHT, 16x16 to 7680x4320");
  if (fs::path(options.out).extension() == ".mp4" && (width % 2 != 0 || height % 2 != 0))
    return fail(exit_usage, "--size " + options.size + ": MP4 needs even numbers");
  core::Result<std::unique_ptr<host::Simulation>> opened = open_source(options);
  if (!opened.ok()) return fail(exit_input, opened.error().message);
  host::Simulation& simulation = **opened;
  double to = options.to;
  if (!(to > 0)) {
    const std::optional<host::StepRange> recorded = simulation.recorded();
    to = recorded ? 1e300 : simulation.declaration().duration;
  }
  if (!(options.from <= to)) return fail(exit_usage, "--from lies after --to");
  core::Result<std::unique_ptr<Movie>> movie = make_movie(options.out, width, height, options.rate);
  if (!movie.ok()) return fail(exit_system, movie.error().message);

  watch_for_interrupts();
  Progress progress("rendering", !options.quiet);
  const double half_step = 0.5 * simulation.declaration().dt;
  int pictures = 0;
  for (bool ended = false; !ended && !interrupted; ++pictures) {
    const double due = options.from + pictures / options.rate;
    if (due > to + 1e-9) break;
    while (simulation.time() + half_step < due) {
      const double before = simulation.time();
      if (const core::Status status = simulation.step(); !status.ok())
        return fail(exit_stopped, status.error().message);
      simulation.base().state.samples.clear();
      if (simulation.time() == before) {
        ended = true;  // the recording's last frame
        break;
      }
    }
    if (ended && pictures > 0) break;
    if (const core::Status status = (*movie)->add(picture_of(simulation, width, height, !options.bare).get());
        !status.ok())
      return fail(exit_system, status.error().message);
    if (to < 1e300) progress.update((due - options.from) / std::max(to - options.from, 1e-9));
  }
  if (const core::Status status = (*movie)->finish(); !status.ok()) return fail(exit_system, status.error().message);
  if (!options.quiet)
    std::printf("%s: %d pictures, %.2f s at %g a second\n", options.out.c_str(), pictures, pictures / options.rate,
                options.rate);
  return interrupted ? exit_interrupted : exit_ok;
}

}  // namespace carom::command
