// Walls and bodies on the grid: distances at nodes, open shares of faces, room of cells.
#pragma once

#include "carom/core/hash.h"
#include "carom/particles/detail/fluid_distance.h"
#include "carom/particles/detail/fluid_grid.inl"

namespace carom::particles::detail {

namespace {

/// Which part of a triangle with these values at its corners is positive; linear in between.
inline float positive_part(float a, float b, float c) {
  const int negative = (a <= 0) + (b <= 0) + (c <= 0);
  if (negative == 0) return 1;
  if (negative == 3) return 0;
  if (negative == 1) {
    const float n = a <= 0 ? a : (b <= 0 ? b : c), p = a <= 0 ? b : a, q = a <= 0 ? c : (b <= 0 ? c : b);
    return 1 - n * n / ((n - p) * (n - q));
  }
  const float p = a > 0 ? a : (b > 0 ? b : c), n = a > 0 ? b : a, m = a > 0 ? c : (b > 0 ? c : b);
  return p * p / ((p - n) * (p - m));
}
inline float positive_part(float a, float b) {
  if (a <= 0 && b <= 0) return 0;
  if (a > 0 && b > 0) return 1;
  return a > 0 ? a / (a - b) : b / (b - a);
}
/// Of a square with the corners a b in one row and c d in the next: the mean over both ways of cutting it in two.
inline float positive_part(float a, float b, float c, float d) {
  if (a > 0 && b > 0 && c > 0 && d > 0) return 1;
  if (a <= 0 && b <= 0 && c <= 0 && d <= 0) return 0;
  return 0.25f *
         ((positive_part(a, b, c) + positive_part(b, c, d)) + (positive_part(a, b, d) + positive_part(a, c, d)));
}

inline void hash_transform(core::StateHash& hash, const math::Transform2f& t) {
  hash.add(t.p.x).add(t.p.y).add(t.q.c).add(t.q.s);
}
inline void hash_transform(core::StateHash& hash, const math::Transform3f& t) {
  hash.add(t.p.x).add(t.p.y).add(t.p.z).add(t.q.w).add(t.q.x).add(t.q.y).add(t.q.z);
}

inline float cross_of(math::Vec2f r, math::Vec2f f) { return r.x * f.y - r.y * f.x; }
inline math::Vec3f cross_of(math::Vec3f r, math::Vec3f f) { return cross(r, f); }
inline math::Vec2f turned(float spin, math::Vec2f r) { return {-spin * r.y, spin * r.x}; }
inline math::Vec3f turned(math::Vec3f spin, math::Vec3f r) { return cross(spin, r); }

inline bool is_round(const geometry::Shape2& s) {
  return s.type == geometry::ShapeType2::circle || s.type == geometry::ShapeType2::capsule;
}
inline bool is_round(const geometry::Shape3& s) {
  using geometry::ShapeType3;
  return s.type == ShapeType3::sphere || s.type == ShapeType3::capsule || s.type == ShapeType3::ellipsoid;
}

constexpr float least_opening = 0.01f;

}  // namespace

template <class D>
typename FluidState<D>::Vector FluidState<D>::face_place(int component, int face) const {
  const int offset = face - grid.first;
  // Padded indices are positive once the first cell's own is added back.
  int rest = offset + grid.first, place[3] = {0, 0, 0};
  for (int b = N - 1; b >= 0; --b) {
    place[b] = rest / grid.stride[b];
    rest -= place[b] * grid.stride[b];
  }
  Vector r{};
  for (int b = 0; b < N; ++b) r[b] = (float(place[b] - 1) + (b == component ? 0.0f : 0.5f)) * cell;
  return r;
}

template <class D>
int FluidState<D>::face_owner(int component, int face) const {
  int best = face;
  for (int corner = 1; corner < (N == 2 ? 2 : 4); ++corner) {
    int node = face;
    int bit = 0;
    for (int b = 0; b < N; ++b) {
      if (b == component) continue;
      if ((corner >> bit) & 1) node += grid.stride[b];
      ++bit;
    }
    if (node_distance[node] < node_distance[best]) best = node;
  }
  return node_owner[best];
}

template <class D>
typename FluidState<D>::Vector FluidState<D>::solid_velocity(int owner, int component, int face) const {
  if (owner < 0) return Vector{};
  const FluidBody<D>& body = bodies[owner];
  return body.velocity + turned(body.spin, face_place(component, face) - body.center);
}

template <class D>
FluidRange FluidState<D>::range_of(const geometry::Bounds<Vector>& bounds, int margin) const {
  FluidRange r;
  for (int b = 0; b < N; ++b) {
    const float low = math::clamp(bounds.low[b] * inverse_cell, -2.0f, float(grid.cells[b]) + 2.0f);
    const float high = math::clamp(bounds.high[b] * inverse_cell, -2.0f, float(grid.cells[b]) + 2.0f);
    r.low[b] = math::clamp(int(low + 2) - 2 - margin, 0, grid.cells[b]);
    r.high[b] = math::clamp(int(high + 2) - 2 + margin, -1, grid.cells[b] - 1);
  }
  return r;
}

/// Distances at nodes, where this solid is nearest, and what it takes of cells.
template <class D>
void FluidState<D>::paint(const FluidSolid<D>& solid, std::vector<float>& distance, std::vector<float>& space,
                          std::int16_t owner) {
  FluidRange r = range_of(solid.bounds, 2);
  for (int b = 0; b < N; ++b)
    if (r.high[b] < r.low[b]) return;
  const float sheet = 0.75f * cell;
  const auto place_of = [&](int i, int j, int k, float shift) {
    const int at[3] = {i, j, k};
    Vector p{};
    for (int b = 0; b < N; ++b) p[b] = (float(at[b]) + shift) * cell;
    return inverse_transform_point(solid.at, p);
  };
  const bool round = is_round(solid.shape);
  // h² Δφ of what is convex. Straight cuts through cells take a twelfth of it from a solid's faces, and give half as
  // much to its volume: of a ball of four cells' radius, 3 % and 1½ %.
  const auto bend = [&](const Vector& local, float d) {
    if (!round || math::abs(d) > 2 * cell) return 0.0f;
    float sum = -float(2 * N) * d;
    for (int b = 0; b < N; ++b)
      for (const float side : {-cell, cell}) {
        Vector q = local;
        q[b] += side;
        sum += signed_distance(solid.shape, q, sheet);
      }
    return math::clamp(sum, 0.0f, cell);
  };
  for_cells(grid, r, [&](int i, int j, int k, int c) {
    const Vector local = place_of(i, j, k, 0.5f);
    float d = signed_distance(solid.shape, local, sheet);
    d += bend(local, d) / 24;
    space[c] = math::max(space[c] - math::clamp(0.5f - d * inverse_cell, 0.0f, 1.0f), 0.0f);
  });
  for (int b = 0; b < N; ++b) {  // nodes: one more, and those of the margin where the range reaches it
    if (r.low[b] == 0) r.low[b] = -1;
    r.high[b] += 1;
  }
  for_cells(grid, r, [&](int i, int j, int k, int node) {
    const Vector local = place_of(i, j, k, 0);
    float d = signed_distance(solid.shape, local, sheet);
    d -= bend(local, d) / 12;
    if (d < distance[node]) {
      distance[node] = d;
      node_owner[node] = owner;
    }
  });
}

template <class D>
void FluidState<D>::measure_openings(const FluidRange& range, const std::vector<float>& distance,
                                     std::vector<float> (&into)[N]) {
  const float shift = 1e-3f * cell;  // a surface that lies on the grid's own planes is closed
  for (int a = 0; a < N; ++a) {
    FluidRange r = range;
    r.high[a] += 1;
    const int s1 = grid.stride[a == 0 ? 1 : 0], s2 = N == 3 ? grid.stride[a == 2 ? 1 : 2] : 0;
    for_cells(grid, r, [&](int, int, int, int f) {
      float part = 0;
      if constexpr (N == 2)
        part = positive_part(distance[f] - shift, distance[f + s1] - shift);
      else
        part = positive_part(distance[f] - shift, distance[f + s1] - shift, distance[f + s2] - shift,
                             distance[f + s1 + s2] - shift);
      into[a][f] = part < least_opening ? 0.0f : part;
    });
  }
}

/// How much mass a cell's kernel can find: the open volume about it with the weights of the transfer, which are 1/8,
/// 3/4, 1/8 along every axis for evenly filled cells.
template <class D>
void FluidState<D>::measure_room(const FluidRange& range, const std::vector<float>& space, std::vector<float>& into) {
  for_cells(grid, range, [&](int, int, int, int c) {
    float sum = 0;
    for (int n = 0; n < (N == 2 ? 9 : 27); ++n) {
      const int d[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
      float weight = (d[0] == 0 ? 0.75f : 0.125f) * (d[1] == 0 ? 0.75f : 0.125f);
      int at = c + d[0] + d[1] * grid.stride[1];
      if constexpr (N == 3) {
        weight *= d[2] == 0 ? 0.75f : 0.125f;
        at += d[2] * grid.stride[2];
      }
      sum += weight * space[at];
    }
    into[c] = sum;
  });
}

/// What never moves, once: the walls of the domain and the fixed shapes of the world.
template <class D>
void FluidState<D>::paint_fixed() {
  std::fill(node_owner.begin(), node_owner.end(), std::int16_t(-1));
  FluidRange nodes = whole();
  for (int b = 0; b < N; ++b) {
    nodes.low[b] = -1;
    nodes.high[b] += 1;
  }
  for_cells(grid, nodes, [&](int i, int j, int k, int node) {
    const int at[3] = {i, j, k};
    float d = 4 * cell;
    for (int b = 0; b < N; ++b) {
      if (definition.walls[2 * b]) d = math::min(d, float(at[b]) * cell);
      if (definition.walls[2 * b + 1]) d = math::min(d, float(grid.cells[b] - at[b]) * cell);
    }
    fixed_distance[node] = d;
  });
  // The margin: nothing beyond a wall, all of it open elsewhere.
  std::fill(fixed_volume.begin(), fixed_volume.end(), 1.0f);
  FluidRange margin = whole();
  for (int b = 0; b < N; ++b) {
    margin.low[b] -= 1;
    margin.high[b] += 1;
  }
  for_cells(grid, margin, [&](int i, int j, int k, int c) {
    const int at[3] = {i, j, k};
    for (int b = 0; b < N; ++b)
      if ((at[b] < 0 && definition.walls[2 * b]) || (at[b] >= grid.cells[b] && definition.walls[2 * b + 1]))
        fixed_volume[c] = 0;
  });
  for (const FluidSolid<D>& solid : solids)
    if (solid.owner < 0) paint(solid, fixed_distance, fixed_volume, -1);
  measure_openings(whole(), fixed_distance, fixed_open);
  measure_room(whole(), fixed_volume, fixed_room);
  node_distance = fixed_distance;
  for (int a = 0; a < N; ++a) open[a] = fixed_open[a];
  room = fixed_room;
  volume = fixed_volume;
  painted.clear();
}

/// Moving bodies over what is fixed; what they covered before is given back first.
template <class D>
void FluidState<D>::place_solids() {
  for (const FluidRange& r : painted) {
    FluidRange nodes = r;
    for (int b = 0; b < N; ++b) {
      if (nodes.low[b] == 0) nodes.low[b] = -1;
      nodes.high[b] += 1;
    }
    for_cells(grid, nodes, [&](int, int, int, int c) {
      node_distance[c] = fixed_distance[c];
      node_owner[c] = -1;
      for (int a = 0; a < N; ++a) open[a][c] = fixed_open[a][c];
      room[c] = fixed_room[c];
      volume[c] = fixed_volume[c];
    });
  }
  painted.clear();
  for (const FluidSolid<D>& solid : solids)
    if (solid.owner >= 0) paint(solid, node_distance, volume, std::int16_t(solid.owner));
  for (const FluidSolid<D>& solid : solids) {
    if (solid.owner < 0) continue;
    const FluidRange r = range_of(solid.bounds, 3);
    bool empty = false;
    for (int b = 0; b < N; ++b) empty = empty || r.high[b] < r.low[b];
    if (empty) continue;
    painted.push_back(r);
    measure_openings(r, node_distance, open);
  }
  for (const FluidRange& r : painted) measure_room(r, volume, room);
}

/// Where a body will be in `time`. Halfway through the step is where the forces belong that act all through it: with
/// those of its beginning, a world that moves bodies with the mean of two velocities would let what floats swing ever
/// higher, by ω² dt/4 a second.
inline math::Pose2 halfway(const rigid::BodyState<rigid::Dim2>& s, float time) {
  const math::Vec2f arm = inverse_rotate(s.pose.rotation, math::Vec2f(s.center_of_mass - s.pose.position));
  const float half = 0.5f * time * s.angular_velocity, scale = 1 / (1 + half * half);
  const math::Rot2f turn{(1 - half * half) * scale, 2 * half * scale};  // tan(φ/2) ≈ φ/2
  const math::Rot2f rotation = turn * s.pose.rotation;
  return {s.center_of_mass + math::Vec2d(time * s.linear_velocity - rotate(rotation, arm)), rotation};
}
inline math::Pose3 halfway(const rigid::BodyState<rigid::Dim3>& s, float time) {
  const math::Vec3f arm = inverse_rotate(s.pose.rotation, math::Vec3f(s.center_of_mass - s.pose.position));
  const math::Vec3f half = 0.5f * time * s.angular_velocity;
  const float scale = 1 / math::sqrt(1 + dot(half, half));
  const math::Quatf rotation = math::Quatf{scale, scale * half} * s.pose.rotation;
  return {s.center_of_mass + math::Vec3d(time * s.linear_velocity - rotate(rotation, arm)), rotation};
}

template <class D>
core::Status FluidState<D>::gather_solids(rigid::World<D>& world, float dt) {
  typename D::Bounds bounds{definition.lower, definition.upper};
  for (int b = 0; b < N; ++b) bounds.high[b] = definition.lower[b] + double(cell) * grid.cells[b];
  core::Status seen = world.overlap_bounds(bounds, found);
  if (!seen.ok()) return seen;
  solids.clear();
  bodies.clear();
  core::StateHash hash;
  for (const rigid::ShapeId shape : found) {
    const auto definition_of_shape = world.shape_definition(shape);
    const auto body = world.body_of(shape);
    if (!definition_of_shape.ok() || !body.ok() || definition_of_shape->sensor) continue;
    const auto state = world.state(body.value());
    if (!state.ok() || !state->enabled) continue;
    auto geometry = world.shape_geometry(shape);
    if (!geometry.ok()) continue;
    FluidSolid<D> solid;
    solid.shape = std::move(geometry).value();
    typename D::Pose origin{};
    origin.position = definition.lower;
    solid.at = relative(origin, halfway(state.value(), 0.5f * dt)) * definition_of_shape->local;
    solid.bounds = geometry::bounds(solid.shape, solid.at);
    if (state->type == rigid::BodyType::fixed) {
      hash.add(shape.packed());
      hash_transform(hash, solid.at);
    } else {
      int owner = 0;
      while (owner < int(bodies.size()) && !(bodies[owner].id == body.value())) ++owner;
      const bool is_new = owner == int(bodies.size());
      if (is_new) {
        if (owner >= 32000) continue;
        bodies.push_back(describe(world, body.value(), state.value(), dt));
      }
      solid.owner = owner;
      solid.shared = !is_new;
    }
    solids.push_back(std::move(solid));
  }
  if (!fixed_known || hash.digest() != fixed_hash) {
    fixed_hash = hash.digest();
    fixed_known = true;
    paint_fixed();
  }
  return {};
}

template <class D>
FluidBody<D> FluidState<D>::describe(const rigid::World<D>& world, rigid::BodyId id, const rigid::BodyState<D>& state,
                                     float dt) {
  FluidBody<D> b;
  b.id = id;
  b.moves = state.type == rigid::BodyType::dynamic && state.mass > 0;
  b.center = Vector(state.center_of_mass - definition.lower) + 0.5f * dt * state.linear_velocity;
  b.velocity = state.linear_velocity;
  b.spin = state.angular_velocity;
  if (!b.moves) return b;
  const auto known_definition = world.body_definition(id);
  const rigid::MotionLocks locks = known_definition.ok() ? known_definition->locks : rigid::MotionLocks{};
  const float weight = known_definition.ok() ? known_definition->gravity_scale : 1.0f;
  b.inverse_mass[0] = locks.x ? 0 : 1 / state.mass;
  b.inverse_mass[1] = locks.y ? 0 : 1 / state.mass;
  if constexpr (N == 2) {
    const auto mass_properties = world.mass_properties2(id);
    const double inertia = mass_properties.ok() ? mass_properties->inertia : 0;
    b.inverse_inertia = inertia > 0 && !locks.rotation_z ? float(1 / inertia) : 0.0f;
  } else {
    b.inverse_mass[2] = locks.z ? 0 : 1 / state.mass;
    const auto mass_properties = world.mass_properties3(id);
    b.inverse_inertia = math::Mat3f::zero();
    if (mass_properties.ok()) {
      const math::Mat3d turn(to_matrix(state.pose.rotation));
      math::Mat3f inverse_inertia(inverse(geometry::rotate_inertia(mass_properties->inertia, turn)));
      const bool locked[3] = {locks.rotation_x, locks.rotation_y, locks.rotation_z};
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          if (locked[i] || locked[j]) inverse_inertia.column(i)[j] = 0;
      b.inverse_inertia = inverse_inertia;
    }
  }
  // Weight, and what contacts and joints added to it in the last step, as far as it looks like a load and not a blow.
  const Vector gravity = weight * world.definition().gravity;
  b.gain = gravity;
  for (const FluidMemory<D>& m : memory) {
    if (!(m.id == id) || !(m.dt > 0)) continue;
    const Vector other = (state.linear_velocity - m.velocity) / m.dt - gravity;
    const float size = length(other), most = 2 * length(gravity) + 1e-3f;
    b.gain += size > most ? (most / size) * other : other;
  }
  for (int i = 0; i < N; ++i)
    if (b.inverse_mass[i] == 0) b.gain[i] = 0;
  return b;
}

}  // namespace carom::particles::detail
