#include "carom/ballistics/hits.h"

#include <algorithm>

#include "carom/core/string.h"
#include "carom/geometry/query.h"

namespace carom::ballistics {

using math::Vec3d;

namespace detail {

template <class D>
typename D::Position to_world(Vec3d p) {
  if constexpr (D::dimension == 2)
    return {p.x, p.y};
  else
    return p;
}
template <class V>
Vec3d from_world(V v) {
  if constexpr (requires { v.z; })
    return {v.x, v.y, v.z};
  else
    return {v.x, v.y, 0};
}

/// What a body's surface does at a point: its velocity, and how easily it gives way.
template <class D>
struct Struck {
  rigid::BodyState<D> state;
  double inverse_mass = 0;
  math::Mat3d inverse_inertia = math::Mat3d::zero();  // body axes

  Struck(const rigid::World<D>& world, rigid::BodyId body) {
    if (auto s = world.state(body); s.ok()) state = *s;
    if (state.type != rigid::BodyType::dynamic || !(state.mass > 0)) return;
    inverse_mass = 1.0 / state.mass;
    if constexpr (D::dimension == 3) {
      if (auto mass = world.mass_properties3(body); mass.ok() && mass->inertia(0, 0) > 0)
        inverse_inertia = math::inverse(mass->inertia);
    } else {
      if (auto mass = world.mass_properties2(body); mass.ok() && mass->inertia > 0)
        inverse_inertia.cz.z = 1 / mass->inertia;
    }
  }
  Vec3d velocity_at(Vec3d point) const {
    const Vec3d r = point - from_world(state.center_of_mass);
    if constexpr (D::dimension == 3)
      return from_world(state.linear_velocity) + cross(Vec3d(state.angular_velocity), r);
    else
      return from_world(state.linear_velocity) + cross(Vec3d{0, 0, double(state.angular_velocity)}, r);
  }
  /// How much velocity at the point along d an impulse of 1 N·s along d gives (1/kg).
  double mobility(Vec3d point, Vec3d d) const {
    if (inverse_mass == 0) return 0;
    const Vec3d arm = cross(point - from_world(state.center_of_mass), d);
    if constexpr (D::dimension == 3) {
      const math::Quatd q(state.pose.rotation);
      const Vec3d local = inverse_rotate(q, arm);
      return inverse_mass + dot(local, inverse_inertia * local);
    } else {
      return inverse_mass + arm.z * arm.z * inverse_inertia(2, 2);
    }
  }
};

/// The way through a convex shape from a point on its surface along d (m); none: it has no end.
template <class D>
double way_through(const rigid::World<D>& world, rigid::ShapeId shape, const rigid::BodyState<D>& body, Vec3d point,
                   Vec3d d) {
  const auto geometry = world.shape_geometry(shape);
  const auto definition = world.shape_definition(shape);
  if (!geometry.ok() || !definition.ok()) return BatchHits<D>::through;
  if constexpr (D::dimension == 3) {
    if (!geometry::is_convex(*geometry) || geometry->type == geometry::ShapeType3::plane) return BatchHits<D>::through;
  } else {
    if (geometry->type == geometry::ShapeType2::chain || geometry->type == geometry::ShapeType2::segment ||
        geometry->type == geometry::ShapeType2::chain_segment)
      return BatchHits<D>::through;
  }
  const auto bounds = geometry::bounds(*geometry, typename D::Transform{});
  const double reach = 2.1 * math::length(from_world(bounds.high - bounds.low)) + 1e-3;
  const auto far = to_world<D>(point + reach * d);
  const auto local = [&](typename D::Position p) {
    return inverse_transform_point(definition->local, local_point(body.pose, p));
  };
  const auto from = local(far), to = local(to_world<D>(point));
  const auto hit = geometry::ray_cast(*geometry, from, to - from);
  return hit.hit ? reach * (1 - double(hit.fraction)) : 0;
}

}  // namespace detail

template <class D>
core::Status BatchHits<D>::set_material(std::uint32_t user_id, std::span<const Layer> layers) {
  if (layers.empty()) return core::Error{"BatchHits::set_material: found no layer, expected at least one"};
  if (const core::Status s = check_layers(layers); !s.ok()) return s;
  const auto place = std::lower_bound(walls_.begin(), walls_.end(), user_id,
                                      [](const Wall& wall, std::uint32_t id) { return wall.user_id < id; });
  if (place != walls_.end() && place->user_id == user_id)
    place->layers.assign(layers.begin(), layers.end());
  else
    walls_.insert(place, Wall{user_id, {layers.begin(), layers.end()}});
  return {};
}

template <class D>
core::Status BatchHits<D>::set_default(std::span<const Layer> layers) {
  if (const core::Status s = check_layers(layers); !s.ok()) return s;
  default_.assign(layers.begin(), layers.end());
  return {};
}

/// Casts a piece of the batch at a time, so that what is asked and answered stays in the cache.
template <class D>
core::Status BatchHits<D>::cast_batch(const ProjectileBatch& batch, const rigid::World<D>& world, double dt,
                                      const HitOptions& options) {
  constexpr std::size_t piece = 256;
  const std::size_t count = batch.size();
  std::span<const float> arrays[9];
  for (int k = 0; k < 9; ++k) arrays[k] = batch.array(k);
  const Vec3d origin = batch.origin();
  met_.clear();
  for (std::size_t first = 0; first < count; first += piece) {
    const std::size_t size = math::min(piece, count - first);
    queries_.resize(size);
    found_.resize(size);
    for (std::size_t k = 0; k < size; ++k) {
      const std::size_t i = first + k;
      const Vec3d from{arrays[6][i], arrays[7][i], arrays[8][i]};
      queries_[k].origin = detail::to_world<D>(origin + from);
      queries_[k].translation =
          typename D::Vector(detail::to_world<D>(Vec3d{arrays[0][i], arrays[1][i], arrays[2][i]} - from));
      queries_[k].filter = options.filter;
    }
    if (const core::Status s = world.cast_rays(queries_, {}, found_, steps_); !s.ok()) return s;
    for (std::size_t k = 0; k < size; ++k) {
      if (found_[k].shape == rigid::ShapeId{}) continue;
      const std::size_t i = first + k;
      const Vec3d from = batch.previous_position(i);
      const FlightPoint now = batch.at(i);
      // Within the step the velocity goes from one whose mean with the last is that of the way.
      const Vec3d along = now.position - from;
      const double left = 1 - double(found_[k].fraction);
      const Vec3d then = now.velocity + (2 * left) * (along / dt - now.velocity);
      met_.push_back({{i, 0, from, along, then}, found_[k], double(found_[k].fraction) * dt});
    }
  }
  cast_ += count;
  return {};
}

/// What goes on behind a surface, once more.
template <class D>
core::Status BatchHits<D>::cast_rest(const rigid::World<D>& world, double dt, const HitOptions& options) {
  queries_.resize(ways_.size());
  found_.resize(ways_.size());
  begins_.resize(ways_.size());
  for (std::size_t i = 0; i < ways_.size(); ++i) begins_[i] = float(math::min(ways_[i].time / dt, 1.0));
  for (std::size_t i = 0; i < ways_.size(); ++i)
    queries_[i] = {detail::to_world<D>(ways_[i].from), typename D::Vector(detail::to_world<D>(ways_[i].along)),
                   options.filter};
  cast_ += ways_.size();
  if (const core::Status s = world.cast_rays(queries_, begins_, found_, steps_); !s.ok()) return s;
  met_.clear();
  for (std::size_t i = 0; i < ways_.size(); ++i)
    if (found_[i].shape != rigid::ShapeId{})
      met_.push_back({ways_[i], found_[i], ways_[i].time + double(found_[i].fraction) * (dt - ways_[i].time)});
  return {};
}

template <class D>
void BatchHits<D>::strike(ProjectileBatch& batch, rigid::World<D>& world, double dt, const HitOptions& options,
                          const Met& met, int order) {
  const Way& way = met.way;
  const rigid::RayHit<D>& found = met.found;
  const BatchRound& round = batch.round(way.projectile);
  BatchHit hit;
  hit.projectile = way.projectile;
  hit.tag = round.tag;
  hit.order = order;
  hit.shape = found.shape;
  hit.material = found.material;
  hit.time = met.time;
  hit.point = way.from + double(found.fraction) * way.along;
  hit.velocity = way.velocity;
  hit.normal = detail::from_world(found.normal);
  if (const auto body = world.body_of(found.shape); body.ok()) hit.body = *body;
  // The body as it was when they met; since then it has gone on.
  detail::Struck<D> struck(world, hit.body);
  const typename D::Pose now = struck.state.pose;
  const auto rest = steps_.rest_of_way(hit.body, hit.time / dt);
  struck.state.center_of_mass -= rest;
  if (const auto then = world.pose_in_step(hit.body, hit.time / dt, steps_); then.ok()) struck.state.pose = *then;
  Vec3d relative = way.velocity - struck.velocity_at(hit.point);
  if constexpr (D::dimension == 2) relative.z = 0;
  const double speed = math::length(relative);
  const Vec3d path = speed > 0 ? relative / speed : -hit.normal;
  if (!(math::length_squared(hit.normal) > 0.5)) hit.normal = -path;

  // What is lost is lost in the motion of one against the other: the mass that counts is the reduced one.
  const double inverse = round.mass > 0 ? 1 / round.mass : 0;
  const double reduced = inverse > 0 ? 1 / (inverse + struck.mobility(hit.point, path)) : 0;
  const double angle = math::asin(math::clamp(-math::dot(path, hit.normal), 1e-3, 1.0));
  const auto wall = std::lower_bound(walls_.begin(), walls_.end(), found.material,
                                     [](const Wall& w, std::uint32_t id) { return w.user_id < id; });
  const bool known = wall != walls_.end() && wall->user_id == found.material;
  const std::span<const Layer> layers = known ? wall->layers : default_;
  Penetrator bullet{reduced, round.frontal_area, speed};
  hit.outcome = LayerOutcome::stopped;
  if (reduced > 0 && round.frontal_area > 0 && speed > 0) {
    double whole = -1;  // the way through the shape, once it is asked for
    for (Layer layer : layers) {
      if (layer.thickness >= through) {
        if (whole < 0) whole = detail::way_through<D>(world, found.shape, struck.state, hit.point, path);
        layer.thickness = math::max(whole - hit.depth, 1e-6) * math::sin(angle);
      }
      // Only what meets a surface from outside can skip off.
      if (hit.depth > 0) layer.ricochet_angle = 0;
      const LayerPassage passage = pass_layer(bullet, layer, angle);
      hit.outcome = passage.outcome;
      hit.depth += passage.path;
      bullet.speed = passage.speed_out;
      if (hit.outcome != LayerOutcome::passed) break;
    }
  }
  Vec3d out{};  // against the surface
  if (hit.outcome == LayerOutcome::passed) out = bullet.speed * path;
  if (hit.outcome == LayerOutcome::ricochet) out = bullet.speed * (path - 2 * math::dot(path, hit.normal) * hit.normal);
  const Vec3d change = relative - out;
  const double changed = math::length(change);
  if (changed > 0 && inverse > 0) {
    const Vec3d d = change / changed;
    hit.impulse = (changed / (inverse + struck.mobility(hit.point, d))) * d;
    // The impulse times the mean of the relative speeds before and after, along it.
    hit.energy = math::length(hit.impulse) * (math::dot(relative, d) - 0.5 * changed);
  }
  hit.exit_velocity = way.velocity - inverse * hit.impulse;
  hit.exit = hit.point;
  if (hit.outcome == LayerOutcome::passed) hit.exit += hit.depth * path;
  if (options.push && struck.inverse_mass > 0 && changed > 0) {
    const typename D::Vector impulse(detail::to_world<D>(hit.impulse));
    if (const core::Status s = world.add_impulse_at(hit.body, impulse, detail::to_world<D>(hit.point) + rest); !s.ok())
      hit.impulse = {};
  }
  hits_.push_back(hit);
  if (hit.outcome == LayerOutcome::stopped) {
    const auto place =
        steps_.way_of(hit.body) == nullptr
            ? hit.exit
            : detail::from_world(world_point(now, local_point(struck.state.pose, detail::to_world<D>(hit.exit))));
    batch.place(way.projectile, {place, hit.exit_velocity});
    stopped_.push_back(way.projectile);
    return;
  }
  // On from there, a hair away from the surface.
  const double left = dt - hit.time, gone = math::length(hit.exit_velocity);
  const Vec3d away = gone > 0 ? hit.exit_velocity / gone : -path;
  const Vec3d from = hit.exit + (hit.outcome == LayerOutcome::ricochet ? 1e-3 * hit.normal : 1e-4 * away);
  ways_.push_back({way.projectile, hit.time, from, left * hit.exit_velocity, hit.exit_velocity});
  batch.place(way.projectile, {from + left * hit.exit_velocity, hit.exit_velocity});
}

template <class D>
core::Status BatchHits<D>::collect(ProjectileBatch& batch, rigid::World<D>& world, double dt,
                                   const HitOptions& options) {
  hits_.clear();
  stopped_.clear();
  cast_ = 0;
  if (!(dt > 0) || !math::is_finite(dt))
    return core::Error{core::text("BatchHits::collect: ", core::refused("dt", dt, "a finite number of seconds > 0"))};
  double sum = 0;  // m/s, of some of them
  int some = 0;
  for (std::size_t i = 0; i < batch.size(); i += 1 + batch.size() / 64, ++some)
    sum += math::length(batch.at(i).velocity);
  world.find_ways(steps_, some > 0 ? dt * sum / some : 0);
  if (!(math::abs(dt - double(steps_.dt)) < 1e-4 * dt)) steps_.clear();
  if (const core::Status s = cast_batch(batch, world, dt, options); !s.ok()) return s;
  for (int order = 0; order < options.most_hits && !met_.empty(); ++order) {
    std::sort(met_.begin(), met_.end(), [](const Met& a, const Met& b) {
      return a.time != b.time ? a.time < b.time : a.way.projectile < b.way.projectile;
    });
    ways_.clear();
    for (const Met& met : met_) strike(batch, world, dt, options, met, order);
    if (const core::Status s = cast_rest(world, dt, options); !s.ok()) return s;
  }
  std::sort(hits_.begin(), hits_.end(), [](const BatchHit& a, const BatchHit& b) {
    if (a.time != b.time) return a.time < b.time;
    return a.projectile != b.projectile ? a.projectile < b.projectile : a.order < b.order;
  });
  if (!options.keep_stopped) {
    std::sort(stopped_.begin(), stopped_.end(), std::greater<>());
    for (const std::size_t i : stopped_) batch.remove(i);
  }
  return {};
}

template class BatchHits<rigid::Dim2>;
template class BatchHits<rigid::Dim3>;

}  // namespace carom::ballistics
