// Threads in WebAssembly: whoever runs the module (a Worker of the page, Node) starts further instances of it on the
// same memory, each in a worker of its own, and each of them calls `carom_worker`, which does what it is given.
// The engine never waits for a worker to come: what nobody has begun is taken back.
#include "carom/core/detail/threads.h"

#if defined(__wasi__) && CAROM_THREADS

#include <cstddef>
#include <cstdlib>

#include "carom/core/scheduler.h"

namespace carom::core {

namespace detail {
namespace {

enum JobState : std::uint32_t { unused, in_writing, waiting, running, done };
struct Job {
  std::atomic<std::uint32_t> state{unused};
  ThreadWork work = nullptr;
  void* context = nullptr;
  int index = 0;
};
constexpr int job_count = 256;  // of all pools together; a thread beyond it finds no worker
Job jobs[job_count];
std::atomic<std::uint32_t> posted{0};   // changes with every job
std::atomic<std::uint32_t> workers{0};  // that were promised
std::atomic<std::uint32_t> failed{0};   // a worker ended in an error, in the midst of its work

constexpr std::size_t stack_size = std::size_t{1} << 20;    // bytes, as the engine's own (cmake/wasm.cmake)
constexpr std::int64_t forever = -1, short_while = 20'000;  // ns

/// Apart, and not part of its caller: V8's first compiler (of 2023, Node 20) loses what its caller has in registers.
[[gnu::noinline]] void wait_for(std::atomic<std::uint32_t>& value, std::uint32_t seen, std::int64_t nanoseconds) {
  static_assert(sizeof value == sizeof(int));
  __builtin_wasm_memory_atomic_wait32(reinterpret_cast<int*>(&value), int(seen), nanoseconds);
}
bool take(Job& job, JobState from, JobState to) {
  std::uint32_t state = from;
  return job.state.load(std::memory_order_relaxed) == from &&
         job.state.compare_exchange_strong(state, to, std::memory_order_acq_rel);
}

}  // namespace

Thread::Thread(ThreadWork work, void* context, int index) : job_(0) {
  while (job_ < job_count && !take(jobs[job_], unused, in_writing)) ++job_;
  if (job_ == job_count) return;
  Job& job = jobs[job_];
  job.work = work;
  job.context = context;
  job.index = index;
  job.state.store(waiting, std::memory_order_release);
  posted.fetch_add(1);
  wake_all(posted);
}

void Thread::join() {
  if (job_ == job_count) return;
  Job& job = jobs[job_];
  if (!take(job, waiting, in_writing))
    while (job.state.load(std::memory_order_acquire) != done) yield();
  job.state.store(unused, std::memory_order_release);
}

ThreadId this_thread() {
  static thread_local char here = 0;
  return &here;
}
void wait_while(std::atomic<std::uint32_t>& value, std::uint32_t seen) {
  while (value.load() == seen) wait_for(value, seen, forever);
}
void wake_all(std::atomic<std::uint32_t>& value) {
  __builtin_wasm_memory_atomic_notify(reinterpret_cast<int*>(&value), unsigned(-1));
}
void yield() {
  if (failed.load(std::memory_order_relaxed) != 0) __builtin_trap();  // what is waited for will never be done
  wait_for(failed, 0, short_while);
}

}  // namespace detail

int hardware_threads() { return 1 + int(detail::workers.load(std::memory_order_relaxed)); }

}  // namespace carom::core

extern "C" {

/// So many workers will call `carom_worker`; 0 lets those go that have nothing to do.
__attribute__((export_name("carom_workers"))) void carom_workers(std::uint32_t count) {
  using namespace carom::core::detail;
  workers.store(count);
  posted.fetch_add(1);
  wake_all(posted);
}

/// Room for one of them: the end of its stack, where its own variables begin. Its instance's `__stack_pointer` takes
/// this address and so does `__wasm_init_tls`, before anything else is called there.
__attribute__((export_name("carom_worker_room"))) void* carom_worker_room() {
  constexpr std::size_t alignment = 64;
  const std::size_t own = (__builtin_wasm_tls_size() + alignment - 1) / alignment * alignment;
  char* const room = static_cast<char*>(std::aligned_alloc(alignment, carom::core::detail::stack_size + own));
  return room == nullptr ? nullptr : room + carom::core::detail::stack_size;
}

/// What a worker does until it is let go.
__attribute__((export_name("carom_worker"))) void carom_worker() {
  using namespace carom::core::detail;
  for (;;) {
    const std::uint32_t seen = posted.load();
    for (Job& job : jobs) {
      if (workers.load() == 0) return;
      if (!take(job, waiting, running)) continue;
      job.work(job.context, job.index);
      job.state.store(done, std::memory_order_release);
    }
    wait_while(posted, seen);
  }
}

/// A worker's call ended in an error of the module or of who runs it.
__attribute__((export_name("carom_worker_failed"))) void carom_worker_failed() {
  carom::core::detail::failed.store(1);
  carom::core::detail::wake_all(carom::core::detail::failed);
}
}

#endif
