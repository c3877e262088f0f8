#include "carom/blast/structure.h"

#include <algorithm>

#include "carom/blast/detail/bond_stress.h"
#include "carom/core/string.h"

namespace carom::blast {

using math::Mat3d;
using math::Vec2d;
using math::Vec2f;
using math::Vec3d;
using math::Vec3f;
using rigid::Dim2;
using rigid::Dim3;

namespace detail {

template <class D>
using Mass = typename D::MassProperties;
template <class D>
using InertiaD = std::conditional_t<D::dimension == 2, double, Mat3d>;

inline double about(double inertia, double mass, Vec2d d) { return inertia + mass * length_squared(d); }
inline Mat3d about(const Mat3d& inertia, double mass, Vec3d d) { return geometry::transfer_inertia(inertia, mass, d); }
inline double solve_for(double inertia, double torque) { return inertia > 0 ? torque / inertia : 0; }
inline Vec3d solve_for(const Mat3d& inertia, Vec3d torque) {
  const double scale = trace(inertia) / 3;
  return scale > 0 ? inverse((1 / scale) * inertia) * (torque / scale) : Vec3d{};
}
inline double no_inertia(Dim2*) { return 0; }
inline Mat3d no_inertia(Dim3*) { return Mat3d::zero(); }
inline Vec2d into(const math::Rot2f& q, Vec2d v) { return inverse_rotate(math::Rot2d(q), v); }
inline Vec3d into(const math::Quatf& q, Vec3d v) { return inverse_rotate(math::Quatd(q), v); }
inline double into(const math::Rot2f&, double w) { return w; }
inline Vec2d out_of(const math::Rot2f& q, Vec2d v) { return rotate(math::Rot2d(q), v); }
inline Vec3d out_of(const math::Quatf& q, Vec3d v) { return rotate(math::Quatd(q), v); }
inline float narrow(double w) { return float(w); }
inline Vec3f narrow(Vec3d w) { return Vec3f(w); }
inline double widen(float w) { return double(w); }
inline Vec3d widen(Vec3f w) { return Vec3d(w); }
inline double spin_squared(double w) { return w * w; }
inline double spin_squared(Vec3d w) { return length_squared(w); }

/// The parts together, in the structure's frame.
template <class D>
Mass<D> together(const StructureDef<D>& d, const std::vector<std::uint32_t>& parts) {
  Mass<D> sum{};
  typename D::Position first{};
  for (const std::uint32_t p : parts) {
    sum.mass += d.parts[p].mass.mass;
    first += d.parts[p].mass.mass * d.parts[p].mass.center;
  }
  sum.center = first / sum.mass;
  InertiaD<D> inertia = no_inertia(static_cast<D*>(nullptr));
  for (const std::uint32_t p : parts) {
    const Mass<D>& m = d.parts[p].mass;
    inertia = inertia + about(m.inertia, m.mass, m.center - sum.center);
  }
  sum.inertia = inertia;
  return sum;
}

template <class D>
core::Status check(const StructureDef<D>& d) {
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

/// Components of the parts under the bonds that hold, in the order of their first parts.
template <class D>
std::vector<std::vector<std::uint32_t>> components(const StructureDef<D>& d, const std::vector<std::uint8_t>& intact,
                                                   const std::vector<std::uint32_t>& parts) {
  std::vector<std::uint32_t> parent(d.parts.size(), ground);
  for (const std::uint32_t p : parts) parent[p] = p;
  const auto root = [&](std::uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (std::size_t i = 0; i < d.bonds.size(); ++i) {
    const auto& b = d.bonds[i];
    if (!intact[i] || b.b == ground || parent[b.a] == ground || parent[b.b] == ground) continue;
    const std::uint32_t x = root(b.a), y = root(b.b);
    if (x != y) parent[math::max(x, y)] = math::min(x, y);
  }
  std::vector<std::vector<std::uint32_t>> found;
  std::vector<std::uint32_t> place(d.parts.size(), ground);
  for (const std::uint32_t p : parts) {
    const std::uint32_t r = root(p);
    if (place[r] == ground) place[r] = std::uint32_t(found.size()), found.emplace_back();
    found[place[r]].push_back(p);
  }
  return found;
}

template <class D>
bool stands(const StructureDef<D>& d, const std::vector<std::uint8_t>& intact,
            const std::vector<std::uint32_t>& parts) {
  for (std::size_t i = 0; i < d.bonds.size(); ++i)
    if (intact[i] && d.bonds[i].b == ground && std::binary_search(parts.begin(), parts.end(), d.bonds[i].a))
      return true;
  return false;
}

}  // namespace detail

using namespace detail;

template <class D>
core::Result<Structure<D>> Structure<D>::make(World& world, const StructureDef<D>& definition) {
  if (auto s = check(definition); !s) return s.error();
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
core::Status Structure<D>::after_step(World& world, float dt) {
  events_.clear();
  made_.clear();
  changed_.clear();
  if (!(dt > 0)) return core::Error{core::refused("Structure::after_step: dt", dt, "s > 0")};
  // Splitting puts new ones at the end, that are looked at in the next step.
  const std::size_t count = clusters_.size();
  for (std::uint32_t c = 0; c < count; ++c)
    if (auto s = look_at(world, c, dt); !s) return s;
  loads_.clear();
  return {};
}

template <class D>
core::Status Structure<D>::look_at(World& world, std::uint32_t index, float dt) {
  const StructureDef<D>& d = *definition_;
  Cluster& cluster = clusters_[index];
  if (cluster.parts.size() == 1 && !cluster.fixed) return {};
  const auto state = world.state(cluster.body);
  if (!state.ok()) return {};  // somebody took it away
  bool extra = false;
  for (const Load& load : loads_) extra = extra || cluster_of_[load.part] == index;
  if (!state->awake && !cluster.fixed && !extra && !cluster.stale) return {};

  struct Blow {
    std::uint32_t part;
    Position point;
    Position impulse;  // on the cluster, N·s
    double duration;
    rigid::BodyId striker;
  };
  std::vector<Blow> blows;
  const rigid::Events<D> events = world.events();
  std::vector<rigid::ContactView<D>> contacts;
  world.contacts(cluster.body, contacts);
  double resting = 0;
  bool struck = extra;
  for (const auto& contact : contacts) {
    const std::uint32_t a = part_of(contact.shape_a), b = part_of(contact.shape_b);
    const bool ours_a = a != ground && cluster_of_[a] == index;
    const std::uint32_t part = ours_a ? a : b;
    if (part == ground || cluster_of_[part] != index) continue;
    double duration = double(dt);
    for (const auto& hit : events.contact_hit)
      if (hit.shape_a == contact.shape_a && hit.shape_b == contact.shape_b)
        duration = math::min(double(dt), d.material.contact_time), struck = true;
    const auto other = world.body_of(ours_a ? contact.shape_b : contact.shape_a);
    if (!other.ok()) continue;
    const double sign = ours_a ? -1 : 1;
    double normal_sum = 0;
    for (int k = 0; k < contact.count; ++k) normal_sum += double(contact.points[k].normal_impulse);
    for (int k = 0; k < contact.count; ++k) {
      const double j = double(contact.points[k].normal_impulse);
      if (!(j > 0)) continue;
      const Position impulse =
          sign * (j * Position(contact.normal) + (j / normal_sum) * Position(contact.friction_impulse));
      blows.push_back({part, contact.points[k].point, impulse, duration, *other});
      resting += duration < double(dt) ? 0 : j / double(dt);
    }
  }
  for (const Load& load : loads_)
    if (cluster_of_[load.part] == index)
      blows.push_back({load.part, load.point, Position(load.impulse), load.duration, {}});
  const double spin2 = spin_squared(widen(state->angular_velocity));
  const bool pressed = resting > 1.2 * cluster.resting_load + 1e-3;
  if (!struck && !cluster.stale && !pressed) return {};
  if (pressed || cluster.stale) cluster.resting_load = resting;
  cluster.stale = false;

  // Nodes in the structure's frame.
  const Position at = state->pose.position;
  const auto& rotation = state->pose.rotation;
  const auto mass = together(d, cluster.parts);
  StressSolver<D> solver;
  solver.start(cluster.parts.size());
  std::vector<std::uint32_t> node(d.parts.size(), ground);
  for (std::uint32_t i = 0; i < cluster.parts.size(); ++i) node[cluster.parts[i]] = i;
  for (std::uint32_t i = 0; i < d.bonds.size(); ++i) {
    const auto& bond = d.bonds[i];
    if (!intact_[i] || node[bond.a] == ground) continue;
    typename StressSolver<D>::Beam beam{};
    beam.a = node[bond.a], beam.bond = i, beam.normal = bond.normal, beam.area = bond.area;
    beam.arm_a = bond.center - d.parts[bond.a].mass.center;
    double reach = length(beam.arm_a);
    if (bond.b == ground) {
      beam.b = ground;
    } else {
      beam.b = node[bond.b];
      beam.arm_b = bond.center - d.parts[bond.b].mass.center;
      reach += length(beam.arm_b);
    }
    const double e = d.material.youngs_modulus / math::max(reach, 1e-6);
    constexpr D* dimension = nullptr;
    beam.normal_stiffness = e * bond.area;
    beam.shear_stiffness = 0.4 * beam.normal_stiffness;
    beam.turning_stiffness = e * bending_moment(dimension, bond.area);
    solver.beams.push_back(beam);
  }
  Position total{};
  AngularD<D> twist{};
  for (const Blow& blow : blows) {
    const Position force = into(rotation, blow.impulse / blow.duration);
    const Position point = into(rotation, blow.point - at) + cluster.origin;
    const std::uint32_t i = node[blow.part];
    solver.force[i] += force;
    solver.torque[i] = solver.torque[i] + cross(point - d.parts[blow.part].mass.center, force);
    total += force;
    twist = twist + cross(point - mass.center, force);
  }
  const Position weight = cluster.fixed ? into(rotation, Position(world.definition().gravity)) : Position{};
  const AngularD<D> spin = into(rotation, widen(state->angular_velocity));
  const AngularD<D> turning = cluster.fixed ? AngularD<D>{} : solve_for(mass.inertia, twist);
  const Position slowing = cluster.fixed ? -weight : total / mass.mass;
  for (std::uint32_t i = 0; i < cluster.parts.size(); ++i) {
    const auto& m = d.parts[cluster.parts[i]].mass;
    const Position arm = m.center - mass.center;
    Position acceleration = slowing;
    if (!cluster.fixed) {
      acceleration += cross(turning, arm);
      if (spin2 > 0) acceleration += cross(spin, cross(spin, arm));
      solver.torque[i] = solver.torque[i] - m.inertia * turning;
    }
    solver.force[i] -= m.mass * acceleration;
  }

  double first_worst = 0;
  bool any = false;
  constexpr int rounds = 6;
  const std::size_t whole = detail::components(d, intact_, cluster.parts).size();
  for (int round = 0; round < rounds; ++round) {
    solver.solve(d.iterations);
    double worst = 0;
    for (const auto& beam : solver.beams) {
      if (beam.broken) continue;
      const double load = solver.load(beam, d.material, double(d.bonds[beam.bond].strength));
      bond_loads_[beam.bond] = float(load);
      worst = math::max(worst, load);
    }
    if (round == 0) first_worst = worst;
    if (!(worst > 1)) break;
    for (auto& beam : solver.beams) {
      const double load = double(bond_loads_[beam.bond]);
      if (beam.broken || !(load > 1) || load < 0.6 * worst) continue;
      beam.broken = true;
      intact_[beam.bond] = 0;
      ++broken_;
      events_.push_back({beam.bond, load});
      any = true;
    }
    // What came apart has loads and inertia of its own: in the next step.
    if (detail::components(d, intact_, cluster.parts).size() > whole) break;
  }
  // Only what stands gives back: of a free body the impulses also hold what pushed it out of the ground.
  if (any && first_worst > 1 && cluster.fixed) {
    const double kept = 1 / first_worst;
    for (const Blow& blow : blows) {
      if (blow.duration >= double(dt) || blow.striker.is_null()) continue;
      const auto striker = world.state(blow.striker);
      if (!striker.ok() || striker->type != rigid::BodyType::dynamic) continue;
      // Impulses hold what pushed overlaps apart, too: no more is given back than what it came with.
      double sum = 0, speed = 0;
      for (const Blow& other : blows)
        if (other.striker == blow.striker && other.duration < double(dt)) sum += (1 - kept) * length(other.impulse);
      for (const auto& hit : events.contact_hit) {
        const auto a = world.body_of(hit.shape_a), b = world.body_of(hit.shape_b);
        if ((a.ok() && *a == blow.striker) || (b.ok() && *b == blow.striker))
          speed = math::max(speed, double(hit.approach_speed));
      }
      const double most = double(striker->mass) * speed, share = sum > most ? most / sum : 1;
      const Vector back = Vector(share * (1 - kept) * blow.impulse);
      if (auto s = world.add_impulse_at(blow.striker, back, blow.point); !s) return s;
    }
  }
  return split(world, index);
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
