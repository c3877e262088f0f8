#include "carom/core/spelling.h"

#include <algorithm>

#include "carom/core/string.h"

namespace carom::core {

namespace detail {
constexpr char lower_case(char c) { return c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c; }
}  // namespace detail

int edit_distance(std::string_view a, std::string_view b) {
  constexpr int limit = 64;
  a = a.substr(0, limit);
  b = b.substr(0, limit);
  const int n = int(b.size());
  int rows[3][limit + 1];
  int *before = rows[0], *previous = rows[1], *current = rows[2];
  for (int j = 0; j <= n; ++j) previous[j] = j;
  for (int i = 1; i <= int(a.size()); ++i) {
    const char ca = detail::lower_case(a[std::size_t(i) - 1]);
    current[0] = i;
    for (int j = 1; j <= n; ++j) {
      const char cb = detail::lower_case(b[std::size_t(j) - 1]);
      int best = std::min(previous[j] + 1, current[j - 1] + 1);
      best = std::min(best, previous[j - 1] + (ca == cb ? 0 : 1));
      if (i > 1 && j > 1 && ca == detail::lower_case(b[std::size_t(j) - 2]) &&
          cb == detail::lower_case(a[std::size_t(i) - 2]))
        best = std::min(best, before[j - 2] + 1);
      current[j] = best;
    }
    int* const recycled = before;
    before = previous;
    previous = current;
    current = recycled;
  }
  return previous[n];
}

std::string_view nearest_name(std::string_view name, std::span<const std::string_view> known) {
  std::string_view best;
  int best_distance = 0;
  for (const std::string_view candidate : known) {
    const int allowed = std::max(1, int(std::max(name.size(), candidate.size())) / 3);
    const int distance = edit_distance(name, candidate);
    if (distance <= allowed && (best.empty() || distance < best_distance)) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view name, std::span<const std::string_view> known) {
  const std::string_view nearest = nearest_name(name, known);
  return nearest.empty() ? std::string{} : text(", did you mean ", quoted(nearest), "?");
}

}  // namespace carom::core
