// What is welded stops as one. Continuous collision stops one body at a time: of several that are welded to each other
// it would leave one where it met something and send the others on, and what the weld then does to bring them together
// again is work out of nothing. So all of them are set back to where the one that was stopped first is.
#include "carom/rigid/detail/body_way.h"

namespace carom::rigid::detail {
namespace {

constexpr float listed = -1;  ///< SweepStart::fraction of a body that is in the list

template <class D>
class Welded {
 public:
  explicit Welded(WorldImplementation<D>& world)
      : world_(world), swept_(world.scratch.swept), bodies_(world.scratch.welded) {}

  /// All that is welded to the body at a place of the list of awake bodies.
  void gather(std::int32_t place) {
    bodies_.clear();
    first_ = place;
    fraction_ = 2;
    uneven_ = false;
    add(place);
    for (std::size_t i = 0; i < bodies_.size(); ++i)
      for_each_weld(world_, bodies_[i], [&](std::int32_t other) {
        const std::int32_t at = world_.bodies.record[std::size_t(other)].awake_index;
        if (at != none && swept_[std::size_t(at)].fraction != listed) add(at);
      });
  }
  /// Brings them to where the first of them was stopped.
  void stop() {
    const SweepStart<D> lead = swept_[std::size_t(first_)];
    for (const std::int32_t body : bodies_) start_of(body).fraction = fraction_;
    if (!uneven_) return;
    const std::int32_t leader = world_.bodies.awake[std::size_t(first_)];
    const typename D::Position center = world_.bodies.motion[std::size_t(leader)].center;
    const typename D::Rotation turned = world_.bodies.pose[std::size_t(leader)].rotation * conjugate(lead.rotation);
    const typename D::Angular spin = world_.bodies.solver[std::size_t(leader)].angular_velocity;
    const Mean mean = mean_motion(center);
    for (const std::int32_t body : bodies_) {
      if (body == leader) continue;
      SweepStart<D>& start = start_of(body);
      world_.bodies.motion[std::size_t(body)].center =
          center + typename D::Position(rotate(turned, typename D::Vector(start.center - lead.center)));
      world_.bodies.pose[std::size_t(body)].rotation = normalize(turned * start.rotation);
      start.turn = lead.turn;
      pose_from_center(world_, body);
    }
    // They move on as one, with the momentum that they have and the spin of the one that was stopped.
    const typename D::Vector middle = mean_motion(center).place;
    for (const std::int32_t body : bodies_) {
      SolverBody<D>& s = world_.bodies.solver[std::size_t(body)];
      const typename D::Vector arm(world_.bodies.motion[std::size_t(body)].center - center);
      s.linear_velocity = mean.velocity + cross(spin, arm - middle);
      s.angular_velocity = spin;
    }
    for (const std::int32_t body : bodies_) {
      BodyRecord& record = world_.bodies.record[std::size_t(body)];
      if ((record.flags & body_fast) != 0) continue;
      record.flags |= body_fast;
      look_at_bounds(world_.bodies.motion[std::size_t(body)]);
      world_.scratch.fast.push_back(record.awake_index);
    }
  }

 private:
  struct Mean {
    typename D::Vector velocity{}, place{};  ///< m/s; m, of the centre of mass
  };
  SweepStart<D>& start_of(std::int32_t body) {
    return swept_[std::size_t(world_.bodies.record[std::size_t(body)].awake_index)];
  }
  void add(std::int32_t place) {
    float& fraction = swept_[std::size_t(place)].fraction;
    uneven_ = uneven_ || (!bodies_.empty() && fraction != fraction_);
    if (fraction < fraction_) fraction_ = fraction, first_ = place;
    fraction = listed;
    bodies_.push_back(world_.bodies.awake[std::size_t(place)]);
  }
  Mean mean_motion(const typename D::Position& base) const {
    Mean sum;
    float mass = 0;
    for (const std::int32_t body : bodies_) {
      const BodyMotion<D>& m = world_.bodies.motion[std::size_t(body)];
      mass += m.mass;
      sum.velocity += m.mass * world_.bodies.solver[std::size_t(body)].linear_velocity;
      sum.place += m.mass * typename D::Vector(m.center - base);
    }
    return {sum.velocity / mass, sum.place / mass};
  }

  WorldImplementation<D>& world_;
  std::vector<SweepStart<D>>& swept_;
  std::vector<std::int32_t>& bodies_;
  std::int32_t first_ = none;  ///< place of the one that was stopped first
  float fraction_ = 1;         ///< of that one
  bool uneven_ = false;        ///< not all were stopped at once
};

}  // namespace

template <class D>
void stop_what_is_welded(WorldImplementation<D>& world) {
  if (world.joints.slots.size() == 0) return;
  StepScratch<D>& scratch = world.scratch;
  Welded<D> welded(world);
  const std::size_t count = scratch.fast.size();
  for (std::size_t k = 0; k < count; ++k) {
    const std::int32_t place = scratch.fast[k];
    const bool jointed = world.bodies.record[std::size_t(world.bodies.awake[std::size_t(place)])].joint_count > 0;
    if (!jointed || scratch.swept[std::size_t(place)].fraction >= 1) continue;
    welded.gather(place);
    welded.stop();
  }
}

template void stop_what_is_welded(WorldImplementation<Dim2>&);
template void stop_what_is_welded(WorldImplementation<Dim3>&);

}  // namespace carom::rigid::detail
