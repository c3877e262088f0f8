#include "carom/rigid/articulation.h"

#include <algorithm>

#include "carom/math/rotation.h"
#include "carom/rigid/detail/check.h"
#include "carom/rigid/detail/in_space.h"

namespace carom::rigid {
namespace {

constexpr int most_links = 256;

template <class D>
Mat3d body_inertia(const World<D>& world, BodyId body, double& mass, Vec3d& center) {
  if constexpr (D::dimension == 2) {
    const auto m = world.mass_properties2(body);
    if (!m.ok()) return Mat3d::zero();
    mass = m->mass, center = detail::in_space(m->center);
    return {{m->inertia, 0, 0}, {0, m->inertia, 0}, {0, 0, m->inertia}};  // only the last is ever asked for
  } else {
    const auto m = world.mass_properties3(body);
    if (!m.ok()) return Mat3d::zero();
    mass = m->mass, center = m->center;
    return m->inertia;
  }
}

/// What of a joint makes a mechanism of two bodies.
struct TreeEdge {
  JointId joint{};
  BodyId a{}, b{};
  bool used = false;
};

}  // namespace

template <class D>
Status Articulation<D>::add_link(const World<D>& world, BodyId body, int parent) {
  if (int(bodies_.size()) == most_links)
    return core::Error{core::text("Articulation::create: more than ", most_links, " links")};
  detail::TreeLink link;
  LinkBody own;
  link.parent = parent;
  const bool root = parent < 0 && !floating_;
  if (!root) own.inertia = body_inertia(world, body, link.mass, own.center);
  bodies_.push_back(body);
  links_.push_back(link);
  own_.push_back(own);
  return {};
}

template <class D>
Status Articulation<D>::add_joint(const AnyJointDef<D>& definition, JointId id, int parent, int link) {
  Frames f;
  bool from_b = false;  // the parent is body B
  std::visit(
      [&](const auto& d) {
        f.a = detail::in_space(d.frame_a.p), f.b = detail::in_space(d.frame_b.p);
        f.rotation_a = detail::turn_in_space(d.frame_a.q), f.rotation_b = detail::turn_in_space(d.frame_b.q);
        from_b = d.body_b == bodies_[std::size_t(parent)];
      },
      definition);
  f.body_a = from_b ? link : parent, f.body_b = from_b ? parent : link;
  ArticulationJoint joint{id, parent, link, degrees_, 1};
  if (std::holds_alternative<HingeJointDef<D>>(definition)) {
    f.type = JointType::hinge;
  } else if (std::holds_alternative<SliderJointDef<D>>(definition)) {
    f.type = JointType::slider;
  } else if (std::holds_alternative<BallJointDef<D>>(definition)) {
    f.type = D::dimension == 2 ? JointType::hinge : JointType::ball;
    joint.degrees = D::dimension == 2 ? 1 : 3;
  } else {
    f.type = JointType::weld;
    joint.degrees = 0;
  }
  detail::TreeLink& tree = links_[std::size_t(link)];
  tree.first = joint.first, tree.degrees = joint.degrees, tree.slides = f.type == JointType::slider;
  degrees_ += joint.degrees;
  joints_.push_back(joint);
  frames_.push_back(f);
  return {};
}

template <class D>
Result<Articulation<D>> Articulation<D>::create(const World<D>& world, BodyId body) {
  const Result<BodyState<D>> first = world.state(body);
  if (!first.ok()) return first.error();
  if (first->type != BodyType::dynamic)
    return core::Error{"Articulation::create: body is fixed or kinematic, expected a dynamic one of the mechanism"};
  std::vector<JointId> all;
  world.joints(all);
  std::vector<TreeEdge> edges;
  for (const JointId id : all) {
    const auto definition = world.joint_definition(id);
    if (!definition.ok()) return definition.error();
    const bool makes_tree = std::visit(
        [](const auto& d) {
          using T = std::decay_t<decltype(d)>;
          if constexpr (std::is_same_v<T, WeldJointDef<D>>) return d.linear.hertz == 0 && d.angular.hertz == 0;
          return std::is_same_v<T, HingeJointDef<D>> || std::is_same_v<T, SliderJointDef<D>> ||
                 std::is_same_v<T, BallJointDef<D>>;
        },
        *definition);
    if (!makes_tree) continue;
    TreeEdge e{id, {}, {}, false};
    std::visit([&](const auto& d) { e.a = d.body_a, e.b = d.body_b; }, *definition);
    edges.push_back(e);
  }
  const auto moves = [&](BodyId b) {
    const auto state = world.state(b);
    return state.ok() && state->type == BodyType::dynamic;
  };
  // The bodies of the mechanism, and the one place that holds it.
  std::vector<BodyId> members{body};
  const auto has = [&](BodyId b) { return std::find(members.begin(), members.end(), b) != members.end(); };
  BodyId base{};
  int holds = 0;
  for (std::size_t i = 0; i < members.size(); ++i)
    for (TreeEdge& e : edges) {
      if (e.a != members[i] && e.b != members[i]) continue;
      const BodyId other = e.a == members[i] ? e.b : e.a;
      if (!moves(other))
        base = other, ++holds;
      else if (!has(other))
        members.push_back(other);
      if (int(members.size()) > most_links)
        return core::Error{core::text("Articulation::create: more than ", most_links, " links")};
    }
  if (holds > 1)
    return core::Error{core::text("Articulation::create: ", holds,
                                  " joints hold the mechanism to what does not move, expected one at most: they close "
                                  "a loop")};
  Articulation made;
  made.floating_ = holds == 0;
  if (const Status s = made.add_link(world, made.floating_ ? body : base, -1); !s.ok()) return s.error();
  for (std::size_t i = 0; i < made.bodies_.size(); ++i)
    for (TreeEdge& e : edges) {
      const BodyId here = made.bodies_[i];
      if (e.used || (e.a != here && e.b != here)) continue;
      const BodyId other = e.a == here ? e.b : e.a;
      if (!has(other)) continue;  // something else that hangs on the same base
      if (std::find(made.bodies_.begin(), made.bodies_.end(), other) != made.bodies_.end())
        return core::Error{"Articulation::create: joints close a loop, expected a tree"};
      e.used = true;
      if (const Status s = made.add_link(world, other, int(i)); !s.ok()) return s.error();
      const auto definition = world.joint_definition(e.joint);
      if (const Status s = made.add_joint(*definition, e.joint, int(i), int(made.bodies_.size()) - 1); !s.ok())
        return s.error();
    }
  const std::size_t n = std::size_t(made.degrees_), links = made.bodies_.size();
  made.muscles_.resize(made.joints_.size());
  made.targets_.resize(made.joints_.size());
  made.coordinates_.resize(n), made.speeds_.resize(n), made.accelerations_.resize(n), made.torques_.resize(n);
  made.velocity_.resize(links), made.spins_.resize(links), made.rotation_.resize(links);
  if (const Status s = made.read(world); !s.ok()) return s.error();
  if (const Status s = made.hold(); !s.ok()) return s.error();
  return made;
}

template <class D>
int Articulation<D>::find(JointId joint) const {
  for (std::size_t i = 0; i < joints_.size(); ++i)
    if (joints_[i].joint == joint) return int(i);
  return -1;
}

template <class D>
Status Articulation<D>::read(const World<D>& world) {
  gravity_ = detail::in_space(world.definition().gravity);
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const bool held = i == 0 && !floating_;
    Vec3d place{}, spin{};
    velocity_[i] = {}, rotation_[i] = {};
    if (bodies_[i]) {
      const Result<BodyState<D>> state = world.state(bodies_[i]);
      if (!state.ok()) return state.error();
      if (!held && state->type != BodyType::dynamic)
        return core::Error{"Articulation::read: a link is no longer a dynamic body"};
      place = detail::in_space(held ? state->pose.position : state->center_of_mass);
      velocity_[i] = detail::in_space(state->linear_velocity);
      rotation_[i] = detail::turn_in_space(state->pose.rotation);
      spin = detail::turn_in_space(state->angular_velocity);
      if (held) velocity_[i] -= cross(spin, detail::in_space(state->center_of_mass) - place);
    }
    if (i == 0) origin_ = place;
    links_[i].center = place - origin_;
    links_[i].inertia = geometry::rotate_inertia(own_[i].inertia, to_matrix(rotation_[i]));
    if (i == 0) root_ = {spin, {}, {}};
    spins_[i] = spin;
  }
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const ArticulationJoint& joint = joints_[j];
    if (!world.contains(joint.joint)) return core::Error{"Articulation::read: a joint of the tree no longer exists"};
    const Frames& f = frames_[j];
    const std::size_t a = std::size_t(f.body_a), b = std::size_t(f.body_b);
    const auto point = [&](std::size_t link, const Vec3d& p) {
      return links_[link].center + rotate(rotation_[link], p - own_[link].center);
    };
    const Quatd qa = rotation_[a] * f.rotation_a, qb = rotation_[b] * f.rotation_b;
    const Vec3d pa = point(a, f.a), pb = point(b, f.b), spin = spins_[b] - spins_[a];
    detail::TreeLink& link = links_[std::size_t(joint.link)];
    link.anchor = f.body_a == joint.parent ? pa : pb;
    const double sign = f.body_a == joint.parent ? 1 : -1;
    Mat3d axes = to_matrix(qa);
    double* const q = coordinates_.data() + joint.first;
    double* const v = speeds_.data() + joint.first;
    if (f.type == JointType::hinge) {
      const Quatd r = conjugate(qa) * qb;
      q[0] = wrap_angle(2 * math::atan2(r.w < 0 ? -r.z : r.z, math::abs(r.w)));
      v[0] = dot(axes.cz, spin);
      axes.cx = axes.cz;
    } else if (f.type == JointType::slider) {
      const Vec3d moved = velocity_[b] + cross(spins_[b], pb - links_[b].center) - velocity_[a] -
                          cross(spins_[a], pb - links_[a].center);
      q[0] = dot(axes.cx, pb - pa);
      v[0] = dot(axes.cx, moved);
    } else if (f.type == JointType::ball) {
      const Vec3d turned = rotation_vector(conjugate(qa) * qb), speed = inverse_rotate(qa, spin);
      q[0] = turned.x, q[1] = turned.y, q[2] = turned.z;
      v[0] = speed.x, v[1] = speed.y, v[2] = speed.z;
    }
    link.axes = sign * axes;
  }
  return {};
}

template <class D>
typename D::Position Articulation<D>::center_of_mass() const {
  return detail::lowered<D>(origin_ + detail::whole_of(links_).center);
}
template <class D>
typename D::Vector Articulation<D>::center_velocity() const {
  Vec3d momentum{};
  double mass = 0;
  for (std::size_t i = 0; i < links_.size(); ++i) momentum += links_[i].mass * velocity_[i], mass += links_[i].mass;
  return Vector(detail::lowered<D>(mass > 0 ? momentum * (1 / mass) : Vec3d{}));
}

template <class D>
Status Articulation<D>::inverse_dynamics(std::span<const double> accelerations, std::span<double> torques) {
  if (accelerations.size() != std::size_t(degrees_) || torques.size() != std::size_t(degrees_))
    return core::Error{core::text("Articulation::inverse_dynamics: ", accelerations.size(), " accelerations and ",
                                  torques.size(), " torques, expected ", degrees_, " each")};
  for (const double a : accelerations)
    if (!math::is_finite(a))
      return core::Error{"Articulation::inverse_dynamics: an acceleration is not finite, expected numbers"};
  detail::TreeRoot root = root_;
  detail::tree_forces(links_, root, speeds_, accelerations, gravity_, {}, motion_, torques);
  if (!floating_ || planted_) return {};
  const detail::TreeForce free{-motion_.root.force, -motion_.root.moment};
  detail::free_root(detail::whole_of(links_), links_[0].center, free, root);
  detail::tree_forces(links_, root, speeds_, accelerations, gravity_, {}, motion_, torques);
  return {};
}

}  // namespace carom::rigid

#include "carom/rigid/detail/articulation_muscles.inl"

namespace carom::rigid {
template class Articulation<Dim2>;
template class Articulation<Dim3>;
}  // namespace carom::rigid
