// A symmetric matrix of 3×3 blocks by the neighbours of a mesh, and conjugate gradients on it: what implicit steps of
// cloth and of soft bodies solve. The same bits for any number of threads: rows are independent, and sums of products
// are taken by chunks of a fixed size in their order.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
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
  /// Blocks for every pair of vertices that share an element.
  void build(int vertices, std::initializer_list<Elements> kinds);
  int rows() const { return int(first_.size()) - 1; }
  /// Place of block (i, j); the pair must share an element.
  int slot(std::uint32_t i, std::uint32_t j) const;
  int first(int row) const { return first_[std::size_t(row)]; }
  std::vector<SoftBlock> blocks;

  /// y = blocks·x
  void multiply(const Vec3f* x, Vec3f* y, core::TaskScheduler& scheduler) const;
  std::size_t column(int slot) const { return column_[std::size_t(slot)]; }

 private:
  std::vector<int> first_;
  std::vector<std::uint32_t> column_;
};

/// (D + K) x = b for particles that are free, b + reaction for those that are held, by preconditioned conjugate
/// gradients with the holds projected out (Baraff and Witkin 1998, "Large steps in cloth simulation"; Ascher and
/// Boxerman 2003).
class SoftSolver {
 public:
  std::vector<Mat3f> diagonal;  ///< D, by particle
  std::vector<Vec3f> right;     ///< b, N·s
  std::vector<Vec3f> change;    ///< x, m/s: at the start the held parts and a guess of the free ones
  std::vector<SoftHold> holds;
  std::vector<Vec3f> reaction;  ///< (D + K) x − b

  void resize(std::size_t n);
  /// Iterations used. `tolerance` is relative to the right-hand side, or to that of changes of `least` m/s if it is
  /// less.
  int solve(const SoftMatrix& matrix, double tolerance, float least, int most, core::TaskScheduler& scheduler);

 private:
  double product(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b, core::TaskScheduler& scheduler);
  std::vector<Vec3f> residual_, direction_, image_, scaled_;
  std::vector<Mat3f> inverse_;
  std::vector<double> sums_;
};

}  // namespace carom::particles::detail
