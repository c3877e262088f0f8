// The program `carom`.
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <thread>

#include "apps/command/command.h"

using namespace carom::command;

namespace {

constexpr const char* exit_codes =
    "Exit status: 0 all well, 1 an expectation failed, 2 bad usage, 3 a file or name that cannot be used,\n"
    "4 a file that cannot be written or a port that is taken, 5 the simulation stopped with an error, 130 interrupted\n"
    "(what was written by then is whole).";

std::string with_examples(const char* examples) { return std::string("Examples:\n") + examples + "\n" + exit_codes; }

int threads_of(int wanted) {
  return wanted > 0 ? wanted : int(std::max(1u, std::min(64u, std::thread::hardware_concurrency())));
}

}  // namespace

int main(int count, char** arguments) {
  CLI::App app{"Carom: the physics of a game in one library."};
  app.require_subcommand(1);
  app.footer(exit_codes);
  app.set_version_flag("--version", std::string(CAROM_VERSION_STRING));
  int result = exit_ok;

  RunOptions run_options;
  CLI::App* run_command = app.add_subcommand(
      "run", "Simulate a scene file or a demo without a display; report, recording, plots, pictures");
  bool no_record = false, no_pictures = false;
  run_command->add_option("scene", run_options.scene, "a scene file, or a name that `carom list` shows")->required();
  run_command->add_option("--out,-o", run_options.out, "folder for what is written (out/SCENE)");
  run_command
      ->add_option("--set,-s", run_options.settings,
                   "a parameter: name=value with its unit, or a name of its choices; may be repeated")
      ->take_all();
  run_command
      ->add_option("--threads,-t", run_options.threads,
                   "worker threads; 0: all processors. The result has the same bits")
      ->check(CLI::Range(0, 64));
  auto* steps =
      run_command->add_option("--steps", run_options.steps, "how many steps")->check(CLI::Range(1LL, 1'000'000'000LL));
  run_command->add_option("--duration", run_options.duration, "simulated seconds (the scene's own)")
      ->check(CLI::Range(1e-6, 1e7))
      ->check([](const std::string& text) {
        return text.find_first_of("nN") == std::string::npos ? "" : "found no number";
      })
      ->excludes(steps);
  run_command->add_option("--hash-every", run_options.hash_every, "list the state hash every N steps")
      ->check(CLI::Range(1, 1'000'000'000));
  run_command->add_option("--trace", run_options.trace, "write a Chrome trace of the run to this file");
  run_command->add_flag("--no-record", no_record, "no recording");
  run_command->add_flag("--no-pictures", no_pictures, "no pictures and plots");
  run_command->add_flag("--json", run_options.json, "the report as JSON on the output");
  run_command->add_flag("--quiet,-q", run_options.quiet, "no report on the output");
  run_command->footer(
      with_examples("  carom run wrecking-ball\n"
                    "  carom run wrecking-ball --set \"ball_mass=2 t\" --set \"angle=80 deg\" --duration 5\n"
                    "  carom run scenes/nesc_02.json --json --no-pictures\n"
                    "  carom run pyramids --threads 2 --steps 300 --hash-every 100 --no-record\n"));
  run_command->callback([&] {
    run_options.record = !no_record;
    run_options.pictures = !no_pictures;
    run_options.threads = threads_of(run_options.threads);
    result = run(run_options);
  });

  SweepOptions sweep_options;
  std::string shard;
  CLI::App* sweep_command = app.add_subcommand(
      "sweep", "Simulate a scene over ranges of its parameters, on all processors; goes on where it was ended");
  sweep_command->add_option("scene", sweep_options.scene, "a scene file, or a name that `carom list` shows")
      ->required();
  sweep_command
      ->add_option("--vary,-v", sweep_options.vary,
                   "name=from:to:count, evenly spaced, or name=a,b,c, with units; may be repeated: every combination")
      ->required()
      ->allow_extra_args(false);
  sweep_command->add_option("--set,-s", sweep_options.settings, "a parameter for all cases: name=value with its unit")
      ->allow_extra_args(false);
  sweep_command->add_option("--out,-o", sweep_options.out, "folder for cases, table and report (out/sweep-SCENE)");
  sweep_options.threads = 0;
  sweep_command->add_option("--threads,-t", sweep_options.threads, "cases at once; 0: as many as processors (0)")
      ->check(CLI::Range(0, 256));
  auto* sweep_steps = sweep_command->add_option("--steps", sweep_options.steps, "steps of each case")
                          ->check(CLI::Range(1LL, 1'000'000'000LL));
  sweep_command->add_option("--duration", sweep_options.duration, "simulated seconds of each case (the scene's own)")
      ->check(CLI::Range(1e-6, 1e7))
      ->excludes(sweep_steps);
  sweep_command->add_option("--shard", shard,
                            "i/n: this process takes every n-th case from the i-th on; the last one to end merges");
  sweep_command->add_flag("--quiet,-q", sweep_options.quiet, "say nothing");
  sweep_command->footer(with_examples(
      "  carom sweep wrecking-ball --vary \"angle=20 deg:80 deg:7\" --vary \"ball_mass=1 t,2 t,4 t\"\n"
      "  carom sweep chain --vary ratio=1:1000:40 --duration 5 --out out/chain\n"
      "  carom sweep chain --vary ratio=1:1000:40 --shard 0/2 --out shared   (and 1/2 on another machine)\n"));
  sweep_command->callback([&] {
    sweep_options.threads = threads_of(sweep_options.threads);
    if (!shard.empty() && (std::sscanf(shard.c_str(), "%d/%d", &sweep_options.shard, &sweep_options.shards) != 2 ||
                           sweep_options.shards < 1))
      result = fail(exit_usage, "--shard " + shard + ": expected i/n, such as 0/4");
    else
      result = sweep(sweep_options);
  });

  RenderOptions render_options;
  CLI::App* render_command = app.add_subcommand(
      "render", "Pictures of a recording, or of a scene as it runs: a GIF, an MP4 (with ffmpeg) or PNG files");
  render_command
      ->add_option("source", render_options.source, "a recording (.carom-rec), a scene file, or a demo's name")
      ->required();
  render_command->add_option("--out,-o", render_options.out, "NAME.gif, NAME.mp4, or a folder for PNG files")
      ->required();
  render_command->add_option("--set,-s", render_options.settings, "a parameter of a scene: name=value with its unit")
      ->take_all();
  render_command->add_option("--size", render_options.size, "of the pictures (1280x720)");
  render_command->add_option("--rate,-r", render_options.rate, "pictures a simulated second (30)")
      ->check(CLI::Range(0.01, 1000.0));
  render_command->add_option("--from", render_options.from, "s; the first picture (0)")->check(CLI::Range(0.0, 1e7));
  render_command->add_option("--to", render_options.to, "s; the last picture (the end)")->check(CLI::Range(0.0, 1e7));
  render_command->add_option("--threads,-t", render_options.threads, "worker threads; 0: all processors")
      ->check(CLI::Range(0, 64));
  render_command->add_flag("--bare", render_options.bare, "no lettering: as a thumbnail");
  render_command->add_flag("--quiet,-q", render_options.quiet, "say nothing");
  render_command->footer(
      with_examples("  carom render out/wrecking-ball/recording.carom-rec --out wall.gif --size 640x360 --rate 20\n"
                    "  carom render pyramids --out pyramids.mp4 --to 5\n"
                    "  carom render scenes/heap.json --out out/frames\n"));
  render_command->callback([&] {
    render_options.threads = threads_of(render_options.threads);
    result = render(render_options);
  });

  ReplayOptions replay_options;
  CLI::App* replay_command = app.add_subcommand(
      "replay", "Run a recording again from what opened it, and say at which step it differs, if any does");
  replay_command->add_option("recording", replay_options.recording, "a recording (.carom-rec)")
      ->required()
      ->check(CLI::ExistingFile);
  replay_command->add_option("--threads,-t", replay_options.threads, "worker threads; 0: all processors")
      ->check(CLI::Range(0, 64));
  replay_command->add_flag("--json", replay_options.json, "as JSON");
  replay_command->add_flag("--quiet,-q", replay_options.quiet, "only the exit status: 0 the same, 1 not");
  replay_command->footer(
      with_examples("  carom replay out/wrecking-ball/recording.carom-rec\n"
                    "  carom replay bug-report.carom-rec --threads 8 --json\n"));
  replay_command->callback([&] {
    replay_options.threads = threads_of(replay_options.threads);
    result = replay(replay_options);
  });

  ServeOptions serve_options;
  CLI::App* serve_command =
      app.add_subcommand("serve", "Serve the playground; the engine runs here, the page shows it");
  serve_command->add_option("--address,-a", serve_options.address, "where to listen (127.0.0.1: this machine only)");
  auto* port =
      serve_command->add_option("--port,-p", serve_options.port, "port; 0: any free one (8080, or the next free one)")
          ->check(CLI::Range(0, 65535));
  serve_command->add_option("--page", serve_options.page, "folder of the built page")->check(CLI::ExistingDirectory);
  serve_command->add_option("--allow-host", serve_options.allowed_hosts,
                            "a further name under which pages may reach this server");
  serve_command->add_option("--threads,-t", serve_options.threads, "worker threads of each world; 0: all processors")
      ->check(CLI::Range(0, 64));
  serve_command->add_option("--clients", serve_options.clients, "pages at once (64)")->check(CLI::Range(1, 1024));
  auto* tls = serve_command->add_flag(
      "--tls", serve_options.tls, "https, with a certificate of its own making: phones give sensors to nothing else");
  auto* certificate = serve_command->add_option("--certificate", serve_options.certificate, "PEM file instead of it");
  auto* key = serve_command->add_option("--key", serve_options.key, "its key, a PEM file without a password");
  certificate->needs(tls)->needs(key);
  key->needs(certificate);
  serve_command->add_flag("--open", serve_options.open, "open a browser where there is a desktop");
  serve_command->add_flag("--json", serve_options.json, "say where it is as one line of JSON");
  serve_command->add_flag("--quiet,-q", serve_options.quiet, "say nothing");
  serve_command->footer(with_examples(
      "  carom serve\n"
      "  carom serve --port 9000 --open\n"
      "  carom serve --address 0.0.0.0 --allow-host mybox.local   (others on the network may drive it)\n"
      "  carom serve --address 0.0.0.0 --tls   (for a phone's sensors; its browser asks once whether to trust it)\n"));
  serve_command->callback([&] {
    serve_options.port_given = port->count() > 0;
    serve_options.threads = threads_of(serve_options.threads);
    result = serve(serve_options);
  });

  MassOptions mass_options;
  CLI::App* mass_command =
      app.add_subcommand("mass", "Mass, centre of mass and inertia tensor of a closed mesh (OBJ, STL, glTF, GLB)");
  mass_command->add_option("file", mass_options.file, "the mesh")->required();
  mass_command->add_option("--density,-d", mass_options.density, "with its unit (1000 kg/m^3)");
  mass_command->add_option("--unit,-u", mass_options.unit, "of the file's coordinates (m)");
  mass_command->add_flag("--json", mass_options.json, "as JSON");
  mass_command->footer(
      with_examples("  carom mass gear.stl --density \"7850 kg/m^3\" --unit mm\n"
                    "  carom mass hull.obj --density \"0.0361 lb/in^3\" --unit in --json\n"));
  mass_command->callback([&] { result = mass(mass_options); });

  bool list_json = false, doctor_json = false;
  CLI::App* list_command =
      app.add_subcommand("list", "Demos, scenes and presets; with --json every parameter, plot and input");
  list_command->add_flag("--json", list_json, "as JSON");
  list_command->footer(with_examples("  carom list\n  carom list --json\n"));
  list_command->callback([&] { result = list(list_json); });

  std::string doctor_scene;
  CLI::App* doctor_command = app.add_subcommand(
      "doctor", "What this machine and this build have, and what is missing; or what a scene's settings cannot hold");
  doctor_command->add_option("scene", doctor_scene, "a demo or scene file: sag, stretch and stiffness to expect of it");
  doctor_command->add_flag("--json", doctor_json, "as JSON");
  doctor_command->footer(with_examples("  carom doctor\n  carom doctor pyramids\n"));
  doctor_command->callback(
      [&] { result = doctor_scene.empty() ? doctor(doctor_json) : advise_scene(doctor_scene, doctor_json); });

  BenchOptions bench_options;
  CLI::App* bench_command = app.add_subcommand(
      "bench", "Time benchmark scenes: the suites of Box3D, Box2D and Jolt rebuilt, and two of our own");
  bench_command->add_option("scenes", bench_options.scenes, "names of scenes (all of the suite); --list shows them");
  bench_command->add_option("--suite,-s", bench_options.suite, "box3d, box2d, jolt, common or all (common)")
      ->check(CLI::IsMember({"box3d", "box2d", "jolt", "common", "all"}));
  bench_command
      ->add_option("--threads,-t", bench_options.threads,
                   "worker threads, one number or several (1,2); 0: all processors (1 and 2)")
      ->delimiter(',')
      ->check(CLI::Range(0, 64));
  bench_command
      ->add_option("--rounds,--repeats", bench_options.rounds,
                   "runs of each scene; the fastest of each step counts (3)")
      ->check(CLI::Range(1, 100));
  bench_command->add_option("--steps", bench_options.steps, "steps of each run (the scene's own)")
      ->check(CLI::Range(1, 100000));
  bench_command
      ->add_option("--width", bench_options.width, "SIMD lanes of the solver; 0: the widest of this machine (0)")
      ->check(CLI::IsMember({0, 4, 8, 16}));
  bench_command->add_flag("--list,-l", bench_options.list, "list the scenes");
  bench_command->add_flag("--json", bench_options.json, "as JSON");
  auto* plot = bench_command->add_option("--plot", bench_options.plot,
                                         "draw Carom beside its peers to this SVG file, from the rows of --from");
  bench_command->add_option("--from", bench_options.from, "rows as --json prints them, of several engines")
      ->needs(plot)
      ->check(CLI::ExistingFile);
  plot->needs("--from");
  bench_command->add_flag("--series", bench_options.series, "with every step's time in the JSON");
  bench_command->footer(
      with_examples("  carom bench\n"
                    "  carom bench --suite box2d --rounds 5\n"
                    "  carom bench box3d/large_pyramid tumbler --threads 1 --json\n"));
  bench_command->callback([&] {
    if (bench_options.threads.empty()) bench_options.threads = {1, 2};
    for (int& threads : bench_options.threads) threads = threads_of(threads);
    result = bench(bench_options);
  });

  try {
    app.parse(count, arguments);
  } catch (const CLI::ParseError& error) {
    const int code = app.exit(error);
    return code == 0 ? exit_ok : exit_usage;
  }
  return result;
}
