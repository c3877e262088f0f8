// Every kind of ground carries every kind of body: planes, meshes, height fields, chains, compounds.
#include <gtest/gtest.h>

#include "carom/geometry/compound.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

geometry::Shape3 flat_mesh() {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  for (int j = 0; j <= 10; ++j)
    for (int i = 0; i <= 10; ++i) vertices.push_back({float(2 * i - 10), 0, float(2 * j - 10)});
  for (std::uint32_t j = 0; j < 10; ++j)
    for (std::uint32_t i = 0; i < 10; ++i) {
      const std::uint32_t a = j * 11 + i, b = a + 1, c = a + 11, d = c + 1;
      for (const std::uint32_t k : {a, c, b, b, c, d}) indices.push_back(k);
    }
  return geometry::make_triangle_mesh(vertices, indices).value();
}
geometry::Shape3 flat_field() {
  return geometry::make_height_field(11, 11, {2, 2}, std::vector<float>(121, 0.0f)).value();
}
std::vector<geometry::Shape3> bodies_of_every_kind() {
  const Vec3f octahedron[6] = {{0.5f, 0, 0}, {-0.5f, 0, 0}, {0, 0.5f, 0}, {0, -0.5f, 0}, {0, 0, 0.5f}, {0, 0, -0.5f}};
  std::vector<geometry::CompoundChild> children{{geometry::Box{{0.5f, 0.1f, 0.1f}}, {}},
                                                {geometry::Sphere{0.3f}, {{0.5f, 0, 0}, {}}},
                                                {geometry::Sphere{0.3f}, {{-0.5f, 0, 0}, {}}}};
  return {geometry::Sphere{0.4f},
          geometry::Capsule3{0.3f, 0.3f},
          geometry::Box{{0.4f, 0.3f, 0.5f}},
          geometry::Cylinder{0.3f, 0.4f},
          geometry::Cone{0.4f, 0.4f},
          geometry::Cone{0.3f, 0.3f, 0.1f},
          geometry::make_hull(octahedron).value(),
          geometry::make_compound(children).value()};
}

TEST(Surface, EveryBodyComesToRestOnEveryGround) {
  struct Ground {
    const char* name;
    geometry::Shape3 shape;
    Vec3d position;
  };
  const Ground grounds[] = {{"plane", geometry::Plane{}, {0, 0, 0}},
                            {"box", geometry::Box{{10, 1, 10}}, {0, -1, 0}},
                            {"mesh", flat_mesh(), {0, 0, 0}},
                            {"height field", flat_field(), {-10, 0, -10}}};
  for (const Ground& ground : grounds) {
    World3 world(world_with<Dim3>());
    const Surface rough{0.6f, 0, 1000, 0.05f};
    add_body<Dim3>(world, BodyType::fixed, ground.shape, ground.position, rough);
    std::vector<BodyId> bodies;
    int k = 0;
    for (const geometry::Shape3& shape : bodies_of_every_kind()) {
      bodies.push_back(add_body<Dim3>(world, BodyType::dynamic, shape, {-6.3 + 2.1 * k, 0.9, 0.37 * k}, rough));
      ++k;
    }
    run(world, 600);
    for (std::size_t i = 0; i < bodies.size(); ++i) {
      const BodyState<Dim3> s = world.state(bodies[i]).value();
      EXPECT_GT(s.pose.position.y, 0.05) << ground.name << ", body " << i;
      EXPECT_LT(s.pose.position.y, 0.7) << ground.name << ", body " << i;
      EXPECT_LT(math::length(s.linear_velocity), 0.05f) << ground.name << ", body " << i;
    }
    EXPECT_LT(world.worst_penetration(), 0.01f) << ground.name;
  }
}

TEST(Surface, ChainCarriesAndLetsSlide) {
  World2 world(world_with<Dim2>());
  std::vector<Vec2f> points;
  for (int i = 20; i >= -20; --i) points.push_back({float(i), 0});
  // Solid lies to the left of the direction of travel: a chain that runs to the left carries from above.
  const auto chain = geometry::make_chain(points, false).value();
  add_body<Dim2>(world, BodyType::fixed, geometry::Shape2(chain), {0, 0}, {0, 0, 1000, 0});
  const BodyId box = add_box<Dim2>(world, {15, 0.26}, 0.25f, {0, 0, 1000, 0});
  run(world, 60);
  EXPECT_NEAR(world.state(box).value().pose.position.y, 0.25, 0.01);
  ASSERT_TRUE(world.set_velocity(box, {-10, 0}, 0).ok());
  run(world, 120);
  EXPECT_NEAR(world.state(box).value().linear_velocity.x, -10, 0.1);
  EXPECT_NEAR(world.state(box).value().pose.position.y, 0.25, 0.01);
}

TEST(Surface, ABoxSlidesOverSeamsOfAMesh) {
  World3 world(world_with<Dim3>());
  add_body<Dim3>(world, BodyType::fixed, flat_mesh(), {0, 0, 0}, {0, 0, 1000, 0});
  const BodyId box =
      add_body<Dim3>(world, BodyType::dynamic, geometry::Box{{0.25f, 0.25f, 0.25f}}, {-8, 0.25, 0.3}, {0, 0, 1000, 0});
  run(world, 30);
  ASSERT_TRUE(world.set_velocity(box, {10, 0, 0}, {}).ok());
  run(world, 90);
  const BodyState<Dim3> s = world.state(box).value();
  EXPECT_NEAR(s.linear_velocity.x, 10, 0.1);
  EXPECT_NEAR(s.pose.position.y, 0.25, 0.01);
}

}  // namespace
}  // namespace carom::rigid::test
