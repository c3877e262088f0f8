// The scenes of Box3D's benchmark program, from their published recipes. Boxes are Carom's own box shape where Box3D
// has hulls.
#include "benchmarks/scene_list.h"
#include "benchmarks/suites.h"

namespace carom::bench {
namespace {
using math::Vec3d;
using math::Vec3f;

// 5 120 of the same hull of 32 points on a sphere of 2 m, dropped in a block of 8 × 8 columns.
class ConvexPile final : public Scene<Dim3> {
  void build(World3& world) override {
    add_fixed(world, {0, -1, 0}, geometry::Box{{250, 1, 250}});
    std::uint32_t state = 42;
    const auto draw = [&state] {
      state = 2147001325u * state + 715136305u;
      return double(state & 0xFFFF) / 65535.0 - 0.5;
    };
    std::vector<Vec3f> points;
    while (points.size() < 32) {
      const double x = draw(), y = draw(), z = draw();
      if (x * x + y * y + z * z > 0.25) continue;
      points.push_back(Vec3f(2.0 * math::normalize(Vec3d{x, y, z})));
    }
    const geometry::Shape3 rock = hull_of(points);
    for (int layer = 0; layer < 80; ++layer)
      for (int z = 0; z < 8; ++z)
        for (int x = 0; x < 8; ++x)
          add_body<Dim3>(world, {.position = {4.0 * (x - 4), 2.0 + 4 * layer, 4.0 * (z - 4)}}, rock, {});
  }
};

// 10 584 rocks of ten points fall into a yard in which a pillar goes round.
class Junkyard final : public Scene<Dim3> {
  void build(World3& world) override {
    const BodyId yard = add_body<Dim3>(world, {.type = BodyType::fixed});
    add_box(world, yard, {0, -1, 0}, {120, 1, 120}, {});
    for (float side : {1.0f, -1.0f}) {
      add_box(world, yard, {50 * side, 7, 0}, {1, 8, 50}, {});
      add_box(world, yard, {0, 7, 50 * side}, {50, 8, 1}, {});
    }
    std::vector<Vec3f> points;
    const double golden_ratio = 0.5 * (1 + math::sqrt(5.0));
    for (int i = 0; i < 10; ++i) {
      const double z = 1 - (2 * i + 1) / 10.0, r = math::sqrt(1 - z * z), azimuth = i * 2 * pi / golden_ratio;
      points.push_back(Vec3f(1.5 * Vec3d{r * math::cos(azimuth), r * math::sin(azimuth), z}));
    }
    const geometry::Shape3 rock = hull_of(points);
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 21; ++x)
        for (int z = 0; z < 21; ++z)
          add_body<Dim3>(world, {.position = {-40.0 + 4 * x, 25.0 + 4 * y, -40.0 + 4 * z}}, rock, {});
    std::vector<Vec3f> pillar;
    for (int i = 0; i < 16; ++i)
      for (float y : {0.0f, 24.0f})
        pillar.push_back({float(4 * math::cos(i * pi / 8)), y, float(4 * math::sin(i * pi / 8))});
    pusher_ = add_body<Dim3>(world, {.type = BodyType::kinematic, .position = {35, 0, 0}}, hull_of(pillar), {});
  }
  void before_step(World3& world, int step) override {
    const double angle = -0.1 * degree * (step + 1);
    world.set_target_pose(pusher_, {35 * math::cos(angle), 0, 35 * math::sin(angle)}, {}, 1.0f / 60.0f).value();
  }
  BodyId pusher_{};
};

// A million fixed slabs; a hundred spheres drop onto them one by one.
class LargeWorld final : public Scene<Dim3> {
  void build(World3& world) override {
    for (int i = 0; i < 1000; ++i)
      for (int k = 0; k < 1000; ++k)
        add_fixed(world, {10.0 * (k - 499.5), 0, 10.0 * (i - 499.5)}, geometry::Box{{5, 0.25f, 5}});
  }
  void before_step(World3& world, int step) override {
    if (step == 0 || step % 5 != 0 || dropped_ == 100) return;
    const int n = dropped_++;
    add_body<Dim3>(world, {.position = {-4000 + 800 * (n % 10 + 0.5), 1.5, -4000 + 800 * (n / 10 + 0.5)}},
                   geometry::Sphere{0.5f}, {});
  }
  int dropped_ = 0;
};

// Fifty trunks of 22 hexagonal prisms fall over on a wavy mesh; `fineness` cells a metre.
template <int fineness>
class Trees final : public Scene<Dim3> {
  void build(World3& world) override {
    const float cell = 1.0f / fineness;
    ShapeDef<Dim3> ground;
    add_body<Dim3>(world, {.type = BodyType::fixed},
                   terrain(150 * fineness, 200 * fineness, cell, {-75, 0, -100},
                           [cell](int i, int j) {
                             return 0.4 * math::sin(2 * pi * 0.1 * double(i) * cell) *
                                    math::sin(2 * pi * 0.05 * double(j) * cell);
                           }),
                   ground);
    std::vector<geometry::Shape3> logs;
    double base = 1;
    for (int n = 0; n < 22; ++n) {
      double radius = 0.75;
      for (int k = 0; k < n; ++k) radius *= 0.95;
      std::vector<Vec3f> points;
      for (int k = 0; k < 6; ++k)
        for (double y : {base - radius, base + 1.5 + radius})
          points.push_back(Vec3f(Vec3d{radius * math::cos(k * pi / 3), y, radius * math::sin(k * pi / 3)}));
      logs.push_back(hull_of(points));
      base += 1.5 + 2 * radius;
    }
    ShapeDef<Dim3> bark;
    bark.density = 1;
    bark.material.friction = 0.9f;
    bark.material.rolling_resistance = 0.05f;
    for (int k = 0; k < 50; ++k) {
      BodyDef<Dim3> trunk;
      trunk.position = {0, 1, -70 + 3.0 * k};
      trunk.sleep_speed = 0.2f;
      const BodyId body = add_body(world, trunk);
      for (const geometry::Shape3& log : logs) world.add_shape(body, log, bark).value();
      const Vec3f spin{0, 0, float((k % 2 == 0 ? -0.5 : 0.5) * (0.5 + 0.5 * k / 50.0))};
      const Vec3f arm = Vec3f(world.state(body).value().center_of_mass - trunk.position);
      world.set_velocity(body, math::cross(spin, arm), spin).value();
    }
  }
};

// 8 000 cubes in a turning drum with four paddles.
class Washer final : public Scene<Dim3> {
  void build(World3& world) override {
    add_fixed(world, {0, -1, 0}, geometry::Box{{60, 1, 60}});
    const BodyId drum = add_body<Dim3>(world, {.type = BodyType::kinematic,
                                               .position = {0, 21, 0},
                                               .linear_velocity = {0.001f, -0.002f, 0},
                                               .angular_velocity = {0, 0, float(25 * degree)}});
    const auto sector = [&](int i, double inner, double outer) {
      std::vector<Vec3f> points;
      for (double angle : {(10 * i - 1) * degree, (10 * i + 11) * degree})
        for (double radius : {inner, outer})
          for (double z : {-10.0, 10.0})
            points.push_back(Vec3f(Vec3d{radius * math::cos(angle), radius * math::sin(angle), z}));
      world.add_shape(drum, hull_of(points)).value();
    };
    for (int i = 0; i < 36; ++i) {
      sector(i, 16, 18);
      if (i % 9 == 0) sector(i, 14, 16);
    }
    for (int x = 0; x < 20; ++x)
      for (int y = 0; y < 20; ++y)
        for (int z = 0; z < 20; ++z)
          add_body<Dim3>(world, {.position = {-8 + 0.8 * x, 13 + 0.8 * y, -8 + 0.8 * z}},
                         geometry::Box{{0.2f, 0.2f, 0.2f}}, {});
  }
};

}  // namespace

std::unique_ptr<Scene<Dim3>> make_rain3();  // rain3.cpp

std::span<const SceneInfo> box3d_scenes() {
  static const SceneInfo scenes[] = {
      {.suite = "box3d", .name = "convex_pile", .steps = 500, .hash_steps = 60, .make3 = make<ConvexPile>},
      {.suite = "box3d",
       .name = "joint_grid",
       .steps = 100,
       .hash_steps = 60,
       .make3 = [] { return list_scene<Dim3>(joint_grid(3)); }},
      {.suite = "box3d", .name = "junkyard", .steps = 500, .hash_steps = 150, .make3 = make<Junkyard>},
      {.suite = "box3d",
       .name = "large_pyramid",
       .steps = 200,
       .hash_steps = 60,
       .make3 = [] { return list_scene<Dim3>(large_pyramid(3)); }},
      {.suite = "box3d", .name = "large_world", .steps = 500, .make3 = make<LargeWorld>},
      {.suite = "box3d",
       .name = "many_pyramids",
       .steps = 100,
       .hash_steps = 60,
       .make3 = [] { return list_scene<Dim3>(many_pyramids()); }},
      {.suite = "box3d", .name = "rain", .steps = 400, .hash_steps = 150, .make3 = make_rain3},
      {.suite = "box3d", .name = "trees100", .steps = 500, .make3 = make<Trees<1>>},
      {.suite = "box3d", .name = "trees50", .steps = 500, .make3 = make<Trees<2>>},
      {.suite = "box3d", .name = "trees25", .steps = 500, .make3 = make<Trees<4>>},
      {.suite = "box3d", .name = "washer", .steps = 1000, .hash_steps = 60, .make3 = make<Washer>},
      {.suite = "box3d",
       .name = "wide_pyramid",
       .steps = 500,
       .make3 = [] { return list_scene<Dim3>(wide_pyramid(false)); }},
  };
  return scenes;
}

}  // namespace carom::bench
