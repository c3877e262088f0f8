// Bodies in water: for every shape the wet volume and its centre, by carom/forces, in the shape's own frame.
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
  typename D::Position point{}, normal{}, velocity{}, acceleration{};
};

/// `radius` is of what feels the water: of the surroundings' water, waves short against it count less.
template <class D>
LocalWater<D> water_near(const WorldImplementation<D>& world, const Buoyancy<D>& def, const environment::Sea* sea,
                         typename D::Position p, double time, double radius) {
  D* const d = nullptr;
  environment::WaterPoint sample;
  if (sea != nullptr) {
    sample = sea->sample(place_of(p), time, radius);
  } else {
    environment::Wave waves[4];
    for (int i = 0; i < def.wave_count; ++i)
      waves[i] = {def.waves[i].amplitude, def.waves[i].wavelength, def.waves[i].phase, 1, 0};
    environment::Water water;
    water.level = def.level;
    water.waves = {waves, std::size_t(def.wave_count)};
    water.density = def.density;
    const double g = math::length(typename D::Position(world.definition.gravity));
    if (g > 0) water.gravity = g;
    sample = environment::sample(water, place_of(p), time);
  }
  LocalWater<D> out;
  out.point = p;
  out.point.y = sample.height;
  out.normal = normalize(part_of(sample.normal, d));
  out.velocity = part_of(sample.velocity, d);
  if (sea != nullptr)
    out.acceleration = part_of(sample.acceleration, d);
  else
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

/// Radius of what a shape feels of the waves: of a disc as wide as it.
double felt_radius(const geometry::Shape2& shape) {
  const geometry::Bounds2f b = geometry::bounds(shape, math::Transform2f{});
  return 0.577 * double(b.high.x - b.low.x);
}
double felt_radius(const geometry::Shape3& shape) {
  const geometry::Bounds3f b = geometry::bounds(shape, math::Transform3f{});
  return 0.577 * double(math::min(b.high.x - b.low.x, b.high.z - b.low.z));
}

/// Half of its height as it lies.
double half_height(const geometry::Shape2& shape, const Pose2& pose) {
  const geometry::Bounds2f b = geometry::bounds(shape, math::Transform2f{{}, pose.rotation});
  return 0.5 * double(b.high.y - b.low.y);
}
double half_height(const geometry::Shape3& shape, const Pose3& pose) {
  const geometry::Bounds3f b = geometry::bounds(shape, math::Transform3f{{}, pose.rotation});
  return 0.5 * double(b.high.y - b.low.y);
}

/// The parts of a shape that each have their own plane of water: a box that is long against the waves is cut across.
template <class Add>
void for_each_part(const geometry::Shape2& shape, const Pose2& pose, double, const Add& add) {
  add(pose, shape, felt_radius(shape));
}
template <class Add>
void for_each_part(const geometry::Shape3& shape, const Pose3& pose, double piece, const Add& add) {
  constexpr int most = 8;
  const auto cuts = [&](float half) {
    return int(math::clamp(math::ceil(2 * double(half) / piece), 1.0, double(most)));
  };
  const int columns = shape.type == geometry::ShapeType3::box ? cuts(shape.box.half_extents.x) : 1;
  const int rows = shape.type == geometry::ShapeType3::box ? cuts(shape.box.half_extents.z) : 1;
  if (columns * rows == 1) return add(pose, shape, felt_radius(shape));
  geometry::Shape3 part = shape;
  const Vec3f half = shape.box.half_extents;
  part.box.half_extents.x = half.x / float(columns);
  part.box.half_extents.z = half.z / float(rows);
  const double radius = felt_radius(part);
  for (int i = 0; i < columns; ++i)
    for (int k = 0; k < rows; ++k) {
      const Vec3f center{part.box.half_extents.x * float(2 * i + 1 - columns), 0,
                         part.box.half_extents.z * float(2 * k + 1 - rows)};
      add(Pose3{pose.position + Vec3d(rotate(pose.rotation, center)), pose.rotation}, part, radius);
    }
}

}  // namespace

template <class D>
void float_body(WorldImplementation<D>& world, const Buoyancy<D>& def, const EffectorBody<D>& body, double time,
                const environment::Environment* surroundings) {
  using Position = typename D::Position;
  using RotationD = std::conditional_t<D::dimension == 2, Rot2d, Quatd>;
  const std::size_t i = std::size_t(body.slot);
  BodyMotion<D>& motion = world.bodies.motion[i];
  const environment::Sea* sea = surroundings != nullptr ? surroundings->water() : nullptr;
  const bool waves = sea != nullptr ? !sea->components().empty() : def.wave_count > 0;
  const LocalWater<D> here = water_near(world, def, sea, body.center, time, 0);
  if (dot(body.center - here.point, here.normal) > double(motion.outer_extent)) return;  // all dry

  const double piece = sea != nullptr && waves ? 2 * math::pi / (6 * sea->mean_wave_number()) : 0;  // m
  double wet = 0;
  Position moment{}, flow{}, push_of_waves{};
  const auto add = [&](const typename D::Pose& pose, const typename D::Shape& shape, double radius) {
    Position asked = pose.position;
    if (sea != nullptr && waves) {  // the water's motion about half way down what is wet
      const double high = half_height(shape, pose), bottom = asked.y - high;
      asked.y = math::min(asked.y, 0.5 * (math::min(sea->water().level, asked.y + high) + bottom));
    }
    const LocalWater<D> surface = waves ? water_near(world, def, sea, asked, time, radius) : here;
    const RotationD q(pose.rotation);
    const auto part = wet_part(world.effectors, shape,
                               {inverse_rotate(q, surface.normal), dot(surface.normal, surface.point - pose.position)});
    const double volume = volume_of(part);
    wet += volume;
    moment += volume * (pose.position + rotate(q, part.centroid) - body.center);
    flow += volume * surface.velocity;
    push_of_waves += volume * surface.acceleration;
  };
  for (std::int32_t s = world.bodies.record[i].first_shape; s != none; s = world.shapes.at(s).next) {
    const ShapeRecord<D>& shape = world.shapes.at(s);
    if (shape.flags & shape_sensor) continue;
    const typename D::Pose pose = shape.at_origin ? body.pose : body.pose * shape.local;
    if (sea != nullptr && waves)
      for_each_part(shape.geometry, pose, piece, add);
    else
      add(pose, shape.geometry, 0);
  }
  if (!(wet > 0)) return;
  const Position arm = moment / wet;  // of the centre of buoyancy, from the centre of mass
  const double displaced = (sea != nullptr ? sea->water().density : def.density) * wet;
  Position gravity(world.definition.gravity);
  if (surroundings != nullptr && surroundings->has_gravity())
    gravity += part_of(surroundings->gravity(place_of(body.center)), static_cast<D*>(nullptr));
  const Position water_velocity = flow / wet, water_acceleration = push_of_waves / wet;
  push_at(world, body, (water_acceleration - gravity) * displaced, arm);
  if (def.linear_drag > 0) {
    // The rate is relative to the displaced mass; averaged over the step it is stable for any rate.
    const double z = def.linear_drag * displaced * body.inverse_mass * body.dt;
    const Position v = body.velocity + cross(body.spin, arm) - water_velocity;
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
  if (def.added_mass != typename D::Vector{} || def.added_inertia != typename D::Angular{})
    world.effectors.added.push_back(
        {body.slot, displaced, Position(def.added_mass), water_velocity, water_acceleration, def.added_inertia});
}

template <class D>
void apply_added_masses(WorldImplementation<D>& world, double dt) {
  using Position = typename D::Position;
  using RotationD = std::conditional_t<D::dimension == 2, Rot2d, Quatd>;
  for (const auto& added : world.effectors.added) {
    const EffectorBody<D> body(world, added.body, dt);
    BodyMotion<D>& motion = world.bodies.motion[std::size_t(added.body)];
    const RotationD q(body.pose.rotation);
    const Position u = inverse_rotate(q, body.velocity - added.water_velocity);
    const Position water = inverse_rotate(q, added.water_acceleration);
    Position force = inverse_rotate(q, other_acceleration(world, body) * body.mass), carried{};
    for (int i = 0; i < D::dimension; ++i) carried[i] = added.share[i] * added.displaced * u[i];
    // Kirchhoff 1869: (m + A) a = F + A a_w + A(ω × u) − ω × (A u), and the moment −u × (A u) that turns a body
    // broadside.
    const auto spin = [&] {
      if constexpr (D::dimension == 2)
        return body.spin;
      else
        return inverse_rotate(q, body.spin);
    }();
    const Position turned = cross(spin, u), cross_flow = cross(spin, carried);
    Position extra{};
    for (int i = 0; i < D::dimension; ++i) {
      const double a = added.share[i] * added.displaced;
      const double all = force[i] + a * (water[i] + turned[i]) - cross_flow[i];
      extra[i] = body.mass * all / (body.mass + a) - force[i];
    }
    push(world, body, rotate(q, extra));
    const auto munk = cross(u, carried);
    if constexpr (D::dimension == 2) {
      const double inertia = double(motion.inertia), j = double(added.inertia) * added.displaced;
      const double torque = double(motion.torque) - munk;
      motion.torque = inertia > 0 ? float(torque * inertia / (inertia + j)) : motion.torque;
    } else {
      const Vec3d torque = inverse_rotate(q, Vec3d(motion.torque)) - munk;
      const Mat3d inertia(motion.inertia);
      Mat3d all = inertia;
      all.cx.x += double(added.inertia.x) * added.displaced;
      all.cy.y += double(added.inertia.y) * added.displaced;
      all.cz.z += double(added.inertia.z) * added.displaced;
      const Vec3d through = math::inverse(all) * torque;
      if (is_finite(through)) motion.torque = Vec3f(rotate(q, inertia * through));
    }
  }
}

template void float_body(WorldImplementation<Dim2>&, const Buoyancy<Dim2>&, const EffectorBody<Dim2>&, double,
                         const environment::Environment*);
template void float_body(WorldImplementation<Dim3>&, const Buoyancy<Dim3>&, const EffectorBody<Dim3>&, double,
                         const environment::Environment*);
template void apply_added_masses(WorldImplementation<Dim2>&, double);
template void apply_added_masses(WorldImplementation<Dim3>&, double);

}  // namespace carom::rigid::detail
