// The fork–join scheduler: every item once, the same chunks for any thread count, nested and concurrent calls.
#include "carom/core/scheduler.h"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <thread>
#include <vector>

namespace scheduler_test {
using carom::core::make_thread_pool;
using carom::core::ParallelRegion;
using carom::core::TaskScheduler;

TEST(Scheduler, RunsEveryItemExactlyOnce) {
  for (const int threads : {1, 2, 3, 8}) {
    const auto pool = make_thread_pool(threads);
    EXPECT_EQ(pool->thread_count(), threads);
    for (const int count : {0, 1, 2, 7, 64, 1000, 4097})
      for (const int grain : {-1, 1, 3, 64, 5000}) {
        std::vector<int> hits(std::size_t(count), 0);
        pool->parallel_for(count, grain, [&](int begin, int end, int worker) {
          EXPECT_GE(worker, 0);
          EXPECT_LT(worker, threads);
          for (int i = begin; i < end; ++i) ++hits[std::size_t(i)];
        });
        for (const int hit : hits) ASSERT_EQ(hit, 1);
      }
  }
}

TEST(Scheduler, CutsTheSameChunksForAnyThreadCount) {
  for (const int threads : {1, 2, 5}) {
    const auto pool = make_thread_pool(threads);
    std::array<int, 10> begins{}, ends{};
    pool->parallel_for(95, 10, [&](int begin, int end, int) {
      begins[std::size_t(begin / 10)] = begin;
      ends[std::size_t(begin / 10)] = end;
    });
    for (int k = 0; k < 10; ++k) {
      EXPECT_EQ(begins[std::size_t(k)], k * 10);
      EXPECT_EQ(ends[std::size_t(k)], std::min(95, k * 10 + 10));
    }
  }
}

double sum_of_roots(TaskScheduler& scheduler) {
  std::vector<double> partial(100);
  scheduler.parallel_for(100000, 1000, [&](int begin, int end, int) {
    double sum = 0;
    for (int i = begin; i < end; ++i) sum += 1.0 / (1 + i);
    partial[std::size_t(begin / 1000)] = sum;
  });
  double total = 0;
  for (const double p : partial) total += p;
  return total;
}

TEST(Scheduler, GivesTheSameBitsForOneAndTwoThreads) {
  carom::core::SerialScheduler serial;
  const double expected = sum_of_roots(serial);
  for (const int threads : {2, 4}) {
    const auto pool = make_thread_pool(threads);
    for (int i = 0; i < 50; ++i) ASSERT_EQ(sum_of_roots(*pool), expected);
  }
}

TEST(Scheduler, WorkersDoNotShareAnIndexAtTheSameTime) {
  const auto pool = make_thread_pool(4);
  std::array<std::atomic<int>, 4> busy{};
  std::atomic<int> clashes{0};
  for (int round = 0; round < 200; ++round)
    pool->parallel_for(64, 1, [&](int, int, int worker) {
      if (busy[std::size_t(worker)].fetch_add(1) != 0) clashes.fetch_add(1);
      busy[std::size_t(worker)].fetch_sub(1);
    });
  EXPECT_EQ(clashes.load(), 0);
}

TEST(Scheduler, RunsNestedCallsOnTheCallingThread) {
  const auto pool = make_thread_pool(2);
  std::vector<std::atomic<int>> hits(64);
  pool->parallel_for(8, 1, [&](int begin, int, int) {
    const auto thread = std::this_thread::get_id();
    pool->parallel_for(8, 1, [&, begin](int inner, int, int) {
      EXPECT_EQ(std::this_thread::get_id(), thread);
      hits[std::size_t(begin * 8 + inner)].fetch_add(1);
    });
  });
  for (const auto& hit : hits) EXPECT_EQ(hit.load(), 1);
}

TEST(Scheduler, ServesTwoCallersAtOnce) {
  const auto pool = make_thread_pool(3);
  std::atomic<std::int64_t> total{0};
  const auto caller = [&] {
    for (int round = 0; round < 300; ++round)
      pool->parallel_for(100, 7, [&](int begin, int end, int) { total.fetch_add(end - begin); });
  };
  std::thread other(caller);
  caller();
  other.join();
  EXPECT_EQ(total.load(), 2 * 300 * 100);
}

TEST(Scheduler, WakesSleepingWorkersAndStopsThem) {
  for (int round = 0; round < 20; ++round) {
    const auto pool = make_thread_pool(2);
    if (round % 2 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::atomic<int> sum{0};
    for (int i = 0; i < 100; ++i) pool->parallel_for(4, 1, [&](int begin, int, int) { sum.fetch_add(begin); });
    EXPECT_EQ(sum.load(), 600);
  }
}

/// Every chunk of a stage must find the stage before complete.
void run_chain(TaskScheduler& scheduler, int rounds) {
  std::vector<TaskScheduler::Stage> stages;
  for (int s = 0; s < 40; ++s) stages.push_back({s % 7 == 0 ? 1 : (s % 5 == 0 ? 0 : 10 + 13 * s), 1 + s % 6});
  for (int round = 0; round < rounds; ++round) {
    std::vector<std::atomic<int>> done(stages.size());
    std::atomic<int> early{0};
    scheduler.run_stages(stages, [&](int stage, int begin, int end, int) {
      for (int s = 0; s < stage; ++s)
        if (done[std::size_t(s)].load() != stages[std::size_t(s)].count) early.fetch_add(1);
      done[std::size_t(stage)].fetch_add(end - begin);
    });
    EXPECT_EQ(early.load(), 0);
    for (std::size_t s = 0; s < stages.size(); ++s) EXPECT_EQ(done[s].load(), stages[s].count) << "stage " << s;
  }
}

TEST(Scheduler, RunsStagesOneAfterTheOther) {
  for (const int threads : {1, 2, 3, 7}) run_chain(*make_thread_pool(threads), 50);
}

TEST(Scheduler, RunsLoopsAndStagesInsideARegion) {
  const auto pool = make_thread_pool(3);
  for (int round = 0; round < 50; ++round) {
    const ParallelRegion region(*pool);
    std::atomic<int> sum{0};
    for (int i = 0; i < 20; ++i) {
      const ParallelRegion nested(*pool);
      pool->parallel_for(50, 3, [&](int begin, int end, int) { sum.fetch_add(end - begin); });
    }
    EXPECT_EQ(sum.load(), 1000);
    run_chain(*pool, 1);
  }
}

TEST(Scheduler, TakesTheCallersOwnJobSystem) {
  struct Backwards final : TaskScheduler {
    int thread_count() const override { return 1; }
    void parallel_for(int count, int grain, Body body) override {
      for (int k = (count - 1) / grain; k >= 0; --k) body(k * grain, std::min(count, (k + 1) * grain), 0);
    }
  } backwards;
  carom::core::SerialScheduler serial;
  EXPECT_EQ(sum_of_roots(backwards), sum_of_roots(serial));
}

}  // namespace scheduler_test
