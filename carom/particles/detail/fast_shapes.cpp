#include "carom/particles/detail/fast_shapes.h"

#include "carom/geometry/shape3.h"
#include "carom/math/elementary.h"
#include "carom/math/quat.h"

namespace carom::particles::detail {

using math::Quatd;
using math::Vec3d;
using math::Vec3f;

geometry::Bounds3d way_of(const rigid::BodyState<rigid::Dim3>& state, const geometry::Bounds3f& tight, double dt,
                          double slack) {
  const Vec3d center = state.center_of_mass, way = dt * Vec3d(state.linear_velocity);
  const bool turns = length(state.angular_velocity) > 0;
  const Vec3d from = state.pose.position - center;
  const Vec3f extents = tight.extents();
  const double outer = length(Vec3d(extents));
  const Vec3d middle = from + rotate(Quatd(state.pose.rotation), Vec3d(tight.center()));
  const double reach = outer + (turns ? length(middle) : 0);
  const Vec3d at = turns ? center : center + middle;
  return grow(geometry::Bounds3d{min(at, at + way), max(at, at + way)}, reach + slack);
}

void find_fast_shapes(const rigid::World3& world, double dt, std::vector<rigid::BodyId>& bodies,
                      std::vector<rigid::ShapeId>& of_body, std::vector<FastShape>& found) {
  found.clear();
  world.fast_bodies(float(usual_body), bodies);
  const double slack = 0.5 * dt * dt * length(Vec3d(world.definition().gravity));
  for (const rigid::BodyId id : bodies) {
    const auto state = world.state(id);
    if (!state) continue;
    world.shapes(id, of_body);
    for (const rigid::ShapeId shape : of_body) {
      const auto definition = world.shape_definition(shape);
      const auto geometry = world.shape_geometry(shape);
      if (!definition || !geometry || definition->sensor) continue;
      found.push_back({shape, way_of(*state, geometry::bounds(*geometry, definition->local), dt, slack)});
    }
  }
}

}  // namespace carom::particles::detail
