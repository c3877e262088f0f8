// Articulations: inverse dynamics against closed forms and against what the world then does; muscles against the
// oscillator that they are to be.
#include "carom/rigid/articulation.h"

#include <gtest/gtest.h>

#include "carom/math/rotation.h"
#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
HingeJointDef<D> hinge_at(const World<D>& world, BodyId a, BodyId b, typename D::Position point) {
  HingeJointDef<D> d;
  d.body_a = a, d.body_b = b;
  const auto local = [&](BodyId body) {
    const auto pose = world.state(body).value().pose;
    return typename D::Vector(inverse_rotate(pose.rotation, typename D::Vector(point - pose.position)));
  };
  d.frame_a.p = local(a), d.frame_b.p = local(b);
  return d;
}

/// Two rods that hang from a fixed body: along x, from the origin, of lengths l1 and l2.
template <class D>
struct TwoRods {
  static constexpr float half[2] = {0.5f, 0.4f};
  World<D> world;
  BodyId base, rod[2];
  JointId joint[2];
  explicit TwoRods(const WorldDef<D>& def = world_with<D>()) : world(def) {
    base = world.create_body({.type = BodyType::fixed}).value();
    rod[0] = add_body<D>(world, BodyType::dynamic, box_shape<D>(half[0], 0.05f, 0.05f), at<D>(double(half[0]), 0));
    rod[1] = add_body<D>(world, BodyType::dynamic, box_shape<D>(half[1], 0.08f, 0.05f),
                         at<D>(double(2 * half[0] + half[1]), 0));
    joint[0] = world.create_joint(hinge_at<D>(world, base, rod[0], at<D>(0, 0))).value();
    joint[1] = world.create_joint(hinge_at<D>(world, rod[0], rod[1], at<D>(double(2 * half[0]), 0))).value();
  }
  double mass(int i) const { return double(world.state(rod[i]).value().mass); }
  double inertia(int i) const {
    if constexpr (D::dimension == 2)
      return world.mass_properties2(rod[i]).value().inertia;
    else
      return world.mass_properties3(rod[i]).value().inertia.cz.z;
  }
  /// Puts the rods at angles from the level, turning.
  void pose(double q1, double q2, double w1, double w2) {
    const double l1 = 2 * double(half[0]), c1 = double(half[0]), c2 = double(half[1]), s = q1 + q2;
    const auto turn = [](double angle) {
      if constexpr (D::dimension == 2)
        return from_angle(float(angle));
      else
        return from_axis_angle(Vec3f{0, 0, 1}, float(angle));
    };
    const auto spin = [](double w) {
      if constexpr (D::dimension == 2)
        return float(w);
      else
        return Vec3f{0, 0, float(w)};
    };
    world.set_pose(rod[0], at<D>(c1 * math::cos(q1), c1 * math::sin(q1)), turn(q1)).value();
    world
        .set_pose(rod[1], at<D>(l1 * math::cos(q1) + c2 * math::cos(s), l1 * math::sin(q1) + c2 * math::sin(s)),
                  turn(s))
        .value();
    world.set_velocity(rod[0], along<D>(float(-c1 * math::sin(q1) * w1), float(c1 * math::cos(q1) * w1)), spin(w1))
        .value();
    world
        .set_velocity(rod[1],
                      along<D>(float(-l1 * math::sin(q1) * w1 - c2 * math::sin(s) * (w1 + w2)),
                               float(l1 * math::cos(q1) * w1 + c2 * math::cos(s) * (w1 + w2))),
                      spin(w1 + w2))
        .value();
  }
};

// The planar elbow manipulator (Spong, Hutchinson & Vidyasagar, "Robot Modeling and Control", 2006, §7.4).
template <class D>
void expect_the_elbow_manipulator() {
  TwoRods<D> rods;
  const double q1 = 0.7, q2 = -1.1, w1 = 1.3, w2 = 2.1, a1 = 3.0, a2 = -4.0, g = 9.81;
  rods.pose(q1, q2, w1, w2);
  auto tree = Articulation<D>::create(rods.world, rods.rod[1]).value();
  ASSERT_FALSE(tree.floating());
  ASSERT_EQ(tree.degrees(), 2);
  ASSERT_EQ(tree.find(rods.joint[0]), 0);
  ASSERT_EQ(tree.find(rods.joint[1]), 1);
  EXPECT_NEAR(tree.coordinates()[0], q1, 1e-6);
  EXPECT_NEAR(tree.coordinates()[1], q2, 1e-6);
  EXPECT_NEAR(tree.speeds()[0], w1, 1e-6);
  EXPECT_NEAR(tree.speeds()[1], w2, 1e-6);
  const double accelerations[2] = {a1, a2};
  double torques[2];
  tree.inverse_dynamics(accelerations, torques).value();
  const double m1 = rods.mass(0), m2 = rods.mass(1), i1 = rods.inertia(0), i2 = rods.inertia(1), l1 = 1, c1 = 0.5,
               c2 = double(rods.half[1]);
  const double d11 = m1 * c1 * c1 + m2 * (l1 * l1 + c2 * c2 + 2 * l1 * c2 * math::cos(q2)) + i1 + i2;
  const double d12 = m2 * (c2 * c2 + l1 * c2 * math::cos(q2)) + i2, d22 = m2 * c2 * c2 + i2;
  const double h = -m2 * l1 * c2 * math::sin(q2);
  const double phi2 = m2 * c2 * g * math::cos(q1 + q2), phi1 = (m1 * c1 + m2 * l1) * g * math::cos(q1) + phi2;
  const double first = d11 * a1 + d12 * a2 + h * w2 * w2 + 2 * h * w1 * w2 + phi1;
  const double second = d12 * a1 + d22 * a2 - h * w1 * w1 + phi2;
  EXPECT_NEAR(torques[0], first, 2e-5 * math::abs(first));
  EXPECT_NEAR(torques[1], second, 2e-5 * math::abs(second));
}
TEST(Articulation, InverseDynamicsOfTheElbowManipulator) {
  expect_the_elbow_manipulator<Dim2>();
  expect_the_elbow_manipulator<Dim3>();
}

// The cart and pole: (M + m) ẍ + m l (θ̈ cos θ − θ̇² sin θ) = F and I θ̈ + m l (l θ̈ + ẍ cos θ + g sin θ) = τ, with θ from
// the way down.
TEST(Articulation, InverseDynamicsOfTheCartAndPole) {
  World3 world(world_with<Dim3>());
  const BodyId rail = world.create_body({.type = BodyType::fixed}).value();
  const BodyId cart = add_box<Dim3>(world, {0.3, 0, 0}, 0.2f);
  const double theta = 0.6, w = 1.7, v = 0.8, l = 0.7;
  const BodyId pole =
      world
          .create_body({.position = {0.3 + l * math::sin(theta), -l * math::cos(theta), 0},
                        .rotation = from_axis_angle(Vec3f{0, 0, 1}, float(theta)),
                        .linear_velocity = {float(v + l * math::cos(theta) * w), float(l * math::sin(theta) * w), 0},
                        .angular_velocity = {0, 0, float(w)}})
          .value();
  world.add_shape(pole, geometry::Box{{0.05f, 0.7f, 0.05f}}).value();
  world.set_velocity(cart, {float(v), 0, 0}, {}).value();
  SliderJointDef<Dim3> slide;
  slide.body_a = rail, slide.body_b = cart;
  world.create_joint(slide).value();
  HingeJointDef<Dim3> hang;  // the pole is body A: the tree goes against the joint
  hang.body_a = pole, hang.body_b = cart;
  hang.frame_a.p = {0, float(l), 0};
  world.create_joint(hang).value();
  auto tree = Articulation3::create(world, cart).value();
  ASSERT_EQ(tree.degrees(), 2);
  EXPECT_NEAR(tree.coordinates()[0], 0.3, 1e-6);
  EXPECT_NEAR(tree.coordinates()[1], -theta, 1e-6) << "of the cart in the pole's frame";
  EXPECT_NEAR(tree.speeds()[0], v, 1e-6);
  EXPECT_NEAR(tree.speeds()[1], -w, 1e-6);
  const double x2 = 2.5, turn = -3.5;
  const double accelerations[2] = {x2, -turn};
  double torques[2];
  tree.inverse_dynamics(accelerations, torques).value();
  const double m = double(world.state(pole)->mass), mass = double(world.state(cart)->mass),
               inertia = world.mass_properties3(pole)->inertia.cz.z, g = 9.81;
  const double force = (mass + m) * x2 + m * l * (turn * math::cos(theta) - w * w * math::sin(theta));
  const double torque = inertia * turn + m * l * (l * turn + x2 * math::cos(theta) + g * math::sin(theta));
  EXPECT_NEAR(torques[0], force, 2e-5 * math::abs(force));
  EXPECT_NEAR(-torques[1], torque, 2e-5 * math::abs(torque));
}

/// A body with limbs on ball joints, a hinge and a slider, thrown.
struct Creature {
  World3 world;
  std::vector<BodyId> parts;
  explicit Creature(const WorldDef<Dim3>& def) : world(def) {
    const Quatf tilt = from_axis_angle(Vec3f{1, 2, 3}, 0.8f);
    const auto part = [&](Vec3f at, Vec3f half) {
      const Vec3f arm = rotate(tilt, at);
      BodyDef<Dim3> d;
      d.position = Vec3d{5, 3, -2} + Vec3d(arm);
      d.rotation = tilt;
      d.linear_velocity = {1, 2, -1};
      parts.push_back(world.create_body(d).value());
      world.add_shape(parts.back(), geometry::Box{half}).value();
    };
    part({0, 0, 0}, {0.3f, 0.2f, 0.25f});
    part({0.6f, 0, 0}, {0.3f, 0.08f, 0.07f});
    part({1.2f, 0, 0}, {0.3f, 0.06f, 0.05f});
    part({0, 0.5f, 0}, {0.1f, 0.3f, 0.1f});
    part({-0.6f, 0, 0}, {0.3f, 0.09f, 0.06f});
    part({0, -0.6f, 0.1f}, {0.05f, 0.4f, 0.08f});
    BallJointDef<Dim3> ball;
    ball.body_a = parts[0], ball.body_b = parts[1];
    ball.frame_a = {{0.3f, 0, 0}, from_axis_angle(Vec3f{0, 1, 1}, 0.3f)};
    ball.frame_b = {{-0.3f, 0, 0}, from_axis_angle(Vec3f{1, 0, 1}, 0.5f)};
    world.create_joint(ball).value();
    HingeJointDef<Dim3> hinge;
    hinge.body_a = parts[2], hinge.body_b = parts[1];
    hinge.frame_a.p = {-0.3f, 0, 0}, hinge.frame_b.p = {0.3f, 0, 0};
    world.create_joint(hinge).value();
    SliderJointDef<Dim3> slide;
    slide.body_a = parts[3], slide.body_b = parts[0];
    slide.frame_a.p = {0, -0.5f, 0};
    world.create_joint(slide).value();
    ball = {};
    ball.body_a = parts[4], ball.body_b = parts[0];
    ball.frame_a.p = {0.3f, 0, 0}, ball.frame_b.p = {-0.3f, 0, 0};
    world.create_joint(ball).value();
    WeldJointDef<Dim3> weld;
    weld.body_a = parts[0], weld.body_b = parts[5];
    weld.frame_a.p = {0, -0.2f, 0.1f}, weld.frame_b.p = {0, 0.4f, 0};
    world.create_joint(weld).value();
  }
};

// What inverse dynamics says, the world does: the speeds of all joints change by a dt.
TEST(Articulation, TheWorldAcceleratesAsAsked) {
  for (const bool held : {false, true}) {
    WorldDef<Dim3> def = world_with<Dim3>();
    def.joint_solver = JointSolver::direct;
    def.substeps = 8;
    Creature creature(def);
    World3& world = creature.world;
    if (held) {
      world.set_type(creature.parts[0], BodyType::fixed).value();
      for (std::size_t i = 1; i < creature.parts.size(); ++i) world.set_velocity(creature.parts[i], {}, {}).value();
    }
    auto tree = Articulation3::create(world, creature.parts[1]).value();
    ASSERT_EQ(tree.floating(), !held);
    ASSERT_EQ(tree.degrees(), held ? 4 : 8) << "held, each limb is a mechanism of its own";
    const float dt = 1e-3f;
    std::vector<double> wanted;
    for (int i = 0; i < tree.degrees(); ++i) wanted.push_back(i % 2 ? -4.0 + i : 5.0 - 0.5 * i);
    // Targets that are so soft that their acceleration is all there is to them.
    for (std::size_t k = 0; k < tree.joints().size(); ++k) {
      const ArticulationJoint& j = tree.joints()[k];
      const auto three = [&](std::span<const double> x) {
        const std::size_t i = std::size_t(j.first);
        return Vec3d{x[i], x[i + 1], x[i + 2]};
      };
      const std::size_t i = std::size_t(j.first);
      if (j.degrees == 3)
        tree.set_target(int(k), Quatf(from_rotation_vector(three(tree.coordinates()))),
                        Vec3f(three(tree.speeds()) + three(wanted) * double(dt)), Vec3f(three(wanted)))
            .value();
      else if (j.degrees == 1)
        tree.set_target(int(k), tree.coordinates()[i], tree.speeds()[i] + wanted[i] * double(dt), wanted[i]).value();
    }
    tree.set_muscles({.hertz = 0.01}).value();
    const std::vector<double> before(tree.speeds().begin(), tree.speeds().end());
    const Vec3d momentum = world.totals().momentum;
    tree.drive(world, dt).value();
    world.step(dt).value();
    tree.read(world).value();
    for (std::size_t i = 0; i < before.size(); ++i)
      EXPECT_NEAR((tree.speeds()[i] - before[i]) / double(dt), wanted[i], 0.08)
          << "coordinate " << i << " held " << held;
    if (held) continue;
    const double fall = -9.81 * world.totals().mass * double(dt);
    EXPECT_NEAR(world.totals().momentum.y - momentum.y, fall, 1e-3 * math::abs(fall));
    EXPECT_NEAR(world.totals().momentum.x, momentum.x, 1e-3 * math::abs(momentum.x)) << "muscles push nothing outside";
  }
}

// A free tree that flies fast keeps a slow motion of its joints: how fast it flies makes no difference to it.
TEST(Articulation, FastFlightLeavesSlowJointsAlone) {
  for (const float flight : {0.0f, 300.0f}) {
    WorldDef<Dim3> def = world_with<Dim3>(0);
    def.joint_solver = JointSolver::direct;
    def.allow_sleep = false;
    World3 world(def);
    BodyId rod[2];
    for (int i = 0; i < 2; ++i) {
      rod[i] = world
                   .create_body({.position = {i == 0 ? -0.5 : 0.5, 0, 0},
                                 .linear_velocity = {flight, -0.005f, 0},
                                 .angular_velocity = {0, 0, i == 0 ? 0.01f : -0.01f}})
                   .value();
      world.add_shape(rod[i], geometry::Box{{0.5f, 0.1f, 0.1f}}).value();
    }
    world.create_joint(hinge_at<Dim3>(world, rod[0], rod[1], {0, 0, 0})).value();
    auto tree = Articulation3::create(world, rod[0]).value();
    EXPECT_NEAR(tree.speeds()[0], -0.02, 1e-6);
    run(world, 60);
    tree.read(world).value();
    EXPECT_NEAR(tree.speeds()[0], -0.02, 2e-4) << flight;
    EXPECT_NEAR(tree.coordinates()[0], -0.02, 4e-4) << flight;
  }
}

// Nor how fast it spins: two rods that spin about their common hinge open and close against each other, for ever.
TEST(Articulation, FastSpinLeavesSlowJointsAlone) {
  for (const float spin : {1.0f, 5.0f, 10.0f, 20.0f})
    for (const float opening : {0.02f, 0.2f}) {
      WorldDef<Dim3> def = world_with<Dim3>(0);
      def.joint_solver = JointSolver::direct;
      def.allow_sleep = false;
      World3 world(def);
      BodyId rod[2];
      for (int i = 0; i < 2; ++i) {
        const float x = i == 0 ? -0.5f : 0.5f, inner = 0.5f * opening;
        rod[i] = world
                     .create_body({.position = {double(x), 0, 0},
                                   .linear_velocity = {0, spin * x - 0.5f * inner, 0},
                                   .angular_velocity = {0, 0, i == 0 ? spin + inner : spin - inner}})
                     .value();
        world.add_shape(rod[i], geometry::Box{{0.5f, 0.1f, 0.1f}}).value();
      }
      world.create_joint(hinge_at<Dim3>(world, rod[0], rod[1], {0, 0, 0})).value();
      auto tree = Articulation3::create(world, rod[0]).value();
      const double energy = world.totals().kinetic_energy;
      double last = 0;
      for (int i = 0; i < 600; ++i) {
        world.step(frame).value();
        tree.read(world).value();
        // The last whole swing: its frequency is of the order of the spin's.
        if (i >= 600 - int(420 / spin)) last = std::max(last, math::abs(tree.speeds()[0]));
      }
      EXPECT_GT(last, 0.85 * double(opening)) << "spin " << spin;
      EXPECT_LT(last, 1.02 * double(opening)) << "spin " << spin;
      EXPECT_NEAR(world.totals().kinetic_energy / energy, 1, 1e-4) << "spin " << spin << " opening " << opening;
    }
}

// Whatever hangs on it, a joint swings with the frequency and damping that were asked for: e^(−ζωt) cos(√(1−ζ²) ωt).
TEST(Articulation, MusclesAreOscillatorsOfTheirFrequency) {
  for (const double zeta : {0.1, 1.0}) {
    WorldDef<Dim2> def = world_with<Dim2>();
    def.joint_solver = JointSolver::direct;
    TwoRods<Dim2> rods(def);
    rods.pose(0.4, 0.3, 0, 0);
    auto arm = Articulation2::create(rods.world, rods.rod[0]).value();
    arm.set_muscles({.hertz = 1, .damping_ratio = zeta}).value();
    arm.set_target(0, 0.2).value();
    arm.set_target(1, 0.6).value();
    const double omega = 2 * math::pi, sway = omega * math::sqrt(max(0.0, 1 - zeta * zeta));
    double worst = 0;
    for (int i = 0; i < 120; ++i) {
      arm.drive(rods.world, frame).value();
      rods.world.step(frame).value();
      arm.read(rods.world).value();
      const double t = rods.world.time(), decay = math::exp(-zeta * omega * t);
      const double shape = zeta < 1 ? decay * (math::cos(sway * t) + zeta * omega / sway * math::sin(sway * t))
                                    : decay * (1 + omega * t);
      worst = max(worst, math::abs(arm.coordinates()[0] - 0.2 - 0.2 * shape));
      worst = max(worst, math::abs(arm.coordinates()[1] - 0.6 + 0.3 * shape));
    }
    EXPECT_LT(worst, 0.02) << "of 0.3 rad, ζ " << zeta;
  }
}

// A rod on a foot on the ground, leaning: with the foot planted its ankle settles as the oscillator of its muscle,
// q (1 + ω t) e^(−ωt); pushing as if the foot were free, it topples.
TEST(Articulation, MusclesPushAgainstAPlantedFoot) {
  const auto last = [](bool planted, double& worst) {
    WorldDef<Dim2> def = world_with<Dim2>();
    def.joint_solver = JointSolver::direct;
    World2 world(def);
    add_ground(world);
    const double lean = 0.03;
    const BodyId foot =
        add_body<Dim2>(world, BodyType::dynamic, box_shape<Dim2>(0.2f, 0.05f, 0.1f), at<Dim2>(0, 0.05), {0.9f});
    const BodyId rod =
        add_body<Dim2>(world, BodyType::dynamic, box_shape<Dim2>(0.05f, 0.5f, 0.1f), at<Dim2>(0, 0.6), {0.5f});
    world.create_joint(hinge_at<Dim2>(world, foot, rod, at<Dim2>(0, 0.1))).value();
    run(world, 30);  // the ground takes up the load of the foot
    world.set_pose(rod, at<Dim2>(-0.5 * math::sin(lean), 0.1 + 0.5 * math::cos(lean)), from_angle(float(lean))).value();
    world.set_velocity(rod, {}, 0).value();
    auto leg = Articulation2::create(world, foot).value();
    EXPECT_TRUE(leg.floating());
    leg.set_muscles({.hertz = 1, .damping_ratio = 1}).value();
    leg.set_target(0, 0.0).value();
    leg.plant(planted);
    const double omega = 2 * math::pi;
    for (int i = 1; i <= 120; ++i) {
      leg.drive(world, frame).value();
      world.step(frame).value();
      leg.read(world).value();
      const double t = i * double(frame);
      worst = max(worst, math::abs(leg.coordinates()[0] - lean * (1 + omega * t) * math::exp(-omega * t)));
    }
    return math::abs(leg.coordinates()[0]);
  };
  double worst = 0, unused = 0;
  EXPECT_LT(last(true, worst), 0.001);
  EXPECT_LT(worst, 0.003) << "of 0.03 rad";
  EXPECT_GT(last(false, unused), 0.2);
}

// Computed torque: an arm of three links with a load of twenty times its hand follows a path of 1 Hz within a
// degree, with soft muscles.
TEST(Articulation, AnArmFollowsItsPath) {
  WorldDef<Dim3> def = world_with<Dim3>();
  def.joint_solver = JointSolver::direct;
  TwoRods<Dim3> rods(def);
  const BodyId load = add_box<Dim3>(rods.world, {1.8, 0, 0}, 0.15f, {.density = 7000});
  WeldJointDef<Dim3> weld;
  weld.body_a = rods.rod[1], weld.body_b = load;
  weld.frame_a.p = {0.4f, 0, 0}, weld.frame_b.p = {0.4f - 0.4f, 0, 0};
  rods.world.create_joint(weld).value();
  auto arm = Articulation3::create(rods.world, load).value();
  ASSERT_EQ(arm.degrees(), 2);
  arm.set_muscles({.hertz = 2}).value();
  const double rate = 2 * math::pi;
  double worst = 0;
  for (int i = 0; i < 240; ++i) {
    const double t = rods.world.time() + double(frame), ease = min(1.0, t);  // both at rest to begin with
    const double k = ease * ease * (3 - 2 * ease), kd = t < 1 ? 6 * t * (1 - t) : 0, kdd = t < 1 ? 6 - 12 * t : 0;
    const double s = math::sin(rate * t), c = math::cos(rate * t);
    for (int j = 0; j < 2; ++j) {
      const double amplitude = j == 0 ? 0.5 : -0.9;
      arm.set_target(j, amplitude * k * s, amplitude * (kd * s + k * rate * c),
                     amplitude * (kdd * s + 2 * kd * rate * c - k * rate * rate * s))
          .value();
    }
    arm.drive(rods.world, frame).value();
    rods.world.step(frame).value();
    arm.read(rods.world).value();
    const double after = rods.world.time(), e = min(1.0, after);
    for (int j = 0; j < 2; ++j)
      worst = max(worst, math::abs(arm.coordinates()[std::size_t(j)] -
                                   (j == 0 ? 0.5 : -0.9) * e * e * (3 - 2 * e) * math::sin(rate * after)));
  }
  EXPECT_LT(worst, math::pi / 180) << "rad";
}

TEST(Articulation, ALimitIsNeverPassedAndWeakMusclesSag) {
  TwoRods<Dim2> rods;
  auto arm = Articulation2::create(rods.world, rods.rod[0]).value();
  const double need = [&] {
    double torques[2];
    const double none[2] = {0, 0};
    arm.inverse_dynamics(none, torques).value();
    return torques[0];
  }();
  for (const double share : {1.05, 0.95}) {
    rods.pose(0, 0, 0, 0);
    arm.read(rods.world).value();
    arm.hold().value();
    arm.set_muscles({.hertz = 3, .max_torque = share * need}).value();
    for (int i = 0; i < 60; ++i) {
      arm.drive(rods.world, frame).value();
      EXPECT_LE(math::abs(arm.torques()[0]), share * need * 1.0001);
      rods.world.step(frame).value();
    }
    arm.read(rods.world).value();
    if (share > 1)
      EXPECT_NEAR(arm.coordinates()[0], 0, 0.02);
    else
      EXPECT_LT(arm.coordinates()[0], -0.2);
  }
  arm.set_muscles({.hertz = 0}).value();
  arm.drive(rods.world, frame).value();
  EXPECT_EQ(arm.torques()[0], 0) << "limp";
}

TEST(Articulation, WhatIsNotATreeIsRefused) {
  TwoRods<Dim2> rods;
  EXPECT_FALSE(Articulation2::create(rods.world, rods.base).ok());
  EXPECT_FALSE(Articulation2::create(rods.world, BodyId{}).ok());
  auto arm = Articulation2::create(rods.world, rods.rod[0]).value();
  double one[1] = {0}, two[2] = {0, 0};
  EXPECT_NE(arm.inverse_dynamics(one, two).error().message.find("expected 2"), std::string::npos);
  two[1] = std::numeric_limits<double>::quiet_NaN();
  double torques[2];
  EXPECT_FALSE(arm.inverse_dynamics(two, torques).ok());
  EXPECT_FALSE(arm.set_target(2, 0).ok());
  EXPECT_FALSE(arm.set_target(-1, 0).ok());
  EXPECT_FALSE(arm.set_target(0, two[1]).ok());
  EXPECT_FALSE(arm.set_target(0, Quatf{}).ok()) << "a hinge";
  EXPECT_FALSE(arm.set_muscles({.hertz = -1}).ok());
  EXPECT_FALSE(arm.set_muscle(7, {}).ok());
  EXPECT_FALSE(arm.drive(rods.world, 0).ok());
  const JointId loop = rods.world.create_joint(hinge_at<Dim2>(rods.world, rods.base, rods.rod[1], {1.8, 0})).value();
  EXPECT_NE(Articulation2::create(rods.world, rods.rod[0]).error().message.find("loop"), std::string::npos);
  rods.world.destroy_joint(loop).value();
  rods.world.destroy_body(rods.rod[1]).value();
  EXPECT_FALSE(arm.drive(rods.world, frame).ok());
}

}  // namespace
}  // namespace carom::rigid::test
