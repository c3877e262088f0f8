#include "apps/host/host.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "apps/host/debug_draw.h"
#include "apps/host/registry.h"
#include "apps/host/stress_demo.h"

namespace carom::host {

namespace {

using Json = nlohmann::json;

constexpr std::size_t max_waiting_samples = 4096;
constexpr double end_pause = 1.5;  // s

#if defined(__wasm__)
constexpr const char* engine_name = "wasm";
#else
constexpr const char* engine_name = "native";
#endif

/// A member of a JSON object, or null.
const Json* member(const Json& object, const char* name) {
  const auto found = object.find(name);
  return found == object.end() ? nullptr : &*found;
}

struct Field {
  core::Status status;
  void wrong(const char* name, const char* expected) {
    if (status.ok()) status = core::Error{std::string("field \"") + name + "\": expected " + expected};
  }
  double number(const Json& object, const char* name) {
    const Json* value = member(object, name);
    if (value && value->is_number()) {
      const double x = value->get<double>();
      if (math::is_finite(x)) return x;
    }
    wrong(name, "a finite number");
    return 0;
  }
  std::string text(const Json& object, const char* name) {
    const Json* value = member(object, name);
    if (value && value->is_string()) return value->get<std::string>();
    wrong(name, "a string");
    return {};
  }
  math::Vec3d vector(const Json& object, const char* name) {
    const Json* value = member(object, name);
    if (value && value->is_array() && value->size() == 3 && (*value)[0].is_number() && (*value)[1].is_number() &&
        (*value)[2].is_number()) {
      const math::Vec3d v{(*value)[0].get<double>(), (*value)[1].get<double>(), (*value)[2].get<double>()};
      if (math::is_finite(v) && math::length_squared(v) < 1e24) return v;
    }
    wrong(name, "three finite numbers");
    return {};
  }
  std::int64_t integer(const Json& object, const char* name, double low, double high) {
    const double x = number(object, name);
    if (!status.ok()) return 0;
    if (x >= low && x <= high && x == double(std::int64_t(x))) return std::int64_t(x);
    wrong(name, "a whole number in range");
    return 0;
  }
};

bool same(const BodyPlace& a, const BodyPlace& b) {
  return a.position == b.position && a.rotation == b.rotation && a.awake == b.awake;
}

}  // namespace

/// One function a message type; each returns what to tell the page when it cannot do it.
struct SimulationHost::Handlers {
  SimulationHost& host;
  const Json& m;
  Field field{};

  core::Status hello() {
    const double version = field.number(m, "protocol");
    if (!field.status.ok()) return field.status;
    if (version != protocol_version)
      return core::Error{"this host speaks protocol " + std::to_string(protocol_version) +
                         "; reload the page to get the one that belongs to it"};
    std::vector<Declaration> list;
    if (host.options_.game) {
      list.push_back(host.options_.game->declaration);
      host.greeted_ = true;
      host.send(welcome_message("game", list));
      return {};
    }
    for (const DemoFactory make : demos()) list.push_back(make()->declaration());
    for (const MenuScene& scene : host.options_.scenes) list.push_back(scene.summary);
    for (const std::unique_ptr<Demo>& demo : stress_demos()) list.push_back(demo->declaration());
    host.greeted_ = true;
    host.send(welcome_message(engine_name, list));
    return {};
  }

  core::Status open() {
    const std::string id = field.text(m, "demo");
    if (!field.status.ok()) return field.status;
    if (host.options_.game) {
      std::unique_ptr<Demo> game = host.options_.game->watch();
      Demo& watcher = *game;
      return host.open(watcher.open(std::move(game), {}, {host.options_.threads}));
    }
    std::unique_ptr<Demo> demo = make_demo(id);
    std::string name_of_scene, text_of_scene;
    for (const MenuScene& scene : host.options_.scenes) {
      if (demo || scene.summary.id != id) continue;
      core::Result<std::unique_ptr<Demo>> loaded = scene.load();
      if (!loaded.ok()) return loaded.error();
      demo = std::move(loaded).value();
      if (scene.text) name_of_scene = id.substr(id.find(':') + 1), text_of_scene = scene.text();
    }
    if (!demo) {
      std::vector<std::string> ids;
      for (const DemoFactory make : demos()) ids.push_back(make()->declaration().id);
      const std::string nearest = nearest_name(id, {ids.begin(), ids.end()});
      return core::Error{"no demo \"" + id.substr(0, 64) + "\"" +
                         (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?")};
    }
    const Declaration declaration = demo->declaration();
    std::vector<double> values;
    for (const Parameter& parameter : declaration.parameters) values.push_back(parameter.value);
    if (const Json* given = member(m, "parameters")) {
      if (!given->is_object()) return core::Error{"field \"parameters\": expected an object of numbers"};
      for (const auto& [name, value] : given->items()) {
        std::size_t i = 0;
        while (i < values.size() && declaration.parameters[i].name != name) ++i;
        if (i == values.size()) return core::Error{"demo " + id + " has no parameter \"" + name.substr(0, 64) + "\""};
        const Parameter& p = declaration.parameters[i];
        const double x = value.is_number() ? value.get<double>() : p.maximum + 1;
        if (!(x >= p.minimum && x <= p.maximum))
          return core::Error{"parameter " + p.name + ": expected a number from " + std::to_string(p.minimum) + " to " +
                             std::to_string(p.maximum) + " " + p.unit};
        values[i] = x;
      }
    }
    Demo& opener = *demo;
    const core::Status status = host.open(opener.open(std::move(demo), values, {host.options_.threads}));
    if (status.ok()) host.source_name_ = std::move(name_of_scene), host.source_text_ = std::move(text_of_scene);
    return status;
  }

  core::Status open_scene() {
    const std::string name = field.text(m, "name"), text = field.text(m, "text");
    if (!field.status.ok()) return field.status;
    if (!host.options_.parse_scene) return core::Error{"this host does not read scene files"};
    core::Result<std::unique_ptr<Demo>> demo = host.options_.parse_scene(name.substr(0, 256), text);
    if (!demo.ok()) return demo.error();
    std::unique_ptr<Demo> owner = std::move(demo).value();
    Demo& opener = *owner;
    const core::Status status = host.open(opener.open(std::move(owner), {}, {host.options_.threads}));
    if (status.ok()) host.source_name_ = name.substr(0, 256), host.source_text_ = text;
    return status;
  }

  core::Status source() {
    host.send(source_message(host.source_name_, host.source_text_));
    return {};
  }

  core::Status set() {
    const std::string name = field.text(m, "name");
    const double value = field.number(m, "value");
    if (!field.status.ok()) return field.status;
    const core::Result<bool> live = host.simulation_->set(name, value);
    if (!live.ok()) return live.error();
    if (*live) host.act([name, value](Simulation& s) { (void)s.set(name, value); });
    // A slider that is dragged sends many: one restart at the next advance is enough.
    if (!*live) host.restart_wanted_ = true;
    host.send(values_message(host.simulation_->declaration(), host.simulation_->values()));
    return {};
  }

  core::Status run() {
    if (host.options_.game) host.options_.game->pause(false);
    host.running_ = true;
    host.send_status();
    return {};
  }
  core::Status pause() {
    if (host.options_.game) host.options_.game->pause(true);
    host.running_ = false;
    host.send_status();
    return {};
  }
  core::Status restart() {
    host.restart_wanted_ = true;
    return {};
  }
  core::Status step() {
    const std::int64_t count = field.integer(m, "count", 1, 1000);
    const std::int64_t to = m.contains("to") ? field.integer(m, "to", 0, 9e15) : std::int64_t(9e15);
    if (!field.status.ok()) return field.status;
    if (host.running_) return core::Error{"step: the simulation runs; pause it first"};
    if (host.options_.game) {
      host.options_.game->step(int(count));
      return {};
    }
    if (host.restart_wanted_) host.restart();
    for (std::int64_t i = 0; i < count && std::int64_t(host.simulation_->step_count()) < to && host.step_once(); ++i) {
    }
    host.send_changes();
    host.frame_wanted_ = true;
    host.since_stats_ = host.options_.stats_interval;
    host.send_status();
    return {};
  }
  core::Status speed() {
    const double value = field.number(m, "value");
    if (!field.status.ok()) return field.status;
    if (!(value >= 0.05 && value <= 4)) return core::Error{"field \"value\": expected a speed from 0.05 to 4"};
    host.speed_ = value;
    host.clock_.set_rate(value);
    host.send_status();
    return {};
  }
  core::Status grab() {
    const std::int64_t pointer = field.integer(m, "pointer", -2147483648.0, 2147483647.0);
    const math::Vec3d origin = field.vector(m, "origin"), direction = field.vector(m, "direction");
    if (!field.status.ok()) return field.status;
    if (!(math::length_squared(direction) > 1e-12))
      return core::Error{"field \"direction\": expected a direction, found none"};
    const auto answer = std::make_shared<GrabAnswer>();
    host.act([answer, pointer, origin, direction](Simulation& s) { *answer = s.grab(pointer, origin, direction); });
    host.send(grabbed_message(pointer, *answer));
    return {};
  }
  core::Status drag() {
    const std::int64_t pointer = field.integer(m, "pointer", -2147483648.0, 2147483647.0);
    const math::Vec3d target = field.vector(m, "target");
    if (!field.status.ok()) return field.status;
    const auto status = std::make_shared<core::Status>();
    host.act([status, pointer, target](Simulation& s) { *status = s.drag(pointer, target); });
    return *status;
  }
  core::Status release() {
    const std::int64_t pointer = field.integer(m, "pointer", -2147483648.0, 2147483647.0);
    if (!field.status.ok()) return field.status;
    host.act([pointer](Simulation& s) { s.release(pointer); });
    return {};
  }
  core::Status input() {
    const std::string action = field.text(m, "action");
    const double value = field.number(m, "value");
    if (!field.status.ok()) return field.status;
    const auto status = std::make_shared<core::Status>();
    host.act([status, action, value](Simulation& s) { *status = s.input(action, value); });
    return *status;
  }
  core::Status seek() {
    const std::int64_t step = field.integer(m, "step", 0, 9e15);
    if (!field.status.ok()) return field.status;
    host.running_ = false;
    host.finish_recording();
    if (host.restart_wanted_) host.restart();
    if (host.simulation_->recorded()) {
      if (const core::Status shown = host.simulation_->show(std::uint64_t(step)); !shown.ok()) return shown;
      host.send_status();
      host.key_wanted_ = true;
      return {};
    }
    const core::Result<bool> another = host.history_.seek(host.simulation_, std::uint64_t(step));
    if (!another.ok()) {
      host.restart_wanted_ = true;  // half-way between two states is nowhere
      return another.error();
    }
    host.simulation_->set_layers(host.layers_);
    if (*another) host.send_scene();
    host.send_changes();
    host.send_status();
    host.key_wanted_ = true;
    return {};
  }
  core::Status record() {
    const Json* on = member(m, "on");
    if (!on || !on->is_boolean()) return core::Error{"field \"on\": expected true or false"};
    if (host.simulation_->recorded()) return core::Error{"record: this is a recording already"};
    if (!on->get<bool>()) {
      host.finish_recording();
      return {};
    }
    return host.recorder_ ? core::Status{} : host.start_recording();
  }
  core::Status spawn() {
    SpawnRequest request;
    const std::string form = field.text(m, "form");
    request.size = field.number(m, "size");
    request.density = field.number(m, "density");
    request.position = field.vector(m, "position");
    request.velocity = field.vector(m, "velocity");
    if (!field.status.ok()) return field.status;
    if (form != "ball" && form != "box" && form != "capsule")
      return core::Error{"field \"form\": expected ball, box or capsule"};
    request.form = form == "ball"  ? SpawnRequest::Form::ball
                   : form == "box" ? SpawnRequest::Form::box
                                   : SpawnRequest::Form::capsule;
    const auto status = std::make_shared<core::Status>();
    host.act([status, request](Simulation& s) { *status = s.spawn(request); });
    host.send_changes();
    host.frame_wanted_ = true;
    return *status;
  }
  core::Status probe() {
    const std::string kind = field.text(m, "kind");
    const math::Vec3d origin = field.vector(m, "origin"), direction = field.vector(m, "direction");
    const double radius = field.number(m, "radius");
    if (!field.status.ok()) return field.status;
    if (!(math::length_squared(direction) > 1e-12))
      return core::Error{"field \"direction\": expected a direction, found none"};
    if (kind != "ray" && kind != "sphere" && kind != "closest")
      return core::Error{"field \"kind\": expected ray, sphere or closest"};
    const ProbeKind asked = kind == "ray" ? ProbeKind::ray : kind == "sphere" ? ProbeKind::sphere : ProbeKind::closest;
    const core::Result<ProbeAnswer> answer = host.simulation_->probe(asked, origin, direction, radius);
    if (!answer.ok()) return answer.error();
    host.send(probed_message(kind, *answer));
    return {};
  }
  core::Status inspect() {
    const std::int64_t body = field.integer(m, "body", -1, 4294967295.0);
    if (!field.status.ok()) return field.status;
    host.inspected_ = body;
    host.send_inspection();
    return {};
  }
  core::Status draw() {
    const Json* layers = member(m, "layers");
    if (!layers || !layers->is_array()) return core::Error{"field \"layers\": expected a list of names"};
    std::uint32_t bits = 0;
    for (const Json& layer : *layers) {
      const auto known = std::find_if(std::begin(debug_layers), std::end(debug_layers),
                                      [&](const DebugLayer& one) { return layer.is_string() && layer == one.name; });
      if (known == std::end(debug_layers)) {
        std::string names;
        for (const DebugLayer& one : debug_layers) names += std::string(names.empty() ? "" : ", ") + one.name;
        return core::Error{"field \"layers\": expected names of " + names};
      }
      bits |= known->bit;
    }
    host.layers_ = bits;
    if (host.simulation_) host.simulation_->set_layers(bits);
    host.frame_wanted_ = host.simulation_ != nullptr;
    return {};
  }
  core::Status ack() {
    const std::int64_t sequence = field.integer(m, "sequence", 0, 4294967295.0);
    if (!field.status.ok()) return field.status;
    // Only what was sent can be acknowledged, and never backwards.
    const auto acknowledged = std::uint32_t(sequence);
    if (host.sequence_ - acknowledged <= host.sequence_ - host.acknowledged_) host.acknowledged_ = acknowledged;
    return {};
  }
};

SimulationHost::SimulationHost(HostOptions options) : options_(std::move(options)), history_(options_.history) {}
SimulationHost::~SimulationHost() = default;

void SimulationHost::receive(std::string_view text) {
  struct Entry {
    const char* type;
    core::Status (Handlers::*handle)();
    bool needs_simulation;
    bool of_the_clock = false;  ///< not for a world that somebody else steps
  };
  constexpr Entry entries[] = {
      {"hello", &Handlers::hello, false},    {"open", &Handlers::open, false},
      {"source", &Handlers::source, false},  {"open_scene", &Handlers::open_scene, false, true},
      {"set", &Handlers::set, true},         {"run", &Handlers::run, true},
      {"pause", &Handlers::pause, true},     {"restart", &Handlers::restart, true, true},
      {"step", &Handlers::step, true},       {"speed", &Handlers::speed, false, true},
      {"grab", &Handlers::grab, true},       {"drag", &Handlers::drag, true},
      {"release", &Handlers::release, true}, {"input", &Handlers::input, true},
      {"record", &Handlers::record, true},   {"seek", &Handlers::seek, true, true},
      {"spawn", &Handlers::spawn, true},     {"probe", &Handlers::probe, true},
      {"inspect", &Handlers::inspect, true}, {"draw", &Handlers::draw, false},
      {"ack", &Handlers::ack, false},
  };
  if (outbox_bytes_ >= options_.max_outbox) return;  // a page that does not read gets no more answers
  if (text.size() > options_.max_message)
    return complain("message of " + std::to_string(text.size()) + " bytes: expected at most " +
                    std::to_string(options_.max_message));
  const Json message = Json::parse(text.begin(), text.end(), nullptr, /*allow_exceptions=*/false);
  if (!message.is_object()) return complain("message: expected one JSON object");
  const Json* type = member(message, "type");
  if (!type || !type->is_string()) return complain("message: field \"type\": expected a string");
  const std::string& name = type->get_ref<const std::string&>();
  for (const Entry& entry : entries) {
    if (name != entry.type) continue;
    if (!greeted_ && name != "hello") return complain("send hello first");
    if (entry.needs_simulation && !simulation_) return complain(name + ": no demo is open");
    if (options_.game && entry.of_the_clock)
      return complain(name + ": the game keeps its own time; it can be paused and stepped");
    Handlers handlers{*this, message};
    const core::Status status = (handlers.*entry.handle)();
    if (!status.ok()) complain(status.error().message);
    return;
  }
  complain("message: unknown type \"" + name.substr(0, 64) + "\"");
}

void SimulationHost::receive_binary(std::string_view bytes) {
  if (outbox_bytes_ >= options_.max_outbox) return;
  if (!greeted_) return complain("send hello first");
  if (bytes.size() < 4 || bytes[0] != file_message_kind)
    return complain("binary message: expected a part of a recording (docs/protocol.md)");
  if (upload_.size() + bytes.size() > options_.max_recording) {
    upload_ = {};
    return complain("recording: expected at most " + std::to_string(options_.max_recording >> 20) + " MiB");
  }
  upload_.insert(upload_.end(), bytes.begin() + 4, bytes.end());
  if (bytes[1] == 0) return;  // more follows
  source_name_.clear(), source_text_.clear();
  const core::Status status = open(open_recording(std::exchange(upload_, {})));
  if (!status.ok()) complain(status.error().message);
}

core::Status SimulationHost::start_recording() {
  recorded_.clear();
  core::Result<scene::Recorder> made = scene::Recorder::open(
      [this](std::span<const std::uint8_t> bytes) -> core::Status {
        if (recorded_.size() + bytes.size() > options_.max_recording) return core::Error{"the recording is full"};
        recorded_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        return {};
      },
      recording_header(*simulation_));
  if (!made.ok()) return made.error();
  recorder_ = std::make_unique<scene::Recorder>(std::move(made).value());
  send_status();
  record();
  return {};
}

void SimulationHost::record() {
  // A step that is shown again, or bodies that the header does not know, end the recording rather than spoil it.
  capture_frame(*simulation_, simulation_->step_count() % 60 == 0, record_frame_);
  record_frame_.samples.clear();
  for (const Sample& s : simulation_->base().state.samples)
    record_frame_.samples.push_back({std::uint16_t(s.plot), std::uint16_t(s.series), s.x, s.y});
  if (const core::Status status = recorder_->add(record_frame_); !status.ok()) finish_recording();
}

void SimulationHost::finish_recording() {
  if (!recorder_) return;
  (void)recorder_->finish();
  recorder_.reset();
  std::string message{file_message_kind, 1, 0, 0};
  message += recorded_;
  recorded_.clear();
  send_binary(std::move(message));
  send_status();
}

void SimulationHost::complain(std::string_view message) { send(error_message(message)); }

core::Status SimulationHost::open(core::Result<std::unique_ptr<Simulation>> opened) {
  if (!opened.ok()) return opened.error();
  simulation_ = std::move(opened).value();
  const double dt = simulation_->declaration().dt;
  // Enough steps for four-fold speed at 30 frames a second.
  clock_ = ode::FixedClock(dt, int(math::clamp(4.0 / 30.0 / dt + 1.0, 4.0, 256.0)));
  running_ = true;
  recorder_.reset();
  send(simulation_->opened_text());
  begin();
  return {};
}

void SimulationHost::begin() {
  since_end_ = 0;
  clock_.reset();
  clock_.set_rate(speed_);
  simulation_->set_layers(layers_);
  if (!options_.game) history_.begin(*simulation_);
  shown_ = simulation_->step_count();
  inspected_ = -1;
  send(values_message(simulation_->declaration(), simulation_->values()));
  send_scene();
  samples_.clear();
  sent_.clear();
  surfaces_sent_.clear();
  real_window_ = simulated_window_ = 0;
  real_time_factor_ = 1;
  acknowledged_ = sequence_;  // the page starts afresh
  restart_wanted_ = false;
  send_status();
  frame(true);
}

void SimulationHost::send_scene() {
  std::vector<std::uint32_t> ignored_added, ignored_removed;
  simulation_->take_changes(ignored_added, ignored_removed);
  send(simulation_->scene_text());
  meshes_sent_ = 0;
  send_meshes();
}

void SimulationHost::act(History::Action action) {
  if (options_.game)
    action(*simulation_);
  else
    history_.act(*simulation_, std::move(action));
}

void SimulationHost::close() {
  if (simulation_) simulation_->release_all();
}

void SimulationHost::follow_game(double real_seconds) {
  const bool running = !options_.game->paused();
  if (std::exchange(running_, running) != running) send_status();
  if (simulation_->step_count() == shown_) return;
  simulated_window_ += double(simulation_->step_count() - shown_) * simulation_->declaration().dt;
  shown_ = simulation_->step_count();
  if ((real_window_ += real_seconds) > 0.5) {
    real_time_factor_ = simulated_window_ / real_window_;
    real_window_ = simulated_window_ = 0;
  }
  if (const core::Status status = simulation_->step(); !status.ok()) return complain(status.error().message);
  if (recorder_) record();
  frame_wanted_ = true;
  if (!running) {
    since_stats_ = options_.stats_interval;
    send_status();
  }
}

void SimulationHost::send_inspection() {
  if (inspected_ < 0) return;
  const std::string report = simulation_->inspect(std::uint32_t(inspected_));
  if (report.empty()) inspected_ = -1;
  send(inspected_message(report));
}

void SimulationHost::restart() {
  restart_wanted_ = false;
  finish_recording();
  core::Result<std::unique_ptr<Simulation>> fresh = simulation_->reopen(simulation_->values());
  if (!fresh.ok()) {
    running_ = false;
    complain(fresh.error().message);
    send_status();
    return;
  }
  simulation_ = std::move(fresh).value();
  begin();
}

bool SimulationHost::step_once() {
  if (const auto recorded = simulation_->recorded(); recorded && simulation_->step_count() >= recorded->last) {
    running_ = false;
    send_status();
    return false;
  }
  // From a step of the past the run goes on as its own, without the fingers that held then.
  if (history_.branch(*simulation_)) history_.act(*simulation_, [](Simulation& s) { s.release_all(); });
  const core::Status status = simulation_->step();
  if (!status.ok()) {
    running_ = false;
    complain("the simulation stopped: " + status.error().message);
    send_status();
    return false;
  }
  if (!simulation_->recorded()) history_.stepped(*simulation_);
  if (recorder_) record();
  StageBase::State& state = simulation_->base().state;
  samples_.insert(samples_.end(), state.samples.begin(), state.samples.end());
  state.samples.clear();
  if (samples_.size() > max_waiting_samples) {
    // The carrier is slow: keep every second sample, so that the curve stays whole.
    std::size_t kept = 0;
    for (std::size_t i = 0; i < samples_.size(); i += 2) samples_[kept++] = samples_[i];
    samples_.resize(kept);
  }
  simulated_window_ += simulation_->declaration().dt;
  return true;
}

bool SimulationHost::at_end() const {
  const Declaration& d = simulation_->declaration();
  return d.loop && simulation_->time() + 0.5 * d.dt >= d.duration;
}

void SimulationHost::advance(double real_seconds) {
  if (!simulation_ || !(real_seconds >= 0) || !math::is_finite(real_seconds)) return;
  if (restart_wanted_) restart();
  since_key_ += real_seconds;
  since_stats_ += real_seconds;
  // What loops shows its last picture for a moment.
  if (!options_.game && running_ && at_end() && (since_end_ += real_seconds) > end_pause) restart();
  if (options_.game) {
    follow_game(real_seconds);
    send_changes();
  } else if (running_ && !at_end()) {
    real_window_ += real_seconds;
    const ode::Frame due = clock_.advance(real_seconds);
    double spent = 0;
    for (int i = 0; i < due.steps; ++i) {
      if (at_end() || !step_once()) break;
      frame_wanted_ = true;
      // A scene heavier than the machine slows down instead of freezing the picture.
      spent += simulation_->profile().total;
      if (spent > 40) break;
    }
    if (real_window_ > 0.5) {
      real_time_factor_ = simulated_window_ / real_window_;
      real_window_ = simulated_window_ = 0;
    }
    send_changes();
  }
  const bool stale = since_key_ >= options_.key_interval && running_;
  // Two frames may be under way; the third waits for an acknowledgement.
  if ((frame_wanted_ || key_wanted_ || stale) && sequence_ - acknowledged_ < 2 && outbox_bytes_ < options_.max_outbox)
    frame(key_wanted_ || stale);
}

void SimulationHost::send_changes() {
  StageBase::State& state = simulation_->base().state;
  std::vector<std::uint32_t> added, removed;
  if (simulation_->take_changes(added, removed)) {
    finish_recording();  // its header names the bodies
    std::vector<BodyView> views;
    if (!added.empty()) simulation_->describe(&added, views);
    send_meshes();
    send(bodies_message(views, removed));
  }
  if (state.values_changed) {
    state.values_changed = false;
    send(values_message(simulation_->declaration(), state.values));
  }
  if (state.message_changed) {
    state.message_changed = false;
    send_status();
  }
}

void SimulationHost::send_meshes() {
  const std::vector<Mesh>& meshes = simulation_->meshes().meshes();
  for (; meshes_sent_ < meshes.size(); ++meshes_sent_)
    send_binary(mesh_message(std::uint32_t(meshes_sent_), meshes[meshes_sent_]));
}

void SimulationHost::send_drawn(bool key) {
  const StageBase::State& state = simulation_->base().state;
  // An empty message takes the last points away.
  if (!state.points.positions.empty() || points_sent_) send_binary(points_message(state.points));
  points_sent_ = !state.points.positions.empty();
  surfaces_sent_.resize(state.surfaces.size());
  for (std::size_t i = 0; i < state.surfaces.size(); ++i) {
    const Surface& surface = state.surfaces[i];
    if (surface.corners.empty()) continue;
    send_binary(surface_message(std::uint32_t(i), surface, key || surfaces_sent_[i] != surface.topology));
    surfaces_sent_[i] = surface.topology;
  }
}

void SimulationHost::send_status() {
  StatusFields fields{running_, speed_};
  if (simulation_) {
    fields.time = simulation_->time();
    fields.step = simulation_->step_count();
    const std::optional<StepRange> recorded = simulation_->recorded();
    fields.first = options_.game ? fields.step : recorded ? recorded->first : history_.first();
    fields.last = options_.game ? fields.step : recorded ? recorded->last : history_.last();
    fields.recording = recorder_ != nullptr;
    fields.message = simulation_->base().state.message;
    simulation_->base().state.message_changed = false;
  }
  send(status_message(fields));
}

void SimulationHost::frame(bool key) {
  simulation_->places(now_);
  moved_.clear();
  if (key) {
    moved_ = now_;
  } else {
    // Both lists are in creation order, so identical ids meet.
    std::size_t j = 0;
    for (const BodyPlace& place : now_) {
      while (j < sent_.size() && sent_[j].id < place.id) ++j;
      if (j >= sent_.size() || sent_[j].id != place.id || !same(sent_[j], place)) moved_.push_back(place);
    }
  }
  FrameFields fields;
  fields.key = key;
  fields.dimension = simulation_->declaration().dimension;
  fields.sequence = ++sequence_;
  fields.step = std::uint32_t(simulation_->step_count());
  fields.time = simulation_->time();
  fields.origin = simulation_->declaration().camera.target;
  const int follow = simulation_->declaration().camera.follow;
  for (const BodyPlace& place : now_)
    if (follow >= 0 && place.id == std::uint32_t(follow)) fields.origin = place.position;
  fields.bodies = moved_;
  fields.samples = samples_;
  simulation_->lines(lines_);
  fields.lines = lines_;
  FrameStats stats;
  if (key || since_stats_ >= options_.stats_interval) {
    const rigid::Counters counters = simulation_->counters();
    const Budget budget = simulation_->budget();
    stats = {std::uint32_t(counters.bodies),
             std::uint32_t(counters.awake_bodies),
             std::uint32_t(counters.touching_contacts),
             std::uint32_t(counters.joints),
             std::uint32_t(counters.islands),
             std::uint32_t(simulation_->threads()),
             float(simulation_->profile().total),
             float(real_time_factor_),
             budget.kinetic,
             budget.potential,
             simulation_->state_hash(),
             simulation_->worst_penetration()};
    fields.stats = &stats;
    since_stats_ = 0;
    send(numbers_message({simulation_->profile(), budget, simulation_->arrows(), simulation_->hand_force(),
                          simulation_->worst_joint_error(), counters.bytes}));
    send_inspection();
  }
  send_drawn(key);
  send_binary(frame_message(fields));
  samples_.clear();
  std::swap(sent_, now_);
  key_wanted_ = frame_wanted_ = false;
  if (key) since_key_ = 0;
}

void SimulationHost::send(std::string text) {
  if (outbox_bytes_ + text.size() > options_.max_outbox) return;
  outbox_bytes_ += text.size() + sizeof(Message);
  outbox_.push_back({true, std::move(text)});
}

void SimulationHost::send_binary(std::string bytes) {
  outbox_bytes_ += bytes.size() + sizeof(Message);
  outbox_.push_back({false, std::move(bytes)});
}

bool SimulationHost::take(Message& message) {
  if (outbox_.empty()) return false;
  message = std::move(outbox_.front());
  outbox_.pop_front();
  outbox_bytes_ -= message.data.size() + sizeof(Message);
  return true;
}

}  // namespace carom::host
