#include "carom/particles/detail/soft_touch.h"

#include <algorithm>

#include "carom/math/elementary.h"

namespace carom::particles::detail {

using math::Mat3f;

namespace {

constexpr float touching_slack = 0.02f;           // of what keeps a sheet apart: so little is left to the next substep
constexpr float least_slack = 1e-6f;              // m; all that a body has, because what it sinks in by is work
constexpr float slow_rise = 0.1f, fast_rise = 4;  // m/s, of what is too deep

/// Velocity of what a touch lies on: before the solve, and how the solve changes it.
Vec3f surface_velocity(const SoftPlane& plane, const SoftObstacles& obstacles) {
  return Vec3f(obstacles.bodies[std::size_t(plane.body)].velocity_at(plane.at));
}
Vec3f surface_change(const SoftTouch& touch, const SoftObstacles& obstacles, const SoftSolver& solver) {
  const std::size_t b = std::size_t(touch.plane.body);
  if (!obstacles.bodies[b].moves) return {};
  return Vec3f(solver.movers[b].change.at(touch.plane.at - obstacles.bodies[b].center));
}

}  // namespace

// What moves is not thrown: the world moves it through a blow a little otherwise than the substeps here foresee. But
// what comes fast would sink in by that, a corner after another.
float greatest_rise(const SoftPlane& plane, const SoftObstacles& obstacles) {
  if (!obstacles.bodies[std::size_t(plane.body)].moves) return 1;
  return obstacles.fast ? math::clamp(0.3f * length(surface_velocity(plane, obstacles)), slow_rise, fast_rise)
                        : slow_rise;
}

void hold_touch(SoftTouch& touch, std::size_t i, Vec3f velocity, double friction, float h,
                const SoftObstacles& obstacles, SoftSolver& solver) {
  const Vec3f n(touch.plane.normal);
  const Vec3f against = velocity - surface_velocity(touch.plane, obstacles);
  touch.grip = 0;
  if (touch.push > 0) {
    touch.slip = against - dot(n, against) * n;
    touch.grip =
        h * math::sqrt(float(friction * touch.plane.friction)) * touch.push / math::max(length(touch.slip), soft_slip);
    solver.diagonal[i] = solver.diagonal[i] + touch.grip * (Mat3f::identity() - math::outer(n, n));
    solver.right[i] -= touch.grip * touch.slip;
  }
  const float deep = float(touch.plane.separation);
  touch.active = touch.active || deep < 0;
  if (!touch.active) return;
  const float target = deep > 0 ? -deep / h : math::min(-0.2f * deep / h, greatest_rise(touch.plane, obstacles));
  touch.given = target - dot(n, against);
}

void tie_touches(const SoftTouching& all, const SoftObstacles& obstacles, SoftSolver& solver) {
  for (const SoftTie& tie : solver.ties) solver.tie_of[std::size_t(tie.node)] = -1;
  solver.ties.clear();
  for (std::size_t i = 0; i < all.touches.size(); ++i) {
    const SoftTouch& touch = all.touches[i];
    if (!touch.near) continue;
    solver.holds[i] = touch.active ? SoftHold{1, Vec3f(touch.plane.normal)} : SoftHold{};
    if (touch.active)
      solver.change[i] = solver.holds[i].filter(solver.change[i]) + touch.given * Vec3f(touch.plane.normal);
    const SoftObstacles::Body& body = obstacles.bodies[std::size_t(touch.plane.body)];
    if (body.moves && (touch.active || touch.grip > 0))
      solver.ties.push_back(
          {int(i), touch.plane.body, touch.plane.at - body.center, Vec3f(touch.plane.normal), touch.grip, touch.slip});
  }
  for (std::size_t k = 0; k < all.pins.size(); ++k) {
    const std::size_t i = std::size_t(all.pinned[k]);
    const int index = all.pins[k].index;
    const SoftObstacles::Body* body = index >= 0 ? &obstacles.bodies[std::size_t(index)] : nullptr;
    solver.change[i] = (body ? Vec3f(body->velocity_at(all.position[i])) : Vec3f{}) - all.velocity[i];
    if (body && body->moves) solver.ties.push_back({int(i), index, all.position[i] - body->center, {}, 0, {}});
  }
  std::sort(solver.ties.begin(), solver.ties.end(),
            [](const SoftTie& a, const SoftTie& b) { return a.body != b.body ? a.body < b.body : a.node < b.node; });
  for (SoftMover& mover : solver.movers) mover.from = mover.to = 0;
  for (std::size_t k = 0; k < solver.ties.size(); ++k) {
    SoftMover& mover = solver.movers[std::size_t(solver.ties[k].body)];
    if (mover.to == 0) mover.from = int(k);
    mover.to = int(k) + 1;
    solver.tie_of[std::size_t(solver.ties[k].node)] = int(k);
  }
}

bool revise_touches(const SoftTouching& all, float h, const SoftObstacles& obstacles, SoftSolver& solver) {
  bool again = false;
  // What hardly pulls where nothing that moves hangs on it is let go for the next substep, not for this one.
  const float slight = solver.ties.empty() ? soft_pull * h : 0;
  const float slack = math::max(touching_slack * float(all.apart), least_slack);
  for (std::size_t i = 0; i < all.position.size(); ++i) {
    SoftTouch& touch = all.touches[i];
    if (!touch.near) continue;
    const Vec3f n(touch.plane.normal);
    if (touch.active) {
      const float pull = -dot(n, solver.reaction[i]);
      if (pull <= 0) continue;
      touch.active = false;
      again |= pull > slight * all.mass[i];
      continue;
    }
    const Vec3f before = all.velocity[i] - surface_velocity(touch.plane, obstacles);
    const Vec3f change = solver.change[i] - surface_change(touch, obstacles, solver);
    if (float(touch.plane.separation) + h * dot(n, before + change) >= -slack) continue;
    touch.active = again = true;
    touch.given = -math::max(float(touch.plane.separation), 0.0f) / h - dot(n, before);
  }
  return again;
}

void react_touches(const SoftTouching& all, float h, SoftObstacles& obstacles, const SoftSolver& solver,
                   Vec3d* pin_impulse) {
  for (std::size_t k = 0; k < all.pins.size(); ++k) {
    const std::size_t i = std::size_t(all.pinned[k]);
    const Vec3d impulse = -Vec3d(solver.reaction[i].vector());
    if (pin_impulse) pin_impulse[k] += impulse;
    obstacles.push(all.pins[k].index, all.position[i], impulse);
  }
  for (std::size_t i = 0; i < all.position.size(); ++i) {
    SoftTouch& touch = all.touches[i];
    if (!touch.near) continue;
    const Vec3f n(touch.plane.normal);
    touch.push = touch.active ? math::max(dot(n, solver.reaction[i]), 0.0f) / h : 0;
    Vec3f impulse = touch.active ? solver.reaction[i].vector() : Vec3f{};
    if (touch.grip > 0) {  // as the system had it
      const Vec3f change = solver.change[i] - surface_change(touch, obstacles, solver);
      impulse -= touch.grip * (touch.slip + change - dot(n, change) * n);
    }
    obstacles.push(touch.plane.body, touch.plane.at, -Vec3d(impulse));
  }
}

void hold_pins(const SoftTouching& all, SoftSolver& solver) {
  for (const int i : all.pinned) solver.holds[std::size_t(i)].rank = 3;
}

void place_pins(std::vector<SoftPin>& pins, std::vector<int>& pinned, std::vector<int>& pin_of, rigid::World3& world,
                SoftObstacles& obstacles, std::vector<Vec3d>& position, std::vector<Vec3f>& velocity) {
  for (std::size_t k = pins.size(); k-- > 0;)
    if (pins[k].body != rigid::BodyId{} && !world.contains(pins[k].body)) {
      pin_of[std::size_t(pinned[k])] = -1;
      pins.erase(pins.begin() + std::ptrdiff_t(k));
      pinned.erase(pinned.begin() + std::ptrdiff_t(k));
      for (std::size_t j = k; j < pins.size(); ++j) pin_of[std::size_t(pinned[j])] = int(j);
    }
  for (std::size_t k = 0; k < pins.size(); ++k) {
    SoftPin& pin = pins[k];
    const std::size_t i = std::size_t(pinned[k]);
    pin.index = pin.body == rigid::BodyId{} ? -1 : obstacles.body_index(world, pin.body);
    const SoftObstacles::Body* body = pin.index >= 0 ? &obstacles.bodies[std::size_t(pin.index)] : nullptr;
    position[i] = body ? body->place(pin.point) : pin.point;
    velocity[i] = body ? Vec3f(body->velocity_at(position[i])) : Vec3f{};
  }
}

core::Status push_vertex(std::vector<Vec3f>& velocity, const SoftTouching& all, const std::vector<int>& pin_of,
                         int vertex, Vec3d impulse, rigid::World3& world) {
  const std::size_t i = std::size_t(vertex);
  if (pin_of[i] < 0) {
    velocity[i] += Vec3f(impulse / double(all.mass[i]));
    return {};
  }
  const rigid::BodyId body = all.pins[std::size_t(pin_of[i])].body;
  return world.contains(body) ? world.add_impulse_at(body, Vec3f(impulse), all.position[i]) : core::Status{};
}

void gather_near(double apart, double dt, rigid::World3& world, const rigid::Filter& filter,
                 const std::vector<SoftPin>& pins, const std::vector<Vec3d>& position,
                 const std::vector<Vec3f>& velocity, SoftObstacles& obstacles) {
  geometry::Bounds3d bounds{position[0], position[0]};
  float fastest = 0;
  for (std::size_t i = 0; i < position.size(); ++i) {
    bounds.low = min(bounds.low, position[i]);
    bounds.high = max(bounds.high, position[i]);
    fastest = math::max(fastest, length_squared(velocity[i]));
  }
  obstacles.gather(world, grow(bounds, 2 * apart + 2 * dt * (double(math::sqrt(fastest)) + dt * 20)), filter, pins, dt);
}

}  // namespace carom::particles::detail
