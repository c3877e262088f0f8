// Ropes against ropes, and a rope against itself: pairs of segments whose nearest points may not come closer than the
// radii. The impulses between them are found by Gauss and Seidel's method on what the implicit rows, with the bodies
// that hang on them, answer to a push at each of them. So a crossing bears a taut rope as well as a slack one.
#include <algorithm>

#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles::detail {

namespace {

constexpr double cross_recovery = 0.5;  // m/s, at which an overlap is undone at most
constexpr int cross_sweeps = 60;

/// Where two segments are nearest to each other, as shares of them: the minimum of a convex quadratic on a square.
void nearest_shares(Vec3d a, Vec3d u, Vec3d b, Vec3d v, double (&share)[2]) {
  const Vec3d w = a - b;
  const double uu = math::max(dot(u, u), 1e-300), vv = math::max(dot(v, v), 1e-300), uv = dot(u, v);
  const double uw = dot(u, w), vw = dot(v, w), determinant = uu * vv - uv * uv;
  // Of parallel ones the middle of what they have in common would do; any end does.
  double s = determinant > 1e-12 * uu * vv ? math::clamp((uv * vw - vv * uw) / determinant, 0.0, 1.0) : 0.5;
  const double t = math::clamp((uv * s + vw) / vv, 0.0, 1.0);
  s = math::clamp((uv * t - uw) / uu, 0.0, 1.0);
  share[0] = s;
  share[1] = math::clamp((uv * s + vw) / vv, 0.0, 1.0);
}

double largest(const Mat3d& m) {
  double most = 0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r) most = math::max(most, math::abs(m(r, c)));
  return most;
}

}  // namespace

void RopeSolver::find_crossings() {
  set.crossings_before_.swap(set.crossings_);
  set.crossings_.clear();
  const std::size_t count = set.ropes_.size();
  const auto touches = [&](const Rope& rope) { return rope.collide && rope.touch != RopeTouch::none; };
  std::size_t others = 0;
  bool itself = false;
  for (const Rope& rope : set.ropes_) {
    others += touches(rope);
    itself |= rope.collide && rope.touch == RopeTouch::itself;
  }
  if (others < 2 && !itself) return;

  const auto margin = [&](const Rope& rope, std::size_t i) {
    return rope.material.radius + 1.5 * dt * (length(rope.velocity[i]) + dt * length(gravity));
  };
  for (std::size_t r = 0; r < count; ++r) {
    Rope& rope = set.ropes_[r];
    if (!touches(rope)) continue;
    double most = 0;
    geometry::Bounds3d box{rope.position[0], rope.position[0]};
    for (std::size_t i = 0; i < rope.position.size(); ++i) {
      box = {min(box.low, rope.position[i]), max(box.high, rope.position[i])};
      most = math::max(most, margin(rope, i));
    }
    rope.around = grow(box, most);
  }
  std::vector<RopeStretch>& stretches = set.stretches_;
  stretches.clear();
  geometry::Bounds3d all{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
  for (std::size_t r = 0; r < count; ++r) {
    const Rope& rope = set.ropes_[r];
    if (!touches(rope)) continue;
    bool near = rope.touch == RopeTouch::itself;
    for (std::size_t q = 0; q < count && !near; ++q)
      near = q != r && touches(set.ropes_[q]) && overlaps(rope.around, set.ropes_[q].around);
    if (!near) continue;
    for (std::size_t e = 0; e + 1 < rope.position.size(); ++e) {
      if (rope.broken[e]) continue;
      const Vec3d a = rope.position[e], b = rope.position[e + 1];
      const double room = math::max(margin(rope, e), margin(rope, e + 1));
      stretches.push_back({grow(geometry::Bounds3d{min(a, b), max(a, b)}, room), int(r), int(e)});
      all = {min(all.low, stretches.back().box.low), max(all.high, stretches.back().box.high)};
    }
  }
  if (stretches.size() < 2) return;
  const Vec3d size = all.high - all.low;
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  std::sort(stretches.begin(), stretches.end(), [&](const RopeStretch& a, const RopeStretch& b) {
    if (a.box.low[axis] != b.box.low[axis]) return a.box.low[axis] < b.box.low[axis];
    return a.rope != b.rope ? a.rope < b.rope : a.segment < b.segment;
  });
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    for (std::size_t j = i + 1; j < stretches.size() && stretches[j].box.low[axis] <= stretches[i].box.high[axis];
         ++j) {
      const RopeStretch *a = &stretches[i], *b = &stretches[j];
      if (!overlaps(a->box, b->box)) continue;
      if (a->rope > b->rope || (a->rope == b->rope && a->segment > b->segment)) std::swap(a, b);
      const Rope &one = set.ropes_[std::size_t(a->rope)], &other = set.ropes_[std::size_t(b->rope)];
      if (a->rope == b->rope) {
        // Nearer along the rope than a hairpin of its own radius is long, they touch as neighbours do.
        const int apart = b->segment - a->segment;
        if (one.touch != RopeTouch::itself || apart < 2 || (apart - 1) * one.segment < math::pi * one.material.radius)
          continue;
      } else if (!filters_meet(one.filter, other.filter)) {
        continue;
      }
      RopeCross cross;
      cross.rope[0] = a->rope, cross.rope[1] = b->rope;
      cross.segment[0] = a->segment, cross.segment[1] = b->segment;
      if (tied_together(cross)) continue;
      cross.friction = math::sqrt(one.material.friction * other.material.friction);
      set.crossings_.push_back(cross);
    }
  }
  std::sort(set.crossings_.begin(), set.crossings_.end());
  // On which side of each other they were, that they cannot pass unseen: of the same pair, or of a neighbour of it.
  for (RopeCross& cross : set.crossings_) {
    const auto same = std::lower_bound(set.crossings_before_.begin(), set.crossings_before_.end(), cross);
    if (same != set.crossings_before_.end() && !(cross < *same)) {
      cross.side = same->side;
      cross.impulse = same->impulse;
      continue;
    }
    for (const RopeCross& old : set.crossings_before_)
      if (old.rope[0] == cross.rope[0] && old.rope[1] == cross.rope[1] &&
          math::abs(old.segment[0] - cross.segment[0]) <= 1 && math::abs(old.segment[1] - cross.segment[1]) <= 1 &&
          old.separation < 0) {
        cross.side = old.side;
        break;
      }
  }
}

void RopeSolver::place_crossings() {
  set.crossing_now_.clear();
  for (std::size_t c = 0; c < set.crossings_.size(); ++c) {
    RopeCross& cross = set.crossings_[c];
    const Rope* rope[2] = {&set.ropes_[std::size_t(cross.rope[0])], &set.ropes_[std::size_t(cross.rope[1])]};
    const std::size_t e[2] = {std::size_t(cross.segment[0]), std::size_t(cross.segment[1])};
    const double radii = rope[0]->material.radius + rope[1]->material.radius;
    const Vec3d pushed = cross.impulse;
    cross.impulse = {};
    if (rope[0]->broken[e[0]] || rope[1]->broken[e[1]]) continue;
    const Vec3d a = rope[0]->position[e[0]], b = rope[1]->position[e[1]];
    const Vec3d u = rope[0]->position[e[0] + 1] - a, v = rope[1]->position[e[1] + 1] - b;
    nearest_shares(a, u, b, v, cross.share);
    const Vec3d way = b + cross.share[1] * v - (a + cross.share[0] * u);
    const double gap = length(way);
    Vec3d out = cross.side;
    if (gap > 1e-9 * radii) out = way / gap;
    if (length_squared(out) == 0) out = normalize_or(math::cross(u, v), Vec3d{0, 1, 0}, 1e-30);
    // Overlapping, and on the other side than they were: they have passed each other and are to go back.
    const bool passed = gap < radii && dot(out, cross.side) < 0;
    cross.normal = passed ? -out : out;
    cross.separation = (passed ? -gap : gap) - radii;
    cross.side = cross.normal;
    // Where the nearest point is an end that another segment goes on from, the pair of that one tells as well.
    bool told = false;
    for (int k = 0; k < 2 && !told; ++k) {
      const double s = cross.share[k];
      const bool first = s <= 0 && e[k] > 0 && !rope[k]->broken[e[k] - 1];
      const bool last = s >= 1 && e[k] + 2 < rope[k]->position.size() && !rope[k]->broken[e[k] + 1];
      const Vec3d toward = k == 0 ? out : -out;
      if (last) told = true;  // the next one has it as its first
      if (first) told = dot(rope[k]->position[e[k] - 1] - rope[k]->position[e[k]], toward) > 0;
    }
    if (told) continue;
    const auto velocity = [&](int k) {
      return lerp(rope[k]->velocity[e[k]], rope[k]->velocity[e[k] + 1], cross.share[k]);
    };
    const double meeting = length(velocity(1) - velocity(0)) + 2 * h * length(gravity);
    if (cross.separation > 2 * h * meeting + 0.25 * radii) continue;
    cross.least =
        cross.separation >= 0 ? -cross.separation / h : math::min(-0.2 * cross.separation / h, cross_recovery);
    if (dot(pushed, cross.normal) > 0) cross.impulse = pushed;
    set.crossing_now_.push_back(int(c));
  }
}

void RopeSolver::add_crossings(Rope& rope, int index) const {
  for (const int c : set.crossing_now_) {
    const RopeCross& cross = set.crossings_[std::size_t(c)];
    for (int k = 0; k < 2; ++k) {
      if (cross.rope[k] != index) continue;
      const std::size_t e = std::size_t(cross.segment[k]);
      const Vec3d impulse = k == 0 ? -cross.impulse : cross.impulse;
      rope.momentum[e] += (1 - cross.share[k]) * impulse;
      rope.momentum[e + 1] += cross.share[k] * impulse;
    }
  }
}

/// What the rows answer to a unit impulse on side k of a crossing, in each direction.
void RopeSolver::answer_crossing(const RopeCross& cross, int k, RopeAnswer& answer) {
  const Rope& rope = set.ropes_[std::size_t(cross.rope[k])];
  const int n = rope.count(), e = cross.segment[k];
  answer.at.resize(std::size_t(n));
  const double sign = k == 0 ? -1 : 1;
  const auto node = [&](int i) -> const RopeNode& { return rope.nodes[std::size_t(i)]; };
  const auto at = [&](int i) -> Mat3d& { return answer.at[std::size_t(i)]; };
  const auto push = [&](int i, double share) { return (sign * share) * project(node(i), Mat3d::identity()); };
  at(e) = rope.factor[std::size_t(e)] * push(e, 1 - cross.share[k]);
  int high = e + 1;
  at(high) = rope.factor[std::size_t(high)] *
             (push(high, cross.share[k]) + (-1.0) * project(node(high), rope.lower[std::size_t(high)] * at(e)));
  // What has died away to a ten-millionth is left out.
  const double least = 1e-7 * math::max(largest(at(e)), largest(at(high)));
  while (high + 1 < n && largest(at(high)) > least) {
    ++high;
    const std::size_t i = std::size_t(high);
    at(high) = (-1.0) * (rope.factor[i] * project(node(high), rope.lower[i] * at(high - 1)));
  }
  int low = high;
  while (low > 0) {
    const std::size_t i = std::size_t(low - 1);
    const Mat3d back = rope.held[i] * at(low);
    if (low - 1 < e && largest(back) <= least) break;
    --low;
    at(low) = (low >= e ? at(low) : Mat3d::zero()) + (-1.0) * back;
  }
  answer.low = low;
  answer.high = high;
  answer.rope = cross.rope[k];
}

/// After the rows are eliminated, before the bodies' system is: answers of the rows, and what of them reaches bodies.
void RopeSolver::answer_crossings() {
  const std::size_t m = set.crossing_now_.size();
  if (set.crossing_answers_.size() < 2 * m) set.crossing_answers_.resize(2 * m);
  for (std::size_t c = 0; c < m; ++c)
    for (int k = 0; k < 2; ++k)
      answer_crossing(set.crossings_[std::size_t(set.crossing_now_[c])], k,
                      set.crossing_answers_[2 * c + std::size_t(k)]);
}

/// The right-hand sides of the bodies' system for a unit impulse at every crossing, three a crossing.
void RopeSolver::load_crossings(std::size_t size) {
  const std::size_t width = 3 * set.crossing_now_.size();
  set.crossing_right_.assign(size * width, 0.0);
  for (std::size_t c = 0; c < set.crossing_now_.size(); ++c) {
    const RopeCross& cross = set.crossings_[std::size_t(set.crossing_now_[c])];
    for (int k = 0; k < 2; ++k) {
      const RopeAnswer& answer = set.crossing_answers_[2 * c + std::size_t(k)];
      const Rope& rope = set.ropes_[std::size_t(answer.rope)];
      const auto add = [&](const RopeNode& node, const Mat3d& reaction) {
        const RopeBody& body = set.bodies_[std::size_t(node.body)];
        if (body.column < 0) return;
        for (int axis = 0; axis < 3; ++axis) {
          const Vec3d r = axis == 0   ? reaction.cx
                          : axis == 1 ? reaction.cy
                                      : reaction.cz,
                      turn = math::cross(node.arm, r);
          for (int q = 0; q < 3; ++q) {
            double* row = &set.crossing_right_[(std::size_t(body.column) * 6 + std::size_t(q)) * width + 3 * c];
            row[axis] += r[q];
            row[3 * width + std::size_t(axis)] += turn[q];
          }
        }
      };
      const double sign = k == 0 ? -1 : 1;
      const auto at = [&](int i) {
        return i >= answer.low && i <= answer.high ? answer.at[std::size_t(i)] : Mat3d::zero();
      };
      for (int i = math::max(answer.low - 1, 0); i <= math::min(answer.high + 1, rope.count() - 1); ++i) {
        const RopeNode& node = rope.nodes[std::size_t(i)];
        if (node.hold == RopeHold::none || node.body < 0) continue;
        const std::size_t j = std::size_t(i);
        Mat3d row = rope.diagonal[j] * at(i);
        if (i > 0) row = row + rope.lower[j] * at(i - 1);
        if (i + 1 < rope.count()) row = row + rope.upper[j] * at(i + 1);
        const double share = i == cross.segment[k]       ? 1 - cross.share[k]
                             : i == cross.segment[k] + 1 ? cross.share[k]
                                                         : 0;
        add(node, row + (-sign * share) * Mat3d::identity());
      }
      for (int e = math::max(answer.low - 1, 0); e < math::min(answer.high + 1, rope.count() - 1); ++e) {
        const RopeEdge& edge = rope.edges[std::size_t(e)];
        if (edge.point.hold == RopeHold::none || edge.point.body < 0) continue;
        add(edge.point, (-1.0) * (edge.stiff * ((1 - edge.share) * at(e) + edge.share * at(e + 1))));
      }
    }
  }
}

/// How the velocity of every crossing answers to an impulse at every other: by the rows, and by the bodies on them.
void RopeSolver::mix_crossings(bool bodies) {
  const std::size_t m = set.crossing_now_.size(), width = 3 * m;
  set.crossing_matrix_.assign(m * m, Mat3d::zero());
  for (std::size_t d = 0; d < m; ++d) {
    for (std::size_t c = 0; c < m; ++c) {
      const RopeCross& cross = set.crossings_[std::size_t(set.crossing_now_[c])];
      Mat3d& w = set.crossing_matrix_[d * m + c];
      for (int k = 0; k < 2; ++k) {
        const int e = cross.segment[k];
        const double sign = k == 0 ? -1 : 1, share[2] = {sign * (1 - cross.share[k]), sign * cross.share[k]};
        for (int l = 0; l < 2; ++l) {
          const RopeAnswer& answer = set.crossing_answers_[2 * d + std::size_t(l)];
          if (answer.rope != cross.rope[k]) continue;
          for (int q = 0; q < 2; ++q)
            if (e + q >= answer.low && e + q <= answer.high)
              w = w + share[q] * answer.at[std::size_t(e) + std::size_t(q)];
        }
        if (!bodies) continue;
        const Rope& rope = set.ropes_[std::size_t(cross.rope[k])];
        for (std::size_t t = 0; t < rope.touched.size(); ++t) {
          const std::size_t row = std::size_t(set.bodies_[std::size_t(rope.touched[t])].column) * 6;
          for (int q = 0; q < 2; ++q) {
            if (e + q < rope.reach[2 * t] || e + q > rope.reach[2 * t + 1]) continue;
            for (std::size_t axis = 0; axis < 6; ++axis) {
              const Vec3d moved = share[q] * rope.columns[(t * 6 + axis) * rope.position.size() + std::size_t(e + q)];
              const double* change = &set.crossing_right_[(row + axis) * width + 3 * d];
              w = w + Mat3d{change[0] * moved, change[1] * moved, change[2] * moved};
            }
          }
        }
      }
    }
  }
}

/// Impulses that keep the crossings apart. True: they changed.
bool RopeSolver::push_crossings() {
  const std::size_t m = set.crossing_now_.size();
  if (m == 0) return false;
  for (const int c : set.crossing_now_) {
    RopeCross& cross = set.crossings_[std::size_t(c)];
    const auto velocity = [&](int k) {
      const Rope& rope = set.ropes_[std::size_t(cross.rope[k])];
      const std::size_t e = std::size_t(cross.segment[k]);
      return lerp(rope.solution[e], rope.solution[e + 1], cross.share[k]);
    };
    cross.velocity = velocity(1) - velocity(0);
  }
  double changed = 0;
  for (int sweep = 0; sweep < cross_sweeps; ++sweep) {
    double most = 0;
    for (std::size_t d = 0; d < m; ++d) {
      RopeCross& cross = set.crossings_[std::size_t(set.crossing_now_[d])];
      const Vec3d n = cross.normal;
      const Mat3d& own = set.crossing_matrix_[d * m + d];
      const double direct = dot(n, own * n);
      if (!(direct > 0)) continue;
      const double before = dot(cross.impulse, n);
      const double push = math::max(before - (dot(cross.velocity, n) - cross.least) / direct, 0.0);
      const Vec3d after = cross.velocity + (push - before) * (own * n);
      // Friction by the larger of the two answers across the normal.
      const Vec3d s = math::perpendicular(n), t1 = math::normalize(s), t2 = math::cross(n, t1);
      const double a = dot(t1, own * t1), b = 0.5 * (dot(t1, own * t2) + dot(t2, own * t1)), c = dot(t2, own * t2);
      const double aside = 0.5 * (a + c) + math::sqrt(0.25 * (a - c) * (a - c) + b * b);
      Vec3d grip = cross.impulse - before * n;
      if (aside > 0) grip -= (after - dot(after, n) * n) / aside;
      const double held = length(grip), cone = cross.friction * push;
      if (held > cone) grip *= cone / held;
      const Vec3d more = push * n + grip - cross.impulse;
      if (length_squared(more) == 0) continue;
      cross.impulse += more;
      most = math::max(most, length(more) * direct);
      for (std::size_t c2 = 0; c2 < m; ++c2)
        set.crossings_[std::size_t(set.crossing_now_[c2])].velocity += set.crossing_matrix_[d * m + c2] * more;
    }
    changed = math::max(changed, most);
    if (most < 1e-6) break;
  }
  if (!math::is_finite(changed)) {  // a rope that is no number already: its crossings are not to spread it
    for (const int c : set.crossing_now_) set.crossings_[std::size_t(c)].impulse = {};
    return false;
  }
  return changed > 1e-4;
}

void RopeSolver::keep_crossings() {
  for (const int c : set.crossing_now_) {
    RopeCross& cross = set.crossings_[std::size_t(c)];
    cross.sum += cross.impulse;
  }
}

void RopeSolver::tell_crossings() {
  set.touching_.clear();
  for (const RopeCross& cross : set.crossings_) {
    if (length_squared(cross.sum) == 0) continue;
    RopeCrossing told;
    for (int k = 0; k < 2; ++k) {
      told.rope[k] = cross.rope[k];
      told.segment[k] = cross.segment[k];
      told.share[k] = cross.share[k];
    }
    told.normal = cross.normal;
    told.force = cross.sum / dt;
    set.touching_.push_back(told);
  }
}

}  // namespace carom::particles::detail
