// The same bits for any number of threads and any width.
#include <gtest/gtest.h>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
std::uint64_t heap_hash(int threads, int width, bool sleep) {
  WorldDef<D> d = world_with<D>();
  d.threads = threads;
  d.simd_width = width;
  d.allow_sleep = sleep;
  World<D> world(d);
  add_ground(world);
  add_heap(world, D::dimension == 2 ? 40 : 12);
  if constexpr (D::dimension == 3) add_pyramid(world, 6, 8);
  run(world, 150);
  return world.state_hash();
}

template <class D>
class WorldDeterminism : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(WorldDeterminism, Dimensions);

TYPED_TEST(WorldDeterminism, ThreadsDoNotMatter) {
  using D = TypeParam;
  const std::uint64_t one = heap_hash<D>(1, 0, true);
  EXPECT_EQ(heap_hash<D>(2, 0, true), one);
  EXPECT_EQ(heap_hash<D>(4, 0, true), one);
}
/// One body under more contacts than there are colours: all the others share it.
template <class D>
std::uint64_t loaded_plate_hash(int threads) {
  WorldDef<D> d = world_with<D>();
  d.threads = threads;
  World<D> world(d);
  add_ground(world);
  const double half = D::dimension == 2 ? 60 : 8;
  add_body<D>(world, BodyType::dynamic, box_shape<D>(float(half), 0.25f, float(half)), at<D>(0, 0.25));
  const int along = D::dimension == 2 ? 150 : 20, rows = D::dimension == 2 ? 1 : 20;
  for (int i = 0; i < along; ++i)
    for (int k = 0; k < rows; ++k)
      add_box<D>(world, at<D>(0.75 * (i - 0.5 * along), 0.8 + 0.05 * ((i + k) % 7), 0.75 * (k - 0.5 * rows)), 0.25f,
                 {0.4f, 0, float(100 + 37 * (i % 11)), 0});
  run(world, 120);
  return world.state_hash();
}
TYPED_TEST(WorldDeterminism, ThreadsDoNotMatterWhereAllTouchOneBody) {
  using D = TypeParam;
  const std::uint64_t one = loaded_plate_hash<D>(1);
  for (int i = 0; i < 3; ++i)
    for (const int threads : {2, 4}) EXPECT_EQ(loaded_plate_hash<D>(threads), one) << threads << " threads";
}
TYPED_TEST(WorldDeterminism, WidthsDoNotMatter) {
  using D = TypeParam;
  const std::uint64_t four = heap_hash<D>(1, 4, false);
  EXPECT_EQ(heap_hash<D>(1, 8, false), four);
  EXPECT_EQ(heap_hash<D>(2, 16, false), four);
}
/// A world in which there comes to be so much to solve that it takes more lanes (choose_kernels), and then less again.
template <class D>
std::pair<std::uint64_t, std::uint64_t> growing_wall_hash(int threads, int width) {
  WorldDef<D> d = world_with<D>();
  d.threads = threads;
  d.simd_width = width;
  World<D> world(d);
  add_ground(world);
  const int along = D::dimension == 2 ? 420 : 70;
  std::vector<BodyId> bodies;
  for (int layer = 0; layer < 12; ++layer) {
    for (int i = 0; i < along; ++i)
      bodies.push_back(add_box<D>(world, at<D>(0.51 * (i - 0.5 * along), 0.26 + 0.52 * layer), 0.25f));
    run(world, 2);
  }
  run(world, 20);
  for (std::size_t i = 0; i < bodies.size(); i += 2) world.destroy_body(bodies[i]).value();
  run(world, 10);
  return {world.state_hash(), world.snapshot().digest()};
}
TYPED_TEST(WorldDeterminism, WidthsDoNotMatterWhereTheWorkGrows) {
  using D = TypeParam;
  const auto eight = growing_wall_hash<D>(1, 8);
  EXPECT_EQ(growing_wall_hash<D>(1, 16), eight);
  EXPECT_EQ(growing_wall_hash<D>(1, 0), eight);
  EXPECT_EQ(growing_wall_hash<D>(2, 0), eight);
}
TYPED_TEST(WorldDeterminism, ARunRepeatsInTheSameProcess) {
  using D = TypeParam;
  EXPECT_EQ(heap_hash<D>(1, 0, true), heap_hash<D>(1, 0, true));
}
TYPED_TEST(WorldDeterminism, HashSeesTheSmallestDifference) {
  using D = TypeParam;
  World<D> a(world_with<D>()), b(world_with<D>());
  add_ball<D>(a, at<D>(0, 1), 0.5f);
  add_ball<D>(b, at<D>(0, 1 + 1e-15), 0.5f);
  EXPECT_NE(a.state_hash(), b.state_hash());
}

}  // namespace
}  // namespace carom::rigid::test
