// Unit costs of the narrow phase and of the trees. Each pair is measured over 64 poses near contact, so that branches
// are as unpredictable as in a pile; "cached" keeps one cache a pose, as a world does from step to step.
#include <benchmark/benchmark.h>

#include "carom/geometry/dynamic_tree.h"
#include "carom/geometry/height_field.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/manifold.h"
#include "carom/geometry/query.h"

namespace {
using namespace carom;
using namespace carom::geometry;

struct KernelDraw {
  std::uint64_t state = 0x9e3779b97f4a7c15ull;
  double unit() {
    state ^= state << 13, state ^= state >> 7, state ^= state << 17;
    return double(state >> 11) * 0x1p-53;
  }
  float in(double a, double b) { return float(a + (b - a) * unit()); }
  Quatf rotation() { return normalize(Quatf{in(-1, 1), in(-1, 1), in(-1, 1), in(-1, 1)}); }
};

Shape3 kernel_hull(int points) {
  KernelDraw draw;
  std::vector<Vec3f> cloud;
  for (int i = 0; i < points; ++i)
    cloud.push_back(normalize(Vec3f{draw.in(-1, 1), draw.in(-1, 1), draw.in(-1, 1)}) * 0.5f);
  return make_hull(cloud).value();
}

/// Touching: pushed together until they overlap by about a hundredth of their size.
std::vector<Transform3f> touching(const Shape3& a, const Shape3& b, bool flat) {
  KernelDraw draw;
  std::vector<Transform3f> out;
  for (int k = 0; k < 64; ++k) {
    Transform3f x;
    x.q = flat ? normalize(Quatf{1, 0, draw.in(-1, 1), 0}) : draw.rotation();
    const Vec3f d = flat ? Vec3f{0, 1, 0} : normalize(Vec3f{draw.in(-1, 1), draw.in(-1, 1), draw.in(-1, 1)});
    x.p = d * 5.0f;
    if (flat) x.p += Vec3f{draw.in(-0.2, 0.2), 0, draw.in(-0.2, 0.2)};
    const CastHit3 h = shape_cast(a, b, x, -d * 5.0f);
    x.p += -d * (5 * h.fraction + 0.005f);
    out.push_back(x);
  }
  return out;
}

void run_pair(benchmark::State& state, const Shape3& a, const Shape3& b, bool flat, bool cached) {
  const std::vector<Transform3f> poses = touching(a, b, flat);
  PairCache caches[64];
  Manifold3 m;
  std::size_t k = 0;
  for (auto _ : state) {
    if (!cached) caches[k] = {};
    collide(a, b, poses[k], 0.02f, caches[k], m);
    benchmark::DoNotOptimize(m);
    k = (k + 1) & 63;
  }
}
const Box unit_box{{0.5f, 0.5f, 0.5f}};
#define PAIR(name, a, b, flat, cached)                                                        \
  void name(benchmark::State& state) { run_pair(state, Shape3(a), Shape3(b), flat, cached); } \
  BENCHMARK(name)
PAIR(sphere_sphere, Sphere{0.5f}, Sphere{0.5f}, false, true);
PAIR(capsule_capsule, (Capsule3{0.5f, 0.3f}), (Capsule3{0.5f, 0.3f}), false, true);
PAIR(box_sphere, unit_box, Sphere{0.5f}, false, true);
PAIR(box_capsule, unit_box, (Capsule3{0.5f, 0.3f}), false, true);
PAIR(box_box_full, unit_box, unit_box, false, false);
PAIR(box_box_cached, unit_box, unit_box, false, true);
PAIR(box_box_resting, unit_box, unit_box, true, true);
PAIR(hull_hull_12_full, kernel_hull(12), kernel_hull(12), false, false);
PAIR(hull_hull_12_cached, kernel_hull(12), kernel_hull(12), false, true);
PAIR(hull_hull_32_full, kernel_hull(32), kernel_hull(32), false, false);
PAIR(hull_hull_32_cached, kernel_hull(32), kernel_hull(32), false, true);
PAIR(box_cylinder_full, unit_box, (Cylinder{0.5f, 0.4f}), false, false);
PAIR(box_cylinder_resting, unit_box, (Cylinder{0.5f, 0.4f}), true, true);

void run_pair2(benchmark::State& state, const Shape2& a, const Shape2& b, float reach) {
  KernelDraw draw;
  Transform2f poses[64];
  for (Transform2f& x : poses) {
    x.q = normalize(Rot2f{draw.in(-1, 1), draw.in(-1, 1)});
    x.p = normalize(Vec2f{draw.in(-1, 1), draw.in(-1, 1)}) * reach;
  }
  PairCache caches[64];
  Manifold2 m;
  std::size_t k = 0;
  for (auto _ : state) {
    collide(a, b, poses[k], 0.02f, caches[k], m);
    benchmark::DoNotOptimize(m);
    k = (k + 1) & 63;
  }
}
void plane_circle_circle(benchmark::State& state) { run_pair2(state, Circle{0.5f}, Circle{0.5f}, 0.99f); }
void plane_box_box(benchmark::State& state) {
  run_pair2(state, make_box2({0.5f, 0.5f}), make_box2({0.5f, 0.5f}), 0.98f);
}
void plane_box_capsule(benchmark::State& state) {
  run_pair2(state, make_box2({0.5f, 0.5f}), Capsule2{0.5f, 0.25f}, 0.95f);
}
BENCHMARK(plane_circle_circle);
BENCHMARK(plane_box_box);
BENCHMARK(plane_box_capsule);

void box_on_height_field(benchmark::State& state) {
  const Shape3 field = make_height_field(65, 65, {0.5f, 0.5f}, std::vector<float>(65 * 65)).value();
  KernelDraw draw;
  Manifold3 m[4];
  Transform3f poses[64];
  for (Transform3f& x : poses)
    x = {{draw.in(4, 28), 0.499f, draw.in(4, 28)}, normalize(Quatf{1, 0, draw.in(-1, 1), 0})};
  std::size_t k = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(collide_many(field, Shape3(unit_box), poses[k], 0.02f, m));
    k = (k + 1) & 63;
  }
}
BENCHMARK(box_on_height_field);

struct TreeScene {
  DynamicTree3 tree;
  std::vector<Bounds3d> boxes;
  std::vector<int> leaves;
  explicit TreeScene(int count) {
    KernelDraw draw;
    std::vector<std::uint32_t> items;
    for (int i = 0; i < count; ++i) {
      const Vec3d c{draw.in(-50, 50), draw.in(-5, 5), draw.in(-50, 50)};
      boxes.push_back({c - Vec3d{0.6, 0.6, 0.6}, c + Vec3d{0.6, 0.6, 0.6}});
      items.push_back(std::uint32_t(i));
    }
    leaves.resize(std::size_t(count));
    tree.insert_all(boxes, items, leaves.data());
  }
};
void tree_query(benchmark::State& state) {
  const TreeScene scene(int(state.range(0)));
  std::size_t k = 0, found = 0;
  for (auto _ : state) {
    scene.tree.query(scene.boxes[k], [&](std::uint32_t) { return ++found, true; });
    k = (k + 1) % scene.boxes.size();
  }
  state.counters["found"] = double(found) / double(state.iterations());
}
void tree_self_pairs(benchmark::State& state) {
  const TreeScene scene(int(state.range(0)));
  std::size_t found = 0;
  for (auto _ : state) scene.tree.self_pairs([&](std::uint32_t, std::uint32_t) { ++found; });
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
void tree_update(benchmark::State& state) {
  TreeScene scene(int(state.range(0)));
  std::size_t k = 0;
  for (auto _ : state) {
    scene.tree.update(scene.leaves[k], scene.boxes[k]);
    k = (k + 1) % scene.boxes.size();
  }
}
void tree_rebuild(benchmark::State& state) {
  TreeScene scene(int(state.range(0)));
  for (auto _ : state) scene.tree.rebuild();
  state.SetItemsProcessed(state.iterations() * state.range(0));
}
void tree_ray(benchmark::State& state) {
  const TreeScene scene(int(state.range(0)));
  KernelDraw draw;
  std::size_t found = 0;
  for (auto _ : state) {
    const Vec3d from{draw.in(-60, 60), draw.in(-5, 5), draw.in(-60, 60)};
    scene.tree.cast(from, {draw.in(-60, 60), 0, draw.in(-60, 60)}, {},
                    [&](std::uint32_t, double limit) { return ++found, limit * 0.5; });
  }
}
BENCHMARK(tree_query)->Arg(10000);
BENCHMARK(tree_self_pairs)->Arg(10000);
BENCHMARK(tree_update)->Arg(10000);
BENCHMARK(tree_rebuild)->Arg(10000);
BENCHMARK(tree_ray)->Arg(10000);

void ray_on_hull(benchmark::State& state) {
  const Shape3 hull = kernel_hull(32);
  KernelDraw draw;
  for (auto _ : state) {
    const Vec3f from{draw.in(-1, 1), 2, draw.in(-1, 1)}, way{draw.in(-1, 1), -3, draw.in(-1, 1)};
    benchmark::DoNotOptimize(ray_cast(hull, from, way));
  }
}
BENCHMARK(ray_on_hull);
void impact_of_a_rod(benchmark::State& state) {
  KernelDraw draw;
  const Shape3 rod = Capsule3{0.4f, 0.02f}, wall = Box{{0.05f, 3, 3}};
  for (auto _ : state) {
    const Quatf q = draw.rotation();
    const Sweep3 s{{}, {-2, 0, 0}, {4, 0.5f, 0.2f}, q, normalize(q * Quatf{1, 0.2f, 0.3f, 0})};
    benchmark::DoNotOptimize(time_of_impact(rod, s, wall, Sweep3{}));
  }
}
BENCHMARK(impact_of_a_rod);
}  // namespace
