#include "carom/particles/detail/soft_matrix.h"

#include <algorithm>

namespace carom::particles::detail {

namespace {
constexpr int rows_at_once = 128;
}

void SoftMatrix::build(int vertices, std::initializer_list<Elements> kinds) {
  std::vector<std::vector<std::uint32_t>> neighbours(static_cast<std::size_t>(vertices));
  for (const Elements& kind : kinds) {
    const std::size_t size = std::size_t(kind.size);
    for (std::size_t e = 0; e + size <= kind.vertices.size(); e += size)
      for (std::size_t a = 0; a < size; ++a)
        for (std::size_t b = 0; b < size; ++b) neighbours[kind.vertices[e + a]].push_back(kind.vertices[e + b]);
  }
  first_.assign(1, 0);
  column_.clear();
  for (std::size_t i = 0; i < neighbours.size(); ++i) {
    auto& row = neighbours[i];
    row.push_back(std::uint32_t(i));
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    column_.insert(column_.end(), row.begin(), row.end());
    first_.push_back(int(column_.size()));
  }
  blocks.assign(column_.size(), SoftBlock{});
}

int SoftMatrix::slot(std::uint32_t i, std::uint32_t j) const {
  const auto begin = column_.begin() + first_[i], end = column_.begin() + first_[i + 1];
  return int(std::lower_bound(begin, end, j) - column_.begin());
}

void SoftMatrix::multiply(const Vec3f* x, Vec3f* y, core::TaskScheduler& scheduler) const {
  scheduler.parallel_for(rows(), rows_at_once, [&](int from, int to, int) {
    for (int i = from; i < to; ++i) {
      SoftBlock::Lanes sum{};
      for (int k = first_[std::size_t(i)]; k < first_[std::size_t(i) + 1]; ++k) {
        const SoftBlock& block = blocks[std::size_t(k)];
        const Vec3f v = x[column_[std::size_t(k)]];
        sum += block.x * v.x + block.y * v.y + block.z * v.z;
      }
      y[i] = {sum[0], sum[1], sum[2]};
    }
  });
}

void SoftSolver::resize(std::size_t n) {
  for (auto* list : {&right, &change, &reaction, &residual_, &direction_, &image_, &scaled_}) list->resize(n);
  diagonal.resize(n);
  inverse_.resize(n);
  holds.resize(n);
  sums_.resize((n + rows_at_once - 1) / rows_at_once);
}

double SoftSolver::product(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b, core::TaskScheduler& scheduler) {
  scheduler.parallel_for(int(a.size()), rows_at_once, [&](int from, int to, int) {
    double sum = 0;
    for (int i = from; i < to; ++i) sum += double(dot(a[std::size_t(i)], b[std::size_t(i)]));
    sums_[std::size_t(from / rows_at_once)] = sum;
  });
  double sum = 0;
  for (const double part : sums_) sum += part;
  return sum;
}

int SoftSolver::solve(const SoftMatrix& matrix, double tolerance, float least, int most,
                      core::TaskScheduler& scheduler) {
  const int n = int(right.size());
  const auto each = [&](auto&& body) {
    scheduler.parallel_for(n, rows_at_once, [&](int from, int to, int) {
      for (int i = from; i < to; ++i) body(std::size_t(i));
    });
  };
  matrix.multiply(change.data(), image_.data(), scheduler);
  each([&](std::size_t i) {
    // Of a particle on a plane only what acts along it is preconditioned.
    inverse_[i] =
        inverse(diagonal[i] + matrix.blocks[std::size_t(matrix.slot(std::uint32_t(i), std::uint32_t(i)))].matrix());
    residual_[i] = holds[i].filter(right[i] - image_[i] - diagonal[i] * change[i]);
    scaled_[i] = holds[i].filter(inverse_[i] * holds[i].filter(right[i]));
    direction_[i] = holds[i].filter(inverse_[i] * residual_[i]);
  });
  // Against the right-hand side, not the first residual: a good guess needs fewer iterations.
  for (std::size_t i = 0; i < right.size(); ++i) image_[i] = holds[i].filter(right[i]);
  double scale = product(image_, scaled_, scheduler);
  // At rest nothing is left to be relative to: a change of `least` for every particle is what does not matter.
  each([&](std::size_t i) {
    image_[i] = holds[i].filter(diagonal[i] * Vec3f{least, least, least});
    scaled_[i] = holds[i].filter(inverse_[i] * image_[i]);
  });
  scale = math::max(scale, product(image_, scaled_, scheduler));
  double size = product(residual_, direction_, scheduler);
  int iterations = 0;
  while (iterations < most && size > tolerance * tolerance * scale && size > 1e-30) {
    ++iterations;
    matrix.multiply(direction_.data(), image_.data(), scheduler);
    each([&](std::size_t i) { image_[i] = holds[i].filter(image_[i] + diagonal[i] * direction_[i]); });
    const double curvature = product(direction_, image_, scheduler);
    if (!(curvature > 0)) break;
    const float along = float(size / curvature);
    each([&](std::size_t i) {
      change[i] += along * direction_[i];
      residual_[i] -= along * image_[i];
      scaled_[i] = holds[i].filter(inverse_[i] * residual_[i]);
    });
    const double next = product(residual_, scaled_, scheduler);
    const float keep = float(next / size);
    size = next;
    each([&](std::size_t i) { direction_[i] = scaled_[i] + keep * direction_[i]; });
  }
  matrix.multiply(change.data(), image_.data(), scheduler);
  // What is left of the residual would be momentum out of nothing: where nothing is pinned, all that is free takes it
  // as a shift of the whole, which the elements do not feel.
  for (int pass = 0; pass < 3; ++pass) {
    Vec3f lost{};
    float all = 0;
    bool pinned = false;
    for (std::size_t i = 0; i < right.size(); ++i) {
      pinned |= holds[i].rank == 3;
      lost += holds[i].filter(right[i] - image_[i] - diagonal[i] * change[i]);
      all += (1.0f / 3) * trace(diagonal[i]);
    }
    if (pinned || !(all > 0)) break;
    const Vec3f shift = lost * (1 / all);
    for (Vec3f& x : change) x += shift;
    if (pass == 0) matrix.multiply(change.data(), image_.data(), scheduler);
  }
  each([&](std::size_t i) {
    reaction[i] = holds[i].rank == 0 ? Vec3f{} : image_[i] + diagonal[i] * change[i] - right[i];
    if (holds[i].rank == 1) reaction[i] = dot(holds[i].normal, reaction[i]) * holds[i].normal;
  });
  return iterations;
}

}  // namespace carom::particles::detail
