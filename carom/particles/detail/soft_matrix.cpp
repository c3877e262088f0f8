#include "carom/particles/detail/soft_matrix.h"

#include <algorithm>

namespace carom::particles::detail {

namespace {
constexpr int rows_at_once = 128;
using Lanes = SoftBlock::Lanes;
using math::Vec3d;
Lanes lanes(Vec3f v) { return Lanes{v.x, v.y, v.z, 0}; }
Vec3f vector(Lanes v) { return {v[0], v[1], v[2]}; }
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
  blocks.assign(column_.size(), SoftBlock{});

  // Links of the same pair are summed in the order in which they come.
  std::vector<Link> sorted(links.begin(), links.end());
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Link& a, const Link& b) { return a.row != b.row ? a.row < b.row : a.column < b.column; });
  near.assign(column_.size(), 0.0f);
  far_first_.assign(std::size_t(vertices) + 1, 0);
  far_middle_.assign(std::size_t(vertices), 0);
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
    if (far_middle_[std::size_t(i)] < 0) far_middle_[std::size_t(i)] = int(far_column_.size());
  }
  find_order();
}

/// A sweep in this order gives what one in the order of rows gives, but a row need not wait for the one before it.
void SoftMatrix::find_order() {
  const std::size_t n = diagonal_.size();
  std::vector<int> level(n, 0);
  order_.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    order_[i] = int(i);
    for (int k = first_[i]; k < diagonal_[i]; ++k) level[i] = math::max(level[i], level[column_[std::size_t(k)]] + 1);
    for (int k = far_first_[i]; k < far_middle_[i]; ++k)
      level[i] = math::max(level[i], level[far_column_[std::size_t(k)]] + 1);
  }
  std::stable_sort(order_.begin(), order_.end(),
                   [&](int a, int b) { return level[std::size_t(a)] < level[std::size_t(b)]; });
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

void SoftMatrix::multiply(const Vec3f* x, Vec3f* y, core::TaskScheduler& scheduler) const {
  scheduler.parallel_for(rows(), rows_at_once, [&](int from, int to, int) {
    for (int row = from; row < to; ++row) {
      const std::size_t i = std::size_t(row);
      y[i] = vector(side(first_[i], first_[i + 1], far_first_[i], far_first_[i + 1], x));
    }
  });
}

void SoftSolver::resize(std::size_t n) {
  for (auto* list : {&right, &change, &guess, &reaction, &residual_, &weighted_residual_, &direction_, &back_,
                     &forward_, &image_, &weighted_image_, &field_, &pull_})
    list->resize(n);
  diagonal.resize(n);
  full_.resize(n);
  inverse_.resize(n);
  holds.resize(n);
}

void SoftSolver::begin(const SoftMatrix& matrix, const std::vector<Vec3f>& velocity, core::TaskScheduler& scheduler) {
  Vec3f common{};
  for (const Vec3f v : velocity) common += v;
  common = common * (1 / float(velocity.size()));
  for (std::size_t i = 0; i < velocity.size(); ++i) change[i] = velocity[i] - common;
  matrix.multiply(change.data(), reaction.data(), scheduler);
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    right[i] -= reaction[i];
    change[i] = guess[i];
    holds[i] = {};
  }
}

/// Of a particle on a plane only what acts along it counts: its inverse maps to and from there.
void SoftSolver::prepare(const SoftMatrix& matrix) {
  for (std::size_t i = 0; i < right.size(); ++i) {
    const Mat3f whole = diagonal[i] + matrix.blocks[std::size_t(matrix.diagonal(int(i)))].matrix();
    full_[i] = SoftBlock::of(whole);
    if (holds[i].rank == 3) {
      inverse_[i] = {};
    } else if (holds[i].rank == 0) {
      inverse_[i] = SoftBlock::of(inverse(whole));
    } else {
      const Mat3f across = math::outer(holds[i].normal, holds[i].normal), within = Mat3f::identity() - across;
      const Mat3f inner = within * whole * within + ((1.0f / 3) * trace(whole)) * across;
      inverse_[i] = SoftBlock::of(within * inverse(inner) * within);
    }
  }
}

/// The guess of the free parts times the number that leaves the least error in energy.
void SoftSolver::scale_guess(const SoftMatrix& matrix, core::TaskScheduler& scheduler) {
  bool any = false;
  for (std::size_t i = 0; i < right.size(); ++i) {
    direction_[i] = holds[i].filter(change[i]);
    back_[i] = change[i] - direction_[i];
    any = any || direction_[i].x != 0 || direction_[i].y != 0 || direction_[i].z != 0;
  }
  if (!any) return;
  matrix.multiply(direction_.data(), image_.data(), scheduler);
  matrix.multiply(back_.data(), forward_.data(), scheduler);
  double along = 0, energy = 0;
  for (std::size_t i = 0; i < right.size(); ++i) {
    along += double(dot(direction_[i], right[i] - forward_[i] - diagonal[i] * back_[i]));
    energy += double(dot(direction_[i], image_[i] + diagonal[i] * direction_[i]));
  }
  const float share = energy > 0 ? float(along / energy) : 0.0f;
  for (std::size_t i = 0; i < right.size(); ++i) change[i] = back_[i] + share * direction_[i];
}

/// x ← (D + L)⁻¹ x, `weighted` = D x; returns x·D x.
double SoftSolver::start_sweep(const SoftMatrix& matrix, std::vector<Vec3f>& x, std::vector<Vec3f>& weighted) {
  double size = 0;
  for (const int row : matrix.order_) {
    const std::size_t i = std::size_t(row);
    const Lanes lower =
        matrix.side(matrix.first_[i], matrix.diagonal_[i], matrix.far_first_[i], matrix.far_middle_[i], x.data());
    const Lanes here = inverse_[i].times(lanes(x[i]) - lower);
    x[i] = vector(here);
    weighted[i] = vector(full_[i].times(here));
    size += double(dot(x[i], weighted[i]));
  }
  return size;
}

int SoftSolver::solve(const SoftMatrix& matrix, double tolerance, float least, int most,
                      core::TaskScheduler& scheduler) {
  const std::size_t n = right.size(), bodies = ties.empty() ? 0 : movers.size();
  prepare(matrix);
  prepare_movers(matrix);
  scale_guess(matrix, scheduler);
  // Against the right-hand side, not the first residual: a good guess needs fewer iterations. At rest nothing is left
  // to be relative to: a change of `least` for every particle is what does not matter.
  double small = 0;
  for (std::size_t i = 0; i < n; ++i) {
    residual_[i] = holds[i].filter(right[i]);
    const Lanes push = lanes(holds[i].filter(diagonal[i] * Vec3f{least, least, least}));
    small += double(dot(vector(push), vector(inverse_[i].times(push))));
  }
  double scale = start_sweep(matrix, residual_, weighted_residual_);
  if (bodies > 0) {
    right_of_movers(mover_residual_);
    scale += start_movers(matrix, residual_);
  }
  scale = math::max(scale, small);

  matrix.multiply(change.data(), image_.data(), scheduler);
  for (std::size_t i = 0; i < n; ++i) residual_[i] = right[i] - image_[i] - diagonal[i] * change[i];
  if (bodies > 0) residual_of_movers(mover_residual_);
  for (std::size_t i = 0; i < n; ++i) residual_[i] = holds[i].filter(residual_[i]);
  double size = start_sweep(matrix, residual_, weighted_residual_);
  if (bodies > 0) size += start_movers(matrix, residual_);
  int iterations = 0;
  float keep = 0;
  while (iterations < most && size > tolerance * tolerance * scale && size > 1e-30) {
    // q ← r + β q, t = (D + Lᵀ)⁻¹ D q
    if (bodies > 0) {
      for (std::size_t b = 0; b < bodies; ++b)
        mover_direction_[b] =
            iterations == 0 ? mover_residual_[b] : mover_residual_[b] + double(keep) * mover_direction_[b];
      sweep_up(matrix, mover_direction_, mover_back_);
    }
    for (std::size_t k = n; k-- > 0;) {
      const std::size_t i = std::size_t(matrix.order_[k]);
      direction_[i] = iterations == 0 ? residual_[i] : residual_[i] + keep * direction_[i];
      Lanes upper = matrix.side(matrix.diagonal_[i] + 1, matrix.first_[i + 1], matrix.far_middle_[i],
                                matrix.far_first_[i + 1], back_.data());
      if (bodies > 0) upper += lanes(pull_[i]);
      back_[i] = vector(lanes(direction_[i]) - inverse_[i].times(upper));
    }
    // w = t + u, u = (D + L)⁻¹ D (q − t)
    double curvature = 0;
    for (const int row : matrix.order_) {
      const std::size_t i = std::size_t(row);
      const Lanes lower = matrix.side(matrix.first_[i], matrix.diagonal_[i], matrix.far_first_[i],
                                      matrix.far_middle_[i], forward_.data());
      const Lanes t = lanes(back_[i]), u = lanes(direction_[i]) - t - inverse_[i].times(lower), w = t + u;
      forward_[i] = vector(u);
      image_[i] = vector(w);
      weighted_image_[i] = vector(full_[i].times(w));
      curvature += double(dot(direction_[i], weighted_image_[i]));
    }
    if (bodies > 0) curvature += finish_movers(matrix);
    ++iterations;
    if (!(curvature > 0)) break;
    const double along = size / curvature;
    double next = 0;
    for (std::size_t i = 0; i < n; ++i) {
      change[i] += float(along) * back_[i];
      residual_[i] -= float(along) * image_[i];
      weighted_residual_[i] -= float(along) * weighted_image_[i];
      next += double(dot(residual_[i], weighted_residual_[i]));
    }
    for (std::size_t b = 0; b < bodies; ++b) {
      if (movers[b].from == movers[b].to) continue;
      movers[b].change = movers[b].change + along * mover_back_[b];
      mover_residual_[b] = mover_residual_[b] - along * mover_image_[b];
      next += dot(mover_residual_[b], times(movers[b].full, mover_residual_[b]));
    }
    keep = float(next / size);
    size = next;
  }
  if (bodies > 0)
    for (const SoftTie& tie : ties)
      change[std::size_t(tie.node)] +=
          carried(tie, movers[std::size_t(tie.body)].change - mover_start_[std::size_t(tie.body)]);
  settle_momentum(matrix, scheduler);
  guess = change;
  return iterations;
}

/// What is left of the residual would be momentum out of nothing: where nothing is pinned, all that is free takes it as
/// a shift of the whole, which the elements do not feel. And what the holds had to give.
void SoftSolver::settle_momentum(const SoftMatrix& matrix, core::TaskScheduler& scheduler) {
  matrix.multiply(change.data(), image_.data(), scheduler);
  const std::size_t bodies = ties.empty() ? 0 : movers.size();
  bool pinned = false;
  for (std::size_t i = 0; i < right.size(); ++i) pinned |= holds[i].rank == 3;
  for (int pass = 0; pass < 3 && !pinned; ++pass) {
    Vec3f lost{};
    float all = 0;
    for (std::size_t i = 0; i < right.size(); ++i) {
      reaction[i] = right[i] - image_[i] - diagonal[i] * change[i];
      all += (1.0f / 3) * trace(diagonal[i]);
    }
    if (bodies > 0)  // which go along with the shift, so that nothing rubs more
      for (const SoftTie& tie : ties) {
        if (!(tie.grip > 0)) continue;
        all -= (2.0f / 3) * tie.grip;
        const Vec3f body(movers[std::size_t(tie.body)].change.at(tie.arm));
        reaction[std::size_t(tie.node)] += tie.grip * (body - dot(tie.normal, body) * tie.normal);
      }
    for (std::size_t i = 0; i < right.size(); ++i) lost += holds[i].filter(reaction[i]);
    if (!(all > 0)) break;
    const Vec3f shift = lost * (1 / all);
    for (Vec3f& x : change) x += shift;
    for (std::size_t b = 0; b < bodies; ++b)
      if (movers[b].from != movers[b].to) movers[b].change.linear += Vec3d(shift);
    if (pass == 0) matrix.multiply(change.data(), image_.data(), scheduler);
  }
  for (std::size_t i = 0; i < right.size(); ++i) {
    reaction[i] = holds[i].rank == 0 ? Vec3f{} : image_[i] + diagonal[i] * change[i] - right[i];
    if (holds[i].rank == 1) reaction[i] = dot(holds[i].normal, reaction[i]) * holds[i].normal;
  }
}

}  // namespace carom::particles::detail
