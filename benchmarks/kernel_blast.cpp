// Unit costs of fracture and of blasts: a Voronoi cell, a hull of it, a whole run-time fracture, a mesh, a polygon, a
// wave over a yard.
#include <benchmark/benchmark.h>

#include "carom/blast/explosion.h"
#include "carom/blast/fracture2.h"
#include "carom/blast/structure.h"
#include "carom/blast/wave.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/math/elementary.h"

namespace {
using namespace carom;
using namespace carom::blast;
using math::Vec3d;

const ConvexCell unit_cube(geometry::Bounds3d{{0, 0, 0}, {1, 1, 1}});

void VoronoiCell(benchmark::State& state) {
  const auto sites = uniform_sites(unit_cube, int(state.range(0)), 1);
  for (auto _ : state) benchmark::DoNotOptimize(voronoi_pattern(unit_cube, sites));
  state.counters["µs per cell"] = benchmark::Counter(
      double(state.range(0)) * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(VoronoiCell)->Arg(200)->Arg(10000);

void CellHull(benchmark::State& state) {
  const Pattern pattern = voronoi_pattern(unit_cube, uniform_sites(unit_cube, 200, 1)).value();
  std::size_t i = 0;
  for (auto _ : state) benchmark::DoNotOptimize(make_cell_hull(pattern.cells[i++ % 200], {}, 1e-3));
}
BENCHMARK(CellHull);

/// All quantities of a charge's wave at a place.
void WaveOfACharge(benchmark::State& state) {
  double distance = 5;
  for (auto _ : state) {
    benchmark::DoNotOptimize(blast_wave(100, distance));
    distance = distance > 100 ? 5 : distance + .1;
  }
}
BENCHMARK(WaveOfACharge);

/// From a body to two hundred in the world, on so many threads.
void FractureAtRunTime(benchmark::State& state) {
  const auto pool = core::make_thread_pool(int(state.range(0)));
  for (auto _ : state) {
    state.PauseTiming();
    rigid::World3 world;
    world.reserve({.bodies = 300, .shapes = 300, .contacts = 4000}).value();
    state.ResumeTiming();
    auto definition =
        structure_of(fracture_convex(voronoi_pattern(unit_cube, uniform_sites(unit_cube, 200, 1), pool.get()).value(),
                                     {.meshes = false, .scheduler = pool.get()})
                         .value(),
                     2400);
    definition.bonds.clear();
    benchmark::DoNotOptimize(Structure3::make(world, definition));
  }
}
BENCHMARK(FractureAtRunTime)->Arg(1)->Arg(2)->Arg(4)->UseRealTime()->Unit(benchmark::kMillisecond);

void FractureMesh(benchmark::State& state) {
  const geometry::Triangles ring = geometry::make_torus_mesh(0.7f, 0.25f, 24, 12);
  const std::vector<Vec3d> vertices(ring.positions.begin(), ring.positions.end());
  const ConvexCell box = container_of(vertices);
  const Pattern pattern = voronoi_pattern(box, uniform_sites(box, 40, 2)).value();
  for (auto _ : state)
    benchmark::DoNotOptimize(fracture_mesh(vertices, ring.indices, pattern, {.hulls = state.range(0) != 0}));
}
BENCHMARK(FractureMesh)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// In the plane, pattern and all: a star in two hundred Voronoi cells, or in bricks.
void FracturePolygon(benchmark::State& state) {
  std::vector<math::Vec2d> star;
  for (int i = 0; i < 12; ++i) {
    const double angle = 2 * math::pi * i / 12, radius = i % 2 == 0 ? 3 : 1.8;
    star.push_back({radius * math::cos(angle), radius * math::sin(angle)});
  }
  const bool bricks = state.range(0) != 0;
  for (auto _ : state) {
    const auto pattern = bricks ? brick_pattern2(star, {0.5, 0.25}, {-3, -3})
                                : voronoi_pattern2(uniform_sites2({{-3, -3}, {3, 3}}, 200, 1));
    benchmark::DoNotOptimize(fracture_polygon(star, *pattern));
  }
}
BENCHMARK(FracturePolygon)->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

/// A charge of 5 kg in the middle of a field of boxes, the wave after 30 ms on all of them.
void BlastOverBoxes(benchmark::State& state) {
  rigid::World3 world;
  const int side = state.range(0) > 100 ? 32 : 10;
  for (int i = 0; i < state.range(0); ++i) {
    rigid::BodyDef<rigid::Dim3> body;
    body.position = {1.5 * (i % side) - 0.75 * side + 0.8, 0.5, 1.5 * (i / side) - 0.75 * side + 0.8};
    (void)world.add_shape(world.create_body(body).value(), geometry::Box{{0.4f, 0.4f, 0.4f}});
  }
  for (auto _ : state) {
    auto charge = Explosion3::make({.mass = 5}).value();
    benchmark::DoNotOptimize(charge.apply(world, 0.03));
  }
}
BENCHMARK(BlastOverBoxes)->Arg(100)->Arg(1000)->Unit(benchmark::kMillisecond);

}  // namespace
