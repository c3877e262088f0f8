#include "carom/core/profiler.h"

#include <algorithm>
#include <vector>

#include "carom/core/string.h"

namespace carom::core {

struct Profiler::Lane {
  struct Scope {
    const char* name;
    std::int64_t begin, end;
  };
  std::vector<Scope> scopes;
};

Profiler::Profiler(int lanes, int capacity)
    : lane_count_(std::clamp(lanes, 1, 64)), capacity_(std::clamp(capacity, 1, 1 << 24)) {
  lanes_ = std::make_unique<Lane[]>(std::size_t(lane_count_));
  for (int i = 0; i < lane_count_; ++i) lanes_[std::size_t(i)].scopes.reserve(std::size_t(capacity_));
}
Profiler::~Profiler() = default;

void Profiler::record(const char* name, int lane, std::int64_t begin, std::int64_t end) {
  if (lane < 0 || lane >= lane_count_ || int(lanes_[std::size_t(lane)].scopes.size()) >= capacity_) {
    lost_.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  lanes_[std::size_t(lane)].scopes.push_back({name, begin, end});
}

int Profiler::lanes() const { return lane_count_; }
std::int64_t Profiler::lost() const { return lost_.load(std::memory_order_relaxed); }
std::int64_t Profiler::recorded() const {
  std::int64_t total = 0;
  for (int i = 0; i < lane_count_; ++i) total += std::int64_t(lanes_[std::size_t(i)].scopes.size());
  return total;
}
void Profiler::clear() {
  for (int i = 0; i < lane_count_; ++i) lanes_[std::size_t(i)].scopes.clear();
  lost_.store(0, std::memory_order_relaxed);
}

std::string Profiler::chrome_trace() const {
  std::int64_t first = 0;
  bool any = false;
  for (int i = 0; i < lane_count_; ++i)
    for (const Lane::Scope& scope : lanes_[std::size_t(i)].scopes) {
      if (!any || scope.begin < first) first = scope.begin;
      any = true;
    }
  std::string out = "{\"displayTimeUnit\":\"ns\",\"traceEvents\":[";
  any = false;
  for (int i = 0; i < lane_count_; ++i)
    for (const Lane::Scope& scope : lanes_[std::size_t(i)].scopes) {
      if (any) out.push_back(',');
      any = true;
      out += text("\n{\"name\":", quoted(scope.name), ",\"ph\":\"X\",\"pid\":1,\"tid\":", i,
                  ",\"ts\":", fixed(double(scope.begin - first) / 1000.0, 3),
                  ",\"dur\":", fixed(double(scope.end - scope.begin) / 1000.0, 3), "}");
    }
  out += "\n]}\n";
  return out;
}

Status Profiler::write_chrome_trace(const std::string& path) const {
  std::FILE* const file = std::fopen(path.c_str(), "wb");
  if (file == nullptr) return Error{text(quoted(path), ": cannot be opened for writing")};
  const std::string trace = chrome_trace();
  const bool whole = std::fwrite(trace.data(), 1, trace.size(), file) == trace.size();
  const bool closed = std::fclose(file) == 0;
  if (!whole || !closed) return Error{text(quoted(path), ": could not be written whole")};
  return {};
}

}  // namespace carom::core
