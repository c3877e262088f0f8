// One session between a page and the engine (docs/protocol.md): messages in, messages out, time from the carrier.
// No threads, sockets, files or clocks of its own: the same object serves a WebSocket, a Worker and a test.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "apps/host/history.h"
#include "apps/host/messages.h"
#include "apps/host/playback.h"
#include "apps/host/replay.h"
#include "apps/host/run_recorder.h"
#include "apps/host/simulation.h"
#include "carom/ode/clock.h"

namespace carom::host {

struct Message {
  bool text = true;
  std::string data;
};

/// A scene in the menu beside the demos; its file is read when somebody opens it.
struct MenuScene {
  Declaration summary;  ///< id, title, summary, group, chapter, dimension
  std::function<core::Result<std::unique_ptr<Demo>>()> load;
  std::function<std::string()> text;  ///< of its file, for who wants to edit it
};

/// A world that a game steps, while pages look at it. Every function is called where the host is.
struct Game {
  Declaration declaration;
  std::function<std::unique_ptr<Demo>()> watch;  ///< a demo round the world, whose `step` leaves it alone
  std::function<bool()> paused;
  std::function<void(bool paused)> pause;
  std::function<void(int count)> step;  ///< while paused
};

struct HostOptions {
  int threads = 1;                    ///< of every world
  double key_interval = 2;            ///< s between key frames
  double stats_interval = 0.25;       ///< s between stats blocks
  std::size_t max_message = 4 << 20;  ///< bytes of one message from the page
  /// Bytes waiting for the carrier; beyond it texts are dropped, and the page is told all anew once half of it is free.
  std::size_t max_outbox = 64 << 20;
  std::size_t max_recording = 64 << 20;  ///< bytes of one that a page sends or makes
  HistoryOptions history;                ///< what can be gone back to
  std::vector<MenuScene> scenes;
  /// The list of demos and scenes as a host of this build with these scenes once made it (menu_json); empty: every demo
  /// is asked what it declares. With a menu only the id of a scene's summary is read.
  std::string menu;
  std::shared_ptr<const Game> game;  ///< the only thing in the menu, where there is one
  /// Reads a scene's text for `open_scene`; empty: refused.
  std::function<core::Result<std::unique_ptr<Demo>>(std::string_view name, std::string_view text)> parse_scene;
};

class SimulationHost {
 public:
  explicit SimulationHost(HostOptions options = {});
  ~SimulationHost();
  SimulationHost(const SimulationHost&) = delete;
  SimulationHost& operator=(const SimulationHost&) = delete;

  /// A text message of the page. Whatever it holds, the host answers or says what was wrong.
  void receive(std::string_view text);
  /// A part of a recording that the page wants to see.
  [[gnu::noinline]] void receive_binary(std::string_view bytes);
  /// `real_seconds` have passed since the last call: steps, and puts a frame into the outbox where one is due.
  void advance(double real_seconds);
  /// The oldest waiting message; false where there is none.
  bool take(Message& message);
  /// Lets a carrier refuse a message itself (too long, wrong kind).
  void complain(std::string_view message);

  /// Lets go of what the page holds: before the host ends while the world goes on.
  void close();

  const Simulation* simulation() const { return simulation_.get(); }
  bool running() const { return running_; }

 private:
  struct Handlers;
  friend struct Handlers;

  core::Status open(core::Result<std::unique_ptr<Simulation>> opened);
  void begin();
  void restart();
  DeedOutcome act(const Deed& deed);
  void forget_after_now();
  void send_scene();
  void tell_anew();
  void send_inspection();
  core::Status start_recording();
  void record();
  void finish_recording();
  core::Status start_replay();
  void go_on_with_replay(double real_seconds);
  void send(std::string text);
  void send_binary(std::string bytes);
  void send_status();
  void send_meshes();
  void send_drawn(bool key);
  bool step_once();
  void follow_game(double real_seconds);
  bool at_end() const;  ///< of a demo that loops
  void send_changes();
  void frame(bool key);

  HostOptions options_;
  std::unique_ptr<Simulation> simulation_;
  std::string source_name_, source_text_;  ///< of the open scene; empty where a program made it
  std::vector<std::uint8_t> upload_;       ///< parts of a recording that have come
  std::unique_ptr<RunRecorder> recorder_;
  std::string recorded_;
  std::unique_ptr<Replay> replay_;
  double since_told_ = 0;              ///< how far the replay is
  std::vector<double> opened_values_;  ///< when the run began
  std::vector<DeedAtStep> done_;       ///< since then
  bool done_is_lost_ = false;          ///< more than anybody wants to do again
  History history_;
  std::uint32_t layers_ = 0;
  std::int64_t inspected_ = -1;  ///< the body whose report is sent with the numbers, or −1
  ode::FixedClock clock_;
  std::deque<Message> outbox_;
  std::size_t outbox_bytes_ = 0;
  std::vector<BodyPlace> sent_, now_, moved_;
  std::vector<Sample> samples_;
  std::vector<Line> lines_;
  bool running_ = false, restart_wanted_ = false, key_wanted_ = false, frame_wanted_ = false;
  bool greeted_ = false, text_lost_ = false;
  double speed_ = 1;
  std::uint32_t sequence_ = 0, acknowledged_ = 0;
  std::vector<std::uint32_t> surfaces_sent_;  ///< topology that the page knows
  bool points_sent_ = false;
  std::size_t meshes_sent_ = 0;
  std::uint64_t shown_ = 0;  ///< the game's step that the page has seen
  double since_key_ = 0, since_stats_ = 0, since_end_ = 0;
  double real_window_ = 0, simulated_window_ = 0, real_time_factor_ = 1;
};

}  // namespace carom::host
