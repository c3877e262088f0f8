// Coulomb's law: gates 4 to 8 and 24 (rigid-body.md 6.1). Default settings, g 9.81. Gravity leans instead of the
// ground.
#include <algorithm>
#include <cmath>

#include "tests/quality/gate.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::quality {
namespace friction {

using namespace carom::rigid;
using namespace carom::rigid::test;
using math::length;
constexpr double g = 9.81;

template <class D>
class QualityFriction : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(QualityFriction, Dimensions);

/// A slope of `a` rad that falls in the compass direction `heading`; in the plane heading 0 and π only.
template <class D>
WorldDef<D> slope(double a, double heading) {
  WorldDef<D> d;
  d.gravity = rigid::test::along<D>(float(g * std::sin(a) * std::cos(heading)), float(-g * std::cos(a)),
                                    float(g * std::sin(a) * std::sin(heading)));
  d.allow_sleep = false;
  return d;
}
template <class D>
typename D::Vector level(double v, double heading) {
  return rigid::test::along<D>(float(v * std::cos(heading)), 0, float(v * std::sin(heading)));
}
template <class D>
int headings() {
  return D::dimension == 2 ? 2 : 16;
}
template <class D>
double heading(int k) {
  return D::dimension == 2 ? k * pi : k * pi / 8;
}
constexpr Surface half{0.5f, 0, 1000, 0};

// Gate 4: tan α = .98 μ holds for a minute, tan α = 1.02 μ slides with g (sin α − μ cos α) = .08739 m/s².
TYPED_TEST(QualityFriction, CriticalSlope) {
  using D = TypeParam;
  double creep = 0, from_start = 0, worst = 0, reached = 0;
  const double steep = std::atan(1.02 * 0.5), expected = g * (std::sin(steep) - 0.5 * std::cos(steep));
  EXPECT_NEAR(expected, 0.08739, 1e-5);
  for (int k = 0; k < headings<D>(); ++k) {
    {
      World<D> world(slope<D>(std::atan(0.98 * 0.5), heading<D>(k)));
      add_ground(world, half);
      const BodyId box = add_box<D>(world, rigid::test::at<D>(0, 0.5), 0.5f, half);
      const auto start = world.state(box).value().pose.position;
      run(world, 60);
      const auto begin = world.state(box).value().pose.position;
      run(world, 3600);
      const auto end = world.state(box).value().pose.position;
      creep = std::max(creep, length(end - begin));
      auto moved = end - start;
      moved.y = 0;
      from_start = std::max(from_start, length(moved));
    }
    World<D> world(slope<D>(steep, heading<D>(k)));
    add_ground(world, half);
    const BodyId box = add_box<D>(world, rigid::test::at<D>(0, 0.5), 0.5f, half);
    run(world, 60);
    const float v1 = rigid::test::speed(world, box);
    run(world, 240);
    const double a = double(rigid::test::speed(world, box) - v1) / 4;
    if (std::abs(a - expected) >= worst) {
      worst = std::abs(a - expected);
      reached = a;
    }
  }
  Gate(4, "slope at .98 of the critical angle, 60 s: creep, every direction", D::dimension, "m").at_most(creep, 1e-4);
  Gate(4, "the same, with the first second in which it settles", D::dimension, "m").at_most(from_start, 1e-4);
  Gate(4, "slope at 1.02 of it: acceleration, worst direction", D::dimension, "m/s²").near(reached, expected, 0.01);
}

// Gate 5: v²/2μg.
TYPED_TEST(QualityFriction, StopDistance) {
  using D = TypeParam;
  const double truth = 25 / (2 * 0.5 * g);
  EXPECT_NEAR(truth, 2.548, 1e-3);
  double least = 1e9, most = 0, side = 0, worst = truth;
  for (int k = 0; k < headings<D>(); ++k) {
    const double th = heading<D>(k);
    WorldDef<D> d = world_with<D>();
    World<D> world(d);
    add_ground(world, half);
    const BodyId box = add_box<D>(world, rigid::test::at<D>(0, 0.5), 0.5f, half);
    run(world, 30);
    const auto begin = world.state(box).value().pose.position;
    world.set_velocity(box, level<D>(5, th), {}).value();
    run(world, 180);
    const auto way = world.state(box).value().pose.position - begin;
    double z = 0;
    if constexpr (D::dimension == 3) z = way.z;
    const double distance = way.x * std::cos(th) + z * std::sin(th);
    side = std::max(side, std::abs(way.x * std::sin(th) - z * std::cos(th)));
    least = std::min(least, distance);
    most = std::max(most, distance);
    if (std::abs(distance - truth) > std::abs(worst - truth)) worst = distance;
  }
  Gate(5, "stop from 5 m/s at μ .5: distance, worst direction", D::dimension, "m").near(worst, truth, 0.01);
  Gate(5, "the same: spread over directions", D::dimension, "%").at_most(100 * (most - least) / truth, 0.2);
  if (D::dimension == 3) Gate(5, "the same: drift to the side", D::dimension, "m").at_most(side, 1e-3);
}

/// When, where and how fast a ball of moment k m r² that starts to skid at 5 m/s begins to roll.
struct Roll {
  double time = 0, way = 0, speed = 0;
};
template <class D>
Roll skid_to_roll() {
  World<D> world(world_with<D>());
  const Surface slippery{0.2f, 0, 1000, 0};
  add_ground(world, slippery);
  const BodyId ball = add_ball<D>(world, rigid::test::at<D>(0, 0.5), 0.5f, slippery);
  run(world, 30);
  const double start = world.state(ball).value().pose.position.x;
  world.set_velocity(ball, rigid::test::along<D>(5, 0), {}).value();
  Roll out;
  double before = 5, x_before = 0;
  for (int i = 1; i <= 120; ++i) {
    world.step(frame).value();
    const BodyState<D> s = world.state(ball).value();
    const double slip = double(s.linear_velocity.x) + 0.5 * double(z_of(s.angular_velocity)),
                 x = s.pose.position.x - start;
    if (out.time == 0 && slip < 0.01) {
      // Slip falls at the constant rate that the steps before show; the rest of the way is rolled at a constant speed.
      const double rate = (5 - before) / (i - 1), part = before / rate;
      out.time = (i - 1 + part) / 60;
      out.way = x_before + (x - x_before) * part;
    }
    before = slip;
    x_before = x;
  }
  out.speed = double(world.state(ball).value().linear_velocity.x);
  return out;
}

// Gate 6. With I = k m r²: v₀/(1 + k), t = v₀ k/((1 + k) μ g), x = v₀ t − ½ μ g t². Sphere k = 2/5, disc k = ½.
TYPED_TEST(QualityFriction, SkidToRoll) {
  using D = TypeParam;
  const double k = D::dimension == 3 ? 0.4 : 0.5, mu = 0.2;
  const double v = 5 / (1 + k), t = 5 * k / ((1 + k) * mu * g), x = 5 * t - 0.5 * mu * g * t * t;
  if (D::dimension == 3) {
    EXPECT_NEAR(v, 3.5714, 1e-4);
    EXPECT_NEAR(t, 0.728, 1e-3);
    EXPECT_NEAR(x, 3.120, 1e-3);
  }
  const Roll roll = skid_to_roll<D>();
  Gate(6, "ball skids at 5 m/s, μ .2: rolls at", D::dimension, "m/s").near(roll.speed, v, 0.005);
  Gate(6, "the same: rolls after", D::dimension, "s").near(roll.time, t, 0.005);
  Gate(6, "the same: rolls from", D::dimension, "m").near(roll.way, x, 0.005);
}

// Gate 7: g sin α/(1 + k).
TYPED_TEST(QualityFriction, RollingDownAnIncline) {
  using D = TypeParam;
  const double a = math::radians(15.0);
  const auto acceleration = [&](const typename D::Shape& shape, typename D::Rotation rotation) {
    World<D> world(slope<D>(a, 0));
    add_ground(world);
    BodyDef<D> body;
    body.position = rigid::test::at<D>(0, 0.5);
    body.rotation = rotation;
    const BodyId id = world.create_body(body).value();
    world.add_shape(id, shape).value();
    run(world, 30);
    const float v1 = rigid::test::speed(world, id);
    run(world, 120);
    return double(rigid::test::speed(world, id) - v1) / 2;
  };
  const double pull = g * std::sin(a);
  if constexpr (D::dimension == 3) {
    EXPECT_NEAR(5.0 / 7 * pull, 1.8136, 1e-4);
    Gate(7, "sphere rolls down 15°: acceleration", 3, "m/s²")
        .near(acceleration(geometry::Sphere{0.5f}, {}), 5.0 / 7 * pull, 0.005);
    const Quatf lying = normalize(Quatf{1, 1, 0, 0});
    Gate(7, "cylinder (2D: disc) rolls down 15°: acceleration", 3, "m/s²")
        .near(acceleration(geometry::Cylinder{0.5f, 0.5f}, lying), 2.0 / 3 * pull, 0.005);
  } else {
    EXPECT_NEAR(2.0 / 3 * pull, 1.6927, 1e-4);
    Gate(7, "cylinder (2D: disc) rolls down 15°: acceleration", 2, "m/s²")
        .near(acceleration(geometry::Circle{0.5f}, {}), 2.0 / 3 * pull, 0.005);
  }
}

// Gate 7, with rolling resistance c: under the torque c r m g, m a = F and k m r² a/r = c r m g − F r give
// a = c g/(1 + k), and the way is v²/2a.
TYPED_TEST(QualityFriction, RollsOutUnderRollingResistance) {
  using D = TypeParam;
  const double c = 0.05, v = 3;
  const auto way = [&](const typename D::Shape& shape, typename D::Rotation rotation) {
    WorldDef<D> def = world_with<D>();
    def.allow_sleep = false;
    World<D> world(def);
    add_ground(world);
    BodyDef<D> body;
    body.position = rigid::test::at<D>(0, 0.5);
    body.rotation = rotation;
    const BodyId id = world.create_body(body).value();
    ShapeDef<D> d;
    d.material.rolling_resistance = float(c);
    world.add_shape(id, shape, d).value();
    run(world, 30);
    const double start = world.state(id).value().pose.position.x;
    world.set_velocity(id, rigid::test::along<D>(float(v), 0), about_z<D>(float(-v / 0.5))).value();
    run(world, 720);
    return world.state(id).value().pose.position.x - start;
  };
  const auto truth = [&](double k) { return v * v * (1 + k) / (2 * c * g); };
  if constexpr (D::dimension == 3) {
    EXPECT_NEAR(truth(0.4), 12.84, 0.01);
    Gate(7, "sphere with rolling resistance .05 rolls out from 3 m/s: way", 3, "m")
        .near(way(geometry::Sphere{0.5f}, {}), truth(0.4), 0.01);
    const Quatf lying = normalize(Quatf{1, 1, 0, 0});
    Gate(7, "cylinder (2D: disc) with rolling resistance .05 rolls out from 3 m/s: way", 3, "m")
        .near(way(geometry::Cylinder{0.5f, 0.5f}, lying), truth(0.5), 0.01);
  } else {
    Gate(7, "cylinder (2D: disc) with rolling resistance .05 rolls out from 3 m/s: way", 2, "m")
        .near(way(geometry::Circle{0.5f}, {}), truth(0.5), 0.01);
  }
}

// Gate 8, of a ball: the torque c r m g on ⅖ m r² stops the spin about the normal after 2 r ω₀/(5 c g).
TEST(QualityFriction3, SpinningBall) {
  World3 world(world_with<Dim3>());
  add_ground(world);
  const BodyId ball = add_ball<Dim3>(world, {0, 0.5, 0}, 0.5f, {.spinning_resistance = 0.05f});
  run(world, 30);
  world.set_velocity(ball, {}, {0, 20, 0}).value();
  run(world, 240);
  const double w = double(world.state(ball).value().angular_velocity.y), truth = 2 * 0.5 * 20 / (5 * 0.05 * g);
  EXPECT_NEAR(truth, 8.155, 1e-3);
  Gate(8, "ball spins on its spot at 20 rad/s, spinning resistance .05: stops after", 3, "s")
      .near(4 * 20 / (20 - w), truth, 0.01);
  run(world, 270);
  EXPECT_NEAR(length(world.state(ball).value().angular_velocity), 0, 1e-3);
  EXPECT_NEAR(length(world.state(ball).value().linear_velocity), 0, 1e-3);
}

// Gate 8: a disc under uniform pressure feels ⅔ μ m g R and stops after 3 R ω₀/(4 μ g).
TEST(QualityFriction3, SpinningDisc) {
  World3 world(world_with<Dim3>());
  add_ground(world, half);
  const BodyId disc = add_body<Dim3>(world, BodyType::dynamic, geometry::Cylinder{0.1f, 1.0f}, {0, 0.1, 0}, half);
  run(world, 30);
  world.set_velocity(disc, {}, {0, 20, 0}).value();
  int steps = 0;
  while (steps < 600 && world.state(disc).value().angular_velocity.y > 0.02f) {
    world.step(frame).value();
    ++steps;
  }
  const double truth = 3 * 20 / (4 * 0.5 * g);
  EXPECT_NEAR(truth, 3.058, 1e-3);
  Gate(8, "disc spinning on its face at 20 rad/s, R 1 m, μ .5: stops after", 3, "s").near(steps / 60.0, truth, 0.03);
}

// Gate 24: a = μ g until t = u/μg, then at the belt's speed.
template <class D>
void conveyor() {
  World<D> world(world_with<D>());
  const BodyId belt = add_ground(world, half);
  std::vector<ShapeId> shapes;
  world.shapes(belt, shapes);
  const BodyId box = add_box<D>(world, rigid::test::at<D>(0, 0.5), 0.5f, half);
  run(world, 30);
  if constexpr (D::dimension == 2) {
    Material m = world.shape_definition(shapes[0]).value().material;
    m.tangent_speed = -3;  // counterclockwise round the shape is positive: the top goes to −x
    world.set_material(shapes[0], m).value();
  } else {
    world.set_surface_velocity(shapes[0], {3, 0, 0}).value();
  }
  const double t = 3 / (0.5 * g);  // .6116 s
  run(world, 30);
  const double a = double(world.state(box).value().linear_velocity.x) / 0.5;
  Gate(24, "conveyor at 3 m/s, μ .5: acceleration", D::dimension, "m/s²").near(a, 0.5 * g, 0.01);
  int steps = 30;
  while (steps < 120 && world.state(box).value().linear_velocity.x < 2.999f) {
    world.step(frame).value();
    ++steps;
  }
  EXPECT_NEAR(steps / 60.0, t, 1.0 / 60) << "u/μg, to the step";
  run(world, 60);
  Gate(24, "the same: speed in the end", D::dimension, "m/s")
      .near(double(world.state(box).value().linear_velocity.x), 3, 0.01);
}
TEST(QualityFriction3, Conveyor) { conveyor<Dim3>(); }
TEST(QualityFriction2, Conveyor) { conveyor<Dim2>(); }

}  // namespace friction
}  // namespace carom::quality
