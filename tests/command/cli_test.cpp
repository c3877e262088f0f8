// The program `carom` as a user meets it: exit codes, JSON, help, interrupted runs.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "carom/scene/recording.h"

namespace carom::command {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Cli : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("carom_cli_test_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Runs `carom` with these arguments; the exit status, and what it said.
  int carom(const std::string& arguments) {
    const std::string command =
        "cd '" + folder_.string() + "' && '" CAROM_COMMAND "' " + arguments + " > out.txt 2> err.txt";
    const int status = std::system(command.c_str());
    out_ = read(folder_ / "out.txt");
    err_ = read(folder_ / "err.txt");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  static std::string read(const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }
  bool no_leftovers() const {
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      if (entry.path().extension() == ".part") return false;
    return true;
  }

  fs::path folder_;
  std::string out_, err_;
};

TEST_F(Cli, HelpHasExamplesAndExitCodes) {
  EXPECT_EQ(carom("--help"), 0);
  EXPECT_NE(out_.find("Exit status"), std::string::npos);
  for (const char* command : {"run", "sweep", "render", "replay", "serve", "mass", "list", "doctor", "bench"}) {
    EXPECT_EQ(carom(std::string(command) + " --help"), 0) << command;
    EXPECT_NE(out_.find("Examples:"), std::string::npos) << command;
  }
  EXPECT_EQ(carom("--version"), 0);
}

TEST_F(Cli, BadUsageIsTwo) {
  for (const char* bad :
       {"", "fly", "run", "run pyramids --threads many", "run pyramids --threads 1000", "run pyramids --steps 0",
        "run pyramids --steps 5 --duration 1", "run pyramids --duration nan", "run pyramids --set friction",
        "run pyramids --set friction=9", "run golf-hole --set club=putter", "run golf-hole --set club=99",
        "run pyramids --set 'friction=2 m'", "run pyramids --set 'nothing=2'", "serve --port 70000", "bench nothing"})
    EXPECT_EQ(carom(bad), 2) << bad;
  carom("run pyramids --set fricton=0.5");
  EXPECT_NE(err_.find("did you mean \"friction\""), std::string::npos) << err_;
}

TEST_F(Cli, ASweepThatWasKilledGoesOnAndShardsMakeTheSameTable) {
  const std::string what = "sweep chain --vary ratio=1:100:4 --vary links=5,10 --steps 30 --quiet --out ";
  ASSERT_EQ(carom(what + "whole"), 0) << err_;
  const std::string table = read(folder_ / "whole/table.csv");
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 9) << table;
  EXPECT_NE(table.find("67.0,10.0"), std::string::npos) << "every combination";
  EXPECT_TRUE(fs::exists(folder_ / "whole/report.html"));
  // Killed within a line: what was whole counts, the rest is done again.
  const fs::path lines = folder_ / "whole/cases-0-of-1.jsonl";
  fs::resize_file(lines, fs::file_size(lines) / 2);
  fs::remove(folder_ / "whole/table.csv");
  ASSERT_EQ(carom(what + "whole"), 0) << err_;
  EXPECT_EQ(read(folder_ / "whole/table.csv"), table);
  // Two processes share a folder; whoever ends last merges.
  ASSERT_EQ(carom(what + "shared --shard 1/2"), 0) << err_;
  EXPECT_FALSE(fs::exists(folder_ / "shared/table.csv"));
  ASSERT_EQ(carom(what + "shared --shard 0/2"), 0) << err_;
  EXPECT_EQ(read(folder_ / "shared/table.csv"), table);
  // A folder belongs to one sweep.
  EXPECT_EQ(carom("sweep chain --vary ratio=1:100:5 --steps 30 --out whole"), 3);
  EXPECT_NE(err_.find("another sweep"), std::string::npos) << err_;
  for (const char* bad : {"sweep chain", "sweep chain --vary ratio", "sweep chain --vary ratio=1:2",
                          "sweep chain --vary ratio=1:2:x", "sweep chain --vary ratio=1:9999:3",
                          "sweep chain --vary ratio=1,2 --shard 2/2", "sweep chain --vary ratio=1,2 --shard x"})
    EXPECT_EQ(carom(bad), 2) << bad;
}

TEST_F(Cli, ARecordingIsRunAgainAndCompared) {
  ASSERT_EQ(carom("run wrecking-ball --steps 40 --set 'ball_mass=2 t' --no-pictures --out run --quiet"), 0) << err_;
  ASSERT_EQ(carom("replay run/recording.carom-rec --json"), 0) << err_ << out_;
  const Json report = Json::parse(out_);
  EXPECT_EQ(report["equal"], true);
  EXPECT_EQ(report["last"], 40);
  ASSERT_EQ(carom("replay run/recording.carom-rec --threads 2"), 0) << err_;
  EXPECT_NE(out_.find("the same: steps 0 to 40"), std::string::npos) << out_;
  EXPECT_EQ(carom("replay nothing.carom-rec"), 2);
  // A scene takes what it was read from along: the recording runs again where its files are gone.
  fs::copy_file(fs::path(CAROM_SOURCE_DIR) / "scenes/heap.json", folder_ / "mine.json");
  ASSERT_EQ(carom("run mine.json --steps 30 --no-pictures --out mine --quiet"), 0) << err_;
  fs::remove(folder_ / "mine.json");
  EXPECT_EQ(carom("replay mine/recording.carom-rec"), 0) << err_ << out_;
}

#ifdef CAROM_MPI
TEST_F(Cli, TwoProcessesOfAnMpiJobShareASweep) {
  const std::string what = " chain --vary ratio=1:100:6 --steps 20 --quiet --out ";
  ASSERT_EQ(carom("sweep" + what + "alone"), 0) << err_;
  const auto mpi = [&](const std::string& arguments) {
    const std::string command = "cd '" + folder_.string() +
                                "' && mpirun --allow-run-as-root --oversubscribe -n 2 '" CAROM_MPI "' " + arguments +
                                " > out.txt 2> err.txt";
    const int status = std::system(command.c_str());
    err_ = read(folder_ / "err.txt");
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  };
  ASSERT_EQ(mpi(what + "shared"), 0) << err_;
  EXPECT_TRUE(fs::exists(folder_ / "shared/cases-1-of-2.jsonl"));
  EXPECT_EQ(read(folder_ / "shared/table.csv"), read(folder_ / "alone/table.csv"));
  // A job that was killed goes on: half of a shard's file is there.
  const fs::path lines = folder_ / "shared/cases-0-of-2.jsonl";
  fs::resize_file(lines, fs::file_size(lines) / 2);
  fs::remove(folder_ / "shared/table.csv");
  ASSERT_EQ(mpi(what + "shared"), 0) << err_;
  EXPECT_EQ(read(folder_ / "shared/table.csv"), read(folder_ / "alone/table.csv"));
  EXPECT_EQ(mpi("no-such-scene --vary x=1,2"), 3);
  EXPECT_EQ(mpi("chain --vary ratio=1,2 --shard 0/2"), 2);
}
#endif

TEST_F(Cli, RendersRecordingsAndScenes) {
  ASSERT_EQ(carom("run bullets --steps 60 --no-pictures --quiet --out run"), 0) << err_;
  ASSERT_EQ(carom("render run/recording.carom-rec --out frames --rate 5 --size 160x90"), 0) << err_;
  // Both ends of a second count: 0, 0.2, … 1.
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_ / "frames"), fs::directory_iterator()), 6);
  EXPECT_EQ(read(folder_ / "frames/frame-000005.png").substr(1, 3), "PNG");
  // A recording shows what the scene itself shows.
  ASSERT_EQ(carom("render bullets --to 1 --out live --rate 5 --size 160x90"), 0) << err_;
  for (const char* frame : {"frame-000002.png", "frame-000005.png"})
    EXPECT_GT(fs::file_size(folder_ / "live" / frame), 1000u) << frame;
  ASSERT_EQ(carom("render pyramids --to 0.2 --out movie.gif --rate 10 --size 96x54"), 0) << err_;
  const std::string gif = read(folder_ / "movie.gif");
  EXPECT_EQ(gif.substr(0, 6), "GIF89a");
  EXPECT_EQ(gif.back(), ';');
  EXPECT_EQ(carom("render no-such --out x.gif"), 3);
  EXPECT_EQ(carom("render run/recording.carom-rec --set speed=3 --out x.gif"), 3);
  EXPECT_EQ(carom("render pyramids --out x.gif --size 5x"), 2);
  EXPECT_EQ(carom("render pyramids --out x.mp4 --size 101x90"), 2);
  std::ofstream(folder_ / "bad.carom-rec") << "no recording";
  EXPECT_EQ(carom("render bad.carom-rec --out x.gif"), 3);
  EXPECT_NE(err_.find("bad.carom-rec"), std::string::npos) << err_;
  EXPECT_TRUE(no_leftovers());
}

TEST_F(Cli, BadInputIsThree) {
  EXPECT_EQ(carom("run no-such-scene"), 3);
  EXPECT_EQ(carom("run pyramid"), 3);
  EXPECT_NE(err_.find("pyramids"), std::string::npos) << err_;
  std::ofstream(folder_ / "broken.json") << "{ \"bodies\": [ ";
  EXPECT_EQ(carom("run broken.json"), 3);
  EXPECT_NE(err_.find("broken.json"), std::string::npos) << err_;
  EXPECT_EQ(carom("mass nothing.obj"), 3);
}

TEST_F(Cli, AFolderThatCannotBeMadeIsFour) {
  std::ofstream(folder_ / "file") << "x";
  EXPECT_EQ(carom("run race-ship --out file/below"), 4);
}

TEST_F(Cli, RunWritesAWholeReport) {
  ASSERT_EQ(carom("run collision-lab-2d --json"), 0) << out_ << err_;
  const Json report = Json::parse(out_, nullptr, false);
  ASSERT_TRUE(report.is_object()) << out_;
  for (const char* field : {"bodies", "contacts", "joints", "start", "end", "worst_penetration_m", "step_ms_median",
                            "step_ms_worst", "real_time_factor", "state_hash", "expectations", "files"})
    EXPECT_TRUE(report.contains(field)) << field;
  EXPECT_TRUE(report["passed"]);
  EXPECT_GE(report["expectations"].size(), 2u);
  for (const Json& file : report["files"]) EXPECT_TRUE(fs::is_regular_file(folder_ / file.get<std::string>())) << file;
  EXPECT_EQ(Json::parse(read(folder_ / "out/collision-lab-2d/report.json"), nullptr, false)["state_hash"],
            report["state_hash"]);
  EXPECT_EQ(read(folder_ / "out/collision-lab-2d/end.png").substr(1, 3), "PNG");
  EXPECT_TRUE(no_leftovers());
  auto recording = scene::Recording::open((folder_ / "out/collision-lab-2d/recording.carom-rec").string());
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_TRUE(recording->complete());
  EXPECT_NEAR(recording->last_time(), 3.0, 1e-6);
  const auto frame = recording->frame(recording->frame_count() - 1);
  ASSERT_TRUE(frame.ok());
  char hash[20];
  std::snprintf(hash, sizeof hash, "%016llx", static_cast<unsigned long long>(frame->state_hash));
  EXPECT_EQ(report["state_hash"], hash) << "the last frame is the end";
}

TEST_F(Cli, SettingsTakeUnitsAndChangeTheRun) {
  ASSERT_EQ(carom("run collision-lab-2d --json --no-record --no-pictures --set 'speed_a=20 km/h' --set mass_a=3"), 0)
      << err_;
  const Json report = Json::parse(out_, nullptr, false);
  EXPECT_EQ(report["parameters"]["mass_a"], "3 kg");
  EXPECT_EQ(report["parameters"]["speed_a"], "5.55555556 m/s");
  EXPECT_TRUE(report["expectations"].empty()) << "they are facts about the default values";
  ASSERT_EQ(carom("run golf-hole --json --no-record --no-pictures --steps 2 --set club=7-iron --set stimp='9 ft'"), 0)
      << err_;
  EXPECT_EQ(Json::parse(out_, nullptr, false)["parameters"]["club"], "7-iron");
  EXPECT_EQ(carom("run golf-hole --set club=putter"), 2);
  EXPECT_NE(err_.find("\"driver\", \"3-wood\""), std::string::npos) << err_;
}

TEST_F(Cli, ThreadsDoNotChangeTheBits) {
  std::string hash[2];
  for (const int threads : {1, 2}) {
    ASSERT_EQ(carom("run wrecking-ball --json --no-record --no-pictures --steps 200 --hash-every 50 --threads " +
                    std::to_string(threads)),
              0);
    const Json report = Json::parse(out_, nullptr, false);
    EXPECT_EQ(report["hashes"].size(), 4u);
    hash[threads - 1] = report["hashes"].dump();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST_F(Cli, ATraceIsChromeJson) {
  ASSERT_EQ(carom("run race-ship --no-record --no-pictures --quiet --trace trace.json"), 0);
  EXPECT_EQ(out_, "");
  EXPECT_FALSE(Json::parse(read(folder_ / "trace.json"), nullptr, false).is_discarded());
}

TEST_F(Cli, NoProgressBarOffATerminal) {
  ASSERT_EQ(carom("run race-ship --no-record --no-pictures"), 0);
  EXPECT_EQ(err_, "");
}

TEST_F(Cli, InterruptedLeavesWholeFiles) {
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder_.c_str()) != 0 || !freopen("out.txt", "w", stdout)) _exit(99);
    execl(CAROM_COMMAND, "carom", "run", "pyramids", "--duration", "100000", "--json", static_cast<char*>(nullptr));
    _exit(98);
  }
  // Not before it runs: the recording's temporary file tells.
  for (int i = 0; i < 1000 && !fs::exists(folder_ / "out/pyramids/start.png"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  ASSERT_EQ(kill(child, SIGINT), 0);
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
  const Json report = Json::parse(read(folder_ / "out/pyramids/report.json"), nullptr, false);
  ASSERT_TRUE(report.is_object());
  EXPECT_TRUE(report["interrupted"]);
  EXPECT_TRUE(no_leftovers());
  auto recording = scene::Recording::open((folder_ / "out/pyramids/recording.carom-rec").string());
  ASSERT_TRUE(recording.ok());
  EXPECT_TRUE(recording->complete());
  EXPECT_NEAR(recording->last_time(), report["simulated_s"].get<double>(), 1e-9);
}

TEST_F(Cli, ListAndDoctorSpeakJson) {
  carom("list --json");
  const Json list = Json::parse(out_, nullptr, false);
  ASSERT_TRUE(list.is_object());
  EXPECT_GE(list["demos"].size(), 12u);
  EXPECT_TRUE(list["demos"][0]["parameters"].is_array());
  EXPECT_EQ(carom("doctor --json"), 0) << out_;
  const Json doctor = Json::parse(out_, nullptr, false);
  for (const char* field : {"version", "compiler", "instruction set", "processors", "page", "free port", "engine"})
    EXPECT_TRUE(doctor.contains(field)) << field;
  EXPECT_EQ(carom("doctor pyramids --json"), 0) << out_;
  EXPECT_TRUE(Json::parse(out_, nullptr, false)["advice"].is_array());
  EXPECT_EQ(carom("doctor no-such-scene"), 3);
}

TEST_F(Cli, ServeEndsCleanlyOnATerminationRequest) {
  const pid_t child = fork();
  if (child == 0) {
    if (chdir(folder_.c_str()) != 0 || !freopen("serve.txt", "w", stdout)) _exit(99);
    execl(CAROM_COMMAND, "carom", "serve", "--port", "0", "--json", static_cast<char*>(nullptr));
    _exit(98);
  }
  for (int i = 0; i < 500 && read(folder_ / "serve.txt").empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  const Json where = Json::parse(read(folder_ / "serve.txt"), nullptr, false);
  EXPECT_TRUE(where.is_object() && where["port"].get<int>() > 0);
  kill(child, SIGTERM);
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

}  // namespace
}  // namespace carom::command
