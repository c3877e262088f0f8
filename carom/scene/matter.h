// What a running scene has besides bodies: ropes, cloth, soft bodies, liquids, grains and particles.
#pragma once

#include <string>
#include <vector>

#include "carom/core/function_ref.h"
#include "carom/core/hash.h"
#include "carom/environment/environment.h"
#include "carom/particles/cloth.h"
#include "carom/particles/coupling.h"
#include "carom/particles/fluid.h"
#include "carom/particles/granular.h"
#include "carom/particles/rope.h"
#include "carom/particles/soft_body.h"
#include "carom/particles/soft_group.h"
#include "carom/scene/scene_world.h"

namespace carom::scene {

/// A thing of the file by its name. `color` is 0xRRGGBB.
template <class T>
struct Named {
  std::string name;
  std::uint32_t color = 0;
  T thing;
};
struct SubEmissionRule {
  bool at_death = true;  ///< or where a particle hits
  int into = 0;          ///< the system that they belong to
  particles::SubEmission emission{};
};
/// A burst with an exact budget of momentum and energy, at its time.
struct TimedBurst {
  double time = 0;  ///< s
  particles::BurstDef burst{};
  particles::Range lifetime{1e30f, 1e30f};  ///< s
  bool done = false;
};
template <class D>
struct SceneParticles {
  particles::ParticleSystem system;
  particles::Coupling<D> coupling;
  particles::Turbulence turbulence{};
  std::vector<SubEmissionRule> rules;
  std::vector<TimedBurst> bursts;
};
template <class D>
struct MatterOf {
  std::vector<Named<particles::Fluid<D>>> liquids;
  std::vector<Named<particles::Granular<D>>> grains;
  std::vector<Named<SceneParticles<D>>> particles;
};

/// Ropes, cloth and soft bodies feel the environment's wind as it is at their middle; particles its steady part over
/// height. Where the scene has no environment the air is still and that of sea level.
class CAROM_API Matter {
 public:
  particles::RopeSet rope_set;
  // Kept for their memory alone.
  particles::RopeAir rope_air;
  environment::WindPatch cloth_patch;
  particles::SoftGroup soft_group;
  std::vector<particles::Cloth*> group_cloths;
  std::vector<particles::SoftBody*> group_bodies;
  std::vector<Named<int>> ropes;  ///< numbers in `rope_set`
  int rope_substeps = 0;          ///< the most that a rope asked for; 0: as the set has them
  std::vector<Named<particles::Cloth>> cloths;
  std::vector<Named<particles::SoftBody>> soft_bodies;
  MatterOf<rigid::Dim2> plane;
  MatterOf<rigid::Dim3> space;

  template <class D>
  MatterOf<D>& of() {
    if constexpr (D::dimension == 2)
      return plane;
    else
      return space;
  }
  template <class D>
  const MatterOf<D>& of() const {
    return const_cast<Matter*>(this)->of<D>();
  }

  /// The world's step with all of this before and after it. `advance` does the world's own part.
  template <class D>
  [[gnu::noinline]] Status step(rigid::World<D>& world, double dt, const environment::Environment* around,
                                core::FunctionRef<Status()> advance);
  /// Lets the particles feel the steady wind of the environment, beside their own turbulence.
  Status set_wind(const environment::Environment* around);
  void add_to(core::StateHash& hash) const;

  /// What a quantity such as "rope.bridge.tension" names; false where it names nothing here.
  bool find(std::string_view text, int dimension, Probe::Source& source, std::string_view& unit) const;
  double read(const Probe::Source& source) const;
  /// The names that quantities begin with: "rope.bridge", "liquid.water", …
  std::vector<std::string> names() const;
};

}  // namespace carom::scene
