// A world of a scene that must load, and what its quantities are.
#pragma once

#include <gtest/gtest.h>

#include "carom/scene/scene.h"

namespace carom::scene::test {

/// An empty world where the scene or its start fails, which fails the test.
inline SceneWorld started(const Result<Scene>& scene, std::span<const ParameterValue> values = {}) {
  EXPECT_TRUE(scene.ok()) << (scene.ok() ? "" : scene.error().message);
  if (!scene) return {};
  Result<SceneWorld> world = scene->instantiate(values);
  EXPECT_TRUE(world.ok()) << (world.ok() ? "" : world.error().message);
  return world ? std::move(world).value() : SceneWorld();
}

/// In SI units; 0 where there is no such quantity, which fails the test.
inline double read(const SceneWorld& world, std::string_view quantity) {
  const Result<Probe> probe = world.probe(quantity);
  EXPECT_TRUE(probe.ok()) << (probe.ok() ? "" : probe.error().message);
  return probe.ok() ? world.read(*probe) : 0;
}

}  // namespace carom::scene::test
