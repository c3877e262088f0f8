// Quality gate 14: bodies that slide without friction over flush tiles, mesh triangles, height-field cells and chain
// segments lose no speed (< 0.1 %) and do not hop (< 0.1 mm).
#include <gtest/gtest.h>

#include "carom/geometry/height_field.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/rigid/world.h"

namespace {
using namespace carom;
using namespace carom::rigid;

template <class D>
void add_fixed(World<D>& world, typename D::Position p, const typename D::Shape& shape) {
  BodyDef<D> body;
  body.type = BodyType::fixed;
  body.position = p;
  ShapeDef<D> smooth;
  smooth.material.friction = 0;
  (void)world.add_shape(world.create_body(body).value(), shape, smooth).value();
}

/// Slides for 4 s at 10 m/s; returns the speed left along x and the highest hop.
template <class D>
void slide(World<D>& world, const typename D::Shape& shape, const BodyDef<D>& start, const char* what) {
  const BodyId body = world.create_body(start).value();
  ShapeDef<D> smooth;
  smooth.material.friction = 0;
  (void)world.add_shape(body, shape, smooth).value();
  double hop = 0;
  for (int k = 0; k < 240; ++k) {
    ASSERT_TRUE(world.step(1.0f / 60).ok());
    hop = math::max(hop, world.state(body).value().pose.position.y - start.position.y);
  }
  EXPECT_NEAR(world.state(body).value().linear_velocity.x, 10, 0.01) << what;
  EXPECT_LT(hop, 1e-4) << what;
}

constexpr int columns = 61, rows = 11;

void lay(World3& world, int ground) {
  if (ground == 0) {
    for (int i = -2; i < 48; ++i)
      for (int j = -1; j < 2; ++j)
        add_fixed<Dim3>(world, {double(i), -0.5, double(j)}, geometry::Box{{0.5f, 0.5f, 0.5f}});
  } else if (ground == 1) {
    const std::vector<float> flat(columns * rows);
    add_fixed<Dim3>(world, {-5, 0, -5}, geometry::make_height_field(columns, rows, {1, 1}, flat).value());
  } else {
    std::vector<Vec3f> vertices;
    std::vector<std::uint32_t> indices;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) vertices.push_back({float(i), 0, float(j)});
    for (std::uint32_t j = 0; j + 1 < rows; ++j)
      for (std::uint32_t i = 0; i + 1 < columns; ++i) {
        const std::uint32_t a = j * columns + i, b = a + columns;
        for (const std::uint32_t k : {a, b + 1, a + 1, a, b, b + 1}) indices.push_back(k);
      }
    add_fixed<Dim3>(world, {-5, 0, -5}, geometry::make_triangle_mesh(vertices, indices).value());
  }
}

TEST(FlushTiles, NoSpeedIsLostInSpace) {
  const Quatf across = normalize(Quatf{1, 1, 0, 0});
  const Quatf turned = normalize(Quatf{0.98877f, 0, 0.14944f, 0});  // 0.3 rad
  struct Case {
    const char* name;
    geometry::Shape3 shape;
    float height;
    Quatf rotation;
  };
  const Case cases[] = {{"box", geometry::Box{{0.25f, 0.25f, 0.25f}}, 0.25f, turned},
                        {"sphere", geometry::Sphere{0.3f}, 0.3f, {}},
                        {"capsule across", geometry::Capsule3{0.3f, 0.3f}, 0.3f, across},
                        {"upright cylinder", geometry::Cylinder{0.3f, 0.3f}, 0.3f, {}}};
  const char* grounds[] = {" on tiles", " on a height field", " on a mesh"};
  for (int ground = 0; ground < 3; ++ground)
    for (const Case& c : cases) {
      World3 world;
      lay(world, ground);
      BodyDef<Dim3> body;
      body.type = BodyType::dynamic;
      body.position = {0, double(c.height), 0.1};
      body.rotation = c.rotation;
      body.linear_velocity = {10, 0, 0};
      slide<Dim3>(world, c.shape, body, (std::string(c.name) + grounds[ground]).c_str());
    }
}

TEST(FlushTiles, NoSpeedIsLostInThePlane) {
  struct Case {
    const char* name;
    geometry::Shape2 shape;
    float height;
  };
  const Case cases[] = {{"box", geometry::make_box2({0.25f, 0.25f}), 0.25f},
                        {"circle", geometry::Circle{0.3f}, 0.3f},
                        {"capsule", geometry::Capsule2{0.3f, 0.2f}, 0.5f}};
  for (const bool chain : {false, true})
    for (const Case& c : cases) {
      World2 world;
      if (chain) {
        std::vector<Vec2f> points;
        for (int i = 50; i >= -2; --i) points.push_back({float(i), 0});  // free space to the right of travel: above
        add_fixed<Dim2>(world, {0, 0}, geometry::make_chain(points, false).value());
      } else {
        for (int i = -2; i < 50; ++i) add_fixed<Dim2>(world, {double(i), -0.5}, geometry::make_box2({0.5f, 0.5f}));
      }
      BodyDef<Dim2> body;
      body.type = BodyType::dynamic;
      body.position = {0, double(c.height)};
      body.linear_velocity = {10, 0};
      slide<Dim2>(world, c.shape, body, (std::string(c.name) + (chain ? " on a chain" : " on tiles")).c_str());
    }
}
}  // namespace
