// Heaps of thin pieces, which whirl as they fall and wedge themselves into each other, come to rest and do not burst.
#include <gtest/gtest.h>

#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace thin_heap_test {

/// A body flung down at random, at up to 7 m/s.
BodyDef<Dim3> flung(std::uint32_t seed, double height, float spin) {
  Draw draw{seed};
  BodyDef<Dim3> body;
  const float w = draw(), x = draw(), y = draw(), z = draw();
  body.position = {0, height, 0};
  body.rotation = normalize(Quatf{w, x, y, z});
  for (int i = 0; i < 3; ++i) body.linear_velocity[i] = 3 * draw() - (i == 1 ? 3.0f : 0.0f);
  for (int i = 0; i < 3; ++i) body.angular_velocity[i] = spin * draw();
  return body;
}
/// The most that the energy of all rises over what it once was, in parts of the first.
double gain_of(World3& world, int steps) {
  double first = 0, least = 0, gain = 0;
  for (int i = 0; i < steps; ++i) {
    world.step(frame).value();
    const Totals<Dim3> t = world.totals();
    const double now = t.kinetic_energy + t.potential_energy;
    if (i == 0) first = least = now;
    gain = std::max(gain, (now - least) / first);
    least = std::min(least, now);
  }
  return gain;
}

// Sticks have moments of inertia as 1 : 300 and more, which turn with them. While contacts took those of the step's
// beginning, 135 of 200 capsules of 1 : 50 that were flung like this gained more than half of their energy as they
// landed, and one left at 44 km/s. What is left comes of the speed at which overlaps part.
TEST(ThinPiece, GainsNothingWhereItLands) {
  for (const float half : {0.025f, 0.01f})
    for (const geometry::Shape3& shape :
         {geometry::Shape3(geometry::Box{{half, 0.5f, half}}), geometry::Shape3(geometry::Capsule3{0.5f, half}),
          geometry::Shape3(geometry::Cylinder{0.5f, half})})
      for (std::uint32_t seed = 1; seed <= 60; ++seed) {
        World3 world(world_with<Dim3>());
        add_ground(world);
        world.add_shape(world.create_body(flung(seed, 0.8, seed % 2 == 0 ? 10.0f : 30.0f)).value(), shape).value();
        ASSERT_LT(gain_of(world, 90), 0.1) << "half " << half << " seed " << seed;
      }
}

/// Two sticks end to end, flung as one with `along` of spin about their length besides.
template <template <class> class Joint, class Change>
void fling_pair(World3& world, std::uint32_t seed, float spin, float along, float half, Change&& change) {
  BodyDef<Dim3> body = flung(seed, 1.8, spin);
  const Vec3f length = rotate(body.rotation, Vec3f{0, 1, 0});
  body.angular_velocity += along * length;
  Joint<Dim3> joint;
  joint.frame_a.p = {0, 0.5f, 0}, joint.frame_b.p = {0, -0.5f, 0};
  joint.body_a = world.create_body(body).value();
  body.position = body.position + Vec3d(length);
  body.linear_velocity += cross(body.angular_velocity, length);
  joint.body_b = world.create_body(body).value();
  for (const BodyId id : {joint.body_a, joint.body_b})
    world.add_shape(id, geometry::Capsule3{0.5f - half, half}).value();
  change(joint);
  world.create_joint(joint).value();
}

// The same of two that a joint holds together at their ends. With the inertia of the beginning one in ten of those of
// 1 : 50 on a ball joint gained more than half of its energy; on hinges, and welded, one in two was thrown by up to
// 10¹⁷ m/s. Continuous collision set back one and not the other, which the joint made energy of; a stick that rolls
// turns so far in a substep that its error of attitude is only known up to whole revolutions; and a contact began each
// substep with what the last one had given to both.
template <template <class> class Joint, class Change>
void expect_no_gain(const char* name, Change&& change) {
  for (const float half : {0.025f, 0.01f})
    for (std::uint32_t seed = 1; seed <= 40; ++seed) {
      World3 world(world_with<Dim3>());
      add_ground(world);
      fling_pair<Joint>(world, seed, seed % 2 == 0 ? 10.0f : 30.0f, 0, half, change);
      ASSERT_LT(gain_of(world, 120), 0.1) << name << ", half " << half << " seed " << seed;
    }
}
TEST(ThinPiece, GainsNothingOnAJoint) {
  const auto nothing = [](auto&) {};
  expect_no_gain<WeldJointDef>("weld", nothing);
  expect_no_gain<BallJointDef>("ball", nothing);
  expect_no_gain<BallJointDef>("cone", [](BallJointDef<Dim3>& joint) { joint.cone_angle = 0.5f; });
  expect_no_gain<HingeJointDef>("hinge", nothing);
  expect_no_gain<HingeJointDef>("hinge with stops",
                                [](HingeJointDef<Dim3>& joint) { joint.limit = {true, -0.5f, 0.5f}; });
}
// In the air 34 of 200 did, with 100 rad/s about their length.
TEST(ThinPiece, GainsNothingWhereItWhirls) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    World3 world(world_with<Dim3>());
    fling_pair<WeldJointDef>(world, seed, 60, 100, 0.01f, [](auto&) {});
    ASSERT_LT(gain_of(world, 120), 1e-3) << "seed " << seed;
  }
}

struct Burst {
  double fastest = 0;  ///< m/s
  double gain = 0;     ///< of the energy of all in a step, over what there was at first
};

/// Thirty pieces of about `size` fall one after the other from up to 24 times that.
std::vector<BodyId> add_falling(World3& world, const geometry::Shape3& shape, std::uint32_t seed, double size = 1) {
  Draw draw{seed};
  std::vector<BodyId> bodies;
  for (int i = 0; i < 30; ++i) {
    BodyDef<Dim3> body;
    const float x = draw(), z = draw(), w = draw(), a = draw(), b = draw(), c = draw();
    body.position = {0.1 * size * double(x), size * (0.5 + 0.8 * i), 0.1 * size * double(z)};
    body.rotation = normalize(Quatf{w, a, b, c});
    bodies.push_back(world.create_body(body).value());
    world.add_shape(bodies.back(), shape).value();
  }
  return bodies;
}

Burst drop(const geometry::Shape3& shape, std::uint32_t seed) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  const std::vector<BodyId> bodies = add_falling(world, shape, seed);
  Burst out;
  double before = 0, most = 0;
  for (int i = 0; i < 300; ++i) {
    world.step(frame).value();
    const Totals<Dim3> t = world.totals();
    const double now = t.kinetic_energy + t.potential_energy;
    most = std::max(most, now);
    if (i > 0) out.gain = std::max(out.gain, (now - before) / most);
    before = now;
    for (const BodyId body : bodies) out.fastest = std::max(out.fastest, double(speed(world, body)));
  }
  return out;
}

// A stick's moments of inertia are as 1 : 312. One of 30 such heaps threw its sticks apart at 200 m/s and more, while
// contacts took the inertia of the step's beginning for what turned by a radian meanwhile; one in 20 of boards, discs
// and cards did, while what is wedged got more mass the harder it was pressed.
TEST(ThinHeap, DoesNotBurst) {
  const geometry::Shape3 shapes[] = {geometry::Box{{0.5f, 0.02f, 0.02f}}, geometry::Box{{0.3f, 0.02f, 0.2f}},
                                     geometry::Box{{0.3f, 0.002f, 0.2f}}, geometry::Cylinder{0.01f, 0.3f},
                                     geometry::Cylinder{0.5f, 0.03f},     geometry::Capsule3{0.5f, 0.03f}};
  for (std::size_t kind = 0; kind < std::size(shapes); ++kind)
    for (std::uint32_t seed = 1; seed <= 12; ++seed) {
      const Burst burst = drop(shapes[kind], seed);
      EXPECT_LT(burst.fastest, 25) << "kind " << kind << " seed " << seed;
      EXPECT_LT(burst.gain, 0.1) << "kind " << kind << " seed " << seed;
    }
}

// Pieces that cross touched in one point, where two edges meet, and rocked from one edge to the other for good, pushed
// out of a millimetre each time: of 16 heaps of sticks none fell asleep within 30 s.
TEST(ThinHeap, FallsAsleep) {
  std::vector<Vec3f> rim;
  for (int i = 0; i < 12; ++i)
    for (const float y : {-0.01f, 0.01f}) {
      const float angle = float(i) * 0.5235988f;
      rim.push_back({0.3f * math::cos(angle), y, 0.3f * math::sin(angle)});
    }
  const geometry::Shape3 shapes[] = {geometry::Box{{0.5f, 0.02f, 0.02f}}, geometry::Box{{0.3f, 0.02f, 0.2f}},
                                     geometry::Box{{0.3f, 0.002f, 0.2f}}, geometry::make_hull(rim).value()};
  for (std::size_t kind = 0; kind < std::size(shapes); ++kind) {
    int asleep = 0;
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      World3 world(world_with<Dim3>());
      add_ground(world);
      add_falling(world, shapes[kind], seed);
      for (int i = 0; i < 30 && (i < 3 || world.counters().awake_bodies > 0); ++i) run(world, 60);
      asleep += world.counters().awake_bodies == 0 ? 1 : 0;
    }
    EXPECT_GE(asleep, 7) << "kind " << kind;
  }
}

// Ten cards of 10 cm, 3 mm thick, fall on each other from a few millimetres. Those below have to bear the others: as
// long as they counted for no more mass than they have, they lay in each other, four tenths of their height in all, and
// a heap of them shivered for good.
TEST(ThinHeap, CardsThatFellIntoEachOtherPart) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  const float thickness = 0.1f / 30;
  double top = 0;
  std::vector<BodyId> cards;
  for (int i = 0; i < 10; ++i)
    cards.push_back(add_body<Dim3>(world, BodyType::dynamic, geometry::Box{{0.05f, 0.5f * thickness, 0.05f}},
                                   {0, double(thickness) * (2.5 + 3 * i), 0}));
  run(world, 180);
  for (const BodyId card : cards) top = std::max(top, world.state(card).value().pose.position.y);
  EXPECT_GT(top, 9.2 * double(thickness));
  EXPECT_LT(world.worst_penetration(), 0.15f * thickness);
}

/// Thirty cards of the plane, 1 : 20, fall on a ground. How many of such heaps have a card that goes into it by more
/// than half its length?
int entered(double size, std::uint32_t heaps, void (*add)(World2&)) {
  int count = 0;
  for (std::uint32_t seed = 1; seed <= heaps; ++seed) {
    World2 world(world_with<Dim2>());
    add(world);
    Draw draw{seed};
    std::vector<BodyId> bodies;
    for (int i = 0; i < 30; ++i) {
      BodyDef<Dim2> body;
      const float x = draw(), angle = math::pi_f * draw();
      body.position = {0.1 * size * double(x), size * (0.5 + 0.8 * i)};
      body.rotation = {math::cos(angle), math::sin(angle)};
      bodies.push_back(world.create_body(body).value());
      world.add_shape(bodies.back(), geometry::make_box2({float(0.5 * size), float(0.025 * size)})).value();
    }
    double lowest = 0;
    for (int step = 0; step < 120; ++step) {
      world.step(frame).value();
      for (const BodyId body : bodies) lowest = std::min(lowest, world.state(body).value().pose.position.y);
    }
    count += lowest < -0.5 * size ? 1 : 0;
  }
  return count;
}

// Cards of a heap that lands are pressed into the ground deeper step by step. Once the guarded part of one had come to
// the surface, nothing held it any more, and it went into the ground by more than half its length within a step, to be
// pushed out later: in 7 of these 40 heaps of 1 cm.
TEST(ThinHeap, OfThePlaneStaysOnTheGround) {
  for (const double size : {0.01, 0.1, 1.0, 10.0}) {
    const int count = entered(size, size < 0.1 ? 40 : 8, [](World2& world) { add_ground(world); });
    EXPECT_LE(count, size < 0.1 ? 1 : 0) << "size " << size;
  }
}

// A chain stops only what comes from its front. Cards whose middle a heap had pressed through its line by some
// micrometres fell on as if they came from behind: in each of these heaps of 1 cm.
TEST(ThinHeap, OfThePlaneStaysOnAChain) {
  for (const double size : {0.01, 0.1, 1.0}) {
    const int count = entered(size, 12, [](World2& world) {
      add_body<Dim2>(world, BodyType::fixed,
                     geometry::make_chain({{100, 0}, {50, 0}, {5, 0}, {-5, 0}, {-100, 0}}, false).value(), {}, {});
    });
    EXPECT_EQ(count, 0) << "size " << size;
  }
}

// Nor do meshes let through what was pressed into them: of boards of 1 cm one in ten fell through, of those of 1 : 50
// every second one.
TEST(ThinHeap, StaysOnAMesh) {
  for (const double size : {0.01, 0.1})
    for (const float thickness : {0.05f, 0.02f}) {
      const float s = float(size);
      const geometry::Shape3 board = geometry::Box{{0.3f * s, 0.5f * thickness * s, 0.2f * s}};
      int below = 0;
      for (std::uint32_t seed = 1; seed <= 8; ++seed) {
        World3 world(world_with<Dim3>());
        std::vector<Vec3f> corners;
        std::vector<std::uint32_t> triangles;
        for (std::uint32_t i = 0; i < 64; ++i) {
          corners.push_back({4 * s * (float(i / 8) - 3.7f), 0, 4 * s * (float(i % 8) - 3.7f)});
          if (i < 56 && i % 8 < 7) triangles.insert(triangles.end(), {i, i + 1, i + 8, i + 1, i + 9, i + 8});
        }
        add_body<Dim3>(world, BodyType::fixed, geometry::make_triangle_mesh(corners, triangles).value(), {}, {});
        const std::vector<BodyId> bodies = add_falling(world, board, seed, size);
        run(world, 90);
        for (const BodyId body : bodies) {
          const Vec3d p = world.state(body).value().pose.position;
          below += p.y < -0.5 * size && math::length(Vec2d{p.x, p.z}) < 10 * size ? 1 : 0;
        }
      }
      EXPECT_EQ(below, 0) << "size " << size << " thickness " << thickness;
    }
}

}  // namespace thin_heap_test
}  // namespace carom::rigid::test
