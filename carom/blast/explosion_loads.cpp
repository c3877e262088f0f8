#include <algorithm>

#include "carom/blast/detail/patches.h"
#include "carom/blast/explosion.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::blast {

namespace {

float widest(const geometry::Bounds2f& b) { return 2 * math::max(b.extents().x, b.extents().y); }
float widest(const geometry::Bounds3f& b) {
  return 2 * math::max(b.extents().x, math::max(b.extents().y, b.extents().z));
}
/// The shorter of the height and half the width of what a box shows: clearing is a matter of a factor, not of percents.
double clearing_length_of(const geometry::Bounds2f& b) { return double(2 * b.extents().y); }
double clearing_length_of(const geometry::Bounds3f& b) {
  const math::Vec3f e = b.extents();
  const float middle = e.x + e.y + e.z - math::max(e.x, math::max(e.y, e.z)) - math::min(e.x, math::min(e.y, e.z));
  return double(middle);
}

/// Of waves that come one after another: the most that they add up to as the front of one arrives.
template <class D>
double greatest_pressure(const WavesAt<D>& waves) {
  double most = 0;
  for (int k = 0; k < waves.count; ++k) {
    double sum = 0;
    for (int j = 0; j < waves.count; ++j) {
      const Wave& w = waves.wave[j];
      sum += friedlander(w.pressure, w.duration, w.decay, waves.wave[k].arrival - w.arrival);
    }
    most = math::max(most, sum);
  }
  return most;
}

/// A patch where it is in the world.
template <class D>
struct Place {
  typename D::Position center, normal;
  double area = 0, distance = 0;
  std::int32_t cover = -1;  // ray
};
/// A shape that the wave is passing.
template <class D>
struct Seen {
  rigid::ShapeId shape;
  rigid::BodyId body;
  typename D::Position center_of_mass;
  double clearing = 0;
  bool dynamic = false, alone = false;  // alone: its body has no other shape
  std::size_t first = 0, count = 0;     // places
};
/// Shapes are taken together until they have so many places.
constexpr std::size_t places_at_once = 2048;

}  // namespace

template <class D>
struct Explosion<D>::Pass {
  double from = 0, to = 0;  // s after the detonation
  std::vector<Seen<D>> seen;
  std::vector<Place<D>> places;
  std::vector<rigid::RayQuery<D>> rays;
  std::vector<rigid::RayHit<D>> hits;
  std::vector<detail::SurfacePatch<D>> patches;
  std::vector<rigid::ShapeId> siblings;

  void clear() {
    seen.clear();
    places.clear();
    rays.clear();
  }
};

template <class D>
core::Status Explosion<D>::apply(World& world, double dt) {
  events_.clear();
  loads_.clear();
  if (!(dt > 0) || !math::is_finite(dt)) return core::Error{core::refused("Explosion::apply: dt", dt, "s > 0")};
  Pass pass;
  pass.from = world.time() - charge_.time;
  pass.to = pass.from + dt;
  if (pass.to <= 0 || pass.from > last_) return {};
  const double front = front_radius(world.time() + dt);
  Position half{};
  for (int k = 0; k < D::dimension; ++k) half[k] = front;
  std::vector<rigid::ShapeId> shapes;
  if (auto s = world.overlap_bounds({charge_.position - half, charge_.position + half}, shapes,
                                    {.mask = charge_.mask, .ignore = charge_.casing});
      !s)
    return s;
  for (const rigid::ShapeId id : shapes) {
    see(world, id, front, pass);
    if (pass.places.size() < places_at_once) continue;
    if (auto s = load(world, pass); !s) return s;
    pass.clear();
  }
  return load(world, pass);
}

template <class D>
void Explosion<D>::see(const World& world, rigid::ShapeId id, double front, Pass& pass) const {
  const auto geometry = world.shape_geometry(id);
  const auto body = world.body_of(id);
  if (!geometry.ok() || !body.ok() || !detail::has_patches(*geometry)) return;
  const auto definition = world.shape_definition(id);
  const auto state = world.state(*body);
  if (!definition.ok() || !state.ok() || definition->sensor || !state->enabled) return;
  const bool dynamic = state->type == rigid::BodyType::dynamic;
  if (!dynamic && !definition->hit_events) return;
  const auto pose = state->pose * definition->local;
  const auto box = geometry::bounds(*geometry, {});
  const double size = 0.5 * double(math::length(box.high - box.low));
  const double middle = distance(world_point(pose, box.center()), charge_.position);
  if (middle - size > math::max(0.0, front)) return;
  // The wave has passed it all.
  const Wave far = wave_at(middle + size + (ground_.empty() ? 0 : 2 * height()));
  if (pass.from > far.arrival + 2.5 * far.duration) return;
  world.shapes(*body, pass.siblings);
  const bool alone = pass.siblings.size() == 1;
  Seen<D> s{id,      *body, state->center_of_mass, charge_.clearing ? clearing_length_of(box) : 0,
            dynamic, alone, pass.places.size()};
  pass.patches.clear();
  detail::add_patches(*geometry, {local_point(pose, charge_.position), math::max(0.02f, widest(box) / 24)},
                      pass.patches);
  for (const auto& patch : pass.patches) {
    Place<D> p;
    p.center = world_point(pose, patch.center);
    p.normal = Position(rotate(pose.rotation, patch.normal));
    p.area = double(patch.area);
    p.distance = distance(p.center, charge_.position);
    if (p.distance > reach_) continue;
    if (!alone) {
      // Parts of one body cover each other: what lies against another one feels nothing.
      constexpr double outside = 2e-4, look = 5e-3;
      p.cover = std::int32_t(pass.rays.size());
      pass.rays.push_back({p.center + outside * p.normal, Vector(look * p.normal), {}});
    }
    pass.places.push_back(p);
  }
  s.count = pass.places.size() - s.first;
  if (s.count > 0) pass.seen.push_back(s);
}

template <class D>
core::Status Explosion<D>::load(World& world, Pass& pass) {
  pass.hits.assign(pass.rays.size(), {});
  if (auto s = world.cast_rays(pass.rays, pass.hits); !s) return s;
  pass.rays.clear();
  const Position eye = this->eye();
  for (const Seen<D>& s : pass.seen)
    for (Place<D>& p : std::span(pass.places).subspan(s.first, s.count)) {
      pass.rays.push_back({eye, Vector(p.center - eye), {.mask = charge_.obstacles, .ignore = s.body}});
      if (p.cover < 0 || pass.hits[std::size_t(p.cover)].shape.is_null()) continue;
      const rigid::ShapeId above = pass.hits[std::size_t(p.cover)].shape;
      const auto owner = world.body_of(above);
      if (!(above == s.shape) && owner.ok() && *owner == s.body) p.area = 0;
    }
  pass.hits.assign(pass.rays.size(), {});
  if (auto s = world.cast_rays(pass.rays, pass.hits); !s) return s;
  for (const Seen<D>& s : pass.seen) {
    Position sum{}, moment_point{};
    double weight = 0, nearest = 1e300, acted = 0;
    decltype(cross(Position{}, Position{})) torque{};
    FrontEvent<D> event;
    for (std::size_t i = s.first; i < s.first + s.count; ++i) {
      const Place<D>& p = pass.places[i];
      if (p.area == 0) continue;
      const auto& hit = pass.hits[i];
      bool sheltered = !hit.shape.is_null() && hit.fraction < 0.999f;
      if (sheltered && !charge_.casing.is_null()) {
        const auto owner = world.body_of(hit.shape);
        sheltered = !(owner.ok() && *owner == charge_.casing);
      }
      const double share = sheltered ? charge_.shelter : 1;
      const WavesAt<D> waves = waves_at(p.center);
      if (waves.count > 0 && p.distance < nearest) {
        nearest = p.distance;
        event = {s.body, waves.wave[0].arrival, p.distance, share * greatest_pressure(waves), sheltered, {}};
      }
      double impulse = 0;
      for (int k = 0; k < waves.count; ++k) {
        const SurfaceLoad load(waves.wave[k], dot(p.normal, waves.toward[k]), s.clearing, share);
        impulse += p.area * (load.impulse(pass.to) - load.impulse(pass.from));
        acted = math::max(acted, math::min(pass.to, load.end()) - math::max(pass.from, load.arrival()));
      }
      if (impulse == 0) continue;
      const Position push = -impulse * p.normal;
      sum += push;
      torque = torque + cross(p.center - s.center_of_mass, push);
      moment_point += math::abs(impulse) * p.center;
      weight += math::abs(impulse);
    }
    if (event.time > pass.from && event.time <= pass.to) {
      event.damage = damage_of(event.pressure);
      const auto known =
          s.alone ? events_.end()
                  : std::find_if(events_.begin(), events_.end(), [&](const auto& e) { return e.body == s.body; });
      if (known == events_.end())
        events_.push_back(event);
      else if (event.distance < known->distance)
        *known = event;
    }
    if (!(weight > 0)) continue;
    loads_.push_back({s.shape, s.body, Vector(sum), moment_point / weight, math::max(acted, 1e-6)});
    if (!s.dynamic) continue;
    if (auto status = world.add_impulse(s.body, Vector(sum)); !status) return status;
    if (auto status = world.add_angular_impulse(s.body, typename D::Angular(torque)); !status) return status;
    given_ += sum;
  }
  return {};
}

template core::Status Explosion<rigid::Dim2>::apply(World&, double);
template core::Status Explosion<rigid::Dim3>::apply(World&, double);
template void Explosion<rigid::Dim2>::see(const World&, rigid::ShapeId, double, Pass&) const;
template void Explosion<rigid::Dim3>::see(const World&, rigid::ShapeId, double, Pass&) const;
template core::Status Explosion<rigid::Dim2>::load(World&, Pass&);
template core::Status Explosion<rigid::Dim3>::load(World&, Pass&);

}  // namespace carom::blast
