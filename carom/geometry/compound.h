// Several shapes as one, each in its place.
#pragma once

#include "carom/geometry/shape3.h"
#include "carom/geometry/static_tree.h"

namespace carom::geometry {

struct CompoundChild {
  Shape3 shape;       ///< convex
  Transform3f local;  ///< child → compound
};
struct Compound {
  std::vector<CompoundChild> children;
  StaticTree tree;  ///< over the children
};
/// Errors: no child, a child that is not convex or not valid, a transform that is not finite.
CAROM_API core::Result<std::shared_ptr<const Compound>> make_compound(std::vector<CompoundChild> children);

}  // namespace carom::geometry
