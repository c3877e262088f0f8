// Points of the curves of path joints, for those who draw them or set bodies on them.
#pragma once

#include "carom/rigid/definitions.h"

namespace carom::rigid {

/// The point of a path at u, in frame A: at points[i] for u = i, in between along the curve; u goes from 0 to the
/// number of pieces (points − 1, or points where it is closed). Before and beyond it runs straight on. A path without
/// points gives zero.
template <class D>
CAROM_API typename D::Vector path_point(const PathJointDef<D>& path, float u);

extern template CAROM_API math::Vec2f path_point(const PathJointDef<Dim2>&, float);
extern template CAROM_API math::Vec3f path_point(const PathJointDef<Dim3>&, float);

}  // namespace carom::rigid
