// The scenes on which other engines were measured first (rigid-body.md 6.2): what Carom does on them, at its defaults.
// bench_quality has them too, beside the peers.
#include <cmath>

#include "tests/quality/chain.h"
#include "tests/quality/gate.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::quality {
namespace peers {

using namespace carom::rigid;
using namespace carom::rigid::test;

double sag_of_stack(int n) {
  World3 world(world_with<Dim3>());
  add_ground(world, {0.6f, 0, 1, 0});
  BodyId top{};
  for (int i = 0; i < n; ++i) top = add_box<Dim3>(world, {0, 0.5 + i, 0}, 0.5f, {0.6f, 0, 1, 0});
  run(world, 900);
  return n - 0.5 - world.state(top).value().pose.position.y;
}
double sag_of_heavy_top(int ratio) {
  World3 world(world_with<Dim3>());
  add_ground(world, {0.6f, 0, 1, 0});
  BodyId top{};
  for (int i = 0; i < 4; ++i)
    top = add_box<Dim3>(world, {0, 0.5 + i, 0}, 0.5f, {0.6f, 0, i == 3 ? float(ratio) : 1.0f, 0});
  run(world, 600);
  return 3.5 - world.state(top).value().pose.position.y;
}

TEST(QualityPeers, ScenesOfTheComparison) {
  int tallest = 0;
  for (const int n : {5, 10, 12, 15, 20, 25, 30, 40, 50, 60})
    if (sag_of_stack(n) < 0.5) tallest = n;
  EXPECT_GE(tallest, 40);

  int heaviest = 1;
  for (const int ratio : {3, 10, 30, 100, 300, 1000, 3000, 10000})
    if (sag_of_heavy_top(ratio) < 0.3) heaviest = ratio;
  EXPECT_GE(heaviest, 100);

  Chain<Dim3> light(20, 100), heavy(20, 1000);
  light.run(15);
  heavy.run(15);
  EXPECT_LT(std::max(light.worst_gap, heavy.worst_gap), 0.01);

  {
    WorldDef<Dim3> d = world_with<Dim3>();
    const double a = std::atan(0.98 * 0.5);
    d.gravity = {float(9.81 * std::sin(a)), float(-9.81 * std::cos(a)), 0};
    World3 world(d);
    add_ground(world, {0.5f, 0, 1, 0});
    const BodyId box = add_box<Dim3>(world, {0, 0.5, 0}, 0.5f, {0.5f, 0, 1, 0});
    run(world, 300);
    const double creep = world.state(box).value().pose.position.x;
    EXPECT_LT(creep, 1e-4);  // friction has taken back what slipped before the box sleeps
  }
  {
    World3 world(world_with<Dim3>(0));
    BodyDef<Dim3> d;
    d.angular_velocity = {0.01f, 5, 0.01f};
    const BodyId body = world.create_body(d).value();
    world.add_shape(body, geometry::Box{{1, 0.5f, 0.15f}}).value();
    const double before = world.totals().kinetic_energy;
    int flips = 0;
    float last = 5;
    for (int i = 0; i < 3600; ++i) {
      world.step(frame).value();
      const BodyState<Dim3> s = world.state(body).value();
      const float wy = inverse_rotate(s.pose.rotation, s.angular_velocity).y;
      flips += wy * last < 0;
      last = wy;
    }
    const double energy = 100 * (world.totals().kinetic_energy / before - 1);
    EXPECT_EQ(flips, 13);
    EXPECT_LT(std::abs(energy), 0.1);
  }
  {
    const auto lost = [](const geometry::Shape3& shape, double height, Quatf rotation) {
      World3 world(world_with<Dim3>());
      for (int i = -2; i < 48; ++i)
        for (int j = -1; j < 2; ++j)
          add_body<Dim3>(world, BodyType::fixed, geometry::Box{{0.5f, 0.5f, 0.5f}}, {double(i), -0.5, double(j)},
                         {0, 0, 1, 0});
      BodyDef<Dim3> body;
      body.position = {0, height, 0};
      body.rotation = rotation;
      body.linear_velocity = {10, 0, 0};
      const BodyId id = world.create_body(body).value();
      ShapeDef<Dim3> def;
      def.material.friction = 0;
      world.add_shape(id, shape, def).value();
      run(world, 240);
      return std::abs(10 * (10 - double(world.state(id).value().linear_velocity.x)));
    };
    const double box = lost(geometry::Box{{0.25f, 0.25f, 0.25f}}, 0.25, normalize(Quatf{0.98877f, 0, 0.14944f, 0})),
                 ball = lost(geometry::Sphere{0.3f}, 0.3, {}),
                 capsule = lost(geometry::Capsule3{0.3f, 0.3f}, 0.3, normalize(Quatf{1, 1, 0, 0}));
    EXPECT_LT(std::max({box, ball, capsule}), 0.1);
  }
  {
    World3 world(world_with<Dim3>(0));
    add_body<Dim3>(world, BodyType::fixed, geometry::Box{{0.05f, 2, 2}}, {0, 0, 0});
    const BodyId ball = add_ball<Dim3>(world, {-3, 0, 0}, 0.05f, {}, {300, 0, 0});
    run(world, 60);
    const bool stops = world.state(ball).value().pose.position.x < 0;
    EXPECT_TRUE(stops);
  }
  {
    World3 world(world_with<Dim3>());
    add_ground(world, {0.5f, 0, 1, 0});
    const BodyId box = add_box<Dim3>(world, {0, 0.5, 0}, 0.5f, {0.5f, 0, 1, 0});
    run(world, 30);
    const double start = world.state(box).value().pose.position.x;
    world.set_velocity(box, {5, 0, 0}, {}).value();
    run(world, 180);
    const double way = world.state(box).value().pose.position.x - start;
    EXPECT_NEAR(way, 2.548, 0.02548);
  }
}

}  // namespace peers
}  // namespace carom::quality
