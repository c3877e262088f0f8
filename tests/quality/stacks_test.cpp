// What stands: gates 1, 2, 17, 18, 19 and 16 (rigid-body.md 6.1). Default settings, g 9.81.
#include <algorithm>
#include <cmath>

#include "tests/quality/gate.h"
#include "tests/quality/ragdoll.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::quality {
namespace stacks {

using namespace carom::rigid;
using namespace carom::rigid::test;
using math::length;

template <class D>
class QualityStacks : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(QualityStacks, Dimensions);

template <class D>
double sideways(const typename D::Position& p) {
  if constexpr (D::dimension == 2)
    return std::abs(p.x);
  else
    return std::hypot(p.x, p.z);
}

// Gate 1: the rigid tower's top is at 39.5 m.
TYPED_TEST(QualityStacks, FortyCubes) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  std::vector<BodyId> boxes;
  for (int i = 0; i < 40; ++i) boxes.push_back(add_box<D>(world, rigid::test::at<D>(0, 0.5 + i)));
  double drift = 0;
  run(world, 3600);
  const double top = world.state(boxes.back()).value().pose.position.y;
  for (const BodyId box : boxes) drift = std::max(drift, sideways<D>(world.state(box).value().pose.position));
  Gate(1, "40 unit cubes, 60 s: sag of the top", D::dimension, "m").at_most(39.5 - top, 0.4);
  Gate(1, "40 unit cubes, 60 s: sideways drift", D::dimension, "m").at_most(drift, 0.01);
  Gate(1, "40 unit cubes, 60 s: still awake", D::dimension).exactly(world.counters().awake_bodies, 0);
}

/// `light` cubes with one of `ratio` times their mass on top; how far the heavy one sinks within `seconds`, and how far
/// the worst leaves the column.
template <class D>
std::pair<double, double> heavy_on_light(int light, float ratio, int seconds) {
  World<D> world(world_with<D>());
  add_ground(world);
  std::vector<BodyId> boxes;
  for (int i = 0; i <= light; ++i)
    boxes.push_back(add_box<D>(world, rigid::test::at<D>(0, 0.5 + i), 0.5f, {0.6f, 0, i == light ? ratio : 1.0f, 0}));
  double drift = 0;
  run(world, 60 * seconds);
  for (const BodyId box : boxes) drift = std::max(drift, sideways<D>(world.state(box).value().pose.position));
  return {light + 0.5 - world.state(boxes.back()).value().pose.position.y, drift};
}

// Gate 2.
TYPED_TEST(QualityStacks, ThousandfoldCubeOnLightOnes) {
  using D = TypeParam;
  for (const int light : {1, 5}) {
    const auto [sink, drift] = heavy_on_light<D>(light, 1000, 30);
    const std::string what = "1000-fold cube on " + std::string(light == 1 ? "one light cube" : "five light cubes");
    Gate(2, what + ": sinks", D::dimension, "m").at_most(sink, 0.01);
    Gate(2, what + ": leaves the column by", D::dimension, "m").at_most(drift, 0.01);
  }
}

// Gate 19: the bar is at 1:1000, the rest is the table.
TYPED_TEST(QualityStacks, MassRatioTable) {
  using D = TypeParam;
  for (const int ratio : {3, 10, 30, 100, 300, 1000, 3000, 10000}) {
    const auto [sink, drift] = heavy_on_light<D>(3, float(ratio), 10);
    Gate(19, "three light cubes under one of " + std::to_string(ratio) + " times the mass: sinks", D::dimension, "m")
        .at_most(sink, 0.05);
  }
}

/// The fastest body.
template <class D>
double fastest(const World<D>& world) {
  std::vector<BodyId> bodies;
  world.bodies(bodies);
  double most = 0;
  for (const BodyId body : bodies) {
    const BodyState<D> s = world.state(body).value();
    if (s.type == BodyType::dynamic) most = std::max(most, double(length(s.linear_velocity)));
  }
  return most;
}

// Gate 17.
TYPED_TEST(QualityStacks, PyramidIsStill) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  d.allow_sleep = false;
  World<D> world(d);
  add_ground(world);
  add_pyramid(world, 12);
  run(world, 600);
  Gate(17, "pyramid of base 12 after 10 s, sleep off: fastest body", D::dimension, "m/s").at_most(fastest(world), 1e-4);
}

// Five thousand boxes in a hundred rows. They agree on their loads by some rows a step: without the first loads, which
// are handed down before it, the top would sink by a quarter of a metre and be thrown up again.
TYPED_TEST(QualityStacks, TallPyramidIsStill) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  const BodyId top = add_pyramid(world, 100).back();
  run(world, 600);
  Gate(17, "pyramid of base 100 after 10 s: fastest body", D::dimension, "m/s").at_most(fastest(world), 1e-4);
  Gate(17, "pyramid of base 100 after 10 s: still awake", D::dimension).exactly(world.counters().awake_bodies, 0);
  Gate(17, "pyramid of base 100 after 10 s: sag of the top", D::dimension, "m")
      .at_most(99.5 - world.state(top).value().pose.position.y, 0.1);
}

/// Heap (b) of 6.2: 2 000 mixed bodies between walls. Its own seed is 12345.
void add_heap_b(World3& world, std::uint32_t seed) {
  add_body<Dim3>(world, BodyType::fixed, geometry::Box{{200, 1, 200}}, {0, -1, 0}, {0.5f, 0, 1, 0});
  for (const double side : {-1.0, 1.0}) {
    add_body<Dim3>(world, BodyType::fixed, geometry::Box{{1, 12, 8.5f}}, {7.5 * side, 10, 0}, {0.5f, 0, 1, 0});
    add_body<Dim3>(world, BodyType::fixed, geometry::Box{{6.5f, 12, 1}}, {0, 10, 7.5 * side}, {0.5f, 0, 1, 0});
  }
  std::uint32_t r = seed;
  const auto u = [&] {
    r = 1664525u * r + 1013904223u;
    return double(r >> 8) / 16777216.0;
  };
  for (int y = 0; y < 20; ++y)
    for (int x = 0; x < 10; ++x)
      for (int z = 0; z < 10; ++z) {
        const double dx = 0.1 * (u() - 0.5), dz = 0.1 * (u() - 0.5);
        const double a = u() - 0.5, b = u() - 0.5, c = u() - 0.5, angle = 3 * u();
        const double n = std::sqrt(a * a + b * b + c * c), s = std::sin(angle / 2) / n;
        BodyDef<Dim3> body;
        body.position = {1.25 * (x - 4.5) + dx, 1 + 1.25 * y, 1.25 * (z - 4.5) + dz};
        body.rotation = {float(std::cos(angle / 2)), float(a * s), float(b * s), float(c * s)};
        geometry::Shape3 shape = geometry::Box{{0.4f, 0.4f, 0.4f}};
        if ((x + y + z) % 3 == 1) shape = geometry::Sphere{0.45f};
        if ((x + y + z) % 3 == 2) shape = geometry::Capsule3{0.3f, 0.3f};
        ShapeDef<Dim3> def;
        def.density = 1;
        def.material.friction = 0.5f;
        world.add_shape(world.create_body(body).value(), shape, def).value();
      }
}

// When the last body of a heap comes to rest is chance, which any change of rounding deals anew: so of eight heaps. Of
// 32, 23 slept within 10 s, 31 within 20, and the last after 24.
TEST(QualityStacks3, HeapsOfTwoThousandComeToRest) {
  constexpr int heaps = 8;
  int late = 0;
  double worst = 0;
  for (std::uint32_t i = 0; i < heaps; ++i) {
    World3 world(world_with<Dim3>());
    add_heap_b(world, 12345 + i);
    int steps = 0;
    while (steps < 1800 && (steps < 60 || world.counters().awake_bodies > 0)) {
      run(world, 1);
      ++steps;
    }
    late += steps > 600;
    worst = std::max(worst, fastest(world));
  }
  Gate(17, "eight heaps of 2 000 after 30 s: fastest body", 3, "m/s").at_most(worst, 1e-4);
  Gate(17, "eight heaps of 2 000: not asleep after 10 s", 3).not_yet(5).exactly(late, 0);
}

TEST(QualityStacks3, RagdollPileIsStill) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  for (int i = 0; i < 10; ++i) add_ragdoll(world, {0.15 * (i % 3), 0.2 + 0.7 * i, 0.1 * (i % 2)}, -(i + 1));
  run(world, 600);
  Gate(17, "pile of ten ragdolls after 10 s: fastest body", 3, "m/s").at_most(fastest(world), 1e-4);
  Gate(17, "pile of ten ragdolls after 10 s: still awake", 3).exactly(world.counters().awake_bodies, 0);
}

/// A card of length 1 m and thickness 20 mm with round ends, leaning by `lean` rad (positive: its top to the right),
/// its outermost point at the top at x and its lowest at y.
constexpr double card_half = 0.49, card_round = 0.01;
template <class D>
double card_core() {  // half the thickness of what is rounded
  return D::dimension == 2 ? 0.0 : 0.001;
}
template <class D>
BodyId add_card(World<D>& world, double x, double y, double lean, float friction) {
  BodyDef<D> body;
  const double s = std::abs(std::sin(lean)), c = std::cos(lean), side = lean > 0 ? 1 : -1;
  body.position = rigid::test::at<D>(x - side * (card_half * s + card_core<D>() * c + card_round),
                                     y + card_half * c + card_core<D>() * s + card_round);
  body.rotation = turned<D>(-lean);
  body.sleep_speed = 0;  // sleep must not be what holds the house
  const BodyId id = world.create_body(body).value();
  ShapeDef<D> def;
  def.density = 700;
  def.material.friction = friction;
  if constexpr (D::dimension == 2)
    world.add_shape(id, geometry::Capsule2{0.49f, 0.01f}, def).value();
  else
    world.add_shape(id, geometry::Box{{0.001f, 0.49f, 0.3f}, 0.01f}, def).value();
  return id;
}
/// A tent that leans on itself at x: half-angle `theta`.
template <class D>
void add_tent(World<D>& world, std::vector<BodyId>& cards, double x, double y, double theta, float friction) {
  cards.push_back(add_card<D>(world, x, y, theta, friction));
  cards.push_back(add_card<D>(world, x, y, -theta, friction));
}
template <class D>
double furthest_moved(World<D>& world, const std::vector<BodyId>& cards, int seconds) {
  std::vector<typename D::Position> start;
  for (const BodyId card : cards) start.push_back(world.state(card).value().pose.position);
  run(world, 60 * seconds);
  double most = 0;
  for (std::size_t i = 0; i < cards.size(); ++i)
    most = std::max(most, length(world.state(cards[i]).value().pose.position - start[i]));
  return most;
}

// Gate 18. A card's foot carries m g and pushes outward with ½ m g tan θ: a tent stands iff μ ≥ ½ tan θ = .233 at 25°.
TYPED_TEST(QualityStacks, CardTentStandsIffTheLawSays) {
  using D = TypeParam;
  const double theta = math::radians(25.0), least = 0.5 * std::tan(theta);
  for (const double factor : {1.2, 0.8}) {
    World<D> world(world_with<D>());
    const float friction = float(factor * least);
    add_ground(world, {friction, 0, 1000, 0});
    std::vector<BodyId> cards;
    add_tent<D>(world, cards, 0, 0, theta, friction);
    const double moved = furthest_moved(world, cards, 60);
    if (factor > 1)
      Gate(18, "card tent at 1.2 of the least friction, 60 s: moved", D::dimension, "m").at_most(moved, 0.01);
    else
      Gate(18, "card tent at .8 of the least friction: falls (1)", D::dimension).exactly(moved > 0.1, 1);
  }
}

// Two tents, a floor card across their tops, and a tent on it, at the default friction of .6. The least friction of
// the lower feet is tan θ (½ m + W)/(m + W) under a load W on each card, here W = 1: .35. In several places, a
// hundredth of a millimetre apart: what stands by luck falls in one of them.
TYPED_TEST(QualityStacks, CardHouseStands) {
  using D = TypeParam;
  const double theta = math::radians(25.0);
  double moved = 0;
  for (int place = 0; place < 4; ++place) {
    const double x = 1e-5 * place;
    World<D> world(world_with<D>());
    add_ground(world);
    std::vector<BodyId> cards;
    add_tent<D>(world, cards, x - 0.45, 0, theta, 0.6f);
    add_tent<D>(world, cards, x + 0.45, 0, theta, 0.6f);
    const double top = 2 * (card_half * std::cos(theta) + card_core<D>() * std::sin(theta) + card_round);
    BodyDef<D> floor;
    floor.position = rigid::test::at<D>(x, top + 0.01);
    floor.sleep_speed = 0;
    const BodyId id = world.create_body(floor).value();
    ShapeDef<D> def;
    def.density = 350;
    world.add_shape(id, box_shape<D>(1.0f, 0.01f, 0.3f), def).value();
    cards.push_back(id);
    add_tent<D>(world, cards, x, top + 0.02, theta, 0.6f);
    moved = std::max(moved, furthest_moved(world, cards, 60));
  }
  Gate(18, "card house of two storeys, four places, 60 s: moved", D::dimension, "m").at_most(moved, 0.01);
}

// Gate 16: half inside each other and half inside a wall. What touches parts no faster than the push speed.
TYPED_TEST(QualityStacks, OverlapsPartGently) {
  using D = TypeParam;
  WorldDef<D> d = world_with<D>();
  World<D> world(d);
  add_ground(world);
  add_body<D>(world, BodyType::fixed, box_shape<D>(1, 5, 5), rigid::test::at<D>(-2, 5));
  const int depth = D::dimension == 2 ? 1 : 3;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      for (int z = 0; z < depth; ++z) add_box<D>(world, rigid::test::at<D>(-1 + 0.5 * x, 0.25 + 0.5 * y, 0.5 * z));
  double parting = 0;
  std::vector<ContactView<D>> contacts;
  for (int i = 0; i < 600; ++i) {
    world.step(frame).value();
    world.contacts(contacts);
    for (const ContactView<D>& c : contacts) {
      const BodyState<D> a = world.state(world.body_of(c.shape_a).value()).value(),
                         b = world.state(world.body_of(c.shape_b).value()).value();
      parting = std::max(parting, double(dot(b.linear_velocity - a.linear_velocity, c.normal)));
    }
  }
  Gate(16, "bodies half inside each other and a wall: part at", D::dimension, "m/s")
      .at_most(parting, double(d.contact_push_speed));
  Gate(16, "the same after 10 s: fastest body", D::dimension, "m/s").at_most(fastest(world), 1e-4);
  Gate(16, "the same after 10 s: deepest overlap", D::dimension, "m").at_most(double(world.worst_penetration()), 0.005);
}

}  // namespace stacks
}  // namespace carom::quality
