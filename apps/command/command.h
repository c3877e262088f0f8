// What the subcommands of `carom` share.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

#include "apps/host/demo.h"
#include "apps/host/host.h"

namespace carom::command {

/// What the program's exit status means; `carom --help` lists them.
enum Exit : int {
  exit_ok = 0,
  exit_failed_expectation = 1,
  exit_usage = 2,
  exit_input = 3,    ///< a file or a name that cannot be used
  exit_system = 4,   ///< a file that cannot be written, a port that is taken
  exit_stopped = 5,  ///< the simulation ended with an error
  exit_interrupted = 130,
};

/// Prints "carom: …" to the error stream.
int fail(int code, const std::string& message);

/// Set by Ctrl-C or a termination request; a second one ends the program at once.
extern std::atomic<bool> interrupted;
void watch_for_interrupts();

/// A progress bar on the error stream: only on a terminal, and only for what takes longer than two seconds.
class Progress {
 public:
  explicit Progress(std::string label, bool wanted = true);
  ~Progress();
  void update(double fraction);

 private:
  std::string label_;
  bool terminal_, shown_ = false;
  double started_, last_ = 0;
};
double now_seconds();

/// A demo's name or a scene file, by its path or by its name in the scenes folder.
core::Result<std::unique_ptr<host::Demo>> open_demo(const std::string& name);
/// Folders where scenes, presets and the page are looked for: beside the working folder, the source, the installation.
std::vector<std::string> data_folders(const std::string& name);
struct SceneFile {
  std::string name, path;
};
std::vector<SceneFile> scene_files();
std::vector<host::MenuScene> menu_scenes();
std::vector<std::string> preset_names();
/// The folder of the built page, or empty.
std::string page_folder();
/// "name=value unit" for a parameter of the demo, checked for dimension and range.
core::Result<std::vector<double>> parse_settings(const host::Declaration& declaration,
                                                 const std::vector<std::string>& settings);

struct RunOptions {
  std::string scene;
  std::string out;
  std::vector<std::string> settings;
  int threads = 1;
  long long steps = 0;  ///< 0: by duration
  double duration = 0;  ///< 0: the scene's own
  int hash_every = 0;
  std::string trace;
  bool record = true, pictures = true, json = false, quiet = false;
};
int run(const RunOptions& options);

struct RenderOptions {
  std::string source;  ///< a recording, a demo's name or a scene file
  std::string out;     ///< NAME.gif, NAME.mp4 or a folder
  std::vector<std::string> settings;
  std::string size = "1280x720";
  double rate = 30, from = 0, to = 0;  ///< to 0: all of it
  int threads = 1;
  bool bare = false;  ///< no lettering
  bool quiet = false;
};
int render(const RenderOptions& options);

struct ReplayOptions {
  std::string recording;
  int threads = 1;
  bool json = false, quiet = false;
};
int replay(const ReplayOptions& options);

struct SweepOptions {
  std::string scene, out;
  std::vector<std::string> settings;
  std::vector<std::string> vary;  ///< "name=from:to:count" or "name=a,b,c"
  int threads = 1;
  long long steps = 0;
  double duration = 0;
  int shard = 0, shards = 1;  ///< of the cases, this process takes those with index % shards == shard
  bool quiet = false;
};
int sweep(const SweepOptions& options);

struct ServeOptions {
  std::string address = "127.0.0.1";
  int port = 8080;
  bool port_given = false;
  std::string page;
  std::vector<std::string> allowed_hosts;
  std::string certificate, key;  ///< PEM files
  int threads = 1, clients = 64;
  bool tls = false, open = false, json = false, quiet = false;
};
int serve(const ServeOptions& options);

struct MassOptions {
  std::string file, density = "1000 kg/m^3", unit = "m";
  bool json = false;
};
int mass(const MassOptions& options);

int list(bool json);
int doctor(bool json);
/// `carom doctor SCENE`: what its settings cannot hold, and what to change.
int advise_scene(const std::string& scene, bool json);
std::vector<std::string> advice_for(host::Simulation& simulation);

struct BenchOptions {
  std::vector<std::string> scenes;
  std::string suite;         ///< common, box3d, box2d, jolt, all
  std::vector<int> threads;  ///< each scene once with each
  int rounds = 3, steps = 0, width = 0;
  bool json = false, series = false, list = false;
  std::string from, plot;  ///< rows in a file, and the picture drawn from them
};
int bench(const BenchOptions& options);
int plot_benchmarks(const std::string& rows, const std::string& picture);

}  // namespace carom::command
