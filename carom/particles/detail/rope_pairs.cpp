// Segments of ropes against segments of ropes: pushes and grips that act on both alike, found together with the rows.
#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles::detail {

namespace {

constexpr double least_speed = 1e-3;  // m/s: what pairs are off by that asks for no further solve
constexpr int pair_sweeps = 4;
constexpr double pair_share = 0.8;       // of what would undo it, were it alone
constexpr double fastest_parting = 0.5;  // m/s at which an overlap is undone

/// Where two segments are nearest to each other. Of parallel ones, in the middle of where they lie side by side.
void nearest_shares(Vec3d p, Vec3d u, Vec3d q, Vec3d v, double& s, double& t) {
  const Vec3d w = p - q;
  const double a = dot(u, u), b = dot(u, v), c = dot(v, v), d = dot(u, w), e = dot(v, w), square = a * c - b * b;
  const auto inside = [](double x) { return math::clamp(x, 0.0, 1.0); };
  if (!(a > 0) || !(c > 0)) {
    s = t = 0.5;
    return;
  }
  if (square < 1e-3 * a * c) {
    const double low = math::max(math::min(-d, b - d) / a, 0.0), high = math::min(math::max(-d, b - d) / a, 1.0);
    s = inside(0.5 * (low + high));
  } else {
    s = inside((b * e - c * d) / square);
  }
  const double free = (b * s + e) / c;
  t = inside(free);
  if (t != free) s = inside((b * t - d) / a);
}

bool before(const RopePair& a, const RopePair& b) {
  for (std::size_t k = 0; k < 2; ++k) {
    if (a.rope[k] != b.rope[k]) return a.rope[k] < b.rope[k];
    if (a.segment[k] != b.segment[k]) return a.segment[k] < b.segment[k];
  }
  return false;
}

bool may_touch(const rigid::Filter& a, const rigid::Filter& b) {
  if (a.group != 0 && a.group == b.group) return a.group > 0;
  return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

}  // namespace

/// Both hang by the same thing at the same place: they cannot keep apart there.
bool RopeSolver::share_anchor(const Rope& a, int segment_a, const Rope& b, int segment_b) const {
  for (const RopeGrip& one : a.grips)
    for (const RopeGrip& other : b.grips) {
      const int i = one.attachment.node, j = other.attachment.node;
      if (i < segment_a || i > segment_a + 1 || j < segment_b || j > segment_b + 1) continue;
      if (one.attachment.body != other.attachment.body) continue;
      if (distance(a.position[std::size_t(i)], b.position[std::size_t(j)]) < a.material.radius + b.material.radius)
        return true;
    }
  return false;
}

void RopeSolver::find_pairs() {
  set.spans_.clear();
  Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (std::size_t r = 0; r < set.ropes_.size(); ++r) {
    const Rope& rope = set.ropes_[r];
    if (!rope.touch_ropes) continue;
    for (std::size_t e = 0; e < rope.rest.size(); ++e) {
      if (rope.broken[e]) continue;
      const double speed = math::max(length(rope.velocity[e]), length(rope.velocity[e + 1]));
      const double margin = 1.5 * rope.material.radius + 1.5 * dt * (speed + dt * length(gravity));
      const Vec3d more{margin, margin, margin};
      RopeSpan span{int(r), int(e), min(rope.position[e], rope.position[e + 1]) - more,
                    max(rope.position[e], rope.position[e + 1]) + more};
      low = min(low, span.low);
      high = max(high, span.high);
      set.spans_.push_back(span);
    }
  }
  set.old_pairs_.swap(set.pairs_);
  set.pairs_.clear();
  if (set.spans_.empty()) return;
  const Vec3d extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : (extent.y >= extent.z ? 1 : 2);
  std::sort(set.spans_.begin(), set.spans_.end(), [axis](const RopeSpan& a, const RopeSpan& b) {
    if (a.low[axis] != b.low[axis]) return a.low[axis] < b.low[axis];
    return a.rope != b.rope ? a.rope < b.rope : a.segment < b.segment;
  });
  for (std::size_t i = 0; i < set.spans_.size(); ++i)
    for (std::size_t j = i + 1; j < set.spans_.size() && set.spans_[j].low[axis] <= set.spans_[i].high[axis]; ++j) {
      const RopeSpan *a = &set.spans_[i], *b = &set.spans_[j];
      if (a->low.x > b->high.x || b->low.x > a->high.x || a->low.y > b->high.y || b->low.y > a->high.y ||
          a->low.z > b->high.z || b->low.z > a->high.z)
        continue;
      if (b->rope < a->rope || (b->rope == a->rope && b->segment < a->segment)) std::swap(a, b);
      const Rope &one = set.ropes_[std::size_t(a->rope)], &other = set.ropes_[std::size_t(b->rope)];
      if (a->rope == b->rope) {
        // What lies between them must be long enough for a fold.
        const int between = b->segment - a->segment - 1;
        if (between < 1 || between * one.segment < math::pi * one.material.radius) continue;
      } else if (!may_touch(one.filter, other.filter) || share_anchor(one, a->segment, other, b->segment)) {
        continue;
      }
      RopePair pair;
      pair.rope[0] = a->rope;
      pair.rope[1] = b->rope;
      pair.segment[0] = a->segment;
      pair.segment[1] = b->segment;
      pair.friction = math::sqrt(one.material.friction * other.material.friction);
      set.pairs_.push_back(pair);
    }
  std::sort(set.pairs_.begin(), set.pairs_.end(), before);
  std::size_t k = 0;
  for (RopePair& pair : set.pairs_) {
    while (k < set.old_pairs_.size() && before(set.old_pairs_[k], pair)) ++k;
    if (k < set.old_pairs_.size() && !before(pair, set.old_pairs_[k])) {
      pair.normal = set.old_pairs_[k].normal;
      pair.push = set.old_pairs_[k].push;
      pair.grip = set.old_pairs_[k].grip;
    }
  }
}

void RopeSolver::place_pairs() {
  for (RopePair& pair : set.pairs_) {
    const Rope* ropes[2] = {&set.ropes_[std::size_t(pair.rope[0])], &set.ropes_[std::size_t(pair.rope[1])]};
    const std::size_t i = std::size_t(pair.segment[0]), j = std::size_t(pair.segment[1]);
    const Vec3d p = ropes[0]->position[i], u = ropes[0]->position[i + 1] - p;
    const Vec3d q = ropes[1]->position[j], v = ropes[1]->position[j + 1] - q;
    nearest_shares(p, u, q, v, pair.share[0], pair.share[1]);
    const Vec3d apart = p + pair.share[0] * u - q - pair.share[1] * v;
    const double size = length(apart), radii = ropes[0]->material.radius + ropes[1]->material.radius;
    const Vec3d fallback =
        length_squared(pair.normal) > 0 ? pair.normal : normalize_or(cross(u, v), Vec3d{0, 1, 0}, 1e-12);
    Vec3d normal = size > 1e-9 ? apart / size : fallback;
    pair.separation = size - radii;
    if (size < 2 * radii && dot(normal, pair.normal) < -0.3) {
      // Gone through each other within a substep: still on the side where they came from.
      normal = -normal;
      pair.separation = -size - radii;
    }
    pair.normal = normal;
    pair.grip -= dot(pair.grip, normal) * normal;
    if (ropes[0]->broken[i] || ropes[1]->broken[j]) pair.separation = 1e30;
    if (pair.separation > 1e20) pair.push = 0, pair.grip = {};
    pair.least = pair.separation >= 0 ? -pair.separation / h : math::min(-0.2 * pair.separation / h, fastest_parting);
  }
}

void RopeSolver::add_pairs(Rope& rope, int index) const {
  for (const RopePair& pair : set.pairs_) {
    if (pair.push == 0) continue;
    const Vec3d impulse = h * (pair.push * pair.normal + pair.grip);
    for (std::size_t k = 0; k < 2; ++k) {
      if (pair.rope[k] != index) continue;
      const std::size_t e = std::size_t(pair.segment[k]);
      const Vec3d side = k == 0 ? impulse : -impulse;
      rope.momentum[e] += (1 - pair.share[k]) * side;
      rope.momentum[e + 1] += pair.share[k] * side;
    }
  }
}

/// The part of a row that a particle is free to answer with. What is held by a body that moves is taken as free: it
/// gives way with the body.
Vec3d RopeSolver::free_part(const RopeNode& node, Vec3d r) const {
  if (node.hold == RopeHold::none || (node.body >= 0 && set.bodies_[std::size_t(node.body)].moves)) return r;
  return node.hold == RopeHold::attached ? Vec3d{} : r - dot(node.normal, r) * node.normal;
}

/// Blocks of the inverse of a rope's rows, with the bodies that it holds as lumps: how its particles answer to an
/// impulse.
void RopeSolver::invert_rows(Rope& rope) const {
  const std::size_t n = rope.position.size();
  rope.inverse.resize(n);
  rope.pair_factor.resize(n);
  rope.pair_held.resize(n);
  const auto project = [&](const RopeNode& node, const Mat3d& m) {
    return Mat3d{free_part(node, m.cx), free_part(node, m.cy), free_part(node, m.cz)};
  };
  for (std::size_t i = 0; i < n; ++i) {
    const RopeNode& node = rope.nodes[i];
    Mat3d d = project(node, rope.diagonal[i]);
    const RopeBody* body =
        node.hold != RopeHold::none && node.body >= 0 ? &set.bodies_[std::size_t(node.body)] : nullptr;
    if (body && body->moves) {
      const double mobility = (math::trace(body->linear) + length_squared(node.arm) * math::trace(body->angular)) / 3;
      if (node.hold == RopeHold::attached && mobility > 0) d = d + (1 / mobility) * Mat3d::identity();
    } else if (node.hold == RopeHold::attached) {
      d = d + rope.mass[i] * Mat3d::identity();
    } else if (node.hold != RopeHold::none) {
      const Mat3d normal = math::outer(node.normal, node.normal);
      d = d + rope.mass[i] * normal + node.resistance * (Mat3d::identity() + (-1.0) * normal);
    }
    if (i > 0) d = d + (-1.0) * (project(node, rope.lower[i]) * rope.pair_held[i - 1]);
    rope.pair_factor[i] = math::inverse(d);
    rope.pair_held[i] = rope.pair_factor[i] * project(node, rope.upper[i]);
  }
  rope.inverse[n - 1] = rope.pair_factor[n - 1];
  for (std::size_t i = n - 1; i-- > 0;)
    rope.inverse[i] = rope.pair_factor[i] +
                      rope.pair_held[i] *
                          (rope.inverse[i + 1] * (project(rope.nodes[i + 1], rope.lower[i + 1]) * rope.pair_factor[i]));
}

/// What an impulse at a point of a segment changes of the velocities of its ends.
void RopeSolver::answer_of(const Rope& rope, std::size_t e, double share, Vec3d impulse, Vec3d& first,
                           Vec3d& second) const {
  const RopeNode &one = rope.nodes[e], &other = rope.nodes[e + 1];
  const Vec3d a = free_part(one, (1 - share) * impulse), b = free_part(other, share * impulse);
  const Vec3d far = rope.inverse[e + 1] * b, low = free_part(other, rope.lower[e + 1] * (rope.pair_factor[e] * a));
  first = free_part(one, rope.inverse[e] * a - rope.pair_held[e] * far);
  second = free_part(other, far - rope.inverse[e + 1] * low);
}

bool RopeSolver::update_pairs() {
  bool any = false;
  for (const RopePair& pair : set.pairs_) {
    const Rope &a = set.ropes_[std::size_t(pair.rope[0])], &b = set.ropes_[std::size_t(pair.rope[1])];
    const std::size_t i = std::size_t(pair.segment[0]), j = std::size_t(pair.segment[1]);
    const Vec3d against =
        lerp(a.solution[i], a.solution[i + 1], pair.share[0]) - lerp(b.solution[j], b.solution[j + 1], pair.share[1]);
    any |= pair.push > 0 || dot(against, pair.normal) < pair.least;
  }
  if (!any) return false;
  for (Rope& rope : set.ropes_) {
    if (!rope.touch_ropes) continue;
    invert_rows(rope);
    rope.trial = rope.solution;
  }
  double worst = 0;
  for (int sweep = 0; sweep < pair_sweeps; ++sweep)
    for (RopePair& pair : set.pairs_) {
      Rope* ropes[2] = {&set.ropes_[std::size_t(pair.rope[0])], &set.ropes_[std::size_t(pair.rope[1])]};
      const std::size_t at[2] = {std::size_t(pair.segment[0]), std::size_t(pair.segment[1])};
      const auto speed = [&](std::size_t k) {
        return lerp(ropes[k]->trial[at[k]], ropes[k]->trial[at[k] + 1], pair.share[k]);
      };
      const Vec3d against = speed(0) - speed(1);
      const double off = dot(against, pair.normal) - pair.least;
      if (pair.push == 0 && off >= 0) continue;
      Vec3d ends[2][2];
      double lightness = 0;
      for (std::size_t k = 0; k < 2; ++k) {
        answer_of(*ropes[k], at[k], pair.share[k], pair.normal, ends[k][0], ends[k][1]);
        lightness += dot(pair.normal, lerp(ends[k][0], ends[k][1], pair.share[k]));
      }
      if (!(lightness > 1e-12)) continue;
      const Vec3d old = pair.push * pair.normal + pair.grip;
      pair.push = math::max(pair.push - pair_share * off / (h * lightness), 0.0);
      const Vec3d slide = against - dot(against, pair.normal) * pair.normal;
      pair.grip -= slide * (0.5 / (h * lightness));
      const double held = length(pair.grip), most = pair.friction * pair.push;
      if (held > most) pair.grip = pair.grip * (held > 0 ? most / held : 0);
      const Vec3d impulse = h * (pair.push * pair.normal + pair.grip - old);
      for (std::size_t k = 0; k < 2; ++k) {
        const Vec3d side = k == 0 ? impulse : -impulse;
        answer_of(*ropes[k], at[k], pair.share[k], side, ends[k][0], ends[k][1]);
        ropes[k]->trial[at[k]] += ends[k][0];
        ropes[k]->trial[at[k] + 1] += ends[k][1];
      }
      if (sweep == 0) worst = math::max(worst, length(impulse) * lightness);
    }
  return worst > least_speed;
}

}  // namespace carom::particles::detail
