#include "apps/host/playback.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "apps/host/messages.h"
#include "apps/host/read_views.h"

namespace carom::host {

namespace {

using Json = nlohmann::json;

const core::Error only_shown{"this is a recording: it can be looked at, not changed; open the demo to take part"};

class Playback final : public Simulation {
 public:
  Playback(Declaration declaration, std::shared_ptr<scene::Recording> recording, StepRange range,
           std::vector<BodyView> views, std::vector<std::uint32_t> first_ids, MeshLibrary meshes)
      : Simulation(std::move(declaration)),
        recording_(std::move(recording)),
        stage_(declaration_, {}),
        range_(range),
        views_(std::move(views)),
        first_ids_(std::move(first_ids)),
        shown_(first_ids_) {
    base_ = &stage_;
    meshes_ = std::move(meshes);
  }

  core::Status show_frame(std::size_t index) {
    core::Result<scene::RecordedFrame> frame = recording_->frame(index);
    if (!frame.ok()) return frame.error();
    frame_ = std::move(frame).value();
    index_ = index;
    if (frame_.has_hash) hash_ = frame_.state_hash;
    show_picture();
    for (const scene::RecordedSample& s : frame_.samples) stage_.sample(s.plot, s.series, s.x, s.y);
    return {};
  }

  core::Status step() override {
    if (index_ + 1 >= recording_->frame_count()) return {};
    return show_frame(index_ + 1);
  }
  double time() const override { return frame_.time; }
  std::uint64_t step_count() const override { return frame_.step; }

  std::optional<StepRange> recorded() const override { return range_; }
  core::Status show(std::uint64_t step) override {
    const core::Status status = show_frame(recording_->index_at_step(step));
    stage_.state.samples.clear();
    return status;
  }
  std::string opened_text() const override { return recording_->header().declaration; }
  std::shared_ptr<scene::Recording> recording() const override { return recording_; }
  std::string scene_text() override {
    shown_ = first_ids_;
    return recording_->header().scene;
  }

  GrabAnswer grab(std::int64_t, math::Vec3d, math::Vec3d) override { return {}; }
  core::Status drag(std::int64_t, math::Vec3d) override { return only_shown; }
  void release(std::int64_t) override {}
  void release_all() override {}
  double hand_force() const override { return 0; }
  core::Status spawn(const SpawnRequest&) override { return only_shown; }
  core::Result<ProbeAnswer> probe(ProbeKind, math::Vec3d, math::Vec3d, double) override { return only_shown; }
  std::string inspect(std::uint32_t) override { return {}; }
  ArrowScale arrows() const override { return {1, 1, 1}; }
  std::unique_ptr<Memento> save() override { return nullptr; }
  core::Status restore(const Memento&) override { return only_shown; }

  std::size_t body_count() const override { return frame_.bodies.size(); }
  void places(std::vector<BodyPlace>& out) const override {
    out.clear();
    for (const scene::RecordedBody& b : frame_.bodies) out.push_back({b.id, b.position, b.rotation, !b.asleep});
  }
  /// The bodies that are there now, where they are now.
  void describe(const std::vector<std::uint32_t>* only, std::vector<BodyView>& out) override {
    std::size_t at = 0;
    for (const scene::RecordedBody& b : frame_.bodies) {
      if (only && std::find(only->begin(), only->end(), b.id) == only->end()) continue;
      while (at < views_.size() && views_[at].id < b.id) ++at;
      if (at == views_.size() || views_[at].id != b.id) continue;
      out.push_back(views_[at]);
      out.back().position = b.position;
      out.back().rotation = b.rotation;
    }
  }
  void lines(std::vector<Line>& out) const override {
    out.clear();
    for (const scene::RecordedLine& line : frame_.picture.lines) out.push_back({line.a, line.b, line.rgba});
  }
  /// Bodies come and go as frames are shown, in whatever order.
  bool take_changes(std::vector<std::uint32_t>& added, std::vector<std::uint32_t>& removed) override {
    std::vector<std::uint32_t> now;
    for (const scene::RecordedBody& b : frame_.bodies) now.push_back(b.id);
    std::set_difference(now.begin(), now.end(), shown_.begin(), shown_.end(), std::back_inserter(added));
    std::set_difference(shown_.begin(), shown_.end(), now.begin(), now.end(), std::back_inserter(removed));
    shown_ = std::move(now);
    return !added.empty() || !removed.empty();
  }

  rigid::Counters counters() const override {
    rigid::Counters counters;
    counters.bodies = int(frame_.bodies.size());
    for (const scene::RecordedBody& b : frame_.bodies) counters.awake_bodies += !b.asleep;
    return counters;
  }
  rigid::StepProfile profile() const override { return {}; }
  Budget budget() const override { return {}; }
  double worst_penetration() const override { return 0; }
  double worst_joint_error() const override { return 0; }
  std::uint64_t state_hash() const override { return hash_; }
  int threads() const override { return 0; }
  core::Result<std::unique_ptr<Simulation>> reopen(const std::vector<double>&) const override {
    auto again = std::make_unique<Playback>(declaration_, recording_, range_, views_, first_ids_, meshes_);
    if (const core::Status status = again->show_frame(0); !status.ok()) return status.error();
    return std::unique_ptr<Simulation>(std::move(again));
  }
  void expectations(std::vector<Expectation>&) override {}

 private:
  class Silent final : public StageBase {
   public:
    using StageBase::StageBase;
  };
  void changed(std::string_view) override {}
  void show_picture() {
    StageBase::State& state = stage_.state;
    const scene::RecordedPicture& picture = frame_.picture;
    state.points = {picture.points, picture.radii, picture.point_rgbas};
    state.surfaces.resize(picture.surfaces.size());
    for (std::size_t i = 0; i < picture.surfaces.size(); ++i) {
      const scene::RecordedSurface& from = picture.surfaces[i];
      Surface& to = state.surfaces[i];
      if (to.triangles != from.triangles || to.rgba != from.rgba) to.triangles = from.triangles, ++to.topology;
      to.corners = from.corners;
      to.rgba = from.rgba;
    }
    state.values_changed = state.values_changed || state.values != frame_.values;
    if (frame_.values.size() == declaration_.parameters.size()) state.values = frame_.values;
    if (!recording_->complete())
      stage_.say("recording, not whole: " + recording_->damage());
    else
      stage_.say(frame_.message.empty() ? "recording" : frame_.message);
  }

  std::shared_ptr<scene::Recording> recording_;
  Silent stage_;
  StepRange range_;
  std::vector<BodyView> views_;           ///< of all bodies that ever come, by rising id
  std::vector<std::uint32_t> first_ids_;  ///< of the header's bodies
  std::vector<std::uint32_t> shown_;      ///< what who looks knows of
  scene::RecordedFrame frame_;
  std::size_t index_ = 0;
  std::uint64_t hash_ = 0;
};

/// What of the recorded declaration this side needs; the page reads the rest from the text itself.
core::Result<Declaration> read_declaration(const scene::RecordingHeader& header) {
  const Json opened = Json::parse(header.declaration, nullptr, /*allow_exceptions=*/false);
  if (!opened.is_object() || opened.value("type", Json()) != "opened")
    return core::Error{"recording: the header holds no declaration, expected the `opened` message of docs/protocol.md"};
  Declaration d;
  d.id = "recording";
  d.title = opened.contains("title") && opened["title"].is_string() ? opened["title"].get<std::string>() : header.name;
  d.dimension = header.dimension;
  d.dt = header.dt;
  read_camera(header.declaration, d.camera);
  // Their names are enough to show how they were set.
  if (opened.contains("parameters") && opened["parameters"].is_array())
    for (const Json& p : opened["parameters"])
      if (p.is_object() && p.contains("name") && p["name"].is_string())
        d.parameters.push_back(
            {.name = p["name"].get<std::string>(), .label = {}, .unit = {}, .display_unit = {}, .description = {}});
  return d;
}

}  // namespace

core::Result<std::unique_ptr<Simulation>> open_recording(std::vector<std::uint8_t> bytes) {
  core::Result<scene::Recording> opened = scene::Recording::from_bytes(std::move(bytes));
  if (!opened.ok()) return opened.error();
  auto recording = std::make_shared<scene::Recording>(std::move(opened).value());
  if (recording->frame_count() == 0)
    return core::Error{"recording: found no whole frame" +
                       (recording->damage().empty() ? std::string() : "; " + recording->damage())};
  core::Result<Declaration> declaration = read_declaration(recording->header());
  if (!declaration.ok()) return declaration.error();
  std::size_t mesh_count = recording->header().meshes.size();
  core::Result<SceneViews> views = read_scene(recording->header().scene, mesh_count);
  if (!views.ok()) return core::Error{"recording: " + views.error().message};
  std::vector<std::uint32_t> first_ids;
  for (const BodyView& body : views->bodies) first_ids.push_back(body.id);
  std::sort(first_ids.begin(), first_ids.end());
  MeshLibrary meshes;
  const auto keep_meshes = [&meshes](const std::vector<std::string>& texts) -> core::Status {
    for (const std::string& text : texts) {
      core::Result<Mesh> mesh = read_mesh(text);
      if (!mesh.ok()) return core::Error{"recording: " + mesh.error().message};
      meshes.add(std::move(mesh).value());
    }
    return {};
  };
  if (const core::Status kept = keep_meshes(recording->header().meshes); !kept.ok()) return kept.error();
  for (const scene::RecordedArrival& arrival : recording->arrivals()) {
    mesh_count += arrival.meshes.size();
    core::Result<std::vector<BodyView>> come = read_arrivals(arrival.bodies, mesh_count);
    if (!come.ok()) return core::Error{"recording: " + come.error().message};
    views->bodies.insert(views->bodies.end(), std::make_move_iterator(come->begin()),
                         std::make_move_iterator(come->end()));
    if (const core::Status kept = keep_meshes(arrival.meshes); !kept.ok()) return kept.error();
  }
  std::sort(views->bodies.begin(), views->bodies.end(),
            [](const BodyView& a, const BodyView& b) { return a.id < b.id; });
  declaration->ground = views->ground;
  const core::Result<scene::RecordedFrame> last = recording->frame(recording->frame_count() - 1);
  if (!last.ok()) return last.error();
  const std::uint64_t end = last->step;
  const core::Result<scene::RecordedFrame> first = recording->frame(0);
  if (!first.ok()) return first.error();
  // A frame is a step of a player, however many steps of the run lie between two of them.
  if (recording->frame_count() > 1)
    declaration->dt = (recording->last_time() - recording->first_time()) / double(recording->frame_count() - 1);
  if (!(declaration->dt > 0)) declaration->dt = recording->header().dt;
  auto playback = std::make_unique<Playback>(std::move(declaration).value(), recording, StepRange{first->step, end},
                                             std::move(views->bodies), std::move(first_ids), std::move(meshes));
  if (const core::Status status = playback->show_frame(0); !status.ok()) return status.error();
  return std::unique_ptr<Simulation>(std::move(playback));
}

}  // namespace carom::host
