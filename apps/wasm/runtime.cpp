// What Debian's C and C++ libraries for WebAssembly, made for one thread, lack where several instances of a module run
// on one memory: the heap behind a lock (the linker's --wrap leads here), static objects that one thread makes while
// the others wait. Nothing is undone at the end of a module.
#include <atomic>
#include <cstddef>
#include <cstdint>

namespace {

/// Apart, and not part of its caller: V8's first compiler (of 2023, Node 20) loses what its caller has in registers.
[[gnu::noinline]] void wait_for(std::atomic<std::uint32_t>& value, std::uint32_t seen, std::int64_t nanoseconds) {
  __builtin_wasm_memory_atomic_wait32(reinterpret_cast<int*>(&value), int(seen), nanoseconds);
}

std::atomic<std::uint32_t> heap_taken{0};

class HeapLock {
 public:
  HeapLock() {
    constexpr std::int64_t while_it_may_last = 20'000;  // ns
    for (int looks = 0; heap_taken.exchange(1, std::memory_order_acquire) != 0; ++looks)
      if (looks > 100) wait_for(heap_taken, 1, while_it_may_last);
  }
  ~HeapLock() { heap_taken.store(0, std::memory_order_release); }
  HeapLock(const HeapLock&) = delete;
  HeapLock& operator=(const HeapLock&) = delete;
};

/// The compiler's own variable beside a static object: bit 0 says that the object is made.
enum Guard : std::uint32_t { untouched = 0, made = 1, in_making = 0x100 };
std::atomic<std::uint32_t>& guard_of(std::uint32_t* guard) {
  static_assert(sizeof(std::atomic<std::uint32_t>) == sizeof(std::uint32_t));
  return *reinterpret_cast<std::atomic<std::uint32_t>*>(guard);
}

}  // namespace

extern "C" {

void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* old, std::size_t size);
void* __real_aligned_alloc(std::size_t alignment, std::size_t size);
int __real_posix_memalign(void** out, std::size_t alignment, std::size_t size);
void __real_free(void* old);

void* __wrap_malloc(std::size_t size) {
  const HeapLock lock;
  return __real_malloc(size);
}
void* __wrap_calloc(std::size_t count, std::size_t size) {
  const HeapLock lock;
  return __real_calloc(count, size);
}
void* __wrap_realloc(void* old, std::size_t size) {
  const HeapLock lock;
  return __real_realloc(old, size);
}
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  const HeapLock lock;
  return __real_aligned_alloc(alignment, size);
}
int __wrap_posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  const HeapLock lock;
  return __real_posix_memalign(out, alignment, size);
}
void __wrap_free(void* old) {
  const HeapLock lock;
  __real_free(old);
}

/// 1 where the caller is to make the object, 0 once it is made.
int __cxa_guard_acquire(std::uint32_t* guard) {
  for (std::atomic<std::uint32_t>& state = guard_of(guard);;) {
    std::uint32_t seen = untouched;
    if (state.compare_exchange_strong(seen, in_making, std::memory_order_acquire)) return 1;
    if ((seen & made) != 0) return 0;
    wait_for(state, seen, 1'000'000);  // ns; then it looks again
  }
}
void __cxa_guard_release(std::uint32_t* guard) {
  guard_of(guard).store(made, std::memory_order_release);
  __builtin_wasm_memory_atomic_notify(reinterpret_cast<int*>(guard), unsigned(-1));
}
void __cxa_guard_abort(std::uint32_t* guard) { guard_of(guard).store(untouched, std::memory_order_release); }

int __cxa_atexit(void (*)(void*), void*, void*) { return 0; }
}
