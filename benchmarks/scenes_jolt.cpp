// The scenes of Jolt's performance test, from their published recipes: damping 0.05/s, friction 0.2, density 1000.
#include "benchmarks/scene_list.h"
#include "benchmarks/suites.h"
#include "carom/math/random.h"

namespace carom::bench {
namespace {
using math::Vec3d;
using math::Vec3f;

constexpr float damping = 0.05f;  // 1/s

ShapeDef<Dim3> surface(float friction, float restitution = 0) {
  ShapeDef<Dim3> s;
  s.material.friction = friction;
  s.material.restitution = restitution;
  return s;
}
BodyDef<Dim3> falling(Vec3d position) {
  return {.position = position, .linear_damping = damping, .angular_damping = damping};
}

// 1 764 boxes, spheres, capsules and small hulls drop onto a wavy mesh.
class ConvexVsMesh final : public Scene<Dim3> {
  void build(World3& world) override {
    const auto wave = [](int i, int j) { return 5 * math::sin(50.0 * i / 100) * math::cos(50.0 * j / 100); };
    add_fixed(world, {-150, 5, -150}, terrain(100, 100, 3, {}, wave), 0.5f, 0.6f);
    const Vec3f points[] = {{0, 1, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 0, 1}, {0, 0, -1}};
    const geometry::Shape3 shapes[] = {geometry::Box{{0.5f, 0.75f, 1}}, geometry::Sphere{0.5f},
                                       geometry::Capsule3{0.75f, 0.5f}, hull_of(points)};
    for (int x = -10; x <= 10; ++x)
      for (int y = 0; y < 4; ++y)
        for (int z = -10; z <= 10; ++z)
          add_body<Dim3>(world, falling({7.5 * x, 15 + 2.0 * y, 7.5 * z}), shapes[y], surface(0.5f, 0.6f));
  }
};

// 5 000 bodies at 250 m/s in a hollow cube of thin walls.
class HighSpeed final : public Scene<Dim3> {
  void build(World3& world) override {
    const BodyId walls = add_body<Dim3>(world, {.type = BodyType::fixed});
    for (float side : {-50.0f, 50.0f}) {
      add_box(world, walls, {side, 0, 0}, {0.1f, 50, 50}, surface(1, 1));
      add_box(world, walls, {0, side, 0}, {50, 0.1f, 50}, surface(1, 1));
      add_box(world, walls, {0, 0, side}, {50, 50, 0.1f}, surface(1, 1));
    }
    math::Random random(1);
    for (int i = 0; i < 5000; ++i) {
      const auto place = [&random] { return random.uniform(-45.0, 45.0); };
      const double x = place(), y = place(), z = place();
      BodyDef<Dim3> body = falling({x, y, z});
      body.rotation = math::Quatf(random.rotation());
      body.linear_velocity = Vec3f(250.0 * random.on_sphere());
      body.bullet = true;
      const float friction = random.uniform(0.5f, 1.0f);
      ShapeDef<Dim3> s = surface(friction, random.uniform(0.9f, 1.0f));
      const BodyId id = add_body(world, body);
      if (i % 3 == 0) {
        world.add_shape(id, geometry::Sphere{0.5f}, s).value();
      } else if (i % 3 == 1) {
        world.add_shape(id, geometry::Box{{0.25f, 0.5f, 0.5f}}, s).value();
      } else {
        s.local.p = {0, 0.5f, 0};
        world.add_shape(id, geometry::Capsule3{0.5f, 0.125f}, s).value();
        add_box(world, id, {0.5f, 0, 0}, {0.5f, 0.125f, 0.125f}, s);
      }
    }
  }
};

// 4 410 boxes drop onto a mountainous mesh of cells² × 2 triangles of a metre.
template <int cells>
class LargeMesh final : public Scene<Dim3> {
  void build(World3& world) override {
    const auto mountains = [](int i, int j) { return 50 * math::sin(50.0 * i / cells) * math::cos(50.0 * j / cells); };
    add_fixed(world, {}, terrain(cells, cells, 1, {-0.5f * cells, 0, -0.5f * cells}, mountains), 0.5f, 0.6f);
    for (int x = -10; x <= 10; ++x)
      for (int y = 0; y < 10; ++y)
        for (int z = -10; z <= 10; ++z)
          add_body<Dim3>(world, falling({7.5 * x, 55 + 2.0 * y, 7.5 * z}), geometry::Box{{0.5f, 0.75f, 1}},
                         surface(0.5f, 0.6f));
  }
};

}  // namespace

std::unique_ptr<Scene<Dim3>> make_characters();           // characters_jolt.cpp
std::unique_ptr<Scene<Dim3>> make_ragdolls();             // ragdolls_jolt.cpp
std::unique_ptr<Scene<Dim3>> make_ragdoll_single_pile();  // ragdolls_jolt.cpp

std::span<const SceneInfo> jolt_scenes() {
  static const SceneInfo scenes[] = {
      {.suite = "jolt", .name = "pyramid", .steps = 500, .make3 = [] { return list_scene<Dim3>(wide_pyramid(true)); }},
      {.suite = "jolt", .name = "convex_vs_mesh", .steps = 500, .hash_steps = 120, .make3 = make<ConvexVsMesh>},
      {.suite = "jolt", .name = "high_speed", .steps = 500, .hash_steps = 60, .make3 = make<HighSpeed>},
      {.suite = "jolt",
       .name = "character_virtual",
       .steps = 500,
       .hash_steps = 120,
       .acts = true,
       .make3 = make_characters},
      {.suite = "jolt",
       .name = "ragdoll",
       .steps = 500,
       .hash_steps = 60,
       .missing = "stand-in figure and terrain",
       .make3 = make_ragdolls},
      {.suite = "jolt",
       .name = "ragdoll_single_pile",
       .steps = 500,
       .missing = "stand-in figure and terrain",
       .make3 = make_ragdoll_single_pile},
      {.suite = "jolt", .name = "large_mesh_500", .steps = 500, .make3 = make<LargeMesh<500>>},
      {.suite = "jolt", .name = "large_mesh_1000", .steps = 500, .make3 = make<LargeMesh<1000>>},
  };
  return scenes;
}

}  // namespace carom::bench
