// The linear solver of implicit steps: conjugate gradients with a sweep through the matrix's tiles.
#include <algorithm>

#include "carom/math/cpu.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/soft_matrix.h"

namespace carom::particles::detail {

using math::Vec3d;

void SoftSolver::set_lanes(int lanes) {
  const math::InstructionSet set =
      lanes == 0 ? math::detect_instruction_set() : math::choose_instruction_set(math::instruction_set_of_width(lanes));
  kernels_ = &soft_kernels(math::simd_width(set));
}

void SoftSolver::resize(const SoftMatrix& matrix) {
  const std::size_t n = std::size_t(matrix.rows()), tiles = std::size_t(matrix.tiles_.count);
  for (auto* list : {&right, &change, &guess, &reaction, &residual_, &free_, &held_, &image_, &field_, &pull_})
    list->resize(n);
  diagonal.resize(n);
  met.resize(n);
  tie_of.assign(n, -1);
  holds.resize(n);
  for (auto* list : {&forward_, &from_}) list->assign((tiles + 1) * soft_lanes, SoftVector{});
  for (auto* list : {&swept_, &direction_, &back_, &sum_, &answer_}) *list = AlignedFloats(tiles * soft_vector);
  scale_.assign((tiles + 1) * soft_lanes, SoftBlock{});
  scale_tiles_ = AlignedFloats(tiles * soft_block);
  lower_ = AlignedFloats(matrix.tiles_.column.size() * 9);
  scaled_for_.resize(n);
  rescaled_.assign((tiles + 1) * soft_lanes, 0);
  stale_.resize(matrix.tiles_.column.size() / soft_lanes);
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

SoftSweep SoftSolver::sweep(const SoftMatrix& matrix) {
  const SoftTiles& tiles = matrix.tiles_;
  SoftSweep sweep;
  sweep.tiles = tiles.count;
  sweep.first = tiles.first.data();
  sweep.last = matrix.far_ahead ? tiles.far.data() : tiles.first.data() + 1;
  sweep.column = tiles.column.data();
  sweep.lower = lower_.data();
  sweep.scale = scale_tiles_.data();
  sweep.swept = swept_.data();
  sweep.direction = direction_.data();
  sweep.back = back_.data();
  sweep.sum = sum_.data();
  sweep.forward = reinterpret_cast<float*>(forward_.data());
  sweep.answer = meets ? answer_.data() : nullptr;
  return sweep;
}

/// `again`: what has the hold of the last solve stays as it is, and with it most of the matrix.
void SoftSolver::prepare(const SoftMatrix& matrix, bool again) {
  const SoftTiles& tiles = matrix.tiles_;
  for (std::size_t p = 0; p < tiles.row.size(); ++p) {
    if (tiles.row[p] < 0) continue;
    const std::size_t i = std::size_t(tiles.row[p]);
    rescaled_[p] = !again || !(holds[i] == scaled_for_[i]);
    if (rescaled_[p] == 0) continue;
    scaled_for_[i] = holds[i];
    Mat3f own = diagonal[i] + matrix.blocks[std::size_t(matrix.diagonal_[i])].matrix();
    if (meets) own = own + met[i];
    const SoftBlock scale = scale_[p] = scale_of(own, holds[i]);
    float* const out = &scale_tiles_[p / soft_lanes * soft_block + p % soft_lanes];
    for (int k = 0; k < 3; ++k) {
      out[k * soft_lanes] = scale.x[k];
      out[(3 + k) * soft_lanes] = scale.y[k];
      out[(6 + k) * soft_lanes] = scale.z[k];
    }
  }
  if (!again) std::fill(stale_.begin(), stale_.end(), std::uint8_t{1});
  for (std::size_t tile = 0; again && tile < std::size_t(tiles.count); ++tile) {
    std::uint8_t own = 0;
    for (std::size_t lane = 0; lane < soft_lanes; ++lane) own |= rescaled_[tile * soft_lanes + lane];
    for (int entry = tiles.first[tile]; entry < tiles.first[tile + 1]; ++entry) {
      std::uint8_t any = own;
      const int* const column = &tiles.column[std::size_t(entry) * soft_lanes];
      for (std::size_t lane = 0; lane < soft_lanes; ++lane) any |= rescaled_[std::size_t(column[lane])];
      stale_[std::size_t(entry)] = any;
    }
  }
  SoftEntries entries;
  entries.stale = stale_.data();
  entries.far = tiles.far.data();
  entries.source = tiles.source.data();
  entries.scale = reinterpret_cast<const float*>(scale_.data());
  entries.blocks = reinterpret_cast<const float*>(matrix.blocks.data());
  entries.links = matrix.far_value_.data();
  entries.link_scale = matrix.link_scale;
  kernels_->fill(sweep(matrix), entries);
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
      residual_[i].v -= image_[i].v + lanes_of(diagonal[i] * held_[i].vector());
  }
  if (!any_free) return;
  matrix.multiply(free_.data(), image_.data(), scheduler);
  double along = 0, energy = 0;
  for (std::size_t i = 0; i < right.size(); ++i) {
    image_[i].v += lanes_of(diagonal[i] * free_[i].vector());
    along += double(dot(free_[i], residual_[i]));
    energy += double(dot(free_[i], image_[i]));
  }
  const float share = energy > 0 ? float(along / energy) : 0.0f;
  for (std::size_t i = 0; i < right.size(); ++i) {
    change[i].v = held_[i].v + share * free_[i].v;
    residual_[i].v -= share * image_[i].v;
  }
}

/// swept, forward ← (1 + L)⁻¹ Wᵀ from; returns its square.
double SoftSolver::start_sweep(const SoftMatrix& matrix, const std::vector<SoftVector>& from) {
  const std::vector<int>& row = matrix.tiles_.row;
  for (std::size_t p = 0; p < row.size(); ++p)
    if (row[p] >= 0) from_[p] = from[std::size_t(row[p])];
  return kernels_->start(sweep(matrix), reinterpret_cast<const float*>(from_.data()));
}

/// What `forward_` holds, by vertex.
void SoftSolver::unscale(const SoftMatrix& matrix, std::vector<SoftVector>& out) const {
  const std::vector<int>& row = matrix.tiles_.row;
  for (std::size_t p = 0; p < row.size(); ++p)
    if (row[p] >= 0) out[std::size_t(row[p])] = scale_[p].times(forward_[p].v);
}

double SoftSolver::open(const SoftMatrix& matrix, float least, bool again, double& small) {
  const std::vector<int>& row = matrix.tiles_.row;
  prepare(matrix, again && !remade);
  remade = false;
  prepare_movers(matrix);
  for (std::size_t p = 0; p < row.size(); ++p) {
    if (row[p] < 0) continue;
    const SoftVector scaled =
        scale_[p].transposed_times(lanes_of(diagonal[std::size_t(row[p])] * Vec3f{least, least, least}));
    small += double(dot(scaled, scaled));
  }
  double scale = start_sweep(matrix, right);
  if (bodies() > 0) {
    right_of_movers(mover_residual_);
    scale += start_movers(matrix);
  }
  return scale;
}

void SoftSolver::find_residual(const SoftMatrix& matrix, bool again, core::TaskScheduler& scheduler) {
  if (!again) return scale_guess(matrix, scheduler);
  matrix.multiply(change.data(), image_.data(), scheduler);
  for (std::size_t i = 0; i < right.size(); ++i)
    residual_[i].v = right[i].v - image_[i].v - lanes_of(diagonal[i] * change[i].vector());
}

double SoftSolver::begin_iterations(const SoftMatrix& matrix) {
  if (bodies() > 0) residual_of_movers(mover_residual_);
  double size = start_sweep(matrix, residual_);
  if (bodies() > 0) size += start_movers(matrix);
  for (SoftVector& v : forward_) v = {};
  for (auto* list : {&direction_, &sum_}) std::fill_n(list->data(), list->size(), 0.0f);
  return size;
}

// q ← r + β q, t = (1 + Lᵀ)⁻¹ q
void SoftSolver::go_up(const SoftMatrix& matrix, bool first, float keep) {
  if (bodies() > 0) {
    const std::vector<int>& row = matrix.tiles_.row;
    for (std::size_t b = 0; b < bodies(); ++b)
      mover_direction_[b] = first ? mover_residual_[b] : mover_residual_[b] + double(keep) * mover_direction_[b];
    sweep_up(matrix, mover_direction_, mover_back_);
    for (std::size_t p = 0; p < row.size(); ++p)
      if (row[p] >= 0) forward_[p] = scale_[p].transposed_times(pull_[std::size_t(row[p])].v);
  }
  kernels_->up(sweep(matrix), keep);
}

// w = t + u, u = (1 + L)⁻¹ (q − t + what contacts with other systems answer to t)
double SoftSolver::go_down(const SoftMatrix& matrix) {
  double curvature = kernels_->down(sweep(matrix));
  if (bodies() > 0) curvature += finish_movers(matrix);
  return curvature;
}

double SoftSolver::go_on(const SoftMatrix& matrix, double along) {
  double next = kernels_->go(sweep(matrix), float(along));
  for (std::size_t b = 0; b < bodies(); ++b) {
    if (movers[b].from == movers[b].to) continue;
    movers[b].change = movers[b].change + along * mover_back_[b];
    mover_residual_[b] = mover_residual_[b] - along * mover_image_[b];
    next += dot(mover_residual_[b], times(movers[b].full, mover_residual_[b]));
  }
  return next;
}

void SoftSolver::end_iterations(const SoftMatrix& matrix) {
  const std::vector<int>& row = matrix.tiles_.row;
  for (std::size_t p = 0; p < row.size(); ++p) {
    if (row[p] < 0) continue;
    const float* const sum = &sum_[p / soft_lanes * soft_vector + p % soft_lanes];
    change[std::size_t(row[p])].v += scale_[p].times(SoftBlock::Lanes{sum[0], sum[soft_lanes], sum[2 * soft_lanes], 0});
  }
  if (bodies() > 0)
    for (const SoftTie& tie : ties)
      change[std::size_t(tie.node)] +=
          carried(tie, movers[std::size_t(tie.body)].change - mover_start_[std::size_t(tie.body)]);
}

Vec3f SoftSolver::back_at(const SoftMatrix& matrix, std::uint32_t node) const {
  const std::size_t p = std::size_t(matrix.tiles_.place[node]);
  const float* const t = back_.data() + p / soft_lanes * soft_vector + p % soft_lanes;
  Vec3f motion = SoftVector(scale_[p].times(SoftBlock::Lanes{t[0], t[soft_lanes], t[2 * soft_lanes], 0}));
  if (const int k = tie_of[node]; k >= 0) {
    const SoftTie& tie = ties[std::size_t(k)];
    motion += carried(tie, mover_back_[std::size_t(tie.body)]);
  }
  return motion;
}

void SoftSolver::add_answer(const SoftMatrix& matrix, std::uint32_t node, Vec3f impulse) {
  const std::size_t p = std::size_t(matrix.tiles_.place[node]);
  float* const out = &answer_[p / soft_lanes * soft_vector + p % soft_lanes];
  const Vec3f scaled = SoftVector(scale_[p].transposed_times(lanes_of(impulse)));
  for (int k = 0; k < 3; ++k) out[k * soft_lanes] += scaled[k];
  if (const int k = tie_of[node]; k >= 0 && holds[node].rank != 0) {
    const SoftTie& tie = ties[std::size_t(k)];
    mover_answer_[std::size_t(tie.body)].push(tie.arm, Vec3d(impulse - holds[node].filter(impulse)));
  }
}

void SoftSolver::clear_answer(const SoftMatrix& matrix, std::uint32_t node) {
  const std::size_t p = std::size_t(matrix.tiles_.place[node]);
  float* const out = &answer_[p / soft_lanes * soft_vector + p % soft_lanes];
  for (int k = 0; k < 3; ++k) out[k * soft_lanes] = 0;
  if (const int k = tie_of[node]; k >= 0) mover_answer_[std::size_t(ties[std::size_t(k)].body)] = {};
}

/// What the holds had to give.
void SoftSolver::find_reactions(const SoftMatrix& matrix) {
  for (std::size_t i = 0; i < right.size(); ++i) {
    reaction[i] = {};
    if (holds[i].rank == 0) continue;
    const Vec3f given =
        SoftVector(matrix.whole_row(i, change.data())).vector() + diagonal[i] * change[i].vector() - right[i].vector();
    reaction[i] = holds[i].rank == 1 ? dot(holds[i].normal, given) * holds[i].normal : given;
  }
}

/// What is left of the residual would be momentum out of nothing: where nothing is pinned, all that is free takes it as
/// a shift of the whole, which the elements do not feel.
void SoftSolver::finish(const SoftMatrix& matrix, core::TaskScheduler& scheduler) {
  bool pinned = false;
  for (std::size_t i = 0; i < right.size(); ++i) pinned |= holds[i].rank == 3;
  if (!pinned) matrix.multiply(change.data(), image_.data(), scheduler);
  for (int pass = 0; pass < 3 && !pinned; ++pass) {
    Vec3d lost{};
    double all = 0;
    for (std::size_t i = 0; i < right.size(); ++i) {
      reaction[i] = right[i].v - image_[i].v - lanes_of(diagonal[i] * change[i].vector());
      all += double((1.0f / 3) * trace(diagonal[i]));
    }
    if (bodies() > 0)  // which go along with the shift, so that nothing rubs more
      for (const SoftTie& tie : ties) {
        if (!(tie.grip > 0)) continue;
        all -= double((2.0f / 3) * tie.grip);
        const Vec3f body(movers[std::size_t(tie.body)].change.at(tie.arm));
        reaction[std::size_t(tie.node)] += tie.grip * (body - dot(tie.normal, body) * tie.normal);
      }
    for (std::size_t i = 0; i < right.size(); ++i) lost += Vec3d(holds[i].filter(reaction[i]));
    if (!(all > 0)) break;
    const Vec3f shift(lost / all);
    for (SoftVector& x : change) x += shift;
    for (std::size_t b = 0; b < bodies(); ++b)
      if (movers[b].from != movers[b].to) movers[b].change.linear += Vec3d(shift);
  }
  if (!pinned) find_reactions(matrix);
  guess = change;
}

}  // namespace carom::particles::detail
