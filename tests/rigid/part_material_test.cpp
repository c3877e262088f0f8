// Parts of one surface of different materials: triangles of a mesh, cells of a height field, segments of a chain.
#include <gtest/gtest.h>

#include "carom/geometry/height_field.h"
#include "carom/geometry/triangle_mesh.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

constexpr float ice = 0.05f, asphalt = 0.8f;  ///< Coulomb's μ against a body of μ = 1
constexpr float gravity = 9.81f;

/// What two materials a road has: number 0 for x < 0, number 1 beyond. Against μ = 1 friction mixes to √μ.
template <class D>
std::vector<rigid::SurfaceMaterial<D>> road_surfaces() {
  return {{{.friction = ice * ice, .user_id = 7}, {}}, {{.friction = asphalt * asphalt, .user_id = 8}, {}}};
}

geometry::Shape3 road_mesh() {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  std::vector<std::uint8_t> materials;
  for (int i = 0; i <= 40; ++i)
    for (int j = 0; j <= 4; ++j) vertices.push_back({float(i - 20), 0, float(j - 2)});
  for (std::uint32_t i = 0; i < 40; ++i)
    for (std::uint32_t j = 0; j < 4; ++j) {
      const std::uint32_t a = 5 * i + j, b = a + 1, c = a + 5, d = c + 1;
      for (const std::uint32_t k : {a, b, d, a, d, c}) indices.push_back(k);
      materials.insert(materials.end(), 2, std::uint8_t(i < 20 ? 0 : 1));
    }
  return geometry::make_triangle_mesh(vertices, indices, materials).value();
}
geometry::Shape3 road_field() {
  std::vector<std::uint8_t> materials;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 40; ++i) materials.push_back(std::uint8_t(i < 20 ? 0 : 1));
  return geometry::make_height_field(41, 5, {1, 1}, std::vector<float>(41 * 5, 0.0f), {}, materials).value();
}
geometry::Shape2 road_chain() {
  std::vector<Vec2f> points;  // solid lies to the left of the travel: from right to left, above is free
  std::vector<std::uint8_t> materials;
  for (int i = 40; i >= 0; --i) points.push_back({float(i - 20), 0});
  for (int i = 39; i >= 0; --i) materials.push_back(std::uint8_t(i < 20 ? 0 : 1));
  return geometry::make_chain(points, false, materials).value();
}

/// A box slides from the ice onto the asphalt: μg on each, the whole way of v²/2μg at the end.
template <class D>
void slide_over(const typename D::Shape& road, typename D::Position place) {
  World<D> world(world_with<D>(gravity));
  BodyDef<D> ground;
  ground.type = BodyType::fixed;
  ground.position = place;
  ShapeDef<D> d;
  d.surfaces = road_surfaces<D>();
  world.add_shape(world.create_body(ground).value(), road, d).value();
  const BodyId box = add_body<D>(world, BodyType::dynamic, box_shape<D>(0.4f, 0.2f, 0.3f), at<D>(-12, 0.2, 0.31),
                                 {.friction = 1}, along<D>(8, 0));
  const auto speed_and_place = [&] {
    const BodyState<D> s = world.state(box).value();
    return std::pair{double(s.linear_velocity.x), s.pose.position.x};
  };
  run(world, 10);
  const auto [v0, x0] = speed_and_place();
  run(world, 60);
  const auto [v1, x1] = speed_and_place();
  ASSERT_LT(x1, -0.4);
  EXPECT_NEAR((v0 - v1) / 1.0, double(ice * gravity), 0.01 * double(ice * gravity)) << "on the ice";
  while (speed_and_place().second < 0.45) world.step(frame).value();
  const auto [v2, x2] = speed_and_place();
  run(world, 12);
  const auto [v3, x3] = speed_and_place();
  EXPECT_NEAR((v2 - v3) / 0.2, double(asphalt * gravity), 0.01 * double(asphalt * gravity)) << "on the asphalt";
  run(world, 120);
  const auto [v4, x4] = speed_and_place();
  EXPECT_NEAR(v4, 0, 1e-4);
  const double way = v2 * v2 / (2 * double(asphalt * gravity));
  EXPECT_NEAR(x4 - x2, way, 0.015 * way);
}

TEST(PartMaterial, ABoxSlowsDownAsTheTrianglesUnderItSay) { slide_over<Dim3>(road_mesh(), {0, 0, 0}); }
TEST(PartMaterial, ABoxSlowsDownAsTheCellsUnderItSay) { slide_over<Dim3>(road_field(), {-20, 0, -2}); }
TEST(PartMaterial, ABoxSlowsDownAsTheSegmentsUnderItSay) { slide_over<Dim2>(road_chain(), {0, 0}); }

/// The road with what a test wants on both halves.
struct Road {
  World3 world{world_with<Dim3>(gravity)};
  ShapeId shape;
  explicit Road(std::vector<rigid::SurfaceMaterial<Dim3>> surfaces, bool hits = false) {
    const BodyId ground = world.create_body({.type = BodyType::fixed}).value();
    shape = world.add_shape(ground, road_mesh(), {.surfaces = std::move(surfaces), .hit_events = hits}).value();
  }
};

TEST(PartMaterial, BallsBounceAndRollAsTheTrianglesUnderThemSay) {
  Road road({{{.friction = 0.6f, .restitution = 0.8f}, {}}, {{.friction = 0.6f, .rolling_resistance = 0.05f}, {}}});
  const BodyId bouncing = add_ball<Dim3>(road.world, {-10, 2.25, 0.3}, 0.25f);
  const BodyId dead = add_ball<Dim3>(road.world, {10, 2.25, 0.3}, 0.25f);
  double highest[2] = {0, 0};
  for (int i = 0; i < 90; ++i) {
    road.world.step(frame).value();
    for (int k = 0; k < 2; ++k) {
      const BodyState<Dim3> s = road.world.state(k == 0 ? bouncing : dead).value();
      if (i > 42) highest[k] = std::max(highest[k], s.pose.position.y - 0.25);
    }
  }
  EXPECT_NEAR(highest[0], 2 * 0.8 * 0.8, 0.02 * 2 * 0.64) << "e²h";
  EXPECT_LT(highest[1], 0.01);
  // Rolling: m a (1 + 2/5) = c m g, so that a = 5/7 c g; nothing on the other half.
  const BodyId slow = add_ball<Dim3>(road.world, {4, 0.25, -0.7}, 0.25f, {}, {3, 0, 0});
  const BodyId free = add_ball<Dim3>(road.world, {-14, 0.25, -0.7}, 0.25f, {}, {3, 0, 0});
  road.world.set_velocity(slow, {3, 0, 0}, {0, 0, -12}).value();
  road.world.set_velocity(free, {3, 0, 0}, {0, 0, -12}).value();
  run(road.world, 10);
  const float v0 = speed(road.world, slow), w0 = speed(road.world, free);
  run(road.world, 60);
  EXPECT_NEAR(v0 - speed(road.world, slow), 5.0f / 7.0f * 0.05f * gravity, 0.02f * 5.0f / 7.0f * 0.05f * gravity);
  EXPECT_NEAR(speed(road.world, free), w0, 2e-3f);
}

TEST(PartMaterial, APartRunsAsABelt) {
  Road road({{{.friction = 0.6f}, {}}, {{.friction = 0.6f}, {0, 0, 1.5f}}});
  const BodyId still = add_box<Dim3>(road.world, {-10, 0.25, 0}, 0.25f);
  const BodyId carried = add_box<Dim3>(road.world, {10, 0.25, -1.2}, 0.25f);
  run(road.world, 60);
  EXPECT_LT(speed(road.world, still), 1e-3f);
  EXPECT_NEAR(road.world.state(carried).value().linear_velocity.z, 1.5f, 0.015f);
  road.world.set_surface(road.shape, 1, {{.friction = 0.6f}, {}}).value();
  run(road.world, 60);
  EXPECT_LT(speed(road.world, carried), 1e-3f);
}

TEST(PartMaterial, EventsContactsAndRaysNameThePart) {
  Road road(road_surfaces<Dim3>(), true);
  for (const double x : {-10.0, 10.0}) add_ball<Dim3>(road.world, {x, 2, 0.3}, 0.25f);
  std::vector<std::uint32_t> begun, hit;
  for (int i = 0; i < 60; ++i) {
    road.world.step(frame).value();
    const Events<Dim3> events = road.world.events();
    for (const ContactBeginEvent& e : events.contact_begin)
      begun.push_back(e.shape_a == road.shape ? e.material_a : e.material_b);
    for (const ContactHitEvent<Dim3>& e : events.contact_hit)
      hit.push_back(e.shape_a == road.shape ? e.material_a : e.material_b);
  }
  std::sort(begun.begin(), begun.end());
  std::sort(hit.begin(), hit.end());
  EXPECT_EQ(begun, (std::vector<std::uint32_t>{7, 8}));
  EXPECT_EQ(hit, (std::vector<std::uint32_t>{7, 8}));
  std::vector<ContactView<Dim3>> contacts;
  road.world.contacts(contacts);
  ASSERT_EQ(contacts.size(), 2u);
  for (const ContactView<Dim3>& c : contacts)
    EXPECT_EQ(c.shape_a == road.shape ? c.material_a : c.material_b, c.points[0].point.x < 0 ? 7u : 8u);
  for (const double x : {-5.0, 5.0}) {
    const RayHit<Dim3> ray = road.world.ray_cast({x, 3, 0.2}, {0, -4, 0}).value();
    ASSERT_EQ(ray.shape, road.shape);
    EXPECT_EQ(ray.material, x < 0 ? 7u : 8u);
  }
}

TEST(PartMaterial, APairRuleHoldsForOnePart) {
  Road road({{{.friction = 1, .user_id = 7}, {}}, {{.friction = 1, .user_id = 8}, {}}});
  const PairRule frictionless{.friction = 0};
  road.world.set_pair_rule(8, 0, &frictionless).value();  // bodies have the id 0
  const BodyId rough = add_body<Dim3>(road.world, BodyType::dynamic, box_shape<Dim3>(0.3f, 0.3f, 0.3f), {-10, 0.3, 0},
                                      {.friction = 1}, {2, 0, 0});
  const BodyId smooth = add_body<Dim3>(road.world, BodyType::dynamic, box_shape<Dim3>(0.3f, 0.3f, 0.3f), {5, 0.3, 0},
                                       {.friction = 1}, {2, 0, 0});
  run(road.world, 60);
  EXPECT_LT(speed(road.world, rough), 1e-3f);
  EXPECT_NEAR(speed(road.world, smooth), 2.0f, 2e-3f);
}

TEST(PartMaterial, SnapshotsCarryTheSurfaces) {
  Road road(road_surfaces<Dim3>());
  const BodyId box = add_body<Dim3>(road.world, BodyType::dynamic, box_shape<Dim3>(0.4f, 0.2f, 0.3f), {-2, 0.2, 0.31},
                                    {.friction = 1}, {8, 0, 0});
  run(road.world, 5);
  const Snapshot<Dim3> before = road.world.snapshot();
  run(road.world, 60);
  const std::uint64_t expected = road.world.state_hash();
  road.world.set_surface(road.shape, 0, {{.friction = 2}, {}}).value();
  road.world.restore(Snapshot<Dim3>::decode(before.encode(), {}).value()).value();
  EXPECT_EQ(road.world.shape_definition(road.shape).value().surfaces, road_surfaces<Dim3>());
  run(road.world, 60);
  EXPECT_EQ(road.world.state_hash(), expected);
  EXPECT_TRUE(road.world.contains(box));
}

TEST(PartMaterial, WhatDoesNotFitIsNamed) {
  World3 world;
  const BodyId ground = world.create_body({.type = BodyType::fixed}).value();
  const auto message = [&](const geometry::Shape3& shape, std::vector<rigid::SurfaceMaterial<Dim3>> surfaces) {
    const Result<ShapeId> r = world.add_shape(ground, shape, {.surfaces = std::move(surfaces)});
    return r.ok() ? std::string("accepted") : r.error().message;
  };
  EXPECT_NE(message(road_mesh(), {{}}).find("surfaces has 1 entries, expected 2 to 256"), std::string::npos);
  EXPECT_NE(message(geometry::Box{}, {{}}).find("expected none"), std::string::npos);
  EXPECT_NE(message(road_mesh(), {{}, {{.friction = -1}, {}}}).find("surfaces[1].material.friction"),
            std::string::npos);
  EXPECT_EQ(message(road_mesh(), {}), "accepted") << "all of the shape's own material";
  const ShapeId road = world.add_shape(ground, road_mesh(), {.surfaces = road_surfaces<Dim3>()}).value();
  EXPECT_NE(world.set_surface(road, 2, {}).error().message.find("index is 2"), std::string::npos);
  const std::vector<Vec3f> corners{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}};
  EXPECT_NE(geometry::make_triangle_mesh(corners, {0, 1, 2}, {0, 1}).error().message.find("2 materials"),
            std::string::npos);
  EXPECT_NE(geometry::make_height_field(2, 2, {1, 1}, {0, 0, 0, 0}, {}, {0, 1}).error().message.find("2 materials"),
            std::string::npos);
  EXPECT_NE(geometry::make_chain({{0, 0}, {1, 0}}, false, {0, 1}).error().message.find("2 materials"),
            std::string::npos);
}

}  // namespace
}  // namespace carom::rigid::test
