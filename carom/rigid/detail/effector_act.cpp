// What effectors do once a step. Fields and thrusters first, then everything that resists motion.
#include "carom/rigid/detail/effector_act.h"

#include "carom/environment/gravity.h"
#include "carom/forces/drag.h"
#include "carom/forces/fields.h"
#include "carom/rigid/detail/joint_record.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

/// Calls act(EffectorBody) for the target, or for every awake dynamic body. Order does not matter: each body is alone.
template <class D, class Act>
void for_each_target(WorldImplementation<D>& world, BodyId target, double dt, const Act& act) {
  const auto moves = [&](std::int32_t slot) {
    const BodyRecord& record = world.bodies.record[std::size_t(slot)];
    return record.type == BodyType::dynamic && record.awake() && record.enabled() &&
           world.bodies.motion[std::size_t(slot)].inverse_mass > 0;
  };
  if (!target.is_null()) {
    const std::int32_t slot = world.bodies.slots.slot(target);
    if (moves(slot)) act(EffectorBody<D>(world, slot, dt));
    return;
  }
  for (const std::int32_t slot : world.bodies.awake)
    if (moves(slot)) act(EffectorBody<D>(world, slot, dt));
}

template <class D>
struct FieldForces {
  WorldImplementation<D>& world;
  double dt;
  const environment::Environment* around;
  typename D::Position uniform_wind;
  using Position = typename D::Position;

  void operator()(const SphericalGravity<D>& e) const {
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      const double scale = world.bodies.motion[std::size_t(body.slot)].gravity_scale;
      push(world, body,
           environment::spherical_gravity(body.center - e.center, e.gm, e.minimum_radius) * (body.mass * scale));
    });
  }
  void operator()(const RadialField<D>& e) const {
    const forces::Radial field{e.strength, e.reference, e.exponent, e.range};
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      push(world, body, forces::radial_acceleration(field, body.center - e.center) * body.mass);
    });
  }
  void operator()(const Thrust<D>& e) const {
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      const auto& motion = world.bodies.motion[std::size_t(body.slot)];
      push_at(world, body, Position(rotate(body.pose.rotation, e.force)),
              Position(rotate(body.pose.rotation, e.point - motion.local_center)));
    });
  }
  void operator()(const Buoyancy<D>& e) const {
    for_each_target(world, e.body, dt,
                    [&](const EffectorBody<D>& body) { float_body(world, e, body, world.time + 0.5 * dt, around); });
  }
  void operator()(const Surroundings<D>& e) const {
    if (e.environment.get() != around || !around->has_gravity()) return;
    for_each_target(world, {}, dt, [&](const EffectorBody<D>& body) {
      const double scale = world.bodies.motion[std::size_t(body.slot)].gravity_scale;
      push(world, body,
           part_of(around->gravity(place_of(body.center)), static_cast<D*>(nullptr)) * (body.mass * scale));
    });
  }
  void operator()(const CustomEffector<D>& e) const {
    if (!e.model) return;
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      const std::size_t i = std::size_t(body.slot);
      const SolverBody<D>& solver = world.bodies.solver[i];
      BodyMotion<D>& motion = world.bodies.motion[i];
      EffectorInput<D> input;
      input.body = world.bodies.slots.handle_at(body.slot);
      input.time = world.time;
      input.around = around;
      input.wind = uniform_wind;
      input.state.pose = world.bodies.pose[i];
      input.state.center_of_mass = motion.center;
      const float pace = world.bodies.pace(body.slot);
      input.state.linear_velocity = solver.linear_velocity * (1 / pace);
      input.state.angular_velocity = solver.angular_velocity * (1 / pace);
      input.state.mass = motion.mass;
      input.state.user_data = word_of(world.bodies.user_data, body.slot);
      const Wrench<D> wrench = e.model(input);
      if (is_finite(wrench.force) && is_finite(wrench.torque)) {
        motion.force += wrench.force;
        motion.torque += wrench.torque;
      } else if ((world.bodies.record[i].flags & body_quarantined) == 0) {
        quarantine(world, body.slot);
        world.scratch.quarantined.push_back({input.body});
        world.scratch.broken.push_back(body.slot);
      }
    });
  }
  template <class Other>
  void operator()(const Other&) const {}
};

/// What turns velocities: frames and magnetic fields. After the fields, so that what they do in the same step is turned
/// with it, as J. P. Boris does it (Relativistic plasma simulation, 4th Conf. Num. Sim. Plasmas, 1970): half of the
/// push, a turn by 2 atan(½ |Ω| dt), the other half. No work is done.
template <class D>
struct Turns {
  WorldImplementation<D>& world;
  double dt;
  const environment::Environment* around;
  using Position = typename D::Position;

  /// v̇ = a + rate × v.
  void turn(const EffectorBody<D>& body, Vec3d rate) const {
    const Vec3d half_push = place_of(other_acceleration(world, body)) * (0.5 * body.dt);
    const Vec3d before = place_of(body.velocity) + half_push, t = rate * (0.5 * body.dt);
    const Vec3d middle = before + math::cross(t, before);
    const Vec3d change = math::cross(t, middle) * (2 / (1 + math::length_squared(t)));
    push(world, body, part_of(change * (body.mass / body.dt), static_cast<D*>(nullptr)));
  }
  void turn_frame(const EffectorBody<D>& body, Vec3d rate, Vec3d center, bool centrifugal) const {
    if (centrifugal) {
      const Vec3d r = place_of(body.center) - center;
      push(world, body, part_of(math::cross(rate, math::cross(rate, r)) * -body.mass, static_cast<D*>(nullptr)));
    }
    turn(body, -2.0 * rate);
  }

  void operator()(const Surroundings<D>& e) const {
    if (e.environment.get() != around || !around->turns()) return;
    const environment::RotatingFrame& frame = around->definition().frame;
    for_each_target(world, {}, dt, [&](const EffectorBody<D>& body) {
      turn_frame(body, frame.rate, frame.origin, frame.centrifugal);
    });
  }
  void operator()(const TurningFrame<D>& e) const {
    Vec3d rate{};
    if constexpr (D::dimension == 2)
      rate.z = e.rate;
    else
      rate = Vec3d(e.rate);
    for_each_target(world, e.body, dt,
                    [&](const EffectorBody<D>& body) { turn_frame(body, rate, place_of(e.center), e.centrifugal); });
  }
  void operator()(const ElectromagneticField<D>& e) const {
    Vec3d field(e.magnetic);
    if constexpr (D::dimension == 2) field.x = field.y = 0;
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      push(world, body, Position(e.electric) * e.charge);
      turn(body, field * (-e.charge * body.inverse_mass));
    });
  }
  template <class Other>
  void operator()(const Other&) const {}
};

template <class D>
struct Resistances {
  WorldImplementation<D>& world;
  double dt;
  const environment::Environment* around;
  typename D::Position uniform_wind{};
  using Position = typename D::Position;

  /// The wind at the body's point `arm` away from its centre.
  Position wind_at(const EffectorBody<D>& body, Position arm = {}) const {
    if (around == nullptr || !around->has_wind()) return uniform_wind;
    return uniform_wind +
           part_of(around->wind(place_of(body.center + arm), world.time + 0.5 * dt), static_cast<D*>(nullptr));
  }

  /// How fast a torque of 1 N m at most changes the spin, 1/(kg m²): at least the largest eigenvalue, by row sums.
  double turning_mobility(const EffectorBody<D>& body) const {
    const BodyMotion<D>& motion = world.bodies.motion[std::size_t(body.slot)];
    if constexpr (D::dimension == 2) {
      return double(motion.world_inverse_inertia);
    } else {
      const Mat3f& m = motion.world_inverse_inertia;
      const Vec3f rows = math::abs(m.cx) + math::abs(m.cy) + math::abs(m.cz);
      return double(math::max(rows.x, math::max(rows.y, rows.z)));
    }
  }
  /// −c ω averaged over the step, for the most agile axis: stable for any c.
  void slow_spin(const EffectorBody<D>& body, double c) const {
    BodyMotion<D>& motion = world.bodies.motion[std::size_t(body.slot)];
    const double mobility = turning_mobility(body);
    motion.torque += typename D::Angular(body.spin * (-c * mean_decay(c * mobility * body.dt)));
  }

  void operator()(const LinearDrag<D>& e) const {
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      if (e.coefficient > 0)
        push(world, body, resist(world, body, e.coefficient * body.inverse_mass, body.velocity - wind_at(body)));
      if (e.angular_coefficient > 0) slow_spin(body, e.angular_coefficient);
    });
  }
  void operator()(const QuadraticDrag<D>& e) const {
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      const auto& motion = world.bodies.motion[std::size_t(body.slot)];
      const Position arm(rotate(body.pose.rotation, e.point - motion.local_center));
      const Position v = forces::relative_velocity(body.velocity, body.spin, arm, wind_at(body, arm));
      // |v| of mid-step, by one more evaluation: second order in dt.
      const double c = 0.5 * e.density * e.drag_coefficient * e.area * body.inverse_mass;
      const double rate = c * math::length(v);
      const Position middle =
          v + (other_acceleration(world, body) - rate * v) * (0.5 * body.dt * mean_decay(0.5 * rate * body.dt));
      push_at(world, body, resist(world, body, c * math::length(middle), v), arm);
      if (e.angular_coefficient > 0) {
        double speed;
        if constexpr (D::dimension == 2)
          speed = math::abs(body.spin);
        else
          speed = math::length(body.spin);
        slow_spin(body, e.angular_coefficient * speed);
      }
    });
  }
  void operator()(const BodyDrag<D>& e) const {
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      const auto& motion = world.bodies.motion[std::size_t(body.slot)];
      const Position arm(rotate(body.pose.rotation, e.point - motion.local_center));
      const Position v = forces::relative_velocity(body.velocity, body.spin, arm, wind_at(body, arm));
      double density = e.density, viscosity = e.viscosity, sound = e.speed_of_sound;
      if (around != nullptr) {
        const environment::AirState air = around->air(place_of(body.center));
        density = air.density, viscosity = air.viscosity, sound = air.speed_of_sound;
      }
      // c |v| with the coefficient at that speed, twice: at the start, then in the middle of the step.
      const auto rate_at = [&](double speed) {
        const double c = forces::drag_coefficient(e.law, forces::reynolds_number(density, speed, e.diameter, viscosity),
                                                  speed / sound);
        return 0.5 * density * e.area * body.inverse_mass * c * speed;
      };
      const double slow = 1e-9;  // at rest drag is Stokes': the rate stays finite
      const double rate = rate_at(math::max(math::length(v), slow));
      const Position middle =
          v + (other_acceleration(world, body) - rate * v) * (0.5 * body.dt * mean_decay(0.5 * rate * body.dt));
      push_at(world, body, resist(world, body, rate_at(math::max(math::length(middle), slow)), v), arm);
    });
  }
  void operator()(const MagnusLift<D>& e) const {
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      const double density = around != nullptr ? around->thin_air(place_of(body.center)).density : e.density;
      push(world, body, forces::magnus_force(e.law, density, e.radius, body.spin, body.velocity - wind_at(body)));
    });
  }
  /// A force of the flow that hangs on attitude, at the point `arm` from the centre; `load` makes it of the velocity
  /// there. What of it lies along the way decays like other drag, what lies across turns the way without doing work:
  /// both stable for any load. `lever` (m) is how far from the point it acts at most.
  template <class Load>
  void flow(const EffectorBody<D>& body, Position arm, double lever, Load&& load) const {
    const Position v = forces::relative_velocity(body.velocity, body.spin, arm, wind_at(body, arm));
    struct Split {
      double decay = 0, turn = 0;  // 1/s
      Vec3d across{};              // unit vector
    };
    const auto split = [&](Vec3d u, Vec3d force) {
      Split out;
      const double speed2 = math::length_squared(u);
      if (!(speed2 > 1e-18)) return out;
      const double along = math::dot(force, u) / speed2;
      const Vec3d rest = force - along * u;
      const double size = math::length(rest);
      out.decay = math::max(0.0, -along * body.inverse_mass);
      out.turn = size * body.inverse_mass / math::sqrt(speed2);
      if (size > 0) out.across = rest / size;
      return out;
    };
    const Vec3d first = place_of(v);
    const Split early = split(first, load(first).force);
    const double half = 0.5 * body.dt;
    Vec3d middle =
        place_of(v + (other_acceleration(world, body) - early.decay * v) * (half * mean_decay(early.decay * half)));
    const math::SinCos<double> part = math::sincos(math::min(early.turn * half, 0.5));
    middle = part.cos * middle + (part.sin * math::length(middle)) * early.across;
    const forces::Wrench3 w = load(middle);
    const Split late = split(middle, w.force);
    const double chord = 2 * math::length(middle) * math::sin(math::min(late.turn * half, 0.5)) * body.mass / body.dt;
    const Position lift = part_of(chord * late.across, static_cast<D*>(nullptr));
    push_at(world, body, resist(world, body, late.decay, v) + lift, arm);
    // Of the moment the mean over the step of what dies down with the turning.
    const double rate = math::length(w.force) / math::max(math::length(middle), 1e-9) *
                        math::max(body.inverse_mass, lever * lever * turning_mobility(body));
    const double held = mean_decay(math::max(0.0, rate * body.dt - 0.5));
    BodyMotion<D>& motion = world.bodies.motion[std::size_t(body.slot)];
    if constexpr (D::dimension == 2)
      motion.torque += float(w.moment.z * held);
    else
      motion.torque += Vec3f(w.moment * held);
  }
  void operator()(const LiftingSurface<D>& e) const {
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      const auto& motion = world.bodies.motion[std::size_t(body.slot)];
      const Position arm(rotate(body.pose.rotation, e.point - motion.local_center));
      const Vec3d forward = normalize(place_of(Position(rotate(body.pose.rotation, e.forward))));
      Vec3d up, spin;
      if constexpr (D::dimension == 2) {
        up = {-forward.y, forward.x, 0};
        spin = {0, 0, body.spin};
      } else {
        const Vec3d told(rotate(body.pose.rotation, e.up));
        up = normalize(told - dot(told, forward) * forward);
        spin = body.spin;
      }
      const double density = around != nullptr ? around->thin_air(place_of(body.center)).density : e.density;
      flow(body, arm, 0.5 * e.chord,
           [&](Vec3d v) { return forces::lifting_surface(e.law, density, e.area, e.chord, forward, up, v, spin); });
    });
  }
  void operator()(const CylinderDrag<D>& e) const {
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      const auto& motion = world.bodies.motion[std::size_t(body.slot)];
      const Position middle(rotate(body.pose.rotation, e.point - motion.local_center));
      const Vec3d axis = normalize(place_of(Position(rotate(body.pose.rotation, e.axis))));
      double density = e.density, viscosity = e.viscosity;
      if (around != nullptr) {
        const environment::AirState air = around->air(place_of(body.center));
        density = air.density, viscosity = air.viscosity;
      }
      Vec3d spin;
      if constexpr (D::dimension == 2)
        spin = {0, 0, body.spin};
      else
        spin = body.spin;
      // Two halves, each at its point of Gauss: so that turning is resisted too.
      const double place = 0.2886751345948129 * e.length;
      flow(body, middle, place, [&](Vec3d v) {
        forces::Wrench3 both;
        for (const double side : {-place, place}) {
          const Vec3d arm = side * axis;
          const Vec3d force =
              0.5 * forces::cylinder_force(density, viscosity, e.diameter, e.length, axis, v + math::cross(spin, arm));
          both = both + forces::Wrench3{force, math::cross(arm, force)};
        }
        return both;
      });
    });
  }
  void operator()(const VortexField<D>& e) const {
    const forces::Vortex vortex{e.circulation, e.core_radius};
    for_each_target(world, e.body, dt, [&](const EffectorBody<D>& body) {
      Position medium{};
      if constexpr (D::dimension == 2) {
        medium = forces::vortex_velocity(vortex, body.center - e.center);
      } else {
        medium = forces::vortex_velocity(vortex, normalize(Vec3d(e.axis)), body.center - e.center);
      }
      push(world, body, resist(world, body, e.rate, body.velocity - medium));
    });
  }
  template <class Other>
  void operator()(const Other&) const {}
};

}  // namespace

template <class D>
void apply_effectors(WorldImplementation<D>& world, float dt) {
  EffectorStore<D>& store = world.effectors;
  if (store.in_order.empty()) return;
  store.added.clear();
  Resistances<D> resistances{world, double(dt), nullptr, {}};
  bool turning = false;
  for (const std::int32_t slot : store.in_order) {
    const EffectorDef<D>& definition = store.data[std::size_t(slot)].definition;
    if (const auto* wind = std::get_if<Wind<D>>(&definition))
      resistances.uniform_wind += typename D::Position(wind->velocity);
    else if (const auto* surroundings = std::get_if<Surroundings<D>>(&definition))
      resistances.around = surroundings->environment.get(), turning = true;
    else if (std::holds_alternative<TurningFrame<D>>(definition) ||
             std::holds_alternative<ElectromagneticField<D>>(definition))
      turning = true;
  }
  const FieldForces<D> fields{world, double(dt), resistances.around, resistances.uniform_wind};
  for (const std::int32_t slot : store.in_order) std::visit(fields, store.data[std::size_t(slot)].definition);
  if (turning) {
    const Turns<D> turns{world, double(dt), resistances.around};
    for (const std::int32_t slot : store.in_order) std::visit(turns, store.data[std::size_t(slot)].definition);
  }
  for (const std::int32_t slot : store.in_order) std::visit(resistances, store.data[std::size_t(slot)].definition);
  if (!store.added.empty()) apply_added_masses(world, double(dt));
}

template <class D>
void release_effector(WorldImplementation<D>& world, std::int32_t slot) {
  EffectorStore<D>& store = world.effectors;
  EffectorData<D>& data = store.data[std::size_t(slot)];
  if (data.joint != none) release_joint(world, data.joint);
  data = {};
  store.slots.release(store.slots.handle_at(slot));
  std::erase(store.in_order, slot);
}

template <class D>
void forget_body_in_effectors(WorldImplementation<D>& world, BodyId body) {
  EffectorStore<D>& store = world.effectors;
  for (std::size_t i = store.in_order.size(); i-- > 0;) {
    const std::int32_t slot = store.in_order[i];
    EffectorData<D>& data = store.data[std::size_t(slot)];
    const bool bound = std::visit(
        [body](const auto& e) {
          if constexpr (requires { e.body_a; })
            return e.body_a == body || e.body_b == body;
          else if constexpr (requires { e.body; })
            return e.body == body;
          else
            return false;
        },
        data.definition);
    if (!bound) continue;
    if (data.joint != none && !(world.joints.slots.in_use(data.joint) && world.joints.at(data.joint).internal))
      data.joint = none;  // went with the body's other joints
    release_effector(world, slot);
  }
}

template void apply_effectors(WorldImplementation<Dim2>&, float);
template void apply_effectors(WorldImplementation<Dim3>&, float);
template void release_effector(WorldImplementation<Dim2>&, std::int32_t);
template void release_effector(WorldImplementation<Dim3>&, std::int32_t);
template void forget_body_in_effectors(WorldImplementation<Dim2>&, BodyId);
template void forget_body_in_effectors(WorldImplementation<Dim3>&, BodyId);

}  // namespace carom::rigid::detail
