#include "benchmarks/recipe.h"

#include "carom/math/elementary.h"
#include "carom/math/vec.h"

namespace carom::bench {
namespace {

BodyRecipe box(double x, double y, double z, float hx, float hy, float hz, bool fixed = false) {
  BodyRecipe b;
  b.fixed = fixed;
  b.size[0] = hx, b.size[1] = hy, b.size[2] = hz;
  b.position[0] = x, b.position[1] = y, b.position[2] = z;
  return b;
}

}  // namespace

// 5 050 unit cubes in one planar pyramid of 100 rows.
Recipe large_pyramid(int dimension) {
  Recipe r;
  r.name = dimension == 2 ? "large_pyramid_2d" : "large_pyramid";
  r.dimension = dimension;
  r.steps = dimension == 2 ? 500 : 200;
  r.density = dimension == 2 ? 1.0f : 100.0f;
  r.bodies.push_back(dimension == 2 ? box(0, -1, 0, 100, 1, 1, true) : box(0, -1, 0, 400, 1, 400, true));
  for (int i = 0; i < 100; ++i)
    for (int j = i; j < 100; ++j) r.bodies.push_back(box(0.5 * (i + 1) + (j - i) - 50, i + 0.5, 0, 0.5f, 0.5f, 0.5f));
  return r;
}

// 14 × 14 pyramids of 55 unit cubes.
Recipe many_pyramids() {
  Recipe r;
  r.name = "many_pyramids";
  r.density = 100;
  r.bodies.push_back(box(0, -1, 0, 77, 1, 77, true));
  for (int i = 0; i < 14; ++i)
    for (int j = 0; j < 14; ++j)
      for (int row = 0; row < 10; ++row)
        for (int column = row; column < 10; ++column)
          r.bodies.push_back(box(0.5 * (row + 1) + (column - row) - 0.5 - 76 + 11 * j, row + 0.5, -76 + i * 152.0 / 13,
                                 0.5f, 0.5f, 0.5f));
  return r;
}

// 20 pyramids of 55 unit cubes, 3 m apart.
Recipe twenty_pyramids() {
  Recipe r;
  r.name = "twenty_pyramids";
  r.steps = 300;
  r.gravity = 9.81f;
  r.density = 1;
  r.bodies.push_back(box(0, -1, 0, 200, 1, 200, true));
  for (int k = 0; k < 20; ++k)
    for (int i = 0; i < 10; ++i)
      for (int j = 0; j < 10 - i; ++j)
        r.bodies.push_back(box(-4.5 + 0.5 * i + j, 0.5 + i, 3.0 * (k - 10), 0.5f, 0.5f, 0.5f));
  return r;
}

// 2 000 cubes, spheres and capsules fall into a walled pit.
Recipe heap() {
  Recipe r;
  r.name = "heap";
  r.steps = 300;
  r.gravity = 9.81f;
  r.density = 1;
  r.friction = r.ground_friction = 0.5f;
  r.bodies.push_back(box(0, -1, 0, 200, 1, 200, true));
  for (int side : {-1, 1}) {
    r.bodies.push_back(box(7.5 * side, 10, 0, 1, 12, 8.5f, true));
    r.bodies.push_back(box(0, 10, 7.5 * side, 6.5f, 12, 1, true));
  }
  std::uint32_t state = 12345;
  const auto draw = [&state] {
    state = 1664525u * state + 1013904223u;
    return double(state >> 8) / 16777216.0;
  };
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 10; ++x)
      for (int z = 0; z < 10; ++z) {
        BodyRecipe b;
        b.position[0] = 1.25 * (x - 4.5) + 0.1 * (draw() - 0.5);
        b.position[1] = 1 + 1.25 * y;
        b.position[2] = 1.25 * (z - 4.5) + 0.1 * (draw() - 0.5);
        double axis[3] = {0, 0, 0}, length = 0;
        for (double& a : axis) a = draw() - 0.5, length += a * a;
        const double angle = 3 * draw(), s = math::sin(angle / 2) / math::sqrt(length);
        b.rotation[0] = float(math::cos(angle / 2));
        for (int k = 0; k < 3; ++k) b.rotation[k + 1] = float(s * axis[k]);
        switch ((x + y + z) % 3) {
          case 0:
            b.kind = Kind::box, b.size[0] = b.size[1] = b.size[2] = 0.4f;
            break;
          case 1:
            b.kind = Kind::sphere, b.size[0] = 0.45f;
            break;
          default:
            b.kind = Kind::capsule, b.size[0] = 0.3f, b.size[1] = 0.3f;
        }
        r.bodies.push_back(b);
      }
  return r;
}

// 100 × 100 spheres (2D: circles) in a net of ball (revolute) joints that hangs from its upper edge, in the plane from
// seven fixed bodies of it; nothing collides. No joints between two fixed bodies.
Recipe joint_grid(int dimension) {
  Recipe r;
  r.name = dimension == 2 ? "joint_grid_2d" : "joint_grid";
  r.dimension = dimension;
  r.steps = dimension == 2 ? 500 : 100;
  r.density = dimension == 2 ? 1.0f : 1000.0f;
  constexpr int n = 100;
  const auto fixed = [dimension](int k, int i) { return i == 0 && (dimension == 3 || (k >= 47 && k <= 53)); };
  for (int k = 0; k < n; ++k)
    for (int i = 0; i < n; ++i) {
      BodyRecipe b;
      b.kind = Kind::sphere;
      b.fixed = fixed(k, i);
      b.size[0] = 0.4f;
      b.position[0] = k, b.position[1] = -i;
      b.collides = false;
      const int index = int(r.bodies.size());
      r.bodies.push_back(b);
      if (i > 0) r.joints.push_back({index - 1, index, {0, -0.5f, 0}, {0, 0.5f, 0}});
      if (k > 0 && !(b.fixed && fixed(k - 1, i))) r.joints.push_back({index - n, index, {0.5f, 0, 0}, {-0.5f, 0, 0}});
    }
  return r;
}

// A pyramid on a square base, 15 layers that fall 0.5 m onto each other: 1 240 cubes of 8 t, or of half 0.975 m.
Recipe wide_pyramid(bool jolt) {
  Recipe r;
  r.name = jolt ? "pyramid" : "wide_pyramid";
  r.steps = 500;
  r.gravity = jolt ? 9.81f : 10.0f;
  r.sleep = !jolt;
  r.damping = jolt ? 0.05f : 0.0f;
  if (jolt) r.friction = r.ground_friction = 0.2f;
  r.bodies.push_back(jolt ? box(0, -1, 0, 50, 1, 50, true) : box(0, -1, 0, 100, 1, 100, true));
  const float half = jolt ? 1.0f : 0.975f;
  for (int i = 0; i < 15; ++i)
    for (int j = i / 2; j < 15 - (i + 1) / 2; ++j)
      for (int k = i / 2; k < 15 - (i + 1) / 2; ++k)
        r.bodies.push_back(box(-15 + 2 * j + i % 2, 1 + 2.5 * i, -15 + 2 * k + i % 2, half, half, half));
  return r;
}

std::vector<std::string> recipe_names() {
  return {"large_pyramid", "many_pyramids", "twenty_pyramids", "heap", "joint_grid", "large_pyramid_2d"};
}

Recipe make_recipe(const std::string& name) {
  if (name == "large_pyramid") return large_pyramid(3);
  if (name == "large_pyramid_2d") return large_pyramid(2);
  if (name == "many_pyramids") return many_pyramids();
  if (name == "twenty_pyramids") return twenty_pyramids();
  if (name == "heap") return heap();
  if (name == "joint_grid") return joint_grid(3);
  return {};
}

}  // namespace carom::bench
