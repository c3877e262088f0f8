// Runs a scene and times it.
#pragma once

#include "benchmarks/scene.h"

namespace carom::bench {

struct Settings {
  int threads = 1;
  int substeps = 4;
  int simd_width = 0;
  int steps = 0;               ///< 0: the scene's own
  bool timed_actions = false;  ///< a step's time includes what is done before it
};

/// What a run came to: time of every step, counts, and the state that tells its quality.
struct Outcome {
  std::vector<rigid::StepProfile> steps;                        ///< ms, by stage; the first step included
  std::vector<double> step_ms;                                  ///< ms, as the caller sees it
  double create_ms = 0;                                         ///< building the scene
  double action_ms = 0;                                         ///< what is done before steps, mean
  rigid::Counters counters;                                     ///< at the end
  double mean_awake = 0, mean_contacts = 0, mean_touching = 0;  ///< over steps (every eighth)
  std::size_t peak_bytes = 0;                                   ///< of the world, over steps (every eighth)
  std::size_t peak_resident = 0;  ///< bytes of the process above what it had before; 0 where the system does not tell
  double worst_drift = 0;         ///< m, farthest any body is from where it was built
  double rms_speed = 0, worst_speed = 0;  ///< m/s at the end
  double worst_penetration = 0;           ///< m at the end
  double worst_joint_gap = 0;             ///< m at the end
  int escaped = 0;                        ///< bodies below −150 m or farther than 10 km
  std::uint64_t hash = 0;                 ///< of the final state
};

Outcome run_scene(const SceneInfo& scene, const Settings& settings);
template <class D>
Outcome run_scene(Scene<D>& scene, rigid::WorldDef<D> definition, int steps, const Settings& settings);

/// Takes the smaller time of each step and stage: the simulations are deterministic, so what remains is free of what
/// other programs did meanwhile.
void take_minima(Outcome& best, Outcome&& next);
double mean_after_first(const std::vector<double>& ms);
/// The mean over steps, without the first.
rigid::StepProfile mean_stages(const Outcome& outcome);

}  // namespace carom::bench
