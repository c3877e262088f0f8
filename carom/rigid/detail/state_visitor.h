// Every member of a world, once: what snapshots copy and what memory counts. The members are taken apart by structured
// bindings, which do not compile when a member is added and not named here: no new state can escape a snapshot.
#pragma once

#include "carom/rigid/detail/world_implementation.h"

namespace carom::rigid::detail {

// `visit` has these functions:
//   state(x)       x decides how the world goes on: a number, a plain struct or a vector of them;
//   scratch(v)     a vector of the step, whose content may be forgotten between steps;
//   events(v)      what the last step told;
//   bodies(v, v, v, v), manifolds(v)                     state of which a part follows from the rest;
//   begins(part)   the state of such a part comes next;
//   definition(d), shapes(v), names(v), effectors(v)     state that is not plain bytes.
// Store types are deduced, so that all of this serves constant worlds too.

/// What a visitor may want to know the place of: the trees of shapes, the set of pairs.
enum class StatePart { trees, pairs };

template <class Slots, class Visit>
void visit_slots(Slots& slots, Visit& visit) {
  std::remove_const_t<Slots>::visit_members(slots, [&](auto& x) { visit.state(x); });
}

template <class Bodies, class Visit>
void visit_bodies(Bodies& store, Visit& visit) {
  auto& [slots, solver, pose, motion, record, names, user_data, birth, time_scale, awake, substep_wishes] = store;
  visit_slots(slots, visit);
  visit.bodies(solver, pose, motion, record);
  visit.names(names);
  visit.state(user_data);
  visit.state(birth);
  visit.state(time_scale);
  visit.state(awake);
  visit.state(substep_wishes);
}

template <class Shapes, class Visit>
void visit_shapes(Shapes& store, Visit& visit) {
  auto& [slots, record, terms, user_data, extras, surfaces, moving_surfaces, bounce, trees, originals, geometry_copy] =
      store;
  (void)bounce, (void)geometry_copy, (void)originals;
  visit_slots(slots, visit);
  visit.shapes(record);
  visit_slots(terms, visit);
  visit.state(user_data);
  visit.state(extras);
  visit.state(surfaces);
  visit.state(moving_surfaces);
  visit.begins(StatePart::trees);
  for (auto& tree : trees) visit_slots(tree, visit);
}

template <class Joints, class Visit>
void visit_joints(Joints& store, Visit& visit) {
  auto& [slots, headers, room, small, large, free_small, free_large, births, internal_count, breakable_count,
         knot_points, knot_tangents, knot_arcs, order, offset, color_begin, records, trees, pins, pin_begin, pin_blocks,
         limbs, limb_begin, limb_blocks] = store;
  (void)pin_blocks, (void)limb_blocks;
  visit_slots(slots, visit);
  visit.state(headers);
  visit.state(room);
  visit.state(small);
  visit.state(large);
  visit.state(free_small);
  visit.state(free_large);
  visit.state(births);
  visit.state(internal_count);
  visit.state(breakable_count);
  visit.state(knot_points);
  visit.state(knot_tangents);
  visit.state(knot_arcs);
  visit.scratch(order);
  visit.scratch(offset);
  visit.scratch(color_begin);
  visit.scratch(records);
  visit.scratch(trees.trees);
  visit.scratch(trees.bodies);
  visit.scratch(trees.joints);
  visit.scratch(trees.of_joint);
  visit.scratch(pins);
  visit.scratch(limbs);
  visit.scratch(limb_begin);
}

template <class Effectors, class Visit>
void visit_effectors(Effectors& store, Visit& visit) {
  auto& [slots, data, in_order, added, vertices, indices, depths, sea_x, sea_z, sea_height, sea] = store;
  visit_slots(slots, visit);
  visit.effectors(data);
  visit.state(in_order);
  visit.scratch(added);
  visit.scratch(vertices);
  visit.scratch(indices);
  visit.scratch(depths);
  visit.scratch(sea_x);
  visit.scratch(sea_z);
  visit.scratch(sea_height);
  visit.scratch(sea.memory());
}

template <class Contacts, class Visit>
void visit_contacts(Contacts& store, Visit& visit) {
  auto& [contacts, manifolds, free_contacts, free_manifolds, awake, count] = store;
  visit.state(contacts);
  visit.manifolds(manifolds);
  visit.state(free_contacts);
  visit.state(free_manifolds);
  visit.state(awake);
  visit.state(count);
}

template <class Graph, class Visit>
void visit_graph(Graph& graph, Visit& visit) {
  auto& [colors] = graph;
  for (auto& color : colors) {
    auto& [manifolds, joints, extra] = color;
    visit.state(manifolds);
    visit.state(joints);
    visit.state(extra);
  }
}

template <class Scratch, class Visit>
void visit_scratch(Scratch& scratch, Visit& visit) {
  auto& [blocks, loads, load_wishes, dropped, again, placed, hits, flights, impacts, impact_queue, solver_stages,
         solver_loops, sweeps, sweeping, watches, old_bounds, moved_place, moved, sweep, strips, found_outgrown,
         outgrown, outgrown_places, new_bounds, found_pairs, met_sensors, pairs, found_bullet_pairs, found_strays,
         strays, driven, bullet_pairs, bullet_meetings, pair_meetings, first_bullet_pair, swept, fast, driven_over,
         tied, broken, body_changes, contact_changes, found_manifolds, manifolds, island_parent, island_list,
         island_bodies, island_ends, doomed_contacts, new_touches, new_manifolds, island_restless, island_substeps,
         whole_awake, whole_trees, whole_colors, contact_begin, contact_end, pending_contact_end, contact_hit,
         sensor_begin, sensor_end, pending_sensor_end, fell_asleep, quarantined, body_moves, joint_break,
         spring_break] = scratch;
  (void)blocks;
  visit.scratch(loads);
  for (auto& list : load_wishes) visit.scratch(list);
  visit.scratch(dropped);
  visit.scratch(again);
  visit.scratch(placed);
  visit.scratch(hits);
  visit.scratch(flights);
  visit.scratch(impacts);
  visit.scratch(impact_queue);
  visit.scratch(solver_stages);
  visit.scratch(solver_loops);
  visit.scratch(sweeps);
  visit.scratch(sweeping);
  visit.scratch(watches);
  visit.scratch(old_bounds);
  visit.scratch(moved_place);
  visit.state(moved);
  BoxSweep::visit_lists(sweep, [&](auto& list) { visit.scratch(list); });
  BoxStrips::visit_lists(strips, [&](auto& list) { visit.scratch(list); });
  for (auto& list : found_outgrown) visit.scratch(list);
  visit.scratch(outgrown);
  visit.scratch(outgrown_places);
  visit.scratch(new_bounds);
  for (auto& list : found_pairs) visit.scratch(list);
  for (auto& list : met_sensors) visit.scratch(list);
  visit.scratch(pairs);
  for (auto& list : found_bullet_pairs) visit.scratch(list);
  for (auto& list : found_strays) visit.scratch(list);
  visit.scratch(strays);
  visit.scratch(driven);
  visit.scratch(bullet_pairs);
  visit.scratch(bullet_meetings);
  visit.scratch(pair_meetings);
  visit.scratch(first_bullet_pair);
  visit.scratch(swept);
  visit.scratch(fast);
  visit.scratch(driven_over);
  visit.scratch(tied);
  visit.scratch(broken);
  visit.scratch(body_changes);
  visit.scratch(contact_changes);
  for (auto& list : found_manifolds) visit.scratch(list);
  visit.scratch(manifolds);
  visit.scratch(island_parent);
  visit.scratch(island_list);
  visit.scratch(island_bodies);
  visit.scratch(island_ends);
  visit.scratch(doomed_contacts);
  visit.scratch(new_touches);
  visit.scratch(new_manifolds);
  visit.scratch(island_restless);
  visit.scratch(island_substeps);
  visit.scratch(whole_awake);
  visit.scratch(whole_trees);
  for (auto& color : whole_colors) {
    visit.scratch(color.manifolds);
    visit.scratch(color.joints);
  }
  visit.events(contact_begin);
  visit.events(contact_end);
  visit.state(pending_contact_end);
  visit.events(contact_hit);
  visit.events(sensor_begin);
  visit.events(sensor_end);
  visit.state(pending_sensor_end);
  visit.events(fell_asleep);
  visit.events(quarantined);
  visit.events(body_moves);
  visit.events(joint_break);
  visit.events(spring_break);
}

/// `world` is a WorldImplementation, constant or not.
template <class World, class Visit>
void visit_world(World& world, Visit&& visit) {
  auto& [definition, world_number, bodies, shapes, joints, effectors, contacts, pairs, graph, sleeping, own_scheduler,
         scheduler, arena, scratch, kernels, hit_event_shapes, step_count, births, time, last_dt, peak_bytes, reserved,
         pair_rules, contact_filter, contact_modifier, profile, moves, query_trees] = world;
  // Of this object, this machine or the last step's clock; or made anew when the trees change.
  (void)world_number, (void)own_scheduler, (void)scheduler, (void)arena, (void)kernels, (void)peak_bytes,
      (void)reserved, (void)contact_filter, (void)contact_modifier, (void)profile, (void)moves, (void)query_trees;
  visit.definition(definition);
  visit_bodies(bodies, visit);
  visit_shapes(shapes, visit);
  visit_joints(joints, visit);
  visit_effectors(effectors, visit);
  visit_contacts(contacts, visit);
  visit.begins(StatePart::pairs);
  visit_slots(pairs, visit);
  visit_graph(graph, visit);
  {
    auto& [first, free] = sleeping;
    visit.state(first);
    visit.state(free);
  }
  visit_scratch(scratch, visit);
  visit.state(pair_rules);
  visit.state(hit_event_shapes);
  visit.state(step_count);
  visit.state(births);
  visit.state(time);
  visit.state(last_dt);
}

}  // namespace carom::rigid::detail
