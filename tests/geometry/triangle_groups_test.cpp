// What is told of eight triangles at once holds for each of them, and is the same in bits by every instruction set.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "carom/geometry/detail/gjk.h"
#include "carom/geometry/detail/surface.h"
#include "carom/geometry/detail/triangle_reach.h"
#include "carom/math/cpu.h"
#include "carom/math/random.h"

namespace carom::geometry::triangle_groups_test {

using namespace detail;

/// A mesh of loose triangles about the origin.
std::shared_ptr<const TriangleMesh> loose_triangles(math::Random& random, int count) {
  const auto vector = [&](double size) {
    return Vec3f(Vec3d{random.uniform(-size, size), random.uniform(-size, size), random.uniform(-size, size)});
  };
  std::vector<Vec3f> vertices;
  std::vector<std::uint32_t> indices;
  for (int i = 0; i < count; ++i) {
    const Vec3f p = vector(2.5);
    for (const Vec3f corner : {p, p + vector(1), p + vector(1)}) {
      indices.push_back(std::uint32_t(vertices.size()));
      vertices.push_back(corner);
    }
  }
  return make_triangle_mesh(vertices, indices).value();
}

Shape3 hexagonal_prism() {
  std::vector<Vec3f> points;
  for (const Vec3f& p :
       {Vec3f{0.4f, 0, 0}, {0.2f, 0, 0.35f}, {-0.2f, 0, 0.35f}, {-0.4f, 0, 0}, {-0.2f, 0, -0.35f}, {0.2f, 0, -0.35f}})
    points.push_back(p + Vec3f{0.1f, -0.8f, 0}), points.push_back(p + Vec3f{0.1f, 1.2f, 0});
  return Shape3(make_hull(points, {.radius = 0.02f}).value());
}

double distance(const Convex& shape, const Transform3f& x, const SurfaceTriangle& t) {
  CoreDistance found;
  const Convex triangle = convex_of_triangle(t.corner[0], t.corner[1], t.corner[2]);
  core_distance(Placed(triangle), Placed(shape, x), 1e30, {}, found);
  return found.overlap ? 0 : found.distance - double(shape.radius);
}

class Groups : public ::testing::Test {
 protected:
  math::Random random{7};
  std::shared_ptr<const TriangleMesh> mesh = loose_triangles(random, 400);
  Shape3 surface{mesh};

  Transform3f place() {
    const auto number = [&](double size) { return float(random.uniform(-size, size)); };
    return {{number(1), number(1), number(1)}, math::normalize(Quatf{number(1), number(1), number(1), 0.1f})};
  }
};

TEST_F(Groups, AreTheTrianglesThatMeetTheBoxInTheOrderOfTheTree) {
  for (int k = 0; k < 50; ++k) {
    const Vec3f middle = place().p;
    const Bounds3f box = grow(Bounds3f{middle, middle}, 0.7f);
    std::vector<std::uint32_t> one_by_one, in_groups;
    visit_triangles(surface, box, true, [&](const SurfaceTriangle& t) { return one_by_one.push_back(t.index), true; });
    visit_groups(surface, box, true, [&](const TriangleGroup& group, std::uint32_t lanes) {
      for (; lanes != 0; lanes &= lanes - 1) {
        const SurfaceTriangle t = triangle_of(surface, group, std::countr_zero(lanes));
        for (int c = 0; c < 3; ++c)
          for (int axis = 0; axis < 3; ++axis)
            EXPECT_EQ(t.corner[c][axis], group.corner[c][axis][std::countr_zero(lanes)]);
        in_groups.push_back(t.index);
      }
      return true;
    });
    std::vector<std::uint32_t> sought;
    for (std::uint32_t i = 0; i < std::uint32_t(mesh->triangle_count()); ++i) {
      const SurfaceTriangle t = triangle_of(*mesh, i);
      if (overlaps(box, Bounds3f{min(t.corner[0], min(t.corner[1], t.corner[2])),
                                 max(t.corner[0], max(t.corner[1], t.corner[2]))}))
        sought.push_back(i);
    }
    EXPECT_EQ(in_groups, one_by_one);
    std::sort(in_groups.begin(), in_groups.end());
    EXPECT_EQ(in_groups, sought);
  }
}

// Nothing within the margin is left out, and most of what is not is.
TEST_F(Groups, LeaveOutNothingThatIsWithinReach) {
  const float margin = 0.05f;
  int near = 0, asked = 0, left = 0;
  for (const Shape3& shape : {Shape3(Box{{0.5f, 0.2f, 0.9f}}), hexagonal_prism()}) {
    const Convex core = convex_of(shape);
    for (int k = 0; k < 100; ++k) {
      const Transform3f x = place();
      const PlacedCorners corners(core, x);
      OffDirections off(corners, {}, core.radius, margin, false);
      CornersReach reach(corners, core.radius, 2, margin, {}, false, off);
      const Vec3f middle = corners.middle() + x.p;
      visit_groups(surface, grow(bounds(shape, x), margin), true, [&](const TriangleGroup& group, std::uint32_t lanes) {
        const std::uint32_t met = reach.meets(group, lanes);
        EXPECT_EQ(met & ~lanes, 0u);
        for (; lanes != 0; lanes &= lanes - 1) {
          const int lane = std::countr_zero(lanes);
          const SurfaceTriangle t = triangle_of(surface, group, lane);
          const Vec3f normal = cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]);
          const bool faces = dot(normal, middle - t.corner[0]) > 0;
          const bool within = faces && distance(core, x, t) < double(margin);
          near += within, ++asked, left += (met >> lane & 1u) != 0;
          if (within) EXPECT_NE(met >> lane & 1u, 0u);
        }
        return true;
      });
    }
  }
  EXPECT_GT(near, 300);
  EXPECT_LT(left - near, (asked - near) / 3);
}

// What keeps off now and at the end of its way keeps off between them.
TEST_F(Groups, LeaveOutWhatTheShapeKeepsOffAsItGoesOn) {
  const Shape3 shape = hexagonal_prism();
  const Convex core = convex_of(shape);
  const float margin = 1;
  int left_out = 0;
  for (int k = 0; k < 100; ++k) {
    const Transform3f x = place();
    const ShapeWay way{.way = 0.2f * place().p, .turn = {}, .bend = 0, .margin = 0.02f};
    PlacedCorners corners(core, x);
    corners.go(way);
    OffDirections off(corners, way, core.radius, margin, false);
    CornersReach reach(corners, core.radius, 2, margin, {}, false, off);
    const Vec3f middle = corners.middle() + x.p;
    visit_groups(surface, grow(bounds(shape, x), margin), true, [&](const TriangleGroup& group, std::uint32_t lanes) {
      const std::uint32_t met = reach.meets(group, lanes);
      for (std::uint32_t out = lanes & ~met; out != 0; out &= out - 1) {
        const SurfaceTriangle t = triangle_of(surface, group, std::countr_zero(out));
        if (dot(cross(t.corner[1] - t.corner[0], t.corner[2] - t.corner[0]), middle - t.corner[0]) <= 0) continue;
        ++left_out;
        for (const float part : {0.0f, 0.5f, 1.0f})
          EXPECT_GT(distance(core, {x.p + part * way.way, x.q}, t), double(way.margin) - 1e-5);
      }
      return true;
    });
  }
  EXPECT_GT(left_out, 1000);
}

TEST_F(Groups, AreTheSameInBitsByAllInstructionSets) {
  if (math::detect_instruction_set() < math::InstructionSet::avx2) GTEST_SKIP() << "this machine has four lanes only";
  const TriangleKernels &four = triangle_groups_baseline::kernels, &eight = triangle_groups_avx2::kernels;
  const Shape3 shape = hexagonal_prism();
  const Convex core = convex_of(shape);
  int met = 0;
  for (int k = 0; k < 200; ++k) {
    const Transform3f x = place();
    const ShapeWay way{.way = 0.2f * place().p, .turn = 0.1f * place().p, .bend = 0.01f, .margin = 0.02f};
    PlacedCorners corners(core, x);
    corners.go(way);
    OffDirections off(corners, way, core.radius, 0.5f, false);
    const SurfaceTriangle first = triangle_of(*mesh, std::uint32_t(k));
    off.learn(x.p - first.corner[0], first.corner[0] - x.p, first.corner[1] - x.p, first.corner[2] - x.p);
    PlacedShape placed{};
    corners.tell(placed), corners.tell_faces(placed), off.tell(placed);
    placed.radius = core.radius, placed.solid = k % 4 == 0;
    const NearQuestion question{corners.middle(), 0.6f, off.most()};
    const ClearanceQuestion clear{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {-1, -1, -1}, {1, 1, 1}, {-1, -1, -1}, {1, 1, 1}};
    std::uint32_t triangles[8];
    for (std::uint32_t& t : triangles) t = std::uint32_t(random.uniform(0.0, double(mesh->triangle_count()) - 1));
    TriangleGroup group[2];
    NearAnswer near[2];
    FacesAnswer faces[2];
    float gap[2][8];
    std::uint32_t boxes[2], lanes[2];
    for (int i = 0; i < 2; ++i) {
      const TriangleKernels& kernels = i == 0 ? four : eight;
      boxes[i] = kernels.load(&mesh->vertices[0].x, mesh->indices.data(), triangles, 1 + k % 8, {-2, -2, -2}, {2, 2, 2},
                              group[i]);
      lanes[i] = kernels.near(group[i], boxes[i], placed, question, near[i]);
      kernels.before_faces(group[i], lanes[i], placed, question, faces[i]);
      kernels.clearance(group[i], placed, clear, gap[i]);
    }
    EXPECT_EQ(boxes[0], boxes[1]);
    EXPECT_EQ(lanes[0], lanes[1]);
    EXPECT_EQ(std::memcmp(group[0].corner, group[1].corner, sizeof group[0].corner), 0);
    EXPECT_EQ(std::memcmp(gap[0], gap[1], sizeof gap[0]), 0);
    ASSERT_EQ(near[0].learned, near[1].learned);
    for (int i = 0; i < near[0].learned; ++i) {
      EXPECT_EQ(near[0].lane[i], near[1].lane[i]);
      EXPECT_EQ(near[0].direction[i], near[1].direction[i]);
    }
    EXPECT_EQ(faces[0].apart, faces[1].apart);
    EXPECT_EQ(faces[0].ahead, faces[1].ahead);
    EXPECT_EQ(std::memcmp(faces[0].face, faces[1].face, sizeof faces[0].face), 0);
    met += std::popcount(lanes[0]);
  }
  EXPECT_GT(met, 50);
}

}  // namespace carom::geometry::triangle_groups_test
