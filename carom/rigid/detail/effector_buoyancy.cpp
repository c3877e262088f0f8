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

/// `footprint` is of what feels the surroundings' water: waves short against it count less.
template <class D>
LocalWater<D> water_near(const WorldImplementation<D>& world, const Buoyancy<D>& def, const environment::Sea* sea,
                         typename D::Position p, double time, const environment::Footprint& footprint = {}) {
  D* const d = nullptr;
  environment::WaterPoint sample;
  if (sea != nullptr) {
    sample = sea->sample(place_of(p), time, footprint);
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

void collect(EffectorStore<Dim3>& store, const geometry::Hull& hull) {
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
}

void collect(EffectorStore<Dim3>& store, const geometry::TriangleMesh& mesh) {
  store.vertices.clear();
  for (const Vec3f v : mesh.vertices) store.vertices.push_back(Vec3d(v));
  store.indices.assign(mesh.indices.begin(), mesh.indices.end());
}

/// Cuts triangles that are long against the waves: between corners the surface is taken as straight.
void refine(EffectorStore<Dim3>& store, double piece) {
  const std::size_t count = store.indices.size();
  for (std::size_t t = 0; t + 2 < count; t += 3) {
    const Vec3d a = store.vertices[store.indices[t]], b = store.vertices[store.indices[t + 1]],
                c = store.vertices[store.indices[t + 2]];
    const double longest = math::max(math::distance(a, b), math::max(math::distance(b, c), math::distance(c, a)));
    const int n = int(math::clamp(math::ceil(longest / piece), 1.0, 8.0));
    if (n == 1) continue;
    // Rows of corners from a to the side bc, and the triangles between them; the first takes the place of the old one.
    const std::uint32_t first = std::uint32_t(store.vertices.size());
    const auto corner = [first](int row, int i) { return first + std::uint32_t(row * (row + 1) / 2 + i); };
    for (int row = 0; row <= n; ++row)
      for (int i = 0; i <= row; ++i)
        store.vertices.push_back(a + (b - a) * (double(row - i) / n) + (c - a) * (double(i) / n));
    store.indices[t] = corner(0, 0), store.indices[t + 1] = corner(1, 0), store.indices[t + 2] = corner(1, 1);
    for (int row = 1; row < n; ++row)
      for (int i = 0; i <= row; ++i) {
        store.indices.insert(store.indices.end(), {corner(row, i), corner(row + 1, i), corner(row + 1, i + 1)});
        if (i < row)
          store.indices.insert(store.indices.end(), {corner(row, i), corner(row + 1, i + 1), corner(row, i + 1)});
      }
  }
}

/// Of the triangles in the store, in the shape's frame, under the real surface: each corner has its own depth.
forces::Submerged3 wet_in_waves(EffectorStore<Dim3>& store, const environment::Sea& sea, const Pose3& pose,
                                double time) {
  const Quatd q(pose.rotation);
  const std::size_t n = store.vertices.size();
  store.sea.set(sea, {pose.position.x, pose.position.z}, time);
  store.sea_x.resize(n);
  store.sea_z.resize(n);
  store.sea_height.resize(n);
  store.depths.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d corner = rotate(q, store.vertices[i]);
    store.sea_x[i] = float(corner.x);
    store.sea_z[i] = float(corner.z);
    store.depths[i] = sea.water().level - (pose.position.y + corner.y);
  }
  store.sea.heights(store.sea_x, store.sea_z, store.sea_height);
  for (std::size_t i = 0; i < n; ++i) store.depths[i] += double(store.sea_height[i]);
  return forces::submerged_mesh(store.vertices, store.indices, store.depths, inverse_rotate(q, Vec3d{0, 1, 0}));
}

/// What is wet of a shape with rounded edges, from the sharp one about it: its share of that one's whole volume.
forces::Submerged3 rounded(forces::Submerged3 part, const geometry::Shape3& shape, double rounding, double sharp) {
  if (rounding > 0) part.volume *= geometry::mass_properties(shape, 1).mass / sharp;
  return part;
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
      const Vec3d half = Vec3d(shape.box.half_extents) + Vec3d{r, r, r};
      return rounded(forces::submerged_box(half, water), shape, r, 8 * half.x * half.y * half.z);
    }
    case ShapeType3::cylinder: {
      const double rounding = double(shape.cylinder.rounding), h = double(shape.cylinder.half_height) + rounding,
                   r = double(shape.cylinder.radius) + rounding;
      return rounded(forces::submerged_revolution({{0, -h, 0}, {0, h, 0}, r, r, false}, water), shape, rounding,
                     2 * pi * r * r * h);
    }
    case ShapeType3::cone: {
      const double rounding = double(shape.cone.rounding), h = double(shape.cone.half_height),
                   r = double(shape.cone.radius), slant = math::sqrt(4 * h * h + r * r), side = 2 * h / slant;
      if (!(rounding > 0)) return forces::submerged_revolution({{0, -h, 0}, {0, h, 0}, r, 0, false}, water);
      // A frustum about it, from the plane under the base to that over the cap.
      const double low = -h - rounding, high = h + rounding, at_apex = rounding / side;
      const double lower = at_apex + r + r / (2 * h) * rounding,
                   upper = math::max(at_apex - r / (2 * h) * rounding, 0.0);
      return rounded(forces::submerged_revolution({{0, low, 0}, {0, high, 0}, lower, upper, false}, water), shape,
                     rounding, pi * (high - low) * (lower * lower + lower * upper + upper * upper) / 3);
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
      collect(store, *shape.hull);
      return forces::submerged_mesh(store.vertices, store.indices, water);
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
      collect(store, *shape.mesh);
      return forces::submerged_mesh(store.vertices, store.indices, water);
    default:
      return {};  // planes and height fields do not move
  }
}
double volume_of(const forces::Submerged2& part) { return part.area; }
double volume_of(const forces::Submerged3& part) { return part.volume; }

/// A shape as it lies in the waves: half its height, and what it covers of the water.
struct Lie {
  double half_height = 0;
  environment::Footprint footprint{};
};
Lie lie_of(const geometry::Shape2& shape, const Pose2& pose) {
  const geometry::Bounds2f b = geometry::bounds(shape, math::Transform2f{{}, pose.rotation});
  const double width = double(b.high.x - b.low.x);
  return {0.5 * double(b.high.y - b.low.y), {width * width / 12, 0, 0}};
}
Lie lie_of(const geometry::Shape3& shape, const Pose3& pose) {
  const geometry::Bounds3f b = geometry::bounds(shape, math::Transform3f{});
  const Quatd q(pose.rotation);
  const Vec3d half = 0.5 * Vec3d(b.high - b.low);
  Lie lie;
  for (int i = 0; i < 3; ++i) {
    Vec3d axis{};
    axis[i] = half[i];
    axis = rotate(q, axis);
    lie.half_height += math::abs(axis.y);
    lie.footprint.xx += axis.x * axis.x / 3;
    lie.footprint.xz += axis.x * axis.z / 3;
    lie.footprint.zz += axis.z * axis.z / 3;
  }
  return lie;
}

/// Whether each corner has its own depth in the waves.
bool by_corners(const geometry::Shape2&) { return false; }
bool by_corners(const geometry::Shape3& shape) {
  return shape.type == geometry::ShapeType3::hull || shape.type == geometry::ShapeType3::mesh;
}
forces::Submerged2 wet_corners(EffectorStore<Dim2>&, const geometry::Shape2&, const environment::Sea&, const Pose2&,
                               double) {
  return {};
}
forces::Submerged3 wet_corners(EffectorStore<Dim3>& store, const geometry::Shape3& shape, const environment::Sea& sea,
                               const Pose3& pose, double time) {
  if (shape.type == geometry::ShapeType3::hull)
    collect(store, *shape.hull);
  else
    collect(store, *shape.mesh);
  refine(store, 2 * math::pi / (8 * sea.mean_wave_number()));
  return wet_in_waves(store, sea, pose, time);
}

/// The parts of a shape that each have their own plane of water: a box that is long against the waves is cut across.
template <class Add>
void for_each_part(const geometry::Shape2& shape, const Pose2& pose, double, const Add& add) {
  add(pose, shape);
}
template <class Add>
void for_each_part(const geometry::Shape3& shape, const Pose3& pose, double piece, const Add& add) {
  if (shape.type == geometry::ShapeType3::compound) {
    for (const geometry::CompoundChild& child : shape.compound->children)
      for_each_part(child.shape, pose * child.local, piece, add);
    return;
  }
  constexpr int most = 8;
  const auto cuts = [&](float half) {
    return int(math::clamp(math::ceil(2 * double(half) / piece), 1.0, double(most)));
  };
  const int columns = shape.type == geometry::ShapeType3::box ? cuts(shape.box.half_extents.x) : 1;
  const int rows = shape.type == geometry::ShapeType3::box ? cuts(shape.box.half_extents.z) : 1;
  if (columns * rows == 1) return add(pose, shape);
  geometry::Shape3 part = shape;
  const Vec3f half = shape.box.half_extents;
  part.box.half_extents.x = half.x / float(columns);
  part.box.half_extents.z = half.z / float(rows);
  for (int i = 0; i < columns; ++i)
    for (int k = 0; k < rows; ++k) {
      const Vec3f center{part.box.half_extents.x * float(2 * i + 1 - columns), 0,
                         part.box.half_extents.z * float(2 * k + 1 - rows)};
      add(Pose3{pose.position + Vec3d(rotate(pose.rotation, center)), pose.rotation}, part);
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
  const LocalWater<D> here = water_near(world, def, sea, body.center, time);
  if (dot(body.center - here.point, here.normal) > double(motion.outer_extent)) return;  // all dry

  const double piece = sea != nullptr && waves ? 2 * math::pi / (6 * sea->mean_wave_number()) : 0;  // m
  double wet = 0;
  Position moment{}, flow{}, push_of_waves{};
  const auto add = [&](const typename D::Pose& pose, const typename D::Shape& shape) {
    LocalWater<D> surface = here;
    if (sea != nullptr && waves) {
      // The water's motion about half way down what is wet.
      const Lie lie = lie_of(shape, pose);
      Position asked = pose.position;
      const double bottom = asked.y - lie.half_height;
      asked.y = math::min(asked.y, 0.5 * (math::min(sea->water().level, asked.y + lie.half_height) + bottom));
      surface = water_near(world, def, sea, asked, time, lie.footprint);
    } else if (waves) {
      surface = water_near(world, def, sea, pose.position, time);
    }
    const RotationD q(pose.rotation);
    const auto part =
        sea != nullptr && waves && by_corners(shape)
            ? wet_corners(world.effectors, shape, *sea, pose, time)
            : wet_part(world.effectors, shape,
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
      add(pose, shape.geometry);
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
