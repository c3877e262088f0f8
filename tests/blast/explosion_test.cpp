// Charges in worlds (shared reference "ballistics", 1c, 2.9, 6).
#include "carom/blast/explosion.h"

#include <gtest/gtest.h>

#include "carom/geometry/hull.h"
#include "carom/math/elementary.h"

namespace blast_test {
using namespace carom;
using namespace carom::blast;
using math::Vec2d;
using math::Vec3d;
using rigid::Dim2;
using rigid::Dim3;

TEST(SurfaceLoad, ImpulseIsTheIntegralOfPressure) {
  for (const double z : {0.5, 1.0, 3.0, 12.0, 35.0})
    for (const double cosine : {1.0, 0.4, 0.0, -0.7})
      for (const double clearing : {0.0, 0.3, 5.0}) {
        const Wave w = blast_wave(8, 2 * z).value();
        const SurfaceLoad load(w, cosine, clearing);
        const int n = 40000;
        double sum = 0, half = 0;
        const double length = load.end() - load.arrival();
        for (int i = 0; i < n; ++i) {
          sum += load.pressure(load.arrival() + length * (i + 0.5) / n) * length / n;
          if (i + 1 == n / 4) half = sum;
        }
        EXPECT_NEAR(load.impulse(), sum, 2e-4 * math::abs(sum) + 1e-3) << z << " " << cosine << " " << clearing;
        EXPECT_NEAR(load.impulse(load.arrival() + length / 4), half, 2e-4 * math::abs(half) + 1e-3);
      }
  // A wall square to the wave gets the published reflected impulse, a face along it the side-on one.
  for (const double z : {1.0, 2.0, 5.0, 20.0}) {
    const Wave w = blast_wave(1, z).value();
    EXPECT_NEAR(SurfaceLoad(w, 1).impulse(), w.reflected_impulse, 1e-8 * w.reflected_impulse);
    EXPECT_NEAR(SurfaceLoad(w, 1).peak(), w.reflected_pressure, 1e-9 * w.reflected_pressure);
    EXPECT_NEAR(SurfaceLoad(w, 0).impulse(), w.impulse, 1e-8 * w.impulse);
    EXPECT_LT(SurfaceLoad(w, 1, 0.05).impulse(), w.reflected_impulse) << "edges relieve";
    EXPECT_GT(SurfaceLoad(w, 1, 0.05).impulse(), w.impulse);
  }
}

template <class D>
rigid::BodyId box_at(rigid::World<D>& world, typename D::Position place, float half, float density = 1000,
                     rigid::BodyType type = rigid::BodyType::dynamic) {
  rigid::BodyDef<D> body;
  body.type = type;
  body.position = place;
  const auto id = world.create_body(body).value();
  if constexpr (D::dimension == 3)
    EXPECT_TRUE(world.add_shape(id, geometry::Box{{half, half, half}}, {.density = density}));
  else
    EXPECT_TRUE(world.add_shape(id, geometry::make_box2({half, half}), {.density = density}));
  return id;
}

template <class D>
void run(rigid::World<D>& world, Explosion<D>& explosion, double dt, double until) {
  while (world.time() < until) {
    ASSERT_TRUE(explosion.apply(world, dt));
    ASSERT_TRUE(world.step(float(dt)));
  }
}

TEST(Explosion, ImpulseOnABoxIsThatOfItsFaces) {
  for (const double dt : {1.0 / 60, 1.0 / 2000}) {
    rigid::World3 world({.gravity = {0, 0, 0}});
    const auto id = box_at<Dim3>(world, {20, 0, 0}, 0.1f, 1e6);
    auto explosion = Explosion3::make({.mass = 10, .burst = Burst::free_air, .clearing = false}).value();
    run(world, explosion, dt, 0.15);
    const double area = 0.04;
    const double front = SurfaceLoad(explosion.wave_at(19.9), 1).impulse() * area,
                 rear = SurfaceLoad(explosion.wave_at(20.1), -1).impulse() * area;
    EXPECT_NEAR(explosion.impulse_given().x, front - rear, 2e-3 * front) << dt;
    EXPECT_NEAR(explosion.impulse_given().y, 0, 1e-3 * front);
    const auto s = world.state(id).value();
    EXPECT_NEAR(double(s.linear_velocity.x) * double(s.mass), explosion.impulse_given().x, 1e-5 * front) << "budget";
  }
}

TEST(Explosion, KnowsItsWaveByATable) {
  for (const Burst burst : {Burst::ground, Burst::free_air})
    for (const double mass : {1e-3, 5.0, 4e4}) {
      const auto explosion = Explosion3::make({.mass = mass, .burst = burst}).value();
      const double scale = math::cbrt(burst == Burst::ground ? mass : mass / 1.8);
      for (double z = 0.2001; z < 39.99; z *= 1.0007) {
        const Wave a = explosion.wave_at(z * scale), b = blast_wave(mass, z * scale, burst).value();
        for (double Wave::* value :
             {&Wave::arrival, &Wave::pressure, &Wave::reflected_pressure, &Wave::duration, &Wave::impulse,
              &Wave::reflected_impulse, &Wave::front_speed, &Wave::decay, &Wave::reflected_decay})
          ASSERT_NEAR(a.*value, b.*value, 1e-7 * math::abs(b.*value) + 1e-9) << mass << " " << z;
      }
    }
}

// What is struck beside its centre of mass turns: Δω = r × J / I. The charge faces the middle of the plate.
TEST(Explosion, TurnsWhatItStrikesBesideItsCentre) {
  rigid::World3 world({.gravity = {0, 0, 0}});
  rigid::BodyDef<Dim3> body;
  body.position = {20, 0, 0};
  const auto id = world.create_body(body).value();
  rigid::ShapeDef<Dim3> shape;
  shape.local.p = {0, 0.4f, 0};
  world.add_shape(id, geometry::Box{{0.05f, 0.3f, 0.3f}}, shape).value();
  const double mass = 5000, inertia = 800;
  world.set_mass_properties(id, {mass, {}, math::Mat3d::diagonal({inertia, inertia, inertia})}).value();
  auto explosion = Explosion3::make({.position = {0, 0.4, 0}, .mass = 10, .burst = Burst::free_air}).value();
  run(world, explosion, 1.0 / 240, 0.15);
  const double given = explosion.impulse_given().x, spin = -0.4 * given / inertia;
  const auto s = world.state(id).value();
  EXPECT_GT(given, 1);
  EXPECT_NEAR(double(s.linear_velocity.x) * mass, given, 1e-4 * given);
  EXPECT_NEAR(double(s.angular_velocity.z), spin, 2e-3 * math::abs(spin));
  EXPECT_NEAR(double(s.angular_velocity.x), 0, 1e-3 * math::abs(spin));
  EXPECT_NEAR(double(s.angular_velocity.y), 0, 1e-3 * math::abs(spin));
}

TEST(Explosion, StepsOfAnyLengthGiveTheSame) {
  double given[3];
  int i = 0;
  for (const double dt : {1.0 / 30, 1.0 / 240, 1.0 / 5000}) {
    rigid::World3 world({.gravity = {0, 0, 0}});
    box_at<Dim3>(world, {3, 1, 0}, 0.5f, 1e6);
    auto explosion = Explosion3::make({.mass = 1}).value();
    run(world, explosion, dt, 0.1);
    given[i++] = explosion.impulse_given().x;
  }
  EXPECT_NEAR(given[0], given[2], 1e-5 * given[2]);
  EXPECT_NEAR(given[1], given[2], 1e-5 * given[2]);
}

// Hopkinson and Cranz: lengths and times by k, masses by k³, and impulses follow by k³.
TEST(Explosion, CubeRootScaling) {
  double given[2];
  for (int i = 0; i < 2; ++i) {
    const float k = i == 0 ? 1 : 2;
    rigid::World3 world({.gravity = {0, 0, 0}});
    box_at<Dim3>(world, {4.0 * double(k), 0, 1.0 * double(k)}, 0.5f * k, 1e6);
    auto explosion = Explosion3::make({.mass = double(k * k * k), .burst = Burst::free_air}).value();
    run(world, explosion, 1.0 / 60, 0.2);
    given[i] = explosion.impulse_given().x;
  }
  EXPECT_NEAR(given[1] / given[0], 8, 1e-4);
}

TEST(Explosion, ArrivesWhenTheFrontDoes) {
  rigid::World3 world({.gravity = {0, 0, 0}});
  const auto id = box_at<Dim3>(world, {15, 0, 0}, 0.25f);
  auto explosion = Explosion3::make({.mass = 100, .time = 0.01}).value();
  const double arrival = explosion.wave_at(14.75).arrival + 0.01;  // 18.3 ms + 10 ms
  EXPECT_NEAR(explosion.wave_at(15).arrival, 18.7428e-3, 1e-6);
  bool told = false;
  while (world.time() < 0.1) {
    const double before = world.time();
    ASSERT_TRUE(explosion.apply(world, 1e-3));
    ASSERT_TRUE(world.step(1e-3f));
    const float speed = world.state(id)->linear_velocity.x;
    if (world.time() < arrival)
      EXPECT_EQ(speed, 0);
    else if (before > arrival + 1e-3)
      EXPECT_GT(speed, 0);
    for (const auto& event : explosion.events()) {
      EXPECT_FALSE(told);
      told = true;
      EXPECT_NEAR(event.pressure, 100e3, 5e3);
      EXPECT_EQ(event.damage, Damage::walls_collapse);
    }
    EXPECT_NEAR(explosion.front_radius(arrival), 14.75, 1e-3);
  }
  EXPECT_TRUE(told);
  EXPECT_TRUE(explosion.finished(1000));
}

TEST(Explosion, WallsShelterAndMirrorsMirror) {
  rigid::World3 world({.gravity = {0, 0, 0}});
  const auto open = box_at<Dim3>(world, {-6, 0.5, 0}, 0.25f), behind = box_at<Dim3>(world, {6, 0.5, 0}, 0.25f),
             left = box_at<Dim3>(world, {0, 0.5, -6}, 0.25f), right = box_at<Dim3>(world, {0, 0.5, 6}, 0.25f);
  rigid::BodyDef<Dim3> wall;
  wall.type = rigid::BodyType::fixed;
  wall.position = {4, 1, 0};
  const auto id = world.create_body(wall).value();
  ASSERT_TRUE(world.add_shape(id, geometry::Box{{0.1f, 2, 2}}));
  auto explosion = Explosion3::make({.position = {0, 0.5, 0}, .mass = 2}).value();
  run(world, explosion, 1.0 / 240, 0.06);
  const float free = -world.state(open)->linear_velocity.x, sheltered = world.state(behind)->linear_velocity.x;
  EXPECT_GT(free, 0.05f);
  EXPECT_LT(math::abs(sheltered), 0.25f * free);
  EXPECT_NEAR(world.state(left)->linear_velocity.z, -world.state(right)->linear_velocity.z, 1e-4f * free);
  EXPECT_NEAR(explosion.pressure_at({-6, 0.5, 0}, explosion.wave_at(6).arrival + 1e-4) * 0.4,
              explosion.pressure_at({6, 0.5, 0}, explosion.wave_at(6).arrival + 1e-4, &world), 1e-6);
}

TEST(Explosion, PartsOfOneBodyCoverEachOther) {
  double given[2];
  for (int i = 0; i < 2; ++i) {
    rigid::World3 world({.gravity = {0, 0, 0}});
    rigid::BodyDef<Dim3> body;
    body.position = {5, 0, 0};
    const auto id = world.create_body(body).value();
    if (i == 0) {
      ASSERT_TRUE(world.add_shape(id, geometry::Box{{0.4f, 0.4f, 0.4f}}, {.density = 1e6}));
    } else {
      for (int k = 0; k < 8; ++k) {
        rigid::ShapeDef<Dim3> shape{.density = 1e6};
        shape.local.p = {k & 1 ? 0.2f : -0.2f, k & 2 ? 0.2f : -0.2f, k & 4 ? 0.2f : -0.2f};
        ASSERT_TRUE(world.add_shape(id, geometry::Box{{0.199f, 0.199f, 0.199f}}, shape));
      }
    }
    auto explosion = Explosion3::make({.mass = 1, .burst = Burst::free_air, .clearing = false}).value();
    run(world, explosion, 1.0 / 60, 0.1);
    given[i] = explosion.impulse_given().x;
  }
  EXPECT_NEAR(given[1], given[0], 0.02 * given[0]);
}

TEST(Explosion, InThePlaneAndOnAnyNumberOfThreads) {
  std::uint64_t hash[2];
  for (int threads = 1; threads <= 2; ++threads) {
    rigid::World2 world({.threads = threads});
    box_at<Dim2>(world, {0, -1}, 1, 1000, rigid::BodyType::fixed);
    const auto id = box_at<Dim2>(world, {3, 0.5}, 0.5f);
    for (int i = 0; i < 5; ++i) box_at<Dim2>(world, {-4.0 - 1.5 * i, 0.5}, 0.4f);
    auto explosion = Explosion2::make({.position = {0, 0.2}, .mass = 1}).value();
    run(world, explosion, 1.0 / 120, 0.2);
    EXPECT_GT(world.state(id)->linear_velocity.x, 0.1f);
    hash[threads - 1] = world.state_hash();
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(Explosion, FacesWithEqualSidesAreSplitToo) {
  // A corner of a cube cut off: its slanted face has three sides of √2, equal to the bit.
  const math::Vec3f corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  rigid::World3 world({.gravity = {0, 0, 0}});
  const auto body = world.create_body({.position = {3, 1, 0}}).value();
  ASSERT_TRUE(world.add_shape(body, geometry::Shape3(geometry::make_hull(corners).value())));
  auto explosion = Explosion3::make({.mass = 1}).value();
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(explosion.apply(world, 1e-3));
    ASSERT_TRUE(world.step(1e-3f));
  }
  EXPECT_GT(length(explosion.impulse_given()), 10);
}

TEST(Explosion, ParticlesRideTheWindAndNoFaster) {
  auto explosion = Explosion3::make({.mass = 1}).value();
  const std::vector<math::Vec3f> places{{3, 0, 0}, {0, 3, 0}, {50, 0, 0}};
  for (const double light : {1e-3, 1e3}) {
    std::vector<math::Vec3f> velocities(3);
    for (int i = 0; i < 100; ++i) explosion.push_particles(places, velocities, {}, light, 1e-3 * i, 1e-3);
    const double wind = wind_speed(explosion.wave_at(3).pressure);
    EXPECT_GT(velocities[0].x, 0);
    EXPECT_LE(double(velocities[0].x), wind * 1.0001);
    EXPECT_EQ(velocities[0].x, velocities[1].y);
    if (light > 1) EXPECT_NEAR(double(velocities[0].x), wind, 1e-3 * wind);
  }
}

TEST(Explosion, BadInputIsNamed) {
  EXPECT_EQ(Explosion3::make({.mass = -1}).error().message, "Charge: mass is -1, expected more than 0, up to 1e9 kg");
  EXPECT_FALSE(Explosion3::make({.position = {math::sqrt(-1.0), 0, 0}}));
  EXPECT_FALSE(Explosion3::make({.shelter = 2}));
  rigid::World3 world;
  auto explosion = Explosion3::make({}).value();
  EXPECT_FALSE(explosion.apply(world, 0));
}

}  // namespace blast_test
