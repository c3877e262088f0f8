// A world as a scene file: reading it back gives the same bits.
#pragma once

#include "carom/scene/scene_world.h"

namespace carom::scene {

struct WriteOptions {
  std::string name = "scene";
  std::string description;
  double dt = 1.0 / 60;  ///< s
  double duration = 10;  ///< s
};
/// The world as it is now. Every number is written with the digits that restore its bits, so that the state hash of
/// the world read back is the same. What a file cannot hold is not written: user callbacks (CustomEffector), contact
/// impulses of the last step and forces that wait for the next one. Names not unique are made so. What is joined to the
/// world itself is read back as joined to a fixed body of that name; then there is a body more, and another hash.
CAROM_API Result<std::string> write_scene(const rigid::World2& world, const WriteOptions& options = {},
                                          std::span<const SceneBody> names = {});
CAROM_API Result<std::string> write_scene(const rigid::World3& world, const WriteOptions& options = {},
                                          std::span<const SceneBody> names = {});
CAROM_API Result<std::string> write_scene(const SceneWorld& world, const WriteOptions& options = {});

}  // namespace carom::scene
