#include "apps/host/simulation.h"

#include <algorithm>
#include <cstdio>

#include "carom/core/spelling.h"

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
    const rigid::BodyId body = pick(origin, direction, point);
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

  void release(std::int64_t pointer) override {
    for (std::size_t i = 0; i < grabs_.size(); ++i) {
      if (grabs_[i].pointer != pointer) continue;
      if (world().contains(grabs_[i].joint)) (void)world().destroy_joint(grabs_[i].joint);
      grabs_.erase(grabs_.begin() + std::ptrdiff_t(i));
      return;
    }
  }

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
    // Ropes, rods and springs hold at a distance: without a line one would not see them.
    std::vector<rigid::JointId> joints;
    world.joints(joints);
    for (const rigid::JointId id : joints) {
      if (out.size() >= max_lines) break;
      const auto definition = world.joint_definition(id);
      if (!definition.ok()) continue;
      if (const auto* rod = std::get_if<rigid::DistanceJointDef<D>>(&*definition))
        out.push_back({anchor(rod->body_a, rod->frame_a.p), anchor(rod->body_b, rod->frame_b.p), 0x6b7682ff});
    }
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
  int threads() const override { return options_.threads; }
  void expectations(std::vector<Expectation>& out) override { demo_.expectations(stage_, out); }
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

  World& world() { return stage_.world(); }
  static math::Quatf quaternion(math::Rot2f r) { return quaternion_of(r); }
  static math::Quatf quaternion(math::Quatf q) { return q; }
  std::int64_t id_of(rigid::BodyId body) const {
    for (const auto& actor : stage_.actors())
      if (actor.body == body) return actor.id;
    return -1;
  }

  rigid::BodyId pick(math::Vec3d origin, math::Vec3d direction, Position& point) {
    if constexpr (D::dimension == 2) {
      // Where the view ray meets the plane of the world; a finger's width around it counts as a hit.
      const double t = direction.z != 0 ? -origin.z / direction.z : 0;
      point = {origin.x + t * direction.x, origin.y + t * direction.y};
      std::vector<rigid::ShapeId> found;
      const float reach = math::clamp(float(declaration_.camera.height) * 0.006f, 1e-4f, 1e4f);
      if (!world().overlap(geometry::Circle{reach}, {point, {}}, found).ok()) return {};
      rigid::BodyId best;
      double nearest = 0;
      for (const rigid::ShapeId shape : found) {
        const auto body = world().body_of(shape);
        const auto state = body.ok() ? world().state(*body) : core::Result<rigid::BodyState<D>>(body.error());
        if (!state.ok() || state->type != rigid::BodyType::dynamic) continue;
        const double d = math::distance_squared(state->center_of_mass, point);
        if (best && d >= nearest) continue;
        best = *body;
        nearest = d;
      }
      return best;
    } else {
      const auto hit = world().ray_cast(origin, math::Vec3f(math::normalize(direction) * 2000.0));
      if (!hit.ok() || !hit->shape) return {};
      point = hit->point;
      const auto body = world().body_of(hit->shape);
      return body.ok() ? *body : rigid::BodyId{};
    }
  }

  /// A point of a body in space; without a body it is one of the world.
  math::Vec3d anchor(rigid::BodyId body, typename D::Vector local) const {
    const auto state = stage_.world().state(body);
    return in_space(state.ok() ? world_point(state->pose, local) : Position(local));
  }

  std::unique_ptr<Demo> owner_;
  DemoOf<D>& demo_;
  Stage<D> stage_;
  std::vector<Grab> grabs_;
  SimulationOptions options_;
};

}  // namespace

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
