#include "carom/particles/detail/soft_matrix.h"

#include <algorithm>

namespace carom::particles::detail {

namespace {
constexpr int rows_at_once = 128;
using Lanes = SoftBlock::Lanes;
}  // namespace

void SoftMatrix::build(int vertices, std::span<const std::uint32_t> elements, int element_size,
                       std::span<const Link> links) {
  std::vector<std::vector<std::uint32_t>> neighbours(static_cast<std::size_t>(vertices));
  const std::size_t size = std::size_t(element_size);
  for (std::size_t e = 0; e + size <= elements.size(); e += size)
    for (std::size_t a = 0; a < size; ++a)
      for (std::size_t b = 0; b < size; ++b) neighbours[elements[e + a]].push_back(elements[e + b]);
  first_.assign(1, 0);
  column_.clear();
  diagonal_.clear();
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    auto& row = neighbours[i];
    row.push_back(std::uint32_t(i));
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    diagonal_.push_back(int(column_.size()) +
                        int(std::lower_bound(row.begin(), row.end(), std::uint32_t(i)) - row.begin()));
    column_.insert(column_.end(), row.begin(), row.end());
    first_.push_back(int(column_.size()));
  }
  blocks.assign(column_.size() + 1, SoftBlock{});  // and one that is none

  // Links of the same pair are summed in the order in which they come.
  std::vector<Link> sorted(links.begin(), links.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Link& a, const Link& b) { return a.row != b.row ? a.row < b.row : a.column < b.column; });
  near.assign(column_.size(), 0.0f);
  far_first_.assign(std::size_t(vertices) + 1, 0);
  far_middle_.assign(std::size_t(vertices), 0);
  far_sum_.assign(std::size_t(vertices), 0.0f);
  far_column_.clear();
  far_value_.clear();
  std::size_t at = 0;
  for (int i = 0; i < vertices; ++i) {
    far_middle_[std::size_t(i)] = -1;
    while (at < sorted.size() && sorted[at].row == std::uint32_t(i)) {
      const std::uint32_t j = sorted[at].column;
      double sum = 0;
      for (; at < sorted.size() && sorted[at].row == std::uint32_t(i) && sorted[at].column == j; ++at)
        sum += double(sorted[at].value);
      const int k = slot(std::uint32_t(i), j);
      if (k < first_[std::size_t(i) + 1] && column_[std::size_t(k)] == j) {
        near[std::size_t(k)] = float(sum);
        continue;
      }
      if (sum == 0) continue;
      if (far_middle_[std::size_t(i)] < 0 && j > std::uint32_t(i))
        far_middle_[std::size_t(i)] = int(far_column_.size());
      far_column_.push_back(j);
      far_value_.push_back(float(sum));
    }
    far_first_[std::size_t(i) + 1] = int(far_column_.size());
    double sum = 0;
    for (int k = far_first_[std::size_t(i)]; k < far_first_[std::size_t(i) + 1]; ++k)
      sum += double(far_value_[std::size_t(k)]);
    far_sum_[std::size_t(i)] = float(sum);
    if (far_middle_[std::size_t(i)] < 0) far_middle_[std::size_t(i)] = int(far_column_.size());
  }
  far_value_.push_back(0);  // of none
  find_tiles();
}

/// A sweep through the tiles gives what one in the order of rows gives, but a row need not wait for the one before it:
/// each tile takes the rows that have waited longest since all that they hang on was in earlier tiles.
void SoftMatrix::find_tiles() {
  const std::size_t n = diagonal_.size();
  std::vector<int> waits(n), ready;
  ready.reserve(n);
  for (std::size_t i = 0; i < n; ++i) {
    waits[i] = diagonal_[i] - first_[i] + far_middle_[i] - far_first_[i];
    if (waits[i] == 0) ready.push_back(int(i));
  }
  tiles_ = {};
  std::vector<int>& place = tiles_.place;
  place.resize(n);
  for (std::size_t taken = 0; taken < n;) {
    const std::size_t end = math::min(ready.size(), taken + soft_lanes);
    for (std::size_t k = taken; k < end; ++k) {
      place[std::size_t(ready[k])] = int(tiles_.row.size());
      tiles_.row.push_back(ready[k]);
    }
    for (std::size_t k = end - taken; k < soft_lanes; ++k) tiles_.row.push_back(-1);
    for (; taken < end; ++taken) {
      const std::size_t i = std::size_t(ready[taken]);
      const auto release = [&](std::uint32_t row) {
        if (--waits[row] == 0) ready.push_back(int(row));
      };
      for (int k = diagonal_[i] + 1; k < first_[i + 1]; ++k) release(column_[std::size_t(k)]);
      for (int k = far_middle_[i]; k < far_first_[i + 1]; ++k) release(far_column_[std::size_t(k)]);
    }
    ++tiles_.count;
  }
  // The entries of a tile's rows side by side: the first of each, then the second.
  const int beyond = tiles_.places();
  for (int tile = 0; tile < tiles_.count; ++tile) {
    const int* rows = &tiles_.row[std::size_t(tile) * soft_lanes];
    const auto take = [&](const std::vector<int>& from, const std::vector<int>& to,
                          const std::vector<std::uint32_t>& columns, int none) {
      bool any = true;
      for (int k = 0; any; ++k) {
        any = false;
        for (int lane = 0; lane < soft_lanes; ++lane)
          any |= rows[lane] >= 0 && from[std::size_t(rows[lane])] + k < to[std::size_t(rows[lane])];
        for (int lane = 0; any && lane < soft_lanes; ++lane) {
          const std::size_t i = std::size_t(math::max(rows[lane], 0));
          const bool is = rows[lane] >= 0 && from[i] + k < to[i];
          tiles_.column.push_back(is ? place[columns[std::size_t(from[i]) + std::size_t(k)]] : beyond + lane);
          tiles_.source.push_back(is ? from[i] + k : none);
        }
      }
    };
    tiles_.first.push_back(int(tiles_.column.size()) / soft_lanes);
    take(first_, diagonal_, column_, int(column_.size()));
    tiles_.far.push_back(int(tiles_.column.size()) / soft_lanes);
    take(far_first_, far_middle_, far_column_, int(far_column_.size()));
  }
  tiles_.first.push_back(int(tiles_.column.size()) / soft_lanes);
}

int SoftMatrix::slot(std::uint32_t i, std::uint32_t j) const {
  const auto begin = column_.begin() + first_[i], end = column_.begin() + first_[i + 1];
  return int(std::lower_bound(begin, end, j) - column_.begin());
}

Vec3f SoftMatrix::pull_of_links(int row, const math::Vec3d* x) const {
  const std::size_t i = std::size_t(row);
  const math::Vec3d here = x[i];
  Vec3f sum{};
  for (int k = first_[i]; k < first_[i + 1]; ++k)
    sum += near[std::size_t(k)] * Vec3f(x[column_[std::size_t(k)]] - here);
  for (int k = far_first_[i]; k < far_first_[i + 1]; ++k)
    sum += far_value_[std::size_t(k)] * Vec3f(x[far_column_[std::size_t(k)]] - here);
  return sum;
}

float SoftMatrix::far_size(int row) const {
  float sum = 0;
  for (int k = far_first_[std::size_t(row)]; k < far_first_[std::size_t(row) + 1]; ++k)
    sum += math::abs(far_value_[std::size_t(k)]);
  return sum;
}

void SoftMatrix::multiply(const SoftVector* x, SoftVector* y, core::TaskScheduler& scheduler) const {
  scheduler.parallel_for(rows(), rows_at_once, [&](int from, int to, int) {
    for (int row = from; row < to; ++row) y[row] = whole_row(std::size_t(row), x);
  });
}

void SoftMatrix::multiply_all(const SoftVector* x, SoftVector* y, core::TaskScheduler& scheduler) const {
  multiply(x, y, scheduler);
  if (!far_ahead) return;
  scheduler.parallel_for(rows(), rows_at_once, [&](int from, int to, int) {
    for (int row = from; row < to; ++row) {
      const std::size_t i = std::size_t(row);
      Lanes far{};
      for (int k = far_first_[i]; k < far_first_[i + 1]; ++k)
        far += far_value_[std::size_t(k)] * (x[far_column_[std::size_t(k)]].v - x[i].v);
      y[i].v += link_scale * far;
    }
  });
}

}  // namespace carom::particles::detail
