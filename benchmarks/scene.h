// Benchmark scenes: the bodies of one world, in a fixed order, and what is done to them before each step. Built here
// once for `carom bench`, bench_scenes and the determinism hashes. The recipes are those that the engines' authors
// publish with their own benchmarks; see docs/benchmarks.md.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "carom/rigid/world.h"

namespace carom::bench {

/// One scene at work. It keeps what its actions need (the pusher's handle, the ragdolls that are next to go).
template <class D>
class Scene {
 public:
  using Dimensions = D;
  virtual ~Scene() = default;
  virtual void define(rigid::WorldDef<D>&) {}  ///< the suite's settings are there already
  virtual void build(rigid::World<D>& world) = 0;
  virtual void before_step(rigid::World<D>&, int /*step*/) {}
};
template <class D>
using SceneMaker = std::unique_ptr<Scene<D>> (*)();
template <class S>
std::unique_ptr<Scene<typename S::Dimensions>> make() {
  return std::make_unique<S>();
}

struct SceneInfo {
  const char* suite;
  const char* name;
  int steps;
  int hash_steps = 0;                       ///< steps of the determinism hash; 0: not one of them
  bool acts = false;                        ///< what is done before a step is part of its time, as the peer counts it
  const char* missing = nullptr;            ///< what Carom lacks for it, or how it differs from its recipe
  SceneMaker<rigid::Dim2> make2 = nullptr;  ///< one of the two is set, or none where the scene cannot be built yet
  SceneMaker<rigid::Dim3> make3 = nullptr;

  std::string path() const { return std::string(suite) + "/" + name; }
  int dimension() const { return make2 != nullptr ? 2 : 3; }
};

/// All of them, suite by suite: common, box3d, box2d, jolt.
std::span<const SceneInfo> all_scenes();
/// Scenes of one suite, or those with this name or "suite/name".
std::vector<const SceneInfo*> find_scenes(const std::string& name);

/// The settings that the scenes of a suite share.
template <class D>
void define_suite(const std::string& suite, rigid::WorldDef<D>& definition) {
  definition.gravity.y = suite == "box3d" || suite == "box2d" ? -10.0f : -9.81f;
  definition.maximum_linear_speed = suite == "jolt" ? 500.0f : 400.0f;
  if (suite == "common") definition.allow_sleep = false;
}

}  // namespace carom::bench
