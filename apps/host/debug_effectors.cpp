#include "apps/host/debug_effectors.h"

#include <cstdio>
#include <iterator>

#include "apps/host/debug_pen.h"

namespace carom::host {

namespace {

struct EffectorKind {
  const char* label;
  std::uint32_t color;
};
/// In the order of rigid::EffectorDef.
constexpr EffectorKind effector_kinds[] = {{"gravity of a point mass", 0x4a8fe7},
                                           {"linear drag", 0xd99a1c},
                                           {"quadratic drag", 0xe4572e},
                                           {"wind", 0x8a8f98},
                                           {"springs", 0x9b6dd6},
                                           {"buoyancy", 0x00a6c7},
                                           {"thrust", 0x6bbf59},
                                           {"radial field", 0xe07a9b},
                                           {"vortex", 0x2a9d8f},
                                           {"custom", 0x8a8f98},
                                           {"gravity of the surroundings", 0x2f5fb3},
                                           {"drag by flow", 0xb5651d},
                                           {"Magnus lift", 0xd1495b},
                                           {"turning frame", 0x7d6bd0},
                                           {"electromagnetic field", 0xc2b800},
                                           {"lifting surfaces", 0x3f8efc},
                                           {"drag of cylinders", 0xc46f3a}};
template <class D>
constexpr std::size_t effector_kind_count = std::variant_size_v<rigid::EffectorDef<D>>;

/// What others ask for their water and air: it stays when their share is looked for.
template <class D>
bool is_medium(const rigid::EffectorDef<D>& definition) {
  return std::holds_alternative<rigid::Surroundings<D>>(definition) ||
         std::holds_alternative<rigid::Wind<D>>(definition);
}

}  // namespace

template <class D>
void EffectorForces<D>::lines(const rigid::World<D>& world, float dt, double size, std::vector<Line>& out) {
  static_assert(std::size(effector_kinds) == effector_kind_count<D>, "one name and colour for each kind of effector");
  legend_.clear();
  std::vector<rigid::EffectorId> effectors;
  world.effectors(effectors);
  bool found[effector_kind_count<D>] = {};
  for (const rigid::EffectorId id : effectors)
    if (const auto definition = world.effector_definition(id); definition.ok()) found[definition->index()] = true;
  std::vector<std::size_t> shown;
  for (std::size_t k = 0; k < effector_kind_count<D>; ++k)
    if (found[k] && k != 3 && k != 9) shown.push_back(k);
  if (shown.empty()) return;
  if (world.counters().bodies > most_bodies) {
    legend_.push_back({"more than " + std::to_string(most_bodies) + " bodies: not shown", 0x8a8f98});
    return;
  }
  if (!copy_) {
    rigid::WorldDef<D> definition = world.definition();
    definition.threads = 1;
    definition.scheduler = nullptr;
    definition.profiler = nullptr;
    copy_ = std::make_unique<rigid::World<D>>(definition);
  }
  // A snapshot reads the world only; that it may not be const is its own affair (it reuses the world's room for
  // writing).
  const_cast<rigid::World<D>&>(world).snapshot(now_);

  std::vector<rigid::BodyId> bodies, copied_bodies;
  std::vector<rigid::EffectorId> copied_effectors;
  std::vector<rigid::ShapeId> shapes;
  std::vector<rigid::JointId> joints;
  world.bodies(bodies);
  using Velocity = std::vector<math::Vec3d>;
  /// Velocities after a step in which of the effectors only those act that `keeps` says.
  const auto velocities_with = [&](const auto& keeps, Velocity& velocities) -> bool {
    if (!copy_->restore(now_).ok()) return false;
    // Its handles are its own, in the same order.
    copy_->joints(joints);
    copy_->effectors(copied_effectors);
    copy_->bodies(copied_bodies);
    for (const rigid::JointId id : joints) (void)copy_->destroy_joint(id);
    for (const rigid::EffectorId id : copied_effectors) {
      const auto definition = copy_->effector_definition(id);
      if (definition.ok() && (definition->index() == 9 || !keeps(*definition))) (void)copy_->destroy_effector(id);
    }
    for (const rigid::BodyId body : copied_bodies) {
      shapes.clear();
      copy_->shapes(body, shapes);
      for (const rigid::ShapeId shape : shapes) (void)copy_->set_filter(shape, {0, 0, 0});
    }
    if (!copy_->step(dt).ok()) return false;
    velocities.clear();
    for (const rigid::BodyId body : copied_bodies) {
      const auto state = copy_->state(body);
      velocities.push_back(state.ok() ? in_space(state->linear_velocity) : math::Vec3d{});
    }
    return true;
  };

  Velocity all, without;
  if (!velocities_with([](const auto&) { return true; }, all)) return;
  DebugPen pen(0.012 * size, D::dimension == 2, out);
  const ArrowScale scale = arrow_scale(world, dt, size);
  for (const std::size_t k : shown) {
    const bool medium = k == 10;
    // The share of the medium's own gravity is what is there without anything that asks for the medium.
    Velocity with = all;
    if (medium && !velocities_with([](const auto& e) { return is_medium<D>(e); }, with)) return;
    if (!velocities_with([&](const auto& e) { return medium ? false : e.index() != k; }, without)) return;
    double most = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const auto state = world.state(bodies[i]);
      if (!state.ok() || state->type != rigid::BodyType::dynamic || !state->awake) continue;
      const math::Vec3d force = (with[i] - without[i]) * (double(state->mass) / double(dt));
      most = math::max(most, math::length(force));
      pen.arrow(in_space(state->center_of_mass), scale.force * force, effector_kinds[k].color << 8 | 0xff);
    }
    if (!(most > 1e-9)) continue;
    char text[40];
    std::snprintf(text, sizeof text, ", up to %.3g N", most);
    legend_.push_back({effector_kinds[k].label + std::string(text), effector_kinds[k].color});
  }
}

template class EffectorForces<rigid::Dim2>;
template class EffectorForces<rigid::Dim3>;

}  // namespace carom::host
