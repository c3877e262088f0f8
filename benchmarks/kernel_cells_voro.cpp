// Voro++'s cells of the sites of kernel_blast.cpp: with faces, neighbours and corners, as a fracture needs them.
#ifdef CAROM_WITH_VORO
#include <benchmark/benchmark.h>

#include <vector>
#include <voro++/voro++.hh>

#include "carom/blast/pattern.h"
#include "carom/math/elementary.h"

namespace {

void voro_cells(benchmark::State& state) {
  using namespace carom;
  const int count = int(state.range(0));
  const blast::ConvexCell cube(geometry::Bounds3d{{0, 0, 0}, {1, 1, 1}});
  const auto sites = blast::uniform_sites(cube, count, 1);
  const int blocks = std::max(1, int(math::cbrt(count / 5.0)));  // five sites in each, as its manual advises
  double volume = 0;
  for (auto _ : state) {
    voro::container container(0, 1, 0, 1, 0, 1, blocks, blocks, blocks, false, false, false, 8);
    for (int i = 0; i < count; ++i) {
      const math::Vec3d p = sites[std::size_t(i)];
      container.put(i, p.x, p.y, p.z);
    }
    voro::c_loop_all loop(container);
    voro::voronoicell_neighbor cell;
    std::vector<double> corners;
    std::vector<int> faces, neighbours;
    volume = 0;
    if (loop.start()) do {
        if (!container.compute_cell(cell, loop)) continue;
        cell.vertices(loop.x(), loop.y(), loop.z(), corners);
        cell.face_vertices(faces);
        cell.neighbors(neighbours);
        volume += cell.volume();
        benchmark::DoNotOptimize(corners.data());
      } while (loop.inc());
  }
  state.counters["volume"] = volume;
  state.counters["µs per cell"] = benchmark::Counter(
      double(count) * 1e-6, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
BENCHMARK(voro_cells)->Arg(200)->Arg(10000);

}  // namespace
#endif
