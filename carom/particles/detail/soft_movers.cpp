// Rigid bodies among the unknowns of cloth and soft bodies: their rows, and their part of the sweeps.
#include "carom/math/elementary.h"
#include "carom/particles/detail/soft_matrix.h"

namespace carom::particles::detail {

using math::Vec3d;

namespace {

double part(const SoftTwist& t, int k) { return k < 3 ? t.linear[k] : t.angular[k - 3]; }
void set_part(SoftTwist& t, int k, double value) { (k < 3 ? t.linear[k] : t.angular[k - 3]) = value; }

void factorize(const double (&m)[6][6], double (&l)[6][6]) {
  for (int j = 0; j < 6; ++j)
    for (int i = j; i < 6; ++i) {
      double sum = m[i][j];
      for (int k = 0; k < j; ++k) sum -= l[i][k] * l[j][k];
      l[i][j] = i == j ? math::sqrt(math::max(sum, 1e-12 * m[j][j])) : sum / l[j][j];
    }
}

SoftTwist solve_factor(const double (&l)[6][6], const SoftTwist& right) {
  SoftTwist x;
  for (int i = 0; i < 6; ++i) {
    double sum = part(right, i);
    for (int k = 0; k < i; ++k) sum -= l[i][k] * part(x, k);
    set_part(x, i, sum / l[i][i]);
  }
  for (int i = 6; i-- > 0;) {
    double sum = part(x, i);
    for (int k = i + 1; k < 6; ++k) sum -= l[k][i] * part(x, k);
    set_part(x, i, sum / l[i][i]);
  }
  return x;
}

}  // namespace

SoftTwist SoftSolver::times(const double (&m)[6][6], const SoftTwist& x) {
  SoftTwist out;
  for (int i = 0; i < 6; ++i) {
    double sum = 0;
    for (int k = 0; k < 6; ++k) sum += m[i][k] * part(x, k);
    set_part(out, i, sum);
  }
  return out;
}

Vec3f SoftSolver::carried(const SoftTie& tie, const SoftTwist& motion) const {
  const SoftHold& hold = holds[std::size_t(tie.node)];
  if (hold.rank == 0) return {};
  const Vec3f v(motion.at(tie.arm));
  return hold.rank == 3 ? v : dot(hold.normal, v) * hold.normal;
}

/// Of D, with what contacts with other systems add to it.
Vec3f SoftSolver::own(std::size_t node, Vec3f x) const {
  return meets ? diagonal[node] * x + met[node] * x : diagonal[node] * x;
}

/// Row of D + K times x.
Vec3f SoftSolver::row(const SoftMatrix& matrix, int node, const SoftVector* x) const {
  const std::size_t i = std::size_t(node);
  return SoftVector(matrix.whole_row(i, x)).vector() + own(i, x[i].vector());
}

/// Adds what a body has to give by a tie for a motion x of the particles.
void SoftSolver::answer(const SoftMatrix& matrix, const SoftTie& tie, const SoftVector* x, SoftTwist& out) const {
  const SoftHold& hold = holds[std::size_t(tie.node)];
  Vec3f impulse{};
  if (hold.rank != 0) {
    const Vec3f whole = row(matrix, tie.node, x);
    impulse = whole - hold.filter(whole);
  }
  if (tie.grip > 0) {
    const Vec3f v = x[tie.node];
    impulse -= tie.grip * (v - dot(tie.normal, v) * tie.normal);
  }
  out.push(tie.arm, Vec3d(impulse));
}

void SoftSolver::prepare_movers(const SoftMatrix& matrix) {
  if (ties.empty()) return;
  for (auto* list : {&mover_residual_, &mover_direction_, &mover_back_, &mover_image_, &mover_start_, &mover_answer_})
    list->resize(movers.size());
  for (SoftTwist& answer : mover_answer_) answer = {};
  for (SoftVector& v : field_) v = {};
  for (std::size_t b = 0; b < movers.size(); ++b) {
    SoftMover& mover = movers[b];
    mover_start_[b] = mover.change;
    if (mover.from == mover.to) {
      for (int i = 0; i < 6; ++i)
        for (int k = 0; k < 6; ++k) mover.full[i][k] = i == k ? 1 : 0;
      factorize(mover.full, mover.factor);
      continue;
    }
    for (int column = 0; column < 6; ++column) {
      SoftTwist unit, out;
      set_part(unit, column, 1);
      for (int k = mover.from; k < mover.to; ++k)
        field_[std::size_t(ties[std::size_t(k)].node)] = carried(ties[std::size_t(k)], unit);
      for (int k = mover.from; k < mover.to; ++k) {
        const SoftTie& tie = ties[std::size_t(k)];
        // What is carried lies along the normal: only the body's own motion rubs.
        if (holds[std::size_t(tie.node)].rank != 0) {
          const Vec3f whole = row(matrix, tie.node, field_.data());
          out.push(tie.arm, Vec3d(whole - holds[std::size_t(tie.node)].filter(whole)));
        }
        if (tie.grip > 0) {
          const Vec3f v(unit.at(tie.arm));
          out.push(tie.arm, Vec3d(tie.grip * (v - dot(tie.normal, v) * tie.normal)));
        }
      }
      for (int i = 0; i < 6; ++i) mover.full[i][column] = mover.mass[i][column] + part(out, i);
    }
    for (int k = mover.from; k < mover.to; ++k) field_[std::size_t(ties[std::size_t(k)].node)] = {};
    for (int i = 0; i < 6; ++i)  // symmetric but for rounding
      for (int k = 0; k < i; ++k) mover.full[i][k] = mover.full[k][i] = 0.5 * (mover.full[i][k] + mover.full[k][i]);
    factorize(mover.full, mover.factor);
  }
  for (const SoftTie& tie : ties) change[std::size_t(tie.node)] += carried(tie, movers[std::size_t(tie.body)].change);
}

void SoftSolver::right_of_movers(std::vector<SoftTwist>& out) const {
  for (std::size_t b = 0; b < movers.size(); ++b) {
    out[b] = {};
    if (movers[b].from == movers[b].to) continue;
    out[b] = movers[b].right;
    for (int k = movers[b].from; k < movers[b].to; ++k) {
      const SoftTie& tie = ties[std::size_t(k)];
      const Vec3f given = right[std::size_t(tie.node)];
      out[b].push(tie.arm, Vec3d(given - holds[std::size_t(tie.node)].filter(given)) + Vec3d(tie.grip * tie.slip));
    }
  }
}

/// From the particles' whole residual in `residual_`, which takes the bodies' rubbing in, and the present changes.
void SoftSolver::residual_of_movers(std::vector<SoftTwist>& out) {
  for (std::size_t b = 0; b < movers.size(); ++b) {
    const SoftMover& mover = movers[b];
    out[b] = {};
    if (mover.from == mover.to) continue;
    out[b] = mover.right - times(mover.mass, mover.change);
    for (int k = mover.from; k < mover.to; ++k) {
      const SoftTie& tie = ties[std::size_t(k)];
      const std::size_t i = std::size_t(tie.node);
      const Vec3f whole = residual_[i];
      Vec3f impulse = whole - holds[i].filter(whole);
      if (tie.grip > 0) {
        const Vec3f body(mover.change.at(tie.arm)), v = change[i].vector() - body;
        impulse += tie.grip * (tie.slip + v - dot(tie.normal, v) * tie.normal);
        residual_[i] += tie.grip * (body - dot(tie.normal, body) * tie.normal);
      }
      out[b].push(tie.arm, Vec3d(impulse));
    }
  }
}

/// motions ← (D + L)⁻¹ motions for the bodies, after the particles' in `forward_`.
void SoftSolver::sweep_down(const SoftMatrix& matrix, std::vector<SoftTwist>& motions) {
  unscale(matrix, field_);
  for (std::size_t b = 0; b < movers.size(); ++b) {
    const SoftMover& mover = movers[b];
    if (mover.from == mover.to) {
      motions[b] = {};
      continue;
    }
    SoftTwist lower;
    for (int k = mover.from; k < mover.to; ++k) answer(matrix, ties[std::size_t(k)], field_.data(), lower);
    motions[b] = solve_factor(mover.factor, motions[b] - lower);
    for (int k = mover.from; k < mover.to; ++k)
      field_[std::size_t(ties[std::size_t(k)].node)] += carried(ties[std::size_t(k)], motions[b]);
  }
}

/// to ← (D + Lᵀ)⁻¹ D from; `pull_` is what that motion is in the rows of the particles.
void SoftSolver::sweep_up(const SoftMatrix& matrix, const std::vector<SoftTwist>& from, std::vector<SoftTwist>& to) {
  for (std::size_t i = 0; i < field_.size(); ++i) field_[i] = pull_[i] = {};
  for (std::size_t b = movers.size(); b-- > 0;) {
    const SoftMover& mover = movers[b];
    to[b] = {};
    if (mover.from == mover.to) continue;
    SoftTwist upper;
    for (int k = mover.from; k < mover.to; ++k) {
      const SoftTie& tie = ties[std::size_t(k)];
      const SoftHold& hold = holds[std::size_t(tie.node)];
      if (hold.rank == 0) continue;
      const Vec3f whole = row(matrix, tie.node, field_.data());
      upper.push(tie.arm, Vec3d(whole - hold.filter(whole)));
    }
    to[b] = from[b] - solve_factor(mover.factor, upper);
    for (int k = mover.from; k < mover.to; ++k)
      field_[std::size_t(ties[std::size_t(k)].node)] = carried(ties[std::size_t(k)], to[b]);
  }
  for (const SoftTie& tie : ties) {
    const std::size_t i = std::size_t(tie.node);
    if (tie.grip > 0) {
      const Vec3f body(to[std::size_t(tie.body)].at(tie.arm));
      pull_[i] -= tie.grip * (body - dot(tie.normal, body) * tie.normal);
    }
    if (holds[i].rank == 0) continue;
    const Vec3f v = field_[i];
    const SoftBlock::Lanes wide = field_[i].v;
    const auto sum = [](SoftBlock::Lanes l) { return l[0] + l[1] + l[2]; };
    for (int k = matrix.first_[i]; k < matrix.first_[i + 1]; ++k) {
      const SoftBlock& block = matrix.blocks[std::size_t(k)];
      pull_[matrix.column_[std::size_t(k)]] += Vec3f{sum(block.x * wide), sum(block.y * wide), sum(block.z * wide)};
    }
    for (int k = matrix.far_first_[i]; k < matrix.far_first_[i + 1] && !matrix.far_ahead; ++k)
      pull_[matrix.far_column_[std::size_t(k)]] += (matrix.link_scale * matrix.far_value_[std::size_t(k)]) * v;
    pull_[i] += own(i, v);
  }
}

double SoftSolver::start_movers(const SoftMatrix& matrix) {
  sweep_down(matrix, mover_residual_);
  double size = 0;
  for (std::size_t b = 0; b < movers.size(); ++b)
    size += dot(mover_residual_[b], times(movers[b].full, mover_residual_[b]));
  return size;
}

double SoftSolver::finish_movers(const SoftMatrix& matrix) {
  // u = (D + L)⁻¹ (D (q − t) + answer): D's product is undone by the sweep's division but for what lies below.
  unscale(matrix, field_);
  double curvature = 0;
  for (std::size_t b = 0; b < movers.size(); ++b) {
    const SoftMover& mover = movers[b];
    mover_image_[b] = {};
    if (mover.from == mover.to) continue;
    SoftTwist lower;
    for (int k = mover.from; k < mover.to; ++k) answer(matrix, ties[std::size_t(k)], field_.data(), lower);
    const SoftTwist u = mover_direction_[b] - mover_back_[b] + solve_factor(mover.factor, mover_answer_[b] - lower);
    for (int k = mover.from; k < mover.to; ++k)
      field_[std::size_t(ties[std::size_t(k)].node)] += carried(ties[std::size_t(k)], u);
    mover_image_[b] = mover_back_[b] + u;
    curvature += dot(mover_direction_[b], times(mover.full, mover_image_[b]));
  }
  return curvature;
}

}  // namespace carom::particles::detail
