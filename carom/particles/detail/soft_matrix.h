// A symmetric matrix of 3×3 blocks by the neighbours of a mesh, and conjugate gradients on it: what implicit steps of
// cloth and of soft bodies solve. The same bits for any number of threads: rows of products are independent, the solver
// itself goes through the rows in their order.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "carom/core/scheduler.h"
#include "carom/math/mat.h"

namespace carom::particles::detail {

using math::Mat3f;
using math::Vec3f;

/// A 3×3 block by columns, each padded to four lanes.
struct SoftBlock {
  typedef float Lanes __attribute__((vector_size(16)));  // NOLINT(modernize-use-using)
  Lanes x{}, y{}, z{};

  void add(Vec3f a, Vec3f b, Vec3f c) {
    x += Lanes{a.x, a.y, a.z, 0};
    y += Lanes{b.x, b.y, b.z, 0};
    z += Lanes{c.x, c.y, c.z, 0};
  }
  void add_diagonal(float d) {
    x[0] += d;
    y[1] += d;
    z[2] += d;
  }
  static SoftBlock of(const Mat3f& m) {
    SoftBlock out;
    out.add(m.column(0), m.column(1), m.column(2));
    return out;
  }
  Lanes times(Lanes v) const { return x * v[0] + y * v[1] + z * v[2]; }
  Mat3f matrix() const { return {{x[0], x[1], x[2]}, {y[0], y[1], y[2]}, {z[0], z[1], z[2]}}; }
};

/// What of a particle's change of velocity is given: nothing, its part along a normal, or all.
struct SoftHold {
  std::uint8_t rank = 0;  ///< 0 free, 1 along `normal`, 3 all
  Vec3f normal{};
  Vec3f filter(Vec3f v) const { return rank == 0 ? v : (rank == 1 ? v - dot(normal, v) * normal : Vec3f{}); }
};

class SoftMatrix {
 public:
  /// Elements of `size` vertices each.
  struct Elements {
    std::span<const std::uint32_t> vertices;
    int size = 3;
  };
  /// A number times the unit matrix that does not change: bending. Both (i, j) and (j, i) are named.
  struct Link {
    std::uint32_t row = 0, column = 0;
    float value = 0;
  };
  /// Blocks for every pair of vertices that share an element. Links between others are kept as numbers; `near` has
  /// those of the blocks, by slot.
  void build(int vertices, std::span<const std::uint32_t> elements, int size, std::span<const Link> links);
  int rows() const { return int(first_.size()) - 1; }
  /// Place of block (i, j); the pair must share an element.
  int slot(std::uint32_t i, std::uint32_t j) const;
  int first(int row) const { return first_[std::size_t(row)]; }
  int diagonal(int row) const { return diagonal_[std::size_t(row)]; }
  std::vector<SoftBlock> blocks;
  std::vector<float> near;  ///< the links' numbers, by slot; whoever fills the blocks adds them
  float link_scale = 1;     ///< times all links that are not in blocks

  /// y = blocks·x
  void multiply(const Vec3f* x, Vec3f* y, core::TaskScheduler& scheduler) const;
  /// Σ (link) (x_j − x_i) over all links of a row, near and far.
  Vec3f pull_of_links(int row, const math::Vec3d* x) const;

 private:
  friend class SoftSolver;
  /// Blocks and links of a row from one side of its diagonal, times x.
  SoftBlock::Lanes side(int from, int to, int far_from, int far_to, const Vec3f* x) const {
    SoftBlock::Lanes sum{}, far{};
    for (int k = from; k < to; ++k) {
      const SoftBlock& block = blocks[std::size_t(k)];
      const Vec3f v = x[column_[std::size_t(k)]];
      sum += block.x * v.x + block.y * v.y + block.z * v.z;
    }
    for (int k = far_from; k < far_to; ++k) {
      const Vec3f v = x[far_column_[std::size_t(k)]];
      far += far_value_[std::size_t(k)] * SoftBlock::Lanes{v.x, v.y, v.z, 0};
    }
    return sum + link_scale * far;
  }
  void find_order();
  std::vector<int> first_, diagonal_;
  std::vector<std::uint32_t> column_;
  std::vector<int> order_;  ///< of a sweep: rows after what they hang on, and beside each other where they are apart
  std::vector<int> far_first_, far_middle_;  ///< links of a row; the first of them above the diagonal
  std::vector<std::uint32_t> far_column_;
  std::vector<float> far_value_;
};

/// A motion of a rigid body: of its centre of mass, and about it.
struct SoftTwist {
  math::Vec3d linear{}, angular{};
  math::Vec3d at(math::Vec3d arm) const { return linear + cross(angular, arm); }
  void push(math::Vec3d arm, math::Vec3d impulse) {
    linear += impulse;
    angular += cross(arm, impulse);
  }
};
inline double dot(const SoftTwist& a, const SoftTwist& b) {
  return math::dot(a.linear, b.linear) + math::dot(a.angular, b.angular);
}
inline SoftTwist operator+(SoftTwist a, const SoftTwist& b) { return {a.linear + b.linear, a.angular + b.angular}; }
inline SoftTwist operator-(SoftTwist a, const SoftTwist& b) { return {a.linear - b.linear, a.angular - b.angular}; }
inline SoftTwist operator*(double s, SoftTwist a) { return {s * a.linear, s * a.angular}; }

/// A rigid body among the unknowns: what it is to the particles that touch it.
struct SoftMover {
  double mass[6][6] = {};  ///< kg, kg m, kg m²; about the centre of mass
  SoftTwist right{};       ///< N·s: what else acts on it in this substep
  SoftTwist change{};      ///< of its velocity; at the start a guess
  int from = 0, to = 0;    ///< its ties
  // Of a solve:
  double full[6][6] = {}, factor[6][6] = {};  ///< its part of the system, and Cholesky's factor of it
};

/// A particle that moves with a body where it is held, and is rubbed by it across `normal`.
struct SoftTie {
  int node = 0, body = 0;
  math::Vec3d arm{};  ///< m, from the body's centre of mass
  Vec3f normal{};
  float grip = 0;  ///< kg: impulse on the body = grip (slip + what the solve changes of it)
  Vec3f slip{};    ///< m/s, before the solve
};

/// (D + K) x = b for particles that are free, b + reaction for those that are held, by conjugate gradients with the
/// holds projected out (Baraff and Witkin 1998, "Large steps in cloth simulation"; Ascher and Boxerman 2003).
/// Preconditioned by a symmetric sweep of block Gauss–Seidel in Eisenstat's form (SIAM J. Sci. Stat. Comput. 2 (1981)
/// 1): an iteration goes through every block once. The bodies that they touch are six unknowns each, after the
/// particles: held particles take their motion over, so that light and heavy ones are as stable as what does not move.
class SoftSolver {
 public:
  std::vector<Mat3f> diagonal;  ///< D, by particle
  std::vector<Vec3f> right;     ///< b, N·s
  std::vector<Vec3f> change;    ///< x, m/s: at the start the held parts and a guess of the free ones
  std::vector<Vec3f> guess;     ///< x of the last solve
  std::vector<SoftHold> holds;
  std::vector<Vec3f> reaction;  ///< (D + K) x − b
  std::vector<SoftMover> movers;
  std::vector<SoftTie> ties;  ///< by body, then by particle

  void resize(std::size_t n);
  /// Takes the forces at the end of the step, −K v, to the right-hand side, and starts from the last solution, nothing
  /// held. What is common to all velocities drops out of K v exactly.
  void begin(const SoftMatrix& matrix, const std::vector<Vec3f>& velocity, core::TaskScheduler& scheduler);
  /// Iterations used. `tolerance` is relative to the right-hand side, or to that of changes of `least` m/s if it is
  /// less.
  int solve(const SoftMatrix& matrix, double tolerance, float least, int most, core::TaskScheduler& scheduler);

 private:
  void prepare(const SoftMatrix& matrix);
  // soft_movers.cpp
  Vec3f carried(const SoftTie& tie, const SoftTwist& motion) const;  ///< of the tie's particle, where it is held
  Vec3f row(const SoftMatrix& matrix, int node, const Vec3f* x) const;
  void prepare_movers(const SoftMatrix& matrix);
  void answer(const SoftMatrix& matrix, const SoftTie& tie, const Vec3f* x, SoftTwist& out) const;
  void right_of_movers(std::vector<SoftTwist>& out) const;
  void residual_of_movers(std::vector<SoftTwist>& out);
  void sweep_down(const SoftMatrix& matrix, const std::vector<Vec3f>& x, std::vector<SoftTwist>& motions);
  void sweep_up(const SoftMatrix& matrix, const std::vector<SoftTwist>& from, std::vector<SoftTwist>& to);
  static SoftTwist times(const double (&m)[6][6], const SoftTwist& x);
  double finish_movers(const SoftMatrix& matrix);  ///< images; their share of the curvature
  double start_movers(const SoftMatrix& matrix, const std::vector<Vec3f>& x);
  void scale_guess(const SoftMatrix& matrix, core::TaskScheduler& scheduler);
  double start_sweep(const SoftMatrix& matrix, std::vector<Vec3f>& x, std::vector<Vec3f>& weighted);
  void settle_momentum(const SoftMatrix& matrix, core::TaskScheduler& scheduler);

  std::vector<Vec3f> residual_, weighted_residual_, direction_, back_, forward_, image_, weighted_image_;
  std::vector<Vec3f> field_, pull_;  ///< of the particles, by the bodies' motion
  std::vector<SoftTwist> mover_residual_, mover_direction_, mover_back_, mover_image_, mover_start_;
  std::vector<SoftBlock> full_, inverse_;  ///< of the diagonal: as it is, and inverted within what is free
};

}  // namespace carom::particles::detail
