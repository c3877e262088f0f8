// Chapter 3, force. Numbers: shared reference "mechanics", computed from the published equations; tolerance: last
// printed digit for closed forms, 1e-4 relative for integrated results, unless stated.
#include <gtest/gtest.h>

#include <cmath>

#include "carom/environment/environment.h"
#include "carom/environment/gravity.h"
#include "carom/forces/buoyancy.h"
#include "carom/forces/drag.h"
#include "carom/forces/fields.h"
#include "carom/forces/friction.h"
#include "carom/forces/friction_table.h"
#include "carom/forces/pressure.h"
#include "carom/forces/spring.h"
#include "carom/forces/wrench.h"
#include "carom/math/elementary.h"
#include "carom/ode/dormand_prince.h"

namespace chapter_03_test {
using namespace carom;
using math::Vec2d;
using math::Vec3d;
using ode::DormandPrince;
using ode::Motion;
using ode::Outcome;

constexpr double degree = math::pi / 180;

// 3.2: low orbit, a = 6778.137 km: T = 5553.62 s, by Kepler's law and by integrating an ellipse of that size.
TEST(Chapter03, LowOrbitPeriod) {
  const double a = 6778137.0;
  EXPECT_NEAR(2 * math::pi * std::sqrt(a * a * a / environment::earth_gm), 5553.62, 5e-3);
  const double perigee = 0.97 * a, speed = std::sqrt(environment::earth_gm * (2 / perigee - 1 / a));
  const auto orbit = [](double, const Motion<Vec3d>& y) {
    return Motion<Vec3d>{y.velocity, environment::spherical_gravity(y.position, environment::earth_gm)};
  };
  DormandPrince<Motion<Vec3d>> solver(0, {{perigee, 0, 0}, {0, speed, 0}},
                                      {.relative_tolerance = 1e-12, .absolute_tolerance = 1e-6});
  bool found = false;
  ASSERT_EQ(solver.advance_to_event(orbit, 1e5, [](double, const Motion<Vec3d>& y) { return y.position.y; }, found,
                                    {.crossing = ode::Crossing::rising}),
            Outcome::done);
  ASSERT_TRUE(found);
  EXPECT_NEAR(solver.t(), 5553.62, 5e-3);
}

// 3.2: J₂ turns the node of an orbit by −(3/2) J₂ (a/p)² n cos i (Vallado, eq. 9-37). Over ten orbits the mean of an
// integrated one agrees to the next order, J₂ itself; a sun-synchronous orbit at 800 km (i = 98.6°) turns with the
// year, .9856° a day.
TEST(Chapter03, OblateEarthTurnsOrbits) {
  const environment::ZonalGravity earth;
  const double day = 86400;
  EXPECT_NEAR(environment::nodal_regression(earth, 7178137, 0, 98.603 * degree) / degree * day, 0.9856, 1e-3);
  const double a = 7178137, i = 51.6 * degree, v = std::sqrt(earth.gm / a);
  environment::GravityField field;
  field.kind = environment::GravityField::Kind::oblate;
  field.axis = {0, 0, 1};
  const auto orbit = [&](double, const Motion<Vec3d>& y) {
    return Motion<Vec3d>{y.velocity, environment::gravity_at(field, y.position)};
  };
  DormandPrince<Motion<Vec3d>> solver(0, {{a, 0, 0}, {0, v * std::cos(i), v * std::sin(i)}},
                                      {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-4});
  // The node at each passage upward through the equator.
  double first = 0, last = 0, first_time = 0, last_time = 0;
  for (int passage = 0; passage <= 10; ++passage) {
    bool found = false;
    ASSERT_EQ(solver.advance_to_event(orbit, 1e5, [](double, const Motion<Vec3d>& y) { return y.position.z; }, found,
                                      {.crossing = ode::Crossing::rising}),
              Outcome::done);
    ASSERT_TRUE(found);
    last = std::atan2(solver.y().position.y, solver.y().position.x), last_time = solver.t();
    if (passage == 0) first = last, first_time = last_time;
  }
  EXPECT_NEAR((last - first) / (last_time - first_time) / environment::nodal_regression(earth, a, 0, i), 1, 4e-3);
  EXPECT_LT(math::distance(environment::gravity_at(field, {3e6, -4e6, 5e6}),
                           environment::zonal_gravity({3e6, -4e6, 5e6}, earth)),
            1e-12);
}

TEST(Chapter03, GravityFallsWithTheSquareOfTheDistance) {
  EXPECT_EQ(environment::gravity_at_height(0), 9.80665);
  EXPECT_NEAR(environment::gravity_at_height(6371000.0), 9.80665 / 4, 1e-15);
  EXPECT_NEAR(environment::gravitational_force(5, 7, 2), 6.674e-11 * 35 / 4, 1e-25);
}

// 3.2: a charge in a magnetic field goes round with r = mv/(qB) and never changes its speed.
TEST(Chapter03, ChargeCirclesInAMagneticField) {
  const double m = 2, q = 3, b = 0.5, v = 4;
  const auto f = [&](double, const Motion<Vec3d>& y) {
    return Motion<Vec3d>{y.velocity, forces::lorentz_force(q, {}, y.velocity, {0, 0, b}) / m};
  };
  DormandPrince<Motion<Vec3d>> solver(0, {{0, 0, 0}, {v, 0, 0}},
                                      {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11});
  ASSERT_EQ(solver.advance(f, math::pi * m / (q * b)), Outcome::done);  // half a turn: clockwise seen from B
  EXPECT_NEAR(solver.y().position.y, -2 * m * v / (q * b), 1e-8);
  EXPECT_NEAR(math::length(solver.y().velocity), v, 1e-9);
  EXPECT_NEAR(math::length(forces::coulomb_force(1e-6, 1e-6, Vec3d{0.1, 0, 0})), 0.898755, 1e-6);
}

// 3.2: in crossed fields a charge drifts at E/B, its guiding centre along E × B; the mean over whole turns is exact.
TEST(Chapter03, ChargeDriftsInCrossedFields) {
  const double m = 0.2, q = -1.5, e = 6, b = 2;
  const auto f = [&](double, const Motion<Vec3d>& y) {
    return Motion<Vec3d>{y.velocity, forces::lorentz_force(q, {0, e, 0}, y.velocity, {0, 0, b}) / m};
  };
  DormandPrince<Motion<Vec3d>> solver(0, {}, {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11});
  const double turn = 2 * math::pi * m / (std::abs(q) * b);
  ASSERT_EQ(solver.advance(f, 7 * turn), Outcome::done);
  EXPECT_NEAR(solver.y().position.x / (7 * turn), e / b, 1e-8);
  EXPECT_NEAR(solver.y().position.y, 0, 1e-7);
}

// 1.1, 3.2 (reference "ballistics and sports" 2.4): dropped from 100 m at the equator a body lands 21.95 mm to the
// east.
TEST(Chapter03, CoriolisMovesADroppedBodyEast) {
  environment::RotatingFrame frame;
  frame.rate = environment::earth_rate(0);
  const auto f = [&](double, const Motion<Vec3d>& y) {
    return Motion<Vec3d>{y.velocity,
                         Vec3d{0, -9.80665, 0} + environment::frame_acceleration(frame, y.position, y.velocity)};
  };
  Motion<Vec3d> y{{0, 100, 0}, {}};
  const double fall = std::sqrt(200 / 9.80665);
  ASSERT_EQ(ode::integrate(ode::Method::rk4, f, 0, fall, 500, y), Outcome::done);
  EXPECT_NEAR(y.position.x * 1000, 21.95, 5e-3);
  EXPECT_NEAR(y.position.x, 7.292115e-5 * 9.80665 * fall * fall * fall / 3, 1e-7);
}

TEST(Chapter03, RadialAndVortexFields) {
  const forces::Radial spring{.strength = -2, .reference = 0.5, .exponent = 1};
  EXPECT_NEAR(math::distance(forces::radial_acceleration(spring, Vec2d{3, 4}), Vec2d{-12, -16}), 0, 1e-13);
  const forces::Radial inverse{.strength = 8, .reference = 2, .exponent = -2, .range = 10};
  EXPECT_NEAR(forces::radial_acceleration(inverse, Vec3d{0, 4, 0}).y, 2, 1e-15);
  EXPECT_EQ(forces::radial_acceleration(inverse, Vec3d{0, 10.1, 0}).y, 0);
  EXPECT_EQ(forces::radial_acceleration(inverse, Vec3d{}).x, 0) << "finite at the centre";
  EXPECT_TRUE(math::is_finite(forces::radial_acceleration(inverse, Vec3d{1e-300, 0, 0})));
  // The circulation round any circle outside the core is Γ.
  const forces::Vortex vortex{.circulation = 6, .core_radius = 0.5};
  EXPECT_NEAR(2 * math::pi * 3 * math::length(forces::vortex_velocity(vortex, Vec2d{3, 0})), 6, 1e-13);
  EXPECT_GT(forces::vortex_velocity(vortex, Vec2d{3, 0}).y, 0);
  EXPECT_NEAR(math::distance(forces::vortex_velocity(vortex, Vec3d{0, 0, 1}, Vec3d{3, 0, 7}),
                             Vec3d{0, forces::vortex_speed(vortex, 3), 0}),
              0, 1e-14);
}

// 3.3: 30° incline, μ = .2, g = 9.80665: a = 3.2048; stays iff tan θ ≤ μ_s; rolling sphere 5/7 g sin θ = 3.5024.
TEST(Chapter03, InclineSlipsAndRolls) {
  const double g = environment::standard_gravity;
  EXPECT_NEAR(forces::incline_acceleration(30 * degree, 0.2, g), 3.2048, 5e-5);
  EXPECT_NEAR(forces::rolling_acceleration(30 * degree, 2.0 / 5, g), 3.5024, 5e-5);
  EXPECT_NEAR(forces::rolling_acceleration(30 * degree, 1.0 / 2, g), 2.0 / 3 * g * 0.5, 1e-12);
  EXPECT_TRUE(forces::stays_on_incline(std::atan(0.5) - 1e-9, 0.5));
  EXPECT_FALSE(forces::stays_on_incline(std::atan(0.5) + 1e-9, 0.5));
  EXPECT_NEAR(forces::rolling_friction_needed(30 * degree, 2.0 / 5), 2.0 / 7 * std::tan(30 * degree), 1e-14);
  // The force holds up to μ_s N and drags with μ_k N afterwards.
  EXPECT_EQ(forces::friction_force(0.5, 0.4, 10, Vec2d{4.9, 0}, Vec2d{}).x, -4.9);
  EXPECT_NEAR(forces::friction_force(0.5, 0.4, 10, Vec2d{5.1, 0}, Vec2d{}).x, -4, 1e-14);
  EXPECT_NEAR(forces::friction_force(0.5, 0.4, 10, Vec2d{5.1, 0}, Vec2d{0, -3}).y, 4, 1e-14);
}

// 3.3: the designer's pairs of the reference.
TEST(Chapter03, PairsOfSurfaces) {
  const struct {
    const char *first, *second;
    double at_rest, sliding;
  } pairs[] = {{"steel", "steel", 0.78, 0.42},
               {"rubber", "asphalt", 0.9, 0.7},
               {"PTFE", "steel", 0.04, 0.04},
               {"steel", "ice", 0.1, 0.03}};
  for (const auto& pair : pairs) {
    const auto found = forces::find_friction(pair.first, pair.second);
    ASSERT_TRUE(found) << pair.first;
    EXPECT_EQ(found->static_coefficient, pair.at_rest) << pair.first;
    EXPECT_EQ(found->kinetic_coefficient, pair.sliding) << pair.first;
  }
}

// 3.4, 6.2: v_t = 42, g = 9.81, t = 5: v = 34.5905 m/s; terminal speeds of the reference.
TEST(Chapter03, FallWithQuadraticDrag) {
  EXPECT_NEAR(forces::quadratic_fall(42, 9.81, 5).speed, 34.5905, 5e-5);
  const auto f = [](double, const Motion<double>& y) {
    return Motion<double>{y.velocity, 9.81 - 9.81 / (42 * 42.0) * y.velocity * y.velocity};
  };
  Motion<double> y{0, 0};
  ASSERT_EQ(ode::integrate(ode::Method::rk4, f, 0, 5, 500, y), Outcome::done);
  EXPECT_NEAR(y.velocity, forces::quadratic_fall(42, 9.81, 5).speed, 1e-9);
  EXPECT_NEAR(y.position, forces::quadratic_fall(42, 9.81, 5).distance, 1e-8);
  const auto disc = [](double diameter) { return math::pi / 4 * diameter * diameter; };
  const double g = environment::standard_gravity;
  EXPECT_NEAR(forces::terminal_speed(0.145, g, 1.225, 0.35, disc(0.0732)), 39.70, 0.011);
  EXPECT_NEAR(forces::terminal_speed(0.04593, g, 1.225, 0.25, disc(0.04267)), 45.35, 0.011);
  EXPECT_NEAR(forces::terminal_speed(80, g, 1.225, 1, 0.7), 42.78, 0.011);
}

// 6.2: Schiller–Naumann C_d(100) = 1.092; Morrison .484 at 1e3, .173 at 3e5.
TEST(Chapter03, SphereDragCoefficient) {
  EXPECT_NEAR(forces::sphere_drag_schiller_naumann(100), 1.092, 5e-4);
  EXPECT_NEAR(forces::sphere_drag_morrison(1e3), 0.484, 5e-4);
  EXPECT_NEAR(forces::sphere_drag_morrison(3e5), 0.173, 5e-4);
  for (double re = 1e-4; re < 0.05; re *= 3)
    EXPECT_NEAR(forces::sphere_drag_morrison(re) / forces::sphere_drag_stokes(re), 1, 0.03) << re;
  EXPECT_NEAR(forces::sphere_drag_morrison(262.9), forces::sphere_drag_morrison(263.1), 1e-3) << "joined smoothly";
}

// 3.5: ∮ p n dA = 0 on a closed mesh at constant p; at p = −ρ g y it is Archimedes' force at the centroid.
TEST(Chapter03, PressureOnAClosedMesh) {
  const Vec3d v[5] = {{0, 0, 0}, {2, 0.1, 0}, {0.3, 1.7, 0.2}, {0.4, 0.5, 1.9}, {1.5, 1.2, 1.4}};
  const std::uint32_t t[18] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 4, 1, 4, 3, 2, 3, 4};  // two tetrahedra joined
  const forces::Wrench3 constant = forces::pressure_on_mesh(v, t, [](Vec3d) { return 101325.0; }, {5, -3, 2});
  EXPECT_LT(math::length(constant.force), 1e-9);
  EXPECT_LT(math::length(constant.moment), 1e-9);
  const Vec3d about{0.2, 0.3, -0.1};
  const forces::Wrench3 water = forces::pressure_on_mesh(v, t, [](Vec3d p) { return 1025 * 9.81 * (10 - p.y); }, about);
  const forces::Submerged3 whole = forces::submerged_mesh(v, t, {{0, 1, 0}, 10});
  EXPECT_LT(math::distance(water.force, Vec3d{0, forces::buoyant_force(1025, 9.81, whole.volume), 0}), 1e-8);
  EXPECT_LT(math::distance(water.moment, math::cross(whole.centroid - about, water.force)), 1e-8);
}

// 3.6: an upright prism of relative density .6 floats at 60 % draft; cap R = .5, h = .3: ∇ = .113097 m³.
TEST(Chapter03, PrismFloatsAtSixtyPercent) {
  const double height = 2, mass = 0.6 * 1000 * height * 0.7 * 0.9;
  double low = -1, high = 1;  // level of the water in the frame of the box
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const double lift = 1000 * forces::submerged_box({0.35, 1, 0.45}, {{0, 1, 0}, middle}).volume;
    (lift < mass ? low : high) = middle;
  }
  EXPECT_NEAR((low + 1) / height, 0.6, 1e-12);
  EXPECT_NEAR(forces::spherical_cap_volume(0.5, 0.3), 0.113097, 5e-7);
  EXPECT_NEAR(forces::submerged_sphere({0, 0, 0}, 0.5, {{0, 1, 0}, -0.2}).volume, 0.113097, 5e-7);
}

// 3.7: k = 100 N/m, m = 1 and 3 kg: ω = √(k/μ) = 11.547 rad/s; ζ = c/(2√(kμ)).
TEST(Chapter03, TwoMassesOnASpring) {
  const double mu = forces::reduced_mass(1, 3);
  EXPECT_NEAR(forces::spring_frequency(100, mu), 11.547, 5e-4);
  EXPECT_NEAR(forces::damping_ratio(forces::damping_for_ratio(0.3, 100, mu), 100, mu), 0.3, 1e-15);
  // Integrated with the force function: the period of the length between two free masses, momentum kept.
  const forces::Spring spring{.rest_length = 1, .stiffness = 100};
  using State = Motion<math::Vec4d>;  // two masses on a line: positions (a, b)
  const auto f = [&](double, const State& y) {
    const Vec2d force = forces::spring_damper_force(spring, Vec2d{y.position.x, 0}, Vec2d{y.position.y, 0},
                                                    Vec2d{y.velocity.x, 0}, Vec2d{y.velocity.y, 0});
    return State{y.velocity, {force.x / 1, -force.x / 3, 0, 0}};
  };
  DormandPrince<State> solver(0, {{-0.6, 0.6, 0, 0}, {0, 0, 0, 0}},
                              {.relative_tolerance = 1e-11, .absolute_tolerance = 1e-11});
  double crossing[2];
  for (double& t : crossing) {
    bool found = false;
    ASSERT_EQ(solver.advance_to_event(f, 10, [](double, const State& y) { return y.position.y - y.position.x - 1; },
                                      found, {.crossing = ode::Crossing::falling}),
              Outcome::done);
    ASSERT_TRUE(found);
    t = solver.t();
  }
  EXPECT_NEAR(2 * math::pi / (crossing[1] - crossing[0]), 11.547, 5e-4);
  EXPECT_NEAR(solver.y().velocity.x + 3 * solver.y().velocity.y, 0, 1e-9);
  EXPECT_EQ(forces::spring_damper_force(spring, Vec3d{1, 1, 1}, Vec3d{1, 1, 1}, Vec3d{}, Vec3d{}), Vec3d{})
      << "ends that coincide";
}

// 3.7: a damped oscillator loses e^{−2πζ/√(1−ζ²)} of its amplitude in a period.
TEST(Chapter03, DampedSpringDecaysByItsRatio) {
  const double k = 100, m = 2, zeta = 0.1, c = forces::damping_for_ratio(zeta, k, m);
  const double omega = forces::spring_frequency(k, m) * std::sqrt(1 - zeta * zeta);
  const forces::Spring spring{.rest_length = 3, .stiffness = k, .damping = c};
  const auto f = [&](double, const Motion<Vec2d>& y) {
    return Motion<Vec2d>{y.velocity, forces::spring_damper_force(spring, y.position, Vec2d{}, y.velocity, Vec2d{}) / m};
  };
  Motion<Vec2d> y{{3.2, 0}, {0, 0}};
  ASSERT_EQ(ode::integrate(ode::Method::rk4, f, 0, 2 * math::pi / omega, 2000, y), Outcome::done);
  EXPECT_NEAR((y.position.x - 3) / 0.2, std::exp(-2 * math::pi * zeta / std::sqrt(1 - zeta * zeta)), 1e-8);
}

// 3.8: M_Q = M_P + (P − Q) × F; couples are position-free.
TEST(Chapter03, WrenchTransport) {
  const Vec3d p{1, 2, 3}, q{-2, 0.5, 4}, at{0.3, -1, 2}, f{10, -4, 7};
  const forces::Wrench3 about_p = forces::force_at(f, at, p), about_q = forces::force_at(f, at, q);
  EXPECT_LT(math::distance(forces::transport(about_p, p, q).moment, about_q.moment), 1e-13);
  const forces::Wrench3 couple = forces::force_at(f, at, p) + forces::force_at(-f, {4, 4, 4}, p);
  EXPECT_LT(math::distance(forces::transport(couple, p, q).moment, couple.moment), 1e-13);
  const forces::Wrench2 flat = forces::force_at(Vec2d{10, -4}, Vec2d{0.3, -1}, Vec2d{1, 2});
  EXPECT_NEAR(forces::transport(flat, Vec2d{1, 2}, Vec2d{-2, 0.5}).moment,
              forces::force_at(Vec2d{10, -4}, Vec2d{0.3, -1}, Vec2d{-2, 0.5}).moment, 1e-13);
}

}  // namespace chapter_03_test
