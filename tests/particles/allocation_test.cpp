// A warm step allocates nothing.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "carom/particles/cloth.h"
#include "carom/particles/coupling.h"
#include "carom/particles/fluid.h"
#include "carom/particles/granular.h"
#include "carom/particles/rope.h"
#include "carom/particles/soft_body.h"
#include "carom/particles/soft_group.h"

namespace particles_allocation_test {
std::atomic<long> allocations{0};
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  ++particles_allocation_test::allocations;
  if (void* p = std::malloc(size)) return p;
  std::abort();
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  ++particles_allocation_test::allocations;
  const std::size_t a = std::size_t(alignment);
  if (void* p = std::aligned_alloc(a, (size + a - 1) / a * a)) return p;
  std::abort();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::align_val_t) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t, std::align_val_t) noexcept { std::free(p); }

namespace particles_allocation_test {
using namespace carom;
using namespace carom::particles;

TEST(ParticleAllocation, NoneInAWarmStep) {
  for (const bool grains : {false, true}) {
    SystemDef d;
    d.capacity = 2000;
    d.radius = 0.03f;
    d.report_deaths = d.report_hits = true;
    d.contacts.enabled = grains;
    ParticleSystem s = ParticleSystem::create(d).value();
    rigid::World3 world;
    rigid::BodyDef<rigid::Dim3> body;
    body.type = rigid::BodyType::fixed;
    ASSERT_TRUE(world.add_shape(world.create_body(body).value(), geometry::Plane{}).ok());
    body.type = rigid::BodyType::dynamic;
    body.position = {0, 2, 0};
    ASSERT_TRUE(world.add_shape(world.create_body(body).value(), geometry::Box{}).ok());
    ASSERT_TRUE(s.set_air({.turbulence = {.speed = 1}}).ok());
    ASSERT_TRUE(
        s.add_emitter({.form = EmitterForm::sphere, .position = {0, 4, 0}, .rate = 600, .lifetime = {1, 2}}).ok());
    Coupling3 coupling({.two_way = true});
    const auto step = [&](int steps) {
      for (int i = 0; i < steps; ++i) {
        ASSERT_TRUE(world.step(1.0f / 60).ok());
        ASSERT_TRUE(coupling.step(world, s, 1.0 / 60).ok());
      }
    };
    step(400);
    const long before = allocations;
    step(60);
    EXPECT_EQ(allocations - before, 0) << (grains ? "grains" : "particles");
    EXPECT_GT(s.size(), 500);
  }
}

/// A floor and a box that falls among whatever is there; counts what `step` allocates once it is warm.
template <class D, class Step>
long allocations_among_bodies(int warm, const Step& step) {
  rigid::World<D> world;
  rigid::BodyDef<D> def;
  def.type = rigid::BodyType::fixed;
  const auto floor = world.create_body(def).value();
  def.type = rigid::BodyType::dynamic;
  def.position.x = 0.5;
  def.position.y = 0.9;
  if constexpr (D::dimension == 3) {
    def.position.z = 0.5;
    world.add_shape(floor, geometry::Plane{}).value();
    world.add_shape(world.create_body(def).value(), geometry::Box{{.15f, .15f, .15f}}, {.density = 300}).value();
  } else {
    world.add_shape(floor, geometry::make_box2({5, .01f})).value();
    world.add_shape(world.create_body(def).value(), geometry::make_box2({.15f, .15f}), {.density = 300}).value();
  }
  const auto run = [&](int steps) {
    for (int i = 0; i < steps; ++i) {
      EXPECT_TRUE(step(world).ok());
      EXPECT_TRUE(world.step(1.0f / 60).ok());
    }
  };
  run(warm);
  const long before = allocations;
  run(60);
  return allocations - before;
}

template <class D>
void liquids_and_grains_allocate_nothing() {
  typename D::Position half = FluidDef<D>::unit_position();
  half.y = 0.5;
  auto fluid = Fluid<D>::create({.spacing = .05f}).value();
  fluid.add_box({}, half).value();
  EXPECT_EQ(allocations_among_bodies<D>(30, [&](rigid::World<D>& w) { return fluid.step(w, 1.0f / 60); }), 0);
  auto grains = Granular<D>::create({.radius = .04f}).value();
  grains.add_box({}, half).value();
  EXPECT_EQ(allocations_among_bodies<D>(120, [&](rigid::World<D>& w) { return grains.step(w, 1.0f / 60); }), 0);
}
TEST(ParticleAllocation, NoneInAWarmStepOfLiquidsAndGrains) {
  liquids_and_grains_allocate_nothing<rigid::Dim2>();
  liquids_and_grains_allocate_nothing<rigid::Dim3>();
}

TEST(ParticleAllocation, NoneInAWarmStepOfRopes) {
  RopeSet ropes;
  const math::Vec3d points[] = {{-1, 1.2, .5}, {.5, 1.0, .5}, {2, 1.2, .5}};
  const int rope = ropes.add({.points = points, .segments = 40}).value();
  rigid::World3 none;
  ropes.attach(rope, {.node = 0, .point = points[0]}, none).value();
  ropes.attach(rope, {.node = -1, .point = points[2]}, none).value();
  EXPECT_EQ(allocations_among_bodies<rigid::Dim3>(200, [&](rigid::World3& w) { return ropes.step(w, 1.0 / 60); }), 0);
}

TEST(ParticleAllocation, NoneInAWarmStepOfClothAndSoftBodies) {
  const ClothSheet sheet = make_cloth_sheet({0, 1.3, 0}, {1, 0, 0}, {0, 0, 1}, 11, 11);
  auto cloth = Cloth::make({.points = sheet.points, .triangles = sheet.triangles}).value();
  EXPECT_EQ(allocations_among_bodies<rigid::Dim3>(240, [&](rigid::World3& w) { return cloth.step(w, 1.0 / 60); }), 0);
  const SoftMesh mesh = make_soft_box({.3, .02, .3}, {.4, .4, .4}, 3, 3, 3);
  auto soft = SoftBody::make({.points = mesh.points, .tetrahedra = mesh.tetrahedra}).value();
  EXPECT_EQ(allocations_among_bodies<rigid::Dim3>(240, [&](rigid::World3& w) { return soft.step(w, 1.0 / 60); }), 0);
  const SoftMesh beside = make_soft_box({.4, .5, .35}, {.3, .3, .3}, 3, 3, 3);
  auto second = SoftBody::make({.points = beside.points, .tetrahedra = beside.tetrahedra}).value();
  Cloth* const cloths[] = {&cloth};
  SoftBody* const bodies[] = {&soft, &second};
  SoftGroup group;
  EXPECT_EQ(allocations_among_bodies<rigid::Dim3>(
                360, [&](rigid::World3& w) { return group.step(cloths, bodies, w, 1.0 / 60); }),
            0);
}

}  // namespace particles_allocation_test
