// Where the time goes: scopes into a Chrome trace (chrome://tracing, Perfetto).
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <memory>
#include <string>

#include "carom/core/result.h"
#include "carom/export.h"

namespace carom::core {

/// Records scopes in a fixed number of lanes (one a thread). Recording neither allocates nor locks; when a lane is
/// full, further scopes are counted as lost. Pass a pointer along; a null pointer records nothing and costs one branch.
class CAROM_API Profiler {
 public:
  /// `lanes`: 1 … 64; `capacity`: scopes a lane.
  explicit Profiler(int lanes = 1, int capacity = 1 << 16);
  ~Profiler();
  Profiler(const Profiler&) = delete;
  Profiler& operator=(const Profiler&) = delete;

  /// Nanoseconds on a steady clock.
  static std::int64_t now() {
    return std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
        .count();
  }
  /// `name` must live as long as the profiler: a literal. Only one thread may write to a lane at a time; a lane out
  /// of range is counted as lost.
  void record(const char* name, int lane, std::int64_t begin, std::int64_t end);

  int lanes() const;
  std::int64_t recorded() const;
  std::int64_t lost() const;
  void clear();

  /// The recording as a Chrome trace ("complete" events, microseconds since the first scope, thread id = lane).
  std::string chrome_trace() const;
  Status write_chrome_trace(const std::string& path) const;

 private:
  struct Lane;
  std::unique_ptr<Lane[]> lanes_;
  int lane_count_, capacity_;
  std::atomic<std::int64_t> lost_{0};
};

/// The time from its construction to its end is one scope.
class ProfileScope {
 public:
  ProfileScope(Profiler* profiler, const char* name, int lane = 0) : profiler_(profiler) {
    if (profiler_ == nullptr) return;
    name_ = name;
    lane_ = lane;
    begin_ = Profiler::now();
  }
  ~ProfileScope() {
    if (profiler_ != nullptr) profiler_->record(name_, lane_, begin_, Profiler::now());
  }
  ProfileScope(const ProfileScope&) = delete;
  ProfileScope& operator=(const ProfileScope&) = delete;

 private:
  Profiler* profiler_;
  const char* name_ = nullptr;
  int lane_ = 0;
  std::int64_t begin_ = 0;
};

}  // namespace carom::core
