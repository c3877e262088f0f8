// Benchmark scenes as engine-neutral lists, so that Carom and its peers build exactly the same bodies in the same
// order. The recipes are those of shared scenes that the engines' authors publish; see docs/benchmarks.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace carom::bench {

enum class Kind : std::uint8_t { box, sphere, capsule, cylinder };  ///< capsule, cylinder: along local y

struct BodyRecipe {
  Kind kind = Kind::box;
  bool fixed = false;
  float size[3] = {0.5f, 0.5f, 0.5f};  ///< box: half extents; sphere: radius; others: half length, radius
  double position[3] = {0, 0, 0};
  float rotation[4] = {1, 0, 0, 0};  ///< w, x, y, z
  bool collides = true;
};
/// A ball (2D: revolute) joint; anchors in the bodies' frames.
struct JointRecipe {
  int body_a = 0, body_b = 0;
  float anchor_a[3] = {0, 0, 0}, anchor_b[3] = {0, 0, 0};
};
struct Recipe {
  std::string name;
  int dimension = 3;
  int steps = 100;
  float gravity = 10;
  float density = 1000;
  float friction = 0.6f, ground_friction = 0.6f;
  float damping = 0;  ///< 1/s, linear and angular
  bool sleep = false;
  std::vector<BodyRecipe> bodies;
  std::vector<JointRecipe> joints;
};

// Lists of the suites of box3d (3D), box2d (2D) and jolt, and the two scenes that any engine can build.
Recipe large_pyramid(int dimension);
Recipe many_pyramids();
Recipe joint_grid(int dimension);
Recipe wide_pyramid(bool jolt);
Recipe twenty_pyramids();
Recipe heap();

/// Those that bench_scenes compares: large_pyramid, many_pyramids, twenty_pyramids, heap, joint_grid, large_pyramid_2d.
std::vector<std::string> recipe_names();
/// Empty `bodies` for an unknown name.
Recipe make_recipe(const std::string& name);

/// What a run of a recipe came to: time of every step and the state that tells its quality.
struct RecipeOutcome {
  std::vector<double> step_ms;
  double worst_drift = 0;  ///< m, farthest any body is from where it was built (stacks)
  double rms_speed = 0;    ///< m/s at the end
  double worst_speed = 0;
  double worst_penetration = 0;  ///< m at the end
  double worst_joint_gap = 0;    ///< m at the end
  int escaped = 0;               ///< bodies outside 200 m
};
struct RecipeSettings {
  int threads = 1;
  int steps = 0;  ///< 0: the recipe's
  int simd_width = 0;
};
using Runner = RecipeOutcome (*)(const Recipe&, const RecipeSettings&);
RecipeOutcome run_carom(const Recipe&, const RecipeSettings&);

}  // namespace carom::bench
