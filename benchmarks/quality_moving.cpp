// Joints, and what turns freely: chains, a cantilever, a pendulum, a gyroscope, the intermediate axis.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "benchmarks/quality.h"

namespace carom::bench {
namespace {

// Capsules of 1 kg (radius .1 m, half length .4 m) at ball joints at x = 0, 1, …, 20 from a fixed point, with a ball of
// radius 1 m beyond; released level.
double chain_gap(const Measurement& m, double ball_mass) {
  Stage stage = m.stage();
  constexpr int links = 20;
  for (int i = 0; i <= links; ++i) {
    Body body;
    body.kind = i == links ? Kind::sphere : Kind::capsule;
    body.size = i == links ? Vec3d{1, 0, 0} : Vec3d{0.4, 0.1, 0};
    body.position = {i == links ? i + 1.0 : i + 0.5, 0, 0};
    body.rotation = {std::sqrt(0.5), 0, 0, -std::sqrt(0.5)};
    body.mass = i == links ? ball_mass : 1;
    body.collides = false;
    stage.join({false, i - 1, stage.add(body), {double(i), 0, 0}});
  }
  double widest = 0;
  for (int i = 0; i < 900; ++i) {
    stage.step();
    widest = std::fmax(widest, stage.widest_gap());
  }
  return widest;
}
void chains(Measurement& m) {
  for (const int ratio : {100, 1000})
    m.tell("c, 3", "chain of 20 links, ball of " + std::to_string(ratio) + " times their mass: widest gap", "m", 0,
           0.01, chain_gap(m, ratio));
}

void cantilever(Measurement& m) {
  Stage stage = m.stage({0, -standard_g, 0}, false);
  int beam = 0;
  for (int i = 0; i < 10; ++i) {
    Body body;
    body.size = {0.5, 0.1, 0.1};
    body.position = {0.5 + i, 0, 0};
    body.collides = false;
    beam = stage.add(body);
    stage.join({true, i - 1, beam, {double(i), 0, 0}});
  }
  double lowest = 0;
  for (int i = 0; i < 1800; ++i) {
    stage.step();
    if (i >= 600) lowest = std::fmin(lowest, stage.motion(beam).position.y);
  }
  m.tell("3", "cantilever of ten welded beams: sags", "m", 0, 0.05, -lowest);
}

// T = 4 K(sin 45°) √(L/g) = 2.3678 s for a point; a ball's own moment makes it √(1 + I/m L²) times as long.
void pendulum(Measurement& m) {
  Stage stage = m.stage({0, -standard_g, 0}, false);
  Body bob = ball_at({1, 0, 0}, 0.1);
  bob.mass = 1;
  bob.collides = false;
  const double moment = moments(bob, m.dimension()).z;
  const int body = stage.add(bob);
  stage.join({false, -1, body, {}});
  double first = 0, period = 0, before = 1;
  for (int i = 1; i <= 3600; ++i) {
    stage.step();
    const double x = stage.motion(body).position.x;
    if (before < 0 && x >= 0) {
      const double t = (i - 1 + before / (before - x)) / 60;
      if (first == 0)
        first = t;
      else if (period == 0)
        period = t - first;
    }
    before = x;
  }
  const BodyMotion s = stage.motion(body);
  const double energy =
      (0.5 * math::dot(s.velocity, s.velocity) + 0.5 * moment * math::dot(s.spin, s.spin)) / standard_g + s.position.y +
      1;
  const double truth = 2.3678 * std::sqrt(1 + moment);
  m.tell("10", "pendulum from 90°: first period", "s", truth, 0.005 * truth, period);
  m.tell("10", "pendulum from 90°, 60 s: energy left", "of it", 1, 0.05, energy);
}

// A disc of R .3 m on an arm of .5 m, axis level, ω 80 rad/s, started at Ω = g r/(½ R² ω).
void gyroscope(Measurement& m) {
  Stage stage = m.stage({0, -standard_g, 0}, false);
  const double radius = 0.3, arm = 0.5, spin = 80, rate = standard_g * arm / (0.5 * radius * radius * spin);
  Body disc = ball_at({arm, 0, 0}, 0.1);
  disc.mass = 1;
  disc.moments = radius * radius * Vec3d{0.5, 0.25, 0.25};
  disc.spin = {spin, rate, 0};
  disc.velocity = {0, 0, -rate * arm};
  disc.collides = false;
  disc.spins = true;
  const int body = stage.add(disc);
  stage.join({false, -1, body, {}});
  double turned = 0, last = 0, lowest = 0;
  for (int i = 0; i < 600; ++i) {
    stage.step();
    const Vec3d p = stage.motion(body).position;
    const double angle = std::atan2(-p.z, p.x);
    turned += std::remainder(angle - last, 2 * std::numbers::pi);
    last = angle;
    lowest = std::fmin(lowest, p.y);
  }
  m.tell("11", "gyroscope, level axis, 10 s: precession", "rad/s", rate, 0.03 * rate, turned / 10);
  m.tell("11", "gyroscope, level axis, 10 s: droop (of the arm)", "%", 0, 3, 100 * -lowest / arm);
}

// ω (.01, 5, .01). Boxes of sides 1 × .6 × .2 change sign twelve times in a minute by elliptic functions, those of
// 2 × 1 × .3 thirteen times.
void intermediate_axis(Measurement& m) {
  struct Case {
    const char *scene, *name;
    Vec3d half;
    double flips;
  };
  for (const Case& c :
       {Case{"9", "1 × .6 × .2 m", {0.5, 0.3, 0.1}, 12}, Case{"e", "2 × 1 × .3 m", {1, 0.5, 0.15}, 13}}) {
    Stage stage = m.stage({});
    Body box;
    box.size = c.half;
    box.spin = {0.01, 5, 0.01};
    box.spins = true;
    const int body = stage.add(box);
    const Vec3d inertia = moments(box, 3);
    const auto energy = [&](Vec3d w) { return inertia.x * w.x * w.x + inertia.y * w.y * w.y + inertia.z * w.z * w.z; };
    int flips = 0;
    double last = 5, worst = 0;
    for (int i = 0; i < 3600; ++i) {
      stage.step();
      const BodyMotion s = stage.motion(body);
      const Vec3d w = math::inverse_rotate(s.rotation, s.spin);
      flips += w.y * last < 0;
      last = w.y;
      const double off = energy(w) / energy(box.spin) - 1;
      if (std::abs(off) > std::abs(worst)) worst = off;
    }
    m.tell(c.scene, std::string(c.name) + " turns about its middle axis: flips", "", c.flips, 0, flips);
    m.tell(c.scene, std::string(c.name) + " turns about its middle axis: energy off by", "%", 0, 0.1, 100 * worst);
  }
}

}  // namespace

std::vector<QualityScene> moving_scenes() {
  return {{"chains", chains},
          {"cantilever", cantilever},
          {"axis", intermediate_axis, true},
          {"pendulum", pendulum},
          {"gyroscope", gyroscope, true}};
}

}  // namespace carom::bench
