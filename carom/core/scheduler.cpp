#include "carom/core/scheduler.h"

#if !defined(__wasi__)
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>
#endif

namespace carom::core {

#if defined(__wasi__)

std::unique_ptr<TaskScheduler> make_thread_pool(int) { return std::make_unique<SerialScheduler>(); }
int hardware_threads() { return 1; }

#else

namespace detail {

inline void spin_pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb" ::: "memory");
#endif
}

class ThreadPool final : public TaskScheduler {
 public:
  explicit ThreadPool(int threads) : spins_(threads > hardware_threads() ? 0 : 2000) {
    workers_.reserve(std::size_t(threads) - 1);
    for (int i = 1; i < threads; ++i) workers_.emplace_back([this, i] { work(i); });
  }
  ~ThreadPool() override {
    stopping_.store(true, std::memory_order_relaxed);
    signal_.fetch_add(1);
    signal_.notify_all();
    for (std::thread& worker : workers_) worker.join();
  }
  int thread_count() const override { return int(workers_.size()) + 1; }

  void parallel_for(int count, int grain, Body body) override {
    if (count <= 0) return;
    if (grain < 1) grain = 1;
    const int chunks = (count - 1) / grain + 1;
    if (chunks == 1 || busy_.exchange(true, std::memory_order_acquire)) {
      SerialScheduler{}.parallel_for(count, grain, body);
      return;
    }
    job_ = {&body, count, grain, chunks};
    next_.store(0, std::memory_order_relaxed);
    const std::uint64_t epoch = (gate_.load(std::memory_order_relaxed) >> 32) + 1;
    gate_.store(epoch << 32 | open_bit, std::memory_order_release);
    signal_.fetch_add(1);  // sequentially consistent with sleepers_: either we see the sleeper or it sees the signal
    if (sleepers_.load() > 0) signal_.notify_all();
    run_chunks(0);
    gate_.fetch_and(~open_bit, std::memory_order_relaxed);
    for (int spin = 0; (gate_.load(std::memory_order_acquire) & inside_mask) != 0; ++spin) {
      if (spin < spins_)
        spin_pause();
      else
        std::this_thread::yield();
    }
    busy_.store(false, std::memory_order_release);
  }

 private:
  struct Job {
    const Body* body = nullptr;
    int count = 0, grain = 1, chunks = 0;
  };
  static constexpr std::uint64_t open_bit = std::uint64_t{1} << 31;
  static constexpr std::uint64_t inside_mask = open_bit - 1;

  void run_chunks(int worker) {
    const Job job = job_;
    for (;;) {
      const int chunk = next_.fetch_add(1, std::memory_order_relaxed);
      if (chunk >= job.chunks) return;
      const int begin = chunk * job.grain;
      (*job.body)(begin, job.count - begin > job.grain ? begin + job.grain : job.count, worker);
    }
  }

  // A worker enters an open job by counting itself in, so that the caller never waits for one that is still asleep
  // and a late one never touches a job that is over.
  bool try_enter(std::uint64_t& served) {
    std::uint64_t gate = gate_.load(std::memory_order_relaxed);
    while ((gate & open_bit) != 0 && gate >> 32 != served) {
      if (!gate_.compare_exchange_weak(gate, gate + 1, std::memory_order_acquire, std::memory_order_relaxed)) continue;
      served = gate >> 32;
      return true;
    }
    return false;
  }

  void work(int worker) {
    std::uint64_t served = 0;
    for (;;) {
      const std::uint32_t seen = signal_.load();
      if (stopping_.load(std::memory_order_relaxed)) return;
      if (try_enter(served)) {
        run_chunks(worker);
        gate_.fetch_sub(1, std::memory_order_release);
        continue;
      }
      bool signalled = false;
      for (int spin = 0; spin < spins_ && !signalled; ++spin) {
        spin_pause();
        signalled = signal_.load(std::memory_order_relaxed) != seen;
      }
      if (signalled) continue;
      sleepers_.fetch_add(1);
      signal_.wait(seen);
      sleepers_.fetch_sub(1);
    }
  }

  alignas(64) std::atomic<std::uint64_t> gate_{0};  // epoch, open bit, workers inside
  std::atomic<std::uint32_t> signal_{0};            // changes with every job and at the end
  alignas(64) std::atomic<int> next_{0};            // chunk to be taken
  alignas(64) Job job_;                             // written only while the gate is closed and empty
  std::atomic<int> sleepers_{0};
  std::atomic<bool> busy_{false};
  std::atomic<bool> stopping_{false};
  int spins_;
  std::vector<std::thread> workers_;
};

}  // namespace detail

int hardware_threads() {
  const unsigned n = std::thread::hardware_concurrency();
  return n < 1 ? 1 : int(n);
}

std::unique_ptr<TaskScheduler> make_thread_pool(int threads) {
  const int n = threads < 1 ? 1 : (threads > 64 ? 64 : threads);
  if (n == 1) return std::make_unique<SerialScheduler>();
  return std::make_unique<detail::ThreadPool>(n);
}

#endif

}  // namespace carom::core
