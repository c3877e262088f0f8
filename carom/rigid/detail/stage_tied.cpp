// What is welded stops as one. Continuous collision stops one body at a time: of several that are welded to each other
// it would leave one where it met something and send the others on, and what the weld then does to bring them together
// again is work out of nothing. So all of them are set back to where the one that was stopped first is. Slender bodies
// on pins are set back, too, each on its own way and to its anchor: they spin fast about their length for little, and
// so joints make the most of a gap there. Others stop alone, because a long chain would be held up whenever a link of
// it is.
#include "carom/rigid/detail/body_way.h"
#include "carom/rigid/detail/joint_part.h"

namespace carom::rigid::detail {
namespace {

/// Does it hold two anchors together?
template <class D>
bool is_pinned(const JointData<D>& data) {
  if ((data.parts & part_pin) != 0) return true;
  const auto* generic = data.template get<GenericJointDef>();
  if (generic == nullptr) return false;
  for (const JointAxis& axis : generic->linear)
    if (axis.free) return false;
  return true;
}

template <class D>
class Tied {
 public:
  Tied(WorldImplementation<D>& world, std::span<std::uint8_t> mark)
      : world_(world), swept_(world.scratch.swept), bodies_(world.scratch.tied), mark_(mark) {}

  /// Stops all that is tied to a body that was stopped.
  void stop(std::int32_t body) {
    if (mark_[place_of(body)] != unseen) return;
    gather(body);
    if (!uneven_) return;
    const Motion before = whole_motion();
    bodies_.assign(1, first_);
    mark_[place_of(first_)] = placed;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      for_each_tie(bodies_[i], [&](std::int32_t joint, int side, std::int32_t other, bool welded) {
        if (mark_[place_of(other)] == placed) return;
        mark_[place_of(other)] = placed;
        bodies_.push_back(other);
        if (welded)
          keep_in_place(bodies_[i], other);
        else
          keep_on_pin(joint, side, bodies_[i], other);
      });
    if (rigid_) move_as_one(before);
    for (const std::int32_t one : bodies_) {
      BodyRecord& record = world_.bodies.record[std::size_t(one)];
      if ((record.flags & body_fast) != 0) continue;
      record.flags |= body_fast;
      look_at_bounds(world_.bodies.motion[std::size_t(one)]);
      world_.scratch.fast.push_back(record.awake_index);
    }
  }

 private:
  enum Mark : std::uint8_t { unseen, seen, placed };
  struct Motion {
    typename D::Vector velocity{}, place{};  ///< m/s; m from the one that was stopped first, of the centre of mass
  };

  std::size_t place_of(std::int32_t body) const {
    return std::size_t(world_.bodies.record[std::size_t(body)].awake_index);
  }
  /// Calls f(joint, side of the body, other body, welded?).
  template <class F>
  void for_each_tie(std::int32_t body, F&& f) const {
    const auto& motion = world_.bodies.motion;
    for_each_joint(world_, body, [&](std::int32_t joint, int side, std::int32_t other) {
      if (world_.joints.headers[std::size_t(joint)].place.color < 0) return;
      if (other == none || !world_.bodies.is_dynamic(other)) return;
      if (world_.bodies.record[std::size_t(other)].awake_index == none) return;
      const JointData<D>& data = world_.joints.at(joint);
      const bool welded = is_welded(data);
      const bool pinned =
          (is_slender(motion[std::size_t(body)]) || is_slender(motion[std::size_t(other)])) && is_pinned(data);
      if (welded || pinned) f(joint, side, other, welded);
    });
  }
  void gather(std::int32_t body) {
    bodies_.assign(1, body);
    mark_[place_of(body)] = seen;
    first_ = body;
    fraction_ = swept_[place_of(body)].fraction;
    uneven_ = false, rigid_ = true;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      for_each_tie(bodies_[i], [&](std::int32_t, int, std::int32_t other, bool welded) {
        rigid_ = rigid_ && welded;
        const std::size_t place = place_of(other);
        if (mark_[place] != unseen) return;
        mark_[place] = seen;
        bodies_.push_back(other);
        const float fraction = swept_[place].fraction;
        uneven_ = uneven_ || fraction != fraction_;
        if (fraction < fraction_) fraction_ = fraction, first_ = other;
      });
  }
  Motion whole_motion() const {
    const typename D::Position base = world_.bodies.motion[std::size_t(first_)].center;
    Motion sum;
    float mass = 0;
    for (const std::int32_t body : bodies_) {
      const BodyMotion<D>& m = world_.bodies.motion[std::size_t(body)];
      mass += m.mass;
      sum.velocity += m.mass * world_.bodies.solver[std::size_t(body)].linear_velocity;
      sum.place += m.mass * typename D::Vector(m.center - base);
    }
    return {sum.velocity / mass, sum.place / mass};
  }
  /// Where it was beside another when the step began.
  void keep_in_place(std::int32_t beside, std::int32_t body) {
    const SweepStart<D>& from = swept_[place_of(beside)];
    SweepStart<D>& start = swept_[place_of(body)];
    typename D::Pose& pose = world_.bodies.pose[std::size_t(body)];
    const typename D::Rotation end = pose.rotation;
    const typename D::Rotation turned = world_.bodies.pose[std::size_t(beside)].rotation * conjugate(from.rotation);
    world_.bodies.motion[std::size_t(body)].center =
        world_.bodies.motion[std::size_t(beside)].center +
        typename D::Position(rotate(turned, typename D::Vector(start.center - from.center)));
    pose.rotation = normalize(turned * start.rotation);
    set_back_spin(world_.bodies.solver[std::size_t(body)], end, pose.rotation);
    start.turn = from.turn;
    start.fraction = fraction_;
    pose_from_center(world_, body);
  }
  /// On its own way, but with its anchor as near that of the other as when the step began.
  void keep_on_pin(std::int32_t joint, int side, std::int32_t beside, std::int32_t body) {
    stop_at(world_, body, fraction_);
    const JointFrames<D>& frames = world_.joints.at(joint).frames();
    const auto gap = [&](bool at_start) {
      const auto anchor = [&](std::int32_t of, const typename D::Vector& p) {
        const BodyMotion<D>& m = world_.bodies.motion[std::size_t(of)];
        const SweepStart<D>& start = swept_[place_of(of)];
        return (at_start ? start.center : m.center) +
               typename D::Position(rotate(at_start ? start.rotation : world_.bodies.pose[std::size_t(of)].rotation,
                                           p - m.local_center));
      };
      return anchor(beside, side == 0 ? frames.frame_a.p : frames.frame_b.p) -
             anchor(body, side == 0 ? frames.frame_b.p : frames.frame_a.p);
    };
    world_.bodies.motion[std::size_t(body)].center += gap(false) - gap(true);
    pose_from_center(world_, body);
  }
  /// With the momentum of the whole, and the spin of the one that was stopped.
  void move_as_one(const Motion& before) {
    const typename D::Position base = world_.bodies.motion[std::size_t(first_)].center;
    const typename D::Angular spin = world_.bodies.solver[std::size_t(first_)].angular_velocity;
    const typename D::Vector middle = whole_motion().place;
    for (const std::int32_t body : bodies_) {
      SolverBody<D>& s = world_.bodies.solver[std::size_t(body)];
      const typename D::Vector arm(world_.bodies.motion[std::size_t(body)].center - base);
      s.linear_velocity = before.velocity + cross(spin, arm - middle);
      s.angular_velocity = spin;
    }
  }

  WorldImplementation<D>& world_;
  std::vector<SweepStart<D>>& swept_;
  std::vector<std::int32_t>& bodies_;
  std::span<std::uint8_t> mark_;  ///< by place in the list of awake bodies
  std::int32_t first_ = none;     ///< the body that was stopped first
  float fraction_ = 1;            ///< of the step, until that one was
  bool uneven_ = false;           ///< not all were stopped at once
  bool rigid_ = true;             ///< welds alone
};

}  // namespace

template <class D>
bool is_welded(const JointData<D>& data) {
  const auto* weld = data.template get<WeldJointDef>();
  return weld != nullptr && !(weld->linear.hertz > 0) && !(weld->angular.hertz > 0);
}

template <class D>
void stop_what_is_tied(StepContext<D>& context) {
  WorldImplementation<D>& world = context.world;
  if (world.joints.slots.size() == 0) return;
  const auto was_stopped = [&](std::int32_t place) {
    return world.scratch.swept[std::size_t(place)].fraction < 1 &&
           world.bodies.record[std::size_t(world.bodies.awake[std::size_t(place)])].joint_count > 0;
  };
  const std::vector<std::int32_t>& fast = world.scratch.fast;  // grows
  const std::size_t count = fast.size();
  std::size_t k = 0;
  while (k < count && !was_stopped(fast[k])) ++k;
  if (k == count) return;
  Tied<D> tied(world, context.arena.template allocate_zeroed<std::uint8_t>(world.bodies.awake.size()));
  for (; k < count; ++k)
    if (was_stopped(fast[k])) tied.stop(world.bodies.awake[std::size_t(fast[k])]);
}

template bool is_welded(const JointData<Dim2>&);
template bool is_welded(const JointData<Dim3>&);
template void stop_what_is_tied(StepContext<Dim2>&);
template void stop_what_is_tied(StepContext<Dim3>&);

}  // namespace carom::rigid::detail
