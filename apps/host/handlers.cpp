// What a page's messages ask of a host (docs/protocol.md), one function a type.
#include <algorithm>

#include "apps/host/debug_draw.h"
#include "apps/host/host.h"
#include "apps/host/message_fields.h"
#include "apps/host/registry.h"
#include "apps/host/stress_demo.h"

namespace carom::host {

using Json = nlohmann::json;

/// One function a message type; each returns what to tell the page when it cannot do it.
struct SimulationHost::Handlers {
  SimulationHost& host;
  const Json& m;
  MessageFields field{m};

  core::Status hello() {
    const double version = field.number("protocol");
    if (!field.status.ok()) return field.status;
    if (version != protocol_version)
      return core::Error{"this host speaks protocol " + std::to_string(protocol_version) +
                         "; reload the page to get the one that belongs to it"};
    host.greeted_ = true;
    if (host.options_.game)
      host.send(welcome_message("game", menu_json({&host.options_.game->declaration, 1})));
    else
      host.send(welcome_message(this_build().engine.c_str(), host.options_.menu.empty() ? menu() : host.options_.menu));
    return {};
  }

  /// All that can be opened, each asked what it declares.
  std::string menu() const {
    std::vector<Declaration> list;
    for (const DemoEntry& demo : demos()) list.push_back(demo.make()->declaration());
    for (const MenuScene& scene : host.options_.scenes) list.push_back(scene.summary);
    for (const std::unique_ptr<Demo>& demo : stress_demos()) list.push_back(demo->declaration());
    return menu_json(list);
  }

  core::Status open() {
    const std::string id = field.text("demo");
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
      std::vector<std::string_view> ids;
      for (const DemoEntry& one : demos()) ids.push_back(one.id);
      const std::string nearest = nearest_name(id, ids);
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
    const std::string name = field.text("name"), text = field.text("text");
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
    if (!host.source_text_.empty() || host.options_.game) {
      host.send(source_message(host.source_name_, host.source_text_, false));
      return {};
    }
    const core::Result<std::string> written = host.simulation_->scene_file();
    if (!written.ok()) return written.error();
    host.send(source_message(host.simulation_->declaration().id, *written, true));
    return {};
  }

  /// What is done to the run itself: set, input, grab, drag, release, spawn.
  core::Status deed() {
    const core::Result<Deed> read = read_deed(m);
    if (!read.ok()) return read.error();
    if (host.simulation_->recorded() && read->kind == Deed::Kind::set)
      return core::Error{"set: this is a recording; what it shows was set when it was made"};
    const DeedOutcome outcome = host.act(*read);
    if (!outcome.status.ok()) return outcome.status;
    switch (read->kind) {
      case Deed::Kind::set:
        // A slider that is dragged sends many: one restart at the next advance is enough.
        if (!outcome.live) host.restart_wanted_ = true;
        host.send(values_message(host.simulation_->declaration(), host.simulation_->values()));
        break;
      case Deed::Kind::grab:
        host.send(grabbed_message(read->pointer, outcome.grabbed));
        break;
      case Deed::Kind::spawn:
        host.send_changes();
        host.frame_wanted_ = true;
        break;
      default:
        break;
    }
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
    if (host.restart_wanted_) host.restart();  // the page is told of the step at which it will be paused
    host.send_status();
    return {};
  }
  core::Status restart() {
    host.restart_wanted_ = true;
    return {};
  }
  core::Status step() {
    const std::int64_t count = field.integer("count", 1, 1000);
    const std::int64_t to = m.contains("to") ? field.integer("to", 0, 9e15) : std::int64_t(9e15);
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
    const double value = field.number("value");
    if (!field.status.ok()) return field.status;
    if (!(value >= 0.05 && value <= 4)) return core::Error{"field \"value\": expected a speed from 0.05 to 4"};
    host.speed_ = value;
    host.clock_.set_rate(value);
    host.send_status();
    return {};
  }
  core::Status seek() {
    const std::int64_t step = field.integer("step", 0, 9e15);
    if (!field.status.ok()) return field.status;
    host.running_ = false;
    host.finish_recording();
    if (host.restart_wanted_) host.restart();
    if (host.simulation_->recorded()) {
      if (const core::Status shown = host.simulation_->show(std::uint64_t(step)); !shown.ok()) return shown;
      host.send_changes();
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
    const bool on = field.flag("on");
    if (!field.status.ok()) return field.status;
    if (host.simulation_->recorded()) return core::Error{"record: this is a recording already"};
    if (!on) {
      host.finish_recording();
      return {};
    }
    return host.recorder_ ? core::Status{} : host.start_recording();
  }
  core::Status verify() { return host.start_replay(); }
  core::Status probe() {
    const std::string kind = field.text("kind");
    const math::Vec3d origin = field.vector("origin"), direction = field.direction("direction");
    const double radius = field.number("radius");
    if (!field.status.ok()) return field.status;
    if (kind != "ray" && kind != "sphere" && kind != "closest")
      return core::Error{"field \"kind\": expected ray, sphere or closest"};
    const ProbeKind asked = kind == "ray" ? ProbeKind::ray : kind == "sphere" ? ProbeKind::sphere : ProbeKind::closest;
    const core::Result<ProbeAnswer> answer = host.simulation_->probe(asked, origin, direction, radius);
    if (!answer.ok()) return answer.error();
    host.send(probed_message(kind, *answer));
    return {};
  }
  core::Status inspect() {
    const std::int64_t body = field.integer("body", -1, 4294967295.0);
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
    const std::int64_t sequence = field.integer("sequence", 0, 4294967295.0);
    if (!field.status.ok()) return field.status;
    // Only what was sent can be acknowledged, and never backwards.
    const auto acknowledged = std::uint32_t(sequence);
    if (host.sequence_ - acknowledged <= host.sequence_ - host.acknowledged_) host.acknowledged_ = acknowledged;
    return {};
  }
};

void SimulationHost::receive(std::string_view text) {
  struct Entry {
    const char* type;
    core::Status (Handlers::*handle)();
    bool needs_simulation;
    bool of_the_clock = false;  ///< not for a world that somebody else steps
  };
  constexpr Entry entries[] = {
      {"hello", &Handlers::hello, false},
      {"open", &Handlers::open, false},
      {"source", &Handlers::source, false},
      {"open_scene", &Handlers::open_scene, false, true},
      {"run", &Handlers::run, true},
      {"pause", &Handlers::pause, true},
      {"restart", &Handlers::restart, true, true},
      {"step", &Handlers::step, true},
      {"speed", &Handlers::speed, false, true},
      {"record", &Handlers::record, true},
      {"verify", &Handlers::verify, true, true},
      {"seek", &Handlers::seek, true, true},
      {"probe", &Handlers::probe, true},
      {"inspect", &Handlers::inspect, true},
      {"draw", &Handlers::draw, false},
      {"ack", &Handlers::ack, false},
      {"set", &Handlers::deed, true},
      {"input", &Handlers::deed, true},
      {"grab", &Handlers::deed, true},
      {"drag", &Handlers::deed, true},
      {"release", &Handlers::deed, true},
      {"spawn", &Handlers::deed, true},
  };
  // A page that does not read gets no more answers. What it has read counts all the same: the next picture waits for
  // it.
  const bool full = outbox_bytes_ >= options_.max_outbox;
  text_lost_ = text_lost_ || full;
  if (full && text.size() > 128) return;
  if (text.size() > options_.max_message)
    return complain("message of " + std::to_string(text.size()) + " bytes: expected at most " +
                    std::to_string(options_.max_message));
  const Json message = Json::parse(text.begin(), text.end(), nullptr, /*allow_exceptions=*/false);
  if (!message.is_object()) return complain("message: expected one JSON object");
  const Json* type = member(message, "type");
  if (!type || !type->is_string()) return complain("message: field \"type\": expected a string");
  const std::string& name = type->get_ref<const std::string&>();
  if (full && name != "ack") return;
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

}  // namespace carom::host
