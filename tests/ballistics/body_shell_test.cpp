// A spinning shell as a body of a world flies as the model alone does; what touches it or pushes it counts; it lands as
// a rigid body; and a snapshot takes it back to the bit.
#include "carom/ballistics/body_shell.h"

#include <gtest/gtest.h>

#include <bit>

#include "carom/core/hash.h"
#include "carom/rigid/snapshot.h"
#include "tests/ballistics/pieces.h"

namespace ballistics_body_shell_test {
using namespace carom;
using namespace carom::ballistics;
using ballistics::test::artillery;
using math::Vec3d;
using rigid::Dim3;

constexpr double mil = 2 * math::pi / 6400;

struct Fired {
  rigid::World3 world;
  BodyShell shell;
  double dt;

  static rigid::WorldDef<Dim3> settings(int threads) {
    rigid::WorldDef<Dim3> d;
    d.gravity = {0, -9.80665f, 0};
    d.threads = threads;
    return d;
  }
  explicit Fired(const BodyShellDef& d, double step, int threads = 1)
      : world(settings(threads)), shell(BodyShell::make(world, d).value()), dt(step) {}
  void ground() {
    const rigid::BodyId body = world.create_body({.type = rigid::BodyType::fixed}).value();
    world.add_shape(body, geometry::Plane{}).value();
  }
  void step() {
    ASSERT_TRUE(shell.before_step(world, dt).ok());
    ASSERT_TRUE(world.step(float(dt)).ok());
  }
  void run(double until) {
    while (world.time() < until - 0.5 * dt) step();
  }
  rigid::BodyState<Dim3> state() const { return world.state(shell.body()).value(); }
};

BodyShellDef shot(double speed, double elevation, ShellModel model, double twist = 20) {
  BodyShellDef d{.shell = m107(), .model = model, .conditions = artillery()};
  d.shell.twist = twist;
  d.start = {{0, 2, 0}, speed * direction(elevation)};
  return d;
}

// The steps are the model's own: at 60 Hz and at 240 the body is where fly_shell says, within two millimetres of eleven
// kilometres.
TEST(BodyShell, FliesAsTheModelAlone) {
  for (const ShellModel model : {ShellModel::modified_point_mass, ShellModel::six_degrees}) {
    BodyShellDef d = shot(474, 539.9 * mil, model);
    const environment::WindColumn::Level layers[] = {{0, {3, 0, -4}}, {800, {-6, 0, 9}}};
    d.conditions.wind = environment::WindColumn(layers);
    d.conditions.rotation = earth_rotation_rate(0.8, 0.6);
    d.tip = {0, 1, 2};
    const auto alone = fly_shell(d.shell, d.conditions, d.start, model, {.time = 39, .tolerance = 1e-10}, d.tip);
    ASSERT_TRUE(alone) << alone.error().message;
    for (const double dt : {1.0 / 60, 1.0 / 240}) {
      Fired fired(d, dt);
      double worst = 0, worst_pose = 0;
      for (const double until : {1.0, 8.0, 20.0, 38.9}) {
        while (fired.world.time() < until) {
          fired.step();
          const rigid::BodyState<Dim3> state = fired.state();
          worst = math::max(worst, distance(state.center_of_mass, alone->path.at(fired.world.time()).position));
          worst_pose = math::max(worst_pose, distance(rotate(math::Quatd(state.pose.rotation), Vec3d{1, 0, 0}),
                                                      fired.shell.motion().axis));
        }
        const auto there =
            fly_shell(d.shell, d.conditions, d.start, model, {.time = fired.world.time(), .tolerance = 1e-10}, d.tip)
                ->states.back();
        EXPECT_NEAR(fired.shell.motion().spin, there.spin, 1e-3) << int(model) << ' ' << dt;
        EXPECT_LT(distance(fired.shell.motion().axis, there.axis), 1e-5) << int(model) << ' ' << dt << ' ' << until;
        EXPECT_NEAR(fired.shell.yaw(), there.yaw, 1e-5) << int(model) << ' ' << dt << ' ' << until;
        EXPECT_LT(distance(fired.shell.motion().velocity, there.velocity), 1e-4);
      }
      EXPECT_LT(worst, 0.002) << int(model) << ' ' << dt;
      EXPECT_LT(worst_pose, 1e-5) << "the pose follows";
    }
  }
}

// A left-hand twist drifts to the left by as much.
TEST(BodyShell, MirroredTwistMirrorsTheDrift) {
  for (const ShellModel model : {ShellModel::modified_point_mass, ShellModel::six_degrees}) {
    Vec3d ends[2];
    for (int k = 0; k < 2; ++k) {
      Fired fired(shot(474, 258.4 * mil, model, k == 0 ? 20 : -20), 1.0 / 60);
      fired.run(20);
      ends[k] = fired.state().center_of_mass;
    }
    EXPECT_GT(ends[0].z, 40) << "a right-hand twist, to the right";
    EXPECT_NEAR(ends[1].z, -ends[0].z, 1e-4 * ends[0].z);
    EXPECT_NEAR(ends[1].x, ends[0].x, 1e-6 * ends[0].x);
    EXPECT_NEAR(ends[1].y, ends[0].y, 1e-3);
  }
}

// A crosswind that begins at the muzzle makes the nose swing about the way through the air: a jump across the wind, up
// or down by the twist, as far as the model alone says and of the size of I_t p C_Nα/(m d V C_Mα) · yaw · I_x/I_t.
TEST(BodyShell, AerodynamicJumpGoesWithTheTwist) {
  double height[2] = {};
  for (int k = 0; k < 2; ++k) {
    BodyShellDef d = shot(474, 0.01, ShellModel::six_degrees, k == 0 ? 20 : -20);
    d.conditions.wind = environment::WindColumn(Vec3d{0, 0, -15});  // from the right
    Fired fired(d, 1.0 / 60);
    fired.run(1);
    height[k] = fired.state().center_of_mass.y;
    const auto alone = fly_shell(d.shell, d.conditions, d.start, d.model, {.time = 1, .tolerance = 1e-10});
    EXPECT_NEAR(height[k], alone->path.end().position.y, 1e-3);
  }
  // McCoy's jump for the first yaw δ₀ of a spinning shell: I_x p C_Nα/(m d V C_Mα) δ₀ (rad), across the yaw.
  const Shell shell = m107();
  const double mach = 474 / 340.3, p = muzzle_spin(shell, 474);
  const ShellCoefficients c = coefficients_at(shell, mach);
  const double lift = c.normal - c.axial;
  const double jump =
      shell.axial_inertia * p * lift / (shell.mass * shell.diameter * 474 * c.overturning) * (15 / 474.0);
  const double found = (height[0] - height[1]) / 2 / 474;
  EXPECT_NEAR(found, jump, 0.2 * jump) << "up for a right-hand twist and wind from the right";
}

// What pushes it on its way counts as it does for the model: a blow across sends it aside, and one that turns it makes
// its nose swing.
TEST(BodyShell, PushesAreTakenOver) {
  const BodyShellDef d = shot(474, 0.3, ShellModel::six_degrees);
  Fired fired(d, 1.0 / 60), free(d, 1.0 / 60);
  for (Fired* f : {&fired, &free}) f->run(1);
  const double calm = fired.shell.yaw();
  ASSERT_TRUE(fired.world.add_impulse(fired.shell.body(), {0, 0, float(43.4545 * 10)}).ok());
  ASSERT_TRUE(fired.world.add_angular_impulse(fired.shell.body(), {0, 1.0f, 0}).ok());
  for (Fired* f : {&fired, &free}) f->run(1.5);
  EXPECT_NEAR(fired.state().center_of_mass.z - free.state().center_of_mass.z, 10 * 0.5, 0.25);
  EXPECT_GT(fired.shell.yaw(), calm + 0.003);
}

// On the ground it is a rigid body: it has touched where the model comes down, spins, bounces, and comes to rest.
TEST(BodyShell, LandsAsARigidBody) {
  BodyShellDef d = shot(337, 152 * mil, ShellModel::modified_point_mass);
  d.shape.material = {.friction = 0.6f, .restitution = 0.3f};
  d.fired_at = 0.5;
  const auto alone = fly_shell(d.shell, d.conditions, d.start, d.model, {.time = 60, .ground = 0});
  Fired fired(d, 1.0 / 120);
  fired.ground();
  fired.run(0.4);
  EXPECT_TRUE(fired.shell.waits());
  EXPECT_EQ(fired.shell.impact(), nullptr);
  while (fired.shell.impact() == nullptr && fired.world.time() < 30) fired.step();
  const ShellImpact* const impact = fired.shell.impact();
  ASSERT_NE(impact, nullptr);
  const Trajectory::Point end = alone->path.end();
  EXPECT_NEAR(impact->time - 0.5, end.time, 0.02);
  EXPECT_NEAR(impact->point.x, end.position.x, 3) << "its nose is ahead of its centre";
  EXPECT_NEAR(impact->point.z, end.position.z, 0.2);
  EXPECT_NEAR(impact->point.y, 0, 0.05);
  EXPECT_NEAR(length(impact->velocity), length(end.velocity), 0.2);
  EXPECT_NEAR(impact->spin, alone->states.back().spin, 0.5);
  EXPECT_GT(length(fired.state().angular_velocity), 300) << "it spins on";
  fired.run(impact->time + 0.3);
  EXPECT_GT(fired.state().center_of_mass.y, 0.2) << "it bounces off";
  fired.run(impact->time + 180);
  EXPECT_LT(length(fired.state().linear_velocity), 0.5);
  EXPECT_NEAR(fired.state().center_of_mass.y, 0.0775, 0.03) << "it lies on its side";
}

TEST(BodyShell, SticksWhereItLandsIfAsked) {
  BodyShellDef d = shot(337, 152 * mil, ShellModel::modified_point_mass);
  d.sticks = true;
  Fired fired(d, 1.0 / 60);
  fired.ground();
  fired.run(15);
  ASSERT_NE(fired.shell.impact(), nullptr);
  EXPECT_LT(distance(fired.state().center_of_mass, fired.shell.impact()->point), 0.6);
  EXPECT_EQ(length(fired.state().linear_velocity), 0);
}

TEST(BodyShell, SnapshotsRestoreToTheBit) {
  for (const ShellModel model : {ShellModel::modified_point_mass, ShellModel::six_degrees}) {
    BodyShellDef d = shot(337, 60 * mil, model);
    d.tip = {0, 2, 1};
    Fired fired(d, 1.0 / 60);
    fired.ground();
    fired.run(2);
    const auto bytes = fired.world.snapshot();
    const BodyShell kept = fired.shell;
    std::uint64_t hash[2];
    for (std::uint64_t& h : hash) {
      ASSERT_TRUE(fired.world.restore(bytes).ok());
      fired.shell = kept;
      fired.run(8);
      const ShellMotion& m = fired.shell.motion();
      h = core::StateHash{}.add(fired.world.state_hash()).add(m.spin).add(m.axis.z).add(m.momentum.y).digest();
      EXPECT_NE(fired.shell.impact(), nullptr) << "it lands in the part that is repeated";
    }
    EXPECT_EQ(hash[0], hash[1]);
  }
}

TEST(BodyShell, BadInputIsNamed) {
  rigid::World3 world;
  const auto message = [&](BodyShellDef d) {
    const auto made = BodyShell::make(world, d);
    return made.ok() ? std::string("none") : made.error().message;
  };
  BodyShellDef d = shot(300, 0.1, ShellModel::six_degrees);
  EXPECT_EQ(message(d), "none");
  d.start.velocity = {};
  EXPECT_NE(message(d).find("speed at the muzzle"), std::string::npos);
  d = shot(300, 0.1, ShellModel::six_degrees);
  d.fired_at = -1;
  EXPECT_NE(message(d).find("fired_at"), std::string::npos);
  d.fired_at = 0, d.spin = 1e9;
  EXPECT_NE(message(d).find("spin"), std::string::npos);
  d.spin = 0, d.shell.mass = 0;
  EXPECT_NE(message(d).find("mass"), std::string::npos);
  d.shell.mass = 1, d.shell.centre = 2, d.shell.length = 1;
  EXPECT_NE(message(d).find("centre"), std::string::npos);
  d.shell.centre = 0, d.start.position.x = std::bit_cast<double>(0x7ff8000000000000);
  EXPECT_NE(message(d), "none");
  BodyShell shell = BodyShell::make(world, shot(300, 0.1, ShellModel::six_degrees)).value();
  EXPECT_FALSE(shell.before_step(world, 0).ok());
  ASSERT_TRUE(world.destroy_body(shell.body()).ok());
  EXPECT_TRUE(shell.before_step(world, 1.0 / 60).ok()) << "a shell that is gone asks for nothing";
}

}  // namespace ballistics_body_shell_test
