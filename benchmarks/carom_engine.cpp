// The recipes in Carom, through its public interface only.
#include "benchmarks/measure.h"
#include "benchmarks/scene_list.h"

namespace carom::bench {
namespace {

template <class D>
RecipeOutcome run(const Recipe& recipe, const RecipeSettings& settings) {
  ListScene<D> scene(recipe);
  Outcome o = run_scene<D>(scene, {}, recipe.steps, {settings.threads, 4, settings.simd_width, settings.steps, false});
  return {std::move(o.step_ms), o.worst_drift,     o.rms_speed, o.worst_speed,
          o.worst_penetration,  o.worst_joint_gap, o.escaped};
}

}  // namespace

RecipeOutcome run_carom(const Recipe& recipe, const RecipeSettings& settings) {
  return recipe.dimension == 2 ? run<rigid::Dim2>(recipe, settings) : run<rigid::Dim3>(recipe, settings);
}

}  // namespace carom::bench
