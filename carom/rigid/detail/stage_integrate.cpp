#include <bit>

#include "carom/rigid/detail/flight_lanes.h"
#include "carom/rigid/detail/move_body.h"
#include "carom/rigid/detail/move_lanes.h"
#include "carom/rigid/detail/stages.h"

namespace carom::rigid::detail {
namespace {

constexpr float still_turn = 0.99999f;  ///< less than half a degree

/// Contacts have the arms and normals of the step's beginning, and of a body that turns slowly the inertia. Of what is
/// slender and turns far within a step they would so make energy: a blow that the long axis takes easily is then one on
/// the others. What they gave to the spin since the body last turned is cut back until it holds no more energy than it
/// would as the body stood when the step began.
void bound_spin(StepContext<Dim3>& context, int place) {
  const std::int32_t body = context.drives[place].body;
  SolverBody<Dim3>& s = context.bodies[body];
  if (s.delta_rotation.w > still_turn) return;
  const Vec3f before = context.spins[place], gain = s.angular_velocity - before;
  const Mat3f& tensor = context.world.bodies.motion[std::size_t(body)].inertia;
  const Quatf start = context.world.bodies.pose[std::size_t(body)].rotation, now = s.delta_rotation * start;
  const auto momentum = [&](const Quatf& q, const Vec3f& w) { return rotate(q, tensor * inverse_rotate(q, w)); };
  const Vec3f believed = momentum(start, gain), real = momentum(now, gain);
  const float b = dot(real, before), a = dot(real, gain);
  const float allowed = dot(believed, before) + 0.5f * dot(believed, gain);
  if (!(a > 0) || b + 0.5f * a <= allowed) return;
  const float square = b * b + 2 * a * allowed;
  const float share = clamp((square > 0 ? math::sqrt(square) - b : -b) / a, 0.0f, 1.0f);
  s.angular_velocity = before + share * gain;
}

/// Gathers bodies of space that constraints push about, and turns as many as there are lanes at once.
template <int W>
class PushedBodies {
 public:
  explicit PushedBodies(StepContext<Dim3>& context) : context_(context), turn_(context.world.kernels.move.turn) {}
  PushedBodies(const PushedBodies&) = delete;
  ~PushedBodies() {
    if (count_ > 0) turn();
  }
  /// By its place in the list of awake bodies.
  void add(int place) {
    const BodyDrive<Dim3>& drive = context_.drives[place];
    if ((drive.flags & BodyDrive<Dim3>::bounded) != 0) bound_spin(context_, place);
    place_[count_] = place;
    body_[count_++] = drive.body;
    if ((drive.flags & BodyDrive<Dim3>::carries) != 0) {
      carrying_[carry_count_++] = place;
      context_.flights[place].spin -= context_.bodies[drive.body].angular_velocity;
    }
    if (count_ == W) turn();
  }

 private:
  void turn() {
    const BodyStore<Dim3>& bodies = context_.world.bodies;
    turn_(context_.bodies, bodies.pose.data(), bodies.motion.data(), body_, count_, context_.h);
    for (int k = 0; k < carry_count_; ++k)
      context_.flights[carrying_[k]].spin += context_.bodies[context_.drives[carrying_[k]].body].angular_velocity;
    for (int k = 0; k < count_; ++k) context_.spins[place_[k]] = context_.bodies[body_[k]].angular_velocity;
    count_ = carry_count_ = 0;
  }
  StepContext<Dim3>& context_;
  decltype(MoveKernels::turn) turn_;
  std::int32_t body_[W] = {};
  int place_[W] = {};
  int carrying_[W] = {};  ///< places of those whose spin turns with them (Flight)
  int count_ = 0, carry_count_ = 0;
};

/// The same for bodies that nothing touches: in double, because one near its intermediate axis feels every rounding.
template <int W>
class FreeBodies {
 public:
  FreeBodies(StepContext<Dim3>& context, int substeps)
      : context_(context), fly_(context.world.kernels.turn_free), substeps_(substeps) {
    clear();
  }
  FreeBodies(const FreeBodies&) = delete;
  ~FreeBodies() {
    if (count_ > 0) turn();
  }
  /// By its place in the list of awake bodies; each substep adds `gain` to the spin and keeps a part of it.
  void add(int place, const Vec3f& gain, float keep) {
    const std::int32_t body = context_.drives[place].body;
    const Mat3f& inertia = context_.world.bodies.motion[std::size_t(body)].inertia;
    const Quatd start = normalize(Quatd(context_.world.bodies.pose[std::size_t(body)].rotation));
    const SolverBody<Dim3>& s = context_.bodies[body];
    const Vec3f rest{s.spin_rest_x, s.spin_rest_y, s.spin_rest_z};
    const float tensor[6] = {inertia.cx.x, inertia.cx.y, inertia.cx.z, inertia.cy.y, inertia.cy.z, inertia.cz.z};
    for (int i = 0; i < 6; ++i) lanes_.inertia[i][count_] = double(tensor[i]);
    lanes_.start[0][count_] = start.w;
    lanes_.so_far[0][count_] = double(s.delta_rotation.w);
    for (int i = 0; i < 3; ++i) {
      lanes_.start[i + 1][count_] = start.vector()[i];
      lanes_.so_far[i + 1][count_] = double(s.delta_rotation.vector()[i]);
      lanes_.spin[i][count_] = double(s.angular_velocity[i]) + double(rest[i]);
      lanes_.gain[i][count_] = double(gain[i]);
    }
    lanes_.keep[count_] = double(keep);
    lanes_.any_gain = lanes_.any_gain || !(gain == Vec3f{});
    lanes_.body[count_] = body;
    places_[count_] = place;
    if (++count_ == W / 2) turn();
  }

 private:
  void turn() {
    fly_(&lanes_, context_.h, substeps_, max_turn);
    for (int k = 0; k < count_; ++k) {
      SolverBody<Dim3>& s = context_.bodies[lanes_.body[k]];
      s.delta_rotation =
          Quatf(Quatd{lanes_.so_far[0][k], {lanes_.so_far[1][k], lanes_.so_far[2][k], lanes_.so_far[3][k]}});
      // Energy and the size of the momentum are those in body axes, however the attitude is rounded: near the
      // intermediate axis that decides when it flips.
      const Quatf now = normalize(s.delta_rotation * context_.world.bodies.pose[std::size_t(lanes_.body[k])].rotation);
      const Vec3d w = rotate(normalize(Quatd(now)), Vec3d{lanes_.spin[0][k], lanes_.spin[1][k], lanes_.spin[2][k]});
      if ((context_.drives[places_[k]].flags & BodyDrive<Dim3>::carries) != 0) {
        Vec3f& spin = context_.flights[places_[k]].spin;
        spin = spin - s.angular_velocity + Vec3f(w);
      }
      s.angular_velocity = Vec3f(w);
      context_.spins[places_[k]] = s.angular_velocity;
      const Vec3f rest(w - Vec3d(s.angular_velocity));
      s.spin_rest_x = rest.x, s.spin_rest_y = rest.y, s.spin_rest_z = rest.z;
    }
    clear();
  }
  void clear() {
    count_ = 0;
    lanes_ = {};
    for (int k = 0; k < W / 2; ++k) {
      lanes_.inertia[0][k] = lanes_.inertia[3][k] = lanes_.inertia[5][k] = 1;
      lanes_.start[0][k] = lanes_.so_far[0][k] = lanes_.keep[k] = 1;
    }
  }
  StepContext<Dim3>& context_;
  FlightKernel fly_;
  int substeps_, count_ = 0;
  FlightLanes<W / 2> lanes_;
  int places_[W / 2] = {};
};

/// Moves the centre of the body at a place of the awake list. Returns whether nothing but forces moved it.
template <class D>
bool move_center(StepContext<D>& context, int place) {
  const BodyDrive<D>& drive = context.drives[place];
  SolverBody<D>& s = context.bodies[drive.body];
  Flight<D>& flight = context.flights[place];
  const typename D::Vector accelerated = flight.after;
  if (drive.locks != 0) {  // which take from it what constraints gave
    flight.after -= s.linear_velocity, flight.spin -= s.angular_velocity;
    apply_locks(s, drive.locks);
    flight.after += s.linear_velocity, flight.spin += s.angular_velocity;
  }
  if ((drive.flags & BodyDrive<D>::in_flight) != 0) return true;
  // What others are near but do not touch flies too: nothing has changed its velocity.
  const bool flies = (drive.flags & BodyDrive<D>::dynamic) != 0 && s.linear_velocity == accelerated;
  if (flies)
    s.delta_position += (0.5f * context.h) * (flight.before + s.linear_velocity);
  else
    s.delta_position += context.h * s.linear_velocity;
  return flies;
}

float speed_of(float w) { return math::abs(w); }
float speed_of(const Vec3f& w) { return math::length(w); }

}  // namespace

template <class D>
void prepare_drives(StepContext<D>& context) {
  const auto& bodies = context.world.bodies;
  const float h = context.h;
  const typename D::Vector gravity = context.world.definition.gravity;
  const bool touches = any_contacts(context.world);
  context.drives = context.arena.template allocate<BodyDrive<D>>(bodies.awake.size()).data();
  if (D::dimension == 3)
    context.spins = context.arena.template allocate<typename D::Angular>(bodies.awake.size()).data();
  context.scheduler.parallel_for(int(bodies.awake.size()), 256, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      BodyDrive<D>& drive = *::new (static_cast<void*>(&context.drives[i])) BodyDrive<D>{};
      drive.body = bodies.awake[std::size_t(i)];
      const BodyRecord& record = bodies.record[std::size_t(drive.body)];
      const BodyMotion<D>& m = bodies.motion[std::size_t(drive.body)];
      drive.locks = record.locks;
      if (record.locks != 0) drive.kind = 4;
      if (record.type != BodyType::dynamic) continue;
      drive.flags = BodyDrive<D>::dynamic;
      if (record.constraint_count == 0) {
        drive.flags |= BodyDrive<D>::in_flight;
        if (D::dimension == 3 && record.locks == 0) drive.flags |= BodyDrive<D>::flies_through;
      }
      std::uint8_t& again = context.world.scratch.again[std::size_t(drive.body)];
      const bool carries = touches && record.constraint_count > 0 && again == 0;
      again = 0;
      if (carries) drive.flags |= BodyDrive<D>::carries;
      if (record.locks == 0) drive.kind = record.constraint_count == 0 ? 3.0f : carries ? 2.0f : 1.0f;
      if (may_turn_freely(m, record)) {
        drive.flags |= BodyDrive<D>::gyroscopic;
        // Joints see the inertia of every substep.
        if (D::dimension == 3 && m.slender != 0 && record.constraint_count > 0 && record.joint_count == 0) {
          drive.flags |= BodyDrive<D>::bounded;
          context.spins[i] = bodies.solver[std::size_t(drive.body)].angular_velocity;
        }
      }
      const float pace = bodies.pace(drive.body), share = h * load_share(m) * (pace * pace);
      drive.linear_gain = share * (m.gravity_scale * gravity + m.inverse_mass * m.force);
      drive.angular_gain = share * (m.world_inverse_inertia * m.torque);
      drive.linear_keep = 1 / (1 + h * pace * m.linear_damping);
      drive.angular_keep = 1 / (1 + h * pace * m.angular_damping);
    }
  });
}

namespace {

/// Of the places [begin, end) as many as a kernel takes at once, the others one by one: the same arithmetic.
template <class Kernel, class Single>
void by_lanes(const StepContext<Dim2>& context, int begin, int end, Kernel&& kernel, Single&& single) {
  const int width = context.world.kernels.width;
  for (; begin + width <= end; begin += width)
    if (!kernel(begin)) single(begin, begin + width);
  if (begin < end) single(begin, end);
}

/// What forces and damping make of a body's velocity in a substep of h seconds. Returns the velocity before.
template <class D>
typename D::Vector accelerate(SolverBody<D>& s, const BodyDrive<D>& drive, float max_speed) {
  const typename D::Vector before = s.linear_velocity;
  s.linear_velocity += drive.linear_gain;
  s.linear_velocity *= drive.linear_keep;
  if (drive.locks != 0) apply_locks(s, drive.locks);
  const float speed_squared = math::length_squared(s.linear_velocity);
  if (speed_squared > max_speed * max_speed) s.linear_velocity *= max_speed / math::sqrt(speed_squared);
  return before;
}
template <class D>
void spin_up(SolverBody<D>& s, const BodyDrive<D>& drive, float h) {
  s.angular_velocity += drive.angular_gain;
  s.angular_velocity *= drive.angular_keep;
  if (drive.locks != 0) apply_locks(s, drive.locks);
  const float spin = speed_of(s.angular_velocity);
  if (spin * h > max_turn) s.angular_velocity *= max_turn / (spin * h);
}

template <class D>
void accelerate_bodies(StepContext<D>& context, int begin, int end, bool carry_on) {
  const float h = context.h, max_speed = context.world.definition.maximum_linear_speed;
  for (int i = begin; i < end; ++i) {
    const BodyDrive<D>& drive = context.drives[i];
    if ((drive.flags & BodyDrive<D>::dynamic) == 0 || (drive.flags & BodyDrive<D>::flies_through) != 0) continue;
    SolverBody<D>& s = context.bodies[drive.body];
    Flight<D>& flight = context.flights[i];
    const bool carries = (drive.flags & BodyDrive<D>::carries) != 0;
    typename D::Vector carried{};
    typename D::Angular carried_spin{};
    if (carry_on && carries) {
      carried = s.linear_velocity - flight.after;
      carried_spin = s.angular_velocity - flight.spin;
    }
    const typename D::Vector before = accelerate(s, drive, max_speed);
    spin_up(s, drive, h);
    // Free flight: the mean of the velocities makes ½at² exact. In contact it would fight the contact.
    if ((drive.flags & BodyDrive<D>::in_flight) != 0) {
      s.delta_position += (0.5f * h) * (before + s.linear_velocity);
      continue;
    }
    flight.after = s.linear_velocity, flight.before = before;
    if (!carries) continue;
    flight.spin = s.angular_velocity;
    s.linear_velocity += carried;
    s.angular_velocity += carried_spin;
  }
}

template <int W>
void move_bodies(StepContext<Dim2>& context, int begin, int end) {
  by_lanes(
      context, begin, end,
      [&](int first) {
        return context.world.kernels.integrate_positions(
            context.bodies, context.drives + first, reinterpret_cast<const float*>(context.flights + first), context.h);
      },
      [&](int first, int last) {
        for (int i = first; i < last; ++i) {
          move_center(context, i);
          turn_body(context.bodies[context.drives[i].body], context.h);
        }
      });
}
/// f(place) for each of those that follow `first`. Bits by their distance.
template <class F>
void for_places(std::uint32_t which, int first, F&& f) {
  for (; which != 0; which &= which - 1) f(first + std::countr_zero(which));
}
template <int W>
void move_bodies(StepContext<Dim3>& context, int begin, int end) {
  const MoveKernels& kernels = context.world.kernels.move;
  PushedBodies<W> pushed(context);
  FreeBodies<W> free(context, 1);
  for (int first = begin; first < end; first += W) {
    const LeftOver left =
        kernels.move(context.bodies, context.drives + first, context.flights + first, min(W, end - first), context.h);
    for_places(left.locked, first, [&](int i) {
      const BodyDrive<Dim3>& drive = context.drives[i];
      SolverBody<Dim3>& s = context.bodies[drive.body];
      const bool flies = move_center(context, i);
      if ((drive.flags & BodyDrive<Dim3>::gyroscopic) == 0 || !spins(s.angular_velocity))
        turn_body(s, context.h);
      else if (flies)
        free.add(i, {}, 1);
      else
        pushed.add(i);
    });
    for_places(left.free, first, [&](int i) { free.add(i, {}, 1); });
    for_places(left.pushed, first, [&](int i) { pushed.add(i); });
  }
}

/// All substeps of the bodies that nothing touches.
template <int W>
void fly_bodies(StepContext<Dim3>& context, int begin, int end) {
  const MoveKernels& kernels = context.world.kernels.move;
  FreeBodies<W> free(context, context.substeps);
  for (int first = begin; first < end; first += W)
    for_places(kernels.fly(context.bodies, context.drives + first, min(W, end - first), context.h, context.substeps,
                           context.world.definition.maximum_linear_speed),
               first, [&](int i) { free.add(i, context.drives[i].angular_gain, context.drives[i].angular_keep); });
}

}  // namespace

void bound_spins(StepContext<Dim3>& context) {
  context.scheduler.parallel_for(int(context.world.bodies.awake.size()), 256, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i)
      if ((context.drives[i].flags & BodyDrive<Dim3>::bounded) != 0) bound_spin(context, i);
  });
}

void fly_through(StepContext<Dim3>& context, int begin, int end) {
  const int width = context.world.kernels.width;
  if (width == 16) return fly_bodies<16>(context, begin, end);
  if (width == 8) return fly_bodies<8>(context, begin, end);
  fly_bodies<4>(context, begin, end);
}

template <class D>
void integrate_velocities(StepContext<D>& context, int begin, int end, bool carry_on) {
  const float max_speed = context.world.definition.maximum_linear_speed;
  if constexpr (D::dimension == 3) {
    const int width = context.world.kernels.width;
    const MoveKernels& kernels = context.world.kernels.move;
    for (int first = begin; first < end; first += width)
      for_places(kernels.accelerate(context.bodies, context.drives + first, context.flights + first,
                                    min(width, end - first), context.h, max_speed, carry_on),
                 first, [&](int i) { accelerate_bodies(context, i, i + 1, carry_on); });
  } else {
    by_lanes(
        context, begin, end,
        [&](int first) {
          return context.world.kernels.integrate_velocities(context.bodies, context.drives + first,
                                                            reinterpret_cast<float*>(context.flights + first),
                                                            context.h, max_speed, max_turn, carry_on);
        },
        [&](int first, int last) { accelerate_bodies(context, first, last, carry_on); });
  }
}

template <class D>
void integrate_positions(StepContext<D>& context, int begin, int end) {
  const int width = context.world.kernels.width;
  if (width == 16) return move_bodies<16>(context, begin, end);
  if (width == 8) return move_bodies<8>(context, begin, end);
  move_bodies<4>(context, begin, end);
}

template void prepare_drives<Dim2>(StepContext<Dim2>&);
template void prepare_drives<Dim3>(StepContext<Dim3>&);
template void integrate_velocities<Dim2>(StepContext<Dim2>&, int, int, bool);
template void integrate_velocities<Dim3>(StepContext<Dim3>&, int, int, bool);
template void integrate_positions<Dim2>(StepContext<Dim2>&, int, int);
template void integrate_positions<Dim3>(StepContext<Dim3>&, int, int);

}  // namespace carom::rigid::detail
