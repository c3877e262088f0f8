// Where round shapes of the plane touch after they have moved a little: the closed form against a new search.
#include <gtest/gtest.h>

#include "carom/math/random.h"
#include "carom/rigid/detail/contact_middle.h"

namespace carom::rigid::detail {
namespace {

using geometry::Shape2;

Shape2 any_shape(math::Random& random) {
  const float size = float(random.uniform(0.2, 0.5));
  switch (int(random.uniform(0.0, 4.0))) {
    case 0:
      return geometry::Circle{size};
    case 1:
      return geometry::Capsule2{0.6f * size, size};
    case 2:
      return geometry::make_box2({size, 0.7f * size});
    default:
      return geometry::make_box2({size, 0.7f * size}, 0.5f * size);
  }
}
Rot2f turn_by(double angle) { return {float(math::cos(angle)), float(math::sin(angle))}; }
/// The points that are not on an edge stand still in their frames.
bool same_features(const RoundFeatures& f, const RoundFeatures& g) {
  if (f.edge_a != g.edge_a || f.edge_b != g.edge_b) return false;
  return (f.edge_a || math::distance(f.a, g.a) < 1e-4f) && (f.edge_b || math::distance(f.b, g.b) < 1e-4f);
}

TEST(RoundMiddle, ClosedFormFindsWhatASearchFinds) {
  math::Random random(5);
  int all = 0, compared = 0, kinds[3] = {};
  for (int i = 0; i < 200000; ++i) {
    const Shape2 a = any_shape(random), b = any_shape(random);
    ContactRecord<Dim2> c;
    const double direction = random.uniform(-math::pi, math::pi), far = random.uniform(0.3, 1.6);
    c.base = {far * Vec2f(turn_by(direction).c, turn_by(direction).s), turn_by(random.uniform(-math::pi, math::pi))};
    geometry::Manifold2 m, searched, found;
    geometry::PairCache cache;
    geometry::collide(a, b, c.base, 0.02f, cache, m);
    if (m.count != 1 || m.points[0].separation < -0.02f) continue;
    Transform2f then = c.base;
    then.p += Vec2f(float(random.uniform(-0.004, 0.004)), float(random.uniform(-0.004, 0.004)));
    then.q = then.q * turn_by(random.uniform(-0.01, 0.01));
    geometry::collide(a, b, then, 0.1f, cache, searched);
    if (searched.count != 1 || searched.points[0].feature != m.points[0].feature) continue;
    // Others meet then, or the normal is bent over the border of a sharp edge, so that nothing catches there.
    ++all;
    const RoundFeatures f = features_of(a, b, c.base, m);
    if (!same_features(f, features_of(a, b, then, searched))) continue;
    ASSERT_TRUE(meet_then(a, b, c, m, then, found));
    ++compared;
    ++kinds[f.edge_a ? 0 : (f.edge_b ? 1 : 2)];
    EXPECT_LT(math::distance(found.normal, searched.normal), 2e-4f) << i;
    EXPECT_LT(math::distance(found.points[0].point, searched.points[0].point), 2e-4f) << i;
  }
  EXPECT_GT(compared, 2000);
  EXPECT_GT(compared, 0.9 * all);
  for (const int kind : kinds) EXPECT_GT(kind, 300);
}

}  // namespace
}  // namespace carom::rigid::detail
