// Births: emitters, and what follows from events.
#include <string>

#include "carom/math/elementary.h"
#include "carom/particles/system.h"

namespace carom::particles {
using math::Vec3d;

core::Result<int> ParticleSystem::add_emitter(const EmitterDef& definition) {
  if (const core::Status status = particles::check(definition); !status) return status.error();
  Emitter emitter;
  emitter.definition = definition;
  if (definition.mesh != nullptr) emitter.areas = MeshAreas(*definition.mesh);
  emitter.random = math::Random(definition.seed, emitters_.size());
  emitters_.push_back(std::move(emitter));
  return int(emitters_.size()) - 1;
}

core::Status ParticleSystem::set_emitter(int index, const EmitterDef& definition) {
  if (index < 0 || index >= int(emitters_.size()))
    return core::Error{"particle system: emitter " + std::to_string(index) + " does not exist, there are " +
                       std::to_string(emitters_.size())};
  if (const core::Status status = particles::check(definition); !status) return status;
  Emitter& emitter = emitters_[std::size_t(index)];
  if (definition.mesh != emitter.definition.mesh)
    emitter.areas = definition.mesh != nullptr ? MeshAreas(*definition.mesh) : MeshAreas();
  emitter.definition = definition;
  return {};
}

bool ParticleSystem::bear_one(Emitter& emitter, double before_end) {
  const EmitterDef& d = emitter.definition;
  const Emission e = draw(d, emitter.areas, definition_.planar, emitter.random);
  const Vec3d velocity = math::rotate(d.rotation, e.velocity) + d.velocity * double(d.inherited);
  // Where the emitter was at that moment, and what of its way the particle has gone since; drag begins with its first
  // whole step.
  const Vec3d gravity = definition_.gravity * double(definition_.gravity_scale);
  const Vec3d position = d.position - d.velocity * before_end + math::rotate(d.rotation, e.place) +
                         (velocity + gravity * (0.5 * before_end)) * before_end;
  return push(position, velocity + gravity * before_end, float(time_ - epoch_ - before_end), e.lifetime, e.scale);
}

core::Result<int> ParticleSystem::emit(int index, int count) {
  if (index < 0 || index >= int(emitters_.size()))
    return core::Error{"particle system: emitter " + std::to_string(index) + " does not exist, there are " +
                       std::to_string(emitters_.size())};
  int born = 0;
  while (born < count && bear_one(emitters_[std::size_t(index)], 0)) ++born;
  return born;
}

void ParticleSystem::bear(Emitter& emitter, double dt) {
  EmitterDef& d = emitter.definition;
  d.position += d.velocity * dt;
  const double before = emitter.age;
  emitter.age += dt;
  if (!d.enabled) return;
  if (!emitter.burst_done && emitter.age >= double(d.start)) {
    emitter.burst_done = true;
    for (int k = 0; k < d.burst && bear_one(emitter, math::min(dt, emitter.age - double(d.start))); ++k) {
    }
  }
  const double end = double(d.start) + double(d.duration);
  const double from = math::max(before, double(d.start)), to = math::min(emitter.age, end);
  if (!(d.rate > 0) || !(to > from)) return;
  // One is due whenever the integral of the rate passes a whole number.
  const double due = emitter.owed + double(d.rate) * (to - from);
  const int whole = int(math::min(due, double(definition_.capacity)));
  for (int k = 1; k <= whole; ++k) {
    const double when = from + (double(k) - emitter.owed) / double(d.rate);
    if (!bear_one(emitter, math::clamp(emitter.age - when, 0.0, dt))) break;
  }
  emitter.owed = due - math::floor(due);
}

core::Result<int> ParticleSystem::emit_at(std::span<const ParticleEvent> events, const SubEmission& sub) {
  if (const core::Status status = particles::check(sub.emitter); !status) return status.error();
  if (sub.count < 0)
    return core::Error{"sub-emission: count is " + std::to_string(sub.count) + ", expected at least 0"};
  if (!(sub.chance >= 0 && sub.chance <= 1))
    return core::Error{"sub-emission: chance is " + std::to_string(sub.chance) + ", expected 0 to 1"};
  if (!math::is_finite(sub.inherited)) return core::Error{"sub-emission: inherited is not finite"};
  const MeshAreas areas = sub.emitter.mesh != nullptr ? MeshAreas(*sub.emitter.mesh) : MeshAreas();
  int born = 0;
  for (const ParticleEvent& event : events) {
    // A stream for each event, so that what one draws does not depend on the others.
    math::Random random(sub.emitter.seed, ++sub_draws_);
    if (!random.chance(double(sub.chance))) continue;
    math::Quatd turn = sub.emitter.rotation;
    const Vec3d n(event.normal);
    if (sub.along_normal && math::length(n) > 0.5) {
      // The shortest turn from y to the normal.
      const math::Quatd half = n.y > -0.999 ? math::Quatd{1 + n.y, n.z, 0, -n.x} : math::Quatd{0, 1, 0, 0};
      turn = math::normalize(half) * turn;
    }
    for (int k = 0; k < sub.count; ++k) {
      const Emission e = draw(sub.emitter, areas, definition_.planar, random);
      if (!push(event.position + math::rotate(turn, e.place),
                math::rotate(turn, e.velocity) + Vec3d(event.velocity) * double(sub.inherited), float(time_ - epoch_),
                e.lifetime, e.scale))
        return born;
      ++born;
    }
  }
  return born;
}

}  // namespace carom::particles
