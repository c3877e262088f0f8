// What the tests of fracture break.
#pragma once

#include "carom/blast/fracture.h"
#include "carom/geometry/mesh_builders.h"

namespace fracture_test {
using namespace carom;
using namespace carom::blast;
using math::Vec3d;

inline ConvexCell unit_box() { return ConvexCell(geometry::Bounds3d{{0, 0, 0}, {1, 1, 1}}); }

struct MeshCase {
  const char* name;
  geometry::Triangles mesh;
  int count;
};
inline std::vector<MeshCase> mesh_cases() {
  std::vector<math::Vec2f> vase;  // a wall 2 cm thick, outside up and inside down
  const float radius[] = {.12f, .2f, .26f, .24f, .16f, .12f, .14f};
  for (int i = 0; i < 7; ++i) vase.push_back({radius[i], 0.1f * float(i)});
  for (int i = 6; i >= 0; --i) vase.push_back({radius[i] - 0.02f, 0.1f * float(i) + (i == 0 ? 0.02f : 0)});
  return {{"torus", geometry::make_torus_mesh(0.7f, 0.25f, 24, 12), 40},
          {"vase", geometry::make_lathe_mesh(vase, 24), 60},
          {"sphere", geometry::make_sphere_mesh(0.5f, 24, 12), 30},
          {"box", geometry::make_box_mesh({0.5f, 0.3f, 0.2f}), 50}};
}

}  // namespace fracture_test
