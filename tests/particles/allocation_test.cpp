// A warm step allocates nothing.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

#include "carom/particles/coupling.h"

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

}  // namespace particles_allocation_test
