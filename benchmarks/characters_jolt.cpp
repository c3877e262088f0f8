// A hundred characters walk to and fro over a wavy mesh with stairs and pillars, among a hundred small boxes.
#include "benchmarks/scene_pieces.h"
#include "carom/math/random.h"
#include "carom/rigid/character.h"

namespace carom::bench {
namespace {
using math::Vec3d;
using math::Vec3f;

class Characters final : public Scene<Dim3> {
  void build(World3& world) override {
    const auto wave = [](int i, int j) { return 2 * math::sin(20.0 * i / 100) * math::cos(20.0 * j / 100); };
    add_fixed(world, {-25, 0, -25}, terrain(100, 100, 0.5f, {}, wave), 0.2f);
    for (int i = 0; i < 10; ++i) {
      const float half = 4 - 0.4f * float(i);
      add_fixed(world, {-4, -1 + 0.3 * i, 0}, geometry::Box{{half, 0.15f, half}}, 0.2f);
    }
    for (int k = 0; k < 10; ++k) add_fixed(world, {2, 1, 2 + 0.2 * k}, geometry::Box{{0.1f, 2.5f, 0.1f}}, 0.2f);
    ShapeDef<Dim3> s;
    s.density = 8;  // kg/m³: half a metre wide, 1 kg
    s.material.friction = 0.2f;
    for (int x = 0; x < 10; ++x)
      for (int z = 0; z < 10; ++z)
        add_body<Dim3>(world,
                       {.position = {4.0 * x - 20, 5, 4.0 * z - 20}, .linear_damping = 0.05f, .angular_damping = 0.05f},
                       geometry::Box{{0.25f, 0.25f, 0.25f}}, s);
    for (int x = 0; x < 10; ++x)
      for (int z = 0; z < 10; ++z)
        walkers_.push_back(
            {rigid::Character3::create(world, {.radius = 0.3f, .half_length = 0.675f}, {4.0 * x - 20, 2, 4.0 * z - 20})
                 .value(),
             {},
             5 + 0.5f * float(x)});
  }
  void before_step(World3& world, int step) override {
    for (Walker& w : walkers_) {
      if (step % 120 == 0) w.target = {random_.uniform(-20.0, 20.0), 0, random_.uniform(-20.0, 20.0)};
      Vec3f way = Vec3f(w.target - w.character.feet());
      way.y = 0;
      const float distance = math::length(way);
      const Vec3f velocity = distance > 0.5f ? way * (w.speed / distance) : Vec3f{};
      w.character.move(world, velocity, 1.0f / 60.0f).value();
    }
  }

  struct Walker {
    rigid::Character3 character;
    Vec3d target;
    float speed;  ///< m/s
  };
  std::vector<Walker> walkers_;
  math::Random random_{5};
};

}  // namespace

std::unique_ptr<Scene<Dim3>> make_characters() { return std::make_unique<Characters>(); }

}  // namespace carom::bench
