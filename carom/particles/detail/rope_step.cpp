// A substep of ropes: Newton's method on the implicit step, by Thomas' elimination of 3×3 blocks.
#include "carom/core/string.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles::detail {

namespace {

constexpr int most_iterations = 60;
constexpr int settled = 10, last_placing = 36;  // when planes of contacts are looked at again
constexpr double unsettled_strain = 0.1;        // of the last iteration: what was found is no solution
constexpr int most_halvings = 4;
constexpr int most_fast_halvings = 9;  // of a substep in which something fast is met
constexpr int turn_iterations = 7;     // in which segments still turn by little
constexpr int cross_iterations = 6;    // in which what ropes push on each other is still found anew
constexpr int most_substeps = 256;
constexpr double gap_rate = 0.4;  // share of a gap between a particle and its anchor that is closed in a step

/// The share of implicitness of a spring with z = (ω h)²: none while it is slow (Verlet's symplectic step), all for a
/// stiff one (implicit Euler's); stable for every z.
double implicit_share(double z) { return z > 1 ? 1 - 1 / z : 0; }

/// What a hold puts in its place, for a velocity of the surface; `mass` makes it a momentum.
Vec3d held_part(const RopeNode& node, double mass, Vec3d v) {
  if (node.hold == RopeHold::none) return {};
  if (node.hold == RopeHold::attached) return mass * v;
  return (mass * dot(node.normal, v)) * node.normal + node.resistance * across(node, v);
}

}  // namespace

int RopeSolver::needed_substeps(const Rope& rope) const {
  int needed = set.substeps_;
  if (rope.material.bending_stiffness > 0) {
    double shortest = rope.rest[0];
    for (const double rest : rope.rest) shortest = math::min(shortest, rest);
    shortest = math::max(shortest, 0.5 * rope.segment);
    // The fastest mode of a row of particles with bending: ω = 4 √(EI/ρ)/l².
    const double omega =
        4 * math::sqrt(rope.material.bending_stiffness / rope.material.mass_per_length) / (shortest * shortest);
    const double rate = math::max(omega, 2 * rope.material.bending_damping * omega * omega);
    const double wanted = math::ceil(dt * rate / 1.2);
    // Twice as many where they are to be had: what folds sharply in free flight is stiffer than the straight row.
    needed = wanted > most_substeps ? most_substeps + 1
                                    : math::max(needed, int(math::min(2 * wanted, double(most_substeps))));
  }
  return needed;
}

void RopeSolver::prepare(Rope& rope) {
  rope.peak = 0;
  for (RopeGrip& grip : rope.grips) {
    const auto bias = [&](std::size_t node, Vec3d local) {
      const Vec3d place = grip.body < 0 ? local : set.bodies_[std::size_t(grip.body)].place(local);
      return (gap_rate / dt) * (place - rope.position[node]);
    };
    const std::size_t node = std::size_t(grip.attachment.node);
    grip.impulse = {};
    grip.bias = bias(node, grip.attachment.point);
    if (grip.attachment.clamped) grip.second_bias = bias(node == 0 ? 1 : node - 1, grip.second);
  }
}

void RopeSolver::find_touched(Rope& rope) {
  const int n = rope.count();
  rope.touched.clear();
  const auto touch = [&](int body) {
    if (body < 0 || !set.bodies_[std::size_t(body)].moves) return;
    for (const int known : rope.touched)
      if (known == body) return;
    rope.touched.push_back(body);
  };
  // In the order of particles, so that the bodies' matrix is narrow.
  for (int i = 0; i < n; ++i) {
    for (const RopeGrip& grip : rope.grips)
      if (grip.attachment.node == i) touch(grip.body);
    const auto touch_both = [&](const RopeContact& contact) {
      touch(contact.body);
      if (contact.coming >= 0) touch(set.shapes_[std::size_t(contact.coming)].body);
    };
    touch_both(rope.contacts[std::size_t(i)]);
    if (i + 1 < n) touch_both(rope.edges[std::size_t(i)].contact);
  }
  rope.columns.resize(rope.touched.size() * 6 * std::size_t(n));
}

void RopeSolver::forces(Rope& rope) {
  const std::size_t n = rope.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    rope.force[i] = rope.mass[i] * gravity;
    rope.start[i] = rope.guess[i] = rope.velocity[i];
  }
  add_bending(rope);
  add_twist(rope, set.bodies_, h);
  const RopeMaterial& m = rope.material;
  const double density = set.air_.density;
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (rope.broken[i]) {
      rope.theta[2 * i] = rope.theta[2 * i + 1] = 0;
      continue;
    }
    const Vec3d d = rope.position[i + 1] - rope.position[i];
    const double l = length(d), lightness = 2 * (1 / rope.mass[i] + 1 / rope.mass[i + 1]);
    rope.theta[2 * i] = implicit_share(h * h * m.axial_stiffness / rope.rest[i] * lightness);
    rope.theta[2 * i + 1] = h * h * lightness;
    rope.pull[i] = math::max(rope.tension[i], 0.0);
    if (density == 0 || (m.drag_coefficient == 0 && m.skin_coefficient == 0)) continue;
    const Vec3d middle = 0.5 * (rope.position[i] + rope.position[i + 1]);
    const Vec3d air = environment::wind_at(set.air_.wind, middle.y) + set.air_.beyond.at(middle) -
                      0.5 * (rope.velocity[i] + rope.velocity[i + 1]);
    const Vec3d t = normalize(d), along = dot(air, t) * t, across = air - along;
    const double surface = density * m.radius * l;
    const double c = surface * m.drag_coefficient * length(across);
    const double s = math::pi * surface * m.skin_coefficient * length(along);
    const double tame = 1 / (1 + h * (c + s) / (rope.mass[i] + rope.mass[i + 1]));
    const Vec3d half = (0.5 * tame) * (c * across + s * along);
    rope.force[i] += half;
    rope.force[i + 1] += half;
  }
}

void RopeSolver::hold_grips(Rope& rope) {
  for (RopeNode& node : rope.nodes) node = RopeNode{};
  for (const RopeGrip& grip : rope.grips) {
    const auto hold = [&](std::size_t i, Vec3d bias) {
      RopeNode& node = rope.nodes[i];
      node.hold = RopeHold::attached;
      node.body = grip.body;
      node.target = bias;
      if (grip.body < 0) return;
      const RopeBody& body = set.bodies_[std::size_t(grip.body)];
      node.arm = rope.position[i] - body.center;
      node.target += body.velocity_at(rope.position[i]);
    };
    const std::size_t i = std::size_t(grip.attachment.node);
    hold(i, grip.bias);
    if (grip.attachment.clamped) hold(i == 0 ? 1 : i - 1, grip.second_bias);
  }
}

void RopeSolver::assemble(Rope& rope) {
  const std::size_t n = rope.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    rope.diagonal[i] = Mat3d::diagonal({rope.mass[i], rope.mass[i], rope.mass[i]});
    rope.lower[i] = rope.upper[i] = Mat3d::zero();
    rope.momentum[i] = rope.mass[i] * rope.start[i] + h * rope.force[i];
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (rope.broken[i]) continue;
    const Vec3d d = rope.position[i + 1] - rope.position[i], closing = rope.guess[i + 1] - rope.guess[i];
    const double stiffness = rope.material.axial_stiffness / rope.rest[i];
    // The turning of a taut segment stiffens it across by T/l: with T as the last solution has it, since that of the
    // guess, a hair too long, would be far off.
    const double across = rope.pull[i] / math::max(length(d), 1e-9);
    const double axial = rope.theta[2 * i], lateral = implicit_share(across * rope.theta[2 * i + 1]);
    const Vec3d reach = d + (axial * h) * closing, aim = d + (lateral * h) * closing;
    const double l = length(reach);
    const Vec3d g = normalize_or(reach, Vec3d{0, 1, 0}, 1e-12), way = normalize_or(aim, g, 1e-12);
    const double damping = rope.material.axial_damping / rope.rest[i];
    const double wound = (i == 0 ? rope.winch[0] : 0) + (i + 2 == n ? rope.winch[1] : 0);  // m/s off the rest length
    const double tension = stiffness * (l - rope.rest[i]) + damping * (dot(way, closing) + wound * l / rope.rest[i]);
    // Damping acts along the line on which its rate is taken: across a fast turn anything else could drive.
    Mat3d c = (axial * h * h * stiffness) * math::outer(way, g) + (h * damping) * math::outer(way, way);
    if (lateral > 0) {
      const double turn = h * h * lateral * rope.pull[i] / math::max(length(aim), 1e-9);
      c = c + turn * (Mat3d::identity() + (-1.0) * math::outer(way, way));
    }
    const Vec3d pull = h * tension * way - c * closing;
    rope.diagonal[i] = rope.diagonal[i] + c;
    rope.diagonal[i + 1] = rope.diagonal[i + 1] + c;
    rope.upper[i] = (-1.0) * c;
    rope.lower[i + 1] = (-1.0) * c;
    rope.momentum[i] += pull;
    rope.momentum[i + 1] -= pull;
  }
  add_edges(rope);
}

void RopeSolver::solve(Rope& rope) {
  const std::size_t n = rope.position.size();
  // `factor` the inverse of the eliminated diagonal, `held` factor·upper; `right` is eliminated downward.
  for (std::size_t i = 0; i < n; ++i) {
    const RopeNode& node = rope.nodes[i];
    Mat3d d = project(node, rope.diagonal[i]);
    Vec3d r = project(node, rope.momentum[i]);
    if (node.hold == RopeHold::attached) {
      d = d + Mat3d::diagonal({rope.mass[i], rope.mass[i], rope.mass[i]});
    } else if (node.hold != RopeHold::none) {
      const Mat3d normal = math::outer(node.normal, node.normal);
      d = d + rope.mass[i] * normal + node.resistance * (Mat3d::identity() + (-1.0) * normal);
      r += node.grip;
    }
    r += held_part(node, rope.mass[i], node.target);
    if (i > 0) {
      const Mat3d low = project(node, rope.lower[i]);
      d = d + (-1.0) * (low * rope.held[i - 1]);
      r -= low * rope.right[i - 1];
    }
    rope.factor[i] = inverse(d);
    rope.right[i] = rope.factor[i] * r;
    rope.held[i] = rope.factor[i] * project(node, rope.upper[i]);
  }
  rope.solution[n - 1] = rope.right[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) rope.solution[i] = rope.right[i] - rope.held[i] * rope.solution[i + 1];

  rope.reach.resize(2 * rope.touched.size());
  for (std::size_t t = 0; t < rope.touched.size(); ++t) {
    // What a body moves ends at the next particles that others hold.
    const auto ends = [&](std::size_t i) {
      return rope.nodes[i].hold == RopeHold::attached && rope.nodes[i].body != rope.touched[t];
    };
    std::size_t low = n, high = 0;
    for (std::size_t i = 0; i < n; ++i)
      if (rope.nodes[i].hold != RopeHold::none && rope.nodes[i].body == rope.touched[t]) {
        low = math::min(low, i);
        high = i;
      }
    for (std::size_t e = 0; e < rope.edges.size(); ++e)
      if (rope.edges[e].point.hold != RopeHold::none && rope.edges[e].point.body == rope.touched[t]) {
        low = math::min(low, e);
        high = math::max(high, e + 1);
      }
    while (low > 0 && low < n && !ends(low)) --low;
    while (low < n && high + 1 < n && !ends(high)) ++high;
    if (low == n) low = 1, high = 0;
    rope.reach[2 * t] = int(low);
    rope.reach[2 * t + 1] = int(high);
    for (int k = 0; k < 6 && low <= high; ++k) {
      Vec3d* column = &rope.columns[(t * 6 + std::size_t(k)) * n];
      const Vec3d unit{double(k % 3 == 0), double(k % 3 == 1), double(k % 3 == 2)};
      for (std::size_t i = low; i <= high; ++i) {
        const RopeNode& node = rope.nodes[i];
        Vec3d r{};
        if (node.hold != RopeHold::none && node.body == rope.touched[t])
          r = held_part(node, rope.mass[i], k < 3 ? unit : cross(unit, node.arm));
        r += project(node, edge_push(rope, int(i), rope.touched[t], k < 3 ? unit : Vec3d{}, k < 3 ? Vec3d{} : unit));
        if (i > low) r -= project(node, rope.lower[i] * column[i - 1]);
        column[i] = rope.factor[i] * r;
      }
      for (std::size_t i = high; i-- > low;) column[i] -= rope.held[i] * column[i + 1];
    }
  }
}

/// What rounding left of the rows that nothing holds, by the same elimination: beside a stiffness of a million masses
/// it is a part of a blow's impulse.
void RopeSolver::refine(Rope& rope) {
  const std::size_t n = rope.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    Vec3d left{};
    if (rope.nodes[i].hold == RopeHold::none) {
      left = rope.momentum[i] - rope.diagonal[i] * rope.solution[i];
      if (i > 0) left -= rope.lower[i] * rope.solution[i - 1];
      if (i + 1 < n) left -= rope.upper[i] * rope.solution[i + 1];
      for (const std::size_t e : {i - 1, i}) {
        if (e >= rope.edges.size() || rope.edges[e].point.hold == RopeHold::none) continue;
        const RopeEdge& edge = rope.edges[e];
        left += (e == i ? 1 - edge.share : edge.share) * (edge.stiff * change_at(edge.point.body, edge.point.arm));
      }
    }
    if (i > 0) left -= project(rope.nodes[i], rope.lower[i]) * rope.right[i - 1];
    rope.right[i] = rope.factor[i] * left;
  }
  rope.solution[n - 1] += rope.right[n - 1];
  for (std::size_t i = n - 1; i-- > 0;) {
    rope.right[i] -= rope.held[i] * rope.right[i + 1];
    rope.solution[i] += rope.right[i];
  }
}

void RopeSolver::react(Rope& rope, bool coupled) {
  const std::size_t n = rope.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    RopeNode& node = rope.nodes[i];
    if (node.hold == RopeHold::none) continue;
    Vec3d row = rope.diagonal[i] * rope.solution[i] - rope.momentum[i];
    if (i > 0) row += rope.lower[i] * rope.solution[i - 1];
    if (i + 1 < n) row += rope.upper[i] * rope.solution[i + 1];
    node.reaction = row;
  }
  react_edges(rope, coupled);
}

double RopeSolver::change(Rope& rope) {
  double worst = 0;
  for (std::size_t i = 0; i + 1 < rope.position.size(); ++i) {
    if (rope.broken[i]) continue;
    const Vec3d closing = rope.guess[i + 1] - rope.guess[i];
    const Vec3d reach = rope.position[i + 1] - rope.position[i] + (rope.theta[2 * i] * h) * closing;
    const double l = length(reach);
    const Vec3d off = (rope.solution[i + 1] - rope.guess[i + 1]) - (rope.solution[i] - rope.guess[i]);
    worst = math::max(worst, h * h * length_squared(off) / (rope.rest[i] * rope.rest[i]));
    const double stretch = l - rope.rest[i] + rope.theta[2 * i] * h * dot(reach, off) / math::max(l, 1e-9);
    const double rate = dot(reach, closing + off) / math::max(l, 1e-9);
    rope.pull[i] =
        math::max((rope.material.axial_stiffness * stretch + rope.material.axial_damping * rate) / rope.rest[i], 0.0);
  }
  return worst;
}

void RopeSolver::advance(Rope& rope, int index) {
  const std::size_t n = rope.position.size();
  for (std::size_t i = 0; i < n; ++i) {
    rope.velocity[i] = rope.solution[i];
    rope.room[i] -= h * length(rope.velocity[i]);
    rope.position[i] += h * rope.velocity[i];
    const RopeNode& node = rope.nodes[i];
    RopeContact& contact = rope.contacts[i];
    if (node.hold != RopeHold::attached) keep_contact(contact, node, node.hold == RopeHold::none);
    if (node.hold == RopeHold::none || node.body < 0) continue;
    RopeBody& body = set.bodies_[std::size_t(node.body)];
    body.impulse -= node.reaction;
    body.turn -= cross(node.arm, node.reaction);
  }
  for (RopeEdge& edge : rope.edges) {
    if (edge.contact.near < 0) continue;
    const bool gone = edge.point.hold == RopeHold::none;
    keep_contact(edge.contact, edge.point, gone);
    if (gone || edge.point.body < 0) continue;
    RopeBody& body = set.bodies_[std::size_t(edge.point.body)];
    body.impulse -= edge.point.reaction;
    body.turn -= cross(edge.point.arm, edge.point.reaction);
  }
  for (RopeGrip& grip : rope.grips) {
    const std::size_t i = std::size_t(grip.attachment.node);
    grip.impulse -= rope.nodes[i].reaction;
    if (grip.attachment.clamped) grip.impulse -= rope.nodes[i == 0 ? 1 : i - 1].reaction;
  }
  for (std::size_t i = 0; i + 1 < n; ++i) {
    if (rope.broken[i]) continue;
    const double stretch = distance(rope.position[i], rope.position[i + 1]) - rope.rest[i];
    const double tension = rope.material.axial_stiffness * stretch / rope.rest[i];
    rope.tension[i] = tension;
    rope.peak = math::max(rope.peak, tension);
    if (rope.material.break_tension > 0 && tension > rope.material.break_tension) {
      rope.broken[i] = 1;
      rope.tension[i] = 0;
      set.breaks_.push_back({index, int(i), tension});
    }
  }
}

/// Of a solution that is not one: as much as turns and stretches no segment by more than a quarter.
void RopeSolver::take_part() {
  double worst = 0;
  for (const Rope& rope : set.ropes_)
    for (std::size_t i = 0; i + 1 < rope.position.size(); ++i) {
      if (rope.broken[i]) continue;
      const Vec3d off = (rope.solution[i + 1] - rope.start[i + 1]) - (rope.solution[i] - rope.start[i]);
      worst = math::max(worst, h * length(off) / rope.rest[i]);
    }
  const double share = worst > 0.25 ? 0.25 / worst : 1;
  for (Rope& rope : set.ropes_) {
    for (std::size_t i = 0; i < rope.position.size(); ++i) {
      rope.solution[i] = lerp(rope.start[i], rope.solution[i], share);
      rope.nodes[i].reaction *= share;
    }
    for (RopeEdge& edge : rope.edges) edge.point.reaction *= share;
  }
  for (double& change : set.right_) change *= share;
}

/// The start of the substep again.
void RopeSolver::undo() {
  set.bodies_ = set.bodies_before_;
  for (Rope& rope : set.ropes_) {
    rope.rest.front() = rope.before[0];
    rope.rest.back() = rope.before[1];
    for (RopeEdge& edge : rope.edges) edge.contact.state = edge.before;
  }
}

/// A share of the step. Of what does not settle, two of half its length; so of what comes or turns so fast that planes
/// and arms of the start tell nothing of its end.
void RopeSolver::substep(double duration, int halvings, bool searched) {
  h = duration;
  (void)search(false);
  if (alert && halvings > 0 && turns_on_its_way()) {
    substep(0.5 * duration, halvings - 1, false);
    substep(0.5 * duration, halvings - 1, false);
    return;
  }
  set.bodies_before_ = set.bodies_;
  for (RopeBody& body : set.bodies_) {
    if (!body.moves) continue;
    const Vec3d weight = (h * body.mass) * body.gravity;
    body.velocity += body.linear * weight;
    body.spin += transpose(body.mixed) * weight;
  }
  for (Rope& rope : set.ropes_) {
    rope.before[0] = rope.rest.front();
    rope.before[1] = rope.rest.back();
    weigh(rope);
    forces(rope);
    hold_grips(rope);
    place_contacts(rope);
    place_edges(rope);
  }
  if (alert && halvings > 0 && comes_far()) {
    undo();
    substep(0.5 * duration, halvings - 1, false);
    substep(0.5 * duration, halvings - 1, false);
    return;
  }
  place_crossings();
  double unsettled = 0;
  int settling = 0;  // iterations since planes were placed
  // What pushes of other ropes leave over is not for this iteration to end.
  const double rough = set.crossing_now_.empty() ? 1e-6 : 1e30;
  for (int iteration = 0; iteration < most_iterations; ++iteration, ++settling) {
    for (std::size_t r = 0; r < set.ropes_.size(); ++r) {
      Rope& rope = set.ropes_[r];
      assemble(rope);
      add_crossings(rope, int(r));
      solve(rope);
      react(rope, false);
    }
    const bool push = !set.crossing_now_.empty() && settling < cross_iterations;
    couple(push);
    bool again = push && push_crossings();
    for (Rope& rope : set.ropes_)
      for (int k = 0; alert && k < 2; ++k) refine(rope);
    for (Rope& rope : set.ropes_) {
      react(rope, true);
      if (iteration + 1 == most_iterations) {
        unsettled = math::max(unsettled, change(rope));
        continue;
      }
      again |= update_holds(rope, settling);
      const double off = change(rope);
      again |= off > (settling < turn_iterations ? 2e-9 : rough);
      // A guess turns no segment by more than about a third in one iteration.
      const double share = (off > 0.1 ? math::sqrt(0.1 / off) : 1) * (settling > settled ? 0.5 : 1);
      for (std::size_t i = 0; i < rope.position.size(); ++i)
        rope.guess[i] = share == 1 ? rope.solution[i] : lerp(rope.guess[i], rope.solution[i], share);
    }
    if (iteration < last_placing && (!again || settling == settled)) {
      bool placed = false;
      for (Rope& rope : set.ropes_) placed |= place_again(rope);
      again |= placed;
      if (placed) settling = -1;
    }
    if (!again) break;
  }
  // What goes farther than it was looked round for may meet what is not known.
  bool far = false;
  for (const Rope& rope : set.ropes_) far |= alert && strayed(rope, true);
  if (far && !searched) {
    undo();
    (void)search(true);
    substep(duration, halvings, true);
    return;
  }
  if ((unsettled > math::square(unsettled_strain) && halvings > most_fast_halvings - most_halvings) ||
      (alert && halvings > 0 && goes_wrong())) {
    undo();
    substep(0.5 * duration, halvings - 1, false);
    substep(0.5 * duration, halvings - 1, false);
    return;
  }
  if (unsettled > math::square(unsettled_strain)) take_part();
  commit_bodies();
  keep_crossings();
  for (Rope& rope : set.ropes_) hold_back(rope);
  for (std::size_t r = 0; r < set.ropes_.size(); ++r) advance(set.ropes_[r], int(r));
  move_bodies();
  elapsed += h;
}

Status RopeSolver::run() {
  gravity = Vec3d(world.definition().gravity);
  set.breaks_.clear();
  substeps = set.substeps_;
  for (std::size_t r = 0; r < set.ropes_.size(); ++r) {
    const int needed = needed_substeps(set.ropes_[r]);
    if (needed > most_substeps)
      return core::Error{core::text("rope ", r, ": bending_stiffness ", set.ropes_[r].material.bending_stiffness,
                                    " N·m² on segments of ", set.ropes_[r].segment, " m needs more than ",
                                    most_substeps, " substeps; expected longer segments, or a shorter step")};
    substeps = math::max(substeps, needed);
  }
  h = dt / substeps;
  gather();
  find_fast_shapes(world, dt, set.fast_bodies_, set.of_body_, set.fast_);
  for (Rope& rope : set.ropes_) {
    wind_winches(rope);
    find_contacts(rope, false);
  }
  find_crossings();
  find_mobility(0);
  for (Rope& rope : set.ropes_) {
    prepare(rope);
    find_touched(rope);
  }
  for (int s = 0; s < substeps; ++s) substep(dt / substeps, most_fast_halvings, false);
  for (Rope& rope : set.ropes_)
    for (RopeGrip& grip : rope.grips) grip.force = grip.impulse / dt;
  tell_crossings();
  hand_over();
  return {};
}

}  // namespace carom::particles::detail
