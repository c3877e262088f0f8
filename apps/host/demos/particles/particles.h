// What the demos of particles share.
#pragma once

#include "apps/host/demos/demos.h"
#include "carom/core/hash.h"
#include "carom/particles/coupling.h"

namespace carom::host::demo {

std::unique_ptr<Demo> make_wind_on_obstacles();
std::unique_ptr<Demo> make_spark_burst();
std::unique_ptr<Demo> make_snow();
std::unique_ptr<Demo> make_drop_fountain();
std::unique_ptr<Demo> make_hail();
std::unique_ptr<Demo> make_fire();
std::unique_ptr<Demo> make_fireball();
std::unique_ptr<Demo> make_sand_heap();

/// Several systems as one cloud of points.
class Cloud {
 public:
  void add(const particles::ParticleSystem& system, int most = 1 << 20) {
    system.look(positions_, radii_, colors_, most);
    all_positions_.insert(all_positions_.end(), positions_.begin(), positions_.end());
    all_radii_.insert(all_radii_.end(), radii_.begin(), radii_.end());
    all_colors_.insert(all_colors_.end(), colors_.begin(), colors_.end());
  }
  void draw(StageBase& stage) {
    stage.points(all_positions_, all_radii_, all_colors_);
    all_positions_.clear();
    all_radii_.clear();
    all_colors_.clear();
  }

 private:
  std::vector<Vec3f> positions_, all_positions_;
  std::vector<float> radii_, all_radii_;
  std::vector<std::uint32_t> colors_, all_colors_;
};

/// A system that the stage answers for: an error fails it.
inline std::optional<particles::ParticleSystem> make_system(StageBase& stage, const particles::SystemDef& definition) {
  auto system = particles::ParticleSystem::create(definition);
  if (!system) {
    stage.fail(system.error());
    return std::nullopt;
  }
  return std::move(*system);
}
inline std::uint64_t mixed(std::uint64_t hash, const std::optional<particles::ParticleSystem>& system) {
  core::StateHash h;
  h.add(hash);
  if (system) h.add(system->state_hash());
  return h.digest();
}

}  // namespace carom::host::demo
