// Bodies that are created in each other part at no more than the push speed, however many, thin or unequal they are.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace overlap_test {

template <class D>
class Overlap : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Overlap, Dimensions);

enum Kind { cube, ball, capsule, plate, card, stick, kinds };

template <class D>
typename D::Shape shape_of(int kind, float s) {
  if (kind == cube) return box_shape<D>(s, s, s);
  if (kind == plate) return box_shape<D>(s, 0.1f * s, s);
  if (kind == card) return box_shape<D>(s, 0.01f * s, 0.7f * s);
  if (kind == stick) return box_shape<D>(0.1f * s, s, 0.1f * s);
  if constexpr (D::dimension == 2) {
    if (kind == ball) return geometry::Circle{s};
    return geometry::Capsule2{s, 0.5f * s};
  } else {
    if (kind == ball) return geometry::Sphere{s};
    return geometry::Capsule3{s, 0.5f * s};
  }
}

/// The fastest of so many bodies about one place, without gravity, in the seconds in which they part.
template <class D>
double fastest_of(int first_kind, int last_kind, int count, float smallest, std::uint32_t seed) {
  WorldDef<D> definition = world_with<D>(0);
  World<D> world(definition);
  std::uint32_t r = seed;
  const auto draw = [&] {
    r = 1664525u * r + 1013904223u;
    return float(r >> 8) / 16777216.0f - 0.5f;
  };
  std::vector<BodyId> bodies;
  for (int i = 0; i < count; ++i) {
    const float size = 0.5f * float(math::exp(math::log(double(smallest)) * double(draw() + 0.5f)));
    const int kind = first_kind + int((draw() + 0.5f) * float(last_kind - first_kind + 1));
    BodyDef<D> body;
    for (int k = 0; k < D::dimension; ++k) body.position[k] = 2 * double(draw());
    const float a = draw(), b = draw(), c = draw(), d = draw();
    if constexpr (D::dimension == 2)
      body.rotation = {math::cos(6 * a), math::sin(6 * a)};
    else
      body.rotation = normalize(Quatf{a, b, c, d});
    bodies.push_back(world.create_body(body).value());
    world.add_shape(bodies.back(), shape_of<D>(kind, size)).value();
  }
  double fastest = 0;
  for (int i = 0; i < 90; ++i) {
    world.step(frame).value();
    for (const BodyId body : bodies) fastest = std::max(fastest, double(speed(world, body)));
  }
  return fastest;
}

// What pushed many, or light ones between heavy ones, was left with them in part: sizes of 1 : 30 flew off at 13 m/s,
// plates at 3.9, sticks at 3.7. Now these keep below 2.7.
TYPED_TEST(Overlap, RandomOnesPartNoFasterThanTheyArePushed) {
  using D = TypeParam;
  const int count = D::dimension == 2 ? 30 : 50;
  double worst = 0;
  for (std::uint32_t seed = 1; seed <= 6; ++seed) {
    for (int kind = 0; kind < kinds; ++kind) worst = std::max(worst, fastest_of<D>(kind, kind, count, 1, seed));
    worst = std::max(worst, fastest_of<D>(cube, stick, count, 1, seed));
    worst = std::max(worst, fastest_of<D>(cube, capsule, 2 * count, 1.0f / 30, seed));
  }
  EXPECT_LT(worst, 3);
}

}  // namespace overlap_test
}  // namespace carom::rigid::test
