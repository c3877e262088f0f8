// Benchmark scenes as engine-neutral lists, so that Carom and its peers build exactly the same bodies in the same
// order. The recipes are those of shared scenes that the engines' authors publish; see docs/benchmarks.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace carom::bench {

enum class Kind : std::uint8_t { box, sphere, capsule };  ///< capsule: along local y

struct BodyRecipe {
  Kind kind = Kind::box;
  bool fixed = false;
  float size[3] = {0.5f, 0.5f, 0.5f};  ///< box: half extents; sphere: radius; capsule: half length, radius
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
  bool sleep = false;
  std::vector<BodyRecipe> bodies;
  std::vector<JointRecipe> joints;
};

/// large_pyramid, many_pyramids, twenty_pyramids, heap, joint_grid, large_pyramid_2d.
std::vector<std::string> recipe_names();
/// Empty `bodies` for an unknown name.
Recipe make_recipe(const std::string& name);

/// What a run came to: time of every step and the state that tells its quality.
struct Outcome {
  std::vector<double> step_ms;
  double worst_drift = 0;  ///< m, farthest any body is from where it was built (stacks)
  double rms_speed = 0;    ///< m/s at the end
  double worst_speed = 0;
  double worst_penetration = 0;  ///< m at the end
  double worst_joint_gap = 0;    ///< m at the end
  int escaped = 0;               ///< bodies outside 200 m (heap: outside its walls)
  std::size_t bytes = 0;         ///< where the engine tells
  std::uint64_t hash = 0;        ///< of the final state, Carom only
};

struct Settings {
  int threads = 1;
  int substeps = 4;
  int simd_width = 0;
  int steps = 0;  ///< 0: the recipe's
};
using Runner = Outcome (*)(const Recipe&, const Settings&);
Outcome run_carom(const Recipe&, const Settings&);
Outcome run_bullet(const Recipe&, const Settings&);
Outcome run_box2d(const Recipe&, const Settings&);

}  // namespace carom::bench
