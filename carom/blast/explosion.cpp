#include "carom/blast/explosion.h"

#include <algorithm>

#include "carom/blast/detail/patches.h"
#include "carom/core/string.h"
#include "carom/math/elementary.h"

namespace carom::blast {

using math::Vec2d;
using math::Vec3d;
using rigid::Dim2;
using rigid::Dim3;

namespace {

double scale_of(double mass, Burst burst) { return math::cbrt(burst == Burst::ground ? mass : mass / 1.8); }

Vec2d up(Dim2*) { return {0, 1}; }
Vec3d up(Dim3*) { return {0, 1, 0}; }
/// A fireball on the ground sees over its roughness.
constexpr double above_ground = 0.05;

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

}  // namespace

template <class D>
core::Result<Explosion<D>> Explosion<D>::make(const Charge<D>& c) {
  if (!(c.mass > 0 && c.mass <= 1e9))
    return core::Error{core::refused("Charge: mass", c.mass, "more than 0, up to 1e9 kg")};
  if (!is_finite(c.position)) return core::Error{"Charge: position is not finite"};
  if (!math::is_finite(c.time)) return core::Error{"Charge: time is not finite"};
  if (!(c.reach >= 0) || !math::is_finite(c.reach))
    return core::Error{core::refused("Charge: reach", c.reach, "metres >= 0")};
  if (!(c.shelter >= 0 && c.shelter <= 1)) return core::Error{core::refused("Charge: shelter", c.shelter, "0 to 1")};
  Explosion e;
  e.charge_ = c;
  const double most = greatest_scaled_distance * scale_of(c.mass, c.burst);
  e.reach_ = c.reach > 0 ? math::min(c.reach, most) : most;
  const Wave last = e.wave_at(e.reach_);
  e.last_ = last.arrival + 2 * last.duration;
  return e;
}

template <class D>
Wave Explosion<D>::wave_at(double distance) const {
  const double scale = scale_of(charge_.mass, charge_.burst);
  const double z =
      math::clamp(distance / scale, least_scaled_distance * (1 + 1e-12), greatest_scaled_distance * (1 - 1e-12));
  const auto wave = blast_wave(charge_.mass, z * scale, charge_.burst);
  return wave.ok() ? *wave : Wave{};
}

template <class D>
double Explosion<D>::front_radius(double world_time) const {
  const double t = world_time - charge_.time;
  if (!(t > 0)) return 0;
  const double scale = scale_of(charge_.mass, charge_.burst);
  double low = least_scaled_distance * scale, high = reach_;
  const double first = wave_at(low).arrival;
  if (t <= first) return low * t / first;
  if (t >= wave_at(high).arrival) return high;
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (low + high);
    (wave_at(middle).arrival < t ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

template <class D>
double Explosion<D>::pressure_at(Position place, double world_time, const World* world) const {
  const double r = distance(place, charge_.position);
  if (r > reach_) return 0;
  const Wave w = wave_at(r);
  const double p = friedlander(w.pressure, w.duration, w.decay, world_time - charge_.time - w.arrival);
  if (p == 0 || world == nullptr) return p;
  const Position from =
      charge_.position + (charge_.burst == Burst::ground ? above_ground : 0) * up(static_cast<D*>(nullptr));
  const auto hit = world->ray_cast(from, Vector(place - from), {.mask = charge_.obstacles, .ignore = charge_.casing});
  const bool sheltered = hit.ok() && !hit->shape.is_null() && hit->fraction < 0.999f;
  return sheltered ? charge_.shelter * p : p;
}

template <class D>
void Explosion<D>::push_particles(std::span<const Vector> positions, std::span<Vector> velocities, Position origin,
                                  double area_per_mass, double world_time, double dt) const {
  const double from = world_time - charge_.time, to = from + dt;
  const double farthest = front_radius(world_time + dt);
  for (std::size_t i = 0; i < positions.size() && i < velocities.size(); ++i) {
    const Position way = origin + Position(positions[i]) - charge_.position;
    const double r = length(way);
    if (!(r > 1e-6) || r > farthest) continue;
    const Wave w = wave_at(r);
    if (to <= w.arrival || from >= w.arrival + w.duration) continue;
    // Only the drag: q alone, as of a face that never reflects.
    const double before = math::max(from - w.arrival, 0.0) / w.duration,
                 after = math::min((to - w.arrival) / w.duration, 1.0);
    // ∫ (1 − s)² e^{−2bs} ds by Simpson's rule in eight parts: particles need no more.
    double sum = 0;
    for (int k = 0; k <= 8; ++k) {
      const double s = before + (after - before) * k / 8;
      sum += (k == 0 || k == 8 ? 1 : (k % 2 == 1 ? 4 : 2)) * math::square(1 - s) * math::exp(-2 * w.decay * s);
    }
    const double q = dynamic_pressure(w.pressure) * w.duration * (after - before) / 24 * sum;
    const Position out = way / r;
    const double along = dot(Position(velocities[i]), out), wind = wind_speed(w.pressure);
    const double gain = math::min(area_per_mass * q, math::max(wind - along, 0.0));
    velocities[i] += Vector(gain * out);
  }
}

template <class D>
core::Status Explosion<D>::apply(World& world, double dt) {
  events_.clear();
  loads_.clear();
  if (!(dt > 0) || !math::is_finite(dt)) return core::Error{core::refused("Explosion::apply: dt", dt, "s > 0")};
  const double from = world.time() - charge_.time, to = from + dt;
  if (to <= 0 || from > last_) return {};
  const double front = front_radius(world.time() + dt);
  Position half{};
  for (int k = 0; k < D::dimension; ++k) half[k] = front;
  std::vector<rigid::ShapeId> shapes;
  if (auto s = world.overlap_bounds({charge_.position - half, charge_.position + half}, shapes,
                                    {.mask = charge_.mask, .ignore = charge_.casing});
      !s)
    return s;
  struct Seen {
    rigid::ShapeId shape;
    rigid::BodyId body;
    Position center_of_mass;
    double clearing = 0;
    std::size_t first = 0, count = 0;  // patches
    bool dynamic = false;
  };
  struct Place {
    Position center, normal;
    double area = 0, distance = 0, cosine = 0;
    std::int32_t cover = -1;  // ray
  };
  std::vector<Seen> seen;
  std::vector<Place> places;
  std::vector<rigid::RayQuery<D>> rays;
  std::vector<detail::SurfacePatch<D>> patches;
  std::vector<rigid::ShapeId> siblings;
  const Position eye =
      charge_.position + (charge_.burst == Burst::ground ? above_ground : 0) * up(static_cast<D*>(nullptr));
  const double band = math::max(0.0, front);
  for (const rigid::ShapeId id : shapes) {
    const auto geometry = world.shape_geometry(id);
    const auto body = world.body_of(id);
    if (!geometry.ok() || !body.ok() || !detail::has_patches(*geometry)) continue;
    const auto definition = world.shape_definition(id);
    const auto state = world.state(*body);
    if (!definition.ok() || !state.ok() || definition->sensor || !state->enabled) continue;
    if (state->type != rigid::BodyType::dynamic && !definition->hit_events) continue;
    const auto pose = state->pose * definition->local;
    const auto box = geometry::bounds(*geometry, {});
    const double size = 0.5 * double(math::length(box.high - box.low));
    const double middle = distance(world_point(pose, box.center()), charge_.position);
    if (middle - size > band) continue;
    // The wave has passed it all.
    const Wave far = wave_at(middle + size);
    if (from > far.arrival + 2.5 * far.duration) continue;
    Seen s{id,
           *body,
           state->center_of_mass,
           charge_.clearing ? clearing_length_of(box) : 0,
           places.size(),
           0,
           state->type == rigid::BodyType::dynamic};
    patches.clear();
    const float fine = math::max(0.02f, math::max(float(0.15 * math::max(middle - size, 0.0)), widest(box) / 24));
    detail::add_patches(*geometry, fine, patches);
    for (const auto& patch : patches) {
      Place p;
      p.center = world_point(pose, patch.center);
      p.normal = Position(rotate(pose.rotation, patch.normal));
      p.area = double(patch.area);
      const Position way = charge_.position - p.center;
      p.distance = length(way);
      p.cosine = p.distance > 0 ? dot(p.normal, way) / p.distance : 1;
      if (p.distance > reach_) continue;
      places.push_back(p);
    }
    s.count = places.size() - s.first;
    if (s.count == 0) continue;
    // Parts of one body cover each other: what lies against another one feels nothing.
    world.shapes(*body, siblings);
    for (std::size_t i = s.first; i < places.size() && siblings.size() > 1; ++i) {
      constexpr double outside = 2e-4, look = 5e-3;
      places[i].cover = std::int32_t(rays.size());
      rays.push_back({places[i].center + outside * places[i].normal, Vector(look * places[i].normal), {}});
    }
    seen.push_back(s);
  }
  std::vector<rigid::RayHit<D>> hits(rays.size());
  if (auto s = world.cast_rays(rays, hits); !s) return s;
  for (const Seen& s : seen)
    for (std::size_t i = s.first; i < s.first + s.count; ++i) {
      if (places[i].cover < 0 || hits[std::size_t(places[i].cover)].shape.is_null()) continue;
      const rigid::ShapeId above = hits[std::size_t(places[i].cover)].shape;
      const auto owner = world.body_of(above);
      if (!(above == s.shape) && owner.ok() && *owner == s.body) places[i].area = 0;
    }
  rays.clear();
  for (const Seen& s : seen)
    for (std::size_t i = s.first; i < s.first + s.count; ++i)
      rays.push_back({eye, Vector(places[i].center - eye), {.mask = charge_.obstacles, .ignore = s.body}});
  hits.assign(rays.size(), {});
  if (auto s = world.cast_rays(rays, hits); !s) return s;
  for (const Seen& s : seen) {
    Position sum{}, moment_point{};
    double weight = 0, nearest = 1e300, acted = 0;
    decltype(cross(Position{}, Position{})) torque{};
    FrontEvent<D> event;
    for (std::size_t i = s.first; i < s.first + s.count; ++i) {
      const Place& p = places[i];
      if (p.area == 0) continue;
      const auto& hit = hits[i];
      bool sheltered = !hit.shape.is_null() && hit.fraction < 0.999f;
      if (sheltered && !charge_.casing.is_null()) {
        const auto owner = world.body_of(hit.shape);
        sheltered = !(owner.ok() && *owner == charge_.casing);
      }
      const Wave wave = wave_at(p.distance);
      const SurfaceLoad load(wave, p.cosine, s.clearing, sheltered ? charge_.shelter : 1);
      if (p.distance < nearest) {
        nearest = p.distance;
        event = {s.body, wave.arrival, p.distance, wave.pressure * (sheltered ? charge_.shelter : 1), sheltered, {}};
      }
      const double impulse = p.area * (load.impulse(to) - load.impulse(from));
      if (impulse == 0) continue;
      const Position push = -impulse * p.normal;
      sum += push;
      torque = torque + cross(p.center - s.center_of_mass, push);
      moment_point += math::abs(impulse) * p.center;
      weight += math::abs(impulse);
      acted = math::max(acted, math::min(to, load.end()) - math::max(from, load.arrival()));
    }
    if (event.time > from && event.time <= to) {
      event.damage = damage_of(event.pressure);
      const auto known = std::find_if(events_.begin(), events_.end(), [&](const auto& e) { return e.body == s.body; });
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

template class Explosion<Dim2>;
template class Explosion<Dim3>;

}  // namespace carom::blast
