// What stands: stacks, heavy on light, a pyramid, overlaps that part.
#include <algorithm>
#include <cmath>

#include "benchmarks/quality.h"

namespace carom::bench {
namespace {

double sideways(Vec3d p) { return std::hypot(p.x, p.z); }

/// `light` cubes with one of `ratio` times their density on top.
struct Column {
  Stage stage;
  int top = 0;
  Column(const Measurement& m, int light, double ratio, double density = 1) : stage(m.stage()) {
    stage.add(ground());
    for (int i = 0; i <= light; ++i) top = stage.add(cube_at({0, 0.5 + i, 0}, 0.5, density * (i == light ? ratio : 1)));
  }
  double sag() const { return top - 0.5 - stage.motion(top).position.y; }
  double drift() const {
    double most = 0;
    for (int i = 1; i <= top; ++i) most = std::fmax(most, sideways(stage.motion(i).position));
    return most;
  }
};

void stacks(Measurement& m) {
  Column forty(m, 39, 1, 1000);
  forty.stage.run(3600);
  m.tell("1", "40 cubes, 60 s: sag of the top", "m", 0, 0.4, forty.sag());
  m.tell("1", "40 cubes, 60 s: sideways drift", "m", 0, 0.01, forty.drift());
  int tallest = 0;
  for (const int n : {5, 10, 12, 15, 20, 25, 30, 40, 50, 60}) {
    Column column(m, n - 1, 1);
    column.stage.run(900);
    if (column.sag() < 0.5) tallest = n;
  }
  m.tell("a", "tallest stack that sags less than .5 m in 15 s", "cubes", 60, 0, tallest);
}

void heavy_on_light(Measurement& m) {
  for (const int light : {1, 5}) {
    Column column(m, light, 1000);
    column.stage.run(1800);
    m.tell("2",
           "1000-fold cube on " + std::string(light == 1 ? "one light cube" : "five light cubes") + ", 30 s: sinks",
           "m", 0, 0.01, column.sag());
  }
  int heaviest = 1;
  for (const int ratio : {3, 10, 30, 100, 300, 1000, 3000, 10000}) {
    Column column(m, 3, ratio);
    column.stage.run(600);
    if (column.sag() < 0.3) heaviest = ratio;
  }
  m.tell("b", "heaviest top that sinks less than .3 m into three cubes", "masses", 10000, 0, heaviest);
}

void pyramid(Measurement& m) {
  for (const bool sleep : {false, true}) {
    Stage stage = m.stage({0, -standard_g, 0}, sleep);
    stage.add(ground());
    for (int row = 0; row < 12; ++row)
      for (int i = 0; i < 12 - row; ++i) stage.add(cube_at({0.5 * row + i, 0.5 + row, 0}));
    stage.run(600);
    if (sleep)
      m.tell("17", "pyramid of base 12, 10 s: cubes still awake", "", 0, 0, stage.awake());
    else
      m.tell("17", "pyramid of base 12, 10 s, sleep off: fastest cube", "m/s", 0, 1e-4, stage.fastest());
  }
}

// Twelve or 36 cubes half inside each other and half inside a wall. Off the heap that they become, 3 m high, one may
// fall 2.5 m, which gives 7 m/s.
void overlaps(Measurement& m) {
  Stage stage = m.stage();
  stage.add(ground());
  stage.add(fixed_box({-2, 5, 0}, {1, 5, 5}));
  const int depth = m.plane() ? 1 : 3;
  for (int y = 0; y < 3; ++y)
    for (int x = 0; x < 4; ++x)
      for (int z = 0; z < depth; ++z) stage.add(cube_at({-1 + 0.5 * x, 0.25 + 0.5 * y, 0.5 * z}));
  double most = 0;
  for (int i = 0; i < 600; ++i) {
    stage.step();
    most = std::fmax(most, stage.fastest());
  }
  m.tell("16", "cubes half inside each other, 10 s: fastest", "m/s", 0, 7, most);
}

}  // namespace

std::vector<QualityScene> standing_scenes() {
  return {{"stacks", stacks}, {"heavy", heavy_on_light}, {"pyramid", pyramid}, {"overlaps", overlaps}};
}

}  // namespace carom::bench
