// Wind as a field of place and time in flights, shells, rockets and bodies of a world.
#include <gtest/gtest.h>

#include "carom/ballistics/body_flight.h"
#include "carom/ballistics/body_rocket.h"
#include "carom/ballistics/shell.h"
#include "carom/environment/environment.h"
#include "tests/ballistics/pieces.h"

namespace ballistics_field_test {
using namespace carom;
using namespace carom::ballistics;
using math::Vec3d;
using math::Vec3f;

/// The same air as a column, told as a field.
Conditions as_field(const Conditions& column) {
  Conditions out = column;
  out.wind = environment::WindColumn(Vec3d{500, 0, 0});  // nobody asks it
  out.field = [wind = column.wind](Vec3d point, double) { return wind.at(point.y); };
  return out;
}
const Conditions layered{.wind = environment::WindColumn(environment::Wind{
                             .velocity = {3, 0, 7}, .profile = environment::WindProfile::logarithmic}),
                         .rotation = earth_rotation_rate(.8, .3)};

Rocket small_rocket() {
  return {
      .stages = {{.motor = test::ideal_motor(60, 1.5, .06, .1), .dry_mass = .6, .dry_centre = .5, .motor_centre = .9}},
      .nose_length = .2,
      .fins = {.count = 3, .position = .88}};
}

TEST(WindField, AColumnToldAsAFieldIsTheSameAir) {
  const FlightPoint start{{0, 1, 0}, 500.0 * direction(.2)};
  const Projectile shot = projectile_from_size(DragCurve(DragFunction::gs), 1, .05);
  const auto a = fly(shot, layered, start, {.time = 8}), b = fly(shot, as_field(layered), start, {.time = 8});
  EXPECT_LT(math::length(a->end().position - b->end().position), 1e-4) << "it bends between nodes";
  for (const ShellModel model : {ShellModel::modified_point_mass, ShellModel::six_degrees}) {
    const auto one = fly_shell(m107(), layered, start, model, {.time = 3, .tolerance = 1e-8}),
               other = fly_shell(m107(), as_field(layered), start, model, {.time = 3, .tolerance = 1e-8});
    EXPECT_LT(math::length(one->path.end().position - other->path.end().position), 1e-3);
  }
  for (const RocketModel model : {RocketModel::point_mass, RocketModel::six_degrees}) {
    const Launch launch{.direction = {.1, 1, 0}};
    const auto one = fly_rocket(small_rocket(), layered, launch, model, {.time = 6}),
               other = fly_rocket(small_rocket(), as_field(layered), launch, model, {.time = 6});
    ASSERT_TRUE(one.ok() && other.ok());
    EXPECT_LT(math::length(one->path.end().position - other->path.end().position), 1e-3);
  }
}

// Drag that is nearly linear (C_D ~ 1/v by a table) would have a closed form; here the exact equations are integrated
// with tiny steps of the middle.
TEST(WindField, AGustCrossesTheWay) {
  const environment::Gust gust{.velocity = {0, 0, 20}, .front = -200, .gradient_distance = 30, .speed = 15};
  Conditions air{.air = environment::AirColumn::uniform(1.2)};
  air.field = [gust](Vec3d p, double t) { return environment::gust_at(gust, p, t); };
  air.field_time = 1;
  const Projectile shot = projectile_from_size(DragCurve(.4), .05, .04);
  const auto path = fly(shot, air, {{-260, 40, 0}, {120, 20, 0}}, {.time = 3});
  ASSERT_TRUE(path.ok());
  State s{{-260, 40, 0}, {120, 20, 0}};
  const double h = 1e-4;
  const auto pull = [&](const State& at, double t) {
    const Vec3d w = at.velocity - environment::gust_at(gust, at.position, 1 + t);
    return Vec3d{0, -9.80665, 0} - (.5 * 1.2 * .4 * math::pi / 4 * .04 * .04 / .05 * math::length(w)) * w;
  };
  for (int i = 0; i < 30000; ++i) {
    const double t = h * i;
    const State middle{s.position + (.5 * h) * s.velocity, s.velocity + (.5 * h) * pull(s, t)};
    s = {s.position + h * middle.velocity, s.velocity + h * pull(middle, t + .5 * h)};
  }
  EXPECT_GT(path->end().position.z, .5) << "it blows aside";
  EXPECT_LT(math::length(path->end().position - s.position), 1e-5);
}

/// A world with Surroundings, a ball of 10 cm and the effector on it.
struct Flown {
  rigid::World3 world;
  rigid::BodyId body;
  Flown(const environment::Environment& around, const BodyFlight& flight, Vec3d velocity) {
    rigid::BodyDef<rigid::Dim3> definition;
    definition.position = {0, 100, 0};
    definition.linear_velocity = Vec3f(velocity);
    body = *world.create_body(definition);
    (void)*world.add_shape(body, geometry::Sphere{.05f});
    (void)*world.add_effector(rigid::Surroundings<rigid::Dim3>{std::make_shared<environment::Environment>(around)});
    (void)*world.add_effector(*flight_effector<rigid::Dim3>(body, flight));
  }
  Vec3d after(int steps) {
    for (int i = 0; i < steps; ++i) EXPECT_TRUE(world.step(1.0f / 240).ok());
    return world.state(body)->center_of_mass;
  }
};

// A body asks what is around it as the model does when it is told the same, air of altitude and gusts too.
TEST(WindField, BodiesFeelTheSurroundings) {
  environment::Environment::Definition d;
  d.altitude = 2000;
  d.ground = 60;
  d.wind.layers = {{0, {2, 0, 4}}, {30, {-3, 0, 9}}, {80, {0, 0, -6}}};
  d.wind.gusts = {{.velocity = {0, 12, 5}, .front = 60, .gradient_distance = 80, .speed = 20}};
  const environment::Environment around = *environment::Environment::make(d);
  Conditions air{.air = environment::AirColumn({}, 2000)};
  air.field = [&](Vec3d p, double t) { return around.wind(p, t); };
  const Projectile shot = projectile_from_size(DragCurve(DragFunction::gs), .5, .1);
  const Vec3d v{150, 30, 0};
  const auto path = fly(shot, air, {{0, 100, 0}, v}, {.time = 3});
  const auto off = [&](const BodyFlight& flight) {
    return math::length(Flown(around, flight, v).after(720) - path->end().position);
  };
  EXPECT_LT(off({.projectile = shot, .dt = 1.0 / 240}), .02);
  EXPECT_LT(off({.projectile = shot, .conditions = air, .dt = 1.0 / 240, .own_air = true, .own_wind = true}), .02);
  EXPECT_GT(off({.projectile = shot, .dt = 1.0 / 240, .own_air = true}), 1);
  EXPECT_GT(off({.projectile = shot, .dt = 1.0 / 240, .own_wind = true}), 1);
}

// A rocket's body in a field drifts as the model alone does.
TEST(WindField, RocketsFeelGustsAsBodiesToo) {
  Conditions air;
  air.field = [](Vec3d p, double t) { return Vec3d{6 * math::sin(2 * t), 0, 4 + .05 * p.y}; };
  Conditions later = air;
  later.field_time = .5;
  const Launch launch{.rail_length = 1.5};
  const auto path = fly_rocket(small_rocket(), later, launch, RocketModel::six_degrees, {.time = 4});
  ASSERT_TRUE(path.ok());
  rigid::World3 world;
  auto rocket = BodyRocket::make(world, {.rocket = small_rocket(), .conditions = air, .launch = launch, .start = .5});
  ASSERT_TRUE(rocket.ok());
  for (int i = 0; i < 270; ++i) {
    ASSERT_TRUE(rocket->before_step(world, 1.0 / 60).ok());
    ASSERT_TRUE(world.step(1.0f / 60).ok());
  }
  const Vec3d off = Vec3d(world.state(rocket->body())->pose.position) - path->path.end().position;
  EXPECT_GT(math::length(Vec3d{path->path.end().position.x, 0, path->path.end().position.z}), 5);
  EXPECT_LT(math::length(Vec3d{off.x, 0, off.z}), 1.5) << off.x << ' ' << off.z;
}

// The centre of mass of a body's rocket goes forward as its motor burns: Σ m x / Σ m of what is left.
TEST(BodyRocket, CentreOfMassMovesAsItBurns) {
  rigid::World3 world;
  const double dt = 1.0 / 240;
  const Rocket rocket = small_rocket();
  auto flown = BodyRocket::make(world, {.rocket = rocket}).value();
  const Stage& stage = rocket.stages[0];
  for (int i = 0; i < 480; ++i) {
    flown.before_step(world, dt).value();
    const auto now = world.mass_properties3(flown.body()).value();
    const double motor = flown.mass() - stage.dry_mass;
    const double centre = (stage.dry_mass * stage.dry_centre + motor * stage.motor_centre) / flown.mass();
    EXPECT_NEAR(now.mass, flown.mass(), 1e-7);
    EXPECT_NEAR(now.center.x, rocket.length - centre, 1e-7);
    if (i == 0) EXPECT_NEAR(flown.mass(), .76, 2e-4);
    if (i == 479) EXPECT_NEAR(centre, (.6 * .5 + .1 * .9) / .7, 1e-9) << "burnt out: only the casing is left";
    world.step(float(dt)).value();
  }
}

}  // namespace ballistics_field_test
