#include "apps/debugger/debugger.h"

#include <atomic>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <thread>

#include "apps/debugger/gate.h"
#include "apps/server/server.h"

namespace carom::debugger {

namespace {

constexpr const char* demo_id = "game";

/// The game's world as a demo that is only looked at: its steps are the game's.
template <class D>
class Watched final : public host::DemoOf<D> {
 public:
  using StageD = host::Stage<D>;
  Watched(rigid::World<D>& world, const DebuggerOptions& options) : world_(world), options_(options) {}

  host::Declaration declaration() const override { return declare(options_, D::dimension); }
  static host::Declaration declare(const DebuggerOptions& options, int dimension) {
    host::Declaration d;
    d.id = demo_id;
    d.title = options.title;
    d.summary = "The world of a running game.";
    d.group = "Running";
    d.dimension = dimension;
    d.dt = double(options.dt);
    d.camera = {options.camera, options.target};
    d.camera.height = options.height;
    return d;
  }
  std::unique_ptr<host::Demo> again() const override { return std::make_unique<Watched>(world_, options_); }
  void build(StageD& stage) override {
    stage.use(world_);
    if constexpr (D::dimension == 3) {
      // The page draws a level floor as its ground, with marks of length.
      std::vector<rigid::ShapeId> shapes;
      for (const auto& actor : stage.actors()) {
        shapes.clear();
        world_.shapes(actor.body, shapes);
        for (const rigid::ShapeId id : shapes) {
          const auto shape = world_.shape_geometry(id);
          if (shape.ok() && shape->type == geometry::ShapeType3::plane && shape->plane.normal.y > 0.999f)
            stage.set_ground(stage.at(actor.body).pose.position.y);
        }
      }
    }
  }
  core::Status step(StageD& stage) override {
    stage.adopt_all();  // the game makes and destroys bodies as it likes
    return {};
  }

 private:
  rigid::World<D>& world_;
  DebuggerOptions options_;
};

}  // namespace

struct Debugger::Implementation {
  DebuggerOptions options;
  Gate gate;
  bool paused = false;  // touched within the gate and by the game's thread only
  int steps = 0;
  std::unique_ptr<server::Server> server;
};

Debugger::Debugger(std::unique_ptr<Implementation> self) : self_(std::move(self)) {}
Debugger::Debugger(Debugger&&) noexcept = default;
Debugger& Debugger::operator=(Debugger&&) noexcept = default;

Debugger::~Debugger() {
  if (!self_ || !self_->server) return;
  // Sessions that end let go of bodies: they get the world for it.
  std::atomic<bool> stopped{false};
  std::thread stopper([&] {
    self_->server->stop();
    self_->server.reset();
    stopped = true;
  });
  while (!stopped) {
    self_->gate.open(std::chrono::duration<double>(0.01));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  stopper.join();
}

bool Debugger::update() {
  self_->gate.open(std::chrono::duration<double>(self_->options.most_wait));
  if (!self_->paused) return true;
  if (self_->steps == 0) return false;
  --self_->steps;
  return true;
}

std::string Debugger::url() const { return self_->server->url(); }
int Debugger::pages() const { return self_->server->clients(); }

template <class D>
core::Result<Debugger> attach_to(rigid::World<D>& world, DebuggerOptions options) {
  if (!(options.dt > 0)) return core::Error{"DebuggerOptions::dt: expected the game's step in seconds, above 0"};
  auto self = std::make_unique<Debugger::Implementation>();
  Debugger::Implementation& d = *self;
  d.options = options;
  server::ServerOptions serve;
  serve.address = options.address;
  serve.port = options.port;
  std::error_code missing;
  serve.root = options.page;
  if (options.page.empty() && std::filesystem::is_directory(CAROM_PAGE_FOLDER, missing)) serve.root = CAROM_PAGE_FOLDER;
  serve.guard = [&d](const std::function<void()>& work) { d.gate.pass(work); };
  serve.host_options = [&d, &world] {
    host::HostOptions host;
    host.game = std::make_shared<host::Game>(host::Game{
        Watched<D>::declare(d.options, D::dimension),
        [&d, &world] { return std::make_unique<Watched<D>>(world, d.options); },
        [&d] { return d.paused; },
        [&d](bool paused) {
          d.paused = paused;
          d.steps = 0;
        },
        [&d](int count) { d.steps += count; },
    });
    return host;
  };
  core::Result<std::unique_ptr<server::Server>> started = server::Server::start(std::move(serve));
  if (!started.ok()) return started.error();
  self->server = std::move(started).value();
  if (options.say_where) {
    std::printf("carom: look at this game at %s\n", self->server->url().c_str());
    std::fflush(stdout);
  }
  return Debugger(std::move(self));
}

core::Result<Debugger> attach(rigid::World2& world, DebuggerOptions options) {
  return attach_to(world, std::move(options));
}
core::Result<Debugger> attach(rigid::World3& world, DebuggerOptions options) {
  return attach_to(world, std::move(options));
}

}  // namespace carom::debugger
