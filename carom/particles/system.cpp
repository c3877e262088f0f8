#include "carom/particles/system.h"

#include <string>

#include "carom/core/hash.h"
#include "carom/math/cpu.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"

namespace carom::particles {
using math::Vec3d;
using math::Vec3f;

namespace {

constexpr int max_capacity = 1 << 24;

std::size_t padded(int count) {
  return (std::size_t(count) + detail::block_size - 1) / detail::block_size * detail::block_size;
}

}  // namespace

core::Status check(const Drag& d) {
  if (!(d.coefficient >= 0 && math::is_finite(d.coefficient)))
    return detail::bad("drag", "coefficient", d.coefficient, "a finite number of at least 0");
  if (!(d.density >= 0 && math::is_finite(d.density)))
    return detail::bad("drag", "density", d.density, "a finite number of at least 0 kg/m³");
  if (!(d.viscosity > 0 && math::is_finite(d.viscosity)))
    return detail::bad("drag", "viscosity", d.viscosity, "a finite number above 0 Pa·s");
  return {};
}

core::Status ParticleSystem::check(const SystemDef& d) {
  const char* what = "particle system";
  if (d.capacity < 1 || d.capacity > max_capacity) return detail::bad(what, "capacity", d.capacity, "1 to 2^24");
  if (!detail::finite_vector(d.anchor)) return core::Error{"particle system: anchor is not finite"};
  if (!detail::finite_vector(d.gravity)) return core::Error{"particle system: gravity is not finite"};
  if (d.planar && (d.gravity.z != 0 || d.anchor.z != 0))
    return core::Error{"particle system: gravity and anchor of a planar system must have z = 0"};
  if (!math::is_finite(d.gravity_scale)) return detail::bad(what, "gravity_scale", d.gravity_scale, "a finite number");
  if (!(d.radius > 0 && d.radius <= 1e3f)) return detail::bad(what, "radius", d.radius, "above 0 to 1000 m");
  if (!(d.mass > 0 && d.mass <= 1e9f)) return detail::bad(what, "mass", d.mass, "above 0 to 10^9 kg");
  if (!(d.slowest_hit >= 0)) return detail::bad(what, "slowest_hit", d.slowest_hit, "at least 0 m/s");
  if (!(d.limit > 0 && d.limit <= 1e9f)) return detail::bad(what, "limit", d.limit, "above 0 to 10^9");
  if (d.lanes != 0 && d.lanes != 4 && d.lanes != 8 && d.lanes != 16)
    return detail::bad(what, "lanes", d.lanes, "0, 4, 8 or 16");
  for (const float value : d.drag_over_age.values())
    if (value < 0) return detail::bad(what, "drag_over_age", value, "at least 0 at every age");
  if (const core::Status status = particles::check(d.drag); !status) return status;
  return particles::check(d.contacts);
}

core::Result<ParticleSystem> ParticleSystem::create(const SystemDef& definition) {
  if (const core::Status status = check(definition); !status) return status.error();
  return ParticleSystem(definition);
}

ParticleSystem::ParticleSystem(const SystemDef& definition) : definition_(definition) {
  const math::InstructionSet set = definition.lanes == 0
                                       ? math::detect_instruction_set()
                                       : math::choose_instruction_set(math::instruction_set_of_width(definition.lanes));
  lanes_ = math::simd_width(set);
  const std::size_t room = padded(definition.capacity);
  for (detail::AlignedFloats& array : arrays_) array = detail::AlignedFloats(room);
  for (std::size_t i = 0; i < room; ++i) arrays_[8][i] = 1;
  ids_.resize(room);
  dead_.resize(room);
  if (definition.report_deaths) deaths_.reserve(std::size_t(definition.capacity));
  if (definition.contacts.enabled) {
    for (detail::AlignedFloats& array : spin_) array = detail::AlignedFloats(room);
    solver_.reserve(std::size_t(definition.capacity));
    gained_.resize(std::size_t(definition.capacity));
  }
  prepare_chunks();
}

void ParticleSystem::clear() {
  count_ = 0;
  deaths_.clear();
  hits_.clear();
}

bool ParticleSystem::push(Vec3d position, Vec3d velocity, float birth, float lifetime, float scale) {
  if (count_ >= definition_.capacity) return false;
  const std::size_t i = std::size_t(count_++);
  const Vec3d p = position - definition_.anchor;
  for (int k = 0; k < 3; ++k) {
    arrays_[k][i] = float(p[k]);
    arrays_[3 + k][i] = float(velocity[k]);
  }
  if (definition_.planar) arrays_[2][i] = arrays_[5][i] = 0;
  arrays_[6][i] = birth;
  arrays_[7][i] = birth + lifetime;
  arrays_[8][i] = scale;
  arrays_[9][i] = 0;
  if (definition_.contacts.enabled)
    for (detail::AlignedFloats& array : spin_) array[i] = 0;
  scaled_ = scaled_ || scale != 1;
  ids_[i] = next_id_++;
  return true;
}

core::Result<bool> ParticleSystem::add(const NewParticle& p) {
  if (!detail::finite_vector(p.position)) return core::Error{"new particle: position is not finite"};
  if (!detail::finite_vector(p.velocity)) return core::Error{"new particle: velocity is not finite"};
  if (!(p.lifetime > 0)) return detail::bad("new particle", "lifetime", p.lifetime, "above 0 s");
  if (!(p.scale >= 1e-3f && p.scale <= 1e3f)) return detail::bad("new particle", "scale", p.scale, "0.001 to 1000");
  return push(p.position, p.velocity, float(time_ - epoch_), p.lifetime, p.scale);
}

core::Result<int> ParticleSystem::burst(const BurstDef& definition, Range lifetime) {
  if (!detail::finite_vector(definition.center) || !detail::finite_vector(definition.velocity))
    return core::Error{"burst: center or velocity is not finite"};
  if (!(lifetime.low > 0 && lifetime.high >= lifetime.low))
    return detail::bad("burst", "lifetime", lifetime.low, "two numbers, rising, above 0 s");
  BurstDef d = definition;
  d.planar = d.planar || definition_.planar;
  const core::Result<std::vector<Vec3d>> velocities = burst_velocities(d);
  if (!velocities) return velocities.error();
  const int room = definition_.capacity - count_;
  const int fits = room >= d.count ? d.count : room / 2 * 2;
  math::Random random(d.seed, 1);
  // The last pairs first, so that what is left out is whole pairs and the odd triple.
  for (int i = 0; i < fits; ++i) {
    const double life = lifetime.low == lifetime.high ? double(lifetime.low)
                                                      : random.uniform(double(lifetime.low), double(lifetime.high));
    push(d.center, d.velocity + (*velocities)[velocities->size() - 1 - std::size_t(i)], float(time_ - epoch_),
         float(life), 1);
  }
  return fits;
}

core::Status ParticleSystem::set_gravity(Vec3d gravity) {
  if (!detail::finite_vector(gravity)) return core::Error{"particle system: gravity is not finite"};
  if (definition_.planar && gravity.z != 0) return core::Error{"particle system: gravity of a planar system has z = 0"};
  definition_.gravity = gravity;
  return {};
}

Vec3d ParticleSystem::position(int i) const {
  const std::size_t k = std::size_t(i);
  return definition_.anchor + Vec3d{arrays_[0][k], arrays_[1][k], arrays_[2][k]};
}
Vec3d ParticleSystem::velocity(int i) const {
  const std::size_t k = std::size_t(i);
  return {arrays_[3][k], arrays_[4][k], arrays_[5][k]};
}
Vec3d ParticleSystem::spin(int i) const {
  if (!definition_.contacts.enabled) return {};
  const std::size_t k = std::size_t(i);
  return {spin_[0][k], spin_[1][k], spin_[2][k]};
}
float ParticleSystem::age(int i) const { return float(time_ - epoch_) - arrays_[6][std::size_t(i)]; }
float ParticleSystem::age_part(int i) const {
  const std::size_t k = std::size_t(i);
  const float life = arrays_[7][k] - arrays_[6][k];
  return math::clamp((float(time_ - epoch_) - arrays_[6][k]) / math::max(life, 1e-6f), 0.0f, 1.0f);
}

void ParticleSystem::set_velocity(int i, Vec3d velocity) {
  for (int k = 0; k < 3; ++k) arrays_[3 + k][std::size_t(i)] = float(velocity[k]);
  if (definition_.planar) arrays_[5][std::size_t(i)] = 0;
}

void ParticleSystem::set_anchor(Vec3d anchor) {
  for (int i = 0; i < count_; ++i) {
    const Vec3d p = position(i) - anchor;
    for (int k = 0; k < 3; ++k) arrays_[k][std::size_t(i)] = float(p[k]);
  }
  definition_.anchor = anchor;
}

ParticleTotals ParticleSystem::totals() const {
  ParticleTotals t;
  Vec3d moment{};
  for (int i = 0; i < count_; ++i) {
    const double s = scale(i), m = double(definition_.mass) * s * s * s;
    const Vec3d v = velocity(i), p = position(i) - definition_.anchor;
    t.mass += m;
    t.momentum += m * v;
    moment += m * p;
    t.kinetic_energy += 0.5 * m * math::dot(v, v);
    t.potential_energy -= m * double(definition_.gravity_scale) * math::dot(definition_.gravity, p);
  }
  t.center = definition_.anchor + (t.mass > 0 ? moment / t.mass : Vec3d{});
  return t;
}

std::uint64_t ParticleSystem::state_hash() const {
  core::StateHash hash;
  hash.add(count_).add(time_);
  for (int k = 0; k < 9; ++k)
    for (int i = 0; i < count_; ++i) hash.add(arrays_[k][std::size_t(i)]);
  for (const detail::AlignedFloats& array : spin_)
    for (std::size_t i = 0; i < math::min(array.size(), std::size_t(count_)); ++i) hash.add(array[i]);
  for (int i = 0; i < count_; ++i) hash.add(ids_[std::size_t(i)]);
  return hash.digest();
}

void ParticleSystem::look(std::vector<Vec3f>& positions, std::vector<float>& radii, std::vector<std::uint32_t>& rgbas,
                          int most) const {
  positions.clear();
  radii.clear();
  rgbas.clear();
  const int stride = most > 0 && count_ > most ? (count_ + most - 1) / most : 1;
  for (int i = 0; i < count_; ++i) {
    if (stride > 1 && ids_[std::size_t(i)] % std::uint32_t(stride) != 0) continue;
    const float part = age_part(i);
    const float opacity = math::clamp(definition_.opacity_over_age(part), 0.0f, 1.0f);
    positions.push_back(Vec3f(position(i)));
    radii.push_back(definition_.radius * scale(i) * math::max(definition_.size_over_age(part), 0.0f));
    rgbas.push_back(definition_.color_over_age(part) << 8 | std::uint32_t(opacity * 255 + 0.5f));
  }
}

}  // namespace carom::particles
