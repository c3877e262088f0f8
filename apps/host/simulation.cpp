#include "apps/host/simulation.h"

#include <algorithm>
#include <cstdio>

#include "apps/host/debug_draw.h"
#include "apps/host/debug_effectors.h"
#include "apps/host/hands.h"
#include "apps/host/inspect.h"
#include "apps/host/messages.h"
#include "carom/core/spelling.h"
#include "carom/rigid/path.h"
#include "carom/scene/write_scene.h"

namespace carom::host {

std::string nearest_name(std::string_view name, const std::vector<std::string_view>& known) {
  return std::string(core::nearest_name(name, known));
}

namespace {

std::string number_text(double x) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%.6g", x);
  return buffer;
}

math::Vec3d in_space_angular(double w) { return {0, 0, w}; }
math::Vec3d in_space_angular(math::Vec3d w) { return w; }

template <class D>
class SimulationOf final : public Simulation {
 public:
  using World = rigid::World<D>;
  using Position = typename D::Position;

  SimulationOf(std::unique_ptr<Demo> owner, DemoOf<D>& demo, const SimulationOptions& options)
      : Simulation(owner->declaration()),
        owner_(std::move(owner)),
        demo_(demo),
        stage_(declaration_, options),
        options_(options) {
    base_ = &stage_;
  }

  core::Status build(const std::vector<double>& values) {
    if (!values.empty()) {
      if (values.size() != declaration_.parameters.size())
        return core::Error{"demo " + declaration_.id + ": " + std::to_string(values.size()) + " values given, " +
                           std::to_string(declaration_.parameters.size()) + " expected"};
      stage_.state.values = values;
    }
    demo_.build(stage_);
    return stage_.state.status;
  }

  core::Status step() override {
    if (!stage_.state.status.ok()) return stage_.state.status;
    stage_.state.lines.clear();
    stage_.state.points.clear();
    demo_.before_step(stage_);
    stage_.check(demo_.step(stage_));
    demo_.after_step(stage_);
    if (!stage_.world().events().quarantined.empty())
      stage_.say(std::to_string(stage_.world().events().quarantined.size()) +
                 " bodies got a state that is not a number and were frozen");
    return stage_.state.status;
  }
  double time() const override { return stage_.world().time(); }
  std::uint64_t step_count() const override { return stage_.world().step_count(); }

  GrabAnswer grab(std::int64_t pointer, math::Vec3d origin, math::Vec3d direction) override {
    release(pointer);
    if (grabs_.size() >= std::size_t(max_pointers)) return {};
    Position point{};
    const rigid::BodyId body = pick_body(stage_, origin, direction, point);
    const core::Result<rigid::BodyState<D>> state = world().state(body);
    if (!state.ok() || state->type != rigid::BodyType::dynamic) return {-1, in_space(point)};
    rigid::MouseJointDef<D> joint;
    joint.body_b = body;
    joint.frame_b.p = local_point(state->pose, point);
    joint.target = point;
    joint.spring = {5.0f, 1.0f};
    // Enough to lift and throw what is held, too little to tear a joint or to press it through the floor.
    joint.max_force = 60.0f * 9.80665f * math::max(state->mass, 1e-3f);
    const core::Result<rigid::JointId> made = world().create_joint(joint);
    if (!made.ok()) return {-1, in_space(point)};
    (void)world().set_awake(body, true);
    grabs_.push_back({pointer, *made, body, joint.frame_b.p, point});
    return {id_of(body), in_space(point)};
  }

  core::Status drag(std::int64_t pointer, math::Vec3d target) override {
    for (Grab& held : grabs_) {
      if (held.pointer != pointer) continue;
      if constexpr (D::dimension == 2)
        held.target = {target.x, target.y};
      else
        held.target = target;
      if (!world().contains(held.joint)) return {};
      (void)world().set_awake(held.body, true);
      return world().set_mouse_target(held.joint, held.target);
    }
    return core::Error{"drag: pointer " + std::to_string(pointer) + " holds nothing; send grab first"};
  }

  core::Status spawn(const SpawnRequest& request) override { return spawn_body(stage_, request); }
  core::Result<ProbeAnswer> probe(ProbeKind kind, math::Vec3d origin, math::Vec3d direction, double radius) override {
    return probe_world(stage_, kind, origin, direction, radius);
  }
  std::string inspect(std::uint32_t body) override { return inspect_body(stage_, body); }

  std::unique_ptr<Memento> save() override {
    std::unique_ptr<Demo> copied = owner_->copy();
    if (!copied) return nullptr;
    auto saved = std::make_unique<Saved>();
    world().snapshot(saved->world);
    saved->demo = std::move(copied);
    saved->stage = stage_.remember();
    saved->grabs = grabs_;
    return saved;
  }
  core::Status restore(const Memento& memento) override {
    const auto& saved = static_cast<const Saved&>(memento);
    if (const core::Status status = world().restore(saved.world); !status.ok()) return status;
    owner_->assign(*saved.demo);
    stage_.recall(saved.stage);
    grabs_ = saved.grabs;
    return {};
  }

  void release(std::int64_t pointer) override {
    for (std::size_t i = 0; i < grabs_.size(); ++i) {
      if (grabs_[i].pointer != pointer) continue;
      if (world().contains(grabs_[i].joint)) (void)world().destroy_joint(grabs_[i].joint);
      grabs_.erase(grabs_.begin() + std::ptrdiff_t(i));
      return;
    }
  }

  void release_all() override {
    while (!grabs_.empty()) release(grabs_.back().pointer);
  }

  double hand_force() const override {
    double most = 0;
    for (const Grab& held : grabs_)
      if (const auto state = stage_.world().joint_state(held.joint); state.ok())
        most = math::max(most, double(math::length(state->force)));
    return most;
  }
  ArrowScale arrows() const override { return arrow_scale(stage_.world(), float(declaration_.dt), scale()); }

  std::size_t body_count() const override { return stage_.actors().size(); }
  void places(std::vector<BodyPlace>& out) const override {
    out.clear();
    for (const auto& actor : stage_.actors()) {
      const auto state = stage_.world().state(actor.body);
      if (!state.ok()) continue;
      out.push_back({actor.id, in_space(state->pose.position), quaternion(state->pose.rotation), state->awake});
    }
  }
  void describe(const std::vector<std::uint32_t>* only, std::vector<BodyView>& out) override {
    std::vector<rigid::ShapeId> shapes;
    for (const auto& actor : stage_.actors()) {
      if (only && std::find(only->begin(), only->end(), actor.id) == only->end()) continue;
      const auto definition = world().body_definition(actor.body);
      if (!definition.ok()) continue;
      BodyView view;
      view.id = actor.id;
      view.name = definition->name;
      view.type = definition->type;
      view.color = actor.color;
      view.position = in_space(definition->position);
      view.rotation = quaternion(definition->rotation);
      shapes.clear();
      world().shapes(actor.body, shapes);
      for (const rigid::ShapeId id : shapes) {
        const auto shape = world().shape_geometry(id);
        const auto shape_definition = world().shape_definition(id);
        if (!shape.ok() || !shape_definition.ok()) continue;
        const std::size_t first = view.shapes.size();
        view_shape(*shape, shape_definition->local, shape_definition->sensor, meshes_, view.shapes);
        const std::uint32_t opacity = actor.color >> 24;
        for (std::size_t i = first; i < view.shapes.size(); ++i) {
          if (stage_.looks_in_materials) view.shapes[i].look = shape_definition->material.user_id;
          if (const int part = view.shapes[i].material; part >= 0) {
            // Parts of a surface stay apart: by colours of their own, or by those that the demo gave them.
            constexpr std::uint32_t shades[] = {0x8d99a6, 0x9fd3e8, 0x4a5560, 0xb98b5e, 0x6fa36b, 0xd9c27e};
            view.shapes[i].look = 0xff000000u | shades[part % 6];
            if (stage_.looks_in_materials && std::size_t(part) < shape_definition->surfaces.size())
              view.shapes[i].look = shape_definition->surfaces[std::size_t(part)].material.user_id;
          }
          if (opacity != 0 && opacity != 255 && view.shapes[i].look == 0) view.shapes[i].look = actor.color;
        }
      }
      out.push_back(std::move(view));
    }
  }
  void lines(std::vector<Line>& out) const override {
    out = stage_.state.lines;
    const World& world = stage_.world();
    for (const Grab& held : grabs_)
      if (const auto state = world.state(held.body); state.ok())
        out.push_back({in_space(world_point(state->pose, held.local)), in_space(held.target), 0xffd54fff});
    if (layers_ & layer_effectors) effectors_.lines(world, float(declaration_.dt), scale(), out);
    if (layers_ != 0) debug_lines(world, layers_, float(declaration_.dt), scale(), out);
    // Ropes, rods and springs hold at a distance: without a line one would not see them.
    std::vector<rigid::JointId> joints;
    world.joints(joints);
    for (const rigid::JointId id : joints) {
      if (out.size() >= max_lines) break;
      const auto definition = world.joint_definition(id);
      if (!definition.ok()) continue;
      if (const auto* rod = std::get_if<rigid::DistanceJointDef<D>>(&*definition))
        out.push_back({anchor(rod->body_a, rod->frame_a.p), anchor(rod->body_b, rod->frame_b.p), 0x6b7682ff});
      if (const auto* path = std::get_if<rigid::PathJointDef<D>>(&*definition)) draw_path(*path, out);
    }
  }
  std::vector<LegendEntry> legend() const override {
    return layers_ & layer_effectors ? effectors_.legend() : std::vector<LegendEntry>();
  }
  bool take_changes(std::vector<std::uint32_t>& added, std::vector<std::uint32_t>& removed) override {
    if (!stage_.changed()) return false;
    added = stage_.take_added();
    removed = stage_.take_removed();
    return true;
  }

  rigid::Counters counters() const override { return stage_.world().counters(); }
  rigid::StepProfile profile() const override { return stage_.world().profile(); }
  Budget budget() const override {
    const rigid::Totals<D> totals = stage_.world().totals();
    return {totals.mass, totals.kinetic_energy, totals.potential_energy, in_space(totals.momentum),
            in_space_angular(totals.angular_momentum)};
  }
  double worst_penetration() const override { return stage_.world().worst_penetration(); }
  double worst_joint_error() const override { return stage_.world().worst_joint_error(); }
  std::uint64_t state_hash() const override { return demo_.state_hash(stage_.world().state_hash()); }
  core::Result<std::unique_ptr<Simulation>> reopen(const std::vector<double>& values) const override {
    std::unique_ptr<Demo> fresh = owner_->again();
    Demo& demo = *fresh;
    return demo.open(std::move(fresh), values, options_);
  }
  std::vector<scene::RecordedFile> files() const override { return owner_->files(); }
  int threads() const override { return options_.threads; }
  void expectations(std::vector<Expectation>& out) override { demo_.expectations(stage_, out); }
  core::Result<std::string> scene_file() const override {
    constexpr std::size_t most = 4000;  // bodies: a text that an editor bears
    if (stage_.actors().size() > most)
      return core::Error{"the scene has " + std::to_string(stage_.actors().size()) +
                         " bodies; as a file beside the view at most " + std::to_string(most) + " are shown"};
    std::vector<scene::SceneBody> known;
    for (const auto& actor : stage_.actors()) {
      const auto definition = stage_.world().body_definition(actor.body);
      if (!definition.ok()) continue;
      const std::string name =
          definition->name.empty() ? "body_" + std::to_string(actor.id) : std::string(definition->name);
      known.push_back({name, actor.body, actor.color, actor.color != 0});
    }
    return scene::write_scene(
        stage_.world(), {declaration_.title, declaration_.summary, declaration_.dt, declaration_.duration}, known);
  }
  rigid::World2* world2() override {
    if constexpr (D::dimension == 2)
      return &world();
    else
      return nullptr;
  }
  rigid::World3* world3() override {
    if constexpr (D::dimension == 3)
      return &world();
    else
      return nullptr;
  }

 protected:
  void changed(std::string_view name) override { demo_.changed(stage_, name); }

 private:
  struct Grab {
    std::int64_t pointer;
    rigid::JointId joint;
    rigid::BodyId body;
    typename D::Vector local;
    Position target;
  };

  struct Saved final : Memento {
    rigid::Snapshot<D> world;
    std::unique_ptr<Demo> demo;
    typename Stage<D>::Memory stage;
    std::vector<Grab> grabs;
    std::size_t bytes() const override { return world.bytes() + stage.actors.size() * sizeof(stage.actors[0]) + 4096; }
  };

  /// m: how large the scene is on the screen.
  double scale() const {
    const Camera& c = declaration_.camera;
    return D::dimension == 2 ? c.height : 0.7 * math::distance(c.position, c.target);
  }
  World& world() { return stage_.world(); }
  static math::Quatf quaternion(math::Rot2f r) { return quaternion_of(r); }
  static math::Quatf quaternion(math::Quatf q) { return q; }
  std::int64_t id_of(rigid::BodyId body) const {
    for (const auto& actor : stage_.actors())
      if (actor.body == body) return actor.id;
    return -1;
  }

  /// A point of a body in space; without a body it is one of the world.
  math::Vec3d anchor(rigid::BodyId body, typename D::Vector local) const {
    const auto state = stage_.world().state(body);
    return in_space(state.ok() ? world_point(state->pose, local) : Position(local));
  }

  void draw_path(const rigid::PathJointDef<D>& path, std::vector<Line>& out) const {
    constexpr int steps = 8;
    const int last = steps * int(path.points.size() - (path.closed ? 0 : 1));
    const auto at = [&](int i) {
      const auto point = path_point(path, float(i) / steps);
      if (path.body_a.is_null()) return in_space(Position(path.frame_a.p) + Position(rotate(path.frame_a.q, point)));
      return anchor(path.body_a, path.frame_a.p + rotate(path.frame_a.q, point));
    };
    for (int i = 0; i < last && out.size() < max_lines; ++i) out.push_back({at(i), at(i + 1), 0x6b7682ff});
  }

  std::unique_ptr<Demo> owner_;
  DemoOf<D>& demo_;
  Stage<D> stage_;
  std::vector<Grab> grabs_;
  mutable EffectorForces<D> effectors_;
  SimulationOptions options_;
};

}  // namespace

std::string Simulation::opened_text() const { return opened_message(declaration_); }

std::string Simulation::scene_text() {
  std::vector<BodyView> views;
  describe(nullptr, views);
  return scene_message(declaration_, views);
}

core::Result<bool> Simulation::set(std::string_view name, double value) {
  std::vector<std::string_view> known;
  for (std::size_t i = 0; i < declaration_.parameters.size(); ++i) {
    const Parameter& parameter = declaration_.parameters[i];
    known.push_back(parameter.name);
    if (parameter.name != name) continue;
    if (!(value >= parameter.minimum && value <= parameter.maximum))
      return core::Error{"parameter " + parameter.name + ": found " + number_text(value) + " " + parameter.unit +
                         ", expected " + number_text(parameter.minimum) + " to " + number_text(parameter.maximum)};
    base_->state.values[i] = value;
    if (parameter.live) changed(parameter.name);
    return parameter.live;
  }
  const std::string nearest = nearest_name(name, known);
  return core::Error{"demo " + declaration_.id + " has no parameter \"" + std::string(name.substr(0, 64)) + "\"" +
                     (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?")};
}

core::Status Simulation::input(std::string_view action, double value) {
  for (std::size_t i = 0; i < declaration_.inputs.size(); ++i) {
    if (declaration_.inputs[i].action != action) continue;
    if (!(value >= -1 && value <= 1))
      return core::Error{"input " + declaration_.inputs[i].action + ": found " + number_text(value) +
                         ", expected −1 to 1"};
    if (declaration_.inputs[i].press && value != 0 && base_->state.presses[i] < 16) ++base_->state.presses[i];
    base_->state.inputs[i] = value;
    return {};
  }
  return core::Error{"demo " + declaration_.id + " has no input \"" + std::string(action.substr(0, 64)) + "\""};
}

template <class D>
core::Result<std::unique_ptr<Simulation>> DemoOf<D>::open(std::unique_ptr<Demo> self, const std::vector<double>& values,
                                                          const SimulationOptions& options) {
  auto simulation = std::make_unique<SimulationOf<D>>(std::move(self), *this, options);
  const core::Status built = simulation->build(values);
  if (!built.ok()) return built.error();
  return std::unique_ptr<Simulation>(std::move(simulation));
}
template class DemoOf<rigid::Dim2>;
template class DemoOf<rigid::Dim3>;

}  // namespace carom::host
