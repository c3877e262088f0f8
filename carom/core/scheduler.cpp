#include "carom/core/scheduler.h"

#include <atomic>
#include <cstdint>
#include <vector>

#include "carom/core/detail/threads.h"

namespace carom::core {

#if !CAROM_THREADS

std::unique_ptr<TaskScheduler> make_thread_pool(int) { return std::make_unique<SerialScheduler>(); }
int hardware_threads() { return 1; }

#else

namespace detail {

/// Workers enter a region by counting themselves in at a gate, so that the caller never waits for one that is still
/// asleep and a late one never touches what is over. Inside, they follow the loops that the caller publishes.
///
/// The chunks of a loop are dealt in as many runs as there are threads: a worker takes its own run first, so that loops
/// over the same data find it in the same core's cache, and then helps the others. A line of cache takes a quarter of a
/// microsecond from one core to another on servers of several dies: what a loop needs to be handed over is in one line,
/// and a run's counter stays with its owner until somebody helps.
class ThreadPool final : public TaskScheduler {
 public:
  explicit ThreadPool(int threads)
      : spins_(threads > hardware_threads() ? 0 : 2000),
        runs_(std::make_unique<Tagged[]>(std::size_t(threads))),
        stage_runs_(std::make_unique<Tagged[]>(std::size_t(threads))),
        stage_done_(std::make_unique<Tagged[]>(std::size_t(threads))) {
    workers_.reserve(std::size_t(threads) - 1);
    for (int i = 1; i < threads; ++i) workers_.emplace_back(&ThreadPool::serve, this, i);
  }
  ~ThreadPool() override {
    stopping_.store(true, std::memory_order_relaxed);
    signal_.fetch_add(1);
    wake_all(signal_);
    for (Thread& worker : workers_) worker.join();
  }
  int thread_count() const override { return int(workers_.size()) + 1; }

  void begin_region() override {
    if (!busy_.exchange(true, std::memory_order_acquire)) {
      owner_.store(this_thread(), std::memory_order_relaxed);
      open();
    }
    if (owned()) ++depth_;
  }
  void end_region() override {
    if (!owned() || --depth_ > 0) return;
    close();
    owner_.store(ThreadId(), std::memory_order_relaxed);
    busy_.store(false, std::memory_order_release);
  }

  void parallel_for(int count, int grain, Body body) override {
    if (count <= 0) return;
    if (grain < 1) grain = 1;
    const int chunks = (count - 1) / grain + 1;
    if (chunks == 1) return body(0, count, 0);
    begin_region();
    if (!owned() || in_loop_) {
      SerialScheduler{}.parallel_for(count, grain, body);
    } else {
      in_loop_ = true;
      share(body, count, grain, chunks);
      in_loop_ = false;
    }
    end_region();
  }

  void run_stages(std::span<const Stage> stages, StageBody body) override {
    begin_region();
    if (!owned() || in_loop_) {
      SerialScheduler{}.run_stages(stages, body);
    } else {
      for (int run = 0; run < thread_count(); ++run) {
        stage_runs_[std::size_t(run)].value.store(0, std::memory_order_relaxed);
        stage_done_[std::size_t(run)].value.store(0, std::memory_order_relaxed);
      }
      parallel_for(thread_count(), 1, [&](int, int, int worker) { walk_stages(stages, body, worker); });
    }
    end_region();
  }

 private:
  static constexpr std::uint64_t open_bit = std::uint64_t{1} << 31;
  static constexpr std::uint64_t inside_mask = open_bit - 1;

  /// A counter under the tag of its loop: what an older tag left counts as not begun.
  struct alignas(64) Tagged {
    std::atomic<std::uint64_t> value{0};
  };
  /// A loop as the caller hands it over. Two take turns, so that one is never written while its tag is current.
  struct Loop {
    std::atomic<const Body*> body{nullptr};
    std::atomic<int> count{1}, grain{1};
  };

  bool owned() const { return owner_.load(std::memory_order_relaxed) == this_thread(); }
  int first_of_run(int run, int chunks) const {
    const int threads = thread_count();
    return int((std::int64_t(chunks) * run + threads - 1) / threads);
  }

  void open() {
    const std::uint64_t epoch = (gate_.load(std::memory_order_relaxed) >> 32) + 1;
    closed_.store(false, std::memory_order_relaxed);
    gate_.store(epoch << 32 | open_bit, std::memory_order_release);
    signal_.fetch_add(1);  // sequentially consistent with sleepers_: either we see the sleeper or it sees the signal
    if (sleepers_.load() > 0) wake_all(signal_);
  }
  void close() {
    gate_.fetch_and(~open_bit, std::memory_order_relaxed);
    closed_.store(true, std::memory_order_release);
    for (int spin = 0; (gate_.load(std::memory_order_acquire) & inside_mask) != 0; ++spin) wait_a_little(spin);
  }

  /// Takes the next chunk of a run, −1 where none is left. A tag is never used twice, and its loop is not over before
  /// every chunk is taken: a latecomer finds nothing.
  static int take_chunk(std::atomic<std::uint64_t>& next, std::uint32_t tag, int first, int end) {
    std::uint64_t seen = next.load(std::memory_order_relaxed);
    for (;;) {
      const bool begun = std::uint32_t(seen >> 32) == tag;
      if (!begun && std::int32_t(std::uint32_t(seen >> 32) - tag) > 0) return -1;
      const int chunk = begun ? int(seen & 0xFFFFFFFF) : first;
      if (chunk >= end) return -1;
      if (next.compare_exchange_weak(seen, std::uint64_t(tag) << 32 | std::uint64_t(chunk + 1),
                                     std::memory_order_acquire, std::memory_order_relaxed))
        return chunk;
    }
  }

  void share(const Body& body, int count, int grain, int chunks) {
    const std::uint32_t tag = tag_.load(std::memory_order_relaxed) + 1;
    Loop& loop = loops_[tag & 1];
    finished_.store(0, std::memory_order_relaxed);
    loop.body.store(&body, std::memory_order_release);
    loop.count.store(count, std::memory_order_release);
    loop.grain.store(grain, std::memory_order_release);
    tag_.store(tag, std::memory_order_release);
    take_part(tag, 0);
    for (int spin = 0; finished_.load(std::memory_order_acquire) != chunks; ++spin) wait_a_little(spin);
  }

  void take_part(std::uint32_t tag, int worker) {
    const Loop& loop = loops_[tag & 1];
    const Body* body = loop.body.load(std::memory_order_acquire);
    const int count = loop.count.load(std::memory_order_acquire), grain = loop.grain.load(std::memory_order_acquire);
    if (tag_.load(std::memory_order_acquire) != tag) return;  // too late: the fields may be those of a later loop
    const int chunks = (count - 1) / grain + 1, threads = thread_count();
    int done = 0;
    for (int k = 0; k < threads; ++k) {
      const int run = worker + k < threads ? worker + k : worker + k - threads;
      const int first = first_of_run(run, chunks), end = first_of_run(run + 1, chunks);
      for (int chunk; (chunk = take_chunk(runs_[std::size_t(run)].value, tag, first, end)) >= 0; ++done) {
        const int begin = chunk * grain;
        (*body)(begin, count - begin > grain ? begin + grain : count, worker);
      }
    }
    if (done > 0) finished_.fetch_add(done, std::memory_order_release);
  }

  /// One thread's way through all stages. Nobody is told to go on: each run's count of finished chunks says so, which
  /// saves half of a fork and join. Stage s has the tag s + 1.
  void walk_stages(std::span<const Stage> stages, const StageBody& body, int worker) {
    const int threads = thread_count();
    int patience = full_patience;
    for (std::size_t s = 0; s < stages.size(); ++s) {
      const int count = stages[s].count, grain = stages[s].grain < 1 ? 1 : stages[s].grain;
      if (count <= 0) continue;
      const int chunks = (count - 1) / grain + 1;
      const std::uint32_t tag = std::uint32_t(s) + 1;
      const auto work_on = [&](int run, int first, int end) {
        int done = 0;
        for (int chunk; (chunk = take_chunk(stage_runs_[std::size_t(run)].value, tag, first, end)) >= 0; ++done) {
          const int begin = chunk * grain;
          body(int(s), begin, count - begin > grain ? begin + grain : count, worker);
        }
        if (done > 0) report_done(stage_done_[std::size_t(run)].value, tag, done);
      };
      for (int k = 0; k < threads; ++k) {
        const int run = worker + k < threads ? worker + k : worker + k - threads;
        const int first = first_of_run(run, chunks), end = first_of_run(run + 1, chunks);
        if (first == end) continue;
        if (k == 0) work_on(run, first, end);
        // Waiting first, helping later: looking for chunks takes the counter away from the one who works with it. Who
        // had to be helped is not waited for in the next stage.
        int spin = 0;
        for (; !is_done(stage_done_[std::size_t(run)].value, tag, end - first); ++spin) {
          if (spin >= patience) work_on(run, first, end);
          wait_a_little(spin);
        }
        patience = spin > patience || spins_ == 0 ? 0 : full_patience;
      }
    }
  }
  static constexpr int full_patience = 200;  // looks at another's progress before helping: some microseconds

  static void report_done(std::atomic<std::uint64_t>& done, std::uint32_t tag, int chunks) {
    std::uint64_t seen = done.load(std::memory_order_relaxed);
    for (;;) {
      const std::uint64_t before = std::uint32_t(seen >> 32) == tag ? seen : std::uint64_t(tag) << 32;
      if (done.compare_exchange_weak(seen, before + std::uint64_t(chunks), std::memory_order_acq_rel,
                                     std::memory_order_relaxed))
        return;
    }
  }
  static bool is_done(const std::atomic<std::uint64_t>& done, std::uint32_t tag, int chunks) {
    const std::uint64_t seen = done.load(std::memory_order_acquire);
    const std::uint32_t of = std::uint32_t(seen >> 32);
    return of > tag || (of == tag && int(seen & 0xFFFFFFFF) == chunks);
  }

  void wait_a_little(int spin) const {
    if (spin < spins_)
      spin_pause();
    else
      yield();
  }

  bool try_enter(std::uint64_t& served) {
    std::uint64_t gate = gate_.load(std::memory_order_relaxed);
    while ((gate & open_bit) != 0 && gate >> 32 != served) {
      if (!gate_.compare_exchange_weak(gate, gate + 1, std::memory_order_acquire, std::memory_order_relaxed)) continue;
      served = gate >> 32;
      return true;
    }
    return false;
  }
  void follow(int worker) {
    std::uint32_t last = tag_.load(std::memory_order_acquire);
    if (last != 0) take_part(last, worker);  // 0: no loop yet
    for (int spin = 0; !closed_.load(std::memory_order_acquire); ++spin) {
      const std::uint32_t tag = tag_.load(std::memory_order_acquire);
      if (tag == last) {
        wait_a_little(spin);
        continue;
      }
      last = tag;
      spin = 0;
      take_part(tag, worker);
    }
  }

  static void serve(void* pool, int worker) { static_cast<ThreadPool*>(pool)->work(worker); }
  void work(int worker) {
    std::uint64_t served = 0;
    for (;;) {
      const std::uint32_t seen = signal_.load();
      if (stopping_.load(std::memory_order_relaxed)) return;
      if (try_enter(served)) {
        follow(worker);
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
      wait_while(signal_, seen);
      sleepers_.fetch_sub(1);
    }
  }

  alignas(64) std::atomic<std::uint64_t> gate_{0};  // epoch, open bit, workers inside
  std::atomic<std::uint32_t> signal_{0};            // changes with every region and at the end
  alignas(64) std::atomic<std::uint32_t> tag_{0};   // of the loop that runs
  std::atomic<bool> closed_{true};                  // the region is over
  Loop loops_[2];                                   // of even and odd tags
  alignas(64) std::atomic<int> finished_{0};        // chunks done
  alignas(64) std::atomic<int> sleepers_{0};
  std::atomic<bool> busy_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<ThreadId> owner_{};  // who opened the region
  int depth_ = 0;                  // the owner's nested regions
  bool in_loop_ = false;           // the owner's: a loop of this region runs
  int spins_;
  std::unique_ptr<Tagged[]> runs_, stage_runs_, stage_done_;  // by run
  std::vector<Thread> workers_;
};

}  // namespace detail

#if !defined(__wasi__)
int hardware_threads() {
  const unsigned n = std::thread::hardware_concurrency();
  return n < 1 ? 1 : int(n);
}
#endif

std::unique_ptr<TaskScheduler> make_thread_pool(int threads) {
  const int n = threads < 1 ? 1 : (threads > 64 ? 64 : threads);
  if (n == 1) return std::make_unique<SerialScheduler>();
  return std::make_unique<detail::ThreadPool>(n);
}

#endif

}  // namespace carom::core
