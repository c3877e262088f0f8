// The scenes of Box2D's benchmark program, from their published recipes.
#include "benchmarks/scene_list.h"
#include "benchmarks/suites.h"

namespace carom::bench {
namespace {
using math::Vec2d;
using math::Vec2f;

ShapeDef<Dim2> surface2(float density, float friction = 0.6f) {
  ShapeDef<Dim2> s;
  s.density = density;
  s.material.friction = friction;
  return s;
}
BodyId fixed_body(World2& world) { return add_body<Dim2>(world, {.type = BodyType::fixed}); }

// Quads about the origin between two radii: ten degrees and one more on both sides.
void add_sector(World2& world, BodyId body, int i, double inner, double outer) {
  Vec2f corners[4];
  int n = 0;
  for (double angle : {(10 * i - 1) * degree, (10 * i + 11) * degree})
    for (double radius : {inner, outer})
      corners[n++] = Vec2f(Vec2d{radius * math::cos(angle), radius * math::sin(angle)});
  world.add_shape(body, geometry::make_polygon(corners).value(), surface2(1)).value();
}

// 3 000 bodies of two triangles fall into a bin.
class Compounds final : public Scene<Dim2> {
  void build(World2& world) override {
    const BodyId bin = fixed_body(world);
    for (int x = -40; x <= 40; ++x) add_box(world, bin, {float(x), 0}, {0.55f, 0.5f}, surface2(1));
    for (float side : {-40.0f, 40.0f})
      for (int y = 1; y <= 100; ++y) add_box(world, bin, {side, float(y)}, {0.5f, 0.55f}, surface2(1));
    world.add_shape(bin, geometry::Segment{{-800, -80}, {800, -80}}, surface2(1)).value();
    const Vec2f left[] = {{-1, 0}, {0.5f, 1}, {0, 2}}, right[] = {{1, 0}, {-0.5f, 1}, {0, 2}};
    const geometry::Shape2 halves[] = {geometry::make_polygon(left).value(), geometry::make_polygon(right).value()};
    int n = 0;
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 150; ++j) {
        const double shift = n++ % 2 == 0 ? -0.25 : 0.25;
        const BodyId body = add_body<Dim2>(world, {.position = {2.0 * i - 19 + shift, 2.25 * j + 5.575}});
        for (const geometry::Shape2& half : halves) world.add_shape(body, half, surface2(1, 0.5f)).value();
      }
  }
};

// 8 000 pentagons on a floor that a box sweeps.
class Junkyard2 final : public Scene<Dim2> {
  void build(World2& world) override {
    const BodyId yard = fixed_body(world);
    for (int x = -80; x <= 80; ++x) add_box(world, yard, {float(x), 0}, {0.55f, 0.5f}, surface2(1));
    for (float side : {-80.0f, 80.0f})
      for (int y = 1; y <= 50; ++y) add_box(world, yard, {side, float(y)}, {0.5f, 0.55f}, surface2(1));
    Vec2f corners[5];
    for (int k = 0; k < 5; ++k)
      corners[k] = Vec2f(Vec2d{0.25 * math::cos(k * 72 * degree), 0.25 * math::sin(k * 72 * degree)});
    const geometry::Shape2 pentagon = geometry::make_polygon(corners).value();
    int n = 0;
    for (int i = 0; i < 200; ++i)
      for (int j = 0; j < 40; ++j) {
        const double shift = n++ % 2 == 0 ? -0.1 : 0.1;
        add_body<Dim2>(world, {.position = {0.375 * (2 * i - 200) + shift, 15.0 + j}}, pentagon, surface2(1));
      }
    pusher_ = add_body<Dim2>(world, {.type = BodyType::kinematic, .position = {0, 4}}, geometry::make_box2({2, 4}),
                             surface2(1));
  }
  void before_step(World2& world, int step) override {
    const double time = (step + 1) / 60.0;
    world.set_target_pose(pusher_, {60 * math::sin(0.2 * time), 4}, {}, 1.0f / 60.0f).value();
  }
  BodyId pusher_{};
};

// 20 × 20 pyramids of 55 unit boxes, one floor above another.
class ManyPyramids final : public Scene<Dim2> {
  void define(rigid::WorldDef<Dim2>& definition) override { definition.allow_sleep = false; }
  void build(World2& world) override {
    const BodyId floors = fixed_body(world);
    for (int i = 0; i < 20; ++i)
      world.add_shape(floors, geometry::Segment{{-115, 11.0f * float(i)}, {115, 11.0f * float(i)}}, surface2(1))
          .value();
    for (int i = 0; i < 20; ++i)
      for (int j = 0; j < 20; ++j)
        for (int row = 0; row < 10; ++row)
          for (int column = row; column < 10; ++column)
            add_body<Dim2>(world,
                           {.position = {0.5 * (row + 1) + (column - row) - 0.5 - 109 + 11 * j, row + 0.5 + 11 * i}},
                           geometry::make_box2({0.5f, 0.5f}), surface2(1));
  }
};

// A block of 9 600 sleeping boxes is hit by a big one, without gravity.
class Smash final : public Scene<Dim2> {
  void define(rigid::WorldDef<Dim2>& definition) override { definition.gravity = {}; }
  void build(World2& world) override {
    add_body<Dim2>(world, {.position = {-20, 0}, .linear_velocity = {40, 0}}, geometry::make_box2({4, 4}), surface2(8));
    for (int i = 0; i < 120; ++i)
      for (int j = 0; j < 80; ++j)
        add_body<Dim2>(world, {.position = {30 + 0.4 * i, 0.4 * (j - 40)}, .awake = false},
                       geometry::make_box2({0.2f, 0.2f}), surface2(1));
  }
};

// A rounded bar of 40 m turns in a ring full of small bodies.
class Spinner final : public Scene<Dim2> {
  void build(World2& world) override {
    std::vector<Vec2f> ring;
    for (int i = 0; i < 360; ++i)
      ring.push_back(Vec2f(Vec2d{40 * math::cos(i * degree), 32 - 40 * math::sin(i * degree)}));
    const BodyId ground = fixed_body(world);
    world.add_shape(ground, geometry::make_chain(ring, true).value(), surface2(1, 0.1f)).value();
    const BodyId bar = add_body<Dim2>(world, {.position = {0, 12}, .sleep_speed = 0},
                                      geometry::make_box2({0.4f, 20}, 0.2f), surface2(1, 0));
    rigid::HingeJointDef<Dim2> hub;
    hub.body_a = ground, hub.body_b = bar;
    hub.frame_a.p = {0, 12};
    hub.motor = {true, 5, 1e9f};
    world.create_joint(hub).value();

    ShapeDef<Dim2> s = surface2(0.25f, 0.1f);
    s.material.restitution = 0.1f;
    ShapeDef<Dim2> lying = s;
    lying.local.q = {0, 1};
    double x = -23, y = 2;
    for (int i = 0; i < 6076; ++i) {
      const BodyId body = add_body<Dim2>(world, {.position = {x, y}});
      if (i % 3 == 0)
        world.add_shape(body, geometry::Capsule2{0.25f, 0.25f}, lying).value();
      else if (i % 3 == 1)
        world.add_shape(body, geometry::Circle{0.35f}, s).value();
      else
        world.add_shape(body, geometry::make_box2({0.35f, 0.35f}), s).value();
      x += 0.5;
      if (x >= 23) x = -23, y += 0.5;
    }
  }
};

// 2 025 small boxes in a box that a motor turns.
class Tumbler final : public Scene<Dim2> {
  void build(World2& world) override {
    const BodyId ground = fixed_body(world);
    const BodyId drum = add_body<Dim2>(world, {.position = {0, 10}});
    for (float side : {10.0f, -10.0f}) {
      add_box(world, drum, {side, 0}, {0.5f, 10}, surface2(50));
      add_box(world, drum, {0, side}, {10, 0.5f}, surface2(50));
    }
    rigid::HingeJointDef<Dim2> hub;
    hub.body_a = ground, hub.body_b = drum;
    hub.frame_a.p = {0, 10};
    hub.motor = {true, float(25 * degree), 1e8f};
    world.create_joint(hub).value();
    for (int i = 0; i < 45; ++i)
      for (int j = 0; j < 45; ++j)
        add_body<Dim2>(world, {.position = {-9 + 0.4 * i, 1 + 0.4 * j}}, geometry::make_box2({0.125f, 0.125f}),
                       surface2(1));
  }
};

// 8 100 small boxes in a turning ring with four paddles.
class Washer2 final : public Scene<Dim2> {
  void build(World2& world) override {
    fixed_body(world);
    const BodyId ring = add_body<Dim2>(world, {.type = BodyType::kinematic,
                                               .position = {0, 10},
                                               .linear_velocity = {0.001f, -0.002f},
                                               .angular_velocity = float(25 * degree)});
    for (int i = 0; i < 36; ++i) {
      add_sector(world, ring, i, 16, 18);
      if (i % 9 == 0) add_sector(world, ring, i, 14, 16);
    }
    ShapeDef<Dim2> s = surface2(1);
    s.hit_events = true;
    for (int i = 0; i < 90; ++i)
      for (int j = 0; j < 90; ++j)
        add_body<Dim2>(world, {.position = {-9.9 + 0.21 * i, 0.1 + 0.21 * j}}, geometry::make_box2({0.1f, 0.1f}), s);
  }
};

}  // namespace

std::unique_ptr<Scene<Dim2>> make_rain2();  // rain2.cpp

std::span<const SceneInfo> box2d_scenes() {
  static const SceneInfo scenes[] = {
      {.suite = "box2d", .name = "compounds", .steps = 500, .hash_steps = 120, .make2 = make<Compounds>},
      {.suite = "box2d",
       .name = "joint_grid",
       .steps = 500,
       .hash_steps = 60,
       .make2 = [] { return list_scene<Dim2>(joint_grid(2)); }},
      {.suite = "box2d", .name = "junkyard", .steps = 800, .hash_steps = 120, .make2 = make<Junkyard2>},
      {.suite = "box2d",
       .name = "large_pyramid",
       .steps = 500,
       .hash_steps = 60,
       .make2 = [] { return list_scene<Dim2>(large_pyramid(2)); }},
      {.suite = "box2d", .name = "many_pyramids", .steps = 200, .hash_steps = 30, .make2 = make<ManyPyramids>},
      {.suite = "box2d", .name = "rain", .steps = 1000, .hash_steps = 150, .make2 = make_rain2},
      {.suite = "box2d", .name = "smash", .steps = 300, .hash_steps = 120, .make2 = make<Smash>},
      {.suite = "box2d", .name = "spinner", .steps = 500, .make2 = make<Spinner>},
      {.suite = "box2d", .name = "tumbler", .steps = 750, .hash_steps = 120, .make2 = make<Tumbler>},
      {.suite = "box2d", .name = "washer", .steps = 500, .hash_steps = 60, .make2 = make<Washer2>},
  };
  return scenes;
}

}  // namespace carom::bench
