// Small random scenes in Carom and in Bullet: two engines that were written apart must agree on what mechanics decides,
// rest positions, stop distances, momentum, impacts, within what Bullet's own softness and margins allow.
#include <gtest/gtest.h>

#include "tests/differential/bullet_world.h"

namespace carom::differential {
namespace {

class Draw {
 public:
  explicit Draw(std::uint32_t seed) : r_(seed * 747796405u + 2891336453u) {}
  float operator()(float low, float high) {
    r_ = 1664525u * r_ + 1013904223u;
    return low + (high - low) * float(r_ >> 8) / 16777216.0f;
  }

 private:
  std::uint32_t r_;
};
Body ground(float friction) {
  Body g;
  g.size = {100, 1, 100};
  g.position = {0, -1, 0};
  g.fixed = true;
  g.friction = friction;
  return g;
}
constexpr int scenes = 20;

TEST(Differential, StopDistances) {
  for (std::uint32_t i = 0; i < scenes; ++i) {
    Draw draw(i);
    Scene scene;
    const float mu = draw(0.2f, 0.8f), speed = draw(2, 6), heading = draw(0, 6.28f);
    scene.bodies.push_back(ground(mu));
    Body box;
    box.size = {draw(0.4f, 0.8f), 0.2f, draw(0.4f, 0.8f)};
    box.position = {0, double(box.size.y), 0};
    box.velocity = {speed * std::cos(heading), 0, speed * std::sin(heading)};
    box.friction = mu;
    scene.bodies.push_back(box);
    const Outcome carom = run_carom(scene, 300), bullet = run_bullet(scene, 300);
    const double truth = double(speed * speed) / (2 * double(mu) * 9.81);
    const double way = length(carom.position[1] - box.position), theirs = length(bullet.position[1] - box.position);
    EXPECT_NEAR(way, truth, 0.02 * truth) << "scene " << i;
    EXPECT_NEAR(way, theirs, 0.06 * truth) << "scene " << i;
    EXPECT_LT(length(carom.velocity[1]), 1e-3) << "scene " << i;
  }
}

TEST(Differential, SlopesHoldOrSlide) {
  for (std::uint32_t i = 0; i < scenes; ++i) {
    Draw draw(100 + i);
    Scene scene;
    const float mu = draw(0.2f, 0.8f);
    // Clear of the critical angle, so that the verdict is no matter of digits.
    const float angle = std::atan(mu) * (i % 2 == 0 ? draw(0.5f, 0.9f) : draw(1.1f, 1.4f));
    scene.gravity = {9.81f * std::sin(angle), -9.81f * std::cos(angle), 0};
    scene.bodies.push_back(ground(mu));
    Body box;
    box.size = {draw(0.6f, 0.9f), 0.25f, draw(0.4f, 0.8f)};
    box.position = {0, double(box.size.y), 0};
    box.friction = mu;
    scene.bodies.push_back(box);
    const Outcome carom = run_carom(scene, 120), bullet = run_bullet(scene, 120);
    const double x = carom.position[1].x, theirs = bullet.position[1].x;
    if (i % 2 == 0) {
      EXPECT_LT(std::abs(x), 0.01) << "scene " << i;
      EXPECT_LT(std::abs(theirs), 0.05) << "scene " << i;
    } else {
      EXPECT_NEAR(x, theirs, 0.05 * x + 0.02) << "scene " << i;
    }
  }
}

TEST(Differential, StacksComeToRestAtTheSamePlace) {
  for (std::uint32_t i = 0; i < scenes; ++i) {
    Draw draw(200 + i);
    Scene scene;
    scene.bodies.push_back(ground(0.7f));
    double top = 0;
    const int count = 2 + int(i % 4);
    for (int k = 0; k < count; ++k) {
      Body box;
      box.size = {draw(0.6f, 0.8f) - 0.05f * float(k), draw(0.2f, 0.5f), draw(0.6f, 0.8f) - 0.05f * float(k)};
      box.density = draw(500, 1500);
      box.friction = 0.7f;
      box.position = {double(draw(-0.05f, 0.05f)), top + double(box.size.y) + 0.01, double(draw(-0.05f, 0.05f))};
      top += 2 * double(box.size.y) + 0.01;
      scene.bodies.push_back(box);
    }
    const Outcome carom = run_carom(scene, 360), bullet = run_bullet(scene, 360);
    for (int k = 1; k <= count; ++k) {
      EXPECT_LT(length(carom.position[std::size_t(k)] - bullet.position[std::size_t(k)]), 0.04)
          << "scene " << i << ", box " << k;
      EXPECT_LT(length(carom.velocity[std::size_t(k)]), 1e-3) << "scene " << i << ", box " << k;
    }
  }
}

TEST(Differential, SpheresStrike) {
  for (std::uint32_t i = 0; i < scenes; ++i) {
    Draw draw(300 + i);
    Scene scene;
    scene.gravity = {};
    const float e = draw(0, 1);
    for (int k = 0; k < 2; ++k) {
      Body ball;
      ball.kind = Kind::sphere;
      const float r = draw(0.3f, 0.6f);
      ball.size = {r, r, r};
      ball.density = draw(300, 3000);
      ball.friction = 0;
      ball.restitution = e;
      ball.position = {k == 0 ? -2.0 : 2.0, 0, 0};
      ball.velocity = {k == 0 ? draw(2, 5) : draw(-5, -2), 0, 0};
      scene.bodies.push_back(ball);
    }
    const Outcome carom = run_carom(scene, 120), bullet = run_bullet(scene, 120);
    // Bullet pushes what it found overlapping apart, which adds to the law of impact.
    const double m0 = carom.mass[0], m1 = carom.mass[1], v0 = double(scene.bodies[0].velocity.x),
                 v1 = double(scene.bodies[1].velocity.x);
    const double impulse = (1 + double(e)) * m0 * m1 / (m0 + m1) * (v0 - v1);
    EXPECT_NEAR(carom.velocity[0].x, v0 - impulse / m0, 0.01) << "scene " << i << ", e " << e;
    EXPECT_NEAR(carom.velocity[1].x, v1 + impulse / m1, 0.01) << "scene " << i << ", e " << e;
    for (int k = 0; k < 2; ++k)
      EXPECT_LT(length(carom.velocity[std::size_t(k)] - bullet.velocity[std::size_t(k)]), 0.6)
          << "scene " << i << ", ball " << k << ", e " << e;
    EXPECT_LT(length(carom.momentum() - bullet.momentum()), 1e-3 * carom.mass[0]) << "scene " << i;
  }
}

TEST(Differential, CloudsKeepTheirMomentum) {
  for (std::uint32_t i = 0; i < scenes; ++i) {
    Draw draw(400 + i);
    Scene scene;
    scene.gravity = {};
    double scale = 0;
    for (int k = 0; k < 12; ++k) {
      Body body;
      body.kind = k % 2 == 0 ? Kind::box : Kind::sphere;
      const float r = draw(0.3f, 0.6f);
      body.size = k % 2 == 0 ? math::Vec3f{draw(0.2f, 0.6f), draw(0.2f, 0.6f), draw(0.2f, 0.6f)} : math::Vec3f{r, r, r};
      body.density = draw(300, 3000);
      body.position = {2.0 * (k % 3 - 1), 2.0 * (k / 3 % 2), 2.0 * (k / 6)};
      body.velocity = math::Vec3f(math::Vec3d{0, 1, 1} - body.position) * draw(0.5f, 1.5f);
      body.spin = {draw(-2, 2), draw(-2, 2), draw(-2, 2)};
      scene.bodies.push_back(body);
      scale += volume(body) * double(body.density) * double(length(body.velocity));
    }
    const Outcome start = run_carom(scene, 0), carom = run_carom(scene, 180), bullet = run_bullet(scene, 180);
    EXPECT_LT(length(carom.momentum() - start.momentum()), 2e-6 * scale) << "scene " << i;
    EXPECT_LT(length(carom.momentum() - bullet.momentum()), 2e-4 * scale) << "scene " << i;
    EXPECT_LT(carom.energy(), start.energy()) << "scene " << i;
  }
}

TEST(Differential, PendulumsSwingTogether) {
  for (std::uint32_t i = 0; i < scenes; ++i) {
    Draw draw(500 + i);
    Scene scene;
    Body bob;
    bob.kind = Kind::sphere;
    bob.size = {0.2f, 0.2f, 0.2f};
    const float length_ = draw(0.8f, 2), angle = draw(0.3f, 1.5f), heading = draw(0, 6.28f);
    bob.position = {double(length_ * std::sin(angle) * std::cos(heading)), -double(length_ * std::cos(angle)),
                    double(length_ * std::sin(angle) * std::sin(heading))};
    scene.bodies.push_back(bob);
    scene.pins.push_back({0, math::Vec3f(-bob.position)});
    const Outcome carom = run_carom(scene, 60), bullet = run_bullet(scene, 60);
    EXPECT_LT(length(carom.position[0] - bullet.position[0]), 0.2 * double(length_)) << "scene " << i;
    EXPECT_NEAR(length(carom.position[0]), double(length_), 0.005) << "scene " << i;
  }
}

TEST(Differential, DroppedBodiesComeToRest) {
  for (std::uint32_t i = 0; i < scenes; ++i) {
    Draw draw(600 + i);
    Scene scene;
    scene.bodies.push_back(ground(0.6f));
    Body box;
    box.size = {draw(0.2f, 0.3f), draw(0.35f, 0.45f), draw(0.5f, 0.6f)};
    box.rotation = normalize(math::Quatf{draw(-1, 1), draw(-1, 1), draw(-1, 1), draw(-1, 1)});
    box.position = {0, 1.5, 0};
    box.friction = 0.6f;
    scene.bodies.push_back(box);
    const Outcome carom = run_carom(scene, 600), bullet = run_bullet(scene, 600);
    // Which face it falls on is chaos; that it lies on a face is not.
    for (const Outcome* out : {&carom, &bullet}) {
      const double y = out->position[1].y;
      const double off = std::min(
          {std::abs(y - double(box.size.x)), std::abs(y - double(box.size.y)), std::abs(y - double(box.size.z))});
      EXPECT_LT(off, out == &carom ? 0.005 : 0.03) << "scene " << i << (out == &carom ? ", Carom" : ", Bullet");
      EXPECT_LT(length(out->velocity[1]), out == &carom ? 1e-3 : 0.05) << "scene " << i;
    }
  }
}

}  // namespace
}  // namespace carom::differential
