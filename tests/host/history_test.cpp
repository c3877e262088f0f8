// Going back in time: every demo shows every remembered step with the bits it had.
#include "apps/host/history.h"

#include <gtest/gtest.h>

#include "apps/host/registry.h"

namespace carom::host {
namespace {

std::unique_ptr<Simulation> opened(std::unique_ptr<Demo> demo) {
  Demo& opener = *demo;
  core::Result<std::unique_ptr<Simulation>> simulation = opener.open(std::move(demo), {}, {});
  EXPECT_TRUE(simulation.ok()) << simulation.error().message;
  return std::move(simulation).value();
}

void step(History& history, Simulation& simulation) {
  history.branch(simulation);
  ASSERT_TRUE(simulation.step().ok());
  history.stepped(simulation);
}

TEST(History, EveryDemoShowsItsPastBitForBit) {
  for (const DemoEntry& demo : demos()) {
    std::unique_ptr<Simulation> simulation = opened(demo.make());
    const std::string id = simulation->declaration().id;
    History history;
    history.begin(*simulation);
    std::vector<std::uint64_t> hashes{simulation->state_hash()};
    for (int i = 0; i < 130; ++i) {
      if (i == 40)
        history.act(*simulation, [](Simulation& s) {
          (void)s.spawn({SpawnRequest::Form::ball, 0.3, 500, {0.1, 6, 0.2}, {0, -3, 0}});
        });
      if (i == 60 && !simulation->declaration().inputs.empty()) {
        const std::string action = simulation->declaration().inputs[0].action;
        history.act(*simulation, [action](Simulation& s) { (void)s.input(action, 1); });
      }
      step(history, *simulation);
      hashes.push_back(simulation->state_hash());
    }
    if (id == "rewind") {  // its first input turns its world's time back
      EXPECT_FALSE(history.seek(simulation, 10).ok());
      continue;
    }
    for (const std::uint64_t wanted : {100u, 99u, 41u, 61u, 130u, 0u, 35u, 129u}) {
      const core::Result<bool> sought = history.seek(simulation, wanted);
      ASSERT_TRUE(sought.ok()) << id << ": " << sought.error().message;
      EXPECT_EQ(simulation->step_count(), wanted) << id;
      EXPECT_EQ(simulation->state_hash(), hashes[wanted]) << id << " at step " << wanted;
    }
  }
}

TEST(History, ARunThatGoesOnFromThePastForgetsWhatCameAfter) {
  std::unique_ptr<Simulation> simulation = opened(make_demo("wrecking-ball"));
  History history;
  history.begin(*simulation);
  for (int i = 0; i < 100; ++i) step(history, *simulation);
  ASSERT_TRUE(history.seek(simulation, 50).ok());
  EXPECT_EQ(history.last(), 100u);
  history.act(*simulation,
              [](Simulation& s) { EXPECT_TRUE(s.spawn({SpawnRequest::Form::box, 0.4, 800, {0, 9, 0}, {}}).ok()); });
  EXPECT_EQ(history.last(), 50u);
  for (int i = 0; i < 60; ++i) step(history, *simulation);
  EXPECT_EQ(history.last(), 110u);
  const std::uint64_t end = simulation->state_hash();
  ASSERT_TRUE(history.seek(simulation, 20).ok());
  ASSERT_TRUE(history.seek(simulation, 110).ok());
  EXPECT_EQ(simulation->state_hash(), end) << "the body that was thrown in is there again";
}

TEST(History, RemembersAMinuteWithinItsMemory) {
  std::unique_ptr<Simulation> simulation = opened(make_demo("pyramids"));
  History history({.window = 2, .interval = 0.1, .bytes = 4u << 20});
  history.begin(*simulation);
  std::vector<std::uint64_t> hashes{simulation->state_hash()};
  for (int i = 0; i < 200; ++i) {
    step(history, *simulation);
    hashes.push_back(simulation->state_hash());
  }
  EXPECT_GE(history.first(), 80u);
  EXPECT_LE(history.first(), 200u);
  const std::uint64_t first = history.first();
  ASSERT_TRUE(history.seek(simulation, 0).ok());
  EXPECT_EQ(simulation->step_count(), first) << "taken to the nearest that is remembered";
  EXPECT_EQ(simulation->state_hash(), hashes[first]);
}

}  // namespace
}  // namespace carom::host
