// Eigenvalues and axes of symmetric matrices, as needed for principal axes of inertia, stress and ellipsoids.
#pragma once

#include "carom/export.h"
#include "carom/math/mat.h"

namespace carom::math {

/// matrix = vectors · diagonal(values) · vectorsᵀ with ascending values and a right-handed orthonormal set of columns.
struct Eigen3 {
  Vec3d values;
  Mat3d vectors;
};
struct Eigen2 {
  Vec2d values;
  Mat2d vectors;
};

/// Of a symmetric matrix; only the upper triangle is read. Cyclic Jacobi rotations (Golub and Van Loan, Matrix
/// Computations, 4th ed., section 8.5) until the off-diagonal part is rounding error. Each of the first two vectors has
/// its largest component positive, so equal matrices give equal axes; a diagonal matrix gives coordinate axes.
CAROM_API Eigen3 symmetric_eigen(const Mat3d& m);
CAROM_API Eigen2 symmetric_eigen(const Mat2d& m);

}  // namespace carom::math
