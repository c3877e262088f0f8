// What ropes, cloth and soft bodies cost: a step of 1/60 s, all substeps.
#include <benchmark/benchmark.h>

#include "carom/particles/cloth.h"
#include "carom/particles/rope.h"
#include "carom/particles/soft_body.h"

namespace {

using namespace carom;
using namespace carom::particles;

/// Swings with a load a thousand times its own weight at its end.
void rope_step(benchmark::State& state) {
  rigid::World3 world;
  rigid::BodyDef<rigid::Dim3> def;
  def.position = {4, 0, 0};
  const auto load = world.create_body(def).value();
  world.add_shape(load, geometry::Sphere{.2f}, {.density = 12000}).value();
  RopeSet ropes;
  const math::Vec3d points[] = {{0, 0, 0}, {4, 0, 0}};
  const int rope = ropes.add({.points = points, .segments = int(state.range(0)), .collide = false}).value();
  ropes.attach(rope, {.node = 0}, world).value();
  ropes.attach(rope, {.node = -1, .body = load}, world).value();
  for (auto _ : state) {
    ropes.step(world, 1.0 / 60).value();
    state.PauseTiming();
    world.step(1.0f / 60).value();
    state.ResumeTiming();
  }
}

/// A flag in the wind (0), or a cloth that has fallen over a ball and hangs down from it (1); the same without folds
/// (2, 3), and with folds whose edges meet too (4, 5).
void cloth_step(benchmark::State& state) {
  const int side = int(state.range(0));
  rigid::World3 world;
  rigid::BodyDef<rigid::Dim3> def;
  def.type = rigid::BodyType::fixed;
  const auto fixed = world.create_body(def).value();
  world.add_shape(fixed, geometry::Sphere{.5f}).value();
  const bool flag = state.range(1) % 2 == 0;
  const ClothSheet sheet = flag ? make_cloth_sheet({1, 0, 0}, {1.5, 0, 0}, {0, 1.5, 0}, side, side)
                                : make_cloth_sheet({-.75, .52, -.75}, {1.5, 0, 0}, {0, 0, 1.5}, side, side);
  auto cloth = Cloth::make({.fabric = {.thickness = .01},
                            .points = sheet.points,
                            .triangles = sheet.triangles,
                            .self_collide = state.range(1) / 2 != 1,
                            .self_collide_edges = state.range(1) / 2 == 2})
                   .value();
  if (flag) {
    for (int r = 0; r < side; ++r) cloth.pin(r * side).value();
    cloth.set_air(1.225, {.velocity = {8, 0, 1}}).value();
  }
  for (int i = 0; i < 90; ++i) cloth.step(world, 1.0 / 60).value();
  double iterations = 0;
  for (auto _ : state) {
    cloth.step(world, 1.0 / 60).value();
    iterations += cloth.iterations();
  }
  state.counters["iterations"] = iterations / double(state.iterations());
}

void soft_body_step(benchmark::State& state) {
  rigid::World3 world;
  rigid::BodyDef<rigid::Dim3> def;
  def.type = rigid::BodyType::fixed;
  world.add_shape(world.create_body(def).value(), geometry::Plane{}).value();
  const int cells = int(state.range(0));
  const SoftMesh mesh = make_soft_box({0, .02, 0}, {.5, .5, .5}, cells, cells, cells);
  auto body = SoftBody::make({.points = mesh.points, .tetrahedra = mesh.tetrahedra}).value();
  for (int i = 0; i < 90; ++i) body.step(world, 1.0 / 60).value();
  double iterations = 0;
  for (auto _ : state) {
    body.step(world, 1.0 / 60).value();
    iterations += body.iterations();
  }
  double low = 1, high = 0;
  for (const math::Vec3d& p : body.positions()) {
    low = math::min(low, p.y);
    high = math::max(high, p.y);
  }
  state.counters["volume %"] = 100 * body.volume() / .125;
  state.counters["height %"] = 100 * (high - low) / .5;
  state.counters["iterations"] = iterations / double(state.iterations());
}

BENCHMARK(rope_step)->Arg(50)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(cloth_step)
    ->Args({32, 0})
    ->Args({64, 0})
    ->Args({64, 1})
    ->Args({64, 2})
    ->Args({64, 3})
    ->Args({64, 4})
    ->Args({64, 5})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(soft_body_step)->Arg(8)->Unit(benchmark::kMillisecond);

}  // namespace
