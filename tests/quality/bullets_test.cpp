// Gate 15 (rigid-body.md 6.1): 10 000 bodies in each dimension fly at 400 m/s against walls of .1 m, fixed and moving,
// thin meshes (chains) and each other, or are rods that turn at 50 rad/s; none passes. Sensors see what flies through.
#include <algorithm>
#include <cmath>
#include <vector>

#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "tests/quality/gate.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::quality {
namespace bullets {

using namespace carom::rigid;
using namespace carom::rigid::test;

template <class D>
class QualityBullets : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(QualityBullets, Dimensions);

constexpr int lanes = 500;  ///< of every case, 4 m apart
constexpr double pitch = 4;

/// Sphere, box, capsule, and hull (2D: a triangle), all about .1 m.
template <class D>
typename D::Shape bullet_shape(int kind) {
  if constexpr (D::dimension == 2) {
    const Vec2f corners[3] = {{-0.05f, -0.05f}, {0.07f, 0}, {-0.05f, 0.05f}};
    if (kind == 0) return geometry::Circle{0.05f};
    if (kind == 1) return geometry::make_box2({0.05f, 0.03f});
    if (kind == 2) return geometry::Capsule2{0.05f, 0.03f};
    return geometry::make_polygon(corners).value();
  } else {
    const Vec3f corners[6] = {{0.07f, 0, 0},  {-0.05f, 0, 0}, {0, 0.05f, 0},
                              {0, -0.05f, 0}, {0, 0, 0.05f},  {0, 0, -0.05f}};
    if (kind == 0) return geometry::Sphere{0.05f};
    if (kind == 1) return geometry::Box{{0.05f, 0.03f, 0.04f}};
    if (kind == 2) return geometry::Capsule3{0.05f, 0.03f};
    return geometry::make_hull(corners).value();
  }
}
const char* const kinds[] = {"spheres", "boxes", "capsules", "hulls"};

double lane(int i) { return pitch * (i - lanes / 2); }
/// A start 2 to 9 m off that meets every phase of the step.
double away(int i) { return 2 + 0.0137 * i; }

template <class D>
BodyId fire(World<D>& world, int kind, int i, double direction, bool bullet, double speed = 400) {
  BodyDef<D> d;
  d.position = rigid::test::at<D>(-direction * away(i), lane(i));
  d.linear_velocity = rigid::test::along<D>(float(direction * speed), 0);
  d.rotation = turned<D>(0.37 * i);
  d.bullet = bullet;
  const BodyId id = world.create_body(d).value();
  world.add_shape(id, bullet_shape<D>(kind)).value();
  return id;
}

// 4 kinds × 500 lanes.
TYPED_TEST(QualityBullets, FixedWall) {
  using D = TypeParam;
  int passed = 0;
  for (int kind = 0; kind < 4; ++kind) {
    World<D> world(world_with<D>(0));
    add_body<D>(world, BodyType::fixed, box_shape<D>(0.05f, 1100, 5), rigid::test::at<D>(0, 0));
    std::vector<BodyId> all;
    for (int i = 0; i < lanes; ++i) all.push_back(fire<D>(world, kind, i, 1, false));
    run(world, 30);
    for (const BodyId b : all) passed += world.state(b).value().pose.position.x > 0;
  }
  Gate(15, "2 000 bodies at 400 m/s, fixed wall of .1 m: passed", D::dimension).exactly(passed, 0);
}

// No force moves the wall; it comes to meet them with a tenth of their speed.
TYPED_TEST(QualityBullets, DrivenWall) {
  using D = TypeParam;
  int passed = 0;
  for (int kind = 0; kind < 4; ++kind) {
    World<D> world(world_with<D>(0));
    const BodyId wall = add_body<D>(world, BodyType::kinematic, box_shape<D>(0.05f, 1100, 5), rigid::test::at<D>(0, 0),
                                    {}, rigid::test::along<D>(-40, 0));
    std::vector<BodyId> all;
    for (int i = 0; i < lanes; ++i) all.push_back(fire<D>(world, kind, i, 1, false));
    run(world, 30);
    const double at = world.state(wall).value().pose.position.x;
    for (const BodyId b : all) passed += world.state(b).value().pose.position.x > at;
  }
  Gate(15, "2 000 bodies at 400 m/s, driven wall of .1 m at 40 m/s: passed", D::dimension).exactly(passed, 0);
}

TYPED_TEST(QualityBullets, ThinMesh) {
  using D = TypeParam;
  int passed = 0;
  for (int kind = 0; kind < 4; ++kind) {
    World<D> world(world_with<D>(0));
    if constexpr (D::dimension == 2) {
      std::vector<Vec2f> points;
      for (int i = -1100; i <= 1100; ++i) points.push_back({0, float(i)});  // solid to the left of travel upward: x < 0
      std::reverse(points.begin(), points.end());                           // so travel downward: free space at x < 0
      add_body<D>(world, BodyType::fixed, geometry::make_chain(points, false).value(), {0, 0});
    } else {
      std::vector<Vec3f> vertices;
      std::vector<std::uint32_t> indices;
      for (int i = -275; i <= 275; ++i)
        for (const float z : {-5.0f, 5.0f}) vertices.push_back({0, 4.0f * float(i), z});
      for (std::uint32_t i = 0; i < 550; ++i)
        for (const std::uint32_t k : {2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3})
          indices.push_back(k);
      add_body<D>(world, BodyType::fixed, geometry::make_triangle_mesh(vertices, indices).value(), {0, 0, 0});
    }
    std::vector<BodyId> all;
    for (int i = 0; i < lanes; ++i) all.push_back(fire<D>(world, kind, i, 1, false));
    run(world, 30);
    for (const BodyId b : all) passed += world.state(b).value().pose.position.x > 0.02;
  }
  Gate(15, "2 000 bodies at 400 m/s, thin mesh (2D: chain): passed", D::dimension).exactly(passed, 0);
}

template <class D>
typename D::Vector local_to(const typename D::Pose& pose, const typename D::Position& p) {
  return typename D::Vector(p - pose.position);
}

TYPED_TEST(QualityBullets, MovingWall) {
  using D = TypeParam;
  int passed = 0;
  for (int kind = 0; kind < 4; ++kind) {
    World<D> world(world_with<D>(0));
    std::vector<BodyId> all, walls;
    for (int i = 0; i < lanes; ++i) {
      walls.push_back(add_body<D>(world, BodyType::dynamic, box_shape<D>(0.05f, 1, 1), rigid::test::at<D>(0, lane(i))));
      all.push_back(fire<D>(world, kind, i, 1, true));
    }
    std::vector<char> through(lanes);
    std::vector<typename D::Vector> last(lanes);
    for (int step = 0; step < 30; ++step) {
      for (int i = 0; i < lanes; ++i) {
        const auto wall = world.state(walls[std::size_t(i)]).value().pose;
        const auto local =
            inverse_rotate(wall.rotation, local_to<D>(wall, world.state(all[std::size_t(i)]).value().pose.position));
        // From before it to behind it, and not round its edge: a wall that was struck aside turns away.
        const auto before = last[std::size_t(i)];
        last[std::size_t(i)] = local;
        if (step == 0 || !(before.x <= 0 && local.x > 0)) continue;
        const auto beside = before + (local - before) * (before.x / (before.x - local.x));
        if (std::abs(beside.y) < 0.95f) through[std::size_t(i)] = 1;
      }
      world.step(frame).value();
    }
    passed += int(std::count(through.begin(), through.end(), 1));
  }
  Gate(15, "2 000 bullets at 400 m/s, moving wall of .1 m: passed", D::dimension).exactly(passed, 0);
}

/// The radius of the largest ball about the origin inside a bullet of the kind.
template <class D>
double inner_radius(int kind) {
  if (kind == 0) return 0.05;
  if (kind < 3) return 0.03;
  // The triangle's long sides run from (−.05, ±.05) to (.07, 0); the hull's faces through three of its six points.
  const double slope = D::dimension == 2 ? 1 / math::sqrt(0.05 * 0.05 + 0.12 * 0.12) * 0.07 * 0.05
                                         : 1 / math::sqrt(1 / (0.07 * 0.07) + 2 / (0.05 * 0.05));
  return std::min(slope, 0.028);
}

// A pair has passed through each other where the balls inside them overlap by half at the moment at which one is beside
// the other, on straight ways from step to step: bullets that struck and glanced off go by farther apart than that.
TYPED_TEST(QualityBullets, EachOther) {
  using D = TypeParam;
  int passed = 0;
  for (int kind = 0; kind < 4; ++kind) {
    World<D> world(world_with<D>(0));
    std::vector<BodyId> left, right;
    for (int i = 0; i < lanes; ++i) {
      left.push_back(fire<D>(world, kind, i, 1, true));
      right.push_back(fire<D>(world, (kind + i) % 4, i, -1, true));
    }
    std::vector<typename D::Position> apart(lanes);
    std::vector<char> through(lanes);
    for (int step = 0; step < 30; ++step) {
      for (int i = 0; i < lanes; ++i) {
        const auto before = apart[std::size_t(i)];
        const auto now = world.state(right[std::size_t(i)]).value().pose.position -
                         world.state(left[std::size_t(i)]).value().pose.position;
        apart[std::size_t(i)] = now;
        if (step == 0 || !(before.x > 0 && now.x <= 0)) continue;
        const auto beside = before + (now - before) * (before.x / (before.x - now.x));
        const double both = inner_radius<D>(kind) + inner_radius<D>((kind + i) % 4);
        if (math::length(beside) < 0.5 * both) through[std::size_t(i)] = 1;
      }
      world.step(frame).value();
    }
    passed += int(std::count(through.begin(), through.end(), 1));
  }
  Gate(15, "2 × 2 000 bullets at 400 m/s, head on: passed through each other", D::dimension).exactly(passed, 0);
}

// Rods of 1 m that turn at 50 rad/s as they fly at 30 m/s at a wall: neither their middle nor an end goes through.
TYPED_TEST(QualityBullets, TurningRods) {
  using D = TypeParam;
  int passed = 0;
  for (int kind = 0; kind < 4; ++kind) {
    World<D> world(world_with<D>(0));
    add_body<D>(world, BodyType::fixed, box_shape<D>(0.05f, 1100, 5), rigid::test::at<D>(0, 0));
    std::vector<BodyId> all;
    for (int i = 0; i < lanes; ++i) {
      BodyDef<D> d;
      d.position = rigid::test::at<D>(-0.8 - 0.003 * i, lane(i));
      d.linear_velocity = rigid::test::along<D>(float(10 + 10 * kind), 0);
      d.rotation = turned<D>(0.37 * i);
      if constexpr (D::dimension == 2)
        d.angular_velocity = 50;
      else
        d.angular_velocity = {0, 0, 50};
      const BodyId id = world.create_body(d).value();
      world.add_shape(id, box_shape<D>(0.5f, 0.02f, 0.02f)).value();
      all.push_back(id);
    }
    std::vector<char> through(lanes);
    for (int step = 0; step < 60; ++step) {
      world.step(frame).value();
      for (int i = 0; i < lanes; ++i) {
        const auto pose = world.state(all[std::size_t(i)]).value().pose;
        for (const float end : {-0.5f, 0.0f, 0.5f})
          if (world_point(pose, rigid::test::along<D>(end, 0)).x > 0.05) through[std::size_t(i)] = 1;
      }
    }
    passed += int(std::count(through.begin(), through.end(), 1));
  }
  Gate(15, "2 000 rods at 50 rad/s and 10 to 40 m/s, wall of .1 m: came through", D::dimension).exactly(passed, 0);
}

TYPED_TEST(QualityBullets, SensorsSeeThem) {
  using D = TypeParam;
  int seen = 0;
  for (int kind = 0; kind < 4; ++kind) {
    World<D> world(world_with<D>(0));
    ShapeDef<D> sensor;
    sensor.sensor = true;
    BodyDef<D> fixed;
    fixed.type = BodyType::fixed;
    const BodyId curtain = world.create_body(fixed).value();
    world.add_shape(curtain, box_shape<D>(0.05f, 1100, 5), sensor).value();
    for (int i = 0; i < lanes; ++i) fire<D>(world, kind, i, 1, i % 2 == 0);
    for (int k = 0; k < 30; ++k) {
      world.step(frame).value();
      seen += int(world.events().sensor_begin.size());
    }
  }
  Gate(15, "2 000 bodies at 400 m/s through a sensor of .1 m: seen", D::dimension).exactly(seen, 4 * lanes);
}

}  // namespace bullets
}  // namespace carom::quality
