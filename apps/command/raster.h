// A small software renderer: perspective, depth buffer, sun with soft shadows, a ground with a grid.
#pragma once

#include <optional>
#include <vector>

#include "apps/command/tessellate.h"
#include "apps/host/declaration.h"

namespace carom::command {

struct RasterScene {
  std::vector<Triangle> triangles;
  std::vector<host::Line> lines;
  host::Camera camera;
  std::optional<double> ground;
  double grid = 1;  ///< m between lines of the ground
};

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;  ///< 0x00RRGGBB
};
Image render(const RasterScene& scene, int width, int height);

/// A point on the image, or nothing where it is behind the camera.
std::optional<math::Vec2d> project(const host::Camera& camera, math::Vec3d p, int width, int height);

}  // namespace carom::command
