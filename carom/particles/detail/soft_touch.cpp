#include "carom/particles/detail/soft_touch.h"

#include "carom/math/elementary.h"

namespace carom::particles::detail {

using math::Mat3f;

void hold_touch(SoftTouch& touch, std::size_t i, Vec3d position, Vec3f velocity, double friction, float h,
                const SoftObstacles& obstacles, SoftSolver& solver) {
  const Vec3f n(touch.plane.normal);
  const Vec3f against = velocity - Vec3f(obstacles.bodies[std::size_t(touch.plane.body)].velocity_at(position));
  if (touch.push > 0) {
    const Vec3f slide = against - dot(n, against) * n;
    const float c =
        h * math::sqrt(float(friction * touch.plane.friction)) * touch.push / math::max(length(slide), soft_slip);
    solver.diagonal[i] = solver.diagonal[i] + c * (Mat3f::identity() - math::outer(n, n));
    solver.right[i] -= c * slide;
  }
  const float deep = float(touch.plane.separation);
  touch.active = touch.active || deep < 0;
  if (!touch.active) return;
  solver.holds[i] = {1, n};
  const float target = deep > 0 ? -deep / h : math::min(-0.2f * deep / h, 1.0f);
  solver.change[i] = (target - dot(n, against)) * n;
}

bool revise_touches(std::vector<SoftTouch>& touches, const std::vector<Vec3d>& position,
                    const std::vector<Vec3f>& velocity, float h, const SoftObstacles& obstacles, SoftSolver& solver) {
  bool again = false;
  for (std::size_t i = 0; i < position.size(); ++i) {
    SoftTouch& touch = touches[i];
    if (!touch.near) continue;
    const Vec3f n(touch.plane.normal);
    if (touch.active) {
      if (dot(n, solver.reaction[i]) >= 0) continue;
      touch.active = false;
      solver.holds[i] = {};
      again = true;
      continue;
    }
    const Vec3f surface(obstacles.bodies[std::size_t(touch.plane.body)].velocity_at(position[i]));
    const float closing = dot(n, velocity[i] + solver.change[i] - surface);
    if (float(touch.plane.separation) + h * closing >= -1e-6f) continue;
    touch.active = again = true;
    solver.holds[i] = {1, n};
    solver.change[i] += (-math::max(float(touch.plane.separation), 0.0f) / h - closing) * n;
  }
  return again;
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
    pin.mass = 0;
    const SoftObstacles::Body* body = pin.index >= 0 ? &obstacles.bodies[std::size_t(pin.index)] : nullptr;
    position[i] = body ? body->place(pin.point) : pin.point;
    velocity[i] = body ? Vec3f(body->velocity_at(position[i])) : Vec3f{};
    if (!body || !body->dynamic || !body->awake) continue;
    int sharing = 0;
    for (const SoftPin& other : pins) sharing += other.body == pin.body;
    pin.mass = float(body->mass / sharing);
  }
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
  obstacles.gather(world, grow(bounds, 2 * apart + 2 * dt * (double(math::sqrt(fastest)) + dt * 20)), filter, pins);
}

}  // namespace carom::particles::detail
