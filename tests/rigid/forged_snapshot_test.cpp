// A snapshot that came as bytes is either the state of a world or refused: whatever was done to it, with checksums that
// are right, the world that restores it steps, lets all of its things be destroyed, and reads no memory but its own
// (the sanitizers' builds watch that).
#include "tests/rigid/forged_snapshot.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>

#include "tests/rigid/furnished_world.h"

namespace carom::rigid::test {
namespace {

template <class D>
class ForgedSnapshotOf : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(ForgedSnapshotOf, Dimensions);

/// The furnished world, with a path, a bouncing ball and sleepers besides.
template <class D>
void furnish_fully(World<D>& world) {
  furnish(world);
  const std::vector<typename D::Vector> points{along<D>(0, 0), along<D>(2, 1), along<D>(4, 0)};
  PathJointDef<D> path;
  path.body_b = add_ball(world, at<D>(20, 3), 0.2f);
  path.frame_a.p = along<D>(20, 3);
  path.points = points;
  path.break_force = 1e6f;
  world.create_joint(path).value();
  add_ball<D>(world, at<D>(25, 4), 0.3f, {0.5f, 0.9f, 1000, 0.01f, 0});
  for (int i = 0; i < 3; ++i) add_box<D>(world, at<D>(30, 0.5 + i));
  GenericJointDef<D> generic;
  generic.body_b = add_box<D>(world, at<D>(35, 0.5));
  generic.frame_a.p = along<D>(35, 0.5f);
  generic.linear[0].free = true;
  world.create_joint(generic).value();
  BodyDef<D> slow;
  slow.position = at<D>(40, 2);
  slow.time_scale = 0.5f;
  slow.substeps = 8;
  slow.name = "slow";
  slow.user_data = 7;
  const BodyId body = world.create_body(slow).value();
  ShapeDef<D> special;
  special.one_way = along<D>(0, 1);
  special.surface_velocity = along<D>(1, 0);
  special.hit_events = true;
  world.add_shape(body, box_shape<D>(0.5f, 0.5f, 0.5f), special).value();
  const PairRule rule{0.1f, 0.2f, 0.3f, 0};
  ASSERT_TRUE(world.set_pair_rule(0, 1, &rule).ok());
  const BodyId gone = add_box<D>(world, at<D>(-30, 3));
  run(world, 200);  // some are asleep
  ASSERT_TRUE(world.destroy_body(gone).ok());
  add_ball<D>(world, at<D>(0, 9), 0.4f);
  run(world, 20);
}

template <class D>
void use_up(World<D>& world) {
  for (int i = 0; i < 6; ++i) (void)world.step(frame);
  std::vector<ShapeId> found;
  (void)world.overlap_bounds({at<D>(-5, -5), at<D>(5, 5, 1)}, found);
  (void)world.ray_cast(at<D>(-50, 0.4), along<D>(100, 0));
  std::vector<BodyId> bodies;
  world.bodies(bodies);
  for (const BodyId body : bodies) (void)world.destroy_body(body);
  (void)world.step(frame);
}

TYPED_TEST(ForgedSnapshotOf, IsRefusedOrTheStateOfAWorld) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  furnish_fully(world);
  ASSERT_GT(world.counters().bodies - world.counters().awake_bodies, 2);
  const Snapshot<D> sound = world.snapshot();
  std::uint32_t r = 7;
  const auto draw = [&] {
    r = 1664525u * r + 1013904223u;
    return r >> 8 ^ r << 24;
  };
  const auto whole = Snapshot<D>::decode(sound.encode());
  ASSERT_TRUE(whole.ok());
  const Status restored = world.restore(*whole);
  ASSERT_TRUE(restored.ok()) << restored.error().message;
  const std::uint64_t hash = world.state_hash();
  const char* const wanted = std::getenv("CAROM_FORGERIES");
  const int forgeries = wanted != nullptr ? std::atoi(wanted) : 200;
  int refused = 0, unlike = 0;
  for (int i = 0; i < forgeries; ++i) {
    Snapshot<D> forged = sound;
    for (std::uint32_t k = draw() % 3; k <= 2; ++k) forge(forged, draw);
    const auto decoded = Snapshot<D>::decode(forged.encode());
    const Status status = decoded.ok() ? world.restore(*decoded) : Status(decoded.error());
    if (!status.ok()) {
      ++refused;
      const char* const who = decoded.ok() ? "World::restore: the snapshot" : "Snapshot::decode: the contacts";
      ASSERT_EQ(status.error().message.find(who), 0u) << status.error().message;
      if (i % 50 == 0) ASSERT_EQ(world.state_hash(), hash) << "a refused snapshot leaves the world as it was";
      continue;
    }
    ++unlike;
    use_up(world);
    ASSERT_TRUE(world.restore(sound).ok());
  }
  EXPECT_GT(6 * refused, forgeries);
  EXPECT_GT(30 * unlike, forgeries);  // a velocity, a colour of user data: what is a state all the same
}

/// The last eight bytes of a snapshot's.
void sign(std::vector<std::byte>& bytes) {
  const std::size_t size = bytes.size() - 8;
  std::vector<std::uint64_t> words((size + 7) / 8);
  std::memcpy(words.data(), bytes.data(), size);
  words.push_back(size);
  const std::uint64_t sum = detail::hash_words(words);
  for (std::size_t i = 0; i < 8; ++i) bytes[size + i] = std::byte(std::uint8_t(sum >> (8 * i)));
}

// What is foreseen of a forged state, or by a forged base, may be nonsense, but both ends foresee the same; and bytes
// that no state has are refused.
TYPED_TEST(ForgedSnapshotOf, DifferencesAreReadAsTheyWereWritten) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  furnish_fully(world);
  add_heap(world, 2);
  run(world, 40);
  const Snapshot<D> base = world.snapshot();
  run(world, 1);
  const Snapshot<D> later = world.snapshot();
  const std::vector<std::byte> sound = later.encode(base);
  ASSERT_TRUE(Snapshot<D>::decode(sound, base).ok());
  std::uint32_t r = 11;
  const auto draw = [&] {
    r = 1664525u * r + 1013904223u;
    return r >> 8 ^ r << 24;
  };
  const char* const wanted = std::getenv("CAROM_FORGERIES");
  const int forgeries = wanted != nullptr ? std::atoi(wanted) : 100;
  for (int i = 0; i < forgeries; ++i) {
    Snapshot<D> from = base, to = later;
    for (int k = 0; k < 20; ++k) forge(i % 2 == 0 ? from : to, draw);
    const auto decoded = Snapshot<D>::decode(to.encode(from), from);
    if (decoded.ok())
      EXPECT_EQ(decoded->digest(), to.digest());
    else
      EXPECT_EQ(decoded.error().message.find("Snapshot::decode: the contacts"), 0u) << decoded.error().message;
    std::vector<std::byte> bytes = sound;
    bytes[32 + draw() % (bytes.size() - 40)] ^= std::byte(std::uint8_t(1 + draw() % 255));
    sign(bytes);
    const auto broken = Snapshot<D>::decode(bytes, base);
    EXPECT_TRUE(!broken.ok() || broken->digest() == later.digest());
  }
}

// The message says what is wrong, and where.
TYPED_TEST(ForgedSnapshotOf, IsToldByWhatAndWhere) {
  using D = TypeParam;
  World<D> world(world_with<D>());
  add_ground(world);
  add_box<D>(world, at<D>(0, 0.5));
  run(world, 5);
  Snapshot<D> snapshot = world.snapshot();
  detail::SnapshotData<D>& data = detail::SnapshotAccess::data(snapshot);
  auto* const record = detail::section_values<detail::BodyRecord>(data.image, data, data.bodies_at + 3);
  record[1].first_shape = 12345;
  const auto decoded = Snapshot<D>::decode(snapshot.encode());
  ASSERT_TRUE(decoded.ok()) << decoded.error().message;
  const Status status = world.restore(*decoded);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(
      status.error().message,
      "World::restore: the snapshot is corrupt: body #2: its list of shapes names 12345, which is not its own, or "
      "goes in a circle");
}

}  // namespace
}  // namespace carom::rigid::test
