#include "carom/geometry/compound.h"

#include "carom/geometry/detail/text.h"

namespace carom::geometry {

core::Result<std::shared_ptr<const Compound>> make_compound(std::vector<CompoundChild> children) {
  if (children.empty()) return detail::error("make_compound: no children, expected at least one");
  std::vector<Bounds3f> boxes;
  boxes.reserve(children.size());
  for (std::size_t i = 0; i < children.size(); ++i) {
    CompoundChild& child = children[i];
    if (!is_convex(child.shape))
      return detail::error(
          "make_compound: child %zu is a plane, mesh, height field or compound, expected a convex shape", i);
    if (auto s = validate(child.shape); !s)
      return detail::error("make_compound: child %zu: %s", i, s.error().message.c_str());
    if (auto s = detail::check_point("its position", child.local.p, max_shape_size); !s)
      return detail::error("make_compound: child %zu: %s", i, s.error().message.c_str());
    const float norm = length(child.local.q);
    if (!(abs(norm - 1) < 1e-3f))
      return detail::error("make_compound: child %zu: its rotation has length %g, expected a unit quaternion", i,
                           double(norm));
    child.local.q = normalize(child.local.q);
    boxes.push_back(bounds(child.shape, child.local));
  }
  auto compound = std::make_shared<Compound>();
  compound->children = std::move(children);
  compound->tree = build_static_tree(boxes);
  return std::shared_ptr<const Compound>(std::move(compound));
}

}  // namespace carom::geometry
