// What a step did to the bonds of a structure, and who pays for it: a part of structure.cpp.
#pragma once

#include "carom/blast/detail/structure_parts.h"

namespace carom::blast {

using namespace detail;

template <class D>
core::Result<bool> Structure<D>::find_breaks(World& world, float dt) {
  apart_.clear();
  blows_.clear();
  struck_.clear();
  for (const auto& hit : world.events().contact_hit)
    for (const rigid::ShapeId shape : {hit.shape_a, hit.shape_b})
      if (const auto body = world.body_of(shape); body.ok()) struck_.push_back(*body);
  bool by_contacts = false;
  // Splitting puts new ones at the end, that are looked at in the next step.
  const std::size_t count = clusters_.size();
  for (std::uint32_t c = 0; c < count; ++c) by_contacts = look_at(world, c, dt) || by_contacts;
  loads_.clear();
  return by_contacts;
}

template <class D>
bool Structure<D>::look_at(World& world, std::uint32_t index, float dt) {
  Cluster& cluster = clusters_[index];
  if (cluster.parts.size() == 1 && !cluster.fixed) return false;
  const std::size_t first = blows_.size();
  if (!collect_blows(world, index, dt)) {
    blows_.resize(first);
    return false;
  }
  const double worst = break_bonds(world, index);
  if (!(worst > 0)) {
    blows_.resize(first);
    // Bonds that were broken by hand may have let go of parts.
    if (comes_apart(*definition_, intact_, cluster.parts, cluster.fixed)) apart_.push_back(index);
    return false;
  }
  apart_.push_back(index);
  bool contacts = false;
  for (std::size_t i = first; i < blows_.size(); ++i) {
    blows_[i].kept = math::min(1 / worst, 1.0);
    contacts = contacts || !blows_[i].striker.is_null();
  }
  return contacts;
}

template <class D>
bool Structure<D>::collect_blows(World& world, std::uint32_t index, float dt) {
  const StructureDef<D>& d = *definition_;
  Cluster& cluster = clusters_[index];
  const auto state = world.state(cluster.body);
  if (!state.ok()) return false;  // somebody took it away
  bool struck = false;
  for (const Load& load : loads_) struck = struck || cluster_of_[load.part] == index;
  if (!state->awake && !cluster.fixed && !struck && !cluster.stale) return false;

  const rigid::Events<D> events = world.events();
  world.contacts(cluster.body, contacts_);
  const double brief = math::min(double(dt), d.material.contact_time);
  double resting = 0;
  for (const auto& contact : contacts_) {
    const std::uint32_t a = part_of(contact.shape_a), b = part_of(contact.shape_b);
    const bool ours_a = a != ground && cluster_of_[a] == index;
    const std::uint32_t part = ours_a ? a : b;
    if (part == ground || cluster_of_[part] != index) continue;
    const auto other = world.body_of(ours_a ? contact.shape_b : contact.shape_a);
    if (!other.ok()) continue;
    const auto striker = world.state(*other);
    if (!striker.ok()) continue;
    Blow blow;
    blow.cluster = index, blow.part = part, blow.striker = *other, blow.duration = double(dt);
    for (const auto& hit : events.contact_hit)
      if (hit.shape_a == contact.shape_a && hit.shape_b == contact.shape_b)
        blow.approach_speed = double(hit.approach_speed);
    // What lies against it and was struck itself hands the blow on.
    const bool hands_on =
        striker->type == rigid::BodyType::dynamic && std::find(struck_.begin(), struck_.end(), *other) != struck_.end();
    if (blow.approach_speed > 0 || hands_on) blow.duration = brief, struck = true;
    const double sign = ours_a ? -1 : 1;
    double normal_sum = 0;
    for (int k = 0; k < contact.count; ++k) normal_sum += double(contact.points[k].normal_impulse);
    for (int k = 0; k < contact.count; ++k) {
      const double j = double(contact.points[k].normal_impulse);
      if (!(j > 0)) continue;
      blow.point = contact.points[k].point;
      blow.impulse = sign * (j * Position(contact.normal) + (j / normal_sum) * Position(contact.friction_impulse));
      blow.cluster_arm = blow.point - state->center_of_mass;
      blow.striker_arm = blow.point - striker->center_of_mass;
      blows_.push_back(blow);
      resting += blow.duration < double(dt) ? 0 : j / double(dt);
    }
  }
  for (const Load& load : loads_)
    if (cluster_of_[load.part] == index) {
      Blow blow;
      blow.cluster = index, blow.part = load.part, blow.duration = load.duration;
      blow.point = load.point, blow.impulse = Position(load.impulse);
      blows_.push_back(blow);
    }
  const bool pressed = resting > 1.2 * cluster.resting_load + 1e-3;
  if (!struck && !cluster.stale && !pressed) return false;
  if (pressed || cluster.stale) cluster.resting_load = resting;
  cluster.stale = false;
  return true;
}

template <class D>
double Structure<D>::break_bonds(World& world, std::uint32_t index) {
  const StructureDef<D>& d = *definition_;
  const Cluster& cluster = clusters_[index];
  const auto state = world.state(cluster.body);
  if (!state.ok()) return 0;
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
  for (const Blow& blow : blows_) {
    if (blow.cluster != index) continue;
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
  const AngularD<D> turning =
      cluster.fixed ? AngularD<D>{} : solve_for(mass.inertia, twist - gyroscopic(mass.inertia, spin));
  const Position slowing = cluster.fixed ? -weight : total / mass.mass;
  for (std::uint32_t i = 0; i < cluster.parts.size(); ++i) {
    const auto& m = d.parts[cluster.parts[i]].mass;
    const Position arm = m.center - mass.center;
    Position acceleration = slowing;
    if (!cluster.fixed) {
      acceleration += cross(turning, arm) + cross(spin, cross(spin, arm));
      solver.torque[i] = solver.torque[i] - m.inertia * turning - gyroscopic(m.inertia, spin);
    }
    solver.force[i] -= m.mass * acceleration;
  }

  // A load that grows breaks the weakest first; what still holds takes the load over. The load under which parts come
  // off is the greatest on the way there.
  double least_worst = 0;
  constexpr int rounds = 24;
  for (int round = 0; round < rounds; ++round) {
    solver.solve(d.iterations);
    double worst = 0;
    for (const auto& beam : solver.beams) {
      if (beam.broken) continue;
      const double load = solver.load(beam, d.material, double(d.bonds[beam.bond].strength));
      bond_loads_[beam.bond] = float(load);
      worst = math::max(worst, load);
    }
    if (!(worst > 1)) return 0;
    least_worst = round == 0 ? worst : math::min(least_worst, worst);
    for (auto& beam : solver.beams) {
      const double load = double(bond_loads_[beam.bond]);
      if (beam.broken || !(load > 1) || load < 0.6 * worst) continue;
      beam.broken = true;
      intact_[beam.bond] = 0;
      ++broken_;
      events_.push_back({beam.bond, load});
    }
    // What came apart has loads and inertia of its own.
    if (comes_apart(d, intact_, cluster.parts, cluster.fixed)) return least_worst;
  }
  return 0;
}

template <class D>
core::Status Structure<D>::give_back(World& world) {
  for (const Blow& blow : blows_) {
    if (!clusters_[blow.cluster].fixed || blow.striker.is_null() || !(blow.approach_speed > 0)) continue;
    const auto speed = [&] {  // toward the cluster, at the point
      const auto s = world.state(blow.striker);
      return s.ok() ? dot(Position(s->linear_velocity) + cross(widen(s->angular_velocity), blow.striker_arm),
                          blow.impulse) /
                          length(blow.impulse)
                    : 0.0;
    };
    const Position back = (1 - blow.kept) * blow.impulse;
    const double before = speed();
    if (auto s = world.add_impulse_at(blow.striker, Vector(back), blow.point); !s) return s;
    // No faster than it came.
    const double after = speed(), too_fast = after - math::max(before, blow.approach_speed);
    if (!(too_fast > 0) || !(after > before)) continue;
    const Position less = -(too_fast / (after - before)) * back;
    if (auto s = world.add_impulse_at(blow.striker, Vector(less), blow.point); !s) return s;
  }
  return {};
}

/// Before the step that is done again: the striker loses what the bonds bore, a free body gets it.
template <class D>
core::Status Structure<D>::bear(World& world) {
  for (const Blow& blow : blows_) {
    if (blow.striker.is_null()) continue;
    const rigid::BodyId body = clusters_[blow.cluster].body;
    const auto striker = world.state(blow.striker), ours = world.state(body);
    if (!striker.ok() || !ours.ok()) continue;
    const bool moves = striker->type == rigid::BodyType::dynamic, free = ours->type == rigid::BodyType::dynamic;
    if (!moves && !free) continue;
    // The same point for both, so that no angular momentum is made; seen from the one that moves.
    const Position point = moves ? striker->center_of_mass + blow.striker_arm : ours->center_of_mass + blow.cluster_arm;
    const auto apart = [&] {  // m/s along the impulse, of the body against the striker
      double speed = 0;
      const auto add = [&](rigid::BodyId id, double sign) {
        if (const auto s = world.state(id); s.ok())
          speed +=
              sign * dot(Position(s->linear_velocity) + cross(widen(s->angular_velocity), point - s->center_of_mass),
                         blow.impulse);
      };
      add(body, 1);
      add(blow.striker, -1);
      return speed;
    };
    const auto act = [&](double share) -> core::Status {
      const Vector impulse = Vector(share * blow.impulse);
      if (moves)
        if (auto s = world.add_impulse_at(blow.striker, -impulse, point); !s) return s;
      return free ? world.add_impulse_at(body, impulse, point) : core::Status{};
    };
    const double before = apart();
    if (!(before < 0)) continue;  // they part: nothing is to be borne
    if (auto s = act(blow.kept); !s) return s;
    // It may stop the two, not throw them back: energy is not won.
    if (const double after = apart(); after > 0)
      if (auto s = act(-blow.kept * after / (after - before)); !s) return s;
  }
  return {};
}

}  // namespace carom::blast
