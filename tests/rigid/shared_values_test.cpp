// What shapes have in common is kept once: whoever changes his own changes nobody else's.
#include <gtest/gtest.h>

#include <map>
#include <vector>

#include "carom/math/random.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

struct Terms {
  float density;
  Material material;
  Filter filter;
  std::uint64_t user_data;
  friend bool operator==(const Terms&, const Terms&) = default;
};
Terms terms_of(const World3& world, ShapeId shape) {
  const ShapeDef<Dim3> d = world.shape_definition(shape).value();
  return {d.density, d.material, d.filter, d.user_data};
}

// A thousand random changes, with snapshots that are taken and restored between, beside a plain list of what is set.
TEST(SharedValues, EachShapeKeepsItsOwnThroughChangesAndSnapshots) {
  math::Random random(11);
  const auto draw = [&](int count) { return random.integer(0, count - 1); };
  World3 world(world_with<Dim3>(0));
  std::map<std::uint32_t, std::pair<ShapeId, Terms>> set, kept_set;
  Snapshot<Dim3> kept = world.snapshot();
  const auto any_terms = [&] {
    Terms t{float(100 * (1 + draw(3))), {}, {}, std::uint64_t(draw(3))};
    t.material.friction = 0.25f * float(draw(4));
    t.filter.group = draw(3);
    return t;
  };
  for (int i = 0; i < 1000; ++i) {
    const int what = draw(10);
    if (set.empty() || what < 3) {
      const Terms t = any_terms();
      ShapeDef<Dim3> d;
      d.density = t.density, d.material = t.material, d.filter = t.filter, d.user_data = t.user_data;
      BodyDef<Dim3> body;
      body.position = {3.0 * i, 0, 0};
      const ShapeId shape = world.add_shape(world.create_body(body).value(), geometry::Sphere{0.5f}, d).value();
      set[shape.index] = {shape, t};
    } else {
      auto at = set.begin();
      std::advance(at, draw(int(set.size())));
      auto& [shape, own] = at->second;
      const Terms t = any_terms();
      if (what == 3) {
        world.destroy_body(world.body_of(shape).value()).value();
        set.erase(at);
      } else if (what == 4) {
        world.snapshot(kept);
        kept_set = set;
      } else if (what == 5) {
        ASSERT_TRUE(world.restore(kept).ok());
        set = kept_set;
      } else if (what == 6) {
        world.set_material(shape, t.material).value();
        own.material = t.material;
      } else if (what == 7) {
        world.set_filter(shape, t.filter).value();
        own.filter = t.filter;
      } else if (what == 8) {
        world.set_density(shape, t.density).value();
        own.density = t.density;
      } else {
        world.step(frame).value();
      }
    }
    for (const auto& [index, entry] : set) ASSERT_EQ(terms_of(world, entry.first), entry.second) << i << ", " << index;
  }
  EXPECT_GT(set.size(), 20u);
}

// A thousand shapes of one kind take no more for it than one.
TEST(SharedValues, AreKeptOnce) {
  std::size_t bytes[2];
  for (const bool own : {false, true}) {
    World3 world(world_with<Dim3>(0));
    for (int i = 0; i < 1000; ++i) {
      const BodyId box = add_box<Dim3>(world, {3.0 * i, 0, 0});
      std::vector<ShapeId> shapes;
      world.shapes(box, shapes);
      Material m = world.shape_definition(shapes[0]).value().material;
      if (own) m.friction = float(i) / 1000;
      world.set_material(shapes[0], m).value();
    }
    bytes[own] = world.counters().bytes;
  }
  EXPECT_GT(bytes[1], bytes[0] + 1000 * 48);
}

}  // namespace
}  // namespace carom::rigid::test
