// Rollback as games with prediction do it: inputs come late and out of order, the world goes back to the frame that
// they belong to and is simulated again. It must end where a world ends that had them all in time.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/rigid/scene_pieces.h"

namespace carom::rigid::test {
namespace {

template <class D>
class Rollback : public testing::Test {};
using Dimensions = testing::Types<Dim2, Dim3>;
TYPED_TEST_SUITE(Rollback, Dimensions);

struct Input {
  int frame = 0, arrival = 0;
  std::uint32_t kind = 0, pick = 0;
  float x = 0, y = 0;
};

std::uint32_t draw(std::uint32_t& r) {
  r = 1664525u * r + 1013904223u;
  return r >> 8;
}
std::vector<Input> random_inputs(std::uint32_t seed, int frames) {
  std::vector<Input> inputs;
  for (int f = 0; f < frames; ++f) {
    const int count = int(draw(seed) % 3);
    for (int i = 0; i < count; ++i) {
      Input input;
      input.frame = f;
      input.arrival = f + int(draw(seed) % 9);  // up to eight frames late
      input.kind = draw(seed) % 9;
      input.pick = draw(seed);
      input.x = float(draw(seed) % 200) / 100 - 1;
      input.y = float(draw(seed) % 200) / 100;
      inputs.push_back(input);
    }
  }
  return inputs;
}

/// What a player does in a frame. Bodies are picked from what there is, as a game would by its own table.
template <class D>
void play(World<D>& world, const Input& in) {
  std::vector<BodyId> bodies;
  world.bodies(bodies);
  const BodyId body = bodies[1 + in.pick % (bodies.size() - 1)];  // not the ground
  std::vector<JointId> joints;
  switch (in.kind) {
    case 0:
    case 1:
      (void)world.add_impulse(body, along<D>(800 * in.x, 800 * in.y));
      break;
    case 2:
      (void)world.add_force(body, along<D>(20000 * in.x, 9000 * in.y));
      break;
    case 3:
      (void)world.set_velocity(body, along<D>(5 * in.x, 5 * in.y), {});
      break;
    case 4:
      if (bodies.size() < 60) {
        BodyDef<D> d;
        d.position = at<D>(3 * double(in.x), 6 + double(in.y));
        const BodyId made = world.create_body(d).value();
        world.add_shape(made, in.pick % 2 == 0 ? ball_shape<D>(0.3f) : box_shape<D>(0.3f, 0.2f, 0.4f)).value();
      }
      break;
    case 5:
      if (bodies.size() > 15) (void)world.destroy_body(body);
      break;
    case 6: {
      BallJointDef<D> d;
      d.body_a = body;
      d.body_b = bodies[1 + (in.pick / 7) % (bodies.size() - 1)];
      d.frame_a.p = along<D>(0.4f, 0);
      d.frame_b.p = along<D>(-0.4f, 0);
      (void)world.create_joint(d);
      break;
    }
    case 7:
      world.joints(joints);
      if (!joints.empty()) (void)world.destroy_joint(joints[in.pick % joints.size()]);
      break;
    default:
      (void)world.explode({.center = at<D>(double(in.x), 0), .radius = 2, .impulse_per_area = 300});
  }
}

template <class D>
void furnish_court(World<D>& world) {
  add_ground(world);
  add_heap(world, D::dimension == 2 ? 6 : 2);
  add_pyramid(world, 4, 6);
}

TYPED_TEST(Rollback, LatePacketsEndWhereTheStraightRunEnds) {
  using D = TypeParam;
  const int frames = 240, history = 10;
  for (const std::uint32_t seed : {1u, 2u, 3u, 4u}) {
    const std::vector<Input> inputs = random_inputs(seed, frames);
    const auto play_frame = [&](World<D>& world, int f, int now) {
      for (const Input& in : inputs)
        if (in.frame == f && in.arrival <= now) play(world, in);
      world.step(frame).value();
    };
    World<D> straight(world_with<D>());
    furnish_court(straight);
    std::vector<std::uint64_t> hashes;
    for (int f = 0; f < frames; ++f) {
      play_frame(straight, f, frames + 100);
      hashes.push_back(straight.state_hash());
    }

    WorldDef<D> d = world_with<D>();
    d.threads = 2;
    World<D> world(d);
    furnish_court(world);
    Snapshot<D> ring[history];  // before each frame
    std::vector<std::uint64_t> final_hashes(std::size_t(frames), 0);
    int resimulated = 0;
    for (int now = 0; now < frames + history; ++now) {
      int from = now;
      for (const Input& in : inputs)
        if (in.arrival == now && in.frame < from) from = in.frame;
      if (from < now && from < frames) ASSERT_TRUE(world.restore(ring[from % history]).ok());
      for (int f = from; f <= now && f < frames; ++f) {
        world.snapshot(ring[f % history]);
        play_frame(world, f, now);
        final_hashes[std::size_t(f)] = world.state_hash();
        resimulated += f < now ? 1 : 0;
      }
    }
    EXPECT_EQ(final_hashes, hashes) << "seed " << seed;
    EXPECT_GT(resimulated, 100);
  }
}

// The same over a wire: the server sends differences to a base that the client holds, and both go on alike.
TYPED_TEST(Rollback, AClientFollowsByDifferences) {
  using D = TypeParam;
  World<D> server(world_with<D>()), client(world_with<D>());
  furnish_court(server);
  furnish_court(client);
  const std::vector<Input> inputs = random_inputs(9, 120);
  Snapshot<D> server_base = server.snapshot();
  Snapshot<D> client_base = Snapshot<D>::decode(server_base.encode()).value();
  for (int f = 0; f < 120; ++f) {
    for (const Input& in : inputs)
      if (in.frame == f) play(server, in);
    server.step(frame).value();
    if (f % 6 != 5) continue;
    const Snapshot<D> now = server.snapshot();
    const auto received = Snapshot<D>::decode(now.encode(server_base), client_base);
    ASSERT_TRUE(received.ok()) << received.error().message;
    ASSERT_TRUE(client.restore(*received).ok());
    ASSERT_EQ(client.state_hash(), server.state_hash());
    if (f % 30 == 29) server_base = now, client_base = *received;
  }
  run(server, 60);
  run(client, 60);
  EXPECT_EQ(client.state_hash(), server.state_hash());
}

World3 heap_of_500(bool sleep) {
  WorldDef<Dim3> d = world_with<Dim3>();
  d.allow_sleep = sleep;
  World3 world(d);
  add_ground(world);
  add_heap(world, 31);
  return world;
}

// Bars of the engine (issue of the rigid bodies, section 3): bytes of a difference per awake body, none for others.
TEST(SnapshotSize, ADifferenceIsSmall) {
  World3 world = heap_of_500(false);
  run(world, 60);
  const auto bytes_per_awake = [](World3& w, int steps) {
    const Snapshot3 base = w.snapshot();
    run(w, steps);
    return double(w.snapshot().encode(base).size()) / w.counters().awake_bodies;
  };
  EXPECT_LT(bytes_per_awake(world, 1), 40);  // falling on one another
  double worst = 0;                          // 3.4 pairs a body, of which many come and go
  for (int i = 0; i < 12; ++i) {
    run(world, 9);
    worst = std::max(worst, bytes_per_awake(world, 1));
  }
  EXPECT_LT(worst, 116);
  run(world, 440);
  EXPECT_LT(bytes_per_awake(world, 1), 72);  // at rest, kept awake
  EXPECT_LT(bytes_per_awake(world, 8), 100);

  World3 sleepers(world_with<Dim3>());
  add_ground(sleepers);
  for (int i = 0; i < 20; ++i) add_pyramid(sleepers, 8, 3.0 * i);
  run(sleepers, 200);
  ASSERT_EQ(sleepers.counters().awake_bodies, 0);
  const BodyId ball = add_ball<Dim3>(sleepers, {-50, 5, 0}, 0.5f);
  const Snapshot3 base = sleepers.snapshot();
  run(sleepers, 8);
  EXPECT_LT(sleepers.snapshot().encode(base).size(), 1000u);  // one ball among 720 sleepers; most is the header
  EXPECT_TRUE(sleepers.contains(ball));
}

}  // namespace
}  // namespace carom::rigid::test
