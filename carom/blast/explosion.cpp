#include "carom/blast/explosion.h"

#include <algorithm>

#include "carom/blast/detail/patches.h"
#include "carom/blast/reflection.h"
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
constexpr int ground_parts = 128;
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
  if (c.burst == Burst::air) {
    if (!math::is_finite(c.ground))
      return core::Error{core::refused("Charge: ground", c.ground, "a finite height in m")};
    const double height = e.height();
    if (!(height > 0)) return core::Error{core::refused("Charge: ground", c.ground, "below a burst in the air")};
    e.tangent_scale_ = ground_parts / math::log1p(e.reach_ / height);
    double before = 0;
    for (int i = 0; i <= ground_parts; ++i) {
      const double along = height * math::expm1(i / e.tangent_scale_), slant = math::hypot(height, along),
                   incident = e.wave_at(slant).pressure;
      const auto found = reflect(incident, math::atan2(along, height));
      if (!found) return found.error();
      Ground here{found->factor, 0};
      if (found->mach && i > 0) {
        // A stem that has swallowed the wave is that of a charge on the ground.
        const double scale = math::cbrt(c.mass);
        const auto on_ground = blast_wave(c.mass, scale * math::clamp(slant / scale, least_scaled_distance * 1.001,
                                                                      greatest_scaled_distance * 0.999));
        if (on_ground.ok()) here.factor = math::max(here.factor, on_ground->pressure / incident);
        here.stem = e.ground_.back().stem + (along - before) * math::tan(found->stem_angle);
      }
      before = along;
      e.ground_.push_back(here);
    }
  }
  const Wave last = e.wave_at(e.reach_ + (c.burst == Burst::air ? 2 * e.height() : 0));
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
double Explosion<D>::height() const {
  return charge_.position.y - charge_.ground;
}
template <class D>
typename Explosion<D>::Ground Explosion<D>::ground_at(double tangent) const {
  if (ground_.empty()) return {};
  const double at = math::clamp(tangent_scale_ * math::log1p(tangent), 0.0, double(ground_parts));
  const std::size_t i = std::size_t(math::min(int(at), ground_parts - 1));
  const double t = at - double(i);
  const Ground &a = ground_[i], &b = ground_[i + 1];
  return {a.factor + t * (b.factor - a.factor), a.stem + t * (b.stem - a.stem)};
}
template <class D>
double Explosion<D>::stem_height(double ground_distance) const {
  return ground_.empty() ? 0 : ground_at(ground_distance / height()).stem;
}

template <class D>
WavesAt<D> Explosion<D>::waves_at(Position place) const {
  WavesAt<D> out;
  const Position way = charge_.position - place;
  const double r = length(way);
  if (r > reach_) return out;
  const Position upward = up(static_cast<D*>(nullptr));
  const auto add = [&](double far, double strength, Position toward) {
    out.wave[out.count] = strength == 1 ? wave_at(far) : strengthened(wave_at(far), strength);
    out.toward[out.count++] = toward;
  };
  const Position toward = r > 0 ? way / r : upward;
  const double above = place.y - charge_.ground;
  if (ground_.empty() || above < -0.01 * height()) {
    add(r, 1, toward);
    return out;
  }
  const Position level = way - way.y * upward;
  const double along = length(level);
  const Ground under = ground_at(along / height());
  if (above <= under.stem && along > 0) {
    add(math::hypot(height(), along), under.factor, level / along);
    return out;
  }
  add(r, 1, toward);
  // From the charge's image in the ground, as strong as where it was reflected.
  const Position image = level - (height() + above) * upward;
  const double strength = ground_at(along / (height() + math::max(above, 0.0))).factor - 1;
  if (strength > 1e-3) add(length(image), strength, image / length(image));
  return out;
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
  const WavesAt<D> waves = waves_at(place);
  double p = 0;
  for (int k = 0; k < waves.count; ++k) {
    const Wave& w = waves.wave[k];
    p += friedlander(w.pressure, w.duration, w.decay, world_time - charge_.time - w.arrival);
  }
  if (p == 0 || world == nullptr) return p;
  const auto hit = world->ray_cast(eye(), Vector(place - eye()), {.mask = charge_.obstacles, .ignore = charge_.casing});
  const bool sheltered = hit.ok() && !hit->shape.is_null() && hit->fraction < 0.999f;
  return sheltered ? charge_.shelter * p : p;
}

template <class D>
typename D::Position Explosion<D>::eye() const {
  return charge_.position + (charge_.burst == Burst::ground ? above_ground : 0) * up(static_cast<D*>(nullptr));
}

template <class D>
core::Status Explosion<D>::shares_at(const World& world, std::span<const Position> places,
                                     std::vector<double>& shares) const {
  const Position from = eye();
  std::vector<rigid::RayQuery<D>> rays;
  for (const Position& place : places)
    rays.push_back({from, Vector(place - from), {.mask = charge_.obstacles, .ignore = charge_.casing}});
  std::vector<rigid::RayHit<D>> hits(rays.size());
  if (auto s = world.cast_rays(rays, hits); !s) return s;
  shares.clear();
  for (const auto& hit : hits) shares.push_back(!hit.shape.is_null() && hit.fraction < 0.999f ? charge_.shelter : 1);
  return {};
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
    const WavesAt<D> waves = waves_at(origin + Position(positions[i]));
    for (int k = 0; k < waves.count; ++k) {
      const Wave& w = waves.wave[k];
      if (to <= w.arrival || from >= w.arrival + w.duration) continue;
      // Only the drag: q alone, as of a face that never reflects.
      const double q = wind_impulse(w, to) - wind_impulse(w, from);
      const Position out = -waves.toward[k];
      const double along = dot(Position(velocities[i]), out), wind = wind_speed(w.pressure);
      const double gain = math::min(area_per_mass * q, math::max(wind - along, 0.0));
      velocities[i] += Vector(gain * out);
    }
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
    double area = 0, distance = 0;
    std::int32_t cover = -1;  // ray
  };
  std::vector<Seen> seen;
  std::vector<Place> places;
  std::vector<rigid::RayQuery<D>> rays;
  std::vector<detail::SurfacePatch<D>> patches;
  std::vector<rigid::ShapeId> siblings;
  const Position eye = this->eye();
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
    const Wave far = wave_at(middle + size + (ground_.empty() ? 0 : 2 * height()));
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
      p.distance = distance(p.center, charge_.position);
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
      const double share = sheltered ? charge_.shelter : 1;
      const WavesAt<D> waves = waves_at(p.center);
      if (waves.count > 0 && p.distance < nearest) {
        nearest = p.distance;
        event = {s.body, waves.wave[0].arrival, p.distance, share * greatest_pressure(waves), sheltered, {}};
      }
      double impulse = 0;
      for (int k = 0; k < waves.count; ++k) {
        const SurfaceLoad load(waves.wave[k], dot(p.normal, waves.toward[k]), s.clearing, share);
        impulse += p.area * (load.impulse(to) - load.impulse(from));
        acted = math::max(acted, math::min(to, load.end()) - math::max(from, load.arrival()));
      }
      if (impulse == 0) continue;
      const Position push = -impulse * p.normal;
      sum += push;
      torque = torque + cross(p.center - s.center_of_mass, push);
      moment_point += math::abs(impulse) * p.center;
      weight += math::abs(impulse);
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
