// Gate 14 (rigid-body.md 6.1): bodies that slide at 10 m/s for 4 s without friction over flush tiles, mesh triangles,
// height-field cells, chain segments and mixed neighbours lose under .1 % of their speed and hop under .1 mm.
#include <algorithm>
#include <cmath>

#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "tests/quality/gate.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::quality {
namespace flush {

using namespace carom::rigid;
using namespace carom::rigid::test;

constexpr Surface smooth{0, 0, 1000, 0};

/// What was lost: speed as a share, height in metres.
struct Loss {
  double speed = 0, hop = 0;
};
template <class D>
Loss slide(World<D>& world, const typename D::Shape& shape, const BodyDef<D>& start) {
  const BodyId body = world.create_body(start).value();
  ShapeDef<D> def;
  def.material.friction = 0;
  world.add_shape(body, shape, def).value();
  Loss out;
  double least = 10;
  for (int k = 0; k < 240; ++k) {
    world.step(frame).value();
    const BodyState<D> s = world.state(body).value();
    out.hop = std::max(out.hop, s.pose.position.y - start.position.y);
    least = std::min(least, double(s.linear_velocity.x));
  }
  const double end = double(world.state(body).value().linear_velocity.x);
  out.speed = std::max(1 - least / 10, std::abs(1 - end / 10));
  return out;
}

constexpr int columns = 61, rows = 11;
geometry::Shape3 flat_field(int x_count) {
  return geometry::make_height_field(x_count, rows, {1, 1}, std::vector<float>(std::size_t(x_count) * rows)).value();
}
geometry::Shape3 flat_mesh(int x_count) {
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < x_count; ++i) vertices.push_back({float(i), 0, float(j)});
  for (std::uint32_t j = 0; j + 1 < rows; ++j)
    for (std::uint32_t i = 0; int(i) + 1 < x_count; ++i) {
      const std::uint32_t a = j * std::uint32_t(x_count) + i, b = a + std::uint32_t(x_count);
      for (const std::uint32_t k : {a, b + 1, a + 1, a, b, b + 1}) indices.push_back(k);
    }
  return geometry::make_triangle_mesh(vertices, indices).value();
}
void lay_tiles(World3& world, int from, int to) {
  for (int i = from; i < to; ++i)
    for (int j = -1; j < 2; ++j)
      add_body<Dim3>(world, BodyType::fixed, geometry::Box{{0.5f, 0.5f, 0.5f}}, {double(i), -0.5, double(j)}, smooth);
}
void lay(World3& world, int ground) {
  const auto fixed = [&](const geometry::Shape3& s, double x) {
    add_body<Dim3>(world, BodyType::fixed, s, {x, 0, -5}, smooth);
  };
  if (ground == 0) lay_tiles(world, -2, 48);
  if (ground == 1) fixed(flat_mesh(columns), -5);
  if (ground == 2) fixed(flat_field(columns), -5);
  if (ground == 3) {  // tiles to 7.5 m, a mesh to 17.5 m, a height field to 27.5 m, tiles
    lay_tiles(world, -2, 8);
    fixed(flat_mesh(11), 7.5);
    fixed(flat_field(11), 17.5);
    lay_tiles(world, 28, 48);
  }
}

TEST(QualityFlush3, NoSpeedIsLost) {
  const Quatf across = normalize(Quatf{1, 1, 0, 0}), lengthwise = normalize(Quatf{1, 0, 0, 1});
  const Quatf turned = normalize(Quatf{0.98877f, 0, 0.14944f, 0});  // 0.3 rad
  std::vector<Vec3f> corners;
  for (int i = 0; i < 6; ++i)
    for (const float y : {-0.25f, 0.25f})
      corners.push_back({0.3f * float(std::cos(i * pi / 3)), y, 0.3f * float(std::sin(i * pi / 3))});
  struct Case {
    const char* name;
    geometry::Shape3 shape;
    float height;
    Quatf rotation;
  };
  const Case cases[] = {{"box", geometry::Box{{0.25f, 0.25f, 0.25f}}, 0.25f, turned},
                        {"box", geometry::Box{{0.25f, 0.25f, 0.25f}}, 0.25f, {}},
                        {"sphere", geometry::Sphere{0.3f}, 0.3f, {}},
                        {"capsule", geometry::Capsule3{0.3f, 0.3f}, 0.3f, across},
                        {"capsule", geometry::Capsule3{0.3f, 0.3f}, 0.3f, lengthwise},
                        {"cylinder", geometry::Cylinder{0.3f, 0.3f}, 0.3f, {}},
                        {"hull", geometry::make_hull(corners).value(), 0.25f, turned}};
  const char* grounds[] = {"separate tiles", "a mesh", "a height field", "tiles, mesh and field in turn"};
  for (int ground = 0; ground < 4; ++ground)
    for (const char* name : {"box", "sphere", "capsule", "cylinder", "hull"}) {
      Loss worst;
      for (const Case& c : cases) {
        if (std::string(c.name) != name) continue;
        for (const double z : {0.1, 0.5}) {  // inside a row and along a seam
          World3 world(world_with<Dim3>());
          lay(world, ground);
          BodyDef<Dim3> body;
          body.position = {0, double(c.height), z};
          body.rotation = c.rotation;
          body.linear_velocity = {10, 0, 0};
          const Loss loss = slide<Dim3>(world, c.shape, body);
          worst = {std::max(worst.speed, loss.speed), std::max(worst.hop, loss.hop)};
        }
      }
      const std::string what = std::string(name) + " over " + grounds[ground];
      Gate(14, what + ": speed lost", 3, "%").at_most(100 * worst.speed, 0.1);
      Gate(14, what + ": hop", 3, "m").at_most(worst.hop, 1e-4);
    }
}

TEST(QualityFlush2, NoSpeedIsLost) {
  struct Case {
    const char* name;
    geometry::Shape2 shape;
    float height;
  };
  const Case cases[] = {{"box", geometry::make_box2({0.25f, 0.25f}), 0.25f},
                        {"sphere", geometry::Circle{0.3f}, 0.3f},
                        {"capsule", geometry::Capsule2{0.3f, 0.2f}, 0.5f}};
  const char* grounds[] = {"separate tiles", "a chain", "tiles and chains in turn"};
  const auto chain = [](World2& world, double from, double to) {
    std::vector<Vec2f> points;
    for (double x = to; x >= from; x -= 1) points.push_back({float(x), 0});  // free space to the right of travel: above
    add_body<Dim2>(world, BodyType::fixed, geometry::make_chain(points, false).value(), {0, 0}, smooth);
  };
  for (int ground = 0; ground < 3; ++ground)
    for (const Case& c : cases) {
      World2 world(world_with<Dim2>());
      for (int i = -2; i < 50; ++i)
        if (ground == 0 || (ground == 2 && (i < 10 || i >= 30)))
          add_body<Dim2>(world, BodyType::fixed, geometry::make_box2({0.5f, 0.5f}), {double(i), -0.5}, smooth);
      if (ground == 1) chain(world, -2, 50);
      if (ground == 2) {
        chain(world, 9.5, 19.5);
        chain(world, 19.5, 29.5);
      }
      BodyDef<Dim2> body;
      body.position = {0, double(c.height)};
      body.linear_velocity = {10, 0};
      const Loss loss = slide<Dim2>(world, c.shape, body);
      const std::string what = std::string(c.name) + " over " + grounds[ground];
      Gate(14, what + ": speed lost", 2, "%").at_most(100 * loss.speed, 0.1);
      Gate(14, what + ": hop", 2, "m").at_most(loss.hop, 1e-4);
    }
}

}  // namespace flush
}  // namespace carom::quality
