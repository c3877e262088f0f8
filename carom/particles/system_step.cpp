// The step: blocks of particles move and meet surfaces, chunks of blocks in parallel; then, in the order of indices,
// what they told is gathered and the dead leave.
#include <algorithm>
#include <string>

#include "carom/math/elementary.h"
#include "carom/particles/system.h"

namespace carom::particles {
using math::Vec3d;
using math::Vec3f;

namespace {

/// Particles of one task. Sums are kept by chunk and added in the order of chunks.
constexpr int chunk_size = 4 * detail::block_size;
constexpr double rebase_after = 64;  // s: ages stay exact to 4 µs
constexpr float immortal = 1e29f;

detail::Kernels kernels_of(int lanes) {
#if CAROM_WIDE_UNITS
  if (lanes == 16)
    return {detail::particles_avx512::move, detail::particles_avx512::collide, detail::particles_avx512::find_near,
            detail::particles_avx512::find_dead};
  if (lanes == 8)
    return {detail::particles_avx2::move, detail::particles_avx2::collide, detail::particles_avx2::find_near,
            detail::particles_avx2::find_dead};
#endif
  (void)lanes;
  return {detail::particles_baseline::move, detail::particles_baseline::collide, detail::particles_baseline::find_near,
          detail::particles_baseline::find_dead};
}

}  // namespace

detail::Arrays ParticleSystem::pointers() {
  detail::Arrays a{};
  for (int k = 0; k < 3; ++k) {
    a.position[k] = arrays_[k].data();
    a.velocity[k] = arrays_[3 + k].data();
  }
  a.birth = arrays_[6].data();
  a.death = arrays_[7].data();
  a.scale = scaled_ ? arrays_[8].data() : nullptr;
  a.held = sticky_ ? arrays_[9].data() : nullptr;
  return a;
}

void ParticleSystem::rebase_time() {
  const double shift = time_ - epoch_;
  if (shift < rebase_after) return;
  epoch_ = time_;
  for (std::size_t i = 0; i < std::size_t(count_); ++i) {
    arrays_[6][i] -= float(shift);
    if (arrays_[7][i] < immortal) arrays_[7][i] -= float(shift);
  }
}

void ParticleSystem::prepare_chunks() {
  const std::size_t chunks = (std::size_t(definition_.capacity) + chunk_size - 1) / chunk_size;
  chunk_dead_.resize(chunks);
  chunk_hits_.resize(chunks);
  if (definition_.report_hits) {
    hit_list_.resize(chunks * chunk_size);
    hit_collider_.resize(chunks * chunk_size);
    hits_.reserve(chunks * chunk_size);
  }
  chunk_exchanged_.resize(chunks * colliders_.size() * 6);
  chunk_touching_.resize(chunks * colliders_.size());
}

int ParticleSystem::collide_block(int from, int to, detail::Path& path, detail::HitList& hits, double* exchanged,
                                  const detail::Kernels& kernels) {
  const detail::Arrays arrays = pointers();
  const std::size_t chunk = std::size_t(from / chunk_size);
  int touched = 0;
  for (std::size_t c = 0; c < surfaces_.size(); ++c) {
    const detail::SurfaceData& surface = surfaces_[c];
    if (surface.form == detail::Form::given) cast_block(surface, colliders_[c].shape, from, to, path);
    hits.exchanged = surface.two_way ? exchanged + 6 * c : nullptr;
    const int before = hits.count;
    const int here = kernels.collide(collide_, surface, arrays, from, to, count_, path, hits);
    for (int k = before; k < hits.count; ++k) hit_collider_[chunk * chunk_size + std::size_t(k)] = int(c);
    chunk_touching_[chunk * surfaces_.size() + c] += here;
    touched += here;
  }
  return touched;
}

void ParticleSystem::run_chunk(int begin, int end, const detail::Kernels& kernels) {
  detail::Path path;
  const detail::Arrays arrays = pointers();
  const std::size_t chunk = std::size_t(begin / chunk_size), colliders = surfaces_.size();
  std::int32_t* const dead = dead_.data() + begin;
  int dead_count = 0;
  detail::HitList hits{nullptr, 0, 0, definition_.slowest_hit, nullptr};
  if (definition_.report_hits) {
    hits.hits = hit_list_.data() + chunk * chunk_size;
    hits.room = chunk_size;
  }
  double* const exchanged = chunk_exchanged_.data() + chunk * colliders * 6;
  for (std::size_t k = 0; k < colliders * 6; ++k) exchanged[k] = 0;
  for (std::size_t k = 0; k < colliders; ++k) chunk_touching_[chunk * colliders + k] = 0;
  for (int from = begin; from < end; from += detail::block_size) {
    const int last = math::min(from + detail::block_size, end), to = (last + 15) / 16 * 16;
    if (definition_.contacts.enabled)
      place_grains(from, to, path);
    else
      kernels.move(move_, arrays, from, to, path);
    // Who was pushed by one surface into another is seen by the second round.
    if (colliders > 0 && collide_block(from, to, path, hits, exchanged, kernels) > 0 && colliders > 1)
      collide_block(from, to, path, hits, exchanged, kernels);
    dead_count += kernels.find_dead(arrays, move_.now, definition_.limit, from, to, count_, dead + dead_count);
  }
  chunk_dead_[chunk] = dead_count;
  chunk_hits_[chunk] = hits.count;
}

void ParticleSystem::collect_events() {
  const std::size_t chunks = (std::size_t(count_) + chunk_size - 1) / chunk_size, colliders = surfaces_.size();
  exchanges_.assign(colliders, Exchange{});
  for (std::size_t chunk = 0; chunk < chunks; ++chunk)
    for (std::size_t c = 0; c < colliders; ++c) {
      const double* e = chunk_exchanged_.data() + (chunk * colliders + c) * 6;
      exchanges_[c].impulse -= Vec3d{e[0], e[1], e[2]};
      exchanges_[c].angular_impulse -= Vec3d{e[3], e[4], e[5]};
      exchanges_[c].touching += chunk_touching_[chunk * colliders + c];
    }
  if (definition_.contacts.enabled)
    for (std::size_t c = 0; c < colliders; ++c) {
      const double* e = contact_exchanged_.data() + 6 * c;
      exchanges_[c].impulse += Vec3d{e[0], e[1], e[2]};
      exchanges_[c].angular_impulse += Vec3d{e[3], e[4], e[5]};
      exchanges_[c].touching += contact_touching_[c];
    }
  hits_.clear();
  if (!definition_.report_hits) return;
  for (std::size_t chunk = 0; chunk < chunks; ++chunk)
    for (std::size_t k = 0; k < std::size_t(chunk_hits_[chunk]); ++k) {
      const detail::Hit& hit = hit_list_[chunk * chunk_size + k];
      hits_.push_back({position(hit.index),
                       Vec3f(velocity(hit.index)),
                       {hit.normal[0], hit.normal[1], hit.normal[2]},
                       hit.speed,
                       hit_collider_[chunk * chunk_size + k],
                       id(hit.index)});
    }
}

void ParticleSystem::remove_dead() {
  deaths_.clear();
  const std::size_t chunks = (std::size_t(count_) + chunk_size - 1) / chunk_size;
  // The dead of a chunk stand at its front in rising order: gathered, they rise over all.
  std::size_t found = 0;
  for (std::size_t chunk = 0; chunk < chunks; ++chunk)
    for (std::int32_t k = 0; k < chunk_dead_[chunk]; ++k) dead_[found++] = dead_[chunk * chunk_size + std::size_t(k)];
  for (std::size_t k = 0; k < found; ++k) {
    const int i = dead_[k];
    if (arrays_[7][std::size_t(i)] > move_.now) {
      ++lost_;
    } else if (definition_.report_deaths) {
      deaths_.push_back({position(i), Vec3f(velocity(i)), {}, 0, -1, id(i)});
    }
  }
  // From the last one down, so that the one that takes a place is never dead itself.
  for (std::size_t k = found; k-- > 0;) {
    const std::size_t i = std::size_t(dead_[k]), last = std::size_t(--count_);
    for (detail::AlignedFloats& array : arrays_) {
      array[i] = array[last];
      array[last] = 0;  // what stands behind the last flies too, and must stay finite
    }
    if (definition_.contacts.enabled)
      for (detail::AlignedFloats& array : spin_) array[i] = array[last];
    arrays_[8][last] = 1;
    ids_[i] = ids_[last];
  }
}

core::Status ParticleSystem::step(double dt, core::TaskScheduler* scheduler) {
  if (!(dt > 0 && dt <= 1))
    return core::Error{"particle system: step of " + std::to_string(dt) + " s, expected above 0 to 1"};
  rebase_time();
  time_ += dt;
  prepare_move(dt);
  prepare_surfaces(dt);
  const detail::Kernels kernels = kernels_of(lanes_);
  core::SerialScheduler serial;
  core::TaskScheduler& tasks = scheduler != nullptr ? *scheduler : serial;
  const core::ParallelRegion region(tasks);
  if (definition_.contacts.enabled) step_contacts(dt, tasks, kernels);
  tasks.parallel_for(count_, chunk_size, [&](int begin, int end, int) { run_chunk(begin, end, kernels); });
  collect_events();
  remove_dead();
  for (Emitter& emitter : emitters_) bear(emitter, dt);
  return {};
}

}  // namespace carom::particles
