#include "apps/host/run_recorder.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>

#include "apps/host/message_fields.h"
#include "apps/host/messages.h"
#include "carom/carom.h"

namespace carom::host {

namespace {

using Json = nlohmann::json;

#if defined(__wasm__)
constexpr const char* engine_name = "wasm";
#else
constexpr const char* engine_name = "native";
#endif

std::string json_text(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

Json json_of(const DeedAtStep& done) { return {{"step", done.step}, {"action", deed_json(done.deed)}}; }

core::Result<DeedAtStep> read_done(const Json& json) {
  if (!json.is_object()) return core::Error{"action: expected an object"};
  MessageFields field(json);
  const std::int64_t step = field.integer("step", 0, 9e15);
  if (!field.status.ok()) return core::Error{"action: " + field.status.error().message};
  const Json* action = member(json, "action");
  if (action == nullptr || !action->is_object()) return core::Error{"action: field \"action\": expected an object"};
  core::Result<Deed> deed = read_deed(*action);
  if (!deed.ok()) return core::Error{"action: " + deed.error().message};
  return DeedAtStep{std::uint64_t(step), std::move(deed).value()};
}

}  // namespace

OriginText this_build() {
  OriginText out;
  out.version = CAROM_VERSION_STRING;
  out.engine = engine_name;
#if defined(__clang__)
  out.compiler = "clang " + std::to_string(__clang_major__) + "." + std::to_string(__clang_minor__);
#elif defined(__GNUC__)
  out.compiler = "gcc " + std::to_string(__GNUC__) + "." + std::to_string(__GNUC_MINOR__);
#endif
  return out;
}

scene::RecordingHeader recording_header(Simulation& simulation, const Origin& origin) {
  const Declaration& d = simulation.declaration();
  scene::RecordingHeader header;
  header.name = d.id;
  header.dt = d.dt;
  header.dimension = d.dimension;
  header.scene = simulation.scene_text();
  header.declaration = simulation.opened_text();
  const std::vector<Mesh>& meshes = simulation.meshes().meshes();
  for (std::size_t i = 0; i < meshes.size(); ++i) header.meshes.push_back(mesh_message(std::uint32_t(i), meshes[i]));
  if (!origin.runs_again) return header;
  header.files = simulation.files();
  const OriginText build = this_build();
  Json values = Json::object(), past = Json::array();
  for (std::size_t i = 0; i < d.parameters.size() && i < origin.values.size(); ++i)
    values[d.parameters[i].name] = origin.values[i];
  for (const DeedAtStep& done : origin.past) past.push_back(json_of(done));
  header.origin = json_text({{"demo", d.id},
                             {"version", build.version},
                             {"engine", build.engine},
                             {"compiler", build.compiler},
                             {"values", std::move(values)},
                             {"past", std::move(past)}});
  return header;
}

core::Result<OriginText> read_origin(const std::string& text) {
  const Json json = Json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!json.is_object()) return core::Error{"origin: expected a JSON object"};
  MessageFields field(json);
  OriginText out;
  out.demo = field.text("demo");
  out.version = field.text("version");
  out.engine = field.text("engine");
  out.compiler = field.text("compiler");
  const Json *values = member(json, "values"), *past = member(json, "past");
  if (values == nullptr || !values->is_object()) field.wrong("values", "an object of numbers");
  if (past == nullptr || !past->is_array()) field.wrong("past", "a list of actions");
  if (!field.status.ok()) return core::Error{"origin: " + field.status.error().message};
  for (const auto& [name, value] : values->items()) {
    if (!value.is_number()) return core::Error{"origin: value of \"" + name.substr(0, 64) + "\": expected a number"};
    out.values.push_back({name, value.get<double>()});
  }
  for (const Json& entry : *past) {
    core::Result<DeedAtStep> done = read_done(entry);
    if (!done.ok()) return core::Error{"origin: " + done.error().message};
    out.past.push_back(std::move(done).value());
  }
  return out;
}

core::Result<DeedAtStep> read_deed_at_step(const std::string& text) {
  return read_done(Json::parse(text, nullptr, /*allow_exceptions=*/false));
}

RunRecorder::RunRecorder(scene::Recorder recorder, Simulation& simulation) : recorder_(std::move(recorder)) {
  simulation.places(places_);
  for (const BodyPlace& place : places_) known_.push_back(place.id);
  std::sort(known_.begin(), known_.end());
  meshes_known_ = simulation.meshes().meshes().size();
}

void RunRecorder::note(const DeedAtStep& deed) { frame_.actions.push_back(json_text(json_of(deed))); }

core::Status RunRecorder::introduce(Simulation& simulation) {
  std::vector<std::uint32_t> fresh;
  for (const BodyPlace& place : places_)
    if (!std::binary_search(known_.begin(), known_.end(), place.id)) fresh.push_back(place.id);
  if (fresh.empty()) return {};
  std::vector<BodyView> views;
  simulation.describe(&fresh, views);
  scene::RecordedArrival arrival;
  arrival.bodies = bodies_message(views, {});
  const std::vector<Mesh>& meshes = simulation.meshes().meshes();
  for (; meshes_known_ < meshes.size(); ++meshes_known_)
    arrival.meshes.push_back(mesh_message(std::uint32_t(meshes_known_), meshes[meshes_known_]));
  known_.insert(known_.end(), fresh.begin(), fresh.end());
  std::sort(known_.begin(), known_.end());
  return recorder_.introduce(arrival);
}

core::Status RunRecorder::add(Simulation& simulation, std::span<const Sample> samples) {
  simulation.places(places_);
  // A body that is drawn anew has a new id, in its old place.
  std::sort(places_.begin(), places_.end(), [](const BodyPlace& a, const BodyPlace& b) { return a.id < b.id; });
  if (const core::Status told = introduce(simulation); !told.ok()) return told;
  frame_.step = simulation.step_count();
  frame_.time = simulation.time();
  frame_.has_hash = frames_++ % hash_interval == 0;
  frame_.state_hash = frame_.has_hash ? simulation.state_hash() : 0;
  frame_.bodies.clear();
  for (const BodyPlace& p : places_) frame_.bodies.push_back({p.id, !p.awake, p.position, p.rotation});
  frame_.samples.clear();
  for (const Sample& s : samples) frame_.samples.push_back({std::uint16_t(s.plot), std::uint16_t(s.series), s.x, s.y});
  const StageBase::State& state = simulation.base().state;
  frame_.message = state.message;
  frame_.values = state.values;
  scene::RecordedPicture& picture = frame_.picture;
  simulation.lines(lines_);
  picture.lines.clear();
  for (const Line& line : lines_) picture.lines.push_back({line.a, line.b, line.rgba});
  picture.points = state.points.positions;
  picture.radii = state.points.radii;
  picture.point_rgbas = state.points.rgbas;
  picture.surfaces.resize(state.surfaces.size());
  for (std::size_t i = 0; i < state.surfaces.size(); ++i) {
    const Surface& surface = state.surfaces[i];
    // Until its corners are known a surface has no triangles to show.
    picture.surfaces[i] = surface.corners.empty()
                              ? scene::RecordedSurface{}
                              : scene::RecordedSurface{surface.corners, surface.triangles, surface.rgba};
  }
  const core::Status status = recorder_.add(frame_);
  frame_.actions.clear();
  return status;
}

}  // namespace carom::host
