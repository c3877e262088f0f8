// Which part of every colour a thread takes: the same in each pass, so that it finds in its cache what it left there.
#pragma once

#include "carom/core/scheduler.h"
#include "carom/rigid/detail/constraint_graph.h"

namespace carom::rigid::detail {

/// One of `of` even parts of any list.
struct ThreadShare {
  int index = 0, of = 1;
  int begin(int count) const { return count * index / of; }
  int end(int count) const { return count * (index + 1) / of; }
};

/// Calls run(color, begin, end) for all of the colours' blocks, of which each has count_of(color), in parallel and in
/// any order. Every thread begins with those that it has in the passes of the solver.
template <class CountOf, class Run>
void for_color_parts(core::TaskScheduler& scheduler, int grain, CountOf&& count_of, Run&& run) {
  constexpr int most_parts = 16;
  const int parts = math::min(scheduler.thread_count(), most_parts);
  int ends[most_parts * (color_count + 1)], total = 0;
  for (int part = 0; part < parts; ++part)
    for (int color = 0; color <= color_count; ++color) {
      const ThreadShare share{part, parts};
      const int count = count_of(color);
      ends[part * (color_count + 1) + color] = total += share.end(count) - share.begin(count);
    }
  if (total == 0) return;
  scheduler.parallel_for(total, grain, [&](int begin, int end, int) {
    for (int k = 0; begin < end; ++k) {
      if (ends[k] <= begin) continue;
      const int color = k % (color_count + 1);
      const int from = ThreadShare{k / (color_count + 1), parts}.begin(count_of(color));
      const int before = k == 0 ? 0 : ends[k - 1], stop = math::min(end, ends[k]);
      run(color, from + begin - before, from + stop - before);
      begin = stop;
    }
  });
}

/// The same of blocks in one row, of which each colour's begin at begins[color]: run(begin, end).
template <class Run>
void for_blocks_of_colors(core::TaskScheduler& scheduler, int grain, const std::vector<std::int32_t>& begins,
                          Run&& run) {
  for_color_parts(
      scheduler, grain, [&](int color) { return begins[std::size_t(color) + 1] - begins[std::size_t(color)]; },
      [&](int color, int begin, int end) {
        run(begins[std::size_t(color)] + begin, begins[std::size_t(color)] + end);
      });
}

}  // namespace carom::rigid::detail
