// What strikes: restitution, Newton's cradle, bullets, and the momentum of a cloud that collides.
#include <algorithm>
#include <cmath>

#include "benchmarks/quality.h"

namespace carom::bench {
namespace {

/// The worst relative error of the apexes e^(2k) h of a ball that falls from h, of up to ten bounces that strike faster
/// than 1.05 m/s: slower impacts do not bounce at the engines' defaults.
double apex_error(const Measurement& m, double e, double h) {
  Stage stage = m.stage();
  stage.add(ground(0, e));
  const int ball = stage.add(ball_at({0, 0.5 + h, 0}, 0.5, 0, e));
  double strike = std::sqrt(2 * standard_g * h), expected = h, worst = 0, y2 = h, y1 = h;
  int apexes = 0;
  for (int i = 1; i < 1800 && apexes < 10; ++i) {
    stage.step();
    const double y = stage.motion(ball).position.y - 0.5;
    if (i > 2 && y1 > y2 && y1 >= y) {  // the parabola through three heights
      const double a = 0.5 * (y2 + y) - y1, b = 0.5 * (y - y2), apex = y1 - b * b / (4 * a);
      if (strike < 1.05) break;
      expected *= e * e;
      strike *= e;
      ++apexes;
      if (strike < 1.05 && expected < 0.02) break;
      worst = std::fmax(worst, std::abs(apex - expected) / expected);
    }
    y2 = y1;
    y1 = y;
  }
  return apexes > 0 ? worst : 1;  // never came up again
}
void restitution(Measurement& m) {
  double lossy = 0, lossless = 0;
  for (const double h : {0.7, 1.0, 1.37, 2.0, 5.0, 13.0, 40.0}) {
    for (const double e : {0.2, 0.4, 0.5, 0.6, 0.8, 0.9, 0.95}) lossy = std::fmax(lossy, apex_error(m, e, h));
    lossless = std::fmax(lossless, apex_error(m, 1, h));
  }
  m.tell("12", "ball falls, e .2 to .95: worst apex off by", "%", 0, 1, 100 * lossy);
  m.tell("12", "ball falls, e 1, ten bounces: worst apex off by", "%", 0, 1, 100 * lossless);
}

void cradle(Measurement& m) {
  for (const int strikers : {1, 2, 3}) {
    Stage stage = m.stage({});
    for (int i = 0; i < strikers; ++i) {
      Body ball = ball_at({-2.0 - (strikers - 1 - i), 0, 0}, 0.5, 0, 1);
      ball.velocity = {5, 0, 0};
      stage.add(ball);
    }
    for (int i = 0; i < 5; ++i) stage.add(ball_at({double(i), 0, 0}, 0.5, 0, 1));
    stage.run(60);
    double worst = 0;
    const int count = strikers + 5;
    for (int i = 0; i < count; ++i)
      worst = std::fmax(worst, std::abs(stage.motion(i).velocity.x - (i >= count - strikers ? 5 : 0)));
    m.tell("13", "cradle of 5 struck by " + std::to_string(strikers) + ": worst velocity off by", "%", 0, 2,
           100 * worst / 5);
  }
}

void bullets(Measurement& m) {
  {
    Stage stage = m.stage({});
    stage.add(fixed_box({}, {0.05, 2, 2}));
    Body ball = ball_at({-3, 0, 0}, 0.05);
    ball.velocity = {300, 0, 0};
    const int body = stage.add(ball);
    stage.run(60);
    m.tell("g", "ball at 300 m/s, no flag set: passes a wall of .1 m (1)", "", 0, 0, stage.motion(body).position.x > 0);
  }
  Stage stage = m.stage({});
  stage.add(fixed_box({}, {0.05, 110, 5}));
  for (int i = 0; i < 200; ++i) {
    const Vec3d from{-2 - 0.0137 * i, 1.0 * (i - 100), 0};
    Body body = i % 2 == 0 ? ball_at(from, 0.05) : cube_at(from);
    if (i % 2 == 1) body.size = {0.05, 0.03, 0.04};
    body.rotation = {std::cos(0.185 * i), 0, 0, std::sin(0.185 * i)};
    body.velocity = {400, 0, 0};
    body.bullet = true;
    stage.add(body);
  }
  stage.run(30);
  int passed = 0;
  for (int i = 1; i <= 200; ++i) {
    const Vec3d p = stage.motion(i).position;
    passed += p.x > 0 && std::abs(p.y) < 110 && std::abs(p.z) < 5;  // not round it
  }
  m.tell("15", "200 bullets at 400 m/s: pass a wall of .1 m", "", 0, 0, passed);
}

// Eighty balls and boxes of 1 : 10⁴ in density fly together; no gravity.
void momentum(Measurement& m) {
  Stage stage = m.stage({});
  std::uint32_t state = 7;
  const auto draw = [&state] {
    state = 1664525u * state + 1013904223u;
    return double(state >> 8) / 16777216.0 - 0.5;
  };
  for (int i = 0; i < 80; ++i) {
    const double x = draw(), y = draw(), z = m.plane() ? 0 : draw();
    Body body = i % 2 == 0 ? ball_at({}, 0.4, 0.5, 0.3) : cube_at({}, 0.4, 1, 0.5);
    if (i % 2 == 1) body.size = {0.4, 0.3, 0.5};
    body.restitution = 0.3;
    body.density = std::pow(10, 4 * (draw() + 0.5));
    body.position = {8 * x, 8 * y, 8 * z};
    body.velocity = {-6 * x + draw(), -6 * y + draw(), -6 * z};
    stage.add(body);
  }
  struct Totals {
    Vec3d linear{}, angular{};
    double linear_size = 0, angular_size = 0;
  };
  const auto totals = [&] {
    Totals t;
    for (int i = 0; i < 80; ++i) {
      const Body& b = stage.bodies()[std::size_t(i)];
      const BodyMotion s = stage.motion(i);
      const Vec3d p = mass(b, m.dimension()) * s.velocity, w = math::inverse_rotate(s.rotation, s.spin),
                  inertia = moments(b, m.dimension());
      t.linear += p;
      t.angular +=
          cross(s.position, p) + math::rotate(s.rotation, Vec3d{inertia.x * w.x, inertia.y * w.y, inertia.z * w.z});
      t.linear_size += length(p);
      t.angular_size += length(s.position) * length(p);
    }
    return t;
  };
  const Totals before = totals();
  stage.run(300);
  const Totals after = totals();
  m.tell("21", "80 bodies collide: momentum off by", "", 0, 1e-6,
         length(after.linear - before.linear) / before.linear_size);
  m.tell("21", "80 bodies collide: angular momentum off by", "", 0, 1e-6,
         length(after.angular - before.angular) / before.angular_size);
}

}  // namespace

std::vector<QualityScene> striking_scenes() {
  return {{"restitution", restitution}, {"cradle", cradle}, {"bullets", bullets}, {"momentum", momentum}};
}

}  // namespace carom::bench
