// How the two shapes of a contact have moved past each other and how far they may come in this step (part of
// stage_narrow_phase.cpp).
#pragma once

namespace carom::rigid::detail {
namespace {

constexpr float recycle_share = 0.1f;   ///< of the smaller half thickness: manifolds stay while the pair slid less,
constexpr float rolling_share = 0.01f;  ///< and where something rolls

/// m: how far a pair may slide and turn until its manifolds are made anew. Where something is round, the point in which
/// it meets another moves over both, and the normal turns with it: a manifold kept over a way s is wrong by s²/2r, and
/// what rocks on it is lifted by as much at every new one.
template <class D>
float longest_way(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
  const float most = recycle_share * c.inner;
  return c.rolls ? min(most, max(rolling_share * c.inner, still_way(world, world.last_dt))) : most;
}

/// How far a turn (rad, times a scale) in its own frame moves the surface of a shape about its middle, at most: about
/// its long axis little. `ball`: m, about all of it.
float way_of_turn(const ShapeRecord<Dim2>& shape, float turn, float ball) {
  return shape.geometry.type == geometry::ShapeType2::circle ? 0 : math::abs(turn) * ball;
}
float way_of_turn(const ShapeRecord<Dim3>& shape, const Vec3f& turn, float ball) {
  const float most = math::length(turn) * ball;
  if (shape.geometry.type != geometry::ShapeType3::hull || ball < 2 * shape.inner_extent) return most;
  const Vec3f e = shape.geometry.hull->bounds.extents();
  const float rounding = math::length(turn) * shape.geometry.hull->radius;
  const Vec3f arms{math::sqrt(e.y * e.y + e.z * e.z), math::sqrt(e.z * e.z + e.x * e.x),
                   math::sqrt(e.x * e.x + e.y * e.y)};
  return min(most, dot(abs(turn), arms) + rounding);
}
/// m per radian: what a further turn adds to that at most, after one of `before` rad that took `way` of m. Where that
/// was less than all of the ball, other axes are not all alike, and turns about two of them are more than either.
float way_of_more(const ShapeRecord<Dim2>& shape, float, float, float ball) {
  return shape.geometry.type == geometry::ShapeType2::circle ? 0 : ball;
}
float way_of_more(const ShapeRecord<Dim3>& shape, const Vec3f& before, float way, float ball) {
  const float angle = math::length(before);
  if (!(way < angle * ball)) return ball;
  const geometry::Hull& hull = *shape.geometry.hull;
  return max(ball, 1.4143f * math::length(hull.bounds.extents()) * (1 + angle) + hull.radius);
}
/// Chords are twice this.
float half_chord(const Rot2f& a, const Rot2f& b) { return 0.5f * chord(a, b); }
Vec3f half_chord(const Quatf& a, const Quatf& b) { return (conjugate(a) * b).vector(); }

/// How far a point strays at most from the tangent of its way while its body turns (rad); what is slender may roll.
float bend_of(const BodyMotion<Dim2>&, float turn, const Vec2f& arm) { return 0.5f * turn * turn * math::length(arm); }
float bend_of(const BodyMotion<Dim3>& m, const Vec3f& turn, const Vec3f& arm) {
  const float angle = math::length(turn);
  return 0.5f * angle * (m.slender == 0 ? angle * math::length(arm) : math::length(cross(turn, arm)));
}

/// How B moved, seen from A, from when its manifolds were made to `now`: its middle, and its surface about that by the
/// turn, at most.
template <class D>
struct Moved {
  typename D::Vector way{};
  float turn = 0;
  float extent;  ///< m per radian of what it turns from here

  Moved(const typename D::Vector& moved_way, float moved_turn, float more)
      : way(moved_way), turn(moved_turn), extent(more) {}
  /// Not yet.
  Moved(const ContactRecord<D>& c, const ShapeRecord<D>& b) : extent(way_of_more(b, {}, 0, c.extent)) {}
  Moved(const ContactRecord<D>& c, const ShapeRecord<D>& b, const typename D::Transform& now) {
    const typename D::Vector middle = ball_about(b).middle;
    way = transform_point(now, middle) - transform_point(c.base, middle);
    const auto half = half_chord(c.base.q, now.q);
    const float half_way = way_of_turn(b, half, c.extent);
    turn = 2 * half_way;
    extent = way_of_more(b, half, half_way, c.extent);
  }
  /// An upper bound for any point of B.
  float most() const { return math::length(way) + turn; }
  /// The same without what is along the normal: approach and parting change separations only.
  float across(const typename D::Vector& normal) const { return math::length(way - normal * dot(normal, way)) + turn; }
};

/// A turn of the world in a shape's frame.
float in_frame(const Rot2f&, float turn) { return turn; }
Vec3f in_frame(const Quatf& frame, const Vec3f& turn) { return inverse_rotate(frame, turn); }

/// How B's shape goes past A in this step by the velocities of their bodies, seen from A: its middle, and what the
/// turns add to that anywhere in it. Long bodies turn fast at their ends only.
template <class D>
BodySweep<D> sweep_of_shape(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
  const ShapeRecord<D>& shape = world.shapes.at(c.shape[1]);
  const typename D::Pose pose = shape_pose(world, shape);
  const typename D::Position middle = world_point(pose, ball_about(shape).middle);
  BodySweep<D> sweep;
  for (int side = 0; side < 2; ++side) {
    const std::size_t body = std::size_t(c.body[side]);
    const SolverBody<D>& s = world.bodies.solver[body];
    const typename D::Vector arm = typename D::Vector(middle - world.bodies.motion[body].center);
    const typename D::Vector way = (s.linear_velocity + cross(s.angular_velocity, arm)) * world.last_dt;
    sweep.way = side == 0 ? sweep.way - way : sweep.way + way;
    const typename D::Angular turn = s.angular_velocity * world.last_dt;
    sweep.turning +=
        way_of_turn(shape, in_frame(pose.rotation, turn), c.extent) + bend_of(world.bodies.motion[body], turn, arm);
  }
  return sweep;
}
/// The same, found when it is first asked for.
template <class D>
struct ShapeSweep {
  BodySweep<D> sweep;
  bool known = false;

  const BodySweep<D>& of(const WorldImplementation<D>& world, const ContactRecord<D>& c) {
    if (!known) sweep = sweep_of_shape(world, c), known = true;
    return sweep;
  }
};
/// Calls way(sweep) for the sweep of the bodies and, where they turn, for that of the shape: both are bounds.
template <class D, class Way>
float least_way(const WorldImplementation<D>& world, const ContactRecord<D>& c, ShapeSweep<D>& shape, Way&& way) {
  const std::vector<BodySweep<D>>& sweeps = world.scratch.sweeps;
  const BodySweep<D>&a = sweeps[std::size_t(c.body[0])], &b = sweeps[std::size_t(c.body[1])];
  const float turning = min(a.turning + b.turning, most_turning * world.last_dt);
  float least = way(BodySweep<D>{b.way - a.way, turning});
  if (turning > 0.1f * c.inner) least = min(least, way(shape.of(world, c)));
  return (c.flags & contact_bouncy) != 0 ? least : min(least, 0.5f * c.inner);
}

/// How far the surfaces of the pair may come nearer in this step. Contacts are foreseen that far, so that impacts
/// happen at the surface, with the energy a body has there; those that do not bounce look no farther than half their
/// thickness.
template <class D>
float look_ahead(const WorldImplementation<D>& world, const ContactRecord<D>& c, ShapeSweep<D>& shape) {
  return least_way(world, c, shape, [](const BodySweep<D>& s) { return math::length(s.way) + s.turning; });
}
/// The same for a contact with this normal (in the frame of A's shape): what counts is what closes along it.
template <class D>
float look_ahead(const WorldImplementation<D>& world, const ContactRecord<D>& c, ShapeSweep<D>& shape,
                 typename D::Vector normal) {
  if ((c.flags & contact_at_origin) == 0) normal = rotate(world.shapes.at(c.shape[0]).local.q, normal);
  normal = rotate(world.bodies.pose[std::size_t(c.body[0])].rotation, normal);
  return least_way(world, c, shape, [&](const BodySweep<D>& s) { return max(s.turning - dot(normal, s.way), 0.0f); });
}
/// How B's shape goes past A in this step, in the frame of A's.
geometry::detail::ShapeWay approach_of(const WorldImplementation<Dim3>& world, const ContactRecord<Dim3>& c,
                                       float reach) {
  geometry::detail::ShapeWay approach;
  const ShapeRecord<Dim3>& shape = world.shapes.at(c.shape[1]);
  const Dim3::Pose pose = shape_pose(world, shape);
  const ShapeBall<Dim3> ball = ball_about(shape);
  const Vec3f to_middle = rotate(pose.rotation, ball.middle);
  for (int side = 0; side < 2; ++side) {
    const std::size_t body = std::size_t(c.body[side]);
    const SolverBody<Dim3>& s = world.bodies.solver[body];
    const Vec3f arm = Vec3f(pose.position - world.bodies.motion[body].center),
                turn = s.angular_velocity * world.last_dt;
    const Vec3f way = s.linear_velocity * world.last_dt + cross(turn, arm);
    approach.way = side == 0 ? approach.way - way : approach.way + way;
    approach.turn = side == 0 ? approach.turn - turn : approach.turn + turn;
    approach.bend +=
        bend_of(world.bodies.motion[body], turn, arm + to_middle) + 0.5f * length_squared(turn) * ball.radius;
  }
  const Quatf frame = shape_pose(world, world.shapes.at(c.shape[0])).rotation;
  approach.way = inverse_rotate(frame, approach.way), approach.turn = inverse_rotate(frame, approach.turn);
  // What moves fast is looked at again in the next step anyway.
  const float margin = c.margin(), ahead = reach - 2 * margin;
  const float more = 0.5f * margin;
  approach.margin = margin + clamp(more - ahead, 0.0f, more);
  approach.worth = margin + 3 * ahead;  // two steps
  return approach;
}
/// m: how far a pair that is apart along an axis may move until it is looked at whether its bounds still meet.
template <class D>
float longest_slide(const ContactRecord<D>& c) {
  return (D::dimension == 2 ? 1.0f : 0.5f) * c.inner;
}
/// m: how far apart along their axis two are that have moved so, at least.
template <class D>
float gap_along(const ContactRecord<D>& c, const Moved<D>& moved) {
  return c.gap + dot(c.axis, moved.way) - moved.turn;
}
/// How much nearer B may still come to A until the pair is of interest; what it may do in this step not
/// counted. Apart from each other along an axis, they may slide past each other, but are looked at now and then, so
/// that pairs end whose bounds have parted.
template <class D>
float slack_of(const ContactRecord<D>& c, const Moved<D>& moved) {
  const float slack = c.gap - c.margin();
  if (c.axis == typename D::Vector{}) return slack - moved.most();
  if (moved.most() >= longest_slide(c)) return -1e30f;
  return slack + dot(c.axis, moved.way) - moved.turn;
}

/// Finds how far bodies may come in the step.
template <class D>
void measure_sweeps(WorldImplementation<D>& world) {
  StepScratch<D>& scratch = world.scratch;
  if (scratch.watches.size() != world.contacts.awake.size()) {
    scratch.watches.clear();
    scratch.watches.resize(world.contacts.awake.size());
  }
  if (world.contacts.awake.empty()) return;
  scratch.sweeps.resize(world.bodies.pose.size());
  for (const std::int32_t body : scratch.sweeping) scratch.sweeps[std::size_t(body)] = {};
  scratch.sweeping.assign(world.bodies.awake.begin(), world.bodies.awake.end());
  world.scheduler->parallel_for(int(world.bodies.awake.size()), 512, [&](int begin, int end, int) {
    for (int i = begin; i < end; ++i) {
      const std::size_t body = std::size_t(world.bodies.awake[std::size_t(i)]);
      const SolverBody<D>& s = world.bodies.solver[body];
      scratch.sweeps[body] = {
          s.linear_velocity * world.last_dt,
          reach_of_turn(world.bodies.motion[body], world.bodies.pose[body].rotation, s.angular_velocity) *
              world.last_dt};
    }
  });
}

}  // namespace
}  // namespace carom::rigid::detail
