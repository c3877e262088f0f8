#include "carom/particles/detail/soft_matrix.h"

#include <algorithm>

namespace carom::particles::detail {

namespace {
constexpr int rows_at_once = 128;
using Lanes = SoftBlock::Lanes;
using math::Vec3d;
Lanes lanes(Vec3f v) { return Lanes{v.x, v.y, v.z, 0}; }
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
  std::vector<std::uint32_t> place(n);
  for (std::size_t p = 0; p < n; ++p) place[std::size_t(order_[p])] = std::uint32_t(p);
  lower_ = {};
  const auto take = [&](int from, int to, const std::vector<std::uint32_t>& columns) {
    for (int k = from; k < to; ++k) {
      lower_.column.push_back(place[columns[std::size_t(k)]]);
      lower_.source.push_back(k);
    }
  };
  for (const int row : order_) {
    const std::size_t i = std::size_t(row);
    lower_.first.push_back(int(lower_.column.size()));
    take(first_[i], diagonal_[i], column_);
    lower_.far.push_back(int(lower_.column.size()));
    take(far_first_[i], far_middle_[i], far_column_);
  }
  lower_.first.push_back(int(lower_.column.size()));
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

void SoftSolver::resize(std::size_t n) {
  for (auto* list : {&right, &change, &guess, &reaction, &residual_, &free_, &held_, &image_, &swept_, &direction_,
                     &back_, &forward_, &sum_, &field_, &pull_})
    list->resize(n);
  diagonal.resize(n);
  scale_.resize(n);
  scale_transposed_.resize(n);
  holds.resize(n);
}

void SoftSolver::begin(const SoftMatrix& matrix, const std::vector<Vec3f>& velocity, core::TaskScheduler& scheduler) {
  Vec3f common{};
  for (const Vec3f v : velocity) common += v;
  common = common * (1 / float(velocity.size()));
  for (std::size_t i = 0; i < velocity.size(); ++i) change[i] = velocity[i] - common;
  matrix.multiply_all(change.data(), reaction.data(), scheduler);
  for (std::size_t i = 0; i < velocity.size(); ++i) {
    right[i].v -= reaction[i].v;
    change[i] = guess[i];
    holds[i] = {};
  }
}

namespace {

/// W with Wᵀ m W = 1 within what a hold leaves free, and without the rest: from Cholesky's factor.
SoftBlock scale_of(const Mat3f& m, const SoftHold& hold) {
  SoftBlock out;
  if (hold.rank == 3) return out;
  const auto root = [](float square, float whole) { return 1 / math::sqrt(math::max(square, 1e-6f * whole)); };
  if (hold.rank == 1) {
    const Vec3f n = hold.normal;
    const Vec3f a = math::normalize(math::abs(n.x) < 0.6f ? Vec3f{0, n.z, -n.y} : Vec3f{-n.z, 0, n.x}), b = cross(n, a);
    const Vec3f ma = m * a, mb = m * b;
    const float inverse = root(dot(a, ma), dot(a, ma)), below = dot(b, ma) * inverse;
    const float last = root(dot(b, mb) - below * below, dot(b, mb));
    out.add(inverse * a, last * (b - (below * inverse) * a), {});
    return out;
  }
  const Vec3f x = m.column(0), y = m.column(1), z = m.column(2);
  const float i0 = root(x.x, x.x), l10 = x.y * i0, l20 = x.z * i0;
  const float i1 = root(y.y - l10 * l10, y.y), l21 = (y.z - l20 * l10) * i1;
  const float i2 = root(z.z - l20 * l20 - l21 * l21, z.z);
  // The transposed inverse of the factor.
  const float w01 = -l10 * i0 * i1, w12 = -l21 * i1 * i2, w02 = -(l20 * i0 + l21 * w01) * i2;
  out.add({i0, 0, 0}, {w01, i1, 0}, {w02, w12, i2});
  return out;
}

}  // namespace

void SoftSolver::prepare(const SoftMatrix& matrix) {
  lower_.resize(matrix.lower_.column.size() + 1);
  const bool all = !matrix.far_ahead;
  for (std::size_t p = 0; p < right.size(); ++p) {
    const std::size_t i = std::size_t(matrix.order_[p]);
    scale_[p] = scale_of(diagonal[i] + matrix.blocks[std::size_t(matrix.diagonal_[i])].matrix(), holds[i]);
    const SoftBlock across = scale_transposed_[p] = scale_[p].transposed();
    for (int k = matrix.lower_.first[p]; k < matrix.lower_.last(p, all); ++k) {
      const SoftBlock& other = scale_[matrix.lower_.column[std::size_t(k)]];
      const std::size_t source = std::size_t(matrix.lower_.source[std::size_t(k)]);
      SoftBlock inner;
      if (k < matrix.lower_.far[p]) {
        inner = matrix.blocks[source].times(other);
      } else {
        const float link = matrix.link_scale * matrix.far_value_[source];
        inner = {link * other.x, link * other.y, link * other.z};
      }
      lower_[std::size_t(k)].set(across.times(inner));
    }
  }
}

/// The guess of the free parts times the number that leaves the least error in energy, and the whole residual then.
void SoftSolver::scale_guess(const SoftMatrix& matrix, core::TaskScheduler& scheduler) {
  bool any_free = false, any_held = false;
  for (std::size_t i = 0; i < right.size(); ++i) {
    free_[i] = holds[i].filter(change[i]);
    held_[i].v = change[i].v - free_[i].v;
    any_free = any_free || !free_[i].is_zero();
    any_held = any_held || !held_[i].is_zero();
    residual_[i] = right[i];
  }
  if (any_held) {
    matrix.multiply(held_.data(), image_.data(), scheduler);
    for (std::size_t i = 0; i < right.size(); ++i)
      residual_[i].v -= image_[i].v + lanes(diagonal[i] * held_[i].vector());
  }
  if (!any_free) return;
  matrix.multiply(free_.data(), image_.data(), scheduler);
  double along = 0, energy = 0;
  for (std::size_t i = 0; i < right.size(); ++i) {
    image_[i].v += lanes(diagonal[i] * free_[i].vector());
    along += double(dot(free_[i], residual_[i]));
    energy += double(dot(free_[i], image_[i]));
  }
  const float share = energy > 0 ? float(along / energy) : 0.0f;
  for (std::size_t i = 0; i < right.size(); ++i) {
    change[i].v = held_[i].v + share * free_[i].v;
    residual_[i].v -= share * image_[i].v;
  }
}

/// swept ← (1 + L)⁻¹ Wᵀ from; returns its square.
double SoftSolver::start_sweep(const SoftMatrix& matrix, const std::vector<SoftVector>& from) {
  const bool all = !matrix.far_ahead;
  double size = 0;
  for (std::size_t p = 0; p < swept_.size(); ++p) {
    Lanes sum{};
    for (int k = matrix.lower_.first[p]; k < matrix.lower_.last(p, all); ++k)
      sum += lower_[std::size_t(k)].times(swept_[matrix.lower_.column[std::size_t(k)]].v);
    swept_[p] = scale_transposed_[p].times(from[std::size_t(matrix.order_[p])].v) - sum;
    size += double(dot(swept_[p], swept_[p]));
  }
  return size;
}

void SoftSolver::unscale(const SoftMatrix& matrix, const std::vector<SoftVector>& x,
                         std::vector<SoftVector>& out) const {
  for (std::size_t p = 0; p < x.size(); ++p) out[std::size_t(matrix.order_[p])] = scale_[p].times(x[p].v);
}

int SoftSolver::solve(const SoftMatrix& matrix, double tolerance, float least, int most,
                      core::TaskScheduler& scheduler) {
  const std::size_t n = right.size(), bodies = ties.empty() ? 0 : movers.size();
  prepare(matrix);
  prepare_movers(matrix);
  // Against the right-hand side, not the first residual: a good guess needs fewer iterations. At rest nothing is left
  // to be relative to: a change of `least` for every particle is what does not matter.
  double small = 0;
  for (std::size_t p = 0; p < n; ++p) {
    const Vec3f push = diagonal[std::size_t(matrix.order_[p])] * Vec3f{least, least, least};
    const SoftVector scaled = scale_transposed_[p].times(lanes(push));
    small += double(dot(scaled, scaled));
  }
  double scale = start_sweep(matrix, right);
  if (bodies > 0) {
    right_of_movers(mover_residual_);
    scale += start_movers(matrix, swept_);
  }
  scale = math::max(scale, small);

  scale_guess(matrix, scheduler);
  if (bodies > 0) residual_of_movers(mover_residual_);
  double size = start_sweep(matrix, residual_);
  if (bodies > 0) size += start_movers(matrix, swept_);
  for (std::size_t p = 0; p < n; ++p) direction_[p] = sum_[p] = forward_[p] = {};
  const bool all = !matrix.far_ahead;
  const SoftMatrix::Side& below = matrix.lower_;
  int iterations = 0;
  float keep = 0;
  while (iterations < most && size > tolerance * tolerance * scale && size > 1e-30) {
    // q ← r + β q, t = (1 + Lᵀ)⁻¹ q
    if (bodies > 0) {
      for (std::size_t b = 0; b < bodies; ++b)
        mover_direction_[b] =
            iterations == 0 ? mover_residual_[b] : mover_residual_[b] + double(keep) * mover_direction_[b];
      sweep_up(matrix, mover_direction_, mover_back_);
    }
    // What lies above the diagonal is pushed on from row to row, in `forward_`, which is zero before.
    if (bodies > 0)
      for (std::size_t p = 0; p < n; ++p)
        forward_[p] = scale_transposed_[p].times(pull_[std::size_t(matrix.order_[p])].v);
    for (std::size_t p = n; p-- > 0;) {
      const Lanes towards = swept_[p].v + keep * direction_[p].v, t = towards - forward_[p].v;
      direction_[p] = towards;
      back_[p] = t;
      for (int k = below.first[p]; k < below.last(p, all); ++k)
        forward_[below.column[std::size_t(k)]].v += lower_[std::size_t(k)].transposed_times(t);
    }
    // w = t + u, u = (1 + L)⁻¹ (q − t)
    double curvature = 0;
    for (std::size_t p = 0; p < n; ++p) {
      Lanes sum{};
      for (int k = below.first[p]; k < below.last(p, all); ++k)
        sum += lower_[std::size_t(k)].times(forward_[below.column[std::size_t(k)]].v);
      forward_[p] = direction_[p].v - back_[p].v - sum;
      curvature += double(dot(direction_[p], SoftVector(back_[p].v + forward_[p].v)));
    }
    if (bodies > 0) curvature += finish_movers(matrix);
    ++iterations;
    if (!(curvature > 0)) break;
    const double along = size / curvature;
    const float stride = float(along);
    double next = 0;
    for (std::size_t p = 0; p < n; ++p) {
      sum_[p].v += stride * back_[p].v;
      swept_[p].v -= stride * (back_[p].v + forward_[p].v);
      forward_[p] = {};
      next += double(dot(swept_[p], swept_[p]));
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
  for (std::size_t p = 0; p < n; ++p) change[std::size_t(matrix.order_[p])].v += scale_[p].times(sum_[p].v);
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
  const std::size_t bodies = ties.empty() ? 0 : movers.size();
  bool pinned = false;
  for (std::size_t i = 0; i < right.size(); ++i) pinned |= holds[i].rank == 3;
  if (!pinned) matrix.multiply(change.data(), image_.data(), scheduler);
  for (int pass = 0; pass < 3 && !pinned; ++pass) {
    Vec3f lost{};
    float all = 0;
    for (std::size_t i = 0; i < right.size(); ++i) {
      reaction[i] = right[i].v - image_[i].v - lanes(diagonal[i] * change[i].vector());
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
    for (SoftVector& x : change) x += shift;
    for (std::size_t b = 0; b < bodies; ++b)
      if (movers[b].from != movers[b].to) movers[b].change.linear += Vec3d(shift);
  }
  for (std::size_t i = 0; i < right.size(); ++i) {
    reaction[i] = {};
    if (holds[i].rank == 0) continue;
    const Vec3f given =
        SoftVector(matrix.whole_row(i, change.data())).vector() + diagonal[i] * change[i].vector() - right[i].vector();
    reaction[i] = holds[i].rank == 1 ? dot(holds[i].normal, given) * holds[i].normal : given;
  }
}

}  // namespace carom::particles::detail
