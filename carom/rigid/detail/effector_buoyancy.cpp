// Bodies in water: for every shape the wet volume and its centre, by carom/forces, in the shape's own frame.
#include "carom/environment/water.h"
#include "carom/forces/buoyancy.h"
#include "carom/geometry/compound.h"
#include "carom/geometry/hull.h"
#include "carom/geometry/triangle_mesh.h"
#include "carom/rigid/detail/effector_act.h"

namespace carom::rigid::detail {
namespace {

/// The surface near a point: through `point` with `normal`, and how the water moves there.
template <class D>
struct LocalWater {
  typename D::Position point{}, normal{}, velocity{};
};

template <class D>
LocalWater<D> water_near(const WorldImplementation<D>& world, const Buoyancy<D>& def, typename D::Position p,
                         double time) {
  LocalWater<D> out;
  environment::Wave waves[4];
  for (int i = 0; i < def.wave_count; ++i)
    waves[i] = {def.waves[i].amplitude, def.waves[i].wavelength, def.waves[i].phase, 1, 0};
  environment::Water water;
  water.level = def.level;
  water.waves = {waves, std::size_t(def.wave_count)};
  water.density = def.density;
  const double g = math::length(typename D::Position(world.definition.gravity));
  if (g > 0) water.gravity = g;
  Vec3d at{p.x, p.y, 0};
  if constexpr (D::dimension == 3) at.z = p.z;
  const environment::WaterPoint sample = environment::sample(water, at, time);
  out.point = p;
  out.point.y = sample.height;
  if constexpr (D::dimension == 3) {
    out.normal = sample.normal;
    out.velocity = sample.velocity;
  } else {
    out.normal = normalize(Vec2d{sample.normal.x, sample.normal.y});
    out.velocity = {sample.velocity.x, sample.velocity.y};
  }
  out.velocity += typename D::Position(def.current);
  return out;
}

forces::Submerged2 wet_part(EffectorStore<Dim2>&, const geometry::Shape2& shape, const forces::WaterLine& water) {
  using geometry::ShapeType2;
  switch (shape.type) {
    case ShapeType2::circle: {
      const Vec2d center{};
      return forces::submerged({&center, 1}, double(shape.circle.radius), water);
    }
    case ShapeType2::capsule: {
      const double l = double(shape.capsule.half_length);
      const Vec2d ends[2] = {{0, -l}, {0, l}};
      return forces::submerged(ends, double(shape.capsule.radius), water);
    }
    case ShapeType2::polygon: {
      Vec2d corners[geometry::max_polygon_vertices];
      for (int i = 0; i < shape.polygon.count; ++i) corners[i] = Vec2d(shape.polygon.vertices[i]);
      return forces::submerged({corners, std::size_t(shape.polygon.count)}, double(shape.polygon.radius), water);
    }
    default:
      return {};  // lines displace nothing
  }
}

forces::Submerged3 wet_hull(EffectorStore<Dim3>& store, const geometry::Hull& hull, const forces::WaterPlane& water) {
  store.vertices.clear();
  store.indices.clear();
  for (const Vec3f v : hull.vertices) store.vertices.push_back(Vec3d(v));
  for (const geometry::HullFace& face : hull.faces) {
    const std::uint16_t first = face.first_edge;
    std::uint16_t edge = hull.edges[first].next;
    for (int i = 2; i < int(face.edge_count); ++i) {
      const std::uint16_t following = hull.edges[edge].next;
      store.indices.push_back(hull.edges[first].origin);
      store.indices.push_back(hull.edges[edge].origin);
      store.indices.push_back(hull.edges[following].origin);
      edge = following;
    }
  }
  return forces::submerged_mesh(store.vertices, store.indices, water);
}

forces::Submerged3 wet_mesh(EffectorStore<Dim3>& store, const geometry::TriangleMesh& mesh,
                            const forces::WaterPlane& water) {
  store.vertices.clear();
  for (const Vec3f v : mesh.vertices) store.vertices.push_back(Vec3d(v));
  store.indices.assign(mesh.indices.begin(), mesh.indices.end());
  return forces::submerged_mesh(store.vertices, store.indices, water);
}

forces::Submerged3 wet_part(EffectorStore<Dim3>& store, const geometry::Shape3& shape,
                            const forces::WaterPlane& water) {
  using geometry::ShapeType3;
  switch (shape.type) {
    case ShapeType3::sphere:
      return forces::submerged_sphere({}, double(shape.sphere.radius), water);
    case ShapeType3::capsule: {
      const double l = double(shape.capsule.half_length), r = double(shape.capsule.radius);
      if (!(l > 0)) return forces::submerged_sphere({}, r, water);
      return forces::submerged_revolution({{0, -l, 0}, {0, l, 0}, r, r, true}, water);
    }
    case ShapeType3::box: {
      const double r = double(shape.box.radius);
      return forces::submerged_box(Vec3d(shape.box.half_extents) + Vec3d{r, r, r}, water);
    }
    case ShapeType3::cylinder: {
      const double h = double(shape.cylinder.half_height), r = double(shape.cylinder.radius);
      return forces::submerged_revolution({{0, -h, 0}, {0, h, 0}, r, r, false}, water);
    }
    case ShapeType3::cone: {
      const double h = double(shape.cone.half_height);
      return forces::submerged_revolution({{0, -h, 0}, {0, h, 0}, double(shape.cone.radius), 0, false}, water);
    }
    case ShapeType3::ellipsoid: {
      // A sphere in the frame where the half axes are one; the plane n·p = d there has the normal r n.
      const Vec3d r(shape.ellipsoid.radii), n = scale(r, water.normal);
      const double l = math::length(n);
      forces::Submerged3 part = forces::submerged_sphere({}, 1, {n * (1 / l), water.offset / l});
      part.volume *= r.x * r.y * r.z;
      part.centroid = scale(part.centroid, r);
      return part;
    }
    case ShapeType3::hull:
      return wet_hull(store, *shape.hull, water);
    case ShapeType3::compound: {
      forces::Submerged3 sum;
      Vec3d moment{};
      for (const geometry::CompoundChild& child : shape.compound->children) {
        const Quatd q(child.local.q);
        const Vec3d p(child.local.p);
        const forces::Submerged3 part =
            wet_part(store, child.shape, {inverse_rotate(q, water.normal), water.offset - dot(water.normal, p)});
        sum.volume += part.volume;
        moment += part.volume * (p + rotate(q, part.centroid));
      }
      if (sum.volume > 0) sum.centroid = moment / sum.volume;
      return sum;
    }
    case ShapeType3::mesh:
      return wet_mesh(store, *shape.mesh, water);
    default:
      return {};  // planes and height fields do not move
  }
}
double volume_of(const forces::Submerged2& part) { return part.area; }
double volume_of(const forces::Submerged3& part) { return part.volume; }

}  // namespace

template <class D>
void float_body(WorldImplementation<D>& world, const Buoyancy<D>& def, const EffectorBody<D>& body, double time) {
  using Position = typename D::Position;
  using RotationD = std::conditional_t<D::dimension == 2, Rot2d, Quatd>;
  const std::size_t i = std::size_t(body.slot);
  BodyMotion<D>& motion = world.bodies.motion[i];
  const LocalWater<D> here = water_near(world, def, body.center, time);
  if (dot(body.center - here.point, here.normal) > double(motion.outer_extent)) return;  // all dry

  double wet = 0;
  Position moment{};
  for (std::int32_t s = world.bodies.record[i].first_shape; s != none; s = world.shapes.at(s).next) {
    const ShapeRecord<D>& shape = world.shapes.at(s);
    if (shape.flags & shape_sensor) continue;
    const typename D::Pose pose = shape.at_origin ? body.pose : body.pose * shape.local;
    const LocalWater<D> surface = def.wave_count > 0 ? water_near(world, def, pose.position, time) : here;
    const RotationD q(pose.rotation);
    const auto part = wet_part(world.effectors, shape.geometry,
                               {inverse_rotate(q, surface.normal), dot(surface.normal, surface.point - pose.position)});
    const double volume = volume_of(part);
    wet += volume;
    moment += volume * (pose.position + rotate(q, part.centroid) - body.center);
  }
  if (!(wet > 0)) return;
  const Position arm = moment / wet;  // of the centre of buoyancy, from the centre of mass
  const double displaced = def.density * wet;
  push_at(world, body, Position(world.definition.gravity) * -displaced, arm);
  if (def.linear_drag > 0) {
    // The rate is relative to the displaced mass; averaged over the step it is stable for any rate.
    const double z = def.linear_drag * displaced * body.inverse_mass * body.dt;
    const Position v = body.velocity + cross(body.spin, arm) - here.velocity;
    push_at(world, body, v * (-def.linear_drag * displaced * mean_decay(z)), arm);
  }
  if (def.angular_drag > 0) {
    const double share = displaced * body.inverse_mass;
    const double rate = def.angular_drag * share;
    const float factor = float(-rate * mean_decay(rate * body.dt));
    const auto spin = world.bodies.solver[i].angular_velocity;
    if constexpr (D::dimension == 2) {
      motion.torque += factor * (motion.inertia * spin);
    } else {
      const Quatf q = world.bodies.pose[i].rotation;
      motion.torque += factor * rotate(q, motion.inertia * inverse_rotate(q, spin));
    }
  }
}

template void float_body(WorldImplementation<Dim2>&, const Buoyancy<Dim2>&, const EffectorBody<Dim2>&, double);
template void float_body(WorldImplementation<Dim3>&, const Buoyancy<Dim3>&, const EffectorBody<Dim3>&, double);

}  // namespace carom::rigid::detail
