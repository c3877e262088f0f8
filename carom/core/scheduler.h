// Fork–join parallel loops. The library's own thread pool is the default; a game hands in its own job system by
// deriving from TaskScheduler.
#pragma once

#include <memory>
#include <span>

#include "carom/core/function_ref.h"
#include "carom/export.h"

namespace carom::core {

/// Runs the chunks of a loop, on one thread or on several, and returns when all are done.
///
/// The contract that makes results independent of the thread count: [0, count) is cut into chunks
/// [k·grain, min((k + 1)·grain, count)), the same for every scheduler; every chunk is run exactly once, in any order,
/// on any thread. Chunks must write to disjoint places. What a chunk produces for later reduction goes to a place
/// chosen by k = begin / grain, never by `worker`, and is reduced in the order of k afterwards.
///
/// `worker` lies in [0, thread_count()) and is unique among chunks of this call that run at the same time: it picks
/// scratch memory. The calling thread takes part.
class CAROM_API TaskScheduler {
 public:
  using Body = FunctionRef<void(int begin, int end, int worker)>;

  virtual ~TaskScheduler() = default;
  virtual int thread_count() const = 0;
  /// count ≤ 0 does nothing; grain < 1 counts as 1. Must not allocate. The body must not throw.
  virtual void parallel_for(int count, int grain, Body body) = 0;

  struct Stage {
    int count = 0, grain = 1;
  };
  using StageBody = FunctionRef<void(int stage, int begin, int end, int worker)>;
  /// Loops that depend on each other: as parallel_for for every stage in turn; a stage begins when all chunks of the
  /// one before are done. Schedulers that can, do it with less than a fork and a join for each.
  virtual void run_stages(std::span<const Stage> stages, StageBody body) {
    for (std::size_t s = 0; s < stages.size(); ++s)
      parallel_for(stages[s].count, stages[s].grain,
                   [&](int begin, int end, int worker) { body(int(s), begin, end, worker); });
  }
  /// Hints that many short loops follow each other until end_region: workers may stay at hand in between. Calls come
  /// in pairs, from the thread that calls parallel_for. By default nothing.
  virtual void begin_region() {}
  virtual void end_region() {}
};

/// Keeps a scheduler's workers at hand while it lives.
class ParallelRegion {
 public:
  explicit ParallelRegion(TaskScheduler& scheduler) : scheduler_(scheduler) { scheduler_.begin_region(); }
  ~ParallelRegion() { scheduler_.end_region(); }
  ParallelRegion(const ParallelRegion&) = delete;
  ParallelRegion& operator=(const ParallelRegion&) = delete;

 private:
  TaskScheduler& scheduler_;
};

/// Everything on the calling thread, chunks in order.
class CAROM_API SerialScheduler final : public TaskScheduler {
 public:
  int thread_count() const override { return 1; }
  void parallel_for(int count, int grain, Body body) override {
    if (grain < 1) grain = 1;
    for (int begin = 0; begin < count;) {
      const int end = count - begin > grain ? begin + grain : count;
      body(begin, end, 0);
      begin = end;
    }
  }
};

/// A pool of `threads` workers, the calling thread included (clamped to 1 … 64). Idle workers spin for some tens of
/// microseconds and then sleep, so that the stages of a physics step follow each other without system calls.
/// A call that comes while another is running (nested in a body, or from another thread) is run on its own calling
/// thread alone, with the same chunks. One thread, and WASM without threads, give a SerialScheduler.
CAROM_API std::unique_ptr<TaskScheduler> make_thread_pool(int threads);

/// Hardware threads of this machine, at least 1.
CAROM_API int hardware_threads();

}  // namespace carom::core
