#include "carom/geometry/mass_properties.h"
#include "carom/math/eigen.h"
#include "carom/math/rotation.h"

namespace carom::geometry {

PrincipalAxes principal_axes(const Mat3d& inertia) {
  const Eigen3 e = symmetric_eigen(inertia);
  return {e.values, from_matrix(e.vectors)};
}

}  // namespace carom::geometry
