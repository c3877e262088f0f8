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

/// How far a point strays at most from the tangent of its way while its body turns (rad); what is slender may roll.
float bend_of(const BodyMotion<Dim2>&, float turn, const Vec2f& arm) { return 0.5f * turn * turn * math::length(arm); }
float bend_of(const BodyMotion<Dim3>& m, const Vec3f& turn, const Vec3f& arm) {
  const float angle = math::length(turn);
  return 0.5f * angle * (m.slender == 0 ? angle * math::length(arm) : math::length(cross(turn, arm)));
}

/// How B moved, seen from A, from when its manifolds were made until now: its middle, and its surface about that by the
/// turn, at most. Lanes find it (pair_motions.inl).
template <class D>
struct Moved {
  typename D::Vector way{};
  float turn = 0;
  float extent = 0;  ///< m per radian of what it turns from here

  /// An upper bound for any point of B.
  float most() const { return math::length(way) + turn; }
  /// The same without what is along the normal: approach and parting change separations only.
  float across(const typename D::Vector& normal) const { return math::length(way - normal * dot(normal, way)) + turn; }
};
/// Of what has not moved yet.
float extent_of(const ContactRecord<Dim2>& c, const ShapeRecord<Dim2>& b) {
  return b.geometry.type == geometry::ShapeType2::circle ? 0 : c.extent;
}
float extent_of(const ContactRecord<Dim3>& c, const ShapeRecord<Dim3>&) { return c.extent; }

/// How far the surfaces of a pair with this normal (in the frame of A's shape) may come nearer in this step: by what
/// closes along it. Contacts are foreseen that far, so that impacts happen at the surface, with the energy a body has
/// there; those that do not bounce look no farther than half their thickness. `shape`: how B's shape goes past A, known
/// where the bodies turn; both are bounds.
template <class D>
float look_ahead(const WorldImplementation<D>& world, const ContactRecord<D>& c, const BodySweep<D>& shape,
                 typename D::Vector normal) {
  if ((c.flags & contact_at_origin) == 0) normal = rotate(world.shapes.at(c.shape[0]).local.q, normal);
  normal = rotate(world.bodies.pose[std::size_t(c.body[0])].rotation, normal);
  const std::vector<BodySweep<D>>& sweeps = world.scratch.sweeps;
  const BodySweep<D>&a = sweeps[std::size_t(c.body[0])], &b = sweeps[std::size_t(c.body[1])];
  const auto closing = [&](const BodySweep<D>& s) { return max(s.turning - dot(normal, s.way), 0.0f); };
  const float turning = min(a.turning + b.turning, most_turning * world.last_dt);
  float least = closing(BodySweep<D>{b.way - a.way, turning});
  if (turning > far_turn * c.inner) least = min(least, closing(shape));
  return (c.flags & contact_bouncy) != 0 ? least : min(least, 0.5f * c.inner);
}
/// m: towards where a surface A pushed B in the step before, as far as brings B's middle back to its front. For what
/// was pressed in by more than a quarter of its thickness, by all that lies on it or at once.
Vec3f held_by(const WorldImplementation<Dim3>& world, const ContactRecord<Dim3>& c) {
  if (c.first_manifold == none) return {};
  const geometry::Manifold3& m = world.contacts.manifold(c.first_manifold).manifold;
  const Vec3f middle = transform_point(c.base, ball_about(world.shapes.at(c.shape[1])).middle);
  const float height = dot(m.normal, middle - m.points[0].point) + 0.5f * m.points[0].separation;  // over A's surface
  return m.normal * max(0.5f * c.inner - height, 0.0f);
}
/// How B's shape goes past A in this step, in the frame of A's.
geometry::detail::ShapeWay approach_of(const WorldImplementation<Dim3>& world, const ContactRecord<Dim3>& c,
                                       float reach, bool known) {
  geometry::detail::ShapeWay approach;
  if (known) approach.held = held_by(world, c);
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
  if (moved.most() >= longest_slide<D> * c.inner) return -1e30f;
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
