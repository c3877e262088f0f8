// Concave polygons as convex ones: exactly the same area, of convex parts within the limit of corners, and not more of
// them than Hertel and Mehlhorn's bound where that limit does not bind.
#include <gtest/gtest.h>

#include <limits>

#include "carom/geometry/decomposition.h"
#include "carom/geometry/mass_properties.h"
#include "carom/math/elementary.h"
#include "carom/math/random.h"

namespace {
using namespace carom;
using namespace carom::geometry;

using Points = std::vector<Vec2f>;

double area_of(const Points& p) {
  double sum = 0;
  for (std::size_t i = 0; i < p.size(); ++i) sum += cross(Vec2d(p[i]), Vec2d(p[(i + 1) % p.size()]));
  return abs(sum) / 2;
}
double area_of(const Polygon& p) { return area_of(Points(p.vertices, p.vertices + p.count)); }
int notches_of(const Points& p) {  // of a counterclockwise outline
  int count = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const Vec2d a(p[i]), b(p[(i + 1) % p.size()]), c(p[(i + 2) % p.size()]);
    count += cross(b - a, c - b) < 0 ? 1 : 0;
  }
  return count;
}
bool inside(const Points& p, Vec2d at) {
  bool in = false;
  for (std::size_t i = 0, j = p.size() - 1; i < p.size(); j = i++) {
    const Vec2d a(p[i]), b(p[j]);
    if ((a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * ((at.y - a.y) / (b.y - a.y))) in = !in;
  }
  return in;
}
/// Parts are sound, their areas add up, and random points are in exactly one of them where they are inside.
void check(const Points& outline, const std::vector<Points>& holes, const std::vector<Polygon>& parts) {
  double whole = area_of(outline), sum = 0;
  for (const Points& hole : holes) whole -= area_of(hole);
  for (const Polygon& part : parts) {
    const auto sound = validate(Shape2(part));
    ASSERT_TRUE(sound.ok()) << sound.error().message;
    sum += area_of(part);
  }
  EXPECT_NEAR(sum / whole, 1, 1e-6);
  Vec2f low = outline[0], high = low;
  for (const Vec2f p : outline) low = min(low, p), high = max(high, p);
  math::Random random(5);
  for (int i = 0; i < 300; ++i) {
    const Vec2d at{random.uniform(double(low.x), double(high.x)), random.uniform(double(low.y), double(high.y))};
    bool in = inside(outline, at);
    for (const Points& hole : holes) in = in && !inside(hole, at);
    int found = 0;
    for (const Polygon& part : parts) found += inside(Points(part.vertices, part.vertices + part.count), at) ? 1 : 0;
    EXPECT_EQ(found, in ? 1 : 0) << at.x << ", " << at.y;
  }
}

TEST(Decomposition2, AnLIsTwoBoxes) {
  const Points l{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  const auto parts = decompose_convex(l).value();
  EXPECT_EQ(parts.size(), 2u);
  check(l, {}, parts);
  Points clockwise(l.rbegin(), l.rend());
  check(l, {}, decompose_convex(clockwise).value());
}

TEST(Decomposition2, AConvexPolygonStaysWhole) {
  Points p;
  for (int i = 0; i < 8; ++i) p.push_back({float(cos(i * pi / 4)), float(sin(i * pi / 4))});
  EXPECT_EQ(decompose_convex(p).value().size(), 1u);
  p.clear();
  for (int i = 0; i < 24; ++i) p.push_back({float(cos(i * pi / 12)), float(sin(i * pi / 12))});
  const auto parts = decompose_convex(p).value();  // more corners than a polygon has: 22 triangles, 6 at most in one
  EXPECT_LE(parts.size(), 6u);
  check(p, {}, parts);
}

TEST(Decomposition2, PointsOnASideAreNoCorners) {
  const Points square{{0, 0}, {1, 0}, {2, 0}, {2, 2}, {1, 2}, {0.5f, 2}, {0, 2}, {0, 1}};
  const auto parts = decompose_convex(square).value();
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_EQ(parts[0].count, 4);
}

TEST(Decomposition2, RandomStars) {
  math::Random random(11);
  for (int n = 5; n < 150; n += 3) {
    Points star;
    for (int i = 0; i < n; ++i) {
      const double a = 2 * pi * (i + random.uniform(-0.3, 0.3)) / n, r = random.uniform(0.2, 1.0);
      star.push_back({float(3 + r * cos(a)), float(r * sin(a))});
    }
    const auto parts = decompose_convex(star);
    ASSERT_TRUE(parts.ok()) << n << ": " << parts.error().message;
    check(star, {}, *parts);
    EXPECT_LE(int(parts->size()), 4 * (notches_of(star) / 2 + 1) + n / 6) << n;
  }
}

TEST(Decomposition2, CombsAndSpirals) {
  Points comb{{0, 0}, {20, 0}};
  for (int i = 19; i >= 0; --i) {
    comb.push_back({float(i) + 0.9f, 3});
    comb.push_back({float(i) + 0.5f, 0.5f + 0.01f * float(i)});
  }
  comb.push_back({0, 3});
  auto parts = decompose_convex(comb).value();
  check(comb, {}, parts);
  EXPECT_LE(parts.size(), 4u * 11u);
  Points spiral;
  const int turns = 12;
  for (int i = 0; i <= 16 * turns; ++i) {
    const double a = i * pi / 8;
    spiral.push_back({float((1 + 0.1 * a) * cos(a)), float((1 + 0.1 * a) * sin(a))});
  }
  for (int i = 16 * turns; i >= 0; --i) {
    const double a = i * pi / 8;
    spiral.push_back({float((0.8 + 0.1 * a) * cos(a)), float((0.8 + 0.1 * a) * sin(a))});
  }
  parts = decompose_convex(spiral).value();
  check(spiral, {}, parts);
}

TEST(Decomposition2, Holes) {
  const Points frame{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  std::vector<Points> holes{{{1, 1}, {3, 1}, {3, 3}, {1, 3}}};
  auto parts = decompose_convex(frame, holes).value();
  EXPECT_EQ(parts.size(), 4u);  // the fewest there can be: each corner of the hole is cut off from two sides
  check(frame, holes, parts);
  // A sieve, with holes of both directions and ends at one height.
  const Points plate{{-1, -1}, {31, -1}, {31, 31}, {-1, 31}};
  holes.clear();
  math::Random random(3);
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) {
      Points hole;
      const int n = 3 + (i + j) % 6;
      for (int k = 0; k < n; ++k) {
        const double a = 2 * pi * k / n * ((i ^ j) % 2 == 0 ? 1 : -1), r = random.uniform(0.4, 1.4);
        hole.push_back({float(3 * i + 1.5 + r * cos(a)), float(3 * j + 1.5 + r * sin(a))});
      }
      holes.push_back(hole);
    }
  parts = decompose_convex(plate, holes).value();
  check(plate, holes, parts);
  // A C in a C: the inner one's rightmost corner sees nothing to its right but the outer's inside.
  const Points outer{{0, 0}, {9, 0}, {9, 9}, {0, 9}};
  holes = {{{1, 1}, {8, 1}, {8, 2}, {2, 2}, {2, 7}, {8, 7}, {8, 8}, {1, 8}},
           {{3, 3}, {7, 3}, {7, 4}, {4, 4}, {4, 5}, {7, 5}, {7, 6}, {3, 6}}};
  check(outer, holes, decompose_convex(outer, holes).value());
}

TEST(Decomposition2, FarAwayAndOfAnySize) {
  const Points l{{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}};
  for (const float scale : {1e-2f, 1.0f, 1e4f}) {
    Points p;
    for (const Vec2f v : l) p.push_back(scale * v);
    const auto parts = decompose_convex(p);
    ASSERT_TRUE(parts.ok()) << parts.error().message;
    check(p, {}, *parts);
  }
}

TEST(Decomposition2, RefusesWhatHasNoInside) {
  const auto says = [](const auto& result, std::string_view part) {
    ASSERT_FALSE(result.ok());
    EXPECT_NE(result.error().message.find(part), std::string::npos) << result.error().message;
  };
  says(decompose_convex(Points{{0, 0}, {1, 0}}), "2 corners");
  says(decompose_convex(Points{{0, 0}, {1, 0}, {0, std::numeric_limits<float>::quiet_NaN()}}), "corner");
  says(decompose_convex(Points{{0, 0}, {1, 0}, {1, 1}, {0, 0}}), "corner 0 of outline and corner 3 of outline");
  says(decompose_convex(Points{{0, 0}, {2, 2}, {2, 0}, {0, 2}}), "meets the side");                  // a bow tie
  says(decompose_convex(Points{{0, 0}, {1, 0}, {2, 0}}), "meets the side");                          // a line
  says(decompose_convex(Points{{0, 0}, {4, 0}, {4, 4}, {2, 0}, {0, 4}}), "meets the side");          // a touch
  says(decompose_convex(Points{{0, 0}, {4, 0}, {6, 0}, {5, 0}, {5, 3}, {0, 3}}), "meets the side");  // a spike
  const Points square{{0, 0}, {4, 0}, {4, 4}, {0, 4}};
  const auto with = [&](std::vector<Points> holes) { return decompose_convex(square, holes); };
  says(with({{{3, 3}, {5, 3}, {5, 5}}}), "holes[0]");
  says(with({{{6, 6}, {7, 6}, {7, 7}}}), "holes[0] lies outside");
  says(with({{{1, 1}, {3, 1}, {2, 3}}, {{1.8f, 1.5f}, {2.2f, 1.5f}, {2, 2}}}), "holes[1] lies in holes[0]");
  says(with({{{1, 1}, {3, 1}, {2, 3}}, {{2, 2}, {3.5f, 2}, {3.5f, 3}}}), "meets the side");
}

}  // namespace
