// What one asks of a world besides steps: rays, casts and overlaps against 10⁵ fixed triangles, 10⁴ boxes and a heap
// that sleeps; the cost of creating, destroying and moving a body beside n others; what sleeping bodies add to a step.
#include <benchmark/benchmark.h>

#include "benchmarks/scene_list.h"
#include "benchmarks/scene_pieces.h"
#include "carom/geometry/mesh_builders.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/math/random.h"

namespace {
using namespace carom;
using namespace carom::bench;
using math::Vec3d;
using math::Vec3f;

enum Place { triangles, boxes, heap_at_rest };
constexpr const char* place_names[] = {"triangles_1e5", "boxes_1e4", "sleeping_heap"};

/// Half the extents of the space that queries start in, and how far they go (m).
struct Room {
  Vec3d center, half;
  double reach;
};
constexpr Room rooms[] = {{{0, 0, 0}, {100, 3, 100}, 50}, {{0, 0, 0}, {50, 50, 50}, 50}, {{0, 6, 0}, {6, 8, 6}, 12}};

World3 make_world(Place place) {
  rigid::WorldDef<Dim3> definition;
  World3 world(definition);
  if (place == triangles) {  // 2 · 224² = 100 352
    const auto wave = [](int i, int j) { return 2 * math::sin(0.11 * i) * math::cos(0.07 * j); };
    add_fixed(world, {-112, 0, -112}, terrain(224, 224, 1, {}, wave));
  } else if (place == boxes) {
    math::Random random(7);
    for (int i = 0; i < 10000; ++i) {
      const Vec3d at{random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0)};
      add_body<Dim3>(world, {.type = BodyType::fixed, .position = at, .rotation = math::Quatf(random.rotation())},
                     geometry::Box{{0.5f, 0.75f, 1}}, {});
    }
  } else {
    ListScene<Dim3>(heap()).build(world);
    for (int i = 0; i < 1800 && world.counters().awake_bodies > 0; ++i) world.step(1.0f / 60.0f).value();
  }
  return world;
}
World3& world_of(int place) {
  static World3 worlds[] = {make_world(triangles), make_world(boxes), make_world(heap_at_rest)};
  return worlds[place];
}

struct Query {
  Vec3d origin;
  Vec3f translation;
};
std::vector<Query> queries(int place) {
  const Room& room = rooms[place];
  math::Random random(11);
  std::vector<Query> out;
  for (int i = 0; i < 1024; ++i) {
    const Vec3d u{random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0)};
    const Vec3d at = room.center + Vec3d{u.x * room.half.x, u.y * room.half.y, u.z * room.half.z};
    out.push_back({at, Vec3f(room.reach * random.on_sphere())});
  }
  return out;
}

template <class Ask>
void ask_all(benchmark::State& state, Ask&& ask) {
  const int place = int(state.range(0));
  World3& world = world_of(place);
  const std::vector<Query> asked = queries(place);
  std::size_t k = 0, found = 0;
  for (auto _ : state) {
    found += ask(world, asked[k]) ? 1 : 0;
    k = (k + 1) % asked.size();
  }
  state.counters["found"] = double(found) / double(state.iterations());
  state.SetLabel(place_names[place]);
}

void BM_RayCast(benchmark::State& state) {
  ask_all(state, [](World3& world, const Query& q) { return world.ray_cast(q.origin, q.translation)->fraction < 1; });
}
void BM_SphereCast(benchmark::State& state) {
  const geometry::Shape3 sphere = geometry::Sphere{0.25f};
  ask_all(state, [&](World3& world, const Query& q) {
    return world.shape_cast(sphere, {q.origin, {}}, q.translation)->fraction < 1;
  });
}
void BM_BoxCast(benchmark::State& state) {
  const geometry::Shape3 box = geometry::Box{{0.25f, 0.25f, 0.25f}};
  ask_all(state, [&](World3& world, const Query& q) {
    return world.shape_cast(box, {q.origin, {}}, q.translation)->fraction < 1;
  });
}
void BM_SphereOverlap(benchmark::State& state) {
  const geometry::Shape3 sphere = geometry::Sphere{0.5f};
  std::vector<rigid::ShapeId> found;
  ask_all(state, [&](World3& world, const Query& q) {
    found.clear();
    world.overlap(sphere, {q.origin, {}}, found).value();
    return !found.empty();
  });
}
void BM_BoundsOverlap(benchmark::State& state) {
  std::vector<rigid::ShapeId> found;
  ask_all(state, [&](World3& world, const Query& q) {
    found.clear();
    const Vec3d half{0.5, 0.5, 0.5};
    world.overlap_bounds({q.origin - half, q.origin + half}, found).value();
    return !found.empty();
  });
}
/// All 1 024 in one call, per query.
void BM_CastRays(benchmark::State& state) {
  const int place = int(state.range(0));
  const World3& world = world_of(place);
  std::vector<rigid::RayQuery<Dim3>> rays;
  for (const Query& q : queries(place)) rays.push_back({q.origin, q.translation});
  std::vector<rigid::RayHit<Dim3>> hits(rays.size());
  for (auto _ : state) world.cast_rays(rays, hits).value();
  state.SetItemsProcessed(std::int64_t(state.iterations()) * std::int64_t(rays.size()));
  state.SetLabel(place_names[place]);
}
/// A mesh of 100 352 triangles with its tree, and what it holds.
void BM_BuildMesh(benchmark::State& state) {
  const auto wave = [](int i, int j) { return 2 * math::sin(0.11 * i) * math::cos(0.07 * j); };
  const geometry::Triangles t = geometry::make_terrain_mesh(224, 224, {1, 1}, wave);
  const double triangles = double(t.indices.size() / 3);
  for (auto _ : state) {
    const auto mesh = geometry::make_triangle_mesh(t.positions, t.indices).value();
    const std::size_t bytes = mesh->vertices.size() * sizeof(Vec3f) + mesh->indices.size() * sizeof(std::uint32_t) +
                              mesh->edge_flags.size() + mesh->tree.bytes();
    state.counters["bytes_a_triangle"] = double(bytes) / triangles;
  }
  state.SetItemsProcessed(std::int64_t(double(state.iterations()) * triangles));
}
BENCHMARK(BM_BuildMesh)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_CastRays)->DenseRange(0, 2);
BENCHMARK(BM_RayCast)->DenseRange(0, 2);
BENCHMARK(BM_SphereCast)->DenseRange(0, 2);
BENCHMARK(BM_BoxCast)->DenseRange(0, 2);
BENCHMARK(BM_SphereOverlap)->DenseRange(0, 2);
BENCHMARK(BM_BoundsOverlap)->DenseRange(0, 2);

void BM_CreateAndDestroyBody(benchmark::State& state) {
  World3 world = sleeping_boxes(int(state.range(0)));
  math::Random random(3);
  for (auto _ : state) {
    const Vec3d at{random.uniform(0.0, 200.0), random.uniform(0.0, 200.0), -10};
    const BodyId body = add_body<Dim3>(world, {.position = at, .awake = false}, geometry::Sphere{0.25f}, {});
    world.destroy_body(body).value();
  }
  state.SetComplexityN(state.range(0));
}
void BM_MoveBody(benchmark::State& state) {
  World3 world = sleeping_boxes(int(state.range(0)));
  const BodyId body =
      add_body<Dim3>(world, {.type = BodyType::fixed, .position = {0, 0, -10}}, geometry::Sphere{0.25f}, {});
  math::Random random(3);
  for (auto _ : state) world.set_pose(body, {random.uniform(0.0, 200.0), random.uniform(0.0, 200.0), -10}, {}).value();
  state.SetComplexityN(state.range(0));
}
BENCHMARK(BM_CreateAndDestroyBody)->Arg(1000)->Arg(10000)->Arg(100000)->Complexity(benchmark::oLogN);
BENCHMARK(BM_MoveBody)->Arg(1000)->Arg(10000)->Arg(100000)->Complexity(benchmark::oLogN);

/// One step of 1 000 boxes that never rest, far from n that sleep.
void BM_StepBesideSleepers(benchmark::State& state) {
  World3 world = sleeping_boxes(int(state.range(0)));
  for (int i = 0; i < 1000; ++i)
    add_body<Dim3>(world,
                   {.position = {2.0 * (i % 10), 2.0 * (i / 10 % 10), -100 - 2.0 * (i / 100)},
                    .angular_velocity = {0.1f, 0.2f, 0},
                    .sleep_speed = 0},
                   geometry::Box{{0.5f, 0.5f, 0.5f}}, {});
  for (int i = 0; i < 3; ++i) world.step(1.0f / 60.0f).value();  // the first looks for everyone's pairs
  for (auto _ : state) world.step(1.0f / 60.0f).value();
}
BENCHMARK(BM_StepBesideSleepers)->Arg(0)->Arg(100000)->Unit(benchmark::kMicrosecond);

}  // namespace
