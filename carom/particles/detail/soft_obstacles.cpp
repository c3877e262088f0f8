#include "carom/particles/detail/soft_obstacles.h"

#include <algorithm>

#include "carom/geometry/mass_properties.h"
#include "carom/math/elementary.h"
#include "carom/particles/detail/checks.h"
#include "carom/particles/detail/nearest_surface.h"

namespace carom::particles::detail {

namespace {
constexpr double half_way = 0.5;  // of half of a shape: what comes farther in a step is fast
constexpr double least_blow = 1;  // m/s
}  // namespace

int SoftObstacles::body_index(rigid::World3& world, rigid::BodyId id) {
  for (std::size_t i = 0; i < bodies.size(); ++i)
    if (bodies[i].id == id) return int(i);
  const auto state = world.state(id);
  if (!state) return -1;
  Body body;
  body.id = id;
  body.dynamic = state->type == rigid::BodyType::dynamic;
  body.awake = state->awake;
  body.center = state->center_of_mass;
  body.rotation = Quatd(state->pose.rotation);
  body.local_center = inverse_rotate(body.rotation, body.center - state->pose.position);
  body.velocity = Vec3d(state->linear_velocity);
  body.spin = Vec3d(state->angular_velocity);
  body.mass = double(state->mass);
  body.start = {body.velocity, body.spin};
  bodies.push_back(body);
  return int(bodies.size()) - 1;
}

double SoftObstacles::speed_of(const Shape& shape) const {
  const Body& body = bodies[std::size_t(shape.body)];
  const double turn = length(body.spin), speed = length(body.velocity);
  if (turn == 0 || !math::is_finite(shape.outer)) return speed;
  return speed + turn * (shape.outer + distance(shape.middle(), body.center));
}

void SoftObstacles::take(rigid::World3& world, rigid::ShapeId id, const rigid::Filter& filter,
                         const std::vector<SoftPin>& pins, double dt) {
  const auto definition = world.shape_definition(id);
  const auto owner = world.body_of(id);
  if (!definition || !owner || definition->sensor) return;
  if (!filters_meet(definition->filter, filter)) return;
  for (const SoftPin& pin : pins)
    if (pin.body == *owner) return;
  const auto shape = world.shape_geometry(id);
  const int index = body_index(world, *owner);
  if (!shape || index < 0) return;
  const Body& body = bodies[std::size_t(index)];
  const Quatd turn(definition->local.q);
  const Vec3d place(definition->local.p);
  Shape here{*shape, geometry::bounds(*shape, {}),         index, body.rotation * turn, turn, body.place(place),
             place,  double(definition->material.friction)};
  const Vec3f extents = here.tight.extents();
  here.half = double(math::min(extents.x, math::min(extents.y, extents.z)));
  here.outer = length(Vec3d(extents));
  here.speed = speed_of(here);
  here.fast = dt * here.speed > half_way * here.half;
  fast = fast || here.fast;
  here.id = id;
  for (const SoftSide& known : sides_)
    if (known.id == id) here.side = known.side;
  shapes_.push_back(here);
  sides_.reserve(shapes_.capacity());
}

void SoftObstacles::gather(rigid::World3& world, const geometry::Bounds3d& bounds, const rigid::Filter& filter,
                           const std::vector<SoftPin>& pins, double dt) {
  (void)world.overlap_bounds(bounds, found_);
  for (const rigid::ShapeId id : found_) take(world, id, filter, pins, dt);
  const auto known = [&](rigid::ShapeId id) { return std::find(found_.begin(), found_.end(), id) != found_.end(); };
  (void)world.overlap_bounds(grow(bounds, dt * usual_body), coming_);
  const double slack = 0.5 * dt * dt * length(Vec3d(world.definition().gravity));
  for (const rigid::ShapeId id : coming_) {
    const auto owner = world.body_of(id);
    if (known(id) || !owner) continue;
    const auto state = world.state(*owner);
    if (!state || (state->linear_velocity == Vec3f{} && state->angular_velocity == Vec3f{})) continue;
    const auto definition = world.shape_definition(id);
    const auto shape = world.shape_geometry(id);
    if (!definition || !shape) continue;
    if (!overlaps(way_of(*state, geometry::bounds(*shape, definition->local), dt, slack), bounds)) continue;
    take(world, id, filter, pins, dt);
    found_.push_back(id);
  }
  find_fast_shapes(world, dt, fast_bodies_, of_body_, fast_shapes_);
  for (const FastShape& coming : fast_shapes_)
    if (overlaps(coming.way, bounds) && !known(coming.id)) take(world, coming.id, filter, pins, dt);
}

bool SoftObstacles::nearest(Vec3d point, double radius, double margin, double h, SoftPlane& plane) const {
  bool found = false;
  for (const Shape& shape : shapes_) {
    const double reach = margin + 2 * h * shape.speed;
    const Vec3f local(inverse_rotate(shape.turn, point - shape.place));
    if (!contains(grow(shape.tight, float(radius + reach)), geometry::Bounds3f{local, local})) continue;
    Vec3f normal;
    float separation = 0;
    // A ground of many triangles tells beside its ridges soon enough.
    const bool plain = shape.shape.type == geometry::ShapeType3::mesh && shape.speed == 0;
    if (plain ? !nearest_plane(shape.shape, local, float(radius), float(reach), normal, separation)
              : !nearest_surface(shape.shape, local, float(radius), float(reach), normal, separation))
      continue;
    if (found && double(separation) >= plane.separation) continue;
    found = true;
    plane = {shape.body, point, rotate(shape.turn, Vec3d(normal)), double(separation), shape.friction};
  }
  return found;
}

/// Of the bodies that a body is pressed against by a push on it, one behind the other; negative: it stands against what
/// does not move.
double SoftObstacles::mass_behind(rigid::World3& world, const Body& body, Vec3d push) {
  constexpr std::size_t most = 32;
  double sum = 0;
  behind_.assign(1, body.id);
  for (std::size_t k = 0; k < behind_.size() && k < most; ++k) {
    const rigid::BodyId here = behind_[k];
    world.contacts(here, contacts_);
    for (const auto& contact : contacts_) {
      float pressed = 0;
      for (int p = 0; p < contact.count; ++p) pressed += contact.points[p].normal_impulse;
      const auto a = world.body_of(contact.shape_a), b = world.body_of(contact.shape_b);
      if (!(pressed > 0) || !a || !b) continue;
      const bool first = *a == here;
      const rigid::BodyId other = first ? *b : *a;
      if ((first ? 1.0 : -1.0) * dot(Vec3d(contact.normal), push) < 0.3 * length(push)) continue;
      const auto state = world.state(other);
      if (!state) continue;
      if (state->type != rigid::BodyType::dynamic) return -1;
      bool known = false;
      for (const rigid::BodyId id : behind_) known |= id == other;
      if (known) continue;
      behind_.push_back(other);
      sum += double(state->mass);
    }
  }
  return sum;
}

void SoftObstacles::find_pulls(rigid::World3& world, double dt) {
  const Vec3d gravity(world.definition().gravity);
  for (Body& body : bodies) {
    if (!body.dynamic || !body.awake || !(body.mass > 0)) continue;
    const auto properties = world.mass_properties3(body.id);
    const auto definition = world.body_definition(body.id);
    if (!properties || !definition) continue;
    const rigid::MotionLocks& locks = definition->locks;
    body.moves = true;
    body.locked = {locks.x ? 1.0 : 0.0, locks.y ? 1.0 : 0.0, locks.z ? 1.0 : 0.0};
    body.locked_turn = {locks.rotation_x ? 1.0 : 0.0, locks.rotation_y ? 1.0 : 0.0, locks.rotation_z ? 1.0 : 0.0};
    body.inertia = geometry::rotate_inertia(properties->inertia, to_matrix(body.rotation));
    body.inverse_inertia = math::inverse(body.inertia);
    body.pull.linear = double(definition->gravity_scale) * gravity;
    for (const SoftMemory& memory : memory_) {
      if (memory.id != body.id) continue;
      if (length_squared(memory.impulse) > 0) {
        const double behind = mass_behind(world, body, memory.impulse);
        body.moves = behind >= 0;
        body.heavier = 1 + math::max(behind, 0.0) / body.mass;
        if (!body.moves) break;
      }
      // Floors, joints and other ropes answer to a load with no more than it and the weight in all but blows.
      const SoftTwist seen = SoftTwist{body.velocity, body.spin} - memory.velocity - memory.change;
      const double most = length(body.pull.linear) * dt + length(memory.change.linear);
      const double most_turn = length(memory.change.angular);
      const double size = length(seen.linear), turn = length(seen.angular);
      body.pull.linear = seen.linear * ((size > most ? most / size : 1) / dt);
      body.pull.angular = seen.angular * ((turn > most_turn ? most_turn / turn : 1) / dt);
      break;
    }
  }
}

void SoftObstacles::enter(float h, SoftSolver& solver) const {
  solver.movers.resize(bodies.size());
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Body& body = bodies[b];
    SoftMover& mover = solver.movers[b];
    mover = {};
    if (!body.moves) continue;
    constexpr double still = 1e9;  // times the mass: a lock
    for (int i = 0; i < 3; ++i) {
      mover.mass[i][i] = body.heavier * body.mass * (1 + still * body.locked[i]);
      for (int k = 0; k < 3; ++k) mover.mass[3 + i][3 + k] = body.heavier * body.inertia.column(k)[i];
      mover.mass[3 + i][3 + i] += still * body.locked_turn[i] * math::trace(body.inertia);
    }
    const SoftTwist fall = double(h) * body.pull;
    mover.right = body.heavier * SoftTwist{body.mass * fall.linear, body.inertia * fall.angular};
    mover.change = body.touched ? body.change : fall;
  }
}

void SoftObstacles::advance(double h, const SoftSolver& solver) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    Body& body = bodies[b];
    const SoftMover& mover = solver.movers[b];
    body.touched = mover.from != mover.to;
    body.change = mover.change;
    if (body.moves) {
      body.velocity += body.change.linear;
      body.spin += body.change.angular;
    }
    if (body.dynamic && !body.moves) continue;
    body.carried += h * body.impulse;
    body.carried_turn += h * body.turn;
    body.center += h * body.velocity;
    body.rotation = integrate(body.rotation, h * body.spin);
  }
  for (Shape& shape : shapes_) {
    const Body& body = bodies[std::size_t(shape.body)];
    shape.turn = body.rotation * shape.local_turn;
    shape.place = body.place(shape.local_place);
    shape.speed = speed_of(shape);
  }
}

// A force over the step would carry a body that is stopped early in it beyond what stops it: of the impulse of a blow
// so much comes at the start that the body is at the step's end where it was in the substeps.
void SoftObstacles::hand_over(rigid::World3& world, double dt, double gravity) {
  const float per_step = float(1 / dt);
  memory_.clear();
  sides_.clear();
  for (const Shape& shape : shapes_)
    if (shape.side != 0) sides_.push_back({shape.id, shape.side});
  for (const Body& body : bodies) {
    if (!body.dynamic) continue;
    if (body.awake && body.mass > 0) {
      const double lightness = 1 / (body.heavier * body.mass), turn = 1 / body.heavier;
      memory_.push_back(
          {body.id, body.start, {lightness * body.impulse, turn * (body.inverse_inertia * body.turn)}, body.impulse});
    }
    if (length_squared(body.impulse) == 0 && length_squared(body.turn) == 0) continue;
    // What sleeps is not woken by what only lies on it.
    if (!body.awake && length(body.impulse) < 0.02 * body.mass * gravity * dt) continue;
    Vec3d start{}, start_turn{};
    if (fast && body.moves && length(body.impulse) > least_blow * body.mass) {
      start = (2 / dt) * body.carried - body.impulse;
      start_turn = (2 / dt) * body.carried_turn - body.turn;
      (void)world.add_impulse(body.id, Vec3f(start));
      (void)world.add_angular_impulse(body.id, Vec3f(start_turn));
    }
    (void)world.add_force(body.id, Vec3f(body.impulse - start) * per_step);
    (void)world.add_torque(body.id, Vec3f(body.turn - start_turn) * per_step);
  }
}

}  // namespace carom::particles::detail
