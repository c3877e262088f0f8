// World's members about effectors.
#pragma once

#include "carom/rigid/detail/effector_act.h"
#include "carom/rigid/detail/joint_check.h"
#include "carom/rigid/detail/joint_record.h"

namespace carom::rigid {
namespace detail {

template <class D>
struct EffectorCheck {
  Complaint& c;
  const WorldImplementation<D>& world;

  void target(const EffectorTarget& e) {
    if (!e.body.is_null()) c.status(world.bodies.slots.check(e.body, "body"));
  }
  void operator()(const SphericalGravity<D>& e) {
    target(e);
    c.vector("center", e.center);
    c.not_negative("gm", e.gm);
    c.positive("minimum_radius", e.minimum_radius);
  }
  void operator()(const LinearDrag<D>& e) {
    target(e);
    c.not_negative("coefficient", e.coefficient);
    c.not_negative("angular_coefficient", e.angular_coefficient);
  }
  void operator()(const QuadraticDrag<D>& e) {
    target(e);
    c.not_negative("density", e.density);
    c.not_negative("drag_coefficient", e.drag_coefficient);
    c.not_negative("area", e.area);
    c.vector("point", e.point);
    c.not_negative("angular_coefficient", e.angular_coefficient);
  }
  void operator()(const Wind<D>& e) { c.vector("velocity", e.velocity); }
  void operator()(const SpringDamper<D>& e) {
    c.status(world.bodies.slots.check(e.body_a, "body_a"));
    if (!e.body_b.is_null()) c.status(world.bodies.slots.check(e.body_b, "body_b"));
    if (!c.none_yet()) return;
    if (e.body_a == e.body_b) c.say("body_a and body_b are the same body, expected two");
    const bool a = world.bodies.is_dynamic(world.bodies.slots.slot(e.body_a));
    const bool b = !e.body_b.is_null() && world.bodies.is_dynamic(world.bodies.slots.slot(e.body_b));
    if (!a && !b) c.say("no end of the spring is on a dynamic body, expected at least one");
    c.vector("point_a", e.point_a);
    c.vector("point_b", e.point_b);
    c.not_negative("rest_length", e.rest_length);
    c.not_negative("stiffness", e.stiffness);
    c.not_negative("damping", e.damping);
    c.not_negative("break_force", e.break_force);
  }
  void operator()(const Buoyancy<D>& e) {
    target(e);
    c.not_negative("density", e.density);
    c.finite("level", e.level);
    c.not_negative("linear_drag", e.linear_drag);
    c.not_negative("angular_drag", e.angular_drag);
    c.vector("current", e.current);
    if (e.wave_count < 0 || e.wave_count > 4) c.say(core::refused("wave_count", e.wave_count, "0 … 4"));
    c.vector("added_mass", e.added_mass);
    for (int i = 0; c.none_yet() && i < D::dimension; ++i) c.not_negative("added_mass", double(e.added_mass[i]));
    if constexpr (D::dimension == 2) {
      c.not_negative("added_inertia", double(e.added_inertia));
    } else {
      c.vector("added_inertia", e.added_inertia);
      for (int i = 0; c.none_yet() && i < 3; ++i) c.not_negative("added_inertia", double(e.added_inertia[i]));
    }
    for (int i = 0; c.none_yet() && i < e.wave_count; ++i) {
      c.finite(core::text("waves[", i, "].amplitude"), e.waves[i].amplitude);
      c.positive(core::text("waves[", i, "].wavelength"), e.waves[i].wavelength);
      c.finite(core::text("waves[", i, "].phase"), e.waves[i].phase);
    }
  }
  void operator()(const Thrust<D>& e) {
    c.status(world.bodies.slots.check(e.body, "body"));
    c.vector("point", e.point);
    c.vector("force", e.force);
  }
  void operator()(const RadialField<D>& e) {
    target(e);
    c.vector("center", e.center);
    c.finite("strength", e.strength);
    c.positive("reference", e.reference);
    c.finite("exponent", e.exponent);
    c.not_negative("range", e.range);
  }
  void operator()(const VortexField<D>& e) {
    target(e);
    c.vector("center", e.center);
    if constexpr (D::dimension == 3) {
      c.vector("axis", e.axis);
      if (c.none_yet() && !(math::length(e.axis) > 1e-6f)) c.say("axis is zero, expected a direction");
    }
    c.finite("circulation", e.circulation);
    c.positive("core_radius", e.core_radius);
    c.not_negative("rate", e.rate);
  }
  void operator()(const Surroundings<D>& e) {
    if (e.environment == nullptr) c.say("environment is null, expected one");
  }
  void operator()(const BodyDrag<D>& e) {
    target(e);
    using Kind = forces::DragLaw::Kind;
    if (e.law.kind < Kind::constant || e.law.kind > Kind::by_mach)
      c.say(core::refused("law.kind", int(e.law.kind), "one of the laws"));
    if (e.law.kind == Kind::constant) c.not_negative("law.coefficient", e.law.coefficient);
    if (c.none_yet() && (e.law.kind == Kind::by_reynolds || e.law.kind == Kind::by_mach)) {
      c.status(forces::validate(e.law.table));
      for (const forces::CoefficientPoint& p : e.law.table.points())
        if (c.none_yet()) c.not_negative("law.table", p.y);
    }
    c.positive("diameter", e.diameter);
    c.not_negative("area", e.area);
    c.vector("point", e.point);
    c.not_negative("density", e.density);
    c.positive("viscosity", e.viscosity);
    c.positive("speed_of_sound", e.speed_of_sound);
  }
  void operator()(const MagnusLift<D>& e) {
    target(e);
    c.not_negative("law.a", e.law.a);
    c.positive("law.b", e.law.b);
    c.positive("radius", e.radius);
    c.not_negative("density", e.density);
  }
  void direction(const char* name, const auto& v) {
    c.vector(name, v);
    if (c.none_yet() && !(math::length(v) > 1e-6f)) c.say(core::text(name, " is zero, expected a direction"));
  }
  void operator()(const LiftingSurface<D>& e) {
    c.status(world.bodies.slots.check(e.body, "body"));
    if (c.none_yet()) c.status(forces::validate(e.law));
    c.vector("point", e.point);
    direction("forward", e.forward);
    if constexpr (D::dimension == 3) {
      direction("up", e.up);
      if (c.none_yet() && !(math::length(math::cross(normalize(e.forward), normalize(e.up))) > 1e-3f))
        c.say("forward and up are parallel, expected two directions");
    }
    c.not_negative("area", e.area);
    c.not_negative("chord", e.chord);
    c.not_negative("density", e.density);
  }
  void operator()(const CylinderDrag<D>& e) {
    c.status(world.bodies.slots.check(e.body, "body"));
    c.vector("point", e.point);
    direction("axis", e.axis);
    c.positive("diameter", e.diameter);
    c.positive("length", e.length);
    c.not_negative("density", e.density);
    c.positive("viscosity", e.viscosity);
  }
  void operator()(const TurningFrame<D>& e) {
    target(e);
    if constexpr (D::dimension == 2)
      c.finite("rate", double(e.rate));
    else
      c.vector("rate", e.rate);
    c.vector("center", e.center);
  }
  void operator()(const ElectromagneticField<D>& e) {
    target(e);
    c.finite("charge", e.charge);
    c.vector("electric", e.electric);
    c.vector("magnetic", e.magnetic);
  }
  void operator()(const CustomEffector<D>& e) {
    target(e);
    if (!e.model) c.say("model is empty, expected a function");
  }
};

template <class D>
Status check_effector(const WorldImplementation<D>& world, const EffectorDef<D>& definition, std::string_view call) {
  Complaint complaint(call);
  std::visit(EffectorCheck<D>{complaint, world}, definition);
  if (!complaint.none_yet()) return complaint.error();
  return {};
}

/// Takes effect: a spring becomes a joint of its own, and sleepers that it is about wake.
template <class D>
void install_effector(WorldImplementation<D>& world, std::int32_t slot, const EffectorDef<D>& definition) {
  EffectorData<D>& effector = world.effectors.data[std::size_t(slot)];
  if (effector.joint != none) release_joint(world, effector.joint);
  effector.joint = none;
  effector.definition = definition;
  if (const auto* spring = std::get_if<SpringDamper<D>>(&definition)) {
    JointStore<D>& joints = world.joints;
    const JointId id = joints.slots.allocate();
    const std::int32_t joint = joints.slots.slot(id);
    DistanceJointDef<D> def;
    def.length = float(spring->rest_length);
    def.break_force = float(spring->break_force);
    def.collide_connected = true;
    if (spring->body_b.is_null()) {
      def.body_b = spring->body_a;
      def.frame_b.p = spring->point_a;
    } else {
      def.body_a = spring->body_a;
      def.body_b = spring->body_b;
      def.frame_a.p = spring->point_a;
      def.frame_b.p = typename D::Vector(spring->point_b);
    }
    JointData<D>& data = joints.make(joint, def, true);
    find_parts(data);
    JointMore<D>& more = data.more();
    more.stiffness = spring->stiffness;
    more.damping = spring->damping;
    more.world_anchor = spring->point_b;
    JointHeader& header = joints.headers[std::size_t(joint)];
    header.collide_connected = true;
    header.body[0] = spring->body_b.is_null() ? none : world.bodies.slots.slot(def.body_a);
    header.body[1] = world.bodies.slots.slot(def.body_b);
    ++joints.internal_count;
    if (may_break(data.frames())) ++joints.breakable_count;
    effector.joint = joint;
    attach_joint(world, joint);
    return;
  }
  std::visit(
      [&](const auto& e) {
        if constexpr (requires { e.body; }) {
          if (!e.body.is_null() && world.bodies.is_dynamic(world.bodies.slots.slot(e.body)))
            wake_body(world, std::int32_t(world.bodies.slots.slot(e.body)));
        }
      },
      definition);
}

template <class D>
Result<std::int32_t> find_effector(const WorldImplementation<D>& world, EffectorId effector, std::string_view call) {
  if (const Status s = world.effectors.slots.check(effector, "effector"); !s.ok())
    return core::Error{core::text(call, ": ", s.error().message)};
  return std::int32_t(world.effectors.slots.slot(effector));
}

}  // namespace detail

template <class D>
Result<EffectorId> World<D>::add_effector(const EffectorDef<D>& definition) {
  if (const Status s = detail::check_effector<D>(*self_, definition, "World::add_effector"); !s.ok()) return s.error();
  auto& store = self_->effectors;
  const EffectorId id = store.slots.allocate();
  const std::size_t slot = std::size_t(store.slots.slot(id));
  if (slot >= store.data.size()) store.data.resize(slot + 1);
  store.data[slot] = {};
  store.in_order.push_back(std::int32_t(slot));
  detail::install_effector<D>(*self_, std::int32_t(slot), definition);
  return id;
}

template <class D>
Status World<D>::destroy_effector(EffectorId effector) {
  const auto slot = detail::find_effector<D>(*self_, effector, "World::destroy_effector");
  if (!slot.ok()) return slot.error();
  detail::release_effector<D>(*self_, *slot);
  return {};
}

template <class D>
Result<EffectorDef<D>> World<D>::effector_definition(EffectorId effector) const {
  const auto slot = detail::find_effector<D>(*self_, effector, "World::effector_definition");
  if (!slot.ok()) return slot.error();
  return self_->effectors.data[std::size_t(*slot)].definition;
}

template <class D>
Status World<D>::set_effector(EffectorId effector, const EffectorDef<D>& definition) {
  constexpr std::string_view call = "World::set_effector";
  const auto slot = detail::find_effector<D>(*self_, effector, call);
  if (!slot.ok()) return slot.error();
  if (const Status s = detail::check_effector<D>(*self_, definition, call); !s.ok()) return s;
  detail::install_effector<D>(*self_, *slot, definition);
  return {};
}

template <class D>
void World<D>::effectors(std::vector<EffectorId>& out) const {
  out.clear();
  for (const std::int32_t slot : self_->effectors.in_order) out.push_back(self_->effectors.slots.handle_at(slot));
}

}  // namespace carom::rigid
