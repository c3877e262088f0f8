// How far a ball is from a shape.
#pragma once

#include "carom/geometry/shape3.h"

namespace carom::particles::detail {

/// The nearest plane of a shape to a ball at `center` (shape's frame) and how far it is, as a contact's manifold tells;
/// false where there is none within `margin`.
bool nearest_plane(const geometry::Shape3& shape, math::Vec3f center, float radius, float margin, math::Vec3f& normal,
                   float& separation);

/// The same, and beside the border of a sharp shape, where a manifold tells nothing yet, too.
bool nearest_surface(const geometry::Shape3& shape, math::Vec3f center, float radius, float margin, math::Vec3f& normal,
                     float& separation);

}  // namespace carom::particles::detail
