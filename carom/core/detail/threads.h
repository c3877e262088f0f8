// What the pool needs of threads: the C++ library's, or in WebAssembly, whose C++ library has none, the workers that
// whoever runs the module lends it (threads_wasm.cpp).
#pragma once

#include <atomic>
#include <cstdint>

#if !defined(__wasi__)
#include <thread>
#endif

#if !defined(__wasi__) || defined(__wasm_atomics__)
#define CAROM_THREADS 1
#else
#define CAROM_THREADS 0
#endif

namespace carom::core::detail {

/// A thread's way: `context` is what it works on, `index` which of the threads on it this is.
using ThreadWork = void (*)(void* context, int index);

#if !defined(__wasi__)

class Thread {
 public:
  Thread(ThreadWork work, void* context, int index) : thread_(work, context, index) {}
  void join() { thread_.join(); }

 private:
  std::thread thread_;
};

using ThreadId = std::thread::id;
inline ThreadId this_thread() { return std::this_thread::get_id(); }

/// Sleeps while the value is `seen`.
inline void wait_while(std::atomic<std::uint32_t>& value, std::uint32_t seen) { value.wait(seen); }
inline void wake_all(std::atomic<std::uint32_t>& value) { value.notify_all(); }
inline void yield() { std::this_thread::yield(); }

#elif CAROM_THREADS

/// Work that waits for a worker. It may be over before one came: who needs it done does it himself.
class Thread {
 public:
  Thread(ThreadWork work, void* context, int index);
  /// Takes the work back where nobody has begun it, otherwise waits for its end.
  void join();

 private:
  int job_;
};

/// The address of what every thread has for itself; null is nobody's.
using ThreadId = const void*;
ThreadId this_thread();

void wait_while(std::atomic<std::uint32_t>& value, std::uint32_t seen);
void wake_all(std::atomic<std::uint32_t>& value);
void yield();

#endif

/// A moment of waiting for another core: some tens of cycles.
inline void spin_pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("isb" ::: "memory");
#elif defined(__wasm__)
  for (int i = 0; i < 16; ++i) asm volatile("" ::: "memory");  // it has no such instruction
#endif
}

}  // namespace carom::core::detail
