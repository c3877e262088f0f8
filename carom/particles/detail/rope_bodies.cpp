// The bodies that ropes hold or touch: how they answer to impulses, and the dense system of their velocities.
#include "carom/geometry/mass_properties.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/rope_solver.h"

namespace carom::particles::detail {

using rigid::BodyType;
using rigid::Dim3;

namespace {

/// What a joint to something that does not move leaves of a body's freedom.
struct RopeFreedom {
  enum Kind { free, turns_about_point, turns_about_axis, slides, none } kind = free;
  Vec3d pivot{}, axis{};
};

template <class Def>
RopeFreedom freedom_of(const Def& def, const RopeBody& body, bool is_a) {
  RopeFreedom freedom;
  const math::Transform3f& frame = is_a ? def.frame_a : def.frame_b;
  freedom.pivot = body.position + rotate(body.rotation, Vec3d(frame.p));
  const auto axis = [&](Vec3d local) { return rotate(body.rotation, rotate(Quatd(frame.q), local)); };
  if constexpr (std::is_same_v<Def, rigid::HingeJointDef<Dim3>>) {
    freedom.kind = def.motor.enabled ? RopeFreedom::none : RopeFreedom::turns_about_axis;
    freedom.axis = axis({0, 0, 1});
  } else if constexpr (std::is_same_v<Def, rigid::SliderJointDef<Dim3>>) {
    freedom.kind = def.motor.enabled ? RopeFreedom::none : RopeFreedom::slides;
    freedom.axis = axis({1, 0, 0});
  } else if constexpr (std::is_same_v<Def, rigid::BallJointDef<Dim3>>) {
    freedom.kind = RopeFreedom::turns_about_point;
  } else if constexpr (std::is_same_v<Def, rigid::WeldJointDef<Dim3>>) {
    freedom.kind = def.linear.hertz == 0 && def.angular.hertz == 0 ? RopeFreedom::none : RopeFreedom::free;
  }
  return freedom;
}

void restrict_mobility(RopeBody& body, const Mat3d& inertia, const RopeFreedom& freedom) {
  const Vec3d arm = body.center - freedom.pivot;
  switch (freedom.kind) {
    case RopeFreedom::free:
      return;
    case RopeFreedom::none:
      body.linear = body.mixed = body.angular = Mat3d::zero();
      break;
    case RopeFreedom::slides:
      body.linear = math::outer(freedom.axis, freedom.axis) / body.mass;
      body.mixed = body.angular = Mat3d::zero();
      break;
    case RopeFreedom::turns_about_axis: {
      const Vec3d along = cross(freedom.axis, arm);
      const double share = dot(freedom.axis, inertia * freedom.axis) + body.mass * length_squared(along);
      body.linear = math::outer(along, along) / share;
      body.mixed = math::outer(along, freedom.axis) / share;
      body.angular = math::outer(freedom.axis, freedom.axis) / share;
      break;
    }
    case RopeFreedom::turns_about_point: {
      const Mat3d about =
          inertia + body.mass * (length_squared(arm) * Mat3d::identity() + (-1.0) * math::outer(arm, arm));
      const Mat3d inverse = math::inverse(about), s = math::skew(arm);
      body.linear = s * inverse * transpose(s);
      body.mixed = (-1.0) * (s * inverse);
      body.angular = inverse;
      break;
    }
  }
}

}  // namespace

int RopeSolver::body_index(rigid::BodyId id) {
  for (std::size_t i = 0; i < set.bodies_.size(); ++i)
    if (set.bodies_[i].id == id) return int(i);
  const auto state = world.state(id);
  if (!state) return -1;
  RopeBody body;
  body.id = id;
  body.type = state->type;
  body.awake = state->awake;
  body.position = state->pose.position;
  body.center = state->center_of_mass;
  body.rotation = Quatd(state->pose.rotation);
  body.velocity = Vec3d(state->linear_velocity);
  body.spin = Vec3d(state->angular_velocity);
  body.mass = double(state->mass);
  body.local_center = inverse_rotate(body.rotation, body.center - body.position);
  body.center += elapsed * body.velocity;  // of what is found late
  if (elapsed > 0) body.rotation = integrate(body.rotation, elapsed * body.spin);
  set.bodies_.push_back(body);
  return int(set.bodies_.size()) - 1;
}

void RopeSolver::find_mobility(std::size_t first) {
  bool any = false;
  for (std::size_t b = first; b < set.bodies_.size(); ++b) {
    RopeBody& body = set.bodies_[b];
    if (body.type != BodyType::dynamic || !body.awake || !(body.mass > 0)) continue;
    const auto properties = world.mass_properties3(body.id);
    const auto definition = world.body_definition(body.id);
    if (!properties || !definition) continue;
    const rigid::MotionLocks& locks = definition->locks;
    if (locks.x || locks.y || locks.z || locks.rotation_x || locks.rotation_y || locks.rotation_z) {
      // A lock in world axes keeps that axis still.
      const Vec3d moves{locks.x ? 0.0 : 1.0, locks.y ? 0.0 : 1.0, locks.z ? 0.0 : 1.0};
      body.linear = Mat3d::diagonal(moves / body.mass);
      const Mat3d inverse = math::inverse(geometry::rotate_inertia(properties->inertia, to_matrix(body.rotation)));
      const Vec3d turns{locks.rotation_x ? 0.0 : 1.0, locks.rotation_y ? 0.0 : 1.0, locks.rotation_z ? 0.0 : 1.0};
      body.angular = Mat3d::diagonal(turns) * inverse * Mat3d::diagonal(turns);
    } else {
      body.linear = Mat3d::diagonal(Vec3d{1, 1, 1} / body.mass);
      body.angular = math::inverse(geometry::rotate_inertia(properties->inertia, to_matrix(body.rotation)));
    }
    body.gravity = double(definition->gravity_scale) * gravity;
    body.moves = any = true;
  }
  if (any && world.counters().joints > 0) find_joints(first);
  find_support(first);
}

void RopeSolver::find_joints(std::size_t first) {
  world.joints(set.joints_);
  for (const rigid::JointId joint : set.joints_) {
    const auto state = world.joint_state(joint);
    if (!state) continue;
    for (std::size_t b = first; b < set.bodies_.size(); ++b) {
      RopeBody& body = set.bodies_[b];
      if (!body.moves || (body.id != state->body_a && body.id != state->body_b)) continue;
      const bool is_a = body.id == state->body_a;
      const rigid::BodyId other = is_a ? state->body_b : state->body_a;
      if (other != rigid::BodyId{}) {
        const auto there = world.state(other);
        if (!there || there->type == BodyType::dynamic) continue;  // its own freedom is not ours to say
      }
      const auto definition = world.joint_definition(joint);
      const auto properties = world.mass_properties3(body.id);
      if (!definition || !properties) continue;
      const Mat3d inertia = geometry::rotate_inertia(properties->inertia, to_matrix(body.rotation));
      const RopeFreedom freedom = std::visit([&](const auto& def) { return freedom_of(def, body, is_a); }, *definition);
      restrict_mobility(body, inertia, freedom);
      if (freedom.kind == RopeFreedom::none) body.moves = false;
    }
  }
}

// A body that lies on something does not fall as the ropes' step would have it. How much of its weight it felt in the
// last step, beside what the ropes did, is how much it is taken to feel in this one.
void RopeSolver::find_support(std::size_t first) {
  for (std::size_t b = first; b < set.bodies_.size(); ++b) {
    RopeBody& body = set.bodies_[b];
    if (!body.moves) continue;
    for (const RopeMemory& memory : set.memory_) {
      if (memory.id != body.id) continue;
      const Vec3d fall = (dt * body.mass) * (body.linear * body.gravity);
      const Vec3d seen = body.velocity - memory.velocity - memory.change;
      const double size = length_squared(fall);
      if (size > 0) body.gravity = math::clamp(dot(seen, fall) / size, 0.0, 1.0) * body.gravity;
      break;
    }
  }
}

void RopeSolver::gather() {
  set.bodies_.clear();
  set.shapes_.clear();
  for (Rope& rope : set.ropes_) {
    std::erase_if(rope.grips, [&](const RopeGrip& grip) {
      return grip.attachment.body != rigid::BodyId{} && !world.contains(grip.attachment.body);
    });
    for (RopeGrip& grip : rope.grips)
      grip.body = grip.attachment.body == rigid::BodyId{} ? -1 : body_index(grip.attachment.body);
  }
}

void RopeSolver::move_bodies() {
  for (RopeBody& body : set.bodies_) {
    body.carried += h * body.impulse;
    body.center += h * body.velocity;
    body.rotation = integrate(body.rotation, h * body.spin);
  }
}

// A force over the step would carry a body that a rope stops early in it beyond that rope: of the impulse of a blow
// such a share comes at the start that the body goes as far as it did in the ropes' step.
double RopeSolver::share_at_start(const RopeBody& body) const {
  constexpr double least_blow = 1;  // m/s
  constexpr double hard_blow = 10;  // m/s: one that comes late is begun the other way
  const double size = length_squared(body.impulse), blow = length(body.linear * body.impulse);
  if (!body.moves || substeps == 1 || !(blow > least_blow)) return 0;
  constexpr double even = 0.5;  // of dt, how long a steady force has acted
  return math::clamp((dot(body.carried, body.impulse) / (size * dt) - even) / (1 - even), blow > hard_blow ? -1.0 : 0.0,
                     1.0);
}

void RopeSolver::hand_over() {
  set.memory_.clear();
  for (const RopeBody& body : set.bodies_) {
    if (!body.moves) continue;
    const auto state = world.state(body.id);
    if (state)
      set.memory_.push_back(
          {body.id, Vec3d(state->linear_velocity), body.linear * body.impulse + body.mixed * body.turn});
  }
  for (RopeBody& body : set.bodies_) {
    if (body.type != BodyType::dynamic) continue;
    if (length_squared(body.impulse) == 0 && length_squared(body.turn) == 0) continue;
    // What sleeps is not woken by a rope that only lies on it.
    if (!body.awake && length(body.impulse) < 0.02 * body.mass * length(gravity) * dt) continue;
    const double start = share_at_start(body);
    const float per_step = float((1 - start) / dt);
    if (start != 0) {
      (void)world.add_impulse(body.id, Vec3f(start * body.impulse));
      (void)world.add_angular_impulse(body.id, Vec3f(start * body.turn));
    }
    (void)world.add_force(body.id, Vec3f(body.impulse) * per_step);
    (void)world.add_torque(body.id, Vec3f(body.turn) * per_step);
  }
}

// Unknowns are the changes of velocity Δu of the bodies that move, six each. A rope says with which impulses its
// particles answer: R = R₀ + R₁ Δu. With Δu = H Σ −(R, r × R): (1 + H Σ(R₁, r × R₁)) Δu = −H Σ(R₀, r × R₀).
// Bodies are numbered as ropes meet them, so that the matrix keeps close to its diagonal; it is solved by Gauss'
// elimination within its skyline.
void RopeSolver::couple(bool answers) {
  int blocks = 0;
  for (RopeBody& body : set.bodies_) body.column = -1;
  for (Rope& rope : set.ropes_)
    for (const int b : rope.touched)
      if (set.bodies_[std::size_t(b)].column < 0) set.bodies_[std::size_t(b)].column = blocks++;
  if (answers) answer_crossings();
  if (blocks == 0) {
    if (answers) mix_crossings(false);
    return;
  }
  const std::size_t size = std::size_t(blocks) * 6;
  set.matrix_.assign(size * size, 0.0);
  set.right_.assign(size, 0.0);
  set.first_block_.resize(std::size_t(blocks));
  if (answers) load_crossings(size);
  const std::size_t width = answers ? 3 * set.crossing_now_.size() : 0;  // right-hand sides beside the one
  for (int b = 0; b < blocks; ++b) set.first_block_[std::size_t(b)] = b;

  // Sums of the answers first (R, r × R by body), then H times them.
  const auto add = [&](std::size_t row, double* target, std::size_t stride, Vec3d arm, Vec3d reaction) {
    const Vec3d turn = cross(arm, reaction);
    for (int k = 0; k < 3; ++k) {
      target[(row + std::size_t(k)) * stride] += reaction[k];
      target[(row + 3 + std::size_t(k)) * stride] += turn[k];
    }
  };
  const auto link = [&](int one, int other) {
    int& first = set.first_block_[std::size_t(one)];
    first = math::min(first, other);
    int& back = set.first_block_[std::size_t(other)];
    back = math::min(back, one);
  };
  for (Rope& rope : set.ropes_) {
    const int n = rope.count();
    if (rope.touched.empty()) continue;
    for (int i = 0; i < n; ++i) {
      const RopeNode& node = rope.nodes[std::size_t(i)];
      if (node.hold == RopeHold::none || node.body < 0) continue;
      const RopeBody& body = set.bodies_[std::size_t(node.body)];
      if (body.column < 0) continue;
      const std::size_t row = std::size_t(body.column) * 6;
      add(row, set.right_.data(), 1, node.arm, node.reaction);
      for (std::size_t t = 0; t < rope.touched.size(); ++t) {
        const int low = rope.reach[2 * t], high = rope.reach[2 * t + 1];
        if (i < low || i > high) continue;
        const int other = set.bodies_[std::size_t(rope.touched[t])].column;
        bool near = false;
        for (int c = 0; c < 6; ++c) {
          const Vec3d* column = &rope.columns[(t * 6 + std::size_t(c)) * std::size_t(n)];
          Vec3d answer = rope.diagonal[std::size_t(i)] * column[i];
          if (i > low) answer += rope.lower[std::size_t(i)] * column[i - 1];
          if (i < high) answer += rope.upper[std::size_t(i)] * column[i + 1];
          const Vec3d unit{double(c % 3 == 0), double(c % 3 == 1), double(c % 3 == 2)};
          answer -= edge_push(rope, i, rope.touched[t], c < 3 ? unit : Vec3d{}, c < 3 ? Vec3d{} : unit);
          if (length_squared(answer) == 0) continue;
          near = true;
          add(row, set.matrix_.data() + std::size_t(other) * 6 + std::size_t(c), size, node.arm, answer);
        }
        if (near) link(body.column, other);
      }
    }
    for (std::size_t e = 0; e < rope.edges.size(); ++e) {
      const RopeNode& point = rope.edges[e].point;
      if (point.hold == RopeHold::none || point.body < 0) continue;
      const RopeBody& body = set.bodies_[std::size_t(point.body)];
      if (body.column < 0) continue;
      const std::size_t row = std::size_t(body.column) * 6;
      add(row, set.right_.data(), 1, point.arm, point.reaction);
      for (std::size_t t = 0; t < rope.touched.size(); ++t) {
        const int other = set.bodies_[std::size_t(rope.touched[t])].column;
        bool near = false;
        for (int c = 0; c < 6; ++c) {
          const Vec3d answer = edge_answer(rope, e, t, c);
          if (length_squared(answer) == 0) continue;
          near = true;
          add(row, set.matrix_.data() + std::size_t(other) * 6 + std::size_t(c), size, point.arm, answer);
        }
        if (near) link(body.column, other);
      }
    }
  }
  const auto through = [&](const RopeBody& body, double* target, std::size_t stride) {
    Vec3d j{target[0], target[stride], target[2 * stride]},
        l{target[3 * stride], target[4 * stride], target[5 * stride]};
    const Vec3d v = body.linear * j + body.mixed * l, w = transpose(body.mixed) * j + body.angular * l;
    for (int k = 0; k < 3; ++k) {
      target[std::size_t(k) * stride] = v[k];
      target[(3 + std::size_t(k)) * stride] = w[k];
    }
  };
  for (const RopeBody& body : set.bodies_) {
    if (body.column < 0) continue;
    const std::size_t row = std::size_t(body.column) * 6;
    through(body, &set.right_[row], 1);
    for (std::size_t k = 0; k < 6; ++k) set.right_[row + k] = -set.right_[row + k];
    for (std::size_t c = 0; c < width; ++c) through(body, &set.crossing_right_[row * width + c], width);
    for (std::size_t k = row * width; k < (row + 6) * width; ++k) set.crossing_right_[k] = -set.crossing_right_[k];
    for (std::size_t c = std::size_t(set.first_block_[std::size_t(body.column)]) * 6; c < size; ++c)
      through(body, &set.matrix_[row * size + c], size);
  }
  double* m = set.matrix_.data();
  for (std::size_t k = 0; k < size; ++k) m[k * size + k] += 1;
  // The skyline: a row reaches left to its first block; by symmetry of the pattern, a column as far up.
  for (std::size_t k = 0; k < size; ++k) {
    const double inverse = 1 / m[k * size + k];
    for (std::size_t i = k + 1; i < size; ++i) {
      if (std::size_t(set.first_block_[i / 6]) > k / 6) {
        i += 5 - i % 6;  // the whole block
        continue;
      }
      const double factor = m[i * size + k] * inverse;
      if (factor == 0) continue;
      for (std::size_t j = k + 1; j < size; ++j) {
        if (std::size_t(set.first_block_[j / 6]) > k / 6)
          j += 5 - j % 6;
        else
          m[i * size + j] -= factor * m[k * size + j];
      }
      set.right_[i] -= factor * set.right_[k];
      for (std::size_t c = 0; c < width; ++c)
        set.crossing_right_[i * width + c] -= factor * set.crossing_right_[k * width + c];
    }
  }
  for (std::size_t k = size; k-- > 0;) {
    double value = set.right_[k];
    for (std::size_t j = k + 1; j < size; ++j) value -= m[k * size + j] * set.right_[j];
    set.right_[k] = value / m[k * size + k];
    for (std::size_t c = 0; c < width; ++c) {
      double& sum = set.crossing_right_[k * width + c];
      for (std::size_t j = k + 1; j < size; ++j) sum -= m[k * size + j] * set.crossing_right_[j * width + c];
      sum /= m[k * size + k];
    }
  }

  for (Rope& rope : set.ropes_) {
    const int n = rope.count();
    for (std::size_t t = 0; t < rope.touched.size(); ++t) {
      const double* change = &set.right_[std::size_t(set.bodies_[std::size_t(rope.touched[t])].column) * 6];
      for (int c = 0; c < 6; ++c) {
        const Vec3d* column = &rope.columns[(t * 6 + std::size_t(c)) * std::size_t(n)];
        for (int i = rope.reach[2 * t]; i <= rope.reach[2 * t + 1]; ++i)
          rope.solution[std::size_t(i)] += change[c] * column[i];
      }
    }
  }
  if (answers) mix_crossings(true);
}

void RopeSolver::commit_bodies() {
  for (RopeBody& body : set.bodies_) {
    if (body.column < 0) continue;
    const double* change = &set.right_[std::size_t(body.column) * 6];
    body.velocity += Vec3d{change[0], change[1], change[2]};
    body.spin += Vec3d{change[3], change[4], change[5]};
  }
}

}  // namespace carom::particles::detail
