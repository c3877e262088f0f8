#include "carom/blast/structure.h"

#include "carom/blast/detail/structure_loads.inl"
#include "carom/core/string.h"

namespace carom::blast {

namespace {

template <class D>
core::Status check_structure(const StructureDef<D>& d) {
  const auto error = [](const auto&... pieces) { return core::Error{core::text("Structure: ", pieces...)}; };
  if (d.parts.empty()) return error("no parts, expected at least one");
  for (std::size_t i = 0; i < d.parts.size(); ++i) {
    if (d.parts[i].shapes.empty()) return error("part ", i, " has no shape");
    if (!(d.parts[i].mass.mass > 0) || !math::is_finite(d.parts[i].mass.mass))
      return error("part ", i, ": ", core::refused("mass", d.parts[i].mass.mass, "a finite number of kg > 0"));
    if (!is_finite(d.parts[i].mass.center)) return error("part ", i, ": center is not finite");
  }
  for (std::size_t i = 0; i < d.bonds.size(); ++i) {
    const auto& b = d.bonds[i];
    if (b.a >= d.parts.size() || (b.b >= d.parts.size() && b.b != ground) || b.a == b.b)
      return error("bond ", i, " is between parts ", b.a, " and ", b.b, ", expected two of ", d.parts.size());
    if (!(b.area > 0) || !math::is_finite(b.area))
      return error("bond ", i, ": ", core::refused("area", b.area, "m² > 0"));
    if (!is_finite(b.center) || !(math::abs(length_squared(b.normal) - 1) < 1e-6))
      return error("bond ", i, ": expected a finite center and a unit normal");
    if (!(b.strength > 0) || !math::is_finite(b.strength))
      return error("bond ", i, ": ", core::refused("strength", b.strength, "a finite number > 0"));
  }
  const BondMaterial& m = d.material;
  for (const auto& [name, value] :
       {std::pair("tensile_strength", m.tensile_strength), std::pair("compressive_strength", m.compressive_strength),
        std::pair("shear_strength", m.shear_strength), std::pair("youngs_modulus", m.youngs_modulus),
        std::pair("contact_time", m.contact_time)})
    if (!(value > 0) || !math::is_finite(value)) return error(core::refused(name, value, "a finite number > 0"));
  if (d.iterations < 1 || d.iterations > 1000) return error(core::refused("iterations", d.iterations, "1 to 1000"));
  return {};
}

}  // namespace

template <class D>
core::Result<Structure<D>> Structure<D>::make(World& world, const StructureDef<D>& definition) {
  if (auto s = check_structure(definition); !s) return s.error();
  Structure made;
  made.definition_ = std::make_shared<StructureDef<D>>(definition);
  made.intact_.assign(definition.bonds.size(), 1);
  made.bond_loads_.assign(definition.bonds.size(), 0);
  made.cluster_of_.assign(definition.parts.size(), 0);
  std::vector<std::uint32_t> all(definition.parts.size());
  for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  const auto whole = together(definition, all);
  const auto components = detail::components(definition, made.intact_, all);
  for (const auto& parts : components) {
    Cluster cluster;
    cluster.parts = parts;
    cluster.fixed = stands(definition, made.intact_, parts);
    // Velocities are those of the whole about its centre.
    const auto mass = together(definition, parts);
    const Vector arm = Vector(out_of(definition.pose.rotation, mass.center - whole.center));
    const Vector velocity = definition.linear_velocity + cross(definition.angular_velocity, arm);
    if (auto s = made.make_body(world, cluster, definition.pose, cluster.fixed ? Vector{} : velocity,
                                cluster.fixed ? typename D::Angular{} : definition.angular_velocity);
        !s)
      return s.error();
    for (const std::uint32_t p : parts) made.cluster_of_[p] = std::uint32_t(made.clusters_.size());
    made.clusters_.push_back(std::move(cluster));
  }
  return made;
}

template <class D>
core::Status Structure<D>::make_body(World& world, Cluster& cluster, const typename D::Pose& frame, Vector velocity,
                                     typename D::Angular spin) {
  const StructureDef<D>& d = *definition_;
  typename D::MassProperties mass = together(d, cluster.parts);
  cluster.origin = mass.center;
  rigid::BodyDef<D> body;
  body.type = cluster.fixed ? rigid::BodyType::fixed : rigid::BodyType::dynamic;
  body.position = frame.position + out_of(frame.rotation, mass.center);
  body.rotation = frame.rotation;
  body.bullet = d.bullet_pieces;
  body.name = "pieces";
  const auto id = world.create_body(body);
  if (!id.ok()) return id.error();
  cluster.body = *id;
  rigid::ShapeDef<D> shape = d.shape;
  shape.density = 0;
  shape.hit_events = true;
  for (const std::uint32_t p : cluster.parts) {
    shape.local = {};
    shape.local.p = Vector(d.parts[p].mass.center - mass.center);
    shape.material.user_id = d.parts[p].user_id != 0 ? d.parts[p].user_id : d.shape.material.user_id;
    for (const auto& geometry : d.parts[p].shapes) {
      const auto made = world.add_shape(*id, geometry, shape);
      if (!made.ok()) {
        (void)world.destroy_body(*id);
        return made.error();
      }
      const auto place = std::lower_bound(shapes_.begin(), shapes_.end(), made->index,
                                          [](const ShapeOf& s, std::uint32_t index) { return s.index < index; });
      if (place != shapes_.end() && place->index == made->index)
        *place = {made->index, *made, p};
      else
        shapes_.insert(place, {made->index, *made, p});
    }
  }
  made_.push_back(*id);
  if (cluster.fixed) return {};
  mass.center = {};
  if (auto s = world.set_mass_properties(*id, mass); !s) return s;
  return world.set_velocity(*id, velocity, spin);
}

template <class D>
std::uint32_t Structure<D>::part_of(rigid::ShapeId shape) const {
  const auto place = std::lower_bound(shapes_.begin(), shapes_.end(), shape.index,
                                      [](const ShapeOf& s, std::uint32_t index) { return s.index < index; });
  return place != shapes_.end() && place->shape == shape ? place->part : ground;
}

template <class D>
void Structure<D>::add_load(std::uint32_t part, Vector impulse, Position point, double duration) {
  if (part >= cluster_of_.size() || !is_finite(impulse) || !is_finite(point) || !(duration > 0)) return;
  loads_.push_back({part, impulse, point, duration});
}

template <class D>
void Structure<D>::break_bond(std::uint32_t bond) {
  if (bond >= intact_.size() || !intact_[bond]) return;
  intact_[bond] = 0;
  ++broken_;
  clusters_[cluster_of_[definition_->bonds[bond].a]].stale = true;
}

template <class D>
void Structure<D>::start_step() {
  events_.clear();
  made_.clear();
  changed_.clear();
}

template <class D>
core::Status Structure<D>::after_step(World& world, float dt) {
  if (!(dt > 0)) return core::Error{core::refused("Structure::after_step: dt", dt, "s > 0")};
  start_step();
  if (const auto broke = find_breaks(world, dt); !broke.ok()) return broke.error();
  if (auto s = give_back(world); !s) return s;
  return part_bodies(world);
}

template <class D>
bool Structure<D>::can_break() const {
  for (const Cluster& cluster : clusters_)
    if (cluster.fixed || cluster.parts.size() > 1) return true;
  return false;
}

template <class D>
core::Status Structure<D>::part_bodies(World& world) {
  for (const std::uint32_t cluster : apart_)
    if (auto s = split(world, cluster); !s) return s;
  apart_.clear();
  blows_.clear();
  std::erase_if(made_, [&](rigid::BodyId body) { return !world.contains(body); });
  return {};
}

template <class D>
core::Status Structure<D>::split(World& world, std::uint32_t index) {
  const StructureDef<D>& d = *definition_;
  auto components = detail::components(d, intact_, clusters_[index].parts);
  const bool was_fixed = clusters_[index].fixed;
  // What stays: all that stands on the ground, or of a free body the heaviest.
  std::vector<std::uint32_t> stays;
  std::vector<std::vector<std::uint32_t>> leaves;
  if (was_fixed) {
    for (auto& parts : components) {
      if (stands(d, intact_, parts))
        stays.insert(stays.end(), parts.begin(), parts.end());
      else
        leaves.push_back(std::move(parts));
    }
    std::sort(stays.begin(), stays.end());
  } else {
    std::size_t heaviest = 0;
    double most = 0;
    for (std::size_t i = 0; i < components.size(); ++i)
      if (const double m = together(d, components[i]).mass; m > most) most = m, heaviest = i;
    stays = components[heaviest];
    for (std::size_t i = 0; i < components.size(); ++i)
      if (i != heaviest) leaves.push_back(std::move(components[i]));
  }
  if (leaves.empty()) return {};
  const auto state = world.state(clusters_[index].body);
  if (!state.ok()) return state.error();
  const typename D::Pose frame{state->pose.position - out_of(state->pose.rotation, clusters_[index].origin),
                               state->pose.rotation};
  const AngularD<D> spin = widen(state->angular_velocity);
  // Off the old body first, so that nothing overlaps itself.
  std::vector<std::uint8_t> leaving(d.parts.size(), 0);
  for (const auto& parts : leaves)
    for (const std::uint32_t p : parts) leaving[p] = 1;
  const rigid::BodyId old = clusters_[index].body;
  changed_.push_back(old);
  if (stays.empty()) {
    if (auto s = world.destroy_body(old); !s) return s;
    std::erase_if(shapes_, [&](const ShapeOf& s) { return leaving[s.part] != 0; });
  } else {
    for (const ShapeOf& s : shapes_)
      if (leaving[s.part])
        if (auto status = world.destroy_shape(s.shape); !status) return status;
    std::erase_if(shapes_, [&](const ShapeOf& s) { return leaving[s.part] != 0; });
    if (!was_fixed) {
      auto mass = together(d, stays);
      const Position center = mass.center;
      mass.center = center - clusters_[index].origin;
      if (auto s = world.set_mass_properties(old, mass); !s) return s;
      const Position arm = out_of(state->pose.rotation, center - clusters_[index].origin) -
                           (state->center_of_mass - state->pose.position);
      const Position velocity = Position(state->linear_velocity) + cross(spin, arm);
      if (auto s = world.set_velocity(old, Vector(velocity), state->angular_velocity); !s) return s;
    }
  }
  for (std::size_t k = 0; k < leaves.size(); ++k) {
    Cluster cluster;
    cluster.parts = std::move(leaves[k]);
    Vector velocity{};
    if (!was_fixed) {
      const Position arm = out_of(state->pose.rotation, together(d, cluster.parts).center - clusters_[index].origin) -
                           (state->center_of_mass - state->pose.position);
      velocity = Vector(Position(state->linear_velocity) + cross(spin, arm));
    }
    if (auto s = make_body(world, cluster, frame, velocity, state->angular_velocity); !s) return s;
    const bool replaces = stays.empty() && k == 0;
    const std::uint32_t place = replaces ? index : std::uint32_t(clusters_.size());
    for (const std::uint32_t p : cluster.parts) cluster_of_[p] = place;
    if (replaces)
      clusters_[index] = std::move(cluster);
    else
      clusters_.push_back(std::move(cluster));
  }
  if (!stays.empty()) {
    clusters_[index].parts = std::move(stays);
    clusters_[index].stale = true;
  }
  return {};
}

template class Structure<Dim2>;
template class Structure<Dim3>;

}  // namespace carom::blast
