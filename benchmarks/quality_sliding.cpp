// Coulomb's law, and what lies flush: slopes, stops, a skid, a spinning disc, tiles.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "benchmarks/quality.h"

namespace carom::bench {
namespace {

using std::numbers::pi;

/// Gravity on a slope of `a` rad that falls in the compass direction `heading`.
Vec3d slope(double a, double heading) {
  return standard_g * Vec3d{std::sin(a) * std::cos(heading), -std::cos(a), std::sin(a) * std::sin(heading)};
}
int headings(const Measurement& m) { return m.plane() ? 2 : 16; }
double heading(const Measurement& m, int k) { return m.plane() ? k * pi : k * pi / 8; }

void critical_slope(Measurement& m) {
  const double steep = std::atan(0.98 * 0.5);
  double creep = 0;
  for (int k = 0; k < headings(m); ++k) {
    Stage stage = m.stage(slope(steep, heading(m, k)), false);
    stage.add(ground(0.5));
    const int cube = stage.add(cube_at({0, 0.5, 0}, 0.5, 1, 0.5));
    stage.run(60);
    const Vec3d begin = stage.motion(cube).position;
    stage.run(3600);
    creep = std::fmax(creep, math::length(stage.motion(cube).position - begin));
  }
  m.tell("4", "slope at .98 of critical, 60 s, sleep off: creep", "m", 0, 1e-4, creep);
  Stage stage = m.stage(slope(steep, 0));
  stage.add(ground(0.5));
  const int cube = stage.add(cube_at({0, 0.5, 0}, 0.5, 1, 0.5));
  stage.run(300);
  m.tell("d", "slope at .98 of critical, first 5 s: moved", "m", 0, 1e-4, std::abs(stage.motion(cube).position.x));
}

void stop_distance(Measurement& m) {
  const double truth = 25 / (2 * 0.5 * standard_g);
  double least = 1e9, most = -1e9, worst = truth;
  for (int k = 0; k < headings(m); ++k) {
    const Vec3d way{std::cos(heading(m, k)), 0, std::sin(heading(m, k))};
    Stage stage = m.stage();
    stage.add(ground(0.5));
    const int cube = stage.add(cube_at({0, 0.5, 0}, 0.5, 1, 0.5));
    stage.run(30);
    const Vec3d begin = stage.motion(cube).position;
    stage.engine().set_velocity(cube, 5.0 * way, {});
    stage.run(180);
    const double distance = math::dot(stage.motion(cube).position - begin, way);
    least = std::fmin(least, distance);
    most = std::fmax(most, distance);
    if (std::abs(distance - truth) > std::abs(worst - truth)) worst = distance;
    if (k == 0) m.tell("h", "stop from 5 m/s, μ .5: along an axis", "m", truth, 0.01 * truth, distance);
  }
  m.tell("5", "stop from 5 m/s, μ .5: worst of all directions", "m", truth, 0.01 * truth, worst);
  m.tell("5", "stop from 5 m/s, μ .5: spread over directions", "%", 0, 0.2, 100 * (most - least) / truth);
}

// With I = k m r²: v₀/(1 + k) after v₀ k/((1 + k) μ g).
void skid_to_roll(Measurement& m) {
  const double k = m.plane() ? 0.5 : 0.4, mu = 0.2;
  Stage stage = m.stage();
  stage.add(ground(mu));
  const int ball = stage.add(ball_at({0, 0.5, 0}, 0.5, mu));
  stage.run(30);
  stage.engine().set_velocity(ball, {5, 0, 0}, {});
  double before = 5, time = 2;
  for (int i = 1; i <= 120; ++i) {
    stage.step();
    const BodyMotion s = stage.motion(ball);
    const double slip = s.velocity.x + 0.5 * s.spin.z;
    // Slip falls at the constant rate that the steps before show.
    if (time == 2 && i > 1 && slip < 0.01) time = (i - 1 + before * (i - 1) / (5 - before)) / 60;
    before = slip;
  }
  const double speed = 5 / (1 + k), truth = 5 * k / ((1 + k) * mu * standard_g);
  m.tell("6", "ball skids at 5 m/s, μ .2: rolls at", "m/s", speed, 0.005 * speed, stage.motion(ball).velocity.x);
  m.tell("6", "ball skids at 5 m/s, μ .2: rolls after", "s", truth, 0.005 * truth, time);
}

// Under uniform pressure ⅔ μ m g R, so that it stops after 3 R ω₀/(4 μ g).
void spinning_disc(Measurement& m) {
  Stage stage = m.stage();
  stage.add(ground(0.5));
  Body disc;
  disc.kind = Kind::cylinder;
  disc.size = {0.1, 1, 1};
  disc.position = {0, 0.1, 0};
  disc.friction = 0.5;
  const int body = stage.add(disc);
  stage.run(30);
  stage.engine().set_velocity(body, {}, {0, 20, 0});
  int steps = 0;
  while (steps < 1200 && stage.motion(body).spin.y > 0.02) stage.step(), ++steps;
  const double truth = 3 * 20 / (4 * 0.5 * standard_g);
  m.tell("8", "disc spins on its face at 20 rad/s: stops after", "s", truth, 0.03 * truth, steps / 60.0);
}

void flush_tiles(Measurement& m) {
  struct Case {
    const char* name;
    Kind kind;
    Vec3d size;
    double height;
    Quatd rotation;
  };
  // In space a box turned by .3 rad and a capsule across the way; in the plane level and upright.
  const Quatd turned{std::cos(0.15), 0, std::sin(0.15), 0}, across{std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  const Case cases[] = {{"box", Kind::box, {0.25, 0.25, 0.25}, 0.25, m.plane() ? Quatd{} : turned},
                        {"ball", Kind::sphere, {0.3, 0, 0}, 0.3, {}},
                        {"capsule", Kind::capsule, {0.3, 0.3, 0}, m.plane() ? 0.6 : 0.3, m.plane() ? Quatd{} : across}};
  for (const Case& c : cases) {
    Stage stage = m.stage();
    for (int i = -2; i < 50; ++i)
      for (int j = m.plane() ? 0 : -1; j < (m.plane() ? 1 : 2); ++j)
        stage.add(fixed_box({double(i), -0.5, double(j)}, {0.5, 0.5, 0.5}, 0));
    Body body;
    body.kind = c.kind;
    body.size = c.size;
    body.position = {0, c.height, 0};
    body.rotation = c.rotation;
    body.velocity = {10, 0, 0};
    body.friction = 0;
    body.slides = true;
    const int slider = stage.add(body);
    stage.run(240);
    const double lost = std::abs(10 * (10 - stage.motion(slider).velocity.x));
    m.tell("f, 14", std::string(c.name) + " over flush tiles, 10 m/s, 4 s: speed lost", "%", 0, 0.1, lost);
  }
}

}  // namespace

std::vector<QualityScene> sliding_scenes() {
  return {{"slope", critical_slope},
          {"stop", stop_distance},
          {"skid", skid_to_roll},
          {"disc", spinning_disc, true},
          {"tiles", flush_tiles}};
}

}  // namespace carom::bench
