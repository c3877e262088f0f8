#include "carom/blast/explosion.h"

#include "carom/blast/detail/wave_table.h"
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
  e.scale_ = scale_of(c.mass, c.burst);
  const double most = greatest_scaled_distance * e.scale_;
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
  const double z =
      math::clamp(distance / scale_, least_scaled_distance * (1 + 1e-12), greatest_scaled_distance * (1 - 1e-12));
  return detail::WaveTable::of(charge_.burst).at(z, scale_);
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
  double low = least_scaled_distance * scale_, high = reach_;
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

template class Explosion<Dim2>;
template class Explosion<Dim3>;

}  // namespace carom::blast
