// The muscles of an articulation: computed torques (Luh, Walker & Paul, "Resolved-acceleration control of mechanical
// manipulators", 1980).

namespace carom::rigid {
namespace {

void check_muscle(detail::Complaint& c, const Muscle& m) {
  detail::check_range(c, "hertz", m.hertz, 0, 1000);
  detail::check_range(c, "damping_ratio", m.damping_ratio, 0, 1000);
  detail::check_range(c, "max_torque", m.max_torque, 0, detail::max_force);
}

}  // namespace

template <class D>
Status Articulation<D>::set_muscles(const Muscle& muscle) {
  detail::Complaint complaint("Articulation::set_muscles");
  check_muscle(complaint, muscle);
  if (!complaint.none_yet()) return complaint.error();
  for (Muscle& m : muscles_) m = muscle;
  return {};
}

template <class D>
Status Articulation<D>::check_joint(const char* function, int joint, bool ball) const {
  if (joint < 0 || joint >= int(joints_.size()))
    return core::Error{core::text(function, ": joint is ", joint, ", expected one of ", joints_.size())};
  const int degrees = joints_[std::size_t(joint)].degrees;
  if (degrees != (ball ? 3 : 1))
    return core::Error{core::text(function, ": joint ", joint, " has ", degrees, " degrees of freedom, expected ",
                                  ball ? "a ball joint in space" : "a hinge or slider")};
  return {};
}

template <class D>
Status Articulation<D>::set_muscle(int joint, const Muscle& muscle) {
  if (joint < 0 || joint >= int(joints_.size()))
    return core::Error{core::text("Articulation::set_muscle: joint is ", joint, ", expected one of ", joints_.size())};
  detail::Complaint complaint("Articulation::set_muscle");
  check_muscle(complaint, muscle);
  if (!complaint.none_yet()) return complaint.error();
  muscles_[std::size_t(joint)] = muscle;
  return {};
}

template <class D>
Status Articulation<D>::set_target(int joint, double coordinate, double speed, double acceleration) {
  if (const Status s = check_joint("Articulation::set_target", joint, false); !s.ok()) return s;
  detail::Complaint complaint("Articulation::set_target");
  detail::check_range(complaint, "coordinate", coordinate, -detail::max_coordinate, detail::max_coordinate);
  detail::check_range(complaint, "speed", speed, -detail::max_velocity, detail::max_velocity);
  detail::check_range(complaint, "acceleration", acceleration, -detail::max_force, detail::max_force);
  if (!complaint.none_yet()) return complaint.error();
  Target& t = targets_[std::size_t(joint)];
  t.coordinate[0] = coordinate, t.speed[0] = speed, t.acceleration[0] = acceleration;
  return {};
}

template <class D>
Status Articulation<D>::set_target(int joint, const Quatf& rotation, const Vec3f& speed, const Vec3f& acceleration) {
  if (const Status s = check_joint("Articulation::set_target", joint, true); !s.ok()) return s;
  detail::Complaint complaint("Articulation::set_target");
  if (!(math::abs(length(rotation) - 1) < 1e-3f))
    complaint.say("rotation is not a unit quaternion, expected a length of 1");
  detail::check_size(complaint, "speed", speed, detail::max_velocity);
  detail::check_size(complaint, "acceleration", acceleration, detail::max_force);
  if (!complaint.none_yet()) return complaint.error();
  Target& t = targets_[std::size_t(joint)];
  t.rotation = normalize(Quatd(rotation));
  for (int k = 0; k < 3; ++k) t.speed[k] = double(speed[k]), t.acceleration[k] = double(acceleration[k]);
  return {};
}

template <class D>
Status Articulation<D>::hold() {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    targets_[j] = {};
    const double* const q = coordinates_.data() + joints_[j].first;
    if (joints_[j].degrees == 3)
      targets_[j].rotation = from_rotation_vector(Vec3d{q[0], q[1], q[2]});
    else if (joints_[j].degrees == 1)
      targets_[j].coordinate[0] = q[0];
  }
  return {};
}

/// What touches the tree from outside, as forces of the last step.
template <class D>
void Articulation<D>::find_touches(const World<D>& world, float dt) {
  outside_.assign(links_.size(), {});
  for (std::size_t i = floating_ && !planted_ ? 0 : 1; i < links_.size(); ++i) {
    world.contacts(bodies_[i], contacts_);
    for (const ContactView<D>& view : contacts_) {
      const auto a = world.body_of(view.shape_a), b = world.body_of(view.shape_b);
      if (!a.ok() || !b.ok()) continue;
      const double sign = b.value() == bodies_[i] ? 1 : -1;
      const BodyId other = sign > 0 ? a.value() : b.value();
      if (std::find(bodies_.begin(), bodies_.end(), other) != bodies_.end()) continue;
      const Vec3d normal = sign * detail::in_space(view.normal);
      const Vec3d friction = detail::in_space(view.friction_impulse) * (sign / double(dt));
      for (int k = 0; k < view.count; ++k) {
        const Vec3d point = detail::in_space(view.points[k].point) - origin_;
        const Vec3d force =
            normal * (double(view.points[k].normal_impulse) / double(dt)) + friction / double(view.count);
        outside_[i].force += force;
        outside_[i].moment += cross(point - links_[i].center, force);
      }
    }
  }
}

/// To the middle of the step: torques that are right there are right for the whole of it, to second order.
template <class D>
void Articulation<D>::move_ahead(double time) {
  for (std::size_t i = 1; i < links_.size(); ++i) {
    detail::TreeLink& link = links_[i];
    const std::size_t p = std::size_t(link.parent);
    link.anchor += time * (velocity_[p] + cross(spins_[p], link.anchor - links_[p].center));
    // The axes of a joint stand in its body A; about them the link turns, so that either body will do for the others.
    const Quatd turn = from_rotation_vector(time * spins_[p]);
    link.axes = {rotate(turn, link.axes.cx), rotate(turn, link.axes.cy), rotate(turn, link.axes.cz)};
  }
  for (std::size_t i = 0; i < links_.size(); ++i) {
    links_[i].center += time * velocity_[i];
    links_[i].inertia = geometry::rotate_inertia(links_[i].inertia, to_matrix(from_rotation_vector(time * spins_[i])));
  }
  for (std::size_t i = 0; i < speeds_.size(); ++i) speeds_[i] += time * accelerations_[i];
}

template <class D>
Status Articulation<D>::drive(World<D>& world, float dt) {
  detail::Complaint complaint("Articulation::drive");
  detail::check_range(complaint, "dt", double(dt), 1e-9, 1);
  if (!complaint.none_yet()) return complaint.error();
  if (const Status s = read(world); !s.ok()) return s;
  const double step = double(dt);
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const ArticulationJoint& joint = joints_[j];
    const Muscle& muscle = muscles_[j];
    const Target& target = targets_[j];
    // The target is that of the end of the step; here it is where it comes from.
    Vec3d error{}, drift{};
    for (int k = 0; k < joint.degrees; ++k) {
      drift[k] = speeds_[std::size_t(joint.first) + std::size_t(k)] - (target.speed[k] - target.acceleration[k] * step);
      error[k] = (target.speed[k] - 0.5 * target.acceleration[k] * step) * step;
    }
    if (joint.degrees == 3) {  // in the axes of A: the turn that takes the target to where B is
      const double* const q = coordinates_.data() + joint.first;
      error += rotation_vector(from_rotation_vector(Vec3d{q[0], q[1], q[2]}) * conjugate(target.rotation));
    } else if (joint.degrees == 1) {
      error.x += coordinates_[std::size_t(joint.first)] - target.coordinate[0];
      if (frames_[j].type == JointType::hinge) error.x = wrap_angle(error.x);
    }
    for (int k = 0; k < joint.degrees; ++k)
      accelerations_[std::size_t(joint.first) + std::size_t(k)] =
          target.acceleration[k] +
          detail::settling_acceleration(error[k], drift[k], 2 * pi * muscle.hertz, muscle.damping_ratio, step);
  }
  find_touches(world, dt);
  move_ahead(0.5 * step);
  detail::TreeRoot root = root_;
  detail::tree_forces(links_, root, speeds_, accelerations_, gravity_, outside_, motion_, torques_);
  if (floating_ && !planted_) {
    detail::free_root(detail::whole_of(links_), links_[0].center, {-motion_.root.force, -motion_.root.moment}, root);
    detail::tree_forces(links_, root, speeds_, accelerations_, gravity_, outside_, motion_, torques_);
  }
  return apply(world);
}

template <class D>
Status Articulation<D>::apply(World<D>& world) {
  loads_.resize(joints_.size());
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const ArticulationJoint& joint = joints_[j];
    const detail::TreeLink& link = links_[std::size_t(joint.link)];
    double* const torque = torques_.data() + joint.first;
    double size = 0;
    for (int k = 0; k < joint.degrees; ++k) size += torque[k] * torque[k];
    size = math::sqrt(size);
    const Muscle& muscle = muscles_[j];
    const double most = muscle.max_torque > 0 ? min(muscle.max_torque, detail::max_force) : detail::max_force;
    const double scale = muscle.hertz == 0 ? 0 : size > most ? most / size : 1;
    loads_[j] = {};
    for (int k = 0; k < joint.degrees; ++k) {
      torque[k] *= scale;
      loads_[j] += (k == 0 ? link.axes.cx : k == 1 ? link.axes.cy : link.axes.cz) * torque[k];
    }
    if (!math::is_finite(dot(loads_[j], loads_[j])))
      return core::Error{"Articulation::drive: a torque is not finite: masses or targets beyond all measure"};
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const ArticulationJoint& joint = joints_[j];
    const detail::TreeLink& link = links_[std::size_t(joint.link)];
    if (joint.degrees == 0 || muscles_[j].hertz == 0) continue;
    for (const int side : {1, -1}) {
      const int body = side > 0 ? joint.link : joint.parent;
      if (body == 0 && !floating_) continue;
      const Vec3d load = double(side) * loads_[j];
      const BodyId id = bodies_[std::size_t(body)];
      const Status s = link.slides ? world.add_force_at(id, Vector(detail::lowered<D>(load)),
                                                        detail::lowered<D>(origin_ + link.anchor))
                                   : world.add_torque(id, detail::lowered_turn<D>(load));
      if (!s.ok()) return s;
    }
  }
  return {};
}

}  // namespace carom::rigid
