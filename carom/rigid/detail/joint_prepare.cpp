// From definitions to the records of a step, and back.
#include <algorithm>

#include "carom/rigid/detail/joint_law.h"
#include "carom/rigid/detail/joint_place.h"

namespace carom::rigid::detail {
namespace {

/// Which axis of a generic joint (others have their first linear one) a block is for.
int axis_of_part(JointPart part) {
  switch (part) {
    case part_linear_y:
    case part_turn_y:
      return 1;
    case part_linear_z:
    case part_turn_z:
      return 2;
    default:
      return 0;
  }
}

/// A coordinate of a generic joint, held or free.
void fill_axis(AxisLaw& law, const JointAxis& axis, const Clock& t, float stiffer) {
  if (!axis.free) {
    law.flags |= AxisLaw::spring | AxisLaw::rigid;
    return;
  }
  fill_spring(law, axis.spring, axis.target, t, stiffer);
  law.max_spring_impulse = axis.max_spring_force * t.push();
  fill_limit(law, axis.limit);
  if (axis.motor.enabled)
    fill_motor(law, axis.motor, t);
  else if (axis.friction > 0)
    fill_motor(law, {true, 0, axis.friction}, t);
}
/// A pair with the record's masses, at rest or with the speeds of `bodies`.
template <class D>
BodyPair<D> pair_of(JointRecord<D>& record, const SolverBody<D>* bodies = nullptr) {
  BodyPair<D> pair;
  if (bodies != nullptr) {
    if (record.body_a != none) {
      pair.velocity_a = bodies[record.body_a].linear_velocity;
      pair.spin_a = bodies[record.body_a].angular_velocity;
    }
    pair.velocity_b = bodies[record.body_b].linear_velocity;
    pair.spin_b = bodies[record.body_b].angular_velocity;
  }
  load_masses(pair, record);
  return pair;
}
template <class Axis>
void memorise(const AxisLaw& law, Axis& memory) {
  memory.spring = law.spring_impulse;
  memory.motor = law.motor_impulse;
  memory.lower = law.lower_impulse;
  memory.upper = law.upper_impulse;
}

/// What is remembered of a generic joint's axes, or of the only one of another.
template <class Data>
auto& linear_of(Data& data, int axis) {
  return axis == 0 ? data.memory.linear : data.more().linear[axis - 1];
}
template <class Data>
auto& turn_of(Data& data, int axis) {
  return axis == 1 ? data.more().turn : data.memory.turn[axis / 2];
}

template <class D>
void fill_linear(LinearAxis<D>& block, const JointData<D>& data, const JointPlacement<D>& at, JointRecord<D>& record,
                 const Clock& t, int axis) {
  block.arm_a = at.arm_a;
  block.arm_b = at.arm_b;
  block.offset = at.offset;
  block.axis = axis_of<D>(at.frame_a, axis);
  AxisLaw& law = block.law;
  if (const auto* slider = data.template get<SliderJointDef>()) {
    block.between_anchors = false;
    float stiffer = 1;
    if (slider->spring.hertz > 0) {
      const BodyPair<D> pair = pair_of(record);
      const auto row = block.row(pair);
      const auto turns = pair.inverse_inertia_a * row.lever_a + pair.inverse_inertia_b * row.lever_b;
      const float mobility = pair.row_inverse_mass(row.lever_a, row.lever_b);
      const auto locked = pair.inverse_inertia_a + pair.inverse_inertia_b;
      stiffer = mass_ratio_root(mobility, mobility - inner(turns, solve_mobility(locked, turns)));
    }
    fill_spring(law, slider->spring, slider->target_translation, t, stiffer);
    law.max_spring_impulse = slider->max_spring_force * t.push();
    fill_motor(law, slider->motor, t);
    fill_limit(law, slider->limit);
  } else if (const auto* generic = data.template get<GenericJointDef>()) {
    block.between_anchors = false;
    fill_axis(law, generic->linear[axis], t, 1);
  } else if (const auto* distance = data.template get<DistanceJointDef>()) {
    fill_spring(law, distance->spring, distance->length, t);
    fill_motor(law, distance->motor, t);
    fill_limit(law, distance->limit);
    if (data.internal) {
      const BodyPair<D> pair = pair_of(record);
      const auto row = block.row(pair);
      const double mobility = double(pair.row_inverse_mass(row.lever_a, row.lever_b));
      law.flags |= AxisLaw::spring;
      law.rest = distance->length;
      law.response = spring_response_of(data.more().stiffness * t.pace * t.pace, data.more().damping * t.pace,
                                        mobility > 0 ? 1 / mobility : 0, t.h);
    } else if (distance->rope) {
      law.flags |= AxisLaw::pull_only;
      if (!(distance->spring.hertz > 0)) {
        law.flags = std::uint8_t((law.flags | AxisLaw::upper) & ~AxisLaw::lower);
        law.high = distance->limit.enabled ? distance->limit.upper : distance->length;
      }
    } else if (is_rod(data)) {
      law.flags |= AxisLaw::spring | AxisLaw::rigid;
      law.rest = distance->length;
    }
  }
  remember(law, linear_of(data, axis));
}

template <class D>
void fill_twist(AngularAxis<D>& block, const JointData<D>& data, const JointPlacement<D>& at, JointRecord<D>& record,
                const Clock& t) {
  block.frame_a = at.frame_a;
  block.frame_b = at.frame_b;
  fill_twist(block.law, data, t);
  const JointSpring* spring = spring_of_twist(data);
  if (spring == nullptr) return;
  const BodyPair<D> pair = pair_of(record);
  float unused;
  const auto n = block.row(pair, false, unused);
  const auto turn_a = pair.inverse_inertia_a * n, turn_b = pair.inverse_inertia_b * n;
  const float mobility = inner(n, turn_a) + inner(n, turn_b);
  const auto anchors = cross(turn_b, at.arm_b) + cross(turn_a, at.arm_a);
  const auto held = solve_mobility(point_mobility(pair, at.arm_a, at.arm_b), anchors);
  block.law.response = stiffened_response(*spring, t, mass_ratio_root(mobility, mobility - dot(anchors, held)));
}

template <class D>
void fill_cone(AngularAxis<D>& block, const JointData<D>& data, const JointPlacement<D>& at) {
  block.frame_a = at.frame_a;
  block.frame_b = at.frame_b;
  block.kind = AngleKind::cone;
  block.law.flags = AxisLaw::upper;
  block.law.high = data.template get<BallJointDef>()->cone_angle;
  remember(block.law, data.memory.turn[0]);
}

template <class D>
void fill_turn(AngularAxis<D>& block, const JointData<D>& data, const JointPlacement<D>& at, const Clock& t, int axis) {
  block.frame_a = at.frame_a;
  block.frame_b = at.frame_b;
  if constexpr (D::dimension == 3) block.kind = AngleKind(int(AngleKind::cardan_x) + axis);
  block.law.flags = AxisLaw::periodic;
  fill_axis(block.law, data.template get<GenericJointDef>()->angular[axis], t, 1);
  remember(block.law, turn_of(data, axis));
}

template <class D>
typename D::Angular spin_axis(const typename D::Rotation& q, int i) {
  if constexpr (D::dimension == 2)
    return 1;
  else
    return axis_of<D>(q, i);
}

template <class D>
void fill_coupling(CouplingBlock<D>& block, const JointData<D>& data, const JointPlacement<D>& at) {
  block.arm_a = at.arm_a;
  block.arm_b = at.arm_b;
  block.offset = at.offset;
  block.impulse = data.memory.coupling;
  block.drift = data.memory.drift;
  block.spin_axis_a = spin_axis<D>(at.frame_a, 2);
  block.spin_axis_b = spin_axis<D>(at.frame_b, 2);
  if (const auto* gear = data.template get<GearJointDef>()) {
    block.ratio = gear->ratio;
  } else if (const auto* rack = data.template get<RackJointDef>()) {
    block.kind = CouplingKind::rack;
    block.ratio = rack->radius;
    block.slide_axis = axis_of<D>(at.frame_b, 0);
  } else if (const auto* screw = data.template get<ScrewJointDef>()) {
    block.kind = CouplingKind::screw;
    block.ratio = screw->pitch / (2 * pi_f);
    block.slide_axis = axis_of<D>(at.frame_a, 0);
    block.spin_axis_a = spin_axis<D>(at.frame_a, 0);
    block.slid = dot(at.offset + at.arm_b - at.arm_a, block.slide_axis);
  } else if (const auto* pulley = data.template get<PulleyJointDef>()) {
    block.kind = CouplingKind::pulley;
    block.ratio = pulley->ratio;
    block.length = pulley->length;
    block.from_ground_a = typename D::Vector(at.center_a - pulley->ground_a);
    block.from_ground_b = typename D::Vector(at.center_a - pulley->ground_b) + at.offset;
  }
}

template <class D>
void fill_path(PathPose<D>& pose, const JointStore<D>& joints, const JointData<D>& data, const JointPlacement<D>& at) {
  pose.arm_a = at.arm_a;
  pose.arm_b = at.arm_b;
  pose.offset = at.offset;
  pose.frame_a = at.frame_a;
  pose.curve = curve_of(joints, data);
  pose.place = data.more().path_place;
  pose.normal = data.more().path_normal;
  // Who was set down somewhere else is looked for on the whole path.
  const auto d = inverse_rotate(at.frame_a, at.offset + at.arm_b - at.arm_a);
  const auto away = [&](PathPlace place) { return math::distance(pose.curve.at(place).p, d); };
  pose.place = pose.curve.foot(d, pose.place);
  if (data.more().fresh_path() || away(pose.place) > 0.05f * pose.curve.length()) {
    const PathPlace nearest = pose.curve.nearest(d);
    if (away(nearest) < away(pose.place)) pose.place = nearest;
  }
}
template <class D>
void fill_along(AxisLaw& law, const PathJointDef<D>& path, const PathCurve<D>& curve, const Clock& t) {
  fill_spring(law, path.spring, path.target_distance, t);
  law.max_spring_impulse = path.max_spring_force * t.push();
  if (path.motor.enabled)
    fill_motor(law, path.motor, t);
  else if (path.friction > 0)
    fill_motor(law, {true, 0, path.friction}, t);
  if (path.closed) return;
  const float end = curve.length();
  fill_limit(law, path.limit.enabled ? JointLimit{true, max(path.limit.lower, 0.0f), min(path.limit.upper, end)}
                                     : JointLimit{true, 0, end});
}

template <class D>
void fill_angular(AngularBlock<D>& block, const JointData<D>& data, const JointPlacement<D>& at, const Clock& t) {
  block.frame_a = at.frame_a;
  block.frame_b = at.frame_b;
  block.impulse = data.memory.angular;
  JointSpring spring{};
  if (const auto* ball = data.template get<BallJointDef>()) {
    spring = ball->spring;
    block.frame_a = at.frame_a * ball->target_rotation;
  } else if (const auto* weld = data.template get<WeldJointDef>())
    spring = weld->angular;
  else if (const auto* mouse = data.template get<MouseJointDef>()) {
    // The hand also slows the body's turning, so that it does not swing for ever.
    const float keep = math::exp(-0.5f * mouse->spring.hertz * mouse->spring.damping_ratio * t.pace * t.h);
    block.rigid = false;
    block.response = {1 - keep, 0, keep, 0};
    return;
  } else if (const auto* motor = data.template get<MotorJointDef>()) {
    spring = motor->angular;
    block.max_impulse = motor->max_torque * t.push();
    block.frame_a = at.frame_a * motor->target_rotation;
    block.friction = !motor->hold_rotation;
    block.driven = !(motor->target_spin == typename D::Angular{});
    if constexpr (D::dimension == 2)
      block.drive = t.pace * motor->target_spin;
    else
      block.drive = rotate(at.frame_a, t.pace * motor->target_spin);
  }
  block.rigid = !(spring.hertz > 0);
  if (!block.rigid) block.response = stiffened_response(spring, t, 1);
}

template <class D>
void fill_point(PointBlock<D>& block, const JointData<D>& data, const JointPlacement<D>& at, const Clock& t) {
  block.arm_a = at.arm_a;
  block.arm_b = at.arm_b;
  block.offset = at.offset;
  block.impulse = data.memory.point;
  JointSpring spring{};
  if (const auto* weld = data.template get<WeldJointDef>())
    spring = weld->linear;
  else if (const auto* motor = data.template get<MotorJointDef>()) {
    spring = motor->linear;
    block.max_impulse = motor->max_force * t.push();
    block.arm_a += rotate(at.frame_a, motor->target_position);
    block.anywhere = !motor->hold_position;
    block.driven = !(motor->target_velocity == typename D::Vector{});
    block.drive = rotate(at.frame_a, t.pace * motor->target_velocity);
  } else if (const auto* mouse = data.template get<MouseJointDef>()) {
    spring = mouse->spring;
    block.max_impulse = mouse->max_force * t.push();
  }
  block.rigid = !(spring.hertz > 0);
  if (!block.rigid) block.response = spring_response(t.pace * spring.hertz, spring.damping_ratio, t.h);
}

}  // namespace

template <class D>
void fill_record(JointRecord<D>& record, const WorldImplementation<D>& world, float h) {
  const JointHeader& header = world.joints.headers[std::size_t(record.joint)];
  const JointData<D>& data = world.joints.at(record.joint);
  record.body_a = header.body[0];
  record.body_b = header.body[1];
  record.dynamic_a = record.body_a != none && world.bodies.is_dynamic(record.body_a);
  record.dynamic_b = world.bodies.is_dynamic(record.body_b);
  const auto fill_masses = [&](bool dynamic, std::int32_t body, float& inverse_mass, float& inverse_inertia, int side) {
    const BodyMotion<D>* motion = dynamic ? &world.bodies.motion[std::size_t(body)] : nullptr;
    const float share = dynamic ? load_share(*motion) : 0;
    inverse_mass = dynamic ? motion->inverse_mass * share : 0;
    if constexpr (D::dimension == 2) {
      inverse_inertia = dynamic ? motion->world_inverse_inertia * share : 0;
    } else if (record.isotropic) {
      inverse_inertia = dynamic ? motion->world_inverse_inertia.cx.x * share : 0;
    } else {
      ::new (static_cast<void*>(record.tensors() + side))
          Mat3f(dynamic ? motion->world_inverse_inertia * share : Mat3f::zero());
    }
  };
  fill_masses(record.dynamic_a, record.body_a, record.inverse_mass_a, record.inverse_inertia_a, 0);
  fill_masses(record.dynamic_b, record.body_b, record.inverse_mass_b, record.inverse_inertia_b, 1);
  Clock t = clock_of(world.bodies, header, h);
  t.in_tree = record.direct != Direct::nothing;
  const JointPlacement<D> at = place_joint(world.bodies, header, data);
  const JointMemory<D>& memory = data.memory;
  const auto moving = [&] { return pair_of(record, world.bodies.solver.data()); };
  const auto note = [&](auto& axis) {
    if (axis.law.has(AxisLaw::spring) && !axis.law.has(AxisLaw::rigid)) axis.note_speed(moving());
  };
  for_each_block(record, [&](JointPart part, auto& raw) {
    using Block = std::remove_reference_t<decltype(raw)>;
    Block& block = *::new (static_cast<void*>(&raw)) Block{};
    if constexpr (std::is_same_v<Block, LinearAxis<D>>)
      fill_linear(block, data, at, record, t, axis_of_part(part)), note(block);
    else if constexpr (std::is_same_v<Block, PointBlock<D>>) {
      fill_point(block, data, at, t);
      if (!block.rigid) block.note_speed(moving());
    } else if constexpr (std::is_same_v<Block, AngularAxis<D>>) {
      if (part == part_cone)
        fill_cone(block, data, at);
      else if (part == part_twist)
        fill_twist(block, data, at, record, t), note(block);
      else
        fill_turn(block, data, at, t, axis_of_part(part)), note(block);
    } else if constexpr (std::is_same_v<Block, CouplingBlock<D>>) {
      fill_coupling(block, data, at);
    } else if constexpr (std::is_same_v<Block, PathAxis<D>>) {
      fill_path(block.pose, world.joints, data, at);
      fill_along(block.law, *data.template get<PathJointDef>(), block.pose.curve, t);
      remember(block.law, memory.linear);
      note(block);
    } else if constexpr (std::is_same_v<Block, PathBlock<D>>) {
      fill_path(block.pose, world.joints, data, at);
      block.follow = data.template get<PathJointDef>()->follow;
      block.along_b = axis_of<D>(at.frame_b, 0);
      for (int i = 0; i < Block::most; ++i) block.impulse[i] = data.more().path[i];
    } else if constexpr (std::is_same_v<Block, AngularBlock<D>>) {
      if (part == part_friction) {
        block.friction = true;
        block.rigid = false;
        block.impulse = memory.friction;
        block.max_impulse = data.template get<BallJointDef>()->friction_torque * t.push();
      } else {
        fill_angular(block, data, at, t);
        if (!block.rigid) block.note_speed(moving());
      }
    } else if constexpr (std::is_same_v<Block, PinBlock<D>>) {
      block.arm_a = at.arm_a;
      block.arm_b = at.arm_b;
      block.offset = at.offset;
      block.impulse = memory.point;
    } else if constexpr (std::is_same_v<Block, SlideBlock<D>>) {
      block.arm_a = at.arm_a;
      block.arm_b = at.arm_b;
      block.offset = at.offset;
      for (int i = 0; i < Block::rows; ++i) block.impulse[i] = memory.slide[i];
      if constexpr (D::dimension == 2) {
        block.normal[0] = rotate(at.frame_a, Vec2f{0, 1});
      } else {
        block.normal[0] = rotate(at.frame_a, Vec3f{0, 1, 0});
        block.normal[1] = rotate(at.frame_a, Vec3f{0, 0, 1});
      }
    } else if constexpr (D::dimension == 3) {
      block.x_a = rotate(at.frame_a, Vec3f{1, 0, 0});
      block.y_a = rotate(at.frame_a, Vec3f{0, 1, 0});
      block.z_b = rotate(at.frame_b, Vec3f{0, 0, 1});
      block.impulse = memory.hinge;
    }
  });
}

/// Those with the same parts together, in whole blocks.
template <class D>
void fill_up_limbs(JointStore<D>& joints, std::size_t first, std::size_t width) {
  std::sort(joints.limbs.begin() + std::ptrdiff_t(first), joints.limbs.end());
  // From behind, so that each is moved once.
  std::size_t room = 0, count = joints.limbs.size() - first;
  for (std::size_t i = first, same = 0; i < first + count; ++i) {
    ++same;
    if (i + 1 < first + count && joints.limbs[i + 1].parts == joints.limbs[i].parts) continue;
    room += (same + width - 1) / width * width;
    same = 0;
  }
  std::size_t from = first + count, to = first + room;
  joints.limbs.resize(to);
  while (from > first) {
    const std::uint32_t parts = joints.limbs[from - 1].parts;
    std::size_t begin = from;
    while (begin > first && joints.limbs[begin - 1].parts == parts) --begin;
    const std::size_t same = from - begin, padded = (same + width - 1) / width * width;
    for (std::size_t i = padded; i-- > 0;)
      joints.limbs[to - padded + i] = i < same ? joints.limbs[begin + i] : typename JointStore<D>::Limb{parts, none};
    to -= padded;
    from = begin;
  }
}

/// How a joint is solved in this step: 0 by itself, else side by side with others, as a pin or with those parts.
constexpr std::uint32_t solved_as_pin = ~0u;
template <class D>
std::span<const std::uint32_t> joints_by_lanes(StepContext<D>& context) {
  const WorldImplementation<D>& world = context.world;
  std::size_t total = 0;
  for (int color = 0; color < overflow_color; ++color) total += world.graph.colors[color].joints.size();
  const std::span<std::uint32_t> all = context.arena.template allocate<std::uint32_t>(total);
  std::size_t first = 0;
  for (int color = 0; color < overflow_color; ++color) {
    const std::vector<std::int32_t>& joints = world.graph.colors[color].joints;
    std::uint32_t* const of_color = all.data() + first;
    first += joints.size();
    context.scheduler.parallel_for(int(joints.size()), 256, [&](int begin, int end, int) {
      for (int i = begin; i < end; ++i) {
        const std::int32_t joint = joints[std::size_t(i)];
        of_color[i] = goes_wide(world, joint) ? solved_as_pin : limb_parts(world, joint);
      }
    });
  }
  return all;
}

template <class D>
void prepare_joints(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  JointStore<D>& joints = world.joints;
  build_trees(world);
  joints.order.clear();
  joints.offset.clear();
  joints.color_begin.clear();
  joints.pins.clear();
  joints.pin_begin.clear();
  joints.limbs.clear();
  joints.limb_begin.clear();
  const std::size_t width = std::size_t(world.kernels.width);
  std::uint32_t units = 0;
  const std::uint32_t* by_lanes = joints_by_lanes(context).data();
  for (const GraphColor& color : world.graph.colors) {
    const bool overflows = &color == &world.graph.colors[overflow_color];
    joints.color_begin.push_back(std::int32_t(joints.order.size()));
    joints.pin_begin.push_back(std::int32_t(joints.pins.size() / width));
    joints.limb_begin.push_back(std::int32_t(joints.limbs.size() / width));
    const std::size_t first_limb = joints.limbs.size();
    for (const std::int32_t joint : color.joints) {
      if (const std::uint32_t parts = overflows ? 0 : *by_lanes++; parts != 0) {
        if (parts == solved_as_pin)
          joints.pins.push_back(joint);
        else
          joints.limbs.push_back({parts, joint});
        continue;
      }
      joints.order.push_back(joint);
      joints.offset.push_back(units);
      const std::int32_t tree = joints.tree_of(joint);
      if (tree != none) joints.trees.joints[std::size_t(tree)].record = units;
      units += record_units<D>(joints.at(joint).parts, is_isotropic(world, joint));
    }
    while (joints.pins.size() % width != 0) joints.pins.push_back(none);
    fill_up_limbs(joints, first_limb, width);
  }
  joints.limb_begin.push_back(std::int32_t(joints.limbs.size() / width));
  joints.pin_begin.push_back(std::int32_t(joints.pins.size() / width));
  joints.color_begin.push_back(std::int32_t(joints.order.size()));
  joints.offset.push_back(units);
  if (joints.records.size() < units) joints.records.resize(units);
  context.scheduler.parallel_for(int(joints.order.size()), 64, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      auto& record = *::new (static_cast<void*>(&joints.records[joints.offset[std::size_t(i)]])) JointRecord<D>{};
      record.joint = joints.order[std::size_t(i)];
      record.isotropic = is_isotropic(world, record.joint);
      record.parts = joints.at(record.joint).parts;
      record.direct = joints.tree_of(record.joint) != none ? Direct::rows : Direct::nothing;
      fill_record(record, world, context.h);
    }
  });
  prepare_trees(context);
  prepare_pins(context);
  prepare_limbs(context);
}

/// Keeps the impulses for the next step, and what the joint exerted.
template <class D>
void store_joints(StepContext<D>& context) {
  JointStore<D>& joints = context.world.joints;
  store_trees(context);
  store_pins(context);
  store_limbs(context);
  context.scheduler.parallel_for(int(joints.order.size()), 64, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      auto& record = *std::launder(reinterpret_cast<JointRecord<D>*>(&joints.records[joints.offset[std::size_t(i)]]));
      JointData<D>& data = joints.at(record.joint);
      JointMemory<D>& memory = data.memory;
      BodyPair<D> pair;
      load_turns(pair, record, context.bodies);
      typename D::Vector force{};
      typename D::Angular torque{};
      for_each_block(record, [&](JointPart part, auto& block) {
        using Block = std::remove_cvref_t<decltype(block)>;
        if constexpr (std::is_same_v<Block, LinearAxis<D>>) {
          memorise(block.law, linear_of(data, axis_of_part(part)));
          force += block.law.total() * block.row(pair).n;
        } else if constexpr (std::is_same_v<Block, PointBlock<D>> || std::is_same_v<Block, PinBlock<D>>) {
          memory.point = block.impulse;
          force += block.impulse;
        } else if constexpr (std::is_same_v<Block, AngularAxis<D>>) {
          if (part == part_twist)
            memorise(block.law, memory.turn[last_turn<D>]);
          else
            memorise(block.law, turn_of(data, axis_of_part(part)));
          float unused;
          torque += block.law.total() * block.row(pair, false, unused);
        } else if constexpr (std::is_same_v<Block, AngularBlock<D>>) {
          (part == part_friction ? memory.friction : memory.angular) = block.impulse;
          torque += block.impulse;
        } else if constexpr (std::is_same_v<Block, CouplingBlock<D>>) {
          const auto row = block.row(pair);
          memory.coupling = block.impulse;
          if (block.kind != CouplingKind::pulley) memory.drift = row.error;
          force += block.impulse * row.along_b;
          torque += block.impulse * row.about_b;
        } else if constexpr (std::is_same_v<Block, PathAxis<D>>) {
          memorise(block.law, memory.linear);
          force += block.law.total() * block.row(pair).n;
        } else if constexpr (std::is_same_v<Block, PathBlock<D>>) {
          typename Block::Row row[Block::most];
          const int count = block.rows(pair, row);
          const auto b = rotate(pair.turn_b, block.pose.arm_b);
          for (int k = 0; k < count; ++k) {
            data.more().path[k] = block.impulse[k];
            force += block.impulse[k] * row[k].n;
            torque += block.impulse[k] * (row[k].lever_b - cross(b, row[k].n));
          }
          data.more().path_place = block.pose.place;
          data.more().path_normal = block.pose.normal;
        } else if constexpr (std::is_same_v<Block, SlideBlock<D>>) {
          typename Block::Row row[Block::rows];
          block.directions(pair, row);
          for (int k = 0; k < Block::rows; ++k) {
            memory.slide[k] = block.impulse[k];
            force += block.impulse[k] * row[k].n;
          }
        } else {
          memory.hinge = block.impulse;
          Vec3f u, v;
          Vec2f error;
          block.directions(pair, u, v, error);
          torque += block.impulse.x * u + block.impulse.y * v;
        }
      });
      data.force = force * context.inverse_h;
      data.torque = torque * context.inverse_h;
    }
  });
}

template void fill_record(JointRecord<Dim2>&, const WorldImplementation<Dim2>&, float);
template void fill_record(JointRecord<Dim3>&, const WorldImplementation<Dim3>&, float);
template void prepare_joints(StepContext<Dim2>&);
template void prepare_joints(StepContext<Dim3>&);
template void store_joints(StepContext<Dim2>&);
template void store_joints(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
