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
#include "carom/particles/detail/aligned.h"
#include "carom/particles/detail/soft_tiles.h"

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
  Lanes times(Lanes v) const { return x * v[0] + y * v[1] + z * v[2]; }
  SoftBlock times(const SoftBlock& b) const { return {times(b.x), times(b.y), times(b.z)}; }
  Lanes transposed_times(Lanes v) const {
    const Lanes a = x * v, b = y * v, c = z * v;
    return Lanes{a[0] + a[1] + a[2], b[0] + b[1] + b[2], c[0] + c[1] + c[2], 0};
  }
  Mat3f matrix() const { return {{x[0], x[1], x[2]}, {y[0], y[1], y[2]}, {z[0], z[1], z[2]}}; }
};

inline SoftBlock::Lanes lanes_of(Vec3f v) { return SoftBlock::Lanes{v.x, v.y, v.z, 0}; }

/// Three numbers of a vertex in four lanes: one load.
struct SoftVector {
  SoftBlock::Lanes v{};

  SoftVector() = default;
  SoftVector(SoftBlock::Lanes lanes) : v(lanes) {}  // NOLINT(google-explicit-constructor)
  SoftVector(Vec3f a) : v{a.x, a.y, a.z, 0} {}      // NOLINT(google-explicit-constructor)
  operator Vec3f() const { return vector(); }       // NOLINT(google-explicit-constructor)
  Vec3f vector() const { return {v[0], v[1], v[2]}; }
  bool is_zero() const { return v[0] == 0 && v[1] == 0 && v[2] == 0; }
  SoftVector& operator+=(Vec3f a) {
    v += SoftBlock::Lanes{a.x, a.y, a.z, 0};
    return *this;
  }
  SoftVector& operator-=(Vec3f a) {
    v -= SoftBlock::Lanes{a.x, a.y, a.z, 0};
    return *this;
  }
};
inline float dot(const SoftVector& a, const SoftVector& b) {
  const SoftBlock::Lanes product = a.v * b.v;
  return product[0] + product[1] + product[2];
}

/// What of a particle's change of velocity is given: nothing, its part along a normal, or all.
struct SoftHold {
  std::uint8_t rank = 0;  ///< 0 free, 1 along `normal`, 3 all
  Vec3f normal{};
  Vec3f filter(Vec3f v) const { return rank == 0 ? v : (rank == 1 ? v - dot(normal, v) * normal : Vec3f{}); }
  bool operator==(const SoftHold& other) const = default;
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
  std::uint32_t column(int slot) const { return column_[std::size_t(slot)]; }
  int diagonal(int row) const { return diagonal_[std::size_t(row)]; }
  std::vector<SoftBlock> blocks;
  std::vector<float> near;  ///< the links' numbers, by slot; whoever fills the blocks adds them
  float link_scale = 1;     ///< times all links that are not in blocks
  /// Links that are not in blocks answer to the velocities before a solve and not to what it changes: for those so weak
  /// that an explicit step of them is stable. Whoever fills the blocks adds `far_sum` to the diagonal then, so that
  /// what is common to all changes drops out as before.
  bool far_ahead = false;
  float far_sum(int row) const { return far_sum_[std::size_t(row)]; }
  /// Σ |link| over the links of a row that are not in blocks.
  float far_size(int row) const;

  /// y = blocks·x
  void multiply(const SoftVector* x, SoftVector* y, core::TaskScheduler& scheduler) const;
  /// The same with the links that are ahead.
  void multiply_all(const SoftVector* x, SoftVector* y, core::TaskScheduler& scheduler) const;
  /// Σ (link) (x_j − x_i) over all links of a row, near and far.
  Vec3f pull_of_links(int row, const math::Vec3d* x) const;

 private:
  friend class SoftSolver;
  /// Blocks and links of a row from one side of its diagonal, times x.
  SoftBlock::Lanes side(int from, int to, int far_from, int far_to, const SoftVector* x) const {
    SoftBlock::Lanes sum{}, far{};
    for (int k = from; k < to; ++k) sum += blocks[std::size_t(k)].times(x[column_[std::size_t(k)]].v);
    if (far_ahead) return sum;
    for (int k = far_from; k < far_to; ++k) far += far_value_[std::size_t(k)] * x[far_column_[std::size_t(k)]].v;
    return sum + link_scale * far;
  }
  SoftBlock::Lanes whole_row(std::size_t i, const SoftVector* x) const {
    return side(first_[i], first_[i + 1], far_first_[i], far_first_[i + 1], x);
  }
  void find_tiles();
  std::vector<int> first_, diagonal_;
  std::vector<std::uint32_t> column_;
  SoftTiles tiles_;
  std::vector<int> far_first_, far_middle_;  ///< links of a row; the first of them above the diagonal
  std::vector<std::uint32_t> far_column_;
  std::vector<float> far_value_, far_sum_;
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
/// 1): an iteration goes through every block once. The unknowns are scaled so that the diagonal is the unit matrix
/// within what is free, and lie in the order of the sweep. The bodies that they touch are six unknowns each, after the
/// particles: held particles take their motion over, so that light and heavy ones are as stable as what does not move.
class SoftSolver {
 public:
  std::vector<Mat3f> diagonal;     ///< D, by particle
  std::vector<SoftVector> right;   ///< b, N·s
  std::vector<SoftVector> change;  ///< x, m/s: at the start the held parts and a guess of the free ones
  std::vector<SoftVector> guess;   ///< x of the last solve
  std::vector<Mat3f> met;          ///< by particle, its own part of what contacts with other systems add
  std::vector<SoftHold> holds;
  std::vector<SoftVector> reaction;  ///< (D + K) x − b of what is held
  std::vector<SoftMover> movers;
  std::vector<SoftTie> ties;  ///< by body, then by particle
  std::vector<int> tie_of;    ///< by particle; −1: none

  void set_lanes(int lanes);  ///< 4, 8 or 16, of those that the machine has; 0: as many as it has
  const SoftKernels& kernels() const { return *kernels_; }
  void resize(const SoftMatrix& matrix);
  /// Takes the forces at the end of the step, −K v, to the right-hand side, and starts from the last solution, nothing
  /// held. What is common to all velocities drops out of K v exactly.
  void begin(const SoftMatrix& matrix, const std::vector<Vec3f>& velocity, core::TaskScheduler& scheduler);
  // The parts of `solve_system`, in their order.
  /// `again`: of the same system with other holds. Returns the square of the right-hand side; adds that of changes of
  /// `least` m/s to `small`.
  double open(const SoftMatrix& matrix, float least, bool again, double& small);
  void find_residual(const SoftMatrix& matrix, bool again, core::TaskScheduler& scheduler);
  void add_residual(std::uint32_t node, Vec3f impulse) { residual_[node] += impulse; }
  double begin_iterations(const SoftMatrix& matrix);  ///< the residual's square
  void go_up(const SoftMatrix& matrix, bool first, float keep);
  Vec3f back_at(const SoftMatrix& matrix, std::uint32_t node) const;  ///< the motion that the way up has for it
  /// What contacts with other systems answer to that motion, N·s, until it is cleared; `meets` says whether there is
  /// any.
  void add_answer(const SoftMatrix& matrix, std::uint32_t node, Vec3f impulse);
  void clear_answer(const SoftMatrix& matrix, std::uint32_t node);
  double go_down(const SoftMatrix& matrix);              ///< curvature
  double go_on(const SoftMatrix& matrix, double along);  ///< the residual's square
  void end_iterations(const SoftMatrix& matrix);
  void find_reactions(const SoftMatrix& matrix);
  bool meets = false;
  bool remade = false;  ///< blocks of the matrix have changed since the last solve

  /// After the last solve of a substep: what it left undone gives no momentum.
  void finish(const SoftMatrix& matrix, core::TaskScheduler& scheduler);

 private:
  SoftSweep sweep(const SoftMatrix& matrix);
  void prepare(const SoftMatrix& matrix, bool again);
  // soft_movers.cpp
  Vec3f carried(const SoftTie& tie, const SoftTwist& motion) const;  ///< of the tie's particle, where it is held
  Vec3f own(std::size_t node, Vec3f x) const;
  Vec3f row(const SoftMatrix& matrix, int node, const SoftVector* x) const;
  void prepare_movers(const SoftMatrix& matrix);
  void answer(const SoftMatrix& matrix, const SoftTie& tie, const SoftVector* x, SoftTwist& out) const;
  void right_of_movers(std::vector<SoftTwist>& out) const;
  void residual_of_movers(std::vector<SoftTwist>& out);
  void sweep_down(const SoftMatrix& matrix, std::vector<SoftTwist>& motions);
  void sweep_up(const SoftMatrix& matrix, const std::vector<SoftTwist>& from, std::vector<SoftTwist>& to);
  static SoftTwist times(const double (&m)[6][6], const SoftTwist& x);
  double finish_movers(const SoftMatrix& matrix);  ///< images; their share of the curvature
  double start_movers(const SoftMatrix& matrix);
  void scale_guess(const SoftMatrix& matrix, core::TaskScheduler& scheduler);
  double start_sweep(const SoftMatrix& matrix, const std::vector<SoftVector>& from);
  void unscale(const SoftMatrix& matrix, std::vector<SoftVector>& out) const;
  std::size_t bodies() const { return ties.empty() ? 0 : movers.size(); }

  const SoftKernels* kernels_ = &soft_kernels(4);
  std::vector<SoftVector> residual_, free_, held_, image_;  // by vertex
  std::vector<SoftVector> forward_, from_;                  ///< scaled, by place; what no one hangs on after the last
  AlignedFloats swept_, direction_, back_, sum_, answer_;   ///< scaled, by tile
  std::vector<SoftVector> field_, pull_;                    ///< of the particles, by the bodies' motion
  std::vector<SoftTwist> mover_residual_, mover_direction_, mover_back_, mover_image_, mover_start_, mover_answer_;
  std::vector<SoftBlock> scale_;      ///< W by place, with W Wᵀ the inverse of the diagonal within what is free
  AlignedFloats scale_tiles_;         ///< the same by tile
  AlignedFloats lower_;               ///< Wᵀ K W below the diagonal, by the tiles' entries
  std::vector<SoftHold> scaled_for_;  ///< by particle: what W was made for
  std::vector<std::uint8_t> rescaled_, stale_;  ///< by place, by entry: whether this solve makes it anew
};

}  // namespace carom::particles::detail
