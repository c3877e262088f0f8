// A warm step takes no memory from the system: every operator new, delete and, under glibc, malloc is counted.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "carom/environment/environment.h"
#include "carom/rigid/character.h"
#include "tests/rigid/scene_pieces.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define CAROM_COUNTS_ALLOCATIONS 0  // the sanitizers bring their own
#elif defined(__GLIBC__)
#define CAROM_COUNTS_ALLOCATIONS 1
#else
#define CAROM_COUNTS_ALLOCATIONS 0
#endif

#if CAROM_COUNTS_ALLOCATIONS
namespace {
std::atomic<bool> counting{false};
std::atomic<long> allocations{0}, releases{0};
void note(std::atomic<long>& counter) {
  if (counting.load(std::memory_order_relaxed)) counter.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

// All of operator new and delete ends in these.
extern "C" {
void* __libc_malloc(std::size_t);
void* __libc_calloc(std::size_t, std::size_t);
void* __libc_realloc(void*, std::size_t);
void* __libc_memalign(std::size_t, std::size_t);
void __libc_free(void*);
void* malloc(std::size_t size) {
  note(allocations);
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  note(allocations);
  return __libc_calloc(count, size);
}
void* realloc(void* old, std::size_t size) {
  note(allocations);
  return __libc_realloc(old, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  note(allocations);
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) noexcept {  // as the C library has it
  note(allocations);
  *out = __libc_memalign(alignment, size);
  return *out != nullptr ? 0 : 12;
}
void free(void* p) {
  if (p != nullptr) note(releases);
  __libc_free(p);
}
}

namespace carom::rigid::test {
namespace {

/// Calls of the allocator, of either kind, while `f` ran.
template <class F>
long allocator_calls(F&& f) {
  allocations = releases = 0;
  counting = true;
  f();
  counting = false;
  return allocations + releases;
}

template <class D>
WorldDef<D> warm_definition(int threads, bool sleep = false) {
  WorldDef<D> d = world_with<D>();
  d.threads = threads;
  d.allow_sleep = sleep;
  return d;
}

/// Steps until warm, then counts.
template <class D, class Each>
long calls_in_warm_steps(World<D>& world, int warm_up, int steps, Each&& each) {
  int frame_number = 0;
  for (int i = 0; i < warm_up; ++i) {
    each(frame_number++);
    world.step(frame).value();
  }
  return allocator_calls([&] {
    for (int i = 0; i < steps; ++i) {
      each(frame_number++);
      world.step(frame).value();
    }
  });
}
const auto nothing = [](int) {};

TEST(Allocation, TheCounterCounts) {
  EXPECT_GT(allocator_calls([] { std::vector<int> v(100); }), 1);
  EXPECT_GT(allocator_calls([] { std::free(std::malloc(10)); }), 1);
  EXPECT_EQ(allocator_calls([] {}), 0);
}

template <class D>
class WarmStep : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(WarmStep, Dimensions);

TYPED_TEST(WarmStep, OfAPyramid) {
  for (const int threads : {1, 2}) {
    World<TypeParam> world(warm_definition<TypeParam>(threads));
    add_ground(world);
    add_pyramid(world, 12);
    EXPECT_EQ(calls_in_warm_steps(world, 60, 120, nothing), 0) << threads << " threads";
  }
}

TYPED_TEST(WarmStep, OfACharacterThatWalksAmongBoxes) {
  using D = TypeParam;
  World<D> world(warm_definition<D>(1));
  add_ground(world);
  for (int i = 0; i < 20; ++i) add_box<D>(world, at<D>(3 + 2 * (i % 10), 0.5 + i / 10));
  auto walker = Character<D>::create(world, {}, at<D>(0, 0)).value();
  EXPECT_EQ(calls_in_warm_steps(world, 200, 120,
                                [&](int k) {
                                  const float way = (k / 50) % 2 == 0 ? 3.0f : -3.0f;
                                  walker.move(world, along<D>(way, 0), frame).value();
                                }),
            0);
}

TYPED_TEST(WarmStep, OfAHeapAtRest) {
  for (const int threads : {1, 2}) {
    World<TypeParam> world(warm_definition<TypeParam>(threads));
    add_ground(world);
    add_heap(world, 12);
    EXPECT_EQ(calls_in_warm_steps(world, 400, 120, nothing), 0) << threads << " threads";
  }
}

// A paddle turns in a tub: contacts and manifolds come and go, trees are rebuilt, but never for more than there was.
TYPED_TEST(WarmStep, OfAHeapThatIsStirred) {
  using D = TypeParam;
  for (const int threads : {1, 2}) {
    World<D> world(warm_definition<D>(threads));
    ASSERT_TRUE(world.reserve({200, 200, 2000, 0}).ok());
    add_ground(world);
    for (const double side : {-4.0, 4.0}) {
      add_body<D>(world, BodyType::fixed, box_shape<D>(0.5f, 20, 5), at<D>(side, 20));
      if constexpr (D::dimension == 3)
        add_body<D>(world, BodyType::fixed, box_shape<D>(5, 20, 0.5f), at<D>(0, 20, side));
    }
    add_heap(world, 10);
    const BodyId paddle = add_body<D>(world, BodyType::kinematic, box_shape<D>(1.5f, 0.2f, 0.4f), at<D>(0, 1.6));
    typename D::Angular turning{};
    if constexpr (D::dimension == 2)
      turning = 3;
    else
      turning = {0, 1, 3};
    ASSERT_TRUE(world.set_velocity(paddle, {}, turning).ok());
    EXPECT_EQ(calls_in_warm_steps(world, 900, 300, nothing), 0) << threads << " threads";
    EXPECT_GT(world.counters().awake_bodies, 20);
  }
}

TYPED_TEST(WarmStep, OfJoints) {
  using D = TypeParam;
  World<D> world(warm_definition<D>(2));
  const BodyId post = add_body<D>(world, BodyType::fixed, box_shape<D>(0.1f, 0.1f, 0.1f), at<D>(0, 10));
  const auto offset = [](auto& d, BodyId a, BodyId b) {
    d.body_a = a;
    d.body_b = b;
    d.frame_a.p = along<D>(0.5f, 0);
    d.frame_b.p = along<D>(-0.5f, 0);
  };
  BodyId last = post;
  for (int i = 0; i < 30; ++i) {
    const BodyId link = add_box<D>(world, at<D>(1.0 + i, 10), 0.2f);
    if (i % 4 == 0) {
      BallJointDef<D> d;
      offset(d, last, link);
      world.create_joint(d).value();
    } else if (i % 4 == 1) {
      HingeJointDef<D> d;
      offset(d, last, link);
      d.limit = {true, -1, 1};
      d.motor = {true, 1, 10};
      world.create_joint(d).value();
    } else if (i % 4 == 2) {
      WeldJointDef<D> d;
      offset(d, last, link);
      d.angular = {4, 0.5f};
      world.create_joint(d).value();
    } else {
      DistanceJointDef<D> d;
      offset(d, last, link);
      d.length = 0.2f;
      d.spring = {3, 0.3f};
      d.limit = {true, 0, 0.5f};
      world.create_joint(d).value();
    }
    last = link;
  }
  EXPECT_EQ(calls_in_warm_steps(world, 200, 200, nothing), 0);
}

TYPED_TEST(WarmStep, OfEffectorsSensorsAndEvents) {
  using D = TypeParam;
  World<D> world(warm_definition<D>(1));
  ASSERT_TRUE(world.reserve({100, 200, 2000, 0}).ok());
  add_ground(world);
  std::vector<BodyId> bodies = add_heap(world, 4);
  const BodyId gate = world.create_body({.type = BodyType::fixed, .position = at<D>(0, 2)}).value();
  ShapeDef<D> s;
  s.sensor = true;
  world.add_shape(gate, box_shape<D>(3, 0.5f, 3), s).value();
  for (const BodyId body : bodies) {
    ShapeDef<D> bell;
    bell.hit_events = true;
    bell.material.restitution = 0.5f;
    world.add_shape(body, ball_shape<D>(0.5f), bell).value();
  }
  world.add_effector(Wind<D>{along<D>(2, 0)}).value();
  LinearDrag<D> drag;
  drag.coefficient = 10;
  world.add_effector(drag).value();
  QuadraticDrag<D> air;
  air.area = 0.5;
  world.add_effector(air).value();
  Buoyancy<D> water;
  water.level = 1;
  world.add_effector(water).value();
  VortexField<D> vortex;
  world.add_effector(vortex).value();
  RadialField<D> field;
  field.center = at<D>(0, 5);
  world.add_effector(field).value();
  environment::Environment::Definition around;
  around.wind.turbulence = environment::Turbulence::make({}).value();
  around.water = environment::Sea::make({.level = 1}, environment::SeaDef{}).value();
  around.frame.rate = {0, 0, 0.01};
  const auto shared =
      std::make_shared<const environment::Environment>(environment::Environment::make(std::move(around)).value());
  world.add_effector(Surroundings<D>{shared}).value();
  Buoyancy<D> carried;
  carried.added_mass = along<D>(0.5f, 0.5f);
  world.add_effector(carried).value();
  BodyDrag<D> curve;
  curve.law.kind = forces::DragLaw::Kind::by_mach;
  curve.law.table = forces::CoefficientTable(std::vector<forces::CoefficientPoint>{{0, 0.2}, {0.9, 0.3}, {1.1, 0.6}});
  world.add_effector(curve).value();
  world.add_effector(MagnusLift<D>{}).value();
  LiftingSurface<D> wing;
  wing.body = bodies[0];
  world.add_effector(wing).value();
  CylinderDrag<D> pole;
  pole.body = bodies[1];
  world.add_effector(pole).value();
  ElectromagneticField<D> charged;
  charged.charge = 0.1;
  charged.magnetic = {0, 0, 1};
  world.add_effector(charged).value();
  CustomEffector<D> custom;
  custom.model = [](const EffectorInput<D>& in) {
    Wrench<D> w;
    w.force = along<D>(0, float(in.time) - float(in.time));
    return w;
  };
  world.add_effector(custom).value();
  // Hops of all bodies, again and again: begin, end, hit and sensor events in most steps.
  std::size_t seen = 0;
  const auto hop = [&](int i) {
    const Events<D> e = world.events();
    seen += e.contact_begin.size() + e.contact_end.size() + e.contact_hit.size() + e.sensor_begin.size();
    if (i % 40 == 0)
      for (const BodyId body : bodies) (void)world.set_velocity(body, along<D>(0, 4), {});
  };
  EXPECT_EQ(calls_in_warm_steps(world, 800, 240, hop), 0);
  EXPECT_GT(seen, 100u);
}

// With room made beforehand nothing is allocated from the first step on, through falling asleep and waking.
TYPED_TEST(WarmStep, WithRoomMadeBeforehand) {
  using D = TypeParam;
  World<D> world(warm_definition<D>(2, true));
  ASSERT_TRUE(world.reserve({300, 300, 3000, 0}).ok());
  add_ground(world);
  const std::vector<BodyId> boxes = add_pyramid(world, 8);
  std::size_t fell_asleep = 0;
  EXPECT_EQ(calls_in_warm_steps(world, 0, 600,
                                [&](int i) {
                                  fell_asleep += world.events().fell_asleep.size();
                                  if (i % 200 == 199) (void)world.add_impulse(boxes[0], along<D>(1, 0));
                                }),
            0);
  EXPECT_GE(fell_asleep, 2 * boxes.size());
  EXPECT_FALSE(world.reserve({-1, 0, 0, 0}).ok());
}

TYPED_TEST(WarmStep, TakingAndRestoringSnapshots) {
  using D = TypeParam;
  World<D> world(warm_definition<D>(1));
  add_ground(world);
  const std::vector<BodyId> bodies = add_heap(world, 4);
  Snapshot<D> ring[4];
  const auto roll_back = [&](int i) {
    if (i % 8 == 7) ASSERT_TRUE(world.restore(ring[std::size_t(i / 8) % 4]).ok());
    world.snapshot(ring[std::size_t(i / 8) % 4]);
    (void)world.add_impulse(bodies[3], along<D>(0, 100));
  };
  EXPECT_EQ(calls_in_warm_steps(world, 1000, 100, roll_back), 0);
}

// Forces, impulses, velocities and queries that find nothing cost no memory either.
TYPED_TEST(WarmStep, WithInputOfEveryKind) {
  using D = TypeParam;
  World<D> world(warm_definition<D>(1));
  add_ground(world);
  const std::vector<BodyId> bodies = add_heap(world, 3);
  std::vector<ShapeId> found;
  found.reserve(100);
  const auto push = [&](int i) {
    const BodyId body = bodies[std::size_t(i) % bodies.size()];
    (void)world.add_force(body, along<D>(100, 0));
    (void)world.add_impulse(body, along<D>(0, 10));
    (void)world.add_torque(body, typename D::Angular{});
    (void)world.set_awake(body, true);
    (void)world.ray_cast(at<D>(-10, 1), along<D>(20, 0));
    (void)world.overlap(ball_shape<D>(1), {at<D>(0, 1), {}}, found);
  };
  // What is thrown about has its most contacts late.
  EXPECT_EQ(calls_in_warm_steps(world, 1000, 200, push), 0);
}

}  // namespace
}  // namespace carom::rigid::test
#endif
